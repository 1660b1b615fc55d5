//! The seven-vane demonstration program of the LinuxCNC package: read unchanged, and measured against a job for it
//! (tests/linuxcnc/impeller) with a head and an end around its moves.
//!
//! The program is not part of this repository. `IMPELLERC_LINUXCNC` names the folder of the unpacked package; without
//! the program the tests report that they were skipped.

use impellerc::base::source::Span;
use impellerc::diagnostics::{Severity, Sink};
use impellerc::driver::{self, Options, Outcome, Stages};
use impellerc::five_axis::Machine;
use impellerc::ir::{Motion, Program};
use impellerc::nc::{self, Post, motion_of::motion_of};
use impellerc::verify::{Certificate, certify};
use impellerc::wheel::part::sample;
use nalgebra::{Point3, Vector3};
use std::io::Write as _;
use std::path::{Path, PathBuf};

const PROGRAM: &str = "usr/share/doc/linuxcnc/examples/sample-configs/sim/axis/vismach/5axis/table-rotary-tilting/demos/\
                       impeller-7bl-xyzac.ngc";

/// Radius of the ball, mm.
const RADIUS: f64 = 3.0;

/// The text of the program, when it is there.
fn text() -> Option<String> {
    let named = std::env::var_os("IMPELLERC_LINUXCNC").map(PathBuf::from);
    let unpacked = named.as_deref().is_some_and(|root| root != Path::new("/"));
    let path = named.unwrap_or_else(|| PathBuf::from("/")).join(PROGRAM);
    let text = std::fs::read_to_string(&path).ok();
    assert!(text.is_some() || !unpacked, "IMPELLERC_LINUXCNC is set, but there is no {}", path.display());
    if text.is_none() {
        std::io::stderr().write_all(b"skipped: the demonstration program of LinuxCNC is not installed\n").unwrap();
    }
    text
}

fn job() -> Program {
    let mut outcome = Outcome::default();
    let options = Options { job: PathBuf::from("tests/linuxcnc/impeller/impeller.imp"), ..Options::default() };
    driver::front(&options, &mut Stages::default(), &mut outcome).unwrap().unwrap()
}

fn linuxcnc() -> &'static dyn Post {
    nc::find("linuxcnc").unwrap()
}

/// Faults of the program as it stands: line, what is said, and why by the manual ("G Codes", "M Codes", "Coordinates"). M2
/// and M30 put some groups back to a default; an abort, MDI and the start of the control do not.
const FAULTS: [(usize, &str, &str); 8] = [
    (4, "the transformation may still be on", "an abort leaves M428 on; nothing switches it off before"),
    (4, "`G53 G0 Z119` before, then A and C", "the switch takes the axes where they are; no block says where that is"),
    (4, "before any tool change", "there is no T, no M6 and no G43: the length of whatever tool acts"),
    (
        8,
        "the plane: write G17; lengths in mm: write G21; absolute coordinates: write G90; X as a coordinate, not as a \
         diameter: write G8; no cutter radius compensation: write G40; the work offset: write G54; no remaining offset of G92 \
         or G52: write G92.1; no rotation of the work offset: write G10 L2 P1 R0",
        "G20, G7, G92 and the rotation outlive M2; G18, G91, G41 and G55 an abort",
    ),
    (
        10,
        "spindle speed in rpm: write G97; coolant on: write M8",
        "G96 outlives M2; coolant is as the operator left it since M9 at the last end",
    ),
    (10, "write G64 P with a tolerance", "G64 without P leaves the path as far as the speed asks for"),
    (
        4503,
        "`M5` stops the spindle or turns it round with the tool in the part",
        "two moves at rapid follow, over the part",
    ),
    (4510, "the program ends with the tool in the part", "M429 and M30 move nothing: the tool stands over the nose"),
];

#[test]
fn as_it_stands_each_thing_that_it_leaves_open_is_told_once() {
    let Some(text) = text() else { return };
    let faults = linuxcnc().read(&text, &job().machine).unwrap_err();
    for f in &faults {
        println!("line {}: {}", f.line, f.reason);
    }
    assert_eq!(faults.len(), FAULTS.len());
    for (fault, (line, said, why)) in faults.iter().zip(FAULTS) {
        assert!(fault.line == line && fault.reason.contains(said), "{fault:?}, due in line {line}: {said} ({why})");
    }
}

/// One move, read by this test alone.
#[derive(Clone, Copy, Debug)]
struct Station {
    line: usize,
    /// Minutes are 1 / F; `None` at rapid.
    feed: Option<f64>,
    tip: Point3<f64>,
    /// Words A and C, degrees.
    words: [f64; 2],
}

impl Station {
    /// Tip and axis of the tool on the way here, from the words of A and C: C turns the table right-handed, A tilts it.
    fn pose(&self, to: &Self, t: f64) -> (Point3<f64>, Vector3<f64>) {
        let [a, c] = [0, 1].map(|k| (self.words[k] + (to.words[k] - self.words[k]) * t).to_radians());
        (self.tip + (to.tip - self.tip) * t, Vector3::new(a.sin() * c.sin(), a.sin() * c.cos(), a.cos()))
    }
}

/// Moves of a text with blanks between letters and numbers.
fn stations(text: &str) -> Vec<Station> {
    let mut found: Vec<Station> = Vec::new();
    let mut at = [0.0; 5];
    for (i, line) in text.lines().enumerate() {
        let words: Vec<&str> = line.split_whitespace().collect();
        let Some((motion @ ("G0" | "G1"), rest)) = words.split_first().map(|(first, rest)| (*first, rest)) else {
            continue;
        };
        let joined = rest.concat();
        let mut feed = None;
        for (k, letter) in joined.char_indices().filter(|(_, c)| c.is_ascii_alphabetic()) {
            let number = &joined[k + 1..];
            let end = number.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(number.len());
            let value: f64 = number[..end].parse().unwrap();
            match "XYZAC".find(letter) {
                Some(axis) => at[axis] = value,
                None => feed = (motion == "G1").then_some(value),
            }
        }
        let [x, y, z, a, c] = at;
        found.push(Station { line: i + 1, feed, tip: Point3::new(x, y, z), words: [a, c] });
    }
    found
}

/// The program with what its faults ask for: a head in front, each of its three operations from the retract height and
/// back to it, an end. `M5` moves behind the last retract. No move is changed.
fn completed(text: &str) -> String {
    let mut out =
        String::from("M429\nG17 G21 G90 G8 G40 G49 G54 G80 G97\nG92.1\nG10 L2 P1 R0\nG64 P0.025\nG53 G0 Z119\nT1 M6\n");
    let mut begun = false;
    for (i, line) in text.lines().enumerate() {
        if line.contains("--- Operation") {
            if begun {
                out.push_str("M429\nG53 G0 Z119\n");
            }
            begun = true;
            let first = stations(text).into_iter().find(|s| s.line > i).unwrap();
            let [a, c] = first.words;
            out.push_str(&format!("{line}\nS600 M3\nM8\nG0 A{a} C{c}\nG53 G0 X0 Y0\nG43 H1\nM428\n"));
        } else if line.starts_with("M429") {
            out.push_str("M429\nG53 G0 Z119\nM5\n");
        } else if !["M428", "S600", "M5"].iter().any(|start| line.starts_with(start)) {
            out.push_str(&format!("{line}\n"));
        }
    }
    out
}

fn measured(text: &str, program: &Program) -> (Motion, Certificate, Vec<String>) {
    let sections = linuxcnc().read(text, &program.machine).unwrap_or_else(|f| panic!("{f:?}"));
    let mut sink = Sink::default();
    let motion = motion_of(program, &sections, &|_| Span::default(), &mut sink).unwrap().motion;
    let certificate = certify(program, &motion, &mut sink).unwrap();
    let errors = sink.diags().iter().filter(|d| d.severity == Severity::Error);
    (motion, certificate, errors.map(|d| d.message.clone()).collect())
}

/// Signed distance of a point to the ball and its shank over dense poses of some ways.
fn distance(poses: &[(Point3<f64>, Vector3<f64>)], p: &Point3<f64>) -> f64 {
    let to = |(tip, axis): &(Point3<f64>, Vector3<f64>)| {
        let d = p - (tip + axis * RADIUS);
        (d - axis * d.dot(axis).clamp(0.0, 20.0 - RADIUS)).norm() - RADIUS
    };
    poses.iter().map(to).fold(f64::INFINITY, f64::min)
}

#[test]
fn its_moves_are_measured_against_a_job_for_it() {
    let Some(text) = text() else { return };
    let program = job();
    let own = stations(&text);
    let completed = completed(&text);
    let (motion, certificate, errors) = measured(&completed, &program);

    // Each move stands where its words say; the last one of each operation is the retract, the first the way to it.
    let read: Vec<_> = motion.operations.iter().flat_map(|o| &o.moves[1..o.moves.len() - 1]).collect();
    assert_eq!(read.len(), own.len());
    for (m, s) in read.iter().zip(&own) {
        let pose = program.machine.forward(&m.joints);
        let (tip, axis) = s.pose(s, 0.0);
        assert!((pose.tip - tip).norm() < 1e-9 && (pose.axis - axis).norm() < 1e-9, "line {}", s.line);
    }
    // In inverse time a block takes 1 / F minutes.
    let minutes: f64 = own.iter().filter_map(|s| s.feed).map(|f| 1.0 / f).sum();
    let said: f64 =
        certificate.machine.runs.iter().map(|r| r.programmed[0].get() + r.programmed[1].get()).sum::<f64>() / 60.0;
    println!("at feed {minutes:.3} min by the words, {said:.3} min by the verifier");
    assert!((minutes - said).abs() < 2e-3 * minutes);

    // Surfaces of one vane and one channel: every seventh part of the program is the same.
    let mut poses = Vec::new();
    for pair in own.windows(2) {
        let way = (pair[1].tip - pair[0].tip).norm() + 20.0 * (pair[1].words[1] - pair[0].words[1]).to_radians().abs();
        let n = (way / 0.05).ceil().max(1.0) as usize;
        poses.extend((0..=n).map(|k| pair[0].pose(&pair[1], k as f64 / n as f64)));
    }
    let samples: Vec<_> = sample::sample(&program.part, 0.5)
        .into_iter()
        .filter(|s| s.surface.milled() && s.surface.sector == 0)
        .collect();
    let near = |p: &Point3<f64>| -> Vec<(Point3<f64>, Vector3<f64>)> {
        poses.iter().filter(|(tip, _)| (tip - p).norm() < 22.0).copied().collect()
    };
    let mut checked = 0;
    for report in certificate.surfaces.iter().filter(|r| samples.iter().any(|s| s.surface.to_string() == r.surface)) {
        let found: Vec<f64> = samples
            .iter()
            .filter(|s| s.surface.to_string() == report.surface)
            .map(|s| distance(&near(&s.position), &s.position))
            .collect();
        let [deepest, most] =
            [&report.gouge, &report.excess].map(|w| distance(&near(&Point3::from(w.point)), &Point3::from(w.point)));
        let (least, largest) =
            found.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
        println!(
            "{:<24} {} samples: {:7.1} to {:6.1} um; verifier {:7.1} (bound {:6.1}) to {:6.1} um (bound {:6.1})",
            report.surface,
            found.len(),
            least * 1e3,
            largest * 1e3,
            report.gouge.value.get() * 1e3,
            -report.gouge_bound.get() * 1e3,
            report.excess.value.get() * 1e3,
            report.excess_bound.get() * 1e3
        );
        // The worst places are as deep as dense poses say, and no sample is worse than the bounds.
        assert!((deepest - report.gouge.value.get()).abs() < 2e-3, "{}: {deepest}", report.surface);
        assert!((most - report.excess.value.get()).abs() < 2e-3, "{}: {most}", report.surface);
        assert!(
            least > -report.gouge_bound.get() - 1e-4 && largest < report.excess_bound.get() + 2e-3,
            "{}",
            report.surface
        );
        checked += found.len();
    }
    println!("{checked} samples, {} poses", poses.len());
    assert!(checked > 1000);

    println!("{:?}", certificate.machine.axes);
    for e in &errors {
        println!("{e}");
    }
    // The control runs G0 by the speed of the tip, whatever joints do.
    let fast = rapid_speeds(&own, &motion, &program.machine);
    let mut due: Vec<String> = "XYZAC"
        .chars()
        .zip(fast)
        .filter(|(_, share)| *share > 1.0001)
        .map(|(axis, share)| format!("axis {axis} would need {:.1} % of its speed", share * 100.0))
        .collect();
    assert!(due.len() > 1, "{fast:?}");
    // The first operation cuts the channel from the full in one pass, as the comments of the program say. That loads the ball
    // more than a slot of 75 % of its diameter, the default at a stick-out of 4 to 8 diameters.
    let deep = errors.iter().find(|e| e.starts_with("t1 cuts") && e.ends_with("its limit is 4.500 mm")).expect("depth");
    due.push(deep.clone());
    due.sort();
    let mut errors = errors.clone();
    errors.sort();
    assert_eq!(errors, due);
}

/// Largest speeds of the joints at G0 as shares of their limits, by dense places: the control takes the time in which X, Y
/// and Z of the part, A and C keep the limits of the axes of these names.
fn rapid_speeds(own: &[Station], motion: &Motion, machine: &Machine) -> [f64; 5] {
    const STEPS: usize = 16;
    let limits = machine.speeds();
    let mut most = [0.0_f64; 5];
    let mut own = own.iter();
    for operation in &motion.operations {
        // From where the axes stand at the retract height.
        let start = operation.moves[0].joints;
        let mut from = (machine.forward(&start).tip, start.rotary);
        for station in own.by_ref().take(operation.moves.len() - 2) {
            let signs = machine.rotary.each_ref().map(|axis| axis.word_sign);
            let to = (station.tip, [0, 1].map(|n| station.words[n].to_radians() * signs[n]));
            let (way, turns) = (to.0 - from.0, [0, 1].map(|n| to.1[n] - from.1[n]));
            let moved = [way.x, way.y, way.z, turns[0], turns[1]];
            let time = moved.iter().zip(limits).map(|(d, v)| d.abs() / v).fold(0.0, f64::max);
            let joints = |k: usize| {
                let t = k as f64 / STEPS as f64;
                machine.joints(&(from.0 + way * t), [from.1[0] + turns[0] * t, from.1[1] + turns[1] * t]).all()
            };
            for k in (1..=STEPS).filter(|_| station.feed.is_none()) {
                let (a, b) = (joints(k - 1), joints(k));
                for n in 0..5 {
                    most[n] = most[n].max((b[n] - a[n]).abs() * STEPS as f64 / time / limits[n]);
                }
            }
            from = to;
        }
    }
    most
}

/// Speed of C, deg/s: what the words ask for, and with a tip no faster than a limit in mm/s.
fn speed_of_c(from: &Station, to: &Station, fastest: f64) -> f64 {
    let seconds = to.feed.map_or(f64::INFINITY, |f| 60.0 / f);
    (to.words[1] - from.words[1]).abs() / seconds.max((to.tip - from.tip).norm() / fastest)
}

#[test]
fn its_links_turn_c_faster_than_the_stock_configuration_can() {
    let Some(text) = text() else { return };
    // C of the stock configuration.
    const LIMIT: f64 = 30.0;
    let mut program = job();
    program.machine.rotary[1].speed = LIMIT.to_radians();
    let own = stations(&text);
    let worst = |fastest: f64| own.windows(2).map(|w| speed_of_c(&w[0], &w[1], fastest)).fold(0.0, f64::max) / LIMIT;
    let (asked, limited) = (worst(f64::INFINITY), worst(20.0));
    let (_, _, errors) = measured(&completed(&text), &program);
    println!("C: {:.1} % of its speed by the words, {:.1} % with 20 mm/s of the tip", asked * 100.0, limited * 100.0);
    // Axes of 20 mm/s slow the tip of these blocks down, and C with it, to what the controller was seen to ask for.
    assert!((limited - 3.41).abs() < 0.01);
    let said = format!("axis C would need {:.1} % of its speed", asked * 100.0);
    assert!(errors.contains(&said), "{said}: {errors:?}");
}
