//! A meridian through the tips of the blades, for files that give the casing as the shroud: the shroud, moved by the gap.

use blade::outline::DividedSection;
use nalgebra::{Point2, Point3, Vector2};
use nurbs::{chords, interpolate};

/// Steps of the meridian.
const MERIDIAN_STEPS: usize = 64;

/// Steps to both sides from which the gap at a place is taken: points of both faces are some steps apart.
const GAP_STEPS: f64 = 1.5;

/// Largest distance of the tips from the meridian, mm, with which it is one through the tips.
const NEAR_TIPS_MM: f64 = 0.05;

/// A meridian through the tips of the blades.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TipMeridian {
    /// Points (r, z) from inlet to outlet, mm.
    pub(super) points: Vec<[f64; 2]>,
    /// Largest distance of the tips from it, mm.
    pub(super) within: f64,
}

impl TipMeridian {
    /// The shroud of a wheel moved to the tips of its blades; `None` where the tips lie on no meridian.
    pub(super) fn of(shroud: &[[f64; 2]], divided: &[Vec<DividedSection>]) -> Option<Self> {
        let line: Vec<Point2<f64>> = shroud.iter().map(|p| Point2::from(*p)).collect();
        let lengths = chords::lengths(&line);
        let step = lengths[lengths.len() - 1] / MERIDIAN_STEPS as f64;
        let tips: Vec<Point2<f64>> = divided
            .iter()
            .filter_map(|sections| sections.last())
            .flat_map(|section| section.outline.faces.iter().chain(&section.outline.edges).flatten())
            .map(|p| Point2::new(libm::hypot(p.x, p.y), p.z))
            .collect();
        // Length along the shroud, and the way from it.
        let gap = |p: &Point2<f64>| {
            let near = chords::nearest(p, &line)?;
            let [from, to] = [near.chord, near.chord + 1].map(|k| lengths.get(k).copied());
            Some((from? + (to? - from?) * near.share, p - near.foot))
        };
        let gaps: Vec<(f64, Vector2<f64>)> = tips.iter().filter_map(gap).collect();
        let at = |k: usize| {
            let length = step * k as f64;
            let next = lengths.partition_point(|l| *l < length).clamp(1, line.len() - 1);
            let share = (length - lengths[next - 1]) / (lengths[next] - lengths[next - 1]).max(f64::MIN_POSITIVE);
            Some(line[next - 1] + (line[next] - line[next - 1]) * share + moved(&gaps, length, GAP_STEPS * step)?)
        };
        let points: Vec<Point2<f64>> = (0..=MERIDIAN_STEPS).map(at).collect::<Option<_>>()?;
        let curve = spline(&points)?;
        let within = tips.iter().map(|p| chords::from_chords(p, &curve)).fold(0.0, f64::max);
        (within <= NEAR_TIPS_MM).then(|| Self { points: points.into_iter().map(Into::into).collect(), within })
    }
}

/// Mean distance to the tips within `reach` of a length, otherwise that of the nearest tip.
fn moved(gaps: &[(f64, Vector2<f64>)], length: f64, reach: f64) -> Option<Vector2<f64>> {
    let near: Vec<Vector2<f64>> =
        gaps.iter().filter(|(l, _)| (l - length).abs() <= reach).map(|(_, way)| *way).collect();
    if near.is_empty() {
        return gaps.iter().min_by(|a, b| (a.0 - length).abs().total_cmp(&(b.0 - length).abs())).map(|(_, way)| *way);
    }
    Some(near.iter().sum::<Vector2<f64>>() / near.len() as f64)
}

/// The spline of the language through points, as a dense line.
fn spline(points: &[Point2<f64>]) -> Option<Vec<Point2<f64>>> {
    let space: Vec<Point3<f64>> = points.iter().map(|p| Point3::new(p.x, 0.0, p.y)).collect();
    let curve = interpolate(&space, 3).ok()?;
    let count = 16 * MERIDIAN_STEPS;
    Some((0..=count).map(|k| curve.point(k as f64 / count as f64)).map(|p| Point2::new(p.x, p.z)).collect())
}
