//! Checks of each stage value. In debug builds, and so in tests, `plan::passes::pipeline` runs them after every
//! pass; a failed check is a fault of the compiler, never of a job.

use super::{
    CcPlan, ClPlan, Contract, Drive, Motion, MoveKind, Operation, OperationId, OperationKind, Program, SplineBlock,
    Tolerances,
};
use base::entity::EntityId;
use base::units::Mm3PerMin;
use five_axis::Machine;
use nalgebra::{Point3, Vector3};
use wheel::control::Decimals;
use wheel::operation::word;
use wheel::part::{FaceId, PassageId, SurfaceKind};

/// Largest difference of the length of a unit vector from one: rounding of a few rotations and blends.
const UNIT_LENGTH_ROUNDING: f64 = 1e-9;

/// Reason why a stage value is malformed: the place and the fault.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Malformed(pub String);

impl std::fmt::Display for Malformed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

/// Which passes have run over a [`ClPlan`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClStage {
    /// Passes of sector 0 have axes.
    Oriented,
    /// The passes exist in every sector of their operation.
    InSectors,
}

fn check(holds: bool, what: impl FnOnce() -> String) -> Result<(), Malformed> {
    if holds { Ok(()) } else { Err(Malformed(what())) }
}

fn finite(p: &Point3<f64>) -> bool {
    p.iter().all(|x| x.is_finite())
}

fn is_unit(v: &Vector3<f64>) -> bool {
    (v.norm() - 1.0).abs() < UNIT_LENGTH_ROUNDING
}

/// Checks the program: every reference names an existing entity; sizes and speeds are possible.
///
/// # Errors
/// The first fault.
pub fn program(program: &Program) -> Result<(), Malformed> {
    let part = &program.part;
    check(!part.blades.is_empty() && part.vane_count >= 2, || "the part has no blades or no sectors".to_owned())?;
    for face in part.faces() {
        check(part.face(face).orientation.abs() == 1.0, || format!("{face:?} has no outside"))?;
    }
    check(
        program.stock.profile.len() > 2 && program.stock.profile.as_flattened().iter().all(|x| x.is_finite()),
        || "the stock has no profile".to_owned(),
    )?;
    machine(&program.machine)?;
    sizes(program)?;
    for (id, operation) in program.operations.iter() {
        let name = &operation.name;
        check(operation.tool.index() < program.tools.len(), || format!("{id} `{name}` has no tool"))?;
        let sizes = [operation.speed.get(), operation.feed.get(), operation.link_feed.get()];
        check(sizes.iter().all(|x| x.is_finite() && *x > 0.0), || format!("`{name}` has the speeds {sizes:?}"))?;
        let sectors = &operation.sectors;
        check(sectors.iter().all(|s| *s < part.vane_count), || format!("`{name}` is in the sectors {sectors:?}"))?;
        check(sectors.windows(2).all(|w| w[0] < w[1]), || format!("sectors of `{name}` do not ascend: {sectors:?}"))?;
        let long_face = |face: &FaceId| face.edge_end().is_none() && part.has_face(*face);
        let surface = |surface: &SurfaceKind| match surface {
            SurfaceKind::Face(face) => long_face(face),
            SurfaceKind::Fillet(face) => part.has_face(*face),
            other => word(*other).is_some_and(|w| w.2.index() < part.blades.len()),
        };
        let fits = match &operation.kind {
            OperationKind::Flank { faces, .. } => !faces.is_empty() && faces.iter().all(long_face),
            OperationKind::Point { surfaces, .. } => !surfaces.is_empty() && surfaces.iter().all(surface),
            OperationKind::Roughing { .. } | OperationKind::Channel { .. } => true,
        };
        check(fits, || format!("`{name}` finishes no surface of the part"))?;
    }
    let contracts = program.contracts.iter().map(|contract| (contract.kind, &contract.scope));
    for (kind, scope) in contracts.chain(program.allowed.iter().map(|allowed| (allowed.kind, &allowed.scope))) {
        let known = scope.operations.iter().all(|o| o.index() < program.operations.len());
        check(known, || format!("a contract on {} names an operation that is not there", kind.name()))?;
    }
    for contract in &program.contracts {
        let Contract { kind, bound, .. } = contract;
        let sound = bound.value().is_finite() && bound.unit() == kind.bound(0.0).unit();
        check(sound, || format!("the bound on {} is {bound:?}", kind.name()))?;
    }
    Ok(())
}

/// Checks that all limits of a machine are possible.
fn machine(machine: &Machine) -> Result<(), Malformed> {
    let Machine { linear, rotary, retract, spindle, rapid, cycle, power, .. } = machine;
    let positive = |x: &f64| x.is_finite() && *x > 0.0;
    for axis in linear {
        let moves = positive(&axis.speed) && positive(&axis.acceleration) && axis.jerk > 0.0;
        check(moves && axis.min <= axis.max, || format!("a linear axis has the limits {axis:?}"))?;
    }
    for axis in rotary {
        let moves = positive(&axis.speed) && positive(&axis.acceleration) && axis.jerk > 0.0;
        let sound = moves && axis.min <= axis.max && axis.word_sign.abs() == 1.0;
        check(sound, || format!("a rotary axis has the limits {axis:?}"))?;
    }
    let sound = retract.is_finite() && spindle.iter().chain([rapid, cycle]).chain(power).all(positive);
    check(sound, || format!("machine `{}` has a size that is not positive", machine.name))?;
    for solid in &machine.carried {
        let sound = solid.profile.len() > 1 && solid.profile.as_flattened().iter().all(|x| x.is_finite());
        check(sound, || format!("the {} of the machine has no outside", solid.kind.name()))?;
    }
    Ok(())
}

/// Checks tools, tolerances, digits of words, and the points of the data.
fn sizes(program: &Program) -> Result<(), Malformed> {
    /// Most digits behind the point: more than any number of a text has.
    const MOST_DIGITS: usize = 17;
    let positive = |x: f64| x.is_finite() && x > 0.0;
    for (_, tool) in program.tools.iter() {
        let given = [Some(tool.max_chip.get()), Some(tool.max_depth.get()), tool.max_rate.map(Mm3PerMin::get)];
        let sound = given.into_iter().flatten().all(positive) && tool.ramp.get() >= 0.0 && tool.flutes > 0;
        check(sound, || format!("tool `{}` has a size that is not positive", tool.name))?;
    }
    let Tolerances { chord, chord_rough } = program.tolerances;
    let sound = [chord.get(), chord_rough.get(), program.memory].into_iter().all(positive);
    check(sound && program.clearance.get() >= 0.0, || "a tolerance is not positive".to_owned())?;
    let Decimals { length, angle, vector, feed } = program.control().decimals;
    check([length, angle, vector, feed].iter().all(|digits| *digits <= MOST_DIGITS), || {
        format!("words have {:?}", program.control().decimals)
    })?;
    check(program.control().orientation_tolerance.is_none_or(positive), || {
        "an orientation tolerance is not positive".to_owned()
    })?;
    let part = &program.part;
    let known = program.data.iter().all(|curve| part.has_face(curve.side))
        && program.stated.iter().all(|stated| stated.blade.index() < part.blades.len());
    check(known, || "points are those of a blade that is not there".to_owned())?;
    let points = program.data.iter().flat_map(|curve| curve.points.iter().map(|point| &point.point));
    let sound = points.chain(program.stated.iter().flat_map(|stated| &stated.points)).all(finite);
    check(sound, || "a point of the data is not finite".to_owned())
}

/// Checks that the operations of a plan are those of the program, in their order.
fn in_order(program: &Program, found: impl Iterator<Item = OperationId>, what: &str) -> Result<(), Malformed> {
    let found: Vec<OperationId> = found.collect();
    let meant: Vec<OperationId> = program.operations.ids().collect();
    check(found == meant, || format!("{what} has the operations {found:?} where the program has {meant:?}"))
}

/// Checks the contact plan: every pass lies on a surface that its operation makes.
///
/// # Errors
/// The first fault.
pub fn cc(program: &Program, plan: &CcPlan) -> Result<(), Malformed> {
    in_order(program, plan.operations.iter().map(|o| o.operation), "the contact plan")?;
    for planned in &plan.operations {
        let operation = &program.operations[planned.operation];
        for pass in &planned.passes {
            let at = || format!("pass `{}` of `{}`", pass.label, operation.name);
            check(pass.points.len() > 1, || format!("{} has {} points", at(), pass.points.len()))?;
            let driven = match &operation.kind {
                OperationKind::Roughing { .. } => pass.drive == Drive::Channel,
                OperationKind::Channel { .. } => matches!(pass.drive, Drive::Hub(_) | Drive::HubWithLead(..)),
                OperationKind::Flank { faces, .. } => {
                    matches!(pass.drive, Drive::Face { side, .. } if faces.contains(&side))
                }
                OperationKind::Point { surfaces, .. } => match pass.drive {
                    Drive::Round(_) => true,
                    Drive::Contact(kind) => surfaces.contains(&kind),
                    Drive::Channel | Drive::Face { .. } | Drive::Hub(_) | Drive::HubWithLead(..) => false,
                },
            };
            let passage = |id: PassageId| id.index() < program.part.blades.len();
            let there = match pass.drive {
                Drive::Hub(id) => passage(id),
                Drive::HubWithLead(id, lead) => passage(id) && lead.is_finite(),
                Drive::Round(blade) => blade.index() < program.part.blades.len(),
                Drive::Channel | Drive::Face { .. } | Drive::Contact(_) => true,
            };
            check(driven && there, || format!("{} is driven by {:?}", at(), pass.drive))?;
            check(pass.path.is_none() || matches!(pass.drive, Drive::Face { .. }), || {
                format!("{} has a path of its axis", at())
            })?;
            for (i, p) in pass.points.iter().enumerate() {
                // On the leads of a pass that was computed as a whole path the cutter touches nothing.
                let lead = pass.path.is_some() && !(0.0..=1.0).contains(&p.u) && p.normal == Vector3::zeros();
                let sound = finite(&p.position) && (is_unit(&p.normal) || lead);
                let sound = sound && [p.u, p.v, p.w].iter().all(|x| x.is_finite());
                check(sound, || format!("point {i} of {} is {p:?}", at()))?;
            }
        }
    }
    Ok(())
}

/// Checks the location plan after some of its passes.
///
/// # Errors
/// The first fault.
pub fn cl(program: &Program, plan: &ClPlan, stage: ClStage) -> Result<(), Malformed> {
    in_order(program, plan.operations.iter().map(|o| o.operation), "the location plan")?;
    for planned in &plan.operations {
        let Operation { name, sectors, .. } = &program.operations[planned.operation];
        for pass in &planned.passes {
            let there = if stage == ClStage::Oriented { pass.sector == 0 } else { sectors.contains(&pass.sector) };
            check(there, || format!("pass `{}` of `{name}` is in sector {}", pass.label, pass.sector))?;
            let air = pass.air.iter().all(|i| *i < pass.points.len()) && pass.air.windows(2).all(|w| w[0] < w[1]);
            check(air, || format!("pass `{}` of `{name}` cuts air at stations that are not there", pass.label))?;
            for (i, p) in pass.points.iter().chain(pass.link.iter().flatten()).enumerate() {
                let sound = finite(&p.tip) && is_unit(&p.axis) && p.contact.is_none_or(|c| finite(&c));
                check(sound, || format!("point {i} of pass `{}` of `{name}` is {p:?}", pass.label))?;
            }
        }
    }
    Ok(())
}

/// Checks the motion: a station at retract height before the first move and after the last, possible positions and
/// times, and a feed wherever a move needs one.
///
/// # Errors
/// The first fault.
pub fn motion(program: &Program, motion: &Motion) -> Result<(), Malformed> {
    in_order(program, motion.operations.iter().map(|o| o.operation), "the motion")?;
    for made in &motion.operations {
        let operation = &program.operations[made.operation];
        let name = &operation.name;
        let (machine, length) = (&program.machine, program.tools[operation.tool].length());
        for (i, m) in made.moves.iter().enumerate() {
            let at = || format!("move {i} of `{name}` is {m:?}");
            let sound = m.joints.all().iter().all(|x| x.is_finite()) && m.time.is_finite() && m.time >= 0.0;
            check(sound && (m.pass as usize) < made.labels.len(), at)?;
            check(m.feed.is_none() == (m.kind == MoveKind::Rapid), at)?;
            check(m.feed.is_none_or(|f| f.is_finite() && f > 0.0), at)?;
        }
        splines(&made.splines, made.moves.len()).map_err(|fault| Malformed(format!("{fault} in `{name}`")))?;
        // Links belong to the pass of the next cut.
        let cuts = made.moves.iter().filter(|m| m.kind == MoveKind::Cut).map(|m| m.pass);
        check(cuts.is_sorted(), || format!("`{name}` does not cut its passes in their order"))?;
        for m in [made.moves.first(), made.moves.last()].into_iter().flatten() {
            let aloft = m.kind == MoveKind::Rapid && m.joints == machine.at_height(&m.joints, machine.retract, length);
            check(aloft, || format!("`{name}` does not begin and end at retract height: {m:?}"))?;
        }
    }
    Ok(())
}

/// Checks that spline blocks have chords among so many moves, in their order.
fn splines(blocks: &[SplineBlock], moves: usize) -> Result<(), Malformed> {
    for (k, SplineBlock { first, last, shares, .. }) in blocks.iter().enumerate() {
        let behind = k.checked_sub(1).is_none_or(|before| blocks[before].last < *first);
        let chords = behind && first <= last && *last < moves && shares.len() == last - first + 1;
        let ascending = shares.first().is_some_and(|share| *share > 0.0) && shares.windows(2).all(|w| w[0] < w[1]);
        check(chords && ascending && shares.last() == Some(&1.0), || {
            format!("spline block {k} has the chords {first} to {last} at the shares {shares:?}")
        })?;
    }
    Ok(())
}
