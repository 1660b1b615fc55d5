//! Which tool axes are clear at a contact of the floor, with a proof between contacts.
//!
//! The ball of the tool stands on the floor, and the tool turns about the centre of the ball. Required distances: those
//! of the contracts for shank and holder, and [`SIDE_DISTANCE_MM`] for the side of the cutter. The side counts from one diameter
//! over the tip on, where the contact no longer has any influence. Between two stations the tip runs straight and the
//! rotary axes turn evenly. At the middle of a piece, each tool point is at most this far from all of its positions on
//! the piece: half of the tip motion, plus half of the turn times its distance from the tip. Pieces are halved until
//! the distance at the middle is larger than that.

use crate::passes::context::{Ends, MotionBound, Obstacles, TILT_RESERVE};
use axes::orient::inscribe::{Proof, inscribe};
use base::units::trim;
use diagnostics::{
    Diag,
    codes::{kinematics, orientation},
};
use five_axis::Pose;
use ir::{ClPoint, Operation, Program};
use nalgebra::{Point3, Vector2, Vector3};
use nurbs::EllipticCone;
use nurbs::elliptic_cone::frame_about;
use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;
use tool_stock::collide::{DistanceTable, Section, ToolSolid};
use wheel::contract::Guarded;
use wheel::operation::Allowances;
use wheel::part::Clamping;

/// Required distance of the side of the cutter from the part, from one diameter over the tip on, mm, for tools from
/// [`WHOLE_DISTANCE_DIAMETER_MM`] on.
const SIDE_DISTANCE_MM: f64 = 0.5;

/// Diameter of a ball, mm, below which the required distance of the side shrinks in proportion: a distance that suits a wheel
/// of 100 mm is wider than the channels of one of 20 mm.
const WHOLE_DISTANCE_DIAMETER_MM: f64 = 5.0;

/// Shares of the distance beside the cutter that are enough on a pass where no axes with the whole distance lead along it: between
/// two blades, or round an edge. The distance only keeps the flutes free; cuts into the part are judged in verification.
const SIDE_DISTANCE_SHARES: [f64; 2] = [0.4, 0.1];

/// Angles from the middle at which axes are tried, degrees.
const RING_ANGLES_DEG: [f64; 9] = [2.5, 5.0, 8.0, 11.0, 15.0, 20.0, 26.0, 33.0, 41.0];

/// Angles at which axes are tried where none of [`RING_ANGLES_DEG`] is clear, degrees: along a twisted channel the tool comes in over
/// the inlet or over the outlet.
const OUTER_RING_ANGLES_DEG: [f64; 3] = [50.0, 60.0, MAX_AWAY_DEG];

/// Largest angle from the middle, degrees.
const MAX_AWAY_DEG: f64 = 70.0;

/// Directions from which the search goes on where no axis on the rings is clear: those with the least violation.
const STARTS: usize = 4;

/// Steps of that search, degrees: the first one, and the least.
const SEARCH_STEPS_DEG: [f64; 2] = [4.0, 0.25];

/// Axes tried on each ring.
const AXES_PER_RING: usize = 16;

/// Least tilt of a candidate, radians. Nearer to the pole, rotary axis 2 would turn through, and a pass keeps one
/// branch.
pub(super) const MIN_TILT: f64 = 0.1;

/// Largest cone about an axis, as a tangent in the plane at height one.
const MAX_CONE_TANGENT: f64 = 0.6;

/// Distance of a contact from the centre of its ball below which they have no direction, mm.
const NO_NORMAL: f64 = 1e-9;

/// Rounding of the angle between axis and normal, radians: an axis along a ruling touches with the middle of the ball.
const AT_THE_MIDDLE: f64 = 1e-6;

/// Half axis of a cone that is wide enough: 1.7 deg.
const WIDE_CONE_HALF_AXIS: f64 = 0.03;

/// Number of clear axes about which cones are tried until a cone is wide enough.
const CONE_SEEDS: usize = 8;

/// The ball of a tool that stands on the part.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StandingBall {
    pub(crate) centre: Point3<f64>,
    /// Normal of the part at the contact; `None` where the ball touches nothing.
    pub(crate) normal: Option<Vector3<f64>>,
}

impl StandingBall {
    /// The ball of a radius at a cutter location.
    pub(crate) fn at(point: &ClPoint, radius: f64) -> Self {
        let centre = point.tip + point.axis * radius;
        Self { centre, normal: point.contact.and_then(|contact| (centre - contact).try_normalize(NO_NORMAL)) }
    }

    /// The ball on the straight way to another place.
    pub(crate) fn towards(&self, other: &Self, share: f64) -> Self {
        let between = |(a, b): (Vector3<f64>, Vector3<f64>)| (a + (b - a) * share).try_normalize(NO_NORMAL);
        Self {
            centre: self.centre + (other.centre - self.centre) * share,
            normal: self.normal.zip(other.normal).and_then(between),
        }
    }

    /// Angle of the contact above the middle of the ball with this axis, radians: there the side of the cutter would cut into the
    /// part. Zero or negative on the lower half of the ball.
    fn above_the_middle(&self, axis: &Vector3<f64>) -> f64 {
        self.normal.map_or(-FRAC_PI_2, |normal| normal.angle(axis) - FRAC_PI_2)
    }
}

/// The tool of an operation among the obstacles.
#[derive(Clone)]
pub(crate) struct ClearAxes<'a> {
    obstacles: &'a Obstacles,
    solid: &'a ToolSolid,
    table: Arc<DistanceTable<3>>,
    clamping: &'a Clamping,
    /// Required distances of the side of the cutter, of shank and of holder, mm.
    required: [f64; 3],
    /// Largest angle between tool axis and Z within the travel of the rotary axes, radians.
    max_tilt: f64,
    program: &'a Program,
    /// Sectors in which the axes are to stay within their travel: one of them where all have equal positions of X, Y and Z.
    sectors: &'a [u32],
}

impl<'a> ClearAxes<'a> {
    pub(crate) fn new(program: &'a Program, obstacles: &'a Obstacles, operation: &'a Operation) -> Self {
        let alike = program.machine.turns_part_about_its_axis();
        let sectors = if alike { operation.sectors.get(..1).unwrap_or_default() } else { &operation.sectors };
        let bound = |body: Guarded| program.required_clearance(body).unwrap_or(program.clearance.get());
        let solid = &program.tools[operation.tool].solid;
        Self {
            obstacles,
            solid,
            table: Arc::new(DistanceTable::new(solid, |rho, s| distances(solid, rho, s))),
            clamping: &program.stock.clamping,
            required: [SIDE_DISTANCE_MM * share_of_size(solid), bound(Guarded::Shank), bound(Guarded::Holder)],
            max_tilt: program.machine.max_tilt(),
            program,
            sectors,
        }
    }

    pub(crate) fn radius(&self) -> f64 {
        self.solid.cutter.tip_radius()
    }

    /// The same with shorter and shorter required distances beside the cutter.
    pub(crate) fn with_less_side_distance(&self) -> [Self; 2] {
        let [side, shank, holder] = self.required;
        SIDE_DISTANCE_SHARES.map(|share| Self { required: [share * side, shank, holder], ..self.clone() })
    }

    /// The axes with these distances, and with shorter ones.
    pub(crate) fn with_side_distances(&self) -> [Self; 3] {
        let [less, least] = self.with_less_side_distance();
        [self.clone(), less, least]
    }

    /// Required distance beside the cutter, mm.
    pub(crate) fn side_distance(&self) -> f64 {
        self.required[0]
    }

    /// A length that suits usual tools, less in proportion for thin ones: such tools finish small wheels.
    pub(crate) fn scaled(&self, whole: f64) -> f64 {
        whole * share_of_size(self.solid)
    }

    /// Distance of a point less the required distance; negative for a violation.
    fn slack(&self, rho: f64, s: f64) -> f64 {
        DistanceTable::least(&distances(self.solid, rho, s), &self.required)
    }

    /// The slack, or anything on the same side of a limit.
    fn slack_side(&self, rho: f64, s: f64, limit: f64) -> f64 {
        self.table.side(rho, s, &self.required, limit, || distances(self.solid, rho, s))
    }

    /// True when every axis within the angle `cap` of this axis is within the travel of the rotary axes, touches with the lower half of
    /// the ball, is clear by at least `margin`, and keeps shank and holder over the clamping. X, Y and Z stay within their travel at this
    /// axis, and about so at the others.
    pub(crate) fn clear(&self, ball: &StandingBall, axis: &Vector3<f64>, cap: f64, margin: f64) -> bool {
        let StandingBall { centre, .. } = ball;
        let tip = centre - axis * self.radius();
        self.tilt_within_travel(axis, cap + TILT_RESERVE)
            && ball.above_the_middle(axis) + cap <= AT_THE_MIDDLE
            && self.in_linear_travel(&tip, axis, cap)
            && self.over_clamping(centre, &tilted_by(axis, cap))
            && self.obstacles.keeps(
                &tip,
                axis,
                |rho, s, _, limit| self.slack_side(rho, s, limit),
                Allowances::NONE,
                MotionBound { about: centre, turn: cap, shift: margin },
            )
    }

    /// True when shank and holder are over the clamping or beside it. The tool comes down as it tilts: an axis with less tilt is over
    /// the clamping as well.
    fn over_clamping(&self, centre: &Point3<f64>, axis: &Vector3<f64>) -> bool {
        self.clamping.clears_body(self.solid, &(centre - axis * self.radius()), axis)
    }

    /// True when every axis within the angle `cap`, radians, of this axis is within the travel of the rotary axes.
    fn tilt_within_travel(&self, axis: &Vector3<f64>, cap: f64) -> bool {
        libm::atan2(libm::hypot(axis.x, axis.y), axis.z) + cap <= self.max_tilt
    }

    /// True when X, Y and Z stay within their travel too, in all sectors. An angle of `cap` moves them by about this angle times
    /// the lengths of tool and part; the links between passes decide.
    fn in_linear_travel(&self, tip: &Point3<f64>, axis: &Vector3<f64>, cap: f64) -> bool {
        let Program { machine, part, .. } = self.program;
        let length = self.solid.length();
        self.sectors.iter().all(|sector| {
            let turn = part.sector_rotation(*sector);
            machine.reaches_place(
                &Pose { tip: turn * tip, axis: turn * axis },
                length,
                cap * (length + tip.coords.norm()),
            )
        })
    }

    /// True when all axes of the machine stay within their travel, in all sectors.
    pub(crate) fn in_travel(&self, at: &ClPoint) -> bool {
        self.tilt_within_travel(&at.axis, 0.0) && self.in_linear_travel(&at.tip, &at.axis, 0.0)
    }

    /// True when the tool is clear over a whole piece of motion.
    pub(crate) fn proved(&self, ends: &Ends) -> bool {
        self.obstacles.keeps_over(ends, |rho, s, _, limit| self.slack_side(rho, s, limit), Allowances::NONE)
    }

    /// Clear axes about a direction, the nearest first.
    pub(crate) fn candidates(&self, ball: &StandingBall, middle: &Vector3<f64>, margin: f64) -> Vec<Vector3<f64>> {
        let clear = |d: &Vector3<f64>| self.clear(ball, d, 0.0, margin);
        let near: Vec<Vector3<f64>> = around(middle).filter(clear).collect();
        if !near.is_empty() {
            return near;
        }
        let outer: Vec<Vector3<f64>> = rings(middle, &OUTER_RING_ANGLES_DEG).filter(clear).collect();
        if outer.is_empty() { self.between_rings(ball, middle, margin) } else { outer }
    }

    /// True where [`Self::candidates`] finds an axis.
    pub(crate) fn has_candidates(&self, ball: &StandingBall, middle: &Vector3<f64>) -> bool {
        let mut tried = around(middle).chain(rings(middle, &OUTER_RING_ANGLES_DEG));
        tried.any(|d| self.clear(ball, &d, 0.0, 0.0)) || !self.between_rings(ball, middle, 0.0).is_empty()
    }

    /// Clear axes between those of the rings. The search starts at the axes with the least violation, and each step reduces it.
    /// Between the walls of a twisted channel the clear axes are a narrow cone.
    fn between_rings(&self, ball: &StandingBall, middle: &Vector3<f64>, margin: f64) -> Vec<Vector3<f64>> {
        let violation = |d: &Vector3<f64>| self.violation(ball, d, margin);
        let clear = |d: &Vector3<f64>| self.clear(ball, d, 0.0, margin);
        let all = around(middle).chain(rings(middle, &OUTER_RING_ANGLES_DEG));
        let mut starts: Vec<(f64, Vector3<f64>)> = all.map(|d| (violation(&d), d)).collect();
        starts.sort_by(|a, b| b.0.total_cmp(&a.0));
        let cone = libm::cos(MAX_AWAY_DEG.to_radians());
        for (mut least, mut axis) in starts.into_iter().take(STARTS).filter(|(violation, _)| violation.is_finite()) {
            let mut step = SEARCH_STEPS_DEG[0];
            while step >= SEARCH_STEPS_DEG[1] && least < 0.0 {
                let neighbours = ring(&axis, step).filter(|d| d.dot(middle) >= cone).map(|d| (violation(&d), d));
                match neighbours.max_by(|a, b| a.0.total_cmp(&b.0)) {
                    Some(better) if better.0 > least => (least, axis) = better,
                    _ => step *= 0.5,
                }
            }
            if clear(&axis) {
                return std::iter::once(axis).chain(rings(&axis, &RING_ANGLES_DEG[..2]).filter(clear)).collect();
            }
        }
        Vec::new()
    }

    /// Worst violation of the required distances, negative; 0 where the tool keeps them.
    fn violation(&self, ball: &StandingBall, axis: &Vector3<f64>, margin: f64) -> f64 {
        let tip = ball.centre - axis * self.radius();
        let reached = self.in_travel(&ClPoint { tip, axis: *axis, contact: None });
        if !reached || !self.over_clamping(&ball.centre, axis) {
            return f64::NEG_INFINITY;
        }
        let distance = |rho: f64, s: f64| self.slack(rho, s) - margin;
        let above = -self.radius() * ball.above_the_middle(axis);
        self.obstacles.nearest(&tip, axis, distance, 0.0).map(|(least, _)| least).fold(above.min(0.0), f64::min)
    }

    /// True when an axis near a direction is clear and far enough from the pole.
    pub(crate) fn has_candidate(&self, ball: &StandingBall, middle: &Vector3<f64>, margin: f64) -> bool {
        around(middle).any(|d| is_steep(&d) && self.clear(ball, &d, 0.0, margin))
    }

    /// Clear axes on the first so many of [`RING_ANGLES_DEG`] about a direction, this direction first.
    pub(crate) fn near(&self, ball: &StandingBall, to: &Vector3<f64>, rings: usize, margin: f64) -> Vec<Vector3<f64>> {
        around(to).take(1 + AXES_PER_RING * rings).filter(|d| self.clear(ball, d, 0.0, margin)).collect()
    }

    /// A cone of clear axes about a clear axis near a direction: the first cone that is wide enough, else the widest.
    pub(crate) fn cone(
        &self,
        ball: &StandingBall,
        to: &Vector3<f64>,
        proof: Proof,
        margin: f64,
    ) -> Option<EllipticCone> {
        self.widest(ball, around(to).filter(|d| self.clear(ball, d, 0.0, margin)), proof, margin)
    }

    /// A cone of clear axes as by [`Self::cone`], else about an axis between the rings.
    pub(crate) fn narrow_cone(
        &self,
        ball: &StandingBall,
        to: &Vector3<f64>,
        proof: Proof,
        margin: f64,
    ) -> Option<EllipticCone> {
        let between = || self.widest(ball, self.between_rings(ball, to, margin).into_iter(), proof, margin);
        self.cone(ball, to, proof, margin).or_else(between)
    }

    /// The first cone about one of these clear axes that is wide enough, else the widest.
    fn widest(
        &self,
        ball: &StandingBall,
        axes: impl Iterator<Item = Vector3<f64>>,
        proof: Proof,
        margin: f64,
    ) -> Option<EllipticCone> {
        let mut best: Option<EllipticCone> = None;
        for about in axes.take(CONE_SEEDS) {
            let frame = frame_about(&about, &Vector3::z());
            let clear = |d: &Vector3<f64>, cap: f64| self.clear(ball, d, cap, margin);
            let Some(cone) = inscribe(&frame, Vector2::zeros(), MAX_CONE_TANGENT, proof, &clear) else { continue };
            if best.is_none_or(|b| cone.half_axes[1] > b.half_axes[1]) {
                best = Some(cone);
            }
            if cone.half_axes[1] >= WIDE_CONE_HALF_AXIS {
                break;
            }
        }
        best
    }

    /// The error for a contact without a clear axis about a direction, which is named. `help` names tools that would have one.
    pub(crate) fn no_axis(
        &self,
        operation: &str,
        tool: &str,
        at: &Point3<f64>,
        about: &Vector3<f64>,
        direction: &str,
        help: impl FnOnce() -> String,
    ) -> Diag {
        if let Some(diag) = self.no_travel(operation, tool, at, about) {
            return diag;
        }
        let [side, shank, holder] = self.required;
        Diag::error(
            orientation::NO_AXIS,
            format!(
                "`{operation}`: no tool axis within {MAX_AWAY_DEG} deg of {direction} keeps {tool} clear of the part; \
                 required clearance {} mm at the side of the cutter, {shank} mm at the shank, {holder} mm at the holder",
                trim(side, 3)
            ),
        )
        .help(help())
    }

    /// The error where axes about a direction are clear of the part, but each of them takes X, Y or Z out of its travel.
    fn no_travel(&self, operation: &str, tool: &str, centre: &Point3<f64>, about: &Vector3<f64>) -> Option<Diag> {
        let anywhere = Self { sectors: &[], ..self.clone() };
        let ball = StandingBall { centre: *centre, normal: None };
        let machine = &self.program.machine;
        let worst = |axis: Vector3<f64>| {
            let tip = centre - axis * self.radius();
            let in_sector = |sector: &u32| {
                let turn = self.program.part.sector_rotation(*sector);
                machine.farthest_out(&Pose { tip: turn * tip, axis: turn * axis }, self.solid.length())
            };
            self.sectors.iter().filter_map(in_sector).max_by(|a, b| a.2.total_cmp(&b.2))
        };
        let clear =
            around(about).chain(rings(about, &OUTER_RING_ANGLES_DEG)).filter(|d| anywhere.clear(&ball, d, 0.0, 0.0));
        let (k, position, beyond) = clear.filter_map(worst).min_by(|a, b| a.2.total_cmp(&b.2))?;
        if beyond <= 0.0 {
            return None;
        }
        let (name, [least, most]) = (machine.names()[k], machine.travel()[k]);
        Some(
            Diag::error(
                kinematics::OUT_OF_TRAVEL,
                format!(
                    "`{operation}` needs {name} = {position:.3} mm here, or more; the travel of this axis of {} is {least:.3} to \
                     {most:.3} mm",
                    machine.name
                ),
            )
            .note(format!("every tool axis that keeps {tool} clear of the part here takes X, Y or Z out of its travel"))
            .help(format!(
                "use a machine on which {name} travels to {position:.3} mm, or mount the part at another position"
            )),
        )
    }
}

/// Signed distances to the cutter above its ball, which touches the part, to shank and holder.
fn distances(solid: &ToolSolid, rho: f64, s: f64) -> [f64; 3] {
    let from = 2.0 * solid.cutter.tip_radius();
    let cutter = if s >= from {
        solid.cutter_distance(rho, s).max(from - s)
    } else {
        libm::hypot(solid.cutter_distance(rho, from).max(0.0), from - s)
    };
    let least = |sections: &[Section]| Section::least_distance(sections, rho, s);
    [cutter, least(&solid.shank), least(&solid.holder)]
}

/// An axis tilted against Z by an angle, radians, more than another one, at most at a right angle to Z.
fn tilted_by(axis: &Vector3<f64>, angle: f64) -> Vector3<f64> {
    let level = libm::hypot(axis.x, axis.y);
    if angle == 0.0 || level < NO_NORMAL {
        return *axis;
    }
    let tilt = libm::atan2(level, axis.z);
    let (sin, cos) = libm::sincos((tilt + angle).min(FRAC_PI_2.max(tilt)));
    Vector3::new(axis.x / level * sin, axis.y / level * sin, cos)
}

/// Share to which distances beside a tool shrink with its diameter.
pub(super) fn share_of_size(solid: &ToolSolid) -> f64 {
    (2.0 * solid.cutter.tip_radius() / WHOLE_DISTANCE_DIAMETER_MM).min(1.0)
}

/// True when an axis is far enough from the pole.
pub(crate) fn is_steep(axis: &Vector3<f64>) -> bool {
    libm::hypot(axis.x, axis.y) >= libm::sin(MIN_TILT)
}

/// Directions about `middle`: first `middle` itself, then ring by ring.
fn around(middle: &Vector3<f64>) -> impl Iterator<Item = Vector3<f64>> {
    std::iter::once(*middle).chain(rings(middle, &RING_ANGLES_DEG))
}

/// Directions at angles from `middle`, degrees, ring by ring.
fn rings(middle: &Vector3<f64>, angles: &'static [f64]) -> impl Iterator<Item = Vector3<f64>> + use<> {
    let middle = *middle;
    angles.iter().flat_map(move |angle| ring(&middle, *angle))
}

/// Directions at an angle from `middle`, degrees.
fn ring(middle: &Vector3<f64>, angle: f64) -> impl Iterator<Item = Vector3<f64>> + use<> {
    let [x, y, w] = frame_about(middle, &Vector3::z());
    let radius = libm::tan(angle.to_radians());
    (0..AXES_PER_RING).map(move |k| {
        let (sin, cos) = libm::sincos(TAU * k as f64 / AXES_PER_RING as f64);
        (w + (x * cos + y * sin) * radius).normalize()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ball that touches a wall stands on its lower half while the tool tilts away from the wall, not towards it.
    #[test]
    fn the_side_of_a_tool_does_not_tilt_into_its_contact() {
        let location = |axis: Vector3<f64>| ClPoint {
            tip: Point3::from(-axis * 2.0),
            axis,
            contact: Some(Point3::new(-2.0, 0.0, 0.0)),
        };
        let tilted = |tilt: f64| Vector3::new(libm::sin(tilt), 0.0, libm::cos(tilt));
        for tilt in [-0.3, 0.0, 0.3] {
            let ball = StandingBall::at(&location(tilted(tilt)), 2.0);
            assert!((ball.normal.unwrap() - Vector3::x()).norm() < 1e-12);
            assert!((ball.above_the_middle(&tilted(tilt)) + tilt).abs() < 1e-12, "{tilt}");
        }
        let free = StandingBall { centre: Point3::origin(), normal: None };
        assert!(free.above_the_middle(&Vector3::z()) < 0.0);
    }
}
