//! Arithmetic of intervals.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::ops::{Add, Mul, Neg, Sub};

/// All numbers from `low` to `high`. The result of an operation contains the result for all numbers of its operands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Least number.
    pub low: f64,
    /// Greatest number.
    pub high: f64,
}

impl Interval {
    /// Only zero.
    pub const ZERO: Self = Self { low: 0.0, high: 0.0 };

    /// All numbers: nothing is known.
    pub const ALL: Self = Self { low: f64::NEG_INFINITY, high: f64::INFINITY };

    /// From one number to another.
    pub fn new([low, high]: [f64; 2]) -> Self {
        Self { low, high }
    }

    /// One number.
    pub fn of(value: f64) -> Self {
        Self { low: value, high: value }
    }

    /// The smallest interval with all of these numbers.
    pub fn hull(values: impl IntoIterator<Item = f64>) -> Self {
        let none = Self { low: f64::INFINITY, high: f64::NEG_INFINITY };
        values.into_iter().fold(none, |hull, v| Self { low: hull.low.min(v), high: hull.high.max(v) })
    }

    /// The smallest interval with both.
    #[must_use]
    pub fn join(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// Largest absolute value.
    pub fn most(self) -> f64 {
        self.high.abs().max(self.low.abs())
    }

    /// Half the width.
    pub fn half_width(self) -> f64 {
        0.5 * (self.high - self.low)
    }

    /// The square.
    #[must_use]
    pub fn squared(self) -> Self {
        let [a, b] = [self.low * self.low, self.high * self.high];
        let low = if self.low <= 0.0 && self.high >= 0.0 { 0.0 } else { a.min(b) };
        Self { low, high: a.max(b) }
    }

    /// The inverse; all numbers where zero belongs to the interval.
    #[must_use]
    pub fn inverse(self) -> Self {
        if self.low > 0.0 || self.high < 0.0 { Self { low: 1.0 / self.high, high: 1.0 / self.low } } else { Self::ALL }
    }

    /// The square root of the numbers that are not negative.
    #[must_use]
    pub fn sqrt(self) -> Self {
        Self { low: self.low.max(0.0).sqrt(), high: self.high.max(0.0).sqrt() }
    }

    /// The numbers that are those of a sine or cosine.
    #[must_use]
    pub fn unit(self) -> Self {
        Self { low: self.low.clamp(-1.0, 1.0), high: self.high.clamp(-1.0, 1.0) }
    }

    /// Sine and cosine.
    pub fn sin_cos(self) -> [Self; 2] {
        [self.cos_from(FRAC_PI_2), self.cos_from(0.0)]
    }

    /// The cosine of the numbers less `zero`.
    fn cos_from(self, zero: f64) -> Self {
        let [low, high] = [self.low - zero, self.high - zero];
        if high - low >= TAU {
            return Self { low: -1.0, high: 1.0 };
        }
        let ends = Self::hull([low, high].map(libm::cos));
        // The greatest value is at whole turns, the least value at half a turn beside them.
        let crosses = |at: f64| (high / TAU - at).floor() >= (low / TAU - at).ceil();
        Self { low: if crosses(0.5) { -1.0 } else { ends.low }, high: if crosses(0.0) { 1.0 } else { ends.high } }
    }
}

impl From<Interval> for [f64; 2] {
    fn from(interval: Interval) -> Self {
        [interval.low, interval.high]
    }
}

/// A product in which zero times anything is zero: the other factor is an end of an interval, not a value.
fn product(a: f64, b: f64) -> f64 {
    if a == 0.0 || b == 0.0 { 0.0 } else { a * b }
}

impl Add for Interval {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { low: self.low + other.low, high: self.high + other.high }
    }
}

impl Sub for Interval {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { low: self.low - other.high, high: self.high - other.low }
    }
}

impl Neg for Interval {
    type Output = Self;
    fn neg(self) -> Self {
        Self { low: -self.high, high: -self.low }
    }
}

impl Mul for Interval {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let [a, b] = [product(self.low, other.low), product(self.low, other.high)];
        let [c, d] = [product(self.high, other.low), product(self.high, other.high)];
        Self { low: a.min(b).min(c.min(d)), high: a.max(b).max(c.max(d)) }
    }
}

impl Mul<f64> for Interval {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        let [a, b] = [product(self.low, factor), product(self.high, factor)];
        Self { low: a.min(b), high: a.max(b) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn interval() -> impl Strategy<Value = Interval> {
        (-9.0..9.0_f64, 0.0..7.0_f64).prop_map(|(low, width)| Interval::new([low, low + width]))
    }

    fn holds(i: Interval, value: f64) -> bool {
        const INTERVAL_ROUNDING: f64 = 1e-12;
        i.low - INTERVAL_ROUNDING * (1.0 + value.abs()) <= value
            && value <= i.high + INTERVAL_ROUNDING * (1.0 + value.abs())
    }

    proptest! {
        #[test]
        fn results_hold_the_results_of_all_numbers(a in interval(), b in interval(), s in 0.0..1.0_f64, t in 0.0..1.0_f64) {
            let (x, y) = (a.low + (a.high - a.low) * s, b.low + (b.high - b.low) * t);
            prop_assert!(holds(a + b, x + y));
            prop_assert!(holds(a - b, x - y));
            prop_assert!(holds(a * b, x * y));
            prop_assert!(holds(a * -2.5, x * -2.5));
            prop_assert!(holds(-a, -x));
            prop_assert!(holds(a.squared(), x * x));
            prop_assert!(holds(a.sqrt(), x.max(0.0).sqrt()));
            prop_assert!(holds(b.inverse(), 1.0 / y));
            let [sin, cos] = a.sin_cos();
            prop_assert!(holds(sin, x.sin()) && holds(cos, x.cos()));
            prop_assert!(sin.low >= -1.0 && sin.high <= 1.0);
        }

        /// No end of a sine lies beyond its values: an end is reached within the interval.
        #[test]
        fn sines_are_not_too_wide(a in interval()) {
            let [sin, _] = a.sin_cos();
            let values = || (0..=4000).map(|i| (a.low + (a.high - a.low) * f64::from(i) / 4000.0).sin());
            prop_assert!(values().fold(1.0, f64::min) - sin.low < 1e-5);
            prop_assert!(sin.high - values().fold(-1.0, f64::max) < 1e-5);
        }
    }

    #[test]
    fn unknown_numbers_stay_unknown_and_are_never_nan() {
        let known = Interval::new([-1.0, 2.0]);
        assert_eq!(Interval::ALL + known, Interval::ALL);
        assert_eq!(Interval::ALL - Interval::ALL, Interval::ALL);
        assert_eq!(Interval::ALL * known, Interval::ALL);
        assert_eq!(Interval::ALL * Interval::ZERO, Interval::ZERO);
        assert_eq!(known.inverse(), Interval::ALL);
        assert_eq!(Interval::ALL.sin_cos(), [Interval::new([-1.0, 1.0]); 2]);
    }
}
