//! Active limits of runs for which they follow from closed forms.

use super::{A, Stop, along_x, motion, near, program, ran, support};
use impellerc::base::entity::PrimaryMap;
use impellerc::base::units::{MmPerMin, Share};
use impellerc::five_axis::Machine;
use impellerc::five_axis::control::Planning;
use impellerc::ir::{MoveKind, Operation, Program};
use impellerc::verify::dynamics::{MotionLimit, Run, run};
use std::f64::consts::{PI, TAU};

/// The program with a process feed, mm/s.
fn with_feed(program: Program, feed: f64) -> Program {
    let mut operations = PrimaryMap::new();
    for (_, o) in program.operations.iter() {
        operations.push(Operation { feed: MmPerMin(60.0 * feed), ..o.clone() });
    }
    Program { operations, ..program }
}

/// Time of a limit in a kind of moves.
fn time(run: &Run, kind: usize, limit: MotionLimit, axis: Option<&str>) -> f64 {
    let own = run.limits.iter().filter(|l| l.limit == limit && l.axis.as_deref() == axis);
    own.map(|l| l.time[kind].get()).sum()
}

/// Whether the times of all limits are the time of the run.
pub(super) fn are_whole(run: &Run) -> bool {
    (0..3).all(|kind| {
        let (sum, time) = (run.limits.iter().map(|l| l.time[kind].get()).sum::<f64>(), run.time[kind].get());
        (sum - time).abs() <= 1e-9 * time
    })
}

#[test]
fn a_trapezoid_is_acceleration_and_feed() {
    let stops = along_x(&[0.0, 0.3, 20.0, 20.01, 55.0, 99.5, 100.0], 100.0);
    let run = ran(&with_feed(program(support::machine()), 100.0), MoveKind::Cut, &stops);
    near(time(&run, 0, MotionLimit::Acceleration, Some("X")), 2.0 * 100.0 / A, 1e-9);
    near(time(&run, 0, MotionLimit::Feed, None), 1.0 - 100.0 / A, 1e-9);
    assert!(are_whole(&run), "{run:?}");
    // Blocks with half of the process feed, and nothing that demands it.
    let run = ran(&with_feed(program(support::machine()), 200.0), MoveKind::Cut, &stops);
    near(time(&run, 0, MotionLimit::BlockFeed, None), 1.0 - 100.0 / A, 1e-9);
    assert_eq!(time(&run, 0, MotionLimit::Feed, None), 0.0);
}

/// Blocks with half of the process feed: by removal where this feed is near a limit of removal.
#[test]
fn lower_feeds_count_for_removal_where_it_is_near() {
    let stops = along_x(&[0.0, 0.3, 20.0, 20.01, 55.0, 99.5, 100.0], 100.0);
    let steady = 1.0 - 100.0 / A;
    for (process, share, [feed, removal, block]) in
        [(200.0, 0.9, [0.0, steady, 0.0]), (200.0, 0.7, [0.0, 0.0, steady]), (100.0, 0.9, [steady, 0.0, 0.0])]
    {
        let program = with_feed(program(support::machine()), process);
        let run = run(&program, &motion(&program, MoveKind::Cut, &stops), 0, &[Share(share); 7]);
        near(time(&run, 0, MotionLimit::Feed, None), feed, 1e-9);
        near(time(&run, 0, MotionLimit::Removal, None), removal, 1e-9);
        near(time(&run, 0, MotionLimit::BlockFeed, None), block, 1e-9);
        assert!(are_whole(&run), "{run:?}");
    }
    // Only the blocks that have a share.
    let program = with_feed(program(support::machine()), 200.0);
    let run = run(&program, &motion(&program, MoveKind::Cut, &stops), 0, &[0.0, 0.0, 0.9].map(Share));
    near(time(&run, 0, MotionLimit::Removal, None), 0.197, 0.01);
}

#[test]
fn speeds_of_axes_are_named() {
    let machine = Machine { rapid: 1000.0, ..support::machine() };
    let run = ran(&program(machine), MoveKind::Rapid, &along_x(&[0.0, 200.0], 1000.0));
    near(time(&run, 2, MotionLimit::Speed, Some("X")), 200.0 / 500.0 - 500.0 / A, 1e-9);
    near(time(&run, 2, MotionLimit::Acceleration, Some("X")), 2.0 * 500.0 / A, 1e-9);
    let stops = [([0.0; 3], 0.0, -0.5, 0.0), ([0.0; 3], 0.0, 2.0, 2.5 / PI)];
    let run = ran(&program(support::machine()), MoveKind::Rapid, &stops);
    near(time(&run, 2, MotionLimit::Speed, Some("C")), 2.5 / PI - PI / 20.0, 1e-9);
    near(time(&run, 2, MotionLimit::Acceleration, Some("C")), 2.0 * PI / 20.0, 1e-9);
    assert!(are_whole(&run), "{run:?}");
}

/// On a circle the accelerations of X and Y are the components of v^2 / r. A pace of 0.75 is 0.5625 of the limit. At a
/// share of 0.7 X takes it over the angles where the cosine is at least 0.5625 / 0.7.
#[test]
fn on_a_circle_x_and_y_take_turns() {
    // So many that speeding up and braking take less than a hundredth of the time.
    const LAPS: u32 = 40;
    const CHORDS: u32 = 720;
    let (radius, share) = (10.0, 0.7);
    let v = (share * A * radius).sqrt();
    let step = TAU / f64::from(CHORDS);
    let chord = 2.0 * radius * (0.5 * step).sin();
    let place = |k: u32| {
        let angle = step * f64::from(k);
        ([radius * angle.cos(), radius * angle.sin(), 0.0], 0.0, 0.0, if k == 0 { 0.0 } else { chord / v })
    };
    let stops: Vec<Stop> = (0..=LAPS * CHORDS).map(place).collect();
    let run = ran(&with_feed(program(support::machine()), 2.0 * v), MoveKind::Cut, &stops);
    let due = 4.0 * (0.5625_f64 / share).acos() / TAU * run.time[0].get();
    for axis in ["X", "Y"] {
        near(time(&run, 0, MotionLimit::Acceleration, Some(axis)), due, 0.03 * due);
    }
    near(time(&run, 0, MotionLimit::BlockFeed, None), run.time[0].get() - 2.0 * due, 0.05 * due);
    assert!(are_whole(&run), "{run:?}");
    // The same blocks where the job asks for no more.
    let run = ran(&with_feed(program(support::machine()), v), MoveKind::Cut, &stops);
    assert!(time(&run, 0, MotionLimit::Feed, None) > 0.95 * run.time[0].get(), "{:?}", run.limits);
}

/// A staircase whose feed was lowered to that of its corners: the half blocks beside corners belong to them, and the
/// outer halves of the first and the last block to nothing.
#[test]
fn a_feed_that_was_lowered_for_corners_belongs_to_them() {
    const LEGS: usize = 20;
    let program = with_feed(program(support::machine()), 100.0);
    let chord = program.tolerances.chord.get();
    let (v, leg) = ((8.0 * chord * A / 2.0_f64.sqrt()).sqrt(), 2.0);
    let stops: Vec<Stop> = (0..=LEGS)
        .map(|k| {
            let (x, y) = (k.div_ceil(2) as f64 * leg, (k / 2) as f64 * leg);
            ([x, y, 0.0], 0.0, 0.0, if k == 0 { 0.0 } else { leg / v })
        })
        .collect();
    let run = ran(&program, MoveKind::Cut, &stops);
    near(time(&run, 0, MotionLimit::Corner, None), (LEGS - 1) as f64 * leg / v, 1e-6);
    near(time(&run, 0, MotionLimit::BlockFeed, None), leg / v - v / A, 1e-6);
    assert!(are_whole(&run), "{run:?}");
    // At half of that feed the corners hold nothing.
    let slow: Vec<Stop> = stops.iter().map(|s| (s.0, s.1, s.2, 2.0 * s.3)).collect();
    assert_eq!(time(&ran(&program, MoveKind::Cut, &slow), 0, MotionLimit::Corner, None), 0.0);
}

/// A ramp from rest to the speed v has jerk for the times a/j at both ends, and acceleration for v/a - a/j between them.
/// Where v j is less than a^2 the acceleration is not reached, and the ramp takes 2 sqrt(v/j).
#[test]
fn with_jerk_the_ends_of_a_ramp_are_jerk() {
    let v = 450.0;
    let found = |jerk: f64| {
        let run = ran(&with_feed(super::with_jerk(jerk, 200.0), v), MoveKind::Cut, &along_x(&[-200.0, 200.0], v));
        assert!(are_whole(&run), "{run:?}");
        let times = [MotionLimit::Jerk, MotionLimit::Acceleration].map(|l| time(&run, 0, l, Some("X")));
        println!("jerk {jerk}: {times:?} s; {:?}", run.limits);
        times
    };
    let [jerk, even] = found(50_000.0);
    let whole = 2.0 * 2.0 * (v / 50_000.0_f64).sqrt();
    assert!(jerk > 0.8 * whole && jerk + even < 1.1 * whole, "{jerk} {even} {whole}");
    let [jerk, even] = found(1_000_000.0);
    let (ends, between) = (4.0 * A / 1_000_000.0, 2.0 * (v / A - A / 1_000_000.0));
    assert!(jerk < 3.0 * ends && even > 0.8 * between, "{jerk} {ends} {even} {between}");
    assert!(jerk + even < 1.1 * (ends + between), "{jerk} {even}");
}

#[test]
fn linuxcnc_runs_a_line_in_a_trapezoid() {
    let machine = Machine { planning: Planning::LinuxCnc, cycle: 1e-4, ..support::machine() };
    let run = ran(&with_feed(program(machine), 100.0), MoveKind::Cut, &along_x(&[0.0, 100.0], 100.0));
    near(time(&run, 0, MotionLimit::Acceleration, Some("X")), 2.0 * 100.0 / A, 1e-3);
    near(time(&run, 0, MotionLimit::Feed, None), 1.0 - 100.0 / A, 1e-3);
    assert!(are_whole(&run), "{run:?}");
}
