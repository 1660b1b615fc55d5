//! Polynomials of a block, from their words to the path of the tool.

use five_axis::{Angles, PoseCurve, TurnCurve};
use nalgebra::{Point3, SVector, Vector2, Vector3};
use nurbs::bezier;

/// Words of the polynomials of a block. Angles in radians, ISO sense.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum SplineWords {
    /// The parameter runs from 0 to 1: end and the coefficients of the powers from 2 on, of X Y Z and of a second point of
    /// the tool axis. The linear term leads from the present place to the end.
    Forward {
        /// Tip, mm.
        tip: [Vec<f64>; 3],
        /// Second point, mm.
        second: [Vec<f64>; 3],
    },
    /// The parameter runs from 1 to 0: end and the coefficients of the powers 3, 2 and 1.
    Backward {
        /// Tip, mm.
        tip: [[f64; 4]; 3],
        /// Rotary axes, radians.
        rotary: [[f64; 4]; 2],
    },
}

/// Largest distance of the start of a spline from the end of the block before, mm, where the words give the start (iTNC 530: 1 um).
const START_OFF_MM: f64 = 1e-3;

/// Largest turn between them, radians.
const START_OFF_RAD: f64 = 2e-5;

/// Where the tool stands.
pub(crate) struct SplineStart {
    pub(crate) tip: Point3<f64>,
    /// Rotary axes, where they are known.
    pub(crate) rotary: Option<Angles>,
    /// Second point, where it is known.
    pub(crate) second: Option<Vector3<f64>>,
}

impl SplineWords {
    /// The path of the tool from where it stands.
    pub(crate) fn curve(&self, start: &SplineStart) -> Result<PoseCurve, String> {
        let (tip, turn) = match self {
            Self::Forward { tip, second } => {
                let from = start.second.ok_or(
                    "the second point of the tool axis is unknown at the start of the polynomial: write XH YH ZH at the place \
                     where the tool stands, in a block with G1, before it",
                )?;
                let count = tip.iter().chain(second).map(Vec::len).max().unwrap_or(1).max(1);
                (
                    bezier::of_powers(&forward(start.tip.coords, tip, count)),
                    TurnCurve::Second(bezier::of_powers(&forward(from, second, count))),
                )
            }
            Self::Backward { tip, rotary } => {
                let tips = backward(tip);
                let turns: Vec<Vector2<f64>> = backward(rotary);
                let off = (tips[0] - start.tip.coords).amax();
                if off > START_OFF_MM {
                    return Err(format!(
                        "the spline begins {off:.4} mm away from where the tool stands: the control takes 0.001 mm"
                    ));
                }
                let before =
                    start.rotary.ok_or("a spline of rotary axes after a direction vector: write their positions")?;
                let turned = (turns[0] - Vector2::from(before)).amax();
                if turned > START_OFF_RAD {
                    return Err(format!(
                        "the spline begins with a rotary axis {:.5} deg away from its position",
                        turned.to_degrees()
                    ));
                }
                (tips, TurnCurve::Rotary(turns))
            }
        };
        PoseCurve::new(tip, turn).ok_or_else(|| "the polynomials give no direction of the tool".to_owned())
    }
}

/// Coefficients of all powers.
fn forward(start: Vector3<f64>, words: &[Vec<f64>; 3], count: usize) -> Vec<Vector3<f64>> {
    let word = |k: usize| Vector3::from_fn(|axis, _| words[axis].get(k).copied().unwrap_or(0.0));
    let higher: Vec<Vector3<f64>> = (1..count).map(word).collect();
    let linear = word(0) - start - higher.iter().sum::<Vector3<f64>>();
    [start, linear].into_iter().chain(higher).collect()
}

/// Control points in the order of motion.
fn backward<const N: usize>(words: &[[f64; 4]; N]) -> Vec<SVector<f64, N>> {
    let power = |k: usize| SVector::from_fn(|axis, _| words[axis][k]);
    let mut control = bezier::of_powers(&[power(0), power(3), power(2), power(1)]);
    control.reverse();
    control
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The example of the reference: both forms of one cubic.
    #[test]
    fn both_forms_are_the_curve_that_they_say() {
        let points = [[40.0, 0.0, 10.0], [39.0, 2.0, 9.2], [37.6, 4.4, 8.7], [36.4, 6.1, 8.3]].map(Vector3::from);
        let start = SplineStart {
            tip: points[0].into(),
            rotary: Some([0.5, 0.2]),
            second: Some(points[0] + Vector3::z() * 20.0),
        };
        let words = SplineWords::Forward {
            tip: [vec![36.4, -1.2, 0.6], vec![6.1, 1.2, -1.1], vec![8.3, 0.9, -0.2]],
            second: [vec![36.4, -1.2, 0.6], vec![6.1, 1.2, -1.1], vec![28.3, 0.9, -0.2]],
        };
        let curve = words.curve(&start).unwrap();
        assert!(curve.tip().iter().zip(&points).all(|(a, b)| (a - b).norm() < 1e-12), "{curve:?}");
        let words = SplineWords::Backward {
            tip: [[36.4, -0.6, 0.6, 3.6], [6.1, 1.1, -2.1, -5.1], [8.3, 0.2, 0.3, 1.2]],
            rotary: [[0.7, 0.0, 0.0, -0.2], [0.1, 0.0, 0.0, 0.1]],
        };
        let curve = words.curve(&start).unwrap();
        assert!(curve.tip().iter().zip(&points).all(|(a, b)| (a - b).norm() < 1e-12), "{curve:?}");
        let TurnCurve::Rotary(turns) = curve.turn() else { panic!("{curve:?}") };
        assert!(
            (turns[0] - Vector2::new(0.5, 0.2)).norm() < 1e-12 && (turns[3] - Vector2::new(0.7, 0.1)).norm() < 1e-12
        );
        // 1 um is the most that the start may be away.
        let away = SplineStart { tip: points[0].into(), ..start };
        let SplineWords::Backward { mut tip, rotary } = words else { panic!() };
        tip[0][3] += 0.0011;
        assert!(SplineWords::Backward { tip, rotary }.curve(&away).is_err());
    }
}
