//! Contracts of the job: `require` and `allow`.

use crate::block::context::Context;
use crate::block::eval::{suggest, unknown};
use crate::model::{AllowedSpec, ContractKind, ContractSpec, OperationSpec};
use crate::property::quantity::{Dimension, Quantity};
use base::source::Span;
use diagnostics::Diag;
use diagnostics::codes::job as codes;
use std::collections::BTreeSet;
use syntax::ast::{Expr, File, Item, ItemKind, Name, ScopeTarget};
use wheel::contract::{Cuts, Guarded, OfOperations, Region, Scope};
use wheel::part::SurfaceClass;

/// Contracts, and the items that `allow` takes out of them.
pub(super) fn resolve(
    file: &File,
    operations: &[OperationSpec],
    cx: &mut Context<'_>,
) -> (Vec<ContractSpec>, Vec<AllowedSpec>) {
    let declared = file.items.iter().filter(|i| matches!(i.kind, ItemKind::Operation { .. })).count();
    let complete = declared == operations.len() && !file.damaged && !file.is_open();
    let mut reader = ContractReader { operations, complete, cx };
    let mut contracts: Vec<ContractSpec> = Vec::new();
    let mut allowed: Vec<AllowedSpec> = Vec::new();
    for item in &file.items {
        match &item.kind {
            ItemKind::Require { what, body, relation, bound, outside, scope } => {
                let Some(kind) = reader.kind(what, body.as_ref(), "required") else { continue };
                let Some(kind) = reader.outside(kind, outside.as_ref()) else { continue };
                reader.relation(kind, relation);
                let scope = reader.scope(kind, scope);
                let bound = reader.bound(kind, bound);
                let Some(scope) = scope else { continue };
                if let Some(first) = contracts.iter().find(|c| c.kind == kind && c.scope == scope) {
                    let first = first.span;
                    reader.twice(kind, item.span, first, "required", "keep the stricter one");
                } else if let Some(bound) = bound {
                    contracts.push(ContractSpec { kind, bound, scope, default: false, span: item.span });
                }
            }
            ItemKind::Allow { what, body, scope, reason } => {
                let Some(kind) = reader.kind(what, body.as_ref(), "allowed") else { continue };
                let required = file.items.iter().any(|i| requires(i, kind));
                if !reader.may_be_allowed(kind, what, scope, required) {
                    continue;
                }
                let Some(scope) = reader.scope(kind, scope) else { continue };
                if reason.text.trim().is_empty() {
                    reader.cx.sink.push(
                        Diag::error(codes::WRONG_FORM, "an `allow` needs a reason")
                            .label(reason.span, "no reason")
                            .help("write the reason: `allow excess on fillet \"blended by hand\"`"),
                    );
                }
                if let Some(first) = allowed.iter().find(|c| c.kind == kind && c.scope == scope) {
                    let first = first.span;
                    reader.twice(kind, item.span, first, "allowed", "keep one of them");
                } else {
                    allowed.push(AllowedSpec { kind, scope, reason: reason.text.clone(), span: item.span });
                }
            }
            _ => {}
        }
    }
    if reader.complete {
        reader.emptied(&contracts, &allowed);
    }
    add_defaults(&mut contracts, &allowed);
    (contracts, allowed)
}

/// Whether an item requires a quantity or a part of this quantity.
fn requires(item: &Item, kind: ContractKind) -> bool {
    let ItemKind::Require { what, body, .. } = &item.kind else { return false };
    let text = body.as_ref().map_or_else(|| what.text.clone(), |b| format!("{} {}", what.text, b.text));
    ContractKind::ALL.into_iter().any(|k| k.quantity() == text && kind.covers(k))
}

/// Adds the default contracts: a quantity that the job neither requires nor allows is judged all the same.
fn add_defaults(contracts: &mut Vec<ContractSpec>, allowed: &[AllowedSpec]) {
    use ContractKind::{Clearance, Gouge};
    let body = Clearance(Guarded::Body);
    let parts = [Guarded::Shank, Guarded::Holder].map(Clearance);
    // Where the job distinguishes shank and holder, the defaults do so as well.
    let separate = contracts.iter().any(|c| parts.contains(&c.kind)) || allowed.iter().any(|a| parts.contains(&a.kind));
    let kinds = if separate { vec![Gouge, parts[0], parts[1]] } else { vec![Gouge, body] };
    for kind in kinds {
        let whole = contracts.iter().any(|c| c.kind.covers(kind) && c.scope.is_whole());
        let waived = allowed.iter().any(|a| a.kind.covers(kind) && a.scope.is_whole());
        if let Some(bound) = kind.default_bound().filter(|_| !(whole || waived)) {
            contracts.push(ContractSpec { kind, bound, scope: Scope::default(), default: true, span: Span::default() });
        }
    }
}

struct ContractReader<'a, 'b> {
    operations: &'a [OperationSpec],
    /// False when operations are missing from the list because they are faulty.
    complete: bool,
    cx: &'a mut Context<'b>,
}

impl ContractReader<'_, '_> {
    fn kind(&mut self, what: &Name, body: Option<&Name>, verb: &str) -> Option<ContractKind> {
        let text = body.map_or_else(|| what.text.clone(), |b| format!("{} {}", what.text, b.text));
        if let Some(kind) = ContractKind::ALL.into_iter().find(|k| k.quantity() == text) {
            return Some(kind);
        }
        let mut known: Vec<&str> = ContractKind::ALL.iter().map(|k| k.quantity()).collect();
        known.dedup();
        match body.filter(|_| known.contains(&what.text.as_str())) {
            Some(body) => {
                let parts: Vec<&str> =
                    known.iter().filter_map(|k| k.strip_prefix(&format!("{} ", what.text))).collect();
                let message = format!("`{}` has no part `{}`", what.text, body.text);
                let diag = Diag::error(codes::UNKNOWN_NAME, message);
                let diag = if parts.is_empty() {
                    diag.label(body.span, "not known").help(format!("write `{}` alone", what.text))
                } else {
                    suggest(diag, &body.text, body.span, "part of the tool", &parts)
                };
                self.cx.sink.push(diag);
            }
            None => {
                let diag = Diag::error(codes::UNKNOWN_NAME, format!("`{}` cannot be {verb}", what.text));
                self.cx.sink.push(suggest(diag, &what.text, what.span, "quantity", &known));
            }
        }
        None
    }

    /// The quantity limited to the cuts that `outside of` leaves.
    fn outside(&mut self, kind: ContractKind, outside: Option<&Name>) -> Option<ContractKind> {
        let Some(what) = outside else { return Some(kind) };
        if kind != ContractKind::Engagement(Cuts::All) {
            let message = format!("`{}` cannot be required outside of `{}`", kind.name(), what.text);
            self.cx.sink.push(
                Diag::error(codes::WRONG_FORM, message)
                    .label(what.span, "only for `engagement`")
                    .help("remove `outside of`, or name operations: `on flank`, `on operation NAME`"),
            );
            return None;
        }
        if what.text != "slots" {
            self.cx.sink.push(unknown(&what.text, what.span, "kind of cut", ["slots"].into_iter()));
            return None;
        }
        Some(ContractKind::Engagement(Cuts::OutsideSlots))
    }

    fn relation(&mut self, kind: ContractKind, relation: &Name) {
        let due = kind.relation().sign();
        if relation.text != due {
            let side = if due == "<=" { "at most" } else { "at least" };
            self.cx.sink.push(
                Diag::error(codes::RELATION, format!("`{}` needs a contract with {side} a value", kind.name()))
                    .label(relation.span, format!("`{due}` is expected"))
                    .help(format!("write `{due}`"))
                    .fix(relation.span, due),
            );
        }
    }

    /// The bound in the units of the contract.
    fn bound(&mut self, kind: ContractKind, expr: &Expr) -> Option<wheel::contract::Bound> {
        let name = kind.name();
        let Quantity { value: largest, dimension } = Quantity::read(kind.largest())?;
        let value = self.cx.scope.expect(expr, dimension, &format!("the bound of `{name}`"), self.cx.sink)?;
        if (0.0..=largest).contains(&value) {
            // Contracts count in seconds and degrees.
            let scale = match dimension {
                Dimension::TIME => 60.0,
                Dimension::ANGLE => 1f64.to_degrees(),
                _ => 1.0,
            };
            return Some(kind.bound(value * scale));
        }
        let message = format!("the bound of `{name}` must be from 0 to {}", kind.largest());
        self.cx.sink.push(
            Diag::error(codes::OUT_OF_RANGE, message)
                .label(expr.span, "out of range")
                .help(format!("write the bound without a sign and with its unit: `require {}`", kind.usual())),
        );
        None
    }

    /// Surfaces and operations of a scope; `None` when a word of it is wrong.
    fn scope(&mut self, kind: ContractKind, targets: &[ScopeTarget]) -> Option<Scope<usize>> {
        let mut scope = Scope::default();
        let mut good = true;
        let mut seen = BTreeSet::new();
        for target in targets {
            let word = target.name.text.as_str();
            if !seen.insert((word, target.operation)) {
                continue;
            }
            let surface = SurfaceClass::ALL.into_iter().find(|s| !target.operation && s.name() == word);
            if let Some(surface) = surface {
                if !kind.surfaces().contains(&surface) {
                    self.no_surface(kind, surface, target.name.span);
                    good = false;
                } else if !scope.surfaces.contains(&surface) {
                    scope.surfaces.push(surface);
                }
                continue;
            }
            let mut found = self.named(word, target.operation);
            if found.is_empty() {
                good = false;
                if self.complete {
                    let known: Vec<&str> = SurfaceClass::ALL
                        .iter()
                        .map(|s| s.name())
                        .filter(|_| !target.operation)
                        .chain(self.operations.iter().map(|o| o.name.as_str()))
                        .collect();
                    let what = if target.operation { "operation" } else { "surface or operation" };
                    self.cx.sink.push(unknown(word, target.name.span, what, known.into_iter()));
                }
            }
            if kind == ContractKind::Rest
                && let Some(finishing) = found.iter().find(|o| !self.roughs(**o))
            {
                let name = self.operations.get(*finishing).map_or("", |o| o.name.as_str());
                self.cx.sink.push(
                    Diag::error(
                        codes::WRONG_FORM,
                        format!("`rest` applies to roughing, but `{name}` is a finishing operation"),
                    )
                    .label(target.name.span, "not a roughing operation")
                    .help("name a groove or expand operation, or require `excess`"),
                );
                good = false;
            }
            scope.operations.append(&mut found);
        }
        // Sorted, so that equal scopes compare equal in every spelling.
        scope.surfaces.sort_unstable();
        scope.operations.sort_unstable();
        scope.operations.dedup();
        good.then_some(scope)
    }

    /// Operations that a word means. After `operation` this is the one of that name; otherwise all operations of that
    /// kind, or the one of that name.
    fn named(&self, word: &str, by_name: bool) -> Vec<usize> {
        let pick = |test: &dyn Fn(&OperationSpec) -> bool| -> Vec<usize> {
            self.operations.iter().enumerate().filter(|(_, o)| test(o)).map(|(i, _)| i).collect()
        };
        let of_kind = pick(&|o| !by_name && o.kind.keyword() == word);
        if of_kind.is_empty() { pick(&|o| o.name == word) } else { of_kind }
    }

    fn roughs(&self, operation: usize) -> bool {
        let kind = self.operations.get(operation).map(|o| &o.kind);
        kind.is_some_and(|kind| kind.roughing().is_some())
    }

    fn no_surface(&mut self, kind: ContractKind, surface: SurfaceClass, span: Span) {
        let known: Vec<&str> = kind.surfaces().iter().map(|s| s.name()).collect();
        let diag =
            Diag::error(codes::WRONG_FORM, format!("`{}` cannot be required on `{}`", kind.name(), surface.name()));
        let diag = if known.is_empty() {
            diag.label(span, "this is a surface").help("name an operation: `on flank`, `on operation NAME`")
        } else {
            diag.label(span, "no operation mills this surface")
                .help(format!("possible surfaces are {}", known.join(", ")))
        };
        self.cx.sink.push(diag);
    }

    /// Checks an `allow`: the quantity must have surfaces or operations that can be taken out. Everything is allowed
    /// only in place of a default contract, where the job requires nothing of the kind.
    fn may_be_allowed(&mut self, kind: ContractKind, what: &Name, targets: &[ScopeTarget], required: bool) -> bool {
        let name = kind.name();
        if targets.is_empty() && kind.default_bound().is_some() && !required {
            return true;
        }
        if targets.is_empty() {
            self.cx.sink.push(
                Diag::error(codes::WRONG_FORM, format!("`allow {name}` names no place"))
                    .label(what.span, "everything would be allowed")
                    .help(format!("name surfaces or operations: `allow {name} on hub \"reason\"`, or require less")),
            );
            return false;
        }
        if kind.of_operations() == OfOperations::Done {
            return true;
        }
        let is_surface = |t: &&ScopeTarget| !t.operation && SurfaceClass::ALL.iter().any(|s| s.name() == t.name.text);
        let Some(operation) = targets.iter().find(|t| !is_surface(t)) else { return true };
        let help = if kind.surfaces().is_empty() {
            format!("require a larger `{name}` instead")
        } else {
            "name surfaces: `on pressure`, `on suction`, `on fillet`, `on hub`".to_owned()
        };
        self.cx.sink.push(
            Diag::error(
                codes::WRONG_FORM,
                format!("`{name}` is measured after all operations; no single operation can be allowed"),
            )
            .label(operation.name.span, "not a surface")
            .help(help),
        );
        false
    }

    fn twice(&mut self, kind: ContractKind, span: Span, first: Span, verb: &str, help: &str) {
        self.cx.sink.push(
            Diag::error(codes::GIVEN_TWICE, format!("`{}` is {verb} twice", kind.name()))
                .label(span, format!("{verb} again"))
                .label(first, format!("first {verb} here"))
                .help(help),
        );
    }

    /// Reports contracts that `allow` removes completely.
    fn emptied(&mut self, contracts: &[ContractSpec], allowed: &[AllowedSpec]) {
        for contract in contracts {
            let mut region = contract.region(self.operations.len());
            let before = region.clone();
            let mut takers = Vec::new();
            for a in allowed.iter().filter(|a| a.kind.takes_out_of(contract.kind)) {
                let taken = Region::of(&a.scope, self.operations.len());
                let after = region.without(&taken);
                if after != region {
                    takers.push(a.span);
                }
                region = after;
            }
            let speaks = contract.kind.speaks_of();
            if region.is_empty_on(speaks) && !before.is_empty_on(speaks) {
                let message = format!("`require {}` has nothing to check", contract.kind.name());
                let mut diag = Diag::error(codes::NOTHING_LEFT, message).label(contract.span, "this contract");
                for span in takers {
                    diag = diag.label(span, "excluded here");
                }
                self.cx.sink.push(diag.help("remove the contract or the `allow`, or require a larger bound there"));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_of_the_table_are_read_as_a_job_writes_them() {
        for kind in ContractKind::ALL {
            let usual = kind.usual();
            let written = usual.strip_prefix(kind.quantity()).unwrap().trim_start().split(' ').skip(1);
            let written = Quantity::read(&written.take(2).collect::<Vec<_>>().join(" ")).unwrap();
            let largest = Quantity::read(kind.largest()).unwrap();
            assert_eq!(written.dimension, largest.dimension, "{usual}");
            assert!(0.0 < written.value && written.value <= largest.value, "{usual}");
            // The quantity of the table has the unit that the bound has.
            let unit = kind.bound(1.0).unit();
            let one = if unit == "1" { Quantity::read("1") } else { Quantity::new(1.0, unit) };
            assert_eq!(one.map(|q| q.dimension), Some(largest.dimension), "{usual}");
        }
    }
}
