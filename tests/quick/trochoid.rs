//! Trochoidal slots of `jobs/small/trochoidal.imp`: the arc of engagement that the verifier finds on the loops.

use impellerc::base::progress::Progress;
use impellerc::diagnostics::Sink;
use impellerc::driver::{self, Options, Outcome, Stages};
use impellerc::ir::{MoveKind, RoughingStrategy};
use impellerc::plan::passes::pipeline;
use impellerc::verify::stock::{Settings, simulate};

/// Cells of the simulated stock, a twentieth of the diameter of the tool, mm.
const CELL: f64 = 0.06;

#[test]
fn loops_keep_to_their_arc_and_are_one_run() {
    let options = Options { job: "jobs/small/trochoidal.imp".into(), ..Options::default() };
    let program = driver::front(&options, &mut Stages::default(), &mut Outcome::default()).unwrap().unwrap();
    let limit = match program.operations.iter().next().unwrap().1.kind.strategy() {
        Some(RoughingStrategy::Rough { slots, .. }) => slots.engagement().unwrap().deg(),
        _ => panic!("no roughing"),
    };
    let mut sink = Sink::default();
    let plan = pipeline::run(&program, &mut sink).unwrap();
    let mut settings = Settings { cell: Some(CELL), ..Settings::default() };
    let stock = simulate(&program, &plan.motion, &mut settings, &Progress::default(), &mut sink).unwrap();
    let (operation, found) = (&plan.motion.operations[0], &stock.operations[0]);
    let (mut largest, mut cuts, mut returns) = ([0.0_f64; 2], 0, 0.0);
    let (mut loops, mut rapids) = (0.0, Vec::new());
    for (i, m) in operation.moves.iter().enumerate() {
        if !operation.labels[m.pass as usize].ends_with("slot") {
            continue;
        }
        loops += m.time;
        match m.kind {
            MoveKind::Cut => {
                cuts += usize::from(found.moves[i].arc.get() > 0.0);
                largest[0] = largest[0].max(found.moves[i].arc.get());
            }
            // Links go through what is cut.
            MoveKind::Link => {
                returns += m.time;
                largest[1] = largest[1].max(found.moves[i].arc.get());
            }
            MoveKind::Rapid => rapids.push(m.pass),
        }
    }
    println!("{:?}", plan.cl.operations[0].notes);
    println!("{cuts} cuts, {loops:.0} s, {returns:.0} s at link feed; largest arcs {largest:.1?} of {limit:.0} deg");
    assert!(cuts > 200, "{cuts}");
    assert!(largest[0] <= limit && largest[0] > 0.6 * limit, "{largest:?}");
    assert!(returns > 0.05 * loops, "{returns} of {loops}");
    // A slot is one run: at rapid the tool only approaches it, and leaves it.
    let passes: std::collections::BTreeSet<u32> = rapids.iter().copied().collect();
    assert!(rapids.len() <= 4 * passes.len().max(1), "{} rapids of {} slots", rapids.len(), passes.len());
    let removed = 100.0 * found.by_links.get() / found.removed.get();
    assert!(removed < 0.1, "links remove {removed} % of the stock");
}
