//! Curves and surfaces as data (feature `serde`): they come back bit by bit, and what no constructor makes is an error.

use super::{DualCurve, LoftedSurface, NurbsCurve, Revolution};
use nalgebra::Point3;
use serde_json::{Value, json};

fn arc(z: f64, turn: f64) -> NurbsCurve {
    let at = |i: u32| turn + 0.2 * f64::from(i);
    let points: Vec<Point3<f64>> =
        (0..7).map(|i| Point3::new(20.0 * libm::cos(at(i)), 20.0 * libm::sin(at(i)), z + 0.3 * f64::from(i))).collect();
    crate::interpolate(&points, 3).unwrap()
}

fn again<T: serde::Serialize + serde::de::DeserializeOwned>(value: &T) -> T {
    serde_json::from_str(&serde_json::to_string(value).unwrap()).unwrap()
}

fn fault<T: serde::de::DeserializeOwned + std::fmt::Debug>(value: Value) -> String {
    serde_json::from_value::<T>(value).unwrap_err().to_string()
}

#[test]
fn values_come_back_bit_by_bit() {
    let loft = LoftedSurface::through((0..5).map(|k| arc(f64::from(k), 0.1 * f64::from(k))).collect()).unwrap();
    // A turned surface is not the surface through turned sections, bit by bit.
    for surface in [loft.rotated(0.3), loft] {
        assert_eq!(again(&surface), surface);
    }
    let curve = arc(0.1, 0.0);
    assert_eq!(again(&curve), curve);
    let weights = [1.0, 0.7, 1.3, 1.0];
    let points = [[0.1, 0.0, 0.0], [1.0, 0.3, 0.0], [2.0, -0.3, 1.0], [3.0, 0.0, 0.0]].map(Point3::from);
    let rational = NurbsCurve::try_new(3, vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0], &points, Some(&weights));
    let rational = rational.unwrap();
    assert_eq!(again(&rational), rational);
    let turned = Revolution::new(curve.clone(), nalgebra::Vector2::new(10.0, 0.0));
    assert_eq!(again(&turned), turned);
    assert_eq!(again(&turned.to_surface()), turned.to_surface());
    let pairs: Vec<[Point3<f64>; 2]> =
        (0..30).map(f64::from).map(|t| [Point3::new(t, t.sin(), 0.0), Point3::new(t, 0.0, 9.0)]).collect();
    let dual = DualCurve::through(&pairs, 8).unwrap();
    assert_eq!(again(&dual), dual);
}

#[test]
fn what_no_constructor_makes_is_an_error() {
    let whole = serde_json::to_value(arc(0.0, 0.0)).unwrap();
    let with = |key: &str, value: Value| {
        let mut changed = whole.clone();
        changed[key] = value;
        fault::<NurbsCurve>(changed)
    };
    assert!(with("degree", json!(4)).contains("degree 4"));
    let mut knots = whole["knots"].clone();
    knots.as_array_mut().unwrap().swap(4, 6);
    assert!(with("knots", knots).contains("knots"));
    let mut control = whole["control"].clone();
    control[2][3] = json!(-1.0);
    assert!(with("control", control).contains("weight 3"));
    assert!(with("more", json!(1)).contains("unknown field"));
    assert!(fault::<Revolution>(json!({ "generator": whole, "orientation": 0.5 })).contains("side"));
    let loft = LoftedSurface::through((0..3).map(|k| arc(f64::from(k), 0.0)).collect()).unwrap();
    let mut loft = serde_json::to_value(&loft).unwrap();
    loft["control"][4][0] = json!(1e3);
    assert!(fault::<LoftedSurface>(loft).contains("control point 5"));
}
