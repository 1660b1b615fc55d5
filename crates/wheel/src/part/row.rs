//! The design part: a row of blades between hub and shroud.

use super::blade::{Blade, BladeId, Face, FaceId, Guides};
use super::chart_table::ChartTables;
use super::fillet::Fillet;
use super::names::PassageId;
use super::passage::{Passage, WholeWall};
use super::surface::{FaceSurface, Surface};
use base::units::Mm;
use nalgebra::{Point3, Rotation3, Vector2, Vector3};
use nurbs::{NurbsCurve, Revolution};
use serde::{Deserialize, Serialize, Serializer};
use std::sync::OnceLock;

/// Most sectors of a part that is read: as many as a job may have.
const MAX_VANES: u32 = 10_000;

/// Most blades of a sector of a part that is read; more have no ids.
const MAX_BLADES: usize = 1000;

/// The design part. Sector k is sector 0 rotated about Z by k pitches (Wei 18). Its row cannot be changed, since the
/// charts are made from it once.
#[derive(Clone, Debug, Deserialize)]
#[serde(try_from = "BladeRow")]
pub struct Part {
    row: BladeRow,
    charts: OnceLock<ChartTables>,
    walls: OnceLock<Vec<[WholeWall; 2]>>,
}

/// Blades of a sector between hub and shroud.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BladeRow {
    /// Number of sectors, and therefore of main blades.
    pub vane_count: u32,
    /// Blades of sector 0: the main blade, then its splitters counter-clockwise, less than a pitch ahead of it.
    pub blades: Vec<Blade>,
    /// Hub: outward normal points into the channel.
    pub hub: Revolution,
    /// Surface of the blade tips.
    pub shroud: Revolution,
}

/// The row defines the part: its tables are made again.
impl Serialize for Part {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.row.serialize(serializer)
    }
}

impl TryFrom<BladeRow> for Part {
    type Error = &'static str;

    fn try_from(row: BladeRow) -> Result<Self, Self::Error> {
        if !(2..=MAX_VANES).contains(&row.vane_count) || !(1..=MAX_BLADES).contains(&row.blades.len()) {
            return Err("a part needs two sectors or more with a blade in each, and has no more than 10000 sectors");
        }
        let sides = |blade: &Blade| {
            let faces = blade.faces.iter().chain(blade.edges.iter().flatten());
            faces.map(|face| face.orientation).all(|side| side.abs() == 1.0) && blade.ahead() < blade.faces.len()
        };
        if row.blades.iter().all(sides) { Ok(Self::of(row)) } else { Err("a face of a blade has no outside") }
    }
}

impl std::ops::Deref for Part {
    type Target = BladeRow;

    fn deref(&self) -> &BladeRow {
        &self.row
    }
}

impl Part {
    /// The part from guide curves of a vane; hub and shroud are surfaces of revolution of curves of the vane. The
    /// orientation of the faces and the order of the walls follow from the geometry.
    pub fn new(
        vane_count: u32,
        pressure: Guides,
        suction: Guides,
        hub: NurbsCurve,
        shroud: NurbsCurve,
        fillet: Option<Mm>,
    ) -> Self {
        let faces = [FaceSurface::from(pressure), FaceSurface::from(suction)];
        Self::with_blades(vane_count, Blade::new("main", faces, fillet.map(Fillet::from)), Vec::new(), hub, shroud)
    }

    /// The part of a main blade and its splitters, in any order.
    pub fn with_blades(
        vane_count: u32,
        main: Blade,
        mut splitters: Vec<Blade>,
        hub: NurbsCurve,
        shroud: NurbsCurve,
    ) -> Self {
        let meridian = |q: Point3<f64>| Vector2::new(libm::hypot(q.x, q.y), q.z);
        let pressure = &main.faces[0].surface;
        let outside = meridian(pressure.point(0.5, 1.0));
        // A point beyond the tips by the height of the vane.
        let beyond = meridian(pressure.point(0.5, 2.0));
        let from = main.faces[0].surface.point(1.0, 0.5);
        splitters.sort_by(|a, b| {
            let [a, b] = [a, b].map(|blade| ahead_of(&from, &blade.faces[0].surface.point(1.0, 0.5)));
            a.total_cmp(&b)
        });
        let row = BladeRow {
            vane_count,
            hub: Revolution::new(hub, outside),
            shroud: Revolution::new(shroud, beyond),
            blades: std::iter::once(main).chain(splitters).collect(),
        };
        Self::of(row)
    }

    /// A part whose tables are made on first use.
    fn of(row: BladeRow) -> Self {
        Self { row, charts: OnceLock::new(), walls: OnceLock::new() }
    }

    /// The same part with sharp roots.
    #[must_use]
    pub fn without_fillets(&self) -> Self {
        let mut row = self.row.clone();
        row.blades.iter_mut().for_each(|blade| blade.fillet = None);
        Self::of(row)
    }

    /// The same part with another fillet of the main blade.
    #[must_use]
    pub fn with_fillet(&self, fillet: Option<Mm>) -> Self {
        let mut row = self.row.clone();
        row.blades[0].fillet = fillet.map(Fillet::from);
        Self::of(row)
    }

    /// Tables of the charts of sector 0. `make` makes them at the first call, outside of the lock: it works in several threads, and
    /// one that waits for the lock could not help it.
    pub(super) fn chart_tables(&self, make: impl FnOnce(&Self) -> ChartTables) -> &ChartTables {
        if let Some(made) = self.charts.get() {
            return made;
        }
        let made = make(self);
        self.charts.get_or_init(|| made)
    }

    /// Share of the height at a point: its distance from the hub over the sum of its distances from hub and shroud. 0 on
    /// the hub and below it, 1 on the shroud and above it.
    pub fn height(&self, p: &Point3<f64>) -> f64 {
        let over_hub = self.hub.distance(p).max(0.0);
        let under_shroud = (-self.shroud.distance(p)).max(0.0);
        if under_shroud > 0.0 { over_hub / (over_hub + under_shroud) } else { 1.0 }
    }

    /// Angle between neighbouring main blades, radians.
    pub fn pitch(&self) -> f64 {
        std::f64::consts::TAU / f64::from(self.vane_count)
    }

    /// Rotation of sector 0 into a sector.
    pub fn sector_rotation(&self, sector: u32) -> Rotation3<f64> {
        Rotation3::from_axis_angle(&Vector3::z_axis(), self.pitch() * f64::from(sector))
    }

    /// The main blade.
    pub fn main(&self) -> &Blade {
        &self.blades[0]
    }

    /// Blades of a sector.
    pub fn blade_ids(&self) -> impl Iterator<Item = BladeId> + use<> {
        (0..self.blades.len()).map(BladeId::new)
    }

    /// A blade of sector 0.
    pub fn blade(&self, id: BladeId) -> &Blade {
        &self.blades[id.index()]
    }

    /// Faces of all blades of a sector.
    pub fn faces(&self) -> impl Iterator<Item = FaceId> + use<> {
        self.blade_ids().flat_map(BladeId::faces)
    }

    /// The leading (`end` 0) or trailing edge (1) of a blade, where it is a surface of its own.
    pub fn edge(&self, blade: BladeId, end: usize) -> Option<FaceId> {
        self.blade(blade).edges[end].as_ref().map(|_| blade.edge(end))
    }

    /// True for a face of a blade of the part, and for an edge that is a surface of its own.
    pub fn has_face(&self, id: FaceId) -> bool {
        let edge = |end: usize| self.blades[id.blade.index()].edges[end].is_some();
        id.blade.index() < self.blades.len() && id.edge_end().is_none_or(edge)
    }

    /// Faces of a blade, and its edges that are surfaces of their own.
    pub fn sides(&self, blade: BladeId) -> impl Iterator<Item = FaceId> + '_ {
        blade.faces().into_iter().chain([0, 1].into_iter().filter_map(move |end| self.edge(blade, end)))
    }

    /// Parts of the outline of a blade along one of its faces, from the middle of the leading to the middle of the trailing
    /// edge: surfaces with their ranges of u.
    pub(super) fn along(&self, face: FaceId, middles: [f64; 2]) -> Vec<(FaceId, [f64; 2])> {
        // Edges run from the pressure to the suction face.
        let side = face.index() as f64;
        let mut parts = vec![(face, [0.0, 1.0])];
        if let Some(leading) = self.edge(face.blade, 0) {
            parts.insert(0, (leading, [middles[0], side]));
        }
        parts.extend(self.edge(face.blade, 1).map(|trailing| (trailing, [side, middles[1]])));
        parts
    }

    /// The surface and its u at a share of the outline along a face, from the middle of the leading edge to that of the
    /// trailing edge. Half an edge takes a tenth.
    pub(super) fn outline_place(&self, face: FaceId, share: f64) -> (FaceId, f64) {
        const EDGE: f64 = 0.1;
        let parts = self.along(face, [0.5; 2]);
        let whole: f64 = parts.iter().map(|(id, _)| if id.edge_end().is_some() { EDGE } else { 1.0 }).sum();
        let mut before = 0.0;
        for (k, (id, [from, to])) in parts.iter().enumerate() {
            let own = if id.edge_end().is_some() { EDGE } else { 1.0 };
            let t = share * whole - before;
            if t <= own || k + 1 == parts.len() {
                return (*id, from + (to - from) * (t / own).clamp(0.0, 1.0));
            }
            before += own;
        }
        (face, share)
    }

    /// A face in sector 0, or an edge that is a surface of its own.
    pub fn face(&self, id: FaceId) -> &Face {
        let blade = self.blade(id.blade);
        // An edge without a surface has no identifier.
        id.edge_end().and_then(|end| blade.edges[end].as_ref()).unwrap_or(&blade.faces[id.index() % blade.faces.len()])
    }

    /// The fillet at the foot of a face.
    pub fn fillet(&self, face: FaceId) -> Option<&Fillet> {
        self.blade(face.blade).fillet.as_ref()
    }

    /// Radius of the fillet at u of a face, or of an edge that is a surface of its own, mm.
    pub fn fillet_radius(&self, face: FaceId, u: f64) -> Option<f64> {
        let fillet = self.fillet(face)?;
        Some(face.edge_end().map_or_else(|| fillet.at(face.index(), u), |end| fillet.at_edge(end)))
    }

    /// The face of a blade that looks ahead, counter-clockwise about Z.
    pub fn face_ahead(&self, blade: BladeId) -> FaceId {
        blade.faces()[self.blade(blade).ahead()]
    }

    /// True for a face that looks ahead, counter-clockwise about Z: the first wall of its passage.
    pub fn looks_ahead(&self, face: FaceId) -> bool {
        self.face_ahead(face.blade) == face
    }

    /// Passages of a sector, counter-clockwise from the main blade.
    pub fn passages(&self) -> impl Iterator<Item = Passage> + '_ {
        (0..self.blades.len()).map(|k| self.passage(PassageId::new(k)))
    }

    /// The passage that follows the main blade.
    pub fn first_passage(&self) -> Passage {
        self.passage(PassageId::FIRST)
    }

    /// A passage of a sector: it follows the blade with its index.
    pub fn passage(&self, id: PassageId) -> Passage {
        let next = (id.index() + 1) % self.blades.len();
        Passage {
            id,
            walls: [self.face_ahead(BladeId::new(id.index())), self.face_ahead(BladeId::new(next)).other()],
            sectors: u32::from(next == 0),
        }
    }

    /// The angle from the sector of the first wall of a passage to that of the second, radians.
    pub fn turn(&self, passage: &Passage) -> f64 {
        self.pitch() * f64::from(passage.sectors)
    }

    /// The passage and the side (0 for the clockwise wall) of a face.
    pub fn passage_of(&self, face: FaceId) -> (PassageId, usize) {
        let found = self.passages().find_map(|p| Some((p.id, p.walls.iter().position(|wall| *wall == face)?)));
        found.unwrap_or((PassageId::FIRST, 0))
    }

    /// Walls of all passages from inlet to outlet. `make` makes them at the first call; it must not wait for other threads.
    pub(super) fn whole_walls(&self, make: impl FnOnce(&Self) -> Vec<[WholeWall; 2]>) -> &[[WholeWall; 2]] {
        self.walls.get_or_init(|| make(self))
    }

    /// The wall on the other side of the passage of a face, and the angle about Z from its place in sector 0.
    pub fn opposite(&self, face: FaceId) -> (FaceId, f64) {
        let facing = self.passages().find_map(|p| match p.walls {
            [a, b] if a == face => Some((b, self.pitch() * f64::from(p.sectors))),
            [a, b] if b == face => Some((a, -self.pitch() * f64::from(p.sectors))),
            _ => None,
        });
        facing.unwrap_or((face.other(), 0.0))
    }
}

/// Angle about Z from one point ahead to another, from 0 to a whole turn.
fn ahead_of(from: &Point3<f64>, to: &Point3<f64>) -> f64 {
    (libm::atan2(to.y, to.x) - libm::atan2(from.y, from.x)).rem_euclid(std::f64::consts::TAU)
}
