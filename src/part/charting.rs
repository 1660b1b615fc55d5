//! Makes the tables of the charts of a part from its surfaces.

use super::blade::{BladeId, FaceId};
use super::borders::Opening;
use super::chart_rows::ChartRows;
use super::chart_table::{ChartForm, ChartTable, ChartTables};
use super::names::SurfaceKind;
use super::turned_patch::TurnedPatch;
use super::{Extent, Part, Passage, Surface, hub_normal};
use nalgebra::{Point3, Vector3};

/// Difference of two values of the secant method that has no slope, mm.
const LEVEL: f64 = 1e-15;

/// Error at which the secant method ends, mm.
const EXACT: f64 = 1e-11;

/// Rows of the tables of borders and rolling balls. Rows are about 0.2 mm apart. For a curve with a curvature radius of
/// millimetres, cubic splines are then exact to 1 nm (tested).
const ROWS: usize = 400;

/// Rows of the tables of edges that the lathe makes, from hub to shroud.
const EDGE_ROWS: usize = 100;

pub(super) fn tables(part: &Part) -> ChartTables {
    let mut milled: Vec<ChartTable> = part.faces().map(|id| face(part, id, SurfaceKind::Face(id))).collect();
    let sides = part.blade_ids().flat_map(|blade| part.sides(blade));
    milled.extend(sides.filter_map(|id| fillet(part, id, part.fillet(id)?.get())));
    milled.extend(part.passages().filter_map(|passage| hub(part, &passage)));
    ChartTables { milled, edges: part.blade_ids().flat_map(|blade| edges_of_blade(part, blade)).collect() }
}

fn edges_of_blade(part: &Part, blade: BladeId) -> [ChartTable; 2] {
    [(SurfaceKind::InletEdge(blade), 0.0), (SurfaceKind::OutletEdge(blade), 1.0)].map(|(kind, u)| {
        if let Some(edge) = part.edge(blade, usize::from(u > 0.5)) {
            return face(part, edge, kind);
        }
        let ranges = blade.faces().map(|id| borders(part, id, u));
        let extent = part.extent(blade);
        let at = |i: usize| {
            blade.faces().map(|id| {
                let [low, high] = ranges[id.index()];
                turned(part, &extent, id, u, low + (high - low) * i as f64 / EDGE_ROWS as f64)
            })
        };
        let rows: Vec<[Point3<f64>; 2]> = (0..=EDGE_ROWS).map(at).collect();
        ChartTable { kind, blade, form: ChartForm::Edge { blade, u, patch: TurnedPatch::between(&rows) } }
    })
}

/// v at the lower and the upper border of a face, on the ruling at u.
fn borders(part: &Part, id: FaceId, u: f64) -> [f64; 2] {
    let low = part
        .fillet(id)
        .and_then(|r| part.fillet_tangent(id, u, r.get()))
        .unwrap_or_else(|| part.ruling_meets(id, u, &part.hub, 0.0));
    [low, part.ruling_meets(id, u, &part.shroud, 1.0)]
}

fn rows() -> impl Iterator<Item = f64> {
    (0..=ROWS).map(|i| i as f64 / ROWS as f64)
}

fn face(part: &Part, id: FaceId, kind: SurfaceKind) -> ChartTable {
    let borders: Vec<[f64; 2]> = rows().map(|u| borders(part, id, u)).collect();
    ChartTable { kind, blade: id.blade, form: ChartForm::Face { face: id, borders: ChartRows::through(&borders) } }
}

fn fillet(part: &Part, id: FaceId, radius: f64) -> Option<ChartTable> {
    let face = part.face(id);
    let [from, to] = part.fillet_ends(id, radius);
    let ball = |u: f64| {
        let v = part.fillet_tangent(id, u, radius)?;
        let to_face = -face.normal(u, v);
        let centre = face.surface.point(u, v) - to_face * radius;
        let to_hub = -hub_normal(part, &centre);
        Some([centre.coords, to_face, to_hub])
    };
    let found: Vec<Option<[Vector3<f64>; 3]>> = rows().map(|x| ball(from + (to - from) * x)).collect();
    // Far beyond an end there may be no ball; the surface is the connected run of rows about the middle.
    let middle = ROWS / 2;
    found[middle]?;
    let first = (0..middle).rev().find(|i| found[*i].is_none()).map_or(0, |i| i + 1);
    let last = (middle..=ROWS).find(|i| found[*i].is_none()).unwrap_or(ROWS + 1);
    let numbers = |ball: &[Vector3<f64>; 3]| std::array::from_fn(|k| ball[k / 3][k % 3]);
    let balls: Vec<[f64; 9]> = found[first..last].iter().flatten().map(numbers).collect();
    let u = [first, last - 1].map(|i| from + (to - from) * i as f64 / ROWS as f64);
    (balls.len() > 3).then_some(ChartTable {
        kind: SurfaceKind::Fillet(id),
        blade: id.blade,
        form: ChartForm::Fillet { radius, u, balls: ChartRows::through(&balls) },
    })
}

fn hub(part: &Part, passage: &Passage) -> Option<ChartTable> {
    let opening = Opening::of(part, passage);
    let border = |i| opening.at(i as f64 / ROWS as f64).map(|[from, angle]| [from, angle.max(0.0)]);
    let borders: Option<Vec<[f64; 2]>> = (0..=ROWS).map(border).collect();
    Some(ChartTable {
        kind: SurfaceKind::Hub(passage.id),
        blade: BladeId::MAIN,
        form: ChartForm::Hub { borders: ChartRows::along(&borders?) },
    })
}

/// The end of the line of equal v of a face at u = 0 or 1, or its intersection with the inlet cone or the outlet
/// cylinder, if this lies farther out: a straight ruling between two points of a cone is not on the cone.
fn turned(part: &Part, extent: &Extent, id: FaceId, u: f64, v: f64) -> Point3<f64> {
    let surface = &part.face(id).surface;
    let gap = |u: f64| extent.beyond(u.round().clamp(0.0, 1.0), &surface.point(u, v));
    let (mut a, mut b) = (u, u + 1e-3);
    let (mut fa, mut fb) = (gap(a), gap(b));
    // Secant method: over some 0.01 mm the face is nearly straight.
    for _ in 0..8 {
        if (fb - fa).abs() < LEVEL || fb.abs() < EXACT {
            break;
        }
        let next = (b - fb * (b - a) / (fb - fa)).clamp(u - 0.2, u + 0.2);
        (a, fa) = (b, fb);
        (b, fb) = (next, gap(next));
    }
    surface.point(if u > 0.5 { b.max(u) } else { b.min(u) }, v)
}
