//! Counts of what became of the cases, by file and class.

use super::judging::Verdict;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Mutex;

type Counts = BTreeMap<(String, Verdict), usize>;

static TALLY: Mutex<BTreeMap<String, Counts>> = Mutex::new(BTreeMap::new());

/// A case of a file and a class has become this.
pub fn count(file: &str, class: &str, verdict: Verdict) {
    let mut tally = TALLY.lock().unwrap();
    *tally.entry(file.to_owned()).or_default().entry((class.to_owned(), verdict)).or_default() += 1;
}

/// Shows what was said of a case, where MEANINGS_LIST is set.
pub fn list(line: impl FnOnce() -> String) {
    if std::env::var_os("MEANINGS_LIST").is_some() {
        println!("{}", line());
    }
}

/// Prints the counts of the cases that were run.
pub fn print() {
    for (file, counts) in &*TALLY.lock().unwrap() {
        let all: usize = counts.values().sum();
        println!("\n{file}: {all} cases\n  {:<18} {:>8} {:>6} {:>9}", "class", "refused", "found", "harmless");
        let line = |class: &str, belongs: &dyn Fn(&str) -> bool| {
            let [refused, found, harmless] = Verdict::DUE
                .map(|due| counts.iter().filter(|((c, v), _)| belongs(c) && *v == due).map(|(_, n)| n).sum::<usize>());
            println!("  {class:<18} {refused:>8} {found:>6} {harmless:>9}");
        };
        for class in counts.keys().map(|(class, _)| class).collect::<BTreeSet<_>>() {
            line(class, &|c| c == class);
        }
        line("all", &|_| true);
    }
}
