//! The short way from the end of a finishing pass to the start of the next, where it lies near.
//!
//! The tool lifts along its axis, which sweeps nothing but the room that it stands in, goes straight over the start of the
//! next pass, and comes down along the axis that it has there. While it goes over, it keeps its distances to the part by
//! proof over continuous time, and it meets no stock, in one of two ways:
//!
//! - What finishing finds is bounded where the job has a contract on it (`require rest`): all of the tool stays farther
//!   from the part than that.
//! - Where nothing is known about the stock, it stands in free room at both ends, since passes begin and end outside of
//!   the stock. Between two places of a cylinder of radius R, d apart, stands a ridge of at most d^2 / 8R: the tool goes
//!   no farther than leaves a ridge that is thinner than a chip.

use super::obstacles::{Ends, Obstacles};
use super::smooth_axis::rotary;
use crate::collide::{Section, ToolSolid};
use crate::contract::{ContractKind, Guarded};
use crate::ir::{ClPoint, Operation, Program};

/// Heights that the tool lifts by, mm.
const LIFTS: [f64; 6] = [0.5, 1.0, 2.0, 4.0, 8.0, 16.0];

/// Distance of the cutter to the part on the way, mm.
const CUTTER: f64 = 0.1;

/// Distance to keep from stock that the contract on rest allows, mm.
const OVER_REST: f64 = 0.2;

/// Thickest ridge that the tool may go through, mm.
const RIDGE: f64 = 0.05;

/// Largest turn of A or C on the way, radians.
const MOST_TURN: f64 = 0.35;

/// Ways between passes of an operation.
pub(super) struct Hops<'a> {
    obstacles: &'a Obstacles,
    solid: &'a ToolSolid,
    /// Distances of cutter, shank and holder to the part, mm.
    asked: [f64; 3],
    /// Distance at which nothing but the part is met, where it is known, mm.
    free: Option<f64>,
}

impl<'a> Hops<'a> {
    pub(super) fn new(program: &'a Program, obstacles: &'a Obstacles, operation: &Operation) -> Self {
        let clearance = |body: Guarded| {
            let asks =
                |kind: ContractKind| matches!(kind, ContractKind::Clearance(b) if b == body || b == Guarded::Body);
            let bounds = program.contracts.iter().filter(|c| asks(c.kind)).map(|c| c.bound.value());
            bounds.fold(program.clearance.get(), f64::max)
        };
        let rest = program.contracts.iter().filter(|c| c.kind == ContractKind::Rest && c.scope.is_whole());
        Self {
            obstacles,
            solid: &program.tools[operation.tool].solid,
            asked: [CUTTER, clearance(Guarded::Shank), clearance(Guarded::Holder)],
            free: rest.map(|c| c.bound.value() + OVER_REST).reduce(f64::min),
        }
    }

    /// Places over the end of a pass and over the start of the next, between which the tool goes straight; `None` where
    /// no such way is proved.
    pub(super) fn between(&self, from: &ClPoint, to: &ClPoint) -> Option<[ClPoint; 2]> {
        let angles = rotary([from.axis, to.axis].into_iter());
        let [(a0, c0), (a1, c1)] = [angles[0], angles[1]];
        if (a1 - a0).abs().max((c1 - c0).abs()) > MOST_TURN {
            return None;
        }
        LIFTS.iter().find_map(|lift| {
            let over = [from, to].map(|p| ClPoint { tip: p.tip + p.axis * *lift, axis: p.axis, contact: None });
            let ends: Ends = [(over[0].tip, a0, c0), (over[1].tip, a1, c1)];
            let way = (over[1].tip - over[0].tip).norm();
            // A block at feed has to move its tip.
            let moves = way > 1e-2;
            let thin = || self.ridge(way, (a1 - a0).hypot(c1 - c0)) <= RIDGE;
            let clear = |least: f64| self.obstacles.keeps_over(&ends, |rho, s| self.lack(rho, s, least));
            let near = || thin() && clear(0.0);
            let free = || self.free.is_some_and(clear);
            (moves && (near() || free())).then_some(over)
        })
    }

    /// How far a point is beyond the distances asked, each at least `least`; negative where one is lacking.
    fn lack(&self, rho: f64, s: f64, least: f64) -> f64 {
        let [cutter, shank, holder] = self.asked.map(|asked| asked.max(least));
        let of = |sections: &[Section]| sections.iter().map(|x| x.distance(rho, s)).fold(f64::INFINITY, f64::min);
        (self.solid.cutter_distance(rho, s) - cutter)
            .min(of(&self.solid.shank) - shank)
            .min(of(&self.solid.holder) - holder)
    }

    /// Thickest ridge between two places of the tool whose tips are `way` apart and whose axes turn by at most `turn`.
    fn ridge(&self, way: f64, turn: f64) -> f64 {
        let sections = self.solid.shank.iter().chain(&self.solid.holder);
        let body = sections.map(|x| (x.radius_from.min(x.radius_to), x.to));
        let cutter = (self.solid.radius(), self.solid.flute_length);
        body.chain([cutter]).map(|(r, s)| (way + turn * s).powi(2) / (8.0 * r)).fold(0.0, f64::max)
    }
}
