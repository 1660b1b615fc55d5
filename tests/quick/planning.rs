//! Planning of the paper's part.

use crate::support::{self, jobs};
use impellerc::base::entity::PrimaryMap;
use impellerc::base::progress::Progress;
use impellerc::diagnostics::{Severity, Sink, codes::kinematics, codes::verification};
use impellerc::ir::MoveKind;
use impellerc::plan::passes::pipeline;
use impellerc::tool_stock::collide::{Cutter, Section};
use impellerc::verify::stock::Settings;
use impellerc::verify::{certify, certify_with};

#[test]
fn one_sector_of_the_paper_part_is_planned() {
    let program = support::wei_program(&[0]);
    let mut sink = Sink::default();
    let start = std::time::Instant::now();
    let plan = pipeline::run(&program, &mut sink);
    println!("planned in {:?}", start.elapsed());
    for d in sink.diags() {
        println!("{} {} {:?} {:?}", d.code, d.message, d.place, d.notes);
    }
    let plan = plan.expect("a plan");
    for (cl, motion) in plan.cl.operations.iter().zip(&plan.motion.operations) {
        let name = &program.operations[cl.operation].name;
        let time: f64 = motion.moves.iter().map(|m| m.time).sum();
        let slow = motion.moves.iter().filter(|m| m.kind == MoveKind::Cut).filter_map(|m| m.feed).fold(1e9, f64::min);
        println!(
            "{name}: {} passes, {} moves, {:.1} min, slowest {slow:.1}",
            cl.passes.len(),
            motion.moves.len(),
            time / 60.0
        );
        for note in &cl.notes {
            println!("    {note}");
        }
    }
    assert_eq!(plan.motion.operations.len(), 6);
}

/// Gouge and excess on the hub between two vanes after channel finishing with a ball of 6 mm, with its shank from the
/// end of the flutes, in mm.
fn channel(cutter: Cutter, flute: f64, neck: f64) -> [f64; 2] {
    let mut program = support::wei_program(&[0]);
    (program.tools, program.operations) = (PrimaryMap::new(), PrimaryMap::new());
    let mut tool = support::tool("t1", 1, cutter, flute, 42.0);
    tool.solid.shank = vec![Section { from: flute, to: 42.0, radius_from: neck, radius_to: neck }];
    let tool = program.tools.push(tool);
    program.operations.push(support::operation("channel", support::channel(0.2), tool, vec![0], 8.0));
    let plan = pipeline::run(&program, &mut Sink::default()).expect("a plan");
    let mut settings = Settings { cell: Some(1.0), ..Settings::default() };
    let progress = Progress::default();
    let certificate =
        certify_with(&program, &plan.motion, &mut settings, &progress, &mut Sink::default()).expect("a certificate");
    let hub = certificate.surfaces.iter().find(|s| s.surface.contains("hub of channel 1")).expect("a hub");
    let deepest = certificate.surfaces.iter().map(|s| s.gouge.depth.get()).fold(0.0, f64::max);
    [deepest, hub.excess.value.get()]
}

#[test]
fn a_lollipop_finishes_channels_like_the_ball_it_carries() {
    let neck = 2.0;
    let lollipop = Cutter::lollipop(3.0);
    let [gouge, excess] = channel(lollipop, lollipop.neck_height(neck).unwrap(), neck);
    let [of_ball, excess_of_ball] = channel(Cutter::ball(3.0), 30.0, 3.0);
    println!("lollipop {gouge} {excess}, ball {of_ball} {excess_of_ball}");
    // Both keep the tolerance of the plan, and leave the same scallops.
    assert!(gouge < 0.003 && of_ball < 0.003, "{gouge} {of_ball}");
    assert!((excess - excess_of_ball).abs() < 0.01, "{excess} {excess_of_ball}");
}

/// Sectors are planned once and copied; the travel of C is judged for each of them, in planning and in verification.
#[test]
fn each_sector_is_within_the_travel_of_c() {
    let limited = |from: f64, to: f64| {
        let mut program = jobs::program("small", None);
        (program.machine.rotary[1].min, program.machine.rotary[1].max) = (from.to_radians(), to.to_radians());
        program
    };
    // Less than the eighth of a turn between two sectors: one error an operation.
    let narrow = limited(-20.0, 20.0);
    let mut sink = Sink::default();
    assert!(pipeline::run(&narrow, &mut sink).is_err());
    let out = sink.diags().iter().filter(|d| d.code == kinematics::OUT_OF_TRAVEL).count();
    assert!(out > 0 && out <= narrow.operations.len(), "{out} errors");
    // A whole turn that begins elsewhere: no move leaves it, links and rapids included.
    let turned = limited(10.0, 370.0);
    let plan = pipeline::run(&turned, &mut Sink::default()).expect("a plan");
    let angles = || plan.motion.operations.iter().flat_map(|o| &o.moves).map(|m| m.joints.rotary[1].to_degrees());
    let (least, most) = angles().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), c| (a.min(c), b.max(c)));
    assert!(least >= 10.0 && most <= 370.0 && most - least > 180.0, "{least} to {most}");
    // The same motion on the machine with less travel is refused by the verifier.
    let mut sink = Sink::default();
    let _ = certify(&narrow, &plan.motion, &mut sink);
    assert!(sink.diags().iter().any(|d| d.code == verification::AXIS_TRAVEL && d.severity == Severity::Error));
}
