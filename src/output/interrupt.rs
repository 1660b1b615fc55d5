//! Signals: unfinished files of a run are removed, also when a signal ends the run.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Unfinished files and folders on the disk. There is one list for the process, since signals are sent to the process.
static UNFINISHED: Mutex<Unfinished> =
    Mutex::new(Unfinished { files: Vec::new(), folders: Vec::new(), done: Vec::new(), streaming: None });

/// Temporary files and new folders.
pub(super) struct Unfinished {
    files: Vec<PathBuf>,
    folders: Vec<PathBuf>,
    /// Outputs that are written completely, by the names that the user gave.
    done: Vec<String>,
    /// The device or FIFO that is being written.
    streaming: Option<String>,
}

/// A further run begins: files of an earlier run are no longer reported.
pub fn begin() {
    hold().done.clear();
}

/// While the guard is held, no signal ends the run.
pub(super) fn hold() -> MutexGuard<'static, Unfinished> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Unfinished {
    /// Adds a file that is removed when the run ends early.
    pub(super) fn file(&mut self, path: &Path) {
        self.files.push(path.to_path_buf());
    }

    /// Adds a folder that is removed, if it is empty, when the run ends early.
    pub(super) fn folder(&mut self, path: &Path) {
        self.folders.push(path.to_path_buf());
    }

    /// Removes a file that is no longer needed.
    pub(super) fn remove(&mut self, path: &Path) {
        // The file may have been moved to its place.
        let _ = std::fs::remove_file(path);
        self.forget(path);
    }

    /// Removes a file or folder from the list, so that it stays.
    pub(super) fn forget(&mut self, path: &Path) {
        self.files.retain(|p| p != path);
        self.folders.retain(|p| p != path);
    }

    /// Removes a folder if it is empty.
    pub(super) fn remove_folder(&mut self, path: &Path) {
        let _ = std::fs::remove_dir(path);
        self.forget(path);
    }

    /// Marks a device or FIFO as being written.
    pub(super) fn stream(&mut self, shown: String) {
        self.streaming = Some(shown);
    }

    /// The whole text was written to the device.
    pub(super) fn streamed(&mut self) {
        self.done.extend(self.streaming.take());
    }

    /// Marks a file as written completely.
    pub(super) fn done(&mut self, shown: String) {
        self.done.push(shown);
    }

    /// Removes all files and folders of the list.
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

/// Waits in its own thread for signals that end the program. On a signal the thread removes temporary files, reports
/// what was written (`tell`), and ends the program with the default action of the signal. Signals that are ignored stay
/// ignored, such as SIGHUP under `nohup`. When a file exceeds the limit of the shell, the result is a write error and
/// no signal.
#[cfg(unix)]
pub fn watch(tell: bool) {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
    use std::sync::Arc;
    use std::sync::atomic::AtomicBool;
    // Otherwise the limit of the file size would kill the program and leave its temporary files.
    let _ = signal_hook::flag::register(SIGXFSZ, Arc::new(AtomicBool::new(false)));
    let wait = move || {
        let ignored = ignored();
        let heard = [SIGINT, SIGTERM, SIGHUP].into_iter().filter(|s| ignored & (1 << (s - 1)) == 0);
        let Ok(mut signals) = signal_hook::iterator::Signals::new(heard) else { return };
        if let Some(signal) = signals.forever().next() {
            end(signal, tell);
        }
    };
    // Without the thread, signals end the program by their default action.
    let _ = std::thread::Builder::new().name("signals".to_owned()).spawn(wait);
}

/// On systems without this thread, signals end the program by their default action.
#[cfg(not(unix))]
pub fn watch(_tell: bool) {}

/// Ends the program by a signal.
#[cfg(unix)]
fn end(signal: i32, tell: bool) {
    // Held until the end, so that no new file is begun.
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
            done.push_str(&format!("; {streaming} may have received a part of its text"));
        }
        let _ = writeln!(std::io::stderr(), "\nended by {name}: {}", diagnostics::printable(&done));
    }
    let _ = signal_hook::low_level::emulate_default_handler(signal);
}

/// Bit mask of the signals that are ignored at the start; zero where the system does not tell.
#[cfg(unix)]
fn ignored() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}
