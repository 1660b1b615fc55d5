//! Rest machining: an operation cuts only where earlier operations left stock.

use crate::support::{self, jobs};
use impellerc::base::entity::PrimaryMap;
use impellerc::base::progress::Progress;
use impellerc::base::units::Mm;
use impellerc::diagnostics::{Sink, codes};
use impellerc::ir::{ClPass, ClPlan, MoveKind, Operation, Program, ToolId};
use impellerc::plan::passes::pipeline::{self, Plan};
use impellerc::plan::passes::{MotionBound, Obstacles, rest_machining};
use impellerc::tool_stock::collide::tool::tool_coordinates;
use impellerc::tool_stock::collide::{Cutter, Section};
use impellerc::verify::stock::{Settings, StockReport, simulate};
use impellerc::wheel::operation::{Allowances, VaneAllowance};
use impellerc::wheel::part::{PassageId, Sample, Surface, SurfaceKind, sample};
use nalgebra::Point3;

/// Thickness of all tests, mm.
const THICKNESS: f64 = 0.05;

/// Lead-in and lead-out, mm.
const LEAD: f64 = 8.0;

/// Steps in which the pass looks at a way, mm.
const STEP: f64 = 1.0;

/// The paper's part with channel finishing by one tool, twice.
fn finished_twice(tool: impellerc::ir::Tool, sectors: [&[u32]; 2], rest: Option<f64>) -> Program {
    let mut program = support::wei_program(&[0]);
    (program.tools, program.operations) = (PrimaryMap::new(), PrimaryMap::new());
    let tool: ToolId = program.tools.push(tool);
    for (name, sectors) in ["channel", "channel2"].into_iter().zip(sectors) {
        program.operations.push(support::operation(name, support::channel(0.2), tool, sectors.to_vec(), LEAD));
    }
    with_rest(program, "channel2", rest)
}

/// The program with rest machining in one operation.
fn with_rest(mut program: Program, name: &str, rest: Option<f64>) -> Program {
    let mut operations = PrimaryMap::new();
    for (_, o) in program.operations.iter() {
        let rest = if o.name == name { rest.map(Mm) } else { o.rest };
        operations.push(Operation { rest, ..o.clone() });
    }
    program.operations = operations;
    program
}

fn ball() -> impellerc::ir::Tool {
    support::tool("t1", 1, Cutter::ball(3.0), 30.0, 42.0)
}

fn planned(program: &Program) -> Plan {
    let mut sink = Sink::default();
    pipeline::run(program, &mut sink).unwrap_or_else(|_| panic!("no plan: {:?}", sink.diags()))
}

fn simulated(program: &Program, plan: &Plan) -> StockReport {
    let mut settings = Settings { cell: Some(0.7), ..Settings::default() };
    simulate(program, &plan.motion, &mut settings, &Progress::default(), &mut Sink::default()).expect("a stock")
}

fn length<'a>(passes: impl IntoIterator<Item = &'a ClPass>) -> f64 {
    let way = |p: &ClPass| p.points.windows(2).map(|w| (w[1].tip - w[0].tip).norm()).sum::<f64>();
    passes.into_iter().map(way).sum()
}

/// Area of the hub between two vanes, mm2.
fn floor(program: &Program) -> f64 {
    let samples = sample::sample(&program.part, 1.0);
    let hub = samples.iter().filter(|s| s.surface.kind == SurfaceKind::Hub(PassageId::FIRST)).count() as f64;
    hub / f64::from(program.part.vane_count)
}

#[test]
fn a_repeated_operation_disappears_where_it_was_done() {
    let sectors: [&[u32]; 2] = [&[0], &[0, 1]];
    let (whole, rest) = (finished_twice(ball(), sectors, None), finished_twice(ball(), sectors, Some(THICKNESS)));
    let (all, less) = (planned(&whole), planned(&rest));
    let of = |plan: &Plan, sector: u32| length(plan.cl.operations[1].passes.iter().filter(|p| p.sector == sector));
    let [done, fresh] = [0, 1].map(|s| [of(&all, s), of(&less, s)]);
    println!("sector 1: {done:?} mm, sector 2: {fresh:?} mm; {:?}", less.cl.operations[1].notes);
    // Without rest machining both sectors are run whole, with it only the second one.
    assert!(done[0] > 1000.0 && done[1] < 0.01 * done[0], "{done:?}");
    assert!((fresh[1] / fresh[0] - 1.0).abs() < 0.02, "{fresh:?}");
    // The first operation is what it was.
    assert_eq!(length(&all.cl.operations[0].passes), length(&less.cl.operations[0].passes));
    let volumes = [simulated(&whole, &all), simulated(&rest, &less)].map(|s| s.rest().get());
    let bound = THICKNESS * floor(&whole);
    println!("rest {volumes:?} mm3, bound {bound:.1} mm3");
    // Cuts in air were taken away, not those in stock.
    assert!(volumes[1] >= volumes[0] - 1e-6 && volumes[1] - volumes[0] < 0.1 * bound, "{volumes:?}");
}

#[test]
fn nothing_left_to_do_is_a_warning_that_says_so() {
    let program = finished_twice(ball(), [&[0], &[0]], Some(THICKNESS));
    let mut sink = Sink::default();
    let plan = pipeline::run(&program, &mut sink).unwrap();
    // The tool is changed, and stays over the part.
    assert!(plan.cl.operations[1].passes.is_empty());
    assert!(plan.motion.operations[1].moves.iter().all(|m| m.kind == MoveKind::Rapid) && !sink.has_errors());
    assert_eq!(pipeline::needless(&program, &Progress::default(), &mut Sink::default()).unwrap().len(), 1);
    let found: Vec<_> = sink.diags().iter().map(|d| d.code).collect();
    assert_eq!(found, [codes::planning::NO_REST]);
    assert!(sink.diags()[0].message.contains("`channel2`") && sink.diags()[0].help.is_some());
}

/// The passes of the first operation up to a radius about Z, those of the second as planned.
fn half_cut(program: &Program, radius: f64) -> ClPlan {
    let mut cl = planned(program).cl;
    for pass in &mut cl.operations[0].passes {
        let inside = |p: &Point3<f64>| p.x.hypot(p.y) < radius;
        pass.points.retain(|p| p.contact.is_some_and(|c| inside(&c)));
    }
    cl
}

#[test]
fn a_half_cut_floor_is_cut_on_from_where_it_ends() {
    let program = finished_twice(ball(), [&[0], &[0]], None);
    let cl = half_cut(&program, 40.0);
    let program = with_rest(program, "channel2", Some(THICKNESS));
    let mut less = cl.clone();
    let progress = Progress::default();
    rest_machining::run(
        &program,
        &Obstacles::new(&program.part, &program.machine),
        &mut less,
        &progress,
        &mut Sink::default(),
    )
    .unwrap();
    // All ways through the stock tell their shares, by passes.
    let told: Vec<_> = progress.all().into_iter().map(|s| (s.name.to_string(), s.done, s.total, s.open)).collect();
    let passes = [0, 1].map(|o| cl.operations[o].passes.len() as u64);
    let left = less.operations[1].passes.len() as u64;
    assert_eq!(
        told,
        [
            ("channel, rest stock".to_owned(), passes[0], passes[0], false),
            ("channel2, find rest".to_owned(), passes[1], passes[1], false),
            ("channel2, links".to_owned(), left, left, false),
        ]
    );
    let [first, second] = [&cl.operations[0].passes, &less.operations[1].passes];
    assert_eq!(second.len(), cl.operations[1].passes.len(), "each line has its other half to do");
    for ((done, left), whole) in first.iter().zip(second).zip(&cl.operations[1].passes) {
        let on_radius = |p: &Point3<f64>| p.x.hypot(p.y);
        // Lines run both ways: the inner ends.
        let inner = |pass: &ClPass, least: bool| {
            let ends = [pass.points.first().unwrap().tip, pass.points.last().unwrap().tip];
            let order = |a: &&Point3<f64>, b: &&Point3<f64>| on_radius(a).total_cmp(&on_radius(b));
            *if least { ends.iter().min_by(order) } else { ends.iter().max_by(order) }.unwrap()
        };
        let (ended, begins) = (inner(done, false), inner(left, true));
        let back = (ended - begins).norm();
        assert!(back < LEAD + 2.0 * STEP && back > 0.9 * LEAD - STEP, "{}: {back}", left.label);
        assert_eq!(inner(left, false), inner(whole, false), "{}", left.label);
    }
    println!("{:.0} mm of {:.0} mm", length(second), length(&cl.operations[1].passes));
}

/// Roughing of one channel with a smaller tool after a larger one: its first lines run where the larger one has been.
#[test]
fn links_of_what_is_left_meet_no_stock() {
    const THICKNESS: f64 = 0.2;
    let roughing = |rest: Option<f64>| {
        let mut program = support::wei_program(&[0]);
        let mut operations = PrimaryMap::new();
        for (_, o) in program.operations.iter().take(4) {
            operations.push(o.clone());
        }
        program.operations = operations;
        with_rest(program, "expand2", rest)
    };
    let (whole, rest) = (roughing(None), roughing(Some(THICKNESS)));
    let (all, less) = (planned(&whole), planned(&rest));
    let [full, thinned] = [&all, &less].map(|p| length(&p.cl.operations[3].passes));
    println!("{full:.0} mm, {thinned:.0} mm, {:?}", less.cl.operations[3].notes.last());
    assert!(thinned < 0.95 * full, "{thinned} of {full}");
    let inside = less.cl.operations[3].passes.iter().filter(|p| p.label.contains("rest")).count();
    assert!(inside >= 2, "no line is left and entered in between");
    let [before, after] = [simulated(&whole, &all), simulated(&rest, &less)].map(|s| s.operations[3].clone());
    println!("rest {} {}, by links {}", before.rest, after.rest, after.by_links.get());
    // A cut is entered where the room is free but for the thickness.
    assert!(after.by_links.get() < 0.01 * after.removed.get() && after.collisions.is_empty(), "{:?}", after.collisions);
    let left = after.rest.get() - before.rest.get();
    assert!(left >= -1e-6 && left < 0.1 * THICKNESS * floor(&whole), "{left}");
}

#[test]
fn a_tool_thinner_above_its_cutter_keeps_whole_passes() {
    let lollipop = Cutter::lollipop(3.0);
    let flute = lollipop.neck_height(2.0).unwrap();
    let mut tool = support::tool("t1", 1, lollipop, flute, 42.0);
    tool.solid.shank = vec![Section { from: flute, to: 42.0, radius_from: 2.0, radius_to: 2.0 }];
    let program = finished_twice(tool, [&[0], &[0]], None);
    let cl = half_cut(&program, 40.0);
    let program = with_rest(program, "channel2", Some(THICKNESS));
    let mut less = cl.clone();
    rest_machining::run(
        &program,
        &Obstacles::new(&program.part, &program.machine),
        &mut less,
        &Progress::default(),
        &mut Sink::default(),
    )
    .unwrap();
    let ends =
        |passes: &[ClPass]| passes.iter().map(|p| (p.points.first().copied(), p.points.last().copied())).collect();
    let [before, after]: [Vec<_>; 2] = [&cl, &less].map(|c| ends(&c.operations[1].passes));
    assert_eq!(before, after);
}

#[test]
fn the_number_of_threads_does_not_matter() {
    let program = finished_twice(ball(), [&[0], &[0, 1]], Some(THICKNESS));
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let plan = pool.install(|| planned(&program));
        format!("{:?}", (plan.cl, plan.motion))
    };
    assert!(run(1) == run(2));
}

/// A way through stock keeps the allowance on the vanes from vanes and that on the hub from the hub, whichever is larger.
/// Oracle: the distances of finer samples to a ball beside a face, over its whole height.
#[test]
fn a_way_keeps_each_allowance_from_its_own_surfaces() {
    /// The larger reserve for samples and some more: farther than that, a way is clear.
    const SURELY: f64 = 0.1;
    let program = jobs::program("rough", None);
    let obstacles = Obstacles::of(&program);
    let ball = program.tools.iter().map(|(_, tool)| &tool.solid).find(|s| s.cutter.tip_radius() > 0.0).unwrap();
    let (hub, walls): (Vec<_>, Vec<_>) =
        sample::sample(&program.part, 0.2).into_iter().partition(|s| matches!(s.surface.kind, SurfaceKind::Hub(_)));
    let face = program.part.face(program.part.first_passage().walls[0]);
    for (vane, on_hub) in [(0.5, 0.2), (0.2, 0.5)] {
        let kept = Allowances { vane: VaneAllowance::even(Mm(vane)), hub: Mm(on_hub) };
        let smaller = Allowances::even(vane.min(on_hub));
        let (mut refused, mut clear) = (0, 0);
        for (u, v, over) in (1..10).flat_map(|u| (0..10).flat_map(move |v| [0.3, 0.7].map(|over| (u, v, over)))) {
            let (u, v) = (0.1 * f64::from(u), 0.1 * f64::from(v));
            let (place, out) = (face.surface.point(u, v), face.normal(u, v));
            let axis = (face.surface.ruling(u).normalize() + out * 0.2).normalize();
            let tip = place + out * (ball.radius() + over) - axis * ball.radius();
            let keeps = |kept: Allowances| {
                let slack = |rho: f64, s: f64, allowance: f64, _: f64| ball.cutter_distance(rho, s) - allowance;
                obstacles.keeps(&tip, &axis, slack, kept, MotionBound { about: &tip, turn: 0.0, shift: 0.0 })
            };
            let least = |samples: &[Sample]| {
                let distances = samples.iter().map(|s| tool_coordinates(&s.position, &tip, &axis));
                distances.map(|(rho, s)| ball.cutter_distance(rho, s)).fold(f64::INFINITY, f64::min)
            };
            let (to_walls, to_hub) = (least(&walls), least(&hub));
            let case = format!("{u} {v} {over}: {to_walls} from the walls, {to_hub} from the hub");
            assert!(!keeps(kept) || (to_walls >= vane && to_hub >= on_hub), "{case}");
            assert!(keeps(kept) || to_walls < vane + SURELY || to_hub < on_hub + SURELY, "{case}");
            clear += usize::from(keeps(kept));
            refused += usize::from(keeps(smaller) && !keeps(kept));
        }
        println!("vane {vane}, hub {on_hub}: {clear} clear, {refused} refused that keep the smaller allowance");
        assert!(clear > 0 && refused > 0, "{clear} {refused}");
    }
}
