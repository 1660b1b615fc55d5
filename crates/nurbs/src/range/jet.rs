//! A function of one parameter with its derivatives up to the third, as intervals over a range of the parameter.

use super::Interval;
use std::array::from_fn;
use std::ops::{Add, Mul, Sub};

/// Derivatives of order 0 to 3 of a function of one parameter. Each interval contains the values over the whole range. At a
/// place where a derivative jumps, it contains the values on both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet {
    /// By order.
    pub orders: [Interval; 4],
    /// Order of the highest derivative that has no jumps, at most 2: 0 for the function itself, -1 where it jumps.
    pub smooth: i32,
}

impl Jet {
    /// A function of which nothing is known.
    pub const UNKNOWN: Self = Self { orders: [Interval::ALL; 4], smooth: -1 };

    /// A constant, somewhere in an interval.
    pub fn constant(value: Interval) -> Self {
        Self { orders: [value, Interval::ZERO, Interval::ZERO, Interval::ZERO], smooth: 2 }
    }

    /// The parameter itself.
    pub fn parameter(range: [f64; 2]) -> Self {
        Self { orders: [Interval::new(range), Interval::of(1.0), Interval::ZERO, Interval::ZERO], smooth: 2 }
    }

    /// The parameter where it varies, otherwise a constant somewhere in its range.
    pub fn varying(range: [f64; 2], varies: bool) -> Self {
        if varies { Self::parameter(range) } else { Self::constant(Interval::new(range)) }
    }

    /// The jet of g(f), of the derivatives of g over the values of f.
    #[must_use]
    pub fn then(&self, g: [Interval; 4]) -> Self {
        let [_, a, b, c] = self.orders;
        Self {
            orders: [
                g[0],
                g[1] * a,
                g[2] * a.squared() + g[1] * b,
                g[3] * (a.squared() * a) + g[2] * (a * b) * 3.0 + g[1] * c,
            ],
            smooth: self.smooth,
        }
    }

    /// The inverse; unknown where zero belongs to the values.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let q = self.orders[0].inverse();
        let square = q.squared();
        self.then([q, -square, square * q * 2.0, square.squared() * -6.0])
    }

    /// The square root; its derivatives are unknown where zero belongs to the values.
    #[must_use]
    pub fn sqrt(&self) -> Self {
        let root = self.orders[0].sqrt();
        let q = root.inverse();
        let cube = q.squared() * q;
        self.then([root, q * 0.5, cube * -0.25, cube * q.squared() * 0.375])
    }

    /// Sine and cosine.
    pub fn sin_cos(&self) -> [Self; 2] {
        let [sin, cos] = self.orders[0].sin_cos();
        [self.then([sin, cos, -sin, -cos]), self.then([cos, -sin, -cos, sin])]
    }

    /// The angle in [0, pi] with this cosine; unknown derivatives where the values reach 1 or -1.
    #[must_use]
    pub fn acos(&self) -> Self {
        let x = self.orders[0];
        let angle = Interval::hull([x.low, x.high].map(|x| libm::acos(x.clamp(-1.0, 1.0))));
        // The sine of the angle.
        let q = (Interval::of(1.0) - x.squared()).sqrt().inverse();
        let cube = q.squared() * q;
        let third = (Interval::of(1.0) + x.squared() * 2.0) * cube * q.squared();
        self.then([angle, -q, -(x * cube), -third])
    }

    /// The function, if its values are coordinates of unit vectors.
    fn unit(mut self) -> Self {
        self.orders[0] = self.orders[0].unit();
        self
    }

    /// The point at a share, which varies too, between this function and another.
    #[must_use]
    pub fn towards(self, other: Self, share: Self) -> Self {
        self + (other - self) * share
    }
}

/// Sum of products of the coordinates.
pub(super) fn dot(a: &[Jet; 3], b: &[Jet; 3]) -> Jet {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Vector product.
pub(super) fn cross(a: &[Jet; 3], b: &[Jet; 3]) -> [Jet; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The unit vector; its derivatives are unknown where the vector may be zero.
pub(super) fn unit(a: &[Jet; 3]) -> [Jet; 3] {
    let length = from_fn::<_, 3, _>(|k| a[k].orders[0].squared()).into_iter().fold(Interval::ZERO, Add::add);
    let mut square = dot(a, a);
    // The sum of squares is narrower than that of products.
    square.orders[0] = length;
    let q = square.sqrt().inverse();
    a.map(|x| (x * q).unit())
}

/// The direction at a share of the great arc from one direction to another, neither a unit vector, as [`great_arc`] of their unit
/// vectors. Its derivatives are unknown where the directions may be the same or opposite.
///
/// [`great_arc`]: crate::angle::great_arc
pub fn great_arc(from: &[Jet; 3], to: &[Jet; 3], share: Jet) -> [Jet; 3] {
    let (from, to) = (unit(from), unit(to));
    let angle = dot(&from, &to).acos();
    let part = angle * share;
    let [sine, rest, part] = [angle, angle - part, part].map(|angle| angle.sin_cos()[0]);
    let q = sine.inverse();
    from_fn(|k| ((from[k] * rest + to[k] * part) * q).unit())
}

/// The point with this radius, height and azimuth.
pub fn turned([r, z]: [Jet; 2], azimuth: Jet) -> [Jet; 3] {
    let [sin, cos] = azimuth.sin_cos();
    [r * cos, r * sin, z]
}

impl Add for Jet {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { orders: from_fn(|k| self.orders[k] + other.orders[k]), smooth: self.smooth.min(other.smooth) }
    }
}

impl Sub for Jet {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { orders: from_fn(|k| self.orders[k] - other.orders[k]), smooth: self.smooth.min(other.smooth) }
    }
}

impl Mul for Jet {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let (a, b) = (&self.orders, &other.orders);
        Self {
            orders: [
                a[0] * b[0],
                a[1] * b[0] + a[0] * b[1],
                a[2] * b[0] + a[1] * b[1] * 2.0 + a[0] * b[2],
                a[3] * b[0] + (a[2] * b[1] + a[1] * b[2]) * 3.0 + a[0] * b[3],
            ],
            smooth: self.smooth.min(other.smooth),
        }
    }
}

impl Mul<f64> for Jet {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self { orders: self.orders.map(|o| o * factor), smooth: self.smooth }
    }
}
