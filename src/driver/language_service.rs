//! `impellerc lsp`: the language service for editors, by the language server protocol 3.17.
//!
//! Messages are answered in the order in which they come. After a change the front end reads the whole text anew, which takes
//! some milliseconds. When a file is opened or saved, a thread judges the file as `impellerc check` does; what it finds is
//! published only while the text is still the one that was judged.

use super::{DiskFiles, Options, RunOptions, Stages, check};
use crate::diag::{Diag, Fix, Severity};
use crate::language::{self, JOB, Position, Positions, Understood};
use crate::source::{SourceId, SourceMap, Span};
use lsp_server::{Connection, ErrorCode, Message, Notification, Request, RequestId, Response};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A text that an editor has open.
#[derive(Debug)]
struct Document {
    text: String,
    version: i64,
    path: PathBuf,
    understood: Understood,
    /// True when the text changed since the front end read it.
    changed: bool,
    judged: Arc<Mutex<FileJudgement>>,
}

/// What the thread that judges a file and the service share. Diagnostics are sent while it is locked, so that those of an
/// older text never come last.
#[derive(Debug, Default)]
struct FileJudgement {
    /// Version of the text that the editor has; `None` when the file was closed.
    version: Option<i64>,
    /// The text that the editor had when it asked for the last time, where no thread has taken it yet.
    wanted: Option<String>,
    running: bool,
}

/// The open texts.
struct Service<'c> {
    connection: &'c Connection,
    library: Option<PathBuf>,
    documents: BTreeMap<String, Document>,
}

fn lock(judged: &Mutex<FileJudgement>) -> MutexGuard<'_, FileJudgement> {
    judged.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Serves an editor until it ends the service.
///
/// # Errors
/// A connection that breaks, or messages out of the order of the protocol.
pub fn serve(connection: &Connection, library: Option<PathBuf>) -> Result<(), String> {
    let capabilities = json!({
        "positionEncoding": "utf-16",
        "textDocumentSync": { "openClose": true, "change": 2, "save": true },
        "completionProvider": { "triggerCharacters": ["\""] },
        "hoverProvider": true,
        "definitionProvider": true,
        "documentSymbolProvider": true,
        "foldingRangeProvider": true,
        "documentFormattingProvider": true,
        "codeActionProvider": { "codeActionKinds": ["quickfix"] },
    });
    let (id, _) = connection.initialize_start().map_err(|e| e.to_string())?;
    let server = json!({ "name": "impellerc", "version": env!("CARGO_PKG_VERSION") });
    connection
        .initialize_finish(id, json!({ "capabilities": capabilities, "serverInfo": server }))
        .map_err(|e| e.to_string())?;
    let mut service = Service { connection, library, documents: BTreeMap::new() };
    while let Ok(message) = connection.receiver.recv() {
        let mut next = Some(message);
        // All changes that wait are taken before the text is read.
        while let Some(message) = next {
            match message {
                Message::Request(request) => {
                    if connection.handle_shutdown(&request).map_err(|e| e.to_string())? {
                        return Ok(());
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

impl Service<'_> {
    fn send(&self, message: Message) -> Result<(), String> {
        self.connection.sender.send(message).map_err(|e| e.to_string())
    }

    /// Takes a notice of the editor.
    fn take(&mut self, notice: &Notification) -> Result<(), String> {
        let document = &notice.params["textDocument"];
        let Some(uri) = document["uri"].as_str() else { return Ok(()) };
        match notice.method.as_str() {
            "textDocument/didOpen" => {
                let text = document["text"].as_str().unwrap_or_default().to_owned();
                self.open(uri, text, document["version"].as_i64().unwrap_or(0));
                self.read_changed()?;
                self.judge(uri);
            }
            "textDocument/didChange" => {
                if let Some(open) = self.documents.get_mut(uri) {
                    let changes = notice.params["contentChanges"].as_array();
                    changes.into_iter().flatten().for_each(|change| open.text = changed(&open.text, change));
                    open.version = document["version"].as_i64().unwrap_or(open.version + 1);
                    open.changed = true;
                }
            }
            "textDocument/didSave" => {
                self.read_changed()?;
                self.judge(uri);
            }
            "textDocument/didClose" => {
                if let Some(closed) = self.documents.remove(uri) {
                    let mut judged = lock(&closed.judged);
                    judged.version = None;
                    self.send(published(uri, closed.version, &[]))?;
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn open(&mut self, uri: &str, text: String, version: i64) {
        let understood = Understood { sources: SourceMap::default(), tree: Default::default(), diags: Vec::new() };
        let document = Document { text, version, path: path(uri), understood, changed: true, judged: Arc::default() };
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
            document.understood = understood(&document.path, self.library.as_deref(), &name, &document.text);
            let mut judged = lock(&document.judged);
            judged.version = Some(document.version);
            let diags = diagnostics(&document.understood.diags, &document.understood.sources, &document.text, &uri);
            self.connection.sender.send(published(&uri, document.version, &diags)).map_err(|e| e.to_string())?;
        }
        Ok(())
    }

    /// Judges the file of a text in a thread of its own.
    fn judge(&self, uri: &str) {
        let Some(document) = self.documents.get(uri) else { return };
        {
            let mut judged = lock(&document.judged);
            judged.wanted = Some(document.text.clone());
            if judged.running {
                return;
            }
            judged.running = true;
        }
        let run = RunOptions { library: self.library.clone(), ..RunOptions::default() };
        let options = Options { job: document.path.clone(), run, ..Options::default() };
        let (uri, shared, sender) = (uri.to_owned(), Arc::clone(&document.judged), self.connection.sender.clone());
        std::thread::spawn(move || {
            loop {
                let (version, text) = {
                    let mut judged = lock(&shared);
                    let next = judged.version.zip(judged.wanted.take());
                    judged.running = next.is_some();
                    let Some(next) = next else { return };
                    next
                };
                let outcome = check(&options, &mut Stages::default());
                // An editor can show a text that is not saved: places of the file are not places of this text.
                let Some(file) = outcome.sources.get(JOB).filter(|file| file.text == text) else { continue };
                let diags = diagnostics(outcome.sink.diags(), &outcome.sources, &file.text, &uri);
                let judged = lock(&shared);
                // The editor is gone when nothing can be sent.
                if judged.version == Some(version) && sender.send(published(&uri, version, &diags)).is_err() {
                    return;
                }
            }
        });
    }

    fn answer(&self, request: Request) -> Result<(), String> {
        let Request { id, method, params } = request;
        let uri = params["textDocument"]["uri"].as_str().unwrap_or_default();
        let Some(document) = self.documents.get(uri) else {
            return self.send(refused(id, ErrorCode::InvalidParams, format!("`{uri}` is not open")));
        };
        let text = &document.text;
        let positions = Positions::new(text);
        let at = positions.byte(position(&params["position"]));
        let result = match method.as_str() {
            "textDocument/completion" => self.completion(document, &positions, at),
            "textDocument/hover" => language::meaning(&document.understood, text, at).map_or(Value::Null, |meaning| {
                let contents = json!({ "kind": "markdown", "value": meaning.text });
                json!({ "contents": contents, "range": range(&positions, meaning.range) })
            }),
            "textDocument/definition" => language::definition(&document.understood, text, at)
                .map_or(Value::Null, |found| json!({ "uri": uri, "range": range(&positions, found) })),
            "textDocument/documentSymbol" => outline(document, &positions),
            "textDocument/foldingRange" => {
                let fold = |fold: Range<usize>| {
                    let [from, to] = positions.range(fold);
                    json!({ "startLine": from.line, "endLine": to.line.saturating_sub(1) })
                };
                language::folds(text).into_iter().map(fold).collect()
            }
            "textDocument/formatting" => formatting(text, &positions),
            "textDocument/codeAction" => {
                let asked = [position(&params["range"]["start"]), position(&params["range"]["end"])];
                actions(document, &positions, uri, asked)
            }
            _ => return self.send(refused(id, ErrorCode::MethodNotFound, format!("no method `{method}`"))),
        };
        self.send(Message::Response(Response::new_ok(id, result)))
    }

    fn completion(&self, document: &Document, positions: &Positions<'_>, at: usize) -> Value {
        let Ok(mut files) = DiskFiles::new(&document.path, self.library.as_deref(), None) else { return Value::Null };
        let (word, words) = language::words_at(&document.text, at, &mut files);
        let place = range(positions, word);
        let item = |word: String| json!({ "label": word, "textEdit": { "range": place, "newText": word } });
        words.into_iter().map(item).collect()
    }
}

/// The text as the front end sees it; without the folder of the file nothing but the shipped library is found.
fn understood(path: &Path, library: Option<&Path>, name: &str, text: &str) -> Understood {
    match DiskFiles::new(path, library, None) {
        Ok(mut files) => language::understand(name, text, &mut files),
        Err(_) => language::understand(name, text, &mut crate::job::InMemory::default()),
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

fn position(value: &Value) -> Position {
    let number = |key: &str| value[key].as_u64().and_then(|n| usize::try_from(n).ok()).unwrap_or(0);
    Position { line: number("line"), column: number("character") }
}

fn range(positions: &Positions<'_>, bytes: Range<usize>) -> Value {
    let [start, end] = positions.range(bytes).map(|at| json!({ "line": at.line, "character": at.column }));
    json!({ "start": start, "end": end })
}

/// The path of the file of an address such as `file:///home/me/a%20job.imp`.
fn path(uri: &str) -> PathBuf {
    let Some(path) = uri.strip_prefix("file://") else { return PathBuf::from(uri) };
    let mut bytes = Vec::new();
    let mut rest = path.as_bytes();
    while let Some((byte, behind)) = rest.split_first() {
        let code = behind.get(..2).and_then(|d| u8::from_str_radix(std::str::from_utf8(d).ok()?, 16).ok());
        match code.filter(|_| *byte == b'%') {
            Some(code) => (bytes.push(code), rest = &behind[2..]),
            None => (bytes.push(*byte), rest = behind),
        };
    }
    let path = String::from_utf8_lossy(&bytes).into_owned();
    // `/C:/jobs` of Windows.
    let drive = path.as_bytes().get(2) == Some(&b':') && path.starts_with('/');
    PathBuf::from(if drive { &path[1..] } else { &path })
}

/// The address of a file.
fn address(path: &Path) -> String {
    let mut text = String::from("file://");
    for byte in path.display().to_string().replace('\\', "/").bytes() {
        if byte.is_ascii_alphanumeric() || b"/-_.~".contains(&byte) {
            text.push(char::from(byte));
        } else {
            text.push_str(&format!("%{byte:02X}"));
        }
    }
    text
}

fn published(uri: &str, version: i64, diagnostics: &[Value]) -> Message {
    let params = json!({ "uri": uri, "version": version, "diagnostics": diagnostics });
    Message::Notification(Notification::new("textDocument/publishDiagnostics".to_owned(), params))
}

fn refused(id: RequestId, code: ErrorCode, reason: String) -> Message {
    Message::Response(Response::new_err(id, code as i32, reason))
}

/// Diagnostics in the form of the protocol. One that belongs to another file stands at the first line of the job.
fn diagnostics(diags: &[Diag], sources: &SourceMap, text: &str, uri: &str) -> Vec<Value> {
    let positions = Positions::new(text);
    let one = |diag: &Diag| {
        let at = diag.labels.iter().map(|label| label.span).find(|span| span.source == JOB);
        let severity = match diag.severity {
            Severity::Error => 1,
            Severity::Warning => 2,
            Severity::Remark => 3,
        };
        let behind = diag.notes.iter().cloned().chain(diag.help.iter().map(|help| format!("help: {help}")));
        let message = std::iter::once(diag.message.clone()).chain(behind).collect::<Vec<_>>().join("\n");
        let related: Vec<Value> =
            diag.labels.iter().filter_map(|label| related(label.span, &label.text, sources, uri)).collect();
        json!({
            "range": range(&positions, at.map_or(0..0, Span::range)),
            "severity": severity,
            "code": diag.code.id(),
            "source": "impellerc",
            "message": message,
            "relatedInformation": related,
        })
    };
    diags.iter().map(one).collect()
}

/// A label with its file.
fn related(span: Span, label: &str, sources: &SourceMap, uri: &str) -> Option<Value> {
    let file = sources.get(span.source)?;
    let place = range(&Positions::new(&file.text), span.range());
    let address = if span.source == SourceId::default() { uri.to_owned() } else { address(file.disk.as_ref()?) };
    Some(json!({ "location": { "uri": address, "range": place }, "message": label }))
}

fn outline(document: &Document, positions: &Positions<'_>) -> Value {
    let symbol = |item: language::Outlined| {
        let place = range(positions, item.range);
        // A module, in the words of the protocol.
        json!({ "name": item.name, "kind": 2, "range": place, "selectionRange": place })
    };
    language::outline(&document.understood.tree).into_iter().map(symbol).collect()
}

/// The edit that gives a text its usual form; none where it has faults.
fn formatting(text: &str, positions: &Positions<'_>) -> Value {
    let formatted = crate::syntax::format(text, JOB, &mut crate::diag::Sink::default());
    match formatted {
        Ok(new) if new != text => json!([{ "range": range(positions, 0..text.len()), "newText": new }]),
        Ok(_) => json!([]),
        Err(_) => Value::Null,
    }
}

/// Changes that remove the faults in a range.
fn actions(document: &Document, positions: &Positions<'_>, uri: &str, asked: [Position; 2]) -> Value {
    let [from, to] = asked.map(|at| positions.byte(at));
    let touches = |diag: &Diag| {
        diag.labels.iter().any(|l| l.span.source == JOB && l.span.range().start <= to && from <= l.span.range().end)
    };
    let action = |diag: &Diag, fix: &Fix| {
        let edit = json!({ "range": range(positions, fix.span.range()), "newText": fix.replacement });
        let title = diag.help.clone().unwrap_or_else(|| format!("write `{}`", fix.replacement));
        json!({ "title": title, "kind": "quickfix", "isPreferred": true, "edit": { "changes": { uri: [edit] } } })
    };
    let diags = document.understood.diags.iter().filter(|diag| touches(diag));
    diags.filter_map(|diag| Some(action(diag, diag.fix.as_ref().filter(|fix| fix.span.source == JOB)?))).collect()
}
