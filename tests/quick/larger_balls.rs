//! Channel floors with a larger ball in the middle and the ball of the fillets beside the walls.

use crate::channel_floor::{Ways, azimuth, contact_length, on_hub};
use crate::support::{self, jobs};
use impellerc::base::entity::PrimaryMap;
use impellerc::base::units::Mm;
use impellerc::diagnostics::{Severity, Sink};
use impellerc::ir::{CcPass, Contract, ContractKind, OperationKind, Program};
use impellerc::nurbs::proximity::Patch;
use impellerc::plan::passes::pipeline::{self, Plan};
use impellerc::tool_stock::collide::Cutter;
use impellerc::wheel::method::{AxisMethod, Lines, Spacing};
use impellerc::wheel::part::Surface;
use std::sync::LazyLock;

const ALLOWANCE: f64 = 0.2;

/// The paper's part with nothing but the finishing of one channel: balls in their order, each but the last with an
/// allowance on the vanes.
fn balls(radii: &[f64], scallop: f64, allowance: f64) -> Program {
    with_axes(radii, scallop, allowance, AxisMethod::Blend)
}

/// The same with a method for the tool axes.
fn with_axes(radii: &[f64], scallop: f64, allowance: f64, method: AxisMethod) -> Program {
    let balls = radii.iter().map(|radius| (Cutter::ball(*radius), method));
    with_tools(&balls.collect::<Vec<_>>(), scallop, allowance)
}

/// The paper's part with nothing but the finishing of one channel: tools in their order with the method for their axes, each
/// but the last with an allowance on the vanes.
pub(crate) fn with_tools(tools: &[(Cutter, AxisMethod)], scallop: f64, allowance: f64) -> Program {
    let mut program = support::wei_program(&[0]);
    (program.tools, program.operations) = (PrimaryMap::new(), PrimaryMap::new());
    for (k, (cutter, method)) in tools.iter().enumerate() {
        let number = k as u32 + 1;
        let tool = program.tools.push(support::tool(&format!("t{number}"), number, *cutter, 30.0, 50.0));
        let kind = OperationKind::Channel {
            scallop: Mm(scallop),
            spacing: Spacing::ConstantScallop,
            lines: Lines::Zigzag,
            method: *method,
            allowance_vane: (k + 1 < tools.len()).then_some(Mm(allowance)),
        };
        program.operations.push(support::operation(&format!("channel{number}"), kind, tool, vec![0], 8.0));
    }
    program
}

fn plan(program: &Program) -> Plan {
    pipeline::run(program, &mut Sink::default()).expect("a plan")
}

/// Two balls and the scallop height of the paper, planned once.
static TWO: LazyLock<(Program, Plan)> = LazyLock::new(|| {
    let program = balls(&[5.0, 3.0], 0.012, ALLOWANCE);
    let plan = plan(&program);
    (program, plan)
});

fn passes(plan: &Plan, operation: usize) -> &[CcPass] {
    &plan.cc.operations[operation].passes
}

#[test]
fn no_ridge_between_the_bands_of_the_balls_is_higher_than_the_scallop() {
    let three = balls(&[6.0, 4.5, 2.5], 0.02, ALLOWANCE);
    let planned = plan(&three);
    for (radii, scallop, program, plan) in
        [(vec![5.0, 3.0], 0.012, &TWO.0, &TWO.1), (vec![6.0, 4.5, 2.5], 0.02, &three, &planned)]
    {
        let last = radii.len() - 1;
        let ways: Vec<Ways> = radii.iter().enumerate().map(|(k, r)| Ways::new(passes(plan, k), *r)).collect();
        let walls = passes(plan, last);
        let planned = scallop - program.tolerances.chord.get();
        let (mut worst, mut both) = (0.0_f64, 0);
        for i in 0..=200 {
            let u = f64::from(i) / 200.0;
            let (from, to) = (azimuth(&walls[0], u), azimuth(walls.last().unwrap(), u));
            for j in 0..=400 {
                let azimuth = from + (to - from) * (0.003 + 0.994 * f64::from(j) / 400.0);
                let (at, normal) = (program.part.hub.point(u, azimuth), program.part.hub.normal(u, azimuth));
                let left: Vec<f64> = ways.iter().map(|w| w.excess(&at, &normal)).collect();
                worst = worst.max(left.iter().copied().fold(f64::INFINITY, f64::min));
                both += u32::from(left.iter().filter(|x| **x < planned).count() > 1);
            }
        }
        println!("{radii:?}: {worst} of {planned}; {both} places finished by more than one ball");
        assert!(worst < 1.01 * planned, "{radii:?}: {worst} {planned}");
        // The bands overlap, and they are no two finishings of the same floor.
        assert!(both > 100 && both < 201 * 401 / 4, "{both}");
        assert!((0..=last).all(|k| !passes(plan, k).is_empty()));
    }
}

#[test]
fn the_verifier_proves_scallop_and_gouge_over_the_blend() {
    // Higher than that of the paper: fewer lines, of which the same is proved.
    const SCALLOP: f64 = 0.05;
    let mut program = with_axes(&[5.0, 3.0], SCALLOP, ALLOWANCE, AxisMethod::Corridor);
    program.contracts.push(Contract::whole(ContractKind::Excess, SCALLOP));
    let plan = plan(&program);
    let certificate = jobs::certified(&program, &plan.motion);
    let hub = certificate.surfaces.iter().find(|s| s.surface.contains("hub of channel 1")).expect("a hub");
    let deepest = certificate.surfaces.iter().map(|s| s.gouge_bound.get()).fold(0.0, f64::max);
    println!(
        "left {} mm found, {} mm proved; deepest cut {deepest} mm",
        hub.excess.value.get(),
        hub.excess_bound.get()
    );
    assert!(hub.excess_bound.get() <= SCALLOP && hub.excess_bound.get() > 0.8 * SCALLOP, "{}", hub.excess_bound.get());
    assert!(deepest < 0.0015, "{deepest}");
}

#[test]
fn the_larger_ball_keeps_its_allowance_from_both_walls_and_saves_lines() {
    let (program, two) = &*TWO;
    let part = &program.part;
    let [first, second] = part.first_passage().walls;
    let mut least = f64::INFINITY;
    for (side, sector) in [(first, 0), (second, 1)] {
        let turn = part.sector_rotation(sector).inverse();
        let surface = &part.face(side).surface;
        for p in passes(two, 0).iter().flat_map(|pass| pass.points.iter().step_by(5)) {
            let centre = turn * (p.position + p.normal * 5.0);
            let foot = surface.closest(&centre, Patch { u: [0.0, 1.0], v: [0.0, 1.0] });
            let free = (surface.point(foot.u, foot.v) - centre).norm() - 5.0;
            if on_hub(program, p) {
                least = least.min(free);
            }
            // Arcs as well stay off the walls.
            assert!(free > 0.0, "{free} at {}", p.position);
        }
    }
    println!("the ball comes to {least} mm");
    assert!((least - ALLOWANCE).abs() < 1e-3, "{least}");
    let alone = plan(&balls(&[3.0], 0.012, ALLOWANCE));
    let length = |plan: &Plan| -> f64 {
        plan.cc.operations.iter().flat_map(|o| &o.passes).map(|p| contact_length(program, p)).sum()
    };
    let (two, one) = (length(two), length(&alone));
    println!("{two} mm of contact with two balls, {one} mm with one");
    assert!(two < 0.9 * one, "{two} {one}");
}

#[test]
fn a_larger_ball_that_fits_nowhere_is_a_remark_and_the_next_one_does_all() {
    // The channel is less than 50 mm wide.
    let program = balls(&[5.0, 3.0], 0.1, 30.0);
    let mut sink = Sink::default();
    let planned = pipeline::run(&program, &mut sink).expect("a plan");
    let said: Vec<_> = sink.diags().iter().map(|d| (d.code.id(), d.severity)).collect();
    assert_eq!(said, [("IMP0411", Severity::Remark)]);
    assert!(passes(&planned, 0).is_empty());
    let alone = plan(&balls(&[3.0], 0.1, 0.0));
    let points = |passes: &[CcPass]| passes.iter().flat_map(|p| p.points.clone()).collect::<Vec<_>>();
    assert_eq!(points(passes(&planned, 1)), points(passes(&alone, 0)));
    let certificate = jobs::certified(&program, &planned.motion);
    assert!(certificate.surfaces.iter().all(|s| s.gouge_bound.get() < 0.002));
}

#[test]
fn a_larger_ball_than_the_hollow_of_the_hub_is_refused() {
    let mut sink = Sink::default();
    assert!(pipeline::run(&balls(&[30.0, 3.0], 0.1, ALLOWANCE), &mut sink).is_err());
    assert!(sink.diags().iter().any(|d| d.code.id() == "IMP0408" && d.help.is_some()));
}
