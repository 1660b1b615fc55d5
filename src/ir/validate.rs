//! What must be true of each stage value. In debug builds, and so in tests, [`crate::passes::pipeline`] asks after every
//! pass; a fault is one of the compiler, never of a job.

use super::{CcPlan, ClPlan, Drive, Motion, MoveKind, Operation, OperationId, OperationKind, Program};
use crate::entity::EntityId;
use crate::operation::word;
use crate::part::FaceId;
use nalgebra::{Point3, Vector3};

/// Largest distance of the length of a unit vector from one: some rounding of turns and blends.
const UNIT: f64 = 1e-9;

/// Why a stage value is malformed: the place and what is wrong there.
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
    /// The passes are there in every sector of their operation.
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

/// The program: every reference leads somewhere, sizes and speeds can be.
///
/// # Errors
/// What is malformed.
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

/// Operations of a plan are those of the program, in their order.
fn in_order(program: &Program, found: impl Iterator<Item = OperationId>, what: &str) -> Result<(), Malformed> {
    let found: Vec<OperationId> = found.collect();
    let meant: Vec<OperationId> = program.operations.ids().collect();
    check(found == meant, || format!("{what} has the operations {found:?} where the program has {meant:?}"))
}

/// The contact plan: every pass lies on a surface that its operation makes.
///
/// # Errors
/// What is malformed.
pub fn cc(program: &Program, plan: &CcPlan) -> Result<(), Malformed> {
    in_order(program, plan.operations.iter().map(|o| o.operation), "the contact plan")?;
    for planned in &plan.operations {
        let operation = &program.operations[planned.operation];
        for pass in &planned.passes {
            let at = || format!("pass `{}` of `{}`", pass.label, operation.name);
            check(pass.points.len() > 1, || format!("{} has {} points", at(), pass.points.len()))?;
            let driven = match (&operation.kind, pass.drive) {
                (OperationKind::Groove { .. } | OperationKind::Expand { .. }, Drive::Channel)
                | (OperationKind::Channel { .. }, Drive::Hub)
                | (OperationKind::Point { .. }, Drive::Round) => true,
                (OperationKind::Flank { faces, .. }, Drive::Face { side, .. }) => faces.contains(&side),
                (OperationKind::Point { surfaces, .. }, Drive::Contact(kind)) => surfaces.contains(&kind),
                _ => false,
            };
            check(driven, || format!("{} is driven by {:?}", at(), pass.drive))?;
            check(pass.path.is_none() || matches!(pass.drive, Drive::Face { .. }), || {
                format!("{} has a path of its axis", at())
            })?;
            for (i, p) in pass.points.iter().enumerate() {
                // The cutter touches nothing on the leads of a path that was found as a whole.
                let lead = pass.path.is_some() && !(0.0..=1.0).contains(&p.u) && p.normal == Vector3::zeros();
                let sound = finite(&p.position) && (is_unit(&p.normal) || lead);
                let sound = sound && [p.u, p.v, p.w].iter().all(|x| x.is_finite());
                check(sound, || format!("point {i} of {} is {p:?}", at()))?;
            }
        }
    }
    Ok(())
}

/// The location plan after some of its passes.
///
/// # Errors
/// What is malformed.
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

/// The motion: one station at retract height before the first move and one behind the last, positions and times that can
/// be, feeds where there must be feeds.
///
/// # Errors
/// What is malformed.
pub fn motion(program: &Program, motion: &Motion) -> Result<(), Malformed> {
    in_order(program, motion.operations.iter().map(|o| o.operation), "the motion")?;
    for made in &motion.operations {
        let operation = &program.operations[made.operation];
        let name = &operation.name;
        let height = program.machine.retract - program.tools[operation.tool].length();
        for (i, m) in made.moves.iter().enumerate() {
            let at = || format!("move {i} of `{name}` is {m:?}");
            let sound = m.joints.all().iter().all(|x| x.is_finite()) && m.time.is_finite() && m.time >= 0.0;
            check(sound && (m.pass as usize) < made.labels.len(), at)?;
            check(m.feed.is_none() == (m.kind == MoveKind::Rapid), at)?;
            check(m.feed.is_none_or(|f| f.is_finite() && f > 0.0), at)?;
        }
        // Links lead to the pass of the cut that follows.
        let cuts = made.moves.iter().filter(|m| m.kind == MoveKind::Cut).map(|m| m.pass);
        check(cuts.is_sorted(), || format!("`{name}` does not cut its passes in their order"))?;
        for m in [made.moves.first(), made.moves.last()].into_iter().flatten() {
            let aloft = m.kind == MoveKind::Rapid && m.joints.xyz.z == height;
            check(aloft, || format!("`{name}` does not begin and end at retract height: {m:?}"))?;
        }
    }
    Ok(())
}
