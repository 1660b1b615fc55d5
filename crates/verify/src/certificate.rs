//! The figures of the proof.

use super::allowance::AllowanceReport;
use super::clamping::ClampingReport;
use super::clearance::Clearance;
use super::kept::KeptSurfaces;
use super::machine::MachineReport;
use super::obstacles::ObstacleReport;
use super::perimeter::PerimeterReport;
use super::proof::piece::At;
use super::rest::RestReport;
use super::splines::SplineReport;
use super::stated_points::{ImportedReport, StatedReport};
use super::stock::StockReport;
use super::surface::SurfaceReport;
use base::source::Span;
use base::units::{Mm, Sec};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use wheel::contract::{ContractKind, Relation};

/// Moves, lengths and time of one operation.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct OperationReport {
    /// Name.
    pub name: String,
    /// Tool.
    pub tool: String,
    /// Passes.
    pub passes: usize,
    /// Moves.
    pub moves: usize,
    /// Length of the tip path while cutting, linking and at rapid.
    pub length: [Mm; 3],
    /// Time of cutting, links and rapids.
    pub time: [Sec; 3],
    /// Spline blocks, where the operation has some.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub splines: Option<SplineReport>,
    /// Least distance of the shank to the design part; `None` when it is beyond the search distance.
    pub shank: Option<Clearance>,
    /// Least distance of the holder.
    pub holder: Option<Clearance>,
    /// Least distance of the whole tool to the turned stock at rapid.
    pub rapid: Option<Clearance>,
}

/// A contract with the found value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContractReport {
    /// Quantity; in a file by its name in the job language.
    #[serde(with = "by_name")]
    pub kind: ContractKind,
    /// Where the contract holds, as written in the job language: `on hub`; empty for everywhere.
    pub scope: String,
    /// Side of the bound on which the contract holds.
    pub relation: Relation,
    /// Unit of bound and found value: `mm`, `deg`, `s`, `mm3`, `mm3/min`, or `1` for a share of one.
    pub unit: Cow<'static, str>,
    /// Bound.
    pub bound: f64,
    /// Found value.
    pub found: f64,
    /// Quantity and place in the program, in words.
    pub place: String,
    /// Place on the part, mm; `None` for quantities without a place.
    pub point: Option<[f64; 3]>,
    /// Move of the program; `None` for quantities without a move.
    pub at: Option<At>,
    /// Whether the contract holds.
    pub holds: bool,
    /// True for a default contract, which the job does not state.
    pub default: bool,
    /// The worst value at the computed points, where `found` is a proved bound beyond it; not part of the file.
    #[serde(skip)]
    pub computed: Option<f64>,
    /// Its text in the job; not part of the file.
    #[serde(skip)]
    pub span: Span,
}

impl ContractReport {
    /// `gouge on hub`.
    pub fn name(&self) -> String {
        format!("{} {}", self.kind.name(), self.scope).trim_end().to_owned()
    }
}

/// An `allow` of the job with the found value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AllowedReport {
    /// Quantity; in a file by its name in the job language.
    #[serde(with = "by_name")]
    pub kind: ContractKind,
    /// Where.
    pub scope: String,
    /// Unit of the figure, as in [`ContractReport::unit`].
    pub unit: Cow<'static, str>,
    /// Value found there; `None` where it cannot be measured.
    pub found: Option<f64>,
    /// Quantity and place in the program, in words.
    pub place: String,
    /// Place on the part, mm; `None` for quantities without a place.
    pub point: Option<[f64; 3]>,
    /// Move of the program; `None` for quantities without a move.
    pub at: Option<At>,
    /// Reason, in the words of the job.
    pub reason: String,
    /// True when a contract would fail without it.
    pub excuses: bool,
    /// True in place of a default contract: nothing then judges the quantity.
    pub waives: bool,
}

/// A quantity as its name.
mod by_name {
    use serde::de::{Deserialize, Deserializer, Error};
    use serde::{Serialize, Serializer};
    use std::borrow::Cow;
    use wheel::contract::ContractKind;

    pub(super) fn serialize<S: Serializer>(kind: &ContractKind, serializer: S) -> Result<S::Ok, S::Error> {
        kind.name().serialize(serializer)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<ContractKind, D::Error> {
        let name = Cow::<str>::deserialize(deserializer)?;
        let kind = ContractKind::ALL.into_iter().find(|kind| kind.name() == name);
        kind.ok_or_else(|| D::Error::custom(format!("`{name}` is no quantity of a contract")))
    }
}

/// The whole proof.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Certificate {
    /// Program name.
    pub name: String,
    /// Machine.
    pub machine_name: String,
    /// Distance of the points that the job states from the surfaces that are cut, a report for each vane of points.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub form: Vec<StatedReport>,
    /// Files that the part was imported from, with what the import states of them; `None` for a part that was not imported.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub imported: Option<ImportedReport>,
    /// Spacing of the samples of the design surfaces.
    pub spacing: Mm,
    /// Largest difference between proved bounds and found values.
    pub slack: Mm,
    /// Milled surfaces.
    pub surfaces: Vec<SurfaceReport>,
    /// Surfaces that milling must leave as they are.
    pub kept: KeptSurfaces,
    /// Clearance of roughing to the part; `None` without roughing.
    pub allowance: Option<AllowanceReport>,
    /// Operations in order.
    pub operations: Vec<OperationReport>,
    /// Least distance of the whole tool to the turned stock at rapid.
    pub rapid: Option<Clearance>,
    /// Motion before, between and behind the operations.
    pub perimeter: PerimeterReport,
    /// Axes.
    pub machine: MachineReport,
    /// Stock after each roughing operation.
    pub rest: Vec<RestReport>,
    /// The stock through the program; `None` when it could not be simulated.
    pub stock: Option<StockReport>,
    /// Nearest approach to table and fixtures; empty where the machine file has none.
    #[serde(rename = "carried", default, skip_serializing_if = "Vec::is_empty")]
    pub obstacles: Vec<ObstacleReport>,
    /// Nearest approach to the space of chuck and table that the job states.
    pub clamping: ClampingReport,
    /// Contracts.
    pub contracts: Vec<ContractReport>,
    /// Items of `allow`.
    pub allowed: Vec<AllowedReport>,
}

impl Certificate {
    /// Time of all operations.
    pub fn time(&self) -> Sec {
        self.operations.iter().flat_map(|o| o.time).sum()
    }

    /// The most by which the control leaves the programmed motion, and the operation.
    pub fn deviation(&self) -> Option<(Mm, &str)> {
        let all = self.operations.iter().zip(&self.machine.runs).map(|(o, run)| (run.contour.value, o.name.as_str()));
        all.max_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Sectors that are machined, and all sectors: of each kind of surface that is machined at all, so many at least. A passage
    /// lies between the faces of two blades, so that the surfaces of one sector are not those of one passage.
    pub fn sectors(&self) -> [usize; 2] {
        let all: BTreeSet<_> = self.surfaces.iter().map(|s| s.id.sector).collect();
        let mut of_kind = BTreeMap::new();
        for surface in self.surfaces.iter().filter(|s| s.is_machined()) {
            *of_kind.entry(surface.id.kind).or_insert(0) += 1;
        }
        let made = of_kind.into_values().min().unwrap_or(0);
        [made, all.len()]
    }
}
