//! Quirks of the 840D.

use super::{Quirk, Step, blocks, changed};
use crate::bad_nc::SIEMENS;
use impellerc::wheel::control::Orientation::{Angles, Vectors};

/// Tips, rotary axes, feeds: a component of the last vector is 0.
const MOVES: [Step; 3] = [
    ([50.0, -40.0, 10.0], [30.0, 20.0], None),
    ([30.0, -0.000_04, 4.0], [30.0, 20.0], Some(1000.0)),
    ([29.0, 0.0, 3.0], [31.0, 0.0], Some(1000.0)),
];

/// C runs to the end of its travel.
const TO_180: [Step; 3] = [
    ([50.0, -40.0, 10.0], [30.0, 179.0], None),
    ([30.0, -17.0, 4.0], [30.0, 180.0], Some(1000.0)),
    ([29.0, -18.0, 3.0], [30.0, 179.5], Some(1000.0)),
];

pub fn quirks() -> Vec<Quirk> {
    let texts = |changes: &[(&'static str, &'static str)]| changed(SIEMENS, changes);
    let long: &'static str = Box::leak(format!("N140 G1 X29{}", " ".repeat(500)).into_boxed_str());
    vec![
        Quirk {
            name: "omitted-components",
            written: blocks("siemens-840d", Vectors, &MOVES),
            texts: texts(&[
                ("A3=0.17101007 B3=-0.46984631 C3=0.86602540", "B3=-0.46984631 C3=0.86602540"),
                ("A3=0.17101007 B3=-0.46984631 C3=0.86602540", "A3=0 B3=0 C3=0"),
                ("A3=0.17101007", "A3 0.17101007"),
            ]),
        },
        Quirk {
            name: "c-across-180",
            written: blocks("siemens-840d", Angles, &TO_180),
            texts: texts(&[
                ("A=30 C=20\nN130", "A=30 C=190\nN130"),
                ("A=30 C=20\nN130", "A=30 C=DC(190)\nN130"),
                ("A=30 C=20\nN130", "A=30 C=IC(170)\nN130"),
            ]),
        },
        Quirk {
            name: "frame-of-switch",
            written: Vec::new(),
            texts: texts(&[("N110 G54 ORIWKS", "N110 ORIWKS"), ("N110 G54 ORIWKS", "N110 G500 ORIWKS")]),
        },
        Quirk { name: "line-length", written: Vec::new(), texts: texts(&[("N140 G1 X29", long)]) },
    ]
}
