//! Whole operations dropped, doubled and swapped, in every dialect.

use super::Change::Operations;
use super::Kind;
use super::Verdict::{self, Harmless, Refused};

/// The head of a text and its operations, without its last line. `begins` says whether an operation begins at a line.
pub fn parts(text: &str, begins: impl Fn(&[&str], usize) -> bool) -> Vec<String> {
    let lines: Vec<&str> = text.lines().collect();
    let last = lines.len() - 1;
    let mut starts = vec![0];
    starts.extend((1..last).filter(|i| begins(&lines, *i)));
    starts.push(last);
    starts.windows(2).map(|w| lines[w[0]..w[1]].join("\n") + "\n").collect()
}

/// Kinds for a text of a head and three operations.
pub fn kinds(parts: fn(&str) -> Vec<String>) -> Vec<Kind> {
    const C: &str = "wrong job, machine";
    let orders: [(&str, &[usize], Verdict, &str); 5] = [
        ("first operation missing", &[0, 2, 3], Refused, "not the operations of the job"),
        ("last operation missing", &[0, 1, 2], Refused, "not the operations of the job"),
        ("operation twice", &[0, 1, 1, 2, 3], Refused, "not the operations of the job"),
        ("operations swapped", &[0, 2, 1, 3], Refused, "not the order of the job"),
        ("no head", &[1, 2, 3], Harmless, "each operation says all that it needs"),
    ];
    orders.into_iter().map(|(what, order, due, why)| (C, Operations(what, parts, order), due, why)).collect()
}
