//! Physical quantities as types. Inside the compiler a length is in millimetres, an angle in radians, a time in
//! seconds, a feed in millimetres per minute. Other units exist in texts: jobs, files of the library, NC text, messages.
//! Figures that are made for texts, such as those of a certificate, have angles in degrees, and say so.

use serde::{Deserialize, Serialize};
use std::cmp::Ordering;
use std::fmt;
use std::iter::Sum;
use std::ops::AddAssign;

macro_rules! number {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd, Serialize, Deserialize)]
        #[serde(transparent)]
        pub struct $name(pub f64);

        impl Sum for $name {
            fn sum<I: Iterator<Item = Self>>(quantities: I) -> Self {
                Self(quantities.map(Self::get).sum())
            }
        }

        impl AddAssign for $name {
            fn add_assign(&mut self, other: Self) {
                self.0 += other.0;
            }
        }

        impl From<f64> for $name {
            fn from(number: f64) -> Self {
                Self(number)
            }
        }

        impl From<$name> for f64 {
            fn from(quantity: $name) -> Self {
                quantity.0
            }
        }

        impl $name {
            /// The bare number, in the unit of the type.
            pub const fn get(self) -> f64 {
                self.0
            }

            /// The order of all numbers, those that are not finite included.
            pub fn total_cmp(&self, other: &Self) -> Ordering {
                self.0.total_cmp(&other.0)
            }
        }
    };
}

number!(
    /// An angle in degrees, for figures that people read; elsewhere an angle is a [`Rad`].
    Deg
);
number!(
    /// A share of one.
    Share
);

/// A number with a unit that prints with it.
macro_rules! quantity {
    ($(#[$doc:meta])* $name:ident, $unit:literal) => {
        number!($(#[$doc])* $name);

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "{} {}", trim(self.0, 6), $unit)
            }
        }
    };
}

quantity!(
    /// A length in millimetres.
    Mm,
    "mm"
);
quantity!(
    /// A feed in millimetres per minute.
    MmPerMin,
    "mm/min"
);
quantity!(
    /// A spindle speed in revolutions per minute.
    Rpm,
    "rpm"
);
quantity!(
    /// A time in seconds.
    Sec,
    "s"
);

quantity!(
    /// An area in square millimetres.
    Mm2,
    "mm2"
);
quantity!(
    /// A volume in cubic millimetres.
    Mm3,
    "mm3"
);
quantity!(
    /// A removal rate in cubic millimetres per minute.
    Mm3PerMin,
    "mm3/min"
);
quantity!(
    /// A removal rate in cubic millimetres per second.
    Mm3PerSec,
    "mm3/s"
);
quantity!(
    /// A power in kilowatts.
    Kw,
    "kW"
);

impl Mm3PerSec {
    /// The same by minutes, as people state it.
    pub fn by_minute(self) -> Mm3PerMin {
        Mm3PerMin(self.0 * 60.0)
    }
}

/// An angle in radians; it prints in degrees.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Rad(pub f64);

impl Rad {
    /// The bare number of radians.
    pub const fn get(self) -> f64 {
        self.0
    }

    /// An angle given in degrees.
    pub fn from_deg(deg: f64) -> Self {
        Self(deg.to_radians())
    }

    /// The angle in degrees.
    pub fn deg(self) -> f64 {
        self.0.to_degrees()
    }
}

impl fmt::Display for Rad {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} deg", trim(self.deg(), 6))
    }
}

/// `value` with at most `decimals` decimals, without trailing zeros and without a negative zero.
pub fn trim(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// Lengths below this value are written in micrometres, mm: larger ones a machinist reads in millimetres.
const MICROMETRES_BELOW: f64 = 0.2;

/// An amount of memory in the form of all texts.
pub fn bytes(bytes: f64) -> String {
    if bytes < 1e9 { format!("{:.0} MB", bytes / 1e6) } else { format!("{:.1} GB", bytes / 1e9) }
}

/// A length in mm in the form of all texts: micrometres with two decimals below 0.2 mm, else millimetres with three.
/// Lengths below 0.01 um have four decimals.
pub fn length(mm: f64) -> String {
    let size = mm.abs();
    if size >= MICROMETRES_BELOW || size.is_nan() {
        format!("{mm:.3} mm")
    } else if size == 0.0 {
        "0 mm".to_owned()
    } else if size < 1e-5 {
        format!("{:.4} um", mm * 1e3)
    } else {
        format!("{:.2} um", mm * 1e3)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_lengths_are_micrometres() {
        let said = [0.0, -0.0, 5e-4, -0.0054, 0.012_34, 2e-6, 0.1999, 0.2, -1.0, 12.345_67].map(length);
        let due = [
            "0 mm",
            "0 mm",
            "0.50 um",
            "-5.40 um",
            "12.34 um",
            "0.0020 um",
            "199.90 um",
            "0.200 mm",
            "-1.000 mm",
            "12.346 mm",
        ];
        assert_eq!(said, due);
        assert_eq!(length(f64::NAN), "NaN mm");
    }
}
