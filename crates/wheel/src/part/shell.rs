//! The closed part as a boundary representation: NURBS faces, planes and cylinders with shared edges.
//!
//! Every patch of the part (`super::patches`) becomes a spline surface through its points. Edges are the borders of these
//! surfaces, which two neighbours have in common, so that no edge needs a tolerance. Steps are halved until the surfaces are
//! near enough to the patches. Planes and cylinders of the blank close the shell: nose, bore, back face, rim.

use super::nodes::{Halved, PatchNodes};
pub use super::patch::PatchFault;
use super::patch::{AlongSpacing, PatchDirection, SheetPatch};
use super::patches::Patches;
use super::{Part, Stock, SurfaceId, SurfaceKind};
use nalgebra::Point3;
use nurbs::{GeomError, NurbsCurve, NurbsSurface, interpolate_at, interpolate_grid};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Largest distance of a spline surface to the patch that it stands for, mm, at half steps. Less makes files of tens of megabytes.
const NEAR_PATCH_MM: f64 = 1e-4;

/// The same for fillets, and for the hub between them, mm. A fillet has a crease where its ball rolls off the end of the face; a
/// spline through its points rounds it off.
const NEAR_FILLET: f64 = 1e-3;

/// The same for borders on the circles of planes and cylinders, mm. OpenCASCADE gives edges a tolerance of 1e-7 mm and refuses one
/// that is farther from its cylinder; half steps do not show the largest distance.
const NEAR_CIRCLES: f64 = 5e-8;

/// Distance below which ends of edges are one vertex, mm: rounding of turned copies is far below, and no edge is so short.
const SAME_VERTEX_MM: f64 = 1e-7;

/// Intervals of each direction at the start.
const INTERVALS: [usize; 7] = [16, 4, 3, 4, 4, 4, 4];

/// The curve of an edge.
#[derive(Clone, Debug, PartialEq)]
pub enum EdgeCurve {
    /// A spline.
    Spline(NurbsCurve),
    /// A circle about Z, counter-clockwise as seen from +Z.
    Circle {
        /// Its height, mm.
        z: f64,
        /// Its radius, mm.
        radius: f64,
    },
    /// The straight line between the ends.
    Line,
}

/// An edge of two faces.
#[derive(Clone, Debug, PartialEq)]
pub struct ShellEdge {
    /// Its curve.
    pub curve: EdgeCurve,
    /// Indices of its first and last vertex.
    pub ends: [usize; 2],
}

/// An edge in the border of a face, and whether the border runs along it or against it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OrientedEdge {
    /// Index of the edge.
    pub edge: usize,
    /// True when the border runs along the edge.
    pub along: bool,
}

/// The surface of a face.
#[derive(Clone, Debug, PartialEq)]
pub enum ShellSurface {
    /// A spline surface; the face is the whole of it.
    Spline(NurbsSurface),
    /// A plane across Z with its normal along +Z.
    Plane {
        /// Its height, mm.
        z: f64,
    },
    /// A cylinder about Z with its normal away from Z.
    Cylinder {
        /// Its radius, mm.
        radius: f64,
    },
}

/// A face of the shell.
#[derive(Clone, Debug, PartialEq)]
pub struct ShellFace {
    /// The surface of the part that it stands for.
    pub id: SurfaceId,
    /// Its surface.
    pub surface: ShellSurface,
    /// Its borders, the outer one first, counter-clockwise as seen from outside of the part.
    pub borders: Vec<Vec<OrientedEdge>>,
    /// True when the normal of the surface points out of the part.
    pub outward: bool,
}

/// A closed shell.
#[derive(Clone, Debug, PartialEq)]
pub struct Shell {
    /// Vertices, mm.
    pub vertices: Vec<Point3<f64>>,
    /// Edges; each is in the borders of two faces, once along and once against it.
    pub edges: Vec<ShellEdge>,
    /// Faces.
    pub faces: Vec<ShellFace>,
    /// Largest distance of a spline surface to the design surface that was found, mm.
    pub error: f64,
}

/// Why a part has no closed shell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ShellFault {
    /// The part has no patches.
    Patches(PatchFault),
    /// The points of this kind of patch have no spline.
    NoSpline(SurfaceKind),
    /// The surfaces do not come near enough to the patches of this kind with the most steps: the distance, mm.
    NotNear(SurfaceKind, f64),
    /// The patches of this kind have a border that is no border of another, or is not on the circle of the turned surfaces.
    Open(SurfaceKind),
    /// The blank does not close the part: the back face is not below both ends of the hub, or the bore is not inside.
    NotClosedByStock,
}

/// The closed shell of a part and its blank.
///
/// # Errors
/// [`ShellFault`].
pub fn shell(part: &Part, stock: &Stock) -> Result<Shell, ShellFault> {
    let (fitted, error) = fit(part)?;
    let mut builder = ShellBuilder {
        shell: Shell { vertices: Vec::new(), edges: Vec::new(), faces: Vec::new(), error },
        uses: Vec::new(),
    };
    for sector in 0..part.vane_count {
        let angle = part.pitch() * f64::from(sector);
        for (patch, surface) in &fitted {
            builder.patch(SurfaceId { kind: patch.kind, sector }, surface.rotated(angle), !patch.turned)?;
        }
    }
    builder.close(part, stock)?;
    Ok(builder.shell)
}

/// A patch with its spline surface.
type Fitted = (SheetPatch, NurbsSurface);

/// Spline surfaces of the patches of sector 0, and their largest distance to the patches at the nodes and half way between them.
/// Intervals between nodes are halved where the surfaces are not near enough.
fn fit(part: &Part) -> Result<(Vec<Fitted>, f64), ShellFault> {
    let fillet = part.blades.iter().any(|blade| blade.fillet.is_some());
    let spacing = if fillet { AlongSpacing::FineEnds } else { AlongSpacing::Equal };
    let near = |kind: SurfaceKind| match kind {
        SurfaceKind::Rim => NEAR_CIRCLES,
        SurfaceKind::Face(_) | SurfaceKind::Tip(_) => NEAR_PATCH_MM,
        _ if fillet => NEAR_FILLET,
        _ => NEAR_PATCH_MM,
    };
    let mut nodes = PatchNodes::equal(INTERVALS);
    loop {
        let patches = Patches::new(part, &nodes.with_middles(), spacing).map_err(ShellFault::Patches)?;
        let fitted: Vec<_> = patches.of_sector(0).0.into_par_iter().map(|patch| fit_patch(patch, &nodes)).collect();
        let fitted = fitted.into_iter().collect::<Result<Vec<_>, ShellFault>>()?;
        let mut halved = Halved::default();
        let mut worst = (SurfaceKind::Rim, 0.0, 0.0);
        let mut judge = |kind: SurfaceKind, direction: PatchDirection, errors: &[f64]| {
            for (interval, error) in errors.iter().enumerate().filter(|(_, error)| **error > near(kind)) {
                halved.mark(direction, interval);
                if error / near(kind) > worst.2 {
                    worst = (kind, *error, error / near(kind));
                }
            }
        };
        for (patch, _, errors) in &fitted {
            patch.directions.into_iter().zip(&errors.between).for_each(|(d, errors)| judge(patch.kind, d, errors));
        }
        for (direction, line) in patches.rings.iter().flatten() {
            let errors = off_circle(line, &nodes.parameters(*direction));
            judge(SurfaceKind::Rim, *direction, &errors.map_err(|_| ShellFault::NoSpline(SurfaceKind::Rim))?);
        }
        if halved.is_empty() {
            let error = fitted.iter().map(|(_, _, errors)| errors.largest).fold(0.0, f64::max);
            return Ok((fitted.into_iter().map(|(patch, surface, _)| (patch, surface)).collect(), error));
        }
        if !nodes.halve(&halved) {
            return Err(ShellFault::NotNear(worst.0, worst.1));
        }
    }
}

/// NodeDistances of a curve or surface to points between its nodes, mm.
struct NodeDistances {
    /// Largest ones at the middle of each interval of the columns, at nodes of the rows; and the same for the rows.
    between: [Vec<f64>; 2],
    /// Largest one of all.
    largest: f64,
}

/// NodeDistances of the curve through every second point of a line to the points between them.
fn off_circle(line: &[Point3<f64>], parameters: &[f64]) -> Result<Vec<f64>, GeomError> {
    let nodes: Vec<Point3<f64>> = line.iter().step_by(2).copied().collect();
    let curve = interpolate_at(parameters, &nodes, 3)?;
    let middles = line.iter().skip(1).step_by(2).zip(parameters.windows(2));
    Ok(middles.map(|(p, pair)| (curve.point(pair[0].midpoint(pair[1])) - p).norm()).collect())
}

/// The surface through every second point of a patch, with its distances to the other points.
fn fit_patch(patch: SheetPatch, nodes: &PatchNodes) -> Result<(SheetPatch, NurbsSurface, NodeDistances), ShellFault> {
    let coarse: Vec<Vec<Point3<f64>>> =
        patch.rows.iter().step_by(2).map(|row| row.iter().step_by(2).copied().collect()).collect();
    let parameters = patch.directions.map(|direction| nodes.parameters(direction));
    let surface = interpolate_grid(&coarse, [&parameters[0], &parameters[1]]);
    let surface = surface.map_err(|_| ShellFault::NoSpline(patch.kind))?;
    let mut distances = NodeDistances { between: parameters.each_ref().map(|p| vec![0.0; p.len() - 1]), largest: 0.0 };
    let at = |d: usize, k: usize| parameters[d][k / 2].midpoint(parameters[d][k.div_ceil(2)]);
    for (j, row) in patch.rows.iter().enumerate() {
        for (i, p) in row.iter().enumerate() {
            let off = (surface.point(at(0, i), at(1, j)) - p).norm();
            distances.largest = distances.largest.max(off);
            let largest = match (i % 2, j % 2) {
                (1, 0) => &mut distances.between[0][i / 2],
                (0, 1) => &mut distances.between[1][j / 2],
                _ => continue,
            };
            *largest = largest.max(off);
        }
    }
    Ok((patch, surface, distances))
}

/// Joins faces to a shell.
struct ShellBuilder {
    shell: Shell,
    /// Of each edge, the kind of its first face and whether the border of that face runs along it; `None` once it has two.
    uses: Vec<Option<(SurfaceKind, bool)>>,
}

impl ShellBuilder {
    fn vertex(&mut self, p: Point3<f64>) -> usize {
        let found = self.shell.vertices.iter().position(|q| (q - p).norm() < SAME_VERTEX_MM);
        found.unwrap_or_else(|| {
            self.shell.vertices.push(p);
            self.shell.vertices.len() - 1
        })
    }

    fn edge(&mut self, curve: EdgeCurve, ends: [usize; 2]) -> usize {
        self.shell.edges.push(ShellEdge { curve, ends });
        self.uses.push(None);
        self.shell.edges.len() - 1
    }

    /// The edge with a curve: one that another face left open, or a new one.
    fn spline_edge(&mut self, curve: NurbsCurve, kind: SurfaceKind) -> OrientedEdge {
        let ends = [0.0, 1.0].map(|u| self.vertex(curve.point(u)));
        let middle = curve.point(0.5);
        for (edge, known) in self.shell.edges.iter().enumerate() {
            let (Some((_, used_along)), EdgeCurve::Spline(other)) = (self.uses[edge], &known.curve) else { continue };
            let along = known.ends == ends;
            let same = along || known.ends == [ends[1], ends[0]];
            if same && (other.point(0.5) - middle).norm() < SAME_VERTEX_MM && used_along != along {
                self.uses[edge] = None;
                return OrientedEdge { edge, along };
            }
        }
        let edge = self.edge(EdgeCurve::Spline(curve), ends);
        self.uses[edge] = Some((kind, true));
        OrientedEdge { edge, along: true }
    }

    /// Adds a spline surface with its four borders.
    fn patch(&mut self, id: SurfaceId, surface: NurbsSurface, outward: bool) -> Result<(), ShellFault> {
        // Counter-clockwise in the plane of the parameters, or clockwise.
        let [low, high] = [surface.border(false), surface.border(true)];
        let [start, end] = [surface.side(false), surface.side(true)];
        let curves = if outward {
            [low, end, high.reversed(), start.reversed()]
        } else {
            [start, high, end.reversed(), low.reversed()]
        };
        let border = curves.map(|curve| self.spline_edge(curve, id.kind)).to_vec();
        self.shell.faces.push(ShellFace { id, surface: ShellSurface::Spline(surface), borders: vec![border], outward });
        Ok(())
    }

    /// Closes the shell by planes and cylinders between the two circles of open edges.
    fn close(&mut self, part: &Part, stock: &Stock) -> Result<(), ShellFault> {
        let [inlet, outlet] = [0.0, 1.0].map(|u| part.hub.meridian(u).point);
        let (bore, back) = (stock.bore_radius.get(), stock.back.get());
        let outside = stock.profile.last().map_or(outlet.x, |p| p[0]);
        if !(back < inlet.y && back < outlet.y && bore < inlet.x && outside >= outlet.x - SAME_VERTEX_MM) {
            return Err(ShellFault::NotClosedByStock);
        }
        let rings = [self.ring([inlet.x, inlet.y])?, self.ring([outlet.x, outlet.y])?];
        if let Some((kind, _)) = self.uses.iter().flatten().next() {
            return Err(ShellFault::Open(*kind));
        }
        let [front, foot] = rings;
        let mut nose = vec![front];
        let mut under = Vec::new();
        if bore > 0.0 {
            let [bottom, top] = [back, inlet.y].map(|z| self.circle(z, bore, [0.0, PI]));
            nose.push(reversed(&top));
            under.push(bottom.clone());
            self.cylinder(SurfaceKind::Bore, bore, [&bottom, &top], false);
        }
        self.plane(SurfaceKind::Nose, inlet.y, nose, true);
        // The circle around the rim, counter-clockwise.
        let (radius, top) = if outside > outlet.x + SAME_VERTEX_MM {
            let top = self.circle(outlet.y, outside, [0.0, PI]);
            self.plane(SurfaceKind::Rim, outlet.y, vec![top.clone(), foot], true);
            (outside, top)
        } else {
            (outlet.x, reversed(&foot))
        };
        let halves = [0, top.len() / 2].map(|k| self.shell.vertices[self.start(top[k])]);
        let bottom = self.circle(back, radius, halves.map(|p| libm::atan2(p.y, p.x)));
        under.insert(0, reversed(&bottom));
        self.cylinder(SurfaceKind::Rim, radius, [&bottom, &top], true);
        self.plane(SurfaceKind::Back, back, under, false);
        Ok(())
    }

    /// The two halves of a cylinder between two circles, counter-clockwise, whose first and middle edges begin at the same
    /// azimuths.
    fn cylinder(&mut self, kind: SurfaceKind, radius: f64, [bottom, top]: [&[OrientedEdge]; 2], outward: bool) {
        let half = |circle: &[OrientedEdge], k: usize| -> Vec<OrientedEdge> {
            let middle = circle.len() / 2;
            if k == 0 { circle[..middle].to_vec() } else { circle[middle..].to_vec() }
        };
        let lines = [0, 1].map(|k| {
            let ends = [bottom, top].map(|circle| self.start(half(circle, k)[0]));
            self.edge(EdgeCurve::Line, ends)
        });
        for k in [0, 1] {
            let mut border = half(bottom, k);
            border.push(OrientedEdge { edge: lines[1 - k], along: true });
            border.extend(reversed(&half(top, k)));
            border.push(OrientedEdge { edge: lines[k], along: false });
            let borders = vec![if outward { border } else { reversed(&border) }];
            let id = SurfaceId { kind, sector: 0 };
            self.shell.faces.push(ShellFace { id, surface: ShellSurface::Cylinder { radius }, borders, outward });
        }
    }

    /// Index of the vertex at which an edge of a border begins.
    fn start(&self, step: OrientedEdge) -> usize {
        self.shell.edges[step.edge].ends[usize::from(!step.along)]
    }

    /// The open edges on a circle about Z as the border of the face that closes them.
    fn ring(&mut self, [r, z]: [f64; 2]) -> Result<Vec<OrientedEdge>, ShellFault> {
        let on = |p: &Point3<f64>| libm::hypot(libm::hypot(p.x, p.y) - r, p.z - z) < SAME_VERTEX_MM;
        let mut open: Vec<OrientedEdge> = Vec::new();
        for (edge, known) in self.shell.edges.iter().enumerate() {
            let Some((_, along)) = self.uses[edge] else { continue };
            if known.ends.iter().all(|v| on(&self.shell.vertices[*v])) {
                open.push(OrientedEdge { edge, along: !along });
            }
        }
        let mut ring: Vec<OrientedEdge> = Vec::new();
        let mut at = open.first().map(|step| self.start(*step));
        while let Some(k) = open.iter().position(|step| Some(self.start(*step)) == at) {
            let step = open.swap_remove(k);
            at = Some(self.shell.edges[step.edge].ends[usize::from(step.along)]);
            self.uses[step.edge] = None;
            ring.push(step);
        }
        let closed = ring.first().map(|step| self.start(*step)) == at;
        if ring.len() < 2 || !closed || !open.is_empty() {
            return Err(ShellFault::Open(SurfaceKind::Rim));
        }
        Ok(ring)
    }

    /// A circle about Z in two edges, counter-clockwise, between two azimuths.
    fn circle(&mut self, z: f64, radius: f64, azimuths: [f64; 2]) -> Vec<OrientedEdge> {
        let ends = azimuths.map(|a| self.vertex(Point3::new(radius * libm::cos(a), radius * libm::sin(a), z)));
        [ends, [ends[1], ends[0]]]
            .map(|ends| OrientedEdge { edge: self.edge(EdgeCurve::Circle { z, radius }, ends), along: true })
            .to_vec()
    }

    fn plane(&mut self, kind: SurfaceKind, z: f64, borders: Vec<Vec<OrientedEdge>>, outward: bool) {
        let id = SurfaceId { kind, sector: 0 };
        self.shell.faces.push(ShellFace { id, surface: ShellSurface::Plane { z }, borders, outward });
    }
}

/// A border in the other direction.
fn reversed(border: &[OrientedEdge]) -> Vec<OrientedEdge> {
    border.iter().rev().map(|step| OrientedEdge { along: !step.along, ..*step }).collect()
}
