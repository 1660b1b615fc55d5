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

const JOB: &str = include_str!("../../jobs/wei2021/paper-strategies.imp");

/// An editor with one text.
struct Editor {
    connection: Connection,
    service: Option<JoinHandle<Result<(), String>>>,
    next: i32,
    /// Diagnostics that were published, with the version of their text, in the order in which they came.
    published: Vec<(i64, Value)>,
    /// Requests and notices of the service other than diagnostics, by their method.
    told: Vec<(String, Value)>,
}

const URI: &str = "file:///no/such/folder/a%20job.imp";

impl Editor {
    fn new() -> Self {
        Self::with(json!({ "capabilities": {}, "initializationOptions": { "verifyOnSave": false } }))
    }

    /// An editor that says at its start what it can do.
    fn with(start: Value) -> Self {
        let (server, client) = Connection::memory();
        let service = std::thread::spawn(move || driver::serve(&server, None));
        let (published, told) = (Vec::new(), Vec::new());
        let mut editor = Self { connection: client, service: Some(service), next: 0, published, told };
        let found = editor.ask("initialize", start);
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
        let message = self.connection.receiver.recv_timeout(Duration::from_secs(300)).unwrap();
        match &message {
            Message::Notification(Notification { method, params }) if method == "textDocument/publishDiagnostics" => {
                self.published.push((params["version"].as_i64().unwrap(), params["diagnostics"].clone()));
            }
            Message::Notification(Notification { method, params })
            | Message::Request(Request { method, params, .. }) => {
                self.told.push((method.clone(), params.clone()));
            }
            Message::Response(_) => {}
        }
        message
    }

    fn open(&mut self, uri: &str, text: &str) {
        let language = if uri.ends_with(".imp") { "impeller" } else { "plaintext" };
        self.tell(
            "textDocument/didOpen",
            json!({ "textDocument": { "uri": uri, "languageId": language, "version": 1, "text": text } }),
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

    /// Diagnostics of the last text that was opened.
    fn of_library(&mut self) -> Value {
        let count = self.published.len();
        while self.published.len() == count {
            self.receive();
        }
        self.published.last().unwrap().1.clone()
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
    for (begun, word, offset, due) in [
        ("let gap = 2 mm\nlet q = g\n", "g\n", 1, "gap"),
        ("tool t9 = b\n", "b\n", 1, "ball"),
        ("require g\n", "g\n", 1, "gouge"),
        ("allow e\n", "e\n", 1, "excess"),
        ("post s\n", "s\n", 1, "siemens-840d"),
    ] {
        let text = format!("edition 2026\n{begun}");
        let uri = format!("file:///no/such/folder/{due}.imp");
        editor.open(&uri, &text);
        let found = editor.ask("textDocument/completion", at(&uri, &text, word, offset));
        assert!(labels(&found).contains(&due), "{begun:?}: {found}");
    }
    // What a block has already is not offered again.
    let uri = "file:///no/such/folder/given.imp";
    let text = "edition 2026\ntool t2 = ball { diameter 6 mm  flutes 4  fl }\n";
    editor.open(uri, text);
    let found = editor.ask("textDocument/completion", at(uri, text, "fl }", 2));
    assert!(labels(&found).contains(&"flute") && !labels(&found).contains(&"flutes"), "{found}");
    // A value may have the name of a property.
    let uri = "file:///no/such/folder/value.imp";
    let text = "edition 2026\nlet feed = 200 mm/min\noperation flank { speed 8000 rpm  feed f }\n";
    editor.open(uri, text);
    let found = editor.ask("textDocument/completion", at(uri, text, "f }", 1));
    assert!(labels(&found).contains(&"feed"), "{found}");
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

/// A name is renamed at all its places and nowhere else; the job stays without faults. Names that are taken are refused.
#[test]
fn a_name_is_renamed_at_all_its_places() {
    let text = std::fs::read_to_string("jobs/splitter/splitter.imp").unwrap();
    let path = Path::new("jobs/splitter/splitter.imp").canonicalize().unwrap();
    let uri = format!("file://{}", path.display());
    let mut editor = Editor::new();
    editor.open(&uri, &text);
    let faults = |found: &Value| found.as_array().unwrap().iter().filter(|d| d["severity"] == 1).count();
    let before = editor.of_version(1);
    assert_eq!(faults(&before), 0, "{before}");
    let mut asked = vec![("tool ", "tool "), ("let ", "let "), ("vane ", "vane "), ("splitter ", "splitter ")];
    asked.retain(|(start, _)| text.lines().any(|line| line.trim_start().starts_with(start)));
    assert!(asked.len() >= 3, "{asked:?}");
    let mut version = 1;
    for (start, _) in asked {
        let line = text.lines().find(|line| line.trim_start().starts_with(start)).unwrap();
        let name = line.trim_start()[start.len()..].trim_start().split([' ', '{']).next().unwrap().to_owned();
        let offset = line.find(start).unwrap() + start.len();
        let mut params = at(&uri, &text, line, line[offset..].find(&name).unwrap() + offset);
        let places = editor.ask("textDocument/references", params.clone());
        let prepared = editor.ask("textDocument/prepareRename", params.clone());
        assert_eq!(prepared["placeholder"], json!(name));
        params["newName"] = json!("renamed-9");
        let edit = editor.ask("textDocument/rename", params.clone());
        let edits = edit["changes"][&uri].as_array().unwrap_or_else(|| panic!("{name}: {edit}")).clone();
        assert_eq!(edits.len(), places.as_array().unwrap().len());
        assert!(edits.len() > 1 || start == "splitter ", "{name} is not used: {edit}");
        // From the end, so that places stay.
        let mut sorted = edits;
        sorted.sort_by_key(|e| (e["range"]["start"]["line"].as_u64(), e["range"]["start"]["character"].as_u64()));
        for edit in sorted.iter().rev() {
            version += 1;
            let change = json!({ "range": edit["range"], "text": edit["newText"] });
            editor.tell(
                "textDocument/didChange",
                json!({ "textDocument": { "uri": uri, "version": version }, "contentChanges": [change] }),
            );
        }
        let after = editor.of_version(version);
        assert_eq!(faults(&after), 0, "{name}: {after}");
        assert_eq!(after.as_array().unwrap().len(), before.as_array().unwrap().len(), "{name}: {after}");
        version += 1;
        editor.tell(
            "textDocument/didChange",
            json!({ "textDocument": { "uri": uri, "version": version }, "contentChanges": [{ "text": text }] }),
        );
        for bad in ["", "two words", "1 mm", "µ"] {
            params["newName"] = json!(bad);
            let refused = editor.ask("textDocument/rename", params.clone());
            assert!(refused["error"].as_str().is_some_and(|reason| reason.contains("no name")), "{refused}");
        }
    }
    // A name that is taken, one that becomes a word of the language, one in a text of which some items cannot be read.
    let small = std::fs::read_to_string("jobs/small/small.imp").unwrap();
    let broken = small.replacen("depth 3 mm", "depth 3 ) mm", 1);
    // The second operation `channel` is called `channel2`, and a requirement names it.
    let of_channel = small.find("operation channel").unwrap()..small.find("tolerance chord").unwrap();
    let named = format!("{}{}{}", &small[..of_channel.end], &small[of_channel.clone()], &small[of_channel.end..]);
    let named = named.replacen("operation flank", "operation flank x", 1);
    let named =
        named.replacen("clearance >= 0.5 mm", "clearance >= 0.5 mm\nrequire gouge <= 5 um on operation channel2", 1);
    for (name, text, word, new, reason) in [
        ("a", "edition 2026\nlet a = 1 mm\nlet b = a * 2\n", "a = 1", "b", "declared twice"),
        ("b", &named, "x {", "channel2", "channel2"),
        ("c", &broken, "t2 = ball", "t9", "has faults"),
    ] {
        let uri = format!("file://{}/{name}.imp", Path::new("jobs/small").canonicalize().unwrap().display());
        editor.open(&uri, text);
        let mut params = at(&uri, text, word, 0);
        params["newName"] = json!(new);
        let refused = editor.ask("textDocument/rename", params);
        assert!(refused["error"].as_str().is_some_and(|said| said.contains(reason)), "{name}: {refused}");
    }
    editor.close();
}

/// Figures beside the text are those that a machinist computes: cutting speed pi d n, feed per tooth f / n / z.
#[test]
fn figures_stand_beside_speeds_and_feeds() {
    let text = std::fs::read_to_string("jobs/small/small.imp").unwrap().replacen(
        "part small",
        "let gap = 2 mm * 3\nlet clear = gap / 12\npart small",
        1,
    );
    let text = text.replacen(">= 0.5 mm", ">= clear", 1);
    let uri = format!(
        "file://{}",
        Path::new("jobs/small/x.imp")
            .canonicalize()
            .unwrap_or_else(|_| { Path::new("jobs/small").canonicalize().unwrap().join("x.imp") })
            .display()
    );
    let mut editor = Editor::new();
    editor.open(&uri, &text);
    let whole = json!({ "start": { "line": 0, "character": 0 }, "end": { "line": 999, "character": 0 } });
    let asked = json!({ "textDocument": { "uri": uri }, "range": whole });
    let found = editor.ask("textDocument/inlayHint", asked);
    let labels: Vec<&str> = found.as_array().unwrap().iter().map(|hint| hint["label"].as_str().unwrap()).collect();
    // 2 mm at 12000 rpm; 150 and 250 mm/min with 4 teeth.
    let due = ["= 6 mm", "= 0.5 mm", "= 75.4 m/min", "= 0.0031 mm/tooth", "= 75.4 m/min", "= 0.0052 mm/tooth"];
    assert_eq!(labels[..6], due, "{found}");
    let hover = editor.ask("textDocument/hover", at(&uri, &text, ">= clear", 4));
    assert!(hover["contents"]["value"].as_str().unwrap().contains("value 0.5 mm"), "{hover}");
    // An item with several tools has the figures of each of them, and those behind it have their own.
    let text = std::fs::read_to_string("jobs/blisk/blisk.imp").unwrap();
    let uri = format!("file://{}", Path::new("jobs/blisk/blisk.imp").canonicalize().unwrap().display());
    editor.open(&uri, &text);
    let found = editor.ask("textDocument/inlayHint", json!({ "textDocument": { "uri": uri }, "range": whole }));
    let start = text.find("operation point").unwrap();
    let number = |word: &str, unit: &str| -> f64 {
        let behind = text[start..].split(&format!(" {word} ")).nth(1).unwrap();
        behind.split(unit).next().unwrap().trim().parse().unwrap()
    };
    let line = text[..start + text[start..].find(" feed ").unwrap()].matches('\n').count();
    let of_line = found.as_array().unwrap().iter().filter(|hint| hint["position"]["line"] == json!(line));
    let labels: Vec<&str> = of_line.filter_map(|hint| hint["label"].as_str()).collect();
    let due = number("feed", "mm/min") / number("speed", "rpm") / 4.0;
    assert_eq!(labels[1], format!("= {} mm/tooth", impellerc::base::units::trim(due, 4)), "{found}");
    editor.close();
}

/// What a job names leads to the file: a curve to its line of the table, a holder of a library beside the job to its table.
#[test]
fn names_of_files_lead_to_the_files() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path().canonicalize().unwrap();
    std::fs::create_dir_all(folder.join("_lib/tools")).unwrap();
    let curves = std::fs::read_to_string("jobs/small/vane_curves.csv").unwrap();
    std::fs::write(folder.join("vane_curves.csv"), &curves).unwrap();
    let library = impellerc::job::files::shipped::TOOLS.iter().find(|(name, _)| *name == "carbide").unwrap().1;
    std::fs::write(folder.join("_lib/tools/carbide.toml"), library).unwrap();
    let text = std::fs::read_to_string("jobs/small/small.imp").unwrap();
    let uri = format!("file://{}/a.imp", folder.display());
    let mut editor = Editor::new();
    editor.open(&uri, &text);
    for (word, offset, file, line) in [
        ("root_suction", 3, "vane_curves.csv", curves.lines().position(|l| l.contains("root_suction")).unwrap()),
        ("er16-mini", 3, "carbide.toml", library.lines().position(|l| l.contains("[holder.er16-mini]")).unwrap()),
        ("\"carbide\"", 3, "carbide.toml", 0),
    ] {
        let found = editor.ask("textDocument/definition", at(&uri, &text, word, offset));
        assert!(found["uri"].as_str().is_some_and(|uri| uri.ends_with(file)), "{word}: {found}");
        assert_eq!(found["range"]["start"]["line"], json!(line), "{word}: {found}");
    }
    let shipped = editor.ask("textDocument/hover", at(&uri, &text, "5mc850-c", 2));
    let said = shipped["contents"]["value"].as_str().unwrap();
    assert!(said.contains("impellerc machines 5mc850-c"), "{said}");
    // A file of the library has its faults at their places.
    let uri = format!("file://{}/_lib/tools/own.toml", folder.display());
    let wrong = library.replacen("mm\"", "deg\"", 1);
    editor.open(&uri, &wrong);
    let found = editor.of_library();
    let place = wrong[..wrong.find("deg\"").unwrap()].matches('\n').count();
    assert!(found.as_array().unwrap().iter().any(|d| d["range"]["start"]["line"] == json!(place)), "{found}");
    // Its holders may stand in another file.
    let uri = format!("file://{}/_lib/tools/few.toml", folder.display());
    let tool = &library[library.find("[tool.").unwrap()..];
    editor.open(&uri, tool);
    assert_eq!(editor.of_library(), json!([]));
    editor.close();
}

/// A saved job is planned and verified, with progress; then each operation and requirement has its figures, and the part its
/// facts. NC text with its source map beside it leads back to the job.
#[test]
fn a_saved_job_is_verified_and_its_text_leads_back() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path().canonicalize().unwrap();
    std::fs::copy("jobs/small/vane_curves.csv", folder.join("vane_curves.csv")).unwrap();
    let text = std::fs::read_to_string("jobs/small/small.imp").unwrap();
    let of_channel = text.find("operation channel").unwrap()..text.find("tolerance chord").unwrap();
    let second = text[of_channel.clone()].replacen("scallop 0.2 mm", "scallop 0.3 mm", 1);
    let text = format!("{}{second}{}", &text[..of_channel.end], &text[of_channel.end..]);
    let job = folder.join("small.imp");
    std::fs::write(&job, &text).unwrap();
    let uri = format!("file://{}", job.display());
    let window = json!({ "workDoneProgress": true });
    let mut editor = Editor::with(json!({
        "capabilities": { "window": window, "workspace": { "codeLens": { "refreshSupport": true } } }
    }));
    editor.open(&uri, &text);
    let asked = json!({ "textDocument": { "uri": uri } });
    assert_eq!(editor.ask("textDocument/codeLens", asked.clone()), json!([]));
    editor.tell("textDocument/didSave", asked.clone());
    let ended = |editor: &Editor| {
        let mut values = editor.told.iter().filter(|(method, _)| method == "$/progress").map(|(_, p)| &p["value"]);
        values.find(|value| value["kind"] == "end").map(|value| value["message"].as_str().unwrap().to_owned())
    };
    while !editor.told.iter().any(|(method, _)| method == "workspace/codeLens/refresh") {
        editor.receive();
    }
    let verdict = ended(&editor).unwrap();
    assert!(verdict.starts_with("PASS small: "), "{verdict}");
    let shown: Vec<&str> = editor.told.iter().filter_map(|(_, p)| p["value"]["message"].as_str()).collect();
    // A plan that takes less than the time between two messages has no share of its own.
    assert!(shown.iter().any(|message| message.starts_with("plan")), "{shown:?}");
    assert!(shown.iter().any(|message| message.contains(": ") && message.ends_with(" %")), "{shown:?}");
    let lenses = editor.ask("textDocument/codeLens", asked.clone());
    let titles: Vec<&str> =
        lenses.as_array().unwrap().iter().map(|l| l["command"]["title"].as_str().unwrap()).collect();
    assert_eq!(titles.len(), 6, "{lenses}");
    assert!(titles[1].contains("passes; 10 strips per face") && titles[4].starts_with("holds: proved "), "{titles:?}");
    // The second of two operations without names has its own times.
    assert_ne!(titles[2], titles[3], "{titles:?}");
    let hover = editor.ask("textDocument/hover", at(&uri, &text, "part small", 2));
    assert!(hover["contents"]["value"].as_str().unwrap().contains("IMP0351"), "{hover}");
    // With another table of curves it is another job.
    let curves = folder.join("vane_curves.csv");
    let table = std::fs::read_to_string(&curves).unwrap();
    std::fs::write(&curves, format!("{table}\n")).unwrap();
    assert_eq!(editor.ask("textDocument/codeLens", asked.clone()), json!([]));
    std::fs::write(&curves, &table).unwrap();
    // An edited text is not the one that was verified.
    let place = json!({ "line": 0, "character": 0 });
    let change = json!({ "range": { "start": place, "end": place }, "text": " " });
    editor.tell(
        "textDocument/didChange",
        json!({ "textDocument": { "uri": uri, "version": 2 }, "contentChanges": [change] }),
    );
    assert_eq!(editor.ask("textDocument/codeLens", asked), json!([]));

    let [nc, map, certificate] = ["small.mpf", "small.map.json", "small.json"].map(|name| folder.join(name));
    let options = driver::Options {
        job,
        output: Some(nc.clone()),
        other_outputs: [("--source-map", map), ("--certificate", certificate)]
            .into_iter()
            .filter_map(|(flag, path)| driver::OutputFile::new(flag, path))
            .collect(),
        ..driver::Options::default()
    };
    assert!(!driver::compile(&options, &mut driver::Stages::default()).sink.has_errors());
    let written = std::fs::read_to_string(&nc).unwrap();
    let uri = format!("file://{}", nc.display());
    editor.open(&uri, &written);
    let start = written.find("; flank: a restart point").unwrap();
    let line = start + written[start..].find(" G1 X").unwrap();
    let line = written[..line].matches('\n').count();
    let place = json!({ "textDocument": { "uri": uri }, "position": { "line": line, "character": 1 } });
    let hover = editor.ask("textDocument/hover", place.clone());
    let said = hover["contents"]["value"].as_str().unwrap();
    assert!(
        said.starts_with("**flank** with t2, ") && said.contains("axes at its end") && said.contains(" C "),
        "{said}"
    );
    let leads = editor.ask("textDocument/definition", place);
    let of_flank = text.lines().position(|line| line.starts_with("operation flank")).unwrap();
    assert_eq!(leads["range"]["start"]["line"], json!(of_flank), "{leads}");
    let worst = written.lines().enumerate().any(|(line, _)| {
        let place = json!({ "textDocument": { "uri": uri }, "position": { "line": line, "character": 0 } });
        let hover = editor.ask("textDocument/hover", place);
        hover["contents"]["value"].as_str().is_some_and(|said| said.contains("here is the deepest cut into"))
    });
    assert!(worst, "no block has a worst place of the certificate");
    editor.close();
}

/// Verification ends when its text is saved again, when it is cancelled, and when the editor goes.
#[test]
fn verification_is_cancelled() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path().canonicalize().unwrap();
    let job = folder.join("long.imp");
    std::fs::write(&job, JOB).unwrap();
    let uri = format!("file://{}", job.display());
    let mut editor = Editor::with(json!({ "capabilities": { "window": { "workDoneProgress": true } } }));
    editor.open(&uri, JOB);
    editor.tell("textDocument/didSave", json!({ "textDocument": { "uri": uri } }));
    let kind = |p: &Value, kind: &str| p["value"]["kind"] == kind;
    let mut token = Value::Null;
    while token.is_null() {
        editor.receive();
        let reports = editor.told.iter().find(|(_, p)| kind(p, "report"));
        token = reports.map_or(Value::Null, |(_, p)| p["token"].clone());
    }
    editor.tell("window/workDoneProgress/cancel", json!({ "token": token }));
    while !editor.told.iter().any(|(_, p)| kind(p, "end")) {
        editor.receive();
    }
    let end = editor.told.iter().find(|(_, p)| kind(p, "end")).unwrap();
    assert_eq!(end.1["value"]["message"], "cancelled");
    editor.tell("textDocument/didSave", json!({ "textDocument": { "uri": uri } }));
    // The editor does not wait for the thread, and may answer an earlier request late.
    let late = Response::new_ok(lsp_server::RequestId::from("late".to_owned()), Value::Null);
    editor.ask("shutdown", Value::Null);
    editor.connection.sender.send(late.into()).unwrap();
    editor.tell("exit", Value::Null);
    editor.service.take().unwrap().join().unwrap().unwrap();
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
    let refused = editor.ask("textDocument/moniker", at(URI, "x", "x", 0));
    assert!(refused["error"].as_str().is_some_and(|reason| reason.contains("no method")), "{refused}");
    let refused = editor.ask("textDocument/rename", at(URI, "x", "x", 0));
    assert!(refused["error"].as_str().is_some_and(|reason| reason.contains("only names")), "{refused}");
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

/// Times of 50 keystrokes at a line, from the message to the diagnostics, and of a completion: printed, not judged.
fn keystrokes(text: &str, line: usize) {
    let mut editor = Editor::new();
    editor.open(URI, text);
    editor.of_version(1);
    let mut times = Vec::new();
    for version in 2..52 {
        let start = Instant::now();
        let place = json!({ "line": line, "character": 0 });
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
    let found = editor.ask("textDocument/completion", at(URI, text, "speed ", 5));
    println!(
        "{} lines: diagnostics 95 % within {:?}; completion {:?}",
        text.lines().count(),
        times[47],
        start.elapsed()
    );
    assert!(found.is_array());
    editor.close();
}

#[test]
fn a_keystroke_is_answered() {
    keystrokes(JOB, 3);
}

/// A job of 2000 lines: curves of many points, many tools and operations.
fn long_job() -> String {
    let mut text = JOB.to_owned();
    let tool = JOB.lines().find(|line| line.starts_with("tool t2")).unwrap();
    let start = JOB.find("operation flank").unwrap();
    let operation = &JOB[start..start + JOB[start..].find("\n}").unwrap() + 2];
    let mut number = 0;
    while text.lines().count() < 2000 {
        number += 1;
        text.push_str(&format!("{}\n", tool.replacen("t2", &format!("u{number}"), 1)));
        let copy = operation.replacen("operation flank", &format!("operation flank copy-{number}"), 1);
        text.push_str(&format!("{}\n", copy.replace("tool t2", &format!("tool u{number}"))));
    }
    text
}

#[test]
fn a_keystroke_in_a_long_job_is_answered() {
    keystrokes(&long_job(), 1900);
}
