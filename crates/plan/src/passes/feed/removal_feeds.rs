//! `removal-feeds`: lower feeds where the tool or the spindle could not take the chips.
//!
//! Before: joints with the feeds of the operations. After: in every block that removes stock, the feed keeps the removal
//! rate within `max-rate` of the tool, and the power at the cutter within that of the machine, where the job states the
//! material. Programs without these limits are left alone.
//!
//! The stock is simulated over the whole motion, links included. The section of the chips is the removed volume over the
//! way of the tip, on a way of some cells around each block, since single rays meet the chips by chance. The largest
//! section of the windows that a block touches decides. The verifier simulates its own stock in its own cells and judges
//! the rates of all blocks.

use base::progress::{Progress, Work};
use diagnostics::{Aborted, Diag, Sink, codes::planning};
use five_axis::between;
use ir::{JointMove, Motion, MoveKind, Operation, Program, Tool};
use tool_stock::collide::ToolSolid;
use tool_stock::stock::{self, Field, FieldError, Step, StepKind};
use wheel::material::Material;

/// Longest tip motion of a step, mm: it divides long blocks at the ends of the stock.
const STEP_LENGTH_MM: f64 = 0.5;

/// Cells in the radius of the smallest cutter, and the largest cell, mm.
const CELLS: f64 = 8.0;
const MAX_CELL_MM: f64 = 0.5;

/// Way over which a section is measured, in cells.
const WINDOW: f64 = 4.0;

/// Share of a limit that the planner uses. The volumes of two simulations in different cells differ by some percent over
/// a window.
const USED: f64 = 0.95;

/// Steps between two updates of the progress.
const PIECE: usize = 1 << 11;

/// Limits of removal of an operation.
struct RemovalLimits {
    /// Largest removal rate, mm3/min.
    rate: Option<f64>,
    /// Material, and the power of the spindle, kW.
    power: Option<(Material, f64)>,
    /// Teeth a minute.
    teeth: f64,
}

impl RemovalLimits {
    /// The limits of an operation; `None` without any.
    fn of(program: &Program, operation: &Operation, tool: &Tool) -> Option<Self> {
        let rate = tool.max_rate.map(|rate| rate.get());
        let power = program.stock.material.zip(program.machine.power);
        (rate.is_some() || power.is_some()).then(|| Self {
            rate,
            power,
            teeth: operation.speed.get() * f64::from(tool.flutes),
        })
    }

    /// Largest feed, mm/min, for chips of a section, mm2.
    fn feed(&self, section: f64) -> f64 {
        let by_rate = self.rate.map_or(f64::INFINITY, |rate| USED * rate / section);
        let by_power =
            self.power.map_or(f64::INFINITY, |(material, power)| material.feed_at(USED * power, section, self.teeth));
        by_rate.min(by_power)
    }
}

/// Sets the feeds.
///
/// # Errors
/// A stock without an inside, or with too many surfaces in a file; the sink has the reason.
pub(crate) fn run(program: &Program, motion: &mut Motion, progress: &Progress, sink: &mut Sink) -> Result<(), Aborted> {
    let limits: Vec<Option<RemovalLimits>> = motion
        .operations
        .iter()
        .map(|planned| {
            let operation = &program.operations[planned.operation];
            RemovalLimits::of(program, operation, &program.tools[operation.tool])
        })
        .collect();
    let Some(last) = limits.iter().rposition(Option::is_some) else { return Ok(()) };
    let mut field = field(program, sink)?;
    for (planned, limits) in motion.operations.iter_mut().zip(limits).take(last + 1) {
        let operation = &program.operations[planned.operation];
        let solid = program.tools[operation.tool].solid.cutter_alone(0.0);
        let work = progress.begin(format!("{}, removal", operation.name), planned.moves.len());
        let sections = sections(program, &planned.moves, &solid, &mut field, &work);
        if work.is_cancelled() {
            return Err(Aborted);
        }
        let Some(limits) = limits else { continue };
        for (m, section) in planned.moves.iter_mut().zip(sections) {
            m.feed = m.feed.map(|feed| if section > 0.0 { feed.min(limits.feed(section)) } else { feed });
        }
    }
    Ok(())
}

/// The stock before the first operation, in cells for the smallest cutter.
fn field(program: &Program, sink: &mut Sink) -> Result<Field, Aborted> {
    let radii = program.operations.iter().map(|(_, o)| {
        let solid = &program.tools[o.tool].solid;
        solid.cutter.widest_below(solid.flute_length)
    });
    let cell = radii.fold(MAX_CELL_MM * CELLS, f64::min) / CELLS;
    let found = program.stock.field(cell).or_else(|error| match error {
        FieldError::TooFine { least_cell, .. } => program.stock.field(least_cell.max(cell)),
        _ => Err(error),
    });
    found.map_err(|_| {
        let text = "the stock cannot be simulated for the feeds of `max-rate` and of the power of the spindle";
        sink.push(Diag::error(planning::REST_TOO_FINE, text).help("remove these limits, or correct the stock"));
        Aborted
    })
}

/// Largest section of the chips in each move, mm2; zero in moves that remove nothing.
fn sections(program: &Program, moves: &[JointMove], solid: &ToolSolid, field: &mut Field, work: &Work) -> Vec<f64> {
    let mut volumes: Vec<f64> = Vec::new();
    // Move and way of each step.
    let mut steps_of: Vec<(usize, f64)> = Vec::new();
    let stream = moves.windows(2).enumerate().flat_map(|(i, pair)| steps(program, pair, i + 1));
    work.in_pieces(
        stream,
        PIECE,
        |(i, _)| *i,
        |piece| {
            let first = steps_of.len();
            let steps = piece.into_iter().enumerate().map(|(n, (i, step))| {
                steps_of.push((i, (step.tips[1] - step.tips[0]).norm()));
                Step { block: u32::try_from(first + n).unwrap_or(u32::MAX), ..step }
            });
            let steps: Vec<Step> = steps.collect();
            let cuts = stock::simulate(field, solid, steps).cuts;
            volumes.resize(steps_of.len(), 0.0);
            for cut in cuts {
                if let Some(volume) = volumes.get_mut(cut.block as usize) {
                    *volume += cut.volume;
                }
            }
        },
    );
    let window = WINDOW * field.cell();
    let mut sections = vec![0.0_f64; moves.len()];
    let (mut start, mut length, mut volume) = (0, 0.0, 0.0);
    for end in 0..steps_of.len() {
        length += steps_of[end].1;
        volume += volumes[end];
        while start < end && length - steps_of[start].1 >= window {
            length -= steps_of[start].1;
            volume -= volumes[start];
            start += 1;
        }
        if volumes[start..=end].iter().all(|v| *v == 0.0) {
            continue;
        }
        // Before a window is full, and where the tip stands while the axis turns, the section is that over a window.
        let section = volume / length.max(window);
        for (i, _) in &steps_of[start..=end] {
            sections[*i] = sections[*i].max(section);
        }
    }
    sections
}

/// The steps of a move, with turn and tip motion within the limits of the stock simulation.
fn steps<'a>(program: &'a Program, pair: &[JointMove], index: usize) -> impl Iterator<Item = (usize, Step)> + use<'a> {
    let machine = &program.machine;
    let (from, to) = (pair[0].joints, pair[1].joints);
    let kind = match pair[1].kind {
        MoveKind::Cut => StepKind::Cut,
        MoveKind::Link => StepKind::Link,
        MoveKind::Rapid => StepKind::Rapid,
    };
    let tip = machine.forward(&from).tip;
    let length = machine.forward(&to).tip - tip;
    let turn = machine.turn(from.rotary, to.rotary);
    let count = (turn / stock::MAX_STEP_TURN).max(length.norm() / STEP_LENGTH_MM).ceil().max(1.0);
    (0..count as usize).map(move |k| {
        let [a, b] = [k as f64 / count, (k + 1) as f64 / count];
        let axes = [a, 0.5 * (a + b), b].map(|t| machine.chain.tool_axis(between(from.rotary, to.rotary, t)));
        (index, Step { block: 0, kind, tips: [tip + length * a, tip + length * b], axes })
    })
}
