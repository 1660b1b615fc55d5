//! CL data of APT.

use crate::support;
use crate::support::{golden, pinned};
use impellerc::base::entity::PrimaryMap;
use impellerc::ir::Program;
use impellerc::ir::Tool;
use impellerc::nc;
use impellerc::tool_stock::collide::Cutter;
use impellerc::wheel::control::Decimals;

const POST: &str = "apt-cl";

/// The program for a dialect, with the frames and digits of its post file.
fn program(dialect: &str) -> Program {
    support::program_for(dialect, &pinned::flank().program)
}

/// The lines of the text of a program, read back before.
fn lines(program: &Program) -> Vec<String> {
    let post = nc::find(&program.post.dialect).unwrap();
    let motion = &pinned::flank().motion;
    let text = nc::emit(post, program, motion, &[]).text();
    nc::read_back(post, program, motion, &text).unwrap_or_else(|d| panic!("{d:?}"));
    text.lines().map(str::to_owned).collect()
}

/// Compares lines with the golden of a quirk.
fn check(quirk: &str, dialect: &str, lines: &[String]) {
    golden::check("posts", &format!("{quirk}.{dialect}"), &(lines.join("\n") + "\n"));
}

/// Lines from the first one that begins like this.
fn from(lines: &[String], start: &str, count: usize) -> Vec<String> {
    let at = lines.iter().position(|l| l.starts_with(start)).unwrap();
    lines[at..at + count].to_vec()
}

/// Curves as one piece: the knots are zeros and ones, and the same motion stands in GOTO.
#[test]
fn movnrb() {
    check("movnrb", POST, &super::spline_blocks(POST));
}

/// A station is said by FROM and reached by RAPID and GOTO as well; the last one is a GOTO, since no statement has the
/// machine frame.
#[test]
fn stations() {
    let all = lines(&program(POST));
    let mut shown = all[..20].to_vec();
    shown.push("...".to_owned());
    shown.extend_from_slice(&all[all.len() - 9..]);
    check("stations", POST, &shown);
}

/// RAPID stands before each GOTO at rapid, FEDRAT behind it, also where the feed is the one before.
#[test]
fn rapid_counts_once() {
    let all = lines(&program(POST));
    // At the end of the way between two passes.
    let last = (20..all.len()).find(|i| all[*i] == "RAPID" && all[i + 2].starts_with("FEDRAT/")).unwrap();
    check("rapid-counts-once", POST, &all[last - 4..last + 8]);
    for (i, line) in all.iter().enumerate().filter(|(_, l)| *l == "RAPID") {
        assert!(all[i + 1].starts_with("GOTO/"), "{line}");
        // The direction of a station has a line of its own.
        let next = all[i + 2..].iter().find(|l| !l.starts_with(' ')).unwrap();
        assert!(["RAPID", "FEDRAT/", "COOLNT/"].iter().any(|word| next.starts_with(word)), "{next}");
    }
}

/// A statement beyond column 72 goes on in the next line, by `$`.
#[test]
fn line_length() {
    let mut program = program(POST);
    program.post.control.decimals = Decimals { length: 6, vector: 9, ..program.post.control.decimals };
    let long = lines(&program);
    assert!(long.iter().all(|l| l.len() <= 72), "{long:?}");
    check("line-length", POST, &from(&long, "FEDRAT/", 9));
}

/// Seven numbers of CUTTER have flat, ball, bull nose and tapered ball; barrel and lollipop have no CUTTER.
#[test]
fn cutters() {
    let mut shown = Vec::new();
    let cutters = [
        Cutter::flat(4.0),
        Cutter::ball(3.0),
        Cutter::bull(4.0, 1.5),
        Cutter::tapered_ball(2.0, 5f64.to_radians()),
        Cutter::barrel(5.0, 40.0, 1.0),
        Cutter::lollipop(3.0),
    ];
    for cutter in cutters {
        let mut program = program(POST);
        let tools: Vec<Tool> = program.tools.iter().map(|(_, tool)| tool.clone()).collect();
        program.tools = PrimaryMap::new();
        for mut tool in tools {
            tool.solid.cutter = cutter;
            program.tools.push(tool);
        }
        shown.push(format!("$$ {}", cutter.keyword()));
        shown.extend(from(&lines(&program), "LOADTL/", 3));
    }
    check("cutters", POST, &shown);
}
