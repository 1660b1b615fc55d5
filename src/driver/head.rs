//! The head of an NC text: the comments that state tools, zero, conditions and figures, and their comparison with the job.

use super::certificate_text;
use ::report::certificate_file::{self, BLANK, HEAD, InputFile, Inputs};
use ::report::proof::head::{self as proof, REQUIRED};
use base::source::{SourceId, SourceMap, Span};
use base::units::trim;
use diagnostics::{Diag, Severity, Sink, codes::post as codes, printable};
use ir::Program;
use nc::{Post, words};
use verify::certificate::Certificate;

/// Beginning of the first line of a head of this compiler.
const MAKER: &str = "impellerc ";

/// Characters of a name in a line of the head; controls show about 100 characters of a line.
const NAME_IN_LINE: usize = 80;

/// The lines of the head for an input file.
fn file_lines(file: &InputFile) -> Vec<String> {
    let InputFile { name, origin, sha256, .. } = file;
    let name: Vec<char> = name.chars().collect();
    let names = name.chunks(NAME_IN_LINE).map(|part| format!("named {}", part.iter().collect::<String>()));
    std::iter::once(format!("file sha256 {sha256}, {origin}:")).chain(names).collect()
}

/// Lines of the comment block at the head of the NC text; placeholders stand for the hashes of body and certificate.
/// `library` has a line for each file of the library that is not the shipped one.
pub(super) fn lines(
    program: &Program,
    certificate: &Certificate,
    post: &dyn Post,
    inputs: &Inputs,
    library: &[String],
) -> Vec<String> {
    let mut head = proof::lines(certificate);
    let mut lines = vec![format!("{MAKER}{}, {}", env!("CARGO_PKG_VERSION"), head.remove(0))];
    lines.extend(head);
    if program.machine.chain.has_head() {
        lines.push("not checked: head and spindle above the gauge line, against part and table".to_owned());
    }
    lines.extend(HEAD.iter().zip([&inputs.sha256, BLANK, BLANK]).map(|(word, hash)| format!("{word}{hash}")));
    lines.extend(inputs.files.iter().flat_map(file_lines));
    lines.push(format!(
        "part {}, machine {}, zero at the origin of the part frame, mm",
        program.name, program.machine.name
    ));
    lines.extend(nc::assumptions(post, program).iter().map(|what| format!("assumed: {what}")));
    lines.extend(proof::contracts(certificate));
    for (_, tool) in program.tools.iter() {
        lines.push(format!(
            "tool {} number {}: {} radius {} mm, length {} mm from the tip to the gauge line",
            tool.name,
            tool.number,
            tool.solid.cutter.keyword(),
            tool.solid.radius(),
            trim(tool.length(), 4)
        ));
    }
    lines.extend_from_slice(library);
    lines
}

/// Most lines of a head that are reported.
const MAX_REPORTED_LINES: usize = 8;

/// Difference of two figures of a head that the digits of words and figures explain: absolute, and as a share.
const FIGURE_ROUNDING: (f64, f64) = (0.011, 1e-2);

/// The same of a time, s: the run within the jerk of the axes depends on the last digits of the words.
const TIME_ROUNDING: f64 = 5.0;

/// Largest difference of a proved bound, um, and as a share of the bound of the contract.
const BOUND_ROUNDING_UM: f64 = 1.0;
const OF_BOUND: f64 = 0.1;

/// Beginnings of lines that the machinist sets the machine by: tools, and the zero.
const SET_BY: [&str; 2] = ["tool ", "part "];

/// Beginnings of further lines of this compiler.
const OWN_LINES: [&str; 7] =
    ["tool ", "part ", "assumed: ", "allowed: ", "NOT VERIFIED", "machined: ", "library file "];

/// Compares what the head of a text states with job, machine and measured figures. Returns a text that says what was
/// compared. What a machinist would set differently is an error; so is a figure that the measurement does not confirm, unless
/// text or inputs were changed after the head was written: then it is a warning.
pub(super) fn compare(
    program: &Program,
    certificate: &Certificate,
    post: &dyn Post,
    inputs: &Inputs,
    sources: &SourceMap,
    source: SourceId,
    sink: &mut Sink,
) -> String {
    let Some(text) = sources.get(source).map(|file| file.text.as_str()) else { return String::new() };
    let all = certificate_file::head_lines(text);
    let behind: Vec<(usize, &str)> =
        certificate_file::comments_behind_head(text).filter(|(_, line)| sets_machine(line)).collect();
    // Without its first line it is still what the machinist reads.
    let begins = all.iter().position(|(_, line)| line.starts_with(MAKER) || sets_machine(line));
    let Some(first) = begins.or((!behind.is_empty()).then_some(all.len())) else {
        return "the text has no head of impellerc: tool lengths, zero, conditions and figures are stated nowhere and not \
                compared\n"
            .to_owned();
    };
    // What stands elsewhere in the form of the head is read as the head is.
    let (before, stated) = all.split_at(first);
    let elsewhere = [before, &behind].concat();
    let library = certificate_text::library_lines(sources);
    let due: Vec<String> = lines(program, certificate, post, inputs, &library)
        .iter()
        .map(|line| words::comment(line).trim().to_owned())
        .collect();
    let body = certificate_file::sha256(certificate_file::body(text).1.as_bytes());
    let [of_inputs, of_body, _] = HEAD;
    let same = |word: &str, hash: &str| certificate_file::named(text, word) == Some(hash);
    let current = same(of_inputs, &inputs.sha256) && same(of_body, &body);
    let comparison = Comparison { stated, elsewhere: &elsewhere, due: &due, current };
    let differences = comparison.differences();
    let more = differences.len().saturating_sub(MAX_REPORTED_LINES);
    for difference in differences.into_iter().take(MAX_REPORTED_LINES) {
        let span = sources.line_span(source, difference.line).unwrap_or(Span::new(source, 0..0));
        let diag = match difference.severity {
            Severity::Error => Diag::error(codes::HEAD_DIFFERS, difference.text),
            _ => Diag::warning(codes::HEAD_DIFFERS, difference.text),
        };
        sink.push(diag.label(span, "in the head").help(
            "compile the job again to write a text with its own head, or correct the line and the tools at the machine",
        ));
    }
    let mut said = "the head of the text was compared with job, machine and measured figures".to_owned();
    if !same(of_inputs, &inputs.sha256) {
        said.push_str("; it was written from another state of job or library");
    }
    if !same(of_body, &body) {
        said.push_str("; the text was changed after its head was written");
    }
    if more > 0 {
        said.push_str(&format!("; {more} further lines differ"));
    }
    said + "; not compared: the hash of a certificate that is not given\n"
}

/// A line of the head that is not what it should be.
struct HeadDifference {
    line: usize,
    severity: Severity,
    text: String,
}

struct Comparison<'a> {
    /// Lines of the head with their numbers, from the first one of this compiler on.
    stated: &'a [(usize, &'a str)],
    /// Comments before and behind the head.
    elsewhere: &'a [(usize, &'a str)],
    /// Lines that the compiler would write now.
    due: &'a [String],
    /// Neither text nor inputs were changed after the head was written.
    current: bool,
}

impl Comparison<'_> {
    fn differences(&self) -> Vec<HeadDifference> {
        let mut open: Vec<(usize, &str)> = self.stated.iter().copied().filter(|(_, line)| !is_hash(line)).collect();
        let mut missing: Vec<&str> = Vec::new();
        for due in self.due.iter().map(String::as_str).filter(|line| !is_hash(line)) {
            match open.iter().position(|(_, line)| agree(line, due)) {
                Some(at) => drop(open.remove(at)),
                None => missing.push(due),
            }
        }
        let last = self.stated.last().map_or(1, |(number, _)| *number);
        let mut found = Vec::new();
        for due in missing {
            let alike = open.iter().position(|(_, line)| names_the_same(line, due));
            let (line, text) = match alike.map(|at| open.remove(at)) {
                Some((number, stated)) => {
                    (number, format!("the head states `{}`; job and measurement give `{due}`", printable(stated)))
                }
                None => (last, format!("the head does not state `{due}`")),
            };
            found.push(HeadDifference { line, severity: self.severity(due), text });
        }
        if self.stated.is_empty() {
            found.clear();
        }
        // Other comments come from the post file.
        let own = |line: &str| {
            let line = in_one_spelling(line);
            OWN_LINES.iter().any(|start| line.starts_with(&start.to_lowercase())) || line.contains(REQUIRED)
        };
        let wrong = |line: &str| sets_machine(line) && !self.due.iter().any(|due| agree(line, due));
        let elsewhere = self.elsewhere.iter().copied().filter(|(_, line)| wrong(line));
        for (number, stated) in open.into_iter().filter(|(_, line)| own(line)).chain(elsewhere) {
            let text = format!("the head states `{}`, which neither job nor measurement gives", printable(stated));
            found.push(HeadDifference { line: number, severity: self.severity(stated), text });
        }
        // Errors first: no number of warnings may hide one.
        found.sort_by_key(|difference| (difference.severity != Severity::Error, difference.line));
        found
    }

    fn severity(&self, line: &str) -> Severity {
        let sets = SET_BY.iter().any(|start| in_one_spelling(line).starts_with(start));
        if sets || self.current { Severity::Error } else { Severity::Warning }
    }
}

/// A line in small letters with single blanks, as a machinist reads it.
fn in_one_spelling(line: &str) -> String {
    line.split_whitespace().map(str::to_lowercase).collect::<Vec<_>>().join(" ")
}

/// Whether a comment states a tool or the zero as a head of this compiler does, wherever it stands.
fn sets_machine(line: &str) -> bool {
    let line = in_one_spelling(line);
    let [tool, part] = SET_BY;
    (line.starts_with(tool) && line.contains(" number ") && line.ends_with("from the tip to the gauge line"))
        || (line.starts_with(part) && line.contains(" machine ") && line.contains(" zero "))
}

/// Whether a line holds hashes, or names a file: the hashes are compared as a whole.
fn is_hash(line: &str) -> bool {
    HEAD.iter().any(|word| line.starts_with(word)) || line.starts_with("file sha256 ") || line.starts_with("named ")
}

/// A number of a line, and by how much it may differ at least.
struct Figure {
    value: f64,
    rounding: f64,
}

impl Figure {
    /// A number, or a time as hours, minutes and seconds.
    fn of(word: &str) -> Option<Self> {
        let word = word.trim_end_matches(',');
        let number = word.parse().ok().map(|value| Self { value, rounding: FIGURE_ROUNDING.0 });
        number.or_else(|| {
            let mut parts = word.split(':').map(|part| part.parse::<u32>().ok().map(f64::from));
            let [hours, minutes, seconds] = [parts.next()??, parts.next()??, parts.next()??];
            let value = (60.0 * hours + minutes) * 60.0 + seconds;
            parts.next().is_none().then_some(Self { value, rounding: TIME_ROUNDING })
        })
    }
}

/// The words of a line without its numbers, and the numbers.
fn words_and_numbers(line: &str) -> (String, Vec<Figure>) {
    let mut numbers = Vec::new();
    let words: Vec<&str> = line
        .split(' ')
        .map(|word| match Figure::of(word) {
            Some(figure) => {
                numbers.push(figure);
                "#"
            }
            None => word,
        })
        .collect();
    (words.join(" "), numbers)
}

/// Whether two lines state the same. What the machinist sets by, and what is required, is the same to the last digit.
fn agree(stated: &str, due: &str) -> bool {
    if SET_BY.iter().any(|start| due.starts_with(start)) {
        return stated == due;
    }
    if let Some((due, required)) = due.split_once(REQUIRED) {
        // A proved bound of a length depends on the last digits of the words, as it does in a certificate.
        let bound = words_and_numbers(required).1.last().map_or(0.0, |f| BOUND_ROUNDING_UM.min(OF_BOUND * f.value));
        let loose = if due.ends_with(" um") { bound } else { 0.0 };
        return stated.split_once(REQUIRED).is_some_and(|(found, r)| r == required && figures_agree(found, due, loose));
    }
    figures_agree(stated, due, 0.0)
}

/// Whether two texts have the same words, and figures that digits, or `loose`, explain.
fn figures_agree(stated: &str, due: &str, loose: f64) -> bool {
    let ((words, numbers), (due, own)) = (words_and_numbers(stated), words_and_numbers(due));
    let close = |(a, b): (&Figure, &Figure)| {
        (a.value - b.value).abs() <= b.rounding.max(loose) + FIGURE_ROUNDING.1 * b.value.abs()
    };
    words == due && numbers.len() == own.len() && numbers.iter().zip(&own).all(close)
}

/// Whether two lines state the same quantity: the words before the first number or colon are the same.
fn names_the_same(stated: &str, due: &str) -> bool {
    let name = |line: &str| {
        let end = line.find(|c: char| c.is_ascii_digit() || c == ':').unwrap_or(line.len());
        line[..end].to_owned()
    };
    let [tool, part] = SET_BY;
    if due.starts_with(part) {
        return stated.starts_with(part);
    }
    // A tool keeps its name in which a digit may stand.
    match (stated.split_once(':'), due.split_once(':')) {
        (Some((a, _)), Some((b, _))) if due.starts_with(tool) => a == b,
        _ => !name(due).is_empty() && name(stated) == name(due),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn differences(stated: &[&str], due: &[&str], current: bool) -> Vec<(usize, bool)> {
        let stated: Vec<(usize, &str)> = (1..).zip(stated.iter().copied()).collect();
        let due: Vec<String> = due.iter().map(|line| (*line).to_owned()).collect();
        let found = Comparison { stated: &stated, elsewhere: &[], due: &due, current }.differences();
        found.into_iter().map(|d| (d.line, d.severity == Severity::Error)).collect()
    }

    #[test]
    fn what_the_head_states_is_compared() {
        let due = [
            "impellerc 0.1.0, verified from the first block to the last",
            "part p, machine m, zero at the origin of the part frame, mm",
            "assumed: G54 is the part origin",
            "gouge 1.85 um, required <= 2.00 um",
            "tool t1 number 1: ball radius 1 mm, length 105 mm from the tip to the gauge line",
        ];
        assert_eq!(differences(&due, &due, true), []);
        let with = |k: usize, line: &'static str, current: bool| {
            let mut stated = due;
            stated[k] = line;
            differences(&stated, &due, current)
        };
        // The last digit of a figure; another figure, of an unchanged text and of a changed one.
        assert_eq!(with(3, "gouge 1.86 um, required <= 2.00 um", true), []);
        assert_eq!(with(3, "gouge 0.85 um, required <= 2.00 um", true), [(4, true)]);
        assert_eq!(with(3, "gouge 0.85 um, required <= 2.00 um", false), [(4, false)]);
        // A time, also over a full minute; what is required of it has no tolerance.
        let times = ["time 2:14:00, required <= 2:30:00"];
        for (line, differs) in [
            ("time 2:13:58, required <= 2:30:00", false),
            ("time 2:16:00, required <= 2:30:00", true),
            ("time 2:14, required <= 2:30:00", true),
            ("time 2:14:00, required <= 2:30:01", true),
        ] {
            assert_eq!(differences(&[line], &times, true), if differs { vec![(1, true)] } else { vec![] }, "{line}");
        }
        // What is required has no tolerance.
        assert_eq!(with(3, "gouge 1.85 um, required <= 2.01 um", true), [(4, true)]);
        // What the machine is set by.
        for current in [true, false] {
            let line = "tool t1 number 1: ball radius 1 mm, length 105.001 mm from the tip to the gauge line";
            assert_eq!(with(4, line, current), [(5, true)]);
            let line = "tool t1 number 2: ball radius 1 mm, length 105 mm from the tip to the gauge line";
            assert_eq!(with(4, line, current).len(), 2);
            assert_eq!(with(1, "part p, machine m, zero 10 mm above the part, mm", current), [(2, true)]);
        }
        // A line too few, and a line too many.
        assert_eq!(differences(&[due[0], due[1], due[3], due[4]], &due, true), [(4, true)]);
        let more = [due[0], due[1], due[2], "assumed: nothing else", due[3], due[4]];
        assert_eq!(differences(&more, &due, true), [(4, true)]);
        // Ten figures of another state do not hide what the machine is set by.
        let figures: Vec<String> = (0..10).map(|k| format!("clearance {k} mm, required >= 0.{k} mm")).collect();
        let other: Vec<&str> = figures.iter().map(String::as_str).collect();
        let found = differences(&[&due[..4], &other].concat(), &due, false);
        assert_eq!((found.len(), found[0].1), (11, true));
        // In another spelling, which a machinist reads all the same.
        let more =
            [&due[..], &["Tool  t1 number 1: ball radius 1 mm, length 95 mm from the tip to the gauge line"]].concat();
        assert_eq!(differences(&more, &due, false), [(6, true)]);
        // Before or behind the head.
        let owned = due.map(str::to_owned);
        let found = |line| {
            let (stated, elsewhere) = ((2..).zip(due).collect::<Vec<_>>(), [(1, line)]);
            let found =
                Comparison { stated: &stated, elsewhere: &elsewhere, due: &owned, current: false }.differences();
            found.into_iter().map(|d| (d.line, d.severity == Severity::Error)).collect::<Vec<_>>()
        };
        let line = "tool t1 number 1: ball radius 1 mm, length 95 mm from the tip to the gauge line";
        assert_eq!(found(line), [(1, true)]);
        assert_eq!(found(due[4]), []);
        assert_eq!(found("tool t1 number 1 is short"), []);
        // Hashes are compared as a whole.
        assert_eq!(differences(&[due.as_slice(), &["inputs sha256 12"]].concat(), &due, true), []);
    }
}
