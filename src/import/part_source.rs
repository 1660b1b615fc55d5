//! What a part is written from.

use super::job_frame::Zero;
use super::{Imported, ImportedRow};
use crate::sections::outline::DividedSection;

/// What is written.
#[derive(Clone, Copy, Debug)]
pub struct PartSource<'a> {
    /// All that was read.
    pub imported: &'a Imported,
    /// The row whose blades are written.
    pub row: &'a ImportedRow,
    /// Sections of each blade of the row, divided.
    pub divided: &'a [Vec<DividedSection>],
    /// Names of the files that were read.
    pub read: &'a [String],
    /// Name of the part and of its files, without an ending.
    pub name: &'a str,
    /// Zero of the part.
    pub zero: Zero,
}

/// Name of a blade in the job.
pub(super) fn blade_name(k: usize) -> String {
    if k == 0 { "main".to_owned() } else { format!("splitter_{k}") }
}
