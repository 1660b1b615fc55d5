//! Changes for SINUMERIK 840D. Reasons come from its programming manuals.

use super::Change::{All, Cut, First, Job, Last, Machine, Move, Text, Word};
use super::How::{Address, Double, Number};
use super::Kind;
use super::Verdict::{Found, Harmless, Refused};
use super::operations;
use impellerc::base::entity::PrimaryMap;
use impellerc::base::units::Mm;

pub fn kinds() -> Vec<Kind> {
    let mut all = Vec::new();
    all.extend(head());
    all.extend(change());
    all.extend(perimeter());
    all.extend(transformation());
    all.extend(path());
    all.extend(moves());
    all.extend(spelling());
    all.extend(end());
    all.extend(operations::kinds(parts));
    all.extend(wrong());
    all
}

fn head() -> Vec<Kind> {
    const C: &str = "head";
    vec![
        (C, First("G710 ", ""), Refused, "inches can be left over"),
        (C, First("G710 ", "G700 "), Refused, "inches"),
        (C, First("G710 ", "G70 "), Refused, "inches"),
        (C, First("G710 ", "G71 "), Refused, "F stays in the units of the machine"),
        (C, First("G710 ", "G710 G710 "), Refused, "two words of one group"),
        (C, First("G710 ", "G710 G700 "), Refused, "two words of one group"),
        (C, First("G17 ", ""), Refused, "the plane decides on which axis the length acts"),
        (C, First("G17 ", "G18 "), Refused, "the length acts on Y"),
        (C, First("G17 ", "G19 "), Refused, "the length acts on X"),
        (C, First("G17 ", "G17 G17 "), Refused, "two words of one group"),
        (C, First("G90 ", ""), Refused, "G91 can be left over"),
        (C, First("G90 ", "G91 "), Refused, "words would be distances"),
        (C, First("G90 ", "G90 G91 "), Refused, "two words of one group"),
        (C, First("G94 ", ""), Refused, "another feed type can be left over"),
        (C, First("G94 ", "G93 "), Refused, "F would be a share of each block, and is missing in most"),
        (C, First("G94 ", "G95 "), Refused, "feed a revolution"),
        (C, First("G94 ", "G96 "), Refused, "constant cutting speed"),
        (C, First("G94 ", "G97 "), Refused, "feed a revolution"),
        (C, First("G94 ", "G961 "), Refused, "constant cutting speed"),
        (C, First("G94 ", "G94 G95 "), Refused, "two words of one group"),
        (C, First(" G40", ""), Refused, "compensation can be left over"),
        (C, First(" G40", " G41"), Refused, "compensation"),
        (C, First(" G40", " G42"), Refused, "compensation"),
        (C, First(" G40", " G40 G40"), Refused, "two words of one group"),
        (C, First("TRANS\n", ""), Harmless, "TRAORI takes the programmable frame back; SUPA leaves it out"),
        (C, First("TRANS\n", "ROT\n"), Harmless, "alone it takes the frame back as well"),
        (C, First("TRANS\n", "TRANS X5\n"), Refused, "shifts the frame"),
        (C, First("TRANS\n", "ATRANS X5\n"), Refused, "shifts the frame"),
        (C, First("TRANS\n", "ROT Z5\n"), Refused, "turns the frame"),
        (C, First("TRANS\n", "AROT Z5\n"), Refused, "turns the frame"),
        (C, First("TRANS\n", "SCALE X2\n"), Refused, "scales the frame"),
        (C, First("TRANS\n", "MIRROR X0\n"), Refused, "mirrors the frame"),
        (C, First("TRANS\n", "TRANS\nTRANS\n"), Harmless, "said twice"),
        (C, First("G500\n", ""), Harmless, "SUPA leaves offsets out, and G54 stands behind TRAORI"),
        (C, First("G500\n", "G54\n"), Harmless, "SUPA leaves offsets out, and G54 stands behind TRAORI"),
        (C, First("G500\n", "G55\n"), Harmless, "SUPA leaves offsets out, and G54 stands behind TRAORI"),
        (C, First("G500\n", "G500 G54\n"), Refused, "two words of one group"),
        (C, First("CYCLE832(0,_OFF,1)\n", ""), Harmless, "each operation says its tolerance"),
        (C, First("TRAFOOF\n", ""), Refused, "TRAORI can be on since an aborted run"),
        (C, First("TRAFOOF\n", "TRAFOOF\nTRAFOOF\n"), Harmless, "said twice"),
        (C, First("TRAFOOF\n", "TRAFOOF G500\n"), Refused, "stands alone in its block"),
        (C, First("TRAFOOF\n", "D0\nTRAFOOF\n"), Refused, "the length changes under TRAORI"),
        (C, First("TRAFOOF\n", "SUPA G0 Z650 D0\nTRAFOOF\n"), Refused, "a move under an unknown transformation"),
        (C, First("TRAFOOF\n", "TRAORI\n"), Refused, "switched on where the axes are unknown"),
        (C, First("TRAFOOF\n", "TRAFOOF\nSOFT\nFFWON\n"), Harmless, "as CYCLE832 does"),
        (C, First("TRAFOOF\n", "TRAFOOF\nBRISK\n"), Refused, "no limit of jerk"),
        (C, First("TRAFOOF\n", "TRAFOOF\nSTOPRE\n"), Harmless, "stops reading ahead"),
        (C, First("TRAFOOF\n", "TRAFOOF\nMSG(\"small\")\n"), Harmless, "a text on the screen"),
        (C, First("TRAFOOF\n", "TRAFOOF\nMSG()\n"), Harmless, "a text on the screen"),
        (C, First("TRAFOOF\n", "TRAFOOF\nDIAMON\n"), Refused, "X is a diameter"),
        (C, First("TRAFOOF\n", "TRAFOOF\nG291\n"), Refused, "another language"),
        (C, First("TRAFOOF\n", "TRAFOOF\nR1=5\n"), Harmless, "a parameter that no word counts with"),
        (C, First("TRAFOOF\n", "TRAFOOF\n$P_UIFR[1]=CTRANS(X,5)\n"), Refused, "changes the offset"),
    ]
}

fn change() -> Vec<Kind> {
    const C: &str = "tool change";
    vec![
        (C, First("T=\"t1\" M6", "M6"), Refused, "no tool was made ready"),
        (C, First("T=\"t1\" M6", "T=\"t1\""), Refused, "the tool does not come into the spindle"),
        (C, First("T=\"t1\" M6", "T=\"t2\" M6"), Refused, "another tool than the job's"),
        (C, First("T=\"t1\" M6", "T=\"t9\" M6"), Refused, "no tool of the job"),
        (C, First("T=\"t1\" M6", "T=\"T1\" M6"), Refused, "names of tools have a case"),
        (C, First("T=\"t1\" M6", "T=\"1\" M6"), Refused, "the tool named 1, not number 1"),
        (C, First("T=\"t1\" M6", "T=\"t1 \" M6"), Refused, "another name"),
        (C, First("T=\"t1\" M6", "T=\"\" M6"), Refused, "no name"),
        (C, First("T=\"t1\" M6", "T=\"t1 M6"), Refused, "no end of the name"),
        (C, First("T=\"t1\" M6", "T=t1 M6"), Refused, "a variable"),
        (C, First("T=\"t1\" M6", "T1 M6"), Harmless, "by number"),
        (C, First("T=\"t1\" M6", "T=1 M6"), Harmless, "by number"),
        (C, First("T=\"t1\" M6", "T2 M6"), Refused, "another tool"),
        (C, First("T=\"t1\" M6", "T0 M6"), Refused, "no tool"),
        (C, First("T=\"t1\" M6", "T=\"t1\" T=\"t2\" M6"), Refused, "a word twice"),
        (C, First("T=\"t1\" M6", "T=\"t1\" M6 M6"), Refused, "a word twice"),
        (C, First("T=\"t1\" M6", "T=\"t1\" M6=6"), Refused, "another spindle"),
        (C, First("T=\"t1\" M6 ;", "T=\"t1\"\nM6 ;"), Harmless, "in two blocks"),
        (C, First("T=\"t1\" M6 ;", "t=\"t1\" m6 ;"), Harmless, "case means nothing but in names"),
        (C, First("T=\"t1\" M6 ;", "T=\"t1\" M06 ;"), Harmless, "leading zeros"),
        (C, First("T=\"t1\" M6 ;", "T = \"t1\" M6 ;"), Harmless, "blanks at the equals sign"),
        (C, First("T=\"t1\" M6 ; groove\n", ""), Refused, "whichever tool is in the spindle"),
        (C, First("G54 D1", "G54"), Refused, "no length"),
        (C, First("G54 D1", "G54 D0"), Refused, "no length"),
        (C, First("G54 D1", "G54 D2"), Refused, "another cutting edge"),
        (C, First("G54 D1", "G54 D1 D1"), Refused, "a word twice"),
        (C, First("G54 D1", "D1"), Harmless, "TRAORI drops G54 anyhow"),
        (C, First("G54 D1", "D1 G54"), Harmless, "order in a block means nothing"),
        (C, First("G54 D1", "G54 D=1"), Harmless, "with an equals sign"),
        (C, First("G54 D1", "G54\nD1"), Harmless, "in two blocks"),
        (C, First("G54 D1\n", "G54 D1\nD0\n"), Refused, "taken back"),
        (C, First("G54 D1\n", ""), Refused, "no length"),
        (C, Move("G54 D1", "TRAORI"), Refused, "the length changes under TRAORI"),
        (C, First("G54 D1\n", "G54 D1\nT=\"t2\" M6\n"), Refused, "which length the new tool has is not said"),
        (C, First("S12000 M3", "M3"), Refused, "the speed is left over"),
        (C, First("S12000 M3", "S0 M3"), Refused, "standstill"),
        (C, First("S12000 M3", "S-5 M3"), Refused, "a negative speed"),
        (C, First("S12000 M3", "S6000 M3"), Refused, "another speed than that of the job"),
        (C, First("S12000 M3", "S12000 M4"), Refused, "the wrong way round"),
        (C, First("S12000 M3", "S12000 M5"), Refused, "standstill"),
        (C, First("S12000 M3", "S12000"), Refused, "the spindle stands since M6"),
        (C, First("S12000 M3", "S12000 M3 M5"), Refused, "two words of one group"),
        (C, First("S12000 M3", "S1=12000 M1=3"), Refused, "another spindle"),
        (C, First("S12000 M3", "S=12000 M3"), Harmless, "with an equals sign"),
        (C, First("S12000 M3", "M3 S12000"), Harmless, "order in a block means nothing"),
        (C, First("S12000 M3\n", ""), Refused, "the spindle stands since M6"),
        (C, First("S12000 M3\n", "S12000 M3\nG4 F2\n"), Harmless, "waits for the spindle"),
        (C, First("S12000 M3\n", "S12000 M3\nG4\n"), Refused, "how long is not said"),
        (C, First("S12000 M3\n", "S12000 M3\nM0\n"), Harmless, "stops with the tool retracted"),
        (C, First("S12000 M3\n", "S12000 M3\nM1\n"), Harmless, "stops with the tool retracted"),
        (C, First("S12000 M3\n", "S12000 M3\nSPOS=0\n"), Refused, "positions the spindle"),
        (C, First("0.0500,_ORI_ROUGH", "0.5,_ORI_ROUGH"), Refused, "more than the job allows"),
        (C, First("0.0500,_ORI_ROUGH", "0,_ORI_ROUGH"), Refused, "0 is not none: the control takes its own"),
        (C, First("0.0500,_ORI_ROUGH", "-1,_ORI_ROUGH"), Refused, "a negative tolerance"),
        (C, First("0.0500,_ORI_ROUGH,0.1000", "0.0500,_ORI_ROUGH,5"), Refused, "the axis leans by more"),
        (C, First("0.0500,_ORI_ROUGH,0.1000", "0.0500,_ORI_ROUGH"), Refused, "the tolerance of the axis is missing"),
        (
            C,
            First("0.0500,_ORI_ROUGH,0.1000", "0.0500,_ORI_ROUGH,0"),
            Refused,
            "0 is not none: the control takes its own",
        ),
        (C, First("0.0500,_ORI_ROUGH,0.1000", "0.0500,_ROUGH,1"), Refused, "no tolerance of the axis"),
        (C, First("0.0500,_ORI_ROUGH,0.1000", "0.0500,3,1"), Refused, "no tolerance of the axis"),
        (C, First("0.0500,_ORI_ROUGH,0.1000", "0.0010,_ORI_FINISH,0.1"), Harmless, "finer"),
        (C, First("0.0500,_ORI_ROUGH,0.1000", "0.0010,_ORI_SEMIFIN,0.1"), Harmless, "finer"),
        (C, First("0.0500,_ORI_ROUGH,0.1000", " 0.0500 , _ori_rough , 0.1 "), Harmless, "blanks and case"),
        (C, First("CYCLE832(0.0500,_ORI_ROUGH,0.1000)\n", ""), Refused, "the tolerance is left over"),
        (C, First("CYCLE832(0.0500,_ORI_ROUGH,0.1000)", "CYCLE832()"), Refused, "settings of the machine"),
        (C, First("CYCLE832(0.0500,_ORI_ROUGH,0.1000)", "CYCLE832(0,_OFF,1)"), Refused, "settings of the machine"),
        (
            C,
            First("CYCLE832(0.0500,_ORI_ROUGH,0.1000)", "CYCLE832(0.0500,_ORI_ROUGH,0.1000) M8"),
            Refused,
            "stands alone in its block",
        ),
        (
            C,
            First("CYCLE832(0.0500,_ORI_ROUGH,0.1000)", "CYCLE832(0.0500,_ORI_ROUGH,0.1"),
            Refused,
            "no end of the call",
        ),
        (C, First("CYCLE832(0.0500,_ORI_ROUGH,0.1000)", "CYCLE800()"), Refused, "swivels the frame"),
        (C, First("CYCLE832(0.0500,_ORI_ROUGH,0.1000)", "CYCLE81(5,0,1,-5)"), Refused, "a cycle"),
        (C, First("CYCLE832(0.0500,_ORI_ROUGH,0.1000)", "G642 CTOL=0.05"), Refused, "CTOL is not read"),
        (C, Last("0.0010,_ORI_FINISH", "0.0500,_ORI_FINISH"), Refused, "more than the job allows"),
        (
            C,
            Text("an orientation tolerance of 0.1 deg in finishing", |t| wide_turn(t, "_ORI_FINISH,", ")")),
            Refused,
            "more than the flutes of the tool allow",
        ),
    ]
}

fn perimeter() -> Vec<Kind> {
    const C: &str = "perimeter";
    vec![
        (C, First("SUPA G0 Z650.0000 D0\n", ""), Refused, "tool change at an unknown height"),
        (C, First("SUPA G0 Z650.0000 D0", "SUPA G0 Z650"), Refused, "whether a length acts is not known"),
        (C, First("SUPA G0 Z650.0000 D0", "SUPA G0 Z650 D1"), Refused, "the length acts"),
        (C, First("SUPA G0 Z650.0000 D0", "G0 Z650 D0"), Refused, "offsets act"),
        (C, First("SUPA G0 Z650.0000 D0", "G53 G0 Z650 D0"), Refused, "offsets of the handwheel act"),
        (C, First("SUPA G0 Z650.0000 D0", "G153 G0 Z650 D0"), Refused, "offsets of the handwheel act"),
        (C, First("SUPA G0 Z650.0000 D0", "SUPA G1 Z650 D0 F500"), Refused, "at feed from an unknown place"),
        (C, First("SUPA G0 Z650.0000 D0", "SUPA Z650 D0"), Refused, "no motion word"),
        (C, First("SUPA G0 Z650.0000 D0", "SUPA G0 Z0 D0"), Refused, "lower than where tools are changed"),
        (C, First("SUPA G0 Z650.0000 D0", "SUPA G0 Z-650 D0"), Refused, "beyond the travel"),
        (C, First("SUPA G0 Z650.0000 D0", "SUPA G0 Z651 D0"), Refused, "beyond the travel"),
        (C, First("SUPA G0 Z650.0000 D0", "SUPA G0 X0 Z650 D0"), Refused, "sideways on the way up"),
        (C, First("SUPA G0 Z650.0000 D0", "SUPA G0 A=0 Z650 D0"), Refused, "the table turns on the way up"),
        (
            C,
            First("SUPA G0 Z650.0000 D0", "SUPA G0 C=0 D0\nSUPA G0 Z650 D0"),
            Refused,
            "the table turns at an unknown height",
        ),
        (C, First("SUPA G0 Z650.0000 D0", "SUPA G0 X0 D0\nSUPA G0 Z650 D0"), Refused, "sideways at an unknown height"),
        (C, First("SUPA G0 Z650.0000 D0", "G75 Z1=0"), Refused, "a place set at the control"),
        (C, First("SUPA G0 Z650.0000 D0", "G74 Z1=0"), Refused, "goes to the reference"),
        (C, First("SUPA G0 Z650.0000 D0", "D0 G0 SUPA Z=650"), Harmless, "order in a block means nothing"),
        (C, First("SUPA G0 Z650.0000 D0", "D0\nSUPA G0 Z650"), Harmless, "D0 is modal"),
        (C, First("SUPA G0 Z650.0000 D0", "SUPA G0 Z650 D0\nSUPA G0 Z650 D0"), Harmless, "said twice"),
        (C, First("SUPA G0 Z650.0000 D0", "SUPA SUPA G0 Z650 D0"), Refused, "a word twice"),
        (C, First("SUPA G0 Z650.0000 D0", "SUPA G0 D0"), Refused, "no axis word"),
        (C, First("SUPA G0 A=", "SUPA G0 Z600 D0\nSUPA G0 A="), Refused, "lower than proved"),
        (C, First("SUPA G0 A=", "SUPA G0 X0 Y0 D0\nSUPA G0 A="), Harmless, "another way at the retract height"),
        (C, First("SUPA G0 A=", "SUPA G0 X999 D0\nSUPA G0 A="), Refused, "beyond the travel"),
        (C, First("SUPA G0 A=", "G0 A="), Refused, "the work offset is that of nothing"),
        (C, First("SUPA G0 A=", "G54 G0 A="), Harmless, "the rotary zero of G54 is that of the machine"),
        (C, First("SUPA G0 A=", "SUPA G1 F100 A="), Refused, "at feed"),
        (C, First("SUPA G0 A=", "SUPA G0 B=1 A="), Refused, "no such axis"),
        (C, First("SUPA G0 A=", "SUPA G0 A=DC("), Refused, "no axis without ends"),
        (C, First("SUPA G0 A=", "SUPA G0 A3="), Refused, "a vector without TRAORI"),
        (C, First("SUPA G0 X", "G0 X"), Refused, "offsets act"),
        (C, First("SUPA G0 X", "SUPA G0 Z650 X"), Refused, "Z with it"),
        (C, First("SUPA G0 X", "SUPA G0 X1 X"), Refused, "a word twice"),
        (C, First("SUPA G0 X", "SUPA G0 U1 X"), Refused, "no such axis"),
        (C, Text("no A and C before TRAORI", |t| without(t, "SUPA G0 A")), Refused, "the table turns on the way down"),
        (C, Text("no X and Y before TRAORI", |t| without(t, "SUPA G0 X")), Refused, "an unknown place on the way down"),
        (C, Text("X and Y before A and C", swap_stations), Harmless, "both at the retract height"),
        (
            C,
            Text("A without sign", |t| {
                t.replacen("SUPA G0 A=-", "SUPA G0 A=", 1).replacen("SUPA G0 A=6", "SUPA G0 A=5", 1)
            }),
            Refused,
            "the table turns on the way down",
        ),
        (C, Last("SUPA G0 Z650.0000 D0 M9\n", "M9\n"), Refused, "the program ends in the part"),
        (C, Last("SUPA G0 Z650.0000 D0 M9", "SUPA G0 Z650 M9"), Refused, "the length acts"),
        (C, Last("SUPA G0 Z650.0000 D0 M9", "G0 Z650 D0 M9"), Refused, "offsets act"),
        (C, Last("SUPA G0 Z650.0000 D0 M9", "SUPA G0 Z0 D0 M9"), Refused, "lower than proved"),
        (C, Last("SUPA G0 Z650.0000 D0 M9", "SUPA G0 X0 Y0 D0 M9"), Refused, "sideways out of the part"),
        (
            C,
            Last("SUPA G0 Z650.0000 D0 M9", "SUPA G0 Z650 D0 M9\nSUPA G0 X0 Y0 A=0 C=0 D0"),
            Harmless,
            "parks behind the retract",
        ),
        (C, Last("SUPA G0 Z650.0000 D0 M9", "SUPA G0 Z650 D0 M9\nSUPA G0 Z0 D0"), Refused, "down again"),
        (C, First("SUPA G0 Z650.0000 D0 M9", "SUPA G0 Z650 D0\nM9"), Harmless, "in two blocks"),
    ]
}

fn without(text: &str, start: &str) -> String {
    text.lines().filter(|l| !l.starts_with(start)).map(|l| format!("{l}\n")).collect()
}

fn swap_stations(text: &str) -> String {
    let mut lines: Vec<&str> = text.lines().collect();
    let at = lines.iter().position(|l| l.starts_with("SUPA G0 A")).unwrap();
    lines.swap(at, at + 1);
    lines.join("\n") + "\n"
}

fn transformation() -> Vec<Kind> {
    const C: &str = "transformation";
    vec![
        (C, First("TRAORI\n", ""), Refused, "words of the part are those of the machine then"),
        (C, First("TRAORI\n", "TRAFOOF\n"), Refused, "words of the part are those of the machine then"),
        (C, First("TRAORI\n", "TRAORI\nTRAORI\n"), Refused, "switched on twice: something is missing between"),
        (C, First("TRAORI\n", "TRAORI(2)\n"), Refused, "another transformation"),
        (C, First("TRAORI\n", "TRANSMIT\n"), Refused, "another transformation"),
        (C, First("TRAORI\n", "TRACYL(50)\n"), Refused, "another transformation"),
        (C, First("TRAORI\n", "TRAORI G54\n"), Refused, "stands alone in its block"),
        (C, First("TRAORI\n", "TRAORI X0\n"), Refused, "stands alone in its block"),
        (C, First("TRAORI\n", "traori ; on\n"), Harmless, "case and comments"),
        (C, First("TRAORI\n", "TRAORI\nSUPA G0 Z650 D0\n"), Refused, "machine frame under TRAORI"),
        (C, First("TRAORI\n", "TRAORI\nD0\n"), Refused, "the length changes under TRAORI"),
        (C, First("TRAORI\n", "TRAORI\nT=\"t2\" M6\n"), Refused, "a change under TRAORI"),
        (C, First("TRAORI\n", "TRAORI\nM0\n"), Refused, "waits on the way down"),
        (C, First("TRAORI\n", "TRAORI\nTRANS X1\n"), Refused, "shifts the frame"),
        (C, First("TRAORI\n", "TRAORI\nROT Z5\n"), Refused, "turns the frame"),
        (C, First("G54 ORIWKS ORIAXES M8", "ORIWKS ORIAXES M8"), Refused, "TRAORI drops the offset"),
        (C, First("G54 ORIWKS ORIAXES M8", "G500 ORIWKS ORIAXES M8"), Refused, "no offset"),
        (C, First("G54 ORIWKS ORIAXES M8", "G55 ORIWKS ORIAXES M8"), Refused, "another offset"),
        (C, First("G54 ORIWKS ORIAXES M8", "G56 ORIWKS ORIAXES M8"), Refused, "another offset"),
        (C, First("G54 ORIWKS ORIAXES M8", "G505 ORIWKS ORIAXES M8"), Refused, "another offset"),
        (C, First("G54 ORIWKS ORIAXES M8", "G54 ORIAXES M8"), Refused, "vectors of another frame"),
        (C, First("G54 ORIWKS ORIAXES M8", "G54 ORIMKS ORIAXES M8"), Refused, "vectors of the machine"),
        (C, First("G54 ORIWKS ORIAXES M8", "G54 ORIWKS M8"), Refused, "how the axis turns is left over"),
        (C, First("G54 ORIWKS ORIAXES M8", "G54 ORIWKS ORIVECT M8"), Refused, "great circles"),
        (C, First("G54 ORIWKS ORIAXES M8", "G54 ORIWKS ORIPLANE M8"), Refused, "great circles"),
        (C, First("G54 ORIWKS ORIAXES M8", "G54 ORIWKS ORIPATH M8"), Refused, "along the path"),
        (C, First("G54 ORIWKS ORIAXES M8", "G54 ORIWKS ORICURVE M8"), Refused, "a second curve"),
        (C, First("G54 ORIWKS ORIAXES M8", "G54 ORIWKS ORIAXES ORIVECT M8"), Refused, "two words of one group"),
        (C, First("G54 ORIWKS ORIAXES M8", "G54 ORIWKS ORIAXES"), Refused, "no coolant"),
        (C, First("G54 ORIWKS ORIAXES M8", "G54 ORIWKS ORIAXES M9"), Refused, "no coolant"),
        (C, First("G54 ORIWKS ORIAXES M8", "G54 ORIWKS ORIAXES M7"), Harmless, "mist"),
        (C, First("G54 ORIWKS ORIAXES M8", "G54\nORIWKS\nORIAXES\nM8"), Harmless, "in four blocks"),
        (C, First("G54 ORIWKS ORIAXES M8", "M8 oriaxes oriwks g54"), Harmless, "order and case"),
        (C, Last("G54 ORIWKS ORIAXES M8", "G54 M8"), Harmless, "ORIWKS and ORIAXES are modal"),
        (C, Last("G54 ORIWKS ORIAXES M8", "M8"), Refused, "TRAORI drops the offset"),
        (C, Cut("TRAFOOF\n", ""), Refused, "a retract in the machine frame under TRAORI"),
        (C, Cut("TRAFOOF\n", "TRAFOOF\nTRAFOOF\n"), Harmless, "said twice"),
        (C, Cut("\nG1 X", "\nTRAFOOF\nG1 X"), Refused, "words of the part are those of the machine then"),
        (C, Cut("\nG1 X", "\nTRAFOOF\nTRAORI\nG1 X"), Refused, "switched on in the part"),
    ]
}

fn path() -> Vec<Kind> {
    const C: &str = "modal in the path";
    vec![
        (C, Cut("\nG1 X", "\nG700\nG1 X"), Refused, "inches"),
        (C, Cut("\nG1 X", "\nG91\nG1 X"), Refused, "distances"),
        (C, Cut("\nG1 X", "\nG18\nG1 X"), Refused, "another plane"),
        (C, Cut("\nG1 X", "\nG41\nG1 X"), Refused, "compensation"),
        (C, Cut("\nG1 X", "\nG93\nG1 X"), Refused, "F is missing then"),
        (C, Cut("\nG1 X", "\nG95\nG1 X"), Refused, "feed a revolution"),
        (C, Cut("\nG1 X", "\nG500\nG1 X"), Refused, "no offset"),
        (C, Cut("\nG1 X", "\nG55\nG1 X"), Refused, "another offset"),
        (C, Cut("\nG1 X", "\nORIMKS\nG1 X"), Refused, "vectors of the machine"),
        (C, Cut("\nG1 X", "\nORIVECT\nG1 X"), Refused, "great circles"),
        (C, Cut("\nG1 X", "\nG64\nG1 X"), Refused, "rounds as the machine likes"),
        (C, Cut("\nG1 X", "\nG641\nG1 X"), Refused, "rounds as the machine likes"),
        (C, Cut("\nG1 X", "\nG642\nG1 X"), Harmless, "within the tolerance of CYCLE832"),
        (C, Cut("\nG1 X", "\nG60\nG1 X"), Harmless, "exact stop"),
        (C, Cut("\nG1 X", "\nCYCLE832(0.9,_ORI_ROUGH,0.1000)\nG1 X"), Refused, "more than the job allows"),
        (C, Cut("\nG1 X", "\nCYCLE832(0,_OFF,1)\nG1 X"), Refused, "settings of the machine"),
        (C, Cut("\nG1 X", "\nM5\nG1 X"), Refused, "the spindle stands"),
        (C, First("\nTRAFOOF\nCYCLE832", "\nS1\nTRAFOOF\nCYCLE832"), Refused, "it nearly stands in the part"),
        (C, Cut("\nG1 X", "\nM4\nG1 X"), Refused, "the wrong way round"),
        (C, Cut("\nG1 X", "\nM9\nG1 X"), Refused, "no coolant"),
        (C, Cut("\nG1 X", "\nS1\nG1 X"), Refused, "another speed than that of the job"),
        (C, Cut("\nG1 X", "\nM6\nG1 X"), Refused, "a change in the part"),
        (C, Cut("\nG1 X", "\nD2\nG1 X"), Refused, "another cutting edge"),
        (C, Cut("\nG1 X", "\nM0\nG1 X"), Refused, "the tool rubs while the program waits"),
        (C, Cut("\nG1 X", "\nG4 F9\nG1 X"), Refused, "the tool rubs while the program waits"),
        (C, Cut("\nG1 X", "\nM30\nG1 X"), Refused, "ends in the part"),
        (C, Cut("\nG1 X", "\nM17\nG1 X"), Refused, "the end of a subprogram"),
        (C, Cut("\nG1 X", "\nX"), Harmless, "G1 is modal"),
        (C, Cut("\nG1 X", "\nG17 G710 G90\nG1 X"), Harmless, "said again"),
    ]
}

fn moves() -> Vec<Kind> {
    const C: &str = "block of the path";
    vec![
        (C, Cut("\nG1 X", "\nG0 G1 X"), Refused, "two words of one group"),
        (C, Cut("\nG1 X", "\nG2 X"), Refused, "an arc"),
        (C, Cut("\nG1 X", "\nG3 X"), Refused, "an arc"),
        (C, Cut("\nG1 X", "\nG33 X"), Refused, "follows the spindle"),
        (C, Cut("\nG1 X", "\nBSPLINE X"), Refused, "a spline"),
        (C, Cut("\nG1 X", "\nPOLY PO[X]=(1,2) X"), Refused, "a polynomial"),
        (C, Cut("\nG1 X", "\nSUPA G1 X"), Refused, "machine frame under TRAORI"),
        (C, Cut("\nG1 X", "\n/G1 X"), Refused, "depends on a switch"),
        (C, Cut("\nG1 X", "\nIF R1==1 GOTOF END\nG1 X"), Refused, "flow of the program"),
        (C, Cut("\nG1 X", "\nEND: G1 X"), Refused, "a label"),
        (C, Cut("\nG1 X", "\nG1 MEAS=1 X"), Refused, "measures"),
        (C, Cut("\nG1 X", "\nG1 OFFN=1 X"), Refused, "an allowance"),
        (C, Cut("\nG1 X", "\nG01 X"), Harmless, "leading zeros"),
        (C, Word("X", Double), Refused, "a word twice"),
        (C, Word("Y", Double), Refused, "a word twice"),
        (C, Word("Z", Double), Refused, "a word twice"),
        (C, Word("A3=", Double), Refused, "a word twice"),
        (C, Word("C3=", Double), Refused, "a word twice"),
        (C, Word("A3=", Address("A=")), Refused, "an angle beside a vector"),
        (C, Word("A3=", Address("A3")), Refused, "the equals sign is missing"),
        (C, Word("A3=", Address("A2=")), Refused, "Euler angles"),
        (C, Word("B3=", Address("A3=")), Refused, "a word twice"),
        (C, Word("C3=", Address("C=")), Refused, "an angle beside a vector"),
        (C, Word("X", Address("Y")), Refused, "a word twice"),
        (C, Word("X", Address("U")), Refused, "no such axis"),
        (C, Word("X", Address("X=")), Harmless, "with an equals sign"),
        (C, Word("X", Number("NAN")), Refused, "no number"),
        (C, Word("X", Number("")), Refused, "a number is missing"),
        (C, Word("X", Number("-")), Refused, "no number"),
        (C, Word("X", Number("--1")), Refused, "no number"),
        (C, Word("X", Number("1E2")), Refused, "exponents are written EX"),
        (C, Word("X", Number("1,5")), Refused, "no comma"),
        (C, Word("X", Number("1.2.3")), Refused, "two points"),
        (C, Word("X", Number("=R1")), Refused, "a parameter"),
        (C, Word("X", Number("=IC(5)")), Refused, "a distance"),
        (C, Word("X", Number("=AC(5)")), Refused, "an expression"),
        (C, Word("X", Number("999999")), Refused, "beyond any machine"),
        (C, Word("Z", Number("-60")), Found, "through part and table"),
        (C, Word("Z", Number("900")), Found, "beyond the travel"),
        (C, Text("a component is missing", |t| t.replacen(" B3=", " F", 1)), Refused, "a missing one counts as 0"),
        (C, Text("a vector of no length", zero_vector), Refused, "no direction"),
        (C, First("F150.000", "F0"), Refused, "no feed"),
        (C, First("F150.000", "F-150"), Refused, "a negative feed"),
        (C, First("F150.000", "F15000"), Refused, "above the feeds of the job"),
        (C, First("F150.000", "F"), Refused, "a number is missing"),
        (C, First("F150.000", "F=150"), Harmless, "with an equals sign"),
        (C, First("F150.000", "FB=150"), Refused, "the feed of one block"),
    ]
}

fn zero_vector(text: &str) -> String {
    let at = text.find(" A3=").unwrap();
    let end = at + text[at..].find(" C3=").unwrap();
    let end = end + 1 + text[end + 1..].find([' ', '\n']).unwrap();
    format!("{} A3=0 B3=0 C3=0{}", &text[..at], &text[end..])
}

fn spelling() -> Vec<Kind> {
    const C: &str = "alphabet";
    vec![
        (
            C,
            Text("lower case", |t| t.to_lowercase()),
            Harmless,
            "case means nothing but in names, which have small letters",
        ),
        (C, Text("CRLF", |t| t.replace('\n', "\r\n")), Harmless, "the end of a line"),
        (C, Text("lone CR", |t| t.replacen(" G90", "\rG90", 1)), Refused, "a control character"),
        (C, Text("tabs", |t| t.replace(' ', "\t")), Harmless, "tabs are blanks"),
        (C, Text("wide", |t| t.replace(' ', "   ")), Harmless, "blanks mean nothing between words"),
        (C, Text("glued", |t| t.replacen("G17 G710 G90", "G17G710G90", 1)), Harmless, "words may be glued"),
        (C, Text("blank lines", |t| t.replace('\n', "\n\n")), Harmless, "blank lines mean nothing"),
        (C, Text("no last line feed", |t| t.trim_end().to_owned()), Harmless, "M30 ends the program"),
        (C, Text("byte order mark", |t| format!("\u{feff}{t}")), Refused, "no character of the language"),
        (C, Text("no-break blank", |t| t.replacen(" G90", "\u{a0}G90", 1)), Refused, "no blank of the language"),
        (C, Text("wide blank", |t| t.replacen(" G90", "\u{3000}G90", 1)), Refused, "no blank of the language"),
        (C, Text("zero byte", |t| t.replacen(" G90", "\0G90", 1)), Refused, "a control character"),
        (
            C,
            Text("head of a tape", |t| format!("%_N_SMALL_MPF\n;$PATH=/_N_WKS_DIR/_N_X_WPD\n{t}")),
            Harmless,
            "the head of a transferred file",
        ),
        (
            C,
            Text("head of a tape later", |t| t.replacen("G500\n", "%_N_SMALL_MPF\nG500\n", 1)),
            Refused,
            "another program begins",
        ),
        (C, Cut("G1 X", "G1 \u{425}"), Refused, "a Cyrillic letter"),
        (C, Cut("G1 X", "G1 \u{3a7}"), Refused, "a Greek letter"),
        (C, Cut("G1 X", "G\u{661} X"), Refused, "an Arabic digit"),
        (C, Cut("G1 X", "G\u{ff11} X"), Refused, "a wide digit"),
        (C, Cut("Y-", "Y\u{2212}"), Refused, "a minus of typography"),
        (C, Cut("Y-", "Y\u{2013}"), Refused, "a dash"),
        (C, First("T=\"t1\"", "T=\u{201c}t1\u{201d}"), Refused, "quotes of typography"),
        (C, First("T=\"t1\"", "T=\"\u{442}1\""), Refused, "a Cyrillic letter in the name"),
        (C, First("TRAORI", "TR\u{410}ORI"), Refused, "a Cyrillic letter"),
        (C, First(" M6 ; groove", "(groove)"), Refused, "brackets are no comment"),
        (C, First(" M6 ; groove", " M6 ; (groove) G91"), Harmless, "a comment"),
        (C, First(" M6 ; groove", " M6"), Harmless, "no comment"),
        (C, First(" M6 ; groove", " M6 ; \u{43f}\u{430}\u{437}"), Harmless, "any letters in a comment"),
        (C, First("G500\n", "N5 G500\n"), Harmless, "a block number"),
        (C, First("G500\n", "N5\n"), Harmless, "a block number alone"),
        (C, First("G500\n", "G500 N5\n"), Refused, "a block number inside of a block"),
        (C, First("G500\n", "M428\n"), Refused, "a word of another control"),
        (C, First("G500\n", "G43 H1\n"), Refused, "a word of another control"),
        (C, First("G500\n", "G500.5\n"), Refused, "no such word"),
        (C, First("G500\n", "G\n"), Refused, "a number is missing"),
        (C, First("G500\n", "GROUP_BEGIN(0,\"x\",0,0)\n"), Refused, "is not read"),
        (C, First("G500\n", "EXTCALL \"X\"\n"), Refused, "another program"),
        (C, First("G500\n", "DEF REAL X1\n"), Refused, "a variable"),
        (
            C,
            Text("513 characters", |t| t.replacen("G500", &format!("G500{}", " ".repeat(509)), 1)),
            Refused,
            "longer than a block may be",
        ),
    ]
}

fn end() -> Vec<Kind> {
    const C: &str = "end";
    vec![
        (C, Last("M30\n", ""), Refused, "no end"),
        (C, Last("M30\n", "M2\n"), Harmless, "an end as well"),
        (C, Last("M30\n", "M02\n"), Harmless, "leading zeros"),
        (C, Last("M30\n", "M17\n"), Refused, "the end of a subprogram"),
        (C, Last("M30\n", "RET\n"), Refused, "the end of a subprogram"),
        (C, Last("M30\n", "M30\nM30\n"), Refused, "text behind the end"),
        (C, Last("M30\n", "M30\nG0 X0\n"), Refused, "text behind the end"),
        (C, Last("M30\n", "M30\n; done\n"), Harmless, "a comment"),
        (C, Last("M5\n", ""), Refused, "the spindle runs on"),
        (C, First("M5\n", ""), Harmless, "the next change stops the spindle"),
        (C, Last(" M9\n", "\n"), Refused, "the coolant runs on"),
        (C, First(" M9\n", "\n"), Harmless, "coolant over the change"),
        (C, Last("TRAFOOF\n", ""), Refused, "a retract in the machine frame under TRAORI"),
        (
            C,
            Text("all that switches off is missing", |t| {
                t.rfind("TRAFOOF\n").map(|at| format!("{}M30\n", &t[..at])).unwrap()
            }),
            Refused,
            "ends in a cut, all on",
        ),
        (C, Text("cut in the middle", |t| t[..t.len() / 2].to_owned()), Refused, "no end"),
        (C, Text("empty", |_| String::new()), Refused, "no program"),
    ]
}

/// The head and the operations.
/// The last number between two pieces is 0.1.
pub(super) fn wide_turn(text: &str, before: &str, behind: &str) -> String {
    let from = text.rfind(before).unwrap() + before.len();
    let to = from + text[from..].find(behind).unwrap();
    assert!(text[from..to].parse::<f64>().unwrap() < 0.09);
    format!("{}0.1{}", &text[..from], &text[to..])
}

fn parts(text: &str) -> Vec<String> {
    operations::parts(text, |lines, i| lines[i].ends_with("a restart point"))
}

fn wrong() -> Vec<Kind> {
    const C: &str = "wrong job, machine";
    vec![
        (
            C,
            Machine("A opposite", |m| m.rotary[0].word_sign = -1.0),
            Refused,
            "the vectors of the path are those of the other side",
        ),
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
        (C, All("T=\"t1\"", "T=\"t3\""), Refused, "no such tool in the job"),
    ]
}
