//! Stage files: every value comes back by bytes, a run goes on from each of them with the same result, and damaged ones are errors.

use crate::support::jobs::{self, Planned, errors};
use crate::support::pinned;
use impellerc::base::source::{SourceMap, Span};
use impellerc::diagnostics::{Code, codes};
use impellerc::driver::{self, Emit, EmitForm, Options, Outcome, OutputFile, Stages};
use impellerc::ir::MoveKind;
use impellerc::ir::stage_file::{self, PlannedMotion, StageFault, StageFile, StageValue};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;

/// The four values of a plan.
fn values(compiled: &Planned) -> [StageValue; 4] {
    let plan = &compiled.plan;
    let motion = PlannedMotion::new(&plan.cl, plan.motion.clone());
    [StageValue::Ir, StageValue::Cc(plan.cc.clone()), StageValue::Cl(plan.cl.clone()), StageValue::Motion(motion)]
}

/// Reads a stage file and writes it again.
fn again(text: &str) -> String {
    let StageFile { sources, program, value } =
        stage_file::read(text).unwrap_or_else(|fault| panic!("{fault:?}: {}", &text[..text.len().min(300)]));
    let mut map = SourceMap::default();
    sources.into_iter().for_each(|file| _ = map.add_file(file));
    stage_file::write(&map, &program, &value).unwrap()
}

#[test]
fn all_values_come_back_by_bytes() {
    let jobs = [("small", "siemens-840d"), ("small", "linuxcnc"), ("reduced", "siemens-840d")];
    for (job, dialect) in jobs {
        let compiled = jobs::planned(job, dialect);
        let (sources, _) = jobs::front(&jobs::options(job, jobs::machine_of(dialect)));
        for value in values(compiled) {
            let text = stage_file::write(&sources, &compiled.program, &value).unwrap();
            assert!(text == again(&text), "{job} {dialect} {}", value.name());
        }
    }
}

/// To pin what a change of the planner made: `INSTA_UPDATE=always cargo test --test quick -- pinned_values`.
#[test]
fn pinned_values_are_those_of_today() {
    for name in pinned::NAMES {
        let (path, today) = (pinned::path(name), pinned::planned_today(name));
        if std::env::var("INSTA_UPDATE").is_ok_and(|update| update == "always") {
            std::fs::write(&path, &today).unwrap();
        }
        let kept = std::fs::read_to_string(&path).unwrap_or_default();
        let line = kept.lines().zip(today.lines()).position(|(kept, today)| kept != today);
        assert!(kept == today, "{}: another value from line {line:?} on", path.display());
    }
}

#[test]
fn programs_of_all_jobs_come_back_by_bytes() {
    let jobs = jobs::shipped();
    assert!(jobs.len() > 15, "{}", jobs.len());
    for job in jobs {
        let (sources, program) = jobs::front(&Options { job: job.clone(), ..Options::default() });
        let text = stage_file::write(&sources, &program, &StageValue::Ir).unwrap();
        assert!(text == again(&text), "{}", job.display());
        // A program without its places is the same for two texts that mean the same; no place is lost on the way.
        let read = stage_file::read(&text).unwrap();
        assert_eq!(read.program.spans().collect::<Vec<Span>>(), program.spans().collect::<Vec<_>>());
    }
}

/// The small job: its outputs, and the stage files of its values.
struct Small {
    folder: tempfile::TempDir,
}

const STAGES: [&str; 4] = ["ir", "cc", "cl", "motion"];

/// Outputs whose bytes are compared.
const OUTPUTS: [&str; 4] = ["part.mpf", "certificate.json", "part.map", "sheet.md"];

impl Small {
    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Options that write all outputs into a folder.
    fn options(&self, folder: &str) -> Options {
        let folder = self.path(folder);
        std::fs::create_dir_all(&folder).unwrap();
        let [output, certificate, map, sheet] = OUTPUTS.map(|name| folder.join(name));
        let other_outputs = [("--certificate", certificate), ("--source-map", map), ("--setup-sheet", sheet)];
        let other_outputs = other_outputs.into_iter().filter_map(|(flag, path)| OutputFile::new(flag, path)).collect();
        let mut options = Options { output: Some(output), other_outputs, ..Options::default() };
        // The stock is not what these tests look at.
        options.run.stock_cell = Some(1.0);
        options
    }
}

static SMALL: LazyLock<Small> = LazyLock::new(|| {
    let small = Small { folder: tempfile::tempdir().unwrap() };
    let options = Options { job: PathBuf::from("jobs/small/small.imp"), ..small.options("job") };
    let outcome = driver::compile(&options, &mut Stages::default());
    assert!(errors(&outcome).is_empty(), "{:#?}", errors(&outcome));
    let (sources, program) = jobs::front(&options);
    let compiled = jobs::planned("small", "siemens-840d");
    for (value, stage) in values(compiled).iter().zip(STAGES) {
        let text = stage_file::write(&sources, &program, value).unwrap();
        std::fs::write(small.path(&format!("{stage}.json")), text).unwrap();
    }
    small
});

fn stage_text(stage: &str) -> String {
    std::fs::read_to_string(SMALL.path(&format!("{stage}.json"))).unwrap()
}

#[test]
fn a_run_goes_on_from_every_stage_with_the_same_outputs() {
    for stage in STAGES {
        let from = Some(SMALL.path(&format!("{stage}.json")));
        let outcome = driver::compile(&Options { from, ..SMALL.options(stage) }, &mut Stages::default());
        assert!(errors(&outcome).is_empty(), "{stage}: {:#?}", errors(&outcome));
        for name in OUTPUTS {
            let [made, due] = [stage, "job"].map(|folder| std::fs::read(SMALL.path(folder).join(name)).unwrap());
            assert!(made == due, "{name} from {stage}");
        }
        assert!(outcome.notes.len() > 2, "{stage}: {:?}", outcome.notes);
    }
}

fn emitted(options: &Options) -> Outcome {
    driver::compile(options, &mut Stages::default())
}

#[test]
fn a_stage_file_is_printed_for_people() {
    let printed = |emit| {
        let from = Some(SMALL.path("motion.json"));
        emitted(&Options { from, emit: Some(emit), ..Options::default() })
    };
    let c = jobs::planned("small", "siemens-840d");
    use impellerc::ir::print::{Detail, motion, program};
    assert_eq!(printed(Emit::Motion).emitted.unwrap(), motion(&c.program, &c.plan.motion, Detail::Full));
    assert_eq!(printed(Emit::Ir).emitted.unwrap(), program(&c.program));
    for emit in [Emit::Cl, Emit::Cc, Emit::Job, Emit::Ast] {
        let outcome = printed(emit);
        let [error] = errors(&outcome)[..] else { panic!("{:?}", outcome.sink) };
        assert!(error.code == codes::files::STAGE_FILE && error.message.contains("begins at `motion`"), "{error:?}");
    }
    // As a stage file it is the same file again.
    let from = Some(SMALL.path("motion.json"));
    let options = Options { from, emit: Some(Emit::Motion), form: EmitForm::Json, ..Options::default() };
    assert!(emitted(&options).emitted.unwrap() == stage_text("motion"));
}

fn impellerc(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_impellerc")).args(arguments).output().unwrap()
}

/// Standard error without the ends of its lines.
fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn the_command_writes_and_reads_stage_files() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("program.json");
    let file = file.to_str().unwrap();
    let run = impellerc(&["jobs/blisk/blisk.imp", "--emit", "ir", "--format", "json", "-o", file]);
    assert!(run.status.success(), "{}", said(&run));
    let text = std::fs::read_to_string(file).unwrap();
    // The same bytes from another folder, and on standard output.
    let other = Command::new(env!("CARGO_BIN_EXE_impellerc"))
        .current_dir("jobs/blisk")
        .args(["blisk.imp", "--emit", "ir", "--format", "json"])
        .output()
        .unwrap();
    assert!(String::from_utf8_lossy(&other.stdout) == text);
    let [from, job] = [vec!["--from", file], vec!["jobs/blisk/blisk.imp"]].map(|first| {
        let run = impellerc(&[first, vec!["--emit", "ir"]].concat());
        String::from_utf8_lossy(&run.stdout).into_owned()
    });
    assert!(from == job && from.len() > 1000);

    // What makes no sense beside a stage file, and a form that a stage does not have.
    for (arguments, says) in [
        (&["--from", file, "jobs/blisk/blisk.imp"][..], "cannot be used with"),
        (&["--from", file, "--post", "linuxcnc"], "cannot be used with"),
        (&["--from", file, "--machine", "5mc850-c"], "cannot be used with"),
        (&["--from", file, "--library", "jobs/_lib"], "cannot be used with"),
        (&["--from", file, "--curves", "jobs"], "cannot be used with"),
        (&["--from", file, "--watch"], "cannot be used with"),
        (&["jobs/blisk/blisk.imp", "--emit", "nc", "--format", "json"], "`--format json` writes the stages"),
        (&["jobs/blisk/blisk.imp", "--emit", "job", "--format", "json"], "`--format json` writes the stages"),
        (&["jobs/blisk/blisk.imp", "--format", "json"], "--emit"),
        (&["--from", file, "--emit", "ir", "--format", "json", "-o", file], "would replace an input"),
        (&["--from", file, "--emit", "ir", "--format", "json", "-o", "program.nc"], "is named like another file"),
        (&["--from", "jobs/blisk/blisk.imp"], "a job is compiled without `--from`"),
        (&[file], "is a stage file, not a job"),
    ] {
        let run = impellerc(arguments);
        assert!(run.status.code() == Some(2) || run.status.code() == Some(3), "{arguments:?}: {:?}", run.status);
        assert!(said(&run).contains(says), "{arguments:?}: {}", said(&run));
    }
    let absent = impellerc(&["--from", "absent.json"]);
    assert_eq!(absent.status.code(), Some(3), "{}", said(&absent));
}

/// The verifier judges what a stage file says: a cut 1 mm lower in every move gouges, and nothing is written.
#[test]
fn a_changed_motion_is_proved_again() {
    let StageFile { sources, program, value } = stage_file::read(&stage_text("motion")).unwrap();
    let StageValue::Motion(mut planned) = value else { panic!("{}", value.name()) };
    let flank = &mut planned.motion.operations[1];
    for cut in flank.moves.iter_mut().filter(|m| m.kind == MoveKind::Cut) {
        cut.joints.rotary[1] += 0.01;
    }
    let mut map = SourceMap::default();
    sources.into_iter().for_each(|file| _ = map.add_file(file));
    let text = stage_file::write(&map, &program, &StageValue::Motion(planned)).unwrap();
    let from = SMALL.path("changed.json");
    std::fs::write(&from, text).unwrap();
    let outcome = driver::compile(&Options { from: Some(from), ..SMALL.options("changed") }, &mut Stages::default());
    let found: Vec<Code> = errors(&outcome).iter().map(|d| d.code).collect();
    assert!(found.iter().any(|code| code.id().starts_with("IMP07")), "{found:?}");
    // The place is one of the job that the file carries.
    let label = errors(&outcome).iter().find_map(|d| d.labels.first().map(|l| l.span)).expect("a place");
    assert_eq!(outcome.sources.get(label.source).unwrap().name, "small.imp");
    assert!(!SMALL.path("changed").join("part.mpf").exists());
}

/// Where a value stands: keys, and indices of lists.
type Place = Vec<Step>;

#[derive(Clone, Debug)]
enum Step {
    Key(String),
    Index(usize),
}

/// All places, the first of each kind: places in one list that differ only by their index are of one kind.
fn places(value: &Value) -> Vec<Place> {
    fn visit(value: &Value, at: &Place, found: &mut BTreeMap<String, Place>) {
        let kind: String =
            at.iter().map(|step| if let Step::Key(key) = step { format!("/{key}") } else { "/#".to_owned() }).collect();
        found.entry(kind).or_insert_with(|| at.clone());
        let mut into = |step: Step, value: &Value| visit(value, &[at.clone(), vec![step]].concat(), found);
        match value {
            Value::Object(map) => map.iter().for_each(|(key, value)| into(Step::Key(key.clone()), value)),
            Value::Array(list) => list.iter().enumerate().for_each(|(i, value)| into(Step::Index(i), value)),
            _ => {}
        }
    }
    let mut found = BTreeMap::new();
    visit(value, &Vec::new(), &mut found);
    found.into_values().filter(|place| !place.is_empty()).collect()
}

fn at<'a>(value: &'a mut Value, place: &[Step]) -> &'a mut Value {
    place.iter().fold(value, |value, step| match step {
        Step::Key(key) => &mut value[key.as_str()],
        Step::Index(i) => &mut value[*i],
    })
}

/// A stage file with few moves, so that many changes of it are read quickly.
fn short(stage: &str) -> Value {
    let mut value: Value = serde_json::from_str(&stage_text(stage)).unwrap();
    if stage == "cc" || stage == "cl" {
        for operation in value["value"]["operations"].as_array_mut().unwrap() {
            let passes = operation["passes"].as_array_mut().unwrap();
            passes.truncate(2);
            for pass in passes {
                pass["points"].as_array_mut().unwrap().truncate(3);
                if let Some(air) = pass.get_mut("air") {
                    *air = json!([1]);
                }
            }
        }
    }
    if stage == "motion" {
        for operation in value["value"]["motion"]["operations"].as_array_mut().unwrap() {
            let moves = operation["moves"].as_array_mut().unwrap();
            moves.drain(3..moves.len() - 2);
        }
    }
    value
}

fn read(value: &Value) -> Result<StageFile, StageFault> {
    stage_file::read(&value.to_string())
}

#[test]
fn lost_keys_and_impossible_numbers_are_errors() {
    const FAR: &str = "12345.625";
    for stage in STAGES {
        let whole = short(stage);
        assert!(read(&whole).is_ok(), "{stage}: {:?}", read(&whole).err());
        let places = places(&whole);
        assert!(places.len() > 150, "{stage}: {}", places.len());
        for place in &places {
            let (last, before) = place.split_last().unwrap();
            let mut changed = whole.clone();
            if let Step::Key(key) = last {
                at(&mut changed, before).as_object_mut().unwrap().remove(key);
                assert!(read(&changed).is_err(), "{stage} without {place:?}");
            }
            let mut changed = whole.clone();
            if at(&mut changed, place).is_number() {
                *at(&mut changed, place) = json!(FAR.parse::<f64>().unwrap());
                let text = changed.to_string();
                assert!(text.contains(FAR), "{place:?}");
                // No number of JSON, and one that no number of the program can be.
                for number in ["1e999", "-1e999", "NaN"] {
                    assert!(stage_file::read(&text.replacen(FAR, number, 1)).is_err(), "{stage} {place:?} {number}");
                }
                // These are errors or other values.
                for number in ["-1", "0", "1e300", "4294967296", "null", "\"1\"", "[]"] {
                    let _ = stage_file::read(&text.replacen(FAR, number, 1));
                }
            }
            let mut changed = whole.clone();
            *at(&mut changed, place) = json!({ "unknown": 1 });
            assert!(read(&changed).is_err(), "{stage} {place:?}");
        }
    }
}

#[test]
fn truncated_files_are_errors_with_their_place() {
    let text = stage_text("motion");
    for k in 0..200 {
        let end = text.len() * k / 200;
        match stage_file::read(&text[..end]) {
            Err(StageFault::Damaged { at, .. }) => assert!(at <= end),
            other => panic!("{end}: {:?}", other.err()),
        }
    }
    let half = SMALL.path("half.json");
    std::fs::write(&half, &text[..text.len() / 2]).unwrap();
    let outcome = emitted(&Options { from: Some(half), ..Options::default() });
    let [error] = errors(&outcome)[..] else { panic!("{:?}", outcome.sink) };
    let place = error.labels[0].span;
    assert!(error.code == codes::files::STAGE_FILE && error.message.ends_with("half.json is damaged"), "{error:?}");
    assert!(outcome.sources.line_column(place).0 > 100 && error.labels[0].text.contains("ends here"), "{error:?}");
}

/// One change of a stage file, and a part of the reason why it is refused.
fn reason(stage: &str, place: &str, to: Value) -> String {
    let mut value: Value = serde_json::from_str(&stage_text(stage)).unwrap();
    *value.pointer_mut(place).unwrap_or_else(|| panic!("{place}")) = to;
    match read(&value) {
        Err(StageFault::Damaged { reason, .. } | StageFault::Malformed(reason)) => reason,
        other => panic!("{place}: {other:?}"),
    }
}

#[test]
fn values_that_no_run_writes_are_refused_with_a_reason() {
    let root = "/program/part/blades/0/faces/0/surface/ruled/root";
    let whole: Value = serde_json::from_str(&stage_text("ir")).unwrap();
    let mut knots = whole.pointer(&format!("{root}/knots")).unwrap().clone();
    knots.as_array_mut().unwrap().swap(3, 5);
    for (stage, place, to, says) in [
        ("ir", format!("{root}/knots").as_str(), knots, "knots"),
        ("ir", &format!("{root}/degree"), json!(7), "degree 7"),
        ("ir", "/program/part/vane_count", json!(1), "two sectors"),
        ("ir", "/program/part/hub/orientation", json!(0), "side"),
        ("ir", "/program/part/blades/0/ahead", json!(9), "no outside"),
        ("ir", "/program/operations/0/tool", json!(99), "has no tool"),
        ("ir", "/program/operations/0/sectors", json!([0, 8]), "sectors"),
        ("ir", "/program/operations/1/kind/flank/faces/0/blade", json!(3), "no surface"),
        ("ir", "/program/operations/1/kind/flank/faces/0/face", json!(9), "no face 9"),
        ("ir", "/program/tools/0/solid/flute_length", json!(-1), "flutes"),
        ("ir", "/program/tools/0/max_chip", json!(0), "not positive"),
        ("ir", "/program/machine/linear/0/speed", json!(0), "linear axis"),
        ("ir", "/program/machine/chain/axes/0/direction", json!([0, 0, 1]), "parallel"),
        ("ir", "/program/post/control/decimals/length", json!(70_000), "words have"),
        ("ir", "/program/post/frames/0/0/text", json!("{nothing}"), "no field `nothing`"),
        ("ir", "/program/name_span/end", json!(1_000_000), "are not there"),
        ("ir", "/program/machine/planning", json!("both"), "both"),
        ("cc", "/value/operations/0/operation", json!(2), "operations"),
        ("cc", "/value/operations/2/passes/0/drive", json!({ "hub": 4 }), "driven by"),
        ("cc", "/value/operations/0/passes/0/points/0/normal", json!([0.5, 0, 0]), "point 0"),
        ("cl", "/value/operations/0/passes/0/air", json!([100_000]), "cuts air"),
        ("cl", "/value/operations/0/passes/0/points/3/axis", json!([0.5, 0, 0]), "point 3"),
        ("cl", "/value/operations/1/passes/0/sector", json!(4), "sector 4"),
        ("motion", "/value/motion/operations/0/moves/5/pass", json!(1_000_000), "move 5"),
        ("motion", "/value/motion/operations/0/moves/0/joints/xyz/2", json!(0), "retract height"),
        ("motion", "/value/motion/operations/0/moves/5/time", json!(-1), "move 5"),
        ("motion", "/value/notes", json!([]), "notes"),
    ] {
        let found = reason(stage, place, to);
        assert!(found.contains(says), "{place}: {found}");
    }
    let mut other = whole.clone();
    other["version"] = json!(1);
    assert_eq!(read(&other).err(), Some(StageFault::Version(1)));
    other["format"] = json!("impellerc-certificate");
    assert_eq!(read(&other).err(), Some(StageFault::Other));
    for text in ["[]", "1", "{}", "null"] {
        assert_eq!(stage_file::read(text).err(), Some(StageFault::Other), "{text}");
    }
    let deep = "[".repeat(100_000);
    assert!(matches!(stage_file::read(&deep), Err(StageFault::Damaged { .. } | StageFault::Other)));
    assert!(Path::new(&SMALL.path("ir.json")).exists());
}
