//! A time that no program with the tools and feeds of a job is below.
//!
//! A ball of radius R that leaves at most e on a surface and cuts at most g into it touches, at one moment, places within
//! a = sqrt((e + g) (2 R + e - g) / (1 - (R + e) k)) of the place nearest to its centre, where k is the largest hollow curvature: along
//! a geodesic the square of the distance to the centre has a second derivative of at least 2 (1 - (R + e) k). A centre that moves
//! at v moves that place by at most v / (1 - R k), so that no more than 2 a v / (1 - R k) of the surface is finished in a unit of time.
//! A tool removes no more than the section that its limits allow, times its feed, and no more than the spindle drives.
//! A minute can serve both, so the bound is that of a linear program, by its dual: for each share m of the time that a minute of removal
//! counts, m V / Q plus, for each surface, its area times the least (1 - m q / Q) / rate of the tools, with Q the largest removal rate q.

use crate::surfaces::Milled;
use base::units::Mm3PerMin;
use ir::{Operation, OperationKind, Program, Tool};
use serde::Serialize;
use wheel::material::Material;
use wheel::part::SurfaceKind;

/// A time that no program is below, and what sets it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LowerBound {
    /// The time, minutes.
    pub minutes: f64,
    /// Its part by removal, minutes.
    pub removal: f64,
    /// Its part by surfaces, minutes.
    pub surfaces: f64,
    /// Largest removal rate of a tool, mm3/min.
    pub rate: f64,
    /// Whether the spindle sets this rate, and not the load of the tool.
    pub by_power: bool,
}

/// Steps of the share that is maximised over: the bound holds for each, so that the steps only make it smaller.
const SHARES: usize = 200;

/// The bound for all operations of a program on the surfaces of sector 0 that they finish, `volume` mm3 to be removed, and contracts on
/// excess and gouge, mm.
pub(crate) fn lower_bound(
    program: &Program,
    surfaces: &[Milled],
    volume: f64,
    [excess, gouge]: [f64; 2],
) -> LowerBound {
    let rates: Vec<Removal> = program.operations.iter().map(|(_, o)| removal(program, o)).collect();
    let largest =
        rates.iter().copied().fold(Removal { rate: 0.0, by_power: false }, |a, b| if b.rate > a.rate { b } else { a });
    let finishing: Vec<(&Operation, f64)> = program
        .operations
        .iter()
        .zip(&rates)
        .filter(|((_, o), _)| o.kind.finishes())
        .map(|((_, o), removal)| (o, removal.rate))
        .collect();
    // Area, and of each tool what it finishes in a minute and removes in it.
    let finished: Vec<(f64, Vec<[f64; 2]>)> = surfaces
        .iter()
        .filter_map(|surface| {
            let sectors = sectors(program, surface.kind)?;
            let of = |(o, removal): &(&Operation, f64)| [covered(program, o, surface, [excess, gouge]), *removal];
            Some((surface.area * sectors as f64, finishing.iter().map(of).collect()))
        })
        .collect();
    let at = |share: f64| {
        let least = |tools: &[[f64; 2]]| {
            let minutes =
                tools.iter().map(|[covered, removal]| (1.0 - share * removal / largest.rate).max(0.0) / covered);
            minutes.fold(f64::INFINITY, f64::min)
        };
        let on_surfaces = finished.iter().map(|(area, tools)| area * least(tools)).sum::<f64>();
        let by_removal = if largest.rate > 0.0 { share * volume / largest.rate } else { 0.0 };
        [by_removal, on_surfaces]
    };
    let shares = (0..=SHARES).map(|k| at(k as f64 / SHARES as f64));
    let [removal, surfaces] = shares.max_by(|a, b| (a[0] + a[1]).total_cmp(&(b[0] + b[1]))).unwrap_or_default();
    LowerBound { minutes: removal + surfaces, removal, surfaces, rate: largest.rate, by_power: largest.by_power }
}

/// Sectors in which a surface is finished; `None` for one that no operation finishes.
pub(crate) fn sectors(program: &Program, kind: SurfaceKind) -> Option<usize> {
    let finishes = |o: &&Operation| finishes(o, kind);
    program.operations.iter().map(|(_, o)| o).filter(finishes).map(|o| o.sectors.len()).max()
}

/// Whether an operation finishes a kind of surface.
pub(crate) fn finishes(operation: &Operation, kind: SurfaceKind) -> bool {
    match &operation.kind {
        OperationKind::Roughing { .. } => false,
        OperationKind::Flank { faces, .. } => matches!(kind, SurfaceKind::Face(face) if faces.contains(&face)),
        OperationKind::Channel { allowance_vane, .. } => {
            allowance_vane.is_none() && matches!(kind, SurfaceKind::Hub(_))
        }
        OperationKind::Point { surfaces, .. } => surfaces.contains(&kind),
    }
}

/// Removal rate of a tool, mm3/min.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Removal {
    rate: f64,
    by_power: bool,
}

/// The largest removal rate of an operation: a slot of its largest depth at its feed, or what the tool or the spindle states.
fn removal(program: &Program, operation: &Operation) -> Removal {
    let tool = &program.tools[operation.tool];
    let section = 2.0 * widest(tool) * tool.max_depth.get();
    let feed = operation.feed.get();
    let by_load = (section * feed).min(tool.max_rate.map_or(f64::INFINITY, Mm3PerMin::get));
    let material = program.stock.material.unwrap_or(Material::Aluminium);
    let teeth = operation.speed.get() * f64::from(tool.flutes);
    // Thin chips take more: at its feed each tooth takes the thickest.
    let kilowatts = material.power(1.0, feed, teeth) / feed;
    let by_power = program.machine.power.map_or(f64::INFINITY, |power| power / kilowatts);
    Removal { rate: by_load.min(by_power), by_power: by_power < by_load }
}

/// Largest radius of a cutter over its flutes, mm.
fn widest(tool: &Tool) -> f64 {
    tool.solid.cutter.widest_below(tool.solid.flute_length)
}

/// Area of a surface that an operation finishes in a minute, mm2; infinite where nothing bounds it.
fn covered(program: &Program, operation: &Operation, surface: &Milled, [excess, gouge]: [f64; 2]) -> f64 {
    let tool = &program.tools[operation.tool];
    let feed = operation.feed.get();
    let by_side = matches!(operation.kind, OperationKind::Flank { .. }) || !tool.solid.cutter.ends_in_ball();
    if by_side {
        // It touches along a line of its side, or over its end.
        return feed * tool.solid.flute_length.max(2.0 * widest(tool));
    }
    let radius = tool.solid.cutter.tip_radius();
    let hollow = 1.0 - (radius + excess) * surface.concave;
    if hollow <= 0.0 {
        return f64::INFINITY;
    }
    let half = ((excess + gouge) * (2.0 * radius + excess - gouge) / hollow).sqrt();
    2.0 * half * feed / (1.0 - radius * surface.concave)
}
