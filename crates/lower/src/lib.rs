//! From the job to the program: units become plain numbers, points become curves, sizes become solids.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking"))]

mod angles;
mod checks;
mod curves;
mod face_curves;
mod facing;
mod left;
mod limits;
mod names;
mod part;
mod pressure;
mod sections;

use base::entity::{EntityId, PrimaryMap};
use base::units::{Mm, trim};
use diagnostics::codes::job::LIBRARY;
use diagnostics::{Aborted, Diag, Sink};
use five_axis::chain::ChainFault;
use five_axis::{AxisLine, Carried, CarriedKind, Carries, Chain, LinearAxis, Machine, RotaryAxis};
use ir::program::DEFAULT_MEMORY;
use ir::{
    Allowed, Contract, DataCurve, DataPoint, Operation, OperationId, OperationKind, Program, StatedPoints, Tolerances,
    Tool, ToolId,
};
use job::model::{
    self, BladeForm, BladeSpec, CurveSpec, CutterKind, Job, LinearSpec, MachineKind, MachineSpec, PartSpec, RotarySpec,
    ToolSpec,
};
use nalgebra::{Matrix3, Point3, Rotation3, Unit, Vector3};
use std::sync::Arc;
use tool_stock::collide::{Cutter, Section, ToolSolid};
use wheel::contract::Scope;
use wheel::material::Material;
use wheel::part::{BladeId, Clamping, FaceId, Part, RulingEnd, Stock, SurfaceKind};

/// Lowers a job. Faults of the geometry go to the sink.
///
/// # Errors
/// [`Aborted`] when the geometry is faulty.
pub fn lower(job: &Job, sink: &mut Sink) -> Result<Program, Aborted> {
    let part = part::part(&job.part, &job.tools, sink)?;
    let mut stock = Stock::turned(&part, job.stock.over_shroud, Mm(job.stock.bore.get() / 2.0), job.stock.back);
    let clamping = &job.stock.clamping;
    stock.clamping = Clamping {
        below: clamping.below,
        radius: clamping.diameter.map(|d| Mm(d.get() / 2.0)),
        by_default: clamping.span.is_none(),
    };
    stock.material = job.stock.material;
    stock.left = job.stock.left.as_ref().map(|file| Arc::clone(&file.mesh));
    checks::stock(job, &part, sink);
    if let Some(file) = job.stock.left.as_ref().filter(|_| !sink.has_errors()) {
        left::check(file, &part, &stock, sink);
    }
    if !sink.has_errors() {
        checks::off_hub(&job.part, &part, sink);
    }
    let mut tools: PrimaryMap<ToolId, Tool> = PrimaryMap::new();
    for spec in &job.tools {
        tools.push(tool(spec, job.stock.material));
    }
    let mut operations: PrimaryMap<OperationId, Operation> = PrimaryMap::new();
    for spec in &job.operations {
        operations.push(Operation { kind: kind(&spec.kind, &job.part, &part), ..operation(spec) });
    }
    let machine = machine(&job.machine, chain(&job.machine, sink)?);
    check_part_axis(&job.machine, &machine, sink)?;
    check_table(&job.machine, &machine, sink)?;
    let program = Program {
        name: job.part.name.clone(),
        name_span: job.part.span,
        part,
        stock,
        tools,
        operations,
        contracts: job.contracts.iter().map(contract).collect(),
        allowed: job.allowed.iter().map(allowed).collect(),
        machine,
        post: job.post.clone(),
        tolerances: Tolerances { chord: job.chord, chord_rough: job.chord_rough },
        clearance: job.clearance,
        data: data(job),
        stated: stated(job),
        imported: job.part.imported.clone(),
        memory: DEFAULT_MEMORY,
    };
    checks::tips_left(job, &program, sink);
    if sink.has_errors() { Err(Aborted) } else { Ok(program) }
}

/// Points of the curves and sections of each vane, turned to its place.
fn stated(job: &Job) -> Vec<StatedPoints> {
    let of_blade = |(k, blade): (usize, &BladeSpec)| {
        let lists: Vec<&[[f64; 3]]> = match &blade.form {
            BladeForm::Faces(faces) => {
                let curves = faces.iter().flat_map(|face| [&face.root, &face.tip].into_iter().chain(&face.sections));
                curves.map(|curve| curve.points.as_slice()).collect()
            }
            BladeForm::Sections(sections) => sections.loops.iter().map(|section| section.points.as_slice()).collect(),
            BladeForm::Angles(_) => Vec::new(),
        };
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), blade.angle.get());
        let points: Vec<_> = lists.into_iter().flatten().map(|p| turn * Point3::from(*p)).collect();
        (!points.is_empty()).then(|| StatedPoints { blade: BladeId::new(k), points })
    };
    job.part.blades.iter().enumerate().filter_map(of_blade).collect()
}

/// Points of the root and tip curves of the main blade; none for a blade of sections, whose points are fitted.
fn data(job: &Job) -> Vec<DataCurve> {
    let curve = |side, end, spec: &CurveSpec| {
        let points = spec.points.iter().zip(&spec.spans);
        let points = points.map(|(p, span)| DataPoint { point: Point3::from(*p), span: Some(*span) }).collect();
        DataCurve { side, end, points }
    };
    let faces = job.part.main().faces().map(|faces| BladeId::MAIN.faces().into_iter().zip(faces));
    faces
        .into_iter()
        .flatten()
        .flat_map(|(id, face)| [curve(id, RulingEnd::Tip, &face.tip), curve(id, RulingEnd::Root, &face.root)])
        .collect()
}

fn tool(spec: &ToolSpec, material: Option<Material>) -> Tool {
    let radius = spec.diameter.get() / 2.0;
    let cutter = match spec.kind {
        CutterKind::Flat => Cutter::flat(radius),
        CutterKind::Ball => Cutter::ball(radius),
        CutterKind::Bull(corner) => Cutter::bull(radius, corner.get()),
        CutterKind::TaperedBall(angle) => Cutter::tapered_ball(radius, angle.get()),
        CutterKind::Barrel { barrel, tip } => Cutter::barrel(radius, barrel.get(), tip.get()),
        CutterKind::Lollipop { .. } => Cutter::lollipop(radius),
    };
    let (flute, reach) = (spec.flute.get(), spec.reach.get());
    let mut shank = Vec::new();
    let mut from = flute;
    let mut cylinder = |to: f64, diameter: Mm| {
        if to > from {
            let radius = diameter.get() / 2.0;
            shank.push(Section { from, to, radius_from: radius, radius_to: radius });
            from = to;
        }
    };
    if let CutterKind::Lollipop { neck, neck_end } = spec.kind {
        cylinder(neck_end.get(), neck);
    }
    cylinder(reach, spec.shank);
    let mut holder = Vec::new();
    let mut from = reach;
    for [length, lower, upper] in spec.holder.iter().flat_map(|(_, sections)| sections) {
        let to = from + length.get();
        holder.push(Section { from, to, radius_from: lower.get() / 2.0, radius_to: upper.get() / 2.0 });
        from = to;
    }
    Tool {
        name: spec.name.clone(),
        number: spec.number,
        flutes: spec.flutes,
        max_chip: spec.largest_chip(material),
        max_depth: spec.largest_depth(material),
        max_rate: spec.limits.rate,
        plunge_width: spec.plunge_width(),
        ramp: spec.largest_ramp(),
        ramp_stated: spec.limits.ramp.is_some(),
        solid: ToolSolid { cutter, flute_length: flute, shank, holder },
        span: spec.span,
    }
}

/// The kind of an operation with the blades in the order of the part, and with the fillets round edges.
fn kind(spec: &OperationKind, given: &PartSpec, part: &Part) -> OperationKind {
    let blade = |id: BladeId| {
        let name = given.blades.get(id.index()).map(|blade| &blade.name);
        part.blade_ids().find(|id| Some(&part.blade(*id).name) == name).unwrap_or(id)
    };
    let face = |id: FaceId| blade(id.blade).faces()[id.index() % FaceId::NAMES.len()];
    let mut kind = spec.clone();
    match &mut kind {
        OperationKind::Flank { faces, .. } => faces.iter_mut().for_each(|id| *id = face(*id)),
        OperationKind::Point { surfaces, .. } => {
            for surface in surfaces.iter_mut() {
                *surface = match *surface {
                    SurfaceKind::Face(id) => SurfaceKind::Face(face(id)),
                    SurfaceKind::Fillet(id) => SurfaceKind::Fillet(face(id)),
                    SurfaceKind::InletEdge(id) => SurfaceKind::InletEdge(blade(id)),
                    SurfaceKind::OutletEdge(id) => SurfaceKind::OutletEdge(blade(id)),
                    SurfaceKind::Tip(id) => SurfaceKind::Tip(blade(id)),
                    other => other,
                };
            }
            // Who names the fillets of both faces means the fillet round the blade.
            for blade in part.blade_ids() {
                let fillets = blade.faces().map(SurfaceKind::Fillet);
                if fillets.iter().all(|fillet| surfaces.contains(fillet)) {
                    surfaces
                        .extend([0, 1].into_iter().filter_map(|end| part.edge(blade, end)).map(SurfaceKind::Fillet));
                }
            }
        }
        OperationKind::Roughing { .. } | OperationKind::Channel { .. } => {}
    }
    kind
}

fn operation(spec: &model::OperationSpec) -> Operation {
    Operation {
        name: spec.name.clone(),
        kind: spec.kind.clone(),
        tool: ToolId::new(spec.tool),
        speed: spec.speed,
        feed: spec.feed,
        link_feed: spec.link_feed,
        sectors: spec.sectors.clone(),
        lead_in: spec.lead_in,
        lead_out: spec.lead_out,
        rest: spec.rest,
        span: spec.span,
    }
}

fn contract(spec: &model::ContractSpec) -> Contract {
    Contract { kind: spec.kind, bound: spec.bound, scope: scope(&spec.scope), default: spec.default, span: spec.span }
}

fn allowed(spec: &model::AllowedSpec) -> Allowed {
    Allowed { kind: spec.kind, scope: scope(&spec.scope), reason: spec.reason.clone(), span: spec.span }
}

fn scope(spec: &Scope<usize>) -> Scope<OperationId> {
    Scope {
        operations: spec.operations.iter().map(|o| OperationId::new(*o)).collect(),
        surfaces: spec.surfaces.clone(),
    }
}

/// The chain of the rotary axes of a machine.
///
/// # Errors
/// The axes cannot give the tool its directions; the reason is in the sink.
fn chain(spec: &MachineSpec, sink: &mut Sink) -> Result<Chain, Aborted> {
    let (kind, span) = (spec.kind.value, spec.kind.span);
    let carries = match kind {
        MachineKind::TableTable => [Carries::Part, Carries::Part],
        MachineKind::HeadTable => [Carries::Tool, Carries::Part],
        MachineKind::HeadHead => [Carries::Tool, Carries::Tool],
    };
    let lines = [0, 1].map(|k| AxisLine {
        carries: carries[k],
        direction: Unit::new_unchecked(Vector3::from(spec.rotary[k].direction)),
        point: Point3::from(spec.rotary[k].point.map(Mm::get)),
    });
    let [first, second] = spec.rotary.each_ref().map(|axis| axis.name.as_str());
    let (message, help) = match Chain::new(lines) {
        Ok(chain) => return Ok(spec.part_axes.map_or(chain, |axes| chain.with_part(part_axes(axes)))),
        Err(ChainFault::Parallel) => {
            (format!("the axes {first} and {second} are parallel"), "correct `direction` of one of them")
        }
        Err(ChainFault::AlongTool) => (
            format!("axis {first}, next to the tool, is parallel to the tool"),
            "correct its `direction`, or name the other axis first in `order`",
        ),
        Err(ChainFault::Order) => (
            format!("axis {first} carries the part and {second} the tool"),
            "name the axis of the head first in `order`",
        ),
    };
    sink.push(Diag::error(LIBRARY, message).label(span, "these axes cannot direct the tool").help(help));
    Err(Aborted)
}

/// The axes of a part from the directions of its X and Z.
fn part_axes([x, z]: [[f64; 3]; 2]) -> Rotation3<f64> {
    let [x, z] = [x, z].map(Vector3::from);
    Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, z.cross(&x), z]))
}

/// Largest sine of the angle between the axis of a table and that of a part that is clamped on it: a measured table is
/// less oblique.
const MAX_TILT_SINE: f64 = 0.0175;

/// Refuses a part that nobody set across the axis of its table: most likely it turns about this axis.
///
/// # Errors
/// The machine is refused; the reason is in the sink.
fn check_part_axis(spec: &MachineSpec, machine: &Machine, sink: &mut Sink) -> Result<(), Aborted> {
    let [_, table] = machine.chain.axes();
    let across = libm::hypot(table.direction.x, table.direction.y);
    if spec.part_direction || table.carries == Carries::Tool || across < MAX_TILT_SINE {
        return Ok(());
    }
    let name = &machine.rotary[1].name;
    let text = |v: Vector3<f64>| format!("[{}]", [v.x, v.y, v.z].map(|x| trim(x + 0.0, 4)).join(", "));
    let along = table.direction.into_inner();
    let reached: Vec<String> = [along, -along]
        .into_iter()
        .filter(|v| machine.reaches(v))
        .map(|v| format!("`direction = {}`", text(v)))
        .collect();
    let on_table = match &reached[..] {
        [] => String::new(),
        ways => format!("{} for a part on the table {name}, ", ways.join(" or ")),
    };
    sink.push(
        Diag::error(LIBRARY, format!("the part lies across the axis {name} of the table that carries it"))
            .label(spec.part_origin.span, "`direction` of the part is missing")
            .note(format!(
                "with all axes at zero {name} turns about {} of the machine frame, and the axis of the part points along [0, 0, 1]",
                text(along)
            ))
            .help(format!(
                "write in [part] of the machine file where Z of the part points with all axes at zero: {on_table}\
                 `direction = [0, 0, 1]` for one that is clamped across it"
            )),
    );
    Err(Aborted)
}

/// Refuses a table that is no solid about the axis of the part: the proof knows no others.
///
/// # Errors
/// The machine is refused; the reason is in the sink.
fn check_table(spec: &MachineSpec, machine: &Machine, sink: &mut Sink) -> Result<(), Aborted> {
    let [_, second] = machine.chain.axes();
    let turning = second.carries == Carries::Part;
    let about = if turning { second.direction.into_inner() } else { Vector3::z() };
    let [_, _, part] = machine.part_directions();
    if spec.table.is_none() || about.cross(&part).norm() < MAX_TILT_SINE {
        return Ok(());
    }
    let axis = if turning { format!("the axis {}", machine.rotary[1].name) } else { "Z".to_owned() };
    sink.push(
        Diag::error(LIBRARY, format!("the part is clamped oblique to its table, and [table] is a solid about {axis}"))
            .label(spec.part_origin.span, "where the part is")
            .note("the proof knows solids about the axis of the part alone")
            .help("write a [fixture] about the axis of the part that encloses table and fixture, and remove [table]"),
    );
    Err(Aborted)
}

/// The machine; its rotary axes have the ISO sense.
fn machine(spec: &MachineSpec, chain: Chain) -> Machine {
    Machine {
        name: spec.name.clone(),
        linear: spec.linear.map(|axis: LinearSpec| LinearAxis {
            min: axis.travel[0].get(),
            max: axis.travel[1].get(),
            speed: axis.speed.get() / 60.0,
            acceleration: axis.acceleration,
            jerk: axis.jerk,
        }),
        rotary: [0, 1].map(|k| rotary(&spec.rotary[k])),
        chain,
        part_origin: Vector3::from(spec.part_origin.value.map(Mm::get)),
        retract: spec.retract.get(),
        home: spec.home.map(|at| at.map(Mm::get)),
        length_to: spec.length_to,
        spindle: spec.spindle.map(base::units::Rpm::get),
        power: spec.power,
        rapid: spec.rapid.get() / 60.0,
        cycle: spec.cycle,
        planning: spec.planning,
        carried: carried(spec),
        own_words: spec.own_words.clone(),
        assumed: spec.assumed.clone(),
    }
}

/// Table and fixture in the part frame.
fn carried(spec: &MachineSpec) -> Vec<Carried> {
    let origin = Vector3::from(spec.part_origin.value.map(Mm::get));
    let below = spec.part_axes.map_or(origin.z, |[_, z]| origin.dot(&Vector3::from(z)));
    let solids = [(CarriedKind::Table, &spec.table, -below), (CarriedKind::Fixture, &spec.fixture, 0.0)];
    let solids = solids.into_iter().filter_map(|(kind, solid, shift)| {
        let solid = solid.as_ref()?;
        let mut z = solid.top.get() + shift;
        let mut profile = vec![[0.0, z]];
        for [length, upper, lower] in &solid.sections {
            profile.push([upper.get() / 2.0, z]);
            z -= length.get();
            profile.push([lower.get() / 2.0, z]);
        }
        profile.push([0.0, z]);
        Some(Carried { kind, profile })
    });
    solids.collect()
}

/// The limits of an axis change places where its word has the opposite sense.
fn rotary(spec: &RotarySpec) -> RotaryAxis {
    let [min, max] = spec.travel.map(|t| t.get());
    let (min, max, word_sign) = if spec.iso { (min, max, 1.0) } else { (-max, -min, -1.0) };
    let name = spec.name.clone();
    let RotarySpec { speed, acceleration, jerk, modulo, .. } = *spec;
    RotaryAxis { name, min, max, speed, acceleration, jerk, word_sign, modulo, clamp: spec.clamp.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::units::Rad;

    #[test]
    fn limits_of_an_opposite_word_change_places() {
        let spec = RotarySpec {
            travel: [Rad(-1.5), Rad(0.5)],
            speed: 1.0,
            acceleration: 2.0,
            jerk: f64::INFINITY,
            iso: false,
            modulo: None,
            clamp: None,
            name: "A".to_owned(),
            direction: [1.0, 0.0, 0.0],
            point: [Mm(0.0); 3],
        };
        let axis = rotary(&spec);
        assert_eq!((axis.min, axis.max, axis.word_sign), (-0.5, 1.5, -1.0));
    }
}
