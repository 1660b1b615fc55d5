//! `impellerc diff`: what differs for the machine between two motions, and between two texts of one job.

use crate::support::{self, pinned};
use impellerc::base::source::Span;
use impellerc::diagnostics::{Severity, Sink};
use impellerc::five_axis::between;
use impellerc::ir::{JointMove, Motion, MoveKind, Program};
use impellerc::job::files::shipped;
use impellerc::job::shipped_post;
use impellerc::nc::compare::{ComparedMotion, OperationDifference};
use impellerc::nc::{self, motion_of::motion_of};
use impellerc::nc_text::compare;
use impellerc::wheel::control::Orientation;
use std::process::Command;

const JOB: &str = "jobs/reduced/reduced.imp";
const DIALECTS: [(&str, &str); 2] = [("siemens-840d", "5mc850-c"), ("linuxcnc", "5mc850-c-linuxcnc")];

/// The differences of an operation of the reduced job after a change of its moves.
fn changed(operation: usize, change: impl Fn(&Program, &mut Vec<JointMove>)) -> [OperationDifference; 2] {
    let (program, motion) = pinned::reduced("siemens-840d").planned();
    let mut other: Motion = motion.clone();
    change(program, &mut other.operations[operation].moves);
    let side = |motion| ComparedMotion { program, motion };
    let found = [[motion, &other], [&other, motion]].map(|[a, b]| compare([side(a), side(b)]));
    for (k, o) in found.iter().flat_map(|found| found.iter().enumerate()) {
        assert!(k == operation || o.is_same(), "{o:?}");
    }
    found.map(|mut found| found.swap_remove(operation))
}

/// The cutting move of an operation with the longest tip motion.
fn longest(program: &Program, moves: &[JointMove]) -> usize {
    let length = |k: usize| {
        let [a, b] = [k - 1, k].map(|k| program.machine.forward(&moves[k].joints).tip);
        (b - a).norm()
    };
    let cuts = (1..moves.len()).filter(|k| moves[*k].kind == MoveKind::Cut);
    cuts.max_by(|a, b| length(*a).total_cmp(&length(*b))).unwrap()
}

#[test]
fn the_division_into_blocks_does_not_count() {
    let found = changed(1, |program, moves| {
        // Every third move in two unequal parts: the tip runs straight, both angles evenly.
        for k in (1..moves.len()).rev().step_by(3) {
            let (from, to) = (moves[k - 1].joints, moves[k].joints);
            let [a, b] = [from, to].map(|joints| program.machine.forward(&joints).tip);
            let rotary = between(from.rotary, to.rotary, 0.3);
            let joints = program.machine.joints(&(a + (b - a) * 0.3), rotary);
            let whole = moves[k];
            moves[k].time = 0.7 * whole.time;
            moves.insert(k, JointMove { joints, time: 0.3 * whole.time, ..whole });
        }
    });
    for o in found {
        println!("tip {} mm, axis {} deg, speed {}", o.tip.value, o.axis.value, o.speed.value);
        assert!(o.is_same() && o.moves[0] != o.moves[1], "{o:?}");
        assert!(o.tip.value < 1e-4 && o.axis.value < 1e-3 && o.speed.value < 1e-3, "{o:?}");
    }
}

#[test]
fn a_place_that_is_off_is_found_with_its_size() {
    for off in [0.002, 0.05, 1.0] {
        let found = changed(3, |program, moves| {
            let k = longest(program, moves);
            let pose = program.machine.forward(&moves[k].joints);
            let across = pose.axis.cross(&nalgebra::Vector3::z()).normalize();
            moves[k].joints = program.machine.joints(&(pose.tip + across * off), moves[k].joints.rotary);
        });
        for o in found {
            println!("{off} mm off: {} mm at {:?}", o.tip.value, o.tip.moves);
            // Square to the way it is a little less.
            assert!(o.tip.value > 0.3 * off && o.tip.value < 1.001 * off, "{off}: {o:?}");
            assert!(!o.is_same());
        }
    }
}

#[test]
fn a_speed_and_a_missing_move_are_found() {
    let slow = changed(3, |program, moves| {
        let k = longest(program, moves);
        moves[k].time /= 0.9;
    });
    for o in slow {
        assert!((o.speed.value - 0.1).abs() < 1e-6 && o.tip.value < 1e-6 && !o.is_same(), "{o:?}");
    }
    let missing = changed(3, |program, moves| {
        let k = longest(program, moves);
        moves.remove(k);
    });
    for o in missing {
        assert!(!o.is_same() && o.moves[0].abs_diff(o.moves[1]) == 1, "{o:?}");
    }
    // A pass less: the rest of the operation is found again.
    let (_, motion) = pinned::reduced("siemens-840d").planned();
    let pass = motion.operations[1].moves[motion.operations[1].moves.len() / 2].pass;
    let found = changed(1, |_, moves| moves.retain(|m| m.pass != pass));
    for o in found {
        assert!(!o.is_same() && o.tip.value > 0.5, "{o:?}");
    }
}

fn impellerc(arguments: &[&str]) -> (Option<i32>, String, String) {
    let run = Command::new(env!("CARGO_BIN_EXE_impellerc")).args(arguments).output().unwrap();
    let say = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (run.status.code(), say(&run.stdout), say(&run.stderr))
}

/// CL data leave the rotary positions open; those of the reader are those of the motion, or as good.
#[test]
fn cl_data_are_the_same_for_the_machine_as_nc_text() {
    let compiled = pinned::reduced("siemens-840d");
    let [nc, cl] = ["siemens-840d", "apt-cl"].map(|dialect| {
        let program = support::with_post(dialect, &compiled.program);
        let post = nc::find(dialect).unwrap();
        let text = nc::emit(post, &program, &compiled.motion, &[]).text();
        let sections = post.read(&text, &program.machine).unwrap();
        let mut sink = Sink::default();
        let motion = motion_of(&program, &sections, &|_| Span::default(), &mut sink).unwrap().motion;
        assert!(!sink.has_errors(), "{dialect}: {:?}", sink.diags());
        motion
    });
    let program = &compiled.program;
    for o in compare([&nc, &cl].map(|motion| ComparedMotion { program, motion })) {
        assert!(o.is_same() && o.moves[0] == o.moves[1], "{o:?}");
    }
}

/// One job, one machine, every post: each pair of texts has the same poses within the coarser step of their words, and the
/// same feeds.
#[test]
fn every_pair_of_posts_means_the_same() {
    let compiled = pinned::reduced("linuxcnc");
    let names = shipped::POSTS.iter().map(|(name, _)| *name);
    let mut read = Vec::new();
    for name in names {
        let file = shipped_post(name).unwrap();
        for orientation in Orientation::ALL {
            let post = nc::find(&file.dialect).unwrap();
            let mut program = support::with_post(name, &compiled.program);
            program.post.control.orientation = orientation;
            let mut sink = Sink::default();
            post.check(&program, &compiled.motion, &mut sink);
            // The motion was planned for LinuxCNC; other posts have no words for its stops, which do not count here.
            let refused = sink.diags().iter().any(|d| d.severity == Severity::Error && d.code.id() != "IMP0809");
            let takes =
                !program.post.transformation[usize::from(orientation == Orientation::Vectors)].pieces.is_empty();
            if !takes || refused {
                // Vectors of Fanuc need a head; the default of every post must be taken.
                assert_ne!(orientation, file.control.orientation, "{name}: {:?}", sink.diags());
                continue;
            }
            let mut sink = Sink::default();
            let text = nc::emit(post, &program, &compiled.motion, &[]).text();
            let sections = post.read(&text, &program.machine).unwrap_or_else(|e| panic!("{name}: {e:?}"));
            let motion = motion_of(&program, &sections, &|_| Span::default(), &mut sink);
            let motion = motion.unwrap_or_else(|| panic!("{name}: {:?}", sink.diags())).motion;
            read.push((name, program, motion));
        }
    }
    assert!(read.len() >= 10, "{}", read.len());
    let mut most = [0.0_f64; 3];
    for (i, (first, a, one)) in read.iter().enumerate() {
        for (second, b, other) in &read[i + 1..] {
            let sides = [ComparedMotion { program: a, motion: one }, ComparedMotion { program: b, motion: other }];
            let (d, e) = (a.post.control.decimals, b.post.control.decimals);
            let step = |digits: usize| 10f64.powi(-i32::try_from(digits).unwrap());
            // Half a step of each of three words of both texts, and of both angles.
            let by_lengths = 3f64.sqrt() * step(d.length.min(e.length)) + 1e-9;
            let by_angles = 2f64.sqrt() * step(d.angle.min(e.angle));
            let by_vectors = 3f64.sqrt() * step(d.vector.min(e.vector)).to_degrees();
            let axis = by_angles.max(by_vectors) + 1e-6;
            for o in compare(sides) {
                // Stations are words of axes: there angles move the tip on the part.
                let lever = o.tip.tip.iter().map(|x| x * x).sum::<f64>().sqrt();
                let tip = by_lengths + lever * by_angles.to_radians();
                assert!(o.tip.value <= tip && o.axis.value <= axis, "{first} {second}: {o:?}");
                assert!(o.beyond_digits().next().is_none(), "{first} {second}: {o:?}");
                most = [most[0].max(o.tip.value), most[1].max(o.axis.value), most[2].max(o.speed.value)];
            }
        }
    }
    println!("{} texts: tip {:.6} mm, axis {:.6} deg, speed {:.2e}", read.len(), most[0], most[1], most[2]);
}

#[test]
fn texts_of_two_dialects_are_the_same_for_the_machine() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    for (dialect, _) in DIALECTS {
        let compiled = pinned::reduced(dialect);
        let program = support::with_post(dialect, &compiled.program);
        let text = nc::emit(nc::find(dialect).unwrap(), &program, &compiled.motion, &[]).text();
        std::fs::write(place(dialect), text).unwrap();
    }
    let [siemens, linuxcnc] = DIALECTS.map(|(dialect, _)| place(dialect));
    let on_both = ["--job", JOB, "--machine", DIALECTS[0].1, "--other-machine", DIALECTS[1].1];
    let (code, said, faults) = impellerc(&[&["diff", &siemens, &linuxcnc], &on_both[..]].concat());
    assert_eq!((code, faults.as_str()), (Some(0), ""), "{said}");
    assert!(said.contains("for the machine both texts are the same"), "{said}");
    // Comments and block numbers do not count; a coordinate does, with the lines of both texts.
    let text = std::fs::read_to_string(&siemens).unwrap();
    let line = text.lines().position(|l| l.contains(" G1 ") && l.contains(" Y-")).unwrap();
    let edit = |l: &str| l.replacen(" Y-", " Y-1", 1);
    let edited: String =
        text.lines().enumerate().map(|(k, l)| if k == line { edit(l) + "\n" } else { format!("{l}\n") }).collect();
    let other = place("edited");
    std::fs::write(&other, format!("{edited}; the end\n")).unwrap();
    let (code, said, faults) = impellerc(&["diff", &siemens, &other, "--job", JOB, "--machine", DIALECTS[0].1]);
    assert_eq!(code, Some(1), "{said}{faults}");
    assert!(faults.contains("IMP0830") && faults.contains(&format!("{}:{}:", other, line + 1)), "{faults}");
    let (code, _, faults) = impellerc(&["diff", &siemens, &place("none"), "--job", JOB]);
    assert!(code == Some(3) && faults.contains("IMP0901"), "{faults}");
}
