//! Tools as data (feature `serde`): the checks when one is read. A solid that no distance is right for is an error.

use super::{Cutter, Section, ToolSolid};
use serde::de::Error;
use serde::{Deserialize, Deserializer};
use std::f64::consts::FRAC_PI_4;

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
    Section: StoredSection,
    Cutter: StoredCutter,
    ToolSolid: StoredTool,
}

/// A frustum.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredSection {
    from: f64,
    to: f64,
    radius_from: f64,
    radius_to: f64,
}

impl TryFrom<StoredSection> for Section {
    type Error = &'static str;

    fn try_from(StoredSection { from, to, radius_from, radius_to }: StoredSection) -> Result<Self, Self::Error> {
        let sizes = [from, to, radius_from, radius_to];
        if sizes.iter().all(|x| x.is_finite() && *x >= 0.0) && from <= to {
            Ok(Self { from, to, radius_from, radius_to })
        } else {
            Err("a section of the tool has no height or a negative size")
        }
    }
}

/// A cutter by its kind and sizes.
#[derive(Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
enum StoredCutter {
    Flat { radius: f64 },
    Ball { radius: f64 },
    Bull { radius: f64, corner: f64 },
    TaperedBall { ball: f64, half_angle: f64 },
    Barrel { radius: f64, barrel: f64, tip: f64 },
    Lollipop { radius: f64 },
}

impl TryFrom<StoredCutter> for Cutter {
    type Error = &'static str;

    fn try_from(stored: StoredCutter) -> Result<Self, Self::Error> {
        let length = |x: f64| x.is_finite() && x > 0.0;
        let (cutter, sound) = match stored {
            StoredCutter::Flat { radius } => (Self::Flat { radius }, length(radius)),
            StoredCutter::Ball { radius } => (Self::Ball { radius }, length(radius)),
            StoredCutter::Lollipop { radius } => (Self::Lollipop { radius }, length(radius)),
            StoredCutter::Bull { radius, corner } => {
                (Self::Bull { radius, corner }, length(radius) && length(corner) && corner <= radius)
            }
            StoredCutter::TaperedBall { ball, half_angle } => {
                (Self::TaperedBall { ball, half_angle }, length(ball) && half_angle > 0.0 && half_angle < FRAC_PI_4)
            }
            StoredCutter::Barrel { radius, barrel, tip } => {
                let sound = length(tip) && length(barrel) && tip < radius && radius < barrel;
                (Self::Barrel { radius, barrel, tip }, sound)
            }
        };
        if sound { Ok(cutter) } else { Err("the sizes of a cutter give no cutter of its kind") }
    }
}

/// Cutter, shank and holder.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredTool {
    cutter: Cutter,
    flute_length: f64,
    shank: Vec<Section>,
    holder: Vec<Section>,
}

impl TryFrom<StoredTool> for ToolSolid {
    type Error = &'static str;

    fn try_from(StoredTool { cutter, flute_length, shank, holder }: StoredTool) -> Result<Self, Self::Error> {
        if flute_length.is_finite() && flute_length > 0.0 {
            Ok(Self { cutter, flute_length, shank, holder })
        } else {
            Err("the flutes of a tool have no length")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{from_value, json, to_value};

    #[test]
    fn tools_come_back_and_impossible_ones_do_not() {
        for cutter in [
            Cutter::Flat { radius: 0.1 + 0.2 },
            Cutter::Bull { radius: 3.0, corner: 0.5 },
            Cutter::TaperedBall { ball: 1.0, half_angle: 0.1 },
            Cutter::Barrel { radius: 5.0, barrel: 85.0, tip: 2.0 },
        ] {
            let shank = vec![Section { from: 12.0, to: 25.0, radius_from: 1.0 / 3.0, radius_to: 2.0 }];
            let tool = ToolSolid { cutter, flute_length: 12.0, shank, holder: Vec::new() };
            let stored = to_value(&tool).unwrap();
            assert_eq!(from_value::<ToolSolid>(stored.clone()).unwrap(), tool);
            for (key, value) in
                [("flute_length", json!(0)), ("cutter", json!({ "bull": { "radius": 1, "corner": 2 } }))]
            {
                let mut changed = stored.clone();
                changed[key] = value;
                assert!(from_value::<ToolSolid>(changed).is_err(), "{key}");
            }
            let mut changed = stored.clone();
            changed["shank"][0]["to"] = json!(11.0);
            assert!(from_value::<ToolSolid>(changed).is_err());
        }
    }
}
