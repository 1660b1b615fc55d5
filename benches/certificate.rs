//! Surface certificate: the main job, and how it grows with the number of blocks.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a bench may stop at once")]

use criterion::{BenchmarkId, Criterion, SamplingMode, criterion_group, criterion_main};
use impellerc::driver::{self, Options, Outcome, Stages};
use impellerc::five_axis::{Chain, RotaryPose};
use impellerc::nurbs::range::CellThickness;
use impellerc::plan::passes::pipeline;
use impellerc::tool_stock::collide::{Cutter, ToolSolid};
use impellerc::verify::proof::sweep::Sweep;
use impellerc::verify::surface::{Limits, certify, certify_shape};
use impellerc::wheel::part::kept::MilledTurned;
use impellerc::wheel::part::{
    PassageId, SurfaceId, SurfaceKind,
    chart::{Place, Shape},
};
use nalgebra::{Point3, Vector3};
use std::hint::black_box;
use std::path::PathBuf;

fn main_job(c: &mut Criterion) {
    let options = Options { job: PathBuf::from("jobs/wei2021/wei2021.imp"), ..Options::default() };
    let mut outcome = Outcome::default();
    let program = driver::front(&options, &mut Stages::default(), &mut outcome).unwrap().unwrap();
    let motion = pipeline::run(&program, &mut outcome.sink).unwrap().motion;
    let mut group = c.benchmark_group("certificate of wei2021");
    group.sampling_mode(SamplingMode::Flat).sample_size(10);
    let sweeps = || -> Vec<Sweep<'_>> {
        (0..motion.operations.len()).filter_map(|o| Sweep::new(&program, &motion, o)).collect()
    };
    group.bench_function("hierarchy", |b| b.iter(|| black_box(sweeps().len())));
    let built = sweeps();
    for spacing in [0.25, 0.1] {
        group.bench_function(BenchmarkId::new("surfaces, cells of mm", spacing), |b| {
            b.iter(|| {
                black_box(certify(
                    &program.part,
                    MilledTurned::default(),
                    &built,
                    spacing,
                    &Limits::default(),
                    &Default::default(),
                ))
            });
        });
    }
    group.finish();
}

/// A plane of 40 mm by 40 mm.
struct Floor;

const SIDE: f64 = 40.0;

impl Shape for Floor {
    fn place(&self, x: f64, y: f64) -> Place {
        Place { position: Point3::new(x * SIDE, y * SIDE, 0.0), normal: Vector3::z(), parameters: [x, y] }
    }

    fn thickness(&self, _: [[f64; 2]; 2]) -> CellThickness {
        CellThickness::of_rate(0.0, 1.0)
    }
}

/// Passes of a ball over the plane in a number of blocks, the axis swaying.
fn passes(blocks: usize) -> Vec<RotaryPose> {
    const LINES: usize = 100;
    let per_line = blocks / LINES;
    (0..LINES)
        .flat_map(|line| {
            (0..per_line).map(move |k| {
                let share = k as f64 / (per_line - 1) as f64;
                let x = if line % 2 == 0 { share } else { 1.0 - share };
                let (a, c) = (0.3 + 0.1 * (6.0 * x).sin(), 0.2 * (5.0 * x).cos());
                let axis = Chain::tilting_table().tool_axis([a, c]);
                let centre = Point3::new(x * SIDE, line as f64 * SIDE / (LINES - 1) as f64, 2.0);
                RotaryPose { tip: centre - axis * 2.0, rotary: [a, c] }
            })
        })
        .collect()
}

fn growth(c: &mut Criterion) {
    let solid = ToolSolid { cutter: Cutter::ball(2.0), flute_length: 20.0, shank: Vec::new(), holder: Vec::new() };
    let mut group = c.benchmark_group("certificate of a plane, blocks");
    group.sampling_mode(SamplingMode::Flat).sample_size(10);
    for blocks in [10_000, 100_000, 1_000_000] {
        let (poses, chain) = (passes(blocks), Chain::tilting_table());
        group.bench_function(BenchmarkId::from_parameter(blocks), |b| {
            b.iter(|| {
                let sweeps = [Sweep::through(&solid, &chain, &poses).unwrap()];
                let id = SurfaceId { kind: SurfaceKind::Hub(PassageId::FIRST), sector: 0 };
                black_box(certify_shape(&Floor, id, &sweeps, 0.25))
            });
        });
    }
    group.finish();
}

criterion_group!(benches, main_job, growth);
criterion_main!(benches);
