//! Contracts of the job against what was measured.

use super::certificate::{Certificate, ContractReport, contract_name, describe};
use super::clearance::Clearance;
use super::surface::{FAR, SurfaceReport, Worst};
use super::sweep::At;
use crate::diag::{Code, Diag, Sink, codes::verification};
use crate::ir::{Contract, ContractKind, Motion, Program};
use nalgebra::Point3;

/// A measured value with its place.
struct Found {
    value: f64,
    what: String,
    point: [f64; 3],
    at: Option<At>,
}

/// Judges all contracts; failing ones become errors.
pub(super) fn judge(
    program: &Program,
    motion: &Motion,
    certificate: &Certificate,
    sink: &mut Sink,
) -> Vec<ContractReport> {
    program
        .contracts
        .iter()
        .filter_map(|contract| {
            let found = measure(contract.kind, certificate)?;
            let bound = contract.bound.get();
            let holds = match contract.kind {
                ContractKind::Clearance => found.value >= bound,
                _ => found.value <= bound,
            };
            if !holds {
                sink.push(failure(program, motion, contract, &found));
            }
            Some(ContractReport { kind: contract_name(contract.kind), bound, found: found.value, holds })
        })
        .collect()
}

fn measure(kind: ContractKind, certificate: &Certificate) -> Option<Found> {
    let on_surface = |pick: fn(&SurfaceReport) -> &Worst, sign: f64| {
        let s = certificate.surfaces.iter().max_by(|a, b| (sign * pick(a).value).total_cmp(&(sign * pick(b).value)))?;
        let w = pick(s);
        Some(Found { value: (sign * w.value).max(0.0), what: s.surface.clone(), point: w.point, at: w.at })
    };
    match kind {
        ContractKind::Gouge => {
            let s = certificate.surfaces.iter().max_by(|a, b| a.gouge.depth.total_cmp(&b.gouge.depth))?;
            let (value, w) = (s.gouge.depth, &s.gouge);
            Some(Found { value, what: s.surface.clone(), point: w.point, at: w.at })
        }
        ContractKind::Excess => on_surface(|s| &s.excess, 1.0),
        ContractKind::Clearance => {
            let near = |c: &Clearance, what: &str| Found {
                value: c.distance,
                what: what.to_owned(),
                point: c.point,
                at: Some(c.at),
            };
            let all = certificate.operations.iter().flat_map(|o| {
                let shank = o.shank.as_ref().map(|c| near(c, "shank"));
                let holder = o.holder.as_ref().map(|c| near(c, "holder"));
                shank.into_iter().chain(holder)
            });
            // A body that never comes within the search distance keeps any sensible clearance.
            let far =
                Found { value: super::BODY_SEARCH, what: "shank and holder".to_owned(), point: [0.0; 3], at: None };
            Some(all.min_by(|a, b| a.value.total_cmp(&b.value)).unwrap_or(far))
        }
        ContractKind::Rest => certificate.rest.last().map(|r| Found {
            value: r.most,
            what: r.surface.as_ref().map_or_else(|| "an island in a channel".to_owned(), |s| format!("on {s}")),
            point: r.point,
            at: Some(super::rest::place(r)),
        }),
    }
}

fn failure(program: &Program, motion: &Motion, contract: &Contract, found: &Found) -> Diag {
    let bound = contract.bound.get();
    let amount = |x: f64| {
        if x >= FAR {
            "all of it".to_owned()
        } else if x < 0.2 {
            format!("{:.2} um", x * 1e3)
        } else {
            format!("{x:.3} mm")
        }
    };
    let (code, text, help): (Code, String, &str) = match contract.kind {
        ContractKind::Gouge => (
            verification::GOUGE,
            format!("a cutter goes {} deep into {}; {} are allowed", amount(found.value), found.what, amount(bound)),
            "more strips, a thinner tool, a finer chord tolerance, or a wider contract",
        ),
        ContractKind::Excess => (
            verification::EXCESS,
            format!("{} stays on {}; {} are allowed", amount(found.value), found.what, amount(bound)),
            "a smaller scallop, more strips, a tool that reaches the place, or all sectors",
        ),
        ContractKind::Clearance => (
            verification::CLEARANCE,
            format!(
                "the {} comes within {} of the part; {} are asked for",
                found.what,
                amount(found.value),
                amount(bound)
            ),
            "a longer reach, a slimmer holder, or a thinner shank",
        ),
        ContractKind::Rest => (
            verification::REST,
            format!("roughing leaves {} ({}); {} are allowed", amount(found.value), found.what, amount(bound)),
            "smaller `depth` or `residual`, smaller allowances, or another roughing tool that reaches the place",
        ),
    };
    let mut diag = Diag::error(code, text)
        .label(contract.span, "this contract fails")
        .place(describe(program, motion, found.at), Point3::from(found.point))
        .help(help);
    if let Some(at) = found.at {
        diag = diag.block(at.operation, at.index);
    }
    if let Some(operation) = found.at.and_then(|at| motion.operations.get(at.operation as usize)) {
        diag = diag.label(program.operations[operation.operation].span, "in this operation");
    }
    diag
}
