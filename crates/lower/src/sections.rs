//! A blade from closed sections: division into faces and edges, curves, surfaces.

use super::face_curves::no_surface;
use super::limits::{MAX_COORDINATE, MIN_RADIUS, SAME_POINT};
use super::names::blade_name;
use super::pressure::{self, facing};
use ::job::model::{BladeSpec, Facing, LoopSpec, PartSpec, SectionsSpec};
use base::units::length;
use blade::foot::{FilletedFoot, filleted_foot};
use blade::loft::{LoftFault, LoftedBlade, loft};
use blade::outline::{DividedSection, Inlet, Known, Side, outline};
use blade::{EdgeForm, Outline, Section, SectionForm};
use diagnostics::codes::{geometry as codes, job};
use diagnostics::{Diag, Sink};
use nalgebra::Point3;
use nurbs::NurbsCurve;
use wheel::part::{Blade, FaceSurface};

/// A blade of sections in its part.
pub(super) struct SectionBlade<'a> {
    pub(super) part: &'a PartSpec,
    pub(super) blade: &'a BladeSpec,
    pub(super) sections: &'a SectionsSpec,
    /// Generating curve of the hub, from inlet to outlet.
    pub(super) hub: &'a NurbsCurve,
    /// Side of the pressure face of the main blade: its splitters have the same, since all turn together.
    pub(super) side: Option<Side>,
}

const EDGE_NAMES: [&str; 2] = ["leading edge", "trailing edge"];

/// The blade through its sections, and the side of its pressure face; faults and what was found go to the sink.
pub(super) fn fitted(given: &SectionBlade<'_>, sink: &mut Sink) -> Option<(Blade, Side)> {
    let name = blade_name(given.part, &given.blade.name);
    let faulty = given.sections.loops.iter().filter(|section| !points_are_good(section, sink)).count();
    if faulty > 0 {
        return None;
    }
    let divided = divided(given, &name, sink)?;
    let side = pressure_side(given, &name, &divided, sink)?;
    let doubled = filleted_foot(&divided).map(|foot| fillet_in_sections(given, &name, &foot));
    let mut outlines: Vec<Outline> = divided.into_iter().map(|section| section.outline).collect();
    if side == Side::Smaller {
        outlines.iter_mut().for_each(exchange);
    }
    if let Some(doubled) = doubled.filter(|_| given.blade.fillet.is_some()) {
        sink.push(doubled);
    }
    let made = match loft(&outlines, given.sections.fit.get()) {
        Ok(made) => made,
        Err(fault) => {
            sink.push(not_lofted(&name, given, &fault));
            return None;
        }
    };
    report(given, &name, &made, facing(side), sink).then(|| {
        let LoftedBlade { faces: [pressure, suction], edges, .. } = made;
        let fillet = given.blade.fillet.clone();
        let blade = Blade::new(&given.blade.name, [pressure.into(), suction.into()], fillet);
        (blade.with_edges(edges.map(|edge| edge.map(FaceSurface::from))), side)
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

/// The sections with their faces and edges, as if each pressure face were at the greater azimuth.
fn divided(given: &SectionBlade<'_>, name: &str, sink: &mut Sink) -> Option<Vec<DividedSection>> {
    /// Points of the hub that tell the leading edge.
    const HUB_POINTS: u32 = 200;
    let hub: Vec<[f64; 2]> = (0..=HUB_POINTS)
        .map(|i| given.hub.point(f64::from(i) / f64::from(HUB_POINTS)))
        .map(|p| [libm::hypot(p.x, p.y), p.z])
        .collect();
    let known = Known { inlet: Inlet::Meridian(&hub), pressure: Side::Greater };
    let sections = given.sections.loops.iter().map(|section| {
        let points = section.points.iter().map(|p| Point3::from(*p)).collect();
        let form = match section.edges {
            Some(edges) => SectionForm::DividedLoop { points, edges },
            None => SectionForm::Loop(points),
        };
        let found = outline(&Section { span: None, form }, &known);
        found
            .map_err(|fault| fault.to_string())
            .and_then(|found| with_forms(found, given.sections))
            .map_err(|fault| (section, fault))
    });
    let (good, faults): (Vec<_>, Vec<_>) = sections.partition(Result::is_ok);
    let mut faults = faults.into_iter().filter_map(Result::err);
    let Some((section, fault)) = faults.next() else { return Some(good.into_iter().flatten().collect()) };
    // The others mostly have the same cause.
    let more = faults.count();
    let diag = Diag::error(codes::SECTION, format!("section {} of {name} has no faces and edges", section.name))
        .label(section.span, fault)
        .help("give the points in order once round the blade, with both edges; state `leading-edge` or `trailing-edge` as round or cut-off where the wrong form is found");
    sink.push(if more > 0 { diag.note(format!("{more} more sections have a fault of this kind")) } else { diag });
    None
}

/// The section with edges of the stated forms. An edge that is cut off is straight between its corners.
fn with_forms(mut found: DividedSection, spec: &SectionsSpec) -> Result<DividedSection, String> {
    for (edge, name) in EDGE_NAMES.iter().enumerate() {
        let points = &mut found.outline.edges[edge];
        match (found.edges[edge].form, spec.edges[edge]) {
            (EdgeForm::Sharp, _) => {
                return Err(format!("both faces meet in one point at its {name}: an edge needs a thickness"));
            }
            (EdgeForm::Round, Some(EdgeForm::CutOff)) => return Err(format!("its {name} has no two corners")),
            (EdgeForm::CutOff, Some(EdgeForm::Round)) if points.len() < 3 => {
                return Err(format!("its {name} has no point between its corners"));
            }
            (EdgeForm::CutOff, Some(EdgeForm::Round)) | (EdgeForm::Round, _) => {}
            (EdgeForm::CutOff, _) => *points = points.first().into_iter().chain(points.last()).copied().collect(),
        }
    }
    Ok(found)
}

fn exchange(outline: &mut Outline) {
    outline.faces.swap(0, 1);
    outline.edges.iter_mut().for_each(|edge| edge.reverse());
}

/// Side of the pressure face: as stated, that of the main blade, or that of a blade that takes up work.
fn pressure_side(given: &SectionBlade<'_>, name: &str, sections: &[DividedSection], sink: &mut Sink) -> Option<Side> {
    let mean = |value: fn(&DividedSection) -> f64| sections.iter().map(value).sum::<f64>() / sections.len() as f64;
    let turns = [mean(|s| s.wrap), mean(|s| s.turn)];
    pressure::side(given.sections.pressure, given.side, turns, name, given.sections.span, sink)
}

fn not_lofted(name: &str, given: &SectionBlade<'_>, fault: &LoftFault) -> Diag {
    let loops = &given.sections.loops;
    let section = |k: usize| loops.get(k).map_or("", |section| section.name.as_str());
    let span = |k: usize| loops.get(k).map_or(given.sections.span, |section| section.span);
    match fault {
        LoftFault::EdgesDiffer { edge, section: k } => Diag::error(
            codes::SECTION,
            format!("the {} of {name} is round in some sections and cut off in others", EDGE_NAMES[*edge]),
        )
        .label(span(*k), format!("section {} is the first that differs from section {}", section(*k), section(0)))
        .help(format!("state the form: `{0} round` or `{0} cut-off`", EDGE_NAMES[*edge].replace(' ', "-"))),
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

/// Sections that seem to hold the fillet which the job states as well.
fn fillet_in_sections(given: &SectionBlade<'_>, name: &str, foot: &FilletedFoot) -> Diag {
    let [lowest, above] = foot.thickness.map(length);
    let section = |k: usize| given.sections.loops.get(k).map_or("", |section| section.name.as_str());
    Diag::warning(
        job::DOUBTFUL,
        format!("the sections of {name} seem to hold its fillet, and the job states one as well"),
    )
    .label(given.sections.span, format!("{lowest} thick in section {}, {above} in section {}", section(0), section(foot.above)))
    .note(format!("the two sections are {} apart; above them the blade widens far less", length(foot.height)))
    .help(format!(
        "leave the {} lowest sections out and keep `fillet`; or keep them and take `fillet` out: then the foot is cut as they say",
        foot.above
    ))
}

/// Reports what was found; `false` when the curves do not keep `fit`.
fn report(given: &SectionBlade<'_>, name: &str, made: &LoftedBlade, facing: Facing, sink: &mut Sink) -> bool {
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
            facing.name(),
            counts[0],
            counts[1]
        ))
        .help("state `leading-edge`, `trailing-edge` or `pressure` where this is not what you mean"),
    );
    true
}
