//! The text of a part whose blades are stated by angles and thicknesses.

use super::angles::{StatedAngle, StatedAngles};
use super::job_frame::JobFrame;
use super::part_source::{PartSource, blade_name};
use super::part_text::{PartFiles, curve, facing, fillet_line, head, meridian, meridians, sections, word, write_cuts};
use base::units::trim;
use blade::angles::EdgeShape;
use nalgebra::Point3;
use std::fmt::Write as _;

/// Digits behind the point of shares in percent and of angles in degrees: on a radius of 1 m less than a nanometre.
const SHARE_DIGITS: usize = 9;

/// Values in a line of a list.
const IN_A_LINE: usize = 6;

/// Writes the files of a part, where all blades have angles.
pub(super) fn write(source: &PartSource<'_>) -> Option<PartFiles> {
    let stated: Vec<&StatedAngles> =
        source.row.blades.iter().map(|blade| blade.angles.as_ref()).collect::<Option<_>>()?;
    let ends = source.ends.as_ref()?;
    let lines = ends.each_ref().map(|end| end.points.as_slice());
    let frame = JobFrame::of(source.zero, source.imported, source.divided, Some(lines));
    let mut curves = meridians(lines, frame);
    curves.push_str("# Meridional edges of the blades, from hub to shroud.\n");
    for (k, blade) in stated.iter().enumerate() {
        for (edge, points) in EDGES.iter().zip(&blade.edges) {
            let points: Vec<Point3<f64>> = points.iter().map(|[r, z]| Point3::new(*r, 0.0, *z)).collect();
            curve(&mut curves, &format!("{}_{edge}", blade_name(k)), &points, frame);
        }
    }
    let mut job = head(source, frame);
    write_cuts(&mut job, source, ends);
    job.push_str("edition 2026\n\n");
    _ = writeln!(job, "part {} {{\n  vanes {}", word(source.name, "imported"), source.row.count);
    job.push_str(&source.imported_from());
    for (k, (blade, divided)) in stated.iter().zip(source.divided).enumerate() {
        self::blade(&mut job, source, k, blade, facing(divided, frame), frame);
    }
    for name in ["hub", "shroud"] {
        _ = writeln!(job, "  {name} revolve spline from \"{}.curves.csv\" curve {name} mm", source.name);
    }
    job.push_str("}\n");
    let (sections, meridian) = (sections(source, frame), meridian(source.imported, frame));
    Some(PartFiles { job, curves, loops: Vec::new(), sections, meridian })
}

const EDGES: [&str; 2] = ["leading", "trailing"];

/// The entries of a blade.
fn blade(text: &mut String, source: &PartSource<'_>, k: usize, stated: &StatedAngles, facing: &str, frame: JobFrame) {
    let name = blade_name(k);
    _ = writeln!(text, "  {} {name} {{", if k == 0 { "vane" } else { "splitter" });
    // A wheel that is turned over has angles of the other sense.
    let sign: f64 = if frame.over { -1.0 } else { 1.0 };
    if k > 0 {
        let turn = if frame.over { 1.0 - stated.turn } else { stated.turn };
        _ = writeln!(text, "    angle {}", percent(turn));
    }
    if stated.camber.iter().any(|row| matches!(row.says, StatedAngle::Beta(..))) {
        text.push_str("    beta-from meridian\n");
    }
    let thickness = |values: &[[f64; 2]]| list("thickness", values, 1.0, "mm");
    if let [row] = stated.thickness.as_slice() {
        _ = writeln!(text, "    {}", thickness(&row.says));
    }
    let mut spans: Vec<f64> = stated.camber.iter().map(|row| row.at).collect();
    if stated.thickness.len() > 1 {
        spans.extend(stated.thickness.iter().map(|row| row.at));
    }
    spans.sort_by(f64::total_cmp);
    spans.dedup();
    for span in spans {
        _ = writeln!(text, "    span {} {{", percent(span));
        if let Some(row) = stated.camber.iter().find(|row| row.at == span) {
            match &row.says {
                StatedAngle::Theta(theta) => {
                    _ = writeln!(text, "      {}", list("theta", theta, sign.to_degrees(), "deg"))
                }
                StatedAngle::Beta(beta, start) => {
                    let start = trim(sign * start.to_degrees(), SHARE_DIGITS);
                    _ = writeln!(
                        text,
                        "      {}\n      start {start} deg",
                        list("beta", beta, sign.to_degrees(), "deg")
                    );
                }
            }
        }
        if let Some(row) = stated.thickness.iter().find(|row| row.at == span && stated.thickness.len() > 1) {
            _ = writeln!(text, "      {}", thickness(&row.says));
        }
        text.push_str("    }\n");
    }
    for (word, edge) in ["from", "to  "].iter().zip(EDGES) {
        _ = writeln!(text, "    {word} spline from \"{}.curves.csv\" curve {name}_{edge} mm", source.name);
    }
    for (edge, shape) in EDGES.iter().zip(stated.shapes) {
        let form = match shape {
            EdgeShape::CutOff => "cut-off".to_owned(),
            EdgeShape::Elliptic(ratio) => format!("elliptic {}", trim(ratio, SHARE_DIGITS)),
        };
        _ = writeln!(text, "    {edge}-edge {form}");
    }
    _ = writeln!(text, "    pressure {facing}");
    text.push_str(&fillet_line(source, k));
    text.push_str("  }\n");
}

fn percent(share: f64) -> String {
    format!("{} %", trim(share * 100.0, SHARE_DIGITS))
}

/// A list of shares and values.
fn list(name: &str, values: &[[f64; 2]], scale: f64, unit: &str) -> String {
    let pair =
        |[share, value]: &[f64; 2]| format!("({}, {} {unit})", percent(*share), trim(value * scale, SHARE_DIGITS));
    let lines: Vec<String> =
        values.chunks(IN_A_LINE).map(|chunk| chunk.iter().map(pair).collect::<Vec<_>>().join(" ")).collect();
    format!("{name} [{}]", lines.join("\n        "))
}
