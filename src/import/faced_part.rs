//! The text of a part whose faces are given as surfaces: ruled or lofted faces with hub and shroud of their own.

use super::job_frame::JobFrame;
use super::part_text::{
    self, FACES, PartFiles, PartSource, blade_name, curves, head, meridian, meridians, sections, word,
};
use super::{BladeSurfaces, angle_part};
use crate::units::trim;
use std::fmt::Write as _;

/// Extension of faces to hub and shroud that the language allows without a word, mm.
const WITHOUT_A_WORD: f64 = 0.1;

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
    lofted: bool,
    extend: f64,
}

impl<'a> FacedPart<'a> {
    /// The part, where faces were imported as surfaces.
    fn of(source: &PartSource<'a>) -> Option<Self> {
        let imported = source.imported;
        let (lofted, extend) = match imported.surfaces {
            BladeSurfaces::BySections => return None,
            BladeSurfaces::Ruled { extend } => (false, extend),
            BladeSurfaces::Lofted { extend } => (true, extend),
        };
        Some(Self { ends: [imported.hub.as_deref()?, imported.shroud.as_deref()?], lofted, extend })
    }

    /// Files of the part.
    fn files(&self, source: &PartSource<'_>) -> PartFiles {
        let frame = JobFrame::of(source.zero, (source.imported, source.divided), Some(self.ends));
        // Each table has a heading of its own.
        let curves = curves(source, frame, self.lofted) + &meridians(self.ends, frame);
        PartFiles {
            job: self.job(source, frame),
            curves,
            loops: Vec::new(),
            sections: sections(source, frame),
            meridian: meridian(source.imported, frame),
        }
    }

    fn job(&self, source: &PartSource<'_>, frame: JobFrame) -> String {
        let mut text = head(source, frame);
        text.push_str("// Hub and shroud end with the blades. Add fillets, stock, tools, operations and contracts.\n");
        text.push_str("edition 2026\n\n");
        _ = writeln!(text, "part {} {{\n  vanes {}", word(source.name, "imported"), source.row.count);
        if self.extend > WITHOUT_A_WORD {
            // Rounded up, so that the faces reach.
            _ = writeln!(text, "  extend {} mm", trim(self.extend + 0.01, 2));
        }
        let file = format!("{}.curves.csv", source.name);
        for (k, divided) in source.divided.iter().enumerate() {
            let blade = blade_name(k);
            _ = writeln!(text, "  {} {blade} {{", if k == 0 { "vane" } else { "splitter" });
            for face in FACES {
                let spline = |name: &str| format!("spline from \"{file}\" curve {blade}_{name}_{face} mm");
                _ = writeln!(text, "    {face} {} {{", if self.lofted { "lofted" } else { "ruled" });
                _ = writeln!(text, "      tip {}", spline("tip"));
                if self.lofted {
                    let between: Vec<String> =
                        (1..divided.len().saturating_sub(1)).map(|k| spline(&k.to_string())).collect();
                    _ = writeln!(text, "      sections {}", between.join(",\n        "));
                }
                _ = writeln!(text, "      root {}\n    }}", spline("root"));
            }
            text.push_str("  }\n");
        }
        for name in ["hub", "shroud"] {
            _ = writeln!(text, "  {name} revolve spline from \"{file}\" curve {name} mm");
        }
        text.push_str("}\n");
        text
    }
}
