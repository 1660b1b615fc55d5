//! Commands as a user types them: the check of a job, and words that are nearly a command.

use std::path::Path;
use std::process::{Command, Output, Stdio};

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
        assert!(said.contains(&format!("no command `{word}`")), "{said}");
        assert!(said.contains(&format!("did you mean the command `{meant}`?")), "{said}");
    }
    // A file is a job, whatever its name is.
    std::fs::write(folder.path().join("chek"), "").unwrap();
    let found = run(folder.path(), &["chek"]);
    assert!(text(&found.stderr).contains("IMP"), "{}", text(&found.stderr));
    // Other words are jobs that do not exist.
    let found = run(folder.path(), &["blade"]);
    assert_eq!(found.status.code(), Some(3), "{}", text(&found.stderr));
}

/// Words of other compilers and programs lead to what does the same here.
#[test]
fn words_of_other_programs_lead_to_the_right_command() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("part.imp"), "").unwrap();
    std::fs::write(folder.path().join("other.imp"), "").unwrap();
    for (words, due) in [
        (&["compile", "part.imp"][..], "`impellerc part.imp -o PART.nc`"),
        (&["build", "part.imp"], "`impellerc part.imp -o PART.nc`"),
        (&["complie", "part.imp"], "`impellerc part.imp -o PART.nc`"),
        (&["run"], "`impellerc JOB.imp -o PART.nc`"),
        (&["lint", "part.imp"], "the command `check`"),
        (&["simulate", "part.nc"], "the command `verify`"),
        (&["view", "part.imp"], "the command `report`"),
        (&["part.imp", "check"], "`impellerc check part.imp`"),
        (&["part.imp", "other.imp"], "one run takes one job"),
        (&["part.imp", "part.nc"], "`-o part.nc`"),
        (&["--details", "part.imp", "other.imp"], "one run takes one job"),
        (&["mill-it", "part.imp"], "the commands are"),
    ] {
        let found = run(folder.path(), words);
        let said = text(&found.stderr);
        assert!(found.status.code() == Some(2) && said.contains(due), "{words:?}: {said}");
        assert!(!said.contains("subcommand"), "{words:?}: {said}");
    }
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
    // A copy says of itself what its original does.
    let copy = run(folder.path(), &["machines", "5mc850-c"]).stdout;
    std::fs::write(own.join("copy.toml"), copy).unwrap();
    let listed = text(&run(folder.path(), &["machines"]).stdout);
    assert_eq!(listed.matches("Vertical five-axis machining centre 5MC850-C").count(), 2, "{listed}");
    assert!(!listed.contains("from: shipped with the compiler Vertical"), "{listed}");
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

/// `report` writes the report of a job and no NC text; its file has the name of the job where none is given.
#[test]
fn a_report_is_written_without_nc_text() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["small.imp", "vane_curves.csv"] {
        std::fs::copy(Path::new("jobs/small").join(name), folder.path().join(name)).unwrap();
    }
    let run = Command::new(env!("CARGO_BIN_EXE_impellerc"))
        .current_dir(folder.path())
        .args(["report", "small.imp", "--stock-cell", "0.5"])
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&run.stdout);
    assert!(said.starts_with("PASS small: ") && said.contains("wrote small.html"), "{said}");
    let mut files: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    files.sort();
    assert_eq!(files, ["small.html", "small.imp", "vane_curves.csv"]);
    let html = std::fs::read_to_string(folder.path().join("small.html")).unwrap();
    assert!(html.starts_with("<!doctype html>") || html.starts_with("<!DOCTYPE html>"));
}

/// `--watch` runs again when the job or a curve file changes, and not when another file does.
#[test]
fn changes_are_watched() {
    use std::io::{BufRead as _, BufReader};
    let folder = tempfile::tempdir().unwrap();
    let [job, curves] = ["small.imp", "vane_curves.csv"].map(|name| folder.path().join(name));
    for path in [&job, &curves] {
        std::fs::copy(Path::new("jobs/small").join(path.file_name().unwrap()), path).unwrap();
    }
    let mut child = Command::new(env!("CARGO_BIN_EXE_impellerc"))
        .current_dir(folder.path())
        .args(["check", "small.imp", "--watch"])
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // Lines through a thread, so that a silent program does not hang the test.
    let (send, lines) = std::sync::mpsc::channel();
    let err = BufReader::new(child.stderr.take().unwrap());
    std::thread::spawn(move || err.lines().map_while(Result::ok).try_for_each(|line| send.send(line)));
    let until_waits = || {
        let mut seen = Vec::new();
        loop {
            let line = lines.recv_timeout(std::time::Duration::from_secs(60)).unwrap_or_else(|_| panic!("{seen:?}"));
            if line.contains("waiting for a change of small.imp and one more file") {
                return seen.join("\n");
            }
            seen.push(line);
        }
    };
    let first = until_waits();
    assert!(first.contains("IMP0351") && !first.contains("IMP0204"), "{first}");
    std::fs::write(folder.path().join("other.txt"), "nothing of the run").unwrap();
    let text = std::fs::read_to_string(&job).unwrap();
    std::fs::write(&job, text.replacen("scallop", "scalop", 1)).unwrap();
    let faulty = until_waits();
    assert!(faulty.contains("scalop"), "{faulty}");
    // Editors write another file and move it into the place of the old one.
    let beside = folder.path().join("beside");
    std::fs::write(&beside, &text).unwrap();
    std::fs::rename(&beside, &job).unwrap();
    assert!(!until_waits().contains("scalop"));
    let points = std::fs::read_to_string(&curves).unwrap();
    std::fs::write(&curves, points.replacen("tip_pressure", "tip_presure", 1)).unwrap();
    assert!(until_waits().contains("vane_curves.csv"));
    // A file that is missing is waited for.
    std::fs::remove_file(&curves).unwrap();
    let without = loop {
        let line = lines.recv_timeout(std::time::Duration::from_secs(60)).unwrap();
        if line.contains("waiting for a change of small.imp;") {
            break line;
        }
    };
    assert!(without.ends_with("Ctrl+C ends"), "{without}");
    std::fs::write(&curves, &points).unwrap();
    assert!(until_waits().contains("IMP0351"));
    child.kill().unwrap();
    child.wait().unwrap();
    let rest: Vec<String> = lines.try_iter().collect();
    assert!(rest.is_empty(), "{rest:?}");
}
