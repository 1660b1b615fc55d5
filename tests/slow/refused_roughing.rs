//! Ways out of refused roughing jobs, followed until a plan keeps all contracts.

use crate::support::jobs::{errors, number_behind, rough_with};
use impellerc::diagnostics::codes::verification;
use impellerc::driver::Outcome;

const T1: &str = "tool t1 = flat { diameter 2 mm";
const T2: &str = "tool t2 = ball { diameter 2 mm";
const BODY: &str = "flute 12 mm  reach 25 mm";

fn help(outcome: &Outcome, index: usize) -> String {
    errors(outcome)[index].help.clone().expect("a way out")
}

fn is_planned(changes: &[(&str, &str)]) {
    let outcome = rough_with(changes);
    assert!(errors(&outcome).is_empty() && !outcome.contracts.is_empty(), "{changes:?}: {:?}", errors(&outcome));
}

/// A flat tool alone leaves the fillets, and the next message asks for another tool: with the ball of the job it is enough.
#[test]
fn the_widest_tool_that_fits() {
    let only = |t1: &str| {
        let text = format!("tool t1 = flat {{ diameter {t1} mm");
        rough_with(&[(T1, &text), ("tools t1, t2 ", "tools t1 "), ("tool t2", "tool t0")])
    };
    let most = number_behind(&help(&only("14"), 0), "a flat tool of at most");
    let alone = only(&most.to_string());
    let found = errors(&alone);
    assert!(found.len() == 1 && found[0].code == verification::REST, "{found:?}");
    assert!(help(&alone, 0).contains("another roughing tool"));
    is_planned(&[(T1, &format!("tool t1 = flat {{ diameter {most} mm"))]);
}

/// The two tools rough one of sixteen narrow channels; the others stay full, so that the contract on the rest is left out.
/// `tests/quick/cost.rs` has the memory for all of them.
#[test]
fn the_tool_for_a_narrow_channel() {
    let narrow = ("vanes 8", "vanes 16");
    // Two fillets do not fit into so narrow a channel; with those that fit, the tool is what is too large.
    let most = number_behind(&help(&rough_with(&[narrow]), 0), "a fillet of at most");
    let fillet = format!("fillet {most} mm");
    let fits = ("fillet 1.2 mm", fillet.as_str());
    let most = number_behind(&help(&rough_with(&[narrow, fits]), 0), "a ball tool of at most");
    let one = [("hub 0.4 mm", "hub 0.4 mm  sectors 1"), ("require rest      <= 0.8 mm", "")];
    is_planned(&[narrow, fits, (T2, &format!("tool t2 = ball {{ diameter {most} mm")), one[0], one[1]]);
}

#[test]
fn a_blank_turned_as_told() {
    let high = rough_with(&[("over shroud 0 mm", "over shroud 20 mm")]);
    let over = number_behind(&help(&high, 0), "`over shroud");
    is_planned(&[("over shroud 0 mm", &format!("over shroud {over} mm"))]);
    let short = rough_with(&[("back -16 mm", "back -10 mm")]);
    let back = number_behind(&help(&short, 0), "`back");
    is_planned(&[("back -16 mm", &format!("back {back} mm"))]);
}

/// Flutes and reach that a message names, or the flutes of the job where it names a reach alone.
fn named(help: &str, flutes: f64) -> String {
    let flutes = if help.contains("flutes of") { number_behind(help, "flutes of") } else { flutes };
    format!("flute {flutes} mm  reach {} mm", number_behind(help, "reach of"))
}

#[test]
fn the_reach_that_is_named() {
    for (flutes, reach, holder) in [(6.0, 8.0, "er16-mini"), (3.0, 4.0, "er16-mini"), (4.0, 8.0, "er32")] {
        let body = format!("flute {flutes} mm  reach {reach} mm");
        let refused = rough_with(&[(BODY, &body), ("er16-mini", holder)]);
        let bodies = [0, 1].map(|k| named(&help(&refused, k), flutes));
        println!("{body}, {holder}: {bodies:?}");
        // The tools stand in two lines.
        let [one, other] = [(T1, &bodies[0]), (T2, &bodies[1])]
            .map(|(tool, body)| [format!("{tool}  flutes 4  {BODY}"), format!("{tool}  flutes 4  {body}")]);
        is_planned(&[(&one[0], &one[1]), (&other[0], &other[1]), ("er16-mini", holder)]);
    }
}
