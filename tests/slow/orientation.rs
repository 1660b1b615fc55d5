//! Tool orientation of the floor and finishing of the vanes. The methods are compared with each other and printed as in
//! Xu 2013 (before and after: speed and time), with the motion of the rotary axes. The clearance is proved with the
//! means of the verifier.
//!
//! Times come from the verifier's simulation with the limits of the axes, not from the planner. `cargo test --test slow --
//! orientation:: --nocapture` shows the tables.

use crate::support;
use impellerc::base::entity::PrimaryMap;
use impellerc::base::progress::Progress;
use impellerc::base::units::{Mm, MmPerMin, Rpm, Sec};
use impellerc::diagnostics::{Severity, Sink};
use impellerc::driver::{self, Options, Outcome, Stages};
use impellerc::five_axis::{Carried, CarriedKind};
use impellerc::ir::{Contract, Motion, MoveKind, OperationKind, Program};
use impellerc::plan::passes::pipeline;
use impellerc::tool_stock::collide::{Cloud, ToolSolid};
use impellerc::verify::clearance::{self, ToolPart};
use impellerc::verify::proof::{piece, sweep};
use impellerc::verify::{dynamics, obstacles, surface};
use impellerc::wheel::contract::{ContractKind, Guarded};
use impellerc::wheel::method::{AxisMethod, Flank, FlankMethod, Lines, Spacing};
use impellerc::wheel::part::{BladeId, SurfaceKind, kept::MilledTurned, sample};
use std::path::PathBuf;
use std::sync::LazyLock;

/// Feeds with which the methods are compared, mm/min: fast milling of steel, of aluminium, and as fast as machines cut.
const FEEDS: [f64; 3] = [3000.0, 6000.0, 12000.0];

/// Feed of planning, mm/min.
const FEED: f64 = 6000.0;

/// A program of one operation, in one sector of the part of a job, at the feed of planning.
fn alone(job: &Program, kind: OperationKind, lead: f64) -> Program {
    let mut program = job.clone();
    let tool = program.operations.iter().last().unwrap().1.tool;
    program.operations = PrimaryMap::new();
    let mut operation = support::operation(kind.keyword(), kind, tool, vec![0], lead);
    (operation.feed, operation.speed, operation.link_feed) = (MmPerMin(FEED), Rpm(18000.0), MmPerMin(FEED));
    program.operations.push(operation);
    program.contracts = vec![
        Contract::whole(ContractKind::Clearance(Guarded::Body), 0.5),
        Contract::whole(ContractKind::Clearance(Guarded::Holder), 1.0),
        // What roughing of the main job leaves at most: short ways between lines go over it.
        Contract::whole(ContractKind::Rest, 1.0),
    ];
    // Along the rulings C turns by more than its travel: here it turns without ends.
    (program.machine.rotary[1].min, program.machine.rotary[1].max) = (-100.0, 100.0);
    program
}

/// Channel finishing alone.
fn floor(job: &Program, method: AxisMethod, lines: Lines, scallop: f64) -> Program {
    let kind = OperationKind::Channel {
        scallop: Mm(scallop),
        spacing: Spacing::EqualDivision,
        lines,
        method,
        allowance_vane: None,
    };
    alone(job, kind, 8.0)
}

/// What finishing of the vanes may leave, mm, or cut too deep: the contract on excess of the main job.
const ASKED: f64 = 0.012;

/// Finishing of both faces of a vane alone.
fn vanes(job: &Program, flank: Flank) -> Program {
    let mut program = alone(job, OperationKind::Flank { faces: BladeId::MAIN.faces().to_vec(), flank }, 12.0);
    program.contracts.extend([ContractKind::Gouge, ContractKind::Excess].map(|kind| Contract::whole(kind, ASKED)));
    program
}

fn job(name: &str) -> Program {
    let job = PathBuf::from(format!("jobs/{name}/{name}.imp"));
    let options = Options { job, ..Options::default() };
    driver::front(&options, &mut Stages::default(), &mut Outcome::default()).unwrap().unwrap()
}

/// With the tolerance of the table, a micrometre.
fn wei() -> Program {
    let mut program = job("wei2021");
    program.tolerances.chord = Mm(0.001);
    program
}

fn turboexpander() -> Program {
    job("turboexpander108")
}

/// What a line of the table says of a method.
struct Row {
    /// Largest turns of A and C a mm of the way of the tip, deg/mm, over blocks of some length.
    turn: [f64; 2],
    /// Length, mm, and time of cutting, s, time with links and rapids, s, and what the process feed alone would take of
    /// the time of cutting, s.
    length: f64,
    time: f64,
    whole: f64,
    at_feed: f64,
    /// Largest acceleration that the feed asks of A and C, as a share of the limit.
    asked: [f64; 2],
}

/// Blocks shorter than this say little of the turn a mm, mm.
const SHORTEST: f64 = 0.02;

fn row(program: &Program, motion: &Motion) -> Row {
    let run = dynamics::run(program, motion, 0, &[]);
    let (mut turn, mut length) = ([0.0_f64; 2], 0.0);
    for pair in motion.operations[0].moves.windows(2).filter(|p| p[1].kind == MoveKind::Cut) {
        let [p, q] = [0, 1].map(|k| program.machine.forward(&pair[k].joints).tip);
        let way = (q - p).norm();
        length += way;
        if way > SHORTEST {
            let [from, to] = [pair[0].joints.rotary, pair[1].joints.rotary];
            turn = [0, 1].map(|k| turn[k].max((to[k] - from[k]).abs().to_degrees() / way));
        }
    }
    let asked = [run.required_acceleration[3].value.0, run.required_acceleration[4].value.0];
    let cuts = motion.operations[0].moves.iter().filter(|m| m.kind == MoveKind::Cut);
    let at_feed = cuts.map(|m| m.time).sum();
    Row { turn, length, time: run.time[0].get(), whole: run.time.into_iter().sum::<Sec>().get(), at_feed, asked }
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

/// Largest deviation, gouge or excess, mm, that a plan leaves on both faces of the vane of the first sector.
fn left_on_faces(program: &Program, motion: &Motion) -> f64 {
    let sweep = sweep::Sweep::new(program, motion, 0).expect("a sweep");
    let found = surface::certify(
        &program.part,
        MilledTurned::default(),
        &[sweep],
        1.0,
        &surface::Limits::default(),
        &Progress::default(),
    );
    let face = |r: &&surface::SurfaceReport| r.id.sector == 0 && matches!(r.id.kind, SurfaceKind::Face(_));
    found.iter().filter(face).map(|r| r.excess.value.get().max(r.gouge.value.get().abs())).fold(0.0, f64::max)
}

/// A method with its plan.
struct Planned {
    name: String,
    program: Program,
    motion: Motion,
}

impl Planned {
    fn new(name: &str, program: Program) -> Self {
        let motion = planned(&program);
        Self { name: name.to_owned(), program, motion }
    }

    /// The row at a feed, printed.
    fn row(&self, feed: f64) -> Row {
        let row = row(&self.program, &at_feed(&self.program, &self.motion, feed));
        println!(
            "{:18} {:13.0} {:7.1} {:12.1} {:9.3} {:9.3} {:18.1} {:7.1}",
            self.name,
            row.length / row.time * 60.0,
            row.time,
            row.whole,
            row.turn[1],
            row.turn[0],
            row.asked[1] * self.program.machine.rotary[1].acceleration,
            row.asked[0] * self.program.machine.rotary[0].acceleration
        );
        row
    }
}

/// Most passes a face that are tried.
const MAX_STRIPS: u32 = 8;

/// One pass a face with the axis along the rulings; as many passes through both ends of the rulings of their bands as it
/// takes to leave no more than is asked; and one pass by minimax.
///
/// More passes along the rulings leave more and not less: the tool goes on above each band, where it cuts into the twist.
fn vane_methods(job: &Program) -> [Planned; 3] {
    let told = |name: String, flank: Flank| {
        let found = Planned::new(&name, vanes(job, flank));
        let left = left_on_faces(&found.program, &found.motion);
        println!("{name} leaves {:.1} um", left * 1e3);
        (found, left)
    };
    let by_ruling = |method: FlankMethod, strips: u32| {
        told(format!("{} {strips}", method.name()), Flank::by_ruling(method, strips))
    };
    let minimax = Flank::by_ruling(FlankMethod::Minimax, 1);
    let (after, left) = told("minimax 1".to_owned(), minimax);
    assert!(left <= ASKED);
    let (one_point, left) = by_ruling(FlankMethod::OnePoint, 1);
    assert!(left > 5.0 * ASKED);
    let enough = (1..=MAX_STRIPS).map(|n| by_ruling(FlankMethod::TwoPoint, n)).find(|(_, left)| *left <= ASKED);
    [one_point, enough.expect("bands enough").0, after]
}

/// Prints the table of a part for each feed: rows of the axis along the ruling, of the blend, of the corridor, on the
/// floor, one way and in zigzag; of the methods on the vanes.
fn table(name: &str, job: &Program, scallop: f64) -> Vec<[Row; 7]> {
    let one_way = [AxisMethod::Ruling, AxisMethod::Blend, AxisMethod::Corridor];
    let [ruling, blend, corridor] =
        one_way.map(|method| Planned::new(method.name(), floor(job, method, Lines::OneWay, scallop)));
    let zigzag = Planned::new("corridor, zigzag", floor(job, AxisMethod::Corridor, Lines::Zigzag, scallop));
    let [one_point, two_point, minimax] = vane_methods(job);
    let methods = [ruling, blend, corridor, zigzag, one_point, two_point, minimax];
    let tables = FEEDS.map(|feed| {
        println!("{name}: one channel and one vane at {feed:.0} mm/min, floor with a scallop of {scallop} mm");
        println!(
            "                    speed mm/min  time s  with ways s  C deg/mm  A deg/mm  asked of C rad/s2    of A"
        );
        let rows = [0, 1, 2, 3, 4, 5, 6].map(|k| methods[k].row(feed));
        let [ruling, blend, corridor, zigzag, one_point, two_point, minimax] = &rows;
        told("floor", &[ruling], &[zigzag]);
        told("vanes", &[one_point], &[minimax]);
        told("both", &[ruling, one_point], &[zigzag, minimax]);
        told("both, as accurate", &[ruling, two_point], &[zigzag, minimax]);
        println!("C a mm against blend {:.1} to 1", blend.turn[1] / corridor.turn[1]);
        rows
    });
    tables.into_iter().collect()
}

/// Prints speeds and times before and after.
fn told(what: &str, before: &[&Row], after: &[&Row]) {
    let sum = |rows: &[&Row], of: fn(&Row) -> f64| rows.iter().map(|r| of(r)).sum::<f64>();
    let [b, a] = [before, after].map(|rows| [sum(rows, |r| r.length), sum(rows, |r| r.time), sum(rows, |r| r.whole)]);
    let ([from, to], ratio) = ([b, a].map(|x| x[0] / x[1] * 60.0), b[1] / a[1]);
    println!("{what}, before and after: {from:.0} and {to:.0} mm/min, {:.1} and {:.1} s, {ratio:.2} to 1", b[1], a[1]);
    println!("    with ways {:.1} and {:.1} s, {:.2} to 1", b[2], a[2], b[2] / a[2]);
    let at_feed = sum(after, |r| r.at_feed);
    println!("    the process feed alone takes {at_feed:.1} s: no more than {:.2} to 1", b[1] / at_feed);
}

fn check(tables: &[[Row; 7]]) {
    for [ruling, blend, corridor, zigzag, one_point, two_point, minimax] in tables {
        assert!(4.0 * corridor.turn[1] < blend.turn[1]);
        assert!(corridor.time < blend.time && corridor.time < ruling.time);
        assert!(minimax.time < one_point.time && minimax.time < two_point.time);
        assert!(zigzag.whole < corridor.whole);
    }
    // Where the axes limit the run and not the process feed: the paper prints 4000 and 900 s.
    let [ruling, _, corridor, zigzag, _, two_point, minimax] = tables.last().expect("a table");
    // Links count as well. The most that the corridor asks is in one of them, the same at each feed of the cuts.
    assert!(10.0 * corridor.asked[1] < ruling.asked[1] && 10.0 * corridor.asked[0] < ruling.asked[0]);
    assert!(4.4 * zigzag.time < ruling.time);
    assert!(4.4 * (zigzag.time + minimax.time) < ruling.time + two_point.time);
}

#[test]
fn the_corridor_turns_less_and_runs_faster_on_the_paper_floor() {
    check(&table("wei2021", &wei(), 0.2));
}

#[test]
fn the_corridor_turns_less_and_runs_faster_on_the_turboexpander() {
    check(&table("turboexpander108", &turboexpander(), 0.1));
}

/// The paper's floor by corridor with few lines, for what needs no more.
static COARSE: LazyLock<Planned> =
    LazyLock::new(|| Planned::new("corridor", floor(&wei(), AxisMethod::Corridor, Lines::OneWay, 0.4)));

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
    let spacing = 0.2;
    let cloud = Cloud::new(sample::cloud_points(&sample::sample(&program.part, spacing)));
    let pieces: Vec<piece::Piece> =
        piece::pieces(&program.machine, motion, 0).into_iter().filter(|p| p.kind == MoveKind::Cut).collect();
    let solid = &program.tools[program.operations.iter().next().unwrap().1.tool].solid;
    let half = spacing * std::f64::consts::FRAC_1_SQRT_2;
    let least = |f: fn(&ToolSolid, f64, f64) -> f64| {
        clearance::least(&pieces, &ToolPart::new(solid, f), &cloud, half, 3.0).map_or(3.0, |c| {
            println!("  found {:.3} mm, at least {:.3} mm", c.found.get(), c.distance.get());
            c.distance.get()
        })
    };
    [least(side), least(shank), least(holder)]
}

#[test]
fn what_the_corridor_promises_the_verifier_finds() {
    let turboexpander = Planned::new("corridor", floor(&turboexpander(), AxisMethod::Corridor, Lines::OneWay, 0.3));
    for (name, found) in [("wei2021", &*COARSE), ("turboexpander108", &turboexpander)] {
        println!("{name}");
        let [side, shank, holder] = clearances(&found.program, &found.motion);
        // The lower bound of the verifier is by up to half a spacing on the safe side.
        assert!(side >= 0.5 - 0.05 && shank >= 0.5 - 0.05 && holder >= 1.0, "{name}: {side} {shank} {holder}");
    }
}

#[test]
fn the_greedy_choice_of_the_paper_is_clear_at_its_stations() {
    let program = floor(&wei(), AxisMethod::Xu, Lines::OneWay, 0.4);
    let motion = planned(&program);
    let row = row(&program, &motion);
    println!("xu: {:.1} s, C {:.2} deg/mm", row.time, row.turn[1]);
    assert!(row.length > 100.0);
}

/// One error for all passes, and the tool that its help names plans the whole operation.
#[test]
fn a_holder_that_is_too_fat_is_told_with_the_reach_that_would_do() {
    let program = floor(&wei(), AxisMethod::Corridor, Lines::OneWay, 0.4);
    let used = program.operations.iter().next().unwrap().1.tool;
    // A holder of 100 mm diameter, 28 mm lower than that of the tool, and that much longer again.
    let with_reach = |longer: f64| {
        let mut solid = program.tools[used].solid.clone();
        solid.shank.clear();
        for section in &mut solid.holder {
            (section.radius_from, section.radius_to) = (50.0, 50.0);
            (section.from, section.to) = (section.from - 28.0 + longer, section.to - 28.0 + longer);
        }
        program.with_solid(used, &solid)
    };
    let fat = with_reach(0.0);
    let mut sink = Sink::default();
    assert!(pipeline::run(&fat, &mut sink).is_err());
    let errors: Vec<_> = sink.diags().iter().filter(|d| d.severity == Severity::Error).collect();
    let [error] = errors.as_slice() else { panic!("{errors:#?}") };
    println!("{} {:?} {:?}", error.message, error.notes, error.help);
    assert!(error.code.id() == "IMP0502" && error.place.is_some());
    let help = error.help.as_deref().unwrap_or_default();
    let after = |words: &str| -> f64 {
        let (_, rest) = help.split_once(words).unwrap_or_else(|| panic!("no `{words}`: {help}"));
        rest.split_once(" mm").unwrap().0.parse().unwrap()
    };
    let reach = fat.tools[used].solid.holder[0].from;
    // A slimmer holder alone has clear axes at the place of the error, and no motion through those of all passes.
    assert!(!help.contains("holder"), "{help}");
    let told = with_reach(after("a reach of ") - reach);
    assert!(pipeline::run(&told, &mut Sink::default()).is_ok(), "{help}");
}

#[test]
fn axes_keep_clear_of_a_fixture() {
    let mut clamped = COARSE.program.clone();
    // A plate that the part stands in, up to the height of its outlet.
    let profile = [[0.0, -41.0], [72.0, -41.0], [72.0, TOP], [170.0, TOP], [170.0, -60.0], [0.0, -60.0]];
    clamped.machine.carried = vec![Carried { kind: CarriedKind::Fixture, profile: profile.to_vec() }];
    let least = |motion: &Motion| {
        let found = obstacles::check(&clamped, motion, &Progress::default());
        println!("{:?}", found[0]);
        found[0].clearance.as_ref().map_or(20.0, |c| c.distance.get())
    };
    let [without, with] = [least(&COARSE.motion), least(&planned(&clamped))];
    assert!(without < 0.0 && with >= 0.5, "{without} {with}");
}

/// Height of the plate, mm.
const TOP: f64 = -26.0;
