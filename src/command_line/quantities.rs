//! Numbers with a unit as values of options.

/// The value of a number with one of some units, such as `10um` or `4 GB`. Each unit has its size.
pub(super) fn with_unit(text: &str, units: &[(&str, f64)]) -> Option<f64> {
    let text = text.trim();
    let (number, size) = units.iter().find_map(|(unit, size)| Some((text.strip_suffix(unit)?, size)))?;
    Some(number.trim().parse::<f64>().ok()? * size)
}

fn millimetres(text: &str) -> Option<f64> {
    with_unit(text, &[("um", 1e-3), ("mm", 1.0)])
}

/// Millimetres of a chord error.
pub(super) fn chord(text: &str) -> Result<f64, String> {
    let within = millimetres(text).filter(|mm| (0.999e-4..=1.0).contains(mm));
    within.ok_or_else(|| "the chord error must be from 0.1um to 1mm, such as 10um".to_owned())
}

/// Millimetres between the files of an import and the part.
pub(super) fn within(text: &str) -> Result<f64, String> {
    let within = millimetres(text).filter(|mm| (0.999e-4..=100.0).contains(mm));
    within.ok_or_else(|| "the distance must be from 0.1um to 100mm, such as 20um".to_owned())
}
