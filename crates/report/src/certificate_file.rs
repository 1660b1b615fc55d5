//! The certificate as a file beside the NC text, and the check whether a text and a file belong together.
//!
//! Each holds hashes (SHA-256, hexadecimal) of the other: the file holds the hashes of the body and of the head of the
//! text, and the head of the text holds the hash of the whole file. The body is the text from the first block on. The
//! head is the comments before the body, without the line that names the file.
//!
//! `docs/certificate.md` and `docs/certificate.schema.json` describe the format.

use base::source::Origin;
use serde::de::{Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Number, Value};
use sha2::{Digest, Sha256};
use std::fmt;
use verify::Certificate;
use wheel::part::SurfaceId;

/// Name of the format, first in every file.
pub const FORMAT: &str = "impellerc-certificate";

/// Version of the format; it grows when a field changes its meaning or is removed.
pub const VERSION: u32 = 2;

/// Number of lines in a run of the body; each run has its hash.
pub const LINES_PER_RUN: usize = 100;

/// Digits that the hash of a run or of a line of the head keeps. Short hashes locate a difference; the whole hash
/// decides whether there is one.
const SHORT_HASH_DIGITS: usize = 16;

/// A text that is an input of the program.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct InputFile {
    /// Name: of the job without its folder, of the other texts as in the job.
    pub name: String,
    /// Origin: the word of an [`Origin`].
    pub origin: String,
    /// Length in bytes.
    pub bytes: u64,
    /// SHA-256 of the text.
    pub sha256: String,
}

/// All input texts of the program; the first is the job.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Inputs {
    /// SHA-256 over length (8 bytes, little endian) and bytes of each file in order, without the names.
    pub sha256: String,
    /// The files.
    pub files: Vec<InputFile>,
}

/// Lines of one operation in the NC text.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct OperationLines {
    /// Operation.
    pub name: String,
    /// Line of the first move with the transformation on, from 1. Move `index` of the operation is in line
    /// `first + index - 1`. Move 0, before this line, leads to the first target; the last move, after line `last`, is
    /// the retract.
    pub first: usize,
    /// Line of the last move with the transformation on, from 1.
    pub last: usize,
}

/// The NC text.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct NcText {
    /// Dialect.
    pub post: String,
    /// SHA-256 of the head without the line that names the certificate.
    pub head_sha256: String,
    /// First digits of the SHA-256 of every line of the head: they locate an edited line.
    pub head: Vec<String>,
    /// SHA-256 of the body.
    pub body_sha256: String,
    /// Lines of the body.
    pub body_lines: usize,
    /// Line at which the body begins, from 1.
    pub body_starts: usize,
    /// First digits of the SHA-256 of every hundred lines of the body: they locate an edit of the text.
    pub runs: Vec<String>,
    /// Lines of the operations.
    pub operations: Vec<OperationLines>,
    /// What the proof assumes of those who take the text further.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub assumed: Vec<String>,
}

/// Content of the file.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CertificateFile {
    /// [`FORMAT`].
    pub format: String,
    /// [`VERSION`].
    pub version: u32,
    /// Compiler and its version.
    pub compiler: String,
    /// Inputs of the program.
    pub inputs: Inputs,
    /// NC text of the program.
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
    /// Hashes of files with their names and origins.
    pub fn new<'a>(read: impl IntoIterator<Item = (String, Origin, &'a [u8])>) -> Self {
        let mut all = Sha256::new();
        let mut files = Vec::new();
        for (name, origin, content) in read {
            // Lengths keep files apart. Names are left out, so that the hash of a job does not depend on its folder.
            all.update((content.len() as u64).to_le_bytes());
            all.update(content);
            let (bytes, sha256) = (content.len() as u64, sha256(content));
            files.push(InputFile { name, origin: origin.word().to_owned(), bytes, sha256 });
        }
        Self { sha256: hexadecimal(all), files }
    }

    /// Differences from other inputs, in words; empty when there are none.
    pub fn differences(&self, other: &Self) -> Vec<String> {
        if self.sha256 == other.sha256 {
            return Vec::new();
        }
        let mut found = Vec::new();
        for file in &self.files {
            match other.files.iter().find(|f| f.name == file.name) {
                None => found.push(format!("`{}` is no longer an input", file.name)),
                Some(f) if f.sha256 != file.sha256 => found.push(format!("`{}` was changed", file.name)),
                Some(_) => {}
            }
        }
        let new = other.files.iter().filter(|f| self.files.iter().all(|g| g.name != f.name));
        found.extend(new.map(|f| format!("`{}` is new", f.name)));
        if found.is_empty() {
            found.push("the inputs are in another order".to_owned());
        }
        found
    }
}

/// The body of an NC text of any dialect, after the line with which it begins, from 1. The body is the text without its
/// head: the comments, the empty lines, and the lines that open a program.
pub fn body(text: &str) -> (usize, &str) {
    let mut rest = text;
    let mut line = 1;
    while let Some(end) = rest.find('\n') {
        let first = unnumbered(rest[..end].trim());
        let comment = first.starts_with(';')
            || first.starts_with("$$")
            || (first.starts_with('(') && first.find(')') == Some(first.len() - 1));
        if !(first.is_empty() || comment || opens(first)) {
            break;
        }
        rest = &rest[end + 1..];
        line += 1;
    }
    (line, rest)
}

/// A line without its block number.
fn unnumbered(line: &str) -> &str {
    let line = line.trim_start();
    let digits = line.strip_prefix('N').unwrap_or(line);
    let rest = digits.trim_start_matches(|c: char| c.is_ascii_digit());
    if rest.len() < digits.len() && rest.starts_with([' ', '\t']) { rest.trim_start() } else { line }
}

/// Whether a line opens a program: a tape mark, a program number, or the name of a program in Klartext.
fn opens(line: &str) -> bool {
    let number = line.strip_prefix('O').is_some_and(|number| number.starts_with(|c: char| c.is_ascii_digit()));
    number || line.starts_with('%') || line.starts_with("BEGIN PGM ")
}

/// The lines of the head with their line ends and numbers, without the first line that names the certificate.
fn head(text: &str) -> Vec<(usize, &str)> {
    let (starts, _) = body(text);
    let mut lines: Vec<(usize, &str)> = (1..starts).zip(text.split_inclusive('\n')).collect();
    if let Some(at) = lines.iter().position(|(_, line)| after(line, HEAD[2]).is_some()) {
        lines.remove(at);
    }
    lines
}

/// The comments of the head with the numbers of their lines, from 1, without block numbers and the characters about a
/// comment.
pub fn head_lines(text: &str) -> Vec<(usize, &str)> {
    let (starts, _) = body(text);
    (1..starts).zip(text.lines()).filter_map(|(number, line)| Some((number, comment_of(line)?))).collect()
}

/// The comment lines behind the head of a text, with their numbers.
pub fn comments_behind_head(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let (starts, _) = body(text);
    (1..)
        .zip(text.lines())
        .skip(starts.saturating_sub(1))
        .filter_map(|(number, line)| Some((number, comment_of(line)?)))
}

/// The text of a comment line, or of a message to the machinist: `MSG("..")`, `(MSG, ..)`, `PPRINT/..`.
fn comment_of(line: &str) -> Option<&str> {
    let line = unnumbered(line.trim());
    let bare = line.strip_prefix("$$").or_else(|| line.strip_prefix(';')).or_else(|| line.strip_prefix("PPRINT/"));
    let message = || line.strip_prefix("MSG")?.trim().strip_prefix("(\"")?.split_once("\")").map(|(text, _)| text);
    let text = bare.or_else(message).or_else(|| line.strip_prefix('(')?.strip_suffix(')'))?.trim();
    let shown = text.split_once(',').filter(|(word, _)| matches!(*word, "MSG" | "PRINT" | "DEBUG"));
    Some(shown.map_or(text, |(_, shown)| shown.trim()))
}

/// The rest of a line after the word with which its comment begins.
fn after<'a>(line: &'a str, word: &str) -> Option<&'a str> {
    let line = unnumbered(line);
    line.strip_prefix([';', '(']).or_else(|| line.strip_prefix("$$"))?.trim_start().strip_prefix(word)
}

fn in_short(text: &str) -> String {
    sha256(text.as_bytes()).chars().take(SHORT_HASH_DIGITS).collect()
}

/// Short hashes of the runs of a body.
fn runs(body: &str) -> Vec<String> {
    let lines: Vec<&str> = body.split_inclusive('\n').collect();
    lines.chunks(LINES_PER_RUN).map(|run| in_short(&run.concat())).collect()
}

impl NcText {
    /// Hashes of a text.
    pub fn new(post: &str, text: &str, operations: Vec<OperationLines>) -> Self {
        let (body_starts, body) = body(text);
        let head: Vec<&str> = head(text).into_iter().map(|(_, line)| line).collect();
        Self {
            post: post.to_owned(),
            head_sha256: sha256(head.concat().as_bytes()),
            head: head.into_iter().map(in_short).collect(),
            body_sha256: sha256(body.as_bytes()),
            body_lines: body.lines().count(),
            body_starts,
            runs: runs(body),
            operations,
            assumed: Vec::new(),
        }
    }

    /// The first line in which the head of a text differs, from 1; when a line is missing at the end, the line after
    /// the head. `None` when the heads are the same.
    pub fn head_difference(&self, text: &str) -> Option<usize> {
        let lines = head(text);
        let whole: String = lines.iter().map(|(_, line)| *line).collect();
        if sha256(whole.as_bytes()) == self.head_sha256 {
            return None;
        }
        let known = self.head.iter().map(Some).chain(std::iter::repeat(None));
        let differs = lines.iter().zip(known).find(|((_, line), known)| *known != Some(&in_short(line)));
        Some(differs.map_or(lines.last().map_or(1, |(number, _)| number + 1), |((number, _), _)| *number))
    }

    /// The first run of lines of a text that differs from the hashed text (first and last line, from 1), and the
    /// operation of the hashed text at this place. `None` when the bodies are the same.
    pub fn first_difference(&self, text: &str) -> Option<(usize, usize, Option<&str>)> {
        let (starts, body) = body(text);
        if sha256(body.as_bytes()) == self.body_sha256 {
            return None;
        }
        let found = runs(body);
        let lines = body.lines().count().max(1);
        let Some(run) = (0..self.runs.len().max(found.len())).find(|k| self.runs.get(*k) != found.get(*k)) else {
            // Short hashes or hash of the body are forged. The hash of the body decides, and gives no place.
            return Some((starts, starts + lines - 1, None));
        };
        let (first, last) = ((run * LINES_PER_RUN).min(lines - 1), ((run + 1) * LINES_PER_RUN).min(lines));
        // The number comes from a file: the addition must not overflow.
        let here = self.body_starts.saturating_add(run * LINES_PER_RUN);
        let operation = self.operations.iter().find(|o| here <= o.last).map(|o| o.name.as_str());
        Some((starts + first, starts + last - 1, operation))
    }
}

impl CertificateFile {
    /// The file for a certificate.
    ///
    /// # Errors
    /// A certificate that cannot be written as JSON; no case is known.
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

    /// The certificate of the file. What a file does not hold is not in it: the figures of single moves and cells, for plots and
    /// pictures, the computed values beside proved bounds of contracts, and the places of contracts in the job.
    ///
    /// # Errors
    /// Figures that are not those of a certificate, with the reason.
    pub fn certificate(&self) -> Result<Certificate, String> {
        let mut read = Certificate::deserialize(&self.measured).map_err(|e| e.to_string())?;
        let named = |name: &str| SurfaceId::named(name).ok_or_else(|| format!("`{name}` is no surface"));
        for s in &mut read.surfaces {
            s.id = named(&s.surface)?;
        }
        for s in read.rest.iter_mut().flat_map(|rest| &mut rest.surfaces) {
            s.id = named(&s.surface)?;
        }
        for s in &mut read.kept.surfaces {
            s.kind = named(&s.worst_on)?.kind;
        }
        Ok(read)
    }

    /// The text of the file.
    ///
    /// # Errors
    /// A value that cannot be written as JSON; no case is known.
    pub fn json(&self) -> Result<String, String> {
        let mut text = serde_json::to_string_pretty(self).map_err(|e| e.to_string())?;
        text.push('\n');
        Ok(text)
    }

    /// Reads a file.
    ///
    /// # Errors
    /// Text that is not of this format, with the reason.
    pub fn read(text: &str) -> Result<Self, String> {
        let Strict(value) = serde_json::from_str(text).map_err(|e| format!("it is not JSON: {e}"))?;
        if value.get("format").and_then(Value::as_str) != Some(FORMAT) {
            return Err(format!("it does not begin with the format {FORMAT}"));
        }
        let version = value.get("version").and_then(Value::as_u64);
        if version != Some(u64::from(VERSION)) {
            return Err(match version {
                Some(v) => format!("its form has version {v}; this compiler knows version {VERSION}"),
                None => "it does not state the version of its form".to_owned(),
            });
        }
        let file: Self = serde_json::from_value(value).map_err(|e| format!("its form is wrong: {e}"))?;
        let contracts = contracts(&file.measured).ok_or("its form is wrong: its contracts have no figures")?;
        match contracts.iter().find(|c| !c.3) {
            Some(broken) => Err(format!("its contract `{}` does not hold", broken.0)),
            None => Ok(file),
        }
    }
}

/// A judged contract: name with its scope, bound, found value, whether the contract holds.
pub type Judged = (String, f64, f64, bool);

/// Contracts of the measured figures; `None` when a contract has no figures.
pub fn contracts(measured: &Value) -> Option<Vec<Judged>> {
    let figures = |c: &Value| {
        let scope = c.get("scope").and_then(Value::as_str).unwrap_or_default();
        Some((
            format!("{} {scope}", c.get("kind")?.as_str()?).trim_end().to_owned(),
            c.get("bound")?.as_f64()?,
            c.get("found")?.as_f64()?,
            c.get("holds")?.as_bool()?,
        ))
    };
    measured.get("contracts")?.as_array()?.iter().map(figures).collect()
}

/// JSON in which no key occurs twice and every number is finite. With two values under one key, some readers take the
/// first, others the last.
struct Strict(Value);

impl<'de> Deserialize<'de> for Strict {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(StrictVisitor).map(Self)
    }
}

struct StrictVisitor;

impl<'de> Visitor<'de> for StrictVisitor {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a value of JSON")
    }

    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_bool<E>(self, value: bool) -> Result<Value, E> {
        Ok(Value::Bool(value))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Value, E> {
        Ok(Value::from(value))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Value, E> {
        Ok(Value::from(value))
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Value, E> {
        Number::from_f64(value).map(Value::Number).ok_or_else(|| E::custom("a number is not finite"))
    }

    fn visit_str<E>(self, value: &str) -> Result<Value, E> {
        Ok(Value::from(value))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Value, A::Error> {
        let mut all = Vec::new();
        while let Some(Strict(item)) = items.next_element()? {
            all.push(item);
        }
        Ok(Value::Array(all))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Value, A::Error> {
        let mut all = Map::new();
        while let Some((key, Strict(value))) = entries.next_entry::<String, Strict>()? {
            if all.contains_key(&key) {
                return Err(A::Error::custom(format!("the key `{key}` stands twice")));
            }
            all.insert(key, value);
        }
        Ok(Value::Object(all))
    }
}

/// Word in the head of an NC text before each hash: of its inputs, of its body, and of its certificate.
pub const HEAD: [&str; 3] = ["inputs sha256 ", "body sha256 ", "certificate sha256 "];

/// Number of digits of a hash.
const HASH_DIGITS: usize = 64;

/// Placeholder of a hash that is not known yet.
pub const BLANK: &str = "0000000000000000000000000000000000000000000000000000000000000000";

/// A hash in the head of a text, by its word in [`HEAD`].
pub fn named<'a>(text: &'a str, word: &str) -> Option<&'a str> {
    let (starts, _) = body(text);
    text.lines().take(starts.saturating_sub(1)).find_map(|line| {
        let after = after(line, word)?;
        let end = after.find(|c: char| !c.is_ascii_hexdigit()).unwrap_or(after.len());
        (end == HASH_DIGITS).then_some(&after[..end])
    })
}

/// Replaces the placeholder of a hash in a line of the head, where the line has it. Returns whether the line had it.
pub fn fill(line: &mut String, word: &str, hash: &str) -> bool {
    let due = after(line, word).is_some_and(|after| after.starts_with(BLANK));
    if due {
        *line = line.replacen(BLANK, hash, 1);
    }
    due
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
    fn what_a_machinist_reads_are_comments_and_messages() {
        for (line, text) in [
            ("; tool t1", Some("tool t1")),
            ("N20 ; tool t1", Some("tool t1")),
            ("(tool t1)", Some("tool t1")),
            ("$$ tool t1", Some("tool t1")),
            ("MSG(\"tool t1\")", Some("tool t1")),
            ("N20 MSG (\"tool t1\") ; note", Some("tool t1")),
            ("(MSG, tool t1)", Some("tool t1")),
            ("(PRINT,tool t1)", Some("tool t1")),
            ("PPRINT/tool t1", Some("tool t1")),
            ("G1 X1", None),
            ("T=\"t1\" M6", None),
        ] {
            assert_eq!(comment_of(line), text, "{line}");
        }
    }

    #[test]
    fn the_body_begins_at_the_first_block() {
        assert_eq!(body("; a\n\n(b)\nN10 G17\n; c\n"), (4, "N10 G17\n; c\n"));
        assert_eq!(body("(a) G21\n"), (1, "(a) G21\n"));
        assert_eq!(body("(a)(b)\n"), (1, "(a)(b)\n"));
        assert_eq!(body("%\nO1234 (A)\n(b)\nN10 G17\n"), (4, "N10 G17\n"));
        assert_eq!(body("0 BEGIN PGM A MM\n1 ; b\n2 M126\n3 ; c\n"), (3, "2 M126\n3 ; c\n"));
        assert_eq!(body("OFFSET\n"), (1, "OFFSET\n"));
        let mut line = format!("12 ; {}{BLANK}", HEAD[2]);
        assert!(fill(&mut line, HEAD[2], "hash") && line == format!("12 ; {}hash", HEAD[2]));
        assert_eq!(body("G17"), (1, "G17"));
        assert_eq!(body(""), (1, ""));
    }

    #[test]
    fn differences_are_found_where_they_are() {
        let lines: Vec<String> = (0..250).map(|i| format!("G1 X{i}\n")).collect();
        let text = format!("; head\n{}", lines.concat());
        let operations = vec![
            OperationLines { name: "one".to_owned(), first: 2, last: 150 },
            OperationLines { name: "two".to_owned(), first: 151, last: 251 },
        ];
        let nc = NcText::new("any", &text, operations);
        assert_eq!((nc.body_lines, nc.body_starts, nc.runs.len()), (250, 2, 3));
        assert_eq!(nc.first_difference(&text), None);
        assert_eq!(nc.first_difference(&format!("; another head\n; of two lines\n{}", lines.concat())), None);
        let changed = text.replacen("X120\n", "X121\n", 1);
        assert_eq!(nc.first_difference(&changed), Some((102, 201, Some("one"))));
        let changed = text.replacen("X220\n", "X221\n", 1);
        assert_eq!(nc.first_difference(&changed), Some((202, 251, Some("two"))));
        // The text cut after the second run; then with one more line.
        let cut = format!("; head\n{}", lines[..200].concat());
        assert_eq!(nc.first_difference(&cut), Some((201, 201, Some("two"))));
        assert_eq!(nc.first_difference(&format!("{text}M2\n")), Some((202, 252, Some("two"))));
        // Heads that differ: another line than that of the certificate changed, one line more, one line less.
        let head = |lines: &[&str]| format!("{}G17\n", lines.concat());
        let [a, c, b] = ["; a\n", "; certificate sha256 12\n", "; b\n"];
        let known = NcText::new("any", &head(&[a, c, b]), Vec::new());
        assert_eq!(known.head_difference(&head(&[a, "; certificate sha256 34\n", b])), None);
        assert_eq!(known.head_difference(&head(&[a, c, "; d\n"])), Some(3));
        assert_eq!(known.head_difference(&head(&[a, c, b, c])), Some(4));
        assert_eq!(known.head_difference(&head(&[c, b])), Some(2));
        assert_eq!(known.head_difference(&head(&[a, c])), Some(2));
        assert_eq!(known.head_difference(&head(&[])), Some(1));
        // Forged: short hashes that match an edited text, or a hash of the body that matches none.
        let forged = NcText { runs: NcText::new("any", &changed, Vec::new()).runs, ..nc.clone() };
        assert_eq!(forged.first_difference(&changed), Some((2, 251, None)));
        let forged = NcText { body_sha256: "0".repeat(64), ..nc };
        assert_eq!(forged.first_difference(&text), Some((2, 251, None)));
    }

    #[test]
    fn json_is_read_strictly() {
        let read = |text: &str| serde_json::from_str::<Strict>(text).map(|s| s.0).map_err(|e| e.to_string());
        let text = r#"{"a": [1, -2, 2.5, null, true, "\u0041"], "b": {"a": {}}}"#;
        assert_eq!(read(text).unwrap(), serde_json::from_str::<Value>(text).unwrap());
        for twice in [r#"{"a": 1, "a": 1}"#, r#"[{"b": {"a": 1, "c": 2, "\u0061": 3}}]"#] {
            assert!(read(twice).unwrap_err().contains("the key `a` stands twice"), "{twice}");
        }
        for bad in ["1e999", "NaN", "[Infinity]", "{} {}"] {
            assert!(read(bad).is_err(), "{bad}");
        }
        // Deep nesting must not abort the program.
        assert!(read(&"[".repeat(100_000)).is_err());
    }

    #[test]
    fn hashes_are_named_by_lines_that_begin_with_their_word() {
        let hash = sha256(b"x");
        let forged = format!("; allowed: body sha256 {hash}\n; body sha256 {BLANK}\nG17\n");
        assert_eq!(named(&forged, HEAD[1]), Some(BLANK));
        let mut line = format!("(body sha256 {BLANK})");
        assert!(!fill(&mut line, HEAD[0], &hash) && fill(&mut line, HEAD[1], &hash));
        assert_eq!(line, format!("(body sha256 {hash})"));
    }
}
