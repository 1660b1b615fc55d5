//! Every number and word of every shipped post file is changed: the compiler never accepts what `impellerc verify` refuses of
//! its text.
//!
//! All rows share one motion that is planned and verified once for each machine. The verdict of the compiler is that of the
//! trial before planning, of what the dialect refuses, and of the read back. The verdict of `verify` is the judgement of the
//! whole text, and the certificate of the motion that it commands.

use crate::support::pinned;
use impellerc::base::progress::Progress;
use impellerc::base::source::{SourceFile, SourceMap, Span};
use impellerc::diagnostics::{Severity, Sink};
use impellerc::driver::{self, Options, RunOptions, Stages};
use impellerc::ir::{Motion, Program};
use impellerc::job::{self, InMemory};
use impellerc::nc;
use impellerc::verify::certify_with;
use impellerc::verify::stock::Settings;
use std::collections::BTreeMap;

/// The shipped post files with their texts.
const FILES: [(&str, &str); 8] = [
    ("apt-cl", include_str!("../../jobs/_lib/posts/apt-cl.toml")),
    ("fanuc", include_str!("../../jobs/_lib/posts/fanuc.toml")),
    ("heidenhain", include_str!("../../jobs/_lib/posts/heidenhain.toml")),
    ("heidenhain-itnc530", include_str!("../../jobs/_lib/posts/heidenhain-itnc530.toml")),
    ("linuxcnc", include_str!("../../jobs/_lib/posts/linuxcnc.toml")),
    ("makino", include_str!("../../jobs/_lib/posts/makino.toml")),
    ("mitsubishi", include_str!("../../jobs/_lib/posts/mitsubishi.toml")),
    ("siemens-840d", include_str!("../../jobs/_lib/posts/siemens-840d.toml")),
];

/// The places of the templates of a post file: between the quotes, without what only names things.
fn templates(text: &str) -> Vec<std::ops::Range<usize>> {
    let mut found = Vec::new();
    let (mut start, mut inside) = (0, false);
    for line in text.split_inclusive('\n') {
        inside |= line.starts_with("[smoothing]") || line.starts_with("[transformation]");
        if inside && !line.trim_start().starts_with('#') {
            let mut rest = 0;
            while let Some(open) = line[rest..].find(['"', '\'']).map(|at| rest + at) {
                let quote = &line[open..=open];
                let Some(close) = line[open + 1..].find(quote).map(|at| open + 1 + at) else { break };
                found.push(start + open + 1..start + close);
                rest = close + 1;
            }
        }
        start += line.len();
    }
    found
}

/// What a template can become when one of its numbers or words is another one or is missing.
fn changes(template: &str) -> Vec<String> {
    let words: Vec<&str> = template.split(' ').filter(|word| !word.is_empty()).collect();
    let mut all = Vec::new();
    for k in 0..words.len() {
        let with = |other: &str| [&words[..k], &[other], &words[k + 1..]].concat().join(" ").trim().to_owned();
        all.push(with(""));
        if k > 0 {
            let mut swapped = words.clone();
            swapped.swap(k - 1, k);
            all.push(swapped.join(" "));
        }
        // Numbers and fields.
        let word = words[k];
        let (mut at, mut depth) = (0, 0);
        while at < word.len() {
            let here = &word[at..];
            if here.starts_with('{') {
                depth += 1;
                if let Some(end) = here.find('}') {
                    all.extend(["0", "7.5"].map(|value| with(&format!("{}{value}{}", &word[..at], &here[end + 1..]))));
                }
            } else if here.starts_with('}') {
                depth -= 1;
            }
            let digits = here.find(|c: char| !c.is_ascii_digit()).unwrap_or(here.len());
            if depth == 0 && digits > 0 {
                let number: u64 = here[..digits].parse().unwrap();
                let others = [number + 1, number.saturating_sub(1), number * 10 + 5];
                all.extend(others.map(|value| with(&format!("{}{value}{}", &word[..at], &here[digits..]))));
                at += digits;
            } else {
                at += 1;
            }
        }
    }
    all.retain(|other| other != template);
    all.sort();
    all.dedup();
    all
}

/// The program with a post file of this text; `None` where the file is refused.
fn with_text(program: &Program, text: &str) -> Option<Program> {
    let job = "edition 2026\npost changed\n";
    let mut files =
        InMemory { posts: BTreeMap::from([("changed".to_owned(), text.to_owned())]), ..InMemory::default() };
    let (mut sources, mut sink) = (SourceMap::default(), Sink::default());
    let source = sources.add_file(SourceFile::text("changed.imp", job));
    let ast = impellerc::syntax::parse(job, source, &mut sink);
    // Whatever else the job lacks.
    let file = job::understand(&ast, &mut files, &mut sources, &mut sink).post?;
    Some(Program { post: file, ..program.clone() })
}

/// What the compiler says: the reason of its refusal.
fn compiled(program: &Program, motion: &Motion) -> Result<(), String> {
    let post = nc::find(&program.post.dialect).unwrap();
    let mut sink = Sink::default();
    nc::trial::check(post, program, &mut sink);
    post.check(program, motion, &mut sink);
    if let Some(diag) = sink.diags().iter().find(|diag| diag.severity == Severity::Error) {
        return Err(diag.message.clone());
    }
    let text = nc::emit(post, program, motion, &[]).text();
    nc::read_back(post, program, motion, &text).map(|_| ()).map_err(|fault| fault.reason)
}

/// Motions that were certified, with what is wrong with them. Many post files command the same motion to the last digit.
#[derive(Default)]
struct Certified(Vec<(Motion, Option<String>)>);

impl Certified {
    /// What is wrong with a motion.
    fn fault(&mut self, program: &Program, motion: Motion) -> Option<String> {
        if let Some((_, fault)) = self.0.iter().find(|(known, _)| is_same(known, &motion)) {
            return fault.clone();
        }
        let mut sink = Sink::default();
        // The largest cells: a post file changes what the control does between the points, not how the tool is loaded.
        let mut settings = Settings { cell: Some(4.0), ..Settings::default() };
        let fault = match certify_with(program, &motion, &mut settings, &Progress::default(), &mut sink) {
            Ok(certificate) if !sink.has_errors() && certificate.contracts.iter().all(|c| c.holds) => None,
            _ => Some(first(&sink)),
        };
        self.0.push((motion, fault.clone()));
        fault
    }
}

/// The first message.
fn first(sink: &Sink) -> String {
    sink.diags().first().map_or_else(String::new, |diag| diag.message.clone())
}

fn is_same(a: &Motion, b: &Motion) -> bool {
    a.operations.len() == b.operations.len()
        && a.operations.iter().zip(&b.operations).all(|(a, b)| {
            a.moves.len() == b.moves.len()
                && a.moves.iter().zip(&b.moves).all(|(m, n)| {
                    (m.kind, m.joints, m.feed, m.time, m.stop) == (n.kind, n.joints, n.feed, n.time, n.stop)
                })
        })
}

/// What `impellerc verify` says of the text.
fn verified(program: &Program, motion: &Motion, certified: &mut Certified) -> Result<(), String> {
    let post = nc::find(&program.post.dialect).unwrap();
    let text = nc::emit(post, program, motion, &[]).text();
    let mut sink = Sink::default();
    let commands = nc::judge(post, program, &text, &|_| Span::default(), &mut sink);
    let Some(commands) = commands.filter(|_| !sink.has_errors()) else { return Err(first(&sink)) };
    certified.fault(program, commands.motion.motion).map_or(Ok(()), Err)
}

/// Reasons of the compiler that `verify` does not know. The tool goes elsewhere at the retract height: verified as it stands, and not
/// the motion that was planned. The trial has no exact stop, behind which the words of smoothing stand again in the moves.
const MORE_THAN_VERIFY: [&str; 2] = ["away from the first station", "the tolerance of the path is unknown"];

#[test]
fn the_compiler_accepts_no_post_file_whose_text_verify_refuses() {
    for (name, text) in FILES {
        let shipped = job::shipped_post(name).unwrap();
        let short = pinned::short(&shipped.dialect);
        let (program, motion) = (&short.program, &short.motion);
        let own = with_text(program, text).expect(name);
        assert_eq!(compiled(&own, motion), Ok(()), "{name}");
        let mut certified = Certified::default();
        verified(&own, motion, &mut certified).unwrap_or_else(|reason| panic!("{name}: {reason}"));
        let [mut rows, mut accepted, mut unread, mut only_compiler] = [0; 4];
        for place in templates(text) {
            for other in changes(&text[place.clone()]) {
                rows += 1;
                let changed = format!("{}{other}{}", &text[..place.start], &text[place.end..]);
                let Some(program) = with_text(program, &changed) else {
                    unread += 1;
                    continue;
                };
                let mut verify = || verified(&program, motion, &mut certified);
                match compiled(&program, motion) {
                    Ok(()) => {
                        if let Err(reason) = verify() {
                            panic!("{name}: `{}` as `{other}` is written; verify: {reason}", &text[place])
                        }
                        accepted += 1;
                    }
                    // Whatever `verify` says of these.
                    Err(reason) if MORE_THAN_VERIFY.iter().any(|why| reason.contains(why)) => only_compiler += 1,
                    Err(reason) => {
                        assert!(verify().is_err(), "{name}: `{}` as `{other}`: {reason}", &text[place.clone()])
                    }
                }
            }
        }
        println!(
            "{name}: {rows} changes, {unread} are no post file, {accepted} accepted by both, {only_compiler} refused by the compiler, which knows the plan, {} motions",
            certified.0.len()
        );
        assert!(rows >= 40, "{name}: {rows}");
    }
}

/// Blocks that a shop may add to a post file, and that change what the control does with the blocks around them.
fn foreign_blocks(dialect: &str) -> Vec<&'static str> {
    let all = match dialect {
        "siemens-840d" => {
            r#"G70 | G91 | G93 | G95 | G41 D1 | G18 | M0 | M5 | M4 | M2 | G4 F5 | FFWON | G641 ADIS=1 | G64 |
            G60 | ROT Z30 | ATRANS X1 | SCALE X1.1 | MIRROR X0 | TRAORI(2) | TRAFOOF | ORIVECT | ORIMKS | G55 |
            G153 | D2 | T="other" M6 | S100 | S100 M3 | COMPCURV | SOFT | CYCLE832(5,_FINISH,1) | CYCLE800() |
            STOPRE | R1=1 | GOTOF END | MSG("x") | G0 Z0 | G0 A0 | OVR=50 | FGROUP(X) | PAROT | G53 G0 Z0 |
            OFFN=1 | M30 | RET"#
        }
        "heidenhain" | "heidenhain-itnc530" => {
            r#"M5 | M4 | M0 | M2 | M91 | M92 | M94 | M97 | M107 | M114 | M116 | M118 X1 Y1 Z1 | M120 LA5 | M126 |
            M127 | M128 | M129 | M130 | M136 | M138 A | M140 MB MAX | M144 | CYCL DEF 7.0 DATUM SHIFT |
            CYCL DEF 8.0 MIRROR IMAGE | CYCL DEF 10.0 ROTATION | CYCL DEF 11.0 SCALING | TOOL CALL 99 Z S1000 |
            TOOL CALL S100 | TOOL CALL DL+1 | PLANE SPATIAL SPA+10 SPB+0 SPC+0 STAY |
            FUNCTION TCPM F CONT AXIS SPAT PATHCTRL VECTOR | L Z+0 FMAX | L A+0 FMAX | CALL LBL 1 |
            FN 0: Q1 = +1 | FUNCTION RESET TCPM | STOP | L Z+0 R0 FMAX M91 | M30 | M99"#
        }
        "fanuc" | "makino" | "mitsubishi" => {
            r#"G20 | G91 | G93 | G95 | G41 D1 | G18 | M0 | M1 | M5 | M4 | M2 | G4 P500 | G61 | G61.1 | G64 |
            G68 X0. Y0. R30. | G52 X1. | G51 X0. Y0. Z0. P1100 | G51.1 X0. | G43 H2 | G43 H1 | G43.5 H1 P0 |
            G43.4 H2 | G49 | G55 | G54.1 P1 | T2 M6 | S100 | S100 M3 | G05 P10000 | G05.1 Q0 | G08 P1 |
            G54.2 P1 | G69 | G92 X0. | G53 G0 Z0. | G28 Z0. | #500=1 | GOTO 10 | M98 P1000 | G65 P1000 |
            G0 Z0. | G0 A0. | M30 | G10 L2 P1 X1. | G40.1"#
        }
        "linuxcnc" => {
            r#"G20 | G91 | G93 | G95 | G41 D1 | G18 | M0 | M1 | M5 | M4 | M2 | G4 P5 | G61 | G61.1 | G64 |
            G64 P1 | G52 X1 | G92 X1 | G43 H2 | G43.1 Z1 | G43.2 H2 | G49 | G55 | G59.3 | T2 M6 | S100 |
            S100 M3 | M428 | M429 | M430 | G96 D1000 S1 | G7 | M48 | M49 | M50 P0 | M51 P0 | M53 P0 | M61 Q2 |
            M62 P0 | M66 P0 L0 | M70 | G53 G0 Z0 | G28 | G30 | #500=1 | #5220=2 | O100 CALL | G0 Z0 | G0 A0 |
            G10 L2 P1 X1 | G10 L1 P1 Z1 | G51 X1 | M30 | G80 | G98"#
        }
        _ => {
            r#"UNITS/INCHES | SPINDL/OFF | SPINDL/RPM,100,CLW | SPINDL/RPM,8000,CCLW | SPINDL/8000 | CUTCOM/LEFT |
            LINTOL/5 | OUTTOL/5 | MULTAX/OFF | MULTAX | TRANS/1,0,0 | ROTATE/AAXIS,10 | LOADTL/9 |
            LOADTL/9,LENGTH,50 | TLAXIS/0,0,1 | GODLTA/1,0,0 | STOP | OPSTOP | GOHOME | FEDRAT/IPM,10 |
            FEDRAT/100,MMPR | RAPID | COOLNT/OFF | CYCLE/DRILL,5 | COPY/1,TRANSL,1,0,0 | DELAY/5 |
            ORIGIN/1,2,3 | TRACUT/1 | FROM/0,0,0 | GOTO/0,0,0 | CUTTER/99 | FINI | CALL/M | END | INSERT/G91"#
        }
    };
    all.split('|').map(str::trim).filter(|block| !block.is_empty()).collect()
}

/// The places behind the entries of the lists of frames of a post file, with the entry, and what stands before a new one.
fn entries(text: &str) -> Vec<(usize, &str)> {
    let start = text.find("[frames]").expect("frames");
    let ranges = templates(text).into_iter().filter(|place| place.start > start);
    ranges.map(|place| (place.end + 1, &text[place])).collect()
}

/// Blocks that are left out between two that stand behind an entry: all of them would take minutes.
const APART: usize = 7;

#[test]
fn a_block_that_a_shop_adds_has_one_verdict() {
    for (name, text) in FILES {
        let shipped = job::shipped_post(name).unwrap();
        let short = pinned::short(&shipped.dialect);
        let (program, motion) = (&short.program, &short.motion);
        let mut certified = Certified::default();
        assert_eq!(verified(&with_text(program, text).expect(name), motion, &mut certified), Ok(()));
        let (mut rows, mut accepted) = (0, Vec::new());
        let blocks = foreign_blocks(name);
        for (n, (place, before)) in entries(text).into_iter().enumerate() {
            // Each block stands behind some entries, and each entry has some behind it.
            for block in blocks.iter().copied().skip(n % APART).step_by(APART) {
                rows += 1;
                let changed = format!("{}, '{block}'{}", &text[..place], &text[place..]);
                let Some(program) = with_text(program, &changed) else { continue };
                // What the compiler refuses is never verified.
                if compiled(&program, motion).is_err() {
                    continue;
                }
                match verified(&program, motion, &mut certified) {
                    Err(reason) => panic!("{name}: `{block}` behind `{before}` is written; verify: {reason}"),
                    Ok(()) => accepted.push(format!("`{block}` behind `{before}`")),
                }
            }
        }
        println!("{name}: {rows} blocks, {} accepted by both, {} motions", accepted.len(), certified.0.len());
        for row in &accepted {
            println!("  {row}");
        }
        assert!(rows >= 40, "{name}: {rows}");
    }
}

/// A frame `end` without the words that end a program is marked itself, and not the line before it.
#[test]
fn a_missing_end_is_marked_where_it_is_missing() {
    for (name, from, to, missing) in [
        ("siemens-840d", "end = [\"M30\"]", "end = []", "M30"),
        ("siemens-840d", "end = [\"M30\"]", "end = [\"; end\"]", "M30"),
        ("fanuc", "end = [\"M30\", \"%\"]", "end = [\"M30\"]", "`%` in its last line"),
        ("fanuc", "end = [\"M30\", \"%\"]", "end = []", "M30"),
        ("heidenhain", "\"END PGM {program.file} MM\"]", "]", "`END PGM"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let text = FILES.iter().find(|(file, _)| *file == name).unwrap().1;
        let changed = text.replace(from, to);
        assert_ne!(text, changed, "{name}");
        std::fs::create_dir(folder.path().join("posts")).unwrap();
        std::fs::write(folder.path().join(format!("posts/{name}.toml")), &changed).unwrap();
        let run =
            RunOptions { library: Some(folder.path().into()), post: Some(name.to_owned()), ..RunOptions::default() };
        let options = Options { job: "jobs/small/small.imp".into(), run, ..Options::default() };
        let outcome = driver::check(&options, &mut Stages::default());
        let errors: Vec<_> = outcome.sink.diags().iter().filter(|d| d.severity == Severity::Error).collect();
        let [error] = errors.as_slice() else { panic!("{name}: {errors:?}") };
        let [label] = error.labels.as_slice() else { panic!("{name}: {error:?}") };
        let file = outcome.sources.get(label.span.source).unwrap();
        let line = changed.split("\nend = ").nth(1).unwrap().lines().next().unwrap();
        assert_eq!(file.text[label.span.range()].to_owned(), line, "{name}");
        assert!(label.text.starts_with(missing) && label.text.ends_with("is missing here"), "{name}: {}", label.text);
        assert!(error.help.as_ref().unwrap().contains("frame `end`"), "{name}: {error:?}");
    }
}
