//! The part of `jobs/small` without tools and operations, in a folder of its own.

use super::bounded;
use std::path::Path;
use std::process::Output;
use tempfile::TempDir;

/// A folder with the part in `part.imp` on the machine that its job names, and some items behind it. It names no library of tools.
pub fn folder(items: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let job = std::fs::read_to_string("jobs/small/small.imp").unwrap();
    let part = job.split("\nstock ").next().unwrap().replace("use tools   \"carbide\"\n", "");
    assert!(!part.contains("use tools"), "{part}");
    std::fs::write(folder.path().join("part.imp"), format!("{part}\n{items}")).unwrap();
    std::fs::copy("jobs/small/vane_curves.csv", folder.path().join("vane_curves.csv")).unwrap();
    folder
}

/// Runs the program in a folder.
pub fn run(folder: &Path, words: &[&str]) -> Output {
    bounded::program().current_dir(folder).args(words).output().unwrap()
}

/// What a run printed: output, then errors.
pub fn said(run: &Output) -> String {
    String::from_utf8_lossy(&run.stdout).into_owned() + &String::from_utf8_lossy(&run.stderr)
}
