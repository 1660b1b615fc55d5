//! Free space beside a vane: the largest ball that touches the point-milled faces and fillets without meeting the next
//! vane across the channel. The floor is no limit here: places where the ball would cut into the hub are left out.

use diagnostics::codes::planning as codes;
use diagnostics::{Diag, Sink};
use ir::{Operation, OperationId, OperationKind, Program};
use nalgebra::Point3;
use nurbs::bracket::Bracket;
use nurbs::proximity::Patch;
use nurbs::range::{Interval, Jet};
use rayon::prelude::*;
use wheel::part::{FaceId, FaceSurface, Part, Surface, SurfaceId, SurfaceKind, chart::Place, columns::Columns};

/// Free space for the tool of a point milling operation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeSpace {
    /// Operation.
    pub operation: OperationId,
    /// Largest radius of a ball that fits at every place of its surfaces, at most the fillet radius, mm, rounded down
    /// to 0.005 mm.
    pub largest: f64,
    /// True when the ball of the tool fits; without a ball, its corner.
    pub fits: bool,
}

/// Numbers of intervals along and across a surface, at whose ends the free space is measured.
const SURFACE_INTERVALS: [usize; 2] = [60, 8];

/// Most steps in which a ball shrinks until it meets nothing; a few are enough.
const SHRINKS: usize = 40;

/// Largest cut of a ball into the hub that counts as rounding, mm.
const HUB_CUT_ROUNDING_MM: f64 = 1e-6;

/// Radius of the first ball where none is required, mm, larger than any free space.
const ENDLESS: f64 = 1e4;

/// A place of a vane with the free space before it.
struct Spot {
    kind: SurfaceKind,
    place: Place,
    /// Largest radius of a ball that touches the vane here and does not meet the next vane, at most the largest that is needed.
    radius_limit: f64,
}

/// Measures every point milling operation, and reports tools that are too large.
pub fn check(program: &Program, sink: &mut Sink) -> Vec<FreeSpace> {
    let part = &program.part;
    let mut spots: Vec<Spot> = Vec::new();
    let mut found = Vec::new();
    for (id, operation) in program.operations.iter() {
        let OperationKind::Point { surfaces, .. } = &operation.kind else { continue };
        // No vane stands opposite an edge.
        let inside = |kind: &SurfaceKind| matches!(kind, SurfaceKind::Face(_) | SurfaceKind::Fillet(_));
        if !surfaces.iter().any(inside) {
            continue;
        }
        if spots.is_empty() {
            spots = measure(part, largest_needed(program));
        }
        let mut own: Vec<&Spot> = spots.iter().filter(|s| surfaces.contains(&s.kind)).collect();
        own.sort_by(|a, b| a.radius_limit.total_cmp(&b.radius_limit));
        let radius = program.tools[operation.tool].solid.cutter.tip_radius();
        let fits = narrowest(part, &own, radius).is_none_or(|s| s.radius_limit >= radius);
        let space = FreeSpace { operation: id, largest: largest(part, &own), fits };
        if !fits {
            sink.push(too_large(program, operation, &space, narrowest(part, &own, radius)));
        }
        found.push(space);
    }
    found
}

/// Radius beyond which free space makes no difference, mm: no tool of the operations and no answer is larger.
fn largest_needed(program: &Program) -> f64 {
    let of_tools = program.tools.iter().map(|(_, tool)| tool.solid.cutter.tip_radius());
    let fillet = program.part.main().fillet.as_ref().map_or(ENDLESS, |f| f.least().get());
    of_tools.fold(fillet, f64::max)
}

/// Measures the free space at places all over faces and fillets, up to a radius.
fn measure(part: &Part, most: f64) -> Vec<Spot> {
    let [columns, rows] = SURFACE_INTERVALS;
    let sides = part.blade_ids().flat_map(|blade| part.sides(blade)).collect::<Vec<_>>();
    let across: Vec<Opposite> = sides.into_par_iter().map(|side| Opposite::of(part, side)).collect();
    let mut spots = Vec::new();
    for surface in Columns::of_faces_and_fillets(part) {
        let Some(next) = across.iter().find(|opposite| opposite.side == surface.side) else { continue };
        let column = |i: usize| {
            let places = surface.places(i as f64 / columns as f64, (0..=rows).map(|j| j as f64 / rows as f64));
            let spot = |place| Spot { kind: surface.kind, radius_limit: radius_limit(next, &place, most), place };
            places.into_iter().map(spot).collect::<Vec<_>>()
        };
        spots.par_extend((0..=columns).into_par_iter().flat_map_iter(column));
    }
    spots
}

/// The surface on the other side of the channel from a side of a blade.
struct Opposite {
    side: FaceId,
    surface: FaceSurface,
    /// Boxes that together contain it: ranges of the coordinates over its parts.
    boxes: Vec<[Interval; 3]>,
}

impl Opposite {
    fn of(part: &Part, side: FaceId) -> Self {
        /// Boxes along and up the surface: some millimetres each.
        const BOXES: [usize; 2] = [16, 4];
        let (opposite, turn) = part.opposite(side);
        let surface = part.face(opposite).surface.rotated(turn);
        let range = |k: usize, n: usize| [k as f64 / n as f64, (k + 1) as f64 / n as f64];
        let part_of = |k: usize| [range(k / BOXES[1], BOXES[0]), range(k % BOXES[1], BOXES[1])];
        let coordinates = |[u, v]: [[f64; 2]; 2]| {
            let [along, up] = [u, v].map(|range| Jet::constant(Interval::new(range)));
            surface.partials(u, v).along(&along, &up).map(|coordinate| coordinate.orders[0])
        };
        let boxes = (0..BOXES[0] * BOXES[1]).map(|k| coordinates(part_of(k))).collect();
        Self { side, surface, boxes }
    }

    /// True where the boxes show that no point of the surface lies nearer to a point than this distance. Most balls are far from the next
    /// vane, so that its nearest point need not be known.
    fn is_beyond(&self, p: &Point3<f64>, distance: f64) -> bool {
        self.boxes.iter().all(|ranges| {
            let off = |k: usize| (ranges[k].low - p[k]).max(p[k] - ranges[k].high).max(0.0);
            let [x, y, z] = [0, 1, 2].map(off);
            x * x + y * y + z * z >= distance * distance
        })
    }
}

/// Radius of the largest ball, at most `most`, that touches a place from outside and does not meet a surface. Each step shrinks the ball
/// until it passes through the surface point nearest to its centre (Ma, Bae, Choi: 3D medial point approximation using
/// nearest neighbors, 2012).
fn radius_limit(opposite: &Opposite, place: &Place, most: f64) -> f64 {
    let mut radius = most;
    for _ in 0..SHRINKS {
        let centre = place.position + place.normal * radius;
        if opposite.is_beyond(&centre, radius) {
            break;
        }
        let near = opposite.surface.closest(&centre, Patch::WHOLE);
        if near.distance >= radius - HUB_CUT_ROUNDING_MM {
            break;
        }
        let chord = near.point - place.position;
        radius = chord.norm_squared() / (2.0 * chord.dot(&place.normal));
    }
    radius
}

/// The place with the least free space among the places at which a ball of this radius does not cut into the hub; the places are in the
/// order of their free space.
fn narrowest<'a>(part: &Part, spots: &[&'a Spot], radius: f64) -> Option<&'a Spot> {
    let over_hub = |s: &&&Spot| {
        let centre: Point3<f64> = s.place.position + s.place.normal * radius;
        part.hub.distance(&centre) >= radius - HUB_CUT_ROUNDING_MM
    };
    spots.iter().find(over_hub).copied()
}

/// Largest radius of a ball that fits at every place at which the ball does not cut into the hub, by bisection.
fn largest(part: &Part, spots: &[&Spot]) -> f64 {
    let fillet = part.main().fillet.as_ref().map_or(f64::INFINITY, |f| f.least().get());
    let radii = Bracket { holds: 0.0, fails: spots.iter().map(|s| s.radius_limit).fold(0.0, f64::max).min(fillet) };
    let fits = |radius: f64| narrowest(part, spots, radius).is_some_and(|s| s.radius_limit >= radius);
    let low = radii.narrowed(1e-4, fits).holds;
    let largest = if fillet - low <= 1e-4 { fillet } else { low };
    (200.0 * largest).floor() / 200.0
}

fn too_large(program: &Program, operation: &Operation, space: &FreeSpace, at: Option<&Spot>) -> Diag {
    let tool = &program.tools[operation.tool];
    let cutter = &tool.solid.cutter;
    let end = match cutter.first().ring {
        _ if cutter.barrel_arc().is_some() => "tip",
        0.0 => "ball",
        _ => "corner",
    };
    let radius = cutter.tip_radius();
    let mut diag = Diag::error(
        codes::TOOL_TOO_LARGE,
        format!("the {end} of {} (radius {radius} mm) touches the neighbouring vane too", tool.name),
    )
    .label(tool.span, format!("{} mm in diameter", 2.0 * radius))
    .label(operation.span, format!("`{}` uses `{}`", operation.name, tool.name))
    .help(format!("use a {end} of at most {} mm radius", space.largest));
    if let Some(spot) = at {
        let [u, v] = spot.place.parameters;
        diag = diag.note(format!("a radius of {:.3} mm fits there", spot.radius_limit)).place(
            format!("{} at u = {u:.3}, v = {v:.3}", SurfaceId { kind: spot.kind, sector: 0 }),
            spot.place.position,
        );
    }
    diag
}
