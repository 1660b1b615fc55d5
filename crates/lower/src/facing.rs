//! Hub and shroud as a whole: curves that are exchanged, a part that is upside down, a part of another size than its tools.

use base::units::trim;
use diagnostics::codes::{geometry, job as codes};
use diagnostics::{Aborted, Diag, Sink};
use job::model::{PartSpec, ToolSpec};
use nalgebra::{Point3, Vector2};
use nurbs::NurbsCurve;
use nurbs::revolution::Revolution;

/// Stations along a meridian.
const MERIDIAN_STATIONS: usize = 64;

/// Component of the normal of the hub, as a mean along the meridian, from which on it clearly faces to a side: a tenth of what a
/// hub has that faces there everywhere.
const CLEARLY: f64 = 0.1;

/// Diameter of the part over that of the largest tool, beyond which one of both has hardly the right unit. Wheels of 20 to
/// 520 mm have from 5 to 60; an inch that stands where a millimetre is meant makes 25.4 times as much. Of a part that is too small
/// the throat says enough.
const RATIO: f64 = 200.0;

/// Mean of the unit normal (r, z) out of the material along a meridian.
fn mean_normal(hub: &Revolution) -> Vector2<f64> {
    let at = |i: usize| i as f64 / MERIDIAN_STATIONS as f64;
    let (mut sum, mut length) = (Vector2::zeros(), 0.0);
    for i in 0..MERIDIAN_STATIONS {
        let way = (hub.meridian(at(i + 1)).point - hub.meridian(at(i)).point).norm();
        sum += hub.meridian_normal(0.5 * (at(i) + at(i + 1))) * way;
        length += way;
    }
    sum / length
}

/// Checks that hub and shroud run the same way: otherwise the blades between them cross over.
pub(super) fn same_way(spec: &PartSpec, [hub, shroud]: [&NurbsCurve; 2], sink: &mut Sink) -> Result<(), Aborted> {
    let end = |curve: &NurbsCurve, at: f64| {
        let p = curve.point(at);
        Point3::new(libm::hypot(p.x, p.y), 0.0, p.z)
    };
    let gap = |of_shroud: [f64; 2]| {
        (end(hub, 0.0) - end(shroud, of_shroud[0])).norm() + (end(hub, 1.0) - end(shroud, of_shroud[1])).norm()
    };
    if gap([0.0, 1.0]) <= gap([1.0, 0.0]) {
        return Ok(());
    }
    // The inlet of most wheels is nearer to the axis: there begins the curve that is right.
    let (wrong, name) =
        if end(hub, 0.0).x > end(hub, 1.0).x { (spec.hub.span(), "hub") } else { (spec.shroud.span(), "shroud") };
    let (other, other_name) = if name == "hub" { (spec.shroud.span(), "shroud") } else { (spec.hub.span(), "hub") };
    sink.push(
        Diag::error(geometry::DIRECTION, "hub and shroud run in opposite directions")
            .label(wrong, format!("the {name}"))
            .label(other, format!("the {other_name}"))
            .help(format!(
                "give the points of both from inlet to outlet; here those of the {name} are the other way round"
            )),
    );
    Err(Aborted)
}

/// Checks that the shroud lies outside of the hub: otherwise they are exchanged.
pub(super) fn exchanged(spec: &PartSpec, [hub, shroud]: [&Revolution; 2], sink: &mut Sink) -> Result<(), Aborted> {
    let stations = (0..=MERIDIAN_STATIONS).map(|i| shroud.meridian(i as f64 / MERIDIAN_STATIONS as f64).point);
    let inside = stations.filter(|p| hub.distance(&Point3::new(p.x, 0.0, p.y)) < 0.0).count();
    if 2 * inside <= MERIDIAN_STATIONS {
        return Ok(());
    }
    sink.push(
        Diag::error(geometry::ROOT_AND_TIP, "the hub lies outside of the shroud")
            .label(spec.hub.span(), "the hub is the surface next to the axis")
            .label(spec.shroud.span(), "the shroud is the surface at the tips")
            .help("exchange the curves of hub and shroud"),
    );
    Err(Aborted)
}

/// Warns of a hub that faces down, away from the spindle.
pub(super) fn upside_down(spec: &PartSpec, hub: &Revolution, sink: &mut Sink) {
    let normal = mean_normal(hub);
    // The hub of an axial wheel may narrow downwards: its tools come from the side.
    if normal.y < -CLEARLY && normal.y.abs() > normal.x.abs() {
        sink.push(
            Diag::warning(codes::DOUBTFUL, "the hub faces down: the part is upside down for tools that come from +Z")
                .label(spec.hub.span(), "its material lies above it")
                .help("turn the part about X: negate Y and Z of all points, which keeps the hand of the blades"),
        );
    }
}

/// What is doubtful about the size of a part, against its largest tool; for people.
pub(super) fn size(curves: [&NurbsCurve; 2], tools: &[ToolSpec]) -> Option<String> {
    let radius = |p: &Point3<f64>| libm::hypot(p.x, p.y);
    let points = curves
        .into_iter()
        .flat_map(|curve| (0..=MERIDIAN_STATIONS).map(|i| curve.point(i as f64 / MERIDIAN_STATIONS as f64)));
    let part = 2.0 * points.map(|p| radius(&p)).fold(0.0, f64::max);
    let largest = tools.iter().max_by(|a, b| a.diameter.get().total_cmp(&b.diameter.get()))?;
    let ratio = part / largest.diameter.get();
    (ratio > RATIO).then(|| {
        format!(
            "the part is {} mm in diameter, {} times as wide as the largest tool, {} with {}: compare the units of curves and \
             tools",
            trim(part, 1),
            trim(ratio, 1),
            largest.name,
            largest.diameter
        )
    })
}

/// Warns of a doubtful size.
pub(super) fn warn_of_size(spec: &PartSpec, doubt: String, sink: &mut Sink) {
    sink.push(
        Diag::warning(codes::DOUBTFUL, doubt)
            .label(spec.hub.span(), "the unit of each curve stands behind it: `mm` or `in`")
            .help("correct the unit, or the size of the tool"),
    );
}
