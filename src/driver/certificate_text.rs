//! What a run prints about its proof: verdict, contracts, tables; with `--details` all figures.

use super::report::Shown;
use super::{RunOptions, shown_path};
use ::report::proof::details::details;
use ::report::proof::summary::{self, Verdict};
use base::source::{Origin, SourceMap};
use diagnostics::{Diag, Severity, Sink};
use job::files::shipped;
use std::path::Path;
use verify::contracts;

/// Name of the machine with the origin of its file.
fn machine(name: &str, sources: &SourceMap) -> String {
    let file = sources.files().iter().find(|f| f.name == format!("machines/{name}.toml"));
    let origin = file.map_or("given in the job", |f| f.origin.word());
    format!("{name} ({origin})")
}

/// Dialect, with post file and libraries of tools that are not the shipped ones.
fn post(dialect: &str, sources: &SourceMap) -> String {
    let own = own_files(sources).filter(|(kind, ..)| *kind != "machines");
    let own = own.map(|(kind, name, origin)| format!(", {} {name} ({origin})", kind.trim_end_matches('s')));
    format!("{dialect}{}", own.collect::<String>())
}

/// Files of the library with another content than the shipped ones: kind, name, and origin.
fn own_files(sources: &SourceMap) -> impl Iterator<Item = (&str, &str, &'static str)> {
    let files = sources.files().iter().filter(|f| f.origin != Origin::Shipped);
    files.filter_map(|f| {
        let (kind, name) = f.name.strip_suffix(".toml")?.split_once('/')?;
        let shipped = match kind {
            "machines" => shipped::MACHINES,
            "tools" => shipped::TOOLS,
            "posts" => shipped::POSTS,
            _ => return None,
        };
        let same = shipped.iter().any(|(known, text)| *known == name && *text == f.text);
        (!same).then_some((kind, name, f.origin.word()))
    })
}

/// A line for each file of the library that is not the shipped one, for the head of the text and the setup sheet.
pub(super) fn library_lines(sources: &SourceMap) -> Vec<String> {
    let own = own_files(sources);
    own.map(|(kind, name, origin)| format!("library file {kind}/{name}.toml: {origin}, not a shipped file")).collect()
}

/// Most faults that the verdict names; all of them are among the diagnostics.
const MAX_NAMED_FAULTS: usize = 3;

/// Errors of a run that are no failed contracts, as the verdict names them.
fn faults(sink: &Sink) -> Vec<String> {
    let others: Vec<&Diag> = sink
        .diags()
        .iter()
        .filter(|diag| diag.severity == Severity::Error && !contracts::FAILURES.contains(&diag.code))
        .collect();
    let named = others.iter().take(MAX_NAMED_FAULTS).map(|diag| format!("{} ({})", diag.message, diag.code.id()));
    let more = others.len().saturating_sub(MAX_NAMED_FAULTS);
    named.chain((more > 0).then(|| format!("and {more} more"))).collect()
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
    let post = post(shown.post, sources);
    let faults = faults(sink);
    let verdict = Verdict { errors: sink.errors(), faults: &faults, name, machine: &machine, post: &post };
    if !run.details {
        return summary::summary(program, certificate, verdict) + "  all figures: `--details`\n";
    }
    let mut text = summary::judgement(certificate, verdict) + "\n" + &details(program, shown.motion, certificate);
    if !shown.notes.is_empty() {
        text.push_str("\nhow the operations were planned\n");
    }
    for (operation, note) in shown.notes {
        text.push_str(&format!("  {operation:<12} {note}\n"));
    }
    text
}
