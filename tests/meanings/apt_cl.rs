//! Changes of CL data of APT by functions.

use super::changes::{Dialect, Named, TextChange};

pub const DIALECT: Dialect = Dialect {
    begins: |lines, i| lines[i].starts_with("$$ ") && lines[i + 1] == "UNITS/MM",
    in_the_cut: pose_in_the_cut,
    texts: TEXTS,
};

const TEXTS: &[Named<TextChange>] = &[
    ("SPINDL before LOADTL", before_the_load),
    ("no FROM", no_from),
    ("FROM alone", from_alone),
    ("FROM twice", from_twice),
    ("FROM lower", lower_start),
    ("FROM without direction", short_from),
    ("first GOTO at feed", feed_at_start),
    ("no way up", no_way_up),
    ("way up at feed", way_up_at_feed),
    ("way up ends lower", |t| last_z(t, -300.0)),
    ("RAPID before FEDRAT", rapid_before_feed),
    ("RAPID for one pose of the cut", rapid_in_the_cut),
    ("X by 0.1 mm", |t| moved(t, 0, 0.1)),
    ("Y by -0.1 mm", |t| moved(t, 1, -0.1)),
    ("Z by -0.5 mm", |t| moved(t, 2, -0.5)),
    ("X beyond any machine", |t| moved(t, 0, 1e6)),
    ("X far away", |t| moved(t, 0, 3000.0)),
    ("k reversed", |t| values(t, |v| v[5] = format!("-{}", v[5]))),
    ("i and j exchanged", |t| values(t, |v| v.swap(3, 4))),
    ("no k", |t| values(t, |v| drop(v.pop()))),
    ("tip alone", |t| values(t, |v| v.truncate(3))),
    ("a seventh value", |t| values(t, |v| v.push("100.0".to_owned()))),
    ("an empty value", |t| values(t, |v| v[3].clear())),
    ("no direction", |t| values(t, |v| (3..6).for_each(|k| v[k] = "0.0".to_owned()))),
    ("direction of length 2", doubled),
    ("missing point", |t| values(t, |v| v[0] = v[0].replace('.', ""))),
    ("point as a comma", |t| values(t, |v| v[0] = v[0].replace('.', ","))),
    ("an exponent", |t| values(t, |v| v[0] = format!("{}E0", v[0]))),
    ("two points", |t| values(t, |v| v[0].push_str(".0"))),
    ("the letter O", |t| values(t, |v| v[0] = "O.5".to_owned())),
    ("an expression", |t| values(t, |v| v[0] = "1+2".to_owned())),
    ("poses left out", |t| changed(t, |l, g| drop(l.drain(g[CUT]..g[CUT + FAR])))),
    ("poses as comments", commented),
    ("a pose twice", |t| changed(t, |l, g| l.insert(g[CUT], l[g[CUT]].clone()))),
    ("poses exchanged", |t| changed(t, |l, g| l.swap(g[CUT], g[CUT + FAR]))),
    ("in two lines", |t| folded(t, ",$\n   ")),
    ("in two lines with a comment", |t| folded(t, ", $ $$ more\n")),
    ("in two lines without $", |t| folded(t, ",\n")),
    ("an empty line in the statement", |t| folded(t, ",$\n\n")),
    ("a word in two lines", |t| folded(t, ",$\nGOTO/")),
    ("text behind $", |t| folded(t, ",$ 5.0\n")),
    ("beyond column 72", |t| changed(t, |l, g| far_right(l, g))),
    ("a comment beyond column 72", |t| changed(t, |l, g| far_comment(l, g))),
];

/// Start of the pose in the cut.
fn pose_in_the_cut(text: &str) -> usize {
    changed(text, |lines, goto| lines.truncate(goto[CUT])).len()
}

const LOAD: &str = "LOADTL/1,LENGTH,105.0000";
const START: &str = "SPINDL/RPM,12000,CLW";

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

fn before_the_load(text: &str) -> String {
    let bare = text.replacen(&format!("{START}\n"), "", 1);
    bare.replacen(LOAD, &format!("{START}\n{LOAD}"), 1)
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

fn commented(text: &str) -> String {
    changed(text, |lines, goto| goto[CUT..CUT + FAR].iter().for_each(|i| lines[*i].insert_str(0, "$$ ")))
}

fn doubled(text: &str) -> String {
    values(text, |v| (3..6).for_each(|k| v[k] = format!("{:.8}", 2.0 * v[k].parse::<f64>().unwrap())))
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
