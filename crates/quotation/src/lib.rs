//! What the machining of a job takes, without planning it: a time that no program is below, the expected one and an upper one, the
//! stock and the chips.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking"))]

mod bound;
mod expected;
mod surfaces;

pub use bound::LowerBound;
pub use expected::Expected;

use ir::{ContractKind, OperationKind, Program};
use serde::Serialize;
use wheel::material::Material;
use wheel::part::solid;

/// What a job takes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Quote {
    /// Version of this form.
    pub version: u32,
    /// Time that no program with these tools and feeds is below.
    pub lower: LowerBound,
    /// Expected time, minutes: predicted by a model.
    pub expected: f64,
    /// Time that most programs are below, minutes: predicted too.
    pub upper: f64,
    /// The operations.
    pub operations: Vec<Expected>,
    /// Volumes and weights.
    pub stock: StockSizes,
}

/// Volumes and weights of the blank, of the finished part and of the chips.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StockSizes {
    /// Volume of the blank, mm3.
    pub blank: f64,
    /// Volume of the finished part, mm3; `None` where its surfaces do not close.
    pub part: Option<f64>,
    /// Volume that is milled off, mm3, where that of the part is known.
    pub chips: Option<f64>,
    /// Weight of the blank, kg.
    pub weight: f64,
}

/// Version of the form of a quote.
const VERSION: u32 = 1;

/// Error of the volume of the part, as a share, that is near enough.
const NEAR: f64 = 1e-3;

/// Estimates a program.
pub fn quote(program: &Program) -> Quote {
    let milled = surfaces::milled(&program.part);
    let stock = stock_sizes(program);
    let lower = bound::lower_bound(program, &milled, removed(program, &stock), limits(program));
    let operations = expected::expected(program, &milled, &expected::Widths::of(&program.part));
    // The model knows nothing of the bound.
    let expected = (operations.iter().map(|o| o.seconds).sum::<f64>() / 60.0).max(lower.minutes);
    Quote { version: VERSION, lower, expected, upper: (1.0 + expected::ERROR) * expected, operations, stock }
}

fn stock_sizes(program: &Program) -> StockSizes {
    let profile: Vec<[f64; 2]> = program.stock.profile.iter().copied().collect();
    let blank = program.stock.left.as_ref().map_or_else(|| surfaces::turned_volume(&profile), |left| left.volume());
    // The larger volume of the part leaves less to mill off: the bound stays one.
    let part = solid::volume(&program.part, &program.stock, NEAR).map(|volume| volume.value + volume.error);
    let material = program.stock.material.unwrap_or(Material::Aluminium);
    let chips = part.map(|part| (blank - part).max(0.0));
    StockSizes { blank, part, chips, weight: density(material) * blank * 1e-6 }
}

/// Volume that operations remove, mm3: all of it where each channel is roughed and finished.
fn removed(program: &Program, stock: &StockSizes) -> f64 {
    let all = program.part.vane_count as usize;
    let whole =
        |is: fn(&OperationKind) -> bool| program.operations.iter().any(|(_, o)| is(&o.kind) && o.sectors.len() == all);
    let cleared =
        whole(|kind| kind.roughing().is_some()) && whole(|kind| matches!(kind, OperationKind::Channel { .. }));
    if cleared { stock.chips.unwrap_or(0.0) } else { 0.0 }
}

/// The most that surfaces may have in excess and in gouges, mm: of contracts the loosest, else what the operations leave by themselves.
fn limits(program: &Program) -> [f64; 2] {
    let loosest = |kind: ContractKind| {
        let stated = program.contracts.iter().filter(|contract| contract.kind == kind);
        stated.map(|contract| contract.bound.value()).reduce(f64::max)
    };
    let left = |kind: &OperationKind| match kind {
        OperationKind::Channel { scallop, .. } | OperationKind::Point { scallop, .. } => scallop.get(),
        OperationKind::Flank { .. } | OperationKind::Roughing { .. } => 0.0,
    };
    let chord = program.tolerances.chord.get();
    let ridges = program.operations.iter().map(|(_, o)| left(&o.kind)).fold(0.0, f64::max);
    let excess = loosest(ContractKind::Excess).map_or(ridges + chord, |stated| stated.max(ridges));
    [excess, loosest(ContractKind::Gouge).unwrap_or(chord)]
}

/// Weight of a material, g/cm3: alloys that are usual for impellers.
pub fn density(material: Material) -> f64 {
    match material {
        Material::Aluminium => 2.8,
        Material::Steel => 7.85,
        Material::Stainless => 7.9,
        Material::Titanium => 4.43,
        Material::Nickel => 8.2,
    }
}
