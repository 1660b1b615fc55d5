//! Machines of every kind: the plan for one machine is the same on another, and kinds that are not planned are refused.

use crate::support::jobs;
use impellerc::driver::{self, Options, Outcome, Stages};
use impellerc::ir::Program;
use impellerc::kin::{Chain, Joints, Machine, RotaryPose};
use impellerc::post;
use impellerc::progress::Progress;
use impellerc::verify::SPACING;
use impellerc::verify::proof::sweep::Sweep;
use impellerc::verify::surface::{self, Limits};
use nalgebra::{Point3, Rotation3, Vector3};
use std::path::Path;

const SHIPPED: &str = include_str!("../../jobs/_lib/machines/5mc850-c.toml");

/// Machine files made from the shipped one by replacing texts.
const KINDS: [(&str, &[(&str, &str)]); 5] = [
    ("bc-table", &[("[axes.A]", "[axes.B]")]),
    ("b-head-c-table", &[("\"table-table\"", "\"head-table\""), ("[axes.A]", "[axes.B]")]),
    ("ac-head", &[("\"table-table\"", "\"head-head\"")]),
    ("nutating-head", &[("\"table-table\"", "\"head-table\""), ("[axes.A]", "[axes.B]\ndirection = [0, 1, 1]")]),
    ("nutating-table", &[("[axes.A]", "[axes.B]\ndirection = [0, -1, 1]")]),
];

/// The job of the smallest wheel with a machine file beside it.
fn job_on(folder: &Path, name: &str, text: &str) -> Options {
    let job = include_str!("../../jobs/small/small.imp").replace("5mc850-c", name);
    let library = folder.join("_lib");
    std::fs::create_dir_all(library.join("machines")).unwrap();
    std::fs::create_dir_all(library.join("tools")).unwrap();
    std::fs::write(library.join("machines").join(format!("{name}.toml")), text).unwrap();
    std::fs::copy("jobs/_lib/tools/carbide.toml", library.join("tools/carbide.toml")).unwrap();
    std::fs::copy("jobs/small/vane_curves.csv", folder.join("vane_curves.csv")).unwrap();
    std::fs::write(folder.join("job.imp"), job).unwrap();
    let mut options = Options { job: folder.join("job.imp"), ..Options::default() };
    options.run.library = Some(library);
    options
}

fn with_text(changes: &[(&str, &str)]) -> String {
    changes.iter().fold(SHIPPED.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1)
    })
}

fn front(name: &str, text: &str) -> (Option<Program>, Outcome) {
    let folder = tempfile::tempdir().unwrap();
    let mut outcome = Outcome::default();
    let program = driver::front(&job_on(folder.path(), name, text), &mut Stages::default(), &mut outcome);
    (program.ok().flatten(), outcome)
}

/// Tool tip and axis in the part frame from the positions of the axes and plain rotations, without the chain.
fn by_hand(machine: &Machine, joints: &Joints, heads: usize) -> (Point3<f64>, Vector3<f64>) {
    let turned = |k: usize, sense: f64, p: Point3<f64>| {
        let axis = machine.chain.axes()[k];
        axis.point + Rotation3::from_axis_angle(&axis.direction, sense * joints.rotary[k]) * (p - axis.point)
    };
    const LENGTH: f64 = 120.0;
    let [x, y, z, ..] = machine.positions(joints, LENGTH);
    // The tool hangs down from the gauge line; axes of the head swing it, the one next to the tool first.
    let mut ends = [Point3::new(0.0, 0.0, -LENGTH), Point3::new(0.0, 0.0, -LENGTH + 1.0)];
    for k in 0..heads {
        ends = ends.map(|p| turned(k, 1.0, p));
    }
    ends = ends.map(|p| p + Vector3::new(x, y, z));
    // Tables turn the part against their words: seen from the part, the tool turns with them.
    for k in heads..2 {
        ends = ends.map(|p| turned(k, 1.0, p));
    }
    let ends = ends.map(|p| p - machine.part_origin);
    (ends[0], ends[1] - ends[0])
}

#[test]
fn every_kind_reaches_the_cutter_locations_of_the_plan() {
    let (planned_for, motion) = jobs::small("siemens-840d").planned();
    for (name, changes) in KINDS {
        let (program, outcome) = front(name, &with_text(changes));
        let program = program.unwrap_or_else(|| panic!("{name}: {:?}", outcome.sink.diags()));
        let machine = &program.machine;
        let heads = machine.chain.axes().iter().filter(|a| a.carries == impellerc::kin::Carries::Tool).count();
        assert!(impellerc::ir::print::program(&program).contains(&format!("  {} carries the ", machine.names()[3])));
        let mut reached = 0;
        for operation in &motion.operations {
            let mut before = 0.0;
            for m in &operation.moves {
                let pose = planned_for.machine.forward(&m.joints);
                let Some(pairs) = machine.chain.inverse(&pose.axis, before) else { continue };
                before = pairs[0][1];
                for rotary in pairs {
                    let joints = machine.joints(&pose.tip, rotary);
                    let back = machine.forward(&joints);
                    assert!((back.tip - pose.tip).norm() < 1e-9 && (back.axis - pose.axis).norm() < 1e-12, "{name}");
                    let (tip, axis) = by_hand(machine, &joints, heads);
                    assert!((tip - pose.tip).norm() < 1e-9 && (axis - pose.axis).norm() < 1e-9, "{name}: {tip} {axis}");
                }
                reached += 1;
            }
        }
        // A nutating axis at 45 deg leans the tool by up to 90 deg: all of them.
        let all: usize = motion.operations.iter().map(|o| o.moves.len()).sum();
        assert_eq!(reached, all, "{name}");
    }
}

/// Surfaces as the sweeps of another machine leave them: finely divided, the tool passes the same places.
#[test]
fn the_verifier_samples_sweeps_of_every_kind() {
    let (planned_for, motion) = jobs::small("siemens-840d").planned();
    // Finishing of the faces, each block in parts so short that the rule between stations does not matter.
    const PARTS: u32 = 8;
    let operation = motion.operations.iter().find(|o| planned_for.operations[o.operation].name == "flank").unwrap();
    let tool = &planned_for.tools[planned_for.operations[operation.operation].tool].solid;
    let own = &planned_for.machine;
    let poses: Vec<RotaryPose> = operation
        .moves
        .windows(2)
        .flat_map(|w| {
            let [from, to] =
                [0, 1].map(|k| RotaryPose { tip: own.forward(&w[k].joints).tip, rotary: w[k].joints.rotary });
            (0..PARTS).map(move |k| from.towards(&to, f64::from(k) / f64::from(PARTS)))
        })
        .collect();
    let deepest = |chain: &Chain, poses: &[RotaryPose]| {
        let sweep = Sweep::through(tool, chain, poses).unwrap();
        let reports = surface::certify(
            &planned_for.part,
            false,
            &[sweep],
            2.0 * SPACING,
            &Limits::default(),
            &Progress::default(),
        );
        reports.into_iter().map(|s| (s.gouge.value, s.gouge_bound)).collect::<Vec<_>>()
    };
    let meant = deepest(&own.chain, &poses);
    for (name, changes) in KINDS.into_iter().filter(|k| k.0 != "bc-table") {
        let chain = front(name, &with_text(changes)).0.unwrap().machine.chain;
        let mut before = 0.0;
        let poses: Vec<RotaryPose> = poses
            .iter()
            .map(|p| {
                let rotary = chain.unwound(&own.chain.tool_axis(p.rotary), 0, before);
                before = rotary[1];
                RotaryPose { tip: p.tip, rotary }
            })
            .collect();
        for ((value, bound), (other, other_bound)) in meant.iter().zip(deepest(&chain, &poses)) {
            assert!((value - other).abs() < 2e-4, "{name}: {value} {other}");
            assert!(
                other_bound >= -other - 1e-9 && (bound - other_bound).abs() < 1e-3,
                "{name}: {bound} {other_bound}"
            );
        }
    }
}

/// Tables with B where the shipped machine has A: the same cuts, the table a quarter of a turn ahead.
#[test]
fn a_bc_table_cuts_what_an_ac_table_cuts() {
    let planned = jobs::small("siemens-840d");
    let ac = post::emit(post::find("siemens-840d").unwrap(), &planned.program, &planned.motion, &[]).text();
    let folder = tempfile::tempdir().unwrap();
    let job = job_on(folder.path(), "bc", &with_text(KINDS[0].1));
    let mut options = Options { output: Some(folder.path().join("part.nc")), ..job };
    options.run.stock_cell = Some(1.0);
    let outcome = driver::compile(&options, &mut Stages::default());
    assert!(!outcome.sink.has_errors(), "{:?}", outcome.sink.diags());
    let bc = std::fs::read_to_string(folder.path().join("part.nc")).unwrap();
    let cuts = |text: &str| -> Vec<Vec<f64>> {
        let block = |line: &str| -> Option<Vec<f64>> {
            let of = |word: &str| line.split(' ').find_map(|w| w.strip_prefix(word))?.parse::<f64>().ok();
            line.contains(" G1 ").then_some(())?;
            ["X", "Y", "Z", "A3=", "B3=", "C3="].into_iter().map(of).collect()
        };
        text.lines().filter_map(block).collect()
    };
    let (meant, found) = (cuts(&ac), cuts(&bc));
    assert!(meant.len() > 1000 && meant.len() == found.len(), "{} {}", meant.len(), found.len());
    for (a, b) in meant.iter().zip(&found) {
        assert!(a.iter().zip(b).all(|(p, q)| (p - q).abs() < 1.5e-4), "{a:?} {b:?}");
    }
    // A word of the tilting axis B and of the table C at rapid give the direction of the block at feed behind it.
    let (mut at, mut seen) = ([0.0; 2], 0);
    for line in bc.lines() {
        let of = |word: &str| line.split(' ').find_map(|w| w.strip_prefix(word))?.parse::<f64>().ok();
        match ([of("B="), of("C=")], [of("A3="), of("B3="), of("C3=")]) {
            ([Some(b), Some(c)], _) => at = [b, c].map(f64::to_radians),
            (_, [Some(x), Some(y), Some(z)]) if at != [0.0; 2] => {
                let [b, c] = at;
                let v = [b.sin() * c.cos(), b.sin() * c.sin(), b.cos()];
                assert!((v[0] - x).abs().max((v[1] - y).abs()).max((v[2] - z).abs()) < 1e-6, "{line}");
                (at, seen) = ([0.0; 2], seen + 1);
            }
            _ => {}
        }
    }
    assert!(seen > 20, "{seen}");
}

#[test]
fn kinds_that_are_not_planned_say_so() {
    for (name, changes) in &KINDS[1..] {
        let folder = tempfile::tempdir().unwrap();
        let output = folder.path().join("part.nc");
        let options = Options { output: Some(output.clone()), ..job_on(folder.path(), name, &with_text(changes)) };
        let outcome = driver::compile(&options, &mut Stages::default());
        let codes: Vec<&str> = outcome
            .sink
            .diags()
            .iter()
            .filter(|d| d.severity == impellerc::diag::Severity::Error)
            .map(|d| d.code.id())
            .collect();
        assert_eq!(codes, ["IMP0602"], "{name}");
        assert!(!output.exists());
    }
}

#[test]
fn machine_files_that_cannot_direct_the_tool_are_refused() {
    let cases: [(&[(&str, &str)], &str); 6] = [
        (&[("\"table-table\"", "\"hexapod\"")], "`hexapod` is not a kind of machine"),
        (&[("[axes.A]", "[axes.A]\ndirection = [0, 0, 2]")], "the axes A and C are parallel"),
        (&[("[axes.A]", "[axes.A]\ndirection = [0, 0, 0]")], "axis A has no direction"),
        (&[("kind = \"table-table\"", "kind = \"table-table\"\norder = [\"C\", \"A\"]")], "is parallel to the tool"),
        (
            &[("kind = \"table-table\"", "kind = \"table-table\"\norder = [\"B\", \"C\"]")],
            "does not name both rotary axes",
        ),
        (&[("kind = \"table-table\"", "kind = \"table-table\"\norder = []")], "does not name both rotary axes"),
    ];
    for (changes, words) in cases {
        let (program, outcome) = front("odd", &with_text(changes));
        let told = outcome.sink.diags();
        assert!(program.is_none() && told.iter().any(|d| d.message.contains(words)), "{words}: {told:?}");
    }
}
