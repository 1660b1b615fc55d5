//! The form of library files: their keys, and what stands behind each, compared with the table of `schema` before the
//! values are read. So faults are reported in the words of the file format, all at once, and each cause once.

use super::example::{example, line};
use super::schema::LibraryFile;
use super::table::FileTable;
use crate::block::eval::nearest;
use crate::property::quantity::{Dimension, library_units};
use crate::property::{Form, Property};
use crate::vocabulary::other_names::meant;
use base::source::{SourceId, SourceMap, Span};
use diagnostics::codes::job as codes;
use diagnostics::{Diag, Sink};
use std::collections::BTreeSet;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Most faults of form that are reported of one file. A file with more is of another kind.
const MAX_FAULTS: usize = 8;

/// Reads a library file that is already in the source map, with the reader of its kind. `used` is its place in the job. All faults
/// of its form go to the sink.
pub(super) fn read<T>(
    kind: LibraryFile,
    source: SourceId,
    sources: &SourceMap,
    used: Option<Span>,
    sink: &mut Sink,
    reader: impl FnOnce(FileTable<'_, '_>, &mut Sink) -> Option<T>,
) -> Option<T> {
    let file = sources.get(source)?;
    let mut walk = Walk { kind, source, text: &file.text, faults: Vec::new(), misplaced: Vec::new(), gaps: Vec::new() };
    match DeTable::parse(&file.text) {
        Ok(table) => {
            walk.table("", table.get_ref(), 0..0, kind.keys(), &[]);
            walk.close();
            if walk.faults.is_empty() {
                return reader(FileTable { keys: kind.keys(), values: table.get_ref() }, sink);
            }
        }
        Err(error) => walk.not_toml(&error, &file.name),
    }
    for fault in walk.faults.into_iter().take(MAX_FAULTS) {
        let diag = fault.with_places(&file.text);
        sink.push(match used {
            Some(used) => diag.label(used, "used here"),
            None => diag,
        });
    }
    None
}

/// A fault of form, and the further places where it stands.
struct Fault {
    /// What several faults of one cause share.
    cause: String,
    diag: Diag,
    more: Vec<usize>,
}

impl Fault {
    fn with_places(self, text: &str) -> Diag {
        if self.more.is_empty() {
            return self.diag;
        }
        let number = |at: &usize| text.get(..*at).unwrap_or_default().matches('\n').count() + 1;
        let lines: BTreeSet<usize> = self.more.iter().take(MAX_FAULTS).map(number).collect();
        let lines: Vec<String> = lines.iter().map(usize::to_string).collect();
        let and_more = if self.more.len() > MAX_FAULTS { ", ..." } else { "" };
        self.diag.note(format!("the same in line {}{and_more}", lines.join(", ")))
    }
}

/// A table without keys that it must have.
struct Gap {
    place: String,
    at: Range<usize>,
    keys: Vec<&'static Property>,
}

/// The walk over a file.
struct Walk<'a> {
    kind: LibraryFile,
    source: SourceId,
    text: &'a str,
    faults: Vec<Fault>,
    /// Names of keys that stand in a table where they do not belong.
    misplaced: Vec<String>,
    gaps: Vec<Gap>,
}

/// A key of the file with its value.
#[derive(Clone, Copy)]
struct Given<'v, 'i> {
    /// Tables around the key: `axes.X`.
    place: &'v str,
    key: &'static Property,
    value: &'v Spanned<DeValue<'i>>,
}

impl Walk<'_> {
    fn fault(&mut self, cause: String, at: Range<usize>, message: String, label: String, help: String) {
        if let Some(known) = self.faults.iter_mut().find(|fault| fault.cause == cause) {
            known.more.push(at.start);
            return;
        }
        let diag = Diag::error(codes::LIBRARY, message).label(Span::new(self.source, at), label).help(help);
        self.faults.push(Fault { cause, diag, more: Vec::new() });
    }

    /// The command that shows a file of this kind, which every user has.
    fn shown(&self) -> String {
        let (command, name) = match self.kind {
            LibraryFile::Machine => ("machines", "5mc850-c"),
            LibraryFile::Tools => ("tools", "carbide"),
            LibraryFile::Post => ("posts", "siemens-840d"),
        };
        format!("`impellerc {command} {name}` prints a file that is right")
    }

    /// A text that is not TOML.
    fn not_toml(&mut self, error: &toml::de::Error, name: &str) {
        let said = error.message().lines().next().unwrap_or_default();
        let bare = [
            "invalid boolean",
            "invalid date-time",
            "invalid literal",
            "string values must be quoted",
            "invalid float",
        ];
        let reason = if bare.iter().any(|begins| said.starts_with(begins)) {
            "a text stands in quotes, and a quantity too".to_owned()
        } else if said.contains("inline table") || said.contains("unclosed") {
            format!("{said}: a `}}` or `]` may be missing before this place")
        } else {
            said.to_owned()
        };
        let at = error.span().unwrap_or(0..0);
        let (reason, help) = foreign_form(self.text, at.start, said).unwrap_or_else(|| {
            (reason, "write each value as `key = value`, with quotes round texts and quantities".to_owned())
        });
        let help = format!("{help}; {}", self.shown());
        self.fault(String::new(), at, format!("the library file {name} is not TOML"), reason, help);
    }

    /// Compares a table with its keys. `as_well` are tables that stand under a misspelt name of this one.
    fn table(
        &mut self,
        place: &str,
        table: &DeTable<'_>,
        at: Range<usize>,
        keys: &'static [Property],
        as_well: &[&DeTable<'_>],
    ) {
        let known: Vec<&str> = keys.iter().map(|key| key.name).collect();
        // Misspelt names with the names that are meant.
        let mut meant: Vec<(&str, &DeValue<'_>)> = Vec::new();
        for (name, value) in table {
            if known.contains(&name.get_ref().as_ref()) {
                continue;
            }
            let near = similar(name.get_ref(), &known);
            meant.extend(near.map(|near| (near, value.get_ref())));
            self.unknown(place, name.get_ref(), name.span(), near, keys);
        }
        for key in keys {
            let Some((_, value)) = table.iter().find(|(name, _)| name.get_ref() == key.name) else { continue };
            let others = meant.iter().filter(|(near, _)| *near == key.name);
            let others: Vec<&DeTable<'_>> = others.filter_map(|(_, value)| value.as_table()).collect();
            self.value(Given { place, key, value }, &others);
        }
        let has = |key: &Property| {
            let within = |table: &DeTable<'_>| table.iter().any(|(name, _)| name.get_ref() == key.name);
            within(table)
                || as_well.iter().any(|other| within(other))
                || meant.iter().any(|(near, _)| *near == key.name)
        };
        let missing: Vec<&Property> = keys.iter().filter(|key| key.is_due() && !has(key)).collect();
        if !missing.is_empty() {
            self.gaps.push(Gap { place: place.to_owned(), at, keys: missing });
        }
    }

    /// A key that a table does not have.
    fn unknown(&mut self, place: &str, name: &str, at: Range<usize>, near: Option<&str>, keys: &'static [Property]) {
        let whole = self.kind.keys();
        // A section of a holder has no name of its own: its keys come from nowhere else.
        let listed = keys.iter().any(|key| key.name == "lower");
        let belongs = if near.is_some() || listed { None } else { place_of(name, whole, "") };
        let (label, help) = match (near, &belongs) {
            (Some(near), _) => (format!("did you mean `{near}`?"), self.renamed(place, name, near, keys)),
            (None, Some(table)) if table.is_empty() => {
                self.misplaced.push(name.to_owned());
                let help = format!(
                    "move the line above the first line in square brackets: behind `[{place}]` it belongs to that table"
                );
                ("a key of the whole file".to_owned(), help)
            }
            (None, Some(table)) => {
                self.misplaced.push(name.to_owned());
                // The table itself is not missing: its line is.
                self.misplaced.extend(table.split('.').map(str::to_owned));
                (format!("a key of [{table}]"), format!("move the line below `[{table}]`"))
            }
            (None, None) => {
                let known: Vec<&str> = keys.iter().map(|key| key.name).collect();
                ("not known".to_owned(), format!("known: {}; {}", known.join(", "), self.shown()))
            }
        };
        let message = format!("{} no key `{name}`", has(place));
        // Several keys of one table, or for one key: one cause.
        let cause = match (near, &belongs) {
            (Some(near), _) => format!("renamed {near}"),
            (None, Some(table)) => format!("stray {place} {table}"),
            (None, None) => format!("unknown {name}"),
        };
        self.fault(cause, at, message, label, help);
    }

    /// The help for a key that is known by another name: with its value, where the word is of another system.
    fn renamed(&self, place: &str, name: &str, near: &str, keys: &'static [Property]) -> String {
        let key = keys.iter().find(|key| key.name == near);
        match key.filter(|_| meant(name, &[near]).is_some()) {
            Some(key) => format!("write {}", line(self.kind, place, key)),
            None => format!("write `{near}`"),
        }
    }

    /// Reports what tables miss, unless it stands in another table by mistake.
    fn close(&mut self) {
        for Gap { place, at, keys } in std::mem::take(&mut self.gaps) {
            let keys: Vec<_> = keys.into_iter().filter(|key| !self.misplaced.iter().any(|s| s == key.name)).collect();
            let Some(first) = keys.first() else { continue };
            let names = keys.iter().map(|key| format!("`{}`", key.name)).collect::<Vec<_>>().join(", ");
            let meaning = first.description();
            let meaning = meaning.trim_end_matches('.');
            let help =
                format!("add {}: {}{}", line(self.kind, &place, first), meaning[..1].to_lowercase(), &meaning[1..]);
            let help = if keys.len() > 1 { format!("{help}; {}", self.shown()) } else { help };
            let label = format!("{names} {}", if keys.len() > 1 { "are missing" } else { "is missing" });
            self.fault(format!("missing {names}"), at, format!("{} no {names}", has(&place)), label, help);
        }
    }

    /// Compares a value with the form of its key.
    fn value(&mut self, given: Given<'_, '_>, as_well: &[&DeTable<'_>]) {
        let Given { place, key, value } = given;
        let inside = if place.is_empty() { key.name.to_owned() } else { format!("{place}.{}", key.name) };
        match (key.form, value.get_ref()) {
            (Form::Table(keys), DeValue::Table(table)) => self.table(&inside, table, value.span(), keys, as_well),
            (Form::Named(keys), DeValue::Table(table)) => {
                for (name, value) in table {
                    match value.get_ref() {
                        DeValue::Table(table) => {
                            self.table(&format!("{inside}.{}", name.get_ref()), table, value.span(), keys, &[]);
                        }
                        _ => self.nameless(&inside, name.span()),
                    }
                }
            }
            (Form::Named(_), DeValue::Array(_)) => self.nameless(&inside, value.span()),
            (Form::Tables(keys), DeValue::Array(items)) if !items.is_empty() => {
                for item in items {
                    match item.get_ref() {
                        DeValue::Table(table) => self.table(&inside, table, item.span(), keys, &[]),
                        _ => self.wrong_form(given, item),
                    }
                }
            }
            (Form::Quantity(due, _), DeValue::Integer(_) | DeValue::Float(_)) => self.bare(given, due),
            (Form::Quantities(due, _, count), DeValue::Array(items))
                if items.len() == count && items.iter().all(|item| is_text(item) || is_number(item)) =>
            {
                if items.iter().any(is_number) {
                    self.bare(given, due);
                }
            }
            (Form::Texts, DeValue::Array(items)) => {
                if let Some(item) = items.iter().find(|item| !is_text(item)) {
                    self.wrong_form(given, item);
                }
            }
            (Form::TextsOf(count), DeValue::Array(items)) if items.len() == count && items.iter().all(is_text) => {}
            (Form::Numbers(count), DeValue::Array(items)) if items.len() == count && items.iter().all(is_number) => {}
            (Form::Text(_) | Form::Word(_) | Form::Quantity(..), DeValue::String(_))
            | (Form::Flag, DeValue::Boolean(_)) => {}
            (Form::Whole(..), DeValue::Integer(n)) if u32::from_str_radix(n.as_str(), n.radix()).is_ok() => {}
            _ => self.wrong_form(given, value),
        }
    }

    /// A number where a quantity is due.
    fn bare(&mut self, Given { place, key, value }: Given<'_, '_>, due: Dimension) {
        let written = self.text.get(value.span()).unwrap_or_default();
        // Lengths and angles have one usual unit each; for others the example shows one.
        let with_unit = |number: &str| format!("\"{number} {}\"", due.usual_unit());
        let own = match value.get_ref() {
            _ if ![Dimension::LENGTH, Dimension::ANGLE].contains(&due) => None,
            DeValue::Array(items) => {
                let item = |item: &Spanned<DeValue<'_>>| {
                    let text = self.text.get(item.span()).unwrap_or_default();
                    if is_number(item) { with_unit(text) } else { text.to_owned() }
                };
                Some(format!("[{}]", items.iter().map(item).collect::<Vec<_>>().join(", ")))
            }
            _ => Some(with_unit(written)),
        };
        let right = own.unwrap_or_else(|| example(self.kind, place, key));
        let message = format!("`{}` is {}, and has no unit", key.name, due.name());
        let label = "a number and its unit, in quotes, are expected".to_owned();
        let help = format!("write `{} = {right}`; units are {}", key.name, library_units(due).join(", "));
        self.fault("no unit".to_owned(), value.span(), message, label, help);
    }

    /// A value of another form; `part` is the value itself, or an entry of a list.
    fn wrong_form(&mut self, Given { place, key, value }: Given<'_, '_>, part: &Spanned<DeValue<'_>>) {
        let due = due(key.form);
        let is = match (key.form, value.get_ref()) {
            (Form::Whole(..), DeValue::Integer(_) | DeValue::Float(_)) => {
                self.text.get(value.span()).unwrap_or("this number").to_owned()
            }
            (_, DeValue::Array(items)) if part.span() == value.span() => match items.len() {
                1 => "a list of one value".to_owned(),
                count => format!("a list of {count} values"),
            },
            _ => kind_of(part.get_ref()).to_owned(),
        };
        let message = if part.span() == value.span() {
            format!("`{}` must be {due}, not {is}", key.name)
        } else {
            format!("`{}` must be {due}, and has {is} in it", key.name)
        };
        let help = format!("write {}", line(self.kind, place, key));
        self.fault(format!("form {}", key.name), part.span(), message, format!("this is {is}"), help);
    }

    /// A table such as `[tool]` whose entries need names.
    fn nameless(&mut self, place: &str, at: Range<usize>) {
        let message = format!("each `{place}` needs a name, by which jobs and tools call it");
        let help = format!("write `[{place}.NAME]` with a name of your own, and the keys below");
        self.fault(format!("nameless {place}"), at, message, format!("behind `[{place}]` without a name"), help);
    }
}

/// What is wrong at a place of a text that is not TOML, and what to write, where the form is one of another language.
fn foreign_form(text: &str, at: usize, said: &str) -> Option<(String, String)> {
    let begin = text.get(..at)?.rfind('\n').map_or(0, |end| end + 1);
    let line = text[begin..].lines().next().unwrap_or_default();
    let rest = text.get(at..).unwrap_or_default();
    let found = |reason: &str, help: String| Some((reason.to_owned(), help));
    if text.trim_start().starts_with(['{', '<']) {
        let help = "write the file as TOML, with `[axes.X]` before the keys of a table and `key = value` on each line";
        return found("the file is written in another form, such as JSON or XML", help.to_owned());
    }
    if rest.starts_with("//") || rest.starts_with(';') || rest.starts_with("/*") {
        return found("a comment begins with `#`", "write `#` before the comment".to_owned());
    }
    if said.starts_with("duplicate key") {
        let name = if line.trim_start().starts_with('[') { line.trim() } else { line.split('=').next()?.trim() };
        return found("it stands above already", format!("keep one `{name}`, or correct the name of this one"));
    }
    let head = line.trim().strip_prefix('[').and_then(|head| head.strip_suffix(']'));
    if let Some(head) = head.filter(|head| head.contains(' ') && !head.contains('"')) {
        return found("a name has no blank in it", format!("write `[{}]`", head.trim().replace(' ', "-")));
    }
    if line.matches('"').count() > 2 && said.contains("missing comma") {
        let help = "write a text that has `\"` in it in single quotes: 'T=\"{tool.name}\" M6'";
        return found("a `\"` inside of the text ends it", help.to_owned());
    }
    None
}

/// The beginning of a sentence on a table.
fn has(place: &str) -> String {
    if place.is_empty() { "the file has".to_owned() } else { format!("[{place}] has") }
}

/// The known name that is meant.
fn similar<'k>(name: &str, known: &[&'k str]) -> Option<&'k str> {
    let same = known.iter().copied().find(|k| k.eq_ignore_ascii_case(&name.replace('_', "-")));
    same.or_else(|| nearest(name, known.iter().copied()))
}

/// The table that has a key of this name: `spindle`, or nothing for the file itself. Names of a shop's own stand as `NAME`.
fn place_of(name: &str, keys: &[Property], place: &str) -> Option<String> {
    if keys.iter().any(|key| key.name == name) {
        return Some(place.to_owned());
    }
    let inside = |key: &Property| if place.is_empty() { key.name.to_owned() } else { format!("{place}.{}", key.name) };
    keys.iter().find_map(|key| match key.form {
        Form::Table(keys) => place_of(name, keys, &inside(key)),
        Form::Named(keys) => place_of(name, keys, &format!("{}.NAME", inside(key))),
        _ => None,
    })
}

fn is_text(value: &Spanned<DeValue<'_>>) -> bool {
    value.get_ref().is_str()
}

fn is_number(value: &Spanned<DeValue<'_>>) -> bool {
    value.get_ref().is_integer() || value.get_ref().is_float()
}

/// What a value is, in words.
fn kind_of(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => "a text",
        DeValue::Integer(_) | DeValue::Float(_) => "a number without quotes",
        DeValue::Boolean(true) => "`true`",
        DeValue::Boolean(false) => "`false`",
        DeValue::Datetime(_) => "a date",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a table",
    }
}

/// What a key takes, in words.
fn due(form: Form) -> String {
    match form {
        Form::Text(_) | Form::Words(_) | Form::Bounded(_) => "a text in quotes".to_owned(),
        Form::Texts => "a list of texts".to_owned(),
        Form::TextsOf(count) => format!("a list of {count} texts"),
        Form::Quantity(due, _) => format!("{} in quotes", due.name()),
        Form::LengthTo(..) => format!("{} in quotes", Dimension::LENGTH),
        Form::Quantities(due, _, count) => format!("a list of {count} values, each {} in quotes", due.name()),
        Form::Numbers(count) => format!("a list of {count} numbers"),
        Form::Word(words) => {
            let words: Vec<String> = words().iter().map(|word| format!("\"{word}\"")).collect();
            match &words[..] {
                [one] => one.clone(),
                more => format!("one of {}", more.join(", ")),
            }
        }
        Form::Whole(..) => "a whole number without quotes".to_owned(),
        Form::Flag => "`true` or `false` without quotes".to_owned(),
        Form::Table(_) | Form::Named(_) => "a table".to_owned(),
        Form::Tables(_) => "a list of tables".to_owned(),
    }
}
