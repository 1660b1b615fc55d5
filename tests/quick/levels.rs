//! `order levels`: both faces of a blade are finished to one depth before any goes deeper.

use crate::support;
use crate::support::squares::{nearest, squares};
use impellerc::base::entity::PrimaryMap;
use impellerc::base::units::Mm;
use impellerc::diagnostics::Sink;
use impellerc::ir::{MoveKind, OperationKind, Program};
use impellerc::plan::passes::pipeline;
use impellerc::tool_stock::collide::Cutter;
use impellerc::wheel::method::{AxisMethod, FaceOrder, Flank, FlankMethod, Lines, Milling};
use impellerc::wheel::part::{BladeId, Surface, SurfaceKind};

/// Sectors of the programs, and samples along and across a face.
const SECTORS: [u32; 2] = [0, 3];
const GRID: [usize; 2] = [200, 60];

fn program(kind: OperationKind) -> Program {
    let mut program = support::wei_program(&[0]);
    (program.tools, program.operations) = (PrimaryMap::new(), PrimaryMap::new());
    let tool = program.tools.push(support::tool("t1", 1, Cutter::ball(2.0), 30.0, 45.0));
    program.operations.push(support::operation(kind.keyword(), kind, tool, SECTORS.to_vec(), 6.0));
    program
}

/// How far the depth on one face runs ahead of the other face of the same blade, at worst, as shares of the height; and
/// the number of changes from face to face. The depth comes from the tips of the motion alone: the least height over the
/// hub at which the centre of the ball has been beside a face.
fn ahead(program: &Program) -> (f64, usize) {
    let mut sink = Sink::default();
    let plan = pipeline::run(program, &mut sink).unwrap_or_else(|_| panic!("{:?}", sink.diags()));
    let part = &program.part;
    let mut samples = Vec::new();
    for (sector, turns) in SECTORS.iter().enumerate() {
        let turn = part.sector_rotation(*turns);
        for (face, id) in BladeId::MAIN.faces().into_iter().enumerate() {
            // Without both ends of the face.
            samples.extend(squares([GRID[0] - 2, GRID[1]], |i, j| {
                let [u, v] = [(i + 1) as f64 / GRID[0] as f64, j as f64 / GRID[1] as f64];
                ((sector, face, v), turn * part.face(id).surface.point(u, v))
            }));
        }
    }
    let mut lowest = [[1.0_f64; 2]; 2];
    let (mut worst, mut changes, mut on) = (0.0_f64, 0, None);
    for pair in plan.motion.operations[0].moves.windows(2).filter(|pair| pair[1].kind == MoveKind::Cut) {
        let pose = program.machine.forward(&pair[1].joints);
        let centre = pose.tip + pose.axis * 2.0;
        let (distance, ((sector, face, v), _)) = nearest(&samples, |p| (p - centre).norm());
        let (sector, face, v) = (*sector, *face, *v);
        if distance > 2.2 {
            continue;
        }
        lowest[sector][face] = lowest[sector][face].min(v);
        changes += usize::from(on.is_some_and(|on| on != (sector, face)));
        on = Some((sector, face));
        worst = worst.max(lowest[sector][1 - face] - lowest[sector][face]);
        // A blade is finished before the tool goes to the next one.
        assert!(sector == 1 || lowest[1] == [1.0; 2]);
    }
    assert!(lowest.iter().flatten().all(|v| *v < 0.25), "{lowest:?}");
    println!("{worst:.2} of the height ahead, {changes} changes");
    (worst, changes)
}

#[test]
fn strips_of_flank_milling_go_down_on_both_faces() {
    let flank = |order: FaceOrder| {
        let flank = Flank { order, ..Flank::by_ruling(FlankMethod::TwoPoint, 4) };
        ahead(&program(OperationKind::Flank { faces: BladeId::MAIN.faces().to_vec(), flank }))
    };
    let ([by_levels, by_faces], changes) = {
        let (levels, faces) = (flank(FaceOrder::Levels), flank(FaceOrder::Faces));
        ([levels.0, faces.0], [levels.1, faces.1])
    };
    // Four strips: a quarter of the height, and what the fillet takes of it.
    assert!(by_levels < 0.3 && by_faces > 0.7, "{by_levels} {by_faces}");
    // From face to face after each strip of two blades; or once on each blade, and from blade to blade.
    assert_eq!(changes, [15, 3]);
}

#[test]
fn lines_of_point_milling_go_down_on_both_faces() {
    let point = |levels: Option<f64>, milling: Option<Milling>| {
        let lines = if milling.is_some() { Lines::OneWay } else { Lines::Zigzag };
        let surfaces = BladeId::MAIN.faces().map(SurfaceKind::Face).to_vec();
        let (levels, method) = (levels.map(Mm), AxisMethod::Blend);
        ahead(&program(OperationKind::Point { surfaces, scallop: Mm(0.2), lines, milling, levels, method }))
    };
    // The face is 8 to 26 mm high: at its lowest place 5 mm are 0.63 of the height.
    for milling in [None, Some(Milling::Climb)] {
        let (by_levels, changes) = point(Some(5.0), milling);
        let (by_faces, once) = point(None, milling);
        assert!(by_levels < 0.7 && by_faces > 0.75, "{by_levels} {by_faces}");
        assert!(changes > 2 * once, "{changes} {once}");
    }
}
