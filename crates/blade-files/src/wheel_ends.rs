//! The part of a meridian that belongs to the wheel: from ahead of the leading edges to the trailing edges or behind them.

use super::{Imported, ImportedRow};
use blade::angles::EdgeShape;
use blade::outline::DividedSection;
use blade::{EdgeForm, SectionForm};
use nalgebra::Point2;
use nurbs::chords;

/// Share of the length from leading to trailing edge by which a meridian goes on.
const EXTENSION_SHARE: f64 = 0.1;

/// Points nearer to a cut end than this share of the length are left out.
const NEAR_END_SHARE: f64 = 1e-3;

/// A cut meridian.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct CutMeridian {
    /// Points (r, z) from inlet to outlet, mm.
    pub(super) points: Vec<[f64; 2]>,
    /// Largest distance of left out points between the ends from the meridian, mm.
    pub(super) moved: f64,
    /// Lengths ahead of the foremost and behind the last point of the blades, mm.
    pub(super) beyond: [f64; 2],
}

/// Edges of the blades of a wheel.
#[derive(Clone, Copy, Debug, Default)]
struct WheelEdges {
    /// Which edges the lathe makes, leading and trailing: there the wheel ends with its blades.
    lathe: [bool; 2],
    /// Largest width of rounded trailing edges, mm.
    rounded: f64,
}

/// Hub and shroud of the wheel, where all blades have closed sections.
pub(super) fn wheel(
    imported: &Imported,
    row: &ImportedRow,
    divided: &[Vec<DividedSection>],
) -> Option<[CutMeridian; 2]> {
    let blades = &row.blades;
    let closed = blades
        .iter()
        .flat_map(|b| &b.sections)
        .all(|s| matches!(s.form, SectionForm::Loop(_) | SectionForm::DividedLoop { .. }));
    // Blades by angles that are cut off go on to the ends of the wheel, where the lathe cuts them.
    let lathe = blades
        .first()
        .and_then(|b| b.angles.as_ref())
        .map_or([false; 2], |angles| angles.shapes.map(|shape| shape == EdgeShape::CutOff));
    let trailing = divided.iter().flatten().map(|section| &section.edges[1]);
    let rounded = trailing.filter(|edge| edge.form == EdgeForm::Round).map(|edge| edge.width).fold(0.0, f64::max);
    let few = blades.iter().all(|b| b.sections.len() >= 2);
    let of = |line: &Option<Vec<[f64; 2]>>, last: bool| {
        let section =
            |divided: &Vec<DividedSection>| if last { divided.last().cloned() } else { divided.first().cloned() };
        let outlines = divided.iter().filter_map(section).map(|d| d.outline);
        let points = outlines.flat_map(|o| o.faces.into_iter().chain(o.edges).flatten());
        cut(line.as_ref()?, points.map(|p| [libm::hypot(p.x, p.y), p.z]), WheelEdges { lathe, rounded })
    };
    let ends = [of(&imported.hub, false)?, of(&imported.shroud, true)?];
    (closed && few).then_some(ends)
}

/// Cuts a meridian, given from inlet to outlet, to the wheel with these points of its blades, (r, z). A meridian that is rather
/// radial where the blades end is cut close behind them, since an impeller ends with its blades: it goes on by the width of
/// rounded edges, so that there is floor behind them. Others go on by a tenth of the length of the blades, as at the inlet. No
/// meridian is extended.
///
/// `None` for a meridian without length, or without blades.
fn cut(
    line: &[[f64; 2]],
    blades: impl Iterator<Item = [f64; 2]>,
    WheelEdges { lathe, rounded }: WheelEdges,
) -> Option<CutMeridian> {
    let points: Vec<Point2<f64>> = line.iter().map(|p| Point2::from(*p)).collect();
    let lengths = chords::lengths(&points);
    let whole = *lengths.last()?;
    let along = |p: [f64; 2]| {
        let near = chords::nearest(&Point2::from(p), &points).filter(|near| near.chord + 1 < points.len());
        near.map_or(0.0, |near| lengths[near.chord] + (lengths[near.chord + 1] - lengths[near.chord]) * near.share)
    };
    let [first, last] =
        blades.map(along).fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], s| [low.min(s), high.max(s)]);
    let length = last - first;
    if !(whole > 0.0 && length > 0.0 && length.is_finite()) {
        return None;
    }
    let segment = |s: f64| lengths.partition_point(|l| *l < s).clamp(1, points.len() - 1);
    let end = segment(last);
    let way = points[end] - points[end - 1];
    let radial = way.x.abs() > way.y.abs();
    let behind = if lathe[1] {
        0.0
    } else if radial {
        rounded.min(EXTENSION_SHARE * length)
    } else {
        EXTENSION_SHARE * length
    };
    let ahead = if lathe[0] { 0.0 } else { EXTENSION_SHARE * length };
    let (from, to) = ((first - ahead).max(0.0), (last + behind).min(whole));
    let at = |s: f64| {
        let k = segment(s);
        let share = (s - lengths[k - 1]) / (lengths[k] - lengths[k - 1]).max(f64::MIN_POSITIVE);
        points[k - 1] + (points[k] - points[k - 1]) * share
    };
    let between = points
        .iter()
        .zip(&lengths)
        .filter(|(_, s)| **s > from + NEAR_END_SHARE * length && **s < to - NEAR_END_SHARE * length);
    let mut kept = vec![at(from)];
    kept.extend(between.map(|(p, _)| *p));
    kept.push(at(to));
    let inside = points.iter().zip(&lengths).filter(|(_, s)| (from..=to).contains(*s));
    let moved = inside.map(|(p, _)| chords::from_chords(p, &kept)).fold(0.0, f64::max);
    let kept = kept.into_iter().map(Into::into).collect();
    Some(CutMeridian { points: kept, moved, beyond: [first - from, to - last] })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A quarter of a circle from axial to radial, with straight lines before and behind.
    fn line() -> Vec<[f64; 2]> {
        let mut line = vec![[10.0, 40.0], [10.0, 30.0]];
        line.extend(
            (1..=30)
                .map(|i| f64::from(i) * 3.0_f64.to_radians())
                .map(|a| [40.0 - 30.0 * a.cos(), 30.0 - 30.0 * a.sin()]),
        );
        line.push([60.0, 0.0]);
        line
    }

    #[test]
    fn an_impeller_ends_with_its_blades() {
        let blades = [[10.5, 28.0], [20.0, 8.0], [55.0, 0.3]];
        let cut = cut(&line(), blades.into_iter(), WheelEdges::default()).expect("cut");
        let [first, last] = [cut.points[0], cut.points[cut.points.len() - 1]];
        assert!((last[0] - 55.0).abs() < 1e-9 && last[1].abs() < 1e-9, "{last:?}");
        assert!(first[1] > 33.0 && first[1] < 36.0 && (first[0] - 10.0).abs() < 1e-9, "{first:?}");
        assert!(cut.beyond[1].abs() < 1e-9 && cut.beyond[0] > 5.0, "{:?}", cut.beyond);
        assert!(cut.points.windows(2).all(|pair| pair[0] != pair[1]));
    }

    /// Behind rounded edges there is floor for the ball that goes round them, as far as the line has it.
    #[test]
    fn an_impeller_with_rounded_edges_ends_behind_them() {
        let blades = [[10.5, 28.0], [20.0, 8.0], [55.0, 0.3]];
        let behind = |rounded: f64| {
            let edges = WheelEdges { rounded, ..WheelEdges::default() };
            cut(&line(), blades.into_iter(), edges).expect("cut").beyond[1]
        };
        assert!((behind(1.2) - 1.2).abs() < 1e-9, "{}", behind(1.2));
        // At most a tenth of the length of the blades, and no longer than the line.
        assert!(behind(50.0) > 4.0 && behind(50.0) <= 5.0 + 1e-9, "{}", behind(50.0));
    }

    #[test]
    fn an_axial_wheel_goes_on_behind_its_blades_as_far_as_the_line() {
        let line = [[20.0, 50.0], [21.0, 0.0], [21.5, -24.0]];
        let cut = cut(&line, [[22.0, 20.0], [22.0, -20.0]].into_iter(), WheelEdges::default()).expect("cut");
        let turned = WheelEdges { lathe: [true; 2], ..WheelEdges::default() };
        let ends = super::cut(&line, [[22.0, 20.0], [22.0, -20.0]].into_iter(), turned).expect("cut").beyond;
        assert!(ends.iter().all(|beyond| beyond.abs() < 1e-9), "{ends:?}");
        assert!((cut.beyond[0] - 4.0).abs() < 0.1 && (cut.beyond[1] - 4.0).abs() < 0.1, "{:?}", cut.beyond);
        assert!(super::cut(&line, std::iter::empty(), WheelEdges::default()).is_none());
        assert!(super::cut(&[[1.0, 1.0]], [[1.0, 1.0]].into_iter(), WheelEdges::default()).is_none());
    }
}
