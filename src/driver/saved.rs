//! Files of a run: all of a program that was accepted, report and meshes of one that was refused.

use super::other_outputs::Accepted;
use super::{Options, RunOptions, Stages, or_reported, report, shown_path};
use crate::output::Outputs;
use diagnostics::{Aborted, Diag, Sink};
use ir::Motion;
use std::path::{Path, PathBuf};

/// Writes every file that the options require. Returns a text that names the files.
pub(super) fn save_accepted(
    options: &Options,
    accepted: &Accepted<'_>,
    shown: report::Shown<'_>,
    mut outputs: Outputs,
    stages: &mut Stages,
    sink: &mut Sink,
) -> Result<String, Aborted> {
    let Options { output, other_outputs, run, .. } = options;
    if let Some(path) = output {
        or_reported(outputs.stage("-o", path, accepted.written.text.as_bytes()), sink)?;
    }
    for file in other_outputs {
        let name = file.output.flag.trim_start_matches('-');
        let bytes = or_reported(stages.run(name, || (file.output.make)(accepted, &file.path)), sink)?;
        or_reported(outputs.stage(file.output.flag, &file.path, &bytes), sink)?;
    }
    let motion = shown.motion;
    if let Some(path) = &run.report {
        let shown =
            report::Shown { nc: Some(report::NcLines::written(&accepted.written.nc, &accepted.written.text)), ..shown };
        let html = report::html(&shown, stages, sink);
        or_reported(outputs.stage("--report", path, html.as_bytes()), sink)?;
    }
    or_reported(stages.run("save", || outputs.commit()), sink)?;

    let mut said = match output {
        Some(path) => format!("wrote {}: {} lines\n", shown_path(path), accepted.written.text.lines().count()),
        None => "no NC text written: no `-o FILE`\n".to_owned(),
    };
    said.push_str(&meshes_written(run, motion));
    for path in other_outputs.iter().map(|file| &file.path).chain(&run.report) {
        said.push_str(&format!("wrote {}\n", shown_path(path)));
    }
    Ok(said)
}

/// Writes the report and the meshes of a program that was refused: they show why. Returns a text about what it wrote.
pub(super) fn save_refused(
    run: &RunOptions,
    shown: &report::Shown<'_>,
    mut outputs: Outputs,
    stages: &mut Stages,
    sink: &mut Sink,
) -> Result<String, Aborted> {
    if let Some(path) = &run.report {
        let html = report::html(shown, stages, sink);
        or_reported(outputs.stage("--report", path, html.as_bytes()), sink)?;
    }
    or_reported(outputs.commit(), sink)?;
    let meshes = meshes_written(run, shown.motion);
    Ok(match &run.report {
        Some(path) => format!("{meshes}wrote {}; no NC text\n", shown_path(path)),
        None => format!("{meshes}no NC text written\n"),
    })
}

/// Text that the stock after each operation was written, where the options require it.
pub(super) fn meshes_written(run: &RunOptions, motion: &Motion) -> String {
    let line = |folder: &PathBuf| format!("wrote {}: {} meshes\n", shown_path(folder), motion.operations.len());
    run.stock.as_ref().map(line).unwrap_or_default()
}

/// Writes files together with those that are staged already, all or none.
pub(super) fn save<'a>(
    mut outputs: Outputs,
    files: impl Iterator<Item = (&'a str, &'a Path, &'a [u8])>,
) -> Result<(), Diag> {
    for (flag, path, bytes) in files {
        outputs.stage(flag, path, bytes)?;
    }
    outputs.commit()
}
