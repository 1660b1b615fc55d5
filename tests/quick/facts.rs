//! Facts about the paper's impeller, and the reach of the tools of a job in it.

use crate::support;
use impellerc::base::entity::PrimaryMap;
use impellerc::base::progress::Progress;
use impellerc::base::source::{SourceId, Span};
use impellerc::base::units::Mm;
use impellerc::diagnostics::{Diag, Severity, Sink};
use impellerc::driver::{Options, Stages, compile};
use impellerc::ir::{Allowances, Contract, ContractKind, OperationKind, Program, RoughingStrategy};
use impellerc::nurbs::NurbsCurve;
use impellerc::nurbs::proximity::Patch;
use impellerc::plan::facts::free_space::{self, FreeSpace};
use impellerc::plan::facts::reach::{self, Reach};
use impellerc::plan::facts::{self, outliers, throat, twist};
use impellerc::tool_stock::collide::Cutter;
use impellerc::wheel::method::{AxisMethod, Lines};
use impellerc::wheel::operation::VaneAllowance;
use impellerc::wheel::part::{BladeId, FaceId, Guides, Part, RulingEnd, Surface, SurfaceKind};
use nalgebra::Point3;
use support::{operation, tool, wei_data, wei_part, wei_program};

fn check(program: &Program) -> Vec<Diag> {
    let mut sink = Sink::default();
    facts::check_with_fits(program, &Progress::default(), &mut sink);
    sink.diags().to_vec()
}

/// Reach of the tool of each operation that goes down to the floor.
fn reaches(program: &Program) -> Vec<Reach> {
    reach::check(program, &throat::all(&program.part, &program.data), &mut Sink::default())
}

/// Largest tool of the kind of the first operation that goes down to the floor.
fn largest(program: &Program) -> f64 {
    let throats = throat::all(&program.part, &program.data);
    reach::largest(program, &throats, &reaches(program)[0])
}

/// Free space for the tool of each operation that point mills faces or fillets.
fn free_spaces(program: &Program) -> Vec<FreeSpace> {
    free_space::check(program, &mut Sink::default())
}

/// The paper's part, roughed with one cutter after the other, finished with a ball of 6 mm.
fn program(fillet: Option<f64>, roughers: &[Cutter]) -> Program {
    let mut program = wei_program(&[0]);
    program.part = wei_part(fillet);
    (program.tools, program.operations) = (PrimaryMap::new(), PrimaryMap::new());
    let span = |at: usize| Span::new(SourceId(0), at..at + 1);
    let mut add = |cutter, kind: OperationKind, at: usize| {
        let mut t = tool("t", 1, cutter, 30.0, 45.0);
        t.span = span(100 + at);
        let id = program.tools.push(t);
        let mut o = operation(kind.keyword(), kind, id, vec![0], 10.0);
        o.span = span(200 + at);
        program.operations.push(o);
    };
    for (i, cutter) in roughers.iter().enumerate() {
        let allowances = Allowances { vane: VaneAllowance::even(Mm(0.2)), hub: Mm(0.5) };
        let strategy = RoughingStrategy::Groove { depth: Mm(1.5) };
        add(*cutter, OperationKind::Roughing { allowances, strategy }, i);
    }
    add(Cutter::ball(3.0), support::channel(0.012), 50);
    program
}

fn errors(diags: &[Diag]) -> Vec<&Diag> {
    diags.iter().filter(|d| d.severity == Severity::Error).collect()
}

#[test]
fn narrowest_place_is_at_the_hub_near_the_inlet() {
    let part = wei_part(None);
    let throat = throat::measure(&part, &part.first_passage(), &wei_data());
    let narrow = throat.narrowest;
    // scipy 1.17.1, `minimize` over u and v of both faces, L-BFGS-B from 24 starts.
    assert!((narrow.distance - 8.983_082_269).abs() < 1e-8, "{narrow:?}");
    assert!((narrow.u - 0.083_698_52).abs() < 1e-5 && narrow.v == 0.0, "{narrow:?}");
    assert_eq!(narrow.place(), "pressure root at u = 0.084");
    // Distances of 201 points to a 401 x 81 grid of the neighbour, numpy: minimum, inlet, outlet of hub, mid, tip. The
    // grid's points lie up to 0.1 mm beside the foot, which adds less than 0.01 mm to these.
    let reference = [[8.98, 10.19, 36.36], [15.46, 18.24, 35.12], [19.22, 27.27, 32.36]];
    let (opposite, turn) = part.opposite(FaceId::PRESSURE);
    let facing = part.face(opposite).surface.rotated(turn);
    let width = |u: f64, v: f64| {
        let p = part.face(FaceId::PRESSURE).surface.point(u, v);
        facing.closest(&p, Patch::WHOLE).distance
    };
    for (v, [least, inlet, outlet]) in [0.0, 0.5, 1.0].into_iter().zip(reference) {
        let values: Vec<_> = (0..=80).map(|i| width(f64::from(i) / 80.0, v)).collect();
        assert!((values.iter().copied().fold(f64::INFINITY, f64::min) - least).abs() < 0.01);
        assert!((values[0] - inlet).abs() < 0.01 && (values[80] - outlet).abs() < 0.01);
    }
    // 2 pi 16.9382 / 8 - 2.9525, from the first row of table 2.
    assert!((throat.formula_8 - 10.35).abs() < 0.005, "{}", throat.formula_8);
}

#[test]
fn faces_twist_as_known() {
    let part = wei_part(None);
    let [p, s] = BladeId::MAIN.faces().map(|face| twist::measure(&part, face));
    // scipy 1.17.1 on 401 rulings, mean by the trapezoidal rule.
    for (twist, [largest, at, mean]) in [
        (p, [32.757_131_801_100_47, 0.3925, 17.628_306_361_766_903]),
        (s, [26.475_667_180_864_473, 0.1775, 17.984_470_558_289_75]),
    ] {
        assert!((twist.largest.to_degrees() - largest).abs() < 1e-9 && (twist.at - at).abs() < 1e-12);
        assert!((twist.mean.to_degrees() - mean).abs() < 1e-9);
    }
    assert!((p.ruling[0] - 8.0288).abs() < 1e-3 && (s.ruling[1] - 26.5294).abs() < 1e-3);
    let diags = check(&program(None, &[Cutter::flat(4.0)]));
    assert!(errors(&diags).is_empty(), "{diags:?}");
}

#[test]
fn the_misprint_of_table_1_is_found_and_nothing_else() {
    let found = outliers::find(&wei_data());
    assert_eq!(found.len(), 1, "{found:?}");
    let o = found[0];
    assert_eq!((o.side, o.end, o.row), (FaceId::PRESSURE, RulingEnd::Tip, 3));
    assert!((o.value.to_degrees() - 4.0437).abs() < 1e-3 && (o.expected.to_degrees() - 3.0).abs() < 1e-3);
    // The radius of the row is kept, and the angle of the others.
    assert!((o.suggestion.x.hypot(o.suggestion.y) - 43.9576).abs() < 1e-9 && o.suggestion.x > 0.7);
    // With the suggestion in its place, nothing is left.
    let mut data = wei_data();
    let curve = data.iter_mut().find(|c| c.side == o.side && c.end == o.end).unwrap();
    curve.points[3].point = o.suggestion;
    assert!(outliers::find(&data).is_empty(), "{:?}", outliers::find(&data));
}

#[test]
fn a_misprint_anywhere_in_a_smooth_table_is_found_where_it_is() {
    let mut clean = wei_data();
    clean.iter_mut().find(|c| c.side == FaceId::PRESSURE && c.end == RulingEnd::Tip).unwrap().points[3].point =
        outliers::find(&wei_data())[0].suggestion;
    for (side, row) in [(FaceId::PRESSURE, 1), (FaceId::SUCTION, 2), (FaceId::SUCTION, 5), (FaceId::PRESSURE, 4)] {
        let mut data = clean.clone();
        let curve = data.iter_mut().find(|c| c.side == side && c.end == RulingEnd::Tip).unwrap();
        curve.points[row].point.z += 2.0;
        let found = outliers::find(&data);
        assert_eq!(found.len(), 1, "{side:?} {row}: {found:?}");
        assert_eq!((found[0].side, found[0].row), (side, row));
    }
}

#[test]
fn the_warning_stands_under_the_point() {
    let mut program = program(None, &[Cutter::flat(4.0)]);
    let span = Span::new(SourceId(0), 7..9);
    program.data.iter_mut().find(|c| c.side == FaceId::PRESSURE && c.end == RulingEnd::Tip).unwrap().points[3].span =
        Some(span);
    let diags = check(&program);
    let warning = diags.iter().find(|d| d.severity == Severity::Warning).unwrap();
    assert_eq!(warning.code.id(), "IMP0350");
    assert_eq!(warning.labels[0].span, span);
    assert!(warning.notes[0].contains("4.04 deg") && warning.notes[0].contains("3.00 deg"), "{warning:?}");
}

#[test]
fn the_rougher_of_the_paper_does_not_fit() {
    let job = program(None, &[Cutter::flat(5.0)]);
    let (found, diags) = (reaches(&job), check(&job));
    let errors = errors(&diags);
    assert_eq!(errors.len(), 1, "{errors:?}");
    let e = errors[0];
    assert_eq!(e.code.id(), "IMP0450");
    assert!(e.message.contains("10 mm flat") && e.message.contains("8.98 mm"), "{}", e.message);
    assert!(e.notes.iter().any(|n| n.contains("0.2 mm from both vanes")));
    assert!(e.notes.iter().any(|n| n.contains("10.35 mm")));
    assert_eq!(e.labels[0].span.start, 100, "the tool's declaration comes first");
    assert_eq!(e.place.as_ref().unwrap().what, "pressure root at u = 0.084");
    // scipy: points 0.5 mm over the hub on both faces are 9.2945 mm apart at the narrowest; 0.2 mm off each is 8.8945.
    // Offsets square to leaning walls make 2 um of difference.
    assert!((found[0].free_width.unwrap().width - 8.8945).abs() < 0.005, "{:?}", found[0]);
    let largest = largest(&job);
    assert!((largest - 8.89).abs() < 0.011);
    assert!(e.help.as_ref().unwrap().contains(&format!("{largest:.2} mm")), "{e:?}");
}

/// A tool of the largest diameter fits, one a little larger does not.
#[test]
fn the_largest_tool_is_the_border() {
    for fillet in [None, Some(3.0)] {
        for make in [
            (|radius| Cutter::flat(radius)) as fn(f64) -> Cutter,
            |radius| Cutter::ball(radius),
            |radius| Cutter::bull(radius, 1.5),
        ] {
            let largest = largest(&program(fillet, &[make(5.0)]));
            let fits = |diameter: f64| reaches(&program(fillet, &[make(diameter / 2.0)]))[0].fits;
            assert!(fits(largest) && !fits(largest + 0.02), "{fillet:?} {:?} {largest}", make(largest));
        }
    }
}

/// A straight channel, 20 mm wide between parallel walls on a hub so large that it is flat to a micrometre.
fn straight_part(fillet: Option<f64>) -> Part {
    let (half, hub, count) = (10.0f64, 20_000.0f64, 4000u32);
    let pitch = std::f64::consts::TAU / f64::from(count);
    let foot = (hub * hub - half * half).sqrt();
    let line = |x: f64, y: f64, turn: f64| {
        let at = |z: f64| Point3::new(x, y, z);
        NurbsCurve::try_new(1, vec![0.0, 0.0, 1.0, 1.0], &[at(0.0), at(-60.0)], None).unwrap().rotated(turn)
    };
    let wall = |x: f64, turn: f64| Guides { root: line(x, foot, turn), tip: line(x, foot + 30.0, turn) };
    // The wall ahead belongs to vane 1.
    let (near, ahead) = (wall(half, 0.0), wall(-half, -pitch));
    let (root, tip) = (near.root.clone(), near.tip.clone());
    Part::new(count, ahead, near, root, tip, fillet.map(Mm))
}

#[test]
fn room_in_a_straight_channel_is_exact() {
    let room = |fillet, cutter| {
        let mut program = program(None, &[cutter]);
        program.part = straight_part(fillet);
        program.data = Vec::new();
        let reach = reaches(&program)[0];
        (reach.free_width.unwrap().width, largest(&program))
    };
    let flat = Cutter::flat(5.0);
    let bull = Cutter::bull(5.0, 1.0);
    // Sharp corners: the walls less 0.2 mm and the corner radius on both sides.
    for (cutter, expected, largest) in [(flat, 19.6, 19.6), (bull, 17.6, 19.6)] {
        let (width, most) = room(None, cutter);
        assert!((width - expected).abs() < 2e-3 && (most - largest).abs() < 0.02, "{width} {most}");
    }
    // Fillets of 3 mm: the hollow's centre is 7 mm from the middle, 3 mm high. The corner's centre, 0.5 mm plus its
    // radius over the hub, stays 2.8 mm less its radius away from it.
    let chord = |corner: f64| ((2.8 - corner).powi(2) - (2.5 - corner).powi(2)).sqrt();
    for (cutter, corner) in [(flat, 0.0), (bull, 1.0)] {
        let (width, most) = room(Some(3.0), cutter);
        let expected = 2.0 * (7.0 + chord(corner));
        assert!((width - expected).abs() < 2e-3, "{width} {expected}");
        assert!((most - expected - 2.0 * corner).abs() < 0.02, "{most}");
    }
    // A corner rounder than the hollow less the allowance touches walls, not fillets.
    let (width, _) = room(Some(3.0), Cutter::bull(5.0, 2.9));
    assert!((width - 2.0 * (10.0 - 0.2 - 2.9)).abs() < 2e-3, "{width}");
}

#[test]
fn a_fillet_narrows_the_floor_for_a_flat_tool() {
    let flat = Cutter::flat(4.0);
    assert!(errors(&check(&program(None, &[flat]))).is_empty());
    let job = program(Some(3.0), &[flat]);
    let (found, diags) = (reaches(&job), check(&job));
    assert!(!found[0].fits && found[0].fits_top);
    assert_eq!(errors(&diags).len(), 1);
    // A ball that goes deeper afterwards makes it a job.
    let job = program(Some(3.0), &[flat, Cutter::ball(3.0)]);
    let (found, diags) = (reaches(&job), check(&job));
    assert!(!found[0].fits && found[1].fits);
    assert!(errors(&diags).is_empty(), "{diags:?}");
}

#[test]
fn what_the_finishers_may_meet_counts() {
    let flat = Cutter::flat(4.0);
    let mut program = program(Some(3.0), &[flat]);
    let rest = |bound| Contract::whole(ContractKind::Rest, bound);
    program.contracts = vec![rest(0.6)];
    assert_eq!(errors(&check(&program)).len(), 1, "8 mm does not stand 0.6 mm over the hub between the fillets");
    program.contracts = vec![rest(3.5)];
    assert!(errors(&check(&program)).is_empty(), "over the fillets it does");
}

#[test]
fn a_tool_thicker_than_the_mouth_is_refused_though_another_reaches_the_floor() {
    let job = program(None, &[Cutter::flat(11.0), Cutter::flat(4.0)]);
    let (found, diags) = (reaches(&job), check(&job));
    assert!(!found[0].fits_top && found[1].fits);
    assert_eq!(errors(&diags).len(), 1);
    assert!(errors(&diags)[0].message.contains("22 mm flat"));
}

#[test]
fn a_finisher_that_does_not_fit_is_an_error() {
    let mut program = program(None, &[Cutter::flat(4.0)]);
    let big = program.tools.push(tool("big", 9, Cutter::ball(7.0), 30.0, 45.0));
    program.operations.push(operation("channel2", support::channel(0.01), big, vec![0], 8.0));
    let diags = check(&program);
    assert_eq!(errors(&diags).len(), 1, "{diags:?}");
    assert!(errors(&diags)[0].message.contains("14 mm ball"));
}

const FACES: [SurfaceKind; 2] = [SurfaceKind::Face(FaceId::PRESSURE), SurfaceKind::Face(FaceId::SUCTION)];
const FILLETS: [SurfaceKind; 2] = [SurfaceKind::Fillet(FaceId::PRESSURE), SurfaceKind::Fillet(FaceId::SUCTION)];

/// What is said of point milling some surfaces of a part with a cutter.
fn pointed(part: &Part, cutter: Cutter, surfaces: &[SurfaceKind]) -> (Vec<FreeSpace>, Vec<Diag>) {
    let mut program = program(None, &[]);
    program.part = part.clone();
    (program.tools, program.operations) = (PrimaryMap::new(), PrimaryMap::new());
    let id = program.tools.push(tool("t", 1, cutter, 30.0, 45.0));
    let kind = OperationKind::Point {
        surfaces: surfaces.to_vec(),
        scallop: Mm(0.01),
        lines: Lines::Zigzag,
        milling: None,
        levels: None,
        method: AxisMethod::Blend,
    };
    program.operations.push(operation(kind.keyword(), kind, id, vec![0], 8.0));
    (free_spaces(&program), check(&program))
}

#[test]
fn point_milling_asks_for_no_floor() {
    // Fillets that meet in the middle of the channel: balls that finish the floor have no room there at all.
    let part = wei_part(Some(7.0));
    let diags = check(&program(Some(7.0), &[]));
    let [told] = &errors(&diags)[..] else { panic!("{diags:?}") };
    assert!(
        told.message.contains("do not fit between the vanes") && told.notes[0].contains("their number"),
        "{told:?}"
    );
    for surfaces in [FACES, FILLETS] {
        let (space, diags) = pointed(&part, Cutter::ball(3.0), &surfaces);
        assert!(space[0].fits && errors(&diags).is_empty(), "{diags:?}");
    }
    // Nor does a corner of a wide bull nose care, or anything that stands before an edge.
    let bull = Cutter::bull(5.0, 1.0);
    assert!(errors(&pointed(&wei_part(Some(3.0)), bull, &FACES).1).is_empty());
    let edges = [SurfaceKind::InletEdge(BladeId::MAIN), SurfaceKind::OutletEdge(BladeId::MAIN)];
    let (space, diags) = pointed(&part, Cutter::ball(20.0), &edges);
    assert!(space.is_empty() && errors(&diags).is_empty(), "{diags:?}");
}

#[test]
fn a_ball_that_meets_the_next_vane_is_told() {
    // Between parallel walls 20 mm apart a ball of 10 mm touches both; none is bigger than the fillet that it goes down to.
    for (fillet, surfaces, expected) in [(None, FACES, 10.0), (Some(3.0), FACES, 3.0), (Some(3.0), FILLETS, 3.0)] {
        let largest = pointed(&straight_part(fillet), Cutter::ball(2.0), &surfaces).0[0].largest;
        assert!((largest - expected).abs() < 0.011, "{fillet:?} {largest}");
    }
    // On the paper's part the largest is the border, by another search: over all points of the next face.
    let part = wei_part(None);
    let ball = |radius: f64| pointed(&part, Cutter::ball(radius), &FACES);
    let (space, diags) = ball(9.0);
    let told = errors(&diags);
    assert!(told.len() == 1 && !space[0].fits, "{diags:?}");
    assert!(told[0].code.id() == "IMP0450" && told[0].place.as_ref().unwrap().what.contains("vane 1"), "{:?}", told[0]);
    let largest = space[0].largest;
    assert!(told[0].help.as_ref().unwrap().contains(&format!("{largest} mm")), "{:?}", told[0]);
    assert!(ball(largest).0[0].fits && !ball(largest + 0.02).0[0].fits, "{largest}");
    let face = |side: FaceId| part.face(side);
    let turn = if part.first_passage().walls[0] == FaceId::PRESSURE { part.pitch() } else { -part.pitch() };
    let next = face(FaceId::SUCTION).surface.rotated(turn);
    let points: Vec<Point3<f64>> = (0..=300)
        .flat_map(|i| (0..=100).map(move |j| [f64::from(i) / 300.0, f64::from(j) / 100.0]))
        .map(|[u, v]| next.point(u, v))
        .collect();
    let mut least = f64::INFINITY;
    for i in 0..=60 {
        let u = f64::from(i) / 60.0;
        for j in 0..=8 {
            let v = f64::from(j) / 8.0;
            let (p, n) = (face(FaceId::PRESSURE).surface.point(u, v), face(FaceId::PRESSURE).normal(u, v));
            // The ball through a point of the next face; balls that cut into the hub are none.
            let room = points.iter().map(|q| (q - p).norm_squared() / (2.0 * (q - p).dot(&n)));
            let room = room.filter(|r| *r > 0.0).fold(f64::INFINITY, f64::min);
            if part.hub.distance(&(p + n * largest)) > largest {
                least = least.min(room);
            }
        }
    }
    println!("{largest} {least}");
    assert!(least > largest - 0.01 && least < largest + 0.5, "{largest} {least}");
}

/// The job as the paper has it: one error, told under the tool, and nothing written.
#[test]
fn the_published_job_fails_with_this_message() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("part.nc");
    let options = Options {
        job: concat!(env!("CARGO_MANIFEST_DIR"), "/jobs/wei2021/as-published.imp").into(),
        output: Some(output.clone()),
        ..Options::default()
    };
    let outcome = compile(&options, &mut Stages::default());
    let errors = errors(outcome.sink.diags());
    assert_eq!(errors.len(), 1, "{errors:?}");
    let e = errors[0];
    let text = |span: Span| outcome.sources.get(span.source).unwrap().text[span.range()].to_owned();
    let mut lines = vec![format!("{} {}", e.code, e.message)];
    lines.extend(e.labels.iter().map(|l| format!("{}: {}", text(l.span), l.text)));
    lines.extend(e.notes.iter().cloned());
    lines.extend(e.help.clone());
    lines.extend(e.place.as_ref().map(|p| p.what.clone()));
    let expected = [
        "IMP0450 the 10 mm flat tool is too large to reach the hub: \
         the throat of the channel is 8.98 mm",
        "tool t1: 10 mm in diameter",
        "operation groove: `groove` uses `t1`",
        "operation expand: `expand` uses `t1`",
        "the tool must keep a distance of 0.2 mm from both vanes and 0.5 mm from the hub",
        "at that height 8.90 mm are free between the vanes after subtraction of the allowances",
        "formula 8 of Wei 2021 measures arcs and gives 10.35 mm",
        "use a flat tool of at most 8.89 mm",
        "pressure root at u = 0.084",
    ];
    assert_eq!(lines, expected);
    assert!(!output.exists());
}
