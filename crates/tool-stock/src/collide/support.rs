//! Extent of a part of a tool along a direction.
//!
//! A direction is given by its component along the tool axis (towards the holder) and its component across, in the same
//! unit.

use super::cutter::Cutter;
use super::tool::{Section, ToolSolid};

/// A convex part of a tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Body {
    /// The cutting part up to the end of the flutes.
    Cutter(Cutter, f64),
    /// A frustum of shank or holder.
    Section(Section),
}

impl Body {
    /// Least value of `along` s - `across` rho over the body: how far the body extends from the tip against a
    /// direction. `across` is not negative.
    pub fn least(&self, along: f64, across: f64) -> f64 {
        let ring = |rho: f64, s: f64| along * s - across * rho;
        match *self {
            Self::Section(s) => ring(s.radius_from, s.from).min(ring(s.radius_to, s.to)),
            Self::Cutter(cutter, top) => cutter.least(along, across, top),
        }
    }

    /// Largest distance from the tip.
    pub fn reach(&self) -> f64 {
        match *self {
            Self::Section(s) => libm::hypot(s.from, s.radius_from).max(libm::hypot(s.to, s.radius_to)),
            Self::Cutter(cutter, top) => libm::hypot(top, cutter.widest_below(top)),
        }
    }
}

impl ToolSolid {
    /// All convex parts with their names.
    pub fn bodies(&self) -> Vec<(&'static str, Body)> {
        let named = |name: &'static str| move |s: &Section| (name, Body::Section(*s));
        let cutter = std::iter::once(("cutter", Body::Cutter(self.cutter, self.flute_length)));
        cutter.chain(self.shank.iter().map(named("shank"))).chain(self.holder.iter().map(named("holder"))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::collide::samples::solids;

    /// Agrees with the least value over points of the outline found by the signed distance of the cutter.
    #[test]
    fn agrees_with_the_distances() {
        for solid in solids() {
            let cutter = solid.cutter;
            let body = Body::Cutter(cutter, solid.flute_length);
            for k in 0..=40 {
                let angle = f64::from(k - 20) / 20.0 * std::f64::consts::FRAC_PI_2;
                let (along, across) = (angle.sin(), angle.cos());
                let least = body.least(along, across);
                // Far away in this direction, the nearest point of the body is the one that extends farthest.
                let far = 1e7;
                let (rho, s) = (across * far, -along * far);
                let distance = solid.cutter_distance(rho, s);
                assert!((far + least - distance).abs() < 1e-4, "{cutter:?} {angle}: {least} {}", distance - far);
            }
        }
    }
}
