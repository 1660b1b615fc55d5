//! `impellerc verify` as a user runs it: on what the compiler wrote, and on the same with faults.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;

const JOB: &str = "jobs/reduced/reduced.imp";

const DIALECTS: [&str; 2] = ["siemens-840d", "linuxcnc"];

fn impellerc(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_impellerc")).args(arguments).output().unwrap()
}

/// The reduced job in both dialects, compiled once.
static WRITTEN: LazyLock<tempfile::TempDir> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    for dialect in DIALECTS {
        let out = folder.path().join(dialect);
        let run = impellerc(&[JOB, "--post", dialect, "-o", out.to_str().unwrap()]);
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
    let mut arguments = vec!["verify", path.to_str().unwrap(), "--job", JOB, "--post", dialect];
    arguments.extend(more);
    let run = impellerc(&arguments);
    let say = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (run.status.success(), say(&run.stdout), say(&run.stderr))
}

/// The diagnostics of a run with `--error-format json`.
fn diagnostics(text: &str) -> Vec<serde_json::Value> {
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
        assert!(out.contains("moves read as") && out.contains("clearance >= 0.5000 mm"), "{out}");
        let moves = text(dialect).lines().filter(|l| l.contains(" X") || l.contains("G0 X")).count();
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
    // The flank operation's retract out of its first pass: from there the rapid is moved onto the axis of the part.
    let start = line_of(&original, "(flank)");
    let index =
        (start..lines.len()).find(|i| lines[*i].starts_with("G0 X") && lines[*i - 1].starts_with("G1 X")).unwrap();
    let mut changed: Vec<String> = lines.iter().map(|l| (*l).to_owned()).collect();
    changed[index] = "G0 X0 Y0 Z-45".to_owned();
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

fn refused(dialect: &str, text: &str, code: &str, line: usize) -> serde_json::Value {
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
        let first_move = line_of(&original, "G0 X");
        // Another spindle speed, a tool that the job does not have, a feed that no operation has.
        refused(dialect, &original.replacen("S4500", "S4600", 1), "IMP0822", first_move);
        let tool = if dialect == "linuxcnc" { ("T1 M6\nG43 H1", "T9 M6\nG43 H9") } else { ("T=\"t1\"", "T=\"t9\"") };
        let unknown = refused(dialect, &original.replacen(tool.0, tool.1, 1), "IMP0822", first_move);
        assert!(unknown["message"].as_str().unwrap().contains("no tool"), "{unknown}");
        refused(dialect, &original.replacen("F1000.000", "F5000.000", 1), "IMP0823", line_of(&original, "F1000.000"));
        refused(dialect, &original.replacen("G0 X", "G1 F100 X", 1), "IMP0824", first_move);
        // Two operations less: what is missing is told after the last block.
        let from = line_of(&original, if dialect == "linuxcnc" { "(flank)" } else { "; flank" }) - 1;
        let end = if dialect == "linuxcnc" { "M2" } else { "M30" };
        let short = original.lines().take(from).map(|l| format!("{l}\n")).collect::<String>() + end + "\n";
        let last = short.lines().count() - short.lines().rev().position(|l| l.contains(" X")).unwrap();
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
    let parked = original.lines().find(|l| l.starts_with("G0 A")).unwrap();
    let turned = parked.replacen("G0 A-8", "G0 A-7", 1);
    assert_ne!(parked, turned);
    find("linuxcnc", parked, &turned, "IMP0824");
    find("siemens-840d", "CYCLE832(0.2000", "CYCLE832(0.9000", "IMP0825");
}

#[test]
fn a_check_needs_something_to_check_against() {
    let run = impellerc(&["verify", "nothing.nc"]);
    assert_eq!(run.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&run.stderr).contains("IMP0828"));
    let (ok, _, err) = verify(&WRITTEN.path().join("linuxcnc"), "fanuc", &[]);
    assert!(!ok && err.contains("IMP0807"), "{err}");
}
