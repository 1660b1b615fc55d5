//! Deviation of the swept tool from points of a design surface, with its gradient.
//!
//! g(p) = min over t of the signed distance of p to the cutter at t: negative is gouge, positive is excess. By the
//! envelope theorem its change with the control points is that of the distance at the best t alone.

use super::target::Target;
use crate::collide::Cutter;
use crate::geom::{AxisAt, DualCurve, Pieces};
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

/// The cutter on its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mounted {
    /// The cutter.
    pub cutter: Cutter,
    /// Height of the lower curve over the tip of the tool.
    pub height: f64,
}

/// Deviation of one point and what changes it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// Signed distance to the swept cutter.
    pub value: f64,
    /// Parameter at which the cutter comes nearest.
    pub t: f64,
    /// Change with the point of the lower curve at t.
    pub lower: Vector3<f64>,
    /// Change with the point of the upper curve at t.
    pub upper: Vector3<f64>,
}

/// Distance to the cutter with one axis.
fn distance(tool: &Mounted, at: &AxisAt, p: &Point3<f64>) -> f64 {
    let d = p - at.lower;
    let s = d.dot(&at.axis);
    let rho = (d - at.axis * s).norm_squared().sqrt();
    tool.cutter.distance(rho, s + tool.height)
}

/// Distance and how it changes with both points of the axis.
fn sensitive(tool: &Mounted, at: &AxisAt, t: f64, p: &Point3<f64>) -> Deviation {
    let d = p - at.lower;
    let s = d.dot(&at.axis);
    let across = d - at.axis * s;
    let rho = across.norm_squared().sqrt();
    let out = if rho > 0.0 { across / rho } else { Vector3::zeros() };
    let slope = tool.cutter.slope(rho, s + tool.height);
    // Turning the axis moves the point across it and along it.
    let turn = (slope.s * rho - slope.rho * s) / at.length;
    let upper = out * turn;
    Deviation { value: slope.value, t, lower: -(out * slope.rho + at.axis * slope.s) - upper, upper }
}

/// Stations at which the best parameter is looked for first, each span of the knots.
const STATIONS_PER_SPAN: usize = 12;

/// Deviations of points. With those of a curve that ran nearly the same, the best parameters are looked for from theirs
/// on, downhill.
pub fn deviations(
    curve: &DualCurve,
    tool: &Mounted,
    targets: &[Target],
    before: Option<&[Deviation]>,
) -> Vec<Deviation> {
    let count = (curve.control_count() - 3) * STATIONS_PER_SPAN;
    let pieces = curve.pieces();
    let stations: Vec<AxisAt> = match before {
        None => (0..=count).map(|i| pieces.at(i as f64 / count as f64)).collect(),
        Some(_) => Vec::new(),
    };
    let search = |(i, target): (usize, &Target)| match before {
        None => nearest(&pieces, tool, &stations, &target.point),
        Some(before) => downhill(&pieces, tool, before[i].t, 0.5 / count as f64, &target.point),
    };
    targets.par_iter().enumerate().with_min_len(64).map(search).collect()
}

fn nearest(pieces: &Pieces, tool: &Mounted, stations: &[AxisAt], p: &Point3<f64>) -> Deviation {
    let mut best = (0, f64::INFINITY);
    for (i, at) in stations.iter().enumerate() {
        let value = distance(tool, at, p);
        if value < best.1 {
            best = (i, value);
        }
    }
    let count = (stations.len() - 1) as f64;
    let at = |i: usize| rate(pieces, tool, i as f64 / count, p);
    between(pieces, tool, p, at(best.0.saturating_sub(1)), at((best.0 + 1).min(stations.len() - 1)))
}

/// The lowest place downhill from a parameter: in steps that double, then between the last two.
fn downhill(pieces: &Pieces, tool: &Mounted, from: f64, step: f64, p: &Point3<f64>) -> Deviation {
    let mut here = rate(pieces, tool, from, p);
    let away = if here.1 < 0.0 { 1.0 } else { -1.0 };
    let mut step = step;
    loop {
        let there = rate(pieces, tool, (here.0.t + away * step).clamp(0.0, 1.0), p);
        let turned = there.1 * away >= 0.0;
        if turned || there.0.t <= 0.0 || there.0.t >= 1.0 {
            return if away > 0.0 {
                between(pieces, tool, p, here, there)
            } else {
                between(pieces, tool, p, there, here)
            };
        }
        (here, step) = (there, 2.0 * step);
    }
}

/// The distance at a parameter and how fast it grows.
fn rate(pieces: &Pieces, tool: &Mounted, t: f64, p: &Point3<f64>) -> (Deviation, f64) {
    let (at, [lower, upper]) = pieces.moving(t);
    let found = sensitive(tool, &at, t, p);
    (found, found.lower.dot(&lower) + found.upper.dot(&upper))
}

/// Least distance between two parameters, where the rate of the distance changes its sign, or at the better end.
fn between(
    pieces: &Pieces,
    tool: &Mounted,
    p: &Point3<f64>,
    (a, mut fa): (Deviation, f64),
    (b, mut fb): (Deviation, f64),
) -> Deviation {
    /// Halvings at most; secants need some six.
    const STEPS: usize = 40;
    if fa >= 0.0 || fb <= 0.0 {
        return if a.value < b.value { a } else { b };
    }
    let (mut low, mut high) = (a.t, b.t);
    let width = high - low;
    let mut found = a;
    let mut stays = 0;
    for _ in 0..STEPS {
        let t = (high - fb * (high - low) / (fb - fa)).clamp(low, high);
        let (at, f) = rate(pieces, tool, t, p);
        found = at;
        // The value changes with the square of what is left: here by less than a picometre.
        if high - low < 1e-6 * width || f.abs() * width < 1e-9 {
            break;
        }
        if f < 0.0 {
            (low, fa) = (t, f);
            fb *= if stays < 0 { 0.5 } else { 1.0 };
            stays = -1;
        } else {
            (high, fb) = (t, f);
            fa *= if stays > 0 { 0.5 } else { 1.0 };
            stays = 1;
        }
    }
    found
}
