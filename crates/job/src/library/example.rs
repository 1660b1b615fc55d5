//! Examples of keys of library files, as the shipped files write them.

use super::schema::LibraryFile;
use crate::files::shipped;
use crate::property::quantity::Dimension;
use crate::property::{Form, Property};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Longest text of a shipped file that is shown as an example, characters.
const MAX_EXAMPLE: usize = 80;

/// Most keys of a table that is shown in one line.
const MAX_KEYS: usize = 4;

/// A key with a value, as a text for messages: `` `speed = "30 m/min"` ``, or the line of a table. `place` are the tables around the
/// key: `axes.X`.
pub(super) fn line(kind: LibraryFile, place: &str, key: &Property) -> String {
    let inside = if place.is_empty() { key.name.to_owned() } else { format!("{place}.{}", key.name) };
    match key.form {
        Form::Table(keys) if !short(keys) => format!("`[{inside}]` in a line of its own, and its keys below"),
        Form::Named(_) => format!("`[{inside}.NAME]` in a line of its own, and its keys below"),
        _ => format!("`{} = {}`", key.name, example(kind, place, key)),
    }
}

/// A value of a key: that of the first shipped file that has the key at this place, otherwise one of the right form.
pub(super) fn example(kind: LibraryFile, place: &str, key: &Property) -> String {
    let inside = if place.is_empty() { key.name.to_owned() } else { format!("{place}.{}", key.name) };
    match key.form {
        Form::Table(keys) => return table(kind, &inside, keys),
        Form::Tables(keys) => return format!("[{}]", table(kind, &inside, keys)),
        _ => {}
    }
    let files = match kind {
        LibraryFile::Machine => shipped::MACHINES,
        LibraryFile::Tools => shipped::TOOLS,
        LibraryFile::Post => shipped::POSTS,
    };
    let path: Vec<&str> = inside.split('.').collect();
    // The files that messages name come first.
    let first = |name: &str| ["5mc850-c", "carbide", "siemens-840d"].contains(&name);
    let ordered = files.iter().filter(|f| first(f.0)).chain(files.iter().filter(|f| !first(f.0)));
    let found = ordered.into_iter().find_map(|(_, text)| {
        let file = DeTable::parse(text).ok()?;
        let value = within(file.get_ref(), &path)?;
        let shown = text.get(value.span())?.to_owned();
        (shown.len() <= MAX_EXAMPLE && !shown.contains('\n') && shown != "[]" && shown != "\"\"").then_some(shown)
    });
    found.unwrap_or_else(|| made(key.form))
}

/// The value at a path; a name of a shop's own stands for any, and a list for its first entry.
fn within<'t, 'i>(table: &'t DeTable<'i>, path: &[&str]) -> Option<&'t Spanned<DeValue<'i>>> {
    let (first, rest) = path.split_first()?;
    let named = table.iter().find(|(name, _)| name.get_ref() == first).map(|(_, value)| value);
    if let Some(value) = named
        && let Some(found) = below(value, rest)
    {
        return Some(found);
    }
    // Another tool, holder or axis has such a key as well.
    table.iter().filter(|_| named.is_none() || !rest.is_empty()).find_map(|(_, value)| match rest {
        [] => None,
        rest => below(value, rest),
    })
}

fn below<'t, 'i>(value: &'t Spanned<DeValue<'i>>, rest: &[&str]) -> Option<&'t Spanned<DeValue<'i>>> {
    if rest.is_empty() {
        return Some(value);
    }
    match value.get_ref() {
        DeValue::Table(table) => within(table, rest),
        DeValue::Array(items) => items.iter().next().and_then(|item| below(item, rest)),
        _ => None,
    }
}

/// Whether a table fits into one line.
fn short(keys: &[Property]) -> bool {
    let plain = |key: &Property| !matches!(key.form, Form::Table(_) | Form::Named(_) | Form::Tables(_) | Form::Texts);
    keys.len() <= MAX_KEYS && keys.iter().all(plain)
}

/// A table in one line, with the keys that it must have.
fn table(kind: LibraryFile, inside: &str, keys: &[Property]) -> String {
    let required = keys.iter().filter(|key| key.is_due());
    let entries: Vec<String> = required.map(|key| format!("{} = {}", key.name, example(kind, inside, key))).collect();
    format!("{{ {} }}", entries.join(", "))
}

/// A value of a form.
fn made(form: Form) -> String {
    let quantity = |due: Dimension| format!("\"3 {}\"", due.usual_unit());
    let list = |one: &str, count: usize| format!("[{}]", vec![one; count].join(", "));
    match form {
        Form::Text(_) | Form::Words(_) | Form::Bounded(_) => "\"...\"".to_owned(),
        Form::Texts => "[\"...\"]".to_owned(),
        Form::TextsOf(count) => list("\"...\"", count),
        Form::Quantity(due, _) => quantity(due),
        Form::LengthTo(..) => quantity(Dimension::LENGTH),
        Form::Quantities(due, _, count) => list(&quantity(due), count),
        Form::Numbers(count) => list("0", count),
        Form::Word(words) => format!("\"{}\"", words().first().copied().unwrap_or_default()),
        Form::Whole(..) => "4".to_owned(),
        Form::Flag => "true".to_owned(),
        Form::Table(_) | Form::Named(_) => "{ }".to_owned(),
        Form::Tables(_) => "[{ }]".to_owned(),
    }
}
