//! Tables of the charts of a part.

use super::blade::{BladeId, FaceId};
use super::names::SurfaceKind;
use nalgebra::Vector3;

/// Tables of all charts of sector 0, made once for a part.
#[derive(Clone, Debug)]
pub(super) struct ChartTables {
    pub(super) milled: Vec<ChartTable>,
    /// Edges at inlet and outlet, blade by blade.
    pub(super) edges: Vec<ChartTable>,
}

#[derive(Clone, Debug)]
pub(super) struct ChartTable {
    pub(super) kind: SurfaceKind,
    /// Blade that bounds the surface at inlet and outlet.
    pub(super) blade: BladeId,
    pub(super) form: ChartForm,
}

#[derive(Clone, Debug)]
pub(super) enum ChartForm {
    /// v at the lower and upper border of a face, row by row.
    Face { face: FaceId, borders: Vec<[f64; 2]> },
    /// Centre of the rolling ball, and unit vectors from the centre to face and hub.
    Fillet { radius: f64, u: [f64; 2], balls: Vec<[Vector3<f64>; 3]> },
    /// First azimuth and opening angle of the channel.
    Hub { borders: Vec<[f64; 2]> },
    /// u of the end, and v at the lower and upper border on each face.
    Edge { blade: BladeId, u: f64, ranges: [[f64; 2]; 2] },
}
