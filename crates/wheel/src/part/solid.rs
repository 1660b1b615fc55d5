//! The finished part as a closed triangle mesh, from the design surfaces only, and its volume: patches of all sectors, and
//! front, bore, back and outside of the blank.

use super::patch::{AlongSpacing, PatchDirection, Shares};
use super::patches::Patches;
use super::shell::ShellFault;
use super::{Part, Stock, SurfaceKind};
use nalgebra::Point3;
use nurbs::angle::nearest_turn;
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use tool_stock::stock::Mesh;

/// A volume with an estimate of its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Volume {
    /// Volume, mm3.
    pub value: f64,
    /// Difference of the last two refinements, mm3: an upper bound of the error.
    pub error: f64,
}

/// Steps of a grid along and up a wall, across a channel, and across a vane.
const GRID_STEPS: [usize; 4] = [48, 12, 16, 8];

/// Most steps of a mesh for a volume, over those of the first one.
const MAX_TIMES: usize = 16;

/// Volume of the finished part: all vanes milled, no stock over the shroud. The error of chords of uniform grids is
/// quadratic in the step; two refinements remove it. Thin noses need more of them: up to four are made, until the error is at most
/// the share `near` of the volume.
///
/// `None` for a part without patches.
pub fn volume(part: &Part, stock: &Stock, near: f64) -> Option<Volume> {
    let of = |factor: usize| mesh(part, stock, GRID_STEPS.map(|n| n * factor)).map(|solid| solid.volume());
    let without_square = |coarse: f64, fine: f64| fine + (fine - coarse) / 3.0;
    let (mut factor, mut coarse) = (2, of(2)?);
    let mut before = without_square(of(1)?, coarse);
    loop {
        factor *= 2;
        let fine = of(factor)?;
        let value = without_square(coarse, fine);
        let error = (value - before).abs();
        if error <= near * value || factor == MAX_TIMES {
            return Some(Volume { value, error });
        }
        (coarse, before) = (fine, value);
    }
}

/// Mesh of the finished part; the steps are those along a wall, up each of its two surfaces, across a channel, and
/// across a vane. `None` as for [`volume`].
pub fn mesh(part: &Part, stock: &Stock, [along, up, across, thick]: [usize; 4]) -> Option<Mesh> {
    let shares = Shares::equal([along, up, up, across, thick, thick, thick]);
    let patches = Patches::new(part, &shares, AlongSpacing::Equal).ok()?;
    Some(mesh_of(part, stock, &patches))
}

/// A mesh with its chord error.
#[derive(Clone, Debug)]
pub struct ChordMesh {
    /// The mesh.
    pub mesh: Mesh,
    /// Largest distance of a surface to its triangles that was found, mm.
    pub error: f64,
}

/// Steps of a mesh at the start, and the most of them in a direction.
const FIRST_MESH_STEPS: [usize; 7] = [12, 3, 2, 3, 1, 1, 1];
const MAX_STEPS: usize = 2048;

/// Mesh of the finished part whose triangles are within a chord error of the surfaces: steps are halved until points half way
/// between two places are near enough to their chord, in both directions together.
///
/// # Errors
/// [`ShellFault`]: a part without patches, and an error that so many triangles do not keep.
pub fn mesh_within(part: &Part, stock: &Stock, chord: f64) -> Result<ChordMesh, ShellFault> {
    let mut steps = FIRST_MESH_STEPS;
    loop {
        let twice = Patches::new(part, &Shares::equal(steps.map(|n| 2 * n)), AlongSpacing::FineEnds)
            .map_err(ShellFault::Patches)?;
        let (patches, rings) = twice.of_sector(0);
        let mut more = steps;
        let (mut worst, mut widest_kind) = (0.0_f64, SurfaceKind::Rim);
        for patch in &patches {
            let errors = chords(&patch.rows);
            if errors[0] + errors[1] > worst {
                (worst, widest_kind) = (errors[0] + errors[1], patch.kind);
            }
            for (direction, error) in patch.directions.into_iter().zip(errors) {
                if error > 0.5 * chord {
                    more[direction as usize] = 2 * steps[direction as usize];
                }
            }
        }
        // The circles of the turned surfaces have the azimuths of the patches.
        let around = turned_rest(part, stock).iter().map(|[r, _]| *r).fold(0.0, f64::max);
        let azimuths = |ring: &[Point3<f64>]| ring.iter().step_by(2).map(|p| libm::atan2(p.y, p.x)).collect::<Vec<_>>();
        let widest = rings.iter().flat_map(|ring| {
            azimuths(ring).windows(2).map(|pair| nearest_turn(pair[1] - pair[0], 0.0).abs()).collect::<Vec<_>>()
        });
        let circle = around * (1.0 - libm::cos(0.5 * widest.fold(0.0, f64::max)));
        worst = worst.max(circle);
        if circle > chord {
            [PatchDirection::Channel, PatchDirection::Blade, PatchDirection::Shoulder, PatchDirection::Before]
                .into_iter()
                .for_each(|d| more[d as usize] = 2 * steps[d as usize]);
        }
        if more == steps {
            let patches =
                Patches::new(part, &Shares::equal(steps), AlongSpacing::FineEnds).map_err(ShellFault::Patches)?;
            return Ok(ChordMesh { mesh: mesh_of(part, stock, &patches), error: worst });
        }
        if more.iter().any(|n| *n > MAX_STEPS) {
            return Err(ShellFault::NotNear(widest_kind, worst));
        }
        steps = more;
    }
}

/// Largest distances of points of a grid from the middle of the chord of their neighbours: between columns, and between rows.
fn chords(rows: &[Vec<Point3<f64>>]) -> [f64; 2] {
    let off = |a: &Point3<f64>, p: &Point3<f64>, b: &Point3<f64>| {
        let chord = b - a;
        let along = if chord.norm_squared() > 0.0 { (p - a).dot(&chord) / chord.norm_squared() } else { 0.0 };
        (p - (a + chord * along)).norm()
    };
    let between_columns = rows.iter().flat_map(|row| row.windows(3).step_by(2).map(|w| off(&w[0], &w[1], &w[2])));
    let between_rows = rows
        .windows(3)
        .step_by(2)
        .flat_map(|w| w[0].iter().zip(&w[1]).zip(&w[2]).map(|((a, p), b)| off(a, p, b)).collect::<Vec<_>>());
    [between_columns.fold(0.0, f64::max), between_rows.fold(0.0, f64::max)]
}

/// Mesh of all patches and of the turned surfaces that close them.
pub(super) fn mesh_of(part: &Part, stock: &Stock, patches: &Patches<'_>) -> Mesh {
    let mut mesh = Mesher::default();
    // Circles at both ends of the hub: borders to the other turned surfaces.
    let mut rings: [Vec<Point3<f64>>; 2] = [Vec::new(), Vec::new()];
    for sector in 0..part.vane_count {
        let (of_sector, ends) = patches.of_sector(sector);
        for patch in &of_sector {
            mesh.grid(&patch.rows, patch.turned);
        }
        rings.iter_mut().zip(ends).for_each(|(ring, end)| ring.extend(end));
    }
    let corners = turned_rest(part, stock);
    let about = |ring: &[Point3<f64>], [r, z]: [f64; 2]| -> Vec<Point3<f64>> {
        let at = |p: &Point3<f64>| {
            let radius = libm::hypot(p.x, p.y);
            Point3::new(p.x / radius * r, p.y / radius * r, z)
        };
        ring.iter().map(at).collect()
    };
    let [first, last] = rings;
    let mut inside = vec![first.clone(), about(&first, corners[0]), about(&first, corners[1])];
    let mut outside = vec![about(&last, corners[2])];
    // Where the blank ends with the hub there is no ring between them.
    if corners[2][0] != part.hub.meridian(1.0).point.x {
        outside.push(about(&last, corners[3]));
    }
    outside.push(last);
    let turned = !patches.turned();
    mesh.annulus(&inside[2], &outside[0], turned);
    for grid in [&mut inside, &mut outside] {
        grid.iter_mut().for_each(|row| row.extend(row.first().copied()));
        mesh.grid(grid, turned);
    }
    mesh.solid
}

/// Corners of the other turned surfaces between the circles, (r, z): two on the side of the inlet, two on the side of
/// the outlet.
fn turned_rest(part: &Part, stock: &Stock) -> [[f64; 2]; 4] {
    let (front, bore, back) = (part.hub.meridian(0.0).point.y, stock.bore_radius.get(), stock.back.get());
    let outlet = part.hub.meridian(1.0).point;
    let outside = stock.profile.last().map_or(outlet.x, |p| p[0]);
    [[bore, front], [bore, back], [outside, back], [outside, outlet.y]]
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
                self.triangle([low[0], low[1], high[1]], turned);
                self.triangle([low[0], high[1], high[0]], turned);
            }
        }
    }

    fn triangle(&mut self, [a, b, c]: [u32; 3], turned: bool) {
        // On the axis a row is one point.
        if a != b && b != c && c != a {
            self.solid.triangles.push(if turned { [a, c, b] } else { [a, b, c] });
        }
    }

    /// Triangles between two circles about Z, each by points counter-clockwise; `turned` as for a grid with the first circle as its
    /// first row.
    fn annulus(&mut self, first: &[Point3<f64>], last: &[Point3<f64>], turned: bool) {
        let azimuth = |p: &Point3<f64>| libm::atan2(p.y, p.x);
        let start = azimuth(&last[0]);
        // Angles from the first point of the second circle, which ascend; the first circle begins with the least.
        let around = |p: &Point3<f64>| (azimuth(p) - start).rem_euclid(TAU);
        let from = (0..first.len()).min_by(|a, b| around(&first[*a]).total_cmp(&around(&first[*b]))).unwrap_or(0);
        let low: Vec<(f64, u32)> =
            (0..first.len()).map(|i| &first[(from + i) % first.len()]).map(|p| (around(p), self.vertex(p))).collect();
        let high: Vec<(f64, u32)> =
            last.iter().enumerate().map(|(i, p)| (if i == 0 { 0.0 } else { around(p) }, self.vertex(p))).collect();
        let at = |ring: &[(f64, u32)], i: usize| {
            let (angle, index) = ring[i % ring.len()];
            (angle + if i < ring.len() { 0.0 } else { TAU }, index)
        };
        let (mut i, mut j) = (0, 0);
        while i < low.len() || j < high.len() {
            let (a, b) = (at(&low, i).1, at(&high, j).1);
            if j == high.len() || (i < low.len() && at(&low, i + 1).0 < at(&high, j + 1).0) {
                self.triangle([a, at(&low, i + 1).1, b], turned);
                i += 1;
            } else {
                self.triangle([a, at(&high, j + 1).1, b], turned);
                j += 1;
            }
        }
    }
}
