//! What an operation does: one type from the job to the paths, and its words in the job language.

use crate::method::{AxisMethod, Flank, Levels, Lines, Milling, Slots, Spacing};
use crate::part::{BladeId, FaceId, Part, SurfaceKind};
use base::units::Mm;
use serde::{Deserialize, Serialize};

/// Stock that roughing leaves on vanes and fillets. It grows evenly over the height, from the tip to the root, so that a
/// thin vane stays stiff; or it is the same everywhere.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "StoredAllowance")]
pub struct VaneAllowance {
    tip: Mm,
    root: Mm,
}

/// An allowance that is read.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredAllowance {
    tip: Mm,
    root: Mm,
}

impl TryFrom<StoredAllowance> for VaneAllowance {
    type Error = &'static str;

    fn try_from(StoredAllowance { tip, root }: StoredAllowance) -> Result<Self, Self::Error> {
        Self::growing(tip, root).ok_or("an allowance is smaller at the root than at the tip")
    }
}

impl VaneAllowance {
    /// No allowance.
    pub const NONE: Self = Self::even(Mm(0.0));

    /// The same allowance at every height.
    pub const fn even(value: Mm) -> Self {
        Self { tip: value, root: value }
    }

    /// An allowance with these values at the tip and at the root. `None` where it is smaller at the root.
    pub fn growing(tip: Mm, root: Mm) -> Option<Self> {
        (root.get() >= tip.get()).then_some(Self { tip, root })
    }

    /// The allowance at a share of the height, from 0 at the hub to 1 at the shroud ([`crate::part::Part::height`]), mm.
    pub fn at(self, height: f64) -> f64 {
        self.tip.get() + self.growth() * (1.0 - height.clamp(0.0, 1.0))
    }

    /// The least allowance, that at the tip.
    pub const fn tip(self) -> Mm {
        self.tip
    }

    /// The largest allowance, that at the root.
    pub const fn root(self) -> Mm {
        self.root
    }

    /// How much more the root has than the tip, mm.
    pub fn growth(self) -> f64 {
        self.root.get() - self.tip.get()
    }

    /// The allowance with a distance more at every height, mm.
    #[must_use]
    pub fn plus(self, more: f64) -> Self {
        Self { tip: Mm(self.tip.get() + more), root: Mm(self.root.get() + more) }
    }
}

impl std::fmt::Display for VaneAllowance {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.tip == self.root { write!(f, "{}", self.tip) } else { write!(f, "{} .. {}", self.tip, self.root) }
    }
}

/// What roughing leaves on the part.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Allowances {
    /// On vanes and fillets.
    pub vane: VaneAllowance,
    /// On the hub.
    pub hub: Mm,
}

impl Allowances {
    /// No allowances.
    pub const NONE: Self = Self::even(0.0);

    /// The same allowance everywhere, mm.
    pub const fn even(value: f64) -> Self {
        Self { vane: VaneAllowance::even(Mm(value)), hub: Mm(value) }
    }

    /// The allowances with a distance more, mm.
    #[must_use]
    pub fn plus(self, more: f64) -> Self {
        Self { vane: self.vane.plus(more), hub: Mm(self.hub.get() + more) }
    }
}

/// How the material between the vanes is removed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum RoughingStrategy {
    /// One line in the middle of the channel, layer by layer (Wei 3.1.1).
    Groove {
        /// Largest step between layers.
        depth: Mm,
    },
    /// Inverted V lines on both sides of the groove (Wei 3.1.2).
    Expand {
        /// Largest step between layers.
        depth: Mm,
        /// Height between neighbouring lines (h of formula 9).
        residual: Mm,
    },
    /// The channel, level by level: a slot in the middle or loops that open it, then lines along both walls from there
    /// outward.
    Rough {
        /// Largest step between levels.
        depth: Mm,
        /// Largest distance between neighbouring lines.
        stepover: Mm,
        /// Form of the levels.
        levels: Levels,
        /// Sense of the lines beside the slot.
        milling: Milling,
        /// How the first cut at a place is made.
        slots: Slots,
    },
    /// The channel, by strokes along the tool axis from above the stock down to the floor.
    Plunge {
        /// Largest distance between neighbouring strokes, along the channel and across it.
        stepover: Mm,
    },
}

/// Kind of an operation with its own parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum OperationKind {
    /// The material between the vanes, before finishing.
    Roughing {
        /// What stays on the part.
        allowances: Allowances,
        /// How it is removed.
        strategy: RoughingStrategy,
    },
    /// Vane faces, milled with the side of the cutter (Wei 3.2).
    Flank {
        /// Faces to finish.
        faces: Vec<FaceId>,
        /// Method.
        flank: Flank,
    },
    /// Hub between the vanes, milled along streamlines (Wei 3.3).
    Channel {
        /// Scallop height between neighbouring lines.
        scallop: Mm,
        /// Spacing of the lines.
        spacing: Spacing,
        /// Direction of the lines.
        lines: Lines,
        /// How tool axes are chosen.
        method: AxisMethod,
        /// For a larger tool, which finishes the middle of the floor only: what it leaves beside vanes and fillets.
        /// `None` for the ball that finishes the floor up to the fillets.
        #[serde(deserialize_with = "Deserialize::deserialize")]
        allowance_vane: Option<Mm>,
    },
    /// Faces, fillets, edges or tips of vanes, milled in lines of constant scallop height.
    Point {
        /// Surfaces to finish.
        surfaces: Vec<SurfaceKind>,
        /// Scallop height between neighbouring lines.
        scallop: Mm,
        /// Direction of the lines.
        lines: Lines,
        /// Sense of milling on both sides of a vane. `None` for lines that do not keep one: `zigzag`, and those along edges and tips.
        #[serde(deserialize_with = "Deserialize::deserialize")]
        milling: Option<Milling>,
        /// Height of the levels that all faces share before the next one; `None` for one face after the other.
        #[serde(deserialize_with = "Deserialize::deserialize")]
        levels: Option<Mm>,
        /// How tool axes are chosen.
        method: AxisMethod,
    },
}

impl RoughingStrategy {
    /// Keyword in the job language.
    pub fn keyword(self) -> &'static str {
        match self {
            Self::Groove { .. } => "groove",
            Self::Expand { .. } => "expand",
            Self::Rough { .. } => "rough",
            Self::Plunge { .. } => "plunge",
        }
    }

    /// Largest step between levels; `None` for strokes.
    pub fn step_down(self) -> Option<Mm> {
        match self {
            Self::Groove { depth } | Self::Expand { depth, .. } | Self::Rough { depth, .. } => Some(depth),
            Self::Plunge { .. } => None,
        }
    }

    /// True where the passes are cut to the stock that they find.
    pub fn follows_stock(self) -> bool {
        match self {
            Self::Rough { .. } | Self::Plunge { .. } => true,
            Self::Groove { .. } | Self::Expand { .. } => false,
        }
    }
}

impl OperationKind {
    /// Keyword in the job language.
    pub fn keyword(&self) -> &'static str {
        match self {
            Self::Roughing { strategy, .. } => strategy.keyword(),
            Self::Flank { .. } => "flank",
            Self::Channel { .. } => "channel",
            Self::Point { surfaces, .. } => surfaces.first().and_then(|s| word(*s)).map_or("point", |w| w.0),
        }
    }

    /// True for the operations that bring a surface to its final shape.
    pub fn finishes(&self) -> bool {
        matches!(self, Self::Flank { .. } | Self::Channel { .. } | Self::Point { .. })
    }

    /// True for the operation whose lines run on the floor of the channel. Its tool may turn to the axes of neighbouring
    /// lines; on a face the cutter would turn against the wall that it cuts.
    pub fn is_on_floor(&self) -> bool {
        matches!(self, Self::Channel { .. })
    }

    /// The material that roughing leaves on vanes and on the hub; `None` for finishing.
    pub fn roughing(&self) -> Option<Allowances> {
        match *self {
            Self::Roughing { allowances, .. } => Some(allowances),
            Self::Flank { .. } | Self::Channel { .. } | Self::Point { .. } => None,
        }
    }

    /// How roughing removes the material; `None` for finishing.
    pub fn strategy(&self) -> Option<RoughingStrategy> {
        match *self {
            Self::Roughing { strategy, .. } => Some(strategy),
            Self::Flank { .. } | Self::Channel { .. } | Self::Point { .. } => None,
        }
    }

    /// Largest step between levels; `None` for operations without levels.
    pub fn step_down(&self) -> Option<Mm> {
        self.strategy()?.step_down()
    }

    /// True for the operations whose passes are cut to the stock that they find.
    pub fn follows_stock(&self) -> bool {
        self.strategy().is_some_and(RoughingStrategy::follows_stock)
    }

    /// What the larger tool of a channel floor leaves beside vanes and fillets; `None` for all other operations.
    pub fn of_larger_tool(&self) -> Option<Mm> {
        match self {
            Self::Channel { allowance_vane, .. } => *allowance_vane,
            Self::Roughing { .. } | Self::Flank { .. } | Self::Point { .. } => None,
        }
    }

    /// The blades that the operation works at: those of its surfaces, or all.
    pub fn blades(&self, part: &Part) -> impl Iterator<Item = BladeId> {
        let all = || part.blade_ids().collect();
        let mut blades: Vec<BladeId> = match self {
            Self::Flank { faces, .. } => faces.iter().map(|face| face.blade).collect(),
            Self::Point { surfaces, .. } => surfaces.iter().filter_map(|s| word(*s)).map(|w| w.2).collect(),
            Self::Roughing { .. } | Self::Channel { .. } => all(),
        };
        blades.sort_unstable();
        blades.dedup();
        blades.into_iter()
    }

    /// The blades whose tips the operation finishes.
    pub fn tips(&self) -> Vec<BladeId> {
        let Self::Point { surfaces, .. } = self else { return Vec::new() };
        let tip = |surface: &SurfaceKind| if let SurfaceKind::Tip(blade) = surface { Some(*blade) } else { None };
        surfaces.iter().filter_map(tip).collect()
    }

    /// Method for the tool axes, where the operation has this choice.
    pub fn axis_method(&self) -> Option<AxisMethod> {
        match self {
            Self::Channel { method, .. } | Self::Point { method, .. } => Some(*method),
            Self::Roughing { .. } | Self::Flank { .. } => None,
        }
    }
}

/// Names in their order, each once.
pub fn distinct<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut all = Vec::new();
    for name in names {
        if !all.contains(&name) {
            all.push(name);
        }
    }
    all
}

/// The surfaces of a blade that are finished in lines of constant scallop height, each with its operation and its word
/// in this operation.
pub fn by_lines(blade: BladeId) -> [(SurfaceKind, &'static str, &'static str); 7] {
    let [one, other] = blade.faces();
    [
        (SurfaceKind::Face(one), "point", one.name()),
        (SurfaceKind::Face(other), "point", other.name()),
        (SurfaceKind::Fillet(one), "fillet", one.name()),
        (SurfaceKind::Fillet(other), "fillet", other.name()),
        (SurfaceKind::InletEdge(blade), "edge", "inlet"),
        (SurfaceKind::OutletEdge(blade), "edge", "outlet"),
        (SurfaceKind::Tip(blade), "tip", "tip"),
    ]
}

/// The operation that finishes a surface in lines of constant scallop height, the word of the surface in this
/// operation, and its blade.
pub fn word(surface: SurfaceKind) -> Option<(&'static str, &'static str, BladeId)> {
    let blade = match surface {
        SurfaceKind::Face(face) | SurfaceKind::Fillet(face) => face.blade,
        SurfaceKind::InletEdge(blade) | SurfaceKind::OutletEdge(blade) | SurfaceKind::Tip(blade) => blade,
        _ => return None,
    };
    // The fillet round an edge belongs to the operation on the fillets of both faces.
    if let SurfaceKind::Fillet(edge) = surface
        && edge.edge_end().is_some()
    {
        return Some(("fillet", edge.name(), blade));
    }
    by_lines(blade).into_iter().find(|entry| entry.0 == surface).map(|entry| (entry.1, entry.2, blade))
}
