//! Memory that the verification of a motion takes, estimated before the start.
//!
//! Memory is needed for each ray of the simulated stock, for each block, for each piece of at most 1 deg and 3 mm into
//! which `sweep` divides a block, and for each change of speed. A text of a few kilobytes can turn the table by thousands of turns, so that the size of
//! the text gives no estimate. Peak memory was measured on two cores with changed texts of `jobs/small` and
//! `jobs/reduced`:
//!
//! | text | blocks | pieces | changes of speed | measured | estimated |
//! |---|---|---|---|---|---|
//! | small | 2504 | 7955 | 234 | 67 MB | 56 MB |
//! | with 100 000 blocks of 1 um | 102 504 | 107 985 | 237 | 293 MB | 316 MB |
//! | with 30 000 blocks of 1 mm to and fro | 32 504 | 37 961 | 30 235 | 1.31 GB | 1.39 GB |
//! | reduced | 785 | 8259 | 389 | 177 MB | 183 MB |
//! | wei2021 | 133 713 | 336 291 | 13 310 | 657 MB | 685 MB |

use super::proof::piece::{self, MAX_PIECE_LENGTH};
use super::{SPACING, stock};
use base::units;
use diagnostics::{Aborted, Diag, Sink, codes::verification};
use five_axis::feedrate::AXES;
use ir::{Motion, Program};
use wheel::part::sample;

/// Memory of the part, bytes.
const PART_BYTES: f64 = 2e7;

/// Memory of a sample of the design surfaces with its share of the samples of the stock, bytes.
const SAMPLE_BYTES: f64 = 170.0;

/// Memory of a block, bytes.
const BLOCK_BYTES: f64 = 500.0;

/// Memory of a piece of a block, bytes.
const PIECE_BYTES: f64 = 600.0;

/// Memory of a block during the run of the axes through its operation, bytes.
const RUN_BYTES_PER_BLOCK: f64 = 1500.0;

/// Memory of a change of speed during the run, bytes: the run has many knots around it.
const SPEED_CHANGE_BYTES: f64 = 4.2e4;

/// Least change of speed that counts, as a share of the larger speed.
const MIN_SPEED_CHANGE: f64 = 0.3;

/// Radius with which turns are converted to lengths, mm.
const ROTARY_RADIUS: f64 = 50.0;

/// Counts that determine the memory of an operation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Counted {
    blocks: f64,
    pieces: f64,
    /// Places where the axes change their speed.
    changes: f64,
}

impl Counted {
    fn new(program: &Program, motion: &Motion, operation: usize) -> Self {
        let (mut counted, mut before) = (Self::default(), [0.0; AXES]);
        piece::each_move(&program.machine, motion, operation, |at, _, ends| {
            counted.blocks += 1.0;
            counted.pieces += piece::piece_count(&program.machine.chain, &ends);
            let [from, to] = &ends;
            let way = to.tip - from.tip;
            let turns = [0, 1].map(|k| ROTARY_RADIUS * (to.rotary[k] - from.rotary[k]));
            let time = motion.operations[operation].moves[at.index as usize].time;
            let speed = [way.x, way.y, way.z, turns[0], turns[1]].map(|way| way / time);
            let size = |v: &[f64; AXES]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
            let change: [f64; AXES] = std::array::from_fn(|k| speed[k] - before[k]);
            counted.changes += f64::from(u8::from(size(&change) > MIN_SPEED_CHANGE * size(&speed).max(size(&before))));
            before = speed;
        });
        counted
    }

    /// Memory that is used until the end, bytes.
    fn kept(&self) -> f64 {
        BLOCK_BYTES * self.blocks + PIECE_BYTES * self.pieces
    }

    /// Memory during the run of the axes through the operation, bytes.
    fn run(&self) -> f64 {
        RUN_BYTES_PER_BLOCK * self.blocks + SPEED_CHANGE_BYTES * self.changes
    }
}

/// Peak memory of [`certify`](super::certify) for the moves of all operations, bytes.
fn peak(program: &Program, counted: &[Counted]) -> f64 {
    let samples = SAMPLE_BYTES * sample::estimate(&program.part, SPACING);
    // The operations run one after the other.
    let run = counted.iter().map(Counted::run).fold(0.0, f64::max);
    PART_BYTES + samples + stock::memory(program) + counted.iter().map(Counted::kept).sum::<f64>() + run
}

fn counted(program: &Program, motion: &Motion) -> Vec<Counted> {
    (0..motion.operations.len()).map(|operation| Counted::new(program, motion, operation)).collect()
}

/// Estimated peak memory of [`certify`](super::certify), bytes.
pub fn estimate(program: &Program, motion: &Motion) -> f64 {
    peak(program, &counted(program, motion))
}

/// Refuses a motion whose verification takes more memory than the program allows, before it starts.
///
/// # Errors
/// The motion is refused; the reason is in the sink.
pub fn check(program: &Program, motion: &Motion, sink: &mut Sink) -> Result<(), Aborted> {
    let counted = counted(program, motion);
    let needed = peak(program, &counted);
    if needed <= program.memory {
        return Ok(());
    }
    let mut diag = Diag::error(
        verification::OVER_MEMORY,
        format!(
            "the check needs about {} of memory; the limit is {}",
            units::bytes(needed),
            units::bytes(program.memory)
        ),
    )
    .help(format!(
        "use fewer blocks, turns of the table and changes of direction, or more memory: `--memory {}GB`",
        (1.2 * needed / 1e9).ceil()
    ));
    let size = |counted: &Counted| counted.kept() + counted.run();
    let largest = motion.operations.iter().zip(&counted).max_by(|a, b| size(a.1).total_cmp(&size(b.1)));
    if let Some((operation, most)) = largest {
        diag = diag.label(program.operations[operation.operation].span, "most of it for this operation").note(format!(
            "{:.0} blocks, which count as {:.0} pieces of at most {MAX_PIECE_LENGTH} mm and 1 deg, and {:.0} changes of speed",
            most.blocks, most.pieces, most.changes
        ));
    }
    sink.push(diag);
    Err(Aborted)
}
