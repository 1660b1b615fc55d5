//! Readers of NC text: `jobs/small` in the words of each post of the library, its operations many times over.
//!
//! `cargo bench --bench read` plans the job for each post, writes its operations until the text has enough lines, and reads the
//! text; `-- fanuc` takes one post alone. The least time of several runs counts: other work on the machine only adds to it.

#![allow(clippy::expect_used, reason = "a bench fails by panicking")]
#![allow(clippy::print_stdout, reason = "a bench prints its times")]

mod time;

use impellerc::driver::{Options, Outcome, RunOptions, Stages, front};
use impellerc::ir::{Motion, Program};
use impellerc::nc;
use impellerc::plan::passes::pipeline;
use std::path::PathBuf;
use std::time::Instant;
use time::processor;

/// Posts, each with another machine than that of the job where its control needs one.
const POSTS: [(&str, Option<&str>); 8] = [
    ("siemens-840d", None),
    ("fanuc", None),
    ("makino", None),
    ("mitsubishi", None),
    ("heidenhain", None),
    ("heidenhain-itnc530", None),
    ("linuxcnc", Some("5mc850-c-linuxcnc")),
    ("apt-cl", None),
];

/// Least lines of a text.
const LINES: usize = 400_000;

/// Times that a text is read.
const RUNS: usize = 7;

fn planned(post: &str, machine: Option<&str>) -> (Program, Motion) {
    let run = RunOptions { post: Some(post.to_owned()), machine: machine.map(str::to_owned), ..RunOptions::default() };
    let options = Options { job: PathBuf::from("jobs/small/small.imp"), run, ..Options::default() };
    let mut outcome = Outcome::default();
    let program = front(&options, &mut Stages::default(), &mut outcome).expect("a job").expect("a program");
    let motion = pipeline::run(&program, &mut outcome.sink).expect("a plan").motion;
    (program, motion)
}

/// Lines in proportion to the operations, so that the text has at least [`LINES`].
fn text(post: &dyn nc::Post, program: &Program, mut motion: Motion) -> String {
    let once = nc::emit(post, program, &motion, &[]).lines.len();
    let operations = motion.operations.clone();
    for _ in 0..LINES / once {
        motion.operations.extend(operations.iter().cloned());
    }
    nc::emit(post, program, &motion, &[]).text()
}

fn main() {
    let wanted: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    for (name, machine) in POSTS.iter().filter(|(name, _)| wanted.is_empty() || wanted.iter().any(|w| w == name)) {
        let (program, motion) = planned(name, *machine);
        let post = nc::find(&program.post.dialect).expect("a dialect");
        let text = text(post, &program, motion);
        let lines = text.lines().count();
        let (mut least, before) = (f64::INFINITY, processor());
        for _ in 0..RUNS {
            let clock = Instant::now();
            let sections = post.read_with_offset(&text, &program.machine, program.post.work_offset());
            least = least.min(clock.elapsed().as_secs_f64());
            assert!(sections.is_ok_and(|sections| !sections.is_empty()));
        }
        let busy = before
            .and_then(|b| processor().map(|now| format!("{:.0} ns", (now - b) / RUNS as f64 / lines as f64 * 1e9)));
        println!(
            "{name:<20} {lines:>8} lines {:>6.1} MB  {:>7.1} MB/s {:>6.0} k lines/s  processor {:>8} a line",
            text.len() as f64 * 1e-6,
            text.len() as f64 * 1e-6 / least,
            lines as f64 * 1e-3 / least,
            busy.unwrap_or_default()
        );
    }
}
