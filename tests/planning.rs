//! Planning of the paper's part.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "figures of a run are shown with --nocapture")]

mod support;

use impellerc::diag::Sink;
use impellerc::ir::MoveKind;
use impellerc::passes::pipeline;

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
        let length: f64 = cl.moves.windows(2).map(|m| (m[1].to.tip - m[0].to.tip).norm()).sum();
        let time: f64 = motion.moves.iter().map(|m| m.time).sum();
        let slow = motion.moves.iter().filter(|m| m.kind == MoveKind::Cut).filter_map(|m| m.feed).fold(1e9, f64::min);
        println!(
            "{name}: {} passes, {} moves, {length:.0} mm, {:.1} min, slowest {slow:.1}",
            cl.passes.len(),
            cl.moves.len(),
            time / 60.0
        );
        for note in &cl.notes {
            println!("    {note}");
        }
    }
    assert_eq!(plan.motion.operations.len(), 6);
}
