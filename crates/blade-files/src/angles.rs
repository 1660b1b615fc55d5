//! Blades that a file states by angles and thicknesses, as the language does: they need no detour over points.

use blade::angles::{
    AngleBlade, CamberAngles, CamberRow, CamberSurface, Distribution, EdgeLine, EdgeShape, MeridianByLength,
    MeridionalPatch, SectionFault, Thickness,
};
use blade::outline::Side;
use blade::{Section, SectionForm};
use nalgebra::{Point3, Rotation3, Vector3};
use nurbs::interpolate;

/// Angles of a camber line by the share of the way from the leading (0) to the trailing edge (1), rad.
#[derive(Clone, Debug, PartialEq)]
pub enum StatedAngle {
    /// Angle about +Z.
    Theta(Vec<[f64; 2]>),
    /// Angle to the meridian, and theta at the leading edge.
    Beta(Vec<[f64; 2]>, f64),
}

/// What holds at a share of the span.
#[derive(Clone, Debug, PartialEq)]
pub struct StatedAtSpan<T> {
    /// Share of the span from hub (0) to shroud (1).
    pub at: f64,
    /// What holds there.
    pub says: T,
}

/// A blade by angles and thicknesses, in the frame of the part.
#[derive(Clone, Debug, PartialEq)]
pub struct StatedAngles {
    /// Camber lines, ascending from hub to shroud.
    pub camber: Vec<StatedAtSpan<StatedAngle>>,
    /// Thicknesses by the share of the way, mm, ascending from hub to shroud, or one that holds for all spans.
    pub thickness: Vec<StatedAtSpan<Vec<[f64; 2]>>>,
    /// Points (r, z) of the meridional leading and trailing edge, from hub to shroud, mm.
    pub edges: [Vec<[f64; 2]>; 2],
    /// Forms of the leading and trailing edge.
    pub shapes: [EdgeShape; 2],
    /// Turn about +Z, as a share of the pitch.
    pub turn: f64,
}

/// The curve through points (r, z), of degree 3 where it has enough of them: the one that a job makes of them.
pub(super) fn meridian(points: &[[f64; 2]]) -> Option<MeridianByLength> {
    let points: Vec<Point3<f64>> = points.iter().map(|[r, z]| Point3::new(*r, 0.0, *z)).collect();
    let degree = points.len().saturating_sub(1).clamp(1, 3);
    MeridianByLength::new(&interpolate(&points, degree).ok()?)
}

/// Why there is no camber surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum CamberFault {
    /// Points give no curve, or shares do not ascend from 0 to 1.
    NoCurve,
    /// The camber line of this number runs round the axis, beta in rad.
    Steep(usize, f64),
}

impl StatedAngles {
    /// The meridional surface between hub and shroud, and how far the ends of both edges lie from hub and shroud, mm.
    pub(super) fn patch(&self, ends: [&MeridianByLength; 2]) -> Option<(MeridionalPatch, [[f64; 2]; 2])> {
        let edge = |points: &Vec<[f64; 2]>| Some(EdgeLine::curved(meridian(points)?, ends));
        let [(leading, off), (trailing, off_trailing)] = [edge(&self.edges[0])?, edge(&self.edges[1])?];
        Some((MeridionalPatch::new(ends.map(Clone::clone), [leading, trailing]), [off, off_trailing]))
    }

    /// The camber surface on a meridional surface.
    pub(super) fn camber(&self, patch: MeridionalPatch) -> Result<CamberSurface, CamberFault> {
        let row = |line: &StatedAtSpan<StatedAngle>| {
            let angles = match &line.says {
                StatedAngle::Theta(theta) => CamberAngles::Theta(Distribution::through(theta)?),
                StatedAngle::Beta(beta, theta) => {
                    CamberAngles::Beta { beta: Distribution::through(beta)?, end: 0, theta: *theta }
                }
            };
            Some(CamberRow { span: line.at, angles })
        };
        let rows = self.camber.iter().map(row).collect::<Option<Vec<_>>>().ok_or(CamberFault::NoCurve)?;
        CamberSurface::new(patch, &rows, Distribution::constant(0.0))
            .map_err(|steep| CamberFault::Steep(steep.row, steep.beta))
    }

    /// Its thickness.
    pub(super) fn thicknesses(&self) -> Option<Thickness> {
        let rows = self.thickness.iter().map(|row| Distribution::through(&row.says)).collect::<Option<_>>()?;
        Some(Thickness { spans: self.thickness.iter().map(|row| row.at).collect(), rows })
    }

    /// Closed sections at shares of the span, turned about +Z by an angle, rad.
    pub(super) fn sections(
        &self,
        camber: &CamberSurface,
        thickness: Thickness,
        spans: &[f64],
        turn: f64,
    ) -> Result<Vec<Section>, SectionFault> {
        let blade = AngleBlade { camber, part: [[0.0; 2], [1.0; 2]], thickness, edges: self.shapes };
        let turned = Rotation3::from_axis_angle(&Vector3::z_axis(), turn);
        let section = |span: &f64| {
            let outline = blade.section(*span, Side::Greater)?;
            let [[face, other], [leading, trailing]] = [&outline.faces, &outline.edges];
            let inside = |edge: &[Point3<f64>]| edge.get(1..edge.len().saturating_sub(1)).unwrap_or_default().to_vec();
            let mut points = face.clone();
            points.extend(inside(trailing));
            points.extend(other.iter().rev());
            points.extend(inside(leading).into_iter().rev());
            points.iter_mut().for_each(|p| *p = turned * *p);
            Ok(Section { span: Some(*span), form: SectionForm::Loop(points) })
        };
        spans.iter().map(section).collect()
    }
}
