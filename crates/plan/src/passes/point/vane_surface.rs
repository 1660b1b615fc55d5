//! Faces, fillets, edges and tips of a vane as drive surfaces for any cutter. The height of ridges follows from the
//! fundamental forms of surface and cutter, and is measured as well.

use super::axes::VaneAxis;
use crate::passes::context::AxisTilt;
use crate::passes::lines::{CutterPose, DriveSurface, METRIC_STATIONS, SurfaceLine, highest_ridge};
use ir::CcPoint;
use nalgebra::{Matrix2, SymmetricEigen, Vector2, Vector3};
use nurbs::BandMetric;
use rayon::prelude::*;
use tool_stock::collide::Cutter;
use wheel::part::{
    FaceId, SurfaceKind,
    chart::{Chart, Shape},
};

/// Layers of the metric across a surface.
const METRIC_LAYERS: usize = 25;

/// Step of differences in the chart.
const CHART_STEP: f64 = 1e-4;

/// Places along and across a surface at which its curvature is compared with that of the cutter.
const CURVATURE_PLACES: [usize; 2] = [120, 12];

/// Places on each side of a contact, in a direction, at which the surface is compared with the cutter.
const CONTACT_PLACES: usize = 24;

/// Share of a tip over which its middle gives the direction of a lead.
const LEAD_CHORD: f64 = 0.1;

/// Lower bound of steps per unit across a surface: a ball in a fillet of its own radius has infinite steps.
const MIN_ACROSS: f64 = 1e-6;

/// Tilt at which the side of a barrel touches, as a share of the angle of its arc.
const BARREL_TILT_SHARE: f64 = 0.5;

/// A face, fillet, edge or tip of sector 0 under a cutter.
pub(crate) struct VaneSurface<'a> {
    pub(crate) chart: &'a Chart<'a>,
    /// Its face; for a fillet the face above it, for an edge or a tip either face.
    pub(crate) side: FaceId,
    /// True for an edge that is a surface of its own, and for the fillet round it: x goes round the edge.
    pub(crate) round_edge: bool,
    pub(crate) cutter: Cutter,
    pub(crate) axes: &'a VaneAxis<'a>,
    /// Lower border, as y at equally spaced x from 0 to 1.
    pub(crate) low: Vec<f64>,
}

/// Tangents and fundamental forms of a chart over (x, y).
struct Local {
    px: Vector3<f64>,
    py: Vector3<f64>,
    /// First fundamental form.
    first: Matrix2<f64>,
    /// Curvature form, positive where the surface bulges out of the material.
    bulge: Matrix2<f64>,
}

impl VaneSurface<'_> {
    fn local(&self, x: f64, y: f64) -> Local {
        let (x, y) = (x.clamp(CHART_STEP, 1.0 - CHART_STEP), y.clamp(CHART_STEP, 1.0 - CHART_STEP));
        let [a, b, c, d] = [(x - CHART_STEP, y), (x + CHART_STEP, y), (x, y - CHART_STEP), (x, y + CHART_STEP)]
            .map(|(x, y)| self.chart.place(x, y));
        let half = 0.5 / CHART_STEP;
        let (px, py) = ((b.position - a.position) * half, (d.position - c.position) * half);
        let (nx, ny) = ((b.normal - a.normal) * half, (d.normal - c.normal) * half);
        let cross = 0.5 * (px.dot(&ny) + py.dot(&nx));
        // Exact, so that a ball of the radius of the fillet leaves no ridge at all.
        let across = self.chart.fillet_radius(x).map_or_else(|| py.dot(&ny), |r| -py.norm_squared() / r);
        Local {
            px,
            py,
            first: Matrix2::new(px.dot(&px), px.dot(&py), px.dot(&py), py.dot(&py)),
            bulge: Matrix2::new(px.dot(&nx), cross, cross, across),
        }
    }

    /// Motion per unit of x beyond an end of the chart. The borders of a tip meet at round edges, where they run square to the
    /// blade: a lead runs on as the middle of the tip does.
    pub(crate) fn beyond(&self, x: f64, y: f64) -> Vector3<f64> {
        if !matches!(self.chart.kind, SurfaceKind::Tip(_)) {
            return self.local(x, y).px;
        }
        let inward = if x > 0.5 { -LEAD_CHORD } else { LEAD_CHORD };
        let chord = (self.chart.place(x + inward, 0.5).position - self.chart.place(x, 0.5).position) / inward;
        let normal = self.chart.place(x, y).normal;
        chord - normal * chord.dot(&normal)
    }

    /// Second fundamental form of the cutter at a contact.
    fn cutter_form(&self, x: f64, y: f64, at: &Local) -> Matrix2<f64> {
        if self.cutter.ends_in_ball() {
            return at.first / self.cutter.tip_radius();
        }
        let place = self.chart.place(x.clamp(0.0, 1.0), y);
        let [u, v] = place.parameters;
        let axis = self.axes.axis(self.chart.kind, u, v, AxisTilt::Away(nominal_tilt(&self.cutter)));
        let Some(curvature) = self.cutter.curvature_at(&place.normal, &axis) else { return at.first };
        let tangents = [at.px, at.py];
        let form = |d: &Vector3<f64>, curvature: f64| {
            Matrix2::from_fn(|i, j| curvature * tangents[i].dot(d) * tangents[j].dot(d))
        };
        form(&curvature.along, curvature.of_profile) + form(&curvature.around, curvature.of_ring)
    }

    /// Radius of curvature of the profile at the contacts.
    fn arc_radius(&self) -> f64 {
        self.cutter.profile_at(nominal_tilt(&self.cutter)).map_or(0.0, |p| p.arc_radius)
    }

    /// Metric of ridges in steps: (I / R + II) / 8h, with the second term of the exact law for a flat surface.
    fn form(&self, x: f64, y: f64, height: f64) -> (Matrix2<f64>, Local) {
        let at = self.local(x, y);
        let scale = 1.0 / (8.0 * height - 4.0 * height * height / self.arc_radius());
        let form = (self.cutter_form(x, y, &at) + at.bulge) * scale;
        (form, at)
    }

    /// Steps per unit of y, straight across lines of equal y, for ridges of a given height.
    pub(crate) fn density(&self, x: f64, y: f64, height: f64) -> f64 {
        let (form, _) = self.form(x, y, height);
        (form[(1, 1)] - form[(0, 1)] * form[(0, 1)] / form[(0, 0)].max(MIN_ACROSS)).max(0.0).sqrt()
    }

    /// How deep the cutter would cut into the surface beside its contacts, at the worst of them.
    ///
    /// In each direction the cutter is taken for the sphere of its curvature there. Depths are measured on the surface, so
    /// that a wave of a fraction of a micrometre counts for its depth, not for its radius.
    pub(crate) fn deepest_gouge(&self, allowed: f64) -> LocalGouge {
        let places: Vec<[usize; 2]> =
            (0..=CURVATURE_PLACES[0]).flat_map(|i| (0..=CURVATURE_PLACES[1]).map(move |j| [i, j])).collect();
        let worst = |a: LocalGouge, b: LocalGouge| LocalGouge {
            sphere: a.sphere.min(b.sphere),
            ..if b.depth > a.depth { b } else { a }
        };
        places
            .into_par_iter()
            .map(|[i, j]| {
                self.gouge_at([i as f64 / CURVATURE_PLACES[0] as f64, j as f64 / CURVATURE_PLACES[1] as f64], allowed)
            })
            .reduce(|| LocalGouge { depth: 0.0, sphere: f64::INFINITY, at: [0.5; 2] }, worst)
    }

    /// The same at one contact.
    fn gouge_at(&self, at: [f64; 2], allowed: f64) -> LocalGouge {
        let mut worst = LocalGouge { depth: 0.0, sphere: f64::INFINITY, at };
        let [x, y] = at;
        let local = self.local(x, y);
        let cutter = self.cutter_form(x, y, &local);
        let place = self.chart.place(x, y);
        for direction in [Vector2::x(), Vector2::y(), least_against(&(cutter + local.bulge), &local.first).1] {
            let length = direction.dot(&(local.first * direction)).sqrt();
            let curvature = direction.dot(&(cutter * direction)) / (length * length);
            if !(length > 0.0 && curvature > 0.0) {
                continue;
            }
            let radius = 1.0 / curvature;
            for k in (1..=CONTACT_PLACES).flat_map(|k| [k as f64, -(k as f64)]) {
                // Steps grow with the distance: waves are short, and hollows as wide as the cutter.
                let share = k / CONTACT_PLACES as f64;
                let step = direction * (radius * share * share.abs() / length);
                let [x, y] = [x + step.x, y + step.y];
                if !((0.0..=1.0).contains(&x) && (0.0..=1.0).contains(&y)) {
                    continue;
                }
                let offset = self.chart.place(x, y).position - place.position;
                let (height, square) = (offset.dot(&place.normal), offset.norm_squared());
                let depth = radius - (square - 2.0 * radius * height + radius * radius).max(0.0).sqrt();
                worst.depth = worst.depth.max(depth);
                if height > allowed {
                    worst.sphere = worst.sphere.min((square - allowed * allowed) / (2.0 * (height - allowed)));
                }
            }
        }
        worst
    }
}

/// Gouge of the cutter beside a contact.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalGouge {
    /// Depth to which it cuts into the surface there, mm.
    pub(crate) depth: f64,
    /// Radius of the largest sphere that cuts in no deeper than allowed, mm.
    pub(crate) sphere: f64,
    /// The contact, (x, y).
    pub(crate) at: [f64; 2],
}

impl VaneSurface<'_> {
    fn pose(&self, x: f64, p: &CcPoint) -> Option<CutterPose> {
        let axis = self.axes.axis(self.chart.kind, p.u, p.v, AxisTilt::Away(nominal_tilt(&self.cutter)));
        CutterPose::at(&self.cutter, x, p, axis)
    }
}

/// Least ratio of two forms over all directions, and the direction.
fn least_against(form: &Matrix2<f64>, metric: &Matrix2<f64>) -> (f64, Vector2<f64>) {
    let Some(root) = metric.cholesky().and_then(|c| c.l().try_inverse()) else { return (0.0, Vector2::zeros()) };
    let eigen = SymmetricEigen::new(root * form * root.transpose());
    let k = eigen.eigenvalues.imin();
    (eigen.eigenvalues[k], root.transpose() * eigen.eigenvectors.column(k))
}

/// Tilt off the surface for which lines are planned, radians. The tilt of a barrel determines which radius cuts.
pub(crate) fn nominal_tilt(cutter: &Cutter) -> f64 {
    cutter.barrel_angle().map_or(0.1, |end| BARREL_TILT_SHARE * end)
}

impl DriveSurface for VaneSurface<'_> {
    fn name(&self) -> String {
        let name = match self.chart.kind {
            SurfaceKind::InletEdge(_) => "inlet edge".to_owned(),
            SurfaceKind::OutletEdge(_) => "outlet edge".to_owned(),
            SurfaceKind::Tip(_) => "tip".to_owned(),
            SurfaceKind::Fillet(side) => format!("{} fillet", side.name()),
            _ => format!("{} face", self.side.name()),
        };
        self.axes.of_blade(self.side.blade, name)
    }

    fn walls(&self, x: f64) -> (f64, f64) {
        let at = x.clamp(0.0, 1.0) * (self.low.len() - 1) as f64;
        let i = (at as usize).min(self.low.len() - 2);
        let low = self.low[i] + (self.low[i + 1] - self.low[i]) * (at - i as f64);
        (low, 1.0 - low)
    }

    fn contact(&self, x: f64, y: f64, _share: f64) -> CcPoint {
        let inside = x.clamp(0.0, 1.0);
        let place = self.chart.place(inside, y.clamp(0.0, 1.0));
        let [u, v] = place.parameters;
        let offset = x - inside;
        let (u, w) = match self.chart.kind {
            // Along an edge that the lathe makes u is constant.
            SurfaceKind::InletEdge(_) if !self.round_edge => (0.0, y),
            SurfaceKind::OutletEdge(_) if !self.round_edge => (1.0, y),
            _ => (u + offset, if self.axes.looks_ahead(self.side) { 0.0 } else { 1.0 }),
        };
        let on_surface = CcPoint { u, v, w, position: place.position, normal: place.normal };
        if offset == 0.0 {
            return on_surface;
        }
        self.off_hub(CcPoint { position: place.position + self.beyond(inside, y) * offset, ..on_surface })
    }

    /// In a fillet away from face and hub alike: where these meet at an acute angle, the normal of the one leads into the
    /// other.
    fn rise(&self, x: f64, at: &CcPoint) -> Vector3<f64> {
        let in_fillet = matches!(self.chart.kind, SurfaceKind::Fillet(_));
        if in_fillet { self.chart.place(x.clamp(0.0, 1.0), 0.5).normal } else { at.normal }
    }

    /// A ball with the radius of the fillet touches the hub at the ends of the lowest line. A lead straight on, or an arc
    /// along the normal of the face, may go into the hub: it is hollow along its meridian, and the face may hang over it.
    fn off_hub(&self, at: CcPoint) -> CcPoint {
        if !self.cutter.ends_in_ball() {
            return at;
        }
        let centre = at.position + at.normal * self.cutter.tip_radius();
        let azimuth = libm::atan2(centre.y, centre.x);
        let hub = self.axes.hub();
        let centre = Vector2::new(libm::hypot(centre.x, centre.y), centre.z);
        let (u, distance) = hub.closest(centre);
        let (away, distance) = if (0.0..=1.0).contains(&u) {
            (hub.meridian_normal(u), distance)
        } else {
            // Ahead of the inlet and behind the outlet is no hub, but its end is still beside the ball.
            let from_end = centre - hub.meridian(u.clamp(0.0, 1.0)).point;
            (from_end.normalize(), from_end.norm())
        };
        let missing = (self.cutter.tip_radius() - distance).max(0.0);
        let (sin, cos) = libm::sincos(azimuth);
        CcPoint { position: at.position + Vector3::new(away.x * cos, away.x * sin, away.y) * missing, ..at }
    }

    /// Below an edge is the hub, beside an edge and over a tip free space. Where a blade ends inside of the part, the surface goes on round
    /// its edge.
    fn open(&self) -> [bool; 2] {
        match self.chart.kind {
            _ if self.round_edge => [false; 2],
            SurfaceKind::InletEdge(_) | SurfaceKind::OutletEdge(_) => [false, true],
            SurfaceKind::Tip(_) => [true; 2],
            _ => self.axes.free_ends(self.side.blade),
        }
    }

    fn speed(&self, x: f64, y: f64, slope: f64) -> f64 {
        let at = self.local(x, y);
        (at.px + at.py * slope).norm()
    }

    fn metric(&self, height: f64) -> BandMetric {
        // On the leads the metric is constant.
        BandMetric::over([-0.02, 1.02], METRIC_STATIONS + 1, [0.0, 1.0], METRIC_LAYERS, |x, y| {
            let (form, _) = self.form(x, y, height);
            let across = form[(1, 1)].max(MIN_ACROSS * MIN_ACROSS);
            let skew = if across > MIN_ACROSS { form[(0, 1)] / across } else { 0.0 };
            let along = (form[(0, 0)] - skew * skew * across).max(MIN_ACROSS * MIN_ACROSS);
            [along.sqrt(), across.sqrt(), skew]
        })
    }

    fn highest_ridge(&self, lines: &[SurfaceLine]) -> Option<f64> {
        let poses = |line: &SurfaceLine| line.on_surface.iter().filter_map(|(x, p)| self.pose(*x, p)).collect();
        let place = |x: f64, y: f64| self.chart.place(x, y).position;
        highest_ridge(&self.cutter, lines, poses, |x| self.walls(x), place)
    }

    fn least_length(&self, height: f64) -> f64 {
        let cell = 1.0 / (CURVATURE_PLACES[0] * CURVATURE_PLACES[1]) as f64;
        let mut sum = 0.0;
        for i in 0..CURVATURE_PLACES[0] {
            let x = (i as f64 + 0.5) / CURVATURE_PLACES[0] as f64;
            let (low, high) = self.walls(x);
            for j in 0..CURVATURE_PLACES[1] {
                let y = low + high * (j as f64 + 0.5) / CURVATURE_PLACES[1] as f64;
                let (form, at) = self.form(x, y, height);
                let least = least_against(&form, &at.first).0.max(0.0).sqrt();
                sum += at.first.determinant().max(0.0).sqrt() * least * high * cell;
            }
        }
        sum
    }
}
