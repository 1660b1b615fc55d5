//! The figures of the proof: as text for people, as JSON for tools.

use super::alike::{Alike, alike};
use super::allowance::AllowanceReport;
use super::carried::{CarriedReport, SEARCH};
use super::clamping::ClampingReport;
use super::clearance::Clearance;
use super::dynamics::{LimitRow, rows};
use super::kept::KeptSurfaces;
use super::machine::{AXIS_UNITS, MachineReport};
use super::perimeter::PerimeterReport;
use super::place::describe;
use super::proof::piece::At;
use super::rest::RestReport;
use super::splines::SplineReport;
use super::stated_points::{self, ImportedReport, StatedReport};
use super::stock::StockReport;
use super::surface::SurfaceReport;
use base::source::Span;
use base::units::length;
use ir::{Motion, Program};
use serde::Serialize;
use std::fmt::Write as _;
use wheel::contract::clock;

/// Moves, lengths and time of one operation.
#[derive(Clone, Debug, Serialize)]
pub struct OperationReport {
    /// Name.
    pub name: String,
    /// Tool.
    pub tool: String,
    /// Passes.
    pub passes: usize,
    /// Moves.
    pub moves: usize,
    /// Length of the tip path while cutting, linking and at rapid, mm.
    pub length: [f64; 3],
    /// Time of cutting, links and rapids, s.
    pub time: [f64; 3],
    /// Spline blocks, where the operation has some.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub splines: Option<SplineReport>,
    /// Least distance of the shank to the design part; `None` when it is beyond the search distance.
    pub shank: Option<Clearance>,
    /// Least distance of the holder.
    pub holder: Option<Clearance>,
    /// Least distance of the whole tool to the turned stock at rapid.
    pub rapid: Option<Clearance>,
}

/// A contract with the found value.
#[derive(Clone, Debug, Serialize)]
pub struct ContractReport {
    /// Quantity, by its name in the job language.
    pub kind: &'static str,
    /// Where the contract holds, as written in the job language: `on hub`; empty for everywhere.
    pub scope: String,
    /// `<=` or `>=`.
    pub relation: &'static str,
    /// Unit of bound and found value: `mm`, `deg`, `s`, `mm3`, `mm3/min`, or `1` for a share of one.
    pub unit: &'static str,
    /// Bound.
    pub bound: f64,
    /// Found value.
    pub found: f64,
    /// Quantity and place in the program, in words.
    pub place: String,
    /// Place on the part, mm; `None` for quantities without a place.
    pub point: Option<[f64; 3]>,
    /// Move of the program; `None` for quantities without a move.
    pub at: Option<At>,
    /// Whether the contract holds.
    pub holds: bool,
    /// True for a default contract, which the job does not state.
    pub default: bool,
    /// Bound and found value for people.
    #[serde(skip)]
    pub figures: [String; 2],
    /// The worst value at the computed points for people, where `found` is a proved bound beyond it.
    #[serde(skip)]
    pub measured: Option<String>,
    /// Its text in the job.
    #[serde(skip)]
    pub span: Span,
}

impl ContractReport {
    /// `gouge on hub`.
    pub fn name(&self) -> String {
        format!("{} {}", self.kind, self.scope).trim_end().to_owned()
    }

    /// Word for the worst of the computed values.
    pub(super) fn extreme(&self) -> &'static str {
        match self.kind {
            "gouge" => "deepest",
            _ if self.relation == ">=" => "least",
            _ => "most",
        }
    }
}

/// An `allow` of the job with the found value.
#[derive(Clone, Debug, Serialize)]
pub struct AllowedReport {
    /// Quantity, by its name in the job language.
    pub kind: &'static str,
    /// Where.
    pub scope: String,
    /// Unit of the figure, as in [`ContractReport::unit`].
    pub unit: &'static str,
    /// Value found there; `None` where it cannot be measured.
    pub found: Option<f64>,
    /// Quantity and place in the program, in words.
    pub place: String,
    /// Place on the part, mm; `None` for quantities without a place.
    pub point: Option<[f64; 3]>,
    /// Move of the program; `None` for quantities without a move.
    pub at: Option<At>,
    /// Reason, in the words of the job.
    pub reason: String,
    /// True when a contract would fail without it.
    pub excuses: bool,
    /// True in place of a default contract: nothing then judges the quantity.
    pub waives: bool,
    /// The figure for people.
    #[serde(skip)]
    pub figure: String,
}

/// The whole proof.
#[derive(Clone, Debug, Serialize)]
pub struct Certificate {
    /// Program name.
    pub name: String,
    /// Machine.
    pub machine_name: String,
    /// Distance of the points that the job states from the surfaces that are cut, a report for each vane of points.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub form: Vec<StatedReport>,
    /// Files that the part was imported from, with what the import states of them; `None` for a part that was not imported.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub imported: Option<ImportedReport>,
    /// Spacing of the samples of the design surfaces, mm.
    pub spacing: f64,
    /// Largest difference between proved bounds and found values, mm.
    pub slack: f64,
    /// Milled surfaces.
    pub surfaces: Vec<SurfaceReport>,
    /// Surfaces that milling must leave as they are.
    pub kept: KeptSurfaces,
    /// Clearance of roughing to the part; `None` without roughing.
    pub allowance: Option<AllowanceReport>,
    /// Operations in order.
    pub operations: Vec<OperationReport>,
    /// Least distance of the whole tool to the turned stock at rapid.
    pub rapid: Option<Clearance>,
    /// Motion before, between and behind the operations.
    pub perimeter: PerimeterReport,
    /// Axes.
    pub machine: MachineReport,
    /// Stock after each roughing operation.
    pub rest: Vec<RestReport>,
    /// The stock through the program; `None` when it could not be simulated.
    pub stock: Option<StockReport>,
    /// Nearest approach to table and fixtures; empty where the machine file has none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub carried: Vec<CarriedReport>,
    /// Nearest approach to the space of chuck and table that the job states.
    pub clamping: ClampingReport,
    /// Contracts.
    pub contracts: Vec<ContractReport>,
    /// Items of `allow`.
    pub allowed: Vec<AllowedReport>,
}

/// Text in place of a figure where no cutter comes near.
pub(super) const NOT_REACHED: &str = "not reached";

/// A figure of the columns in um.
pub(super) fn um(mm: f64) -> String {
    if mm >= super::surface::FAR { NOT_REACHED.to_owned() } else { format!("{:.2}", mm * 1e3) }
}

/// A distance in the columns, mm.
pub(super) fn gap(c: &Option<Clearance>) -> String {
    c.as_ref().map_or("far".to_owned(), |c| format!("{:.3}", c.distance))
}

/// Figures of a surface as in its line: area, gouge and its bound, excess and its bound, percentiles.
fn figures(s: &SurfaceReport) -> [String; 8] {
    let [p5, p50, p95] = s.percentiles.map(um);
    let [gouge, gouge_bound] = [s.gouge.depth, s.gouge_bound].map(um);
    let [excess, excess_bound] = [s.excess.value, s.excess_bound].map(um);
    [format!("{:.1}", s.area), gouge, gouge_bound, excess, excess_bound, p5, p50, p95]
}

impl Certificate {
    /// The lines on the proof at the head of the NC text: whether everything was verified, and what was verified.
    pub fn head(&self) -> Vec<String> {
        let mut lines: Vec<String> = self.not_verified().collect();
        if lines.is_empty() {
            lines.push("verified from the first block to the last".to_owned());
        }
        let [made, sectors] = self.sectors();
        lines.push(format!("machined: {made} of {sectors} sectors"));
        lines.extend(self.not_machined());
        lines.extend(self.not_checked().map(str::to_owned));
        let solids: String = self.carried.iter().map(|c| format!(", {}", c.solid)).collect();
        lines.push(format!(
            "checked: whole tool against part, stock{solids}; travel and speed of all axes; contracts below"
        ));
        lines.push(format!(
            "at the start nothing is taken for known but that Z is not over {:.3}, the retract height",
            self.perimeter.retract
        ));
        lines.push(
            "surfaces are those that the programmed motion leaves; from it the control departs by at most:".to_owned(),
        );
        for (o, run) in self.operations.iter().zip(&self.machine.runs) {
            lines.push(format!("{}: {:.2} um, {:.3} deg", o.name, run.contour.value * 1e3, run.orientation.value));
        }
        lines
    }

    /// A line for each default contract in place of which the job allows the quantity.
    pub(super) fn not_verified(&self) -> impl Iterator<Item = String> {
        let waived = self.allowed.iter().filter(|a| a.waives);
        waived.map(|a| format!("NOT VERIFIED: {}, which the job allows: {}", a.kind, a.reason))
    }

    /// The most by which the control leaves the programmed motion, mm, and the operation.
    pub(super) fn departure(&self) -> Option<(f64, &str)> {
        let all = self.operations.iter().zip(&self.machine.runs).map(|(o, run)| (run.contour.value, o.name.as_str()));
        all.max_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Where the tool stays at rapid.
    pub(super) fn at_rapid(&self) -> String {
        let distance = self.rapid.as_ref().map_or_else(|| "far".to_owned(), |c| length(c.distance));
        format!("  at rapid the tool stays {distance} outside of the stock")
    }

    /// The text form. `places` names the moves.
    pub fn text(&self, program: &Program, motion: &Motion) -> String {
        let mut t = String::new();
        // Writing to a string does not fail.
        let _ = self.write(program, motion, &mut t);
        t
    }

    fn write_surfaces(&self, program: &Program, motion: &Motion, t: &mut String) -> std::fmt::Result {
        writeln!(
            t,
            "surfaces: cutters of the whole program swept against the design, um; proved over cells of {} mm and less; worst first",
            self.spacing
        )?;
        writeln!(
            t,
            "  {:<27} {:>7} {:>8} {:>8}  {:<28} {:>11} {:>11}  {:<28} {:>7} {:>7} {:>7}",
            "surface", "mm2", "gouge", "at most", "at (mm)", "excess", "at most", "at (mm)", "5 %", "50 %", "95 %"
        )?;
        // For each group the largest gouge and the largest excess over all of its vanes.
        let mut groups = alike(&self.surfaces, |s| Some(figures(s).concat()));
        let size = |g: &Alike| {
            let largest = |pick: fn(&SurfaceReport) -> f64| g.worst(&self.surfaces, pick).map_or(0.0, |(_, s)| pick(s));
            largest(|s| s.gouge_bound).max(largest(|s| s.excess_bound))
        };
        groups.sort_by(|a, b| size(b).total_cmp(&size(a)));
        for group in &groups {
            let [Some((_, deepest)), Some((_, most))] =
                [group.worst(&self.surfaces, |s| s.gouge.depth), group.worst(&self.surfaces, |s| s.excess.value)]
            else {
                continue;
            };
            let at = |p: [f64; 3]| format!("({:.3}, {:.3}, {:.3})", p[0], p[1], p[2]);
            let [area, gouge, gouge_bound, excess, excess_bound, p5, p50, p95] = figures(deepest);
            writeln!(
                t,
                "  {:<27} {area:>7} {gouge:>8} {gouge_bound:>8}  {:<28} {excess:>11} {excess_bound:>11}  {:<28} {p5:>7} {p50:>7} {p95:>7}",
                group.name,
                at(deepest.gouge.point),
                at(most.excess.point),
            )?;
        }
        let most = |f: &dyn Fn(&SurfaceReport) -> f64| self.surfaces.iter().max_by(|a, b| f(a).total_cmp(&f(b)));
        let figure = |mm: f64| if mm >= super::surface::FAR { NOT_REACHED.to_owned() } else { length(mm) };
        let bound = |f: &dyn Fn(&SurfaceReport) -> f64| self.surfaces.iter().map(f).fold(0.0, f64::max);
        if let Some(s) = most(&|s| s.gouge.depth) {
            let (found, place) = (figure(s.gouge.depth), describe(program, motion, s.gouge.at));
            let loose = |s: &SurfaceReport| s.gouge_bound > s.gouge.depth + 2.0 * super::surface::SLACK;
            if self.surfaces.iter().any(loose) {
                let broken = length(super::surface::BROKEN);
                writeln!(t, "  deepest gouge found {found} on {}: {place}", s.surface)?;
                writeln!(
                    t,
                    "  a cut over {broken} deeper than its contract has no closer bound than the radius of the cutter"
                )?;
            } else {
                let bound = figure(bound(&|s| s.gouge_bound));
                writeln!(t, "  no gouge over {bound} anywhere, deepest found {found} on {}: {place}", s.surface)?;
            }
        }
        if let Some(s) = most(&|s| s.excess.value) {
            let (found, place) = (figure(s.excess.value), describe(program, motion, s.excess.at));
            match figure(bound(&|s| s.excess_bound)) {
                bound if found == NOT_REACHED => writeln!(t, "  {bound}: {}", s.surface)?,
                bound => writeln!(t, "  nowhere more than {bound} left, most found {found} on {}: {place}", s.surface)?,
            }
        }
        let limit = length(super::surface::NOT_REACHED);
        let missed = |s: &SurfaceReport| {
            let causes: Vec<String> =
                s.nearest_there.iter().map(|(operation, area)| self.cause(*operation, *area)).collect();
            (s.not_reached > 0.0).then(|| causes.join(", "))
        };
        let mut missing = alike(&self.surfaces, missed);
        // As written: areas that differ by rounding alone keep the order of their surfaces.
        let area = |g: &Alike| {
            (100.0 * g.worst(&self.surfaces, |s| s.not_reached).map_or(0.0, |(_, s)| s.not_reached)).round()
        };
        missing.sort_by(|a, b| area(b).total_cmp(&area(a)));
        for group in &missing {
            let Some((_, s)) = group.worst(&self.surfaces, |s| s.not_reached) else { continue };
            let each = if group.members.len() > 1 { ", each" } else { "" };
            let causes = missed(s).unwrap_or_default();
            writeln!(t, "  over {limit} left on {:.2} mm2 of {}{each}: {causes}", s.not_reached, group.name)?;
        }
        Ok(())
    }

    /// Reason why an area is not reached.
    fn cause(&self, operation: Option<u32>, area: f64) -> String {
        match operation.and_then(|o| self.operations.get(o as usize)) {
            Some(o) => format!("{area:.2} mm2 where {} comes nearest", o.name),
            None => format!("{area:.2} mm2 where no operation comes near"),
        }
    }

    fn write(&self, program: &Program, motion: &Motion, t: &mut String) -> std::fmt::Result {
        writeln!(t, "certificate of {} on {}", self.name, self.machine_name)?;
        writeln!(t)?;
        self.write_surfaces(program, motion, t)?;
        writeln!(t)?;
        self.kept.write(t)?;
        stated_points::write(&self.form, t)?;
        if let Some(imported) = &self.imported {
            writeln!(t, "  {}", imported.told(&self.form))?;
        }
        if let Some(allowance) = &self.allowance {
            allowance.write(t)?;
        }
        writeln!(t)?;
        self.write_operations(t)?;
        self.write_splines(t)?;
        writeln!(t)?;
        self.write_rest(t)?;
        writeln!(t)?;
        if let Some(stock) = &self.stock {
            stock.write(t)?;
            writeln!(t)?;
        }
        self.write_axes(t)?;
        self.write_surroundings(program, motion, t)?;
        writeln!(t)?;
        self.write_runs(program, t)?;
        writeln!(t)?;
        self.write_limits(t)?;
        self.write_contracts(t)?;
        self.write_allowed(t)
    }

    /// Spline blocks of each operation that has some.
    fn write_splines(&self, t: &mut String) -> std::fmt::Result {
        for operation in &self.operations {
            let Some(SplineReport { blocks, chords, flutes, .. }) = operation.splines else { continue };
            writeln!(
                t,
                "  {:<12} {blocks} spline blocks, checked on {chords} chords that are at most {:.3} um away; the figures include it",
                operation.name,
                flutes * 1e3
            )?;
        }
        Ok(())
    }

    /// Stock that each roughing operation leaves.
    fn write_rest(&self, t: &mut String) -> std::fmt::Result {
        writeln!(t, "stock after roughing, mm")?;
        for r in &self.rest {
            let name = self.operations.get(r.operation as usize).map_or("", |o| o.name.as_str());
            writeln!(
                t,
                "  {name:<12} least {:>6.3}  median {:>6.3}  most {:>6.3} {} ({:.2}, {:.2}, {:.2}), {:.1} % of the room cleared",
                r.least,
                r.median,
                r.most,
                r.surface.as_ref().map_or_else(|| "inside a channel at".to_owned(), |s| format!("on {s} at")),
                r.point[0],
                r.point[1],
                r.point[2],
                r.cleared * 100.0
            )?;
        }
        Ok(())
    }

    /// The share of travel, speed, acceleration and jerk that the motion takes of each axis.
    fn write_axes(&self, t: &mut String) -> std::fmt::Result {
        writeln!(
            t,
            "axes: used, travel, of the limits: largest speed reached, acceleration asked for inside of blocks, jerk reached"
        )?;
        for (a, unit) in self.machine.axes.iter().zip(AXIS_UNITS) {
            let travel = a
                .travel
                .map_or_else(|| format!("{:>20}", "no limits"), |[low, high]| format!("{low:>8.1} .. {high:>8.1}"));
            writeln!(
                t,
                "  {} {:>10.3} .. {:>10.3} {unit:<3}  of {travel}  {:>5.1} %  {:>5.1} %  {:>5.1} %",
                a.axis,
                a.used[0],
                a.used[1],
                a.speed_share * 100.0,
                a.acceleration_share * 100.0,
                a.jerk_share * 100.0
            )?;
        }
        writeln!(t, "  least distance to the pole while cutting {:.3} deg", self.machine.pole_distance)
    }

    /// Clearances of the tools: to the stock at rapid and between operations, to chuck, table and fixtures.
    fn write_surroundings(&self, program: &Program, motion: &Motion, t: &mut String) -> std::fmt::Result {
        writeln!(t, "{}", self.at_rapid())?;
        let p = &self.perimeter;
        let [.., first, second] = program.machine.names();
        writeln!(
            t,
            "  X, Y, {first} and {second} move without tool centre point control at Z {:.3} of the gauge line only, with every {} at least {}",
            p.retract,
            if program.machine.chain.has_head() { "point of a tool" } else { "tip" },
            length(p.clearance)
        )?;
        writeln!(
            t,
            "  over Z {:.3}, which the {} does not pass under any {first} and {second}; required {}",
            p.height,
            p.highest,
            length(p.required)
        )?;
        if program.machine.chain.has_head() {
            writeln!(t, "  head and spindle above the gauge line are not checked against part and table")?;
        }
        self.clamping.write(program, motion, t)?;
        for c in &self.carried {
            match &c.clearance {
                Some(found) => {
                    let place = describe(program, motion, Some(found.at));
                    let distance = length(found.distance);
                    writeln!(t, "  the {} comes within {distance} of the {}: {place}", c.part, c.solid)?;
                }
                None => writeln!(t, "  no tool comes within {SEARCH} mm of the {}", c.solid)?,
            }
        }
        Ok(())
    }

    /// Every contract with its verdict.
    fn write_contracts(&self, t: &mut String) -> std::fmt::Result {
        if !self.contracts.is_empty() {
            writeln!(t)?;
            writeln!(t, "contracts")?;
        }
        for c in &self.contracts {
            let verdict = if c.holds { "holds" } else { "FAILS" };
            let [bound, found] = &c.figures;
            let default = if c.default { "; the default, as the job says nothing of it" } else { "" };
            writeln!(t, "  {:<9} {} {bound}: {found}, {verdict}{default}", c.name(), c.relation)?;
        }
        if let Some((most, name)) = self.departure() {
            let most = most * 1e3;
            writeln!(t, "  of the programmed motion; the control departs from it by at most {most:.2} um, in {name}")?;
        }
        Ok(())
    }

    /// Every `allow` with its figure.
    fn write_allowed(&self, t: &mut String) -> std::fmt::Result {
        if !self.allowed.is_empty() {
            writeln!(t)?;
            writeln!(t, "allowed: taken out of the contracts")?;
        }
        for a in &self.allowed {
            let needless = if a.excuses { "" } else { "; needless" };
            writeln!(t, "  {} {}: {}, {}: {}{needless}", a.kind, a.scope, a.figure, a.place, a.reason)?;
        }
        Ok(())
    }

    fn write_runs(&self, program: &Program, t: &mut String) -> std::fmt::Result {
        let [.., first, second] = program.machine.names();
        writeln!(
            t,
            "motion between blocks: tip straight, {first} and {second} linear, within accelerations and jerks of the axes. Slowest cutting block"
        )?;
        writeln!(
            t,
            "as a share of its feed; time without bounds on jerks, which is no longer than any run takes, and without bounds on"
        )?;
        writeln!(
            t,
            "accelerations; how far tip or flutes leave the motion, um: rounded corners, control cycle, both at one block, and the"
        )?;
        writeln!(t, "axis in deg; and how far they would by great circles, and by linear joints without TCP")?;
        writeln!(
            t,
            "  {:<12} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9}",
            "operation", "slowest", "no jerk", "unbound", "corners", "cycle", "both", "axis", "circles", "no TCP"
        )?;
        for ((o, run), other) in self.operations.iter().zip(&self.machine.runs).zip(&self.machine.other_rules) {
            writeln!(
                t,
                "  {:<12} {:>7.1} % {:>9} {:>9} {:>9.2} {:>9.2} {:>9.2} {:>9.4} {:>9.2} {:>9.2}",
                o.name,
                run.slowest.value * 100.0,
                clock(run.within_accelerations.iter().sum()),
                clock(run.programmed.iter().sum()),
                run.corners.value * 1e3,
                run.cycle.value * 1e3,
                run.contour.value * 1e3,
                run.orientation.value,
                other.great_circle.value * 1e3,
                other.joints_linear.value * 1e3
            )?;
        }
        Ok(())
    }

    /// For each operation and for the whole program the active limits in shares of the time.
    fn write_limits(&self, t: &mut String) -> std::fmt::Result {
        writeln!(t, "active limits: what bounds the motion, in shares of the time of each kind of moves")?;
        let mut before = "";
        for row in self.limits() {
            let shares: Vec<String> =
                row.shares().iter().map(|(limit, share)| format!("{limit} {share:.1} %")).collect();
            let name = if row.operation == before { "" } else { row.operation };
            writeln!(t, "  {name:<12} {:<5} {:>8}  {}", row.moves, clock(row.time), shares.join(", "))?;
            before = row.operation;
        }
        Ok(())
    }

    /// Times by active limit: each operation and kind of moves, then the whole program.
    pub fn limits(&self) -> Vec<LimitRow<'_>> {
        rows(self.operations.iter().map(|o| o.name.as_str()).zip(&self.machine.runs))
    }

    fn write_operations(&self, t: &mut String) -> std::fmt::Result {
        writeln!(t, "operations: lengths in mm, times in h:mm:ss, distances of shank and holder to the part in mm")?;
        writeln!(
            t,
            "  {:<12} {:<8} {:>6} {:>7} {:>9} {:>9} {:>9} {:>8} {:>8} {:>8} {:>8} {:>8}",
            "operation",
            "tool",
            "passes",
            "moves",
            "cut",
            "link",
            "rapid",
            "t cut",
            "t link",
            "t rapid",
            "shank",
            "holder"
        )?;
        let mut totals = (0, [0.0; 3], [0.0; 3]);
        for o in &self.operations {
            writeln!(
                t,
                "  {:<12} {:<8} {:>6} {:>7} {:>9.0} {:>9.0} {:>9.0} {:>8} {:>8} {:>8} {:>8} {:>8}",
                o.name,
                o.tool,
                o.passes,
                o.moves,
                o.length[0],
                o.length[1],
                o.length[2],
                clock(o.time[0]),
                clock(o.time[1]),
                clock(o.time[2]),
                gap(&o.shank),
                gap(&o.holder)
            )?;
            totals.0 += o.moves;
            for k in 0..3 {
                totals.1[k] += o.length[k];
                totals.2[k] += o.time[k];
            }
        }
        let (moves, length, time) = totals;
        writeln!(
            t,
            "  {:<12} {:<8} {:>6} {:>7} {:>9.0} {:>9.0} {:>9.0} {:>8} {:>8} {:>8}",
            "total",
            "",
            "",
            moves,
            length[0],
            length[1],
            length[2],
            clock(time[0]),
            clock(time[1]),
            clock(time[2])
        )
    }
}
