//! Quirks of spline blocks.

use super::{Quirk, changed, spline_blocks};
use crate::bad_nc::{HEIDENHAIN, SIEMENS};

/// A cubic behind the last block but one, from the words of the reference (posts.md, 2.7).
fn spl() -> String {
    let block = "21 SPL X+26.4 Y-19.9 Z+2.3 A+32.2 C+22.5 ~\n  K3X-0.6 K2X+0.6 K1X+2.6 ~\n  K3Y+0.1 K2Y-0.1 K1Y+1.9 ~\n  \
                 K3Z+0.2 K2Z+0.3 K1Z+0.2 ~\n  K3A-0.2 K2A+0.3 K1A-1.3 ~\n  K3C+0.5 K2C-0.3 K1C-1.7 F250\n";
    let text =
        HEIDENHAIN.replace("FUNCTION RESET TCPM", "M129").replace("FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS", "M128");
    let (before, behind) = text.split_once("21 L X+28").unwrap();
    let behind = behind.split_once('\n').unwrap().1;
    format!("{before}{block}{behind}")
}

/// A polynomial behind the last straight block.
pub fn poly() -> String {
    let block = "N151 ORICURVE\nN152 G1 X28 Y-19 Z2 XH=31.8202 YH=-28.3969 ZH=19.3205 F250\nN153 POLY PO[X]=(26.4,-1.2,0.6) \
                 PO[Y]=(-19.9,0.2,-0.1) PO[Z]=(2.3,0.9,-0.2) PO[XH]=(30.2,-1.2,0.6) PO[YH]=(-29.2,0.2,-0.1) \
                 PO[ZH]=(19.6,0.9,-0.2)\nN154 G1 ORIAXES\n";
    SIEMENS.replace("N160 TRAFOOF", &format!("{block}N160 TRAFOOF"))
}

pub fn heidenhain() -> Vec<Quirk> {
    let texts = |changes: &[(&'static str, &'static str)]| changed(&spl(), changes);
    vec![Quirk {
        name: "spl-chained-by-rounded-words",
        written: spline_blocks("heidenhain"),
        texts: texts(&[
            ("K1X+2.6", "K1X+2.6010"),
            ("K1X+2.6", "K1X+2.6011"),
            ("K1A-1.3", "K1A-1.31"),
            ("K1X+2.6", "K1X+2.6E+0"),
            ("K1X+2.6", "K1X+0.26 E+1"),
            ("K1X+2.6", "K1X+12.6"),
            (" K2X+0.6", ""),
            ("K3X-0.6 K2X+0.6", "K2X+0.6 K3X-0.6"),
            ("  K3C+0.5 K2C-0.3 K1C-1.7 F250\n", ""),
            (" C+22.5 ~", " ~"),
            ("16 M128", "16 FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS"),
        ]),
    }]
}

pub fn siemens() -> Vec<Quirk> {
    let texts = |changes: &[(&'static str, &'static str)]| changed(&poly(), changes);
    vec![Quirk {
        name: "polynomials",
        written: spline_blocks("siemens-840d"),
        texts: texts(&[
            ("POLY ", ""),
            ("N151 ORICURVE\n", ""),
            ("N152 G1 X28 Y-19 Z2 XH=31.8202 YH=-28.3969 ZH=19.3205 F250\n", ""),
            ("XH=31.8202", "XH=32.8202"),
            (" ZH=19.3205", ""),
            ("G1 X28 Y-19 Z2 XH", "G1 X27 Y-19 Z2 XH"),
            (" PO[ZH]=(19.6,0.9,-0.2)", ""),
            ("PO[XH]", "PO[A]"),
            ("PO[X]=(26.4,-1.2,0.6)", "PO[X]=(26.4,-1.2,0.6,0,0,1)"),
            ("PO[X]=(26.4,-1.2,0.6)", "X26.4"),
            ("N154 G1 ORIAXES\n", "N154 X20\n"),
            ("N154 G1 ORIAXES\n", "N154 G1 X20\n"),
            ("G90 G94", "G90 G93"),
        ]),
    }]
}
