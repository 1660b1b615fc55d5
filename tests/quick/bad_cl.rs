//! Bad CL data: every fault is an error with its line; no panic, no endless loop, bounded memory.

use crate::support;
use impellerc::base::source::Span;
use impellerc::diagnostics::Sink;
use impellerc::five_axis::Machine;
use impellerc::nc::{self, MAX_FAULTS, NcSection, ReadError, motion_of::motion_of};
use proptest::prelude::*;
use std::sync::LazyLock;

static MACHINE: LazyLock<Machine> = LazyLock::new(support::machine);

/// A stroke along a tilted tool.
const CL: &str = "\
PARTNO TEST
UNITS/MM
$$ flank
LOADTL/2,LENGTH,102.0
CUTTER/6.0,3.0
SPINDL/RPM,8000,CLW
COOLNT/FLOOD
LINTOL/0.001
MULTAX/ON
FROM/101.3030,-180.9539,269.8076,0.17101007,-0.46984631,0.86602540
RAPID
GOTO/101.3030,-180.9539,269.8076,0.17101007,-0.46984631,0.86602540
RAPID
GOTO/50.0,-40.0,10.0,0.17101007,-0.46984631,0.86602540
FEDRAT/1000.0,MMPM
GOTO/30.0,-17.0,4.0,0.17101007,-0.46984631,0.86602540
FEDRAT/250.0,MMPM
GOTO/29.0,-18.0,3.0,0.18101007,$
  -0.46984631,0.86397
RAPID
GOTO/101.3030,-180.9539,269.8076,0.18101007,-0.46984631,0.86397
COOLNT/OFF
SPINDL/OFF
FINI
";

fn read(text: &str) -> Result<Vec<NcSection>, Vec<ReadError>> {
    nc::find("apt-cl").unwrap().read(text, &MACHINE)
}

/// No cutter touches stock while the spindle stands.
#[test]
fn the_spindle_turns_until_the_retract() {
    let stops = "stops or turns round with the tool in the part";
    for words in ["SPINDL/OFF", "SPINDL/RPM,8000,CCLW", "SPINDL/OFF\nSPINDL/RPM,8000,CLW"] {
        refused("FEDRAT/250.0,MMPM\n", &format!("{words}\nFEDRAT/250.0,MMPM\n"), 17, stops);
    }
    refused(
        "RAPID\nGOTO/101.3030,-180.9539,269.8076,0.18101007",
        "SPINDL/OFF\nRAPID\nGOTO/101.3030,-180.9539,269.8076,0.18101007",
        20,
        stops,
    );
    let again = CL.replacen("FEDRAT/250.0", "SPINDL/RPM,8000,CLW\nFEDRAT/250.0", 1);
    assert!(read(&again).is_ok(), "{:?}", read(&again));
}

/// The first fault of the text with a change: its line and its words.
fn refused(from: &str, to: &str, line: usize, words: &str) {
    assert!(CL.contains(from), "{from}");
    let faults = read(&CL.replacen(from, to, 1)).expect_err(to);
    assert!(faults[0].line == line && faults[0].reason.contains(words), "{to}: {faults:?}");
}

#[test]
fn the_original_is_read() {
    let sections = read(CL).unwrap();
    let [section] = sections.as_slice() else { panic!("{sections:?}") };
    let lines: Vec<usize> = section.moves.iter().map(|m| m.line).collect();
    assert_eq!((section.start.line, lines, section.retract.unwrap().0), (12, vec![14, 16, 18], 21));
    assert_eq!(section.moves.iter().map(|m| m.feed).collect::<Vec<_>>(), [None, Some(1000.0), Some(250.0)]);
    assert!(section.moves.iter().all(|m| m.speed == 8000.0 && m.smoothing == Some(0.001)));
    let program = support::flank_only(&[0]);
    let mut sink = Sink::default();
    let motion = motion_of(&program, &sections, &|_| Span::default(), &mut sink).unwrap().motion;
    assert!(!sink.has_errors(), "{:?}", sink.diags());
    // The table stands as the directions say, and the gauge line at the retract height.
    let first = motion.operations[0].moves[0].joints;
    let angles = first.rotary.map(f64::to_degrees);
    assert!((angles[0] - 30.0).abs() < 1e-5 && (angles[1] - 20.0).abs() < 1e-5, "{angles:?}");
    assert!(first.xyz.z + 102.0 > program.machine.retract);
}

#[test]
fn faults_have_their_line() {
    refused("GOTO/29.0,-18.0", "GOTO/29.0,-18,0", 18, "not 7 values");
    refused("GOTO/30.0", "GOTO/3O.0", 16, "`3O.0` is not a number");
    refused(",$\n", ",\n", 18, "has x, y, z, i, j and k, not 5 values");
    refused("  -0.46984631", "  -0.56984631", 18, "has the length 1.05");
    refused("MULTAX/ON\n", "", 9, "write MULTAX/ON");
    refused("UNITS/MM\n", "", 3, "write UNITS/MM");
    refused("FEDRAT/1000.0,MMPM\n", "", 15, "write FEDRAT before");
    refused("FROM/101", "FROM/100", 12, "goes elsewhere than FROM");
    refused("FINI\n", "", 23, "without FINI");
    refused("SPINDL/OFF\n", "", 23, "by line 6: write SPINDL/OFF");
}

/// Where a path begins, the gauge line stands at the retract height; here lower. The axes of the machine meet in its origin, 80 mm
/// below that of the part: the height is the product of direction and tip over it, and the length of the tool.
#[test]
fn a_low_station_is_refused() {
    let low = CL.replace("101.3030,-180.9539,269.8076,0.17101007", "67.1010,-86.9846,96.6025,0.17101007");
    let height = 0.17101007 * 67.1010 + 0.46984631 * 86.9846 + 0.86602540 * (96.6025 + 80.0) + 102.0;
    let faults = read(&low).unwrap_err();
    assert!(faults.len() == 1 && faults[0].line == 10, "{faults:?}");
    assert!(
        faults[0].reason.contains(&format!("Z {height:.3} ")) && faults[0].reason.contains("retract height 350.000"),
        "{faults:?}"
    );
}

/// One fault a cause, not one a statement; at most fifty.
#[test]
fn what_follows_from_a_fault_is_not_told_again() {
    let moves: String = (0..200).map(|i| format!("GOTO/{i}.0,0.0,4.0,0.17101007,-0.46984631,0.86602540\n")).collect();
    let long = CL.replacen(
        "RAPID\nGOTO/101.3030,-180.9539,269.8076,0.18",
        &format!("{moves}RAPID\nGOTO/101.3030,-180.9539,269.8076,0.18"),
        1,
    );
    assert!(read(&long).is_ok());
    for (from, to) in
        [("COOLNT/FLOOD\n", ""), ("SPINDL/RPM,8000,CLW\n", ""), ("MULTAX/ON\n", ""), ("LINTOL/0.001\n", "")]
    {
        assert_eq!(read(&long.replacen(from, to, 1)).unwrap_err().len(), 1, "{from}");
    }
    let broken = long.replace("0.0,4.0,", "0.0,");
    assert_eq!(read(&broken).unwrap_err().len(), MAX_FAULTS);
}

/// Causes that do not follow from each other are told at once.
#[test]
fn all_that_is_missing_is_told() {
    let bare = CL.replacen("COOLNT/FLOOD\n", "", 1).replacen("LINTOL/0.001\n", "", 1);
    let faults = read(&bare).unwrap_err();
    assert!(faults.len() == 2 && faults[0].line == faults[1].line, "{faults:?}");
    assert!(faults[0].reason.contains("COOLNT/FLOOD") && faults[1].reason.contains("LINTOL"), "{faults:?}");
}

/// The stroke with two curves of order 3 in two spans, and GOTO along them.
static CURVES: LazyLock<String> = LazyLock::new(|| {
    let axis = "0.17101007,-0.46984631,0.86602540";
    let goto = |tip: &str| format!("GOTO/{tip},{axis}\n");
    let places =
        ["29.5875,-17.525,3.575", "29.35,-17.9,3.3", "29.0875,-18.175,3.025", "28.6,-18.4,2.6"].map(goto).concat();
    let curves = format!(
        "MOVNRB/5AXIS,LENGTH,40.0\nMOVNRB/ON,3,7,0,4,2.4731\nMOVNRB/1,0.0,0.0,0.0,0.5,1.0,1.0,1.0\n\
         MOVNRB/2,30.0,-17.0,4.0,29.5,-17.6,3.5,29.2,-18.2,3.1,$\n  28.6,-18.4,2.6\n\
         MOVNRB/3,36.840403,-35.793852,38.641016,$\n  36.340403,-36.393852,38.141016,$\n\
         36.040403,-36.993852,37.741016,$\n  35.440403,-37.193852,37.241016\nMOVNRB/NEXT\n{places}MOVNRB/OFF\n"
    );
    CL.replacen("LINTOL/0.001", "LINTOL/0.05", 1).replacen("FEDRAT/250.0", &format!("{curves}FEDRAT/250.0"), 1)
});

#[test]
fn curves_are_read_span_by_span() {
    let sections = read(&CURVES).unwrap();
    let curves: Vec<_> = sections[0].moves.iter().filter_map(|m| m.curve.as_ref().map(|curve| (m, curve))).collect();
    // At 0, 0.25, 0.5, 0.75 and 1 of the whole, by the algorithm of de Boor in another program.
    let due = [
        [30.0, -17.0, 4.0],
        [29.5875, -17.525, 3.575],
        [29.35, -17.9, 3.3],
        [29.0875, -18.175, 3.025],
        [28.6, -18.4, 2.6],
    ];
    assert_eq!(curves.len(), 2);
    for (k, (m, curve)) in curves.iter().enumerate() {
        assert_eq!(m.feed, Some(1000.0));
        for (i, t) in [0.0, 0.5, 1.0].into_iter().enumerate() {
            let (tip, _) = curve.at(t);
            assert!((0..3).all(|x| (tip[x] - due[2 * k + i][x]).abs() < 1e-12), "{k} {t}: {tip}");
        }
    }
    // The motion goes on where the curves end.
    assert!((sections[0].moves.len(), sections[0].moves[4].tip.x) == (5, 29.0));
}

/// Curves cut as GOTO do: behind them the tool is in the part.
#[test]
fn the_speed_does_not_change_behind_curves() {
    let rapid = CURVES.replacen("FEDRAT/1000.0,MMPM\nGOTO/30.0", "RAPID\nGOTO/30.0", 1);
    let fast = rapid.replacen("MOVNRB/5AXIS", "FEDRAT/1000.0,MMPM\nMOVNRB/5AXIS", 1);
    assert!(read(&fast).is_ok(), "{:?}", read(&fast));
    let faults = read(&fast.replacen("FEDRAT/250.0", "SPINDL/RPM,7000,CLW\nFEDRAT/250.0", 1)).unwrap_err();
    assert!(faults.len() == 1 && faults[0].reason.contains("the speed of the spindle changes"), "{faults:?}");
}

#[test]
fn faults_of_curves_are_told() {
    for (from, to, words) in [
        ("MOVNRB/5AXIS,LENGTH,40.0", "MOVNRB/M3AXIS", "says no direction of the tool"),
        ("MOVNRB/5AXIS,LENGTH,40.0\n", "", "MOVNRB begins by"),
        ("LENGTH,40.0", "LENGTH,41.0", "not 41 mm apart"),
        ("ON,3,7,0,4", "ON,3,8,0,4", "4 control points of order 3 have 7 knots"),
        ("ON,3,7,0,4", "ON,3,7,4,4", "the number of weights is 0"),
        ("ON,3,7,0,4", "ON,7,11,0,4", "the order 7 is not from 2 to 6"),
        ("2.4731", "2.6", "2.473 mm long"),
        ("0.0,0.5,1.0", "0.0,0.0,1.0", "stand 3 times"),
        ("0.0,0.5,1.0", "0.0,1.5,1.0", "must ascend"),
        ("0.5,1.0,1.0,1.0", "0.5,1.0,1.0", "says 7 knots; 6 stand"),
        ("36.340403,-36.393852,38.141016,$\n", "36.340403,-36.393852,$\n", "not 11 numbers"),
        ("MOVNRB/NEXT\n", "", "GOTO between MOVNRB/5AXIS and MOVNRB/NEXT"),
        ("GOTO/30.0,", "GOTO/30.2,", "begins 0.2000 mm"),
        ("GOTO/29.35,", "GOTO/29.45,", "beside what is left of the curve"),
        ("GOTO/29.35,", "RAPID\nGOTO/29.35,", "at rapid between"),
        ("LINTOL/0.05", "LINTOL/0.001", "over LINTOL"),
        ("MOVNRB/OFF\n", "", "`FEDRAT` before MOVNRB/OFF of the motion that line 17 begins"),
        ("MOVNRB/OFF\n", "MOVNRB/NEXT\nMOVNRB/OFF\n", "behind MOVNRB/NEXT stand"),
        ("MOVNRB/NEXT\n", "MOVNRB/NEXT\nMOVNRB/OFF\n", "before the end of the curve"),
    ] {
        assert!(CURVES.contains(from), "{from}");
        let faults = read(&CURVES.replacen(from, to, 1)).expect_err(to);
        // An OFF too early leaves one too many at the end.
        let due = 1 + usize::from(words == "before the end of the curve");
        assert!(faults.len() == due && faults[0].reason.contains(words), "{to}: {faults:?}");
    }
    // A fault before the curves is the only one as well.
    assert_eq!(read(&CURVES.replacen("COOLNT/FLOOD\n", "", 1)).unwrap_err().len(), 1);
}

fn mutated() -> impl Strategy<Value = String> {
    let change = (any::<prop::sample::Index>(), 0..4_u8, "[A-Z0-9=.,$/\" ;+-]{1,3}");
    (prop::collection::vec(change, 1..4), any::<bool>()).prop_map(|(changes, curves)| {
        let mut text = if curves { CURVES.clone() } else { CL.to_owned() };
        for (at, kind, piece) in changes {
            let i = at.index(text.len());
            match kind {
                0 => text.insert_str(i, &piece),
                1 => drop(text.remove(i)),
                2 => text.replace_range(i..=i, &piece[..1]),
                _ => {
                    let mut lines: Vec<&str> = text.lines().collect();
                    let k = at.index(lines.len());
                    if piece.len() > 1 {
                        lines.remove(k);
                    } else {
                        lines.insert(k, lines[k / 2]);
                    }
                    text = lines.join("\n") + "\n";
                }
            }
        }
        text
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]
    #[test]
    fn changed_text_is_read_or_refused_with_a_line_of_it(text in mutated()) {
        let count = text.lines().count().max(1);
        match read(&text) {
            Ok(sections) => {
                for m in sections.iter().flat_map(|s| &s.moves) {
                    prop_assert!(m.tip.iter().all(|x| x.is_finite() && x.abs() <= 1e5));
                    prop_assert!((1..=count).contains(&m.line));
                }
                let program = support::flank_only(&[0]);
                let mut sink = Sink::default();
                match motion_of(&program, &sections, &|_| Span::default(), &mut sink) {
                    Some(nc) => {
                        let all: Vec<_> = nc.motion.operations.iter().flat_map(|o| &o.moves).collect();
                        prop_assert_eq!(all.len(), nc.lines.iter().map(Vec::len).sum::<usize>());
                        prop_assert!(all.iter().all(|m| m.time >= 0.0 && m.joints.xyz.iter().all(|x| x.is_finite())));
                    }
                    None => prop_assert!(sink.has_errors()),
                }
            }
            Err(faults) => {
                prop_assert!(!faults.is_empty() && faults.len() <= MAX_FAULTS);
                prop_assert!(faults.iter().all(|f| (1..=count).contains(&f.line) && !f.reason.is_empty()));
            }
        }
    }
}
