//! Tool axes at contacts of vane faces, fillets and edges, and the cutter locations for them.

use crate::ir::{CcPass, CcPoint, ClPoint, Operation, Program};
use crate::part::{BladeId, FaceId, Part, Surface, SurfaceKind};
use crate::passes::context::{AxisTilt, ChannelChart};
use nalgebra::Vector3;

/// Least tilt off an edge, radians: the space in front of an edge is free, so that the tool need not lie along it.
const EDGE_TILT: f64 = 0.5;

/// Directions along the vane of sector 0.
pub(crate) struct VaneAxis<'a> {
    part: &'a Part,
    channel: ChannelChart<'a>,
}

impl<'a> VaneAxis<'a> {
    pub(crate) fn new(part: &'a Part) -> Self {
        Self { part, channel: ChannelChart::new(part) }
    }

    /// Tool axis at the parameters of a contact: along the ruling of its face, tilted outward as far as the pole of the
    /// rotary axes requires, and tilted off the face by `tilt`. A fillet takes the axis of the face above it. On leads
    /// the axis is constant.
    pub(crate) fn axis(&self, surface: SurfaceKind, u: f64, v: f64, tilt: AxisTilt) -> Vector3<f64> {
        let (side, v) = match surface {
            SurfaceKind::Face(side) => (side, v),
            SurfaceKind::Fillet(side) => (side, 0.0),
            SurfaceKind::InletEdge(_) => return self.off_edge(0.0, tilt),
            _ => return self.off_edge(1.0, tilt),
        };
        let u = u.clamp(0.0, 1.0);
        let face = self.part.face(side);
        let normal = face.normal(u, v);
        let tilt = match tilt {
            AxisTilt::Along => return face.surface.ruling(u),
            AxisTilt::Away(tilt) => tilt,
        };
        let along = if self.part.looks_ahead(side) {
            self.channel.tilted_ruling(u, 0.0, 0.0)
        } else {
            self.part.sector_rotation(1).inverse() * self.channel.tilted_ruling(u, 1.0, 1.0)
        };
        let along = (along - normal * along.dot(&normal)).normalize();
        along * libm::cos(tilt) + normal * libm::sin(tilt)
    }

    /// Tool axis round a vane: on the first face (`round` 0), over the inlet edge (0 to 2), on the other face (2), over
    /// the outlet edge (2 to 4) back.
    pub(crate) fn round(&self, round: f64, u: f64, v: f64, tilt: AxisTilt) -> Vector3<f64> {
        let [first, second] = BladeId::MAIN.faces().map(SurfaceKind::Face);
        if round == 0.0 || round == 2.0 {
            return self.axis(if round < 1.0 { first } else { second }, u, v, tilt);
        }
        let (end, from, to) = if round < 2.0 { (0.0, first, second) } else { (1.0, second, first) };
        // From face to face the axis turns over the edge.
        let share = 0.5 * round - end;
        let edge = self.off_edge(end, tilt);
        if share < 0.5 {
            self.axis(from, end, v, tilt).slerp(&edge, 2.0 * share)
        } else {
            edge.slerp(&self.axis(to, end, v, tilt), 2.0 * share - 1.0)
        }
    }

    pub(crate) fn looks_ahead(&self, face: FaceId) -> bool {
        self.part.looks_ahead(face)
    }

    /// Axis at an edge, between the ruling and the direction away from the vane, at inlet (u = 0) or outlet (u = 1).
    fn off_edge(&self, u: f64, tilt: AxisTilt) -> Vector3<f64> {
        let faces = BladeId::MAIN.faces().map(|side| &self.part.face(side).surface);
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
    axis: impl Fn(&VaneAxis<'_>, &CcPoint) -> Vector3<f64>,
) -> Vec<ClPoint> {
    let cutter = &program.tools[operation.tool].solid.cutter;
    let axes = VaneAxis::new(&program.part);
    let at = |p: &CcPoint| {
        let axis = axis(&axes, p);
        let tip = cutter.tip_at(&p.position, &p.normal, &axis)?;
        Some(ClPoint { tip, axis, contact: Some(p.position) })
    };
    pass.points.iter().filter_map(at).collect()
}
