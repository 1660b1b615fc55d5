//! The turned blank and its clamping.

use super::Part;
use crate::units::Mm;

/// Turned blank: the result of the lathe. Milling removes the space between its outside and the part.
#[derive(Clone, Debug)]
pub struct Stock {
    /// Outside, as a closed profile in the meridian plane of (r, z) points from the bore over front, inlet, shroud and
    /// outlet to the back; straight between the points.
    pub profile: Vec<[f64; 2]>,
    /// Thickness of the stock over the vane tips, by which the shroud is offset outward.
    pub over_shroud: Mm,
    /// Radius of the bore.
    pub bore_radius: Mm,
    /// Height of the back face.
    pub back: Mm,
    /// Clamping of the blank.
    pub clamping: Clamping,
}

/// Space of chuck and table: a cylinder about Z without a lower end, which no part of a tool may enter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clamping {
    /// Its height.
    pub below: Mm,
    /// Its radius; `None` for everything below the height.
    pub radius: Option<Mm>,
    /// True when the job does not state the clamping: everything below the back face.
    pub by_default: bool,
}

/// Pieces of the turned profile along the shroud: their chords deviate by less than 1 um from the meridian of a vane.
const SHROUD_PIECES: usize = 200;

impl Stock {
    /// The blank that is turned to the shroud plus `over`, to the inlet line between hub and shroud and to the outlet
    /// radius, with a flat front face at the inlet of the hub.
    pub fn turned(part: &Part, over: Mm, bore_radius: Mm, back: Mm) -> Self {
        let hub = part.hub.meridian(0.0).point;
        let mut profile = vec![[bore_radius.get(), back.get()], [bore_radius.get(), hub.y], [hub.x, hub.y]];
        for i in 0..=SHROUD_PIECES {
            let u = i as f64 / SHROUD_PIECES as f64;
            let p = part.shroud.meridian(u).point + part.shroud.meridian_normal(u) * over.get();
            profile.push([p.x, p.y]);
        }
        let outlet = part.hub.meridian(1.0).point.x.max(profile.last().map_or(0.0, |p| p[0]));
        profile.push([outlet, part.hub.meridian(1.0).point.y]);
        profile.push([outlet, back.get()]);
        let clamping = Clamping { below: back, radius: None, by_default: true };
        Self { profile, over_shroud: over, bore_radius, back, clamping }
    }
}
