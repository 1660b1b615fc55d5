//! Places to which the reader can jump: the worst place of every surface, tool and contract, and the places of the
//! diagnostics.

use super::Input;
use crate::proof::NOT_REACHED;
use crate::proof::alike::alike;
use crate::proof::contracts::{allowed_figure, proved, with_symbols};
use base::units::length;
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
const ASKED: &str = "contracts";

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
pub(super) fn amount(mm: f64) -> String {
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
    let picks: [fn(&SurfaceReport) -> f64; 2] = [|s| s.gouge.depth, |s| s.excess.value];
    for (k, pick) in picks.into_iter().enumerate() {
        let place = |i: usize| own.get(i).and_then(|places| places[k]);
        let shown = |s: &SurfaceReport| Some(amount(pick(s))).filter(|_| pick(s) > 0.0 && pick(s) < FAR);
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

/// A place: the point on the part, and the move of the program where a move makes it.
type Where = ([f64; 3], Option<At>);

impl Places {
    /// Adds a place, with its rank and its figure. Returns its index in the list.
    fn add(
        &mut self,
        input: &Input<'_>,
        group: &'static str,
        name: String,
        (rank, value): (f64, String),
        (point, at): Where,
        fails: bool,
    ) -> usize {
        self.list.push(PlaceData {
            group,
            listed: name.clone(),
            name,
            value,
            program: at.map_or_else(String::new, |_| describe(input.program, input.motion, at)),
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
            let mut worst = |group: &'static str, w: &Worst, value: f64, kind: &str| {
                (value > 0.0 && value < FAR).then(|| {
                    let figure = (value, amount(value));
                    self.add(input, group, s.surface.clone(), figure, (w.point, w.at), over(value, kind))
                })
            };
            let gouge = worst("deepest cut into a surface", &s.gouge, s.gouge.depth, "gouge");
            let excess = worst("most material left", &s.excess, s.excess.value, "excess");
            self.surfaces.push([gouge, excess]);
        }
    }

    /// Places where shank and holder of each operation are nearest to the part.
    fn add_operations(&mut self, input: &Input<'_>) {
        for o in &input.certificate.operations {
            let mut near = |what: &str, c: &Option<Clearance>| {
                c.as_ref().map(|c| {
                    let fails = bound(input, "clearance").is_some_and(|b| c.distance < b);
                    let value = (-c.distance, with_symbols(&length(c.distance)));
                    let name = format!("{what} in {}", o.name);
                    self.add(input, "nearest to the part", name, value, (c.point, Some(c.at)), fails)
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
            let name = format!("after {after}: {on}");
            let value = (r.most.get(), amount(r.most.get()));
            let place = self.add(input, "most stock after roughing", name, value, (r.point, None), false);
            self.rest.push(place);
        }
    }

    /// Place where the tool at rapid is nearest to the turned stock.
    fn add_rapid(&mut self, input: &Input<'_>) {
        let Some(c) = &input.certificate.rapid else { return };
        let value = (-c.distance, with_symbols(&length(c.distance)));
        let name = "whole tool".to_owned();
        self.add(input, "nearest to the stock at rapid", name, value, (c.point, Some(c.at)), c.distance <= 0.0);
    }

    /// Collisions with the stock, and the largest engagement of each operation.
    fn add_stock(&mut self, input: &Input<'_>) {
        for o in input.certificate.stock.iter().flat_map(|s| &s.operations) {
            for c in &o.collisions {
                let value = (c.depth.get(), with_symbols(&length(c.depth.get())));
                let name = format!("{} in {}", c.part, o.name);
                self.add(input, "stock that the tool must not meet", name, value, (c.point, Some(c.at)), true);
            }
            // One quantity after another, each with its largest value first.
            let mut peak = |what: &str, p: &Option<Peak>, (scale, before): (f64, f64), unit: &str| {
                p.as_ref().map(|p| {
                    let value = (p.value * scale - before, format!("{:.1} {unit}", p.value * scale));
                    let name = format!("{what} in {}", o.name);
                    self.add(input, "largest engagement", name, value, (p.tip, Some(p.at)), false)
                })
            };
            let peaks = [
                peak("depth", &o.depth, (1.0, 0.0), "mm"),
                peak("width", &o.width, (1.0, QUANTITY), "mm"),
                peak("arc", &o.arc, (1.0, 2.0 * QUANTITY), "deg"),
                peak("removal", &o.rate, (60.0, 3.0 * QUANTITY), "mm\u{b3}/min"),
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
                let value = (f64::from(u8::from(fails)), d.code.id().to_owned());
                let at = place.block.map(|(operation, index)| At { operation, index });
                self.add(input, "findings", d.message.clone(), value, ([p.x, p.y, p.z], at), fails)
            });
            self.findings.push(place);
        }
    }

    /// The deciding place of each contract.
    fn add_contracts(&mut self, input: &Input<'_>) {
        for c in &input.certificate.contracts {
            let place = c.point.map(|p| {
                let value = proved(c);
                self.contract_place(input, c.name(), value, (&c.place, p, c.at), !c.holds)
            });
            self.contracts.push(place);
        }
    }

    /// Places that the job allows.
    fn add_allowed(&mut self, input: &Input<'_>) {
        for a in &input.certificate.allowed {
            let name = format!("allowed: {} {}", a.kind.name(), a.scope);
            let place = a.point.map(|p| {
                self.contract_place(input, name, with_symbols(&allowed_figure(a)), (&a.place, p, a.at), false)
            });
            self.allowed.push(place);
        }
    }

    /// Adds the place that decides a contract, with the move at which the check found it.
    fn contract_place(
        &mut self,
        input: &Input<'_>,
        name: String,
        value: String,
        (program, point, at): (&str, [f64; 3], Option<At>),
        fails: bool,
    ) -> usize {
        let point = rounded(point);
        let at = at.map(|a| [a.operation, a.index]);
        self.list.push(PlaceData {
            group: ASKED,
            listed: name.clone(),
            name,
            value,
            program: program.to_owned(),
            point,
            normal: normal(input, point),
            at,
            fails,
            rank: f64::from(u8::from(fails)),
        });
        self.list.len() - 1
    }
}
