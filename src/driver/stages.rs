//! The stages of a run: their times, their display on a terminal, and the values that can be printed.

use base::progress::{Progress, RunTime, Span, State};
use diagnostics::Aborted;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, LazyLock, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// A run as other threads see it: the stage that lasts, and the request to end the run.
#[derive(Debug, Default)]
pub struct RunState {
    stage: Mutex<Option<(&'static str, Arc<Progress>)>>,
    cancelled: AtomicBool,
}

impl RunState {
    fn stage_now(&self) -> MutexGuard<'_, Option<(&'static str, Arc<Progress>)>> {
        self.stage.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Ends the run: it makes no value and writes no file. Work that cannot be left is done to its end first.
    pub fn cancel(&self) {
        // The stage is locked, so that none begins between the two.
        let stage = self.stage_now();
        self.cancelled.store(true, Ordering::Relaxed);
        if let Some((_, progress)) = &*stage {
            progress.cancel();
        }
    }

    /// True after the run was cancelled.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// The stage that lasts with its current work, and the share of this work that is done, 0 to 1.
    pub fn stage(&self) -> Option<(String, Option<f64>)> {
        let (name, progress) = self.stage_now().clone()?;
        let work = progress.current();
        let text = work.as_ref().map_or_else(|| name.to_owned(), |work| format!("{name}: {}", work.name));
        Some((text, work.map(|work| work.share())))
    }

    /// A stage begins.
    fn enter(&self, name: &'static str, progress: &Arc<Progress>) {
        let mut stage = self.stage_now();
        if self.is_cancelled() {
            progress.cancel();
        }
        *stage = Some((name, Arc::clone(progress)));
    }
}

/// A stage that ran.
#[derive(Debug)]
struct StageTime {
    name: &'static str,
    time: RunTime,
    /// Its parts.
    spans: Vec<Span>,
}

/// Times of the stages that ran.
#[derive(Debug, Default)]
pub struct Stages {
    times: Vec<StageTime>,
    /// Show long stages on standard error. Only for a terminal: a pipe should receive no such text.
    pub progress: bool,
    state: Arc<RunState>,
}

/// Time after which a stage is shown; shorter stages would flicker.
const SHOWN_AFTER: Duration = Duration::from_secs(1);

/// Time between two images of the spinner.
const SPINNER_INTERVAL: Duration = Duration::from_millis(100);

/// Template of the line of a stage.
const LINE_TEMPLATE: &str = "{spinner} {prefix:>2} {elapsed_precise} {msg}";

/// Columns of the bar; the whole line fits into 80 columns.
const BAR_COLUMNS: usize = 24;

/// Name of a stage, with the share of its current work where this is known. Both are set as one text: if they were set
/// one after the other, the name of one work could be shown with the share of another for a moment.
fn line(stage: &str, work: Option<&State>) -> String {
    let Some(work) = work else { return stage.to_owned() };
    let (share, name) = (work.share(), format!("{stage}: {}", work.name));
    let full = (share * BAR_COLUMNS as f64) as usize;
    format!("{name:<30.30} [{}{}] {:>3.0} %", "#".repeat(full), ".".repeat(BAR_COLUMNS - full), (100.0 * share).floor())
}

/// The line of a stage, shown from [`SHOWN_AFTER`] on until the stage ends.
struct StageLine {
    /// Dropped when the stage ends.
    running: Sender<()>,
    thread: JoinHandle<()>,
}

impl StageLine {
    /// `number` counts the stages from 1. `None` when no thread can be started; then nothing is shown.
    fn start(name: &'static str, number: usize, progress: Option<Arc<Progress>>) -> Option<Self> {
        let (running, ended) = channel();
        let start = Instant::now();
        let draw = move || {
            if ended.recv_timeout(SHOWN_AFTER) != Err(RecvTimeoutError::Timeout) {
                return;
            }
            let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
            let bar = bar.with_prefix(number.to_string()).with_elapsed(start.elapsed());
            if let Ok(style) = ProgressStyle::with_template(LINE_TEMPLATE) {
                bar.set_style(style);
            }
            while ended.recv_timeout(SPINNER_INTERVAL) == Err(RecvTimeoutError::Timeout) {
                bar.set_message(line(name, progress.as_ref().and_then(|p| p.current()).as_ref()));
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
        // A thread that failed to draw does not stop the work.
        let _ = self.thread.join();
    }
}

impl Stages {
    /// Runs a stage and measures its time.
    pub fn run<T>(&mut self, name: &'static str, work: impl FnOnce() -> T) -> T {
        self.timed(name, None, work)
    }

    /// Runs a stage that reports its progress.
    pub fn watched<T>(&mut self, name: &'static str, work: impl FnOnce(&Progress) -> T) -> T {
        let (progress, state) = (Arc::new(Progress::timed(now)), self.state());
        state.enter(name, &progress);
        let value = self.timed(name, Some(Arc::clone(&progress)), || work(&progress));
        if let Some(stage) = self.times.last_mut() {
            stage.spans = progress.spans();
        }
        *state.stage_now() = None;
        value
    }

    /// What other threads see of the run.
    pub fn state(&self) -> Arc<RunState> {
        Arc::clone(&self.state)
    }

    /// Ends a run that was cancelled; nothing goes to the sink.
    pub(super) fn go_on(&self) -> Result<(), Aborted> {
        if self.state.is_cancelled() { Err(Aborted) } else { Ok(()) }
    }

    fn timed<T>(&mut self, name: &'static str, progress: Option<Arc<Progress>>, work: impl FnOnce() -> T) -> T {
        let shown = if self.progress { StageLine::start(name, self.times.len() + 1, progress) } else { None };
        let start = now();
        let value = work();
        self.times.push(StageTime { name, time: now().since(start), spans: Vec::new() });
        if let Some(shown) = shown {
            shown.end();
        }
        value
    }

    /// One line per stage and per part of it, with the times of clock and processor in seconds, and their sum.
    pub fn report(&self) -> String {
        let line = |name: &str, time: RunTime| {
            format!("{name:<26}{:>9.3} s {:>9.3} s\n", time.clock.as_secs_f64(), time.processor.as_secs_f64())
        };
        let mut out = format!("{:<26}{:>11} {:>11}\n", "", "clock", "processor");
        let mut sum = RunTime::default();
        for StageTime { name, time, spans } in &self.times {
            out.push_str(&line(name, *time));
            out.extend(spans.iter().map(|span| line(&format!("  {}", span.name), span.time)));
            sum = sum.and(*time);
        }
        out + &line("total", sum)
    }
}

/// The time of this program since it was first asked. Where the system does not tell the time of the processor, this is zero.
fn now() -> RunTime {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    RunTime { clock: START.elapsed(), processor: processor_time() }
}

#[cfg(unix)]
fn processor_time() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Duration::new(u64::try_from(time.tv_sec).unwrap_or(0), u32::try_from(time.tv_nsec).unwrap_or(0))
}

#[cfg(not(unix))]
fn processor_time() -> Duration {
    Duration::ZERO
}
