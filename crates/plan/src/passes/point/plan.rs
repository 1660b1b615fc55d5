//! Plan of the operation `point`: lines of constant scallop on faces, fillets, edges and tips of vanes.
//!
//! Before: an operation. After: lines along each surface: on faces from the shroud down to the fillet, on fillets
//! from the face to the hub, on edges and tips from face to face; surface by surface, or level by level on both
//! faces. Both borders are lines. Where a surface is higher, as vanes are at the inlet, further lines begin and end
//! on it. A ball with the radius of the fillet needs a single line in the fillet. A spiral runs round both faces and
//! both edges of a vane without leaving it.

use super::axes::VaneAxis;
use super::spiral::Around;
use super::vane_surface::{LocalGouge, VaneSurface, nominal_tilt};
use crate::passes::context::{
    AxisTilt, PassContext, from_outlet,
    largest_ball::{check_fillet, less_than_radius},
};
use crate::passes::lines::{self, DriveSurface, PlannedLines, constant_scallop};
use base::units::length;
use diagnostics::{Aborted, Diag, codes::planning};
use ir::{CcOperation, CcPass, Drive, Operation, OperationId, OperationKind};
use nurbs::bracket::Bracket;
use rayon::prelude::*;
use wheel::method::Lines;
use wheel::part::{
    BladeId, FaceId, FaceSurface, Part, Surface, SurfaceKind,
    chart::{Chart, Shape, charts, edges, edges_of, tips},
};

/// Plans a point milling operation.
///
/// # Errors
/// A cutter bigger than the fillet or than a hollow of a surface; no fillet where a fillet is to be finished. The sink
/// holds the diagnostic.
pub(crate) fn plan(cx: &mut PassContext<'_>, id: OperationId) -> Result<CcOperation, Aborted> {
    let operation = &cx.program.operations[id];
    let OperationKind::Point { ref surfaces, scallop, lines: order, milling, levels, .. } = operation.kind else {
        return Err(Aborted);
    };
    let part = &cx.program.part;
    let cutter = cx.program.tools[operation.tool].solid.cutter;
    // An edge ends at the fillets, but the space in front of it is free: a ball of any size fits there.
    let reasons = surfaces.iter().find_map(|kind| match kind {
        SurfaceKind::Face(_) => {
            Some(["the lines of this operation end at the fillets", "this ball would cut into the hub there"])
        }
        SurfaceKind::Fillet(_) => {
            Some(["this operation cuts the fillets", "this ball would cut into hub and vane beside them"])
        }
        _ => None,
    });
    if let Some([at_operation, at_tool]) = reasons {
        check_fillet(cx, operation, at_operation, at_tool)?;
    }
    let mut all = charts(part);
    all.extend(edges(part).chain(tips(part)));
    let axes = VaneAxis::new(part);
    let surface_of = |cx: &mut PassContext<'_>, kind: SurfaceKind| drive_surface(cx, operation, &all, &axes, kind);
    let (mut planned, mut notes) = (Vec::new(), Vec::new());
    let mut round = Vec::new();
    for blade in part.blade_ids() {
        let faces = blade.faces().map(SurfaceKind::Face);
        if order == Lines::Spiral && faces.iter().all(|f| surfaces.contains(f)) {
            let pair = [surface_of(cx, faces[0])?, surface_of(cx, faces[1])?];
            let spiral = spiral(cx, operation, [&pair[0], &pair[1]], scallop.get())?;
            notes.extend(spiral.notes);
            planned.push((Drive::Round(blade), axes.of_blade(blade, "spiral".to_owned()), spiral.lines));
            round.extend(faces);
        }
    }
    for kind in surfaces.iter().filter(|kind| !round.contains(kind)) {
        let surface = surface_of(cx, *kind)?;
        let speed = [0.0, 1.0]
            .map(|x| [0.0, 0.5, 1.0].map(|y| surface.beyond(x, y).norm()).into_iter().fold(f64::INFINITY, f64::min));
        let side = match kind {
            SurfaceKind::Face(side) | SurfaceKind::Fillet(side) => Some(*side),
            _ => None,
        };
        let back = side.zip(milling).is_some_and(|(side, milling)| from_outlet(part, side, milling));
        let directions = lines::directions(operation, cutter.tip_radius(), speed, order, back);
        let lines = constant_scallop(cx, operation, &surface, cutter.tip_radius(), scallop.get(), &directions)?;
        notes.extend(lines.notes);
        let mut lines = lines.lines;
        if matches!(kind, SurfaceKind::Face(_)) {
            // From the shroud down.
            lines.reverse();
        }
        planned.push((Drive::Contact(*kind), surface.name(), lines));
    }
    let mut passes = Vec::new();
    for (drive, name, lines) in planned {
        for (j, points) in lines.into_iter().enumerate() {
            passes.push(CcPass { path: None, label: format!("{name} line {}", j + 1), drive, points });
        }
    }
    if let Some(height) = levels {
        // The lines of a face stay in their order, and the faces in theirs within a level.
        let level = |pass: &CcPass| (deepest(part, pass) / height.get()).ceil() as u32;
        passes.sort_by_cached_key(|pass| (blade_of(pass), level(pass)));
        let last = passes.iter().map(level).max().unwrap_or(0);
        notes.push(format!("{last} levels of {height}, each on all faces before the next one"));
    }
    Ok(CcOperation { operation: id, passes, notes })
}

/// A face, fillet or edge under the cutter of an operation.
///
/// # Errors
/// A cutter bigger than a hollow of the surface; no such surface. The sink holds the diagnostic.
fn drive_surface<'a>(
    cx: &mut PassContext<'_>,
    operation: &Operation,
    charts: &'a [Chart<'a>],
    axes: &'a VaneAxis<'a>,
    kind: SurfaceKind,
) -> Result<VaneSurface<'a>, Aborted> {
    let part = &cx.program.part;
    let cutter = cx.program.tools[operation.tool].solid.cutter;
    let (side, round_edge) = match kind {
        SurfaceKind::Face(side) | SurfaceKind::Fillet(side) => (side, side.edge_end().is_some()),
        SurfaceKind::InletEdge(blade) => (blade.faces()[0], part.edge(blade, 0).is_some()),
        SurfaceKind::OutletEdge(blade) => (blade.faces()[0], part.edge(blade, 1).is_some()),
        SurfaceKind::Tip(blade) => (blade.faces()[0], false),
        // No operation mills other surfaces.
        _ => return Err(Aborted),
    };
    let Some(chart) = charts.iter().find(|c| c.kind == kind) else { return Err(no_fillet(cx, operation)) };
    let mut surface = VaneSurface { chart, side, round_edge, cutter, axes, low: vec![0.0; 2] };
    let own = match kind {
        SurfaceKind::Face(face) => Some(face),
        SurfaceKind::InletEdge(blade) => part.edge(blade, 0),
        SurfaceKind::OutletEdge(blade) => part.edge(blade, 1),
        _ => None,
    };
    // An edge ends at the fillet round it; without one the cutter has to stay off the hub there as on a face.
    if let Some(face) = own.filter(|face| matches!(kind, SurfaceKind::Face(_)) || part.fillet(*face).is_none()) {
        surface.low = lowest(cx, operation, &surface, face);
    }
    check_hollow(cx, operation, &surface)?;
    Ok(surface)
}

/// The blade of a pass along a face.
fn blade_of(pass: &CcPass) -> BladeId {
    if let Drive::Contact(SurfaceKind::Face(side)) = pass.drive { side.blade } else { BladeId::MAIN }
}

/// Largest depth of a line of a face below the tip of the blade, along the rulings, mm.
fn deepest(part: &Part, pass: &CcPass) -> f64 {
    let Drive::Contact(SurfaceKind::Face(side)) = pass.drive else { return 0.0 };
    let surface = &part.face(side).surface;
    let on_face = pass.points.iter().filter(|p| (0.0..=1.0).contains(&p.u));
    on_face.map(|p| (surface.point(p.u, 1.0) - surface.point(p.u, p.v)).norm()).fold(0.0, f64::max)
}

/// A spiral round both faces.
fn spiral(
    cx: &mut PassContext<'_>,
    operation: &Operation,
    pair: [&VaneSurface<'_>; 2],
    height: f64,
) -> Result<PlannedLines, Aborted> {
    let blade = pair[0].side.blade;
    let edges = edges_of(&cx.program.part, blade);
    let low = pair.iter().flat_map(|g| g.low.iter().copied()).fold(0.0, f64::max);
    let OperationKind::Point { milling, .. } = operation.kind else { return Err(Aborted) };
    let [first, _] = blade.faces();
    // Without a sense the spiral runs to the inlet on the first face.
    let other_way = milling.is_some_and(|milling| !from_outlet(&cx.program.part, first, milling));
    let around = Around { faces: [pair[0], pair[1]], edges: &edges, low, other_way };
    let target = lines::left_to_ridges(cx, height);
    let leads = [operation.lead_in.get(), operation.lead_out.get()];
    let (spiral, _) = lines::refined(target, |planned| {
        let density = |side: usize, x: f64, y: f64| pair[side].density(x, y, planned);
        let spiral = around.lay(&density, leads);
        cx.check_points(operation, spiral.points.len() as f64)?;
        let ridges = [0, 1].map(|side| pair[side].highest_ridge(&spiral.turns[side]));
        Ok((spiral, ridges.into_iter().flatten().reduce(f64::max)))
    })?;
    let length: f64 = spiral.turns.iter().flatten().map(lines::SurfaceLine::length).sum();
    let least: f64 = pair.iter().map(|g| g.least_length(height)).sum();
    let note = format!(
        "a spiral of {} turns per vane for a scallop of {height:.4} mm: {length:.1} mm of contact on both faces, {:.1} % over the \
         lower bound {least:.1} mm (area over the larger step)",
        spiral.turns[0].len(),
        100.0 * (length / least - 1.0)
    );
    Ok(PlannedLines { lines: vec![spiral.points], notes: vec![note] })
}

fn no_fillet(cx: &mut PassContext<'_>, operation: &Operation) -> Aborted {
    cx.sink.push(
        Diag::error(planning::NO_FILLET_TO_FINISH, format!("`{}` finds no fillet on the part", operation.name))
            .label(operation.span, "this operation finishes fillets")
            .help("declare the radius in the part, `fillet 3 mm`, or remove the operation"),
    );
    Aborted
}

/// Refuses a cutter that would cut into the surface beside its line: one that is less curved than a hollow.
///
/// Half of the chord tolerance is allowed. The interpolation takes the other part of what a contract on gouge leaves.
fn check_hollow(cx: &mut PassContext<'_>, operation: &Operation, surface: &VaneSurface<'_>) -> Result<(), Aborted> {
    /// Share of the largest sphere that is advised: a smaller cutter is checked at other places.
    const ADVISED_SHARE: f64 = 0.9;
    let allowed = 0.5 * cx.program.tolerances.chord.get();
    let LocalGouge { depth, sphere, at: [x, y] } = surface.deepest_gouge(allowed);
    if depth <= allowed {
        return Ok(());
    }
    let tool = &cx.program.tools[operation.tool];
    let place = surface.chart.place(x, y);
    let mut diag = Diag::error(
        planning::TOO_HOLLOW,
        format!("{} would cut {} deep into the {} beside its line", tool.name, length(depth), surface.name()),
    )
    .label(operation.span, "in this operation")
    .label(
        tool.span,
        format!("this cutter is wider than a hollow; {} are allowed, half of the chord tolerance", length(allowed)),
    )
    .place(
        format!("{} at u = {:.3}, v = {:.3}", surface.name(), place.parameters[0], place.parameters[1]),
        place.position,
    )
    .help(less_than_radius(ADVISED_SHARE * sphere));
    if matches!(cx.program.part.face(surface.side).surface, FaceSurface::Lofted(_))
        && surface.chart.fillet_radius(0.0).is_none()
    {
        diag =
            diag.note("a curve through points of a section that are rounded or few has waves; a larger or a smaller `fit` makes them lower");
    }
    cx.sink.push(diag);
    Err(Aborted)
}

/// Stations of the lower border, minus one.
const BORDER_INTERVALS: usize = 60;

/// Bisection steps for the lower border: down to a thousandth of the ruling.
const BORDER_BISECTIONS: usize = 10;

/// Lowest y at which the cutter stands on a face without cutting into fillet or hub. For a ball it is the edge of the
/// fillet.
fn lowest(cx: &PassContext<'_>, operation: &Operation, surface: &VaneSurface<'_>, face: FaceId) -> Vec<f64> {
    let part = &cx.program.part;
    let solid = &cx.program.tools[operation.tool].solid;
    let stations = (0..=BORDER_INTERVALS).map(|i| i as f64 / BORDER_INTERVALS as f64);
    if solid.cutter.ends_in_ball() {
        let radius = solid.cutter.tip_radius();
        let height = |x: f64| {
            let [low, high] = [0.0, 1.0].map(|y| surface.chart.place(x, y).parameters[1]);
            let v = part.fillet_tangent(face, x, radius)?;
            Some(((v - low) / (high - low)).clamp(0.0, 1.0))
        };
        // With a fillet the chart begins where any ball that fits the fillet may stand.
        return if part.fillet(face).is_some() {
            vec![0.0; 2]
        } else {
            stations.map(|x| height(x).unwrap_or(0.0)).collect()
        };
    }
    let stands = |x: f64, y: f64| {
        let place = surface.chart.place(x, y);
        let [u, v] = place.parameters;
        let axis = surface.axes.axis(surface.chart.kind, u, v, AxisTilt::Away(nominal_tilt(&solid.cutter)));
        let tip = solid.cutter.tip_at(&place.position, &place.normal, &axis);
        tip.is_some_and(|tip| cx.obstacles.cutter_inside(solid, &tip, &axis).is_none())
    };
    let border = |x: f64| Bracket { holds: 1.0, fails: 0.0 }.halved(BORDER_BISECTIONS, |y| stands(x, y)).holds;
    stations.collect::<Vec<f64>>().into_par_iter().map(border).collect()
}
