//! Text form of the job, with every default.

use super::library::LINUXCNC;
use super::model::{
    AnglesAtSpan, AnglesSpec, BladeForm, BladeSpec, CamberSpec, CurveSpec, DistributionSpec, EdgePlace, FaceForm,
    FaceSpec, Job, Looks, MeridianPlace, OperationKind, RevolvedSpec, RotarySpec,
};
use super::property::Property;
use super::tool_model::PROPERTIES;
use base::units::{Mm, Rad, trim};
use blade::angles::EdgeShape;
use blade::{EdgeForm, LOOP_EDGES};
use five_axis::control::{LengthTo, Planning};
use std::fmt::Write;
use wheel::control::Sectors;
use wheel::method::FlankMethod;
use wheel::operation::{Allowances, distinct, word};
use wheel::part::{BladeId, FaceId};
use wheel::post_file::PostFile;

/// The fillet of a blade as a value of the language.
fn fillet(blade: &BladeSpec) -> String {
    blade.fillet.as_ref().map_or_else(|| "0 mm".to_owned(), ToString::to_string)
}

/// The job as text.
pub fn print(job: &Job) -> String {
    let mut out = String::new();
    machine(&mut out, job);
    let p = &job.part;
    let main = p.main();
    let _ = writeln!(out, "part {}\n  vanes {}\n  extend {}\n  fillet {}", p.name, p.vanes.0, p.extend, fillet(main));
    if let Some(from) = &p.imported {
        let _ = writeln!(out, "  imported {:?}, within {}", from.files, from.within);
    }
    blade_form(&mut out, &main.form);
    for blade in &p.blades[1..] {
        let _ = writeln!(out, "  splitter {}\n  angle {}\n  fillet {}", blade.name, blade.angle, fillet(blade));
        blade_form(&mut out, &blade.form);
    }
    for (name, generator) in [("hub", &p.hub), ("shroud", &p.shroud)] {
        match generator {
            RevolvedSpec::OfBlade(curve) => {
                let _ = writeln!(out, "  {name} revolve {}.{}", curve.face.name(), curve.end.name());
            }
            RevolvedSpec::Own(curve) => {
                let _ = writeln!(out, "  {name} revolve spline of {} points", curve.points.len());
                points(&mut out, &curve.points);
            }
        }
    }
    let s = &job.stock;
    let _ = writeln!(out, "stock turned\n  over shroud {}\n  bore {}\n  back {}", s.over_shroud, s.bore, s.back);
    let diameter = s.clamping.diameter.map_or_else(|| "any".to_owned(), |d| d.to_string());
    let _ = writeln!(out, "  clamping below {}, diameter {diameter}", s.clamping.below);
    if let Some(left) = &s.left {
        let (triangles, volume) = (left.mesh.triangles.len(), left.mesh.volume());
        let _ = writeln!(out, "  from {:?}: {triangles} triangles, {volume:.0} mm3", left.file);
    }
    if let Some(material) = s.material {
        let _ = writeln!(out, "  material {}", material.name());
    }
    tools(&mut out, job);
    operations(&mut out, job);
    let _ = writeln!(out, "tolerance chord {}, rough {}", job.chord, job.chord_rough);
    let _ = writeln!(out, "clearance {}", job.clearance);
    let operation = |o: &usize| job.operations.get(*o).map_or_else(String::new, |o| o.name.clone());
    for c in &job.contracts {
        let default = if c.default { ", the default" } else { "" };
        let _ = writeln!(out, "require {}{}{default}", c.kind.statement(c.bound), c.scope.text(operation));
    }
    for a in &job.allowed {
        let _ = writeln!(out, "allow {}{} {:?}", a.kind.name(), a.scope.text(operation), a.reason);
    }
    post(&mut out, &job.post);
    out
}

fn post(out: &mut String, post: &PostFile) {
    let numbers = match post.block_numbers {
        0 => "no block numbers".to_owned(),
        step => format!("block numbers in steps of {step}"),
    };
    let turn =
        post.control.orientation_tolerance.map_or("by the flutes of each tool".to_owned(), |t| Rad(t).to_string());
    let _ = writeln!(out, "post {}, dialect {}", post.name, post.dialect);
    let _ = writeln!(out, "  orientation {}, orientation tolerance {turn}", post.control.orientation.name());
    let _ =
        writeln!(out, "  {numbers}, program number {}, lines end with {}", post.program_number, post.line_end.name());
    if let Some(offset) = post.work_offset() {
        let _ = writeln!(out, "  work offset {offset}");
    }
    if post.control.sectors != Sectors::Inline {
        let _ = writeln!(out, "  sectors {}", post.control.sectors.name());
    }
    let d = post.control.decimals;
    let _ = writeln!(
        out,
        "  digits behind the point: lengths {}, angles {}, vectors {}, feeds {}",
        d.length, d.angle, d.vector, d.feed
    );
}

/// A limit of jerk with its unit.
fn jerk(limit: f64, unit: &str) -> String {
    if limit.is_finite() { format!("{} {unit}", trim(limit, 3)) } else { "unlimited jerk".to_owned() }
}

fn machine(out: &mut String, job: &Job) {
    let m = &job.machine;
    let _ = writeln!(out, "machine {}", m.name);
    for (name, axis) in ["X", "Y", "Z"].iter().zip(&m.linear) {
        let [lo, hi] = axis.travel;
        let (acceleration, jerk) = (trim(axis.acceleration, 3), jerk(axis.jerk, "mm/s3"));
        let _ = writeln!(out, "  {name} {lo} to {hi}, {}, {acceleration} mm/s2, {jerk}", axis.speed);
    }
    for axis in &m.rotary {
        let name = &axis.name;
        let travel = match (axis.modulo, axis.travel) {
            (Some(way), _) => format!("modulo 360 deg, way {}", way.name()),
            (None, [lo, hi]) => format!("{lo} to {hi}"),
        };
        let sense = if axis.iso { "iso" } else { "opposite" };
        let (speed, acceleration) = (trim(axis.speed.to_degrees(), 3), trim(axis.acceleration, 3));
        let (jerk, [x, y, z]) = (jerk(axis.jerk, "rad/s3"), axis.point);
        let _ =
            writeln!(out, "  {name} {travel}, {speed} deg/s, {acceleration} rad/s2, {jerk}, {sense}, at {x}, {y}, {z}");
    }
    for RotarySpec { name, clamp, .. } in &m.rotary {
        clamp.as_ref().map(|[on, off]| writeln!(out, "  {name} clamped by {on}, unclamped by {off}"));
    }
    let [x, y, z] = m.part_origin.0;
    let _ = writeln!(out, "  part origin {x}, {y}, {z}");
    if let Some(axes) = m.part_axes {
        let [of_x, of_z] = axes.map(|v| v.map(|x| trim(x, 6)).join(", "));
        let _ = writeln!(out, "  part direction {of_z}; x-direction {of_x}");
    }
    let _ = writeln!(out, "  retract z {}", m.retract);
    for (name, at) in ["x", "y", "z"].iter().zip(&m.home) {
        at.map(|at| writeln!(out, "  home {name} {at}"));
    }
    if m.length_to != LengthTo::Tip {
        let _ = writeln!(out, "  tool lengths to the {}", m.length_to.name());
    }
    let power = m.power.map_or_else(String::new, |power| format!(", {} kW", trim(power, 3)));
    let _ = writeln!(out, "  spindle {} to {}{power}\n  rapid {}", m.spindle[0], m.spindle[1], m.rapid);
    let _ = writeln!(out, "  cycle {} s", trim(m.cycle, 6));
    if m.planning == Planning::LinuxCnc {
        let _ = writeln!(out, "  planning {LINUXCNC}");
    }
    for assumed in &m.assumed {
        let _ = writeln!(out, "  assumed: {assumed}");
    }
}

fn points(out: &mut String, points: &[[f64; 3]]) {
    for [x, y, z] in points {
        let _ = writeln!(out, "    {} {} {} mm", trim(*x, 6), trim(*y, 6), trim(*z, 6));
    }
}

fn blade_form(out: &mut String, form: &BladeForm) {
    let sections = match form {
        BladeForm::Faces(given) => return faces(out, given),
        BladeForm::Sections(sections) => sections,
        BladeForm::Angles(given) => return angles(out, given),
    };
    let _ = writeln!(out, "  fit {}", sections.fit);
    for (name, form) in ["leading-edge", "trailing-edge"].iter().zip(sections.edges) {
        let _ = writeln!(out, "  {name} {}", form.map_or("as found", EdgeForm::name));
    }
    let _ = writeln!(out, "  pressure {}", sections.pressure.map_or("as found", Looks::name));
    for section in &sections.loops {
        let _ = writeln!(out, "  loop {}", section.name);
        for (word, [first, last]) in LOOP_EDGES.iter().zip(section.edges.into_iter().flatten()) {
            let _ = writeln!(out, "    {word} points {} to {}", first + 1, last + 1);
        }
        points(out, &section.points);
    }
}

/// Values by shares: percent and value.
fn values(given: &DistributionSpec, value: fn(f64) -> String) -> String {
    let one = |[share, given]: &[f64; 2]| format!("({} %, {})", trim(share * 100.0, 4), value(*given));
    match given.points.as_slice() {
        [[_, everywhere]] => value(*everywhere),
        points => points.iter().map(one).collect::<Vec<_>>().join(" "),
    }
}

fn angles(out: &mut String, given: &AnglesSpec) {
    let percent = |share: f64| format!("{} %", trim(share * 100.0, 4));
    let angle = |a| Rad(a).to_string();
    let mm = |l| Mm(l).to_string();
    let _ = writeln!(out, "  fit {}\n  pressure {}", given.fit, given.pressure.map_or("as found", Looks::name));
    for (name, edge) in ["leading-edge", "trailing-edge"].iter().zip(given.edges) {
        let _ = match edge {
            EdgeShape::CutOff => writeln!(out, "  {name} cut-off"),
            EdgeShape::Elliptic(ratio) => writeln!(out, "  {name} elliptic {ratio}"),
        };
    }
    match &given.camber {
        CamberSpec::OfMain { part } => {
            for (name, [hub, shroud]) in ["from", "to"].iter().zip(part) {
                let _ = writeln!(out, "  {name} of main: hub {}, shroud {}", percent(*hub), percent(*shroud));
            }
        }
        CamberSpec::Own { angles, lean, edges } => {
            for (name, place) in ["from", "to"].iter().zip(edges.iter()) {
                match place {
                    EdgePlace::Places(places, _) => {
                        let [hub, shroud] = places.map(|place| match place {
                            MeridianPlace::Share(share) => percent(share),
                            MeridianPlace::Length(length) => length.to_string(),
                        });
                        let _ = writeln!(out, "  {name} hub {hub}, shroud {shroud}");
                    }
                    EdgePlace::Curve(curve) => {
                        let _ = writeln!(out, "  {name} spline of {} points", curve.points.len());
                        points(out, &curve.points);
                    }
                }
            }
            if let Some(lean) = lean {
                let _ = writeln!(out, "  lean {}", values(lean, angle));
            }
            for row in angles {
                let _ = match &row.says {
                    AnglesAtSpan::Theta(theta) => {
                        writeln!(out, "  span {} theta {}", percent(row.at), values(theta, angle))
                    }
                    AnglesAtSpan::Beta { beta, theta, end } => {
                        let end = ["start", "end"][*end];
                        let beta = values(beta, angle);
                        writeln!(out, "  span {} beta to the meridian {beta}, {end} {}", percent(row.at), Rad(*theta))
                    }
                };
            }
        }
    }
    for row in &given.thickness {
        let _ = writeln!(out, "  span {} thickness {}", percent(row.at), values(&row.says, mm));
    }
}

fn faces(out: &mut String, faces: &[FaceSpec; 2]) {
    for (name, face) in FaceId::NAMES.iter().zip(faces) {
        let curve = |out: &mut String, end: &str, curve: &CurveSpec| {
            let _ = writeln!(out, "  {name} {end}");
            points(out, &curve.points);
        };
        curve(out, "tip", &face.tip);
        curve(out, "root", &face.root);
        if face.form != FaceForm::Ruled {
            let _ = writeln!(out, "  {name} {}", face.form.name());
        }
        for (k, section) in face.sections.iter().enumerate() {
            curve(out, &format!("section {}", k + 1), section);
        }
    }
}

fn tools(out: &mut String, job: &Job) {
    for t in &job.tools {
        let _ = writeln!(out, "tool {} = {}", t.name, t.kind.keyword());
        for Property { name, .. } in PROPERTIES {
            t.text(name, job.stock.material).map(|value| writeln!(out, "  {name} {value}"));
        }
        let Some((name, sections)) = &t.holder else { continue };
        let _ = writeln!(out, "  holder {name}");
        for [length, lower, upper] in sections {
            let _ = writeln!(out, "    {length} long, diameter {lower} to {upper}");
        }
    }
}

/// The blades of surfaces, for a job whose sectors have several.
fn blades(out: &mut String, job: &Job, of_surfaces: impl Iterator<Item = BladeId>) {
    if job.part.blades.len() > 1 {
        let names = of_surfaces.filter_map(|blade| job.part.blades.get(blade.index())).map(|blade| blade.name.as_str());
        let _ = writeln!(out, "  blades {}", distinct(names).join(", "));
    }
}

fn operations(out: &mut String, job: &Job) {
    for o in &job.operations {
        let tool = job.tools.get(o.tool).map_or("?", |t| t.name.as_str());
        let _ = writeln!(
            out,
            "operation {} {}\n  tool {tool}\n  speed {}\n  feed {}",
            o.kind.keyword(),
            o.name,
            o.speed,
            o.feed
        );
        let _ = writeln!(out, "  link-feed {}\n  lead-in {}\n  lead-out {}", o.link_feed, o.lead_in, o.lead_out);
        let _ = writeln!(out, "  rest {}", o.rest.map_or_else(|| "off".to_owned(), |t| format!("over {t}")));
        let sectors: Vec<String> = o.sectors.iter().map(|s| (s + 1).to_string()).collect();
        let _ = writeln!(out, "  sectors {}", sectors.join(", "));
        if let Some(depth) = o.kind.step_down() {
            let _ = writeln!(out, "  depth {depth}");
        }
        if let Some(Allowances { vane, hub }) = o.kind.roughing() {
            let _ = writeln!(out, "  allowance vane {vane}, hub {hub}");
        }
        match &o.kind {
            OperationKind::Groove { .. } => {}
            OperationKind::Expand { residual, .. } => {
                let _ = writeln!(out, "  residual {residual}");
            }
            OperationKind::Rough { stepover, levels: form, milling, slots, .. } => {
                let _ = writeln!(out, "  stepover {stepover}\n  levels {}\n  milling {}", form.name(), milling.name());
                let _ = writeln!(out, "  slots {}", slots.name());
                slots.engagement().map(|arc| writeln!(out, "  engagement {arc}"));
            }
            OperationKind::Plunge { stepover, .. } => {
                let _ = writeln!(out, "  stepover {stepover}");
            }
            OperationKind::Flank { faces, flank } => {
                blades(out, job, faces.iter().map(|face| face.blade));
                let faces = distinct(faces.iter().map(|face| face.name()));
                let (method, strips) = (flank.method.name(), flank.strips_text());
                let _ = writeln!(out, "  faces {}\n  method {method}\n  strips {strips}", faces.join(", "));
                if flank.method == FlankMethod::Minimax {
                    let _ = writeln!(out, "  side {}\n  conflict {}", flank.side.name(), flank.conflict.name());
                }
                let _ = writeln!(out, "  milling {}\n  order {}", flank.milling.name(), flank.order.name());
            }
            OperationKind::Channel { scallop, spacing, lines, method, allowance_vane } => {
                let _ = writeln!(out, "  scallop {scallop}\n  spacing {}", spacing.name());
                let _ = writeln!(out, "  lines {}\n  method {}", lines.name(), method.name());
                if let Some(vane) = allowance_vane {
                    let _ = writeln!(out, "  allowance vane {vane}");
                }
            }
            OperationKind::Point { surfaces, scallop, lines, milling, levels, method } => {
                blades(out, job, surfaces.iter().filter_map(|s| word(*s)).map(|w| w.2));
                let names = distinct(surfaces.iter().filter_map(|s| word(*s)).map(|w| w.1));
                let property = match o.kind.keyword() {
                    "edge" => Some("edges"),
                    "tip" => None,
                    _ => Some("faces"),
                };
                if let Some(property) = property {
                    let _ = writeln!(out, "  {property} {}", names.join(", "));
                }
                let _ = writeln!(out, "  scallop {scallop}");
                let _ = writeln!(out, "  lines {}\n  method {}", lines.name(), method.name());
                if let Some(milling) = milling {
                    let _ = writeln!(out, "  milling {}", milling.name());
                }
                if let Some(height) = levels {
                    let _ = writeln!(out, "  order levels\n  depth {height}");
                }
            }
        }
    }
}
