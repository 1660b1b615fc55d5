//! Grids of points over a blade: its faces with their fillets, its edges, its tip.

use super::chart::Chart;
use super::patch::{PatchDirection, PatchFault, PointRows, Shares, SheetPatch, clockwise};
use super::sheet::Sheet;
use super::unrolled::Unrolled;
use super::{BladeId, FaceId, Part, Surface, SurfaceKind};
use nalgebra::{Point3, Vector2, Vector3};
use nurbs::Revolution;
use nurbs::angle::nearest_turn;

/// Distance from the circle at the end of the hub below which a blade ends there, mm: tables of fillets are exact to 1 nm.
const ON_CIRCLE: f64 = 1e-4;

/// Largest distance of the border of an edge from the end of a face, mm: the surfaces are made with one border.
const SAME_BORDER: f64 = 1e-5;

/// u of a rounded edge between which its middle part lies, with both ends.
const EDGE_PARTS: [f64; 4] = [0.0, 0.25, 0.75, 1.0];

/// Grids over a blade of sector 0. Their rows run from the hub to the shroud.
pub(super) struct BladeSheets {
    blade: BladeId,
    /// Faces: the one that looks ahead, and the other.
    sides: [FaceId; 2],
    /// Their grids, from the leading to the trailing edge.
    pub(super) faces: [PointRows; 2],
    /// Leading and trailing edge.
    pub(super) ends: [EndSheets; 2],
    /// Row at which the faces begin; 0 without fillets.
    foot: usize,
}

/// Grids over an edge, from the face behind to the face ahead.
pub(super) struct EndSheets {
    /// Directions across, and grids.
    pub(super) parts: Vec<(PatchDirection, PointRows)>,
    /// The edge, where it is a surface of its own.
    rounded: Option<FaceId>,
    /// True when the blade ends before the circle at the end of the hub.
    pub(super) inside: bool,
}

/// What the grids of a blade are made with.
pub(super) struct SheetForm<'a> {
    pub(super) part: &'a Part,
    pub(super) charts: &'a [Chart<'a>],
    pub(super) shares: &'a Shares,
    /// Shares of the way along a blade.
    pub(super) along: Vec<f64>,
}

impl BladeSheets {
    pub(super) fn new(form: &SheetForm<'_>, blade: BladeId) -> Result<Self, PatchFault> {
        let part = form.part;
        let ahead = part.face_ahead(blade);
        let sides = [ahead, ahead.other()];
        let up = [PatchDirection::Fillet, PatchDirection::Face].map(|d| form.shares.of(d));
        let sheet = |id: FaceId, along: &[f64]| {
            let fault = PatchFault::Fillet(SurfaceKind::Face(id));
            Sheet::new(part, form.charts, id).and_then(|sheet| sheet.grid(along, up)).ok_or(fault)
        };
        let mut faces = [sheet(sides[0], &form.along)?, sheet(sides[1], &form.along)?];
        let last = form.along.len() - 1;
        let inside = [0, 1].map(|end| {
            let circle = part.hub.meridian(end as f64).point;
            let off = |p: &Point3<f64>| libm::hypot(libm::hypot(p.x, p.y) - circle.x, p.z - circle.y) > ON_CIRCLE;
            faces.iter().any(|face| off(&face[0][end * last]))
        });
        for face in &mut faces {
            let ends = [0, 1].map(|end| (!inside[end]).then_some(end as f64));
            onto_hub(part, &mut face[0], ends);
        }
        let foot = if part.blade(blade).fillet.is_some() { up[0].len() - 1 } else { 0 };
        let end = |end: usize| -> Result<EndSheets, PatchFault> {
            let columns = [1, 0].map(|side| column(&faces[side], end * last));
            let rounded = part.edge(blade, end);
            let parts = match rounded {
                Some(edge) => rounded_edge(form, edge, sides[1].index() == 1, &columns, &sheet)?,
                None => vec![(PatchDirection::Blade, turned_edge(form, &columns, inside[end]))],
            };
            Ok(EndSheets { parts, rounded, inside: inside[end] })
        };
        let ends = [end(0)?, end(1)?];
        Ok(Self { blade, sides, faces, ends, foot })
    }

    /// Patches of faces, fillets, edges and tip.
    pub(super) fn patches(&self, form: &SheetForm<'_>) -> Result<Vec<SheetPatch>, PatchFault> {
        let part = form.part;
        let mut patches = Vec::new();
        for (face, grid) in self.sides.iter().zip(&self.faces) {
            let turned = clockwise(grid, &part.face(*face).normal(0.5, 0.5));
            let kinds = [SurfaceKind::Fillet(*face), SurfaceKind::Face(*face)];
            self.up(&mut patches, kinds, PatchDirection::Along, grid, turned);
        }
        for (end, sheets) in self.ends.iter().enumerate() {
            let [root, edge] = [
                [SurfaceKind::InletRoot(self.blade), SurfaceKind::InletEdge(self.blade)],
                [SurfaceKind::OutletRoot(self.blade), SurfaceKind::OutletEdge(self.blade)],
            ][end];
            let foot = sheets.rounded.map_or(root, SurfaceKind::Fillet);
            for (k, (direction, grid)) in sheets.parts.iter().enumerate() {
                let outward = match sheets.rounded {
                    Some(id) => {
                        let at = if self.sides[1].index() == 1 { EDGE_PARTS.len() - 2 - k } else { k };
                        part.face(id).normal(0.5 * (EDGE_PARTS[at] + EDGE_PARTS[at + 1]), 0.5)
                    }
                    None => {
                        part.blade(self.blade).faces[0].surface.tangents(end as f64, 0.5).1 * (2.0 * end as f64 - 1.0)
                    }
                };
                self.up(&mut patches, [foot, edge], *direction, grid, clockwise(grid, &outward));
            }
        }
        self.tip(form, &mut patches)?;
        Ok(patches)
    }

    /// Adds the patches of a grid below and above the upper border of the fillet.
    fn up(
        &self,
        patches: &mut Vec<SheetPatch>,
        [below, above]: [SurfaceKind; 2],
        across: PatchDirection,
        grid: &PointRows,
        turned: bool,
    ) {
        let mut add = |kind, up, rows: &[Vec<Point3<f64>>]| {
            patches.push(SheetPatch { kind, directions: [across, up], rows: rows.to_vec(), turned });
        };
        if self.foot > 0 {
            add(below, PatchDirection::Fillet, &grid[..=self.foot]);
        }
        add(above, PatchDirection::Face, &grid[self.foot..]);
    }

    /// Adds the patches of the tip: one between the faces, and one at each rounded edge.
    fn tip(&self, form: &SheetForm<'_>, patches: &mut Vec<SheetPatch>) -> Result<(), PatchFault> {
        let part = form.part;
        let [ahead, behind] = self.faces.each_ref().map(|face| &face[face.len() - 1]);
        let shares = form.shares.of(PatchDirection::Blade);
        let rows: PointRows = behind.iter().zip(ahead).map(|(p, q)| bridge(p, q, shares, Some(&part.shroud))).collect();
        let kind = SurfaceKind::Tip(self.blade);
        let mut add = |rows: PointRows, along| {
            let p = rows[rows.len() / 2][rows[0].len() / 2];
            let u = part.shroud.closest(Vector2::new(libm::hypot(p.x, p.y), p.z)).0;
            let normal: Vector3<f64> = part.shroud.normal(u, libm::atan2(p.y, p.x));
            let turned = clockwise(&rows, &normal);
            patches.push(SheetPatch { kind, directions: [PatchDirection::Blade, along], rows, turned });
        };
        let shroud = Unrolled::straight(&part.shroud);
        for (end, sheets) in self.ends.iter().enumerate() {
            let tops: Vec<&Vec<Point3<f64>>> = sheets.parts.iter().map(|(_, grid)| &grid[grid.len() - 1]).collect();
            if let [first, middle, last] = tops[..] {
                let across = &rows[end * (rows.len() - 1)];
                let last: Vec<Point3<f64>> = last.iter().rev().copied().collect();
                let places = [PatchDirection::Blade, PatchDirection::Shoulder].map(|d| form.shares.of(d));
                let cap = shroud.filled([across, middle], [first, &last], places).ok_or(PatchFault::Folded(kind))?;
                add(cap, PatchDirection::Shoulder);
            }
        }
        add(rows, PatchDirection::Along);
        Ok(())
    }
}

/// A column of a grid.
fn column(grid: &PointRows, at: usize) -> Vec<Point3<f64>> {
    grid.iter().map(|row| row[at]).collect()
}

/// Grids over an edge that the lathe makes, between the ends of the face behind and of the face ahead.
fn turned_edge(form: &SheetForm<'_>, [behind, ahead]: &[Vec<Point3<f64>>; 2], inside: bool) -> PointRows {
    let shares = form.shares.of(PatchDirection::Blade);
    let top = behind.len() - 1;
    let on = |j: usize| match j {
        0 if inside => Some(&form.part.hub),
        j if j == top => Some(&form.part.shroud),
        _ => None,
    };
    behind.iter().zip(ahead).enumerate().map(|(j, (p, q))| bridge(p, q, shares, on(j))).collect()
}

/// Grids over the three parts of an edge that is a surface of its own, from the face behind to the face ahead.
fn rounded_edge(
    form: &SheetForm<'_>,
    edge: FaceId,
    reversed: bool,
    faces: &[Vec<Point3<f64>>; 2],
    sheet: &impl Fn(FaceId, &[f64]) -> Result<PointRows, PatchFault>,
) -> Result<Vec<(PatchDirection, PointRows)>, PatchFault> {
    let directions = [PatchDirection::Shoulder, PatchDirection::Blade, PatchDirection::Shoulder];
    let mut parts = Vec::new();
    for (direction, range) in directions.into_iter().zip(EDGE_PARTS.windows(2)) {
        let share = |t: &f64| if *t == 1.0 { range[1] } else { range[0] + (range[1] - range[0]) * t };
        let mut shares: Vec<f64> = form.shares.of(direction).iter().map(share).collect();
        if reversed {
            shares.iter_mut().for_each(|s| *s = 1.0 - *s);
        }
        let mut grid = sheet(edge, &shares)?;
        onto_hub(form.part, &mut grid[0], [None, None]);
        parts.push((direction, grid));
    }
    // The faces and the edge share their borders.
    let kind = SurfaceKind::Face(edge);
    for (k, face) in [(0, &faces[0]), (parts.len() - 1, &faces[1])] {
        for (row, p) in parts[k].1.iter_mut().zip(face) {
            let at = if k == 0 { 0 } else { row.len() - 1 };
            let off = (row[at] - p).norm();
            if off > SAME_BORDER {
                return Err(PatchFault::Gap(kind, off));
            }
            row[at] = *p;
        }
    }
    Ok(parts)
}

/// Moves the points of a border onto the hub; where an end has a parameter of the hub, its point is there.
fn onto_hub(part: &Part, row: &mut [Point3<f64>], ends: [Option<f64>; 2]) {
    let last = row.len() - 1;
    for (i, p) in row.iter_mut().enumerate() {
        let stated = match i {
            0 => ends[0],
            _ if i == last => ends[1],
            _ => None,
        };
        let u = stated.unwrap_or_else(|| part.hub.closest(Vector2::new(libm::hypot(p.x, p.y), p.z)).0);
        *p = part.hub.point(u, libm::atan2(p.y, p.x));
    }
}

/// Points at shares of the way around Z from one point to another, both included, the shorter way: on a surface, or on the straight
/// line between their places in the meridian plane.
fn bridge(from: &Point3<f64>, to: &Point3<f64>, shares: &[f64], on: Option<&Revolution>) -> Vec<Point3<f64>> {
    let flat = |p: &Point3<f64>| Vector2::new(libm::hypot(p.x, p.y), p.z);
    let (a, b) = (flat(from), flat(to));
    let start = libm::atan2(from.y, from.x);
    let turn = nearest_turn(libm::atan2(to.y, to.x) - start, 0.0);
    let ends = on.map(|s| [s.closest(a).0, s.closest(b).0]);
    let at = |t: &f64| {
        let azimuth = start + turn * t;
        match (on, ends) {
            _ if *t == 0.0 => *from,
            _ if *t == 1.0 => *to,
            (Some(surface), Some([u, v])) => surface.point(u + (v - u) * t, azimuth),
            _ => {
                let p = a + (b - a) * *t;
                Point3::new(p.x * libm::cos(azimuth), p.x * libm::sin(azimuth), p.y)
            }
        }
    };
    shares.iter().map(at).collect()
}
