//! Blades of public data sets.
//! What is expected comes from the files by a few lines of its own, not by the readers.

use super::points;
pub use crate::support::blade_data::folder;
use impellerc::base::source::{SourceFile, SourceMap};
use impellerc::blade::outline::DividedSection;
use impellerc::blade::{EdgeForm, Outline};
use impellerc::blade_files::outlines::{doubtful, outlines};
use impellerc::blade_files::{self, Imported, LengthUnit, Options};
use std::path::Path;

pub fn read(folder: &Path, names: &[String], options: &Options) -> (Imported, SourceMap) {
    let mut sources = SourceMap::default();
    let mut fetch = |name: &str, _: usize| {
        let text = std::fs::read_to_string(folder.join(name)).map_err(|e| e.to_string())?;
        Ok(SourceFile::text(name, text))
    };
    let read = blade_files::read(names, &mut fetch, options, &mut sources);
    (read.unwrap_or_else(|diags| panic!("{}", super::human(&diags, &sources))), sources)
}

/// NASA Rotor 37.
pub fn rotor37() -> Option<Imported> {
    let folder = folder("nasa_rotor37")?;
    Some(read(&folder, &["BladeGen.inf".to_owned()], &Options::default()).0)
}

/// Rotor 1 of the compressor of Hannover.
pub fn hannover() -> Option<Imported> {
    let folder = folder("hannover_tfd4ac_rotor1")?;
    Some(read(&folder, &["1_Rotor1_Blade.inf".to_owned()], &Options::default()).0)
}

/// NASA HECC: sections of the main blade and of the splitter, hub and shroud; inches, 15 blades by the read-me.
pub fn hecc() -> Option<Imported> {
    let folder = folder("nasa_hecc/hot_design_intent")?;
    let mut names: Vec<String> =
        std::fs::read_dir(&folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    let options = Options { unit: Some(LengthUnit::Inch), blades: Some(15), ..Options::default() };
    Some(read(&folder, &names, &options).0)
}

/// All lines of numbers of a file.
fn numbers(set: &str, file: &str) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(folder(set).unwrap().join(file)).unwrap();
    let line = |line: &str| line.split_whitespace().map(|w| w.parse().ok()).collect::<Option<Vec<f64>>>();
    text.lines().filter_map(line).filter(|n| !n.is_empty()).collect()
}

/// Range of a value.
fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
}

fn close(found: [f64; 2], due: [f64; 2]) {
    for (found, due) in found.into_iter().zip(due) {
        assert!((found - due).abs() < 1e-9 * due.abs().max(1.0), "{found} is not {due}");
    }
}

/// Ranges of radius and Z of all sections, mm.
fn size(imported: &Imported) -> [[f64; 2]; 2] {
    let all = || imported.rows[0].blades.iter().flat_map(|b| &b.sections).flat_map(|s| points(&s.form));
    [range(all().map(|p| p.x.hypot(p.y))), range(all().map(|p| p.z))]
}

#[test]
fn rotor_37_has_36_blades_in_centimetres() {
    let Some(rotor) = rotor37() else { return };
    let row = &rotor.rows[0];
    assert_eq!((rotor.rows.len(), row.count, row.blades.len()), (1, 36, 1));
    let sections = &row.blades[0].sections;
    assert_eq!(sections.iter().map(|s| points(&s.form).len()).collect::<Vec<_>>(), [300; 6]);
    assert_eq!(sections[0].span, Some(0.0));
    let due = numbers("nasa_rotor37", "profile.curve");
    close(size(&rotor)[0], range(due.iter().map(|p| 10.0 * p[0].hypot(p[1]))));
    close(size(&rotor)[1], range(due.iter().map(|p| 10.0 * p[2])));
    for (curve, file) in [(&rotor.hub, "hub.curve"), (&rotor.shroud, "shroud.curve")] {
        // Some points of the file repeat the one before.
        let mut due = numbers("nasa_rotor37", file);
        due.dedup();
        let curve = curve.as_ref().unwrap();
        assert_eq!(curve.len(), due.len());
        for (found, due) in curve.iter().zip(due) {
            close(*found, [10.0 * due[0].hypot(due[1]), 10.0 * due[2]]);
        }
    }
    // From -6.8 to +4.4 deg.
    assert!(super::noted(&rotor, "the angle of the hub about the axis varies"));
    assert!(super::noted(&rotor, "the sections repeat their first point"));
}

#[test]
fn hannover_has_23_blades_in_millimetres() {
    let Some(rotor) = hannover() else { return };
    let row = &rotor.rows[0];
    assert_eq!((row.count, row.blades.len()), (23, 1));
    let sections = &row.blades[0].sections;
    assert_eq!(sections.iter().map(|s| points(&s.form).len()).collect::<Vec<_>>(), [120; 7]);
    let due = numbers("hannover_tfd4ac_rotor1", "1_Rotor1_Blade.crv");
    close(size(&rotor)[0], range(due.iter().map(|p| p[0].hypot(p[1]))));
    assert_eq!((rotor.hub.unwrap().len(), rotor.shroud.unwrap().len()), (13, 13));
}

#[test]
fn hecc_has_15_blades_and_15_splitters_in_inches() {
    let Some(hecc) = hecc() else { return };
    let row = &hecc.rows[0];
    assert_eq!((row.count, row.blades.len()), (15, 2));
    for (blade, name) in row.blades.iter().zip(["main", "splitter"]) {
        assert!(blade.name.contains(name), "{}", blade.name);
        assert_eq!(blade.sections.len(), 11);
        for (k, section) in blade.sections.iter().enumerate() {
            let file = format!("impeller_{name}_blade_section_{:02}.txt", k + 1);
            let due = numbers("nasa_hecc/hot_design_intent", &file);
            let found = points(&section.form);
            assert_eq!(found.len(), due.len(), "{file}");
            for (p, due) in found.iter().zip(due) {
                close([p.x.hypot(p.y), p.z], [25.4 * due[2], 25.4 * due[0]]);
                let angle = p.y.atan2(p.x) - due[1] / due[2];
                assert!(angle.sin().abs() < 1e-12 && angle.cos() > 0.0, "{file}");
            }
        }
    }
    // Tip radius of 8.49 in.
    let due = range((1..=11).flat_map(|k| {
        numbers("nasa_hecc/hot_design_intent", &format!("impeller_main_blade_section_{k:02}.txt"))
            .into_iter()
            .map(|p| 25.4 * p[2])
            .collect::<Vec<_>>()
    }));
    close([size(&hecc)[0][1]; 2], [due[1]; 2]);
    assert!((due[1] - 215.8).abs() < 0.2, "{due:?}");
    assert_eq!((hecc.hub.unwrap().len(), hecc.shroud.unwrap().len()), (350, 310));
    // Section 7 of the main blade.
    assert!(hecc.notes.iter().any(|n| n.text.contains("the file has no header")));
}

/// Faces and edges of all sections of a set.
fn divided(imported: &Imported, blade: usize) -> Vec<DividedSection> {
    let row = &imported.rows[0];
    let all = outlines(row, imported.hub.as_deref(), &Options::default()).unwrap_or_else(|d| panic!("{d:?}"));
    let (blade, found) = (&row.blades[blade], all.into_iter().nth(blade).unwrap());
    // Nothing of the loop is lost, and neighbours share their ends.
    for (divided, section) in found.iter().zip(&blade.sections) {
        let Outline { faces, edges, .. } = &divided.outline;
        let mut all: Vec<_> = faces.iter().chain(edges).flatten().map(|p| [p.x, p.y, p.z]).collect();
        let given = points(&section.form);
        assert!(all.iter().all(|p| given.iter().any(|q| [q.x, q.y, q.z] == *p)));
        all.sort_by(|a, b| a.partial_cmp(b).unwrap());
        all.dedup();
        let cut: usize = divided.edges.iter().map(|e| usize::from(e.form == EdgeForm::CutOff)).sum();
        assert!(all.len() == given.len() || cut > 0, "{} of {}", all.len(), given.len());
        for (face, other) in [(0, 1), (1, 0)] {
            assert_eq!(
                (faces[face].first(), faces[face].last()),
                match face {
                    0 => (edges[0].first(), edges[1].first()),
                    _ => (edges[0].last(), edges[1].last()),
                }
            );
            assert_ne!(faces[face].first(), faces[other].first());
        }
    }
    found
}

/// Prints the figures of a blade. Edges are half ellipses within a share of their width, and blades get thinner to the tip.
fn shown(name: &str, found: &[DividedSection], residual: f64) {
    for (k, d) in found.iter().enumerate() {
        println!(
            "{name} {}: thickness {:.3} mm, mean line turns by {:.1} deg",
            k + 1,
            d.thickness,
            d.turn.to_degrees()
        );
        for e in &d.edges {
            println!(
                "    {:?} radius {:.3} width {:.3} depth {:.3} residual {:.4}",
                e.form, e.radius, e.width, e.depth, e.residual
            );
            assert!(e.form == EdgeForm::Round && e.residual < residual * e.width, "{name} {}: {e:?}", k + 1);
            assert!(e.width < 0.7 * d.thickness && e.radius > 0.0, "{name} {}: {e:?}", k + 1);
        }
        assert_eq!(d.pressure, found[0].pressure);
    }
    assert!(found.windows(2).all(|w| w[1].thickness < w[0].thickness), "{name}");
}

#[test]
fn sections_have_faces_and_edges() {
    if let Some(rotor) = rotor37() {
        shown("rotor 37", &divided(&rotor, 0), 0.03);
    }
    if let Some(rotor) = hannover() {
        shown("hannover", &divided(&rotor, 0), 0.15);
    }
    if let Some(hecc) = hecc() {
        // Its edges are blunt with round corners, no ellipses.
        let (main, splitter) = (divided(&hecc, 0), divided(&hecc, 1));
        shown("hecc main", &main, 0.2);
        shown("hecc splitter", &splitter, 0.2);
        assert_eq!(main[0].pressure, splitter[0].pressure);
        for (blade, divided) in hecc.rows[0].blades.iter().zip([&main, &splitter]) {
            assert!(doubtful(blade, divided).is_empty());
        }
    }
}
