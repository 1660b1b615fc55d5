//! Signals: what a run left on the disk before its end is taken away, whatever ends it.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What lies on the disk and belongs to no finished run. There is one list for the process, as signals are sent to it.
static UNFINISHED: Mutex<Unfinished> =
    Mutex::new(Unfinished { files: Vec::new(), folders: Vec::new(), done: Vec::new(), streaming: None });

/// Temporary files and new folders.
pub(super) struct Unfinished {
    files: Vec<PathBuf>,
    folders: Vec<PathBuf>,
    /// What was written for good, as the user names it.
    done: Vec<String>,
    /// The device or FIFO that is being written to.
    streaming: Option<String>,
}

/// While it is held, no signal ends the run.
pub(super) fn hold() -> MutexGuard<'static, Unfinished> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Unfinished {
    /// A file that is to go when the run ends early.
    pub(super) fn file(&mut self, path: &Path) {
        self.files.push(path.to_path_buf());
    }

    /// The same of a folder; it goes when it is empty.
    pub(super) fn folder(&mut self, path: &Path) {
        self.folders.push(path.to_path_buf());
    }

    /// Removes a file that is not needed any more.
    pub(super) fn remove(&mut self, path: &Path) {
        // It may have taken its place.
        let _ = std::fs::remove_file(path);
        self.forget(path);
    }

    /// A file or folder that is here to stay.
    pub(super) fn forget(&mut self, path: &Path) {
        self.files.retain(|p| p != path);
        self.folders.retain(|p| p != path);
    }

    /// Removes a folder if it is empty.
    pub(super) fn remove_folder(&mut self, path: &Path) {
        let _ = std::fs::remove_dir(path);
        self.forget(path);
    }

    /// A device or FIFO that a text goes to from now on.
    pub(super) fn stream(&mut self, shown: String) {
        self.streaming = Some(shown);
    }

    /// The text went there as a whole.
    pub(super) fn streamed(&mut self) {
        self.done.extend(self.streaming.take());
    }

    /// A file that was written for good.
    pub(super) fn done(&mut self, shown: String) {
        self.done.push(shown);
    }

    /// Removes everything.
    #[cfg(unix)]
    fn clear(&mut self) {
        for file in self.files.drain(..) {
            let _ = std::fs::remove_file(file);
        }
        for folder in self.folders.drain(..).rev() {
            let _ = std::fs::remove_dir(folder);
        }
    }
}

/// Waits for signals that end the program, in a thread of its own: they remove temporary files, say (`tell`) what was
/// written, and end the program as they always do. Signals that are ignored stay so, as SIGHUP under `nohup`. A file that
/// grows beyond the limit of the shell becomes an error of writing instead of a signal.
#[cfg(unix)]
pub fn watch(tell: bool) {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
    use std::sync::Arc;
    use std::sync::atomic::AtomicBool;
    // Without it a full quota of this kind would kill the program with its temporary files in place.
    let _ = signal_hook::flag::register(SIGXFSZ, Arc::new(AtomicBool::new(false)));
    let wait = move || {
        let ignored = ignored();
        let heard = [SIGINT, SIGTERM, SIGHUP].into_iter().filter(|s| ignored & (1 << (s - 1)) == 0);
        let Ok(mut signals) = signal_hook::iterator::Signals::new(heard) else { return };
        if let Some(signal) = signals.forever().next() {
            end(signal, tell);
        }
    };
    // Without a thread signals end the program as if nobody had asked for them.
    let _ = std::thread::Builder::new().name("signals".to_owned()).spawn(wait);
}

/// Signals without a thread of their own end the program on their own.
#[cfg(not(unix))]
pub fn watch(_tell: bool) {}

/// Ends the program by a signal.
#[cfg(unix)]
fn end(signal: i32, tell: bool) {
    // Held until the end, so that nothing new is begun.
    let mut unfinished = hold();
    unfinished.clear();
    if tell {
        use std::io::Write as _;
        let name = signal_hook::low_level::signal_name(signal).unwrap_or("a signal");
        let mut done = match (&unfinished.done[..], &unfinished.streaming) {
            ([], None) => "nothing was written".to_owned(),
            ([], Some(_)) => "no file was written".to_owned(),
            (done, _) => format!("{} written", done.join(", ")),
        };
        if let Some(streaming) = &unfinished.streaming {
            done.push_str(&format!("; {streaming} may have got a part of its text"));
        }
        let _ = writeln!(std::io::stderr(), "\nended by {name}: {}", crate::diag::printable(&done));
    }
    let _ = signal_hook::low_level::emulate_default_handler(signal);
}

/// Signals that are ignored from the start, a bit for each; none where the system does not say.
#[cfg(unix)]
fn ignored() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}
