//! The codes of each stage with their manual pages. The number gives the stage: `01` text, `02` job, `03` geometry,
//! `04` planning, `05` orientation, `06` kinematics, `07` verification, `08` post, `09` files and faults of the
//! compiler, `10` readers of blade files.

use super::code::Code;

pub mod files;
pub mod geometry;
pub mod import;
pub mod job;
pub mod kinematics;
pub mod orientation;
pub mod planning;
pub mod post;
pub mod syntax;
pub mod verification;

/// The stages in the order of their numbers.
pub const STAGES: &[&[Code]] = &[
    syntax::ALL,
    job::ALL,
    geometry::ALL,
    planning::ALL,
    orientation::ALL,
    kinematics::ALL,
    verification::ALL,
    post::ALL,
    files::ALL,
    import::ALL,
];

impl Code {
    /// The code with a text such as `IMP0203`.
    pub fn find(id: &str) -> Option<Self> {
        Self::all().find(|c| c.id().eq_ignore_ascii_case(id))
    }

    /// All codes, by stage.
    pub fn all() -> impl Iterator<Item = Self> {
        STAGES.iter().flat_map(|stage| stage.iter().copied())
    }
}
