//! Feeds that keep the removal rate of a tool and the power of the spindle.

use crate::support;
use impellerc::base::entity::PrimaryMap;
use impellerc::base::progress::Progress;
use impellerc::base::units::{Mm3PerMin, Share};
use impellerc::diagnostics::Sink;
use impellerc::ir::{MoveKind, Program, Tool};
use impellerc::plan::passes::pipeline::{self, Plan};
use impellerc::verify::dynamics::{MotionLimit, run};
use impellerc::verify::stock::{OperationStock, Settings, simulate};
use impellerc::wheel::material::Material;

/// Cells of the verifier, mm: not those of the planner.
const CELL: f64 = 0.3;

fn planned(program: &Program) -> Plan {
    let mut sink = Sink::default();
    pipeline::run(program, &mut sink).unwrap_or_else(|_| panic!("no plan: {:?}", sink.diags()))
}

/// The stock of the only operation, as the verifier simulates it.
fn simulated(program: &Program, plan: &Plan) -> OperationStock {
    let mut settings = Settings { cell: Some(CELL), ..Settings::default() };
    let report = simulate(program, &plan.motion, &mut settings, &Progress::default(), &mut Sink::default());
    report.expect("a stock").operations.swap_remove(0)
}

fn limited(program: &Program, max_rate: f64) -> Program {
    let mut tools = PrimaryMap::new();
    for (_, tool) in program.tools.iter() {
        tools.push(Tool { max_rate: Some(Mm3PerMin(max_rate)), ..tool.clone() });
    }
    Program { tools, ..program.clone() }
}

/// Finishing lines in the full blank cut large sections, and smaller ones beside the lines before.
#[test]
fn feeds_keep_the_removal_rate_and_the_power() {
    let program = support::channel_only(0.2);
    let free = simulated(&program, &planned(&program));
    let most = free.rate.expect("cuts").by_minute().value;
    let limit = 0.4 * most;

    let within = limited(&program, limit);
    let plan = planned(&within);
    let kept = simulated(&within, &plan);
    let rate = kept.rate.expect("cuts").by_minute().value;
    println!("largest rate {most:.0} mm3/min without a limit; {rate:.0} with the limit {limit:.0}");
    assert!(rate <= limit && rate > 0.85 * limit, "{rate} of {limit}");
    assert!((kept.removed.get() - free.removed.get()).abs() < 1e-6 * free.removed.get(), "the paths are the same");
    // Blocks with small chips keep their feed.
    let cuts = plan.motion.operations[0].moves.iter().filter(|m| m.kind == MoveKind::Cut);
    let (fast, all) = cuts.fold((0, 0), |(fast, all), m| (fast + usize::from(m.feed > Some(200.0)), all + 1));
    println!("{fast} of {all} cutting blocks keep at least 200 of 250 mm/min");
    assert!(fast > all / 10 && fast < all, "{fast} of {all}");

    // The lower feeds count for the removal, not for the feed of the block.
    let shares = |removal: &[Share]| {
        let run = run(&within, &plan.motion, 0, removal);
        [MotionLimit::Removal, MotionLimit::BlockFeed].map(|limit| {
            let own = run.limits.iter().filter(|l| l.limit == limit);
            own.map(|l| l.time[0].get()).sum::<f64>() / run.time[0].get()
        })
    };
    let ([removal, block], [none, all]) = (shares(&kept.removal), shares(&[]));
    println!("cuts: removal {removal:.3}, block feed {block:.3}; {all:.3} by blocks alone");
    assert!(all > 0.05 && none == 0.0, "{all} {none}");
    assert!(removal > 0.9 * all && (removal + block - all).abs() < 0.05 * all, "{removal} {block} {all}");
    assert!(free.removal.is_empty(), "no limit");

    let mut strong = program.clone();
    strong.stock.material = Some(Material::Titanium);
    let needed = simulated(&strong, &planned(&strong)).power.expect("a material").value.get();
    strong.machine.power = Some(0.5 * needed);
    let power = simulated(&strong, &planned(&strong)).power.expect("a material").value.get();
    println!("largest power {needed:.3} kW without a limit; {power:.3} kW with half of it");
    assert!(power <= 0.5 * needed && power > 0.4 * needed, "{power} of {needed}");
}
