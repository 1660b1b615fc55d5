//! Channel floors with a bull nose in the middle and the ball of the fillets beside the walls.

use crate::channel_floor::{Ways, azimuth};
use crate::larger_balls::with_tools;
use crate::support::jobs;
use impellerc::diagnostics::Sink;
use impellerc::ir::{ClPoint, Contract, ContractKind, Drive, Program};
use impellerc::plan::passes::pipeline::{self, Plan};
use impellerc::tool_stock::collide::Cutter;
use impellerc::tool_stock::collide::tool::tool_coordinates;
use impellerc::wheel::method::AxisMethod;
use nalgebra::{Point3, Vector2};
use std::collections::BTreeMap;
use std::sync::LazyLock;

const SCALLOP: f64 = 0.012;
const ALLOWANCE: f64 = 0.2;
fn bull() -> Cutter {
    Cutter::bull(4.0, 1.5)
}

/// The paper's part with nothing but the finishing of one channel: a larger tool, then the ball of the fillets.
fn program(larger: Cutter, scallop: f64) -> Program {
    let ball = Cutter::ball(3.0);
    with_tools(&[(larger, AxisMethod::Lead), (ball, AxisMethod::Corridor)], scallop, ALLOWANCE)
}

/// The program with the bull nose and a contract on what it leaves, and its plan.
static PLANNED: LazyLock<(Program, Plan)> = LazyLock::new(|| {
    let mut program = program(bull(), SCALLOP);
    program.contracts.push(Contract::whole(ContractKind::Excess, SCALLOP));
    let plan = pipeline::run(&program, &mut Sink::default()).expect("a plan");
    (program, plan)
});

/// Positions of the bull nose, at most this far apart along a line, mm.
const APART: f64 = 0.1;

/// The cell of 2 mm in x and y.
fn cell(p: &Point3<f64>) -> [i64; 2] {
    [(p.x / 2.0).floor() as i64, (p.y / 2.0).floor() as i64]
}

/// Positions along straight pieces between the cutter locations of an operation, by the cell of their contact.
fn positions(plan: &Plan, operation: usize) -> BTreeMap<[i64; 2], Vec<ClPoint>> {
    let mut cells: BTreeMap<[i64; 2], Vec<ClPoint>> = BTreeMap::new();
    for pair in plan.cl.operations[operation].passes.iter().flat_map(|pass| pass.points.windows(2)) {
        let [(a, from), (b, to)] = [0, 1].map(|i: usize| (pair[i], pair[i].contact.expect("a contact")));
        let count = ((to - from).norm() / APART).ceil().max(1.0);
        for i in 0..count as usize {
            let t = i as f64 / count;
            let tip = a.tip + (b.tip - a.tip) * t;
            let axis = (a.axis * (1.0 - t) + b.axis * t).normalize();
            let contact = from + (to - from) * t;
            cells.entry(cell(&contact)).or_default().push(ClPoint { tip, axis, contact: Some(contact) });
        }
    }
    cells
}

#[test]
fn no_ridge_of_a_bull_nose_is_higher_than_the_scallop() {
    let (program, plan) = &*PLANNED;
    let (cells, part) = (positions(plan, 0), &program.part);
    let ball = Ways::new(&plan.cc.operations[1].passes, 3.0);
    let walls = &plan.cc.operations[1].passes;
    let (mut worst, mut of_bull, mut deepest) = (0.0_f64, 0, f64::INFINITY);
    for i in 0..=150 {
        let u = f64::from(i) / 150.0;
        let (from, to) = (azimuth(&walls[0], u), azimuth(walls.last().unwrap(), u));
        for j in 0..=300 {
            let azimuth = from + (to - from) * (0.003 + 0.994 * f64::from(j) / 300.0);
            let (at, normal) = (part.hub.point(u, azimuth), part.hub.normal(u, azimuth));
            let [x, y] = cell(&at);
            let near = (x - 1..=x + 1).flat_map(|x| (y - 1..=y + 1).map(move |y| [x, y]));
            let left = near.filter_map(|c| cells.get(&c)).flatten().map(|p| {
                let (rho, s) = tool_coordinates(&at, &p.tip, &p.axis);
                bull().distance(rho, s)
            });
            let by_bull = left.fold(f64::INFINITY, f64::min);
            deepest = deepest.min(by_bull);
            of_bull += u32::from(by_bull < SCALLOP);
            worst = worst.max(by_bull.min(ball.excess(&at, &normal)));
        }
    }
    println!(
        "{worst} of {SCALLOP}; the bull nose finishes {of_bull} of {} places, {deepest} at the deepest",
        151 * 301
    );
    // The chords of the interpolation are in it.
    assert!(worst < SCALLOP && worst > 0.9 * SCALLOP, "{worst}");
    assert!(of_bull > 151 * 301 / 5, "{of_bull}");
    assert!(deepest > -1.5 * program.tolerances.chord.get(), "{deepest}");
}

#[test]
fn the_end_of_a_bull_nose_stays_out_of_the_hub_and_its_axis_has_the_lead_angle() {
    let (program, plan) = &*PLANNED;
    let Drive::HubWithLead(_, lead) = plan.cc.operations[0].passes[0].drive else { panic!("a bull nose without lead") };
    let mut least = f64::INFINITY;
    for (cc, cl) in plan.cc.operations[0].passes.iter().zip(&plan.cl.operations[0].passes) {
        assert!(cc.points.first().unwrap().u < cc.points.last().unwrap().u, "against the feed");
        for p in &cl.points {
            let contact = p.contact.unwrap();
            let (u, lifted) = program.part.hub.closest(Vector2::new(contact.x.hypot(contact.y), contact.z));
            let normal = program.part.hub.normal(u, contact.y.atan2(contact.x));
            // On leads the axis is constant.
            if (0.0..=1.0).contains(&u) && lifted < 1e-6 {
                assert!((normal.dot(&p.axis).acos() - lead).abs() < 1e-6);
            }
            // The flat end, all of it; the corner is in the test of ridges.
            let across = p.axis.cross(&normal).normalize();
            let other = p.axis.cross(&across);
            for k in 0..100 {
                let (sin, cos) = (f64::from(k) * 0.0628).sin_cos();
                for share in [0.2, 0.5, 0.8, 1.0] {
                    let at = p.tip + (across * cos + other * sin) * (2.5 * share);
                    least = least.min(program.part.hub.closest(Vector2::new(at.x.hypot(at.y), at.z)).1);
                }
            }
        }
    }
    println!("lead angle {} deg, the flat end at least {least} mm outside of the hub", lead.to_degrees());
    // On a plane the flat end begins this far above the contact of the corner; the hub is hollow along the channel.
    let on_plane = 1.5 * (1.0 - lead.cos());
    assert!(least > 0.0 && least < on_plane, "{least} {on_plane}");
}

#[test]
fn the_verifier_proves_scallop_and_gouge_of_a_bull_nose() {
    let (program, plan) = &*PLANNED;
    let certificate = jobs::certified(program, &plan.motion);
    let hub = certificate.surfaces.iter().find(|s| s.surface.contains("hub of channel 1")).expect("a hub");
    let deepest = certificate.surfaces.iter().map(|s| s.gouge_bound.get()).fold(0.0, f64::max);
    println!(
        "left {} mm found, {} mm proved; deepest cut {deepest} mm",
        hub.excess.value.get(),
        hub.excess_bound.get()
    );
    assert!(hub.excess_bound.get() <= SCALLOP, "{}", hub.excess_bound.get());
    assert!(deepest < 0.0015, "{deepest}");
}

#[test]
fn a_bull_nose_whose_heel_no_lead_angle_lifts_is_a_remark() {
    // 50 mm wide on a floor whose meridian is hollow with about 25 mm; few lines, since the scallop has no part in it.
    let mut sink = Sink::default();
    let wide = program(Cutter::bull(25.0, 1.0), 0.5);
    let planned = pipeline::run(&wide, &mut sink).expect("a plan");
    assert!(sink.diags().iter().any(|d| d.code.id() == "IMP0411"));
    assert!(planned.cc.operations[0].passes.is_empty());
    assert!(!planned.cc.operations[1].passes.is_empty());
}
