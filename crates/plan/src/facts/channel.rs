//! The lower corners of a passage, where a rounded tool corner touches wall and hub together.

use nalgebra::Point3;
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use wheel::part::{Face, Part, Passage, Surface};

/// Error at which the search for a place ends, mm. Distances to the hub are exact to about 4e-10 mm.
const EXACT: f64 = 1e-8;

/// Least step of the search, as a share.
const MIN_SEARCH_STEP: f64 = 1e-6;

/// Angle from one azimuth to another, in (-pi, pi].
pub(crate) fn turn_between(from: f64, to: f64) -> f64 {
    let turn = (to - from).rem_euclid(TAU);
    if turn > PI { turn - TAU } else { turn }
}

/// The walls of a passage of sector 0.
pub(crate) struct Channel<'a> {
    part: &'a Part,
    walls: [Face; 2],
    /// Angle from the sector of the first wall to that of the second, radians.
    turn: f64,
}

/// Free space between the walls at given distances from walls and hub.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeWidth {
    /// Distance between the two corner curves, mm; negative where the curves cross, so that no tool fits.
    pub width: f64,
    /// Place along the first wall from inlet (0) to outlet (1); beyond these values around the edge.
    pub u: f64,
    /// Middle of the narrowest place, in sector 0.
    pub point: Point3<f64>,
}

/// Number of intervals of a corner curve: 20 around each edge, 60 on the face.
const CORNER_INTERVALS: usize = 100;

/// First and last parameter of a corner curve: a right angle around each edge.
const CURVE: [f64; 2] = [-1.0, 2.0];

/// Parameter of a station.
fn station(i: usize) -> f64 {
    match i {
        0..20 => i as f64 / 20.0 - 1.0,
        20..80 => (i - 20) as f64 / 60.0,
        _ => 1.0 + (i - 80) as f64 / 20.0,
    }
}

impl<'a> Channel<'a> {
    pub(crate) fn new(part: &'a Part, passage: &Passage) -> Self {
        let [first, second] = passage.walls.map(|wall| part.face(wall));
        let turn = part.turn(passage);
        let surface = second.surface.rotated(turn);
        let walls = [first.clone(), Face { surface, orientation: second.orientation }];
        Self { part, walls, turn }
    }

    /// The point over a ruling at the distance `wall` from the wall and `floor` from the hub. `None` where the ruling
    /// ends below this point or the wall hangs too far over the hub. On the face `s` is u; below 0 and above 1 the
    /// offset turns around the inlet or outlet edge by a right angle per unit, since the edge is as near there as the
    /// face. The distance to the hub is nearly linear along the ruling, so that the secant method needs few steps.
    fn corner(&self, side: usize, s: f64, wall: f64, floor: f64) -> Option<Point3<f64>> {
        let face = &self.walls[side];
        let u = s.clamp(0.0, 1.0);
        let (sin, cos) = libm::sincos((s - u) * FRAC_PI_2);
        let at = |v: f64| {
            let (point, su, sv) = face.surface.tangents(u, v);
            let n = su.cross(&sv).normalize() * face.orientation;
            // Along the flow, perpendicular to the ruling.
            let flow = su - sv * (su.dot(&sv) / sv.norm_squared());
            point + (n * cos + flow.normalize() * sin) * wall
        };
        let over_floor = |v: f64| self.part.hub.distance(&at(v)) - floor;
        let (mut v0, mut v1) = (0.0, 0.25);
        let (mut f0, mut f1) = (over_floor(v0), over_floor(v1));
        for _ in 0..30 {
            if f1.abs() < EXACT {
                return (-0.5..=1.5).contains(&v1).then(|| at(v1));
            }
            let slope = (f1 - f0) / (v1 - v0);
            if slope.is_nan() || slope <= 0.0 {
                return None;
            }
            (v0, f0) = (v1, f1);
            v1 = (v1 - f1 / slope).clamp(-1.0, 2.0);
            if v1 == v0 {
                return None;
            }
            f1 = over_floor(v1);
        }
        None
    }

    /// Narrowest free space between the corner curves at these distances from walls and hub. `None` when a ruling has
    /// no such corner.
    pub(crate) fn free_width(&self, wall: f64, floor: f64) -> Option<FreeWidth> {
        let curve = |side: usize| -> Option<Vec<Point3<f64>>> {
            (0..=CORNER_INTERVALS).into_par_iter().map(|i| self.corner(side, station(i), wall, floor)).collect()
        };
        let (a, b) = (curve(0)?, curve(1)?);
        if let Some(crossed) = self.crossing(&a[20..=80], &b[20..=80]) {
            return Some(crossed);
        }
        let mut best = (f64::INFINITY, 0, 0);
        for (i, p) in a.iter().enumerate() {
            for (j, q) in b.iter().enumerate() {
                let d = (p - q).norm();
                if d < best.0 {
                    best = (d, i, j);
                }
            }
        }
        let (mut d, mut u, mut w) = (best.0, station(best.1), station(best.2));
        let mut ends = (a[best.1], b[best.2]);
        let mut step = 0.03;
        while step > MIN_SEARCH_STEP {
            // Corners before, at and behind the place on both curves: each belongs to several of the places that are tried.
            let mut corners = [[None, Some(ends.0), None], [None, Some(ends.1), None]];
            let mut better = false;
            for moves in [[1, 0], [-1, 0], [0, 1], [0, -1], [1, 1], [-1, -1]] {
                let [x, y] = [(u, moves[0]), (w, moves[1])]
                    .map(|(from, by)| (from + f64::from(by) * step).clamp(CURVE[0], CURVE[1]));
                let mut corner = |side: usize, s: f64| {
                    let known = &mut corners[side][(moves[side] + 1) as usize];
                    *known = known.or_else(|| self.corner(side, s, wall, floor));
                    *known
                };
                let (p, q) = (corner(0, x)?, corner(1, y)?);
                if (p - q).norm() < d {
                    (d, u, w, ends, better) = ((p - q).norm(), x, y, (p, q), true);
                    break;
                }
            }
            if !better {
                step *= 0.5;
            }
        }
        Some(FreeWidth { width: d, u, point: nalgebra::center(&ends.0, &ends.1) })
    }

    /// Where the curves cross: the place with the largest overlap; the width is the arc as a negative number.
    fn crossing(&self, a: &[Point3<f64>], b: &[Point3<f64>]) -> Option<FreeWidth> {
        let along = |p: &Point3<f64>| self.part.hub.closest(nalgebra::Vector2::new(libm::hypot(p.x, p.y), p.z)).0;
        let stations: Vec<f64> = b.iter().map(along).collect();
        let mut worst: Option<FreeWidth> = None;
        for (i, p) in a.iter().enumerate() {
            // The other curve at the same station of the meridian.
            let s = along(p);
            // A splitter begins behind the inlet.
            let (Some(first), Some(last)) = (stations.first(), stations.last()) else { continue };
            if s < *first || s > *last {
                continue;
            }
            let k = stations.partition_point(|t| *t < s).clamp(1, stations.len() - 1);
            let t = (s - stations[k - 1]) / (stations[k] - stations[k - 1]);
            let q = b[k - 1] + (b[k] - b[k - 1]) * t;
            // The gap is measured from the sector of the second wall on, so that the angle is unambiguous for few vanes as well.
            let gap = self.turn + turn_between(libm::atan2(p.y, p.x) + self.turn, libm::atan2(q.y, q.x));
            let width = gap * libm::hypot(p.x, p.y);
            if width < 0.0 && worst.is_none_or(|w| width < w.width) {
                worst = Some(FreeWidth { width, u: station(20 + i), point: nalgebra::center(p, &q) });
            }
        }
        worst
    }
}
