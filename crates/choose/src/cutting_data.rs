//! Cutting speeds and feeds.
//!
//! Cutting speeds of coated solid carbide lie in these ranges in workshop tables: wrought aluminium 200 to 500 m/min, steel 80 to
//! 160, austenitic stainless steel 50 to 100, titanium 40 to 70, nickel 20 to 40. Values here are from the lower half of each range:
//! tools of impellers are long. Feeds are shares of the largest feed per tooth of the tool, which falls with its stick-out and
//! with the material.

use ir::Tool;
use std::f64::consts::PI;
use wheel::material::Material;

/// Share of the largest feed per tooth while roughing.
const ROUGH_SHARE: f64 = 0.8;

/// The same on finished surfaces.
const FINISH_SHARE: f64 = 0.5;

/// Speed of the spindle, and the feed of the tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CuttingData {
    /// Rpm.
    pub(crate) speed: f64,
    /// Roughing, mm/min.
    pub(crate) rough: f64,
    /// Finishing, mm/min.
    pub(crate) finish: f64,
}

/// Cutting speed at the diameter, m/min.
pub(crate) fn cutting_speed(material: Material) -> f64 {
    match material {
        Material::Aluminium => 300.0,
        Material::Steel => 110.0,
        Material::Stainless => 70.0,
        Material::Titanium => 50.0,
        Material::Nickel => 25.0,
    }
}

/// Cutting data of a tool in a material, within the speeds of a spindle, rpm.
pub(crate) fn cutting_data(tool: &Tool, material: Material, [least, most]: [f64; 2]) -> CuttingData {
    let diameter = 2.0 * tool.solid.cutter.nominal_radius();
    let speed = (1000.0 * cutting_speed(material) / (PI * diameter)).clamp(least, most);
    // Rounding may not leave the range of the spindle.
    let speed = rounded(speed).clamp(least, most);
    let feed = |share: f64| rounded(share * tool.max_chip.get() * f64::from(tool.flutes) * speed);
    CuttingData { speed, rough: feed(ROUGH_SHARE), finish: feed(FINISH_SHARE) }
}

/// A value with two digits, rounded down.
pub(crate) fn rounded(value: f64) -> f64 {
    let mut unit = 1.0;
    while value / unit >= 100.0 {
        unit *= 10.0;
    }
    while value / unit < 10.0 {
        unit /= 10.0;
    }
    (value / unit).floor() * unit
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_have_two_digits() {
        for (value, due) in [(15_915.0, 15_000.0), (99.9, 99.0), (0.123, 0.12), (8.0, 8.0), (1000.0, 1000.0)] {
            assert!((rounded(value) - due).abs() < 1e-12 * due, "{value}");
        }
    }

    #[test]
    fn harder_materials_are_cut_slower() {
        assert!(Material::ALL.windows(2).all(|pair| cutting_speed(pair[0]) > cutting_speed(pair[1])));
    }
}
