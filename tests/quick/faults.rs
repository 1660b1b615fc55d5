//! Faults in a verified motion are found with their size and place. The expected values are computed here without the
//! verifier: in closed form, or by brute force over finely sampled poses.

use crate::support;
use crate::support::{jobs, pinned};
use impellerc::diagnostics::Sink;
use impellerc::ir::{Motion, MoveKind, OperationKind, Program};
use impellerc::plan::passes::pipeline;
use impellerc::verify::Certificate;
use impellerc::wheel::method::{Flank, FlankMethod};
use impellerc::wheel::part::{FaceId, Surface};
use nalgebra::{Point3, Vector3};
use std::sync::LazyLock;

/// A micrometre, in mm.
const UM: f64 = 1e-3;

fn planned(program: &Program) -> Motion {
    pipeline::run(program, &mut Sink::default()).expect("a plan").motion
}

fn measured(program: &Program, motion: &Motion) -> Certificate {
    jobs::certified(program, motion)
}

fn surface<'a>(certificate: &'a Certificate, name: &str) -> &'a impellerc::verify::surface::SurfaceReport {
    certificate.surfaces.iter().find(|s| s.surface == name).expect("a surface")
}

/// Moves the tip of one move without turning the tool.
fn shift(program: &Program, motion: &mut Motion, operation: usize, index: usize, by: Vector3<f64>) {
    let joints = &mut motion.operations[operation].moves[index].joints;
    let tip = program.machine.forward(joints).tip + by;
    *joints = program.machine.joints(&tip, joints.rotary);
}

/// Distance of a point to the cutter of the only tool over every move, by brute force: 4000 poses a move, the moves
/// that a coarse look finds near.
fn brute(program: &Program, motion: &Motion, p: &Point3<f64>) -> f64 {
    let mut least = f64::INFINITY;
    for operation in &motion.operations {
        let solid = &program.tools[program.operations[operation.operation].tool].solid;
        for pair in operation.moves.windows(2) {
            let tips = [0, 1].map(|k| program.machine.forward(&pair[k].joints).tip);
            let at = |t: f64| {
                let (a, b) = (&pair[0].joints, &pair[1].joints);
                let axis = program.machine.chain.tool_axis(impellerc::five_axis::between(a.rotary, b.rotary, t));
                let d = p - (tips[0] + (tips[1] - tips[0]) * t);
                let s = d.dot(&axis);
                solid.cutter_distance((d - axis * s).norm(), s)
            };
            let coarse = (0..=50).map(|k| at(f64::from(k) / 50.0)).fold(f64::INFINITY, f64::min);
            let reach = (tips[1] - tips[0]).norm() / 50.0 + 1.0;
            if coarse < least + reach {
                least = (0..=4000).map(|k| at(f64::from(k) / 4000.0)).fold(least, f64::min);
            }
        }
    }
    least
}

/// Finishing of one channel with few lines, planned once.
static CHANNEL: LazyLock<(Program, Motion)> = LazyLock::new(|| {
    let program = support::channel_only(0.2);
    let motion = planned(&program);
    (program, motion)
});

#[test]
fn a_plunge_ten_millimetres_too_deep_is_found() {
    let (program, mut motion) = CHANNEL.clone();
    let moves = &motion.operations[0].moves;
    // A move in the middle of a line in the middle of the channel.
    let passes = motion.operations[0].labels.len();
    let pass: Vec<usize> =
        (0..moves.len()).filter(|i| moves[*i].kind == MoveKind::Cut && moves[*i].pass as usize == passes / 2).collect();
    let index = pass[pass.len() / 2];
    let pose = program.machine.forward(&moves[index].joints);
    // Straight into the hub, against the normal at the contact.
    let radius = 3.0;
    let centre = pose.tip + pose.axis * radius;
    let (u, distance) = {
        let at = nalgebra::Vector2::new(centre.x.hypot(centre.y), centre.z);
        program.part.hub.closest(at)
    };
    assert!((distance - radius).abs() < 2.0 * UM, "the ball stands on the hub");
    let normal = program.part.hub.normal(u, centre.y.atan2(centre.x));
    shift(&program, &mut motion, 0, index, normal * -10.0);
    let hub = measured(&program, &motion);
    let found = &surface(&hub, "hub of channel 1").gouge;
    // Straight below the contact the ball ends ten millimetres farther in; no other way in is longer.
    let contact = centre - normal * distance;
    let expected = 10.0 - (distance - radius);
    assert!((found.depth.get() - expected).abs() < UM, "{found:?}, expected {expected}");
    assert!((Point3::from(found.point) - contact).norm() < 0.05, "{found:?} {contact}");
    let at = found.at.unwrap();
    assert!((at.index as usize).abs_diff(index) <= 1, "{at:?} {index}");
}

#[test]
fn a_plunge_of_one_millimetre_has_the_right_size() {
    let (program, mut motion) = CHANNEL.clone();
    let before = measured(&program, &motion);
    assert!(surface(&before, "hub of channel 1").gouge.depth.get() < 7.0 * UM);
    let moves = &motion.operations[0].moves;
    let passes = motion.operations[0].labels.len();
    let pass: Vec<usize> =
        (0..moves.len()).filter(|i| moves[*i].kind == MoveKind::Cut && moves[*i].pass as usize == passes / 2).collect();
    let index = pass[pass.len() / 2];
    let pose = program.machine.forward(&moves[index].joints);
    let centre = pose.tip + pose.axis * 3.0;
    let (u, gap) = program.part.hub.closest(nalgebra::Vector2::new(centre.x.hypot(centre.y), centre.z));
    let normal = program.part.hub.normal(u, centre.y.atan2(centre.x));
    shift(&program, &mut motion, 0, index, normal * -1.0);
    let after = measured(&program, &motion);
    let found = &surface(&after, "hub of channel 1").gouge;
    // The contact lies on the normal through the centre, now one millimetre nearer to it.
    let expected = 1.0 - (gap - 3.0);
    assert!((found.depth.get() - expected).abs() < UM, "{found:?}, expected {expected}");
    assert!((Point3::from(found.point) - (centre - normal * gap)).norm() < 0.05, "{found:?}");
    assert!((found.at.unwrap().index as usize).abs_diff(index) <= 1);
}

#[test]
fn a_shifted_vane_is_found() {
    let (program, motion) = pinned::flank().planned();
    let mut shifted = motion.clone();
    let by = Vector3::new(0.05, 0.02, 0.0);
    for index in 0..shifted.operations[0].moves.len() {
        shift(program, &mut shifted, 0, index, by);
    }
    let certificate = measured(program, &shifted);
    for name in ["vane 1 pressure face", "vane 1 suction face"] {
        let report = surface(&certificate, name);
        for worst in [&report.gouge, &report.excess] {
            // Seen from the shifted tools the design is shifted the other way.
            let expected = brute(program, motion, &(Point3::from(worst.point) - by));
            assert!((worst.value.get() - expected).abs() < UM, "{name}: {worst:?}, expected {expected}");
        }
    }
    // The face that the shift moves into is cut by nearly all of it.
    let deepest = ["vane 1 pressure face", "vane 1 suction face"].map(|n| surface(&certificate, n).gouge.depth.get());
    assert!(deepest.iter().any(|d| *d > 0.04 && *d < by.norm() + 0.13), "{deepest:?}");
}

#[test]
fn a_dropped_strip_is_found() {
    let mut program = support::flank_only(&[0]);
    for (id, _) in program.operations.clone().iter() {
        let mut operation = program.operations[id].clone();
        operation.kind =
            OperationKind::Flank { faces: vec![FaceId::PRESSURE], flank: Flank::by_ruling(FlankMethod::TwoPoint, 4) };
        program.operations = impellerc::base::entity::PrimaryMap::new();
        program.operations.push(operation);
    }
    let motion = planned(&program);
    let whole = measured(&program, &motion);
    assert!(surface(&whole, "vane 1 pressure face").excess.value.get() < 3.0 * UM);
    let mut dropped = motion.clone();
    let strip = dropped.operations[0].labels.iter().position(|l| l.ends_with("strip 2")).unwrap();
    dropped.operations[0].moves.retain(|m| m.pass as usize != strip);
    let certificate = measured(&program, &dropped);
    let found = &surface(&certificate, "vane 1 pressure face").excess;
    let expected = brute(&program, &dropped, &Point3::from(found.point));
    assert!((found.value.get() - expected).abs() < UM, "{found:?}, expected {expected}");
    // Far more than the contract of the shipped job, where the whole motion leaves less than 3 um.
    assert!(found.value.get() > 12.0 * UM, "{found:?}");
    // Inside the band of the strip, or at its border: between a quarter and a half of the ruling over the fillet.
    let foot = program
        .part
        .face(FaceId::PRESSURE)
        .surface
        .closest(&Point3::from(found.point), impellerc::nurbs::proximity::Patch { u: [0.0, 1.0], v: [0.0, 1.0] });
    let low = program.part.fillet_tangent(FaceId::PRESSURE, foot.u, 3.0).unwrap();
    let share = (foot.v - low) / (1.0 - low);
    assert!(share > 0.2 && share < 0.55, "{share}");
}
