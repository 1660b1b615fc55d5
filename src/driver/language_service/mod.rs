//! `impellerc lsp`: the language service for editors, by the language server protocol 3.17.
//!
//! Messages are answered in the order in which they come. After a change the front end reads the whole text anew, which takes
//! some milliseconds. When a job is opened or saved, a thread judges the file as `impellerc check` does; when it is saved, the
//! thread plans and verifies it as well.

mod job_text;
mod judgement;
mod messages;
mod nc_text;

use super::{DiskFiles, FileStamps, Options, RunOptions};
use diagnostics::Sink;
use job::language::{self, Positions, Understood};
use job::{InMemory, LibraryFile};
use job_text::JobText;
use judgement::{Judgement, Wishes, judge, lock, token};
use lsp_server::{Connection, ErrorCode, Message, Notification, Request, Response};
use messages::{address, diagnostics, path, position, published, range, refused};
use nc_text::FilesOfText;
use serde_json::{Value, json};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::{Arc, Mutex};

/// What a text is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum TextKind {
    /// A job.
    Job,
    /// A file of the library.
    Library(LibraryFile),
    /// NC text, or a text that the service does not know.
    Nc,
}

impl TextKind {
    /// By the ending of the name and the folder: `machines/mine.toml`.
    fn of(path: &Path, language: &str) -> Self {
        let ends = |ending: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(ending));
        if language == "impeller" || ends("imp") {
            return Self::Job;
        }
        let folder = path.parent().and_then(Path::file_name).and_then(|name| name.to_str());
        match folder.and_then(LibraryFile::of_folder).filter(|_| ends("toml")) {
            Some(kind) => Self::Library(kind),
            None => Self::Nc,
        }
    }
}

/// A text that an editor has open.
#[derive(Debug)]
struct Document {
    kind: TextKind,
    text: String,
    version: i64,
    path: PathBuf,
    understood: Understood,
    /// True when the text changed since the front end read it.
    changed: bool,
    judgement: Arc<Mutex<Judgement>>,
    /// What is known of NC text, after the first request.
    nc: RefCell<Option<Rc<FilesOfText>>>,
}

/// The open texts.
struct Service {
    send: Arc<judgement::Send>,
    library: Option<PathBuf>,
    wishes: Wishes,
    documents: BTreeMap<String, Document>,
}

/// What the service can do, in the form of the protocol.
fn capabilities() -> Value {
    json!({
        "positionEncoding": "utf-16",
        "textDocumentSync": { "openClose": true, "change": 2, "save": true },
        "completionProvider": { "triggerCharacters": ["\""] },
        "hoverProvider": true,
        "definitionProvider": true,
        "referencesProvider": true,
        "renameProvider": { "prepareProvider": true },
        "documentSymbolProvider": true,
        "foldingRangeProvider": true,
        "documentFormattingProvider": true,
        "codeActionProvider": { "codeActionKinds": ["quickfix"] },
        "inlayHintProvider": true,
        "codeLensProvider": {},
    })
}

/// Serves an editor until it ends the service.
///
/// # Errors
/// A connection that breaks, or messages out of the order of the protocol.
pub fn serve(connection: &Connection, library: Option<PathBuf>) -> Result<(), String> {
    let (id, offered) = connection.initialize_start().map_err(|e| e.to_string())?;
    let server = json!({ "name": "impellerc", "version": env!("CARGO_PKG_VERSION") });
    connection
        .initialize_finish(id, json!({ "capabilities": capabilities(), "serverInfo": server }))
        .map_err(|e| e.to_string())?;
    let can = |path: &str| offered.pointer(path).and_then(Value::as_bool);
    let wishes = Wishes {
        progress: can("/capabilities/window/workDoneProgress").unwrap_or(false),
        lenses: can("/capabilities/workspace/codeLens/refreshSupport").unwrap_or(false),
        verify: can("/initializationOptions/verifyOnSave").unwrap_or(true),
    };
    let sender = connection.sender.clone();
    let send: Arc<judgement::Send> = Arc::new(move |message| sender.send(message).is_ok());
    let mut service = Service { send, library, wishes, documents: BTreeMap::new() };
    while let Ok(message) = connection.receiver.recv() {
        let mut next = Some(message);
        // All changes that wait are taken before the text is read.
        while let Some(message) = next {
            match message {
                Message::Request(request) => {
                    if request.method == "shutdown" {
                        return service.shut_down(connection, request);
                    }
                    service.read_changed()?;
                    service.answer(request)?;
                }
                Message::Notification(notification) => service.take(&notification)?,
                Message::Response(_) => {}
            }
            next = connection.receiver.try_recv().ok();
        }
        service.read_changed()?;
    }
    Ok(())
}

impl Service {
    /// Ends the work, and waits for the notice with which the editor ends the service. Answers of the editor to earlier
    /// requests may still come.
    fn shut_down(&self, connection: &Connection, request: Request) -> Result<(), String> {
        self.documents.values().for_each(|document| {
            let mut judgement = lock(&document.judgement);
            judgement.version = None;
            judgement.cancel();
        });
        self.send(Message::Response(Response::new_ok(request.id, Value::Null)))?;
        while let Ok(message) = connection.receiver.recv() {
            match message {
                Message::Notification(notice) if notice.method == "exit" => return Ok(()),
                Message::Request(request) => {
                    let reason = "the service is shut down".to_owned();
                    self.send(refused(request.id, ErrorCode::InvalidRequest, reason))?;
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn send(&self, message: Message) -> Result<(), String> {
        if (self.send)(message) { Ok(()) } else { Err("the editor is gone".to_owned()) }
    }

    /// Takes a notice of the editor.
    fn take(&mut self, notice: &Notification) -> Result<(), String> {
        if notice.method == "window/workDoneProgress/cancel" {
            let cancelled = notice.params["token"].as_str().unwrap_or_default();
            let of_token = self.documents.iter().filter(|(uri, _)| token(uri) == cancelled);
            of_token.for_each(|(_, document)| lock(&document.judgement).cancel());
            return Ok(());
        }
        let document = &notice.params["textDocument"];
        let Some(uri) = document["uri"].as_str() else { return Ok(()) };
        match notice.method.as_str() {
            "textDocument/didOpen" => {
                let text = document["text"].as_str().unwrap_or_default().to_owned();
                let language = document["languageId"].as_str().unwrap_or_default();
                self.open(uri, text, document["version"].as_i64().unwrap_or(0), language);
                self.read_changed()?;
                self.judge(uri, false);
            }
            "textDocument/didChange" => {
                if let Some(open) = self.documents.get_mut(uri) {
                    let changes = notice.params["contentChanges"].as_array();
                    changes.into_iter().flatten().for_each(|change| open.text = changed(&open.text, change));
                    open.version = document["version"].as_i64().unwrap_or(open.version + 1);
                    open.changed = true;
                    open.nc = RefCell::default();
                }
            }
            "textDocument/didSave" => {
                // A file of the library may be one of those that the open jobs read.
                if self.documents.get(uri).is_some_and(|saved| saved.kind != TextKind::Job) {
                    self.documents.values_mut().for_each(|document| document.changed |= document.kind == TextKind::Job);
                }
                self.read_changed()?;
                self.judge(uri, true);
            }
            "textDocument/didClose" => {
                if let Some(closed) = self.documents.remove(uri) {
                    let mut judgement = lock(&closed.judgement);
                    judgement.version = None;
                    judgement.cancel();
                    self.send(published(uri, closed.version, &[]))?;
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn open(&mut self, uri: &str, text: String, version: i64, language: &str) {
        let path = path(uri);
        let kind = TextKind::of(&path, language);
        let understood = language::understand("", "", &mut InMemory::default());
        let (judgement, nc) = (Arc::default(), RefCell::default());
        let document = Document { kind, text, version, path, understood, changed: true, judgement, nc };
        self.documents.insert(uri.to_owned(), document);
    }

    /// Reads the texts that changed and publishes what the front end says of them.
    fn read_changed(&mut self) -> Result<(), String> {
        let changed: Vec<String> =
            self.documents.iter().filter(|(_, d)| d.changed).map(|(uri, _)| uri.clone()).collect();
        for uri in changed {
            let Some(document) = self.documents.get_mut(&uri) else { continue };
            document.changed = false;
            let name = document.path.display().to_string();
            let mut library_sink = Sink::default();
            let diags = match document.kind {
                TextKind::Job => {
                    document.understood = understood(document, self.library.as_deref(), &name);
                    diagnostics(&document.understood.diags, &document.understood.sources, &document.text, &uri)
                }
                TextKind::Library(kind) => {
                    let sources = job::read_library_file(kind, &name, &document.text, &mut library_sink);
                    diagnostics(library_sink.diags(), &sources, &document.text, &uri)
                }
                TextKind::Nc => Vec::new(),
            };
            let mut judgement = lock(&document.judgement);
            judgement.version = Some(document.version);
            if !(self.send)(published(&uri, document.version, &diags)) {
                return Err("the editor is gone".to_owned());
            }
        }
        Ok(())
    }

    /// Judges the file of a job in a thread of its own.
    fn judge(&self, uri: &str, saved: bool) {
        let Some(document) = self.documents.get(uri).filter(|document| document.kind == TextKind::Job) else { return };
        let run = RunOptions { library: self.library.clone(), ..RunOptions::default() };
        let options = Options { job: document.path.clone(), run, ..Options::default() };
        let send = Arc::downgrade(&self.send);
        judge(&document.judgement, &document.text, saved, uri, options, send, self.wishes);
    }

    fn answer(&self, request: Request) -> Result<(), String> {
        let Request { id, method, params } = request;
        let uri = params["textDocument"]["uri"].as_str().unwrap_or_default();
        let Some(document) = self.documents.get(uri) else {
            return self.send(refused(id, ErrorCode::InvalidParams, format!("`{uri}` is not open")));
        };
        let positions = Positions::new(&document.text);
        let answer = match document.kind {
            TextKind::Job => {
                JobText { uri, document, positions, library: self.library.as_deref() }.answer(&method, &params)
            }
            TextKind::Nc => Ok(of_nc(document, &positions, &method, &params)),
            TextKind::Library(_) => Ok(method.starts_with("textDocument/").then_some(Value::Null)),
        };
        self.send(match answer {
            Ok(Some(result)) => Message::Response(Response::new_ok(id, result)),
            Ok(None) => refused(id, ErrorCode::MethodNotFound, format!("no method `{method}`")),
            Err(reason) => refused(id, ErrorCode::RequestFailed, reason),
        })
    }
}

/// The answer to a question about NC text.
fn of_nc(document: &Document, positions: &Positions<'_>, method: &str, params: &Value) -> Option<Value> {
    let line = position(&params["position"]).line;
    let nc = || {
        let mut known = document.nc.borrow_mut();
        let last = known.take().filter(|nc| nc.holds(&document.path));
        let nc = last.unwrap_or_else(|| Rc::new(FilesOfText::new(&document.path, &document.text)));
        Rc::clone(known.insert(nc))
    };
    match method {
        "textDocument/hover" => Some(nc().meaning(line).map_or(Value::Null, |text| {
            let start = positions.byte(language::Position { line, column: 0 });
            let end = positions.byte(language::Position { line, column: usize::MAX });
            let contents = json!({ "kind": "markdown", "value": text });
            json!({ "contents": contents, "range": range(positions, start..end) })
        })),
        "textDocument/definition" => Some(nc().job_line(line).map_or(Value::Null, |(job, line)| {
            let start = json!({ "line": line, "character": 0 });
            json!({ "uri": address(&job), "range": { "start": start, "end": start } })
        })),
        method => method.starts_with("textDocument/").then_some(Value::Null),
    }
}

/// The text as the front end sees it; without the folder of the file nothing but the shipped library is found.
fn understood(document: &Document, library: Option<&Path>, name: &str) -> Understood {
    match DiskFiles::new(&document.path, library, None) {
        Ok(mut files) => language::understand(name, &document.text, &mut files),
        Err(_) => language::understand(name, &document.text, &mut InMemory::default()),
    }
}

/// The text after a change of the editor.
fn changed(text: &str, change: &Value) -> String {
    let new = change["text"].as_str().unwrap_or_default();
    let Some(place) = change.get("range").filter(|range| !range.is_null()) else { return new.to_owned() };
    let positions = Positions::new(text);
    let [start, end] = ["start", "end"].map(|end| positions.byte(position(&place[end])));
    format!("{}{new}{}", &text[..start], &text[end.max(start)..])
}
