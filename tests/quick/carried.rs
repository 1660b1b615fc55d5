//! Table and fixture: distances of the whole tool in closed form.

use crate::support;
use crate::support::pinned;
use impellerc::base::progress::Progress;
use impellerc::diagnostics::Sink;
use impellerc::five_axis::{Carried, CarriedKind};
use impellerc::ir::{Motion, MoveKind, Program};
use impellerc::verify::obstacles::{ObstacleReport, check, report};
use nalgebra::Point3;
use std::borrow::Cow;
use std::f64::consts::FRAC_PI_2;

/// A table of 400 mm with its top at -60 mm, and on it a round fixture of 50 mm up to -40 mm.
fn solids() -> Vec<Carried> {
    let solid = |kind, r: f64, top: f64, bottom: f64| Carried {
        kind,
        profile: vec![[0.0, top], [r, top], [r, bottom], [0.0, bottom]],
    };
    vec![solid(CarriedKind::Table, 200.0, -60.0, -70.0), solid(CarriedKind::Fixture, 25.0, -40.0, -60.0)]
}

/// One move of a ball of 6 mm, from above to a place, with the A axis at an angle.
fn moved(to: [f64; 3], a: f64, kind: MoveKind, turn_axis: f64) -> (Program, Motion) {
    let (program, motion) = pinned::flank().planned();
    let (mut program, mut motion) = (program.clone(), motion.clone());
    program.machine.carried = solids();
    program.machine.chain = support::shifted(&program.machine.chain, [[0.0; 3], [turn_axis, 0.0, 0.0]]);
    let moves = &mut motion.operations[0].moves;
    moves.truncate(2);
    let to = Point3::from(to);
    for (m, up) in moves.iter_mut().zip([80.0, 0.0]) {
        m.joints = program.machine.joints(&(to + nalgebra::Vector3::z() * up), [a, 0.0]);
        m.kind = kind;
    }
    (program, motion)
}

fn found(to: [f64; 3], a: f64, kind: MoveKind, turn_axis: f64) -> [(Cow<'static, str>, f64); 2] {
    let (program, motion) = moved(to, a, kind, turn_axis);
    let found: Vec<ObstacleReport> = check(&program, &motion, &Progress::default());
    [0, 1].map(|k| (found[k].part.clone(), found[k].clearance.as_ref().map_or(f64::INFINITY, |c| c.distance.get())))
}

/// Samples are 0.5 mm apart: below the true distance by no more than that leaves.
fn near(found: f64, exact: f64) -> bool {
    let half = 0.5 * std::f64::consts::FRAC_1_SQRT_2;
    found <= exact + 2e-3 && found >= (exact * exact - half * half).sqrt() - 2e-3
}

#[test]
fn distances_have_their_closed_form() {
    for kind in [MoveKind::Cut, MoveKind::Link, MoveKind::Rapid] {
        // Upright beside the fixture: the tip over the table, the side of the cutter beside the cylinder.
        let [table, fixture] = found([35.0, 0.0, -55.0], 0.0, kind, 0.0);
        assert!(table.0 == "cutter" && near(table.1, 5.0), "{table:?}");
        assert!(fixture.0 == "cutter" && near(fixture.1, 7.0), "{fixture:?}");
    }
    // The C axis 2 mm nearer to the tool.
    let [_, fixture] = found([35.0, 0.0, -55.0], 0.0, MoveKind::Link, 2.0);
    assert!(near(fixture.1, 5.0), "{fixture:?}");
    // Lying over the table: the holder, 20 mm in radius, is nearest.
    let [table, _] = found([0.0, 60.0, -30.0], FRAC_PI_2, MoveKind::Rapid, 0.0);
    assert!(table.0 == "holder" && near(table.1, 10.0), "{table:?}");
    // Farther than is looked for.
    let [table, fixture] = found([0.0, 0.0, 0.0], 0.0, MoveKind::Rapid, 0.0);
    assert!(table.1.is_infinite() && fixture.1.is_infinite());
}

#[test]
fn a_collision_is_an_error_with_its_block() {
    let (program, motion) = moved([60.0, 0.0, -63.0], 0.0, MoveKind::Rapid, 0.0);
    let found = check(&program, &motion, &Progress::default());
    let depth = -found[0].clearance.as_ref().unwrap().distance.get();
    // The middle of the ball is in the plane: its deepest point is 3 mm inside.
    assert!((3.0 - 0.4..3.0 + 0.4).contains(&depth), "{depth}");
    let mut sink = Sink::default();
    report(&program, &motion, &found, &mut sink);
    let [diag] = sink.diags() else { panic!("{:?}", sink.diags()) };
    assert_eq!(diag.code.id(), "IMP0734");
    assert!(
        diag.message.contains("at rapid the cutter") && diag.message.contains("into the table"),
        "{}",
        diag.message
    );
    assert!(diag.place.as_ref().unwrap().block.is_some() && diag.help.is_some());
}
