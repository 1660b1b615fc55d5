//! Motion of the tool as polynomials of one parameter: what a control interpolates in a spline block.
//!
//! The tip is a polynomial. The direction is given by polynomials of both rotary axes (Heidenhain SPL), or by a second point
//! of the tool axis (Siemens ORICURVE, APT MOVNRB). The parameter says only which direction belongs to which tip; the feed
//! says how fast the tip runs.
//!
//! All checks of a motion know moves with a straight tip and even turns. [`PoseCurve::chords`] divides a curve into so many
//! of them that no point of the tool leaves the curve by more than a given distance. The verifier measures this distance by
//! itself and adds it to its figures.

use super::{Angles, Chain, Pose, RotaryPose};
use nalgebra::{Point3, Rotation3, Vector2, Vector3};
use nurbs::bezier;

/// Largest distance that a point of the tool up to the upper end of its flutes may leave the curve on a chord, mm: the 0.1 um
/// to which independent checks agree with the certificate.
pub const MAX_CHORD_ERROR_MM: f64 = 1e-4;

/// Most halvings of a curve into chords.
const MAX_HALVINGS: u32 = 14;

/// Largest break of direction, as a share of the speed, over which one curve counts as the continuation of another, and the
/// height at which turns are compared with ways, mm.
const SMOOTH: (f64, f64) = (1e-4, 100.0);

/// Direction of the tool along a curve, by Bezier control points.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum TurnCurve {
    /// Positions of both rotary axes, radians, ISO sense.
    Rotary(Vec<Vector2<f64>>),
    /// A second point of the tool axis, above the tip, part frame, mm.
    Second(Vec<Vector3<f64>>),
}

/// Tip and direction of the tool as polynomials of one parameter in [0, 1].
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(try_from = "StoredCurve"))]
pub struct PoseCurve {
    tip: Vec<Vector3<f64>>,
    turn: TurnCurve,
}

/// Control points of a curve that is read.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredCurve {
    tip: Vec<Vector3<f64>>,
    turn: TurnCurve,
}

#[cfg(feature = "serde")]
impl TryFrom<StoredCurve> for PoseCurve {
    type Error = &'static str;

    fn try_from(StoredCurve { tip, turn }: StoredCurve) -> Result<Self, Self::Error> {
        Self::new(tip, turn).ok_or("the control points make no path of a tool: other numbers of them, or no direction")
    }
}

/// Direction at a place of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CurveDirection {
    /// Both rotary axes, radians.
    Rotary(Angles),
    /// Vector of length 1 from the tip to the holder, part frame.
    Axis(Vector3<f64>),
}

/// A part of a curve on which the tool may run straight, with even turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chord {
    /// Pose at its end.
    pub end: RotaryPose,
    /// Shares of the curve at its start and its end.
    pub ends: [f64; 2],
}

impl PoseCurve {
    /// A curve by its Bezier control points, part frame, mm. `None` where their numbers differ or fit no degree from 1 to 5,
    /// where a number is not finite, or where the second point could meet the tip.
    pub fn new(tip: Vec<Vector3<f64>>, turn: TurnCurve) -> Option<Self> {
        let (count, finite) = match &turn {
            TurnCurve::Rotary(angles) => (angles.len(), angles.iter().all(|a| a.iter().all(|x| x.is_finite()))),
            TurnCurve::Second(points) => (points.len(), points.iter().all(|p| p.iter().all(|x| x.is_finite()))),
        };
        let sound = finite && tip.iter().all(|p| p.iter().all(|x| x.is_finite()));
        let curve = Self { tip, turn };
        let degree = (2..=bezier::MAX_BEZIER_DEGREE + 1).contains(&count) && count == curve.tip.len();
        (sound && degree && curve.least_length() > 0.0).then_some(curve)
    }

    /// The curve in a turned frame.
    pub fn turned(&self, rotation: &Rotation3<f64>) -> Self {
        let turned = |points: &[Vector3<f64>]| points.iter().map(|p| rotation * p).collect();
        let turn = match &self.turn {
            TurnCurve::Rotary(angles) => TurnCurve::Rotary(angles.clone()),
            TurnCurve::Second(points) => TurnCurve::Second(turned(points)),
        };
        Self { tip: turned(&self.tip), turn }
    }

    /// Degree of the polynomials.
    pub fn degree(&self) -> usize {
        self.tip.len() - 1
    }

    /// Control points of the tip, mm.
    pub fn tip(&self) -> &[Vector3<f64>] {
        &self.tip
    }

    /// Control points of the direction.
    pub fn turn(&self) -> &TurnCurve {
        &self.turn
    }

    /// Tip and direction at a parameter.
    pub fn at(&self, t: f64) -> (Point3<f64>, CurveDirection) {
        let tip = bezier::value(&self.tip, t);
        let direction = match &self.turn {
            TurnCurve::Rotary(angles) => CurveDirection::Rotary(bezier::value(angles, t).into()),
            TurnCurve::Second(points) => CurveDirection::Axis((bezier::value(points, t) - tip).normalize()),
        };
        (tip.into(), direction)
    }

    /// Pose at a parameter.
    pub fn pose(&self, chain: &Chain, t: f64) -> Pose {
        let (tip, direction) = self.at(t);
        let axis = match direction {
            CurveDirection::Rotary(angles) => chain.tool_axis(angles),
            CurveDirection::Axis(axis) => axis,
        };
        Pose { tip, axis }
    }

    /// Vectors from the tip to the second point, where there is one.
    pub fn levers(&self) -> Option<Vec<Vector3<f64>>> {
        match &self.turn {
            TurnCurve::Rotary(_) => None,
            TurnCurve::Second(points) => Some(points.iter().zip(&self.tip).map(|(h, p)| h - p).collect()),
        }
    }

    /// Lower bound of the distance between tip and second point, mm; infinite where there is no second point. All vectors
    /// between them lie in the hull of the vectors between the control points.
    pub fn least_length(&self) -> f64 {
        let Some(levers) = self.levers() else { return f64::INFINITY };
        let Some(along) = levers.iter().sum::<Vector3<f64>>().try_normalize(0.0) else { return 0.0 };
        levers.iter().map(|d| d.dot(&along)).fold(f64::INFINITY, f64::min)
    }

    /// The part between two parameters.
    #[must_use]
    pub fn part(&self, ends: [f64; 2]) -> Self {
        let turn = match &self.turn {
            TurnCurve::Rotary(angles) => TurnCurve::Rotary(bezier::part(angles, ends)),
            TurnCurve::Second(points) => TurnCurve::Second(bezier::part(points, ends)),
        };
        Self { tip: bezier::part(&self.tip, ends), turn }
    }

    /// Bounds of the second derivative of tip (mm) and tool axis (radians) by the parameter, without that of the chord itself.
    fn second_derivatives(&self) -> [f64; 2] {
        let tip = bezier::most_derivative(&self.tip, 2);
        let axis = match &self.turn {
            // The axis turns by at most the sum of both turns.
            TurnCurve::Rotary(angles) => std::f64::consts::SQRT_2 * bezier::most_derivative(angles, 2),
            TurnCurve::Second(_) => {
                let levers = self.levers().unwrap_or_default();
                let least = self.least_length();
                let [first, second] = [1, 2].map(|order| bezier::most_derivative(&levers, order) / least);
                second + 3.0 * first * first
            }
        };
        [tip, axis]
    }

    /// Chords in order, from the rotary positions `before` at the start: the curve is halved until on its chord no point of the
    /// tool axis up to a height over the tip leaves it by more than [`MAX_CHORD_ERROR_MM`]. `None` where this needs more halvings than are
    /// possible, or where no rotary positions give a direction.
    pub fn chords(&self, chain: &Chain, before: Angles, height: f64) -> Option<Vec<Chord>> {
        let mut chords: Vec<Chord> = Vec::new();
        // Parts that are not divided yet, the first at the top, with the shares of the curve and the number of halvings.
        let mut open = vec![(self.clone(), [0.0, 1.0], 0)];
        let mut at = before;
        while let Some((part, ends, halvings)) = open.pop() {
            let (tip, direction) = self.at(ends[1]);
            let rotary = match direction {
                CurveDirection::Rotary(angles) => angles,
                CurveDirection::Axis(axis) => chain.near(&axis, at)?,
            };
            let [second, turning] = part.second_derivatives();
            // On a chord the rotary axes turn evenly: this gives the axis a second derivative too.
            let turn = if part.levers().is_some() { chain.turn(at, rotary) } else { 0.0 };
            let away = second + height * (turning + chain.turning().second * turn * turn);
            if away <= 8.0 * MAX_CHORD_ERROR_MM {
                at = rotary;
                chords.push(Chord { end: RotaryPose { tip, rotary }, ends });
            } else if halvings < MAX_HALVINGS {
                let middle = 0.5 * (ends[0] + ends[1]);
                open.push((part.part([0.5, 1.0]), [middle, ends[1]], halvings + 1));
                open.push((part.part([0.0, 0.5]), [ends[0], middle], halvings + 1));
            } else {
                return None;
            }
        }
        Some(chords)
    }

    /// Whether another curve goes on from the end of this one without a corner: in the same direction of tip and turn.
    pub fn runs_on(&self, next: &Self) -> bool {
        let ends = |curve: &Self, k: usize| {
            let tip = bezier::end_derivatives(&curve.tip)[k];
            let turn = match &curve.turn {
                TurnCurve::Rotary(angles) => {
                    let rate = bezier::end_derivatives(angles)[k] * SMOOTH.1;
                    Vector3::new(rate.x, rate.y, 0.0)
                }
                TurnCurve::Second(points) => bezier::end_derivatives(points)[k],
            };
            (tip, turn)
        };
        let ((p, a), (q, b)) = (ends(self, 1), ends(next, 0));
        let speeds = [p.norm_squared() + a.norm_squared(), q.norm_squared() + b.norm_squared()].map(f64::sqrt);
        if speeds[0] <= 0.0 || speeds[1] <= 0.0 {
            return false;
        }
        let ratio = speeds[0] / speeds[1];
        ((q * ratio - p).norm_squared() + (b * ratio - a).norm_squared()).sqrt() <= SMOOTH.0 * speeds[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A curve with a second point 30 mm above the tip or with rotary axes.
    fn curve() -> impl Strategy<Value = PoseCurve> {
        let rotary = proptest::collection::vec([0.2..0.9_f64, -1.0..1.0], 4);
        let tips = proptest::collection::vec([-4.0..4.0_f64, -4.0..4.0, -4.0..4.0], 4);
        (tips, rotary, any::<bool>()).prop_map(|(tips, rotary, second)| {
            let chain = Chain::tilting_table();
            let step = |k: usize| Vector3::new(10.0 * k as f64, 0.0, 0.0);
            let tip: Vec<Vector3<f64>> =
                tips.into_iter().enumerate().map(|(k, p)| Vector3::from(p) + step(k)).collect();
            let turn = if second {
                TurnCurve::Second(tip.iter().zip(&rotary).map(|(p, r)| p + chain.tool_axis(*r) * 30.0).collect())
            } else {
                TurnCurve::Rotary(rotary.into_iter().map(Vector2::from).collect())
            };
            PoseCurve::new(tip, turn).unwrap()
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]
        /// Sampled densely, tool and chord are no farther apart than stated.
        #[test]
        fn chords_stay_at_the_curve(curve in curve()) {
            let chain = Chain::tilting_table();
            let start = curve.pose(&chain, 0.0);
            let before = match curve.at(0.0).1 {
                CurveDirection::Rotary(angles) => angles,
                CurveDirection::Axis(axis) => chain.near(&axis, [0.5, 0.0]).unwrap(),
            };
            let mut from = RotaryPose { tip: start.tip, rotary: before };
            let mut done = 0.0;
            for Chord { end, ends } in curve.chords(&chain, before, 30.0).unwrap() {
                prop_assert_eq!(ends[0], done);
                for share in [0.1, 0.35, 0.5, 0.8, 1.0] {
                    let on = from.towards(&end, share);
                    let due = curve.pose(&chain, ends[0] + (ends[1] - ends[0]) * share);
                    let gap = on.tip - due.tip;
                    let turned = (chain.tool_axis(on.rotary) - due.axis) * 30.0;
                    prop_assert!(gap.norm().max((gap + turned).norm()) <= MAX_CHORD_ERROR_MM + 1e-11);
                }
                (from, done) = (end, ends[1]);
            }
            prop_assert_eq!(done, 1.0);
        }

        #[test]
        fn halves_run_on_and_are_the_whole(curve in curve(), t in 0.2..0.8_f64) {
            let [one, two] = [curve.part([0.0, t]), curve.part([t, 1.0])];
            prop_assert!(one.runs_on(&two));
            let chain = Chain::tilting_table();
            let [a, b] = [one.pose(&chain, 0.5), curve.pose(&chain, 0.5 * t)];
            prop_assert!((a.tip - b.tip).norm() < 1e-9 && (a.axis - b.axis).norm() < 1e-9);
        }
    }

    #[test]
    fn curves_that_say_no_direction_are_refused() {
        let tip = vec![Vector3::zeros(), Vector3::x()];
        assert!(PoseCurve::new(tip.clone(), TurnCurve::Second(tip.clone())).is_none());
        assert!(PoseCurve::new(tip.clone(), TurnCurve::Second(vec![Vector3::z()])).is_none());
        assert!(PoseCurve::new(tip.clone(), TurnCurve::Rotary(vec![Vector2::new(f64::NAN, 0.0); 2])).is_none());
        assert!(PoseCurve::new(tip, TurnCurve::Rotary(vec![Vector2::zeros(); 2])).is_some());
    }
}
