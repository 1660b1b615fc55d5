//! Reads the entries of a block as properties. Each property is known, is given once, and has the right form and
//! dimension.

use super::eval::{LetScope, mismatch, nc_entry, nearest, suggest, unknown, unknown_unit};
pub(crate) use crate::property::Range;
use crate::property::quantity::Dimension;
use crate::property::{Form, Property, Without};
use crate::vocabulary;
use crate::vocabulary::other_names::instead;
use base::source::Span;
use diagnostics::codes::job as codes;
use diagnostics::{Diag, Sink};
use syntax::ast::{Block, Entry, Expr, ExprKind, Name, Value};

/// Entries of one block.
pub(crate) struct Properties<'a, 'c> {
    /// Name of the block in messages: `tool t1`.
    owner: String,
    head: Span,
    entries: Vec<(&'a Name, Vec<&'a Value>)>,
    damaged: bool,
    /// Corrections of words of other systems that were reported, each with the first of these words.
    reported: Vec<(&'static str, Span)>,
    /// Names for expressions.
    pub(crate) scope: &'c mut LetScope,
    /// Receives the faults.
    pub(crate) sink: &'c mut Sink,
}

/// What stands behind a label: `0.2 mm`, or `0.2 mm .. 0.4 mm`.
#[derive(Clone, Copy)]
pub(crate) struct LabelledValue<'a> {
    /// The value, or the first one of the range.
    pub(crate) first: &'a Expr,
    /// The second value of a range.
    pub(crate) second: Option<&'a Expr>,
}

/// Marks a further unknown property in the message about the first one, where both have the same cause.
fn also_unknown(sink: &mut Sink, first: Span, also: Span) {
    sink.change_all(|diag| {
        let same = diag.code == codes::UNKNOWN_PROPERTY && diag.labels.first().is_some_and(|label| label.span == first);
        if same { diag.label(also, "not known for the same reason") } else { diag }
    });
}

impl<'a, 'c> Properties<'a, 'c> {
    /// The properties of a block; only the `known` names are allowed.
    pub(crate) fn new(
        owner: String,
        head: Span,
        block: &'a Block,
        known: &[&str],
        scope: &'c mut LetScope,
        sink: &'c mut Sink,
    ) -> Self {
        Self::repeated(owner, head, block, known, &[], scope, sink)
    }

    /// The same; the names in `many`, which are known as well, may be repeated.
    pub(crate) fn repeated(
        owner: String,
        head: Span,
        block: &'a Block,
        known: &[&str],
        many: &[&str],
        scope: &'c mut LetScope,
        sink: &'c mut Sink,
    ) -> Self {
        let damaged = block.damaged || scope.damaged;
        let mut this = Self { owner, head, entries: Vec::new(), damaged, reported: Vec::new(), scope, sink };
        let mut before: Option<&Entry> = None;
        for entry in &block.entries {
            this.add(entry, before, known, many, block.damaged);
            before = Some(entry);
        }
        this
    }

    /// `unsure`: a fault of the block was reported, such as a bracket that is missing.
    fn add(&mut self, entry: &'a Entry, before: Option<&Entry>, known: &[&str], many: &[&str], unsure: bool) {
        let name = &entry.name;
        if known.contains(&name.text.as_str()) {
            let once = !many.contains(&name.text.as_str());
            let first = self.entries.iter().filter(|_| once).find(|(n, _)| n.text == name.text);
            if let Some((first, _)) = first {
                self.sink.push(
                    Diag::error(codes::GIVEN_TWICE, format!("{} has `{}` twice", self.owner, name.text))
                        .label(name.span, "given again")
                        .label(first.span, "first given here")
                        .help("keep one of them"),
                );
                return;
            }
            self.entries.push((name, entry.values.iter().collect()));
            return;
        }
        // `depth 3 inch  speed 9 rpm` reads as an entry `inch` with the labelled value `speed 9 rpm`.
        let bare = before.and_then(|b| b.values.last()).is_some_and(
            |v| matches!(v, Value::Expr(e) | Value::Labelled(_, e) | Value::Range(_, [_, e]) if matches!(e.kind, ExprKind::Number(_, None))),
        );
        let is_known = |value: &Value| matches!(value, Value::Expr(Expr { kind: ExprKind::Path(path), .. }) if known.contains(&path.text().as_str()));
        // A property of another item has a value of its own; a unit is followed by the next property or by nothing.
        let unit = match entry.values.as_slice() {
            [] => true,
            [Value::Labelled(label, _), ..] => known.contains(&label.text.as_str()),
            [first, ..] => is_known(first),
        };
        if bare && unit && nearest(&name.text, known.iter().copied()).is_none() {
            self.sink.push(unknown_unit(name));
            self.damaged = true;
            // The number before has a unit, but an unknown one.
            self.entries.retain(|(n, _)| before.is_none_or(|b| n.span != b.name.span));
            return;
        }
        // `N10 tool t1` and `0.2 inch  spacing equal-division`: an unknown word took the next property for its value, and its value is
        // read as a property here. The unknown word is the cause.
        let unknown_before = before.filter(|b| !known.contains(&b.name.text.as_str()));
        if unknown_before.is_some_and(|b| b.values.iter().any(is_known)) {
            return;
        }
        if name.text == "let" {
            let what = match entry.values.as_slice() {
                [Value::Labelled(declared, _), ..] => format!("let {}", declared.text),
                _ => "let".to_owned(),
            };
            self.sink.push(
                Diag::error(codes::UNKNOWN_PROPERTY, format!("`{what}` stands inside of {}", self.owner))
                    .label(name.span, "not in a block")
                    .help(format!("move `{what} = ...` out of the block, to a line above it")),
            );
            self.damaged = true;
            return;
        }
        if let Some(diag) = nc_entry(&name.text, name.span) {
            self.sink.push(diag);
            self.damaged = true;
            return;
        }
        self.add_unknown(name, known, unsure);
        self.damaged = true;
    }

    /// Reports a property that the block does not have.
    fn add_unknown(&mut self, name: &Name, known: &[&str], unsure: bool) {
        let diag = Diag::error(codes::UNKNOWN_PROPERTY, format!("{} has no property `{}`", self.owner, name.text));
        let diag = suggest(diag, &name.text, name.span, "property", known);
        let elsewhere: Vec<&str> =
            vocabulary::topics().filter(|t| t.property(&name.text).is_some()).map(|t| t.name).collect();
        if unsure && diag.fix.is_none() && !elsewhere.is_empty() {
            // Behind a missing bracket stand the properties of another block.
            return;
        }
        if let Some(reason) = instead(&name.text).filter(|_| diag.fix.is_none()) {
            if let Some((_, first)) = self.reported.iter().find(|(reported, _)| *reported == reason) {
                also_unknown(self.sink, *first, name.span);
                return;
            }
            self.reported.push((reason, name.span));
        }
        self.sink.push(match (&diag.fix, elsewhere.as_slice()) {
            (None, [first, ..]) => diag.note(format!(
                "`{}` is a property of {}; `impellerc explain {first}` shows it",
                name.text,
                elsewhere.join(", ")
            )),
            _ => diag,
        });
    }

    /// Removes a property and returns its values.
    pub(crate) fn take(&mut self, name: &str) -> Option<(&'a Name, Vec<&'a Value>)> {
        let at = self.entries.iter().position(|(n, _)| n.text == name)?;
        Some(self.entries.remove(at))
    }

    /// Removes a property whose value is a list in brackets, and returns the list.
    pub(crate) fn take_list(&mut self, name: &str) -> Option<&'a Value> {
        let listed =
            |(n, values): &(&Name, Vec<&Value>)| n.text == name && matches!(values.as_slice(), [Value::List(..)]);
        let at = self.entries.iter().position(listed)?;
        self.entries.remove(at).1.pop()
    }

    /// Removes a repeatable property and returns all of its values.
    pub(crate) fn take_all(&mut self, name: &str) -> Vec<(&'a Name, Vec<&'a Value>)> {
        let entries = std::mem::take(&mut self.entries);
        let (found, rest) = entries.into_iter().partition(|(n, _)| n.text == name);
        self.entries = rest;
        found
    }

    /// Reports a missing property.
    pub(crate) fn missing(&mut self, name: &str, example: &str) {
        if !self.damaged {
            self.sink.push(
                Diag::error(codes::MISSING_PROPERTY, format!("{} needs `{name}`", self.owner))
                    .label(self.head, format!("`{name}` is missing"))
                    .help(format!("add `{example}`")),
            );
        }
    }

    /// Reports a value of the wrong form.
    pub(crate) fn wrong_form(&mut self, span: Span, name: &str, due: &str, example: &str) {
        self.sink.push(
            Diag::error(codes::WRONG_FORM, format!("`{name}` of {} needs {due}", self.owner))
                .label(span, format!("{due} is expected"))
                .help(format!("write it like `{example}`")),
        );
    }

    /// Reports a number outside of its range.
    pub(crate) fn out_of_range(&mut self, span: Span, name: &str, range: &str) {
        self.sink.push(
            Diag::error(codes::OUT_OF_RANGE, format!("`{name}` of {} must be {range}", self.owner))
                .label(span, "out of range")
                .help(if range.starts_with("a ") { format!("give {range}") } else { format!("give a value {range}") }),
        );
    }

    /// The value of a property as an expression.
    pub(crate) fn expression(&mut self, name: &str, example: &str) -> Option<&'a Expr> {
        let (word, values) = self.take(name)?;
        match values.as_slice() {
            [Value::Expr(e)] => Some(e),
            // `speed feed 150 mm/min`: the value is missing, and the parser took the next property for it.
            [value] => {
                self.wrong_form(value.span(), name, "one number", example);
                self.damaged = true;
                None
            }
            _ => {
                self.wrong_form(word.span, name, "one value", example);
                self.damaged = true;
                None
            }
        }
    }

    /// The values of a property as expressions.
    pub(crate) fn expressions(&mut self, name: &str, example: &str) -> Option<Vec<&'a Expr>> {
        let (_, values) = self.take(name)?;
        let mut found = Vec::new();
        for value in values {
            let Value::Expr(e) = value else {
                self.wrong_form(value.span(), name, "numbers", example);
                self.damaged = true;
                return None;
            };
            found.push(e);
        }
        Some(found)
    }

    /// A number with the dimension `due` in its range, in base units; `None` when it is absent or faulty.
    pub(crate) fn number(&mut self, name: &str, due: Dimension, range: Range, example: &str) -> Option<(f64, Span)> {
        let expr = self.expression(name, example)?;
        let value = self.value_of(expr, name, due, range)?;
        Some((value, expr.span))
    }

    /// Value of an expression as this property, with all checks.
    pub(crate) fn value_of(&mut self, expr: &Expr, name: &str, due: Dimension, range: Range) -> Option<f64> {
        let value = self.scope.expect(expr, due, &format!("`{name}`"), self.sink);
        let value = value.filter(|v| {
            let good = range.holds(*v);
            if !good {
                self.out_of_range(expr.span, name, &range.text(due));
            }
            good
        });
        self.damaged |= value.is_none();
        value
    }

    /// The same for a required property.
    pub(crate) fn required(&mut self, name: &str, due: Dimension, range: Range, example: &str) -> Option<(f64, Span)> {
        if !self.has(name) {
            self.missing(name, example);
            return None;
        }
        self.number(name, due, range, example)
    }

    /// The number of a property of the table, in base units, and its place. Outer `None`: faulty, or missing though required;
    /// inner `None`: not given, or no number.
    pub(crate) fn read(&mut self, property: &Property) -> Option<Option<(f64, Span)>> {
        let (name, example) = (property.name, property.written());
        if !self.given(property) {
            return (property.without != Without::Required).then_some(None);
        }
        match property.form {
            Form::Quantity(due, range) => self.number(name, due, range, &example).map(Some),
            Form::Whole(least, most) => self.count(name, least, most, &example).map(|(n, at)| Some((n.into(), at))),
            _ => Some(None),
        }
    }

    /// The number of a property of the table, or its default; `None` where it is faulty, or missing without a default.
    pub(crate) fn read_or_default(&mut self, property: &Property) -> Option<f64> {
        self.read(property)?.map_or_else(|| property.default(), |(number, _)| Some(number))
    }

    /// The words of a property of the table; `None` where it is faulty or not given.
    pub(crate) fn words_of(&mut self, property: &Property) -> Option<Vec<&'a Name>> {
        if self.given(property) { self.words(property.name, &property.written()) } else { None }
    }

    /// The value of a property of the table as an expression; `None` where it is faulty or not given.
    pub(crate) fn expression_of(&mut self, property: &Property) -> Option<&'a Expr> {
        if self.given(property) { self.expression(property.name, &property.written()) } else { None }
    }

    /// True when a property of the table is given. One that is not, but is required, is reported as missing.
    pub(crate) fn given(&mut self, property: &Property) -> bool {
        let given = self.has(property.name);
        if !given && property.without == Without::Required {
            self.missing(property.name, &property.written());
        }
        given
    }

    /// True when the property is given and not yet removed.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.entries.iter().any(|(n, _)| n.text == name)
    }

    /// True when the value of a property is the single word `word`.
    pub(crate) fn is_word(&self, name: &str, word: &str) -> bool {
        self.entries.iter().filter(|(n, _)| n.text == name).any(|(_, values)| match values.as_slice() {
            [Value::Expr(Expr { kind: ExprKind::Path(path), .. })] => path.text() == word,
            _ => false,
        })
    }

    /// A whole number from `min` to `max`.
    pub(crate) fn count(&mut self, name: &str, min: u32, max: u32, example: &str) -> Option<(u32, Span)> {
        let expr = self.expression(name, example)?;
        let value = self.scope.value(expr, self.sink)?;
        self.whole(expr, value, name, min, max).map(|n| (n, expr.span))
    }

    fn whole(
        &mut self,
        expr: &Expr,
        value: crate::property::quantity::Quantity,
        name: &str,
        min: u32,
        max: u32,
    ) -> Option<u32> {
        if value.dimension != Dimension::NONE {
            self.sink.push(mismatch(expr, value, &[Dimension::NONE], &format!("`{name}`")));
            self.damaged = true;
            return None;
        }
        let (low, high) = (f64::from(min), f64::from(max));
        if !(low..=high).contains(&value.value) || value.value.fract() != 0.0 {
            self.out_of_range(expr.span, name, &format!("a whole number from {min} to {max}"));
            self.damaged = true;
            return None;
        }
        Some(value.value as u32)
    }

    /// One or more whole numbers from `min` to `max`.
    pub(crate) fn counts(&mut self, name: &str, min: u32, max: u32, example: &str) -> Option<Vec<(u32, Span)>> {
        let (_, values) = self.take(name)?;
        let mut out = Vec::new();
        for value in values {
            let Value::Expr(expr) = value else {
                self.wrong_form(value.span(), name, "whole numbers", example);
                return None;
            };
            let quantity = self.scope.value(expr, self.sink)?;
            out.push((self.whole(expr, quantity, name, min, max)?, expr.span));
        }
        Some(out)
    }

    /// Single words such as `pressure`.
    pub(crate) fn words(&mut self, name: &str, example: &str) -> Option<Vec<&'a Name>> {
        let (_, values) = self.take(name)?;
        let mut out = Vec::new();
        for value in values {
            match value {
                Value::Expr(Expr { kind: ExprKind::Path(path), .. }) if path.names.len() == 1 => {
                    out.extend(path.names.first());
                }
                other => {
                    self.wrong_form(other.span(), name, "a name", example);
                    self.damaged = true;
                    return None;
                }
            }
        }
        Some(out)
    }

    /// Values with labels, one value for each; each label is one of `known` and occurs once.
    pub(crate) fn labelled(&mut self, name: &str, known: &[&str], example: &str) -> Vec<(&'a Name, &'a Expr)> {
        let given = self.labelled_ranges(name, known, example);
        given.into_iter().filter_map(|(label, of)| Some((label, self.single(name, label, of, example)?))).collect()
    }

    /// The value of a label that takes one value and no range.
    pub(crate) fn single(
        &mut self,
        name: &str,
        label: &Name,
        of: LabelledValue<'a>,
        example: &str,
    ) -> Option<&'a Expr> {
        if let Some(second) = of.second {
            self.wrong_form(second.span, &format!("{name} {}", label.text), "one value and no range", example);
            self.damaged = true;
            return None;
        }
        Some(of.first)
    }

    /// Values with labels, each a value or a range; each label is one of `known` and occurs once.
    pub(crate) fn labelled_ranges(
        &mut self,
        name: &str,
        known: &[&str],
        example: &str,
    ) -> Vec<(&'a Name, LabelledValue<'a>)> {
        let Some((_, values)) = self.take(name) else { return Vec::new() };
        let mut out: Vec<(&Name, LabelledValue<'_>)> = Vec::new();
        for value in values {
            let labelled = match value {
                Value::Labelled(label, first) => Some((label, LabelledValue { first, second: None })),
                Value::Range(label, [first, second]) => Some((label, LabelledValue { first, second: Some(second) })),
                _ => None,
            };
            match labelled {
                Some((label, of)) if known.contains(&label.text.as_str()) => {
                    if out.iter().any(|(l, _)| l.text == label.text) {
                        self.sink.push(
                            Diag::error(codes::GIVEN_TWICE, format!("`{name}` has `{}` twice", label.text))
                                .label(label.span, "given again")
                                .help("keep one of them"),
                        );
                    } else {
                        out.push((label, of));
                    }
                }
                Some((label, _)) => {
                    let diag = Diag::error(codes::UNKNOWN_PROPERTY, format!("`{name}` has no part `{}`", label.text));
                    self.sink.push(suggest(diag, &label.text, label.span, "part", known));
                    self.damaged = true;
                }
                None => {
                    let due = format!("a value with a label before it ({})", known.join(", "));
                    self.wrong_form(value.span(), name, &due, example);
                    self.damaged = true;
                }
            }
        }
        out
    }
}

/// The value of a property whose row lists its words: of `all`, those that the row has. Without it, the default of the row is
/// the value, or the first word where the row has no word for the default.
pub(crate) fn named<T: Copy>(
    p: &mut Properties<'_, '_>,
    property: &Property,
    all: &[T],
    name: fn(T) -> &'static str,
) -> Option<T> {
    let Form::Word(words) = property.form else { return None };
    let words = words();
    let values: Vec<T> = all.iter().copied().filter(|value| words.contains(&name(*value))).collect();
    let default = values.iter().find(|value| property.without == Without::Is(name(**value))).or(values.first());
    Some(name_of(p, property.name, &values, name)?.unwrap_or(*default?))
}

/// A property with one of some names. Outer `None`: faulty; inner `None`: not given.
pub(crate) fn name_of<T: Copy>(
    p: &mut Properties<'_, '_>,
    property: &str,
    all: &[T],
    name: fn(T) -> &'static str,
) -> Option<Option<T>> {
    if !p.has(property) {
        return Some(None);
    }
    let example = format!("{property} {}", name(*all.first()?));
    let words = p.words(property, &example)?;
    let [word] = words.as_slice() else {
        p.wrong_form(words.first()?.span, property, "one name", &example);
        return None;
    };
    let found = all.iter().copied().find(|x| name(*x) == word.text);
    if found.is_none() {
        p.sink.push(unknown(&word.text, word.span, property, all.iter().map(|x| name(*x))));
    }
    Some(Some(found?))
}
