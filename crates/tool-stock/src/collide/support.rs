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
            Self::Cutter(cutter, top) => {
                // A ball on a ring about the axis, at the height of its radius.
                let rounded = |ring: f64, ball: f64| along * ball - across * ring - ball * libm::hypot(along, across);
                let tip = match cutter {
                    Cutter::Flat { radius } => rounded(radius, 0.0),
                    Cutter::Bull { radius, corner } => rounded(radius - corner, corner),
                    Cutter::Ball { radius } => rounded(0.0, radius),
                    // The plane at the end of the flutes may cut off the ball below the farthest point.
                    Cutter::Lollipop { radius } => {
                        let height = radius - radius * along / libm::hypot(along, across);
                        if height <= top { rounded(0.0, radius) } else { f64::INFINITY }
                    }
                    Cutter::TaperedBall { ball, .. } => rounded(0.0, ball),
                    Cutter::Barrel { radius, tip, .. } => {
                        let height = cutter.barrel_height().filter(|h| *h < top);
                        let widest = height.map_or(f64::INFINITY, |h| ring(radius, h));
                        // The arc, if its normal points against the direction.
                        let angle = libm::atan2(along, across);
                        let arc = cutter.barrel_angle().filter(|end| (0.0..*end).contains(&angle));
                        let arc = arc.and_then(|_| cutter.profile_at(angle)).filter(|p| p.s < top);
                        rounded(0.0, tip).min(widest).min(arc.map_or(f64::INFINITY, |p| ring(p.rho, p.s)))
                    }
                };
                tip.min(ring(cutter.radius_at(top), top))
            }
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

    /// Agrees with the least value over points of the outline found by the signed distance of the cutter.
    #[test]
    fn agrees_with_the_distances() {
        let cutters = [
            Cutter::Flat { radius: 4.0 },
            Cutter::Ball { radius: 3.0 },
            Cutter::Bull { radius: 4.0, corner: 1.0 },
            Cutter::TaperedBall { ball: 1.5, half_angle: 0.1 },
            Cutter::Barrel { radius: 5.0, barrel: 40.0, tip: 1.0 },
            Cutter::Lollipop { radius: 3.0 },
        ];
        for cutter in cutters {
            let top = if matches!(cutter, Cutter::Lollipop { .. }) { 5.0 } else { 20.0 };
            let solid = ToolSolid { cutter, flute_length: top, shank: Vec::new(), holder: Vec::new() };
            let body = Body::Cutter(cutter, top);
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
