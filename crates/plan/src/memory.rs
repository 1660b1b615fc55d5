//! Memory of a compilation, estimated before the start: the larger value of planning and verification.
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

use crate::spacing::{LOOP_STATIONS, loop_stations, rough_spacing};
use base::units::{Mm, bytes, trim};
use diagnostics::{Aborted, Diag, Sink, codes::planning};
use ir::{Motion, MoveKind, Operation, OperationKind, Program};
use wheel::method::{AxisMethod, FlankMethod};
use wheel::part::{BladeId, FaceId, Part, Surface, SurfaceKind, sample};

/// Memory of a station in the planned sector, bytes: contact and cutter location.
const PLANNED: f64 = 400.0;

/// Memory of a station in each sector to which it is copied, bytes: mostly that of its block in the run of the axes.
const COPIED: f64 = 1400.0;

/// Memory of a block in the run of the axes, bytes.
const BLOCK: f64 = 1500.0;

/// Memory of a link over the clearance surface, bytes.
const LINK: f64 = 4.5e5;

/// Memory of the part and its samples, bytes.
const PART: f64 = 2e7;

/// Memory of the verifier for stations and links, as a share of the memory of planning.
const VERIFIED: f64 = 0.75;

/// Memory of the verifier for a sample of the design surfaces, with its share of the samples of the stock, bytes.
const SAMPLE: f64 = 170.0;

/// Distance of these samples, mm.
const SPACING: f64 = 0.25;

/// Share of the lines of `method corridor` without a direct link.
const NOT_JOINED: f64 = 0.1;

/// Memory of the links of a line of `rough`, as a share of that of a link over the clearance surface. More than 95 of 100
/// run through air, with fewer changes of speed. Measured: 0.2 MB a pass that cuts.
const THROUGH_AIR: f64 = 0.3;

/// Stations of a finishing line.
const FINISHING_STATIONS: f64 = 405.0;

/// Distance of the stations of `groove` and `expand`, mm.
const ROUGHING_STATION: f64 = 0.7;

/// Length of a V line of `expand` as a share of a line from inlet to outlet, on average: its legs meet where the
/// channel is narrow.
const OF_V: f64 = 0.6;

/// Share of the height that remains for a roughing operation after an earlier one of the same kind. The depth that the
/// earlier operation has reached is known only while planning.
const WENT_ON: f64 = 1.0 / 3.0;

/// Share of the stations of a later tool of `rough` that counts: of the planned passes of `jobs/wheel400` and `jobs/turbo20`
/// 0.05 to 0.2 cut.
const LATER_ROUGH: f64 = 0.3;

/// Stations of a stroke of `plunge`: above the stock, at its surface, at the floor, off the wall, and up.
const OF_STROKE: f64 = 6.0;

/// Most strips that a plan may optimise: each takes about a second of a processor.
const MOST_STRIPS: u32 = 200;

/// Strips of a face that `strips auto` may try.
const AUTO_BANDS: u32 = 8;

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

/// Share of the stations of an operation that become blocks: a later tool of `rough` keeps what the tool before has left.
fn reduced(operation: &Operation) -> f64 {
    let after_another = matches!(operation.kind, OperationKind::Rough { .. }) && operation.rest.is_some();
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

/// Sizes of a channel and its walls, mm.
struct Sizes {
    /// Length of a wall from inlet to outlet.
    length: f64,
    /// Length of the longest ruling.
    height: f64,
    /// Longest arc between two vanes.
    width: f64,
    /// Thickness of a vane at its thicker end.
    thickness: f64,
}

impl Sizes {
    fn new(part: &Part) -> Self {
        /// Number of chords with which a curve is measured.
        const PIECES: u32 = 50;
        let at = |i: u32| f64::from(i) / f64::from(PIECES);
        let [one, other] = BladeId::MAIN.faces();
        let surface = |side: FaceId| &part.face(side).surface;
        let along = |side: FaceId, v: f64| {
            (0..PIECES).map(|i| (surface(side).point(at(i + 1), v) - surface(side).point(at(i), v)).norm()).sum::<f64>()
        };
        let between = |u: f64, v: f64| (surface(one).point(u, v) - surface(other).point(u, v)).norm();
        let ends = [0.0, 1.0];
        let largest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
        let height = |i: u32| (surface(one).point(at(i), 1.0) - surface(one).point(at(i), 0.0)).norm();
        let radius = largest(&ends.map(|u| part.hub.meridian(u).point.x));
        Self {
            length: largest(&BladeId::MAIN.faces().map(|s| along(s, 0.0).max(along(s, 1.0)))),
            height: (0..=PIECES).map(height).fold(0.0, f64::max),
            width: (part.pitch() * radius - between(1.0, 0.0)).max(0.0),
            thickness: largest(&ends.map(|u| between(u, 0.0).max(between(u, 1.0)))),
        }
    }

    /// `share` is the share of the height that is roughed.
    fn cost(&self, program: &Program, operation: &Operation, kind: &OperationKind, share: f64) -> Cost {
        let cutter = &program.tools[operation.tool].solid.cutter;
        let radius = cutter.nominal_radius();
        let length = self.length + operation.lead_in.get() + operation.lead_out.get();
        // Distance between the lines of a ball for a scallop height.
        let step = |h: &Mm| 2.0 * (2.0 * radius * h.get() - h.get() * h.get()).max(h.get() * h.get()).sqrt();
        let layers = |depth: &Mm| (share * self.height / depth.get()).ceil();
        let sectors = operation.sectors.len() as f64;
        let of = |lines: f64, stations: f64, linked: f64| {
            let stations = Stations::default().and(lines * stations, operation);
            Cost { lines: lines * sectors, stations, links: lines * sectors * linked * reduced(operation) }
        };
        let linked = |method: &AxisMethod| if *method == AxisMethod::Corridor { NOT_JOINED } else { 1.0 };
        match kind {
            OperationKind::Groove { depth, .. } => of(layers(depth) * program.part.blades.len() as f64, length, 1.0),
            OperationKind::Expand { depth, residual, .. } => {
                let free = (0.5 * self.width - radius).max(0.0);
                let pairs = (free / (2.0 * radius * residual.get()).sqrt()).ceil().max(1.0);
                of(layers(depth) * pairs, 2.0 * OF_V * length / ROUGHING_STATION, 1.0)
            }
            OperationKind::Rough { depth, stepover, .. } => {
                let free = (0.5 * self.width - radius).max(0.0);
                let pairs = (free / stepover.get()).ceil() + 1.0;
                let lines = of(layers(depth) * pairs, 2.0 * OF_V * length / rough_spacing(program), THROUGH_AIR);
                // Each loop begins where the loop before it ends.
                let stations = layers(depth) * loop_stations(program, operation, length);
                let loops = of(stations / LOOP_STATIONS, LOOP_STATIONS, 0.0);
                let stations = Stations {
                    planned: lines.stations.planned + loops.stations.planned,
                    copied: lines.stations.copied + loops.stations.copied,
                };
                Cost { lines: lines.lines + loops.lines, stations, links: lines.links }
            }
            OperationKind::Plunge { stepover, .. } => {
                let free = (self.width - 2.0 * radius).max(0.0);
                let rows = (length + 4.0 * radius) / stepover.get();
                of(rows * ((free / stepover.get()).ceil() + 1.0), OF_STROKE, THROUGH_AIR)
            }
            OperationKind::Flank { faces, flank } => {
                of(f64::from(flank.strips.unwrap_or(1)) * faces.len() as f64, FINISHING_STATIONS, 1.0)
            }
            OperationKind::Channel { scallop, method, allowance_vane, .. } => {
                // The remaining width is finished by balls that roll in the fillets. What a larger ball leaves to the
                // next one is known only while planning.
                let beside = program.part.main().fillet.as_ref().map_or(radius, |f| f.most().get());
                let beside = allowance_vane.map_or(beside, |vane| beside.max(radius) + vane.get());
                let floor = self.width - 2.0 * beside;
                of((floor.max(0.0) / step(scallop)).ceil() + 1.0, FINISHING_STATIONS, linked(method))
            }
            OperationKind::Point { surfaces, scallop, method, .. } => {
                let across = |surface: &SurfaceKind| match surface {
                    SurfaceKind::Fillet(_) => program
                        .part
                        .main()
                        .fillet
                        .as_ref()
                        .map_or(0.0, |f| std::f64::consts::FRAC_PI_2 * f.most().get()),
                    SurfaceKind::Tip(_) => self.thickness,
                    SurfaceKind::InletEdge(_) | SurfaceKind::OutletEdge(_) => {
                        std::f64::consts::FRAC_PI_2 * self.thickness
                    }
                    _ => self.height,
                };
                let lines = surfaces.iter().map(|s| (across(s) / step(scallop)).ceil() + 1.0).sum();
                of(lines, FINISHING_STATIONS, linked(method))
            }
        }
    }
}

/// Size of the motion of each operation, in machining order.
pub fn estimate(program: &Program) -> Vec<Cost> {
    with_figure(program, None)
}

/// [`estimate`], with a figure of all operations, mm, raised to `raised` where it is less.
fn with_figure(program: &Program, raised: Option<(Figure, f64)>) -> Vec<Cost> {
    let sizes = Sizes::new(&program.part);
    let mut roughed = [false; 2];
    let operations = program.operations.iter().map(|(_, operation)| {
        let mut kind = operation.kind.clone();
        if let Some((figure, least)) = raised
            && let Some(value) = figure.of(&mut kind)
        {
            *value = Mm(value.get().max(least));
        }
        let before = match kind {
            OperationKind::Groove { .. } => std::mem::replace(&mut roughed[0], true),
            OperationKind::Expand { .. } => std::mem::replace(&mut roughed[1], true),
            OperationKind::Rough { .. }
            | OperationKind::Plunge { .. }
            | OperationKind::Flank { .. }
            | OperationKind::Channel { .. }
            | OperationKind::Point { .. } => false,
        };
        sizes.cost(program, operation, &kind, if before { WENT_ON } else { 1.0 })
    });
    operations.collect()
}

/// Peak memory, the larger value of planning and verification, from the bytes that planning takes for stations and
/// links.
fn peak(program: &Program, planning: f64) -> f64 {
    let samples = SAMPLE * sample::estimate(&program.part, SPACING);
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

base::named! {
    /// Figure that determines the distance between layers or lines.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    enum Figure {
        Depth = "depth",
        Residual = "residual",
        Stepover = "stepover",
        Scallop = "scallop",
    }
}

impl Figure {
    /// The figure of an operation; `None` where the operation has no such figure.
    fn of(self, kind: &mut OperationKind) -> Option<&mut Mm> {
        match (self, kind) {
            (
                Self::Depth,
                OperationKind::Groove { depth, .. }
                | OperationKind::Expand { depth, .. }
                | OperationKind::Rough { depth, .. },
            ) => Some(depth),
            (Self::Stepover, OperationKind::Rough { stepover, .. } | OperationKind::Plunge { stepover, .. }) => {
                Some(stepover)
            }
            (Self::Residual, OperationKind::Expand { residual, .. }) => Some(residual),
            (Self::Scallop, OperationKind::Channel { scallop, .. } | OperationKind::Point { scallop, .. }) => {
                Some(scallop)
            }
            _ => None,
        }
    }
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

/// Refuses a plan that would take too much memory or optimise too many strips, before it starts.
///
/// # Errors
/// The plan is refused; the reason is in the sink, with a value that would fit.
pub fn check(program: &Program, sink: &mut Sink) -> Result<(), Aborted> {
    check_bands(program, sink)?;
    let costs = estimate(program);
    let needed = sum(program, &costs);
    if needed <= program.memory {
        return Ok(());
    }
    let mut ranked: Vec<(&Operation, Cost)> = program.operations.iter().map(|(_, o)| o).zip(costs).collect();
    ranked.sort_by(|a, b| b.1.bytes().total_cmp(&a.1.bytes()));
    let Some((operation, cost)) = ranked.first() else { return Ok(()) };
    let more = format!("`--memory {}GB`", (1.2 * needed / 1e9).ceil());
    // What the part needs without any motion: no operation lowers it.
    let of_part = peak(program, 0.0);
    let help = match fitting(program, operation) {
        _ if of_part > program.memory => format!("allow more memory: {more}; the part alone needs more than the limit"),
        Some(fits) => format!("use {fits} or more, fewer `sectors`, or more memory: {more}"),
        None => {
            format!("divide the job into several jobs with fewer operations or `sectors`, or allow more memory: {more}")
        }
    };
    let mut diag = Diag::error(
        planning::OVER_MEMORY,
        format!("the plan needs about {} of memory; the limit is {}", bytes(needed), bytes(program.memory)),
    )
    .help(help)
    .note(format!("the part with samples of the surfaces of all its sectors: about {}", bytes(of_part)));
    diag = if of_part > cost.bytes() {
        diag.label(program.name_span, "most of it for this part")
    } else {
        diag.label(operation.span, format!("{:.0} lines with {:.0} points", cost.lines, cost.stations.copied))
    };
    for (operation, cost) in ranked.iter().take(5) {
        diag = diag.note(format!("`{}`: about {}", operation.name, bytes(cost.bytes())));
    }
    sink.push(diag);
    Err(Aborted)
}

/// The least usual value of a figure with which the plan fits, when no operation has a lower one.
fn fitting(program: &Program, operation: &Operation) -> Option<String> {
    let solid = &program.tools[operation.tool].solid;
    let radius = solid.cutter.nominal_radius();
    let figures = [
        (Figure::Residual, radius),
        (Figure::Stepover, 2.0 * radius),
        (Figure::Scallop, radius),
        (Figure::Depth, solid.flute_length),
    ];
    figures.into_iter().find_map(|(figure, most)| {
        let now = figure.of(&mut operation.kind.clone())?.get();
        let usual = (-4..=2).flat_map(|e| [1.0, 1.5, 2.0, 3.0, 5.0, 7.0].map(|m: f64| m * 10f64.powi(e)));
        let fits = |value: &f64| sum(program, &with_figure(program, Some((figure, *value)))) <= program.memory;
        let value = usual.filter(|v| *v > now && *v <= most).find(fits)?;
        let text = if value < 0.2 { format!("{} um", trim(value * 1e3, 3)) } else { format!("{} mm", trim(value, 3)) };
        Some(format!("`{} {text}`", figure.name()))
    })
}

/// Refuses more strips than can be optimised in minutes.
fn check_bands(program: &Program, sink: &mut Sink) -> Result<(), Aborted> {
    let strips_of = |o: &Operation| match &o.kind {
        OperationKind::Flank { faces, flank } if flank.method == FlankMethod::Minimax => {
            flank.strips.unwrap_or(AUTO_BANDS).saturating_mul(u32::try_from(faces.len()).unwrap_or(u32::MAX))
        }
        OperationKind::Flank { .. } => 0,
        OperationKind::Groove { .. }
        | OperationKind::Expand { .. }
        | OperationKind::Rough { .. }
        | OperationKind::Plunge { .. }
        | OperationKind::Channel { .. }
        | OperationKind::Point { .. } => 0,
    };
    let all = program.operations.iter().map(|(_, o)| strips_of(o)).fold(0, u32::saturating_add);
    let Some((_, operation)) =
        program.operations.iter().filter(|_| all > MOST_STRIPS).max_by_key(|(_, o)| strips_of(o))
    else {
        return Ok(());
    };
    sink.push(
        Diag::error(
            planning::OVER_MEMORY,
            format!("the job optimises up to {all} strips of flank milling; the limit is {MOST_STRIPS}"),
        )
        .label(operation.span, format!("{} of them", strips_of(operation)))
        .help(format!(
            "use fewer `strips` (`strips auto` counts as {AUTO_BANDS} per face), or fewer operations with `method minimax` in one job"
        )),
    );
    Err(Aborted)
}
