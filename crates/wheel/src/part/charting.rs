//! Makes the tables of the charts of a part from its surfaces.

use super::blade::{BladeId, FaceId};
use super::borders::Opening;
use super::chart_rows::ChartRows;
use super::chart_table::{ChartForm, ChartTable, ChartTables};
use super::names::SurfaceKind;
use super::rolling_ball::FilletArc;
use super::turned_patch::TurnedPatch;
use super::{Extent, Part, Passage, Surface};
use base::units::Mm;
use nalgebra::{Point3, Vector2};
use nurbs::angle::nearest_turn;
use nurbs::bracket::{SecantEnd, secant};
use rayon::prelude::*;

/// End of secants along a line of equal height of a face, mm.
const LINE: SecantEnd = SecantEnd { steps: 8, exact: 1e-11, level: 1e-15 };

/// Fewest and most spans of the tables of borders and rolling balls.
const TABLE_SPANS: [usize; 2] = [400, 6400];

/// Largest error of such a table in the middle between two rows, mm. Below the foot of a sharp leading edge 400 spans were off by a
/// micrometre.
const MAX_TABLE_ERROR_MM: f64 = 5e-5;

/// Spans of the table of the hub of a passage, whose borders have corners.
const HUB_SPANS: usize = 400;

/// Spans of the tables of tips.
const TIP_SPANS: usize = 400;

/// Rows of the tables of edges that the lathe makes, from hub to shroud.
const EDGE_ROWS: usize = 100;

pub(super) fn tables(part: &Part) -> ChartTables {
    let mut milled: Vec<ChartTable> = part.faces().map(|id| face(part, id, SurfaceKind::Face(id))).collect();
    let sides = part.blade_ids().flat_map(|blade| part.sides(blade));
    milled.extend(sides.filter_map(|id| fillet(part, id)));
    milled.extend(part.passages().filter_map(|passage| hub(part, &passage)));
    let edges = part.blade_ids().flat_map(|blade| edges_of_blade(part, blade)).collect();
    ChartTables { milled, edges, tips: part.blade_ids().map(|blade| tip(part, blade)).collect() }
}

fn tip(part: &Part, blade: BladeId) -> ChartTable {
    let [pressure, suction] = blade.faces().map(|face| {
        let at = |i: usize| {
            let (id, u) = part.outline_place(face, i as f64 / TIP_SPANS as f64);
            let p = part.face(id).surface.point(u, part.ruling_meets(id, u, &part.shroud, 1.0));
            let (along, _) = part.shroud.closest(Vector2::new(libm::hypot(p.x, p.y), p.z));
            [along, libm::atan2(p.y, p.x)]
        };
        (0..=TIP_SPANS).into_par_iter().map(at).collect::<Vec<_>>()
    });
    // Azimuths of neighbouring rows, and of both borders of the first row, lie within half a turn.
    let mut before = [pressure[0][1]; 2];
    let row = |([u, azimuth], [other_u, other_azimuth]): (&[f64; 2], &[f64; 2])| {
        let from = nearest_turn(*azimuth, before[0]);
        let to = nearest_turn(*other_azimuth, before[1]);
        before = [from, to];
        [*u, from, *other_u, to]
    };
    let rows: Vec<[f64; 4]> = pressure.iter().zip(&suction).map(row).collect();
    ChartTable { kind: SurfaceKind::Tip(blade), blade, form: ChartForm::Tip { borders: ChartRows::along(&rows) } }
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
pub(super) fn borders(part: &Part, id: FaceId, u: f64) -> [f64; 2] {
    let low = part.fillet_top(id, u).unwrap_or_else(|| part.ruling_meets(id, u, &part.hub, 0.0));
    [low, part.ruling_meets(id, u, &part.shroud, 1.0)]
}

/// Splines through rows at equal steps of x, so many that they are off by at most [`MAX_TABLE_ERROR_MM`] in the middle between two rows. `off` is the
/// distance of a row of the splines from the row itself, mm. `None` where a row has no numbers.
fn table<const N: usize>(
    at: impl Fn(f64) -> Option<[f64; N]> + Sync,
    off: impl Fn(&[f64; N], &[f64; N]) -> f64 + Sync,
) -> Option<ChartRows<N>> {
    let [fewest, most] = TABLE_SPANS;
    let first = (0..=fewest).into_par_iter().map(|i| at(i as f64 / fewest as f64));
    let mut rows: Vec<[f64; N]> = first.collect::<Option<_>>()?;
    loop {
        let (table, spans) = (ChartRows::through(&rows), rows.len() - 1);
        if spans >= most {
            return Some(table);
        }
        let places = (0..spans).into_par_iter().map(|i| (i as f64 + 0.5) / spans as f64);
        let between: Vec<[f64; N]> = places.clone().map(&at).collect::<Option<_>>()?;
        if places.zip(&between).all(|(x, row)| off(&table.at(x), row) <= MAX_TABLE_ERROR_MM) {
            return Some(table);
        }
        let last = rows[spans];
        rows = rows.into_iter().zip(between).flat_map(|(row, next)| [row, next]).chain([last]).collect();
    }
}

fn face(part: &Part, id: FaceId, kind: SurfaceKind) -> ChartTable {
    let surface = &part.face(id).surface;
    let height = surface.height(0.5);
    let off = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).abs().max((a[1] - b[1]).abs()) * height;
    let borders = table(|u| Some(borders(part, id, u)), off);
    // Every row has borders.
    let borders = borders.unwrap_or_else(|| ChartRows::through(&[[0.0, 1.0]; 4]));
    ChartTable { kind, blade: id.blade, form: ChartForm::Face { face: id, borders } }
}

fn fillet(part: &Part, id: FaceId) -> Option<ChartTable> {
    let around_edge = || part.fillet_radius(id, 0.0).filter(|_| id.edge_end().is_some());
    let constant = part.fillet(id)?.constant().map(Mm::get).or_else(around_edge);
    let form = match constant {
        Some(radius) => {
            let (u, balls) = fillet_table(part, id, |FilletArc { centre: c, ends: [f, h], .. }| {
                [c.x, c.y, c.z, f.x, f.y, f.z, h.x, h.y, h.z]
            })?;
            ChartForm::Fillet { radius, u, balls }
        }
        None => {
            let (u, balls) =
                fillet_table(part, id, |FilletArc { centre: c, radius, tilt: t, level, ends: [f, h] }| {
                    [c.x, c.y, c.z, f.x, f.y, f.z, h.x, h.y, h.z, t.x, t.y, t.z, level, radius]
                })?;
            ChartForm::VariedFillet { u, balls }
        }
    };
    Some(ChartTable { kind: SurfaceKind::Fillet(id), blade: id.blade, form })
}

/// Range of u of a fillet. `None` where no ball touches face and hub in the middle.
pub(super) fn fillet_range(part: &Part, id: FaceId) -> Option<[f64; 2]> {
    /// Steps along the foot at which the range is looked for.
    const RANGE_STEPS: usize = 400;
    let [from, to] = part.fillet_ends(id, |u| part.fillet_radius(id, u).unwrap_or(0.0));
    let place = |i: usize| from + (to - from) * i as f64 / RANGE_STEPS as f64;
    let balls: Vec<bool> = (0..=RANGE_STEPS).into_par_iter().map(|i| part.has_fillet_arc(id, place(i))).collect();
    let stands = |i: &usize| balls[*i];
    // Far beyond an end there may be no ball; the surface is the connected run of places about the middle.
    let middle = RANGE_STEPS / 2;
    if !stands(&middle) {
        return None;
    }
    let first = (0..middle).rev().take_while(stands).last().unwrap_or(middle);
    let last = (middle..=RANGE_STEPS).take_while(stands).last().unwrap_or(middle);
    Some([first, last].map(place))
}

/// Range of u and table of a fillet: of the centre and of directions from it. `None` where no ball touches face and hub in the middle.
fn fillet_table<const N: usize>(
    part: &Part,
    id: FaceId,
    numbers: impl Fn(FilletArc) -> [f64; N] + Sync,
) -> Option<([f64; 2], ChartRows<N>)> {
    let u = fillet_range(part, id)?;
    let most = part.fillet(id)?.most().get();
    let off = |a: &[f64; N], b: &[f64; N]| {
        let square = |k: usize| (a[k] - b[k]) * (a[k] - b[k]);
        let [centre, directions]: [f64; 2] = [(0..3).map(square).sum(), (3..N).map(square).sum()];
        centre.sqrt() + directions.sqrt() * most
    };
    let balls = table(|x| part.fillet_arc(id, u[0] + (u[1] - u[0]) * x).map(&numbers), off)?;
    Some((u, balls))
}

fn hub(part: &Part, passage: &Passage) -> Option<ChartTable> {
    let opening = Opening::of(part, passage);
    let border = |i| opening.at(i as f64 / HUB_SPANS as f64).map(|[from, angle]| [from, angle.max(0.0)]);
    let borders: Option<Vec<[f64; 2]>> = (0..=HUB_SPANS).into_par_iter().map(border).collect();
    Some(ChartTable {
        kind: SurfaceKind::Hub(passage.id),
        blade: BladeId::MAIN,
        form: ChartForm::Hub { borders: ChartRows::along(&borders?) },
    })
}

/// The end of the line of equal v of a face at u = 0 or 1, or its intersection with the inlet cone or the outlet
/// cylinder, if this lies farther out: a straight ruling between two points of a cone is not on the cone.
pub(super) fn turned(part: &Part, extent: &Extent, id: FaceId, u: f64, v: f64) -> Point3<f64> {
    let surface = &part.face(id).surface;
    let gap = |u: f64| extent.beyond(u.round().clamp(0.0, 1.0), &surface.point(u, v));
    // Over some 0.01 mm the face is nearly straight.
    let met = secant([u, u + 1e-3], 0.2, LINE, gap);
    surface.point(if u > 0.5 { met.max(u) } else { met.min(u) }, v)
}
