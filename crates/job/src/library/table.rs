//! Tables of a library file whose form was compared with their keys: values by the names of the keys.

use crate::property::{Form, Property};
use base::source::{SourceId, Span};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A text of a file with its place there.
pub(super) type SpannedText = Spanned<String>;

/// A table with its keys.
#[derive(Clone, Copy)]
pub(super) struct FileTable<'t, 'i> {
    pub(super) keys: &'static [Property],
    pub(super) values: &'t DeTable<'i>,
}

fn text(value: &Spanned<DeValue<'_>>) -> Option<SpannedText> {
    Some(Spanned::new(value.span(), value.get_ref().as_str()?.to_owned()))
}

/// A number without quotes. `toml` writes all digits of an integer with its radix.
fn number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Integer(n) => Some(i64::from_str_radix(n.as_str(), n.radix()).map_or(f64::INFINITY, |n| n as f64)),
        DeValue::Float(x) => x.as_str().parse().ok(),
        _ => None,
    }
}

impl<'t, 'i> FileTable<'t, 'i> {
    /// The key of this name with its value; `None` where the file does not give it.
    pub(super) fn get(self, name: &str) -> Option<(&'static Property, &'t Spanned<DeValue<'i>>)> {
        let key = self.keys.iter().find(|key| key.name == name);
        debug_assert!(key.is_some(), "`{name}` is no key of this table");
        let (_, value) = self.values.iter().find(|(given, _)| given.get_ref() == name)?;
        Some((key?, value))
    }

    /// Whether the file gives the key.
    pub(super) fn has(self, name: &str) -> bool {
        self.get(name).is_some()
    }

    /// The number of a key where the file does not give it, in base units.
    pub(super) fn default(self, name: &str) -> Option<f64> {
        self.keys.iter().find(|key| key.name == name)?.default()
    }

    /// A text.
    pub(super) fn text(self, name: &str) -> Option<SpannedText> {
        text(self.get(name)?.1)
    }

    /// A list of texts.
    pub(super) fn texts(self, name: &str) -> Option<Vec<SpannedText>> {
        self.get(name)?.1.get_ref().as_array()?.iter().map(text).collect()
    }

    /// A list of so many texts.
    pub(super) fn texts_of<const N: usize>(self, name: &str) -> Option<[SpannedText; N]> {
        self.texts(name)?.try_into().ok()
    }

    /// A list of so many numbers.
    pub(super) fn numbers<const N: usize>(self, name: &str) -> Option<Spanned<[f64; N]>> {
        let value = self.get(name)?.1;
        let numbers: Option<Vec<f64>> = value.get_ref().as_array()?.iter().map(|item| number(item.get_ref())).collect();
        Some(Spanned::new(value.span(), numbers?.try_into().ok()?))
    }

    /// A whole number.
    pub(super) fn whole(self, name: &str) -> Option<Spanned<u32>> {
        let value = self.get(name)?.1;
        let DeValue::Integer(n) = value.get_ref() else { return None };
        Some(Spanned::new(value.span(), u32::from_str_radix(n.as_str(), n.radix()).ok()?))
    }

    /// `true` or `false`.
    pub(super) fn flag(self, name: &str) -> Option<Spanned<bool>> {
        let value = self.get(name)?.1;
        Some(Spanned::new(value.span(), value.get_ref().as_bool()?))
    }

    /// A table in this one.
    pub(super) fn table(self, name: &str) -> Option<FileTable<'t, 'i>> {
        let (key, value) = self.get(name)?;
        let Form::Table(keys) = key.form else { return None };
        Some(FileTable { keys, values: value.get_ref().as_table()? })
    }

    /// The tables of a list.
    pub(super) fn tables(self, name: &str) -> Vec<FileTable<'t, 'i>> {
        let Some((Property { form: Form::Tables(keys), .. }, value)) = self.get(name) else { return Vec::new() };
        let items = value.get_ref().as_array().into_iter().flatten();
        items.filter_map(|item| Some(FileTable { keys, values: item.get_ref().as_table()? })).collect()
    }

    /// The tables that stand by names of their own, in the order of the names.
    pub(super) fn named(self, name: &str) -> Vec<(&'t str, FileTable<'t, 'i>)> {
        let Some((Property { form: Form::Named(keys), .. }, value)) = self.get(name) else { return Vec::new() };
        let tables = value.get_ref().as_table().into_iter().flat_map(DeTable::iter);
        let mut found: Vec<_> = tables
            .filter_map(|(name, value)| {
                Some((name.get_ref().as_ref(), FileTable { keys, values: value.get_ref().as_table()? }))
            })
            .collect();
        found.sort_by_key(|named| named.0);
        found
    }

    /// The place of a value.
    pub(super) fn span(self, name: &str, source: SourceId) -> Option<Span> {
        Some(Span::new(source, self.get(name)?.1.span()))
    }
}
