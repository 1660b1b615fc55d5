//! Machines of every kind: the plan for one machine is the same on another, texts for the shipped machines put the tool where
//! plain vectors put it, and rotary axes that end within a pass.

use crate::support::{self, jobs, pinned};
use impellerc::base::entity::PrimaryMap;
use impellerc::base::progress::Progress;
use impellerc::base::source::Span;
use impellerc::diagnostics::Sink;
use impellerc::driver::{self, Options, Outcome, Stages};
use impellerc::five_axis::control::{LengthTo, ModuloWay};
use impellerc::five_axis::{Chain, Joints, Machine, RotaryPose};
use impellerc::ir::{Operation, Program, Tool};
use impellerc::nc;
use impellerc::nc::compare::ComparedMotion;
use impellerc::nc::motion_of::motion_of;
use impellerc::nc_text::compare;
use impellerc::plan::passes::pipeline;
use impellerc::report::proof::details::details;
use impellerc::verify::proof::sweep::Sweep;
use impellerc::verify::stock::Settings;
use impellerc::verify::surface::{self, Limits};
use impellerc::verify::{SPACING, examine};
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

pub(super) fn with_text(changes: &[(&str, &str)]) -> String {
    changes.iter().fold(SHIPPED.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1)
    })
}

pub(super) fn front(name: &str, text: &str) -> (Option<Program>, Outcome) {
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
    let (planned_for, motion) = pinned::small("siemens-840d").planned();
    for (name, changes) in KINDS {
        let (program, outcome) = front(name, &with_text(changes));
        let program = program.unwrap_or_else(|| panic!("{name}: {:?}", outcome.sink.diags()));
        let machine = &program.machine;
        let heads = machine.chain.axes().iter().filter(|a| a.carries == impellerc::five_axis::Carries::Tool).count();
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
    let (planned_for, motion) = pinned::small("siemens-840d").planned();
    // The first two strips of a face, each block in parts so short that the rule between stations does not matter.
    const PARTS: u32 = 8;
    let operation = motion.operations.iter().find(|o| planned_for.operations[o.operation].name == "flank").unwrap();
    let tool = &planned_for.tools[planned_for.operations[operation.operation].tool].solid;
    let own = &planned_for.machine;
    let poses: Vec<RotaryPose> = operation
        .moves
        .windows(2)
        .take_while(|w| w[1].pass < 2)
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
            impellerc::wheel::part::kept::MilledTurned::default(),
            &[sweep],
            2.0 * SPACING,
            &Limits::default(),
            &Progress::default(),
        );
        reports.into_iter().map(|s| (s.gouge.value.get(), s.gouge_bound.get())).collect::<Vec<_>>()
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
    let planned = pinned::small("siemens-840d");
    let ac = nc::emit(nc::find("siemens-840d").unwrap(), &planned.program, &planned.motion, &[]).text();
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

/// The machines that ship, one of each kind.
const GENERIC: [&str; 5] =
    ["generic-ac-table", "generic-bc-table", "generic-b-head-c-table", "generic-ab-head", "generic-nutating-head"];

type Vector = [f64; 3];

fn about_x([x, y, z]: Vector, angle: f64) -> Vector {
    let (s, c) = angle.sin_cos();
    [x, c * y - s * z, s * y + c * z]
}

fn about_y([x, y, z]: Vector, angle: f64) -> Vector {
    let (s, c) = angle.sin_cos();
    [c * x + s * z, y, c * z - s * x]
}

fn about_z([x, y, z]: Vector, angle: f64) -> Vector {
    let (s, c) = angle.sin_cos();
    [c * x - s * y, s * x + c * y, z]
}

fn plus(a: Vector, b: Vector) -> Vector {
    [0, 1, 2].map(|k| a[k] + b[k])
}

/// About the direction (0, 1, 1).
fn about_the_nutating_axis(v: Vector, angle: f64) -> Vector {
    let lean = std::f64::consts::FRAC_PI_4;
    about_x(about_y(about_x(v, -lean), angle), lean)
}

/// A direction of the machine frame in the frame of the part, on the shipped machines: tables turn against their angles.
fn seen_from_the_part(machine: &str, v: Vector, [first, second]: [f64; 2]) -> Vector {
    match machine {
        "generic-ac-table" => about_z(about_x(v, first), second),
        "generic-bc-table" => about_z(about_y(v, first), second),
        "generic-b-head-c-table" | "generic-nutating-head" => about_z(v, second),
        _ => v,
    }
}

/// Tool tip and tool axis in the frame of the part, from the positions of the axes, by plain vectors with the dimensions of the
/// shipped files: heads turn 200 mm above the gauge line, the part lies 50 mm above the origin.
fn tool_by_hand(machine: &str, xyz: Vector, angles: [f64; 2], length: f64) -> (Vector, Vector) {
    const PIVOT: f64 = 200.0;
    let [first, second] = angles;
    let swung = |v: Vector| match machine {
        "generic-b-head-c-table" => about_y(v, first),
        "generic-ab-head" => about_y(about_x(v, first), second),
        "generic-nutating-head" => about_the_nutating_axis(v, first),
        _ => v,
    };
    let pivot = plus(xyz, [0.0, 0.0, PIVOT]);
    let tip = plus(pivot, swung([0.0, 0.0, -PIVOT - length]));
    let [tip, axis] = [tip, swung([0.0, 0.0, 1.0])].map(|v| seen_from_the_part(machine, v, angles));
    (plus(tip, [0.0, 0.0, -50.0]), axis)
}

fn word(line: &str, word: &str) -> Option<f64> {
    line.split(' ').find_map(|w| w.strip_prefix(word))?.parse().ok()
}

fn words<const N: usize>(line: &str, names: [&str; N]) -> Option<[f64; N]> {
    let found: Vec<f64> = names.into_iter().filter_map(|name| word(line, name)).collect();
    found.try_into().ok()
}

/// Checks every station and every rapid of a text: the tip of the station lies straight above the first target along Z of the
/// machine, and rotary words give the direction of the block at feed behind them.
fn stations_agree(name: &str, program: &Program, text: &str) -> [usize; 2] {
    let rotary = [0, 1].map(|k| format!("{}=", program.machine.rotary[k].name));
    let names: [&str; 2] = [&rotary[0], &rotary[1]];
    let (mut z, mut xy, mut angles, mut length) = (f64::NAN, [f64::NAN; 2], [f64::NAN; 2], f64::NAN);
    let (mut due, mut fresh, mut at, mut counted) = (false, false, [f64::NAN; 3], [0; 2]);
    for line in text.lines() {
        if let Some((_, rest)) = line.split_once("T=\"") {
            let tool = rest.split('"').next().unwrap();
            length = program.tools.iter().find(|(_, t)| t.name == tool).unwrap().1.length();
        }
        if line.contains("SUPA") {
            z = word(line, "Z").unwrap_or(z);
            xy = words(line, ["X", "Y"]).unwrap_or(xy);
        }
        if let Some(turned) = words(line, names) {
            angles = turned.map(f64::to_radians);
            fresh = true;
        }
        due |= line.ends_with(" TRAORI");
        if !line.contains("SUPA") && due && line.contains(" G0 ") {
            let target: Vector = words(line, ["X", "Y", "Z"]).unwrap();
            let (tip, _) = tool_by_hand(name, [xy[0], xy[1], z], angles, length);
            let up = seen_from_the_part(name, [0.0, 0.0, 1.0], angles);
            let way = plus(tip, target.map(|x| -x));
            let along: f64 = (0..3).map(|k| way[k] * up[k]).sum();
            let aside = plus(way, up.map(|u| -u * along));
            assert!(along > 10.0 && aside.iter().all(|x| x.abs() < 4e-4), "{name}: {aside:?} {along} at {line}");
            due = false;
            counted[0] += 1;
        }
        let place: Option<Vector> = words(line, ["X", "Y", "Z"]);
        if let (Some(direction), Some(to), true) = (words(line, ["A3=", "B3=", "C3="]), place, fresh) {
            let (_, axis) = tool_by_hand(name, [0.0; 3], angles, length);
            // The way down along the tool axis keeps the direction; where the rapid ends at the first place of a pass, the block
            // behind it is the first cut.
            let way = plus(to, at.map(|x| -x));
            let along: f64 = (0..3).map(|k| way[k] * axis[k]).sum();
            if plus(way, axis.map(|x| -x * along)).iter().all(|x| x.abs() < 2e-4) {
                assert!((0..3).all(|k| (axis[k] - direction[k]).abs() < 3e-7), "{name}: {axis:?} at {line}");
                counted[1] += 1;
            }
            fresh = false;
        }
        at = place.unwrap_or(at);
    }
    counted
}

/// A block at feed: tip, axis, and whether it cuts.
type FeedBlock = (Point3<f64>, Vector3<f64>, bool);

/// The blocks at feed of each operation, from the text; cuts are those at feeds up to the process feed.
fn feed_blocks(program: &Program, text: &str) -> Vec<Vec<FeedBlock>> {
    let feeds: Vec<f64> = program.operations.iter().map(|(_, o)| o.feed.get()).collect();
    let (mut found, mut feed) = (Vec::new(), f64::NAN);
    for line in text.lines() {
        if line.contains(" T=\"") {
            found.push(Vec::new());
        }
        let (Some([x, y, z]), Some([i, j, k])) = (words(line, ["X", "Y", "Z"]), words(line, ["A3=", "B3=", "C3="]))
        else {
            continue;
        };
        feed = word(line, "F").unwrap_or(feed);
        let cuts = feed <= feeds[found.len() - 1];
        found.last_mut().unwrap().push((Point3::new(x, y, z), Vector3::new(i, j, k), cuts));
    }
    found
}

/// Largest distance of the cuts of an operation from the lines between the blocks of another text: at the tip, and at a height
/// over it. Rest machining ends a pass at a station where the stock ends: lines count
/// with some length beyond them, mm.
fn apart(of: &[FeedBlock], from: &[FeedBlock], (height, beyond): (f64, f64)) -> f64 {
    let ends = |(tip, axis, _): &FeedBlock| [*tip, tip + axis * height];
    let distance = |place: &[Point3<f64>; 2], w: &[FeedBlock]| {
        let [a, b] = [ends(&w[0]), ends(&w[1])];
        let (chord, way) = (b[0] - a[0], place[0] - a[0]);
        let more = if beyond > 0.0 { beyond / chord.norm().max(1e-3) } else { 0.0 };
        let share = (chord.dot(&way) / chord.norm_squared()).clamp(-more, 1.0 + more);
        (0..2).map(|k| (place[k] - (a[k] + (b[k] - a[k]) * share)).norm()).fold(0.0, f64::max)
    };
    let nearest = |place: [Point3<f64>; 2]| from.windows(2).map(|w| distance(&place, w)).fold(f64::INFINITY, f64::min);
    of.iter().filter(|block| block.2).map(|place| nearest(ends(place))).fold(0.0, f64::max)
}

/// Roughing and finishing, each in one operation of the reduced job.
const ONE_OF_EACH: [&str; 2] = ["groove", "flank"];

/// Operations of the reduced job on a shipped machine, planned and verified, as text.
fn text_on(machine: &str, operations: &[&str]) -> (Program, String) {
    let whole = jobs::program("reduced", Some(machine));
    let mut program = Program { operations: PrimaryMap::new(), ..whole.clone() };
    for (_, operation) in whole.operations.iter().filter(|(_, o)| operations.contains(&o.name.as_str())) {
        program.operations.push(operation.clone());
    }
    assert_eq!(program.operations.iter().count(), operations.len());
    program.allowed.push(support::deep_slots());
    // Less is roughed than in the whole job, and coarse cells show more depth than there is.
    let mut tools = PrimaryMap::new();
    for (_, tool) in program.tools.iter() {
        tools.push(Tool { max_depth: impellerc::base::units::Mm(30.0), ..tool.clone() });
    }
    program.tools = tools;
    // The largest cells that a job may have: the stock has no part in what is compared.
    let (mut sink, mut settings) = (Sink::default(), Settings { cell: Some(1.0), ..Settings::default() });
    let motion = pipeline::run(&program, &mut sink).unwrap_or_else(|_| panic!("{:?}", sink.diags())).motion;
    let (motion, _) = examine(&program, motion, &mut settings, &Progress::default(), &mut sink).expect("a certificate");
    let motion = motion.unwrap_or_else(|_| panic!("{machine}: {:?}", sink.diags()));
    let post = nc::find("siemens-840d").unwrap();
    let text = nc::emit(post, &program, &motion, &[]).text();
    nc::read_back(post, &program, &motion, &text).unwrap();
    (program, text)
}

/// Compared with the shipped A/C machine of the paper, operation by operation. Stations are thinned within the chord tolerance
/// of each machine. Operations do not depend on each other: what the axes do is decided for each one.
fn cuts_the_same(name: &str, operations: &[&str]) {
    let reference = pinned::reduced("siemens-840d");
    let meant = nc::emit(nc::find("siemens-840d").unwrap(), &reference.program, &reference.motion, &[]).text();
    let names = reference.program.operations.iter().map(|(_, o)| o.name.as_str());
    let meant = names.zip(feed_blocks(&reference.program, &meant)).filter(|(name, _)| operations.contains(name));
    let meant: Vec<Vec<FeedBlock>> = meant.map(|(_, blocks)| blocks).collect();
    let (program, text) = text_on(name, operations);
    let [stations, rapids] = stations_agree(name, &program, &text);
    assert!(stations == program.operations.iter().count() && rapids >= 3, "{name}: {stations} {rapids}");
    let found = feed_blocks(&program, &text);
    assert_eq!(found.len(), meant.len());
    for ((_, operation), (a, b)) in program.operations.iter().zip(meant.iter().zip(&found)) {
        let t = &program.tolerances;
        let chord = if operation.kind.finishes() { t.chord.get() } else { t.chord_rough.get() };
        let height = program.tools[operation.tool].solid.cutter.tip_radius();
        // A line of the floor follows the ball centre; axes may be off by 20 chords at the end of the flutes.
        let lines = (height, if operation.kind.finishes() { 0.0 } else { 2.0 });
        let found = apart(a, b, lines).max(apart(b, a, lines));
        println!("{name} {}: {} and {} blocks, {found:.4} mm apart", operation.name, a.len(), b.len());
        assert!(a.len() > 10 && found < chord + 1e-3, "{name} {}: {found} mm", operation.name);
    }
}

#[test]
fn a_nutating_head_cuts_what_a_table_cuts() {
    cuts_the_same(GENERIC[4], &["groove", "expand", "flank", "channel"]);
}

#[test]
fn a_head_of_two_axes_cuts_what_a_table_cuts() {
    cuts_the_same(GENERIC[3], &ONE_OF_EACH);
}

#[test]
fn a_head_with_a_table_cuts_what_a_table_cuts() {
    cuts_the_same(GENERIC[2], &ONE_OF_EACH);
}

#[test]
fn generic_tables_cut_the_same() {
    cuts_the_same(GENERIC[0], &ONE_OF_EACH);
    cuts_the_same(GENERIC[1], &ONE_OF_EACH);
}

/// Finishing of the faces of the reduced job in sector 3 on the shipped A/C machine with other travels of A and C.
fn flank_with_travels(a: &str, c: &str) -> (tempfile::TempDir, Outcome) {
    flank_on(&with_text(&[("[\"-100 deg\", \"100 deg\"]", a), ("[\"-180 deg\", \"180 deg\"]", c)]))
}

/// Nothing roughs before the faces here.
const SLOTS: &str = "allow slot on flank \"nothing roughs before\"\n";

/// The same on another machine.
fn flank_on(text: &str) -> (tempfile::TempDir, Outcome) {
    let folder = tempfile::tempdir().unwrap();
    let mut options = job_on(folder.path(), "limited", text);
    let job =
        include_str!("../../jobs/reduced/reduced.imp").replace("5mc850-c", "limited").replace("sectors 1", "sectors 3");
    // Nothing is roughed.
    let job = job.replace("max-depth 18 mm", "max-depth 30 mm");
    let (head, rest) = job.split_once("operation groove").unwrap();
    let (_, flank) = rest.split_once("operation flank").unwrap();
    let (flank, _) = flank.split_once("operation channel").unwrap();
    let (_, end) = rest.split_once("tolerance chord").unwrap();
    std::fs::write(&options.job, format!("{head}operation flank{flank}{SLOTS}tolerance chord{end}")).unwrap();
    std::fs::copy("jobs/reduced/vane_curves.csv", folder.path().join("vane_curves.csv")).unwrap();
    options.output = Some(folder.path().join("part.nc"));
    options.run.stock_cell = Some(1.0);
    let outcome = driver::compile(&options, &mut Stages::default());
    (folder, outcome)
}

/// Blocks at feed of a text, and the range of the words of both rotary axes.
fn blocks_and_ranges(folder: &Path) -> (Vec<String>, [[f64; 2]; 2]) {
    let text = std::fs::read_to_string(folder.join("part.nc")).unwrap();
    let mut ranges = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    for turned in text.lines().filter_map(|line| words(line, ["A=", "C="])) {
        for (range, angle) in ranges.iter_mut().zip(turned) {
            *range = [range[0].min(angle), range[1].max(angle)];
        }
    }
    let block = |line: &str| Some(line.split_once(" G1 ")?.1.split(" F").next().unwrap().to_owned());
    (text.lines().filter_map(block).collect(), ranges)
}

fn says(outcome: &Outcome, code: &str) -> Vec<String> {
    outcome.sink.diags().iter().filter(|d| d.code.id() == code).map(|d| d.message.clone()).collect()
}

/// Where the travel of C ends within a pass, the tool leaves the part, turns, and comes back: the same cuts, proved clear.
#[test]
fn a_short_table_turns_within_a_pass() {
    let (wide, outcome) = flank_with_travels("[\"-100 deg\", \"100 deg\"]", "[\"-360 deg\", \"360 deg\"]");
    assert!(jobs::errors(&outcome).is_empty() && says(&outcome, "IMP0603").is_empty(), "{:?}", outcome.sink.diags());
    let (meant, _) = blocks_and_ranges(wide.path());
    for (a, c, limits) in [
        ("[\"-100 deg\", \"100 deg\"]", "[\"-100 deg\", \"100 deg\"]", [[-100.0, 100.0], [-100.0, 100.0]]),
        ("[\"-100 deg\", \"0 deg\"]", "[\"-180 deg\", \"180 deg\"]", [[-100.0, 0.0], [-180.0, 180.0]]),
    ] {
        let (folder, outcome) = flank_with_travels(a, c);
        assert!(jobs::errors(&outcome).is_empty(), "{:?}", outcome.sink.diags());
        let told = says(&outcome, "IMP0603");
        assert!(told.len() == 1 && told[0].contains("`flank` leaves the part once"), "{told:?}");
        let (blocks, ranges) = blocks_and_ranges(folder.path());
        for (range, limits) in ranges.iter().zip(limits) {
            assert!(range[0] >= limits[0] - 1e-5 && range[1] <= limits[1] + 1e-5, "{ranges:?}");
        }
        let missing: Vec<&String> = meant.iter().filter(|block| !blocks.contains(block)).collect();
        // The way from and to the first and last place over the clearance surface is another one.
        assert!(meant.len() > 40 && missing.is_empty(), "{} {missing:?}", meant.len());
        // Out, back, and at most one place where the travel ends.
        assert!((2..=3).contains(&(blocks.len() - meant.len())), "{} {}", blocks.len(), meant.len());
    }
}

/// Where no branch, winding or turn within the pass helps, the job is refused with operation, place, axis and limit.
#[test]
fn travels_that_cannot_be_kept_are_refused() {
    let (folder, outcome) = flank_with_travels("[\"-100 deg\", \"0 deg\"]", "[\"-100 deg\", \"100 deg\"]");
    let errors = jobs::errors(&outcome);
    assert_eq!(errors.len(), 1, "{errors:?}");
    let error = errors[0];
    assert_eq!(error.code.id(), "IMP0601");
    assert!(
        error.message.starts_with("`flank` needs C = ") && error.message.ends_with("is -100.000 to 100.000 deg"),
        "{error:?}"
    );
    assert!(error.place.is_some() && !folder.path().join("part.nc").exists(), "{error:?}");
}

/// Where X, Y or Z leave their travel with every winding of C, the error names this axis: a winding that leaves the travel of C is none
/// that anybody would choose.
#[test]
fn the_axis_that_no_winding_keeps_within_travel_is_named() {
    let (_, outcome) = flank_on(&with_text(&[
        ("[\"-250 mm\", \"250 mm\"]", "[\"-22 mm\", \"22 mm\"]"),
        ("[\"-180 deg\", \"180 deg\"]", "[\"-200 deg\", \"200 deg\"]"),
    ]));
    let errors = jobs::errors(&outcome);
    assert!(errors.iter().all(|e| e.code.id() == "IMP0601") && errors.len() == 1, "{errors:?}");
    assert!(errors[0].message.starts_with("`flank` needs Y = "), "{errors:?}");
    assert!(errors[0].help.as_ref().is_some_and(|help| help.contains("a machine on which Y travels to")), "{errors:?}");
}

/// A head that cannot stand upright gives the tool no direction around the axis of the part.
#[test]
fn heads_without_the_directions_of_the_part_are_refused() {
    let head = include_str!("../../jobs/_lib/machines/generic-ab-head.toml");
    let cases = [
        ("[\"10 deg\", \"50 deg\"]", "A and B of the machine head do not set the tool along the axis of the part"),
        ("[\"-0.5 deg\", \"50 deg\"]", "A and B of the machine head lean the tool to all sides by at most 0.50 deg"),
    ];
    for (travel, message) in cases {
        let folder = tempfile::tempdir().unwrap();
        let text = head.replacen("[\"-100 deg\", \"100 deg\"]", travel, 1);
        let options = Options { output: Some(folder.path().join("part.nc")), ..job_on(folder.path(), "head", &text) };
        let outcome = driver::compile(&options, &mut Stages::default());
        let errors = jobs::errors(&outcome);
        assert!(errors.len() == 1 && errors[0].code.id() == "IMP0602" && errors[0].message == message, "{errors:?}");
    }
}

/// A head at the retract height swings the tool down: the height that it can reach decides, not that of the upright tool.
#[test]
fn a_retract_height_is_judged_under_every_angle_of_the_head() {
    let head = include_str!("../../jobs/_lib/machines/generic-b-head-c-table.toml");
    let folder = tempfile::tempdir().unwrap();
    // The axis B lies 200 mm above the gauge line: the tool hangs lowest when the head is nearly upright.
    let upright = front("head", head).0.unwrap();
    let tool = upright.tools.iter().next().unwrap().1;
    let lowest = tool.lowest(&upright.machine);
    assert!((lowest + tool.length()).abs() < 2.5, "{lowest} {}", tool.length());
    let below = head.replacen("\"0 mm\", \"200 mm\"]", "\"0 mm\", \"-100 mm\"]", 1);
    let swung = front("head", &below).0.unwrap();
    let lowest = swung.tools.iter().next().unwrap().1.lowest(&swung.machine);
    // The axis B lies 100 mm below the gauge line, beyond the tip. At 90 deg the tool is level, 100 mm below the gauge line of
    // the upright head, and hangs down by the radius of its holder.
    assert!((-100.0 - 60.0..-100.0).contains(&lowest), "{lowest}");
    let text = below.replacen("z = \"800 mm\"", "z = \"150 mm\"", 1);
    let options = Options { output: Some(folder.path().join("part.nc")), ..job_on(folder.path(), "head", &text) };
    let outcome = driver::compile(&options, &mut Stages::default());
    assert!(jobs::errors(&outcome).iter().any(|d| d.code.id() == "IMP0740"), "{:?}", outcome.sink.diags());
}

/// Keys that posts use are read, printed, and kept in the machine.
#[test]
fn keys_for_posts_are_handed_on() {
    let text = with_text(&[
        ("kind = ", "tool-length = \"centre\"\nkind = "),
        ("travel = [\"-180 deg\", \"180 deg\"]", "modulo = true\nway = \"shortest\"\nclamp = [\"M10\", \"M11\"]"),
        ("[spindle]", "[home]\ny = \"250 mm\"\n\n[spindle]"),
    ]);
    let (program, outcome) = front("keys", &text);
    let program = program.unwrap_or_else(|| panic!("{:?}", outcome.sink.diags()));
    let machine = &program.machine;
    let [a, c] = &machine.rotary;
    assert_eq!((a.modulo, c.modulo), (None, Some(ModuloWay::Shortest)));
    assert_eq!((&a.clamp, c.clamp.as_ref().unwrap()), (&None, &["M10".to_owned(), "M11".to_owned()]));
    assert!((c.min, c.max) == (f64::NEG_INFINITY, f64::INFINITY) && machine.length_to == LengthTo::Centre);
    assert_eq!(machine.home, [None, Some(250.0), None]);
    let printed = impellerc::ir::print::program(&program);
    for line in [
        "  C is modulo 360 deg, way shortest",
        "  C is clamped by M10, unclamped by M11",
        "  tool lengths to the centre",
        "  parks Y at 250.000",
    ] {
        assert!(printed.contains(line), "{line} is not in {printed}");
    }
    // Planned and verified without a travel: C turns to where it likes.
    let compiled = jobs::Compiled::new(program.clone());
    let certificate = details(&compiled.program, &compiled.motion, &compiled.certificate);
    assert!(certificate.contains("  of            no limits  "), "{certificate}");
    // A post that writes positions of the tip refuses the centre, before planning.
    let folder = tempfile::tempdir().unwrap();
    let options = Options { output: Some(folder.path().join("part.nc")), ..job_on(folder.path(), "keys", &text) };
    let outcome = driver::compile(&options, &mut Stages::default());
    let errors = jobs::errors(&outcome);
    assert!(errors.len() == 1 && errors[0].code.id() == "IMP0809", "{errors:?}");
    an_endless_table_means_the_same(&compiled);
}

/// The same motion on a table that turns without end, in words within one turn, and on one with much travel: for the machine
/// both texts are the same.
fn an_endless_table_means_the_same(compiled: &jobs::Compiled) {
    for dialect in ["siemens-840d", "heidenhain", "fanuc"] {
        let post = nc::find(dialect).unwrap();
        let endless = support::with_post(dialect, &compiled.program);
        let endless = Program { machine: Machine { length_to: LengthTo::Tip, ..endless.machine.clone() }, ..endless };
        let mut limited = endless.clone();
        let [_, c] = &mut limited.machine.rotary;
        (c.min, c.max, c.modulo) = (-20.0 * std::f64::consts::PI, 20.0 * std::f64::consts::PI, None);
        let texts = [&endless, &limited].map(|program| {
            let mut sink = Sink::default();
            post.check(program, &compiled.motion, &mut sink);
            assert!(!sink.has_errors(), "{dialect}: {:?}", sink.diags());
            let text = nc::emit(post, program, &compiled.motion, &[]).text();
            nc::read_back(post, program, &compiled.motion, &text).unwrap_or_else(|d| panic!("{dialect}: {d:?}"));
            text
        });
        assert_ne!(texts[0], texts[1], "{dialect}");
        let [of_endless, of_limited] = [(&endless, &texts[0]), (&limited, &texts[1])].map(|(program, text)| {
            let mut sink = Sink::default();
            let sections = post.read(text, &program.machine).unwrap();
            let motion = motion_of(program, &sections, &|_| Span::default(), &mut sink).unwrap().motion;
            assert!(!sink.has_errors(), "{dialect}: {:?}", sink.diags());
            motion
        });
        let sides = [(&endless, &of_endless), (&limited, &of_limited)];
        for o in compare(sides.map(|(program, motion)| ComparedMotion { program, motion })) {
            assert!(o.is_same() && o.moves[0] == o.moves[1], "{dialect}: {o:?}");
        }
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
        (&[("kind = \"table-table\"", "kind = \"table-table\"\norder = []")], "must be a list of 2 texts"),
    ];
    for (changes, words) in cases {
        let (program, outcome) = front("odd", &with_text(changes));
        let told = outcome.sink.diags();
        assert!(program.is_none() && told.iter().any(|d| d.message.contains(words)), "{words}: {told:?}");
    }
}

/// `corridor` takes other axes where the travel of Y is shorter than those that it would take without this limit.
#[test]
fn corridors_stay_within_the_travel() {
    let changes = [("scallop 12 um", "scallop 1 mm"), ("constant-scallop", "equal-division")];
    let mut program = jobs::program_with("jobs/wei2021/paper-strategies.imp", &changes);
    let channel = program.operations.iter().last().unwrap().1.clone();
    program.operations = PrimaryMap::new();
    program.operations.push(Operation { sectors: vec![0], ..channel });
    let ends = |program: &Program| -> Result<[f64; 2], Sink> {
        let mut sink = Sink::default();
        let Ok(plan) = pipeline::run(program, &mut sink) else { return Err(sink) };
        let y = plan.motion.operations.iter().flat_map(|o| &o.moves).map(|m| m.joints.xyz.y);
        Ok(y.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], y| [least.min(y), most.max(y)]))
    };
    let wide = ends(&program).ok().unwrap();
    // On the other branch Y goes as far to the other side.
    program.machine.linear[1].min = wide[0] + 1.0;
    assert!(-wide[1] < program.machine.linear[1].min);
    let narrow = ends(&program).ok().unwrap();
    assert!(narrow[0] >= program.machine.linear[1].min, "{narrow:?} {wide:?}");
    // Where no clear axis stays within the travel, the error names the axis of the machine, not the tool.
    program.machine.linear[1].min = 200.0;
    let sink = ends(&program).err().unwrap();
    let first = &sink.diags()[0];
    assert!(first.code.id() == "IMP0601" && first.message.starts_with("`channel` needs Y = "), "{first:?}");
    assert!(first.notes.iter().any(|note| note.contains("keeps t3 clear of the part")), "{first:?}");
}
