//! Whole compiles, pass by pass and check by check.
//!
//! `cargo bench --bench whole` compiles the main job, the splitter, the blisk and `small/point` once each and prints clock and
//! processor time of every part, by `--timings`. `cargo bench --bench whole -- reduced` compiles jobs by name. Times on a
//! machine that does other work say little: `-- --count reduced` counts instructions instead, by valgrind on one thread, which
//! takes some fifty times as long; `.ci/instructions` compares this count with the pinned one.

#![allow(clippy::expect_used, clippy::panic, reason = "a bench fails by panicking")]
#![allow(clippy::print_stdout, reason = "a bench prints its times")]

use std::path::PathBuf;
use std::process::{Command, Output};

/// Jobs that are compiled where none is named.
const JOBS: [&str; 4] = ["wei2021/wei2021", "splitter/splitter", "blisk/blisk", "small/point"];

/// A part of a compile takes at least this share of its processor time to be printed.
const LEAST_SHARE: f64 = 0.005;

/// A line of `--timings`: name, clock and processor time, s; parts of a stage are indented.
struct Line {
    name: String,
    clock: f64,
    processor: f64,
}

impl Line {
    fn of(text: &str) -> Option<Self> {
        let (rest, processor) = text.strip_suffix(" s")?.rsplit_once("s ")?;
        let (name, clock) = rest.trim_end().rsplit_once("  ")?;
        let number = |text: &str| text.trim().parse().ok();
        Some(Self { name: name.trim_end().to_owned(), clock: number(clock)?, processor: number(processor)? })
    }
}

fn run(mut command: Command) -> Output {
    let output = command.output().expect("the program runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    output
}

/// The job file of a name: `reduced` is `jobs/reduced/reduced.imp`.
fn job(name: &str) -> PathBuf {
    let name = if name.contains('/') { name.to_owned() } else { format!("{name}/{name}") };
    PathBuf::from("jobs").join(name).with_extension("imp")
}

fn times(name: &str) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_impellerc"));
    command.arg(job(name)).arg("--timings");
    let output = run(command);
    let text = String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout);
    let lines: Vec<Line> = text.lines().filter_map(Line::of).collect();
    let total = lines.iter().find(|line| line.name == "total").expect("a total").processor;
    println!("{name:<26} {:>9} {:>11} {:>6}", "clock", "processor", "share");
    for Line { name, clock, processor } in lines.iter().filter(|line| line.processor >= LEAST_SHARE * total) {
        println!("  {name:<24} {clock:>7.2} s {processor:>9.2} s {:>4.0} %", 100.0 * processor / total);
    }
}

fn count(name: &str) {
    let mut command = Command::new("valgrind");
    command.args(["--tool=cachegrind", "--cache-sim=no", "--cachegrind-out-file=/dev/null"]);
    command.arg(env!("CARGO_BIN_EXE_impellerc")).arg(job(name)).env("RAYON_NUM_THREADS", "1");
    let output = run(command);
    let text = String::from_utf8_lossy(&output.stderr);
    let counted = text.lines().find_map(|line| line.split_once("I   refs:")).expect("a count of valgrind").1;
    println!("{name:<26} {} instructions", counted.trim());
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| word != "--bench").collect();
    let named: Vec<&str> = words.iter().map(String::as_str).filter(|word| !word.starts_with('-')).collect();
    let jobs = if named.is_empty() { &JOBS[..] } else { &named };
    let counts = words.iter().any(|word| word == "--count");
    jobs.iter().for_each(|name| if counts { count(name) } else { times(name) });
}
