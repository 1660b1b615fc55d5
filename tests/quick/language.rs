//! The job language: accepted texts, refused texts, and the words of the messages.

use impellerc::base::source::{SourceFile, SourceId, SourceMap};
use impellerc::diagnostics::{Code, Sink, codes, render};
use impellerc::job::files::shipped;
use impellerc::job::model::{CutterKind, OperationKind};
use impellerc::job::{self, Files, Job, MissingFile};
use impellerc::syntax;
use impellerc::wheel::contract::{ContractKind, Cuts, Guarded};
use impellerc::wheel::method::{AxisMethod, Lines, Milling, Spacing};
use impellerc::wheel::part::{BladeId, SurfaceClass, SurfaceKind};
use proptest::prelude::*;

const JOB: &str = include_str!("../../jobs/wei2021/paper-strategies.imp");
const REDUCED: &str = include_str!("../../jobs/reduced/reduced.imp");

/// The shipped library and the curves of the reduced job.
struct Memory;

impl Files for Memory {
    fn machine(&mut self, name: &str) -> Result<SourceFile, MissingFile> {
        find(name, shipped::MACHINES)
    }

    fn tools(&mut self, name: &str) -> Result<SourceFile, MissingFile> {
        find(name, shipped::TOOLS)
    }

    fn post(&mut self, name: &str) -> Result<SourceFile, MissingFile> {
        find(name, shipped::POSTS)
    }

    fn curves(&mut self, path: &str) -> Result<SourceFile, MissingFile> {
        find(path, &[("vane_curves.csv", include_str!("../../jobs/reduced/vane_curves.csv"))])
    }

    fn mesh(&mut self, path: &str) -> Result<SourceFile, MissingFile> {
        find(path, &[])
    }
}

fn find(name: &str, files: &[(&str, &str)]) -> Result<SourceFile, MissingFile> {
    let known: Vec<String> = files.iter().map(|f| f.0.to_owned()).collect();
    match files.iter().find(|f| f.0 == name) {
        Some((name, text)) => Ok(SourceFile::text(*name, *text)),
        None => Err(MissingFile { reason: "not in memory".to_owned(), known, ..MissingFile::default() }),
    }
}

struct Read {
    sources: SourceMap,
    sink: Sink,
    job: Option<Job>,
}

fn read(text: &str) -> Read {
    let mut sources = SourceMap::default();
    let mut sink = Sink::default();
    let source = sources.add("job.imp", text);
    let ast = syntax::parse(text, source, &mut sink);
    let job = job::resolve(&ast, &mut Memory, &mut sources, &mut sink).ok();
    Read { sources, sink, job }
}

impl Read {
    fn codes(&self) -> Vec<Code> {
        self.sink.diags().iter().map(|d| d.code).collect()
    }
}

/// A job with one change; the change must occur.
fn changed(from: &str, to: &str) -> String {
    assert!(JOB.contains(from), "{from} is not in the job");
    JOB.replacen(from, to, 1)
}

#[test]
fn the_main_job_reads_as_it_is_written() {
    let read = read(JOB);
    assert_eq!(read.codes(), []);
    let job = read.job.unwrap();
    assert_eq!(job.part.vanes.value, 8);
    assert_eq!(job.part.main().fillet, Some(impellerc::base::units::Mm(3.0).into()));
    assert_eq!(job.part.main().faces().unwrap()[0].tip.points[0], [15.0578, -38.5221, 0.0]);
    assert_eq!(job.part.main().faces().unwrap()[1].root.points[6], [-3.9268, -58.9631, -32.5]);
    let names: Vec<&str> = job.operations.iter().map(|o| o.name.as_str()).collect();
    assert_eq!(names, ["groove", "expand", "groove2", "expand2", "flank", "channel"]);
    assert_eq!(job.operations[0].speed.get(), 4500.0);
    assert_eq!(job.operations[0].feed.get(), 150.0);
    let scallop = impellerc::base::units::Mm(0.012);
    assert_eq!(
        job.operations[5].kind,
        OperationKind::Channel {
            scallop,
            spacing: Spacing::ConstantScallop,
            lines: Lines::Zigzag,
            method: AxisMethod::Corridor,
            allowance_vane: None,
        }
    );
    assert_eq!(job.operations[5].sectors, [0, 1, 2, 3, 4, 5, 6, 7]);
    assert_eq!((job.chord.get(), job.clearance.get()), (0.00025, 0.5));
    assert_eq!(job.machine.spindle.map(|s| s.get()), [100.0, 18000.0]);
    assert!((job.machine.rotary[1].speed - 30.0 * std::f64::consts::TAU / 60.0).abs() < 1e-12);
    assert_eq!((job.post.name.as_str(), job.post.dialect.as_str()), ("siemens-840d", "siemens-840d"));
}

#[test]
fn curves_from_a_file_are_the_curves_of_the_main_job() {
    let (main, reduced) = (read(JOB).job.unwrap(), read(REDUCED).job.unwrap());
    assert_eq!(main.part.main().faces().unwrap()[0].tip.points, reduced.part.main().faces().unwrap()[0].tip.points);
    assert_eq!(main.part.main().faces().unwrap()[1].root.points, reduced.part.main().faces().unwrap()[1].root.points);
    assert_eq!(reduced.operations[0].sectors, [0, 7]);
}

#[test]
fn expand_takes_the_layers_of_the_groove_before_it() {
    let job = read(REDUCED).job.unwrap();
    let kind = |o: usize| &job.operations[o].kind;
    let layers = |o: usize| kind(o).step_down().zip(kind(o).roughing());
    assert!(layers(0).is_some());
    assert_eq!(layers(0), layers(1));
}

/// The main job with these properties of `channel` in place of its tool, its speed, its feed and its spacing.
fn floor(properties: &str) -> String {
    let text = changed("tool t3  speed 8000 rpm  feed 250 mm/min  spacing constant-scallop", properties);
    let larger = "tool t9 = ball { diameter 10 mm  flutes 4  flute 30 mm  reach 50 mm  holder \"er16-mini\" }\n\
                  tool t8 = bull { diameter 8 mm  corner 1 mm  flutes 4  flute 30 mm  reach 50 mm  holder \"er16-mini\" }\n";
    text.replacen("operation groove", &format!("{larger}operation groove"), 1)
}

#[test]
fn a_channel_with_tools_is_an_operation_for_each() {
    let job = read(&floor("tools t9, t3  speed 6000 rpm, 8000 rpm  feed 300 mm/min")).job.unwrap();
    let [larger, last] = &job.operations[5..] else { panic!("{} operations", job.operations.len()) };
    assert_eq!([larger.name.as_str(), last.name.as_str()], ["channel", "channel2"]);
    assert_eq!([larger, last].map(|o| o.speed.get()), [6000.0, 8000.0]);
    assert_eq!([larger, last].map(|o| o.feed.get()), [300.0; 2]);
    assert_eq!([larger, last].map(|o| job.tools[o.tool].diameter.get()), [10.0, 6.0]);
    // The larger ball leaves a default, which is printed; the last one leaves nothing.
    assert_eq!(larger.kind.of_larger_tool(), Some(impellerc::base::units::Mm(0.2)));
    assert_eq!(last.kind.of_larger_tool(), None);
    let printed = job::print::print(&job);
    // Both are one item again.
    let item = printed.split("operation channel channel {\n").nth(1).unwrap().split('}').next().unwrap();
    for line in ["  tools t9, t3\n", "  speed 6000 rpm, 8000 rpm\n", "  allowance vane 0.2 mm\n"] {
        assert!(item.contains(line), "{line} is not in\n{item}");
    }
    assert!(!printed.contains("channel2"), "{printed}");
    let given = read(&floor("tools t9, t3  speed 8000 rpm  feed 300 mm/min  allowance vane 0.35 mm")).job.unwrap();
    assert_eq!(given.operations[5].kind.of_larger_tool(), Some(impellerc::base::units::Mm(0.35)));
    // A bull nose has a method of its own for its axis.
    let bull = read(&floor("tools t8, t3  speed 8000 rpm  feed 300 mm/min")).job.unwrap();
    let methods = [5, 6].map(|k: usize| bull.operations[k].kind.axis_method());
    assert_eq!(methods, [Some(AxisMethod::Lead), last.kind.axis_method()]);
    // A list of one tool is that tool.
    let one = read(&floor("tools t3  speed 8000 rpm  feed 250 mm/min  spacing constant-scallop")).job.unwrap();
    let plain = read(JOB).job.unwrap();
    assert_eq!(one.operations.len(), 6);
    assert_eq!(one.operations[5].kind, plain.operations[5].kind);
}

#[test]
fn lists_of_balls_that_mean_nothing_are_refused() {
    let tail = "speed 8000 rpm  feed 250 mm/min";
    for (properties, code, words) in [
        (format!("tools t3, t9  {tail}"), codes::job::WRONG_TOOL, "do not get smaller"),
        (format!("tools t9, t9  {tail}"), codes::job::WRONG_TOOL, "do not get smaller"),
        (format!("tools t1, t3  {tail}"), codes::job::WRONG_TOOL, "cannot use a flat tool"),
        (format!("tools t9, t8  {tail}"), codes::job::WRONG_TOOL, "cannot use a bull tool"),
        (format!("tools t8  {tail}"), codes::job::WRONG_TOOL, "cannot use a bull tool"),
        (format!("tools t9, t3  {tail}  spacing equal-division"), codes::job::WRONG_FORM, "needs one tool"),
        (format!("tools t9, t3  {tail}, 3 mm/min, 4 mm/min"), codes::job::WRONG_FORM, "one for each of the 2 tools"),
        (format!("tools t9, t3  {tail}  allowance hub 1 mm"), codes::job::UNKNOWN_PROPERTY, "no part `hub`"),
        (format!("tools t9, t3  {tail}  allowance vane -1 mm"), codes::job::OUT_OF_RANGE, "allowance vane"),
        (format!("tools t3  {tail}  allowance vane 1 mm"), codes::job::UNKNOWN_PROPERTY, "no property `allowance`"),
        (format!("tools t9, t3  tool t3  {tail}"), codes::job::UNKNOWN_PROPERTY, "no property `tool`"),
    ] {
        let read = read(&floor(&properties));
        let found = read.sink.diags().iter().find(|d| d.code == code);
        let found = found.unwrap_or_else(|| panic!("{properties}: {:?}", read.sink.diags()));
        assert!(found.message.contains(words), "{properties}: {}", found.message);
        assert!(read.job.is_none() && found.help.is_some(), "{properties}");
    }
}

#[test]
fn spacing_is_named_and_has_a_default() {
    let spacing = |text: &str| match read(text).job.unwrap().operations[5].kind {
        OperationKind::Channel { spacing, .. } => spacing,
        ref other => panic!("{other:?}"),
    };
    assert_eq!(spacing(&changed("spacing constant-scallop", "")), Spacing::ConstantScallop);
    for named in Spacing::ALL {
        assert_eq!(spacing(&changed("constant-scallop", named.name())), named);
    }
}

#[test]
fn methods_of_tool_axes_are_named_and_have_a_default() {
    let method = |text: &str| match read(text).job.unwrap().operations[5].kind {
        OperationKind::Channel { method, .. } => method,
        ref other => panic!("{other:?}"),
    };
    assert_eq!(method(&changed("method corridor", "")), AxisMethod::Corridor);
    for named in AxisMethod::ALL {
        assert_eq!(method(&changed("method corridor", &format!("method {}", named.name()))), named);
    }
    let read = read(&changed("method corridor", "method coridor"));
    let error = read.sink.diags().iter().find(|d| d.code.id() == "IMP0203").expect("an error");
    assert!(format!("{error:?}").contains("corridor"));
}

/// The main job with another operation for its faces.
fn with_faces(operation: &str) -> String {
    let from = JOB.find("operation flank").expect("flank");
    let to = from + JOB[from..].find('}').expect("its end") + 1;
    format!("{}{operation}{}", &JOB[..from], &JOB[to..])
}

#[test]
fn point_milling_names_its_surfaces_and_order() {
    let common = "tool t2  speed 8000 rpm  feed 250 mm/min  scallop 20 um";
    let kind = |text: &str| {
        let read = read(&with_faces(text));
        assert_eq!(read.codes(), []);
        read.job.unwrap().operations[4].clone()
    };
    let faces = BladeId::MAIN.faces();
    let [both, fillets] = [faces.map(SurfaceKind::Face).to_vec(), faces.map(SurfaceKind::Fillet).to_vec()];
    let [inlet, outlet] = [SurfaceKind::InletEdge(BladeId::MAIN), SurfaceKind::OutletEdge(BladeId::MAIN)];
    for (text, name, expected, order) in [
        ("point { COMMON }", "point", both.clone(), Lines::Zigzag),
        ("point { COMMON  faces suction  lines one-way }", "point", vec![both[1]], Lines::OneWay),
        ("point { COMMON  lines spiral }", "point", both.clone(), Lines::Spiral),
        ("fillet { COMMON }", "fillet", fillets.clone(), Lines::Zigzag),
        ("edge { COMMON  edges outlet }", "edge", vec![outlet], Lines::Zigzag),
        ("edge { COMMON }", "edge", vec![inlet, outlet], Lines::Zigzag),
        ("fillet { COMMON  lines one-way  milling conventional }", "fillet", fillets, Lines::OneWay),
        ("point { COMMON  order levels  depth 4 mm }", "point", both.clone(), Lines::Zigzag),
        ("point { COMMON  lines one-way  order faces }", "point", both.clone(), Lines::OneWay),
        ("edge { COMMON  lines one-way }", "edge", vec![inlet, outlet], Lines::OneWay),
        ("tip { COMMON }", "tip", vec![SurfaceKind::Tip(BladeId::MAIN)], Lines::Zigzag),
        ("tip { COMMON  lines one-way }", "tip", vec![SurfaceKind::Tip(BladeId::MAIN)], Lines::OneWay),
    ] {
        let operation = kind(&format!("operation {}", text.replace("COMMON", common)));
        assert_eq!((operation.name.as_str(), operation.kind.keyword()), (name, name));
        let OperationKind::Point { surfaces, scallop, lines, milling, levels, method } = operation.kind else {
            panic!("{text}")
        };
        assert_eq!((surfaces, lines), (expected, order), "{text}");
        // Climb milling unless the job says otherwise; lines of both directions and those along edges and tips have no sense.
        let sense = match (name, order) {
            ("edge" | "tip", _) | (_, Lines::Zigzag) => None,
            _ if text.contains("conventional") => Some(Milling::Conventional),
            _ => Some(Milling::Climb),
        };
        assert_eq!(milling, sense, "{text}");
        assert_eq!(levels.map(|l| l.get()), text.contains("levels").then_some(4.0), "{text}");
        assert_eq!((scallop.get(), method), (0.02, AxisMethod::Corridor));
    }
}

#[test]
fn point_milling_that_cannot_be_is_refused() {
    let common = "tool t2  speed 8000 rpm  feed 250 mm/min  scallop 20 um";
    for (text, code) in [
        ("point { COMMON  lines spiral  faces suction }", "IMP0210"),
        ("point { COMMON  faces hub }", "IMP0203"),
        ("edge { COMMON  lines spiral }", "IMP0203"),
        ("edge { COMMON  lines one-way  milling climb }", "IMP0204"),
        ("point { COMMON  milling climb }", "IMP0210"),
        ("fillet { COMMON  lines zigzag  milling conventional }", "IMP0210"),
        ("point { COMMON  lines one-way  milling up }", "IMP0203"),
        ("point { COMMON  order levels }", "IMP0205"),
        ("point { COMMON  order levels  depth 0 mm }", "IMP0209"),
        ("point { COMMON  depth 5 mm }", "IMP0210"),
        ("point { COMMON  order strips }", "IMP0203"),
        ("point { COMMON  order levels  depth 5 mm  faces suction }", "IMP0210"),
        ("point { COMMON  order levels  depth 5 mm  lines spiral }", "IMP0210"),
        ("fillet { COMMON  order levels }", "IMP0204"),
        ("flank { tool t2  speed 8000 rpm  feed 250 mm/min  order levels  faces pressure }", "IMP0210"),
        ("flank { tool t2  speed 8000 rpm  feed 250 mm/min  order levels  depth 5 mm }", "IMP0204"),
        ("flank { tool t2  speed 8000 rpm  feed 250 mm/min  milling zigzag }", "IMP0203"),
        ("edge { COMMON  edges inlet, inlet }", "IMP0202"),
        ("fillet { COMMON  edges inlet }", "IMP0204"),
        ("fillet { tool t1  speed 8000 rpm  feed 250 mm/min  scallop 20 um }", "IMP0212"),
    ] {
        let codes = read(&with_faces(&format!("operation {}", text.replace("COMMON", common)))).codes();
        assert!(codes.iter().any(|c| c.id() == code), "{text}: {codes:?}");
    }
    // A bull nose keeps one tilt a line.
    let bull = |method: &str| {
        let operation = format!("operation point {{ {common}{method} }}").replace("t2", "t9");
        let tool =
            "tool t9 = bull { diameter 6 mm  corner 1 mm  flutes 4  flute 30 mm  reach 50 mm  holder \"er16-mini\" }\n";
        read(&with_faces(&operation).replacen("operation groove", &format!("{tool}operation groove"), 1))
    };
    let OperationKind::Point { method, .. } = bull("").job.unwrap().operations[4].kind else { panic!("point") };
    assert_eq!(method, AxisMethod::Blend);
    assert!(bull("  method corridor").codes().iter().any(|c| c.id() == "IMP0210"));
}

#[test]
fn independent_faults_are_reported_in_one_run() {
    let text = changed("fillet 3 mm", "fillet 3")
        .replacen("scallop 12 um", "scalop 12 um", 1)
        .replacen("tool t1  speed 4500 rpm", "tool t9  speed 4500 rpm", 1)
        .replacen("strips auto", "strips = auto", 1)
        .replacen("require rest      <= 1 mm", "require rest      >= 1 mm", 1);
    let mut ids: Vec<&str> = read(&text).sink.diags().iter().map(|d| d.code.id()).collect();
    ids.sort_unstable();
    assert_eq!(ids, ["IMP0112", "IMP0203", "IMP0204", "IMP0206", "IMP0216"]);
}

/// A fix that is applied removes its diagnostic.
#[test]
fn fixes_mend_what_they_are_offered_for() {
    let cases = [
        ("fillet 3 mm", "fillet 3", codes::job::NO_UNIT),
        ("scallop 12 um", "scalop 12 um", codes::job::UNKNOWN_PROPERTY),
        ("operation flank", "opration flank", codes::syntax::UNKNOWN_ITEM),
        ("edition 2026", "edition 2027", codes::job::EDITION),
        ("require gouge     <=", "require gouge     >=", codes::job::RELATION),
        ("\"5mc850-c\"", "\"5mc850c\"", codes::files::NOT_IN_LIBRARY),
        ("holder \"er16-mini\"", "holder \"er16mini\"", codes::job::UNKNOWN_NAME),
        ("diameter 8 mm", "diameter 8 mmm", codes::job::UNKNOWN_UNIT),
        ("feed 150 mm/min", "feed 150", codes::job::NO_UNIT),
        ("constant-scallop", "constant-scalop", codes::job::UNKNOWN_NAME),
    ];
    for (right, wrong, code) in cases {
        let text = changed(right, wrong);
        let faulty = read(&text);
        assert_eq!(faulty.codes(), [code], "for {wrong}");
        let fix = faulty.sink.diags()[0].fix.clone().unwrap_or_else(|| panic!("no fix for {wrong}"));
        let mut mended = text.clone();
        mended.replace_range(fix.span.range(), &fix.replacement);
        assert_eq!(read(&mended).codes(), [], "after the fix of {wrong}");
    }
}

#[test]
fn units_are_converted_and_checked() {
    let job = |text: String| read(&text).job.unwrap_or_else(|| panic!("faulty"));
    assert_eq!(
        job(changed("fillet 3 mm", "fillet 0.25 in")).part.main().fillet,
        Some(impellerc::base::units::Mm(6.35).into())
    );
    assert_eq!(
        job(changed("fillet 3 mm", "fillet 3000 um")).part.main().fillet,
        Some(impellerc::base::units::Mm(3.0).into())
    );
    assert_eq!(
        job(changed("fillet 3 mm", "fillet (1 mm + 2 mm) * 4 / 3 - 1 mm")).part.main().fillet,
        Some(impellerc::base::units::Mm(3.0).into())
    );
    assert_eq!(
        job(changed("fillet 3 mm", "fillet 150 % * 2 mm")).part.main().fillet,
        Some(impellerc::base::units::Mm(3.0).into())
    );
    // A cutting speed of 100 m/min at 8 mm, and 0.01 mm a tooth.
    let job = job(changed("speed 4500 rpm  feed 150 mm/min", "speed 100 m/min  feed 0.01 mm/tooth"));
    let rpm = 100_000.0 / (std::f64::consts::PI * 8.0);
    assert!((job.operations[0].speed.get() - rpm).abs() < 1e-9);
    assert!((job.operations[0].feed.get() - 0.01 * 4.0 * rpm).abs() < 1e-9);
}

#[test]
fn wrong_dimensions_are_refused() {
    for value in ["3 deg", "3 rpm", "3 mm * 1 mm", "3 mm / 1 mm * 1 s", "2 mm/min"] {
        let read = read(&changed("fillet 3 mm", &format!("fillet {value}")));
        assert_eq!(read.codes(), [codes::job::WRONG_DIMENSION], "for {value}");
    }
    assert_eq!(read(&changed("fillet 3 mm", "fillet 3 mm + 1 deg")).codes(), [codes::job::WRONG_DIMENSION]);
    assert_eq!(read(&changed("fillet 3 mm", "fillet 6 mm / 2 mm")).codes(), [codes::job::NO_UNIT]);
}

#[test]
fn tools_of_each_kind_are_read() {
    let with = |tool: &str| {
        let text = changed("operation groove", &format!("tool t4 = {tool}\noperation groove"));
        read(&text).job.unwrap_or_else(|| panic!("{tool} is faulty")).tools.pop().unwrap()
    };
    let size = "flutes 4  flute 20 mm  reach 40 mm";
    assert_eq!(with(&format!("flat {{ diameter 6 mm  {size} }}")).kind, CutterKind::Flat);
    let bull = with(&format!("bull {{ diameter 6 mm  corner 2 mm  {size}  number 12 }}"));
    assert_eq!((bull.kind, bull.number), (CutterKind::Bull(impellerc::base::units::Mm(2.0)), 12));
    let taper = with(&format!("tapered-ball {{ diameter 4 mm  angle 3 deg  {size}  shank 6 mm }}"));
    assert_eq!(
        (taper.kind, taper.shank.get()),
        (CutterKind::TaperedBall(impellerc::base::units::Rad::from_deg(3.0)), 6.0)
    );
    let barrel = with("barrel { diameter 10 mm  barrel 85 mm  tip 2 mm  flutes 4  flute 25 mm  reach 40 mm }");
    let mm = impellerc::base::units::Mm;
    assert_eq!(barrel.kind, CutterKind::Barrel { barrel: mm(85.0), tip: mm(2.0) });
    // Tangent circles: 2 + sqrt(83^2 - 80^2).
    assert!((barrel.kind.least_flute(barrel.diameter).0 - 24.113).abs() < 1e-3);
    let lollipop = with("lollipop { diameter 6 mm  neck 4 mm  flutes 2  reach 40 mm }");
    assert_eq!(lollipop.kind, CutterKind::Lollipop { neck: mm(4.0), neck_end: mm(40.0) });
    // Chord of the neck in the ball: 3 + sqrt(3^2 - 2^2).
    assert!((lollipop.flute.get() - 5.236_068).abs() < 1e-6);
    let lollipop = with("lollipop { diameter 6 mm  neck 4 mm  neck-end 20 mm  flutes 2  reach 40 mm }");
    assert_eq!((lollipop.kind.keyword(), lollipop.shank), ("lollipop", mm(6.0)));
    assert_eq!(lollipop.kind, CutterKind::Lollipop { neck: mm(4.0), neck_end: mm(20.0) });
    let library = with("\"ball-6\"");
    assert_eq!((library.name.as_str(), library.number, library.shank.get()), ("t4", 4, 6.0));
    assert_eq!(library.holder.unwrap().0, "er16-mini");
    assert_eq!(with("\"barrel-10-85\"").kind, CutterKind::Barrel { barrel: mm(85.0), tip: mm(2.0) });
    assert_eq!(with("\"lollipop-6\"").kind, CutterKind::Lollipop { neck: mm(4.0), neck_end: mm(30.0) });
}

/// The main job with other contracts.
fn with_contracts(text: &str) -> String {
    changed("require rest      <= 1 mm\n", &format!("{text}\n"))
}

#[test]
fn contracts_of_each_kind_are_read() {
    let text = with_contracts(
        "let limit = 5 um\n\
         require gouge <= limit on hub, fillet\n\
         require gouge <= 6 um on groove\n\
         require gouge <= 8 um on operation groove\n\
         require clearance tool   >= 0.3 mm\n\
         require clearance shank  >= 0.4 mm on hub\n\
         require clearance holder >= 2 mm on flank, edge\n\
         require air          <= 30 %\n\
         require time         <= 10 h\n\
         require time         <= 90 min on flank, channel\n\
         require axis-speed   <= 80 %\n\
         require contour-error     <= 5 um on flank\n\
         require orientation-error <= 0.02 deg\n\
         require removal-rate <= 2.5 cm3/min on expand\n\
         require engagement <= 90 deg on expand\n\
         require engagement <= 90 deg on expand outside of slots\n\
         require engagement <= 90 deg outside of slots\n\
         require rest         <= 1000 um on operation expand2\n\
         require rest-volume  <= 1.5 cm3\n\
         allow   excess on fillet \"blended by hand\"\n\
         allow   clearance holder on operation channel \"soft holder\"",
    );
    let read = read(&text);
    assert_eq!(read.codes(), [], "{}", render::human(&read.sink, &read.sources, false));
    let job = read.job.unwrap();
    let found: Vec<_> = job.contracts.iter().skip(3).map(|c| (c.kind, c.bound.value(), c.scope.clone())).collect();
    let is = |kind, bound: f64, operations: &[usize], surfaces: &[SurfaceClass]| {
        (
            kind,
            bound,
            impellerc::wheel::contract::Scope { operations: operations.to_vec(), surfaces: surfaces.to_vec() },
        )
    };
    use SurfaceClass::{Edge, Fillet, Hub};
    let expected = [
        is(ContractKind::Gouge, 0.005, &[], &[Fillet, Hub]),
        // All operations of the kind, or the one of the name.
        is(ContractKind::Gouge, 0.006, &[0, 2], &[]),
        is(ContractKind::Gouge, 0.008, &[0], &[]),
        is(ContractKind::Clearance(Guarded::Tool), 0.3, &[], &[]),
        is(ContractKind::Clearance(Guarded::Shank), 0.4, &[], &[Hub]),
        is(ContractKind::Clearance(Guarded::Holder), 2.0, &[4], &[Edge]),
        is(ContractKind::Air, 0.3, &[], &[]),
        is(ContractKind::Time, 36000.0, &[], &[]),
        is(ContractKind::Time, 5400.0, &[4, 5], &[]),
        is(ContractKind::AxisSpeed, 0.8, &[], &[]),
        is(ContractKind::ContourError, 0.005, &[4], &[]),
        is(ContractKind::OrientationError, 0.02, &[], &[]),
        is(ContractKind::RemovalRate, 2500.0, &[1, 3], &[]),
        is(ContractKind::Engagement(Cuts::All), 90.0, &[1, 3], &[]),
        is(ContractKind::Engagement(Cuts::OutsideSlots), 90.0, &[1, 3], &[]),
        is(ContractKind::Engagement(Cuts::OutsideSlots), 90.0, &[], &[]),
        is(ContractKind::Rest, 1.0, &[3], &[]),
        is(ContractKind::RestVolume, 1500.0, &[], &[]),
    ];
    assert_eq!(found, expected);
    assert_eq!(job.allowed[0].reason, "blended by hand");
    assert_eq!(
        (job.allowed[1].kind, job.allowed[1].scope.operations.as_slice()),
        (ContractKind::Clearance(Guarded::Holder), &[5][..])
    );
    // Planning keeps the strictest of them everywhere; a rapid is no matter of planning clearance.
    assert_eq!(job.clearance.get(), 2.0);
    let printed = job::print::print(&job);
    for line in [
        "require gouge <= 0.005 mm on fillet, hub",
        "require gouge <= 0.006 mm on operation groove, operation groove2",
        "require air <= 30 %",
        "require time <= 5400 s on operation flank, operation channel",
        "require contour-error <= 0.005 mm on operation flank",
        "require orientation-error <= 0.02 deg",
        "require removal-rate <= 2500 mm3/min on operation expand, operation expand2",
        "require rest-volume <= 1500 mm3",
        "allow clearance holder on operation channel \"soft holder\"",
    ] {
        assert!(printed.contains(line), "{line} is not in\n{printed}");
    }
}

/// What `--emit job` prints of contracts is itself read, and means the same.
#[test]
fn printed_contracts_read_back() {
    let text = with_contracts(
        "require clearance holder >= 2 mm on flank\nrequire rest-volume <= 0.1 cm3\nrequire time <= 3 h on channel\n\
         require orientation-error <= 0.007 deg\nrequire contour-error <= 3 um on channel\n\
         allow gouge on hub, operation groove \"left for later\"",
    );
    let first = read(&text).job.unwrap();
    let printed = job::print::print(&first);
    let lines: Vec<&str> =
        printed.lines().filter(|l| l.starts_with("require") || l.starts_with("allow")).skip(3).collect();
    let second = read(&with_contracts(&lines.join("\n"))).job.unwrap();
    let plain = |job: &Job| -> Vec<_> { job.contracts.iter().map(|c| (c.kind, c.bound, c.scope.clone())).collect() };
    assert_eq!(plain(&first), plain(&second));
    assert_eq!(first.allowed[0].scope, second.allowed[0].scope);
}

#[test]
fn the_clamping_is_read_and_has_a_default() {
    let with = |text: &str| changed("back -40 mm }", &format!("back -40 mm  {text} }}"));
    let of = |text: &str| {
        let clamping = read(&with(text)).job.unwrap_or_else(|| panic!("{text} is faulty")).stock.clamping;
        (clamping.below.get(), clamping.diameter.map(|d| d.get()), clamping.span.is_some())
    };
    assert_eq!(of(""), (-40.0, None, false));
    assert_eq!(of("clamping { below -42 mm }"), (-42.0, None, true));
    assert_eq!(of("clamping { diameter 60 mm }"), (-40.0, Some(60.0), true));
    assert_eq!(of("clamping { diameter 2.5 in  below -41 mm - 1 mm }"), (-42.0, Some(63.5), true));
    for (wrong, code) in [
        ("clamping 60 mm", codes::job::WRONG_FORM),
        ("clamping { diameter -60 mm }", codes::job::OUT_OF_RANGE),
        ("clamping { diameter 0 mm }", codes::job::OUT_OF_RANGE),
        ("clamping { below 42 deg }", codes::job::WRONG_DIMENSION),
        ("clamping { height 42 mm }", codes::job::UNKNOWN_PROPERTY),
        ("clamping { below -42 mm }  clamping { below -43 mm }", codes::job::GIVEN_TWICE),
    ] {
        assert_eq!(read(&with(wrong)).codes(), [code], "for {wrong}");
    }
}

#[test]
fn lengths_below_zero_are_out_of_range_wherever_they_stand() {
    let wrong = [
        ("scallop 12 um", "scallop 12 um  rest over -0.05 mm", "-0.05 mm"),
        ("scallop 12 um", "scallop 12 um  rest over - 50 um", "- 50 um"),
        ("scallop 12 um", "scallop 12 um  rest over -(0.1 mm + 0.2 mm)", "-(0.1 mm + 0.2 mm)"),
        ("scallop 12 um", "scallop 12 um  rest over 0.1 mm - 0.2 mm", "0.1 mm - 0.2 mm"),
        ("scallop 12 um", "scallop 12 um  rest over 0.1 mm - (0.2 mm) // too thick", "0.1 mm - (0.2 mm)"),
        ("scallop 12 um", "scallop 12 um  rest over -vane_allowance", "-vane_allowance"),
        ("scallop 12 um", "scallop -12 um", "-12 um"),
        ("lead-in 12 mm", "lead-in -12 mm", "-12 mm"),
        ("lead-out 12 mm", "lead-out -12 mm", "-12 mm"),
        ("residual 1 mm", "residual -1 mm", "-1 mm"),
        ("depth 1.5 mm", "depth -1.5 mm", "-1.5 mm"),
        ("allowance vane vane_allowance", "allowance vane -vane_allowance", "-vane_allowance"),
        ("hub hub_allowance", "hub -0.1 mm", "-0.1 mm"),
        ("fillet 3 mm", "fillet -3 mm", "-3 mm"),
        ("over shroud 0 mm", "over shroud -1 mm", "-1 mm"),
        ("bore 10 mm", "bore -10 mm", "-10 mm"),
        ("diameter 8 mm", "diameter -8 mm", "-8 mm"),
        ("flute 30 mm", "flute -30 mm", "-30 mm"),
        ("reach 50 mm", "reach -50 mm", "-50 mm"),
        ("reach 50 mm", "reach 50 mm  shank -8 mm", "-8 mm"),
        ("chord 0.25 um", "chord -1 um", "-1 um"),
        ("rough 50 um", "rough -50 um", "-50 um"),
        ("require gouge     <= 1 um", "require gouge <= -1 um", "-1 um"),
        ("require clearance >= 0.5 mm", "require clearance >= -0.5 mm", "-0.5 mm"),
    ];
    for (right, wrong, place) in wrong {
        let text = changed(right, wrong);
        let read = read(&text);
        assert_eq!(read.codes(), [codes::job::OUT_OF_RANGE], "for {wrong}");
        let diag = &read.sink.diags()[0];
        assert_eq!(&text[diag.labels[0].span.range()], place, "for {wrong}");
        assert!(diag.message.contains(" must be ") && diag.help.is_some(), "{} for {wrong}", diag.message);
    }
    // A name behind the label is its value; no value is a wrong form, with the label that is due.
    let job = read(&changed("scallop 12 um", "scallop 12 um  rest over vane_allowance")).job.unwrap();
    assert_eq!(job.operations[5].rest.map(|r| r.get()), Some(0.2));
    for wrong in ["rest over", "rest 0.05 mm", "rest -0.05 mm"] {
        let read = read(&changed("scallop 12 um", &format!("scallop 12 um  {wrong}")));
        assert_eq!(read.codes(), [codes::job::WRONG_FORM], "for {wrong}");
        assert!(read.sink.diags()[0].message.contains("(over)"), "{}", read.sink.diags()[0].message);
    }
}

#[test]
fn contracts_that_contradict_themselves_are_refused() {
    for (text, code) in [
        ("require gouge <= 5 um on hub\nrequire gouge <= 6 um on hub", codes::job::GIVEN_TWICE),
        ("require gouge <= 5 um on hub, fillet\nrequire gouge <= 6 um on fillet, hub", codes::job::GIVEN_TWICE),
        ("require air <= 0.3 mm", codes::job::WRONG_DIMENSION),
        ("require time <= 3", codes::job::NO_UNIT),
        ("require axis-speed <= 120 %", codes::job::OUT_OF_RANGE),
        ("require contour-error <= 1 deg", codes::job::WRONG_DIMENSION),
        ("require contour-error <= 5 um on hub", codes::job::WRONG_FORM),
        ("require orientation-error <= 0.01", codes::job::NO_UNIT),
        ("require orientation-error <= 91 deg", codes::job::OUT_OF_RANGE),
        ("require orientation-error >= 1 deg", codes::job::RELATION),
        ("require rest-volume >= 1 mm3", codes::job::RELATION),
        ("require gouge tool <= 1 um", codes::job::UNKNOWN_NAME),
        ("require rest <= 1 mm on flank", codes::job::WRONG_FORM),
        ("allow time on hub \"x\"", codes::job::WRONG_FORM),
        ("allow rest-volume on groove \"x\"", codes::job::WRONG_FORM),
        ("allow gouge \"x\"", codes::job::WRONG_FORM),
        ("allow gouge on hub", codes::syntax::UNEXPECTED),
        ("require gouge on hub <= 1 um", codes::syntax::UNEXPECTED),
        (
            "require time <= 1 h on flank, channel\nallow time on flank \"x\"\nallow time on channel \"y\"",
            codes::job::NOTHING_LEFT,
        ),
    ] {
        let read = read(&with_contracts(text));
        assert_eq!(read.codes(), [code], "for {text}");
    }
}

#[test]
fn what_is_not_built_is_refused_by_name() {
    for (right, wrong, exists) in [
        (
            "operation channel",
            "operation splitter",
            "rough, plunge, groove, expand, flank, point, fillet, edge, tip, channel",
        ),
        ("stock turned", "stock casting", "turned"),
        ("pressure ruled", "pressure swept", "ruled, lofted"),
        ("use tools  ", "use import ", "machine, tools"),
    ] {
        let read = read(&changed(right, wrong));
        let diag = &read.sink.diags()[0];
        assert_eq!(diag.code, codes::job::NOT_IN_LANGUAGE, "for {wrong}");
        assert!(diag.help.as_ref().unwrap().contains(exists), "{:?} for {wrong}", diag.help);
    }
}

#[test]
fn an_open_block_does_not_swallow_the_next_item() {
    let text =
        changed("scallop 12 um\n  lead-in 8 mm  lead-out 8 mm\n}", "scallop 12 um\n  lead-in 8 mm  lead-out 8 mm\n");
    let read = read(&text);
    assert_eq!(read.codes(), [codes::syntax::BRACKET_OPEN]);
}

#[test]
fn json_has_lines_columns_and_the_fix() {
    let read = read(&changed("fillet 3 mm", "fillet 3"));
    let text = render::json(&read.sink, &read.sources);
    let value: serde_json::Value = serde_json::from_str(text.trim_end()).unwrap();
    let line = JOB.lines().position(|l| l.contains("fillet 3 mm")).unwrap() + 1;
    assert_eq!(value["code"], "IMP0206");
    assert_eq!(value["severity"], "error");
    assert_eq!(value["labels"][0]["line"], line);
    assert_eq!(value["labels"][0]["column"], 12);
    assert_eq!(value["labels"][0]["file"], "job.imp");
    assert_eq!(value["fix"]["replacement"], " mm");
    assert_eq!(value["fix"]["start"], value["fix"]["end"]);
}

/// Everything that a text goes through, printed as well.
fn survive(text: &str) {
    let mut sink = Sink::default();
    let ast = syntax::parse(text, SourceId(0), &mut sink);
    let _ = syntax::print::print(&ast);
    let read = read(text);
    if let Some(job) = &read.job {
        let _ = job::print::print(job);
        let mut sink = Sink::default();
        let _ = impellerc::lower::lower(job, &mut sink);
    } else {
        assert!(read.sink.has_errors(), "no job and no error");
    }
    let _ = render::json(&read.sink, &read.sources);
    // The human form is slow; a few diagnostics show its ways of failing as well as many.
    if read.sink.diags().len() < 5 {
        let _ = render::human(&read.sink, &read.sources, false);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_text_makes_the_reader_panic(text in any::<String>()) {
        survive(&text);
    }

    #[test]
    fn no_words_make_the_reader_panic(
        words in prop::collection::vec(
            prop::sample::select(vec![
                "let", "part", "tool", "operation", "groove", "post", "use", "machine", "x", "t1", "vane", "hub",
                "require", "allow", "on", "gouge", "spline", "from", "curve", "revolve", "ruled", "{", "}", "(", ")", "[", "]", "=", "<=", ",", "+", "-",
                "*", "/", "3", "0.5", "1e999", "mm", "rpm", "%", "\"", "\"a\"", "//", "\n", "\n", "é",
            ]),
            0..60,
        )
    ) {
        survive(&words.join(" "));
    }

    /// A piece of a valid job is cut out, doubled, or replaced.
    #[test]
    fn no_change_of_a_job_makes_the_reader_panic(
        at in 0..REDUCED.len(),
        length in 0_usize..40,
        patch in prop::sample::select(vec!["", " ", "{", "}", "\"", "0", "-1", "1e300", "mm", "9999999999", "\n", "x"]),
    ) {
        let mut text = REDUCED.as_bytes().to_vec();
        let end = (at + length).min(text.len());
        text.splice(at..end, patch.bytes());
        survive(&String::from_utf8_lossy(&text));
    }
}
