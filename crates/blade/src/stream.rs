//! The mean line of a section on its stream surface, unrolled so that angles are kept.
//!
//! Coordinates are m', the integral of ds/r along the meridian, and the angle about the axis. In them a blade of an impeller
//! looks like one of a straight cascade, with the same angles to the meridian.

use nalgebra::Point3;

/// Stations of a mean line.
pub(super) const MEAN_LINE_STATIONS: usize = 33;

/// A face or mean line at even shares of its length: radius, angle without jumps, height.
pub(super) fn stations(points: &[Point3<f64>]) -> Vec<[f64; 3]> {
    let mut along = vec![0.0];
    for w in points.windows(2) {
        along.push(along.last().copied().unwrap_or(0.0) + nalgebra::distance(&w[0], &w[1]));
    }
    let length = along.last().copied().unwrap_or(0.0);
    let at = |k: usize| {
        let distance = length * k as f64 / (MEAN_LINE_STATIONS - 1) as f64;
        let i = along.partition_point(|a| *a <= distance).clamp(1, points.len().max(2) - 1) - 1;
        match (points.get(i), points.get(i + 1)) {
            (Some(a), Some(b)) if along[i + 1] > along[i] => {
                a + (b - a) * ((distance - along[i]) / (along[i + 1] - along[i]))
            }
            (Some(a), _) => *a,
            _ => Point3::origin(),
        }
    };
    let mut before = None;
    (0..MEAN_LINE_STATIONS)
        .map(|k| {
            let p = at(k);
            let angle = near(libm::atan2(p.y, p.x), before);
            before = Some(angle);
            [libm::hypot(p.x, p.y), angle, p.z]
        })
        .collect()
}

/// The angle with whole turns added so that it is nearest to another, rad.
pub(super) fn near(angle: f64, other: Option<f64>) -> f64 {
    let turn = std::f64::consts::TAU;
    other.map_or(angle, |other| angle + turn * libm::round((other - angle) / turn))
}

/// What both faces tell of a section; both from the leading to the trailing edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Camber {
    /// Mean angle about the axis from the first to the second face, rad.
    pub(super) between: f64,
    /// Turn of the mean line from the leading to the trailing edge, rad; positive towards greater angles about the axis.
    pub(super) turn: f64,
    /// Angle about the axis from the leading to the trailing edge, rad.
    pub(super) wrap: f64,
}

/// Compares two faces.
pub(super) fn camber(faces: [&[Point3<f64>]; 2]) -> Camber {
    let [a, b] = faces.map(stations);
    let pairs: Vec<[f64; 4]> = a
        .iter()
        .zip(&b)
        .map(|(a, b)| {
            let angle = near(b[1], Some(a[1]));
            [0.5 * (a[0] + b[0]), 0.5 * (a[1] + angle), 0.5 * (a[2] + b[2]), angle - a[1]]
        })
        .collect();
    let between = pairs.iter().map(|p| p[3]).sum::<f64>() / MEAN_LINE_STATIONS as f64;
    let mut line = vec![[0.0, pairs.first().map_or(0.0, |p| p[1])]];
    for w in pairs.windows(2) {
        let [p, q] = [w[0], w[1]];
        let r = 0.5 * (p[0] + q[0]);
        let step = libm::hypot(q[0] - p[0], q[2] - p[2]) / r.max(f64::MIN_POSITIVE);
        let m = line.last().map_or(0.0, |l| l[0]);
        line.push([m + step, q[1]]);
    }
    // Over a quarter of the blade at each end, without the part at the edges.
    let direction = |from: usize, to: usize| libm::atan2(line[to][1] - line[from][1], line[to][0] - line[from][0]);
    let last = MEAN_LINE_STATIONS - 1;
    let turn = direction(last - 9, last - 1) - direction(1, 9);
    Camber { between, turn, wrap: line[last][1] - line[0][1] }
}

/// Points of a section unrolled: along the meridian of its mean line, and round the axis at the mean radius, mm. Angles are
/// not kept; what crosses in space crosses here too.
pub(super) fn unrolled(faces: &[Vec<Point3<f64>>; 2], points: &[Point3<f64>]) -> Vec<[f64; 2]> {
    let [a, b] = [&faces[0], &faces[1]].map(|f| stations(f));
    let line: Vec<[f64; 2]> = a.iter().zip(&b).map(|(a, b)| [0.5 * (a[0] + b[0]), 0.5 * (a[2] + b[2])]).collect();
    let radius = line.iter().map(|p| p[0]).sum::<f64>() / MEAN_LINE_STATIONS as f64;
    let mut before = a.first().map(|s| s[1]);
    points
        .iter()
        .map(|p| {
            let angle = near(libm::atan2(p.y, p.x), before);
            before = Some(angle);
            [along(&line, [libm::hypot(p.x, p.y), p.z]), radius * angle]
        })
        .collect()
}

/// Distance along a meridian (r, z) to the place nearest to a point, mm. The first and the last chord go on beyond its ends,
/// where blades may begin or end.
pub(super) fn along(line: &[[f64; 2]], [r, z]: [f64; 2]) -> f64 {
    let (mut best, mut gone) = ((f64::INFINITY, 0.0), 0.0);
    let last = line.len().saturating_sub(2);
    for (k, w) in line.windows(2).enumerate() {
        let [dr, dz] = [w[1][0] - w[0][0], w[1][1] - w[0][1]];
        let chord = libm::hypot(dr, dz);
        if chord == 0.0 {
            continue;
        }
        let low = if k == 0 { f64::NEG_INFINITY } else { 0.0 };
        let high = if k == last { f64::INFINITY } else { 1.0 };
        let share = (((r - w[0][0]) * dr + (z - w[0][1]) * dz) / (chord * chord)).clamp(low, high);
        let distance = libm::hypot(r - w[0][0] - share * dr, z - w[0][1] - share * dz);
        if distance < best.0 {
            best = (distance, gone + share * chord);
        }
        gone += chord;
    }
    best.1
}
