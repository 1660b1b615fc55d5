//! Paths of the operation `rough`: what they leave, what their links meet, and the sense of their lines.

use crate::support::Heights;
use crate::support::jobs::{self, Compiled};
use impellerc::base::entity::PrimaryMap;
use impellerc::base::progress::Progress;
use impellerc::base::units::Mm;
use impellerc::diagnostics::Sink;
use impellerc::driver::{self, Options, Outcome, Stages};
use impellerc::ir::{Allowances, Motion, MoveKind, Operation, OperationKind, Program, RoughingStrategy, Tool};
use impellerc::plan::passes::pipeline;
use impellerc::tool_stock::collide::Cloud;
use impellerc::verify::proof::sweep::Sweep;
use impellerc::verify::stock::{Settings, simulate};
use impellerc::wheel::contract::ContractKind;
use impellerc::wheel::method::{Levels, Milling};
use impellerc::wheel::operation::VaneAllowance;
use impellerc::wheel::part::sample::{Sample, cloud_points, sample};
use impellerc::wheel::part::{SurfaceClass, SurfaceKind};
use nalgebra::Point3;
use rayon::prelude::*;
use std::sync::LazyLock;

/// The shipped job in one sector, without its contract on the rest.
fn changed(change: impl Fn(&mut Operation)) -> Program {
    let mut program = jobs::program("rough", None);
    let mut operations = PrimaryMap::new();
    for (_, operation) in program.operations.iter() {
        let mut operation = Operation { sectors: vec![0], ..operation.clone() };
        change(&mut operation);
        operations.push(operation);
    }
    program.contracts.retain(|c| c.kind != ContractKind::Rest);
    program.operations = operations;
    program
}

/// One sector, planned and verified once.
static ROUGHED: LazyLock<Compiled> = LazyLock::new(|| Compiled::new(changed(|_| {})));

/// No cutter comes nearer to the finished part than the allowances, by the distances of all samples.
#[test]
fn the_allowances_are_kept() {
    let (program, motion) = ROUGHED.planned();
    let sweeps: Vec<Sweep<'_>> = (0..motion.operations.len()).filter_map(|o| Sweep::new(program, motion, o)).collect();
    let samples: Vec<Sample> = sample(&program.part, 0.5).into_iter().filter(|s| s.surface.sector == 0).collect();
    // The planner finds the free interval across the channel to about 0.02 mm.
    const FOUND_TO: f64 = 0.025;
    let (mut compared, mut missing) = (0, 0.0_f64);
    for sample in samples.iter().filter(|s| s.surface.milled()) {
        let required = if matches!(sample.surface.kind, SurfaceKind::Hub(_)) { 0.4 } else { 0.2 };
        let least =
            sweeps.iter().fold(required, |d, w| w.nearest(&sample.position, d).map_or(d, |n| n.distance.min(d)));
        assert!(least > required - FOUND_TO, "{}: {least}", sample.surface);
        missing = missing.max(required - least);
        compared += 1;
    }
    println!("{compared} samples; at worst {missing:.4} mm less than the allowance");
    assert!(compared > 300, "{compared}");
}

/// What the shipped job leaves on vanes and fillets in one sector with other allowances, by the distances of all samples
/// to the swept cutters: height of a sample, and how much more than the allowance is left there. Only samples with less
/// than 0.4 mm more count.
fn left_on_vanes(vane: VaneAllowance, hub: Mm) -> Vec<(f64, f64)> {
    let program = changed(|o| {
        if let OperationKind::Roughing { allowances, .. } = &mut o.kind {
            *allowances = Allowances { vane, hub };
        }
    });
    let motion = pipeline::run(&program, &mut Sink::default()).expect("a plan").motion;
    let sweeps: Vec<Sweep<'_>> =
        (0..motion.operations.len()).filter_map(|o| Sweep::new(&program, &motion, o)).collect();
    let on_vane = |s: &Sample| matches!(s.surface.kind, SurfaceKind::Face(_) | SurfaceKind::Fillet(_));
    let samples: Vec<Sample> = sample(&program.part, 0.4).into_iter().filter(on_vane).collect();
    let heights = Heights::new(&program.part);
    let left = samples.par_iter().filter_map(|sample| {
        let near = |d: f64, w: &Sweep<'_>| w.nearest(&sample.position, d).map_or(d, |n| n.distance.min(d));
        // The allowance of the root is the largest one: the height is needed only where a cutter comes as near.
        let most = vane.root().get() + 0.4;
        let least = Some(sweeps.iter().fold(most, near)).filter(|least| *least < most)?;
        let height = heights.at(&sample.position);
        let required = vane.root().get() - vane.growth() * height;
        (least < required + 0.4).then_some((height, least - required))
    });
    left.collect()
}

/// An allowance on the vanes that is larger than that on the hub is kept, also by the ramps: no sample of faces and fillets
/// has less.
#[test]
fn ramps_keep_the_allowance_on_the_vanes() {
    let over = left_on_vanes(VaneAllowance::even(Mm(0.5)), Mm(0.2));
    let least = over.iter().map(|f| f.1).fold(f64::INFINITY, f64::min);
    println!("{} samples, at least {least:.4} mm over the allowance", over.len());
    assert!(over.len() > 300 && least > -1e-3, "{least}");
}

/// An allowance that grows from 0.2 mm at the tip to 0.6 mm at the root is kept at every height, by the distances of all
/// samples of faces and fillets to the swept cutters. The cutters also come near it in each third of the height: a plan
/// that kept the value of the root everywhere would leave 0.15 mm more in the middle, and 0.25 mm at the top.
#[test]
fn a_growing_allowance_is_kept_at_every_height() {
    let vane = VaneAllowance::growing(Mm(0.2), Mm(0.6)).unwrap();
    let figures = left_on_vanes(vane, Mm(0.4));
    for third in 0..3 {
        let of_third = figures.iter().filter(|f| ((3.0 * f.0) as usize).min(2) == third);
        let over: Vec<f64> = of_third.map(|f| f.1).collect();
        let least = over.iter().copied().fold(f64::INFINITY, f64::min);
        println!("third {third} from the hub: {} samples, at least {least:.4} mm over the allowance", over.len());
        assert!(over.len() > 100 && least > -1e-3, "{third}: {least}");
        // `tolerance rough` is 0.05 mm; samples of the planner and their reserve take 0.08 mm with a sharp edge.
        assert!(least < 0.1, "{third}: {least}");
    }
}

/// A tapered ball of 1.2 mm as the last tool of `rough` gets where the tools of 2 mm do not fit, leaves a growing allowance
/// by proof and by the distances of all samples, and collides with nothing.
#[test]
fn a_tapered_ball_roughs() {
    let folder = tempfile::tempdir().unwrap();
    let taper = "tool t3 = tapered-ball { diameter 1.2 mm  angle 4 deg  flutes 4  flute 10 mm  reach 25 mm  holder \
                 \"er16-mini\" }\n\noperation rough {";
    let mut text = include_str!("../../jobs/small/rough.imp").to_owned();
    for (from, to) in [
        ("operation rough {", taper),
        ("tools t1, t2 ", "tools t1, t2, t3  sectors 1"),
        ("feed 300 mm/min", "feed 300 mm/min, 300 mm/min, 150 mm/min"),
        ("vane 0.2 mm,", "vane 0.2 mm .. 0.4 mm,"),
        ("require rest      <= 0.8 mm", ""),
    ] {
        assert!(text.contains(from), "{from}");
        text = text.replacen(from, to, 1);
    }
    std::fs::write(folder.path().join("job.imp"), text).unwrap();
    std::fs::write(folder.path().join("vane_curves.csv"), include_str!("../../jobs/small/vane_curves.csv")).unwrap();
    let options = Options { job: folder.path().join("job.imp"), ..Options::default() };
    let program = driver::front(&options, &mut Stages::default(), &mut Outcome::default()).unwrap().unwrap();
    let compiled = Compiled::new(program);
    let (program, motion) = compiled.planned();
    let last = Sweep::new(program, motion, 2).expect("a tapered ball");
    let samples = sample(&program.part, 0.2);
    let heights = Heights::new(&program.part);
    let missing = samples.par_iter().filter(|s| matches!(s.surface.kind, SurfaceKind::Face(_))).map(|s| {
        // No allowance is larger than 0.4 mm: the height is needed only where the cutter comes as near.
        let near = last.nearest(&s.position, 0.4);
        near.map_or(0.0, |n| 0.4 - 0.2 * heights.at(&s.position) - n.distance)
    });
    let missing = missing.reduce(|| 0.0, f64::max);
    let vanes = &compiled.certificate.allowance.as_ref().expect("roughing").vanes;
    let stock = &compiled.certificate.stock.as_ref().expect("a stock").operations[2];
    let rest = &compiled.certificate.rest;
    println!(
        "tapered ball: {missing:.4} mm missing, proved {:.5} mm; {:.1} mm3 removed, {:.2} by links; cleared {:.2} % to {:.2} %",
        vanes[2].bound.get(),
        stock.removed.get(),
        stock.by_links.get(),
        100.0 * rest[1].cleared.get(),
        100.0 * rest[2].cleared.get()
    );
    assert!(missing < 1e-3 && vanes[2].bound.get() < 1e-3, "{missing} {}", vanes[2].bound.get());
    assert!(
        stock.collisions.is_empty() && stock.removed.get() > 3.0 && stock.by_links.get() < 0.05 * stock.removed.get()
    );
    assert!(rest[2].cleared > rest[1].cleared);
}

/// The simulation of the verifier, in cells of a tenth of the tools: nothing collides, no link removes more than a cut,
/// and links remove next to nothing. Later tools run over cusps of the earlier ones, which are narrower than the cells of
/// the planner, so that their links meet a little more.
#[test]
fn links_remove_nothing() {
    let (program, motion) = ROUGHED.planned();
    let mut settings = Settings { cell: Some(0.2), ..Settings::default() };
    let report = simulate(program, motion, &mut settings, &Progress::default(), &mut Sink::default()).expect("a stock");
    for (operation, most) in report.operations.iter().zip([1e-3, 1e-2]) {
        println!(
            "{}: links remove {:.3} of {:.3} mm3",
            operation.name,
            operation.by_links.get(),
            operation.removed.get()
        );
        let [link, cut] = [operation.link, operation.rate].map(|peak| peak.map_or(0.0, |p| p.value.get()));
        assert!(operation.collisions.is_empty() && link <= cut, "{}: {link} {cut}", operation.name);
        assert!(operation.by_links.get() < most * operation.removed.get(), "{}", operation.name);
    }
}

/// The sense of the lines of an operation `rough`.
fn sense_of(operation: &Operation) -> Milling {
    let Some(RoughingStrategy::Rough { milling, .. }) = operation.kind.strategy() else { panic!("rough") };
    milling
}

/// The wall lies to the right of a tool that climbs, and to the left of one that mills conventionally.
#[test]
fn lines_keep_their_sense() {
    let (climbing, by_default) = ROUGHED.planned();
    assert!(climbing.operations.iter().all(|(_, o)| sense_of(o) == Milling::Climb));
    let conventional = changed(|o| {
        if let OperationKind::Roughing { strategy: RoughingStrategy::Rough { milling, .. }, .. } = &mut o.kind {
            *milling = Milling::Conventional;
        }
    });
    let planned = pipeline::run(&conventional, &mut Sink::default()).unwrap().motion;
    for (program, motion) in [(climbing, by_default), (&conventional, &planned)] {
        let milling = sense_of(program.operations.iter().next().unwrap().1);
        let walls: Vec<Sample> = sample(&program.part, 0.4)
            .into_iter()
            .filter(|s| matches!(s.surface.kind.class(), SurfaceClass::Pressure | SurfaceClass::Suction))
            .collect();
        let operation = &motion.operations[0];
        let (mut right, mut all) = (0, 0);
        for pair in operation.moves.windows(2) {
            let line = operation.labels[pair[1].pass as usize].contains(" line ");
            if pair[1].kind != MoveKind::Cut || !line {
                continue;
            }
            let [from, to] = [0, 1].map(|k| program.machine.forward(&pair[k].joints));
            let middle = from.tip + (to.tip - from.tip) * 0.5 + from.axis;
            let near = walls.iter().map(|s| s.position - middle).min_by(|a, b| a.norm().total_cmp(&b.norm())).unwrap();
            // Beside a wall, with the wall across the motion: not on the way from one wall to the other.
            let motion = (to.tip - from.tip).normalize();
            if near.norm() > 1.6 || near.normalize().dot(&motion).abs() > 0.4 {
                continue;
            }
            all += 1;
            right += usize::from(motion.cross(&from.axis).dot(&near) > 0.0);
        }
        let share = f64::from(u32::try_from(right).unwrap()) / f64::from(u32::try_from(all).unwrap());
        println!("{}: wall to the right on {:.1} % of {all} moves", milling.name(), 100.0 * share);
        let as_named = if milling == Milling::Climb { share } else { 1.0 - share };
        assert!(all > 100 && as_named > 0.95, "{} {share} of {all}", milling.name());
    }
}

/// The tool of an operation.
fn tool_of<'a>(program: &'a Program, name: &str) -> &'a Tool {
    let operation = program.operations.iter().find(|(_, o)| o.name == name).expect("an operation").1;
    &program.tools[operation.tool]
}

/// Edge of the grid in the room of a channel, mm.
const GRID: f64 = 1.0;

/// What the plan of one sector, turned into every channel, leaves in one sector of the part, mm: the largest distance of a
/// milled surface to the cutters, and of a place in the room between the vanes that no cutter passes to the part.
fn rest(program: &Program, motion: &Motion) -> [f64; 2] {
    let part = &program.part;
    let sweeps: Vec<Sweep<'_>> = (0..motion.operations.len()).filter_map(|o| Sweep::new(program, motion, o)).collect();
    // A place in a channel is to the plan of another sector what the turned place is to the plan of this one.
    let nearest = |p: &Point3<f64>, most: f64| {
        let turned = (0..part.vane_count).map(|sector| part.sector_rotation(sector) * p);
        let near = |d: f64, p: &Point3<f64>, w: &Sweep<'_>| w.nearest(p, d).map_or(d, |n| n.distance.min(d));
        turned.fold(most, |least, p| sweeps.iter().fold(least, |d, w| near(d, &p, w)))
    };
    let samples = sample(part, 0.5);
    let milled: Vec<&Sample> = samples.iter().filter(|s| s.surface.sector == 0 && s.surface.milled()).collect();
    assert!(milled.len() > 1000, "{}", milled.len());
    let on_surfaces = milled.par_iter().map(|s| nearest(&s.position, 5.0)).reduce(|| 0.0, f64::max);
    // A grid in one sector of the blank, outside of the part.
    let [radii, heights] = [0, 1].map(|k| program.stock.profile.iter().map(move |p| p[k]));
    let (reach, low) = (radii.fold(0.0, f64::max), heights.clone().fold(f64::INFINITY, f64::min));
    let (n, levels) = ((reach / GRID) as i32, ((heights.fold(low, f64::max) - low) / GRID) as i32);
    let row = |j: i32, k: i32| (-n..=n).map(move |i| [f64::from(i), f64::from(j), f64::from(k)]);
    let grid = (0..=levels).flat_map(|k| (-n..=n).flat_map(move |j| row(j, k)));
    let points = grid.map(|[i, j, k]| Point3::new(i * GRID, j * GRID, low + k * GRID));
    let sector = std::f64::consts::TAU / f64::from(part.vane_count);
    let design = Cloud::new(cloud_points(&samples));
    let room: Vec<(Point3<f64>, f64)> = points
        .filter(|p| (0.0..sector).contains(&p.y.atan2(p.x)))
        .filter(|p| program.stock.distance(p) < 0.0 && part.hub.distance(p) > 0.0)
        .filter_map(|p| {
            let (distance, index) = design.least(|q| (q - p).norm(), f64::INFINITY)?;
            let at = &design.points()[index];
            ((p - at.position).dot(&at.normal) > 0.0).then_some((p, distance))
        })
        .collect();
    assert!(room.len() > 100, "{}", room.len());
    let in_room = room.par_iter().map(|(p, distance)| if nearest(p, 0.0) < 0.0 { 0.0 } else { *distance });
    [on_surfaces, in_room.reduce(|| 0.0, f64::max)]
}

/// All forms of levels reach the floor of a channel, and load no tool beyond its default limit.
#[test]
fn each_form_of_levels_reaches_the_floor() {
    for form in Levels::ALL {
        let program = changed(|o| {
            if let OperationKind::Roughing { strategy: RoughingStrategy::Rough { levels, .. }, .. } = &mut o.kind {
                *levels = form;
            }
        });
        let compiled = Compiled::new(program);
        for operation in &compiled.certificate.stock.as_ref().expect("a stock").operations {
            let limit = tool_of(&compiled.program, &operation.name).max_depth.get();
            let load = operation.slot_depth.expect("a cut");
            println!(
                "{}, {}: load of a slot {:.3} mm deep of {limit:.2} mm",
                form.name(),
                operation.name,
                load.value.get()
            );
            assert!(load.value.get() <= limit, "{}: {load:?}", form.name());
        }
        // The contract of the job.
        let [surfaces, room] = rest(&compiled.program, &compiled.plan.motion);
        println!("{}: rest {surfaces:.3} mm on surfaces, {room:.3} mm between them", form.name());
        assert!(surfaces <= 0.8 && room <= 0.8, "{}: {surfaces} {room}", form.name());
    }
}

/// The blades of this wheel lean by up to 65 deg against its levels: a step down is more than twice as long along the tool, and levels
/// leave strips beside the flutes. Parts over the lines keep the load within the limit, a slot of half of the diameter.
#[test]
fn cuts_keep_within_the_limit_of_the_tool_where_blades_lean() {
    let changes = [
        ("max-depth 4 mm", "max-depth 2 mm"),
        ("tools t1, t2, t3  speed", "tools t1  speed"),
        ("depth 1.5 mm  stepover 1 mm", "depth 1.3 mm  stepover 1.6 mm"),
        ("lead-out 4 mm  sectors 1, 5\n", "lead-out 4 mm  sectors 1\n"),
    ];
    let mut program = jobs::program_with("jobs/splitter/splitter.imp", &changes);
    let mut operations = PrimaryMap::new();
    for (_, operation) in program.operations.iter().filter(|(_, o)| o.kind.roughing().is_some()) {
        operations.push(operation.clone());
    }
    program.operations = operations;
    let compiled = Compiled::new(program);
    let lifted: Vec<&str> = compiled.plan.cl.operations[0]
        .passes
        .iter()
        .map(|pass| pass.label.as_str())
        .filter(|label| label.contains(" lifted "))
        .collect();
    println!("{lifted:#?}");
    assert!(lifted.len() > 5, "{lifted:?}");
    let load = compiled.certificate.stock.as_ref().expect("a stock").operations[0].slot_depth.expect("a cut");
    println!("load of a slot {:.3} mm deep of 2 mm", load.value.get());
    assert!(load.value.get() <= 2.0, "{load:?}");
}

/// Every contract of a wheel that is roughed from one item holds, no island stands, and no link removes more than a cut.
fn is_roughed_from_one_item(program: Program) {
    let compiled = Compiled::new(program);
    for contract in &compiled.certificate.contracts {
        println!("{}: {:.3}", contract.name(), contract.found);
        assert!(contract.holds, "{}: {}", contract.name(), contract.found);
    }
    for operation in &compiled.certificate.stock.as_ref().expect("a stock").operations {
        let [link, cut] = [operation.link, operation.rate].map(|peak| peak.map_or(0.0, |p| p.value.get()));
        assert!(operation.collisions.is_empty() && link <= cut, "{}: {link} {cut}", operation.name);
    }
}

/// Few long vanes.
#[test]
fn a_pump_wheel_is_roughed_from_one_item() {
    is_roughed_from_one_item(jobs::program("pump", None));
}

/// Tools of 0.6 mm in channels of 1.5 mm.
#[test]
fn a_turbo_wheel_of_20_mm_is_roughed_from_one_item() {
    is_roughed_from_one_item(jobs::program("turbo20", None));
}
