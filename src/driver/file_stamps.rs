//! When files were changed, to see whether they still are what was read.

use super::Outcome;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Time of the last change of a file and its size; `None` where there is no file.
type Stamp = Option<(SystemTime, u64)>;

/// Files with their last changes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FileStamps(BTreeMap<PathBuf, Stamp>);

fn stamp(path: &Path) -> Stamp {
    let about = std::fs::metadata(path).ok()?;
    Some((about.modified().ok()?, about.len()))
}

impl FileStamps {
    /// Files as they are.
    pub fn new(paths: impl Iterator<Item = PathBuf>) -> Self {
        Self(paths.map(|path| (path.clone(), stamp(&path))).collect())
    }

    /// The files that a run has read, and those that it looked for and did not find.
    pub fn of(outcome: &Outcome) -> Self {
        let read = outcome.sources.files().iter().filter_map(|file| file.disk.clone());
        Self::new(read.chain(outcome.missing_files.iter().cloned()))
    }

    /// Adds files. One that changed from a time on may have been read before its change: it counts as changed.
    pub fn add(&mut self, more: Self, began: SystemTime) {
        for (path, now) in more.0 {
            self.0.entry(path).or_insert(now.filter(|(changed, _)| *changed < began));
        }
    }

    /// The same files as they are now.
    pub fn again(&self) -> Self {
        Self::new(self.0.keys().cloned())
    }

    /// True while no file has changed.
    pub fn hold(&self) -> bool {
        self.0.iter().all(|(path, before)| stamp(path) == *before)
    }

    /// Number of files that exist.
    pub fn existing(&self) -> usize {
        self.0.values().flatten().count()
    }
}
