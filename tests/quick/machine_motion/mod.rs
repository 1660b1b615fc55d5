//! Reached feed, time and deviation of the machine's motion, against closed forms and a brute-force run.

mod active;
mod times;

use crate::support;
use impellerc::base::units::Mm;
use impellerc::five_axis::{Chain, Interpolation, Joints, Machine};
use impellerc::ir::{JointMove, Motion, MotionOperation, MoveKind, Program};
use impellerc::verify::dynamics::{Run, run};
use nalgebra::{Point3, Vector3};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A place of the tool: tip, A, C; and the time that the block to it is programmed with.
type Stop = ([f64; 3], f64, f64, f64);

fn program(machine: Machine) -> Program {
    Program { machine, ..support::channel_only(0.01) }
}

fn motion(program: &Program, kind: MoveKind, stops: &[Stop]) -> Motion {
    let joint = |s: &Stop| program.machine.joints(&Point3::from(s.0), [s.1, s.2]);
    let moves = stops
        .iter()
        .map(|s| JointMove { kind, joints: joint(s), feed: None, time: s.3, pass: 0, stop: false })
        .collect();
    let operation = program.operations.ids().next().unwrap();
    Motion { operations: vec![MotionOperation { operation, labels: vec![String::new()], moves, splines: Vec::new() }] }
}

fn ran(program: &Program, kind: MoveKind, stops: &[Stop]) -> Run {
    run(program, &motion(program, kind, stops), 0, &[])
}

/// Places along X at a speed, mm and mm/s.
fn along_x(places: &[f64], speed: f64) -> Vec<Stop> {
    let time = |i: usize| if i == 0 { 0.0 } else { (places[i] - places[i - 1]).abs() / speed };
    places.iter().enumerate().map(|(i, x)| ([*x, 0.0, 0.0], 0.0, 0.0, time(i))).collect()
}

const A: f64 = 5000.0;

fn near(found: f64, due: f64, within: f64) {
    assert!((found - due).abs() <= within, "{found} is not {due}");
}

#[test]
fn one_axis_runs_in_trapezoids() {
    let program = program(support::machine());
    let cut = |stops: &[Stop]| ran(&program, MoveKind::Cut, stops);
    // Up to speed, even, down; cut into blocks it is the same.
    let whole = cut(&along_x(&[0.0, 100.0], 100.0));
    near(whole.time[0].get(), 100.0 / 100.0 + 100.0 / A, 1e-12);
    near(whole.programmed[0].get(), 1.0, 1e-12);
    let blocks = cut(&along_x(&[0.0, 0.3, 20.0, 20.01, 55.0, 99.5, 100.0], 100.0));
    near(blocks.time[0].get(), 1.0 + 100.0 / A, 1e-9);
    near(blocks.corners.value.get(), 0.0, 1e-9);
    // Too short for its speed.
    near(cut(&along_x(&[0.0, 1.0], 500.0)).time[0].get(), 2.0 * (1.0 / A).sqrt(), 1e-12);
    near(cut(&along_x(&[0.0, 0.1, 0.4, 1.0], 500.0)).time[0].get(), 2.0 * (1.0 / A).sqrt(), 1e-9);
    // The slowest block is run through with half of its feed or less.
    let run = cut(&along_x(&[0.0, 1.0], 500.0));
    near(run.slowest.value.get(), (1.0 / 500.0) / run.time[0].get(), 1e-12);
    // Another feed from the second block on.
    let mut stops = along_x(&[0.0, 50.0, 150.0], 50.0);
    stops[2].3 = 100.0 / 200.0;
    let (v, w) = (50.0, 200.0);
    let due = 50.0 / v + v / (2.0 * A) + 100.0 / w + (w - v).powi(2) / (2.0 * A * w) + w / (2.0 * A);
    near(cut(&stops).time[0].get(), due, 1e-9);
    // Speeds above the limit of the axis are not reached.
    let fast = ran(&program, MoveKind::Rapid, &along_x(&[0.0, 200.0], 1000.0));
    near(fast.time[2].get(), 200.0 / 500.0 + 500.0 / A, 1e-12);
    near(fast.speed[0].value.get(), 1.0, 1e-12);
}

#[test]
fn a_table_turns_in_a_trapezoid() {
    let program = program(support::machine());
    // The tip on the axis of C: nothing else moves.
    let stops = [([0.0; 3], 0.0, -0.5, 0.0), ([0.0; 3], 0.0, 2.0, 2.5 / PI)];
    let run = ran(&program, MoveKind::Rapid, &stops);
    near(run.time[2].get(), 2.5 / PI + PI / 20.0, 1e-9);
    near(run.speed[4].value.get(), 1.0, 1e-9);
}

#[test]
fn a_corner_is_rounded_within_the_tolerance() {
    let program = program(support::machine());
    let chord = program.tolerances.chord.get();
    let stops = [([0.0; 3], 0.0, 0.0, 0.0), ([50.0, 0.0, 0.0], 0.0, 0.0, 0.5), ([50.0, 50.0, 0.0], 0.0, 0.0, 0.5)];
    let run = ran(&program, MoveKind::Cut, &stops);
    // At speed v the corner is rounded in the time v / a, by sqrt(2) v (v / a) / 8.
    let (v, corner) = (100.0, (8.0 * chord * A / 2.0_f64.sqrt()).sqrt());
    let leg = 50.0 / v + v / (2.0 * A) + (v - corner).powi(2) / (2.0 * A * v);
    near(run.time[0].get(), 2.0 * leg, 1e-9);
    near(run.corners.value.get(), chord, 1e-12);
    // The rounded way itself, step by step: X slows down evenly while Y speeds up.
    let t = corner / A;
    let way = |s: f64| {
        let x = -corner * t / 2.0 + corner * s - A * s * s / 2.0;
        (x.powi(2) + (A * s * s / 2.0).powi(2)).sqrt()
    };
    let closest = (0..=10_000).map(|k| way(t * f64::from(k) / 10_000.0)).fold(f64::INFINITY, f64::min);
    near(closest, chord, 1e-8);
}

/// Least time over a path by the smallest steps, in s: `path` gives q' and q'' of the joints by the programmed time.
/// With `signs` a bend that helps is used, which is the true least.
fn brute(machine: &Machine, length: f64, path: &dyn Fn(f64) -> ([f64; 5], [f64; 5]), signs: bool) -> f64 {
    const STEPS: usize = 100_000;
    let (speed, most) = (machine.speeds(), machine.accelerations());
    let width = length / STEPS as f64;
    let at: Vec<_> = (0..=STEPS).map(|i| path(width * i as f64)).collect();
    let cap = |(rate, bend): &([f64; 5], [f64; 5])| {
        (0..5)
            .map(|k| (speed[k] / rate[k].abs()).powi(2).min(most[k] / bend[k].abs()))
            .filter(|c| !c.is_nan())
            .fold(1.0, f64::min)
    };
    // Largest slope of y, forward (1) or backward (-1) in time.
    let slope = |(rate, bend): &([f64; 5], [f64; 5]), y: f64, way: f64| {
        let one = |k: usize| {
            let turned = if signs { way * rate[k].signum() * bend[k] } else { bend[k].abs() };
            2.0 * (most[k] - turned * y).max(0.0) / rate[k].abs()
        };
        (0..5).map(one).filter(|s| !s.is_nan()).fold(f64::INFINITY, f64::min)
    };
    let mut y = vec![0.0; STEPS + 1];
    for i in 1..STEPS {
        y[i] = (y[i - 1] + width * slope(&at[i - 1], y[i - 1], 1.0)).min(cap(&at[i]));
    }
    for i in (1..STEPS).rev() {
        y[i] = f64::min(y[i], y[i + 1] + width * slope(&at[i + 1], y[i + 1], -1.0));
    }
    (0..STEPS).map(|i| 2.0 * width / (y[i].sqrt() + y[i + 1].sqrt())).sum()
}

#[test]
fn a_tip_on_a_line_under_a_turning_table_takes_the_time_of_a_dense_run() {
    // Weak linear axes, so that what they need to follow the table decides.
    for acceleration in [300.0, 600.0, 5000.0] {
        let mut machine = support::machine();
        machine.linear.iter_mut().for_each(|l| l.acceleration = acceleration);
        let program = program(machine);
        let (from, to) = ([60.0, -20.0, 5.0], [40.0, 30.0, -5.0]);
        let (c0, turn, time) = (-FRAC_PI_2, PI, 1.2);
        let stops = [(from, 0.0, c0, 0.0), (to, 0.0, c0 + turn, time)];
        let found = ran(&program, MoveKind::Link, &stops).time[1].get();
        let path = |tau: f64| {
            let q = |s: f64| {
                let t = s / time;
                let tip = Point3::from(std::array::from_fn::<f64, 3, _>(|k| from[k] + (to[k] - from[k]) * t));
                program.machine.joints(&tip, [0.0, c0 + turn * t]).all()
            };
            let h = 1e-4;
            let (a, b, c) = (q(tau - h), q(tau), q(tau + h));
            let rate = std::array::from_fn(|k| (c[k] - a[k]) / (2.0 * h));
            // Joints that run evenly have no bend; differences of them are noise.
            let bend = std::array::from_fn(|k| if k < 2 { (c[k] - 2.0 * b[k] + a[k]) / (h * h) } else { 0.0 });
            (rate, bend)
        };
        let [same, least] = [false, true].map(|signs| brute(&program.machine, time, &path, signs));
        println!("{acceleration} mm/s2: {found:.5} s, dense {same:.5} s, least {least:.5} s, asked for {time} s");
        near(found, same, 0.01 * same);
        assert!(found >= least - 1e-4 && found < 1.15 * least, "{found} {least}");
    }
}

#[test]
fn a_circle_of_chords_takes_the_time_of_the_circle() {
    let program = program(support::machine());
    let (radius, speed, count) = (20.0, 500.0, 1200);
    let place = |k: i32| {
        let angle = TAU * f64::from(k) / f64::from(count);
        [radius * angle.cos(), radius * angle.sin(), 0.0]
    };
    let chord = 2.0 * radius * (PI / f64::from(count)).sin() / speed;
    let stops: Vec<Stop> = (0..=count).map(|k| (place(k), 0.0, 0.0, if k == 0 { 0.0 } else { chord })).collect();
    let run = ran(&program, MoveKind::Cut, &stops);
    let omega = speed / radius;
    let path = |tau: f64| {
        let (sin, cos) = (omega * tau).sin_cos();
        ([-speed * sin, speed * cos, 0.0, 0.0, 0.0], [-speed * omega * cos, -speed * omega * sin, 0.0, 0.0, 0.0])
    };
    let dense = brute(&program.machine, TAU / omega, &path, false);
    println!("chords {:.5} s, circle {dense:.5} s, asked for {:.5} s", run.time[0].get(), TAU / omega);
    near(run.time[0].get(), dense, 0.02 * dense);
    // The corners of so fine a polygon are rounded by less than the sag of its chords.
    let sag = radius * (1.0 - (PI / f64::from(count)).cos());
    assert!(run.corners.value.get() > 0.0 && run.corners.value <= Mm(sag), "{} {sag}", run.corners.value);
}

#[test]
fn the_control_cycle_leaves_the_arc_by_its_sag() {
    let program = program(support::machine());
    // A standing tip 60 mm from C while the table turns: the linear joints run on a circle.
    let (radius, omega) = (60.0, 2.0);
    let stops = [([radius, 0.0, 0.0], 0.0, 0.0, 0.0), ([radius, 0.0, 0.0], 0.0, 2.0, 2.0 / omega)];
    let run = ran(&program, MoveKind::Link, &stops);
    let due = radius * (1.0 - (omega * program.machine.cycle / 2.0).cos());
    near(run.cycle.value.get(), due, 1e-3 * due);
    // Without a corner it is all of the error, and the axis leans nowhere.
    near(run.contour.value.get(), run.cycle.value.get(), 0.0);
    assert_eq!((run.contour.corner.get(), run.orientation.value.get()), (0.0, 0.0));
    near(run.contour.tip[0], radius, 1e-9);
}

#[test]
fn a_turn_that_comes_back_is_rounded_as_its_arc() {
    let program = program(support::machine());
    let (chord, turning) = (program.tolerances.chord.get(), program.machine.rotary[1].acceleration);
    let height = program.tools[program.operations.iter().next().unwrap().1.tool].solid.flute_length;
    // The tip on the axis of C: the table turns to and fro, and nothing else moves.
    let to_and_fro = |radius: f64| {
        let at = |c: f64, time: f64| ([radius, 0.0, 0.0], 0.0, c, time);
        ran(&program, MoveKind::Cut, &[at(0.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)])
    };
    let run = to_and_fro(0.0);
    // A turn of the tool by the angle moves the end of the flutes by no more than the chord tolerance.
    near(run.contour.value.get(), chord, 1e-9);
    near(run.contour.corner.get(), run.contour.value.get(), 1e-12);
    near(run.orientation.value.get(), (chord / height).to_degrees(), 1e-9);
    assert_eq!(run.orientation.at.map(|at| at.index), Some(1));
    // The rounded turn itself, step by step: from a speed to its opposite at the acceleration of the axis.
    let speed = (2.0 * turning * chord / height).sqrt();
    let duration = 2.0 * speed / turning;
    let left = |t: f64| -speed * duration / 2.0 + speed * t - turning * t * t / 2.0;
    let nearest = (0..=10_000).map(|k| left(duration * f64::from(k) / 10_000.0).abs()).fold(f64::INFINITY, f64::min);
    near(nearest.to_degrees(), run.orientation.value.get(), 1e-6 * run.orientation.value.get());
    // Away from the axis of C the cycle comes on top of the corner, in the same block.
    let run = to_and_fro(60.0);
    assert!(run.corners.value.get() > 0.0 && run.cycle.value.get() > 0.0, "{run:?}");
    near(run.contour.value.get(), run.corners.value.get() + run.cycle.value.get(), 1e-12);
    near(run.contour.corner.get(), run.corners.value.get(), 0.0);
    // At rapid nobody asks.
    let stops = [([0.0; 3], 0.0, 0.0, 0.0), ([0.0; 3], 0.0, 1.0, 1.0), ([0.0; 3], 0.0, 0.0, 1.0)];
    let rapid = ran(&program, MoveKind::Rapid, &stops);
    assert_eq!((rapid.contour.value.get(), rapid.orientation.value.get(), rapid.contour.at), (0.0, 0.0, None));
}

#[test]
fn the_error_of_a_block_is_between_the_larger_and_the_sum_of_its_parts() {
    let program = program(support::machine());
    let place = |k: i32| {
        let t = f64::from(k) * 0.05;
        ([30.0 * t.cos(), 20.0 * t.sin(), 3.0 * (2.0 * t).sin()], 0.6 + 0.2 * t.sin(), 0.8 * t, 0.02)
    };
    let stops: Vec<Stop> = (0..200).map(place).collect();
    let run = ran(&program, MoveKind::Cut, &stops);
    let (corner, cycle) = (run.corners.value, run.cycle.value);
    assert!(corner.get() > 0.0 && cycle.get() > 0.0 && run.orientation.value.get() > 0.0, "{run:?}");
    let all = run.contour.value;
    assert!(
        all.get() >= corner.get().max(cycle.get()) && all.get() <= corner.get() + cycle.get(),
        "{all} {corner} {cycle}"
    );
    assert!(run.contour.corner <= corner && all.get() - run.contour.corner.get() <= cycle.get() + 1e-15);
    // The tip that is named is that of the move.
    let index = run.contour.at.unwrap().index as usize;
    (0..3).for_each(|k| near(run.contour.tip[k], stops[index].0[k], 1e-9));
}

#[test]
fn slower_axes_take_longer() {
    let mut last = 0.0;
    for share in [8.0, 1.0, 0.25] {
        let mut machine = support::machine();
        machine.linear.iter_mut().for_each(|l| l.acceleration *= share);
        machine.rotary.iter_mut().for_each(|r| r.acceleration *= share);
        let program = program(machine);
        let place = |k: i32| {
            let t = f64::from(k) * 0.05;
            ([30.0 * t.cos(), 20.0 * t.sin(), 3.0 * (2.0 * t).sin()], 0.6 + 0.2 * t.sin(), 0.8 * t, 0.02)
        };
        let stops: Vec<Stop> = (0..200).map(place).collect();
        let run = ran(&program, MoveKind::Cut, &stops);
        assert!(run.time[0].get() > last && run.time[0].get() >= run.programmed[0].get(), "{share}: {run:?}");
        last = run.time[0].get();
    }
}

/// A machine whose linear axes have a limit of jerk, mm/s3, and the rotary ones too, rad/s3.
fn with_jerk(linear: f64, rotary: f64) -> Program {
    let mut machine = support::machine();
    machine.linear.iter_mut().for_each(|l| l.jerk = linear);
    machine.rotary.iter_mut().for_each(|r| r.jerk = rotary);
    program(machine)
}

/// Time of an S-curve between two speeds.
fn curve(from: f64, to: f64, a: f64, j: f64) -> f64 {
    let change = (to - from).abs();
    if change * j >= a * a { change / a + a / j } else { 2.0 * (change / j).sqrt() }
}

#[test]
fn with_jerk_one_axis_runs_in_seven_phases() {
    const J: f64 = 50_000.0;
    let program = with_jerk(J, 200.0);
    for (places, speed) in [(vec![0.0, 100.0], 100.0), (vec![0.0, 0.3, 20.0, 20.01, 55.0, 100.0], 100.0)] {
        let run = ran(&program, MoveKind::Cut, &along_x(&places, speed));
        let ramp = curve(0.0, speed, A, J);
        let due = 2.0 * ramp + (100.0 - speed * ramp) / speed;
        println!("{:.5} s, seven phases {due:.5} s", run.time[0].get());
        assert!(run.time[0].get() >= due - 1e-9 && run.time[0].get() <= 1.05 * due, "{} {due}", run.time[0].get());
        // Without the jerk it is the trapezoid, and that is the bound.
        near(run.within_accelerations[0].get(), 1.0 + 100.0 / A, 1e-9);
        near(run.programmed[0].get(), 1.0, 1e-9);
        assert!(run.jerk[0].value.get() > 0.9 && run.jerk[0].value.get() <= 1.0 + 1e-9, "{:?}", run.jerk);
        assert!(run.jerk[1].value.get() == 0.0 && run.jerk[4].value.get() == 0.0);
    }
    // Large limits of jerk are none.
    let run = ran(&with_jerk(1e9, 1e6), MoveKind::Cut, &along_x(&[0.0, 100.0], 100.0));
    near(run.time[0].get(), run.within_accelerations[0].get(), 0.01 * run.time[0].get());
    // A turning table: the tip on the axis of C.
    let stops = [([0.0; 3], 0.0, -0.5, 0.0), ([0.0; 3], 0.0, 2.0, 2.5 / PI)];
    let run = ran(&program, MoveKind::Rapid, &stops);
    let ramp = curve(0.0, PI, 20.0, 200.0);
    let due = 2.0 * ramp + (2.5 - PI * ramp) / PI;
    assert!(run.time[2].get() >= due - 1e-9 && run.time[2].get() <= 1.15 * due, "{} {due}", run.time[2].get());
    assert!(run.jerk[4].value.get() > 0.9 && run.jerk[4].value.get() <= 1.0 + 1e-9);
}

#[test]
fn with_jerk_a_corner_is_rounded_by_a_pulse() {
    const J: f64 = 50_000.0;
    let program = with_jerk(J, 200.0);
    let chord = program.tolerances.chord.get();
    let stops = [([0.0; 3], 0.0, 0.0, 0.0), ([50.0, 0.0, 0.0], 0.0, 0.0, 0.5), ([50.0, 50.0, 0.0], 0.0, 0.0, 0.5)];
    let run = ran(&program, MoveKind::Cut, &stops);
    // Both axes change their speed by v in the time 2 sqrt(v / j), so that the corner is left by sqrt(2) v t / 8 at most.
    let corner = (4.0 * chord * J.sqrt() / 2.0_f64.sqrt()).cbrt().powi(2);
    assert!(
        run.corners.value <= Mm(chord + 1e-12) && run.corners.value > Mm(0.9 * chord),
        "{} {chord}",
        run.corners.value
    );
    // The pulse itself, step by step: the way from the corner in its middle is v t / 12.
    let (t, v) = (curve(0.0, corner, A, J), corner);
    let (steps, mut speed, mut way) = (100_000, 0.0, 0.0);
    for i in 0..steps / 2 {
        let at = (f64::from(i) + 0.5) * t / f64::from(steps);
        speed += J * at * t / f64::from(steps);
        way += speed * t / f64::from(steps);
    }
    near(way, v * t / 12.0, 1e-3 * way);
    assert!(2.0_f64.sqrt() * v * t / 12.0 <= chord);
    // Speeding up, even, slowing down to the speed of the corner, and the same again.
    let (ramp, slow) = (curve(0.0, 100.0, A, J), curve(corner, 100.0, A, J));
    let even = (50.0 - 50.0 * ramp - 0.5 * (100.0 + corner) * slow) / 100.0;
    let due = 2.0 * (ramp + slow + even);
    println!("corner at {corner:.2} mm/s: {:.5} s, S-curves {due:.5} s", run.time[0].get());
    assert!(run.time[0].get() >= due * (1.0 - 1e-6) && run.time[0].get() <= 1.1 * due, "{} {due}", run.time[0].get());
    assert!(run.time[0].get() > run.within_accelerations[0].get());
}

#[test]
fn less_jerk_takes_longer() {
    let place = |k: i32| {
        let t = f64::from(k) * 0.05;
        ([30.0 * t.cos(), 20.0 * t.sin(), 3.0 * (2.0 * t).sin()], 0.6 + 0.2 * t.sin(), 0.8 * t, 0.05)
    };
    let stops: Vec<Stop> = (0..200).map(place).collect();
    let mut last = 0.0;
    for share in [16.0, 4.0, 1.0, 0.25] {
        let run = ran(&with_jerk(50_000.0 * share, 200.0 * share), MoveKind::Cut, &stops);
        println!("{share}: {:.4} s, without jerk {:.4} s", run.time[0].get(), run.within_accelerations[0].get());
        assert!(run.time[0].get() > last && run.time[0].get() >= run.within_accelerations[0].get(), "{share}: {run:?}");
        assert!(run.jerk.iter().all(|j| j.value.get() <= 1.0 + 1e-9), "{run:?}");
        last = run.time[0].get();
    }
}

#[test]
fn other_rules_leave_the_motion_by_their_closed_forms() {
    let machine = support::machine();
    let joints = |tip: [f64; 3], a: f64, c: f64| -> Joints { machine.joints(&Point3::from(tip), [a, c]) };
    // A stays, C turns: the axis runs on a small circle, the great circle through its ends leaves it most in the middle.
    let (a, turn, height) = (0.7_f64, 0.4_f64, 30.0);
    let (from, to) = (joints([40.0, 0.0, 0.0], a, 0.1), joints([41.0, 0.0, 0.0], a, 0.1 + turn));
    let found = Interpolation::GreatCircle.deviation(&machine, [&from, &to], 100.0, height);
    let angle = a - (a.tan() * (turn / 2.0).cos()).atan();
    near(found, 2.0 * (angle / 2.0).sin() * height, 1e-9);
    let dense = (0..=1000).map(|k| {
        let [p, q] = [Interpolation::GreatCircle, Interpolation::RotaryLinear]
            .map(|rule| rule.pose(&machine, [&from, &to], 100.0, f64::from(k) / 1000.0));
        ((p.tip + p.axis * height) - (q.tip + q.axis * height)).norm()
    });
    let dense = dense.fold(0.0, f64::max);
    assert!(found <= dense + 1e-12 && found > 0.99 * dense, "{found} {dense}");
    // A standing tip at a radius while all joints run straight: the sag of the arc.
    let (from, to) = (joints([60.0, 0.0, 0.0], 0.0, 0.0), joints([60.0, 0.0, 0.0], 0.0, turn));
    let found = Interpolation::JointsLinear.deviation(&machine, [&from, &to], 100.0, height);
    near(found, 60.0 * (1.0 - (turn / 2.0).cos()), 1e-9);
    assert_eq!(Interpolation::RotaryLinear.deviation(&machine, [&from, &to], 100.0, height), 0.0);
}

proptest! {
    /// No sample of a dense one is over the bound, and the bound is hardly over the samples.
    #[test]
    fn no_sample_of_the_joints_is_faster_than_the_bound(
        tip in prop::array::uniform3(-80.0..80.0_f64), way in prop::array::uniform3(-1.0..1.0_f64),
        length in 0.0..200.0_f64, a in -1.5..1.5_f64, c in -6.0..6.0_f64,
        tilt in -2.0..2.0_f64, turn in -7.0..7.0_f64, share in 0.0..1.0_f64,
    ) {
        let machine = Machine {
            chain: support::shifted(&Chain::tilting_table(), [[3.0, 20.0, 10.0], [-2.0, 1.0, 0.0]]),
            ..support::machine()
        };
        let (tip, way) = (Point3::from(tip), Vector3::from(way) * length);
        let at = |s: f64| machine.joints(&(tip + way * s), [a + tilt * share * s, c + turn * share * s]);
        let found = machine.largest_rates(&at(0.0), &at(1.0), 0.0);
        let mut most = [0.0_f64; 5];
        let places = 4000;
        for k in 0..places {
            let [p, q] = [k, k + 1].map(|k| at(f64::from(k) / f64::from(places)));
            let d = (q.xyz - p.xyz).abs() * f64::from(places);
            let [a, c] = [0, 1].map(|k| (q.rotary[k] - p.rotary[k]).abs() * f64::from(places));
            for (most, d) in most.iter_mut().zip([d.x, d.y, d.z, a, c]) {
                *most = most.max(d);
            }
        }
        // What the speeds of the joints add up from; they may cancel.
        let [tilting, turning] = machine.chain.axes().map(|axis| axis.point);
        let arm = |s: f64| (at(s).xyz - tilting.coords).norm() + (turning - tilting).norm();
        let parts = way.norm() + (tilt.abs() + turn.abs()) * share * arm(0.0).max(arm(1.0)) + 1e-9;
        for (found, most) in found.iter().zip(most) {
            prop_assert!(most <= found + 1e-9 * parts, "{found} {most}");
            prop_assert!(found - most <= 1e-3 * parts, "{found} {most}");
        }
    }
}
