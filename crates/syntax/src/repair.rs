//! Signs and forms that people bring from other languages: `µm`, decimal commas, `;`, `:`, `#`, curly quotes, `sectors 1-8`.
//!
//! Each is reported once, with what to write instead. The parser then reads the text as it is meant, so that no other error
//! follows. The repaired text is as long as the given one: places in it are places of the given text.

use super::scan::ITEMS;
use base::source::{SourceId, Span};
use diagnostics::codes::syntax as codes;
use diagnostics::{Diag, Sink};
use std::ops::Range;

/// A form that is not of the language.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    Micro,
    Quotes,
    DecimalComma,
    DigitGroups,
    Semicolon,
    Colon,
    Comment,
    Equals,
    Relation,
    Sectors,
    NoComma,
    Comma,
    Degree,
    Inch,
    Turns,
    PerTurn,
    Quoted,
    NamedOperation,
    SeveralContracts,
    NcWord,
    Unit,
    PerSecond,
    FileName,
    UsePost,
    Faces,
    /// `let` in a block; the reader of the block reports it.
    Let,
}

impl Form {
    /// What is wrong.
    fn message(self) -> &'static str {
        match self {
            Self::Micro => "the unit of a micrometre is `um`",
            Self::Quotes => "texts stand in straight quotes",
            Self::DecimalComma => "the decimal sign is a point",
            Self::DigitGroups => "digits of a number stand together",
            Self::Semicolon => "`;` is not needed: the end of the line ends an item, and blanks separate entries",
            Self::Colon => "no `:` stands between a name and its value",
            Self::Comment => "a comment begins with `//`",
            Self::Equals => "no `=` stands between a name and its value",
            Self::Relation => "the relations are `<=` and `>=`",
            Self::Sectors => "`sectors` takes a list of numbers",
            Self::NoComma => "a comma separates the values of one entry",
            Self::Comma => "blanks separate entries; a comma separates values of one entry",
            Self::Degree => "the unit of an angle is `deg`",
            Self::Inch => "the unit of an inch is `in`",
            Self::Turns => "the unit of a spindle speed is `rpm`",
            Self::PerTurn => "feeds are in `mm/min` or `mm/tooth`",
            Self::Quoted => "this word stands without quotes",
            Self::NamedOperation => "the name of an operation stands behind its kind",
            Self::SeveralContracts => "each contract is an item of its own",
            Self::Unit => "the unit has another name here",
            Self::PerSecond => "feeds are in `mm/min` or `m/min`, and speeds in `rpm`",
            Self::FileName => "the name of a file stands in quotes",
            Self::UsePost => "the post is an item of its own",
            Self::Faces => "`faces` takes `pressure` and `suction`",
            Self::Let => "a name is declared outside of blocks",
            Self::NcWord => "a number has no letter before it, as in NC text",
        }
    }
}

/// A place that is read in another way.
struct Repair {
    form: Form,
    range: Range<usize>,
    /// What is read there, of the same length.
    read: String,
    help: String,
    /// What to write there, where that is one change.
    fix: Option<String>,
}

/// A piece of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum LinePiece<'a> {
    Word(&'a str),
    Number(&'a str),
    Text(&'a str),
    Sign(char),
}

/// The text as the parser reads it; the forms are reported.
pub(super) fn repaired(text: &str, source: SourceId, sink: &mut Sink) -> Option<String> {
    let repairs = FormFinder::default().find(text);
    if repairs.is_empty() {
        return None;
    }
    let mut forms: Vec<(&Repair, usize)> = Vec::new();
    for repair in repairs.iter().filter(|r| r.form != Form::Let) {
        match forms.iter_mut().find(|(first, _)| first.form == repair.form && first.help == repair.help) {
            Some((_, times)) => *times += 1,
            None => forms.push((repair, 1)),
        }
    }
    for (first, times) in forms {
        let span = Span::new(source, first.range.clone());
        let mut diag = Diag::error(codes::MISWRITTEN, first.form.message()).label(span, "not of this language");
        diag = diag.help(first.help.clone());
        if times > 1 {
            diag = diag.note(format!("and at {} more places", times - 1));
        }
        sink.push(match &first.fix {
            Some(fix) => diag.fix(span, fix.clone()),
            None => diag,
        });
    }
    let mut read = text.to_owned();
    for repair in repairs {
        read.replace_range(repair.range, &repair.read);
    }
    Some(read)
}

/// What is left open at the end of a line.
#[derive(Default)]
struct FormFinder {
    found: Vec<Repair>,
    /// Depth of braces and brackets.
    depth: usize,
    in_comment: bool,
}

/// Blanks of a length.
fn blank(range: &Range<usize>) -> String {
    " ".repeat(range.len())
}

/// A text with blanks behind it, where it fits.
fn padded(text: &str, range: &Range<usize>) -> Option<String> {
    (text.len() <= range.len()).then(|| format!("{text:<width$}", width = range.len()))
}

impl FormFinder {
    fn find(mut self, text: &str) -> Vec<Repair> {
        let mut start = 0;
        for line in text.split_inclusive('\n') {
            self.line(line.trim_end_matches(['\n', '\r']), start);
            start += line.len();
        }
        self.found.sort_by_key(|r| r.range.start);
        // A place is read in one way.
        let mut end = 0;
        self.found.retain(|r| {
            let free = r.range.start >= end;
            end = if free { r.range.end } else { end };
            free
        });
        self.found
    }

    fn push(&mut self, form: Form, range: Range<usize>, read: String, help: impl Into<String>, fix: Option<&str>) {
        self.found.push(Repair { form, range, read, help: help.into(), fix: fix.map(str::to_owned) });
    }

    fn line(&mut self, line: &str, start: usize) {
        let whole = start..start + line.len();
        if self.in_comment {
            let end = line.find("*/").map(|at| start + at + 2);
            self.in_comment = end.is_none();
            let range = start..end.unwrap_or(whole.end);
            self.push(Form::Comment, range.clone(), blank(&range), "write `//` before the comment on each line", None);
            return;
        }
        let (tokens, foreign) = tokens(line);
        let first = tokens.first().map(|t| (t.0, t.1.start));
        // A line that begins an item ends blocks that were not closed.
        if matches!(first, Some((LinePiece::Word(word), 0)) if ITEMS.contains(&word)) {
            self.depth = 0;
        }
        let in_brackets = matches!(first, Some((LinePiece::Sign('('), _))) && line.trim_end().ends_with(')');
        if self.depth == 0 && in_brackets {
            self.push(Form::Comment, whole.clone(), blank(&whole), "write `//` before the comment", None);
            return;
        }
        if let Some(at) = foreign {
            let range = start + at..whole.end;
            let block = line[at..].starts_with("/*");
            let closed = line[at..].find("*/").map(|end| range.start + end + 2);
            self.in_comment = block && closed.is_none();
            let range = range.start..if block { closed.unwrap_or(range.end) } else { range.end };
            self.push(Form::Comment, range.clone(), blank(&range), "write `//` before the comment", None);
        }
        self.signs(line, start, &tokens);
        self.heads(start, &tokens);
        for at in 0..tokens.len() {
            self.nc_words(start, &tokens[at..]);
            self.units(line, start, &tokens[at..]);
            self.values(line, start, &tokens[at..]);
            self.lists(line, start, &tokens[at..]);
            match tokens[at].0 {
                LinePiece::Sign('{' | '[') => self.depth += 1,
                LinePiece::Sign('}' | ']') => self.depth = self.depth.saturating_sub(1),
                LinePiece::Sign(_) if self.depth > 0 || at > 0 => self.between(start, &tokens, at),
                _ => {}
            }
        }
    }

    /// Signs that the language does not have.
    fn signs(&mut self, line: &str, start: usize, tokens: &[(LinePiece<'_>, Range<usize>)]) {
        for (token, at) in tokens {
            let LinePiece::Sign(sign) = *token else { continue };
            let range = start + at.start..start + at.end;
            let rest = &line[at.end..];
            match sign {
                'µ' | 'μ' if rest.starts_with('m') => {
                    let range = range.start..range.end + 1;
                    if let Some(read) = padded("um", &range) {
                        self.push(Form::Micro, range, read, "write `um`", Some("um"));
                    }
                }
                '“' | '”' | '„' | '‘' | '’' | '\'' | '«' | '»' => {
                    let opens = rest.starts_with(|c: char| c.is_alphanumeric());
                    let blanks = " ".repeat(range.len() - 1);
                    let read = if opens { format!("{blanks}\"") } else { format!("\"{blanks}") };
                    self.push(Form::Quotes, range, read, "write straight quotes: `\"`", None);
                }
                ';' => self.push(Form::Semicolon, range.clone(), blank(&range), "remove `;`", Some("")),
                '≤' | '≥' => {
                    let due = if sign == '≤' { "<=" } else { ">=" };
                    let read = padded(due, &range).unwrap_or_else(|| blank(&range));
                    self.push(Form::Relation, range, read, format!("write `{due}`"), Some(due));
                }
                '°' => {
                    let space = range.start..range.end + rest.len() - rest.trim_start_matches(' ').len();
                    // Two blanks or the end of the line, so that a word behind stays a word.
                    let fits = space.len() > 3 || rest.trim().is_empty() && space.len() >= 3;
                    let read = if fits { padded("deg", &space) } else { None };
                    let (range, read) = read.map_or_else(|| (range.clone(), blank(&range)), |read| (space, read));
                    self.push(Form::Degree, range, read, "write `deg`", None);
                }
                _ => {}
            }
        }
    }

    /// Items that are written in the manner of another language.
    fn heads(&mut self, start: usize, tokens: &[(LinePiece<'_>, Range<usize>)]) {
        let at = |range: &Range<usize>| start + range.start..start + range.end;
        if self.depth > 0 {
            return;
        }
        match tokens {
            [(LinePiece::Word("use"), from), (LinePiece::Word("post"), _), (LinePiece::Text(text), to), ..] => {
                let range = start + from.start..start + to.end;
                let due = format!("post {}", text.trim_matches('"'));
                if let Some(read) = padded(&due, &range) {
                    self.push(Form::UsePost, range, read, format!("write `{due}`"), Some(&due));
                }
            }
            [(LinePiece::Word("post" | "edition"), _), (LinePiece::Text(text), range), ..] => {
                let name = text.trim_matches('"');
                let help = format!("write `{name}`");
                self.push(Form::Quoted, at(range), format!(" {name} "), help, Some(name));
            }
            [
                (LinePiece::Word("operation"), _),
                (LinePiece::Word(name), from),
                (LinePiece::Sign('='), _),
                (LinePiece::Word(kind), to),
                ..,
            ] => {
                let range = start + from.start..start + to.end;
                let due = format!("{kind} {name}");
                if let Some(read) = padded(&due, &range) {
                    self.push(Form::NamedOperation, range, read, format!("write `operation {due}`"), Some(&due));
                }
            }
            [(LinePiece::Word("require"), _), rest @ ..] => {
                let Some(comma) = rest.iter().position(|t| t.0 == LinePiece::Sign(',')) else { return };
                let relation = |t: &(LinePiece<'_>, Range<usize>)| matches!(t.0, LinePiece::Sign('<' | '>'));
                if rest[comma..].iter().any(relation) {
                    let end = rest.last().map_or(0, |t| t.1.end);
                    let range = start + rest[comma].1.start..start + end;
                    let help = "write the next contract on a line of its own, as `require NAME <= VALUE`";
                    self.push(Form::SeveralContracts, range.clone(), blank(&range), help, None);
                }
            }
            _ => {}
        }
    }

    /// Units with other names or of other systems, and names of files without quotes; `tokens` begins at the place.
    fn units(&mut self, line: &str, start: usize, tokens: &[(LinePiece<'_>, Range<usize>)]) {
        let at = |from: &Range<usize>, to: &Range<usize>| start + from.start..start + to.end;
        match tokens {
            [
                (LinePiece::Number(number), from),
                (LinePiece::Word(length @ ("mm" | "m" | "in")) | LinePiece::Number(length @ "1"), _),
                (LinePiece::Sign('/'), _),
                (LinePiece::Word(time @ ("s" | "sec" | "min")), to),
                ..,
            ] => {
                let (factor, due) = match (*length, *time) {
                    ("in", "min") => (25.4, "mm/min"),
                    ("in", _) => (25.4 * 60.0, "mm/min"),
                    ("1", "s" | "sec") => (60.0, "rpm"),
                    ("mm", "s" | "sec") => (60.0, "mm/min"),
                    ("m", "s" | "sec") => (60.0, "m/min"),
                    _ => return,
                };
                let Ok(value) = number.parse::<f64>() else { return };
                let written = format!("{} {due}", (value * factor * 1e6).round() / 1e6);
                let range = at(from, to);
                // What is read there is too short for all digits: a value of the right kind keeps other faults away.
                let short = if due == "rpm" { "9999rpm" } else { "1mm/min" };
                let read = padded(&written, &range).or_else(|| padded(short, &range)).unwrap_or_else(|| blank(&range));
                self.push(Form::PerSecond, range, read, format!("write `{written}`"), Some(&written));
            }
            [(LinePiece::Number(_), _), (LinePiece::Word(word), unit), ..] => {
                if let Some((_, due)) = OTHER_UNITS.iter().find(|(other, _)| other == word) {
                    let range = start + unit.start..start + unit.end;
                    let read = padded(due, &range).unwrap_or_else(|| blank(&range));
                    self.push(Form::Unit, range, read, format!("write `{due}`"), Some(due));
                }
            }
            [(LinePiece::Word("from"), _), (LinePiece::Word(word), name), ..] if is_file(word) => {
                let free = |at: usize| line.as_bytes().get(at).is_none_or(|b| *b == b' ');
                if name.start > 0 && free(name.start - 1) && free(name.end) && name.end < line.len() {
                    let range = start + name.start - 1..start + name.end + 1;
                    let fix = format!(" \"{word}\" ");
                    self.push(Form::FileName, range, format!("\"{word}\""), format!("write `\"{word}\"`"), Some(&fix));
                }
            }
            _ => {}
        }
    }

    /// Words of NC text with a decimal point or a unit behind, such as `F0.05 mm/tooth`; `tokens` begins at the place.
    fn nc_words(&mut self, start: usize, tokens: &[(LinePiece<'_>, Range<usize>)]) {
        let [(LinePiece::Word(word), at), rest @ ..] = tokens else { return };
        let (letter, number) = word.split_at(1);
        let plain = number.split('.').all(|part| !part.is_empty() && part.bytes().all(|b| b.is_ascii_digit()));
        let unit = matches!(rest, [(LinePiece::Word(unit), _), ..] if is_unit(unit));
        if self.depth == 0
            || !plain
            || !letter.bytes().all(|b| b.is_ascii_uppercase())
            || !(unit || number.contains('.'))
        {
            return;
        }
        let help = if unit { format!("write `{number}`") } else { format!("write `{number}` and its unit") };
        self.push(Form::NcWord, start + at.start..start + at.end, format!(" {number}"), help, Some(number));
    }

    /// Numbers and units that are written in the manner of another language; `tokens` begins at the place.
    fn values(&mut self, line: &str, start: usize, tokens: &[(LinePiece<'_>, Range<usize>)]) {
        let adjacent = |a: &Range<usize>, b: &Range<usize>| a.end == b.start;
        let at = |from: &Range<usize>, to: &Range<usize>| start + from.start..start + to.end;
        match tokens {
            [
                (LinePiece::Number(whole), a),
                (LinePiece::Sign(','), comma),
                (LinePiece::Number(part), b),
                (LinePiece::Word(unit), _),
                ..,
            ] if adjacent(a, comma) && adjacent(comma, b) && is_unit(unit) => {
                let (range, fast) = (at(a, b), matches!(*unit, "rpm" | "mm" | "m") && part.len() == 3);
                if fast && *unit == "rpm" {
                    let due = format!("{whole}{part}");
                    let read = padded(&due, &range).unwrap_or_else(|| blank(&range));
                    self.push(Form::DigitGroups, range, read, format!("write `{due} {unit}`"), Some(&due));
                } else {
                    let due = format!("{whole}.{part}");
                    self.push(Form::DecimalComma, range, due.clone(), format!("write `{due} {unit}`"), Some(&due));
                }
            }
            [(LinePiece::Number(thousands), a), (LinePiece::Number(rest), b), (LinePiece::Word(unit), _), ..]
                if rest.len() == 3 && !rest.contains('.') && is_unit(unit) =>
            {
                let due = format!("{thousands}{rest}");
                let range = at(a, b);
                let read = padded(&due, &range).unwrap_or_else(|| blank(&range));
                self.push(Form::DigitGroups, range, read, format!("write `{due} {unit}`"), Some(&due));
            }
            [(LinePiece::Number(_), a), (LinePiece::Text(_) | LinePiece::Sign('"'), b), ..] if adjacent(a, b) => {
                let space = |length| start + b.start..start + b.start + length;
                if line[b.start + 1..].starts_with(' ') {
                    self.push(Form::Inch, space(2), "in".to_owned(), "write `in`", Some("in "));
                } else {
                    self.push(Form::Inch, space(1), " ".to_owned(), "write `in`", Some(" in"));
                }
            }
            [
                (LinePiece::Number(_), before),
                (LinePiece::Number("1"), a),
                (LinePiece::Sign('/'), _),
                (LinePiece::Word("min"), b),
                ..,
            ] if !adjacent(before, a) => {
                let range = at(a, b);
                let read = padded("rpm", &range).unwrap_or_else(|| blank(&range));
                self.push(Form::Turns, range, read, "write `rpm`", Some("rpm"));
            }
            [
                (LinePiece::Number(_), _),
                (LinePiece::Word("mm"), a),
                (LinePiece::Sign('/'), _),
                (LinePiece::Word("rev"), b),
                ..,
            ] => {
                let blanks = line[b.end..].len() - line[b.end..].trim_start_matches(' ').len();
                let space = start + a.start..start + b.end + blanks;
                // One blank must stay before the next word.
                let (range, read) = match padded("mm/tooth", &space) {
                    Some(read) if blanks > 2 || b.end + blanks == line.len() => (space, read),
                    _ => (at(a, b), "m/min ".to_owned()),
                };
                let help = "divide the feed per turn by the number of flutes, and write `mm/tooth`";
                self.push(Form::PerTurn, range, read, help, None);
            }
            _ => {}
        }
    }

    /// Lists that are written in the manner of another language; `tokens` begins at the place.
    fn lists(&mut self, line: &str, start: usize, tokens: &[(LinePiece<'_>, Range<usize>)]) {
        let at = |from: &Range<usize>, to: &Range<usize>| start + from.start..start + to.end;
        match tokens {
            [
                (LinePiece::Word("sectors"), a),
                (LinePiece::Number(from), b),
                (LinePiece::Sign('-'), _),
                (LinePiece::Number(to), c),
                ..,
            ] => {
                self.sectors(at(a, c), at(b, c), from, to);
            }
            [
                (LinePiece::Word("sectors"), a),
                (LinePiece::Number(from), b),
                (LinePiece::Word("to" | "through" | "bis"), _),
                (LinePiece::Number(to), c),
                ..,
            ] => {
                self.sectors(at(a, c), at(b, c), from, to);
            }
            [
                (LinePiece::Word("faces"), a),
                (LinePiece::Word(word @ ("hub" | "shroud" | "vane")), c),
                (LinePiece::Word(_), _),
                ..,
            ] if self.depth > 0 => {
                let range = at(a, c);
                let help = match *word {
                    "hub" => "leave `faces` out: `channel` finishes the hub, `fillet` its border with the vanes",
                    "shroud" => "leave `faces` out: the lathe makes the shroud, and no operation cuts it",
                    _ => "write `faces pressure, suction`",
                };
                self.push(Form::Faces, range.clone(), blank(&range), help, None);
            }
            [(LinePiece::Word("let"), a), (LinePiece::Word(_), _), (LinePiece::Sign('='), c), ..] if self.depth > 0 => {
                let range = at(a, c);
                let read = format!("{} ", &line[a.start..c.start]);
                self.push(Form::Let, range, read, "", None);
            }
            [(LinePiece::Word("sectors"), a), (LinePiece::Word("all"), c), ..] => {
                let range = at(a, c);
                self.push(Form::Sectors, range.clone(), blank(&range), "leave `sectors` out for all sectors", Some(""));
            }
            [(LinePiece::Word("sectors"), a), (LinePiece::Number(both), c), ..] if both.contains("..") => {
                let (from, to) = both.split_once("..").unwrap_or_default();
                self.sectors(at(a, c), at(c, c), from, to);
            }
            [(LinePiece::Word("pressure"), a), (LinePiece::Word("suction"), b), ..]
            | [(LinePiece::Word("suction"), a), (LinePiece::Word("pressure"), b), ..]
            | [(LinePiece::Word("inlet"), a), (LinePiece::Word("outlet"), b), ..]
            | [(LinePiece::Word("outlet"), a), (LinePiece::Word("inlet"), b), ..]
                if !line.trim_start().starts_with("vane") =>
            {
                let range = start + a.end..start + b.start;
                if !range.is_empty() {
                    self.push(
                        Form::NoComma,
                        range.clone(),
                        format!(",{}", " ".repeat(range.len() - 1)),
                        "write a comma between the two words",
                        Some(", "),
                    );
                }
            }
            _ => {}
        }
    }

    fn sectors(&mut self, range: Range<usize>, list: Range<usize>, from: &str, to: &str) {
        let ends = from.parse::<u32>().ok().zip(to.parse::<u32>().ok()).filter(|(a, b)| a < b && b - a < 40);
        let numbers = ends.map(|(a, b)| (a..=b).map(|n| n.to_string()).collect::<Vec<_>>().join(", "));
        let Some(numbers) = numbers else { return };
        let help = format!("write `sectors {numbers}`; or leave `sectors` out for all sectors");
        self.found.push(Repair { form: Form::Sectors, range: range.clone(), read: blank(&range), help, fix: None });
        // The list alone is what the fix replaces.
        if let Some(last) = self.found.last_mut() {
            last.fix = (list.start == range.start).then_some(numbers);
        }
    }

    /// Signs between a name and its value, and between entries.
    fn between(&mut self, start: usize, tokens: &[(LinePiece<'_>, Range<usize>)], at: usize) {
        let (sign, range) = (tokens[at].0, start + tokens[at].1.start..start + tokens[at].1.end);
        let before = at.checked_sub(1).map(|k| tokens[k].0);
        let after = tokens.get(at + 1).map(|t| (t.0, start + t.1.start));
        let word_before = matches!(before, Some(LinePiece::Word(_)));
        match (sign, after) {
            (LinePiece::Sign(':'), Some(_)) if word_before => {
                self.push(Form::Colon, range.clone(), blank(&range), "remove `:`", Some(""));
            }
            (LinePiece::Sign('='), Some((LinePiece::Sign('<' | '>'), next))) if next == range.end => {
                let due = if matches!(after, Some((LinePiece::Sign('<'), _))) { "<=" } else { ">=" };
                let range = range.start..next + 1;
                self.push(Form::Relation, range, due.to_owned(), format!("write `{due}`"), Some(due));
            }
            (LinePiece::Sign('='), Some(_)) if word_before && self.depth > 0 => {
                self.push(Form::Equals, range.clone(), blank(&range), "remove `=`", Some(""));
            }
            (LinePiece::Sign(','), Some((LinePiece::Word(word), _))) if self.depth > 0 && !LABELS.contains(&word) => {
                if matches!(tokens.get(at + 2), Some((LinePiece::Number(_), _))) {
                    self.push(Form::Comma, range.clone(), blank(&range), "remove the comma", Some(" "));
                }
            }
            _ => {}
        }
    }
}

/// Words that stand before a value inside of one entry.
const LABELS: [&str; 6] = ["vane", "hub", "shroud", "chord", "rough", "within"];

/// Other names of units, and the unit of the language.
const OTHER_UNITS: &[(&str, &str)] = &[
    ("mu", "um"),
    ("micron", "um"),
    ("microns", "um"),
    ("micrometer", "um"),
    ("micrometers", "um"),
    ("micrometre", "um"),
    ("micrometres", "um"),
    ("millimeter", "mm"),
    ("millimeters", "mm"),
    ("millimetre", "mm"),
    ("millimetres", "mm"),
    ("degree", "deg"),
    ("degrees", "deg"),
    ("radians", "rad"),
    ("hour", "h"),
    ("hours", "h"),
    ("minute", "min"),
    ("minutes", "min"),
    ("sec", "s"),
    ("secs", "s"),
    ("second", "s"),
    ("seconds", "s"),
];

/// Whether a word is the name of a file that jobs read.
fn is_file(word: &str) -> bool {
    [".csv", ".stl", ".txt"].iter().any(|ending| word.ends_with(ending))
}

/// The first word of a unit.
fn is_unit(word: &str) -> bool {
    matches!(word, "mm" | "um" | "in" | "deg" | "rad" | "rpm" | "m" | "mm3" | "cm3" | "s" | "min" | "h")
}

/// Whether `--`, `;`, `%` or `!` begins a comment: at the beginning of a line, or with three words behind, of which no entry
/// consists. `5 --3` is a number, and `depth 3 mm; speed 9000 rpm` two entries.
fn begins_comment(before: &str, rest: &str) -> bool {
    let dashes = rest.starts_with("--");
    if !dashes && !rest.starts_with([';', '%', '!']) {
        return false;
    }
    // Asked first, so that a long run of such signs is read once.
    if !(before.is_empty() || before.ends_with([' ', '\t']) || !dashes && before.ends_with('}')) {
        return false;
    }
    let behind = rest.trim_start_matches(['-', ';', '%', '!']);
    let is_word = |word: &str| word.starts_with(|c: char| c.is_alphabetic());
    if dashes {
        return before.is_empty() || is_word(behind.trim_start());
    }
    if before.trim().is_empty() {
        return !behind.trim().is_empty();
    }
    // `air <= 20 % on operation rough`
    if rest.starts_with('%') {
        return false;
    }
    let words: Vec<&str> = behind.split_whitespace().take(3).collect();
    words.len() == 3 && words.iter().all(|word| is_word(word) && !word.ends_with(','))
}

/// The pieces of a line before its comment, and the place of a comment in the manner of another language.
fn tokens(line: &str) -> (Vec<(LinePiece<'_>, Range<usize>)>, Option<usize>) {
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(c) = line[at..].chars().next() {
        let rest = &line[at..];
        if rest.starts_with("//") {
            break;
        }
        if c == '#' || rest.starts_with("/*") || begins_comment(&line[..at], rest) {
            return (found, Some(at));
        }
        let length = |of: &dyn Fn(char) -> bool| rest.find(|c: char| !of(c)).unwrap_or(rest.len());
        let (token, end) = match c {
            ' ' | '\t' => {
                at += 1;
                continue;
            }
            '"' => match rest[1..].find('"') {
                Some(close) => (LinePiece::Text(&rest[..close + 2]), close + 2),
                None => (LinePiece::Sign('"'), 1),
            },
            c if c.is_ascii_alphabetic() || c == '_' => {
                let end = length(&|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '-' | '.'));
                (LinePiece::Word(&rest[..end]), end)
            }
            c if c.is_ascii_digit() => {
                let end = length(&|c| c.is_ascii_digit() || c == '.');
                (LinePiece::Number(&rest[..end]), end)
            }
            c => (LinePiece::Sign(c), c.len_utf8()),
        };
        found.push((token, at..at + end));
        at += end;
    }
    (found, None)
}
