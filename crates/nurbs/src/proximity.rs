//! Closest points and distances of ruled surfaces.

use super::RuledSurface;
use super::bracket::root;
use nalgebra::Point3;

/// Least step of the search by halving, as a share of the curve.
const MIN_SEARCH_STEP: f64 = 1e-10;

/// A rectangle of the parameter plane of a surface. It may extend beyond [0, 1]: guides and rulings continue straight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// Ends of u.
    pub u: [f64; 2],
    /// Ends of v.
    pub v: [f64; 2],
}

impl Patch {
    /// The whole surface between its guides.
    pub const WHOLE: Self = Self { u: [0.0, 1.0], v: [0.0, 1.0] };
}

/// A point of a surface close to another point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    /// Parameter along the guides.
    pub u: f64,
    /// Parameter along the ruling.
    pub v: f64,
    /// The point of the surface.
    pub point: Point3<f64>,
    /// Distance to it.
    pub distance: f64,
}

/// The closest pair of points of two surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPair {
    /// On the first surface.
    pub first: Projection,
    /// On the second surface.
    pub second: Projection,
    /// Distance between them.
    pub distance: f64,
}

/// Seeds along u. A surface that turns by about a right angle turns by 1 or 2 deg between seeds. This is far
/// less than a second minimum between two seeds would need.
const U_SEEDS: usize = 48;

/// Seeds along u of each surface in the search of a closest pair.
const PAIR_SEEDS: usize = 40;

fn at(range: [f64; 2], i: usize, steps: usize) -> f64 {
    range[0] + (range[1] - range[0]) * (i as f64 / steps as f64)
}

impl RuledSurface {
    /// Closest point of the ruling at u.
    fn on_ruling(&self, p: &Point3<f64>, u: f64, v_range: [f64; 2]) -> Projection {
        let root = self.root.point_extended(u);
        let ruling = self.tip.point_extended(u) - root;
        let square = ruling.norm_squared();
        let v =
            if square > 0.0 { ((p - root).dot(&ruling) / square).clamp(v_range[0], v_range[1]) } else { v_range[0] };
        let point = root + ruling * v;
        Projection { u, v, point, distance: (p - point).norm() }
    }

    /// Closest point of a patch: distances of all seeds, then Newton's method inside the brackets of the local minima,
    /// on the derivative of the distance to the ruling, with bisection where Newton's method leaves the bracket.
    pub fn closest(&self, p: &Point3<f64>, patch: Patch) -> Projection {
        let seeds: [f64; U_SEEDS + 1] =
            std::array::from_fn(|i| self.on_ruling(p, at(patch.u, i, U_SEEDS), patch.v).distance);
        let mut best: Option<Projection> = None;
        for i in 0..=U_SEEDS {
            let left = i == 0 || seeds[i] <= seeds[i - 1];
            let right = i == U_SEEDS || seeds[i] <= seeds[i + 1];
            if left && right {
                let bracket = [at(patch.u, i.saturating_sub(1), U_SEEDS), at(patch.u, (i + 1).min(U_SEEDS), U_SEEDS)];
                let found = self.refine(p, at(patch.u, i, U_SEEDS), bracket, patch.v);
                if best.is_none_or(|b| found.distance < b.distance) {
                    best = Some(found);
                }
            }
        }
        best.unwrap_or_else(|| self.on_ruling(p, patch.u[0], patch.v))
    }

    fn refine(&self, p: &Point3<f64>, start: f64, bracket: [f64; 2], v_range: [f64; 2]) -> Projection {
        let slope = |u: f64| {
            let v = self.on_ruling(p, u, v_range).v;
            let s = self.derivatives(u, v);
            let gap = s.point - p;
            let mut second = s.su.norm_squared() + gap.dot(&s.suu);
            if v_range[0] < v && v < v_range[1] {
                // v follows u along the minimum over v.
                let mixed = s.su.dot(&s.sv) + gap.dot(&s.suv);
                second -= mixed * mixed / s.sv.norm_squared();
            }
            [gap.dot(&s.su), second]
        };
        self.on_ruling(p, root(bracket, start, slope), v_range)
    }

    /// Closest pair of points of two patches: exact distances of ruling segments on a grid of both u, then a pattern
    /// search from each local minimum, which halves its step down to 1e-10.
    pub fn closest_pair(&self, patch: Patch, other: &Self, other_patch: Patch) -> ClosestPair {
        let distance = |a: f64, b: f64| segment_pair(self, a, patch.v, other, b, other_patch.v).distance;
        let n = PAIR_SEEDS;
        let grid: Vec<f64> = (0..(n + 1) * (n + 1))
            .map(|k| distance(at(patch.u, k / (n + 1), n), at(other_patch.u, k % (n + 1), n)))
            .collect();
        let mut best: Option<ClosestPair> = None;
        for i in 0..=n {
            for j in 0..=n {
                let here = grid[i * (n + 1) + j];
                let mut around = (i.saturating_sub(1)..=(i + 1).min(n))
                    .flat_map(|a| (j.saturating_sub(1)..=(j + 1).min(n)).map(move |b| a * (n + 1) + b));
                if !around.all(|k| here <= grid[k]) {
                    continue;
                }
                let (mut a, mut b, mut d) = (at(patch.u, i, n), at(other_patch.u, j, n), here);
                let (width, other_width) = (patch.u[1] - patch.u[0], other_patch.u[1] - other_patch.u[0]);
                let mut step = 0.5 / n as f64;
                while step > MIN_SEARCH_STEP {
                    let moves = [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, -1), (1, -1), (-1, 1)];
                    let better = moves.iter().find_map(|(da, db)| {
                        let x = (a + f64::from(*da) * step * width).clamp(patch.u[0], patch.u[1]);
                        let y = (b + f64::from(*db) * step * other_width).clamp(other_patch.u[0], other_patch.u[1]);
                        let e = distance(x, y);
                        (e < d).then_some((x, y, e))
                    });
                    match better {
                        Some(found) => (a, b, d) = found,
                        None => step *= 0.5,
                    }
                }
                if best.is_none_or(|x| d < x.distance) {
                    best = Some(segment_pair(self, a, patch.v, other, b, other_patch.v));
                }
            }
        }
        best.unwrap_or_else(|| segment_pair(self, patch.u[0], patch.v, other, other_patch.u[0], other_patch.v))
    }
}

/// Closest points of two rulings, each within its range of v.
fn segment_pair(a: &RuledSurface, ua: f64, va: [f64; 2], b: &RuledSurface, ub: f64, vb: [f64; 2]) -> ClosestPair {
    let (pa, ra) = (a.point(ua, 0.0), a.point(ua, 1.0));
    let (pb, rb) = (b.point(ub, 0.0), b.point(ub, 1.0));
    let (da, db) = (ra - pa, rb - pb);
    let (aa, bb, ab) = (da.norm_squared(), db.norm_squared(), da.dot(&db));
    let gap = pa - pb;
    let (ca, cb) = (da.dot(&gap), db.dot(&gap));
    let pair = |s: f64, t: f64| {
        let (x, y) = (pa + da * s, pb + db * t);
        let distance = (x - y).norm();
        ClosestPair {
            first: Projection { u: ua, v: s, point: x, distance },
            second: Projection { u: ub, v: t, point: y, distance },
            distance,
        }
    };
    let on_b = |s: f64| if bb > 0.0 { ((ab * s + cb) / bb).clamp(vb[0], vb[1]) } else { vb[0] };
    let on_a = |t: f64| if aa > 0.0 { ((ab * t - ca) / aa).clamp(va[0], va[1]) } else { va[0] };
    // The minimum without limits if it lies inside of both ranges, else the best of the four ends.
    let det = aa * bb - ab * ab;
    let mut best: Option<ClosestPair> = None;
    let mut take = |x: ClosestPair| {
        if best.is_none_or(|b| x.distance < b.distance) {
            best = Some(x);
        }
    };
    if det > 1e-14 * aa * bb {
        let s = ((ab * cb - bb * ca) / det).clamp(va[0], va[1]);
        let t = on_b(s);
        take(pair(on_a(t), t));
    }
    for s in va {
        take(pair(s, on_b(s)));
    }
    for t in vb {
        take(pair(on_a(t), t));
    }
    best.unwrap_or_else(|| pair(va[0], vb[0]))
}
