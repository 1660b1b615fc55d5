//! Channel floors of constant scallop.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "figures of a run are shown with --nocapture")]

mod support;

use impellerc::collide::Cutter;
use impellerc::diag::Sink;
use impellerc::entity::PrimaryMap;
use impellerc::ir::{CcPass, CcPoint, Contract, ContractKind, OperationKind, Program};
use impellerc::method::{AxisMethod, Spacing};
use impellerc::passes::pipeline;
use impellerc::units::Mm;
use impellerc::verify::certify;

/// The paper's part with nothing but the finishing of one channel with a ball of 6 mm.
fn floor_only(scallop: f64, spacing: Spacing) -> Program {
    let mut program = support::wei_program(&[0]);
    (program.tools, program.operations) = (PrimaryMap::new(), PrimaryMap::new());
    let tool = program.tools.push(support::tool("t1", 1, Cutter::Ball { radius: 3.0 }, 30.0, 42.0));
    let kind = OperationKind::Channel { scallop: Mm(scallop), spacing, method: AxisMethod::Blend };
    program.operations.push(support::operation("channel", kind, tool, vec![0], 8.0));
    program
}

/// Figures of the note: contact length and lower bound of a channel, mm.
fn figures(note: &str) -> [f64; 2] {
    let before = |words: &str| {
        let at = note.find(words).unwrap_or_else(|| panic!("{note}"));
        note[..at].split_whitespace().last().unwrap().parse::<f64>().unwrap()
    };
    [before(" mm of contact"), before(" mm (area")]
}

#[test]
fn scallop_holds_as_proved_and_the_path_is_near_its_lower_bound() {
    let mut program = floor_only(0.012, Spacing::ConstantScallop);
    program.contracts.push(Contract::whole(ContractKind::Excess, 0.012));
    let start = std::time::Instant::now();
    let plan = pipeline::run(&program, &mut Sink::default()).expect("a plan");
    println!("planned in {:?}", start.elapsed());
    let note = &plan.cc.operations[0].notes[1];
    println!("{note}");
    let certificate = certify(&program, &plan.motion, &mut Sink::default()).expect("a certificate");
    let hub = certificate.surfaces.iter().find(|s| s.surface.contains("hub of channel 1")).expect("a hub");
    println!("left {} mm found, {} mm proved, {:?}", hub.excess.value, hub.excess_bound, hub.excess.point);
    let deepest = certificate.surfaces.iter().map(|s| s.gouge_bound).fold(0.0, f64::max);
    println!("deepest cut {deepest} mm proved");
    // The scallop with the interpolation of the machine, by the proof of the verifier; the chord alone cuts.
    assert!(hub.excess_bound <= 0.012, "{}", hub.excess_bound);
    assert!(deepest < 0.0015, "{deepest}");
    // Lengths measured again from the contact points.
    let length: f64 = plan.cc.operations[0].passes.iter().map(|p| contact_length(&program, p)).sum();
    let [told, least] = figures(note);
    assert!((length - told).abs() < 0.1, "{length} {told}");
    assert!(length <= 1.15 * least, "{length} {least}");
}

/// Length of a pass where it lies on the hub between inlet and outlet.
fn contact_length(program: &Program, pass: &CcPass) -> f64 {
    let on = |p: &CcPoint| (0.0..=1.0).contains(&p.u) && program.part.hub.distance(&p.position) < 1e-9;
    pass.points.windows(2).filter(|w| w.iter().all(on)).map(|w| (w[1].position - w[0].position).norm()).sum()
}
