//! The cost of a plan is known before it starts: jobs that would need too much are refused, with a value that fits.

use crate::support::jobs;
use impellerc::diagnostics::Sink;
use impellerc::diagnostics::codes::{job as codes, planning};
use impellerc::driver::{self, Options, Outcome, Stages};
use impellerc::plan::budget;
use std::process::Command;

const JOB: &str = include_str!("../../jobs/wei2021/paper-strategies.imp");

fn job(changes: &[(&str, &str)]) -> String {
    changes.iter().fold(JOB.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from} is not in the job");
        text.replace(from, to)
    })
}

/// What the front end and the estimate say of a job.
fn estimated(text: &str, memory: Option<f64>) -> Outcome {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("job.imp");
    std::fs::write(&path, text).unwrap();
    let mut outcome = Outcome::default();
    let mut options = Options { job: path, ..Options::default() };
    options.run.memory = memory;
    if let Ok(Some(program)) = driver::front(&options, &mut Stages::default(), &mut outcome) {
        assert_eq!(budget::check(&program, &mut outcome.sink).is_err(), outcome.sink.has_errors());
    }
    outcome
}

/// The value in the help of the error, as `scallop 3 um`.
fn fitting(outcome: &Outcome) -> String {
    let error = outcome.sink.diags().iter().find(|d| d.code == planning::OVER_MEMORY).expect("refused for its memory");
    let help = error.help.clone().unwrap();
    help.split('`').nth(1).filter(|_| help.contains("or more, fewer")).expect("a value that fits").to_owned()
}

/// Estimated memory of a job beside the curves of the small one, bytes.
fn needed(text: &str) -> f64 {
    needed_with(text, include_str!("../../jobs/small/vane_curves.csv"))
}

/// The same beside other curves.
fn needed_with(text: &str, curves: &str) -> f64 {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("job.imp");
    std::fs::write(&path, text).unwrap();
    std::fs::write(folder.path().join("vane_curves.csv"), curves).unwrap();
    let mut outcome = Outcome::default();
    let options = Options { job: path, ..Options::default() };
    let program = driver::front(&options, &mut Stages::default(), &mut outcome).unwrap().unwrap();
    budget::needed(&program)
}

/// Peak memory of the compilation, as `/usr/bin/time -v` told it; of the last three of `--emit motion`, which takes more than
/// what follows it.
#[test]
fn estimates_are_within_a_factor_of_two_of_what_was_measured() {
    let small = include_str!("../../jobs/small/small.imp");
    let (start, end) = (small.find("operation groove").unwrap(), small.find("tolerance chord").unwrap());
    let alone = |operation: &str| format!("{}{operation}\n{}", &small[..start], &small[end..]);
    let channel = |scallop: &str, sectors: &str| {
        alone(&format!(
            "operation channel {{ tool t2  speed 12000 rpm  feed 250 mm/min  scallop {scallop}  spacing equal-division  \
             method blend  lead-in 4 mm  lead-out 4 mm  sectors {sectors} }}"
        ))
    };
    let expand = |depth: &str, residual: &str| {
        alone(&format!(
            "operation expand {{ tool t1  speed 12000 rpm  feed 150 mm/min  depth {depth}  residual {residual}  allowance \
             vane 0.2 mm, hub 0.4 mm  lead-in 4 mm  lead-out 4 mm  sectors 1, 2, 3, 4 }}"
        ))
    };
    let reduced = include_str!("../../jobs/reduced/reduced.imp");
    let (rough, turbo20) = (include_str!("../../jobs/small/rough.imp"), include_str!("../../jobs/turbo20/turbo20.imp"));
    let narrow = rough.replace("vanes 8", "vanes 16").replace("ball { diameter 2 mm", "ball { diameter 0.56 mm");
    let alone_in_narrow = narrow.replace("tools t1, t2 ", "tools t2 ").replace("tool t1", "tool t0");
    let measured = [
        (needed(small), 73e6),
        (needed(include_str!("../../jobs/small/point.imp")), 99e6),
        (needed_with(reduced, include_str!("../../jobs/reduced/vane_curves.csv")), 190e6),
        (needed(JOB), 698e6),
        (needed(&channel("20 um", "1")), 98e6),
        (needed(&channel("1 um", "1")), 251e6),
        (needed(&channel("1 um", "1, 2, 3, 4")), 635e6),
        (needed(&expand("0.5 mm", "20 um")), 1.837e9),
        (needed(&channel("0.1 um", "1")), 661e6),
        (needed(&channel("1 um", "1, 2, 3, 4, 5, 6, 7, 8")), 1.637e9),
        (needed(&expand("0.1 mm", "5 um")), 16.15e9),
        (needed(rough), 352e6),
        (needed(&narrow), 1.397e9),
        (needed(&alone_in_narrow), 4.846e9),
        (needed(include_str!("../../jobs/wei2021/rough.imp")), 260e6),
        (needed_with(include_str!("../../jobs/pump/pump.imp"), ""), 275e6),
        (needed_with(turbo20, include_str!("../../jobs/turbo20/vane_curves.csv")), 276e6),
    ];
    let ratios = measured.map(|(needed, bytes)| needed / bytes);
    println!("{ratios:.2?}");
    assert!(ratios.iter().all(|r| (0.5..=2.0).contains(r)), "{ratios:.2?}");
}

#[test]
fn the_main_job_fits() {
    assert!(!estimated(JOB, None).sink.has_errors());
}

#[test]
fn what_is_too_fine_is_refused_with_a_value_that_fits() {
    for (from, to) in
        [("depth 3 mm", "depth 10 um"), ("residual 0.4 mm", "residual 1 um"), ("depth 1.5 mm", "depth 10 um")]
    {
        let refused = estimated(&job(&[(from, to)]), None);
        let value = fitting(&refused);
        let again = estimated(&job(&[(from, &value)]), None);
        assert!(!again.sink.has_errors(), "{value}: {:?}", again.sink.diags());
        // A tenth finer than what fits may fit as well, a tenth of it does not.
        let (property, number) = value.split_once(' ').unwrap();
        let tenth = estimated(&job(&[(from, &format!("{property} {number} * 0.1"))]), None);
        assert!(tenth.sink.has_errors(), "a tenth of {value} fits");
    }
}

#[test]
fn more_memory_may_be_allowed() {
    let fine = job(&[("residual 0.4 mm", "residual 1 um")]);
    assert!(estimated(&fine, None).sink.has_errors());
    assert!(!estimated(&fine, Some(1e11)).sink.has_errors());
    assert!(estimated(JOB, Some(1e8)).sink.has_errors());
}

#[test]
fn many_operations_and_many_strips_are_refused() {
    let start = JOB.find("operation channel").unwrap();
    let end = start + JOB[start..].find('}').unwrap() + 1;
    let many = JOB.replace(&JOB[start..end], &format!("{}\n", &JOB[start..end]).repeat(100));
    assert!(estimated(&many, None).sink.diags().iter().any(|d| d.code == planning::OVER_MEMORY));
    let strips = estimated(&job(&[("strips auto", "strips 100")]), None);
    assert!(strips.sink.diags().iter().any(|d| d.code == codes::OUT_OF_RANGE));
    let start = JOB.find("operation flank").unwrap();
    let end = start + JOB[start..].find('}').unwrap() + 1;
    let many = JOB.replace(&JOB[start..end], &format!("{}\n", &JOB[start..end]).repeat(100));
    let refused = estimated(&many, None);
    assert!(
        refused.sink.diags().iter().any(|d| d.message.contains("strips of flank milling")),
        "{:?}",
        refused.sink.diags()
    );
}

#[test]
fn the_command_line_takes_sizes() {
    let run = |memory: &str| {
        let arguments = ["jobs/_errors/IMP0420-cost.imp", "--memory", memory, "--error-format", "json"];
        let run = Command::new(env!("CARGO_BIN_EXE_impellerc")).args(arguments).output().unwrap();
        (run.status.code(), String::from_utf8(run.stderr).unwrap())
    };
    for memory in ["4", "-1GB", "1e300GB", "nanGB", "1 KB", ""] {
        let (code, text) = run(memory);
        assert_eq!(code, Some(2), "{memory}: {text}");
        assert!(text.contains("such as 4GB"), "{text}");
    }
    let (code, text) = run("1.5 GB");
    assert_eq!(code, Some(2));
    assert!(text.contains("IMP0420") && text.contains("the limit is 1.5 GB"), "{text}");
}

/// Where surfaces of the part take the memory, the message says so, and asks for nothing that does not lower it.
#[test]
fn a_part_that_takes_the_memory_is_named() {
    let mut program = jobs::program("small", None);
    let of_part = budget::of_stations(&program, budget::Stations::default());
    program.memory = 0.9 * of_part;
    let mut sink = Sink::default();
    assert!(budget::check(&program, &mut sink).is_err());
    let [diag] = sink.diags() else { panic!("{:?}", sink.diags()) };
    let help = diag.help.as_ref().unwrap();
    assert!(help.contains("the part alone") && !help.contains("sectors"), "{help}");
    assert_eq!(diag.labels[0].span, program.name_span);
    assert!(
        diag.notes[0].starts_with("the part with samples of the surfaces of all its sectors: about "),
        "{:?}",
        diag.notes
    );
    // What the message asks for is enough.
    program.memory = 1e9 * jobs::number_behind(help, "`--memory");
    assert!(budget::check(&program, &mut Sink::default()).is_ok());
}
