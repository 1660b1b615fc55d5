//! Readers of blade files: what they make of files of every format, of files with the traps of these formats, and of faulty
//! ones.

mod bladegen;
mod command;
mod data;
mod examples;
mod geomturbo;
mod ibl;
mod mutations;
mod rtzt;
mod sections;
mod step;
mod step_assembly;
mod step_faces;
mod step_hub;
mod step_nose;
mod step_wheel;
mod table;
mod turbogrid;

use impellerc::base::source::{SourceFile, SourceMap};
use impellerc::blade::SectionForm;
use impellerc::blade_files::{self, Axis, Imported, LengthUnit, Options};
use impellerc::diagnostics::{Diag, Severity, Sink, codes, render};
use nalgebra::Point3;

/// Files in memory, by name.
pub type FileTexts<'a> = &'a [(&'a str, &'a str)];

/// Reads the first `given` files; the others can be named by these.
pub fn read(files: FileTexts<'_>, given: usize, options: &Options) -> (Result<Imported, Vec<Diag>>, SourceMap) {
    let mut sources = SourceMap::default();
    let names: Vec<String> = files.iter().take(given).map(|(name, _)| (*name).to_owned()).collect();
    let mut fetch = |name: &str, _: usize| {
        let found = files.iter().find(|(n, _)| *n == name);
        found
            .map(|(_, text)| SourceFile::text(name, *text))
            .ok_or_else(|| blade_files::NoFile::from("there is no such file".to_owned()))
    };
    let read = blade_files::read(&names, &mut fetch, options, &mut sources);
    (read, sources)
}

/// What the files hold.
pub fn good(files: FileTexts<'_>, given: usize, options: &Options) -> Imported {
    let (read, sources) = read(files, given, options);
    read.unwrap_or_else(|diags| panic!("{}", human(&diags, &sources)))
}

/// The faults of the files. Each is an error with a remedy, and with a line unless it is about a file or an option.
pub fn faults(files: FileTexts<'_>, given: usize, options: &Options) -> Vec<Diag> {
    let (read, sources) = read(files, given, options);
    let diags = read.expect_err("the files are faulty");
    assert!(!diags.is_empty());
    for diag in &diags {
        let text = human(&diags, &sources);
        assert_eq!(diag.severity, Severity::Error, "{text}");
        assert!(diag.help.is_some(), "no remedy: {text}");
        let without = [codes::import::UNKNOWN_FORMAT, codes::files::CANNOT_READ].contains(&diag.code);
        assert!(without || !diag.labels.is_empty(), "no line: {text}");
        for label in &diag.labels {
            let file = sources.get(label.span.source).expect("a file of the map");
            assert!(label.span.range().end <= file.text.len(), "{text}");
        }
    }
    diags
}

/// Line of the first mark of a fault.
pub fn line(files: FileTexts<'_>, given: usize, options: &Options) -> (&'static str, String, usize) {
    let (read, sources) = read(files, given, options);
    let diags = read.expect_err("the files are faulty");
    let span = diags[0].labels[0].span;
    (diags[0].code.id(), sources.get(span.source).unwrap().name.clone(), sources.line_column(span).0)
}

pub fn human(diags: &[Diag], sources: &SourceMap) -> String {
    let mut sink = Sink::default();
    diags.iter().cloned().for_each(|diag| sink.push(diag));
    render::human(&sink, sources, false)
}

/// Points of a section that is a loop.
pub fn points(form: &SectionForm) -> &[Point3<f64>] {
    match form {
        SectionForm::Loop(points) => points,
        other => panic!("not a loop: {other:?}"),
    }
}

/// Whether some note has these words.
pub fn noted(imported: &Imported, words: &str) -> bool {
    imported.notes.iter().any(|note| note.text.contains(words))
}

/// Options of a table in mm about Z.
pub fn millimetres() -> Options {
    Options { unit: Some(LengthUnit::Millimetre), axis: Some(Axis::Z), blades: Some(5), ..Options::default() }
}

/// A section of a made-up axial blade: a loop with round ends of radius 1 at a radius, along Z from 0 to 20, `count` points.
/// It begins `shift` points behind the leading edge.
pub fn axial_loop(radius: f64, count: usize, shift: usize) -> Vec<[f64; 3]> {
    let straight = 18.0;
    let round = std::f64::consts::PI;
    let length = 2.0 * (straight + round);
    let at = |s: f64| {
        // From the leading edge along the side of positive angle.
        let s = s.rem_euclid(length);
        let quarter = 0.5 * round;
        if s < quarter {
            [1.0 - s.cos(), s.sin()]
        } else if s < quarter + straight {
            [1.0 + s - quarter, 1.0]
        } else if s < 3.0 * quarter + straight {
            let t = s - quarter - straight;
            [19.0 + t.sin(), t.cos()]
        } else if s < 3.0 * quarter + 2.0 * straight {
            [19.0 - (s - 3.0 * quarter - straight), -1.0]
        } else {
            let t = s - 3.0 * quarter - 2.0 * straight;
            [1.0 - t.sin(), -t.cos()]
        }
    };
    (0..count)
        .map(|k| {
            let [z, arc] = at((k + shift) as f64 * length / count as f64);
            // Bent, so that it has a concave face: the mean line turns by some 20 deg.
            let theta = (arc + 0.01 * z * z) / radius;
            [radius * theta.cos(), radius * theta.sin(), z]
        })
        .collect()
}
