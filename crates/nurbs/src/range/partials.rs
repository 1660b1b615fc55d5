//! Partial derivatives of faces over rectangles of (u, v), and jets along lines of a face.

use super::jet::{cross, unit};
use super::segment::{MAX_CONTROL_POINTS, SpanPart, smoothness};
use super::{Interval, Jet};
use crate::{LoftedSurface, RuledSurface};
use nalgebra::Vector3;
use std::array::from_fn;

/// Partial derivatives of a surface up to the third order over a rectangle of (u, v), as intervals.
#[derive(Clone, Copy, Debug)]
pub struct Partials {
    /// By order in u, order in v and coordinate. Orders with a sum above three are unknown.
    orders: Orders,
    /// Order of the highest derivative without a jump, in u and in v.
    smooth: [i32; 2],
}

type Orders = [[[Interval; 3]; 4]; 4];

/// The orders with a sum of at most three, each as the function says.
fn orders(partial: impl Fn(usize, usize) -> [Interval; 3]) -> Orders {
    from_fn(|i| from_fn(|j| if i + j < 4 { partial(i, j) } else { [Interval::ALL; 3] }))
}

impl Partials {
    fn join(&mut self, other: &Self) {
        for (all, own) in self.orders.iter_mut().flatten().flatten().zip(other.orders.iter().flatten().flatten()) {
            *all = all.join(*own);
        }
        self.smooth = from_fn(|k| self.smooth[k].min(other.smooth[k]));
    }

    /// Coordinates of S(u, v(t)) as functions of t, with `u` and `v` as functions of t. u is linear in t.
    pub fn along(&self, u: &Jet, v: &Jet) -> [Jet; 3] {
        self.of(0, 0, u, v)
    }

    /// The unit normal along `S_u` x `S_v`, of (u, v) as functions of one parameter. Its third derivative is unknown.
    pub fn normal(&self, u: &Jet, v: &Jet) -> [Jet; 3] {
        unit(&cross(&self.of(1, 0, u, v), &self.of(0, 1, u, v)))
    }

    /// The partial derivative of order i in u and j in v, as function of one parameter.
    fn of(&self, i: usize, j: usize, u: &Jet, v: &Jet) -> [Jet; 3] {
        let [_, p, ..] = u.orders;
        let [_, s, c, t] = v.orders;
        from_fn(|k| {
            let d = |a: usize, b: usize| match self.orders.get(i + a).and_then(|by_v| by_v.get(j + b)) {
                Some(partial) => partial[k],
                None => Interval::ALL,
            };
            let (pp, ps, ss) = (p.squared(), p * s, s.squared());
            let mixed = p * d(1, 1) + s * d(0, 2);
            let orders = [
                d(0, 0),
                p * d(1, 0) + s * d(0, 1),
                pp * d(2, 0) + ps * d(1, 1) * 2.0 + ss * d(0, 2) + c * d(0, 1),
                pp * p * d(3, 0)
                    + (pp * s * d(2, 1) + p * ss * d(1, 2) + c * mixed) * 3.0
                    + ss * s * d(0, 3)
                    + t * d(0, 1),
            ];
            // A direction that does not vary brings no jumps.
            let own = [(p, self.smooth[0] - i as i32), (s, self.smooth[1] - j as i32)];
            let varies = own.into_iter().filter(|(rate, _)| *rate != Interval::ZERO);
            let smooth = varies.map(|(_, smooth)| smooth).fold(u.smooth.min(v.smooth), i32::min);
            Jet { orders, smooth }
        })
    }

    /// Continues a surface straight in v: over the way from the end of the surface, of the partial derivatives at the end.
    fn straight(&self, way: Interval) -> Self {
        let own = &self.orders;
        let orders = orders(|i, j| match j {
            0 if i < 3 => from_fn(|k| own[i][0][k] + own[i][1][k] * way),
            0 => [Interval::ALL; 3],
            1 => own[i][1],
            _ => [Interval::ZERO; 3],
        });
        Self { orders, smooth: [self.smooth[0], 2] }
    }
}

impl RuledSurface {
    /// Partial derivatives over a range of u within [0, 1] and any range of v.
    pub fn partials(&self, u: [f64; 2], v: [f64; 2]) -> Partials {
        let (root, tip) = (self.root.jets(u), self.tip.jets(u));
        let v = Interval::new(v);
        let orders = orders(|i, j| {
            from_fn(|k| {
                let ruling = tip[k].orders[i] - root[k].orders[i];
                match j {
                    0 => root[k].orders[i] + ruling * v,
                    1 => ruling,
                    _ => Interval::ZERO,
                }
            })
        });
        Partials { orders, smooth: [root[0].smooth.min(tip[0].smooth), 2] }
    }
}

impl LoftedSurface {
    /// Partial derivatives over a range of u within [0, 1] and any range of v. Outside of [0, 1] the surface continues
    /// straight.
    pub fn partials(&self, u: [f64; 2], [low, high]: [f64; 2]) -> Partials {
        let inside = [low, high].map(|v| v.clamp(0.0, 1.0));
        let mut all = self.partials_within(u, inside);
        for (end, beyond) in [(0.0, low.min(0.0)), (1.0, high.max(1.0))] {
            if beyond == end {
                continue;
            }
            let straight = self.partials_within(u, [end; 2]).straight(Interval::hull([0.0, beyond - end]));
            if inside[0] == inside[1] {
                all = straight;
            } else {
                all.join(&straight);
                // The second derivative jumps at the end.
                all.smooth[1] = all.smooth[1].min(1);
            }
        }
        all
    }

    fn partials_within(&self, u: [f64; 2], v: [f64; 2]) -> Partials {
        let ([ku, kv], [pu, pv]) = (self.knots(), self.degree());
        let smooth = [smoothness(ku, pu, u), smoothness(kv, pv, v)];
        let mut all: Option<Partials> = None;
        for along in SpanPart::all(ku, pu, u) {
            for across in SpanPart::all(kv, pv, v) {
                let own = Partials { orders: self.of_segments(&along, &across), smooth };
                match &mut all {
                    Some(all) => all.join(&own),
                    None => all = Some(own),
                }
            }
        }
        all.unwrap_or(Partials { orders: [[[Interval::ALL; 3]; 4]; 4], smooth: [-1; 2] })
    }

    fn of_segments(&self, along: &SpanPart<'_>, across: &SpanPart<'_>) -> Orders {
        let degree = self.degree();
        let net: [[Vector3<f64>; MAX_CONTROL_POINTS]; MAX_CONTROL_POINTS] = from_fn(|a| {
            from_fn(|b| self.control_point(along.first() + a.min(degree[0]), across.first() + b.min(degree[1])))
        });
        // Control points of the derivatives by v, for each control point along u, and how many there are.
        let by_v: [(usize, [[Vector3<f64>; MAX_CONTROL_POINTS]; MAX_CONTROL_POINTS]); 4] = from_fn(|j| {
            let mut derived = net;
            let counts = derived.each_mut().map(|row| across.derivative(j, row));
            (counts[0], derived)
        });
        orders(|i, j| {
            let (count, derived) = &by_v[j];
            let mut all = Vec::with_capacity(MAX_CONTROL_POINTS * MAX_CONTROL_POINTS);
            for b in 0..*count {
                let mut points = derived.map(|row| row[b]);
                let rows = along.derivative(i, &mut points);
                all.extend_from_slice(&points[..rows]);
            }
            from_fn(|k| Interval::hull(all.iter().map(|p| p[k])))
        })
    }
}
