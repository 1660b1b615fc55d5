//! Changes for CL data of APT. No control runs them: the question is what any post-processor makes of them, and what two of
//! them make of them differently. Words from ISO 3592 and ISO 4343 and the list of CL commands of PTC.

use super::Change::{All, First, Job, Last, Machine, Text};
use super::Kind;
use super::Verdict::{Found, Harmless, Refused};
use super::operations;
use impellerc::base::entity::PrimaryMap;
use impellerc::base::units::Mm;
use impellerc::five_axis::control::Planning;

const LOAD: &str = "LOADTL/1,LENGTH,105.0000";
const FLAT: &str = "CUTTER/2.0000,0.0000,1.0000,0.0000,0.00000,0.00000,12.0000";
const START: &str = "SPINDL/RPM,12000,CLW";

pub fn kinds() -> Vec<Kind> {
    let mut all = Vec::new();
    all.extend(head());
    all.extend(change());
    all.extend(cutters());
    all.extend(stations());
    all.extend(rapids_and_feeds());
    all.extend(poses());
    all.extend(spelling());
    all.extend(end());
    all.extend(operations::kinds(parts));
    all.extend(wrong());
    all
}

/// Lines of a text with one change by a function of the line numbers of all GOTO; operation 1 is the second one, flank.
fn changed(text: &str, change: impl Fn(&mut Vec<String>, &[usize])) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let starts: Vec<usize> = (0..lines.len()).filter(|i| lines[*i].starts_with("LOADTL/")).collect();
    let of_flank: Vec<usize> = (starts[1]..starts[2]).filter(|i| lines[*i].starts_with("GOTO/")).collect();
    change(&mut lines, &of_flank);
    lines.join("\n") + "\n"
}

/// A pose in a cut of the flank, behind a station, a rapid and the lead-in; that many poses behind it the tool leans otherwise.
const CUT: usize = 60;
const FAR: usize = 40;

/// Values of the pose in the cut, changed.
fn values(text: &str, change: impl Fn(&mut Vec<String>)) -> String {
    changed(text, |lines, goto| {
        let line = &mut lines[goto[CUT]];
        let mut values: Vec<String> = line["GOTO/".len()..].split(',').map(str::to_owned).collect();
        assert_eq!(values.len(), 6);
        change(&mut values);
        *line = format!("GOTO/{}", values.join(","));
    })
}

/// A value of the pose in the cut, moved by an amount.
fn moved(text: &str, k: usize, by: f64) -> String {
    values(text, |v| v[k] = format!("{:.8}", v[k].parse::<f64>().unwrap() + by))
}

/// A statement before the pose in the cut.
fn before_the_cut(text: &str, statement: &str) -> String {
    changed(text, |lines, goto| lines.insert(goto[CUT], statement.to_owned()))
}

fn head() -> Vec<Kind> {
    const C: &str = "head";
    vec![
        (C, First("PARTNO small\n", ""), Harmless, "the name of the program moves nothing"),
        (C, First("PARTNO small\n", "PARTNO\n"), Harmless, "no name"),
        (C, First("PARTNO small\n", "PARTNO small $$ UNITS/INCHES $\n"), Harmless, "the rest of the line is the name"),
        (C, First("UNITS/MM\n", "UNITS/MM\nPARTNO small\n"), Refused, "begins a program of its own"),
        (C, First("PARTNO small\n", "PARTNO small\nPARTNO small\n"), Refused, "begins a program of its own"),
        (C, First("UNITS/MM\n", ""), Refused, "lengths in the units that the processor was left in"),
        (C, First("UNITS/MM", "UNITS/INCHES"), Refused, "inches"),
        (C, First("UNITS/MM", "UNITS/INCH"), Refused, "inches"),
        (C, First("UNITS/MM", "UNITS/CM"), Refused, "another unit"),
        (C, First("UNITS/MM", "UNITS"), Refused, "no unit"),
        (C, First("UNITS/MM", "UNITS/MM,INCHES"), Refused, "two units"),
        (C, First("UNITS/MM\n", "UNITS/MM\nUNITS/MM\n"), Harmless, "said twice"),
        (C, First("UNITS/MM\n", "UNITS/MM\nUNITS/INCHES\n"), Refused, "the last one counts"),
        (C, First("UNITS/MM\n", "UNITS/INCHES\nUNITS/MM\n"), Refused, "inches, whatever follows"),
        (C, First("UNITS/MM\n", "UNITS/MM\nMACHIN/FIVEAX,1\n"), Harmless, "the name of a post-processor"),
        (C, First("UNITS/MM\n", "UNITS/MM\nMACHIN/FIVEAX,1,CIRCUL,ON\n"), Refused, "an option of one post-processor"),
        (C, First("UNITS/MM\n", "UNITS/MM\nMACHIN\n"), Refused, "no name"),
        (C, First("UNITS/MM\n", "UNITS/MM\nPPRINT CLAMP THE PART / $ FIRST\n"), Harmless, "text for the operator"),
        (C, First("UNITS/MM\n", "UNITS/MM\n\n$$ a comment / with $ signs\n"), Harmless, "a comment"),
        (C, First("UNITS/MM\n", "UNITS/MM\nTRANS/10.0,0.0,0.0\n"), Refused, "shifts the frame"),
        (C, First("UNITS/MM\n", "UNITS/MM\nORIGIN/0.0,0.0,5.0\n"), Refused, "shifts the frame"),
        (C, First("UNITS/MM\n", "UNITS/MM\nROTATE/TABLE,90.0\n"), Refused, "turns an axis of one machine"),
        (C, First("UNITS/MM\n", "UNITS/MM\nCUTCOM/LEFT\n"), Refused, "adds the radius of the tool"),
        (C, First("UNITS/MM\n", "UNITS/MM\nINSERT G92 X0\n"), Refused, "words of a control"),
        (C, First("UNITS/MM\n", "UNITS/MM\nAUXFUN/7\n"), Refused, "a word of a control"),
        (C, First("UNITS/MM\n", "UNITS/MM\nOUTTOL/0.1\n"), Refused, "belongs to a part program"),
        (C, First("UNITS/MM\n", "UNITS/MM\nCOPY/1,TRANSL,0,0,1,2\n"), Refused, "moves what follows"),
        (C, All("MULTAX/ON\n", ""), Refused, "i j k may be left out by the processor"),
        (C, First("MULTAX/ON", "MULTAX/OFF"), Refused, "i j k are left out"),
        (C, First("MULTAX/ON", "MULTAX"), Refused, "no word in its list"),
        (C, First("MULTAX/ON", "MULTAX/ON,OFF"), Refused, "two words"),
        (C, Last("MULTAX/ON\n", ""), Harmless, "it still holds"),
        (C, Last("MULTAX/ON\n", "MULTAX/OFF\n"), Refused, "i j k are left out from here on"),
        (C, First("LINTOL/0.0500\n", ""), Refused, "the path between poses may be anything"),
        (C, First("LINTOL/0.0500", "LINTOL/0.5000"), Refused, "more than the job allows"),
        (C, First("LINTOL/0.0500", "LINTOL/0.0010"), Harmless, "less than the job allows"),
        (C, First("LINTOL/0.0500", "LINTOL/0"), Refused, "no tolerance"),
        (C, First("LINTOL/0.0500", "LINTOL/-0.05"), Refused, "negative"),
        (C, First("LINTOL/0.0500", "LINTOL/OFF"), Refused, "no straight path of the tip"),
        (C, First("LINTOL/0.0500", "LINTOL/0.05,0.1"), Refused, "one number too many"),
        (C, First("LINTOL/0.0500", "LINTOL"), Refused, "no number"),
        (C, First("LINTOL/0.0010\n", ""), Refused, "the tolerance of roughing still holds"),
        (C, Last("LINTOL/0.0010\n", ""), Harmless, "the tolerance before is the same"),
    ]
}

fn change() -> Vec<Kind> {
    const C: &str = "tool change";
    vec![
        (C, First("LOADTL/1,", "LOADTL/2,"), Refused, "another tool"),
        (C, First("LOADTL/1,", "LOADTL/3,"), Refused, "no tool of the job"),
        (C, First("LOADTL/1,", "LOADTL/0,"), Refused, "no tool"),
        (C, First("LOADTL/1,", "LOADTL/-1,"), Refused, "negative"),
        (C, First("LOADTL/1,", "LOADTL/1.5,"), Refused, "no whole number"),
        (C, First("LOADTL/1,", "LOADTL/FLAT2,"), Refused, "a name"),
        (C, First("LOADTL/1,", "LOADTL/01.,"), Harmless, "the same number"),
        (C, First("LOADTL/1,", "TOOLNO/1,"), Refused, "another statement, with other values"),
        (C, First("LOADTL/1,", "TURRET/1,"), Refused, "another statement, with other values"),
        (C, First("LOADTL/1,LENGTH,105.0000\n", ""), Refused, "whichever tool is in the spindle"),
        (C, First("LOADTL/1,LENGTH,105.0000\n", "LOADTL/1\n"), Refused, "the length is unknown"),
        (C, First("LENGTH,105.0000", "LENGTH,104.0000"), Refused, "another length"),
        (C, First("LENGTH,105.0000", "LENGTH,-105.0"), Refused, "negative"),
        (C, First("LENGTH,105.0000", "LENGTH,105"), Harmless, "the same number"),
        (C, First("LENGTH,105.0000", "LENGTH"), Refused, "a number is missing"),
        (C, First("LENGTH,105.0000", "105.0000"), Refused, "a number of nothing"),
        (C, First("LENGTH,105.0000", "LENGTH,105.0000,LENGTH,105.0000"), Refused, "said twice"),
        (C, First("LENGTH,105.0000", "LENGTH,105.0000,OSETNO,1"), Harmless, "the register of this tool"),
        (C, First("LENGTH,105.0000", "LENGTH,105.0000,OSETNO,2"), Refused, "the length of another tool"),
        (C, First("LENGTH,105.0000", "LENGTH,105.0000,MANUAL"), Refused, "a word that not every post-processor has"),
        (C, First("LENGTH,105.0000", "LENGTH,105.0000,IN,2"), Refused, "a word that not every post-processor has"),
        (C, First(LOAD, "LOADTL/2,LENGTH,105.0000\nLOADTL/1,LENGTH,105.0000"), Harmless, "the last one counts"),
        (C, First(LOAD, "LOADTL/1,LENGTH,105.0000\nLOADTL/2,LENGTH,105.0000"), Refused, "the last one counts"),
        (C, Last("LOADTL/2,LENGTH,105.0000\n", ""), Refused, "the operation before goes on"),
        (C, First("SPINDL/RPM,12000,CLW\n", ""), Refused, "the spindle stands since the tool change"),
        (C, First(START, "SPINDL/OFF"), Refused, "standstill"),
        (C, Last("\nRAPID\n", "\nSPINDL/RPM,1,CLW\nRAPID\n"), Refused, "it nearly stands in the part"),
        (C, First(START, "SPINDL/ON"), Refused, "the speed is left over"),
        (C, First(START, "SPINDL/RPM,12000"), Refused, "no direction"),
        (C, First(START, "SPINDL/12000,CLW"), Refused, "no unit: surface speed or rpm"),
        (C, First(START, "SPINDL/SMM,12000,CLW"), Refused, "a cutting speed"),
        (C, First(START, "SPINDL/RPM,12000,CCLW"), Refused, "the wrong way round"),
        (C, First(START, "SPINDL/RPM,6000,CLW"), Refused, "another speed than that of the job"),
        (C, First(START, "SPINDL/RPM,0,CLW"), Refused, "standstill"),
        (C, First(START, "SPINDL/RPM,-12000,CLW"), Refused, "negative"),
        (C, First(START, "SPINDL/RPM,12000,CLW,RANGE,HIGH"), Refused, "a gear of one machine"),
        (C, First(START, "SPINDL/12000,RPM,CLW"), Harmless, "the other order"),
        (C, First(START, "SPINDL"), Refused, "nothing behind it"),
        (C, Text("SPINDL before LOADTL", before_the_load), Refused, "the tool change stops the spindle"),
        (C, First("COOLNT/FLOOD\n", ""), Refused, "no coolant"),
        (C, First("COOLNT/FLOOD", "COOLNT/OFF"), Refused, "no coolant"),
        (C, First("COOLNT/FLOOD", "COOLNT"), Refused, "nothing behind it"),
        (C, First("COOLNT/FLOOD", "COOLNT/TAP"), Refused, "oil for tapping"),
        (C, First("COOLNT/FLOOD", "COOLNT/FLOOD,MIST"), Refused, "two words"),
        (C, First("COOLNT/FLOOD", "COOLNT/MIST"), Harmless, "mist"),
        (C, First("COOLNT/FLOOD", "COOLNT/ON"), Harmless, "coolant"),
        (C, First("COOLNT/FLOOD", "COOLNT/THRU"), Harmless, "through the tool"),
        (C, First("MULTAX/ON\n", "MULTAX/ON\nSTOP\n"), Harmless, "stops with the tool retracted"),
        (C, First("MULTAX/ON\n", "MULTAX/ON\nOPSTOP\n"), Harmless, "stops with the tool retracted"),
        (C, First("MULTAX/ON\n", "MULTAX/ON\nDELAY/2.0\n"), Harmless, "waits with the tool retracted"),
        (C, First("MULTAX/ON\n", "MULTAX/ON\nDELAY/-2.0\n"), Refused, "negative"),
        (C, First("MULTAX/ON\n", "MULTAX/ON\nDELAY\n"), Refused, "how long is left over"),
    ]
}

fn before_the_load(text: &str) -> String {
    let bare = text.replacen(&format!("{START}\n"), "", 1);
    bare.replacen(LOAD, &format!("{START}\n{LOAD}"), 1)
}

fn cutters() -> Vec<Kind> {
    const C: &str = "cutter";
    const BALL: &str = "CUTTER/2.0000,1.0000,0.0000,1.0000,0.00000,0.00000,12.0000";
    vec![
        (C, First("CUTTER/2.0000,0.0000,1.0000,0.0000,0.00000,0.00000,12.0000\n", ""), Harmless, "it moves nothing"),
        (C, First(FLAT, "CUTTER/2.0"), Harmless, "the same cylinder by one number"),
        (C, First(FLAT, "CUTTER/2.0,0.0"), Harmless, "the same cylinder by two numbers"),
        (C, First(FLAT, "CUTTER/2.0,1.0"), Refused, "a ball"),
        (C, First(FLAT, "CUTTER/3.0"), Refused, "another diameter"),
        (C, First(FLAT, "CUTTER/2.0,0.0,1.0"), Refused, "three numbers"),
        (C, First(FLAT, "CUTTER/2.0,0.0,1.0,0.0,0.0,0.0,12.0,1.0"), Refused, "eight numbers"),
        (C, First(FLAT, "CUTTER/-2.0"), Refused, "negative"),
        (C, First(FLAT, "CUTTER/"), Refused, "no number"),
        (C, First(FLAT, "CUTTER"), Refused, "no number"),
        (C, First(FLAT, "CUTTER/BALL"), Refused, "no number"),
        (C, First(FLAT, "CUTTER/2.0\nCUTTER/2.0"), Refused, "said twice"),
        (
            C,
            First("LOADTL/1,LENGTH,105.0000\nCUTTER/2.0000,", "CUTTER/2.0\nLOADTL/1,LENGTH,105.0000\nCUTTER/2.0000,"),
            Refused,
            "of an unknown tool",
        ),
        (C, First(BALL, "CUTTER/2.0,1.0"), Harmless, "the same ball by two numbers"),
        (C, First(BALL, "CUTTER/2.0,0.9"), Refused, "a smaller corner radius"),
        (C, First(BALL, "CUTTER/2.0000,1.0000,0.0000,0.0000,0.0,0.0,12.0"), Refused, "the ball begins below the tip"),
        (C, First(BALL, "CUTTER/2.0000,1.0000,0.5000,1.0000,0.0,0.0,12.0"), Refused, "arc and side do not meet"),
        (C, First(BALL, "CUTTER/2.0000,1.0000,0.0000,1.0000,0.0,5.0,12.0"), Refused, "a taper"),
        (C, First(BALL, "CUTTER/2.0000,1.0000,0.0000,1.0000,5.0,0.0,12.0"), Refused, "a point"),
        (C, First(BALL, "CUTTER/2.0000,1.0000,0.0000,1.0000,0.0,90.0,12.0"), Refused, "no side"),
    ]
}

fn stations() -> Vec<Kind> {
    const C: &str = "stations";
    vec![
        (C, Text("no FROM", no_from), Refused, "where the tool stands is unknown"),
        (
            C,
            Text("FROM beside", |t| t.replacen("FROM/", "FROM/1", 1)),
            Refused,
            "stands elsewhere than the motion begins",
        ),
        (C, Text("FROM alone", from_alone), Refused, "a post-processor that skips FROM goes straight down"),
        (C, Text("FROM as a way", |t| t.replacen("FROM/", "RAPID\nGOTO/", 1)), Refused, "from an unknown place"),
        (C, Text("FROM twice", from_twice), Refused, "it stands at one place"),
        (C, Text("FROM lower", lower_start), Refused, "lower than where axes may move"),
        (
            C,
            Text("FROM in the path", |t| before_the_cut(t, "FROM/0.0,0.0,700.0,0.0,0.0,1.0")),
            Refused,
            "moves nothing",
        ),
        (C, Text("FROM without direction", short_from), Refused, "the direction is left over"),
        (C, Text("first GOTO at feed", feed_at_start), Refused, "at feed from the tool change"),
        (C, Text("no way up", no_way_up), Refused, "the tool change is in the part"),
        (C, Text("way up at feed", way_up_at_feed), Refused, "RAPID is missing: the way up at the feed of the cut"),
        (C, Text("way up ends lower", |t| last_z(t, -300.0)), Refused, "lower than where axes may move"),
        (
            C,
            Text("GOHOME", |t| t.replacen("COOLNT/OFF\n", "GOHOME\nCOOLNT/OFF\n", 1)),
            Refused,
            "a way of the post-processor",
        ),
        (
            C,
            Text("RETRCT", |t| t.replacen("COOLNT/OFF\n", "RETRCT\nCOOLNT/OFF\n", 1)),
            Refused,
            "a way of the post-processor",
        ),
        (C, Text("STOP in the path", |t| before_the_cut(t, "STOP")), Refused, "stands in the cut"),
        (C, Text("OPSTOP in the path", |t| before_the_cut(t, "OPSTOP")), Refused, "stands in the cut"),
        (C, Text("DELAY in the path", |t| before_the_cut(t, "DELAY/1.0")), Refused, "stands in the cut"),
        (
            C,
            Text("LOADTL in the path", |t| before_the_cut(t, "LOADTL/2,LENGTH,105.0")),
            Refused,
            "a tool change in the cut",
        ),
        (C, Text("FINI in the path", |t| before_the_cut(t, "FINI")), Refused, "ends in the cut"),
    ]
}

fn without(text: &str, dropped: impl Fn(&str) -> bool) -> String {
    let mut seen = false;
    let kept = text.lines().filter(|l| seen || !dropped(l) || std::mem::replace(&mut seen, true));
    kept.map(|l| format!("{l}\n")).collect()
}

/// The station: its FROM, and RAPID with GOTO behind it.
fn station(text: &str) -> (String, String) {
    let start = text.find("FROM/").unwrap() + "FROM/".len();
    let pose = text[start..start + text[start..].find("RAPID").unwrap()].trim_end();
    let whole = format!("FROM/{pose}\nRAPID\nGOTO/{pose}\n");
    assert!(text.contains(&whole), "{whole}");
    (pose.to_owned(), whole)
}

fn from_alone(text: &str) -> String {
    let (pose, whole) = station(text);
    text.replacen(&whole, &format!("FROM/{pose}\n"), 1)
}

fn from_twice(text: &str) -> String {
    let (pose, whole) = station(text);
    text.replacen(&whole, &format!("FROM/{pose}\n{whole}"), 1)
}

fn no_from(text: &str) -> String {
    let (pose, whole) = station(text);
    text.replacen(&whole, &format!("RAPID\nGOTO/{pose}\n"), 1)
}

fn feed_at_start(text: &str) -> String {
    let (pose, whole) = station(text);
    text.replacen(&whole, &format!("FROM/{pose}\nFEDRAT/1000.0,MMPM\nGOTO/{pose}\n"), 1)
}

fn lower_start(text: &str) -> String {
    let (pose, whole) = station(text);
    let mut values: Vec<f64> = pose.replace(",$\n", ",").split(',').map(|v| v.trim().parse().unwrap()).collect();
    // Along the tool, towards the part.
    for k in 0..3 {
        values[k] -= 200.0 * values[3 + k];
    }
    let [tip, axis] = [0, 3].map(|k| values[k..k + 3].iter().map(|v| format!("{v:.8}")).collect::<Vec<_>>().join(","));
    text.replacen(&whole, &whole.replace(&pose, &format!("{tip},$\n{axis}")), 1)
}

fn short_from(text: &str) -> String {
    let (pose, whole) = station(text);
    let short: Vec<&str> = pose.split(',').take(3).collect();
    text.replacen(&whole, &whole.replacen(&pose, &short.join(","), 1), 1)
}

/// The last RAPID and GOTO of the first operation.
fn way_up(text: &str) -> (usize, usize) {
    let end = text.find("COOLNT/OFF").unwrap();
    (text[..end].rfind("RAPID\n").unwrap(), end)
}

fn no_way_up(text: &str) -> String {
    let (start, end) = way_up(text);
    format!("{}{}", &text[..start], &text[end..])
}

fn way_up_at_feed(text: &str) -> String {
    let (start, _) = way_up(text);
    format!("{}{}", &text[..start], &text[start + "RAPID\n".len()..])
}

fn last_z(text: &str, by: f64) -> String {
    let (start, end) = way_up(text);
    let line = text[start + "RAPID\n".len()..end].lines().next().unwrap();
    let mut values: Vec<String> = line["GOTO/".len()..].split(',').map(str::to_owned).collect();
    values[2] = format!("{:.4}", values[2].parse::<f64>().unwrap() + by);
    text.replacen(line, &format!("GOTO/{}", values.join(",")), 1)
}

fn rapids_and_feeds() -> Vec<Kind> {
    const C: &str = "rapids and feeds";
    vec![
        (C, Text("no first RAPID", |t| without(t, |l| l == "RAPID")), Refused, "at feed, and at none"),
        (C, All("RAPID\n", ""), Refused, "ways at the feed of the cut, and at none"),
        (C, First("RAPID\n", "RAPID\nRAPID\n"), Refused, "one too many: the next motion at rapid as well?"),
        (C, First("RAPID\n", "RAPID/ON\n"), Refused, "no such value"),
        (C, First("RAPID\n", "RAPID $$ over the part\n"), Harmless, "a comment"),
        (C, First("RAPID\n", "RAPID\n$$ over the part\n"), Harmless, "a comment"),
        (C, First("RAPID\n", "RAPID\nLINTOL/0.05\n"), Refused, "post-processors differ in what RAPID counts for"),
        (C, Text("RAPID before FEDRAT", rapid_before_feed), Refused, "post-processors differ in what RAPID counts for"),
        (C, Text("RAPID in the cut", |t| before_the_cut(t, "RAPID")), Refused, "for how many poses?"),
        (C, Text("RAPID for one pose of the cut", rapid_in_the_cut), Found, "through the material at rapid"),
        (C, First("FEDRAT/1000.000,MMPM\n", ""), Refused, "RAPID holds up to FEDRAT in some post-processors"),
        (C, First("FEDRAT/1000.000,MMPM", "FEDRAT/1000.0"), Refused, "a feed of which unit?"),
        (C, First("FEDRAT/1000.000,MMPM", "FEDRAT/1000.0,MMPR"), Refused, "a feed per turn"),
        (C, First("FEDRAT/1000.000,MMPM", "FEDRAT/1000.0,IPM"), Refused, "inches per minute"),
        (C, First("FEDRAT/1000.000,MMPM", "FEDRAT/INVERS,AUTO"), Refused, "inverse time by rules of a post-processor"),
        (C, First("FEDRAT/1000.000,MMPM", "FEDRAT/MMPM,1000.0"), Harmless, "the other order"),
        (C, First("FEDRAT/1000.000,MMPM", "FEDRAT/1000,MMPM"), Harmless, "the same number"),
        (C, First("FEDRAT/1000.000,MMPM", "FEDRAT/1000.0,MMPM,MAXIPM,100"), Refused, "a value too many"),
        (C, First("FEDRAT/1000.000,MMPM", "FEDRAT/0,MMPM"), Refused, "standstill"),
        (C, First("FEDRAT/1000.000,MMPM", "FEDRAT/-1000,MMPM"), Refused, "negative"),
        (C, First("FEDRAT/1000.000,MMPM", "FEDRAT/90000,MMPM"), Refused, "faster than the job"),
        (C, First("FEDRAT/1000.000,MMPM", "FEDRAT"), Refused, "no number"),
        (C, First("FEDRAT/1000.000,MMPM", "FEDRAT/200,MMPM\nFEDRAT/1000,MMPM"), Harmless, "the last one counts"),
        (C, First("FEDRAT/1000.000,MMPM", "FEDRAT/1000,MMPM\nSPINDL/OFF"), Refused, "standstill in the cut"),
        (C, First("FEDRAT/1000.000,MMPM", "FEDRAT/1000,MMPM\nCOOLNT/OFF"), Refused, "no coolant in the cut"),
        (
            C,
            First("FEDRAT/1000.000,MMPM", "FEDRAT/1000,MMPM\nSPINDL/RPM,3000,CLW"),
            Refused,
            "another speed in the cut",
        ),
        (C, First("FEDRAT/1000.000,MMPM", "FEDRAT/1000,MMPM\nCOOLNT/MIST"), Harmless, "mist"),
    ]
}

fn rapid_in_the_cut(text: &str) -> String {
    changed(text, |lines, goto| {
        lines.insert(goto[CUT] + 1, "FEDRAT/250.0,MMPM".to_owned());
        lines.insert(goto[CUT], "RAPID".to_owned());
    })
}

fn rapid_before_feed(text: &str) -> String {
    let at = text.match_indices("RAPID\nGOTO/").nth(1).unwrap().0;
    format!("{}RAPID\nFEDRAT/1000.0,MMPM\n{}", &text[..at], &text[at + "RAPID\n".len()..])
}

fn poses() -> Vec<Kind> {
    const C: &str = "poses";
    vec![
        (C, Text("X by 0.1 mm", |t| moved(t, 0, 0.1)), Found, "gouges"),
        (C, Text("Y by -0.1 mm", |t| moved(t, 1, -0.1)), Found, "gouges"),
        (C, Text("Z by -0.5 mm", |t| moved(t, 2, -0.5)), Found, "gouges"),
        (C, Text("X beyond any machine", |t| moved(t, 0, 1e6)), Refused, "out of range"),
        (C, Text("X far away", |t| moved(t, 0, 3000.0)), Found, "beyond the travel"),
        (C, Text("k reversed", |t| values(t, |v| v[5] = format!("-{}", v[5]))), Refused, "the tool from below"),
        (C, Text("i and j exchanged", |t| values(t, |v| v.swap(3, 4))), Refused, "turns the table through the cut"),
        (C, Text("no k", |t| values(t, |v| drop(v.pop()))), Refused, "five values"),
        (C, Text("tip alone", |t| values(t, |v| v.truncate(3))), Refused, "the direction is left over"),
        (
            C,
            Text("a seventh value", |t| values(t, |v| v.push("100.0".to_owned()))),
            Refused,
            "a feed in some post-processors",
        ),
        (C, Text("an empty value", |t| values(t, |v| v[3].clear())), Refused, "left over, or 0"),
        (C, Text("no direction", |t| values(t, |v| (3..6).for_each(|k| v[k] = "0.0".to_owned()))), Refused, "length 0"),
        (C, Text("direction of length 2", doubled), Refused, "no unit vector: not what a direction is"),
        (C, Text("missing point", |t| values(t, |v| v[0] = v[0].replace('.', ""))), Found, "ten thousand times as far"),
        (C, Text("point as a comma", |t| values(t, |v| v[0] = v[0].replace('.', ","))), Refused, "seven values"),
        (
            C,
            Text("an exponent", |t| values(t, |v| v[0] = format!("{}E0", v[0]))),
            Refused,
            "a number that not all have",
        ),
        (C, Text("two points", |t| values(t, |v| v[0].push_str(".0"))), Refused, "no number"),
        (C, Text("the letter O", |t| values(t, |v| v[0] = "O.5".to_owned())), Refused, "no number"),
        (C, Text("an expression", |t| values(t, |v| v[0] = "1+2".to_owned())), Refused, "no number"),
        (
            C,
            Text("poses left out", |t| changed(t, |l, g| drop(l.drain(g[CUT]..g[CUT + FAR])))),
            Found,
            "cuts the corner",
        ),
        (C, Text("poses as comments", commented), Found, "cuts the corner"),
        (
            C,
            Text("a pose twice", |t| changed(t, |l, g| l.insert(g[CUT], l[g[CUT]].clone()))),
            Harmless,
            "stays where it is",
        ),
        (C, Text("poses exchanged", |t| changed(t, |l, g| l.swap(g[CUT], g[CUT + FAR]))), Found, "back and forth"),
        (C, Text("GODLTA", |t| before_the_cut(t, "GODLTA/0.0,0.0,0.0")), Refused, "from where it stands"),
        (C, Text("CIRCLE", |t| before_the_cut(t, "CIRCLE/0.0,0.0,0.0,0.0,0.0,1.0,5.0")), Refused, "an arc"),
        (C, Text("MOVNRB", |t| before_the_cut(t, "MOVNRB/ON,4,8,0,4,10.0")), Refused, "a spline"),
        (C, Text("CYCLE", |t| before_the_cut(t, "CYCLE/DRILL,5.0,MMPM,100")), Refused, "a stroke at each pose"),
        (C, Text("CUTCOM", |t| before_the_cut(t, "CUTCOM/RIGHT")), Refused, "adds the radius of the tool"),
        (C, Text("ROTABL", |t| before_the_cut(t, "ROTABL/ATANGL,90.0")), Refused, "turns the table"),
        (C, Text("INSERT", |t| before_the_cut(t, "INSERT")), Refused, "words of a control"),
        (C, Text("PPRINT", |t| before_the_cut(t, "PPRINT NEXT LINE")), Harmless, "text for the operator"),
        (C, Text("MULTAX/OFF", |t| before_the_cut(t, "MULTAX/OFF")), Refused, "i j k are left out"),
        (C, Text("UNITS/INCHES", |t| before_the_cut(t, "UNITS/INCHES")), Refused, "inches from here on"),
        (C, Text("an unknown statement", |t| before_the_cut(t, "GOTOO/1.0")), Refused, "no statement"),
    ]
}

fn commented(text: &str) -> String {
    changed(text, |lines, goto| goto[CUT..CUT + FAR].iter().for_each(|i| lines[*i].insert_str(0, "$$ ")))
}

fn doubled(text: &str) -> String {
    values(text, |v| (3..6).for_each(|k| v[k] = format!("{:.8}", 2.0 * v[k].parse::<f64>().unwrap())))
}

fn spelling() -> Vec<Kind> {
    const C: &str = "spelling";
    vec![
        (C, Text("in two lines", |t| folded(t, ",$\n   ")), Harmless, "goes on behind $"),
        (
            C,
            Text("in two lines with a comment", |t| folded(t, ", $ $$ more\n")),
            Harmless,
            "text behind $ is a comment",
        ),
        (C, Text("in two lines without $", |t| folded(t, ",\n")), Refused, "five values are missing"),
        (
            C,
            Text("an empty line in the statement", |t| folded(t, ",$\n\n")),
            Refused,
            "the statement ends there in some",
        ),
        (C, Text("a word in two lines", |t| folded(t, ",$\nGOTO/")), Refused, "a statement within a statement"),
        (C, Text("text behind $", |t| folded(t, ",$ 5.0\n")), Refused, "text behind $ is not read"),
        (
            C,
            Text("beyond column 72", |t| changed(t, |l, g| far_right(l, g))),
            Refused,
            "the end of the statement is not read",
        ),
        (
            C,
            Text("a comment beyond column 72", |t| changed(t, |l, g| far_comment(l, g))),
            Harmless,
            "comments are not read",
        ),
        (C, Text("blanks", |t| t.replace(',', " , ")), Refused, "some lines pass column 72"),
        (C, Text("blanks about the stroke", |t| t.replacen("FEDRAT/", "  FEDRAT /\t", 1)), Harmless, "blanks"),
        (C, Text("small letters", |t| t.replacen("FEDRAT/", "fedrat/", 1)), Refused, "not all read small letters"),
        (C, Text("small units", |t| t.replacen("MMPM", "mmpm", 1)), Refused, "not all read small letters"),
        (C, Text("block numbers", |t| t.replacen("FEDRAT/", "N10 FEDRAT/", 1)), Refused, "none in CL data"),
        (
            C,
            Text("two statements in a line", |t| t.replacen("RAPID\n", "RAPID ; ", 1)),
            Refused,
            "one statement a line",
        ),
        (C, All("\n", "\r\n"), Harmless, "other ends of lines"),
        (C, First("RAPID\n", "RAPID\n\n"), Harmless, "an empty line"),
        (C, All("\n", "\n\n"), Refused, "empty lines within statements as well"),
        (C, First("\nRAPID", "\nRAPID\u{a0}"), Refused, "a blank that is none"),
        (C, First("FEDRAT/", "FEDRAT\u{2044}"), Refused, "a stroke that is none"),
        (C, First("UNITS/MM\n", "UNITS/MM\n\u{7}\n"), Refused, "a control character"),
        (C, First("UNITS/MM\n", "UNITS/MM\n% comment\n"), Refused, "no comment"),
        (C, First("UNITS/MM\n", "UNITS/MM\n; comment\n"), Refused, "no comment"),
        (C, First("UNITS/MM\n", "UNITS/MM\n(comment)\n"), Refused, "no comment"),
    ]
}

fn folded(text: &str, by: &str) -> String {
    changed(text, |lines, goto| lines[goto[CUT]] = lines[goto[CUT]].replacen(',', by, 1))
}

fn far_right(lines: &mut [String], goto: &[usize]) {
    let line = &mut lines[goto[CUT]];
    *line = format!("{}{line}", " ".repeat(74 - line.len()));
}

fn far_comment(lines: &mut [String], goto: &[usize]) {
    let comment = format!(" $$ {}", "far ".repeat(20));
    lines[goto[CUT]].push_str(&comment);
}

fn end() -> Vec<Kind> {
    const C: &str = "end";
    vec![
        (C, Last("FINI\n", ""), Refused, "the text is cut off"),
        (C, Last("FINI\n", "END\n"), Refused, "no such statement"),
        (C, Last("FINI\n", "FINI/1\n"), Refused, "no such value"),
        (C, Last("FINI\n", "FINI\nFINI\n"), Refused, "text behind the end"),
        (C, Last("FINI\n", "FINI\nRAPID\nGOTO/0.0,0.0,0.0,0.0,0.0,1.0\n"), Refused, "text behind the end"),
        (C, Last("FINI\n", "FINI\n$$ the end\n"), Harmless, "a comment"),
        (C, Last("FINI\n", "FINI"), Harmless, "the last line without an end"),
        (C, Last("SPINDL/OFF\n", ""), Refused, "the spindle goes on"),
        (C, Last("COOLNT/OFF\n", ""), Refused, "the coolant goes on"),
        (C, First("SPINDL/OFF\n", ""), Harmless, "it starts again behind the tool change"),
        (C, First("COOLNT/OFF\n", ""), Harmless, "it starts again behind the tool change"),
    ]
}

fn parts(text: &str) -> Vec<String> {
    operations::parts(text, |lines, i| lines[i].starts_with("$$ ") && lines[i + 1] == "UNITS/MM")
}

fn wrong() -> Vec<Kind> {
    const C: &str = "wrong job, machine";
    vec![
        (C, Machine("A opposite", |m| m.rotary[0].word_sign = -1.0), Harmless, "poses have no words of axes"),
        (C, Machine("tools are changed higher", |m| m.retract += 50.0), Refused, "lower than where tools are changed"),
        (C, Machine("Z ends lower", |m| m.linear[2].max -= 50.0), Found, "beyond the travel"),
        (
            C,
            Machine("A ends earlier", |m| (m.rotary[0].min, m.rotary[0].max) = (-0.1, 0.1)),
            Refused,
            "beyond the travel",
        ),
        (
            C,
            Machine("C ends earlier", |m| (m.rotary[1].min, m.rotary[1].max) = (-0.1, 0.1)),
            Refused,
            "beyond the travel",
        ),
        (
            C,
            Machine("X ends earlier", |m| (m.linear[0].min, m.linear[0].max) = (-1.0, 1.0)),
            Found,
            "beyond the travel",
        ),
        (C, Machine("LinuxCNC", |m| m.planning = Planning::LinuxCnc), Refused, "exact stops have no words"),
        (C, Job("no operation", |p| p.operations = PrimaryMap::new()), Refused, "more operations than the job"),
        (C, Job("finer tolerance", |p| p.tolerances.chord = Mm(1e-4)), Refused, "smooths by more than the job allows"),
        (C, All("RPM,12000", "RPM,12001"), Refused, "another speed"),
        (C, All("LOADTL/1", "LOADTL/3"), Refused, "no such tool in the job"),
    ]
}
