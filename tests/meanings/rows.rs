//! Tests of the data as a whole: a row that is written wrongly is refused, every dialect has cases, and every change by a
//! function is used.

use super::cases::{Case, Cases, Change};
use super::{changes, dialect, machines_and_jobs};
use impellerc::nc;
use libtest_mimic::{Failed, Trial};
use std::collections::BTreeSet;

/// Rows that are refused, and words of the reason.
const WRONG: [(&str, &str); 8] = [
    (r#"{ frist = ["a", "b"], refused = "why" }"#, "unknown variant `frist`"),
    (r#"{ first = ["a", "b"], refusd = "why" }"#, "one of refused, found, harmless"),
    (r#"{ first = ["a", "b"] }"#, "one of refused, found, harmless"),
    (r#"{ refused = "why" }"#, "one change"),
    (r#"{ first = ["a", "b"], refused = "why", note = "x" }"#, "one change"),
    (r#"{ first = ["a", "b"], last = ["a", "b"], refused = "why" }"#, "one change"),
    (r#"{ first = ["a", "b"], refused = "why", harmless = "why" }"#, "one of refused, found, harmless"),
    (r#"{ first = ["a"], refused = "why" }"#, "length 2"),
];

fn file(of_all: &str, rows: &str) -> String {
    format!("post = \"fanuc\"\norientation = \"angles\"\n{of_all}\n[cases]\nhead = [\n{rows}\n]\n")
}

fn check(holds: bool, otherwise: impl FnOnce() -> String) -> Result<(), Failed> {
    if holds { Ok(()) } else { Err(otherwise().into()) }
}

fn wrong_rows_are_refused() -> Result<(), Failed> {
    let right = r#"{ first = ["a", "b"], refused = "why" },"#;
    for (row, words) in WRONG {
        let fault = toml::from_str::<Cases>(&file("least = 1", &format!("{right}\n{row}"))).err();
        let said = fault.map(|fault| fault.to_string()).unwrap_or_default();
        check(said.contains(words) && said.contains("line"), || format!("{row}: {said:?}"))?;
    }
    let fault = toml::from_str::<Cases>(&file("least = 1\nmost = 2", right)).err();
    check(fault.is_some_and(|fault| fault.to_string().contains("unknown field `most`")), || "most".to_owned())
}

fn twice_and_too_few_are_told() -> Result<(), Failed> {
    let row = r#"{ first = ["a", "b"], refused = "why" },"#;
    let fault = |least: usize, rows: &str| {
        let cases: Cases = toml::from_str(&file(&format!("least = {least}"), rows)).unwrap();
        cases.fault().unwrap_or_default()
    };
    check(fault(1, row).is_empty(), || fault(1, row))?;
    check(fault(2, row).contains("at least 2"), || fault(2, row))?;
    check(fault(2, &row.repeat(2)).contains("stands twice"), || fault(2, &row.repeat(2)))
}

/// Names of changes by functions, of a kind.
fn names<'a>(cases: impl Iterator<Item = &'a Case>, kind: fn(&Change) -> Option<&str>) -> BTreeSet<&'a str> {
    cases.filter_map(|case| kind(&case.change)).collect()
}

fn text(change: &Change) -> Option<&str> {
    if let Change::Text(name) = change { Some(name) } else { None }
}

fn machine_or_job(change: &Change) -> Option<&str> {
    if let Change::Machine(name) | Change::Job(name) = change { Some(name) } else { None }
}

/// The tests.
pub fn trials(files: &[(String, Result<Cases, String>)]) -> Vec<Trial> {
    let read = || files.iter().filter_map(|(_, cases)| cases.as_ref().ok());
    let mut unused: Vec<String> = Vec::new();
    for post in nc::POSTS.iter().map(|post| post.name()) {
        let used = names(read().filter(|file| file.post == post).flat_map(|file| file.all().map(|(_, c)| c)), text);
        // Mitsubishi has the functions of Fanuc, and cases of what differs.
        if post != "mitsubishi" {
            let own = dialect(post).texts.iter().map(|(name, _)| *name).filter(|name| !used.contains(name));
            unused.extend(own.map(|name| format!("{post}: {name}")));
        }
    }
    let all = || read().flat_map(|file| file.all().map(|(_, case)| case));
    let [texts, others] = [names(all(), text), names(all(), machine_or_job)];
    let of_all = changes::TEXTS.iter().map(|(name, _)| *name).filter(|name| !texts.contains(name));
    let machines = machines_and_jobs::MACHINES.iter().map(|(name, _)| *name);
    let jobs = machines_and_jobs::JOBS.iter().map(|(name, _)| *name);
    unused.extend(of_all.chain(machines.chain(jobs).filter(|name| !others.contains(name))).map(str::to_owned));
    let posts: BTreeSet<&str> = read().map(|file| file.post.as_str()).collect();
    let without: Vec<&str> = nc::POSTS.iter().map(|post| post.name()).filter(|name| !posts.contains(name)).collect();
    vec![
        Trial::test("rows::rows that are written wrongly are refused", wrong_rows_are_refused),
        Trial::test("rows::a row that stands twice and a row too few are told", twice_and_too_few_are_told),
        Trial::test("rows::every dialect has cases", move || {
            check(without.is_empty(), || format!("without cases: {without:?}"))
        }),
        Trial::test("rows::every change by a function is used", move || {
            check(unused.is_empty(), || format!("unused: {unused:?}"))
        }),
    ]
}
