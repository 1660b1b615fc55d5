//! Programs for tests, built without the job language.

#![allow(dead_code, reason = "each program of tests uses its part")]

pub mod blade_data;
pub mod bounded;
pub mod browser;
pub mod certificates;
pub mod golden;
pub mod jobs;
pub mod part_alone;
pub mod pinned;
pub mod round_trip;
pub mod sources;
pub mod squares;
pub mod step_text;

use impellerc::base::entity::PrimaryMap;
use impellerc::base::source::Span;
use impellerc::base::units::{Mm, MmPerMin, Rad, Rpm};
use impellerc::five_axis::control::Planning;
use impellerc::five_axis::{Chain, LinearAxis, Machine, RotaryAxis};
use impellerc::ir::program::DEFAULT_MEMORY;
use impellerc::ir::{
    Allowances, Allowed, ContractKind, DataCurve, DataPoint, Operation, OperationId, OperationKind, Program,
    RoughingStrategy, Tolerances, Tool, ToolId,
};
use impellerc::job::shipped_post;
use impellerc::nurbs::{LoftedSurface, NurbsCurve, interpolate};
use impellerc::tool_stock::collide::{Cutter, Section, ToolSolid};
use impellerc::wheel::contract::Scope;
use impellerc::wheel::method::{AxisMethod, Flank, FlankMethod, Lines, Spacing};
use impellerc::wheel::operation::VaneAllowance;
use impellerc::wheel::part::{Blade, BladeId, FaceId, FaceSurface, Guides, Part, RulingEnd, Stock};
use nalgebra::{Point3, Rotation3, Vector2, Vector3};

/// Wei et al. 2021, tables 1 and 2, mm.
pub const TIP_PRESSURE: [[f64; 3]; 7] = [
    [15.0578, -38.5221, 0.0],
    [9.7506, -40.4552, -3.9523],
    [4.9017, -41.9681, -8.5921],
    [0.0, -43.9576, -13.7361],
    [-2.3747, -47.3994, -18.7416],
    [-4.8445, -52.5897, -22.4812],
    [-7.3561, -58.6341, -24.5],
];
/// As above.
pub const TIP_SUCTION: [[f64; 3]; 7] = [
    [17.0533, -37.6813, 0.0],
    [11.8545, -39.8895, -3.9523],
    [7.0914, -41.6541, -8.5921],
    [3.1003, -43.8554, -13.7361],
    [0.1093, -47.4587, -18.7416],
    [-2.0856, -52.7712, -22.4812],
    [-4.2774, -58.9387, -24.5],
];
/// As above.
pub const ROOT_PRESSURE: [[f64; 3]; 7] = [
    [5.8562, -15.8937, -10.0],
    [2.0282, -20.1342, -17.111],
    [-0.6451, -25.5343, -23.7352],
    [-2.3108, -32.8384, -28.6366],
    [-3.5795, -41.2836, -31.355],
    [-5.1602, -50.0458, -32.4837],
    [-8.0303, -58.5456, -32.5],
];
/// As above.
pub const ROOT_SUCTION: [[f64; 3]; 7] = [
    [8.5272, -14.6354, -10.0],
    [5.238, -19.5435, -17.0893],
    [2.7895, -25.3057, -23.6533],
    [1.1626, -32.7485, -28.5652],
    [-0.2986, -41.2614, -31.3441],
    [-1.6591, -50.1741, -32.478],
    [-3.9268, -58.9631, -32.5],
];

/// Cubic curve through the points of a table.
pub fn curve(points: &[[f64; 3]]) -> NurbsCurve {
    let points: Vec<Point3<f64>> = points.iter().map(|p| Point3::new(p[0], p[1], p[2])).collect();
    interpolate(&points, 3).unwrap()
}

/// The paper's part.
pub fn wei_part(fillet: Option<f64>) -> Part {
    Part::new(
        8,
        Guides { root: curve(&ROOT_PRESSURE), tip: curve(&TIP_PRESSURE) },
        Guides { root: curve(&ROOT_SUCTION), tip: curve(&TIP_SUCTION) },
        curve(&ROOT_PRESSURE),
        curve(&TIP_PRESSURE),
        fillet.map(Mm),
    )
}

/// The paper's part with faces that are curved from root to tip: the middle of each goes up to 0.6 mm aside.
pub fn curved_part(fillet: Option<f64>) -> Part {
    let face = |root: &[[f64; 3]], tip: &[[f64; 3]]| -> FaceSurface {
        let last = root.len() as f64 - 1.0;
        let middle = |(k, (r, t)): (usize, (&[f64; 3], &[f64; 3]))| {
            let p = nalgebra::center(&Point3::from(*r), &Point3::from(*t));
            let aside = 0.6 * libm::sin(std::f64::consts::PI * k as f64 / last) / libm::hypot(p.x, p.y);
            let turned = Rotation3::from_axis_angle(&Vector3::z_axis(), aside) * p;
            [turned.x, turned.y, turned.z]
        };
        let middle: Vec<[f64; 3]> = root.iter().zip(tip).enumerate().map(middle).collect();
        LoftedSurface::through(vec![curve(root), curve(&middle), curve(tip)]).unwrap().into()
    };
    let faces = [face(&ROOT_PRESSURE, &TIP_PRESSURE), face(&ROOT_SUCTION, &TIP_SUCTION)];
    let blade = Blade::new("main", faces, fillet.map(|radius| Mm(radius).into()));
    Part::with_blades(8, blade, Vec::new(), curve(&ROOT_PRESSURE), curve(&TIP_PRESSURE))
}

/// The points of the paper's tables.
pub fn wei_data() -> Vec<DataCurve> {
    let curve = |side, end, points: &[[f64; 3]]| DataCurve {
        side,
        end,
        points: points.iter().map(|p| DataPoint { point: Point3::from(*p), span: None }).collect(),
    };
    vec![
        curve(FaceId::PRESSURE, RulingEnd::Root, &ROOT_PRESSURE),
        curve(FaceId::PRESSURE, RulingEnd::Tip, &TIP_PRESSURE),
        curve(FaceId::SUCTION, RulingEnd::Root, &ROOT_SUCTION),
        curve(FaceId::SUCTION, RulingEnd::Tip, &TIP_SUCTION),
    ]
}

/// A/C double turntable in the class of the paper's machine.
pub fn machine() -> Machine {
    let linear =
        |half: f64| LinearAxis { min: -half, max: half, speed: 500.0, acceleration: 5000.0, jerk: f64::INFINITY };
    let rotary = |name: &str, min: f64, max: f64, rpm: f64| RotaryAxis {
        min: min.to_radians(),
        max: max.to_radians(),
        speed: rpm * std::f64::consts::TAU / 60.0,
        acceleration: 20.0,
        ..RotaryAxis::unlimited(name)
    };
    Machine {
        name: "5mc850-c".to_owned(),
        linear: [linear(400.0), linear(250.0), linear(350.0)],
        rotary: [rotary("A", -100.0, 100.0, 16.0), rotary("C", -180.0, 180.0, 30.0)],
        part_origin: Vector3::new(0.0, 0.0, 80.0),
        retract: 350.0,
        spindle: [100.0, 18000.0],
        rapid: 500.0,
        cycle: 0.002,
        ..Machine::unlimited(Chain::tilting_table())
    }
}

/// Tool axis on an A/C table, in the closed form of textbooks.
pub fn axis_at(a: f64, c: f64) -> Vector3<f64> {
    Vector3::new(a.sin() * c.sin(), -a.sin() * c.cos(), a.cos())
}

/// Moves the axes of a chain by these vectors, mm: first the axis next to the tool, then the axis next to the part.
pub fn shifted(chain: &Chain, by: [[f64; 3]; 2]) -> Chain {
    let mut axes = *chain.axes();
    for (axis, by) in axes.iter_mut().zip(by) {
        axis.point += Vector3::from(by);
    }
    Chain::new(axes).unwrap()
}

/// A machine with the control of a dialect. On LinuxCNC a positive word turns the part as a right-hand screw, and the
/// control plans speeds in its own way.
pub fn machine_for(dialect: &str, machine: &Machine) -> Machine {
    let linuxcnc = dialect == "linuxcnc";
    let word_sign = if linuxcnc { -1.0 } else { 1.0 };
    let planning = if linuxcnc { Planning::LinuxCnc } else { Planning::Joints };
    let with_sense = |axis: &RotaryAxis| RotaryAxis { word_sign, ..axis.clone() };
    Machine { rotary: machine.rotary.each_ref().map(with_sense), planning, ..machine.clone() }
}

/// A program for [`machine_for`] a dialect, with its shipped post file.
pub fn program_for(dialect: &str, program: &Program) -> Program {
    Program { machine: machine_for(dialect, &program.machine), ..with_post(dialect, program) }
}

/// A program with the shipped post file of a dialect.
pub fn with_post(dialect: &str, program: &Program) -> Program {
    Program { post: shipped_post(dialect).unwrap(), ..program.clone() }
}

/// A tool with a cylindrical shank and a slim collet holder.
pub fn tool(name: &str, number: u32, cutter: Cutter, flute: f64, reach: f64) -> Tool {
    let radius = cutter.radius_at(flute);
    // Over its ball a lollipop has no radius.
    let cutting = if radius > 0.0 { radius } else { cutter.nominal_radius() };
    let section = |from: f64, to: f64, a: f64, b: f64| Section { from, to, radius_from: a, radius_to: b };
    Tool {
        name: name.to_owned(),
        number,
        flutes: 4,
        max_chip: Mm(0.06 * cutting),
        max_depth: Mm(1e6),
        max_rate: None,
        plunge_width: Some(Mm(radius)),
        ramp: Rad(std::f64::consts::FRAC_PI_2),
        ramp_stated: true,
        solid: ToolSolid {
            cutter,
            flute_length: flute,
            shank: vec![section(flute, reach, radius, radius)],
            holder: vec![section(reach, reach + 20.0, 8.0, 11.0), section(reach + 20.0, reach + 60.0, 16.0, 20.0)],
        },
        span: Span::default(),
    }
}

/// An operation; settings that matter are those of the paper's table 3.
pub fn operation(name: &str, kind: OperationKind, tool: ToolId, sectors: Vec<u32>, lead: f64) -> Operation {
    Operation {
        name: name.to_owned(),
        kind,
        tool,
        speed: Rpm(8000.0),
        feed: MmPerMin(250.0),
        link_feed: MmPerMin(2000.0),
        sectors,
        lead_in: Mm(lead),
        lead_out: Mm(lead),
        rest: None,
        span: Span::default(),
    }
}

/// Finishing of channels with evenly spaced lines, all in one direction, with the scallop height in mm.
pub fn channel(scallop: f64) -> OperationKind {
    let (spacing, lines, method) = (Spacing::EqualDivision, Lines::OneWay, AxisMethod::Blend);
    OperationKind::Channel { scallop: Mm(scallop), spacing, lines, method, allowance_vane: None }
}

/// Leave for finishing to cut deep slots, for tests that plan it without the roughing before it.
pub fn deep_slots() -> Allowed {
    let reason = "nothing roughs before".to_owned();
    Allowed { kind: ContractKind::Slot, scope: Scope::default(), reason, span: Span::default() }
}

/// The paper's part with roughing and finishing on the given sectors.
pub fn wei_program(sectors: &[u32]) -> Program {
    let part = wei_part(Some(3.0));
    let mut tools = PrimaryMap::new();
    let t1: ToolId = tools.push(tool("t1", 1, Cutter::flat(4.0), 30.0, 45.0));
    let t2: ToolId = tools.push(tool("t2", 2, Cutter::ball(3.0), 30.0, 42.0));
    let mut operations: PrimaryMap<OperationId, Operation> = PrimaryMap::new();
    let (vane, hub) = (VaneAllowance::even(Mm(0.2)), Mm(0.5));
    let roughing = |strategy| OperationKind::Roughing { allowances: Allowances { vane, hub }, strategy };
    let groove = |depth: f64| roughing(RoughingStrategy::Groove { depth: Mm(depth) });
    let expand =
        |depth: f64, residual: f64| roughing(RoughingStrategy::Expand { depth: Mm(depth), residual: Mm(residual) });
    let sectors = sectors.to_vec();
    operations.push(operation("groove", groove(3.0), t1, sectors.clone(), 12.0));
    operations.push(operation("expand", expand(3.0, 1.4), t1, sectors.clone(), 12.0));
    operations.push(operation("groove2", groove(1.5), t2, sectors.clone(), 12.0));
    operations.push(operation("expand2", expand(1.5, 0.4), t2, sectors.clone(), 12.0));
    let faces = BladeId::MAIN.faces().to_vec();
    operations.push(operation(
        "flank",
        OperationKind::Flank { faces, flank: Flank::by_ruling(FlankMethod::TwoPoint, 6) },
        t2,
        sectors.clone(),
        15.0,
    ));
    operations.push(operation("channel", channel(0.01), t2, sectors, 8.0));
    Program {
        name: "wei2021".to_owned(),
        name_span: Span::default(),
        stock: Stock::turned(&part, Mm(0.0), Mm(5.0), Mm(-40.0)),
        part,
        tools,
        operations,
        contracts: Vec::new(),
        allowed: vec![deep_slots()],
        machine: machine(),
        post: shipped_post("siemens-840d").unwrap(),
        tolerances: Tolerances { chord: Mm(0.001), chord_rough: Mm(0.05) },
        clearance: Mm(0.5),
        data: wei_data(),
        stated: Vec::new(),
        imported: None,
        memory: DEFAULT_MEMORY,
    }
}

/// Finishing of the faces only, on the given sectors.
pub fn flank_only(sectors: &[u32]) -> Program {
    let mut program = wei_program(sectors);
    let tool = program.operations.iter().last().unwrap().1.tool;
    program.operations = PrimaryMap::new();
    let faces = BladeId::MAIN.faces().to_vec();
    let kind = OperationKind::Flank { faces, flank: Flank::by_ruling(FlankMethod::TwoPoint, 2) };
    program.operations.push(operation("flank", kind, tool, sectors.to_vec(), 15.0));
    program
}

/// Finishing of one channel alone.
pub fn channel_only(scallop: f64) -> Program {
    let mut program = wei_program(&[0]);
    let tool = program.operations.iter().last().unwrap().1.tool;
    program.operations = PrimaryMap::new();
    program.operations.push(operation("channel", channel(scallop), tool, vec![0], 8.0));
    program
}

/// Points (r, z) of the meridians of hub and shroud.
pub struct Heights([Vec<Vector2<f64>>; 2]);

impl Heights {
    /// Both meridians in many equal steps.
    pub fn new(part: &Part) -> Self {
        const STEPS: u32 = 4000;
        let share = |i| f64::from(i) / f64::from(STEPS);
        Self([&part.hub, &part.shroud].map(|s| (0..=STEPS).map(|i| s.meridian(share(i)).point).collect()))
    }

    /// Share of the height at a point, by brute force over all points: 0 on the hub, 1 on the shroud.
    pub fn at(&self, p: &Point3<f64>) -> f64 {
        let at = Vector2::new(p.x.hypot(p.y), p.z);
        let least = |points: &Vec<Vector2<f64>>| points.iter().map(|q| (q - at).norm()).fold(f64::INFINITY, f64::min);
        let [hub, shroud] = self.0.each_ref().map(least);
        hub / (hub + shroud)
    }
}
