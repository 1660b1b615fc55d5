//! Facts about the points of a section that a designer should check.

use super::ring::Ring;
use super::{Outline, Section, SectionForm, stream};
use nalgebra::Point3;

/// A chord this many times as long as both its neighbours is a gap.
const GAP_RATIO: f64 = 5.0;

/// A point this many times farther from the curve through its neighbours than the others of its face is doubtful.
const DOUBTFUL_RATIO: f64 = 12.0;

/// Least distance from that curve that is reported, as a share of the length of the face: some 10 um. Blades made of arcs have
/// steps of the curvature on their faces, with which smaller distances are found.
const MIN_REPORTED_SHARE: f64 = 2e-4;

/// Fewest points of a face that show a pattern.
const PATTERN: usize = 12;

/// A fact about points of a section. Points count from 0, in the order of the source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SectionFact {
    /// A point is at the place of the one before.
    Repeated(usize),
    /// The chord behind a point is much longer than its neighbours: its length, mm.
    Gap(usize, f64),
    /// A point lies off the curve through its neighbours: its distance, mm.
    OffCurve(usize, f64),
    /// The section crosses itself between the chords behind two points.
    Crossing(usize, usize),
}

/// Lines of points of a section: one that is closed, or two faces, or a mean line.
fn lines(section: &Section) -> (Vec<Vec<Point3<f64>>>, bool) {
    match &section.form {
        SectionForm::Loop(points) | SectionForm::DividedLoop { points, .. } => (vec![points.clone()], true),
        SectionForm::Faces(faces) => (faces.to_vec(), false),
        SectionForm::MeanLine { points, .. } => (vec![points.iter().map(|p| p.position).collect()], false),
    }
}

/// Facts of a section. The outline, where there is one, tells faces, on which points beside are looked for, and the mean
/// line, with which crossings are found. The second face of a section counts on from the first.
pub fn facts(section: &Section, outline: Option<&Outline>) -> Vec<SectionFact> {
    let mut found = Vec::new();
    let (lines, closed) = lines(section);
    let mut first = 0;
    for line in &lines {
        for (k, w) in line.windows(2).enumerate() {
            if w[0] == w[1] {
                found.push(SectionFact::Repeated(first + k + 1));
            }
        }
        gaps(line, closed, first, outline, &mut found);
        first += line.len();
    }
    if let Some(outline) = outline {
        let all: Vec<Point3<f64>> = lines.into_iter().flatten().collect();
        for face in &outline.faces {
            off_neighbours(face, &all, &mut found);
        }
        crossing(outline, &all, &mut found);
    }
    found
}

fn gaps(line: &[Point3<f64>], closed: bool, first: usize, outline: Option<&Outline>, found: &mut Vec<SectionFact>) {
    let n = line.len();
    let chords = if closed { n } else { n.saturating_sub(1) };
    if chords < 3 {
        return;
    }
    let chord = |k: usize| nalgebra::distance(&line[k % n], &line[(k + 1) % n]);
    for k in 0..chords {
        if !closed && (k == 0 || k + 1 == chords) {
            continue;
        }
        let neighbours = chord((k + chords - 1) % chords).max(chord((k + 1) % chords));
        // The flat middle of an edge is a long chord between dense points.
        let is_edge = outline.is_some_and(|o| {
            let ends = [line[k % n], line[(k + 1) % n]];
            o.edges.iter().any(|edge| ends.iter().all(|p| edge.contains(p)))
        });
        if neighbours > 0.0 && chord(k) > GAP_RATIO * neighbours && !is_edge {
            found.push(SectionFact::Gap(first + k, chord(k)));
        }
    }
}

/// Distance of a point from the cubic through two neighbours on each side, by the length along the chords (Lagrange).
fn off_curve(w: &[Point3<f64>]) -> f64 {
    let mut along = [0.0; 5];
    for k in 0..4 {
        along[k + 1] = along[k] + nalgebra::distance(&w[k], &w[k + 1]);
    }
    let mut expected = nalgebra::Vector3::zeros();
    for i in [0, 1, 3, 4] {
        let others = [0, 1, 3, 4].into_iter().filter(|j| *j != i);
        let weight: f64 = others.map(|j| (along[2] - along[j]) / (along[i] - along[j])).product();
        expected += w[i].coords * weight;
    }
    (w[2].coords - expected).norm()
}

fn off_neighbours(face: &[Point3<f64>], all: &[Point3<f64>], found: &mut Vec<SectionFact>) {
    if face.len() < PATTERN {
        return;
    }
    let length: f64 = face.windows(2).map(|w| nalgebra::distance(&w[0], &w[1])).sum();
    let off: Vec<f64> = face.windows(5).map(off_curve).collect();
    for (k, value) in off.iter().enumerate() {
        // The neighbours of a point off the curve are off by a part of its distance.
        let near = off.iter().enumerate().skip(k.saturating_sub(7)).take(15).filter(|(i, _)| i.abs_diff(k) > 2);
        let mut others: Vec<f64> = near.map(|(_, v)| *v).collect();
        others.sort_by(f64::total_cmp);
        let Some(median) = others.get(others.len() / 2) else { continue };
        let highest = off.iter().skip(k.saturating_sub(2)).take(5).all(|v| v <= value);
        if highest
            && *value > DOUBTFUL_RATIO * median
            && *value > MIN_REPORTED_SHARE * length
            && let Some(at) = face.get(k + 2).and_then(|p| all.iter().position(|q| q == p))
        {
            found.push(SectionFact::OffCurve(at, *value));
        }
    }
}

/// The first crossing of the loop with itself, seen on its stream surface: along the mean line and round the axis.
fn crossing(outline: &Outline, all: &[Point3<f64>], found: &mut Vec<SectionFact>) {
    let ring = loop_of(outline);
    let flat = stream::unrolled(&outline.faces, &ring.points);
    let n = flat.len();
    let side = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    // Chords in the order of their first coordinate, so that only those that overlap in it are compared.
    let low = |k: usize| flat[k][0].min(flat[(k + 1) % n][0]);
    let high = |k: usize| flat[k][0].max(flat[(k + 1) % n][0]);
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|a, b| low(*a).total_cmp(&low(*b)));
    for (place, i) in order.iter().enumerate() {
        for j in order[place + 1..].iter().take_while(|j| low(**j) <= high(*i)) {
            let apart = (i.abs_diff(*j)).min(n - i.abs_diff(*j));
            let [a, b, c, d] = [flat[*i], flat[(i + 1) % n], flat[*j], flat[(j + 1) % n]];
            if apart > 1 && side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0 {
                let index = |k: usize| all.iter().position(|p| *p == ring.points[k]).unwrap_or(k);
                let (first, second) = (index(*i), index(*j));
                found.push(SectionFact::Crossing(first.min(second), first.max(second)));
                return;
            }
        }
    }
}

/// The loop round an outline: the pressure face backwards, the leading edge, the suction face, the trailing edge backwards.
fn loop_of(outline: &Outline) -> Ring {
    let [pressure, suction] = &outline.faces;
    let [leading, trailing] = &outline.edges;
    let points: Vec<Point3<f64>> =
        pressure.iter().rev().chain(leading).chain(suction).chain(trailing.iter().rev()).copied().collect();
    Ring::new(&points)
}
