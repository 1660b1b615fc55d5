//! The path that a control follows through stations: straight between them, with every corner rounded.

use super::{AXES, Axes, Rounding, Station};

/// Knots closer than this share of a segment count as one knot.
const SAME_KNOT: f64 = 1e-9;

/// The rounded path. Its parameter s is the length of the joint polygon, with each axis weighted by its acceleration
/// limit.
///
/// At a corner the derivative jumps by D. A triangle of the second derivative spreads the jump over a length l before
/// and r behind the corner, with the value 2 D/(l + r) at the corner, so that first and second derivative are
/// continuous. Where the tolerance allows it, l and r are the whole lengths of both segments. The second derivative is
/// then linear between stations, as for the cubic B-spline of equally spaced stations. Elsewhere l = r, and the path
/// deviates from the corner by |D| l/6. Where segments differ in length, the integrated path deviates from the polygon
/// by up to |D| (r - l)/3. This is less than the deviation of the chords from the curve that they represent; only the
/// derivatives of the path are used.
pub(super) struct SpeedPath {
    /// Parameter of every station.
    pub(super) at: Vec<f64>,
    /// Derivative of the joints on the segment that ends at a station; the first is unused.
    slope: Vec<Axes>,
    /// Lengths before and behind a station over which its corner is rounded; zero at both ends of the path.
    sides: Vec<[f64; 2]>,
    /// Largest rate of the parameter on the segment that ends at a station, from the time of the segment.
    pub(super) rate: Vec<f64>,
}

/// Derivatives of the joints over a span of the path, in which the joints are polynomials.
#[derive(Clone, Copy, Debug)]
pub(super) struct PathSpan {
    /// Length of the parameter.
    pub(super) width: f64,
    /// Bernstein coefficients of the first derivative, which is quadratic.
    pub(super) rate: [Axes; 3],
    /// Second derivative at both ends; linear between them.
    second: [Axes; 2],
    /// Third derivative.
    twist: Axes,
}

impl PathSpan {
    /// Second derivative at both ends.
    pub(super) fn second(&self, k: usize) -> [f64; 2] {
        [self.second[0][k], self.second[1][k]]
    }

    /// Third derivative.
    pub(super) fn twist(&self, k: usize) -> f64 {
        self.twist[k]
    }

    /// Largest first derivative.
    pub(super) fn most_rate(&self, k: usize) -> f64 {
        self.rate.iter().fold(0.0, |most, r| r[k].abs().max(most))
    }
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

impl SpeedPath {
    /// The path through stations that differ from their predecessors; `weight` divides each axis in the length.
    pub(super) fn new(stations: &[Station], weight: &Axes, rounding: &Rounding) -> Self {
        let n = stations.len();
        let mut path =
            Self { at: vec![0.0; n], slope: vec![[0.0; AXES]; n], sides: vec![[0.0; 2]; n], rate: vec![0.0; n] };
        let mut tips = vec![[0.0; 3]; n];
        for i in 1..n {
            let (a, b) = (&stations[i - 1], &stations[i]);
            let length = (0..AXES).map(|k| ((b.joints[k] - a.joints[k]) / weight[k]).powi(2)).sum::<f64>().sqrt();
            path.at[i] = path.at[i - 1] + length;
            path.slope[i] = std::array::from_fn(|k| (b.joints[k] - a.joints[k]) / length);
            tips[i] = std::array::from_fn(|k| (b.tip[k] - a.tip[k]) / length);
            path.rate[i] = length / b.time;
        }
        for i in 1..n.saturating_sub(1) {
            let turn = |k: usize| path.slope[i + 1][k] - path.slope[i][k];
            let away = distance(&tips[i], &tips[i + 1]) + rounding.height * libm::hypot(turn(3), turn(4));
            let lengths = [path.at[i] - path.at[i - 1], path.at[i + 1] - path.at[i]];
            let allowed = 6.0 * rounding.tolerance / away;
            let [short, long] = [lengths[0].min(lengths[1]), lengths[0].max(lengths[1])];
            path.sides[i] = if allowed >= long { lengths } else { [allowed.min(short); 2] };
        }
        // At a corner, half of the derivative of the neighbour enters a segment: the tip keeps its feed there too.
        let speed = |tip: &[f64; 3]| distance(tip, &[0.0; 3]);
        let own: Vec<f64> = path.rate.clone();
        for i in 1..n {
            let neighbours = [i - 1, i + 1].into_iter().filter(|k| *k > 0 && *k < n).map(|k| speed(&tips[k]));
            let (mine, most) = (speed(&tips[i]), neighbours.fold(0.0, f64::max));
            if most > mine && mine > 0.0 {
                path.rate[i] = own[i] * mine / (0.5 * (mine + most));
            }
        }
        path
    }

    /// Places between which the derivatives are polynomials, each with the segment that ends there; the first place is
    /// the start.
    pub(super) fn knots(&self) -> Vec<(f64, u32)> {
        let mut knots = Vec::with_capacity(2 * self.at.len());
        knots.push((0.0, 1));
        for i in 1..self.at.len() {
            let (from, to) = (self.at[i - 1], self.at[i]);
            let segment = u32::try_from(i).unwrap_or(u32::MAX);
            let (a, b) = (from + self.sides[i - 1][1], to - self.sides[i][0]);
            let same = SAME_KNOT * (to - from);
            for place in [a.min(b), a.max(b), to] {
                let last = knots.last().map_or(0.0, |k| k.0);
                if place - last > same && (place == to || to - place > same) {
                    knots.push((place, segment));
                }
            }
        }
        knots
    }

    /// First, second and third derivative at a place of a segment; the third is that on the side of `inside`.
    fn derivatives(&self, segment: usize, s: f64, inside: f64) -> [Axes; 3] {
        let mut found = [self.slope[segment], [0.0; AXES], [0.0; AXES]];
        // The corner behind reduces the derivative, the corner ahead adds to it.
        let corners = [(segment - 1, 1, self.at[segment - 1], -1.0), (segment, 0, self.at[segment], 1.0)];
        for (corner, side, at, sign) in corners {
            let [before, behind] = self.sides[corner];
            let (length, away) = (self.sides[corner][side], (s - at).abs());
            let peak = 2.0 / (before + behind);
            // At the end of the triangle the place `inside` decides.
            let within = (inside - at).abs() < length;
            if within {
                let rest = (1.0 - away / length).max(0.0);
                let factors = [sign * 0.5 * peak * length * rest * rest, peak * rest, sign * peak / length];
                for (found, factor) in found.iter_mut().zip(factors) {
                    for (k, found) in found.iter_mut().enumerate() {
                        *found += factor * (self.slope[corner + 1][k] - self.slope[corner][k]);
                    }
                }
            }
        }
        found
    }

    /// The span between two places of one segment, without a knot between them.
    pub(super) fn span(&self, segment: u32, from: f64, to: f64) -> PathSpan {
        let (width, inside) = (to - from, 0.5 * (from + to));
        let [start, second, twist] = self.derivatives(segment as usize, from, inside);
        let [end, last, _] = self.derivatives(segment as usize, to, inside);
        let middle = std::array::from_fn(|k| start[k] + 0.5 * width * second[k]);
        PathSpan { width, rate: [start, middle, end], second: [second, last], twist }
    }
}
