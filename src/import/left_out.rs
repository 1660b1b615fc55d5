//! Sections that a part of ruled faces leaves out, and how far they lie beside these faces.

use super::part_source::{PartSource, blade_name};
use crate::diag::codes::import as codes;
use crate::diag::{Diag, printable};
use crate::units::trim;
use nalgebra::{Point3, Vector3};

/// Largest distance of left out points from the faces, mm: that of a tolerance of form, and less than any allowance of finishing.
const MOST: f64 = 0.02;

/// Rulings of a face that distances are taken from.
const RULINGS: usize = 400;

/// How far the sections between the first and the last one lie beside faces that are ruled from the first to the last.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LeftOut {
    /// Blade of the row.
    pub(super) blade: usize,
    /// Section with the largest distance, counted from the hub.
    pub(super) section: usize,
    /// This distance, mm.
    pub(super) distance: f64,
}

/// The largest distance of each blade that leaves sections out.
pub(super) fn all(source: &PartSource<'_>) -> Vec<LeftOut> {
    let of = |blade: usize| {
        let divided = &source.divided[blade];
        let (first, last) = (divided.first()?, divided.last()?);
        let inner = divided.iter().enumerate().take(divided.len() - 1).skip(1);
        let distances = inner.flat_map(|(section, d)| (0..2).map(move |face| (section, face, &d.outline.faces[face])));
        let faces = [0, 1].map(|face| [first, last].map(|d| evenly(&d.outline.faces[face])));
        let far = |(section, face, points): (usize, usize, &Vec<Point3<f64>>)| {
            let distance = points.iter().map(|p| beside(p, &faces[face])).fold(0.0, f64::max);
            LeftOut { blade, section, distance }
        };
        distances.map(far).max_by(|a, b| a.distance.total_cmp(&b.distance))
    };
    (0..source.divided.len()).filter_map(of).collect()
}

/// What is told of a blade that leaves sections out.
pub(super) fn told(left: &LeftOut, sections: usize) -> String {
    let (blade, distance) = (blade_name(left.blade), trim(left.distance, 4));
    let between = match sections - 2 {
        1 => "the section between the first and the last one is".to_owned(),
        count => format!("the {count} sections between the first and the last one are"),
    };
    format!("{blade}: {between} left out; their points lie up to {distance} mm beside the ruled faces.")
}

/// Refuses a part that leaves out sections which are not on its faces.
///
/// # Errors
/// A section lies farther beside the faces than a tolerance of form.
pub(super) fn check(source: &PartSource<'_>) -> Result<(), Diag> {
    let worst = all(source).into_iter().max_by(|a, b| a.distance.total_cmp(&b.distance));
    let Some(LeftOut { blade, section, distance }) = worst.filter(|left| left.distance > MOST) else { return Ok(()) };
    let read = &source.row.blades[blade];
    let place = read.places.get(section).copied().unwrap_or_default();
    let message = format!(
        "section {} of the blade `{}` lies up to {} mm beside faces ruled from the first to the last section",
        section + 1,
        printable(&read.name),
        trim(distance, 3)
    );
    Err(Diag::error(codes::LEFT_OUT, message)
        .label(place, format!("the part would leave it out; at most {MOST} mm are left without a word"))
        .help(
            "give the blade by closed sections, with hub and shroud: then the faces go through all of them; or state `--ruled` \
             where ruled faces are meant",
        ))
}

/// Points of a curve at equal shares of its length.
fn evenly(points: &[Point3<f64>]) -> Vec<Point3<f64>> {
    let mut lengths = vec![0.0];
    for pair in points.windows(2) {
        lengths.push(lengths[lengths.len() - 1] + nalgebra::distance(&pair[0], &pair[1]));
    }
    let whole = lengths[lengths.len() - 1];
    let at = |k: usize| {
        let length = whole * k as f64 / RULINGS as f64;
        let next = lengths.partition_point(|l| *l < length).clamp(1, (points.len() - 1).max(1));
        let (Some(a), Some(b)) = (points.get(next - 1), points.get(next)) else { return points[0] };
        let step = lengths[next] - lengths[next - 1];
        a + (b - a) * if step > 0.0 { (length - lengths[next - 1]) / step } else { 0.0 }
    };
    if points.is_empty() { Vec::new() } else { (0..=RULINGS).map(at).collect() }
}

/// Distance of a point from the face between two curves, along its normal, mm.
fn beside(p: &Point3<f64>, [root, tip]: &[Vec<Point3<f64>>; 2]) -> f64 {
    let foot = |k: usize| {
        let way = tip[k] - root[k];
        let square = way.norm_squared();
        let t = if square > 0.0 { ((p - root[k]).dot(&way) / square).clamp(0.0, 1.0) } else { 0.0 };
        (root[k] + way * t, t, way)
    };
    let nearest = (0..root.len().min(tip.len())).min_by(|a, b| {
        let far = |k: usize| (p - foot(k).0).norm_squared();
        far(*a).total_cmp(&far(*b))
    });
    let Some(k) = nearest else { return 0.0 };
    let (at, t, across) = foot(k);
    let [before, behind] = [k.saturating_sub(1), (k + 1).min(root.len() - 1)];
    let on = |k: usize| root[k] + (tip[k] - root[k]) * t;
    let normal: Vector3<f64> = across.cross(&(on(behind) - on(before)));
    normal.try_normalize(0.0).map_or(0.0, |normal| normal.dot(&(p - at)).abs())
}
