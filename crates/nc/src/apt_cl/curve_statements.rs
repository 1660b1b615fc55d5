//! From spline blocks to MOVNRB, each with the same motion in GOTO for post-processors that do not take curves.

use crate::words::fixed;
use five_axis::{PoseCurve, TurnCurve};
use ir::SplineBlock;
use nalgebra::Vector3;
use nurbs::bezier;

/// Digits that control points have behind those of a pose: rounded, no curve leaves the proved one.
const EXTRA_DIGITS: usize = 4;

/// Chords by which the length of a curve is measured.
const LENGTH_CHORDS: u32 = 64;

/// Writes the statements before the GOTO of a spline block. `statement` writes a MOVNRB with values, on as many lines as it needs.
pub(super) fn begin(spline: &SplineBlock, digits: usize, mut statement: impl FnMut(Vec<String>)) {
    let curve = &spline.curve;
    let TurnCurve::Second(second) = curve.turn() else { return };
    let order = curve.degree() + 1;
    let distance = curve.levers().and_then(|levers| levers.first().map(Vector3::norm)).unwrap_or_default();
    statement(vec!["5AXIS".to_owned(), "LENGTH".to_owned(), fixed(distance, digits)]);
    let head = [order, 2 * order, 0, order].map(|n| n.to_string());
    statement([&["ON".to_owned()][..], &head, &[fixed(length(curve), digits)]].concat());
    let knots = (0..2 * order).map(|k| u8::from(k >= order).to_string());
    statement(std::iter::once("1".to_owned()).chain(knots).collect());
    for (number, points) in [("2", curve.tip()), ("3", second)] {
        let numbers = points.iter().flat_map(|p| [p.x, p.y, p.z]).map(|x| fixed(x, digits + EXTRA_DIGITS));
        statement(std::iter::once(number.to_owned()).chain(numbers).collect());
    }
    statement(vec!["NEXT".to_owned()]);
}

fn length(curve: &PoseCurve) -> f64 {
    let at = |k: u32| bezier::value(curve.tip(), f64::from(k) / f64::from(LENGTH_CHORDS));
    (0..LENGTH_CHORDS).map(|k| (at(k + 1) - at(k)).norm()).sum()
}
