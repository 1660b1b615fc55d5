//! The certificate as a file beside the NC text, and the question whether a text and a file belong together.
//!
//! Both hold hashes (SHA-256, hexadecimal) of each other: the file that of the text's body, the head of the text that of
//! the whole file. The body is everything from the first block on, so that the comments at the head may name the file.
//! The form is described in `docs/certificate.md` and `docs/certificate.schema.json`.

use crate::verify::Certificate;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use sha2::{Digest, Sha256};

/// Name of the form, first in every file.
pub const FORMAT: &str = "impellerc-certificate";

/// Version of the form: grows when a field changes its meaning or goes.
pub const VERSION: u32 = 1;

/// Lines in a run of the body that has a hash of its own.
pub const RUN: usize = 100;

/// Digits that the hash of a run keeps: it says where texts differ, the hash of the body says whether.
const RUN_DIGITS: usize = 16;

/// A text that the program was made from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct InputFile {
    /// Name: of the job without its folder, of the others as the job calls them.
    pub name: String,
    /// Length.
    pub bytes: u64,
    /// SHA-256 of the text.
    pub sha256: String,
}

/// All texts that the program was made from: the job first.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Inputs {
    /// SHA-256 over length (8 bytes, little endian) and bytes of each text in order; names are left out.
    pub sha256: String,
    /// The texts.
    pub files: Vec<InputFile>,
}

/// Lines of one operation in the NC text.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Lines {
    /// Operation.
    pub name: String,
    /// Line of the first and of the last move, from 1. Move `index` of the operation stands in line `first + index`.
    pub first: usize,
    /// As above.
    pub last: usize,
}

/// The NC text.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct NcText {
    /// Dialect.
    pub post: String,
    /// SHA-256 of the body.
    pub body_sha256: String,
    /// Lines of the body.
    pub body_lines: usize,
    /// Line at which the body begins, from 1.
    pub body_starts: usize,
    /// First digits of the SHA-256 of every hundred lines of the body: they say where an edited text differs.
    pub runs: Vec<String>,
    /// Where the operations stand.
    pub operations: Vec<Lines>,
}

/// What the file holds.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CertificateFile {
    /// [`FORMAT`].
    pub format: String,
    /// [`VERSION`].
    pub version: u32,
    /// Compiler and its version.
    pub compiler: String,
    /// What it was made from.
    pub inputs: Inputs,
    /// What it was made for.
    pub nc: NcText,
    /// The figures: a [`Certificate`].
    pub measured: Value,
}

/// SHA-256, hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    hexadecimal(Sha256::new_with_prefix(bytes))
}

fn hexadecimal(hash: Sha256) -> String {
    hash.finalize().iter().map(|b| format!("{b:02x}")).collect()
}

impl Inputs {
    /// Hashes of texts by name.
    pub fn new<'a>(texts: impl IntoIterator<Item = (&'a str, &'a str)>) -> Self {
        let mut all = Sha256::new();
        let mut files = Vec::new();
        for (name, text) in texts {
            // Lengths keep texts apart; names are left out, so that the same job elsewhere hashes the same.
            all.update((text.len() as u64).to_le_bytes());
            all.update(text.as_bytes());
            files.push(InputFile { name: name.to_owned(), bytes: text.len() as u64, sha256: sha256(text.as_bytes()) });
        }
        Self { sha256: hexadecimal(all), files }
    }

    /// What differs from other inputs, in words; empty when nothing does.
    pub fn differences(&self, other: &Self) -> Vec<String> {
        if self.sha256 == other.sha256 {
            return Vec::new();
        }
        let mut found = Vec::new();
        for file in &self.files {
            match other.files.iter().find(|f| f.name == file.name) {
                None => found.push(format!("`{}` takes part no longer", file.name)),
                Some(f) if f.sha256 != file.sha256 => found.push(format!("`{}` was changed", file.name)),
                Some(_) => {}
            }
        }
        let new = other.files.iter().filter(|f| self.files.iter().all(|g| g.name != f.name));
        found.extend(new.map(|f| format!("`{}` is new", f.name)));
        if found.is_empty() {
            found.push("the texts take part in another order".to_owned());
        }
        found
    }
}

/// The body of an NC text of any dialect with its first line, from 1: all but the comments and empty lines at its head.
pub fn body(text: &str) -> (usize, &str) {
    let mut rest = text;
    let mut line = 1;
    while let Some(end) = rest.find('\n') {
        let first = rest[..end].trim();
        let comment = first.starts_with(';') || (first.starts_with('(') && first.find(')') == Some(first.len() - 1));
        if !(first.is_empty() || comment) {
            break;
        }
        rest = &rest[end + 1..];
        line += 1;
    }
    (line, rest)
}

/// The lines of a text with their ends.
fn runs(body: &str) -> Vec<String> {
    let lines: Vec<&str> = body.split_inclusive('\n').collect();
    lines.chunks(RUN).map(|run| sha256(run.concat().as_bytes()).chars().take(RUN_DIGITS).collect()).collect()
}

impl NcText {
    /// Hashes of a text.
    pub fn new(post: &str, text: &str, operations: Vec<Lines>) -> Self {
        let (body_starts, body) = body(text);
        Self {
            post: post.to_owned(),
            body_sha256: sha256(body.as_bytes()),
            body_lines: body.lines().count(),
            body_starts,
            runs: runs(body),
            operations,
        }
    }

    /// The first lines of a text that differ from the text that was hashed here (first and last, from 1), and the
    /// operation in which they lie here. `None` when the bodies are the same.
    pub fn first_difference(&self, text: &str) -> Option<(usize, usize, Option<&str>)> {
        let (starts, body) = body(text);
        if sha256(body.as_bytes()) == self.body_sha256 {
            return None;
        }
        let found = runs(body);
        let lines = body.lines().count().max(1);
        let Some(run) = (0..self.runs.len().max(found.len())).find(|k| self.runs.get(*k) != found.get(*k)) else {
            // One of both is forged: the hash of the body decides, and says no place.
            return Some((starts, starts + lines - 1, None));
        };
        let (first, last) = ((run * RUN).min(lines - 1), ((run + 1) * RUN).min(lines));
        // The number comes from a file.
        let here = self.body_starts.saturating_add(run * RUN);
        let operation = self.operations.iter().find(|o| here <= o.last).map(|o| o.name.as_str());
        Some((starts + first, starts + last - 1, operation))
    }
}

impl CertificateFile {
    /// The file for a certificate.
    ///
    /// # Errors
    /// A certificate that JSON cannot say; none is known.
    pub fn new(certificate: &Certificate, inputs: Inputs, nc: NcText) -> Result<Self, String> {
        Ok(Self {
            format: FORMAT.to_owned(),
            version: VERSION,
            compiler: format!("impellerc {}", env!("CARGO_PKG_VERSION")),
            inputs,
            nc,
            measured: serde_json::to_value(certificate).map_err(|e| e.to_string())?,
        })
    }

    /// The text of the file.
    ///
    /// # Errors
    /// A value that JSON cannot say; none is known.
    pub fn json(&self) -> Result<String, String> {
        let mut text = serde_json::to_string_pretty(self).map_err(|e| e.to_string())?;
        text.push('\n');
        Ok(text)
    }

    /// Reads a file.
    ///
    /// # Errors
    /// Text that is not of this form, with the reason.
    pub fn read(text: &str) -> Result<Self, String> {
        let value: Value = serde_json::from_str(text).map_err(|e| format!("it is not JSON: {e}"))?;
        if value.get("format").and_then(Value::as_str) != Some(FORMAT) {
            return Err(format!("it does not begin with the format {FORMAT}"));
        }
        let version = value.get("version").and_then(Value::as_u64);
        if version != Some(u64::from(VERSION)) {
            return Err(match version {
                Some(v) => format!("it has version {v} of the form; this compiler knows {VERSION}"),
                None => "it does not say the version of its form".to_owned(),
            });
        }
        serde_json::from_value(value).map_err(|e| format!("its form is broken: {e}"))
    }

    /// Contracts as the file says them: name with its scope, bound, found value, whether it holds.
    pub fn contracts(&self) -> Vec<(String, f64, f64, bool)> {
        let all = self.measured.get("contracts").and_then(Value::as_array);
        all.into_iter()
            .flatten()
            .filter_map(|c| {
                let scope = c.get("scope").and_then(Value::as_str).unwrap_or_default();
                Some((
                    format!("{} {scope}", c.get("kind")?.as_str()?).trim_end().to_owned(),
                    c.get("bound")?.as_f64()?,
                    c.get("found")?.as_f64()?,
                    c.get("holds")?.as_bool()?,
                ))
            })
            .collect()
    }
}

/// Word in the head of an NC text before the hash of its inputs, of its body, and of its certificate.
pub const HEAD: [&str; 3] = ["inputs sha256 ", "body sha256 ", "certificate sha256 "];

/// A hash that the head of a text names, by its word in [`HEAD`].
pub fn named<'a>(text: &'a str, word: &str) -> Option<&'a str> {
    let (starts, _) = body(text);
    text.lines().take(starts.saturating_sub(1)).find_map(|line| {
        let after = &line[line.find(word)? + word.len()..];
        let end = after.find(|c: char| !c.is_ascii_hexdigit()).unwrap_or(after.len());
        (end == 64).then_some(&after[..end])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hashes_are_those_of_the_standard() {
        // FIPS 180-4, examples of one block and of the empty text.
        assert_eq!(sha256(b"abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
        assert_eq!(sha256(b""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    }

    #[test]
    fn the_body_begins_at_the_first_block() {
        assert_eq!(body("; a\n\n(b)\nN10 G17\n; c\n"), (4, "N10 G17\n; c\n"));
        assert_eq!(body("(a) G21\n"), (1, "(a) G21\n"));
        assert_eq!(body("(a)(b)\n"), (1, "(a)(b)\n"));
        assert_eq!(body("G17"), (1, "G17"));
        assert_eq!(body(""), (1, ""));
    }

    #[test]
    fn differences_are_found_where_they_are() {
        let lines: Vec<String> = (0..250).map(|i| format!("G1 X{i}\n")).collect();
        let text = format!("; head\n{}", lines.concat());
        let operations = vec![
            Lines { name: "one".to_owned(), first: 2, last: 150 },
            Lines { name: "two".to_owned(), first: 151, last: 251 },
        ];
        let nc = NcText::new("any", &text, operations);
        assert_eq!((nc.body_lines, nc.body_starts, nc.runs.len()), (250, 2, 3));
        assert_eq!(nc.first_difference(&text), None);
        assert_eq!(nc.first_difference(&format!("; another head\n; of two lines\n{}", lines.concat())), None);
        let changed = text.replacen("X120\n", "X121\n", 1);
        assert_eq!(nc.first_difference(&changed), Some((102, 201, Some("one"))));
        let changed = text.replacen("X220\n", "X221\n", 1);
        assert_eq!(nc.first_difference(&changed), Some((202, 251, Some("two"))));
        // Cut behind the second run; and one line more.
        let cut = format!("; head\n{}", lines[..200].concat());
        assert_eq!(nc.first_difference(&cut), Some((201, 201, Some("two"))));
        assert_eq!(nc.first_difference(&format!("{text}M2\n")), Some((202, 252, Some("two"))));
        // Hashes of the runs that were forged to fit an edited text, or a hash of the body that fits none.
        let forged = NcText { runs: NcText::new("any", &changed, Vec::new()).runs, ..nc.clone() };
        assert_eq!(forged.first_difference(&changed), Some((2, 251, None)));
        let forged = NcText { body_sha256: "0".repeat(64), ..nc };
        assert_eq!(forged.first_difference(&text), Some((2, 251, None)));
    }
}
