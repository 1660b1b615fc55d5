//! What an import states of the files that a part was made from.

use base::units::Mm;
use serde::{Deserialize, Serialize};

/// Files that `impellerc import` read, and how far what it wrote lies from them: as the job states it. Nothing measures it again.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ImportedFrom {
    /// Names of the files.
    pub files: String,
    /// Largest distance between the points of the files and the job.
    pub within: Mm,
}
