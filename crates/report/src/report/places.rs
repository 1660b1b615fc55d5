//! Places to which the reader can jump: the worst place of every surface, tool and contract, and the places of the
//! diagnostics.

use super::Input;
use crate::proof::NOT_REACHED;
use crate::proof::alike::alike;
use crate::proof::contracts::{allowed_figure, proved, with_symbols};
use base::units::{Deg, Mm, length};
use diagnostics::Severity;
use nalgebra::{Point3, Vector3};
use serde::Serialize;
use verify::clearance::Clearance;
use verify::place::describe;
use verify::proof::piece::At;
use verify::stock::Peak;
use verify::surface::{FAR, SurfaceReport, Worst};
use wheel::part::Sample;

/// A place on the part.
#[derive(Clone, Debug, Serialize)]
pub(super) struct PlaceData {
    /// Heading of the list that holds the place.
    group: &'static str,
    /// Name of the place.
    name: String,
    /// Name in the list, where the entry stands for all surfaces with the same figure; empty when another entry stands
    /// for this place.
    listed: String,
    /// Its figure with the unit.
    value: String,
    /// Position in the program.
    program: String,
    point: [f64; 3],
    /// Normal out of the material; the page looks against it.
    normal: [f64; 3],
    /// Operation and move, where these are known.
    at: Option<[u32; 2]>,
    /// Whether it breaks a contract or is an error.
    fails: bool,
    /// The list is in descending order of the rank.
    rank: f64,
}

/// Distance of two quantities in rank, so that their figures do not mix in the list.
const QUANTITY: f64 = 1e12;

/// Group of the places that decide contracts; the page lists it first.
const CONTRACTS: &str = "contracts";

/// All places, and for each row of the tables the index of its place.
#[derive(Default)]
pub(super) struct Places {
    pub(super) list: Vec<PlaceData>,
    /// Gouge and excess of each surface of the certificate.
    pub(super) surfaces: Vec<[Option<usize>; 2]>,
    /// Shank and holder of each operation.
    pub(super) operations: Vec<[Option<usize>; 2]>,
    /// Axial depth, radial depth, arc and removal rate of each operation in the stock.
    pub(super) stock: Vec<[Option<usize>; 4]>,
    /// Each report of the rest.
    pub(super) rest: Vec<usize>,
    /// Each contract.
    pub(super) contracts: Vec<Option<usize>>,
    /// Each thing that is allowed.
    pub(super) allowed: Vec<Option<usize>>,
    /// Each finding.
    pub(super) findings: Vec<Option<usize>>,
}

/// A length with the symbols of the page.
pub(super) fn amount(Mm(mm): Mm) -> String {
    if mm >= FAR { NOT_REACHED.to_owned() } else { with_symbols(&length(mm)) }
}

fn rounded(p: [f64; 3]) -> [f64; 3] {
    p.map(|x| (x * 1e4).round() / 1e4)
}

/// Normal of the part at its point nearest to `point`; the view must be from that side.
fn normal(input: &Input<'_>, point: [f64; 3]) -> [f64; 3] {
    let part = &input.program.part;
    let near = (0..part.vane_count).filter_map(|sector| {
        let turn = part.sector_rotation(sector);
        let p = turn.inverse() * Point3::from(point);
        let distance = |s: &Sample| (s.position - p).norm_squared();
        let nearest = input.samples.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        Some((distance(nearest), turn * nearest.normal))
    });
    let n = near.min_by(|a, b| a.0.total_cmp(&b.0)).map_or_else(Vector3::z, |n| n.1);
    rounded([n.x, n.y, n.z])
}

/// Bound of a contract on the whole part and program.
pub(super) fn bound(input: &Input<'_>, kind: &str) -> Option<f64> {
    let mut whole = input.certificate.contracts.iter().filter(|c| c.kind.name() == kind && c.scope.is_empty());
    whole.next().map(|c| c.bound)
}

/// Finds all places.
pub(super) fn places(input: &Input<'_>) -> Places {
    let mut places = Places::default();
    places.add_surfaces(input);
    places.add_operations(input);
    places.add_rest(input);
    places.add_rapid(input);
    places.add_stock(input);
    places.add_findings(input);
    list_once(&mut places.list, &input.certificate.surfaces, &places.surfaces);
    places.add_contracts(input);
    places.add_allowed(input);
    places
}

/// Shows surfaces of a kind with the same figure as one entry, at their worst place and with the names of all their
/// vanes.
fn list_once(list: &mut [PlaceData], surfaces: &[SurfaceReport], own: &[[Option<usize>; 2]]) {
    let picks: [fn(&SurfaceReport) -> Mm; 2] = [|s| s.gouge.depth, |s| s.excess.value];
    for (k, pick) in picks.into_iter().enumerate() {
        let place = |i: usize| own.get(i).and_then(|places| places[k]);
        let shown = |s: &SurfaceReport| Some(amount(pick(s))).filter(|_| pick(s).get() > 0.0 && pick(s).get() < FAR);
        for group in alike(surfaces, shown).iter().filter(|g| g.members.len() > 1) {
            let worst = group.worst(surfaces, pick).map(|(i, _)| i);
            for i in &group.members {
                let name = if Some(*i) == worst { group.name.as_str() } else { "" };
                if let Some(entry) = place(*i).and_then(|p| list.get_mut(p)) {
                    name.clone_into(&mut entry.listed);
                }
            }
        }
    }
}

/// A place that a check found.
struct FoundPlace {
    group: &'static str,
    name: String,
    /// Its figure with the unit.
    value: String,
    rank: f64,
    point: [f64; 3],
    /// The move that makes it.
    at: Option<At>,
    fails: bool,
}

impl Places {
    /// Adds a place. Returns its index in the list.
    fn add(&mut self, input: &Input<'_>, found: FoundPlace) -> usize {
        let program = found.at.map_or_else(String::new, |_| describe(input.program, input.motion, found.at));
        self.add_with(input, found, program)
    }

    /// The same with the position in the program in words.
    fn add_with(&mut self, input: &Input<'_>, found: FoundPlace, program: String) -> usize {
        let FoundPlace { group, name, value, rank, point, at, fails } = found;
        self.list.push(PlaceData {
            group,
            listed: name.clone(),
            name,
            value,
            program,
            point: rounded(point),
            normal: normal(input, point),
            at: at.map(|a| [a.operation, a.index]),
            fails,
            rank,
        });
        self.list.len() - 1
    }

    /// Deepest gouge and largest excess of each surface.
    fn add_surfaces(&mut self, input: &Input<'_>) {
        let over = |value: f64, kind: &str| bound(input, kind).is_some_and(|b| value > b);
        for s in &input.certificate.surfaces {
            let mut worst = |group: &'static str, w: &Worst, Mm(rank): Mm, kind: &str| {
                (rank > 0.0 && rank < FAR).then(|| {
                    let (name, value, fails) = (s.surface.clone(), amount(Mm(rank)), over(rank, kind));
                    self.add(input, FoundPlace { group, name, value, rank, point: w.point, at: w.at, fails })
                })
            };
            let gouge = worst("deepest cut into a surface", &s.gouge, s.gouge.depth, "gouge");
            let excess = worst("most material left", &s.excess, s.excess.value, "excess");
            self.surfaces.push([gouge, excess]);
        }
    }

    /// Adds the place where a part of a tool is nearest to something.
    fn add_clearance(
        &mut self,
        input: &Input<'_>,
        group: &'static str,
        name: String,
        found: &Clearance,
        fails: bool,
    ) -> usize {
        let distance = found.distance.get();
        let (value, rank) = (with_symbols(&length(distance)), -distance);
        self.add(input, FoundPlace { group, name, value, rank, point: found.point, at: Some(found.at), fails })
    }

    /// Places where shank and holder of each operation are nearest to the part.
    fn add_operations(&mut self, input: &Input<'_>) {
        for o in &input.certificate.operations {
            let mut near = |what: &str, c: &Option<Clearance>| {
                c.as_ref().map(|c| {
                    let fails = bound(input, "clearance").is_some_and(|b| c.distance.get() < b);
                    self.add_clearance(input, "nearest to the part", format!("{what} in {}", o.name), c, fails)
                })
            };
            let both = [near("shank", &o.shank), near("holder", &o.holder)];
            self.operations.push(both);
        }
    }

    /// Places where most stock is left after each roughing operation.
    fn add_rest(&mut self, input: &Input<'_>) {
        for r in &input.certificate.rest {
            let operation = input.certificate.operations.get(r.operation as usize);
            let after = operation.map_or("", |o| o.name.as_str());
            let on = r.surface.clone().unwrap_or_else(|| "inside a channel".to_owned());
            let found = FoundPlace {
                group: "most stock after roughing",
                name: format!("after {after}: {on}"),
                value: amount(r.most),
                rank: r.most.get(),
                point: r.point,
                at: None,
                fails: false,
            };
            let place = self.add(input, found);
            self.rest.push(place);
        }
    }

    /// Place where the tool at rapid is nearest to the turned stock.
    fn add_rapid(&mut self, input: &Input<'_>) {
        let Some(c) = &input.certificate.rapid else { return };
        let fails = c.distance.get() <= 0.0;
        self.add_clearance(input, "nearest to the stock at rapid", "whole tool".to_owned(), c, fails);
    }

    /// Collisions with the stock, and the largest engagement of each operation.
    fn add_stock(&mut self, input: &Input<'_>) {
        for o in input.certificate.stock.iter().flat_map(|s| &s.operations) {
            for c in &o.collisions {
                let found = FoundPlace {
                    group: "stock that the tool must not meet",
                    name: format!("{} in {}", c.part, o.name),
                    value: with_symbols(&length(c.depth.get())),
                    rank: c.depth.get(),
                    point: c.point,
                    at: Some(c.at),
                    fails: true,
                };
                self.add(input, found);
            }
            // One quantity after another, each with its largest value first.
            let mut peak = |what: &str, found: Option<Peak<f64>>, before: f64, unit: &str| {
                found.map(|p| {
                    let found = FoundPlace {
                        group: "largest engagement",
                        name: format!("{what} in {}", o.name),
                        value: format!("{:.1} {unit}", p.value),
                        rank: p.value - before,
                        point: p.tip,
                        at: Some(p.at),
                        fails: false,
                    };
                    self.add(input, found)
                })
            };
            let peaks = [
                peak("depth", o.depth.map(|p| p.map(Mm::get)), 0.0, "mm"),
                peak("width", o.width.map(|p| p.map(Mm::get)), QUANTITY, "mm"),
                peak("arc", o.arc.map(|p| p.map(Deg::get)), 2.0 * QUANTITY, "deg"),
                peak("removal", o.rate.map(Peak::by_minute), 3.0 * QUANTITY, "mm\u{b3}/min"),
            ];
            self.stock.push(peaks);
        }
    }

    /// Places of the diagnostics.
    fn add_findings(&mut self, input: &Input<'_>) {
        for d in input.findings {
            let place = d.place.as_ref().map(|place| {
                let p = place.point;
                let fails = d.severity == Severity::Error;
                let found = FoundPlace {
                    group: "findings",
                    name: d.message.clone(),
                    value: d.code.id().to_owned(),
                    rank: f64::from(u8::from(fails)),
                    point: [p.x, p.y, p.z],
                    at: place.block.map(|(operation, index)| At { operation, index }),
                    fails,
                };
                self.add(input, found)
            });
            self.findings.push(place);
        }
    }

    /// The deciding place of each contract.
    fn add_contracts(&mut self, input: &Input<'_>) {
        for c in &input.certificate.contracts {
            let place = c.point.map(|p| {
                let found = contract_place(c.name(), proved(c), p, c.at, !c.holds);
                self.add_with(input, found, c.place.clone())
            });
            self.contracts.push(place);
        }
    }

    /// Places that the job allows.
    fn add_allowed(&mut self, input: &Input<'_>) {
        for a in &input.certificate.allowed {
            let name = format!("allowed: {} {}", a.kind.name(), a.scope);
            let place = a.point.map(|p| {
                let found = contract_place(name, with_symbols(&allowed_figure(a)), p, a.at, false);
                self.add_with(input, found, a.place.clone())
            });
            self.allowed.push(place);
        }
    }
}

/// The place that decides a contract, with the move at which the check found it.
fn contract_place(name: String, value: String, point: [f64; 3], at: Option<At>, fails: bool) -> FoundPlace {
    let (point, rank) = (rounded(point), f64::from(u8::from(fails)));
    FoundPlace { group: CONTRACTS, name, value, rank, point, at, fails }
}
