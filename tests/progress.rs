//! What is said of long work: on a terminal the stages, in a pipe nothing.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::io::Write;
use std::process::{Command, Stdio};

const JOB: &str = "jobs/reduced/reduced.imp";

#[test]
fn pipes_see_nothing() {
    let output = Command::new(env!("CARGO_BIN_EXE_impellerc")).arg(JOB).output().unwrap();
    assert!(output.status.success());
    let (said, made) = (String::from_utf8(output.stderr).unwrap(), String::from_utf8(output.stdout).unwrap());
    assert!(!said.contains(['\u{1b}', '\r']), "control signs in {said:?}");
    assert!(!made.contains(['\u{1b}', '\r']), "control signs in {made:?}");
    // Diagnostics only: each begins with its code.
    for line in said.lines().filter(|l| l.contains("IMP")) {
        assert!(["IMP03", "IMP07"].iter().any(|c| line.contains(c)), "{line}");
    }
    for stage in ["plan ", "verify "] {
        assert!(!said.lines().any(|l| l.contains(stage) && l.contains("0:00:")), "{said:?} tells of `{stage}`");
    }
}

#[test]
fn a_terminal_sees_the_names_of_long_stages() {
    // `script` of util-linux gives the command a terminal.
    let there = Command::new("script").arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
    if !there.is_ok_and(|s| s.success()) {
        std::io::stderr().write_all(b"skipped: a terminal needs `script` of util-linux in PATH\n").unwrap();
        return;
    }
    let command = format!("'{}' {JOB} > /dev/null", env!("CARGO_BIN_EXE_impellerc"));
    let output = Command::new("script")
        .args(["--quiet", "--return", "--command", &command, "/dev/null"])
        .env("TERM", "xterm-256color")
        .output()
        .unwrap();
    assert!(output.status.success());
    let seen = String::from_utf8_lossy(&output.stdout).into_owned();
    // Planning or verifying takes more than a second here; reading the job never does.
    assert!(seen.contains("verify ") || seen.contains("plan "), "{seen:?}");
    assert!(!seen.contains("resolve"), "a short stage was shown: {seen:?}");
}
