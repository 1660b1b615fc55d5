//! Stock simulation of the main job.
//!
//! `cargo bench --bench stock` plans `jobs/wei2021` once and sends it through stocks of several cells, then through
//! 0.5 mm cells with its moves cut to 10 k, 100 k and 1 M blocks. `cargo bench --bench stock -- 0.1` runs the finest
//! only.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs, reason = "a bench fails by panicking")]

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use impellerc::driver::{Options, Outcome, Stages, front};
use impellerc::ir::{JointMove, Motion, Program};
use impellerc::kin::Joints;
use impellerc::passes::pipeline;
use impellerc::verify::stock::{Settings, simulate};
use std::path::PathBuf;
use std::time::Duration;

fn planned() -> (Program, Motion) {
    let options = Options { job: PathBuf::from("jobs/wei2021/wei2021.imp"), ..Options::default() };
    let mut outcome = Outcome::default();
    let program = front(&options, &mut Stages::default(), &mut outcome).expect("a job").expect("a program");
    let motion = pipeline::run(&program, &mut outcome.sink).expect("a plan").motion;
    (program, motion)
}

fn run(program: &Program, motion: &Motion, cell: f64) -> f64 {
    let mut settings = Settings { cell: Some(cell), after: None };
    simulate(program, motion, &mut settings, &mut Default::default()).expect("a stock").rest()
}

/// The first operations up to a number of moves; or every move cut into equal parts until there are as many.
fn with_moves(program: &Program, motion: &Motion, count: usize) -> Motion {
    let all: usize = motion.operations.iter().map(|o| o.moves.len()).sum();
    let mut cut = motion.clone();
    let parts = count.div_ceil(all);
    let mut left = count;
    for operation in &mut cut.operations {
        let mut moves: Vec<JointMove> = operation.moves.first().copied().into_iter().collect();
        for pair in operation.moves.windows(2) {
            let (a, b) = (&pair[0].joints, &pair[1].joints);
            let tips = [a, b].map(|j| program.machine.forward(j).tip);
            for k in 1..=parts {
                let t = k as f64 / parts as f64;
                let (tilt, turn) = (a.a + (b.a - a.a) * t, a.c + (b.c - a.c) * t);
                let joints: Joints = program.machine.joints(&(tips[0] + (tips[1] - tips[0]) * t), tilt, turn);
                moves.push(JointMove { joints, time: pair[1].time / parts as f64, ..pair[1] });
            }
        }
        moves.truncate(left);
        left -= moves.len();
        operation.moves = moves;
    }
    cut.operations.retain(|o| !o.moves.is_empty());
    cut
}

fn stock(c: &mut Criterion) {
    let (program, motion) = planned();
    let mut group = c.benchmark_group("stock of wei2021, cells in mm");
    group.sample_size(10).warm_up_time(Duration::from_millis(1));
    for cell in ["1", "0.5", "0.25", "0.1"] {
        let size: f64 = cell.parse().expect("a number");
        group.bench_function(BenchmarkId::from_parameter(cell), |b| b.iter(|| run(&program, &motion, size)));
    }
    group.finish();
    let mut group = c.benchmark_group("stock of wei2021 at 0.5 mm, moves");
    group.sample_size(10).warm_up_time(Duration::from_millis(1));
    for count in [10_000, 100_000, 1_000_000] {
        let part = with_moves(&program, &motion, count);
        group.throughput(Throughput::Elements(count as u64));
        group.bench_function(BenchmarkId::from_parameter(count), |b| b.iter(|| run(&program, &part, 0.5)));
    }
    group.finish();
}

criterion_group!(benches, stock);
criterion_main!(benches);
