//! Which tool axes are clear at a contact of the floor, with a proof between contacts.
//!
//! The ball of the tool stands on the floor, and the tool turns about the centre of the ball. Required distances: those
//! of the contracts for shank and holder, and [`SIDE`] for the side of the cutter. The side counts from one diameter
//! over the tip on, where the contact no longer has any influence. Between two stations the tip runs straight and the
//! rotary axes turn evenly. At the middle of a piece, each tool point is at most this far from all of its positions on
//! the piece: half of the tip motion, plus half of the turn times its distance from the tip. Pieces are halved until
//! the distance at the middle is larger than that.

use crate::collide::{Section, ToolSolid};
use crate::contract::Guarded;
use crate::diag::{Diag, codes::orientation};
use crate::geom::EllipticCone;
use crate::geom::elliptic_cone::frame_about;
use crate::ir::{Operation, Program};
use crate::operation::Allowances;
use crate::orient::inscribe::{Proof, inscribe};
use crate::passes::context::{Ends, Obstacles, remedy};
use nalgebra::{Point3, Vector2, Vector3};
use std::f64::consts::TAU;

/// Required distance of the side of the cutter from the part, from one diameter over the tip on, mm.
pub(crate) const SIDE: f64 = 0.5;

/// Angles from the middle at which axes are tried, degrees.
const RINGS: [f64; 9] = [2.5, 5.0, 8.0, 11.0, 15.0, 20.0, 26.0, 33.0, 41.0];

/// Axes tried on each ring.
const AROUND: usize = 16;

/// Least tilt of a candidate, radians. Nearer to the pole, rotary axis 2 would turn through, and a pass keeps one
/// branch.
const LEAST_TILT: f64 = 0.1;

/// Largest cone about an axis, as a tangent in the plane at height one.
const REACH: f64 = 0.6;

/// Half axis of a cone that is wide enough: 1.7 deg.
const WIDE: f64 = 0.03;

/// Number of clear axes about which cones are tried until a cone is wide enough.
const SEEDS: usize = 8;

/// The tool of an operation among the obstacles.
#[derive(Clone, Copy)]
pub(crate) struct ClearAxes<'a> {
    obstacles: &'a Obstacles,
    solid: &'a ToolSolid,
    /// Required distances of the side of the cutter, of shank and of holder, mm.
    asked: [f64; 3],
    /// Largest angle between tool axis and Z within the travel of the rotary axes, radians.
    most_lean: f64,
}

impl<'a> ClearAxes<'a> {
    pub(crate) fn new(program: &'a Program, obstacles: &'a Obstacles, operation: &Operation) -> Self {
        let bound = |body: Guarded| program.clearance_asked(body).unwrap_or(program.clearance.get());
        let solid = &program.tools[operation.tool].solid;
        Self {
            obstacles,
            solid,
            asked: [SIDE, bound(Guarded::Shank), bound(Guarded::Holder)],
            most_lean: program.machine.most_lean(),
        }
    }

    pub(crate) fn radius(&self) -> f64 {
        self.solid.cutter.tip_radius()
    }

    /// Distance of a point less the required distance; negative for a violation.
    fn slack(&self, rho: f64, s: f64) -> f64 {
        let from = 2.0 * self.radius();
        let [side, shank, holder] = self.asked;
        let least = |sections: &[Section]| Section::least_distance(sections, rho, s);
        let cutter = if s >= from {
            self.solid.cutter_distance(rho, s)
        } else {
            libm::hypot(self.solid.cutter_distance(rho, from).max(0.0), from - s)
        };
        (cutter - side).min(least(&self.solid.shank) - shank).min(least(&self.solid.holder) - holder)
    }

    /// True when every axis within the angle `cap` of this axis is within travel and clear by at least `margin`, with
    /// the ball at `centre`.
    pub(crate) fn clear(&self, centre: &Point3<f64>, axis: &Vector3<f64>, cap: f64, margin: f64) -> bool {
        let tip = centre - axis * self.radius();
        self.in_travel(axis, cap)
            && self.obstacles.keeps(
                (&tip, axis),
                (|rho, s, _| self.slack(rho, s), Allowances::NONE),
                (centre, cap, margin),
            )
    }

    /// True when every axis within the angle `cap` of this axis is within the travel of the rotary axes.
    pub(crate) fn in_travel(&self, axis: &Vector3<f64>, cap: f64) -> bool {
        libm::atan2(libm::hypot(axis.x, axis.y), axis.z) + cap <= self.most_lean
    }

    /// True when the tool is clear over a whole piece of motion.
    pub(crate) fn proved(&self, ends: &Ends) -> bool {
        self.obstacles.keeps_over(ends, (|rho, s, _| self.slack(rho, s), Allowances::NONE))
    }

    /// Clear axes about a direction, the nearest first.
    pub(crate) fn candidates(&self, centre: &Point3<f64>, middle: &Vector3<f64>, margin: f64) -> Vec<Vector3<f64>> {
        around(middle).filter(|d| self.clear(centre, d, 0.0, margin)).collect()
    }

    /// True when an axis about a direction is clear and far enough from the pole.
    pub(crate) fn has_candidate(&self, centre: &Point3<f64>, middle: &Vector3<f64>, margin: f64) -> bool {
        around(middle).any(|d| is_steep(&d) && self.clear(centre, &d, 0.0, margin))
    }

    /// Clear axes at most the first angle of [`RINGS`] from a direction, this direction first.
    pub(crate) fn beside(&self, centre: &Point3<f64>, to: &Vector3<f64>, margin: f64) -> Vec<Vector3<f64>> {
        around(to).take(1 + AROUND).filter(|d| self.clear(centre, d, 0.0, margin)).collect()
    }

    /// A cone of clear axes about a clear axis near a direction: the first cone that is wide enough, else the widest.
    pub(crate) fn cone(
        &self,
        centre: &Point3<f64>,
        to: &Vector3<f64>,
        proof: Proof,
        margin: f64,
    ) -> Option<EllipticCone> {
        let mut best: Option<EllipticCone> = None;
        for about in around(to).filter(|d| self.clear(centre, d, 0.0, margin)).take(SEEDS) {
            let frame = frame_about(&about, &Vector3::z());
            let clear = |d: &Vector3<f64>, cap: f64| self.clear(centre, d, cap, margin);
            let Some(cone) = inscribe(&frame, Vector2::zeros(), REACH, proof, &clear) else { continue };
            if best.is_none_or(|b| cone.half_axes[1] > b.half_axes[1]) {
                best = Some(cone);
            }
            if cone.half_axes[1] >= WIDE {
                break;
            }
        }
        best
    }

    /// The error for a contact without a clear axis about a direction.
    pub(crate) fn no_axis(&self, operation: &str, tool: &str, at: &Point3<f64>, about: &Vector3<f64>) -> Diag {
        let [side, shank, holder] = self.asked;
        Diag::error(
            orientation::NO_AXIS,
            format!(
                "`{operation}`: no tool axis within 41 deg of the channel's direction keeps {tool} clear of the part; required \
                 clearance {side} mm at the side of the cutter, {shank} mm at the shank, {holder} mm at the holder"
            ),
        )
        .help(self.remedy(at, about))
    }

    /// Describes tools with which some axis about a direction is clear, where no axis is clear with this tool.
    pub(crate) fn remedy(&self, centre: &Point3<f64>, middle: &Vector3<f64>) -> String {
        remedy(self.solid, true, |solid| self.with_any(solid, centre, middle))
    }

    fn with_any(&self, solid: &ToolSolid, centre: &Point3<f64>, middle: &Vector3<f64>) -> bool {
        // A smaller ball would put the tip lower over the same contact: this query is about the upper part of the tool
        // only.
        let clear = ClearAxes { solid, ..*self };
        around(middle).any(|d| clear.clear(centre, &d, 0.0, 0.0))
    }
}

/// True when an axis is far enough from the pole.
pub(crate) fn is_steep(axis: &Vector3<f64>) -> bool {
    libm::hypot(axis.x, axis.y) >= libm::sin(LEAST_TILT)
}

/// Directions about `middle`: first `middle` itself, then ring by ring.
fn around(middle: &Vector3<f64>) -> impl Iterator<Item = Vector3<f64>> {
    let [x, y, w] = frame_about(middle, &Vector3::z());
    let rings = RINGS.into_iter().flat_map(move |ring| {
        let radius = libm::tan(ring.to_radians());
        (0..AROUND).map(move |k| {
            let (sin, cos) = libm::sincos(TAU * k as f64 / AROUND as f64);
            (w + (x * cos + y * sin) * radius).normalize()
        })
    });
    std::iter::once(w).chain(rings)
}
