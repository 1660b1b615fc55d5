//! Blades that are designed by angles and thicknesses: camber lines on surfaces between hub and shroud, and thickness across
//! them.
//!
//! | file | what |
//! |---|---|
//! | `distribution` | values along a curve or over the span |
//! | `meridional` | the meridional surface between hub, shroud and both edges |
//! | `camber` | the camber surface: theta stated, or integrated from beta |
//! | `blade` | sections: half of the thickness to both sides of the camber line, and edges |
//! | `limits` | what such blades may have |
//! | `made` | the surfaces through enough sections |

mod blade;
mod camber;
mod distribution;
pub mod limits;
mod made;
mod meridional;

pub use blade::{AngleBlade, EdgeShape, FaultKind, SectionFault, Thickness};
pub use camber::{CamberAngles, CamberRow, CamberSurface, MAX_CAMBER_ANGLE, SteepCamber};
pub use distribution::Distribution;
pub use made::{MadeFault, SurfaceResidual, made};
pub use meridional::{EdgeLine, MeridianByLength, MeridionalPatch};
