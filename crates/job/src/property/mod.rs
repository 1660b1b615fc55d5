//! A property of a block, or a key of a library file: name, form, default and meaning, declared once. Readers of blocks and of
//! files, vocabulary, reference page and JSON schemas take them from here.

pub(crate) mod limits;
pub mod quantity;

use base::units::trim;
use quantity::{Dimension, Quantity};

/// Bounds of a number, in base units; the texts go into messages.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// Between two bounds.
    Between(f64, f64),
    /// From zero to the bound.
    NotNegative(f64),
    /// From the negative bound to the bound.
    Within(f64),
}

/// Lengths below this one are written in micrometres, mm.
const SMALL: f64 = 0.01;

impl Range {
    /// Whether a value is in the range.
    pub fn holds(self, value: f64) -> bool {
        let [least, most] = self.bounds();
        (least..=most).contains(&value)
    }

    /// Least and largest value.
    pub fn bounds(self) -> [f64; 2] {
        match self {
            Self::Between(min, max) => [min, max],
            Self::NotNegative(max) => [0.0, max],
            Self::Within(max) => [-max, max],
        }
    }

    /// The range in words.
    pub fn text(self, due: Dimension) -> String {
        let unit = due.usual_unit();
        let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
        let [least, most] = self.bounds().map(|value| due.bound(value));
        format!("from {least} to {most}{unit}")
    }
}

/// A size of the tool of an operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ToolSize {
    /// Its radius.
    Radius,
    /// The length of its flutes.
    Flutes,
}

/// What stands behind a property or a key.
#[derive(Clone, Copy, Debug)]
pub enum Form {
    /// In words: form, range, words in backticks. Its reader knows the rest.
    Words(&'static str),
    /// The same with bounds that its reader takes from `limits`.
    Bounded(fn() -> String),
    /// A number with a unit of this dimension; in files a text.
    Quantity(Dimension, Range),
    /// A length from the least one, mm, to a size of the tool.
    LengthTo(f64, ToolSize),
    /// A whole number with its least and its largest value.
    Whole(u32, u32),
    /// A text in quotes, and what it is.
    Text(&'static str),
    /// One of these words.
    Word(fn() -> Vec<&'static str>),
    /// A list of texts.
    Texts,
    /// So many texts.
    TextsOf(usize),
    /// So many numbers with units.
    Quantities(Dimension, Range, usize),
    /// So many numbers.
    Numbers(usize),
    /// `true` or `false`.
    Flag,
    /// A table.
    Table(&'static [Property]),
    /// Tables by names of their own.
    Named(&'static [Property]),
    /// A list of tables.
    Tables(&'static [Property]),
}

/// What holds where a property is not given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Without {
    /// It must be given.
    Required,
    /// This value, as a job would write it.
    Is(&'static str),
    /// In words.
    Means(&'static str),
    /// Nothing, or its meaning says so.
    Nothing,
}

/// A property of a block, or a key of a table in a file.
#[derive(Clone, Copy, Debug)]
pub struct Property {
    /// Name.
    pub name: &'static str,
    /// What stands behind it.
    pub form: Form,
    /// What holds without it.
    pub without: Without,
    /// Meaning.
    pub meaning: &'static str,
    /// A value as a job writes it, for messages.
    pub example: &'static str,
    /// Kinds of the block that have it; empty for all.
    pub of: &'static [&'static str],
    /// Its names in other systems.
    pub also: &'static [&'static str],
}

/// The least length of a range, with its unit.
fn least_length(least: f64) -> String {
    if least < SMALL { format!("{} um", trim(least * 1000.0, 3)) } else { format!("{least} mm") }
}

/// A property whose value is described in words.
pub(crate) const fn property(
    name: &'static str,
    value: &'static str,
    without: Without,
    meaning: &'static str,
) -> Property {
    typed(name, Form::Words(value), without, meaning)
}

/// A property with the form of its value.
pub(crate) const fn typed(name: &'static str, form: Form, without: Without, meaning: &'static str) -> Property {
    Property { name, form, without, meaning, example: "", of: &[], also: &[] }
}

impl Property {
    /// With a value for messages.
    pub(crate) const fn like(self, example: &'static str) -> Self {
        Self { example, ..self }
    }

    /// With its names in other systems.
    pub(crate) const fn also(self, also: &'static [&'static str]) -> Self {
        Self { also, ..self }
    }

    /// With something else that holds where it is not given.
    pub(crate) const fn without(self, without: Without) -> Self {
        Self { without, ..self }
    }

    /// Of these kinds of the block alone.
    pub(crate) const fn of(self, kinds: &'static [&'static str]) -> Self {
        Self { of: kinds, ..self }
    }

    /// Whether a block of this kind has it.
    pub fn is_of(&self, kind: &str) -> bool {
        self.of.is_empty() || self.of.contains(&kind)
    }

    /// Whether each block or table must have it.
    pub(crate) fn is_due(&self) -> bool {
        self.without == Without::Required && self.of.is_empty()
    }

    /// The value that holds without it, in base units, where that is a number.
    pub(crate) fn default(&self) -> Option<f64> {
        let Without::Is(value) = self.without else { return None };
        Quantity::read(value).map(|quantity| quantity.value)
    }

    /// The property with a value, as a job writes it.
    pub(crate) fn written(&self) -> String {
        format!("{} {}", self.name, self.example)
    }

    /// Its value in words: form, range, words in backticks.
    pub fn value(&self) -> String {
        match self.form {
            Form::Words(words) | Form::Text(words) => words.to_owned(),
            Form::Bounded(words) => words(),
            Form::Quantity(due, range) => {
                let name = due.name();
                let [least, most] = range.bounds();
                let range = if due == Dimension::LENGTH && 0.0 < least && least < SMALL {
                    format!("from {} to {} mm", least_length(least), due.bound(most))
                } else {
                    range.text(due)
                };
                format!("{} {range}", name.split_once(' ').map_or(name.as_str(), |(_, noun)| noun))
            }
            Form::LengthTo(least, size) => format!(
                "length from {} to the {}",
                least_length(least),
                match size {
                    ToolSize::Radius => "radius",
                    ToolSize::Flutes => "flutes",
                }
            ),
            Form::Whole(least, most) => format!("whole number from {least} to {most}"),
            Form::Word(words) => {
                let words: Vec<String> = words().iter().map(|word| format!("`{word}`")).collect();
                match &words[..] {
                    [more @ .., one] if !more.is_empty() => format!("{} or {one}", more.join(", ")),
                    _ => words.concat(),
                }
            }
            // Of files alone, whose schema says it.
            _ => String::new(),
        }
    }

    /// Name, value, default and meaning.
    pub fn text(&self) -> String {
        format!("`{}`: {}\n\n{}", self.name, self.value_and_default(), self.meaning)
    }

    /// Value and default in one line: `LENGTH from 0 to 100 mm; without it 2 mm`.
    pub(crate) fn value_and_default(&self) -> String {
        let value = self.value();
        match self.without {
            Without::Required => format!("{value}; required"),
            Without::Is(default) | Without::Means(default) => format!("{value}; without it {default}"),
            Without::Nothing => value,
        }
    }

    /// The meaning with kinds and default, for the schema of files.
    pub(crate) fn description(&self) -> String {
        let kinds = if self.of.is_empty() { String::new() } else { format!("{}: ", self.of.join(", ")) };
        match self.without {
            Without::Is(default) | Without::Means(default) => {
                format!("{kinds}{}; without it {default}.", self.meaning.trim_end_matches('.'))
            }
            Without::Required | Without::Nothing => format!("{kinds}{}", self.meaning),
        }
    }
}
