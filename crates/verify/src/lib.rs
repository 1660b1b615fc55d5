//! Independent checks of a motion; only this module makes a [`Verified`].
//!
//! The verifier shares only the engines with the planner. Its inputs are joints, tools and the design. It computes what
//! the tools do over continuous time, with forward kinematics only.
//!
//! | layer | question | where |
//! |---|---|---|
//! | V1 | is the motion well formed? | [`structure`] |
//! | | how far are the chords of spline blocks from what the control interpolates? | [`splines`] |
//! | V2 | what do the swept cutters leave on every design surface? | [`surface`], by [`proof`] |
//! | | do the cutters leave the kept surfaces untouched? | [`kept`] |
//! | | does roughing keep clear of the part, deviations of the control included? | [`allowance`] |
//! | | does roughing leave its allowance on the vanes? | [`vane_allowance`] |
//! | | what is the clearance of shank and holder to the part, and of rapids to the stock? | [`clearance`] |
//! | | what is the clearance of the tool to table and fixtures? | [`obstacles`] |
//! | | what is the clearance of the tool to the clamping of the job? | [`clamping`] |
//! | | what does roughing leave? | [`rest`] |
//! | V3 | what does each block remove of the stock, and what touches the stock? | [`stock`] |
//! | | is the tool above all obstacles where all axes but Z move without tool centre point control? | [`perimeter`] |
//! | V4 | are the axes within travel and speed? | [`machine`] |
//! | | which feed is reached within accelerations and jerks, with which deviation? | [`dynamics`] |

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking"))]

pub mod allowance;
pub mod certificate;
pub mod clamping;
pub mod clearance;
pub mod contracts;
pub mod dynamics;
pub mod finite;
pub mod kept;
pub mod left;
pub mod machine;
mod measure;
pub mod memory;
pub mod obstacles;
pub mod perimeter;
pub mod place;
pub mod proof;
pub mod rest;
pub mod splines;
pub mod stated_points;
pub mod stock;
pub mod structure;
pub mod surface;
mod symmetry;
pub mod vane_allowance;

pub use certificate::Certificate;

use base::progress::{Progress, Work};
use base::units::{Mm, Sec, length};
use certificate::OperationReport;
use clearance::ToolPart;
use diagnostics::{Aborted, Diag, Sink, codes::verification};
use ir::{ContractKind, Motion, MoveKind, Program};
use nalgebra::Point3;
use place::describe;
use proof::piece;
use proof::sweep::Sweep;
use proof::turns::PartnerRounding;
use rayon::prelude::*;
use surface::{Limit, Limits};
use tool_stock::collide::{Cloud, Section, ToolSolid, revolved};
use wheel::contract::Guarded;
use wheel::part::{Sample, SurfaceClass, sample, solid};

/// Spacing of the samples of the design surfaces, mm.
pub const SPACING: f64 = 0.25;

/// Spacing of the samples of the turned stock, mm.
const STOCK_SPACING: f64 = 0.5;

/// Deepest allowed cut into kept surfaces in a job that allows gouge, or without a contract on gouge of the whole part,
/// mm: larger than any tolerance of finishing.
const MAX_KEPT_GOUGE: f64 = 0.1;

/// Search distance of shank, holder and rapids, mm; larger distances are not measured.
const BODY_SEARCH_DISTANCE: f64 = 5.0;

/// A value that the verifier accepted.
#[derive(Clone, Debug)]
pub struct Verified<T>(T);

impl<T> std::ops::Deref for Verified<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.0
    }
}

/// Verifies a motion against its program.
///
/// # Errors
/// Any violation of a rule of the machine or of a contract of the job; all of them are in the sink.
pub fn verify(program: &Program, motion: Motion, sink: &mut Sink) -> Result<(Verified<Motion>, Certificate), Aborted> {
    let (judged, certificate) = examine(program, motion, &mut stock::Settings::default(), &Progress::default(), sink)?;
    judged.map(|motion| (motion, certificate)).map_err(|_| Aborted)
}

/// Verifies a motion with settings of the stock simulation. Returns a refused motion as it is, so that its faults can
/// be shown.
///
/// # Errors
/// The motion is malformed; all other violations of a rule or a contract are in the sink.
pub fn examine(
    program: &Program,
    motion: Motion,
    settings: &mut stock::Settings<'_>,
    progress: &Progress,
    sink: &mut Sink,
) -> Result<(Result<Verified<Motion>, Motion>, Certificate), Aborted> {
    let certificate = certify_with(program, &motion, settings, progress, sink)?;
    Ok((if sink.has_errors() { Err(motion) } else { Ok(Verified(motion)) }, certificate))
}

/// Measures a motion; faults and failed contracts go to the sink.
///
/// # Errors
/// The motion is malformed, or the run was cancelled.
pub fn certify(program: &Program, motion: &Motion, sink: &mut Sink) -> Result<Certificate, Aborted> {
    certify_with(program, motion, &mut stock::Settings::default(), &Progress::default(), sink)
}

/// Makes a check, whose time counts under its name, unless the run was cancelled.
fn checked<T>(progress: &Progress, name: &'static str, check: impl FnOnce() -> T) -> Result<T, Aborted> {
    if progress.is_cancelled() { Err(Aborted) } else { Ok(progress.span(name, check)) }
}

/// Gives each operation the time that the machine takes, not the programmed time.
fn machine_times(certificate: &mut Certificate) {
    for (operation, run) in certificate.operations.iter_mut().zip(&certificate.machine.runs) {
        operation.time = run.time;
    }
}

/// [`certify`] with settings of the stock simulation, and with reports of its progress.
///
/// # Errors
/// As [`certify`].
pub fn certify_with(
    program: &Program,
    motion: &Motion,
    settings: &mut stock::Settings<'_>,
    progress: &Progress,
    sink: &mut Sink,
) -> Result<Certificate, Aborted> {
    if !structure::check(program, motion, sink) {
        return Err(Aborted);
    }
    let splines = checked(progress, "splines", || splines::reports(program, motion, sink))?.ok_or(Aborted)?;
    let samples = checked(progress, "samples", || sample::sample(&program.part, SPACING))?;
    let (design_cloud, blank) = checked(progress, "samples", || {
        rayon::join(
            || Cloud::new(sample::cloud_points(&samples)),
            || Cloud::new(revolved(&program.stock.profile, [0.0; 2], STOCK_SPACING, f64::INFINITY).0),
        )
    })?;
    let clouds = Clouds { design: &design_cloud, blank: &blank, search: search(program) };
    let swept = |rounding| {
        let sweep = |o| Sweep::rounded(program, motion, o, rounding);
        checked(progress, "sweeps", || (0..motion.operations.len()).filter_map(sweep).collect::<Vec<_>>())
    };
    let sweeps = swept(settings.rounding)?;
    let proofs = Proofs::of(program, motion, &sweeps, &splines, &clouds, progress)?;
    let roughs = |o: &usize| !program.operations[motion.operations[*o].operation].kind.finishes();
    let roughing: Vec<usize> = (0..motion.operations.len()).filter(roughs).collect();
    let left = program.stock.left.as_ref().map(|mesh| left::Left::new(mesh));
    let stock = checked(progress, "stock", || stock::simulate(program, motion, settings, progress, sink))?;
    let measured = rest::Measured { samples: &samples, design: &design_cloud, start: left.as_ref() };
    let rest = checked(progress, "rest", || rest::reports(program, &measured, &sweeps, &roughing, progress))?;
    let obstacles = checked(progress, "obstacles", || obstacles::check(program, motion, progress))?;
    let mut certificate = Certificate {
        name: program.name.clone(),
        machine_name: program.machine.name.clone(),
        form: stated_points::check(program),
        imported: stated_points::imported(program),
        spacing: Mm(SPACING),
        slack: Mm(surface::SLACK),
        surfaces: proofs.surfaces,
        kept: proofs.kept,
        allowance: proofs.allowance,
        rapid: nearest_rapid(&proofs.operations),
        operations: proofs.operations,
        perimeter: checked(progress, "perimeter", || perimeter::check(program, motion))?,
        machine: checked(progress, "machine", || machine::check(program, motion, stock.as_ref()))?,
        rest,
        stock,
        obstacles,
        clamping: proofs.clamping,
        contracts: Vec::new(),
        allowed: Vec::new(),
    };
    nearer_obstacles(&mut certificate, &splines);
    machine_times(&mut certificate);
    if let Some(left) = &left {
        left.report(program, &samples, sink);
    }
    let narrower = Narrower { program, motion, samples: &samples, splines: &splines, progress };
    let mut found = Sink::default();
    judge(program, motion, &mut certificate, &narrower, &mut found)?;
    let rounded = settings.rounding != PartnerRounding::ARITHMETIC && Sweep::largest_partner_error(&sweeps) > 0.0;
    if found.has_errors() && rounded {
        // What fails may hold without the rounding between sectors.
        let sweeps = swept(PartnerRounding::ARITHMETIC)?;
        let proofs = Proofs::of(program, motion, &sweeps, &splines, &clouds, progress)?;
        (certificate.surfaces, certificate.kept, certificate.allowance) =
            (proofs.surfaces, proofs.kept, proofs.allowance);
        certificate.rapid = nearest_rapid(&proofs.operations);
        (certificate.operations, certificate.clamping) = (proofs.operations, proofs.clamping);
        machine_times(&mut certificate);
        found = Sink::default();
        judge(program, motion, &mut certificate, &narrower, &mut found)?;
    }
    sink.append(found);
    if progress.is_cancelled() { Err(Aborted) } else { Ok(certificate) }
}

/// What is proved of the motion near the part and the clamping: by one sector, as far as the others are the same, turned.
struct Proofs {
    surfaces: Vec<surface::SurfaceReport>,
    kept: kept::KeptSurfaces,
    allowance: Option<allowance::AllowanceReport>,
    operations: Vec<OperationReport>,
    clamping: clamping::ClampingReport,
}

impl Proofs {
    fn of(
        program: &Program,
        motion: &Motion,
        sweeps: &[Sweep<'_>],
        splines: &[Option<splines::SplineReport>],
        clouds: &Clouds<'_>,
        progress: &Progress,
    ) -> Result<Self, Aborted> {
        let chords = splines::widest(splines);
        let bounds = limits(program).narrowed(chords);
        let mut surfaces = checked(progress, "surfaces", || {
            surface::certify(&program.part, program.milled_turned(), sweeps, SPACING, &bounds, progress)
        })?;
        splines::widen(&mut surfaces, chords);
        let kept = checked(progress, "kept surfaces", || kept::check(program, sweeps, chords, progress))?;
        let allowance = checked(progress, "allowance", || allowance::check(program, motion, sweeps, progress))?;
        let report = |o: usize| operation_report(program, motion, o, sweeps, splines[o], clouds, progress);
        let operations = (0..motion.operations.len()).map(|o| checked(progress, "clearance", || report(o)));
        let operations = operations.collect::<Result<Vec<OperationReport>, Aborted>>()?;
        let mut clamping = checked(progress, "clamping", || clamping::check(program, sweeps))?;
        clamping.distance = clamping.distance.map(|distance| Mm(distance.get() - widest_tool(splines)));
        Ok(Self { surfaces, kept, allowance, operations, clamping })
    }
}

/// Judges what was measured and proved.
fn judge(
    program: &Program,
    motion: &Motion,
    certificate: &mut Certificate,
    narrower: &Narrower<'_>,
    sink: &mut Sink,
) -> Result<(), Aborted> {
    report_checks(program, motion, certificate, sink);
    let judged =
        checked(narrower.progress, "contracts", || contracts::judge(program, motion, certificate, narrower, sink))?;
    (certificate.contracts, certificate.allowed) = judged;
    finite::report(program, motion, certificate, sink);
    Ok(())
}

/// The rapid that comes nearest to the stock.
fn nearest_rapid(operations: &[OperationReport]) -> Option<clearance::Clearance> {
    operations.iter().filter_map(|o| o.rapid.clone()).min_by(|a, b| a.distance.total_cmp(&b.distance))
}

/// Reports what the checks without contracts found.
fn report_checks(program: &Program, motion: &Motion, certificate: &Certificate, sink: &mut Sink) {
    report_faults(program, motion, certificate, sink);
    perimeter::report(program, motion, &certificate.perimeter, sink);
    kept::report(program, motion, &certificate.kept, sink);
    if let Some(found) = &certificate.allowance {
        allowance::report(program, motion, found, sink);
    }
    obstacles::report(program, motion, &certificate.obstacles, sink);
    clamping::report(program, motion, &certificate.clamping, sink);
    if let Some(report) = &certificate.stock {
        stock::report(program, motion, report, sink);
    }
}

/// Largest distance of the tool between curves and chords, mm.
fn widest_tool(reports: &[Option<splines::SplineReport>]) -> f64 {
    reports.iter().flatten().map(|r| r.tool.get()).fold(0.0, f64::max)
}

/// Takes the distance between curves and chords from the clearances to table and fixtures.
fn nearer_obstacles(certificate: &mut Certificate, reports: &[Option<splines::SplineReport>]) {
    for obstacle in &mut certificate.obstacles {
        splines::nearer(&mut obstacle.clearance, widest_tool(reports));
    }
}

/// The contracts on gouge and excess, each with its surfaces.
pub fn limits(program: &Program) -> Limits {
    let of = |kind: ContractKind| {
        let contracts = program.contracts.iter().filter(|c| c.kind == kind);
        contracts.map(|c| Limit { bound: Mm(c.bound.value()), surfaces: c.scope.surfaces.clone() }).collect()
    };
    Limits { gouge: of(ContractKind::Gouge), excess: of(ContractKind::Excess) }
}

/// Deepest allowed cut into kept surfaces, mm: the strictest contract on gouge of the whole part and program. Where the
/// job allows gouge, which may extend over the border of a face, at least [`MAX_KEPT_GOUGE`].
fn kept_gouge(program: &Program) -> f64 {
    let whole = program.contracts.iter().filter(|c| c.kind == ContractKind::Gouge && c.scope.is_whole());
    let strictest = whole.map(|c| c.bound.value()).reduce(f64::min).unwrap_or(MAX_KEPT_GOUGE);
    let allowed = program.allowed.iter().any(|a| a.kind == ContractKind::Gouge);
    if allowed { strictest.max(MAX_KEPT_GOUGE) } else { strictest }
}

/// Search distance of shank, holder and rapids, mm: enough to judge every contract on clearance.
pub fn search(program: &Program) -> f64 {
    let required = program.contracts.iter().filter(|c| matches!(c.kind, ContractKind::Clearance(_)));
    required.map(|c| c.bound.value()).fold(BODY_SEARCH_DISTANCE, f64::max)
}

/// Measures again for contracts on some operations or surfaces.
struct Narrower<'a> {
    program: &'a Program,
    motion: &'a Motion,
    samples: &'a [Sample],
    splines: &'a [Option<splines::SplineReport>],
    progress: &'a Progress,
}

impl measure::NarrowMeasure for Narrower<'_> {
    fn is_asked(&self, surface: wheel::part::SurfaceId) -> bool {
        self.program.asks_for(surface)
    }

    fn surfaces(&self, operations: &[bool]) -> Vec<surface::SurfaceReport> {
        let chosen = operations.iter().enumerate().filter(|(_, done)| **done);
        let sweeps: Vec<Sweep<'_>> = chosen.filter_map(|(o, _)| Sweep::new(self.program, self.motion, o)).collect();
        let chords = splines::widest(self.splines);
        let mut surfaces = surface::certify(
            &self.program.part,
            self.program.milled_turned(),
            &sweeps,
            SPACING,
            &limits(self.program).narrowed(chords),
            self.progress,
        );
        splines::widen(&mut surfaces, chords);
        surfaces
    }

    fn clearance(&self, operation: usize, body: Guarded, classes: &[SurfaceClass]) -> Option<clearance::Clearance> {
        let chosen = self.samples.iter().filter(|s| classes.contains(&s.surface.kind.class()));
        let cloud = Cloud::new(sample::cloud_points(chosen));
        let declared = &self.program.operations[self.motion.operations.get(operation)?.operation];
        let pieces = piece::pieces(&self.program.machine, self.motion, operation);
        let distance = if body == Guarded::Shank { shank_distance } else { holder_distance };
        let solid = &self.program.tools[declared.tool].solid;
        let work = self.progress.begin(format!("{}, clearance", declared.name), pieces.len());
        let part = ToolPart::new(solid, distance);
        let mut found = least_over(&pieces, &part, &cloud, HALF_SPACING, self.search(), &work);
        splines::nearer(&mut found, self.splines.get(operation)?.map_or(0.0, |s| s.tool.get()));
        found
    }

    fn part_volume(&self) -> Option<f64> {
        solid::volume(&self.program.part, &self.program.stock, 1e-5).map(|v| v.value)
    }

    fn search(&self) -> f64 {
        search(self.program)
    }
}

/// Upper bound of the distance from a point of a design surface to its nearest sample, mm.
const HALF_SPACING: f64 = SPACING * std::f64::consts::FRAC_1_SQRT_2;

fn shank_distance(s: &ToolSolid, rho: f64, h: f64) -> f64 {
    Section::least_distance(&s.shank, rho, h)
}

fn holder_distance(s: &ToolSolid, rho: f64, h: f64) -> f64 {
    Section::least_distance(&s.holder, rho, h)
}

/// Least distance over pieces, in parallel over groups of pieces; of equal distances the earlier group wins.
fn least_over(
    pieces: &[piece::Piece],
    part: &ToolPart<'_>,
    cloud: &Cloud,
    half_spacing: f64,
    search: f64,
    work: &Work,
) -> Option<clearance::Clearance> {
    let least = |run: &[piece::Piece]| {
        if work.is_cancelled() {
            return None;
        }
        let found = clearance::least(run, part, cloud, half_spacing, search);
        work.advance(run.len());
        found
    };
    let found: Vec<Option<clearance::Clearance>> = pieces.par_chunks(clearance::PIECES_PER_GROUP).map(least).collect();
    found.into_iter().flatten().min_by(|a, b| a.distance.total_cmp(&b.distance))
}

/// Samples from which the clearances of tools are measured.
struct Clouds<'a> {
    /// Design surfaces.
    design: &'a Cloud,
    /// The turned blank.
    blank: &'a Cloud,
    /// Search distance, mm.
    search: f64,
}

fn operation_report(
    program: &Program,
    motion: &Motion,
    o: usize,
    sweeps: &[Sweep<'_>],
    splines: Option<splines::SplineReport>,
    &Clouds { design, blank, search }: &Clouds<'_>,
    progress: &Progress,
) -> OperationReport {
    let operation = &motion.operations[o];
    let declared = &program.operations[operation.operation];
    let tool = &program.tools[declared.tool];
    // The part and the turned blank are the same in each sector.
    let sweep = sweeps.iter().find(|sweep| sweep.operation().is_some_and(|own| own as usize == o));
    let pieces = sweep.map_or_else(Vec::new, Sweep::first_pieces);
    let turned = sweep.map_or(0.0, Sweep::partner_error);
    let mut rapids = pieces.clone();
    rapids.retain(|p| p.kind == MoveKind::Rapid);
    let half_stock = STOCK_SPACING * std::f64::consts::FRAC_1_SQRT_2;
    let (mut length, mut time) = ([0.0; 3], [0.0; 3]);
    let mut before: Option<Point3<f64>> = None;
    for m in &operation.moves {
        let tip = program.machine.forward(&m.joints).tip;
        let kind = match m.kind {
            MoveKind::Cut => 0,
            MoveKind::Link => 1,
            MoveKind::Rapid => 2,
        };
        length[kind] += before.map_or(0.0, |b| (tip - b).norm());
        time[kind] += m.time;
        before = Some(tip);
    }
    let work = progress.begin(format!("{}, clearance", declared.name), 2 * pieces.len() + rapids.len());
    let chords = splines.map_or(0.0, |s| s.tool.get());
    let body = |distance: fn(&ToolSolid, f64, f64) -> f64| {
        let part = ToolPart::new(&tool.solid, distance);
        let mut found = least_over(&pieces, &part, design, HALF_SPACING, search, &work);
        splines::nearer(&mut found, chords + turned);
        found
    };
    let whole = ToolPart::new(&tool.solid, ToolSolid::distance);
    let mut rapid = least_over(&rapids, &whole, blank, half_stock, search, &work);
    splines::nearer(&mut rapid, turned);
    let (shank, holder) = rayon::join(|| body(shank_distance), || body(holder_distance));
    OperationReport {
        name: declared.name.clone(),
        tool: tool.name.clone(),
        passes: operation.labels.len(),
        moves: operation.moves.len(),
        length: length.map(Mm),
        time: time.map(Sec),
        splines,
        shank,
        holder,
        rapid,
    }
}

/// Reports faults that need no contract: axes beyond their limits, rapids through stock; and further remarks.
fn report_faults(program: &Program, motion: &Motion, certificate: &Certificate, sink: &mut Sink) {
    for f in &certificate.machine.faults {
        let what = describe(program, motion, Some(f.at));
        let tip = motion.operations.get(f.at.operation as usize).and_then(|o| o.moves.get(f.at.index as usize));
        let point = tip.map_or_else(Point3::origin, |m| program.machine.forward(&m.joints).tip);
        let (code, text) = if f.speed {
            (verification::AXIS_SPEED, format!("axis {} would need {:.1} % of its speed", f.axis, f.value * 100.0))
        } else {
            (
                verification::AXIS_TRAVEL,
                format!("axis {} goes to {:.3}; its travel ends at {:.3}", f.axis, f.value, f.bound),
            )
        };
        let mut diag = Diag::error(code, text)
            .place(what, point)
            .block(f.at.operation, f.at.index)
            .help("see `impellerc explain` for this code");
        if let Some(o) = motion.operations.get(f.at.operation as usize) {
            diag = diag.label(program.operations[o.operation].span, "in this operation");
        }
        sink.push(diag);
    }
    if let Some(c) = certificate.rapid.as_ref().filter(|c| c.distance.get() <= 0.0) {
        sink.push(
            Diag::error(
                verification::RAPID_IN_STOCK,
                format!("at rapid the tool is {} inside the stock", length(-c.distance.get())),
            )
            .place(describe(program, motion, Some(c.at)), Point3::from(c.point))
            .block(c.at.operation, c.at.index)
            .help("use a longer lead-in or lead-out, so that passes begin and end outside the stock"),
        );
    }
    let missed: f64 =
        certificate.surfaces.iter().filter(|s| s.excess.value.get() >= surface::FAR).map(|s| s.area.get()).sum();
    let judged = program.contracts.iter().any(|c| c.kind == ContractKind::Excess);
    if missed > 0.0 && !judged {
        sink.push(Diag::remark(
            verification::NOT_REACHED,
            format!("surfaces of {missed:.0} mm2 have places that no cutter reaches; the job has no `require excess`"),
        ));
    }
}
