//! Absurd sizes: for any number of a property, the job compiles or is refused for a reason that lies in the job.

use impellerc::diagnostics::codes;
use impellerc::driver::{self, Options, Outcome, Stages};
use rayon::prelude::*;
use std::path::Path;

/// The small job with its operations taken out.
fn frame() -> String {
    let job = include_str!("../../jobs/small/small.imp");
    let (start, end) = (job.find("operation groove").unwrap(), job.find("tolerance chord").unwrap());
    format!("{}OPERATION\n{}", &job[..start], &job[end..])
}

const GROOVE: &str = "operation groove { tool t1  speed 12000 rpm  feed 150 mm/min  depth 3 mm  \
                      allowance vane 0.2 mm, hub 0.4 mm  link-feed 900 mm/min  lead-in 5 mm  lead-out 4 mm  sectors 1 }";
const EXPAND: &str = "operation expand { tool t1  speed 12000 rpm  feed 150 mm/min  depth 3 mm  residual 0.5 mm  \
                      allowance vane 0.2 mm, hub 0.4 mm  lead-in 5 mm  lead-out 5 mm  sectors 1 }";
const FLANK: &str = "operation flank { tool t2  speed 12000 rpm  feed 250 mm/min  faces pressure  method two-point  \
                     strips 2  lead-in 6 mm  lead-out 6 mm  sectors 1 }";
const CHANNEL: &str = "operation channel { tool t2  speed 12000 rpm  feed 250 mm/min  scallop 0.2 mm  \
                       spacing equal-division  method blend  lead-in 4 mm  lead-out 3 mm  sectors 1 }";
const TAPER: &str = "tool t3 = tapered-ball { diameter 2.2 mm  angle 3 deg  flutes 4  flute 12 mm  reach 26 mm }";
const BULL: &str =
    "tool t3 = bull { diameter 2.2 mm  corner 0.5 mm  flutes 4  flute 12 mm  reach 26 mm  shank 2.1 mm }";
const BARREL: &str =
    "tool t3 = barrel { diameter 2.2 mm  barrel 40 mm  tip 0.5 mm  flutes 4  flute 12 mm  reach 26 mm }";
const LOLLIPOP: &str = "tool t3 = lollipop { diameter 2.2 mm  neck 1.1 mm  neck-end 20 mm  flutes 4  reach 26 mm }";

/// Operation of the job, what is added to it, and the figures that change, each as it stands in the text.
const FIGURES: &[(&str, &str, &[&str])] = &[
    (
        GROOVE,
        "",
        &[
            "speed 12000 rpm",
            "feed 150 mm/min",
            "depth 3 mm",
            "vane 0.2 mm",
            "hub 0.4 mm",
            "link-feed 900 mm/min",
            "lead-in 5 mm",
            "lead-out 4 mm",
            "fillet 1.2 mm",
            "over shroud 0 mm",
            "bore 4 mm",
            "back -16 mm",
            "rough 50 um",
            "gouge     <= 2 um",
            "clearance >= 0.5 mm",
            "vanes 8",
            "sectors 1",
        ],
    ),
    (EXPAND, "", &["residual 0.5 mm"]),
    (FLANK, "", &["strips 2", "chord 1 um"]),
    (CHANNEL, "", &["scallop 0.2 mm", "lead-in 4 mm", "lead-out 3 mm"]),
    (CHANNEL, TAPER, &["diameter 2.2 mm", "angle 3 deg", "reach 26 mm"]),
    (CHANNEL, BULL, &["diameter 2.2 mm", "corner 0.5 mm", "shank 2.1 mm"]),
    (CHANNEL, BARREL, &["barrel 40 mm", "tip 0.5 mm"]),
    (CHANNEL, LOLLIPOP, &["neck 1.1 mm", "neck-end 20 mm"]),
];

const ABSURD: [&str; 6] = ["0", "1e-300", "1e-9", "-1e-9", "1e9", "1e300"];

fn compile(text: &str, folder: &Path, whole: bool) -> Outcome {
    let path = folder.join("job.imp");
    std::fs::write(&path, text).unwrap();
    std::fs::write(folder.join("vane_curves.csv"), include_str!("../../jobs/small/vane_curves.csv")).unwrap();
    let options = Options { job: path, ..Options::default() };
    if whole {
        return driver::compile(&options, &mut Stages::default());
    }
    let mut outcome = Outcome::default();
    let program = driver::front(&options, &mut Stages::default(), &mut outcome);
    assert_eq!(program.is_err(), outcome.sink.has_errors());
    outcome
}

#[test]
fn absurd_figures_compile_or_are_refused() {
    let frame = frame();
    let mut jobs: Vec<(String, String)> = Vec::new();
    for (operation, tool, figures) in FIGURES {
        let job = frame.replace("OPERATION", &format!("{tool}\n{operation}"));
        for figure in *figures {
            assert!(job.contains(figure), "{figure} is not in the job");
            for value in ABSURD {
                let number = figure
                    .split_whitespace()
                    .find(|w| w.trim_start_matches('-').starts_with(|c: char| c.is_ascii_digit()));
                let number = number.unwrap();
                // The last place: `feed` stands in `link-feed` as well.
                let at = job.rfind(figure).unwrap() + figure.rfind(number).unwrap();
                let mut changed = job.clone();
                changed.replace_range(at..at + number.len(), value);
                jobs.push((format!("{figure}: {value}"), changed));
            }
        }
    }
    let faults: Vec<String> = jobs
        .into_par_iter()
        .filter_map(|(name, text)| {
            let folder = tempfile::tempdir().unwrap();
            let first = compile(&text, folder.path(), false);
            let outcome = if first.sink.has_errors() { first } else { compile(&text, folder.path(), true) };
            let internal = outcome.sink.diags().iter().find(|d| d.code == codes::files::INTERNAL);
            internal.map(|d| format!("{name}: {}", d.message))
        })
        .collect();
    assert!(faults.is_empty(), "{faults:#?}");
}
