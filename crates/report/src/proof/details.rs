//! All figures of a certificate, as a run prints them with `--details`.

use super::{Text, contracts, machine, operations, stock, summary, surfaces};
use crate::table::{Form, Table};
use ir::{Motion, Program};
use verify::Certificate;

/// The text; the motion names the places of moves.
pub fn details(program: &Program, motion: &Motion, certificate: &Certificate) -> String {
    let mut tables = vec![
        Table::lines(format!("certificate of {} on {}", certificate.name, certificate.machine_name), Vec::new()),
        surfaces::surfaces(Text::Details, certificate)
            .with(surfaces::worst(program, motion, certificate).into_iter().chain(summary::following(certificate))),
        surfaces::kept(certificate),
        operations::operations(Text::Details, program, certificate, &[]),
        surfaces::rest(Text::Details, certificate),
    ];
    tables.extend(certificate.stock.iter().flat_map(|found| [stock::stock(Text::Details, found), stock::arcs(found)]));
    tables.extend([
        machine::axes(Text::Details, certificate).with(machine::surroundings(program, motion, certificate)),
        machine::runs(program, certificate),
        machine::limits(certificate),
    ]);
    if !certificate.contracts.is_empty() {
        tables.push(contracts::contracts(Text::Details, certificate));
    }
    let um = |mm: f64| format!("{} um", Form::UM.of(mm));
    if let Some(last) = tables.last_mut() {
        last.notes.extend(machine::deviation(certificate, um, "at most"));
    }
    if !certificate.allowed.is_empty() {
        tables.push(contracts::allowed(Text::Details, certificate));
    }
    tables.iter().map(Table::text).collect::<Vec<_>>().join("\n")
}
