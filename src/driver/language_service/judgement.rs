//! Threads that judge a saved job: facts as in `impellerc check`, then planning and verification with progress.
//!
//! What a thread finds is published only while the editor still has the text that was judged. A new save cancels the
//! verification of the text before it.

use super::messages::{diagnostics, notice, published, request};
use super::{FileStamps, Options};
use crate::driver::{Outcome, RunState, Stages, check, compile};
use base::source::Span;
use diagnostics::Diag;
use job::language::JOB;
use lsp_server::Message;
use serde_json::{Value, json};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::time::Duration;
use verify::certificate::{ContractReport, OperationReport};

/// Sends a message to the editor; false when the editor is gone.
pub(super) type Send = dyn Fn(Message) -> bool + std::marker::Send + Sync;

/// What the editor can do, and what its user wants.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Wishes {
    /// It shows progress that the service begins.
    pub(super) progress: bool,
    /// It requests lenses again on notice.
    pub(super) lenses: bool,
    /// A saved job is planned and verified.
    pub(super) verify: bool,
}

/// What verification found of a text.
#[derive(Debug)]
pub(super) struct SavedProof {
    pub(super) text: String,
    pub(super) contracts: Vec<ContractReport>,
    /// Operations with their places in the job.
    pub(super) operations: Vec<(Span, OperationReport)>,
    /// Operation, and a decision of its planning.
    pub(super) notes: Vec<(String, String)>,
    /// The files that the run has read.
    files: FileStamps,
}

impl SavedProof {
    /// True for a text, while its files are as they were when it was verified.
    pub(super) fn is_of(&self, text: &str) -> bool {
        self.text == text && self.files.hold()
    }
}

/// What the facts say of a text.
#[derive(Debug)]
pub(super) struct Facts {
    pub(super) text: String,
    pub(super) diags: Vec<Diag>,
}

/// A text to be judged.
#[derive(Debug)]
struct Wanted {
    text: String,
    /// Its version.
    version: i64,
    /// Whether it is also planned and verified.
    verify: bool,
}

/// What the threads and the service share. Diagnostics are sent while it is locked, so that those of an older text never come
/// last.
#[derive(Debug, Default)]
pub(super) struct Judgement {
    /// Version of the text that the editor has; `None` when the file was closed.
    pub(super) version: Option<i64>,
    /// The text of the last request of the editor, where no thread has taken it yet.
    wanted: Option<Wanted>,
    running: bool,
    /// The verification that runs.
    run: Option<Arc<RunState>>,
    pub(super) facts: Option<Facts>,
    pub(super) proof: Option<SavedProof>,
}

pub(super) fn lock(judgement: &Mutex<Judgement>) -> MutexGuard<'_, Judgement> {
    judgement.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Judgement {
    /// Ends the verification that runs, and forgets what an earlier one found.
    pub(super) fn cancel(&mut self) {
        self.proof = None;
        self.run.iter().for_each(|run| run.cancel());
    }
}

/// The token of the progress of a file.
pub(super) fn token(uri: &str) -> String {
    format!("verify {uri}")
}

/// Judges a text of a saved file in a thread.
pub(super) fn judge(
    shared: &Arc<Mutex<Judgement>>,
    text: &str,
    saved: bool,
    uri: &str,
    options: Options,
    send: Weak<Send>,
    wishes: Wishes,
) {
    {
        let mut judgement = lock(shared);
        judgement.cancel();
        let Some(version) = judgement.version else { return };
        judgement.wanted = Some(Wanted { text: text.to_owned(), version, verify: saved && wishes.verify });
        if judgement.running {
            return;
        }
        judgement.running = true;
    }
    let judge = JobJudge { shared: Arc::clone(shared), uri: uri.to_owned(), options, send, wishes };
    std::thread::spawn(move || judge.run());
}

/// Runs something when it goes out of scope, also when the code before panics.
struct AtEnd<F: FnMut()>(F);

impl<F: FnMut()> Drop for AtEnd<F> {
    fn drop(&mut self) {
        (self.0)();
    }
}

/// One job is planned and verified at a time: each of them takes all processors and much memory.
static VERIFYING: Mutex<()> = Mutex::new(());

/// A thread that judges the texts of one file.
struct JobJudge {
    shared: Arc<Mutex<Judgement>>,
    uri: String,
    options: Options,
    /// Weak: the service does not wait for a thread that judges when its editor ends it.
    send: Weak<Send>,
    wishes: Wishes,
}

impl JobJudge {
    fn send(&self, message: Message) {
        if let Some(send) = self.send.upgrade() {
            send(message);
        }
    }

    fn run(&self) {
        // A thread that panicked does not keep the next one from running.
        let _ended = AtEnd(|| {
            if std::thread::panicking() {
                lock(&self.shared).running = false;
            }
        });
        loop {
            let wanted = {
                let mut judgement = lock(&self.shared);
                let Some(wanted) = judgement.wanted.take().filter(|_| judgement.version.is_some()) else {
                    // Inside of the lock: a text that is wanted from here on starts a thread of its own.
                    judgement.running = false;
                    return;
                };
                wanted
            };
            let facts = check(&self.options, &mut Stages::default());
            let sound = !facts.sink.has_errors();
            if self.publish(&facts, &wanted) && sound && wanted.verify {
                self.verify(&wanted);
            }
        }
    }

    /// Publishes what was found of a text, where the editor still has it. False where it has another one.
    fn publish(&self, outcome: &Outcome, Wanted { text, version, .. }: &Wanted) -> bool {
        // An editor can show a text that is not saved: places of the file are not places of this text.
        let Some(file) = outcome.sources.get(JOB).filter(|file| file.text == *text) else { return false };
        let diags = diagnostics(outcome.sink.diags(), &outcome.sources, &file.text, &self.uri);
        let mut judgement = lock(&self.shared);
        if judgement.version != Some(*version) {
            return false;
        }
        judgement.facts = Some(Facts { text: text.clone(), diags: outcome.sink.diags().to_vec() });
        self.send(published(&self.uri, *version, &diags));
        true
    }

    /// Plans and verifies the file.
    fn verify(&self, wanted: &Wanted) {
        let _alone = VERIFYING.lock().unwrap_or_else(PoisonError::into_inner);
        let mut stages = Stages::default();
        let state = stages.state();
        {
            let mut judgement = lock(&self.shared);
            if judgement.wanted.is_some() || judgement.version.is_none() {
                return;
            }
            judgement.run = Some(Arc::clone(&state));
        }
        let outcome = self.with_progress(&state, || compile(&self.options, &mut stages));
        lock(&self.shared).run = None;
        let of_text = outcome.sources.get(JOB).is_some_and(|file| file.text == wanted.text);
        if state.is_cancelled() || !of_text {
            return;
        }
        // An edit that is undone brings the verified text back: its proof is kept, whatever version the editor has.
        self.publish(&outcome, wanted);
        let files = FileStamps::of(&outcome);
        let Outcome { contracts, operations, notes, .. } = outcome;
        lock(&self.shared).proof = Some(SavedProof { text: wanted.text.clone(), contracts, operations, notes, files });
        if self.wishes.lenses {
            self.send(request(&format!("lenses {}", self.uri), "workspace/codeLens/refresh", Value::Null));
        }
    }

    /// Shows in the editor how far the work is.
    fn with_progress(&self, state: &RunState, work: impl FnOnce() -> Outcome) -> Outcome {
        if !self.wishes.progress {
            return work();
        }
        let token = token(&self.uri);
        let tell = |value: Value| self.send(notice("$/progress", json!({ "token": token, "value": value })));
        self.send(request(&token, "window/workDoneProgress/create", json!({ "token": token })));
        let name = self.options.job.file_name().map_or_else(String::new, |name| name.display().to_string());
        tell(json!({ "kind": "begin", "title": format!("impellerc: {name}"), "cancellable": true }));
        let ended = AtomicBool::new(false);
        let outcome = std::thread::scope(|threads| {
            let teller = threads.spawn(|| {
                let mut shown = String::new();
                while !ended.load(Ordering::Acquire) {
                    // The share is that of the current work, which begins at zero several times: a percentage of the protocol
                    // must not fall.
                    let now = state.stage().map(|(text, share)| match share {
                        Some(share) => format!("{text} {:.0} %", 100.0 * share),
                        None => text,
                    });
                    if let Some(now) = now.filter(|now| *now != shown) {
                        tell(json!({ "kind": "report", "message": now }));
                        shown = now;
                    }
                    std::thread::park_timeout(PROGRESS_INTERVAL);
                }
            });
            // Also when the work panics: otherwise the scope would wait for ever.
            let _ended = AtEnd(|| {
                ended.store(true, Ordering::Release);
                // A cancelled run does not wait for the next look.
                teller.thread().unpark();
            });
            work()
        });
        let verdict = outcome.emitted.as_deref().and_then(|text| text.lines().next());
        let message = if state.is_cancelled() { "cancelled" } else { verdict.unwrap_or("refused") };
        tell(json!({ "kind": "end", "message": message }));
        outcome
    }
}

/// Time between two reports of the progress.
const PROGRESS_INTERVAL: Duration = Duration::from_millis(200);
