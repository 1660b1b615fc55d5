//! Roughing that goes on after a tool broke half way.

use crate::support::jobs::{self, Compiled, simulated};
use impellerc::diagnostics::{Sink, codes};
use impellerc::ir::{Motion, Program};
use impellerc::plan::passes::pipeline;
use impellerc::tool_stock::stock::{Field, stl};
use std::sync::{Arc, LazyLock};

/// Cells of the mesh, mm: what the documents advise on a part of this size.
const CELL: f64 = 0.25;

/// The shipped job, all sectors, with all its contracts.
static WHOLE: LazyLock<Compiled> = LazyLock::new(|| Compiled::new(jobs::program("rough", None)));

fn started(program: &Program, field: &Field) -> Program {
    let mut program = program.clone();
    program.stock.left = Some(Arc::new(stl::read(&field.mesh().stl("left")).expect("a closed mesh")));
    assert!(program.stock.farthest_out(0.5).is_none());
    program
}

#[test]
fn roughing_goes_on_from_any_block() {
    let whole = &*WHOLE;
    let (program, motion) = whole.planned();
    let (due, _) = simulated(program, motion, CELL);
    let rest = |c: &Compiled| c.certificate.rest.last().expect("roughing").most.get();
    for share in [0.02, 0.5] {
        let mut broken = Motion { operations: vec![motion.operations[0].clone()] };
        let count = broken.operations[0].moves.len();
        broken.operations[0].moves.truncate((share * count as f64) as usize);
        let (report, field) = simulated(program, &broken, CELL);
        // Planned, and verified with all contracts: this fails otherwise.
        let again = Compiled::new(started(program, &field));
        let (found, _) = simulated(&again.program, &again.plan.motion, CELL);
        let cut = |c: &Compiled| c.plan.motion.operations[0].moves.len();
        println!(
            "broken after {:.0} of {:.0} mm3: {} instead of {} moves, rest {:.3} instead of {:.3} mm, {:.0} instead of {:.0} mm3",
            report.operations[0].removed.get(),
            due.operations[0].removed.get(),
            cut(&again),
            cut(whole),
            rest(&again),
            rest(whole),
            found.rest().get(),
            due.rest().get()
        );
        // What is left at the end is what the whole run leaves: volumes differ by the edges that the mesh rounds, at the
        // start, and the thickest rest by less than a cell.
        let rounded = (report.rest().get() - found.blank.get()).abs();
        assert!(
            (found.rest().get() - due.rest().get()).abs() < rounded + 0.003 * due.rest().get(),
            "{} {}",
            found.rest().get(),
            due.rest().get()
        );
        assert!((rest(&again) - rest(whole)).abs() < CELL);
        // The second tool finds its rest as before, and the first is not sent where it has been.
        assert!(
            (found.operations[1].removed.get() - due.operations[1].removed.get()).abs()
                < 0.25 * due.operations[1].removed.get()
        );
        let left = 1.0 - report.operations[0].removed.get() / due.operations[0].removed.get();
        assert!((cut(&again) as f64) < (left + 0.15) * cut(whole) as f64, "{} moves of {}", cut(&again), cut(whole));
        assert!(found.collisions().next().is_none());
    }
}

/// After the first operation was done, it finds next to nothing, and a remark or an error says so.
#[test]
fn a_finished_operation_finds_nothing() {
    let (program, motion) = WHOLE.planned();
    let first = Motion { operations: vec![motion.operations[0].clone()] };
    let (report, field) = simulated(program, &first, CELL);
    let again = started(program, &field);
    let mut sink = Sink::default();
    match pipeline::run(&again, &mut sink) {
        Err(_) => assert!(sink.diags().iter().any(|d| d.code == codes::planning::NO_REST)),
        Ok(plan) => {
            let (found, _) = simulated(&again, &plan.motion, CELL);
            println!(
                "removed again {:.1} of {:.1} mm3",
                found.operations[0].removed.get(),
                report.operations[0].removed.get()
            );
            assert!(found.operations[0].removed.get() < 0.005 * report.operations[0].removed.get());
        }
    }
}
