//! Goldens of the shipped jobs: the text form of every stage, the certificate, the NC text. `golden/errors` belongs to
//! `tests/errors.rs`.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use impellerc::driver::{self, Emit, Options, Outcome, Stages};
use impellerc::ir::print::{self, Detail};
use impellerc::ir::{Motion, Program};
use impellerc::passes::pipeline::{self, Plan};
use impellerc::post;
use impellerc::verify::{Certificate, Verified, verify};
use std::borrow::Cow;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

/// Snapshots of this file, by folder.
const GOLDENS: &[(&str, &[&str])] = &[
    ("reduced", &["ast", "job", "ir", "cc", "cl", "motion", "certificate", "siemens-840d", "linuxcnc", "bytes"]),
    ("point", &["ir", "plan", "certificate", "siemens-840d", "linuxcnc"]),
    // For LinuxCNC the whole job is compiled in `.ci/run`, and read by its interpreter.
    ("wei2021", &["ir", "plan", "certificate", "siemens-840d"]),
];

fn check(job: &str, name: &str, text: &str) {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(Path::new("../golden").join(job));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!(name, text));
}

fn options(job: &str, emit: Option<Emit>) -> Options {
    let folder = if job == "point" { "small" } else { job };
    Options { job: PathBuf::from(format!("jobs/{folder}/{job}.imp")), emit, ..Options::default() }
}

fn emitted(job: &str, emit: Emit) -> String {
    driver::compile(&options(job, Some(emit)), &mut Stages::default()).emitted.expect("a stage value")
}

#[derive(Clone)]
struct Compiled {
    program: Program,
    plan: Plan,
    motion: Verified<Motion>,
    certificate: Certificate,
}

/// A job, planned and verified for its own machine and post.
fn compiled(job: &str) -> Compiled {
    compiled_for(job, None)
}

/// The same for another machine of the library, as `--machine` takes it.
fn compiled_for(job: &str, machine: Option<&str>) -> Compiled {
    let mut outcome = Outcome::default();
    let mut options = options(job, None);
    options.run.machine = machine.map(str::to_owned);
    let program = driver::front(&options, &mut Stages::default(), &mut outcome).unwrap().unwrap();
    let plan = pipeline::run(&program, &mut outcome.sink).unwrap();
    let (motion, certificate) = verify(&program, plan.motion.clone(), &mut outcome.sink).unwrap();
    Compiled { program, plan, motion, certificate }
}

impl Compiled {
    /// NC text without the header, which names the hash of the inputs.
    fn nc(&self, post: &dyn post::Post) -> String {
        post.emit(&self.program, &self.motion, &[]).text()
    }
}

/// What a text snapshot does not see.
fn bytes(name: &str, text: &str) -> String {
    assert!(text.is_ascii() && text.ends_with('\n') && !text.ends_with("\n\n") && !text.contains('\r'), "{name}");
    format!("{name}: {} bytes, {} lines, blake3 {}\n", text.len(), text.lines().count(), blake3::hash(text.as_bytes()))
}

fn on_threads(threads: usize) -> Compiled {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| compiled("reduced"))
}

/// The reduced job, on two threads.
static REDUCED: LazyLock<Compiled> = LazyLock::new(|| on_threads(2));

#[test]
fn reduced_job_stage_by_stage() {
    check("reduced", "ast", &emitted("reduced", Emit::Ast));
    check("reduced", "job", &emitted("reduced", Emit::Job));
    check("reduced", "ir", &emitted("reduced", Emit::Ir));
    let c = &*REDUCED;
    check("reduced", "cc", &print::cc(&c.program, &c.plan.cc, Detail::Summary));
    check("reduced", "cl", &print::cl(&c.program, &c.plan.cl, Detail::Summary));
    check("reduced", "motion", &print::motion(&c.program, &c.plan.motion, Detail::Summary));
    check("reduced", "certificate", &c.certificate.text(&c.program, c.motion.get()));
    let mut all = String::new();
    for post in post::POSTS {
        let text = on_machine_of("reduced", *post, c).nc(*post);
        check("reduced", post.name(), &text);
        all.push_str(&bytes(post.name(), &text));
    }
    check("reduced", "bytes", &all);
}

#[test]
fn reduced_job_is_the_same_on_one_thread_and_on_two() {
    let texts = [&on_threads(1), &*REDUCED].map(|c| {
        let certificate = c.certificate.text(&c.program, c.motion.get());
        (print::motion(&c.program, &c.plan.motion, Detail::Full), certificate)
    });
    assert!(texts[0] == texts[1]);
}

/// The job on the machine that has the control of a dialect.
fn on_machine_of<'a>(job: &str, post: &dyn post::Post, own: &'a Compiled) -> Cow<'a, Compiled> {
    match post.name() {
        "linuxcnc" => Cow::Owned(compiled_for(job, Some("5mc850-c-linuxcnc"))),
        _ => Cow::Borrowed(own),
    }
}

/// The longer jobs: their plan by its notes, the ends of their NC texts and what a hash says of the rest.
fn in_short(job: &str) {
    let c = compiled(job);
    check(job, "ir", &print::program(&c.program));
    let mut plan = String::new();
    for operation in &c.plan.cl.operations {
        let name = &c.program.operations[operation.operation].name;
        plan.push_str(&format!("{name}: {} passes, {} moves\n", operation.passes.len(), operation.moves.len()));
        for note in &operation.notes {
            plan.push_str(&format!("  {note}\n"));
        }
    }
    check(job, "plan", &plan);
    check(job, "certificate", &c.certificate.text(&c.program, c.motion.get()));
    let pinned = |post: &dyn post::Post| GOLDENS.iter().any(|(name, of)| *name == job && of.contains(&post.name()));
    for post in post::POSTS.iter().filter(|post| pinned(**post)) {
        let c = on_machine_of(job, *post, &c);
        let text = c.nc(*post);
        let read = post::read_back(*post, &c.program, &c.motion, &text).expect("the motion");
        let lines: Vec<&str> = text.lines().collect();
        let short = format!(
            "{}{} moves read back\n\n{}\n...\n{}\n",
            bytes(post.name(), &text),
            read.moves,
            lines[..40].join("\n"),
            lines[lines.len() - 20..].join("\n")
        );
        check(job, post.name(), &short);
    }
}

#[test]
fn whole_job_in_short() {
    in_short("wei2021");
}

#[test]
fn point_milled_job_in_short() {
    in_short("point");
}

#[test]
fn no_golden_is_without_its_test() {
    let expected: BTreeSet<PathBuf> = GOLDENS
        .iter()
        .flat_map(|(job, names)| names.iter().map(move |n| Path::new("golden").join(job).join(format!("{n}.snap"))))
        .collect();
    let mut found = BTreeSet::new();
    for folder in std::fs::read_dir("golden").unwrap() {
        let folder = folder.unwrap().path();
        if folder.ends_with("errors") {
            continue;
        }
        found.extend(std::fs::read_dir(folder).unwrap().map(|f| f.unwrap().path()));
    }
    assert_eq!(found, expected, "golden/ has files without a test, or lacks some");
}
