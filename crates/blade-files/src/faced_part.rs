//! The text of a part whose faces are given as surfaces: ruled or lofted faces, or closed sections of them, with hub and shroud of
//! their own.

use super::job_frame::JobFrame;
use super::part_source::{PartSource, blade_name};
use super::part_text::{
    self, COORDINATE_DIGITS, FACES, PartFiles, curves, facing, fillet_line, head, loops, meridian, meridians, sections,
    word,
};
use super::short_ends::WITHOUT_A_WORD;
use super::{BladeSurfaces, angle_part};
use base::units::trim;
use blade::outline::DividedSection;
use std::fmt::Write as _;

/// Writes the files of a part: with the angles or the faces that were imported, or as its sections demand.
pub fn write(source: &PartSource<'_>) -> PartFiles {
    angle_part::write(source)
        .or_else(|| Some(FacedPart::of(source)?.files(source)))
        .unwrap_or_else(|| part_text::write(source))
}

/// A part of faces.
struct FacedPart<'a> {
    /// Hub and shroud from inlet to outlet, (r, z), mm.
    ends: [&'a [[f64; 2]]; 2],
    extend: f64,
    /// Largest distance of points from the curve of their closed section, mm; `None` for faces of curves.
    fit: Option<f64>,
}

impl<'a> FacedPart<'a> {
    /// The part, where faces were imported as surfaces.
    fn of(source: &PartSource<'a>) -> Option<Self> {
        let imported = source.imported;
        let (extend, fit) = match imported.surfaces {
            BladeSurfaces::BySections => return None,
            BladeSurfaces::Ruled { extend } | BladeSurfaces::Lofted { extend } => (extend, None),
            BladeSurfaces::Loops { extend, fit } => (extend, Some(fit)),
        };
        Some(Self { ends: [imported.hub.as_deref()?, imported.shroud.as_deref()?], extend, fit })
    }

    /// Files of the part.
    fn files(&self, source: &PartSource<'_>) -> PartFiles {
        let frame = JobFrame::of(source.zero, source.imported, source.divided, Some(self.ends));
        let meridians = meridians(self.ends, frame);
        let (loops, curves) = match self.fit {
            Some(_) => (loops(source, frame), meridians),
            // Each table has a heading of its own.
            None => (Vec::new(), curves(source, frame, true) + &meridians),
        };
        PartFiles {
            job: self.job(source, frame),
            curves,
            loops,
            sections: sections(source, frame),
            meridian: meridian(source.imported, frame),
        }
    }

    fn job(&self, source: &PartSource<'_>, frame: JobFrame) -> String {
        let fillets = source.row.blades.iter().all(|blade| blade.fillet.is_some());
        let mut text = head(source, frame);
        text.push_str(match (self.fit, fillets) {
            (None, false) => {
                "// Hub and shroud end with the blades. Add fillets, stock, tools, operations and contracts.\n"
            }
            (None, true) => "// Hub and shroud end with the blades. Add stock, tools, operations and contracts.\n",
            (Some(_), false) => "// Add fillets, stock, tools, operations and contracts.\n",
            (Some(_), true) => "// Add stock, tools, operations and contracts.\n",
        });
        text.push_str("edition 2026\n\n");
        _ = writeln!(text, "part {} {{\n  vanes {}", word(source.name, "imported"), source.row.count);
        text.push_str(&source.imported_from());
        if self.extend > WITHOUT_A_WORD {
            // Rounded up, so that the faces reach.
            _ = writeln!(text, "  extend {} mm", trim(self.extend + 0.01, 2));
        }
        let file = format!("{}.curves.csv", source.name);
        for (k, divided) in source.divided.iter().enumerate() {
            let blade = blade_name(k);
            _ = writeln!(text, "  {} {blade} {{", if k == 0 { "vane" } else { "splitter" });
            match self.fit {
                Some(fit) => closed_sections(&mut text, source, k, divided, fit, frame),
                None => faces(&mut text, divided, &blade, &file),
            }
            text.push_str(&fillet_line(source, k));
            text.push_str("  }\n");
        }
        for name in ["hub", "shroud"] {
            _ = writeln!(text, "  {name} revolve spline from \"{file}\" curve {name} mm");
        }
        text.push_str("}\n");
        text
    }
}

/// Both faces of a blade by their curves: ruled ones by two, lofted ones by more.
fn faces(text: &mut String, divided: &[DividedSection], blade: &str, file: &str) {
    let lofted = divided.len() > 2;
    for face in FACES {
        let spline = |name: &str| format!("spline from \"{file}\" curve {blade}_{name}_{face} mm");
        _ = writeln!(text, "    {face} {} {{", if lofted { "lofted" } else { "ruled" });
        _ = writeln!(text, "      tip {}", spline("tip"));
        if lofted {
            let between: Vec<String> = (1..divided.len() - 1).map(|k| spline(&k.to_string())).collect();
            _ = writeln!(text, "      sections {}", between.join(",\n        "));
        }
        _ = writeln!(text, "      root {}\n    }}", spline("root"));
    }
}

/// A blade by its closed sections.
fn closed_sections(
    text: &mut String,
    source: &PartSource<'_>,
    k: usize,
    divided: &[DividedSection],
    fit: f64,
    frame: JobFrame,
) {
    _ = writeln!(text, "    sections loops from \"{}.{}.csv\" mm", source.name, blade_name(k));
    _ = writeln!(text, "    fit {} mm", trim(fit, COORDINATE_DIGITS));
    let stated = source.row.blades.get(k).map_or([None; 2], |blade| blade.edges);
    for (edge, form) in ["leading", "trailing"].iter().zip(stated) {
        form.map(|form| writeln!(text, "    {edge}-edge {}", form.name()));
    }
    _ = writeln!(text, "    pressure {}", facing(divided, frame));
}
