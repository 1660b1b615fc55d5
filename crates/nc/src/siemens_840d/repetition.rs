//! Program parts that are repeated in 840D text, for the reader: labels, and `REPEAT BEGIN END P=1`.
//!
//! The control executes the blocks from one label to the other again, and goes on behind the block with REPEAT (programming
//! manual, "Program part repetition"). Labels must stand before, each alone in its block.

use crate::control::flow::{Flow, MAX_TIMES, Step};
use crate::control::{has_byte, shown};
use std::collections::BTreeMap;

/// Shortest and longest label.
const LABEL: [usize; 2] = [2, 32];

/// Finds labels and repetitions of a text.
pub(super) fn flow(text: &str) -> Flow {
    let mut flow = Flow::default();
    let mut labels: BTreeMap<String, usize> = BTreeMap::new();
    for (at, line) in text.split('\n').enumerate() {
        // Blocks of moves have neither the colon of a label nor the first letter of REPEAT.
        if !has_byte(line, |byte| matches!(byte, b':' | b'R' | b'r')) {
            continue;
        }
        let code = line.split(';').next().unwrap_or_default().trim();
        let code = without_number(code);
        if let Some((name, behind)) = code.split_once(':').filter(|(name, _)| is_label(name)) {
            let name = name.to_ascii_uppercase();
            let step = if !behind.trim().is_empty() {
                Step::Fault(format!("words behind the label `{name}:`: write the label alone in its block"))
            } else if let Some(before) = labels.get(&name) {
                Step::Fault(format!(
                    "the label `{name}` is in line {} as well: give each label a name of its own",
                    before + 1
                ))
            } else {
                labels.insert(name, at);
                Step::Label
            };
            flow.0.insert(at, step);
        } else if let Some(words) = repeat(code) {
            let step = call(words, &labels, at).unwrap_or_else(Step::Fault);
            flow.0.insert(at, step);
        }
    }
    let labels_within: Vec<(usize, Step)> = mixed(&flow, &labels);
    flow.0.extend(labels_within);
    flow.refuse_nested("repeat from the program itself");
    flow
}

/// The words behind REPEAT.
fn repeat(code: &str) -> Option<&str> {
    let start = code.get(..6).filter(|start| start.eq_ignore_ascii_case("REPEAT"))?;
    let behind = &code[start.len()..];
    (behind.is_empty() || behind.starts_with([' ', '\t'])).then_some(behind)
}

fn without_number(code: &str) -> &str {
    let Some(behind) = code.strip_prefix(['N', 'n']) else { return code };
    let rest = behind.trim_start_matches(|c: char| c.is_ascii_digit());
    if rest.len() < behind.len() && rest.starts_with([' ', '\t']) { rest.trim_start() } else { code }
}

fn is_label(name: &str) -> bool {
    let letter = |c: char| c.is_ascii_alphabetic() || c == '_';
    (LABEL[0]..=LABEL[1]).contains(&name.len())
        && name.chars().take(2).all(letter)
        && name.chars().all(|c| letter(c) || c.is_ascii_digit())
}

/// The repetition of a block.
fn call(words: &str, labels: &BTreeMap<String, usize>, at: usize) -> Result<Step, String> {
    let due = "write `REPEAT BEGIN END P=1` with the labels of the first and the last block";
    let words: Vec<&str> = words.split([' ', '\t']).filter(|w| !w.is_empty()).collect();
    let (first, last, count) = match words.as_slice() {
        [first, last] => (first, last, "P=1"),
        [first, last, count] => (first, last, *count),
        _ => return Err(format!("REPEAT with {} words: {due}", words.len())),
    };
    let times = count.strip_prefix(['P', 'p']).map(|t| t.strip_prefix('=').unwrap_or(t));
    let times = times.and_then(|t| t.parse::<u32>().ok()).filter(|t| (1..=MAX_TIMES).contains(t));
    let times = times
        .ok_or_else(|| format!("`{}` of REPEAT is not read: write P=1, at most P={MAX_TIMES}", shown(count, 20)))?;
    let line = |name: &str| {
        labels
            .get(&name.to_ascii_uppercase())
            .copied()
            .ok_or_else(|| format!("REPEAT names the label `{}`, and no block before has it: {due}", shown(name, 40)))
    };
    let lines = line(first)?..line(last)? + 1;
    if lines.len() < 2 || lines.end > at {
        return Err(format!("the label `{}` is not behind `{}`: {due}", shown(last, 40), shown(first, 40)));
    }
    Ok(Step::Call { lines, times, arguments: Vec::new() })
}

/// Labels of one repeated part within another one.
fn mixed(flow: &Flow, labels: &BTreeMap<String, usize>) -> Vec<(usize, Step)> {
    let parts = || {
        flow.0.values().filter_map(|step| match step {
            Step::Call { lines, .. } => Some(lines.clone()),
            _ => None,
        })
    };
    let mut found = Vec::new();
    for (name, at) in labels {
        let used = parts().any(|p| p.start == *at || p.end == *at + 1);
        let inside = parts().find(|p| p.start < *at && *at + 1 < p.end);
        if let (true, Some(part)) = (used, inside) {
            let reason = format!(
                "the label `{name}` of a repeated part is inside of another one, which begins in line {}: repeat parts that are apart",
                part.start + 1
            );
            found.push((*at, Step::Fault(reason)));
        }
    }
    found
}
