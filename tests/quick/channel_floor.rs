//! Channel floors of constant scallop.

use crate::support::{self, jobs};
use impellerc::base::entity::PrimaryMap;
use impellerc::base::units::Mm;
use impellerc::diagnostics::Sink;
use impellerc::ir::{CcPass, CcPoint, Contract, ContractKind, OperationKind, Program};
use impellerc::nurbs::proximity::Patch;
use impellerc::plan::passes::pipeline;
use impellerc::tool_stock::collide::Cutter;
use impellerc::wheel::method::{AxisMethod, Lines, Spacing};
use impellerc::wheel::part::{FaceId, Surface};
use nalgebra::{Point3, Vector3};
use std::collections::BTreeMap;

/// The paper's part with nothing but the finishing of one channel with a ball of 6 mm.
fn floor_only(scallop: f64, spacing: Spacing) -> Program {
    with_ball(3.0, scallop, spacing)
}

/// The same with another ball.
fn with_ball(radius: f64, scallop: f64, spacing: Spacing) -> Program {
    let mut program = support::wei_program(&[0]);
    (program.tools, program.operations) = (PrimaryMap::new(), PrimaryMap::new());
    let tool = program.tools.push(support::tool("t1", 1, Cutter::ball(radius), 30.0, 42.0));
    let kind = OperationKind::Channel {
        scallop: Mm(scallop),
        spacing,
        lines: Lines::OneWay,
        method: AxisMethod::Blend,
        allowance_vane: None,
    };
    program.operations.push(support::operation("channel", kind, tool, vec![0], 8.0));
    program
}

/// Figures of the note: contact length and lower bound of a channel, mm.
fn figures(note: &str) -> [f64; 2] {
    let before = |words: &str| {
        let at = note.find(words).unwrap_or_else(|| panic!("{note}"));
        note[..at].split_whitespace().last().unwrap().parse::<f64>().unwrap()
    };
    [before(" mm of contact"), before(" mm (area")]
}

#[test]
fn scallop_holds_as_proved_and_the_path_is_near_its_lower_bound() {
    let mut program = floor_only(0.012, Spacing::ConstantScallop);
    program.contracts.push(Contract::whole(ContractKind::Excess, 0.012));
    let start = std::time::Instant::now();
    let plan = pipeline::run(&program, &mut Sink::default()).expect("a plan");
    println!("planned in {:?}", start.elapsed());
    let note = &plan.cc.operations[0].notes[1];
    println!("{note}");
    let certificate = jobs::certified(&program, &plan.motion);
    let hub = certificate.surfaces.iter().find(|s| s.surface.contains("hub of channel 1")).expect("a hub");
    println!("left {} mm found, {} mm proved, {:?}", hub.excess.value.get(), hub.excess_bound.get(), hub.excess.point);
    let deepest = certificate.surfaces.iter().map(|s| s.gouge_bound.get()).fold(0.0, f64::max);
    println!("deepest cut {deepest} mm proved");
    // The scallop with the interpolation of the machine, by the proof of the verifier; the chord alone cuts.
    assert!(hub.excess_bound.get() <= 0.012, "{}", hub.excess_bound.get());
    assert!(deepest < 0.0015, "{deepest}");
    // Lengths measured again from the contact points.
    let length: f64 = plan.cc.operations[0].passes.iter().map(|p| contact_length(&program, p)).sum();
    let [told, least] = figures(note);
    assert!((length - told).abs() < 0.1, "{length} {told}");
    assert!(length <= 1.15 * least, "{length} {least}");
}

/// True for a point of the hub between inlet and outlet.
pub(crate) fn on_hub(program: &Program, p: &CcPoint) -> bool {
    (0.0..=1.0).contains(&p.u) && program.part.hub.distance(&p.position) < 1e-9
}

/// Length of a pass where it lies on the hub between inlet and outlet.
pub(crate) fn contact_length(program: &Program, pass: &CcPass) -> f64 {
    let on = |w: &&[CcPoint]| w.iter().all(|p| on_hub(program, p));
    pass.points.windows(2).filter(on).map(|w| (w[1].position - w[0].position).norm()).sum()
}

/// Excess at a point of the hub over the ways of a ball along all passes, brute force: the distance to the nearest piece
/// of the way of its centre, less the radius.
pub(crate) struct Ways {
    radius: f64,
    /// Pieces by the cell of 2 mm in x and y of their first point.
    cells: BTreeMap<[i64; 2], Vec<[Point3<f64>; 2]>>,
}

impl Ways {
    pub(crate) fn new(passes: &[CcPass], radius: f64) -> Self {
        let mut cells: BTreeMap<[i64; 2], Vec<[Point3<f64>; 2]>> = BTreeMap::new();
        for pair in passes.iter().flat_map(|p| p.points.windows(2)) {
            let piece = [0, 1].map(|i| pair[i].position + pair[i].normal * radius);
            cells.entry(Self::cell(&piece[0])).or_default().push(piece);
        }
        Self { radius, cells }
    }

    fn cell(p: &Point3<f64>) -> [i64; 2] {
        [(p.x / 2.0).floor() as i64, (p.y / 2.0).floor() as i64]
    }

    pub(crate) fn excess(&self, at: &Point3<f64>, normal: &Vector3<f64>) -> f64 {
        let [i, j] = Self::cell(&(at + normal * self.radius));
        let around = (i - 1..=i + 1).flat_map(|i| (j - 1..=j + 1).map(move |j| [i, j]));
        let pieces = around.filter_map(|c| self.cells.get(&c)).flatten();
        let distance = pieces.map(|[a, b]| {
            let way = b - a;
            let t = ((at - a).dot(&way) / way.norm_squared()).clamp(0.0, 1.0);
            (a + way * t - at).norm()
        });
        distance.fold(f64::INFINITY, f64::min) - self.radius
    }
}

/// Planned passes of the only operation.
fn passes(program: &Program) -> Vec<CcPass> {
    pipeline::run(program, &mut Sink::default()).expect("a plan").cc.operations.remove(0).passes
}

/// Where the rolling ball touches the hub, by the first or the last line: azimuth at the station nearest to u.
pub(crate) fn azimuth(line: &CcPass, u: f64) -> f64 {
    let p = line.points.iter().min_by(|a, b| (a.u - u).abs().total_cmp(&(b.u - u).abs())).unwrap();
    p.position.y.atan2(p.position.x)
}

#[test]
fn ridges_between_lines_are_as_high_as_planned_and_no_higher() {
    for (height, radius) in [(0.012, 3.0), (0.1, 3.0), (0.02, 2.0)] {
        let program = with_ball(radius, height, Spacing::ConstantScallop);
        let lines = passes(&program);
        let ways = Ways::new(&lines, radius);
        let planned = height - program.tolerances.chord.get();
        let (mut worst, mut high, mut count) = (0.0_f64, 0, 0);
        for i in 0..=200 {
            let u = f64::from(i) / 200.0;
            let (from, to) = (azimuth(&lines[0], u), azimuth(lines.last().unwrap(), u));
            for j in 0..=400 {
                let azimuth = from + (to - from) * (0.005 + 0.99 * f64::from(j) / 400.0);
                let excess = ways.excess(&program.part.hub.point(u, azimuth), &program.part.hub.normal(u, azimuth));
                worst = worst.max(excess);
                count += 1;
                high += usize::from(excess > 0.75 * planned);
            }
        }
        let share = high as f64 / f64::from(count);
        println!("{height} {radius}: {worst}, {share}");
        assert!(worst < 1.01 * planned, "{worst} {planned}");
        // Of a parabola of the full height everywhere 13 % lie higher than three quarters of it.
        assert!(share > 0.09, "{share}");
    }
}

#[test]
fn walls_are_lines() {
    let program = floor_only(0.05, Spacing::ConstantScallop);
    let lines = passes(&program);
    let part = &program.part;
    let sides = [
        (&lines[0], part.first_passage().walls[0], 0),
        (lines.last().unwrap(), other(part.first_passage().walls[0]), 1),
    ];
    for (line, side, sector) in sides {
        let turn = part.sector_rotation(sector).inverse();
        let face = part.face(side);
        for p in line.points.iter().filter(|p| (0.1..0.9).contains(&p.u)) {
            let centre = turn * (p.position + p.normal * 3.0);
            let foot = face.surface.closest(&centre, Patch { u: [0.0, 1.0], v: [0.0, 1.0] });
            let distance = (face.surface.point(foot.u, foot.v) - centre).norm();
            assert!((distance - 3.0).abs() < 1e-6, "{} at {}: {distance}", line.label, p.u);
        }
    }
}

fn other(side: FaceId) -> FaceId {
    if side == FaceId::PRESSURE { FaceId::SUCTION } else { FaceId::PRESSURE }
}

#[test]
fn lines_lie_side_by_side_and_begin_smoothly() {
    let program = floor_only(0.012, Spacing::ConstantScallop);
    let lines = passes(&program);
    // From wall to wall at the outlet.
    let ends: Vec<f64> = lines.iter().map(|l| l.points.last().unwrap().w).collect();
    assert!(ends.windows(2).all(|w| w[0] < w[1]), "{ends:?}");
    let partial: Vec<&CcPass> = lines.iter().filter(|l| l.points[0].u > 0.0).collect();
    assert!(partial.len() > lines.len() / 2);
    for line in partial {
        // Half a ball radius over the hub where it starts, along its normal, down to it on an arc.
        let height = |p: &CcPoint| program.part.hub.distance(&p.position);
        assert!((height(&line.points[0]) - 1.5).abs() < 1e-6, "{}: {}", line.label, height(&line.points[0]));
        assert!(line.points.iter().all(|p| height(p) > -1e-9 && (0.0..=1.0).contains(&p.w)));
        assert!(line.points.windows(2).all(|w| w[0].u < w[1].u));
    }
    let mut sharpest = f64::INFINITY;
    for line in &lines {
        for w in line.points.windows(3).filter(|w| w.iter().all(|p| on_hub(&program, p))) {
            let (a, b) = (w[1].position - w[0].position, w[2].position - w[1].position);
            sharpest = sharpest.min(0.5 * (a.norm() + b.norm()) / a.angle(&b).max(1e-12));
        }
    }
    println!("sharpest turn {sharpest} mm");
    // Where a line parts from the seam: the radius of the line itself, which stations follow within a quarter of the chord tolerance.
    assert!(sharpest > 1.1, "{sharpest}");
}

/// Codes of what planning says.
fn codes(program: &Program) -> Vec<String> {
    let mut sink = Sink::default();
    assert!(pipeline::run(program, &mut sink).is_err());
    for d in sink.diags() {
        println!("{} {} {:?} {:?}", d.code, d.message, d.place, d.help);
        assert!(d.help.is_some());
    }
    sink.diags().iter().map(|d| d.code.id().to_owned()).collect()
}

#[test]
fn what_does_not_fit_is_named() {
    let resized = |radius: f64, fillet: Option<f64>| {
        let mut program = with_ball(radius, 0.012, Spacing::ConstantScallop);
        program.part = program.part.with_fillet(fillet.map(Mm));
        program
    };
    assert_eq!(codes(&resized(3.5, Some(3.0))), ["IMP0402"]);
    // Two balls of this radius would overlap at the inlet.
    assert_eq!(codes(&resized(6.0, None)), ["IMP0450"]);
    // A ball nearly as round as the hub is hollow is too big for the walls; a bigger one is too big for the hub.
    let hollow = least_hollow();
    assert_eq!(codes(&resized(0.99 * hollow, None)), ["IMP0403"]);
    assert_eq!(codes(&resized(1.01 * hollow, None)), ["IMP0408"]);
}

#[test]
fn the_ball_that_would_do_is_named() {
    // Without and with a fillet in the design, which the ball rolls in.
    let hollow = 1.01 * least_hollow();
    for (radius, fillet, code) in
        [(6.0, None, "IMP0450"), (2.0, Some(6.0), "IMP0450"), (9.0, None, "IMP0403"), (hollow, None, "IMP0408")]
    {
        let refused = |radius: f64, fillet: Option<f64>| {
            let mut program = with_ball(radius, 0.5, Spacing::EqualDivision);
            program.part = program.part.with_fillet(fillet.map(Mm));
            let mut sink = Sink::default();
            let _ = pipeline::run(&program, &mut sink);
            let error = |d: &&impellerc::diagnostics::Diag| ["IMP0450", "IMP0403", "IMP0408"].contains(&d.code.id());
            sink.diags().iter().find(error).map(|d| (d.code.id().to_owned(), d.help.clone().unwrap_or_default()))
        };
        let (found, help) = refused(radius, fillet).expect("an error");
        assert_eq!(found, code);
        println!("{radius} {fillet:?}: {help}");
        let number = |after: &str| -> f64 {
            let rest = help.split(after).nth(1).unwrap_or_else(|| panic!("{help}"));
            rest.split(" mm").next().unwrap().parse().unwrap()
        };
        let most = 0.5 * number("ball of at most ");
        match fillet {
            None => {
                assert!(refused(most, None).is_none(), "{most}");
                assert!(refused(most + 0.006, None).is_some(), "{most}");
            }
            Some(_) => {
                assert!((number("fillet of at most ") - most).abs() < 0.006);
                assert!(refused(2.0, Some(most)).is_none(), "{most}");
                assert!(refused(2.0, Some(most + 0.006)).is_some(), "{most}");
            }
        }
    }
}

/// Least radius of the hollows of the paper's hub, from differences of its meridian.
fn least_hollow() -> f64 {
    let part = support::wei_part(None);
    let point = |u: f64| part.hub.meridian(u).point;
    let mut least = f64::INFINITY;
    for i in 1..4000 {
        let (u, d) = (f64::from(i) / 4000.0, 2e-4);
        let (a, b) = (point(u) - point(u - d), point(u + d) - point(u));
        least = least.min(0.5 * (a.norm() + b.norm()) / a.angle(&b));
    }
    least
}
