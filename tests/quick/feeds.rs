//! Runs of the axes within speed, acceleration and jerk, against closed forms, brute force and finite differences.

use impellerc::five_axis::feedrate::{AXES, Axes, Limits, Profile, Rounding, Station, jerk, plan};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};

const FREE: f64 = f64::INFINITY;

const ROUNDING: Rounding = Rounding { tolerance: 0.002, height: 20.0 };

/// A machine like 5MC850-C, in mm, rad and s.
fn limits() -> Limits {
    Limits {
        speed: [500.0, 500.0, 500.0, 1.6755, PI],
        acceleration: [5000.0, 5000.0, 5000.0, 20.0, 20.0],
        jerk: [5e4, 5e4, 5e4, 200.0, 200.0],
    }
}

fn without_jerk() -> Limits {
    Limits { jerk: [FREE; AXES], ..limits() }
}

fn near(found: f64, due: f64, within: f64) {
    assert!((found - due).abs() <= within, "{found} is not {due}");
}

/// Stations through places of the tip and joints, at a feed along the tip, mm/s.
fn stations(places: &[([f64; 3], Axes)], feed: f64) -> Vec<Station> {
    let way = |a: &[f64; 3], b: &[f64; 3]| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
    (0..places.len())
        .map(|i| {
            let time = if i == 0 { 1.0 } else { way(&places[i].0, &places[i - 1].0) / feed };
            Station { joints: places[i].1, tip: places[i].0, time }
        })
        .collect()
}

/// The tip moves as the linear axes do, and nothing turns.
fn linear(points: &[[f64; 3]], feed: f64) -> Vec<Station> {
    let places: Vec<_> = points.iter().map(|p| (*p, [p[0], p[1], p[2], 0.0, 0.0])).collect();
    stations(&places, feed)
}

fn along_x(length: f64, pieces: usize, feed: f64) -> Vec<Station> {
    let points: Vec<[f64; 3]> = (0..=pieces).map(|i| [length * i as f64 / pieces as f64, 0.0, 0.0]).collect();
    linear(&points, feed)
}

/// Time of the seven phases from rest to rest, with speed, acceleration and jerk of one axis.
fn seven_phases(length: f64, v: f64, a: f64, j: f64) -> f64 {
    let ramp = |v: f64| if v * j >= a * a { v / a + a / j } else { 2.0 * (v / j).sqrt() };
    // Speeding up and slowing down go over v * ramp(v) together.
    if v * ramp(v) <= length {
        return 2.0 * ramp(v) + (length - v * ramp(v)) / v;
    }
    let (mut low, mut high) = (0.0, v);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        (low, high) = if middle * ramp(middle) < length { (middle, high) } else { (low, middle) };
    }
    2.0 * ramp(low)
}

/// Largest speeds, accelerations and jerks as shares of their limits, from differences of positions at even times. The
/// run is rebuilt from its spans alone; the creeping ends are left out.
fn differences(profile: &Profile, limits: &Limits, steps: f64) -> [f64; 3] {
    let step = profile.time / steps;
    let part = |y: &[f64; 3], x: f64| {
        let (a, b) = (y[0] + (y[1] - y[0]) * x, y[1] + (y[2] - y[1]) * x);
        [y[0], a, a + (b - a) * x]
    };
    let (mut t, mut next, mut q) = (0.0, step, [0.0; AXES]);
    let mut places: Vec<Axes> = Vec::new();
    for leg in &profile.legs {
        let whole = jerk::time(leg.width, leg.y);
        while next < t + whole {
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..60 {
                let x = 0.5 * (low + high);
                let before = t + jerk::time(leg.width * x, part(&leg.y, x)) < next;
                (low, high) = if before { (x, high) } else { (low, x) };
            }
            let x = low;
            places.push(std::array::from_fn(|k| {
                let [a, b, c] = part(&leg.rate.map(|r| r[k]), x);
                q[k] + leg.width * x * (a + b + c) / 3.0
            }));
            next += step;
        }
        t += whole;
        for k in 0..AXES {
            q[k] += leg.width * leg.rate.iter().map(|r| r[k]).sum::<f64>() / 3.0;
        }
    }
    let mut found = [0.0_f64; 3];
    for k in 0..AXES {
        let mut values: Vec<f64> = places.iter().map(|p| p[k]).collect();
        for (order, limit) in [limits.speed[k], limits.acceleration[k], limits.jerk[k]].into_iter().enumerate() {
            values = values.windows(2).map(|w| (w[1] - w[0]) / step).collect();
            found[order] = values.iter().fold(found[order], |m, v| m.max(v.abs() / limit));
        }
    }
    found
}

/// Shares of bounds and of differences are within the limits, and times are in order.
fn holds(name: &str, profile: &Profile, limits: &Limits) {
    let found = differences(profile, limits, 20_000.0);
    let shares = profile.shares.map(|s| s.iter().copied().fold(0.0, f64::max));
    println!(
        "{name}: {:.5} s, at least {:.5} s, ratio {:.4}; shares {shares:.4?}, by differences {found:.4?}; {} spans",
        profile.time,
        profile.least,
        profile.time / profile.least,
        profile.legs.len()
    );
    assert!(profile.time >= profile.least, "{name}");
    for order in 0..3 {
        assert!(shares[order] <= 1.0 + 1e-9, "{name}: {shares:?}");
        // Differences of the third order of 20000 places carry rounding of some 1e-4 of the limit.
        assert!(found[order] <= shares[order] + 2e-3, "{name}: {found:?} {shares:?}");
    }
    // Never above the process feed.
    assert!(profile.segments.iter().skip(1).all(|s| s.share <= 1.0 && s.time > 0.0), "{name}");
    let sum: f64 = profile.segments.iter().map(|s| s.time).sum();
    near(sum, profile.time, 1e-9 * sum);
}

#[test]
fn without_limits_of_jerk_one_axis_runs_in_trapezoids() {
    let a = limits().acceleration[0];
    for pieces in [1, 7, 100] {
        let plan = |length: f64, feed: f64| plan(&along_x(length, pieces, feed), &without_jerk(), &ROUNDING);
        // Up to speed, even, down; too short for its speed; faster than the axis.
        near(plan(100.0, 100.0).time, 1.0 + 100.0 / a, 1e-9);
        near(plan(1.0, 500.0).time, 2.0 * (1.0 / a).sqrt(), 1e-9);
        near(plan(200.0, 900.0).time, 200.0 / 500.0 + 500.0 / a, 1e-9);
        // The bound is met.
        near(plan(100.0, 100.0).least, 1.0 + 100.0 / a, 1e-9);
    }
}

/// Changes of speed that are far shorter than the block: the way to them has no knots of its own.
#[test]
fn a_slow_long_block_takes_its_time() {
    for (length, feed) in [(200.0, 0.0017), (200.0, 0.1), (1000.0, 1.0), (0.1, 0.0017)] {
        for limits in [limits(), Limits { acceleration: [1.0; AXES], jerk: [1.0; AXES], ..limits() }] {
            for pieces in [1, 2, 7] {
                let run = plan(&along_x(length, pieces, feed), &limits, &ROUNDING);
                let due = length / feed;
                let [a, j] = [limits.acceleration[0], limits.jerk[0]];
                let most = seven_phases(length, feed, a, j) * 1.05;
                assert!(run.time >= due && run.time <= most, "{length} mm at {feed} mm/s: {} s, {due} s", run.time);
                assert!(run.segments[1..].iter().all(|s| s.time > 0.0 && s.share > 0.9), "{:?}", run.segments);
            }
        }
    }
}

#[test]
fn one_axis_takes_little_more_than_the_seven_phases() {
    let l = limits();
    for (length, feed, pieces, most) in [
        (10.0, 4.0, 1, 1.005),
        (10.0, 4.0, 20, 1.005),
        (100.0, 100.0, 1, 1.01),
        (300.0, 500.0, 600, 1.03),
        (1.0, 500.0, 1, 1.04),
        (0.01, 4.0, 1, 1.04),
    ] {
        let run = plan(&along_x(length, pieces, feed), &l, &ROUNDING);
        let due = seven_phases(length, feed.min(l.speed[0]), l.acceleration[0], l.jerk[0]);
        println!("{length} mm at {feed} mm/s: {:.6} s, seven phases {due:.6} s, {:.4}", run.time, run.time / due);
        holds("line", &run, &l);
        assert!(run.time >= due * (1.0 - 1e-9) && run.time <= most * due, "{} {due}", run.time);
    }
}

fn circle(radius: f64, pieces: usize) -> Vec<[f64; 3]> {
    (0..=pieces)
        .map(|i| {
            let angle = TAU * i as f64 / pieces as f64;
            [radius * angle.cos(), radius * angle.sin(), 0.0]
        })
        .collect()
}

#[test]
fn a_circle_runs_at_its_feed_or_as_fast_as_the_axes_hold_the_curve() {
    let l = limits();
    let (radius, pieces) = (20.0, 1200);
    let path = circle(radius, pieces);
    let chords = 2.0 * radius * (PI / pieces as f64).sin() * pieces as f64;
    // Below v^2/r = a and v^3/r^2 = j: the feed everywhere but at the ends.
    let slow = plan(&linear(&path, 50.0), &l, &ROUNDING);
    holds("circle", &slow, &l);
    let ends = 2.0 * (50.0 / l.jerk[0]).sqrt();
    assert!(slow.time >= chords / 50.0 && slow.time <= chords / 50.0 + 2.0 * ends, "{slow:?}", slow = slow.time);
    assert_eq!(slow.segments[pieces / 2].share, 1.0);
    // Without a limit of jerk, asked for more: where the curve is along an axis, v^2/r is at most a.
    let fast = plan(&linear(&path, 480.0), &without_jerk(), &ROUNDING);
    let along = fast.segments[pieces / 2].share * 480.0;
    near(along, (l.acceleration[0] * radius).sqrt(), 0.01 * along);
    // With one, no faster than v^3/r^2 = j by more than what a change of speed gains.
    let fast = plan(&linear(&path, 480.0), &l, &ROUNDING);
    holds("fast circle", &fast, &l);
}

#[test]
fn corners_are_rounded_as_far_as_the_tolerance_lets_them() {
    let l = limits();
    let square = [[0.0; 3], [50.0, 0.0, 0.0], [50.0, 50.0, 0.0], [0.0, 50.0, 0.0], [0.0; 3]];
    for feed in [4.0, 100.0] {
        let run = plan(&linear(&square, feed), &l, &ROUNDING);
        holds("square", &run, &l);
        // As slow as the tolerance asks for, a corner costs hardly less than a stop; the spans in which y'' is even cost
        // 2.3 % here.
        let stops = 4.0 * seven_phases(50.0, feed, l.acceleration[0], l.jerk[0]);
        assert!(run.time < 1.025 * stops, "{} {stops}", run.time);
        // The path leaves the corner by the tolerance: that of the corner and the nearest point of the run.
        let mut nearest = FREE;
        let mut at = [0.0; 2];
        for leg in &run.legs {
            for k in 0..2 {
                at[k] += leg.width * leg.rate.iter().map(|r| r[k]).sum::<f64>() / 3.0;
            }
            let start = run.creep[0][0] * run.legs[0].rate[0][0];
            nearest = nearest.min((at[0] + start - 50.0).hypot(at[1]));
        }
        near(nearest, ROUNDING.tolerance, 1e-6);
    }
}

/// A helix on a cone, with the tool leaning along its slope: all five axes move.
fn helix(turns: f64, pieces: usize) -> Vec<([f64; 3], Axes)> {
    (0..=pieces)
        .map(|i| {
            let t = i as f64 / pieces as f64;
            let (angle, r) = (TAU * turns * t, 10.0 + 20.0 * t);
            let tip = [r * angle.cos(), r * angle.sin(), -30.0 * t];
            (tip, [r * (0.3 * angle).cos(), r * (0.3 * angle).sin(), -30.0 * t, 0.5 + 0.2 * t, 0.35 * angle])
        })
        .collect()
}

#[test]
fn a_helix_on_a_cone_keeps_all_limits() {
    let l = limits();
    for feed in [4.0, 40.0, 200.0] {
        holds("helix", &plan(&stations(&helix(3.0, 3000), feed), &l, &ROUNDING), &l);
    }
}

/// Least time over the spans of a run by dynamic programming over levels of y, straight between knots, with rows at
/// places inside of the spans.
fn brute(profile: &Profile, limits: &Limits, cap: f64, levels: usize) -> f64 {
    const INSIDE: usize = 6;
    let level = |i: usize| cap * (i as f64 / levels as f64).powi(2);
    let mut best = vec![FREE; levels + 1];
    best[0] = 0.0;
    for leg in &profile.legs {
        let at = |x: f64, k: usize| {
            let [a, b, c] = leg.rate.map(|r| r[k]);
            let rate = a * (1.0 - x).powi(2) + 2.0 * b * x * (1.0 - x) + c * x * x;
            (rate, 2.0 * ((b - a) * (1.0 - x) + (c - b) * x) / leg.width)
        };
        let places: Vec<[(f64, f64); AXES]> =
            (0..=INSIDE).map(|p| std::array::from_fn(|k| at(p as f64 / INSIDE as f64, k))).collect();
        let most_rate: f64 = (0..=levels)
            .rev()
            .map(level)
            .find(|y| {
                places.iter().all(|p| (0..AXES).all(|k| p[k].0.abs() * y.sqrt() <= limits.speed[k] * (1.0 + 1e-9)))
            })
            .unwrap();
        let mut next = vec![FREE; levels + 1];
        for (from, &so_far) in best.iter().enumerate() {
            if so_far == FREE {
                continue;
            }
            for (to, next) in next.iter_mut().enumerate() {
                let (y, z) = (level(from), level(to));
                if z > most_rate || y > most_rate || from + to == 0 {
                    continue;
                }
                let slope = (z - y) / leg.width;
                let keeps = places.iter().enumerate().all(|(p, place)| {
                    let here = y + (z - y) * p as f64 / INSIDE as f64;
                    (0..AXES).all(|k| (place[k].1 * here + 0.5 * place[k].0 * slope).abs() <= limits.acceleration[k])
                });
                if keeps {
                    *next = next.min(so_far + 2.0 * leg.width / (y.sqrt() + z.sqrt()));
                }
            }
        }
        best = next;
    }
    best[0]
}

#[test]
fn two_passes_are_as_fast_as_dynamic_programming() {
    let mut l = without_jerk();
    l.acceleration = [800.0, 800.0, 800.0, 4.0, 4.0];
    let places = helix(0.4, 40);
    let run = plan(&stations(&places, 120.0), &l, &ROUNDING);
    let cap = run.legs.iter().flat_map(|leg| leg.y).fold(0.0, f64::max);
    let [coarse, dense] = [300, 600].map(|levels| brute(&run, &l, cap, levels));
    println!(
        "two passes {:.5} s, dynamic programming {coarse:.5} and {dense:.5} s, bound {:.5} s",
        run.time, run.least
    );
    // Levels cost the dense run something; rows of Bernstein coefficients cost the two passes something.
    assert!(run.time <= 1.01 * dense && run.time >= 0.97 * dense, "{} {dense}", run.time);
    assert!(run.least <= run.time && run.least >= 0.85 * run.time, "{} {}", run.least, run.time);
}

#[test]
fn standing_stations_and_few_stations_are_no_trouble() {
    let l = limits();
    assert_eq!(plan(&[], &l, &ROUNDING).time, 0.0);
    assert_eq!(plan(&along_x(1.0, 1, 4.0)[..1], &l, &ROUNDING).time, 0.0);
    let mut line = along_x(10.0, 10, 4.0);
    let stands = line[5];
    line.insert(6, stands);
    let run = plan(&line, &l, &ROUNDING);
    let due = 2.0 * seven_phases(5.0, 4.0, l.acceleration[0], l.jerk[0]) + stands.time;
    assert!(run.time >= due && run.time <= 1.01 * due, "{} {due}", run.time);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    #[test]
    fn any_polygon_keeps_all_limits(
        steps in prop::collection::vec((prop::array::uniform5(-1.0..1.0_f64), 0.01..20.0_f64), 2..40),
        feed in 1.0..400.0_f64,
    ) {
        let l = limits();
        let mut joints = [0.0; AXES];
        let mut places = vec![([0.0; 3], joints)];
        for (step, size) in steps {
            for k in 0..AXES {
                joints[k] += step[k] * size * if k < 3 { 1.0 } else { 0.02 };
            }
            places.push(([joints[0], joints[1], joints[2]], joints));
        }
        let run = plan(&stations(&places, feed), &l, &ROUNDING);
        prop_assert!(run.time.is_finite() && run.time >= run.least);
        for order in run.shares {
            prop_assert!(order.iter().all(|s| *s <= 1.0 + 1e-9), "{:?}", run.shares);
        }
    }
}
