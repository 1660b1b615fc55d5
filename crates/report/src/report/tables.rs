//! The tables of the report; they can be read without a script.

use super::Input;
use super::places::Places;
use crate::markup::escaped;
use crate::proof::{self, Text};
use crate::table::{Form, Table, figures, words};
use diagnostics::{Diag, Severity};
use ir::Tool;
use wheel::contract::clock;

/// Part, machine, dialect, inputs: one line per fact.
pub(super) fn header(input: &Input<'_>) -> String {
    let certificate = input.certificate;
    let vanes = input.program.part.vane_count;
    let lines = |text: &str| format!("{} lines", text.lines().count());
    let imported = certificate
        .imported
        .as_ref()
        .map(|imported| ("imported part", proof::surfaces::imported(imported, &certificate.form)));
    let facts = [
        ("machine", certificate.machine_name.clone()),
        ("NC dialect", input.post.to_owned()),
        ("NC program", input.nc_text.map_or_else(|| "none: a fault stopped it".to_owned(), lines)),
        ("machining time", format!("{} h:mm:ss", clock(certificate.time().get()))),
        ("vanes", vanes.to_string()),
        ("deviations proved over", format!("cells of {} mm and less", certificate.spacing.get())),
    ];
    let item = |(name, value): &(&str, String)| format!("<div><dt>{name}</dt><dd>{}</dd></div>\n", escaped(value));
    facts.iter().chain(&imported).map(item).collect()
}

/// Hash of the inputs, and the compiler.
pub(super) fn inputs(input: &Input<'_>) -> String {
    let compiler = format!("impellerc {}", env!("CARGO_PKG_VERSION"));
    format!("<p>Made by {compiler} from inputs with sha256 <code>{}</code>.</p>\n", escaped(input.hash))
}

/// The verdict: all contracts hold, or the number that does not. Returns its class and its text.
pub(super) fn verdict(input: &Input<'_>) -> (&'static str, String) {
    let errors = input.findings.iter().filter(|d| d.severity == Severity::Error).count();
    let contracts = &input.certificate.contracts;
    let failed = contracts.iter().filter(|c| !c.holds).count();
    let (class, text) = judged(contracts.len(), failed, errors);
    // How much of the part was judged.
    let [made, sectors] = input.certificate.sectors();
    (class, format!("{text}; {made} of {sectors} sectors"))
}

fn judged(contracts: usize, failed: usize, errors: usize) -> (&'static str, String) {
    match (failed, errors) {
        (0, 0) if contracts == 0 => ("good", "no fault found, no contract given".to_owned()),
        (0, 0) if contracts == 1 => ("good", "the contract holds".to_owned()),
        (0, 0) => ("good", format!("all {contracts} contracts hold")),
        (0, n) => ("bad", format!("{n} faults, no NC program")),
        (n, _) => ("bad", format!("{n} of {contracts} contracts fail")),
    }
}

/// Contracts, and what the job allows.
pub(super) fn contracts(input: &Input<'_>, places: &Places) -> String {
    let certificate = input.certificate;
    let mut out = if certificate.contracts.is_empty() {
        "<p>The job has no <code>require</code>: nothing was required.</p>".to_owned()
    } else {
        let place = |row: usize, _| places.contracts.get(row).copied().flatten();
        proof::contracts::contracts(Text::Page(&place), certificate).page()
    };
    if !certificate.allowed.is_empty() {
        let place = |row: usize, _| places.allowed.get(row).copied().flatten();
        out.push_str(&proof::contracts::allowed(Text::Page(&place), certificate).page());
    }
    out
}

/// Operations with their times, paths and clearances.
pub(super) fn operations(input: &Input<'_>, places: &Places) -> String {
    let place = |row: usize, figure: usize| places.operations.get(row).and_then(|p| p[figure]);
    proof::operations::operations(Text::Page(&place), input.program, input.certificate, &[]).page()
}

/// Stock, surfaces, rest, axes, tools, notes.
pub(super) fn details(input: &Input<'_>, places: &Places) -> String {
    let certificate = input.certificate;
    let in_stock = |row: usize, figure: usize| places.stock.get(row).and_then(|p| p[figure]);
    let on_surface = |row: usize, figure: usize| places.surfaces.get(row).and_then(|p| p[figure]);
    let of_rest = |row: usize, _| places.rest.get(row).copied();
    let stock = certificate.stock.as_ref().map(|stock| proof::stock::stock(Text::Page(&in_stock), stock));
    let rest = proof::surfaces::rest(Text::Page(&of_rest), certificate);
    let notes = notes(input);
    let tables = [
        Some(proof::surfaces::surfaces(Text::Page(&on_surface), certificate)),
        (!rest.is_empty()).then_some(rest),
        Some(proof::machine::axes(Text::Page(&|_, _| None), certificate)),
        Some(tools(input)),
        (!notes.is_empty()).then_some(notes),
    ];
    stock.into_iter().chain(tables.into_iter().flatten()).map(|table| table.page()).collect()
}

/// Decisions of planning.
fn notes(input: &Input<'_>) -> Table {
    type Row = (String, String);
    let columns = vec![words("operation", 0, |r: &&Row| r.0.clone()), words("decision", 0, |r: &&Row| r.1.clone())];
    Table::new("How the operations were planned", input.notes, columns)
}

/// The diagnostics, worst first.
pub(super) fn findings(input: &Input<'_>, places: &Places) -> String {
    type Row<'a> = (usize, &'a Diag);
    let mut rows: Vec<Row> = input.findings.iter().enumerate().collect();
    rows.sort_by_key(|(_, d)| std::cmp::Reverse(d.severity));
    let severity = |r: &Row| match r.1.severity {
        Severity::Error => ("bad", "error"),
        Severity::Warning => ("warn", "warning"),
        Severity::Remark => ("", "remark"),
    };
    let place = |r: &Row| r.1.place.as_ref().map_or_else(String::new, |p| p.what.clone());
    let columns = vec![
        words("code", 0, |r: &Row| format!("{} {}", severity(r).1, r.1.code.id())).mark(|r: &Row| severity(r).0),
        words("what", 0, |r: &Row| r.1.message.clone()),
        words("where", 0, place).place(|r: &Row| places.findings.get(r.0).copied().flatten()),
        words("remedy", 0, |r: &Row| r.1.help.clone().unwrap_or_default()),
    ];
    if rows.is_empty() { String::new() } else { Table::new("Findings", rows, columns).page() }
}

fn tools(input: &Input<'_>) -> Table {
    type Row<'a> = &'a Tool;
    let reach = |t: &Row| t.solid.holder.first().map_or(t.solid.length(), |s| s.from);
    let columns = vec![
        words("tool", 0, |t: &Row| t.name.clone()),
        figures("number", 0, Form::WHOLE, |t: &Row| t.number.to_string()),
        words("cutter", 0, |t: &Row| t.solid.cutter.keyword().to_owned()),
        figures("diameter, mm", 0, Form::THOUSANDTHS, |t: &Row| 2.0 * t.solid.radius()),
        figures("flutes", 0, Form::WHOLE, |t: &Row| t.flutes.to_string()),
        figures("flute length, mm", 0, Form::TENTHS, |t: &Row| t.solid.flute_length),
        figures("reach to holder, mm", 0, Form::TENTHS, reach),
    ];
    Table::new("Tools", input.program.tools.iter().map(|(_, tool)| tool), columns)
}
