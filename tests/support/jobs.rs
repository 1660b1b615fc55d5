//! Jobs that are planned and verified once for all tests of a test program.

use impellerc::base::progress::Progress;
use impellerc::base::source::SourceMap;
use impellerc::diagnostics::{Diag, Severity, Sink};
use impellerc::driver::{self, Options, Outcome, Stages};
use impellerc::ir::{Motion, Program};
use impellerc::plan::passes::pipeline::{self, Plan};
use impellerc::tool_stock::stock::Field;
use impellerc::verify::stock::{Settings, StockReport, simulate};
use impellerc::verify::{Certificate, Verified, certify_with, verify};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::path::PathBuf;
use std::sync::LazyLock;

/// A program with all stages before its text.
#[derive(Clone)]
pub struct Compiled {
    pub program: Program,
    pub plan: Plan,
    pub motion: Verified<Motion>,
    pub certificate: Certificate,
}

/// Writes a stage value as data, reads it, and writes it again: the same bytes. So every plan of a test program does.
fn comes_back<T: Serialize + DeserializeOwned>(stage: &str, value: &T) {
    let text = serde_json::to_string(value).unwrap();
    let again: T = serde_json::from_str(&text).unwrap_or_else(|fault| panic!("{stage}: {fault}"));
    assert!(serde_json::to_string(&again).unwrap() == text, "{stage} is another value when it is read");
}

/// A program with its plan, which nothing has proved.
pub struct Planned {
    pub program: Program,
    pub plan: Plan,
}

impl Planned {
    /// Plans.
    pub fn new(program: Program) -> Self {
        let mut sink = Sink::default();
        let plan = pipeline::run(&program, &mut sink).unwrap_or_else(|_| panic!("no plan: {:#?}", sink.diags()));
        comes_back("ir", &program);
        comes_back("cc", &plan.cc);
        comes_back("cl", &plan.cl);
        comes_back("motion", &plan.motion);
        Self { program, plan }
    }
}

/// The motion of a program with its certificate.
pub fn proved(program: &Program, motion: &Motion) -> (Verified<Motion>, Certificate) {
    let mut sink = Sink::default();
    verify(program, motion.clone(), &mut sink).unwrap_or_else(|_| panic!("no certificate: {:#?}", sink.diags()))
}

impl Compiled {
    /// Plans and verifies.
    pub fn new(program: Program) -> Self {
        let Planned { program, plan } = Planned::new(program);
        let (motion, certificate) = proved(&program, &plan.motion);
        Self { program, plan, motion, certificate }
    }

    /// The program and its motion.
    pub fn planned(&self) -> (&Program, &Motion) {
        (&self.program, &self.plan.motion)
    }

    /// Plans and verifies on a number of threads.
    pub fn on_threads(threads: usize, program: Program) -> Self {
        on_threads(threads, || Self::new(program))
    }
}

fn on_threads<T: Send>(threads: usize, made: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(made)
}

/// Options for a job that ships with the compiler; for another machine of the library where `machine` names one.
pub fn options(job: &str, machine: Option<&str>) -> Options {
    let folder = if ["point", "rough", "stiff"].contains(&job) { "small" } else { job };
    let mut options = Options { job: PathBuf::from(format!("jobs/{folder}/{job}.imp")), ..Options::default() };
    options.run.machine = machine.map(str::to_owned);
    options
}

/// The jobs that ship with the compiler.
pub fn shipped() -> Vec<PathBuf> {
    let folders = std::fs::read_dir("jobs").unwrap().map(|entry| entry.unwrap().path());
    let folders = folders.filter(|path| path.is_dir() && !path.ends_with("_errors") && !path.ends_with("_lib"));
    let files = folders.flat_map(|folder| std::fs::read_dir(folder).unwrap()).map(|file| file.unwrap().path());
    let mut jobs: Vec<PathBuf> = files.filter(|path| path.extension().is_some_and(|e| e == "imp")).collect();
    jobs.sort();
    jobs
}

/// What makes the small job short: one face, few lines of the floor, which the tool may then cut deep, and deeper roughing.
pub const SHORTER: [(&str, &str); 4] = [
    ("faces pressure, suction", "faces pressure"),
    ("scallop 0.2 mm", "scallop 0.8 mm"),
    ("max-depth 4 mm", "max-depth 9 mm"),
    ("depth 3 mm", "depth 4 mm"),
];

/// The program of a shipped job, see [`options`].
pub fn program(job: &str, machine: Option<&str>) -> Program {
    front(&options(job, machine)).1
}

/// The program of a job of any folder.
pub fn program_at(job: &str) -> Program {
    front(&Options { job: PathBuf::from(job), ..Options::default() }).1
}

/// The text of a job with texts replaced, each in all of its places.
fn replaced(job: &str, changes: &[(&str, &str)]) -> String {
    changes.iter().fold(std::fs::read_to_string(job).unwrap(), |text, (from, to)| {
        assert!(text.contains(from), "{from} is not in the job");
        text.replace(from, to)
    })
}

/// The program of a job with texts replaced. The job needs no other file.
pub fn program_with(job: &str, changes: &[(&str, &str)]) -> Program {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("changed.imp");
    std::fs::write(&path, replaced(job, changes)).unwrap();
    front(&Options { job: path, ..Options::default() }).1
}

/// The sources and the program of a job.
pub fn front(options: &Options) -> (SourceMap, Program) {
    let mut outcome = Outcome::default();
    let program = driver::front(options, &mut Stages::default(), &mut outcome).unwrap().unwrap();
    (outcome.sources, program)
}

/// The machine with the control of a dialect, where the machine of the jobs has another control.
pub fn machine_of(dialect: &str) -> Option<&'static str> {
    (dialect == "linuxcnc").then_some("5mc850-c-linuxcnc")
}

/// A folder with a job of `jobs/small` with texts replaced, and its curves.
fn changed(job: &str, changes: &[(&str, &str)]) -> tempfile::TempDir {
    let text = replaced(&format!("jobs/small/{job}"), changes);
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join(job), text).unwrap();
    std::fs::copy("jobs/small/vane_curves.csv", folder.path().join("vane_curves.csv")).unwrap();
    folder
}

/// A folder with `small.imp` with texts replaced, and its curves.
pub fn small_with(changes: &[(&str, &str)]) -> tempfile::TempDir {
    changed("small.imp", changes)
}

/// What a run says of `jobs/small/rough.imp` with texts replaced, each in all of its places: planned and verified, without
/// outputs.
pub fn rough_with(changes: &[(&str, &str)]) -> Outcome {
    let folder = changed("rough.imp", changes);
    driver::compile(&Options { job: folder.path().join("rough.imp"), ..Options::default() }, &mut Stages::default())
}

/// The errors of a run.
pub fn errors(outcome: &Outcome) -> Vec<&Diag> {
    outcome.sink.diags().iter().filter(|d| d.severity == Severity::Error).collect()
}

/// The first number behind some words of a text.
pub fn number_behind(text: &str, words: &str) -> f64 {
    let (_, rest) = text.split_once(words).unwrap_or_else(|| panic!("{words} is not in {text}"));
    let rest = rest.trim_start();
    let end = rest.find(|c: char| !(c.is_ascii_digit() || c == '.' || c == '-')).unwrap_or(rest.len());
    rest[..end].parse().unwrap_or_else(|_| panic!("no number behind {words} in {text}"))
}

/// What is made of a job on the machines of both dialects, each on first use.
pub struct Dialects<T: 'static>(pub [LazyLock<T>; 2]);

impl<T> Dialects<T> {
    pub fn on(&self, dialect: &str) -> &T {
        &self.0[usize::from(machine_of(dialect).is_some())]
    }
}

/// The small or the reduced job, planned today, on the machine with the control of a dialect; the reduced one on two threads.
/// Tests of what stands behind the planner take [`super::pinned`].
pub fn planned(job: &str, dialect: &str) -> &'static Planned {
    static SMALL: Dialects<Planned> = Dialects([
        LazyLock::new(|| Planned::new(program("small", None))),
        LazyLock::new(|| Planned::new(program("small", machine_of("linuxcnc")))),
    ]);
    static REDUCED: Dialects<Planned> = Dialects([
        LazyLock::new(|| on_threads(2, || Planned::new(program("reduced", None)))),
        LazyLock::new(|| on_threads(2, || Planned::new(program("reduced", machine_of("linuxcnc"))))),
    ]);
    match job {
        "small" => SMALL.on(dialect),
        "reduced" => REDUCED.on(dialect),
        _ => panic!("{job} is planned by its own test"),
    }
}

/// Both faces of one vane of the paper's part, and nothing else, planned today.
pub fn planned_flank() -> &'static Planned {
    static FLANK: LazyLock<Planned> = LazyLock::new(|| Planned::new(super::flank_only(&[0])));
    &FLANK
}

/// The certificate of a motion for a look at surfaces alone: the cells of the stock are the largest ones, since proofs of
/// surfaces do not see them.
pub fn certified(program: &Program, motion: &Motion) -> Certificate {
    let mut settings = Settings { cell: Some(1.0), ..Settings::default() };
    certify_with(program, motion, &mut settings, &Progress::default(), &mut Sink::default()).expect("a certificate")
}

/// The stock after the last operation of a motion in cells of this edge, mm, and the report.
pub fn simulated(program: &Program, motion: &Motion, cell: f64) -> (StockReport, Field) {
    let mut last = None;
    let mut keep = |_: usize, field: &Field| last = Some(field.clone());
    let mut settings = Settings { cell: Some(cell), after: Some(&mut keep), ..Settings::default() };
    let report = simulate(program, motion, &mut settings, &Progress::default(), &mut Sink::default()).expect("a stock");
    (report, last.expect("an operation"))
}
