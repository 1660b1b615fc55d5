//! Convex bodies of revolution. A function describes each body: it is zero on the surface, negative inside, convex, and
//! changes no faster than the point moves.
//!
//! Near sharp edges the function is the largest of the distances to the faces. Outside, this is less than the true
//! distance; the zero set and all bounds remain valid.

use crate::collide::{Cutter, Section, ToolSolid};

/// The cylinder around a body: heights over the tip, and radius.
pub(super) struct Extent {
    pub(super) from: f64,
    pub(super) to: f64,
    pub(super) radius: f64,
}

/// A body about the tool axis; heights are over the tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum SolidShape {
    /// Cylinder from the tip to `top`.
    Flat { radius: f64, top: f64 },
    /// Cylinder to `top` with a half ball below.
    Ball { radius: f64, top: f64 },
    /// Any other cutter up to `top`, by its own distance.
    Other { cutter: Cutter, top: f64 },
    /// Frustum; `side` is the normal of its side in the half plane (radius, height).
    Frustum { from: f64, to: f64, radius: f64, side: [f64; 2] },
}

/// Value of the function and its derivatives by the distance from the axis and by the height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RadiusValue {
    pub(super) f: f64,
    pub(super) by_rho: f64,
    pub(super) by_s: f64,
}

/// A body given by its function.
pub(super) trait RadiusProfile {
    /// The function at a distance from the axis and a height.
    fn at(&self, rho: f64, s: f64) -> RadiusValue;
}

/// Cylinder up to `top`, flat at the tip or with a half ball.
pub(super) struct Round<const BALL: bool> {
    pub(super) radius: f64,
    pub(super) top: f64,
}

impl<const BALL: bool> RadiusProfile for Round<BALL> {
    /// Without branches, for vectorised loops.
    #[inline(always)]
    fn at(&self, rho: f64, s: f64) -> RadiusValue {
        let side = rho - self.radius;
        let (f, by_rho, by_s) = if BALL {
            let h = s - self.radius;
            let length = (rho * rho + h * h).sqrt();
            let scale = 1.0 / if length > 0.0 { length } else { f64::INFINITY };
            let ball = h < 0.0;
            (
                if ball { length - self.radius } else { side },
                if ball { rho * scale } else { 1.0 },
                if ball { h * scale } else { 0.0 },
            )
        } else {
            let on_side = side > -s;
            (if on_side { side } else { -s }, if on_side { 1.0 } else { 0.0 }, if on_side { 0.0 } else { -1.0 })
        };
        let above = s - self.top;
        let over = above > f;
        RadiusValue {
            f: if over { above } else { f },
            by_rho: if over { 0.0 } else { by_rho },
            by_s: if over { 1.0 } else { by_s },
        }
    }
}

impl SolidShape {
    /// The cutter of a tool, closed at the end of the flutes.
    pub(super) fn cutter(solid: &ToolSolid) -> Self {
        let top = solid.flute_length;
        let cutter = solid.cutter;
        let radius = cutter.nominal_radius();
        match cutter.only_corner() {
            Some(arc) if arc.radius == 0.0 => Self::Flat { radius, top },
            Some(arc) if arc.ring == 0.0 => Self::Ball { radius, top },
            _ => Self::Other { cutter, top },
        }
    }

    /// A section of shank or holder; `None` when it has no height.
    pub(super) fn section(section: &Section) -> Option<Self> {
        let (rise, run) = (section.to - section.from, section.radius_to - section.radius_from);
        (rise > 0.0).then(|| {
            let length = libm::hypot(rise, run);
            let side = [rise / length, -run / length];
            Self::Frustum { from: section.from, to: section.to, radius: section.radius_from, side }
        })
    }

    /// Heights and radius of the cylinder around it.
    pub(super) fn extent(&self) -> Extent {
        match *self {
            Self::Flat { radius, top } | Self::Ball { radius, top } => Extent { from: 0.0, to: top, radius },
            Self::Other { ref cutter, top } => Extent { from: 0.0, to: top, radius: cutter.widest_below(top) },
            Self::Frustum { from, to, radius, side } => {
                Extent { from, to, radius: radius.max(radius - (to - from) * side[1] / side[0]) }
            }
        }
    }

    /// Upper bound of the distance of a point of the body from the tip.
    pub(super) fn reach(&self) -> f64 {
        let Extent { from, to, radius } = self.extent();
        from.abs().max(to.abs()) + radius
    }
}

impl RadiusProfile for SolidShape {
    #[inline]
    fn at(&self, rho: f64, s: f64) -> RadiusValue {
        let (value, top) = match *self {
            Self::Flat { radius, top } => return Round::<false> { radius, top }.at(rho, s),
            Self::Ball { radius, top } => return Round::<true> { radius, top }.at(rho, s),
            Self::Other { ref cutter, top } => {
                let slope = cutter.slope(rho, s);
                (RadiusValue { f: slope.value, by_rho: slope.rho, by_s: slope.s }, top)
            }
            Self::Frustum { from, to, radius, side } => {
                let out = (rho - radius) * side[0] + (s - from) * side[1];
                if from - s > out {
                    (RadiusValue { f: from - s, by_rho: 0.0, by_s: -1.0 }, to)
                } else {
                    (RadiusValue { f: out, by_rho: side[0], by_s: side[1] }, to)
                }
            }
        };
        let above = s - top;
        if above > value.f { RadiusValue { f: above, by_rho: 0.0, by_s: 1.0 } } else { value }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Zero set and sign equal those of the tool's own distances, the derivatives equal difference quotients.
    #[test]
    fn agrees_with_the_distances_of_the_tool() {
        let section = Section { from: 20.0, to: 45.0, radius_from: 3.0, radius_to: 9.0 };
        let solid = |cutter| ToolSolid { cutter, flute_length: 20.0, shank: vec![section], holder: Vec::new() };
        let named = [
            Cutter::flat(4.0),
            Cutter::ball(3.0),
            Cutter::bull(4.0, 1.0),
            Cutter::tapered_ball(2.0, 0.1),
            Cutter::barrel(5.0, 60.0, 1.0),
        ];
        for cutter in named.into_iter().chain(crate::collide::samples::turned()) {
            let solid = solid(cutter);
            for (shape, is_cutter) in
                [(SolidShape::cutter(&solid), true), (SolidShape::section(&section).unwrap(), false)]
            {
                for i in 0..60 {
                    for j in 0..120 {
                        let (rho, s) = (f64::from(i) * 0.203 + 0.011, f64::from(j) * 0.503 - 5.017);
                        let v = shape.at(rho, s);
                        let distance = if is_cutter { solid.cutter_distance(rho, s) } else { section.distance(rho, s) };
                        assert!(v.f <= distance.max(0.0) + 1e-12, "{cutter:?} {rho} {s}");
                        assert_eq!(v.f < 0.0, distance < 0.0, "{cutter:?} {rho} {s}: {} {distance}", v.f);
                        let d = 1e-6;
                        let by_rho = (shape.at(rho + d, s).f - shape.at(rho - d, s).f) / (2.0 * d);
                        let by_s = (shape.at(rho, s + d).f - shape.at(rho, s - d).f) / (2.0 * d);
                        assert!((v.by_rho - by_rho).abs() < 1e-3 && (v.by_s - by_s).abs() < 1e-3);
                    }
                }
            }
        }
    }
}
