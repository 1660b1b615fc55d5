//! The time that operations are expected to take: lengths of their paths from sizes of the part, and factors that were found on the
//! certificates of nine wheels of 8 to 209 mm on a machine with two tables.

use crate::bound::finishes;
use crate::surfaces::Milled;
use ir::{Operation, OperationKind, Program, RoughingStrategy};
use nurbs::angle::nearest_turn;
use nurbs::proximity::Patch;
use serde::Serialize;
use wheel::part::{Part, Surface, SurfaceKind};

/// What an operation does, by sizes of the part.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Expected {
    /// Name of the operation.
    pub operation: String,
    /// Name of its tool.
    pub tool: String,
    /// Lines in all its sectors; none for later tools of roughing, whose lines follow what the tool before left.
    pub lines: f64,
    /// Length of these lines, mm.
    pub length: f64,
    /// Expected time, s.
    pub seconds: f64,
}

/// Widths of the channels of a sector, with the volume that has each.
pub(crate) struct Widths {
    /// Width from wall to wall, mm, and volume, mm3.
    cells: Vec<[f64; 2]>,
    /// Length of all walls, mm.
    walls: f64,
    /// Angles by which the rulings of a wall turn about the axis of the part and against it from inlet to outlet, rad, the mean of the walls.
    turns: [f64; 2],
}

/// Cells along and up a wall.
const CELLS: [usize; 2] = [24, 8];

impl Widths {
    pub(crate) fn of(part: &Part) -> Self {
        let [columns, rows] = CELLS;
        let (mut cells, mut walls) = (Vec::new(), 0.0);
        let (mut turns, mut count) = ([0.0; 2], 0.0);
        for passage in part.passages() {
            let [first, second] = passage.walls;
            let from = if first.index() == 0 { first } else { second };
            let surface = &part.face(from).surface;
            let (opposite, turn) = part.opposite(from);
            let facing = part.face(opposite).surface.rotated(turn);
            let at = |i: usize, j: usize| surface.point(i as f64 / columns as f64, j as f64 / rows as f64);
            for i in 0..columns {
                for j in 0..rows {
                    let [u, v] = [(i as f64 + 0.5) / columns as f64, (j as f64 + 0.5) / rows as f64];
                    let width = facing.closest(&surface.point(u, v), Patch::WHOLE).distance;
                    let area = 0.5 * (at(i + 1, j + 1) - at(i, j)).cross(&(at(i, j + 1) - at(i + 1, j))).norm();
                    cells.push([width, width * area]);
                }
            }
            let rulings = (0..=columns).map(|i| surface.ruling(i as f64 / columns as f64));
            let angles: Vec<[f64; 2]> =
                rulings.map(|r| [libm::atan2(r.y, r.x), libm::atan2(libm::hypot(r.x, r.y), r.z)]).collect();
            for [a, b] in angles.array_windows() {
                turns[0] += nearest_turn(b[0] - a[0], 0.0).abs();
                turns[1] += (b[1] - a[1]).abs();
            }
            count += 1.0;
            walls += (0..columns).map(|i| (at(i + 1, 0) - at(i, 0)).norm()).sum::<f64>();
        }
        Self { cells, walls, turns: turns.map(|turn| turn / count) }
    }

    /// Volume between walls that are at least so far apart, mm3.
    fn at_least(&self, width: f64) -> f64 {
        self.cells.iter().filter(|[w, _]| *w >= width).map(|[_, volume]| volume).sum()
    }
}

/// What the paths of a kind of finishing have over the sizes of their surfaces.
struct Factors {
    /// Length of the paths, as a multiple of lines over the surface.
    length: f64,
    /// Speed of the tip at which the axes alone would take as long as the feed: both times add up, mm/min.
    speed: f64,
    /// Time of links and rapids for each line over the surface, s.
    link: f64,
}

const FACES: Factors = Factors { length: 1.12, speed: 14000.0, link: 1.0 };
const EDGES: Factors = Factors { length: 1.6, speed: 2500.0, link: 1.6 };
const FILLETS: Factors = Factors { length: 1.06, speed: 15000.0, link: 1.6 };
/// A floor whose blades end inside of the part has lines that end at each of them.
const FLOORS: [Factors; 2] =
    [Factors { length: 1.18, speed: 12000.0, link: 0.4 }, Factors { length: 1.18, speed: 12000.0, link: 2.2 }];

/// Time of a line of roughing, s, and what a radian of the turns of its walls adds: the axes brake at every bend.
const ROUGH_LINE: [f64; 2] = [4.0, 1.5];

/// Time of a later tool of roughing for each millimetre of the walls, s.
const LATER_ROUGH: f64 = 1.0;

/// The same of the last one: it grows with what its radius is smaller than that of the tool before, from this ratio on.
const LAST_ROUGH: f64 = 8.0;
const LAST_RATIO: f64 = 0.8;
const LEAST_LAST: f64 = 0.05;

/// By how much certificates were over the expected time, as a share, among 13 wheels: those nine and four others.
pub(crate) const ERROR: f64 = 0.3;

/// What each operation of a program is expected to take.
pub(crate) fn expected(program: &Program, surfaces: &[Milled], widths: &Widths) -> Vec<Expected> {
    let inside = program.part.blade_ids().any(|blade| (0..2).any(|end| program.part.ends_inside(blade, end)));
    let rough = |o: &Operation| o.kind.roughing().is_some();
    let roughings = program.operations.iter().filter(|(_, o)| rough(o)).count();
    let mut before: Vec<f64> = Vec::new();
    let of = |(_, operation): (_, &Operation)| {
        let sectors = operation.sectors.len() as f64;
        let radius = program.tools[operation.tool].solid.cutter.nominal_radius();
        let (lines, length, seconds) = match &operation.kind {
            OperationKind::Roughing { allowances, strategy } => {
                let last = before.len() + 1 == roughings;
                // Later operations of other strategies cut stock of their own.
                let previous = before.last().copied().filter(|_| matches!(strategy, RoughingStrategy::Rough { .. }));
                before.push(radius);
                match previous {
                    None => {
                        let open = widths.at_least(2.0 * (radius + allowances.vane.tip().get()));
                        first_roughing(operation, strategy, widths, open)
                    }
                    Some(previous) if last => {
                        (0.0, 0.0, LAST_ROUGH * (LAST_RATIO - radius / previous).max(LEAST_LAST) * widths.walls)
                    }
                    Some(_) => (0.0, 0.0, LATER_ROUGH * widths.walls),
                }
            }
            OperationKind::Flank { .. } | OperationKind::Channel { .. } | OperationKind::Point { .. } => {
                let own = surfaces.iter().filter(|surface| finishes(operation, surface.kind));
                let each = own.map(|surface| finishing(program, operation, surface, inside));
                each.fold((0.0, 0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1, a.2 + b.2))
            }
        };
        Expected {
            operation: operation.name.clone(),
            tool: program.tools[operation.tool].name.clone(),
            lines: sectors * lines,
            length: sectors * length,
            seconds: sectors * seconds,
        }
    };
    program.operations.iter().map(of).collect()
}

/// Lines, their length and the time of an operation on a surface of a sector.
fn finishing(program: &Program, operation: &Operation, surface: &Milled, inside: bool) -> (f64, f64, f64) {
    let radius = program.tools[operation.tool].solid.cutter.tip_radius();
    let lines = match &operation.kind {
        OperationKind::Flank { flank, .. } => f64::from(flank.strips.unwrap_or(1)),
        OperationKind::Channel { scallop, .. } | OperationKind::Point { scallop, .. } => {
            // A ball as large as the hollow makes it in one line.
            let bend = (1.0 / radius - surface.across).max(LEAST_BEND);
            let step = (8.0 * scallop.get() / bend).sqrt();
            (surface.width / step).ceil() + 1.0
        }
        OperationKind::Roughing { .. } => 0.0,
    };
    let factors = match surface.kind {
        SurfaceKind::Hub(_) => &FLOORS[usize::from(inside)],
        SurfaceKind::Fillet(_) => &FILLETS,
        SurfaceKind::InletEdge(_) | SurfaceKind::OutletEdge(_) => &EDGES,
        _ => &FACES,
    };
    let length = factors.length * lines * (surface.length + operation.lead_in.get() + operation.lead_out.get());
    let minutes = length * (operation.feed.get().recip() + factors.speed.recip());
    (lines, length, 60.0 * minutes + factors.link * lines)
}

/// Curvature of a surface against a ball, 1/mm, below which they count as one.
const LEAST_BEND: f64 = 1e-6;

/// Lines, their length and the time of the first operation of roughing in a sector, with the volume that is open to its tool, mm3.
fn first_roughing(operation: &Operation, strategy: &RoughingStrategy, widths: &Widths, open: f64) -> (f64, f64, f64) {
    let [depth, stepover] = match strategy {
        RoughingStrategy::Rough { depth, stepover, .. } => [depth.get(), stepover.get()],
        RoughingStrategy::Groove { depth } | RoughingStrategy::Expand { depth, .. } => [depth.get(); 2],
        RoughingStrategy::Plunge { stepover } => [stepover.get(); 2],
    };
    let length = open / (depth * stepover);
    let lines = length / widths.walls.max(1.0);
    let [line, turn] = ROUGH_LINE;
    let turns: f64 = widths.turns.iter().sum();
    (lines, length, 60.0 * length / operation.feed.get() + lines * (line + turn * turns))
}
