//! Ridges between lines, measured with the cutter itself.

use super::SurfaceLine;
use crate::collide::Cutter;
use crate::collide::tool::tool_coordinates;
use crate::ir::CcPoint;
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

/// Columns over a surface in which ridges are measured.
const COLUMNS: usize = 40;

/// Samples between two lines.
const RIDGES: usize = 8;

/// Range of x about a place that contains the nearest positions of the cutter.
const WINDOW: f64 = 0.06;

/// A contact with its x on the surface, and the tool there.
pub(crate) struct CutterPose {
    x: f64,
    contact: Point3<f64>,
    tip: Point3<f64>,
    axis: Vector3<f64>,
}

impl CutterPose {
    /// The cutter with an axis on a contact at x. `None` for a flat end.
    pub(crate) fn at(cutter: &Cutter, (x, p): (f64, &CcPoint), axis: Vector3<f64>) -> Option<Self> {
        let tip = cutter.tip_at(&p.position, &p.normal, &axis)?;
        Some(Self { x, contact: p.position, tip, axis })
    }
}

/// The highest ridge that lines leave, mm: in columns of x the greatest height between both walls. `poses` gives the tool
/// along a line, `walls` y of the first wall and the difference to the second one, `place` the point of the surface at (x, y).
pub(crate) fn highest_ridge(
    cutter: &Cutter,
    lines: &[SurfaceLine],
    poses: impl Fn(&SurfaceLine) -> Vec<CutterPose>,
    walls: impl Fn(f64) -> (f64, f64) + Sync,
    place: impl Fn(f64, f64) -> Point3<f64> + Sync,
) -> Option<f64> {
    let poses: Vec<Vec<CutterPose>> = lines.iter().map(poses).collect();
    let rows = RIDGES * lines.len().max(2);
    let columns: Vec<f64> = (0..=COLUMNS).map(|i| i as f64 / COLUMNS as f64).collect();
    let highest = |x: &f64| {
        let (low, height) = walls(*x);
        // Neighbours of a row: the lines around it, and the next lines where lines begin.
        let near: Vec<NearLine<'_>> = poses.iter().filter_map(|line| around(line, *x)).map(NearLine::new).collect();
        let left = |row: f64| left_at(cutter, &near, &place(*x, low + height * row / rows as f64));
        let values: Vec<f64> = (0..=rows).map(|j| left(j as f64)).collect();
        // A ridge is a local maximum between two rows.
        let tops = values.windows(3).enumerate().filter(|(_, v)| v[1] > v[0] && v[1] >= v[2]);
        tops.map(|(j, _)| top(&left, j as f64, j as f64 + 2.0)).fold(0.0, f64::max)
    };
    columns.par_iter().map(highest).collect::<Vec<f64>>().into_iter().reduce(f64::max)
}

/// Greatest value of a function that has one maximum between two places.
fn top(f: &dyn Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    /// Number of times that a third of the interval is removed: a thousandth remains.
    const THIRDS: usize = 16;
    let mut best = 0.0_f64;
    for _ in 0..THIRDS {
        let third = (high - low) / 3.0;
        let (a, b) = (f(low + third), f(high - third));
        best = best.max(a).max(b);
        if a < b { low += third } else { high -= third }
    }
    best
}

/// Poses of a line near a place.
fn around(line: &[CutterPose], x: f64) -> Option<&[CutterPose]> {
    let from = line.partition_point(|p| p.x < x - WINDOW);
    let to = line.partition_point(|p| p.x <= x + WINDOW);
    (from < to).then(|| &line[from..to])
}

/// The poses of a line about a place, of which every [`STRIDE`]-th is looked at first.
struct NearLine<'a> {
    poses: &'a [CutterPose],
    /// Largest distance of a contact from the nearer one of those before and behind it that are looked at first, mm.
    between: f64,
}

/// Poses from one that is looked at first to the next.
const STRIDE: usize = 8;

/// Rounding of distances, mm.
const ROUNDING: f64 = 1e-9;

impl<'a> NearLine<'a> {
    fn new(poses: &'a [CutterPose]) -> Self {
        let far = |i: usize, k: usize| (poses[i].contact - poses[k].contact).norm();
        let last = poses.len() - 1;
        let nearer = |k: usize| {
            let before = k - k % STRIDE;
            far(k, before).min(far(k, (before + STRIDE).min(last)))
        };
        Self { poses, between: (0..=last).map(nearer).fold(0.0, f64::max) }
    }

    /// The poses that are looked at first.
    fn first(&self) -> impl Iterator<Item = usize> + use<> {
        let last = self.poses.len() - 1;
        (0..last).step_by(STRIDE).chain([last])
    }
}

/// For the three lines with the nearest contacts to a point, the nearest first: square of the distance, line and pose.
fn nearest_contacts(lines: &[NearLine<'_>], p: &Point3<f64>) -> Vec<(f64, usize, usize)> {
    let far = |line: &NearLine<'_>, k: usize| (line.poses[k].contact - p).norm_squared();
    let first: Vec<f64> =
        lines.iter().map(|line| line.first().map(|k| far(line, k)).fold(f64::INFINITY, f64::min).sqrt()).collect();
    // The three nearest lines are not farther than this.
    let mut three = [f64::INFINITY; 3];
    for distance in &first {
        if *distance < three[2] {
            three[2] = *distance;
            three.sort_by(f64::total_cmp);
        }
    }
    let mut nearest: Vec<(f64, usize, usize)> = lines
        .iter()
        .zip(&first)
        .enumerate()
        .filter(|(_, (line, distance))| **distance - line.between <= three[2] + ROUNDING)
        .filter_map(|(i, (line, _))| {
            let k = (0..line.poses.len()).min_by(|a, b| far(line, *a).total_cmp(&far(line, *b)))?;
            Some((far(line, k), i, k))
        })
        .collect();
    nearest.sort_by(|a, b| a.0.total_cmp(&b.0));
    nearest.truncate(3);
    nearest
}

/// Height that poses leave at a point: the least distance of each line, with a parabola between its poses.
fn left_at(cutter: &Cutter, lines: &[NearLine<'_>], p: &Point3<f64>) -> f64 {
    // For a ball only the sphere: the distance of its side depends on the axis that is chosen later.
    let ball = cutter.ends_in_ball().then(|| cutter.tip_radius());
    let gap = |pose: &CutterPose| match ball {
        Some(radius) => (p - (pose.tip + pose.axis * radius)).norm() - radius,
        None => {
            let (rho, s) = tool_coordinates(p, &pose.tip, &pose.axis);
            cutter.distance(rho, s)
        }
    };
    // The nearest contacts leave least, apart from effects of the cutter's shape: use the three nearest lines.
    let mut least = f64::INFINITY;
    for (_, i, start) in nearest_contacts(lines, p) {
        let line = lines[i].poses;
        // Descend from the nearest contact.
        let (mut k, mut value) = (start, gap(&line[start]));
        loop {
            let next = [k.checked_sub(1), Some(k + 1).filter(|n| *n < line.len())]
                .into_iter()
                .flatten()
                .map(|n| (n, gap(&line[n])))
                .min_by(|a, b| a.1.total_cmp(&b.1));
            match next {
                Some((n, g)) if g < value => (k, value) = (n, g),
                _ => break,
            }
        }
        if k > 0 && k + 1 < line.len() {
            let (before, after) = (gap(&line[k - 1]) - value, gap(&line[k + 1]) - value);
            let arc_radius = before + after;
            if arc_radius > 0.0 {
                value -= (after - before).powi(2) / (8.0 * arc_radius);
            }
        }
        least = least.min(value);
    }
    least
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same lines and poses as by a look at every pose.
    #[test]
    fn nearest_contacts_are_those_of_a_full_search() {
        let line = |j: usize| -> Vec<CutterPose> {
            let count = 3 + (j * 7) % 90;
            let at = |k: usize| {
                let x = k as f64 / count as f64;
                let contact =
                    Point3::new(20.0 * x, 0.4 * j as f64 + libm::sin(9.0 * x), libm::cos(3.0 * x + 0.1 * j as f64));
                CutterPose { x, contact, tip: contact, axis: Vector3::z() }
            };
            (0..count).map(at).collect()
        };
        let poses: Vec<Vec<CutterPose>> = (0..60).map(line).collect();
        let lines: Vec<NearLine<'_>> = poses.iter().map(|line| NearLine::new(line)).collect();
        for n in 0..2000 {
            let p = Point3::new((n % 50) as f64 * 0.41, (n / 50) as f64 * 0.61, libm::sin(n as f64));
            let mut all: Vec<(f64, usize, usize)> = poses
                .iter()
                .enumerate()
                .map(|(i, line)| {
                    let far = |k: usize| (line[k].contact - p).norm_squared();
                    let k = (0..line.len()).min_by(|a, b| far(*a).total_cmp(&far(*b))).unwrap();
                    (far(k), i, k)
                })
                .collect();
            all.sort_by(|a, b| a.0.total_cmp(&b.0));
            assert_eq!(nearest_contacts(&lines, &p), all[..3]);
        }
    }
}
