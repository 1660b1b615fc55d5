//! The operation `plunge`: what its item means, and its strokes against points of a grid, which the tool meets one after the
//! other. The points share only the positions of the tool with the stocks of planner and verifier.

use crate::support;
use impellerc::base::entity::PrimaryMap;
use impellerc::base::progress::Progress;
use impellerc::base::source::SourceMap;
use impellerc::base::units::Mm;
use impellerc::diagnostics::{Severity, Sink, codes};
use impellerc::driver::{self, Options, Outcome, Stages};
use impellerc::ir::{JointMove, Motion, MotionOperation, MoveKind, Program, Tool};
use impellerc::job::model::OperationSpec;
use impellerc::job::{self, InMemory};
use impellerc::plan::passes::pipeline;
use impellerc::syntax;
use impellerc::tool_stock::collide::{Cutter, ToolSolid};
use impellerc::verify::stock::{OperationStock, Settings, report, simulate};
use impellerc::wheel::operation::{Allowances, OperationKind, RoughingStrategy};
use impellerc::wheel::part::{Surface, TurnedProfile};
use nalgebra::{Point3, Vector3};
use std::sync::LazyLock;

const JOB: &str = include_str!("../../jobs/small/plunge.imp");

/// Plunge widths of the tools, and the operations.
type Read = (Vec<Option<Mm>>, Vec<OperationSpec>);

/// Tools and operations of the job with a text replaced, or the codes of its faults.
fn read(from: &str, to: &str) -> Result<Read, Vec<&'static str>> {
    assert!(JOB.contains(from), "{from}");
    let mut files = InMemory::default();
    files.curves.insert("vane_curves.csv".to_owned(), include_str!("../../jobs/small/vane_curves.csv").to_owned());
    let (mut sources, mut sink) = (SourceMap::default(), Sink::default());
    let text = JOB.replacen(from, to, 1);
    let source = sources.add("plunge.imp", &text);
    let ast = syntax::parse(&text, source, &mut sink);
    let partial = job::understand(&ast, &mut files, &mut sources, &mut sink);
    let found = partial.job().map(|job| (job.tools.iter().map(|t| t.plunge_width()).collect(), job.operations));
    found.ok_or_else(|| sink.diags().iter().map(|d| d.code.id()).collect())
}

#[test]
fn step_and_width_follow_from_the_tool() {
    for (tool, width, step) in [
        ("flat { diameter 2 mm", 0.5, 0.5),
        ("flat { diameter 2 mm  plunge-width 0.3 mm", 0.3, 0.3),
        ("flat { diameter 2 mm  plunge-width 1 mm", 1.0, 0.5),
        ("bull { diameter 2 mm  corner 0.2 mm", 0.6, 0.4),
        ("ball { diameter 2 mm", 1.0, 0.5),
    ] {
        let (widths, operations) = read("flat { diameter 2 mm", tool).unwrap();
        let Some(RoughingStrategy::Plunge { stepover }) = operations[0].kind.strategy() else { panic!("{tool}") };
        let found = [widths[0].unwrap().get(), stepover.get()];
        assert!((found[0] - width).abs() < 1e-12 && (found[1] - step).abs() < 1e-12, "{tool}: {found:?}");
        assert!(operations[0].kind.roughing().is_some() && operations[0].kind.step_down().is_none());
    }
    let centre = "plunge-width 1 mm  flutes 4  flute 12 mm  reach 25 mm  holder \"er16-mini\" }\n\noperation plunge { stepover 0.9 mm";
    let tool = "flutes 4  flute 12 mm  reach 25 mm  holder \"er16-mini\" }\n\noperation plunge {";
    assert!(read(tool, centre).is_ok());
}

#[test]
fn faults_of_the_item_are_named() {
    for (from, to, code) in [
        ("feed 300 mm/min", "feed 300 mm/min  stepover 0.6 mm", codes::job::PLUNGE),
        ("flat { diameter 2 mm", "bull { diameter 2 mm  corner 0.5 mm  plunge-width 0.5 mm", codes::job::PLUNGE),
        ("flat { diameter 2 mm", "ball { diameter 2 mm  plunge-width 0.9 mm", codes::job::PLUNGE),
        ("flat { diameter 2 mm", "flat { diameter 2 mm  plunge-width 1.1 mm", codes::job::OUT_OF_RANGE),
        ("flat { diameter 2 mm", "lollipop { neck 1 mm  diameter 2 mm", codes::job::WRONG_TOOL),
        (
            "flat { diameter 2 mm",
            "tapered-ball { angle 3 deg  plunge-width 1 mm  diameter 2 mm",
            codes::job::UNKNOWN_PROPERTY,
        ),
        ("feed 300 mm/min", "feed 300 mm/min  stepover 1.5 mm", codes::job::OUT_OF_RANGE),
        ("feed 300 mm/min", "feed 300 mm/min  stepover 2", codes::job::NO_UNIT),
        ("feed 300 mm/min", "feed 300 mm/min  depth 2 mm", codes::job::UNKNOWN_PROPERTY),
        ("feed 300 mm/min", "feed 300 mm/min  rest over 0.1 mm", codes::job::NO_REST_BEFORE),
        ("  allowance vane 0.2 mm, hub 0.4 mm\n", "", codes::job::MISSING_PROPERTY),
        ("feed 300 mm/min", "feed 3000 mm/min", codes::job::CHIP),
    ] {
        let found = read(from, to).map(|o| o.1.len());
        assert!(found.as_ref().is_err_and(|f| f.contains(&code.id())), "{to}: {found:?}");
    }
}

/// A tool that goes down along its axis beside a wall and in full material: what the verifier says of it.
#[test]
fn strokes_have_an_arc_about_the_axis_and_a_radial_width() {
    const RADIUS: f64 = 2.0;
    for (tilt, step, cell) in [(0.0, 0.5, 0.05), (0.3, 0.5, 0.05), (0.3, 1.0, 0.1), (0.0, 1.4, 0.1)] {
        let program = block(RADIUS, 1.4);
        let found = stroke_beside_a_slot(&program, tilt, step, cell);
        // The circle of the stroke outside of the circles that have moved up to it, a step away: a lune over
        // 2 acos(-s / 2R) when one circle stands there.
        let arc = 2.0 * (-0.5 * step / RADIUS).acos().to_degrees();
        let (shown, bound) = (found.arc.unwrap().value.get(), found.arc_bound.unwrap().value.get());
        assert!(shown <= arc + 0.01 && arc <= bound && shown > arc - 25.0, "{tilt} {step}: {shown} {arc} {bound}");
        let width = found.width.unwrap().value.get();
        assert!(width <= step + 0.01 && width > step - 2.0 * cell, "{width}");
        // A stroke has no depth that `max-depth` could judge.
        assert!(found.slot_depth.is_none() && found.depth.is_none());
        assert!(found.middle.is_none_or(|m| m.value.get() < 0.01), "{:?}", found.middle);
    }
    // Of full material the middle of the end meets all.
    let program = block(RADIUS, 1.4);
    let motion = strokes(&program, 0.1, &[0.0]);
    let (found, codes) = judged(&program, &motion, 0.1);
    assert!((found.middle.unwrap().value.get() - 0.6).abs() < 0.08, "{:?}", found.middle);
    assert!(found.arc.unwrap().value.get() > 340.0 && found.width.unwrap().value.get() > 1.9);
    assert!(codes.contains(&codes::verification::TOOL_LOAD.id()), "{codes:?}");
    // A tool that cuts at its centre may do that, and one that moves in by its width.
    let (_, codes) = judged(&block(RADIUS, RADIUS), &motion, 0.1);
    assert!(!codes.contains(&codes::verification::TOOL_LOAD.id()), "{codes:?}");
    let (found, codes) = judged(&program, &strokes(&program, 0.1, &[8.0, 6.7, 5.4, 4.1, 2.8, 1.5]), 0.1);
    assert!(!codes.contains(&codes::verification::TOOL_LOAD.id()), "{codes:?} {:?}", found.middle);
    let (_, codes) = judged(&program, &strokes(&program, 0.1, &[8.0, 6.7, 5.4, 3.8, 2.5]), 0.1);
    assert!(codes.contains(&codes::verification::TOOL_LOAD.id()), "{codes:?}");
}

/// A cylinder of material about Z, 12 mm across and 8 mm high, and a flat tool.
pub(crate) fn block(radius: f64, plunge_width: f64) -> Program {
    let mut program = support::channel_only(0.01);
    let solid = ToolSolid { cutter: Cutter::flat(radius), flute_length: 30.0, shank: Vec::new(), holder: Vec::new() };
    let mut tools = PrimaryMap::new();
    for (_, tool) in program.tools.iter() {
        tools.push(Tool {
            solid: solid.clone(),
            plunge_width: Some(Mm(plunge_width)),
            max_chip: Mm(1e6),
            ..tool.clone()
        });
    }
    program.stock.profile = TurnedProfile::new(vec![[0.0, -8.0], [6.0, -8.0], [6.0, 0.0], [0.0, 0.0]]);
    program.contracts.clear();
    let strategy = RoughingStrategy::Plunge { stepover: Mm(1.0) };
    let kind = OperationKind::Roughing { allowances: Allowances::NONE, strategy };
    let tool = tools.ids().next().unwrap();
    program.operations = PrimaryMap::new();
    program.operations.push(support::operation("plunge", kind, tool, vec![0], 1.0));
    Program { tools, machine: support::machine(), ..program }
}

/// Strokes along an axis that tilts, at these distances from the middle of the block, down to 4 mm below its top.
fn strokes(program: &Program, tilt: f64, places: &[f64]) -> Motion {
    let axis = program.machine.chain.tool_axis([tilt, 0.0]);
    let across = axis.cross(&Vector3::x()).normalize();
    let at = |place: f64, height: f64| {
        program.machine.joints(&(Point3::new(0.0, 0.0, -4.0) + across * place + axis * height), [tilt, 0.0])
    };
    let mut moves = Vec::new();
    for place in places {
        for (kind, height) in [(MoveKind::Rapid, 12.0), (MoveKind::Cut, 0.0), (MoveKind::Rapid, 12.0)] {
            let joints = at(*place, height);
            moves.push(JointMove { kind, joints, feed: Some(1.0), time: 1.0, pass: 0, stop: false });
        }
    }
    of_one_operation(program, moves)
}

pub(crate) fn of_one_operation(program: &Program, moves: Vec<JointMove>) -> Motion {
    let operation = program.operations.ids().next().unwrap();
    Motion { operations: vec![MotionOperation { operation, labels: vec![String::new()], moves, splines: Vec::new() }] }
}

/// A stroke a step beside another, inside of the block. The first one is at rapid in a block that is open there: it comes
/// first, as an operation of its own.
fn stroke_beside_a_slot(program: &Program, tilt: f64, step: f64, cell: f64) -> OperationStock {
    let first = strokes(program, tilt, &[0.0]).operations.swap_remove(0);
    let second = strokes(program, tilt, &[step]).operations.swap_remove(0);
    let motion = Motion { operations: vec![first, second] };
    let mut settings = Settings { cell: Some(cell), ..Settings::default() };
    let found = simulate(program, &motion, &mut settings, &Progress::default(), &mut Sink::default());
    found.expect("a stock").operations.swap_remove(1)
}

/// What the verifier says of the stock of a motion: its first operation, and the codes of its errors.
pub(crate) fn judged(program: &Program, motion: &Motion, cell: f64) -> (OperationStock, Vec<&'static str>) {
    let (found, findings) = findings(program, motion, cell);
    (found, findings.into_iter().filter(|f| f.0 == Severity::Error).map(|f| f.1).collect())
}

/// The same with all findings.
pub(crate) fn findings(
    program: &Program,
    motion: &Motion,
    cell: f64,
) -> (OperationStock, Vec<(Severity, &'static str)>) {
    let (mut settings, mut sink) = (Settings { cell: Some(cell), ..Settings::default() }, Sink::default());
    let found = simulate(program, motion, &mut settings, &Progress::default(), &mut sink).expect("a stock");
    report(program, motion, &found, &mut sink);
    (found.operations[0].clone(), sink.diags().iter().map(|d| (d.severity, d.code.id())).collect())
}

/// The job of the language, planned.
static PLANNED: LazyLock<(Program, Motion)> = LazyLock::new(|| planned(JOB, &[]));

/// A job of the small impeller with texts replaced, planned.
pub(crate) fn planned(job: &str, changes: &[(&str, &str)]) -> (Program, Motion) {
    let text = changes.iter().fold(job.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from} is not in the job");
        text.replace(from, to)
    });
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plunge.imp");
    std::fs::write(&path, text).unwrap();
    std::fs::copy("jobs/small/vane_curves.csv", folder.path().join("vane_curves.csv")).unwrap();
    let options = Options { job: path, ..Options::default() };
    let program = driver::front(&options, &mut Stages::default(), &mut Outcome::default()).unwrap().unwrap();
    let motion = pipeline::run(&program, &mut Sink::default()).expect("a plan").motion;
    (program, motion)
}

/// Points of the blank in cubes, and whether each is still material.
pub(crate) struct Points {
    step: f64,
    low: [f64; 3],
    count: [usize; 3],
    material: Vec<bool>,
}

impl Points {
    /// The points of the blank within 2 mm of the tips at feed.
    pub(crate) fn new(program: &Program, motion: &Motion, step: f64) -> Self {
        let moves = motion.operations.iter().flat_map(|o| &o.moves).filter(|m| m.kind == MoveKind::Cut);
        let tips: Vec<Point3<f64>> = moves.map(|m| program.machine.forward(&m.joints).tip).collect();
        let low = [0, 1, 2].map(|k| tips.iter().map(|t| t[k]).fold(f64::INFINITY, f64::min) - 2.0);
        let high = [0, 1, 2].map(|k| tips.iter().map(|t| t[k]).fold(f64::NEG_INFINITY, f64::max) + 2.0);
        let count = [0, 1, 2].map(|k: usize| ((high[k] - low[k]) / step) as usize + 1);
        let mut points = Self { step, low, count, material: vec![true; count.iter().product()] };
        let mut n = 0;
        while n < points.material.len() {
            let p = points.at(n);
            let distance = program.stock.profile.distance([p.x.hypot(p.y), p.z]);
            // The next points of the row that are nearer than the surface lie on the same side of it.
            let row_end = n - n % count[0] + count[0];
            let end = (n + 1 + (distance.abs() / step) as usize).min(row_end);
            points.material[n..end].fill(distance < 0.0);
            n = end;
        }
        points
    }

    fn at(&self, n: usize) -> Point3<f64> {
        let k = [n % self.count[0], n / self.count[0] % self.count[1], n / self.count[0] / self.count[1]];
        let [x, y, z] = [0, 1, 2].map(|a: usize| self.low[a] + self.step * k[a] as f64);
        Point3::new(x, y, z)
    }

    /// Removes the points of which a test says that they are inside of a cylinder between two points, and returns them.
    fn remove(
        &mut self,
        ends: [Point3<f64>; 2],
        radius: f64,
        inside: impl Fn(&Point3<f64>) -> bool,
    ) -> Vec<Point3<f64>> {
        let range = [1, 2].map(|k: usize| {
            let ends = [ends[0][k].min(ends[1][k]) - radius, ends[0][k].max(ends[1][k]) + radius];
            self.along(k, ends)
        });
        let axis = (ends[1] - ends[0]).normalize();
        let mut removed = Vec::new();
        for z in range[1].clone() {
            for y in range[0].clone() {
                let row = (z * self.count[1] + y) * self.count[0];
                // Where the row is inside of the endless cylinder: its distance from the axis squared is a parabola.
                let from = self.at(row) - ends[0];
                let (off, slope) = (from - axis * from.dot(&axis), Vector3::x() - axis * axis.x);
                let (square, half, rest) =
                    (slope.norm_squared(), slope.dot(&off), off.norm_squared() - radius * radius);
                let root = half * half - square * rest;
                if root < 0.0 {
                    continue;
                }
                let (middle, wide) = (self.low[0] - half / square, root.sqrt() / square);
                for n in self.along(0, [middle - wide, middle + wide]).map(|x| row + x) {
                    if self.material[n] && inside(&self.at(n)) {
                        self.material[n] = false;
                        removed.push(self.at(n));
                    }
                }
            }
        }
        removed
    }

    /// The points along an axis between two coordinates, and one beside each.
    fn along(&self, axis: usize, ends: [f64; 2]) -> std::ops::RangeInclusive<usize> {
        let place = |x: f64| ((x - self.low[axis]) / self.step).clamp(0.0, self.count[axis] as f64 - 1.0);
        place(ends[0]) as usize..=place(ends[1]).ceil() as usize
    }
}

/// What a flat tool does to the points.
#[derive(Debug, Default)]
pub(crate) struct Cutting {
    points: usize,
    /// How far removed points lie inside of the middle of the end, in strokes down along the axis and more than a layer
    /// above their end, mm.
    pub(crate) into_middle: f64,
    /// Strokes down along the axis.
    pub(crate) strokes: usize,
}

/// Sends the flat tool of a program through the points; `middle` is the radius of the middle of its end.
pub(crate) fn cut(points: &mut Points, program: &Program, motion: &Motion, middle: f64) -> Cutting {
    const LAYER: f64 = 0.06;
    let mut found = Cutting::default();
    for operation in &motion.operations {
        let solid = &program.tools[program.operations[operation.operation].tool].solid;
        let (radius, flute) = (solid.radius(), solid.flute_length);
        for pair in operation.moves.windows(2).filter(|pair| pair[1].kind != MoveKind::Rapid) {
            let ends = [0, 1].map(|k: usize| program.machine.forward(&pair[k].joints).tip);
            let rotary = [0, 1].map(|k: usize| pair[k].joints.rotary);
            let axis_at = |t: f64| {
                program.machine.chain.tool_axis([0, 1].map(|k| rotary[0][k] + (rotary[1][k] - rotary[0][k]) * t))
            };
            let way = ends[1] - ends[0];
            let axis = axis_at(1.0);
            let down =
                (axis_at(0.0) - axis).norm() < 1e-6 && way.norm() > 0.0 && axis.dot(&way) < -0.999_999 * way.norm();
            // A stroke sweeps a cylinder from its end up; other moves are looked at in small steps.
            let count = if down {
                1
            } else {
                ((way.norm() + 12.0 * (axis_at(0.0) - axis).norm()) / 0.1).ceil().max(1.0) as usize
            };
            found.strokes += usize::from(down);
            for k in 1..=count {
                let t = k as f64 / count as f64;
                let (tip, axis) = (ends[0] + way * t, axis_at(t));
                let long = flute + if down { way.norm() } else { 0.0 };
                let seen = |p: &Point3<f64>| {
                    let d = p - tip;
                    let s = d.dot(&axis);
                    ((d - axis * s).norm(), s)
                };
                let inside = |p: &Point3<f64>| {
                    let (rho, s) = seen(p);
                    rho < radius && (0.0..long).contains(&s)
                };
                let removed = points.remove([tip, tip + axis * long], radius, inside);
                found.points += removed.len();
                for p in removed.iter().filter(|_| down) {
                    let (rho, s) = seen(p);
                    if s > LAYER {
                        found.into_middle = found.into_middle.max(middle - rho);
                    }
                }
            }
        }
    }
    found
}

/// The strokes clear the middle of the channel down to the allowance of the hub, as much as the verifier says, and never
/// take the middle of the end into material.
#[test]
fn strokes_clear_the_channel_with_their_teeth() {
    const STEP: f64 = 0.15;
    let (program, motion) = &*PLANNED;
    let mut points = Points::new(program, motion, STEP);
    let found = cut(&mut points, program, motion, 0.5);
    assert!(found.strokes > 400, "{found:?}");
    assert!(found.into_middle < 0.05, "{found:?}");
    let mut settings = Settings { cell: Some(0.3), ..Settings::default() };
    let stock = simulate(program, motion, &mut settings, &Progress::default(), &mut Sink::default()).unwrap();
    let (volume, removed) = (found.points as f64 * STEP.powi(3), stock.operations[0].removed.get());
    assert!((volume - removed).abs() < 0.02 * removed, "{volume} {removed}");
    // In the middle between the walls, from half a millimetre over the allowance of the hub up.
    let part = &program.part;
    let walls = part.first_passage().walls.map(|wall| &part.face(wall).surface);
    let next = part.sector_rotation(1);
    let (mut cleared, mut left) = (0, Vec::new());
    for k in 1..40 {
        let u = f64::from(k) / 40.0;
        let [root, tip] = [0.0, 1.0].map(|v| nalgebra::center(&walls[0].point(u, v), &(next * walls[1].point(u, v))));
        for n in 0..=20 {
            let p = root + (tip - root) * (0.99 * f64::from(n) / 20.0);
            if part.hub.distance(&p) < 0.4 + 0.5 || program.stock.profile.distance([p.x.hypot(p.y), p.z]) > 0.0 {
                continue;
            }
            let near = [0, 1, 2].map(|a: usize| ((p[a] - points.low[a]) / STEP).round() as usize);
            if points.material[(near[2] * points.count[1] + near[1]) * points.count[0] + near[0]] {
                left.push((u, n));
            } else {
                cleared += 1;
            }
        }
    }
    assert!(left.is_empty() && cleared > 300, "{cleared} {left:?}");
}

/// A tool whose teeth cut only half of each step takes its middle into material: the points and the verifier see it.
#[test]
fn too_wide_steps_take_the_middle_into_material() {
    let centre = ("flat { diameter 2 mm", "flat { diameter 2 mm  plunge-width 1 mm");
    let wide = ("feed 300 mm/min", "feed 300 mm/min  stepover 0.9 mm");
    let (mut program, motion) = planned(JOB, &[centre, wide]);
    let mut points = Points::new(&program, &motion, 0.2);
    let found = cut(&mut points, &program, &motion, 0.6);
    assert!(found.into_middle > 0.3, "{found:?}");
    // A tool that cuts at its centre needs fewer strokes.
    let strokes = |program: &Program, motion: &Motion| {
        let mut points = Points::new(program, motion, 1.0);
        cut(&mut points, program, motion, 0.0).strokes
    };
    assert!(2 * strokes(&program, &motion) < strokes(&PLANNED.0, &PLANNED.1));
    let (_, codes) = judged(&program, &motion, 0.3);
    assert!(codes.is_empty(), "{codes:?}");
    let mut tools = PrimaryMap::new();
    for (_, tool) in program.tools.iter() {
        tools.push(Tool { plunge_width: Some(Mm(0.4)), ..tool.clone() });
    }
    program.tools = tools;
    let (_, codes) = judged(&program, &motion, 0.3);
    assert_eq!(codes, [codes::verification::TOOL_LOAD.id()]);
}

/// At the lower ends of all strokes the tool keeps its allowances from points of vanes and hub.
#[test]
fn strokes_keep_the_allowances() {
    let (program, motion) = &*PLANNED;
    let part = &program.part;
    let walls = part.first_passage().walls.map(|wall| &part.face(wall).surface);
    let turns = [part.sector_rotation(0), part.sector_rotation(1)];
    let mut vane = Vec::new();
    for (wall, turn) in walls.iter().zip(turns) {
        for (i, j) in (0..=60).flat_map(|i| (0..=20).map(move |j| (i, j))) {
            vane.push(turn * wall.point(f64::from(i) / 60.0, f64::from(j) / 20.0));
        }
    }
    let (mut least, mut lowest, mut ends) = (f64::INFINITY, f64::INFINITY, 0);
    for operation in &motion.operations {
        for pair in operation.moves.windows(2).filter(|pair| pair[1].kind == MoveKind::Cut) {
            for t in [0.5, 1.0] {
                let [a, b] = [0, 1].map(|k: usize| program.machine.forward(&pair[k].joints).tip);
                let tip = a + (b - a) * t;
                let axis = program.machine.chain.tool_axis(pair[1].joints.rotary);
                ends += 1;
                for p in &vane {
                    let d = p - tip;
                    let s = d.dot(&axis);
                    let out = [(d - axis * s).norm() - 1.0, -s];
                    let distance = if s > 12.0 {
                        f64::INFINITY
                    } else if out[0] > 0.0 && out[1] > 0.0 {
                        out[0].hypot(out[1])
                    } else {
                        out[0].max(out[1])
                    };
                    least = least.min(distance);
                }
                // The rim is nowhere nearer to the hub than its middle less its radius.
                if part.hub.distance(&tip) - 1.0 > lowest {
                    continue;
                }
                let side = axis.cross(&Vector3::x()).normalize();
                let beside = axis.cross(&side);
                for k in 0..24 {
                    let angle = std::f64::consts::TAU * f64::from(k) / 24.0;
                    let rim = tip + side * angle.cos() + beside * angle.sin();
                    // Beyond the outlet there is no hub.
                    if rim.x.hypot(rim.y) < part.hub.meridian(1.0).point.x && rim.z < part.hub.meridian(0.0).point.y {
                        lowest = lowest.min(part.hub.distance(&rim));
                    }
                }
            }
        }
    }
    assert!(ends > 1000 && least < 0.5, "{ends} {least}");
    assert!(least >= 0.2 && lowest >= 0.4, "{least} {lowest}");
    assert!(lowest < 0.6, "{lowest}");
}
