//! Four-sided patches over the hub of a sector.
//!
//! Between two blades lies a patch from one face to the other. A line joins the blades at each end of it. Where blades end
//! inside of the part, cuts run from both sides of their edges to the circle at the end of the hub. They separate patches before the
//! edges from a patch before the channel. Each cut leaves its blade by a quarter of the opening.
//!
//! ```text
//!  ---*-----*---------*-----*---   circle
//!      \   / \       / \   /       cuts
//!       \_/   \     /   \_/        edges
//!       | |----\---/----| |        line between the blades
//! ```

use super::blade_sheets::{BladeSheets, SheetForm};
use super::patch::{PatchDirection, PatchFault, SheetPatch, clockwise};
use super::unrolled::{ChannelStrip, Unrolled};
use super::{Part, PassageId, SurfaceKind};
use nalgebra::{Point3, Rotation3, Vector2};
use nurbs::angle::nearest_turn;

/// Points of a line on the hub.
type HubLine = Vec<Point3<f64>>;

/// How far a cut leaves the line on which its face would go on, over the opening between the blades; and how far its blade at most.
const MAX_CUT_DEVIATION: f64 = 0.25;
const MAX_BLADE_DEVIATION: f64 = 0.45;

/// Least and largest share of its way to the circle after which a cut has left its blade.
const LEAVES: [f64; 2] = [0.3, 0.7];

/// Largest angle at which a cut leaves the line on which its face would go on, radians.
const MAX_CUT_ANGLE: f64 = 1.3;

/// Widths of the strip from one wall of a passage to the other, about; and from its middle to a wall.
const ABOUT: f64 = 0.5;

/// Share of the length of a blade in which its nose bulges.
const NOSE: f64 = 0.05;

/// Shares of the arc before a rounded edge at which its three parts end. The lines from the ends of the middle part run like the
/// cuts and spread: an edge across a blade that is inclined to the meridian would be in the way of others.
const ARCS: [f64; 4] = [0.0, 0.1, 0.9, 1.0];

/// The sense about Z from a face into its channel: 0 is the face that looks ahead.
fn outward(side: usize) -> f64 {
    if side == 0 { 1.0 } else { -1.0 }
}

/// A patch over the hub of sector 0.
pub(super) struct HubPatch {
    pub(super) patch: SheetPatch,
    /// The end of the last column that belongs to the next sector, from a row on, as its points are in sector 0.
    pub(super) next: Option<HubLine>,
}

/// Patches over the hub of sector 0, and the lines on the circles at its ends, counter-clockwise.
pub(super) struct HubPatches {
    pub(super) patches: Vec<HubPatch>,
    pub(super) rings: [Vec<(PatchDirection, HubLine)>; 2],
}

/// The hub with the blades on it.
struct Layout<'a> {
    form: &'a SheetForm<'a>,
    blades: &'a [BladeSheets],
    /// The plane in which the main blades are borders of their channels, for the patches between blades.
    channel: Unrolled<'a>,
    /// The plane that follows the channel smoothly, for the patches before blades.
    plane: Unrolled<'a>,
}

/// An end of the passage behind a blade.
struct PassageEnd {
    /// The line from blade to blade.
    between: HubLine,
    /// Cuts from both blades to the circle, or parts of the circle at blades that end on it; none where both end on it.
    cuts: Option<[HubLine; 2]>,
    /// The circle between the cuts.
    arc: HubLine,
    /// The second cut as it is in the sector of its blade.
    second: HubLine,
}

pub(super) fn hub_patches(form: &SheetForm<'_>, blades: &[BladeSheets]) -> Result<HubPatches, PatchFault> {
    let walls = strip(form.part, &blades[0]);
    let plane = Unrolled::along(&form.part.hub, walls.smooth());
    let layout = Layout { form, blades, channel: Unrolled::along(&form.part.hub, walls), plane };
    let passages: Vec<[PassageEnd; 2]> =
        (0..blades.len()).map(|k| [0, 1].map(|end| layout.passage_end(k, end))).collect();
    let mut found = HubPatches { patches: Vec::new(), rings: [Vec::new(), Vec::new()] };
    for k in 0..blades.len() {
        for end in [0, 1] {
            layout.before_blade(&passages, k, end, &mut found)?;
            layout.before_passage(&passages[k][end], k, end, &mut found)?;
        }
        layout.passage(&passages[k], k, &mut found)?;
    }
    Ok(found)
}

/// The channel between main blades on the hub: the faces are its borders.
fn strip(part: &Part, main: &BladeSheets) -> ChannelStrip {
    // The ahead face of a blade, and the face behind of the next one.
    let [ahead, behind] = main.faces.each_ref().map(|face| {
        let mut before = libm::atan2(face[0][0].y, face[0][0].x);
        let place = |p: &Point3<f64>| {
            let u = part.hub.closest(Vector2::new(libm::hypot(p.x, p.y), p.z)).0;
            before = nearest_turn(libm::atan2(p.y, p.x), before);
            [u, before, 0.0]
        };
        ChannelStrip::through(face[0].iter().map(place).collect())
    });
    let mut parameters: Vec<f64> = ahead.parameters().chain(behind.parameters()).collect();
    parameters.sort_by(f64::total_cmp);
    let from = parameters[0];
    // The blade between its faces is narrower than half a turn.
    let blade = behind.at(from)[0] - ahead.at(from)[0];
    let turn = nearest_turn(blade, 0.0) - blade + part.pitch();
    let place = |u: f64| {
        let [a, b] = [ahead.at(u)[0], behind.at(u)[0] + turn];
        [u, 0.5 * (a + b), b - a]
    };
    ChannelStrip::through(parameters.into_iter().map(place).collect())
}

impl Layout<'_> {
    fn shares(&self, direction: PatchDirection) -> &[f64] {
        self.form.shares.of(direction)
    }

    /// Index of the blade behind a passage, and the rotation and angle to its sector.
    fn next(&self, k: usize) -> (usize, Rotation3<f64>, f64) {
        let part = self.form.part;
        let next = (k + 1) % self.blades.len();
        let sector = u32::from(next == 0);
        (next, part.sector_rotation(sector % part.vane_count), part.pitch() * f64::from(sector))
    }

    /// Foot of a face of a blade at one end: 0 for the face that looks ahead.
    fn corner(&self, blade: usize, side: usize, end: usize) -> Point3<f64> {
        let foot = &self.blades[blade].faces[side][0];
        foot[end * (foot.len() - 1)]
    }

    fn passage_end(&self, k: usize, end: usize) -> PassageEnd {
        let (next, turn, _) = self.next(k);
        let [channel, before] = [PatchDirection::Channel, PatchDirection::Before].map(|d| self.shares(d));
        let [from, own] = [self.corner(k, 0, end), self.corner(next, 1, end)];
        let to = turn * own;
        let between = self.channel.line(&from, &to, ABOUT, channel);
        let inside = [k, next].map(|blade| self.blades[blade].ends[end].inside);
        if inside == [false; 2] {
            return PassageEnd { arc: between.clone(), between, cuts: None, second: Vec::new() };
        }
        let one = self.cut(k, 0, end, &from, &to);
        // As it is in the sector of its blade.
        let back = turn.inverse();
        let mut second: HubLine = self.cut(next, 1, end, &to, &from).iter().map(|p| back * p).collect();
        second[0] = own;
        let mut other: HubLine = second.iter().map(|p| turn * p).collect();
        other[0] = to;
        let arc = self.plane.line(&one[before.len() - 1], &other[before.len() - 1], ABOUT, channel);
        PassageEnd { between, cuts: Some([one, other]), arc, second }
    }

    /// The cut from a face of a blade at an end to the circle, on the side of the passage to the blade at `opposite`. At a blade that
    /// ends on the circle it is a part of the circle.
    fn cut(&self, blade: usize, side: usize, end: usize, from: &Point3<f64>, opposite: &Point3<f64>) -> HubLine {
        let shares = self.shares(PatchDirection::Before);
        let outward = outward(side);
        let start = self.plane.place(from, -ABOUT * outward);
        let circle = end as f64;
        if !self.blades[blade].ends[end].inside {
            let opposite = self.plane.place(opposite, start[1] + ABOUT * outward);
            let on_circle = self.plane.point([circle, start[1] + MAX_CUT_DEVIATION * (opposite[1] - start[1])]);
            return self.plane.line(from, &on_circle, 0.0, shares);
        }
        let depth = self.depth(blade, end, start[0]);
        let widths = start[1] + outward * self.leaves(blade, end)[side];
        let middle = [start[0] + depth * (circle - start[0]).signum(), widths];
        self.plane.parabola(from, [middle, [circle, widths]], shares)
    }

    /// Parameter of the hub after which a cut has left a blade that ends inside of the part: beside the nose of a rounded edge, or a part
    /// of the way to the circle.
    fn depth(&self, blade: usize, end: usize, start: f64) -> f64 {
        let way = end as f64 - start;
        let before = self.blades[blade].ends[end].parts.iter().flat_map(|(_, grid)| &grid[0]);
        let depths = before.map(|p| (self.plane.place(p, 0.0)[0] - start) * way.signum());
        depths.fold(0.0, f64::max).clamp(LEAVES[0] * way.abs(), LEAVES[1] * way.abs())
    }

    /// Widths by which the cuts from both faces of a blade leave it until the circle. Before a blade that is inclined, both cuts go
    /// to the same side. The one that follows must not cross the other: they come no nearer to each other than the faces are.
    fn leaves(&self, blade: usize, end: usize) -> [f64; 2] {
        let [ahead, behind] = [0, 1].map(|side| self.side_deviation(blade, side, end));
        let missing = (-ahead - behind).max(0.0);
        [ahead + 0.5 * missing, behind + 0.5 * missing]
    }

    /// Index of the place along a blade by which the direction of its end is found: behind the bulge of the nose.
    fn inner(&self, end: usize) -> usize {
        let along = &self.form.along;
        if end == 0 {
            along.partition_point(|share| *share < NOSE)
        } else {
            along.partition_point(|share| *share <= 1.0 - NOSE) - 1
        }
    }

    /// Widths by which a cut leaves its blade with regard to the channel beside it: half way between the line on which the face would
    /// go on and the line to the other blade.
    fn side_deviation(&self, blade: usize, side: usize, end: usize) -> f64 {
        let (outward, circle) = (outward(side), end as f64);
        // In the sector in which the plane runs like the channel.
        let (turn, opposite) = if side == 0 {
            let (next, turn, _) = self.next(blade);
            (Rotation3::identity(), turn * self.corner(next, 1, end))
        } else {
            let before = (blade + self.blades.len() - 1) % self.blades.len();
            (self.next(before).1, self.corner(before, 0, end))
        };
        let start = self.plane.place(&(turn * self.corner(blade, side, end)), -ABOUT * outward);
        let opposite = self.plane.place(&opposite, start[1] + ABOUT * outward);
        let opening = opposite[1] - start[1];
        let foot = &self.blades[blade].faces[side][0];
        let inner = turn * foot[self.inner(end)];
        let inner = self.plane.place(&inner, start[1]);
        let slope = (start[1] - inner[1]) / (start[0] - inner[0]);
        let way = circle - start[0];
        let depth = self.depth(blade, end, start[0]);
        // Half of the angle between the way on which the face would go on and the line to the other blade, in mm.
        let meridian = self.form.part.hub.meridian(start[0]);
        let [along, across] = [meridian.first.norm(), meridian.point.x * self.plane.width(start[0])];
        let on = [along, slope * way.signum() * outward * across];
        let over = [(opposite[0] - start[0]) * way.signum() * along, opening.abs() * across];
        let [on_angle, over_angle] = [on, over].map(|[x, y]| libm::atan2(y, x));
        let half = (0.5 * (on_angle + over_angle)).min(MAX_CUT_ANGLE);
        let deviation = slope * way.signum() * outward * depth + MAX_CUT_DEVIATION * opening.abs();
        (libm::tan(half) * depth * along / across).min(deviation).min(MAX_BLADE_DEVIATION * opening.abs())
    }

    /// Adds the patch between its first and last row, and its first and last column.
    fn add(
        &self,
        found: &mut HubPatches,
        kind: usize,
        directions: [PatchDirection; 2],
        rows: [&[Point3<f64>]; 2],
        columns: [&[Point3<f64>]; 2],
        next: Option<HubLine>,
    ) -> Result<(), PatchFault> {
        let kind = SurfaceKind::Hub(PassageId::new(kind));
        let shares = directions.map(|direction| self.shares(direction));
        let plane = if directions[1] == PatchDirection::Along { &self.channel } else { &self.plane };
        let rows = plane.filled(rows, columns, shares).ok_or(PatchFault::Folded(kind))?;
        let p = rows[rows.len() / 2][rows[0].len() / 2];
        let [u, _] = self.plane.place(&p, 0.0);
        let turned = clockwise(&rows, &self.form.part.hub.normal(u, libm::atan2(p.y, p.x)));
        found.patches.push(HubPatch { patch: SheetPatch { kind, directions, rows, turned }, next });
        Ok(())
    }

    /// The patch between the faces of a passage.
    fn passage(&self, ends: &[PassageEnd; 2], k: usize, found: &mut HubPatches) -> Result<(), PatchFault> {
        let (next, turn, angle) = self.next(k);
        let own = &self.blades[next].faces[1][0];
        let second: HubLine = own.iter().map(|p| turn * p).collect();
        let (rows, columns) =
            (ends.each_ref().map(|end| end.between.as_slice()), [self.blades[k].faces[0][0].as_slice(), &second]);
        let next = (angle > 0.0).then(|| own.clone());
        self.add(found, k, [PatchDirection::Channel, PatchDirection::Along], rows, columns, next)
    }

    /// The patch between a passage and the circle, and its part of the circle.
    fn before_passage(&self, at: &PassageEnd, k: usize, end: usize, found: &mut HubPatches) -> Result<(), PatchFault> {
        let Some([one, other]) = &at.cuts else {
            found.rings[end].push((PatchDirection::Channel, at.arc.clone()));
            return Ok(());
        };
        let (next, _, angle) = self.next(k);
        let inside = [k, next].map(|blade| self.blades[blade].ends[end].inside);
        if !inside[0] {
            found.rings[end].push((PatchDirection::Before, one.clone()));
        }
        found.rings[end].push((PatchDirection::Channel, at.arc.clone()));
        if !inside[1] {
            found.rings[end].push((PatchDirection::Before, other.iter().rev().copied().collect()));
        }
        let shared = if inside[1] { at.second.len() } else { 1 };
        let next = (angle > 0.0).then(|| at.second[..shared].to_vec());
        self.add(
            found,
            k,
            [PatchDirection::Channel, PatchDirection::Before],
            [&at.between, &at.arc],
            [one, other],
            next,
        )
    }

    /// The patches between an edge and the circle, and their parts of the circle.
    fn before_blade(
        &self,
        passages: &[[PassageEnd; 2]],
        k: usize,
        end: usize,
        found: &mut HubPatches,
    ) -> Result<(), PatchFault> {
        let sheets = &self.blades[k].ends[end];
        let feet: Vec<&HubLine> = sheets.parts.iter().map(|(_, grid)| &grid[0]).collect();
        if !sheets.inside {
            found.rings[end].extend(sheets.parts.iter().map(|(direction, grid)| (*direction, grid[0].clone())));
            return Ok(());
        }
        let before = &passages[(k + passages.len() - 1) % passages.len()][end];
        let Some([after, _]) = &passages[k][end].cuts else { return Ok(()) };
        let last = after.len() - 1;
        let count = feet.len();
        let mut side = before.second.clone();
        for (j, foot) in feet.into_iter().enumerate() {
            let direction = sheets.parts[j].0;
            let beyond = if j + 1 == count {
                after.clone()
            } else {
                self.plane.line_between(
                    &foot[foot.len() - 1],
                    [&before.second, after],
                    ARCS[j + 1],
                    self.shares(PatchDirection::Before),
                )
            };
            let on_circle = self.plane.line(&side[last], &beyond[last], 0.0, self.shares(direction));
            self.add(found, k, [direction, PatchDirection::Before], [foot, &on_circle], [&side, &beyond], None)?;
            found.rings[end].push((direction, on_circle));
            side = beyond;
        }
        Ok(())
    }
}
