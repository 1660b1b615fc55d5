//! Signs and forms that people bring from other languages: `µm`, decimal commas, `;`, `:`, `#`, curly quotes, `sectors 1-8`.
//!
//! Each is reported once, with what to write instead. The parser then reads the text as it is meant, so that no other error
//! follows. The repaired text is as long as the given one: places in it are places of the given text.

use self::LinePiece::{Number, Sign, Text, Word};
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
    let repairs = FormFinder { text, ..FormFinder::default() }.find();
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
struct FormFinder<'t> {
    text: &'t str,
    found: Vec<Repair>,
    /// Depth of braces and brackets.
    depth: usize,
    in_comment: bool,
    /// The line.
    line: Range<usize>,
}

/// A piece with its range in the text.
type Token<'t> = (LinePiece<'t>, Range<usize>);

/// Blanks of a length.
fn blank(range: &Range<usize>) -> String {
    " ".repeat(range.len())
}

/// A text with blanks behind it, where it fits.
fn padded(text: &str, range: &Range<usize>) -> Option<String> {
    (text.len() <= range.len()).then(|| format!("{text:<width$}", width = range.len()))
}

impl<'t> FormFinder<'t> {
    fn find(mut self) -> Vec<Repair> {
        let mut start = 0;
        for line in self.text.split_inclusive('\n') {
            self.line = start..start + line.trim_end_matches(['\n', '\r']).len();
            self.read_line();
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

    /// The rest of the line from a place.
    fn rest(&self, from: usize) -> &'t str {
        &self.text[from..self.line.end]
    }

    fn push(&mut self, form: Form, range: Range<usize>, read: String, help: impl Into<String>, fix: Option<&str>) {
        self.found.push(Repair { form, range, read, help: help.into(), fix: fix.map(str::to_owned) });
    }

    /// A place that is read as blanks.
    fn skip(&mut self, form: Form, range: Range<usize>, help: &str, fix: Option<&str>) {
        self.push(form, range.clone(), blank(&range), help, fix);
    }

    /// A place that is read as what is to be written there, or as blanks where that does not fit.
    fn put(&mut self, form: Form, range: Range<usize>, due: &str, help: String) {
        let read = padded(due, &range).unwrap_or_else(|| blank(&range));
        self.push(form, range, read, help, Some(due));
    }

    fn read_line(&mut self) {
        let whole = self.line.clone();
        let comment_end = |from: usize, text: &str| text.find("*/").map(|at| from + at + 2);
        if self.in_comment {
            let end = comment_end(whole.start, self.rest(whole.start));
            self.in_comment = end.is_none();
            let range = whole.start..end.unwrap_or(whole.end);
            return self.skip(Form::Comment, range, "write `//` before the comment on each line", None);
        }
        let (tokens, foreign) = tokens(self.text, whole.clone());
        // A line that begins an item ends blocks that were not closed.
        if matches!(tokens.first(), Some((Word(word), at)) if at.start == whole.start && ITEMS.contains(word)) {
            self.depth = 0;
        }
        let in_brackets =
            matches!(tokens.first(), Some((Sign('('), _))) && self.rest(whole.start).trim_end().ends_with(')');
        if self.depth == 0 && in_brackets {
            return self.skip(Form::Comment, whole, "write `//` before the comment", None);
        }
        if let Some(at) = foreign {
            let block = self.rest(at).starts_with("/*");
            let closed = comment_end(at, self.rest(at));
            self.in_comment = block && closed.is_none();
            let range = at..if block { closed.unwrap_or(whole.end) } else { whole.end };
            self.skip(Form::Comment, range, "write `//` before the comment", None);
        }
        self.signs(&tokens);
        self.heads(&tokens);
        for at in 0..tokens.len() {
            self.nc_words(&tokens[at..]);
            self.units(&tokens[at..]);
            self.values(&tokens[at..]);
            self.lists(&tokens[at..]);
            match tokens[at].0 {
                Sign('{' | '[') => self.depth += 1,
                Sign('}' | ']') => self.depth = self.depth.saturating_sub(1),
                Sign(_) if self.depth > 0 || at > 0 => self.between(&tokens, at),
                _ => {}
            }
        }
    }

    /// Signs that the language does not have.
    fn signs(&mut self, tokens: &[Token<'t>]) {
        for (token, range) in tokens {
            let Sign(sign) = *token else { continue };
            let (range, rest) = (range.clone(), self.rest(range.end));
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
                ';' => self.skip(Form::Semicolon, range, "remove `;`", Some("")),
                '≤' => self.put(Form::Relation, range, "<=", "write `<=`".to_owned()),
                '≥' => self.put(Form::Relation, range, ">=", "write `>=`".to_owned()),
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
    fn heads(&mut self, tokens: &[Token<'t>]) {
        if self.depth > 0 {
            return;
        }
        match tokens {
            [(Word("use"), from), (Word("post"), _), (Text(text), to), ..] => {
                let (range, due) = (from.start..to.end, format!("post {}", text.trim_matches('"')));
                if let Some(read) = padded(&due, &range) {
                    self.push(Form::UsePost, range, read, format!("write `{due}`"), Some(&due));
                }
            }
            [(Word("post" | "edition"), _), (Text(text), range), ..] => {
                let name = text.trim_matches('"');
                self.push(Form::Quoted, range.clone(), format!(" {name} "), format!("write `{name}`"), Some(name));
            }
            [(Word("operation"), _), (Word(name), from), (Sign('='), _), (Word(kind), to), ..] => {
                let (range, due) = (from.start..to.end, format!("{kind} {name}"));
                if let Some(read) = padded(&due, &range) {
                    self.push(Form::NamedOperation, range, read, format!("write `operation {due}`"), Some(&due));
                }
            }
            [(Word("require"), _), rest @ ..] => {
                let Some(comma) = rest.iter().position(|t| t.0 == Sign(',')) else { return };
                if rest[comma..].iter().any(|t| matches!(t.0, Sign('<' | '>'))) {
                    let range = rest[comma].1.start..rest[rest.len() - 1].1.end;
                    let help = "write the next contract on a line of its own, as `require NAME <= VALUE`";
                    self.skip(Form::SeveralContracts, range, help, None);
                }
            }
            _ => {}
        }
    }

    /// Units with other names or of other systems, and names of files without quotes; `tokens` begins at the place.
    fn units(&mut self, tokens: &[Token<'t>]) {
        match tokens {
            [
                (Number(number), from),
                (Word(length @ ("mm" | "m" | "in")) | Number(length @ "1"), _),
                (Sign('/'), _),
                (Word(time @ ("s" | "sec" | "min")), to),
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
                let range = from.start..to.end;
                // What is read there is too short for all digits: a value of the right kind keeps other faults away.
                let short = if due == "rpm" { "9999rpm" } else { "1mm/min" };
                let read = padded(&written, &range).or_else(|| padded(short, &range)).unwrap_or_else(|| blank(&range));
                self.push(Form::PerSecond, range, read, format!("write `{written}`"), Some(&written));
            }
            [(Number(_), _), (Word(word), unit), ..] => {
                if let Some((due, _)) =
                    OTHER_UNITS.iter().find(|(_, others)| others.split(' ').any(|other| other == *word))
                {
                    self.put(Form::Unit, unit.clone(), due, format!("write `{due}`"));
                }
            }
            [(Word("from"), _), (Word(word), name), ..] if is_file(word) => {
                let free = |at: usize| self.text.as_bytes().get(at).is_none_or(|b| *b == b' ');
                if name.start > self.line.start && free(name.start - 1) && name.end < self.line.end && free(name.end) {
                    let (range, fix) = (name.start - 1..name.end + 1, format!(" \"{word}\" "));
                    self.push(Form::FileName, range, format!("\"{word}\""), format!("write `\"{word}\"`"), Some(&fix));
                }
            }
            _ => {}
        }
    }

    /// Words of NC text with a decimal point or a unit behind, such as `F0.05 mm/tooth`; `tokens` begins at the place.
    fn nc_words(&mut self, tokens: &[Token<'t>]) {
        let [(Word(word), at), rest @ ..] = tokens else { return };
        let (letter, number) = word.split_at(1);
        let plain = number.split('.').all(|part| !part.is_empty() && part.bytes().all(|b| b.is_ascii_digit()));
        let unit = matches!(rest, [(Word(unit), _), ..] if is_unit(unit));
        let capital = letter.bytes().all(|b| b.is_ascii_uppercase());
        if self.depth > 0 && plain && capital && (unit || number.contains('.')) {
            let help = if unit { format!("write `{number}`") } else { format!("write `{number}` and its unit") };
            self.push(Form::NcWord, at.clone(), format!(" {number}"), help, Some(number));
        }
    }

    /// Numbers and units that are written in the manner of another language; `tokens` begins at the place.
    fn values(&mut self, tokens: &[Token<'t>]) {
        let adjacent = |a: &Range<usize>, b: &Range<usize>| a.end == b.start;
        match tokens {
            [(Number(whole), a), (Sign(','), comma), (Number(part), b), (Word(unit), _), ..]
                if adjacent(a, comma) && adjacent(comma, b) && is_unit(unit) =>
            {
                let range = a.start..b.end;
                if part.len() == 3 && *unit == "rpm" {
                    let due = format!("{whole}{part}");
                    self.put(Form::DigitGroups, range, &due, format!("write `{due} {unit}`"));
                } else {
                    let due = format!("{whole}.{part}");
                    self.push(Form::DecimalComma, range, due.clone(), format!("write `{due} {unit}`"), Some(&due));
                }
            }
            [(Number(thousands), a), (Number(rest), b), (Word(unit), _), ..]
                if rest.len() == 3 && !rest.contains('.') && is_unit(unit) =>
            {
                let due = format!("{thousands}{rest}");
                self.put(Form::DigitGroups, a.start..b.end, &due, format!("write `{due} {unit}`"));
            }
            [(Number(_), a), (Text(_) | Sign('"'), b), ..] if adjacent(a, b) => {
                let (length, read, fix) =
                    if self.rest(b.start + 1).starts_with(' ') { (2, "in", "in ") } else { (1, " ", " in") };
                self.push(Form::Inch, b.start..b.start + length, read.to_owned(), "write `in`", Some(fix));
            }
            [(Number(_), before), (Number("1"), a), (Sign('/'), _), (Word("min"), b), ..] if !adjacent(before, a) => {
                self.put(Form::Turns, a.start..b.end, "rpm", "write `rpm`".to_owned());
            }
            [(Number(_), _), (Word("mm"), a), (Sign('/'), _), (Word("rev"), b), ..] => {
                let rest = self.rest(b.end);
                let blanks = rest.len() - rest.trim_start_matches(' ').len();
                let space = a.start..b.end + blanks;
                // One blank must stay before the next word.
                let (range, read) = match padded("mm/tooth", &space) {
                    Some(read) if blanks > 2 || space.end == self.line.end => (space, read),
                    _ => (a.start..b.end, "m/min ".to_owned()),
                };
                let help = "divide the feed per turn by the number of flutes, and write `mm/tooth`";
                self.push(Form::PerTurn, range, read, help, None);
            }
            _ => {}
        }
    }

    /// Lists that are written in the manner of another language; `tokens` begins at the place.
    fn lists(&mut self, tokens: &[Token<'t>]) {
        match tokens {
            [
                (Word("sectors"), a),
                (Number(from), _),
                (Sign('-') | Word("to" | "through" | "bis"), _),
                (Number(to), c),
                ..,
            ] => self.sectors(a.start..c.end, from, to),
            [(Word("faces"), a), (Word(word @ ("hub" | "shroud" | "vane")), c), (Word(_), _), ..] if self.depth > 0 => {
                let help = match *word {
                    "hub" => "leave `faces` out: `channel` finishes the hub, `fillet` its border with the vanes",
                    "shroud" => "leave `faces` out: the lathe makes the shroud, and no operation cuts it",
                    _ => "write `faces pressure, suction`",
                };
                self.skip(Form::Faces, a.start..c.end, help, None);
            }
            [(Word("let"), a), (Word(_), _), (Sign('='), c), ..] if self.depth > 0 => {
                let read = format!("{} ", &self.text[a.start..c.start]);
                self.push(Form::Let, a.start..c.end, read, "", None);
            }
            [(Word("sectors"), a), (Word("all"), c), ..] => {
                self.skip(Form::Sectors, a.start..c.end, "leave `sectors` out for all sectors", Some(""));
            }
            [(Word("sectors"), a), (Number(both), c), ..] if both.contains("..") => {
                let (from, to) = both.split_once("..").unwrap_or_default();
                self.sectors(a.start..c.end, from, to);
            }
            [(Word("pressure"), a), (Word("suction"), b), ..]
            | [(Word("suction"), a), (Word("pressure"), b), ..]
            | [(Word("inlet"), a), (Word("outlet"), b), ..]
            | [(Word("outlet"), a), (Word("inlet"), b), ..]
                if a.end < b.start && !self.rest(self.line.start).trim_start().starts_with("vane") =>
            {
                let read = format!(",{}", " ".repeat(b.start - a.end - 1));
                self.push(Form::NoComma, a.end..b.start, read, "write a comma between the two words", Some(", "));
            }
            _ => {}
        }
    }

    /// A range of sectors.
    fn sectors(&mut self, range: Range<usize>, from: &str, to: &str) {
        let ends = from.parse::<u32>().ok().zip(to.parse::<u32>().ok()).filter(|(a, b)| a < b && b - a < 40);
        let Some((from, to)) = ends else { return };
        let numbers = (from..=to).map(|n| n.to_string()).collect::<Vec<_>>().join(", ");
        let help = format!("write `sectors {numbers}`; or leave `sectors` out for all sectors");
        self.skip(Form::Sectors, range, &help, None);
    }

    /// Signs between a name and its value, and between entries.
    fn between(&mut self, tokens: &[Token<'t>], at: usize) {
        let (sign, range) = tokens[at].clone();
        let Some((after, next)) = tokens.get(at + 1) else { return };
        let word_before = at > 0 && matches!(tokens[at - 1].0, Word(_));
        match (sign, *after) {
            (Sign(':'), _) if word_before => self.skip(Form::Colon, range, "remove `:`", Some("")),
            (Sign('='), Sign(relation @ ('<' | '>'))) if next.start == range.end => {
                let due = format!("{relation}=");
                self.push(
                    Form::Relation,
                    range.start..next.start + 1,
                    due.clone(),
                    format!("write `{due}`"),
                    Some(&due),
                );
            }
            (Sign('='), _) if word_before && self.depth > 0 => self.skip(Form::Equals, range, "remove `=`", Some("")),
            (Sign(','), Word(word)) if self.depth > 0 && !LABELS.contains(&word) => {
                if matches!(tokens.get(at + 2), Some((Number(_), _))) {
                    self.skip(Form::Comma, range, "remove the comma", Some(" "));
                }
            }
            _ => {}
        }
    }
}

/// Words that stand before a value inside of one entry.
const LABELS: [&str; 6] = ["vane", "hub", "shroud", "chord", "rough", "within"];

/// Units of the language, and their other names.
const OTHER_UNITS: [(&str, &str); 7] = [
    ("um", "mu micron microns micrometer micrometers micrometre micrometres"),
    ("mm", "millimeter millimeters millimetre millimetres"),
    ("deg", "degree degrees"),
    ("rad", "radians"),
    ("h", "hour hours"),
    ("min", "minute minutes"),
    ("s", "sec secs second seconds"),
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
fn tokens(text: &str, line: Range<usize>) -> (Vec<Token<'_>>, Option<usize>) {
    let mut found = Vec::new();
    let mut at = line.start;
    while let Some(c) = text[at..line.end].chars().next() {
        let rest = &text[at..line.end];
        if rest.starts_with("//") {
            break;
        }
        if c == '#' || rest.starts_with("/*") || begins_comment(&text[line.start..at], rest) {
            return (found, Some(at));
        }
        let piece = |of: &dyn Fn(char) -> bool| &rest[..rest.find(|c: char| !of(c)).unwrap_or(rest.len())];
        let token = match c {
            ' ' | '\t' => {
                at += 1;
                continue;
            }
            '"' => rest[1..].find('"').map_or(Sign('"'), |close| Text(&rest[..close + 2])),
            c if c.is_ascii_alphabetic() || c == '_' => {
                Word(piece(&|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '-' | '.')))
            }
            c if c.is_ascii_digit() => Number(piece(&|c| c.is_ascii_digit() || c == '.')),
            c => Sign(c),
        };
        let end = at
            + match token {
                Word(text) | Number(text) | Text(text) => text.len(),
                Sign(sign) => sign.len_utf8(),
            };
        found.push((token, at..end));
        at = end;
    }
    (found, None)
}
