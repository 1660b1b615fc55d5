//! Kept surfaces: surfaces of the finished part that milling leaves as the lathe made them. No cutter may go into them.
//!
//! Together with the milled surfaces of [`super::chart`] these surfaces close the part.
//!
//! | surface | x | y |
//! |---|---|---|
//! | rim, back face, bore, nose | once around, from +X | along the meridian |
//! | tip, edge | as in [`super::chart`] | |
//! | root | from the hub to the edge | between the two fillets of the vane |

use super::chart::{self, Along, Chart, Patch, Place, Shape, charts};
use super::sheet::Sheet;
use super::turned_patch::TurnedPatch;
use super::{BladeId, Part, Stock, SurfaceKind};
use base::units::Mm;
use nalgebra::{Point3, Vector2, Vector3};
use nurbs::range::{CellThickness, Interval, Jet, turned};
use std::f64::consts::TAU;
use tool_stock::collide::CloudPoint;

/// Rows of a root, which is a few millimetres high.
const ROOT_ROWS: usize = 48;

/// Share of the height of the fillet by which a root continues above the fillet, so that no gap remains below the edge.
const ROOT_OVERLAP: f64 = 0.05;

/// Width of a ring, mm, below which the ring only results from rounding of the ends of hub and shroud.
const SLIVER: f64 = 1e-3;

/// A kept surface: the whole surface if it goes all around, else that of sector 0.
#[derive(Clone, Debug)]
pub struct Kept<'a> {
    /// Kind of the surface.
    pub kind: SurfaceKind,
    form: KeptForm<'a>,
}

#[derive(Clone, Debug)]
enum KeptForm<'a> {
    /// A straight line of the meridian plane, rotated once around, and its unit normal (r, z) out of the material.
    Ring { ends: [Vector2<f64>; 2], normal: Vector2<f64> },
    /// The chart of a surface that milling makes, in this job or in others.
    Chart(Chart<'a>),
    /// The patch from the pressure fillet to the suction fillet, and its unit normal (r, z).
    Root { patch: TurnedPatch, normal: Vector2<f64> },
}

/// Edges and tips of the blades that milling makes: these are design surfaces. The lathe makes the others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MilledTurned {
    /// The edges at the inlet, and those at the outlet.
    pub edges: [bool; 2],
    /// The tips.
    pub tips: bool,
}

impl MilledTurned {
    /// Charts of these surfaces, or of the others.
    pub fn charts(self, part: &Part, milled: bool) -> impl Iterator<Item = Chart<'_>> {
        let edges = chart::edges(part).filter(move |edge| {
            let end = usize::from(matches!(edge.kind, SurfaceKind::OutletEdge(_)));
            self.edges[end] == milled
        });
        let tips = (self.tips == milled).then(|| chart::tips(part));
        tips.into_iter().flatten().chain(edges)
    }
}

/// The turned surfaces that go all around: rim, back face, bore and nose.
pub fn rings<'a>(part: &Part, stock: &Stock) -> Vec<Kept<'a>> {
    let (inlet, outlet) = (part.hub.meridian(0.0).point, part.hub.meridian(1.0).point);
    let (bore, back) = (stock.bore_radius.get(), stock.back.get());
    let outside = stock.profile.last().map_or(outlet.x, |p| p[0]);
    let ring = |kind, from: [f64; 2], to: [f64; 2], normal: [f64; 2]| {
        let ends = [Vector2::from(from), Vector2::from(to)];
        let form = KeptForm::Ring { ends, normal: Vector2::from(normal) };
        ((ends[1] - ends[0]).norm() > SLIVER && from[0].max(to[0]) > 0.0).then_some(Kept { kind, form })
    };
    [
        ring(SurfaceKind::Rim, [outside, back], [outside, outlet.y], [1.0, 0.0]),
        // Where the blank is wider than the hub, the rim has a step at the height of the outlet.
        ring(SurfaceKind::Rim, [outside, outlet.y], [outlet.x, outlet.y], [0.0, 1.0]),
        ring(SurfaceKind::Back, [bore, back], [outside, back], [0.0, -1.0]),
        ring(SurfaceKind::Bore, [bore, inlet.y], [bore, back], [-1.0, 0.0]),
        ring(SurfaceKind::Nose, [inlet.x, inlet.y], [bore, inlet.y], [0.0, 1.0]),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Most samples of what stands beside the ends of the channels.
const MAX_BESIDE: f64 = 2e5;

/// Samples of what stands beside the ends of the channels, within `reach` of the inlet and the outlet of the hub, mm: the [`rings`] and the
/// clamping. With their spacing, which is `spacing` where these are not too many.
pub fn beside_ends(part: &Part, stock: &Stock, reach: f64, spacing: f64) -> (Vec<CloudPoint>, f64) {
    let hub = [0.0, 1.0].map(|end| part.hub.meridian(end).point);
    let near = |p: &Vector2<f64>| hub.iter().any(|end| (p - end).norm() <= reach);
    let ring_of = |ring: Kept<'_>| match ring.form {
        KeptForm::Ring { ends, normal } => Some((ends, normal)),
        KeptForm::Chart(_) | KeptForm::Root { .. } => None,
    };
    let mut lines: Vec<_> = rings(part, stock).into_iter().filter_map(ring_of).collect();
    let below = stock.clamping.below.get();
    let wide = stock.clamping.radius.map_or(hub[1].x.max(hub[0].x) + reach, Mm::get);
    lines.push(([Vector2::new(0.0, below), Vector2::new(wide, below)], Vector2::y()));
    lines.push(([Vector2::new(wide, below), Vector2::new(wide, below - reach)], Vector2::x()));
    // Rows of each line, and columns of each row.
    let places = |spacing: f64| -> Vec<(Vector2<f64>, Vector2<f64>, f64)> {
        let rows = |(ends, normal): &([Vector2<f64>; 2], Vector2<f64>)| {
            let (from, along, normal) = (ends[0], ends[1] - ends[0], *normal);
            let rows = (along.norm() / spacing).ceil().max(1.0);
            (0..=rows as u32).map(move |row| (from + along * (f64::from(row) / rows), normal))
        };
        let row = |(p, normal): (Vector2<f64>, Vector2<f64>)| (p, normal, (TAU * p.x / spacing).ceil().max(1.0));
        lines.iter().flat_map(rows).filter(|(p, _)| near(p)).map(row).collect()
    };
    let count: f64 = places(spacing).iter().map(|row| row.2).sum();
    let spacing = spacing * (count / MAX_BESIDE).sqrt().max(1.0);
    let samples = places(spacing).into_iter().flat_map(|(p, normal, columns)| {
        (0..columns as u32).map(move |column| {
            let at = place([p.x, p.y], TAU * f64::from(column) / columns, normal, [0.0; 2]);
            CloudPoint { position: at.position, normal: at.normal, tag: 0 }
        })
    });
    (samples.collect(), spacing)
}

/// All kept surfaces of a part that is milled from a blank, but for turned surfaces that operations finish.
///
/// Roots are missing where a fillet does not extend from inlet to outlet: there the part has no closed surface.
pub fn kept<'a>(part: &'a Part, stock: &Stock, milled: MilledTurned) -> Vec<Kept<'a>> {
    let mut all = rings(part, stock);
    all.extend(milled.charts(part, false).map(Kept::of));
    all.extend(roots(part));
    all
}

/// The milled surfaces of the part as kept surfaces: before finishing no cutter may touch them.
pub fn milled(part: &Part) -> Vec<Kept<'_>> {
    charts(part).into_iter().map(Kept::of).collect()
}

/// Roots at inlet and outlet; none without fillets, or where a fillet ends before inlet or outlet.
fn roots(part: &Part) -> Vec<Kept<'_>> {
    let rounded = |blade: &BladeId| part.blade(*blade).fillet.is_some();
    if !part.blade_ids().any(|blade| rounded(&blade)) {
        return Vec::new();
    }
    let charts = charts(part);
    part.blade_ids().filter(rounded).flat_map(|blade| roots_of(part, &charts, blade)).collect()
}

fn roots_of<'a>(part: &Part, charts: &[Chart<'_>], blade: BladeId) -> Vec<Kept<'a>> {
    let sheets = blade.faces().map(|id| Sheet::new(part, charts, id));
    let [Some(pressure), Some(suction)] = sheets else { return Vec::new() };
    let root = |(kind, end): (SurfaceKind, f64)| {
        if part.edge(blade, usize::from(end > 0.5)).is_some() {
            return None;
        }
        let row = |i: usize| -> Option<[Point3<f64>; 2]> {
            let w = (1.0 + ROOT_OVERLAP) * i as f64 / ROOT_ROWS as f64;
            let at = |sheet: &Sheet<'_>| Some(sheet.point(sheet.meets(end, w)?, w));
            Some([at(&pressure)?, at(&suction)?])
        };
        let [hub, shroud] = part.end_line(blade, end);
        let across = (shroud - hub).normalize();
        // The normal points away from the other end of the hub.
        let normal = Vector2::new(across.y, -across.x);
        let away = hub - part.end_line(blade, 1.0 - end)[0];
        let normal = if normal.dot(&away) < 0.0 { -normal } else { normal };
        let rows = (0..=ROOT_ROWS).map(row).collect::<Option<Vec<_>>>()?;
        Some(Kept { kind, form: KeptForm::Root { patch: TurnedPatch::between(&rows), normal } })
    };
    let ends = [(SurfaceKind::InletRoot(blade), 0.0), (SurfaceKind::OutletRoot(blade), 1.0)];
    ends.into_iter().filter_map(root).collect()
}

impl<'a> Kept<'a> {
    fn of(chart: Chart<'a>) -> Self {
        Self { kind: chart.kind, form: KeptForm::Chart(chart) }
    }
}

impl Kept<'_> {
    /// True for a surface that goes all around; other surfaces exist once per sector.
    pub fn is_ring(&self) -> bool {
        matches!(self.form, KeptForm::Ring { .. })
    }

    /// Coordinates along x or along y over a rectangle.
    fn jets(&self, along: Along, rectangle: [[f64; 2]; 2]) -> [Jet; 3] {
        let [x, y] = along.jets(rectangle);
        let varies = along == Along::X;
        match &self.form {
            KeptForm::Ring { ends: [from, to], .. } => {
                let [r, z] = [[from.x, to.x], [from.y, to.y]].map(|ends| {
                    let [from, to] = ends.map(|end| Jet::constant(Interval::of(end)));
                    from.towards(to, y)
                });
                turned([r, z], x * TAU)
            }
            KeptForm::Chart(chart) => chart.jets(along, rectangle, 0.0),
            KeptForm::Root { patch, .. } => patch.jets(rectangle[0], varies, y),
        }
    }

    /// Middle of a patch, and a radius that contains the patch, mm; `None` where these are not known in closed form.
    pub fn ball(&self, patch: &Patch) -> Option<(Point3<f64>, f64)> {
        let KeptForm::Ring { ends, .. } = &self.form else { return None };
        let [x, y] = [patch.x, patch.y].map(|range| 0.5 * (range[0] + range[1]));
        let half = |range: [f64; 2]| 0.5 * (range[1] - range[0]);
        let widest = ends[0].x.max(ends[1].x);
        let radius = libm::hypot(half(patch.x) * TAU * widest, half(patch.y) * (ends[1] - ends[0]).norm());
        Some((self.place(x, y).position, radius))
    }
}

/// A place of a surface of revolution.
fn place([r, z]: [f64; 2], azimuth: f64, normal: Vector2<f64>, parameters: [f64; 2]) -> Place {
    let (sin, cos) = libm::sincos(azimuth);
    Place {
        position: Point3::new(r * cos, r * sin, z),
        normal: Vector3::new(normal.x * cos, normal.x * sin, normal.y),
        parameters,
    }
}

impl Shape for Kept<'_> {
    fn place(&self, x: f64, y: f64) -> Place {
        match &self.form {
            KeptForm::Ring { ends: [from, to], normal } => {
                let p = from + (to - from) * y;
                place([p.x, p.y], TAU * x, *normal, [x, y])
            }
            KeptForm::Chart(chart) => chart.place(x, y),
            KeptForm::Root { patch, normal } => {
                let [r, z, azimuth] = patch.at(x, y);
                place([r, z], azimuth, *normal, [x, y])
            }
        }
    }

    fn thickness(&self, rectangle: [[f64; 2]; 2]) -> CellThickness {
        chart::thickness(rectangle, |along| self.jets(along, rectangle))
    }

    fn is_milled(&self, xy: [f64; 2], position: &Point3<f64>) -> bool {
        if let KeptForm::Chart(chart) = &self.form { chart.is_milled(xy, position) } else { true }
    }
}
