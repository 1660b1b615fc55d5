//! `--emit job` prints a job: with every default, and with the same program to the last bit.

use crate::support::jobs;
use impellerc::driver::{self, Emit, Options, Outcome, Stages};
use impellerc::ir::Program;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// What `--emit job` prints.
fn printed(options: &Options) -> String {
    let outcome = driver::compile(&Options { emit: Some(Emit::Job), ..options.clone() }, &mut Stages::default());
    outcome.emitted.unwrap_or_else(|| panic!("{:#?}", outcome.sink.diags()))
}

fn program(options: &Options, text: &str) -> Program {
    let mut outcome = Outcome::default();
    let program = driver::front(options, &mut Stages::default(), &mut outcome);
    program.unwrap_or_else(|_| panic!("{:#?}\n{text}", outcome.sink.diags())).unwrap()
}

/// A value without places in texts.
fn without_places(value: &Value) -> Value {
    let is_place = |map: &serde_json::Map<String, Value>| map.len() == 3 && map.contains_key("source");
    match value {
        Value::Object(map) if is_place(map) => Value::Null,
        Value::Object(map) => {
            let kept = map.iter().filter(|(key, _)| *key != "span" && !key.ends_with("_span"));
            Value::Object(kept.map(|(key, value)| (key.clone(), without_places(value))).collect())
        }
        Value::Array(list) => Value::Array(list.iter().map(without_places).collect()),
        other => other.clone(),
    }
}

/// The first place where two values differ.
fn difference(a: &Value, b: &Value, at: &str) -> Option<String> {
    match (a, b) {
        (Value::Object(x), Value::Object(y)) if x.len() == y.len() => {
            x.iter().find_map(|(key, value)| difference(value, y.get(key)?, &format!("{at}/{key}")))
        }
        (Value::Array(x), Value::Array(y)) if x.len() == y.len() => {
            x.iter().zip(y).enumerate().find_map(|(i, (x, y))| difference(x, y, &format!("{at}/{i}")))
        }
        _ => (a != b).then(|| format!("{at}: {a} and {b}")),
    }
}

/// Compiles what a job prints in a copy of its folder, and compares the programs; returns the printed text.
fn holds(options: &Options) -> String {
    let text = printed(options);
    let folder = tempfile::tempdir().unwrap();
    for file in std::fs::read_dir(options.job.parent().unwrap()).unwrap().map(|file| file.unwrap().path()) {
        if file.is_file() {
            std::fs::copy(&file, folder.path().join(file.file_name().unwrap())).unwrap();
        }
    }
    let job = folder.path().join("printed.imp");
    std::fs::write(&job, &text).unwrap();
    let mut again = Options { job, ..Options::default() };
    again.run.library = Some(PathBuf::from("jobs/_lib"));
    let [of_job, of_text] = [options, &again].map(|options| program(options, &text));
    let [a, b] = [&of_job, &of_text].map(|program| without_places(&serde_json::to_value(program).unwrap()));
    if a != b {
        panic!("{}: {:?}\n{text}", options.job.display(), difference(&a, &b, ""));
    }
    // It prints itself.
    assert_eq!(printed(&again), text, "{}", options.job.display());
    text
}

#[test]
fn every_shipped_job_prints_a_job_with_the_same_program() {
    for job in jobs::shipped() {
        holds(&Options { job, ..Options::default() });
    }
}

/// A job in words that the shipped ones do not have.
fn changed(job: &str, changes: &[(&str, &str)]) -> String {
    let text = changes.iter().fold(std::fs::read_to_string(job).unwrap(), |text, (from, to)| {
        assert!(text.contains(from), "{from} is not in {job}");
        text.replace(from, to)
    });
    let folder = tempfile::tempdir().unwrap();
    for file in std::fs::read_dir(Path::new(job).parent().unwrap()).unwrap().map(|file| file.unwrap().path()) {
        if file.is_file() {
            std::fs::copy(&file, folder.path().join(file.file_name().unwrap())).unwrap();
        }
    }
    let path = folder.path().join("changed.imp");
    std::fs::write(&path, text).unwrap();
    let mut options = Options { job: path, ..Options::default() };
    options.run.library = Some(PathBuf::from("jobs/_lib"));
    holds(&options)
}

#[test]
fn jobs_in_other_words_print_the_same_program() {
    // Numbers that have no short form: thirds, cutting speeds, feeds of a tooth, minutes, oblique angles.
    let text = changed(
        "jobs/small/small.imp",
        &[
            ("speed 12000 rpm  feed 150 mm/min", "speed 70 m/min  feed 0.003 mm/tooth"),
            ("vane 0.2 mm, hub 0.4 mm", "vane 1 mm / 7 .. 2 mm / 7, hub 0.4 mm"),
            ("fillet 1.2 mm", "fillet [(0 %, 1.2 mm) (1 / 3, 1.3 mm) (100 %, 1.1 mm)]"),
            ("holder \"er16-mini\" }\ntool t2", "holder \"er16-mini\"  ramp 1 rad / 7  max-chip 1 mm / 30 }\ntool t2"),
            (
                "require clearance >= 0.5 mm",
                "require clearance holder >= 1 mm / 3 on hub\nrequire time <= 1 h / 7\nrequire air <= 1 / 3\n\
                 require orientation-error <= 0.1 rad / 7\nrequire engagement <= 200 deg outside of slots\n\
                 allow excess on fillet \"blended: by hand\"",
            ),
            (
                "post siemens-840d",
                "post siemens-840d { orientation-tolerance 0.02 deg  block-numbers 10  work-offset \"G55\" }",
            ),
        ],
    );
    for line in ["  ramp 0.14285714285714285 rad\n", "  block-numbers 10\n", "  work-offset \"G55\"\n"] {
        assert!(text.contains(line), "{line} is not in\n{text}");
    }
    // Blades by angles: radians, thirds, shares of meridians, splitters of the main blade.
    changed(
        "jobs/splitter/splitter.imp",
        &[
            ("(0 %, 30 deg) (40 %, 32 deg)", "(0 %, 0.52 rad) (40 %, 5 rad / 9)"),
            ("from hub 3 mm, shroud 2 mm", "from hub 1 / 11, shroud 7 %"),
            ("angle 46 %", "angle 33.3 deg"),
        ],
    );
    // Other machines and posts, by the command line.
    for (machine, post) in [("5mc850-c-linuxcnc", "linuxcnc"), ("5mc850-c", "heidenhain")] {
        let mut options = jobs::options("small", Some(machine));
        options.run.post = Some(post.to_owned());
        assert!(holds(&options).contains(&format!("use machine \"{machine}\"")));
    }
}
