//! Text form of the stage values, for `--emit` and the goldens: stable order, fixed decimals, mm and degrees.

use super::{
    Allowances, CcPass, CcPlan, ClPlan, ClPoint, Motion, MoveKind, OperationId, OperationKind, Program,
    RoughingStrategy,
};
use five_axis::control::LengthTo;
use five_axis::{Carries, Machine};
use nalgebra::{Point3, Vector3};
use std::fmt::Write as _;
use wheel::operation::{distinct, word};
use wheel::part::{Blade, BladeId, Part};

/// Level of detail of a printed plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Detail {
    /// Every point.
    Full,
    /// Counts, and the first and last point of every pass.
    Summary,
}

fn at(p: &Point3<f64>) -> String {
    let f = |x: f64| base::units::trim(x, 4);
    format!("({}, {}, {})", f(p.x), f(p.y), f(p.z))
}

/// The program: one line per entity.
pub fn program(program: &Program) -> String {
    let mut t = String::new();
    let _ = writeln!(t, "program {}", program.name);
    part(&mut t, &program.part);
    let s = &program.stock;
    let _ = writeln!(t, "stock turned over shroud {} bore radius {} back {}", s.over_shroud, s.bore_radius, s.back);
    if let Some(left) = &s.left {
        let (vertices, triangles) = (left.vertices.len(), left.triangles.len());
        let _ = writeln!(t, "left {vertices} vertices {triangles} triangles volume {:.3} mm3", left.volume());
    }
    let radius = s.clamping.radius.map_or_else(|| "any".to_owned(), |r| r.to_string());
    let _ = writeln!(t, "clamping below {} radius {radius}", s.clamping.below);
    tools(&mut t, program);
    operations(&mut t, program);
    contracts(&mut t, program);
    machine(&mut t, &program.machine);
    let _ = writeln!(
        t,
        "tolerance chord {} rough {}, clearance {}",
        program.tolerances.chord, program.tolerances.chord_rough, program.clearance
    );
    let _ = writeln!(t, "post {}, {}", program.post.name, program.post.control.orientation.name());
    t
}

/// The part: its blades with the passages between them, hub, shroud and fillets.
fn part(t: &mut String, part: &Part) {
    let _ = writeln!(
        t,
        "part vanes {} pitch {:.4} deg, first wall {}",
        part.vane_count,
        part.pitch().to_degrees(),
        part.first_passage().walls[0].name()
    );
    faces(t, part);
    if part.blades.len() > 1 {
        for passage in part.passages() {
            let [from, to] = passage.walls.map(|wall| format!("{} {}", part.blade(wall.blade).name, wall.name()));
            let next = if passage.sectors == 1 { " of the next sector" } else { "" };
            let _ = writeln!(t, "passage from {from} to {to}{next}");
        }
    }
    for (name, s) in [("hub", &part.hub), ("shroud", &part.shroud)] {
        let (a, b) = (s.meridian(0.0).point, s.meridian(1.0).point);
        let _ = writeln!(t, "{name} = revolution (r, z) ({:.4}, {:.4}) .. ({:.4}, {:.4})", a.x, a.y, b.x, b.y);
    }
    let fillet = |blade: &Blade| blade.fillet.as_ref().map_or("none".to_owned(), ToString::to_string);
    let _ = writeln!(t, "fillet {}", fillet(part.main()));
    for splitter in &part.blades[1..] {
        let _ = writeln!(t, "fillet of {} {}", splitter.name, fillet(splitter));
    }
}

/// Both long faces of every blade.
fn faces(t: &mut String, part: &Part) {
    for side in part.faces() {
        let face = part.face(side);
        let s = &face.surface;
        let blade = part.blade(side.blade);
        let splitter = if side.blade == BladeId::MAIN { String::new() } else { format!("{} ", blade.name) };
        let sections = match s.sections().len() {
            2 => String::new(),
            n => format!(" through {n} sections"),
        };
        let _ = writeln!(
            t,
            "face {splitter}{} = {}{sections} root {} .. {} tip {} .. {} orientation {:+}",
            side.name(),
            s.kind(),
            at(&s.root().point(0.0)),
            at(&s.root().point(1.0)),
            at(&s.tip().point(0.0)),
            at(&s.tip().point(1.0)),
            face.orientation
        );
    }
}

fn tools(t: &mut String, program: &Program) {
    for (id, tool) in program.tools.iter() {
        let _ = writeln!(
            t,
            "{id} = {} {} number {} radius {:.4} flute {:.4} length {:.4}",
            tool.name,
            tool.solid.cutter.keyword(),
            tool.number,
            tool.solid.cutter.widest_below(tool.solid.flute_length),
            tool.solid.flute_length,
            tool.solid.length()
        );
    }
}

fn operations(t: &mut String, program: &Program) {
    for (id, o) in program.operations.iter() {
        let sectors: Vec<String> = o.sectors.iter().map(|s| (s + 1).to_string()).collect();
        let _ = writeln!(
            t,
            "{id} = {} {} {} at {}, feed {}, link feed {}, lead {} / {}, sectors {}{}",
            o.name,
            kind(&o.kind),
            o.tool,
            o.speed,
            o.feed,
            o.link_feed,
            o.lead_in,
            o.lead_out,
            sectors.join(" "),
            o.rest.map_or_else(String::new, |t| format!(", rest over {t}"))
        );
    }
}

/// Contracts of the job, and what the job allows.
fn contracts(t: &mut String, program: &Program) {
    let name = |o: &OperationId| program.operations[*o].name.clone();
    for c in &program.contracts {
        let _ = writeln!(t, "require {}{}", c.kind.statement(c.bound), c.scope.text(name));
    }
    for a in &program.allowed {
        let _ = writeln!(t, "allow {}{} {:?}", a.kind.name(), a.scope.text(name), a.reason);
    }
}

fn kind(kind: &OperationKind) -> String {
    match kind {
        OperationKind::Roughing { allowances: Allowances { vane, hub }, strategy } => {
            let keeps = format!("vane {vane} hub {hub}");
            match strategy {
                RoughingStrategy::Groove { depth } => format!("groove depth {depth} {keeps}"),
                RoughingStrategy::Expand { depth, residual } => {
                    format!("expand depth {depth} {keeps} residual {residual}")
                }
                RoughingStrategy::Rough { depth, stepover, levels, milling, slots } => {
                    let (levels, milling) = (levels.name(), milling.name());
                    let loops = slots.engagement().map_or_else(String::new, |arc| format!(" to {arc}"));
                    let slots = slots.name();
                    format!("rough depth {depth} stepover {stepover} {keeps} {levels} {milling}, {slots} slots{loops}")
                }
                RoughingStrategy::Plunge { stepover } => format!("plunge stepover {stepover} {keeps}"),
            }
        }
        OperationKind::Flank { faces, flank } => {
            let blades = of_blades(faces.iter().map(|face| face.blade));
            let faces = distinct(faces.iter().map(|f| f.name()));
            let (method, strips) = (flank.method.name(), flank.strips_text());
            let (milling, order) = (flank.milling.name(), flank.order.name());
            format!("flank {method} {}{blades} strips {strips} {milling} order {order}", faces.join(" "))
        }
        OperationKind::Channel { scallop, spacing, lines, method, allowance_vane } => {
            let (spacing, lines, method) = (spacing.name(), lines.name(), method.name());
            let vane = allowance_vane.map_or_else(String::new, |vane| format!(" vane {vane}"));
            format!("channel {spacing} scallop {scallop} {lines} axes {method}{vane}")
        }
        OperationKind::Point { surfaces, scallop, lines, milling, levels, method } => {
            let blades = of_blades(surfaces.iter().filter_map(|s| word(*s)).map(|w| w.2));
            let names = distinct(surfaces.iter().filter_map(|s| word(*s)).map(|w| w.1));
            let (lines, axes) = (lines.name(), method.name());
            let levels = levels.map_or_else(String::new, |height| format!(" levels {height}"));
            let milling = milling.map_or_else(String::new, |milling| format!(" {}", milling.name()));
            format!(
                "{} {}{blades} scallop {scallop} lines {lines}{milling}{levels} axes {axes}",
                kind.keyword(),
                names.join(" ")
            )
        }
    }
}

/// The blades of surfaces, where these are others than the main blade.
fn of_blades(blades: impl Iterator<Item = BladeId>) -> String {
    let mut blades: Vec<BladeId> = blades.collect();
    blades.sort_unstable();
    blades.dedup();
    if blades == [BladeId::MAIN] {
        return String::new();
    }
    let numbers: Vec<String> = blades.iter().map(|blade| blade.index().to_string()).collect();
    format!(" of blades {}", numbers.join(" "))
}

/// Indices of the printed points of a run.
fn shown(count: usize, detail: Detail) -> Vec<usize> {
    match detail {
        Detail::Full => (0..count).collect(),
        Detail::Summary if count > 1 => vec![0, count - 1],
        Detail::Summary => (0..count).collect(),
    }
}

/// Contact points.
pub fn cc(program: &Program, plan: &CcPlan, detail: Detail) -> String {
    let mut t = String::new();
    for operation in &plan.operations {
        let _ = writeln!(t, "{} {}", operation.operation, program.operations[operation.operation].name);
        for note in &operation.notes {
            let _ = writeln!(t, "  note {note}");
        }
        for pass in &operation.passes {
            let _ = writeln!(t, "  pass {}: {} points", pass.label, pass.points.len());
            cc_points(pass, detail, &mut t);
        }
    }
    t
}

fn cc_points(pass: &CcPass, detail: Detail, t: &mut String) {
    for i in shown(pass.points.len(), detail) {
        let p = &pass.points[i];
        let _ = writeln!(t, "    {i} u {:.5} v {:.5} w {:.5} {}", p.u, p.v, p.w, at(&p.position));
    }
}

fn location(p: &ClPoint) -> String {
    format!("{} axis ({:.6}, {:.6}, {:.6})", at(&p.tip), p.axis.x + 0.0, p.axis.y + 0.0, p.axis.z + 0.0)
}

/// Cutter locations of all passes.
pub fn cl(program: &Program, plan: &ClPlan, detail: Detail) -> String {
    let mut t = String::new();
    for operation in &plan.operations {
        let name = &program.operations[operation.operation].name;
        let _ = writeln!(t, "{} {name}: {} passes", operation.operation, operation.passes.len());
        for note in &operation.notes {
            let _ = writeln!(t, "  note {note}");
        }
        for pass in &operation.passes {
            let _ = writeln!(t, "  pass {}: {} points", pass.label, pass.points.len());
            for i in shown(pass.points.len(), detail) {
                let _ = writeln!(t, "    {i} {}", location(&pass.points[i]));
            }
        }
    }
    t
}

fn directed(v: &Vector3<f64>) -> String {
    [v.x, v.y, v.z].map(|x| format!("{x:.4}")).join(", ")
}

/// The chain of the rotary axes from the tool to the part.
fn machine(t: &mut String, machine: &Machine) {
    let _ = writeln!(t, "machine {}", machine.name);
    for (limits, axis) in machine.rotary.iter().zip(machine.chain.axes()) {
        let carries = match axis.carries {
            Carries::Tool => "tool",
            Carries::Part => "part",
        };
        let [x, y, z] = axis.direction.into_inner().into();
        let _ = writeln!(
            t,
            "  {} carries the {carries} about ({x:.4}, {y:.4}, {z:.4}) at {}",
            limits.name,
            at(&axis.point)
        );
        if let Some(way) = limits.modulo {
            let _ = writeln!(t, "  {} is modulo 360 deg, way {}", limits.name, way.name());
        }
        if let Some([on, off]) = &limits.clamp {
            let _ = writeln!(t, "  {} is clamped by {on}, unclamped by {off}", limits.name);
        }
    }
    if !machine.chain.holds_part_upright() {
        let [x, _, z] = machine.part_directions();
        let _ = writeln!(t, "  Z of the part along ({}), X along ({})", directed(&z), directed(&x));
    }
    if machine.length_to != LengthTo::Tip {
        let _ = writeln!(t, "  tool lengths to the {}", machine.length_to.name());
    }
    for (name, home) in machine.names().iter().zip(machine.home) {
        if let Some(home) = home {
            let _ = writeln!(t, "  parks {name} at {home:.3}");
        }
    }
}

fn move_word(kind: MoveKind) -> &'static str {
    match kind {
        MoveKind::Rapid => "rapid",
        MoveKind::Link => "link",
        MoveKind::Cut => "cut",
    }
}

/// Joint motion: every move, or the first of each pass.
pub fn motion(program: &Program, motion: &Motion, detail: Detail) -> String {
    let mut t = String::new();
    let [.., first, second] = program.machine.names();
    for operation in &motion.operations {
        let name = &program.operations[operation.operation].name;
        let time: f64 = operation.moves.iter().map(|m| m.time).sum();
        let _ = writeln!(t, "{} {name}: {} moves, {time:.3} s", operation.operation, operation.moves.len());
        let mut last = None;
        for (i, m) in operation.moves.iter().enumerate() {
            if detail == Detail::Summary && last == Some(m.pass) {
                continue;
            }
            last = Some(m.pass);
            let j = &m.joints;
            let feed = m.feed.map_or("rapid".to_owned(), |f| format!("feed {f:.3}"));
            let _ = writeln!(
                t,
                "  {i} {} X {:.4} Y {:.4} Z {:.4} {first} {:.4} {second} {:.4} {feed} time {:.4}",
                move_word(m.kind),
                j.xyz.x + 0.0,
                j.xyz.y + 0.0,
                j.xyz.z + 0.0,
                j.rotary[0].to_degrees(),
                j.rotary[1].to_degrees(),
                m.time
            );
        }
    }
    t
}
