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

/// Millimetres of the radius of a fillet.
pub(super) fn fillet(text: &str) -> Result<f64, String> {
    let radius = millimetres(text).filter(|mm| (0.05..=50.0).contains(mm));
    radius.ok_or_else(|| "the radius must be from 0.05mm to 50mm, such as 0.8mm".to_owned())
}

/// Millimetres between the files of an import and the part.
pub(super) fn within(text: &str) -> Result<f64, String> {
    let within = millimetres(text).filter(|mm| (0.999e-4..=100.0).contains(mm));
    within.ok_or_else(|| "the distance must be from 0.1um to 100mm, such as 20um".to_owned())
}

/// A price.
pub(super) fn price(text: &str) -> Result<f64, String> {
    let price = text.trim().parse().ok().filter(|price: &f64| price.is_finite() && *price >= 0.0);
    price.ok_or_else(|| "a price is a number that is not negative, such as 95 or 4.50".to_owned())
}
