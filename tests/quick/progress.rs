//! Progress of long work: on a terminal the stages with their completed shares, in a pipe nothing.

use impellerc::base::progress::{Progress, State};
use impellerc::diagnostics::Sink;
use impellerc::driver::{self, Options, Outcome, Stages};
use impellerc::ir::Program;
use impellerc::plan::passes::pipeline;
use impellerc::verify;
use impellerc::verify::stock::Settings;
use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};

const JOB: &str = "jobs/reduced/reduced.imp";

#[test]
fn pipes_see_nothing() {
    let output = Command::new(env!("CARGO_BIN_EXE_impellerc")).arg(JOB).output().unwrap();
    assert!(output.status.success());
    let (said, made) = (String::from_utf8(output.stderr).unwrap(), String::from_utf8(output.stdout).unwrap());
    assert!(!said.contains(['\u{1b}', '\r']), "control signs in {said:?}");
    assert!(!made.contains(['\u{1b}', '\r']), "control signs in {made:?}");
    // Diagnostics only: each begins with its code.
    for line in said.lines().filter(|l| l.contains("IMP")) {
        assert!(["IMP03", "IMP07"].iter().any(|c| line.contains(c)), "{line}");
    }
    for stage in ["plan ", "verify "] {
        assert!(!said.lines().any(|l| l.contains(stage) && l.contains("0:00:")), "{said:?} tells of `{stage}`");
    }
}

#[test]
fn a_terminal_sees_the_names_of_long_stages() {
    // `script` of util-linux gives the command a terminal.
    let there = Command::new("script").arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
    if !there.is_ok_and(|s| s.success()) {
        std::io::stderr().write_all(b"skipped: a terminal needs `script` of util-linux in PATH\n").unwrap();
        return;
    }
    let command = format!("'{}' {JOB} > /dev/null", env!("CARGO_BIN_EXE_impellerc"));
    let output = Command::new("script")
        .args(["--quiet", "--return", "--command", &command, "/dev/null"])
        .env("TERM", "xterm-256color")
        .output()
        .unwrap();
    assert!(output.status.success());
    let seen = String::from_utf8_lossy(&output.stdout).into_owned();
    // Planning or verifying takes more than a second here; reading the job never does.
    assert!(seen.contains("verify ") || seen.contains("plan "), "{seen:?}");
    assert!(!seen.contains("resolve"), "a short stage was shown: {seen:?}");

    // `00:00:02 verify: surfaces   [####....]  43 %`: of each work the share never falls.
    let mut before: BTreeMap<(bool, &str), u32> = BTreeMap::new();
    for line in seen.split(['\r', '\n']).filter(|l| l.contains('[') && l.trim_end().ends_with('%')) {
        let (name, rest) = line.split_once(": ").unwrap_or_else(|| panic!("no work is named in {line:?}"));
        assert!(name.ends_with("plan") || name.ends_with("verify"), "{line:?}");
        let work = rest.split("  ").next().unwrap();
        let percent = rest.trim_end().trim_end_matches('%').trim().rsplit(' ').next().unwrap().parse().unwrap();
        let last = before.insert((name.ends_with("plan"), work), percent).unwrap_or(0);
        assert!(last <= percent && percent <= 100, "{work} fell from {last} to {percent} %");
    }
    assert!(before.values().any(|p| (1..100).contains(p)), "no share between none and all: {before:?}");
}

/// Looks at the shares while work goes on; gives all that was seen at once.
fn watched<T: Send>(progress: &Progress, work: impl FnOnce() -> T + Send) -> (T, Vec<Vec<State>>) {
    let ended = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let watcher = scope.spawn(|| {
            let mut seen = Vec::new();
            while !ended.load(Ordering::Acquire) {
                seen.push(progress.all());
                std::thread::sleep(std::time::Duration::from_millis(2));
            }
            seen
        });
        let made = work();
        ended.store(true, Ordering::Release);
        (made, watcher.join().unwrap())
    })
}

#[test]
fn shares_grow_to_the_whole_and_count_every_step_once() {
    let options = Options { job: JOB.into(), ..Options::default() };
    let mut outcome = Outcome::default();
    let program: Program = driver::front(&options, &mut Stages::default(), &mut outcome).unwrap().unwrap();
    let (planning, verifying) = (Progress::default(), Progress::default());
    let (plan, mut seen) =
        watched(&planning, || pipeline::run_with(&program, &planning, &mut Sink::default()).unwrap());
    let (_, more) = watched(&verifying, || {
        let settings = &mut Settings::default();
        verify::certify_with(&program, &plan.motion, settings, &verifying, &mut Sink::default()).unwrap()
    });
    for (looks, end) in [(&mut seen, planning.all()), (&mut more.clone(), verifying.all())] {
        assert!(looks.iter().flatten().any(|s| s.open && s.done > 0 && s.done < s.total), "no work was seen half done");
        looks.push(end);
        for pair in looks.windows(2) {
            for (before, after) in pair[0].iter().zip(&pair[1]) {
                assert!(before.name == after.name && before.done <= after.done, "{before:?} became {after:?}");
            }
        }
        for work in looks.last().unwrap() {
            assert!(!work.open && work.done == work.total, "{work:?} counted too little or too much");
        }
    }
    let names: Vec<String> = planning.all().iter().chain(&verifying.all()).map(|s| s.name.to_string()).collect();
    for part in ["surfaces", "groove, layers", "expand, lines", "channel, clearance", "groove, stock"] {
        assert!(names.iter().any(|n| n == part), "nothing is told of {part}: {names:?}");
    }
}

/// A run that is cancelled at any point begins no further work and does few further steps: those that its threads had begun.
#[test]
fn a_cancelled_run_does_hardly_anything_more() {
    /// Steps of all threads that may end after the cancel, and those between the look at the counts and the cancel.
    const FEW: u64 = 200;
    let options = Options { job: JOB.into(), ..Options::default() };
    let mut outcome = Outcome::default();
    let program: Program = driver::front(&options, &mut Stages::default(), &mut outcome).unwrap().unwrap();
    let plan = pipeline::run(&program, &mut Sink::default()).unwrap();
    // Stock is simulated in pieces of moves, and clearances are looked for in runs of pieces, each counted as a whole.
    let as_wholes = ["stock", "clearance", "distance"];
    let steps = |progress: &Progress| -> u64 {
        let all = progress.all();
        let single = all.iter().filter(|work| !as_wholes.iter().any(|name| work.name.contains(name)));
        single.map(|work| work.done).sum()
    };
    let run = |progress: &Progress, planning: bool| {
        if planning {
            pipeline::run_with(&program, progress, &mut Sink::default()).is_err()
        } else {
            let settings = &mut Settings::default();
            verify::certify_with(&program, &plan.motion, settings, progress, &mut Sink::default()).is_err()
        }
    };
    let mut cut_short = 0;
    for planning in [true, false] {
        let whole = Progress::default();
        assert!(!run(&whole, planning));
        let works = whole.all().len();
        // Once in each kind of work, in whatever operation it comes first.
        let mut kinds = BTreeSet::new();
        let first_of_kind = |work: &State| kinds.insert(work.name.rsplit(", ").next().unwrap().to_owned());
        let places: Vec<bool> = whole.all().iter().map(first_of_kind).collect();
        for after in (1..works).filter(|after| places[after - 1]) {
            let progress = Progress::default();
            let (ended, seen) = std::thread::scope(|scope| {
                let running = scope.spawn(|| run(&progress, planning));
                while progress.all().len() < after && !running.is_finished() {
                    std::thread::sleep(std::time::Duration::from_micros(100));
                }
                let seen = (progress.all().len(), steps(&progress));
                progress.cancel();
                (running.join().unwrap(), seen)
            });
            let (begun, done) = (progress.all().len(), steps(&progress));
            if ended {
                cut_short += 1;
                // A loop over the operations may begin the work of each, without a step.
                assert!(
                    begun <= seen.0 + program.operations.len(),
                    "after {after} of {works}: {} works began later",
                    begun - seen.0
                );
                assert!(done <= seen.1 + FEW, "after {after} of {works}: {} steps were done later", done - seen.1);
            } else {
                assert_eq!(begun, works, "a run without an end by cancelling is whole");
            }
        }
    }
    assert!(cut_short > 5, "{cut_short}");
}
