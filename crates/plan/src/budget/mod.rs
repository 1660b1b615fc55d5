//! What a plan may cost: counts of samples, lines, stations, links and strips, the memory that they take, and the refusal of what
//! does not fit, before the start and again where planning knows more.
//!
//! Memory is the larger value of planning and verification.
//!
//! The numbers of lines and stations follow from sizes of the part and figures of the job. Their memory was measured as
//! peak memory on two cores, for planning (`--emit motion`) and for the whole compilation:
//!
//! | job | planning | compilation |
//! |---|---|---|
//! | `jobs/small` | 54 MB | 72 MB |
//! | `jobs/small/point.imp` | 87 MB | 99 MB |
//! | `jobs/reduced` | 47 MB | 190 MB |
//! | `jobs/wei2021`: 1368 lines, 134 k blocks | 689 MB | 698 MB |
//! | `jobs/small`, channel alone, scallop 20 um, one sector: 37 lines | 61 MB | 94 MB |
//! | the same, 1 um: 160 lines | 224 MB | 270 MB |
//! | the same, four sectors: 656 lines | 832 MB | 864 MB before sectors were copied |
//! | one sector, 0.1 um: 500 lines | 661 MB | |
//! | eight sectors, 1 um: 1280 lines | 1.64 GB | |
//! | `jobs/small`, expand alone, depth 0.5 mm, residual 20 um, four sectors: 2400 lines | 1.80 GB | 1.84 GB |
//! | the same, depth 0.1 mm, residual 5 um: 23 k lines | 16.1 GB | |
//!
//! `tests/quick/cost.rs` requires that the estimate is within a factor of two of these figures. The memory of a station
//! is mainly that of its block in the run of the axes. The memory of a link over the clearance surface comes from its
//! many changes of speed. The verifier computes the run of the same blocks after the planner has freed its memory, and
//! has samples of all surfaces of the part in addition.

mod counts;
mod limits;

pub use counts::estimate;
pub use limits::check;
pub(crate) use limits::{check_motion, check_points, check_size};

use ir::{Motion, MoveKind, Operation, Program, RoughingStrategy};
use wheel::part::sample;

/// Memory of a station in the planned sector, bytes: contact and cutter location.
const PLANNED: f64 = 400.0;

/// Memory of a station in each sector to which it is copied, bytes: stations are thinned before, to a seventh on an axial rotor of 60 mm.
const COPIED: f64 = 300.0;

/// Memory of a block in the run of the axes, bytes.
const BLOCK: f64 = 1000.0;

/// Memory of a link over the clearance surface, bytes.
const LINK: f64 = 6e5;

/// Memory of the part and its samples, bytes.
const PART: f64 = 2e7;

/// Memory of the verifier for stations and links, as a share of the memory of planning.
const VERIFIED: f64 = 0.75;

/// Memory of the verifier for a sample of the design surfaces, with its share of the samples of the stock, bytes.
const SAMPLE: f64 = 170.0;

/// Distance of these samples, mm.
const SAMPLE_SPACING: f64 = 0.25;

/// Share of the stations of a later tool of `rough` that counts: of the planned passes of `jobs/wheel400` and `jobs/turbo20`
/// 0.05 to 0.2 cut.
const LATER_ROUGH: f64 = 0.3;

/// Numbers of stations.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stations {
    /// Stations of the planned sector.
    pub planned: f64,
    /// Stations in all sectors to which they are copied.
    pub copied: f64,
}

impl Stations {
    /// Adds the stations of an operation, `planned` in each of its sectors.
    #[must_use]
    pub fn and(self, planned: f64, operation: &Operation) -> Self {
        let copied = planned * operation.sectors.len() as f64 * reduced(operation);
        Self { planned: self.planned + planned, copied: self.copied + copied }
    }

    fn bytes(self) -> f64 {
        PLANNED * self.planned + COPIED * self.copied
    }
}

/// Share of the stations of an operation that become blocks: a later tool of `rough` cuts only the rest of the tool before.
fn reduced(operation: &Operation) -> f64 {
    let after_another =
        matches!(operation.kind.strategy(), Some(RoughingStrategy::Rough { .. })) && operation.rest.is_some();
    if after_another { LATER_ROUGH } else { 1.0 }
}

/// Size of the motion of an operation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cost {
    /// Lines in all sectors.
    pub lines: f64,
    /// Stations of these lines.
    pub stations: Stations,
    /// Links over the clearance surface.
    pub links: f64,
}

impl Cost {
    /// Memory in bytes.
    pub fn bytes(&self) -> f64 {
        self.stations.bytes() + LINK * self.links
    }
}

/// Peak memory, the larger value of planning and verification, from the bytes that planning takes for stations and
/// links.
fn peak(program: &Program, planning: f64) -> f64 {
    let samples = SAMPLE * sample::estimate(&program.part, SAMPLE_SPACING);
    PART + planning.max(samples + VERIFIED * planning)
}

/// Peak memory for the motions of all operations, bytes.
fn sum(program: &Program, costs: &[Cost]) -> f64 {
    peak(program, costs.iter().map(Cost::bytes).sum())
}

/// Estimated memory of plan and verification, bytes.
pub fn needed(program: &Program) -> f64 {
    sum(program, &estimate(program))
}

/// Peak memory for these stations, bytes.
pub fn of_stations(program: &Program, stations: Stations) -> f64 {
    peak(program, stations.bytes())
}

/// Peak memory for the run of the axes through a motion, with `planned` stations in a sector, bytes.
pub fn of_moves(program: &Program, motion: &Motion, planned: f64) -> f64 {
    let (mut blocks, mut links) = (0.0, 0.0);
    for operation in &motion.operations {
        blocks += operation.moves.len() as f64;
        let rapid = |k: usize| operation.moves[k].kind == MoveKind::Rapid;
        links += (0..operation.moves.len()).filter(|k| rapid(*k) && (*k == 0 || !rapid(k - 1))).count() as f64;
    }
    peak(program, PLANNED * planned + BLOCK * blocks + LINK * links)
}
