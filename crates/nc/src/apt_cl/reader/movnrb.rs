//! Reader of MOVNRB: two curves of one parameter, of the tip and of a second point of the tool axis, and the same motion in GOTO for
//! post-processors that do not take curves (PTC, "CL Output for NURBS Interpolation").
//!
//! - `MOVNRB/5AXIS,LENGTH,l` begins; l is the length between both curves.
//! - `MOVNRB/ON,o,k,w,n,s`: order, number of knots, number of weights (always 0), number of control points, length of the curve.
//! - `MOVNRB/1,...` has the knots, at most 24 in a statement, `MOVNRB/2,...` control points of the tip and `MOVNRB/3,...` those of
//!   the second point, three numbers each, at most 24 points in a statement.
//! - `MOVNRB/NEXT`, the GOTO, and `MOVNRB/OFF`.
//!
//! Which of both a post-processor takes is its choice. Therefore the GOTO stand on the curve, in its order, up to its end, and no
//! chord between two of them leaves the curve by more than LINTOL.

use super::FARTHEST;
use crate::control::number;
use crate::nc::NcPose;
use five_axis::{CurveDirection, PoseCurve, TurnCurve};
use nalgebra::{Point3, Vector3};
use nurbs::bezier::{self, MAX_BEZIER_DEGREE};
use nurbs::bracket::around_minimum;
use nurbs::knots::bezier as bezier_points;

/// Most knots or control points in a statement.
const MAX_IN_STATEMENT: usize = 24;

/// Most control points of a curve: it bounds the memory.
const MAX_CONTROL_POINTS: usize = 100_000;

/// Largest distance of a pose from the curve, mm: two roundings of the words.
const ON_CURVE_MM: f64 = 1e-3;

/// Largest turn of a pose from that of the curve, radians: two roundings of the words.
const ON_CURVE_RAD: f64 = 2e-5;

/// Share by which the distance of both curves at their start, and the length of that of the tip, may differ from what is said.
const LENGTH_ERROR_SHARE: f64 = 1e-3;

/// Share by which the distance may differ along the curves: only the direction between them counts.
const DISTANCE_ERROR_SHARE: f64 = 0.1;

/// Chords by which the length of a curve is measured.
const LENGTH_CHORDS: u32 = 48;

/// Places of a curve among which the nearest one to a pose is found.
const SEARCH_STARTS: u32 = 16;

/// Steps of the search from there, each of which leaves two thirds of the range.
const SEARCH_STEPS: usize = 30;

/// Places of a chord at which it is compared with the curve.
const CHORD_SAMPLES: u32 = 8;

/// Curves that are read, from 5AXIS to OFF.
pub(super) struct Movnrb {
    /// Line in which they begin.
    pub(super) line: usize,
    length: f64,
    head: Option<Head>,
    knots: Vec<f64>,
    tip: Vec<Vector3<f64>>,
    second: Vec<Vector3<f64>>,
    follow: Option<Follow>,
    /// A statement has a fault: what follows up to OFF is not judged.
    broken: bool,
}

/// What ON says.
#[derive(Clone, Copy)]
struct Head {
    order: usize,
    knots: usize,
    points: usize,
    /// Length of the curve of the tip, mm.
    length: f64,
}

/// A place on the curves: a piece and its parameter.
#[derive(Clone, Copy)]
struct CurvePlace {
    piece: usize,
    t: f64,
}

/// The GOTO along the curves, behind NEXT.
struct Follow {
    pieces: Vec<PoseCurve>,
    /// Place of the last GOTO.
    at: CurvePlace,
}

impl Movnrb {
    /// Before the values of 5AXIS, in a line.
    pub(super) fn at(line: usize) -> Self {
        let (knots, tip, second) = (Vec::new(), Vec::new(), Vec::new());
        Self { line, length: 0.0, head: None, knots, tip, second, follow: None, broken: false }
    }

    /// The result of a step; the first fault is the only one.
    pub(super) fn judged<T: Default>(
        &mut self,
        step: impl FnOnce(&mut Self) -> Result<T, String>,
    ) -> Result<T, String> {
        if self.broken {
            return Ok(T::default());
        }
        let result = step(self);
        self.broken = result.is_err();
        result
    }

    /// Takes the values of 5AXIS.
    ///
    /// # Errors
    /// What is wrong with them.
    pub(super) fn begin(&mut self, values: &[&str]) -> Result<(), String> {
        match values {
            ["5AXIS", "LENGTH", length] => {
                let length = number(length)?;
                if !(length > 0.0 && length <= FARTHEST) {
                    return Err(format!("LENGTH {length} is out of range: more than 0, at most {FARTHEST:.0}"));
                }
                self.length = length;
                Ok(())
            }
            ["M3AXIS" | "3AXIS", ..] => {
                Err("a curve of the tip alone says no direction of the tool: write MOVNRB/5AXIS,LENGTH and a length"
                    .to_owned())
            }
            _ => Err("MOVNRB begins by MOVNRB/5AXIS,LENGTH and the length between both curves".to_owned()),
        }
    }

    /// Breaks the motion off; false where a fault broke it before.
    pub(super) fn breaks(&mut self) -> bool {
        !std::mem::replace(&mut self.broken, true)
    }

    /// Whether NEXT was read.
    pub(super) fn follows(&self) -> bool {
        self.follow.is_some()
    }

    /// Takes the values of a statement before NEXT.
    ///
    /// # Errors
    /// What is wrong with them.
    pub(super) fn take(&mut self, values: &[&str]) -> Result<(), String> {
        if self.follow.is_some() {
            return Err("behind MOVNRB/NEXT stand GOTO and MOVNRB/OFF".to_owned());
        }
        match (values, self.head) {
            (["ON", rest @ ..], None) => {
                self.head = Some(head(rest)?);
                Ok(())
            }
            (["ON", ..], Some(_)) => Err("a second MOVNRB/ON of one motion".to_owned()),
            (_, None) => Err("MOVNRB/ON stands behind MOVNRB/5AXIS".to_owned()),
            (["1", rest @ ..], Some(head)) => {
                if rest.len() > MAX_IN_STATEMENT || self.knots.len() + rest.len() > head.knots {
                    return Err(format!(
                        "more knots than {MAX_IN_STATEMENT} in a statement, or than {} in all",
                        head.knots
                    ));
                }
                for text in rest {
                    self.knots.push(number(text)?);
                }
                Ok(())
            }
            (["2", rest @ ..], Some(head)) => points(&mut self.tip, rest, head.points),
            (["3", rest @ ..], Some(head)) => points(&mut self.second, rest, head.points),
            _ => Err("MOVNRB is followed by ON, 1, 2, 3, NEXT or OFF".to_owned()),
        }
    }

    /// The curves piece by piece, from where the tool stands, where this is known.
    ///
    /// # Errors
    /// A statement is missing, or the curve starts elsewhere.
    pub(super) fn next(&mut self, from: Option<NcPose>) -> Result<Vec<PoseCurve>, String> {
        let Some(head) = self.head else { return Err("MOVNRB/NEXT before MOVNRB/ON".to_owned()) };
        for (what, found, due) in [
            ("knots", self.knots.len(), head.knots),
            ("control points of the tip", self.tip.len(), head.points),
            ("control points of the second point", self.second.len(), head.points),
        ] {
            if found != due {
                return Err(format!("MOVNRB/ON says {due} {what}; {found} stand before MOVNRB/NEXT"));
            }
        }
        check_knots(&self.knots, head)?;
        let pieces: Option<Vec<PoseCurve>> = spans(&self.knots, head.order)
            .map(|span| {
                let piece =
                    |points: &[Vector3<f64>]| bezier_points(&self.knots, &points[span + 1 - head.order..=span], span);
                PoseCurve::new(piece(&self.tip), TurnCurve::Second(piece(&self.second)))
            })
            .collect();
        let Some(pieces) = pieces.filter(|pieces| !pieces.is_empty()) else {
            return Err("both curves give no direction of the tool: the second point meets the tip".to_owned());
        };
        let distance = |piece: &PoseCurve| {
            let levers = piece.levers().unwrap_or_default();
            let at =
                (0..=CHORD_SAMPLES).map(|k| bezier::value(&levers, f64::from(k) / f64::from(CHORD_SAMPLES)).norm());
            at.map(|length| (length / self.length - 1.0).abs()).fold(0.0, f64::max)
        };
        let at_start = self.second[0] - self.tip[0];
        let start_off = (at_start.norm() / self.length - 1.0).abs();
        if start_off > LENGTH_ERROR_SHARE || pieces.iter().map(distance).any(|off| off > DISTANCE_ERROR_SHARE) {
            return Err(format!("both curves are not {} mm apart, which LENGTH says", self.length));
        }
        let long: f64 = pieces.iter().map(way).sum();
        if (long - head.length).abs() > LENGTH_ERROR_SHARE * long + ON_CURVE_MM {
            return Err(format!("the curve of the tip is {long:.3} mm long, and MOVNRB/ON says {:.3} mm", head.length));
        }
        if let Some(from) = from {
            let (tip, axis) = pose(&pieces[0], 0.0);
            let (off, turned) = ((tip - from.tip).norm(), axis.angle(&from.axis));
            if off > ON_CURVE_MM || turned > ON_CURVE_RAD {
                return Err(format!(
                    "the curve begins {off:.4} mm and {:.4} deg away from where the tool stands",
                    turned.to_degrees()
                ));
            }
        }
        self.follow = Some(Follow { pieces: pieces.clone(), at: CurvePlace { piece: 0, t: 0.0 } });
        Ok(pieces)
    }

    /// Follows the curve to a pose; chords may leave it by the tolerance, mm.
    ///
    /// # Errors
    /// A pose off the curve, or behind the last one, or a chord too far from the curve.
    pub(super) fn goto(&mut self, to: &NcPose, tolerance: f64) -> Result<(), String> {
        match &mut self.follow {
            Some(follow) => follow.goto(to, tolerance),
            None => Err("GOTO between MOVNRB/5AXIS and MOVNRB/NEXT: write the curves first".to_owned()),
        }
    }

    /// Ends at OFF.
    ///
    /// # Errors
    /// Curves without GOTO up to their end.
    pub(super) fn end(&self) -> Result<(), String> {
        let Some(Follow { pieces, at }) = &self.follow else {
            return Err("MOVNRB/OFF before MOVNRB/NEXT".to_owned());
        };
        let (tip, _) = pose(&pieces[at.piece], at.t);
        let gap = (tip - pose(&pieces[pieces.len() - 1], 1.0).0).norm();
        if at.piece + 1 < pieces.len() || gap > ON_CURVE_MM {
            return Err(format!("the last GOTO stands {gap:.4} mm before the end of the curve"));
        }
        Ok(())
    }
}

impl Follow {
    fn goto(&mut self, to: &NcPose, tolerance: f64) -> Result<(), String> {
        let CurvePlace { piece: first, t: from } = self.at;
        let mut least = (f64::INFINITY, 0.0);
        for (index, piece) in self.pieces.iter().enumerate().skip(first) {
            let start = if index == first { from } else { 0.0 };
            let t = nearest(piece, start, &to.tip);
            let (tip, axis) = pose(piece, t);
            let (off, turned) = ((tip - to.tip).norm(), axis.angle(&to.axis));
            if off < least.0 {
                least = (off, turned);
            }
            if off <= ON_CURVE_MM && turned <= ON_CURVE_RAD {
                let place = CurvePlace { piece: index, t };
                let away = self.chord(place);
                self.at = place;
                if away > tolerance {
                    return Err(format!(
                        "the straight way of this GOTO leaves the curve by {away:.4} mm, over LINTOL: write more GOTO along the curve"
                    ));
                }
                return Ok(());
            }
        }
        Err(format!(
            "this pose is {:.4} mm and {:.4} deg beside what is left of the curve: post-processors that take GOTO would go elsewhere",
            least.0,
            least.1.to_degrees()
        ))
    }

    /// Largest distance of the tip on the curve, from the last GOTO to a place, from the straight way, mm.
    fn chord(&self, to: CurvePlace) -> f64 {
        let [a, b] = [self.at, to].map(|place| pose(&self.pieces[place.piece], place.t).0);
        let way = b - a;
        let mut most = 0.0_f64;
        for index in self.at.piece..=to.piece {
            let from = if index == self.at.piece { self.at.t } else { 0.0 };
            let end = if index == to.piece { to.t } else { 1.0 };
            for k in 1..=CHORD_SAMPLES {
                let t = from + (end - from) * f64::from(k) / f64::from(CHORD_SAMPLES);
                let gap = pose(&self.pieces[index], t).0 - a;
                let share =
                    if way.norm_squared() > 0.0 { (gap.dot(&way) / way.norm_squared()).clamp(0.0, 1.0) } else { 0.0 };
                most = most.max((gap - way * share).norm());
            }
        }
        most
    }
}

/// Tip and axis of a piece at a parameter.
fn pose(piece: &PoseCurve, t: f64) -> (Point3<f64>, Vector3<f64>) {
    match piece.at(t) {
        (tip, CurveDirection::Axis(axis)) => (tip, axis),
        (tip, CurveDirection::Rotary(_)) => (tip, Vector3::z()),
    }
}

/// Length of a piece of the curve of the tip, mm.
fn way(piece: &PoseCurve) -> f64 {
    let at = |k: u32| pose(piece, f64::from(k) / f64::from(LENGTH_CHORDS)).0;
    (0..LENGTH_CHORDS).map(|k| (at(k + 1) - at(k)).norm()).sum()
}

/// Parameter from `from` to 1 at which a piece is nearest to a point.
fn nearest(piece: &PoseCurve, from: f64, to: &Point3<f64>) -> f64 {
    let far = |t: f64| (pose(piece, t).0 - to).norm_squared();
    let step = (1.0 - from) / f64::from(SEARCH_STARTS);
    let best = (0..=SEARCH_STARTS)
        .map(|k| from + step * f64::from(k))
        .min_by(|a, b| far(*a).total_cmp(&far(*b)))
        .unwrap_or(from);
    let [low, high] = around_minimum([(best - step).max(from), (best + step).min(1.0)], SEARCH_STEPS, far);
    // The ends of a piece are joints with the next one.
    let middle = 0.5 * (low + high);
    [low, high, middle].into_iter().min_by(|a, b| far(*a).total_cmp(&far(*b))).unwrap_or(middle)
}

fn head(values: &[&str]) -> Result<Head, String> {
    let [order, knots, weights, points, length] = values else {
        return Err("MOVNRB/ON has order, knots, weights, control points and length".to_owned());
    };
    let count = |text: &str| {
        let value = number(text)?;
        let fits = value.fract() == 0.0 && (0.0..=2.0 * MAX_CONTROL_POINTS as f64).contains(&value);
        if fits { Ok(value as usize) } else { Err(format!("MOVNRB/ON: {value} is no number of knots or points")) }
    };
    let (order, knots, weights, points) = (count(order)?, count(knots)?, count(weights)?, count(points)?);
    let length = number(length)?;
    if weights != 0 {
        return Err("MOVNRB/ON with weights: the number of weights is 0".to_owned());
    }
    if !(2..=MAX_BEZIER_DEGREE + 1).contains(&order) {
        return Err(format!("MOVNRB/ON: the order {order} is not from 2 to {}", MAX_BEZIER_DEGREE + 1));
    }
    if points < order || points > MAX_CONTROL_POINTS || knots != points + order {
        return Err(format!("MOVNRB/ON: {points} control points of order {order} have {} knots", points + order));
    }
    if length.is_nan() || length < 0.0 {
        return Err(format!("MOVNRB/ON: {length} is no length"));
    }
    Ok(Head { order, knots, points, length })
}

fn points(list: &mut Vec<Vector3<f64>>, values: &[&str], most: usize) -> Result<(), String> {
    if values.is_empty() || !values.len().is_multiple_of(3) || values.len() > 3 * MAX_IN_STATEMENT {
        return Err(format!(
            "MOVNRB/2 and MOVNRB/3 have x, y and z of at most {MAX_IN_STATEMENT} points, not {} numbers",
            values.len()
        ));
    }
    for point in values.chunks(3) {
        let mut place = Vector3::zeros();
        for (k, text) in point.iter().enumerate() {
            place[k] = number(text)?;
            if place[k].abs() > FARTHEST {
                return Err(format!("{} is out of range: at most {FARTHEST:.0}", place[k]));
            }
        }
        list.push(place);
    }
    if list.len() > most {
        return Err(format!("more than the {most} control points that MOVNRB/ON says"));
    }
    Ok(())
}

/// Knots ascend, the first and the last stand as often as the order says, and no other as often: there the curve would break.
fn check_knots(knots: &[f64], Head { order, .. }: Head) -> Result<(), String> {
    let ascend = knots.windows(2).all(|pair| pair[0] <= pair[1]);
    let (first, last) = (knots[0], knots[knots.len() - 1]);
    let times = |value: f64| knots.iter().filter(|k| **k == value).count();
    if !ascend || first == last || times(first) != order || times(last) != order {
        return Err(format!(
            "the knots must ascend, and the first and the last stand {order} times: the curve begins and ends at its control points"
        ));
    }
    if knots.windows(order).any(|same| same[0] == same[order - 1] && same[0] != first && same[0] != last) {
        return Err(format!("a knot between stands {order} times: the curve breaks there"));
    }
    Ok(())
}

/// Index of the knot at the start of each span that is not empty.
fn spans(knots: &[f64], order: usize) -> impl Iterator<Item = usize> + '_ {
    (order - 1..knots.len() - order).filter(|k| knots[*k] < knots[k + 1])
}
