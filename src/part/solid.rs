//! The finished part as a closed triangle mesh, from the design surfaces only, and its volume.
//!
//! A wall of a channel is one sheet: from the contact with the hub along the rolling ball, then up the ruling to the
//! shroud. Rows of a sheet run from the inlet line to the outlet line, which are the straight lines of the meridian
//! plane between the ends of hub and shroud. Hub, tips and both edges lie between the borders of sheets; front, bore,
//! back and outside of the blank close the mesh. Neighbouring grids share the points of their borders, so that there
//! are no gaps.

use super::chart::{Chart, Shape, charts};
use super::{FaceId, FaceSurface, Part, Stock, Surface, SurfaceKind};
use crate::geom::Revolution;
use crate::geom::angle::nearest_turn;
use crate::geom::proximity::Patch;
use crate::stock::Mesh;
use nalgebra::{Point3, Vector2};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// A volume with an estimate of its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Volume {
    /// Volume, mm3.
    pub value: f64,
    /// Difference of the last two refinements, mm3: an upper bound of the error.
    pub error: f64,
}

/// Steps of a grid along and up a wall, across a channel, and across a vane.
const STEPS: [usize; 4] = [24, 12, 12, 4];

/// Volume of the finished part: all vanes milled, no stock over the shroud. The error of chords of uniform grids is
/// quadratic in the step; two refinements remove it.
///
/// `None` when a fillet does not extend from inlet to outlet, and for a part with splitters.
pub fn volume(part: &Part, stock: &Stock) -> Option<Volume> {
    let of = |factor: usize| mesh(part, stock, STEPS.map(|n| n * factor)).map(|solid| solid.volume());
    let (coarse, middle, fine) = (of(1)?, of(2)?, of(4)?);
    let without_square = |coarse: f64, fine: f64| fine + (fine - coarse) / 3.0;
    let (before, value) = (without_square(coarse, middle), without_square(middle, fine));
    Some(Volume { value, error: (value - before).abs() })
}

/// Mesh of the finished part; the steps are those along a wall, up each of its two surfaces, across a channel, and
/// across a vane. `None` as for [`volume`].
pub fn mesh(part: &Part, stock: &Stock, [along, up, across, thick]: [usize; 4]) -> Option<Mesh> {
    if part.blades.len() > 1 {
        return None;
    }
    let [ahead, behind] = part.first_passage().walls;
    let charts = charts(part);
    let sheets = [Sheet::new(part, &charts, ahead)?, Sheet::new(part, &charts, behind)?];
    let (ahead, behind) = (sheets[0].grid(along, up)?, sheets[1].grid(along, up)?);
    let top = ahead.len() - 1;
    let mut mesh = Mesher::default();
    // Circles at both ends of the hub: borders to the other turned surfaces.
    let mut rings: [Vec<Point3<f64>>; 2] = [Vec::new(), Vec::new()];
    for sector in 0..part.vane_count {
        let turned = |grid: &[Vec<Point3<f64>>], sector: u32| -> Vec<Vec<Point3<f64>>> {
            let turn = part.sector_rotation(sector % part.vane_count);
            grid.iter().map(|row| row.iter().map(|p| turn * p).collect()).collect()
        };
        let (a, b, next) = (turned(&ahead, sector), turned(&behind, sector), turned(&behind, sector + 1));
        let hub: Vec<Vec<Point3<f64>>> =
            a[0].iter().zip(&next[0]).map(|(p, q)| bridge(p, q, (across, part.pitch()), Some(&part.hub))).collect();
        let tip: Vec<Vec<Point3<f64>>> =
            b[top].iter().zip(&a[top]).map(|(p, q)| bridge(p, q, (thick, 0.0), Some(&part.shroud))).collect();
        for (end, ring) in [0, along].into_iter().zip(&mut rings) {
            let mut edge: Vec<Vec<Point3<f64>>> =
                (0..top).map(|j| bridge(&b[j][end], &a[j][end], (thick, 0.0), None)).collect();
            edge.push(tip[end].clone());
            ring.extend_from_slice(&edge[0][..thick]);
            ring.extend_from_slice(&hub[end][..across]);
            mesh.grid(&edge, end != 0);
        }
        mesh.grid(&a, false);
        mesh.grid(&b, true);
        mesh.grid(&hub, false);
        mesh.grid(&tip, false);
    }
    // Over front, bore, back and outside from the first circle to the second.
    let [first, last] = &mut rings;
    let corners = turned_rest(part, stock);
    let half = corners.len() / 2;
    let mut grid: Vec<Vec<Point3<f64>>> = vec![first.clone()];
    for (k, [r, z]) in corners.iter().enumerate() {
        let ring: &[Point3<f64>] = if k < half { first } else { last };
        grid.push(
            ring.iter()
                .map(|p| {
                    let radius = libm::hypot(p.x, p.y);
                    Point3::new(p.x / radius * r, p.y / radius * r, *z)
                })
                .collect(),
        );
    }
    grid.push(last.clone());
    for row in &mut grid {
        let start = row[0];
        row.push(start);
    }
    mesh.grid(&grid, true);
    let mut solid = mesh.solid;
    // The orientation of all grids depends on that of the channel.
    if solid.volume() < 0.0 {
        solid.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    Some(solid)
}

/// Corners of the other turned surfaces between the circles, (r, z): two on the side of the inlet, two on the side of
/// the outlet.
fn turned_rest(part: &Part, stock: &Stock) -> [[f64; 2]; 4] {
    let (front, bore, back) = (part.hub.meridian(0.0).point.y, stock.bore_radius.get(), stock.back.get());
    let outlet = part.hub.meridian(1.0).point;
    let outside = stock.profile.last().map_or(outlet.x, |p| p[0]);
    [[bore, front], [bore, back], [outside, back], [outside, outlet.y]]
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

/// A wall of a channel with its fillet, sector 0.
pub(super) struct Sheet<'a> {
    part: &'a Part,
    id: FaceId,
    fillet: Option<&'a Chart<'a>>,
    /// Range of u in which the wall is defined.
    range: [f64; 2],
}

impl<'a> Sheet<'a> {
    pub(super) fn new(part: &'a Part, charts: &'a [Chart<'a>], id: FaceId) -> Option<Self> {
        let fillet = charts.iter().find(|c| c.kind == SurfaceKind::Fillet(id));
        if part.fillet(id).is_some() && fillet.is_none() {
            return None;
        }
        let range = match fillet {
            Some(chart) => [chart.place(0.0, 0.0).parameters[0], chart.place(1.0, 0.0).parameters[0]],
            // The guides continue along their tangents.
            None => [-0.2, 1.2],
        };
        Some(Self { part, id, fillet, range })
    }

    /// Point at u; `w` from 0 to 1 goes along the fillet, from 1 to 2 up the ruling.
    pub(super) fn point(&self, u: f64, w: f64) -> Point3<f64> {
        let surface = &self.part.face(self.id).surface;
        let low = match self.fillet {
            Some(chart) => {
                let x = (u - self.range[0]) / (self.range[1] - self.range[0]);
                if w < 1.0 {
                    return chart.place(x, 1.0 - w).position;
                }
                let contact = chart.place(x, 0.0).position;
                match surface {
                    FaceSurface::Ruled(ruled) => {
                        let (root, _, ruling) = ruled.tangents(u, 0.0);
                        (contact - root).dot(&ruling) / ruling.norm_squared()
                    }
                    FaceSurface::Lofted(lofted) => lofted.closest(&contact, Patch { u: [u, u], v: [-0.5, 1.5] }).v,
                }
            }
            None => self.part.ruling_meets(self.id, u, &self.part.hub, 0.0),
        };
        let high = self.part.ruling_meets(self.id, u, &self.part.shroud, 1.0);
        surface.point(u, low + (high - low) * (w - 1.0))
    }

    /// Rows from hub to shroud, each from the inlet line to the outlet line.
    fn grid(&self, along: usize, up: usize) -> Option<Vec<Vec<Point3<f64>>>> {
        let rows = if self.fillet.is_some() { 0..=2 * up } else { up..=2 * up };
        rows.into_par_iter().map(|j| self.row(along, j as f64 / up as f64)).collect()
    }

    fn row(&self, along: usize, w: f64) -> Option<Vec<Point3<f64>>> {
        let ends = [self.meets(0.0, w)?, self.meets(1.0, w)?];
        let at = |i: usize| self.point(ends[0] + (ends[1] - ends[0]) * i as f64 / along as f64, w);
        Some((0..=along).map(at).collect())
    }

    /// u at which a row meets the line in the meridian plane between the ends of hub and shroud at u = 0 or 1.
    pub(super) fn meets(&self, end: f64, w: f64) -> Option<f64> {
        let [hub, shroud] = self.part.end_line(self.id.blade, end);
        let normal = Vector2::new(hub.y - shroud.y, shroud.x - hub.x).normalize();
        let gap = |u: f64| {
            let p = self.point(u, w);
            (Vector2::new(libm::hypot(p.x, p.y), p.z) - hub).dot(&normal)
        };
        let (mut out, mut inside) = (self.range[end as usize], 0.5);
        let sign = gap(inside).signum();
        if gap(out) * sign > 0.0 {
            return None;
        }
        // Bisection of a wall of some 100 mm down to rounding.
        for _ in 0..48 {
            let u = 0.5 * (out + inside);
            if gap(u) * sign > 0.0 { inside = u } else { out = u }
        }
        Some(0.5 * (out + inside))
    }
}

/// Joins grids that share the points of their borders to one solid.
#[derive(Default)]
struct Mesher {
    solid: Mesh,
    known: BTreeMap<[u64; 3], u32>,
}

impl Mesher {
    fn vertex(&mut self, p: &Point3<f64>) -> u32 {
        // Adding zero maps negative zero to positive zero.
        let key = [p.x, p.y, p.z].map(|x| (x + 0.0).to_bits());
        let next = self.solid.vertices.len() as u32;
        let index = *self.known.entry(key).or_insert(next);
        if index == next {
            self.solid.vertices.push(*p);
        }
        index
    }

    /// Two triangles per cell; `turned` when rows and columns run clockwise as seen from outside.
    fn grid(&mut self, rows: &[Vec<Point3<f64>>], turned: bool) {
        let indices: Vec<Vec<u32>> = rows.iter().map(|row| row.iter().map(|p| self.vertex(p)).collect()).collect();
        for pair in indices.windows(2) {
            for (low, high) in pair[0].windows(2).zip(pair[1].windows(2)) {
                for [a, b, c] in [[low[0], low[1], high[1]], [low[0], high[1], high[0]]] {
                    // On the axis a row is one point.
                    if a != b && b != c && c != a {
                        self.solid.triangles.push(if turned { [a, c, b] } else { [a, b, c] });
                    }
                }
            }
        }
    }
}
