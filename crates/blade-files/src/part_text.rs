//! A part in the language, from what was imported: its text, its curves, and tables of sections, hub and shroud.

use super::job_frame::JobFrame;
use super::part_source::{PartSource, blade_name};
use super::wheel_ends::CutMeridian;
use super::{Imported, ImportedBlade, left_out, short_ends};
use base::units::trim;
use blade::foot::{FilletedFoot, filleted_foot};
use blade::outline::{DividedSection, Side};
use blade::{EdgeForm, LOOP_EDGES, Outline, SectionForm};
use nalgebra::Point3;
use std::fmt::Write as _;

/// Files of a part, with their contents.
#[derive(Clone, Debug, PartialEq)]
pub struct PartFiles {
    /// The job with the part alone.
    pub job: String,
    /// Curves of its faces, or its hub and shroud where the blades have closed sections, `curve,number,x,y,z` in mm.
    pub curves: String,
    /// Closed sections of each blade, `curve,number,x,y,z` in mm, with the name of the blade; none for ruled faces.
    pub loops: Vec<(String, String)>,
    /// All sections, `blade,section,span,face,x,y,z` in mm, in the frame of the job.
    pub sections: String,
    /// Hub and shroud, `curve,r,z` in mm, in the frame of the job.
    pub meridian: Option<String>,
}

/// Digits behind the point of written coordinates, mm: a tenth of a nanometre, so that reading them changes nothing.
pub(super) const COORDINATE_DIGITS: usize = 7;

fn coordinates(p: &Point3<f64>, frame: JobFrame) -> String {
    let p = frame.point(p);
    // A sum with zero has no sign of its own.
    [p.x, p.y, p.z].map(|x| trim(x + 0.0, COORDINATE_DIGITS)).join(",")
}

/// A word of the language: letters, digits and underscores, beginning with a letter.
pub(super) fn word(text: &str, otherwise: &str) -> String {
    let letters = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '_' };
    let word: String = text.chars().map(letters).collect();
    let word = word.trim_matches('_').to_owned();
    if word.starts_with(|c: char| c.is_ascii_alphabetic()) { word } else { otherwise.to_owned() }
}

pub(super) const FACES: [&str; 2] = ["pressure", "suction"];

/// The ends of the rulings with their sections: the last section is the tip.
fn ends(divided: &[DividedSection]) -> Option<[(&'static str, &Outline); 2]> {
    Some([("tip", &divided.last()?.outline), ("root", &divided.first()?.outline)])
}

/// Writes the files of a part. Where all sections are closed and hub and shroud are known, the blades have these sections;
/// otherwise their faces are ruled from the first to the last section.
pub fn write(source: &PartSource<'_>) -> PartFiles {
    let ends = source.ends.as_ref();
    let lines = ends.map(|ends| ends.each_ref().map(|end| end.points.as_slice()));
    let frame = JobFrame::of(source.zero, source.imported, source.divided, lines);
    let (loops, curves) = match lines {
        Some(lines) => (loops(source, frame), meridians(lines, frame) + &tips(source, frame)),
        None => (Vec::new(), curves(source, frame, false)),
    };
    let job = job(source, frame, ends);
    PartFiles { job, curves, loops, sections: sections(source, frame), meridian: meridian(source.imported, frame) }
}

/// Comments at the head of a job: what was found.
pub(super) fn head(source: &PartSource<'_>, frame: JobFrame) -> String {
    let mut text = String::new();
    for line in summary(source) {
        _ = writeln!(text, "// {line}");
    }
    for line in frame.sentences() {
        _ = writeln!(text, "// {line}");
    }
    text
}

fn job(source: &PartSource<'_>, frame: JobFrame, ends: Option<&[CutMeridian; 2]>) -> String {
    let mut text = head(source, frame);
    if let Some(ends) = ends {
        write_cuts(&mut text, source, ends);
    } else {
        text.push_str(
            "// The faces are ruled from the first to the last section. Add stock, tools, operations and contracts.\n",
        );
    }
    text.push_str("edition 2026\n\n");
    _ = writeln!(text, "part {} {{", word(source.name, "imported"));
    _ = writeln!(text, "  vanes {}", source.row.count);
    text.push_str(&source.imported_from());
    let short = short_ends::largest(source);
    if ends.is_some() && short > short_ends::WITHOUT_A_WORD {
        _ = writeln!(text, "  extend {} mm", short_ends::extension(short));
    }
    let file = format!("{}.curves.csv", source.name);
    for (k, divided) in source.divided.iter().enumerate() {
        let name = blade_name(k);
        _ = writeln!(text, "  {} {name} {{", if k == 0 { "vane" } else { "splitter" });
        if ends.is_some() {
            _ = writeln!(text, "    sections loops from \"{}.{name}.csv\" mm", source.name);
            let stated = source.row.blades.get(k).map_or([None; 2], |blade| blade.edges);
            for (edge, form) in ["leading", "trailing"].iter().zip(stated) {
                form.map(|form| writeln!(text, "    {edge}-edge {}", form.name()));
            }
            _ = writeln!(text, "    pressure {}", facing(divided, frame));
        } else {
            ruled_faces(&mut text, divided, &name, &file);
        }
        text.push_str(&fillet_line(source, k));
        text.push_str("  }\n");
    }
    text.push_str(&match ends {
        Some(_) => ["hub   ", "shroud"]
            .map(|name| format!("  {name} revolve spline from \"{file}\" curve {} mm\n", name.trim_end()))
            .concat(),
        None => "  hub    revolve main.pressure.root\n  shroud revolve main.pressure.tip\n".to_owned(),
    });
    text.push_str("}\n");
    text
}

/// Comments that tell where hub and shroud are cut.
pub(super) fn write_cuts(text: &mut String, source: &PartSource<'_>, [hub, shroud]: &[CutMeridian; 2]) {
    for (name, CutMeridian { beyond: [ahead, behind], .. }) in [("hub", hub), ("shroud", shroud)] {
        let (ahead, behind) = (trim(*ahead, 3), trim(*behind, 3));
        _ = writeln!(
            text,
            "// The {name} is cut {ahead} mm ahead of the leading edges and {behind} mm behind the trailing edges: change it to the ends of the wheel."
        );
    }
    let fillets = if source.row.blades.iter().all(|blade| blade.fillet.is_some()) { "" } else { "fillets, " };
    _ = writeln!(text, "// Add {fillets}stock, tools, operations and contracts.");
}

/// The line of the fillet of a blade, where it is known.
pub(super) fn fillet_line(source: &PartSource<'_>, blade: usize) -> String {
    let fillet = source.row.blades.get(blade).and_then(|blade| blade.fillet);
    fillet.map_or_else(String::new, |fillet| format!("    fillet {} mm\n", trim(fillet, 3)))
}

/// Where the pressure face looks in the frame of the job, seen from +Z.
pub(super) fn facing(divided: &[DividedSection], frame: JobFrame) -> &'static str {
    let greater = divided.first().is_some_and(|d| d.pressure == Side::Greater);
    if greater == frame.over { "clockwise" } else { "counter-clockwise" }
}

fn ruled_faces(text: &mut String, divided: &[DividedSection], blade: &str, file: &str) {
    for face in FACES {
        _ = writeln!(text, "    {face} ruled {{");
        for (end, _) in ends(divided).into_iter().flatten() {
            _ = writeln!(text, "      {end} spline from \"{file}\" curve {blade}_{end}_{face} mm");
        }
        text.push_str("    }\n");
    }
}

/// True for an index from a first to a last one, which may lie over the end of the list.
fn is_between(k: usize, [first, last]: [usize; 2]) -> bool {
    if first <= last { (first..=last).contains(&k) } else { k >= first || k <= last }
}

/// Closed sections of each blade.
pub(super) fn loops(source: &PartSource<'_>, frame: JobFrame) -> Vec<(String, String)> {
    let of = |(k, blade): (usize, &ImportedBlade)| {
        let mut text = format!(
            "# Sections of {} of {} in mm, from hub to shroud. Z is the axis of rotation.\n# curve,number,x,y,z\n",
            blade_name(k),
            source.name
        );
        for (section, given) in blade.sections.iter().enumerate() {
            let (points, edges) = match &given.form {
                SectionForm::Loop(points) => (points, None),
                SectionForm::DividedLoop { points, edges } => (points, Some(edges)),
                _ => continue,
            };
            for (number, p) in points.iter().enumerate() {
                let edge = edges.and_then(|edges| (0..2).find(|edge| is_between(number, edges[*edge])));
                let edge = edge.map_or_else(String::new, |edge| format!(",{}", LOOP_EDGES[edge]));
                _ = writeln!(text, "section_{:02},{},{}{edge}", section + 1, number + 1, coordinates(p, frame));
            }
        }
        (blade_name(k), text)
    };
    source.row.blades.iter().enumerate().map(of).collect()
}

/// Hub and shroud of the wheel as curves.
pub(super) fn meridians(ends: [&[[f64; 2]]; 2], frame: JobFrame) -> String {
    let mut text =
        String::from("# Hub and shroud of the wheel in mm from inlet to outlet: meridians.\n# curve,number,x,y,z\n");
    for (name, line) in ["hub", "shroud"].iter().zip(ends) {
        for (number, [r, z]) in line.iter().enumerate() {
            _ = writeln!(text, "{name},{},{}", number + 1, coordinates(&Point3::new(*r, 0.0, *z), frame));
        }
    }
    text
}

/// The curve through the tips that may take the place of the shroud.
fn tips(source: &PartSource<'_>, frame: JobFrame) -> String {
    let Some(tips) = short_ends::casing(source) else { return String::new() };
    let mut text = "# For a shroud that is the casing: the meridian through the tips of the blades.\n".to_owned();
    let points: Vec<Point3<f64>> = tips.points.iter().map(|[r, z]| Point3::new(*r, 0.0, *z)).collect();
    curve(&mut text, short_ends::TIPS, &points, frame);
    text
}

/// Points of a curve.
pub(super) fn curve(text: &mut String, name: &str, points: &[Point3<f64>], frame: JobFrame) {
    for (number, p) in points.iter().enumerate() {
        _ = writeln!(text, "{name},{},{}", number + 1, coordinates(p, frame));
    }
}

/// Curves of the faces: tip and root, and the sections between them where faces are lofted.
pub(super) fn curves(source: &PartSource<'_>, frame: JobFrame, lofted: bool) -> String {
    let mut text =
        format!("# Faces of {} in mm. Z is the axis of rotation; points run from inlet to outlet.\n", source.name);
    text.push_str("# curve,number,x,y,z\n");
    for (k, divided) in source.divided.iter().enumerate() {
        for (face, name) in FACES.iter().enumerate() {
            for (end, outline) in ends(divided).into_iter().flatten() {
                curve(&mut text, &format!("{}_{end}_{name}", blade_name(k)), &outline.faces[face], frame);
            }
            let between = divided.get(1..divided.len().saturating_sub(1)).filter(|_| lofted).unwrap_or_default();
            for (section, divided) in between.iter().enumerate() {
                let named = format!("{}_{}_{name}", blade_name(k), section + 1);
                curve(&mut text, &named, &divided.outline.faces[face], frame);
            }
        }
    }
    text
}

pub(super) fn sections(source: &PartSource<'_>, frame: JobFrame) -> String {
    let thick = |form: &SectionForm| matches!(form, SectionForm::MeanLine { .. });
    let with_thickness = source.row.blades.iter().flat_map(|b| &b.sections).any(|s| thick(&s.form));
    let mut text = String::from("# Sections in mm, as they were read. Z is the axis of rotation.\n");
    text.push_str("blade,section,span,face,x,y,z");
    text.push_str(if with_thickness { ",thickness\n" } else { "\n" });
    for (b, blade) in source.row.blades.iter().enumerate() {
        for (k, section) in blade.sections.iter().enumerate() {
            let span = section.span.map_or_else(String::new, |s| trim(s, COORDINATE_DIGITS));
            let head = format!("{},{},{span}", blade_name(b), k + 1);
            let mut line = |face: &str, p: &Point3<f64>, thickness: Option<f64>| {
                let thickness = thickness.map_or_else(String::new, |t| format!(",{}", trim(t, COORDINATE_DIGITS)));
                _ = writeln!(text, "{head},{face},{}{thickness}", coordinates(p, frame));
            };
            match &section.form {
                SectionForm::Loop(points) | SectionForm::DividedLoop { points, .. } => {
                    points.iter().for_each(|p| line("", p, None))
                }
                SectionForm::Faces(faces) => {
                    for (name, face) in FACES.iter().zip(faces) {
                        face.iter().for_each(|p| line(name, p, None));
                    }
                }
                SectionForm::MeanLine { points, .. } => {
                    points.iter().for_each(|p| line("", &p.position, Some(p.thickness)));
                }
            }
        }
    }
    text
}

pub(super) fn meridian(imported: &Imported, frame: JobFrame) -> Option<String> {
    let curves = [("hub", &imported.hub), ("shroud", &imported.shroud)];
    let mut text = String::from("# Hub and shroud in mm from inlet to outlet. Z is the axis of rotation.\ncurve,r,z\n");
    let mut any = false;
    for (name, curve) in curves {
        for [r, z] in curve.iter().flatten() {
            any = true;
            _ = writeln!(
                text,
                "{name},{},{}",
                trim(*r, COORDINATE_DIGITS),
                trim(frame.height(*z) + 0.0, COORDINATE_DIGITS)
            );
        }
    }
    any.then_some(text)
}

/// What was found, line by line: for people, and as comments of the job.
pub fn summary(source: &PartSource<'_>) -> Vec<String> {
    let PartSource { imported, row, divided, .. } = source;
    let mut lines = vec![format!("Blades read from {} (format {}).", source.files(), imported.format)];
    lines.push(format!("{} main blades; splitters of each: {}.", row.count, row.blades.len().saturating_sub(1)));
    for (k, (blade, divided)) in row.blades.iter().zip(*divided).enumerate() {
        let named = if blade.name.is_empty() || blade.name == blade_name(k) {
            String::new()
        } else {
            format!(" (`{}`)", diagnostics::printable(&blade.name))
        };
        lines.push(format!("{}{named}: {} sections.", blade_name(k), blade.sections.len()));
        lines.extend(of_blade(divided));
        lines.extend(filleted_foot(divided).map(|foot| in_sections(&foot)));
        if source.ends.is_some() {
            lines.extend(short_ends::sentences(source, k));
        }
        lines.extend(
            source.left.iter().filter(|l| l.blade == k).map(|l| left_out::sentences(l, &blade_name(k), divided.len())),
        );
    }
    lines.extend(imported.notes.iter().filter(|n| n.span.is_none()).map(|n| format!("Note: {}.", n.text)));
    lines
}

/// Largest distance from the axis, mm.
fn radius<'a>(points: impl Iterator<Item = &'a Point3<f64>>) -> f64 {
    points.map(|p| libm::hypot(p.x, p.y)).fold(0.0, f64::max)
}

/// Message about sections that seem to hold the fillet.
fn in_sections(foot: &FilletedFoot) -> String {
    let [lowest, above] = foot.thickness.map(|mm| trim(mm, 3));
    format!(
        "  The sections seem to hold the fillet: {lowest} mm thick at section 1, {above} mm at section {}, {} mm higher. State no \
         `fillet` beside them, or leave the {} lowest out and state it.",
        foot.above + 1,
        trim(foot.height, 3),
        foot.above
    )
}

/// Figures of a blade.
fn of_blade(divided: &[DividedSection]) -> Vec<String> {
    let range = |value: &dyn Fn(&DividedSection) -> f64| {
        let [low, high] =
            divided.iter().map(value).fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| [l.min(v), h.max(v)]);
        if low == high { trim(low, 4) } else { format!("{} to {}", trim(low, 4), trim(high, 4)) }
    };
    let points: usize =
        divided.iter().map(|d| d.outline.faces.iter().chain(&d.outline.edges).map(Vec::len).sum::<usize>()).sum();
    let tip = divided.last().map_or(0.0, |d| radius(d.outline.faces.iter().chain(&d.outline.edges).flatten()));
    let side = match divided.first().map(|d| d.pressure) {
        Some(Side::Greater) => "greater",
        _ => "smaller",
    };
    let mut lines = vec![
        format!(
            "  {points} points on faces and edges; tip radius {} mm; thickness {} mm.",
            trim(tip, 4),
            range(&|d| d.thickness)
        ),
        format!(
            "  The pressure face lies at the {side} angle about the axis of the file; the mean lines turn by {} deg.",
            range(&|d| d.turn.to_degrees())
        ),
    ];
    for (k, name) in ["Leading", "Trailing"].into_iter().enumerate() {
        let count = |form: EdgeForm| divided.iter().filter(|d| d.edges[k].form == form).count();
        let forms = [(EdgeForm::Round, "round"), (EdgeForm::CutOff, "cut off"), (EdgeForm::Sharp, "sharp")];
        let forms: Vec<String> = forms
            .into_iter()
            .map(|(form, word)| (count(form), word))
            .filter(|(n, _)| *n > 0)
            .map(|(n, word)| format!("{n} {word}"))
            .collect();
        lines.push(format!(
            "  {name} edge: {}; radius {} mm, width {} mm, depth {} mm, off half an ellipse by {} mm.",
            forms.join(", "),
            range(&|d| d.edges[k].radius),
            range(&|d| d.edges[k].width),
            range(&|d| d.edges[k].depth),
            range(&|d| d.edges[k].residual)
        ));
    }
    lines
}
