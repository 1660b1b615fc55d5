//! The report of every code as a golden, and the manual pages.

use impellerc::base::progress::Progress;
use impellerc::diagnostics::{Code, Severity, codes, render};
use impellerc::driver::{self, Options, Outcome, Stages};
use impellerc::plan::{self, facts};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Codes whose example cannot be a small file, and those that only other commands show: the export of a part (`solids.rs`) and
/// `fmt` (`job_format.rs`).
const WITHOUT_EXAMPLE: [Code; 4] =
    [codes::syntax::TOO_LARGE, codes::syntax::TOO_MANY, codes::syntax::NOT_FORMATTED, codes::geometry::NO_SHELL];

fn examples() -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = std::fs::read_dir("jobs/_errors")
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "imp"))
        .collect();
    files.sort();
    files
}

/// What the stages before planning say; facts and cost only for the examples that show them.
fn report(job: &Path) -> Outcome {
    let mut outcome = Outcome::default();
    let options = Options { job: job.to_path_buf(), ..Options::default() };
    let program = driver::front(&options, &mut Stages::default(), &mut outcome);
    if let Ok(Some(program)) = program {
        let _ = facts::flat_edges::check(&program, &mut outcome.sink);
        if stem(job).ends_with("-facts") {
            facts::check_with_fits(&program, &Progress::default(), &mut outcome.sink);
        }
        if stem(job).ends_with("-frame") {
            let _ = driver::check_frames(&program, &mut outcome.sink);
        }
        if stem(job).ends_with("-cost") {
            let _ = plan::budget::check(&program, &mut outcome.sink);
        }
    }
    outcome
}

fn stem(path: &Path) -> String {
    path.file_stem().unwrap().to_str().unwrap().to_owned()
}

#[test]
fn each_example_is_reported_as_pinned() {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path("../../golden/errors");
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    let mut wrong = Vec::new();
    for path in examples() {
        let stem = stem(&path);
        let outcome = report(&path);
        let code = stem.split('-').next().unwrap();
        if !outcome.sink.diags().iter().any(|d| d.code.id() == code) {
            wrong.push(stem.clone());
        }
        settings.bind(|| insta::assert_snapshot!(stem, render::human(&outcome.sink, &outcome.sources, false)));
    }
    assert!(wrong.is_empty(), "examples without the diagnostic of their name: {wrong:?}");
}

#[test]
fn each_golden_has_its_example() {
    let stems: BTreeSet<String> = examples().iter().map(|p| stem(p)).collect();
    for entry in std::fs::read_dir("golden/errors").unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        let stem = name.strip_suffix(".snap").unwrap_or_else(|| panic!("{name} is no golden"));
        assert!(stems.contains(stem), "no example makes golden/errors/{name}");
    }
}

#[test]
fn each_code_of_text_job_and_geometry_has_an_example() {
    let shown: BTreeSet<&str> = examples()
        .iter()
        .flat_map(|p| report(p).sink.diags().iter().map(|d| d.code.id()).collect::<Vec<_>>())
        .collect();
    for code in [codes::syntax::ALL, codes::job::ALL, codes::geometry::ALL].concat() {
        let found = shown.contains(code.id());
        assert!(found || WITHOUT_EXAMPLE.contains(&code), "{code} has no file in jobs/_errors");
    }
}

#[test]
fn each_code_has_a_page_and_a_number_of_its_own() {
    let mut ids = BTreeSet::new();
    for code in Code::all() {
        assert!(ids.insert(code.id()), "{code} is used twice");
        assert!(code.id().len() == 7 && code.id().starts_with("IMP"), "{code} is no code");
        assert!(!code.0.title.is_empty());
        assert!(code.0.page.len() > 80, "the page of {code} says too little");
        assert!(code.0.page.contains("Remedy:"), "the page of {code} shows no remedy");
    }
}

/// Machines have rotary axes of any two letters, in the table or in the head. So a page names an axis by its place. An example may
/// have letters; IMP0218 is on the letters themselves, and IMP0809 on the two kinematics of LinuxCNC.
#[test]
fn pages_of_codes_name_no_axis_by_its_letter() {
    for code in Code::all().filter(|code| !["IMP0218", "IMP0809"].contains(&code.id())) {
        let own = code.0.page.split("\n\n").filter(|text| !text.starts_with("Example") && !text.starts_with("    "));
        for text in own {
            let mut words = text.split_whitespace().map(|w| w.trim_matches(&['(', ')', ',', '.', ':'][..])).peekable();
            while let Some(word) = words.next() {
                // `A` may be the article.
                let before_axis = words.peek().is_some_and(|next| ["and", "or", "axis", "="].contains(next));
                let letter = word == "B" || word == "C" || word == "A" && before_axis;
                assert!(!letter, "the page of {code} names an axis by its letter: {text}");
            }
        }
    }
}

#[test]
fn each_error_of_the_examples_has_a_help_line() {
    for path in examples() {
        for diag in report(&path).sink.diags().iter().filter(|d| d.severity == Severity::Error) {
            assert!(diag.help.is_some(), "{} in {} has no help", diag.code, path.display());
        }
    }
}
