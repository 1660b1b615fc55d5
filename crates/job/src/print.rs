//! Text form of the job: a job with every default, which means the same. What only the library holds, and defaults that no
//! property states, are comments.
//!
//! Numbers have all their digits, so that the printed job is the same to the last bit. An angle is in degrees where that loses
//! nothing, else in radians.

use crate::library::schema::LINUXCNC;
use crate::model::tool::{PROPERTIES, PropertyText, ToolSpec};
use crate::model::{
    AnglesAtSpan, AnglesSpec, BladeForm, BladeSpec, CamberSpec, CurveSpec, DistributionSpec, EdgePlace, FaceForm,
    FaceSpec, Facing, Job, MeridianPlace, OperationKind, OperationSpec, RevolvedSpec, RotarySpec, SectionsSpec,
    StockSpec,
};
use crate::property::Property;
use crate::property::quantity::{angle, mm, short};
use crate::resolve::EDITION;
use crate::vocabulary::operations::{
    ALLOWANCE, BLADES, CONFLICT, DEPTH, EDGES, ENGAGEMENT, FACES, FEED, FLANK_METHOD, FLOOR_SCALLOP, LEAD_IN, LEAD_OUT,
    LEVEL_DEPTH, LEVELS, LINES, LINK_FEED, METHOD, MILLING, ORDER, RESIDUAL, REST, SCALLOP, SECTORS, SIDE, SLOTS,
    SPACING, SPEED, STEPOVER, STRIPS, STROKE_STEP, TOOL, TOOLS,
};
use base::units::{Mm, Rad, trim};
use blade::LOOP_EDGES;
use blade::angles::EdgeShape;
use five_axis::control::{LengthTo, Planning};
use std::fmt::{Display, Write};
use wheel::contract::{Bound, ContractKind};
use wheel::method::{FaceOrder, FlankMethod};
use wheel::operation::{Allowances, RoughingStrategy, VaneAllowance, distinct, word};
use wheel::part::{BladeId, FaceId, Fillet};
use wheel::post_file::PostFile;

/// A share, in percent where that loses nothing.
fn share(share: f64) -> String {
    let percent = short(share, 100.0, |percent| percent / 100.0);
    percent.map_or_else(|| share.to_string(), |percent| format!("{percent} %"))
}

/// A time given in seconds; the language counts in minutes.
fn time(seconds: f64) -> String {
    if seconds / 60.0 * 60.0 == seconds { format!("{seconds} s") } else { format!("{} min", seconds / 60.0) }
}

/// The fillet of a blade.
fn fillet(fillet: Option<&Fillet>) -> String {
    match fillet.map(Fillet::values) {
        None => "0 mm".to_owned(),
        Some([[_, radius]]) => mm(Mm(*radius)),
        Some(values) => list(values, |radius| mm(Mm(radius))),
    }
}

/// Values by shares.
fn list(values: &[[f64; 2]], text: fn(f64) -> String) -> String {
    let pair = |[at, value]: &[f64; 2]| format!("({}, {})", share(*at), text(*value));
    format!("[{}]", values.iter().map(pair).collect::<Vec<_>>().join(" "))
}

/// A value that holds everywhere, or values by shares.
fn distribution(given: &DistributionSpec, text: fn(f64) -> String) -> String {
    match given.points.as_slice() {
        [[_, everywhere]] => text(*everywhere),
        points => list(points, text),
    }
}

/// The job as text.
pub fn print(job: &Job) -> String {
    let mut out = format!("edition {EDITION}\nuse machine {:?}\n", job.machine.name);
    let mut facts = String::new();
    machine(&mut facts, job);
    out.extend(facts.lines().map(|line| format!("//{line}\n")));
    out.extend(job.libraries.iter().map(|library| format!("use tools {library:?}\n")));
    part(&mut out, job);
    stock(&mut out, &job.stock);
    job.tools.iter().for_each(|tool| self::tool(&mut out, job, tool));
    operations(&mut out, job);
    let _ = writeln!(out, "tolerance chord {}, rough {}", mm(job.chord), mm(job.chord_rough));
    let _ = writeln!(out, "// clearance that planning keeps: {}", job.clearance);
    let operation = |o: &usize| job.operations.get(*o).map_or_else(String::new, |o| o.name.clone());
    for c in &job.contracts {
        let [before, behind] = if c.default { ["// ", ", the default"] } else { [""; 2] };
        let _ = writeln!(out, "{before}require {}{}{behind}", statement(c.kind, c.bound), c.scope.text(operation));
    }
    for a in &job.allowed {
        let _ = writeln!(out, "allow {}{} \"{}\"", a.kind.name(), a.scope.text(operation), a.reason);
    }
    post(&mut out, &job.post);
    out
}

/// A contract with its bound, without its scope.
fn statement(kind: ContractKind, bound: Bound) -> String {
    let bound = match bound {
        Bound::Length(length) => mm(length),
        Bound::Angle(Rad(rad)) => angle(rad),
        Bound::Share(of) => share(of),
        Bound::Time(seconds) => time(seconds.get()),
        Bound::Volume(volume) => format!("{} mm3", volume.get()),
        Bound::Rate(rate) => format!("{} mm3/min", rate.get()),
    };
    let quantity = kind.quantity();
    let rest = kind.name().strip_prefix(quantity).unwrap_or_default();
    format!("{quantity} {} {bound}{rest}", kind.relation().sign())
}

fn part(out: &mut String, job: &Job) {
    let p = &job.part;
    let _ = writeln!(out, "part {} {{\n  vanes {}\n  extend {}", p.name, p.vanes.value, mm(p.extend));
    if let Some(from) = &p.imported {
        let _ = writeln!(out, "  imported \"{}\", within {}", from.files, mm(from.within));
    }
    for (k, blade) in p.blades.iter().enumerate() {
        let _ = writeln!(out, "  {} {} {{", if k == 0 { "vane" } else { "splitter" }, blade.name);
        blade_form(out, blade, &p.main().name);
        if k > 0 {
            let _ = writeln!(out, "    angle {}", angle(blade.angle.get()));
        }
        let _ = writeln!(out, "    fillet {}\n  }}", fillet(blade.fillet.as_ref()));
    }
    for (name, generator) in [("hub", &p.hub), ("shroud", &p.shroud)] {
        let _ = write!(out, "  {name} revolve ");
        match generator {
            RevolvedSpec::OfBlade(curve) => {
                let _ = writeln!(out, "{}.{}.{}", p.main().name, curve.face.name(), curve.end.name());
            }
            RevolvedSpec::Own(curve) => spline(out, curve, "  "),
        }
    }
    out.push_str("}\n");
}

fn stock(out: &mut String, stock: &StockSpec) {
    let StockSpec { over_shroud, bore, back, clamping, left, material, .. } = stock;
    let _ = writeln!(
        out,
        "stock turned {{\n  over shroud {}\n  bore {}\n  back {}",
        mm(*over_shroud),
        mm(*bore),
        mm(*back)
    );
    match (clamping.span, clamping.diameter) {
        (None, _) => _ = writeln!(out, "  // clamping below {}, of any diameter: the default", clamping.below),
        (Some(_), None) => _ = writeln!(out, "  clamping {{ below {} }}", mm(clamping.below)),
        (Some(_), Some(d)) => _ = writeln!(out, "  clamping {{ below {}  diameter {} }}", mm(clamping.below), mm(d)),
    }
    if let Some(left) = left {
        let (triangles, volume) = (left.mesh.triangles.len(), left.mesh.volume());
        let _ = writeln!(out, "  from \"{}\" // {triangles} triangles, {volume:.0} mm3", left.file);
    }
    material.map(|material| writeln!(out, "  material {}", material.name()));
    out.push_str("}\n");
}

fn post(out: &mut String, post: &PostFile) {
    let _ = writeln!(out, "post {} {{ // dialect {}", post.name, post.dialect);
    let _ = writeln!(out, "  orientation {}", post.control.orientation.name());
    match post.control.orientation_tolerance {
        Some(rad) => _ = writeln!(out, "  orientation-tolerance {}", angle(rad)),
        None => out.push_str("  // orientation-tolerance by the flutes of each tool\n"),
    }
    let _ = writeln!(out, "  block-numbers {}\n  program-number {}", post.block_numbers, post.program_number);
    match post.work_offset() {
        Some(offset) => _ = writeln!(out, "  work-offset \"{offset}\""),
        None => out.push_str("  // work-offset: the usual one of the dialect\n"),
    }
    let _ = writeln!(
        out,
        "  line-end {}\n  path {}\n  sectors {}",
        post.line_end.name(),
        post.control.path.name(),
        post.control.sectors.name()
    );
    let d = post.control.decimals;
    let _ = writeln!(
        out,
        "  // digits behind the point: lengths {}, angles {}, vectors {}, feeds {}\n}}",
        d.length, d.angle, d.vector, d.feed
    );
}

/// A limit of jerk with its unit.
fn jerk(limit: f64, unit: &str) -> String {
    if limit.is_finite() { format!("{} {unit}", trim(limit, 3)) } else { "unlimited jerk".to_owned() }
}

fn machine(out: &mut String, job: &Job) {
    let m = &job.machine;
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
    let [x, y, z] = m.part_origin.value;
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

/// `spline` with the points of a curve, behind the word of the property.
fn spline(out: &mut String, curve: &CurveSpec, indent: &str) {
    out.push_str("spline ");
    points(out, &curve.points, indent);
    out.push('\n');
}

fn points(out: &mut String, points: &[[f64; 3]], indent: &str) {
    out.push_str("[\n");
    for [x, y, z] in points {
        let _ = writeln!(out, "{indent}  ({x}, {y}, {z})");
    }
    let _ = write!(out, "{indent}] mm");
}

fn blade_form(out: &mut String, blade: &BladeSpec, main: &str) {
    match &blade.form {
        BladeForm::Faces(given) => faces(out, given),
        BladeForm::Sections(given) => sections(out, given),
        BladeForm::Angles(given) => angles(out, given, main),
    }
}

/// Where the pressure face looks.
fn facing(out: &mut String, pressure: Option<Facing>) {
    match pressure {
        Some(facing) => _ = writeln!(out, "    pressure {}", facing.name()),
        None => out.push_str("    // pressure as found\n"),
    }
}

fn sections(out: &mut String, given: &SectionsSpec) {
    let _ = writeln!(out, "    fit {}", mm(given.fit));
    for (name, form) in ["leading-edge", "trailing-edge"].iter().zip(given.edges) {
        let _ = match form {
            Some(form) => writeln!(out, "    {name} {}", form.name()),
            None => writeln!(out, "    // {name} as found"),
        };
    }
    facing(out, given.pressure);
    out.push_str("    sections ");
    // Only a file can state the points of the edges.
    if let Some(file) = given.file.as_ref().filter(|_| given.loops.iter().any(|section| section.edges.is_some())) {
        let _ = writeln!(out, "{file}");
        for section in &given.loops {
            for (word, [first, last]) in LOOP_EDGES.iter().zip(section.edges.into_iter().flatten()) {
                let _ = writeln!(out, "    // {}: {word} points {} to {}", section.name, first + 1, last + 1);
            }
        }
        return;
    }
    for (k, section) in given.loops.iter().enumerate() {
        let comma = if k > 0 { ", " } else { "" };
        let _ = write!(out, "{comma}loop ");
        points(out, &section.points, "    ");
    }
    out.push('\n');
}

fn angles(out: &mut String, given: &AnglesSpec, main: &str) {
    let length = |l| mm(Mm(l));
    let _ = writeln!(out, "    fit {}", mm(given.fit));
    for (name, edge) in ["leading-edge", "trailing-edge"].iter().zip(given.edges) {
        let _ = match edge {
            EdgeShape::CutOff => writeln!(out, "    {name} cut-off"),
            EdgeShape::Elliptic(ratio) => writeln!(out, "    {name} elliptic {ratio}"),
        };
    }
    let mut rows: &[_] = &[];
    match &given.camber {
        CamberSpec::OfMain { part } => {
            let _ = writeln!(out, "    of {main}");
            for (name, [hub, shroud]) in ["from", "to"].iter().zip(part) {
                let _ = writeln!(out, "    {name} hub {}, shroud {}", share(*hub), share(*shroud));
            }
        }
        CamberSpec::Own { angles, lean, edges } => {
            facing(out, given.pressure);
            out.push_str("    beta-from meridian\n");
            edge_places(out, edges);
            lean.iter().for_each(|lean| _ = writeln!(out, "    lean {}", distribution(lean, angle)));
            rows = angles;
        }
    }
    let thickness = given.thickness.as_slice();
    if let [everywhere] = thickness {
        let _ = writeln!(out, "    thickness {}", distribution(&everywhere.says, length));
    }
    let at_spans = if thickness.len() > 1 { thickness } else { &[] };
    let mut spans: Vec<f64> = rows.iter().map(|row| row.at).chain(at_spans.iter().map(|row| row.at)).collect();
    spans.sort_by(f64::total_cmp);
    spans.dedup();
    for at in spans {
        let _ = write!(out, "    span {} {{", share(at));
        if let Some(row) = rows.iter().find(|row| row.at == at) {
            let _ = match &row.says {
                AnglesAtSpan::Theta(theta) => write!(out, " theta {} ", distribution(theta, angle)),
                AnglesAtSpan::Beta { beta, theta, end } => {
                    let end = ["start", "end"][*end];
                    write!(out, " beta {}  {end} {} ", distribution(beta, angle), angle(*theta))
                }
            };
        }
        if let Some(row) = at_spans.iter().find(|row| row.at == at) {
            let _ = write!(out, " thickness {} ", distribution(&row.says, length));
        }
        out.push_str("}\n");
    }
}

/// Where the meridional edges of a blade are.
fn edge_places(out: &mut String, edges: &[EdgePlace; 2]) {
    for (name, place) in ["from", "to"].iter().zip(edges) {
        match place {
            EdgePlace::Places(places, _) => {
                let [hub, shroud] = places.map(|place| match place {
                    MeridianPlace::Share(of) => share(of),
                    MeridianPlace::Length(length) => mm(length),
                });
                let _ = writeln!(out, "    {name} hub {hub}, shroud {shroud}");
            }
            EdgePlace::Curve(curve) => {
                let _ = write!(out, "    {name} ");
                spline(out, curve, "    ");
            }
        }
    }
}

fn faces(out: &mut String, faces: &[FaceSpec; 2]) {
    for (name, face) in FaceId::NAMES.iter().zip(faces) {
        let _ = writeln!(out, "    {name} {} {{", face.form.name());
        for (end, curve) in [("tip", &face.tip), ("root", &face.root)] {
            let _ = write!(out, "      {end} ");
            spline(out, curve, "      ");
        }
        if face.form == FaceForm::Lofted {
            out.push_str("      sections ");
            for (k, section) in face.sections.iter().enumerate() {
                let comma = if k > 0 { ", " } else { "" };
                let _ = write!(out, "{comma}spline ");
                points(out, &section.points, "      ");
            }
            out.push('\n');
        }
        out.push_str("    }\n");
    }
}

fn tool(out: &mut String, job: &Job, t: &ToolSpec) {
    let _ = writeln!(out, "tool {} = {} {{", t.name, t.kind.keyword());
    for Property { name, .. } in PROPERTIES {
        let _ = match t.text(name, job.stock.material) {
            Some(PropertyText::Stated(value)) => writeln!(out, "  {name} {value}"),
            // What the job does not state counts otherwise than what it states.
            Some(PropertyText::Default(value)) => writeln!(out, "  // {name} {value}, the default"),
            None => Ok(()),
        };
    }
    if let Some((name, sections)) = &t.holder {
        let _ = writeln!(out, "  holder {name:?}");
        for [length, lower, upper] in sections {
            let _ = writeln!(out, "  // {length} long, diameter {lower} to {upper}");
        }
    }
    out.push_str("}\n");
}

/// A property with its value.
fn put(out: &mut String, property: &Property, value: impl Display) {
    // Writing to a string does not fail.
    let _ = writeln!(out, "  {} {value}", property.name);
}

/// The blades of surfaces, for a job whose sectors have several.
fn blades(out: &mut String, job: &Job, of_surfaces: impl Iterator<Item = BladeId>) {
    if job.part.blades.len() > 1 {
        let names = of_surfaces.filter_map(|blade| job.part.blades.get(blade.index())).map(|blade| blade.name.as_str());
        put(out, &BLADES, distinct(names).join(", "));
    }
}

/// What a larger tool of a floor leaves beside the vanes; it stands in one item with the smaller tools.
fn larger(operation: &OperationSpec) -> Option<Mm> {
    operation.kind.of_larger_tool()
}

fn operations(out: &mut String, job: &Job) {
    // Tools of a floor from the larger ones to the one that finishes it are one item.
    let items = job.operations.chunk_by(|before, _| larger(before).is_some());
    for item in items {
        let (Some(first), Some(last)) = (item.first(), item.last()) else { continue };
        let of_all = |text: &dyn Fn(&OperationSpec) -> String| item.iter().map(text).collect::<Vec<_>>().join(", ");
        let tools = of_all(&|o| job.tools.get(o.tool).map_or_else(String::new, |tool| tool.name.clone()));
        let listed = item.len() > 1 || matches!(first.kind.strategy(), Some(RoughingStrategy::Rough { .. }));
        let _ = writeln!(out, "operation {} {} {{", first.kind.keyword(), first.name);
        put(out, if listed { &TOOLS } else { &TOOL }, tools);
        put(out, &SPEED, of_all(&|o| format!("{} rpm", o.speed.get())));
        put(out, &FEED, of_all(&|o| format!("{} mm/min", o.feed.get())));
        put(out, &LINK_FEED, format!("{} mm/min", first.link_feed.get()));
        put(out, &LEAD_IN, mm(first.lead_in));
        put(out, &LEAD_OUT, mm(first.lead_out));
        put(out, &REST, first.rest.map_or_else(|| "off".to_owned(), |t| format!("over {}", mm(t))));
        put(out, &SECTORS, first.sectors.iter().map(|s| (s + 1).to_string()).collect::<Vec<_>>().join(", "));
        if let Some(vane) = larger(first) {
            put(out, &ALLOWANCE, format!("vane {}", mm(vane)));
        }
        operation_kind(out, job, &last.kind);
        out.push_str("}\n");
    }
}

/// An allowance that grows towards the root, or is the same everywhere.
fn allowance(vane: VaneAllowance) -> String {
    if vane.growth() == 0.0 { mm(vane.tip()) } else { format!("{} .. {}", mm(vane.tip()), mm(vane.root())) }
}

/// The properties that a strategy of roughing has beside its depth and its allowances.
fn roughing(out: &mut String, strategy: RoughingStrategy) {
    match strategy {
        RoughingStrategy::Groove { .. } => {}
        RoughingStrategy::Expand { residual, .. } => put(out, &RESIDUAL, mm(residual)),
        RoughingStrategy::Rough { stepover, levels, milling, slots, .. } => {
            put(out, &STEPOVER, mm(stepover));
            put(out, &LEVELS, levels.name());
            put(out, &MILLING, milling.name());
            put(out, &SLOTS, slots.name());
            if let Some(arc) = slots.engagement() {
                put(out, &ENGAGEMENT, angle(arc.get()));
            }
        }
        RoughingStrategy::Plunge { stepover } => put(out, &STROKE_STEP, mm(stepover)),
    }
}

/// The properties of a kind.
fn operation_kind(out: &mut String, job: &Job, kind: &OperationKind) {
    if let Some(depth) = kind.step_down() {
        put(out, &DEPTH, mm(depth));
    }
    if let Some(Allowances { vane, hub }) = kind.roughing() {
        put(out, &ALLOWANCE, format!("vane {}, hub {}", allowance(vane), mm(hub)));
    }
    match kind {
        OperationKind::Roughing { strategy, .. } => roughing(out, *strategy),
        OperationKind::Flank { faces, flank } => {
            blades(out, job, faces.iter().map(|face| face.blade));
            put(out, &FACES, distinct(faces.iter().map(|face| face.name())).join(", "));
            put(out, &FLANK_METHOD, flank.method.name());
            put(out, &STRIPS, flank.strips_text());
            if flank.method == FlankMethod::Minimax {
                put(out, &SIDE, flank.side.name());
                put(out, &CONFLICT, flank.conflict.name());
            }
            put(out, &MILLING, flank.milling.name());
            put(out, &ORDER, flank.order.name());
        }
        OperationKind::Channel { scallop, spacing, lines, method, .. } => {
            put(out, &FLOOR_SCALLOP, mm(*scallop));
            put(out, &SPACING, spacing.name());
            put(out, &LINES, lines.name());
            put(out, &METHOD, method.name());
        }
        OperationKind::Point { .. } => in_lines(out, job, kind),
    }
}

/// The properties of `point`, `fillet`, `edge` and `tip`.
fn in_lines(out: &mut String, job: &Job, kind: &OperationKind) {
    let OperationKind::Point { surfaces, scallop, lines, milling, levels, method } = kind else { return };
    blades(out, job, surfaces.iter().filter_map(|s| word(*s)).map(|w| w.2));
    let names = distinct(surfaces.iter().filter_map(|s| word(*s)).map(|w| w.1)).join(", ");
    match kind.keyword() {
        "edge" => put(out, &EDGES, names),
        "tip" => {}
        _ => put(out, &FACES, names),
    }
    put(out, &SCALLOP, mm(*scallop));
    put(out, &LINES, lines.name());
    put(out, &METHOD, method.name());
    if let Some(milling) = milling {
        put(out, &MILLING, milling.name());
    }
    if let Some(height) = levels {
        put(out, &ORDER, FaceOrder::Levels.name());
        put(out, &LEVEL_DEPTH, mm(*height));
    }
}
