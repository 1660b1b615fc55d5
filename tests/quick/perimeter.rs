//! Before, between and behind operations: heights at which axes move from unknown positions, and paths down and up.

use crate::support::pinned;
use impellerc::base::entity::PrimaryMap;
use impellerc::base::progress::Progress;
use impellerc::base::units::Mm;
use impellerc::diagnostics::{Sink, codes::verification};
use impellerc::five_axis::{Carried, CarriedKind};
use impellerc::ir::{MoveKind, Program};
use impellerc::plan::facts;
use impellerc::verify::{certify, machine, perimeter};

/// Every operation begins over its first target and ends over its last one, at the retract height less the tool.
#[test]
fn stations_stand_straight_over_the_first_and_the_last_target() {
    let (program, motion) = pinned::flank().planned();
    for operation in &motion.operations {
        let tool = &program.tools[program.operations[operation.operation].tool];
        let [first, second, .., before, last] = operation.moves.as_slice() else { panic!("too few moves") };
        for (station, target) in [(first, second), (last, before)] {
            assert_eq!(station.kind, MoveKind::Rapid);
            assert!((station.joints.xyz.z + tool.length() - program.machine.retract).abs() < 1e-9);
            let (s, t) = (&station.joints, &target.joints);
            assert!((s.xyz.xy() - t.xyz.xy()).norm() < 1e-9 && s.rotary == t.rotary && s.xyz.z > t.xyz.z);
        }
    }
    let found = perimeter::check(program, motion);
    assert!(found.clearance > found.required, "{found:?}");
}

/// With the retract just below what a fixture reaches, facts and verifier refuse; just above, both accept.
#[test]
fn a_tool_that_does_not_stand_over_a_fixture_is_refused() {
    let (program, motion) = pinned::flank().planned();
    let mut program = program.clone();
    // The part origin lies 80 mm over the A axis, the lower rim of a disc of 300 mm therefore 70 mm below it. A turns by 100 deg.
    program.machine.carried = vec![Carried {
        kind: CarriedKind::Fixture,
        profile: vec![[0.0, -140.0], [150.0, -140.0], [150.0, -150.0], [0.0, -150.0]],
    }];
    let (sin, cos) = 100f64.to_radians().sin_cos();
    let reached = 150.0 * sin - 70.0 * cos;
    let length = program.operations.iter().map(|(_, o)| program.tools[o.tool].length()).fold(0.0, f64::max);
    let shifted = |z: f64| {
        let mut motion = motion.clone();
        for operation in &mut motion.operations {
            for m in [0, operation.moves.len() - 1] {
                operation.moves[m].joints.xyz.z = z - length;
            }
        }
        motion
    };
    for (gap, fits) in [(0.49, false), (0.51, true)] {
        program.machine.retract = reached + length + gap;
        let has = |sink: &Sink| sink.diags().iter().any(|d| d.code == verification::RETRACT_TOO_LOW);
        let mut facts = Sink::default();
        facts::check(&program, &Progress::default(), &mut facts);
        assert_eq!(has(&facts), !fits, "facts at {gap}");
        let found = perimeter::check(&program, &shifted(program.machine.retract));
        assert!((found.clearance.get() - gap).abs() < 1e-6, "{found:?}");
        let mut sink = Sink::default();
        let _ = certify(&program, &shifted(program.machine.retract), &mut sink);
        assert_eq!(has(&sink), !fits, "verifier at {gap}");
    }
}

/// An operation that is one rapid through the part is no lone move: the way to it and away from it count.
#[test]
fn a_lone_rapid_through_the_part_is_found() {
    let (program, motion) = pinned::flank().planned();
    let mut motion = motion.clone();
    let moves = &mut motion.operations[0].moves;
    let (first, last) = (moves[0], moves[moves.len() - 1]);
    let mut through = first;
    // Down along Z into the hub beside the bore.
    let hub = nalgebra::Point3::new(12.0, 0.0, -30.0);
    through.joints = program.machine.joints(&hub, [0.0; 2]);
    let over = |m: impellerc::ir::JointMove| {
        let mut station = m;
        station.joints.xyz.z = first.joints.xyz.z;
        station
    };
    *moves = vec![over(through), through, over(through)];
    let _ = last;
    let mut sink = Sink::default();
    let _ = certify(program, &motion, &mut sink);
    let codes: Vec<&str> = sink.diags().iter().map(|d| d.code.id()).collect();
    assert!(codes.contains(&verification::RAPID_THROUGH_STOCK.id()), "{codes:?}");
    assert!(codes.contains(&verification::RAPID_IN_STOCK.id()), "{codes:?}");
}

/// Travel of Z is that of the gauge line: a longer tool needs more of it.
#[test]
fn travel_counts_the_length_of_the_tool() {
    let (program, motion) = pinned::flank().planned();
    let used = |program: &Program| machine::check(program, motion, None).axes.linear[2].used.map(Mm::get);
    let length = program.tools.iter().next().unwrap().1.length();
    let before = used(program);
    let mut program = program.clone();
    let mut longer = PrimaryMap::new();
    for (_, tool) in program.tools.iter() {
        let mut tool = tool.clone();
        tool.solid.holder.last_mut().unwrap().to += 25.0;
        longer.push(tool);
    }
    program.tools = longer;
    let after = used(&program);
    assert!(length > 0.0 && (after[0] - before[0] - 25.0).abs() < 1e-9 && (after[1] - before[1] - 25.0).abs() < 1e-9);
}
