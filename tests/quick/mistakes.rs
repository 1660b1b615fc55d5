//! What people write by mistake, in the table `mistakes.toml`: each mistake gives at most two errors or warnings, at its place,
//! and a job that follows the help has none of them. `docs/mistakes.md` shows the table with the messages.

use impellerc::diagnostics::{Diag, Severity};
use impellerc::driver::{self, Options, RunOptions, Stages};
use rayon::prelude::*;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;
use std::sync::LazyLock;

/// A mistake.
#[derive(Deserialize)]
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

/// Messages of the jobs without a mistake.
static UNCHANGED: LazyLock<BTreeMap<&'static str, Vec<Said>>> = LazyLock::new(|| {
    let messages = |job: &'static str| {
        let text = std::fs::read_to_string(format!("jobs/{job}/{job}.imp")).unwrap();
        (job, check(job, &format!("{job}.imp"), &text))
    };
    ["small", "splitter"].into_iter().map(messages).collect()
});

/// The row of a mistake for people; or what is wrong with its messages.
fn row(mistake: &Mistake) -> Result<String, String> {
    let Mistake { name, job, file, change, right, code, label, messages } = mistake;
    let job = job.as_deref().unwrap_or("small");
    let file = file.clone().unwrap_or_else(|| format!("{job}.imp"));
    let folder = if file.ends_with(".toml") { "_lib" } else { job };
    let text = std::fs::read_to_string(Path::new("jobs").join(folder).join(&file)).unwrap();
    let before = &UNCHANGED[job];
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

#[test]
fn mistakes_are_told_once_at_their_place_with_a_remedy_that_works() {
    let tables = [include_str!("mistakes.toml"), include_str!("mistakes_2.toml")];
    let mistakes: Vec<Mistake> = tables.into_iter().flat_map(|t| toml::from_str::<Table>(t).unwrap().mistake).collect();
    assert!(mistakes.len() >= 278, "{}", mistakes.len());
    let rows: Vec<Result<String, String>> = mistakes.par_iter().map(row).collect();
    let faults: Vec<&String> = rows.iter().filter_map(|r| r.as_ref().err()).collect();
    assert!(faults.is_empty(), "{faults:#?}");
    let mut page = String::from(
        "# What people write, and what the compiler says\n\nA test makes each of these mistakes in a job, and then follows the help. \
         `impellerc explain CODE` tells more of a message.\n\n| mistake | marked | message | help |\n|---|---|---|---|\n",
    );
    for row in rows.iter().flatten() {
        let _ = write!(page, "{row}");
    }
    let path = "docs/mistakes.md";
    if std::env::var_os("INSTA_UPDATE").is_some_and(|how| how == "always") {
        std::fs::write(path, &page).unwrap();
    }
    assert!(
        std::fs::read_to_string(path).unwrap_or_default() == page,
        "write it again: INSTA_UPDATE=always, this test"
    );
}
