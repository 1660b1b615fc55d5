//! Values and messages in the form of the protocol.

use base::source::{SourceMap, Span};
use diagnostics::{Diag, Severity};
use job::language::{JOB, Position, Positions};
use lsp_server::{ErrorCode, Message, Notification, Request, RequestId, Response};
use serde_json::{Value, json};
use std::ops::Range;
use std::path::{Path, PathBuf};

pub(super) fn position(value: &Value) -> Position {
    let number = |key: &str| value[key].as_u64().and_then(|n| usize::try_from(n).ok()).unwrap_or(0);
    Position { line: number("line"), column: number("character") }
}

pub(super) fn range(positions: &Positions<'_>, bytes: Range<usize>) -> Value {
    let [start, end] = positions.range(bytes).map(|at| json!({ "line": at.line, "character": at.column }));
    json!({ "start": start, "end": end })
}

/// The path of the file of an address such as `file:///home/me/a%20job.imp`.
pub(super) fn path(uri: &str) -> PathBuf {
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
pub(super) fn address(path: &Path) -> String {
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

pub(super) fn published(uri: &str, version: i64, diagnostics: &[Value]) -> Message {
    notice("textDocument/publishDiagnostics", json!({ "uri": uri, "version": version, "diagnostics": diagnostics }))
}

pub(super) fn refused(id: RequestId, code: ErrorCode, reason: String) -> Message {
    Message::Response(Response::new_err(id, code as i32, reason))
}

/// Diagnostics in the form of the protocol. One that belongs to another file stands at the first line of the job.
pub(super) fn diagnostics(diags: &[Diag], sources: &SourceMap, text: &str, uri: &str) -> Vec<Value> {
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
            diag.labels.iter().filter_map(|label| related(label.span, &label.text, sources, uri, &positions)).collect();
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
fn related(span: Span, label: &str, sources: &SourceMap, uri: &str, positions: &Positions<'_>) -> Option<Value> {
    let (address, place) = if span.source == JOB {
        (uri.to_owned(), range(positions, span.range()))
    } else {
        let file = sources.get(span.source)?;
        (address(file.disk.as_ref()?), range(&Positions::new(&file.text), span.range()))
    };
    Some(json!({ "location": { "uri": address, "range": place }, "message": label }))
}

/// A notice to the editor.
pub(super) fn notice(method: &str, params: Value) -> Message {
    Message::Notification(Notification::new(method.to_owned(), params))
}

/// A request to the editor. Its answer says nothing that is needed.
pub(super) fn request(id: &str, method: &str, params: Value) -> Message {
    Message::Request(Request::new(RequestId::from(id.to_owned()), method.to_owned(), params))
}
