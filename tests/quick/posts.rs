//! The texts of all dialects mean the motion, and the readers notice when they do not.

use crate::support::{self, pinned};
use impellerc::base::source::Span;
use impellerc::diagnostics::Sink;
use impellerc::ir::{Motion, Program};
use impellerc::nc::{self, NcMove, NcProgram, NcSection, Post};
use impellerc::wheel::control::{Decimals, Orientation};
use impellerc::wheel::post_file::{LineEnd, Template};
use proptest::prelude::*;
use std::ops::Range;

/// Both faces of one vane, with the machine that the dialect can have.
fn program(post: &dyn Post) -> (Program, &'static Motion) {
    let (program, motion) = pinned::flank().planned();
    (support::program_for(post.name(), program), motion)
}

fn written(post: &dyn Post) -> NcProgram {
    let (program, motion) = program(post);
    let mut sink = Sink::default();
    post.check(&program, motion, &mut sink);
    assert!(!sink.has_errors(), "{:?}", sink.diags());
    nc::emit(post, &program, motion, &["a test (with brackets); and more".to_owned()])
}

#[test]
fn texts_read_back_as_the_motion_within_the_word_quantum() {
    for post in nc::POSTS {
        let (program, motion) = program(*post);
        let text = written(*post).text();
        let found = nc::read_back(*post, &program, motion, &text).unwrap_or_else(|d| panic!("{}: {d:?}", post.name()));
        assert_eq!(found.moves, motion.operations.iter().map(|o| o.moves.len()).sum::<usize>());
        let digits = &program.post.control.decimals;
        let half = |decimals: usize| 0.5 * 10f64.powi(-i32::try_from(decimals).unwrap());
        assert!(found.tip <= half(digits.length) + 1e-10, "{}: {}", post.name(), found.tip);
        // Two angles, or three components, each with an error of half a step.
        let axis = match program.post.control.orientation {
            Orientation::Angles => half(digits.angle).to_radians() * 2f64.sqrt(),
            Orientation::Vectors => half(digits.vector) * 3f64.sqrt(),
        };
        // Rapids have the positions of the rotary axes in both.
        let axis = axis.max(half(digits.angle).to_radians() * 2f64.sqrt());
        assert!(found.axis <= axis + 1e-10, "{}: {}", post.name(), found.axis);
    }
}

#[test]
fn both_orientations_read_back() {
    for post in nc::POSTS {
        let (mut program, motion) = program(*post);
        for (k, orientation) in Orientation::ALL.into_iter().enumerate() {
            program.post.control.orientation = orientation;
            // An empty text: the dialect has no such words.
            if program.post.transformation[k].text().is_empty() {
                continue;
            }
            let mut sink = Sink::default();
            post.check(&program, motion, &mut sink);
            if sink.has_errors() {
                // G43.5 leaves the choice of the rotary positions to the control, which is not certain with two tables.
                assert_eq!((post.dialect().family, orientation), ("fanuc", Orientation::Vectors));
                continue;
            }
            let text = nc::emit(*post, &program, motion, &[]).text();
            let found = nc::read_back(*post, &program, motion, &text);
            assert!(found.is_ok(), "{} by {}: {found:?}", post.name(), orientation.name());
        }
    }
}

#[test]
fn bytes_are_plain() {
    for post in nc::POSTS {
        let text = written(*post).text();
        assert!(text.is_ascii() && text.ends_with('\n') && !text.ends_with("\n\n"), "{}", post.name());
        assert!(!text.contains('\r') && !text.contains("-0.0000 "), "{}", post.name());
        assert!(text.lines().all(|l| l.len() <= 252), "{}", post.name());
    }
}

/// Where the text of a coordinate stands in a line: 0, 1 and 2 are X, Y and Z.
fn coordinate(line: &str, axis: usize) -> Option<Range<usize>> {
    let (start, end) = match line.split_once('/') {
        Some((word @ ("GOTO" | "FROM"), values)) => {
            let before: usize = values.split(',').take(axis).map(|value| value.len() + 1).sum();
            (word.len() + 1 + before, ',')
        }
        _ => (line.find([" X", " Y", " Z"][axis])? + 2, ' '),
    };
    Some(start..line[start..].find(end).map_or(line.len(), |at| start + at))
}

/// A line with other characters in the place of some.
fn put(line: &str, range: Range<usize>, text: &str) -> String {
    format!("{}{text}{}", &line[..range.start], &line[range.end..])
}

/// A frame parks the machine where its file says; an axis without a place stays, and Z is at the retract height.
#[test]
fn a_program_ends_at_home() {
    let (mut program, motion) = program(nc::find("siemens-840d").unwrap());
    let post = nc::find("siemens-840d").unwrap();
    let lines = ["SUPA G0 Z{home.z} D0", "SUPA G0 X{home.x} D0", "SUPA G0 Y{home.y} D0", "M30"];
    program.post.frames[4] = lines.map(|line| Template::new(line, Span::default()).unwrap()).to_vec();
    for (home, end) in [
        ([Some(12.5), None, None], ["SUPA G0 Z350.0000 D0", "SUPA G0 X12.5000 D0", "M30"]),
        ([None, Some(-3.0), Some(350.0)], ["SUPA G0 Z350.0000 D0", "SUPA G0 Y-3.0000 D0", "M30"]),
    ] {
        program.machine.home = home;
        let mut sink = Sink::default();
        nc::trial::check(post, &program, &mut sink);
        assert!(!sink.has_errors(), "{:?}", sink.diags());
        let text = nc::emit(post, &program, motion, &[]).text();
        let last: Vec<&str> = text.lines().rev().take(3).map(|line| line.split_once(' ').unwrap().1).collect();
        assert_eq!(last.into_iter().rev().collect::<Vec<_>>(), end);
        assert!(nc::read_back(post, &program, motion, &text).is_ok());
    }
}

/// The work offset that a post states is written, read back, and named by what is assumed; another one is refused.
#[test]
fn the_work_offset_is_stated_once() {
    let cases: [(&str, &[&str], &[&str]); 5] = [
        ("siemens-840d", &["G55", "G57", "G505", "G599"], &["G500", "G58", "G504", "G600", "G54.1", "55", ""]),
        ("linuxcnc", &["G55", "G59", "G59.3"], &["G53", "G59.4", "G505", "g55"]),
        ("heidenhain", &["2", "17"], &["0", "G55", "-1", "+2", "70000"]),
        ("fanuc", &["G55", "G59", "G54.1 P1", "G54.1 P48"], &["G54.1", "G54.1 P0", "G54.1 P301", "G54.1P1", "G505"]),
        ("mitsubishi", &["G56", "G54.1 P96"], &["G60"]),
    ];
    for (dialect, offsets, others) in cases {
        let post = nc::find(dialect).unwrap();
        let (mut program, motion) = program(post);
        let usual = post.dialect().offsets.unwrap().usual;
        let frames = |program: &Program| {
            let mut sink = Sink::default();
            nc::trial::check(post, program, &mut sink);
            sink.diags().iter().map(|d| d.message.clone()).collect::<Vec<_>>()
        };
        let usual_text = nc::emit(post, &program, motion, &[]).text();
        for name in offsets {
            program.post.offset = Some(((*name).to_owned(), Span::default()));
            assert!(frames(&program).is_empty(), "{dialect} {name}: {:?}", frames(&program));
            let text = nc::emit(post, &program, motion, &[]).text();
            assert!(text.contains(name) && text != usual_text);
            nc::read_back(post, &program, motion, &text).unwrap_or_else(|d| panic!("{dialect} {name}: {d:?}"));
            let assumed = nc::assumptions(post, &program);
            let due = format!("{}{name} is the part origin", if dialect == "heidenhain" { "preset " } else { "" });
            assert!(assumed.iter().any(|line| line.starts_with(&due)), "{assumed:?}");
            assert!(!assumed.iter().any(|line| line.contains('{')), "{assumed:?}");
            // The text of another offset, both ways.
            let faults = post.read(&text, &program.machine).unwrap_err();
            let said = [format!("`work-offset \"{name}\"`"), "of G10 only G10 L2 P1 R0".to_owned()];
            assert!(
                dialect == "heidenhain" || said.iter().any(|said| faults[0].reason.contains(said)),
                "{dialect} {name}: {faults:?}"
            );
            let other = nc::read_back(post, &program, motion, &usual_text);
            assert!(other.is_err(), "{dialect} {name}");
        }
        for name in others {
            program.post.offset = Some(((*name).to_owned(), Span::default()));
            let said = frames(&program);
            assert!(said.len() == 1 && said[0].contains("has no work offset"), "{dialect} {name}: {said:?}");
        }
        program.post.offset = Some((usual.to_owned(), Span::default()));
        assert_eq!(nc::emit(post, &program, motion, &[]).text(), usual_text);
    }
    let post = nc::find("apt-cl").unwrap();
    let (mut program, _) = program(post);
    program.post.offset = Some(("G54".to_owned(), Span::default()));
    let mut sink = Sink::default();
    nc::trial::check(post, &program, &mut sink);
    assert!(sink.diags()[0].message.contains("has no work offset"), "{:?}", sink.diags());
}

/// A line as a comment shows it: whole, with the signs that controls take in comments.
fn words_of_comment(line: &str) -> String {
    line.replace('%', "percent").replace(['(', '['], "<").replace([')', ']'], ">").replace(';', ",")
}

/// What no word of a text excludes is named for each control: settings, offsets and interventions of the operator that would
/// change what the text does. The sources stand in the pages of the dialects.
#[test]
fn conditions_that_no_word_excludes_are_named() {
    let everywhere = ["100 % at most", "waits for the spindle|has its speed"];
    let of_controls = ["at the retract height|moves no axis", "rotary offsets"];
    let cases: [(&str, &[&str]); 5] = [
        ("siemens-840d", &["MD21104", "wear", "base frames", "DRF", "MD20560", "FGROUP", "dry run"]),
        ("heidenhain", &["pallet preset", "global program settings", "M118", "DR2", "AFC", "cycle 32"]),
        ("fanuc", &["EXT", "wear", "3402#6", "handle", "1401#1", "19696#5", "3708#0"]),
        ("mitsubishi", &["EXT", "wear", "RESET and M30 cancel", "handle"]),
        ("linuxcnc", &["WRAPPED_ROTARY", "conventional-directions", "REMAP", "eoffset", "X, Y, A, B, C"]),
    ];
    for post in nc::POSTS {
        let (program, motion) = program(*post);
        let assumed = nc::assumptions(*post, &program);
        let head: Vec<String> = assumed.iter().map(|line| format!("assumed: {line}")).collect();
        let text = nc::emit(*post, &program, motion, &head).text();
        for line in head.iter().map(|line| words_of_comment(line)) {
            assert!(text.contains(&line), "{}: {line} is cut off or altered in\n{text}", post.name());
        }
        let assumed = assumed.join("\n");
        let own = cases.iter().find(|(name, _)| *name == post.name()).map(|(_, own)| *own);
        let due =
            everywhere.iter().chain(own.map(|_| &of_controls).into_iter().flatten()).chain(own.unwrap_or_default());
        for words in due {
            assert!(words.split('|').any(|words| assumed.contains(words)), "{}: {words}\n{assumed}", post.name());
        }
    }
}

/// A post file that writes another offset than it states is refused, with the line to state it.
#[test]
fn a_frame_with_another_work_offset_is_refused() {
    let post = nc::find("fanuc").unwrap();
    let (mut program, _) = program(post);
    for line in &mut program.post.frames[2] {
        *line = Template::new(&line.text().replace("{work-offset}", "G55"), Span::default()).unwrap();
    }
    let mut sink = Sink::default();
    nc::trial::check(post, &program, &mut sink);
    let message = &sink.diags()[0].message;
    assert!(message.contains("a move with G55") && message.contains("`work-offset \"G55\"`"), "{message}");
    program.post.offset = Some(("G55".to_owned(), Span::default()));
    let mut sink = Sink::default();
    nc::trial::check(post, &program, &mut sink);
    assert!(!sink.has_errors(), "{:?}", sink.diags());
}

/// The transformation that a post file names is among what is assumed.
#[test]
fn the_number_of_the_transformation_is_assumed() {
    let post = nc::find("siemens-840d").unwrap();
    let (mut program, motion) = program(post);
    assert!(nc::assumptions(post, &program)[0].starts_with("TRAORI is the transformation of the machine file"));
    program.post.transformation = [0, 1].map(|_| Template::new("TRAORI(2)", Span::default()).unwrap());
    let mut sink = Sink::default();
    nc::trial::check(post, &program, &mut sink);
    assert!(!sink.has_errors(), "{:?}", sink.diags());
    let text = nc::emit(post, &program, motion, &[]).text();
    assert!(nc::read_back(post, &program, motion, &text).is_ok() && text.contains(" TRAORI(2)\n"));
    assert!(nc::assumptions(post, &program)[0].starts_with("TRAORI(2) is the transformation of the machine file"));
}

/// What must be noticed: a changed digit, a dropped line, a swapped pair of lines, a lost word.
#[test]
fn a_changed_text_is_noticed() {
    for post in nc::POSTS {
        let (program, motion) = program(*post);
        let nc = written(*post);
        let poses = nc.lines.iter().enumerate().filter(|(_, l)| l.source.is_some() && coordinate(&l.text, 2).is_some());
        let mut moves: Vec<usize> = poses.map(|(i, _)| i).collect();
        let up = moves.pop().unwrap();
        let judge = |lines: Vec<String>| nc::read_back(*post, &program, motion, &(lines.join("\n") + "\n"));
        let lines = || nc.lines.iter().map(|l| l.text.clone()).collect::<Vec<_>>();
        assert!(judge(lines()).is_ok());
        // The stations at retract height.
        for at in [up, moves[0]] {
            let mut dropped = lines();
            dropped.remove(at);
            assert!(judge(dropped).is_err());
        }
        let placed = nc.lines.iter().position(|l| l.source == Some((0, 0))).unwrap();
        for (at, axis) in [(placed, 0), (placed, 1), (up, 2)] {
            let mut moved = lines();
            let place = coordinate(&moved[at], axis).unwrap().start;
            moved[at] = put(&moved[at], place..place, "1");
            assert!(judge(moved).is_err(), "{}: {axis} in {}", post.name(), lines()[at]);
        }
        // Before: the rotary axes, or where CL data say that the tool stands.
        let mut turned = lines();
        match turned[placed - 1].as_str() {
            "RAPID" => turned[placed - 3] = turned[placed - 3].replacen("FROM/", "FROM/1", 1),
            _ => turned[placed - 1] = turned[placed - 1].replacen('C', "C1", 1),
        }
        assert_ne!(turned, lines());
        assert!(judge(turned).is_err(), "{}", post.name());
        for at in moves.iter().step_by(97) {
            let mut dropped = lines();
            dropped.remove(*at);
            assert!(judge(dropped).is_err());
            let mut word_lost = lines();
            let word = coordinate(&word_lost[*at], 1).unwrap();
            let address = if word_lost[*at].starts_with("GOTO/") { 0 } else { " Y".len() };
            let comma = 1 - address.min(1);
            word_lost[*at] = put(&word_lost[*at], word.start - address..word.end + comma, "");
            assert!(judge(word_lost).is_err());
            let mut digit = lines();
            // The third decimal of Z: a micrometre.
            let z = coordinate(&digit[*at], 2).unwrap().start;
            let place = digit[*at][z..].find('.').unwrap() + z + 3;
            let old: u32 = digit[*at][place..=place].parse().unwrap();
            digit[*at].replace_range(place..=place, &((old + 1) % 10).to_string());
            assert!(judge(digit).is_err());
        }
    }
}

/// With few digits the planned motion is what the words say, not what they are near to.
#[test]
fn coarse_words_are_planned_and_proved() {
    for orientation in Orientation::ALL {
        let mut program = pinned::flank().program.clone();
        program.post.control.orientation = orientation;
        program.post.control.decimals = Decimals { length: 3, angle: 3, vector: 5, feed: 0 };
        let mut sink = Sink::default();
        let plan = impellerc::plan::passes::pipeline::run(&program, &mut sink).expect("a plan");
        let (motion, _) = impellerc::verify::verify(&program, plan.motion, &mut sink).expect("a certificate");
        let post = nc::find(&program.post.dialect).unwrap();
        let text = nc::emit(post, &program, &motion, &[]).text();
        let found = nc::read_back(post, &program, &motion, &text).unwrap_or_else(|d| panic!("{d:?}"));
        assert!(found.tip < 1e-9 && found.axis < 2e-8, "{found:?}");
        let line = text.lines().find(|l| l.contains(" G1 ")).unwrap();
        let digits = |word: &str| line.split(word).nth(1).unwrap().split([' ', '.']).nth(1).unwrap().len();
        assert_eq!(digits(" X"), 3, "{line}");
        let word = if orientation == Orientation::Vectors { "A3=" } else { "A=" };
        assert_eq!(digits(word), if orientation == Orientation::Vectors { 5 } else { 3 }, "{line}");
    }
}

/// Line ends and block numbers are those of the post file.
#[test]
fn line_ends_and_block_numbers_are_chosen() {
    let (mut program, motion) = (pinned::flank().program.clone(), &pinned::flank().motion);
    program.post.line_end = LineEnd::CrLf;
    program.post.block_numbers = 5;
    let post = nc::find("siemens-840d").unwrap();
    let text = nc::emit(post, &program, motion, &["a comment".to_owned()]).text();
    assert_eq!(text.matches("\r\n").count(), text.matches('\n').count());
    assert!(text.starts_with("; %_N_WEI2021_MPF\r\n; a comment\r\n"));
    assert!(text.contains("\nN5 G17") && text.contains("\nN10 TRAFOOF\r\n"));
    let found = nc::read_back(post, &program, motion, &text);
    assert!(found.is_ok(), "{found:?}");
    program.post.block_numbers = 0;
    assert!(nc::emit(post, &program, motion, &[]).text().lines().all(|l| !l.starts_with('N')));
}

/// A program can be started at each operation: the text from there is read without a fault, beginning with an unknown
/// control, and commands the same moves.
#[test]
fn each_operation_is_a_restart_point() {
    for post in nc::POSTS {
        let small = pinned::small(post.name());
        let program = support::with_post(post.name(), &small.program);
        let nc = nc::emit(*post, &program, &small.motion, &[]);
        let starts: Vec<usize> =
            (0..nc.lines.len()).filter(|i| nc.lines[*i].text.contains("a restart point")).collect();
        assert_eq!(starts.len(), 3, "{}", post.name());
        let whole = post.read(&nc.text(), &program.machine).unwrap();
        // What a control needs before any block, such as the name of the program.
        let begin = program.post.frames[0].len();
        for (k, start) in starts.into_iter().enumerate() {
            let mut lines = nc.lines[..begin].to_vec();
            lines.extend_from_slice(&nc.lines[start..]);
            let text = NcProgram { lines, ..nc.clone() }.text();
            let found = post.read(&text, &program.machine).unwrap_or_else(|e| panic!("{}: {e:?}", post.name()));
            let moves = |sections: &[NcSection]| -> Vec<NcMove> {
                let all = sections.iter().flat_map(|s| &s.moves);
                all.map(|m| NcMove { line: 0, ..m.clone() }).collect()
            };
            assert_eq!(moves(&found), moves(&whole[k..]), "{} from operation {k}", post.name());
        }
    }
}

proptest! {
    #[test]
    fn readers_never_panic(text in "[A-Z0-9=.()\" \n;-]{0,200}") {
        for post in nc::POSTS {
            let (program, _) = program(*post);
            let _ = post.read(&text, &program.machine);
        }
    }
}
