//! The turned blank and what holds it.

use super::Part;
use crate::units::Mm;

/// Turned blank: what the lathe left. The space between its outside and the part is what milling removes.
#[derive(Clone, Debug)]
pub struct Stock {
    /// Outside, a closed-off profile in the meridian plane as (r, z) points from the bore over front, inlet, shroud
    /// and outlet to the back; corners are sharp between the points.
    pub profile: Vec<[f64; 2]>,
    /// Surface over the vane tips: the shroud offset outward by the stock left over it.
    pub over_shroud: Mm,
    /// Radius of the bore.
    pub bore_radius: Mm,
    /// Height of the back face.
    pub back: Mm,
    /// What holds it.
    pub clamping: Clamping,
}

/// Space of chuck and table: a cylinder about Z without a lower end, which no part of a tool may enter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clamping {
    /// Its height.
    pub below: Mm,
    /// Its radius; `None` is everything below.
    pub radius: Option<Mm>,
    /// True when the job does not say: everything below the back face.
    pub by_default: bool,
}

/// Pieces of the turned profile along the shroud: their chords stay within a micrometre of a vane's meridian.
const SHROUD_PIECES: usize = 200;

impl Stock {
    /// The blank that is turned to the shroud plus `over`, to the inlet line between hub and shroud, to the outlet
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
