//! Cubic splines through several rows of points, one a row, on common knots: the curves of a lofted surface.
//!
//! Each spline has the least sum of squared distances to its points (Piegl and Tiller, The NURBS Book, 9.4.1). A span of the
//! knots in which a row is out of tolerance is halved. Where a row has no point in a span, its spline goes on smoothly: the
//! second differences of control points count a little, as in penalised splines (Eilers and Marx 1996). Rows are open, from
//! their first to their last point, or closed.

use super::NurbsCurve;
use super::basis::MAX_DEGREE;
use super::knots::clamped;
use super::least_squares::SoughtSpline;
use nalgebra::{Point3, Vector3, Vector4};
use rayon::prelude::*;

/// Degree of the splines.
const DEGREE: usize = MAX_DEGREE;

/// Judged points of a row in a span at the start, on average: a spline with fewer control points smooths noise.
const POINTS_A_SPAN: usize = 8;

/// Weight of the squared second differences of control points, against the squared distances of points. At a nose with a radius
/// of 1 mm and control points every 0.2 mm it moves the curve by less than a nanometre.
const SMOOTH: f64 = 1e-7;

/// Spans, at most.
const MAX_SPANS: usize = 400;

/// Spans are halved down to this part of the tolerance, to compare fits.
const HALVED_TOLERANCE: f64 = 32.0;

/// Places of a span at which directions are compared.
const SPAN_PLACES: usize = 6;

/// Turn that is worth more knots, rad: a wave 1 mm long and 0.01 um high adds 2e-4.
const LESS_TURN: f64 = 1e-4;

/// Rounds in which each parameter is moved to the foot of its point.
const CORRECTIONS: usize = 4;

/// Points of a row with their parameters on [0, 1], ascending. A closed row does not repeat its first point, and its last
/// parameter is below 1.
#[derive(Clone, Debug)]
pub struct Row {
    /// Points, mm.
    pub points: Vec<Point3<f64>>,
    /// Their parameters.
    pub parameters: Vec<f64>,
    /// Whether each is a point that the spline must meet within the tolerance. The others lead it between those.
    pub judged: Vec<bool>,
}

impl Row {
    /// Number of points that the spline must meet.
    fn judged(&self) -> usize {
        self.judged.iter().filter(|judged| **judged).count()
    }
}

/// Control points of a row, with the parameter and the distance of the foot of each of its points.
type Curve = (Vec<Vector3<f64>>, Vec<(f64, f64)>);

/// The splines of all rows.
#[derive(Clone, Debug)]
pub struct RowFit {
    closed: bool,
    /// Knots, clamped for open rows, periodic for closed ones; the domain is [0, 1].
    knots: Vec<f64>,
    /// Control points by row.
    control: Vec<Vec<Vector3<f64>>>,
    /// Largest distance of a judged point of each row to its spline, with the index of the point.
    pub residuals: Vec<(f64, usize)>,
    /// Sum of the turns along all rows, rad.
    turn: f64,
}

/// Splines on common knots through rows, each within `tolerance` of all its judged points where the points allow it: else with the
/// residuals that remain. Of the fits within the tolerance the one is taken that turns least: too few knots make waves beside a
/// nose, and too many follow the noise of the points.
///
/// `None` for rows with fewer than four points, or parameters that do not ascend.
pub fn fit_rows(rows: &[Row], closed: bool, tolerance: f64) -> Option<RowFit> {
    let ascends = |row: &Row| {
        row.points.len() == row.parameters.len()
            && row.points.len() == row.judged.len()
            && row.points.len() > DEGREE
            && row.parameters.windows(2).all(|pair| pair[0] < pair[1])
            && row.points.iter().all(|p| p.coords.iter().all(|x| x.is_finite()))
            && row.parameters[0] >= 0.0
            && row.parameters.last().is_some_and(|last| if closed { *last < 1.0 } else { *last <= 1.0 })
    };
    if rows.is_empty() || !rows.iter().all(ascends) {
        return None;
    }
    let mut all: Vec<f64> = rows.iter().flat_map(|row| row.parameters.iter().copied()).collect();
    all.sort_by(f64::total_cmp);
    let least = rows.iter().map(Row::judged).min().unwrap_or(0);
    let mut inner = start(&all, least, closed);
    let mut best: Option<RowFit> = None;
    loop {
        let Some(found) = RowFit::on(rows, closed, &inner) else {
            return best;
        };
        // For the tolerance two points of all rows are enough: fewer say nothing of the curve between them. A row without
        // points in a half may turn there, so that for less than the tolerance each row has two.
        let needed = found.failing(&inner, tolerance, |row, i| rows[row].judged[i]);
        let finer = found
            .failing(&inner, tolerance / HALVED_TOLERANCE, |_, _| true)
            .into_iter()
            .filter(|span| !needed.contains(span));
        let finer = finer.filter_map(|span| halving(rows, span, |points| points.iter().all(|n| *n >= 2)));
        let halves: Vec<f64> = needed
            .iter()
            .filter_map(|span| halving(rows, *span, |points| points.iter().sum::<usize>() >= 2))
            .chain(finer)
            .collect();
        if best.as_ref().is_none_or(|best| found.fit.is_better(best, tolerance)) {
            best = Some(found.fit);
        }
        if halves.is_empty() || inner.len() + halves.len() > MAX_SPANS {
            return best;
        }
        inner.extend(halves);
        inner.sort_by(f64::total_cmp);
    }
}

/// Inner knots at the start: with equal numbers of points between them, over all rows.
fn start(all: &[f64], least: usize, closed: bool) -> Vec<f64> {
    let spans = (least / POINTS_A_SPAN).clamp(if closed { DEGREE + 1 } else { 1 }, MAX_SPANS / 4);
    let at = |k: usize| {
        let i = (k * all.len() / spans).clamp(1, all.len() - 1);
        0.5 * (all[i - 1] + all[i])
    };
    let mut inner: Vec<f64> = (1..spans).map(at).filter(|u| *u > 0.0 && *u < 1.0).collect();
    inner.dedup();
    inner
}

/// Parameter that halves a span; `None` where the numbers of points of the rows in a half are not enough.
fn halving(rows: &[Row], [from, to]: [f64; 2], enough: impl Fn(&[usize]) -> bool) -> Option<f64> {
    let middle = 0.5 * (from + to);
    let points = |from: f64, to: f64| -> Vec<usize> {
        let within = |at: &[f64]| at.partition_point(|u| *u < to) - at.partition_point(|u| *u <= from);
        rows.iter().map(|row| within(&row.parameters)).collect()
    };
    (enough(&points(from, middle)) && enough(&points(middle, to))).then_some(middle)
}

/// A fit with the errors of its points.
struct JudgedFit {
    fit: RowFit,
    /// Parameter of the foot of each point, and the distance, by row.
    feet: Vec<Vec<(f64, f64)>>,
}

impl JudgedFit {
    /// Spans with a point out of tolerance, of those that count: by row and index.
    fn failing(&self, inner: &[f64], tolerance: f64, counts: impl Fn(usize, usize) -> bool) -> Vec<[f64; 2]> {
        let mut ends = vec![0.0];
        ends.extend_from_slice(inner);
        ends.push(1.0);
        let mut fails = vec![false; ends.len() - 1];
        for (row, feet) in self.feet.iter().enumerate() {
            for (i, (u, distance)) in feet.iter().enumerate() {
                if *distance > tolerance && counts(row, i) {
                    fails[ends.partition_point(|e| e <= u).clamp(1, ends.len() - 1) - 1] = true;
                }
            }
        }
        ends.windows(2).zip(fails).filter(|(_, fails)| *fails).map(|(span, _)| [span[0], span[1]]).collect()
    }
}

impl RowFit {
    fn on(rows: &[Row], closed: bool, inner: &[f64]) -> Option<JudgedFit> {
        let knots = if closed { periodic(inner) } else { clamped([0.0, 1.0], inner.iter().copied(), DEGREE) };
        let mut fit = Self { closed, knots, control: Vec::new(), residuals: Vec::new(), turn: 0.0 };
        let mut feet = Vec::new();
        let curves: Vec<Option<Curve>> = rows.par_iter().map(|row| fit.through(row)).collect();
        for (row, curve) in rows.iter().zip(curves) {
            let (control, found) = curve?;
            let judged = found.iter().enumerate().filter(|(i, _)| row.judged[*i]);
            let worst = judged.fold((0.0, 0), |w, (i, (_, d))| if *d > w.0 { (*d, i) } else { w });
            fit.control.push(control);
            fit.residuals.push(worst);
            feet.push(found);
        }
        fit.turn = fit.turn_of_all();
        Some(JudgedFit { fit, feet })
    }

    /// True for the smaller residual where one is out of tolerance, else for the one that turns less.
    fn is_better(&self, than: &Self, tolerance: f64) -> bool {
        if self.worst().max(than.worst()) > tolerance {
            return self.worst() < than.worst();
        }
        self.turn < than.turn - LESS_TURN
    }

    /// Sum of the turns of the tangents along all rows, without signs, rad. It does not depend on how sharp a nose is, and each
    /// wave adds to it.
    fn turn_of_all(&self) -> f64 {
        let domain = &self.knots[DEGREE..self.knots.len() - DEGREE];
        let along = |curve: &NurbsCurve| {
            let places = domain.windows(2).flat_map(|span| {
                let step = (span[1] - span[0]) / SPAN_PLACES as f64;
                (0..SPAN_PLACES).map(move |k| span[0] + step * (k as f64 + 0.5))
            });
            let tangents: Vec<Vector3<f64>> = places.map(|u| curve.derivatives(u).first).collect();
            tangents
                .windows(2)
                .map(|pair| libm::atan2(pair[0].cross(&pair[1]).norm(), pair[0].dot(&pair[1])))
                .sum::<f64>()
        };
        let turns: Vec<f64> = self.control.par_iter().map(|control| along(&self.curve(control))).collect();
        turns.into_iter().sum()
    }

    /// Largest distance of a judged point to its spline, mm.
    pub fn worst(&self) -> f64 {
        self.residuals.iter().map(|r| r.0).fold(0.0, f64::max)
    }

    /// Control points of a row, with the parameter and the distance of the foot of each point.
    fn through(&self, row: &Row) -> Option<Curve> {
        let mut at = row.parameters.clone();
        let mut best: Option<Curve> = None;
        for _ in 0..=CORRECTIONS {
            let Some(control) = self.least_squares(row, &at) else { break };
            let curve = self.curve(&control);
            let feet: Vec<(f64, f64)> = self.feet(&curve, &row.points, &at);
            let largest = |feet: &[(f64, f64)]| feet.iter().map(|f| f.1).fold(0.0, f64::max);
            if best.as_ref().is_none_or(|b| largest(&feet) < largest(&b.1)) {
                best = Some((control, feet.clone()));
            }
            at = feet.iter().map(|f| f.0).collect();
            // The ends of an open row stay where they are.
            if !self.closed {
                (at[0], at[row.points.len() - 1]) = (row.parameters[0], row.parameters[row.points.len() - 1]);
            }
            if at.windows(2).any(|pair| pair[0] >= pair[1]) {
                break;
            }
        }
        best
    }

    /// Control points of the spline nearest to the points of a row at parameters. An open one begins and ends at the ends of its row.
    fn least_squares(&self, row: &Row, at: &[f64]) -> Option<Vec<Vector3<f64>>> {
        let ends = (!self.closed).then(|| [row.points[0].coords, row.points[row.points.len() - 1].coords]);
        let sought = SoughtSpline { knots: &self.knots, degree: DEGREE, closed: self.closed, ends, smoothing: SMOOTH };
        sought.nearest_to(row.points.iter().map(|p| p.coords), at.iter().copied())
    }

    /// Parameters of the feet of points near `at`, by Newton's method, and their distances. All points take a step before any takes the
    /// next one: the steps of one point wait for each other, those of different points do not.
    fn feet(&self, curve: &NurbsCurve, points: &[Point3<f64>], at: &[f64]) -> Vec<(f64, f64)> {
        /// Steps of a point.
        const STEPS: usize = 6;
        // What lies inside takes no division.
        let inside = |u: f64| match self.closed {
            true if !(0.0..1.0).contains(&u) => u.rem_euclid(1.0),
            true => u,
            false => u.clamp(0.0, 1.0),
        };
        let mut feet: Vec<(f64, f64)> = at.iter().map(|u| (*u, f64::INFINITY)).collect();
        // Where each point is, and where it was a step ago.
        let mut places: Vec<[f64; 2]> = at.iter().map(|u| [*u, f64::NAN]).collect();
        let mut moving: Vec<usize> = (0..points.len()).collect();
        for _ in 0..STEPS {
            let mut span = DEGREE;
            moving.retain(|i| {
                let [here, before] = places[*i];
                let d = curve.next_derivatives(here, &mut span);
                let gap = d.point - points[*i];
                if gap.norm() < feet[*i].1 {
                    feet[*i] = (here, gap.norm());
                }
                let slope = d.first.norm_squared() + gap.dot(&d.second);
                let next = inside(here - gap.dot(&d.first) / slope);
                places[*i] = [next, here];
                // Back where it was, a point would go on between two places.
                slope > 0.0 && next != here && next != before
            });
        }
        feet
    }

    /// The spline of a row; the knots of a closed one are not clamped.
    fn curve(&self, control: &[Vector3<f64>]) -> NurbsCurve {
        let repeated = if self.closed { DEGREE } else { 0 };
        let round = control.iter().cycle().take(control.len() + repeated);
        NurbsCurve::from_homogeneous(DEGREE, self.knots.clone(), round.map(|c| c.push(1.0)).collect())
    }

    /// The part of a row between two parameters as a curve on [0, 1]; from the second parameter to the first when `back`.
    /// On a closed row the second parameter may be greater than 1 by less than the first.
    pub fn piece(&self, row: usize, [from, to]: [f64; 2], back: bool) -> NurbsCurve {
        let spline = self.curve(&self.control[row]);
        let turns = |u: f64| if self.closed { u.floor() } else { 0.0 };
        let domain = &self.knots[DEGREE..self.knots.len() - DEGREE];
        let whole = turns(from) as i32..=turns(to) as i32;
        let mut inner: Vec<f64> = whole.flat_map(|n| domain.iter().map(move |k| k + f64::from(n))).collect();
        inner.retain(|k| *k > from && *k < to);
        inner.dedup();
        let knots = clamped([from, to], inner, DEGREE);
        let point = |i: usize| {
            // A span under the basis function of the control point that is not empty.
            let k = (i..=i + DEGREE).find(|k| knots[*k] < knots[k + 1]).unwrap_or(i);
            let middle = 0.5 * (knots[k] + knots[k + 1]);
            let shift = turns(middle);
            let arguments: [f64; DEGREE] = std::array::from_fn(|j| knots[i + 1 + j] - shift);
            spline.blossom(&arguments, middle - shift)
        };
        let mut control: Vec<Vector4<f64>> = (0..knots.len() - DEGREE - 1).map(point).collect();
        let mut knots: Vec<f64> = knots.iter().map(|u| (u - from) / (to - from)).collect();
        if back {
            knots = knots.iter().rev().map(|u| 1.0 - u).collect();
            control.reverse();
        }
        let last = knots.len() - DEGREE - 1;
        knots[..=DEGREE].fill(0.0);
        knots[last..].fill(1.0);
        NurbsCurve::from_homogeneous(DEGREE, knots, control)
    }
}

/// Knots that go on before 0 and beyond 1 as they stand at the other end.
fn periodic(inner: &[f64]) -> Vec<f64> {
    let mut round = vec![0.0];
    round.extend_from_slice(inner);
    let n = round.len();
    let at = |i: i64| round[i.rem_euclid(n as i64) as usize] + i.div_euclid(n as i64) as f64;
    (-(DEGREE as i64)..=(n + DEGREE) as i64).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn ellipse(count: usize, closed: bool, height: f64) -> Row {
        let last = if closed { count } else { count - 1 };
        let parameters: Vec<f64> = (0..count).map(|i| i as f64 / last as f64).collect();
        let points =
            parameters.iter().map(|u| Point3::new(30.0 * (TAU * u).cos(), 4.0 * (TAU * u).sin(), height)).collect();
        Row { points, parameters, judged: vec![true; count] }
    }

    #[test]
    fn closed_and_open_rows_are_within_tolerance() {
        for closed in [true, false] {
            let rows = [ellipse(240, closed, 0.0), ellipse(300, closed, 5.0)];
            let fit = fit_rows(&rows, closed, 1e-3).expect("rows");
            assert!(fit.worst() <= 1e-3, "{}", fit.worst());
        }
    }

    /// Pieces that divide a closed row give the same points as the row, and meet with the same tangent and curvature.
    #[test]
    fn pieces_are_the_row() {
        let fit = fit_rows(&[ellipse(240, true, 1.0)], true, 1e-3).expect("rows");
        let whole = fit.curve(&fit.control[0]);
        let joints = [0.0, 0.11, 0.52, 0.6, 1.0];
        for pair in joints.windows(2) {
            let [curve, reversed] = [false, true].map(|back| fit.piece(0, [pair[0], pair[1]], back));
            for i in 0..=40 {
                let t = f64::from(i) / 40.0;
                let expected = whole.point((pair[0] + (pair[1] - pair[0]) * t).min(1.0 - 1e-15));
                assert!((curve.point(t) - expected).norm() < 1e-11, "{t}");
                assert!((reversed.point(1.0 - t) - expected).norm() < 1e-11, "{t}");
            }
        }
        let across = fit.piece(0, [0.9, 1.2], false);
        assert!((across.point(1.0 / 3.0) - whole.point(0.0)).norm() < 1e-11);
    }

    /// Noise of 10 um is smoothed: with a tolerance above it the spline lies nearer to the true curve than the points.
    #[test]
    fn noise_is_smoothed() {
        let mut row = ellipse(400, true, 0.0);
        let clean = row.points.clone();
        for (i, p) in row.points.iter_mut().enumerate() {
            p.x += 0.01 * libm::sin(i as f64 * 12.9898);
            p.y += 0.01 * libm::sin(i as f64 * 78.233);
        }
        let fit = fit_rows(&[row.clone()], true, 0.03).expect("rows");
        let whole = fit.curve(&fit.control[0]);
        let error = |k: usize| (whole.point(row.parameters[k]) - clean[k]).norm();
        let mean = (0..400).map(error).sum::<f64>() / 400.0;
        assert!(mean < 0.006, "{mean}");
    }

    #[test]
    fn rows_that_cannot_be_fitted() {
        let mut row = ellipse(20, true, 0.0);
        row.parameters.swap(3, 4);
        assert!(fit_rows(&[row], true, 1e-3).is_none());
        assert!(fit_rows(&[ellipse(3, true, 0.0)], true, 1e-3).is_none());
        assert!(fit_rows(&[], true, 1e-3).is_none());
    }
}
