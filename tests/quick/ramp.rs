//! `ramp` of a tool: what the language means by it, ramps of the planner, and what the verifier finds in motions made by hand.

use crate::plunge::{block, findings, judged, of_one_operation, planned};
use impellerc::base::entity::PrimaryMap;
use impellerc::base::source::SourceMap;
use impellerc::base::units::Rad;
use impellerc::diagnostics::{Severity, Sink, codes};
use impellerc::ir::{JointMove, Motion, MoveKind, Program, Tool};
use impellerc::job::{self, InMemory};
use impellerc::syntax;
use nalgebra::{Point3, Vector3};

const JOB: &str = include_str!("../../jobs/small/rough.imp");

/// The angle of the first tool, degrees, and the job as it is printed, with the tool replaced; or the codes of its faults.
fn read(tool: &str) -> Result<(f64, String), Vec<&'static str>> {
    const FIRST: &str = "flat { diameter 2 mm";
    assert!(JOB.contains(FIRST));
    let mut files = InMemory::default();
    files.curves.insert("vane_curves.csv".to_owned(), include_str!("../../jobs/small/vane_curves.csv").to_owned());
    let (mut sources, mut sink) = (SourceMap::default(), Sink::default());
    let text = JOB.replacen(FIRST, tool, 1);
    let source = sources.add("ramp.imp", &text);
    let ast = syntax::parse(&text, source, &mut sink);
    let partial = job::understand(&ast, &mut files, &mut sources, &mut sink);
    let found = partial.job().map(|job| (job.tools[0].largest_ramp().deg(), job::print::print(&job)));
    found.ok_or_else(|| sink.diags().iter().map(|d| d.code.id()).collect())
}

#[test]
fn the_angle_follows_from_the_end_of_the_tool() {
    // A hollow half as deep as the radius of the flat part, over the width of the middle.
    let by = |hollow: f64, middle: f64| (hollow / middle).atan().to_degrees();
    for (tool, angle) in [
        ("flat { diameter 2 mm", by(0.5, 1.0)),
        ("flat { diameter 2 mm  plunge-width 0.3 mm", by(0.5, 1.4)),
        ("flat { diameter 2 mm  plunge-width 0.8 mm", by(0.5, 0.4)),
        ("flat { diameter 2 mm  plunge-width 1 mm", 90.0),
        ("bull { diameter 2 mm  corner 0.5 mm", by(0.25, 0.5)),
        ("bull { diameter 2 mm  corner 0.5 mm  plunge-width 0.6 mm", by(0.25, 0.8)),
        ("ball { diameter 2 mm", 90.0),
        ("ball { diameter 2 mm  plunge-width 0.9 mm", by(0.05, 0.2)),
        ("tapered-ball { angle 3 deg  diameter 2 mm", 90.0),
        ("flat { diameter 2 mm  ramp 3 deg", 3.0),
        ("ball { diameter 2 mm  ramp 12.5 deg", 12.5),
    ] {
        let (found, printed) = read(tool).unwrap();
        assert!((found - angle).abs() < 1e-9, "{tool}: {found} {angle}");
        // What is printed reads back.
        // A default is a comment.
        let line =
            printed.lines().map(|l| l.trim().trim_start_matches("// ")).find(|l| l.starts_with("ramp ")).unwrap();
        let line = line.trim_end_matches(", the default");
        let plain = tool.split("  ramp").next().unwrap();
        let (again, printed) = read(&format!("{plain}  {line}")).unwrap();
        assert!((again - angle).abs() < 1e-6 && printed.contains(line), "{tool}: {line} {again}");
    }
}

#[test]
fn faults_of_the_angle_are_named() {
    for (angle, code) in [
        ("0 deg", codes::job::OUT_OF_RANGE),
        ("-3 deg", codes::job::OUT_OF_RANGE),
        ("90.1 deg", codes::job::OUT_OF_RANGE),
        ("3", codes::job::NO_UNIT),
        ("3 mm", codes::job::WRONG_DIMENSION),
    ] {
        let found = read(&format!("flat {{ diameter 2 mm  ramp {angle}")).map(|f| f.0);
        assert!(found.as_ref().is_err_and(|f| f.contains(&code.id())), "{angle}: {found:?}");
    }
}

/// A flat tool of 4 mm with an end whose teeth cut 1.4 mm from the rim, in a block.
fn ramping(angle: f64) -> Program {
    let program = block(2.0, 1.4);
    let mut tools = PrimaryMap::new();
    for (_, tool) in program.tools.iter() {
        tools.push(Tool { ramp: Rad::from_deg(angle), ..tool.clone() });
    }
    Program { tools, ..program }
}

/// Cuts along a line from beside the block into it that goes down by an angle, in a number of moves, once and again, under
/// a tilted axis.
fn line(program: &Program, tilt: f64, angle: f64, count: usize, times: usize) -> Motion {
    let rotary = [tilt, 0.0];
    let axis = program.machine.chain.tool_axis(rotary);
    let across = axis.cross(&Vector3::x()).normalize();
    let end = Point3::new(0.0, 0.0, -2.0) + across * 3.0;
    let (sin, cos) = angle.to_radians().sin_cos();
    let at = |t: f64, up: f64| {
        let tip = end - (across * cos - axis * sin) * (13.0 * (1.0 - t)) + axis * up;
        program.machine.joints(&tip, rotary)
    };
    let to = |kind, joints| JointMove { kind, joints, feed: Some(1.0), time: 1.0, pass: 0, stop: false };
    let mut moves = Vec::new();
    for _ in 0..times {
        moves.extend([to(MoveKind::Rapid, at(0.0, 15.0)), to(MoveKind::Link, at(0.0, 0.0))]);
        moves.extend((1..=count).map(|k| to(MoveKind::Cut, at(k as f64 / count as f64, 0.0))));
        moves.push(to(MoveKind::Rapid, at(1.0, 15.0)));
    }
    of_one_operation(program, moves)
}

#[test]
fn the_verifier_measures_how_steeply_a_tool_goes_down() {
    for tilt in [0.0, 0.4] {
        for (angle, count) in [(2.0, 1), (10.0, 1), (10.0, 25), (26.0, 4), (40.0, 7)] {
            for (limit, fails) in [(0.9 * angle, true), (1.1 * angle, false)] {
                let program = ramping(limit);
                let (found, codes) = judged(&program, &line(&program, tilt, angle, count, 1), 0.2);
                let ramp = found.ramp.expect("a ramp").value.get();
                println!("{angle} deg in {count} moves, tilted by {tilt}: {ramp:.4} deg");
                assert!((ramp - angle).abs() < 1e-3, "{tilt} {angle} {count}: {ramp}");
                let load = codes.contains(&codes::verification::TOOL_LOAD.id());
                assert_eq!(load, fails, "{tilt} {angle} {limit}: {codes:?}");
            }
        }
    }
}

#[test]
fn the_default_is_a_remark() {
    for (stated, severity) in [(true, Severity::Error), (false, Severity::Remark)] {
        let mut program = ramping(5.0);
        let tools = program.tools.iter().map(|(_, tool)| Tool { ramp_stated: stated, ..tool.clone() });
        let tools: Vec<Tool> = tools.collect();
        program.tools = PrimaryMap::new();
        for tool in tools {
            program.tools.push(tool);
        }
        let (_, found) = findings(&program, &line(&program, 0.0, 10.0, 5, 1), 0.2);
        let load: Vec<Severity> =
            found.iter().filter(|f| f.1 == codes::verification::TOOL_LOAD.id()).map(|f| f.0).collect();
        assert_eq!(load, [severity]);
    }
}

#[test]
fn only_ways_down_with_material_under_the_middle_are_ramps() {
    let program = ramping(1.0);
    for angle in [0.0, -10.0] {
        let (found, _) = judged(&program, &line(&program, 0.0, angle, 5, 1), 0.2);
        assert!(found.ramp.is_none(), "{angle}: {:?}", found.ramp);
    }
    // The second time the material is gone.
    let (once, twice) = (line(&program, 0.2, 10.0, 5, 1), line(&program, 0.2, 10.0, 5, 2));
    let [once, twice] = [once, twice].map(|motion| judged(&program, &motion, 0.2).0.ramp.expect("a ramp"));
    assert_eq!((once.value, once.at), (twice.value, twice.at));
    // A short way down counts over the width of the middle, 1.2 mm.
    let rotary = [0.0; 2];
    let at = |x: f64, z: f64| program.machine.joints(&Point3::new(x, 0.0, z), rotary);
    let to = |kind, joints| JointMove { kind, joints, feed: Some(1.0), time: 1.0, pass: 0, stop: false };
    let places = [(-9.0, -1.0), (0.0, -1.0), (0.3, -1.3), (2.0, -1.3)];
    let cuts = places.map(|(x, z)| to(MoveKind::Cut, at(x, z)));
    let moves = [to(MoveKind::Rapid, at(-9.0, 9.0))].into_iter().chain(cuts).collect();
    let (found, _) = judged(&program, &of_one_operation(&program, moves), 0.1);
    let short = (0.3_f64 / 1.2).atan().to_degrees();
    assert!((found.ramp.expect("a ramp").value.get() - short).abs() < 1e-6, "{:?} {short}", found.ramp);
}

/// A flat tool goes down in the middle of the block, from its top, in parts: a way down with the first part of each, and level
/// with the second.
fn stairs(program: &Program, [down, level]: [[f64; 2]; 2], count: usize, peck: f64) -> Motion {
    let to = |kind, [x, z]: [f64; 2]| JointMove {
        kind,
        joints: program.machine.joints(&Point3::new(x, 0.0, z), [0.0; 2]),
        feed: Some(1.0),
        time: 1.0,
        pass: 0,
        stop: false,
    };
    let mut at = [-1.0, 0.001];
    let mut moves = vec![to(MoveKind::Rapid, [at[0], 9.0]), to(MoveKind::Link, at)];
    for _ in 0..count {
        for way in [down, level] {
            at = [at[0] + way[0], at[1] - way[1]];
            moves.push(to(MoveKind::Cut, at));
        }
        if peck > 0.0 {
            moves.extend([peck, 0.0].map(|up| to(MoveKind::Rapid, [at[0], at[1] + up])));
        }
    }
    moves.push(to(MoveKind::Rapid, [at[0], 9.0]));
    of_one_operation(program, moves)
}

/// A stroke, or a steep way down, is one however its blocks divide it: here by 0.04 mm, less than a layer that counts alone.
#[test]
fn short_blocks_down_are_judged_together() {
    let load = codes::verification::TOOL_LOAD.id();
    let program = ramping(20.0);
    let said = |down, level, count, peck| {
        let (found, codes) = judged(&program, &stairs(&program, [down, level], count, peck), 0.1);
        println!("{down:?} {level:?} {peck}: {:?} {:?}", found.middle.map(|m| m.value), found.ramp.map(|r| r.value));
        (found, codes.contains(&load))
    };
    // Strokes in one, in parts, in parts with level blocks or ways up and down between them.
    for (down, level, count, peck) in
        [(1.0, 0.0, 1, 0.0), (0.04, 0.0, 25, 0.0), (0.04, 0.02, 25, 0.0), (0.04, 0.0, 25, 0.5), (0.02, 0.0, 50, 0.0)]
    {
        let (found, refused) = said([0.0, down], [level, 0.0], count, peck);
        assert!(refused && found.middle.is_some_and(|m| m.value.get() > 0.5), "{down} {level} {peck}");
    }
    // A way down at 60 deg between level blocks that are too short to matter.
    let (found, refused) = said([0.02, 0.02 * 3f64.sqrt()], [0.004, 0.0], 60, 0.0);
    let angle = (0.02 * 3f64.sqrt() / 0.024).atan().to_degrees();
    let ramp = found.ramp.expect("a ramp").value.get();
    assert!(refused && (ramp - angle).abs() < 2.0, "{ramp} {angle}");
    // Gentle stairs, and one layer that a ridge can be.
    assert!(!said([0.0, 0.01], [0.05, 0.0], 40, 0.0).1);
    assert!(!said([0.0, 0.02], [0.0, 0.02], 2, 0.0).1);
}

/// Angles at which the tool goes down in the first cut of each pass of the second operation, degrees.
fn entries(program: &Program, motion: &Motion) -> Vec<f64> {
    let moves = &motion.operations[1].moves;
    let first = moves.windows(2).filter(|w| w[1].kind == MoveKind::Cut && w[0].kind != MoveKind::Cut);
    let angle = |w: &[JointMove]| {
        let [from, to] = [0, 1].map(|k: usize| program.machine.forward(&w[k].joints));
        let way = to.tip - from.tip;
        let down = -way.dot(&from.axis);
        down.atan2((way + from.axis * down).norm()).to_degrees()
    };
    first.map(angle).collect()
}

/// The ramps of a ball onto what a flat tool has left keep the angle of the ball.
#[test]
fn ramps_of_the_planner_keep_the_angle() {
    let plan = |ramp: &str| {
        let (program, motion) = planned(
            JOB,
            &[
                ("tools t1, t2 ", "tools t1, t2  sectors 1 "),
                ("ball { diameter 2 mm", &format!("ball {{ diameter 2 mm {ramp}")),
                ("require rest      <= 0.8 mm", ""),
            ],
        );
        let mut found = entries(&program, &motion);
        found.sort_by(f64::total_cmp);
        println!("{ramp}: {found:.2?}");
        found
    };
    // Lines of the levels themselves go down by up to 23 deg where they begin.
    let steep = |angles: &[f64]| angles.iter().filter(|a| **a > 24.0).count();
    assert!(steep(&plan("")) > 3);
    let limited = plan("ramp 24 deg");
    assert!(steep(&limited) == 0 && limited.len() > 10, "{limited:?}");
}
