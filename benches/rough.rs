//! Planning of one `rough` item at the usual stations and at finer ones. Four times finer stations come from a tolerance of a
//! sixteenth.
//!
//! `cargo bench --bench rough` plans `jobs/wei2021/rough.imp` at stations 1, 2 and 4 times finer. A case takes up to some
//! minutes, so each runs once; processor time of all threads, where the system tells it, says more than the clock on a
//! machine that does other work. The exponent compares a case with the usual stations: 1 is linear.

#![allow(clippy::expect_used, reason = "a bench fails by panicking")]
#![allow(clippy::print_stdout, reason = "a bench prints its times")]

mod time;

use impellerc::base::units::Mm;
use impellerc::driver::{Options, Outcome, Stages, front};
use impellerc::plan::passes::pipeline;
use std::path::PathBuf;
use std::time::Instant;
use time::processor;

fn main() {
    let options = Options { job: PathBuf::from("jobs/wei2021/rough.imp"), ..Options::default() };
    let program = front(&options, &mut Stages::default(), &mut Outcome::default()).expect("a job").expect("a program");
    let mut usual: Option<[f64; 2]> = None;
    for finer in [1.0_f64, 2.0, 4.0] {
        let mut program = program.clone();
        program.tolerances.chord_rough = Mm(program.tolerances.chord_rough.get() / (finer * finer));
        program.memory = 2e10;
        let (clock, before) = (Instant::now(), processor());
        let plan = pipeline::run(&program, &mut Outcome::default().sink).expect("a plan");
        let clock = clock.elapsed().as_secs_f64();
        let busy = before.and_then(|b| processor().map(|now| now - b));
        let stations: usize = plan.cc.operations.iter().flat_map(|o| &o.passes).map(|p| p.points.len()).sum();
        let moves: usize = plan.motion.operations.iter().map(|o| o.moves.len()).sum();
        let now = [stations as f64, busy.unwrap_or(clock)];
        let exponent = usual.map_or(1.0, |[stations, time]| (now[1] / time).ln() / (now[0] / stations).ln());
        usual = usual.or(Some(now));
        println!(
            "stations {finer} times finer: {stations} in a sector, {moves} moves; clock {clock:.1} s, processor {:.1} s, \
             exponent {exponent:.2}",
            now[1]
        );
    }
}
