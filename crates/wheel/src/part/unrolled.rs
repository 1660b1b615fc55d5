//! A turned surface as a plane, in which lines and four-sided patches between given borders are found.

use super::patch::PointRows;
use nalgebra::{Point3, Vector2};
use nurbs::Revolution;
use nurbs::angle::nearest_turn;

/// Parameters of the meridian that differ by less from one of its ends are that end: rounding.
const END: f64 = 1e-9;

/// A turned surface as a plane: the parameter of its meridian, and the azimuth less that of a guide line, over the width of a strip
/// about this line. Where the strip runs like a channel, straight lines between blades cross none.
pub(super) struct Unrolled<'a> {
    surface: &'a Revolution,
    strip: ChannelStrip,
}

/// Azimuth and width of a strip over the parameter of the meridian: natural cubic splines. Beyond their ends the azimuth goes straight
/// on; so does the width, which soon stays as it is: a blade is thin at its end, and it is not to be thinner than nothing before it.
pub(super) struct ChannelStrip {
    /// Parameter, azimuth, width in radians; parameters ascend.
    places: Vec<[f64; 3]>,
    /// Second derivatives of azimuth and width there.
    second_derivatives: Vec<[f64; 2]>,
}

/// Least distance of the places of a strip, as a parameter of the meridian: at nearer ones rounding would distort it.
const MIN_SPACING: f64 = 1e-5;

/// Least width of a strip, radians.
const NARROWEST: f64 = 0.05;

/// Way beyond the end of a strip after which its width stays as it is, as a parameter of the meridian.
const SETTLES: f64 = 0.1;

impl ChannelStrip {
    /// The strip through places, of which those are left out whose parameter ascends by less than [`MIN_SPACING`].
    pub(super) fn through(mut places: Vec<[f64; 3]>) -> Self {
        places.dedup_by(|next, before| next[0] < before[0] + MIN_SPACING);
        let mut second_derivatives = vec![[0.0; 2]; places.len()];
        // Elimination of the tridiagonal system of the natural spline, then back substitution.
        let mut upper = vec![0.0; places.len()];
        for k in 1..places.len().saturating_sub(1) {
            let [p, q, r] = [places[k - 1], places[k], places[k + 1]];
            let (before, after) = (q[0] - p[0], r[0] - q[0]);
            let pivot = 2.0 * (before + after) - before * upper[k - 1];
            upper[k] = after / pivot;
            second_derivatives[k] = [0, 1].map(|d| {
                let turn = 6.0 * ((r[d + 1] - q[d + 1]) / after - (q[d + 1] - p[d + 1]) / before);
                (turn - before * second_derivatives[k - 1][d]) / pivot
            });
        }
        for k in (1..places.len().saturating_sub(1)).rev() {
            second_derivatives[k] = [0, 1].map(|d| second_derivatives[k][d] - upper[k] * second_derivatives[k + 1][d]);
        }
        Self { places, second_derivatives }
    }

    /// A strip that runs nearly like this one and bends little.
    pub(super) fn smooth(&self) -> Self {
        /// Shares of the way from the first to the last place.
        const PLACE_SHARES: [f64; 9] = [0.0, 0.05, 0.12, 0.25, 0.5, 0.75, 0.88, 0.95, 1.0];
        /// The share at both ends in which the noses of the blades widen the channel.
        const NOSE: f64 = 0.05;
        let [from, to] = [0, self.places.len() - 1].map(|k| self.places[k][0]);
        let at = |share: f64| from + (to - from) * share;
        let place = |share: f64| [at(share), self.at(at(share))[0], self.at(at(share.clamp(NOSE, 1.0 - NOSE)))[1]];
        Self::through(PLACE_SHARES.map(place).to_vec())
    }

    /// Parameters of the places.
    pub(super) fn parameters(&self) -> impl Iterator<Item = f64> {
        self.places.iter().map(|place| place[0])
    }

    /// Azimuth and width.
    pub(super) fn at(&self, u: f64) -> [f64; 2] {
        let last = self.places.len() - 1;
        let k = self.places.partition_point(|place| place[0] <= u).clamp(1, last) - 1;
        let [p, q] = [self.places[k], self.places[k + 1]];
        let length = q[0] - p[0];
        let t = (u - p[0]) / length;
        let inside = t.clamp(0.0, 1.0);
        let [azimuth, width] = [0, 1].map(|d| {
            let (second, next) = (self.second_derivatives[k][d], self.second_derivatives[k + 1][d]);
            let chord = (q[d + 1] - p[d + 1]) / length;
            let cubic = |t: f64| (1.0 - t) * (second * t * (t - 2.0) - next * t * (t + 1.0)) * length * length / 6.0;
            let slope = match inside {
                0.0 => chord - length * (2.0 * second + next) / 6.0,
                _ => chord + length * (second + 2.0 * next) / 6.0,
            };
            let beyond = (t - inside) * length;
            let way = if d == 0 { beyond } else { SETTLES * libm::tanh(beyond / SETTLES) };
            p[d + 1] + chord * inside * length + cubic(inside) + slope * way
        });
        [azimuth, width.max(NARROWEST)]
    }
}

impl<'a> Unrolled<'a> {
    /// The plane with a strip.
    pub(super) fn along(surface: &'a Revolution, strip: ChannelStrip) -> Self {
        Self { surface, strip }
    }

    /// The plane with a meridian as its guide.
    pub(super) fn straight(surface: &'a Revolution) -> Self {
        Self::along(surface, ChannelStrip::through(vec![[0.0, 0.0, 1.0], [1.0, 0.0, 1.0]]))
    }

    /// Azimuth of the guide, and width of the strip.
    fn at(&self, u: f64) -> [f64; 2] {
        self.strip.at(u)
    }

    /// Place of a point in the plane: parameter of the meridian, and widths of the strip from the guide, the one within half a turn of
    /// `about`.
    pub(super) fn place(&self, p: &Point3<f64>, about: f64) -> [f64; 2] {
        let u = self.surface.closest(Vector2::new(libm::hypot(p.x, p.y), p.z)).0;
        let u = [0.0, 1.0].into_iter().find(|end| (u - end).abs() < END).unwrap_or(u);
        let [azimuth, width] = self.at(u);
        [u, nearest_turn(libm::atan2(p.y, p.x) - azimuth, about * width) / width]
    }

    /// Width of the strip at a parameter of the meridian, radians.
    pub(super) fn width(&self, u: f64) -> f64 {
        self.at(u)[1]
    }

    /// The point of a place.
    pub(super) fn point(&self, [u, widths]: [f64; 2]) -> Point3<f64> {
        let [azimuth, width] = self.at(u);
        self.surface.point(u, azimuth + widths * width)
    }

    /// Points at shares of the straight line between two points, both included; it spans about as many widths as stated.
    pub(super) fn line(&self, from: &Point3<f64>, to: &Point3<f64>, about: f64, shares: &[f64]) -> Vec<Point3<f64>> {
        let a = self.place(from, 0.0);
        let b = self.place(to, a[1] + about);
        let at = |t: &f64| match *t {
            0.0 => *from,
            1.0 => *to,
            t => self.point([0, 1].map(|d| a[d] + (b[d] - a[d]) * t)),
        };
        shares.iter().map(at).collect()
    }

    /// Points at shares of the parabola from a point to a place, with the place that its tangents at both ends meet; both ends
    /// included.
    pub(super) fn parabola(&self, from: &Point3<f64>, [middle, to]: [[f64; 2]; 2], shares: &[f64]) -> Vec<Point3<f64>> {
        let start = self.place(from, middle[1]);
        let at = |t: &f64| {
            let mix = |d: usize| start[d] * (1.0 - t) * (1.0 - t) + 2.0 * middle[d] * t * (1.0 - t) + to[d] * t * t;
            if *t == 0.0 { *from } else { self.point([0, 1].map(mix)) }
        };
        shares.iter().map(at).collect()
    }

    /// A line from a point to the place at a share of the way from the end of one line to that of another. It runs as these lines do,
    /// whose points are at the shares `places` of their ways.
    pub(super) fn line_between(
        &self,
        from: &Point3<f64>,
        lines: [&[Point3<f64>]; 2],
        share: f64,
        places: &[f64],
    ) -> Vec<Point3<f64>> {
        let start = self.place(from, 0.0);
        let [left, right] = lines.map(|line| self.places(line, start[1]));
        let between = |k: usize, d: usize| left[k][d] * (1.0 - share) + right[k][d] * share;
        let at = |(k, t): (usize, &f64)| match k {
            0 => *from,
            k => self.point([0, 1].map(|d| between(k, d) + (start[d] - between(0, d)) * (1.0 - t))),
        };
        places.iter().enumerate().map(at).collect()
    }

    /// Places of a line, the first one within half a turn of `about`, each of the others within half a turn of the one before.
    fn places(&self, line: &[Point3<f64>], mut about: f64) -> Vec<[f64; 2]> {
        let place = |p: &Point3<f64>| {
            let at = self.place(p, about);
            about = at[1];
            at
        };
        line.iter().map(place).collect()
    }

    /// Points between four borders (Coons): the first and the last row, the first and the last column. The borders stay as they
    /// are; their points are at shares of the columns and of the rows. `None` where lines between borders cross each other.
    pub(super) fn filled(
        &self,
        [first, last]: [&[Point3<f64>]; 2],
        sides: [&[Point3<f64>]; 2],
        shares: [&[f64]; 2],
    ) -> Option<PointRows> {
        let low = self.places(first, self.place(&first[0], 0.0)[1]);
        let columns = low.len() - 1;
        let left = self.places(sides[0], low[0][1]);
        let right = self.places(sides[1], low[columns][1]);
        let rows = left.len() - 1;
        let high = self.places(last, left[rows][1]);
        let at = |i: usize, j: usize| {
            let (x, y) = (shares[0][i], shares[1][j]);
            [0, 1].map(|d| {
                let between = low[i][d] * (1.0 - y) + high[i][d] * y + left[j][d] * (1.0 - x) + right[j][d] * x;
                let lowest = low[0][d] * (1.0 - x) + low[columns][d] * x;
                let highest = high[0][d] * (1.0 - x) + high[columns][d] * x;
                between - lowest * (1.0 - y) - highest * y
            })
        };
        let flat: Vec<Vec<[f64; 2]>> = (0..=rows).map(|j| (0..=columns).map(|i| at(i, j)).collect()).collect();
        let point = |(i, j): (usize, usize)| match (i, j) {
            (i, 0) => first[i],
            (i, j) if j == rows => last[i],
            (0, j) => sides[0][j],
            (i, j) if i == columns => sides[1][j],
            (i, j) => self.point(flat[j][i]),
        };
        (!folded(&flat)).then(|| (0..=rows).map(|j| (0..=columns).map(|i| point((i, j))).collect()).collect())
    }
}

/// True when cells of a grid run in different senses.
fn folded(rows: &[Vec<[f64; 2]>]) -> bool {
    let cells = rows.windows(2).flat_map(|pair| pair[0].windows(2).zip(pair[1].windows(2)));
    let sense = |(low, high): (&[[f64; 2]], &[[f64; 2]])| {
        // Twice the area, by the diagonals.
        let [p, q] = [[low[0], high[1]], [low[1], high[0]]].map(|[a, b]| [b[0] - a[0], b[1] - a[1]]);
        p[0] * q[1] - p[1] * q[0]
    };
    let (least, most) = cells.map(sense).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), s| (a.min(s), b.max(s)));
    least * most <= 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strip goes through its places, its derivatives are continuous; its azimuth goes straight on, and its width settles.
    #[test]
    fn strips_are_smooth() {
        let place = |k: u8| {
            let u = 0.1 + 0.02 * f64::from(k * k);
            [u, libm::sin(4.0 * u), 0.4 + u * u]
        };
        let strip = ChannelStrip::through((0..7).map(place).collect());
        for k in 0..7 {
            let [u, azimuth, width] = place(k);
            let at = strip.at(u);
            assert!((at[0] - azimuth).abs() < 1e-14 && (at[1] - width).abs() < 1e-14, "{k}: {at:?}");
            let h = 1e-4;
            for (d, middle) in at.into_iter().enumerate() {
                let [a, b, c, e] = [-2.0, -1.0, 1.0, 2.0].map(|j| strip.at(u + j * h)[d]);
                assert!(((e - middle) / (2.0 * h) - (middle - a) / (2.0 * h)).abs() < 0.02, "{k} {d}");
                // Second derivatives half a step to both sides.
                let [before, after] = [(a - 2.0 * b + middle) / (h * h), (middle - 2.0 * c + e) / (h * h)];
                assert!((before - after).abs() < 0.1, "{k} {d}: {before} {after}");
            }
        }
        for u in [-0.3, 1.2] {
            let [a, b, c] = [-0.1, 0.0, 0.1].map(|x| strip.at(u + x));
            assert!((a[0] + c[0] - 2.0 * b[0]).abs() < 1e-12);
            assert!((a[1] - b[1]).abs().max((c[1] - b[1]).abs()) < 1e-3);
        }
    }
}
