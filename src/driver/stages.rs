//! The stages of a run: their times, what a terminal shows of them, and what can be printed.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Stage values that `--emit` prints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Emit {
    /// Syntax tree.
    Ast,
    /// Job with every default.
    Job,
    /// Lowered program.
    Ir,
    /// Contact points.
    Cc,
    /// Cutter locations.
    Cl,
    /// Joint motion.
    Motion,
    /// NC text.
    Nc,
}

/// Times of the stages that ran.
#[derive(Debug, Default)]
pub struct Stages {
    times: Vec<(&'static str, Duration)>,
    /// Show long stages on standard error. For a terminal: in a pipe nothing is to be said of them.
    pub progress: bool,
}

/// Time after which a stage is shown, so that short ones do not flicker.
const PATIENCE: Duration = Duration::from_secs(1);

/// Time between two pictures of the spinner.
const TICK: Duration = Duration::from_millis(100);

/// A stage that is shown while it lasts, from [`PATIENCE`] on.
struct Shown {
    /// Dropped when the stage ends.
    running: Sender<()>,
    thread: JoinHandle<()>,
}

impl Shown {
    /// `number` counts the stages from 1. `None` when there is no thread to be had: then nothing is shown.
    fn start(name: &'static str, number: usize) -> Option<Self> {
        let (running, ended) = channel();
        let start = Instant::now();
        let draw = move || {
            if ended.recv_timeout(PATIENCE) != Err(RecvTimeoutError::Timeout) {
                return;
            }
            let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
            if let Ok(style) = ProgressStyle::with_template("{spinner} {prefix:>2} {msg:<12} {elapsed_precise}") {
                bar.set_style(style);
            }
            let bar = bar.with_prefix(number.to_string()).with_message(name).with_elapsed(start.elapsed());
            while ended.recv_timeout(TICK) == Err(RecvTimeoutError::Timeout) {
                bar.tick();
            }
            bar.finish_and_clear();
        };
        let thread = std::thread::Builder::new().name("progress".to_owned()).spawn(draw).ok()?;
        Some(Self { running, thread })
    }

    /// Clears the line.
    fn end(self) {
        drop(self.running);
        // A thread that failed to draw is no reason to stop the work.
        let _ = self.thread.join();
    }
}

impl Stages {
    /// Runs a stage and takes its time.
    pub fn run<T>(&mut self, name: &'static str, work: impl FnOnce() -> T) -> T {
        let shown = if self.progress { Shown::start(name, self.times.len() + 1) } else { None };
        let start = Instant::now();
        let value = work();
        self.times.push((name, start.elapsed()));
        if let Some(shown) = shown {
            shown.end();
        }
        value
    }

    /// One line a stage with its time in seconds, and their sum.
    pub fn report(&self) -> String {
        let mut out = String::new();
        let mut sum = Duration::ZERO;
        for (name, time) in &self.times {
            out.push_str(&format!("{name:<16}{:>9.3} s\n", time.as_secs_f64()));
            sum += *time;
        }
        out.push_str(&format!("{:<16}{:>9.3} s\n", "total", sum.as_secs_f64()));
        out
    }
}
