//! Areas and sizes of the surfaces that operations finish.

use nalgebra::Point3;
use plan::facts::concave;
use wheel::part::chart::{self, Chart, Shape};
use wheel::part::{Part, SurfaceKind};

/// A surface of sector 0 that is finished.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Milled {
    pub(crate) kind: SurfaceKind,
    /// Area, mm2.
    pub(crate) area: f64,
    /// Largest concave curvature in any direction, 1/mm; zero where it is nowhere hollow.
    pub(crate) concave: f64,
    /// Curvature across its lines in the middle, 1/mm, positive where it is hollow.
    pub(crate) across: f64,
    /// Length along its lines and width across them, mm, the mean of both.
    pub(crate) length: f64,
    pub(crate) width: f64,
}

/// Cells along and across a surface for its area: chords of 1/48 of a surface leave less than a thousandth of it.
const CELLS: [usize; 2] = [48, 16];

/// Places along a hub at which its curvature is measured.
const HUB_PLACES: usize = 400;

/// All surfaces of sector 0 that an operation can finish.
pub(crate) fn milled(part: &Part) -> Vec<Milled> {
    let of_part = chart::charts(part);
    let kinds: Vec<SurfaceKind> = of_part.iter().map(|chart| chart.kind).collect();
    let turned = chart::edges(part).chain(chart::tips(part)).filter(|chart| !kinds.contains(&chart.kind));
    of_part.iter().cloned().chain(turned).map(|chart| measured(part, &chart)).collect()
}

fn measured(part: &Part, chart: &Chart<'_>) -> Milled {
    let [columns, rows] = CELLS;
    let at = |i: usize, j: usize| chart.place(i as f64 / columns as f64, j as f64 / rows as f64).position;
    let grid: Vec<Vec<Point3<f64>>> = (0..=columns).map(|i| (0..=rows).map(|j| at(i, j)).collect()).collect();
    let mut area = 0.0;
    for [a, b] in grid.array_windows() {
        for j in 0..rows {
            area += 0.5 * (b[j + 1] - a[j]).cross(&(a[j + 1] - b[j])).norm();
        }
    }
    // Edges run from face to face, and their lines from root to tip.
    let edge = matches!(chart.kind, SurfaceKind::InletEdge(_) | SurfaceKind::OutletEdge(_));
    let along: f64 = grid.array_windows().map(|[a, b]| (b[rows / 2] - a[rows / 2]).norm()).sum();
    let across: f64 = grid[columns / 2].array_windows().map(|[a, b]| (b - a).norm()).sum();
    let own = matches!(chart.kind, SurfaceKind::InletEdge(b) if part.edge(b, 0).is_some())
        || matches!(chart.kind, SurfaceKind::OutletEdge(b) if part.edge(b, 1).is_some());
    let turns = edge && own;
    let length = if turns { across } else { along };
    let width = if length > 0.0 { area / length } else { 0.0 };
    let (concave, bend) = curvatures(part, chart, width);
    Milled { kind: chart.kind, area, concave, across: bend, length, width }
}

/// Largest concave curvature of a surface, and its curvature across the lines, positive where it is hollow, 1/mm.
fn curvatures(part: &Part, chart: &Chart<'_>, width: f64) -> (f64, f64) {
    match chart.kind {
        SurfaceKind::Face(face) => {
            let concave = concave::measure(part, face).map_or(0.0, |concave| 1.0 / concave.radius);
            (concave, 0.0)
        }
        SurfaceKind::Fillet(_) => {
            let radii = (0..=CELLS[0]).filter_map(|i| chart.fillet_radius(i as f64 / CELLS[0] as f64));
            let curvature = 1.0 / radii.fold(f64::INFINITY, f64::min);
            (curvature, curvature)
        }
        SurfaceKind::Hub(_) => {
            let places = (0..=HUB_PLACES).map(|k| k as f64 / HUB_PLACES as f64);
            let hollow = places.map(|u| -part.hub.meridian_curvature(u)).fold(0.0, f64::max);
            (hollow, -part.hub.ring_curvature(0.5))
        }
        // Round from face to face, about a middle line: half of a circle.
        SurfaceKind::InletEdge(_) | SurfaceKind::OutletEdge(_) if width > 0.0 => (0.0, -std::f64::consts::PI / width),
        _ => (0.0, 0.0),
    }
}

/// Volume of a turned blank, mm3, by the theorem of Pappus on the edges of its profile.
pub(crate) fn turned_volume(profile: &[[f64; 2]]) -> f64 {
    let ends = profile.iter().zip(profile.iter().cycle().skip(1));
    let edge = |([r, z], [s, t]): (&[f64; 2], &[f64; 2])| (t - z) * (r * r + r * s + s * s);
    (std::f64::consts::PI / 3.0 * ends.map(edge).sum::<f64>()).abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turned_ring_and_a_cone_have_their_volumes() {
        let ring = turned_volume(&[[2.0, 0.0], [5.0, 0.0], [5.0, 3.0], [2.0, 3.0]]);
        assert!((ring - std::f64::consts::PI * 21.0 * 3.0).abs() < 1e-9, "{ring}");
        let cone = turned_volume(&[[0.0, 0.0], [3.0, 0.0], [0.0, 4.0]]);
        assert!((cone - std::f64::consts::PI * 12.0).abs() < 1e-9, "{cone}");
    }
}
