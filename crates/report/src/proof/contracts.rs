//! Contracts and what the job allows, each with its figure.

use super::Text;
use crate::table::{Form, Table, figures, words};
use verify::Certificate;
use verify::certificate::{AllowedReport, ContractReport};
use verify::contracts::amount;
use wheel::contract::{ContractKind, Relation};

/// Bound and found value of a contract.
pub fn bound_and_found(c: &ContractReport) -> [String; 2] {
    [c.kind.bound(c.bound).figure(), amount(c.kind, c.found)]
}

/// The worst value at the computed points, where what is found is a proved bound beyond it.
pub fn computed(c: &ContractReport) -> Option<String> {
    c.computed.map(|value| amount(c.kind, value))
}

/// What was found of an allowed quantity.
pub fn allowed_figure(a: &AllowedReport) -> String {
    a.found.map_or_else(|| "no figure".to_owned(), |value| amount(a.kind, value))
}

/// The figure with the symbols of the page.
pub(crate) fn with_symbols(text: &str) -> String {
    text.replace("um", "\u{b5}m").replace("mm3", "mm\u{b3}")
}

/// What was found, with the symbols of the page. For gouge and excess it is the proved bound.
pub(crate) fn proved(c: &ContractReport) -> String {
    let found = with_symbols(&bound_and_found(c)[1]);
    if matches!(c.kind, ContractKind::Gouge | ContractKind::Excess) { format!("\u{2264} {found}") } else { found }
}

/// The contracts.
pub(crate) fn contracts(text: Text<'_>, certificate: &Certificate) -> Table {
    type Row<'a> = (usize, &'a ContractReport);
    let rows = certificate.contracts.iter().enumerate();
    let name = |r: &Row| r.1.name();
    let verdict = |r: &Row| if r.1.holds { "holds" } else { "FAILS" }.to_owned();
    match text {
        Text::Page(_) => {
            let wanted = |r: &Row| {
                let relation = if r.1.relation == Relation::AtLeast { "at least" } else { "at most" };
                format!("{relation} {}", with_symbols(&bound_and_found(r.1)[0]))
            };
            let columns = vec![
                words("contract", 0, name),
                figures("wanted", 0, Form::WHOLE, wanted),
                figures("found", 0, Form::WHOLE, |r: &Row| proved(r.1)).place(|r: &Row| text.place(r.0, 0)),
                words("verdict", 0, verdict).mark(|r: &Row| if r.1.holds { "good" } else { "bad" }),
            ];
            Table::new("Contracts", rows, columns)
        }
        Text::Sheet => {
            let columns = vec![
                words("contract", 0, name),
                figures("required", 0, Form::WHOLE, |r: &Row| {
                    format!("{} {}", r.1.relation.sign(), bound_and_found(r.1)[0])
                }),
                figures("found", 0, Form::WHOLE, |r: &Row| bound_and_found(r.1)[1].clone()),
                words("verdict", 0, verdict),
            ];
            Table::new("", rows, columns)
        }
        Text::Summary | Text::Details => {
            let line = |r: Row| {
                let [bound, found] = bound_and_found(r.1);
                let default = if r.1.default { "; the default, as the job says nothing of it" } else { "" };
                format!("{:<9} {} {bound}: {found}, {}{default}", name(&r), r.1.relation.sign(), verdict(&r))
            };
            Table::lines("contracts", rows.map(line).collect())
        }
    }
}

/// What the job allows.
pub(crate) fn allowed(text: Text<'_>, certificate: &Certificate) -> Table {
    type Row<'a> = (usize, &'a AllowedReport);
    let rows = certificate.allowed.iter().enumerate();
    if let Text::Page(_) = text {
        let reason = |r: &Row| if r.1.excuses { r.1.reason.clone() } else { format!("{} (needless)", r.1.reason) };
        let columns = vec![
            words("allowed", 0, |r: &Row| format!("{} {}", r.1.kind.name(), r.1.scope)),
            figures("found", 0, Form::WHOLE, |r: &Row| with_symbols(&allowed_figure(r.1)))
                .place(|r: &Row| text.place(r.0, 0)),
            words("reason", 0, reason),
        ];
        return Table::new("Knowingly left", rows, columns);
    }
    let line = |(_, a): Row| {
        let needless = if a.excuses { "" } else { "; needless" };
        format!("{} {}: {}, {}: {}{needless}", a.kind.name(), a.scope, allowed_figure(a), a.place, a.reason)
    };
    Table::lines("allowed: taken out of the contracts", rows.map(line).collect())
}

/// An allowed quantity with its figure and its reason.
pub fn allowed_line(a: &AllowedReport) -> String {
    format!("{} {}, {}: {}", a.kind.name(), a.scope, allowed_figure(a), a.reason)
}
