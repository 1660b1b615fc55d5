//! Progress of long work, for display, and the request to cancel it.
//!
//! The stages count their steps here. The counters use neither terminals nor clocks, and no result depends on the
//! counts. Each work has its own counter, so that a share is the share of counted steps and not of estimated weights.
//!
//! Planning and verification look before each step whether they were cancelled. A cancelled run ends with an error and makes no
//! value. Steps take some hundredths of a second: an editor waits for the end of a cancelled run before it judges the next text.

use std::borrow::Cow;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// All works of a run, in the order in which they began.
#[derive(Debug, Default)]
pub struct Progress {
    works: Mutex<Vec<Arc<Counter>>>,
    cancelled: Arc<AtomicBool>,
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
