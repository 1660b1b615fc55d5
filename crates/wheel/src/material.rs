//! Materials of the stock: the force that they need to be cut, and the share of a tool's limits that they leave.
//!
//! The specific cutting force is that of Kienzle, k = k1 h^-0.25 for a chip h mm thick. k1, the force on a chip of 1 mm2
//! that is 1 mm thick, is the middle of what makers of tools state for the groups of ISO 513 (N, P, M, and S for titanium
//! and nickel).

use serde::{Deserialize, Serialize};
use std::f64::consts::FRAC_PI_2;

base::named! {
    /// Material of the stock.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Material {
        /// Wrought aluminium.
        Aluminium = "aluminium",
        /// Unalloyed and low-alloy steel.
        Steel = "steel",
        /// Austenitic stainless steel.
        Stainless = "stainless",
        /// Titanium alloy.
        Titanium = "titanium",
        /// Nickel alloy.
        Nickel = "nickel",
    }
}

/// Exponent of the thickness of the chip in the specific cutting force.
const EXPONENT: f64 = 0.25;

/// N mm/min of a kilowatt.
const KILOWATT: f64 = 6e7;

impl Material {
    /// Share of the usual limits of a tool, which are those for aluminium.
    pub fn share(self) -> f64 {
        match self {
            Self::Aluminium => 1.0,
            Self::Steel => 0.6,
            Self::Stainless => 0.5,
            Self::Titanium => 0.4,
            Self::Nickel => 0.25,
        }
    }

    /// Force on a chip of 1 mm2 that is 1 mm thick, N.
    pub fn unit_force(self) -> f64 {
        match self {
            Self::Aluminium => 500.0,
            Self::Steel => 1700.0,
            Self::Stainless => 2000.0,
            Self::Titanium => 1400.0,
            Self::Nickel => 2700.0,
        }
    }

    /// Power at the cutter, kW, that removes `section` mm2 at `feed` mm/min with `teeth` teeth a minute. The chip is taken
    /// as thick as the mean chip of a slot, 2/pi of the feed per tooth.
    pub fn power(self, section: f64, feed: f64, teeth: f64) -> f64 {
        let chip = feed / (teeth * FRAC_PI_2);
        self.unit_force() * libm::pow(chip, -EXPONENT) * section * feed / KILOWATT
    }

    /// The feed, mm/min, at which [`Self::power`] is `power` kW.
    pub fn feed_at(self, power: f64, section: f64, teeth: f64) -> f64 {
        let force = self.unit_force() * libm::pow(teeth * FRAC_PI_2, EXPONENT) * section;
        libm::pow(power * KILOWATT / force, (1.0 - EXPONENT).recip())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A slot of 100 mm2 at 1000 mm/min is 100 cm3/min. A kilowatt removes 16 to 22 cm3/min of steel and 55 to 90 cm3/min
    /// of aluminium, by the unit powers of workshop tables (1 to 1.4, and 0.25 to 0.4 horsepower a cubic inch a minute).
    #[test]
    fn power_is_that_of_workshop_tables() {
        let power = Material::Steel.power(100.0, 1000.0, 10_000.0);
        assert!((4.5..=6.2).contains(&power), "{power}");
        let aluminium = Material::Aluminium.power(100.0, 1000.0, 10_000.0);
        assert!((1.1..=1.8).contains(&aluminium), "{aluminium}");
    }

    #[test]
    fn the_feed_at_a_power_has_this_power() {
        for material in Material::ALL {
            for (section, feed, teeth) in [(3.0, 900.0, 4000.0), (180.0, 4500.0, 56_000.0)] {
                let power = material.power(section, feed, teeth);
                let back = material.feed_at(power, section, teeth);
                assert!((back / feed - 1.0).abs() < 1e-12, "{material:?} {back} {feed}");
            }
        }
    }
}
