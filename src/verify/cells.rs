//! Cells of one patch of a surface: g at their corners, then the proof that it stays within goals between them.

use super::bounds::{Hull, Tangent};
use super::roof::Roof;
use super::surface::{FAR, LEAST_SLACK, PatchCorners, SLACK};
use super::sweep::{At, Sweep};
use crate::ir::chart::{Patch, Shape};
use crate::ir::design::SurfaceId;
use nalgebra::{Point3, Rotation3};

/// Times a cell is halved at most: from 0.25 mm to 1 um.
const DEEPEST: i32 = 8;

/// The same for cells across the border of the part: the strip that stays out is narrower than a twentieth of a cell.
const BORDER_DEPTH: i32 = 4;

/// Share of the third difference over half a cell by which a surface may leave the biquadratic through nine points: a
/// cubic leaves the parabola by 1/15.6, in two directions, with the mixed terms, and half as much again.
const THICKNESS: f64 = 0.2;

/// What g at a corner may miss, mm; a bound from above needs no more, the bound from below does not rest on it.
pub const CORNER_SLACK: f64 = 1e-3;

/// Cells along a side of the blocks whose corners share their candidates.
const BLOCK: usize = 2;

/// A surface of one sector.
pub(super) struct Surface<'a> {
    /// Its shape in sector 0.
    pub(super) shape: &'a dyn Shape,
    /// Turn into the sector.
    pub(super) turn: Rotation3<f64>,
    /// Which one.
    pub(super) id: SurfaceId,
}

impl Surface<'_> {
    /// The point of a place of the chart.
    pub(super) fn point(&self, [x, y]: [f64; 2]) -> Point3<f64> {
        self.turn * self.shape.place(x, y).position
    }

    pub(super) fn holds(&self, p: &Point3<f64>) -> bool {
        self.shape.is_milled(&(self.turn.inverse() * p))
    }
}

/// Points of a patch in sector 0: corners, middles of sides and middles of its cells, x by x.
pub(super) struct Grid {
    /// The patch.
    pub(super) patch: Patch,
    points: Vec<Point3<f64>>,
    /// Largest third difference along its lines, mm.
    third: f64,
}

impl Grid {
    /// The grid of a patch.
    pub(super) fn new(shape: &dyn Shape, patch: Patch) -> Self {
        let (nx, ny) = (2 * patch.columns, 2 * patch.rows);
        let points: Vec<Point3<f64>> = (0..=nx)
            .flat_map(|i| (0..=ny).map(move |j| (i, j)))
            .map(|(i, j)| shape.place(mix(patch.x, i, nx), mix(patch.y, j, ny)).position)
            .collect();
        let at = |i: usize, j: usize| points[i * (ny + 1) + j].coords;
        let mut third = 0.0_f64;
        for i in 0..=nx {
            for j in 0..=ny {
                if i + 3 <= nx {
                    third = third.max((at(i + 3, j) - (at(i + 2, j) - at(i + 1, j)) * 3.0 - at(i, j)).norm());
                }
                if j + 3 <= ny {
                    third = third.max((at(i, j + 3) - (at(i, j + 2) - at(i, j + 1)) * 3.0 - at(i, j)).norm());
                }
            }
        }
        Self { patch, points, third }
    }

    fn point(&self, i: usize, j: usize) -> Point3<f64> {
        self.points[i * (2 * self.patch.rows + 1) + j]
    }
}

/// The i-th of n + 1 even places over a range.
fn mix(range: [f64; 2], i: usize, n: usize) -> f64 {
    range[0] + (range[1] - range[0]) * i as f64 / n as f64
}

/// A piece of a sweep that may come near.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Candidate {
    sweep: u32,
    piece: u32,
}

/// A candidate over a run of cells.
struct Near {
    candidate: Candidate,
    /// Its distance from the middle.
    value: f64,
    /// It comes nowhere nearer.
    bound: f64,
    /// The same for places.
    tangent: Tangent,
}

/// g at a corner of cells.
#[derive(Clone, Copy, Debug)]
struct Corner {
    value: f64,
    by: Option<Candidate>,
}

/// A run of cells of a patch: columns and rows from..to.
#[derive(Clone, Copy, Debug)]
struct Block {
    x: [usize; 2],
    y: [usize; 2],
}

impl Block {
    fn longest(&self) -> usize {
        (self.x[1] - self.x[0]).max(self.y[1] - self.y[0])
    }

    /// Its cells.
    fn cells(&self) -> impl Iterator<Item = Self> {
        let [from, to] = self.y;
        (self.x[0]..self.x[1]).flat_map(move |i| (from..to).map(move |j| Self { x: [i, i + 1], y: [j, j + 1] }))
    }

    /// Both halves along x by both along y; a single column or row stays whole.
    fn parts(&self) -> impl Iterator<Item = Self> {
        let cut = |[from, to]: [usize; 2]| {
            let middle = from + (to - from).div_ceil(2);
            [[from, middle], [middle, to]]
        };
        let (x, y) = (cut(self.x), cut(self.y));
        x.into_iter().flat_map(move |x| y.map(|y| Self { x, y })).filter(|b| b.x[0] < b.x[1] && b.y[0] < b.y[1])
    }
}

/// What the first look at a patch found.
pub(super) struct Looked {
    /// Blocks of cells, each with what may come nearest in it.
    blocks: Vec<(Block, Vec<Near>)>,
    corners: Vec<Corner>,
    /// True for corners on the part.
    inside: Vec<bool>,
    /// Least and most g at corners on the part.
    pub(super) range: [f64; 2],
}

/// Bounds that a surface is to be proved within.
#[derive(Clone, Copy, Debug)]
pub(super) struct Goals {
    /// g is to stay above.
    pub(super) low: f64,
    /// g is to stay below.
    pub(super) high: f64,
}

/// An extreme of g with its place in the chart.
pub(super) type Found = Option<(f64, [f64; 2])>;

/// What was proved of a patch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Proved {
    /// Least g found.
    pub(super) least: Found,
    /// Most g found.
    pub(super) most: Found,
    /// g is nowhere less.
    pub(super) low: f64,
    /// g is nowhere more.
    pub(super) high: f64,
    /// Points at which g was computed, and cells looked at.
    pub(super) points: usize,
}

impl Proved {
    /// Nothing looked at.
    pub(super) const NOTHING: Self =
        Self { least: None, most: None, low: f64::INFINITY, high: f64::NEG_INFINITY, points: 0 };

    fn take_least(&mut self, value: f64, at: [f64; 2]) {
        if self.least.is_none_or(|l| value < l.0) {
            self.least = Some((value, at));
        }
    }

    fn take(&mut self, value: f64, at: [f64; 2]) {
        self.take_least(value, at);
        if self.most.is_none_or(|m| value > m.0) {
            self.most = Some((value, at));
        }
    }

    /// Both.
    pub(super) fn join(mut self, other: &Self) -> Self {
        for (value, at) in other.least.iter().chain(&other.most) {
            self.take(*value, *at);
        }
        self.low = self.low.min(other.low);
        self.high = self.high.max(other.high);
        self.points += other.points;
        self
    }
}

/// A cell of the chart: middle and half sides.
#[derive(Clone, Copy, Debug)]
struct Cell {
    middle: [f64; 2],
    half: [f64; 2],
    depth: i32,
}

impl Cell {
    fn quarters(self) -> [Self; 4] {
        let half = self.half.map(|h| 0.5 * h);
        [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)].map(|(i, j)| Self {
            middle: [self.middle[0] + i * half[0], self.middle[1] + j * half[1]],
            half,
            depth: self.depth + 1,
        })
    }

    fn at(&self, i: f64, j: f64) -> [f64; 2] {
        [self.middle[0] + i * self.half[0], self.middle[1] + j * self.half[1]]
    }
}

/// How a cell lies to the part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Lies {
    Inside,
    Across,
    Outside,
}

/// What may come nearest in a hull, from all that is looked at in turn.
struct Narrowing<'h> {
    hull: &'h Hull,
    found: Vec<Near>,
    /// Nearest to the middle.
    least: f64,
    /// g is nowhere in the hull more than this: what comes nowhere nearer counts nowhere.
    most: f64,
}

impl<'h> Narrowing<'h> {
    fn new(hull: &'h Hull) -> Self {
        Self { hull, found: Vec::new(), least: FAR, most: FAR + hull.radius }
    }

    fn take(&mut self, sweep: &Sweep<'_>, candidate: Candidate) {
        let Some(look) = sweep.look(candidate.piece, self.hull, self.most) else { return };
        if look.value < self.least {
            self.least = look.value;
            self.most = self.most.min(sweep.farthest(candidate.piece, self.hull, look.t));
        }
        self.found.push(Near { candidate, value: look.value, bound: look.bound, tangent: look.tangent });
    }

    /// What is left, nearest first.
    fn kept(self) -> Vec<Near> {
        let Self { mut found, most, .. } = self;
        found.retain(|f| f.bound <= most);
        found.sort_by(|a, b| a.value.total_cmp(&b.value).then(a.candidate.cmp(&b.candidate)));
        found
    }
}

/// One patch with the program.
pub(super) struct Task<'a> {
    /// Surface.
    pub(super) surface: &'a Surface<'a>,
    /// Grid of its patch.
    pub(super) grid: &'a Grid,
    /// Program.
    pub(super) sweeps: &'a [Sweep<'a>],
}

impl Task<'_> {
    fn whole(&self) -> Block {
        Block { x: [0, self.grid.patch.columns], y: [0, self.grid.patch.rows] }
    }

    fn hull(&self, block: &Block) -> Hull {
        let along = |[from, to]: [usize; 2]| [2 * from, from + to, 2 * to];
        let (x, y) = (along(block.x), along(block.y));
        let size = block.longest() as f64;
        let at = |k: usize| self.surface.turn * self.grid.point(x[k / 3], y[k % 3]);
        Hull::new(&std::array::from_fn(at), THICKNESS * self.grid.third * size * size * size)
    }

    fn cell(&self, block: &Block) -> Cell {
        let patch = &self.grid.patch;
        let half = [
            0.5 * (patch.x[1] - patch.x[0]) / patch.columns as f64,
            0.5 * (patch.y[1] - patch.y[0]) / patch.rows as f64,
        ];
        let middle =
            [patch.x[0] + half[0] * (2 * block.x[0] + 1) as f64, patch.y[0] + half[1] * (2 * block.y[0] + 1) as f64];
        Cell { middle, half, depth: 0 }
    }

    fn hull_of(&self, cell: &Cell) -> Hull {
        let at = |k: usize| self.surface.point(cell.at((k / 3) as f64 - 1.0, (k % 3) as f64 - 1.0));
        Hull::new(&std::array::from_fn(at), THICKNESS * self.grid.third * 0.125_f64.powi(cell.depth))
    }

    fn lies(&self, hull: &Hull) -> Lies {
        let count = hull.corners.iter().chain([&hull.centre]).filter(|p| self.surface.holds(p)).count();
        match count {
            0 => Lies::Outside,
            5 => Lies::Inside,
            _ => Lies::Across,
        }
    }

    /// True for a cell that is divided further where its bounds fall short.
    fn divides(&self, cell: &Cell, hull: &Hull, lies: Lies) -> bool {
        let deepest = if lies == Lies::Inside || self.surface.holds(&hull.centre) { DEEPEST } else { BORDER_DEPTH };
        cell.depth < deepest
    }

    /// g at the corners of all cells.
    pub(super) fn look(&self) -> Looked {
        let patch = &self.grid.patch;
        let count = (patch.columns + 1) * (patch.rows + 1);
        let hull = self.hull(&self.whole());
        let mut looked = Looked {
            blocks: Vec::new(),
            corners: vec![Corner { value: f64::NAN, by: None }; count],
            inside: vec![true; count],
            range: [f64::INFINITY, f64::NEG_INFINITY],
        };
        let near = self.gather(&hull);
        self.look_at(&self.whole(), near, &mut looked);
        for i in 0..=patch.columns {
            for j in 0..=patch.rows {
                let k = i * (patch.rows + 1) + j;
                looked.inside[k] = self.surface.shape.is_milled(&self.grid.point(2 * i, 2 * j));
                if looked.inside[k] {
                    let value = looked.corners[k].value;
                    looked.range = [looked.range[0].min(value), looked.range[1].max(value)];
                }
            }
        }
        looked
    }

    fn look_at(&self, block: &Block, near: Vec<Near>, looked: &mut Looked) {
        if block.longest() > BLOCK {
            for part in block.parts() {
                let near = self.narrow(&near, &self.hull(&part));
                self.look_at(&part, near, looked);
            }
            return;
        }
        let rows = self.grid.patch.rows + 1;
        for i in block.x[0]..=block.x[1] {
            for j in block.y[0]..=block.y[1] {
                let k = i * rows + j;
                if looked.corners[k].value.is_nan() {
                    let p = self.surface.turn * self.grid.point(2 * i, 2 * j);
                    looked.corners[k] = self.corner(&p, &near);
                }
            }
        }
        looked.blocks.push((*block, near));
    }

    /// g at a point of a run of cells.
    fn corner(&self, p: &Point3<f64>, near: &[Near]) -> Corner {
        let mut best = Corner { value: FAR, by: None };
        let mut visit = |near: &Near| {
            let c = near.candidate;
            if let Some(touch) = self.sweeps[c.sweep as usize].least(c.piece, p, best.value, CORNER_SLACK) {
                best = Corner { value: touch.value, by: Some(c) };
            }
            best.value
        };
        let bounds: Vec<f64> = near.iter().map(|n| n.tangent.at(p)).collect();
        let first = (0..near.len()).min_by(|a, b| bounds[*a].total_cmp(&bounds[*b]));
        let mut value = first.map_or(FAR, |k| visit(&near[k]));
        for (k, near) in near.iter().enumerate() {
            if bounds[k] < value && Some(k) != first {
                value = visit(near);
            }
        }
        best
    }

    /// Everything that may come nearest anywhere in a hull.
    fn gather(&self, hull: &Hull) -> Vec<Near> {
        let mut narrowing = Narrowing::new(hull);
        // Finishing first: what comes near bounds the rest.
        for (k, sweep) in self.sweeps.iter().enumerate().rev() {
            let sweep_index = u32::try_from(k).unwrap_or(u32::MAX);
            sweep.gather(hull, narrowing.most, &mut |piece, _| {
                narrowing.take(sweep, Candidate { sweep: sweep_index, piece });
                narrowing.most
            });
        }
        narrowing.kept()
    }

    /// Those of what may come nearest in a larger hull that may in a part of it; what is known of them over the larger one
    /// rules most of them out.
    fn narrow(&self, from: &[Near], hull: &Hull) -> Vec<Near> {
        let mut narrowing = Narrowing::new(hull);
        for near in from {
            if near.tangent.about(&hull.centre, hull.radius) <= narrowing.most {
                narrowing.take(&self.sweeps[near.candidate.sweep as usize], near.candidate);
            }
        }
        narrowing.kept()
    }

    /// Proves bounds of g over the patch.
    pub(super) fn prove(&self, looked: &Looked, goals: Goals) -> Proved {
        let mut proved = Proved::NOTHING;
        let patch = &self.grid.patch;
        for i in 0..=patch.columns {
            for j in 0..=patch.rows {
                let k = i * (patch.rows + 1) + j;
                if looked.inside[k] {
                    let at = [mix(patch.x, i, patch.columns), mix(patch.y, j, patch.rows)];
                    proved.take(looked.corners[k].value, at);
                }
            }
        }
        proved.points += looked.corners.len();
        for (block, near) in &looked.blocks {
            self.below(block, near, goals.low, &mut proved);
        }
        for (block, near) in &looked.blocks {
            for cell in block.cells() {
                let hull = self.hull(&cell);
                let lies = self.lies(&hull);
                if lies != Lies::Outside {
                    let at = |i: usize, j: usize| looked.corners[i * (patch.rows + 1) + j];
                    let ([i, i1], [j, j1]) = (cell.x, cell.y);
                    let corners = [at(i, j), at(i, j1), at(i1, j), at(i1, j1)];
                    self.above(&self.cell(&cell), &hull, lies, corners, near, goals.high, &mut proved);
                }
            }
        }
        proved
    }

    /// Proves that g stays above a goal over a block. What was not kept for it comes nowhere nearer than g, of which
    /// something above the goal is known everywhere.
    fn below(&self, block: &Block, near: &[Near], goal: f64, proved: &mut Proved) {
        let hull = self.hull(block);
        let mut left: Vec<Candidate> = Vec::new();
        for Near { bound, candidate: c, .. } in near {
            let bound = match *bound {
                far if far >= goal => far,
                _ => self.sweeps[c.sweep as usize].below(c.piece, &hull, goal).bound,
            };
            if bound >= goal {
                proved.low = proved.low.min(bound);
            } else {
                left.push(*c);
            }
        }
        if left.is_empty() {
            return;
        }
        for cell in block.cells() {
            self.below_cell(&self.cell(&cell), &self.hull(&cell), &left, goal, proved);
        }
    }

    fn below_cell(&self, cell: &Cell, hull: &Hull, near: &[Candidate], goal: f64, proved: &mut Proved) {
        let lies = self.lies(hull);
        if lies == Lies::Outside {
            return;
        }
        proved.points += 1;
        let goal = lower_goal(goal, proved.least);
        let mut low = f64::INFINITY;
        let mut left = Vec::new();
        for c in near {
            let sweep = &self.sweeps[c.sweep as usize];
            let below = sweep.below(c.piece, hull, goal);
            low = low.min(below.bound);
            if let Some(at) = below.nearest {
                left.push(*c);
                if lies == Lies::Inside {
                    // What the hull shows is asked of the surface itself.
                    let place = cell.at(at[0], at[1]);
                    if let Some(touch) = sweep.least(c.piece, &self.surface.point(place), FAR, CORNER_SLACK) {
                        proved.take_least(touch.value, place);
                    }
                }
            }
        }
        let goal = lower_goal(goal, proved.least);
        if low >= goal || (cell.depth >= DEEPEST && self.surface.holds(&hull.centre)) {
            proved.low = proved.low.min(low);
        } else if self.divides(cell, hull, lies) {
            for quarter in cell.quarters() {
                self.below_cell(&quarter, &self.hull_of(&quarter), &left, goal, proved);
            }
        }
    }

    /// Proves that g stays below a goal over a cell.
    #[allow(clippy::too_many_arguments, reason = "the state of one recursion")]
    fn above(
        &self,
        cell: &Cell,
        hull: &Hull,
        lies: Lies,
        corners: [Corner; 4],
        near: &[Near],
        goal: f64,
        proved: &mut Proved,
    ) {
        let goal = higher_goal(goal, proved.most);
        let high = self.over(hull, &corners, goal);
        if high <= goal || (cell.depth >= DEEPEST && self.surface.holds(&hull.centre)) {
            proved.high = proved.high.max(high);
            return;
        }
        if !self.divides(cell, hull, lies) {
            return;
        }
        let at = |i: f64, j: f64| {
            let place = cell.at(i, j);
            let p = self.surface.point(place);
            (self.corner(&p, near), place, self.surface.holds(&p))
        };
        let between = [at(-1.0, 0.0), at(0.0, -1.0), at(0.0, 0.0), at(0.0, 1.0), at(1.0, 0.0)];
        for (corner, place, inside) in &between {
            proved.points += 1;
            if *inside {
                proved.take(corner.value, *place);
            }
        }
        let [a, b, c, d] = corners;
        let [low_x, low_y, middle, high_y, high_x] = between.map(|b| b.0);
        let parts = [
            [a, low_x, low_y, middle],
            [low_x, b, middle, high_y],
            [low_y, middle, c, high_x],
            [middle, high_y, high_x, d],
        ];
        for (quarter, corners) in cell.quarters().iter().zip(parts) {
            let hull = self.hull_of(quarter);
            let lies = if lies == Lies::Inside { lies } else { self.lies(&hull) };
            if lies != Lies::Outside {
                self.above(quarter, &hull, lies, corners, near, goal, proved);
            }
        }
    }

    /// Upper bound of g over a cell, no better than `enough`.
    fn over(&self, hull: &Hull, corners: &[Corner; 4], enough: f64) -> f64 {
        let high = corners.iter().map(|c| c.value).fold(f64::INFINITY, f64::min) + 2.0 * hull.radius;
        let mut roofs: Vec<Roof> = Vec::with_capacity(8);
        let mut tried: Vec<(u32, u32, u32)> = Vec::with_capacity(8);
        for c in corners.iter().filter_map(|c| c.by) {
            let sweep = &self.sweeps[c.sweep as usize];
            let pairs = [
                sweep.after(c.piece).map(|next| (c.sweep, c.piece, next)),
                sweep.before(c.piece).map(|last| (c.sweep, last, c.piece)),
            ];
            for pair in pairs.into_iter().flatten() {
                if tried.contains(&pair) {
                    continue;
                }
                tried.push(pair);
                let roof = sweep.above(pair.1, pair.2, hull);
                if roof.most() <= enough {
                    return roof.most();
                }
                roofs.push(roof);
            }
        }
        high.min(under(&roofs, enough, ROOF_DEPTH)).min(FAR)
    }
}

/// A goal below moves when something deeper comes up, and only then.
fn lower_goal(goal: f64, least: Found) -> f64 {
    least.map_or(goal, |l| if l.0 - LEAST_SLACK < goal { l.0 - SLACK } else { goal })
}

/// The same above.
fn higher_goal(goal: f64, most: Found) -> f64 {
    most.map_or(goal, |m| if m.0 + LEAST_SLACK > goal { m.0 + SLACK } else { goal })
}

/// Times a cell is halved to choose between roofs.
const ROOF_DEPTH: u32 = 3;

/// Most over a cell of the least of some roofs, no better than `enough`. On the ridge between two passes the mean of both
/// holds: the slope of one makes up for that of the other.
fn under(roofs: &[Roof], enough: f64, depth: u32) -> f64 {
    let mut high = f64::INFINITY;
    for (k, roof) in roofs.iter().enumerate() {
        high = high.min(roof.most());
        for other in &roofs[..k] {
            high = high.min(roof.most_of_mean(other));
        }
        if high <= enough {
            return high;
        }
    }
    if depth == 0 {
        return high;
    }
    let quarters: Vec<[Roof; 4]> = roofs.iter().map(Roof::quarters).collect();
    let mut most = f64::NEG_INFINITY;
    for k in 0..4 {
        let of_quarter: Vec<Roof> = quarters.iter().map(|q| q[k]).collect();
        most = most.max(under(&of_quarter, enough, depth - 1));
        if most >= high {
            return high;
        }
    }
    most
}

/// g of a point, if less than `cutoff`, with the move that makes it.
pub(super) fn deviation(p: &Point3<f64>, sweeps: &[Sweep<'_>], cutoff: f64) -> (f64, Option<At>) {
    let mut best = (cutoff, None);
    // The last operations come nearest: with them first the others are soon out of the question.
    for sweep in sweeps.iter().rev() {
        if let Some(n) = sweep.nearest(p, best.0) {
            best = (n.distance, Some(n.at));
        }
    }
    best
}

impl Looked {
    /// g at the corners on the part.
    pub(super) fn values(&self, task: &Task<'_>) -> PatchCorners {
        let values = self.corners.iter().zip(&self.inside).map(|(c, on)| if *on { c.value as f32 } else { f32::NAN });
        PatchCorners { patch: task.grid.patch, values: values.collect() }
    }

    /// Mean g, area and the nearest move of every cell on the part.
    pub(super) fn cells(&self, task: &Task<'_>) -> Vec<(f64, f64, Option<At>)> {
        let patch = &task.grid.patch;
        let rows = patch.rows + 1;
        let mut cells = Vec::with_capacity(patch.columns * patch.rows);
        for i in 0..patch.columns {
            for j in 0..patch.rows {
                let around = [i * rows + j, i * rows + j + 1, (i + 1) * rows + j, (i + 1) * rows + j + 1];
                let on = || around.iter().filter(|k| self.inside[**k]).map(|k| &self.corners[*k]);
                let count = on().count();
                // Cells across the border count when half of them lies on the part.
                let Some(by) = on().map(|c| c.by).next().filter(|_| count >= 2) else { continue };
                let mean = on().map(|c| c.value).sum::<f64>() / count as f64;
                let area = task.hull(&Block { x: [i, i + 1], y: [j, j + 1] }).area();
                cells.push((mean, area, by.map(|c| task.sweeps[c.sweep as usize].at(c.piece))));
            }
        }
        cells
    }
}
