//! The unit of length of a file: an SI unit with its prefix, or one that is converted to it, such as the inch.

use super::super::Options;
use super::super::found::Found;
use super::super::stated::{RequiredFacts, SAME_UNIT, same_unit};
use super::table::{Entity, EntityTable};
use base::source::Span;
use base::units::trim;
use diagnostics::Diag;
use diagnostics::codes::import as codes;

/// Most conversions from a unit to the metre. Files have one.
const MAX_CONVERSIONS: usize = 8;

/// Names of the SI prefixes with their powers of ten.
const PREFIXES: [(&str, i32); 16] = [
    ("EXA", 18),
    ("PETA", 15),
    ("TERA", 12),
    ("GIGA", 9),
    ("MEGA", 6),
    ("KILO", 3),
    ("HECTO", 2),
    ("DECA", 1),
    ("DECI", -1),
    ("CENTI", -2),
    ("MILLI", -3),
    ("MICRO", -6),
    ("NANO", -9),
    ("PICO", -12),
    ("FEMTO", -15),
    ("ATTO", -18),
];

/// Millimetres of the unit of length that the file or the caller states.
///
/// # Errors
/// A unit that is not stated, that is stated twice and not alike, or that is not one of length.
pub(super) fn length(table: &EntityTable<'_>, options: &Options, end: Span, found: &mut Found) -> Result<f64, Diag> {
    let mut stated: Option<(f64, Span)> = None;
    for context in table.of_kinds(&["GLOBAL_UNIT_ASSIGNED_CONTEXT"]) {
        let context = context?;
        for number in context.arguments("GLOBAL_UNIT_ASSIGNED_CONTEXT")?.references(0)? {
            let unit = table.entity(number, context.span)?;
            if unit.part("LENGTH_UNIT").is_none() {
                continue;
            }
            let mm = millimetres(table, unit)?;
            match stated {
                Some((other, at)) if (mm - other).abs() > SAME_UNIT * mm => {
                    return Err(Diag::error(codes::CONTRADICTS, "the file has two units of length")
                        .label(context.span, format!("{} mm", trim(mm, 9)))
                        .label(at, format!("{} mm", trim(other, 9)))
                        .help("export the wheel as a part of its own"));
                }
                _ => stated = stated.or(Some((mm, context.span))),
            }
        }
    }
    let Some((mm, at)) = stated else {
        let mut required = RequiredFacts::of(options, found, end);
        let unit = required.unit(None)?;
        required.end()?;
        return Ok(unit.mm());
    };
    same_unit(options, mm, &format!("the unit of the file is {} mm", trim(mm, 9)), at)?;
    found.note(at, format!("the unit of length is {} mm", trim(mm, 9)));
    Ok(mm)
}

/// Radians of the unit of angles: a radian where the file has no other one.
pub(super) fn angle(table: &EntityTable<'_>) -> Result<f64, Diag> {
    for context in table.of_kinds(&["GLOBAL_UNIT_ASSIGNED_CONTEXT"]) {
        let context = context?;
        for number in context.arguments("GLOBAL_UNIT_ASSIGNED_CONTEXT")?.references(0)? {
            let unit = table.entity(number, context.span)?;
            if unit.part("PLANE_ANGLE_UNIT").is_none() || unit.part("CONVERSION_BASED_UNIT").is_none() {
                continue;
            }
            let measure = table.entity(unit.arguments("CONVERSION_BASED_UNIT")?.reference(1)?, unit.span)?;
            let radians = measure.arguments("MEASURE_WITH_UNIT")?.number(0)?;
            if !(1e-6..10.0).contains(&radians) {
                return Err(measure.fault("a unit of angles is not between 0.000001 and 10 rad"));
            }
            return Ok(radians);
        }
    }
    Ok(1.0)
}

/// Millimetres of a unit.
fn millimetres<'t>(table: &EntityTable<'t>, mut unit: Entity<'t>) -> Result<f64, Diag> {
    let mut factor = 1.0;
    for _ in 0..MAX_CONVERSIONS {
        if unit.part("SI_UNIT").is_some() {
            let si = unit.arguments("SI_UNIT")?;
            let power = match si.word(0) {
                None => Some(0),
                Some(word) => PREFIXES.iter().find(|(name, _)| *name == word).map(|(_, power)| *power),
            };
            return match (power, si.word(1)) {
                (Some(power), Some("METRE")) => Ok(factor * 1000.0 * libm::pow(10.0, f64::from(power))),
                _ => Err(unit.fault("this is no unit of length of the SI")),
            };
        }
        let base = unit.arguments("CONVERSION_BASED_UNIT")?.reference(1)?;
        let measure = table.entity(base, unit.span)?;
        let arguments = measure.arguments("MEASURE_WITH_UNIT")?;
        let value = arguments.number(0)?;
        if value <= 0.0 {
            return Err(measure.fault("a unit of length is not positive"));
        }
        factor *= value;
        unit = table.entity(arguments.reference(1)?, measure.span)?;
    }
    Err(unit.fault("a unit is converted to itself"))
}
