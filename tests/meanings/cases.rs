//! The cases as data: `dialects/*.toml`, a file a dialect, or a way to state tool directions in it. A case is a row: what is
//! changed, and what has to become of the text with the reason by the manual of the control.
//!
//!     { first = ["G710 ", "G700 "], refused = "inches" },
//!
//! The verdicts are those of [`Verdict`], the changes those of [`Change`], in small letters.

use super::judging::Verdict;
use impellerc::wheel::control::Orientation;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A file of cases.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cases {
    /// Name of the dialect.
    pub post: String,
    #[serde(deserialize_with = "orientation")]
    pub orientation: Orientation,
    /// The least number of cases.
    pub least: usize,
    /// By class.
    pub cases: BTreeMap<String, Vec<Case>>,
}

/// A row.
#[derive(Deserialize)]
#[serde(try_from = "toml::Table")]
pub struct Case {
    pub change: Change,
    pub due: Verdict,
    /// The reason by the manual of the control.
    pub why: String,
}

/// A change of the text, of the machine or of the job. A piece that a change needs has to be there.
#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Change {
    /// The first occurrence of a piece is replaced.
    First([String; 2]),
    /// The last one.
    Last([String; 2]),
    /// All of them.
    All([String; 2]),
    /// The first one from the block in the cut on; that block is the third one at feed.
    Path([String; 2]),
    /// A line (without its end) goes behind the first line that begins like this.
    Move([String; 2]),
    /// The first line that begins like this changes places with the next one.
    Swap(String),
    /// All lines that begin like this are missing.
    Without(String),
    /// A line goes before the block in the cut.
    Insert(String),
    /// Before the whole text.
    Prefix(String),
    /// Behind the whole text.
    Suffix(String),
    /// In the block in the cut the word of an address stands twice.
    Twice(String),
    /// It is missing.
    Missing(String),
    /// The word of an address has another number.
    Number([String; 2]),
    /// The number of an address has another address.
    Address([String; 2]),
    /// The head of the text (0) and its operations (from 1), in this order.
    Order(Vec<usize>),
    /// A change of the text by a function of the dialect.
    Text(String),
    /// Another machine, from `machines_and_jobs.rs`.
    Machine(String),
    /// Another job, from there.
    Job(String),
}

impl Change {
    /// As names of tests show it.
    pub fn shown(&self) -> String {
        match self {
            Self::First([from, to]) => format!("{from:?} -> {to:?}"),
            Self::Last([from, to]) => format!("the last {from:?} -> {to:?}"),
            Self::All([from, to]) => format!("all {from:?} -> {to:?}"),
            Self::Path([from, to]) => format!("in the path {from:?} -> {to:?}"),
            Self::Move([line, behind]) => format!("{line:?} behind {behind:?}"),
            Self::Swap(start) => format!("{start:?} behind the next line"),
            Self::Without(start) => format!("without {start:?}"),
            Self::Insert(line) => format!("{line:?} in the cut"),
            Self::Prefix(text) => format!("{text:?} before the text"),
            Self::Suffix(text) => format!("{text:?} behind the text"),
            Self::Twice(address) => format!("{address} twice"),
            Self::Missing(address) => format!("{address} missing"),
            Self::Number([address, number]) => format!("{address} with {number:?}"),
            Self::Address([address, other]) => format!("{address} as {other:?}"),
            Self::Order(order) => format!("head and operations in the order {order:?}"),
            Self::Text(what) | Self::Machine(what) | Self::Job(what) => what.clone(),
        }
    }
}

impl TryFrom<toml::Table> for Case {
    type Error = String;

    fn try_from(mut row: toml::Table) -> Result<Self, String> {
        let due = Verdict::due(&row)?;
        let Some(toml::Value::String(why)) = row.remove(due.key()) else {
            return Err(format!("`{}` is the reason, a text: {row}", due.key()));
        };
        if row.len() != 1 {
            return Err(format!("a case has one change: {row}"));
        }
        let shown = row.to_string();
        let change = toml::Value::Table(row).try_into().map_err(|fault| format!("{fault}in: {shown}"))?;
        Ok(Self { change, due, why })
    }
}

fn orientation<'de, D: serde::Deserializer<'de>>(from: D) -> Result<Orientation, D::Error> {
    let name = String::deserialize(from)?;
    let all = [Orientation::Angles, Orientation::Vectors];
    let found = all.into_iter().find(|o| o.name() == name);
    found.ok_or_else(|| serde::de::Error::custom(format!("{name:?} is none of {:?}", all.map(|o| o.name()))))
}

impl Cases {
    /// All cases with their classes.
    pub fn all(&self) -> impl Iterator<Item = (&str, &Case)> {
        self.cases.iter().flat_map(|(class, cases)| cases.iter().map(move |case| (class.as_str(), case)))
    }

    /// What is wrong with the rows.
    pub fn fault(&self) -> Option<String> {
        let count = self.all().count();
        if count < self.least {
            return Some(format!("{count} cases, at least {} are due", self.least));
        }
        let mut shown: Vec<String> = self.all().map(|(_, case)| case.change.shown()).collect();
        shown.sort();
        shown.windows(2).find(|w| w[0] == w[1]).map(|twice| format!("{} stands twice", twice[0]))
    }
}

/// A file, parsed; or what is wrong with it.
pub fn parsed<T: for<'de> Deserialize<'de>>(path: &Path) -> Result<T, String> {
    let text = std::fs::read_to_string(path).map_err(|fault| format!("{}: {fault}", path.display()))?;
    toml::from_str(&text).map_err(|fault| format!("{}: {fault}", path.display()))
}

/// The files of cases, by name.
pub fn files() -> Vec<(String, PathBuf)> {
    let mut files: Vec<(String, PathBuf)> = std::fs::read_dir("tests/meanings/dialects")
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .map(|path| (path.file_stem().unwrap().to_string_lossy().into_owned(), path))
        .collect();
    files.sort();
    files
}
