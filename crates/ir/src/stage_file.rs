//! Stage files: a stage value as JSON, with the program and the texts that it was made from, so that the pipeline can go on from
//! there with the same result.
//!
//! | field | content |
//! |---|---|
//! | `format`, `version` | [`FORMAT`], [`VERSION`] |
//! | `stage` | `ir`, `cc`, `cl` or `motion` |
//! | `sources` | the files of the job in their order, the job first: name, origin, and the text or the bytes in hexadecimal digits |
//! | `program` | the [`Program`] |
//! | `value` | null, the [`CcPlan`], the [`ClPlan`], or the [`Motion`] with the notes of planning |
//!
//! Units and frames are those of the values: mm, radians, the part frame. Numbers are written so that they come back bit by
//! bit; null stands for a limit that is not there. A key that may be null must stand in the file: one that was lost is no null.
//! A value is checked when it is read, by the constructors of its parts and by [`validate`]. What passes may still be a bad
//! motion: the verifier judges it like any other.

use crate::validate::{self, ClStage, Malformed};
use crate::{CcPlan, ClPlan, Motion, Program};
use base::source::{Origin, SourceFile, SourceMap, Span};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::error::Category;

/// Name of the format.
pub const FORMAT: &str = "impellerc-stage";

/// Version of the format; another one is refused.
pub const VERSION: u32 = 2;

/// Nesting up to which each entry has a line of its own: moves and stations do.
const LINES: usize = 8;

/// A stage value that was read, with all that the stages behind it need.
#[derive(Clone, Debug)]
pub struct StageFile {
    /// The files of the job, in their order.
    pub sources: Vec<SourceFile>,
    /// The program.
    pub program: Program,
    /// The value.
    pub value: StageValue,
}

/// The value of a stage behind the front end.
#[derive(Clone, Debug)]
pub enum StageValue {
    /// The program alone.
    Ir,
    /// Contact plan.
    Cc(CcPlan),
    /// Location plan.
    Cl(ClPlan),
    /// Motion.
    Motion(PlannedMotion),
}

/// A motion with what planning says of it.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlannedMotion {
    /// The motion.
    pub motion: Motion,
    /// Decisions of planning for the reader, of each operation.
    pub notes: Vec<Vec<String>>,
}

impl PlannedMotion {
    /// A motion with the notes of the location plan that it was made from.
    pub fn new(cl: &ClPlan, motion: Motion) -> Self {
        Self { motion, notes: cl.operations.iter().map(|o| o.notes.clone()).collect() }
    }
}

impl StageValue {
    /// Name of the stage, as after `--emit`.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Ir => StageName::Ir.name(),
            Self::Cc(_) => StageName::Cc.name(),
            Self::Cl(_) => StageName::Cl.name(),
            Self::Motion(_) => StageName::Motion.name(),
        }
    }
}

base::named! {
    /// Stages that a file can begin at.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    enum StageName {
        Ir = "ir",
        Cc = "cc",
        Cl = "cl",
        Motion = "motion",
    }
}

/// Why a text is no stage file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum StageFault {
    /// JSON, but of another kind.
    Other,
    /// A stage file of another version.
    Version(u64),
    /// The text is damaged at a byte.
    Damaged {
        /// The byte.
        at: usize,
        /// What is wrong there.
        reason: String,
    },
    /// The parts can be read, and do not belong together.
    Malformed(String),
}

impl From<Malformed> for StageFault {
    fn from(Malformed(reason): Malformed) -> Self {
        Self::Malformed(reason)
    }
}

/// What is read before the rest.
#[derive(Deserialize)]
struct Head {
    format: String,
    version: u64,
}

/// The stage, read when the version is known.
#[derive(Deserialize)]
struct StageHead {
    stage: StageName,
}

#[derive(Serialize)]
struct Writing<'a, V> {
    format: &'static str,
    version: u32,
    stage: StageName,
    sources: Vec<StoredSource>,
    program: &'a Program,
    value: V,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Reading<V> {
    #[serde(rename = "format")]
    _format: String,
    #[serde(rename = "version")]
    _version: u64,
    #[serde(rename = "stage")]
    _stage: StageName,
    sources: Vec<StoredSource>,
    program: Program,
    value: V,
}

/// A file of the job. Its folder is not kept, so that the same job gives the same stage file from any folder.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredSource {
    name: String,
    origin: Origin,
    text: String,
    /// Bytes of a file that is no text.
    data: String,
}

impl From<&SourceFile> for StoredSource {
    fn from(file: &SourceFile) -> Self {
        let data = file.data.iter().map(|byte| format!("{byte:02x}")).collect();
        Self { name: file.own_name(), origin: file.origin, text: file.text.clone(), data }
    }
}

impl TryFrom<StoredSource> for SourceFile {
    type Error = StageFault;

    fn try_from(StoredSource { name, origin, text, data }: StoredSource) -> Result<Self, StageFault> {
        let pairs = data.as_bytes().chunks(2);
        let byte = |pair: &[u8]| u8::from_str_radix(std::str::from_utf8(pair).ok().filter(|p| p.len() == 2)?, 16).ok();
        let bytes: Option<Vec<u8>> = pairs.map(byte).collect();
        let data =
            bytes.ok_or_else(|| StageFault::Malformed(format!("the bytes of `{name}` are no hexadecimal digits")))?;
        Ok(Self { name, text, data, origin, ..Self::default() })
    }
}

/// The text of a stage file.
///
/// # Errors
/// A value that is no stage value: the reason, which is a fault of the compiler.
pub fn write(sources: &SourceMap, program: &Program, value: &StageValue) -> Result<String, String> {
    checked(program, value).map_err(|malformed| malformed.0)?;
    match value {
        StageValue::Ir => text(sources, program, StageName::Ir, ()),
        StageValue::Cc(plan) => text(sources, program, StageName::Cc, plan),
        StageValue::Cl(plan) => text(sources, program, StageName::Cl, plan),
        StageValue::Motion(planned) => text(sources, program, StageName::Motion, planned),
    }
}

fn text(sources: &SourceMap, program: &Program, stage: StageName, value: impl Serialize) -> Result<String, String> {
    let sources = sources.files().iter().map(StoredSource::from).collect();
    let file = Writing { format: FORMAT, version: VERSION, stage, sources, program, value };
    serde_json::to_string(&file).map(|json| in_lines(&json)).map_err(|error| error.to_string())
}

/// True for a text that begins like a stage file.
pub fn recognise(text: &str) -> bool {
    let rest = text.trim_start().strip_prefix('{').map(str::trim_start);
    rest.and_then(|rest| rest.strip_prefix("\"format\":"))
        .is_some_and(|rest| rest.trim_start_matches(['"', ' ']).starts_with(FORMAT))
}

/// Reads a stage file.
///
/// # Errors
/// [`StageFault`].
pub fn read(text: &str) -> Result<StageFile, StageFault> {
    let head = match serde_json::from_str::<Head>(text) {
        Ok(head) => head,
        Err(error) if error.classify() == Category::Data => return Err(StageFault::Other),
        Err(error) => return Err(damaged(text, &error)),
    };
    if head.format != FORMAT {
        return Err(StageFault::Other);
    }
    if head.version != u64::from(VERSION) {
        return Err(StageFault::Version(head.version));
    }
    match of_json::<StageHead>(text)?.stage {
        StageName::Ir => whole(text, |(): ()| StageValue::Ir),
        StageName::Cc => whole(text, StageValue::Cc),
        StageName::Cl => whole(text, StageValue::Cl),
        StageName::Motion => whole(text, StageValue::Motion),
    }
}

fn whole<V: DeserializeOwned>(text: &str, value: impl FnOnce(V) -> StageValue) -> Result<StageFile, StageFault> {
    let Reading { sources, program, value: read, .. } = of_json::<Reading<V>>(text)?;
    let sources: Vec<SourceFile> = sources.into_iter().map(SourceFile::try_from).collect::<Result<_, _>>()?;
    let value = value(read);
    let known = |span: &Span| {
        let file = sources.get(span.source.0 as usize);
        file.is_some_and(|file| file.text.get(span.range()).is_some())
    };
    if let Some(span) = program.spans().find(|span| !known(span)) {
        return Err(StageFault::Malformed(format!(
            "bytes {} to {} of file {} are not there",
            span.start, span.end, span.source.0
        )));
    }
    checked(&program, &value)?;
    Ok(StageFile { sources, program, value })
}

/// Checks that program and value belong together.
fn checked(program: &Program, value: &StageValue) -> Result<(), Malformed> {
    validate::program(program)?;
    match value {
        StageValue::Ir => Ok(()),
        StageValue::Cc(plan) => validate::cc(program, plan),
        StageValue::Cl(plan) => validate::cl(program, plan, ClStage::InSectors),
        StageValue::Motion(planned) => {
            validate::motion(program, &planned.motion)?;
            if planned.notes.len() == planned.motion.operations.len() {
                return Ok(());
            }
            Err(Malformed("the notes of planning are not those of all operations".to_owned()))
        }
    }
}

fn of_json<T: DeserializeOwned>(text: &str) -> Result<T, StageFault> {
    serde_json::from_str(text).map_err(|error| damaged(text, &error))
}

/// Words of the reader, and what they are called in messages.
const WORDS: [(&str, &str); 12] = [
    ("invalid type: ", "found "),
    ("invalid value: ", "found "),
    ("invalid length ", "found a list of length "),
    ("integer `", "the number `"),
    ("floating point `", "the number `"),
    ("expected f64", "expected a number"),
    ("expected u64", "expected a whole number"),
    ("expected u32", "expected a whole number"),
    ("expected u16", "expected a whole number"),
    ("expected usize", "expected a whole number"),
    ("expected a sequence", "expected a list"),
    ("expected struct ", "expected an object "),
];

/// The fault of a text at the place where the reader stopped.
fn damaged(text: &str, error: &serde_json::Error) -> StageFault {
    let line: usize = text.split_inclusive('\n').take(error.line().saturating_sub(1)).map(str::len).sum();
    let mut at = (line + error.column().saturating_sub(1)).min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    let said = error.to_string();
    let reason = match error.classify() {
        Category::Eof => "the text ends here, within a value".to_owned(),
        _ => {
            let place = format!(" at line {} column {}", error.line(), error.column());
            WORDS.iter().fold(said.trim_end_matches(&place).to_owned(), |said, (from, to)| said.replace(from, to))
        }
    };
    StageFault::Damaged { at, reason }
}

/// The same JSON with the entries down to a depth of [`LINES`] on lines of their own, without indentation, so that a message can
/// show the line of a fault and a comparison those that differ.
fn in_lines(json: &str) -> String {
    let mut out = String::with_capacity(json.len() + json.len() / 16);
    let (mut depth, mut quoted, mut escaped) = (0_usize, false, false);
    for c in json.chars() {
        let closes = !quoted && matches!(c, ']' | '}');
        depth -= usize::from(closes);
        out.push(c);
        if quoted {
            (quoted, escaped) = (escaped || c != '"', !escaped && c == '\\');
            continue;
        }
        quoted = c == '"';
        depth += usize::from(matches!(c, '[' | '{'));
        if matches!(c, '[' | '{' | ',') && depth <= LINES {
            out.push('\n');
        }
    }
    out.push('\n');
    out
}
