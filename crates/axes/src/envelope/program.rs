//! Convex quadratic programs in which each bound depends on a few neighbouring unknowns only: the interior-point method
//! of Mehrotra on banded normal equations.
//!
//! For x in [-1, 1] and, where bounds may give way, a widening w >= 0, the program minimises x P x / 2 + q x + w
//! subject to a x <= limit + give w for all bounds. A general solver takes ten times as long, most of it for ordering
//! and for matrices that do not change.

use super::band::{Band, Factor, dot};
use nurbs::bezier::MAX_BEZIER_DEGREE;

/// Factors of a bound, at most: for the control points of both curves on which a place depends.
pub(super) const MAX_ENTRIES: usize = 6 * (MAX_BEZIER_DEGREE + 1);

/// A bound: a x <= limit + give w.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bound {
    /// First unknown of the bound.
    pub(super) first: usize,
    /// Factors of this unknown and of the next ones.
    pub(super) a: [f64; MAX_ENTRIES],
    /// Right side.
    pub(super) limit: f64,
    /// Factor of the widening.
    pub(super) give: f64,
}

/// A quadratic program.
pub(super) struct QuadraticProgram<'a> {
    /// Bounds.
    pub(super) bounds: &'a [Bound],
    /// How many factors of each bound count.
    pub(super) entries: usize,
    /// P, positive semidefinite.
    pub(super) quadratic: &'a Band,
    /// q.
    pub(super) linear: &'a [f64],
    /// True when bounds may give way.
    pub(super) widens: bool,
}

/// Most steps; some twelve are needed.
const MAX_PROGRAM_STEPS: usize = 50;

/// Largest residuals of bounds and slopes at the end; then the largest gap to the optimum, as a share and as a number.
const MAX_RESIDUALS: f64 = 1e-7;
const GAP: [f64; 2] = [1e-4, 1e-5];

/// Share of the distance to the border that a step covers.
const BORDER_SHARE: f64 = 0.995;

/// A number for each bound: the given bounds, the upper and lower ends of all unknowns, and the widening.
#[derive(Clone)]
struct Each {
    bounds: Vec<f64>,
    ends: [Vec<f64>; 2],
    widening: f64,
}

impl Each {
    /// Numbers computed from two or three others.
    fn of(f: impl Fn(f64, f64, f64) -> f64, a: &Self, b: &Self, c: &Self) -> Self {
        let list = |a: &[f64], b: &[f64], c: &[f64]| a.iter().zip(b).zip(c).map(|((a, b), c)| f(*a, *b, *c)).collect();
        Self {
            bounds: list(&a.bounds, &b.bounds, &c.bounds),
            ends: [0, 1].map(|k| list(&a.ends[k], &b.ends[k], &c.ends[k])),
            widening: f(a.widening, b.widening, c.widening),
        }
    }

    fn all(&self) -> impl Iterator<Item = f64> {
        self.bounds.iter().chain(&self.ends[0]).chain(&self.ends[1]).copied().chain(std::iter::once(self.widening))
    }

    fn dot(&self, other: &Self) -> f64 {
        dot(&self.bounds, &other.bounds)
            + dot(&self.ends[0], &other.ends[0])
            + dot(&self.ends[1], &other.ends[1])
            + self.widening * other.widening
    }

    fn count(&self) -> f64 {
        (self.bounds.len() + 2 * self.ends[0].len() + 1) as f64
    }

    /// Largest step, at most 1, that keeps all of these numbers positive.
    fn step(&self, change: &Self) -> f64 {
        self.all().zip(change.all()).filter(|(_, d)| *d < 0.0).fold(1.0, |step, (x, d)| step.min(-x / d))
    }

    fn go(&mut self, change: &Self, step: f64) {
        *self = Self::of(|x, d, _| x + step * d, self, change, change);
    }
}

/// Residuals of bounds and slopes.
struct Off {
    bounds: Each,
    slope: Vec<f64>,
    /// Residual of the slope by the widening.
    widening: f64,
}

/// Changes of the unknowns, of the widening, and of slack and weight of each bound.
struct Change {
    x: Vec<f64>,
    w: f64,
    left: Each,
    weight: Each,
}

/// Factors of the normal equations, with a border for the widening.
struct Normal {
    factor: Factor,
    border: Vec<f64>,
    /// Solution of the equations for the border.
    solved: Vec<f64>,
    corner: f64,
}

impl QuadraticProgram<'_> {
    /// The solution and its widening, zero where no bound may give way; `None` when no solution is found.
    pub(super) fn solve(&self) -> Option<(Vec<f64>, f64)> {
        let n = self.quadratic.size();
        let (mut x, mut w) = (vec![0.0; n], f64::from(u8::from(self.widens)));
        let limits = Each {
            bounds: self.bounds.iter().map(|b| b.limit).collect(),
            ends: [vec![1.0; n], vec![1.0; n]],
            widening: 0.0,
        };
        // Slack of each bound, positive, and its weight.
        let taken = self.taken(&x, w);
        let mut left = Each::of(|limit, taken, _| (limit - taken).max(0.1), &limits, &taken, &taken);
        let mut weight = Each::of(|left, _, _| 1.0 / left.max(1.0), &left, &left, &left);
        if !self.widens {
            (left.widening, weight.widening) = (1.0, 0.0);
        }
        let largest = limits.all().fold(1.0, |m: f64, r| if r.is_finite() { m.max(r.abs()) } else { m });
        for _ in 0..MAX_PROGRAM_STEPS {
            let taken = self.taken(&x, w);
            // Residuals of bounds and slopes.
            let bounds = Each::of(|taken, left, limit| taken + left - limit, &taken, &left, &limits);
            let bounds = if self.widens { bounds } else { Each { widening: 0.0, ..bounds } };
            let px = self.quadratic.times(&x);
            let (pulled, pulled_widening) = self.pulled(&weight);
            let slope: Vec<f64> = (0..n).map(|i| px[i] + self.linear[i] + pulled[i]).collect();
            let off = Off { bounds, slope, widening: if self.widens { 1.0 + pulled_widening } else { 0.0 } };
            let gap = left.dot(&weight);
            let value = 0.5 * dot(&px, &x) + dot(self.linear, &x) + w;
            let worst = off.bounds.all().fold(0.0, |m: f64, x| m.max(x.abs()));
            let steep = off.slope.iter().fold(off.widening.abs(), |m, x| m.max(x.abs()));
            if worst <= MAX_RESIDUALS * largest && steep <= 1e3 * MAX_RESIDUALS && gap <= GAP[0] * value.abs() + GAP[1]
            {
                return Some((x, w));
            }
            let share = Each::of(|weight, left, _| weight / left, &weight, &left, &left);
            let normal = self.normal(&share)?;
            let mean = gap / left.count();
            let products = Each::of(|l, w, _| l * w, &left, &weight, &weight);
            let first = self.towards(&products, &off, &left, &share, &normal);
            let step = left.step(&first.left).min(weight.step(&first.weight));
            let then = Each::of(|x, d, _| x + step * d, &left, &first.left, &first.left).dot(&Each::of(
                |x, d, _| x + step * d,
                &weight,
                &first.weight,
                &first.weight,
            ));
            let centre = (then / gap).powi(3) * mean;
            let second = Each::of(|a, b, _| a * b, &first.left, &first.weight, &first.weight);
            let mut complement = Each::of(|p, s, _| p + s - centre, &products, &second, &second);
            if !self.widens {
                complement.widening = 0.0;
            }
            let change = self.towards(&complement, &off, &left, &share, &normal);
            let step = (BORDER_SHARE * left.step(&change.left).min(weight.step(&change.weight))).min(1.0);
            if step < 1e-7 {
                return None;
            }
            x.iter_mut().zip(&change.x).for_each(|(x, d)| *x += step * d);
            w += step * change.w;
            left.go(&change.left, step);
            weight.go(&change.weight, step);
        }
        None
    }

    /// The change that makes the residuals zero and reduces the products of slack (`left`) and weight by `complement`.
    /// `share` is the weight over the slack.
    fn towards(&self, complement: &Each, off: &Off, left: &Each, share: &Each, normal: &Normal) -> Change {
        let relative = Each::of(|c, l, _| c / l, complement, left, left);
        let push = Each::of(|s, off, c| s * off - c, share, &off.bounds, &relative);
        let (pulled, pulled_widening) = self.pulled(&push);
        let right: Vec<f64> = off.slope.iter().zip(&pulled).map(|(slope, pulled)| -slope - pulled).collect();
        let (x, w) = normal.solve(&right, -off.widening - pulled_widening, self.widens);
        let moved = self.taken(&x, w);
        let mut left = Each::of(|off, moved, _| -off - moved, &off.bounds, &moved, &moved);
        let mut weight = Each::of(|r, s, d| -r - s * d, &relative, share, &left);
        if !self.widens {
            (left.widening, weight.widening) = (0.0, 0.0);
        }
        Change { x, w, left, weight }
    }

    /// Left sides of all bounds.
    fn taken(&self, x: &[f64], w: f64) -> Each {
        let bound = |b: &Bound| dot(&b.a[..self.entries], &x[b.first..b.first + self.entries]) - b.give * w;
        let negative = x.iter().map(|x| -x).collect();
        Each { bounds: self.bounds.iter().map(bound).collect(), ends: [x.to_vec(), negative], widening: -w }
    }

    /// Sum of the factors of all bounds, each with its weight: for the unknowns and for the widening.
    fn pulled(&self, weight: &Each) -> (Vec<f64>, f64) {
        let mut out: Vec<f64> = weight.ends[0].iter().zip(&weight.ends[1]).map(|(a, b)| a - b).collect();
        let mut widening = -weight.widening;
        for (b, w) in self.bounds.iter().zip(&weight.bounds) {
            for (to, a) in out[b.first..b.first + self.entries].iter_mut().zip(&b.a) {
                *to += a * w;
            }
            widening -= b.give * w;
        }
        (out, widening)
    }

    fn normal(&self, share: &Each) -> Option<Normal> {
        let mut matrix = self.quadratic.widened(self.entries - 1);
        let n = matrix.size();
        let mut border = vec![0.0; n];
        let mut corner = share.widening;
        for (b, s) in self.bounds.iter().zip(&share.bounds) {
            matrix.add_square(b.first, &b.a[..self.entries], *s);
            for (to, a) in border[b.first..b.first + self.entries].iter_mut().zip(&b.a) {
                *to -= b.give * s * a;
            }
            corner += b.give * b.give * s;
        }
        for i in 0..n {
            *matrix.diagonal(i) += share.ends[0][i] + share.ends[1][i];
        }
        let factor = matrix.factor()?;
        let solved = if self.widens { factor.solve(&border) } else { Vec::new() };
        let corner = if self.widens { corner - dot(&border, &solved) } else { 1.0 };
        Some(Normal { factor, border, solved, corner })
    }
}

impl Normal {
    fn solve(&self, right: &[f64], below: f64, widens: bool) -> (Vec<f64>, f64) {
        let mut x = self.factor.solve(right);
        if !widens {
            return (x, 0.0);
        }
        let w = (below - dot(&self.border, &x)) / self.corner;
        x.iter_mut().zip(&self.solved).for_each(|(x, s)| *x -= s * w);
        (x, w)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clarabel::algebra::CscMatrix;
    use clarabel::solver::{DefaultSettingsBuilder, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus};

    /// Numbers in [-1, 1] that look random.
    fn drawn(k: usize) -> f64 {
        ((k as f64 * 12.9898 + 78.233).sin() * 43_758.545_3).fract()
    }

    /// Bounds along ten control points of cubics or quintics, and a curvature.
    fn sample(entries: usize, seed: usize, widens: bool, tight: f64) -> (Vec<Bound>, Band, Vec<f64>) {
        let n = 60;
        let bound = |k: usize| Bound {
            first: 6 * (k % ((n - entries) / 6 + 1)),
            a: std::array::from_fn(|i| drawn(seed + 31 * k + i)),
            limit: tight + 0.5 * drawn(seed + 7 * k + 5),
            give: f64::from(u8::from(widens)) * (0.5 + 0.5 * drawn(k).abs()),
        };
        let mut quadratic = Band::new(n, 29);
        for k in 0..n / 2 {
            let entries: Vec<f64> = (0..30).map(|i| drawn(seed + 17 * k + i) * 0.2).collect();
            quadratic.add_square(6 * (k % 6), &entries, 1.0);
        }
        (0..n).for_each(|i| *quadratic.diagonal(i) += 1e-4);
        let linear = (0..n).map(|i| if widens { 0.0 } else { drawn(seed + 3 * i) }).collect();
        ((0..160).map(bound).collect(), quadratic, linear)
    }

    /// The least value by another solver; `None` where it finds that there is no solution.
    fn reference(program: &QuadraticProgram<'_>) -> Option<f64> {
        let n = program.quadratic.size();
        let unknowns = n + usize::from(program.widens);
        let unit = |i: usize| (0..n).map(|k| f64::from(u8::from(k == i))).collect::<Vec<f64>>();
        let columns: Vec<Vec<f64>> = (0..n).map(|j| program.quadratic.times(&unit(j))).collect();
        let entry = |i: usize, j: usize| {
            if i <= j { columns.get(j).and_then(|c| c.get(i)).copied().unwrap_or(0.0) } else { 0.0 }
        };
        let p: Vec<Vec<f64>> = (0..unknowns).map(|i| (0..unknowns).map(|j| entry(i, j)).collect()).collect();
        let (mut rows, mut right) = (Vec::new(), Vec::new());
        let mut put = |entries: &[(usize, f64)], limit: f64| {
            let mut row = vec![0.0; unknowns];
            entries.iter().for_each(|(i, x)| row[*i] = *x);
            rows.push(row);
            right.push(limit);
        };
        for b in program.bounds {
            let factors = b.a.iter().enumerate().take(program.entries);
            let mut entries: Vec<(usize, f64)> = factors.map(|(i, a)| (b.first + i, *a)).collect();
            entries.extend(program.widens.then_some((n, -b.give)));
            put(&entries, b.limit);
        }
        for i in 0..n {
            put(&[(i, 1.0)], 1.0);
            put(&[(i, -1.0)], 1.0);
        }
        let mut q = program.linear.to_vec();
        if program.widens {
            put(&[(n, -1.0)], 0.0);
            q.push(1.0);
        }
        let settings = DefaultSettingsBuilder::default().verbose(false).build().unwrap();
        let (p, a) = (CscMatrix::from(&p), CscMatrix::from(&rows));
        let mut solver = DefaultSolver::new(&p, &q, &a, &right, &[NonnegativeConeT(right.len())], settings).unwrap();
        solver.solve();
        (solver.solution.status == SolverStatus::Solved).then_some(solver.solution.obj_val)
    }

    #[test]
    fn solutions_keep_the_bounds_and_are_as_low_as_those_of_another_solver() {
        let cases = [(1, true), (400, true), (900, true), (2, false), (500, false), (1_000, false)];
        for ((seed, widens), entries) in cases.into_iter().flat_map(|case| [24, 36].map(|entries| (case, entries))) {
            let (bounds, quadratic, linear) = sample(entries, seed, widens, if widens { -0.2 } else { 0.6 });
            let program = QuadraticProgram { bounds: &bounds, entries, quadratic: &quadratic, linear: &linear, widens };
            let (x, w) = program.solve().expect("a solution");
            for b in &bounds {
                let over = dot(&b.a[..entries], &x[b.first..b.first + entries]) - b.limit - b.give * w;
                assert!(over < 1e-6, "{seed}: {over}");
            }
            assert!(x.iter().all(|x| x.abs() < 1.0 + 1e-6) && w > -1e-6);
            let value = 0.5 * dot(&quadratic.times(&x), &x) + dot(&linear, &x) + w;
            let least = reference(&program).expect("a solution");
            assert!((value - least).abs() < 3e-4 * least.abs() + 3e-5, "{seed}: {value} {least}");
            assert!(least.abs() > 1e-2, "nothing to compare");
        }
    }

    #[test]
    fn bounds_that_exclude_each_other_have_no_solution() {
        let (mut bounds, quadratic, linear) = sample(24, 3, false, 0.6);
        let against = Bound { a: bounds[0].a.map(|a| -a), limit: -bounds[0].limit - 0.1, ..bounds[0] };
        bounds.push(against);
        let program =
            QuadraticProgram { bounds: &bounds, entries: 24, quadratic: &quadratic, linear: &linear, widens: false };
        assert!(program.solve().is_none());
        assert!(reference(&program).is_none());
    }
}
