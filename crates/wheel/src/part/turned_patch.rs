//! Turned surfaces between two borders: radius, height and azimuth go evenly from one border to the other.

use super::chart_rows::ChartRows;
use nalgebra::Point3;
use nurbs::angle::nearest_turn;
use nurbs::range::{Jet, turned};

/// A patch of a turned surface, with x along both borders and y from the first border to the second.
#[derive(Clone, Debug)]
pub(super) struct TurnedPatch {
    /// Radius, height and azimuth of the first border, then of the second.
    borders: ChartRows<6>,
}

impl TurnedPatch {
    /// The patch between rows of points of both borders, the short way around Z. At least four rows.
    pub(super) fn between(rows: &[[Point3<f64>; 2]]) -> Self {
        let mut before: Option<[f64; 6]> = None;
        let row = |pair: &[Point3<f64>; 2]| {
            let [a, b] = pair.map(|p| [libm::hypot(p.x, p.y), p.z, libm::atan2(p.y, p.x)]);
            // Neighbouring azimuths lie within half a turn.
            let from = before.map_or(a[2], |before| nearest_turn(a[2], before[2]));
            let to = nearest_turn(b[2], before.map_or(from, |before| before[5]));
            let row = [a[0], a[1], from, b[0], b[1], to];
            before = Some(row);
            row
        };
        let rows: Vec<[f64; 6]> = rows.iter().map(row).collect();
        Self { borders: ChartRows::through(&rows) }
    }

    /// Radius, height and azimuth.
    pub(super) fn at(&self, x: f64, y: f64) -> [f64; 3] {
        let b = self.borders.at(x);
        [0, 1, 2].map(|k| b[k] + (b[k + 3] - b[k]) * y)
    }

    /// Point.
    pub(super) fn point(&self, x: f64, y: f64) -> Point3<f64> {
        let [r, z, azimuth] = self.at(x, y);
        let (sin, cos) = libm::sincos(azimuth);
        Point3::new(r * cos, r * sin, z)
    }

    /// Coordinates over a range of x, which varies or not, and a jet of y.
    pub(super) fn jets(&self, x: [f64; 2], varies: bool, y: Jet) -> [Jet; 3] {
        let b = self.borders.jets(x, varies);
        let [r, z, azimuth] = [0, 1, 2].map(|k| b[k].towards(b[k + 3], y));
        turned([r, z], azimuth)
    }
}
