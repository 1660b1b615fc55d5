//! Obstacles of the planner: sampled surfaces of the design part, of table and of fixtures.

use five_axis::{Carried, Chain, Machine, RotaryPose};
use ir::{Operation, OperationKind, Program};
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;
use std::f64::consts::FRAC_1_SQRT_2;
use std::sync::Arc;
use tool_stock::collide::revolved;
use tool_stock::collide::tool::tool_coordinates;
use tool_stock::collide::{Cloud, CloudPoint, DistanceTable, ToolSolid};
use wheel::operation::{Allowances, VaneAllowance};
use wheel::part::{Part, Sample, SurfaceKind, kept, sample};

/// Spacing of the samples, mm, for tools from [`WHOLE_SPACING`] on.
const SAMPLE_SPACING_MM: f64 = 0.4;

/// Radius of a tool, mm, below which samples and reserves shrink with the thinnest tool of the job: a reserve as large as
/// the allowance of a small wheel would keep the tool out of the channel.
const WHOLE_SPACING: f64 = 0.8;

/// Least share of the spacing that a thin tool may demand.
const MIN_SCALE: f64 = 0.1;

/// Most samples for which the spacing shrinks: some hundred megabytes.
const MAX_SAMPLES: f64 = 4e6;

/// Reserve for samples in place of a surface, mm. The nearest sample lies at most d = 0.71 spacings beside the closest
/// point of the surface. A measured distance g is therefore too large by at most sqrt(g^2 + d^2) - g at a sharp edge,
/// and by d^2 / 2R at a round one. The planner adds this reserve to the required distance, at a spacing of 0.4 mm.
const EDGE_MARGIN: f64 = 0.08;

/// The same reserve for tools with a tip radius of at least 2.5 spacings.
const ROUND_MARGIN: f64 = 0.02;
const ROUND_TIP_RADIUS_MM: f64 = 2.5 * SAMPLE_SPACING_MM;

/// Radii of a tool that it stands beyond the ends of a channel, with its leads: a line begins a diameter before the stock, and a tool has
/// its own radius.
const BESIDE_RADII: f64 = 4.0;

/// Halvings of a piece of motion after which its clearance counts as not proved: the pieces are then some micrometres
/// long.
const MAX_MOTION_HALVINGS: u32 = 9;

/// Both ends of a piece of motion.
pub(crate) type Ends = [RotaryPose; 2];

/// A cutter that is less than this inside of a sample touches it, mm: half of the usual chord tolerance.
const TOUCHES: f64 = 5e-4;

/// Distances to keep, mm.
#[derive(Clone, Copy, Debug)]
pub struct Keep {
    /// Cutter to vanes and fillets, at each height.
    pub vane: VaneAllowance,
    /// Cutter to the hub.
    pub hub: f64,
    /// Shank and holder to everything.
    pub clearance: f64,
}

/// Spacing of the samples of table and fixtures, mm; wider for large solids, by [`MAX_ROTATING_SAMPLES`].
const ROTATING_SPACING_MM: f64 = 1.0;

/// Most samples of a rotating obstacle.
const MAX_ROTATING_SAMPLES: f64 = 1e5;

/// A tool with a table of its distances.
#[derive(Clone)]
pub struct TableTool<'a> {
    pub(crate) solid: &'a ToolSolid,
    /// Distances of the cutter, and of shank and holder.
    table: Arc<DistanceTable<2>>,
}

impl<'a> TableTool<'a> {
    /// The table of a tool.
    pub fn new(solid: &'a ToolSolid) -> Self {
        Self { solid, table: Arc::new(DistanceTable::new(solid, |rho, s| cutter_and_body(solid, rho, s))) }
    }

    /// Distance of a point less the distance that is required of the cutter, and of shank and holder, or anything on the same
    /// side of a limit.
    fn slack(&self, rho: f64, s: f64, required: &[f64; 2], limit: f64) -> f64 {
        self.table.side(rho, s, required, limit, || cutter_and_body(self.solid, rho, s))
    }
}

/// Signed distances to the cutter, and to shank and holder.
fn cutter_and_body(solid: &ToolSolid, rho: f64, s: f64) -> [f64; 2] {
    [solid.cutter_distance(rho, s), solid.body_distance(rho, s)]
}

/// Reserve of a cutter for samples whose spacing is a share of the usual one, mm.
fn margin_at(scale: f64, solid: &ToolSolid) -> f64 {
    scale * if solid.cutter.tip_radius() >= scale * ROUND_TIP_RADIUS_MM { ROUND_MARGIN } else { EDGE_MARGIN }
}

/// Bound of a motion: no tool point moves by more than `shift` plus `turn` times its distance from `about`.
#[derive(Clone, Copy, Debug)]
pub struct MotionBound<'a> {
    /// Centre of the turn.
    pub about: &'a Point3<f64>,
    /// Largest turn, radians.
    pub turn: f64,
    /// Largest motion of the centre, mm.
    pub shift: f64,
}

/// Sampled surfaces.
pub struct Obstacles {
    walls: Cloud,
    /// Share of the height at each sample of the walls; empty where no operation has an allowance that grows.
    heights: Vec<f64>,
    hub: Cloud,
    /// Turned surfaces and clamping beside the ends of the channels, which leads pass; with the spacing of the samples as a share of the
    /// usual one.
    beside: (Cloud, f64),
    /// Samples of table and fixtures, with the largest distance from a point of their surface to a sample.
    rotating: Vec<(Cloud, f64)>,
    chain: Chain,
    /// Spacing of the samples of the part as a share of the usual one.
    scale: f64,
}

impl Obstacles {
    /// Samples all surfaces of the part, and of the rotating obstacles of a machine, as closely as the tools of a program
    /// need.
    pub fn of(program: &Program) -> Self {
        // Of a tapered tool the ball counts, which is thinner than the end of the flutes.
        let radius = |solid: &ToolSolid| solid.radius().min(solid.cutter.nominal_radius());
        let radii = program.operations.iter().map(|(_, o)| radius(&program.tools[o.tool].solid));
        let thinnest = radii.fold(WHOLE_SPACING, f64::min);
        let finest = (sample::estimate(&program.part, SAMPLE_SPACING_MM) / MAX_SAMPLES).sqrt();
        let scale = (thinnest / WHOLE_SPACING).max(finest).clamp(MIN_SCALE, 1.0);
        let reach = |operation: &Operation| {
            let leads = operation.lead_in.get().max(operation.lead_out.get());
            leads + BESIDE_RADII * program.tools[operation.tool].solid.radius()
        };
        let reach = program.operations.iter().map(|(_, o)| reach(o)).fold(0.0, f64::max);
        let mut obstacles = Self::sampled(&program.part, &program.machine, scale);
        let (beside, spacing) = kept::beside_ends(&program.part, &program.stock, reach, scale * SAMPLE_SPACING_MM);
        obstacles.beside = (Cloud::new(beside), spacing / SAMPLE_SPACING_MM);
        let vane = |kind: &OperationKind| kind.roughing().map_or(0.0, |kept| kept.vane.growth());
        if program.operations.iter().any(|(_, o)| vane(&o.kind) > 0.0) {
            let height = |p: &CloudPoint| program.part.height(&p.position);
            obstacles.heights = obstacles.walls.points().par_iter().map(height).collect();
        }
        obstacles
    }

    /// Samples all surfaces of the part, and of the rotating obstacles of a machine, at the usual spacing.
    pub fn new(part: &Part, machine: &Machine) -> Self {
        Self::sampled(part, machine, 1.0)
    }

    fn sampled(part: &Part, machine: &Machine, scale: f64) -> Self {
        let samples = sample::sample(part, scale * SAMPLE_SPACING_MM);
        let (hub, walls): (Vec<&Sample>, Vec<&Sample>) =
            samples.iter().partition(|s| matches!(s.surface.kind, SurfaceKind::Hub(_)));
        let [hub, walls] = [hub, walls].map(sample::cloud_points);
        // Passes are planned in sector 0. Where the part does not sit on the axis of the table, table and fixtures stand
        // elsewhere for each sector: planning keeps clear of all of these places.
        let [x, y] = machine.table_axis();
        let places: Vec<[f64; 2]> = if [x, y] == [0.0; 2] {
            vec![[0.0; 2]]
        } else {
            let turns = (0..part.vane_count).map(|k| part.sector_rotation(k).inverse() * Point3::new(x, y, 0.0));
            turns.map(|p| [p.x, p.y]).collect()
        };
        let most = MAX_ROTATING_SAMPLES / places.len() as f64;
        let sampled = |solid: &Carried, place: [f64; 2]| {
            let (points, spacing) = revolved(&solid.profile, place, ROTATING_SPACING_MM, most);
            (Cloud::new(points), spacing * FRAC_1_SQRT_2)
        };
        let rotating = machine.carried.iter().flat_map(|solid| places.iter().map(move |place| (solid, *place)));
        let rotating = rotating.map(|(solid, place)| sampled(solid, place)).collect();
        let heights = Vec::new();
        let beside = (Cloud::new(Vec::new()), scale);
        Self { walls: Cloud::new(walls), heights, hub: Cloud::new(hub), beside, rotating, chain: machine.chain, scale }
    }

    /// Share to which distances shrink that suit usual tools: 1 for them, less where the job has thinner ones.
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    /// Reserve for samples in place of a surface, mm.
    fn edge_margin(&self) -> f64 {
        self.scale * EDGE_MARGIN
    }

    /// Reserve of a cutter, mm.
    fn margin(&self, solid: &ToolSolid) -> f64 {
        margin_at(self.scale, solid)
    }

    /// True when the tool keeps its distances over a motion. `slack` takes the distance of a point from the tool axis,
    /// its height over the tip, the allowance at the point and a limit, and returns its distance less the required distance,
    /// or anything on the same side of the limit. It must change no faster than the point moves, and not grow with the
    /// allowance. Table and fixtures have no allowance.
    pub fn keeps(
        &self,
        tip: &Point3<f64>,
        axis: &Vector3<f64>,
        slack: impl Fn(f64, f64, f64, f64) -> f64,
        kept: Allowances,
        motion: MotionBound<'_>,
    ) -> bool {
        let MotionBound { about, turn, shift } = motion;
        // The distance to `about` changes as fast as the point moves, so that the sum changes at most 1 + turn times as
        // fast.
        let value = |p: &Point3<f64>, kept: f64, margin: f64, limit: f64| {
            let (rho, s) = tool_coordinates(p, tip, axis);
            let moved = turn * (p - about).norm() + shift + margin;
            (slack(rho, s, kept, limit * (1.0 + turn) + moved) - moved) / (1.0 + turn)
        };
        let of_part = |p: &Point3<f64>, kept: f64, limit: f64| value(p, kept, self.edge_margin(), limit);
        let of_walls = |i: usize, p: &Point3<f64>, limit: f64| of_part(p, self.allowance(kept.vane, i), limit);
        !self.walls.any_below_of(|p, limit| of_part(p, kept.vane.root().get(), limit), of_walls, 0.0)
            && !self.hub.any_below(|p, limit| of_part(p, kept.hub.get(), limit), 0.0)
            && !self.beside.0.any_below(|p, limit| value(p, kept.hub.get(), self.beside.1 * EDGE_MARGIN, limit), 0.0)
            && !self
                .rotating
                .iter()
                .any(|(cloud, margin)| cloud.any_below(|p, limit| value(p, 0.0, *margin, limit), 0.0))
    }

    /// True when the tool keeps its distances, as in [`Self::keeps`], over a whole piece of motion in which the tip
    /// runs straight and both angles evenly. At the middle of a piece, each tool point is at most this far from all of
    /// its positions on the piece: half of the tip motion, plus half of the turn times its distance from the tip.
    /// Pieces are halved until the distance at the middle is larger than that.
    pub fn keeps_over(&self, ends: &Ends, slack: impl Fn(f64, f64, f64, f64) -> f64, kept: Allowances) -> bool {
        let mut open = vec![(*ends, 0)];
        while let Some(([p, q], depth)) = open.pop() {
            let middle = RotaryPose {
                tip: p.tip + (q.tip - p.tip) * 0.5,
                rotary: [0, 1].map(|k| 0.5 * (p.rotary[k] + q.rotary[k])),
            };
            let (turn, shift) = (0.5 * self.chain.turn(p.rotary, q.rotary), 0.5 * (q.tip - p.tip).norm());
            let motion = MotionBound { about: &middle.tip, turn, shift };
            if self.keeps(&middle.tip, &self.chain.tool_axis(middle.rotary), &slack, kept, motion) {
                continue;
            }
            if depth >= MAX_MOTION_HALVINGS {
                return false;
            }
            open.push(([p, middle], depth + 1));
            open.push(([middle, q], depth + 1));
        }
        true
    }

    /// True when the tool keeps its distances to the hub, and to what stands beside its ends.
    pub fn hub_clear(&self, tool: &TableTool<'_>, tip: &Point3<f64>, axis: &Vector3<f64>, keep: &Keep) -> bool {
        let clear = |(cloud, scale): (&Cloud, f64)| {
            let required = [keep.hub + margin_at(scale, tool.solid), keep.clearance + scale * EDGE_MARGIN];
            let slack = |p: &Point3<f64>, limit: f64| {
                let (rho, s) = tool_coordinates(p, tip, axis);
                tool.slack(rho, s, &required, limit)
            };
            !cloud.any_below(slack, 0.0)
        };
        clear((&self.hub, self.scale)) && clear((&self.beside.0, self.beside.1))
    }

    /// True when the tool keeps its distances to vanes and fillets.
    pub fn walls_clear(&self, tool: &TableTool<'_>, tip: &Point3<f64>, axis: &Vector3<f64>, keep: &Keep) -> bool {
        let (vane, body) = (keep.vane.plus(self.margin(tool.solid)), keep.clearance + self.edge_margin());
        let slack = |p: &Point3<f64>, vane: f64, limit: f64| {
            let (rho, s) = tool_coordinates(p, tip, axis);
            tool.slack(rho, s, &[vane, body], limit)
        };
        let at_sample = |i: usize, p: &Point3<f64>, limit: f64| slack(p, self.allowance(vane, i), limit);
        !self.walls.any_below_of(|p, limit| slack(p, vane.root().get(), limit), at_sample, 0.0)
    }

    /// Allowance at a sample of the walls, mm.
    fn allowance(&self, vane: VaneAllowance, wall: usize) -> f64 {
        // Without heights the allowance is the same everywhere.
        vane.at(self.heights.get(wall).copied().unwrap_or(0.0))
    }

    /// Negative depth of the cutter inside of the part; `None` where it at most touches the part.
    pub fn cutter_inside(&self, solid: &ToolSolid, tip: &Point3<f64>, axis: &Vector3<f64>) -> Option<f64> {
        let slack = |rho: f64, s: f64| solid.cutter_distance(rho, s) + TOUCHES;
        let walls = self.walls.nearest(tip, axis, slack, 0.0).map(|x| x.0);
        let hub = self.hub.nearest(tip, axis, slack, 0.0).map(|x| x.0);
        walls.into_iter().chain(hub).reduce(f64::min)
    }

    /// For each obstacle the place where a distance to the tool is least, and this distance less the error of the
    /// samples, if it is below `cutoff`.
    pub fn nearest<'a>(
        &'a self,
        tip: &'a Point3<f64>,
        axis: &'a Vector3<f64>,
        distance: impl Fn(f64, f64) -> f64 + 'a,
        cutoff: f64,
    ) -> impl Iterator<Item = (f64, Point3<f64>)> + 'a {
        let part = [(&self.walls, self.edge_margin()), (&self.hub, self.edge_margin())];
        let all = part.into_iter().chain(self.rotating.iter().map(|(cloud, margin)| (cloud, *margin)));
        all.filter_map(move |(cloud, margin)| {
            let (least, index) = cloud.nearest(tip, axis, &distance, cutoff + margin)?;
            Some((least - margin, cloud.points()[index].position))
        })
    }

    /// Worst violation of the clearance of shank and holder to part, table and fixtures, negative; `None` where the
    /// clearance is kept. The side of the cutter keeps the distance `side`, if given, from a radius above the middle of
    /// its ball on.
    pub fn body_violation(
        &self,
        solid: &ToolSolid,
        tip: &Point3<f64>,
        axis: &Vector3<f64>,
        clearance: f64,
        side: Option<f64>,
    ) -> Option<f64> {
        // Above this height the side of the cutter is clear of the contact of the ball.
        let from = 2.0 * solid.cutter.tip_radius();
        let slack = |rho: f64, s: f64| {
            let body = solid.body_distance(rho, s) - clearance;
            let Some(free) = side else { return body };
            let side = libm::hypot(solid.cutter_distance(rho, s.max(from)).max(0.0), (from - s).max(0.0));
            let side = if s >= from { solid.cutter_distance(rho, s) } else { side };
            body.min(side - free)
        };
        self.nearest(tip, axis, slack, 0.0).map(|(least, _)| least).reduce(f64::min)
    }
}
