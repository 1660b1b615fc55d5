//! Forged and stale certificates: changes in a certificate, in the head of its text, or in both with matching hashes.
//! Hashes alone reveal the first two; only a measurement of the text against the job reveals the third.

use super::Verdict::{self, Found, Harmless, Refused};
use impellerc::report::certificate_file::{CertificateFile, HEAD, NcText, named, sha256};
use rayon::prelude::*;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Output};
use std::sync::LazyLock;
use tempfile::TempDir;

/// Text and certificate as they are given to `verify`, and the files of the job.
#[derive(Clone)]
struct Given {
    nc: String,
    certificate: String,
    /// By the path below the folder of the job.
    job: BTreeMap<&'static str, String>,
    /// The text is measured against the job as well.
    measured: bool,
}

/// Class, what is done, the change, what has to become of it, words that say so, and why.
struct Kind(&'static str, &'static str, Box<dyn Fn(&mut Given) + Sync>, Verdict, &'static str, &'static str);

const MACHINE: &str = "_lib/machines/5mc850-c.toml";
const TOOLS: &str = "_lib/tools/carbide.toml";
const JOB: &str = "small.imp";
const CURVES: &str = "vane_curves.csv";

/// The largest cells that a job may have: the stock has no part in what is told here.
const CELLS: [&str; 2] = ["--stock-cell", "1"];

fn impellerc(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_impellerc")).current_dir(folder).args(arguments).output().unwrap()
}

fn placed(given: &Given) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let files = given.job.iter().map(|(name, text)| (*name, text));
    for (name, text) in files.chain([("part.nc", &given.nc), ("part.json", &given.certificate)]) {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    folder
}

fn compiled(job: BTreeMap<&'static str, String>, more: &[&str]) -> Given {
    let mut given = Given { nc: String::new(), certificate: String::new(), job, measured: false };
    let folder = placed(&given);
    let run =
        impellerc(folder.path(), &[&[JOB, "-o", "part.nc", "--certificate", "part.json"][..], &CELLS, more].concat());
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    given.nc = std::fs::read_to_string(folder.path().join("part.nc")).unwrap();
    given.certificate = std::fs::read_to_string(folder.path().join("part.json")).unwrap();
    given
}

/// The small job without its flanks, with its library beside it.
static ORIGINAL: LazyLock<Given> = LazyLock::new(|| {
    let read = |path: &str| std::fs::read_to_string(Path::new("jobs").join(path)).unwrap();
    let job = [(JOB, "small/small.imp"), (CURVES, "small/vane_curves.csv"), (MACHINE, MACHINE), (TOOLS, TOOLS)];
    let mut job: BTreeMap<_, _> = job.map(|(name, path)| (name, read(path))).into();
    let text = job.get_mut(JOB).unwrap();
    let [flank, channel] = ["operation flank", "operation channel"].map(|words| text.find(words).unwrap());
    text.replace_range(flank..channel, "");
    // The floor is finished beside what the flanks would have cut, in few lines.
    *text = text.replace("max-depth 4 mm", "max-depth 9 mm").replace("scallop 0.2 mm", "scallop 0.8 mm");
    *text = text.replace("tolerance chord", "allow slot on channel \"no flank before\"\ntolerance chord");
    compiled(job, &[])
});

/// The same for LinuxCNC.
static OTHER_POST: LazyLock<Given> =
    LazyLock::new(|| compiled(ORIGINAL.job.clone(), &["--post", "linuxcnc", "--machine", "5mc850-c-linuxcnc"]));

/// The same with a wider contract on clearance and slower axes.
static OTHER_JOB: LazyLock<Given> = LazyLock::new(|| {
    let mut job = ORIGINAL.job.clone();
    replace(job.get_mut(JOB).unwrap(), "clearance >= 0.5 mm", "clearance >= 0.4 mm");
    compiled(job, &[])
});

fn replace(text: &mut String, from: &str, to: &str) {
    assert!(text.contains(from), "{from:?} is not in the text");
    *text = text.replacen(from, to, 1);
}

/// An edit of the text of the certificate, behind a place.
fn edit(given: &mut Given, behind: &str, from: &str, to: &str) {
    let at = given.certificate.rfind(behind).unwrap_or_else(|| panic!("{behind} is not in the certificate"));
    let found = at + given.certificate[at..].find(from).unwrap_or_else(|| panic!("{from} behind {behind}"));
    given.certificate.replace_range(found..found + from.len(), to);
}

/// Another value at a place of the certificate.
fn set(given: &mut Given, pointer: &str, value: impl Into<Value>) {
    let mut all: Value = serde_json::from_str(&given.certificate).unwrap();
    *all.pointer_mut(pointer).unwrap_or_else(|| panic!("{pointer}")) = value.into();
    given.certificate = serde_json::to_string_pretty(&all).unwrap() + "\n";
}

fn figure(given: &Given, pointer: &str) -> f64 {
    let all: Value = serde_json::from_str(&given.certificate).unwrap();
    all.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("{pointer}"))
}

/// The index of the contract of a kind.
fn contract(given: &Given, kind: &str) -> usize {
    let all: Value = serde_json::from_str(&given.certificate).unwrap();
    let contracts = all["measured"]["contracts"].as_array().unwrap();
    contracts.iter().position(|c| c["kind"] == kind).unwrap()
}

fn scale(given: &mut Given, pointer: &str, factor: f64) {
    let value = figure(given, pointer) * factor;
    set(given, pointer, value);
}

/// The first other digit in the place of one of a hash in the head of the text.
fn other_digit(given: &mut Given, word: &str) {
    let at = given.nc.find(word).unwrap() + word.len();
    let digit = if given.nc[at..].starts_with('0') { "1" } else { "0" };
    given.nc.replace_range(at..=at, digit);
}

fn line_with(text: &str, word: &str) -> String {
    text.lines().find(|l| l.contains(word)).unwrap().to_owned() + "\n"
}

/// All hashes fit again, as a forger with the compiler at hand would make them.
fn sealed(given: &mut Given) {
    let body = named(&given.nc, HEAD[1]).unwrap().to_owned();
    let mut file: CertificateFile = serde_json::from_str(&given.certificate).unwrap();
    let now = NcText::new(&file.nc.post, &given.nc, Vec::new());
    given.nc = given.nc.replacen(&body, &now.body_sha256, 1);
    let assumed = std::mem::take(&mut file.nc.assumed);
    let sealed = NcText::new(&file.nc.post, &given.nc, std::mem::take(&mut file.nc.operations));
    file.nc = NcText { assumed, ..sealed };
    given.certificate = file.json().unwrap();
    let before = named(&given.nc, HEAD[2]).unwrap().to_owned();
    given.nc = given.nc.replacen(&before, &sha256(given.certificate.as_bytes()), 1);
}

macro_rules! kind {
    ($class:expr, $what:expr, $due:expr, $words:expr, $why:expr, $change:expr) => {
        Kind($class, $what, Box::new($change), $due, $words, $why)
    };
}

/// Words of a certificate that is not the one that the head names.
const ANOTHER: &str = "names another certificate";

fn figures() -> Vec<Kind> {
    const C: &str = "figures";
    let seen = "the head names the hash of the whole file";
    vec![
        kind!(C, "gouge lowered", Refused, ANOTHER, seen, |g| {
            let k = contract(g, "gouge");
            scale(g, &format!("/measured/contracts/{k}/found"), 0.5);
        }),
        kind!(C, "gouge raised", Refused, ANOTHER, seen, |g| {
            let k = contract(g, "gouge");
            scale(g, &format!("/measured/contracts/{k}/found"), 1.1);
        }),
        kind!(C, "clearance raised", Refused, ANOTHER, seen, |g| {
            let k = contract(g, "clearance");
            scale(g, &format!("/measured/contracts/{k}/found"), 2.0);
        }),
        kind!(C, "last digit of a figure", Refused, ANOTHER, seen, |g| {
            edit(g, "\"measured\"", "\"area\": 1", "\"area\": 2");
        }),
        kind!(C, "bound of a surface", Refused, ANOTHER, seen, |g| scale(g, "/measured/surfaces/0/gouge_bound", 0.5)),
        kind!(C, "most left on a surface", Refused, ANOTHER, seen, |g| {
            scale(g, "/measured/surfaces/0/excess/value", 0.5);
        }),
        kind!(C, "kept surface", Refused, ANOTHER, seen, |g| set(g, "/measured/kept/surfaces/0/gouge_bound", -1.0)),
        kind!(C, "allowed gouge of kept surfaces", Refused, ANOTHER, seen, |g| set(g, "/measured/kept/allowed", 5.0)),
        kind!(C, "length of an operation", Refused, ANOTHER, seen, |g| set(g, "/measured/operations/0/length/0", 1.0)),
        kind!(C, "axis travel", Refused, ANOTHER, seen, |g| set(g, "/measured/machine/axes/0/used/0", 0.0)),
        kind!(C, "contracts under another name", Refused, "form is wrong", "a field is missing", |g| {
            edit(g, "\"measured\"", "\"contracts\"", "\"contract\"");
        }),
        kind!(C, "name of the part", Refused, ANOTHER, seen, |g| set(g, "/measured/name", "other")),
        kind!(C, "name of the machine", Refused, ANOTHER, seen, |g| set(g, "/measured/machine_name", "other")),
        kind!(C, "null", Refused, "no figures", "a contract without figure is none", |g| {
            set(g, "/measured/contracts/0/found", Value::Null);
        }),
        kind!(C, "bound null", Refused, "no figures", "a contract without figure is none", |g| {
            set(g, "/measured/contracts/0/bound", Value::Null);
        }),
        kind!(C, "text", Refused, "no figures", "a figure is a number", |g| {
            set(g, "/measured/contracts/0/found", "0.0001");
        }),
        kind!(C, "NaN", Refused, "not JSON", "JSON has no such number", |g| {
            edit(g, "\"contracts\"", "\"found\": ", "\"found\": NaN, \"said\": ");
        }),
        kind!(C, "infinity", Refused, "not JSON", "JSON has no such number", |g| {
            edit(g, "\"contracts\"", "\"found\": ", "\"found\": Infinity, \"said\": ");
        }),
        kind!(C, "beyond all numbers", Refused, "not JSON", "no finite number", |g| {
            edit(g, "\"contracts\"", "\"bound\": ", "\"bound\": 1e999, \"said\": ");
        }),
        kind!(C, "below all numbers", Refused, "not JSON", "no finite number", |g| {
            edit(g, "\"contracts\"", "\"found\": ", "\"found\": -1e999, \"said\": ");
        }),
    ]
}

fn contracts() -> Vec<Kind> {
    const C: &str = "contracts";
    let seen = "the head names the hash of the whole file";
    vec![
        kind!(C, "widened", Refused, ANOTHER, seen, |g| {
            let k = contract(g, "gouge");
            scale(g, &format!("/measured/contracts/{k}/bound"), 10.0);
        }),
        kind!(C, "one taken out", Refused, ANOTHER, seen, |g| {
            let mut all: Value = serde_json::from_str(&g.certificate).unwrap();
            all["measured"]["contracts"].as_array_mut().unwrap().remove(0);
            g.certificate = all.to_string();
        }),
        kind!(C, "all taken out", Refused, ANOTHER, seen, |g| set(g, "/measured/contracts", Vec::<Value>::new())),
        kind!(C, "no list", Refused, "no figures", "contracts are a list", |g| set(g, "/measured/contracts", 3)),
        kind!(C, "one too many", Refused, ANOTHER, seen, |g| {
            let mut all: Value = serde_json::from_str(&g.certificate).unwrap();
            let list = all["measured"]["contracts"].as_array_mut().unwrap();
            list.push(list[0].clone());
            g.certificate = all.to_string();
        }),
        kind!(C, "another scope", Refused, ANOTHER, seen, |g| set(g, "/measured/contracts/0/scope", "on hub")),
        kind!(C, "another kind", Refused, ANOTHER, seen, |g| set(g, "/measured/contracts/0/kind", "excess")),
        kind!(C, "another unit", Refused, ANOTHER, seen, |g| set(g, "/measured/contracts/0/unit", "um")),
        kind!(C, "does not hold", Refused, "does not hold", "no text is written then", |g| {
            set(g, "/measured/contracts/0/holds", false);
        }),
        kind!(C, "holds in words", Refused, "no figures", "true or false", |g| {
            set(g, "/measured/contracts/0/holds", "true");
        }),
        kind!(C, "what is allowed", Refused, ANOTHER, seen, |g| {
            set(g, "/measured/allowed", vec![Value::from("gouge")]);
        }),
    ]
}

fn hashes() -> Vec<Kind> {
    const C: &str = "hashes";
    let zeros = || "0".repeat(64);
    let of_head = "the head is in the certificate's hash of it";
    vec![
        kind!(C, "body in the certificate", Refused, "another text", "it is not that of the text", move |g| {
            set(g, "/nc/body_sha256", zeros());
        }),
        kind!(C, "head in the certificate", Refused, "another head of the text", "not that of the text", move |g| {
            set(g, "/nc/head_sha256", zeros());
        }),
        kind!(C, "inputs in the certificate", Refused, "other inputs", "not those that the head names", move |g| {
            set(g, "/inputs/sha256", zeros());
        }),
        kind!(
            C,
            "a file in the certificate",
            Refused,
            ANOTHER,
            "the head names the hash of the whole file",
            move |g| {
                set(g, "/inputs/files/0/sha256", zeros());
            }
        ),
        kind!(C, "a run in the certificate", Refused, ANOTHER, "the head names the hash of the whole file", |g| {
            set(g, "/nc/runs/0", "0123456789abcdef");
        }),
        kind!(C, "a line of the head in the certificate", Refused, ANOTHER, "the hash of the whole file", |g| {
            set(g, "/nc/head/0", "0123456789abcdef");
        }),
        kind!(C, "lines of operations", Refused, ANOTHER, "the hash of the whole file", |g| {
            set(g, "/nc/operations/0/first", 1);
        }),
        kind!(C, "lines of the body", Refused, ANOTHER, "the hash of the whole file", |g| set(g, "/nc/body_lines", 7)),
        kind!(C, "dialect", Refused, ANOTHER, "the hash of the whole file", |g| set(g, "/nc/post", "linuxcnc")),
        kind!(C, "lines that are none", Refused, "form is wrong", "a number of lines is not negative", |g| {
            set(g, "/nc/body_lines", -7);
        }),
        kind!(C, "inputs in the head", Refused, "other inputs", "not those of the certificate", |g| {
            other_digit(g, HEAD[0]);
        }),
        kind!(C, "body in the head", Refused, "differs from the one in its head", "not that of the text", |g| {
            other_digit(g, HEAD[1])
        }),
        kind!(C, "certificate in the head", Refused, ANOTHER, "not that of the file", |g| other_digit(g, HEAD[2])),
        kind!(
            C,
            "no inputs in the head",
            Refused,
            "the head of the text lacks inputs",
            "nobody could tell an edit",
            |g| {
                g.nc = g.nc.replacen(&line_with(&g.nc, HEAD[0]), "", 1);
            }
        ),
        kind!(C, "no body in the head", Refused, "the head of the text lacks body", "nobody could tell an edit", |g| {
            g.nc = g.nc.replacen(&line_with(&g.nc, HEAD[1]), "", 1);
        }),
        kind!(
            C,
            "no certificate in the head",
            Refused,
            "the head of the text lacks certificate",
            "nobody could tell",
            |g| {
                g.nc = g.nc.replacen(&line_with(&g.nc, HEAD[2]), "", 1);
            }
        ),
        kind!(C, "certificate named twice, the right one last", Refused, "IMP0827", of_head, |g| {
            let line = line_with(&g.nc, HEAD[2]);
            let hash = named(&g.nc, HEAD[2]).unwrap().to_owned();
            let wrong = line.replacen(&hash, &"0".repeat(64), 1);
            g.nc = g.nc.replacen(&line, &format!("{wrong}{line}"), 1);
        }),
        kind!(C, "certificate named twice, the right one first", Refused, "IMP0827", of_head, |g| {
            let line = line_with(&g.nc, HEAD[2]);
            let hash = named(&g.nc, HEAD[2]).unwrap().to_owned();
            let wrong = line.replacen(&hash, &"0".repeat(64), 1);
            g.nc = g.nc.replacen(&line, &format!("{line}{wrong}"), 1);
        }),
        kind!(C, "hash cut short", Refused, "the head of the text lacks certificate", "a hash has 64 digits", |g| {
            let hash = named(&g.nc, HEAD[2]).unwrap().to_owned();
            g.nc = g.nc.replacen(&hash, &hash[..60], 1);
        }),
        kind!(C, "hash in large letters", Refused, ANOTHER, "hashes are written in small letters", |g| {
            let hash = named(&g.nc, HEAD[2]).unwrap().to_owned();
            g.nc = g.nc.replacen(&hash, &hash.to_uppercase(), 1);
        }),
        kind!(
            C,
            "hash behind the first block",
            Refused,
            "the head of the text lacks certificate",
            "the head ends there",
            |g| {
                let line = line_with(&g.nc, HEAD[2]);
                g.nc = g.nc.replacen(&line, "", 1);
                let at = g.nc.find("G17").unwrap();
                let end = at + g.nc[at..].find('\n').unwrap() + 1;
                g.nc.insert_str(end, &line);
            }
        ),
        kind!(C, "figure in the head", Refused, "another head of the text", of_head, |g| {
            let line = line_with(&g.nc, "; gouge ");
            g.nc = g.nc.replacen(&line, &line.replacen("um", "nm", 1), 1);
        }),
        kind!(C, "length of a tool in the head", Refused, "another head of the text", of_head, |g| {
            let line = line_with(&g.nc, "tool t1 number");
            g.nc = g.nc.replacen(&line, &line.replacen("length 1", "length 2", 1), 1);
        }),
        kind!(C, "a line more in the head", Refused, "another head of the text", of_head, |g| {
            g.nc.insert_str(0, "; approved\n");
        }),
        kind!(C, "a comment in the body", Refused, "another text", "the body is hashed as it is", |g| {
            replace(&mut g.nc, "M6 ; groove", "M6 ; roughing");
        }),
        kind!(C, "one digit of a block", Refused, "another text", "the body is hashed as it is", |g| {
            let at = g.nc.rfind(" X1").unwrap();
            g.nc.replace_range(at..at + 3, " X2");
        }),
        kind!(C, "line ends", Refused, "another text", "the body is hashed as it is", |g| {
            g.nc = g.nc.replace('\n', "\r\n");
        }),
        kind!(C, "a line behind the end", Refused, "another text", "the body is hashed as it is", |g| {
            g.nc.push_str("; end\n");
        }),
    ]
}

fn forms() -> Vec<Kind> {
    const C: &str = "form";
    let version = |v: &'static str| {
        move |g: &mut Given| {
            let at = g.certificate.find("\"version\": ").unwrap() + "\"version\": ".len();
            let end = at + g.certificate[at..].find(',').unwrap();
            g.certificate.replace_range(at..end, v);
        }
    };
    vec![
        kind!(C, "older", Refused, "version 1", "its fields had other meanings", version("1")),
        kind!(C, "newer", Refused, "version 3", "its fields are not known", version("3")),
        kind!(C, "version in words", Refused, "does not state the version", "a number", version("\"2\"")),
        kind!(C, "version null", Refused, "does not state the version", "a number", version("null")),
        kind!(C, "version below zero", Refused, "does not state the version", "a number", version("-2")),
        kind!(
            C,
            "version twice",
            Refused,
            "stands twice",
            "readers take one or the other",
            version("2, \"version\": 2")
        ),
        kind!(C, "another format", Refused, "does not begin with the format", "it is no certificate", |g| {
            set(g, "/format", "certificate");
        }),
        kind!(C, "holds twice", Refused, "stands twice", "readers take one or the other", |g| {
            edit(g, "\"contracts\"", "\"holds\": true", "\"holds\": false, \"holds\": true");
        }),
        kind!(C, "found twice", Refused, "stands twice", "readers take one or the other", |g| {
            edit(g, "\"contracts\"", "\"found\": ", "\"found\": 0.0001, \"found\": ");
        }),
        kind!(C, "contracts twice", Refused, "stands twice", "readers take one or the other", |g| {
            edit(g, "\"contracts\"", "\"contracts\"", "\"contracts\": [], \"contracts\"");
        }),
        kind!(C, "measured twice", Refused, "stands twice", "readers take one or the other", |g| {
            edit(g, "\"measured\"", "\"measured\"", "\"measured\": {}, \"measured\"");
        }),
        kind!(C, "key twice by its escape", Refused, "stands twice", "an escape is the same letter", |g| {
            edit(g, "\"contracts\"", "\"holds\": true", "\"h\\u006flds\": false, \"holds\": true");
        }),
        kind!(C, "no measured", Refused, "form is wrong", "a field is missing", |g| {
            let mut all: Value = serde_json::from_str(&g.certificate).unwrap();
            all.as_object_mut().unwrap().remove("measured");
            g.certificate = all.to_string();
        }),
        kind!(C, "no nc", Refused, "form is wrong", "a field is missing", |g| {
            let mut all: Value = serde_json::from_str(&g.certificate).unwrap();
            all.as_object_mut().unwrap().remove("nc");
            g.certificate = all.to_string();
        }),
        kind!(C, "no inputs", Refused, "form is wrong", "a field is missing", |g| {
            let mut all: Value = serde_json::from_str(&g.certificate).unwrap();
            all.as_object_mut().unwrap().remove("inputs");
            g.certificate = all.to_string();
        }),
        kind!(C, "a list", Refused, "format", "a certificate is an object", |g| {
            g.certificate = format!("[{}]", g.certificate);
        }),
        kind!(C, "empty", Refused, "not JSON", "nothing is there", |g| g.certificate.clear()),
        kind!(C, "cut in the middle", Refused, "not JSON", "it does not end", |g| {
            g.certificate.truncate(g.certificate.len() / 2);
        }),
        kind!(C, "last bracket cut", Refused, "not JSON", "it does not end", |g| {
            g.certificate = g.certificate.trim_end().trim_end_matches('}').to_owned();
        }),
        kind!(C, "something behind it", Refused, "not JSON", "one value only", |g| g.certificate.push_str("{}")),
        kind!(C, "byte order mark", Refused, "not JSON", "no JSON begins so", |g| g.certificate.insert(0, '\u{feff}')),
        kind!(C, "a comment", Refused, "not JSON", "JSON has none", |g| g.certificate.insert_str(0, "// checked\n")),
        kind!(C, "no spaces", Refused, ANOTHER, "the file is hashed as it is", |g| {
            let all: Value = serde_json::from_str(&g.certificate).unwrap();
            g.certificate = all.to_string();
        }),
        kind!(C, "line ends", Refused, ANOTHER, "the file is hashed as it is", |g| {
            g.certificate = g.certificate.replace('\n', "\r\n");
        }),
        kind!(C, "a space more at its end", Refused, ANOTHER, "the file is hashed as it is", |g| g
            .certificate
            .push(' ')),
        kind!(C, "the NC text", Refused, "not JSON", "it is no certificate", |g| g.certificate = g.nc.clone()),
    ]
}

fn others() -> Vec<Kind> {
    const C: &str = "of another";
    vec![
        kind!(C, "job", Refused, "IMP0827", "its contracts are others", |g| {
            g.certificate = OTHER_JOB.certificate.clone();
        }),
        kind!(C, "dialect", Refused, "another text", "it was written for other words", |g| {
            g.certificate = OTHER_POST.certificate.clone();
        }),
        kind!(C, "text of another dialect", Refused, "another text", "certificates of both are swapped", |g| {
            g.nc = OTHER_POST.nc.clone();
        }),
        kind!(C, "text of another job", Refused, "IMP0827", "certificates of both are swapped", |g| {
            g.nc = OTHER_JOB.nc.clone();
        }),
        kind!(C, "compiler", Refused, ANOTHER, "the head names the hash of the whole file", |g| {
            set(g, "/compiler", "impellerc 99.0.0");
        }),
    ]
}

fn stale() -> Vec<Kind> {
    const C: &str = "stale";
    let change = |file: &'static str, from: &'static str, to: &'static str| {
        move |g: &mut Given| {
            g.measured = true;
            replace(g.job.get_mut(file).unwrap(), from, to);
        }
    };
    vec![
        kind!(C, "nothing changed", Harmless, "belong together", "it is as it was written", |g| g.measured = true),
        kind!(
            C,
            "a comment in the job",
            Refused,
            "`small.imp` was changed",
            "inputs are hashed as they are",
            change(JOB, "edition 2026", "// later\nedition 2026")
        ),
        kind!(
            C,
            "a contract in the job",
            Refused,
            "`small.imp` was changed",
            "it says another bound",
            change(JOB, "clearance >= 0.5 mm", "clearance >= 0.6 mm")
        ),
        kind!(
            C,
            "the machine",
            Refused,
            "`machines/5mc850-c.toml` was changed",
            "inputs are hashed as they are",
            change(MACHINE, "kind =", "# later\nkind =")
        ),
        kind!(
            C,
            "the tools",
            Refused,
            "`tools/carbide.toml` was changed",
            "inputs are hashed as they are",
            change(TOOLS, "about =", "# later\nabout =")
        ),
        kind!(
            C,
            "the curves",
            Refused,
            "`vane_curves.csv` was changed",
            "inputs are hashed as they are",
            change(CURVES, "# curve", "# later\n# curve")
        ),
    ]
}

/// Forged so that all hashes fit: alone it cannot be told, and is not meant to; measured against the job it is.
fn sealed_again() -> Vec<Kind> {
    const C: &str = "sealed again";
    let forged = |change: fn(&mut Given)| {
        move |g: &mut Given| {
            change(g);
            sealed(g);
            g.measured = true;
        }
    };
    vec![
        kind!(C, "nothing changed", Harmless, "belong together", "the same pair", forged(|_| {})),
        kind!(
            C,
            "another dialect",
            Found,
            "IMP0829",
            "the text is not in it",
            forged(|g| g.certificate = g.certificate.replacen("\"post\": \"siemens-840d\"", "\"post\": \"fanuc\"", 1))
        ),
        kind!(
            C,
            "a condition left out",
            Found,
            "IMP0829",
            "the proof has it",
            forged(|g| {
                let mut file: CertificateFile = serde_json::from_str(&g.certificate).unwrap();
                file.nc.assumed.pop().unwrap();
                g.certificate = file.json().unwrap();
            })
        ),
        kind!(
            C,
            "a tool length of the head",
            Found,
            "IMP0832",
            "the machinist sets the tool by it",
            forged(|g| g.nc =
                g.nc.replacen(" mm from the tip to the gauge line", "1 mm from the tip to the gauge line", 1))
        ),
        kind!(
            C,
            "the zero of the head",
            Found,
            "IMP0832",
            "the machinist sets the zero by it",
            forged(|g| g.nc = g.nc.replacen("zero at the origin", "zero 10 mm above the origin", 1))
        ),
        kind!(
            C,
            "a figure of the head",
            Found,
            "IMP0832",
            "another one is measured",
            forged(|g| g.nc = g.nc.replacen("gouge 0.", "gouge 0.0", 1))
        ),
        kind!(
            C,
            "a distance to the clamping",
            Found,
            "IMP0829",
            "another figure is measured",
            forged(|g| scale(g, "/measured/clamping/distance", 2.0))
        ),
        kind!(
            C,
            "the height over the blank",
            Found,
            "IMP0829",
            "another figure is measured",
            forged(|g| scale(g, "/measured/perimeter/clearance", 2.0))
        ),
        kind!(
            C,
            "a distance of the shank",
            Found,
            "IMP0829",
            "another figure is measured",
            forged(|g| scale(g, "/measured/operations/0/shank/distance", 2.0))
        ),
        kind!(
            C,
            "the way of an axis",
            Found,
            "IMP0829",
            "another figure is measured",
            forged(|g| scale(g, "/measured/machine/axes/1/used/1", 0.9))
        ),
        kind!(
            C,
            "the speed of an axis",
            Found,
            "IMP0829",
            "another figure is measured",
            forged(|g| scale(g, "/measured/machine/axes/4/speed_share", 0.5))
        ),
        kind!(
            C,
            "a machining time",
            Found,
            "IMP0829",
            "another figure is measured",
            forged(|g| scale(g, "/measured/operations/0/time/0", 0.5))
        ),
        kind!(
            C,
            "a volume that is removed",
            Found,
            "IMP0829",
            "another figure is measured",
            forged(|g| scale(g, "/measured/stock/operations/0/removed", 0.9))
        ),
        kind!(
            C,
            "the depth of a cut",
            Found,
            "IMP0829",
            "another figure is measured",
            forged(|g| scale(g, "/measured/stock/operations/0/depth/value", 0.5))
        ),
        kind!(
            C,
            "no stock at all",
            Found,
            "IMP0829",
            "another figure is measured",
            forged(|g| {
                let mut all: Value = serde_json::from_str(&g.certificate).unwrap();
                all["measured"]["stock"] = Value::Null;
                g.certificate = all.to_string();
            })
        ),
        kind!(
            C,
            "a stock in other cells",
            Found,
            "IMP0829",
            "another figure is measured in these cells",
            forged(|g| scale(g, "/measured/stock/cell", 0.8))
        ),
        kind!(
            C,
            "a stock in cells that show nothing",
            Found,
            "IMP0829",
            "such cells are not taken from a certificate",
            forged(|g| scale(g, "/measured/stock/cell", 100.0))
        ),
        kind!(
            C,
            "gouge lowered",
            Found,
            "IMP0829",
            "another figure is measured",
            forged(|g| {
                let k = contract(g, "gouge");
                scale(g, &format!("/measured/contracts/{k}/found"), 0.5);
            })
        ),
        kind!(
            C,
            "clearance raised",
            Found,
            "IMP0829",
            "another figure is measured",
            forged(|g| {
                let k = contract(g, "clearance");
                scale(g, &format!("/measured/contracts/{k}/found"), 2.0);
            })
        ),
        kind!(
            C,
            "contract widened",
            Found,
            "IMP0829",
            "the job asks for less",
            forged(|g| {
                let k = contract(g, "gouge");
                scale(g, &format!("/measured/contracts/{k}/bound"), 10.0);
            })
        ),
        kind!(
            C,
            "contract taken out",
            Found,
            "no such contract",
            "the job asks for it",
            forged(|g| {
                let mut all: Value = serde_json::from_str(&g.certificate).unwrap();
                all["measured"]["contracts"].as_array_mut().unwrap().remove(0);
                g.certificate = all.to_string();
            })
        ),
        kind!(
            C,
            "contract added",
            Found,
            "the job has no such contract",
            "the job does not ask for it",
            forged(|g| {
                let mut all: Value = serde_json::from_str(&g.certificate).unwrap();
                let list = all["measured"]["contracts"].as_array_mut().unwrap();
                list.push(list[0].clone());
                g.certificate = all.to_string();
            })
        ),
        kind!(
            C,
            "excess of a surface lowered",
            Found,
            "excess value",
            "another figure is measured",
            forged(|g| {
                let all: Value = serde_json::from_str(&g.certificate).unwrap();
                let surfaces = all["measured"]["surfaces"].as_array().unwrap();
                let far = surfaces.iter().position(|s| s["excess"]["value"].as_f64().unwrap() > 0.01).unwrap();
                scale(g, &format!("/measured/surfaces/{far}/excess/value"), 0.5);
            })
        ),
        kind!(
            C,
            "bound of a surface raised",
            Found,
            "gouge bound",
            "another figure is measured",
            forged(|g| {
                set(g, "/measured/surfaces/0/gouge_bound", 0.1);
            })
        ),
        kind!(
            C,
            "surface taken out",
            Found,
            "states nothing for",
            "the part has it",
            forged(|g| {
                let mut all: Value = serde_json::from_str(&g.certificate).unwrap();
                all["measured"]["surfaces"].as_array_mut().unwrap().remove(0);
                g.certificate = all.to_string();
            })
        ),
        kind!(
            C,
            "kept surface renamed",
            Found,
            "IMP0829",
            "the part has no such surface",
            forged(|g| {
                set(g, "/measured/kept/surfaces/0/surface", "fin");
            })
        ),
        kind!(
            C,
            "inputs of the certificate",
            Refused,
            "another job",
            "the job given is another",
            forged(|g| {
                let before = named(&g.nc, HEAD[0]).unwrap().to_owned();
                set(g, "/inputs/sha256", "1".repeat(64));
                g.nc = g.nc.replacen(&before, &"1".repeat(64), 1);
            })
        ),
        kind!(
            C,
            "a block lowered by 1 mm",
            Found,
            "IMP0702",
            "the text gouges",
            forged(|g| {
                // The middle of the last operation, which cuts the hub.
                let lines: Vec<&str> = g.nc.lines().collect();
                let from = lines.iter().rposition(|l| l.contains("channel")).unwrap();
                let cuts: Vec<usize> =
                    (from..lines.len()).filter(|i| lines[*i].contains("G1 X") || lines[*i].contains(" X")).collect();
                let line = lines[cuts[cuts.len() / 2]];
                let at = line.find(" Z").unwrap() + 2;
                let end = line[at..].find(' ').map_or(line.len(), |n| at + n);
                let z: f64 = line[at..end].parse().unwrap();
                let lower = format!("{}{:.4}{}", &line[..at], z - 1.0, &line[end..]);
                g.nc = g.nc.replacen(&format!("{line}\n"), &format!("{lower}\n"), 1);
            })
        ),
        kind!(
            C,
            "spindle speed",
            Found,
            "IMP0822",
            "the job has another",
            forged(|g| {
                g.nc = g.nc.replace("S12000", "S9000");
            })
        ),
        kind!(
            C,
            "no head of the program",
            Found,
            "IMP0821",
            "units are not known",
            forged(|g| {
                replace(&mut g.nc, "G710 ", "");
            })
        ),
    ]
}

/// What becomes of what is given, with all that is said.
fn judged(given: &Given) -> (Verdict, String) {
    let folder = placed(given);
    let arguments = ["verify", "part.nc", "--certificate", "part.json", "--error-format", "json"];
    // The cells are those of the certificate.
    let measured = ["--job", JOB];
    let run = impellerc(folder.path(), &[&arguments[..], if given.measured { &measured } else { &[] }].concat());
    let said = format!("{}{}", String::from_utf8_lossy(&run.stdout), String::from_utf8_lossy(&run.stderr));
    assert!(!said.contains("panicked"), "{said}");
    let belongs = said.contains("belong together");
    let verdict = match run.status.code() {
        Some(0) if belongs => Harmless,
        // Hashes fit, and measuring finds it.
        Some(1 | 2) if belongs => Found,
        Some(1 | 2) => Refused,
        code => panic!("{code:?}: {said}"),
    };
    (verdict, said)
}

#[test]
fn forged_and_stale_certificates_are_told() {
    let kinds: Vec<Kind> =
        [figures(), contracts(), hashes(), forms(), others(), stale(), sealed_again()].into_iter().flatten().collect();
    let found: Vec<(Verdict, String)> = kinds
        .par_iter()
        .map(|kind| {
            let mut given = ORIGINAL.clone();
            (kind.2)(&mut given);
            judged(&given)
        })
        .collect();
    let mut counts: BTreeMap<(&str, Verdict), usize> = BTreeMap::new();
    let mut complaints = Vec::new();
    for (Kind(class, what, _, due, words, why), (verdict, said)) in kinds.iter().zip(&found) {
        *counts.entry((class, *verdict)).or_default() += 1;
        if verdict != due || !said.contains(words) {
            let said: String = said.chars().take(1500).collect();
            complaints.push(format!("{class}: {what}: {verdict:?}, due {due:?} with {words:?} ({why}): {said}"));
        }
    }
    super::print_counts("certificates", kinds.len(), &counts);
    assert!(complaints.is_empty(), "{} complaints\n{}", complaints.len(), complaints.join("\n"));
}
