//! What milling must not touch: kept surfaces against exact shapes, the clamping in closed form, roughing with the
//! deviations of the control, and damage outside of the design surfaces in a verified program.

use crate::support;
use crate::support::pinned;
use impellerc::base::entity::PrimaryMap;
use impellerc::base::progress::Progress;
use impellerc::base::source::Span;
use impellerc::base::units::{Mm, Mm3PerMin};
use impellerc::diagnostics::{Severity, Sink};
use impellerc::five_axis::Chain;
use impellerc::ir::{
    Allowances, Allowed, Contract, ContractKind, Motion, MoveKind, Operation, OperationKind, Program, RoughingStrategy,
    Tool,
};
use impellerc::plan::passes::pipeline;
use impellerc::tool_stock::collide::{Cutter, Section, ToolSolid};
use impellerc::verify::clamping::ClampingReport;
use impellerc::verify::kept::{KeptReport, KeptSurfaces};
use impellerc::verify::proof::sweep::Sweep;
use impellerc::verify::stock::{self, Settings};
use impellerc::verify::{allowance, certify_with, clamping};
use impellerc::wheel::contract::Scope;
use impellerc::wheel::material::Material;
use impellerc::wheel::operation::VaneAllowance;
use impellerc::wheel::part::{
    BladeId, Clamping, Surface, SurfaceKind,
    chart::Shape,
    kept::{MilledTurned, kept},
};
use nalgebra::{Point3, Vector3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// What figures may be wrong by, mm.
const TENTH: f64 = 1e-4;

/// Radius of the outlet of the paper's part, mm.
fn outlet(program: &Program) -> f64 {
    program.stock.profile.last().unwrap()[0]
}

/// The paper's part with one operation that makes these moves alone, with the ball of 6 mm.
fn moved(poses: &[(Point3<f64>, Vector3<f64>, MoveKind)]) -> (Program, Motion) {
    let (program, motion) = pinned::flank().planned();
    let mut motion = motion.clone();
    replace(program, &mut motion, 0, poses);
    (program.clone(), motion)
}

/// Replaces all moves of an operation.
fn replace(program: &Program, motion: &mut Motion, operation: usize, poses: &[(Point3<f64>, Vector3<f64>, MoveKind)]) {
    let feed = program.operations[motion.operations[operation].operation].feed.get();
    let moves = &mut motion.operations[operation].moves;
    let first = moves[0];
    let mut from = None;
    *moves = poses
        .iter()
        .map(|(tip, axis, kind)| {
            let [rotary, _] = program.machine.chain.nearest(axis, 0.0);
            let joints = program.machine.joints(tip, rotary);
            let feed = match kind {
                MoveKind::Rapid => None,
                MoveKind::Cut => Some(feed),
                MoveKind::Link => Some(20.0 * feed),
            };
            let way = from.replace(*tip).map_or(0.0, |from: Point3<f64>| (tip - from).norm());
            let time = feed.map_or(1.0, |feed| way / feed * 60.0);
            impellerc::ir::JointMove { kind: *kind, joints, feed, time, ..first }
        })
        .collect();
}

fn sweeps<'a>(program: &'a Program, motion: &Motion) -> Vec<Sweep<'a>> {
    (0..motion.operations.len()).filter_map(|o| Sweep::new(program, motion, o)).collect()
}

fn measured(program: &Program, motion: &Motion) -> KeptSurfaces {
    impellerc::verify::kept::check(program, &sweeps(program, motion), 0.0, &Progress::default())
}

fn of(found: &KeptSurfaces, kind: SurfaceKind) -> &KeptReport {
    found.surfaces.iter().find(|s| s.kind == kind).expect("a kept surface")
}

/// A cut of a known depth is found to a tenth of a micrometre, and its bound holds and gives away half of one.
#[track_caller]
fn deep(report: &KeptReport, depth: f64) {
    assert!((report.gouge.depth.get() - depth).abs() < TENTH, "{report:?}, expected {depth}");
    assert!((depth - TENTH..depth + 7e-4).contains(&report.gouge_bound.get()), "{report:?}, expected {depth}");
}

fn down(to: [f64; 3], kind: MoveKind) -> (Program, Motion) {
    let to = Point3::from(to);
    moved(&[(to + Vector3::z() * 40.0, Vector3::z(), kind), (to, Vector3::z(), kind)])
}

#[test]
fn plunges_have_their_closed_form() {
    for kind in [MoveKind::Cut, MoveKind::Link, MoveKind::Rapid] {
        // Into the nose, a plane at -10 mm.
        let (program, motion) = down([11.0, 0.0, -10.03], kind);
        let found = measured(&program, &motion);
        deep(of(&found, SurfaceKind::Nose), 0.03);
        for other in [SurfaceKind::Rim, SurfaceKind::Bore, SurfaceKind::Back, SurfaceKind::Tip(BladeId::MAIN)] {
            assert_eq!(of(&found, other).gouge_bound.get(), 0.0, "{other:?}");
        }
        // Into the wall of the bore of 5 mm, a hollow cylinder, with the side of the cutter of 3 mm.
        let (program, motion) = down([2.02, 0.0, -30.0], kind);
        deep(of(&measured(&program, &motion), SurfaceKind::Bore), 0.02);
        // Along the rim, a round cylinder, below the outlet at -32.5 mm.
        let r = outlet(&program) + 3.0 - 0.05;
        let (program, motion) = down([r * 0.6, r * 0.8, -38.0], kind);
        deep(of(&measured(&program, &motion), SurfaceKind::Rim), 0.05);
    }
}

#[test]
fn deep_holes_are_told_by_their_depth() {
    // Radially through the rim, below the outlet: the ball ends eight millimetres inside.
    let program = support::flank_only(&[0]);
    let at = Point3::new(0.0, -(outlet(&program) - 8.0), -36.2);
    let out = Vector3::new(0.0, -1.0, 0.0);
    let (program, motion) = moved(&[(at + out * 30.0, out, MoveKind::Cut), (at, out, MoveKind::Cut)]);
    let found = measured(&program, &motion);
    let rim = of(&found, SurfaceKind::Rim);
    assert!((rim.gouge.depth.get() - 8.0).abs() < 0.01, "{rim:?}");
    assert!((Point3::from(rim.gouge.point) - (at + out * 8.0)).norm() < 0.2, "{rim:?}");
    // Through the nose and out at the back: both are found.
    let (program, motion) = down([10.0, 0.0, -43.0], MoveKind::Cut);
    let found = measured(&program, &motion);
    for kind in [SurfaceKind::Nose, SurfaceKind::Back] {
        assert!(of(&found, kind).gouge.depth.get() > 2.0, "{:?}", of(&found, kind));
    }
}

/// Into the middle of each surface that a vane has of its own, along its normal.
#[test]
fn surfaces_of_vanes_have_their_closed_form() {
    let program = support::flank_only(&[0]);
    let shapes = kept(&program.part, &program.stock, MilledTurned::default());
    let mut seen = 0;
    for shape in shapes.iter().filter(|s| !s.is_ring()) {
        let place = shape.place(0.5, 0.5);
        let tip = place.position - place.normal * 0.02;
        // No axis of the machine points below the horizon by much; roots and edges at the outlet do not need it.
        let from = tip + place.normal * 20.0;
        let poses = [(from, place.normal, MoveKind::Cut), (tip, place.normal, MoveKind::Cut)];
        let (program, motion) = moved(&poses);
        deep(of(&measured(&program, &motion), shape.kind), 0.02);
        seen += 1;
    }
    assert_eq!(seen, 5);
}

/// The kept surfaces lie where the closed solid of the part has its own: on planes, cylinders, cone and shroud.
#[test]
fn kept_surfaces_lie_on_the_blank() {
    let program = support::flank_only(&[0]);
    let part = &program.part;
    let (hub, shroud) = (part.hub.meridian(0.0).point, part.shroud.meridian(0.0).point);
    let inlet = (shroud - hub).normalize();
    for shape in kept(part, &program.stock, MilledTurned::default()) {
        for k in 0..=100 {
            let (x, y) = (f64::from(k % 11) / 10.0, f64::from(k / 11 % 10) / 9.0);
            let p = shape.place(x, y).position;
            let (r, z) = (p.x.hypot(p.y), p.z);
            let off = match shape.kind {
                SurfaceKind::Rim | SurfaceKind::OutletRoot(_) => r - outlet(&program),
                SurfaceKind::Back => z + 40.0,
                SurfaceKind::Bore => r - 5.0,
                SurfaceKind::Nose => z + 10.0,
                SurfaceKind::Tip(_) => part.shroud.distance(&p),
                SurfaceKind::InletRoot(_) => inlet.x * (z - hub.y) - inlet.y * (r - hub.x),
                // Rulings between two points of a cone leave it.
                _ => 0.0,
            };
            assert!(off.abs() < 2e-4, "{:?} at {x}, {y}: {off}", shape.kind);
        }
    }
}

#[test]
fn the_clamping_has_its_closed_form() {
    let distance = |program: &Program, motion: &Motion| {
        let found = clamping_of(program, motion);
        (found.part, found.distance.unwrap())
    };
    let near = |found: f64, exact: f64| (found - exact).abs() < 3e-3;
    let clamped = |program: &mut Program, below: f64, radius: f64| {
        program.stock.clamping = Clamping { below: Mm(below), radius: Some(Mm(radius)), by_default: false };
    };
    for kind in [MoveKind::Cut, MoveKind::Link, MoveKind::Rapid] {
        // Beside the part: by default everything below the back face at -40 mm is kept free.
        let (mut program, motion) = down([70.0, 0.0, -42.0], kind);
        let found = distance(&program, &motion);
        assert!(found.0 == "cutter" && near(found.1.get(), -2.0), "{found:?}");
        // A chuck of 100 mm: the centre of the ball is 20 mm beside and 1 mm over its edge.
        clamped(&mut program, -40.0, 50.0);
        let found = distance(&program, &motion);
        assert!(found.0 == "cutter" && near(found.1.get(), 20.0_f64.hypot(1.0) - 3.0), "{found:?}");
        // One that ends lower: the centre of the ball is 20 mm beside and 11 mm over its edge.
        clamped(&mut program, -50.0, 50.0);
        let found = distance(&program, &motion);
        assert!(near(found.1.get(), 20.0_f64.hypot(11.0) - 3.0), "{found:?}");
    }
    // Lying: the holder of 20 mm is the lowest part, over the chuck.
    let axis = Vector3::new(0.0, -1.0, 0.0);
    let at = |z: f64| Point3::new(0.0, -10.0, z);
    let (mut program, motion) = moved(&[(at(10.0), axis, MoveKind::Cut), (at(-15.0), axis, MoveKind::Cut)]);
    clamped(&mut program, -40.0, 200.0);
    let found = distance(&program, &motion);
    assert!(found.0 == "holder" && near(found.1.get(), 5.0), "{found:?}");
    let mut sink = Sink::default();
    clamping_report(&program, &motion, &mut sink);
    assert!(!sink.has_errors());
    clamped(&mut program, -34.0, 200.0);
    clamping_report(&program, &motion, &mut sink);
    let told = sink.diags().iter().find(|d| d.code.id() == "IMP0737").expect("a finding");
    assert!(told.message.contains("holder") && told.message.contains("1.00"), "{}", told.message);
}

#[test]
fn what_planning_takes_for_clear_of_the_clamping_is_clear() {
    let section = |from: f64, to: f64, radius_from: f64, radius_to: f64| Section { from, to, radius_from, radius_to };
    // The cutter is the lower face of the shank: planning asks for shank and holder, the verifier for the whole tool.
    let solid = ToolSolid {
        cutter: Cutter::flat(3.0),
        flute_length: 0.0,
        shank: vec![section(0.0, 12.0, 3.0, 3.0)],
        holder: vec![section(12.0, 30.0, 5.0, 9.0), section(30.0, 50.0, 16.0, 16.0)],
    };
    let (program, mut motion) = moved(&[(Point3::origin(), Vector3::z(), MoveKind::Cut); 2]);
    let tool = program.operations[motion.operations[0].operation].tool;
    let mut program = program.with_solid(tool, &solid);
    for radius in [None, Some(Mm(30.0)), Some(Mm(8.0))] {
        let clamping = Clamping { below: Mm(-40.0), radius, by_default: false };
        program.stock.clamping = clamping;
        // Poses clear of the clamping, inside of it, and clear of it but refused.
        let mut counts = [0; 3];
        for k in 0..2000 {
            // Evenly spread over tips, tilts and directions.
            let share = |step: f64| (f64::from(k) * step).fract();
            let (tilt, azimuth) = (2.0 * share(0.754_877_666), TAU * share(0.569_840_291));
            let axis = Vector3::new(tilt.sin() * azimuth.cos(), tilt.sin() * azimuth.sin(), tilt.cos());
            let tip = Point3::new(
                120.0 * share(0.438_578_7) - 60.0,
                40.0 * share(0.671_043_6),
                60.0 * share(0.819_172_5) - 70.0,
            );
            replace(&program, &mut motion, 0, &[(tip, axis, MoveKind::Cut); 2]);
            let gap = clamping_of(&program, &motion).distance.unwrap().get();
            let clear = clamping.clears_body(&solid, &tip, &axis);
            // The verifier gives a bound that is too low by a few micrometres.
            assert!(!clear || gap > -3e-3, "{clamping:?} {tip} {axis}: {gap}");
            assert!(clear || radius.is_some() || gap < 0.0, "{clamping:?} {tip} {axis}: {gap}");
            counts[if clear { 0 } else { 1 + usize::from(gap >= 0.0) }] += 1;
        }
        println!("{radius:?}: {counts:?}");
        assert!(counts[0] > 100 && counts[1] > 100 && counts[2] < counts[1], "{radius:?}: {counts:?}");
    }
}

fn clamping_of(program: &Program, motion: &Motion) -> ClampingReport {
    let sweeps: Vec<Sweep<'_>> = (0..motion.operations.len()).filter_map(|o| Sweep::new(program, motion, o)).collect();
    clamping::check(program, &sweeps)
}

fn clamping_report(program: &Program, motion: &Motion, sink: &mut Sink) {
    clamping::report(program, motion, &clamping_of(program, motion), sink);
}

#[test]
fn roughing_counts_with_what_the_control_adds() {
    let program = support::wei_program(&[0]);
    let mut motion = pipeline::run(&program, &mut Sink::default()).expect("a plan").motion;
    // The flat cutter of 8 mm comes down over the nose; only the first operation is left.
    motion.operations.truncate(1);
    for (over, fails) in [(0.0505, false), (0.03, true), (-0.02, true)] {
        let down = |z: f64| (Point3::new(11.0, 0.0, z), Vector3::z(), MoveKind::Cut);
        replace(&program, &mut motion, 0, &[down(20.0), down(-10.0 + over)]);
        let found =
            allowance::check(&program, &motion, &sweeps(&program, &motion), &Progress::default()).expect("roughing");
        assert_eq!(found.bound < found.tolerance, fails, "{found:?}");
        match found.nearest {
            Some(n) => assert!(fails && n.surface == "nose" && (n.place.value.get() - over).abs() < TENTH, "{n:?}"),
            None => assert!(!fails),
        }
        assert!((found.bound.get() - over.min(0.051)).abs() < 6e-4, "{over}: {}", found.bound);
    }
}

/// A ball of 6 mm comes down to 0.35 mm over a place of a face. An allowance of 0.2 mm is kept there, and so is one that
/// grows little. Of one that grows to 0.6 mm at the root, the part missing follows from the height of the place.
#[test]
fn roughing_keeps_its_allowance_on_the_vanes() {
    let over = 0.35;
    let part = pinned::flank().planned().0.part.clone();
    let face = part.face(part.first_passage().walls[0]);
    let (place, out) = (face.surface.point(0.6, 0.3), face.normal(0.6, 0.3));
    let axis = (face.surface.ruling(0.6) + out * 0.4).normalize();
    let tip = place + out * (3.0 + over) - axis * 3.0;
    let up = (tip + axis * 5.0, axis, MoveKind::Rapid);
    let (planned, motion) = moved(&[up, (tip, axis, MoveKind::Cut), up]);
    let height = support::Heights::new(&part).at(&place);
    assert!((0.2..0.4).contains(&height), "{height}");
    for (root, fails) in [(0.2, false), (0.3, false), (0.6, true)] {
        let allowances = Allowances { vane: VaneAllowance::growing(Mm(0.2), Mm(root)).unwrap(), hub: Mm(0.2) };
        let kind = OperationKind::Roughing { allowances, strategy: RoughingStrategy::Groove { depth: Mm(3.0) } };
        let mut program = Program { operations: PrimaryMap::new(), ..planned.clone() };
        for (_, operation) in planned.operations.iter() {
            program.operations.push(Operation { kind: kind.clone(), ..operation.clone() });
        }
        let found = allowance::check(&program, &motion, &sweeps(&program, &motion), &Progress::default())
            .expect("roughing")
            .vanes;
        assert_eq!(errors(&program, &motion).iter().any(|(code, _)| code == "IMP0749"), fails, "{root}");
        let [found] = found.as_slice() else { panic!("{found:?}") };
        let missing = (root - (root - 0.2) * height - over).max(0.0);
        let measured = found.worst.as_ref().map_or(0.0, |w| -w.place.value.get());
        println!("root {root}: missing {missing:.4}, measured {measured:.4}, bound {:.4}", found.bound);
        // Beside the place the allowance is a little larger and the ball a little farther.
        assert!(measured >= missing - TENTH && measured < missing + 0.01, "{missing} {found:?}");
        assert!(found.bound >= Mm(measured) && found.bound < Mm(measured + 1e-3), "{found:?}");
    }
}

/// Chips and slots: a ball of 6 mm straight down beside the nose and along a line through the full blank.
#[test]
fn load_is_judged_by_tool_and_feed() {
    let line = |kind| {
        let at = |x: f64, z: f64| (Point3::new(x, 40.0, z), Vector3::z());
        let [(a, up), (b, _), (c, _)] = [at(-80.0, -20.0), at(-70.0, -20.0), at(70.0, -20.0)];
        moved(&[(a, up, MoveKind::Rapid), (b, up, MoveKind::Rapid), (c, up, kind)])
    };
    let diags = |program: &Program, motion: &Motion| {
        let mut sink = Sink::default();
        let report =
            stock::simulate(program, motion, &mut Settings::default(), &Progress::default(), &mut sink).unwrap();
        stock::report(program, motion, &report, &mut sink);
        let told = sink.diags().iter().filter(|d| ["IMP0735", "IMP0739"].contains(&d.code.id()));
        told.cloned().collect::<Vec<_>>()
    };
    let told = |program: &Program, motion: &Motion| {
        let told = diags(program, motion).into_iter();
        told.map(|d| (d.code.id(), d.severity == Severity::Error, d.message)).collect::<Vec<_>>()
    };
    // A finishing tool in full material, with chips of 8 um, deeper than its diameter: no shop does this, whatever the tool is said
    // to take. The job can allow it for the operation; then it is worth a remark.
    let (mut program, mut motion) = line(MoveKind::Cut);
    program.allowed.clear();
    let found = told(&program, &motion);
    assert!(matches!(&found[..], [("IMP0739", true, text)] if text.contains("full material")), "{found:?}");
    let own = motion.operations[0].operation;
    let other = program.operations.ids().find(|o| *o != own);
    for (scope, allows) in [(Some(own), true), (other, other.is_none())] {
        let operations = scope.into_iter().collect();
        let scope = Scope { operations, surfaces: Vec::new() };
        let reason = "tried on this machine".to_owned();
        let allowed = vec![Allowed { kind: ContractKind::Slot, scope, reason, span: Span::default() }];
        let found = told(&Program { allowed, ..program.clone() }, &motion);
        let right = |f: &(&str, bool, String)| f.0 == "IMP0739" && f.1 != allows && f.2.contains("full material");
        assert!(found.len() == 1 && right(&found[0]), "{allows}: {found:?}");
    }
    // The same with chips of 0.25 mm: the tool breaks, also by the chip alone.
    let cut = &mut motion.operations[0].moves[2];
    (cut.feed, cut.time) = (Some(8000.0), cut.time * cut.feed.unwrap() / 8000.0);
    let found = told(&program, &motion);
    assert!(found.iter().any(|f| f.1 && f.2.contains("full material")), "{found:?}");
    let thick = |f: &&(&str, bool, String)| f.2.contains("feed per tooth of");
    assert!(found.iter().find(thick).is_some_and(|f| f.0 == "IMP0739" && f.1), "{found:?}");
    // A tool that permits such chips breaks in the slot all the same. One that permits less depth is told that as well.
    let stiff = |max_depth: f64, max_rate: Option<Mm3PerMin>| {
        let mut tools = PrimaryMap::new();
        for (_, tool) in program.tools.iter() {
            tools.push(Tool { max_chip: Mm(0.3), max_depth: Mm(max_depth), max_rate, ..tool.clone() });
        }
        Program { tools, ..program.clone() }
    };
    let found = told(&stiff(f64::INFINITY, None), &motion);
    assert!(found.iter().any(|f| f.1 && f.2.contains("full material")), "{found:?}");
    assert!(!found.iter().any(|f| thick(&f) || f.2.contains("its limit is")), "{found:?}");
    let found = told(&stiff(4.0, None), &motion);
    let deep = |f: &(&str, bool, String)| f.0 == "IMP0739" && f.1 && f.2.contains("its limit is 4.000 mm");
    assert!(found.iter().any(deep), "{found:?}");
    // The deepest section of the slot: the width of the ball, 6 mm, by the height of the blank over the tip, where the
    // line crosses the meridian nearest to the axis, less the corners beside the hemisphere. The mean over some cells, which
    // the simulation finds, is smaller.
    let blank = program.stock.profile.iter().filter(|p| p[0] >= 40.0).map(|p| p[1]).fold(f64::NEG_INFINITY, f64::max);
    let section = 6.0 * (blank + 20.0 - 3.0) + PI * 9.0 / 2.0;
    let rate = section * 8000.0;
    let fast = |f: &(&str, bool, String)| f.0 == "IMP0739" && f.1 && f.2.contains("mm3/min");
    for (share, fails) in [(0.85, true), (1.1, false)] {
        let found = told(&stiff(f64::INFINITY, Some(Mm3PerMin(share * rate))), &motion);
        assert_eq!(found.iter().any(fast), fails, "{share} {rate} {found:?}");
    }
    // The feeds that the messages tell are enough: that of the chip, 0.25 mm where 0.2 mm are allowed, and that of the rate, which
    // the simulation finds from below.
    let told_feed = |program: &Program, motion: &Motion, of: &str| {
        let told = diags(program, motion).into_iter().find(|d| d.message.contains(of)).unwrap();
        let help = told.help.unwrap();
        help.split_once("a feed of at most ").unwrap().1.split_once(" mm/min").unwrap().0.parse::<f64>().unwrap()
    };
    let slow = stiff(f64::INFINITY, Some(Mm3PerMin(0.85 * rate)));
    let mut thin = Program { tools: PrimaryMap::new(), ..slow.clone() };
    for (_, tool) in slow.tools.iter() {
        thin.tools.push(Tool { max_chip: Mm(0.2), ..tool.clone() });
    }
    for (of, expected) in [("feed per tooth of", 0.2 * 8000.0 * 4.0), ("mm3/min", 0.85 * 8000.0)] {
        let feed = told_feed(&thin, &motion, of);
        assert!((0.95 * expected..1.1 * expected).contains(&feed), "{of}: {feed} {expected}");
        let mut slower = motion.clone();
        let cut = &mut slower.operations[0].moves[2];
        (cut.feed, cut.time) = (Some(feed), cut.time * cut.feed.unwrap() / feed);
        let left = told(&thin, &slower);
        assert!(!left.iter().any(|f| f.2.contains(of)), "{of}: {feed} {left:?}");
    }
    // Aluminium: 500 N/mm2 for a chip of 1 mm. Here the mean chip is 2/pi of 8000 / (8000 * 4) mm.
    let power = 500.0 * (8000.0 / (8000.0 * 4.0) * 2.0 / PI).powf(-0.25) * rate / 6e7;
    let strong = |f: &(&str, bool, String)| f.0 == "IMP0739" && f.1 && f.2.contains("kW at the cutter");
    for (share, fails) in [(0.85, true), (1.1, false)] {
        let mut program = stiff(f64::INFINITY, None);
        program.machine.power = Some(share * power);
        assert!(!told(&program, &motion).iter().any(strong), "the material is unknown");
        program.stock.material = Some(Material::Aluminium);
        assert_eq!(told(&program, &motion).iter().any(strong), fails, "{share} {power}");
    }
    // At link feed it is no cut: a link that removes anything here removes more than any cut.
    let (program, motion) = line(MoveKind::Link);
    let found = told(&program, &motion);
    assert!(found.iter().any(|f| f.0 == "IMP0735" && f.1), "{found:?}");
}

/// A stated limit alone permits a cut that loads a tool as a slot deeper than its diameter: a remark says so for each operation
/// of the small job. With a limit below the load it is an error.
#[test]
fn a_stated_depth_over_the_diameter_is_told() {
    let small = pinned::small("siemens-840d");
    let report = small.certificate().stock.as_ref().unwrap();
    let told = |max_depth: f64| {
        let mut tools = PrimaryMap::new();
        for (_, tool) in small.program.tools.iter() {
            tools.push(Tool { max_depth: Mm(max_depth), ..tool.clone() });
        }
        let (program, mut sink) = (Program { tools, ..small.program.clone() }, Sink::default());
        stock::report(&program, &small.motion, report, &mut sink);
        let loads = sink.diags().iter().filter(|d| d.message.contains("which loads it as a slot"));
        loads.map(|d| (d.severity == Severity::Error, d.message.clone())).collect::<Vec<_>>()
    };
    let depths = report.operations.iter().filter_map(|o| o.slot_depth).map(|p| p.value.get());
    let deep = depths.clone().filter(|depth| *depth > 2.0).count();
    let deepest = depths.fold(0.0, f64::max);
    assert!(deep > 1 && (3.0..4.0).contains(&deepest), "{deep} {deepest}");
    for (limit, errors) in [(4.0, false), (2.0, true)] {
        let found = told(limit);
        assert!(found.len() == deep && found.iter().all(|f| f.0 == errors), "{limit}: {found:?}");
        assert!(found.iter().all(|f| f.1.contains("% of the diameter of 2.000 mm")), "{found:?}");
    }
    let found = told(deepest - 0.01);
    assert_eq!(found.iter().filter(|f| f.0).count(), 1, "{found:?}");
}

/// The small job with nothing but the end of its last operation, and with cuts before it.
fn harmed(poses: &[(Point3<f64>, Vector3<f64>)]) -> (Program, Motion) {
    let (whole, motion) = pinned::small("siemens-840d").planned();
    let mut operation = motion.operations.last().unwrap().clone();
    let mut program = Program { operations: PrimaryMap::new(), ..whole.clone() };
    operation.operation = program.operations.push(whole.operations[operation.operation].clone());
    let last = *operation.moves.last().unwrap();
    operation.moves = vec![last];
    for (tip, axis) in poses {
        let [rotary, _] = program.machine.chain.nearest(axis, 0.0);
        let joints = program.machine.joints(tip, rotary);
        operation.moves.push(impellerc::ir::JointMove {
            kind: MoveKind::Cut,
            joints,
            feed: Some(250.0),
            time: 10.0,
            ..last
        });
    }
    // Up again to where the operation ended.
    operation.moves.push(impellerc::ir::JointMove { time: 10.0, ..last });
    (program, Motion { operations: vec![operation] })
}

/// Codes of errors with their messages.
fn errors(program: &Program, motion: &Motion) -> Vec<(String, String)> {
    let mut sink = Sink::default();
    // The largest cells that a job may have.
    let mut settings = Settings { cell: Some(1.0), ..Settings::default() };
    let _ = certify_with(program, motion, &mut settings, &Progress::default(), &mut sink);
    let errors = sink.diags().iter().filter(|d| d.severity == Severity::Error);
    errors.map(|d| (d.code.id().to_owned(), d.message.clone())).collect()
}

/// A ring of tips about Z, with the tool along Z.
fn ring(r: f64, z: f64) -> Vec<(Point3<f64>, Vector3<f64>)> {
    let at = |angle: f64, z: f64| (Point3::new(r * angle.cos(), r * angle.sin(), z), Vector3::z());
    let mut poses = vec![at(0.0, 20.0)];
    poses.extend((0..=72).map(|k| at(TAU * f64::from(k) / 72.0, z)));
    poses.push(at(0.0, 20.0));
    poses
}

#[test]
fn harm_outside_of_the_design_surfaces_is_refused() {
    let rim = outlet(&pinned::small("siemens-840d").program);
    let out = Vector3::new(0.0, -1.0, 0.0);
    let radial = |r: f64| (Point3::new(0.0, -r, -14.6), out);
    let along = |z: f64| (Point3::new(4.4, 0.0, z), Vector3::z());
    // Name, moves, the kept surface, whether rays a millimetre apart meet it.
    let cases = [
        ("bore milled wider", ring(1.4, -15.0), "bore", true),
        ("hole through the rim", vec![radial(40.0), radial(rim - 8.0), radial(40.0)], "rim", true),
        ("hole through the nose", vec![along(20.0), along(-19.0), along(20.0)], "nose", true),
        ("groove along the outer edge", ring(rim + 0.6, -15.2), "rim", true),
        ("groove of 20 um", ring(rim + 0.98, -15.2), "rim", false),
    ];
    for (name, poses, surface, seen) in cases {
        let (program, motion) = harmed(&poses);
        let found = errors(&program, &motion);
        let has = |code: &str, word: &str| found.iter().any(|(c, m)| c == code && m.contains(word));
        assert!(has("IMP0736", &format!("into the {surface}")), "{name}: {found:?}");
        assert_eq!(has("IMP0746", "hub disc"), seen, "{name}: {found:?}");
    }
    // Beside the part, the tip below its back at -16 mm.
    let beside = |z: f64| (Point3::new(rim + 6.0, 0.0, z), Vector3::z());
    let (program, below) = harmed(&[beside(20.0), beside(-17.5), beside(20.0)]);
    let found = errors(&program, &below);
    let has = |found: &[(String, String)], code: &str| found.iter().any(|(c, _)| c == code);
    assert!(found.iter().any(|(code, text)| code == "IMP0737" && text.contains("1.50")), "{found:?}");
    assert!(!has(&found, "IMP0736") && !has(&found, "IMP0746"), "{found:?}");
    // With a chuck that the job states it is no harm.
    let mut chuck = program.clone();
    chuck.stock.clamping = Clamping { below: Mm(-16.0), radius: Some(Mm(rim)), by_default: false };
    let found = errors(&chuck, &below);
    assert!(["IMP0736", "IMP0737", "IMP0746"].iter().all(|code| !has(&found, code)), "{found:?}");
}

/// A contract on the hub alone says nothing of kept surfaces; one on the whole part does.
#[test]
fn the_whole_contract_bounds_kept_surfaces() {
    let (mut program, motion) = down([11.0, 0.0, -10.03], MoveKind::Cut);
    assert_eq!(measured(&program, &motion).allowed.get(), 0.1);
    let mut hub = Contract::whole(ContractKind::Gouge, 1e-3);
    hub.scope.surfaces = vec![impellerc::wheel::part::SurfaceClass::Hub];
    program.contracts =
        vec![hub, Contract::whole(ContractKind::Gouge, 0.05), Contract::whole(ContractKind::Gouge, 0.02)];
    assert_eq!(measured(&program, &motion).allowed.get(), 0.02);
    assert!((FRAC_PI_2 - Chain::tilting_table().nearest(&Vector3::x(), 0.0)[0][0]).abs() < 1e-12);
}

/// Who finishes the edges at the inlet leaves to the lathe those that it makes at the outlet; an edge inside of the part is no edge of
/// the lathe.
#[test]
fn edges_of_the_lathe_are_kept_where_the_others_are_milled() {
    for (job, edges) in [("small/small", [false; 2]), ("splitter/splitter", [true, false]), ("blisk/blisk", [true; 2])]
    {
        let program = support::jobs::program_at(&format!("jobs/{job}.imp"));
        assert_eq!(program.milled_turned().edges, edges, "{job}");
    }
}
