//! Flank milling of faces of public wheels, each face alone: the least error of one, two and four strips, beside the figures of another
//! program (algorithms reference, 1.5).

use super::{imported, with_fillet};
use impellerc::axes::envelope::{Target, best_least_squares, minimax};
use impellerc::driver::{self, Options, Outcome, Stages};
use impellerc::nurbs::DualCurve;
use impellerc::plan::passes::flank::strip::{Strip, Surroundings};
use impellerc::tool_stock::collide::Cutter;
use impellerc::wheel::part::{FaceId, Part, Surface};
use nalgebra::Point3;
use rayon::prelude::*;

/// Relative gain of a minimax step at which the iteration stops.
const GAIN: f64 = 2e-3;

/// Places along and across a strip, as in the other program.
const PLACES: [u32; 2] = [90, 12];

/// Share of a face at its inlet and at its outlet that does not count. The other program leaves out 4 % (Rotor 37: 6 %).
const TRIMMED: f64 = 0.04;

/// Shares of a face from one end to the other, and beyond both ends, that a path follows.
const ALONG: [f64; 2] = [0.02, 0.12];

/// Control points of a path, as in the other program.
const CONTROL: usize = 20;

/// Places of a strip through whose offsets the axes of the starts go, as shares of its height; the first pair is that of the other
/// program.
const THROUGH: [[f64; 2]; 4] = [[0.15, 0.85], [0.0, 1.0], [0.3, 0.7], [0.4, 0.6]];

/// A start with an axis through the offsets of two places of a strip. The tip runs two radii below them, so that the ball cuts
/// nothing: the other program has a cylinder without an end.
fn start(part: &Part, side: FaceId, [low, high]: [f64; 2], radius: f64, through: [f64; 2]) -> DualCurve {
    let face = part.face(side);
    let offset = |u: f64, v: f64| {
        let at = |u: f64| face.surface.point(u, v) + face.normal(u, v) * radius;
        let inside = u.clamp(ALONG[0], 1.0 - ALONG[0]);
        let step = if inside > 0.5 { -1e-3 } else { 1e-3 };
        at(inside) + (at(inside + step) - at(inside)) * ((u - inside) / step)
    };
    let pairs: Vec<[Point3<f64>; 2]> = (0..=300)
        .map(|i| -ALONG[1] + (1.0 + 2.0 * ALONG[1]) * f64::from(i) / 300.0)
        .map(|u| {
            let [below, above] = through.map(|share| offset(u, low + (high - low) * share));
            let axis = (above - below).normalize();
            [below - axis * (2.0 * radius + 0.2 * (above - below).norm()), above]
        })
        .collect();
    DualCurve::through(&pairs, CONTROL).expect("more pairs than control points")
}

/// The least error of a face with strips of equal height, mm. No other surface counts.
fn error(part: &Part, side: FaceId, strips: u32, cutter: Cutter) -> f64 {
    let around = Surroundings::new(part);
    let surface = &part.face(side).surface;
    let of_strip = |k: u32| {
        let at = |i: u32, j: u32| {
            let v = (f64::from(k) + f64::from(j) / f64::from(PLACES[1])) / f64::from(strips);
            let u = TRIMMED + (1.0 - 2.0 * TRIMMED) * f64::from(i) / f64::from(PLACES[0]);
            Target::touched(surface.point(u, v))
        };
        let places = (0..=PLACES[0]).flat_map(|i| (0..=PLACES[1]).map(move |j| (i, j)));
        let targets: Vec<Target> = places.map(|(i, j)| at(i, j)).collect();
        let span = [k, k + 1].map(|k| f64::from(k) / f64::from(strips));
        let strip = Strip::new(&around, side, span, cutter);
        let starts = THROUGH.map(|through| start(part, side, span, cutter.tip_radius(), through));
        let each = starts.iter().map(|start| (start, targets.clone()));
        let (_, fit) = best_least_squares(each, &strip.tool()).expect("there are starts");
        let best = minimax(&fit, &strip.tool(), &targets, GAIN);
        best.measured.at.iter().map(|d| d.value.abs()).fold(0.0, f64::max)
    };
    (0..strips).into_par_iter().map(of_strip).reduce(|| 0.0, f64::max)
}

/// Compares the errors of both faces with one strip, with two and with four with those of the other program, um; it names the faces in
/// another way, so that the smaller and the larger error are compared.
fn are_reached(part: &Part, cutter: Cutter, known: [[f64; 2]; 3]) {
    for (strips, known) in [1, 2, 4].into_iter().zip(known) {
        let mut found = part.faces().take(2).map(|side| 1e3 * error(part, side, strips, cutter)).collect::<Vec<f64>>();
        found.sort_by(f64::total_cmp);
        println!("{strips} strips: {found:.1?} um, the other program {known:?} um");
        for (found, known) in found.iter().zip(known) {
            assert!(*found <= 1.02 * known, "{strips} strips: {found} um, {known} um");
        }
    }
}

const REST: &str = "
stock turned { over shroud 0 mm  bore 30 mm  back -200 mm }
tool t1 = ball { diameter 8 mm  flutes 4  flute 100 mm  reach 120 mm  max-depth 100 mm  holder \"er16-mini\" }
operation flank {
  tool t1  speed 12000 rpm  feed 800 mm/min  faces pressure, suction  strips 1  lead-in 4 mm  lead-out 4 mm
}
tolerance chord 1 um
post siemens-840d
";

/// The part of a wheel with one blade a sector.
fn part(folder: &std::path::Path, text: &str) -> Part {
    std::fs::write(folder.join("faces.imp"), text.to_owned() + REST).unwrap();
    let mut options = Options { job: folder.join("faces.imp"), ..Options::default() };
    options.run.library = Some("jobs/_lib".into());
    driver::front(&options, &mut Stages::default(), &mut Outcome::default()).unwrap().unwrap().part
}

/// A text without what lies between two marks.
fn without(text: &str, from: &str, to: &str) -> String {
    let (from, to) = (text.find(from).unwrap(), text.find(to).unwrap());
    text[..from].to_owned() + &text[to..]
}

/// NASA HECC, ball of 8 mm: main blade and splitter, each as a row of its own.
#[test]
fn faces_of_hecc_alone() {
    let folder = tempfile::tempdir().unwrap();
    let options = ["--unit", "in", "--blades", "15"];
    let Some(text) = imported("nasa_hecc", "hot_design_intent", (&options, "generic-ac-table"), folder.path()) else {
        return;
    };
    let main = without(&with_fillet(&text, "4 mm"), "  splitter splitter_1", "  hub ");
    let cutter = Cutter::ball(4.0);
    are_reached(&part(folder.path(), &main), cutter, [[43.5, 87.1], [12.6, 49.9], [6.6, 22.0]]);
    let splitter = main.replace("wheel.main.csv", "wheel.splitter_1.csv");
    are_reached(&part(folder.path(), &splitter), cutter, [[42.1, 47.0], [10.2, 19.1], [5.9, 8.8]]);
}

/// NASA Rotor 37, ball of 12 mm.
#[test]
fn faces_of_rotor_37_alone() {
    let folder = tempfile::tempdir().unwrap();
    let Some(text) = imported("nasa_rotor37", "BladeGen.inf", (&[], "generic-ac-table"), folder.path()) else { return };
    let text = with_fillet(&text, "3 mm");
    are_reached(&part(folder.path(), &text), Cutter::ball(6.0), [[71.9, 209.6], [16.3, 39.2], [4.4, 37.0]]);
}
