//! The true cut of a program: brute force over dense poses of the tools and dense points of the design surfaces, with
//! signed distances to convex solids in closed form. Nothing here comes from the verifier.

use super::blocks::{Station, axis};
use impellerc::ir::Program;
use impellerc::tool_stock::collide::{Cutter, Kind, Section};
use impellerc::wheel::part::{BladeId, FaceId, Part, Sample, Surface, SurfaceId, SurfaceKind, sample};
use nalgebra::{Point3, Vector2, Vector3};
use rayon::prelude::*;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::f64::consts::PI;

/// Spacing of the points of the design surfaces in the first look, mm.
const POINTS: f64 = 0.1;

/// Way of any point of the engaged cutter between poses in the first look, mm.
const POSES: f64 = 0.1;

/// Side of the cells in which points are looked up, mm.
const CELL: f64 = 1.0;

/// Segments whose deepest place is looked for between the points, and places of each.
const LOOKED_AT: (usize, usize) = (40, 3);

fn norm(x: f64, y: f64) -> f64 {
    (x * x + y * y).sqrt()
}

/// Signed distance to a cutter that ends at its flutes: flat or ball.
pub fn cutter(cutter: &Cutter, flute: f64, rho: f64, s: f64) -> f64 {
    let radius = cutter.nominal_radius();
    let side = match cutter.kind() {
        Kind::Ball if s < radius => norm(rho, s - radius) - radius,
        Kind::Ball => rho - radius,
        Kind::Flat => {
            let (out, below) = (rho - radius, -s);
            if out > 0.0 && below > 0.0 { norm(out, below) } else { out.max(below) }
        }
        _ => panic!("the campaign has flat and ball cutters only"),
    };
    let over = s - flute;
    if over <= 0.0 {
        // Outside the side decides; inside the nearest border.
        if side > 0.0 { side } else { side.max(over) }
    } else if rho <= radius {
        over
    } else {
        norm(rho - radius, over)
    }
}

/// Signed distance to a frustum, by its half section as a convex polygon.
fn frustum(from: [f64; 2], to: [f64; 2], rho: f64, s: f64) -> f64 {
    let corners = [[-from[0], from[1]], [from[0], from[1]], [to[0], to[1]], [-to[0], to[1]]];
    let (mut inside, mut outside) = (f64::NEG_INFINITY, f64::INFINITY);
    for k in 0..4 {
        let ([x, y], [x1, y1]) = (corners[k], corners[(k + 1) % 4]);
        let (dx, dy) = (x1 - x, y1 - y);
        let length = norm(dx, dy);
        if length == 0.0 {
            continue;
        }
        // Counter-clockwise: outside lies to the right.
        inside = inside.max(((rho - x) * dy - (s - y) * dx) / length);
        let t = (((rho - x) * dx + (s - y) * dy) / (length * length)).clamp(0.0, 1.0);
        outside = outside.min(norm(rho - x - t * dx, s - y - t * dy));
    }
    if inside <= 0.0 { inside } else { outside }
}

/// The way to a station.
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    pub line: usize,
    pub operation: usize,
    tips: [Point3<f64>; 2],
    rotary: [(f64, f64); 2],
}

/// Ways of a program.
pub fn segments(stations: &[Station]) -> Vec<Segment> {
    stations
        .windows(2)
        .filter(|w| !w[1].first)
        .map(|w| Segment {
            line: w[1].line,
            operation: w[1].operation,
            tips: [w[0].tip, w[1].tip],
            rotary: [(w[0].a, w[0].c), (w[1].a, w[1].c)],
        })
        .collect()
}

impl Segment {
    fn pose(&self, t: f64) -> (Point3<f64>, Vector3<f64>) {
        let [(a0, c0), (a1, c1)] = self.rotary;
        (self.tips[0] + (self.tips[1] - self.tips[0]) * t, axis(a0 + (a1 - a0) * t, c0 + (c1 - c0) * t))
    }

    /// Way of the farthest point of a tool of a length.
    fn way(&self, length: f64) -> f64 {
        let [(a0, c0), (a1, c1)] = self.rotary;
        (self.tips[1] - self.tips[0]).norm() + ((a1 - a0).abs() + (c1 - c0).abs()) * length
    }

    /// What makes the cut of a segment: equal keys, equal cuts.
    fn key(&self) -> [u64; 11] {
        let [(a0, c0), (a1, c1)] = self.rotary;
        let [p, q] = self.tips;
        let figures = [p.x, p.y, p.z, q.x, q.y, q.z, a0, c0, a1, c1].map(f64::to_bits);
        let mut key = [self.operation as u64; 11];
        key[..10].copy_from_slice(&figures);
        key
    }
}

fn in_tool(p: &Point3<f64>, (tip, axis): &(Point3<f64>, Vector3<f64>)) -> (f64, f64) {
    let d = p - tip;
    (d.cross(axis).norm(), d.dot(axis))
}

/// Where and how deep a segment cuts.
#[derive(Clone, Copy, Debug)]
pub struct Cut {
    /// Signed distance of the point inside of the cutter, as a positive depth, mm.
    pub depth: f64,
    pub point: Point3<f64>,
    pub surface: SurfaceId,
    pub line: usize,
}

/// The design, ready to be looked up.
pub struct Design<'a> {
    pub part: &'a Part,
    samples: Vec<Sample>,
    cells: HashMap<[i32; 3], Vec<u32>>,
    /// Coarser points for the wide bodies of shank and holder.
    coarse: Vec<Cluster>,
}

fn cell(p: &Point3<f64>) -> [i32; 3] {
    [p.x, p.y, p.z].map(|x| (x / CELL).floor() as i32)
}

impl<'a> Design<'a> {
    pub fn new(part: &'a Part) -> Self {
        let samples: Vec<Sample> = sample::sample(part, POINTS).into_iter().filter(|s| s.surface.milled()).collect();
        let mut cells: HashMap<[i32; 3], Vec<u32>> = HashMap::new();
        for (i, s) in samples.iter().enumerate() {
            cells.entry(cell(&s.position)).or_default().push(i as u32);
        }
        Self { part, samples, cells, coarse: clusters(&sample::sample(part, 0.4), 2.0) }
    }

    /// Points of the cells that a cutter at a pose may touch.
    fn near(&self, tip: &Point3<f64>, axis: &Vector3<f64>, radius: f64, flute: f64, mut look: impl FnMut(u32)) {
        // Balls of the cutter's radius along its axis, by the cells of their boxes, each cell once.
        let top = tip + axis * flute;
        let low = tip.inf(&top) - Vector3::repeat(radius);
        let high = tip.sup(&top) + Vector3::repeat(radius);
        let (from, to) = (cell(&low), cell(&high));
        for i in from[0]..=to[0] {
            for j in from[1]..=to[1] {
                for k in from[2]..=to[2] {
                    let middle = Point3::new(f64::from(i) + 0.5, f64::from(j) + 0.5, f64::from(k) + 0.5) * CELL;
                    let s = (middle - tip).dot(axis).clamp(0.0, flute);
                    if (middle - (tip + axis * s)).norm() > radius + 0.87 * CELL {
                        continue;
                    }
                    for index in self.cells.get(&[i, j, k]).into_iter().flatten() {
                        look(*index);
                    }
                }
            }
        }
    }
}

/// A program's tools against the design.
pub struct Truth<'a> {
    pub design: &'a Design<'a>,
    pub program: &'a Program,
}

impl Truth<'_> {
    fn tool(&self, operation: usize) -> (&Cutter, f64, f64) {
        let id = self.program.operations.iter().nth(operation).unwrap().1.tool;
        let solid = &self.program.tools[id].solid;
        (&solid.cutter, solid.radius(), solid.flute_length)
    }

    fn at(&self, segment: &Segment, t: f64, p: &Point3<f64>) -> f64 {
        let (shape, _, flute) = self.tool(segment.operation);
        let (rho, s) = in_tool(p, &segment.pose(t));
        cutter(shape, flute, rho, s)
    }

    fn poses(&self, segment: &Segment) -> usize {
        let (.., flute) = self.tool(segment.operation);
        (segment.way(flute) / POSES).ceil().max(1.0) as usize
    }

    /// Signed distance of a point to the cutter over a segment: dense poses, then a search around the best.
    pub fn distance(&self, segment: &Segment, p: &Point3<f64>) -> f64 {
        let n = self.poses(segment);
        let best = (0..=n).map(|k| (self.at(segment, k as f64 / n as f64, p), k)).min_by(|x, y| x.0.total_cmp(&y.0));
        let (value, k) = best.unwrap();
        value.min(self.search(segment, p, k as f64 / n as f64, 1.0 / n as f64))
    }

    /// Least distance within a step of a time, by thirds.
    fn search(&self, segment: &Segment, p: &Point3<f64>, t: f64, step: f64) -> f64 {
        let (mut low, mut high) = ((t - step).max(0.0), (t + step).min(1.0));
        for _ in 0..30 {
            let (x, y) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if self.at(segment, x, p) < self.at(segment, y, p) { high = y } else { low = x }
        }
        self.at(segment, 0.5 * (low + high), p).min(self.at(segment, low, p)).min(self.at(segment, high, p))
    }

    /// Deepest points of a segment in the first look, one a surface, deepest first.
    fn first_look(&self, segment: &Segment) -> Vec<(f64, u32)> {
        let (shape, radius, flute) = self.tool(segment.operation);
        let n = self.poses(segment);
        let mut best: BTreeMap<SurfaceId, (f64, u32)> = BTreeMap::new();
        for k in 0..=n {
            let pose = segment.pose(k as f64 / n as f64);
            self.design.near(&pose.0, &pose.1, radius, flute, |index| {
                let sample = &self.design.samples[index as usize];
                let (rho, s) = in_tool(&sample.position, &pose);
                let depth = -cutter(shape, flute, rho, s);
                // Points and poses may miss a shallow cut by some micrometres.
                if depth > -0.02 {
                    let entry = best.entry(sample.surface).or_insert((depth, index));
                    if depth > entry.0 {
                        *entry = (depth, index);
                    }
                }
            });
        }
        let mut found: Vec<(f64, u32)> = best.into_values().collect();
        found.sort_by(|x, y| y.0.total_cmp(&x.0).then(x.1.cmp(&y.1)));
        found.truncate(LOOKED_AT.1);
        found
    }

    /// Deepest place of a segment on the surface around a point: grids that close in.
    pub fn deepest_around(
        &self,
        segment: &Segment,
        surface: SurfaceId,
        start: &Point3<f64>,
        parameters: Option<[f64; 2]>,
    ) -> Cut {
        let mut best = Cut { depth: -self.distance(segment, start), point: *start, surface, line: segment.line };
        let Some(mut middle) = parameters.or_else(|| self.design.parameters(surface, start)) else { return best };
        let mut half = 1.5 * POINTS;
        while half > 1e-3 {
            let scale = self.design.scale(surface, middle);
            let mut next = middle;
            for i in -2..=2 {
                for j in -2..=2 {
                    let q = [
                        middle[0] + f64::from(i) / 2.0 * half * scale[0],
                        middle[1] + f64::from(j) / 2.0 * half * scale[1],
                    ];
                    let p = self.design.part_point(surface, q);
                    let depth = -self.distance(segment, &p);
                    if depth > best.depth && belongs(self.design.part, surface, q) {
                        best = Cut { depth, point: p, ..best };
                        next = q;
                    }
                }
            }
            middle = next;
            half *= 0.5;
        }
        best
    }

    /// Deepest cut of some segments.
    pub fn deepest(&self, segments: &[Segment]) -> Option<Cut> {
        let mut looks: Vec<(f64, &Segment, u32)> = segments
            .par_iter()
            .flat_map_iter(|s| self.first_look(s).into_iter().map(move |(depth, index)| (depth, s, index)))
            .collect();
        looks.sort_by(|x, y| y.0.total_cmp(&x.0));
        looks.truncate(LOOKED_AT.0);
        let cuts: Vec<Cut> = looks
            .par_iter()
            .map(|(_, segment, index)| {
                let sample = &self.design.samples[*index as usize];
                // Of a fillet the sample has the parameters of this file, of the hub others.
                let fillet = matches!(sample.surface.kind, SurfaceKind::Fillet(_));
                let parameters = fillet.then_some(sample.parameters);
                self.deepest_around(segment, sample.surface, &sample.position, parameters)
            })
            .collect();
        cuts.into_iter().max_by(|x, y| x.depth.total_cmp(&y.depth))
    }

    /// Signed distance of a point to the cutters over all segments, with the line of the nearest.
    pub fn distance_to_all(&self, segments: &[Segment], p: &Point3<f64>) -> (f64, usize) {
        let mut least = (f64::INFINITY, 0);
        for segment in segments {
            let (_, radius, flute) = self.tool(segment.operation);
            let (tip, axis) = segment.pose(0.5);
            let far = (p - (tip + axis * (0.5 * flute))).norm() - 0.5 * flute - radius - segment.way(flute);
            if far < least.0 {
                let d = self.distance(segment, p);
                if d < least.0 {
                    least = (d, segment.line);
                }
            }
        }
        least
    }

    /// Length of the way from a point against a normal inside of the cutters: balls that fit.
    pub fn way_inside(&self, segments: &[Segment], p: &Point3<f64>, normal: &Vector3<f64>) -> f64 {
        let mut way = 0.0;
        for _ in 0..2000 {
            let (d, _) = self.distance_to_all(segments, &(p - normal * way));
            if d > -1e-7 {
                break;
            }
            way -= d;
        }
        way
    }

    /// Least distance of shank and holder to the points of the design below [`NEAR`], with its line. A first look at the
    /// middles of all segments tells which of them can have the least.
    pub fn bodies(&self, segments: &[Segment]) -> (f64, usize) {
        let looks: Vec<(f64, f64)> = segments.par_iter().map(|s| self.bodies_at(s, (0.0, 1.0), NEAR)).collect();
        let first = looks.iter().zip(segments).map(|(l, s)| (l.0, s.line)).min_by(|x, y| x.0.total_cmp(&y.0));
        let first = first.filter(|f| f.0 < NEAR).unwrap_or((NEAR, 0));
        let open: Vec<&Segment> =
            looks.iter().zip(segments).filter(|(l, _)| l.0 - l.1 < first.0).map(|x| x.1).collect();
        let all: Vec<(f64, usize)> = open.par_iter().map(|s| (self.bodies_below(s, first.0), s.line)).collect();
        all.into_iter().filter(|x| x.0 < first.0).min_by(|x, y| x.0.total_cmp(&y.0)).unwrap_or(first)
    }

    /// The same of one segment.
    pub fn bodies_of(&self, segment: &Segment) -> f64 {
        self.bodies_below(segment, NEAR)
    }

    /// Least distance of a segment below another one: halved until no part of the tool moves by more than a fiftieth of
    /// a millimetre.
    fn bodies_below(&self, segment: &Segment, mut least: f64) -> f64 {
        let mut open = vec![(0.0, 1.0)];
        while let Some((from, to)) = open.pop() {
            let (here, moved) = self.bodies_at(segment, (from, to), least);
            least = least.min(here);
            if here - moved < least && moved > 0.02 {
                let middle = 0.5 * (from + to);
                open.extend([(from, middle), (middle, to)]);
            }
        }
        least
    }

    /// Distance in the middle of a stretch of a segment, where it may matter beside `least`, and by how much it may be
    /// less elsewhere on the stretch.
    fn bodies_at(&self, segment: &Segment, (from, to): (f64, f64), least: f64) -> (f64, f64) {
        let id = self.program.operations.iter().nth(segment.operation).unwrap().1.tool;
        let solid = &self.program.tools[id].solid;
        let sections: Vec<_> = solid.shank.iter().chain(&solid.holder).collect();
        let pose = segment.pose(0.5 * (from + to));
        let moved = 0.5 * (to - from) * segment.way(solid.length() + 20.0);
        let mut here = least + moved;
        // No farther than this from a box around each section: true of a cluster if it is of its middle, less its radius.
        let apart = |p: &Point3<f64>, x: &Section| {
            let (rho, s) = in_tool(p, &pose);
            (rho - x.radius_from.max(x.radius_to)).max(x.from - s).max(s - x.to)
        };
        for cluster in &self.design.coarse {
            if sections.iter().all(|x| apart(&cluster.middle, x) - cluster.radius >= here) {
                continue;
            }
            for p in &cluster.points {
                for x in &sections {
                    if apart(p, x) < here {
                        let (rho, s) = in_tool(p, &pose);
                        here = here.min(frustum([x.radius_from, x.from], [x.radius_to, x.to], rho, s));
                    }
                }
            }
        }
        (here, moved)
    }
}

/// Points with a ball around them.
struct Cluster {
    middle: Point3<f64>,
    radius: f64,
    points: Vec<Point3<f64>>,
}

/// Points by cells of a size.
fn clusters(samples: &[Sample], size: f64) -> Vec<Cluster> {
    let mut cells: BTreeMap<[i32; 3], Vec<Point3<f64>>> = BTreeMap::new();
    for p in samples.iter().map(|s| s.position) {
        cells.entry([p.x, p.y, p.z].map(|x| (x / size).floor() as i32)).or_default().push(p);
    }
    let cluster = |points: Vec<Point3<f64>>| {
        let middle = Point3::from(points.iter().map(|p| p.coords).sum::<Vector3<f64>>() / points.len() as f64);
        // A little more, for rounding.
        let radius = points.iter().map(|p| (p - middle).norm()).fold(0.0, f64::max) + 1e-9;
        Cluster { middle, radius, points }
    };
    cells.into_values().map(cluster).collect()
}

/// Distance of shank and holder beyond which nothing is asked, mm.
const NEAR: f64 = 1.0;

/// Cuts of segments that were looked at before, by what makes them.
#[derive(Default)]
pub struct Known(HashSet<[u64; 11]>);

impl Known {
    pub fn new(segments: &[Segment]) -> Self {
        Self(segments.iter().map(Segment::key).collect())
    }

    /// Those that are new.
    pub fn new_ones(&self, segments: &[Segment]) -> Vec<Segment> {
        segments.iter().filter(|s| !self.0.contains(&s.key())).copied().collect()
    }
}

impl Design<'_> {
    /// Parameters of a point of a surface.
    pub fn parameters(&self, surface: SurfaceId, p: &Point3<f64>) -> Option<[f64; 2]> {
        if !matches!(surface.kind, SurfaceKind::Fillet(_)) {
            return chart(self.part, surface, p);
        }
        // From the nearest sample by grids that close in.
        let [i, j, k] = cell(p);
        let around = (-1..=1).flat_map(|a| (-1..=1).flat_map(move |b| (-1..=1).map(move |c| [i + a, j + b, k + c])));
        let near = around.filter_map(|c| self.cells.get(&c)).flatten().map(|n| &self.samples[*n as usize]);
        let off = |q: [f64; 2]| (self.part_point(surface, q) - p).norm();
        let first = near
            .filter(|s| s.surface == surface)
            .min_by(|x, y| (x.position - p).norm().total_cmp(&(y.position - p).norm()))?;
        let mut middle = first.parameters;
        let mut half = self.scale(surface, middle).map(|k| 2.0 * POINTS * k);
        for _ in 0..40 {
            let grid = (-2..=2).flat_map(|i| (-2..=2).map(move |j| [f64::from(i) / 2.0, f64::from(j) / 2.0]));
            let best = grid.map(|g| [middle[0] + g[0] * half[0], middle[1] + g[1] * half[1]]);
            middle = best.min_by(|x, y| off(*x).total_cmp(&off(*y))).unwrap();
            half = half.map(|h| 0.6 * h);
        }
        Some(middle)
    }

    /// Change of each parameter for a millimetre on the surface.
    fn scale(&self, surface: SurfaceId, at: [f64; 2]) -> [f64; 2] {
        let origin = self.part_point(surface, at);
        [[1e-5, 0.0], [0.0, 1e-5]].map(|d| {
            let moved = self.part_point(surface, [at[0] + d[0], at[1] + d[1]]);
            1e-5 / (moved - origin).norm().max(1e-9)
        })
    }

    /// Point of a surface by its parameters: (u, v) of a face, (u, share of the arc) of a fillet, (u, azimuth) of the
    /// hub.
    fn part_point(&self, surface: SurfaceId, [u, v]: [f64; 2]) -> Point3<f64> {
        let part = self.part;
        match surface.kind {
            SurfaceKind::Face(side) => part.sector_rotation(surface.sector) * part.face(side).surface.point(u, v),
            SurfaceKind::Hub(_) => part.hub.point(u, v),
            SurfaceKind::Fillet(side) => {
                part.sector_rotation(surface.sector) * fillet(part, side, u, v).map_or(Point3::origin(), |f| f.0)
            }
            _ => Point3::origin(),
        }
    }

    /// Normal out of the material.
    pub fn normal(&self, surface: SurfaceId, p: &Point3<f64>) -> Option<Vector3<f64>> {
        let [u, v] = self.parameters(surface, p)?;
        let turn = self.part.sector_rotation(surface.sector);
        match surface.kind {
            SurfaceKind::Face(side) => Some(turn * self.part.face(side).normal(u, v)),
            SurfaceKind::Hub(_) => Some(self.part.hub.normal(u, v)),
            SurfaceKind::Fillet(side) => fillet(self.part, side, u, v).map(|f| turn * f.1),
            _ => None,
        }
    }
}

/// Point and normal of a fillet: the rolling ball touches the face at u, and the arc runs from there to the hub.
fn fillet(part: &Part, side: FaceId, u: f64, share: f64) -> Option<(Point3<f64>, Vector3<f64>)> {
    let radius = part.main().fillet.as_ref()?.constant()?.get();
    let v = part.fillet_tangent(side, u, radius)?;
    let face = part.face(side);
    let n = face.normal(u, v);
    let centre = face.surface.point(u, v) + n * radius;
    let (k, _) = part.hub.closest(Vector2::new(centre.x.hypot(centre.y), centre.z));
    let hub = part.hub.normal(k, centre.y.atan2(centre.x));
    let angle = n.angle(&hub);
    let normal = (n * ((1.0 - share) * angle).sin() + hub * (share * angle).sin()) / angle.sin();
    Some((centre - normal * radius, normal))
}

/// Parameters of a point of a face or of the hub.
fn chart(part: &Part, surface: SurfaceId, p: &Point3<f64>) -> Option<[f64; 2]> {
    let own = part.sector_rotation(surface.sector).inverse() * p;
    match surface.kind {
        SurfaceKind::Hub(_) => {
            let (u, _) = part.hub.closest(Vector2::new(p.x.hypot(p.y), p.z));
            Some([u, p.y.atan2(p.x)])
        }
        SurfaceKind::Face(side) => {
            let patch = impellerc::nurbs::proximity::Patch { u: [0.0, 1.0], v: [-0.1, 1.1] };
            let foot = part.face(side).surface.closest(&own, patch);
            Some([foot.u, foot.v])
        }
        _ => None,
    }
}

/// Whether parameters lie on the part of a surface that the finished part has.
fn belongs(part: &Part, surface: SurfaceId, [u, v]: [f64; 2]) -> bool {
    let radius = part.main().fillet.as_ref().map_or(0.0, |r| r.most().get());
    match surface.kind {
        SurfaceKind::Face(side) => {
            let high = part.ruling_meets(side, u, &part.shroud, 1.0);
            (0.0..=1.0).contains(&u) && v <= high && part.fillet_tangent(side, u, radius).is_some_and(|low| v >= low)
        }
        SurfaceKind::Fillet(side) => {
            (0.0..=1.0).contains(&v) && fillet(part, side, u, v).is_some_and(|(p, _)| in_channel(part, &p))
        }
        SurfaceKind::Hub(_) => {
            if !(0.0..=1.0).contains(&u) {
                return false;
            }
            // A ball of the fillet that stands there touches no vane.
            let centre = part.hub.point(u, v) + part.hub.normal(u, v) * radius;
            let pitch = 2.0 * PI / f64::from(part.vane_count);
            (0..part.vane_count).all(|k| {
                let own = nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), -pitch * f64::from(k)) * centre;
                BladeId::MAIN.faces().into_iter().all(|side| {
                    let patch = impellerc::nurbs::proximity::Patch { u: [0.0, 1.0], v: [-0.1, 1.1] };
                    let foot = part.face(side).surface.closest(&own, patch);
                    (part.face(side).surface.point(foot.u, foot.v) - own).norm() >= radius
                })
            })
        }
        _ => false,
    }
}

/// Between inlet cone and outlet cylinder.
fn in_channel(part: &Part, p: &Point3<f64>) -> bool {
    let (r, z) = (p.x.hypot(p.y), p.z);
    let (hub, shroud) = (part.hub.meridian(0.0).point, part.shroud.meridian(0.0).point);
    let outlet = part.hub.meridian(1.0).point;
    let side = |r: f64, z: f64| (shroud.x - hub.x) * (z - hub.y) - (shroud.y - hub.y) * (r - hub.x);
    side(r, z) * side(outlet.x, outlet.y) >= 0.0 && r <= outlet.x.max(part.shroud.meridian(1.0).point.x)
}
