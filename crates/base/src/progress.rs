//! Progress of long work, for display, and the request to cancel it.
//!
//! The stages count their steps here. The counters use neither terminals nor clocks, and no result depends on the
//! counts. Who runs them may give a clock ([`Progress::timed`]): then each part of a stage has its times. Each work has its own
//! counter, so that a share is the share of counted steps and not of estimated weights.
//!
//! Planning and verification look before each step whether they were cancelled. A cancelled run ends with an error and makes no
//! value. Steps take some hundredths of a second: an editor waits for the end of a cancelled run before it judges the next text.

use core::time::Duration;
use std::borrow::Cow;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// All works of a run, in the order in which they began.
#[derive(Debug, Default)]
pub struct Progress {
    works: Mutex<Vec<Arc<Counter>>>,
    cancelled: Arc<AtomicBool>,
    clock: Option<fn() -> RunTime>,
    spans: Mutex<Vec<Span>>,
}

/// Time since a fixed moment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RunTime {
    /// Of the clock.
    pub clock: Duration,
    /// Of the processor, all threads together.
    pub processor: Duration,
}

impl RunTime {
    /// The time from an earlier moment to this one.
    pub fn since(self, earlier: Self) -> Self {
        Self {
            clock: self.clock.saturating_sub(earlier.clock),
            processor: self.processor.saturating_sub(earlier.processor),
        }
    }

    /// Both times together.
    pub fn and(self, other: Self) -> Self {
        Self { clock: self.clock + other.clock, processor: self.processor + other.processor }
    }
}

/// A part of a stage that has ended: a pass of the planner, a check of the verifier.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Span {
    /// Its name.
    pub name: &'static str,
    /// The time that it took; of parts of one name the sum.
    pub time: RunTime,
}

/// State of a work.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct State {
    /// Name of the work.
    pub name: Cow<'static, str>,
    /// Steps done so far; never decreases.
    pub done: u64,
    /// Total number of steps.
    pub total: u64,
    /// Whether the work continues.
    pub open: bool,
}

impl State {
    /// Share done, 0 to 1. Work without any step counts as done.
    pub fn share(&self) -> f64 {
        if self.total == 0 { 1.0 } else { (self.done as f64 / self.total as f64).min(1.0) }
    }
}

#[derive(Debug)]
struct Counter {
    name: Cow<'static, str>,
    done: AtomicU64,
    total: u64,
    open: AtomicBool,
}

impl Counter {
    fn state(&self) -> State {
        State {
            name: self.name.clone(),
            // Counts order no other memory accesses: relaxed order is enough.
            done: self.done.load(Ordering::Relaxed),
            total: self.total,
            open: self.open.load(Ordering::Relaxed),
        }
    }
}

impl Progress {
    /// Cancels the run; any thread may do so.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// True after the run was cancelled.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// Begins work with `total` steps. The work lasts until the returned value is dropped.
    pub fn begin(&self, name: impl Into<Cow<'static, str>>, total: usize) -> Work {
        let counter = Arc::new(Counter {
            name: name.into(),
            done: AtomicU64::new(0),
            total: u64::try_from(total).unwrap_or(u64::MAX),
            open: AtomicBool::new(true),
        });
        self.works.lock().unwrap_or_else(PoisonError::into_inner).push(Arc::clone(&counter));
        Work { counter, cancelled: Arc::clone(&self.cancelled) }
    }

    /// Progress with a clock.
    pub fn timed(clock: fn() -> RunTime) -> Self {
        Self { clock: Some(clock), ..Self::default() }
    }

    /// Does a part of the stage, whose time counts under a name. Parts do not contain each other.
    pub fn span<T>(&self, name: &'static str, part: impl FnOnce() -> T) -> T {
        let Some(clock) = self.clock else { return part() };
        let start = clock();
        let value = part();
        self.took(name, clock().since(start));
        value
    }

    fn took(&self, name: &'static str, time: RunTime) {
        let mut spans = self.spans.lock().unwrap_or_else(PoisonError::into_inner);
        match spans.iter_mut().find(|span| span.name == name) {
            Some(span) => span.time = span.time.and(time),
            None => spans.push(Span { name, time }),
        }
    }

    /// The parts that have ended, in the order in which they first ended; none without a clock.
    pub fn spans(&self) -> Vec<Span> {
        self.spans.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// The work that began last among those that still last.
    pub fn current(&self) -> Option<State> {
        self.all().into_iter().rfind(|s| s.open)
    }

    /// All works in the order in which they began.
    pub fn all(&self) -> Vec<State> {
        self.works.lock().unwrap_or_else(PoisonError::into_inner).iter().map(|c| c.state()).collect()
    }
}

/// Work in progress; any thread may count its steps.
#[derive(Debug)]
pub struct Work {
    counter: Arc<Counter>,
    cancelled: Arc<AtomicBool>,
}

impl Work {
    /// Counts steps done.
    pub fn advance(&self, steps: usize) {
        self.counter.done.fetch_add(u64::try_from(steps).unwrap_or(u64::MAX), Ordering::Relaxed);
    }

    /// True after the run was cancelled: what remains of the work makes no value that anybody sees.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// Does a step and counts it; `None` after the run was cancelled, so that collected steps end there.
    pub fn do_step<T>(&self, step: impl FnOnce() -> T) -> Option<T> {
        (!self.is_cancelled()).then(|| self.step(step()))
    }

    /// Counts a step within a chain of calls and returns the value.
    pub fn step<T>(&self, value: T) -> T {
        self.advance(1);
        value
    }

    /// Passes a stream to `work` in pieces of at most `size` items (at least one), and counts each piece when the work
    /// on it has ended; work on a whole stream at once could not report its progress. `done` is the number of steps
    /// that are done before an item. At the end all steps are done. A cancelled run ends between two pieces.
    pub fn in_pieces<T>(
        &self,
        items: impl IntoIterator<Item = T>,
        size: usize,
        done: impl Fn(&T) -> usize,
        mut work: impl FnMut(Vec<T>),
    ) {
        let mut items = items.into_iter();
        loop {
            let piece: Vec<T> = items.by_ref().take(size.max(1)).collect();
            let Some(reached) = piece.last().map(&done).filter(|_| !self.is_cancelled()) else { break };
            work(piece);
            self.counter.done.fetch_max(u64::try_from(reached).unwrap_or(u64::MAX), Ordering::Relaxed);
        }
        self.rest_is_needless();
    }

    /// The remaining steps are not needed: the work ended early.
    pub fn rest_is_needless(&self) {
        self.counter.done.fetch_max(self.counter.total, Ordering::Relaxed);
    }
}

impl Drop for Work {
    fn drop(&mut self) {
        self.counter.open.store(false, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_one_name_count_together() {
        static READINGS: AtomicU64 = AtomicU64::new(0);
        // Each look at the clock is a second later than the one before, and the processor two.
        let clock = || {
            let seconds = READINGS.fetch_add(1, Ordering::Relaxed);
            RunTime { clock: Duration::from_secs(seconds), processor: Duration::from_secs(2 * seconds) }
        };
        let progress = Progress::timed(clock);
        assert_eq!(
            (progress.span("links", || 7), progress.span("axes", || 8), progress.span("links", || 9)),
            (7, 8, 9)
        );
        let times = |name, clock: u64| Span {
            name,
            time: RunTime { clock: Duration::from_secs(clock), processor: Duration::from_secs(2 * clock) },
        };
        assert_eq!(progress.spans(), [times("links", 2), times("axes", 1)]);
        let untimed = Progress::default();
        assert_eq!((untimed.span("links", || 7), untimed.spans()), (7, Vec::new()));
    }

    #[test]
    fn works_nest_and_count_for_themselves() {
        let progress = Progress::default();
        assert_eq!(progress.current(), None);
        let outer = progress.begin("outer", 4);
        outer.advance(1);
        {
            let inner = progress.begin("inner".to_owned(), 2);
            assert_eq!(inner.step(7), 7);
            let seen = progress.current().unwrap();
            assert_eq!((seen.name.as_ref(), seen.done, seen.total), ("inner", 1, 2));
            inner.rest_is_needless();
        }
        let seen = progress.current().unwrap();
        assert_eq!((seen.name.as_ref(), seen.share()), ("outer", 0.25));
        outer.advance(9);
        drop(outer);
        assert_eq!(progress.current(), None);
        let pieces = progress.begin("pieces", 10);
        let mut seen = Vec::new();
        // Twenty items, two per step.
        pieces.in_pieces(0..20, 6, |i| i / 2, |piece| seen.push((piece, progress.current().unwrap().done)));
        assert_eq!(seen.iter().map(|(_, done)| *done).collect::<Vec<_>>(), [0, 2, 5, 8]);
        assert_eq!(seen.into_iter().flat_map(|(piece, _)| piece).collect::<Vec<_>>(), (0..20).collect::<Vec<_>>());
        drop(pieces);
        // A cancelled run does no further step.
        let late = progress.begin("late", 3);
        assert_eq!(late.do_step(|| 7), Some(7));
        progress.cancel();
        assert_eq!(late.do_step(|| 7), None);
        assert_eq!((0..3).map(|i| late.do_step(|| i)).collect::<Option<Vec<_>>>(), None);
        late.in_pieces(0..3, 1, |i| *i, |_| panic!("a piece after the end"));
        drop(late);
        assert!(progress.all().iter().all(|s| s.share() == 1.0 && !s.open));
    }
}
