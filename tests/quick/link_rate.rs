//! The removal rate of a link is that of its fastest part, however long its way through air is.

use crate::plunge::{block, findings, of_one_operation};
use impellerc::base::entity::PrimaryMap;
use impellerc::base::units::Mm;
use impellerc::diagnostics::Severity;
use impellerc::ir::{JointMove, Motion, MoveKind, Program, Tool};
use nalgebra::{Point3, Vector3};

/// Speed of links and of cuts, mm/s.
const LINK: f64 = 100.0;
const CUT: f64 = 20.0;

/// A flat tool of 4 mm runs 3 mm into a block on a link, 1 mm deep, after a way through air; then it cuts on.
#[test]
fn the_air_before_does_not_lower_it() {
    let program = block(2.0, 1.4);
    let at = |x: f64, z: f64| program.machine.joints(&Point3::new(x, 0.0, z), [0.0; 2]);
    let to = |kind, x: f64, z: f64, way: f64, speed: f64| JointMove {
        kind,
        joints: at(x, z),
        feed: Some(speed * 60.0),
        time: way / speed,
        pass: 0,
        stop: false,
    };
    let run = |air: f64, link: f64| {
        let moves = vec![
            to(MoveKind::Rapid, -8.0 - air, 10.0, 1.0, LINK),
            to(MoveKind::Link, -8.0 - air, -1.0, 11.0, link),
            to(MoveKind::Link, -5.0, -1.0, 3.0 + air, link),
            to(MoveKind::Cut, -1.0, -1.0, 4.0, CUT),
            to(MoveKind::Rapid, -1.0, 10.0, 11.0, LINK),
        ];
        findings(&program, &of_one_operation(&program, moves), 0.2)
    };
    for air in [0.5, 20.0, 200.0] {
        let (found, said) = run(air, LINK);
        let rate = found.link.expect("a link that cuts").value.get();
        println!("{air} mm of air: {rate:.1} mm3/s");
        // At the end of the link the tool is 3 mm deep in the block: a chord of nearly 4 mm, 1 mm deep.
        assert!(rate > 0.8 * 3.9 * LINK && rate < 1.05 * 4.0 * LINK, "{air}: {rate}");
        assert!(said.contains(&(Severity::Error, "IMP0735")), "{air}: {said:?}");
        // At the speed of the cuts it is none.
        let (found, said) = run(air, 0.9 * CUT);
        assert!(found.link.expect("a link that cuts").value.get() < 4.0 * CUT);
        assert!(!said.contains(&(Severity::Error, "IMP0735")), "{air}: {said:?}");
    }
}

/// A full slot, 1 mm deep, from the middle of the block on. Each block of `slot` mm has the kind and speed that `of` gives it.
fn slot(program: &Program, length: f64, of: &dyn Fn(usize) -> (MoveKind, f64), parts: usize) -> Motion {
    let at = |x: f64, z: f64| program.machine.joints(&Point3::new(x, 0.0, z), [0.0; 2]);
    let mut from = [-8.0, 10.0];
    let mut moves = Vec::new();
    let mut to = |kind, x: f64, z: f64, speed: f64| {
        let way = (x - from[0]).hypot(z - from[1]);
        for k in 1..=parts {
            let share = k as f64 / parts as f64;
            let joints = at(from[0] + (x - from[0]) * share, from[1] + (z - from[1]) * share);
            let time = way / speed / parts as f64;
            moves.push(JointMove { kind, joints, feed: Some(speed * 60.0), time, pass: 0, stop: false });
        }
        from = [x, z];
    };
    to(MoveKind::Rapid, -8.5, 10.0, LINK);
    to(MoveKind::Link, -8.5, -1.0, LINK);
    to(MoveKind::Cut, -5.0, -1.0, CUT);
    let count = (6.0 / length) as usize;
    for block in 0..count {
        let (kind, speed) = of(block);
        to(kind, -5.0 + length * (block + 1) as f64, -1.0, speed);
    }
    to(MoveKind::Rapid, -5.0 + length * count as f64, 10.0, LINK);
    of_one_operation(program, moves)
}

/// A slot at the feed of links is one however its blocks divide it, and whatever stands between them.
#[test]
fn short_blocks_are_judged_by_what_they_remove_together() {
    use MoveKind::{Cut, Link};
    type Feeds = fn(usize) -> (MoveKind, f64);
    let program = block(2.0, 1.4);
    let harmed = |length: f64, of: &dyn Fn(usize) -> (MoveKind, f64), parts: usize| {
        let (found, said) = findings(&program, &slot(&program, length, of, parts), 0.2);
        println!("{length} mm in {parts}: {:?}, cuts {:.1} mm3/s", found.link.map(|l| l.value), found.cut_rate.get());
        said.contains(&(Severity::Error, "IMP0735"))
    };
    let fast: [(&str, Feeds); 6] = [
        ("links alone", |_| (Link, LINK)),
        ("one cut", |k| if k == 8 { (Cut, CUT) } else { (Link, LINK) }),
        ("every other block", |k| if k % 2 == 0 { (Cut, CUT) } else { (Link, LINK) }),
        ("every fifth block at link feed", |k| if k % 5 == 0 { (Link, LINK) } else { (Cut, CUT) }),
        ("two link feeds", |k| (Link, if k % 2 == 0 { LINK } else { 0.5 * LINK })),
        ("the end of the pass", |k| if k < 20 { (Cut, CUT) } else { (Link, LINK) }),
    ];
    for (name, of) in fast {
        for length in [0.03, 0.12, 0.2] {
            assert!(harmed(length, &of, 1), "{name}, blocks of {length} mm");
        }
    }
    for parts in [1, 2, 7, 40] {
        assert!(harmed(3.0, &|k| (if k == 0 { Link } else { Cut }, if k == 0 { LINK } else { CUT }), parts), "{parts}");
        assert!(!harmed(3.0, &|_| (Cut, CUT), parts), "{parts}");
        // A link as slow as the cuts harms nothing.
        assert!(!harmed(3.0, &|k| (if k == 0 { Link } else { Cut }, 0.9 * CUT), parts), "{parts}");
    }
}

/// A full slot of a finishing tool counts as one however short its blocks are, straight or to and fro within a micrometre.
#[test]
fn a_slot_in_blocks_of_a_micrometre_is_a_slot() {
    let program = block(2.0, 1.4);
    let slot = |length: f64, across: f64| {
        let at = |x: f64, y: f64, z: f64| program.machine.joints(&Point3::new(x, y, z), [0.0; 2]);
        let to = |kind, at, time: f64| JointMove { kind, joints: at, feed: Some(1200.0), time, pass: 0, stop: false };
        let mut moves =
            vec![to(MoveKind::Rapid, at(-8.5, 0.0, 10.0), 1.0), to(MoveKind::Link, at(-8.5, 0.0, -1.0), 0.55)];
        let count = (4.0 / length) as usize;
        moves.extend((1..=count).map(|k| {
            let y = if k % 2 == 1 { across } else { 0.0 };
            to(MoveKind::Cut, at(-8.5 + length * k as f64, y, -1.0), length / 20.0)
        }));
        moves.push(to(MoveKind::Rapid, at(-8.5 + length * count as f64, 0.0, 10.0), 0.55));
        findings(&program, &of_one_operation(&program, moves), 0.2).0
    };
    let whole = slot(4.0, 0.0);
    let [depth, arc] = [whole.slot_depth.expect("a depth").value.get(), whole.arc.expect("an arc").value.get()];
    assert!((165.0..181.0).contains(&arc) && depth > 0.9, "{arc} deg, {depth} mm");
    for (length, across) in [(0.1, 0.0), (0.015, 0.0), (0.005, 0.0), (0.0015, 0.0), (0.0004, 0.0), (0.001, 0.0005)] {
        let divided = slot(length, across);
        let [d, a] = [divided.slot_depth.map_or(0.0, |p| p.value.get()), divided.arc.map_or(0.0, |p| p.value.get())];
        println!(
            "blocks of {length} mm, {across} mm across: {a:.1} deg, {d:.3} mm; whole: {arc:.1} deg, {depth:.3} mm"
        );
        assert!((160.0..181.0).contains(&a) && d > 0.9 * depth, "{length}: {a} deg, {d} mm");
        let removed = [whole.removed.get(), divided.removed.get()];
        assert!((removed[0] - removed[1]).abs() < 2e-3 * removed[0], "{length}: {removed:?}");
    }
}

/// A tool whose tip is slow and whose flutes are fast, since it turns: the chip counts where it is cut.
#[test]
fn a_fast_turn_with_a_slow_tip_is_a_thick_chip() {
    let program = block(2.0, 1.4);
    let run = |largest: f64, turn: f64| {
        let mut program = program.clone();
        let mut tools = PrimaryMap::new();
        for (_, tool) in program.tools.iter() {
            tools.push(Tool { max_chip: Mm(largest), ..tool.clone() });
        }
        program.tools = tools;
        let declared = program.operations.ids().next().unwrap();
        let teeth = program.operations[declared].speed.get()
            * f64::from(program.tools[program.operations[declared].tool].flutes);
        // 5 mm deep beside the block, and over the way of 0.2 mm the tool turns into it about its tip.
        let tip = Point3::new(0.0, -8.1, -5.0);
        let at = |y: f64, angle: f64| program.machine.joints(&(tip + Vector3::y() * y), [angle, 0.0]);
        let time = 0.2 / 20.0;
        let to = |kind, joints, time| JointMove { kind, joints, feed: Some(1200.0), time, pass: 0, stop: false };
        let mut moves = vec![
            to(MoveKind::Rapid, program.machine.joints(&Point3::new(0.0, -20.0, -5.0), [0.0; 2]), 1.0),
            to(MoveKind::Cut, at(0.0, 0.0), 0.6),
        ];
        moves.extend(
            (1..=20).map(|k| to(MoveKind::Cut, at(0.01 * f64::from(k), turn * f64::from(k) / 20.0), time / 20.0)),
        );
        let (found, said) = findings(&program, &of_one_operation(&program, moves), 0.2);
        (found.chip, said.contains(&(Severity::Error, "IMP0739")), 1200.0 / teeth)
    };
    let tip = run(1e6, 0.0);
    let straight = tip.0.expect("a cut").value.get();
    assert!((straight - tip.2).abs() < 1e-9 * straight, "without a turn {straight} is that of the tip, {}", tip.2);
    for turn in [0.4_f64, -0.4] {
        let (chip, harmed, feed) = run(1e6, turn);
        let Some(chip) = chip else { continue };
        // The axis at a height moves by the way of the tip and by the height times the turn; the tool meets the block up to
        // 6.5 mm over its tip.
        let most = feed * (1.0 + 6.5 * turn.abs() / 0.2);
        let value = chip.value.get();
        println!("turn of {turn}: {value:.4} mm at {:.2} mm; tip {feed:.4} mm", chip.height.get());
        assert!(value > 3.0 * feed && value < most && !harmed, "{chip:?}");
        assert!(run(1.5 * feed, turn).1, "1.5 times the feed of the tip is the limit");
        assert!(!run(1.5 * feed, 0.0).1);
    }
}
