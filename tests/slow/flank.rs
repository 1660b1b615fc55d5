//! Flank milling by `minimax`: contracts are kept with proof, planning and verification together.

use crate::support;
use impellerc::base::entity::PrimaryMap;
use impellerc::base::progress::Progress;
use impellerc::base::units::Mm;
use impellerc::diagnostics::codes::verification;
use impellerc::diagnostics::{Severity, Sink};
use impellerc::ir::{Contract, ContractKind, Motion, Operation, OperationKind, Program};
use impellerc::plan::passes::{Obstacles, pipeline};
use impellerc::tool_stock::collide::{Cutter, Section};
use impellerc::verify::certify_with;
use impellerc::verify::stock::Settings;
use impellerc::wheel::contract::{Guarded, Scope};
use impellerc::wheel::method::{ErrorSide, Flank, FlankMethod};
use impellerc::wheel::part::{BladeId, FaceId, SurfaceClass, SurfaceId};

/// The vanes that are milled: two, so that one follows the other. All vanes have one shape.
const VANES: [u32; 2] = [0, 1];

/// The paper's part with one flank operation on both faces of two vanes, and contracts on faces and fillets, um.
fn program(cutter: Cutter, choices: Flank, gouge: f64, excess: f64, chord: f64) -> Program {
    let mut program = support::wei_program(&[0]);
    (program.tools, program.operations) = (PrimaryMap::new(), PrimaryMap::new());
    let tool = program.tools.push(support::tool("t1", 1, cutter, 30.0, 50.0));
    let kind = OperationKind::Flank { faces: BladeId::MAIN.faces().to_vec(), flank: choices };
    // Nothing roughs the blank before: at link feed the way down to a pass would remove more than its cuts.
    let operation = support::operation("flank", kind, tool, VANES.to_vec(), 15.0);
    program.operations.push(Operation { link_feed: operation.feed, ..operation });
    program.tolerances.chord = Mm(chord * 1e-3);
    let surfaces = vec![SurfaceClass::Pressure, SurfaceClass::Suction, SurfaceClass::Fillet];
    let contract = |kind, bound: f64| Contract {
        scope: Scope { operations: Vec::new(), surfaces: surfaces.clone() },
        ..Contract::whole(kind, bound * 1e-3)
    };
    program.contracts = vec![contract(ContractKind::Gouge, gouge), contract(ContractKind::Excess, excess)];
    program
}

fn minimax(strips: Option<u32>) -> Flank {
    Flank { strips, ..Flank::by_ruling(FlankMethod::Minimax, 1) }
}

fn ball() -> Cutter {
    Cutter::ball(3.0)
}

/// Whether a motion keeps all contracts; of the contract on excess, which no vane keeps that nothing mills, only the part on
/// the milled vanes. The stock has the largest cells: no contract is about it.
fn keeps(program: &Program, motion: &Motion, sink: &mut Sink) -> bool {
    let mut settings = Settings { cell: Some(1.0), ..Settings::default() };
    let certificate = certify_with(program, motion, &mut settings, &Progress::default(), sink).expect("a certificate");
    let mut errors = sink.diags().iter().filter(|d| d.severity == Severity::Error);
    let not_milled = errors.all(|d| d.code == verification::EXCESS && d.message.contains("not machined"));
    let excess = program.contracts.iter().find(|c| c.kind == ContractKind::Excess).expect("a contract");
    let asked = |id: SurfaceId| VANES.contains(&id.sector) && excess.scope.surfaces.contains(&id.kind.class());
    let milled: Vec<_> = certificate.surfaces.iter().filter(|s| asked(s.id)).collect();
    assert!(milled.len() >= VANES.len() * excess.scope.surfaces.len(), "surfaces are missing");
    not_milled && milled.iter().all(|s| s.excess_bound.get() <= excess.bound.value())
}

/// Plans and verifies; the passes of a vane, and whether all contracts are kept.
fn run(program: &Program) -> (usize, bool) {
    let mut sink = Sink::default();
    let plan = pipeline::run(program, &mut sink);
    let plan = plan.unwrap_or_else(|_| panic!("{:?}", sink.diags().iter().map(|d| &d.message).collect::<Vec<_>>()));
    for note in &plan.cl.operations[0].notes {
        println!("{note}");
    }
    let kept = keeps(program, &plan.motion, &mut sink);
    for d in sink.diags() {
        println!("{} {} {:?} {:?}", d.code, d.message, d.place, d.notes);
    }
    for (pass, planned) in plan.cl.operations[0].passes.iter().zip(&plan.cc.operations[0].passes) {
        let path = planned.path.as_ref().expect("dual NURBS");
        // The stations lie on the curves that are kept.
        // Not those of the leads: the ends, and where a lead changes to link feed.
        let on_lead = |i: usize| pass.air.contains(&i) || pass.air.contains(&(i + 1));
        let inner = (1..pass.points.len() - 1).filter(|i| !on_lead(*i));
        for point in inner.map(|i| pass.points[i]) {
            let near = (0..=4000).map(|i| path.at(f64::from(i) / 4000.0));
            let gap = near.map(|at| (at.lower - point.tip).norm()).fold(f64::INFINITY, f64::min);
            assert!(gap < 0.03, "{gap}");
        }
    }
    (plan.cl.operations[0].passes.len() / VANES.len(), kept)
}

#[test]
fn one_pass_a_face_keeps_a_micrometre_of_gouge_and_twelve_of_excess() {
    let (passes, kept) = run(&program(ball(), minimax(None), 1.0, 12.0, 0.25));
    assert_eq!(passes, 2);
    assert!(kept, "a contract fails");
}

#[test]
fn two_bands_keep_two_micrometres_on_both_sides() {
    let (passes, kept) = run(&program(ball(), minimax(None), 2.0, 2.0, 0.1));
    assert_eq!(passes, 4);
    assert!(kept, "a contract fails");
}

#[test]
fn all_error_on_the_side_of_excess_leaves_next_to_no_gouge() {
    let choices = Flank { side: ErrorSide::Excess, ..minimax(Some(1)) };
    let (_, kept) = run(&program(ball(), choices, 0.8, 12.0, 0.25));
    assert!(kept, "a contract fails");
}

#[test]
fn a_cutter_that_does_not_fit_in_any_number_of_bands_is_refused() {
    let mut program = program(ball(), minimax(None), 0.1, 0.1, 0.25);
    program.operations = {
        let mut operations = PrimaryMap::new();
        for (_, operation) in program.operations.iter() {
            let mut operation = operation.clone();
            operation.sectors = vec![0];
            operation.kind = OperationKind::Flank { faces: vec![FaceId::SUCTION], flank: minimax(None) };
            operations.push(operation);
        }
        operations
    };
    let mut sink = Sink::default();
    assert!(pipeline::run(&program, &mut sink).is_err());
    let found = sink.diags().iter().find(|d| d.code.to_string() == "IMP0409").expect("the reason");
    println!("{} {:?} {:?} {:?}", found.message, found.place, found.notes, found.help);
    // The chord tolerance alone takes more than the bounds.
    assert!(found.help.iter().any(|h| h.contains("tolerance chord")), "{:?}", found.help);
}

/// One face of one vane.
fn suction_only(cutter: Cutter, strips: Option<u32>, bound: f64) -> Program {
    let mut program = program(cutter, minimax(strips), bound, bound, 0.1);
    let mut operations = PrimaryMap::new();
    for (_, operation) in program.operations.iter() {
        let mut operation = operation.clone();
        operation.sectors = vec![0];
        operation.kind = OperationKind::Flank { faces: vec![FaceId::SUCTION], flank: minimax(strips) };
        operations.push(operation);
    }
    program.operations = operations;
    program
}

#[test]
fn the_error_names_the_place_and_a_cutter_that_would_do() {
    let mut sink = Sink::default();
    // One band misses these bounds: what is left of 1.5 um on each side is below the 2.5 um of this cutter.
    assert!(pipeline::run(&suction_only(ball(), Some(1), 1.5), &mut sink).is_ok());
    let found = sink.diags().iter().find(|d| d.code.to_string() == "IMP0409").expect("the warning");
    let help = found.help.clone().expect("a way out");
    println!("{} {help}", found.message);
    let words: Vec<&str> = help.split(' ').collect();
    let diameter = words.windows(2).find_map(|w| (w[1] == "mm").then(|| w[0].parse::<f64>().unwrap())).expect("a size");
    assert!(diameter > 0.5 && diameter < 6.0, "{diameter}");
    // That cutter keeps them.
    let mut sink = Sink::default();
    let program = suction_only(Cutter::ball(0.5 * diameter), Some(1), 1.5);
    assert!(pipeline::run(&program, &mut sink).is_ok());
    let again = sink.diags().iter().find(|d| d.code.to_string() == "IMP0409");
    assert!(again.is_none(), "{again:?}");
}

#[test]
fn cutters_of_other_shapes_keep_contracts_as_well() {
    for cutter in [Cutter::bull(3.0, 1.5), Cutter::tapered_ball(2.0, 0.05), Cutter::barrel(3.2, 1000.0, 2.5)] {
        let mut program = program(cutter, minimax(None), 8.0, 8.0, 0.25);
        // Their tips are rounder than the fillet, which stays for another tool.
        for contract in &mut program.contracts {
            contract.scope.surfaces.retain(|s| *s != SurfaceClass::Fillet);
        }
        println!("{cutter:?}");
        let (passes, kept) = run(&program);
        println!("{passes} passes a vane");
        assert!(kept, "{cutter:?}: a contract fails");
    }
}

/// One face of the vanes with a holder of a radius at a reach, and the contracts of one band on it.
fn with_holder(side: FaceId, reach: f64, radius: f64) -> Program {
    let mut program = program(ball(), minimax(Some(1)), 1.0, 12.0, 0.25);
    program.tools = {
        let mut tools = PrimaryMap::new();
        for (_, tool) in program.tools.iter() {
            let mut tool = tool.clone();
            tool.solid.flute_length = 28.0;
            tool.solid.shank = vec![Section { from: 28.0, to: reach, radius_from: 3.0, radius_to: 3.0 }];
            let upper = radius + 6.0;
            tool.solid.holder = vec![Section { from: reach, to: reach + 60.0, radius_from: radius, radius_to: upper }];
            tools.push(tool);
        }
        tools
    };
    program.operations = {
        let mut operations = PrimaryMap::new();
        for (_, operation) in program.operations.iter() {
            let OperationKind::Flank { flank, .. } = operation.kind else { panic!("flank") };
            let kind = OperationKind::Flank { faces: vec![side], flank };
            operations.push(Operation { kind, ..operation.clone() });
        }
        operations
    };
    for contract in &mut program.contracts {
        contract.scope.surfaces =
            vec![if side == FaceId::PRESSURE { SurfaceClass::Pressure } else { SurfaceClass::Suction }];
    }
    program
}

/// Largest angle between the axis of the first pass and Z, degrees, and least distance of shank and holder, mm.
fn lean_and_distance(program: &Program) -> (f64, f64) {
    let mut sink = Sink::default();
    let plan = pipeline::run(program, &mut sink);
    let plan = plan.unwrap_or_else(|_| panic!("{:?}", sink.diags()));
    let obstacles = Obstacles::new(&program.part, &program.machine);
    let solid = &program.tools.iter().next().unwrap().1.solid;
    let path = plan.cc.operations[0].passes[0].path.clone().unwrap();
    let stations = (0..=400).map(|i| path.at(f64::from(i) / 400.0));
    stations.fold((0.0, f64::INFINITY), |(lean, least), at| {
        let body = obstacles.nearest(&at.lower, &at.axis, |rho, s| solid.body_distance(rho, s), 50.0);
        let least = body.map(|x| x.0).fold(least, f64::min);
        (at.axis.z.acos().to_degrees().max(lean), least)
    })
}

#[test]
fn the_path_keeps_to_the_travel_of_a() {
    let mut program = with_holder(FaceId::PRESSURE, 50.0, 12.0);
    // Nothing roughs the blank: flutes of 28 mm would take the shank into what stands over them at the inlet.
    let mut tools = PrimaryMap::new();
    for (_, tool) in program.tools.iter() {
        let mut tool = tool.clone();
        tool.solid.flute_length = 31.0;
        tool.solid.shank[0].from = 31.0;
        tools.push(tool);
    }
    program.tools = tools;
    let (free, _) = lean_and_distance(&program);
    let most = 66.3_f64;
    assert!(free > most + 0.4, "nothing to keep: {free}");
    (program.machine.rotary[0].min, program.machine.rotary[0].max) = (-most.to_radians(), most.to_radians());
    let (kept, _) = lean_and_distance(&program);
    println!("A to {kept:.2} deg, {free:.2} where it may");
    assert!(kept < most);
    // The contracts of the face are kept as well.
    let mut sink = Sink::default();
    let plan = pipeline::run(&program, &mut sink).unwrap();
    assert!(keeps(&program, &plan.motion, &mut sink), "{:?}", sink.diags());
}

#[test]
fn the_path_keeps_the_holder_clear() {
    let mut program = with_holder(FaceId::SUCTION, 28.0, 16.0);
    program.contracts.push(Contract::whole(ContractKind::Clearance(Guarded::Holder), 0.5));
    // What the path would come to that knows of no holder.
    let free = {
        let mut free = with_holder(FaceId::SUCTION, 80.0, 16.0);
        let mut sink = Sink::default();
        let plan = pipeline::run(&free, &mut sink).unwrap();
        free.tools = program.tools.clone();
        let obstacles = Obstacles::new(&free.part, &free.machine);
        let solid = &free.tools.iter().next().unwrap().1.solid;
        let path = plan.cc.operations[0].passes[0].path.clone().unwrap();
        let at = |i: u32| path.at(f64::from(i) / 400.0);
        let near = |at: impellerc::nurbs::AxisAt| {
            let body = obstacles.nearest(&at.lower, &at.axis, |rho, s| solid.body_distance(rho, s), 50.0);
            body.map(|x| x.0).fold(f64::INFINITY, f64::min)
        };
        (0..=400).map(|i| near(at(i))).fold(f64::INFINITY, f64::min)
    };
    let (_, kept) = lean_and_distance(&program);
    println!("holder at {kept:.3} mm, {free:.3} mm by the path that knows of none");
    assert!(free < 0.5 && kept >= 0.5, "{free} {kept}");
    let mut sink = Sink::default();
    let plan = pipeline::run(&program, &mut sink).unwrap();
    assert!(keeps(&program, &plan.motion, &mut sink), "{:?}", sink.diags());
}

#[test]
fn a_holder_that_no_path_clears_is_refused_with_the_tool_that_would_do() {
    let mut sink = Sink::default();
    assert!(pipeline::run(&with_holder(FaceId::PRESSURE, 28.0, 16.0), &mut sink).is_err());
    let found = sink.diags().iter().find(|d| d.code.to_string() == "IMP0501").expect("the reason");
    let help = found.help.clone().expect("a way out");
    println!("{} {help}", found.message);
    assert!(found.place.is_some());
    let words: Vec<&str> = help.split([' ', ';']).collect();
    let number = |after: [&str; 2]| {
        let at = words.windows(3).find(|w| w[..2] == after).unwrap_or_else(|| panic!("{after:?}: {help}"));
        at[2].parse::<f64>().unwrap()
    };
    // Both do.
    for (reach, radius) in [(number(["reach", "of"]), 16.0), (28.0, 0.5 * number(["at", "most"]) - 6.0)] {
        let mut sink = Sink::default();
        assert!(pipeline::run(&with_holder(FaceId::PRESSURE, reach, radius), &mut sink).is_ok(), "{reach} {radius}");
    }
}

#[test]
fn a_shank_that_touches_the_face_is_refused_with_the_flutes_that_would_do() {
    let mut program = with_holder(FaceId::PRESSURE, 28.0, 16.0);
    let with_flutes = |program: &Program, flutes: f64, reach: f64| {
        let mut tools = PrimaryMap::new();
        for (_, tool) in program.tools.iter() {
            let mut tool = tool.clone();
            tool.solid.flute_length = flutes;
            tool.solid.shank = vec![Section { from: flutes, to: reach, radius_from: 3.0, radius_to: 3.0 }];
            tool.solid.holder = vec![Section { from: reach, to: reach + 60.0, radius_from: 16.0, radius_to: 22.0 }];
            tools.push(tool);
        }
        tools
    };
    program.tools = with_flutes(&program, 22.0, 28.0);
    let mut sink = Sink::default();
    assert!(pipeline::run(&program, &mut sink).is_err());
    let found = sink.diags().iter().find(|d| d.code.to_string() == "IMP0501").expect("the reason");
    let help = found.help.clone().expect("a way out");
    println!("{} {help}", found.message);
    let numbers: Vec<f64> = help.split([' ', ';']).filter_map(|w| w.parse().ok()).collect();
    let [flutes, reach] = numbers[..] else { panic!("{help}") };
    program.tools = with_flutes(&program, flutes, reach);
    assert!(pipeline::run(&program, &mut Sink::default()).is_ok(), "{flutes} {reach}");
}
