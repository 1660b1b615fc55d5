//! Quirks of LinuxCNC.

use super::{Quirk, Step, blocks, changed};
use crate::bad_nc::LINUXCNC;
use impellerc::wheel::control::Orientation::Angles;

/// A rapid of 0.02 um, which would be slower than the interpreter can say.
const MOVES: [Step; 3] = [
    ([50.0, -40.0, 10.0], [30.0, 20.0], None),
    ([50.0, -40.0, 10.000_02], [34.0, 20.0], None),
    ([30.0, -17.0, 4.0], [34.0, 20.0], Some(1000.0)),
];

pub fn quirks() -> Vec<Quirk> {
    let texts = |changes: &[(&'static str, &'static str)]| changed(LINUXCNC, changes);
    vec![
        Quirk {
            name: "inverse-time",
            written: blocks("linuxcnc", Angles, &MOVES),
            texts: texts(&[
                ("G1 X29 Y-18 Z3 A-31 C-21 F250", "G93 G1 X29 Y-18 Z3 A-31 C-21 F250"),
                ("G1 X29 Y-18 Z3 A-31 C-21 F250", "G93 G1 X29 Y-18 Z3 A-31 C-21"),
                ("G1 X29 Y-18 Z3 A-31 C-21 F250", "G93 G1 X30 Y-17 Z4.00001 A-31 C-21 F60"),
                ("G1 X28 Y-19 Z2 A-32 C-22", "G93 G1 X28 Y-19 Z2 A-32 C-22 F60\nG94 G1 X27"),
            ]),
        },
        Quirk {
            name: "numbers",
            written: Vec::new(),
            texts: texts(&[("X29 Y-18", "X29E0 Y-18"), ("X29 Y-18", "X29 X29 Y-18"), ("X29 Y-18", "X29,5 Y-18")]),
        },
        Quirk {
            name: "splines",
            written: Vec::new(),
            texts: texts(&[
                ("G1 X29 Y-18 Z3 A-31 C-21 F250", "G5.2 X29 Y-18 P1 L4"),
                ("G1 X29 Y-18 Z3 A-31 C-21 F250", "G5 X29 Y-18 I0 J1 P0 Q1"),
            ]),
        },
    ]
}
