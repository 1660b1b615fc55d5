//! Places that the reader may jump to: the worst of every surface, tool and contract, and what the diagnostics name.

use super::Input;
use crate::diag::Severity;
use crate::part::Sample;
use crate::units::length;
use crate::verify::alike::alike;
use crate::verify::clearance::Clearance;
use crate::verify::place::describe;
use crate::verify::proof::piece::At;
use crate::verify::stock::Peak;
use crate::verify::surface::{FAR, SurfaceReport, Worst};
use nalgebra::{Point3, Vector3};
use serde::Serialize;

/// A place on the part.
#[derive(Clone, Debug, Serialize)]
pub(super) struct PlaceData {
    /// Heading of its list.
    group: &'static str,
    /// What it is.
    name: String,
    /// What it is in the list, where it stands for surfaces that show the same; empty when another stands for it.
    listed: String,
    /// Its figure with the unit.
    value: String,
    /// Where in the program.
    program: String,
    point: [f64; 3],
    /// Out of the material, to look against.
    normal: [f64; 3],
    /// Operation and move, where they are known.
    at: Option<[u32; 2]>,
    /// Whether it breaks a contract or is an error.
    fails: bool,
    /// The greater, the sooner the reader should look at it.
    rank: f64,
}

/// Apart in rank, so that no figure of one quantity stands among those of another.
const QUANTITY: f64 = 1e12;

/// Group of the places that decide contracts; the page lists it first.
const ASKED: &str = "contracts";

/// All places, and which of them belong to the rows of the tables.
#[derive(Default)]
pub(super) struct Places {
    pub(super) list: Vec<PlaceData>,
    /// Gouge and excess of each surface of the certificate.
    pub(super) surfaces: Vec<[Option<usize>; 2]>,
    /// Shank and holder of each operation.
    pub(super) operations: Vec<[Option<usize>; 2]>,
    /// Depth, width, arc and rate of each operation in the stock.
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

/// A length in the signs of the page.
pub(super) fn amount(mm: f64) -> String {
    if mm >= FAR { "not reached".to_owned() } else { figure(&length(mm)) }
}

fn rounded(p: [f64; 3]) -> [f64; 3] {
    p.map(|x| (x * 1e4).round() / 1e4)
}

/// Normal of the part where it is nearest to a point; to see the point the eye must stand on that side.
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

/// A figure of the certificate in the signs of the page.
pub(super) fn figure(text: &str) -> String {
    text.replace("um", "\u{b5}m").replace("mm3", "mm\u{b3}")
}

/// What is said to be found for a contract: of gouge and excess it is the bound that holds everywhere.
pub(super) fn proved(kind: &str, found: &str) -> String {
    if matches!(kind, "gouge" | "excess") { format!("\u{2264} {found}") } else { found.to_owned() }
}

/// Bound of a contract on the whole part and program.
pub(super) fn bound(input: &Input<'_>, kind: &str) -> Option<f64> {
    let mut whole = input.certificate.contracts.iter().filter(|c| c.kind == kind && c.scope.is_empty());
    whole.next().map(|c| c.bound)
}

/// Finds all places.
pub(super) fn places(input: &Input<'_>) -> Places {
    let mut places = Places::default();
    let describe_at = |at: Option<At>| at.map_or_else(String::new, |_| describe(input.program, input.motion, at));
    let mut add = |group: &'static str,
                   name: String,
                   (rank, value): (f64, String),
                   point: [f64; 3],
                   at: Option<At>,
                   fails: bool| {
        places.list.push(PlaceData {
            group,
            listed: name.clone(),
            name,
            value,
            program: describe_at(at),
            point: rounded(point),
            normal: normal(input, point),
            at: at.map(|a| [a.operation, a.index]),
            fails,
            rank,
        });
        places.list.len() - 1
    };
    let certificate = input.certificate;
    let over = |value: f64, kind: &str| bound(input, kind).is_some_and(|b| value > b);

    let mut surfaces = Vec::new();
    for s in &certificate.surfaces {
        let mut worst = |group: &'static str, w: &Worst, value: f64, kind: &str| {
            (value > 0.0 && value < FAR)
                .then(|| add(group, s.surface.clone(), (value, amount(value)), w.point, w.at, over(value, kind)))
        };
        surfaces.push([
            worst("deepest cut into a surface", &s.gouge, s.gouge.depth, "gouge"),
            worst("most material left", &s.excess, s.excess.value, "excess"),
        ]);
    }
    let mut operations = Vec::new();
    for o in &certificate.operations {
        let mut near = |what: &str, c: &Option<Clearance>| {
            c.as_ref().map(|c| {
                let fails = bound(input, "clearance").is_some_and(|b| c.distance < b);
                let value = (-c.distance, figure(&length(c.distance)));
                add("nearest to the part", format!("{what} in {}", o.name), value, c.point, Some(c.at), fails)
            })
        };
        operations.push([near("shank", &o.shank), near("holder", &o.holder)]);
    }
    let rest: Vec<usize> = certificate
        .rest
        .iter()
        .map(|r| {
            let name = certificate.operations.get(r.operation as usize).map_or("", |o| o.name.as_str());
            let on = r.surface.clone().unwrap_or_else(|| "inside a channel".to_owned());
            add(
                "most stock after roughing",
                format!("after {name}: {on}"),
                (r.most, amount(r.most)),
                r.point,
                None,
                false,
            )
        })
        .collect();
    if let Some(c) = &certificate.rapid {
        let value = (-c.distance, figure(&length(c.distance)));
        add("nearest to the stock at rapid", "whole tool".to_owned(), value, c.point, Some(c.at), c.distance <= 0.0);
    }
    let mut engagement = Vec::new();
    for o in certificate.stock.iter().flat_map(|s| &s.operations) {
        for c in &o.collisions {
            let value = (c.depth, figure(&length(c.depth)));
            add(
                "stock that the tool must not meet",
                format!("{} in {}", c.part, o.name),
                value,
                c.point,
                Some(c.at),
                true,
            );
        }
        // Quantities one after another, each with its largest first.
        let mut peak = |what: &str, p: &Option<Peak>, (scale, before): (f64, f64), unit: &str| {
            p.as_ref().map(|p| {
                let value = (p.value * scale - before, format!("{:.1} {unit}", p.value * scale));
                add("largest engagement", format!("{what} in {}", o.name), value, p.tip, Some(p.at), false)
            })
        };
        engagement.push([
            peak("depth", &o.depth, (1.0, 0.0), "mm"),
            peak("width", &o.width, (1.0, QUANTITY), "mm"),
            peak("arc", &o.arc, (1.0, 2.0 * QUANTITY), "deg"),
            peak("removal", &o.rate, (60.0, 3.0 * QUANTITY), "mm\u{b3}/min"),
        ]);
    }
    let findings: Vec<Option<usize>> = input
        .findings
        .iter()
        .map(|d| {
            let place = d.place.as_ref()?;
            let p = place.point;
            let fails = d.severity == Severity::Error;
            let value = (f64::from(u8::from(fails)), d.code.id().to_owned());
            let at = place.block.map(|(operation, index)| At { operation, index });
            Some(add("findings", d.message.clone(), value, [p.x, p.y, p.z], at, fails))
        })
        .collect();
    list_once(&mut places.list, &certificate.surfaces, &surfaces);
    places.surfaces = surfaces;
    places.operations = operations;
    places.stock = engagement;
    places.rest = rest;
    places.findings = findings;
    for c in &certificate.contracts {
        let place = c.point.map(|p| {
            let value = proved(c.kind, &figure(&c.figures[1]));
            places.asked(input, c.name(), value, (&c.place, p, c.at), !c.holds)
        });
        places.contracts.push(place);
    }
    for a in &certificate.allowed {
        let name = format!("allowed: {} {}", a.kind, a.scope);
        let place = a.point.map(|p| places.asked(input, name, figure(&a.figure), (&a.place, p, a.at), false));
        places.allowed.push(place);
    }
    places
}

/// Lists surfaces of a kind that show the same figure once, by their worst place and with all their vanes.
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

impl Places {
    /// Adds the place that decides a contract, with the move that the check found there.
    fn asked(
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
