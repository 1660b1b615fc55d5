//! Shares done of long work, for whoever wants to show them, and the wish to cancel it.
//!
//! Work counts its steps here; it knows neither terminals nor clocks, and nothing that it makes depends on the counts.
//! Each work counts by itself, so that a share is one of steps that were counted and not of guessed weights.
//!
//! Planning asks between its steps whether it was cancelled. A cancelled run ends with an error and makes no value.

use std::borrow::Cow;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Works of a run in the order in which they began.
#[derive(Debug, Default)]
pub struct Progress {
    works: Mutex<Vec<Arc<Counter>>>,
    cancelled: AtomicBool,
}

/// How far a work is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct State {
    /// What is being done.
    pub name: Cow<'static, str>,
    /// Steps done so far; never less than before.
    pub done: u64,
    /// Steps in all.
    pub total: u64,
    /// Whether it still goes on.
    pub open: bool,
}

impl State {
    /// Share done, 0 to 1. Work without any step is done.
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
            // Counts say nothing about other memory: relaxed order will do.
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

    /// True once the run was cancelled.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// Begins work of so many steps. It goes on until the value is dropped.
    pub fn begin(&self, name: impl Into<Cow<'static, str>>, total: usize) -> Work {
        let counter = Arc::new(Counter {
            name: name.into(),
            done: AtomicU64::new(0),
            total: u64::try_from(total).unwrap_or(u64::MAX),
            open: AtomicBool::new(true),
        });
        self.works.lock().unwrap_or_else(PoisonError::into_inner).push(Arc::clone(&counter));
        Work { counter }
    }

    /// The work that began last of those that go on.
    pub fn current(&self) -> Option<State> {
        self.all().into_iter().rfind(|s| s.open)
    }

    /// All works in the order in which they began.
    pub fn all(&self) -> Vec<State> {
        self.works.lock().unwrap_or_else(PoisonError::into_inner).iter().map(|c| c.state()).collect()
    }
}

/// Work that goes on; any thread may count its steps.
#[derive(Debug)]
pub struct Work {
    counter: Arc<Counter>,
}

impl Work {
    /// Counts steps done.
    pub fn advance(&self, steps: usize) {
        self.counter.done.fetch_add(u64::try_from(steps).unwrap_or(u64::MAX), Ordering::Relaxed);
    }

    /// Counts a step of a chain of calls and hands its value on.
    pub fn step<T>(&self, value: T) -> T {
        self.advance(1);
        value
    }

    /// Hands a stream on in pieces of at most `size` items (at least one), and counts a piece when the work on it has ended:
    /// what takes a stream as a whole cannot tell how far it is. `done` is the number of steps that are done before an
    /// item; in the end all are.
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
            let Some(reached) = piece.last().map(&done) else { break };
            work(piece);
            self.counter.done.fetch_max(u64::try_from(reached).unwrap_or(u64::MAX), Ordering::Relaxed);
        }
        self.rest_is_needless();
    }

    /// The steps that remain are not needed: the work ended early.
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
        // Twenty items, two for a step.
        pieces.in_pieces(0..20, 6, |i| i / 2, |piece| seen.push((piece, progress.current().unwrap().done)));
        assert_eq!(seen.iter().map(|(_, done)| *done).collect::<Vec<_>>(), [0, 2, 5, 8]);
        assert_eq!(seen.into_iter().flat_map(|(piece, _)| piece).collect::<Vec<_>>(), (0..20).collect::<Vec<_>>());
        drop(pieces);
        assert!(progress.all().iter().all(|s| s.share() == 1.0 && !s.open));
    }
}
