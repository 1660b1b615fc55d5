//! The validators of the stage values: a real plan passes all of them, and every single defect in it is found.

use crate::support::jobs;
use impellerc::base::entity::PrimaryMap;
use impellerc::base::units::Rpm;
use impellerc::diagnostics::Sink;
use impellerc::ir::validate::{self, ClStage, Malformed};
use impellerc::ir::{CcPlan, ClPlan, Drive, Motion, Operation, OperationKind, Program};
use impellerc::plan::passes::pipeline;
use impellerc::wheel::part::{BladeId, SurfaceKind, TurnedProfile};

type Broken<T> = Vec<(&'static str, fn(&mut T))>;

fn each<T: Clone>(value: &T, broken: &Broken<T>, validate: impl Fn(&T) -> Result<(), Malformed>) {
    assert_eq!(validate(value), Ok(()));
    for (what, change) in broken {
        let mut wrong = value.clone();
        change(&mut wrong);
        let found = validate(&wrong);
        assert!(found.is_err(), "{what} is not found");
        println!("{what}: {}", found.unwrap_err());
    }
}

#[test]
fn programs() {
    let broken: Broken<Program> = vec![
        ("a sector that is not there", |p| operation(p, 0, |o| o.sectors = vec![8])),
        ("sectors twice", |p| operation(p, 0, |o| o.sectors = vec![1, 1])),
        ("no speed", |p| operation(p, 1, |o| o.speed = Rpm(0.0))),
        ("a feed that is no number", |p| operation(p, 1, |o| o.feed = impellerc::base::units::MmPerMin(f64::NAN))),
        ("no face", |p| {
            operation(p, 1, |o| {
                if let OperationKind::Flank { faces, .. } = &mut o.kind {
                    faces.clear();
                }
            });
        }),
        ("a stock without an outside", |p| p.stock.profile = TurnedProfile::new(Vec::new())),
    ];
    each(&jobs::planned("small", "siemens-840d").program, &broken, validate::program);
}

/// Changes one operation of a program.
fn operation(program: &mut Program, index: usize, change: fn(&mut Operation)) {
    let mut operations = PrimaryMap::new();
    for (i, (_, operation)) in program.operations.iter().enumerate() {
        let mut operation = operation.clone();
        if i == index {
            change(&mut operation);
        }
        operations.push(operation);
    }
    program.operations = operations;
}

#[test]
fn contact_plans() {
    let small = jobs::planned("small", "siemens-840d");
    let broken: Broken<CcPlan> = vec![
        ("a missing operation", |cc| cc.operations.truncate(2)),
        ("operations out of order", |cc| cc.operations.swap(0, 1)),
        ("a place nowhere", |cc| cc.operations[0].passes[0].points[2].u = f64::NAN),
        ("a pass of one point", |cc| cc.operations[0].passes[0].points.truncate(1)),
        ("a surface that the operation does not make", |cc| {
            cc.operations[1].passes[0].drive = Drive::Contact(SurfaceKind::Fillet(BladeId::MAIN.faces()[0]));
        }),
        ("a normal that is too long", |cc| cc.operations[2].passes[1].points[3].normal *= 1.001),
    ];
    each(&small.plan.cc, &broken, |cc| validate::cc(&small.program, cc));
}

#[test]
fn location_plans() {
    let small = jobs::planned("small", "siemens-840d");
    let broken: Broken<ClPlan> = vec![
        ("another sector", |cl| cl.operations[0].passes[0].sector = 5),
        ("an axis that is too short", |cl| cl.operations[0].passes[0].points[5].axis *= 0.5),
        ("a tip nowhere", |cl| cl.operations[2].passes[1].points[0].tip.x = f64::INFINITY),
        ("a contact nowhere", |cl| {
            let points = &mut cl.operations[2].passes[1].points;
            points.iter_mut().find_map(|p| p.contact.as_mut()).unwrap().y = f64::NAN;
        }),
        ("a missing operation", |cl| cl.operations.truncate(2)),
    ];
    each(&small.plan.cl, &broken, |cl| validate::cl(&small.program, cl, ClStage::InSectors));
    // A pass of another sector is none of the one that is planned.
    let mut another = small.plan.cl.clone();
    another.operations[0].passes.retain(|pass| pass.sector == 0);
    assert_eq!(validate::cl(&small.program, &another, ClStage::Oriented), Ok(()));
    another.operations[0].passes[0].sector = 3;
    assert!(validate::cl(&small.program, &another, ClStage::Oriented).is_err());
}

#[test]
fn motions() {
    let small = jobs::planned("small", "siemens-840d");
    let broken: Broken<Motion> = vec![
        ("a time before the start", |m| m.operations[0].moves[4].time = -1.0),
        ("a joint that is no number", |m| m.operations[0].moves[4].joints.rotary[1] = f64::NAN),
        ("no way down from retract height", |m| m.operations[1].moves = m.operations[1].moves.split_off(1)),
        ("no way up to retract height", |m| m.operations[1].moves.truncate(9)),
        ("passes out of order", |m| {
            let last = m.operations[2].labels.len() as u32 - 1;
            m.operations[2].moves[5].pass = last;
        }),
        ("a label that is not there", |m| m.operations[2].labels.clear()),
        ("a rapid with a feed", |m| {
            let kind = impellerc::ir::MoveKind::Rapid;
            m.operations[0].moves.iter_mut().find(|m| m.kind == kind).unwrap().feed = Some(100.0);
        }),
        ("a cut without a feed", |m| {
            let kind = impellerc::ir::MoveKind::Cut;
            m.operations[0].moves.iter_mut().find(|m| m.kind == kind).unwrap().feed = None;
        }),
        ("a feed of zero", |m| {
            m.operations[2].moves.iter_mut().find(|m| m.feed.is_some()).unwrap().feed = Some(0.0);
        }),
    ];
    each(&small.plan.motion, &broken, |m| validate::motion(&small.program, m));
}

/// Passes of an operation in two sectors are those of the first, turned, sector by sector.
#[test]
fn passes_are_copied_to_the_sectors_of_their_operation() {
    let mut program = jobs::planned("small", "siemens-840d").program.clone();
    operation(&mut program, 0, |o| o.sectors = vec![0]);
    let one = pipeline::run(&program, &mut Sink::default()).unwrap().cl;
    for index in 0..program.operations.len() {
        operation(&mut program, index, |o| o.sectors = vec![0, 3]);
    }
    let two = pipeline::run(&program, &mut Sink::default()).unwrap();
    assert_eq!(validate::cl(&program, &two.cl, ClStage::InSectors), Ok(()));
    let turn = program.part.sector_rotation(3);
    for (alone, both) in one.operations.iter().zip(&two.cl.operations) {
        let count = alone.passes.len();
        assert_eq!(both.passes.len(), 2 * count);
        for (k, pass) in alone.passes.iter().enumerate() {
            let (first, second) = (&both.passes[k], &both.passes[count + k]);
            assert_eq!((first.sector, second.sector), (0, 3));
            assert_eq!(first.label, pass.label);
            assert_eq!(second.label, pass.label.replace("sector 1 ", "sector 4 "));
            assert_eq!(first.points, pass.points);
            for (p, q) in pass.points.iter().zip(&second.points) {
                assert!((turn * p.tip - q.tip).norm() < 1e-12 && (turn * p.axis - q.axis).norm() < 1e-12);
            }
        }
    }
}
