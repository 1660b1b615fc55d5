//! One sector for all: the proof by partners against the proof of each sector by itself, on a whole wheel and on the same wheel
//! with faults in one sector.

use crate::support::jobs;
use impellerc::base::progress::Progress;
use impellerc::diagnostics::Sink;
use impellerc::ir::motion::MotionOperation;
use impellerc::ir::{JointMove, Motion, MoveKind, Program};
use impellerc::plan::passes::pipeline;
use impellerc::verify::allowance::{self, AllowanceReport};
use impellerc::verify::dynamics;
use impellerc::verify::kept::{self, KeptSurfaces};
use impellerc::verify::proof::piece::At;
use impellerc::verify::proof::sweep::Sweep;
use impellerc::verify::proof::turns::PartnerRounding;
use impellerc::verify::surface::{self, SurfaceReport};
use impellerc::verify::{SPACING, limits};
use impellerc::wheel::part::sample::{self, Sample};
use impellerc::wheel::part::{SurfaceId, SurfaceKind};
use nalgebra::{Point3, Rotation3, Vector3};
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// Figures of two proofs of the same surface agree to this, mm.
const ROUNDING: f64 = 1e-9;

/// The flank of `small` in all sectors, and the floor roughly, so that it is planned in a second.
pub(super) static WHEEL: LazyLock<(Program, Motion)> = LazyLock::new(|| {
    let folder = jobs::small_with(&[
        ("  lead-in 5 mm  lead-out 5 mm  sectors 1, 8\n", "  lead-in 5 mm  lead-out 5 mm\n"),
        ("  sectors 1\n", "\n"),
        ("scallop 0.2 mm", "scallop 0.6 mm"),
    ]);
    let program = jobs::program_at(folder.path().join("small.imp").to_str().unwrap());
    let motion = pipeline::run(&program, &mut Sink::default()).expect("a plan").motion;
    (program, motion)
});

/// What is proved of the motion as it was planned.
static CLEAN: LazyLock<Proofs> = LazyLock::new(|| Proofs::new(&WHEEL.0, &WHEEL.1));

/// What is proved of a motion, by partners and of each sector by itself.
struct Proofs {
    surfaces: [Vec<SurfaceReport>; 2],
    kept: [KeptSurfaces; 2],
    allowance: [AllowanceReport; 2],
}

impl Proofs {
    fn new(program: &Program, motion: &Motion) -> Self {
        Self::rounded(program, motion, PartnerRounding::ARITHMETIC)
    }

    fn rounded(program: &Program, motion: &Motion, rounding: PartnerRounding) -> Self {
        let all = |alone: bool| -> Vec<Sweep<'_>> {
            let sweeps = (0..motion.operations.len()).filter_map(|o| Sweep::rounded(program, motion, o, rounding));
            sweeps.map(|sweep| if alone { sweep.in_each_sector() } else { sweep }).collect()
        };
        let both = [false, true].map(all);
        let progress = Progress::default();
        Self {
            surfaces: both.each_ref().map(|sweeps| {
                let (part, turned) = (&program.part, program.milled_turned());
                surface::certify(part, turned, sweeps, SPACING, &limits(program), &progress)
            }),
            kept: both.each_ref().map(|sweeps| kept::check(program, sweeps, 0.0, &progress)),
            allowance: both
                .each_ref()
                .map(|sweeps| allowance::check(program, motion, sweeps, &progress).expect("roughing")),
        }
    }

    /// Both proofs say the same: bounds within the slack of a proof, what was found to rounding.
    fn agree(&self) {
        let near = |a: f64, b: f64, by: f64, what: &str| assert!((a - b).abs() <= by, "{what}: {a} {b}");
        let [partners, alone] = &self.surfaces;
        assert_eq!(partners.len(), alone.len());
        for (a, b) in partners.iter().zip(alone) {
            let what = &a.surface;
            assert_eq!((a.id, &a.surface, a.samples, b.follows.is_none()), (b.id, &b.surface, b.samples, true));
            near(a.gouge.value.get(), b.gouge.value.get(), surface::SLACK, what);
            near(a.excess.value.get(), b.excess.value.get(), surface::SLACK, what);
            near(a.area.get(), b.area.get(), ROUNDING * b.area.get(), what);
            near(a.not_reached.get(), b.not_reached.get(), ROUNDING * b.area.get(), what);
            assert!(a.gouge_bound.get() >= -b.gouge.value.get() - ROUNDING, "{what}");
            assert!(a.excess_bound.get() >= b.excess.value.get() - ROUNDING, "{what}");
            near(a.gouge_bound.get(), b.gouge_bound.get(), 2.0 * surface::SLACK, what);
            near(a.excess_bound.get(), b.excess_bound.get(), 0.05 * b.excess_bound.get() + 2.0 * surface::SLACK, what);
        }
        let [partners, alone] = &self.kept;
        assert_eq!(partners.surfaces.len(), alone.surfaces.len());
        for (a, b) in partners.surfaces.iter().zip(&alone.surfaces) {
            assert_eq!(a.surface, b.surface);
            near(a.gouge.value.get(), b.gouge.value.get(), surface::SLACK, &a.surface);
            near(a.gouge_bound.get(), b.gouge_bound.get(), 2.0 * surface::SLACK, &a.surface);
        }
        let [partners, alone] = &self.allowance;
        near(partners.bound.get(), alone.bound.get(), 2.0 * surface::SLACK, "allowance");
    }

    /// Surfaces that were proved by themselves.
    fn proved(&self) -> impl Iterator<Item = &SurfaceReport> {
        self.surfaces[0].iter().filter(|s| s.follows.is_none())
    }

    /// The sector from which others follow.
    fn first(&self) -> u32 {
        let name = self.surfaces[0].iter().find_map(|s| s.follows.as_ref()).unwrap();
        self.surfaces[0].iter().find(|s| s.surface == *name).unwrap().id.sector
    }

    /// Of a surface in a sector, what the proof by partners says.
    fn of(&self, kind: SurfaceKind, sector: u32) -> &SurfaceReport {
        self.surfaces[0].iter().find(|s| s.id == SurfaceId { kind, sector }).unwrap()
    }
}

#[test]
fn one_sector_proves_the_wheel() {
    let (program, motion) = &*WHEEL;
    let proofs = &*CLEAN;
    proofs.agree();
    let vanes = program.part.vane_count;
    let sector = proofs.first();
    for report in &proofs.surfaces[0] {
        let first = proofs.of(report.id.kind, sector);
        let follows = (report.id.sector != sector).then_some(&first.surface);
        assert_eq!(report.follows.as_ref(), follows, "{}", report.surface);
        let [from, to] = [sector, report.id.sector].map(|sector| program.part.sector_rotation(sector));
        let turn = to * from.inverse();
        let there = turn * Point3::from(first.gouge.point);
        assert!((there - Point3::from(report.gouge.point)).norm() < ROUNDING, "{}", report.surface);
        // The move that is named is the one that is nearest there.
        let (at, first_at) = (report.gouge.at.unwrap(), first.gouge.at.unwrap());
        let tip = |at: At| {
            let joints = &motion.operations[at.operation as usize].moves[at.index as usize].joints;
            program.machine.forward(joints).tip
        };
        assert!((turn * tip(first_at) - tip(at)).norm() < ROUNDING, "{}: {at:?} {first_at:?}", report.surface);
    }
    assert_eq!(proofs.proved().count() * vanes as usize, proofs.surfaces[0].len());
}

/// The sectors of a text are the same within the steps of its words: all but a few surfaces follow, with bounds that hold, and a
/// block that is moved by 2 um is found.
#[test]
fn sectors_of_a_text_follow_within_the_rounding_of_its_words() {
    let (program, motion) = &*WHEEL;
    let control = &program.post.control;
    assert_eq!(control.decimals.length, 4);
    let rounding = PartnerRounding::of_words(control);
    let mut text = motion.clone();
    let words = |p: Point3<f64>| p.map(|x| (x * 1e4).round() / 1e4);
    for m in text.operations.iter_mut().flat_map(|o| &mut o.moves) {
        let pose = program.machine.forward(&m.joints);
        let rotary = m.joints.rotary.map(|angle| ((angle.to_degrees() * 1e5).round() / 1e5).to_radians());
        m.joints = program.machine.joints(&words(pose.tip), rotary);
    }
    // By a quarter turn the rounding is the same, and no other turn is the same to the arithmetic.
    let exact = Proofs::new(program, &text).proved().count();
    let proofs = Proofs::rounded(program, &text, rounding);
    proofs.agree();
    let (proved, all) = (proofs.proved().count(), proofs.surfaces[0].len());
    println!("{proved} of {all} surfaces are proved by themselves, {exact} without the rounding");
    assert!(4 * proved < all && proved < exact, "{proved} and {exact} of {all}");
    let (sector, size) = (4, 2e-3);
    let cuts: Vec<usize> = in_sector(&text, sector);
    let block = cuts[cuts.len() / 4];
    let pose = program.machine.forward(&text.operations[FLANK].moves[block].joints);
    let normal = normal_near(&(pose.tip + pose.axis * 1.0));
    let moves = &mut text.operations[FLANK].moves;
    moves[block] = posed(program, &moves[block], &Rotation3::identity(), -normal * size);
    let changed = Proofs::rounded(program, &text, rounding);
    changed.agree();
    let depth = |proofs: &Proofs| {
        let own = proofs.surfaces[0].iter().filter(|s| s.id.sector == sector);
        own.map(|s| s.gouge.depth.get()).fold(0.0, f64::max)
    };
    println!("deepest cut in sector {}: {} mm, before {} mm", sector + 1, depth(&changed), depth(&proofs));
    assert!(depth(&changed) > depth(&proofs) + 0.3 * size);
    assert!(changed.surfaces[0].iter().any(|s| s.id.sector == sector && s.follows.is_none()));
}

/// Feeds and times of all sectors but the first and last are the same to the last digit: their axes run alike from rest to rest.
#[test]
fn sectors_that_run_alike_have_the_same_feeds() {
    let (program, motion) = &*WHEEL;
    let (mut all, mut repeated) = (0, 0);
    for (o, operation) in motion.operations.iter().enumerate() {
        let rests: Vec<usize> = (0..operation.moves.len()).filter(|i| operation.rests_before(*i)).collect();
        let run = dynamics::run(program, motion, o, &[]);
        // Runs between rests, by their number of moves and the feeds and times of these.
        let mut alike: BTreeMap<String, usize> = BTreeMap::new();
        for pair in rests.windows(2) {
            let moves = &operation.moves[pair[0]..pair[1]];
            let feeds: Vec<_> = moves.iter().map(|m| (m.kind, m.feed)).collect();
            let times = &run.move_times[pair[0]..pair[1]];
            *alike.entry(format!("{feeds:?} {times:?}")).or_default() += 1;
        }
        all += rests.len();
        repeated += alike.values().filter(|count| **count > 1).sum::<usize>();
    }
    println!("{all} runs from rest to rest, {repeated} of them alike");
    assert!(all > 100 && 10 * repeated > 8 * all, "{repeated} of {all}");
}

/// Joints of a move, with the pose turned about the axis of the part and the tip moved.
pub(crate) fn posed(program: &Program, from: &JointMove, turn: &Rotation3<f64>, by: Vector3<f64>) -> JointMove {
    let pose = program.machine.forward(&from.joints);
    let [first, second] = from.joints.rotary;
    let branches = [0, 1].map(|branch| program.machine.chain.unwound(&(turn * pose.axis), branch, second));
    let rotary = branches.into_iter().min_by(|a, b| (a[0] - first).abs().total_cmp(&(b[0] - first).abs())).unwrap();
    JointMove { joints: program.machine.joints(&(turn * pose.tip + by), rotary), ..*from }
}

/// The flank operation of the wheel.
const FLANK: usize = 1;

/// The moves of the flank operation in a sector.
fn in_sector(motion: &Motion, sector: u32) -> Vec<usize> {
    of_sector(&motion.operations[FLANK], sector)
}

/// The moves of an operation in a sector: those of its passes.
pub(crate) fn of_sector(operation: &MotionOperation, sector: u32) -> Vec<usize> {
    let prefix = format!("sector {} ", sector + 1);
    let own = |k: &usize| operation.labels[operation.moves[*k].pass as usize].starts_with(&prefix);
    (1..operation.moves.len()).filter(own).collect()
}

/// The normal of the part at the place nearest to a point.
fn normal_near(point: &Point3<f64>) -> Vector3<f64> {
    static SAMPLES: LazyLock<Vec<Sample>> = LazyLock::new(|| sample::sample(&WHEEL.0.part, 2.0 * SPACING));
    let distance = |s: &&Sample| (s.position - point).norm();
    SAMPLES.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap().normal
}

/// The surface with the deepest cut, by the proof with partners.
fn deepest(proofs: &Proofs) -> &SurfaceReport {
    proofs.surfaces[0].iter().max_by(|a, b| a.gouge.depth.get().total_cmp(&b.gouge.depth.get())).unwrap()
}

/// Whether surfaces of a sector were proved by themselves, and others only in the first sector and beside this one: in a channel
/// between two sectors a cutter is near surfaces of both.
fn is_proved_beside(proofs: &Proofs, sector: u32) -> bool {
    let vanes = WHEEL.0.part.vane_count;
    let beside = [proofs.first(), sector, (sector + 1) % vanes, (sector + vanes - 1) % vanes];
    let alone = |s: u32| proofs.proved().any(|report| report.id.sector == s);
    alone(sector) && (0..vanes).all(|s| beside.contains(&s) || !alone(s))
}

/// A block of one sector that goes 2 um to 1 mm into its face is found with its size, in its sector, at the block; the other
/// sectors follow as before.
#[test]
fn a_moved_block_is_found_in_its_sector() {
    let (program, motion) = &*WHEEL;
    for (sector, size) in [(0, 0.05), (4, 0.002), (4, 1.0), (7, 0.05)] {
        let cuts: Vec<usize> = in_sector(motion, sector);
        let cut = |k: &&usize| motion.operations[FLANK].moves[**k].kind == MoveKind::Cut;
        let cuts: Vec<usize> = cuts.iter().filter(cut).copied().collect();
        // In the middle of a pass along the pressure face.
        let block = cuts[cuts.len() / 4];
        let pose = program.machine.forward(&motion.operations[FLANK].moves[block].joints);
        let normal = normal_near(&(pose.tip + pose.axis * 1.0));
        let mut changed = motion.clone();
        let moves = &mut changed.operations[FLANK].moves;
        moves[block] = posed(program, &moves[block], &Rotation3::identity(), -normal * size);
        let proofs = Proofs::new(program, &changed);
        proofs.agree();
        let found = deepest(&proofs);
        println!("sector {}, {size} mm: {} {:?}", sector + 1, found.surface, found.gouge);
        assert_eq!(found.id.sector, sector, "{}", found.surface);
        let depth = found.gouge.depth.get();
        assert!(depth > 0.5 * size && depth < 1.1 * size + 2e-3, "{:?}", found.gouge);
        let index = found.gouge.at.unwrap().index as usize;
        assert!(index == block || index == block + 1, "{index} {block}");
        assert!(sector == CLEAN.first() || is_proved_beside(&proofs, sector));
    }
}

/// A sector that is turned by 0.01 deg is found in this sector alone, as deep as its radius and the angle say.
#[test]
fn a_turned_sector_is_found() {
    let (program, motion) = &*WHEEL;
    let angle = 0.01_f64.to_radians();
    let mut changed = motion.clone();
    for block in in_sector(motion, 4) {
        let moves = &mut changed.operations[FLANK].moves;
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), angle);
        moves[block] = posed(program, &moves[block], &turn, Vector3::zeros());
    }
    let proofs = Proofs::new(program, &changed);
    proofs.agree();
    let found = deepest(&proofs);
    println!("{} {:?}", found.surface, found.gouge);
    let reach = angle * Point3::from(found.gouge.point).xy().coords.norm();
    assert_eq!(found.id.sector, 4, "{}", found.surface);
    assert!(
        found.gouge.depth.get() > 0.3 * reach && found.gouge.depth.get() < reach + 2e-3,
        "{:?} {reach}",
        found.gouge
    );
    assert!(is_proved_beside(&proofs, 4));
}

/// A sector that is left out is not machined, and its neighbours follow where its moves do not reach them.
#[test]
fn a_sector_that_is_left_out_is_found() {
    let (program, motion) = &*WHEEL;
    let mut changed = motion.clone();
    let left_out = in_sector(motion, 4);
    let mut index = 0;
    changed.operations[FLANK].moves.retain(|_| {
        index += 1;
        !left_out.contains(&(index - 1))
    });
    let proofs = Proofs::new(program, &changed);
    proofs.agree();
    let worst = |sector: u32| {
        let faces =
            proofs.surfaces[0].iter().filter(|s| s.id.sector == sector && matches!(s.id.kind, SurfaceKind::Face(_)));
        faces.map(|s| s.excess.value.get()).fold(0.0, f64::max)
    };
    assert!(worst(4) > 0.1 && (0..8).filter(|s| *s != 4).all(|s| worst(s) < 0.01));
}

/// Of a wheel of which sectors 1 to 4 are machined, the sectors between the first and the last of them follow from one.
#[test]
fn sectors_of_a_wheel_that_is_machined_in_part_follow() {
    let (program, motion) = &*WHEEL;
    let mut changed = motion.clone();
    for operation in &mut changed.operations {
        let left_out: Vec<usize> = (4..8).flat_map(|sector| of_sector(operation, sector)).collect();
        let mut index = 0;
        operation.moves.retain(|_| {
            index += 1;
            !left_out.contains(&(index - 1))
        });
    }
    let proofs = Proofs::new(program, &changed);
    proofs.agree();
    let of_face = |s: &&SurfaceReport| matches!(s.id.kind, SurfaceKind::Face(_)) && s.is_machined();
    let faces: Vec<&SurfaceReport> = proofs.surfaces[0].iter().filter(of_face).collect();
    let following = faces.iter().filter(|s| s.follows.is_some()).count();
    println!("{} faces are machined, {following} follow", faces.len());
    assert!(faces.len() >= 8 && following >= 2, "{following} of {}", faces.len());
}

/// The order of the sectors does not count for what is proved of surfaces.
#[test]
fn exchanged_sectors_prove_the_same() {
    let (program, motion) = &*WHEEL;
    let mut changed = motion.clone();
    let [second, sixth] = [1, 5].map(|sector| in_sector(motion, sector));
    assert_eq!(second.len(), sixth.len());
    for (a, b) in second.iter().zip(&sixth) {
        changed.operations[FLANK].moves.swap(*a, *b);
    }
    let proofs = Proofs::new(program, &changed);
    proofs.agree();
    for (a, b) in proofs.surfaces[0].iter().zip(&CLEAN.surfaces[0]) {
        assert!((a.excess.value.get() - b.excess.value.get()).abs() < surface::SLACK, "{}", a.surface);
    }
}
