//! Jets of NURBS curves and of meridians.

use super::segment::{MAX_CONTROL_POINTS, SpanPart, smoothness};
use super::{Interval, Jet};
use crate::{NurbsCurve, Revolution};
use nalgebra::Vector4;
use std::array::from_fn;

impl NurbsCurve {
    /// The coordinates over a range of the parameter within [0, 1].
    pub fn jets(&self, range: [f64; 2]) -> [Jet; 3] {
        let smooth = smoothness(self.knots(), self.degree(), range);
        let mut orders = [[None; 4]; 4];
        for segment in SpanPart::all(self.knots(), self.degree(), range) {
            let net: [Vector4<f64>; MAX_CONTROL_POINTS] =
                from_fn(|j| self.control()[segment.first() + j.min(self.degree())]);
            for order in 0..4 {
                let mut points = net;
                let count = segment.derivative(order, &mut points);
                for (k, by_order) in orders.iter_mut().enumerate() {
                    let own = Interval::hull(points[..count].iter().map(|p| p[k]));
                    let all = &mut by_order[order];
                    *all = Some(all.map_or(own, |all: Interval| all.join(own)));
                }
            }
        }
        let homogeneous = orders.map(|orders| Jet { orders: orders.map(|o| o.unwrap_or(Interval::ALL)), smooth });
        let [x, y, z, weight] = homogeneous;
        if !self.is_rational() {
            return [x, y, z];
        }
        let q = weight.inverse();
        [x * q, y * q, z * q]
    }
}

impl Revolution {
    /// Radius and height of the meridian at a parameter that varies. Outside of [0, 1] the meridian continues along its
    /// tangents.
    pub fn meridian_jets(&self, u: &Jet) -> [Jet; 2] {
        let Interval { low, high } = u.orders[0];
        let inside = [low, high].map(|u| u.clamp(0.0, 1.0));
        let mut by_u = self.meridian_over(inside);
        for (end, beyond) in [(0.0, low.min(0.0)), (1.0, high.max(1.0))] {
            if beyond == end {
                continue;
            }
            let way = Interval::hull([0.0, beyond - end]);
            for (all, at_end) in by_u.iter_mut().zip(self.meridian_over([end; 2])) {
                let [value, slope, ..] = at_end.orders;
                let straight = [value + slope * way, slope, Interval::ZERO, Interval::ZERO];
                // A range that lies wholly beyond the end is straight; otherwise the second derivative jumps at the end.
                let wholly = inside[0] == inside[1];
                all.orders = if wholly { straight } else { from_fn(|k| all.orders[k].join(straight[k])) };
                all.smooth = if wholly { 2 } else { all.smooth.min(1) };
            }
        }
        by_u.map(|f| {
            let jet = u.then(f.orders);
            // A constant has no jumps.
            let smooth = if u.orders[1] == Interval::ZERO { 2 } else { jet.smooth.min(f.smooth) };
            Jet { smooth, ..jet }
        })
    }

    /// Radius and height over a range of u within [0, 1].
    fn meridian_over(&self, range: [f64; 2]) -> [Jet; 2] {
        let [x, y, z] = self.generator().jets(range);
        let mut square = x * x + y * y;
        square.orders[0] = x.orders[0].squared() + y.orders[0].squared();
        [square.sqrt(), z]
    }
}
