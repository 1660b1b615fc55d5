//! Finishing passes as polynomials: on the way into the text, in the text, and on the way back.

use crate::support::{self, pinned};
use impellerc::base::entity::PrimaryMap;
use impellerc::base::source::Span;
use impellerc::base::units::Mm;
use impellerc::diagnostics::Sink;
use impellerc::five_axis::{PoseCurve, RotaryPose, TurnCurve};
use impellerc::ir::{Contract, ContractKind, Motion, MoveKind, OperationKind, Program, SplineBlock};
use impellerc::job::shipped_post;
use impellerc::nc::{self, motion_of::motion_of};
use impellerc::nurbs::bezier;
use impellerc::plan::passes::pipeline;
use impellerc::verify::{self, Verified};
use impellerc::wheel::contract::Scope;
use impellerc::wheel::control::PathForm;
use impellerc::wheel::method::{Flank, FlankMethod};
use impellerc::wheel::part::{BladeId, SurfaceClass};
use nalgebra::Vector3;
use std::sync::LazyLock;

const POSTS: [&str; 3] = ["siemens-840d", "heidenhain-itnc530", "apt-cl"];

/// Both faces of a vane with splines, for a post.
struct Splines {
    program: Program,
    motion: Motion,
    text: String,
}

fn splines(name: &str, mut program: Program) -> Splines {
    program.post = shipped_post(name).unwrap();
    program.post.control.path = PathForm::Splines;
    let motion = pipeline::run(&program, &mut Sink::default()).unwrap().motion;
    let text = text(&program, &motion);
    Splines { program, motion, text }
}

static FITTED: LazyLock<[Splines; 3]> = LazyLock::new(|| POSTS.map(|name| splines(name, support::flank_only(&[0]))));

/// The texts with splines: name of the post, job, and text.
pub fn texts() -> Vec<(&'static str, &'static Program, &'static str)> {
    POSTS.iter().zip(&*FITTED).map(|(name, made)| (*name, &made.program, made.text.as_str())).collect()
}

/// The text of a motion.
fn text(program: &Program, motion: &Motion) -> String {
    let post = nc::find(&program.post.dialect).unwrap();
    let verified = verified(program, motion);
    let text = nc::emit(post, program, &verified, &[]).text();
    // V5: as the compiler does before it writes.
    let read = nc::read_back(post, program, &verified, &text).unwrap_or_else(|diag| panic!("{diag:?}"));
    assert!(read.tip < 6e-5 && read.axis < 2e-6, "{read:?}");
    text
}

fn verified(program: &Program, motion: &Motion) -> Verified<Motion> {
    let mut program = program.clone();
    // The channel is not roughed here: only the text matters.
    program.contracts.clear();
    program.allowed.push(support::deep_slots());
    let mut sink = Sink::default();
    let mut settings = verify::stock::Settings { cell: Some(1.0), ..Default::default() };
    let progress = impellerc::base::progress::Progress::default();
    let (judged, _) = verify::examine(&program, motion.clone(), &mut settings, &progress, &mut sink).unwrap();
    judged.unwrap_or_else(|_| panic!("{:?}", sink.diags()))
}

fn blocks(motion: &Motion) -> &[SplineBlock] {
    &motion.operations[0].splines
}

#[test]
fn cuts_are_few_polynomials() {
    let (_, lines) = pinned::flank().planned();
    let cuts = lines.operations[0].moves.iter().filter(|m| m.kind == MoveKind::Cut).count();
    for ((name, made), fewer) in POSTS.iter().zip(&*FITTED).zip([7, 2, 7]) {
        let operation = &made.motion.operations[0];
        let chords: usize = operation.splines.iter().map(|s| s.shares.len()).sum();
        let straight = operation.moves.iter().filter(|m| m.kind == MoveKind::Cut).count() - chords;
        let blocks = operation.splines.len() + straight;
        println!("{name}: {blocks} blocks instead of {cuts}, {chords} chords");
        assert!(fewer * blocks < cuts, "{name}: {blocks} of {cuts}");
    }
}

/// A path of `minimax` is planned as few quintics, so that as few polynomials follow it: both faces, one strip each.
#[test]
fn a_path_of_quintics_needs_few_polynomials() {
    let mut program = support::flank_only(&[0]);
    let contract = |kind, bound: f64| Contract {
        scope: Scope {
            operations: Vec::new(),
            surfaces: vec![SurfaceClass::Pressure, SurfaceClass::Suction, SurfaceClass::Fillet],
        },
        ..Contract::whole(kind, bound)
    };
    program.contracts = vec![contract(ContractKind::Gouge, 0.002), contract(ContractKind::Excess, 0.014)];
    program.tolerances.chord = Mm(0.001);
    let mut operation = program.operations.iter().next().unwrap().1.clone();
    let flank = Flank { strips: Some(1), ..Flank::by_ruling(FlankMethod::Minimax, 1) };
    operation.kind = OperationKind::Flank { faces: BladeId::MAIN.faces().to_vec(), flank };
    program.operations = PrimaryMap::new();
    program.operations.push(operation);
    let made = splines("siemens-840d", program);
    let count = blocks(&made.motion).len();
    println!("{count} polynomials in two passes");
    // Four quintics a pass, and what the length of the path as its parameter costs. A path of 11 cubics needs 26.
    assert!((8..=14).contains(&count), "{count}");
}

/// Every station of the path with lines lies on the path with splines, within the tolerance.
#[test]
fn splines_follow_the_path_that_lines_follow() {
    let (program, lines) = pinned::flank().planned();
    let tool = &program.tools[program.operations.iter().next().unwrap().1.tool];
    let heights = [tool.solid.cutter.tip_radius(), tool.solid.flute_length];
    let tolerance = program.tolerances.chord.get();
    for made in &*FITTED {
        let machine = &made.program.machine;
        let all: Vec<_> = made.motion.operations[0].moves.iter().map(|m| machine.forward(&m.joints)).collect();
        let cuts: Vec<_> = lines.operations[0].moves.iter().filter(|m| m.kind == MoveKind::Cut).collect();
        let mut worst = 0.0_f64;
        for m in cuts.iter().step_by(9) {
            let pose = program.machine.forward(&m.joints);
            let far = |h: f64| {
                let point = pose.tip + pose.axis * h;
                let each = all.windows(2).map(|w| {
                    let [a, b] = [0, 1].map(|k| w[k].tip + w[k].axis * h);
                    let way = b - a;
                    let t = (way.dot(&(point - a)) / way.norm_squared()).clamp(0.0, 1.0);
                    (a + way * t - point).norm()
                });
                each.fold(f64::INFINITY, f64::min)
            };
            worst = heights.map(far).into_iter().fold(worst, f64::max);
        }
        println!("stations at most {worst} mm beside the splines");
        assert!(worst > 0.0 && worst < 1.05 * tolerance, "{worst}");
    }
}

/// Samples, which share nothing with the bounds: no point of the tool leaves its chord by more than the certificate says.
#[test]
fn chords_are_as_near_as_the_certificate_says() {
    for made in &*FITTED {
        let (program, motion) = (&made.program, &made.motion);
        let reports = verify::splines::reports(program, motion, &mut Sink::default()).unwrap();
        let report = reports[0].unwrap();
        let (chain, operation) = (&program.machine.chain, &motion.operations[0]);
        let height = program.tools[program.operations[operation.operation].tool].solid.flute_length;
        let mut worst = 0.0_f64;
        for spline in &operation.splines {
            let mut from = 0.0;
            for (index, to) in spline.chords().zip(&spline.shares) {
                let ends = [index - 1, index].map(|k| {
                    let joints = &operation.moves[k].joints;
                    RotaryPose { tip: program.machine.forward(joints).tip, rotary: joints.rotary }
                });
                for share in [0.0, 0.2, 0.5, 0.9, 1.0] {
                    let (on, due) =
                        (ends[0].towards(&ends[1], share), spline.curve.pose(chain, from + (to - from) * share));
                    let (gap, turned) = (on.tip - due.tip, chain.tool_axis(on.rotary) - due.axis);
                    worst = worst.max(gap.norm()).max((gap + turned * height).norm());
                }
                from = *to;
            }
        }
        println!("{worst:.2e} mm sampled, {:.2e} mm stated, {} blocks", report.flutes.get(), report.blocks);
        assert!(
            worst <= report.flutes.get() && worst > 0.1 * report.flutes.get() && report.flutes.get() < 5e-4,
            "{worst} {report:?}"
        );
        assert_eq!(report.blocks, blocks(motion).len());
    }
}

/// A curve that is not that of its chords is found, however little it is off.
#[test]
fn a_curve_away_from_its_chords_is_found() {
    let made = &FITTED[0];
    for (off, found) in [(2e-3, true), (0.0, false)] {
        let mut motion = made.motion.clone();
        let spline = &mut motion.operations[0].splines[3];
        let tip: Vec<Vector3<f64>> = spline.curve.tip().iter().map(|p| p + Vector3::x() * off).collect();
        spline.curve = PoseCurve::new(tip, spline.curve.turn().clone()).unwrap();
        let mut sink = Sink::default();
        assert_eq!(verify::splines::reports(&made.program, &motion, &mut sink).is_none(), found);
        assert_eq!(sink.has_errors(), found);
    }
}

/// The text says the curves: read by the reader of the dialect, they are those of the motion up to the last digits.
#[test]
fn the_text_comes_back_as_the_curves() {
    for made in &*FITTED {
        let post = nc::find(&made.program.post.dialect).unwrap();
        let sections = post.read(&made.text, &made.program.machine).unwrap();
        let mut sink = Sink::default();
        let read = motion_of(&made.program, &sections, &|_| Span::default(), &mut sink).unwrap();
        assert!(!sink.has_errors(), "{:?}", sink.diags());
        let (meant, found) = (blocks(&made.motion), blocks(&read.motion));
        assert_eq!(meant.len(), found.len());
        for (a, b) in meant.iter().zip(found) {
            let gap = |p: &[Vector3<f64>], q: &[Vector3<f64>]| {
                let [p, q] = [p, q].map(|c| bezier::elevated(c, 5));
                p.iter().zip(&q).map(|(p, q)| (p - q).amax()).fold(0.0, f64::max)
            };
            assert!(gap(a.curve.tip(), b.curve.tip()) < 1e-6);
            match (a.curve.turn(), b.curve.turn()) {
                (TurnCurve::Second(p), TurnCurve::Second(q)) => assert!(gap(p, q) < 1e-6),
                (TurnCurve::Rotary(p), TurnCurve::Rotary(q)) => {
                    assert!(p.iter().zip(q).all(|(p, q)| (p - q).amax() < 1e-7));
                }
                _ => panic!("two kinds of splines"),
            }
        }
    }
}

/// Neighbours have no corner between them, but where the pass has one.
#[test]
fn neighbours_run_on() {
    for made in &*FITTED {
        let blocks = blocks(&made.motion);
        let pairs = blocks.windows(2).filter(|pair| pair[0].last + 1 == pair[1].first);
        let (on, all) =
            pairs.fold((0, 0), |(on, all), pair| (on + usize::from(pair[0].curve.runs_on(&pair[1].curve)), all + 1));
        println!("{on} of {all} joins without a corner");
        assert!(10 * on >= 9 * all && all > 10);
    }
}
