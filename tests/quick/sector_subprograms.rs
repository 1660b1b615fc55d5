//! What sectors repeat as a subprogram: the text means the motion of the inline text, and a broken text is refused.

use crate::support::{self, golden, jobs::Compiled};
use impellerc::base::source::Span;
use impellerc::diagnostics::{Severity, Sink};
use impellerc::five_axis::{Carries, Chain};
use impellerc::ir::{Motion, Program};
use impellerc::nc::compare::ComparedMotion;
use impellerc::nc::{self, NcMove, NcProgram, motion_of::motion_of, sectors};
use impellerc::nc_text::compare;
use impellerc::report::source_map::{LaidMap, SourceMapFile, WrittenLine};
use impellerc::verify::verify;
use impellerc::wheel::control::{Orientation, Sectors};
use std::sync::LazyLock;

/// Sectors of the job: some of them reach the travel of C, so that they take the other branch.
const SECTORS: [u32; 4] = [0, 1, 3, 5];

/// Both faces of four vanes, planned once for each dialect with subprograms.
static COMPILED: LazyLock<[Compiled; 2]> = LazyLock::new(|| {
    ["siemens-840d", "linuxcnc"].map(|dialect| {
        let mut program = support::program_for(dialect, &support::flank_only(&SECTORS));
        program.post.control.sectors = Sectors::Subprogram;
        Compiled::new(program)
    })
});

/// A program with its motion, and another way to state the tool direction.
fn cases() -> [(&'static Compiled, Program); 3] {
    let [siemens, linuxcnc] = &*COMPILED;
    let by_angles = {
        let mut program = siemens.program.clone();
        program.post.control.orientation = Orientation::Angles;
        program
    };
    [(siemens, siemens.program.clone()), (siemens, by_angles), (linuxcnc, linuxcnc.program.clone())]
}

fn written(compiled: &Compiled, program: &Program) -> NcProgram {
    let post = nc::find(&program.post.dialect).unwrap();
    let mut sink = Sink::default();
    post.check(program, &compiled.motion, &mut sink);
    sectors::remark(post, program, &compiled.motion, &mut sink);
    assert!(sink.diags().is_empty(), "{:?}", sink.diags());
    nc::emit(post, program, &compiled.motion, &[])
}

/// The texts with subprograms, with their jobs.
pub fn texts() -> Vec<(Program, String)> {
    let text = |(compiled, program): (&Compiled, Program)| {
        let text = written(compiled, &program).text();
        (program, text)
    };
    cases().into_iter().map(text).collect()
}

fn inline(program: &Program) -> Program {
    let mut program = program.clone();
    program.post.control.sectors = Sectors::Inline;
    program
}

/// The motion that a text means.
fn meant(program: &Program, text: &str) -> Result<Motion, String> {
    let post = nc::find(&program.post.dialect).unwrap();
    let sections = post.read(text, &program.machine).map_err(|faults| {
        let first = &faults[0];
        format!("line {}: {}", first.line, first.reason)
    })?;
    let mut sink = Sink::default();
    let motion = motion_of(program, &sections, &|_| Span::default(), &mut sink);
    match motion {
        Some(found) if !sink.has_errors() => Ok(found.motion),
        _ => Err(sink.diags()[0].message.clone()),
    }
}

#[test]
fn a_text_with_subprograms_is_the_inline_text_for_the_machine() {
    for (compiled, program) in cases() {
        let post = nc::find(&program.post.dialect).unwrap();
        let short = written(compiled, &program);
        let long = written(compiled, &inline(&program));
        let lines = [&short, &long].map(|nc| nc.lines.len());
        println!("{} by {}: {lines:?} lines", post.name(), program.post.control.orientation.name());
        // Four sectors are little more than one, or than two where sectors have two branches.
        assert!(lines[0] * 2 < lines[1], "{lines:?}");
        for nc in [&short, &long] {
            let found = nc::read_back(post, &program, &compiled.motion, &nc.text());
            let found = found.unwrap_or_else(|d| panic!("{}: {}", post.name(), d.reason));
            assert!(found.tip <= 0.5e-4 * 2f64.sqrt() + 1e-6, "{found:?}");
        }
        let motions = [&short, &long].map(|nc| meant(&program, &nc.text()).unwrap());
        for o in compare([0, 1].map(|k: usize| ComparedMotion { program: &program, motion: &motions[k] })) {
            println!("tip {} mm, axis {} deg, speed {}", o.tip.value, o.axis.value, o.speed.value);
            assert!(o.is_same() && o.moves[0] == o.moves[1], "{o:?}");
        }
    }
}

#[test]
fn every_move_has_its_line() {
    for (compiled, program) in cases() {
        let nc = written(compiled, &program);
        let mut moves: Vec<u32> = Vec::new();
        for line in &nc.lines {
            assert!(line.again.is_empty() || line.source.is_some());
            moves.extend(line.source.map(|(_, index)| index));
            moves.extend(&line.again);
        }
        moves.sort_unstable();
        let count = u32::try_from(compiled.motion.operations[0].moves.len()).unwrap();
        assert_eq!(moves, (0..count).collect::<Vec<_>>());
        assert!(nc.lines.iter().any(|line| line.again.len() == SECTORS.len() - 1));
    }
}

/// A text with one change in its first place behind a mark.
fn changed(text: &str, behind: &str, from: &str, to: &str) -> String {
    let start = text.find(behind).unwrap_or_else(|| panic!("{behind:?} is not in the text"));
    let at = text[start..].find(from).unwrap_or_else(|| panic!("{from:?} is not behind {behind:?}")) + start;
    format!("{}{to}{}", &text[..at], &text[at + from.len()..])
}

#[test]
fn broken_texts_are_refused() {
    let siemens: &[[&str; 4]] = &[
        ["", "SUB_101_END:", "", "the label `SUB_101_END`, and no block before has it"],
        ["", "REPEAT SUB_101_BEGIN", "REPEAT SUB_100_BEGIN", "the label `SUB_100_BEGIN`, and no block before"],
        ["", "REPEAT SUB_101_BEGIN SUB_101_END", "REPEAT SUB_101_END SUB_101_BEGIN", "is not behind"],
        ["", "P=1", "P=0", "`P=0` of REPEAT is not read"],
        ["", "SUB_101_END:", "REPEAT SUB_101_BEGIN SUB_101_END P=1\nSUB_101_END:", "no block before has it"],
        ["SUB_101_BEGIN:", "G1 ", "SUB_101_BEGIN: G1 ", "words behind the label"],
        ["", "ROT Z", "ROT X", "turns of the work frame are read about Z only"],
        ["", "ROT Z", "AROT Z", "`AROT` is not understood"],
        ["", "R90=0 R91=1", "G17", "R91 has no value"],
    ];
    let linuxcnc: &[[&str; 4]] = &[
        ["", "o101 endsub\n", "", "without `o101 endsub` behind"],
        ["", "o101 sub\n", "", "has no value: the call of the subprogram gives it"],
        ["", "o101 endsub\n", "o101 endsub\no101 endsub\n", "`o101 endsub` without `o101 sub` before"],
        ["", "o101 call", "o100 call", "no `o100 sub` before"],
        ["", "o101 call [0]", "o101 call", "`#2` has no value"],
        ["", "o101 endsub", "o101 call [0] [1]\no101 endsub", "inside of a subprogram"],
        ["", "o101 endsub", "o300 sub\no101 endsub", "inside of the subprogram o101"],
        ["", "o101 call [0]", "o101 while [0]", "of O words only"],
        ["", "o101 call [0]", "o101 call [1e9]", "is not a number"],
        ["o101 sub", "+#1]", "+#9]", "`#9` has no value"],
        ["o101 sub", "+#1]", "-#1]", "is not read"],
        ["o101 call", "G10 L2 P1 R0\n", "", "the work frame is still turned"],
    ];
    for (compiled, program) in cases() {
        let text = written(compiled, &program).text();
        let texts = if program.post.dialect == "linuxcnc" { linuxcnc } else { siemens };
        for [behind, from, to, said] in texts {
            // Only the last turn back is missed by the reader.
            let broken = if from.contains("R0\n") {
                let at = text.rfind(from).unwrap();
                format!("{}{}", &text[..at], &text[at + from.len()..])
            } else {
                changed(&text, behind, from, to)
            };
            let why = meant(&program, &broken).expect_err(&format!("{from:?} as {to:?}"));
            assert!(why.contains(said), "{from:?} as {to:?}: {why}");
        }
    }
}

/// A text that turns to a wrong place is no fault of grammar: reading back finds it, and so does the proof.
#[test]
fn a_wrong_turn_is_found() {
    for (compiled, program) in cases() {
        let post = nc::find(&program.post.dialect).unwrap();
        let text = written(compiled, &program).text();
        let changes = match program.post.dialect.as_str() {
            "linuxcnc" => [("G10 L2 P1 R45\n", "G10 L2 P1 R50\n"), ("G10 L2 P1 R45\n", "")],
            _ => [("ROT Z45\n", "ROT Z50\n"), ("ROT Z45\n", "TRANS\n")],
        };
        for (from, to) in changes {
            let wrong = changed(&text, "", from, to);
            let back = nc::read_back(post, &program, &compiled.motion, &wrong);
            assert!(back.is_err(), "{from:?} as {to:?}");
            // A proof takes seconds: one for each text is enough.
            if !to.contains("50") {
                continue;
            }
            let motion = meant(&program, &wrong).unwrap();
            let mut sink = Sink::default();
            assert!(verify(&program, motion, &mut sink).is_err(), "{from:?} as {to:?}");
            let first = sink.diags().iter().find(|d| d.severity == Severity::Error).unwrap();
            println!("{} {from:?} as {to:?}: {}", post.name(), first.message);
        }
    }
}

/// A short text that calls for long has an end.
#[test]
fn calls_without_end_are_refused() {
    let machine = support::machine_for("linuxcnc", &support::machine());
    let body = "(a comment)\n".repeat(1000);
    let linuxcnc = format!("o1 sub\n{body}o1 endsub\n{}M2\n", "o1 call\n".repeat(20_000));
    let siemens = format!("AA:\n{body}BB:\n{}M30\n", "REPEAT AA BB P=10000\n".repeat(10));
    let body = body.replace('(', ";");
    let siemens = siemens.replace("(a comment)\n", &body[..body.len() / 1000]);
    for (dialect, text) in [("linuxcnc", linuxcnc), ("siemens-840d", siemens)] {
        let faults = nc::find(dialect).unwrap().read(&text, &machine).unwrap_err();
        assert!(faults.iter().any(|f| f.reason.contains("lines are executed")), "{dialect}: {faults:?}");
    }
}

#[test]
fn what_a_job_does_not_get_is_told() {
    let [siemens, _] = &*COMPILED;
    let said = |program: &Program| {
        let post = nc::find(&program.post.dialect).unwrap();
        let mut sink = Sink::default();
        sectors::remark(post, program, &siemens.motion, &mut sink);
        let text = nc::emit(post, program, &siemens.motion, &[]).text();
        let calls = ["REPEAT", "call"].iter().any(|word| text.contains(word));
        assert_eq!(calls, sink.diags().is_empty());
        sink.diags().iter().map(|d| format!("{} {:?}", d.code.id(), d.notes)).collect::<Vec<_>>().join("\n")
    };
    let asked = |change: &dyn Fn(&mut Program)| {
        let mut program = siemens.program.clone();
        change(&mut program);
        said(&program)
    };
    assert_eq!(asked(&|_| {}), "");
    for dialect in ["heidenhain", "fanuc", "mitsubishi", "apt-cl"] {
        let mut program = support::with_post(dialect, &siemens.program);
        program.post.control.sectors = Sectors::Subprogram;
        assert!(said(&program).starts_with("IMP0812"), "{dialect}");
    }
    let few = asked(&|program| program.post.control.decimals.length = 3);
    assert!(few.contains("too few digits"), "{few}");
    let beside = asked(&|program| program.machine.part_origin.x += 0.01);
    assert!(beside.contains("axis C of the machine 5mc850-c does not turn the part about its axis"), "{beside}");
    let head = asked(&|program| {
        let mut axes = *program.machine.chain.axes();
        axes.iter_mut().for_each(|axis| axis.carries = Carries::Tool);
        program.machine.chain = Chain::new(axes).unwrap();
    });
    assert!(head.contains("does not turn the part"), "{head}");
}

/// The lines about the calls of each dialect.
#[test]
fn calls_as_they_are_written() {
    for (compiled, program) in [&cases()[0], &cases()[2]] {
        let text = written(compiled, program).text();
        let lines: Vec<&str> = text.lines().collect();
        let marks = ["sub", "call", "SUB_", "ROT", "R90=", "G10 L2 P1 R"];
        let near = |at: usize| {
            lines[at.saturating_sub(1)..lines.len().min(at + 2)].iter().any(|l| marks.iter().any(|m| l.contains(m)))
        };
        let mut shown: Vec<&str> = Vec::new();
        for (at, line) in lines.iter().enumerate() {
            if near(at) {
                shown.push(line);
            } else if shown.last().is_some_and(|l| *l != "...") {
                shown.push("...");
            }
        }
        golden::check("posts", &format!("sectors.{}", program.post.dialect), &(shown.join("\n") + "\n"));
    }
}

/// The text from the restart point on, for a control of which nothing is known.
#[test]
fn an_operation_holds_its_subprograms() {
    for (compiled, program) in cases() {
        let post = nc::find(&program.post.dialect).unwrap();
        let nc = written(compiled, &program);
        let start = nc.lines.iter().position(|line| line.text.contains("a restart point")).unwrap();
        let rest = NcProgram { lines: nc.lines[start..].to_vec(), ..nc.clone() };
        let moves = |nc: &NcProgram| -> Vec<NcMove> {
            let sections = post.read(&nc.text(), &program.machine).unwrap();
            sections.into_iter().flat_map(|s| s.moves).map(|m| NcMove { line: 0, ..m }).collect()
        };
        assert_eq!(moves(&rest), moves(&nc));
    }
}

/// Each time that a line of a subprogram is executed, the source map has the pass of that time.
#[test]
fn the_source_map_names_the_pass_of_each_call() {
    for (compiled, program) in cases() {
        let post = nc::find(&program.post.dialect).unwrap();
        let nc = written(compiled, &program);
        let lines = nc.lines.iter().map(|line| WrittenLine {
            text: &line.text,
            source: line.source,
            again: &line.again,
            frame: None,
        });
        let map = SourceMapFile::new(&program, &compiled.motion, "a.imp", |_| 1, lines);
        let map = LaidMap::new(SourceMapFile::read(&map.json().unwrap()).unwrap(), &nc.text());
        let planned = &compiled.motion.operations[0];
        let sections = post.read(&nc.text(), &program.machine).unwrap();
        let mut executed = vec![0; nc.lines.len() + 1];
        for (m, read) in planned.moves[1..].iter().zip(&sections[0].moves) {
            let time = executed[read.line];
            executed[read.line] += 1;
            assert_eq!(map.pass(read.line, time), Some(planned.labels[m.pass as usize].as_str()), "line {}", read.line);
        }
        let line = (1..executed.len()).find(|line| executed[*line] == SECTORS.len()).unwrap();
        let says = map.says(line).unwrap();
        assert!(says.contains("again, turned, for `sector 2 ") && says.contains("`sector 6 "), "{says}");
        assert_eq!(map.pass(line, SECTORS.len()), None);
    }
}
