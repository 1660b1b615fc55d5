//! `impellerc verify` as a user runs it: on the output of the compiler, and on the same output with faults.

use impellerc::report::source_map::{LaidMap, SourceMapFile};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;

const JOB: &str = "jobs/small/small.imp";

/// The largest cells that a job may have, where a test does not look at the stock.
const CELLS: [&str; 2] = ["--stock-cell", "1"];

const DIALECTS: [&str; 2] = ["siemens-840d", "linuxcnc"];

/// The machine with the senses of rotary words that a dialect can have.
fn machine(dialect: &str) -> [&str; 2] {
    ["--machine", if dialect == "linuxcnc" { "5mc850-c-linuxcnc" } else { "5mc850-c" }]
}

fn impellerc(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_impellerc")).args(arguments).output().unwrap()
}

/// The small job in both dialects, compiled once.
static WRITTEN: LazyLock<tempfile::TempDir> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    for dialect in DIALECTS {
        let out = folder.path().join(dialect);
        let certificate = folder.path().join(format!("{dialect}.json"));
        let map = folder.path().join(format!("{dialect}.map"));
        let ending = if dialect == "linuxcnc" { "html" } else { "md" };
        let sheet = folder.path().join(format!("{dialect}.{ending}"));
        let [out, certificate, map, sheet] = [&out, &certificate, &map, &sheet].map(|path| path.to_str().unwrap());
        let more = ["-o", out, "--certificate", certificate, "--source-map", map, "--setup-sheet", sheet];
        let run = impellerc(&[&[JOB, "--post", dialect], &machine(dialect)[..], &more[..], &CELLS[..]].concat());
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    }
    folder
});

fn text(dialect: &str) -> String {
    std::fs::read_to_string(WRITTEN.path().join(dialect)).unwrap()
}

struct Edited {
    _folder: tempfile::TempDir,
    path: PathBuf,
}

fn edited(text: &str) -> Edited {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("part.nc");
    std::fs::write(&path, text).unwrap();
    Edited { _folder: folder, path }
}

fn verify(path: &Path, dialect: &str, more: &[&str]) -> (bool, String, String) {
    let mut arguments = vec!["verify", path.to_str().unwrap(), "--job", JOB];
    arguments.extend(machine(dialect));
    // The compiler's own texts are recognised; the others are read as they are meant.
    if !path.starts_with(WRITTEN.path()) {
        arguments.extend(["--post", dialect]);
    }
    if !more.contains(&CELLS[0]) {
        arguments.extend(CELLS);
    }
    arguments.extend(more);
    let run = impellerc(&arguments);
    let say = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (run.status.success(), say(&run.stdout), say(&run.stderr))
}

/// The diagnostics of a run with `--error-format json`.
fn diagnostics(text: &str) -> Vec<Value> {
    text.lines().map(|l| serde_json::from_str(l).unwrap()).collect()
}

/// Line of the first block whose text begins (after its number) like this, from 1.
fn line_of(text: &str, words: &str) -> usize {
    text.lines().position(|l| l.contains(words)).unwrap_or_else(|| panic!("no {words}")) + 1
}

/// The certificate's figures are those of the compiler: only the digits of the words lie between.
#[test]
fn written_text_is_verified_with_the_figures_of_the_compiler() {
    for dialect in DIALECTS {
        let path = WRITTEN.path().join(dialect);
        let (ok, out, err) = verify(&path, dialect, &[]);
        assert!(ok, "{err}");
        assert!(!err.contains("error"), "{err}");
        assert!(out.contains("moves read as") && out.contains("clearance >= 0.500 mm"), "{out}");
        // The moves with the transformation on, and a station in front of each operation and behind it.
        let text = text(dialect);
        let on = if dialect == "linuxcnc" { "M428" } else { "TRAORI" };
        let moves = text.lines().filter(|l| !is_comment(l) && l.contains(" X") && l.contains(" Z")).count()
            + 2 * text.lines().filter(|l| l.ends_with(on)).count();
        assert!(out.contains(&format!("{moves} moves read as {dialect}")), "{moves} {out}");
    }
}

/// A block that takes the tool against the vane: the finding names the NC line, the block, the contract and the
/// operation's line of the job.
#[test]
fn a_finding_names_the_block_and_the_lines_of_the_job() {
    let dialect = "linuxcnc";
    let original = text(dialect);
    let lines: Vec<&str> = original.lines().collect();
    // The end of the way over the sphere after the first pass of the flank operation: it is moved into the part, so that the
    // rapid hits the stock, and the link after it goes with the shank among the vanes.
    let start = line_of(&original, "(flank: a restart");
    let is = |i: usize, word: &str| lines[i].starts_with(word);
    let index =
        (start..lines.len()).find(|i| is(i - 1, "G1 X") && is(*i, "G61.1 G1 X") && is(i + 1, "G94 G1 X")).unwrap();
    let mut changed: Vec<String> = lines.iter().map(|l| (*l).to_owned()).collect();
    changed[index] = "G0 X0 Y0 Z-12".to_owned();
    let nc = edited(&(changed.join("\n") + "\n"));
    let (ok, out, err) = verify(&nc.path, dialect, &["--error-format", "json"]);
    assert!(!ok);
    assert!(out.contains("FAILS"), "the certificate is printed with its failed contract: {out}");
    let all = diagnostics(&err);
    let found = all.iter().find(|d| d["code"] == "IMP0705").unwrap_or_else(|| panic!("{err}"));
    let labels = found["labels"].as_array().unwrap();
    assert!(labels[0]["file"].as_str().unwrap().ends_with("part.nc"), "{found}");
    let line = usize::try_from(labels[0]["line"].as_u64().unwrap()).unwrap();
    assert!(line.abs_diff(index + 1) <= 1, "line {line}, changed {}", index + 1);
    assert_eq!(labels[1]["file"], JOB);
    let job = std::fs::read_to_string(JOB).unwrap();
    assert_eq!(labels[1]["line"].as_u64().unwrap() as usize, line_of(&job, "operation flank"));
    assert!(found["place"]["what"].as_str().unwrap().contains(&format!("part.nc line {line}: flank")), "{found}");
    // The same for people: the block's text stands in the report.
    let (_, _, human) = verify(&nc.path, dialect, &[]);
    assert!(human.contains(&format!("part.nc:{line}:1")), "{human}");
    assert!(human.contains(&changed[line - 1]) && human.contains("this block"), "{human}");
}

/// Whether a line of NC text is a comment.
fn is_comment(line: &str) -> bool {
    line.starts_with([';', '('])
}

/// Number of the first block of this kind, from 1.
fn text_line(text: &str, is: impl Fn(&str) -> bool) -> usize {
    text.lines().position(|line| !is_comment(line) && is(line)).unwrap() + 1
}

fn refused(dialect: &str, text: &str, code: &str, line: usize) -> Value {
    let nc = edited(text);
    let (ok, out, err) = verify(&nc.path, dialect, &["--error-format", "json"]);
    assert!(!ok && out.is_empty(), "{out}{err}");
    let all = diagnostics(&err);
    let found = all.iter().find(|d| d["code"] == code).unwrap_or_else(|| panic!("no {code} in {err}"));
    assert_eq!(found["labels"][0]["line"], line, "{found}");
    assert!(found["help"].is_string());
    found.clone()
}

#[test]
fn text_that_does_not_follow_the_job_is_refused_with_its_line() {
    for dialect in DIALECTS {
        let original = text(dialect);
        let first_move = text_line(&original, |l| l.contains(" X") && l.contains(" Z"));
        // Another spindle speed, a tool that the job does not have, a feed that no operation has.
        refused(dialect, &original.replacen("S12000", "S12100", 1), "IMP0822", first_move);
        let tool = if dialect == "linuxcnc" { ("T1 M6", "T9 M6") } else { ("T=\"t1\"", "T=\"t9\"") };
        let other = original.replacen(tool.0, tool.1, 1).replacen("G43 H1", "G43 H9", 1);
        let unknown = refused(dialect, &other, "IMP0822", first_move);
        assert!(unknown["message"].as_str().unwrap().contains("no tool"), "{unknown}");
        refused(dialect, &original.replacen("F1000.000", "F5000.000", 1), "IMP0823", line_of(&original, "F1000.000"));
        let (head, moves) = original.split_at(original.match_indices('\n').nth(first_move - 2).unwrap().0);
        let at_feed = if dialect == "linuxcnc" { ("G93 ", "") } else { ("G0 X", "G1 F100 X") };
        let feed = format!("{head}{}", moves.replacen(at_feed.0, at_feed.1, 1));
        refused(dialect, &feed, "IMP0824", first_move);
        // Two operations less: what is missing is told after the last block.
        let from = line_of(&original, "flank: a restart point") - 1;
        let end = if dialect == "linuxcnc" { "M2" } else { "M30" };
        let short = original.lines().take(from).map(|l| format!("{l}\n")).collect::<String>() + end + "\n";
        let last = short.lines().count() - short.lines().rev().position(|l| l.contains(" Z")).unwrap();
        let missing = refused(dialect, &short, "IMP0822", last);
        let message = missing["message"].as_str().unwrap();
        assert!(message.contains("`flank`") && message.contains("`channel`"), "{message}");
    }
}

#[test]
fn unsafe_beginnings_and_loose_smoothing_are_errors() {
    let find = |dialect: &str, from: &str, to: &str, code: &str| {
        let original = text(dialect);
        assert!(original.contains(from), "{from}");
        let nc = edited(&original.replacen(from, to, 1));
        let (ok, _, err) = verify(&nc.path, dialect, &["--error-format", "json"]);
        assert!(!ok && err.contains(code), "{code}: {err}");
    };
    // The table would turn by a degree while the tool comes down.
    let original = text("linuxcnc");
    let parked = original.lines().find(|l| l.starts_with("G53 G0 A")).unwrap();
    let turned = parked.replacen("A-8", "A-7", 1).replacen("A8", "A7", 1);
    assert_ne!(parked, turned);
    find("linuxcnc", parked, &turned, "IMP0824");
    find("siemens-840d", "CYCLE832(0.0500", "CYCLE832(0.9000", "IMP0825");
}

#[test]
fn a_check_needs_something_to_check_against() {
    let run = impellerc(&["verify", "nothing.nc"]);
    assert_eq!(run.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&run.stderr).contains("IMP0828"));
    let (ok, _, err) = verify(&WRITTEN.path().join("linuxcnc"), "linuxcnc", &["--post", "okuma"]);
    assert!(!ok && err.contains("IMP0902"), "{err}");
}

/// Whether a value has the form of a schema; only what the schema of the certificate uses.
fn conforms(schema: &Value, root: &Value, value: &Value, at: &str, faults: &mut Vec<String>) {
    let known = [
        "$schema",
        "$defs",
        "$ref",
        "title",
        "description",
        "type",
        "required",
        "additionalProperties",
        "properties",
        "const",
        "enum",
        "pattern",
        "items",
        "minItems",
        "maxItems",
        "minimum",
        "exclusiveMinimum",
        "anyOf",
    ];
    for key in schema.as_object().unwrap().keys() {
        assert!(known.contains(&key.as_str()), "the schema uses {key}, which is not checked");
    }
    if let Some(name) = schema["$ref"].as_str() {
        let target = root.pointer(name.strip_prefix('#').unwrap()).unwrap_or_else(|| panic!("no {name}"));
        return conforms(target, root, value, at, faults);
    }
    let mut fail = |what: &str| faults.push(format!("{at}: {what}"));
    let is = |kind: &str| match kind {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        "boolean" => value.is_boolean(),
        "null" => value.is_null(),
        _ => panic!("type {kind}"),
    };
    match &schema["type"] {
        Value::String(kind) if !is(kind) => fail(kind),
        Value::Array(kinds) if !kinds.iter().any(|k| is(k.as_str().unwrap())) => fail("none of the types"),
        _ => {}
    }
    if schema.get("const").is_some_and(|c| c != value) {
        fail("another constant");
    }
    if schema["enum"].as_array().is_some_and(|all| !all.contains(value)) {
        fail("none of the values");
    }
    if let (Some(pattern), Some(text)) = (schema["pattern"].as_str(), value.as_str()) {
        let hexadecimal = |n: usize| text.len() == n && text.bytes().all(|b| matches!(b, b'0'..=b'9' | b'a'..=b'f'));
        let fits = match pattern {
            "^[0-9a-f]{64}$" => hexadecimal(64),
            "^[0-9a-f]{16}$" => hexadecimal(16),
            "^impellerc " => text.starts_with("impellerc "),
            _ => panic!("pattern {pattern}"),
        };
        if !fits {
            fail("another pattern");
        }
    }
    if let (Some(least), Some(x)) = (schema["minimum"].as_f64(), value.as_f64())
        && x < least
    {
        fail("too small");
    }
    if let (Some(bound), Some(x)) = (schema["exclusiveMinimum"].as_f64(), value.as_f64())
        && x <= bound
    {
        fail("not above its bound");
    }
    if let Some(all) = schema["anyOf"].as_array() {
        let fits = |s: &Value| {
            let mut own = Vec::new();
            conforms(s, root, value, at, &mut own);
            own.is_empty()
        };
        if !all.iter().any(fits) {
            faults.push(format!("{at}: none of the forms"));
        }
    }
    if let Some(items) = value.as_array() {
        let n = items.len() as u64;
        if schema["minItems"].as_u64().is_some_and(|m| n < m) || schema["maxItems"].as_u64().is_some_and(|m| n > m) {
            faults.push(format!("{at}: {n} items"));
        }
        if schema["items"].is_object() {
            for (i, item) in items.iter().enumerate() {
                conforms(&schema["items"], root, item, &format!("{at}[{i}]"), faults);
            }
        }
    }
    if let Some(fields) = value.as_object() {
        for name in schema["required"].as_array().into_iter().flatten() {
            if !fields.contains_key(name.as_str().unwrap()) {
                faults.push(format!("{at}: without {name}"));
            }
        }
        for (name, field) in fields {
            match schema["properties"].get(name) {
                Some(s) => conforms(s, root, field, &format!("{at}.{name}"), faults),
                None if schema["additionalProperties"] == false => faults.push(format!("{at}: {name} is not known")),
                None => {}
            }
        }
    }
}

fn certificate(dialect: &str) -> PathBuf {
    WRITTEN.path().join(format!("{dialect}.json"))
}

fn json(path: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

#[test]
fn certificates_have_the_form_of_their_schema() {
    let schema = json(Path::new("docs/certificate.schema.json"));
    let faults = |value: &Value| {
        let mut faults = Vec::new();
        conforms(&schema, &schema, value, "certificate", &mut faults);
        faults
    };
    for dialect in DIALECTS {
        let value = json(&certificate(dialect));
        assert!(faults(&value).is_empty(), "{:#?}", faults(&value));
        // The check itself sees faults.
        for (pointer, wrong) in [
            ("/inputs/sha256", Value::from("ab")),
            ("/nc/operations/0/first", Value::from("12")),
            ("/measured/surfaces/3/gouge/point", Value::from(vec![1.0, 2.0])),
            ("/measured/contracts/0/holds", Value::Null),
            ("/nc/post", Value::from("okuma")),
        ] {
            let mut broken = value.clone();
            *broken.pointer_mut(pointer).unwrap() = wrong;
            assert_eq!(faults(&broken).len(), 1, "{pointer}: {:?}", faults(&broken));
        }
        let mut more = value.clone();
        more["nc"]["machine"] = Value::from("here");
        assert_eq!(faults(&more).len(), 1);
        // Every field of the schema has its line in the document.
        let document = std::fs::read_to_string("docs/certificate.md").unwrap();
        let fields = ["/properties", "/properties/nc/properties", "/$defs/measured/properties"];
        for name in fields.iter().flat_map(|f| schema.pointer(f).unwrap().as_object().unwrap().keys()) {
            assert!(document.contains(&format!("`{name}")) || document.contains(&format!(".{name}")), "{name}");
        }
        // The lines of the operations are theirs.
        let text = text(dialect);
        let lines: Vec<&str> = text.lines().collect();
        let body = value["nc"]["body_starts"].as_u64().unwrap() as usize;
        assert!(
            (lines[body - 1].contains("G17") || lines[body - 1] == "M429")
                && lines[..body - 1].iter().all(|l| l.starts_with([';', '(']))
        );
        for (k, operation) in value["nc"]["operations"].as_array().unwrap().iter().enumerate() {
            let at = |key: &str| operation[key].as_u64().unwrap() as usize;
            let moves = value["measured"]["operations"][k]["moves"].as_u64().unwrap() as usize;
            // Two moves are the way to the first target and the retract.
            let between = lines[at("first") - 1..at("last")].iter().filter(|l| l.contains(" X")).count();
            assert_eq!(between + 2, moves);
            assert!(lines[at("first") - 1].contains(" X") && lines[at("last") - 1].contains(" X"));
            assert!(!lines[at("first") - 2].contains(" X") && !lines[at("last")].contains(" X"));
        }
    }
}

fn belongs(nc: &Path, certificate: &Path, more: &[&str]) -> (bool, String, String) {
    let arguments = ["verify", nc.to_str().unwrap(), "--certificate", certificate.to_str().unwrap()];
    let run = impellerc(&[&arguments[..], more].concat());
    let say = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (run.status.success(), say(&run.stdout), say(&run.stderr))
}

#[test]
fn text_and_certificate_belong_together_or_not() {
    for dialect in DIALECTS {
        let nc = WRITTEN.path().join(dialect);
        let (ok, out, err) = belongs(&nc, &certificate(dialect), &[]);
        assert!(ok && out.contains("belong together"), "{out}{err}");
        let original = text(dialect);
        let refused = |changed: &str, certificate: &Path, words: &str| {
            let nc = edited(changed);
            let (ok, out, err) = belongs(&nc.path, certificate, &["--error-format", "json"]);
            assert!(!ok && !out.contains("belong together"), "{words}: {out}");
            let all = diagnostics(&err);
            let found = all.iter().find(|d| d["message"].as_str().unwrap().contains(words));
            found.unwrap_or_else(|| panic!("{words}: {err}")).clone()
        };
        // One digit, one line less, other line ends.
        let at = line_of(&original, "flank: a restart point") + 20;
        let mut lines: Vec<String> = original.lines().map(|l| format!("{l}\n")).collect();
        let at = (at..lines.len()).find(|i| lines[*i].contains(" Y")).unwrap();
        lines[at] = lines[at].replacen("Y", "Y0", 1);
        let found = refused(&lines.concat(), &certificate(dialect), "another text");
        assert_eq!(found["code"], "IMP0827");
        let line = found["labels"][0]["line"].as_u64().unwrap() as usize;
        assert!(line <= at + 1 && at + 1 < line + 100, "{found} {at}");
        assert!(found["message"].as_str().unwrap().contains("`flank`") || line < at - 20, "{found}");
        lines.remove(at);
        refused(&lines.concat(), &certificate(dialect), "another text");
        refused(&original.replace('\n', "\r\n"), &certificate(dialect), "another text");
        // What the head does not name, or names otherwise, and a certificate that was edited to fit.
        let dropped = |word: &str| -> String {
            original.lines().filter(|l| !l.contains(word)).map(|l| format!("{l}\n")).collect()
        };
        for word in ["inputs sha256", "body sha256", "certificate sha256"] {
            refused(&dropped(word), &certificate(dialect), &format!("the head of the text lacks {word}"));
        }
        let at = original.find("body sha256 ").unwrap() + "body sha256 ".len();
        let other = if original[at..].starts_with('0') { "1" } else { "0" };
        let mut head = original.clone();
        head.replace_range(at..=at, other);
        refused(&head, &certificate(dialect), "differs from the one in its head");
        let nameless = dropped("certificate sha256");
        let mut forged = json(&certificate(dialect));
        forged["nc"]["body_sha256"] = Value::from("0".repeat(64));
        refused(&nameless, &edited(&forged.to_string()).path, "another text");
        // A comment at the head is no part of the body, and covered as well.
        let head = original.replacen("mm", "millimetres", 1);
        let line = original.lines().position(|l| l.contains("mm")).unwrap() + 1;
        refused(&head, &certificate(dialect), &format!("line {line} differs"));
        // An edited certificate.
        let shown = std::fs::read_to_string(certificate(dialect)).unwrap();
        let forged = edited(&shown.replacen("\"holds\": true", "\"holds\":  true", 1));
        let found = refused(&original, &forged.path, "names another certificate");
        assert_eq!(found["labels"][0]["line"], 1);
        let other = edited(&shown.replacen("\"sha256\": \"", "\"sha256\": \"0", 1).replacen("0\",", "\",", 1));
        let (ok, _, err) = belongs(&edited(&original).path, &other.path, &[]);
        assert!(!ok, "{err}");
    }
    // The certificate of the other dialect; and files that are none.
    let nc = WRITTEN.path().join(DIALECTS[0]);
    assert!(!belongs(&nc, &certificate(DIALECTS[1]), &[]).0);
    for (text, words) in [
        ("", "not JSON"),
        ("{}", "format"),
        ("{\"format\": \"impellerc-certificate\", \"version\": 7}", "version 7"),
        ("{\"format\": \"impellerc-certificate\", \"version\": 2}", "form is wrong"),
    ] {
        let file = edited(text);
        let (ok, _, err) = belongs(&nc, &file.path, &[]);
        assert!(!ok && err.contains("IMP0826") && err.contains(words), "{words}: {err}");
    }
    let (ok, _, err) = belongs(&nc, Path::new("nothing.json"), &[]);
    assert!(!ok && err.contains("IMP0901"), "{err}");
}

/// Klartext, whose comments have block numbers: recognised, verified, and bound to its certificate.
#[test]
fn klartext_is_verified_and_belongs_to_its_certificate() {
    let folder = tempfile::tempdir().unwrap();
    let [nc, certificate] = ["small.h", "small.json"].map(|name| folder.path().join(name));
    let out = ["-o", nc.to_str().unwrap(), "--certificate", certificate.to_str().unwrap()];
    let run = impellerc(&[&[JOB, "--post", "heidenhain-itnc530"], &out[..], &CELLS[..]].concat());
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    // Without `--post`: the job names another dialect.
    let run = impellerc(&[&["verify", nc.to_str().unwrap(), "--job", JOB], &CELLS[..]].concat());
    let said = String::from_utf8_lossy(&run.stdout).into_owned();
    assert!(run.status.success() && said.contains("moves read as heidenhain"), "{said}");
    let (ok, out, err) = belongs(&nc, &certificate, &[]);
    assert!(ok && out.contains("belong together"), "{out}{err}");
    let original = std::fs::read_to_string(&nc).unwrap();
    let body = json(&certificate)["nc"]["body_starts"].as_u64().unwrap() as usize;
    let lines: Vec<&str> = original.lines().collect();
    assert!(lines[body - 1].contains("* - groove") && lines[0] == "0 BEGIN PGM SMALL MM");
    assert!(lines[1..body - 1].iter().all(|line| line.contains(" ; ")), "comments in the head");
    let changed = |from: &str, to: &str| belongs(&edited(&original.replacen(from, to, 1)).path, &certificate, &[]);
    let (ok, _, err) = changed("length 105 mm", "length 104 mm");
    assert!(!ok && err.contains("IMP0827") && err.contains("differs"), "{err}");
    let (ok, _, err) = changed("F150.000", "F151.000");
    assert!(!ok && err.contains("another text"), "{err}");
}

/// With the job: its files are compared by name, and the contracts with what is measured.
#[test]
fn a_certificate_is_compared_with_job_and_measurement() {
    let dialect = "linuxcnc";
    let machine = machine(dialect);
    let nc = WRITTEN.path().join(dialect);
    let (ok, out, err) =
        belongs(&nc, &certificate(dialect), &["--job", JOB, machine[0], machine[1], CELLS[0], CELLS[1]]);
    assert!(ok && out.contains("belong together") && out.contains("are those of the certificate"), "{out}{err}");
    // A wider contract in the job, and a certificate with another figure.
    let folder = tempfile::tempdir().unwrap();
    let job = folder.path().join("small.imp");
    let text = std::fs::read_to_string(JOB).unwrap();
    std::fs::write(&job, text.replacen("clearance >= 0.5 mm", "clearance >= 0.4 mm", 1)).unwrap();
    std::fs::copy("jobs/small/vane_curves.csv", folder.path().join("vane_curves.csv")).unwrap();
    let mut forged = json(&certificate(dialect));
    let found = forged["measured"]["contracts"][0]["found"].as_f64().unwrap();
    forged["measured"]["contracts"][0]["found"] = Value::from(found + 0.01);
    let file = edited(&forged.to_string());
    let more = [CELLS[0], CELLS[1], machine[0], machine[1], "--error-format", "json", "--job"];
    let (ok, out, err) = belongs(&nc, &file.path, &[&more[..], &[job.to_str().unwrap()]].concat());
    assert!(!ok && out.contains("moves read as linuxcnc"), "{out}{err}");
    // An import that the job does not state.
    let mut imported = json(&certificate(dialect));
    imported["measured"]["imported"] = serde_json::json!({ "files": "wheel.step", "within": 0.001 });
    let (ok, _, said) = belongs(&nc, &edited(&imported.to_string()).path, &[&more[..], &[JOB]].concat());
    assert!(!ok && said.contains("states an import of wheel.step within 0.001 mm; the job states none"), "{said}");
    // Contracts that are not asked for.
    let mut wider = json(&certificate(dialect));
    let mut first = wider["measured"]["contracts"][0].clone();
    first["kind"] = Value::from("excess");
    wider["measured"]["contracts"].as_array_mut().unwrap().push(first);
    let (ok, _, said) = belongs(&nc, &edited(&wider.to_string()).path, &[&more[..], &[JOB]].concat());
    assert!(!ok && said.contains("the job has no such contract"), "{said}");
    let all = diagnostics(&err);
    let changed = all.iter().find(|d| d["message"].as_str().unwrap().contains("another job")).unwrap();
    assert_eq!(changed["notes"][0], "`small.imp` was changed", "{changed}");
    assert!(all.iter().any(|d| d["code"] == "IMP0829"), "{err}");
}

/// The job in the place of the NC text and the other way round, folders, and files that are not there.
#[test]
fn wrong_files_are_told_apart() {
    let nc = WRITTEN.path().join(DIALECTS[0]);
    let (nc, folder) = (nc.to_str().unwrap(), WRITTEN.path().to_str().unwrap());
    let missing = WRITTEN.path().join("missing");
    let missing = missing.to_str().unwrap();
    for (arguments, code, words) in [
        (vec!["verify", nc, "--job", nc], "IMP0101", "is NC text of siemens-840d, not a job"),
        (vec![nc], "IMP0101", "is NC text of siemens-840d, not a job"),
        (vec!["verify", JOB, "--job", JOB], "IMP0821", "give NC text"),
        (vec!["verify", nc, "--job", folder], "IMP0901", "it is a folder"),
        (vec!["verify", folder, "--job", JOB], "IMP0901", "give the NC text that the control would run"),
        (vec!["verify", nc, "--certificate", folder], "IMP0901", "it is a folder"),
        (vec!["verify", nc, "--certificate", nc], "IMP0826", "not JSON"),
        (vec!["verify", missing, "--job", JOB], "IMP0901", "there is no such file"),
        (vec!["verify", nc, "--job", missing], "IMP0901", "there is no such file"),
        (
            vec!["verify", nc, "--job", JOB, "--machine", "5mc850-c-linuxcnc", "--post", "linuxcnc"],
            "IMP0821",
            "its words are those of siemens-840d",
        ),
        (vec!["verify", nc, "--job", JOB, "--post", "siemens"], "IMP0902", "heidenhain"),
        (vec!["verify", nc, "--job", JOB, "--machine", "5mc850-d"], "IMP0902", "5mc850-c, 5mc850-c-linuxcnc"),
        (vec!["verify", nc, "--job", "jobs/reduced/reduced.imp"], "IMP0822", "make tools, speeds and order"),
    ] {
        let run = impellerc(&arguments);
        let text = String::from_utf8_lossy(&run.stderr).into_owned();
        let flat = text.split_whitespace().filter(|w| *w != "│").collect::<Vec<_>>().join(" ");
        let exit = [("IMP0901", 3), ("IMP0822", 1)].into_iter().find(|(c, _)| *c == code).map_or(2, |(_, exit)| exit);
        assert_eq!(run.status.code(), Some(exit), "{arguments:?}: {text}");
        assert!(flat.contains(code) && flat.contains(words) && flat.contains("help:"), "{arguments:?}: {text}");
    }
}

/// A block of a slot with the feed of the links: the tool would break there.
#[test]
fn a_cut_at_link_feed_is_found() {
    let text = text("linuxcnc");
    let slot = line_of(&text, "(groove: a restart");
    let mut lines: Vec<String> = text.lines().map(|l| format!("{l}\n")).collect();
    // The first of two blocks with the feed of the block before.
    let states = |i: usize| lines[i].contains('F');
    let at = (slot + 1..lines.len()).find(|i| lines[i - 1].contains("F150") && !states(*i) && !states(i + 1)).unwrap();
    let feed = lines[at].trim_end().to_owned();
    lines[at] = format!("{feed} F700\n");
    lines[at + 1] = lines[at + 1].trim_end().to_owned() + " F150\n";
    let edited = edited(&lines.concat());
    let (ok, _, err) = verify(&edited.path, "linuxcnc", &["--error-format", "json"]);
    let found = diagnostics(&err);
    let found = found.iter().find(|d| d["code"] == "IMP0735").unwrap_or_else(|| panic!("{err}"));
    assert!(!ok && found["help"].as_str().unwrap().contains("process feed"), "{found}");
    assert_eq!(found["labels"][0]["line"].as_u64().unwrap() as usize, at + 1, "{found}");
}

/// Volume of a binary STL, and whether each of its edges belongs to an even number of triangles.
/// The setup sheet has the tools with their lengths, the restart points of the text, and checks by the machine file.
#[test]
fn a_setup_sheet_tells_what_the_machinist_needs() {
    let sheet = std::fs::read_to_string(WRITTEN.path().join("siemens-840d.md")).unwrap();
    let original = text("siemens-840d");
    for operation in ["groove", "flank", "channel"] {
        let line = line_of(&original, &format!("; {operation}: a restart point"));
        let row = sheet.lines().find(|l| l.starts_with(&format!("| {operation} |"))).unwrap();
        assert!(row.ends_with(&format!("| {line} |")), "{row} {line}");
    }
    let head = original.lines().find(|l| l.contains("tool t1 number")).unwrap();
    let length = head.split("length ").nth(1).unwrap().split(' ').next().unwrap();
    let row = sheet.lines().find(|l| l.starts_with("| 1 | t1 |")).unwrap();
    assert!(row.ends_with(&format!("| {length} |")), "{row} {length}");
    // Both tables of this machine have the sense "iso": a positive word turns them left-handed.
    assert_eq!(sheet.matches("the table must turn counter-clockwise").count(), 2, "{sheet}");
    assert!(sheet.contains("X 0, Y 0, Z 50 mm") && sheet.contains("gauge line at machine Z 650 mm"), "{sheet}");
    assert!(
        sheet.contains("At the end of the program the gauge line is at the retract height, machine Z 650 mm"),
        "{sheet}"
    );
    let page = std::fs::read_to_string(WRITTEN.path().join("linuxcnc.html")).unwrap();
    // LinuxCNC turns them the other way.
    assert_eq!(page.matches("the table must turn clockwise").count(), 2);
    assert!(page.starts_with("<!DOCTYPE html>") && page.ends_with("</body></html>\n") && !page.contains("<script"));
    assert_eq!(page.matches("<tr>").count(), page.matches("</tr>").count());
}

/// What is no source map is refused with the reason, and with what would be one.
#[test]
fn another_file_is_no_source_map() {
    let dialect = "siemens-840d";
    for path in [Path::new(JOB), &WRITTEN.path().join(format!("{dialect}.json"))] {
        let (ok, _, err) = verify(&WRITTEN.path().join(dialect), dialect, &["--source-map", path.to_str().unwrap()]);
        assert!(!ok && err.contains("IMP0831") && err.contains("`--source-map` wrote"), "{err}");
    }
}

/// The source map names pass, job line and cutter location of a block, also in a text with another block before it.
#[test]
fn a_source_map_names_the_pass_and_the_line_of_the_job() {
    let dialect = "siemens-840d";
    let map = WRITTEN.path().join(format!("{dialect}.map"));
    let original = text(dialect);
    let flank = line_of(&original, "; flank: a restart point");
    let cut = flank + original.lines().skip(flank).position(|l| l.contains(" G1 X")).unwrap() + 5;
    let mut lines: Vec<String> = original.lines().map(str::to_owned).collect();
    // 5 mm into the vane or the hub.
    let z: f64 = lines[cut].split(" Z").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    lines[cut] = lines[cut].replace(&format!(" Z{z:.4}"), &format!(" Z{:.4}", z - 5.0));
    assert_ne!(lines[cut], original.lines().nth(cut).unwrap());
    let faulty = edited(&(lines.join("\n") + "\n"));
    let more = ["--source-map", map.to_str().unwrap(), "--error-format", "json"];
    let (ok, _, err) = verify(&faulty.path, dialect, &more);
    assert!(!ok);
    let notes: Vec<String> = diagnostics(&err)
        .iter()
        .flat_map(|d| d["notes"].as_array().cloned().unwrap_or_default())
        .filter_map(|n| n.as_str().map(str::to_owned))
        .filter(|n| n.contains("was written for"))
        .collect();
    let job = std::fs::read_to_string(JOB).unwrap();
    let due = format!("was written for `flank`, line {} of small.imp", line_of(&job, "operation flank"));
    // The edited block itself is unknown; the finding is there or at a neighbour.
    assert!(notes.iter().any(|n| n.contains(&due)) || err.contains(&format!("blocks from line {}", cut + 1)), "{err}");
    let (_, out, _) = verify(&faulty.path, dialect, &more[..2]);
    assert!(out.contains(&format!("the source map knows {} of {} lines", lines.len() - 1, lines.len())), "{out}");
    // Whole, each block is known, with the cutter location that its words say.
    let file = SourceMapFile::read(&std::fs::read_to_string(&map).unwrap()).unwrap();
    let laid = LaidMap::new(file, &original);
    for (i, line) in original.lines().enumerate().filter(|(_, l)| l.contains(" G1 X")) {
        let (block, operation) = laid.block(i + 1).unwrap_or_else(|| panic!("line {}", i + 1));
        let words = ["X", "Y", "Z"].map(|w| line.split(&format!(" {w}")).nth(1).unwrap().split(' ').next().unwrap());
        for (word, x) in words.iter().zip(block.tip) {
            assert!((word.parse::<f64>().unwrap() - x).abs() < 0.51e-4, "{line} {block:?}");
        }
        assert!(operation.passes.len() > block.pass as usize && block.kind != "rapid");
    }
    let frame = laid.says(flank).unwrap();
    assert!(frame.contains("by the template in line") && frame.contains("posts/siemens-840d.toml"), "{frame}");
}

fn stl(path: &Path) -> (f64, bool) {
    let bytes = std::fs::read(path).unwrap();
    let number = |at: usize| f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
    let count = u32::from_le_bytes(bytes[80..84].try_into().unwrap()) as usize;
    assert_eq!(bytes.len(), 84 + 50 * count);
    let mut volume = 0.0;
    let mut edges = std::collections::BTreeMap::new();
    for t in 0..count {
        let corner = |k: usize| [0, 1, 2].map(|axis| number(84 + 50 * t + 12 * (k + 1) + 4 * axis));
        let corners = [corner(0), corner(1), corner(2)];
        let [a, b, c] = corners.map(|p| p.map(f64::from));
        volume += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]);
        volume += a[2] * (b[0] * c[1] - b[1] * c[0]);
        for (p, q) in [(0, 1), (1, 2), (2, 0)] {
            let mut ends = [corners[p].map(f32::to_bits), corners[q].map(f32::to_bits)];
            ends.sort_unstable();
            *edges.entry(ends).or_insert(0_usize) += 1;
        }
    }
    (volume / 6.0, count > 0 && edges.values().all(|n| n % 2 == 0))
}

/// The meshes are closed and hold what the certificate says is left after each operation.
#[test]
fn stock_is_written_as_closed_meshes() {
    let folder = tempfile::tempdir().unwrap();
    let stock = folder.path().join("stock");
    let path = WRITTEN.path().join("linuxcnc");
    let more = ["--stock", stock.to_str().unwrap(), "--stock-cell", "0.4", "--details"];
    let (ok, out, err) = verify(&path, "linuxcnc", &more);
    assert!(ok, "{err}");
    let table = out.split("stock: cells of ").nth(1).expect("a table");
    let cell: f64 = table.split(' ').next().unwrap().parse().unwrap();
    assert!(cell > 0.25 && cell <= 0.4, "{table}");
    let mut files: Vec<PathBuf> = std::fs::read_dir(&stock).unwrap().map(|f| f.unwrap().path()).collect();
    files.sort();
    let rows: Vec<Vec<&str>> =
        table.lines().skip(2).take(files.len()).map(|l| l.split_whitespace().collect()).collect();
    assert!(files.len() > 2 && rows[0][0] == "groove", "{table}");
    let mut before = f64::INFINITY;
    for (k, (file, row)) in files.iter().zip(&rows).enumerate() {
        assert_eq!(file.file_name().unwrap().to_str().unwrap(), format!("{:02}-{}.stl", k + 1, row[0]));
        let (volume, closed) = stl(file);
        let rest: f64 = row[3].parse().unwrap();
        // Edges of the mesh are rounded within a cell, planes and smooth surfaces are not.
        assert!(closed && (volume - rest).abs() < 0.005 * rest, "{}: {volume} {rest} {closed}", row[0]);
        assert!(volume < before, "each operation of the job removes something");
        before = volume;
    }
    let (ok, _, err) = verify(&path, "linuxcnc", &["--stock-cell", "0"]);
    assert!(!ok && err.contains("IMP0733"), "{err}");
}
