//! Files of sections of the part: the import reads them, and their points lie on the design surfaces.

use crate::support::jobs;
use impellerc::base::source::{SourceFile, SourceMap};
use impellerc::blade::{EdgeForm, SectionForm};
use impellerc::blade_files::{self, Imported};
use impellerc::driver::{self, Emit, Options, PartOptions, Stages};
use impellerc::nurbs::proximity::Patch;
use impellerc::wheel::part::{Part, Surface};
use std::path::PathBuf;

/// Writes the sections of a job; returns what the import reads and what was printed.
fn written(job: &str, sections: usize) -> (Imported, String) {
    let folder = tempfile::tempdir().unwrap();
    let options = Options {
        job: PathBuf::from(job),
        output: Some(folder.path().join("wheel.inf")),
        emit: Emit::named("sections"),
        part: PartOptions { sections, ..PartOptions::default() },
        ..Options::default()
    };
    let said = driver::compile(&options, &mut Stages::default()).emitted.unwrap();
    let mut fetch = |name: &str, _: usize| {
        let text =
            std::fs::read_to_string(folder.path().join(name)).map_err(|e| blade_files::NoFile::from(e.to_string()))?;
        Ok(SourceFile::text(name, text))
    };
    let names = ["wheel.inf".to_owned()];
    let read = blade_files::read(&names, &mut fetch, &blade_files::Options::default(), &mut SourceMap::default());
    (read.unwrap_or_else(|diags| panic!("{diags:#?}")), said)
}

/// Distance of a point to the nearest face or rounded edge of a blade.
fn off(part: &Part, blade: usize, p: &nalgebra::Point3<f64>) -> f64 {
    let blade = part.blade_ids().nth(blade).unwrap();
    let patch = Patch { u: [-0.05, 1.05], v: [-0.2, 1.2] };
    part.sides(blade).map(|id| part.face(id).surface.closest(p, patch).distance).fold(f64::INFINITY, f64::min)
}

#[test]
fn sections_are_read_back() {
    for (job, forms) in [
        ("jobs/small/small.imp", [EdgeForm::CutOff, EdgeForm::CutOff]),
        ("jobs/sections/sections.imp", [EdgeForm::Round, EdgeForm::CutOff]),
        ("jobs/splitter/splitter.imp", [EdgeForm::Round, EdgeForm::CutOff]),
    ] {
        let part = jobs::program_at(job).part;
        let (read, said) = written(job, 7);
        assert!(said.contains("7 sections") && said.contains("read back, surfaces"), "{said}");
        let row = &read.rows[0];
        assert_eq!((row.count, row.blades.len()), (part.vane_count, part.blades.len()), "{job}");
        let mut worst = 0.0_f64;
        for (k, blade) in row.blades.iter().enumerate() {
            assert_eq!(blade.name, part.blades[k].name);
            assert_eq!(blade.edges, forms.map(Some), "{job}");
            assert_eq!(blade.sections.len(), 7);
            for section in &blade.sections {
                let SectionForm::Loop(points) = &section.form else { panic!("{job}: not a loop") };
                let share = section.span.unwrap();
                for p in points.iter().step_by(3) {
                    worst = worst.max(off(&part, k, p));
                    // The first section lies on the hub, the last one on the shroud.
                    let [hub, shroud] = [&part.hub, &part.shroud].map(|surface| surface.distance(p).abs());
                    assert!(share > 0.0 || hub < 1e-6, "{job}: {hub}");
                    assert!(share < 1.0 || shroud < 1e-6, "{job}: {shroud}");
                }
            }
        }
        println!("{job}: points within {worst:.1e} mm of the design surfaces");
        assert!(worst < 1e-6, "{job}: {worst}");
        for (found, surface) in [(&read.hub, &part.hub), (&read.shroud, &part.shroud)] {
            for [r, z] in found.as_ref().unwrap() {
                assert!(surface.distance(&nalgebra::Point3::new(*r, 0.0, *z)).abs() < 1e-6);
            }
        }
    }
}

/// More sections come nearer to a part that is lofted; what is printed says how near.
#[test]
fn more_sections_come_nearer() {
    let near = |sections: usize| -> f64 {
        let (_, said) = written("jobs/sections/sections.imp", sections);
        let at = said.find("within ").unwrap() + "within ".len();
        said[at..].split(' ').next().unwrap().parse().unwrap()
    };
    let [few, many] = [3, 17].map(near);
    assert!(many < 0.01 * few && many < 1e-3, "{few} {many}");
}
