//! Tool orientation of the floor: the methods against each other, printed as Xu 2013 prints them (before and after:
//! speed and time), with what the rotary axes do; and the proof of clearance, by the verifier's own means.
//!
//! Times are those of the verifier's simulation with the limits of the axes, not of the planner. `cargo test --test
//! orientation -- --nocapture` shows the tables.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "figures of a run are shown with --nocapture")]

mod support;

use impellerc::collide::{Cloud, ToolSolid};
use impellerc::contract::{ContractKind, Guarded};
use impellerc::diag::Sink;
use impellerc::driver::{self, Options, Outcome, Stages};
use impellerc::entity::PrimaryMap;
use impellerc::ir::{Contract, Motion, MoveKind, OperationKind, Program, design};
use impellerc::method::{AxisMethod, Lines, Spacing};
use impellerc::passes::pipeline;
use impellerc::units::{Mm, MmPerMin, Rpm};
use impellerc::verify::{clearance, dynamics, sweep};
use std::path::PathBuf;

/// Feeds with which the methods are compared, mm/min: fast milling of steel, of aluminium, and as fast as machines cut.
const FEEDS: [f64; 3] = [3000.0, 6000.0, 12000.0];

/// Feed of planning, mm/min.
const FEED: f64 = 6000.0;

/// A program of channel finishing alone, in one sector of a part.
fn floor(mut program: Program, method: AxisMethod, scallop: f64) -> Program {
    let tool = program.operations.iter().last().unwrap().1.tool;
    program.operations = PrimaryMap::new();
    let kind =
        OperationKind::Channel { scallop: Mm(scallop), spacing: Spacing::EqualDivision, lines: Lines::OneWay, method };
    let mut operation = support::operation("channel", kind, tool, vec![0], 8.0);
    (operation.feed, operation.speed, operation.link_feed) = (MmPerMin(FEED), Rpm(18000.0), MmPerMin(FEED));
    program.operations.push(operation);
    program.contracts = vec![
        Contract::whole(ContractKind::Clearance(Guarded::Body), 0.5),
        Contract::whole(ContractKind::Clearance(Guarded::Holder), 1.0),
    ];
    // Along the rulings C turns by more than its travel: here it turns without ends.
    (program.machine.turn.min, program.machine.turn.max) = (-100.0, 100.0);
    program
}

fn wei() -> Program {
    support::wei_program(&[0])
}

fn turboexpander() -> Program {
    let job = PathBuf::from("jobs/turboexpander108/turboexpander108.imp");
    let options = Options { job, ..Options::default() };
    driver::front(&options, &mut Stages::default(), &mut Outcome::default()).unwrap().unwrap()
}

/// What a line of the table says of a method.
struct Row {
    /// Largest turns of A and C a mm of the way of the tip, deg/mm, over blocks of some length.
    turn: [f64; 2],
    /// Length, mm, and time of cutting, s, and time with links and rapids, s.
    length: f64,
    time: f64,
    whole: f64,
    /// Largest acceleration that the feed asks of A and C, as a share of the limit.
    asked: [f64; 2],
}

/// Blocks shorter than this say little of the turn a mm, mm.
const SHORTEST: f64 = 0.02;

fn row(program: &Program, motion: &Motion) -> Row {
    let run = dynamics::run(program, motion, 0);
    let (mut turn, mut length) = ([0.0_f64; 2], 0.0);
    for pair in motion.operations[0].moves.windows(2).filter(|p| p[1].kind == MoveKind::Cut) {
        let [p, q] = [0, 1].map(|k| program.machine.forward(&pair[k].joints).tip);
        let way = (q - p).norm();
        length += way;
        if way > SHORTEST {
            turn[0] = turn[0].max((pair[1].joints.a - pair[0].joints.a).abs().to_degrees() / way);
            turn[1] = turn[1].max((pair[1].joints.c - pair[0].joints.c).abs().to_degrees() / way);
        }
    }
    let asked = [run.asked[3].value, run.asked[4].value];
    Row { turn, length, time: run.time[0], whole: run.time.iter().sum(), asked }
}

fn planned(program: &Program) -> Motion {
    let mut sink = Sink::default();
    match pipeline::run(program, &mut sink) {
        Ok(plan) => plan.motion,
        Err(_) => panic!("{:#?}", sink.diags().iter().map(|d| (&d.message, &d.place, &d.help)).collect::<Vec<_>>()),
    }
}

/// The same motion at another feed: the simulation keeps the limits of the axes.
fn at_feed(program: &Program, motion: &Motion, feed: f64) -> Motion {
    let mut motion = motion.clone();
    for operation in &mut motion.operations {
        let tips: Vec<_> = operation.moves.iter().map(|m| program.machine.forward(&m.joints).tip).collect();
        for (i, m) in operation.moves.iter_mut().enumerate().skip(1) {
            let way = (tips[i] - tips[i - 1]).norm();
            if m.kind == MoveKind::Cut && way > 0.0 {
                (m.feed, m.time) = (Some(feed), way / feed * 60.0);
            }
        }
    }
    motion
}

/// Prints the table of a part: rows of the axis along the ruling, of the blend, of the corridor, for each feed.
fn table(name: &str, part: fn() -> Program, scallop: f64) -> Vec<[Row; 3]> {
    let methods = [AxisMethod::Ruling, AxisMethod::Blend, AxisMethod::Corridor];
    let plans = methods.map(|method| {
        let program = floor(part(), method, scallop);
        let motion = planned(&program);
        (program, motion)
    });
    let tables = FEEDS.map(|feed| {
        println!("{name}: floor of one channel at {feed:.0} mm/min, scallop {scallop} mm");
        println!("           speed mm/min  time s  with ways s  C deg/mm  A deg/mm  asked of C rad/s2    of A");
        let rows = [0, 1, 2].map(|k| {
            let (program, motion) = &plans[k];
            let row = row(program, &at_feed(program, motion, feed));
            println!(
                "{:9} {:13.0} {:7.1} {:12.1} {:9.3} {:9.3} {:18.1} {:7.1}",
                methods[k].name(),
                row.length / row.time * 60.0,
                row.time,
                row.whole,
                row.turn[1],
                row.turn[0],
                row.asked[1] * program.machine.turn.acceleration,
                row.asked[0] * program.machine.tilt.acceleration
            );
            row
        });
        println!(
            "before, after: {:.0} and {:.0} mm/min, {:.1} and {:.1} s, {:.2} to 1; C a mm against blend {:.1} to 1",
            rows[0].length / rows[0].time * 60.0,
            rows[2].length / rows[2].time * 60.0,
            rows[0].time,
            rows[2].time,
            rows[0].time / rows[2].time,
            rows[1].turn[1] / rows[2].turn[1]
        );
        rows
    });
    tables.into_iter().collect()
}

fn check(tables: &[[Row; 3]]) {
    for [ruling, blend, corridor] in tables {
        assert!(4.0 * corridor.turn[1] < blend.turn[1]);
        assert!(corridor.time < blend.time && corridor.time < ruling.time);
        assert!(10.0 * corridor.asked[1] < ruling.asked[1] && 10.0 * corridor.asked[0] < ruling.asked[0]);
    }
    // Where the axes limit the run and not the process feed: the paper prints 4000 and 900 s.
    let [ruling, _, corridor] = tables.last().expect("a table");
    assert!(4.4 * corridor.time < ruling.time);
}

#[test]
fn the_corridor_turns_less_and_runs_faster_on_the_paper_floor() {
    check(&table("wei2021", wei, 0.2));
}

#[test]
fn the_corridor_turns_less_and_runs_faster_on_the_turboexpander() {
    check(&table("turboexpander108", turboexpander, 0.1));
}

/// Signed distance of a point to the side of the cutter from one diameter over its tip on.
fn side(solid: &ToolSolid, rho: f64, s: f64) -> f64 {
    let from = 2.0 * solid.cutter.tip_radius();
    let (out, below, over) = (rho - solid.radius(), from - s, s - solid.flute_length);
    let beyond = below.max(over);
    if out <= 0.0 || beyond <= 0.0 { out.max(beyond) } else { out.hypot(beyond) }
}

fn shank(solid: &ToolSolid, rho: f64, s: f64) -> f64 {
    solid.shank.iter().map(|x| x.distance(rho, s)).fold(f64::INFINITY, f64::min)
}

fn holder(solid: &ToolSolid, rho: f64, s: f64) -> f64 {
    solid.holder.iter().map(|x| x.distance(rho, s)).fold(f64::INFINITY, f64::min)
}

/// Least distances of side of the cutter, shank and holder to the part over the continuous motion of all cuts, from the
/// joints alone, with samples other than the planner's: lower bounds, mm.
fn clearances(program: &Program, motion: &Motion) -> [f64; 3] {
    let spacing = 0.3;
    let cloud = Cloud::new(design::sample(&program.part, spacing).iter().map(|s| s.cloud_point()).collect());
    let pieces: Vec<sweep::Piece> =
        sweep::pieces(&program.machine, motion, 0).into_iter().filter(|p| p.kind == MoveKind::Cut).collect();
    let solid = &program.tools[program.operations.iter().next().unwrap().1.tool].solid;
    let half = spacing * std::f64::consts::FRAC_1_SQRT_2;
    let least = |f: fn(&ToolSolid, f64, f64) -> f64| {
        clearance::least(&pieces, solid, f, &cloud, half, 3.0).map_or(3.0, |c| {
            println!("  found {:.3} mm, at least {:.3} mm", c.found, c.distance);
            c.distance
        })
    };
    [least(side), least(shank), least(holder)]
}

#[test]
fn what_the_corridor_promises_the_verifier_finds() {
    for (name, part, scallop) in [("wei2021", wei as fn() -> Program, 0.4), ("turboexpander108", turboexpander, 0.3)] {
        let program = floor(part(), AxisMethod::Corridor, scallop);
        println!("{name}");
        let [side, shank, holder] = clearances(&program, &planned(&program));
        // The lower bound of the verifier is by up to half a spacing on the safe side.
        assert!(side >= 0.5 - 0.05 && shank >= 0.5 - 0.05 && holder >= 1.0, "{name}: {side} {shank} {holder}");
    }
}

#[test]
fn the_greedy_choice_of_the_paper_is_clear_at_its_stations() {
    let program = floor(wei(), AxisMethod::Xu, 0.4);
    let motion = planned(&program);
    let row = row(&program, &motion);
    println!("xu: {:.1} s, C {:.2} deg/mm", row.time, row.turn[1]);
    assert!(row.length > 100.0);
}

#[test]
fn a_holder_that_is_too_fat_is_told_with_the_one_that_would_do() {
    let mut program = floor(wei(), AxisMethod::Corridor, 0.4);
    let used = program.operations.iter().next().unwrap().1.tool;
    let mut tools = PrimaryMap::new();
    for (id, tool) in program.tools.iter() {
        let mut tool = tool.clone();
        if id == used {
            // A holder of 100 mm diameter, 20 mm lower than that of the tool.
            tool.solid.shank.clear();
            for section in &mut tool.solid.holder {
                (section.radius_from, section.radius_to) = (50.0, 50.0);
                (section.from, section.to) = (section.from - 20.0, section.to - 20.0);
            }
        }
        tools.push(tool);
    }
    program.tools = tools;
    let mut sink = Sink::default();
    assert!(pipeline::run(&program, &mut sink).is_err());
    let error = sink.diags().iter().find(|d| d.code.id() == "IMP0502").expect("an error");
    println!("{} {:?}", error.message, error.help);
    let help = error.help.as_deref().unwrap_or_default();
    assert!(error.place.is_some() && help.contains("holder of at most") && help.contains("reach of"), "{help}");
}
