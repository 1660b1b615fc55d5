//! How far a function lies from the parabola through its values at both ends and in the middle of a range.

use super::Jet;

/// Largest deviation for a third derivative of at most one and half a range of one: max |x (x^2 - 1)| / 6, at x = 1/sqrt 3.
const THIRD: f64 = 0.0642;

/// The same for a second derivative of at most one that may jump: the greatest integral of the absolute value of the kernel
/// of Peano, near x = 0.52.
const SECOND: f64 = 0.1506;

/// The same for a first derivative of at most one that may jump, near x = 0.55.
const FIRST_DERIVATIVE_FACTOR: f64 = 0.6315;

/// The same for a value of at most one: its own and that of the parabola.
const VALUE: f64 = 1.0 + WEIGHTS;

/// Greatest sum of the absolute weights with which the parabola takes the three values.
const WEIGHTS: f64 = 1.25;

/// Thickness of a surface that is not known at all, mm: more than the size of any part.
const UNKNOWN: f64 = 1e6;

/// A bound of how far a function, or a surface, lies from the parabola, or the biquadratic, through its points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellThickness {
    /// The bound, mm.
    pub most: f64,
    /// True where the bound is that of the third derivative: then it is at most an eighth over half of the range.
    pub cubic: bool,
}

impl CellThickness {
    /// Of a vector function over a range of the parameter with this half width.
    ///
    /// A constant part of a derivative belongs to the parabola. Therefore half the width of its interval counts where the next
    /// derivative jumps.
    pub fn of(function: &[Jet; 3], half: f64) -> Self {
        let norm = |measure: &dyn Fn(&Jet) -> f64| function.iter().map(measure).map(|x| x * x).sum::<f64>().sqrt();
        let smooth = function.iter().map(|f| f.smooth).fold(2, i32::min);
        let value = VALUE * norm(&|f| f.orders[0].half_width());
        let first = FIRST_DERIVATIVE_FACTOR * half * norm(&|f| f.orders[1].half_width());
        let second = SECOND * half * half * norm(&|f| f.orders[2].half_width());
        let third = THIRD * half * half * half * norm(&|f| f.orders[3].most());
        let mut least = Self { most: UNKNOWN, cubic: false };
        let bounds = [(value, true), (first, smooth >= 0), (second, smooth >= 1), (third, smooth >= 2)];
        for (order, (most, valid)) in bounds.into_iter().enumerate() {
            if valid && most <= least.most {
                least = Self { most, cubic: order == 3 };
            }
        }
        least
    }

    /// Of a function whose first derivative has at most this length, with any jumps, over a range with this half width.
    pub fn of_rate(rate: f64, half: f64) -> Self {
        Self { most: (FIRST_DERIVATIVE_FACTOR * half * rate).min(UNKNOWN), cubic: false }
    }

    /// Of a surface, from the thicknesses of its lines along both parameters.
    pub fn of_surface([x, y]: [Self; 2]) -> Self {
        Self { most: (x.most + WEIGHTS * y.most).min(UNKNOWN), cubic: x.cubic && y.cubic }
    }

    /// Of the sum of two functions.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self { most: self.most + other.most, cubic: self.cubic && other.cubic }
    }

    /// Over half of the range, where that follows from this bound.
    pub fn halved(self) -> Option<Self> {
        self.cubic.then_some(Self { most: 0.125 * self.most, cubic: true })
    }
}
