//! Meridians of faces by their surfaces: between the ends that the borders of a face have there.
//!
//! Any line of a surface of revolution that runs from one of its ends to the other shows the meridian by its radii and heights. So no
//! edge needs to run along the meridian: a face may lie between two rings, and have holes where blades stand.

use super::face::{EDGE_GAP_MM, EDGE_STEPS, StepBorder, StepFace};
use super::meridian::{StepMeridian, flat};
use super::placement::StepPlacement;
use super::surface::StepSurface;
use nalgebra::{Point3, Vector2};
use std::cmp::Ordering;
use std::f64::consts::{FRAC_PI_2, PI};

/// Largest sine between the axis of a surface and Z. How far it is off is measured at the borders.
const TILTED: f64 = 0.01;

/// Of the points of borders, one in so many counts.
const BORDER_STRIDE: usize = 8;

/// The meridian of a face of a plane across Z, or of a cylinder, cone, sphere, torus or turned curve about Z; `None` for another one.
pub(super) fn exact(face: &StepFace) -> Option<StepMeridian> {
    match &face.surface {
        StepSurface::Plane(frame) => of_plane(face, frame),
        StepSurface::Torus(frame, 0.0, radius) => of_sphere(face, &frame.origin, *radius),
        StepSurface::Cone(frame, ..) | StepSurface::Torus(frame, ..) | StepSurface::Revolution(frame, _) => {
            about_z(frame).then(|| along(face, 1)).flatten()
        }
        StepSurface::Extrusion(..) | StepSurface::Spline(..) => None,
    }
}

/// The meridian by the line of a surface that changes its radius and height the most: of both lines through its middle.
pub(super) fn traced(face: &StepFace) -> Option<StepMeridian> {
    let lines = [0, 1].into_iter().filter_map(|k| along(face, k));
    lines.max_by(|a, b| a.length().total_cmp(&b.length()))
}

/// Whether an axis is the Z axis.
fn about_z(frame: &StepPlacement) -> bool {
    let across = |x: f64, y: f64| libm::hypot(x, y);
    let [_, _, axis] = frame.axes;
    across(axis.x, axis.y) <= TILTED && across(frame.origin.x, frame.origin.y) <= EDGE_GAP_MM
}

fn first_point(border: &StepBorder) -> Option<&Point3<f64>> {
    border.first()?.points.first()
}

/// Points of the borders of a face.
fn points(face: &StepFace) -> impl Iterator<Item = &Point3<f64>> {
    face.borders.iter().flatten().flat_map(|edge| edge.points.iter().step_by(BORDER_STRIDE).chain(edge.points.last()))
}

/// The border round the axis of a face that holds a place of the axis: an odd number of its borders goes round it.
fn ring_round_axis(face: &StepFace) -> Option<&StepBorder> {
    let goes_round = |border: &&StepBorder| {
        let angles: Vec<f64> = border.iter().flat_map(|edge| &edge.points).map(|p| libm::atan2(p.y, p.x)).collect();
        let turn = |w: &[f64]| nurbs::angle::nearest_turn(w[1] - w[0], 0.0);
        angles.windows(2).map(turn).sum::<f64>().abs() > PI
    };
    let rings: Vec<&StepBorder> = face.borders.iter().filter(goes_round).collect();
    rings.first().copied().filter(|_| rings.len() % 2 == 1)
}

/// The range from a ring to the tip of the surface on which the face has its other borders; without such to the nearest tip.
fn to_tip(ends: [f64; 2], ring: f64, tips: &[f64]) -> [f64; 2] {
    let [below, above] = [ring - ends[0], ends[1] - ring];
    let beyond = |tip: &&f64| match below.total_cmp(&above) {
        Ordering::Greater => **tip <= ends[0],
        Ordering::Less => **tip >= ends[1],
        Ordering::Equal => true,
    };
    let far = |tip: &f64| (tip - ends[0]).abs().min((tip - ends[1]).abs());
    let tip = tips.iter().filter(beyond).min_by(|a, b| far(a).total_cmp(&far(b)));
    tip.map_or(ends, |tip| [ends[0].min(*tip), ends[1].max(*tip)])
}

/// A plane across Z, between its least and its largest radius.
fn of_plane(face: &StepFace, frame: &StepPlacement) -> Option<StepMeridian> {
    let [_, _, normal] = frame.axes;
    if libm::hypot(normal.x, normal.y) > TILTED {
        return None;
    }
    let at_axis = frame.origin.coords.dot(&normal) / normal.z;
    let [least, most] = range(points(face).map(|p| flat(p).x))?;
    let least = if ring_round_axis(face).is_some() { 0.0 } else { least };
    StepMeridian::new(vec![Vector2::new(least, at_axis), Vector2::new(most, at_axis)])
}

/// A sphere about a point of the Z axis. It is turned about all axes through its middle: one of its edges must be a ring about Z.
fn of_sphere(face: &StepFace, middle: &Point3<f64>, radius: f64) -> Option<StepMeridian> {
    let ring = |edge: &[Point3<f64>]| {
        let first = edge.first().map(flat);
        edge.iter().all(|p| first.is_some_and(|first| (flat(p) - first).norm() <= EDGE_GAP_MM))
    };
    let has_ring = face.borders.iter().flatten().any(|edge| ring(&edge.points));
    if !has_ring || libm::hypot(middle.x, middle.y) > EDGE_GAP_MM {
        return None;
    }
    let angle = |p: &Point3<f64>| libm::atan2(p.z - middle.z, flat(p).x);
    let mut ends = range(points(face).map(angle))?;
    if let Some(p) = ring_round_axis(face).and_then(first_point) {
        ends = to_tip(ends, angle(p), &[-FRAC_PI_2, FRAC_PI_2]);
    }
    let at = |angle: f64| {
        let (sin, cos) = libm::sincos(angle);
        Vector2::new(radius * cos, middle.z + radius * sin)
    };
    StepMeridian::new(steps(ends).map(at).collect())
}

/// The line of a surface along one of its parameters, between the ends that the borders have there, in the middle of the other one.
fn along(face: &StepFace, k: usize) -> Option<StepMeridian> {
    let surface = &face.surface;
    let mut near = None;
    let mut places: [Vec<f64>; 2] = [Vec::new(), Vec::new()];
    for p in points(face) {
        let mut foot = surface.nearest(p, near);
        // A search that went astray begins anew, and one that came to a seam goes on behind it.
        if foot.far >= EDGE_GAP_MM && near.is_some() {
            foot = surface.nearest(p, None);
        }
        let behind = surface.beyond_seam(foot.place).map(|start| surface.nearest(p, Some(start)));
        if let Some(found) = behind.filter(|other| other.far < foot.far) {
            foot = found;
        }
        near = (foot.far < EDGE_GAP_MM).then_some(foot.place);
        for (all, at) in places.iter_mut().zip(foot.place) {
            all.push(at);
        }
    }
    let middle = range(places[1 - k].iter().copied())?;
    let middle = 0.5 * (middle[0] + middle[1]);
    let at = |v: f64| flat(&surface.round(if k == 0 { [v, middle] } else { [middle, v] }).point);
    let mut ends = match surface.period(k) {
        Some(period) => shortest_arc(&mut places[k], period)?,
        None => range(places[k].iter().copied())?,
    };
    if let Some(p) = ring_round_axis(face).and_then(first_point) {
        let tips: Vec<f64> = surface.tips(k).into_iter().filter(|tip| at(*tip).x < EDGE_GAP_MM).collect();
        ends = to_tip(ends, surface.nearest(p, None).place[k], &tips);
    }
    StepMeridian::new(steps(ends).map(at).collect())
}

/// Values between two ends.
fn steps([from, to]: [f64; 2]) -> impl Iterator<Item = f64> {
    (0..=EDGE_STEPS).map(move |k| from + (to - from) * k as f64 / EDGE_STEPS as f64)
}

/// Least and largest value.
fn range(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    values.fold(None, |range: Option<[f64; 2]>, x| {
        let [least, most] = range.unwrap_or([x; 2]);
        Some([least.min(x), most.max(x)])
    })
}

/// The shortest arc of a closed parameter that holds all values: what lies opposite of the largest gap between them.
fn shortest_arc(values: &mut [f64], period: f64) -> Option<[f64; 2]> {
    values.iter_mut().for_each(|x| *x = x.rem_euclid(period));
    values.sort_by(f64::total_cmp);
    let (first, last) = (*values.first()?, *values.last()?);
    let gaps = values.windows(2).map(|w| (w[1] - w[0], [w[1], w[0] + period]));
    let round = (first + period - last, [first, last]);
    gaps.chain([round]).max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, arc)| arc)
}
