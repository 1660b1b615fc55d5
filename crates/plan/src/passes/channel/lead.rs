//! A bull nose on the floor: its axis tilts ahead of the normal by a constant lead angle, along the channel towards the outlet.
//!
//! The corner touches the floor in front; the heel, behind, is above the floor. Across the lines the cutter is as flat as a
//! much larger ball: the radius of its curvature there is (R - r) / sin(lead) + r.

use crate::passes::context::{ChannelChart, MIN_OUTWARD};
use crate::passes::lines::CutterPose;
use ir::CcPoint;
use nalgebra::{Matrix2, Point3, SymmetricEigen, Vector2, Vector3};
use nurbs::bracket::last_whole;
use std::f64::consts::TAU;
use tool_stock::collide::Cutter;

/// Largest lead angle, radians: beyond it a bull nose is hardly flatter than a ball.
const MAX_LEAD: f64 = std::f64::consts::FRAC_PI_4;

/// Steps from the least to the largest lead angle.
const LEADS: usize = 64;

/// Places along the floor at which the cutter is compared with the hub, minus one.
const FLOOR_INTERVALS: usize = 120;

/// Shares of the distance from the first wall to the second at which it is compared.
const WALL_SHARES: [f64; 3] = [0.0, 0.5, 1.0];

/// Directions around the tool.
const TOOL_DIRECTIONS: usize = 48;

/// Circles of the flat end, as shares of the circle on which the centre of the corner runs.
const CIRCLES: [f64; 3] = [0.0, 0.4, 0.8];

/// Depth inside of the hub that is rounding, mm.
const DEPTH_ROUNDING_MM: f64 = 1e-6;

/// A bull nose on the floor.
#[derive(Clone, Copy)]
pub(super) struct BullNose {
    cutter: Cutter,
    /// Angle by which its axis tilts ahead of the normal, radians.
    pub(super) lead: f64,
}

impl BullNose {
    /// A cutter in a passage with the least lead angle that keeps its end out of the hub; `None` where there is none.
    pub(super) fn new(chart: &ChannelChart<'_>, cutter: Cutter) -> Option<Self> {
        least(chart, &cutter).map(|lead| Self { cutter, lead })
    }

    /// Tool on the hub at (u, w) and an azimuth.
    pub(super) fn axis(&self, chart: &ChannelChart<'_>, u: f64, w: f64, azimuth: f64) -> Vector3<f64> {
        axis(chart, u, w, azimuth, self.lead)
    }

    /// Metric of ridges of a height at (u, w), in the directions of the meridian and around Z, 1/mm^2.
    pub(super) fn ridges(&self, chart: &ChannelChart<'_>, u: f64, w: f64, height: f64) -> Matrix2<f64> {
        let hub = &chart.part().hub;
        // Everything but the direction of the channel is the same at each azimuth.
        let (normal, axis) = (hub.normal(u, 0.0), self.axis(chart, u.clamp(0.0, 1.0), w, 0.0));
        let meridian = hub.meridian(u).first.normalize();
        let frame = [Vector3::new(meridian.x, 0.0, meridian.y), Vector3::y()];
        let hollow = Matrix2::from_diagonal(&Vector2::new(hub.meridian_curvature(u), hub.ring_curvature(u)));
        let Some(of_cutter) = self.cutter.curvature_at(&normal, &axis) else { return hollow };
        let form = |d: &Vector3<f64>, curvature: f64| {
            let d = Vector2::new(frame[0].dot(d), frame[1].dot(d));
            d * d.transpose() * curvature
        };
        let sum = form(&of_cutter.along, of_cutter.of_profile) + form(&of_cutter.around, of_cutter.of_ring) + hollow;
        sum / (8.0 * height - 4.0 * height * height * of_cutter.of_ring)
    }

    /// Largest step of any direction, in the middle of the channel at u, mm.
    pub(super) fn largest_step(&self, chart: &ChannelChart<'_>, u: f64, height: f64) -> f64 {
        SymmetricEigen::new(self.ridges(chart, u, 0.5, height)).eigenvalues.min().max(f64::MIN_POSITIVE).sqrt().recip()
    }

    /// The cutter with its axis, on a contact with its x.
    pub(super) fn pose(&self, chart: &ChannelChart<'_>, x: f64, p: &CcPoint) -> Option<CutterPose> {
        let azimuth = libm::atan2(p.position.y, p.position.x);
        CutterPose::at(&self.cutter, x, p, self.axis(chart, p.u.clamp(0.0, 1.0), p.w, azimuth))
    }

    pub(super) fn cutter(&self) -> &Cutter {
        &self.cutter
    }
}

/// Axis of a tool on the hub with a lead angle, at (u, w) and an azimuth.
pub(super) fn axis(chart: &ChannelChart<'_>, u: f64, w: f64, azimuth: f64, lead: f64) -> Vector3<f64> {
    let hub = &chart.part().hub;
    let along = chart.direction(u, w);
    let meridian = hub.meridian(u).first.normalize();
    let (sin, cos) = libm::sincos(azimuth);
    let forward = Vector3::new(meridian.x * cos, meridian.x * sin, meridian.y) * along[0]
        + Vector3::new(-sin, cos, 0.0) * along[1];
    hub.normal(u, azimuth) * libm::cos(lead) + forward * libm::sin(lead)
}

/// The least lead angle, radians, with which no part of the end of a bull nose cuts into the hub; `None` where there is none.
fn least(chart: &ChannelChart<'_>, cutter: &Cutter) -> Option<f64> {
    // With less, the axis would come near the pole of the table where the floor lies flat.
    let from = libm::asin(MIN_OUTWARD);
    let at = |step: usize| from + (MAX_LEAD - from) * step as f64 / LEADS as f64;
    // A larger lead angle lifts the heel.
    if !clears(chart, cutter, at(LEADS)) {
        return None;
    }
    if clears(chart, cutter, from) {
        return Some(from);
    }
    Some(at(last_whole(LEADS, 0, |step| clears(chart, cutter, at(step)))))
}

/// True where the end of a cutter with a lead angle stays out of the hub, along the whole floor.
fn clears(chart: &ChannelChart<'_>, cutter: &Cutter, lead: f64) -> bool {
    let hub = &chart.part().hub;
    let corner = cutter.tip_radius();
    let ring = cutter.nominal_radius() - corner;
    let outside = |p: &Point3<f64>| hub.closest(Vector2::new(libm::hypot(p.x, p.y), p.z)).1;
    let at = |u: f64, w: f64| {
        let middle = chart.point(u, 0.0, w);
        let azimuth = libm::atan2(middle.y, middle.x);
        let axis = axis(chart, u, w, azimuth, lead);
        let Some(tip) = cutter.tip_at(&hub.point(u, azimuth), &hub.normal(u, azimuth), &axis) else { return false };
        let across = Vector3::new(-axis.y, axis.x, 0.0).try_normalize(f64::EPSILON).unwrap_or_else(Vector3::x);
        let other = axis.cross(&across);
        (0..TOOL_DIRECTIONS).all(|k| {
            let (sin, cos) = libm::sincos(TAU * k as f64 / TOOL_DIRECTIONS as f64);
            let outward = across * cos + other * sin;
            outside(&(tip + axis * corner + outward * ring)) >= corner - DEPTH_ROUNDING_MM
                && CIRCLES.iter().all(|share| outside(&(tip + outward * (ring * share))) >= -DEPTH_ROUNDING_MM)
        })
    };
    (0..=FLOOR_INTERVALS).all(|i| WALL_SHARES.iter().all(|w| at(i as f64 / FLOOR_INTERVALS as f64, *w)))
}
