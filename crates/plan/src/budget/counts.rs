//! Counts of lines, stations and links of each operation, from the sizes of the part and the figures of the job.

use super::{Cost, Stations, reduced};
use crate::spacing::{LOOP_STATIONS, loop_stations, rough_spacing};
use base::units::Mm;
use ir::{Operation, OperationKind, Program, RoughingStrategy};
use wheel::method::AxisMethod;
use wheel::part::{BladeId, FaceId, Part, Surface, SurfaceKind};

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

/// Stations of a stroke of `plunge`: above the stock, at its surface, at the floor, off the wall, and up.
const OF_STROKE: f64 = 6.0;

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
        const CURVE_CHORDS: u32 = 50;
        let at = |i: u32| f64::from(i) / f64::from(CURVE_CHORDS);
        let [one, other] = BladeId::MAIN.faces();
        let surface = |side: FaceId| &part.face(side).surface;
        let along = |side: FaceId, v: f64| {
            (0..CURVE_CHORDS)
                .map(|i| (surface(side).point(at(i + 1), v) - surface(side).point(at(i), v)).norm())
                .sum::<f64>()
        };
        let between = |u: f64, v: f64| (surface(one).point(u, v) - surface(other).point(u, v)).norm();
        let ends = [0.0, 1.0];
        let largest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
        let height = |i: u32| (surface(one).point(at(i), 1.0) - surface(one).point(at(i), 0.0)).norm();
        let radius = largest(&ends.map(|u| part.hub.meridian(u).point.x));
        Self {
            length: largest(&BladeId::MAIN.faces().map(|s| along(s, 0.0).max(along(s, 1.0)))),
            height: (0..=CURVE_CHORDS).map(height).fold(0.0, f64::max),
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
            OperationKind::Roughing { strategy: RoughingStrategy::Groove { depth }, .. } => {
                of(layers(depth) * program.part.blades.len() as f64, length, 1.0)
            }
            OperationKind::Roughing { strategy: RoughingStrategy::Expand { depth, residual }, .. } => {
                let free = (0.5 * self.width - radius).max(0.0);
                let pairs = (free / (2.0 * radius * residual.get()).sqrt()).ceil().max(1.0);
                of(layers(depth) * pairs, 2.0 * OF_V * length / ROUGHING_STATION, 1.0)
            }
            OperationKind::Roughing { strategy: RoughingStrategy::Rough { depth, stepover, .. }, .. } => {
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
            OperationKind::Roughing { strategy: RoughingStrategy::Plunge { stepover }, .. } => {
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
                let off_walls = program.part.main().fillet.as_ref().map_or(radius, |f| f.most().get());
                let off_walls = allowance_vane.map_or(off_walls, |vane| off_walls.max(radius) + vane.get());
                let floor = self.width - 2.0 * off_walls;
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
pub(super) fn with_figure(program: &Program, raised: Option<(Figure, f64)>) -> Vec<Cost> {
    let sizes = Sizes::new(&program.part);
    let mut roughed = [false; 2];
    let operations = program.operations.iter().map(|(_, operation)| {
        let mut kind = operation.kind.clone();
        if let Some((figure, least)) = raised
            && let Some(value) = figure.of(&mut kind)
        {
            *value = Mm(value.get().max(least));
        }
        let before = match kind.strategy() {
            Some(RoughingStrategy::Groove { .. }) => std::mem::replace(&mut roughed[0], true),
            Some(RoughingStrategy::Expand { .. }) => std::mem::replace(&mut roughed[1], true),
            Some(RoughingStrategy::Rough { .. } | RoughingStrategy::Plunge { .. }) | None => false,
        };
        sizes.cost(program, operation, &kind, if before { WENT_ON } else { 1.0 })
    });
    operations.collect()
}

base::named! {
    /// Figure that determines the distance between layers or lines.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(super) enum Figure {
        Depth = "depth",
        Residual = "residual",
        Stepover = "stepover",
        Scallop = "scallop",
    }
}

impl Figure {
    /// The figure of an operation; `None` where the operation has no such figure.
    pub(super) fn of(self, kind: &mut OperationKind) -> Option<&mut Mm> {
        match kind {
            OperationKind::Roughing { strategy, .. } => self.of_roughing(strategy),
            OperationKind::Channel { scallop, .. } | OperationKind::Point { scallop, .. } => {
                (self == Self::Scallop).then_some(scallop)
            }
            OperationKind::Flank { .. } => None,
        }
    }

    fn of_roughing(self, strategy: &mut RoughingStrategy) -> Option<&mut Mm> {
        match strategy {
            RoughingStrategy::Groove { depth } => (self == Self::Depth).then_some(depth),
            RoughingStrategy::Expand { depth, residual } => match self {
                Self::Depth => Some(depth),
                Self::Residual => Some(residual),
                Self::Stepover | Self::Scallop => None,
            },
            RoughingStrategy::Rough { depth, stepover, .. } => match self {
                Self::Depth => Some(depth),
                Self::Stepover => Some(stepover),
                Self::Residual | Self::Scallop => None,
            },
            RoughingStrategy::Plunge { stepover } => (self == Self::Stepover).then_some(stepover),
        }
    }
}
