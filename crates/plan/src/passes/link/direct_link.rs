//! Direct links from the end of a finishing pass to the start of the next pass nearby.
//!
//! The tool lifts along its axis and sweeps only space that it already occupied. It goes straight to a place over the
//! start of the next pass, and comes down along the axis at that start. A proof over continuous time shows that the
//! tool keeps its distances to the part between both places. In addition the tool must not meet stock. One of two
//! conditions ensures this:
//!
//! - A contract (`require rest`) bounds the stock that finishing finds. All of the tool then stays farther from the
//!   part than that bound.
//! - Nothing is known about the stock. Passes begin and end outside of the stock, so that the tool stands in free space
//!   at both ends. Between two places of a cylinder of radius R, d apart, a ridge of at most d^2 / 8R is left. For the
//!   part of the tool inside of the blank, the link is so short that this ridge is thinner than a chip.

use super::blank::Blank;
use crate::passes::axis::run::rotary;
use crate::passes::context::{Ends, Obstacles};
use five_axis::{Machine, RotaryPose};
use ir::{ClPoint, Operation, Program};
use tool_stock::collide::{DistanceTable, Section, ToolSolid};
use wheel::contract::{ContractKind, Guarded};
use wheel::operation::Allowances;

/// Heights that the tool lifts by, mm; none where both ends are far enough from the part.
const LIFTS: [f64; 7] = [0.0, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0];

/// Distance of the cutter to the part on the link, mm; less with thin tools.
const CUTTER: f64 = 0.1;

/// Distance beyond the rest that the contract allows, mm.
const OVER_REST: f64 = 0.2;

/// Thickest ridge that the tool may go through, mm.
const RIDGE: f64 = 0.1;

/// Largest turn of a rotary axis on the link, radians.
const MAX_LINK_TURN: f64 = 0.35;

/// Largest turn of a rotary axis on a straight link through air, radians.
const MAX_STRAIGHT_TURN: f64 = 1.5;

/// Least motion of the tip on a link, mm, ten steps of the words of NC text; and the largest turn per mm, radians: a feed is
/// a speed of the tip.
const MIN_LINK_LENGTH_MM: f64 = 1e-3;
const MAX_TURN_PER_MM: f64 = 35.0;

/// Height that the tool lifts by between two places that are nearer to each other, mm.
const SAME_PLACE_LIFT: f64 = 0.5;

/// True where a block at feed can have a tip motion of this length with this turn.
fn can_be_block(length: f64, turn: f64) -> bool {
    length > MIN_LINK_LENGTH_MM && turn <= MAX_TURN_PER_MM * length
}

/// Signed distances to cutter, shank and holder.
fn distances(solid: &ToolSolid, rho: f64, s: f64) -> [f64; 3] {
    let of = |sections: &[Section]| Section::least_distance(sections, rho, s);
    [solid.cutter_distance(rho, s), of(&solid.shank), of(&solid.holder)]
}

/// Direct links between passes of an operation.
pub(crate) struct DirectLinks<'a> {
    machine: &'a Machine,
    obstacles: &'a Obstacles,
    solid: &'a ToolSolid,
    table: DistanceTable<3>,
    blank: Blank<'a>,
    /// Required distances of cutter, shank and holder to the part, mm.
    required: [f64; 3],
    /// Distance from the part beyond which there is no stock, mm; `None` where no contract bounds it.
    free: Option<f64>,
}

impl<'a> DirectLinks<'a> {
    pub(crate) fn new(program: &'a Program, obstacles: &'a Obstacles, operation: &Operation) -> Self {
        let least = program.clearance.get();
        let clearance = |body: Guarded| program.required_clearance(body).map_or(least, |required| required.max(least));
        let rest = program.contracts.iter().filter(|c| c.kind == ContractKind::Rest && c.scope.is_whole());
        let solid = &program.tools[operation.tool].solid;
        Self {
            machine: &program.machine,
            obstacles,
            solid,
            table: DistanceTable::new(solid, |rho, s| distances(solid, rho, s)),
            blank: Blank::new(&program.stock, solid),
            required: [CUTTER * obstacles.scale(), clearance(Guarded::Shank), clearance(Guarded::Holder)],
            free: rest.map(|c| c.bound.value() + OVER_REST).reduce(f64::min),
        }
    }

    /// Share to which distances shrink that suit usual tools.
    pub(super) fn scale(&self) -> f64 {
        self.obstacles.scale()
    }

    /// Places over the end of a pass and over the start of the next, with a straight motion between them; none where the
    /// motion goes from the end itself to the start. `None` where no direct link is proved.
    pub(crate) fn between(&self, from: &ClPoint, to: &ClPoint) -> Option<Vec<ClPoint>> {
        let angles = rotary(&self.machine.chain, [from.axis, to.axis].into_iter());
        let [start, end] = [angles[0], angles[1]];
        if [0, 1].iter().any(|k: &usize| (end[*k] - start[*k]).abs() > MAX_LINK_TURN) {
            return None;
        }
        let turn = self.machine.turn(start, end);
        let moves = can_be_block((to.tip - from.tip).norm(), turn);
        if !moves && turn <= MIN_LINK_LENGTH_MM {
            if from.tip == to.tip && from.axis == to.axis {
                return Some(Vec::new());
            }
            // Up and down along the axis, in space that the tool is in.
            return Some(vec![ClPoint { tip: to.tip + to.axis * SAME_PLACE_LIFT, axis: to.axis, contact: None }]);
        }
        let height = self.blank.height_within(from).max(self.blank.height_within(to));
        LIFTS.iter().find_map(|lift| {
            let over = [from, to].map(|p| ClPoint { tip: p.tip + p.axis * *lift, axis: p.axis, contact: None });
            let ends: Ends = [0, 1].map(|k| RotaryPose { tip: over[k].tip, rotary: angles[k] });
            let length = (over[1].tip - over[0].tip).norm();
            let moves = can_be_block(length, turn);
            let thin = || self.ridge(length, turn, height) <= RIDGE;
            let clear = |least: f64| self.keeps(&ends, Allowances::even(least));
            let near = || thin() && clear(0.0);
            let free = || self.free.is_some_and(clear);
            let places = if *lift > 0.0 { over.to_vec() } else { Vec::new() };
            (moves && (near() || free())).then_some(places)
        })
    }

    /// True when the tool keeps its distances to the part, each at least the allowance there, while its tip goes straight
    /// from one place to another and the rotary axes turn evenly.
    pub(crate) fn straight(&self, from: &ClPoint, to: &ClPoint, kept: Allowances) -> bool {
        let angles = rotary(&self.machine.chain, [from.axis, to.axis].into_iter());
        let ends: Ends = [(from, angles[0]), (to, angles[1])].map(|(p, rotary)| RotaryPose { tip: p.tip, rotary });
        let turns = [0, 1].map(|k: usize| (angles[1][k] - angles[0][k]).abs());
        let moves = can_be_block((to.tip - from.tip).norm(), self.machine.turn(angles[0], angles[1]));
        moves && turns.iter().all(|turn| *turn <= MAX_STRAIGHT_TURN) && self.keeps(&ends, kept)
    }

    /// True when the tool keeps its distances, each at least the allowance, over a motion.
    fn keeps(&self, ends: &Ends, kept: Allowances) -> bool {
        self.obstacles.keeps_over(ends, |rho, s, least, limit| self.slack(rho, s, least, limit), kept)
    }

    /// Distance of a point less the required distance, each at least `least`; negative for a violation; or anything on the same
    /// side of a limit.
    fn slack(&self, rho: f64, s: f64, least: f64, limit: f64) -> f64 {
        let required = self.required.map(|required| required.max(least));
        self.table.side(rho, s, &required, limit, || distances(self.solid, rho, s))
    }

    /// Thickest ridge, up to a height over the tip, between two places of the tool whose tips are `length` apart and whose
    /// axes turn by at most `turn`.
    fn ridge(&self, length: f64, turn: f64, height: f64) -> f64 {
        let sections = self.solid.shank.iter().chain(&self.solid.holder).filter(|x| x.from < height);
        let body = sections.map(|x| (x.radius_from.min(x.radius_to), x.to));
        let cutter = (self.solid.radius(), self.solid.flute_length);
        let moved = |s: f64| length + turn * s.min(height);
        body.chain([cutter]).map(|(r, s)| moved(s).powi(2) / (8.0 * r)).fold(0.0, f64::max)
    }
}
