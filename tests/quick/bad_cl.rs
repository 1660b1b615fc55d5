//! Bad CL data: every fault is an error with its line; no panic, no endless loop, bounded memory.

use crate::support;
use impellerc::diag::Sink;
use impellerc::kin::Machine;
use impellerc::post::{self, MOST_FAULTS, NcSection, ReadError, motion_of::motion_of};
use impellerc::source::Span;
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
    post::find("apt-cl").unwrap().read(text, &MACHINE)
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
    assert_eq!(read(&broken).unwrap_err().len(), MOST_FAULTS);
}

fn mutated() -> impl Strategy<Value = String> {
    let change = (any::<prop::sample::Index>(), 0..4_u8, "[A-Z0-9=.,$/\" ;+-]{1,3}");
    prop::collection::vec(change, 1..4).prop_map(|changes| {
        let mut text = CL.to_owned();
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
                prop_assert!(!faults.is_empty() && faults.len() <= MOST_FAULTS);
                prop_assert!(faults.iter().all(|f| (1..=count).contains(&f.line) && !f.reason.is_empty()));
            }
        }
    }
}
