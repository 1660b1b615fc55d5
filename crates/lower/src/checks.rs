//! Faults of the geometry that make planning impossible, each reported at the text that causes it.

use super::face_curves::FaceCurves;
use super::limits::MIN_RADIUS;
use super::names::face_name;
use base::source::Span;
use base::units::length;
use diagnostics::codes::geometry as codes;
use diagnostics::{Aborted, Diag, Sink};
use ir::Program;
use job::model::{BladeForm, Job, PartSpec, RevolvedSpec};
use nalgebra::{Point3, Rotation3, Vector2, Vector3};
use nurbs::NurbsCurve;
use nurbs::proximity::Patch;
use std::collections::BTreeSet;
use wheel::part::{Blade, BladeId, FaceId, Part, RulingEnd, Surface};

/// Cosine of normals along a ruling at which the face has turned by a right angle.
const TURNED: f64 = 1e-9;

/// Samples of the checks along a curve.
const CURVE_STATIONS: usize = 64;

/// Number of intervals along a ruling.
const HEIGHTS: usize = 8;

/// Least height of a vane, mm.
const MIN_HEIGHT: f64 = 0.1;

/// Distance of a face's end from hub or shroud from which on it is reported, mm: the tolerance class of milled hubs.
const OFF_HUB: f64 = 0.005;

fn u(i: usize) -> f64 {
    i as f64 / CURVE_STATIONS as f64
}

fn meridian(p: &Point3<f64>) -> Vector2<f64> {
    Vector2::new(libm::hypot(p.x, p.y), p.z)
}

fn name_of(spec: &PartSpec, part: &Part, face: FaceId) -> String {
    face_name(spec, &part.blade(face.blade).name, face.name())
}

fn done(sink: &Sink, before: usize) -> Result<(), Aborted> {
    if sink.count() > before { Err(Aborted) } else { Ok(()) }
}

/// Checks that the hub comes from a root curve and the shroud from a tip curve.
pub(super) fn ends(spec: &PartSpec, sink: &mut Sink) -> Result<(), Aborted> {
    let before = sink.count();
    for (what, reference, due, wrong) in
        [("hub", &spec.hub, "root", RulingEnd::Tip), ("shroud", &spec.shroud, "tip", RulingEnd::Root)]
    {
        if matches!(reference, RevolvedSpec::OfBlade(curve) if curve.end == wrong) {
            sink.push(
                Diag::error(codes::ROOT_AND_TIP, format!("the {what} is revolved from a {due} curve"))
                    .label(reference.span(), format!("a {due} curve is expected"))
                    .help("revolve the hub from a root curve and the shroud from a tip curve"),
            );
        }
    }
    done(sink, before)
}

/// Checks that every curve keeps away from the axis of rotation.
pub(super) fn meridians(faces: &[&FaceCurves<'_>], sink: &mut Sink) -> Result<(), Aborted> {
    let before = sink.count();
    for (name, text, curve) in faces.iter().flat_map(|face| face.curves()) {
        let nearest =
            (0..=CURVE_STATIONS).map(|i| curve.point(u(i))).min_by(|a, b| meridian(a).x.total_cmp(&meridian(b).x));
        if let Some(p) = nearest.filter(|p| meridian(p).x < MIN_RADIUS) {
            sink.push(
                Diag::error(
                    codes::AXIS,
                    format!("the {name} curve is only {} away from the axis", length(meridian(&p).x)),
                )
                .label(text.span, "this curve")
                .place(format!("{name} curve"), p)
                .help("check the coordinates, and that Z is the axis of rotation"),
            );
        }
    }
    done(sink, before)
}

/// Checks that all curves run from the inlet to the outlet; the inlet is nearer to the axis.
pub(super) fn directions(faces: &[&FaceCurves<'_>], sink: &mut Sink) -> Result<(), Aborted> {
    let before = sink.count();
    for (name, text, curve) in faces.iter().flat_map(|face| face.curves()) {
        let (first, last) = (curve.point(0.0), curve.point(1.0));
        if meridian(&last).x <= meridian(&first).x {
            sink.push(
                Diag::error(codes::DIRECTION, format!("the {name} curve does not run outward"))
                    .label(text.span, format!("radius {:.3} to {:.3} mm", meridian(&first).x, meridian(&last).x))
                    .place("its first point", first)
                    .help("give the points from inlet to outlet; the outlet is farther from the axis"),
            );
        }
    }
    done(sink, before)
}

/// Checks that the tips lie outside of the hub, on the side away from the axis.
pub(super) fn heights(spec: &PartSpec, part: &Part, sink: &mut Sink) -> Result<(), Aborted> {
    let before = sink.count();
    for side in part.faces() {
        let surface = &part.face(side).surface;
        let (text, name) = (face_text(spec, part, side), name_of(spec, part, side));
        let (root, tip) = (surface.root().point(0.0), surface.tip().point(0.0));
        let swapped = meridian(&tip).x <= meridian(&root).x;
        let low = (0..=CURVE_STATIONS)
            .map(|i| surface.tip().point(u(i)))
            .map(|p| (p, part.hub.distance(&p)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .filter(|(_, height)| *height < MIN_HEIGHT);
        if !swapped && low.is_none() {
            continue;
        }
        let place = low.map_or(tip, |l| l.0);
        let message = if swapped {
            format!("the {} tip curve begins nearer to the axis than the root curve", name)
        } else {
            format!("the {} tip curve goes below the hub", name)
        };
        sink.push(
            Diag::error(codes::ROOT_AND_TIP, message)
                .label(text.tip, "tip: the curve at the shroud")
                .label(text.root, "root: the curve at the hub")
                .place(format!("{} tip curve", name), place)
                .help("`root` is the curve on the hub, `tip` the curve at the shroud; exchange them if necessary"),
        );
    }
    done(sink, before)
}

/// Places of the curves of a face in the text.
struct FaceText {
    root: Span,
    tip: Span,
}

fn face_text(spec: &PartSpec, part: &Part, face: FaceId) -> FaceText {
    let name = &part.blade(face.blade).name;
    let blade = spec.blades.iter().find(|b| b.name == *name).unwrap_or(spec.main());
    match &blade.form {
        BladeForm::Angles(angles) => FaceText { root: angles.span, tip: angles.span },
        BladeForm::Faces(faces) => {
            let face = &faces[face.index() % faces.len()];
            FaceText { root: face.root.span, tip: face.tip.span }
        }
        BladeForm::Sections(sections) => {
            let [first, last] = [sections.loops.first(), sections.loops.last()];
            let of = |section: Option<&job::model::LoopSpec>| section.map_or(sections.span, |s| s.span);
            FaceText { root: of(first), tip: of(last) }
        }
    }
}

/// Checks hubs and shrouds of their own: they keep away from the axis.
pub(super) fn own_meridians(spec: &PartSpec, curves: [&NurbsCurve; 2], sink: &mut Sink) -> Result<(), Aborted> {
    let before = sink.count();
    for ((name, given), curve) in [("hub", &spec.hub), ("shroud", &spec.shroud)].into_iter().zip(curves) {
        let RevolvedSpec::Own(own) = given else { continue };
        let radius = |p: &Point3<f64>| meridian(p).x;
        let nearest = (0..=CURVE_STATIONS).map(|i| curve.point(u(i))).min_by(|a, b| radius(a).total_cmp(&radius(b)));
        if let Some(p) = nearest.filter(|p| radius(p) < MIN_RADIUS) {
            sink.push(
                Diag::error(codes::AXIS, format!("the {name} comes to {} from the axis", length(radius(&p))))
                    .label(own.span, "this curve")
                    .place(name, p)
                    .help("begin the curve at the bore or at the front of the wheel"),
            );
        }
    }
    done(sink, before)
}

/// Azimuth of the suction face less that of the pressure face at equal parameters, in (-pi, pi].
fn gap(blade: &Blade, u: f64, v: f64) -> f64 {
    let [p, s] = blade.faces.each_ref().map(|face| face.surface.point(u, v));
    libm::atan2(p.x * s.y - p.y * s.x, p.x * s.x + p.y * s.y)
}

/// Checks that the faces of a blade do not cross, and that no face folds over.
pub(super) fn faces(spec: &PartSpec, part: &Part, sink: &mut Sink) -> Result<(), Aborted> {
    let before = sink.count();
    for id in part.blade_ids() {
        let blade = part.blade(id);
        let rounded = blade.edges.iter().any(Option::is_some);
        let Some((u, v)) = (if rounded { crossing(part, id) } else { crossing_by_azimuth(blade) }) else { continue };
        let [pressure, suction] = id.faces().map(|face| (face_text(spec, part, face), name_of(spec, part, face)));
        sink.push(
            Diag::error(codes::FACES_CROSS, format!("{} and suction face cross each other", pressure.1))
                .label(suction.0.root, "suction side")
                .label(pressure.0.root, "pressure side")
                .place(format!("{} face, u = {u:.2}, v = {v:.2}", pressure.1), blade.faces[0].surface.point(u, v))
                .help("check the points: the suction face must lie on one side of the pressure face everywhere"),
        );
    }
    for side in part.faces() {
        let surface = &part.face(side).surface;
        if let Some((u, v)) = fold(surface) {
            let (text, name) = (face_text(spec, part, side), name_of(spec, part, side));
            sink.push(
                Diag::error(codes::RULINGS_FOLD, format!("the rulings of the {} face cross each other", name))
                    .label(text.root, "root")
                    .label(text.tip, "tip")
                    .place(format!("{} face, u = {u:.2}, v = {v:.2}", name), surface.point(u, v))
                    .help("give root and tip points in pairs of one ruling, spread in the same way along the vane"),
            );
        }
    }
    done(sink, before)
}

/// A place of the pressure face at which the suction face lies on the other side, for faces with equal parameters at both ends.
fn crossing_by_azimuth(blade: &Blade) -> Option<(f64, f64)> {
    let sign = gap(blade, 0.5, 0.5).signum();
    grid().find(|(u, v)| gap(blade, *u, *v) * sign <= 0.0)
}

/// A place of the suction face outside of the material behind the pressure face, by closest points: on a staggered blade the
/// azimuths at equal parameters say nothing.
fn crossing(part: &Part, id: BladeId) -> Option<(f64, f64)> {
    /// Intervals along and up the face.
    const PLACES: [usize; 2] = [16, 4];
    let [pressure, suction] = id.faces().map(|face| part.face(face));
    let share = |k: usize, n: usize| k as f64 / n as f64;
    let places = (0..=PLACES[0]).flat_map(|i| (0..=PLACES[1]).map(move |j| (share(i, PLACES[0]), share(j, PLACES[1]))));
    places.into_iter().find(|(u, v)| {
        let p = suction.surface.point(*u, *v);
        let foot = pressure.surface.closest(&p, Patch { u: [0.0, 1.0], v: [0.0, 1.0] });
        (p - foot.point).dot(&pressure.normal(foot.u, foot.v)) >= 0.0
    })
}

fn grid() -> impl Iterator<Item = (f64, f64)> {
    (0..=CURVE_STATIONS).flat_map(|i| (0..=HEIGHTS).map(move |j| (u(i), j as f64 / HEIGHTS as f64)))
}

/// A place where the normal vanishes, or differs by more than a right angle from the normal in the middle of its
/// ruling.
fn fold(surface: &impl Surface) -> Option<(f64, f64)> {
    let normal = |u: f64, v: f64| {
        let (_, su, sv) = surface.tangents(u, v);
        su.cross(&sv)
    };
    grid().find(|(u, v)| {
        let (here, middle) = (normal(*u, *v), normal(*u, 0.5));
        here.dot(&middle) <= TURNED * middle.norm_squared()
    })
}

/// Checks that neighbouring vanes leave a channel between them.
pub(super) fn overlap(spec: &PartSpec, part: &Part, sink: &mut Sink) -> Result<(), Aborted> {
    let before = sink.count();
    let thickest = grid().map(|(u, v)| (gap(part.main(), u, v).abs(), u, v)).max_by(|a, b| a.0.total_cmp(&b.0));
    if let Some((thickness, u, v)) = thickest.filter(|t| t.0 >= part.pitch()) {
        let most = (2..=spec.vanes.value).rev().find(|n| std::f64::consts::TAU / f64::from(*n) > thickness);
        let help = match most {
            Some(most) => format!("at most {most} vanes of this thickness fit"),
            None => "make the vane thinner".to_owned(),
        };
        sink.push(
            Diag::error(codes::VANES_OVERLAP, format!("{} vanes overlap their neighbours", spec.vanes.value))
                .label(
                    spec.vanes.span,
                    format!(
                        "the pitch is {:.3} deg; the vane is {:.3} deg thick",
                        part.pitch().to_degrees(),
                        thickness.to_degrees()
                    ),
                )
                .place(format!("pressure face, u = {u:.2}, v = {v:.2}"), part.main().faces[0].surface.point(u, v))
                .help(help),
        );
    }
    done(sink, before)
}

/// Checks that splitters stand between their main blade and the next one, and apart from each other.
pub(super) fn splitters_between(spec: &PartSpec, part: &Part, sink: &mut Sink) -> Result<(), Aborted> {
    /// Intervals along and up a face, at whose ends the face is compared with the opposite faces.
    const PLACES: [usize; 2] = [12, 2];
    let before = sink.count();
    let places = || {
        let share = |k: usize, n: usize| k as f64 / n as f64;
        (0..=PLACES[0]).flat_map(move |i| (0..=PLACES[1]).map(move |j| (share(i, PLACES[0]), share(j, PLACES[1]))))
    };
    let main = part.face_ahead(BladeId::MAIN);
    let above_and_below = Patch { u: [0.0, 1.0], v: [-0.2, 1.2] };
    let searches: Vec<_> = part.faces().map(|face| (face, part.face(face).surface.search(above_and_below))).collect();
    for id in part.blade_ids().skip(1) {
        // The faces opposite: the neighbour, and a main blade where the neighbour is shorter.
        let far = |face: FaceId| if part.looks_ahead(face) { (main.other(), part.pitch()) } else { (main, 0.0) };
        let meets = |face: FaceId, p: &Point3<f64>| {
            [part.opposite(face), far(face)].into_iter().find(|(wall, turn)| {
                let near = Rotation3::from_axis_angle(&Vector3::z_axis(), -turn) * p;
                let search = searches.iter().find(|(face, _)| face == wall);
                search.map(|(_, search)| search.closest(&near)).is_some_and(|foot| {
                    let within = foot.u > 0.0 && foot.u < 1.0;
                    within && (near - foot.point).dot(&part.face(*wall).normal(foot.u, foot.v)) <= 0.0
                })
            })
        };
        let found = id.faces().into_iter().find_map(|face| {
            places().find_map(|(u, v)| {
                let p = part.face(face).surface.point(u, v);
                meets(face, &p).map(|(wall, _)| (face, wall, (u, v), p))
            })
        });
        let Some((face, wall, (u, v), p)) = found else { continue };
        let blade = spec.blades.iter().find(|b| b.name == part.blade(id).name);
        let (name, wall) = (name_of(spec, part, face), name_of(spec, part, wall));
        sink.push(
            Diag::error(codes::VANES_OVERLAP, format!("the {name} face reaches into the {wall} face beside it"))
                .label(blade.map_or(spec.span, |b| b.span), "this splitter")
                .place(format!("{name} face, u = {u:.2}, v = {v:.2}"), p)
                .help(format!(
                    "a splitter must stand between a vane and the next vane, {:.3} deg ahead; check its `angle` and its curves",
                    part.pitch().to_degrees()
                )),
        );
    }
    done(sink, before)
}

/// Reports faces that end short of hub or shroud by more than the part allows, with what is doubtful about the size of the part.
pub(super) fn extensions(spec: &PartSpec, part: &Part, doubt: Option<&str>, sink: &mut Sink) -> Result<(), Aborted> {
    let before = sink.count();
    for (what, surface, tip) in [("hub", &part.hub, false), ("shroud", &part.shroud, true)] {
        let short = |side: FaceId| {
            let face = &part.face(side).surface;
            let curve = if tip { face.tip() } else { face.root() };
            // Above the hub, or below the shroud.
            let gap = |p: &Point3<f64>| surface.distance(p) * if tip { -1.0 } else { 1.0 };
            let points = (0..=CURVE_STATIONS).map(|i| curve.point(u(i)));
            points.map(|p| (gap(&p), side, p)).max_by(|a, b| a.0.total_cmp(&b.0))
        };
        let Some((gap, side, p)) = part.faces().filter_map(short).max_by(|a, b| a.0.total_cmp(&b.0)) else { continue };
        if gap <= spec.extend.get() {
            continue;
        }
        let text = face_text(spec, part, side);
        let end = if tip { "tip" } else { "root" };
        let name = format!("{} {end}", name_of(spec, part, side));
        let enough = (gap * 100.0).ceil() / 100.0;
        let mut diag = Diag::error(codes::EXTENSION, format!("the {name} ends {} short of the {what}", length(gap)))
            .label(
                if tip { text.tip } else { text.root },
                format!("at most {} are extended", length(spec.extend.get())),
            )
            .place(name, p)
            .note(if tip {
                "many files give the casing as the shroud: then the gap is the gap between tips and casing"
            } else {
                "the first section should lie on the hub or below it"
            })
            .help(format!(
                "extend the faces with `extend {enough:.2} mm`, or give the {what} through the {end}s of the blades"
            ));
        if let Some(doubt) = doubt {
            diag = diag.note(doubt);
        }
        sink.push(diag);
    }
    done(sink, before)
}

/// Reports the distances of the ends of the faces from hub and shroud; the faces are extended or trimmed along their
/// rulings.
pub(super) fn off_hub(spec: &PartSpec, part: &Part, sink: &mut Sink) {
    for (what, surface, tip) in [("hub", &part.hub, false), ("shroud", &part.shroud, true)] {
        for side in part.faces() {
            let guides = &part.face(side).surface;
            let curve = if tip { guides.tip() } else { guides.root() };
            let farthest = (0..=CURVE_STATIONS)
                .map(|i| curve.point(u(i)))
                .map(|p| (surface.distance(&p), p))
                .max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
            let Some((distance, p)) = farthest.filter(|f| f.0.abs() > OFF_HUB) else { continue };
            let text = face_text(spec, part, side);
            let name = format!("{} {}", name_of(spec, part, side), if tip { "tip" } else { "root" });
            sink.push(
                Diag::remark(
                    codes::OFF_HUB,
                    format!("the {name} curve is up to {:.0} um away from the {what}", distance.abs() * 1000.0),
                )
                .label(if tip { text.tip } else { text.root }, "this curve")
                .place(format!("{name} curve"), p)
                .help(format!("the compiler extends or trims the face along its rulings to end on the {what}")),
            );
        }
    }
}

/// Warns of blades whose tips keep stock: the blank stands over the shroud, and no operation finishes them.
pub(super) fn tips_left(job: &Job, program: &Program, sink: &mut Sink) {
    let over = job.stock.over_shroud;
    if over.get() <= 0.0 || job.stock.left.is_some() {
        return;
    }
    let finished: BTreeSet<BladeId> = program.operations.iter().flat_map(|(_, o)| o.kind.tips()).collect();
    for blade in program.part.blade_ids().filter(|blade| !finished.contains(blade)) {
        let name = &program.part.blade(blade).name;
        sink.push(
            Diag::warning(codes::TIPS_LEFT, format!("{over} of stock stay on the tips of `{name}`"))
                .label(job.stock.span, "the blank stands over the shroud, and no operation finishes these tips")
                .help("add an operation `tip`, or turn the blank to `over shroud 0 mm`"),
        );
    }
}

/// Checks that the blank contains the part.
pub(super) fn stock(job: &Job, part: &Part, sink: &mut Sink) {
    let lowest = (0..=CURVE_STATIONS).map(|i| part.hub.meridian(u(i)).point.y).fold(f64::INFINITY, f64::min);
    if job.stock.back.get() >= lowest {
        sink.push(
            Diag::error(codes::STOCK, "the stock ends inside the part")
                .label(job.stock.span, format!("its back is at {}", job.stock.back))
                .label(job.part.hub.span(), format!("the hub goes down to {lowest:.3} mm"))
                .help(format!(
                    "put the back of the stock below the hub: `back {:.2} mm` or lower",
                    (lowest * 100.0).ceil() / 100.0 - 0.01
                )),
        );
    }
    if let Some(span) = job.stock.clamping.span.filter(|_| job.stock.clamping.below.get() > job.stock.back.get()) {
        sink.push(
            Diag::error(codes::STOCK, "the clamping reaches into the stock")
                .label(span, format!("it goes up to {}", job.stock.clamping.below))
                .label(job.stock.span, format!("the back of the stock is at {}", job.stock.back))
                .help("put `below` at the back of the stock or lower; without `below` the clamping begins at the back"),
        );
    }
    let narrowest = (0..=CURVE_STATIONS).map(|i| part.hub.meridian(u(i)).point.x).fold(f64::INFINITY, f64::min);
    if job.stock.bore.get() / 2.0 >= narrowest {
        sink.push(
            Diag::error(codes::STOCK, "the bore of the stock cuts into the hub")
                .label(job.stock.span, format!("its diameter is {}", job.stock.bore))
                .label(job.part.hub.span(), format!("the hub begins with a diameter of {:.3} mm", 2.0 * narrowest))
                .help(format!("use a `bore` of less than {:.2} mm", 2.0 * narrowest)),
        );
    }
}
