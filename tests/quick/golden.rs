//! Goldens of the reduced job, and whether every golden has its test; goldens of whole parts are in
//! `tests/slow/golden.rs`.

use crate::support::golden::{GOLDENS, bytes, check, nc};
use crate::support::jobs::{self, Compiled};
use crate::support::pinned;
use impellerc::driver::{self, Emit, Stages};
use impellerc::ir::print::{self, Detail};
use impellerc::nc;
use impellerc::report::proof::details::details;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

fn emitted(job: &str, emit: Emit) -> String {
    let options = driver::Options { emit: Some(emit), ..jobs::options(job, None) };
    driver::compile(&options, &mut Stages::default()).emitted.expect("a stage value")
}

#[test]
fn reduced_job_stage_by_stage() {
    check("reduced", "ast", &emitted("reduced", Emit::Ast));
    check("reduced", "job", &emitted("reduced", Emit::Job));
    check("reduced", "ir", &emitted("reduced", Emit::Ir));
    let c = jobs::planned("reduced", "siemens-840d");
    check("reduced", "cc", &print::cc(&c.program, &c.plan.cc, Detail::Summary));
    check("reduced", "cl", &print::cl(&c.program, &c.plan.cl, Detail::Summary));
    check("reduced", "motion", &print::motion(&c.program, &c.plan.motion, Detail::Summary));
    let p = pinned::reduced("siemens-840d");
    check("reduced", "certificate", &details(&p.program, &p.motion, p.certificate()));
    let mut all = String::new();
    for post in nc::POSTS {
        let text = nc(pinned::reduced(post.name()).planned(), *post);
        check("reduced", post.name(), &text);
        all.push_str(&bytes(post.name(), &text));
    }
    check("reduced", "bytes", &all);
}

/// `tests/quick/angles.rs` has the oracles of blades by angles.
#[test]
fn wheels_by_angles() {
    for job in ["splitter", "blisk"] {
        check(job, "job", &emitted(job, Emit::Job));
        check(job, "ir", &emitted(job, Emit::Ir));
    }
}

#[test]
fn reduced_job_is_the_same_on_one_thread_and_on_two() {
    let texts = [1, 2].map(|threads| {
        let c = Compiled::on_threads(threads, jobs::program("reduced", None));
        let certificate = details(&c.program, &c.motion, &c.certificate);
        (print::motion(&c.program, &c.plan.motion, Detail::Full), certificate)
    });
    assert!(texts[0] == texts[1]);
}

#[test]
fn no_golden_is_without_its_test() {
    let expected: BTreeSet<PathBuf> = GOLDENS
        .iter()
        .flat_map(|(job, names)| names.iter().map(move |n| Path::new("golden").join(job).join(format!("{n}.snap"))))
        .chain(pinned::NAMES.map(pinned::path))
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
