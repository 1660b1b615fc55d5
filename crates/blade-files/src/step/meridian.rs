//! Meridians of surfaces of revolution about Z.

use nalgebra::{Point3, Vector2};

/// A meridian as a dense line of points (r, z), mm.
#[derive(Clone, Debug)]
pub(super) struct StepMeridian {
    points: Vec<Vector2<f64>>,
    lengths: Vec<f64>,
}

/// Radius and height of a point.
pub(super) fn flat(p: &Point3<f64>) -> Vector2<f64> {
    Vector2::new(libm::hypot(p.x, p.y), p.z)
}

impl StepMeridian {
    /// The meridian through points; `None` without length.
    pub(super) fn new(points: Vec<Vector2<f64>>) -> Option<Self> {
        let mut kept: Vec<Vector2<f64>> = Vec::with_capacity(points.len());
        let mut lengths: Vec<f64> = Vec::with_capacity(points.len());
        for p in points {
            match kept.last() {
                None => lengths.push(0.0),
                // A ring of a turned face stays at one place.
                Some(last) if (p - last).norm() < 1e-9 => continue,
                Some(last) => lengths.push(lengths[lengths.len() - 1] + (p - last).norm()),
            }
            kept.push(p);
        }
        (kept.len() >= 2).then_some(Self { points: kept, lengths })
    }

    pub(super) fn length(&self) -> f64 {
        self.lengths.last().copied().unwrap_or(0.0)
    }

    /// Length from the start to the nearest place of the meridian, and the distance from it.
    pub(super) fn nearest(&self, p: &Vector2<f64>) -> [f64; 2] {
        let mut best = [0.0, f64::INFINITY];
        for (pair, from) in self.points.windows(2).zip(&self.lengths) {
            let way = pair[1] - pair[0];
            let share = ((p - pair[0]).dot(&way) / way.norm_squared()).clamp(0.0, 1.0);
            let far = (p - pair[0] - way * share).norm();
            if far < best[1] {
                best = [from + share * way.norm(), far];
            }
        }
        best
    }

    /// Point at a length from the start.
    pub(super) fn at(&self, length: f64) -> Vector2<f64> {
        let k = self.lengths.partition_point(|l| *l < length).clamp(1, self.points.len() - 1);
        let width = self.lengths[k] - self.lengths[k - 1];
        self.points[k - 1] + (self.points[k] - self.points[k - 1]) * ((length - self.lengths[k - 1]) / width)
    }

    pub(super) fn reversed(&self) -> Self {
        let whole = self.length();
        Self {
            points: self.points.iter().rev().copied().collect(),
            lengths: self.lengths.iter().rev().map(|l| whole - l).collect(),
        }
    }

    /// The meridian with the part of another one that goes on beyond one of its ends; `None` where the other one does not meet that
    /// end, or goes on nowhere.
    pub(super) fn continued(&self, other: &Self) -> Option<Self> {
        /// Distance within which meridians of several faces meet, mm.
        const MEET: f64 = 0.01;
        for line in [self.clone(), self.reversed()] {
            let end = line.points[line.points.len() - 1];
            for other in [other.clone(), other.reversed()] {
                let [from, far] = other.nearest(&end);
                let beyond = other.points[other.points.len() - 1];
                if far < MEET && line.nearest(&beyond)[1] > MEET {
                    let rest = other.points.iter().zip(&other.lengths).filter(|(_, length)| **length > from);
                    let rest = rest.map(|(p, _)| *p).skip_while(|p| (p - end).norm() < MEET);
                    return Self::new(line.points.iter().copied().chain(rest).collect());
                }
            }
        }
        None
    }

    /// The meridian from one length to another one.
    pub(super) fn part(&self, [from, to]: [f64; 2]) -> Option<Self> {
        let between = self.points.iter().zip(&self.lengths).filter(|(_, length)| (from..to).contains(*length));
        let inside = between.map(|(p, _)| *p);
        Self::new(std::iter::once(self.at(from)).chain(inside).chain(std::iter::once(self.at(to))).collect())
    }

    /// The meridian with straight lines of these lengths before its start and behind its end.
    pub(super) fn lengthened(&self, [before, behind]: [f64; 2]) -> Option<Self> {
        let last = self.points.len() - 1;
        let beyond = |end: usize, inside: usize, by: f64| {
            let way = self.points[end] - self.points[inside];
            self.points[end] + way * (by / way.norm())
        };
        let first = (before > 0.0).then(|| beyond(0, 1, before));
        let end = (behind > 0.0).then(|| beyond(last, last - 1, behind));
        Self::new(first.into_iter().chain(self.points.iter().copied()).chain(end).collect())
    }

    /// Points between two lengths, with equal steps.
    pub(super) fn between(&self, [from, to]: [f64; 2], steps: usize) -> Vec<[f64; 2]> {
        (0..=steps).map(|k| self.at(from + (to - from) * k as f64 / steps as f64).into()).collect()
    }
}
