//! Facts that a file or the caller states.

use super::found::Found;
use super::frame::{Axis, Handedness, LengthUnit};
use super::{Options, limits};
use base::source::{Span, Spanned};
use diagnostics::Diag;
use diagnostics::codes::import as codes;
use std::fmt::Display;

/// A kind of fact: its name, the option that states it, what the option takes.
struct StatedFact {
    name: &'static str,
    option: &'static str,
    values: &'static str,
}

const UNIT: StatedFact = StatedFact { name: "unit of length", option: "--unit", values: "mm, cm, m, in or ft" };
const AXIS: StatedFact = StatedFact { name: "axis of rotation", option: "--axis", values: "x, y or z" };
const HANDEDNESS: StatedFact = StatedFact { name: "handedness", option: "--handedness", values: "right or left" };
const COUNT: StatedFact = StatedFact { name: "number of main blades", option: "--blades", values: "a whole number" };

/// Share by which units may differ that are the same.
pub(super) const SAME_UNIT: f64 = 1e-9;

/// The value that file and caller state. A value that both state must be the same.
fn one<T: PartialEq + Copy + Display>(
    fact: &StatedFact,
    file: Option<Spanned<T>>,
    given: Option<T>,
    found: &mut Found,
) -> Result<Option<T>, Diag> {
    if let (Some(file), Some(given)) = (&file, given)
        && file.value != given
    {
        let says = format!("the {} of the file is {}", fact.name, file.value);
        return Err(contradicts(fact, &says, file.span, given));
    }
    match (&file, given) {
        (Some(file), _) => found.note(file.span, format!("the {} is {}", fact.name, file.value)),
        (None, Some(given)) => found.note(None, format!("the {} is {given}, by `{}`", fact.name, fact.option)),
        (None, None) => {}
    }
    Ok(file.map(|file| file.value).or(given))
}

/// The fault of a fact of the file that the option states otherwise.
fn contradicts(fact: &StatedFact, says: &str, at: Span, given: impl Display) -> Diag {
    Diag::error(codes::CONTRADICTS, format!("{says}, but `{}` says {given}", fact.option))
        .label(at, "stated here")
        .help(format!("leave out `{}`, or correct the file", fact.option))
}

/// Refuses an option that states another unit than a file which has it as a number, in mm. Such units are the same within
/// 1e-9: the numbers of files have some digits.
pub(super) fn same_unit(options: &Options, mm: f64, says: &str, at: Span) -> Result<(), Diag> {
    match options.unit {
        Some(given) if (given.mm() - mm).abs() > SAME_UNIT * given.mm() => Err(contradicts(&UNIT, says, at, given)),
        _ => Ok(()),
    }
}

/// The fault of a fact that nothing states.
pub(super) fn not_stated(name: &str, option: &str, values: &str, at: Span) -> Diag {
    Diag::error(codes::NOT_STATED, format!("the file does not state the {name}"))
        .label(at, "in this file")
        .help(format!("state `{option}`: {values}"))
}

/// Facts that the file or the caller must state. Those that nothing states are reported together.
#[derive(Debug)]
pub(super) struct RequiredFacts<'a> {
    options: &'a Options,
    found: &'a mut Found,
    at: Span,
    missing: Vec<Diag>,
}

impl<'a> RequiredFacts<'a> {
    /// Facts of the file at a place.
    pub(super) fn of(options: &'a Options, found: &'a mut Found, at: Span) -> Self {
        Self { options, found, at, missing: Vec::new() }
    }

    fn required<T: PartialEq + Copy + Display>(
        &mut self,
        fact: &StatedFact,
        file: Option<Spanned<T>>,
        given: Option<T>,
        stand_in: T,
    ) -> Result<T, Diag> {
        let value = one(fact, file, given, self.found)?;
        if value.is_none() {
            self.missing.push(not_stated(fact.name, fact.option, fact.values, self.at));
        }
        Ok(value.unwrap_or(stand_in))
    }

    /// Unit of length. Without one the value has no meaning, and [`Self::end`] refuses the file.
    pub(super) fn unit(&mut self, file: Option<Spanned<LengthUnit>>) -> Result<LengthUnit, Diag> {
        self.required(&UNIT, file, self.options.unit, LengthUnit::Millimetre)
    }

    /// Axis of rotation, as [`Self::unit`].
    pub(super) fn axis(&mut self, file: Option<Spanned<Axis>>) -> Result<Axis, Diag> {
        self.required(&AXIS, file, self.options.axis, Axis::Z)
    }

    /// Number of main blades, as [`Self::unit`].
    pub(super) fn blades(&mut self, file: Option<Spanned<u32>>) -> Result<u32, Diag> {
        let count = self.required(&COUNT, file.clone(), self.options.blades, 1)?;
        if (1..=limits::COUNT).contains(&count) {
            return Ok(count);
        }
        let message = format!("{count} blades cannot stand round an axis");
        let span = file.map_or(self.at, |file| file.span);
        Err(Diag::error(codes::MALFORMED, message)
            .label(span, format!("a number from 1 to {} is expected", limits::COUNT))
            .help("give the number of main blades of the whole row"))
    }

    /// Handedness. The formats have right-handed frames where they say nothing.
    pub(super) fn handedness(&mut self, file: Option<Spanned<Handedness>>) -> Result<Handedness, Diag> {
        let value = one(&HANDEDNESS, file, self.options.handedness, self.found)?;
        if value.is_none() {
            self.found.note(self.at, "the frame is taken for right handed: the file says nothing else");
        }
        Ok(value.unwrap_or(Handedness::Right))
    }

    /// Refuses the file where a fact is missing; the first is returned, the others are further faults.
    pub(super) fn end(self) -> Result<(), Diag> {
        let mut missing = self.missing.into_iter();
        let Some(first) = missing.next() else { return Ok(()) };
        self.found.faults.extend(missing);
        Err(first)
    }
}
