//! Climb or conventional milling of vanes: the side of the material as the motion of the machine shows it.

use crate::support::squares::{nearest, squares};
use crate::support::{self, golden, pinned};
use impellerc::base::entity::PrimaryMap;
use impellerc::base::units::Mm;
use impellerc::diagnostics::Sink;
use impellerc::ir::{Contract, ContractKind, MoveKind, OperationKind, Program};
use impellerc::nc;
use impellerc::plan::passes::pipeline;
use impellerc::tool_stock::collide::Cutter;
use impellerc::tool_stock::collide::tool::tool_coordinates;
use impellerc::wheel::method::{AxisMethod, Flank, FlankMethod, Lines, Milling};
use impellerc::wheel::part::chart::{self, Chart, Shape};
use impellerc::wheel::part::{BladeId, Surface, SurfaceKind};
use nalgebra::{Point3, Vector3};

/// Samples along and across a face.
const GRID: [usize; 2] = [300, 60];

/// Distance from a sample at which the cutter touches the surface, mm.
const TOUCHES: f64 = 0.1;

/// A program with one operation of a ball of 4 mm in two sectors.
fn program(kind: OperationKind) -> Program {
    let mut program = support::wei_program(&[0]);
    (program.tools, program.operations) = (PrimaryMap::new(), PrimaryMap::new());
    let tool = program.tools.push(support::tool("t1", 1, Cutter::ball(2.0), 30.0, 45.0));
    program.operations.push(support::operation(kind.keyword(), kind, tool, vec![0, 3], 6.0));
    program
}

fn lines(
    surface: fn(impellerc::wheel::part::FaceId) -> SurfaceKind,
    lines: Lines,
    milling: Option<Milling>,
) -> OperationKind {
    let surfaces = BladeId::MAIN.faces().map(surface).to_vec();
    OperationKind::Point { surfaces, scallop: Mm(0.4), lines, milling, levels: None, method: AxisMethod::Blend }
}

/// For each face the number of blocks that mill it in climb and in conventional sense, and that go outward and inward.
///
/// The spindle turns clockwise as seen along the tool axis from above (M3): a tooth on the right of the motion goes
/// backward. Where the material is there, teeth go the way of the feed of the part: climb milling. The material is where
/// the nearest place of a face is.
fn found(program: &Program) -> [[[usize; 2]; 2]; 2] {
    let mut sink = Sink::default();
    let plan = pipeline::run(program, &mut sink).unwrap_or_else(|_| panic!("{:?}", sink.diags()));
    let operation = program.operations.iter().next().unwrap().1;
    let solid = &program.tools[operation.tool].solid;
    let is_finished = |chart: &Chart<'_>| match &operation.kind {
        OperationKind::Flank { faces, .. } => faces.iter().any(|f| chart.kind == SurfaceKind::Face(*f)),
        OperationKind::Point { surfaces, .. } => surfaces.contains(&chart.kind),
        _ => false,
    };
    let charts = chart::charts(&program.part);
    let (mut faces, mut finished) = (Vec::new(), Vec::new());
    for turn in operation.sectors.iter().map(|sector| program.part.sector_rotation(*sector)) {
        let share = |i: usize, j: usize| [i as f64 / GRID[0] as f64, j as f64 / GRID[1] as f64];
        for (k, face) in BladeId::MAIN.faces().into_iter().enumerate() {
            let surface = &program.part.face(face).surface;
            faces.extend(squares(GRID, |i, j| {
                let [u, v] = share(i, j);
                ((k, (1..GRID[0]).contains(&i)), turn * surface.point(u, v))
            }));
        }
        for chart in charts.iter().filter(|c| is_finished(c)) {
            finished.extend(squares(GRID, |i, j| {
                let [u, v] = share(i, j);
                ((), turn * chart.place(u, v).position)
            }));
        }
    }
    let mut counts = [[[0; 2]; 2]; 2];
    for pair in plan.motion.operations[0].moves.windows(2).filter(|pair| pair[1].kind == MoveKind::Cut) {
        let [from, to] = [0, 1].map(|i| program.machine.forward(&pair[i].joints));
        let (tip, axis): (Point3<f64>, Vector3<f64>) =
            (nalgebra::center(&from.tip, &to.tip), (from.axis + to.axis).normalize());
        let distance = |p: &Point3<f64>| {
            let (rho, s) = tool_coordinates(p, &tip, &axis);
            solid.cutter_distance(rho, s)
        };
        let ((face, inside), place) = *nearest(&faces, distance).1;
        // On leads and where a line rises the cutter touches nothing.
        if !inside || nearest(&finished, distance).0 > TOUCHES {
            continue;
        }
        // The motion of the tool at the height of the place: the tip of a turning tool may go another way.
        let (_, height) = tool_coordinates(&place, &tip, &axis);
        let motion = (to.tip + to.axis * height) - (from.tip + from.axis * height);
        let right = motion.cross(&axis);
        let radius = |p: &Point3<f64>| p.coords.xy().norm();
        counts[face][0][usize::from((place - tip).dot(&right) < 0.0)] += 1;
        counts[face][1][usize::from(radius(&to.tip) < radius(&from.tip))] += 1;
    }
    counts
}

/// All blocks on both faces have the sense, and both faces are cut in opposite directions.
fn keeps(counts: [[[usize; 2]; 2]; 2], sense: Milling) {
    println!("{counts:?} {sense:?}");
    let other = usize::from(sense == Milling::Climb);
    for [senses, _] in counts {
        assert!(senses[1 - other] > 20, "{counts:?}");
        assert_eq!(senses[other], 0, "{counts:?}");
    }
    let outward = counts.map(|[_, directions]| directions[0] > directions[1]);
    assert_ne!(outward[0], outward[1], "{counts:?}");
}

#[test]
fn flank_milling_keeps_its_sense_on_both_faces() {
    for method in [FlankMethod::TwoPoint, FlankMethod::OnePoint, FlankMethod::Minimax] {
        for milling in Milling::ALL {
            let flank = Flank { milling, ..Flank::by_ruling(method, 2) };
            let mut program = program(OperationKind::Flank { faces: BladeId::MAIN.faces().to_vec(), flank });
            // Without contracts `minimax` looks for the least error alone, and its tip may falter by micrometres.
            program.contracts = [ContractKind::Gouge, ContractKind::Excess].map(|k| Contract::whole(k, 0.012)).into();
            keeps(found(&program), milling);
        }
    }
}

#[test]
fn lines_on_faces_and_fillets_keep_their_sense() {
    for milling in Milling::ALL {
        keeps(found(&program(lines(SurfaceKind::Face, Lines::OneWay, Some(milling)))), milling);
        keeps(found(&program(lines(SurfaceKind::Face, Lines::Spiral, Some(milling)))), milling);
        // In the fillet the face stands beside the tool.
        keeps(found(&program(lines(SurfaceKind::Fillet, Lines::OneWay, Some(milling)))), milling);
    }
    // The check sees it where every other line has the other sense.
    let zigzag = found(&program(lines(SurfaceKind::Face, Lines::Zigzag, None)));
    assert!(zigzag.iter().all(|[senses, _]| senses.iter().all(|n| *n > 20)), "{zigzag:?}");
}

#[test]
fn the_spindle_turns_clockwise() {
    for post in nc::POSTS {
        let text = golden::nc(pinned::reduced(post.name()).planned(), *post);
        let words: Vec<&str> = text.split([' ', ',', '\n']).collect();
        let [right, wrong] = if post.name() == "apt-cl" { ["CLW", "CCLW"] } else { ["M3", "M4"] };
        assert!(words.contains(&right) && !words.contains(&wrong), "{}", post.name());
    }
}
