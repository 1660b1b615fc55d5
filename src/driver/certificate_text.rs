//! What a run prints about its proof: verdict, contracts, tables; with `--details` all figures.

use super::report::Shown;
use super::{RunOptions, shown_path};
use crate::diag::Sink;
use crate::source::SourceMap;
use crate::verify::summary::Verdict;
use std::path::Path;

/// Name of the machine with the origin of its file.
fn machine(name: &str, sources: &SourceMap) -> String {
    let file = sources.files().iter().find(|f| f.name == format!("machines/{name}.toml"));
    let origin = file.map_or("given in the job", |f| f.origin.word());
    format!("{name} ({origin})")
}

/// The text on the proof. `judged` is the NC text that was judged; without it the part names what was judged.
pub(super) fn text(
    run: &RunOptions,
    shown: &Shown<'_>,
    judged: Option<&Path>,
    sources: &SourceMap,
    sink: &Sink,
) -> String {
    let Shown { certificate, program, .. } = *shown;
    let machine = machine(&program.machine.name, sources);
    let file = judged.map(shown_path);
    let name = file.as_deref().unwrap_or(&program.name);
    let verdict = Verdict { errors: sink.errors(), name, machine: &machine, post: shown.post };
    if !run.details {
        return certificate.summary(verdict) + "  all figures: `--details`\n";
    }
    let mut text = certificate.judgement(verdict) + "\n" + &certificate.text(program, shown.motion);
    if !shown.notes.is_empty() {
        text.push_str("\nhow the operations were planned\n");
    }
    for (operation, note) in shown.notes {
        text.push_str(&format!("  {operation:<12} {note}\n"));
    }
    text
}
