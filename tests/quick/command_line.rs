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

/// A job to begin with has the name of its file, is judged without an error, and replaces no file.
#[test]
fn a_new_job_is_one_that_can_be_checked() {
    let folder = tempfile::tempdir().unwrap();
    for kind in ["vanes", "pump", "turbo"] {
        let file = format!("my_{kind}.imp");
        let made = run(folder.path(), &["new", &format!("my_{kind}"), "--kind", kind]);
        assert!(made.status.success(), "{}", text(&made.stderr));
        assert!(text(&made.stdout).contains(&format!("impellerc check {file}")), "{}", text(&made.stdout));
        let job = std::fs::read_to_string(folder.path().join(&file)).unwrap();
        assert!(job.starts_with("//") && job.contains(&format!("\npart my_{kind} {{\n")), "{job}");
    }
    let checked = run(folder.path(), &["check", "my_vanes.imp"]);
    assert!(checked.status.success(), "{}", text(&checked.stderr));
    assert!(text(&checked.stdout).starts_with("my_vanes: no fault found before planning"), "{}", text(&checked.stdout));
    let again = run(folder.path(), &["new", "my_vanes.imp"]);
    assert_eq!(again.status.code(), Some(3));
    assert!(text(&again.stderr).contains("exists already"), "{}", text(&again.stderr));
    assert_eq!(run(folder.path(), &["new", "other", "--kind", "propeller"]).status.code(), Some(2));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 3);
}

/// The job of the first page is the one of `impellerc new`.
#[test]
fn the_job_of_the_first_page_is_a_job_to_begin_with() {
    let page = include_str!("../../README.md");
    let sample = page.split("```\n").find(|block| block.starts_with("edition 2026")).unwrap();
    assert!(include_str!("../../jobs/new/vanes.imp").ends_with(sample));
}

/// Every machine, tool library and post of the project is in the binary; a file beside the job comes first, and says so.
#[test]
fn the_library_is_listed_and_shown() {
    let folder = tempfile::tempdir().unwrap();
    for kind in ["machines", "tools", "posts"] {
        let listed = text(&run(folder.path(), &[kind]).stdout);
        for file in std::fs::read_dir(Path::new("jobs/_lib").join(kind)).unwrap() {
            let path = file.unwrap().path();
            let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
            assert!(listed.contains(&format!("{name} ")), "{name} is not listed:\n{listed}");
            let shown = text(&run(folder.path(), &[kind, &name]).stdout);
            let own = std::fs::read_to_string(&path).unwrap();
            assert_eq!(shown, format!("# from: shipped with the compiler\n{own}"));
        }
        assert!(listed.contains("from: shipped"), "{listed}");
    }
    let own = folder.path().join("_lib/machines");
    std::fs::create_dir_all(&own).unwrap();
    std::fs::write(own.join("generic-ac-table.toml"), "# Ours. With more.\n").unwrap();
    let listed = text(&run(folder.path(), &["machines"]).stdout);
    assert!(listed.contains("Ours\n") && listed.contains("_lib/machines\n"), "{listed}");
    let absent = run(folder.path(), &["machines", "5mc950"]);
    assert_eq!(absent.status.code(), Some(2));
    assert!(text(&absent.stderr).contains("5mc850-c"), "{}", text(&absent.stderr));
}

#[test]
fn shells_and_manual_know_every_command() {
    let here = Path::new(".");
    let page = text(&run(here, &["man"]).stdout);
    let completions: Vec<String> =
        ["bash", "zsh", "fish"].map(|shell| text(&run(here, &["completions", shell]).stdout)).into();
    let help = text(&run(here, &["--help"]).stdout);
    let commands = help.lines().skip_while(|l| *l != "Commands:").skip(1).take_while(|l| !l.is_empty());
    let names: Vec<&str> = commands
        .filter(|l| l.starts_with("  ") && !l.starts_with("   "))
        .filter_map(|l| l.split_whitespace().next())
        .collect();
    assert!(names.len() > 10, "{names:?}");
    for name in names {
        assert!(completions.iter().all(|text| text.contains(name)), "{name}");
        assert!(name == "help" || page.contains(&format!("impellerc\\-{name}")), "{name} is not in the manual page");
    }
}
