//! Deviation of the swept tool from points of a design surface, with its gradient.
//!
//! g(p) = min over t of the signed distance of p to the cutter at t: negative is gouge, positive is excess. By the
//! envelope theorem, its derivative by the control points is that of the distance at the best t.

use super::target::{LEVER, Of, Target};
use nalgebra::Vector3;
use nurbs::bracket::SecantBracket;
use nurbs::{AxisAt, DualCurve, Pieces};
use rayon::prelude::*;
use tool_stock::collide::meridian::Slope;
use tool_stock::collide::{Cutter, Section};

/// Share of the whole interval at which the search for the nearest time ends.
const INTERVAL: f64 = 1e-6;

/// Change of the distance over the whole interval at which the search ends, mm.
const LEVEL_CHANGE_MM: f64 = 1e-9;

/// The tool in relation to the axis curves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mounted<'a> {
    /// The cutter.
    pub cutter: Cutter,
    /// Height of the lower curve over the tip of the tool.
    pub height: f64,
    /// Shank and holder with the clearance of each section, mm. Empty where no target concerns them.
    pub body: &'a [(Section, f64)],
}

/// Deviation of one point, with its derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// Signed distance to the swept cutter.
    pub value: f64,
    /// Parameter at which the cutter is nearest.
    pub t: f64,
    /// Derivative by the point of the lower curve at t.
    pub lower: Vector3<f64>,
    /// Derivative by the point of the upper curve at t.
    pub upper: Vector3<f64>,
}

/// Distance of a target to the cutter or to the body, at one position of the axis.
fn distance(tool: &Mounted<'_>, at: &AxisAt, target: &Target) -> f64 {
    let d = target.point - at.lower;
    let s = d.dot(&at.axis);
    let rho = (d - at.axis * s).norm_squared().sqrt();
    match target.of {
        Of::Body => body_slope(tool, rho, s + tool.height).value,
        _ => tool.cutter.distance(rho, s + tool.height),
    }
}

/// Distance of the body from a point less its clearance, with the gradient.
fn body_slope(tool: &Mounted<'_>, rho: f64, s: f64) -> Slope {
    let none = Slope { value: f64::INFINITY, rho: 1.0, s: 0.0 };
    tool.body.iter().fold(none, |least, (section, clearance)| {
        let slope = section.slope(rho, s);
        let value = slope.value - clearance;
        if value < least.value { Slope { value, ..slope } } else { least }
    })
}

/// Remaining tilt of the axis, see [`Of::Tilt`].
fn remaining_tilt(at: &AxisAt, t: f64, most: f64) -> Deviation {
    let radial = libm::hypot(at.axis.x, at.axis.y);
    // Where the axis is parallel to Z, every direction of tilt is equal.
    let out = if radial > 0.0 { Vector3::new(at.axis.x, at.axis.y, 0.0) / radial } else { Vector3::x() };
    let upper = (Vector3::z() * radial - out * at.axis.z) * (LEVER / at.length);
    Deviation { value: LEVER * (most - libm::atan2(radial, at.axis.z)), t, lower: -upper, upper }
}

/// Distance, with its derivatives by both points of the axis.
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
    // A turn of the axis moves the point across and along the axis.
    let turn = (slope.s * rho - slope.rho * s) / at.length;
    let upper = out * turn;
    Deviation { value: slope.value, t, lower: -(out * slope.rho + at.axis * slope.s) - upper, upper }
}

/// Stations per knot span at which the best parameter is searched first.
const STATIONS_PER_SPAN: usize = 12;

/// Deviations of points. `before` are the deviations for a similar curve: the search then descends from their
/// parameters.
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
        (Of::Tilt { t, most }, _) => remaining_tilt(&pieces.at(t), t, most),
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
    between(pieces, tool, target, [best.0.saturating_sub(1), (best.0 + 1).min(stations.len() - 1)].map(at))
}

/// The local minimum below a parameter: steps double until the distance grows, then the last interval is searched.
fn downhill(pieces: &Pieces, tool: &Mounted<'_>, from: f64, step: f64, target: &Target) -> Deviation {
    let mut here = rate(pieces, tool, from, target);
    let away = if here.rate < 0.0 { 1.0 } else { -1.0 };
    let mut step = step;
    loop {
        let there = rate(pieces, tool, (here.deviation.t + away * step).clamp(0.0, 1.0), target);
        let turned = there.rate * away >= 0.0;
        if turned || there.deviation.t <= 0.0 || there.deviation.t >= 1.0 {
            return between(pieces, tool, target, if away > 0.0 { [here, there] } else { [there, here] });
        }
        (here, step) = (there, 2.0 * step);
    }
}

/// A deviation with the derivative of the distance by the parameter, mm.
#[derive(Clone, Copy)]
struct RatedDeviation {
    deviation: Deviation,
    rate: f64,
}

/// The deviation at a parameter with its rate.
fn rate(pieces: &Pieces, tool: &Mounted<'_>, t: f64, target: &Target) -> RatedDeviation {
    let (at, [lower, upper]) = pieces.moving(t);
    let deviation = sensitive(tool, &at, t, target);
    RatedDeviation { deviation, rate: deviation.lower.dot(&lower) + deviation.upper.dot(&upper) }
}

/// Least distance between two parameters: where the derivative of the distance changes its sign, else at the better
/// end.
fn between(pieces: &Pieces, tool: &Mounted<'_>, target: &Target, ends: [RatedDeviation; 2]) -> Deviation {
    /// Largest number of iterations; the secant method needs about six.
    const MAX_SECANT_STEPS: usize = 40;
    let [a, b] = ends.map(|end| end.deviation);
    let rates = ends.map(|end| end.rate);
    if rates[0] >= 0.0 || rates[1] <= 0.0 {
        return if a.value < b.value { a } else { b };
    }
    let mut bracket = SecantBracket::new([a.t, b.t], rates);
    let width = bracket.width();
    let mut found = a;
    for _ in 0..MAX_SECANT_STEPS {
        let t = bracket.next().clamp(bracket.ends[0], bracket.ends[1]);
        let RatedDeviation { deviation, rate } = rate(pieces, tool, t, target);
        found = deviation;
        // The error of the value is quadratic in the remaining interval: less than 1 pm here.
        if bracket.width() < INTERVAL * width || rate.abs() * width < LEVEL_CHANGE_MM {
            break;
        }
        bracket.take(t, rate);
    }
    found
}
