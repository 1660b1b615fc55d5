//! Options that commands share.

use super::ChoiceOptions;
use std::path::PathBuf;

/// Options that a compilation and a check of NC text share.
#[derive(Clone, Debug, Default)]
pub struct RunOptions {
    /// Folder with `machines` and `tools`, searched before any other.
    pub library: Option<PathBuf>,
    /// Folder with curve files, in addition to the folder of the job.
    pub curves: Option<PathBuf>,
    /// Dialect instead of the job's.
    pub post: Option<String>,
    /// Name of the machine file instead of the job's.
    pub machine: Option<String>,
    /// File to write the report to, also when a contract fails.
    pub report: Option<PathBuf>,
    /// Edge of the cells of the stock simulation, mm, instead of the default.
    pub stock_cell: Option<f64>,
    /// Folder for a mesh of the stock after each operation.
    pub stock: Option<PathBuf>,
    /// Memory that planning may use, bytes, instead of the default.
    pub memory: Option<f64>,
    /// Whether all figures of the proof are printed.
    pub details: bool,
    /// How a job with open places is completed.
    pub choice: ChoiceOptions,
}
