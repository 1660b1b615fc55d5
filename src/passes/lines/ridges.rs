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
        let near: Vec<&[CutterPose]> = poses.iter().filter_map(|line| around(line, *x)).collect();
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

/// Height that poses leave at a point: the least distance of each line, with a parabola between its poses.
fn left_at(cutter: &Cutter, lines: &[&[CutterPose]], p: &Point3<f64>) -> f64 {
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
    let mut nearest: Vec<(f64, usize, usize)> = lines
        .iter()
        .enumerate()
        .filter_map(|(i, line)| {
            let far = |k: usize| (line[k].contact - p).norm_squared();
            let k = (0..line.len()).min_by(|a, b| far(*a).total_cmp(&far(*b)))?;
            Some((far(k), i, k))
        })
        .collect();
    nearest.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut least = f64::INFINITY;
    for (_, i, start) in nearest.into_iter().take(3) {
        let line = lines[i];
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
