//! Flank milling by optimisation on surfaces with known optima: the reference table of the algorithms reference, 1.5
//! (cylinders, computed there by another program), and brute force.

use crate::support;
use impellerc::axes::envelope::target::{LEVER, Of};
use impellerc::axes::envelope::{Measured, Mounted, Target, ease, finest, least_squares, minimax};
use impellerc::nurbs::{DualCurve, RuledSurface};
use impellerc::tool_stock::collide::{Cutter, Section};
use nalgebra::{Point3, Vector3};
use std::f64::consts::FRAC_PI_2;

type Surface = dyn Fn(f64, f64) -> Point3<f64> + Sync;

/// Unit normal by differences, along S_u x S_v.
fn normal(surface: &Surface, u: f64, v: f64) -> Vector3<f64> {
    let h = 1e-5;
    (surface(u + h, v) - surface(u - h, v)).cross(&(surface(u, v + h) - surface(u, v - h))).normalize()
}

fn targets(surface: &Surface, columns: usize, rows: usize) -> Vec<Target> {
    let at = |i: usize, n: usize| i as f64 / n as f64;
    (0..=columns)
        .flat_map(|i| (0..=rows).map(move |j| (i, j)))
        .map(|(i, j)| Target::touched(surface(at(i, columns), at(j, rows))))
        .collect()
}

/// Two-point offsets at 0.15 and 0.85 of each ruling, run on beyond both ends.
fn start(surface: &Surface, radius: f64, sign: f64) -> DualCurve {
    const EXTENSION: f64 = 0.12;
    let offset = |u: f64, v: f64| surface(u, v) + normal(surface, u, v) * (sign * radius);
    let beyond = |u: f64, v: f64| {
        let edge = u.clamp(0.0, 1.0);
        let inward = if edge > 0.5 { -0.01 } else { 0.01 };
        let slope = (offset(edge + inward, v) - offset(edge, v)) / inward;
        offset(edge, v) + slope * (u - edge)
    };
    let pairs: Vec<[Point3<f64>; 2]> = (0..=240)
        .map(|i| -EXTENSION + (1.0 + 2.0 * EXTENSION) * f64::from(i) / 240.0)
        .map(|u| [beyond(u, 0.15), beyond(u, 0.85)])
        .collect();
    DualCurve::through(&pairs, 14).unwrap()
}

/// A cylinder without ends.
fn cylinder(radius: f64) -> Mounted<'static> {
    Mounted { cutter: Cutter::ball(radius), height: 1000.0, body: &[] }
}

/// Largest gouge and excess in um after minimax, on a finer grid than that of the optimisation.
fn errors(name: &str, surface: &Surface, radius: f64, sign: f64) -> [f64; 2] {
    let tool = cylinder(radius);
    let coarse = targets(surface, 80, 20);
    let fit = least_squares(&start(surface, radius, sign), &tool, &coarse);
    let best = finest(&fit, &tool, &coarse, &targets(surface, 160, 40), 5e-4).best;
    let fine = targets(surface, 200, 40);
    let [gouge, excess] = Measured::new(&best.curve, &tool, &fine).violation(&fine).map(|x| x * 1e3);
    println!("{name} R{radius}: -{gouge:.3} +{excess:.3} um, {} control points", best.curve.control_count());
    [gouge, excess]
}

fn wei(root: &[[f64; 3]], tip: &[[f64; 3]]) -> impl Fn(f64, f64) -> Point3<f64> + Sync + use<> {
    let surface = RuledSurface { root: support::curve(root), tip: support::curve(tip) };
    move |u, v| surface.point(u, v)
}

/// Not worse than 3 % over the larger error of the reference.
fn reaches(name: &str, found: [f64; 2], reference: f64) {
    let worst = found[0].max(found[1]);
    assert!(worst <= reference * 1.03, "{name}: {worst} um, reference {reference}");
    // Far below the reference the measure itself would be wrong: the reference is the optimum to a few per cent.
    assert!(worst >= reference * 0.9, "{name}: {worst} um, reference {reference}");
}

#[test]
fn minimax_reaches_the_reference_on_the_paper_vane() {
    let pressure = wei(&support::ROOT_PRESSURE, &support::TIP_PRESSURE);
    let suction = wei(&support::ROOT_SUCTION, &support::TIP_SUCTION);
    let out = pressure(0.5, 0.5) - suction(0.5, 0.5);
    let signs = [normal(&pressure, 0.5, 0.5).dot(&out).signum(), -normal(&suction, 0.5, 0.5).dot(&out).signum()];
    for (radius, reference) in [(2.0, [3.95, 2.46]), (3.0, [5.98, 3.70]), (5.0, [10.24, 6.33])] {
        reaches("pressure", errors("pressure", &pressure, radius, signs[0]), reference[0]);
        reaches("suction", errors("suction", &suction, radius, signs[1]), reference[1]);
    }
}

#[test]
fn minimax_reaches_the_reference_on_halves_of_the_paper_vane() {
    for (low, reference) in [(0.0, 0.53), (0.5, 0.95)] {
        let pressure = wei(&support::ROOT_PRESSURE, &support::TIP_PRESSURE);
        let suction = wei(&support::ROOT_SUCTION, &support::TIP_SUCTION);
        let sign = normal(&pressure, 0.5, 0.5).dot(&(pressure(0.5, 0.5) - suction(0.5, 0.5))).signum();
        let half = move |u: f64, v: f64| pressure(u, low + 0.5 * v);
        reaches("half", errors(&format!("pressure from v = {low}"), &half, 3.0, sign), reference);
    }
}

#[test]
fn minimax_reaches_the_reference_on_exact_surfaces() {
    let hp1 = |u: f64, v: f64| Point3::new(60.0 * u, v * (-5.0 + 10.0 * u), 30.0 * v);
    // The reference says 0.02 with two digits.
    assert!(errors("HP1", &hp1, 3.0, 1.0).into_iter().fold(0.0, f64::max) < 0.0206);
    let round = |r: f64, angle: f64, z: f64| Point3::new(r * angle.cos(), r * angle.sin(), z);
    let helicoid = move |u: f64, v: f64| round(20.0 + 30.0 * v, u * FRAC_PI_2, 30.0 * u);
    reaches("HEL", errors("HEL", &helicoid, 5.0, 1.0), 8.36);
    // Developable: nothing but the splines is left.
    let cone = move |u: f64, v: f64| round(20.0 + 20.0 * v, u * FRAC_PI_2, 30.0 * v);
    assert!(errors("CON", &cone, 5.0, 1.0).into_iter().fold(0.0, f64::max) < 0.005);
}

fn cutters() -> [Mounted<'static>; 5] {
    [
        Mounted { cutter: Cutter::ball(3.0), height: 0.0, body: &[] },
        Mounted { cutter: Cutter::flat(3.0), height: 0.0, body: &[] },
        Mounted { cutter: Cutter::bull(3.0, 1.0), height: 0.5, body: &[] },
        Mounted { cutter: Cutter::tapered_ball(2.0, 0.08), height: 0.0, body: &[] },
        Mounted { cutter: Cutter::barrel(4.0, 60.0, 2.0), height: 1.0, body: &[] },
    ]
}

/// Shank and holder with the clearance of each.
const BODY: [(Section, f64); 2] = [
    (Section { from: 20.0, to: 30.0, radius_from: 3.0, radius_to: 4.0 }, 0.5),
    (Section { from: 30.0, to: 60.0, radius_from: 8.0, radius_to: 12.0 }, 1.0),
];

/// Everything that targets may be about.
fn cases() -> (DualCurve, Vec<(Mounted<'static>, Vec<Target>)>) {
    let (curve, targets) = path();
    let mut cases: Vec<_> = cutters().into_iter().map(|tool| (tool, targets.clone())).collect();
    let body = Mounted { cutter: Cutter::ball(3.0), height: 0.5, body: &BODY };
    cases.push((body, targets.iter().map(|t| Target { of: Of::Body, ..*t }).collect()));
    let tilt = |t: f64| Target { of: Of::Tilt { t, most: 1.2 }, ..Target::clear(Point3::origin(), 0.0) };
    cases.push((body, (0..=40).map(|i| tilt(f64::from(i) / 40.0)).collect()));
    (curve, cases)
}

/// A path beside the pressure face of the paper, its points near and further up.
fn path() -> (DualCurve, Vec<Target>) {
    let pressure = wei(&support::ROOT_PRESSURE, &support::TIP_PRESSURE);
    (start(&pressure, 3.0, 1.0), targets(&pressure, 12, 5))
}

#[test]
fn deviations_equal_the_least_distance_of_many_poses() {
    let (curve, cases) = cases();
    for (tool, targets) in cases {
        let measured = Measured::new(&curve, &tool, &targets);
        for (deviation, target) in measured.at.iter().zip(&targets) {
            let distance = |t: f64| {
                let at = curve.at(t);
                let from = target.point - at.lower;
                let (rho, s) = (from.cross(&at.axis).norm(), from.dot(&at.axis) + tool.height);
                match target.of {
                    Of::Cutter => tool.cutter.distance(rho, s),
                    Of::Body => {
                        tool.body.iter().map(|(x, asked)| x.distance(rho, s) - asked).fold(f64::INFINITY, f64::min)
                    }
                    Of::Tilt { t, most } => LEVER * (most - curve.at(t).axis.angle(&Vector3::z())),
                }
            };
            let brute = (0..=20_000).map(|i| distance(f64::from(i) / 20_000.0)).fold(f64::INFINITY, f64::min);
            assert!(deviation.value <= brute + 1e-9, "{:?}: {} {brute}", tool.cutter, deviation.value);
            assert!(deviation.value > brute - 1e-6, "{:?}: {} {brute}", tool.cutter, deviation.value);
        }
    }
}

#[test]
fn gradients_equal_differences() {
    let (curve, targets) = path();
    let step = 1e-5;
    for tool in cutters() {
        let measured = Measured::new(&curve, &tool, &targets);
        let mut compared = 0;
        for unknown in (0..curve.unknowns()).step_by(7) {
            let shift = |by: f64| {
                let mut shift = vec![0.0; curve.unknowns()];
                shift[unknown] = by;
                Measured::new(&curve.shifted(&shift, 1.0), &tool, &targets)
            };
            let (more, less) = (shift(step), shift(-step));
            let point = unknown / 6;
            for (i, at) in measured.at.iter().enumerate() {
                let (first, weights) = curve.weights(at.t);
                let side = if unknown % 6 < 3 { &at.lower } else { &at.upper };
                let weight = point.checked_sub(first).and_then(|k| weights.get(k)).copied().unwrap_or(0.0);
                let expected = weight * side[unknown % 3];
                let found = (more.at[i].value - less.at[i].value) / (2.0 * step);
                // Where two places along the path are equally near, either is right.
                if (more.at[i].t - less.at[i].t).abs() < 0.01 {
                    compared += usize::from(expected != 0.0);
                    assert!((found - expected).abs() < 1e-4, "{:?} {unknown} {i}: {found} {expected}", tool.cutter);
                }
            }
        }
        assert!(compared > 60, "{:?}: {compared}", tool.cutter);
    }
}

#[test]
fn a_barrel_finishes_a_hollow_that_a_cylinder_leaves() {
    let (hollow, half) = (80.0, 0.09);
    // Straight along, hollow upwards.
    let surface = move |u: f64, v: f64| {
        let angle = half * (2.0 * v - 1.0);
        Point3::new(60.0 * u, -hollow * angle.cos(), hollow * angle.sin())
    };
    let asked = targets(&surface, 40, 15);
    let least = |start: &DualCurve, tool: &Mounted<'_>| {
        minimax(&least_squares(start, tool, &asked), tool, &asked, 5e-4).measured.worst(&asked)
    };
    let cylinder = least(&start(&surface, 4.0, normal(&surface, 0.5, 0.5).y.signum()), &cylinder(4.0));
    let cutter = Cutter::barrel(4.0, hollow, 2.0);
    // The middle of its arc touches the middle of the face, from where the axis leans off it.
    let middle = cutter.profile_at(0.5 * cutter.barrel_angle().unwrap()).unwrap();
    let angle = 0.5 * cutter.barrel_angle().unwrap();
    let axis = Vector3::new(0.0, angle.sin(), angle.cos());
    let radial = Vector3::new(0.0, -angle.cos(), angle.sin());
    let pair = |i: u32| {
        let tip = surface(f64::from(i) / 100.0, 0.5) - radial * middle.rho - axis * middle.s;
        [tip, tip + axis * 20.0]
    };
    let pairs: Vec<_> = (0..=100).map(pair).collect();
    let barrel = least(&DualCurve::through(&pairs, 14).unwrap(), &Mounted { cutter, height: 0.0, body: &[] });
    println!("hollow: cylinder {:.1} um, barrel {:.3} um", 1e3 * cylinder, 1e3 * barrel);
    // The cylinder leaves half of the depth of the hollow at best.
    let depth = hollow * (1.0 - half.cos());
    assert!(cylinder > 0.45 * depth && barrel < 1e-3, "{cylinder} {barrel}");
}

#[test]
fn easing_lessens_the_motion_and_keeps_the_bounds() {
    let pressure = wei(&support::ROOT_PRESSURE, &support::TIP_PRESSURE);
    let suction = wei(&support::ROOT_SUCTION, &support::TIP_SUCTION);
    let sign = normal(&pressure, 0.5, 0.5).dot(&(pressure(0.5, 0.5) - suction(0.5, 0.5))).signum();
    let tool = cylinder(3.0);
    let band: Vec<Target> = targets(&pressure, 80, 20).into_iter().map(|t| t.widened(0.001, 0.012)).collect();
    let fit = least_squares(&start(&pressure, 3.0, sign), &tool, &band);
    let kept = minimax(&fit, &tool, &band, 5e-4);
    assert!(kept.widening <= 1e-6, "{}", kept.widening);
    let rotary = |axis: &Vector3<f64>| {
        let radial = axis.x.hypot(axis.y);
        let tilt = Vector3::new(axis.z * axis.x / radial, axis.z * axis.y / radial, -radial);
        let turn = Vector3::new(-axis.y, axis.x, 0.0) / (radial * radial);
        [(radial.atan2(axis.z), tilt), (axis.x.atan2(-axis.y), turn)]
    };
    let eased = ease(&kept.curve, &tool, &band, &rotary, 3.0, 1e-4, 16);
    println!("motion {:?} in {} steps", eased.motion, eased.steps);
    assert!(eased.motion[1] < 0.3 * eased.motion[0]);
    let [below, above] = eased.measured.violation(&band);
    assert!(below <= 1.1e-4 && above <= 1.1e-4, "{below} {above}");
    // Half of the steps of the sum give the same sum.
    let sum = |n: usize| {
        let at: Vec<_> = (0..=n).map(|i| eased.curve.at(i as f64 / n as f64)).collect();
        let angle = |k: usize, i: usize| rotary(&at[i].axis)[k].0;
        let way = |i: usize| (at[i + 1].lower - at[i].lower).norm();
        let speed = |k: usize, i: usize| (angle(k, i + 1) - angle(k, i)) / way(i);
        let speeds: f64 = (0..n).map(|i| (0..2).map(|k| speed(k, i).powi(2)).sum::<f64>() * way(i)).sum();
        let bends: f64 = (1..n)
            .map(|i| {
                let ds = 0.5 * (way(i) + way(i - 1));
                (0..2).map(|k| ((speed(k, i) - speed(k, i - 1)) / ds * 3.0).powi(2)).sum::<f64>() * ds
            })
            .sum();
        speeds + bends
    };
    assert!((sum(480) / eased.motion[1] - 1.0).abs() < 0.05, "{} {}", sum(480), eased.motion[1]);
}
