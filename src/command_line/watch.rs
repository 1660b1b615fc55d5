//! `--watch`: the files of a run, and their changes.
//!
//! Editors replace files in many ways, and some disks do not report changes; so times and sizes are compared, some times a
//! second.

use impellerc::driver::{FileStamps, Outcome, RunState};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, SystemTime};

/// Time between two checks of the files.
const POLL_INTERVAL: Duration = Duration::from_millis(150);

/// The files of a run.
pub(super) struct Watch {
    /// The job as the user named it.
    job: PathBuf,
    /// The files as the last run began.
    files: FileStamps,
    /// When the last run began.
    began: SystemTime,
}

/// Ends the watch of the files, also when the work panics: otherwise its thread would be waited for.
struct Ended<'a>(&'a AtomicBool);

impl Drop for Ended<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

impl Watch {
    /// Watches the job alone: the other files are known after the first run.
    pub(super) fn new(job: &Path) -> Self {
        // With symbolic links resolved, as the sources of a run name it.
        let resolved = job.canonicalize().unwrap_or_else(|_| job.to_path_buf());
        let files = FileStamps::new([resolved].into_iter());
        Self { job: job.to_path_buf(), files, began: SystemTime::now() }
    }

    /// Runs work, and cancels it when a file changes.
    pub(super) fn cancelled_by_changes(&mut self, state: &RunState, work: impl FnOnce() -> Outcome) -> Outcome {
        self.files = self.files.again();
        self.began = SystemTime::now();
        let ended = AtomicBool::new(false);
        std::thread::scope(|threads| {
            threads.spawn(|| {
                while !ended.load(Ordering::Relaxed) {
                    if !self.files.hold() {
                        state.cancel();
                        return;
                    }
                    std::thread::sleep(POLL_INTERVAL);
                }
            });
            let _ended = Ended(&ended);
            work()
        })
    }

    /// Watches the files that a run has read, and those that it looked for and did not find.
    pub(super) fn take_files(&mut self, outcome: &Outcome) {
        self.files.add(FileStamps::of(outcome), self.began);
    }

    /// What is watched, for people.
    pub(super) fn waits_for(&self) -> String {
        let others = match self.files.existing().saturating_sub(1) {
            0 => String::new(),
            1 => " and one more file".to_owned(),
            others => format!(" and {others} more files"),
        };
        format!("\nwaiting for a change of {}{others}; Ctrl+C ends\n", self.job.display())
    }

    /// Waits until a file has changed and no file changes any more.
    pub(super) fn wait(&self) {
        while self.files.hold() {
            std::thread::sleep(POLL_INTERVAL);
        }
        loop {
            let before = self.files.again();
            std::thread::sleep(POLL_INTERVAL);
            if before.hold() {
                return;
            }
        }
    }
}
