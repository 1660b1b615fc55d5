//! A blade from closed sections: division into faces and edges, curves, surfaces.

use super::face_curves::no_surface;
use super::limits::{MAX_COORDINATE, MIN_RADIUS, SAME_POINT};
use super::names::blade_name;
use crate::diag::codes::geometry as codes;
use crate::diag::{Diag, Sink};
use crate::geom::{NurbsCurve, Revolution};
use crate::job::model::{BladeSpec, Looks, LoopSpec, PartSpec, SectionsSpec};
use crate::part::{Blade, FaceSurface};
use crate::sections::Outline;
use crate::sections::divide::{DivideFault, divide};
use crate::sections::loft::{LoftFault, LoftedBlade, loft};
use crate::units::length;
use nalgebra::{Point3, Vector2};

/// A blade of sections in its part.
pub(super) struct SectionBlade<'a> {
    pub(super) part: &'a PartSpec,
    pub(super) blade: &'a BladeSpec,
    pub(super) sections: &'a SectionsSpec,
    /// Generating curve of the hub, from inlet to outlet.
    pub(super) hub: &'a NurbsCurve,
}

/// Change of azimuth from the leading to the trailing edge that tells the pressure face, at least, rad.
const TOLD: f64 = 2.0 / 180.0 * std::f64::consts::PI;

const EDGES: [&str; 2] = ["leading edge", "trailing edge"];

/// The blade through its sections; faults and what was found go to the sink.
pub(super) fn fitted(given: &SectionBlade<'_>, sink: &mut Sink) -> Option<Blade> {
    let name = blade_name(given.part, &given.blade.name);
    let faulty = given.sections.loops.iter().filter(|section| !points_are_good(section, sink)).count();
    if faulty > 0 {
        return None;
    }
    // Along the hub from inlet to outlet.
    let hub = Revolution::new(given.hub.clone(), Vector2::new(0.0, 0.0));
    let flow = |p: &Point3<f64>| hub.closest(Vector2::new(libm::hypot(p.x, p.y), p.z)).0;
    let divided = given.sections.loops.iter().map(|section| {
        let points: Vec<Point3<f64>> = section.points.iter().map(|p| Point3::from(*p)).collect();
        divide(&points, given.sections.edges, flow, None).map_err(|fault| (section, fault))
    });
    let (outlines, faults): (Vec<_>, Vec<_>) = divided.partition(Result::is_ok);
    let mut faults = faults.into_iter().filter_map(Result::err);
    if let Some((section, fault)) = faults.next() {
        // The others mostly have the same cause.
        let more = faults.count();
        let diag = not_divided(&name, section, &fault, given.sections);
        sink.push(if more > 0 { diag.note(format!("{more} more sections have a fault of this kind")) } else { diag });
        return None;
    }
    let mut outlines: Vec<Outline> = outlines.into_iter().flatten().collect();
    same_order(&mut outlines);
    let looks = pressure_looks(given, &name, &outlines, sink)?;
    // The face ahead of the other is the one with the greater azimuth.
    let middle = &outlines[outlines.len() / 2];
    let first_ahead = turn(&halfway(&middle.faces[1]), &halfway(&middle.faces[0])) > 0.0;
    if first_ahead != (looks == Looks::CounterClockwise) {
        outlines.iter_mut().for_each(exchange);
    }
    let made = match loft(&outlines, given.sections.fit.get()) {
        Ok(made) => made,
        Err(fault) => {
            sink.push(not_lofted(&name, given, &fault));
            return None;
        }
    };
    told(given, &name, &made, looks, sink).then(|| {
        let LoftedBlade { faces: [pressure, suction], edges, .. } = made;
        let fillet = (given.blade.fillet.get() > 0.0).then_some(given.blade.fillet);
        Blade::new(&given.blade.name, [pressure.into(), suction.into()], fillet)
            .with_edges(edges.map(|edge| edge.map(FaceSurface::from)))
    })
}

/// Reports points that no section can have.
fn points_are_good(section: &LoopSpec, sink: &mut Sink) -> bool {
    let before = sink.count();
    let far = section.points.iter().position(|p| p.iter().any(|x| !x.is_finite() || x.abs() > MAX_COORDINATE));
    if let Some(i) = far {
        sink.push(
            Diag::error(codes::COORDINATE, format!("a point of section {} lies beyond 10 m", section.name))
                .label(section.spans[i], "the unit of the list applies to all coordinates")
                .help("correct the coordinate, or the unit"),
        );
        return false;
    }
    let count = section.points.len();
    let gap = |i: usize| (Point3::from(section.points[i]) - Point3::from(section.points[(i + 1) % count])).norm();
    if let Some(i) = (0..count).find(|i| gap(*i) < SAME_POINT) {
        let last = i + 1 == count;
        let again = if last { "the first point again: a loop closes by itself" } else { "the next point is the same" };
        sink.push(
            Diag::error(
                codes::POINTS,
                format!("points {} and {} of section {} coincide", i + 1, (i + 1) % count + 1, section.name),
            )
            .label(section.spans[i], again)
            .help(if last { "remove the last point" } else { "remove one of the two points" }),
        );
    }
    if let Some(i) = section.points.iter().position(|p| libm::hypot(p[0], p[1]) < MIN_RADIUS) {
        sink.push(
            Diag::error(codes::AXIS, format!("section {} touches the axis of rotation", section.name))
                .label(section.spans[i], "this point")
                .help("check the coordinates, and that Z is the axis of rotation"),
        );
    }
    sink.count() == before
}

/// Lets the first faces of all sections lie on the same side: the points of a section may run in either sense.
fn same_order(outlines: &mut [Outline]) {
    let ahead = |o: &Outline| turn(&halfway(&o.faces[1]), &halfway(&o.faces[0])) > 0.0;
    let first = ahead(&outlines[0]);
    outlines.iter_mut().filter(|o| ahead(o) != first).for_each(exchange);
}

fn exchange(outline: &mut Outline) {
    outline.faces.swap(0, 1);
    outline.edges.iter_mut().for_each(|edge| edge.reverse());
}

/// The point in the middle of the length of a face.
fn halfway(points: &[Point3<f64>]) -> Point3<f64> {
    let lengths: Vec<f64> = points
        .windows(2)
        .scan(0.0, |sum, pair| {
            *sum += (pair[1] - pair[0]).norm();
            Some(*sum)
        })
        .collect();
    let whole = lengths.last().copied().unwrap_or(0.0);
    let i = lengths.partition_point(|l| *l < 0.5 * whole).min(points.len() - 2);
    let before = if i == 0 { 0.0 } else { lengths[i - 1] };
    points[i] + (points[i + 1] - points[i]) * ((0.5 * whole - before) / (lengths[i] - before))
}

/// Angle about Z from one point to another, in (-pi, pi].
fn turn(from: &Point3<f64>, to: &Point3<f64>) -> f64 {
    libm::atan2(from.x * to.y - from.y * to.x, from.x * to.x + from.y * to.y)
}

/// Where the pressure face looks: as stated, or away from the sense in which the blade falls back from inlet to outlet, as in
/// compressors and pumps.
fn pressure_looks(given: &SectionBlade<'_>, name: &str, outlines: &[Outline], sink: &mut Sink) -> Option<Looks> {
    if let Some(stated) = given.sections.pressure {
        return Some(stated);
    }
    let falls = outlines.iter().map(|o| {
        let face = &o.faces[0];
        face.windows(2).map(|pair| turn(&pair[0], &pair[1])).sum::<f64>()
    });
    let mean = falls.sum::<f64>() / outlines.len() as f64;
    if mean.abs() < TOLD {
        sink.push(
            Diag::error(codes::PRESSURE_SIDE, format!("the pressure face of {name} cannot be told"))
                .label(given.sections.span, format!("the blade turns by only {:.2} deg about Z", mean.to_degrees()))
                .help("state it: `pressure counter-clockwise` when the pressure face looks counter-clockwise, seen from +Z; or `pressure clockwise`"),
        );
        return None;
    }
    Some(if mean < 0.0 { Looks::CounterClockwise } else { Looks::Clockwise })
}

fn not_divided(name: &str, section: &LoopSpec, fault: &DivideFault, spec: &SectionsSpec) -> Diag {
    let message = format!("section {} of {name} has no faces and edges", section.name);
    let at = |i: usize| section.spans.get(i).copied().unwrap_or(section.span);
    let diag = Diag::error(codes::SECTION, message);
    match fault {
        DivideFault::TooFew(n) => diag
            .label(section.span, format!("it has {n} points"))
            .help("give at least 12 points round the blade; 100 and more describe its edges well"),
        DivideFault::Repeated(i) => diag.label(at(*i), "this point stands twice").help("remove one of the two points"),
        DivideFault::NoEdges => diag
            .label(section.span, "no two parts of it turn by 130 deg")
            .help("give the points in order once round the blade, with leading and trailing edge"),
        DivideFault::Sharp(i) => diag
            .label(at(*i), "both faces end in this point")
            .help("give the edge a thickness: no tool leaves an edge without thickness"),
        DivideFault::NoCorners(edge) => diag
            .label(section.span, format!("its {} has no two corners", EDGES[*edge]))
            .help(format!("write `{} round`, or remove the property", EDGES[*edge].replace(' ', "-")))
            .label(spec.span, "the form of the edge is stated with these sections"),
    }
}

fn not_lofted(name: &str, given: &SectionBlade<'_>, fault: &LoftFault) -> Diag {
    let loops = &given.sections.loops;
    let section = |k: usize| loops.get(k).map_or("", |section| section.name.as_str());
    let span = |k: usize| loops.get(k).map_or(given.sections.span, |section| section.span);
    match fault {
        LoftFault::EdgesDiffer { edge, section: k } => Diag::error(
            codes::SECTION,
            format!("the {} of {name} is round in some sections and cut off in others", EDGES[*edge]),
        )
        .label(span(*k), format!("section {} is the first that differs from section {}", section(*k), section(0)))
        .help(format!("state the form: `{0} round` or `{0} cut-off`", EDGES[*edge].replace(' ', "-"))),
        LoftFault::Points { section: k } => {
            Diag::error(codes::SECTION, format!("section {} of {name} gives no curve", section(*k)))
                .label(span(*k), "these points")
                .help("check the points for repetitions and for parts that run back")
        }
        LoftFault::Surface(fault) => Diag::error(codes::POINTS, format!("{name} has no surface through its sections"))
            .label(given.sections.span, "these sections")
            .note(no_surface(fault, "sections"))
            .help("give the sections in order from hub to shroud, each at another height"),
    }
}

/// Reports what was found; `false` when the curves do not keep `fit`.
fn told(given: &SectionBlade<'_>, name: &str, made: &LoftedBlade, looks: Looks, sink: &mut Sink) -> bool {
    let residual = made.residual;
    let of = |k: usize| given.sections.loops.get(k).map_or("", |section| section.name.as_str());
    let place = format!("{name}, section {}", of(residual.section));
    let span = given.sections.span;
    if residual.distance > given.sections.fit.get() {
        // The next tenth of a micrometre above.
        let enough = (residual.distance * 1e4).ceil() / 1e4;
        sink.push(
            Diag::error(
                codes::SECTION_FIT,
                format!("the curves of {name} miss their points by up to {}", length(residual.distance)),
            )
            .label(span, format!("at most {} are asked for", length(given.sections.fit.get())))
            .place(place, residual.at)
            .help(format!("allow more with `fit {}`, or give more points where the section bends", length(enough)))
            .note("points that are noisy or in wrong order are missed most; look at this place first"),
        );
        return false;
    }
    let counts = made.faces[0].to_surface().counts();
    let forms = made.edges.each_ref().map(|edge| if edge.is_some() { "round" } else { "cut off" });
    sink.push(
        Diag::remark(
            codes::SECTIONS_FOUND,
            format!(
                "{name}: {} sections within {} of their points",
                given.sections.loops.len(),
                length(residual.distance)
            ),
        )
        .label(span, format!("leading edge {}, trailing edge {}", forms[0], forms[1]))
        .place(place, residual.at)
        .note(format!(
            "the pressure face looks {}; a face has {} by {} control points",
            looks.name(),
            counts[0],
            counts[1]
        ))
        .help("state `leading-edge`, `trailing-edge` or `pressure` where this is not what you mean"),
    );
    true
}
