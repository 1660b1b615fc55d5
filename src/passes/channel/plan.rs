//! Plan of the operation `channel`: streamlines on the hub between the vanes, from inlet to outlet (Wei 3.3).
//!
//! Before: an operation. After: lines between the two fillets; the outer lines roll in the fillets. With
//! `constant-scallop` neighbours are everywhere as far apart as the scallop height allows, and additional lines begin
//! where the channel widens. With `equal-division` all lines run from inlet to outlet at equal shares of the arc
//! (formula 13). Their number is the least that keeps the scallop height at the widest place. The step there follows
//! the exact law with the curvature of the hub across the line.

use crate::diag::{Aborted, Diag, codes::planning};
use crate::geom::BandMetric;
use crate::geom::angle::nearest_turn;
use crate::ir::{CcOperation, CcPass, CcPoint, Drive, Operation, OperationId, OperationKind};
use crate::method::Spacing;
use crate::part::{FaceId, Part, Surface};
use crate::passes::context::{
    PassContext, STATIONS,
    limits::{check_fillet, check_points},
};
use crate::passes::lines::{self, DriveSurface, LaidLines, LineDirection, METRIC_STATIONS, constant_scallop, scallop};
use nalgebra::Vector2;

/// Contacts with the hub of the ball that rolls in the fillet: (u of the hub, azimuth), ascending in u.
type Contact = Vec<[f64; 2]>;

/// The machined surface: the hub of channel 0 between the two lines where the ball leaves the fillets.
struct ChannelFloor<'a> {
    part: &'a Part,
    /// Radius of the ball of the tool.
    radius: f64,
    walls: [Contact; 2],
}

impl ChannelFloor<'_> {
    /// Azimuth of the first wall, and the angle from it to the second.
    fn walls(&self, u: f64) -> (f64, f64) {
        let a = azimuth(&self.walls[0], u);
        let ahead = azimuth(&self.walls[1], u) - a;
        (a, nearest_turn(ahead, 0.0) + self.part.pitch())
    }

    fn point(&self, u: f64, w: f64, azimuth: f64) -> CcPoint {
        let hub = &self.part.hub;
        CcPoint { u, v: 0.0, w, position: hub.point(u, azimuth), normal: hub.normal(u, azimuth) }
    }

    /// Steps along and across the meridian that leave ridges of a given height.
    fn steps(&self, u: f64, height: f64) -> [f64; 2] {
        let hub = &self.part.hub;
        [hub.meridian_curvature(u), hub.ring_curvature(u)].map(|k| scallop::curved_step(self.radius, height, k))
    }
}

impl DriveSurface for ChannelFloor<'_> {
    fn name(&self) -> String {
        "channel".to_owned()
    }

    fn walls(&self, x: f64) -> (f64, f64) {
        self.walls(x)
    }

    fn contact(&self, x: f64, y: f64, share: f64) -> CcPoint {
        self.point(x, share, y)
    }

    fn speed(&self, x: f64, _y: f64, slope: f64) -> f64 {
        let m = self.part.hub.meridian(x);
        libm::hypot(m.first.norm(), m.point.x * slope)
    }

    /// Along and across the meridian, which are the principal directions, the metric has the exact step.
    fn metric(&self, height: f64) -> BandMetric {
        let hub = &self.part.hub;
        // Until the ball has passed the edges, but well before the axis.
        let beyond = [0.0, 1.0].map(|u| {
            let m = hub.meridian(u);
            self.radius.min(0.5 * m.point.x) / m.first.norm()
        });
        BandMetric::new(-beyond[0], 1.0 + beyond[1], METRIC_STATIONS + 1, |u| {
            let m = hub.meridian(u);
            let [along, across] = self.steps(u, height);
            [m.first.norm() / along, m.point.x / across]
        })
    }

    fn least_length(&self, height: f64) -> f64 {
        (0..STATIONS)
            .map(|i| {
                let u = (i as f64 + 0.5) / STATIONS as f64;
                let m = self.part.hub.meridian(u);
                let [along, across] = self.steps(u, height);
                m.first.norm() * m.point.x * self.walls(u).1 / along.max(across) / STATIONS as f64
            })
            .sum()
    }
}

/// Plans a channel operation.
///
/// # Errors
/// The ball does not reach the hub between the vanes, or is too big for its hollow; the sink holds the diagnostic.
pub(crate) fn plan(cx: &mut PassContext<'_>, id: OperationId, operation: &Operation) -> Result<CcOperation, Aborted> {
    let OperationKind::Channel { scallop: height, spacing, lines: order, .. } = operation.kind else {
        return Err(Aborted);
    };
    let part = &cx.program.part;
    let radius = cx.program.tools[operation.tool].solid.cutter.tip_radius();
    let rolling = part.main().fillet.map_or(radius, |f| f.get());
    check_hollow(cx, operation, radius)?;
    let [ahead, behind] = part.first_passage().walls;
    let bounds = (contact(part, ahead, rolling), contact(part, behind, rolling));
    let (Some(first), Some(second)) = bounds else {
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
    let floor = ChannelFloor { part, radius, walls: [first, second] };
    check_fit(cx, operation, &floor)?;
    let speed = [0.0, 1.0].map(|u| part.hub.meridian(u).first.norm());
    let directions = lines::directions(operation, radius, speed, order);
    let LaidLines { mut lines, notes } = match spacing {
        Spacing::EqualDivision => equal_division(cx, operation, &floor, height.get(), &directions)?,
        Spacing::ConstantScallop => constant_scallop(cx, operation, &floor, radius, height.get(), &directions)?,
    };
    lines::turn_back(&mut lines, order);
    let pass = |(j, points)| CcPass { path: None, label: format!("line {}", j + 1), drive: Drive::Hub, points };
    Ok(CcOperation { operation: id, passes: lines.into_iter().enumerate().map(pass).collect(), notes })
}

/// Refuses a ball with a larger radius than the hollow of the hub along or across the meridian.
fn check_hollow(cx: &mut PassContext<'_>, operation: &Operation, radius: f64) -> Result<(), Aborted> {
    let part = &cx.program.part;
    let tool = &cx.program.tools[operation.tool];
    let hollow = |u: f64| part.hub.meridian_curvature(u).min(part.hub.ring_curvature(u));
    let stations = (0..=STATIONS).map(|i| i as f64 / STATIONS as f64);
    let Some(worst) = stations.min_by(|a, b| hollow(*a).total_cmp(&hollow(*b))) else { return Err(Aborted) };
    let hollow_radius = -1.0 / hollow(worst);
    if hollow(worst) >= 0.0 || hollow_radius > radius {
        return Ok(());
    }
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
        .help(part.main().fillet.map_or_else(
            || what_would_do(part, radius),
            |f| format!("use a ball of less than {:.2} mm diameter", (200.0 * hollow_radius.min(f.get())).floor() / 100.0),
        )),
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
        ["the lines of this operation end at the fillets", "this ball would cut into the vanes there"],
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
    let most = part.main().fillet.map_or(floor.radius, |f| f.get());
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
    let hollow = |u: f64| part.hub.meridian_curvature(u).min(part.hub.ring_curvature(u));
    let stations = || (0..=STATIONS).map(|i| i as f64 / STATIONS as f64);
    let sharpest = stations().map(hollow).fold(f64::INFINITY, f64::min);
    let [ahead, behind] = part.first_passage().walls;
    let fits = |radius: f64| {
        let walls = contact(part, ahead, radius).zip(contact(part, behind, radius));
        walls.is_some_and(|(first, second)| {
            let floor = ChannelFloor { part, radius, walls: [first, second] };
            -sharpest * radius < 1.0 && stations().all(|u| floor.walls(u).1 > 0.0)
        })
    };
    // A smaller ball fits wherever a bigger ball fits, so that bisection finds the largest step.
    let (mut low, mut high) = (0_u32, (below / RADIUS_STEP).ceil() as u32);
    while high - low > 1 {
        let middle = low + (high - low) / 2;
        if fits(f64::from(middle) * RADIUS_STEP) { low = middle } else { high = middle }
    }
    let radius = f64::from(low) * RADIUS_STEP;
    match (low, part.main().fillet) {
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
) -> Result<LaidLines, Aborted> {
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
    check_points(cx, operation, count * grid.len() as f64)?;
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
    Ok(LaidLines { lines, notes })
}

/// Contact line of the ball that rolls between the hub and a face of sector 0.
fn contact(part: &Part, side: FaceId, radius: f64) -> Option<Contact> {
    let face = part.face(side);
    let mut line: Contact = Vec::with_capacity(STATIONS + 1);
    // The ball touches the hub before or behind the ruling whose face it touches: run on beyond both ends.
    let (from, to) = (-part.root_step(side, 0.0, radius), 1.0 + part.root_step(side, 1.0, radius));
    for i in 0..=STATIONS {
        let u = from + (to - from) * i as f64 / STATIONS as f64;
        let v = part.fillet_tangent(side, u, radius)?;
        let centre = face.surface.point(u, v) + face.normal(u, v) * radius;
        let (hub_u, _) = part.hub.closest(Vector2::new(libm::hypot(centre.x, centre.y), centre.z));
        let mut azimuth = libm::atan2(centre.y, centre.x);
        if let Some(last) = line.last() {
            azimuth = nearest_turn(azimuth, last[1]);
        }
        line.push([hub_u, azimuth]);
    }
    Some(line)
}

/// Azimuth of a contact line at a hub parameter; linear beyond both ends. Four point interpolation: over 0.15 mm its
/// error is far below a nanometre for a smooth line.
fn azimuth(line: &Contact, u: f64) -> f64 {
    let n = line.len();
    let i = line.partition_point(|p| p[0] <= u).clamp(2, n - 2);
    let at = &line[i - 2..i + 2];
    if u < line[0][0] {
        return line[0][1] + (line[1][1] - line[0][1]) / (line[1][0] - line[0][0]) * (u - line[0][0]);
    }
    if u > line[n - 1][0] {
        let (p, q) = (line[n - 2], line[n - 1]);
        return q[1] + (q[1] - p[1]) / (q[0] - p[0]) * (u - q[0]);
    }
    (0..4)
        .map(|j| (0..4).filter(|k| *k != j).map(|k| (u - at[k][0]) / (at[j][0] - at[k][0])).product::<f64>() * at[j][1])
        .sum()
}
