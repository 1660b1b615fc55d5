//! Roughing jobs that cannot be done: each is refused at once, for the true reason, with a way out.
//! `tests/slow/refused_roughing.rs` follows the ways out to a plan.

use crate::support::jobs::{self, errors, number_behind, rough_with};
use impellerc::diagnostics::codes::{geometry, kinematics, orientation, planning};
use impellerc::diagnostics::{Severity, Sink};
use impellerc::ir::Program;
use impellerc::plan::passes::pipeline;

const T1: &str = "tool t1 = flat { diameter 2 mm";
const T2: &str = "tool t2 = ball { diameter 2 mm";
const BODY: &str = "flute 12 mm  reach 25 mm";

#[test]
fn tools_that_are_too_wide_for_every_level() {
    let outcome = rough_with(&[(T1, "tool t1 = flat { diameter 14 mm"), (T2, "tool t2 = ball { diameter 14 mm")]);
    let found = errors(&outcome);
    assert!(found.len() == 1 && found[0].code == planning::TOOL_TOO_LARGE, "{found:?}");
    // The narrowest place of the part, by `facts` and by the map of distances of the paper's part at 0.4 of its size.
    assert!((number_behind(&found[0].message, "throat of the channel is") - 0.4 * 8.983).abs() < 0.01, "{found:?}");
    assert!(found[0].place.is_some() && found[0].help.as_ref().unwrap().contains("tool of at most"), "{found:?}");
}

#[test]
fn a_channel_too_narrow_for_the_tools() {
    let outcome = rough_with(&[("vanes 8", "vanes 16")]);
    let found = errors(&outcome);
    assert!(found.len() == 1 && found[0].code == planning::TOOL_TOO_LARGE, "{found:?}");
    let help = found[0].help.as_ref().unwrap();
    let most = number_behind(help, "a fillet of at most");
    let width = number_behind(&found[0].message, "the channel is");
    assert!(most > 0.2 && 2.0 * most < width, "{most} {width}");
    // With this fillet, what is left is the size of the tools.
    let outcome = rough_with(&[("vanes 8", "vanes 16"), ("fillet 1.2 mm", &format!("fillet {most} mm"))]);
    let found = errors(&outcome);
    assert!(
        found.iter().all(|d| d.help.as_ref().is_none_or(|help| !help.contains("a fillet of at most"))),
        "{found:?}"
    );
}

#[test]
fn a_blank_far_over_the_shroud() {
    let outcome = rough_with(&[("over shroud 0 mm", "over shroud 20 mm")]);
    let found = errors(&outcome);
    assert!(found.len() == 1 && found[0].code == geometry::STOCK_HIGH, "{found:?}");
    // Half of the depth that a flat tool of 2 mm takes by default.
    assert_eq!(number_behind(found[0].help.as_ref().unwrap(), "`over shroud"), 0.375);
}

#[test]
fn a_blank_smaller_than_the_part() {
    let outcome = rough_with(&[("back -16 mm", "back -10 mm")]);
    let found = errors(&outcome);
    assert!(found.len() == 1 && found[0].code == geometry::STOCK, "{found:?}");
    let back = number_behind(found[0].help.as_ref().unwrap(), "`back");
    // The lowest point of the curves of the hub is at -13.042 mm.
    assert!(back < -13.042 && back > -13.07, "{back}");
}

/// One error for each of both operations, with the place and what is too near.
fn is_refused_for_its_holder(changes: &[(&str, &str)]) {
    let outcome = rough_with(changes);
    let found = errors(&outcome);
    assert_eq!(found.iter().map(|d| d.code).collect::<Vec<_>>(), [orientation::COLLISION; 2], "{found:?}");
    for (error, operation) in found.iter().zip(["`rough`", "`rough2`"]) {
        println!("{} {:?}", error.message, error.help);
        assert!(error.message.contains(operation) && error.message.contains("its holder would be"), "{error:?}");
        assert!(number_behind(&error.message, "its holder would be") > 1.0, "{error:?}");
        assert!(error.place.is_some() && error.help.as_ref().unwrap().contains("reach of"), "{error:?}");
    }
}

#[test]
fn no_tool_reaches_the_floor() {
    is_refused_for_its_holder(&[(BODY, "flute 6 mm  reach 8 mm")]);
    is_refused_for_its_holder(&[(BODY, "flute 3 mm  reach 4 mm")]);
}

#[test]
fn a_holder_that_does_not_go_into_the_channel() {
    is_refused_for_its_holder(&[(BODY, "flute 4 mm  reach 8 mm"), ("er16-mini", "er32")]);
}

/// A machine that is too small for the part is told before finishing is planned, with the travel that the program needs.
#[test]
fn a_machine_that_is_too_small() {
    let mut program = jobs::program("rough", None);
    let needed = |program: &Program| {
        let mut sink = Sink::default();
        let planned = pipeline::run(program, &mut sink).is_ok();
        let error = sink.diags().iter().find(|d| d.severity == Severity::Error).cloned();
        assert!(planned == error.is_none(), "{error:?}");
        error.map(|error| {
            assert!(
                error.code == kinematics::OUT_OF_TRAVEL && error.message.starts_with("`rough` needs Y = "),
                "{error:?}"
            );
            number_behind(error.help.as_ref().unwrap(), "a machine on which Y travels to")
        })
    };
    (program.machine.linear[1].min, program.machine.linear[1].max) = (-10.0, 10.0);
    let most = needed(&program).unwrap().abs();
    (program.machine.linear[1].min, program.machine.linear[1].max) = (-most, most);
    assert!(most > 30.0 && needed(&program).is_none(), "{most}");
}
