//! The language service, by the messages that an editor sends.

use impellerc::driver;
use lsp_server::{Connection, Message, Notification, Request, Response};
use proptest::prelude::*;
use proptest::strategy::ValueTree as _;
use proptest::test_runner::{Config, TestRunner};
use serde_json::{Value, json};
use std::path::Path;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

const JOB: &str = include_str!("../../jobs/wei2021/wei2021.imp");

/// An editor with one text.
struct Editor {
    connection: Connection,
    service: Option<JoinHandle<Result<(), String>>>,
    next: i32,
    /// Diagnostics that were published, with the version of their text, in the order in which they came.
    published: Vec<(i64, Value)>,
}

const URI: &str = "file:///no/such/folder/a%20job.imp";

impl Editor {
    fn new() -> Self {
        let (server, client) = Connection::memory();
        let service = std::thread::spawn(move || driver::serve(&server, None));
        let mut editor = Self { connection: client, service: Some(service), next: 0, published: Vec::new() };
        let found = editor.ask("initialize", json!({ "capabilities": {} }));
        assert_eq!(found["serverInfo"]["name"], "impellerc");
        editor.tell("initialized", json!({}));
        editor
    }

    fn tell(&self, method: &str, params: Value) {
        self.connection.sender.send(Notification::new(method.to_owned(), params).into()).unwrap();
    }

    fn ask(&mut self, method: &str, params: Value) -> Value {
        self.next += 1;
        let id = lsp_server::RequestId::from(self.next);
        self.connection.sender.send(Request::new(id.clone(), method.to_owned(), params).into()).unwrap();
        loop {
            match self.receive() {
                Message::Response(Response { id: of, response_result }) if of == id => {
                    return response_result.unwrap_or_else(|refused| json!({ "error": refused.message }));
                }
                _ => {}
            }
        }
    }

    fn receive(&mut self) -> Message {
        let message = self.connection.receiver.recv_timeout(Duration::from_secs(60)).unwrap();
        if let Message::Notification(Notification { method, params }) = &message
            && method == "textDocument/publishDiagnostics"
        {
            self.published.push((params["version"].as_i64().unwrap(), params["diagnostics"].clone()));
        }
        message
    }

    fn open(&mut self, uri: &str, text: &str) {
        self.tell(
            "textDocument/didOpen",
            json!({ "textDocument": { "uri": uri, "languageId": "impeller", "version": 1, "text": text } }),
        );
    }

    /// Diagnostics of the front end for a version of the text.
    fn of_version(&mut self, version: i64) -> Value {
        loop {
            if let Some((_, found)) = self.published.iter().find(|(of, _)| *of == version) {
                return found.clone();
            }
            self.receive();
        }
    }

    fn close(mut self) {
        self.ask("shutdown", Value::Null);
        self.tell("exit", Value::Null);
        self.service.take().unwrap().join().unwrap().unwrap();
    }
}

fn at(uri: &str, text: &str, word: &str, offset: usize) -> Value {
    let byte = text.find(word).unwrap_or_else(|| panic!("no {word}")) + offset;
    let before = &text[..byte];
    let column: usize = before.rsplit('\n').next().unwrap().chars().map(char::len_utf16).sum();
    json!({ "textDocument": { "uri": uri }, "position": { "line": before.matches('\n').count(), "character": column } })
}

fn labels(found: &Value) -> Vec<&str> {
    found.as_array().unwrap().iter().map(|item| item["label"].as_str().unwrap()).collect()
}

/// Words are those of the compiler at each place: items, properties, values, units, names of the job and of the library.
#[test]
fn words_are_offered_where_the_compiler_knows_them() {
    let mut editor = Editor::new();
    let text = "edition 2026\nuse machine \"5mc850-c\"\nuse tools \"carbide\"\nlet gap = 2 mm\n\
        tool t1 = ball { diameter 6 mm  flutes 4  flute 30 mm  reach 50 mm  holder \"er16-mini\" }\n\
        operation flank {\n  tool t1  speed 8000 rpm  feed 250 mm/m\n  faces pressure\n  method tw\n  st\n}\nreq\n";
    editor.open(URI, text);
    for (word, offset, due) in [
        ("req\n", 3, "require"),
        ("tw\n", 2, "two-point"),
        ("  st\n", 4, "strips"),
        ("mm/m\n", 4, "mm/min"),
        ("5mc850-c", 3, "generic-ac-table"),
        ("carbide", 2, "carbide"),
    ] {
        let found = editor.ask("textDocument/completion", at(URI, text, word, offset));
        assert!(labels(&found).contains(&due), "{word:?}: {found}");
    }
    let uri = "file:///no/such/folder/tool.imp";
    let text = "edition 2026\ntool t2 = ball { diameter 6 mm  hol }\n";
    editor.open(uri, text);
    let found = editor.ask("textDocument/completion", at(uri, text, "hol }", 3));
    assert!(labels(&found).contains(&"holder"), "{found}");
    let text = "edition 2026\nuse tools \"carbide\"\ntool t1 = \"flat-6\"\n\
        operation flank { tool t9  speed 8000 rpm  feed 250 mm/min  faces pressure }\n";
    editor.open(uri, text);
    let found = editor.ask("textDocument/completion", at(uri, text, "t9", 2));
    assert_eq!(labels(&found), ["t1"]);
    editor.close();
}

/// A fault has its place, its code and a change that removes it; the changed text has no fault of this code.
#[test]
fn a_fault_is_shown_with_its_place_and_its_change() {
    let mut editor = Editor::new();
    let text = JOB.replacen("spacing", "spcaing", 1).replacen("// ", "// µ\u{1D11E} ", 1);
    assert!(text.contains("spcaing"));
    editor.open(URI, &text);
    let found = editor.of_version(1);
    let fault = found.as_array().unwrap().iter().find(|d| d["code"] == "IMP0204").unwrap_or_else(|| panic!("{found}"));
    assert_eq!((&fault["severity"], &fault["source"]), (&json!(1), &json!("impellerc")));
    let place = at(URI, &text, "spcaing", 0);
    assert_eq!(fault["range"]["start"], place["position"]);

    let asked = json!({ "textDocument": { "uri": URI }, "range": fault["range"], "context": { "diagnostics": [] } });
    let actions = editor.ask("textDocument/codeAction", asked);
    let edit = &actions[0]["edit"]["changes"][URI][0];
    assert_eq!(edit["newText"], "spacing", "{actions}");
    let change = json!({ "range": edit["range"], "text": edit["newText"] });
    editor.tell(
        "textDocument/didChange",
        json!({ "textDocument": { "uri": URI, "version": 2 }, "contentChanges": [change] }),
    );
    assert!(editor.of_version(2).as_array().unwrap().iter().all(|d| d["code"] != "IMP0204"));
    let hover = editor.ask("textDocument/hover", at(URI, &text, "tool t2  ", 6));
    assert!(hover["contents"]["value"].as_str().unwrap().contains("tool t2 = "), "{hover}");
    editor.close();
}

#[test]
fn names_items_blocks_and_the_usual_form() {
    let mut editor = Editor::new();
    let text = "edition   2026\nlet gap = 2 mm\ntool t1 = ball { diameter gap  flutes 4 }\npart p {\n  vanes 8\n}\n";
    editor.open(URI, text);
    let found = editor.ask("textDocument/definition", at(URI, text, "gap  flutes", 1));
    assert_eq!(found["range"]["start"], json!({ "line": 1, "character": 4 }));
    let outline = editor.ask("textDocument/documentSymbol", json!({ "textDocument": { "uri": URI } }));
    let names: Vec<&str> = outline.as_array().unwrap().iter().map(|s| s["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["edition 2026", "let gap", "tool t1 (ball)", "part p"]);
    let folds = editor.ask("textDocument/foldingRange", json!({ "textDocument": { "uri": URI } }));
    assert_eq!(folds, json!([{ "startLine": 3, "endLine": 4 }]));
    let edits = editor.ask("textDocument/formatting", json!({ "textDocument": { "uri": URI }, "options": {} }));
    assert_eq!(edits[0]["newText"], text.replace("edition   ", "edition "));
    editor.close();
}

/// A saved file is judged as `impellerc check` does: facts about the part come without being asked for.
#[test]
fn a_file_is_judged_when_it_is_opened() {
    let path = Path::new("jobs/small/small.imp").canonicalize().unwrap();
    let uri = format!("file://{}", path.display());
    let mut editor = Editor::new();
    editor.open(&uri, &std::fs::read_to_string(&path).unwrap());
    while !editor.published.iter().any(|(_, found)| found.to_string().contains("IMP0351")) {
        editor.receive();
    }
    assert!(!editor.published[0].1.to_string().contains("IMP0351"), "the front end comes first");
    editor.close();
}

#[test]
fn messages_out_of_order_are_refused_and_do_not_end_the_service() {
    let mut editor = Editor::new();
    editor.tell(
        "textDocument/didChange",
        json!({ "textDocument": { "uri": URI, "version": 2 }, "contentChanges": [{}] }),
    );
    editor.tell("textDocument/didSave", json!({}));
    for method in ["textDocument/hover", "textDocument/rename"] {
        let refused = editor.ask(method, at(URI, "x", "x", 0));
        assert!(refused["error"].as_str().is_some_and(|reason| reason.contains("not open")), "{refused}");
    }
    editor.open(URI, "edition 2026");
    let refused = editor.ask("textDocument/rename", at(URI, "x", "x", 0));
    assert!(refused["error"].as_str().is_some_and(|reason| reason.contains("no method")), "{refused}");
    editor.close();
}

/// 10 000 random changes of the main job, in messages of several: the last diagnostics are those of the whole text that a fresh
/// service gets.
#[test]
fn changes_leave_what_a_fresh_start_gives() {
    let mut editor = Editor::new();
    let mut text: Vec<u16> = JOB.encode_utf16().collect();
    editor.open(URI, JOB);
    let mut runner = TestRunner::new(Config::default());
    let words = ["", "\n", " ", "}", "{", "// µ\u{1D11E}\n", "\"", "8 mm", "tool", "\r\n", "x"];
    let change = (any::<prop::sample::Index>(), 0..4_usize, 0..words.len());
    let messages = prop::collection::vec(change, 10);
    let mut version = 1;
    for _ in 0..1000 {
        version += 1;
        let mut changes = Vec::new();
        for (index, length, word) in messages.new_tree(&mut runner).unwrap().current() {
            // Not inside of a letter of two units.
            let whole = |at: &usize| *at == text.len() || !(0xDC00..0xE000).contains(&text[*at]);
            let start = (0..=index.index(text.len() + 1)).rev().find(whole).unwrap();
            let end = (start + length..=text.len()).find(whole).unwrap_or(start);
            let place = |at: usize| {
                let line = text[..at].iter().filter(|u| **u == 10).count();
                let column = text[..at].iter().rev().take_while(|u| **u != 10).count();
                json!({ "line": line, "character": column })
            };
            // Columns end before `\r\n`: a place between the two is no place of an editor.
            if [start, end].iter().any(|at| *at > 0 && text.get(*at) == Some(&10) && text[at - 1] == 13) {
                continue;
            }
            changes.push(json!({ "range": { "start": place(start), "end": place(end) }, "text": words[word] }));
            text.splice(start..end, words[word].encode_utf16());
        }
        editor.tell(
            "textDocument/didChange",
            json!({ "textDocument": { "uri": URI, "version": version }, "contentChanges": changes }),
        );
    }
    let after = editor.of_version(version);
    let versions: Vec<i64> = editor.published.iter().map(|(version, _)| *version).collect();
    assert!(versions.is_sorted(), "{versions:?}");
    editor.close();
    let mut fresh = Editor::new();
    fresh.open(URI, &String::from_utf16(&text).unwrap());
    assert_eq!(fresh.of_version(1), after);
    fresh.close();
}

/// Times of a keystroke on the main job, from the message to the diagnostics: printed, not judged.
#[test]
fn a_keystroke_is_answered() {
    let mut editor = Editor::new();
    editor.open(URI, JOB);
    let mut times = Vec::new();
    for version in 2..52 {
        let start = Instant::now();
        let place = json!({ "line": 3, "character": 0 });
        let change = json!({ "range": { "start": place, "end": place }, "text": " " });
        editor.tell(
            "textDocument/didChange",
            json!({ "textDocument": { "uri": URI, "version": version }, "contentChanges": [change] }),
        );
        editor.of_version(version);
        times.push(start.elapsed());
    }
    times.sort();
    let start = Instant::now();
    let found = editor.ask("textDocument/completion", at(URI, JOB, "speed ", 5));
    println!("diagnostics: 95 % within {:?}; completion {:?}", times[47], start.elapsed());
    assert!(found.is_array());
    editor.close();
}
