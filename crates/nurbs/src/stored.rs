//! Curves and surfaces as data (feature `serde`): what defines each of them, and the checks when one is read. A value that no
//! constructor would make is an error.

use super::bezier::MOST_DEGREE;
use super::{DualCurve, GeomError, LoftedSurface, NurbsCurve, NurbsSurface, Revolution, basis};
use nalgebra::{Point3, Vector3, Vector4};
use serde::de::Error;
use serde::{Deserialize, Deserializer};

/// Reads a value through the data that define it.
macro_rules! checked {
    ($($value:ty: $stored:ty),* $(,)?) => {
        $(impl<'de> Deserialize<'de> for $value {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                Self::try_from(<$stored>::deserialize(deserializer)?).map_err(D::Error::custom)
            }
        })*
    };
}

checked! {
    NurbsCurve: StoredCurve,
    NurbsSurface: StoredSurface,
    Revolution: StoredRevolution,
    LoftedSurface: StoredLoft,
    DualCurve: StoredDual,
}

/// A curve with homogeneous control points.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredCurve {
    degree: usize,
    knots: Vec<f64>,
    control: Vec<Vector4<f64>>,
}

/// Refuses homogeneous control points that are not finite or have no positive weight.
fn check_control(control: &[Vector4<f64>]) -> Result<(), GeomError> {
    if let Some(i) = control.iter().position(|c| !c.iter().all(|x| x.is_finite())) {
        return Err(GeomError::NotFinite(i));
    }
    control.iter().position(|c| c.w <= 0.0).map_or(Ok(()), |i| Err(GeomError::Weight(i)))
}

impl TryFrom<StoredCurve> for NurbsCurve {
    type Error = GeomError;

    fn try_from(StoredCurve { degree, knots, control }: StoredCurve) -> Result<Self, GeomError> {
        if !(1..=basis::MAX_DEGREE).contains(&degree) {
            return Err(GeomError::Degree(degree));
        }
        if !basis::valid_knots(&knots, degree, control.len()) {
            return Err(GeomError::Knots);
        }
        check_control(&control)?;
        Ok(Self::from_homogeneous(degree, knots, control))
    }
}

/// A surface with homogeneous control points.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredSurface {
    degree: [usize; 2],
    knots: [Vec<f64>; 2],
    control: Vec<Vector4<f64>>,
}

impl TryFrom<StoredSurface> for NurbsSurface {
    type Error = GeomError;

    fn try_from(StoredSurface { degree, knots, control }: StoredSurface) -> Result<Self, GeomError> {
        if let Some(p) = degree.iter().find(|p| !(1..=basis::MAX_DEGREE).contains(*p)) {
            return Err(GeomError::Degree(*p));
        }
        let count = |k: usize| knots[k].len().checked_sub(degree[k] + 1);
        let (Some(rows), Some(columns)) = (count(0), count(1)) else { return Err(GeomError::Knots) };
        if !basis::valid_knots(&knots[0], degree[0], rows) || !basis::valid_knots(&knots[1], degree[1], columns) {
            return Err(GeomError::Knots);
        }
        if rows.checked_mul(columns) != Some(control.len()) {
            return Err(GeomError::TooFewPoints { given: control.len(), needed: rows.saturating_mul(columns) });
        }
        check_control(&control)?;
        Ok(Self::from_homogeneous(degree, knots, control))
    }
}

/// A surface of revolution: its seeds follow from the curve.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredRevolution {
    generator: NurbsCurve,
    orientation: f64,
}

impl TryFrom<StoredRevolution> for Revolution {
    type Error = GeomError;

    fn try_from(StoredRevolution { generator, orientation }: StoredRevolution) -> Result<Self, GeomError> {
        if orientation.abs() == 1.0 { Ok(Self::oriented(generator, orientation)) } else { Err(GeomError::Orientation) }
    }
}

/// A lofted surface. Degrees and knots follow from the sections; control points do so to rounding, since a turned surface has
/// turned ones.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredLoft {
    sections: Vec<NurbsCurve>,
    places: Vec<f64>,
    control: Vec<Vector3<f64>>,
}

/// Most sections of a surface that is read: no blade has as many, and the matrix between them grows by the square.
const MOST_SECTIONS: usize = 1000;

/// Share of the size of a surface to which control points follow from the sections.
const SAME_CONTROL: f64 = 1e-6;

impl TryFrom<StoredLoft> for LoftedSurface {
    type Error = GeomError;

    fn try_from(StoredLoft { sections, places, control }: StoredLoft) -> Result<Self, GeomError> {
        if sections.len() > MOST_SECTIONS {
            return Err(GeomError::TooManySections(sections.len()));
        }
        if places.first() != Some(&0.0) || places.last() != Some(&1.0) {
            return Err(GeomError::Knots);
        }
        let made = Self::at(sections, places)?;
        let due = made.control();
        if due.len() != control.len() {
            return Err(GeomError::TooFewPoints { given: control.len(), needed: due.len() });
        }
        let size = due.iter().map(|p| p.amax()).fold(1.0, f64::max);
        let follows = |(due, given): (&Vector3<f64>, &Vector3<f64>)| (due - given).amax() <= SAME_CONTROL * size;
        match due.iter().zip(&control).position(|pair| !follows(pair)) {
            Some(i) => Err(GeomError::Control(i)),
            None => Ok(made.with_control(control)),
        }
    }
}

/// Two B-splines on common knots.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredDual {
    degree: usize,
    knots: Vec<f64>,
    lower: Vec<Point3<f64>>,
    upper: Vec<Point3<f64>>,
}

impl TryFrom<StoredDual> for DualCurve {
    type Error = GeomError;

    fn try_from(StoredDual { degree, knots, lower, upper }: StoredDual) -> Result<Self, GeomError> {
        if ![basis::MAX_DEGREE, MOST_DEGREE].contains(&degree) {
            return Err(GeomError::Degree(degree));
        }
        if lower.len() != upper.len() {
            return Err(GeomError::TooFewPoints { given: upper.len(), needed: lower.len() });
        }
        if !basis::valid_knots(&knots, degree, lower.len()) {
            return Err(GeomError::Knots);
        }
        if let Some(i) = lower.iter().chain(&upper).position(|p| !p.iter().all(|x| x.is_finite())) {
            return Err(GeomError::NotFinite(i));
        }
        Ok(Self::of_parts(degree, knots, lower, upper))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    fn arc(z: f64, turn: f64) -> NurbsCurve {
        let at = |i: u32| turn + 0.2 * f64::from(i);
        let points: Vec<Point3<f64>> = (0..7)
            .map(|i| Point3::new(20.0 * libm::cos(at(i)), 20.0 * libm::sin(at(i)), z + 0.3 * f64::from(i)))
            .collect();
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
}
