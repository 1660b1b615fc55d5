//! What a tool removes in a step along its axis, as seen along the axis.
//!
//! A step across the axis has a direction of feed, and sides to both sides of it. A step along the axis has none: the cutter
//! meets material around its axis, mostly in a lune between its own circle and those of the strokes before.

use nalgebra::Vector3;
use std::f64::consts::TAU;

/// Number of sectors about the axis.
pub const SECTORS: usize = 32;

/// Thickness of a layer under the middle of a tool that is left out of [`Lune::inner`], mm. Such a layer is a ridge between
/// the floors of two strokes; the end of a tool is hollow by more.
pub const RIDGE: f64 = 0.05;

/// Material about the axis of a tool.
#[derive(Clone, Debug, PartialEq)]
pub struct Lune {
    /// Least and largest angle about the axis in each sector, radians from 0 to a whole turn; infinity and minus infinity
    /// where the sector is empty. In single precision: within 0.1 um on cutters of metres.
    angles: [[f32; 2]; SECTORS],
    /// Least distance from the axis of material that lies more than [`RIDGE`] above the tip at the end of the step, mm;
    /// infinity without any.
    inner: f64,
}

impl Lune {
    /// No material.
    pub const NONE: Self = Self { angles: [[f32::INFINITY, f32::NEG_INFINITY]; SECTORS], inner: f64::INFINITY };

    /// Least distance from the axis of the material, mm.
    pub fn inner(&self) -> f64 {
        self.inner
    }

    /// Adds all points between two points of a tool with a tip and a unit axis at the end of its step. Angles count from
    /// the unit vector `around`, which is square to the axis.
    pub(super) fn add(
        &mut self,
        ends: [Vector3<f64>; 2],
        (tip, axis): (&Vector3<f64>, &Vector3<f64>),
        around: &Vector3<f64>,
    ) {
        let across = axis.cross(around);
        let [a, b] = ends.map(|p| {
            let d = p - tip;
            [d.dot(around), d.dot(&across), d.dot(axis)]
        });
        let [from, to] = [a, b].map(|[x, y, _]| {
            let angle = libm::atan2(y, x);
            if angle < 0.0 { angle + TAU } else { angle }
        });
        // A straight segment is seen over less than half a turn.
        let (from, turn) = match to - from {
            t if t > 0.5 * TAU => (to, TAU - t),
            t if t < -0.5 * TAU => (from, TAU + t),
            t if t < 0.0 => (to, -t),
            t => (from, t),
        };
        self.fill(from, turn);
        // The part above the ridge: heights change evenly along the segment.
        let at = |t: f64| [0, 1].map(|k: usize| a[k] + (b[k] - a[k]) * t);
        let rise = b[2] - a[2];
        let (mut low, mut high) = (0.0_f64, 1.0_f64);
        if rise.abs() > f64::MIN_POSITIVE {
            let cross = ((RIDGE - a[2]) / rise).clamp(0.0, 1.0);
            if rise > 0.0 { low = cross } else { high = cross }
        } else if a[2] <= RIDGE {
            return;
        }
        if a[2].max(b[2]) <= RIDGE {
            return;
        }
        let (p, q) = (at(low), at(high));
        let along = [q[0] - p[0], q[1] - p[1]];
        let square = along[0] * along[0] + along[1] * along[1];
        let t = if square > 0.0 { (-(p[0] * along[0] + p[1] * along[1]) / square).clamp(0.0, 1.0) } else { 0.0 };
        self.inner = self.inner.min(libm::hypot(p[0] + along[0] * t, p[1] + along[1] * t));
    }

    /// Adds the angles from `from` on over `turn`.
    fn fill(&mut self, from: f64, turn: f64) {
        const WIDTH: f64 = TAU / SECTORS as f64;
        let first = ((from / WIDTH) as usize).min(SECTORS - 1);
        for k in first..=first + SECTORS {
            let (begin, end) = (k as f64 * WIDTH, (k + 1) as f64 * WIDTH);
            let whole = if k >= SECTORS { TAU } else { 0.0 };
            let part = [begin.max(from), end.min(from + turn)];
            if part[0] > part[1] {
                return;
            }
            widen(&mut self.angles[k % SECTORS], part.map(|angle| (angle - whole) as f32));
        }
    }

    /// Adds what other steps remove.
    pub fn join(&mut self, other: &Self) {
        self.angles.iter_mut().zip(&other.angles).for_each(|(own, other)| widen(own, *other));
        self.inner = self.inner.min(other.inner);
    }

    /// Smallest arc about the axis that holds all of the material, degrees: a whole turn less the largest gap. No gap
    /// inside of one sector counts.
    pub fn arc(&self) -> f64 {
        let filled: Vec<[f64; 2]> = self.angles.iter().filter(|a| a[0] <= a[1]).map(|a| a.map(f64::from)).collect();
        let (Some(first), Some(last)) = (filled.first(), filled.last()) else { return 0.0 };
        let gaps = filled.windows(2).map(|w| w[1][0] - w[0][1]);
        let widest = gaps.fold(first[0] + TAU - last[1], f64::max);
        (TAU - widest).clamp(0.0, TAU).to_degrees()
    }
}

/// Adds what other steps remove, where there is anything.
pub(super) fn join(own: &mut Option<Box<Lune>>, other: Option<&Lune>) {
    match (own.as_mut(), other) {
        (Some(own), Some(other)) => own.join(other),
        (None, Some(other)) => *own = Some(Box::new(other.clone())),
        (_, None) => {}
    }
}

fn widen(own: &mut [f32; 2], other: [f32; 2]) {
    *own = [own[0].min(other[0]), own[1].max(other[1])];
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The arc and the inner distance of segments against points on them.
    #[test]
    fn segments_count_as_their_points() {
        let (tip, axis) = (Vector3::new(1.0, 2.0, 3.0), Vector3::new(0.2, -0.3, 0.9).normalize());
        let around = axis.cross(&Vector3::x()).normalize();
        let across = axis.cross(&around);
        let place = |angle: f64, rho: f64, height: f64| {
            tip + (around * angle.cos() + across * angle.sin()) * rho + axis * height
        };
        for (ends, arc) in [
            ([(0.2, 2.0, 0.5), (1.0, 1.0, 0.1)], 0.8),
            ([(-0.3, 2.0, 0.5), (0.4, 1.8, -0.2)], 0.7),
            ([(3.0, 1.0, 0.0), (3.5, 1.0, 0.02)], 0.5),
            ([(5.0, 1.5, 1.0), (5.0, 0.5, 1.0)], 0.0),
        ] {
            let ends = ends.map(|(angle, rho, height)| place(angle, rho, height));
            let mut lune = Lune::NONE;
            lune.add(ends, (&tip, &axis), &around);
            assert!((lune.arc() - f64::to_degrees(arc)).abs() < 1e-4, "{} {arc}", lune.arc());
            let points = (0..=20_000).map(|k| ends[0] + (ends[1] - ends[0]) * (f64::from(k) / 20_000.0) - tip);
            let high = points.filter(|d| d.dot(&axis) > RIDGE);
            let inner = high.map(|d| (d - axis * d.dot(&axis)).norm()).fold(f64::INFINITY, f64::min);
            assert!(inner == lune.inner() || (inner - lune.inner()).abs() < 1e-3, "{inner} {}", lune.inner());
        }
        // Two pieces: the largest gap is left out.
        let mut lune = Lune::NONE;
        for angle in [0.5, 2.0, 6.0] {
            lune.add([place(angle, 1.0, 1.0), place(angle, 1.2, 1.0)], (&tip, &axis), &around);
        }
        assert!((lune.arc() - (TAU - 4.0_f64).to_degrees()).abs() < 1e-3, "{}", lune.arc());
    }
}
