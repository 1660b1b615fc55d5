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
//! | tip | along the blade, from the middle of an edge to that of the other | from the pressure face to the suction face, on the
//! shroud |

use super::chart_table::{ChartForm, ChartTable};
use super::charting::tables;
use super::rolling_ball::FilletArc;
use super::{BladeId, Extent, Face, Part, Surface, SurfaceKind};
use nalgebra::{Point3, Vector3};
use nurbs::angle::great_arc;
use nurbs::range::{self, CellThickness, Interval, Jet};
use std::array::from_fn;

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

impl Place {
    /// The place of a face at u, at a share of the way between the v of its borders.
    pub(super) fn on_face(face: &Face, u: f64, [low, high]: [f64; 2], share: f64) -> Self {
        let v = low + (high - low) * share;
        let (position, normal) = face.point_and_normal(u, v);
        Self { position, normal, parameters: [u, v] }
    }

    /// The place of a fillet at u, at a share of its arc there.
    pub(super) fn on_fillet(arc: &FilletArc, u: f64, share: f64) -> Self {
        let direction = arc.direction(share);
        Self { position: arc.centre + direction * arc.radius, normal: -direction, parameters: [u, share] }
    }
}

/// A parameter of a chart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Along {
    /// x.
    X,
    /// y.
    Y,
}

impl Along {
    /// x and y of a rectangle as jets: one varies, the other is somewhere in its range.
    pub fn jets(self, [x, y]: [[f64; 2]; 2]) -> [Jet; 2] {
        [Jet::varying(x, self == Self::X), Jet::varying(y, self == Self::Y)]
    }
}

/// Thickness over a rectangle of a surface, of its coordinates along x and along y.
pub(super) fn thickness(rectangle: [[f64; 2]; 2], coordinates: impl Fn(Along) -> [Jet; 3]) -> CellThickness {
    let [x, y] = [(Along::X, rectangle[0]), (Along::Y, rectangle[1])]
        .map(|(along, [from, to])| CellThickness::of(&coordinates(along), 0.5 * (to - from)));
    CellThickness::of_surface([x, y])
}

/// A surface as the image of the unit square.
pub trait Shape: Sync {
    /// The place of (x, y), both in [0, 1].
    fn place(&self, x: f64, y: f64) -> Place;

    /// True when the place of (x, y), which lies at `position`, belongs to the part.
    fn is_milled(&self, _xy: [f64; 2], _position: &Point3<f64>) -> bool {
        true
    }

    /// How far the surface lies from the biquadratic through nine points of a rectangle: its corners, the middles of its sides and
    /// its middle. Proved by the ranges of the derivatives.
    fn thickness(&self, rectangle: [[f64; 2]; 2]) -> CellThickness;

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

/// Charts of all milled surfaces of sector 0.
pub fn charts(part: &Part) -> Vec<Chart<'_>> {
    part.chart_tables(tables).milled.iter().map(|table| Chart::new(part, table)).collect()
}

/// Charts of the edges of all blades of sector 0.
pub fn edges(part: &Part) -> impl Iterator<Item = Chart<'_>> {
    part.chart_tables(tables).edges.iter().map(|table| Chart::new(part, table))
}

/// Charts of the tips of all blades of sector 0.
pub fn tips(part: &Part) -> impl Iterator<Item = Chart<'_>> {
    part.chart_tables(tables).tips.iter().map(|table| Chart::new(part, table))
}

/// Charts of the edges of a blade of sector 0 at inlet and outlet, between its faces.
pub fn edges_of(part: &Part, blade: BladeId) -> [Chart<'_>; 2] {
    [0, 1].map(|end| Chart::new(part, &part.chart_tables(tables).edges[2 * blade.index() + end]))
}

impl<'a> Chart<'a> {
    fn new(part: &'a Part, table: &'a ChartTable) -> Self {
        Self { kind: table.kind, part, extent: part.extent(table.blade), form: &table.form }
    }

    /// As [`Shape::thickness`], for the surface that lies at a distance from this one along its normal, mm. Known for faces and
    /// fillets, and for other surfaces at no distance.
    pub fn moved_thickness(&self, rectangle: [[f64; 2]; 2], distance: f64) -> CellThickness {
        thickness(rectangle, |along| self.jets(along, rectangle, distance))
    }

    /// Coordinates along x or along y over a rectangle, of the surface at a distance along the normal, mm. Unknown as for
    /// [`Self::moved_thickness`].
    pub fn jets(&self, along: Along, rectangle: [[f64; 2]; 2], distance: f64) -> [Jet; 3] {
        let [x, y] = along.jets(rectangle);
        let varies = along == Along::X;
        match self.form {
            ChartForm::Face { face, borders } => {
                let [low, high] = borders.jets(rectangle[0], varies);
                let v = low.towards(high, y);
                let face = self.part.face(*face);
                let partials = face.surface.partials(rectangle[0], v.orders[0].into());
                let position = partials.along(&x, &v);
                if distance == 0.0 {
                    return position;
                }
                let normal = partials.normal(&x, &v);
                from_fn(|k| position[k] + normal[k] * (face.orientation * distance))
            }
            ChartForm::Fillet { radius, balls, .. } => {
                let [a, b, c, d, e, f, g, h, i] = balls.jets(rectangle[0], varies);
                let direction = range::great_arc(&[d, e, f], &[g, h, i], y);
                let centre = [a, b, c];
                from_fn(|k| centre[k] + direction[k] * (radius - distance))
            }
            ChartForm::VariedFillet { balls, .. } => {
                let [a, b, c, d, e, f, g, h, i, p, q, r, level, radius] = balls.jets(rectangle[0], varies);
                let direction = range::great_arc(&[d, e, f], &[g, h, i], y);
                let (centre, tilt) = ([a, b, c], [p, q, r]);
                let reach = radius - Jet::constant(Interval::of(distance));
                from_fn(|k| centre[k] + (tilt[k] + direction[k] * level) * reach)
            }
            ChartForm::Hub { borders } if distance == 0.0 => {
                let [from, angle] = borders.jets(rectangle[0], varies);
                range::turned(self.part.hub.meridian_jets(&x), from + angle * y)
            }
            ChartForm::Edge { patch, .. } if distance == 0.0 => patch.jets(rectangle[0], varies, y),
            ChartForm::Tip { borders } if distance == 0.0 => {
                let [u, azimuth, other_u, other_azimuth] = borders.jets(rectangle[0], varies);
                let meridian = self.part.shroud.meridian_jets(&u.towards(other_u, y));
                range::turned(meridian, azimuth.towards(other_azimuth, y))
            }
            ChartForm::Hub { .. } | ChartForm::Edge { .. } | ChartForm::Tip { .. } => [Jet::UNKNOWN; 3],
        }
    }
}

impl Chart<'_> {
    /// Radius of the ball that rolls in a fillet at x, mm; `None` for other surfaces.
    pub fn fillet_radius(&self, x: f64) -> Option<f64> {
        match self.form {
            ChartForm::Fillet { radius, .. } => Some(*radius),
            ChartForm::VariedFillet { balls, .. } => Some(balls.at(x)[13]),
            _ => None,
        }
    }
}

impl Shape for Chart<'_> {
    fn place(&self, x: f64, y: f64) -> Place {
        match self.form {
            ChartForm::Face { face, borders } => Place::on_face(self.part.face(*face), x, borders.at(x), y),
            ChartForm::Fillet { radius, u, balls } => {
                let ball = balls.at(x);
                let [centre, to_face, to_hub] = [0, 3, 6].map(|k| Vector3::new(ball[k], ball[k + 1], ball[k + 2]));
                let (to_face, to_hub) = (to_face.normalize(), to_hub.normalize());
                // From the face contact to the hub contact.
                let direction = great_arc(&to_face, &to_hub, y);
                let position = Point3::from(centre + direction * *radius);
                Place { position, normal: -direction, parameters: [u[0] + (u[1] - u[0]) * x, y] }
            }
            ChartForm::VariedFillet { u, balls } => {
                let ball = balls.at(x);
                let [centre, to_face, to_hub, tilt] =
                    [0, 3, 6, 9].map(|k| Vector3::new(ball[k], ball[k + 1], ball[k + 2]));
                let ends = [to_face.normalize(), to_hub.normalize()];
                let [level, radius] = [ball[12], ball[13]];
                let arc = FilletArc { centre: centre.into(), radius, tilt, level, ends };
                Place::on_fillet(&arc, u[0] + (u[1] - u[0]) * x, y)
            }
            ChartForm::Hub { borders } => {
                let [from, angle] = borders.at(x);
                let azimuth = from + angle * y;
                let position = self.part.hub.point(x, azimuth);
                Place { position, normal: self.part.hub.normal(x, azimuth), parameters: [x, y] }
            }
            ChartForm::Edge { blade, u, patch } => {
                /// Step of differences: their relative error over the thickness of a vane is below 1e-9.
                const DIFFERENCE_STEP: f64 = 1e-5;
                let at = |x: f64, y: f64| patch.point(x, y);
                let along = at(x + DIFFERENCE_STEP, y) - at(x - DIFFERENCE_STEP, y);
                let across = at(x, y + DIFFERENCE_STEP) - at(x, y - DIFFERENCE_STEP);
                let normal = along.cross(&across).normalize();
                // The outward normal points away from the other end of the vane.
                let (_, su, _) = self.part.blade(*blade).faces[0].surface.tangents(*u, 0.5);
                let outward = if *u > 0.5 { su } else { -su };
                let normal = if normal.dot(&outward) < 0.0 { -normal } else { normal };
                Place { position: at(x, y), normal, parameters: [x, y] }
            }
            ChartForm::Tip { borders } => {
                let [u, azimuth, other_u, other_azimuth] = borders.at(x);
                let (u, azimuth) = (u + (other_u - u) * y, azimuth + (other_azimuth - azimuth) * y);
                let normal = self.part.shroud.normal(u, azimuth);
                Place { position: self.part.shroud.point(u, azimuth), normal, parameters: [x, y] }
            }
        }
    }

    fn thickness(&self, rectangle: [[f64; 2]; 2]) -> CellThickness {
        self.moved_thickness(rectangle, 0.0)
    }

    /// Fillets end at the inlet cone and the outlet cylinder.
    fn is_milled(&self, _: [f64; 2], position: &Point3<f64>) -> bool {
        !matches!(self.form, ChartForm::Fillet { .. } | ChartForm::VariedFillet { .. }) || self.extent.holds(position)
    }
}
