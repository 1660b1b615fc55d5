//! Links between passes: over the clearance sphere, and direct links where a pass begins beside the end of the last
//! one.

use crate::support;
use impellerc::base::entity::PrimaryMap;
use impellerc::base::units::{Mm, Sec};
use impellerc::diagnostics::Sink;
use impellerc::five_axis::Pose;
use impellerc::ir::{Contract, ContractKind, JointMove, Motion, MotionOperation, MoveKind, OperationKind, Program};
use impellerc::plan::passes::pipeline;
use impellerc::tool_stock::collide::{Cloud, Cutter, ToolSolid};
use impellerc::verify::clearance::{self, ToolPart};
use impellerc::verify::dynamics;
use impellerc::verify::proof::piece;
use impellerc::wheel::method::{AxisMethod, Lines, Spacing};
use impellerc::wheel::part::sample;
use nalgebra::Point3;

/// Channel finishing in one sector of the paper's part.
fn floor(lines: Lines, scallop: f64) -> Program {
    let mut program = support::wei_program(&[0]);
    let tool = program.operations.iter().last().unwrap().1.tool;
    program.operations = PrimaryMap::new();
    let kind = OperationKind::Channel {
        scallop: Mm(scallop),
        spacing: Spacing::EqualDivision,
        lines,
        method: AxisMethod::Corridor,
        allowance_vane: None,
    };
    program.operations.push(support::operation("channel", kind, tool, vec![0], 8.0));
    program
}

fn planned(program: &Program) -> Motion {
    let mut sink = Sink::default();
    pipeline::run(program, &mut sink).unwrap_or_else(|_| panic!("{:?}", sink.diags())).motion
}

/// The moves without that to the station at retract height behind the last pass.
fn on_the_way(operation: &MotionOperation) -> &[JointMove] {
    operation.moves.split_last().unwrap().1
}

/// Passes that are reached without a rapid.
fn joined(motion: &Motion) -> usize {
    let operation = &motion.operations[0];
    let by_rapid: std::collections::BTreeSet<u32> =
        on_the_way(operation).iter().filter(|m| m.kind == MoveKind::Rapid).map(|m| m.pass).collect();
    operation.labels.len() - by_rapid.len()
}

/// First and last radius of the cuts of each pass.
fn directions(program: &Program, motion: &Motion) -> Vec<bool> {
    let moves = &motion.operations[0].moves;
    let radius = |i: usize| program.machine.forward(&moves[i].joints).tip.coords.xy().norm();
    (0..motion.operations[0].labels.len() as u32)
        .map(|pass| {
            let cuts: Vec<usize> =
                (0..moves.len()).filter(|i| moves[*i].pass == pass && moves[*i].kind == MoveKind::Cut).collect();
            radius(cuts[0]) < radius(*cuts.last().unwrap())
        })
        .collect()
}

/// Least distance of a part of the tool to the part over the moves of a kind, mm; `far` where it is more.
fn least(program: &Program, motion: &Motion, kind: MoveKind, of: fn(&ToolSolid, f64, f64) -> f64, far: f64) -> f64 {
    let spacing = 0.3;
    let cloud = Cloud::new(sample::cloud_points(&sample::sample(&program.part, spacing)));
    let pieces: Vec<piece::Piece> =
        piece::pieces(&program.machine, motion, 0).into_iter().filter(|p| p.kind == kind).collect();
    let solid = &program.tools[program.operations.iter().next().unwrap().1.tool].solid;
    clearance::least(&pieces, &ToolPart::new(solid, of), &cloud, spacing * std::f64::consts::FRAC_1_SQRT_2, far)
        .map_or(far, |c| c.found.get())
}

#[test]
fn zigzag_lines_are_joined_by_short_ways_that_stay_clear() {
    let [(there, one_way), (back, zigzag)] = [Lines::OneWay, Lines::Zigzag].map(|lines| {
        let program = floor(lines, 0.02);
        let motion = planned(&program);
        (program, motion)
    });
    let count = zigzag.operations[0].labels.len();
    assert!(count > 15 && one_way.operations[0].labels.len() == count);
    assert!(directions(&there, &one_way).iter().all(|out| *out));
    assert!(directions(&back, &zigzag).iter().enumerate().all(|(i, out)| *out == (i % 2 == 0)));
    // From outlet to inlet there is no short way.
    assert_eq!(joined(&one_way), 0);
    println!("{} of {count} lines are reached by short ways", joined(&zigzag));
    assert!(10 * joined(&zigzag) >= 9 * count);
    // The contact does not move; only directions, and ways between lines.
    let time = |program: &Program, motion: &Motion| dynamics::run(program, motion, 0, &[]).time.map(Sec::get);
    let ([cut, link, rapid], before) = (time(&back, &zigzag), time(&there, &one_way));
    println!("cut, link, rapid: {cut:.1} {link:.1} {rapid:.1} s; one-way {before:?} s");
    assert!((cut / before[0] - 1.0).abs() < 0.02 && 3.0 * (link + rapid) < before[1] + before[2]);
    // Clear of the part: the ball touches it only where a way begins and ends in a line.
    let body: fn(&ToolSolid, f64, f64) -> f64 = ToolSolid::body_distance;
    let cutter: fn(&ToolSolid, f64, f64) -> f64 = ToolSolid::cutter_distance;
    assert!(least(&back, &zigzag, MoveKind::Link, body, 3.0) >= 0.5);
    assert!(least(&back, &zigzag, MoveKind::Link, cutter, 3.0) >= 0.1);
}

#[test]
fn wide_steps_are_joined_only_where_the_rest_is_bounded() {
    // Lines some three millimetres apart: between them the tool would meet what nobody knows.
    let mut program = floor(Lines::Zigzag, 0.4);
    let unknown = planned(&program);
    program.contracts = vec![Contract::whole(ContractKind::Rest, 0.4)];
    let bounded = planned(&program);
    println!("{} and {} of {}", joined(&unknown), joined(&bounded), bounded.operations[0].labels.len());
    assert!(joined(&unknown) < joined(&bounded));
    // Moves of links that are not along the tool axis, each from its start.
    let across = |motion: &Motion| {
        let mut kept = Vec::new();
        let moves = &motion.operations[0].moves;
        let way = |i: usize| {
            let [p, q] = [i - 1, i].map(|k| program.machine.forward(&moves[k].joints).tip);
            (q - p).try_normalize(1e-9)
        };
        for (i, pair) in moves.windows(2).enumerate() {
            let [p, q] = [0, 1].map(|k| program.machine.forward(&pair[k].joints));
            let along = (q.tip - p.tip).cross(&p.axis).norm() < 1e-6;
            // A lead at link feed goes on straight.
            let straight = |beside: usize| way(i + 1).zip(way(beside)).is_some_and(|(a, b)| a.dot(&b) > 1.0 - 1e-6);
            let lead = i > 0 && straight(i) || i + 2 < moves.len() && straight(i + 2);
            if pair[1].kind == MoveKind::Link && !along && !lead {
                kept.extend([JointMove { kind: MoveKind::Rapid, feed: None, ..pair[0] }, pair[1]]);
            }
        }
        assert_eq!(kept.len(), 2 * joined(motion));
        let mut across = motion.clone();
        across.operations[0].moves = kept;
        across
    };
    // A ridge of 0.1 mm stands between places of the ball of 3 mm that are 1.55 mm apart.
    let near = (8.0 * 3.0 * 0.1_f64).sqrt();
    for pair in across(&unknown).operations[0].moves.chunks(2) {
        let [p, q] = [0, 1].map(|k| program.machine.forward(&pair[k].joints).tip);
        assert!((q - p).norm() <= near, "{}", (q - p).norm());
    }
    // The others go over the stock that the contract allows.
    let mut far = across(&bounded);
    let moves = far.operations[0].moves.chunks(2).filter(|pair| {
        let [p, q] = [0, 1].map(|k| program.machine.forward(&pair[k].joints).tip);
        (q - p).norm() > near
    });
    far.operations[0].moves = moves.flatten().copied().collect();
    assert!(!far.operations[0].moves.is_empty());
    let cutter: fn(&ToolSolid, f64, f64) -> f64 = ToolSolid::cutter_distance;
    assert!(least(&program, &far, MoveKind::Link, cutter, 3.0) >= 0.4);
}

#[test]
fn lines_that_begin_where_one_ends_are_linked() {
    let mut program = floor(Lines::Zigzag, 0.012);
    let mut operation = program.operations.iter().next().unwrap().1.clone();
    if let OperationKind::Channel { spacing, .. } = &mut operation.kind {
        *spacing = Spacing::ConstantScallop;
    }
    (operation.lead_in, operation.lead_out) = (Mm(3.0), Mm(3.0));
    program.operations = PrimaryMap::new();
    program.operations.push(operation);
    let motion = planned(&program);
    let operation = &motion.operations[0];
    let tip = |i: usize| program.machine.forward(&operation.moves[i].joints).tip;
    // Where the first and the last cut of each pass begin and end.
    let ends: Vec<[Point3<f64>; 2]> = (0..operation.labels.len() as u32)
        .map(|pass| {
            let cuts = |i: &usize| operation.moves[*i].pass == pass && operation.moves[*i].kind == MoveKind::Cut;
            let all: Vec<usize> = (0..operation.moves.len()).filter(cuts).collect();
            [tip(all[0] - 1), tip(*all.last().unwrap())]
        })
        .collect();
    let (_, moves) = operation.moves.split_last().unwrap();
    let by_rapid: std::collections::BTreeSet<u32> =
        moves.iter().filter(|m| m.kind == MoveKind::Rapid).map(|m| m.pass).collect();
    let same = ends.windows(2).enumerate().filter(|(_, pair)| (pair[1][0] - pair[0][1]).norm() < 0.01);
    let same: Vec<u32> = same.map(|(i, _)| i as u32 + 1).collect();
    println!("{} passes, by rapid {by_rapid:?}, at the same place {same:?}", ends.len());
    assert!(!same.is_empty() && same.iter().all(|pass| !by_rapid.contains(pass)));
}

#[test]
fn rapids_stay_outside_of_the_blank_with_any_holder() {
    // A holder as wide as the blank, low over the tip: the sphere grows with it.
    let mut program = floor(Lines::OneWay, 0.4);
    let used = program.operations.iter().next().unwrap().1.tool;
    let mut tools = PrimaryMap::new();
    for (id, tool) in program.tools.iter() {
        let mut tool = tool.clone();
        if id == used {
            tool.solid.cutter = Cutter::ball(3.0);
            for section in &mut tool.solid.holder {
                (section.radius_from, section.radius_to) = (30.0, 30.0);
                (section.from, section.to) = (section.from + 20.0, section.to + 20.0);
            }
            for section in &mut tool.solid.shank {
                section.to += 20.0;
            }
        }
        tools.push(tool);
    }
    program.tools = tools;
    let motion = planned(&program);
    let solid = &program.tools[used].solid;
    let profile = &program.stock.profile;
    // The blank in slices: no point of it inside of the tool at any place of a rapid.
    let mut least = f64::INFINITY;
    let mut looked = 0;
    for piece in piece::pieces(&program.machine, &motion, 0).iter().filter(|p| p.kind == MoveKind::Rapid) {
        let Pose { tip, axis } = piece.middle();
        looked += 1;
        for [r, z] in profile.iter() {
            for k in 0..36 {
                let (sin, cos) = (f64::from(k) * std::f64::consts::TAU / 36.0).sin_cos();
                let d = Point3::new(r * cos, r * sin, *z) - tip;
                least = least.min(solid.distance(d.cross(axis).norm(), d.dot(axis)));
            }
        }
    }
    println!("{looked} places, {least:.2} mm");
    assert!(looked > 50 && least > 3.0, "{looked} {least}");
}
