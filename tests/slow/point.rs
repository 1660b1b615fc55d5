//! Point milling of vane faces and fillets: the certificate proves the remaining excess, and its verifier does not use
//! lines and scallops.

use crate::support::{
    self,
    jobs::{self, Compiled},
};
use impellerc::base::entity::PrimaryMap;
use impellerc::base::units::Mm;
use impellerc::diagnostics::Sink;
use impellerc::ir::{ClPoint, Contract, ContractKind, Operation, OperationKind, Program};
use impellerc::plan::passes::pipeline::{self, Plan};
use impellerc::tool_stock::collide::Cutter;
use impellerc::verify::{certify, verify};
use impellerc::wheel::control::PathForm;
use impellerc::wheel::method::{AxisMethod, Lines, Milling};
use impellerc::wheel::part::chart::{self, Shape};
use impellerc::wheel::part::{BladeId, FaceId, SurfaceKind};
use nalgebra::Point3;

/// The paper's part with point milling of some surfaces of one vane.
fn program(cutter: Cutter, surfaces: Vec<SurfaceKind>, scallop: f64, method: AxisMethod) -> Program {
    let mut program = support::wei_program(&[0]);
    (program.tools, program.operations) = (PrimaryMap::new(), PrimaryMap::new());
    let tool = program.tools.push(support::tool("t1", 1, cutter, 30.0, 50.0));
    let kind = OperationKind::Point {
        surfaces,
        scallop: Mm(scallop),
        lines: Lines::Zigzag,
        milling: None,
        levels: None,
        method,
    };
    program.operations.push(support::operation("point", kind, tool, vec![0], 8.0));
    program.tolerances.chord = Mm(0.0005);
    // For its sake the proof goes on until it is as fine as that.
    program.contracts.push(Contract::whole(ContractKind::Excess, scallop));
    program.contracts.push(Contract::whole(ContractKind::Gouge, 0.001));
    program
}

/// What a run left, mm.
struct Left {
    /// Gouge over everything and excess on the named surfaces of vane 1, both proved.
    gouge: f64,
    excess: Vec<f64>,
    /// Lengths of contact, told and least.
    lengths: [f64; 2],
    /// Passes of the first operation.
    passes: usize,
}

fn run(program: &Program, surfaces: &[&str]) -> Left {
    let mut sink = Sink::default();
    let start = std::time::Instant::now();
    let plan = pipeline::run(program, &mut sink)
        .unwrap_or_else(|_| panic!("{:?}", sink.diags().iter().map(|d| (&d.message, &d.place)).collect::<Vec<_>>()));
    println!("planned in {:?}", start.elapsed());
    for note in &plan.cl.operations[0].notes {
        println!("{note}");
    }
    stands_on_its_contacts(program, &plan);
    let certificate = certify(program, &plan.motion, &mut sink);
    for d in sink.diags() {
        println!("{} {} {:?}", d.code, d.message, d.place);
    }
    let certificate = certificate.expect("a certificate");
    let gouge = certificate.surfaces.iter().map(|s| s.gouge_bound.get()).fold(0.0, f64::max);
    let excess = surfaces
        .iter()
        .map(|name| {
            let report = certificate.surfaces.iter().find(|s| s.surface == format!("vane 1 {name}"));
            let report = report.unwrap_or_else(|| panic!("{name}"));
            println!(
                "{name}: {:?} {:?} {} {}",
                report.gouge,
                report.excess,
                report.gouge_bound.get(),
                report.excess_bound.get()
            );
            report.excess_bound.get()
        })
        .collect();
    let mut lengths = [0.0; 2];
    for note in &plan.cl.operations[0].notes {
        for (sum, words) in lengths.iter_mut().zip([" mm of contact", " mm (area"]) {
            if let Some(at) = note.find(words) {
                *sum += note[..at].split_whitespace().last().unwrap().parse::<f64>().unwrap();
            }
        }
    }
    Left { gouge, excess, lengths, passes: plan.cl.operations[0].passes.len() }
}

/// The ball of each pass comes by where it touches each planned contact, to some micrometres.
fn stands_on_its_contacts(program: &Program, plan: &Plan) {
    for (cc, cl) in plan.cc.operations.iter().zip(&plan.cl.operations) {
        let cutter = program.tools[program.operations[cc.operation].tool].solid.cutter;
        if !cutter.ends_in_ball() || program.operations[cc.operation].rest.is_some() {
            continue;
        }
        let radius = cutter.tip_radius();
        assert_eq!(cc.passes.len(), cl.passes.len());
        for (planned, pass) in cc.passes.iter().zip(&cl.passes) {
            let centres: Vec<_> = pass.points.iter().map(|p| p.tip + p.axis * radius).collect();
            for p in planned.points.iter().step_by(7) {
                let at = p.position + p.normal * radius;
                let near = centres.windows(2).map(|w| {
                    let way = w[1] - w[0];
                    let t = ((at - w[0]).dot(&way) / way.norm_squared()).clamp(0.0, 1.0);
                    (w[0] + way * t - at).norm()
                });
                let gap = near.fold(f64::INFINITY, f64::min);
                assert!(gap < 0.005, "{}: {gap} at {at}", pass.label);
            }
        }
    }
}

const FACES: [SurfaceKind; 2] = [SurfaceKind::Face(FaceId::PRESSURE), SurfaceKind::Face(FaceId::SUCTION)];
const FILLETS: [SurfaceKind; 2] = [SurfaceKind::Fillet(FaceId::PRESSURE), SurfaceKind::Fillet(FaceId::SUCTION)];

#[test]
fn ball_leaves_the_scallop_on_faces() {
    let program = program(Cutter::ball(2.0), FACES.to_vec(), 0.02, AxisMethod::Blend);
    let Left { gouge, excess, lengths: [told, least], .. } = run(&program, &["pressure face", "suction face"]);
    assert!(excess.iter().all(|e| *e <= 0.02), "{excess:?}");
    assert!(gouge <= 0.001, "{gouge}");
    assert!(told < 1.25 * least, "{told} {least}");
}

/// Faces through three curves: the proof agrees with the least distance of dense samples of a face to the ball over dense places of
/// the motion.
#[test]
fn ball_leaves_the_scallop_on_curved_faces() {
    let mut program = program(Cutter::ball(2.0), FACES.to_vec(), 0.02, AxisMethod::Blend);
    program.part = support::curved_part(Some(3.0));
    let mut sink = Sink::default();
    let plan = pipeline::run(&program, &mut sink).expect("a plan");
    let certificate = certify(&program, &plan.motion, &mut sink).expect("a certificate");
    let cl = &plan.cl.operations[0];
    let centres: Vec<Vec<Point3<f64>>> =
        cl.passes.iter().map(|pass| pass.points.iter().map(|p| p.tip + p.axis * 2.0).collect()).collect();
    for face in BladeId::MAIN.faces() {
        let report = certificate.surfaces.iter().find(|s| s.surface == format!("vane 1 {} face", face.name())).unwrap();
        let mut found = [f64::INFINITY, f64::NEG_INFINITY];
        let chart = chart::charts(&program.part).into_iter().find(|c| c.kind == SurfaceKind::Face(face)).unwrap();
        for i in 0..=60 {
            for j in 0..=60 {
                let p = chart.place(f64::from(i) / 60.0, f64::from(j) / 60.0).position;
                let near = centres.iter().flat_map(|pass| pass.windows(2)).map(|w| {
                    let way = w[1] - w[0];
                    let t = ((p - w[0]).dot(&way) / way.norm_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
                    (w[0] + way * t - p).norm() - 2.0
                });
                let g = near.fold(f64::INFINITY, f64::min);
                found = [found[0].min(g), found[1].max(g)];
            }
        }
        println!(
            "{}: samples {found:?}, proved {} and {}",
            face.name(),
            report.gouge_bound.get(),
            report.excess_bound.get()
        );
        assert!(report.excess_bound.get() <= 0.02 && report.gouge_bound.get() <= 0.001, "{report:?}");
        assert!(found[0] >= -report.gouge_bound.get() && found[1] <= report.excess_bound.get(), "{found:?}");
        assert!(found[1] > 0.9 * 0.02, "lines are as far apart as the scallop allows: {found:?}");
    }
}

/// The shipped wheel with curved vanes keeps its contracts with all operations.
#[test]
fn curved_vanes_keep_their_contracts() {
    let program = support::jobs::program("curved", None);
    let mut sink = Sink::default();
    let plan = pipeline::run(&program, &mut sink).expect("a plan");
    let (_, certificate) = verify(&program, plan.motion, &mut sink).expect("a motion that holds");
    assert!(!certificate.contracts.is_empty() && certificate.contracts.iter().all(|c| c.holds));
    let curved =
        certificate.surfaces.iter().filter(|s| s.surface.starts_with("vane 1 ") && s.surface.ends_with(" face"));
    for report in curved {
        println!(
            "{}: gouge at most {}, excess at most {}",
            report.surface,
            report.gouge_bound.get(),
            report.excess_bound.get()
        );
        assert!(report.gouge_bound.get() <= 0.002 && report.excess_bound.get() <= 0.02, "{report:?}");
    }
}

/// The shipped wheels whose blades have edges of their own: one through sections, one with splitters written by angles, an axial one.
/// One sector is finished, but for edges that the lathe makes. Round the edges lines of the floor turn, where the metric of their
/// ridges is less exact: they may be a micrometre higher there.
#[test]
fn blades_that_begin_inside_of_the_part_are_finished() {
    for (job, count) in [("sections", 7), ("splitter", 14), ("blisk", 9)] {
        let program = support::jobs::program(job, None);
        let mut sink = Sink::default();
        let plan = pipeline::run(&program, &mut sink).expect("a plan");
        let (_, certificate) = verify(&program, plan.motion, &mut sink).expect("a motion that holds");
        assert!(certificate.contracts.iter().all(|c| c.holds));
        let of_blade = |name: &str| ["vane 1 ", "splitter 1.1 "].iter().any(|of| name.starts_with(of));
        let of_hub = |name: &str| ["hub of channel 1", "hub of channel 1.1"].contains(&name);
        let turned = |name: &str| job != "blisk" && name.ends_with("outlet edge");
        let own = |name: &str| (of_blade(name) || of_hub(name)) && !turned(name);
        let finished: Vec<_> = certificate.surfaces.iter().filter(|s| own(&s.surface)).collect();
        assert_eq!(finished.len(), count, "{finished:?}");
        for report in finished {
            println!("{job} {}: {:.5}, {:.5}", report.surface, report.gouge_bound.get(), report.excess_bound.get());
            let most = if report.surface.starts_with("hub") { 0.0215 } else { 0.02 };
            assert!(report.gouge_bound.get() <= 0.002 && report.excess_bound.get() <= most, "{report:?}");
        }
    }
}

#[test]
fn ball_leaves_the_scallop_in_fillets() {
    let program = program(Cutter::ball(2.0), FILLETS.to_vec(), 0.005, AxisMethod::Blend);
    let Left { gouge, excess, .. } = run(&program, &["pressure fillet", "suction fillet"]);
    assert!(excess.iter().all(|e| *e <= 0.005), "{excess:?}");
    assert!(gouge <= 0.001, "{gouge}");
}

#[test]
fn a_ball_of_the_radius_of_the_fillet_rolls_along_it_once() {
    let program = program(Cutter::ball(3.0), FILLETS.to_vec(), 0.005, AxisMethod::Blend);
    let Left { gouge, excess, passes, .. } = run(&program, &["pressure fillet", "suction fillet"]);
    assert_eq!(passes, 2);
    assert!(excess.iter().all(|e| *e <= 0.0015), "{excess:?}");
    assert!(gouge <= 0.001, "{gouge}");
}

#[test]
fn ball_leaves_the_scallop_on_edges() {
    let edges = vec![SurfaceKind::InletEdge(BladeId::MAIN), SurfaceKind::OutletEdge(BladeId::MAIN)];
    let program = program(Cutter::ball(2.0), edges, 0.01, AxisMethod::Blend);
    let Left { gouge, excess, .. } = run(&program, &["inlet edge", "outlet edge"]);
    assert!(excess.iter().all(|e| *e <= 0.01), "{excess:?}");
    assert!(gouge <= 0.001, "{gouge}");
}

#[test]
fn ball_leaves_the_scallop_on_tips() {
    for method in [AxisMethod::Blend, AxisMethod::Corridor] {
        let program = program(Cutter::ball(2.0), vec![SurfaceKind::Tip(BladeId::MAIN)], 0.01, method);
        let Left { gouge, excess, .. } = run(&program, &["tip"]);
        assert!(excess.iter().all(|e| *e <= 0.01), "{excess:?}");
        assert!(gouge <= 0.001, "{gouge}");
    }
}

/// Tips between round edges, where both borders meet; a splitter ends inside of the part. By another measure, the distance from the shroud,
/// the ball touches it at all stations but some of leads, which run straight on.
#[test]
fn tips_between_round_edges_are_finished() {
    let mut program = support::jobs::program("splitter", None);
    let tips: Vec<SurfaceKind> = program.part.blade_ids().map(SurfaceKind::Tip).collect();
    let kind = OperationKind::Point {
        surfaces: tips,
        scallop: Mm(0.01),
        lines: Lines::Zigzag,
        milling: None,
        levels: None,
        method: AxisMethod::Blend,
    };
    let tool = program.operations.iter().next().unwrap().1.tool;
    let radius = program.tools[tool].solid.cutter.tip_radius();
    program.operations = PrimaryMap::new();
    program.operations.push(support::operation("tip", kind, tool, vec![0], 3.0));
    let mut sink = Sink::default();
    let plan = pipeline::run(&program, &mut sink).expect("a plan");
    let depth = |p: &ClPoint| radius - program.part.shroud.distance(&(p.tip + p.axis * radius));
    let depths: Vec<f64> = plan.cl.operations[0].passes.iter().flat_map(|pass| &pass.points).map(depth).collect();
    let touching = depths.iter().filter(|depth| depth.abs() <= 1e-9).count();
    println!("{touching} of {} stations touch the shroud", depths.len());
    assert!(20 * touching > 19 * depths.len());
    let certificate = certify(&program, &plan.motion, &mut sink).expect("a certificate");
    let of = |name: &&str| certificate.surfaces.iter().find(|s| s.surface == **name);
    for report in ["vane 1 tip", "splitter 1.1 tip"].iter().map(|name| of(name).expect("a report")) {
        println!("{}: {:.5}, {:.5}", report.surface, report.gouge_bound.get(), report.excess_bound.get());
        assert!(report.gouge_bound.get() <= 0.002 && report.excess_bound.get() <= 0.01, "{report:?}");
    }
}

/// Before an edge is free room: the ball may be bigger than the fillet, which it does not touch.
#[test]
fn a_ball_bigger_than_the_fillet_cuts_edges_and_nothing_else() {
    let edges = vec![SurfaceKind::InletEdge(BladeId::MAIN), SurfaceKind::OutletEdge(BladeId::MAIN)];
    let big = Cutter::ball(5.0);
    let Left { gouge, excess, .. } = run(&program(big, edges, 0.05, AxisMethod::Blend), &["inlet edge", "outlet edge"]);
    assert!(excess.iter().all(|e| *e <= 0.05), "{excess:?}");
    assert!(gouge <= 0.001, "{gouge}");
    for (surfaces, words) in
        [(FACES, ["end at the fillets", "into the hub"]), (FILLETS, ["cuts the fillets", "beside"])]
    {
        let mut sink = Sink::default();
        assert!(pipeline::run(&program(big, surfaces.to_vec(), 0.01, AxisMethod::Blend), &mut sink).is_err());
        let error = &sink.diags()[0];
        assert_eq!(error.code.id(), "IMP0402");
        assert!(error.labels.iter().zip(words).all(|(l, w)| l.text.contains(w)), "{:?}", error.labels);
    }
}

#[test]
fn a_spiral_leaves_the_scallop_without_leaving_the_vane() {
    let mut program = program(Cutter::ball(2.0), FACES.to_vec(), 0.05, AxisMethod::Blend);
    let (_, mut operation) = program.operations.iter().next().map(|(id, o)| (id, o.clone())).unwrap();
    // Round the vane one way and the other.
    for sense in Milling::ALL {
        if let OperationKind::Point { lines, milling, .. } = &mut operation.kind {
            (*lines, *milling) = (Lines::Spiral, Some(sense));
        }
        program.operations = PrimaryMap::new();
        program.operations.push(operation.clone());
        let Left { gouge, excess, passes, .. } = run(&program, &["pressure face", "suction face"]);
        assert_eq!(passes, 1);
        assert!(excess.iter().all(|e| *e <= 0.05), "{excess:?}");
        assert!(gouge <= 0.001, "{gouge}");
    }
}

#[test]
fn corridor_turns_the_axis_evenly_on_faces() {
    let program = program(Cutter::ball(2.0), FACES.to_vec(), 0.2, AxisMethod::Corridor);
    let Left { gouge, excess, .. } = run(&program, &["pressure face", "suction face"]);
    assert!(excess.iter().all(|e| *e <= 0.2), "{excess:?}");
    assert!(gouge <= 0.001, "{gouge}");
}

#[test]
fn barrel_leaves_the_scallop_with_a_fraction_of_the_lines() {
    let barrel = Cutter::barrel(3.0, 40.0, 1.0);
    let mut program = program(barrel, FACES.to_vec(), 0.02, AxisMethod::Blend);
    // Down to where the tip would cut into fillet and hub; the rest of the root is left to a ball.
    let ball = program.tools.push(support::tool("t2", 2, Cutter::ball(2.0), 30.0, 50.0));
    let kind = OperationKind::Point {
        surfaces: FACES.to_vec(),
        scallop: Mm(0.02),
        lines: Lines::Zigzag,
        milling: None,
        levels: None,
        method: AxisMethod::Blend,
    };
    let rest = support::operation("point2", kind, ball, vec![0], 8.0);
    program.operations.push(Operation { rest: Some(Mm(0.02)), ..rest });
    let Left { gouge, excess, lengths: [told, _], .. } = run(&program, &["pressure face", "suction face"]);
    assert!(excess.iter().all(|e| *e <= 0.02), "{excess:?}");
    assert!(gouge <= 0.001, "{gouge}");
    // A fifth of what the ball takes over the whole faces.
    assert!(told < 515.0, "{told}");
}

#[test]
fn bull_nose_and_lollipop_leave_the_scallop() {
    for cutter in [Cutter::bull(2.5, 1.0), Cutter::lollipop(2.0)] {
        let program = program(cutter, vec![SurfaceKind::Face(FaceId::SUCTION)], 0.03, AxisMethod::Blend);
        let Left { gouge, excess, .. } = run(&program, &["suction face"]);
        assert!(excess.iter().all(|e| *e <= 0.03), "{cutter:?}: {excess:?}");
        assert!(gouge <= 0.001, "{cutter:?}: {gouge}");
    }
}

/// Fillets whose radius changes along the foot, and the floor between them, of `jobs/splitter`: no more than their scallop and the chord
/// tolerance is left, and the ball cuts in nowhere.
#[test]
fn fillets_of_a_varied_radius_are_finished() {
    let job = std::fs::read_to_string("jobs/splitter/splitter.imp").unwrap();
    let operation = |name: &str| {
        let (_, rest) = job.split_once(&format!("operation {name} {{")).unwrap();
        format!("operation {name} {{{}\n}}\n", rest.split_once("\n}").unwrap().0)
    };
    let [rough, point, edge] = ["rough", "point", "edge"].map(operation);
    let varied = "fillet [(0 %, 1.2 mm) (60 %, 2 mm) (100 %, 1.5 mm)]";
    let changes = [("fillet 1.5 mm", varied), (&rough, ""), (&point, ""), (&edge, "")];
    let program = support::jobs::program_with("jobs/splitter/splitter.imp", &changes);
    let mut sink = Sink::default();
    let plan = pipeline::run(&program, &mut sink).unwrap_or_else(|_| panic!("{:?}", sink.diags()));
    let certificate = certify(&program, &plan.motion, &mut sink).unwrap_or_else(|_| panic!("{:?}", sink.diags()));
    let mut finished = 0;
    for report in &certificate.surfaces {
        assert!(report.gouge_bound.get() <= 0.002, "{}: {}", report.surface, report.gouge_bound.get());
        let first = ["vane 1 ", "splitter 1.1 "].iter().any(|blade| report.surface.starts_with(blade));
        if first && report.surface.ends_with("fillet") || report.surface.starts_with("hub of channel 1") {
            println!("{}: {} {}", report.surface, report.gouge_bound.get(), report.excess_bound.get());
            if report.surface.ends_with("channel 1") || first {
                assert!(report.excess_bound.get() <= 0.0215, "{}: {}", report.surface, report.excess_bound.get());
                finished += 1;
            }
        }
    }
    // Three fillets of each blade, and the floor of the first passage; the second ends at a blade without its fillet.
    assert_eq!(finished, 7);
}

/// Spline blocks are proved like straight moves: all operations of the job, edges of 2.8 mm2 included, round which short passes turn.
#[test]
fn polynomials_hold_the_contracts_of_the_job() {
    let mut program = jobs::program("point", None);
    program.post.control.path = PathForm::Splines;
    let made = Compiled::new(program);
    let blocks: Vec<usize> = made.motion.operations.iter().map(|o| o.splines.len()).collect();
    println!("{blocks:?} spline blocks");
    assert!(blocks[0] == 0 && blocks[1..].iter().all(|count| *count > 40), "{blocks:?}");
    let worst = made.certificate.surfaces.iter().map(|s| s.gouge_bound.get()).fold(0.0, f64::max);
    println!("gouge at most {worst} mm");
    assert!(worst > 0.0 && worst <= 0.002, "{worst}");
}
