//! Verification that also writes the stock after each operation as a mesh.

use super::RunOptions;
use crate::output::Outputs;
use ::report::report::StockStage;
use base::progress::Progress;
use diagnostics::codes::verification;
use diagnostics::{Aborted, Diag, Sink};
use ir::{Motion, Program};
use std::path::{Path, PathBuf};
use tool_stock::stock::{Field, Mesh};
use verify::{Certificate, Verified, stock::Settings};

/// Options of the stock simulation.
pub(super) struct StockRequest<'a> {
    /// Edge of the cells, mm, instead of the default.
    pub(super) cell: Option<f64>,
    /// Largest cell of the meshes where the simulation takes its default, mm.
    pub(super) usual: f64,
    /// Folder for the meshes.
    pub(super) folder: Option<&'a Path>,
    /// Stages the meshes as files until all outputs are written.
    pub(super) outputs: &'a mut Outputs,
    /// Receives the meshes for the report.
    pub(super) stages: Option<&'a mut Vec<StockStage>>,
}

/// Verifies with the settings of the command line. The meshes are written also when a contract fails, since they show
/// why. `stages` receives them for the report.
pub(super) fn examine(
    options: &RunOptions,
    program: &Program,
    motion: Motion,
    stages: &mut Vec<StockStage>,
    outputs: &mut Outputs,
    progress: &Progress,
    sink: &mut Sink,
) -> Result<(Result<Verified<Motion>, Motion>, Certificate), Aborted> {
    let names = names(program, &motion);
    stages.extend(at_start(program).filter(|_| options.report.is_some()));
    let stages = options.report.is_some().then_some(stages);
    let usual = verify::stock::usual_cell(&program.stock.profile);
    let request = StockRequest { cell: options.stock_cell, usual, folder: options.stock.as_deref(), outputs, stages };
    simulated(request, &names, sink, |settings, sink| verify::examine(program, motion, settings, progress, sink))
}

/// Names of the operations of a motion.
pub(super) fn names(program: &Program, motion: &Motion) -> Vec<String> {
    motion.operations.iter().map(|o| program.operations[o.operation].name.clone()).collect()
}

/// Runs a verification with the options; `names` are those of the operations.
pub(super) fn simulated<T>(
    request: StockRequest<'_>,
    names: &[String],
    sink: &mut Sink,
    work: impl FnOnce(&mut Settings<'_>, &mut Sink) -> Result<T, Aborted>,
) -> Result<T, Aborted> {
    let StockRequest { cell, usual, folder, outputs, mut stages } = request;
    let wanted = folder.is_some() || stages.is_some();
    let mut failed: Option<Diag> = None;
    let mut after = |o: usize, field: &Field| {
        let name = names.get(o).map_or("", String::as_str);
        let coarser = cell.is_none().then(|| field.coarser(usual));
        let drawn = coarser.as_ref().unwrap_or(field);
        let mesh = drawn.mesh();
        if let (Some(folder), None) = (folder, &failed) {
            failed = outputs.stage("--stock", &path(folder, o, name), &mesh.stl(name)).err();
        }
        if let Some(stages) = &mut stages {
            stages.push(stage(o, name, mesh, drawn.cell()));
        }
    };
    let mut settings = Settings { cell, ..Settings::default() };
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

/// What is left of the blank before the first operation, in the form of the report.
pub(super) fn at_start(program: &Program) -> Option<StockStage> {
    let mesh = program.stock.left.as_deref()?.clone();
    Some(StockStage {
        name: "at the start".to_owned(),
        positions: mesh.vertices,
        triangles: mesh.triangles,
        cell: 0.0,
        after: None,
    })
}

/// Stock after an operation in the form of the report.
fn stage(operation: usize, name: &str, mesh: Mesh, cell: f64) -> StockStage {
    let name = format!("after {name}");
    StockStage { name, positions: mesh.vertices, triangles: mesh.triangles, cell, after: Some(operation) }
}

/// Mesh file of an operation. Its name begins with a number, so that a listing is in machining order.
pub(super) fn path(folder: &Path, operation: usize, name: &str) -> PathBuf {
    folder.join(format!("{:02}-{name}.stl", operation + 1))
}

/// Refuses cells larger than the default, between which a collision could be missed. Cells that are too fine for the
/// memory are refused when the stock is made.
pub(super) fn check_cell(cell: f64, profile: &[[f64; 2]]) -> Result<(), Diag> {
    // Rounded down, so that the figure in the message is an allowed one.
    let most = (verify::stock::usual_cell(profile) * 1e3).floor() / 1e3;
    if cell > 0.0 && cell <= most {
        return Ok(());
    }
    let why = if cell > most {
        format!("they are larger than {most} mm, so a collision between two rays could be missed")
    } else {
        "the cell size is not larger than zero".to_owned()
    };
    Err(Diag::error(verification::STOCK_CELL, format!("the stock cannot be simulated with cells of {cell} mm: {why}"))
        .help(format!("give `--stock-cell` at most {most} on this part, or leave it out")))
}
