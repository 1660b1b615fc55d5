//! The part: surfaces, blades, the row of a sector, its passages, and results that all readers share.
//!
//! Sector 0 represents all others; sector k is sector 0 rotated about Z by k pitches. Lengths are in mm, angles in
//! radians.
//!
//! | file | holds |
//! |---|---|
//! | `surface` | common interface of the surfaces of blades; ruled and lofted surfaces |
//! | `blade` | a blade with its two faces and their names |
//! | `row` | the part: main blade and splitters between hub and shroud |
//! | `passage` | the space between neighbouring blades |
//! | `beyond` | walls of passages before and behind edges that lie far inside of the part |
//! | `continued` | walls of passages from inlet to outlet, where a blade is shorter |
//! | `names` | every surface of the finished part by kind and sector |
//! | `stock` | the turned blank and what holds it |
//! | `fillet` | radius of the fillet along the foot of a blade |
//! | `rolling_ball` | the ball that touches face and hub: fillets |
//! | `extent` | space between inlet and outlet, which contains the milled surfaces |
//! | `borders` | borders between neighbouring surfaces |
//! | `chart` | milled surfaces over the unit square |
//! | `chart_table` | their tables, made once for a part |
//! | `charting` | makes these tables |
//! | `columns` | columns of places across faces and fillets, without tables |
//! | `chart_rows` | rows of such a table as splines |
//! | `turned_patch` | turned surfaces between two borders |
//! | `turned_profile` | the outside of a turned blank |
//! | `kept` | surfaces that milling leaves as the lathe made them, over the unit square |
//! | `sample` | points of all surfaces |
//! | `sheet` | walls of channels with their fillets |
//! | `patch` | directions and steps of four-sided patches |
//! | `unrolled` | turned surfaces as planes, and patches in them between given borders |
//! | `blade_sheets` | grids of points over a blade |
//! | `blade_loops` | closed loops round the blades from hub to shroud |
//! | `hub_patches` | four-sided patches over the hub of a sector |
//! | `patches` | four-sided patches that cover the milled part of the wheel |
//! | `solid` | the closed part as a mesh, and its volume |
//! | `shell` | the closed part as NURBS faces with shared edges |

mod beyond;
mod blade;
pub mod blade_loops;
mod blade_sheets;
mod borders;
pub mod chart;
mod chart_rows;
mod chart_table;
mod charting;
pub mod columns;
mod continued;
mod extent;
mod fillet;
mod hub_patches;
pub mod imported;
pub mod kept;
mod names;
mod nodes;
mod passage;
mod patch;
mod patches;
mod rolling_ball;
mod row;
pub mod sample;
mod sheet;
pub mod shell;
pub mod solid;
mod stock;
pub mod surface;
mod turned_patch;
mod turned_profile;
mod unrolled;

pub use blade::{Blade, BladeId, Face, FaceId, Guides, RulingEnd};
pub use borders::{FloorBorder, Rolling};
pub use extent::Extent;
pub use fillet::Fillet;
pub use names::{PassageId, SurfaceClass, SurfaceId, SurfaceKind};
pub use passage::{Across, Passage, WholeWall};
pub use rolling_ball::hub_normal;
pub use row::{BladeRow, Part};
pub use sample::{Sample, sample};
pub use stock::{Clamping, Stock};
pub use surface::{FaceLine, FaceSearch, FaceSurface, Surface};
pub use turned_profile::TurnedProfile;
