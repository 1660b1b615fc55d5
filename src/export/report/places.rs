//! Places that the reader may jump to: the worst of every surface, tool and contract, and what the diagnostics name.

use super::Input;
use crate::diag::Severity;
use crate::ir::design::Sample;
use crate::verify::certificate::describe;
use crate::verify::clearance::Clearance;
use crate::verify::stock::Peak;
use crate::verify::surface::{FAR, Worst};
use crate::verify::sweep::At;
use nalgebra::{Point3, Vector3};
use serde::Serialize;

/// A place on the part.
#[derive(Clone, Debug, Serialize)]
pub(super) struct PlaceData {
    /// Heading of its list.
    group: &'static str,
    /// What it is.
    name: String,
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

/// A length of a surface: micrometres, or mm when large.
pub(super) fn amount(mm: f64) -> String {
    if mm >= FAR {
        "not reached".to_owned()
    } else if mm.abs() < 0.2 {
        format!("{:.2} \u{b5}m", mm * 1e3)
    } else {
        format!("{mm:.3} mm")
    }
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

/// A figure of a contract: small lengths in um, all others as the certificate has them.
pub(super) fn figure(value: f64, unit: &str, text: &str) -> String {
    if unit == "mm" { amount(value) } else { text.replace("mm3", "mm\u{b3}") }
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
                let value = (-c.distance, format!("{:.3} mm", c.distance));
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
        let value = (-c.distance, format!("{:.3} mm", c.distance));
        add("nearest to the stock at rapid", "whole tool".to_owned(), value, c.point, Some(c.at), c.distance <= 0.0);
    }
    let mut engagement = Vec::new();
    for o in certificate.stock.iter().flat_map(|s| &s.operations) {
        for c in &o.collisions {
            let value = (c.depth, amount(c.depth));
            add(
                "stock that the tool must not meet",
                format!("{} in {}", c.part, o.name),
                value,
                c.point,
                Some(c.at),
                true,
            );
        }
        let mut peak = |what: &str, p: &Option<Peak>, scale: f64, unit: &str| {
            p.as_ref().map(|p| {
                let value = (0.0, format!("{:.1} {unit}", p.value * scale));
                add("largest engagement", format!("{what} in {}", o.name), value, p.tip, Some(p.at), false)
            })
        };
        engagement.push([
            peak("depth", &o.depth, 1.0, "mm"),
            peak("width", &o.width, 1.0, "mm"),
            peak("arc", &o.arc, 1.0, "deg"),
            peak("removal", &o.rate, 60.0, "mm\u{b3}/min"),
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
            Some(add("findings", d.message.clone(), value, [p.x, p.y, p.z], None, fails))
        })
        .collect();
    places.surfaces = surfaces;
    places.operations = operations;
    places.stock = engagement;
    places.rest = rest;
    places.findings = findings;
    for c in &certificate.contracts {
        let place = c.point.map(|p| {
            let value = proved(c.kind, &figure(c.found, c.unit, &c.figures[1]));
            places.asked(input, c.name(), value, (&c.place, p), !c.holds)
        });
        places.contracts.push(place);
    }
    for a in &certificate.allowed {
        let name = format!("allowed: {} {}", a.kind, a.scope);
        let place = a.point.map(|p| {
            let value = a.found.map_or_else(|| a.figure.clone(), |f| figure(f, a.unit, &a.figure));
            places.asked(input, name, value, (&a.place, p), false)
        });
        places.allowed.push(place);
    }
    places
}

impl Places {
    /// Adds the place that decides a contract; the move is that of the place measured there.
    fn asked(
        &mut self,
        input: &Input<'_>,
        name: String,
        value: String,
        (program, point): (&str, [f64; 3]),
        fails: bool,
    ) -> usize {
        let point = rounded(point);
        let at = self.list.iter().filter(|p| p.point == point).find_map(|p| p.at);
        self.list.push(PlaceData {
            group: ASKED,
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
