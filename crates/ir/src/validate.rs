//! Checks of each stage value. In debug builds, and so in tests, [`plan::passes::pipeline`] runs them after every
//! pass; a failed check is a fault of the compiler, never of a job.

use super::{CcPlan, ClPlan, Drive, Motion, MoveKind, Operation, OperationId, OperationKind, Program};
use base::entity::EntityId;
use nalgebra::{Point3, Vector3};
use wheel::operation::word;
use wheel::part::FaceId;

/// Largest difference of the length of a unit vector from one: rounding of a few rotations and blends.
const UNIT: f64 = 1e-9;

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
    (v.norm() - 1.0).abs() < UNIT
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
    for (id, operation) in program.operations.iter() {
        let name = &operation.name;
        check(operation.tool.index() < program.tools.len(), || format!("{id} `{name}` has no tool"))?;
        let sizes = [operation.speed.get(), operation.feed.get(), operation.link_feed.get()];
        check(sizes.iter().all(|x| x.is_finite() && *x > 0.0), || format!("`{name}` has the speeds {sizes:?}"))?;
        let sectors = &operation.sectors;
        check(sectors.iter().all(|s| *s < part.vane_count), || format!("`{name}` is in the sectors {sectors:?}"))?;
        check(sectors.windows(2).all(|w| w[0] < w[1]), || format!("sectors of `{name}` do not ascend: {sectors:?}"))?;
        let known = |face: &FaceId| face.blade.index() < part.blades.len();
        let fits = match &operation.kind {
            OperationKind::Flank { faces, .. } => !faces.is_empty() && faces.iter().all(known),
            OperationKind::Point { surfaces, .. } => {
                !surfaces.is_empty()
                    && surfaces.iter().all(|s| word(*s).is_some_and(|w| w.2.index() < part.blades.len()))
            }
            _ => true,
        };
        check(fits, || format!("`{name}` finishes no surface of the part"))?;
    }
    for contract in &program.contracts {
        let known = contract.scope.operations.iter().all(|o| o.index() < program.operations.len());
        check(known, || format!("a contract on {} names an operation that is not there", contract.kind.name()))?;
    }
    Ok(())
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
            let driven = match (&operation.kind, pass.drive) {
                (
                    OperationKind::Groove { .. }
                    | OperationKind::Expand { .. }
                    | OperationKind::Rough { .. }
                    | OperationKind::Plunge { .. },
                    Drive::Channel,
                )
                | (OperationKind::Channel { .. }, Drive::Hub(_) | Drive::HubWithLead(..))
                | (OperationKind::Point { .. }, Drive::Round(_)) => true,
                (OperationKind::Flank { faces, .. }, Drive::Face { side, .. }) => faces.contains(&side),
                (OperationKind::Point { surfaces, .. }, Drive::Contact(kind)) => surfaces.contains(&kind),
                _ => false,
            };
            check(driven, || format!("{} is driven by {:?}", at(), pass.drive))?;
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
            for (i, p) in pass.points.iter().enumerate() {
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
