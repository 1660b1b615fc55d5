//! Limits that may be infinite, as data: null stands for no limit, since JSON has no infinite numbers.

use serde::de::Error as _;
use serde::ser::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// The finite number of a limit.
fn finite<S: Serializer>(value: f64, none: f64) -> Result<Option<f64>, S::Error> {
    match value {
        value if value.is_finite() => Ok(Some(value)),
        value if value == none => Ok(None),
        value => Err(S::Error::custom(format!("{value} is no limit"))),
    }
}

/// A limit that was read.
fn limit<'de, D: Deserializer<'de>>(deserializer: D, none: f64) -> Result<f64, D::Error> {
    let value = Option::<f64>::deserialize(deserializer)?.unwrap_or(none);
    if value.is_finite() || value == none { Ok(value) } else { Err(D::Error::custom("a limit is not a finite number")) }
}

/// Upper limits: none is plus infinity.
pub(crate) mod above {
    use super::{Deserializer, Serialize, Serializer, finite, limit};

    pub(crate) fn serialize<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
        finite::<S>(*value, f64::INFINITY)?.serialize(serializer)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
        limit(deserializer, f64::INFINITY)
    }
}

/// Lower limits: none is minus infinity.
pub(crate) mod below {
    use super::{Deserializer, Serialize, Serializer, finite, limit};

    pub(crate) fn serialize<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
        finite::<S>(*value, f64::NEG_INFINITY)?.serialize(serializer)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
        limit(deserializer, f64::NEG_INFINITY)
    }
}

#[cfg(test)]
mod tests {
    use crate::{Chain, Machine};
    use nalgebra::{Rotation3, Vector3};
    use serde_json::{Value, from_str, from_value, json, to_string, to_value};

    #[test]
    fn machines_come_back_bit_by_bit() {
        let turned = Rotation3::from_euler_angles(0.1, 0.2, 0.3);
        for chain in [Chain::tilting_table(), Chain::tilting_table().with_part(turned)] {
            let mut machine = Machine::unlimited(chain);
            machine.part_origin = Vector3::new(0.1 + 0.2, -0.0, 1.0 / 3.0);
            machine.rotary[1].min = f64::NEG_INFINITY;
            machine.rotary[1].max = f64::INFINITY;
            let again: Machine = from_str(&to_string(&machine).unwrap()).unwrap();
            assert_eq!(again, machine);
            assert!(again.part_origin.y.is_sign_negative());
        }
    }

    #[test]
    fn impossible_machines_are_errors() {
        let whole = to_value(Machine::unlimited(Chain::tilting_table())).unwrap();
        let fault = |change: &dyn Fn(&mut Value)| {
            let mut changed = whole.clone();
            change(&mut changed);
            from_value::<Machine>(changed).unwrap_err().to_string()
        };
        assert!(fault(&|m| m["chain"]["axes"][0]["direction"] = json!([0.5, 0.0, 0.0])).contains("length 1"));
        assert!(fault(&|m| m["chain"]["axes"][0]["direction"] = json!([0.0, 0.0, 1.0])).contains("parallel"));
        assert!(fault(&|m| m["chain"]["part_axes"] = json!([1, 0, 0, 0, 1, 0, 0, 0, -1])).contains("right-handed"));
        assert!(fault(&|m| m["retract"] = Value::Null).contains("null"));
        assert!(fault(&|m| _ = m.as_object_mut().unwrap().remove("power")).contains("missing field `power`"));
        let mut broken = Machine::unlimited(Chain::tilting_table());
        broken.linear[0].jerk = f64::NAN;
        assert!(to_string(&broken).is_err());
    }
}
