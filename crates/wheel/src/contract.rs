//! Contracts: quantities and scopes, in the words that job, stage values and verifier share.

use crate::part::SurfaceClass;
use base::units::{Mm, Mm3, Mm3PerMin, Rad, Sec, length, trim};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Quantity of a contract.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ContractKind {
    /// Depth of the deepest gouge into a design surface.
    Gouge,
    /// Largest excess on a design surface.
    Excess,
    /// Least distance of a part of the tool.
    Clearance(Guarded),
    /// Share of the time at feed in which the tool cuts air.
    Air,
    /// Time that the machine takes.
    Time,
    /// Largest axis speed as a share of the axis limit.
    AxisSpeed,
    /// Largest deviation of tip or flutes from the verified motion between the ends of blocks.
    ContourError,
    /// Largest angle of the tool axis against the verified motion between the ends of blocks.
    OrientationError,
    /// Largest removal rate.
    RemovalRate,
    /// Largest arc of the circle of the cutter in the stock.
    Engagement(Cuts),
    /// Deepest slot that an operation of finishing cuts, as a share of the diameter of its cutter.
    Slot,
    /// Largest thickness of stock that roughing leaves for the finishing operations.
    Rest,
    /// Volume of stock outside of the part.
    RestVolume,
}

/// Cuts whose engagement a contract limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Cuts {
    /// All cuts.
    All,
    /// Cuts that are no slots: a slot is a cut with material on both sides of the cutter at full width.
    OutsideSlots,
}

/// Parts of the tool, and the obstacle to which the clearance is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Guarded {
    /// Shank and holder to the design part.
    Body,
    /// The whole tool at rapid to the turned stock.
    Tool,
    /// Shank to the design part.
    Shank,
    /// Holder to the design part.
    Holder,
}

/// Side of the bound on which a value satisfies a contract.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Relation {
    /// `<=`
    #[serde(rename = "<=")]
    AtMost,
    /// `>=`
    #[serde(rename = ">=")]
    AtLeast,
}

impl Relation {
    /// Sign in the job language.
    pub fn sign(self) -> &'static str {
        match self {
            Self::AtMost => "<=",
            Self::AtLeast => ">=",
        }
    }

    /// True when `found` satisfies `bound`. A value that is not a number satisfies no bound.
    pub fn holds(self, found: f64, bound: f64) -> bool {
        match self {
            Self::AtMost => found <= bound,
            Self::AtLeast => found >= bound,
        }
    }
}

/// Meaning of the operations in the scope of a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OfOperations {
    /// The value during these operations.
    Done,
    /// The state after the last of these operations.
    After,
}

/// What the language and the program know of a quantity: a row of the table of contracts.
#[derive(Clone, Copy)]
struct Terms {
    /// Word in the job language.
    word: &'static str,
    /// The word, with the cuts to which the quantity is limited.
    name: &'static str,
    /// The bound with its unit, from a number in mm, deg, s, mm3, mm3/min or a share.
    bound: fn(f64) -> Bound,
    /// Side of the bound on which a value satisfies the contract.
    relation: Relation,
    /// Largest bound, as a job writes it.
    largest: &'static str,
    /// A bound that jobs often have, as a job writes it.
    usual: &'static str,
    /// Surfaces for which it can be required.
    surfaces: &'static [SurfaceClass],
    /// Meaning of operations in its scope.
    of_operations: OfOperations,
    /// Bound without a contract, in the unit of `bound`.
    default: Option<f64>,
    /// Meaning, for the reference of the language.
    meaning: &'static str,
}

/// Surfaces that operations mill.
const MILLED: &[SurfaceClass] = SurfaceClass::ALL.split_at(4).0;

const LENGTH: fn(f64) -> Bound = |x| Bound::Length(Mm(x));
const ANGLE: fn(f64) -> Bound = |x| Bound::Angle(Rad::from_deg(x));
const SHARE: fn(f64) -> Bound = Bound::Share;

/// A quantity of all cuts, during operations, without surfaces and without a default.
fn at_most(
    word: &'static str,
    bound: fn(f64) -> Bound,
    [largest, usual]: [&'static str; 2],
    meaning: &'static str,
) -> Terms {
    let (relation, of_operations) = (Relation::AtMost, OfOperations::Done);
    Terms { word, name: word, bound, relation, largest, usual, surfaces: &[], of_operations, default: None, meaning }
}

/// A length on surfaces that operations mill, after them.
fn on_milled(word: &'static str, usual: &'static str, meaning: &'static str) -> Terms {
    let base = at_most(word, LENGTH, ["100 mm", usual], meaning);
    Terms { surfaces: MILLED, of_operations: OfOperations::After, ..base }
}

/// A distance of a part of the tool: to the part, or of the whole tool to the turned stock.
fn clearance(of: Guarded) -> Terms {
    let (word, meaning) = match of {
        Guarded::Body => ("clearance", "the least distance of shank and holder to the part"),
        Guarded::Tool => ("clearance tool", "the least distance of the whole tool at rapid to the turned stock"),
        Guarded::Shank => ("clearance shank", "the least distance of the shank to the part"),
        Guarded::Holder => ("clearance holder", "the least distance of the holder to the part"),
    };
    let base = Terms { relation: Relation::AtLeast, ..at_most(word, LENGTH, ["100 mm", "0.5 mm"], meaning) };
    match of {
        Guarded::Tool => base,
        _ => Terms { surfaces: &SurfaceClass::ALL, default: Some(0.5), ..base },
    }
}

impl ContractKind {
    /// All quantities, in the order in which messages list them.
    pub const ALL: [Self; 17] = [
        Self::Gouge,
        Self::Excess,
        Self::Clearance(Guarded::Body),
        Self::Clearance(Guarded::Tool),
        Self::Clearance(Guarded::Shank),
        Self::Clearance(Guarded::Holder),
        Self::Air,
        Self::Time,
        Self::AxisSpeed,
        Self::ContourError,
        Self::OrientationError,
        Self::RemovalRate,
        Self::Engagement(Cuts::All),
        Self::Engagement(Cuts::OutsideSlots),
        Self::Slot,
        Self::Rest,
        Self::RestVolume,
    ];

    /// The table of contracts.
    fn terms(self) -> Terms {
        match self {
            Self::Gouge => Terms {
                of_operations: OfOperations::Done,
                default: Some(0.02),
                ..on_milled("gouge", "7 um", "the deepest cut of the swept tool into a design surface")
            },
            Self::Excess => on_milled("excess", "20 um", "the most stock that is left on a design surface"),
            Self::Clearance(of) => clearance(of),
            Self::Air => {
                at_most("air", SHARE, ["100 %", "30 %"], "the share of the time at feed in which the tool cuts air")
            }
            Self::Time => {
                at_most("time", |x| Bound::Time(Sec(x)), ["10000 h", "10 h"], "the time that the machine takes")
            }
            Self::AxisSpeed => {
                at_most("axis-speed", SHARE, ["100 %", "80 %"], "the largest speed of an axis as a share of its limit")
            }
            Self::ContourError => at_most(
                "contour-error",
                LENGTH,
                ["100 mm", "5 um"],
                "how far the control leaves the programmed motion of tip and flutes",
            ),
            Self::OrientationError => at_most(
                "orientation-error",
                ANGLE,
                ["90 deg", "0.01 deg"],
                "how far the control leaves the programmed tool axis",
            ),
            Self::RemovalRate => at_most(
                "removal-rate",
                |x| Bound::Rate(Mm3PerMin(x)),
                ["1000000 cm3/min", "2000 mm3/min"],
                "the largest removal rate",
            ),
            Self::Engagement(Cuts::All) => {
                at_most("engagement", ANGLE, ["360 deg", "60 deg"], "the largest arc of the cutter in the stock")
            }
            Self::Engagement(Cuts::OutsideSlots) => Terms {
                name: "engagement outside of slots",
                meaning: "the largest arc of the cutter in the stock, slots left out",
                ..Self::Engagement(Cuts::All).terms()
            },
            Self::Slot => at_most(
                "slot",
                SHARE,
                ["100 %", "50 %"],
                "the deepest slot that finishing cuts, as a share of the diameter of the cutter",
            ),
            Self::Rest => on_milled("rest", "1 mm", "the most stock that roughing leaves for the finishing operations"),
            Self::RestVolume => Terms {
                of_operations: OfOperations::After,
                ..at_most(
                    "rest-volume",
                    |x| Bound::Volume(Mm3(x)),
                    ["1000000 cm3", "500 mm3"],
                    "the volume of stock outside of the part",
                )
            },
        }
    }

    /// Name of the quantity with the cuts to which it is limited.
    pub fn name(self) -> &'static str {
        self.terms().name
    }

    /// The contract with a bound in the job language, without its scope.
    pub fn statement(self, bound: impl fmt::Display) -> String {
        let Terms { word, name, relation, .. } = self.terms();
        format!("{word} {} {bound}{}", relation.sign(), name.strip_prefix(word).unwrap_or_default())
    }

    /// A contract that jobs often have, for examples.
    pub fn usual(self) -> String {
        self.statement(self.terms().usual)
    }

    /// Largest bound, as a job writes it, with its unit.
    pub fn largest(self) -> &'static str {
        self.terms().largest
    }

    /// Name of the quantity in the job language.
    pub fn quantity(self) -> &'static str {
        self.terms().word
    }

    /// Side of the bound on which a value satisfies the contract.
    pub fn relation(self) -> Relation {
        self.terms().relation
    }

    /// Surfaces for which the quantity can be required; empty where the quantity belongs to no surface.
    pub fn surfaces(self) -> &'static [SurfaceClass] {
        self.terms().surfaces
    }

    /// Surfaces that distinguish its regions: all where the quantity belongs to no surface.
    pub fn speaks_of(self) -> &'static [SurfaceClass] {
        if self.surfaces().is_empty() { &SurfaceClass::ALL } else { self.surfaces() }
    }

    /// Bound that holds where a job neither requires nor allows the quantity; `None` where the job alone decides. No
    /// program is verified without these contracts.
    pub fn default_bound(self) -> Option<Bound> {
        self.terms().default.map(|value| self.bound(value))
    }

    /// Meaning, for the reference of the language.
    pub fn meaning(self) -> &'static str {
        self.terms().meaning
    }

    /// Whether a contract on this quantity includes another quantity: a contract on shank and holder together includes
    /// each of them.
    pub fn covers(self, other: Self) -> bool {
        let parts = [Guarded::Shank, Guarded::Holder].map(Self::Clearance);
        self == other || (self == Self::Clearance(Guarded::Body) && parts.contains(&other))
    }

    /// Whether an `allow` of this quantity takes operations and surfaces out of a contract on another one.
    pub fn takes_out_of(self, other: Self) -> bool {
        self == other || (self == Self::Engagement(Cuts::All) && matches!(other, Self::Engagement(_)))
    }

    /// Meaning of operations in the scope of the quantity.
    pub fn of_operations(self) -> OfOperations {
        self.terms().of_operations
    }

    /// The bound as a quantity with its unit, from a number in mm, deg, s, mm3, mm3/min or a share.
    pub fn bound(self, value: f64) -> Bound {
        (self.terms().bound)(value)
    }
}

/// Bound of a contract, with its unit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Bound {
    /// A length.
    Length(Mm),
    /// An angle.
    Angle(Rad),
    /// A share of one.
    Share(f64),
    /// A time.
    Time(Sec),
    /// A volume.
    Volume(Mm3),
    /// A removal rate.
    Rate(Mm3PerMin),
}

impl Bound {
    /// The number for texts and certificates, in the unit that [`Self::unit`] names: mm, deg, s, mm3, mm3/min or a share of
    /// one.
    pub fn value(self) -> f64 {
        match self {
            Self::Length(Mm(x)) | Self::Share(x) | Self::Time(Sec(x)) | Self::Volume(Mm3(x)) => x,
            Self::Rate(Mm3PerMin(x)) => x,
            Self::Angle(x) => x.deg(),
        }
    }

    /// Unit of [`Self::value`]; a share has the unit `1`.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Length(_) => "mm",
            Self::Angle(_) => "deg",
            Self::Share(_) => "1",
            Self::Time(_) => "s",
            Self::Volume(_) => "mm3",
            Self::Rate(_) => "mm3/min",
        }
    }

    /// The quantity with the decimals of a certificate; lengths as in [`length`].
    pub fn figure(self) -> String {
        match self {
            Self::Length(Mm(x)) => length(x),
            Self::Angle(x) => format!("{:.4} deg", x.deg()),
            Self::Share(x) => format!("{:.2} %", x * 100.0),
            Self::Time(Sec(x)) => clock(x),
            Self::Volume(Mm3(x)) => format!("{x:.1} mm3"),
            Self::Rate(Mm3PerMin(x)) => format!("{x:.1} mm3/min"),
        }
    }
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length(x) => write!(f, "{x}"),
            Self::Angle(x) => write!(f, "{x}"),
            Self::Share(x) => write!(f, "{} %", trim(x * 100.0, 6)),
            Self::Time(x) => write!(f, "{x}"),
            Self::Volume(x) => write!(f, "{x}"),
            Self::Rate(x) => write!(f, "{x}"),
        }
    }
}

/// Hours, minutes and seconds.
pub fn clock(seconds: f64) -> String {
    let s = seconds.round().max(0.0) as u64;
    format!("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60)
}

/// Surfaces and operations for which a contract holds; `O` is an index of an operation. An empty list is no
/// restriction.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scope<O> {
    /// Operations.
    pub operations: Vec<O>,
    /// Surfaces.
    pub surfaces: Vec<SurfaceClass>,
}

impl<O> Default for Scope<O> {
    fn default() -> Self {
        Self { operations: Vec::new(), surfaces: Vec::new() }
    }
}

impl<O> Scope<O> {
    /// True when both lists are empty.
    pub fn is_whole(&self) -> bool {
        self.operations.is_empty() && self.surfaces.is_empty()
    }

    /// The scope in the job language, with a blank before it; empty when the scope is whole.
    pub fn text(&self, operation: impl Fn(&O) -> String) -> String {
        let surfaces = self.surfaces.iter().map(|s| s.name().to_owned());
        let words: Vec<String> =
            surfaces.chain(self.operations.iter().map(|o| format!("operation {}", operation(o)))).collect();
        if words.is_empty() { String::new() } else { format!(" on {}", words.join(", ")) }
    }
}

/// Pairs of surface and operation for which a contract holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Region {
    /// For each of [`SurfaceClass::ALL`], whether each operation belongs to the region.
    pub rows: [Vec<bool>; 5],
}

impl Region {
    /// The region of a scope among `count` operations.
    pub fn of(scope: &Scope<usize>, count: usize) -> Self {
        let operations: Vec<bool> =
            (0..count).map(|o| scope.operations.is_empty() || scope.operations.contains(&o)).collect();
        let rows = SurfaceClass::ALL.map(|s| {
            let named = scope.surfaces.is_empty() || scope.surfaces.contains(&s);
            if named { operations.clone() } else { vec![false; count] }
        });
        Self { rows }
    }

    /// The pairs in this region that are not in the other.
    #[must_use]
    pub fn without(&self, other: &Self) -> Self {
        self.combined(other, |a, b| a && !b)
    }

    /// The pairs in both regions.
    #[must_use]
    pub fn within(&self, other: &Self) -> Self {
        self.combined(other, |a, b| a && b)
    }

    fn combined(&self, other: &Self, pick: fn(bool, bool) -> bool) -> Self {
        let mut rows = self.rows.clone();
        for (row, by) in rows.iter_mut().zip(&other.rows) {
            for (a, b) in row.iter_mut().zip(by) {
                *a = pick(*a, *b);
            }
        }
        Self { rows }
    }

    /// True when the region holds no pair with the given surfaces.
    pub fn is_empty_on(&self, surfaces: &[SurfaceClass]) -> bool {
        SurfaceClass::ALL.iter().zip(&self.rows).all(|(s, row)| !surfaces.contains(s) || !row.contains(&true))
    }

    /// For each operation, whether the region holds it with any surface.
    pub fn operations(&self) -> Vec<bool> {
        let count = self.rows[0].len();
        (0..count).map(|o| self.rows.iter().any(|row| row.get(o) == Some(&true))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regions_are_sets_of_pairs() {
        let scope = |operations: &[usize], surfaces: &[SurfaceClass]| Scope {
            operations: operations.to_vec(),
            surfaces: surfaces.to_vec(),
        };
        let whole = Region::of(&Scope::default(), 3);
        let hub = Region::of(&scope(&[], &[SurfaceClass::Hub]), 3);
        let second_on_hub = Region::of(&scope(&[1], &[SurfaceClass::Hub]), 3);
        assert_eq!(whole.within(&hub), hub);
        let left = hub.without(&second_on_hub);
        assert_eq!(left.rows[3], [true, false, true]);
        assert_eq!(left.operations(), [true, false, true]);
        assert!(left.is_empty_on(&[SurfaceClass::Pressure, SurfaceClass::Edge]));
        assert!(!left.is_empty_on(&[SurfaceClass::Hub]));
        assert!(hub.without(&whole).is_empty_on(&SurfaceClass::ALL));
    }

    #[test]
    fn a_figure_that_is_no_number_keeps_no_bound() {
        assert!(!Relation::AtMost.holds(f64::NAN, 1.0) && !Relation::AtLeast.holds(f64::NAN, 1.0));
    }
}
