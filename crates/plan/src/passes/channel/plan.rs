//! Plan of the operation `channel`: streamlines on the hub between the vanes, from inlet to outlet (Wei 3.3).
//!
//! Before: an operation. After: lines between the two fillets; the outer lines roll in the fillets. With
//! `constant-scallop` neighbours are everywhere as far apart as the scallop height allows, and additional lines begin
//! where the channel widens. With `equal-division` all lines run from inlet to outlet at equal shares of the arc
//! (formula 13). Their number is the least that keeps the scallop height at the widest place. The step there follows
//! the exact law with the curvature of the hub across the line.

use super::finished::Finished;
use super::floor::{ChannelFloor, TURN_OFF_STEPS, azimuth, contacts};
use super::middle::{IntervalFloor, Middle, Middles, before};
use crate::passes::context::{
    PassContext, STATIONS, in_passage,
    largest_ball::{check_fillet, less_than_radius},
};
use crate::passes::lines::{
    self, DriveSurface, LineDirection, PlannedLines, constant_scallop, left_to_ridges, scallop,
};
use diagnostics::{Aborted, Diag, codes::planning};
use ir::{CcOperation, CcPass, CcPoint, Drive, Operation, OperationId, OperationKind};
use nurbs::bracket::last_whole;
use wheel::method::{Lines, Spacing};
use wheel::part::{FloorBorder, Part, Passage, Rolling, Surface};

/// Plans a channel operation.
///
/// # Errors
/// The ball does not reach the hub between the vanes, or is too big for its hollow; the sink holds the diagnostic.
pub(crate) fn plan(cx: &mut PassContext<'_>, id: OperationId, middles: &Middles<'_>) -> Result<CcOperation, Aborted> {
    let operation = &cx.program.operations[id];
    let OperationKind::Channel { scallop: height, spacing, lines: order, allowance_vane, .. } = operation.kind else {
        return Err(Aborted);
    };
    let cutter = &cx.program.tools[operation.tool].solid.cutter;
    let radius = cutter.tip_radius();
    // The lead angle of a bull nose is searched where it fits.
    if cutter.ends_in_ball() {
        check_hollow(cx, operation, radius)?;
    }
    let ridges = left_to_ridges(cx, height.get());
    let (mut passes, mut all_notes) = (Vec::new(), Vec::new());
    for passage in cx.program.part.passages() {
        let middle = middles.get(&(id, passage.id));
        let larger = before(cx.program, id).filter_map(|id| middles.get(&(id, passage.id)));
        let finished: Vec<Finished> = larger.flat_map(|middle| middle.finished(ridges)).collect();
        let PlannedLines { lines, notes } = match allowance_vane {
            Some(allowance) => middle_lines(cx, operation, middle, &finished, allowance.get(), height.get())?,
            None => {
                let floor = whole_floor(cx, operation, passage, radius, height.get(), finished)?;
                let speed = [0.0, 1.0].map(|u| floor.part.hub.meridian(u).first.norm());
                let directions = lines::directions(operation, radius, speed, order, false);
                match spacing {
                    Spacing::EqualDivision => {
                        let mut planned = equal_division(cx, operation, &floor, height.get(), &directions.each)?;
                        lines::turn_back(&mut planned.lines, order);
                        planned
                    }
                    Spacing::ConstantScallop => {
                        constant_scallop(cx, operation, &floor, radius, height.get(), &directions)?
                    }
                }
            }
        };
        let drive = middle.map_or(Drive::Hub(passage.id), Middle::drive);
        let of_passage = |text| in_passage(&cx.program.part, passage.id, text);
        let pass = |(j, points)| CcPass { path: None, label: of_passage(format!("line {}", j + 1)), drive, points };
        passes.extend(lines.into_iter().enumerate().map(pass));
        all_notes.extend(notes.into_iter().map(of_passage));
    }
    Ok(CcOperation { operation: id, passes, notes: all_notes })
}

/// The floor up to the fillets.
fn whole_floor<'a>(
    cx: &mut PassContext<'a>,
    operation: &Operation,
    passage: Passage,
    radius: f64,
    height: f64,
    finished: Vec<Finished>,
) -> Result<ChannelFloor<'a>, Aborted> {
    let part = &cx.program.part;
    let turn_off = TURN_OFF_STEPS * scallop::flat_step(radius, height);
    let Some(walls) = contacts(part, &passage, FloorBorder::Fillets(Some(radius)), turn_off) else {
        let rolling = part.main().fillet.as_ref().map_or(radius, |f| f.most().get());
        cx.sink.push(
            Diag::error(
                planning::NO_FILLET,
                format!("at a ruling no ball of radius {rolling} mm touches hub and vane together"),
            )
            .label(operation.span, "this operation ends at the fillets")
            .help(what_would_do(part, rolling)),
        );
        return Err(Aborted);
    };
    let floor = ChannelFloor { part, passage, radius, walls, finished };
    check_fit(cx, operation, &floor)?;
    Ok(floor)
}

/// Lines of a larger tool, interval by interval; none where the tool fits nowhere.
fn middle_lines(
    cx: &mut PassContext<'_>,
    operation: &Operation,
    middle: Option<&Middle<'_>>,
    finished: &[Finished],
    allowance: f64,
    height: f64,
) -> Result<PlannedLines, Aborted> {
    let OperationKind::Channel { lines: order, .. } = operation.kind else { return Err(Aborted) };
    let mut all = PlannedLines { lines: Vec::new(), notes: Vec::new() };
    let Some(middle) = middle.filter(|m| m.fits()) else {
        all.notes.push("the tool fits nowhere between the vanes: smaller tools finish the floor".to_owned());
        return Ok(all);
    };
    all.notes.push(middle.note(allowance));
    // In the other direction the heel would cut first.
    let order = if matches!(middle.drive(), Drive::Hub(_)) { order } else { Lines::OneWay };
    let radius = middle.floor.radius;
    for interval in &middle.intervals {
        let surface = IntervalFloor { middle, interval: *interval, finished };
        let speed = [0.0, 1.0].map(|x| surface.speed(x, 0.0, 0.0));
        let directions = lines::directions(operation, radius, speed, order, false);
        let PlannedLines { lines, notes } = constant_scallop(cx, operation, &surface, radius, height, &directions)?;
        all.lines.extend(lines);
        all.notes.extend(notes);
    }
    Ok(all)
}

/// Where the hub is most hollow along or across the meridian, and the radius there; `None` where it is hollow nowhere.
fn hollow(part: &Part) -> Option<(f64, f64)> {
    let curvature = |u: f64| part.hub.meridian_curvature(u).min(part.hub.ring_curvature(u));
    let stations = (0..=STATIONS).map(|i| i as f64 / STATIONS as f64);
    let worst = stations.min_by(|a, b| curvature(*a).total_cmp(&curvature(*b)))?;
    (curvature(worst) < 0.0).then(|| (worst, -1.0 / curvature(worst)))
}

/// Refuses a ball with a larger radius than the hollow of the hub along or across the meridian.
fn check_hollow(cx: &mut PassContext<'_>, operation: &Operation, radius: f64) -> Result<(), Aborted> {
    let part = &cx.program.part;
    let tool = &cx.program.tools[operation.tool];
    let Some((worst, hollow_radius)) = hollow(part).filter(|(_, hollow)| *hollow <= radius) else { return Ok(()) };
    // Approximately the middle of the channel.
    let root = part.face(part.first_passage().walls[0]).surface.point(worst, 0.0);
    let at = part.hub.point(worst, libm::atan2(root.y, root.x) + 0.5 * part.pitch());
    cx.sink.push(
        Diag::error(
            planning::TOO_HOLLOW,
            format!(
                "the ball of {} (radius {radius} mm) is larger than the concave radius of the hub ({hollow_radius:.3} mm)",
                tool.name
            ),
        )
        .label(operation.span, "this operation finishes the hub")
        .label(tool.span, "this ball would gouge the hub beside its line")
        .place(format!("hub at u = {worst:.3}"), at)
        .help(match (&part.main().fillet, operation.kind.of_larger_tool()) {
            (_, Some(_)) => less_than_radius(hollow_radius),
            (Some(f), None) => less_than_radius(hollow_radius.min(f.least().get())),
            (None, None) => what_would_do(part, radius),
        }),
    );
    Err(Aborted)
}

/// Refuses a ball that is too big for the fillets or for the space between them.
fn check_fit(cx: &mut PassContext<'_>, operation: &Operation, floor: &ChannelFloor<'_>) -> Result<(), Aborted> {
    let part = floor.part;
    let tool = &cx.program.tools[operation.tool];
    check_fillet(
        cx,
        operation,
        "the lines of this operation end at the fillets",
        "this ball would cut into the vanes there",
    )?;
    let stations = || (0..=STATIONS).map(|i| i as f64 / STATIONS as f64);
    let place = |u: f64| {
        let (a, angle) = floor.walls(u);
        (format!("hub at u = {u:.3}"), part.hub.point(u, a + 0.5 * angle))
    };
    let width = |u: f64| floor.walls(u).1 * part.hub.meridian(u).point.x;
    let Some(narrow) = stations().min_by(|a, b| width(*a).total_cmp(&width(*b))) else { return Err(Aborted) };
    if width(narrow) > 0.0 {
        return Ok(());
    }
    let (name, at) = place(narrow);
    let most = part.main().fillet.as_ref().map_or(floor.radius, |f| f.most().get());
    cx.sink.push(
        Diag::error(
            planning::TOOL_TOO_LARGE,
            format!("balls of radius {most} mm that roll along both walls leave no hub surface between them"),
        )
        .label(operation.span, "this operation finishes the hub")
        .label(tool.span, format!("{} mm in diameter", 2.0 * floor.radius))
        .note(format!("they overlap by {:.3} mm along the hub", -width(narrow)))
        .place(name, at)
        .help(what_would_do(part, most)),
    );
    Err(Aborted)
}

/// Step of the search for the radius of a ball that fits, mm.
const RADIUS_STEP: f64 = 0.005;

/// Describes the largest ball below a radius that rolls along both walls, leaves floor between them and fits the hollow
/// of the hub. For a design with a fillet it describes the fillet as well.
fn what_would_do(part: &Part, below: f64) -> String {
    let stations = || (0..=STATIONS).map(|i| i as f64 / STATIONS as f64);
    let over_hollow = hollow(part).map_or(f64::INFINITY, |(_, hollow)| hollow);
    let fits = |radius: f64| {
        part.passages().all(|passage| {
            contacts(part, &passage, FloorBorder::Ball(Rolling::ball(radius)), f64::INFINITY).is_some_and(|walls| {
                let floor = ChannelFloor { part, passage, radius, walls, finished: Vec::new() };
                radius < over_hollow && stations().all(|u| floor.walls(u).1 > 0.0)
            })
        })
    };
    // A smaller ball fits wherever a bigger ball fits, so that bisection finds the largest step.
    let steps = last_whole(0, (below / RADIUS_STEP).ceil() as usize, |steps| fits(steps as f64 * RADIUS_STEP));
    let radius = steps as f64 * RADIUS_STEP;
    match (steps, &part.main().fillet) {
        (0, _) => "no ball fits along both walls of this channel: correct the faces, or use fewer vanes".to_owned(),
        (_, None) => format!("use a ball of at most {:.2} mm diameter", 2.0 * radius),
        (_, Some(_)) => {
            format!(
                "declare a fillet of at most {radius:.3} mm, and use a ball of at most {:.2} mm diameter",
                2.0 * radius
            )
        }
    }
}

/// The number of lines that the widest place needs, everywhere.
fn equal_division(
    cx: &mut PassContext<'_>,
    operation: &Operation,
    floor: &ChannelFloor<'_>,
    height: f64,
    directions: &[LineDirection; 2],
) -> Result<PlannedLines, Aborted> {
    let grid = &directions[0].grid;
    let (part, radius) = (floor.part, floor.radius);
    let [first, second] = &floor.walls;
    let mut count = 1.0_f64;
    let mut place = (0.0, 0.0, 0.0);
    for u in grid.iter().copied().filter(|u| (0.0..=1.0).contains(u)) {
        let (_, angle) = floor.walls(u);
        let m = part.hub.meridian(u);
        let delta = 1e-4;
        // Slope of a wall against the meridian. The less steep wall narrows the distance between lines.
        let slope = |wall| {
            let turn = azimuth(wall, u + delta) - azimuth(wall, u - delta);
            (turn * m.point.x / (2.0 * delta * m.first.norm())).abs()
        };
        let slope = slope(first).min(slope(second));
        let cos2 = 1.0 / (1.0 + slope * slope);
        let across = part.hub.ring_curvature(u) * cos2 + part.hub.meridian_curvature(u) * (1.0 - cos2);
        let step = scallop::curved_step(radius, height, across);
        let lines = angle * m.point.x * cos2.sqrt() / step;
        if lines > count {
            count = lines;
            place = (u, angle * m.point.x, step);
        }
    }
    let count = count.ceil();
    cx.check_points(operation, count * grid.len() as f64)?;
    let lines: Vec<Vec<CcPoint>> = (0..=count as usize)
        .map(|j| {
            let share = j as f64 / count;
            let grid = &directions[j % 2].grid;
            grid.iter()
                .map(|u| {
                    let (a, angle) = floor.walls(*u);
                    floor.point(*u, share, a + angle * share)
                })
                .collect()
        })
        .collect();
    let notes = vec![format!(
        "{} lines per channel (13) for a scallop of {:.4} mm: widest at u = {:.3}, arc {:.3} mm, exact step {:.4} mm; formula (9) gives {:.4} mm",
        lines.len(),
        height,
        place.0,
        place.1,
        place.2,
        scallop::formula_9_step(radius, height)
    )];
    Ok(PlannedLines { lines, notes })
}
