//! The stages of a run: their times, a spinner on a terminal, and what can be printed.

use indicatif::{ProgressBar, ProgressStyle};
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
    /// Show a spinner on standard error, when that is a terminal.
    pub progress: bool,
}

impl Stages {
    /// Runs a stage and takes its time.
    pub fn run<T>(&mut self, name: &'static str, work: impl FnOnce() -> T) -> T {
        let spinner = self.progress.then(|| {
            let style = ProgressStyle::with_template("{spinner} {msg} {elapsed}");
            let bar = ProgressBar::new_spinner().with_message(name);
            if let Ok(style) = style {
                bar.set_style(style);
            }
            bar.enable_steady_tick(Duration::from_millis(100));
            bar
        });
        let start = Instant::now();
        let value = work();
        self.times.push((name, start.elapsed()));
        if let Some(bar) = spinner {
            bar.finish_and_clear();
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
