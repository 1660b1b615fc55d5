//! Distances of the parts of a tool to places about its axis, on a grid.
//!
//! A search of the nearest sample asks for most distances only whether they are below a limit. A look-up answers that
//! without a root; near the limit the exact distance decides, so that no answer depends on the grid.

use super::ToolSolid;
use std::f64::consts::FRAC_1_SQRT_2;

/// Distance of the places, as a share of the radius of the tip of the tool, and its largest value, mm.
const STEP_SHARE: f64 = 0.25;
const MAX_STEP_MM: f64 = 0.5;

/// Most places of a table: they should stay in the cache of the processor.
const MAX_PLACES: f64 = 1e5;

/// Distance from the tool up to which the table reaches, mm.
const BEYOND_MM: f64 = 20.0;

/// Reserve for the digits of a distance in the table, as a share of the distance.
const DIGITS: f64 = 1e-6;

/// Distances of `N` parts of a tool.
#[derive(Clone, Debug)]
pub struct DistanceTable<const N: usize> {
    /// Lowest height over the tip, mm.
    low: f64,
    /// Inverse of the distance of the places.
    per_mm: f64,
    /// Places across, in rows of one height.
    columns: usize,
    rows: usize,
    values: Vec<[f32; N]>,
    /// Largest distance of a place from the nearest one of the table, mm.
    error: f64,
}

impl<const N: usize> DistanceTable<N> {
    /// The table of a tool. `distances` takes the distance from the tool axis and the height over the tip; none of its values
    /// may change faster than the place.
    pub fn new(solid: &ToolSolid, distances: impl Fn(f64, f64) -> [f64; N]) -> Self {
        let sections = solid.shank.iter().chain(&solid.holder);
        let widest = sections.map(|s| s.radius_from.max(s.radius_to)).fold(solid.radius(), f64::max);
        let (across, height) = (widest + BEYOND_MM, solid.length() + 2.0 * BEYOND_MM);
        let finest = (across * height / MAX_PLACES).sqrt();
        let step = (STEP_SHARE * solid.cutter.nominal_radius()).min(MAX_STEP_MM).max(finest);
        let [columns, rows] = [across, height].map(|length| (length / step).ceil() as usize + 1);
        let low = -BEYOND_MM;
        let values = (0..rows * columns)
            .map(|k| {
                let (rho, s) = ((k % columns) as f64 * step, low + (k / columns) as f64 * step);
                distances(rho, s).map(|d| d as f32)
            })
            .collect();
        Self { low, per_mm: 1.0 / step, columns, rows, values, error: FRAC_1_SQRT_2 * step }
    }

    /// Least distance over all parts, each less what is required of it.
    #[inline]
    pub fn least(distances: &[f64; N], required: &[f64; N]) -> f64 {
        distances.iter().zip(required).map(|(d, required)| d - required).fold(f64::INFINITY, f64::min)
    }

    /// Least distance over all parts, each less what is required of it, at a distance from the axis and a height over the tip;
    /// or, where the table shows on which side of `limit` it lies, a number on that side that is no greater. `exact` computes the
    /// distances.
    #[inline]
    pub fn side(&self, rho: f64, s: f64, required: &[f64; N], limit: f64, exact: impl FnOnce() -> [f64; N]) -> f64 {
        let exact = || Self::least(&exact(), required);
        let (column, row) = (rho * self.per_mm + 0.5, (s - self.low) * self.per_mm + 0.5);
        // Casts saturate: no number is beyond both ends.
        let (i, j) = (column as usize, row as usize);
        if row < 0.0 || i >= self.columns || j >= self.rows {
            return exact();
        }
        let mut about = f64::INFINITY;
        let mut error = self.error;
        for (known, required) in self.values[j * self.columns + i].iter().zip(required) {
            let known = f64::from(*known);
            about = about.min(known - required);
            error = error.max(self.error + DIGITS * if known.is_finite() { known.abs() } else { 0.0 });
        }
        if about - error >= limit || about + error < limit { about - error } else { exact() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::collide::samples::solids;
    use crate::collide::tool::Section;

    /// All over the table and beyond it, with limits on both sides of the distance.
    #[test]
    fn sides_are_those_of_the_distance() {
        let shank = Section { from: 12.0, to: 40.0, radius_from: 2.0, radius_to: 6.0 };
        let (mut known, mut all) = (0, 0);
        for solid in solids() {
            let solid = ToolSolid { shank: vec![shank], ..solid };
            let parts = |rho: f64, s: f64| [solid.cutter_distance(rho, s), solid.body_distance(rho, s)];
            let table = DistanceTable::new(&solid, parts);
            let required = [0.2, 0.5];
            for k in 0..4000 {
                let at = |f: f64| (f64::from(k) * f).sin();
                let (rho, s) = (20.0 + 20.0 * at(0.7), 20.0 + 45.0 * at(1.3));
                let [cutter, body] = parts(rho, s);
                let exact = (cutter - required[0]).min(body - required[1]);
                for limit in [exact - 1.0, exact - 0.1, exact - 1e-9, exact, exact + 1e-9, exact + 0.1, exact + 1.0] {
                    let mut asked = false;
                    let side = table.side(rho, s, &required, limit, || {
                        asked = true;
                        [cutter, body]
                    });
                    assert_eq!(side < limit, exact < limit, "{rho} {s} {limit}: {side} {exact}");
                    assert!(side <= exact, "{rho} {s} {limit}: {side} {exact}");
                    all += 1;
                    known += i32::from(!asked);
                }
            }
        }
        assert!(known > all / 10, "{known} of {all}");
    }
}
