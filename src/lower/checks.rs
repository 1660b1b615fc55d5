//! Faults of the geometry that planning could not survive, each under the text that causes it.

use crate::diag::codes::geometry as codes;
use crate::diag::{Aborted, Diag, Sink};
use crate::job::model::{CurveSpec, FaceSpec, Job, PartSpec};
use crate::part::{BladeId, FaceId, Guides, Part, Surface};
use crate::units::length;
use nalgebra::{Point3, Vector2};

/// Stations along a curve that the checks look at.
const STATIONS: usize = 64;

/// Stations along a ruling.
const HEIGHTS: usize = 8;

/// Nearest that a curve may come to the axis of rotation, mm; on the axis itself a hub has no azimuth.
const MIN_RADIUS: f64 = 0.1;

/// Least height of a vane, mm.
const MIN_HEIGHT: f64 = 0.1;

/// Distance of a face's end from hub or shroud that is worth a remark, mm: the tolerance class of milled hubs.
const OFF_HUB: f64 = 0.005;

fn u(i: usize) -> f64 {
    i as f64 / STATIONS as f64
}

fn meridian(p: &Point3<f64>) -> Vector2<f64> {
    Vector2::new(libm::hypot(p.x, p.y), p.z)
}

fn names(side: FaceId, tip: bool) -> String {
    format!("{} {}", side.name(), if tip { "tip" } else { "root" })
}

/// The four curves with their faces.
fn curves<'a>(spec: &'a PartSpec, faces: [&'a Guides; 2]) -> [(String, &'a CurveSpec, &'a crate::geom::NurbsCurve); 4] {
    let [p, s] = faces;
    [
        (names(FaceId::PRESSURE, true), &spec.pressure.tip, &p.tip),
        (names(FaceId::PRESSURE, false), &spec.pressure.root, &p.root),
        (names(FaceId::SUCTION, true), &spec.suction.tip, &s.tip),
        (names(FaceId::SUCTION, false), &spec.suction.root, &s.root),
    ]
}

fn done(sink: &Sink, before: usize) -> Result<(), Aborted> {
    if sink.count() > before { Err(Aborted) } else { Ok(()) }
}

/// The hub comes from a root curve, the shroud from a tip curve.
pub(super) fn ends(spec: &PartSpec, sink: &mut Sink) -> Result<(), Aborted> {
    let before = sink.count();
    for (what, reference, due, wrong) in
        [("hub", &spec.hub, "root", spec.hub.tip), ("shroud", &spec.shroud, "tip", !spec.shroud.tip)]
    {
        if wrong {
            sink.push(
                Diag::error(codes::ROOT_AND_TIP, format!("the {what} is revolved from a {due} curve"))
                    .label(reference.span, format!("a {due} curve is due"))
                    .help("the hub carries the roots of the vanes, the shroud covers their tips"),
            );
        }
    }
    done(sink, before)
}

/// Every curve keeps away from the axis of rotation.
pub(super) fn meridians(spec: &PartSpec, faces: [&Guides; 2], sink: &mut Sink) -> Result<(), Aborted> {
    let before = sink.count();
    for (name, text, curve) in curves(spec, faces) {
        let nearest = (0..=STATIONS).map(|i| curve.point(u(i))).min_by(|a, b| meridian(a).x.total_cmp(&meridian(b).x));
        if let Some(p) = nearest.filter(|p| meridian(p).x < MIN_RADIUS) {
            sink.push(
                Diag::error(
                    codes::AXIS,
                    format!("the {name} curve comes within {} of the axis", length(meridian(&p).x)),
                )
                .label(text.span, "this curve")
                .place(format!("{name} curve"), p)
                .help("Z is the axis of rotation; check the coordinates, and that the axis is Z"),
            );
        }
    }
    done(sink, before)
}

/// All four curves run the same way, from the inlet, which is nearer to the axis, to the outlet.
pub(super) fn directions(spec: &PartSpec, faces: [&Guides; 2], sink: &mut Sink) -> Result<(), Aborted> {
    let before = sink.count();
    for (name, text, curve) in curves(spec, faces) {
        let (first, last) = (curve.point(0.0), curve.point(1.0));
        if meridian(&last).x <= meridian(&first).x {
            sink.push(
                Diag::error(codes::DIRECTION, format!("the {name} curve does not run outward"))
                    .label(text.span, format!("radius {:.3} to {:.3} mm", meridian(&first).x, meridian(&last).x))
                    .place("its first point", first)
                    .help("give the points from inlet to outlet, the outlet being farther from the axis"),
            );
        }
    }
    done(sink, before)
}

/// The tips lie outside of the hub, on the side away from the axis.
pub(super) fn heights(spec: &PartSpec, part: &Part, sink: &mut Sink) -> Result<(), Aborted> {
    let before = sink.count();
    for side in BladeId::MAIN.faces() {
        let surface = &part.face(side).surface;
        let text = face_spec(spec, side);
        let (root, tip) = (surface.root().point(0.0), surface.tip().point(0.0));
        let swapped = meridian(&tip).x <= meridian(&root).x;
        let low = (0..=STATIONS)
            .map(|i| surface.tip().point(u(i)))
            .map(|p| (p, part.hub.distance(&p)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .filter(|(_, height)| *height < MIN_HEIGHT);
        if !swapped && low.is_none() {
            continue;
        }
        let place = low.map_or(tip, |l| l.0);
        let message = if swapped {
            format!("the {} tip curve begins nearer to the axis than the root curve", side.name())
        } else {
            format!("the {} tip curve does not stay above the hub", side.name())
        };
        sink.push(
            Diag::error(codes::ROOT_AND_TIP, message)
                .label(text.tip.span, "tip: the curve at the shroud")
                .label(text.root.span, "root: the curve at the hub")
                .place(format!("{} tip curve", side.name()), place)
                .help("`root` lies on the hub, `tip` at the shroud; swap them if they changed places"),
        );
    }
    done(sink, before)
}

fn face_spec(spec: &PartSpec, side: FaceId) -> &FaceSpec {
    [&spec.pressure, &spec.suction][side.index()]
}

/// Azimuth by which the suction face is ahead of the pressure face at equal parameters, in (-pi, pi].
fn gap(part: &Part, u: f64, v: f64) -> f64 {
    let p = part.main().faces[0].surface.point(u, v);
    let s = part.main().faces[1].surface.point(u, v);
    libm::atan2(p.x * s.y - p.y * s.x, p.x * s.x + p.y * s.y)
}

/// The faces of the vane do not cross, and no face folds over.
pub(super) fn faces(spec: &PartSpec, part: &Part, sink: &mut Sink) -> Result<(), Aborted> {
    let before = sink.count();
    let sign = gap(part, 0.5, 0.5).signum();
    let crossing = grid().find(|(u, v)| gap(part, *u, *v) * sign <= 0.0);
    if let Some((u, v)) = crossing {
        sink.push(
            Diag::error(codes::FACES_CROSS, "pressure and suction face cross each other")
                .label(spec.suction.root.span, "suction side")
                .label(spec.pressure.root.span, "pressure side")
                .place(format!("pressure face, u = {u:.2}, v = {v:.2}"), part.main().faces[0].surface.point(u, v))
                .help("every point of the suction side lies on the same side of the pressure side; check the points"),
        );
    }
    for side in BladeId::MAIN.faces() {
        let surface = &part.face(side).surface;
        if let Some((u, v)) = fold(surface) {
            let text = face_spec(spec, side);
            sink.push(
                Diag::error(codes::RULINGS_FOLD, format!("the rulings of the {} face fold over", side.name()))
                    .label(text.root.span, "root")
                    .label(text.tip.span, "tip")
                    .place(format!("{} face, u = {u:.2}, v = {v:.2}", side.name()), surface.point(u, v))
                    .help("root and tip points of the same number belong together; spread both alike along the vane"),
            );
        }
    }
    done(sink, before)
}

fn grid() -> impl Iterator<Item = (f64, f64)> {
    (0..=STATIONS).flat_map(|i| (0..=HEIGHTS).map(move |j| (u(i), j as f64 / HEIGHTS as f64)))
}

/// A place where the normal vanishes or turns by more than a right angle against that of the middle of its ruling.
fn fold(surface: &impl Surface) -> Option<(f64, f64)> {
    let normal = |u: f64, v: f64| {
        let (_, su, sv) = surface.tangents(u, v);
        su.cross(&sv)
    };
    grid().find(|(u, v)| {
        let (here, middle) = (normal(*u, *v), normal(*u, 0.5));
        here.dot(&middle) <= 1e-9 * middle.norm_squared()
    })
}

/// Neighbouring vanes leave a channel between them.
pub(super) fn overlap(spec: &PartSpec, part: &Part, sink: &mut Sink) -> Result<(), Aborted> {
    let before = sink.count();
    let thickest = grid().map(|(u, v)| (gap(part, u, v).abs(), u, v)).max_by(|a, b| a.0.total_cmp(&b.0));
    if let Some((thickness, u, v)) = thickest.filter(|t| t.0 >= part.pitch()) {
        let most = (2..=spec.vanes.0).rev().find(|n| std::f64::consts::TAU / f64::from(*n) > thickness);
        let help = match most {
            Some(most) => format!("at most {most} vanes of this thickness have room"),
            None => "make the vane thinner".to_owned(),
        };
        sink.push(
            Diag::error(codes::VANES_OVERLAP, format!("{} vanes overlap their neighbours", spec.vanes.0))
                .label(
                    spec.vanes.1,
                    format!(
                        "a pitch of {:.3} deg; the vane is {:.3} deg thick",
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

/// Says how far faces end from hub and shroud; they are extended or trimmed along their rulings.
pub(super) fn off_hub(spec: &PartSpec, part: &Part, sink: &mut Sink) {
    for (what, surface, tip) in [("hub", &part.hub, false), ("shroud", &part.shroud, true)] {
        for side in BladeId::MAIN.faces() {
            let guides = &part.face(side).surface;
            let curve = if tip { guides.tip() } else { guides.root() };
            let farthest = (0..=STATIONS)
                .map(|i| curve.point(u(i)))
                .map(|p| (surface.distance(&p), p))
                .max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
            let Some((distance, p)) = farthest.filter(|f| f.0.abs() > OFF_HUB) else { continue };
            let text = face_spec(spec, side);
            let name = names(side, tip);
            sink.push(
                Diag::remark(
                    codes::OFF_HUB,
                    format!("the {name} curve lies up to {:.0} um off the {what}", distance.abs() * 1000.0),
                )
                .label(if tip { text.tip.span } else { text.root.span }, "this curve")
                .place(format!("{name} curve"), p)
                .help(format!("the face is extended or trimmed along its rulings to end on the {what}")),
            );
        }
    }
}

/// The blank holds the part.
pub(super) fn stock(job: &Job, part: &Part, sink: &mut Sink) {
    let lowest = (0..=STATIONS).map(|i| part.hub.meridian(u(i)).point.y).fold(f64::INFINITY, f64::min);
    if job.stock.back.get() >= lowest {
        sink.push(
            Diag::error(codes::STOCK, "the stock ends inside the part")
                .label(job.stock.span, format!("its back is at {}", job.stock.back))
                .label(job.part.hub.span, format!("the hub goes down to {lowest:.3} mm"))
                .help("put the back of the stock below the hub"),
        );
    }
    if let Some(span) = job.stock.clamping.span.filter(|_| job.stock.clamping.below.get() > job.stock.back.get()) {
        sink.push(
            Diag::error(codes::STOCK, "the clamping reaches into the stock")
                .label(span, format!("it goes up to {}", job.stock.clamping.below))
                .label(job.stock.span, format!("the back of the stock is at {}", job.stock.back))
                .help("`below` at the back of the stock or lower; without it the clamping begins at the back"),
        );
    }
    let narrowest = (0..=STATIONS).map(|i| part.hub.meridian(u(i)).point.x).fold(f64::INFINITY, f64::min);
    if job.stock.bore.get() / 2.0 >= narrowest {
        sink.push(
            Diag::error(codes::STOCK, "the bore of the stock cuts into the hub")
                .label(job.stock.span, format!("its radius is {} mm", job.stock.bore.get() / 2.0))
                .label(job.part.hub.span, format!("the hub begins at a radius of {narrowest:.3} mm"))
                .help("make the bore smaller than the hub"),
        );
    }
}
