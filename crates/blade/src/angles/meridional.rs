//! The meridional surface of a blade: what lies between hub and shroud, and between the leading and the trailing edge.

use super::distribution::HermiteTable;
use nurbs::NurbsCurve;
use nurbs::bracket::{Bracket, around_minimum};
use nurbs::quadrature::integral;

/// Cells of the table of a meridian. On a meridian of 40 mm that turns with a radius of 10 mm a cubic over a cell is off by
/// less than 1e-10 mm.
const CELLS: usize = 512;

/// Rounds of the search for the place nearest to a point; each halves the range.
const BISECTION_ROUNDS: usize = 60;

/// A meridian (r, z) by its length from the first point, mm.
#[derive(Clone, Debug)]
pub struct MeridianByLength {
    table: HermiteTable<2>,
}

impl MeridianByLength {
    /// The meridian of a curve: its azimuth does not count. `None` for a curve without length.
    pub fn new(curve: &NurbsCurve) -> Option<Self> {
        let at = |u: f64| {
            let d = curve.derivatives(u);
            let r = libm::hypot(d.point.x, d.point.y);
            let dr = if r > 0.0 { (d.point.x * d.first.x + d.point.y * d.first.y) / r } else { d.first.x };
            ([r, d.point.z], [dr, d.first.z])
        };
        let speed = |u: f64| {
            let (_, [dr, dz]) = at(u);
            libm::hypot(dr, dz)
        };
        let u = |k: usize| k as f64 / CELLS as f64;
        let mut lengths = vec![0.0];
        for k in 0..CELLS {
            lengths.push(lengths[k] + integral(u(k), u(k + 1), &speed));
        }
        let whole = lengths[CELLS];
        if !(whole > 0.0 && whole.is_finite()) {
            return None;
        }
        let step = whole / CELLS as f64;
        let node = |k: usize| {
            let due = step * k as f64;
            let cell = lengths.partition_point(|l| *l <= due).clamp(1, CELLS) - 1;
            let (mut low, mut high) = (u(cell), u(cell + 1));
            let mut here = low + (high - low) * (due - lengths[cell]) / (lengths[cell + 1] - lengths[cell]);
            // Newton within the cell; a step out of it is replaced by its middle.
            for _ in 0..BISECTION_ROUNDS {
                let over = lengths[cell] + integral(u(cell), here, &speed) - due;
                if over > 0.0 {
                    high = here
                } else {
                    low = here
                }
                let next = here - over / speed(here);
                let next = if next > low && next < high { next } else { 0.5 * (low + high) };
                if (next - here).abs() <= f64::EPSILON {
                    break;
                }
                here = next;
            }
            if k == 0 {
                here = 0.0;
            } else if k == CELLS {
                here = 1.0;
            }
            let (point, slope) = at(here);
            let speed = libm::hypot(slope[0], slope[1]);
            (point, slope.map(|x| if speed > 0.0 { x / speed } else { 0.0 }))
        };
        Some(Self { table: HermiteTable::new(step, (0..=CELLS).map(node).collect()) })
    }

    /// Its length, mm.
    pub fn length(&self) -> f64 {
        self.table.length()
    }

    /// Point (r, z) and direction at a length; beyond the ends on their tangents.
    pub fn at(&self, length: f64) -> ([f64; 2], [f64; 2]) {
        self.table.at(length)
    }

    /// The length at the place nearest to a point (r, z), and the distance there, mm.
    pub fn nearest(&self, [r, z]: [f64; 2]) -> (f64, f64) {
        let distance = |length: f64| {
            let ([a, b], _) = self.at(length);
            libm::hypot(a - r, b - z)
        };
        let step = self.length() / CELLS as f64;
        let node = (0..=CELLS).min_by(|a, b| distance(step * *a as f64).total_cmp(&distance(step * *b as f64)));
        let middle = step * node.unwrap_or(0) as f64;
        let around = [(middle - step).max(0.0), (middle + step).min(self.length())];
        let [low, high] = around_minimum(around, BISECTION_ROUNDS, distance);
        let found = 0.5 * (low + high);
        (found, distance(found))
    }
}

/// A meridional edge between hub and shroud: a straight line, or a curve.
#[derive(Clone, Debug)]
pub struct EdgeLine {
    /// Lengths on hub and shroud at which it begins and ends, mm.
    places: [f64; 2],
    curve: Option<MeridianByLength>,
}

impl EdgeLine {
    /// The straight line between places of hub and shroud, lengths in mm.
    pub fn straight(places: [f64; 2]) -> Self {
        Self { places, curve: None }
    }

    /// A curve from hub to shroud, and how far its ends are from them, mm. Its shape holds between the places nearest to its
    /// ends.
    pub fn curved(curve: MeridianByLength, [hub, shroud]: [&MeridianByLength; 2]) -> (Self, [f64; 2]) {
        let [first, last] = [0.0, curve.length()].map(|length| curve.at(length).0);
        let [(from, off), (to, off_shroud)] = [hub.nearest(first), shroud.nearest(last)];
        (Self { places: [from, to], curve: Some(curve) }, [off, off_shroud])
    }

    /// Lengths on hub and shroud at which it begins and ends, mm.
    pub fn places(&self) -> [f64; 2] {
        self.places
    }

    /// Vector from the chord to the curve at a share of its length.
    fn off_chord(&self, share: f64) -> [f64; 2] {
        let Some(curve) = &self.curve else { return [0.0; 2] };
        let [first, last, here] = [0.0, curve.length(), curve.length() * share].map(|length| curve.at(length).0);
        [0, 1].map(|i| here[i] - (1.0 - share) * first[i] - share * last[i])
    }
}

/// The meridional surface of a blade: a Coons patch between hub, shroud and both meridional edges. Between straight edges these
/// are straight lines between equal shares of the lengths of hub and shroud.
#[derive(Clone, Debug)]
pub struct MeridionalPatch {
    ends: [MeridianByLength; 2],
    edges: [EdgeLine; 2],
}

impl MeridionalPatch {
    /// The patch between hub and shroud, and between the leading and the trailing edge.
    pub fn new(ends: [MeridianByLength; 2], edges: [EdgeLine; 2]) -> Self {
        Self { ends, edges }
    }

    /// Point (r, z) and its derivative by the share x of the way from the leading (0) to the trailing edge (1), at a share of
    /// the span from hub (0) to shroud (1).
    pub fn at(&self, x: f64, span: f64) -> ([f64; 2], [f64; 2]) {
        let mut point = [0.0; 2];
        let mut slope = [0.0; 2];
        for (k, weight) in [(0, 1.0 - span), (1, span)] {
            let [from, to] = [0, 1].map(|edge: usize| self.edges[edge].places[k]);
            let (p, d) = self.ends[k].at(from + (to - from) * x);
            for i in 0..2 {
                point[i] += weight * p[i];
                slope[i] += weight * d[i] * (to - from);
            }
        }
        let [leading, trailing] = self.edges.each_ref().map(|edge| edge.off_chord(span));
        for i in 0..2 {
            point[i] += (1.0 - x) * leading[i] + x * trailing[i];
            slope[i] += trailing[i] - leading[i];
        }
        (point, slope)
    }

    /// Shares of the way at shares of the length from the leading to the trailing edge, on the meridian of a share of the span.
    /// They are the same on hub and shroud.
    pub fn at_lengths(&self, span: f64, shares: &[f64]) -> Vec<f64> {
        const LENGTH_PIECES: usize = 128;
        let speed = |x: f64| {
            let (_, [dr, dz]) = self.at(x, span);
            libm::hypot(dr, dz)
        };
        let x = |k: usize| k as f64 / LENGTH_PIECES as f64;
        let mut lengths = vec![0.0];
        for k in 0..LENGTH_PIECES {
            lengths.push(lengths[k] + integral(x(k), x(k + 1), &speed));
        }
        let place = |share: &f64| {
            let due = share * lengths[LENGTH_PIECES];
            if *share <= 0.0 || *share >= 1.0 {
                return share.clamp(0.0, 1.0);
            }
            let piece = lengths.partition_point(|l| *l <= due).clamp(1, LENGTH_PIECES) - 1;
            let ends = Bracket { holds: x(piece + 1), fails: x(piece) };
            ends.halved(BISECTION_ROUNDS, |to| lengths[piece] + integral(x(piece), to, &speed) > due).middle()
        };
        shares.iter().map(place).collect()
    }

    /// The share of the way and the share of the span at a point (r, z) of the surface, by Newton's method from a place near to
    /// it. `None` where no place within 1e-7 mm of the point is found.
    pub fn place_of(&self, point: [f64; 2], near: [f64; 2]) -> Option<[f64; 2]> {
        const DIFFERENCE_STEP: f64 = 1e-6;
        const CLOSE: f64 = 1e-7;
        let [mut x, mut span] = near;
        for _ in 0..BISECTION_ROUNDS {
            let ([r, z], [rx, zx]) = self.at(x, span);
            let off = [point[0] - r, point[1] - z];
            if libm::hypot(off[0], off[1]) < CLOSE {
                return Some([x, span]);
            }
            let [[r_low, z_low], [r_high, z_high]] =
                [span - DIFFERENCE_STEP, span + DIFFERENCE_STEP].map(|s| self.at(x, s).0);
            let [rs, zs] = [r_high - r_low, z_high - z_low].map(|d| d / (2.0 * DIFFERENCE_STEP));
            let determinant = rx * zs - zx * rs;
            if determinant == 0.0 || !determinant.is_finite() {
                return None;
            }
            x += (off[0] * zs - off[1] * rs) / determinant;
            span += (rx * off[1] - zx * off[0]) / determinant;
            if !(-1.0..=2.0).contains(&x) || !(-1.0..=2.0).contains(&span) {
                return None;
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;
    use nurbs::interpolate;

    fn line(points: &[[f64; 2]]) -> NurbsCurve {
        let points: Vec<_> = points.iter().map(|[r, z]| Point3::new(*r, 0.0, *z)).collect();
        interpolate(&points, 3.min(points.len() - 1)).unwrap()
    }

    /// A quarter of a circle about (30, 0) with radius 20.
    fn quarter() -> NurbsCurve {
        let at = |k: u32| {
            let (s, c) = libm::sincos(f64::from(k) / 40.0 * std::f64::consts::FRAC_PI_2);
            [30.0 - 20.0 * c, -20.0 * s]
        };
        line(&(0..=40).map(at).collect::<Vec<_>>())
    }

    #[test]
    fn a_meridian_is_taken_by_its_length() {
        let meridian = MeridianByLength::new(&quarter()).unwrap();
        let arc = 20.0 * std::f64::consts::FRAC_PI_2;
        assert!((meridian.length() - arc).abs() < 1e-5);
        for k in 0..=33 {
            let share = f64::from(k) / 33.0;
            let (s, c) = libm::sincos(share * std::f64::consts::FRAC_PI_2);
            let (p, d) = meridian.at(share * meridian.length());
            assert!(libm::hypot(p[0] - 30.0 + 20.0 * c, p[1] + 20.0 * s) < 1e-5);
            assert!((libm::hypot(d[0], d[1]) - 1.0).abs() < 1e-8);
            let (found, off) = meridian.nearest([30.0 - 15.0 * c, -15.0 * s]);
            assert!((found - share * arc).abs() < 1e-4 && (off - 5.0).abs() < 1e-5);
        }
    }

    #[test]
    fn places_are_found_by_length_and_by_point() {
        let hub = MeridianByLength::new(&quarter()).unwrap();
        let shroud = MeridianByLength::new(&line(&[[20.0, 0.0], [30.0, -10.0]])).unwrap();
        let edges = [EdgeLine::straight([0.0; 2]), EdgeLine::straight([hub.length(), shroud.length()])];
        let patch = MeridionalPatch::new([hub, shroud], edges);
        let shares: Vec<f64> = (0..=10).map(|k| f64::from(k) / 10.0).collect();
        for span in [0.0, 1.0] {
            for (found, due) in patch.at_lengths(span, &shares).iter().zip(&shares) {
                assert!((found - due).abs() < 1e-9, "{found} {due}");
            }
        }
        // Lengths by chords, which are short enough for 1e-6.
        let found = patch.at_lengths(0.5, &shares);
        let length = |x: f64| {
            let at = |k: u32| patch.at(x * f64::from(k) / 20_000.0, 0.5).0;
            (0..20_000).map(|k| [at(k), at(k + 1)]).map(|[a, b]| libm::hypot(a[0] - b[0], a[1] - b[1])).sum::<f64>()
        };
        for (x, share) in found.iter().zip(&shares) {
            assert!((length(*x) / length(1.0) - share).abs() < 1e-6, "{x} {share}");
        }
        let [x, span] = patch.place_of(patch.at(0.37, 0.62).0, [0.5, 0.5]).unwrap();
        assert!((x - 0.37).abs() < 1e-7 && (span - 0.62).abs() < 1e-7);
        assert!(patch.place_of([500.0, 500.0], [0.5, 0.5]).is_none());
    }

    #[test]
    fn edges_are_the_stated_lines() {
        let hub = MeridianByLength::new(&quarter()).unwrap();
        let shroud = MeridianByLength::new(&line(&[[20.0, 0.0], [30.0, -10.0]])).unwrap();
        let curve = [[10.0, 0.0], [14.0, -3.0], [16.0, -2.0], [20.0, 0.0]];
        let edge = MeridianByLength::new(&line(&curve)).unwrap();
        let (leading, off) = EdgeLine::curved(edge.clone(), [&hub, &shroud]);
        assert!(off.iter().all(|d| *d < 1e-6));
        let trailing = EdgeLine::straight([hub.length(), shroud.length()]);
        let patch = MeridionalPatch::new([hub.clone(), shroud.clone()], [leading, trailing]);
        for k in 0..=10 {
            let share = f64::from(k) / 10.0;
            let near = |a: [f64; 2], b: [f64; 2]| assert!(libm::hypot(a[0] - b[0], a[1] - b[1]) < 1e-5, "{a:?} {b:?}");
            near(patch.at(0.0, share).0, edge.at(share * edge.length()).0);
            near(patch.at(1.0, share).0, [30.0, -20.0 + 10.0 * share]);
            near(patch.at(share, 0.0).0, hub.at(share * hub.length()).0);
            near(patch.at(share, 1.0).0, shroud.at(share * shroud.length()).0);
            let [a, b] = [share - 1e-6, share + 1e-6].map(|x| patch.at(x, 0.4).0);
            let slope = patch.at(share, 0.4).1;
            near([0, 1].map(|i| (b[i] - a[i]) / 2e-6), slope);
        }
    }
}
