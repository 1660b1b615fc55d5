//! Times of any motion are finite and include every block: extreme feeds, limits and lengths, long operations.

use super::{Stop, motion, program, ran, support, with_jerk};
use impellerc::base::units::{Deg, Mm, Sec};
use impellerc::five_axis::Machine;
use impellerc::five_axis::control::Planning;
use impellerc::ir::{JointMove, MoveKind, Program};
use impellerc::verify::dynamics::{Run, run};
use impellerc::verify::machine;
use nalgebra::Point3;
use proptest::prelude::*;

/// Every figure of a run.
fn figures(run: &Run) -> Vec<f64> {
    let limits = run.limits.iter().flat_map(|l| l.time).map(Sec::get);
    let times = [run.time, run.within_accelerations, run.programmed].concat().into_iter().map(Sec::get).chain(limits);
    let peaks = [run.speed, run.required_acceleration, run.jerk].concat();
    let others = [run.slowest.value.get(), run.corners.value.get(), run.cycle.value.get()];
    let contour = [run.contour.value, run.contour.corner].map(Mm::get);
    let orientation = [run.orientation.value, run.orientation.corner].map(Deg::get);
    let peaks = peaks.iter().map(|p| p.value.get());
    times.chain(peaks).chain(others).chain(contour).chain(orientation).collect()
}

fn limited(speed: f64, acceleration: f64, jerk: f64, planning: Planning) -> Program {
    let mut machine: Machine = support::machine();
    for axis in &mut machine.linear {
        (axis.speed, axis.acceleration, axis.jerk) = (speed, acceleration, jerk);
    }
    for axis in &mut machine.rotary {
        (axis.speed, axis.acceleration, axis.jerk) = (0.01 * speed, 0.01 * acceleration, 0.01 * jerk);
    }
    (machine.planning, machine.cycle) = (planning, 0.001);
    program(machine)
}

/// Time of each block: that of its feed, no less than the slowest axis takes.
fn timed(program: &Program, moves: &mut [JointMove], feeds: &[f64]) {
    let machine = &program.machine;
    let speeds = machine.speeds();
    for i in 1..moves.len() {
        let [a, b] = [&moves[i - 1].joints, &moves[i].joints];
        let way = (machine.forward(b).tip - machine.forward(a).tip).norm();
        let (from, to) = (a.all(), b.all());
        let axes: [f64; 5] = std::array::from_fn(|k| to[k] - from[k]);
        let least = (0..5).map(|k| axes[k].abs() / speeds[k]).fold(way / feeds[i % feeds.len()], f64::max);
        moves[i].time = least;
    }
}

/// Time of the lines that LinuxCNC leaves out, since no axis moves by 1e-7 mm or rad.
fn too_short(program: &Program, moves: &[JointMove]) -> f64 {
    const TINY: f64 = 1e-7;
    let left_out = |pair: &&[JointMove]| {
        let [a, b] = [&pair[0], &pair[1]].map(|m| (program.machine.forward(&m.joints).tip, m.joints.rotary));
        let turns = (0..2).map(|k| b.1[k] - a.1[k]);
        (b.0 - a.0).iter().copied().chain(turns).all(|d| d.abs() < TINY)
    };
    moves.windows(2).filter(left_out).map(|pair| pair[1].time).sum()
}

fn places() -> impl Strategy<Value = Vec<Stop>> {
    let length = prop::sample::select(vec![0.0, 1e-9, 1e-6, 1e-3, 0.3, -7.0, 200.0]);
    let angle = prop::sample::select(vec![0.0, 1e-12, 1e-6, 0.01, -0.3, 1.2]);
    let turn = prop::sample::select(vec![0.0, 1e-12, 1e-6, 0.01, -0.3, 3.0]);
    prop::collection::vec(([length.clone(), length.clone(), length], angle, turn, Just(0.0)), 2..12)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 800, failure_persistence: None, ..ProptestConfig::default() })]

    /// From feeds with which a metre takes a week to those that no axis reaches; blocks that move nothing.
    #[test]
    fn extreme_feeds_and_limits(
        stops in places(),
        feeds in prop::collection::vec(prop::sample::select(vec![0.0017, 0.1, 4.0, 100.0, 1e4]), 1..4),
        speed in prop::sample::select(vec![0.017, 20.0, 500.0, 16_000.0]),
        acceleration in prop::sample::select(vec![1.0, 300.0, 5000.0, 1e6]),
        jerk in prop::sample::select(vec![1.0, 5e4, 1e9, f64::INFINITY]),
        linuxcnc in any::<bool>(),
    ) {
        let planning = if linuxcnc { Planning::LinuxCnc } else { Planning::Joints };
        let program = limited(speed, acceleration, jerk, planning);
        let mut motion = motion(&program, MoveKind::Cut, &stops);
        timed(&program, &mut motion.operations[0].moves, &feeds);
        let run = run(&program, &motion, 0, &[]);
        prop_assert!(figures(&run).iter().all(|x| x.is_finite() && *x >= 0.0), "{:?}", run);
        let due: f64 = motion.operations[0].moves.iter().map(|m| m.time).sum();
        let [spent, least, programmed] =
            [run.time, run.within_accelerations, run.programmed].map(|t| t.into_iter().sum::<Sec>().get());
        prop_assert!(super::active::are_whole(&run), "{:?}", run);
        prop_assert!((programmed - due).abs() <= 1e-9 * due, "programmed {} of {}", programmed, due);
        prop_assert!(least >= due * (1.0 - 1e-9), "{} is less than {}", least, due);
        if !linuxcnc {
            prop_assert!(spent >= least * (1.0 - 1e-9), "{} is less than {}", spent, least);
        } else if speed >= 20.0 {
            let due = due - too_short(&program, &motion.operations[0].moves);
            prop_assert!(spent >= 0.5 * due, "{} is less than half of {}", spent, due);
        }
    }
}

/// Largest speed of an axis over its limit that the check finds in one rapid with a time.
fn over_speed(program: &Program, ends: &[Stop; 2], time: f64) -> Option<f64> {
    let mut motion = motion(program, MoveKind::Rapid, ends);
    motion.operations[0].moves[1].time = time;
    let faults = machine::check(program, &motion, None).faults;
    faults.iter().filter(|f| f.speed).map(|f| f.value).reduce(f64::max)
}

fn least_time(program: &Program, [from, to]: &[Stop; 2]) -> f64 {
    let joints = |s: &Stop| program.machine.joints(&Point3::from(s.0), [s.1, s.2]);
    program.machine.least_time(&joints(from), &joints(to), 0.0)
}

/// A rapid of 200 mm with a turn: at the time that the planner gives it no axis is over its limit by the measure of the
/// check, and a tenth below that time one is.
#[test]
fn a_long_rapid_keeps_the_limits_of_the_check() {
    let program = program(support::machine());
    for turn in [0.0, 0.3, 1.5] {
        let ends = [([-100.0, 20.0, 5.0], 0.2, -0.4, 0.0), ([100.0, 25.0, 0.0], 0.2 + 0.3 * turn, turn - 0.4, 0.0)];
        let least = least_time(&program, &ends);
        assert_eq!(over_speed(&program, &ends, least), None, "turn {turn}");
        assert!(over_speed(&program, &ends, 0.9 * least).is_some(), "turn {turn}");
    }
}

proptest! {
    #[test]
    fn rapids_keep_the_limits_of_the_check(
        from in prop::array::uniform3(-100.0..100.0_f64), to in prop::array::uniform3(-100.0..100.0_f64),
        a in -1.5..1.5_f64, c in -6.0..6.0_f64, tilt in -1.5..1.5_f64, turn in -7.0..7.0_f64,
    ) {
        let program = program(support::machine());
        let ends = [(from, a, c, 0.0), (to, a + tilt, c + turn, 0.0)];
        prop_assert_eq!(over_speed(&program, &ends, least_time(&program, &ends)), None);
    }
}

/// Out under a turning table and back without a turn, without a stop: each corner takes up by how much the joints became
/// faster on the way out, thousands of times in a row.
#[test]
fn thousands_of_corners_that_each_change_the_pace() {
    let stops = |pairs: u32| -> Vec<Stop> {
        let place = |i: u32| {
            let (out, turns) = (i % 2 == 1, f64::from(i.div_ceil(2)));
            (
                [if out { 60.0 } else { 20.0 }, 0.1 * f64::from(i % 2), 0.0],
                0.5,
                0.4 * turns,
                if i == 0 { 0.0 } else { 1.0 },
            )
        };
        (0..=2 * pairs).map(place).collect()
    };
    for program in [program(support::machine()), with_jerk(50_000.0, 200.0)] {
        let [short, long] = [10, 4000].map(|pairs| ran(&program, MoveKind::Cut, &stops(pairs)));
        assert!(figures(&long).iter().all(|x| x.is_finite()), "{long:?}");
        let ratio = long.time[0].get() / short.time[0].get();
        assert!((ratio / 400.0 - 1.0).abs() < 0.02, "{ratio}");
    }
}

/// Twenty hours in one block, in many, and with the planner of LinuxCNC.
#[test]
fn an_operation_of_twenty_hours() {
    const HOURS: f64 = 20.0 * 3600.0;
    for planning in [Planning::Joints, Planning::LinuxCnc] {
        let program = limited(500.0, 5000.0, 5e4, planning);
        for blocks in [1_u32, 7, 20_000] {
            let time = HOURS / f64::from(blocks);
            let place = |i: u32| {
                let share = f64::from(i) / f64::from(blocks);
                ([122.0 * share, 0.0, 0.0], 0.3, 0.5 * share, if i == 0 { 0.0 } else { time })
            };
            let stops: Vec<Stop> = (0..=blocks).map(place).collect();
            let run = ran(&program, MoveKind::Cut, &stops);
            assert!(figures(&run).iter().all(|x| x.is_finite()), "{run:?}");
            assert!(
                (run.time[0].get() / HOURS - 1.0).abs() < 1e-3,
                "{planning:?}, {blocks} blocks: {} s",
                run.time[0].get()
            );
        }
    }
}
