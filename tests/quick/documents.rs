//! The documents: links lead to files, commands are those of the command line, texts of the language have no fault.

use crate::support::sources::files;
use impellerc::base::source::SourceId;
use impellerc::diagnostics::Sink;
use impellerc::syntax;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Pages with their texts.
fn pages() -> Vec<(PathBuf, String)> {
    let folder = |name: &str| std::fs::read_dir(name).unwrap().map(|entry| entry.unwrap().path()).collect::<Vec<_>>();
    let all = folder(".").into_iter().chain(folder("docs"));
    let mut paths: Vec<PathBuf> = all.filter(|path| path.extension().is_some_and(|e| e == "md")).collect();
    paths.sort();
    paths.into_iter().map(|path| (path.clone(), std::fs::read_to_string(path).unwrap())).collect()
}

/// Files that a page links.
fn links(path: &Path, text: &str) -> Vec<PathBuf> {
    let targets = text.split("](").skip(1).filter_map(|rest| rest.split_once(')').map(|(target, _)| target));
    let own = targets.filter(|target| !target.starts_with("http") && !target.starts_with('#'));
    own.map(|target| path.parent().unwrap().join(target.split('#').next().unwrap())).collect()
}

#[test]
fn links_lead_to_files_and_every_page_is_linked() {
    let (contents, pages): (Vec<_>, Vec<_>) = pages().into_iter().partition(|(path, _)| path.ends_with("SUMMARY.md"));
    let docs = Path::new("docs").canonicalize().unwrap();
    let mut linked: BTreeSet<PathBuf> = BTreeSet::new();
    for (path, text) in &pages {
        for target in links(path, text) {
            assert!(target.exists(), "{} links {}", path.display(), target.display());
            let target = target.canonicalize().unwrap();
            // A book has its own pages and pictures alone.
            let of_book = path.starts_with("docs") || path.starts_with("./docs");
            assert!(!of_book || target.starts_with(&docs), "{} leaves the book: {}", path.display(), target.display());
            linked.insert(target);
        }
    }
    let mut of_docs = Vec::new();
    for (path, _) in pages.iter().filter(|(path, _)| path.starts_with("docs")) {
        let path = path.canonicalize().unwrap();
        assert!(linked.contains(&path), "no page links {}", path.display());
        of_docs.push(path);
    }
    // The contents of the book have each page once.
    let [(path, text)] = &contents[..] else { panic!("the contents of the book are missing") };
    let mut listed: Vec<PathBuf> = links(path, text).iter().map(|page| page.canonicalize().unwrap()).collect();
    listed.sort();
    of_docs.sort();
    assert_eq!(listed, of_docs);
}

/// A file that was removed or has another name is no longer named by a page.
#[test]
fn source_files_of_the_pages_exist() {
    let folders = ["src", "crates", "tests", "benches", "fuzz"].map(Path::new);
    let all = folders.into_iter().filter(|folder| folder.is_dir()).flat_map(files);
    let known: BTreeSet<String> = all.map(|path| path.file_name().unwrap().to_str().unwrap().to_owned()).collect();
    let mut seen = 0;
    for (path, text) in pages() {
        let quoted = text.split('`').skip(1).step_by(2).filter(|name| name.ends_with(".rs") && !name.contains(' '));
        for name in quoted {
            let file = name.rsplit('/').next().unwrap();
            assert!(known.contains(file), "{} names {name}", path.display());
            seen += 1;
        }
    }
    assert!(seen > 60, "{seen}");
}

#[test]
fn the_first_page_is_short() {
    let lines = std::fs::read_to_string("README.md").unwrap().lines().count();
    assert!(lines < 120, "{lines}");
}

/// In an empty folder, one for each of them, a command fails for want of its files, never for an option that it does not have.
#[test]
fn commands_of_the_documents_are_those_of_the_command_line() {
    let mut seen = 0;
    for (path, text) in pages() {
        // A command may go on in the next line.
        let text = text.replace("\\\n", " ");
        for line in text.lines().filter_map(|line| line.strip_prefix("    impellerc ")) {
            let folder = tempfile::tempdir().unwrap();
            let words = line.split("  #").next().unwrap().split_whitespace();
            let run = Command::new(env!("CARGO_BIN_EXE_impellerc"))
                .current_dir(folder.path())
                .args(words)
                .stdin(Stdio::null())
                .output()
                .unwrap();
            let said = String::from_utf8_lossy(&run.stderr);
            assert!(!said.contains("Usage: impellerc"), "{}: {line}\n{said}", path.display());
            seen += 1;
        }
    }
    assert!(seen > 20, "{seen}");
}

#[test]
fn texts_of_the_language_have_no_fault() {
    let mut seen = 0;
    for (path, text) in pages() {
        // Blocks with a word behind their fence are other languages, or parts of a job, which the test of their page puts together.
        let mut blocks: Vec<(&str, String)> = Vec::new();
        let mut inside = false;
        for line in text.lines() {
            match line.strip_prefix("```") {
                Some(word) if !inside => {
                    blocks.push((word, String::new()));
                    inside = true;
                }
                Some(_) => inside = false,
                None if inside => blocks.last_mut().unwrap().1 += &format!("{line}\n"),
                None => {}
            }
        }
        assert!(!inside, "{}: a block is not closed", path.display());
        for (_, block) in blocks.iter().filter(|(word, _)| word.is_empty()) {
            let mut sink = Sink::default();
            let file = syntax::parse(block, SourceId::default(), &mut sink);
            assert!(!file.faulty && !file.damaged, "{}:\n{block}\n{:?}", path.display(), sink.diags());
            seen += 1;
        }
    }
    assert!(seen >= 2, "{seen}");
}
