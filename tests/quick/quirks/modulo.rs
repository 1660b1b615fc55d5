//! Axes whose words a control reduces modulo 360 deg: a path that winds such an axis through several turns is written in
//! words within one turn, and read as what it was.

use super::{Step, fanuc, operation, program, splines};
use crate::bad_nc::{HEIDENHAIN, SIEMENS};
use impellerc::diagnostics::Sink;
use impellerc::five_axis::Machine;
use impellerc::five_axis::control::ModuloWay;
use impellerc::ir::{Motion, Program};
use impellerc::nc::{self, Direction};
use impellerc::wheel::control::Orientation;

/// The machine with a table C that turns without end.
fn endless(machine: &Machine, way: ModuloWay) -> Machine {
    let mut machine = machine.clone();
    let [_, c] = &mut machine.rotary;
    (c.min, c.max, c.modulo) = (f64::NEG_INFINITY, f64::INFINITY, Some(way));
    machine
}

fn on_endless(dialect: &str, way: ModuloWay) -> Program {
    let program = program(dialect);
    Program { machine: endless(&program.machine, way), ..program }
}

/// C goes up by three turns and down by seven, in steps of less than a quarter turn; each fifth move is a rapid.
fn winding(from: f64) -> Vec<Step> {
    let up = (0..=27).map(|k| 40.0 * f64::from(k));
    let down = (1..=72).map(|k| 1080.0 - 35.0 * f64::from(k));
    let step = |(k, c): (u32, f64)| {
        let feed = (k % 5 > 0).then_some(900.0);
        ([50.0 - 0.3 * f64::from(k), -40.0, 10.0 + 0.2 * f64::from(k)], [30.0, from + c], feed)
    };
    (0..).zip(up.chain(down)).map(step).collect()
}

/// A program with some blocks in the place of its moves.
fn text(dialect: &str, blocks: &[String]) -> String {
    let (whole, first, last) = match dialect {
        "siemens-840d" => (SIEMENS.replace("C=20 D0", "C=DC(20) D0"), "N120", "N160"),
        "heidenhain" => (HEIDENHAIN.to_owned(), "18 ", "22 "),
        _ => (fanuc::PROGRAM.to_owned(), "G0 X50.", "G49\nG05.1"),
    };
    let [first, last] = [first, last].map(|start| whole.find(&format!("\n{start}")).unwrap() + 1);
    let all = format!("{}{}\n{}", &whole[..first], blocks.join("\n"), &whole[last..]);
    if dialect != "heidenhain" {
        return all;
    }
    // Every block has its number.
    let mut number = 0;
    let numbered = all.lines().map(|line| {
        if line.starts_with(' ') {
            return format!("{line}\n");
        }
        let block = line.trim_start_matches(|c: char| c.is_ascii_digit()).trim_start();
        number += 1;
        format!("{} {block}\n", number - 1)
    });
    numbered.collect()
}

fn blocks(program: &Program, moves: &[Step]) -> Vec<String> {
    let mut blocks = Vec::new();
    let operation = operation(program, moves);
    nc::find(&program.post.dialect).unwrap().moves(program, &operation, "", &mut |text, _| blocks.push(text));
    blocks
}

/// Degrees of the words of C in blocks.
fn words(blocks: &[String]) -> Vec<f64> {
    let word = |block: &String| {
        let text = block.split(' ').find(|word| word.starts_with('C') && !word.starts_with("C3="))?;
        let number = text.trim_start_matches(|c: char| !(c.is_ascii_digit() || c == '-')).trim_end_matches(')');
        Some(number.parse().unwrap_or_else(|_| panic!("{block}")))
    };
    blocks.iter().filter_map(word).collect()
}

#[test]
fn a_path_that_winds_is_read_as_it_was() {
    // The text begins within the first turn, whatever the motion: 20 deg on the way up, and five turns lower.
    for from in [20.0, 20.0 - 1800.0] {
        for (dialect, orientation) in [
            ("siemens-840d", Orientation::Angles),
            ("siemens-840d", Orientation::Vectors),
            ("heidenhain", Orientation::Angles),
            ("heidenhain", Orientation::Vectors),
            ("fanuc", Orientation::Angles),
        ] {
            let mut program = on_endless(dialect, ModuloWay::Shortest);
            program.post.control.orientation = orientation;
            let moves = winding(from);
            let motion = Motion { operations: vec![operation(&program, &moves)] };
            let post = nc::find(dialect).unwrap();
            let mut sink = Sink::default();
            post.check(&program, &motion, &mut sink);
            // The stations of this operation stand elsewhere: only its own blocks are looked at.
            let own = |d: &&impellerc::diagnostics::Diag| d.code.id() != "IMP0811" && d.code.id() != "IMP0803";
            assert!(sink.diags().iter().find(own).is_none(), "{dialect}: {:?}", sink.diags());
            let mut blocks = blocks(&program, &moves);
            // Fanuc turns the tables to the first station before.
            blocks.retain(|block| dialect != "fanuc" || !block.contains(" X0. Y0. Z0. "));
            let words = words(&blocks);
            assert!(words.len() >= 20 && words.iter().all(|c| (0.0..360.0).contains(c)), "{dialect}: {words:?}");
            let text = text(dialect, &blocks);
            let sections = post.read(&text, &program.machine).unwrap_or_else(|e| panic!("{dialect}: {e:?}\n{text}"));
            let read = &sections[0].moves;
            assert_eq!(read.len(), moves.len(), "{dialect}");
            let mut turns = None;
            for (m, (_, [a, c], feed)) in read.iter().zip(&moves) {
                match m.direction {
                    Direction::Rotary([first, second]) => {
                        let off = second.to_degrees() - c;
                        let turns = *turns.get_or_insert((off / 360.0).round());
                        assert!((first.to_degrees() - a).abs() < 1e-4, "{dialect}: {first}");
                        assert!((off - 360.0 * turns).abs() < 1e-4, "{dialect} line {}: {off} at {c}", m.line);
                    }
                    Direction::Axis(_) => assert!(orientation == Orientation::Vectors && feed.is_some()),
                }
            }
        }
    }
}

#[test]
fn half_a_turn_and_foreign_words_are_refused() {
    let said = |dialect: &str, block: &str| {
        let machine = endless(&program(dialect).machine, ModuloWay::Shortest);
        let faults = nc::find(dialect).unwrap().read(&text(dialect, &[block.to_owned()]), &machine);
        faults.map_or_else(|faults| faults[0].reason.clone(), |_| "read".to_owned())
    };
    let of = |dialect: &str, c: &str| match dialect {
        "siemens-840d" => said(dialect, &format!("G0 X50 Y-40 Z10 A=30 C={c}")),
        "heidenhain" => said(dialect, &format!("0 L X+50 Y-40 Z+10 A+30 C{c} R0 FMAX")),
        _ => said(dialect, &format!("G0 X50. Y-40. Z60. A0. C{c}")),
    };
    // From 20 deg, for Fanuc from 0.
    for (dialect, c) in [("siemens-840d", "DC(200)"), ("heidenhain", "+200"), ("fanuc", "180.")] {
        assert!(of(dialect, c).contains("both ways are as short"), "{dialect}: {}", of(dialect, c));
    }
    for (dialect, c) in [("siemens-840d", "DC(199.99)"), ("heidenhain", "+200.01"), ("fanuc", "179.99")] {
        assert_eq!(of(dialect, c), "read", "{dialect}");
    }
    for (dialect, c) in [("siemens-840d", "DC(380)"), ("heidenhain", "-10"), ("fanuc", "360.")] {
        assert!(of(dialect, c).contains("modulo 360 deg"), "{dialect}: {}", of(dialect, c));
    }
    for c in ["20", "20+R1", "ACP(20)"] {
        assert_ne!(of("siemens-840d", c), "read", "{c}");
    }
    assert!(of("siemens-840d", "20").contains("write `C=DC(...)`"), "{}", of("siemens-840d", "20"));
    let limited = program("siemens-840d").machine;
    let faults = nc::find("siemens-840d").unwrap().read(&SIEMENS.replace("C=20", "C=DC(20)"), &limited).unwrap_err();
    assert!(faults[0].reason.contains("is no axis modulo 360 deg"), "{faults:?}");
}

/// Behind polynomials, which turn the tool by a second point of its axis, the reader knows where the axis stands.
#[test]
fn an_axis_is_followed_through_polynomials() {
    let machine = endless(&program("siemens-840d").machine, ModuloWay::Shortest);
    let text = splines::poly()
        .replace("C=20", "C=DC(20)")
        .replace("N154 G1 ORIAXES\n", "N154 G1 ORIAXES\nN155 G1 X26 Y-20 Z3 A=32 C=DC(359) F250\n");
    let sections = nc::find("siemens-840d").unwrap().read(&text, &machine).unwrap();
    let Direction::Rotary([_, c]) = sections[0].moves.last().unwrap().direction else { panic!("{sections:?}") };
    assert!((c.to_degrees() + 1.0).abs() < 1e-9, "{c}");
}

/// A post takes an axis modulo 360 deg whose control goes the shorter way to its words, and no half turns of it.
#[test]
fn posts_say_what_they_do_not_take() {
    use ModuloWay::{Direct, Shortest, Sign};
    let codes = |dialect: &str, way: ModuloWay, turn: f64| {
        let program = on_endless(dialect, way);
        let moves = [([50.0, -40.0, 10.0], [30.0, 0.0], None), ([50.0, -40.0, 12.0], [30.0, turn], Some(900.0))];
        let mut operation = operation(&program, &moves);
        // Without stations elsewhere.
        operation.moves.pop();
        let mut sink = Sink::default();
        nc::find(dialect).unwrap().check(&program, &Motion { operations: vec![operation] }, &mut sink);
        sink.diags().iter().map(|d| d.code.id()).filter(|code| *code != "IMP0803").collect::<Vec<_>>()
    };
    for dialect in ["siemens-840d", "heidenhain", "fanuc"] {
        assert!(codes(dialect, Shortest, 80.0).is_empty(), "{dialect}");
        assert_eq!(codes(dialect, Shortest, 180.0), ["IMP0811"], "{dialect}");
        assert_eq!(codes(dialect, Sign, 80.0), ["IMP0809"], "{dialect}");
    }
    assert_eq!(codes("siemens-840d", Direct, 80.0), codes("heidenhain", Direct, 80.0));
    assert_eq!(codes("fanuc", Direct, 80.0), ["IMP0809"]);
    assert_eq!(codes("mitsubishi", Shortest, 80.0), ["IMP0809"]);
    assert_eq!(codes("linuxcnc", Shortest, 80.0), ["IMP0809"]);
    assert!(codes("apt-cl", Sign, 80.0).is_empty());
    // What the proof assumes of the axis stands in the head.
    for dialect in ["siemens-840d", "heidenhain", "fanuc"] {
        let program = on_endless(dialect, Shortest);
        let assumed = nc::assumptions(nc::find(dialect).unwrap(), &program);
        assert!(assumed.iter().any(|what| what.starts_with("C is an axis modulo 360 deg")), "{assumed:?}");
    }
}
