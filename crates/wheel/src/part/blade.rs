//! Blades of a row, their faces, and the names of faces.

use super::fillet::Fillet;
use super::surface::{FaceSurface, Surface};
use nalgebra::{Point3, Vector3};
use nurbs::NurbsCurve;
use nurbs::{LoftedSurface, RuledSurface};
use serde::{Deserialize, Serialize};

/// A blade of a sector. The first one is the main blade, the others are its splitters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct BladeId(u16);

impl BladeId {
    /// The main blade.
    pub const MAIN: Self = Self(0);

    /// The blade at an index of [`super::BladeRow::blades`].
    pub fn new(index: usize) -> Self {
        Self(u16::try_from(index).unwrap_or(u16::MAX))
    }

    /// Its index in [`super::BladeRow::blades`].
    pub fn index(self) -> usize {
        usize::from(self.0)
    }

    /// Its faces, the pressure face first.
    pub fn faces(self) -> [FaceId; 2] {
        [0, 1].map(|face| FaceId { blade: self, face })
    }

    /// Its leading (`end` 0) or trailing edge (1), where the edge is a surface of its own.
    pub(super) fn edge(self, end: usize) -> FaceId {
        FaceId { blade: self, face: if end == 0 { 2 } else { 3 } }
    }

    /// Its kind, and the suffix to the number of its sector: `vane 3`, `splitter 3.1`.
    pub(super) fn words(self) -> (&'static str, String) {
        if self == Self::MAIN { ("vane", String::new()) } else { ("splitter", format!(".{}", self.0)) }
    }
}

/// A face of a blade, or an edge that is a surface of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(try_from = "StoredFaceId")]
pub struct FaceId {
    /// Its blade.
    pub blade: BladeId,
    face: u8,
}

/// A name of a face that is read.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredFaceId {
    blade: BladeId,
    face: u8,
}

impl TryFrom<StoredFaceId> for FaceId {
    type Error = String;

    fn try_from(StoredFaceId { blade, face }: StoredFaceId) -> Result<Self, String> {
        let known = usize::from(face) < Self::NAMES.len() + Self::EDGES.len();
        if known { Ok(Self { blade, face }) } else { Err(format!("a blade has no face {face}")) }
    }
}

impl FaceId {
    /// Names of the two faces in the job language.
    pub const NAMES: [&'static str; 2] = ["pressure", "suction"];
    /// The pressure face of the main blade.
    pub const PRESSURE: Self = Self { blade: BladeId::MAIN, face: 0 };
    /// The suction face of the main blade.
    pub const SUCTION: Self = Self { blade: BladeId::MAIN, face: 1 };

    /// Names of the two edges.
    const EDGES: [&'static str; 2] = ["leading edge", "trailing edge"];

    /// Name in the job language.
    pub fn name(self) -> &'static str {
        match self.edge_end() {
            Some(end) => Self::EDGES[end],
            None => Self::NAMES[self.index()],
        }
    }

    /// Its index among the faces of its blade.
    pub fn index(self) -> usize {
        usize::from(self.face)
    }

    /// For an edge: 0 for the leading, 1 for the trailing edge.
    pub fn edge_end(self) -> Option<usize> {
        self.index().checked_sub(Self::NAMES.len())
    }

    /// The other face of its blade.
    #[must_use]
    pub fn other(self) -> Self {
        Self { face: self.face ^ 1, ..self }
    }
}

base::named! {
    /// End of a ruling.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum RulingEnd {
        /// At the hub.
        Root = "root",
        /// At the shroud.
        Tip = "tip",
    }
}

/// A face of a blade. Its material lies on the side opposite to the outward normal.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Face {
    /// The surface in sector 0.
    pub surface: FaceSurface,
    /// +1 when `S_u` x `S_v` points out of the material, else -1.
    pub orientation: f64,
}

impl Face {
    /// Point, and unit normal out of the material, sector 0.
    pub fn point_and_normal(&self, u: f64, v: f64) -> (Point3<f64>, Vector3<f64>) {
        let (point, su, sv) = self.surface.tangents(u, v);
        (point, su.cross(&sv).normalize() * self.orientation)
    }

    /// Unit normal out of the material, sector 0.
    pub fn normal(&self, u: f64, v: f64) -> Vector3<f64> {
        self.surface.normal(u, v) * self.orientation
    }
}

/// Curves of a face, from the hub to the shroud.
#[derive(Clone, Debug)]
pub struct Guides {
    /// Curve at the hub.
    pub root: NurbsCurve,
    /// Curve at the shroud.
    pub tip: NurbsCurve,
}

impl From<Guides> for FaceSurface {
    fn from(guides: Guides) -> Self {
        Self::Ruled(RuledSurface { root: guides.root, tip: guides.tip })
    }
}

impl From<LoftedSurface> for FaceSurface {
    fn from(surface: LoftedSurface) -> Self {
        Self::Lofted(surface)
    }
}

/// A blade of sector 0: the main blade, or a splitter.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Blade {
    /// Name in the job.
    pub name: String,
    /// Its faces, the pressure face first.
    pub faces: [Face; 2],
    /// Surfaces of its leading and trailing edge, u from the pressure (0) to the suction face (1). `None` for an edge that the
    /// lathe makes, between the ends of the faces.
    pub edges: [Option<Face>; 2],
    /// Fillet between blade and hub; `None` for a sharp root.
    #[serde(deserialize_with = "Deserialize::deserialize")]
    pub fillet: Option<Fillet>,
    /// Index of the face that looks ahead, counter-clockwise about Z.
    ahead: u8,
}

impl Blade {
    /// The blade between a pressure and a suction face. The side of the material and the face that looks ahead follow
    /// from the geometry.
    pub fn new(name: impl Into<String>, [pressure, suction]: [FaceSurface; 2], fillet: Option<Fillet>) -> Self {
        let (p, s) = (pressure.point(0.5, 0.5), suction.point(0.5, 0.5));
        // A face points away from the other face of its blade.
        let across = p - s;
        let sign = |x: f64| if x < 0.0 { -1.0 } else { 1.0 };
        let orientation = [sign(pressure.normal(0.5, 0.5).dot(&across)), sign(-suction.normal(0.5, 0.5).dot(&across))];
        // The suction face is ahead when the turn from pressure to suction is positive.
        let ahead = u8::from(p.x * s.y - p.y * s.x > 0.0);
        let [pressure, suction] = [(pressure, orientation[0]), (suction, orientation[1])]
            .map(|(surface, orientation)| Face { surface, orientation });
        let faces = [pressure, suction];
        let fillet = fillet.map(|fillet| fillet.at_foot(faces.each_ref().map(|face| &face.surface)));
        Self { name: name.into(), faces, edges: [None, None], fillet, ahead }
    }

    /// The blade with surfaces for its leading and trailing edge. The side of the material follows from the geometry.
    #[must_use]
    pub fn with_edges(self, edges: [Option<FaceSurface>; 2]) -> Self {
        let [p, s] = self.faces.each_ref().map(|face| face.surface.point(0.5, 0.5));
        let middle = nalgebra::center(&p, &s);
        let edges = edges.map(|edge| {
            edge.map(|surface| {
                let outward = surface.point(0.5, 0.5) - middle;
                let orientation = if surface.normal(0.5, 0.5).dot(&outward) < 0.0 { -1.0 } else { 1.0 };
                Face { surface, orientation }
            })
        });
        Self { edges, ..self }
    }

    /// The blade turned about Z by an angle in radians.
    #[must_use]
    pub fn rotated(&self, angle: f64) -> Self {
        let turned = |f: &Face| Face { surface: f.surface.rotated(angle), ..*f };
        let faces = self.faces.each_ref().map(turned);
        let edges = self.edges.each_ref().map(|edge| edge.as_ref().map(turned));
        Self { name: self.name.clone(), faces, edges, fillet: self.fillet.clone(), ..*self }
    }

    /// Index of the face that looks ahead, counter-clockwise about Z.
    pub(super) fn ahead(&self) -> usize {
        usize::from(self.ahead)
    }
}
