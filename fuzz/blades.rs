//! Readers of blade files, on texts in memory.

use impellerc::diagnostics::{Severity, Sink, render};
use impellerc::blade_files::outlines::{doubtful, outlines};
use impellerc::blade_files::{self, Axis, LengthUnit, Options};
use impellerc::blade::ThicknessDirection;
use impellerc::base::source::{SourceFile, SourceMap};

/// Stands between the files of a text.
pub const BETWEEN: char = '\u{1}';

/// Reads the files of a text and divides their sections. Faults are told with a remedy. The first `given` names are given to
/// the reader; the others can be named by these.
pub fn blades(names: &[&str], given: usize, text: &str) {
    let files: Vec<(&str, &str)> = names.iter().copied().zip(text.split(BETWEEN)).collect();
    let mut sources = SourceMap::default();
    let mut fetch = |name: &str, _: usize| {
        let found = files.iter().find(|(n, _)| *n == name);
        found.map(|(n, text)| SourceFile::text(*n, *text)).ok_or_else(|| blade_files::NoFile::from("there is no such file".to_owned()))
    };
    let stated = Options {
        unit: Some(LengthUnit::Millimetre),
        axis: Some(Axis::Z),
        blades: Some(5),
        thickness: Some(ThicknessDirection::Normal),
        ..Options::default()
    };
    let given: Vec<String> = names.iter().take(given).map(|n| (*n).to_owned()).collect();
    for options in [Options::default(), stated] {
        let mut sink = Sink::default();
        match blade_files::read(&given, &mut fetch, &options, &mut sources) {
            Err(diags) => {
                assert!(!diags.is_empty(), "refused without a reason");
                assert!(diags.iter().all(|d| d.severity == Severity::Error && d.help.is_some()), "a fault without a remedy");
                diags.into_iter().for_each(|diag| sink.push(diag));
            }
            Ok(imported) => {
                for row in &imported.rows {
                    match outlines(row, imported.hub.as_deref(), &options) {
                        Err(diag) => sink.push(diag),
                        Ok(divided) => {
                            let facts = row.blades.iter().zip(&divided).flat_map(|(blade, d)| doubtful(blade, d));
                            facts.for_each(|diag| sink.push(diag));
                        }
                    }
                }
            }
        }
        let _ = render::human(&sink, &sources, false);
    }
}
