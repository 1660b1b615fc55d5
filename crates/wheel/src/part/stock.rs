//! The turned blank, what is left of it at the start, and its clamping.

use super::{Part, TurnedProfile};
use crate::material::Material;
use base::units::Mm;
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use tool_stock::collide::{Section, ToolSolid};
use tool_stock::stock::mesh::halves;
use tool_stock::stock::{Field, FieldError, Mesh};

/// Turned blank: the result of the lathe. Milling removes the space between its outside and the part.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stock {
    /// Outside, as a closed profile in the meridian plane of (r, z) points from the bore over front, inlet, shroud and
    /// outlet to the back; straight between the points.
    pub profile: TurnedProfile,
    /// Thickness of the stock over the vane tips, by which the shroud is offset outward.
    pub over_shroud: Mm,
    /// Radius of the bore.
    pub bore_radius: Mm,
    /// Height of the back face.
    pub back: Mm,
    /// What is left of the blank before the first operation, as a closed mesh; `None` is all of it. What stands outside
    /// of the profile does not count.
    #[serde(with = "left")]
    pub left: Option<Arc<Mesh>>,
    /// Clamping of the blank.
    pub clamping: Clamping,
    /// Material, where the job states it.
    #[serde(deserialize_with = "Deserialize::deserialize")]
    pub material: Option<Material>,
}

/// What is left of a blank, as data: a closed mesh.
mod left {
    use super::{Arc, Deserialize, Mesh, Serialize};
    use serde::de::Error;
    use serde::{Deserializer, Serializer};

    pub(super) fn serialize<S: Serializer>(left: &Option<Arc<Mesh>>, serializer: S) -> Result<S::Ok, S::Error> {
        left.as_deref().serialize(serializer)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Arc<Mesh>>, D::Error> {
        let mesh = Option::<Mesh>::deserialize(deserializer)?;
        match mesh {
            Some(mesh) if !(mesh.is_closed() && mesh.volume() > 0.0) => {
                Err(D::Error::custom("what is left of the blank is no closed mesh with its outside outward"))
            }
            mesh => Ok(mesh.map(Arc::new)),
        }
    }
}

/// Greatest depth of pieces of a triangle, for the search for its farthest point: 2^-12 of a triangle across a blank is
/// less than a tenth of a millimetre.
const MAX_HALVINGS: u32 = 24;

/// Space of chuck and table: a cylinder about Z without a lower end, which no part of a tool may enter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Clamping {
    /// Its height.
    pub below: Mm,
    /// Its radius; `None` for everything below the height.
    #[serde(deserialize_with = "Deserialize::deserialize")]
    pub radius: Option<Mm>,
    /// True when the job does not state the clamping: everything below the back face.
    pub by_default: bool,
}

impl Clamping {
    /// True when shank and holder of a tool with this tip and unit axis are over the clamping or outside of its radius. Each of their
    /// sections is replaced by a cylinder around it, so that a tilted one may be refused although it is clear.
    pub fn clears_body(&self, solid: &ToolSolid, tip: &Point3<f64>, axis: &Vector3<f64>) -> bool {
        let level = libm::hypot(axis.x, axis.y);
        let rings = |x: &Section| [(x.from, x.radius_from), (x.to, x.radius_to)];
        let centre = |s: f64| -> Point3<f64> { tip + axis * s };
        let over = |(s, r): (f64, f64)| centre(s).z - r * level >= self.below.get();
        let clears_cylinder = |x: &Section, radius: f64| {
            // The nearest point of the axis of the section to the axis of the part.
            let [from, to] = [x.from, x.to].map(centre);
            let (a, along) = (from.coords.xy(), (to - from).xy());
            let square = along.norm_squared();
            let t = if square > 0.0 { (-a.dot(&along) / square).clamp(0.0, 1.0) } else { 0.0 };
            (a + along * t).norm() - x.radius_from.max(x.radius_to) >= radius
        };
        let mut sections = solid.shank.iter().chain(&solid.holder);
        sections.all(|x| rings(x).into_iter().all(over) || self.radius.is_some_and(|r| clears_cylinder(x, r.get())))
    }
}

/// Pieces of the turned profile along the shroud: their chords deviate by less than 1 um from the meridian of a vane.
const SHROUD_PIECES: usize = 200;

impl Stock {
    /// The blank that is turned to the shroud plus `over`, to the inlet line between hub and shroud and to the outlet
    /// radius, with a flat front face at the inlet of the hub. With an axial outlet it is turned to the outlet line, and has
    /// the radius of the hub below it.
    pub fn turned(part: &Part, over: Mm, bore_radius: Mm, back: Mm) -> Self {
        let hub = part.hub.meridian(0.0).point;
        let mut profile = vec![[bore_radius.get(), back.get()], [bore_radius.get(), hub.y], [hub.x, hub.y]];
        for i in 0..=SHROUD_PIECES {
            let u = i as f64 / SHROUD_PIECES as f64;
            let p = part.shroud.meridian(u).point + part.shroud.meridian_normal(u) * over.get();
            profile.push([p.x, p.y]);
        }
        let foot = part.hub.meridian(1.0).point;
        let outlet = if part.axial_outlet() { foot.x } else { foot.x.max(profile.last().map_or(0.0, |p| p[0])) };
        profile.push([outlet, foot.y]);
        profile.push([outlet, back.get()]);
        let clamping = Clamping { below: back, radius: None, by_default: true };
        let profile = TurnedProfile::new(profile);
        Self { profile, over_shroud: over, bore_radius, back, left: None, clamping, material: None }
    }

    /// The material before the first operation, on rays in cells of this edge, mm.
    ///
    /// # Errors
    /// [`FieldError`].
    pub fn field(&self, cell: f64) -> Result<Field, FieldError> {
        Field::new(&self.profile, self.left.as_deref(), cell)
    }

    /// Distance of a point to the outside of the turned blank, mm; negative inside of it.
    pub fn distance(&self, p: &Point3<f64>) -> f64 {
        self.profile.distance([libm::hypot(p.x, p.y), p.z])
    }

    /// The sphere about the blank whose centre lies on Z at half of the height: height of the centre and radius, mm.
    pub fn sphere(&self) -> [f64; 2] {
        let heights = || self.profile.iter().map(|p| p[1]);
        let centre = 0.5 * (heights().fold(f64::INFINITY, f64::min) + heights().fold(f64::NEG_INFINITY, f64::max));
        [centre, self.profile.iter().map(|p| libm::hypot(p[0], p[1] - centre)).fold(0.0, f64::max)]
    }

    /// Place of what is left that stands farthest out of the turned blank, with its distance, mm, when this is more than
    /// `most`. Found to a tenth of `most`.
    pub fn farthest_out(&self, most: f64) -> Option<(Point3<f64>, f64)> {
        let mesh = self.left.as_ref()?;
        let corners = mesh.vertices.par_iter().map(|p| (*p, self.distance(p)));
        let farther = |a: (Point3<f64>, f64), b: (Point3<f64>, f64)| if b.1 > a.1 { b } else { a };
        let worst = corners.reduce(|| (Point3::origin(), f64::NEG_INFINITY), farther);
        if worst.1 > most {
            return Some(worst);
        }
        // All corners are near the blank, so the triangles are not larger than it.
        let triangles = mesh.triangles.par_iter().map(|t| t.map(|i| mesh.vertices[i as usize]));
        let found = triangles.filter_map(|t| self.out_between(&t, most, MAX_HALVINGS));
        found.reduce_with(farther)
    }

    /// A place of a triangle farther out than `most`: the middle of a piece, in which no distance differs from that of the
    /// middle by more than the radius of the piece.
    fn out_between(&self, corners: &[Point3<f64>; 3], most: f64, halvings: u32) -> Option<(Point3<f64>, f64)> {
        let [a, b, c] = corners;
        let middle = Point3::from((a.coords + b.coords + c.coords) / 3.0);
        let radius = corners.iter().map(|p| (p - middle).norm()).fold(0.0, f64::max);
        let distance = self.distance(&middle);
        if distance > most {
            return Some((middle, distance));
        }
        if distance + radius <= most || radius < 0.1 * most || halvings == 0 {
            return None;
        }
        halves(corners).iter().find_map(|half| self.out_between(half, most, halvings - 1))
    }
}
