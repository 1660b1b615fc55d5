//! Four-sided patches that cover the milled part of the wheel: faces, fillets, hub, tips and edges of the blades.
//!
//! Rows of a sheet run from the inlet line to the outlet line, which are the straight lines of the meridian plane between
//! the ends of hub and shroud. Hub, tips and both edges lie between the borders of sheets. Neighbouring patches share the
//! points of their borders, to the last bit, so that there are no gaps. Turned surfaces close the part between two circles.

use super::chart::charts;
use super::sheet::Sheet;
use super::{BladeId, FaceId, Part, SurfaceKind};
use crate::geom::Revolution;
use crate::geom::angle::nearest_turn;
use nalgebra::{Point3, Vector2, Vector3};

/// A direction of patches. All patches that meet in a border have the same steps along it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PatchDirection {
    /// Along a blade.
    Along,
    /// From the hub up a fillet.
    Fillet,
    /// Up a face.
    Face,
    /// Across a channel.
    Channel,
    /// Across a blade.
    Blade,
}

/// Numbers of steps in each [`PatchDirection`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Steps(pub [usize; 5]);

impl Steps {
    /// Number of steps in a direction.
    pub(super) fn of(&self, direction: PatchDirection) -> usize {
        self.0[direction as usize]
    }

    /// As many times the steps.
    #[must_use]
    pub(super) fn times(self, factor: usize) -> Self {
        Self(self.0.map(|n| n * factor))
    }
}

/// Spacing of the places along a blade.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Spacing {
    /// Equal steps.
    Equal,
    /// Shorter steps near both ends, where a fillet bends: the ball rolls beyond the ends of the face, which goes on straight.
    FineEnds,
}

impl Spacing {
    /// Shares of the way along a blade at equal steps of a parameter; their derivatives are continuous.
    fn shares(self, steps: usize) -> Vec<f64> {
        /// Share of the length near an end that is fine: fillets of the shipped wheels bend within a twentieth.
        const NEAR_END: f64 = 0.06;
        /// Density of places at an end, over that in the middle.
        const DENSER: f64 = 10.0;
        // Integral of 1 + DENSER (exp(-(s / NEAR_END)^2) + exp(-((1 - s) / NEAR_END)^2)).
        let bell = DENSER * NEAR_END / std::f64::consts::FRAC_2_SQRT_PI;
        let [at_end, whole] = [0.0, 1.0 / NEAR_END].map(libm::erf);
        let sum = |s: f64| s + bell * (libm::erf(s / NEAR_END) + whole - at_end - libm::erf((1.0 - s) / NEAR_END));
        let share = |t: f64| {
            let (mut low, mut high) = (0.0, 1.0);
            // Bisection down to rounding.
            for _ in 0..54 {
                let middle = 0.5 * (low + high);
                if sum(middle) < t * sum(1.0) { low = middle } else { high = middle }
            }
            0.5 * (low + high)
        };
        let equal = (0..=steps).map(|i| i as f64 / steps as f64);
        match self {
            Self::Equal => equal.collect(),
            Self::FineEnds => equal.map(|t| if t == 0.0 || t == 1.0 { t } else { share(t) }).collect(),
        }
    }
}

/// A surface over the unit square by points at equal steps.
#[derive(Clone, Debug)]
pub(super) struct SheetPatch {
    /// Kind of the surface.
    pub kind: SurfaceKind,
    /// Directions of its columns and of its rows.
    pub directions: [PatchDirection; 2],
    /// Rows of points.
    pub rows: Vec<Vec<Point3<f64>>>,
    /// True when columns and rows run clockwise as seen from outside.
    pub turned: bool,
}

/// Rows of points.
type Grid = Vec<Vec<Point3<f64>>>;

/// The patches of all sectors.
pub(super) struct Patches<'a> {
    part: &'a Part,
    steps: Steps,
    /// Sheets of the face that looks ahead and of the other, sector 0.
    sheets: [Grid; 2],
    /// Their faces.
    faces: [FaceId; 2],
    /// Row of a sheet at which the face begins.
    foot: usize,
    /// True when the meridian runs so that all patches are turned.
    turned: bool,
}

impl<'a> Patches<'a> {
    /// `None` when a fillet does not extend from inlet to outlet, and for a part with splitters or with edges that are
    /// surfaces of their own.
    pub(super) fn new(part: &'a Part, steps: Steps, spacing: Spacing) -> Option<Self> {
        if part.blades.len() > 1 || (0..2).any(|end| part.edge(BladeId::MAIN, end).is_some()) {
            return None;
        }
        let faces = part.first_passage().walls;
        let charts = charts(part);
        let up = [steps.of(PatchDirection::Fillet), steps.of(PatchDirection::Face)];
        let along = spacing.shares(steps.of(PatchDirection::Along));
        let [ahead, behind] = [Sheet::new(part, &charts, faces[0])?, Sheet::new(part, &charts, faces[1])?];
        let foot = if ahead.has_fillet() { up[0] } else { 0 };
        let mut sheets = [ahead.grid(&along, up)?, behind.grid(&along, up)?];
        sheets.iter_mut().for_each(|sheet| onto_hub(part, &mut sheet[0]));
        let mut patches = Self { part, steps, sheets, faces, foot, turned: false };
        let hub = patches.hub(0);
        let (i, j) = (hub.len() / 2, hub[0].len() / 2);
        let [p, q, s] = [hub[i][j], hub[i][j + 1], hub[i + 1][j]];
        let at = part.hub.closest(Vector2::new(libm::hypot(p.x, p.y), p.z)).0;
        let normal: Vector3<f64> = part.hub.normal(at, libm::atan2(p.y, p.x));
        patches.turned = (q - p).cross(&(s - p)).dot(&normal) < 0.0;
        Some(patches)
    }

    /// True when the meridian runs so that all patches are turned.
    pub(super) fn turned(&self) -> bool {
        self.turned
    }

    /// A sheet in a sector.
    fn sheet(&self, side: usize, sector: u32) -> Grid {
        let turn = self.part.sector_rotation(sector % self.part.vane_count);
        self.sheets[side].iter().map(|row| row.iter().map(|p| turn * p).collect()).collect()
    }

    /// The hub of the channel behind the blade of a sector: a row for each step along the blade.
    fn hub(&self, sector: u32) -> Grid {
        let [from, to] = [self.sheet(0, sector), self.sheet(1, sector + 1)];
        let across = (self.steps.of(PatchDirection::Channel), self.part.pitch());
        from[0].iter().zip(&to[0]).map(|(p, q)| bridge(p, q, across, Some(&self.part.hub))).collect()
    }

    /// Patches of a sector, and for each end of the hub the points on its circle, without the last.
    pub(super) fn of_sector(&self, sector: u32) -> (Vec<SheetPatch>, [Vec<Point3<f64>>; 2]) {
        let [ahead, behind] = [0, 1].map(|side| self.sheet(side, sector));
        let hub = self.hub(sector);
        let (top, foot) = (ahead.len() - 1, self.foot);
        let thick = (self.steps.of(PatchDirection::Blade), 0.0);
        let tip: Grid =
            behind[top].iter().zip(&ahead[top]).map(|(p, q)| bridge(p, q, thick, Some(&self.part.shroud))).collect();
        let mut patches = Vec::new();
        let mut add = |kind, directions, rows: &[Vec<Point3<f64>>], turned: bool| {
            patches.push(SheetPatch { kind, directions, rows: rows.to_vec(), turned: turned != self.turned });
        };
        let mut rings = [Vec::new(), Vec::new()];
        let blade = BladeId::MAIN;
        let kinds = [
            [SurfaceKind::InletRoot(blade), SurfaceKind::InletEdge(blade)],
            [SurfaceKind::OutletRoot(blade), SurfaceKind::OutletEdge(blade)],
        ];
        for (side, sheet) in [&ahead, &behind].into_iter().enumerate() {
            let face = self.faces[side];
            if foot > 0 {
                let up = [PatchDirection::Along, PatchDirection::Fillet];
                add(SurfaceKind::Fillet(face), up, &sheet[..=foot], side == 1);
            }
            add(SurfaceKind::Face(face), [PatchDirection::Along, PatchDirection::Face], &sheet[foot..], side == 1);
        }
        add(
            SurfaceKind::Hub(self.part.first_passage().id),
            [PatchDirection::Channel, PatchDirection::Along],
            &hub,
            false,
        );
        add(SurfaceKind::Tip(blade), [PatchDirection::Blade, PatchDirection::Along], &tip, false);
        for (end, [at, ring]) in [(0, [0, 0]), (1, [hub.len() - 1, 1])] {
            let mut edge: Grid = (0..top).map(|j| bridge(&behind[j][at], &ahead[j][at], thick, None)).collect();
            edge.push(tip[at].clone());
            rings[ring].extend_from_slice(&edge[0][..thick.0]);
            rings[ring].extend_from_slice(&hub[at][..hub[at].len() - 1]);
            if foot > 0 {
                add(kinds[end][0], [PatchDirection::Blade, PatchDirection::Fillet], &edge[..=foot], end != 0);
            }
            add(kinds[end][1], [PatchDirection::Blade, PatchDirection::Face], &edge[foot..], end != 0);
        }
        (patches, rings)
    }
}

/// Moves the points of a border onto the hub, from its inlet to its outlet: tables of fillets are exact to 1 nm.
fn onto_hub(part: &Part, row: &mut [Point3<f64>]) {
    let last = row.len() - 1;
    for (i, p) in row.iter_mut().enumerate() {
        let u = match i {
            0 => 0.0,
            _ if i == last => 1.0,
            _ => part.hub.closest(Vector2::new(libm::hypot(p.x, p.y), p.z)).0,
        };
        *p = part.hub.point(u, libm::atan2(p.y, p.x));
    }
}

/// Equal steps around Z from one point to another, both included; on a surface, or on the straight line between their
/// places in the meridian plane. The angle is the one within half a turn of `about`.
fn bridge(
    from: &Point3<f64>,
    to: &Point3<f64>,
    (steps, about): (usize, f64),
    on: Option<&Revolution>,
) -> Vec<Point3<f64>> {
    let flat = |p: &Point3<f64>| Vector2::new(libm::hypot(p.x, p.y), p.z);
    let (a, b) = (flat(from), flat(to));
    let start = libm::atan2(from.y, from.x);
    let turn = libm::atan2(to.y, to.x) - start;
    let turn = nearest_turn(turn, about);
    let ends = on.map(|s| [s.closest(a).0, s.closest(b).0]);
    (0..=steps)
        .map(|k| {
            let t = k as f64 / steps as f64;
            let azimuth = start + turn * t;
            match (k, on, ends) {
                (0, ..) => *from,
                (k, ..) if k == steps => *to,
                (_, Some(surface), Some([u, v])) => surface.point(u + (v - u) * t, azimuth),
                _ => {
                    let p = a + (b - a) * t;
                    Point3::new(p.x * libm::cos(azimuth), p.x * libm::sin(azimuth), p.y)
                }
            }
        })
        .collect()
}
