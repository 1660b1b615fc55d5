//! Tables of the charts of a part.

use super::blade::{BladeId, FaceId};
use super::chart_rows::ChartRows;
use super::names::SurfaceKind;
use super::turned_patch::TurnedPatch;

/// Tables of all charts of sector 0, made once for a part.
#[derive(Clone, Debug)]
pub(super) struct ChartTables {
    pub(super) milled: Vec<ChartTable>,
    /// Edges at inlet and outlet, blade by blade.
    pub(super) edges: Vec<ChartTable>,
    /// Tips of the blades.
    pub(super) tips: Vec<ChartTable>,
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
    /// v at the lower and upper border of a face.
    Face { face: FaceId, borders: ChartRows<2> },
    /// Centre of the rolling ball, and the directions from the centre to face and hub.
    Fillet { radius: f64, u: [f64; 2], balls: ChartRows<9> },
    /// The same where the radius changes: centre, directions from the centre of the circle to face and hub, [`FilletArc::tilt`],
    /// [`FilletArc::level`], and the radius of the ball.
    ///
    /// [`FilletArc::tilt`]: super::rolling_ball::FilletArc::tilt
    /// [`FilletArc::level`]: super::rolling_ball::FilletArc::level
    VariedFillet { u: [f64; 2], balls: ChartRows<14> },
    /// First azimuth and opening angle of the channel.
    Hub { borders: ChartRows<2> },
    /// u of the end, and the turned patch between the ends of both faces.
    Edge { blade: BladeId, u: f64, patch: TurnedPatch },
    /// u of the shroud and azimuth of the upper border of the pressure face, then of the suction face.
    Tip { borders: ChartRows<4> },
}
