//! Sizes of a part that decide which tools it takes.

use ir::Program;
use plan::facts::{concave, throat};
use wheel::part::{FaceId, Part, Surface};

/// Places along a face at which the height of the blade is measured.
const PLACES: usize = 40;

/// Sizes of a part, mm.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sizes {
    /// Diameter of the wheel at its tips.
    pub(crate) diameter: f64,
    /// Largest height of a blade along its faces.
    pub(crate) height: f64,
    /// Least width of a channel between blades, fillets left out.
    pub(crate) throat: f64,
    /// The same between the tips of the blades.
    pub(crate) top: f64,
    /// Least radius of a fillet; `None` without fillets.
    pub(crate) fillet: Option<f64>,
    /// Least concave radius of a face; infinite where faces have none.
    pub(crate) concave: f64,
}

impl Sizes {
    pub(crate) fn of(program: &Program) -> Self {
        let part = &program.part;
        let throats = throat::all(part, &program.data);
        let least = |width: fn(&throat::Throat) -> f64| {
            throats.iter().map(|(_, throat)| width(throat)).fold(f64::INFINITY, f64::min)
        };
        let faces: Vec<FaceId> = part.faces().collect();
        let fillets = part.blades.iter().filter_map(|blade| blade.fillet.as_ref());
        let concave = faces.iter().filter_map(|face| Some(concave::measure(part, *face)?.radius));
        Self {
            diameter: 2.0 * largest_radius(part),
            height: faces.iter().map(|face| height(part, *face)).fold(0.0, f64::max),
            throat: least(|throat| throat.narrowest.distance),
            top: least(|throat| throat.levels.last().map_or(f64::INFINITY, |level| level.distance)),
            fillet: fillets.map(|fillet| fillet.least().get()).reduce(f64::min),
            concave: concave.fold(f64::INFINITY, f64::min),
        }
    }
}

/// Largest height of a face from root to tip.
fn height(part: &Part, face: FaceId) -> f64 {
    let surface = &part.face(face).surface;
    (0..=PLACES).map(|k| surface.height(k as f64 / PLACES as f64)).fold(0.0, f64::max)
}

/// Largest distance of a tip from the axis.
fn largest_radius(part: &Part) -> f64 {
    let along = |face: FaceId| (0..=PLACES).map(move |k| (face, k as f64 / PLACES as f64));
    let radius = |(face, u)| part.face(face).surface.point(u, 1.0).coords.xy().norm();
    part.faces().flat_map(along).map(radius).fold(0.0, f64::max)
}
