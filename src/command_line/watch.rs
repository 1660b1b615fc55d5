//! `--watch`: the files of a run, and their changes.
//!
//! Editors replace files in many ways, and some disks tell nothing of changes; so times and sizes are looked at, some times a
//! second.

use impellerc::driver::{Outcome, RunState};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, SystemTime};

/// Time between two looks at the files.
const LOOK: Duration = Duration::from_millis(150);

/// Time of the last change of a file and its size; `None` where there is none.
type Stamp = Option<(SystemTime, u64)>;

/// The files of a run.
pub(super) struct Watch {
    /// The job as the user named it.
    shown: PathBuf,
    /// The job with symbolic links resolved, as the sources of a run name it.
    job: PathBuf,
    /// The files as the last run began.
    stamps: BTreeMap<PathBuf, Stamp>,
    /// When the last run began.
    began: SystemTime,
}

fn stamp(path: &Path) -> Stamp {
    let about = std::fs::metadata(path).ok()?;
    Some((about.modified().ok()?, about.len()))
}

fn stamps<'p>(paths: impl Iterator<Item = &'p PathBuf>) -> BTreeMap<PathBuf, Stamp> {
    paths.map(|path| (path.clone(), stamp(path))).collect()
}

impl Watch {
    /// Watches the job alone: the other files are known after the first run.
    pub(super) fn new(job: &Path) -> Self {
        let shown = job.to_path_buf();
        let job = job.canonicalize().unwrap_or_else(|_| shown.clone());
        Self { shown, stamps: stamps([job.clone()].iter()), job, began: SystemTime::now() }
    }

    /// Runs work, and cancels it when a file changes.
    pub(super) fn cancelled_by_changes(&mut self, state: &RunState, work: impl FnOnce() -> Outcome) -> Outcome {
        self.stamps = stamps(self.stamps.keys());
        self.began = SystemTime::now();
        let ended = AtomicBool::new(false);
        std::thread::scope(|threads| {
            threads.spawn(|| {
                while !ended.load(Ordering::Relaxed) {
                    if self.changed() {
                        state.cancel();
                        return;
                    }
                    std::thread::sleep(LOOK);
                }
            });
            let outcome = work();
            ended.store(true, Ordering::Relaxed);
            outcome
        })
    }

    /// Watches the files that a run has read.
    pub(super) fn take_files(&mut self, outcome: &Outcome) {
        let read = outcome.sources.files().iter().filter_map(|file| file.disk.clone());
        let files: BTreeSet<PathBuf> = read.chain([self.job.clone()]).collect();
        for path in files {
            // A file that changed after the run had begun may have been read before its change: it counts as changed.
            let now = stamp(&path).filter(|(changed, _)| *changed < self.began);
            self.stamps.entry(path).or_insert(now);
        }
    }

    /// What is watched, for people.
    pub(super) fn waits_for(&self) -> String {
        let others = match self.stamps.len().saturating_sub(1) {
            0 => String::new(),
            1 => " and one more file".to_owned(),
            others => format!(" and {others} more files"),
        };
        format!("\nwaiting for a change of {}{others}; Ctrl+C ends\n", self.shown.display())
    }

    fn changed(&self) -> bool {
        self.stamps.iter().any(|(path, before)| stamp(path) != *before)
    }

    /// Waits until a file has changed and no file changes any more.
    pub(super) fn wait(&self) {
        while !self.changed() {
            std::thread::sleep(LOOK);
        }
        loop {
            let before = stamps(self.stamps.keys());
            std::thread::sleep(LOOK);
            if stamps(self.stamps.keys()) == before {
                return;
            }
        }
    }
}
