//! The certificate in short: verdict, contracts, operations and surfaces, in lines of at most 100 columns.

use super::alike::{Alike, alike};
use super::certificate::{Certificate, ContractReport, gap, um};
use super::surface::{self, FAR, SurfaceReport};
use base::units::length;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use wheel::contract::clock;

/// Most columns of a line.
pub const COLUMNS: usize = 100;

/// What the first line says besides the figures of the certificate.
#[derive(Clone, Copy, Debug)]
pub struct Verdict<'a> {
    /// Errors of the run.
    pub errors: usize,
    /// What failed besides the contracts, each with its code.
    pub faults: &'a [String],
    /// Part or NC text that is judged.
    pub name: &'a str,
    /// Machine with its origin: `5mc850-c (shipped)`.
    pub machine: &'a str,
    /// Dialect.
    pub post: &'a str,
}

/// What no figure of the certificate contains.
const NOT_COVERED: &str =
    "not covered: deflection of tool and part, run-out, heat, wear, chatter, errors of the machine";

/// Share of the area of a surface that is left where the operations do not machine the surface.
const UNTOUCHED: f64 = 0.999;

/// A text in lines of at most [`COLUMNS`]; the lines after the first are indented.
fn wrapped(text: &str, indent: usize) -> String {
    let mut lines = String::new();
    let mut columns = 0;
    for word in text.split(' ') {
        let due = word.chars().count() + 1;
        if columns + due > COLUMNS && columns > indent {
            let _ = write!(lines, "\n{:indent$}", "");
            columns = indent;
        } else if columns > 0 {
            lines.push(' ');
        }
        lines.push_str(word);
        columns += due;
    }
    lines + "\n"
}

/// A name that keeps its columns: a longer name loses its end.
fn short(name: &str, columns: usize) -> String {
    if name.chars().count() <= columns {
        return name.to_owned();
    }
    name.chars().take(columns.saturating_sub(2)).chain("..".chars()).collect()
}

/// Area that is left over the limit, as a share of the surface.
fn left_share(s: &SurfaceReport) -> f64 {
    if s.area > 0.0 { s.not_reached / s.area } else { 0.0 }
}

impl Certificate {
    /// Time of all operations, s.
    pub fn time(&self) -> f64 {
        self.operations.iter().flat_map(|o| o.time).sum()
    }

    /// The first line: whether the program may run, and what was judged.
    pub fn verdict(&self, verdict: Verdict<'_>) -> String {
        let Verdict { errors, name, machine, post, .. } = verdict;
        let held = self.contracts.iter().filter(|c| c.holds).count();
        let passed = errors == 0 && held == self.contracts.len();
        let word = if passed { "PASS" } else { "FAIL" };
        let (all, [made, sectors]) = (self.contracts.len(), self.sectors());
        let hold = if passed { "" } else { " hold" };
        // A contract that fails is an error as well.
        let others = match errors.saturating_sub(all - held) {
            0 => String::new(),
            1 => ", 1 other fault".to_owned(),
            n => format!(", {n} other faults"),
        };
        let time = clock(self.time());
        format!(
            "{word} {name}: {held} of {all} contracts{hold}{others}, {made} of {sectors} sectors, {time}, {machine}, {post}\n"
        )
    }

    /// Sectors that are machined, and all sectors: of each kind of surface that is machined at all, so many at least. A passage
    /// lies between the faces of two blades, so that the surfaces of one sector are not those of one passage.
    pub fn sectors(&self) -> [usize; 2] {
        let all: BTreeSet<_> = self.surfaces.iter().map(|s| s.id.sector).collect();
        let mut of_kind = BTreeMap::new();
        for surface in self.surfaces.iter().filter(|s| left_share(s) < UNTOUCHED) {
            *of_kind.entry(surface.id.kind).or_insert(0) += 1;
        }
        let made = of_kind.into_values().min().unwrap_or(0);
        [made, all.len()]
    }

    /// The surfaces that no operation machines, in words; `None` where there are none.
    pub fn not_machined(&self) -> Option<String> {
        let untouched = alike(&self.surfaces, |s| (left_share(s) >= UNTOUCHED).then(String::new));
        let names: Vec<&str> = untouched.iter().map(|g| g.name.as_str()).collect();
        (!names.is_empty()).then(|| format!("not machined: {}", names.join(", ")))
    }

    /// What the proof does not know of the machine, in words; `None` where the machine file has table or fixtures.
    pub fn not_checked(&self) -> Option<&'static str> {
        self.carried.is_empty().then_some("not checked: table and fixtures, of which the machine file has none")
    }

    /// Verdict and contracts; the contracts that fail come first.
    pub fn judgement(&self, verdict: Verdict<'_>) -> String {
        let mut t = self.verdict(verdict);
        for fault in verdict.faults {
            t.push_str(&wrapped(&format!("! {fault}"), 4));
        }
        for line in self.not_verified() {
            t.push_str(&wrapped(&line, 2));
        }
        if let Some(line) = self.not_machined() {
            t.push_str(&wrapped(&format!("  {line}"), 4));
        }
        t.push('\n');
        let (holds, fails): (Vec<_>, Vec<_>) = self.contracts.iter().partition(|c| c.holds);
        for contract in fails.into_iter().chain(holds) {
            t.push_str(&statement(contract));
        }
        for a in self.allowed.iter().filter(|a| !a.waives) {
            t.push_str(&wrapped(&format!("  allowed: {} {}, {}: {}", a.kind, a.scope, a.figure, a.reason), 4));
        }
        t
    }

    /// The short form.
    pub fn summary(&self, verdict: Verdict<'_>) -> String {
        let mut t = self.judgement(verdict);
        // Writing to a string does not fail.
        let _ = self.write_short(&mut t);
        t
    }

    fn write_short(&self, t: &mut String) -> std::fmt::Result {
        writeln!(t)?;
        self.write_short_operations(t)?;
        writeln!(t)?;
        self.write_short_surfaces(t)?;
        writeln!(t)?;
        self.write_remarks(t)
    }

    fn write_short_operations(&self, t: &mut String) -> std::fmt::Result {
        let cells: [&str; 8] = ["passes", "moves", "cutting", "time", "links", "rapids", "shank", "holder"];
        let [passes, moves, cutting, time, links, rapids, shank, holder] = cells;
        writeln!(
            t,
            "  {:<14} {:<10} {passes:>6} {moves:>7} {cutting:>10} {time:>8} {links:>8} {rapids:>8} {shank:>8} {holder:>8}",
            "operation", "tool"
        )?;
        for o in &self.operations {
            let [cut, link, rapid] = o.time.map(clock);
            writeln!(
                t,
                "  {:<14} {:<10} {:>6} {:>7} {:>7.0} mm {cut:>8} {link:>8} {rapid:>8} {:>8} {:>8}",
                short(&o.name, 14),
                short(&o.tool, 10),
                o.passes,
                o.moves,
                o.length[0],
                gap(&o.shank),
                gap(&o.holder)
            )?;
        }
        writeln!(t, "  shank, holder: least distance to the part, mm")
    }

    /// The surfaces that the operations machine, worst first.
    fn write_short_surfaces(&self, t: &mut String) -> std::fmt::Result {
        let figures = |s: &SurfaceReport| {
            let all = [s.gouge_bound, s.gouge.depth, s.excess_bound, s.excess.value].map(um);
            (left_share(s) < UNTOUCHED).then(|| all.concat())
        };
        let mut machined = alike(&self.surfaces, figures);
        let size = |g: &Alike| {
            g.worst(&self.surfaces, |s| s.gouge_bound.max(s.excess_bound))
                .map_or(0.0, |(_, s)| s.gouge_bound.max(s.excess_bound))
        };
        machined.sort_by(|a, b| size(b).total_cmp(&size(a)));
        if !machined.is_empty() {
            let left = format!("over {}", length(surface::NOT_REACHED));
            writeln!(
                t,
                "  {:<30} {:>9} {:>9} {:>12} {:>12} {left:>14}",
                "surface, um", "gouge <=", "found", "excess <=", "found"
            )?;
        }
        for group in &machined {
            let Some((_, deepest)) = group.worst(&self.surfaces, |s| s.gouge_bound) else { continue };
            let Some((_, most)) = group.worst(&self.surfaces, |s| s.excess_bound) else { continue };
            let left = match left_share(most) {
                0.0 => "-".to_owned(),
                share => format!("{:.2} %", share * 100.0),
            };
            writeln!(
                t,
                "  {:<30} {:>9} {:>9} {:>12} {:>12} {left:>14}",
                short(&group.name, 30),
                um(deepest.gouge_bound),
                um(deepest.gouge.depth),
                um(most.excess_bound),
                um(most.excess.value)
            )?;
        }
        Ok(())
    }

    /// What lies beside the design surfaces, and what no figure covers.
    fn write_remarks(&self, t: &mut String) -> std::fmt::Result {
        let kept = &self.kept;
        if let Some(worst) = kept.surfaces.iter().max_by(|a, b| a.gouge_bound.total_cmp(&b.gouge_bound)) {
            writeln!(
                t,
                "  turned surfaces: gouge <= {} (found {}) on {}, allowed {}",
                length(worst.gouge_bound),
                length(worst.gouge.depth),
                worst.surface,
                length(kept.allowed)
            )?;
        }
        writeln!(t, "{}", self.at_rapid())?;
        if let Some(stock) = &self.stock {
            let collisions = stock.collisions().count();
            let hits = if collisions == 0 { "no collision".to_owned() } else { format!("{collisions} collisions") };
            writeln!(
                t,
                "  shank and holder with the stock: {hits}; in air {:.1} % of the time",
                stock.air_share() * 100.0
            )?;
        }
        if let Some((most, name)) = self.departure() {
            writeln!(
                t,
                "  figures are those of the programmed motion; the control departs from it by <= {}, in {name}",
                length(most)
            )?;
        }
        if let Some(line) = self.not_checked() {
            writeln!(t, "  {line}")?;
        }
        writeln!(t, "  {NOT_COVERED}")
    }
}

/// A contract with what was proved and where.
fn statement(c: &ContractReport) -> String {
    let [bound, found] = &c.figures;
    let mark = if c.holds { "  " } else { "! " };
    let proved = match &c.measured {
        Some(measured) if c.found < FAR => format!("proved {} {found} ({} found {measured})", c.relation, c.extreme()),
        _ => format!("found {found}"),
    };
    let verdict = if c.holds { "" } else { "FAILS: " };
    let default = if c.default { ", by default" } else { "" };
    let first = format!("{mark}{:<32} {verdict}{proved}{default}", format!("{} {} {bound}", c.name(), c.relation));
    let mut t = wrapped(&first, 6);
    if c.found < FAR && !c.place.is_empty() {
        t.push_str(&wrapped(&format!("      {}", c.place), 6));
    }
    t
}
