//! What a control has no words for, where no job shows it: each refusal has its code, a place and a way out.

use super::{Step, operation, program};
use impellerc::base::entity::PrimaryMap;
use impellerc::diagnostics::Sink;
use impellerc::ir::{Motion, Program, Tool};
use impellerc::nc;
use impellerc::wheel::control::Orientation;

/// The only refusal of a motion: its code and its message.
fn refusal(program: &Program, moves: &[Step]) -> (&'static str, String) {
    let motion = Motion { operations: vec![operation(program, moves)] };
    let mut sink = Sink::default();
    nc::find(&program.post.dialect).unwrap().check(program, &motion, &mut sink);
    let [diag] = sink.diags() else { panic!("{:?}", sink.diags()) };
    assert!(diag.help.is_some() && !diag.labels.is_empty(), "{diag:?}");
    (diag.code.id(), diag.message.clone())
}

const CUT: [Step; 2] = [([50.0, -40.0, 10.0], [30.0, 0.0], None), ([50.0, -40.0, 12.0], [30.0, 20.0], Some(900.0))];

#[test]
fn vectors_that_fit_two_positions_are_refused() {
    for dialect in ["siemens-840d", "heidenhain", "apt-cl"] {
        let mut program = program(dialect);
        program.post.control.orientation = Orientation::Vectors;
        let around = [CUT[0], ([50.0, -40.0, 12.0], [30.0, 100.0], Some(900.0))];
        let through = [CUT[0], ([50.0, -40.0, 12.0], [-2.0, 0.0], Some(900.0))];
        for moves in [around, through] {
            let (code, said) = refusal(&program, &moves);
            assert!(code == "IMP0803" && said.contains("turns C by"), "{dialect}: {said}");
        }
    }
}

#[test]
fn a_turn_on_the_spot_has_no_feed() {
    for dialect in ["siemens-840d", "heidenhain", "fanuc", "mitsubishi", "apt-cl"] {
        let still = [CUT[0], ([50.0, -40.0, 10.0], [30.0, 20.0], Some(900.0))];
        let (code, said) = refusal(&program(dialect), &still);
        assert!(code == "IMP0804" && said.contains("without moving its tip"), "{dialect}: {said}");
    }
}

/// Jobs take tool numbers up to 9999; only Fanuc has fewer, which an example shows.
#[test]
fn tool_numbers_beyond_the_table_are_refused() {
    for (dialect, number) in
        [("heidenhain", 32_768), ("heidenhain", 0), ("fanuc", 1000), ("mitsubishi", 1000), ("apt-cl", 0)]
    {
        let program = program(dialect);
        let mut tools = PrimaryMap::new();
        for (_, tool) in program.tools.iter() {
            tools.push(Tool { number, ..tool.clone() });
        }
        let program = Program { tools, ..program };
        let (code, said) = refusal(&program, &CUT);
        assert!(code == "IMP0802" && said.contains(&format!("has the number {number}")), "{dialect}: {said}");
    }
}
