//! Stock simulation: the main job, and how it grows with the number of blocks.
//!
//! `cargo bench --bench stock` plans `jobs/wei2021` once and sends it through stocks of several cells, then one synthetic
//! program of 10 k, 100 k and 1 M blocks over the same room. `cargo bench --bench stock -- 0.1` runs the finest cells
//! only, `-- blocks` the growth only. Cases take seconds to minutes, so each runs once; the processor time of all
//! threads, where the system tells it, says more than the clock on a machine that does other work.

#![allow(clippy::expect_used, reason = "a bench fails by panicking")]
#![allow(clippy::print_stdout, reason = "a bench prints its times")]

mod time;

use impellerc::driver::{Options, Outcome, Stages, front};
use impellerc::ir::{Motion, Program};
use impellerc::plan::passes::pipeline;
use impellerc::tool_stock::collide::{Cutter, ToolSolid};
use impellerc::tool_stock::stock::{self, Field, Step, StepKind};
use impellerc::verify::stock::{Settings, simulate};
use nalgebra::{Point3, Vector3};
use std::path::PathBuf;
use std::time::Instant;
use time::processor;

fn planned() -> (Program, Motion) {
    let options = Options { job: PathBuf::from("jobs/wei2021/wei2021.imp"), ..Options::default() };
    let mut outcome = Outcome::default();
    let program = front(&options, &mut Stages::default(), &mut outcome).expect("a job").expect("a program");
    let motion = pipeline::run(&program, &mut outcome.sink).expect("a plan").motion;
    (program, motion)
}

fn timed(name: &str, run: impl FnOnce() -> f64) {
    let (clock, before) = (Instant::now(), processor());
    let rest = run();
    let clock = clock.elapsed().as_secs_f64();
    let busy = before.and_then(|b| processor().map(|now| format!("{:.2} s", now - b)));
    println!("{name:<24} clock {clock:>8.2} s  processor {:>10}  rest {rest:.1} mm3", busy.unwrap_or_default());
}

/// Lines of a tilted ball cutter over a plate of 40 mm, in layers, the axis swaying: the same way in any number of blocks.
fn lines(blocks: usize) -> impl Iterator<Item = Step> {
    const LINES: usize = 100;
    let each = blocks / LINES;
    let pose = move |line: usize, share: f64| {
        let x = if line.is_multiple_of(2) { share } else { 1.0 - share };
        let axis = Vector3::new(0.3 + 0.1 * (6.0 * x).sin(), 0.2 * (5.0 * x).cos(), 1.0).normalize();
        let y = (line % 50) as f64 * 0.8 - 20.0;
        (Point3::new(50.0 * x - 25.0, y, -1.0 - (line / 50) as f64), axis)
    };
    (0..LINES).flat_map(move |line| {
        (0..each).map(move |k| {
            let at = |h: f64| pose(line, (k as f64 + h) / each as f64);
            let block = u32::try_from(line * each + k).expect("blocks fit");
            let tips = [at(0.0).0, at(1.0).0];
            Step { block, kind: StepKind::Cut, tips, axes: [at(0.0).1, at(0.5).1, at(1.0).1] }
        })
    })
}

fn main() {
    let wanted: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let chosen = |name: &str| wanted.is_empty() || wanted.iter().any(|w| w == name);
    let cells: Vec<&str> = ["1", "0.5", "0.25", "0.1"].into_iter().filter(|c| chosen(c)).collect();
    if !cells.is_empty() {
        let (program, motion) = planned();
        for cell in cells {
            let size: f64 = cell.parse().expect("a number");
            timed(&format!("wei2021, cells {cell} mm"), || {
                let mut settings = Settings { cell: Some(size), each_sector: true, ..Settings::default() };
                simulate(&program, &motion, &mut settings, &Default::default(), &mut Default::default())
                    .expect("a stock")
                    .rest()
                    .get()
            });
        }
    }
    if chosen("blocks") {
        let cutter = Cutter::ball(3.0);
        let solid = ToolSolid { cutter, flute_length: 20.0, shank: Vec::new(), holder: Vec::new() };
        for blocks in [10_000, 100_000, 1_000_000] {
            timed(&format!("{blocks} blocks, cells 0.25 mm"), || {
                let plate = [[0.0, -10.0], [20.0, -10.0], [20.0, 0.0], [0.0, 0.0]];
                let mut field = Field::turned(&plate, 0.25).expect("a field");
                stock::simulate(&mut field, &solid, lines(blocks));
                field.volume()
            });
        }
    }
}
