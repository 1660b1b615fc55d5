//! What people write by mistake, in the tables `*.toml`: each mistake gives at most two errors or warnings, at its place,
//! and a job that follows the help has none of them. `docs/mistakes.md` shows the tables with the messages.
//!
//! Each row is a test with the name `code::what happened`:
//!
//!     cargo test --test mistakes -- IMP0112
//!     INSTA_UPDATE=always cargo test --test mistakes    # writes the page again

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use impellerc::diagnostics::{Diag, Severity};
use impellerc::driver::{self, Options, RunOptions, Stages};
use libtest_mimic::{Arguments, Failed, Trial};
use serde::Deserialize;
use std::fmt::Write as _;
use std::path::Path;
use std::sync::{LazyLock, OnceLock};

/// The least number of mistakes.
const LEAST: usize = 277;

/// A mistake.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Mistake {
    /// What happened.
    name: String,
    /// The job, `small` where it is left out.
    job: Option<String>,
    /// The file beside the job, or in the library (`tools/carbide.toml`), where it happens there.
    file: Option<String>,
    /// Texts of the job and what stands there by mistake.
    change: Vec<[String; 2]>,
    /// What a person changes who follows the help.
    right: Vec<[String; 2]>,
    /// Code of the first message.
    code: String,
    /// Text that the message marks.
    label: String,
    /// Number of messages.
    messages: usize,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    mistake: Vec<Mistake>,
}

fn changed(text: &str, changes: &[[String; 2]], name: &str) -> String {
    changes.iter().fold(text.to_owned(), |text, [from, to]| {
        assert_eq!(text.matches(from.as_str()).count(), 1, "{name}: {from:?}");
        text.replacen(from.as_str(), to, 1)
    })
}

/// A message, and the text that it marks.
struct Said {
    diag: Diag,
    marks: String,
}

/// Errors and warnings of a check.
fn check(job: &str, file: &str, text: &str) -> Vec<Said> {
    let folder = tempfile::tempdir().unwrap();
    let own = Path::new("jobs").join(job);
    for entry in std::fs::read_dir(&own).unwrap() {
        let path = entry.unwrap().path();
        if path.is_file() {
            std::fs::copy(&path, folder.path().join(path.file_name().unwrap())).unwrap();
        }
    }
    let place = if file.ends_with(".toml") { folder.path().join("lib").join(file) } else { folder.path().join(file) };
    std::fs::create_dir_all(place.parent().unwrap()).unwrap();
    std::fs::write(place, text).unwrap();
    // Other files of the library are those that ship.
    let run =
        RunOptions { library: file.ends_with(".toml").then(|| folder.path().join("lib")), ..RunOptions::default() };
    let options = Options { job: folder.path().join(format!("{job}.imp")), run, ..Options::default() };
    let outcome = driver::check(&options, &mut Stages::default());
    let harmful = outcome.sink.diags().iter().filter(|d| d.severity != Severity::Remark);
    let marks = |diag: &Diag| {
        let span = diag.labels.first().map(|label| label.span)?;
        outcome.sources.get(span.source)?.text.get(span.range()).map(str::to_owned)
    };
    harmful.map(|diag| Said { diag: diag.clone(), marks: marks(diag).unwrap_or_default() }).collect()
}

/// Messages that the unchanged job does not have.
fn new(said: Vec<Said>, before: &[Said]) -> Vec<Said> {
    let known = |s: &Said| before.iter().any(|b| b.diag.code == s.diag.code && b.diag.message == s.diag.message);
    said.into_iter().filter(|s| !known(s)).collect()
}

/// Messages of a job without a mistake.
fn unchanged(job: &str) -> &'static [Said] {
    static SMALL: LazyLock<Vec<Said>> = LazyLock::new(|| of_job("small"));
    static SPLITTER: LazyLock<Vec<Said>> = LazyLock::new(|| of_job("splitter"));
    match job {
        "small" => &SMALL,
        "splitter" => &SPLITTER,
        other => panic!("no mistakes are made in {other}"),
    }
}

fn of_job(job: &str) -> Vec<Said> {
    let text = std::fs::read_to_string(format!("jobs/{job}/{job}.imp")).unwrap();
    check(job, &format!("{job}.imp"), &text)
}

/// The row of a mistake for people; or what is wrong with its messages.
fn row(mistake: &Mistake) -> Result<String, String> {
    let Mistake { name, job, file, change, right, code, label, messages } = mistake;
    let job = job.as_deref().unwrap_or("small");
    let file = file.clone().unwrap_or_else(|| format!("{job}.imp"));
    let folder = if file.ends_with(".toml") { "_lib" } else { job };
    let text = std::fs::read_to_string(Path::new("jobs").join(folder).join(&file)).unwrap();
    let before = unchanged(job);
    let wrong = changed(&text, change, name);
    let found = new(check(job, &file, &wrong), before);
    let listed =
        || found.iter().map(|s| format!("{} {:?}: {}", s.diag.code.id(), s.marks, s.diag.message)).collect::<Vec<_>>();
    let Some(first) = found.first() else { return Err(format!("{name}: nothing is said")) };
    if found.len() > 2 || found.len() != *messages || first.diag.code.id() != code || first.marks.trim() != label.trim()
    {
        return Err(format!("{name}: {:#?}", listed()));
    }
    let after = new(check(job, &file, &changed(&wrong, right, name)), before);
    if let Some(left) = after.first() {
        return Err(format!("{name}, after its remedy: {}", left.diag.message));
    }
    let short = |text: &str| text.trim().lines().next().unwrap_or_default().replace('|', "\\|");
    let help = first.diag.help.as_deref().unwrap_or_default();
    Ok(format!("| {name} | `{}` | {code}: {} | {} |\n", short(label), short(&first.diag.message), short(help)))
}

/// A mistake, and its row of the page once it was made.
struct Case {
    mistake: Mistake,
    row: OnceLock<Result<String, String>>,
}

impl Case {
    fn row(&self) -> Result<&str, &str> {
        self.row.get_or_init(|| row(&self.mistake)).as_deref().map_err(String::as_str)
    }
}

/// All rows, or what is wrong with a table.
fn cases() -> Result<Vec<Case>, String> {
    let mut paths: Vec<_> = std::fs::read_dir("tests/mistakes").unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == "toml"));
    paths.sort();
    let mut cases = Vec::new();
    for path in paths {
        let text = std::fs::read_to_string(&path).unwrap();
        let table: Table = toml::from_str(&text).map_err(|fault| format!("{}: {fault}", path.display()))?;
        cases.extend(table.mistake.into_iter().map(|mistake| Case { mistake, row: OnceLock::new() }));
    }
    Ok(cases)
}

/// No row is missing, and none stands twice.
fn whole(cases: &[Case]) -> Result<(), Failed> {
    if cases.len() < LEAST {
        return Err(format!("{} mistakes, at least {LEAST} are due", cases.len()).into());
    }
    let twice = |key: &dyn Fn(&Mistake) -> String| {
        let mut keys: Vec<String> = cases.iter().map(|case| key(&case.mistake)).collect();
        keys.sort();
        keys.windows(2).find(|w| w[0] == w[1]).map(|w| format!("{} stands twice", w[0]))
    };
    let same = twice(&|m| m.name.clone()).or_else(|| twice(&|m| format!("{:?} {:?} {:?}", m.job, m.file, m.change)));
    same.map_or(Ok(()), |fault| Err(fault.into()))
}

/// The page shows all of them.
fn page(cases: &[Case]) -> Result<(), Failed> {
    let mut page = String::from(
        "# What people write, and what the compiler says\n\nA test makes each of these mistakes in a job, and then follows the help. \
         `impellerc explain CODE` tells more of a message.\n\n| mistake | marked | message | help |\n|---|---|---|---|\n",
    );
    for case in cases {
        let _ = write!(page, "{}", case.row()?);
    }
    let path = "docs/mistakes.md";
    if std::env::var_os("INSTA_UPDATE").is_some_and(|how| how == "always") {
        std::fs::write(path, &page).unwrap();
    }
    if std::fs::read_to_string(path).unwrap_or_default() == page {
        Ok(())
    } else {
        Err("write it again: INSTA_UPDATE=always, this test".into())
    }
}

fn trials() -> Vec<Trial> {
    let cases: &'static [Case] = match cases() {
        Ok(cases) => cases.leak(),
        Err(fault) => return vec![Trial::test("tables::are read", || Err(fault.into()))],
    };
    let mut trials = vec![Trial::test("tables::no row is missing, and none stands twice", || whole(cases))];
    trials.extend(cases.iter().map(|case| {
        let name = format!("{}::{}", case.mistake.code, case.mistake.name);
        Trial::test(name, || Ok(case.row().map(drop)?))
    }));
    // Last: the rows are there then.
    trials.push(Trial::test("tables::docs/mistakes.md shows them all", || page(cases)));
    trials
}

fn main() {
    let mut arguments = Arguments::from_args();
    // All of them are more lines than anybody reads.
    arguments.quiet |= arguments.filter.is_none() && arguments.format.is_none() && !arguments.list;
    libtest_mimic::run(&arguments, trials()).exit();
}
