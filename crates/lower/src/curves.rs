//! Curves through points; faults of the points are reported at their text.

use super::limits::{MAX_COORDINATE, SAME_POINT};
use diagnostics::codes::geometry as codes;
use diagnostics::{Diag, Sink};
use job::model::CurveSpec;
use nalgebra::{Point3, Vector2};
use nurbs::{GeomError, NurbsCurve, interpolate};

/// Number of chords that are searched for crossings.
const CROSSING_CHORDS: usize = 128;

/// The meridian through the points of the job, at azimuth 0. Only radius and height count: files have meridians whose azimuth
/// changes.
pub(super) fn meridian(spec: &CurveSpec, name: &str, sink: &mut Sink) -> Option<NurbsCurve> {
    let flat = |p: &[f64; 3]| [libm::hypot(p[0], p[1]), 0.0, p[2]];
    curve(&CurveSpec { points: spec.points.iter().map(flat).collect(), ..spec.clone() }, name, sink)
}

/// The curve through the points of the job; `name` is its name in messages.
pub(super) fn curve(spec: &CurveSpec, name: &str, sink: &mut Sink) -> Option<NurbsCurve> {
    let before = sink.count();
    for (point, span) in spec.points.iter().zip(&spec.spans) {
        if point.iter().any(|x| !x.is_finite() || x.abs() > MAX_COORDINATE) {
            sink.push(
                Diag::error(codes::COORDINATE, format!("a point of the {name} curve lies beyond 10 m"))
                    .label(*span, "the unit behind the list applies to all coordinates")
                    .help("correct the coordinate, or the unit of the list"),
            );
        }
    }
    if sink.count() > before {
        return None;
    }
    for (i, pair) in spec.points.windows(2).enumerate() {
        if (Point3::from(pair[0]) - Point3::from(pair[1])).norm() < SAME_POINT {
            let mut diag =
                Diag::error(codes::POINTS, format!("points {} and {} of the {name} curve coincide", i + 1, i + 2));
            for (at, text) in [(i + 1, "the same point again"), (i, "the first of the two")] {
                if let Some(span) = spec.spans.get(at) {
                    diag = diag.label(*span, text);
                }
            }
            sink.push(
                diag.place(format!("{name} curve, point {}", i + 1), Point3::from(pair[0]))
                    .help("remove one of the two points"),
            );
        }
    }
    if sink.count() > before {
        return None;
    }
    let points: Vec<_> = spec.points.iter().map(|p| Point3::from(*p)).collect();
    // Cubic as in the paper; fewer points give a lower degree.
    let degree = points.len().saturating_sub(1).clamp(1, 3);
    match interpolate(&points, degree) {
        Ok(curve) => {
            crossing(&curve, spec, name, sink);
            (sink.count() == before).then_some(curve)
        }
        Err(error) => {
            sink.push(point_fault(&error, spec, name));
            None
        }
    }
}

fn point_fault(error: &GeomError, spec: &CurveSpec, name: &str) -> Diag {
    let help = match error {
        GeomError::TooFewPoints { .. } => "a curve needs at least two points; four or more make it cubic",
        _ => "correct the points",
    };
    Diag::error(codes::POINTS, format!("no curve goes through the points of the {name} curve: {error}"))
        .label(spec.span, "this curve")
        .help(help)
}

/// Reports a curve whose meridian crosses itself: no surface of revolution and no channel has such a wall.
fn crossing(curve: &NurbsCurve, spec: &CurveSpec, name: &str, sink: &mut Sink) {
    let at = |i: usize| curve.point(i as f64 / CROSSING_CHORDS as f64);
    let space: Vec<Point3<f64>> = (0..=CROSSING_CHORDS).map(at).collect();
    let flat: Vec<Vector2<f64>> = space.iter().map(|p| Vector2::new(libm::hypot(p.x, p.y), p.z)).collect();
    for i in 0..CROSSING_CHORDS {
        for j in i + 2..CROSSING_CHORDS {
            if segments_cross(flat[i], flat[i + 1], flat[j], flat[j + 1]) {
                sink.push(
                    Diag::error(codes::CURVE_CROSSES, format!("the {name} curve crosses itself in the meridian plane"))
                        .label(spec.span, "this curve")
                        .place(
                            format!(
                                "{name} curve, u = {:.2} and {:.2}",
                                i as f64 / CROSSING_CHORDS as f64,
                                j as f64 / CROSSING_CHORDS as f64
                            ),
                            space[i],
                        )
                        .help("give the points in order from inlet to outlet; check whether two points are exchanged"),
                );
                return;
            }
        }
    }
}

fn segments_cross(a: Vector2<f64>, b: Vector2<f64>, c: Vector2<f64>, d: Vector2<f64>) -> bool {
    let side = |p: Vector2<f64>, q: Vector2<f64>, r: Vector2<f64>| (q - p).perp(&(r - p));
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}
