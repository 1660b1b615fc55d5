//! Flank milling of one face of the paper's part by `minimax`: the optimiser, the charts of the surroundings given; and
//! how well the cutters of the main job fit its faces, which `--emit facts` tells.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a bench may stop at once")]

use criterion::{BenchmarkId, Criterion, SamplingMode, criterion_group, criterion_main};
use impellerc::base::entity::PrimaryMap;
use impellerc::base::progress::Progress;
use impellerc::base::units::Mm;
use impellerc::diagnostics::Sink;
use impellerc::driver::{self, Options, Outcome, Stages};
use impellerc::ir::{Contract, ContractKind, OperationKind};
use impellerc::plan::facts::flank;
use impellerc::plan::passes::flank::strip::Surroundings;
use impellerc::plan::passes::{Obstacles, flank::plan};
use impellerc::wheel::method::{Conflict, ErrorSide};
use impellerc::wheel::part::BladeId;
use std::hint::black_box;
use std::path::PathBuf;

fn faces(c: &mut Criterion) {
    let options = Options { job: PathBuf::from("jobs/wei2021/wei2021.imp"), ..Options::default() };
    let mut outcome = Outcome::default();
    let program = driver::front(&options, &mut Stages::default(), &mut outcome).unwrap().unwrap();
    let mut group = c.benchmark_group("one face of wei2021");
    group.sampling_mode(SamplingMode::Flat).sample_size(10);
    for (name, strips, bounds, chord) in [("one band", 1, [1.0, 12.0], 0.25), ("two bands", 2, [2.0, 2.0], 0.1)] {
        let mut program = program.clone();
        program.tolerances.chord = Mm(chord * 1e-3);
        program.contracts = vec![
            Contract::whole(ContractKind::Gouge, bounds[0] * 1e-3),
            Contract::whole(ContractKind::Excess, bounds[1] * 1e-3),
        ];
        let all = std::mem::replace(&mut program.operations, PrimaryMap::new());
        let mut id = None;
        for (_, operation) in all.iter() {
            let mut operation = operation.clone();
            if let OperationKind::Flank { flank, .. } = &mut operation.kind {
                (flank.strips, flank.side, flank.conflict) = (Some(strips), ErrorSide::Both, Conflict::Balance);
                id = Some(program.operations.push(operation));
            }
        }
        let around = Surroundings::new(&program.part);
        let obstacles = Obstacles::new(&program.part, &program.machine);
        for side in BladeId::MAIN.faces() {
            group.bench_function(BenchmarkId::new(side.name(), name), |b| {
                b.iter(|| black_box(plan::axis_paths(&program, id.unwrap(), side, &around, &obstacles).unwrap()));
            });
        }
    }
    group.bench_function("fit of both faces", |b| {
        b.iter(|| flank::report(&program, &Progress::default(), &mut black_box(Sink::default())))
    });
    group.finish();
}

criterion_group!(benches, faces);
criterion_main!(benches);
