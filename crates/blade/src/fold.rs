//! Where a loop folds: its noses at the leading and at the trailing edge.
//!
//! A blade is thin. Where its loop is cut at the two noses, both halves lie close to each other all along. So the noses are
//! the two points for which the halves, each walked with equal shares of its length, are nearest to each other on the mean.
//! This asks neither where the loop begins nor how the blade is bent. It is found on points with even steps, and then made
//! sharper: near each of the two, the nose is the centre of the turns of that part of the loop which turns the most over a
//! length of five quarters of the thickness of the blade.

use super::ring::Ring;
use nalgebra::Point3;
use nurbs::chords::from_chords;

/// Points with even steps that stand for the loop in the search.
const LOOP_POINTS: usize = 128;

/// Places at which both halves are compared.
const COMPARED_PLACES: usize = 24;

/// Fewest steps of a half, as a share of the loop: blades have faces of about equal length.
const SHORTEST: usize = LOOP_POINTS / 4;

/// The noses of a loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fold {
    /// Points of the loop.
    pub(super) noses: [usize; 2],
    /// Largest thickness between the halves, mm, about.
    pub(super) thickness: f64,
}

/// Finds the noses of a loop with length.
pub(super) fn fold(ring: &Ring) -> Fold {
    let step = ring.length() / LOOP_POINTS as f64;
    let even: Vec<Point3<f64>> = (0..LOOP_POINTS).map(|k| ring.at(k as f64 * step)).collect();
    let mut best = (f64::INFINITY, [0, LOOP_POINTS / 2]);
    for i in 0..LOOP_POINTS {
        for j in i + SHORTEST..=(i + LOOP_POINTS - SHORTEST).min(LOOP_POINTS - 1) {
            let distance = between_halves(&even, [i, j]);
            if distance < best.0 {
                best = (distance, [i, j]);
            }
        }
    }
    let coarse = best.1;
    let thickness = thickness(&even, coarse);
    let noses = coarse.map(|k| nose(ring, k as f64 * step, 2.0 * step, 1.25 * thickness));
    Fold { noses, thickness }
}

/// Mean distance of both halves at equal shares of their lengths.
fn between_halves(even: &[Point3<f64>], [i, j]: [usize; 2]) -> f64 {
    let (there, back) = ((j - i) as f64, (LOOP_POINTS - (j - i)) as f64);
    let at = |k: f64| {
        let k = k.rem_euclid(LOOP_POINTS as f64);
        let whole = libm::floor(k);
        let (a, b) = (whole as usize % LOOP_POINTS, (whole as usize + 1) % LOOP_POINTS);
        even[a] + (even[b] - even[a]) * (k - whole)
    };
    let distance = |k: usize| {
        let share = k as f64 / COMPARED_PLACES as f64;
        nalgebra::distance(&at(i as f64 + share * there), &at(i as f64 - share * back))
    };
    (1..COMPARED_PLACES).map(distance).sum::<f64>() / (COMPARED_PLACES - 1) as f64
}

/// Largest of the least distances from one half to the other, mm.
fn thickness(even: &[Point3<f64>], [i, j]: [usize; 2]) -> f64 {
    let other: Vec<Point3<f64>> = (j..=i + LOOP_POINTS).map(|k| even[k % LOOP_POINTS]).collect();
    even[i..=j].iter().map(|p| from_chords(p, &other)).fold(0.0, f64::max)
}

/// The nose near a distance along the loop: the centre of the turns of the window that turns the most.
fn nose(ring: &Ring, near: f64, reach: f64, window: f64) -> usize {
    let n = ring.len();
    let first = ring.nearest(near - reach - window);
    let last = ring.nearest(near + reach + window);
    let count = (last + n - first) % n;
    let places: Vec<usize> = (0..=count).map(|k| (first + k) % n).collect();
    let mut most = (0.0, 0, 0);
    let (mut end, mut turn) = (0, 0.0);
    for begin in 0..places.len() {
        while end < places.len() && ring.between(places[begin], places[end]) <= window {
            turn += ring.turns[places[end]];
            end += 1;
        }
        if turn > most.0 + 1e-9 {
            most = (turn, begin, end);
        }
        turn -= ring.turns[places[begin]];
    }
    let (turn, begin, end) = most;
    if turn <= 0.0 {
        return ring.nearest(near);
    }
    let from = places[begin];
    let moment: f64 = places[begin..end].iter().map(|k| ring.turns[*k] * ring.between(from, *k)).sum();
    ring.nearest(ring.along[from] + moment / turn)
}
