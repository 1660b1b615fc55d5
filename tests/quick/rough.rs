//! The operation `rough`: what one item of the job means.

use crate::plunge::{Points, cut, planned};
use impellerc::base::source::SourceMap;
use impellerc::diagnostics::{Sink, codes};
use impellerc::ir::{JointMove, Motion, Program};
use impellerc::job::model::OperationSpec;
use impellerc::job::{self, InMemory};
use impellerc::syntax;
use impellerc::wheel::method::{Levels, Milling};
use impellerc::wheel::operation::RoughingStrategy;

const JOB: &str = include_str!("../../jobs/small/rough.imp");

/// The operations of the job with a text replaced, or the codes of its faults.
fn read(from: &str, to: &str) -> Result<Vec<OperationSpec>, Vec<&'static str>> {
    assert!(JOB.contains(from), "{from}");
    read_text(&JOB.replacen(from, to, 1))
}

/// The operations of a job, or the codes of its faults.
fn read_text(text: &str) -> Result<Vec<OperationSpec>, Vec<&'static str>> {
    let mut files = InMemory::default();
    files.curves.insert("vane_curves.csv".to_owned(), include_str!("../../jobs/small/vane_curves.csv").to_owned());
    let (mut sources, mut sink) = (SourceMap::default(), Sink::default());
    let source = sources.add("rough.imp", text);
    let ast = syntax::parse(text, source, &mut sink);
    let partial = job::understand(&ast, &mut files, &mut sources, &mut sink);
    partial.job().map(|job| job.operations).ok_or_else(|| sink.diags().iter().map(|d| d.code.id()).collect())
}

#[test]
fn one_item_is_one_operation_a_tool() {
    let operations = read("tools t1, t2", "tools t1, t2").unwrap();
    let figures = |o: &OperationSpec| match o.kind.strategy() {
        Some(RoughingStrategy::Rough { depth, stepover, levels, milling, .. }) => {
            (o.name.clone(), o.tool, depth.get(), stepover.get(), levels, milling, o.rest.map(|r| r.get()))
        }
        _ => panic!("{:?}", o.kind),
    };
    let found: Vec<_> = operations.iter().map(figures).collect();
    // The defaults by the shapes of a flat and a ball of 2 mm.
    assert_eq!(found[0], ("rough".into(), 0, 0.75, 1.5, Levels::Hub, Milling::Climb, None));
    assert_eq!(found[1], ("rough2".into(), 1, 0.66, 0.8, Levels::Hub, Milling::Climb, Some(0.2)));
    // A tapered ball counts as a ball of its diameter at the tip.
    let operations = read("tool t2 = ball {", "tool t2 = tapered-ball { angle 4 deg ").unwrap();
    assert_eq!((figures(&operations[1]).2, figures(&operations[1]).3), (0.66, 0.8));
    // One value for all tools, or one for each.
    let given = "depth 0.5 mm, 0.4 mm  stepover 1 mm  levels from-shroud  milling conventional  allowance vane";
    let found: Vec<_> = read("allowance vane", given).unwrap().iter().map(figures).collect();
    assert_eq!((found[0].2, found[0].3, found[1].2, found[1].3), (0.5, 1.0, 0.4, 1.0));
    assert_eq!((found[0].4, found[0].5), (Levels::Shroud, Milling::Conventional));
    let speeds = read("speed 12000 rpm", "speed 12000 rpm, 10000 rpm").unwrap();
    assert_eq!([speeds[0].speed.get(), speeds[1].speed.get()], [12000.0, 10000.0]);
}

/// Without `tools` all that can rough: the widest first, and of two as wide as each other the flat one.
#[test]
fn by_default_all_tools_rough_that_can() {
    const TOOLS: &str = "tool t1 = flat { diameter 2 mm  flutes 4  flute 12 mm  reach 25 mm  holder \"er16-mini\" }\n\
                         tool t2 = ball { diameter 2 mm  flutes 4  flute 12 mm  reach 25 mm  holder \"er16-mini\" }\n";
    let text = JOB.replacen("  tools t1, t2  speed", "  speed", 1);
    let tool = |name: &str, kind: &str| {
        let flute = if kind.contains("lollipop") { "" } else { "flute 12 mm  " };
        format!("tool {name} = {kind}  flutes 4  {flute}reach 25 mm  holder \"er16-mini\" }}\n")
    };
    let used = |tools: &str| -> Result<Vec<usize>, Vec<&'static str>> {
        assert!(text.contains(TOOLS));
        read_text(&text.replace(TOOLS, tools)).map(|operations| operations.iter().map(|o| o.tool).collect())
    };
    let (flat, ball) = (tool("t1", "flat { diameter 2 mm"), tool("t2", "ball { diameter 2 mm"));
    assert_eq!(used(&format!("{flat}{ball}")), Ok(vec![0, 1]));
    assert_eq!(used(&format!("{ball}{flat}")), Ok(vec![1, 0]));
    let wide = tool("t3", "ball { diameter 3 mm");
    assert_eq!(used(&format!("{flat}{ball}{wide}")), Ok(vec![2, 0, 1]));
    let lollipop = tool("t4", "lollipop { diameter 3 mm  neck 2 mm");
    assert_eq!(used(&format!("{lollipop}{ball}")), Ok(vec![1]));
    assert_eq!(used(&lollipop), Err(vec![codes::job::MISSING_PROPERTY.id()]));
}

/// Without a figure loops have the arc of a line at the stepover, within the arcs that loops may have.
#[test]
fn slots_are_full_or_trochoidal() {
    let arcs = |text: &str| -> Vec<Option<f64>> {
        let arc = |o: &OperationSpec| match o.kind.strategy() {
            Some(RoughingStrategy::Rough { slots, .. }) => slots.engagement().map(|arc| arc.get().to_degrees()),
            _ => panic!("{:?}", o.kind),
        };
        read("feed 300 mm/min", &format!("feed 300 mm/min  {text}")).unwrap().iter().map(arc).collect()
    };
    assert_eq!(arcs(""), [None, None]);
    assert_eq!(arcs("slots full"), [None, None]);
    let near = |found: &[Option<f64>], wanted: [f64; 2]| {
        assert!(found.iter().zip(wanted).all(|(f, w)| (f.unwrap() - w).abs() < 1e-9), "{found:?}");
    };
    near(&arcs("slots trochoidal  engagement 75 deg"), [75.0; 2]);
    // acos(1 - 2 * 1.5 / 2) and acos(1 - 2 * 0.8 / 2).
    near(&arcs("slots trochoidal"), [120.0, 0.2_f64.acos().to_degrees()]);
    near(&arcs("slots trochoidal  stepover 0.5 mm"), [60.0; 2]);
    near(&arcs("slots trochoidal  stepover 0.01 mm"), [20.0; 2]);
}

/// An allowance at the tip and at the root is read back from its own text, and one value means the same as two equal ones.
#[test]
fn an_allowance_may_grow_towards_the_root() {
    let vane = |text: &str| read("vane 0.2 mm", &format!("vane {text}")).unwrap()[1].kind.roughing().unwrap().vane;
    for (text, tip, root) in [
        ("0.2 mm .. 0.6 mm", 0.2, 0.6),
        ("0.2mm..0.6mm", 0.2, 0.6),
        ("0 mm .. 300 um + 0.1 mm", 0.0, 0.4),
        ("(0.1 mm + 0.1 mm) .. 2 * 0.3 mm", 0.2, 0.6),
        ("0.3 mm .. 0.3 mm", 0.3, 0.3),
        ("0.3 mm", 0.3, 0.3),
    ] {
        let found = vane(text);
        assert!((found.tip().get() - tip).abs() < 1e-12 && (found.root().get() - root).abs() < 1e-12, "{text}");
        assert_eq!(vane(&found.to_string()), found, "{found}");
    }
    assert_eq!(vane("0.3 mm .. 0.3 mm"), vane("0.3 mm"));
    assert_eq!(vane("0.3 mm .. 0.3 mm").to_string(), "0.3 mm");
    // Linear over the height, and no more than at the ends.
    let found = vane("0.2 mm .. 0.6 mm");
    for (height, mm) in [(-1.0, 0.6), (0.0, 0.6), (0.25, 0.5), (0.5, 0.4), (1.0, 0.2), (2.0, 0.2)] {
        assert!((found.at(height) - mm).abs() < 1e-12, "{height}");
    }
}

#[test]
fn faults_of_the_item_are_named() {
    for (from, to, code) in [
        ("speed 12000 rpm", "speed 1 rpm, 2 rpm, 3 rpm", codes::job::WRONG_FORM),
        ("tools t1, t2", "tools t1, t9", codes::job::UNKNOWN_NAME),
        ("feed 300 mm/min", "", codes::job::MISSING_PROPERTY),
        ("feed 300 mm/min", "feed 300 mm/min  levels floor", codes::job::UNKNOWN_NAME),
        ("feed 300 mm/min", "feed 300 mm/min  depth 90 mm", codes::job::OUT_OF_RANGE),
        ("feed 300 mm/min", "feed 300 mm/min  residual 1 mm", codes::job::UNKNOWN_PROPERTY),
        ("feed 300 mm/min", "feed 300 mm/min  slots round", codes::job::UNKNOWN_NAME),
        ("feed 300 mm/min", "feed 300 mm/min  engagement 60 deg", codes::job::WRONG_FORM),
        ("feed 300 mm/min", "feed 300 mm/min  slots full  engagement 60 deg", codes::job::WRONG_FORM),
        ("feed 300 mm/min", "feed 300 mm/min  slots trochoidal  engagement 10 deg", codes::job::OUT_OF_RANGE),
        ("feed 300 mm/min", "feed 300 mm/min  slots trochoidal  engagement 160 deg", codes::job::OUT_OF_RANGE),
        ("feed 300 mm/min", "feed 300 mm/min  slots trochoidal  engagement 1 mm", codes::job::WRONG_DIMENSION),
        ("  allowance vane 0.2 mm, hub 0.4 mm\n", "", codes::job::MISSING_PROPERTY),
        ("vane 0.2 mm", "vane 0.4 mm .. 0.2 mm", codes::job::OUT_OF_RANGE),
        ("vane 0.2 mm", "vane -0.1 mm .. 0.2 mm", codes::job::OUT_OF_RANGE),
        ("vane 0.2 mm", "vane 0.2 mm .. -0.4 mm", codes::job::OUT_OF_RANGE),
        ("vane 0.2 mm", "vane 0.2 .. 0.4 mm", codes::job::NO_UNIT),
        ("vane 0.2 mm", "vane 0.2 mm .. 3 rpm", codes::job::WRONG_DIMENSION),
        ("vane 0.2 mm", "vane 0.2 mm .. 0.4 mm .. 0.6 mm", codes::syntax::UNEXPECTED),
        ("vane 0.2 mm", "vane 0.2 mm ..", codes::syntax::UNEXPECTED),
        ("hub 0.4 mm", "hub 0.4 mm .. 0.6 mm", codes::job::WRONG_FORM),
        ("chord 1 um", "chord 1 um .. 2 um", codes::job::WRONG_FORM),
        ("feed 300 mm/min", "feed 300 mm/min  rest over 0.1 mm .. 0.2 mm", codes::job::WRONG_FORM),
        ("feed 300 mm/min", "feed 300 mm/min .. 400 mm/min", codes::syntax::UNEXPECTED),
    ] {
        let found = read(from, to).map(|o| o.len());
        assert!(found.as_ref().is_err_and(|f| f.contains(&code.id())), "{to}: {found:?}");
    }
}

/// A flat tool whose blank stands over the shroud: on its ways down along the axis, at link feed and at cutting feed, no
/// point of material is under the middle of its end. Points of a grid, without the stocks of planner and verifier.
#[test]
fn no_way_down_along_the_axis_has_material_under_the_middle() {
    const MIDDLE: f64 = 0.5;
    let (program, mut motion) = planned(
        JOB,
        &[
            ("over shroud 0 mm", "over shroud 0.375 mm"),
            ("tools t1, t2 ", "tools t1 "),
            ("tool t2", "tool t0"),
            ("hub 0.4 mm", "hub 0.4 mm  sectors 2"),
            ("require rest      <= 0.8 mm", ""),
        ],
    );
    assert_eq!(program.tools[program.operations.iter().next().unwrap().1.tool].toothless_radius(), Some(MIDDLE));
    let found = |motion: &Motion, step: f64| cut(&mut Points::new(&program, motion, step), &program, motion, MIDDLE);
    let planned = found(&motion, 0.15);
    assert!(planned.strokes > 50 && planned.into_middle <= 0.05, "{planned:?}");
    begin_inside(&program, &mut motion);
    let inside = found(&motion, 0.3);
    assert!(inside.into_middle > 0.3, "{inside:?}");
}

/// Moves the starts of passes, with the ways down to them, 4 mm along their passes.
fn begin_inside(program: &Program, motion: &mut Motion) {
    for operation in &mut motion.operations {
        let moves = &mut operation.moves;
        for i in 1..moves.len() {
            let tip = |m: &JointMove| program.machine.forward(&m.joints).tip;
            let axis = program.machine.chain.tool_axis(moves[i].joints.rotary);
            let start = tip(&moves[i]);
            let way = start - tip(&moves[i - 1]);
            let inside = moves[i..].iter().take_while(|m| m.pass == moves[i].pass);
            let inside = inside.map(|m| m.joints).find(|j| (program.machine.forward(j).tip - start).norm() > 4.0);
            if let Some(to) = inside.filter(|_| way.norm() > 0.0 && axis.dot(&way) < -0.999_999 * way.norm()) {
                let axis = program.machine.chain.tool_axis(to.rotary);
                moves[i - 1].joints =
                    program.machine.joints(&(program.machine.forward(&to).tip + axis * 3.0), to.rotary);
                moves[i].joints = to;
            }
        }
    }
}
