//! A tool beside the turned blank.

use crate::collide::ToolSolid;
use crate::ir::ClPoint;
use crate::part::profile_distance;

/// Steps along the tool at which its distance to the blank is determined, mm.
const HEIGHT_STEP: f64 = 1.0;

/// The turned blank and a tool.
pub(crate) struct Blank<'a> {
    /// Meridian as (r, z), closed from its last point to its first.
    pub(crate) profile: &'a [[f64; 2]],
    pub(crate) solid: &'a ToolSolid,
}

impl Blank<'_> {
    /// True when all of the tool is outside of the blank and farther from it than a distance, mm.
    pub(crate) fn clear(&self, at: &ClPoint, distance: f64) -> bool {
        self.highest_near(at, distance).is_none()
    }

    /// Height over the tip above which no point of the tool is in the blank, mm.
    pub(crate) fn height_within(&self, at: &ClPoint) -> f64 {
        self.highest_near(at, 0.0).unwrap_or(0.0)
    }

    /// Greatest height over the tip at which the tool is in the blank or nearer to it than a distance, mm.
    fn highest_near(&self, at: &ClPoint, distance: f64) -> Option<f64> {
        let count = (self.solid.length() / HEIGHT_STEP).ceil() as usize;
        let near = |k: &usize| {
            let s = *k as f64 * HEIGHT_STEP;
            let p = at.tip + at.axis * s;
            let body = self.solid.shank.iter().chain(&self.solid.holder).filter(|x| x.from <= s && s <= x.to);
            let widest = body.map(|x| x.radius_from.max(x.radius_to)).fold(self.solid.radius(), f64::max);
            profile_distance(self.profile, [libm::hypot(p.x, p.y), p.z]) <= widest + HEIGHT_STEP + distance
        };
        (0..=count).rev().find(near).map(|k| k as f64 * HEIGHT_STEP)
    }
}
