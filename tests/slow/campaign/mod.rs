//! The fault campaign: seeded faults in the verified text of every dialect. The verifier measures each fault, and brute
//! force measures it without the verifier. A fault that gouges by two micrometres or more, or collides, is found with
//! its size and its line; any other fault is not reported.
//!
//! `.ci/run` judges five faults of each kind in each dialect. All thirteen, 208 faults, are judged by
//! `cargo test --test slow -- --ignored --nocapture all_faults`, before a release and after a change of the verifier.
//! When CAMPAIGN_LIST is set, each fault is listed with its truth.

mod blocks;
mod faults;
mod truth;

use crate::support::{
    self,
    jobs::{self, Compiled},
};
use blocks::{Dialect, stations};
use faults::{Fault, KINDS, Kind, Original, Seeded};
use impellerc::base::entity::PrimaryMap;
use impellerc::base::progress::Progress;
use impellerc::base::source::{SourceId, Span};
use impellerc::diagnostics::{Code, Severity, Sink, codes};
use impellerc::ir::{Operation, OperationKind, Program};
use impellerc::nc::motion_of::motion_of;
use impellerc::nc::{self};
use impellerc::verify::certify_with;
use impellerc::verify::stock::Settings;
use nalgebra::Point3;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::ops::Range;
use std::time::Instant;
use truth::{Cut, Design, Known, Segment, Truth, segments};

/// Faults of each kind in each dialect.
const EACH: usize = 13;

/// Those of them that every run judges: other ones in each dialect.
const EVERY_RUN: [Range<usize>; 2] = [0..5, 5..10];

/// What must be found, and how well its size must be known, mm.
const MUST: f64 = 2e-3;
const SIZE: f64 = 1e-3;

/// Depth beyond which the verifier follows the normal instead of the distance, mm.
const DEEP: f64 = 0.1;

/// Cells of the stock simulation, mm. What the cutter alone does wrong at feed shows on the design surfaces; of the stock
/// these faults say nothing that is judged here. The others are millimetres long and need no fine engagement.
fn cell(kind: Kind) -> f64 {
    match kind {
        Kind::BlockMoved | Kind::AxisTurned | Kind::BlockDropped | Kind::ToolRadius => 4.0,
        Kind::ToolLength | Kind::WrongTurn | Kind::RapidThroughVane | Kind::HolderTooFat => USUAL_CELL,
    }
}

/// Cells that find what shank and holder meet, mm.
const USUAL_CELL: f64 = 1.0;

/// What the verifier says about a text.
struct Said {
    /// Errors with the NC lines of their labels.
    errors: Vec<(Code, Vec<usize>)>,
    /// Deepest gouge: depth, point, surface, line.
    gouge: Option<(f64, Point3<f64>, impellerc::wheel::part::SurfaceId, usize)>,
    /// Least distance of shank and holder with its line.
    bodies: Option<(f64, usize)>,
}

impl Said {
    fn has(&self, code: Code) -> bool {
        self.errors.iter().any(|e| e.0 == code)
    }
}

fn ask(dialect: Dialect, program: &Program, lines: &[String], cell: f64) -> Said {
    let text = lines.join("\n") + "\n";
    // Lines are carried through as places of a file of their own.
    let file = SourceId(u32::MAX);
    let span = |line: usize| Span::new(file, line..line);
    let mut sink = Sink::default();
    let mut said = Said { errors: Vec::new(), gouge: None, bodies: None };
    let sections = match nc::find(dialect.name()).unwrap().read(&text, &program.machine) {
        Ok(sections) => sections,
        Err(faults) => panic!("a fault that is no text: {faults:?}"),
    };
    let motion = motion_of(program, &sections, &span, &mut sink);
    if let Some(nc) = &motion
        && let Ok(certificate) = certify_with(
            program,
            &nc.motion,
            &mut Settings { cell: Some(cell), ..Settings::default() },
            &Progress::default(),
            &mut sink,
        )
    {
        let worst = certificate.surfaces.iter().max_by(|a, b| a.gouge.depth.total_cmp(&b.gouge.depth)).unwrap();
        said.gouge = worst.gouge.at.and_then(|at| {
            Some((worst.gouge.depth.get(), Point3::from(worst.gouge.point), worst.id, nc.line(at.operation, at.index)?))
        });
        let bodies = certificate.operations.iter().flat_map(|o| [&o.shank, &o.holder]).flatten();
        said.bodies = bodies
            .min_by(|a, b| a.distance.total_cmp(&b.distance))
            .and_then(|c| Some((c.distance.get(), nc.line(c.at.operation, c.at.index)?)));
    }
    for diag in sink.diags().iter().filter(|d| d.severity == Severity::Error) {
        let mut lines: Vec<usize> =
            diag.labels.iter().filter(|l| l.span.source == file).map(|l| l.span.start as usize).collect();
        let block = diag.place.as_ref().and_then(|p| p.block);
        lines.extend(block.and_then(|(o, i)| motion.as_ref()?.line(o, i)));
        said.errors.push((diag.code, lines));
    }
    said
}

/// The verdict on one fault.
struct Verdict {
    kind: Kind,
    gouges: bool,
    collides: bool,
    /// Truth, mm.
    depth: f64,
    found: bool,
    /// Difference of the sizes, um.
    size: f64,
    false_alarm: bool,
    complaints: Vec<String>,
}

struct Campaign<'a> {
    original: &'a Original,
    design: &'a Design<'a>,
    /// Cuts of the text as written.
    base: Cut,
    bodies: (f64, usize),
    known: Known,
}

impl Campaign<'_> {
    fn judge(&self, fault: &Fault) -> Verdict {
        let said = ask(self.original.dialect, &fault.program, &fault.lines, cell(fault.kind));
        let all = segments(&stations(self.original.dialect, &fault.lines));
        let truth = Truth { design: self.design, program: &fault.program };
        let new = if fault.kind == Kind::ToolRadius { all.clone() } else { self.known.new_ones(&all) };
        let mut deepest = truth.deepest(&new).filter(|c| c.depth > self.base.depth).unwrap_or(self.base);
        let mut complaints = Vec::new();
        let mut size = 0.0;
        let of_line = |line: usize| all.iter().find(|s: &&Segment| s.line == line);
        if let Some((depth, point, surface, line)) = said.gouge {
            // Where the verifier looked the brute force looks as well.
            let there = of_line(line).map(|s| truth.deepest_around(s, surface, &point, None));
            if let Some(there) = there.filter(|c| c.depth > deepest.depth) {
                deepest = there;
            }
            let (least, _) = truth.distance_to_all(&all, &point);
            if deepest.depth >= MUST {
                let expected = if depth <= DEEP {
                    deepest.depth
                } else {
                    let normal = self.design.normal(surface, &point).unwrap();
                    truth.way_inside(&all, &point, &normal)
                };
                size = (depth - expected).abs();
                if size > SIZE || depth < deepest.depth - SIZE {
                    complaints.push(format!(
                        "size {:.2} um on {surface} line {line}, truth {:.2} um there and {:.2} um on {} line {} at {:.3}",
                        depth * 1e3,
                        expected * 1e3,
                        deepest.depth * 1e3,
                        deepest.surface,
                        deepest.line,
                        deepest.point
                    ));
                }
                let own = of_line(line).map_or(f64::INFINITY, |s| truth.distance(s, &point));
                if own > least + SIZE {
                    complaints.push(format!("line {line} is {own:.4} mm away where another is {least:.4} mm"));
                }
            }
        }
        let gouges = deepest.depth >= MUST;
        let fresh = if matches!(fault.kind, Kind::HolderTooFat | Kind::ToolRadius) { &all } else { &new };
        let mut bodies = truth.bodies(fresh);
        if fault.kind != Kind::HolderTooFat && self.bodies.0 < bodies.0 {
            bodies = self.bodies;
        }
        let collides = bodies.0 < 0.0;
        let mut found = true;
        if gouges && !said.has(codes::verification::GOUGE) {
            found = false;
            complaints.push(format!("gouge of {:.2} um is not found: {:?}", deepest.depth * 1e3, deepest));
        }
        if collides {
            if !said.has(codes::verification::CLEARANCE) {
                found = false;
                complaints.push(format!("collision of {:.3} mm at line {} is not found", bodies.0, bodies.1));
            } else if let Some((distance, line)) = said.bodies {
                // The verifier gives a lower bound that counts the spacing of its points; so do the points here.
                let own = of_line(line).map_or(f64::INFINITY, |s| truth.bodies_of(s));
                if own > bodies.0 + 0.3 || distance > bodies.0 + 0.05 || distance < bodies.0 - 0.5 {
                    complaints.push(format!("body {distance:.3} mm at line {line} ({own:.3}), truth {bodies:?}"));
                }
            }
        }
        let alarm = said.has(codes::verification::GOUGE) && !gouges;
        let near = said.has(codes::verification::CLEARANCE) && bodies.0 > 0.5 + 0.2;
        if alarm || near {
            complaints.push(format!(
                "false alarm: {:?}, truth {:.2} um, bodies {bodies:?}",
                said.errors,
                deepest.depth * 1e3
            ));
        }
        Verdict {
            kind: fault.kind,
            gouges,
            collides,
            depth: deepest.depth,
            found,
            size: size * 1e3,
            false_alarm: alarm || near,
            complaints,
        }
    }
}

/// The small job with fewer passes, since each fault is a verification of the whole text.
fn short(dialect: Dialect) -> Compiled {
    let mut program = jobs::program("small", jobs::machine_of(dialect.name()));
    let operations: Vec<Operation> = program.operations.iter().map(|(_, o)| o.clone()).collect();
    program.operations = PrimaryMap::new();
    for mut operation in operations {
        operation.sectors = vec![0];
        if let OperationKind::Flank { flank, .. } = &mut operation.kind {
            flank.strips = Some(6);
        }
        program.operations.push(operation);
    }
    program.allowed.push(support::deep_slots());
    Compiled::new(program)
}

#[test]
fn faults_are_found_with_size_and_line() {
    judge_faults(EVERY_RUN);
}

#[test]
#[ignore = "takes a quarter of an hour on two cores"]
fn all_faults_are_found_with_size_and_line() {
    judge_faults([0..EACH, 0..EACH]);
}

/// Judges these faults of each kind, by dialect.
fn judge_faults(chosen: [Range<usize>; 2]) {
    let start = Instant::now();
    let mut complaints = Vec::new();
    let (mut judged, mut must) = (0, 0);
    for (k, (dialect, chosen)) in [Dialect::Siemens, Dialect::LinuxCnc].into_iter().zip(chosen).enumerate() {
        let Compiled { mut program, motion, .. } = short(dialect);
        // A whole turn of C too far is a motion to be measured here, not a word beyond travel.
        (program.machine.rotary[1].min, program.machine.rotary[1].max) = (-20.0, 20.0);
        let design = Design::new(&program.part);
        let text =
            nc::emit(nc::find(dialect.name()).unwrap(), &support::with_post(dialect.name(), &program), &motion, &[])
                .text();
        let original = Original::new(dialect, &text, &program);
        let said = ask(dialect, &program, &original.lines, USUAL_CELL);
        assert!(said.errors.is_empty(), "an alarm on the original: {:?}", said.errors);
        let all = segments(&original.stations);
        let truth = Truth { design: &design, program: &program };
        let base = truth.deepest(&all).unwrap();
        assert!(base.depth < MUST, "{base:?}");
        let (depth, ..) = said.gouge.unwrap();
        assert!((depth - base.depth).abs() < SIZE, "{depth} {base:?}");
        let campaign = Campaign {
            original: &original,
            design: &design,
            base,
            bodies: truth.bodies(&all),
            known: Known::new(&all),
        };
        let mut random = Seeded::new(2026 + k as u64);
        // All are made, so that each is the same whichever are judged.
        let of_kind = KINDS.map(|kind| [(); EACH].map(|()| original.fault(kind, &program, &mut random)));
        let faults: Vec<Fault> = of_kind
            .into_iter()
            .flat_map(|faults| faults.into_iter().enumerate())
            .filter(|(number, _)| chosen.contains(number))
            .map(|(_, fault)| fault)
            .collect();
        judged += faults.len();
        let verdicts: Vec<Verdict> = faults.par_iter().map(|f| campaign.judge(f)).collect();
        println!(
            "\n{}: {} blocks, original {:.2} um by brute force, {:.2} um by the verifier",
            dialect.name(),
            original.stations.len(),
            base.depth * 1e3,
            depth * 1e3
        );
        println!(
            "  {:<18} {:>6} {:>12} {:>8} {:>6} {:>9} {:>12} {:>13}",
            "fault", "faults", "gouge >= 2um", "collide", "found", "harmless", "false alarms", "size, um off"
        );
        let mut rows: BTreeMap<Kind, Vec<&Verdict>> = BTreeMap::new();
        for verdict in &verdicts {
            rows.entry(verdict.kind).or_default().push(verdict);
        }
        for (kind, row) in rows {
            let count = |f: &dyn Fn(&Verdict) -> bool| row.iter().filter(|v| f(v)).count();
            let bad = |v: &Verdict| v.gouges || v.collides;
            must += count(&bad);
            println!(
                "  {:<18} {:>6} {:>12} {:>8} {:>6} {:>9} {:>12} {:>13.3}",
                format!("{kind:?}"),
                row.len(),
                count(&|v| v.gouges),
                count(&|v| v.collides),
                count(&|v| bad(v) && v.found),
                count(&|v| !bad(v)),
                count(&|v| v.false_alarm),
                row.iter().map(|v| v.size).fold(0.0, f64::max)
            );
        }
        for (fault, verdict) in faults.iter().zip(&verdicts) {
            if std::env::var_os("CAMPAIGN_LIST").is_some() {
                println!(
                    "    {:?} {}: {:.2} um, gouges {}, collides {}",
                    fault.kind,
                    fault.what,
                    verdict.depth * 1e3,
                    verdict.gouges,
                    verdict.collides
                );
            }
            for complaint in &verdict.complaints {
                complaints.push(format!("{} {:?} {}: {complaint}", dialect.name(), fault.kind, fault.what));
            }
        }
    }
    println!("\n{:.0} s", start.elapsed().as_secs_f64());
    assert!(complaints.is_empty(), "{} complaints\n{}", complaints.len(), complaints.join("\n"));
    // Half of them at least do harm: a fault that nothing can find proves nothing.
    assert!(judged >= 80 && 2 * must >= judged, "only {must} of {judged} faults do harm");
}
