//! Commands as a user types them: the check of a job, and words that are nearly a command.

use std::path::Path;
use std::process::{Command, Output};

fn run(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_impellerc")).current_dir(folder).args(arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// The check says what it judged and what it did not; it finds what a compilation refuses before planning, and nothing is written.
#[test]
fn a_job_is_checked_without_a_plan() {
    let here = Path::new(".");
    let found = run(here, &["check", "jobs/small/small.imp"]);
    assert!(found.status.success(), "{}", text(&found.stderr));
    let verdict = text(&found.stdout);
    assert!(verdict.starts_with("small: no fault found before planning"), "{verdict}");
    assert!(
        verdict.contains("on 5mc850-c, post siemens-840d\n") && verdict.contains("only when the job is compiled\n"),
        "{verdict}"
    );
    // A fact about the part is told as in a compilation.
    assert!(text(&found.stderr).contains("IMP0351"), "{}", text(&found.stderr));

    // A machine that the control cannot have is refused as in a compilation.
    let other = run(here, &["check", "jobs/small/small.imp", "--machine", "generic-ab-head", "--post", "linuxcnc"]);
    assert!(!other.status.success() && other.stdout.is_empty(), "{}", text(&other.stdout));
    assert!(text(&other.stderr).contains("IMP0809"), "{}", text(&other.stderr));

    let folder = tempfile::tempdir().unwrap();
    let job = std::fs::read_to_string("jobs/small/small.imp").unwrap();
    std::fs::copy("jobs/small/vane_curves.csv", folder.path().join("vane_curves.csv")).unwrap();
    // A fault of the text, and a fact that no plan can overcome.
    for (from, to, code) in [("feed 250 mm/min", "feed 250", "IMP0206"), ("vanes 8", "vanes 16", "IMP0450")] {
        assert!(job.contains(from), "{from}");
        std::fs::write(folder.path().join("job.imp"), job.replace(from, to)).unwrap();
        let found = run(folder.path(), &["check", "job.imp"]);
        assert!(found.status.code() == Some(2) && found.stdout.is_empty(), "{to}: {:?}", found.status);
        assert!(text(&found.stderr).contains(code), "{to}: {}", text(&found.stderr));
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2, "a check writes nothing");
}

#[test]
fn words_that_are_nearly_a_command_are_named() {
    let folder = tempfile::tempdir().unwrap();
    for (word, meant) in
        [("chek", "check"), ("verfy", "verify"), ("explian", "explain"), ("Diff", "diff"), ("imports", "import")]
    {
        let found = run(folder.path(), &[word, "part.nc"]);
        assert_eq!(found.status.code(), Some(2), "{word}");
        let said = text(&found.stderr);
        assert!(said.starts_with(&format!("there is no file `{word}`; did you mean the command `{meant}`?")), "{said}");
    }
    // A file is a job, whatever its name is.
    std::fs::write(folder.path().join("chek"), "").unwrap();
    let found = run(folder.path(), &["chek"]);
    assert!(text(&found.stderr).contains("IMP"), "{}", text(&found.stderr));
    // Other words are jobs that do not exist.
    let found = run(folder.path(), &["blade"]);
    assert_eq!(found.status.code(), Some(3), "{}", text(&found.stderr));
}
