//! Quirks of Klartext.

use super::{Quirk, Step, blocks, changed};
use crate::bad_nc::HEIDENHAIN;
use impellerc::nc;
use impellerc::wheel::control::Orientation::{Angles, Vectors};

/// Tips, rotary axes, feeds.
const MOVES: [Step; 4] = [
    ([50.0, -40.0, 10.0], [30.0, 20.0], None),
    ([30.0, -0.000_04, 4.0], [30.0, -0.000_04], Some(1000.0)),
    ([29.0, 0.0, 3.0], [31.0, 0.0], Some(1000.0)),
    ([50.0, -40.0, 10.0], [31.0, 0.0], None),
];

fn m128() -> String {
    HEIDENHAIN
        .replace("FUNCTION RESET TCPM", "M129")
        .replace("FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS", "M128 F30000")
}

pub fn quirks() -> Vec<Quirk> {
    let tcpm = |changes: &[(&'static str, &'static str)]| changed(HEIDENHAIN, changes);
    let by_m128 = |changes: &[(&'static str, &'static str)]| changed(&m128(), changes);
    let number = |value: f64| nc::find("heidenhain").unwrap().number(value, 4);
    vec![
        Quirk {
            name: "negative-zero",
            written: blocks("heidenhain", Angles, &MOVES),
            texts: tcpm(&[("X+29 Y-18", "X+29 Y-0.0000")]),
        },
        Quirk {
            name: "sign",
            written: [12.5, -12.5, 0.0, -0.000_04].map(number).to_vec(),
            texts: tcpm(&[
                ("X+29", "X29"),
                ("X+29", "X +29"),
                ("X+29", "X+-29"),
                ("X+29", "X29,5"),
                ("X+29", "X29.12345"),
            ]),
        },
        Quirk {
            name: "block-numbers",
            written: Vec::new(),
            texts: tcpm(&[
                ("26 END PGM", "30 END PGM"),
                ("20 L X+29", "25 L X+29"),
                ("20 L X+29", "19 L X+29"),
                ("20 L X+29", "L X+29"),
                ("20 L X+29", "N20 L X+29"),
                ("1 ; a test", "; a test"),
            ]),
        },
        Quirk {
            name: "vector-components",
            written: blocks("heidenhain", Vectors, &MOVES),
            texts: tcpm(&[
                (" TX+0.17101007", ""),
                ("X+30 Y-17 Z+4 TX", "Y-17 Z+4 TX"),
                ("TX+0.17101007 TY-0.46984631", "TY-0.46984631 TX+0.17101007"),
                ("TX+0.17101007 TY-0.46984631 TZ+0.8660254", "TX+0.17 TY-0.47 TZ+0.87"),
                ("TX+0.17101007 TY-0.46984631 TZ+0.8660254", "TX+0.171010 TY-0.469846 TZ+0.866025"),
                ("19 LN", "19 L"),
                ("20 L X", "20 LN X"),
            ]),
        },
        Quirk {
            name: "program-name",
            written: Vec::new(),
            texts: tcpm(&[
                ("END PGM TEST MM", "END PGM BLADE MM"),
                ("END PGM TEST MM", "END PGM TEST INCH"),
                ("26 END PGM TEST MM\n", ""),
                ("BEGIN PGM TEST MM", "BEGIN PGM TEST INCH"),
            ]),
        },
        Quirk {
            name: "feed-of-m128",
            written: Vec::new(),
            texts: by_m128(&[
                ("M128 F30000", "M128"),
                ("M128 F30000", "M128 F1000"),
                ("M128 F30000", "L F1000 M128"),
                ("M128 F30000", "FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS"),
            ]),
        },
        Quirk {
            name: "rotary-tolerance",
            written: Vec::new(),
            texts: tcpm(&[
                ("HSC-MODE:0 TA0.05", "HSC-MODE:0"),
                ("HSC-MODE:0 TA0.05", "HSC-MODE:0 TA0"),
                ("HSC-MODE:0 TA0.05", "HSC-MODE:0 TA1"),
                ("14 CYCL DEF 32.2 HSC-MODE:0 TA0.05\n", ""),
                ("32.1 T0.001\n14 CYCL DEF 32.2 HSC-MODE:0 TA0.05", "32.1"),
            ]),
        },
        Quirk {
            name: "rapid-in-its-block",
            written: blocks("heidenhain", Angles, &MOVES),
            texts: tcpm(&[("C+21 F250", "C+21 FMAX"), ("C+20 R0 FMAX\n19", "C+20 R0\n19"), ("17 M8", "17 L FMAX M8")]),
        },
        Quirk {
            name: "speed-alone",
            written: Vec::new(),
            texts: tcpm(&[
                ("TOOL CALL 2 Z S8000", "TOOL CALL Z S8000"),
                ("15 M3", "15 TOOL CALL Z S8000 M3"),
                ("TOOL CALL 2 Z S8000", "TOOL CALL 2 S8000"),
                ("17 M8", "17 TOOL CALL Z S9000"),
            ]),
        },
        Quirk {
            name: "settings-of-tcpm",
            written: Vec::new(),
            texts: tcpm(&[
                ("F TCP AXIS POS", "F CONT AXIS POS"),
                ("F TCP AXIS POS", "F TCP AXIS SPAT"),
                ("F TCP AXIS POS", "AXIS POS"),
                ("PATHCTRL AXIS", "PATHCTRL AXIS REFPNT CENTER-CENTER"),
                ("PATHCTRL AXIS", "PATHCTRL AXIS REFPNT TIP-TIP"),
            ]),
        },
        Quirk {
            name: "machine-frame",
            written: Vec::new(),
            texts: tcpm(&[
                ("22 FUNCTION RESET TCPM\n", ""),
                ("7 L Z+350 R0 FMAX M91", "7 L Z+350 R0 FMAX"),
                ("7 L Z+350 R0 FMAX M91", "7 L Z+350 R0 FMAX M92"),
                ("7 L Z+350 R0 FMAX M91", "7 M140 MB MAX"),
                ("5 PLANE RESET STAY\n", ""),
            ]),
        },
        Quirk { name: "shorter-way", written: Vec::new(), texts: tcpm(&[("6 M126\n", ""), ("6 M126", "6 M127")]) },
        Quirk {
            name: "incremental",
            written: Vec::new(),
            texts: tcpm(&[("L X+29", "L IX+29"), ("A+31", "IA+1"), ("L X+29 Y-18", "LP PR+5 PA+10")]),
        },
    ]
}
