//! Radius of the fillets of a blade: that of the ball that touches a fillet face and the hub.
//!
//! From a place of the face the centre of the ball is its radius away along the normal. The ball touches the hub where the centre
//! has the same distance from it. So each place gives a radius, and a fillet of a rolling ball gives the same everywhere.

use super::face::{EDGE_GAP_MM, StepFace};
use super::meridian::{StepMeridian, flat};
use super::surface::SurfaceJet;
use nalgebra::{Point3, Vector3};
use nurbs::bracket::{SecantEnd, secant};

/// A fillet that was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MeasuredFillet {
    /// Median of the radii, mm.
    pub(super) radius: f64,
    /// Smallest and largest radius, mm.
    pub(super) range: [f64; 2],
    /// Distance from the median within which a place keeps to it, mm: 0.02 mm, or 1 % of small fillets.
    pub(super) within: f64,
    /// Number of places, and of those that keep to the median. At the ends of a blade the ball rolls off its face.
    pub(super) places: [usize; 2],
}

impl MeasuredFillet {
    /// Whether three of four places keep to the median.
    pub(super) fn is_constant(&self) -> bool {
        let [all, keep] = self.places;
        4 * keep >= 3 * all
    }

    fn of(mut radii: Vec<f64>) -> Option<Self> {
        /// Files of usual accuracy keep 0.001 mm to 0.01 mm.
        const WITHIN: f64 = 0.02;
        const RADIUS_SHARE: f64 = 0.01;
        radii.sort_by(f64::total_cmp);
        let radius = *radii.get(radii.len() / 2)?;
        let within = WITHIN.min(RADIUS_SHARE * radius);
        let keep = radii.iter().filter(|r| (*r - radius).abs() <= within).count();
        Some(Self { radius, range: [*radii.first()?, *radii.last()?], within, places: [radii.len(), keep] })
    }
}

/// The fillet of faces between a blade and the hub; `None` where no ball touches a face and the hub.
pub(super) fn measured(faces: &[StepFace], hub: &StepMeridian) -> Option<MeasuredFillet> {
    let mut all = Vec::new();
    for face in faces {
        // The normal of a surface may look to either side. On the side of the ball the radii are the same.
        let sides = [1.0, -1.0].map(|side| radii(face, hub, side));
        let keep = |radii: &Vec<f64>| MeasuredFillet::of(radii.clone()).map_or(0, |found| found.places[1]);
        let [ahead, behind] = sides;
        all.extend(if keep(&ahead) >= keep(&behind) { ahead } else { behind });
    }
    MeasuredFillet::of(all)
}

/// Radii of balls on one side of a face, mm, at places that are away from the hub.
fn radii(face: &StepFace, hub: &StepMeridian, side: f64) -> Vec<f64> {
    /// Where the ball touches the hub any radius fits. Places count from this share of the largest height over the hub.
    const AWAY: f64 = 0.3;
    /// Of the points of borders, one in so many counts.
    const BORDER_STRIDE: usize = 16;
    let places = face.inside(BORDER_STRIDE).into_iter().map(|place| face.surface.at(place));
    let heights: Vec<(SurfaceJet, f64)> = places.map(|jet| (jet, hub.nearest(&flat(&jet.point))[1])).collect();
    let highest = heights.iter().map(|(_, height)| *height).fold(0.0, f64::max);
    let away = heights.into_iter().filter(|(_, height)| *height > EDGE_GAP_MM.max(AWAY * highest));
    away.filter_map(|(jet, height)| radius(&jet.point, jet.normal()? * side, height, hub)).collect()
}

/// Radius of the ball that touches a surface at a point with a normal, and the hub, mm. `height` is the distance of the point from the
/// hub.
fn radius(p: &Point3<f64>, normal: Vector3<f64>, height: f64, hub: &StepMeridian) -> Option<f64> {
    /// End of the search for the radius at which centre and hub are as far from each other, mm.
    const TOUCHES: SecantEnd = SecantEnd { steps: 40, exact: 1e-9, level: 0.0 };
    let at = |r: f64| hub.nearest(&flat(&(p + normal * r)));
    let r = secant([0.0, height], f64::INFINITY, TOUCHES, |r| at(r)[1] - r);
    let [length, distance] = at(r);
    // Where the ball is beyond the end of the hub, its radius is not known.
    let touches = (distance - r).abs() < 1e-6 && length > 0.0 && length < hub.length();
    (r.is_finite() && touches).then_some(r)
}
