//! Links of finishing through the air of the simulated stock.

use crate::support::jobs;
use impellerc::base::entity::PrimaryMap;
use impellerc::base::units::Mm;
use impellerc::diagnostics::Sink;
use impellerc::ir::{Motion, MotionOperation, MoveKind, OperationKind, Program};
use impellerc::plan::passes::pipeline;
use impellerc::tool_stock::collide::{Cloud, ToolSolid};
use impellerc::verify::clearance::{self, ToolPart};
use impellerc::verify::proof::piece;
use impellerc::wheel::part::sample;
use std::collections::BTreeSet;

fn planned(program: &Program) -> Motion {
    let mut sink = Sink::default();
    pipeline::run(program, &mut sink).unwrap_or_else(|_| panic!("{:?}", sink.diags())).motion
}

/// Passes that the tool reaches from the pass before without a rapid.
fn joined(operation: &MotionOperation) -> BTreeSet<u32> {
    let (_, moves) = operation.moves.split_last().unwrap();
    let by_rapid: BTreeSet<u32> = moves.iter().filter(|m| m.kind == MoveKind::Rapid).map(|m| m.pass).collect();
    (0..operation.labels.len() as u32).filter(|pass| !by_rapid.contains(pass)).collect()
}

/// Least distance of a part of the tool to the part over all links of an operation, mm.
fn least(program: &Program, motion: &Motion, at: usize, of: fn(&ToolSolid, f64, f64) -> f64) -> f64 {
    const SPACING: f64 = 0.1;
    const FAR: f64 = 3.0;
    let cloud = Cloud::new(sample::cloud_points(&sample::sample(&program.part, SPACING)));
    let all = piece::pieces(&program.machine, motion, at);
    let links: Vec<piece::Piece> = all.into_iter().filter(|p| p.kind == MoveKind::Link).collect();
    let solid = &program.tools[program.operations[motion.operations[at].operation].tool].solid;
    let part = ToolPart::new(solid, of);
    clearance::least(&links, &part, &cloud, SPACING * std::f64::consts::FRAC_1_SQRT_2, FAR)
        .map_or(FAR, |c| c.found.get())
}

/// The small job, whose floor in two sectors follows the simulated stock, or none of whose operations does.
fn small(follows: bool) -> Program {
    let mut program = jobs::program("small", None);
    let operations: Vec<_> = program.operations.iter().map(|(_, o)| o.clone()).collect();
    program.operations = PrimaryMap::new();
    for mut operation in operations {
        operation.sectors = vec![0, 1];
        if matches!(operation.kind, OperationKind::Channel { .. }) && follows {
            operation.rest = Some(Mm(0.1));
        }
        program.operations.push(operation);
    }
    program
}

#[test]
fn the_tool_goes_from_face_to_face_through_the_air_of_the_stock() {
    let [known, unknown] = [true, false].map(small);
    let [with, without] = [&known, &unknown].map(planned);
    let flank = 1;
    let [new, old] = [&with, &without].map(|motion| joined(&motion.operations[flank]));
    let labels = &with.operations[flank].labels;
    println!("{:?} and {:?}", new.iter().map(|p| &labels[*p as usize]).collect::<Vec<_>>(), old);
    // From the pressure to the suction face of both blades, round their edges.
    let round: Vec<u32> =
        (0..labels.len() as u32).filter(|p| labels[*p as usize].ends_with("suction strip 10")).collect();
    assert_eq!(round.len(), 2);
    assert!(round.iter().all(|pass| new.contains(pass) && !old.contains(pass)), "{new:?} {old:?}");
    // By the means of the verifier: clear of the part, and of the stock in smaller cells than those of the planner.
    assert!(least(&known, &with, flank, ToolSolid::body_distance) >= 0.5);
    assert!(least(&known, &with, flank, ToolSolid::cutter_distance) >= 0.1);
    let (report, _) = jobs::simulated(&known, &with, 0.2);
    for operation in &report.operations {
        println!("{} mm3 by links, {} collisions", operation.by_links.get(), operation.collisions.len());
    }
    assert!(report.operations[flank].collisions.is_empty());
    assert_eq!(report.operations[flank].by_links.get(), 0.0);
}
