//! What a part of ruled faces leaves out, and how far it lies from the part: sections between the first and the last one, edges, hub
//! and shroud.

use super::{Imported, ImportedRow};
use base::units::trim;
use blade::outline::DividedSection;
use diagnostics::codes::import as codes;
use diagnostics::{Diag, printable};
use nalgebra::{Matrix2, Point2, Point3, Vector2};
use nurbs::{chords, interpolate};

/// Rulings of a face that distances are taken from.
const RULINGS: usize = 400;

/// What is left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LeftOutThing {
    /// Faces of the sections between the first and the last one.
    Sections,
    /// Edges of all sections: the lathe makes them, straight from root to tip.
    Edges,
    /// The hub: the part takes the root of the pressure face for it.
    Hub,
    /// The shroud: the part takes the tip of the pressure face for it.
    Shroud,
}

/// Points that are left out, and how far they lie from the part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LeftOut {
    pub(super) thing: LeftOutThing,
    /// Blade of the row.
    pub(super) blade: usize,
    /// Section with the largest distance, counted from the hub.
    pub(super) section: usize,
    /// This distance, mm.
    pub(super) distance: f64,
}

/// The largest distances of all things that are left out.
pub(super) fn all(imported: &Imported, divided: &[Vec<DividedSection>]) -> Vec<LeftOut> {
    let blades = divided.iter().enumerate().filter_map(|(blade, divided)| of_blade(blade, divided));
    blades.flatten().chain(turned(imported, divided)).collect()
}

/// Sections between the first and the last one, and edges, of a blade.
fn of_blade(blade: usize, divided: &[DividedSection]) -> Option<Vec<LeftOut>> {
    let (first, last) = (divided.first()?, divided.last()?);
    let faces = [0, 1].map(|face| RuledFace::between([first, last].map(|d| d.outline.faces[face].as_slice())));
    // The edges of the part: straight lines between the ends of its faces.
    let ends =
        [0, RULINGS].map(|k| RuledFace { curves: [0, 1].map(|c| faces.each_ref().map(|f| f.curves[c][k]).to_vec()) });
    let farthest = |thing: LeftOutThing, of: &dyn Fn(usize, &DividedSection) -> Option<f64>| {
        let all = divided.iter().enumerate().filter_map(|(section, d)| Some((section, of(section, d)?)));
        let (section, distance) = all.max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(LeftOut { thing, blade, section, distance })
    };
    let from_ends = |p: &Point3<f64>| ends.iter().map(|end| end.distance(p)).fold(f64::INFINITY, f64::min);
    let sections = farthest(LeftOutThing::Sections, &|section, d| {
        let between = section > 0 && section + 1 < divided.len();
        let points =
            d.outline.faces.iter().zip(&faces).flat_map(|(points, face)| points.iter().map(move |p| (p, face)));
        between.then(|| points.map(|(p, face)| face.distance(p).min(from_ends(p))).fold(0.0, f64::max))
    });
    let edges = farthest(LeftOutThing::Edges, &|_, d| {
        let points = d.outline.edges.iter().flatten();
        let off = |p: &Point3<f64>| faces.iter().map(|face| face.distance(p)).fold(from_ends(p), f64::min);
        Some(points.map(off).fold(0.0, f64::max))
    });
    Some(sections.into_iter().chain(edges).collect())
}

/// Distances of hub and shroud of the files from those of the part, which are the ends of the pressure face of the main blade.
fn turned(imported: &Imported, divided: &[Vec<DividedSection>]) -> Vec<LeftOut> {
    let Some(main) = divided.first() else { return Vec::new() };
    let ends = [
        (LeftOutThing::Hub, &imported.hub, 0, main.first()),
        (LeftOutThing::Shroud, &imported.shroud, main.len().saturating_sub(1), main.last()),
    ];
    let off = |(thing, line, section, end): (LeftOutThing, &Option<Vec<[f64; 2]>>, usize, Option<&DividedSection>)| {
        let given: Vec<Point2<f64>> = line.as_ref()?.iter().map(|p| Point2::from(*p)).collect();
        let own: Vec<Point2<f64>> =
            end?.outline.faces[0].iter().map(|p| Point2::new(libm::hypot(p.x, p.y), p.z)).collect();
        let distance = farthest(&own, &dense(&given)).max(farthest(&given, &dense(&own)));
        Some(LeftOut { thing, blade: 0, section, distance })
    };
    ends.into_iter().filter_map(off).collect()
}

/// The spline of the language through points, as a dense line.
fn dense(points: &[Point2<f64>]) -> Vec<Point2<f64>> {
    /// Chords between two points.
    const CHORDS_BETWEEN_POINTS: usize = 16;
    let space: Vec<Point3<f64>> = points.iter().map(|p| Point3::new(p.x, 0.0, p.y)).collect();
    let Ok(curve) = interpolate(&space, 3.min(points.len().saturating_sub(1)).max(1)) else { return points.to_vec() };
    let count = CHORDS_BETWEEN_POINTS * points.len();
    let places = (0..=count).map(|k| curve.point(k as f64 / count as f64));
    places.map(|p| Point2::new(p.x, p.z)).collect()
}

/// Largest distance of points from a line, of those that are not beyond its ends: there the wheel ends.
fn farthest(points: &[Point2<f64>], line: &[Point2<f64>]) -> f64 {
    let off = |p: &Point2<f64>| {
        let near = chords::nearest(p, line)?;
        let [first, last] = [near.chord == 0, near.chord + 2 >= line.len()];
        let beyond = (first && near.share <= 0.0) || (last && near.share >= 1.0);
        (!beyond).then_some(near.distance)
    };
    points.iter().filter_map(off).fold(0.0, f64::max)
}

/// Message about a thing that is left out.
pub(super) fn sentences(left: &LeftOut, blade: &str, sections: usize) -> String {
    let distance = trim(left.distance, 4);
    match left.thing {
        LeftOutThing::Sections => {
            let between = match sections - 2 {
                1 => "the section between the first and the last one is".to_owned(),
                count => format!("the {count} sections between the first and the last one are"),
            };
            format!("{blade}: {between} left out; their points lie up to {distance} mm beside the ruled faces.")
        }
        LeftOutThing::Edges => format!(
            "{blade}: the edges of the sections are left out; their points lie up to {distance} mm beside the straight edges of the part."
        ),
        LeftOutThing::Hub => {
            format!(
                "The hub is left out: the part takes the root of {blade} for it, which lies up to {distance} mm beside."
            )
        }
        LeftOutThing::Shroud => {
            format!(
                "The shroud is left out: the part takes the tip of {blade} for it, which lies up to {distance} mm beside."
            )
        }
    }
}

/// Refuses a part that leaves out what does not lie on it.
///
/// # Errors
/// Points lie farther from the part than `limit`, mm.
pub(super) fn check(left: &[LeftOut], row: &ImportedRow, limit: f64) -> Result<(), Diag> {
    let worst = left.iter().max_by(|a, b| a.distance.total_cmp(&b.distance));
    let Some(LeftOut { thing, blade, section, distance }) = worst.filter(|left| left.distance > limit) else {
        return Ok(());
    };
    let read = &row.blades[*blade];
    let place = read.places.get(*section).copied().unwrap_or_default();
    let (name, distance, number) = (printable(&read.name), trim(*distance, 3), section + 1);
    let message = match thing {
        LeftOutThing::Sections => format!(
            "section {number} of the blade `{name}` lies up to {distance} mm beside faces ruled from the first to the last section"
        ),
        LeftOutThing::Edges => format!(
            "the edges of section {number} of the blade `{name}` lie up to {distance} mm beside straight edges of ruled faces"
        ),
        LeftOutThing::Hub => format!("the hub lies up to {distance} mm beside the root of the blade `{name}`"),
        LeftOutThing::Shroud => format!("the shroud lies up to {distance} mm beside the tip of the blade `{name}`"),
    };
    Err(Diag::error(codes::LEFT_OUT, message)
        .label(place, format!("the part would leave it out; at most {} mm are left without a word", trim(limit, 4)))
        .help(
            "give the blade by closed sections, with hub and shroud: then the faces go through all of them; or state `--ruled` \
             where ruled faces are meant, or a larger `--within`",
        ))
}

/// A face of straight lines between two curves, as places at equal shares of their lengths.
struct RuledFace {
    /// Curves at root and tip, of one number of places.
    curves: [Vec<Point3<f64>>; 2],
}

impl RuledFace {
    /// The face between two curves.
    fn between(curves: [&[Point3<f64>]; 2]) -> Self {
        Self { curves: curves.map(evenly) }
    }

    /// Distance of a point from the face within its borders, mm.
    fn distance(&self, p: &Point3<f64>) -> f64 {
        let [root, tip] = &self.curves;
        let count = root.len().min(tip.len());
        let near =
            |k: usize| chords::nearest(p, &[root[k], tip[k]]).map_or((f64::INFINITY, 0.0), |n| (n.distance, n.share));
        let all = (0..count).map(|k| (k, near(k)));
        let Some((k, (mut least, t))) = all.min_by(|a, b| a.1.0.total_cmp(&b.1.0)) else { return f64::INFINITY };
        // Between neighbouring rulings the face is bilinear.
        for first in [k.checked_sub(1), Some(k)].into_iter().flatten().filter(|first| first + 1 < count) {
            let from = if first == k { 0.0 } else { 1.0 };
            least = least.min(self.distance_from_cell(p, first, [from, t]));
        }
        least
    }

    /// Distance of a point from the face between a ruling and the next one, searched from a place of this cell.
    fn distance_from_cell(&self, p: &Point3<f64>, first: usize, [mut s, mut t]: [f64; 2]) -> f64 {
        /// Steps of Newton's method; four make it exact on cells of usual twist.
        const NEWTON_STEPS: usize = 8;
        let [[a, b], [c, d]] = self.curves.each_ref().map(|curve| [curve[first], curve[first + 1]]);
        let mut least = f64::INFINITY;
        for _ in 0..NEWTON_STEPS {
            let [root, tip] = [a + (b - a) * s, c + (d - c) * s];
            let way = p - (root + (tip - root) * t);
            if way.norm() >= least {
                break;
            }
            least = way.norm();
            let (su, sv) = ((b - a) * (1.0 - t) + (d - c) * t, tip - root);
            let normal = Matrix2::new(su.norm_squared(), su.dot(&sv), su.dot(&sv), sv.norm_squared());
            let Some(inverse) = normal.try_inverse() else { break };
            let step = inverse * Vector2::new(way.dot(&su), way.dot(&sv));
            (s, t) = ((s + step.x).clamp(0.0, 1.0), (t + step.y).clamp(0.0, 1.0));
        }
        least
    }
}

/// Points of a curve at equal shares of its length.
fn evenly(points: &[Point3<f64>]) -> Vec<Point3<f64>> {
    let lengths = chords::lengths(points);
    let whole = lengths[lengths.len() - 1];
    let at = |k: usize| {
        let length = whole * k as f64 / RULINGS as f64;
        let next = lengths.partition_point(|l| *l < length).clamp(1, (points.len() - 1).max(1));
        let (Some(a), Some(b)) = (points.get(next - 1), points.get(next)) else { return points[0] };
        let step = lengths[next] - lengths[next - 1];
        a + (b - a) * if step > 0.0 { (length - lengths[next - 1]) / step } else { 0.0 }
    };
    if points.is_empty() { vec![Point3::origin(); RULINGS + 1] } else { (0..=RULINGS).map(at).collect() }
}
