//! The source files of the compiler, for tests that read them.

use std::path::{Path, PathBuf};

/// Rust files below a folder, sorted in each folder.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let mut entries: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    entries.sort();
    let below = |path: PathBuf| if path.is_dir() { files(&path) } else { vec![path] };
    entries.into_iter().flat_map(below).filter(|path| path.extension().is_some_and(|e| e == "rs")).collect()
}

/// The source folders of the compiler: that of the command, and those of its crates.
pub fn folders() -> Vec<PathBuf> {
    let crates = std::fs::read_dir("crates").unwrap().map(|e| e.unwrap().path().join("src"));
    let mut all: Vec<PathBuf> = crates.filter(|folder| folder.is_dir()).collect();
    all.push("src".into());
    all.sort();
    all
}

/// All Rust files of the compiler.
pub fn all_files() -> Vec<PathBuf> {
    folders().iter().flat_map(|folder| files(folder)).collect()
}
