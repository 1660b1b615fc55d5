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
use super::patch::{PatchDirection, PatchFault, PointRows, SheetPatch, clockwise};
use super::unrolled::Unrolled;
use super::{Part, PassageId, SurfaceKind};
use crate::geom::angle::nearest_turn;
use nalgebra::{Point3, Rotation3, Vector2};

/// Points of a line on the hub.
type HubLine = Vec<Point3<f64>>;

/// How far a cut leaves the line on which its face would go on, over the opening between the blades; and how far its blade at most.
const BESIDE: f64 = 0.25;
const MOST: f64 = 0.45;

/// Least and largest share of its way to the circle after which a cut has left its blade.
const LEAVES: [f64; 2] = [0.3, 0.7];

/// Largest angle at which a cut leaves the line on which its face would go on, radians.
const STEEPEST: f64 = 1.3;

/// Widths of the strip from one wall of a passage to the other, about; and from its middle to a wall.
const ABOUT: f64 = 0.5;

/// Shares of the arc before a rounded edge that its three parts have, with both ends. The lines from the ends of the middle part
/// spread: an edge across a blade that is inclined to the meridian would be in the way of straight ones.
const ARCS: [f64; 4] = [0.0, 0.1, 0.9, 1.0];

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
    let layout = Layout { form, blades, plane: Unrolled::along(&form.part.hub, strip(form.part, &blades[0])) };
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

/// Places of the channel between main blades on the hub: parameter of the hub, azimuth, width in radians.
fn strip(part: &Part, main: &BladeSheets) -> [[f64; 3]; 4] {
    let [ahead, behind] = main.faces.each_ref().map(|face| &face[0]);
    let mut before = None;
    [0, 1, 2, 3].map(|k| {
        let at = k * (ahead.len() - 1) / 3;
        let [p, q] = [behind[at], ahead[at]];
        let [u, v] = [p, q].map(|p| part.hub.closest(Vector2::new(libm::hypot(p.x, p.y), p.z)).0);
        let first = libm::atan2(p.y, p.x);
        let blade = nearest_turn(libm::atan2(q.y, q.x) - first, 0.0);
        let azimuth = nearest_turn(first + 0.5 * (blade + part.pitch()), before.unwrap_or(first));
        before = Some(azimuth);
        [0.5 * (u + v), azimuth, part.pitch() - blade]
    })
}

impl Layout<'_> {
    fn steps(&self, direction: PatchDirection) -> usize {
        self.form.steps.of(direction)
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
        let [channel, before] = [PatchDirection::Channel, PatchDirection::Before].map(|d| self.steps(d));
        let [from, own] = [self.corner(k, 0, end), self.corner(next, 1, end)];
        let to = turn * own;
        let between = self.plane.line(&from, &to, ABOUT, channel);
        let inside = [k, next].map(|blade| self.blades[blade].ends[end].inside);
        if inside == [false; 2] {
            return PassageEnd { arc: between.clone(), between, cuts: None, second: Vec::new() };
        }
        let one = self.cut((k, 0, end), &Rotation3::identity(), &from, &to);
        // As it is in the sector of its blade.
        let back = turn.inverse();
        let mut second: HubLine = self.cut((next, 1, end), &turn, &to, &from).iter().map(|p| back * p).collect();
        second[0] = own;
        let mut other: HubLine = second.iter().map(|p| turn * p).collect();
        other[0] = to;
        let arc = self.plane.line(&one[before], &other[before], ABOUT, channel);
        PassageEnd { between, cuts: Some([one, other]), arc, second }
    }

    /// The cut from a face of a blade at an end to the circle, on the side of the passage to the blade at `opposite`. It leaves the
    /// blade half way between the line on which the face would go on and the line to that blade. At a blade that ends on the circle it is a part of the
    /// circle.
    fn cut(
        &self,
        (blade, side, end): (usize, usize, usize),
        turn: &Rotation3<f64>,
        from: &Point3<f64>,
        opposite: &Point3<f64>,
    ) -> HubLine {
        let steps = self.steps(PatchDirection::Before);
        let outward = if side == 0 { 1.0 } else { -1.0 };
        let start = self.plane.place(from, -ABOUT * outward);
        let opposite = self.plane.place(opposite, start[1] + ABOUT * outward);
        let opening = opposite[1] - start[1];
        let circle = end as f64;
        let sheets = &self.blades[blade].ends[end];
        if !sheets.inside {
            let on_circle = self.plane.point([circle, start[1] + BESIDE * opening]);
            return self.plane.line(from, &on_circle, 0.0, steps);
        }
        let foot = &self.blades[blade].faces[side][0];
        let inner = turn * foot[if end == 0 { 1 } else { foot.len() - 2 }];
        let inner = self.plane.place(&inner, start[1]);
        let slope = (start[1] - inner[1]) / (start[0] - inner[0]);
        // Beside the nose of a rounded edge, or a part of the way to the circle.
        let way = circle - start[0];
        let before = sheets.parts.iter().flat_map(|(_, grid)| &grid[0]);
        let depths = before.map(|p| (self.plane.place(p, 0.0)[0] - start[0]) * way.signum());
        let depth = depths.fold(0.0, f64::max).clamp(LEAVES[0] * way.abs(), LEAVES[1] * way.abs());
        // Half of the angle between the way on which the face would go on and the line to the other blade, in mm.
        let meridian = self.form.part.hub.meridian(start[0]);
        let [along, across] = [meridian.first.norm(), meridian.point.x * self.plane.width(start[0])];
        let on = [along, slope * way.signum() * outward * across];
        let over = [(opposite[0] - start[0]) * way.signum() * along, opening.abs() * across];
        let [on_angle, over_angle] = [on, over].map(|[x, y]| libm::atan2(y, x));
        let half = (0.5 * (on_angle + over_angle)).min(STEEPEST);
        let beside = slope * way.signum() * outward * depth + BESIDE * opening.abs();
        let beyond = (libm::tan(half) * depth * along / across).min(beside).min(MOST * opening.abs());
        let widths = start[1] + outward * beyond;
        self.plane.parabola(from, [[start[0] + depth * way.signum(), widths], [circle, widths]], steps)
    }

    fn add(
        &self,
        found: &mut HubPatches,
        kind: usize,
        directions: [PatchDirection; 2],
        rows: PointRows,
        next: Option<HubLine>,
    ) {
        let p = rows[rows.len() / 2][rows[0].len() / 2];
        let [u, _] = self.plane.place(&p, 0.0);
        let turned = clockwise(&rows, &self.form.part.hub.normal(u, libm::atan2(p.y, p.x)));
        let kind = SurfaceKind::Hub(PassageId::new(kind));
        found.patches.push(HubPatch { patch: SheetPatch { kind, directions, rows, turned }, next });
    }

    fn filled(&self, k: usize, rows: [&[Point3<f64>]; 2], sides: [&[Point3<f64>]; 2]) -> Result<PointRows, PatchFault> {
        self.plane.filled(rows, sides).ok_or(PatchFault::Folded(SurfaceKind::Hub(PassageId::new(k))))
    }

    /// The patch between the faces of a passage.
    fn passage(&self, ends: &[PassageEnd; 2], k: usize, found: &mut HubPatches) -> Result<(), PatchFault> {
        let (next, turn, angle) = self.next(k);
        let own = &self.blades[next].faces[1][0];
        let second: HubLine = own.iter().map(|p| turn * p).collect();
        let rows = self.filled(k, [&ends[0].between, &ends[1].between], [&self.blades[k].faces[0][0], &second])?;
        let next = (angle > 0.0).then(|| own.clone());
        self.add(found, k, [PatchDirection::Channel, PatchDirection::Along], rows, next);
        Ok(())
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
        let rows = self.filled(k, [&at.between, &at.arc], [one, other])?;
        let shared = if inside[1] { at.second.len() } else { 1 };
        let next = (angle > 0.0).then(|| at.second[..shared].to_vec());
        self.add(found, k, [PatchDirection::Channel, PatchDirection::Before], rows, next);
        Ok(())
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
        let [low, high] = [before.second[last], after[last]];
        let from = self.plane.place(&low, 0.0)[1];
        let arc = self.plane.place(&high, from + ABOUT)[1] - from;
        let count = feet.len();
        let mut side = before.second.clone();
        for (j, foot) in feet.into_iter().enumerate() {
            let direction = sheets.parts[j].0;
            let beyond = if j + 1 == count {
                after.clone()
            } else {
                let to = self.plane.point([end as f64, from + arc * ARCS[j + 1]]);
                self.plane.line(&foot[foot.len() - 1], &to, 0.0, last)
            };
            let on_circle = self.plane.line(&side[last], &beyond[last], 0.0, self.steps(direction));
            let rows = self.filled(k, [foot, &on_circle], [&side, &beyond])?;
            self.add(found, k, [direction, PatchDirection::Before], rows, None);
            found.rings[end].push((direction, on_circle));
            side = beyond;
        }
        Ok(())
    }
}
