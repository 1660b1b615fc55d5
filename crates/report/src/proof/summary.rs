//! The certificate in short: verdict, contracts, operations and surfaces, in lines of at most 100 columns.

use super::contracts::{allowed_line, bound_and_found, computed};
use super::{Text, machine, operations, surfaces};
use crate::table::{Form, Table};
use base::units::length;
use ir::Program;
use std::fmt::Write as _;
use verify::Certificate;
use verify::certificate::ContractReport;
use verify::surface::FAR;
use wheel::contract::{ContractKind, Relation, clock};

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

/// The first line: whether the program may run, and what was judged.
pub fn first_line(certificate: &Certificate, verdict: Verdict<'_>) -> String {
    let Verdict { errors, name, machine, post, .. } = verdict;
    let held = certificate.contracts.iter().filter(|c| c.holds).count();
    let passed = errors == 0 && held == certificate.contracts.len();
    let word = if passed { "PASS" } else { "FAIL" };
    let (all, [made, sectors]) = (certificate.contracts.len(), certificate.sectors());
    let hold = if passed { "" } else { " hold" };
    // A contract that fails is an error as well.
    let others = match errors.saturating_sub(all - held) {
        0 => String::new(),
        1 => ", 1 other fault".to_owned(),
        n => format!(", {n} other faults"),
    };
    let time = clock(certificate.time().get());
    format!(
        "{word} {name}: {held} of {all} contracts{hold}{others}, {made} of {sectors} sectors, {time}, {machine}, {post}\n"
    )
}

/// A line for each default contract in place of which the job allows the quantity.
pub(super) fn not_verified(certificate: &Certificate) -> impl Iterator<Item = String> {
    let waived = certificate.allowed.iter().filter(|a| a.waives);
    waived.map(|a| format!("NOT VERIFIED: {}, which the job allows: {}", a.kind.name(), a.reason))
}

/// What the proof does not know of the machine, in words; `None` where the machine file has table or fixtures.
pub(crate) fn not_checked(certificate: &Certificate) -> Option<&'static str> {
    certificate.obstacles.is_empty().then_some("not checked: table and fixtures, of which the machine file has none")
}

/// Verdict and contracts; the contracts that fail come first.
pub fn judgement(certificate: &Certificate, verdict: Verdict<'_>) -> String {
    let mut t = first_line(certificate, verdict);
    for fault in verdict.faults {
        t.push_str(&wrapped(&format!("! {fault}"), 4));
    }
    for line in not_verified(certificate) {
        t.push_str(&wrapped(&line, 2));
    }
    if let Some(line) = surfaces::not_machined(certificate) {
        t.push_str(&wrapped(&format!("  {line}"), 4));
    }
    t.push('\n');
    let (holds, fails): (Vec<_>, Vec<_>) = certificate.contracts.iter().partition(|c| c.holds);
    for contract in fails.into_iter().chain(holds) {
        t.push_str(&statement(contract));
    }
    for a in certificate.allowed.iter().filter(|a| !a.waives) {
        t.push_str(&wrapped(&format!("  allowed: {}", allowed_line(a)), 4));
    }
    t
}

/// The short form.
pub fn summary(program: &Program, certificate: &Certificate, verdict: Verdict<'_>) -> String {
    let tables = [
        operations::operations(Text::Summary, program, certificate, &[]),
        surfaces::surfaces(Text::Summary, certificate),
        Table::lines("", remarks(certificate)),
    ];
    tables.iter().fold(judgement(certificate, verdict), |text, table| text + "\n" + &table.text())
}

/// Turned surfaces, rapids, stock and control, and what no figure covers.
fn remarks(certificate: &Certificate) -> Vec<String> {
    let mut lines = Vec::new();
    let kept = &certificate.kept;
    if let Some(worst) = kept.surfaces.iter().max_by(|a, b| a.gouge_bound.total_cmp(&b.gouge_bound)) {
        lines.push(format!(
            "turned surfaces: gouge <= {} (found {}) on {}, allowed {}",
            length(worst.gouge_bound.get()),
            length(worst.gouge.depth.get()),
            worst.surface,
            length(kept.allowed.get())
        ));
    }
    lines.extend(following(certificate));
    lines.push(machine::at_rapid(certificate));
    if let Some(stock) = &certificate.stock {
        let collisions = stock.collisions().count();
        let hits = if collisions == 0 { "no collision".to_owned() } else { format!("{collisions} collisions") };
        let air = Form::PERCENT.of(stock.air_share());
        lines.push(format!("shank and holder with the stock: {hits}; in air {air} of the time"));
    }
    lines.extend(machine::deviation(certificate, length, "<=").map(|line| format!("figures are those {line}")));
    lines.extend(not_checked(certificate).map(str::to_owned));
    lines.push(NOT_COVERED.to_owned());
    lines
}

/// How many surfaces follow from those of another sector.
pub(super) fn following(certificate: &Certificate) -> Option<String> {
    let all = &certificate.surfaces;
    let count = all.iter().filter(|s| s.follows.is_some()).count();
    let others = all.len() - count;
    (count > 0).then(|| {
        format!("{others} surfaces proved; the program is the same, turned, near {count} more, for which the proof holds too")
    })
}

/// A contract with what was proved and where.
fn statement(c: &ContractReport) -> String {
    let [bound, found] = bound_and_found(c);
    let mark = if c.holds { "  " } else { "! " };
    let proved = match computed(c) {
        Some(measured) if c.found < FAR => {
            format!("proved {} {found} ({} found {measured})", c.relation.sign(), extreme(c))
        }
        _ => format!("found {found}"),
    };
    let verdict = if c.holds { "" } else { "FAILS: " };
    let default = if c.default { ", by default" } else { "" };
    let first =
        format!("{mark}{:<32} {verdict}{proved}{default}", format!("{} {} {bound}", c.name(), c.relation.sign()));
    let mut t = wrapped(&first, 6);
    if c.found < FAR && !c.place.is_empty() {
        t.push_str(&wrapped(&format!("      {}", c.place), 6));
    }
    t
}

/// Word for the worst of the computed values.
fn extreme(c: &ContractReport) -> &'static str {
    match c.kind {
        ContractKind::Gouge => "deepest",
        _ if c.relation == Relation::AtLeast => "least",
        _ => "most",
    }
}
