//! The job as geometry: part, tools, operations, machine and contracts.

use base::entity::PrimaryMap;
use base::entity_id;
use base::source::Span;
use base::units::{Mm, Mm3PerMin, MmPerMin, Rad, Rpm};
use five_axis::Machine;
use nalgebra::Point3;
use nurbs::Revolution;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use tool_stock::collide::ToolSolid;
pub use wheel::contract::ContractKind;
use wheel::contract::{Bound, Guarded, Scope};
use wheel::control::{Control, counts_in_part_frame};
pub use wheel::operation::{Allowances, OperationKind, RoughingStrategy};
use wheel::part::imported::ImportedFrom;
use wheel::part::{BladeId, FaceId, Part, RulingEnd, Stock, SurfaceKind, kept::MilledTurned};
use wheel::post_file::PostFile;

entity_id!(
    /// A tool of the job.
    ToolId,
    "tool"
);
entity_id!(
    /// An operation of the job, in machining order.
    OperationId,
    "op"
);

/// The lowered job.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Program {
    /// Name of the part; also the program name in the NC text.
    pub name: String,
    /// Its place in the job.
    pub name_span: Span,
    /// Design geometry.
    pub part: Part,
    /// Blank before the first operation.
    pub stock: Stock,
    /// Tools.
    pub tools: PrimaryMap<ToolId, Tool>,
    /// Operations in machining order.
    pub operations: PrimaryMap<OperationId, Operation>,
    /// Contracts.
    pub contracts: Vec<Contract>,
    /// Exceptions from the contracts, with their reasons.
    pub allowed: Vec<Allowed>,
    /// Machine with the part mounted on its table.
    pub machine: Machine,
    /// Dialect to write, with its number formats and frames.
    pub post: PostFile,
    /// Tolerances of the planned paths.
    pub tolerances: Tolerances,
    /// Least distance of shank and holder to the part that planning keeps.
    pub clearance: Mm,
    /// Points that the guide curves of the faces go through, for the check of the data.
    pub data: Vec<DataCurve>,
    /// Points that the job states for the surfaces of its vanes, for the certificate.
    pub stated: Vec<StatedPoints>,
    /// Files that the part was imported from.
    #[serde(deserialize_with = "Deserialize::deserialize")]
    pub imported: Option<ImportedFrom>,
    /// Memory that planning may use, bytes.
    pub memory: f64,
}

/// The points that the job states for the surfaces of a vane, in the part frame. A vane of angles has none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StatedPoints {
    /// The vane or the splitter.
    pub blade: BladeId,
    /// Points, mm.
    pub points: Vec<Point3<f64>>,
}

/// Least and largest orientation tolerance, degrees.
pub const ORIENTATION_TOLERANCES: [f64; 2] = [1e-4, 0.1];

/// Default of the memory that planning may use, bytes.
pub const DEFAULT_MEMORY: f64 = 2e9;

/// The points of one guide curve as the job gives them, from inlet to outlet.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DataCurve {
    /// Face that the curve bounds.
    pub side: FaceId,
    /// End of the rulings that the curve guides.
    pub end: RulingEnd,
    /// The points, each with its place in the text.
    pub points: Vec<DataPoint>,
}

/// One data point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DataPoint {
    /// Position in the part frame.
    pub point: Point3<f64>,
    /// Its place in the text, where it has one.
    #[serde(deserialize_with = "Deserialize::deserialize")]
    pub span: Option<Span>,
}

/// Tolerances of the planned paths.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tolerances {
    /// Largest distance between the planned and the interpolated tool, anywhere on the engaged cutter, in finishing.
    pub chord: Mm,
    /// The same tolerance in roughing.
    pub chord_rough: Mm,
}

/// A tool with its holder.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tool {
    /// Name in the job.
    pub name: String,
    /// Number in the magazine.
    pub number: u32,
    /// Teeth.
    pub flutes: u32,
    /// Swept solid of cutter, shank and holder about the tool axis; zero is the tip.
    pub solid: ToolSolid,
    /// Largest feed per tooth: the stated one, or a share of the diameter.
    pub max_chip: Mm,
    /// Largest depth of cut at full width: the stated one, or a share of the diameter.
    pub max_depth: Mm,
    /// Largest removal rate that the job or the library states.
    #[serde(deserialize_with = "Deserialize::deserialize")]
    pub max_rate: Option<Mm3PerMin>,
    /// Width, from the rim towards the axis, that the teeth of its end cut in a stroke along the axis. The radius for a
    /// tool that cuts at its centre; `None` for other shapes than flat, ball and bull.
    #[serde(deserialize_with = "Deserialize::deserialize")]
    pub plunge_width: Option<Mm>,
    /// Largest angle against the plane of its end at which it goes down while it moves sideways through material.
    pub ramp: Rad,
    /// True where the job or the tool library states this angle.
    pub ramp_stated: bool,
    /// Its declaration.
    pub span: Span,
}

impl Tool {
    /// Radius of the middle of the end, which has no teeth, mm; zero for a tool that cuts at its centre. `None` for other
    /// shapes than flat, ball and bull.
    pub fn toothless_radius(&self) -> Option<f64> {
        self.plunge_width.map(|width| (self.solid.radius() - width.get()).max(0.0))
    }

    /// Height of the gauge line over the tip, mm: the tool length in the tool table of the control.
    pub fn length(&self) -> f64 {
        self.solid.length()
    }

    /// Lowest height of any point of the tool on a machine, under any angles of its head within their travel, mm, against
    /// the gauge line with the head upright.
    pub fn lowest(&self, machine: &Machine) -> f64 {
        let ToolSolid { cutter, flute_length, shank, holder } = &self.solid;
        let radius = cutter.widest_below(*flute_length);
        let sections = shank.iter().chain(holder);
        let corners = sections.flat_map(|x| [[x.radius_from, x.from], [x.radius_to, x.to]]);
        let profile: Vec<[f64; 2]> = [[radius, 0.0], [radius, *flute_length]].into_iter().chain(corners).collect();
        machine.lowest(&profile, self.length())
    }
}

/// One operation.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Operation {
    /// Name, unique in the job; the keyword, with a number where it occurs again.
    pub name: String,
    /// Kind of the operation with its parameters.
    pub kind: OperationKind,
    /// Its tool.
    pub tool: ToolId,
    /// Spindle speed.
    pub speed: Rpm,
    /// Feed of the tool tip along the part while cutting.
    pub feed: MmPerMin,
    /// Feed along the tool axis into and out of the channel, and of lead moves in air.
    pub link_feed: MmPerMin,
    /// Sectors to machine, from 0: vane k and the channel that follows it counter-clockwise.
    pub sectors: Vec<u32>,
    /// Length added before the first contact, along the path.
    pub lead_in: Mm,
    /// Length added after the last contact.
    pub lead_out: Mm,
    /// Rest machining: only stock thicker than this is cut; `None` cuts every pass whole.
    #[serde(deserialize_with = "Deserialize::deserialize")]
    pub rest: Option<Mm>,
    /// Its declaration.
    pub span: Span,
}

/// A condition that stops the compilation when it does not hold.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Contract {
    /// Quantity.
    pub kind: ContractKind,
    /// The bound.
    pub bound: Bound,
    /// Surfaces and operations for which the contract holds.
    pub scope: Scope<OperationId>,
    /// True when the job does not give the contract: it holds wherever no other contract on the quantity does.
    pub default: bool,
    /// Its line in the job; the empty span for a default.
    pub span: Span,
}

impl Contract {
    /// A contract on the whole part and program; `bound` in mm, deg, s, mm3, mm3/min or as a share, depending on the
    /// quantity.
    pub fn whole(kind: ContractKind, bound: f64) -> Self {
        Self { kind, bound: kind.bound(bound), scope: Scope::default(), default: false, span: Span::default() }
    }
}

/// A deviation that the job allows: it is excluded from all contracts of its quantity.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Allowed {
    /// Quantity.
    pub kind: ContractKind,
    /// Surfaces and operations. The scope is everything only where the exception replaces a default contract.
    pub scope: Scope<OperationId>,
    /// Reason, in the words of the job.
    pub reason: String,
    /// Its line in the job.
    pub span: Span,
}

impl Program {
    /// What the control takes. Planning asks this alone; the rest of the post file is for those who write the text.
    pub fn control(&self) -> &Control {
        &self.post.control
    }

    /// Whether the words of the program count in the part frame.
    pub fn words_in_part_frame(&self) -> bool {
        counts_in_part_frame(&self.post.dialect)
    }

    /// All places in texts that the program refers to.
    pub fn spans(&self) -> impl Iterator<Item = Span> {
        let PostFile { span, dialect_span, offset, splines_span, end_span, .. } = &self.post;
        let templates =
            self.post.smoothing.iter().chain(&self.post.transformation).chain(self.post.frames.iter().flatten());
        let of_post = [*dialect_span, *end_span].into_iter().chain(*span);
        let of_post = of_post.chain(offset.iter().map(|x| x.1)).chain(*splines_span);
        let points = self.data.iter().flat_map(|curve| &curve.points).filter_map(|point| point.span);
        std::iter::once(self.name_span)
            .chain(of_post)
            .chain(templates.map(|template| template.span))
            .chain(self.tools.iter().map(|(_, tool)| tool.span))
            .chain(self.operations.iter().map(|(_, operation)| operation.span))
            .chain(self.contracts.iter().map(|contract| contract.span))
            .chain(self.allowed.iter().map(|allowed| allowed.span))
            .chain(points)
    }

    /// Path tolerance of an operation, mm.
    pub fn path_tolerance(&self, operation: &Operation) -> f64 {
        if operation.kind.finishes() { self.tolerances.chord.get() } else { self.tolerances.chord_rough.get() }
    }

    /// Largest error of the tool direction that smoothing may add in an operation, radians: that of the post, or else the
    /// angle that moves the upper end of the flutes by the path tolerance.
    pub fn orientation_tolerance(&self, operation: &Operation) -> f64 {
        let by_flutes = || self.path_tolerance(operation) / self.tools[operation.tool].solid.flute_length;
        let [least, most] = ORIENTATION_TOLERANCES.map(f64::to_radians);
        self.post.control.orientation_tolerance.unwrap_or_else(by_flutes).clamp(least, most)
    }

    /// The same program with another solid for a tool.
    #[must_use]
    pub fn with_solid(&self, tool: ToolId, solid: &ToolSolid) -> Self {
        let mut tools = PrimaryMap::new();
        for (id, other) in self.tools.iter() {
            let solid = if id == tool { solid } else { &other.solid };
            tools.push(Tool { solid: solid.clone(), ..other.clone() });
        }
        Self { tools, ..self.clone() }
    }

    /// Largest clearance to the part that the contracts require for shank or holder, mm.
    pub fn required_clearance(&self, body: Guarded) -> Option<f64> {
        let asks = |kind: ContractKind| matches!(kind, ContractKind::Clearance(b) if b == body || b == Guarded::Body);
        self.contracts.iter().filter(|c| asks(c.kind)).map(|c| c.bound.value()).reduce(f64::max)
    }

    /// The highest obstacle under any angles of the rotary axes within their travel (`stock`, `table` or `fixture`),
    /// and its height in the machine frame, mm.
    pub fn highest(&self) -> (&'static str, f64) {
        let solids = self.machine.carried.iter().map(|solid| (solid.kind.name(), self.machine.highest(&solid.profile)));
        let stock = ("stock", self.machine.highest(&self.stock.profile));
        solids.fold(stock, |most, solid| if solid.1 > most.1 { solid } else { most })
    }

    /// The edges and tips of the blades that operations finish: edges at the inlet and at the outlet by themselves. The lathe makes the
    /// others, but no edge inside of the part.
    pub fn milled_turned(&self) -> MilledTurned {
        let end = |s: SurfaceKind| match s {
            SurfaceKind::InletEdge(_) => Some(0),
            SurfaceKind::OutletEdge(_) => Some(1),
            _ => None,
        };
        let finishes = |o: &Operation, wanted: usize| {
            let at_end = |s: &SurfaceKind| end(*s) == Some(wanted);
            matches!(&o.kind, OperationKind::Point { surfaces, .. } if surfaces.iter().any(at_end))
        };
        let finished = |wanted: usize| self.operations.iter().any(|(_, o)| finishes(o, wanted));
        let any = [0, 1].map(finished);
        // Where some edges are milled, so are those that no lathe can make.
        let inside = |end: usize| self.part.blade_ids().any(|blade| self.part.ends_inside(blade, end));
        let edges = [0, 1].map(|end| any[end] || (any[1 - end] && inside(end)));
        MilledTurned { edges, tips: self.operations.iter().any(|(_, o)| !o.kind.tips().is_empty()) }
    }

    /// Sectors, from 0, whose channels an operation enters but the roughing of the job leaves full; with the operation that
    /// roughs first. A vane has the channel of its own sector on one side, and that of the sector before on the other.
    pub fn sectors_left_full(&self, operation: &Operation) -> Option<(&Operation, BTreeSet<u32>)> {
        let count = self.part.vane_count;
        let before = |k: &u32| (k + count.saturating_sub(1)) % count.max(1);
        let roughing = || self.operations.iter().map(|(_, o)| o).filter(|o| o.kind.roughing().is_some());
        let opened: BTreeSet<u32> = roughing().flat_map(|o| o.sectors.iter().copied()).collect();
        let own = operation.sectors.iter().copied();
        let both_sides = operation.kind.finishes() && !operation.kind.is_on_floor();
        let beside = operation.sectors.iter().filter(|_| both_sides).map(before);
        let full: BTreeSet<u32> = own.chain(beside).filter(|k| !opened.contains(k)).collect();
        roughing().next().filter(|_| !full.is_empty()).map(|first| (first, full))
    }

    /// The surface over the vane tips.
    pub fn shroud(&self) -> &Revolution {
        &self.part.shroud
    }
}
