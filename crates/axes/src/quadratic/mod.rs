//! Convex quadratic programs in which each bound depends on a few neighbouring unknowns and on at most one unknown that
//! all bounds share: the interior-point method of Mehrotra on banded normal equations with a border.
//!
//! For x in [-1, 1] and shared unknowns w >= 0 (the widening of bounds that may give way, the largest difference of
//! neighbours), the program minimises x P x / 2 + q x + sum of (c w + d w^2 / 2) subject to a x <= limit + give w for
//! all bounds. A general solver takes ten times as long, most of it for ordering and for matrices that do not change.

mod band;

use band::Factor;
pub(crate) use band::{Band, dot};

/// A bound: a x <= limit + give w, with one of the shared unknowns as w.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bound<const ENTRIES: usize> {
    /// First unknown of the bound.
    pub(crate) first: usize,
    /// Factors of this unknown and of the next ones.
    pub(crate) a: [f64; ENTRIES],
    /// Right side.
    pub(crate) limit: f64,
    /// Factor of the shared unknown.
    pub(crate) give: f64,
    /// Which shared unknown.
    pub(crate) shared: usize,
}

/// Cost of a shared unknown: linear w + quadratic w^2 / 2.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SharedCost {
    pub(crate) linear: f64,
    pub(crate) quadratic: f64,
}

/// A quadratic program.
pub(crate) struct QuadraticProgram<'a, const ENTRIES: usize> {
    /// Bounds.
    pub(crate) bounds: &'a [Bound<ENTRIES>],
    /// How many factors of each bound count.
    pub(crate) entries: usize,
    /// P, positive semidefinite.
    pub(crate) quadratic: &'a Band,
    /// q.
    pub(crate) linear: &'a [f64],
    /// Shared unknowns; none where no bound may give way.
    pub(crate) shared: &'a [SharedCost],
    /// When a solution is good enough.
    pub(crate) accuracy: Accuracy,
}

/// When a solution is good enough.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Accuracy {
    /// Largest gap to the optimum, as a share of the value and as a number.
    pub(crate) gap: [f64; 2],
    /// Largest residual of the slopes.
    pub(crate) slope: f64,
    /// As many times less accurate a solution is taken where no step makes it better: rounding ends the way to it.
    pub(crate) at_rest: f64,
}

/// Most steps; some twelve are needed.
const MAX_PROGRAM_STEPS: usize = 50;

/// Largest residual of the bounds at the end, as a share of the largest limit.
const MAX_RESIDUAL: f64 = 1e-7;

/// Share of the distance to the border that a step covers.
const BORDER_SHARE: f64 = 0.995;

/// A number for each bound: the given bounds, the upper and lower ends of all unknowns, and the shared unknowns.
#[derive(Clone)]
struct Each {
    bounds: Vec<f64>,
    ends: [Vec<f64>; 2],
    shared: Vec<f64>,
}

impl Each {
    /// Numbers computed from two or three others.
    fn of(f: impl Fn(f64, f64, f64) -> f64, a: &Self, b: &Self, c: &Self) -> Self {
        let list = |a: &[f64], b: &[f64], c: &[f64]| a.iter().zip(b).zip(c).map(|((a, b), c)| f(*a, *b, *c)).collect();
        Self {
            bounds: list(&a.bounds, &b.bounds, &c.bounds),
            ends: [0, 1].map(|k| list(&a.ends[k], &b.ends[k], &c.ends[k])),
            shared: list(&a.shared, &b.shared, &c.shared),
        }
    }

    fn all(&self) -> impl Iterator<Item = f64> {
        self.bounds.iter().chain(&self.ends[0]).chain(&self.ends[1]).chain(&self.shared).copied()
    }

    fn dot(&self, other: &Self) -> f64 {
        dot(&self.bounds, &other.bounds)
            + dot(&self.ends[0], &other.ends[0])
            + dot(&self.ends[1], &other.ends[1])
            + dot(&self.shared, &other.shared)
    }

    /// One shared unknown counts where there is none: the target of a step is then a little lower, not wrong.
    fn count(&self) -> f64 {
        (self.bounds.len() + 2 * self.ends[0].len() + self.shared.len().max(1)) as f64
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
    /// Residual of the slope by each shared unknown.
    shared: Vec<f64>,
}

/// Changes of the unknowns, of the shared ones, and of slack and weight of each bound.
struct Change {
    x: Vec<f64>,
    w: Vec<f64>,
    left: Each,
    weight: Each,
}

/// Factors of the normal equations, with a border for each shared unknown.
struct Normal {
    factor: Factor,
    border: Vec<Vec<f64>>,
    /// Solutions of the equations for the borders.
    solved: Vec<Vec<f64>>,
    /// What is left for the shared unknowns: the lower triangle of a symmetric matrix.
    corner: Vec<Vec<f64>>,
}

impl<const ENTRIES: usize> QuadraticProgram<'_, ENTRIES> {
    /// The solution and its shared unknowns; `None` when no solution is found.
    pub(crate) fn solve(&self) -> Option<(Vec<f64>, Vec<f64>)> {
        let n = self.quadratic.size();
        let (mut x, mut w) = (vec![0.0; n], vec![1.0; self.shared.len()]);
        let limits = Each {
            bounds: self.bounds.iter().map(|b| b.limit).collect(),
            ends: [vec![1.0; n], vec![1.0; n]],
            shared: vec![0.0; self.shared.len()],
        };
        // Slack of each bound, positive, and its weight.
        let taken = self.taken(&x, &w);
        let mut left = Each::of(|limit, taken, _| (limit - taken).max(0.1), &limits, &taken, &taken);
        let mut weight = Each::of(|left, _, _| 1.0 / left.max(1.0), &left, &left, &left);
        let mut rests = false;
        let largest = limits.all().fold(1.0, |m: f64, r| if r.is_finite() { m.max(r.abs()) } else { m });
        for _ in 0..MAX_PROGRAM_STEPS {
            let taken = self.taken(&x, &w);
            let px = self.quadratic.times(&x);
            let off = self.off(&px, &w, &taken, &left, &weight, &limits);
            let gap = left.dot(&weight);
            let value = 0.5 * dot(&px, &x) + dot(self.linear, &x) + self.cost(&w);
            let worst = off.bounds.all().fold(0.0, |m: f64, x| m.max(x.abs()));
            let steep = off.slope.iter().chain(&off.shared).fold(0.0, |m: f64, x| m.max(x.abs()));
            let Accuracy { gap: [share, number], slope, at_rest } = self.accuracy;
            let allowed = share * value.abs() + number;
            let keeps =
                |times: f64| worst <= MAX_RESIDUAL * largest && steep <= times * slope && gap <= times * allowed;
            if keeps(1.0) {
                return Some((x, w));
            }
            rests = keeps(at_rest);
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
            let complement = Each::of(|p, s, _| p + s - centre, &products, &second, &second);
            let change = self.towards(&complement, &off, &left, &share, &normal);
            let step = (BORDER_SHARE * left.step(&change.left).min(weight.step(&change.weight))).min(1.0);
            if step < 1e-7 {
                break;
            }
            x.iter_mut().zip(&change.x).for_each(|(x, d)| *x += step * d);
            w.iter_mut().zip(&change.w).for_each(|(w, d)| *w += step * d);
            left.go(&change.left, step);
            weight.go(&change.weight, step);
        }
        rests.then_some((x, w))
    }

    /// Residuals; `px` is P x, `taken` are the left sides of the bounds, `left` their slack.
    fn off(&self, px: &[f64], w: &[f64], taken: &Each, left: &Each, weight: &Each, limits: &Each) -> Off {
        let (pulled, pulled_shared) = self.pulled(weight);
        let slope = px.iter().zip(self.linear).zip(&pulled).map(|((px, q), pulled)| px + q + pulled).collect();
        let shared = self.shared.iter().zip(w).zip(&pulled_shared);
        Off {
            bounds: Each::of(|taken, left, limit| taken + left - limit, taken, left, limits),
            slope,
            shared: shared.map(|((cost, w), pulled)| cost.linear + cost.quadratic * w + pulled).collect(),
        }
    }

    /// Cost of the shared unknowns.
    fn cost(&self, w: &[f64]) -> f64 {
        self.shared.iter().zip(w).map(|(cost, w)| (cost.linear + 0.5 * cost.quadratic * w) * w).sum()
    }

    /// The change that makes the residuals zero and reduces the products of slack (`left`) and weight by `complement`.
    /// `share` is the weight over the slack.
    fn towards(&self, complement: &Each, off: &Off, left: &Each, share: &Each, normal: &Normal) -> Change {
        let relative = Each::of(|c, l, _| c / l, complement, left, left);
        let push = Each::of(|s, off, c| s * off - c, share, &off.bounds, &relative);
        let (pulled, pulled_shared) = self.pulled(&push);
        let opposite = |off: &[f64], pulled: &[f64]| off.iter().zip(pulled).map(|(off, p)| -off - p).collect();
        let right: Vec<f64> = opposite(&off.slope, &pulled);
        let (x, w) = normal.solve(&right, opposite(&off.shared, &pulled_shared));
        let moved = self.taken(&x, &w);
        let left = Each::of(|off, moved, _| -off - moved, &off.bounds, &moved, &moved);
        let weight = Each::of(|r, s, d| -r - s * d, &relative, share, &left);
        Change { x, w, left, weight }
    }

    /// Left sides of all bounds.
    fn taken(&self, x: &[f64], w: &[f64]) -> Each {
        let given = |b: &Bound<ENTRIES>| w.get(b.shared).map_or(0.0, |w| b.give * w);
        let bound = |b: &Bound<ENTRIES>| dot(&b.a[..self.entries], &x[b.first..b.first + self.entries]) - given(b);
        let negative = |x: &[f64]| x.iter().map(|x| -x).collect();
        Each { bounds: self.bounds.iter().map(bound).collect(), ends: [x.to_vec(), negative(x)], shared: negative(w) }
    }

    /// Sum of the factors of all bounds, each with its weight: for the unknowns and for the shared ones.
    fn pulled(&self, weight: &Each) -> (Vec<f64>, Vec<f64>) {
        let mut out: Vec<f64> = weight.ends[0].iter().zip(&weight.ends[1]).map(|(a, b)| a - b).collect();
        let mut shared: Vec<f64> = weight.shared.iter().map(|w| -w).collect();
        for (b, w) in self.bounds.iter().zip(&weight.bounds) {
            for (to, a) in out[b.first..b.first + self.entries].iter_mut().zip(&b.a) {
                *to += a * w;
            }
            if let Some(to) = shared.get_mut(b.shared) {
                *to -= b.give * w;
            }
        }
        (out, shared)
    }

    fn normal(&self, share: &Each) -> Option<Normal> {
        let mut matrix = self.quadratic.widened(self.entries - 1);
        let n = matrix.size();
        let mut border = vec![vec![0.0; n]; self.shared.len()];
        let mut own: Vec<f64> = share.shared.clone();
        for (b, s) in self.bounds.iter().zip(&share.bounds) {
            matrix.add_square(b.first, &b.a[..self.entries], *s);
            let Some((border, own)) = border.get_mut(b.shared).zip(own.get_mut(b.shared)) else { continue };
            for (to, a) in border[b.first..b.first + self.entries].iter_mut().zip(&b.a) {
                *to -= b.give * s * a;
            }
            *own += b.give * b.give * s;
        }
        for i in 0..n {
            *matrix.diagonal(i) += share.ends[0][i] + share.ends[1][i];
        }
        let factor = matrix.factor()?;
        let solved: Vec<Vec<f64>> = border.iter().map(|border| factor.solve(border)).collect();
        let own = own.iter().zip(self.shared).map(|(own, cost)| own + cost.quadratic);
        let corner = own
            .enumerate()
            .map(|(i, own)| {
                let by_itself = |j: usize| if i == j { own } else { 0.0 };
                (0..=i).map(|j| by_itself(j) - dot(&border[i], &solved[j])).collect()
            })
            .collect();
        Some(Normal { factor, border, solved, corner: factored(corner) })
    }
}

/// The factors L and D of L D L' of a symmetric matrix, of which the lower triangle is given, in one triangle.
fn factored(mut a: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    for i in 0..a.len() {
        for j in 0..=i {
            let sum: f64 = (0..j).map(|k| a[i][k] * a[j][k] * a[k][k]).sum();
            let rest = a[i][j] - sum;
            a[i][j] = if i == j { rest } else { rest / a[j][j] };
        }
    }
    a
}

impl Normal {
    fn solve(&self, right: &[f64], below: Vec<f64>) -> (Vec<f64>, Vec<f64>) {
        let mut x = self.factor.solve(right);
        let mut w = below;
        for (i, row) in self.corner.iter().enumerate() {
            w[i] -= dot(&self.border[i], &x);
            w[i] -= (0..i).map(|k| row[k] * w[k]).sum::<f64>();
        }
        for i in (0..w.len()).rev() {
            w[i] /= self.corner[i][i];
            w[i] -= (i + 1..w.len()).map(|k| self.corner[k][i] * w[k]).sum::<f64>();
        }
        for (solved, w) in self.solved.iter().zip(&w) {
            x.iter_mut().zip(solved).for_each(|(x, s)| *x -= s * w);
        }
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

    /// Shared unknowns: the widening, and others with a quadratic cost.
    const SHARED: [SharedCost; 3] = [
        SharedCost { linear: 1.0, quadratic: 0.0 },
        SharedCost { linear: 0.0, quadratic: 0.7 },
        SharedCost { linear: 0.1, quadratic: 0.3 },
    ];
    const ACCURACY: Accuracy = Accuracy { gap: [1e-4, 1e-5], slope: 1e-4, at_rest: 1.0 };

    /// Bounds along ten control points of cubics or quintics, and a curvature. Every bound gives way by one of the first `shared` of
    /// [`SHARED`].
    fn sample(entries: usize, seed: usize, shared: usize, tight: f64) -> (Vec<Bound<36>>, Band, Vec<f64>) {
        let n = 60;
        let bound = |k: usize| Bound {
            first: 6 * (k % ((n - entries) / 6 + 1)),
            a: std::array::from_fn(|i| drawn(seed + 31 * k + i)),
            limit: tight + 0.5 * drawn(seed + 7 * k + 5),
            give: 0.5 + 0.5 * drawn(k).abs(),
            shared: k % shared.max(1),
        };
        let mut quadratic = Band::new(n, 29);
        for k in 0..n / 2 {
            let entries: Vec<f64> = (0..30).map(|i| drawn(seed + 17 * k + i) * 0.2).collect();
            quadratic.add_square(6 * (k % 6), &entries, 1.0);
        }
        (0..n).for_each(|i| *quadratic.diagonal(i) += 1e-4);
        let linear = (0..n).map(|i| if shared > 0 { 0.0 } else { drawn(seed + 3 * i) }).collect();
        ((0..160).map(bound).collect(), quadratic, linear)
    }

    /// The least value by another solver; `None` where it finds that there is no solution.
    fn reference<const N: usize>(program: &QuadraticProgram<'_, N>) -> Option<f64> {
        let n = program.quadratic.size();
        let shared = program.shared.len();
        let unknowns = n + shared;
        let unit = |i: usize| (0..n).map(|k| f64::from(u8::from(k == i))).collect::<Vec<f64>>();
        let columns: Vec<Vec<f64>> = (0..n).map(|j| program.quadratic.times(&unit(j))).collect();
        let entry = |i: usize, j: usize| {
            let of_shared = || if i == j { program.shared[i - n].quadratic } else { 0.0 };
            if i > j { 0.0 } else { columns.get(j).map_or_else(of_shared, |c| c.get(i).copied().unwrap_or(0.0)) }
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
            entries.extend((b.shared < shared).then_some((n + b.shared, -b.give)));
            put(&entries, b.limit);
        }
        for i in 0..n {
            put(&[(i, 1.0)], 1.0);
            put(&[(i, -1.0)], 1.0);
        }
        let mut q = program.linear.to_vec();
        for (i, cost) in program.shared.iter().enumerate() {
            put(&[(n + i, -1.0)], 0.0);
            q.push(cost.linear);
        }
        let settings = DefaultSettingsBuilder::default().verbose(false).build().unwrap();
        let (p, a) = (CscMatrix::from(&p), CscMatrix::from(&rows));
        let mut solver = DefaultSolver::new(&p, &q, &a, &right, &[NonnegativeConeT(right.len())], settings).unwrap();
        solver.solve();
        (solver.solution.status == SolverStatus::Solved).then_some(solver.solution.obj_val)
    }

    #[test]
    fn solutions_keep_the_bounds_and_are_as_low_as_those_of_another_solver() {
        let cases = [(1, 1), (400, 1), (900, 1), (2, 0), (500, 0), (1_000, 0), (3, 3), (700, 3), (1_100, 2)];
        for ((seed, shared), entries) in cases.into_iter().flat_map(|case| [24, 36].map(|entries| (case, entries))) {
            let (bounds, quadratic, linear) = sample(entries, seed, shared, if shared > 0 { -0.2 } else { 0.6 });
            let shared = &SHARED[..shared];
            let (bounds, quadratic, linear) = (&bounds[..], &quadratic, &linear[..]);
            let program = QuadraticProgram { bounds, entries, quadratic, linear, shared, accuracy: ACCURACY };
            let (x, w) = program.solve().expect("a solution");
            for b in bounds {
                let given = w.get(b.shared).map_or(0.0, |w| b.give * w);
                let over = dot(&b.a[..entries], &x[b.first..b.first + entries]) - b.limit - given;
                assert!(over < 1e-6, "{seed}: {over}");
            }
            assert!(x.iter().all(|x| x.abs() < 1.0 + 1e-6) && w.iter().all(|w| *w > -1e-6));
            let value = 0.5 * dot(&quadratic.times(&x), &x) + dot(linear, &x) + program.cost(&w);
            let least = reference(&program).expect("a solution");
            assert!((value - least).abs() < 3e-4 * least.abs() + 3e-5, "{seed}: {value} {least}");
            assert!(least.abs() > 1e-2, "nothing to compare");
        }
    }

    #[test]
    fn bounds_that_exclude_each_other_have_no_solution() {
        let (mut bounds, quadratic, linear) = sample(24, 3, 0, 0.6);
        let against = Bound { a: bounds[0].a.map(|a| -a), limit: -bounds[0].limit - 0.1, ..bounds[0] };
        bounds.push(against);
        let (bounds, quadratic, linear) = (&bounds[..], &quadratic, &linear[..]);
        let program = QuadraticProgram { bounds, entries: 24, quadratic, linear, shared: &[], accuracy: ACCURACY };
        assert!(program.solve().is_none());
        assert!(reference(&program).is_none());
    }
}
