//! Verification with the stock after each operation written as a mesh.

use super::RunOptions;
use crate::diag::codes::files;
use crate::diag::{Aborted, Diag, Sink};
use crate::export::report::StockStage;
use crate::ir::{Motion, Program};
use crate::output;
use crate::progress::Progress;
use crate::stock::{Field, Mesh};
use crate::verify::{self, Certificate, Verified, stock::Settings};
use std::path::{Path, PathBuf};

/// What is asked of the stock simulation.
pub(super) struct Asked<'a> {
    /// Edge of the cells, mm, instead of the usual.
    pub(super) cell: Option<f64>,
    /// Where to write the meshes.
    pub(super) folder: Option<&'a Path>,
    /// Gets the meshes for the report.
    pub(super) stages: Option<&'a mut Vec<StockStage>>,
}

/// Verifies with the settings of the command line. The meshes are written also when a contract fails then: they show
/// why. `stages` gets them for the report.
pub(super) fn examine(
    options: &RunOptions,
    program: &Program,
    motion: Motion,
    stages: &mut Vec<StockStage>,
    progress: &Progress,
    sink: &mut Sink,
) -> Result<(Result<Verified<Motion>, Motion>, Certificate), Aborted> {
    let names = names(program, &motion);
    let stages = options.report.is_some().then_some(stages);
    let asked = Asked { cell: options.stock_cell, folder: options.stock.as_deref(), stages };
    simulated(asked, &names, sink, |settings, sink| verify::examine(program, motion, settings, progress, sink))
}

/// Names of the operations of a motion.
pub(super) fn names(program: &Program, motion: &Motion) -> Vec<String> {
    motion.operations.iter().map(|o| program.operations[o.operation].name.clone()).collect()
}

/// Runs a verification as it is asked for; `names` are those of the operations.
pub(super) fn simulated<T>(
    asked: Asked<'_>,
    names: &[String],
    sink: &mut Sink,
    work: impl FnOnce(&mut Settings<'_>, &mut Sink) -> Result<T, Aborted>,
) -> Result<T, Aborted> {
    let Asked { cell, folder, mut stages } = asked;
    let wanted = folder.is_some() || stages.is_some();
    let mut failed: Option<Diag> = None;
    let mut after = |o: usize, field: &Field| {
        let name = names.get(o).map_or("", String::as_str);
        let mesh = field.mesh();
        if let (Some(folder), None) = (folder, &failed) {
            failed = output::write_whole(&path(folder, o, name), &mesh.stl(name)).err();
        }
        if let Some(stages) = &mut stages {
            stages.push(stage(name, mesh));
        }
    };
    let mut settings = Settings { cell, after: None };
    if wanted {
        settings.after = Some(&mut after);
    }
    let verified = work(&mut settings, sink);
    match failed {
        Some(diag) => {
            sink.push(diag);
            Err(Aborted)
        }
        None => verified,
    }
}

/// Stock after an operation as the report takes it.
fn stage(name: &str, mesh: Mesh) -> StockStage {
    StockStage { name: format!("after {name}"), positions: mesh.vertices, triangles: mesh.triangles }
}

/// Mesh file of an operation: numbered, so that a listing shows them in the order of machining.
fn path(folder: &Path, operation: usize, name: &str) -> PathBuf {
    folder.join(format!("{:02}-{name}.stl", operation + 1))
}

/// Makes the folder where it is missing.
pub(super) fn check(folder: &Path) -> Result<(), Diag> {
    std::fs::create_dir_all(folder).map_err(|e| {
        Diag::error(files::CANNOT_WRITE, format!("the folder {} cannot be made: {e}", folder.display()))
            .help("give `--stock` a folder, or a path at which one can be made")
    })?;
    output::check(&path(folder, 0, "stock"))
}
