//! Values along a curve or over the span: splines through the values that a designer states.

use nalgebra::Point3;
use nurbs::NurbsCurve;
use nurbs::basis::MAX_DEGREE;
use nurbs::interpolate::interpolate_at;

/// Values over shares from 0 to 1: a spline of degree 3, lower for fewer than four values.
#[derive(Clone, Debug)]
pub struct Distribution {
    /// Values as the x coordinate of a curve; `None` for one value that holds everywhere.
    curve: Option<NurbsCurve>,
    first: f64,
}

impl Distribution {
    /// The same value everywhere.
    pub fn constant(value: f64) -> Self {
        Self { curve: None, first: value }
    }

    /// The spline through (share, value). A single value holds everywhere.
    ///
    /// `None` unless shares ascend from 0 to 1.
    pub fn through(points: &[[f64; 2]]) -> Option<Self> {
        let [_, first] = *points.first()?;
        if points.len() == 1 {
            return Some(Self::constant(first));
        }
        let (shares, values): (Vec<f64>, Vec<Point3<f64>>) =
            points.iter().map(|[share, value]| (*share, Point3::new(*value, 0.0, 0.0))).unzip();
        let curve = interpolate_at(&shares, &values, MAX_DEGREE.min(points.len() - 1)).ok()?;
        Some(Self { curve: Some(curve), first })
    }

    /// Value at a share; outside of 0 to 1 that of the nearer end.
    pub fn at(&self, share: f64) -> f64 {
        self.curve.as_ref().map_or(self.first, |curve| curve.point(share.clamp(0.0, 1.0)).x)
    }

    /// Value and derivative by the share; outside of 0 to 1 on the tangent of the nearer end.
    pub fn on_tangent(&self, share: f64) -> [f64; 2] {
        self.curve.as_ref().map_or([self.first, 0.0], |curve| {
            let d = curve.derivatives_extended(share);
            [d.point.x, d.first.x]
        })
    }
}

/// Weights with which values at places, which ascend from 0 to 1, give the value at another place: those of the spline through
/// them. One place holds everywhere.
///
/// `None` unless the places ascend from 0 to 1.
pub(super) fn weights(places: &[f64], at: f64) -> Option<Vec<f64>> {
    let unit = |j: usize| {
        let points: Vec<[f64; 2]> =
            places.iter().enumerate().map(|(k, place)| [*place, if k == j { 1.0 } else { 0.0 }]).collect();
        Some(Distribution::through(&points)?.at(at))
    };
    if places.len() == 1 { Some(vec![1.0]) } else { (0..places.len()).map(unit).collect() }
}

/// Values with slopes at even steps from 0, between them cubic (Hermite); outside on the tangents of the ends.
#[derive(Clone, Debug)]
pub(super) struct HermiteTable<const N: usize> {
    step: f64,
    nodes: Vec<([f64; N], [f64; N])>,
}

impl<const N: usize> HermiteTable<N> {
    /// At least two nodes, each a value with its slope.
    pub(super) fn new(step: f64, nodes: Vec<([f64; N], [f64; N])>) -> Self {
        debug_assert!(nodes.len() > 1 && step > 0.0);
        Self { step, nodes }
    }

    /// Distance from the first to the last node.
    pub(super) fn length(&self) -> f64 {
        self.step * (self.nodes.len() - 1) as f64
    }

    /// The same table with a number added to its values.
    pub(super) fn moved(&self, by: [f64; N]) -> Self {
        let nodes = self.nodes.iter().map(|(value, slope)| (std::array::from_fn(|i| value[i] + by[i]), *slope));
        Self { step: self.step, nodes: nodes.collect() }
    }

    /// Value and slope.
    pub(super) fn at(&self, x: f64) -> ([f64; N], [f64; N]) {
        let last = self.nodes.len() - 1;
        for (end, beyond) in [(0, x < 0.0), (last, x > self.length())] {
            if beyond {
                let (value, slope) = self.nodes[end];
                let over = x - self.step * end as f64;
                return (std::array::from_fn(|i| value[i] + slope[i] * over), slope);
            }
        }
        let k = ((x / self.step) as usize).min(last - 1);
        let (h, t) = (self.step, x / self.step - k as f64);
        let ((a, da), (b, db)) = (self.nodes[k], self.nodes[k + 1]);
        let value = |i: usize| {
            let rise = b[i] - a[i];
            let [first, second] = [3.0 * rise - h * (2.0 * da[i] + db[i]), h * (da[i] + db[i]) - 2.0 * rise];
            a[i] + t * (h * da[i] + t * (first + t * second))
        };
        let slope = |i: usize| {
            let rise = b[i] - a[i];
            let [first, second] = [3.0 * rise - h * (2.0 * da[i] + db[i]), h * (da[i] + db[i]) - 2.0 * rise];
            da[i] + t * (2.0 * first + 3.0 * t * second) / h
        };
        (std::array::from_fn(value), std::array::from_fn(slope))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spline_goes_through_its_values_and_repeats_cubics() {
        let cubic = |x: f64| 2.0 - x + 3.0 * x * x - 4.0 * x * x * x;
        let points: Vec<[f64; 2]> = [0.0, 0.2, 0.7, 1.0].iter().map(|x| [*x, cubic(*x)]).collect();
        let spline = Distribution::through(&points).unwrap();
        for k in 0..=20 {
            let x = f64::from(k) / 20.0;
            assert!((spline.at(x) - cubic(x)).abs() < 1e-12);
            let slope = -1.0 + 6.0 * x - 12.0 * x * x;
            assert!((spline.on_tangent(x)[1] - slope).abs() < 1e-11);
        }
        assert!((spline.on_tangent(1.5)[0] - (cubic(1.0) - 7.0 * 0.5)).abs() < 1e-11);
        assert_eq!(spline.at(1.5), spline.at(1.0));
        for wrong in [
            vec![],
            vec![[0.0, 1.0], [0.9, 2.0]],
            vec![[0.1, 1.0], [1.0, 2.0]],
            vec![[0.0, 1.0], [0.0, 2.0], [1.0, 3.0]],
        ] {
            assert!(Distribution::through(&wrong).is_none(), "{wrong:?}");
        }
    }

    #[test]
    fn weights_repeat_lines_and_sum_to_one() {
        let places = [0.0, 0.3, 0.5, 0.8, 1.0];
        for k in 0..=10 {
            let at = f64::from(k) / 10.0;
            let found = weights(&places, at).unwrap();
            assert!((found.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            let line: f64 = found.iter().zip(places).map(|(w, p)| w * p).sum();
            assert!((line - at).abs() < 1e-12);
        }
        assert_eq!(weights(&[0.4], 0.9), Some(vec![1.0]));
    }

    #[test]
    fn a_table_repeats_cubics() {
        let f = |x: f64| ([x * x * x - x], [3.0 * x * x - 1.0]);
        let table = HermiteTable::new(0.5, (0..=4).map(|k| f(0.5 * f64::from(k))).collect());
        assert_eq!(table.length(), 2.0);
        for k in 0..=17 {
            let x = 2.0 * f64::from(k) / 17.0;
            let (found, due) = (table.at(x), f(x));
            assert!((found.0[0] - due.0[0]).abs() < 1e-12 && (found.1[0] - due.1[0]).abs() < 1e-12);
        }
        assert!((table.at(2.5).0[0] - (6.0 + 0.5 * 11.0)).abs() < 1e-12);
    }
}
