//! Work on grossly wrong programs: the verifier does not follow a cut that is far deeper than its contract, and the
//! certificate reports this. Work is counted in evaluated points and cells, not in seconds.

use crate::support::pinned::{self, Pinned};
use impellerc::base::progress::Progress;
use impellerc::diagnostics::Sink;
use impellerc::five_axis::Joints;
use impellerc::ir::{Motion, MoveKind, Program};
use impellerc::verify::stock::Settings;
use impellerc::verify::{Certificate, certify_with};
use nalgebra::{Point3, Vector3};

fn measured(program: &Program, motion: &Motion) -> (usize, Certificate) {
    let mut settings = Settings { cell: Some(4.0), ..Settings::default() };
    let mut sink = Sink::default();
    let certificate = certify_with(program, motion, &mut settings, &Progress::default(), &mut sink).unwrap();
    (certificate.surfaces.iter().map(|s| s.points).sum(), certificate)
}

/// Moves of one operation but for the ways to its first target and up at its end, changed by their tips and rotary axes.
fn changed(
    program: &Program,
    motion: &Motion,
    operation: usize,
    change: impl Fn(usize, Point3<f64>, [f64; 2]) -> (Point3<f64>, [f64; 2]),
) -> Motion {
    let mut motion = motion.clone();
    let moves = &mut motion.operations[operation].moves;
    let last = moves.len() - 2;
    for (k, m) in moves[1..=last].iter_mut().enumerate().filter(|(_, m)| m.kind == MoveKind::Cut) {
        let Joints { rotary: [a, c], .. } = m.joints;
        let (tip, [a, c]) = change(k, program.machine.forward(&m.joints).tip, [a, c]);
        m.joints = program.machine.joints(&tip, [a, c]);
        // Long enough for every axis, so that nothing but the cut is wrong.
        m.time = m.time.max(20.0);
    }
    motion
}

#[test]
fn a_wrong_program_takes_no_more_than_three_times_the_work_of_the_right_one() {
    let Pinned { program, motion, .. } = pinned::small("siemens-840d");
    let motion = &motion;
    let (right, certificate) = measured(program, motion);
    println!("right: {right} points and cells");
    // Of what holds, bounds are as close as ever.
    assert!(certificate.surfaces.iter().all(|s| s.gouge_bound.get() <= s.gouge.depth.get() + 6e-4));
    let down = |by: f64| changed(program, motion, 1, move |_, tip, rotary| (tip - Vector3::z() * by, rotary));
    let wrong = [
        ("2 mm lower", down(2.0)),
        ("10 mm lower", down(10.0)),
        (
            "to and fro by 20 mm",
            changed(program, motion, 1, |k, tip, rotary| (tip + Vector3::new([20.0, -20.0][k % 2], 0.0, -5.0), rotary)),
        ),
        (
            "forty half turns of C",
            changed(program, motion, 2, |k, tip, [a, c]| (tip, [a, c + if k < 40 { [0.0, 3.0][k % 2] } else { 0.0 }])),
        ),
    ];
    for (what, motion) in wrong {
        let (points, certificate) = measured(program, &motion);
        let deepest = certificate.surfaces.iter().max_by(|a, b| a.gouge.depth.total_cmp(&b.gouge.depth)).unwrap();
        println!("{what}: {points} points and cells, {:.2} mm deep", deepest.gouge.depth.get());
        assert!(points <= 3 * right, "{what}: {points} for {right}");
        assert!(deepest.gouge.depth.get() > 0.5, "{what}: {deepest:?}");
        // The ball of these operations has 1 mm: a bound that was not looked for is no less, and never below what is found.
        for s in &certificate.surfaces {
            let far = -s.gouge.value.get() > 0.4;
            assert!(s.gouge_bound.get() >= s.gouge.depth.get(), "{what}: {}", s.surface);
            assert!(!far || s.gouge_bound.get() >= 1.0 - 1e-9, "{what}: {} {}", s.surface, s.gouge_bound.get());
        }
        let text = impellerc::report::proof::details::details(program, &motion, &certificate);
        assert!(text.contains("has no closer bound than the radius of the cutter"), "{what}");
        assert!(!text.contains("no gouge over"), "{what}");
    }
}
