//! Reach of the tool of each operation that goes down to the floor of the channel: whether the tool fits with its
//! allowances, and the largest tool of its kind that fits.

use super::channel::{Channel, FreeWidth};
use super::throat::Throat;
use base::units::trim;
use diagnostics::codes::planning as codes;
use diagnostics::{Diag, Sink};
use ir::{Contract, ContractKind, Operation, OperationId, OperationKind, Program, ToolId};
use nurbs::bracket::Bracket;
use std::cell::RefCell;
use tool_stock::collide::Cutter;
use wheel::operation::{Allowances, VaneAllowance};
use wheel::part::{FaceId, FaceSurface, Part, Passage, Surface};

/// Reach of the tool of one operation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// Operation.
    pub operation: OperationId,
    /// Material that it leaves on the walls.
    pub allowance_vane: VaneAllowance,
    /// Material that it leaves on the hub, mm.
    pub allowance_hub: f64,
    /// Free space over the hub allowance for the flat part of the tool's end, beyond its corners. The tool fits where
    /// this width is at least the diameter less twice the corner radius. `None` where no such corner exists.
    pub free_width: Option<FreeWidth>,
    /// True when the tool fits over the hub allowance along the whole channel.
    pub fits: bool,
    /// True when the tool fits between the tips, so that it can rough upper layers.
    pub fits_top: bool,
}

/// Allowances on vane and hub; finishing leaves nothing. `None` where the width at the floor does not limit the tool.
fn allowances(kind: &OperationKind) -> Option<Allowances> {
    match kind {
        OperationKind::Channel { allowance_vane: Some(vane), .. } => {
            Some(Allowances { vane: VaneAllowance::even(*vane), ..Allowances::NONE })
        }
        OperationKind::Flank { .. } | OperationKind::Channel { .. } => Some(Allowances::NONE),
        OperationKind::Roughing { .. } | OperationKind::Point { .. } => kind.roughing(),
    }
}

/// Shape of the tool's end at the floor: a flat disc whose rim has a corner radius.
#[derive(Clone, Copy)]
struct End {
    radius: f64,
    corner: f64,
}

fn end(cutter: &Cutter) -> End {
    End { radius: cutter.end_radius(), corner: cutter.tip_radius() }
}

/// Places along the channel at which the height of the vane is measured.
const HEIGHT_PLACES: usize = 40;

/// Finds the reach of tools.
struct Finder<'a> {
    part: &'a Part,
    /// Walls of the passage.
    walls: [FaceId; 2],
    channel: Channel<'a>,
    throat: &'a Throat,
    /// Least height of the vane along the passage, mm.
    lowest: f64,
    /// Widths that are known, with their distances from walls and hub: a search for the largest tool needs the same width again where
    /// the corner of the tool stays.
    widths: RefCell<Vec<([f64; 2], Option<FreeWidth>)>>,
}

/// The first face of its blade among the walls of a passage: its levels are measured along it.
fn measured(part: &Part, [first, second]: [FaceId; 2]) -> &FaceSurface {
    &part.face(if first.index() == 0 { first } else { second }).surface
}

impl Finder<'_> {
    fn width(&self, wall: f64, floor: f64) -> Option<FreeWidth> {
        let known = self.widths.borrow().iter().find(|(at, _)| *at == [wall, floor]).map(|(_, width)| *width);
        known.unwrap_or_else(|| {
            let width = self.channel.free_width(wall, floor);
            self.widths.borrow_mut().push(([wall, floor], width));
            width
        })
    }

    /// Free space for the flat of an end with this corner radius, whose lowest point is `hub` over the hub.
    ///
    /// The centre of the corner stays corner + vane off the wall and corner + hub off the hub. A fillet of radius r is
    /// a hollow around a centre at the distance r from both. Inside of the fillet, at the height of the corner's
    /// centre, the corner comes nearer to the wall than the centre of the hollow by a chord of the hollow, less the
    /// allowance.
    fn free_width(&self, corner: f64, vane: VaneAllowance, hub: f64) -> Option<FreeWidth> {
        // The share of the height is largest where the vane is lowest, so that no tool is refused that fits.
        let vane = vane.at((corner + hub) / self.lowest);
        let plain = self.width(corner + vane, corner + hub)?;
        let radii = self.walls.iter().filter_map(|wall| self.part.fillet(*wall));
        let Some(fillet) = radii.map(|fillet| fillet.most().get()).reduce(f64::max) else { return Some(plain) };
        let hollow = fillet - vane - corner;
        let below = fillet - corner - hub;
        if hollow <= 0.0 || below <= 0.0 {
            return Some(plain);
        }
        let mut round = self.width(fillet, fillet)?;
        round.width += 2.0 * (hollow * hollow - below * below).max(0.0).sqrt();
        Some(if round.width < plain.width { round } else { plain })
    }

    /// True when the tool fits between the walls above the floor: each level is compared with the radius of the tool at
    /// that height, and with the allowance there.
    fn fits_above(&self, cutter: &Cutter, vane: VaneAllowance, from: f64) -> bool {
        self.throat.levels.iter().filter(|l| l.v >= from).all(|level| {
            let face = measured(self.part, self.walls);
            let ruling = (face.point(level.u, 1.0) - face.point(level.u, 0.0)).norm();
            // A tool without taper has its full radius at every height; the radius of a taper or barrel grows with the
            // height.
            let height = (level.v - from).max(0.0) * ruling;
            let radius = if cutter.widens() { cutter.radius_at(height) } else { cutter.end_radius() };
            2.0 * (radius + vane.at(level.v)) <= level.distance
        })
    }

    fn fits(&self, cutter: &Cutter, vane: VaneAllowance, hub: f64) -> bool {
        let End { radius, corner } = end(cutter);
        let flat = 2.0 * (radius - corner);
        // The floor is judged over the allowance, the levels from a quarter of the height up.
        self.fits_above(cutter, vane, 0.25) && self.free_width(corner, vane, hub).is_some_and(|r| r.width >= flat)
    }

    /// Largest diameter of this kind that fits, by bisection.
    fn largest(&self, cutter: &Cutter, vane: VaneAllowance, hub: f64) -> f64 {
        let End { corner, radius } = end(cutter);
        let least = if corner < radius { corner } else { 0.0 };
        let widest = self.throat.levels.iter().map(|l| l.distance).fold(0.0, f64::max);
        let radii = Bracket { holds: least, fails: 0.5 * widest + least };
        let largest = radii.narrowed(1e-3, |radius| self.fits(&cutter.with_end_radius(radius), vane, hub)).holds;
        if largest > least { (200.0 * largest).floor() / 100.0 } else { 0.0 }
    }
}

fn finders<'a>(part: &'a Part, throats: &'a [(Passage, Throat)]) -> Vec<Finder<'a>> {
    let finder = |(passage, throat): &'a (Passage, Throat)| {
        let channel = Channel::new(part, passage);
        let surface = measured(part, passage.walls);
        let heights = (0..=HEIGHT_PLACES).map(|i| surface.height(i as f64 / HEIGHT_PLACES as f64));
        let lowest = heights.fold(f64::INFINITY, f64::min);
        Finder { part, walls: passage.walls, channel, throat, lowest, widths: RefCell::default() }
    };
    throats.iter().map(finder).collect()
}

/// Largest diameter of the kind of the tool of an operation (same corner radius, same taper) that fits in all passages, mm, rounded
/// down to 0.01 mm. It is searched for only where a tool does not fit: for a ball each step measures other corners.
pub fn largest(program: &Program, throats: &[(Passage, Throat)], reach: &Reach) -> f64 {
    largest_of(program, &finders(&program.part, throats), reach)
}

fn largest_of(program: &Program, finders: &[Finder<'_>], reach: &Reach) -> f64 {
    let cutter = &program.tools[program.operations[reach.operation].tool].solid.cutter;
    let (vane, hub) = (reach.allowance_vane, reach.allowance_hub);
    finders.iter().map(|finder| finder.largest(cutter, vane, hub)).fold(f64::INFINITY, f64::min)
}

/// Measures these operations in all passages, and reports tools that cannot do their work.
pub fn check(program: &Program, throats: &[(Passage, Throat)], sink: &mut Sink) -> Vec<Reach> {
    let finders = finders(&program.part, throats);
    let reaches: Vec<Reach> = program
        .operations
        .iter()
        .filter_map(|(id, operation)| {
            let cutter = &program.tools[operation.tool].solid.cutter;
            let Allowances { vane, hub } = allowances(&operation.kind)?;
            let hub = hub.get();
            let widths = finders.iter().map(|finder| finder.free_width(end(cutter).corner, vane, hub));
            // The narrowest passage; none where one of them has no such place.
            let free_width = widths.reduce(|a, b| Some(if b?.width < a?.width { b? } else { a? })).flatten();
            Some(Reach {
                operation: id,
                allowance_vane: vane,
                allowance_hub: hub,
                free_width,
                fits: finders.iter().all(|finder| finder.fits(cutter, vane, hub)),
                fits_top: finders.iter().all(|finder| finder.fits_above(cutter, vane, 1.0)),
            })
        })
        .collect();
    let narrowest = throats.iter().map(|(_, throat)| throat);
    let Some(throat) = narrowest.min_by(|a, b| a.narrowest.distance.total_cmp(&b.narrowest.distance)) else {
        return reaches;
    };
    if let Some(fault) = fillets_too_large(program, throat, &reaches) {
        sink.push(fault);
        return reaches;
    }
    roughing(program, &finders, throat, &reaches, sink);
    // The floor that a larger ball does not reach is left to the next smaller one.
    let must_fit = |r: &&Reach| {
        let kind = &program.operations[r.operation].kind;
        kind.finishes() && kind.of_larger_tool().is_none()
    };
    // One message a tool, whatever number of operations it finishes.
    let mut reported: Vec<ToolId> = Vec::new();
    for reach in reaches.iter().filter(must_fit).filter(|r| !r.fits) {
        let tool = program.operations[reach.operation].tool;
        if !reported.contains(&tool) {
            reported.push(tool);
            let of_tool = |r: &&Reach| !r.fits && program.operations[r.operation].tool == tool;
            let all: Vec<&Reach> = reaches.iter().filter(must_fit).filter(of_tool).collect();
            sink.push(too_large(program, &finders, throat, &all, "finish the channel"));
        }
    }
    reaches
}

/// Whether two fillets are wider than the narrowest channel.
pub(super) fn fillets_fill(program: &Program, throats: &[(Passage, Throat)]) -> bool {
    let needed = two_fillets(program);
    throats.iter().any(|(_, throat)| throat.narrowest.distance < needed)
}

/// Width that two fillets beside each other take, mm; zero without fillets.
fn two_fillets(program: &Program) -> f64 {
    program.part.main().fillet.as_ref().map_or(0.0, |fillet| 2.0 * fillet.most().get())
}

/// The error for a part whose fillets leave no space between two vanes: no tool fits, so it is no fault of a tool.
fn fillets_too_large(program: &Program, throat: &Throat, reaches: &[Reach]) -> Option<Diag> {
    let fillet = program.part.main().fillet.as_ref()?;
    let needed = two_fillets(program);
    let (narrow, vanes) = (&throat.narrowest, program.part.vane_count);
    if needed <= narrow.distance || reaches.iter().all(|r| r.fits) {
        return None;
    }
    let message = format!(
        "the fillets do not fit between the vanes: two of {fillet} need {} mm, and the channel is {:.2} mm wide",
        trim(needed, 3),
        narrow.distance
    );
    let diag = Diag::error(codes::TOOL_TOO_LARGE, message)
        .label(program.name_span, format!("{vanes} vanes with fillets of {fillet}"))
        .place(narrow.place(), narrow.point)
        .note(format!(
            "{vanes} vanes stand {} deg apart: the throat follows from their number",
            trim(360.0 / f64::from(vanes), 2)
        ))
        .help(format!(
            "compare `vanes {vanes}` and `fillet {fillet}` with the drawing; a fillet of at most {:.2} mm fits",
            (50.0 * narrow.distance).floor() / 100.0
        ));
    Some(diag)
}

/// Roughing may leave the lower layers to a later, thinner tool. At least one tool has to reach the floor, or the rest
/// that the job allows before finishing.
fn roughing(program: &Program, finders: &[Finder<'_>], throat: &Throat, reaches: &[Reach], sink: &mut Sink) {
    let rough: Vec<&Reach> = reaches.iter().filter(|r| !program.operations[r.operation].kind.finishes()).collect();
    let whole = |c: &&Contract| c.kind == ContractKind::Rest && c.scope.is_whole();
    let rest = program.contracts.iter().find(whole).map_or(0.0, |c| c.bound.value());
    let reaches_floor = |r: &&Reach| {
        let cutter = &program.tools[program.operations[r.operation].tool].solid.cutter;
        r.fits || (rest > r.allowance_hub && finders.iter().all(|finder| finder.fits(cutter, r.allowance_vane, rest)))
    };
    if !rough.is_empty() && !rough.iter().any(reaches_floor) {
        sink.push(too_large(program, finders, throat, &rough, "reach the hub"));
        return;
    }
    for reach in rough.iter().filter(|r| !r.fits_top) {
        sink.push(too_large(program, finders, throat, &[reach], "enter the channel"));
    }
}

/// The error for tools that are too large, with the figures of the tool that is nearest to fitting.
fn too_large(program: &Program, finders: &[Finder<'_>], throat: &Throat, reaches: &[&Reach], purpose: &str) -> Diag {
    let diameter = |o: &Operation| 2.0 * end(&program.tools[o.tool].solid.cutter).radius;
    let measured = reaches.iter().map(|reach| (reach, largest_of(program, finders, reach)));
    let excess = |(reach, largest): &(&&Reach, f64)| diameter(&program.operations[reach.operation]) - largest;
    let Some((reach, largest)) = measured.min_by(|a, b| excess(a).total_cmp(&excess(b))) else {
        return Diag::error(codes::TOOL_TOO_LARGE, format!("no tool can {purpose}"));
    };
    let operation = &program.operations[reach.operation];
    let tool = &program.tools[operation.tool];
    let size = trim(diameter(operation), 3);
    let kind = tool.solid.cutter.keyword();
    let narrow = &throat.narrowest;
    let mut diag = Diag::error(
        codes::TOOL_TOO_LARGE,
        format!(
            "the {size} mm {kind} tool is too large to {purpose}: the throat of the channel is {:.2} mm",
            narrow.distance
        ),
    )
    .label(tool.span, format!("{size} mm in diameter"));
    for r in reaches {
        let o = &program.operations[r.operation];
        diag = diag.label(o.span, format!("`{}` uses `{}`", o.name, program.tools[o.tool].name));
    }
    let fillet = program.part.main().fillet.as_ref().map_or(String::new(), |f| format!(", between fillets of {f}"));
    let (vane, hub) = (reach.allowance_vane, trim(reach.allowance_hub, 3));
    let [tip, root] = [vane.tip(), vane.root()].map(|value| trim(value.get(), 3));
    let vane = if vane.growth() > 0.0 { format!("{tip} .. {root}") } else { root };
    diag = diag
        .note(format!("the tool must keep a distance of {vane} mm from both vanes and {hub} mm from the hub{fillet}"));
    if let Some(free_width) = reach.free_width {
        // The corners need space on both sides as well; a ball consists of corners only.
        let across = (free_width.width + 2.0 * end(&tool.solid.cutter).corner).max(0.0);
        diag = diag.note(format!(
            "at that height {across:.2} mm are free between the vanes after subtraction of the allowances"
        ));
    }
    diag = diag
        .note(format!("formula 8 of Wei 2021 measures arcs and gives {:.2} mm", throat.formula_8))
        .place(narrow.place(), narrow.point);
    if largest > 0.0 {
        diag.help(format!("use a {kind} tool of at most {largest:.2} mm"))
    } else {
        let fillet = program.part.main().fillet.as_ref().map_or(0.0, |f| 2.0 * f.most().get());
        let kept = 2.0 * reach.allowance_vane.root().get();
        let space = narrow.distance;
        diag.help(match () {
            () if fillet > space => {
                format!("no {kind} tool fits: two fillets of {:.2} mm are wider than the channel; use a smaller `fillet`", fillet / 2.0)
            }
            () if kept > space => {
                format!("no {kind} tool fits: allowances of {:.2} mm on both vanes leave nothing of the channel; use smaller ones", kept / 2.0)
            }
            () => format!("no {kind} tool fits; use a ball or bull tool, or smaller allowances"),
        })
    }
}
