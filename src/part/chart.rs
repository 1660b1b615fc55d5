//! Charts: every milled surface of a sector as the image of the unit square, so that it divides into cells without
//! gaps.
//!
//! | surface | x | y |
//! |---|---|---|
//! | face | u, from inlet to outlet | from the fillet (or the hub) up the ruling to the shroud |
//! | fillet | along the rolling ball, also beyond both ends of the face | from the contact on the face to that on the
//! hub |
//! | hub | u of the hub | from the clockwise wall of the channel to the other |
//! | edge that the lathe makes | from the fillets (or the hub) to the shroud | from the pressure face to the suction face |
//! | edge that is a surface of its own | u, from the pressure to the suction face | as for a face |

use super::borders::{Opening, arc_between};
use super::chart_table::{ChartForm, ChartTable, ChartTables};
use super::{BladeId, Extent, FaceId, Part, Passage, Surface, SurfaceKind, hub_normal};
use crate::geom::angle::great_arc;
use nalgebra::{Point3, Vector3};

/// Difference of two values of the secant method that has no slope, mm.
const LEVEL: f64 = 1e-15;

/// Error at which the secant method ends, mm.
const EXACT: f64 = 1e-11;

/// Rows of the tables of borders and rolling balls. Rows are about 0.2 mm apart. For a curve with a curvature radius of
/// millimetres, cubic interpolation is then exact to 1 nm (tested).
const ROWS: usize = 400;

/// A milled surface of sector 0 over the unit square.
#[derive(Clone, Debug)]
pub struct Chart<'a> {
    /// Kind of the surface.
    pub kind: SurfaceKind,
    part: &'a Part,
    extent: Extent,
    form: &'a ChartForm,
}

/// A place of a chart.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// Position, part frame, sector 0.
    pub position: Point3<f64>,
    /// Unit normal out of the material.
    pub normal: Vector3<f64>,
    /// Parameters: (u, v) of a face, (u, share of the arc) of a fillet, (u, share across) of the hub.
    pub parameters: [f64; 2],
}

/// A surface as the image of the unit square.
pub trait Shape: Sync {
    /// The place of (x, y), both in [0, 1].
    fn place(&self, x: f64, y: f64) -> Place;

    /// True when a place belongs to the part.
    fn is_milled(&self, _position: &Point3<f64>) -> bool {
        true
    }

    /// Patches that cover the square once, with cells of at most `spacing` on the surface, mm.
    fn patches(&self, spacing: f64) -> Vec<Patch> {
        let length = |a: (f64, f64), b: (f64, f64)| -> f64 {
            const PARTS: usize = 40;
            let at = |k: usize| {
                let t = k as f64 / PARTS as f64;
                self.place(a.0 + (b.0 - a.0) * t, a.1 + (b.1 - a.1) * t).position
            };
            (0..PARTS).map(|k| (at(k + 1) - at(k)).norm()).sum()
        };
        let along = [0.0, 0.5, 1.0].map(|y| length((0.0, y), (1.0, y))).into_iter().fold(0.0, f64::max);
        let strips = (along / (spacing * PATCH as f64)).ceil().max(1.0) as usize;
        let mut patches = Vec::new();
        for i in 0..strips {
            let x = [i as f64 / strips as f64, (i + 1) as f64 / strips as f64];
            let across = x.map(|x| length((x, 0.0), (x, 1.0))).into_iter().fold(0.0, f64::max);
            let rows = (across / spacing).ceil().max(2.0) as usize;
            let count = rows.div_ceil(PATCH);
            for j in 0..count {
                let (first, last) = (j * rows / count, (j + 1) * rows / count);
                let y = [first as f64 / rows as f64, last as f64 / rows as f64];
                patches.push(Patch { x, y, columns: PATCH, rows: last - first });
            }
        }
        patches
    }
}

/// A rectangle of the unit square, divided into cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// Least and largest x.
    pub x: [f64; 2],
    /// Least and largest y.
    pub y: [f64; 2],
    /// Cells along x.
    pub columns: usize,
    /// Cells along y.
    pub rows: usize,
}

impl Patch {
    /// The corner of its cells with index i along x and j along y.
    pub fn corner(&self, i: usize, j: usize) -> [f64; 2] {
        let mix = |r: [f64; 2], k: usize, n: usize| r[0] + (r[1] - r[0]) * k as f64 / n as f64;
        [mix(self.x, i, self.columns), mix(self.y, j, self.rows)]
    }
}

/// Cells along a side of a patch.
const PATCH: usize = 8;

fn tables(part: &Part) -> ChartTables {
    let mut milled: Vec<ChartTable> = part.faces().map(|id| face(part, id, SurfaceKind::Face(id))).collect();
    let sides = part.blade_ids().flat_map(|blade| part.sides(blade));
    milled.extend(sides.filter_map(|id| fillet(part, id, part.fillet(id)?.get())));
    milled.extend(part.passages().filter_map(|passage| hub(part, &passage)));
    ChartTables { milled, edges: part.blade_ids().flat_map(|blade| edges_of_blade(part, blade)).collect() }
}

/// Charts of all milled surfaces of sector 0.
pub fn charts(part: &Part) -> Vec<Chart<'_>> {
    part.chart_tables(tables).milled.iter().map(|table| Chart::new(part, table)).collect()
}

/// Charts of the edges of all blades of sector 0.
pub fn edges(part: &Part) -> impl Iterator<Item = Chart<'_>> {
    part.chart_tables(tables).edges.iter().map(|table| Chart::new(part, table))
}

/// Charts of the edges of a blade of sector 0 at inlet and outlet, between its faces.
pub fn edges_of(part: &Part, blade: BladeId) -> [Chart<'_>; 2] {
    [0, 1].map(|end| Chart::new(part, &part.chart_tables(tables).edges[2 * blade.index() + end]))
}

fn edges_of_blade(part: &Part, blade: BladeId) -> [ChartTable; 2] {
    [(SurfaceKind::InletEdge(blade), 0.0), (SurfaceKind::OutletEdge(blade), 1.0)].map(|(kind, u)| {
        if let Some(edge) = part.edge(blade, usize::from(u > 0.5)) {
            return face(part, edge, kind);
        }
        let ranges = blade.faces().map(|id| borders(part, id, u));
        ChartTable { kind, blade, form: ChartForm::Edge { blade, u, ranges } }
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
    let borders = rows().map(|u| borders(part, id, u)).collect();
    ChartTable { kind, blade: id.blade, form: ChartForm::Face { face: id, borders } }
}

fn fillet(part: &Part, id: FaceId, radius: f64) -> Option<ChartTable> {
    let face = part.face(id);
    let [from, to] = part.fillet_ends(id, radius);
    let ball = |u: f64| {
        let v = part.fillet_tangent(id, u, radius)?;
        let to_face = -face.normal(u, v);
        let centre = face.surface.point(u, v) - to_face * radius;
        Some([centre.coords, to_face, -hub_normal(part, &centre)])
    };
    let found: Vec<Option<[Vector3<f64>; 3]>> = rows().map(|x| ball(from + (to - from) * x)).collect();
    // Far beyond an end there may be no ball; the surface is the connected run of rows about the middle.
    let middle = ROWS / 2;
    found[middle]?;
    let first = (0..middle).rev().find(|i| found[*i].is_none()).map_or(0, |i| i + 1);
    let last = (middle..=ROWS).find(|i| found[*i].is_none()).unwrap_or(ROWS + 1);
    let balls: Vec<[Vector3<f64>; 3]> = found[first..last].iter().copied().flatten().collect();
    let u = [first, last - 1].map(|i| from + (to - from) * i as f64 / ROWS as f64);
    (balls.len() > 3).then_some(ChartTable {
        kind: SurfaceKind::Fillet(id),
        blade: id.blade,
        form: ChartForm::Fillet { radius, u, balls },
    })
}

fn hub(part: &Part, passage: &Passage) -> Option<ChartTable> {
    let opening = Opening::of(part, passage);
    let border = |i| opening.at(i as f64 / ROWS as f64).map(|[from, angle]| [from, angle.max(0.0)]);
    let borders: Option<Vec<[f64; 2]>> = (0..=ROWS).map(border).collect();
    Some(ChartTable {
        kind: SurfaceKind::Hub(passage.id),
        blade: BladeId::MAIN,
        form: ChartForm::Hub { borders: borders? },
    })
}

impl<'a> Chart<'a> {
    fn new(part: &'a Part, table: &'a ChartTable) -> Self {
        Self { kind: table.kind, part, extent: part.extent(table.blade), form: &table.form }
    }

    /// Point of an edge.
    fn on_edge(&self, blade: BladeId, u: f64, ranges: &[[f64; 2]; 2], x: f64, y: f64) -> Point3<f64> {
        let [p, s] = blade.faces().map(|id| {
            let [low, high] = ranges[id.index()];
            self.turned(id, u, low + (high - low) * x)
        });
        arc_between(&p, &s, y)
    }

    /// The end of the line of equal v of a face at u = 0 or 1, or its intersection with the inlet cone or the outlet
    /// cylinder, if this lies farther out: a straight ruling between two points of a cone is not on the cone.
    fn turned(&self, id: FaceId, u: f64, v: f64) -> Point3<f64> {
        let surface = &self.part.face(id).surface;
        let gap = |u: f64| self.extent.beyond(u.round().clamp(0.0, 1.0), &surface.point(u, v));
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
}

impl Shape for Chart<'_> {
    fn place(&self, x: f64, y: f64) -> Place {
        match self.form {
            ChartForm::Face { face, borders } => {
                let [low, high] = level(borders, x);
                let v = low + (high - low) * y;
                let face = self.part.face(*face);
                let (position, su, sv) = face.surface.tangents(x, v);
                let normal = su.cross(&sv).normalize() * face.orientation;
                Place { position, normal, parameters: [x, v] }
            }
            ChartForm::Fillet { radius, u, balls } => {
                let [centre, to_face, to_hub] = smooth(balls, x);
                let (to_face, to_hub) = (to_face.normalize(), to_hub.normalize());
                // From the face contact to the hub contact.
                let direction = great_arc(&to_face, &to_hub, y);
                let position = Point3::from(centre + direction * *radius);
                Place { position, normal: -direction, parameters: [u[0] + (u[1] - u[0]) * x, y] }
            }
            ChartForm::Hub { borders } => {
                let [from, angle] = level(borders, x);
                let azimuth = from + angle * y;
                let position = self.part.hub.point(x, azimuth);
                Place { position, normal: self.part.hub.normal(x, azimuth), parameters: [x, y] }
            }
            ChartForm::Edge { blade, u, ranges } => {
                /// Step of differences: their relative error over the thickness of a vane is below 1e-9.
                const STEP: f64 = 1e-5;
                let at = |x: f64, y: f64| self.on_edge(*blade, *u, ranges, x, y);
                let along = at(x + STEP, y) - at(x - STEP, y);
                let across = at(x, y + STEP) - at(x, y - STEP);
                let normal = along.cross(&across).normalize();
                // The outward normal points away from the other end of the vane.
                let (_, su, _) = self.part.blade(*blade).faces[0].surface.tangents(*u, 0.5);
                let outward = if *u > 0.5 { su } else { -su };
                let normal = if normal.dot(&outward) < 0.0 { -normal } else { normal };
                Place { position: at(x, y), normal, parameters: [x, y] }
            }
        }
    }

    /// Fillets end at the inlet cone and the outlet cylinder.
    fn is_milled(&self, position: &Point3<f64>) -> bool {
        !matches!(self.form, ChartForm::Fillet { .. }) || self.extent.holds(position)
    }
}

/// Index and share of x in a table of evenly spaced rows.
fn row(count: usize, x: f64) -> (usize, f64) {
    let at = x.clamp(0.0, 1.0) * (count - 1) as f64;
    let i = (at as usize).min(count.saturating_sub(2));
    (i, at - i as f64)
}

/// Linear interpolation, sufficient for borders, which only divide one surface from the next.
fn level(table: &[[f64; 2]], x: f64) -> [f64; 2] {
    let (i, t) = row(table.len(), x);
    let (a, b) = (&table[i], &table[i + 1]);
    [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t]
}

/// Cubic interpolation through four rows, for rows that define the surface itself.
fn smooth(table: &[[Vector3<f64>; 3]], x: f64) -> [Vector3<f64>; 3] {
    let (i, t) = row(table.len(), x);
    let start = i.saturating_sub(1).min(table.len() - 4);
    let t = t + (i - start) as f64;
    // Lagrange weights of the rows 0, 1, 2, 3.
    let w = [
        -(t - 1.0) * (t - 2.0) * (t - 3.0) / 6.0,
        t * (t - 2.0) * (t - 3.0) / 2.0,
        -t * (t - 1.0) * (t - 3.0) / 2.0,
        t * (t - 1.0) * (t - 2.0) / 6.0,
    ];
    std::array::from_fn(|k| (0..4).map(|j| table[start + j][k] * w[j]).sum())
}
