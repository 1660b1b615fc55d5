//! Tools as data (feature `serde`): they come back, and a solid that no distance is right for does not.

use super::{Cutter, Section, ToolSolid};
use serde_json::{from_value, json, to_value};

#[test]
fn tools_come_back_and_impossible_ones_do_not() {
    let [chamfered, _] = super::samples::turned();
    for cutter in [
        Cutter::flat(0.1 + 0.2),
        Cutter::bull(3.0, 0.5),
        Cutter::tapered_ball(1.0, 0.1),
        Cutter::barrel(5.0, 85.0, 2.0),
        chamfered,
    ] {
        let shank = vec![Section { from: 12.0, to: 25.0, radius_from: 1.0 / 3.0, radius_to: 2.0 }];
        let tool = ToolSolid { cutter, flute_length: 12.0, shank, holder: Vec::new() };
        let stored = to_value(&tool).unwrap();
        assert_eq!(from_value::<ToolSolid>(stored.clone()).unwrap(), tool);
        for (key, value) in [("flute_length", json!(0)), ("cutter", json!({ "bull": { "radius": 1, "corner": 2 } }))] {
            let mut changed = stored.clone();
            changed[key] = value;
            assert!(from_value::<ToolSolid>(changed).is_err(), "{key}");
        }
        let mut changed = stored.clone();
        changed["shank"][0]["to"] = json!(11.0);
        assert!(from_value::<ToolSolid>(changed).is_err());
    }
}
