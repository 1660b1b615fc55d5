//! Random changes of files of every format: each text is read, or refused with a place. What is read is divided, or refused.

use super::{human, read};
use crate::import::{bladegen, geomturbo, ibl, rtzt, step, step_wheel, table, turbogrid};
use impellerc::blade::ThicknessDirection;
use impellerc::blade_files::outlines::{doubtful, outlines};
use impellerc::blade_files::{Axis, LengthUnit, Options};
use impellerc::diagnostics::Severity;
use proptest::prelude::*;
use proptest::sample::Index;

/// Files of each format; the first is given.
fn sets() -> Vec<Vec<(String, String)>> {
    vec![
        turbogrid::example(),
        geomturbo::example(),
        ibl::example(),
        rtzt::example(),
        table::example(),
        step::example(),
        step_wheel::example(),
        bladegen::example(),
    ]
}

const PIECES: [&str; 20] = [
    "0",
    "-1",
    "1e300",
    "1e400",
    "NaN",
    "inf",
    "\n",
    "#",
    "!",
    "##",
    ",",
    ":",
    "begin section",
    "NI_END",
    "99999999",
    "\u{fffd}",
    "#4",
    "(",
    "/*",
    "ENDSEC;",
];

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn changed_files_never_panic(
        set in 0..sets().len(),
        file in any::<Index>(),
        changes in prop::collection::vec((any::<Index>(), 0..6_usize, any::<u8>(), 0..PIECES.len()), 1..5),
    ) {
        let mut files = sets().swap_remove(set);
        let k = file.index(files.len());
        let mut bytes = files[k].1.clone().into_bytes();
        for (at, kind, byte, piece) in changes {
            if bytes.is_empty() {
                break;
            }
            let i = at.index(bytes.len());
            match kind {
                0 => bytes.truncate(i),
                1 => bytes[i] = byte,
                2 => _ = bytes.drain(i..(i + 1 + usize::from(byte) % 40).min(bytes.len())),
                3 => {
                    let again = bytes[i..(i + usize::from(byte)).min(bytes.len())].to_vec();
                    bytes.splice(i..i, again);
                }
                _ => _ = bytes.splice(i..(i + usize::from(byte) % 9).min(bytes.len()), PIECES[piece].bytes()),
            }
        }
        files[k].1 = String::from_utf8_lossy(&bytes).into_owned();
        let borrowed: Vec<(&str, &str)> = files.iter().map(|(n, t)| (n.as_str(), t.as_str())).collect();
        let options = Options {
            unit: (set != 0 && set != 1).then_some(LengthUnit::Millimetre),
            axis: (set == 2).then_some(Axis::Z),
            blades: matches!(set, 2 | 4 | 6).then_some(5),
            thickness: (set == 4).then_some(ThicknessDirection::Normal),
            ..Options::default()
        };
        let given = if set == 4 { borrowed.len() } else { 1 };
        let (result, sources) = read(&borrowed, given, &options);
        match result {
            Err(diags) => {
                prop_assert!(!diags.is_empty() && diags.iter().all(|d| d.severity == Severity::Error && d.help.is_some()));
                human(&diags, &sources);
            }
            Ok(imported) => {
                for row in &imported.rows {
                    match outlines(row, imported.hub.as_deref(), &options) {
                        Err(diag) => _ = human(&[diag], &sources),
                        Ok(divided) => {
                            for (blade, divided) in row.blades.iter().zip(&divided) {
                                human(&doubtful(blade, divided), &sources);
                            }
                        }
                    }
                }
            }
        }
    }
}
