//! Cells of one patch of a surface: g at their corners, then the proof that g stays within goals over each cell.

use super::cutoff::Cutoff;
use super::grid::{Cell, CellBlock, Grid, Lies, PlacedSurface, mix};
use super::hull::Hull;
use super::lower_bound::Tangent;
use super::piece::At;
use super::sweep::Sweep;
use super::upper_bound::UpperBound;
use nalgebra::{Point3, Vector3};
use wheel::part::chart::Patch;

/// Reserve for rounding among distances, mm.
const BOUND_ROUNDING: f64 = 1e-9;

/// Distance beyond which a place counts as out of reach of all cutters, mm; searches end there.
pub const FAR: f64 = 20.0;

/// How far a proved bound may lie beyond the worst measured value, mm.
pub const SLACK: f64 = 5e-4;

/// The least of these distances, used where a limit lies close by, mm.
pub const MIN_SLACK: f64 = 2e-5;

/// g at the corners of the cells of a patch.
#[derive(Clone, Debug)]
pub struct PatchCorners {
    /// The patch.
    pub patch: Patch,
    /// g, mm, column by column; at most [`CORNER_SLACK`] above the true value. NaN off the part.
    pub values: Vec<f32>,
}

/// Largest number of times that a cell is halved: from 0.25 mm to 1 um.
const MAX_HALVINGS: i32 = 8;

/// The same for cells across the border of the part: the strip that is left out is narrower than a twentieth of a cell.
const MAX_BORDER_HALVINGS: i32 = 4;

/// Allowed error of g at a corner, mm. It is small enough for the upper bound; the lower bound does not depend on it.
pub const CORNER_SLACK: f64 = 1e-3;

/// Upper bound of g over a block below which no further search is made, mm.
const SEARCH_CUTOFF: f64 = 0.06;

/// A piece of a sweep that may be nearest somewhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct PieceCandidate {
    sweep: u32,
    piece: u32,
}

/// A candidate over a block of cells.
struct Near {
    candidate: PieceCandidate,
    /// Distance of the candidate from the middle of the block.
    value: f64,
    /// Lower bound of its distance over the block.
    bound: f64,
    /// Lower bound of its distance at each place.
    tangent: Tangent,
}

/// g at a corner of cells.
#[derive(Clone, Copy, Debug)]
struct Corner {
    value: f64,
    by: Option<PieceCandidate>,
}

/// Result of the evaluation of the corners of a patch.
pub(crate) struct SampledPatch {
    /// Blocks of cells, each with the pieces that can be nearest in it.
    blocks: Vec<(CellBlock, Vec<Near>)>,
    corners: Vec<Corner>,
    /// True for corners on the part.
    inside: Vec<bool>,
    /// Position of each cell relative to the part.
    lies: Vec<Lies>,
    /// Least and greatest g at corners on the part.
    pub(crate) range: [f64; 2],
}

/// Bounds of g that are to be proved.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Goals {
    /// Required lower bound of g.
    pub(crate) low: f64,
    /// Required upper bound of g.
    pub(crate) high: f64,
}

/// An extreme of g with its place in the chart.
pub(crate) type Extreme = Option<(f64, [f64; 2])>;

/// Result of the proof over a patch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Proved {
    /// Least measured g.
    pub(crate) least: Extreme,
    /// Greatest measured g.
    pub(crate) most: Extreme,
    /// Proved lower bound of g.
    pub(crate) low: f64,
    /// Proved upper bound of g.
    pub(crate) high: f64,
    /// Number of points at which g was computed, plus number of cells tested.
    pub(crate) points: usize,
}

impl Proved {
    /// Result without any cell.
    pub(crate) const NO_CELLS: Self =
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

    /// Result over both parts.
    pub(crate) fn join(mut self, other: &Self) -> Self {
        for (value, at) in other.least.iter().chain(&other.most) {
            self.take(*value, *at);
        }
        self.low = self.low.min(other.low);
        self.high = self.high.max(other.high);
        self.points += other.points;
        self
    }
}

/// A candidate over a patch.
struct Far {
    candidate: PieceCandidate,
    /// Lower bound of its distance over the patch.
    tangent: Tangent,
}

/// Collects the pieces that can be nearest in a hull.
struct Narrowing<'h> {
    hull: &'h Hull,
    found: Vec<Near>,
    /// Distance of the nearest candidate from the middle.
    least: f64,
    /// Upper bound of g over the hull: a piece with a larger lower bound cannot matter.
    most: f64,
}

impl<'h> Narrowing<'h> {
    fn new(hull: &'h Hull, most: f64) -> Self {
        Self { hull, found: Vec::new(), least: FAR, most }
    }

    fn take(&mut self, sweep: &Sweep<'_>, candidate: PieceCandidate) {
        let Some(query) = sweep.query(candidate.piece, self.hull, self.most) else { return };
        if query.value < self.least {
            self.least = query.value;
            self.most = self.most.min(sweep.farthest(candidate.piece, self.hull, query.t));
        }
        self.found.push(Near { candidate, value: query.value, bound: query.bound, tangent: query.tangent });
    }

    /// The remaining candidates, nearest first.
    fn kept(self) -> Vec<Near> {
        let Self { mut found, most, .. } = self;
        found.retain(|f| f.bound <= most);
        found.sort_by(|a, b| a.value.total_cmp(&b.value).then(a.candidate.cmp(&b.candidate)));
        // The lists are kept for every block of every patch, and few candidates remain.
        found.shrink_to_fit();
        found
    }
}

/// One patch with the program.
pub(crate) struct PatchTask<'a> {
    /// Surface.
    pub(crate) surface: &'a PlacedSurface<'a>,
    /// Grid of its patch.
    pub(crate) grid: &'a Grid,
    /// Program.
    pub(crate) sweeps: &'a [Sweep<'a>],
}

impl PatchTask<'_> {
    fn whole(&self) -> CellBlock {
        CellBlock { x: [0, self.grid.patch.columns], y: [0, self.grid.patch.rows] }
    }

    fn hull(&self, block: &CellBlock) -> Hull {
        self.grid.hull(block, self.surface)
    }

    fn cell(&self, block: &CellBlock) -> Cell {
        self.grid.cell(block, self.surface.shape)
    }

    fn hull_of(&self, cell: &Cell) -> Hull {
        let at = |k: usize| self.surface.point(cell.at((k / 3) as f64 - 1.0, (k % 3) as f64 - 1.0));
        Hull::new(&std::array::from_fn(at), cell.thickness.most)
    }

    /// True for a cell that may be divided when its bounds are not sufficient.
    fn divides(&self, cell: &Cell, hull: &Hull, lies: Lies) -> bool {
        let deepest = if lies == Lies::Inside || self.surface.holds(cell.middle, &hull.centre) {
            MAX_HALVINGS
        } else {
            MAX_BORDER_HALVINGS
        };
        cell.depth < deepest
    }

    /// True if no cutter comes within a distance of any place of the patch on the part.
    pub(crate) fn keeps_clear(&self, distance: f64) -> bool {
        let far = self.gather_below(distance);
        let (columns, rows) =
            (CellBlock::runs([0, self.grid.patch.columns]), CellBlock::runs([0, self.grid.patch.rows]));
        let mut blocks = columns.iter().flat_map(|x| rows.iter().map(|y| CellBlock { x: *x, y: *y }));
        let is_clear = |near: &[Near], cell: &CellBlock| {
            let hull = self.hull(cell);
            let keeps =
                |c: PieceCandidate| self.sweeps[c.sweep as usize].below(c.piece, &hull, distance).bound >= distance;
            near.iter().all(|near| keeps(near.candidate)) || self.surface.lies(&self.cell(cell), &hull) == Lies::Outside
        };
        far.is_empty()
            || blocks.all(|block| {
                let near = self.narrow(&far, &self.hull(&block), distance);
                near.is_empty() || block.cells().all(|cell| is_clear(&near, &cell))
            })
    }

    /// All pieces that can be within a distance of some place of the patch, by the hull of the whole patch.
    fn gather_below(&self, distance: f64) -> Vec<Far> {
        let whole = self.hull(&self.whole());
        let bulge = whole.bulges();
        let corners = whole.corners.map(|corner| (corner - whole.centre, distance + bulge));
        self.gather(&Cutoff::new(&whole, &corners, bulge))
    }

    /// g at the corners of all cells.
    pub(crate) fn sample(&self) -> SampledPatch {
        self.sample_below(None)
    }

    /// g at the corners of all cells, as far as it lies below a cutoff. Pieces that are nowhere below the cutoff are
    /// not evaluated, and corners without a nearby piece are [`FAR`]. Without a cutoff all corners are evaluated.
    pub(crate) fn sample_below(&self, cutoff: Option<f64>) -> SampledPatch {
        let patch = &self.grid.patch;
        let count = (patch.columns + 1) * (patch.rows + 1);
        let mut sampled = SampledPatch {
            blocks: Vec::new(),
            corners: vec![Corner { value: f64::NAN, by: None }; count],
            inside: vec![true; count],
            lies: Vec::with_capacity(patch.columns * patch.rows),
            range: [f64::INFINITY, f64::NEG_INFINITY],
        };
        if cutoff.is_some_and(|cutoff| self.gather_below(cutoff).is_empty()) {
            sampled.inside.fill(false);
            return sampled;
        }
        let milled = |i: usize, j: usize| self.surface.shape.is_milled(self.grid.xy(i, j), &self.grid.point(i, j));
        for i in 0..=patch.columns {
            for j in 0..=patch.rows {
                sampled.inside[i * (patch.rows + 1) + j] = milled(2 * i, 2 * j);
            }
        }
        for i in 0..patch.columns {
            for j in 0..patch.rows {
                let k = i * (patch.rows + 1) + j;
                let corners = [k, k + 1, k + patch.rows + 1, k + patch.rows + 2].map(|k| sampled.inside[k]);
                let on = corners.into_iter().chain([milled(2 * i + 1, 2 * j + 1)]).filter(|on| *on).count();
                sampled.lies.push(Lies::by(on));
            }
        }
        self.sample_blocks(&mut sampled, cutoff);
        for (corner, _) in sampled.corners.iter().zip(&sampled.inside).filter(|(_, on)| **on) {
            sampled.range = [sampled.range[0].min(corner.value), sampled.range[1].max(corner.value)];
        }
        sampled
    }

    /// Divides the patch into blocks, and computes g at the corners of the blocks on the part.
    fn sample_blocks(&self, sampled: &mut SampledPatch, cutoff: Option<f64>) {
        let (columns, rows) =
            (CellBlock::runs([0, self.grid.patch.columns]), CellBlock::runs([0, self.grid.patch.rows]));
        let on_part = |b: &CellBlock| b.cells().any(|c| sampled.lies_of(&c, self.grid.patch.rows) != Lies::Outside);
        let places = (0..columns.len()).flat_map(|i| (0..rows.len()).map(move |j| (i, j)));
        let blocks = places.map(|(i, j)| ((i, j), CellBlock { x: columns[i], y: rows[j] })).filter(|(_, b)| on_part(b));
        let (places, blocks): (Vec<_>, Vec<_>) = blocks.map(|(place, b)| (place, (b, self.hull(&b)))).unzip();
        if blocks.is_empty() {
            return;
        }
        let upper_bounds = cutoff.map_or_else(|| self.upper_bounds(&blocks), |most| vec![most; blocks.len()]);
        let whole = self.hull(&self.whole());
        // Corner n of block (i, j) is corner (i + n / 2, j + n % 2) of all.
        let mut corners = vec![(Vector3::zeros(), f64::NEG_INFINITY); (columns.len() + 1) * (rows.len() + 1)];
        let mut bulge = 0.0_f64;
        for (((_, hull), most), (i, j)) in blocks.iter().zip(&upper_bounds).zip(places) {
            let own = hull.bulges();
            bulge = bulge.max(own);
            for (n, p) in hull.corners.iter().enumerate() {
                let corner = &mut corners[(i + n / 2) * (rows.len() + 1) + j + n % 2];
                *corner = (p - whole.centre, corner.1.max(most + own));
            }
        }
        // Corners without a block keep minus infinity and exclude nothing.
        let far = self.gather(&Cutoff::new(&whole, &corners, bulge));
        let stride = self.grid.patch.rows + 1;
        for ((block, hull), most) in blocks.iter().zip(upper_bounds) {
            let near = self.narrow(&far, hull, most);
            for i in block.x[0]..=block.x[1] {
                for j in block.y[0]..=block.y[1] {
                    let k = i * stride + j;
                    if sampled.corners[k].value.is_nan() {
                        let p = self.surface.turn * self.grid.point(2 * i, 2 * j);
                        sampled.corners[k] = self.corner(&p, &near);
                    }
                }
            }
            sampled.blocks.push((*block, near));
        }
    }

    /// Upper bound of g over each block.
    fn upper_bounds(&self, blocks: &[(CellBlock, Hull)]) -> Vec<f64> {
        let mut last: Option<(usize, u32)> = None;
        let most = |(_, hull): &(CellBlock, Hull)| {
            let (mut most, mut near) = (FAR + hull.radius, FAR);
            if let Some((k, piece)) = last {
                let found = self.sweeps[k].quick_distance(piece, &hull.centre);
                most = most.min(self.sweeps[k].farthest(piece, hull, found.t));
                near = near.min(found.distance);
            }
            // First the sweep that was near the previous block, then finishing before roughing: an early small distance
            // excludes most other sweeps.
            let first = last.map(|l| l.0);
            let others = (0..self.sweeps.len()).rev().filter(|k| Some(*k) != first);
            for k in first.into_iter().chain(others) {
                if most <= SEARCH_CUTOFF {
                    break;
                }
                let sweep = &self.sweeps[k];
                if let Some(found) = sweep.near(&hull.centre, near) {
                    most = most.min(sweep.farthest(found.index, hull, found.t));
                    near = found.distance;
                    last = Some((k, found.index));
                }
            }
            // Reserve for rounding: pieces that are equally near are kept.
            most + BOUND_ROUNDING
        };
        blocks.iter().map(most).collect()
    }

    /// g at a point of a block of cells.
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

    /// All pieces that can be nearest anywhere below a cutoff.
    fn gather(&self, cutoff: &Cutoff<'_>) -> Vec<Far> {
        let mut found = Vec::new();
        for (k, sweep) in self.sweeps.iter().enumerate() {
            let own = u32::try_from(k).unwrap_or(u32::MAX);
            sweep.gather(cutoff, &mut |piece| {
                if let Some(tangent) = sweep.glance(piece, cutoff) {
                    found.push(Far { candidate: PieceCandidate { sweep: own, piece }, tangent });
                }
            });
        }
        found
    }

    /// Pieces that can be nearest in this block, in which g is at most `most`; a subset of those of the patch. Their
    /// bounds over the patch exclude most of them.
    fn narrow(&self, from: &[Far], hull: &Hull, most: f64) -> Vec<Near> {
        let mut narrowing = Narrowing::new(hull, most);
        for far in from {
            if far.tangent.about(&hull.centre, hull.radius) <= narrowing.most {
                narrowing.take(&self.sweeps[far.candidate.sweep as usize], far.candidate);
            }
        }
        narrowing.kept()
    }

    /// Proves bounds of g over the patch.
    pub(crate) fn prove(&self, sampled: &SampledPatch, goals: Goals) -> Proved {
        let mut proved = Proved::NO_CELLS;
        let patch = &self.grid.patch;
        for i in 0..=patch.columns {
            for j in 0..=patch.rows {
                let k = i * (patch.rows + 1) + j;
                if sampled.inside[k] {
                    let at = [mix(patch.x, i, patch.columns), mix(patch.y, j, patch.rows)];
                    proved.take(sampled.corners[k].value, at);
                }
            }
        }
        proved.points += sampled.corners.len();
        for (block, near) in &sampled.blocks {
            if self.is_certain(goals.low, &mut proved) {
                break;
            }
            self.below(block, near, sampled, goals.low, &mut proved);
        }
        // Without an upper goal no upper bound is proved.
        let above = sampled.blocks.iter().filter(|_| goals.high < f64::INFINITY);
        for (block, near) in above {
            for cell in block.cells() {
                let lies = sampled.lies_of(&cell, patch.rows);
                if lies != Lies::Outside {
                    let hull = self.hull(&cell);
                    let at = |i: usize, j: usize| sampled.corners[i * (patch.rows + 1) + j];
                    let ([i, i1], [j, j1]) = (cell.x, cell.y);
                    let corners = [at(i, j), at(i, j1), at(i1, j), at(i1, j1)];
                    self.above(&self.cell(&cell), &hull, lies, corners, near, goals.high, &mut proved);
                }
            }
        }
        proved
    }

    /// True for a goal that always holds: no point lies deeper inside of a cutter than its radius.
    fn is_certain(&self, goal: f64, proved: &mut Proved) -> bool {
        let deepest = -self.sweeps.iter().map(Sweep::widest).fold(0.0, f64::max);
        let certain = goal <= deepest;
        if certain {
            proved.low = proved.low.min(deepest);
        }
        certain
    }

    /// Proves that g stays above a goal over a block. Pieces that were not kept for the block are nowhere nearer than
    /// the kept pieces, so that only the kept pieces need a proof.
    /// Bounds of g that are to be proved.
    fn below(&self, block: &CellBlock, near: &[Near], sampled: &SampledPatch, goal: f64, proved: &mut Proved) {
        let hull = self.hull(block);
        let mut left: Vec<PieceCandidate> = Vec::new();
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
            let lies = sampled.lies_of(&cell, self.grid.patch.rows);
            self.below_cell(&self.cell(&cell), &self.hull(&cell), lies, &left, goal, proved);
        }
    }

    fn below_cell(
        &self,
        cell: &Cell,
        hull: &Hull,
        lies: Lies,
        near: &[PieceCandidate],
        goal: f64,
        proved: &mut Proved,
    ) {
        if lies == Lies::Outside {
            return;
        }
        proved.points += 1;
        let goal = lower_goal(goal, proved.least);
        if self.is_certain(goal, proved) {
            return;
        }
        let mut low = f64::INFINITY;
        let mut left = Vec::new();
        for c in near {
            let sweep = &self.sweeps[c.sweep as usize];
            let below = sweep.below(c.piece, hull, goal);
            low = low.min(below.bound);
            if let Some(at) = below.nearest {
                left.push(*c);
                if lies == Lies::Inside {
                    // The nearest place of the hull is evaluated on the surface itself.
                    let place = cell.at(at[0], at[1]);
                    if let Some(touch) = sweep.least(c.piece, &self.surface.point(place), FAR, CORNER_SLACK) {
                        proved.take_least(touch.value, place);
                    }
                }
            }
        }
        let goal = lower_goal(goal, proved.least);
        if low >= goal || (cell.depth >= MAX_HALVINGS && self.surface.holds(cell.middle, &hull.centre)) {
            proved.low = proved.low.min(low);
        } else if self.divides(cell, hull, lies) {
            for quarter in cell.quarters(self.surface.shape) {
                let hull = self.hull_of(&quarter);
                self.below_cell(&quarter, &hull, self.surface.lies(&quarter, &hull), &left, goal, proved);
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
        if high <= goal || (cell.depth >= MAX_HALVINGS && self.surface.holds(cell.middle, &hull.centre)) {
            proved.high = proved.high.max(high);
            return;
        }
        if !self.divides(cell, hull, lies) {
            return;
        }
        let at = |i: f64, j: f64| {
            let place = cell.at(i, j);
            let p = self.surface.point(place);
            (self.corner(&p, near), place, self.surface.holds(place, &p))
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
        for (quarter, corners) in cell.quarters(self.surface.shape).iter().zip(parts) {
            let hull = self.hull_of(quarter);
            let lies = if lies == Lies::Inside { lies } else { self.surface.lies(quarter, &hull) };
            if lies != Lies::Outside {
                self.above(quarter, &hull, lies, corners, near, goal, proved);
            }
        }
    }

    /// Upper bound of g over a cell; the search ends when a bound is at most `enough`.
    fn over(&self, hull: &Hull, corners: &[Corner; 4], enough: f64) -> f64 {
        let high = corners.iter().map(|c| c.value).fold(f64::INFINITY, f64::min) + 2.0 * hull.radius;
        let mut bounds: Vec<UpperBound> = Vec::with_capacity(8);
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
                let bound = sweep.above(pair.1, pair.2, hull);
                if bound.most() <= enough {
                    return bound.most();
                }
                bounds.push(bound);
            }
        }
        high.min(under(&bounds, enough, MAX_UPPER_BOUND_HALVINGS)).min(FAR)
    }
}

/// The lower goal changes only when a smaller value than the goal is measured.
fn lower_goal(goal: f64, least: Extreme) -> f64 {
    least.map_or(goal, |l| if l.0 - MIN_SLACK < goal { l.0 - SLACK } else { goal })
}

/// The upper goal changes only when a greater value than the goal is measured.
fn higher_goal(goal: f64, most: Extreme) -> f64 {
    most.map_or(goal, |m| if m.0 + MIN_SLACK > goal { m.0 + SLACK } else { goal })
}

/// Largest number of times that a cell is halved to combine upper bounds.
const MAX_UPPER_BOUND_HALVINGS: u32 = 3;

/// Upper bound over a cell of the least of several upper bounds; the search ends at `enough`. On the ridge between two
/// passes the mean of two bounds is used, since their slopes compensate each other.
fn under(bounds: &[UpperBound], enough: f64, depth: u32) -> f64 {
    let mut high = f64::INFINITY;
    for (k, bound) in bounds.iter().enumerate() {
        high = high.min(bound.most());
        for other in &bounds[..k] {
            high = high.min(bound.most_of_mean(other));
        }
        if high <= enough {
            return high;
        }
    }
    if depth == 0 {
        return high;
    }
    let quarters: Vec<[UpperBound; 4]> = bounds.iter().map(UpperBound::quarters).collect();
    let mut most = f64::NEG_INFINITY;
    for k in 0..4 {
        let of_quarter: Vec<UpperBound> = quarters.iter().map(|q| q[k]).collect();
        most = most.max(under(&of_quarter, enough, depth - 1));
        if most >= high {
            return high;
        }
    }
    most
}

/// g of a point, if less than `cutoff`, with the move that is nearest.
pub(crate) fn deviation(p: &Point3<f64>, sweeps: &[Sweep<'_>], cutoff: f64) -> (f64, Option<At>) {
    let mut best = (cutoff, None);
    // The last operations are usually nearest: after them the other operations are excluded early.
    for sweep in sweeps.iter().rev() {
        if let Some(n) = sweep.nearest(p, best.0) {
            best = (n.distance, Some(n.at));
        }
    }
    best
}

/// Figures of a cell.
pub(crate) struct CellFigures {
    /// Mean g, mm.
    pub(crate) mean: f64,
    /// Area, mm2.
    pub(crate) area: f64,
    /// Nearest move.
    pub(crate) at: Option<At>,
}

impl SampledPatch {
    /// Position of a cell relative to the part, in a patch with a number of rows.
    fn lies_of(&self, cell: &CellBlock, rows: usize) -> Lies {
        self.lies[cell.x[0] * rows + cell.y[0]]
    }

    /// g at the corners on the part.
    pub(crate) fn values(&self, task: &PatchTask<'_>) -> PatchCorners {
        let values = self.corners.iter().zip(&self.inside).map(|(c, on)| if *on { c.value as f32 } else { f32::NAN });
        PatchCorners { patch: task.grid.patch, values: values.collect() }
    }

    /// Figures of every cell on the part.
    pub(crate) fn cells(&self, task: &PatchTask<'_>) -> Vec<CellFigures> {
        let patch = &task.grid.patch;
        let rows = patch.rows + 1;
        let mut cells = Vec::with_capacity(patch.columns * patch.rows);
        for i in 0..patch.columns {
            for j in 0..patch.rows {
                let around = [i * rows + j, i * rows + j + 1, (i + 1) * rows + j, (i + 1) * rows + j + 1];
                let on = || around.iter().filter(|k| self.inside[**k]).map(|k| &self.corners[*k]);
                let count = on().count();
                // Cells across the border count when at least two of their corners lie on the part.
                let Some(by) = on().map(|c| c.by).next().filter(|_| count >= 2) else { continue };
                let mean = on().map(|c| c.value).sum::<f64>() / count as f64;
                let area = task.hull(&CellBlock { x: [i, i + 1], y: [j, j + 1] }).area();
                cells.push(CellFigures { mean, area, at: by.map(|c| task.sweeps[c.sweep as usize].at(c.piece)) });
            }
        }
        cells
    }
}
