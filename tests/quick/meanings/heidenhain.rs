//! Changes for iTNC 530 and TNC 640. Reasons come from their user's manuals.

use super::Change::{All, Cut, First, Job, Last, Machine, Move, Operations, Text, Word};
use super::How::{Address, Double, Number};
use super::Kind;
use super::Verdict::{Found, Harmless, Refused};
use super::operations;
use impellerc::base::entity::PrimaryMap;
use impellerc::base::units::Mm;

/// Of the text with positions of the rotary axes.
pub fn kinds() -> Vec<Kind> {
    let mut all = Vec::new();
    all.extend(head());
    all.extend(change());
    all.extend(smoothing());
    all.extend(perimeter());
    all.extend(transformation());
    all.extend(path());
    all.extend(moves());
    all.extend(numbers());
    all.extend(spelling());
    all.extend(end());
    all.extend(operations());
    all.extend(wrong());
    all
}

fn head() -> Vec<Kind> {
    const C: &str = "head";
    vec![
        (C, First("BEGIN PGM SMALL MM\n", ""), Refused, "the units are not known"),
        (C, First("BEGIN PGM SMALL MM", "BEGIN PGM SMALL INCH"), Refused, "inches, and F in tenths of an inch"),
        (C, All("PGM SMALL MM", "PGM SMALL INCH"), Refused, "inches, and F in tenths of an inch"),
        (C, First("BEGIN PGM SMALL MM", "BEGIN PGM SMALL"), Refused, "the units are not known"),
        (C, First("BEGIN PGM SMALL MM", "BEGIN PGM OTHER MM"), Refused, "begin and end differ"),
        (C, All("PGM SMALL MM", "PGM OTHER MM"), Harmless, "the name of the file"),
        (C, First("BEGIN PGM SMALL MM\n", "BEGIN PGM SMALL MM\nBEGIN PGM SMALL MM\n"), Refused, "begins twice"),
        (C, First("BEGIN PGM SMALL MM", "%SMALL G71"), Refused, "DIN/ISO is another language"),
        (C, First("FUNCTION RESET TCPM\n", ""), Refused, "TCPM can be on since an aborted run"),
        (C, First("FUNCTION RESET TCPM\n", "M129\n"), Refused, "M129 is not said to end FUNCTION TCPM"),
        (C, First("FUNCTION RESET TCPM\n", "FUNCTION RESET TCPM\nFUNCTION RESET TCPM\n"), Harmless, "said twice"),
        (C, First("FUNCTION RESET TCPM\n", "FUNCTION RESET\n"), Refused, "no word of the language"),
        (
            C,
            First("FUNCTION RESET TCPM\n", "L Z+650 R0 FMAX M91\nFUNCTION RESET TCPM\n"),
            Refused,
            "M91 needs TCPM off",
        ),
        (C, First("FUNCTION RESET TCPM\n", "PLANE RESET STAY\nFUNCTION RESET TCPM\n"), Refused, "TCPM can be on"),
        (C, First("PLANE RESET STAY\n", ""), Refused, "the plane can be tilted since an aborted run"),
        (C, First("PLANE RESET STAY\n", "PLANE RESET MOVE\n"), Refused, "turns the axes at once"),
        (C, First("PLANE RESET STAY\n", "PLANE RESET\n"), Refused, "how it resets is not said"),
        (C, First("PLANE RESET STAY\n", "PLANE SPATIAL SPA+10 SPB+0 SPC+0 STAY\n"), Refused, "tilts the working plane"),
        (C, First("PLANE RESET STAY\n", "PLANE RESET STAY\nPLANE RESET STAY\n"), Harmless, "said twice"),
        (C, First("M126\n", ""), Refused, "a parameter decides on the way of a rotary axis"),
        (C, First("M126\n", "M127\n"), Refused, "the long way where the display stays below 360 deg"),
        (C, First("M126\n", "M126\nM126\n"), Harmless, "said twice"),
        (C, First("M126\n", "L M126\n"), Harmless, "in a block of L"),
        (C, First("M126\n", "M126 M127\n"), Refused, "two words of one group"),
        (C, First("M126\n", "M126\nM94\n"), Refused, "changes the position of a rotary axis"),
        (C, First("M126\n", "M126\nM116\n"), Refused, "another meaning of F"),
        (C, First("M126\n", "M126\nM136\n"), Refused, "feed a revolution"),
        (C, First("M126\n", "M126\nM103 F20\n"), Refused, "a share of the feed downwards"),
        (C, First("M126\n", "M126\nM118 X1\n"), Refused, "the handwheel moves the tool"),
        (C, First("M126\n", "M126\nM138 C\n"), Refused, "other axes compensate"),
        (C, First("M126\n", "M126\nM144\n"), Refused, "other kinematics"),
        (C, First("M126\n", "M126\nM120 LA50\n"), Refused, "looks ahead for radius compensation"),
        (C, First("M126\n", "M126\nM7\n"), Refused, "the machine builder decides"),
        (C, First("M126\n", "M126\nM999\n"), Refused, "the machine builder decides"),
        (C, First("M126\n", "M126\nBLK FORM 0.1 Z X-60 Y-60 Z-40\nBLK FORM 0.2 X+60 Y+60 Z+0\n"), Harmless, "a blank"),
        (C, First("M126\n", "M126\nBLK FORM CYLINDER Z R50 L105 DIST+5 RI10\n"), Harmless, "a blank"),
        (C, First("M126\n", "M126\nBLK FORM 0.1 X X-60 Y-60 Z-40\n"), Refused, "another tool axis"),
        (C, First("M126\n", "M126\nBLK FORM 0.1 Z X-60 Y-60\n"), Refused, "Z is missing"),
        (C, First("M126\n", "M126\nBLK FORM 0.2 X+60 Y+60 Z+0\n"), Refused, "the first corner is missing"),
        (
            C,
            First("M126\n", "M126\nBLK FORM 0.1 Z X-60 Y-60 Z-40\nBLK FORM 0.2 X+60 Y+60 Z-50\n"),
            Refused,
            "the corners are exchanged",
        ),
        (C, First("M126\n", "M126\nQ1=+5\n"), Refused, "a parameter"),
        (C, First("M126\n", "M126\nFN 0: Q1 = +5\n"), Refused, "a parameter"),
        (C, First("M126\n", "M126\nTRANS DATUM AXIS X+5\n"), Refused, "shifts the frame"),
        (C, First("M126\n", "M126\nCYCL DEF 7.0 DATUM SHIFT\nCYCL DEF 7.1 X+5\n"), Refused, "shifts the frame"),
        (C, First("M126\n", "M126\nCYCL DEF 10.0 ROTATION\nCYCL DEF 10.1 ROT+5\n"), Refused, "turns the frame"),
        (C, First("M126\n", "M126\nCYCL DEF 8.0 MIRROR IMAGE\nCYCL DEF 8.1 X\n"), Refused, "mirrors the frame"),
        (C, First("M126\n", "M126\nCYCL DEF 11.0 SCALING\nCYCL DEF 11.1 SCL2\n"), Refused, "scales the frame"),
        (C, First("M126\n", "M126\nCYCL DEF 19.0 WORKING PLANE\nCYCL DEF 19.1 A+5\n"), Refused, "tilts the plane"),
    ]
}

fn change() -> Vec<Kind> {
    const C: &str = "tool change";
    vec![
        (C, First("TOOL CALL 1 Z S12000\n", ""), Refused, "whichever tool is in the spindle"),
        (C, First("TOOL CALL 1 Z S12000", "TOOL CALL 2 Z S12000"), Refused, "another tool"),
        (C, First("TOOL CALL 1 Z S12000", "TOOL CALL 0 Z S12000"), Refused, "no tool"),
        (C, First("TOOL CALL 1 Z S12000", "TOOL CALL 99999 Z S12000"), Refused, "beyond the tool table"),
        (C, First("TOOL CALL 1 Z S12000", "TOOL CALL 1.1 Z S12000"), Refused, "an indexed tool has other data"),
        (C, First("TOOL CALL 1 Z S12000", "TOOL CALL Q5 Z S12000"), Refused, "a parameter"),
        (C, First("TOOL CALL 1 Z S12000", "TOOL CALL -1 Z S12000"), Refused, "no number of a tool"),
        (C, First("TOOL CALL 1 Z S12000", "TOOL CALL \"T1\" Z S12000"), Harmless, "by name"),
        (C, First("TOOL CALL 1 Z S12000", "TOOL CALL \"T2\" Z S12000"), Refused, "another tool"),
        (C, First("TOOL CALL 1 Z S12000", "TOOL CALL \"t1\" Z S12000"), Refused, "the table has capital letters only"),
        (C, First("TOOL CALL 1 Z S12000", "TOOL CALL \"1\" Z S12000"), Refused, "the tool named 1"),
        (C, First("TOOL CALL 1 Z S12000", "TOOL CALL \"\" Z S12000"), Refused, "no name"),
        (C, First("TOOL CALL 1 Z S12000", "TOOL CALL \"T1 Z S12000"), Refused, "no end of the name"),
        (C, First("TOOL CALL 1 Z S12000", "TOOL CALL 1 X S12000"), Refused, "the length acts on X"),
        (C, First("TOOL CALL 1 Z S12000", "TOOL CALL 1 Y S12000"), Refused, "the length acts on Y"),
        (C, First("TOOL CALL 1 Z S12000", "TOOL CALL 1 S12000"), Refused, "on which axis the length acts is left over"),
        (C, First("TOOL CALL 1 Z S12000", "TOOL CALL Z S12000"), Refused, "changes the speed, not the tool"),
        (C, First("TOOL CALL 1 Z S12000", "TOOL CALL 1 Z"), Refused, "the speed is left over"),
        (C, First("TOOL CALL 1 Z S12000", "TOOL CALL 1 Z S6000"), Refused, "another speed than that of the job"),
        (C, First("TOOL CALL 1 Z S12000", "TOOL CALL 1 Z S0"), Refused, "standstill"),
        (C, First("TOOL CALL 1 Z S12000", "TOOL CALL 1 Z S-5"), Refused, "a negative speed"),
        (C, First("TOOL CALL 1 Z S12000", "TOOL CALL 1 Z S12000 S12000"), Refused, "a word twice"),
        (C, First("TOOL CALL 1 Z S12000", "TOOL CALL 1 Z S12000 DL+0.1"), Refused, "another length"),
        (C, First("TOOL CALL 1 Z S12000", "TOOL CALL 1 Z S12000 DR-0.1"), Refused, "another radius"),
        (C, First("TOOL CALL 1 Z S12000", "TOOL CALL 1 Z S12000 DR2+0.1"), Refused, "another radius"),
        (
            C,
            First("TOOL CALL 1 Z S12000", "TOOL CALL 1 Z S12000 F100"),
            Harmless,
            "F follows in the first block at feed",
        ),
        (C, First("TOOL CALL 1 Z S12000", "TOOL CALL 1 Z S12000 M3"), Refused, "no word of TOOL CALL"),
        (C, First("TOOL CALL 1 Z S12000", "TOOL CALL"), Refused, "which tool is not said"),
        (C, First("TOOL CALL 1 Z S12000", "TOOL CALL 01 Z S12000.000"), Harmless, "leading and trailing zeros"),
        (C, First("TOOL CALL 1 Z S12000", "TOOL CALL 1 Z S6000\nTOOL CALL Z S12000"), Harmless, "the speed alone"),
        (C, First("TOOL CALL 1 Z S12000\n", "TOOL DEF 2\nTOOL CALL 1 Z S12000\n"), Harmless, "brings the next tool"),
        (C, First("TOOL CALL 1 Z S12000\n", "TOOL CALL 1 Z S12000\nTOOL DEF 2\n"), Harmless, "brings the next tool"),
        (
            C,
            First("TOOL CALL 1 Z S12000\n", "TOOL DEF 1 L+30 R+1\nTOOL CALL 1 Z S12000\n"),
            Refused,
            "another tool table",
        ),
        (C, First("TOOL CALL 1 Z S12000\n", "T1 M6\n"), Refused, "no words of the language"),
        (
            C,
            First("TOOL CALL 1 Z S12000\n", "TOOL CALL 1 Z S12000\nTOOL CALL 2 Z S12000\n"),
            Refused,
            "another tool and length",
        ),
        (C, First("M3\n", ""), Refused, "the spindle stands since TOOL CALL"),
        (C, First("M3\n", "M4\n"), Refused, "the wrong way round"),
        (C, First("M3\n", "M5\n"), Refused, "standstill"),
        (C, First("M3\n", "M13\n"), Harmless, "with coolant"),
        (C, First("M3\n", "M14\n"), Refused, "the wrong way round"),
        (C, First("M3\n", "M03\n"), Harmless, "leading zeros"),
        (C, First("M3\n", "M3 M8\n"), Harmless, "two words"),
        (C, First("M3\n", "M3 M4\n"), Refused, "two words of one group"),
        (C, First("M3\n", "M3 M8 M126\n"), Refused, "two M words a block"),
        (C, First("M3\n", "M3\nM0\n"), Refused, "M0 stops the spindle"),
        (C, First("M3\n", "M0\nM3\n"), Harmless, "waits with the tool retracted"),
        (C, First("M3\n", "M1\nM3\n"), Harmless, "waits with the tool retracted"),
        (C, First("M3\n", "STOP\nM3\n"), Harmless, "waits with the tool retracted"),
        (C, First("M3\n", "M3\nSTOP\n"), Refused, "a stop ends the spindle"),
        (C, First("M3\n", "M3\nM19\n"), Refused, "positions the spindle"),
        (C, First("M3\n", "M3\nCYCL DEF 9.0 DWELL TIME\n"), Refused, "a dwell"),
        (C, First("M3\n", "M3\nCYCL DEF 13.0 ORIENTATION\n"), Refused, "positions the spindle"),
        (C, First("M3\n", "M3\nM6\n"), Refused, "another tool change"),
    ]
}

fn smoothing() -> Vec<Kind> {
    const C: &str = "smoothing";
    const LAST: &str = "CYCL DEF 32.2 HSC-MODE:1 TA0.1000\n";
    vec![
        (C, First("CYCL DEF 32.1 T0.0500", "CYCL DEF 32.1 T0.5"), Refused, "more than the job allows"),
        (C, First("CYCL DEF 32.1 T0.0500", "CYCL DEF 32.1 T0"), Refused, "the control takes its own"),
        (C, First("CYCL DEF 32.1 T0.0500", "CYCL DEF 32.1 T-1"), Refused, "a negative tolerance"),
        (C, First("CYCL DEF 32.1 T0.0500", "CYCL DEF 32.1 T0.05001"), Refused, "too many digits"),
        (C, First("CYCL DEF 32.1 T0.0500", "CYCL DEF 32.1 T"), Refused, "a number is missing"),
        (C, First("CYCL DEF 32.1 T0.0500", "CYCL DEF 32.1 T0.0010"), Harmless, "finer"),
        (C, First("CYCL DEF 32.1 T0.0500", "CYCL DEF 32.1 T+0.05"), Harmless, "with a sign"),
        (C, First("CYCL DEF 32.1 T0.0500\n", ""), Refused, "32.1 is missing"),
        (C, First(LAST, ""), Refused, "the tolerance of the axes is missing"),
        (C, First(LAST, "CYCL DEF 32.2 HSC-MODE:1\n"), Refused, "the tolerance of the axes is missing"),
        (C, First(LAST, "CYCL DEF 32.2 HSC-MODE:1 TA0\n"), Refused, "the control takes its own"),
        (C, First(LAST, "CYCL DEF 32.2 HSC-MODE:1 TA5\n"), Refused, "the axis leans by more"),
        (C, First(LAST, "CYCL DEF 32.2 HSC-MODE:0 TA0.1\n"), Harmless, "the filter of finishing"),
        (C, First(LAST, "CYCL DEF 32.2 HSC-MODE:2 TA0.1\n"), Refused, "no such mode"),
        (C, First(LAST, "CYCL DEF 32.2 TA0.1\n"), Refused, "the mode is missing"),
        (C, First(LAST, "CYCL DEF 32.2 HSC-MODE:1 TA0.01\n"), Harmless, "finer"),
        (
            C,
            Text("TA0.1 in finishing", |t| super::siemens::wide_turn(t, "HSC-MODE:0 TA", "\n")),
            Refused,
            "more than the flutes of the tool allow",
        ),
        (C, First("CYCL DEF 32.0 TOLERANCE\nCYCL DEF 32.1 T0.0500\n", ""), Refused, "two blocks are missing"),
        (
            C,
            First("CYCL DEF 32.1 T0.0500\n", "CYCL DEF 32.1 T0.0500\nM126\n"),
            Refused,
            "another block inside of the cycle",
        ),
        (
            C,
            First("CYCL DEF 32.1 T0.0500\nCYCL DEF 32.2 HSC-MODE:1 TA0.1000\n", "CYCL DEF 32.1\n"),
            Refused,
            "settings of the machine",
        ),
        (C, First("CYCL DEF 32.0 TOLERANCE", "CYCL DEF 32.0 TOLERANZ"), Harmless, "the name of the cycle"),
        (C, First("CYCL DEF 32.0 TOLERANCE", "CYCL DEF 32.0"), Harmless, "the name of the cycle"),
        (C, First("CYCL DEF 32.0 TOLERANCE\n", "CYCL DEF 332 TOLERANCE\n"), Refused, "a cycle of the machine builder"),
        (C, First("CYCL DEF 32.0 TOLERANCE\n", "CYCL CALL\nCYCL DEF 32.0 TOLERANCE\n"), Refused, "calls a cycle"),
        (C, Last("CYCL DEF 32.1 T0.0010", "CYCL DEF 32.1 T0.05"), Refused, "more than the job allows"),
    ]
}

fn perimeter() -> Vec<Kind> {
    const C: &str = "perimeter";
    const UP: &str = "L Z+650.0000 R0 FMAX M91";
    vec![
        (C, First("L Z+650.0000 R0 FMAX M91\n", ""), Refused, "tool change at an unknown height"),
        (C, First(UP, "L Z+650 R0 FMAX"), Refused, "offsets act"),
        (C, First(UP, "L Z+650 R0 FMAX M92"), Refused, "the machine builder sets the point"),
        (C, First(UP, "L Z+650 R0 M91"), Refused, "the feed is left over"),
        (C, First(UP, "L Z+650 R0 F1000 M91"), Refused, "of moves without TCPM rapids are read"),
        (C, First(UP, "L Z+650 FMAX M91"), Refused, "radius compensation is left over"),
        (C, First(UP, "L Z+650 RL FMAX M91"), Refused, "radius compensation"),
        (C, First(UP, "L IZ+650 R0 FMAX M91"), Refused, "a distance"),
        (C, First(UP, "L Z+700 R0 FMAX M91"), Refused, "beyond the travel"),
        (C, First(UP, "L Z+600 R0 FMAX M91"), Refused, "lower than where tools are changed"),
        (C, First(UP, "L Z-650 R0 FMAX M91"), Refused, "beyond the travel"),
        (C, First(UP, "L Z+650 R0 FMAX M91 M91"), Refused, "a word twice"),
        (C, First(UP, "L M91"), Refused, "no axis"),
        (C, First(UP, "L Z650 R0 FMAX M91"), Harmless, "a number without sign is positive"),
        (C, First(UP, "L Z+650 R0 FMAX M091"), Harmless, "leading zeros"),
        (C, First(UP, "L Z+650 FMAX R0 M91"), Refused, "the order of words"),
        (C, First(UP, "L R0 Z+650 FMAX M91"), Refused, "the order of words"),
        (C, First(UP, "L Z+650 R0 M91 FMAX"), Refused, "the order of words"),
        (C, First(UP, "M140 MB MAX"), Refused, "to a limit of the control"),
        (C, First(UP, "L X+0 Z+650 R0 FMAX M91"), Refused, "sideways from an unknown place"),
        (C, First(UP, "L A+0 R0 FMAX M91\nL Z+650 R0 FMAX M91"), Refused, "turns at an unknown height"),
        (C, First(UP, "L Z+650 R0 FMAX M91\nL Z+650 R0 FMAX M91"), Harmless, "said twice"),
        (C, First(UP, "G0 G53 Z650"), Refused, "no words of the language"),
        (C, Text("no rotary axes at the start", without_rotary), Refused, "A and C are where they were"),
        (C, First("R0 FMAX\nL X", "R0 FMAX M91\nL X"), Harmless, "positions of the machine, without preset"),
        (C, First("R0 FMAX\nL X", "R0 F500\nL X"), Refused, "of moves without TCPM rapids are read"),
        (C, Text("no X and Y at the start", without_station), Refused, "X and Y are where they were"),
        (C, Text("the station without M91", station_in_part), Refused, "the preset and the length act"),
        (C, First("CYCL DEF 247 DATUM SETTING ~\n  Q339=+1 ;DATUM NUMBER\n", ""), Refused, "which preset is not said"),
        (C, All("CYCL DEF 247 DATUM SETTING ~\n  Q339=+1 ;DATUM NUMBER\n", ""), Refused, "which preset is not said"),
        (C, First("Q339=+1", "Q339=+2"), Refused, "another preset"),
        (C, First("Q339=+1", "Q339=+0"), Refused, "the preset of manual operation"),
        (C, First("Q339=+1", "Q339=+Q5"), Refused, "a parameter"),
        (C, First("Q339=+1", "Q339=1"), Harmless, "without sign"),
        (C, First("Q339=+1", "Q338=+1"), Refused, "no word of the cycle"),
        (C, First("  Q339=+1 ;DATUM NUMBER\n", ""), Refused, "which preset is not said"),
        (C, First("DATUM SETTING ~\n  Q339=+1 ;DATUM NUMBER\n", "DATUM SETTING Q339=+1\n"), Harmless, "in one line"),
        (C, First("DATUM SETTING ~", "PRESETTING ~"), Harmless, "the name of the cycle in newer software"),
        (C, First("DATUM SETTING ~\n", "DATUM SETTING\n"), Refused, "the block ends without its word"),
        (
            C,
            Move("PLANE RESET STAY", "FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS"),
            Refused,
            "the plane can be tilted before, and TCPM is on",
        ),
    ]
}

fn line_removed(text: &str, is_it: impl Fn(&str) -> bool) -> String {
    let at = text.lines().position(is_it).unwrap();
    text.lines().enumerate().filter(|(i, _)| *i != at).map(|(_, line)| format!("{line}\n")).collect()
}

fn without_rotary(text: &str) -> String {
    line_removed(text, |line| line.starts_with("L A"))
}

fn without_station(text: &str) -> String {
    line_removed(text, |line| line.starts_with("L X") && line.ends_with("M91"))
}

fn station_in_part(text: &str) -> String {
    let at = text.find("L X").unwrap();
    let end = at + text[at..].find(" M91").unwrap();
    format!("{}{}", &text[..end], &text[end + " M91".len()..])
}

fn transformation() -> Vec<Kind> {
    const C: &str = "transformation";
    const ON: &str = "FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS\n";
    vec![
        (C, First(ON, ""), Refused, "words of the part are those of the machine then"),
        (C, First(ON, "FUNCTION TCPM\n"), Refused, "how it acts is not said"),
        (C, First(ON, "FUNCTION TCPM F TCP AXIS POS\n"), Refused, "the path of the axes is not said"),
        (C, First(ON, "FUNCTION TCPM AXIS POS PATHCTRL AXIS\n"), Refused, "the meaning of F is not said"),
        (C, First(ON, "FUNCTION TCPM F CONT AXIS POS PATHCTRL AXIS\n"), Refused, "F counts the rotary axes"),
        (C, First(ON, "FUNCTION TCPM F TCP AXIS SPAT PATHCTRL AXIS\n"), Refused, "A and C are angles in space"),
        (C, First(ON, "FUNCTION TCPM F TCP AXIS POS PATHCTRL VECTOR\n"), Refused, "the axis turns on great circles"),
        (C, First(ON, "FUNCTION TCPM AXIS POS F TCP PATHCTRL AXIS\n"), Refused, "the order of words"),
        (C, First(ON, "FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS REFPNT TIP-TIP\n"), Harmless, "as without"),
        (
            C,
            First(ON, "FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS REFPNT TIP-CENTER\n"),
            Refused,
            "turns about the centre",
        ),
        (
            C,
            First(ON, "FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS REFPNT CENTER-CENTER\n"),
            Refused,
            "points are centres",
        ),
        (C, First(ON, "FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS F100\n"), Refused, "the axes would follow slowly"),
        (C, First(ON, "FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS F30000\n"), Harmless, "as fast as the axes"),
        (
            C,
            First(ON, "FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS\nFUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS\n"),
            Refused,
            "switched on twice",
        ),
        (C, First(ON, "M128\n"), Refused, "M128 beside FUNCTION TCPM"),
        (C, First(ON, "FUNCTION RESET TCPM\n"), Refused, "switches off"),
        (C, First(ON, "FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS M8\n"), Refused, "no word of the function"),
        (C, First(ON, "TRAORI\n"), Refused, "a word of another control"),
        (C, First("M8\n", ""), Refused, "no coolant"),
        (C, First("M8\n", "M9\n"), Refused, "no coolant"),
        (C, First("M8\n", "L M8\n"), Harmless, "in a block of L"),
        (C, Text("with M128", with_m128), Harmless, "the older word for the same"),
        (
            C,
            Text("with M128 F", |t| with_m128(t).replacen("\nM128\n", "\nM128 F1000\n", 1)),
            Refused,
            "F is that of the axes which follow",
        ),
        (
            C,
            Text("with M128 F30000", |t| with_m128(t).replacen("\nM128\n", "\nM128 F30000\n", 1)),
            Harmless,
            "as fast as the axes",
        ),
        (
            C,
            Text("with L M128", |t| with_m128(t).replacen("\nM128\n", "\nL M128 F30000\n", 1)),
            Harmless,
            "in a block of L",
        ),
        (
            C,
            Text("M128 in a move", |t| with_m128(t).replacen("\nM128\n", "\nL X+0 Y+0 R0 FMAX M128\n", 1)),
            Refused,
            "is on in this move already",
        ),
        (
            C,
            Text("M128 without M129", |t| with_m128(t).replace("M129\n", "")),
            Refused,
            "can be on since an aborted run",
        ),
        (C, Text("M128 to the tool change", m128_to_change), Refused, "M129 stands before TOOL CALL"),
        (
            C,
            Text("M128 and M116", |t| with_m128(t).replacen("\nM128\n", "\nM116\nM128\n", 1)),
            Refused,
            "they exclude each other",
        ),
        (C, Cut("FUNCTION RESET TCPM\n", ""), Refused, "a retract in the machine frame under TCPM"),
        (C, Cut("FUNCTION RESET TCPM\n", "FUNCTION RESET TCPM\nFUNCTION RESET TCPM\n"), Harmless, "said twice"),
        (C, Cut("\nL X", "\nFUNCTION RESET TCPM\nL X"), Refused, "words of the part are those of the machine then"),
        (
            C,
            Cut("\nL X", "\nFUNCTION RESET TCPM\nFUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS\nL X"),
            Refused,
            "switched on in the part",
        ),
        (C, Cut("\nL X", "\nTOOL CALL Z S12000\nL X"), Refused, "TCPM is off before TOOL CALL"),
        (C, Cut("\nL X", "\nTOOL CALL 1 Z S12000\nL X"), Refused, "a change in the part"),
        (C, Cut("\nL X", "\nL Z+650 R0 FMAX M91\nL X"), Refused, "M91 needs TCPM off"),
        (
            C,
            Cut("\nL X", "\nCYCL DEF 247 DATUM SETTING ~\n  Q339=+1 ;DATUM NUMBER\nL X"),
            Refused,
            "a preset under TCPM",
        ),
    ]
}

fn with_m128(text: &str) -> String {
    text.replace("FUNCTION RESET TCPM\n", "M129\n").replace("FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS\n", "M128\n")
}

fn m128_to_change(text: &str) -> String {
    let text = with_m128(text);
    let on = text.find("\nM128\n").unwrap();
    let off = on + text[on..].find("M129\n").unwrap();
    format!("{}{}", &text[..off], &text[off + "M129\n".len()..])
}

fn path() -> Vec<Kind> {
    const C: &str = "modal in the path";
    vec![
        (C, Cut("\nL X", "\nL RL\nL X"), Refused, "radius compensation"),
        (C, Cut("\nL X", "\nL R0\nL X"), Harmless, "said again"),
        (C, Cut("\nL X", "\nM127\nL X"), Refused, "the long way round"),
        (C, Cut("\nL X", "\nM126\nL X"), Harmless, "said again"),
        (C, Cut("\nL X", "\nM5\nL X"), Refused, "the spindle stands"),
        (
            C,
            First("\nFUNCTION RESET TCPM\nCYCL DEF", "\nFUNCTION RESET TCPM\nTOOL CALL Z S1\nCYCL DEF"),
            Refused,
            "it nearly stands in the part",
        ),
        (
            C,
            First("CYCL DEF 32.1 T", "CYCL DEF 32.1 TOLERANCE T"),
            Refused,
            "only the first block of a cycle has a name",
        ),
        (C, Cut("\nL X", "\nM4\nL X"), Refused, "the wrong way round"),
        (C, Cut("\nL X", "\nM9\nL X"), Refused, "no coolant"),
        (C, Cut("\nL X", "\nM0\nL X"), Refused, "the tool rubs while the program waits"),
        (C, Cut("\nL X", "\nM1\nL X"), Refused, "the tool rubs while the program waits"),
        (C, Cut("\nL X", "\nSTOP\nL X"), Refused, "the tool rubs while the program waits"),
        (C, Cut("\nL X", "\nM30\nL X"), Refused, "ends in the part"),
        (C, Cut("\nL X", "\nL F100\nL X"), Harmless, "the block has its own feed or that of the program"),
        (C, Cut("\nL X", "\nL FMAX\nL X"), Refused, "acts in its block, which has no axes"),
        (
            C,
            Cut("\nL X", "\nCYCL DEF 32.0 TOLERANCE\nCYCL DEF 32.1 T0.9\nCYCL DEF 32.2 HSC-MODE:0 TA0.1\nL X"),
            Refused,
            "more than the job allows",
        ),
        (C, Cut("\nL X", "\nCYCL DEF 32.0 TOLERANCE\nCYCL DEF 32.1\nL X"), Refused, "settings of the machine"),
        (C, Cut("\nL X", "\nM90\nL X"), Refused, "rounds corners"),
        (C, Cut("\nL X", "\nM140 MB+50\nL X"), Refused, "a move along the tool"),
        (C, Cut("\nL X", "\nM128\nL X"), Refused, "M128 beside FUNCTION TCPM"),
        (C, Cut("\nL X", "\nCALL LBL 1\nL X"), Refused, "a subprogram"),
        (C, Cut("\nL X", "\nLBL 1\nL X"), Refused, "a label"),
        (C, Cut("\nL X", "\nCALL PGM X\nL X"), Refused, "another program"),
        (C, Cut("\nL X", "\nPLANE RESET STAY\nL X"), Refused, "a change of planes under TCPM"),
        (C, Cut("\nL X", "\nFUNCTION MODE TURN\nL X"), Refused, "turning"),
    ]
}

fn moves() -> Vec<Kind> {
    const C: &str = "block of the path";
    vec![
        (C, Cut("\nL X", "\nC X"), Refused, "an arc"),
        (C, Cut("\nL X", "\nCR X"), Refused, "an arc"),
        (C, Cut("\nL X", "\nCT X"), Refused, "an arc"),
        (C, Cut("\nL X", "\nLP X"), Refused, "polar coordinates"),
        (C, Cut("\nL X", "\nSPL X"), Refused, "a spline"),
        (C, Cut("\nL X", "\nFL X"), Refused, "a free contour"),
        (C, Cut("\nL X", "\nRND R1\nL X"), Refused, "rounds the corner"),
        (C, Cut("\nL X", "\nAPPR LT X"), Refused, "an approach"),
        (C, Cut("\nL X", "\nLN X"), Refused, "a vector is missing"),
        (C, Cut("\nL X", "\nX"), Refused, "L is not modal"),
        (C, Cut("\nL X", "\n/ L X"), Refused, "depends on a switch"),
        (C, Cut("\nL X", "\nL IX"), Refused, "a distance"),
        (C, Word("X", Double), Refused, "a word twice"),
        (C, Word("Y", Double), Refused, "a word twice"),
        (C, Word("Z", Double), Refused, "a word twice"),
        (C, Word("A", Double), Refused, "a word twice"),
        (C, Word("C", Double), Refused, "a word twice"),
        (C, Word("X", Address("Y")), Refused, "a word twice"),
        (C, Word("X", Address("U")), Refused, "no such axis"),
        (C, Word("A", Address("B")), Refused, "no such axis"),
        (C, Word("A", Address("IA")), Refused, "a distance"),
        (C, Word("A", Address("TX")), Refused, "a vector belongs to LN"),
        (C, Word("X", Address("PR")), Refused, "polar coordinates"),
        (C, Word("X", Number("NAN")), Refused, "no number"),
        (C, Word("X", Number("")), Refused, "a number is missing"),
        (C, Word("X", Number("-")), Refused, "no number"),
        (C, Word("X", Number("--1")), Refused, "no number"),
        (C, Word("X", Number("1E2")), Refused, "no exponents"),
        (C, Word("X", Number("1,5")), Refused, "a decimal comma"),
        (C, Word("X", Number("1.2.3")), Refused, "two points"),
        (C, Word("X", Number("1.23456")), Refused, "more decimals than the control takes"),
        (C, Word("X", Number("+Q1")), Refused, "a parameter"),
        (C, Word("X", Number("+999999")), Refused, "more digits than the control takes"),
        (C, Word("Z", Number("-60")), Found, "through part and table"),
        (C, Word("Z", Number("+900")), Found, "beyond the travel"),
        (C, Word("A", Number("+170")), Refused, "beyond the travel"),
        (C, Cut(" X+", " X"), Harmless, "a number without sign is positive"),
        (C, First("F150.000", "F0"), Refused, "no feed"),
        (C, First("F150.000", "F-150"), Refused, "a negative feed"),
        (C, First("F150.000", "F15000"), Refused, "above the feeds of the job"),
        (C, First("F150.000", "F"), Refused, "a number is missing"),
        (C, First("F150.000", "F150"), Harmless, "without decimals"),
        (C, First("F150.000", "F150.0000"), Refused, "more decimals than the control takes"),
        (C, First("F150.000", "FAUTO"), Refused, "the feed of TOOL CALL or of a cycle"),
        (C, First("F150.000", "F AUTO"), Refused, "the feed of TOOL CALL or of a cycle"),
        (C, First("F150.000", "FU0.1"), Refused, "feed a revolution"),
        (C, First("F150.000", "FZ0.1"), Refused, "feed a tooth"),
        (C, First("F150.000", "FT5"), Refused, "a time"),
        (C, First("F150.000", "FMAXT5"), Refused, "a time"),
        (C, First("F150.000", "F=150"), Refused, "no equals sign"),
        (C, First("F150.000", "F150 F150"), Refused, "a word twice"),
        (C, First("F150.000", "F150 FMAX"), Refused, "a word twice"),
        (C, First("F150.000", "F150 M9"), Refused, "M9 acts at the end of the block"),
        (C, First("F150.000", "F150 M5"), Refused, "M5 acts at the end of the block"),
        (C, First("F150.000", "R0 F150"), Harmless, "no compensation, said again"),
        (C, First("F150.000", "RR F150"), Refused, "compensation"),
        (C, First("F150.000", "F150 R0"), Refused, "the order of words"),
        (C, First("F150.000", "F150 M8"), Harmless, "coolant, said again"),
        (C, First("F150.000", "F150 M91"), Refused, "the machine frame under TCPM"),
        (C, First("F150.000", "F150 M128"), Refused, "M128 beside FUNCTION TCPM"),
        (C, Text("no F behind the first rapid", |t| t.replacen(" F1000.000", "", 1)), Refused, "the feed is left over"),
    ]
}

fn numbers() -> Vec<Kind> {
    const C: &str = "block numbers";
    vec![
        (C, First("M126\n", "4 M126\n"), Harmless, "the number that it has"),
        (C, First("M126\n", "900000000 M126\n"), Refused, "the next number is smaller"),
        (C, First("M126\n", "0 M126\n"), Refused, "not larger than the number before"),
        (C, First("M126\n", "N5 M126\n"), Refused, "numbers have no N"),
        (C, First("M126\n", "5.5 M126\n"), Refused, "no whole number"),
        (C, First("M126\n", "9999999999 M126\n"), Refused, "too many digits"),
        (C, First("M126\n", "4\n5 M126\n"), Harmless, "an empty block"),
    ]
}

fn spelling() -> Vec<Kind> {
    const C: &str = "alphabet";
    vec![
        (C, Text("lower case", |t| t.to_lowercase()), Refused, "words have capital letters"),
        (C, First("M126\n", "m126\n"), Refused, "words have capital letters"),
        (C, Text("CRLF", |t| t.replace('\n', "\r\n")), Harmless, "the end of a line"),
        (C, Text("lone CR", |t| t.replacen(" R0", "\rR0", 1)), Refused, "a control character"),
        (C, Text("tabs", |t| t.replace(' ', "\t")), Harmless, "tabs are blanks"),
        (C, Text("wide", |t| t.replace(' ', "   ")), Harmless, "blanks between words"),
        (C, Text("glued", |t| t.replacen(" R0 FMAX", "R0FMAX", 1)), Refused, "words need blanks"),
        (C, Text("blank inside of a word", |t| t.replacen("L Z+", "L Z +", 1)), Refused, "a word in two pieces"),
        (
            C,
            Text("blank lines", |t| t.replace('\n', "\n\n").replace("~\n\n", "~\n")),
            Harmless,
            "blank lines mean nothing",
        ),
        (C, Text("no last line feed", |t| t.trim_end().to_owned()), Harmless, "END PGM ends the program"),
        (C, Text("byte order mark", |t| format!("\u{feff}{t}")), Refused, "no character of the language"),
        (C, Text("no-break blank", |t| t.replacen(" R0", "\u{a0}R0", 1)), Refused, "no blank of the language"),
        (C, Text("wide blank", |t| t.replacen(" R0", "\u{3000}R0", 1)), Refused, "no blank of the language"),
        (C, Text("zero byte", |t| t.replacen(" R0", "\0R0", 1)), Refused, "a control character"),
        (C, Cut("L X", "L \u{425}"), Refused, "a Cyrillic letter"),
        (C, Cut("L X", "L \u{3a7}"), Refused, "a Greek letter"),
        (C, Cut("Y-", "Y\u{2212}"), Refused, "a minus of typography"),
        (C, Cut("Y-", "Y\u{2013}"), Refused, "a dash"),
        (C, First("M126\n", "M\u{661}26\n"), Refused, "an Arabic digit"),
        (C, First("M126\n", "M\u{ff11}26\n"), Refused, "a wide digit"),
        (C, First("M126\n", "M126 ; (anything) M127 \u{43f}\n"), Harmless, "a comment"),
        (C, First("M126\n", "; M127\nM126\n"), Harmless, "a comment"),
        (C, First("M126\n", "* - section M127\nM126\n"), Harmless, "structure"),
        (C, First("M126\n", "(comment)\nM126\n"), Refused, "brackets are no comment"),
        (C, First("M126\n", "M126 ~\n"), Refused, "only cycles go on in the next line"),
        (C, First("M126\n", "; comment ~\nM126\n"), Refused, "only cycles go on in the next line"),
        (C, First("M126\n", "M428\n"), Refused, "a word of another control"),
        (C, First("M126\n", "G54\nM126\n"), Refused, "a word of another control"),
        (C, First("M126\n", "M126.5\n"), Refused, "no such word"),
        (C, First("M126\n", "M\n"), Refused, "a number is missing"),
        (
            C,
            Text("a cycle of 600 characters", |t| {
                t.replacen("DATUM SETTING ~", &format!("DATUM {}~", "A".repeat(600)), 1)
            }),
            Refused,
            "longer than any block",
        ),
    ]
}

fn end() -> Vec<Kind> {
    const C: &str = "end";
    vec![
        (C, Last("M30\n", ""), Harmless, "END PGM ends the program, and all is off"),
        (C, Last("M30\n", "M2\n"), Harmless, "an end as well"),
        (C, Last("M30\n", "M02\n"), Harmless, "leading zeros"),
        (C, Last("M30\n", "M17\n"), Refused, "no end of the language"),
        (C, Last("M30\n", "M30\nM30\n"), Refused, "text behind the end"),
        (C, Last("M30\n", "M30\nL X+0 R0 FMAX M91\n"), Refused, "text behind the end"),
        (C, Last("M30\n", "M30\n; done\n"), Harmless, "a comment"),
        (C, Last("END PGM SMALL MM\n", ""), Refused, "no end"),
        (C, Last("END PGM SMALL MM\n", "END PGM SMALL INCH\n"), Refused, "another unit"),
        (C, Last("END PGM SMALL MM\n", "END PGM LARGE MM\n"), Refused, "another name"),
        (C, Last("END PGM SMALL MM\n", "END PGM SMALL\n"), Refused, "no unit"),
        (C, Last("END PGM SMALL MM\n", "END PGM SMALL MM\nM126\n"), Refused, "text behind the end"),
        (C, Last("END PGM SMALL MM\n", "END PGM SMALL MM\n; done\n"), Harmless, "a comment"),
        (C, Last("M5\n", ""), Harmless, "M30 stops the spindle"),
        (C, First("M5\n", ""), Harmless, "the next change stops the spindle"),
        (C, Last("M9\n", ""), Harmless, "M30 stops the coolant"),
        (C, First("M9\n", ""), Harmless, "coolant over the change"),
        (
            C,
            Text("no M5, no M30", |t| t.rfind("M5\n").map(|at| format!("{}{}", &t[..at], &t[at + 7..])).unwrap()),
            Refused,
            "END PGM is not said to stop the spindle",
        ),
        (C, Last("FUNCTION RESET TCPM\n", ""), Refused, "a retract in the machine frame under TCPM"),
        (
            C,
            Text("all that switches off is missing", |t| {
                t.rfind("FUNCTION RESET TCPM\n").map(|at| format!("{}M30\nEND PGM SMALL MM\n", &t[..at])).unwrap()
            }),
            Refused,
            "ends in a cut, all on",
        ),
        (C, Text("cut in the middle", |t| t[..t.len() / 2].to_owned()), Refused, "no end"),
        (C, Text("empty", |_| String::new()), Refused, "no program"),
    ]
}

/// The head and the operations.
fn parts(text: &str) -> Vec<String> {
    operations::parts(text, |lines, i| lines[i].starts_with("* - "))
}

/// Without its head the text lacks BEGIN PGM.
fn operations() -> Vec<Kind> {
    let due = |(class, change, due, why): Kind| match change {
        Operations("no head", ..) => (class, change, Refused, "the name and the unit of the program are missing"),
        _ => (class, change, due, why),
    };
    operations::kinds(parts).into_iter().map(due).collect()
}

fn wrong() -> Vec<Kind> {
    const C: &str = "wrong job, machine";
    vec![
        (C, Machine("A opposite", |m| m.rotary[0].word_sign = -1.0), Found, "the tool leans to the other side"),
        (C, Machine("tools are changed higher", |m| m.retract += 50.0), Refused, "lower than where tools are changed"),
        (C, Machine("Z ends lower", |m| m.linear[2].max -= 50.0), Refused, "beyond the travel"),
        (
            C,
            Machine("A ends earlier", |m| (m.rotary[0].min, m.rotary[0].max) = (-0.1, 0.1)),
            Refused,
            "beyond the travel",
        ),
        (
            C,
            Machine("C ends earlier", |m| (m.rotary[1].min, m.rotary[1].max) = (-0.1, 0.1)),
            Refused,
            "beyond the travel",
        ),
        (
            C,
            Machine("X ends earlier", |m| (m.linear[0].min, m.linear[0].max) = (-1.0, 1.0)),
            Refused,
            "beyond the travel",
        ),
        (C, Job("no operation", |p| p.operations = PrimaryMap::new()), Refused, "more operations than the job"),
        (C, Job("finer tolerance", |p| p.tolerances.chord = Mm(1e-4)), Refused, "smooths by more than the job allows"),
        (C, All("S12000", "S12001"), Refused, "another speed"),
        (C, All("TOOL CALL 1 ", "TOOL CALL 3 "), Refused, "no such tool in the job"),
    ]
}

/// Of the text with vectors.
pub fn vectors() -> Vec<Kind> {
    const C: &str = "vectors";
    vec![
        (C, Word("TX", Double), Refused, "a word twice"),
        (C, Word("TX", Address("TY")), Refused, "a word twice"),
        (C, Word("TX", Address("NX")), Refused, "the normal of the surface"),
        (C, Word("TX", Address("A")), Refused, "an angle beside a vector"),
        (C, Word("TX", Number("+Q1")), Refused, "a parameter"),
        (C, Word("TX", Number("+0.123456789")), Refused, "more decimals than the control takes"),
        (C, Word("TZ", Number("+9")), Refused, "a vector of another length"),
        (C, Word("TZ", Number("+0")), Refused, "a vector of another length"),
        (C, Text("TX is missing", |t| without(t, " TX")), Refused, "every component in every block"),
        (C, Text("TY is missing", |t| without(t, " TY")), Refused, "every component in every block"),
        (C, Text("TZ is missing", |t| without(t, " TZ")), Refused, "every component in every block"),
        (C, Text("X is missing", |t| without(t, " X")), Refused, "every component in every block"),
        (C, Text("Y is missing", |t| without(t, " Y")), Refused, "every component in every block"),
        (C, Text("Z is missing", |t| without(t, " Z")), Refused, "every component in every block"),
        (C, Text("TX before X", vector_first), Refused, "the order of words"),
        (C, Text("the other side", |t| changed_sign(t, " TZ")), Found, "A would turn beyond its travel"),
        (C, Cut("\nLN X", "\nL X"), Refused, "TX belongs to LN"),
        (C, Cut("\nLN X", "\nLN R0 X"), Refused, "the order of words"),
        (C, First("F150.000", "R0 F150"), Harmless, "no compensation, said again"),
        (C, First("F150.000", "RR F150"), Refused, "compensation along the flank"),
        (C, All("PATHCTRL AXIS", "PATHCTRL VECTOR"), Refused, "the axis turns on great circles"),
        (C, Text("with M128", with_m128), Harmless, "the older word for the same"),
    ]
}

/// The third block of LN.
fn block(text: &str) -> (usize, &str) {
    let at = text.match_indices("\nLN X").nth(2).unwrap().0 + 1;
    (at, &text[at..at + text[at..].find('\n').unwrap()])
}

fn with_block(text: &str, change: impl Fn(&str) -> String) -> String {
    let (at, line) = block(text);
    format!("{}{}{}", &text[..at], change(line), &text[at + line.len()..])
}

fn without(text: &str, word: &str) -> String {
    with_block(text, |line| {
        let at = line.find(word).unwrap();
        let end = line[at + 1..].find(' ').map_or(line.len(), |n| at + 1 + n);
        format!("{}{}", &line[..at], &line[end..])
    })
}

fn vector_first(text: &str) -> String {
    with_block(text, |line| {
        let words: Vec<&str> = line.split(' ').collect();
        [&words[..1], &words[4..7], &words[1..4], &words[7..]].concat().join(" ")
    })
}

fn changed_sign(text: &str, word: &str) -> String {
    with_block(text, |line| {
        let at = line.find(word).unwrap() + word.len();
        let sign = if &line[at..=at] == "+" { "-" } else { "+" };
        format!("{}{sign}{}", &line[..at], &line[at + 1..])
    })
}
