//! Figures of contracts: the values of the certificate, limited to the surfaces and operations that a contract names.

use super::certificate::Certificate;
use super::clearance::Clearance;
use super::dynamics::{Deviation, Run};
use super::proof::piece::At;
use super::stock::{OperationStock, Peak, StockReport};
use super::surface::{SurfaceReport, Worst};
use base::units::{Deg, Mm, Sec, Share, length};
use wheel::contract::{ContractKind, Cuts, Guarded, Region};
use wheel::part::{SurfaceClass, SurfaceId};

/// A measured value with its place.
#[derive(Clone, Debug)]
pub(super) struct Figure {
    /// In the unit of the contract's bound.
    pub(super) value: f64,
    /// The worst value at the computed points, where `value` is a proved bound beyond it.
    pub(super) found: Option<f64>,
    /// The measured quantity in words.
    pub(super) what: String,
    /// Place on the part.
    pub(super) point: Option<[f64; 3]>,
    /// Place in the program.
    pub(super) at: Option<At>,
    /// The operation with the largest share, by its index.
    pub(super) operation: Option<usize>,
}

/// Why there is no figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unmeasured {
    /// The stock was not simulated.
    NeedsStock,
    /// No roughing operation leaves anything.
    NoRoughing,
    /// The part has no closed surface.
    NoSolid,
}

/// Measurements for a part of the surfaces or operations.
pub(super) trait NarrowMeasure {
    /// Surfaces as left by the cutters of these operations alone.
    fn surfaces(&self, operations: &[bool]) -> Vec<SurfaceReport>;

    /// Least distance of a part of the tool in an operation to some surfaces of the design.
    fn clearance(&self, operation: usize, body: Guarded, surfaces: &[SurfaceClass]) -> Option<Clearance>;

    /// Whether the operations are to make a surface in its sector.
    fn is_asked(&self, surface: SurfaceId) -> bool;

    /// Volume of the finished part, mm3; `None` when its surfaces are not closed.
    fn part_volume(&self) -> Option<f64>;

    /// Search distance of bodies, mm.
    fn search(&self) -> f64;
}

/// The figure of a quantity on a region. `after` is the operation after which the quantity is judged; `None` means the
/// last operation.
///
/// # Errors
/// Why there is no figure.
pub(super) fn measure(
    kind: ContractKind,
    region: &Region,
    after: Option<usize>,
    certificate: &Certificate,
    narrow: &dyn NarrowMeasure,
) -> Result<Figure, Unmeasured> {
    let stock = || certificate.stock.as_ref().ok_or(Unmeasured::NeedsStock);
    match kind {
        ContractKind::Gouge => Ok(worst(certificate, narrow, region, gouge, &|_| true)),
        ContractKind::Excess => {
            let mut region = region.clone();
            for (o, done) in region.rows.iter_mut().flat_map(|row| row.iter_mut().enumerate()) {
                *done &= after.is_none_or(|last| o <= last);
            }
            Ok(worst(certificate, narrow, &region, excess, &|s| narrow.is_asked(s.id)))
        }
        ContractKind::Clearance(body) => Ok(clearance(certificate, narrow, body, region)),
        ContractKind::Time => Ok(time(certificate, region)),
        ContractKind::AxisSpeed => Ok(axis_speed(certificate, region)),
        ContractKind::ContourError => Ok(deviation(certificate, region, contour)),
        ContractKind::OrientationError => Ok(deviation(certificate, region, orientation)),
        ContractKind::Rest => rest(certificate, region, after),
        ContractKind::Air => air(stock()?, region),
        ContractKind::RemovalRate => Ok(largest(stock()?, region, |o| o.rate.map(Peak::by_minute))),
        ContractKind::Engagement(cuts) => Ok(engagement(stock()?, region, cuts)),
        ContractKind::Slot => Ok(largest(stock()?, region, |o| o.slot.map(|p| p.map(Share::get)))),
        ContractKind::RestVolume => rest_volume(stock()?, after, narrow),
    }
}

/// A quantity of a surface: its proved bound, its largest computed value, and the place of this value.
struct OnSurface<'a> {
    bound: Mm,
    computed: Mm,
    worst: &'a Worst,
}

fn gouge(s: &SurfaceReport) -> OnSurface<'_> {
    OnSurface { bound: s.gouge_bound, computed: s.gouge.depth, worst: &s.gouge }
}

fn excess(s: &SurfaceReport) -> OnSurface<'_> {
    OnSurface { bound: s.excess_bound, computed: s.excess.value, worst: &s.excess }
}

/// The largest bound and the largest computed value over the surfaces of a region that are `judged`; for each surface only the
/// operations of the region count.
fn worst(
    certificate: &Certificate,
    narrow: &dyn NarrowMeasure,
    region: &Region,
    pick: fn(&SurfaceReport) -> OnSurface<'_>,
    judged: &dyn Fn(&SurfaceReport) -> bool,
) -> Figure {
    let mut known: Vec<(&[bool], Vec<SurfaceReport>)> = Vec::new();
    let mut found: Option<Figure> = None;
    let mut largest = 0.0_f64;
    for (surface, row) in SurfaceClass::ALL.into_iter().zip(&region.rows) {
        if !row.contains(&true) {
            continue;
        }
        let whole = row.iter().all(|o| *o);
        if !whole && known.iter().all(|(operations, _)| operations != row) {
            known.push((row, narrow.surfaces(row)));
        }
        let narrowed = known.iter().find(|(operations, _)| !whole && operations == row);
        let reports = narrowed.map_or(&certificate.surfaces, |(_, reports)| reports);
        for s in reports.iter().filter(|s| s.id.kind.class() == surface && judged(s)) {
            let OnSurface { bound, computed, worst } = pick(s);
            largest = largest.max(computed.get());
            if found.as_ref().is_none_or(|f| bound.get() > f.value) {
                found = Some(Figure {
                    value: bound.get(),
                    found: None,
                    what: s.surface.clone(),
                    point: Some(worst.point),
                    at: worst.at,
                    operation: worst.at.map(|a| a.operation as usize),
                });
            }
        }
    }
    found.map_or_else(|| none(0.0, "no surface"), |f| Figure { found: Some(largest), ..f })
}

fn none(value: f64, what: &str) -> Figure {
    Figure { value, found: None, what: what.to_owned(), point: None, at: None, operation: None }
}

fn clearance(certificate: &Certificate, narrow: &dyn NarrowMeasure, body: Guarded, region: &Region) -> Figure {
    let mut all: Vec<(&str, Clearance)> = Vec::new();
    for (o, report) in certificate.operations.iter().enumerate() {
        let surfaces: Vec<SurfaceClass> = SurfaceClass::ALL
            .into_iter()
            .zip(&region.rows)
            .filter(|(_, row)| row.get(o) == Some(&true))
            .map(|p| p.0)
            .collect();
        if surfaces.is_empty() {
            continue;
        }
        if body == Guarded::Tool {
            all.extend(report.rapid.clone().map(|c| ("tool at rapid", c)));
            continue;
        }
        let parts = [(Guarded::Shank, "shank", &report.shank), (Guarded::Holder, "holder", &report.holder)];
        for (part, name, stored) in parts.into_iter().filter(|p| body == Guarded::Body || body == p.0) {
            let found = if surfaces.len() == SurfaceClass::ALL.len() {
                stored.clone()
            } else {
                narrow.clearance(o, part, &surfaces)
            };
            all.extend(found.map(|c| (name, c)));
        }
    }
    let least = all.into_iter().min_by(|a, b| a.1.distance.total_cmp(&b.1.distance));
    match least {
        Some((name, c)) => Figure {
            value: c.distance.get(),
            found: Some(c.found.get()),
            what: name.to_owned(),
            point: Some(c.point),
            at: Some(c.at),
            operation: Some(c.at.operation as usize),
        },
        // Nothing is within the search distance, and no bound of a contract exceeds this distance.
        None => none(narrow.search(), "tool"),
    }
}

fn time(certificate: &Certificate, region: &Region) -> Figure {
    let chosen = region.operations();
    let times = certificate.operations.iter().enumerate().filter(|(o, _)| chosen.get(*o) == Some(&true));
    let mut longest: Option<(usize, f64)> = None;
    let mut sum = 0.0;
    for (o, report) in times {
        let time = report.time.into_iter().sum::<Sec>().get();
        sum += time;
        if longest.is_none_or(|(_, t)| time > t) {
            longest = Some((o, time));
        }
    }
    let name = longest.and_then(|(o, _)| certificate.operations.get(o)).map_or("", |o| o.name.as_str());
    let what = longest.map_or_else(String::new, |(_, t)| format!("{} of it in {name}", wheel::contract::clock(t)));
    Figure { value: sum, found: None, what, point: None, at: None, operation: longest.map(|l| l.0) }
}

/// Share of the time at feed without removal.
fn air(stock: &StockReport, region: &Region) -> Result<Figure, Unmeasured> {
    let chosen = region.operations();
    let (mut sum, mut worst): ([f64; 2], Option<&OperationStock>) = ([0.0; 2], None);
    for o in stock.operations.iter().filter(|o| chosen.get(o.operation as usize) == Some(&true)) {
        sum = [sum[0] + o.feed[0].get(), sum[1] + o.feed[1].get()];
        if worst.is_none_or(|w| o.feed[1] > w.feed[1]) {
            worst = Some(o);
        }
    }
    let what =
        worst.map_or_else(String::new, |w| format!("{} of it in {}", wheel::contract::clock(w.feed[1].get()), w.name));
    let value = if sum[0] > 0.0 { sum[1] / sum[0] } else { 0.0 };
    Ok(Figure { value, found: None, what, point: None, at: None, operation: worst.map(|w| w.operation as usize) })
}

/// The largest of the peaks of the chosen operations, in the unit of the contract.
fn largest(stock: &StockReport, region: &Region, peak: impl Fn(&OperationStock) -> Option<Peak<f64>>) -> Figure {
    let chosen = region.operations();
    let operations = stock.operations.iter().filter(|o| chosen.get(o.operation as usize) == Some(&true));
    let largest = operations.filter_map(|o| peak(o).map(|p| (o, p))).max_by(|a, b| a.1.value.total_cmp(&b.1.value));
    largest.map_or_else(
        || none(0.0, "nothing is removed"),
        |(o, p)| Figure {
            value: p.value,
            found: None,
            what: o.name.clone(),
            point: Some(p.tip),
            at: Some(p.at),
            operation: Some(o.operation as usize),
        },
    )
}

/// The largest upper bound of the arc in the chosen operations.
fn engagement(stock: &StockReport, region: &Region, cuts: Cuts) -> Figure {
    let of = |o: &OperationStock| match cuts {
        Cuts::All => o.arc_bound,
        Cuts::OutsideSlots => o.arc_outside_slots,
    };
    let found = |f: &Figure| {
        let o = stock.operations.iter().find(|o| Some(o.operation as usize) == f.operation)?;
        of(o).map(|b| b.found.get())
    };
    let figure = largest(stock, region, |o| of(o).map(|b| Peak { value: b.value.get(), at: b.at, tip: b.tip }));
    Figure { found: found(&figure), ..figure }
}

/// Stock after an operation, or at the end, less the finished part. A cut into the part reduces this value.
fn rest_volume(stock: &StockReport, after: Option<usize>, narrow: &dyn NarrowMeasure) -> Result<Figure, Unmeasured> {
    let part = narrow.part_volume().ok_or(Unmeasured::NoSolid)?;
    let last = match after {
        Some(o) => stock.operations.iter().find(|s| s.operation as usize == o),
        None => stock.operations.last(),
    };
    let rest = last.map_or(stock.blank, |o| o.rest).get();
    let name = last.map_or("the blank", |o| o.name.as_str());
    Ok(Figure {
        value: rest - part,
        found: None,
        what: format!("{rest:.0} mm3 of stock after {name}, {part:.0} mm3 of part"),
        point: None,
        at: None,
        operation: last.map(|o| o.operation as usize),
    })
}

fn axis_speed(certificate: &Certificate, region: &Region) -> Figure {
    let chosen = region.operations();
    let uses = certificate.machine.fastest.iter().enumerate().filter(|(o, _)| chosen.get(*o) == Some(&true));
    let fastest = uses.filter_map(|(_, f)| f.as_ref()).max_by(|a, b| a.share.total_cmp(&b.share));
    match fastest {
        Some(f) => Figure {
            value: f.share.get(),
            found: None,
            what: format!("axis {}", f.axis),
            point: Some(f.tip),
            at: Some(f.at),
            operation: Some(f.at.operation as usize),
        },
        None => none(0.0, "no axis"),
    }
}

/// Largest deviation from the verified motion over the operations of a region, and its cause in words.
fn deviation<Q: Copy + Into<f64>>(
    certificate: &Certificate,
    region: &Region,
    pick: fn(&Run) -> (Deviation<Q>, String),
) -> Figure {
    let chosen = region.operations();
    let runs = certificate.machine.runs.iter().enumerate().filter(|(o, _)| chosen.get(*o) == Some(&true));
    let most =
        runs.map(|(o, run)| (o, pick(run))).reduce(|a, b| if b.1.0.value.into() > a.1.0.value.into() { b } else { a });
    match most {
        Some((o, (found, what))) => Figure {
            value: found.value.into(),
            found: None,
            what,
            point: found.at.map(|_| found.tip),
            at: found.at,
            operation: Some(o),
        },
        None => none(0.0, "no operation"),
    }
}

fn contour(run: &Run) -> (Deviation<Mm>, String) {
    let d = run.contour;
    let what = format!(
        "rounding a corner {}, control cycle {}",
        length(d.corner.get()),
        length(d.value.get() - d.corner.get())
    );
    (d, what)
}

fn orientation(run: &Run) -> (Deviation<Deg>, String) {
    (run.orientation, "rounding a corner".to_owned())
}

/// Rest on the surfaces of the region; islands in the channels count as well where the region includes all surfaces.
fn rest(certificate: &Certificate, region: &Region, after: Option<usize>) -> Result<Figure, Unmeasured> {
    let report = match after {
        Some(o) => certificate.rest.iter().find(|r| r.operation as usize == o),
        None => certificate.rest.last(),
    };
    let report = report.ok_or(Unmeasured::NoRoughing)?;
    let has =
        |s: SurfaceClass| SurfaceClass::ALL.into_iter().zip(&region.rows).any(|(c, row)| c == s && row.contains(&true));
    let surfaces = report.surfaces.iter().filter(|s| has(s.id.kind.class()));
    let surfaces = surfaces.map(|s| (s.most.get(), format!("on {}", s.surface), s.point));
    let island = report.island.iter().filter(|_| has(SurfaceClass::Edge));
    let island = island.map(|i| (i.most.get(), "an island in a channel".to_owned(), i.point));
    let most = surfaces.chain(island).max_by(|a, b| a.0.total_cmp(&b.0));
    let (value, what, point) = most.unwrap_or((0.0, "nothing".to_owned(), [0.0; 3]));
    let operation = report.operation as usize;
    Ok(Figure {
        value,
        found: None,
        what,
        point: Some(point),
        at: Some(super::rest::place(report)),
        operation: Some(operation),
    })
}
