//! Deviation of the swept tool from points of a design surface, with its gradient.
//!
//! g(p) = min over t of the signed distance of p to the cutter at t: negative is gouge, positive is excess. By the
//! envelope theorem its change with the control points is that of the distance at the best t alone.

use super::target::{LEVER, Of, Target};
use crate::collide::cutter::Slope;
use crate::collide::{Cutter, Section};
use crate::geom::{AxisAt, DualCurve, Pieces};
use nalgebra::Vector3;
use rayon::prelude::*;

/// The tool on its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mounted<'a> {
    /// The cutter.
    pub cutter: Cutter,
    /// Height of the lower curve over the tip of the tool.
    pub height: f64,
    /// Shank and holder, with the clearance that each section keeps, mm. None where no target is about them.
    pub body: &'a [(Section, f64)],
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

/// Distance to the cutter or to the body with one axis.
fn distance(tool: &Mounted<'_>, at: &AxisAt, target: &Target) -> f64 {
    let d = target.point - at.lower;
    let s = d.dot(&at.axis);
    let rho = (d - at.axis * s).norm_squared().sqrt();
    match target.of {
        Of::Body => body_slope(tool, rho, s + tool.height).value,
        _ => tool.cutter.distance(rho, s + tool.height),
    }
}

/// What the body has to spare at a point, with the gradient.
fn body_slope(tool: &Mounted<'_>, rho: f64, s: f64) -> Slope {
    let none = Slope { value: f64::INFINITY, rho: 1.0, s: 0.0 };
    tool.body.iter().fold(none, |least, (section, clearance)| {
        let slope = section.slope(rho, s);
        let value = slope.value - clearance;
        if value < least.value { Slope { value, ..slope } } else { least }
    })
}

/// How much further the axis could lean, see [`Of::Lean`].
fn leaning(at: &AxisAt, t: f64, most: f64) -> Deviation {
    let radial = libm::hypot(at.axis.x, at.axis.y);
    // Where the axis is Z it may lean any way.
    let out = if radial > 0.0 { Vector3::new(at.axis.x, at.axis.y, 0.0) / radial } else { Vector3::x() };
    let upper = (Vector3::z() * radial - out * at.axis.z) * (LEVER / at.length);
    Deviation { value: LEVER * (most - libm::atan2(radial, at.axis.z)), t, lower: -upper, upper }
}

/// Distance and how it changes with both points of the axis.
fn sensitive(tool: &Mounted<'_>, at: &AxisAt, t: f64, target: &Target) -> Deviation {
    let d = target.point - at.lower;
    let s = d.dot(&at.axis);
    let across = d - at.axis * s;
    let rho = across.norm_squared().sqrt();
    let out = if rho > 0.0 { across / rho } else { Vector3::zeros() };
    let slope = match target.of {
        Of::Body => body_slope(tool, rho, s + tool.height),
        _ => tool.cutter.slope(rho, s + tool.height),
    };
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
    tool: &Mounted<'_>,
    targets: &[Target],
    before: Option<&[Deviation]>,
) -> Vec<Deviation> {
    let count = (curve.control_count() - 3) * STATIONS_PER_SPAN;
    let pieces = curve.pieces();
    let stations: Vec<AxisAt> = match before {
        None => (0..=count).map(|i| pieces.at(i as f64 / count as f64)).collect(),
        Some(_) => Vec::new(),
    };
    let search = |(i, target): (usize, &Target)| match (target.of, before) {
        (Of::Lean { t, most }, _) => leaning(&pieces.at(t), t, most),
        (_, None) => nearest(&pieces, tool, &stations, target),
        (_, Some(before)) => downhill(&pieces, tool, before[i].t, 0.5 / count as f64, target),
    };
    targets.par_iter().enumerate().with_min_len(64).map(search).collect()
}

fn nearest(pieces: &Pieces, tool: &Mounted<'_>, stations: &[AxisAt], target: &Target) -> Deviation {
    let mut best = (0, f64::INFINITY);
    for (i, at) in stations.iter().enumerate() {
        let value = distance(tool, at, target);
        if value < best.1 {
            best = (i, value);
        }
    }
    let count = (stations.len() - 1) as f64;
    let at = |i: usize| rate(pieces, tool, i as f64 / count, target);
    between(pieces, tool, target, at(best.0.saturating_sub(1)), at((best.0 + 1).min(stations.len() - 1)))
}

/// The lowest place downhill from a parameter: in steps that double, then between the last two.
fn downhill(pieces: &Pieces, tool: &Mounted<'_>, from: f64, step: f64, target: &Target) -> Deviation {
    let mut here = rate(pieces, tool, from, target);
    let away = if here.1 < 0.0 { 1.0 } else { -1.0 };
    let mut step = step;
    loop {
        let there = rate(pieces, tool, (here.0.t + away * step).clamp(0.0, 1.0), target);
        let turned = there.1 * away >= 0.0;
        if turned || there.0.t <= 0.0 || there.0.t >= 1.0 {
            return if away > 0.0 {
                between(pieces, tool, target, here, there)
            } else {
                between(pieces, tool, target, there, here)
            };
        }
        (here, step) = (there, 2.0 * step);
    }
}

/// The distance at a parameter and how fast it grows.
fn rate(pieces: &Pieces, tool: &Mounted<'_>, t: f64, target: &Target) -> (Deviation, f64) {
    let (at, [lower, upper]) = pieces.moving(t);
    let found = sensitive(tool, &at, t, target);
    (found, found.lower.dot(&lower) + found.upper.dot(&upper))
}

/// Least distance between two parameters, where the rate of the distance changes its sign, or at the better end.
fn between(
    pieces: &Pieces,
    tool: &Mounted<'_>,
    target: &Target,
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
        let (at, f) = rate(pieces, tool, t, target);
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
