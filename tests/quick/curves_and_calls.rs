//! Words of polynomials and of calls. Whatever one of their numbers is changed to, the text is refused, or the motion that is
//! read is another one, which the verifier then measures. None is read as the motion that was meant.

use crate::{sector_subprograms, splines};
use impellerc::base::source::Span;
use impellerc::diagnostics::Sink;
use impellerc::ir::{Motion, Program};
use impellerc::nc::compare::ComparedMotion;
use impellerc::nc::{self, motion_of::motion_of};
use impellerc::nc_text::compare;
use std::ops::Range;

/// What is added to a number with and without a point: at least three steps of any word.
const ADDED: [f64; 2] = [0.3, 1.0];

/// What is added to a feed.
const FASTER: f64 = 20.0;

/// The motion of a text; `None` where it is refused.
fn read(program: &Program, text: &str) -> Option<Motion> {
    let sections = nc::find(&program.post.dialect).unwrap().read(text, &program.machine).ok()?;
    let mut sink = Sink::default();
    let motion = motion_of(program, &sections, &|_| Span::default(), &mut sink)?;
    (!sink.has_errors()).then_some(motion.motion)
}

/// Places of the numbers of a line, without that of the block at its start.
fn numbers(line: &str) -> Vec<Range<usize>> {
    let number = |c: char| c.is_ascii_digit() || c == '.';
    let mut found = Vec::new();
    let head = line.trim_start_matches('N');
    let block = if head.starts_with(|c: char| c.is_ascii_digit()) { line.find(' ').unwrap_or(0) } else { 0 };
    let mut at = block;
    while let Some(start) = line[at..].find(number).map(|n| n + at) {
        let end = line[start..].find(|c| !number(c)).map_or(line.len(), |n| n + start);
        // A parameter without a value in this line keeps the one that it has, which may be the same.
        if !(line[..start].ends_with(" R") && line[end..].starts_with('=')) {
            found.push(start..end);
        }
        at = end;
    }
    found
}

/// A line with another number in one place.
fn with_other(line: &str, place: &Range<usize>) -> String {
    let number = &line[place.clone()];
    let digits = number.split_once('.').map_or(0, |(_, behind)| behind.len());
    let value: f64 = number.parse().unwrap();
    let feed = line[..place.start].ends_with(" F");
    let other = value + if feed { FASTER } else { ADDED[usize::from(digits == 0)] };
    format!("{}{other:.digits$}{}", &line[..place.start], &line[place.end..])
}

/// Changes each number of some lines, and drops each of these lines. Returns the numbers of changes that were refused, and of
/// those that gave another motion.
fn change_all(program: &Program, text: &str, lines: &[usize]) -> [usize; 2] {
    let meant = read(program, text).expect("the text as it was written");
    let all: Vec<&str> = text.lines().collect();
    let mut counts = [0; 2];
    for at in lines {
        let line = all[*at];
        let changes = numbers(line).into_iter().map(|place| with_other(line, &place) + "\n");
        for change in changes.chain([String::new()]) {
            let changed: String =
                all.iter().enumerate().map(|(k, l)| if k == *at { change.clone() } else { format!("{l}\n") }).collect();
            let Some(motion) = read(program, &changed) else {
                counts[0] += 1;
                continue;
            };
            counts[1] += 1;
            let same = compare([&motion, &meant].map(|motion| ComparedMotion { program, motion }));
            assert!(same.iter().any(|o| !o.is_same()), "line {} is read as what it was: {line} -> {change}", at + 1);
        }
    }
    counts
}

/// Lines of a text that hold one of some words.
fn holding(text: &str, words: &[&str]) -> Vec<usize> {
    let holds =
        |line: &str| words.iter().any(|word| line.contains(word)) && !line.contains(';') && !line.starts_with('(');
    text.lines().enumerate().filter(|(_, line)| holds(line)).map(|(k, _)| k).collect()
}

#[test]
fn each_number_of_polynomials_counts() {
    for (name, program, text) in splines::texts() {
        let lines = match name {
            "siemens-840d" => {
                let polynomials = holding(text, &["PO["]);
                let starts = holding(text, &[" XH="]);
                vec![starts[0], polynomials[0], polynomials[1], polynomials[polynomials.len() / 2]]
            }
            "apt-cl" => {
                let [begins, nexts] = ["MOVNRB/5AXIS", "MOVNRB/NEXT"].map(|word| holding(text, &[word]));
                let middle = begins.len() / 2;
                (begins[middle]..=nexts[middle]).collect()
            }
            _ => {
                let blocks = holding(text, &["SPL "]);
                let middle = blocks[blocks.len() / 2];
                (middle..=middle + 5).collect()
            }
        };
        let [refused, others] = change_all(program, text, &lines);
        println!("{name}: {refused} changes of polynomials refused, {others} read as another motion");
        assert!(refused + others > 40, "{name}");
    }
}

/// A post-processor may go along the GOTO: none of their numbers may be another one, none may be missing over a bend, and the last
/// one ends where the curve does.
#[test]
fn goto_within_curves_are_the_same_motion() {
    let (_, program, text) = splines::texts().into_iter().find(|(name, ..)| *name == "apt-cl").unwrap();
    let all: Vec<&str> = text.lines().collect();
    let [nexts, offs] = ["MOVNRB/NEXT", "MOVNRB/OFF"].map(|word| holding(text, &[word]));
    let with = |change: &dyn Fn(usize) -> Option<String>| -> String {
        (0..all.len()).filter_map(change).map(|line| line + "\n").collect()
    };
    let kept = |k: usize| Some(all[k].to_owned());
    assert!(read(program, &with(&kept)).is_some());
    let middle = nexts.len() / 2;
    let [next, off] = [nexts[middle], offs[middle]];
    let mut changes = 0;
    for at in next + 1..off.min(next + 7) {
        for place in numbers(all[at]) {
            let change = |k: usize| if k == at { Some(with_other(all[k], &place)) } else { kept(k) };
            assert!(read(program, &with(&change)).is_none(), "{}", all[at]);
            changes += 1;
        }
    }
    assert!(changes >= 18, "{changes}");
    // Without the last GOTO, with the last two exchanged, and with the last one alone: one way over the whole bend.
    let starts: Vec<usize> = (next + 1..off).filter(|k| all[*k].starts_with("GOTO")).collect();
    let [before, last] = [starts[starts.len() - 2], starts[starts.len() - 1]];
    let without = |k: usize| if (last..off).contains(&k) { None } else { kept(k) };
    assert!(read(program, &with(&without)).is_none());
    let exchanged = |k: usize| match k {
        _ if k >= before && k < before + off - last => kept(k + last - before),
        _ if k >= before + off - last && k < off => kept(k - (off - last)),
        _ => kept(k),
    };
    assert!(last - before != off - last || read(program, &with(&exchanged)).is_none());
    let alone = |k: usize| if (next + 1..last).contains(&k) { None } else { kept(k) };
    let found = nc::find("apt-cl").unwrap().read(&with(&alone), &program.machine);
    println!("{:?}", found.as_ref().err().map(|faults| &faults[0].reason));
    assert!(found.is_err_and(|faults| faults[0].reason.contains("over LINTOL")));
}

/// Two coefficients of SPL against each other leave both ends where they are.
#[test]
fn a_cubic_between_the_same_ends_is_another_one() {
    let (_, program, text) = splines::texts().into_iter().find(|(name, ..)| *name == "heidenhain-itnc530").unwrap();
    let meant = read(program, text).unwrap();
    let blocks = holding(text, &["SPL "]);
    let block = blocks[blocks.len() / 2];
    let all: Vec<&str> = text.lines().collect();
    let mut seen = 0;
    // Of X, Y, Z and of both rotary axes.
    for at in block + 1..=block + 5 {
        let shifted = |word: &str, by: f64| {
            let sign = word.find(['+', '-']).unwrap();
            match word[sign..].parse::<f64>() {
                Ok(value) => format!("{}{:+.8}", &word[..sign], value + by),
                Err(_) => word.to_owned(),
            }
        };
        let words: Vec<String> = all[at]
            .split_whitespace()
            .map(|word| match word.get(..2) {
                Some("K3") => shifted(word, 0.05),
                Some("K1") => shifted(word, -0.05),
                _ => word.to_owned(),
            })
            .collect();
        let line = format!("  {}", words.join(" "));
        let changed: String =
            all.iter().enumerate().map(|(k, l)| if k == at { line.clone() } else { (*l).to_owned() } + "\n").collect();
        // A large coefficient has an exponent, which makes the change a larger one.
        let Some(motion) = read(program, &changed) else { continue };
        seen += 1;
        let same = compare([&motion, &meant].map(|motion| ComparedMotion { program, motion }));
        assert!(same.iter().any(|o| !o.is_same()), "{} -> {line}", all[at]);
    }
    assert!(seen >= 3, "{seen}");
}

#[test]
fn each_number_of_calls_counts() {
    for (program, text) in sector_subprograms::texts() {
        let words = match program.post.dialect.as_str() {
            "linuxcnc" => ["o101 ", "o102 ", "G10 "],
            _ => ["SUB_", "ROT", "R90="],
        };
        // The resets at the start of the operation say what is so already.
        let first = holding(&text, &[words[0]])[0];
        let lines: Vec<usize> = holding(&text, &words).into_iter().filter(|k| *k >= first).collect();
        let [refused, others] = change_all(&program, &text, &lines);
        println!("{}: {refused} changes of calls refused, {others} read as another motion", program.post.dialect);
        assert!(refused > 10 && others > 3, "{} {refused} {others}", program.post.dialect);
        // A call that stands twice cuts twice.
        let all: Vec<&str> = text.lines().collect();
        let call = lines.iter().find(|k| all[**k].contains("REPEAT") || all[**k].contains(" call ")).unwrap();
        let twice: String =
            all.iter().enumerate().map(|(k, l)| format!("{l}\n").repeat(1 + usize::from(k == *call))).collect();
        let meant = read(&program, &text).unwrap();
        let same = read(&program, &twice).map(|motion| {
            let sides = [&motion, &meant].map(|motion| ComparedMotion { program: &program, motion });
            compare(sides).iter().all(|o| o.is_same() && o.moves[0] == o.moves[1])
        });
        assert_ne!(same, Some(true), "{}", all[*call]);
    }
}
