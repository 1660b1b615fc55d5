//! Flank milling of one face of the paper's part by `minimax`: planning from the program to the motion.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a bench may stop at once")]

use criterion::{BenchmarkId, Criterion, SamplingMode, criterion_group, criterion_main};
use impellerc::driver::{self, Options, Outcome, Stages};
use impellerc::entity::PrimaryMap;
use impellerc::ir::{Contract, ContractKind, OperationKind, Side};
use impellerc::method::{Conflict, ErrorSide, Flank, FlankMethod};
use impellerc::passes::pipeline;
use impellerc::units::Mm;
use std::hint::black_box;
use std::path::PathBuf;

fn faces(c: &mut Criterion) {
    let options = Options { job: PathBuf::from("jobs/wei2021/wei2021.imp"), ..Options::default() };
    let mut outcome = Outcome::default();
    let program = driver::front(&options, &mut Stages::default(), &mut outcome).unwrap().unwrap();
    let mut group = c.benchmark_group("one face of wei2021");
    group.sampling_mode(SamplingMode::Flat).sample_size(10);
    for (name, strips, bounds, chord) in [("one band", 1, [1.0, 12.0], 0.25), ("two bands", 2, [2.0, 2.0], 0.1)] {
        for side in [Side::Pressure, Side::Suction] {
            let mut program = program.clone();
            let all = std::mem::replace(&mut program.operations, PrimaryMap::new());
            let mut operations = PrimaryMap::new();
            for (_, operation) in all.iter() {
                if let OperationKind::Flank { .. } = operation.kind {
                    let flank = Flank {
                        method: FlankMethod::Minimax,
                        strips: Some(strips),
                        side: ErrorSide::Both,
                        conflict: Conflict::Balance,
                    };
                    let mut operation = operation.clone();
                    operation.kind = OperationKind::Flank { faces: vec![side], flank };
                    operation.sectors = vec![0];
                    operations.push(operation);
                }
            }
            program.operations = operations;
            program.tolerances.chord = Mm(chord * 1e-3);
            program.contracts = vec![
                Contract::whole(ContractKind::Gouge, bounds[0] * 1e-3),
                Contract::whole(ContractKind::Excess, bounds[1] * 1e-3),
            ];
            group.bench_function(BenchmarkId::new(side.name(), name), |b| {
                b.iter(|| black_box(pipeline::run(&program, &mut outcome.sink).is_ok()));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, faces);
criterion_main!(benches);
