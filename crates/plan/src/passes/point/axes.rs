//! Tool axes at contacts of vane faces, fillets, edges and tips, and the cutter locations for them.

use crate::passes::context::{AxisTilt, ChannelChart};
use ir::{CcPass, CcPoint, ClPoint, Operation, Program};
use nalgebra::Vector3;
use nurbs::Revolution;
use wheel::part::{BladeId, FaceId, Part, Surface, SurfaceKind};

/// Least tilt off an edge, radians: the space in front of an edge is free, so that the tool need not lie along it.
const EDGE_TILT: f64 = 0.5;

/// The same for an edge that is a surface of its own: other blades stand before it, and the hub rises there.
const ROUND_EDGE_TILT: f64 = 0.2;

/// Directions along the vane of sector 0.
pub(crate) struct VaneAxis<'a> {
    part: &'a Part,
    /// Passages of a sector.
    channels: Vec<ChannelChart<'a>>,
}

impl<'a> VaneAxis<'a> {
    pub(crate) fn new(part: &'a Part) -> Self {
        Self { part, channels: part.passages().map(|passage| ChannelChart::new(part, passage.id)).collect() }
    }

    /// Tool axis at the parameters of a contact: along the ruling of its face, tilted outward as far as the pole of the
    /// rotary axes requires, and tilted off the face by `tilt`. A fillet takes the axis of the face above it. On leads
    /// the axis is constant.
    pub(crate) fn axis(&self, surface: SurfaceKind, u: f64, v: f64, tilt: AxisTilt) -> Vector3<f64> {
        let (side, v) = match surface {
            SurfaceKind::Face(side) => (side, v),
            SurfaceKind::Fillet(side) if side.edge_end().is_some() => return self.round_edge(side, [u, 0.0], tilt),
            SurfaceKind::Fillet(side) => (side, 0.0),
            SurfaceKind::InletEdge(blade) | SurfaceKind::OutletEdge(blade) => {
                let end = usize::from(matches!(surface, SurfaceKind::OutletEdge(_)));
                return match self.part.edge(blade, end) {
                    Some(edge) => self.round_edge(edge, [u, v], tilt),
                    None => self.off_edge(blade, end as f64, tilt),
                };
            }
            SurfaceKind::Tip(blade) => return self.over_tip(blade, u, tilt),
            _ => return Vector3::z(),
        };
        let u = u.clamp(0.0, 1.0);
        let face = self.part.face(side);
        let normal = face.normal(u, v);
        let tilt = match tilt {
            AxisTilt::Along => return face.surface.ruling(u),
            AxisTilt::Away(tilt) => tilt,
        };
        let along = self.tilted_ruling(side, u);
        let along = (along - normal * along.dot(&normal)).normalize();
        along * libm::cos(tilt) + normal * libm::sin(tilt)
    }

    /// Tool axis round a blade at (u, v): on the first face (`round` 0), over the inlet edge (0 to 2), on the other face (2), over
    /// the outlet edge (2 to 4) back.
    pub(crate) fn round(&self, blade: BladeId, round: f64, [u, v]: [f64; 2], tilt: AxisTilt) -> Vector3<f64> {
        let [first, second] = blade.faces().map(SurfaceKind::Face);
        if round == 0.0 || round == 2.0 {
            return self.axis(if round < 1.0 { first } else { second }, u, v, tilt);
        }
        let (end, from, to) = if round < 2.0 { (0.0, first, second) } else { (1.0, second, first) };
        // From face to face the axis turns over the edge.
        let share = 0.5 * round - end;
        let edge = self.off_edge(blade, end, tilt);
        if share < 0.5 {
            self.axis(from, end, v, tilt).slerp(&edge, 2.0 * share)
        } else {
            edge.slerp(&self.axis(to, end, v, tilt), 2.0 * share - 1.0)
        }
    }

    pub(crate) fn hub(&self) -> &Revolution {
        &self.part.hub
    }

    pub(crate) fn looks_ahead(&self, face: FaceId) -> bool {
        self.part.looks_ahead(face)
    }

    /// True at an end of a blade, inlet and outlet, beyond which nothing of the part is.
    pub(crate) fn free_ends(&self, blade: BladeId) -> [bool; 2] {
        [0, 1].map(|end| !self.part.ends_inside(blade, end))
    }

    /// A text about a surface of a blade, with the name of the blade where a sector has several.
    pub(crate) fn of_blade(&self, blade: BladeId, text: String) -> String {
        if self.part.blades.len() == 1 { text } else { format!("{} {text}", self.part.blade(blade).name) }
    }

    /// Ruling of a face at u, tilted outward as far as the pole of the rotary axes requires.
    fn tilted_ruling(&self, side: FaceId, u: f64) -> Vector3<f64> {
        let (passage, wall) = self.part.passage_of(side);
        let (channel, along) = (&self.channels[passage.index()], self.part.along_channel(side, u));
        if wall == 0 {
            channel.tilted_ruling(along, 0.0, 0.0)
        } else {
            channel.second_turn().inverse() * channel.tilted_ruling(along, 1.0, 1.0)
        }
    }

    /// Axis over the tip of a blade at u: between the tilted rulings of both faces, and tilted towards Z. This tilt vanishes
    /// where the rulings run along Z, so that the axis stays on its side of the pole.
    fn over_tip(&self, blade: BladeId, u: f64, tilt: AxisTilt) -> Vector3<f64> {
        let [a, b] = blade.faces().map(|side| self.tilted_ruling(side, u.clamp(0.0, 1.0)));
        let ruling = (a + b).normalize();
        let AxisTilt::Away(tilt) = tilt else { return ruling };
        let up = Vector3::z() - ruling * ruling.z;
        (ruling + up * libm::tan(tilt)).normalize()
    }

    /// Axis at (u, v) of an edge that is a surface of its own: along the line of equal u in its middle, away from the blade,
    /// and tilted off the surface by `tilt`.
    fn round_edge(&self, edge: FaceId, [u, v]: [f64; 2], tilt: AxisTilt) -> Vector3<f64> {
        let face = self.part.face(edge);
        let ruling = face.surface.ruling(0.5);
        let AxisTilt::Away(tilt) = tilt else { return ruling };
        let square = |d: Vector3<f64>| (d - ruling * d.dot(&ruling)).normalize();
        let (normal, away) = (square(face.normal(u.clamp(0.0, 1.0), v)), square(face.normal(0.5, 0.5)));
        (ruling + normal * libm::tan(tilt) + away * libm::tan(ROUND_EDGE_TILT)).normalize()
    }

    /// Axis at an edge of a blade, between the ruling and the direction away from the vane, at inlet (u = 0) or outlet (u = 1).
    fn off_edge(&self, blade: BladeId, u: f64, tilt: AxisTilt) -> Vector3<f64> {
        let faces = blade.faces().map(|side| &self.part.face(side).surface);
        let ruling = (faces[0].ruling(u) + faces[1].ruling(u)).normalize();
        let AxisTilt::Away(tilt) = tilt else { return ruling };
        let (_, along, _) = faces[0].tangents(u, 0.5);
        let away = if u > 0.5 { along } else { -along };
        let away = (away - ruling * away.dot(&ruling)).normalize();
        let tilt = tilt + EDGE_TILT;
        ruling * libm::cos(tilt) + away * libm::sin(tilt)
    }
}

/// Point milling of a vane: the rounded part of the cutter stands on the contact.
pub(crate) fn vane_points(
    program: &Program,
    operation: &Operation,
    pass: &CcPass,
    axis: impl Fn(&VaneAxis<'_>, usize, &CcPoint) -> Vector3<f64>,
) -> Vec<ClPoint> {
    let cutter = &program.tools[operation.tool].solid.cutter;
    let axes = VaneAxis::new(&program.part);
    let at = |(i, p): (usize, &CcPoint)| {
        let axis = axis(&axes, i, p);
        let tip = cutter.tip_at(&p.position, &p.normal, &axis)?;
        Some(ClPoint { tip, axis, contact: Some(p.position) })
    };
    pass.points.iter().enumerate().filter_map(at).collect()
}
