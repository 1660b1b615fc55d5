//! Values of expressions: names, units, dimensions.

use crate::property::quantity::{Dimension, Quantity, unit_names};
use crate::vocabulary::other_names;
use base::source::Span;
use diagnostics::codes::job as codes;
use diagnostics::codes::syntax::MISWRITTEN;
use diagnostics::{Diag, Sink};
use std::collections::BTreeMap;
use syntax::ast::{Expr, ExprKind, Name, Operator, Path};

/// Values of `let`.
#[derive(Debug, Default)]
pub(crate) struct LetScope {
    names: BTreeMap<String, Binding>,
    /// Places of the names that are declared farther below.
    below: BTreeMap<String, Span>,
    /// Number of unknown names so far.
    unknown: usize,
    /// True when items are missing from the tree: an unknown name may be declared in one of them.
    pub(crate) damaged: bool,
}

#[derive(Debug)]
struct Binding {
    /// `None` when its expression is faulty; the fault was reported.
    value: Option<Quantity>,
    span: Span,
    used: bool,
}

impl LetScope {
    /// An empty scope.
    pub(crate) fn new(damaged: bool) -> Self {
        Self { damaged, ..Self::default() }
    }

    /// Binds a name.
    pub(crate) fn bind(&mut self, name: &Name, value: Option<Quantity>, sink: &mut Sink) {
        if let Some(first) = self.names.get(&name.text) {
            sink.push(
                Diag::error(codes::GIVEN_TWICE, format!("`{}` is declared twice", name.text))
                    .label(name.span, "declared again")
                    .label(first.span, "first declared here")
                    .help("give the second one another name"),
            );
            return;
        }
        self.names.insert(name.text.clone(), Binding { value, span: name.span, used: false });
    }

    /// States which names are declared below the place that is read next.
    pub(crate) fn declared_below(&mut self, names: impl Iterator<Item = (String, Span)>) {
        self.below = names.collect();
    }

    /// The values that are readable.
    pub(crate) fn values(&self) -> BTreeMap<String, Quantity> {
        self.names.iter().filter_map(|(name, binding)| Some((name.clone(), binding.value?))).collect()
    }

    /// Warns of unused names.
    pub(crate) fn warn_unused(&self, sink: &mut Sink) {
        for (name, binding) in self.names.iter().filter(|(_, b)| !b.used) {
            sink.push(
                Diag::warning(codes::UNUSED, format!("`{name}` is not used"))
                    .label(binding.span, "declared here")
                    .help("remove the name, or use it where its value is intended"),
            );
        }
    }

    fn look_up(&mut self, path: &Path, sink: &mut Sink) -> Option<Quantity> {
        let text = path.text();
        if let Some(binding) = self.names.get_mut(&text) {
            binding.used = true;
            return binding.value;
        }
        if self.damaged {
            return None;
        }
        if ["nan", "inf", "infinity"].contains(&text.to_ascii_lowercase().as_str()) {
            sink.push(
                Diag::error(codes::WRONG_FORM, format!("`{text}` is not a number"))
                    .label(path.span, "a finite number is expected")
                    .help("write the number itself; every number of a job must be finite"),
            );
            return None;
        }
        if let Some(diag) = nc_word(&text, path.span) {
            sink.push(diag);
            return None;
        }
        if let Some(digits) = other_names::digits(&text) {
            let diag = Diag::error(codes::UNKNOWN_NAME, format!("`{text}` is a word, not a number"));
            let diag = diag.label(path.span, "a number is expected").help(format!("write `{digits}`"));
            sink.push(diag.fix(path.span, digits.to_string()));
            return None;
        }
        if let Some(below) = self.below.get(&text) {
            sink.push(
                Diag::error(codes::UNKNOWN_NAME, format!("`{text}` is used before it is declared"))
                    .label(path.span, "used here")
                    .label(*below, "declared here")
                    .help(format!("move `let {text}` above this line; a value cannot depend on itself")),
            );
            return None;
        }
        self.unknown += 1;
        sink.push(if self.unknown > MAX_COMPARED {
            Diag::error(codes::UNKNOWN_NAME, format!("the name `{text}` is not declared"))
                .label(path.span, "not declared")
                .help("declare the name with `let` before its use, or correct it")
        } else {
            unknown(&text, path.span, "name", self.names.keys().map(String::as_str))
        });
        None
    }

    /// Value of an expression; faults go to the sink.
    pub(crate) fn value(&mut self, expr: &Expr, sink: &mut Sink) -> Option<Quantity> {
        let value = match &expr.kind {
            ExprKind::Number(number, None) => Quantity { value: *number, dimension: Dimension::NONE },
            ExprKind::Number(number, Some(unit)) => {
                let Some(quantity) = Quantity::new(*number, &unit.text) else {
                    sink.push(unknown_unit(unit));
                    return None;
                };
                quantity
            }
            ExprKind::Path(path) => self.look_up(path, sink)?,
            ExprKind::Negative(inner) => {
                let inner = self.value(inner, sink)?;
                Quantity { value: -inner.value, ..inner }
            }
            ExprKind::Chain(first, rest) => {
                let mut sum = self.value(first, sink);
                for (operator, operand) in rest {
                    let right = self.value(operand, sink);
                    sum = match (sum, right) {
                        (Some(left), Some(right)) => apply(*operator, left, right, expr.span, operand.span, sink),
                        _ => None,
                    };
                }
                sum?
            }
        };
        if !value.value.is_finite() {
            sink.push(
                Diag::error(codes::ARITHMETIC, "the value is not a finite number")
                    .label(expr.span, "too large")
                    .help("correct the number; the unit behind a number applies to it"),
            );
            return None;
        }
        Some(value)
    }

    /// Value of an expression in base units; the expression must have the dimension `due`.
    pub(crate) fn expect(&mut self, expr: &Expr, due: Dimension, what: &str, sink: &mut Sink) -> Option<f64> {
        let value = self.value(expr, sink)?;
        if value.dimension == due {
            return Some(value.value);
        }
        sink.push(mismatch(expr, value, &[due], what));
        None
    }
}

/// The diagnostic for a word as in NC text, such as `S12000`, where a value is expected.
pub(crate) fn nc_word(text: &str, span: Span) -> Option<Diag> {
    let (letter, number) = text.split_at_checked(1)?;
    let plain = !number.is_empty() && number.strip_prefix('-').unwrap_or(number).bytes().all(|b| b.is_ascii_digit());
    if !plain {
        return None;
    }
    let diag = Diag::error(MISWRITTEN, format!("`{text}` is a word of NC text, not a value of a job"))
        .label(span, "not of this language");
    let value = match letter {
        "S" => format!("{number} rpm"),
        "F" => format!("{number} mm/min"),
        _ if letter.bytes().all(|b| b.is_ascii_uppercase()) => {
            return Some(
                diag.help(format!("write the number with its unit and without the letter, such as `{number} mm`")),
            );
        }
        _ => return None,
    };
    Some(diag.help(format!("write `{value}`")).fix(span, value))
}

/// The same, where a property is expected: `M8`, or `S12000` without `speed`.
pub(crate) fn nc_entry(text: &str, span: Span) -> Option<Diag> {
    let (letter, number) = text.split_at_checked(1)?;
    if number.is_empty()
        || !number.bytes().all(|b| b.is_ascii_digit())
        || !letter.bytes().all(|b| b.is_ascii_uppercase())
    {
        return None;
    }
    let diag = Diag::error(MISWRITTEN, format!("`{text}` is a word of NC text, not a property of a job"))
        .label(span, "not of this language");
    let written = match letter {
        "S" => format!("speed {number} rpm"),
        "F" => format!("feed {number} mm/min"),
        "T" => {
            return Some(diag.help(format!(
                "name a tool of the job: `tool t1`; `number {number}` in `tool t1 = ball {{ ... }}` gives its place in the magazine"
            )));
        }
        _ => {
            let help = "remove it: the post writes coolant, offsets, modes and ends of programs; its frames can be changed, \
                        `impellerc posts siemens-840d` shows them";
            return Some(diag.help(help));
        }
    };
    Some(diag.help(format!("write `{written}`")).fix(span, written))
}

/// The diagnostic for a value of the wrong dimension, with a fix where only the unit is missing.
pub(crate) fn mismatch(expr: &Expr, value: Quantity, due: &[Dimension], what: &str) -> Diag {
    let wanted = due.iter().map(|d| d.name()).collect::<Vec<_>>().join(" or ");
    // The only times of a job are those of a program.
    let usual = due.first().map_or("", |d| if *d == Dimension::TIME { "h" } else { d.usual_unit() });
    if value.dimension == Dimension::NONE && !usual.is_empty() {
        let units = due.iter().flat_map(|d| d.units()).collect::<Vec<_>>().join(", ");
        let diag = Diag::error(codes::NO_UNIT, format!("{what} needs a unit"))
            .label(expr.span, format!("a number without a unit; {wanted} is expected"));
        // A bare name or a sum cannot take a unit. Zero is zero in every unit, but needs a unit all the same.
        return match &expr.kind {
            ExprKind::Number(_, Some(percent)) if percent.text == "%" => {
                Diag::error(codes::WRONG_DIMENSION, format!("{what} must be {wanted}, not a share"))
                    .label(expr.span, "this is a share")
                    .help(format!("write the value itself, with one of the units {units}"))
            }
            ExprKind::Number(number, None) => {
                let at = Span { start: expr.span.end, ..expr.span };
                diag.help(format!("write `{number} {usual}`, or another unit of {units}")).fix(at, format!(" {usual}"))
            }
            _ => diag.help(format!("add a unit to its numbers: {units}")),
        };
    }
    Diag::error(codes::WRONG_DIMENSION, format!("{what} must be {wanted}, not {}", value.dimension))
        .label(expr.span, format!("this is {}", value.dimension))
        .help(if usual.is_empty() {
            "write the number without a unit".to_owned()
        } else {
            format!("possible units are {}", due.iter().flat_map(|d| d.units()).collect::<Vec<_>>().join(", "))
        })
}

fn apply(
    operator: Operator,
    left: Quantity,
    right: Quantity,
    whole: Span,
    operand: Span,
    sink: &mut Sink,
) -> Option<Quantity> {
    match operator {
        Operator::Add | Operator::Subtract => {
            if left.dimension != right.dimension {
                let before = Span { end: operand.start, ..whole };
                sink.push(
                    Diag::error(
                        codes::WRONG_DIMENSION,
                        format!("{} and {} cannot be added", left.dimension, right.dimension),
                    )
                    .label(operand, format!("{} is expected, this is {}", left.dimension, right.dimension))
                    .label(before, left.dimension.name())
                    .help("both sides of a sum need the same dimension"),
                );
                return None;
            }
            let sign = if operator == Operator::Add { 1.0 } else { -1.0 };
            Some(Quantity { value: left.value + sign * right.value, dimension: left.dimension })
        }
        Operator::Multiply | Operator::Divide => {
            let sign = if operator == Operator::Multiply { 1 } else { -1 };
            if sign < 0 && right.value == 0.0 {
                sink.push(
                    Diag::error(codes::ARITHMETIC, "division by zero")
                        .label(operand, "this is zero")
                        .help("correct the divisor"),
                );
                return None;
            }
            let Some(dimension) = left.dimension.combine(right.dimension, sign) else {
                sink.push(
                    Diag::error(codes::ARITHMETIC, "the product has no dimension of the language")
                        .label(whole, "too many factors with units")
                        .help("no property of a job has such a dimension"),
                );
                return None;
            };
            let value = if sign > 0 { left.value * right.value } else { left.value / right.value };
            Some(Quantity { value, dimension })
        }
    }
}

/// The diagnostic for an unknown unit.
pub(crate) fn unknown_unit(unit: &Name) -> Diag {
    let units = unit_names();
    let diag = Diag::error(codes::UNKNOWN_UNIT, format!("`{}` is not a unit", unit.text)).known(units.iter().copied());
    if let Some((_, due)) = OTHER_SIZES.iter().find(|(other, _)| unit.text.eq_ignore_ascii_case(other)) {
        return diag
            .label(unit.span, "not known")
            .help(format!("write the value in another unit: 1 {} is {due}", unit.text));
    }
    match nearest(&unit.text, units.iter().copied()) {
        Some(near) => diag
            .label(unit.span, format!("did you mean `{near}`?"))
            .help(format!("write `{near}`"))
            .fix(unit.span, near),
        None => diag.label(unit.span, "not known").help(format!("units are {}", units.join(", "))),
    }
}

/// Units of other sizes, with one of them in a unit of the language.
const OTHER_SIZES: &[(&str, &str)] = &[
    ("cm", "10 mm"),
    ("dm", "100 mm"),
    ("m", "1000 mm"),
    ("nm", "0.001 um"),
    ("mil", "0.001 in"),
    ("thou", "0.001 in"),
    ("ft", "12 in"),
    ("ms", "0.001 s"),
    ("ipm", "25.4 mm/min"),
    ("ipt", "25.4 mm/tooth"),
    ("sfm", "0.3048 m/min"),
    ("hz", "60 rpm"),
    ("gon", "0.9 deg"),
];

/// Most unknown names of a job for which a similar name is searched.
const MAX_COMPARED: usize = 1000;

/// Most names with which an unknown name is compared. No person writes a job or library with more names, and a text may
/// have many unknown names.
const MAX_KNOWN: usize = 100;

/// Most names that a message lists.
const MAX_LISTED: usize = 30;

/// The known names for a message, at most the first [`MAX_LISTED`].
fn listed(known: &[&str]) -> String {
    let more = if known.len() > MAX_LISTED { ", ..." } else { "" };
    format!("{}{more}", known.iter().take(MAX_LISTED).copied().collect::<Vec<_>>().join(", "))
}

/// The diagnostic for an unknown word, with a suggestion where a known word is similar.
pub(crate) fn unknown<'a>(text: &str, span: Span, kind: &str, known: impl Iterator<Item = &'a str>) -> Diag {
    let known: Vec<_> = known.take(MAX_KNOWN).collect();
    let diag = Diag::error(codes::UNKNOWN_NAME, format!("no {kind} is called `{text}`"));
    suggest(diag, text, span, kind, &known)
}

/// Adds label, help and fix to a diagnostic about an unknown word.
pub(crate) fn suggest(diag: Diag, text: &str, span: Span, kind: &str, known: &[&str]) -> Diag {
    let diag = diag.known(known.iter().copied());
    match nearest(text, known.iter().copied()) {
        Some(near) => {
            let form = other_names::form(near).filter(|_| other_names::meant(text, known) == Some(near));
            let form = form.map_or_else(String::new, |form| format!(", with its values as in `{form}`"));
            diag.label(span, format!("did you mean `{near}`?")).help(format!("write `{near}`{form}")).fix(span, near)
        }
        None if known.is_empty() && kind == "name" => diag.label(span, "not declared").help(format!(
            "write a value, such as `3` or `3 mm`; a name is declared before its use, as in `let {} = 3 mm`",
            text.split('.').next().unwrap_or(text)
        )),
        None if known.is_empty() => diag.label(span, "not declared").help(format!("the job declares no {kind}")),
        None if diag.code == codes::NOT_IN_LANGUAGE => {
            diag.label(span, "not available").help(format!("available: {}", listed(known)))
        }
        None => {
            let diag = diag.label(span, "not known");
            let known = format!("known: {}", listed(known));
            match other_names::instead(text) {
                Some(instead) => diag.help(instead).note(known),
                None => diag.help(known),
            }
        }
    }
}

/// The known word that is meant: a word of another system, or the most similar word, where it is similar enough.
pub(crate) fn nearest<'a>(text: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let known: Vec<&str> = known.take(MAX_KNOWN).collect();
    if let Some(meant) = other_names::meant(text, &known) {
        return Some(meant);
    }
    // Files of the library are named without their ending.
    let text = text.strip_suffix(".toml").unwrap_or(text);
    if let Some(same) = known.iter().copied().find(|k| k.eq_ignore_ascii_case(text)) {
        return Some(same);
    }
    // `t9` is no slip for `t1`.
    let letters = text.chars().count();
    if letters < 3 && text.contains(|c: char| c.is_ascii_digit()) {
        return None;
    }
    let limit = (letters / 3).max(1);
    // The time of the edit distance is proportional to the product of the lengths; no known word is longer than this.
    if text.len() > 64 {
        return None;
    }
    // Words of very different lengths are not similar.
    let near = |k: &&str| k.len().abs_diff(text.len()) <= 4 * limit;
    known
        .into_iter()
        .filter(near)
        .map(|k| (strsim::damerau_levenshtein(text, k), k))
        .filter(|(d, _)| *d <= limit)
        .min()
        .map(|(_, k)| k)
}
