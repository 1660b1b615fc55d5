//! `impellerc fmt`: nothing of a job is lost, the form is that of its own result, and files with faults stay as they are.

use impellerc::base::source::SourceId;
use impellerc::diagnostics::Sink;
use impellerc::syntax::{self, Unformatted};
use proptest::prelude::*;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

fn format(text: &str) -> Result<String, Unformatted> {
    syntax::format(text, SourceId::default(), &mut Sink::default())
}

/// All jobs of the project that can be read, those with faults of meaning among them.
fn jobs() -> Vec<(PathBuf, String)> {
    let folders = std::fs::read_dir("jobs").unwrap().map(|entry| entry.unwrap().path());
    let files = folders.filter(|path| path.is_dir()).flat_map(|folder| std::fs::read_dir(folder).unwrap());
    let paths = files.map(|file| file.unwrap().path()).filter(|path| path.extension().is_some_and(|e| e == "imp"));
    let mut read: Vec<_> = paths.filter_map(|path| Some((path.clone(), std::fs::read_to_string(path).ok()?))).collect();
    read.retain(|(_, text)| {
        let file = syntax::parse(text, SourceId::default(), &mut Sink::default());
        !file.faulty && !file.damaged
    });
    read.sort();
    read
}

/// What a text says, found without the formatter: comments in their order, and all other letters without blanks.
fn said(text: &str) -> (Vec<String>, String) {
    let (mut comments, mut rest) = (Vec::new(), String::new());
    for line in text.lines() {
        let mut quoted = false;
        let mut at = 0;
        let letters: Vec<char> = line.chars().collect();
        while at < letters.len() {
            quoted ^= letters[at] == '"';
            if !quoted && letters[at..].starts_with(&['/', '/']) {
                comments.push(letters[at..].iter().collect::<String>().trim_end().to_owned());
                break;
            }
            if quoted || !(letters[at].is_whitespace() || letters[at] == '\u{FEFF}') {
                rest.push(letters[at]);
            }
            at += 1;
        }
    }
    (comments, rest)
}

#[test]
fn all_jobs_keep_what_they_say() {
    let jobs = jobs();
    assert!(jobs.len() > 100, "{}", jobs.len());
    for (path, text) in jobs {
        let formatted = format(&text).unwrap_or_else(|e| panic!("{}: {e:?}", path.display()));
        assert_eq!(said(&text), said(&formatted), "{}", path.display());
        assert_eq!(format(&formatted).as_ref(), Ok(&formatted), "{} once more", path.display());
        assert!(formatted.lines().all(|line| line.trim_end() == line), "{}", path.display());
        assert!(!formatted.contains("\n\n\n"), "{}", path.display());
        // Jobs with faults stand as people write them.
        assert!(path.starts_with("jobs/_errors") || formatted == text, "{} is not in the usual form", path.display());
    }
}

#[test]
fn the_usual_form() {
    let text = "edition 2026\n\n\n\nuse machine \"5mc850-c\" // machine\nuse tools \"carbide\"   // tools\n\
        part p{vanes 8\nvane main{\n\npressure ruled{tip spline [\n(1,-22.5,3)\n(10 , 2, 3.25)\n]mm\n\
        root spline [(1,2,3)\n// between\n(4,5,6)]   mm}\n\n}}\n\
        tool t1=ball{diameter 6 mm flutes 4}\ntool long = ball {diameter 10 mm   flutes 2}\n\
        operation flank{tool t1 feed 100 mm/min\nallowance vane 0.2 mm,\nhub 0.3 mm}\n\
        require gouge<=2 um\nrequire clearance >= 2*gap - 0.5 mm\n";
    let usual = "edition 2026\n\nuse machine \"5mc850-c\"  // machine\nuse tools   \"carbide\"   // tools\n\
        part p { vanes 8\n  vane main {\n    pressure ruled { tip spline [\n      ( 1, -22.5,    3)\n      (10,     2, 3.25)\n    ] mm\n\
        \u{20}     root spline [(1, 2, 3)\n                   // between\n                   (4, 5, 6)] mm }\n  } }\n\
        tool t1   = ball { diameter 6 mm   flutes 4 }\ntool long = ball { diameter 10 mm  flutes 2 }\n\
        operation flank { tool t1  feed 100 mm/min\n  allowance vane 0.2 mm,\n    hub 0.3 mm }\n\
        require gouge     <= 2 um\nrequire clearance >= 2*gap - 0.5 mm\n";
    assert_eq!(format(text).as_deref(), Ok(usual));
    assert_eq!(format(&text.replace('\n', "\r\n")).as_deref(), Ok(usual), "line ends of other systems");
}

#[test]
fn a_job_with_faults_has_no_usual_form() {
    for text in ["part p { vanes 8", "edition 2026\ntool t1 = ball { diameter }", "let a = 3 mm }", "post \"x"] {
        let mut sink = Sink::default();
        assert_eq!(syntax::format(text, SourceId::default(), &mut sink), Err(Unformatted::Faulty), "{text}");
        assert!(!sink.diags().is_empty(), "{text}");
    }
}

proptest! {
    // A case changes one job at up to 20 places: 10 000 insertions.
    #![proptest_config(ProptestConfig { cases: 1000, ..ProptestConfig::default() })]

    /// Comments, blanks and line ends between the words of a job: nothing is lost, and the result stays as it is.
    #[test]
    fn comments_anywhere_are_kept(
        job in any::<prop::sample::Index>(),
        places in prop::collection::vec((any::<prop::sample::Index>(), 0..6_usize), 10..20),
    ) {
        let jobs = SHORT.with(Clone::clone);
        let text = job.get(&jobs);
        let mut gaps: Vec<usize> = gaps(text);
        gaps.dedup();
        let mut places: Vec<(usize, usize)> = places.iter().map(|(at, what)| (*at.get(&gaps), *what)).collect();
        places.sort_unstable();
        let mut changed = text.clone();
        for (number, (at, what)) in places.iter().enumerate().rev() {
            let inserted = match what {
                0 => format!("// note {number}\n"),
                1 => format!("  // \"{number}\" {{ [ µm \n\n"),
                2 => "\n".to_owned(),
                3 => "\n\n\n".to_owned(),
                4 => "\t  ".to_owned(),
                _ => format!("//{number}\r\n"),
            };
            changed.insert_str(*at, &inserted);
        }
        let file = syntax::parse(&changed, SourceId::default(), &mut Sink::default());
        // A line end can take a word from its item, or a unit from its number; such a text has faults.
        prop_assume!(!file.faulty && !file.damaged);
        let formatted = format(&changed);
        prop_assert!(formatted.is_ok(), "{:?}\n{}", formatted, changed);
        let formatted = formatted.unwrap_or_default();
        prop_assert_eq!(said(&changed), said(&formatted));
        prop_assert_eq!(format(&formatted), Ok(formatted));
    }
}

thread_local! {
    static SHORT: Vec<String> =
        jobs().into_iter().map(|(_, text)| text).filter(|text| text.len() < 6000).collect();
}

/// Places between words: before blanks outside of comments and quotes.
fn gaps(text: &str) -> Vec<usize> {
    let mut found = Vec::new();
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        let mut quoted = false;
        for (i, c) in line.char_indices() {
            quoted ^= c == '"';
            if !quoted && line[i..].starts_with("//") {
                break;
            }
            if !quoted && c == ' ' {
                found.push(start + i);
            }
        }
        start += line.len();
    }
    found
}

fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_impellerc"));
    command.current_dir(folder).args(arguments);
    command
}

/// Files are written where their form differs; with `--check` nothing is written; a job with faults stays as it is.
#[test]
fn files_are_formatted_in_place() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let read = |name: &str| std::fs::read_to_string(path(name)).unwrap();
    let (loose, faulty) = ("edition   2026\n", "edition 2026\npart {\n");
    std::fs::write(path("loose.imp"), loose).unwrap();
    std::fs::write(path("faulty.imp"), faulty).unwrap();
    let run = |arguments: &[&str]| command(folder.path(), arguments).output().unwrap();

    let checked = run(&["fmt", "--check", "loose.imp"]);
    assert_eq!((checked.status.code(), read("loose.imp").as_str()), (Some(1), loose));
    assert!(String::from_utf8_lossy(&checked.stderr).contains("IMP0111"));

    let formatted = run(&["fmt", "loose.imp", "faulty.imp"]);
    assert_eq!(formatted.status.code(), Some(2));
    assert_eq!(String::from_utf8_lossy(&formatted.stdout), "formatted loose.imp\n");
    assert_eq!((read("loose.imp").as_str(), read("faulty.imp").as_str()), ("edition 2026\n", faulty));
    assert_eq!(run(&["fmt", "--check", "loose.imp"]).status.code(), Some(0));

    let mut child = command(folder.path(), &["fmt", "-"]).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    std::io::Write::write_all(&mut child.stdin.take().unwrap(), loose.as_bytes()).unwrap();
    assert_eq!(child.wait_with_output().unwrap().stdout, b"edition 2026\n");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
}

/// Comments alone are no job yet, but `fmt` writes them as they stand.
#[test]
fn comments_alone_stay() {
    for (text, due) in [
        ("// one\n", "// one\n"),
        ("// one\n\n// two", "// one\n\n// two\n"),
        ("\n  // one  \n\n\n// two\n", "// one\n\n// two\n"),
    ] {
        let mut sink = Sink::default();
        assert_eq!(syntax::format(text, SourceId::default(), &mut sink).as_deref(), Ok(due), "{text:?}");
        assert_eq!(sink.count(), 0, "{text:?}");
    }
    // What is no text is still refused.
    assert_eq!(format("// one \u{7}\n"), Err(Unformatted::Faulty));
}
