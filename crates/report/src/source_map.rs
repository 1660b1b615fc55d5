//! The source map: a file beside the NC text that says of each block which cutter location, pass, operation and line of
//! the job it comes from. `docs/files.md` describes the format.
//!
//! A text may be edited after it was written. The map holds a short hash of each line, so that blocks before the first
//! and behind the last edited line are still found.

use super::certificate_file::sha256;
use five_axis::{Joints, Machine};
use ir::{Motion, MoveKind, Program};
use serde::{Deserialize, Serialize};

/// Name of the format.
pub const FORMAT: &str = "impellerc-source-map";

/// Version of the format.
pub const VERSION: u32 = 2;

/// Digits of the hash of a line.
const LINE_HASH_DIGITS: usize = 8;

/// A line of the text, as the writer knows it.
#[derive(Clone, Copy, Debug)]
pub struct WrittenLine<'a> {
    /// Text without the end of the line.
    pub text: &'a str,
    /// Operation and move of the motion.
    pub source: Option<(u32, u32)>,
    /// Further moves of the operation that the line makes when it is called again.
    pub again: &'a [u32],
    /// File and line of the template that made the line.
    pub frame: Option<(&'a str, usize)>,
}

/// An operation of the job.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct MappedOperation {
    /// Name.
    pub name: String,
    /// Line of the job, from 1.
    pub job_line: usize,
    /// Tool.
    pub tool: String,
    /// Names of the passes.
    pub passes: Vec<String>,
}

/// A block that moves the tool.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MappedBlock {
    /// Line of the text, from 1.
    pub line: usize,
    /// Index of the operation.
    pub operation: u32,
    /// Index of the move in the operation.
    pub index: u32,
    /// Index of the pass in the operation.
    pub pass: u32,
    /// `rapid`, `link` or `cut`.
    pub kind: String,
    /// Cutter location at the end of the block: tip, part frame, mm.
    pub tip: [f64; 3],
    /// Vector from the tip to the holder, part frame.
    pub axis: [f64; 3],
    /// Positions of the axes at the end of the block, as the machine shows them without tool centre point control, mm and
    /// degrees.
    pub positions: [f64; 5],
    /// Passes in which the block is executed again, turned about the axis of the part, in the order of the calls. What the
    /// other fields say is true of the first time.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub again: Vec<u32>,
}

/// A line that a template of the post file made.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct MappedFrame {
    /// Line of the text, from 1.
    pub line: usize,
    /// Post file.
    pub file: String,
    /// Its line, from 1.
    pub file_line: usize,
}

/// Content of the file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SourceMapFile {
    /// [`FORMAT`].
    pub format: String,
    /// [`VERSION`].
    pub version: u32,
    /// Compiler and its version.
    pub compiler: String,
    /// File name of the job.
    pub job: String,
    /// Names of the axes, in the order of [`MappedBlock::positions`].
    pub axes: [String; 5],
    /// Operations of the text in their order.
    pub operations: Vec<MappedOperation>,
    /// Blocks in their order.
    pub blocks: Vec<MappedBlock>,
    /// Lines of frames.
    pub frames: Vec<MappedFrame>,
    /// Short hashes of all lines, without their block numbers, one after the other.
    pub hashes: String,
}

/// A number with some decimals.
fn rounded(value: f64, decimals: i32) -> f64 {
    let scale = 10f64.powi(decimals);
    // The sum makes a negative zero positive.
    (value * scale).round() / scale + 0.0
}

/// Positions of the axes as the machine shows them, mm and degrees.
fn shown_positions(machine: &Machine, joints: &Joints, length: f64) -> [f64; 5] {
    let [x, y, z, first, second] = machine.positions(joints, length);
    let turned = |k: usize, angle: f64| {
        let axis = &machine.rotary[k];
        let shown = axis.word_sign * angle.to_degrees();
        rounded(if axis.modulo.is_some() { shown.rem_euclid(360.0) } else { shown }, 5)
    };
    let [x, y, z] = [x, y, z].map(|mm| rounded(mm, 5));
    [x, y, z, turned(0, first), turned(1, second)]
}

/// Short hash of a line without its block number.
fn line_hash(line: &str) -> String {
    let text = line.trim_end();
    let number = text.strip_prefix('N').unwrap_or(text);
    let behind = number.trim_start_matches(|c: char| c.is_ascii_digit());
    let numbered = behind.len() < number.len() && behind.starts_with(' ');
    sha256(if numbered { behind.trim_start() } else { text }.as_bytes()).chars().take(LINE_HASH_DIGITS).collect()
}

impl SourceMapFile {
    /// The map of a text. `job_line` gives the line of an operation in the job.
    pub fn new<'a>(
        program: &Program,
        motion: &Motion,
        job: &str,
        job_line: impl Fn(base::source::Span) -> usize,
        lines: impl Iterator<Item = WrittenLine<'a>>,
    ) -> Self {
        let operations = motion.operations.iter().map(|made| {
            let declared = &program.operations[made.operation];
            MappedOperation {
                name: declared.name.clone(),
                job_line: job_line(declared.span),
                tool: program.tools[declared.tool].name.clone(),
                passes: made.labels.clone(),
            }
        });
        let mut map = Self {
            format: FORMAT.to_owned(),
            version: VERSION,
            compiler: format!("impellerc {}", env!("CARGO_PKG_VERSION")),
            job: job.to_owned(),
            axes: program.machine.names().map(str::to_owned),
            operations: operations.collect(),
            blocks: Vec::new(),
            frames: Vec::new(),
            hashes: String::new(),
        };
        let pass_of = |operation: u32, index: u32| {
            let made = motion.operations.get(operation as usize)?;
            Some(made.moves.get(index as usize)?.pass)
        };
        for (line, written) in (1..).zip(lines) {
            map.hashes.push_str(&line_hash(written.text));
            if let Some((file, file_line)) = written.frame {
                map.frames.push(MappedFrame { line, file: file.to_owned(), file_line });
            }
            let Some((operation, index)) = written.source else { continue };
            let made = motion.operations.get(operation as usize);
            let Some((made, m)) = made.and_then(|o| Some((o, o.moves.get(index as usize)?))) else { continue };
            let length = program.tools[program.operations[made.operation].tool].length();
            let pose = program.machine.forward(&m.joints);
            let kind = match m.kind {
                MoveKind::Rapid => "rapid",
                MoveKind::Link => "link",
                MoveKind::Cut => "cut",
            };
            map.blocks.push(MappedBlock {
                line,
                operation,
                index,
                pass: m.pass,
                kind: kind.to_owned(),
                tip: pose.tip.coords.map(|x| rounded(x, 5)).into(),
                axis: pose.axis.map(|x| rounded(x, 8)).into(),
                positions: shown_positions(&program.machine, &m.joints, length),
                again: written.again.iter().filter_map(|index| pass_of(operation, *index)).collect(),
            });
        }
        map
    }

    /// The text of the file.
    ///
    /// # Errors
    /// A value that cannot be written as JSON; no case is known.
    pub fn json(&self) -> Result<String, String> {
        let mut text = serde_json::to_string(self).map_err(|e| e.to_string())?;
        text.push('\n');
        Ok(text)
    }

    /// Reads a file.
    ///
    /// # Errors
    /// Text that is not of this format, with the reason.
    pub fn read(text: &str) -> Result<Self, String> {
        let map: Self = serde_json::from_str(text).map_err(|e| format!("it is no source map: {e}"))?;
        if map.format != FORMAT {
            return Err(format!("it does not have the format {FORMAT}"));
        }
        if map.version != VERSION {
            return Err(format!("its form has version {}; this compiler knows version {VERSION}", map.version));
        }
        let fits = |b: &MappedBlock| {
            let operation = map.operations.get(b.operation as usize);
            let known = |pass: &u32| operation.is_some_and(|o| (*pass as usize) < o.passes.len());
            known(&b.pass) && b.again.iter().all(known)
        };
        let ordered =
            map.blocks.is_sorted_by(|a, b| a.line < b.line) && map.frames.is_sorted_by(|a, b| a.line < b.line);
        if !(ordered && map.blocks.iter().all(fits) && map.hashes.is_ascii()) {
            return Err("its blocks do not fit its operations".to_owned());
        }
        Ok(map)
    }
}

/// A map laid on a text, which may be an edited form of the text of the map.
#[derive(Clone, Debug)]
pub struct LaidMap {
    map: SourceMapFile,
    /// Lines at the beginning that both texts share, and lines at the end.
    shared: [usize; 2],
    /// Lines of the text of the map, and of the text.
    lines: [usize; 2],
}

impl LaidMap {
    /// Lays a map on a text.
    pub fn new(map: SourceMapFile, text: &str) -> Self {
        let old: Vec<&[u8]> = map.hashes.as_bytes().chunks(LINE_HASH_DIGITS).collect();
        let new: Vec<String> = text.lines().map(line_hash).collect();
        let same = |(a, b): &(&&[u8], &String)| **a == b.as_bytes();
        let start = old.iter().zip(&new).take_while(same).count();
        let most = old.len().min(new.len()) - start;
        let end = old.iter().rev().zip(new.iter().rev()).take(most).take_while(same).count();
        let lines = [old.len(), new.len()];
        Self { map, shared: [start, end], lines }
    }

    /// Names of the axes.
    pub fn axes(&self) -> &[String; 5] {
        &self.map.axes
    }

    /// File name of the job.
    pub fn job(&self) -> &str {
        &self.map.job
    }

    /// Number of lines of the text, and of those that the map knows.
    pub fn known(&self) -> [usize; 2] {
        [self.lines[1], self.shared[0] + self.shared[1]]
    }

    /// The line of the text of the map, from 1, for a line of the text.
    fn original(&self, line: usize) -> Option<usize> {
        let [start, end] = self.shared;
        let [old, new] = self.lines;
        if line <= start {
            return Some(line);
        }
        (line > new - end && line <= new).then(|| line + old - new)
    }

    /// The block of a line of the text, and its operation.
    pub fn block(&self, line: usize) -> Option<(&MappedBlock, &MappedOperation)> {
        let original = self.original(line)?;
        let at = self.map.blocks.binary_search_by_key(&original, |b| b.line).ok()?;
        let block = &self.map.blocks[at];
        Some((block, self.map.operations.get(block.operation as usize)?))
    }

    /// Pass of a line of the text when it is executed for the first time (0), for the second time (1) and so on.
    pub fn pass(&self, line: usize, time: usize) -> Option<&str> {
        let (block, operation) = self.block(line)?;
        let pass = match time.checked_sub(1) {
            None => block.pass,
            Some(again) => *block.again.get(again)?,
        };
        operation.passes.get(pass as usize).map(String::as_str)
    }

    /// What the map says of a line of the text, in one sentence.
    pub fn says(&self, line: usize) -> Option<String> {
        if let Some((block, operation)) = self.block(line) {
            let place = |v: &[f64; 3], digits: usize| v.map(|x| format!("{x:.digits$}")).join(", ");
            let name = |pass: u32| operation.passes.get(pass as usize).map_or("", String::as_str);
            let pass = name(block.pass);
            let again: Vec<String> = block.again.iter().map(|pass| format!("`{}`", name(*pass))).collect();
            let again = match again.is_empty() {
                true => String::new(),
                false => format!("; the text executes it again, turned, for {}", again.join(", ")),
            };
            return Some(format!(
                "line {line} was written for `{}`, line {} of {}: {} of pass `{pass}` to ({}) mm, axis ({}){again}",
                operation.name,
                operation.job_line,
                self.map.job,
                block.kind,
                place(&block.tip, 4),
                place(&block.axis, 6)
            ));
        }
        let original = self.original(line)?;
        let at = self.map.frames.binary_search_by_key(&original, |f| f.line).ok()?;
        let MappedFrame { file, file_line, .. } = &self.map.frames[at];
        Some(format!("line {line} was written by the template in line {file_line} of {file}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn laid(old: &str, new: &str) -> LaidMap {
        let map = SourceMapFile {
            format: FORMAT.to_owned(),
            version: VERSION,
            compiler: String::new(),
            job: "a.imp".to_owned(),
            axes: ["X", "Y", "Z", "A", "C"].map(str::to_owned),
            operations: Vec::new(),
            blocks: Vec::new(),
            frames: Vec::new(),
            hashes: old.lines().map(line_hash).collect(),
        };
        LaidMap::new(map, new)
    }

    #[test]
    fn lines_about_an_edit_are_found() {
        let old = "N10 a\nN20 b\nN30 c\nN40 d\n";
        let originals = |new: &str| {
            let map = laid(old, new);
            (1..=new.lines().count() + 1).map(|line| map.original(line)).collect::<Vec<_>>()
        };
        assert_eq!(originals(old), [Some(1), Some(2), Some(3), Some(4), None]);
        // A new block with new numbers.
        assert_eq!(originals("N10 a\nN20 x\nN30 b\nN40 c\nN50 d\n"), [Some(1), None, Some(2), Some(3), Some(4), None]);
        assert_eq!(originals("N10 a\nN40 d\n"), [Some(1), Some(4), None]);
        assert_eq!(originals("N10 a\nN20 B\nN30 c\nN40 d\n"), [Some(1), None, Some(3), Some(4), None]);
        assert_eq!(originals(""), [None]);
    }
}
