//! What is to be made, with what, on which machine, and what must hold: the job as geometry.

use crate::collide::ToolSolid;
pub use crate::contract::ContractKind;
use crate::contract::{Bound, Guarded, Scope};
use crate::entity::PrimaryMap;
use crate::entity_id;
use crate::geom::Revolution;
use crate::kin::Machine;
pub use crate::operation::OperationKind;
use crate::part::{FaceId, Part, RulingEnd, Stock, SurfaceKind};
use crate::source::Span;
use crate::units::{Mm, MmPerMin, Rpm};
use nalgebra::Point3;

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
#[derive(Clone, Debug)]
pub struct Program {
    /// Name of the part; also the program name in the NC text.
    pub name: String,
    /// Design geometry.
    pub part: Part,
    /// Blank before the first operation.
    pub stock: Stock,
    /// Tools.
    pub tools: PrimaryMap<ToolId, Tool>,
    /// Operations in machining order.
    pub operations: PrimaryMap<OperationId, Operation>,
    /// What must hold.
    pub contracts: Vec<Contract>,
    /// What is taken out of them, with its reason.
    pub allowed: Vec<Allowed>,
    /// Machine with the part mounted on its table.
    pub machine: Machine,
    /// Dialect to write.
    pub post: PostChoice,
    /// Tolerances of path making.
    pub tolerances: Tolerances,
    /// Least distance of shank and holder to the part that planning keeps.
    pub clearance: Mm,
    /// Points that the guide curves of the faces go through, for the check of the data.
    pub data: Vec<DataCurve>,
    /// Memory that planning may take, bytes.
    pub memory: f64,
}

/// Memory that planning may take where nothing else is said, bytes.
pub const DEFAULT_MEMORY: f64 = 2e9;

/// The points of one guide curve as the job gives them, from inlet to outlet.
#[derive(Clone, Debug, PartialEq)]
pub struct DataCurve {
    /// Face that the curve bounds.
    pub side: FaceId,
    /// End of the rulings that it guides.
    pub end: RulingEnd,
    /// The points, each with its place in the text.
    pub points: Vec<DataPoint>,
}

/// One data point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DataPoint {
    /// Position in the part frame.
    pub point: Point3<f64>,
    /// Its place in the text, where there is one.
    pub span: Option<Span>,
}

/// Tolerances of path making.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerances {
    /// Largest distance between the planned and the interpolated tool, anywhere on the engaged cutter, in finishing.
    pub chord: Mm,
    /// The same in roughing.
    pub chord_rough: Mm,
}

/// A tool with its holder.
#[derive(Clone, Debug)]
pub struct Tool {
    /// Name in the job.
    pub name: String,
    /// Number in the magazine.
    pub number: u32,
    /// Teeth.
    pub flutes: u32,
    /// Swept solid of cutter, shank and holder about the tool axis; zero is the tip.
    pub solid: ToolSolid,
    /// Its declaration.
    pub span: Span,
}

impl Tool {
    /// Height of the gauge line over the tip, mm: what the tool table of the control holds as length of the tool.
    pub fn length(&self) -> f64 {
        self.solid.length()
    }
}

/// One operation.
#[derive(Clone, Debug)]
pub struct Operation {
    /// Name, unique in the job; the keyword, with a number where it occurs again.
    pub name: String,
    /// What it does.
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
    pub rest: Option<Mm>,
    /// Its declaration.
    pub span: Span,
}

/// A condition that stops the compilation when it does not hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Contract {
    /// What is measured.
    pub kind: ContractKind,
    /// The bound.
    pub bound: Bound,
    /// Where it holds.
    pub scope: Scope<OperationId>,
    /// True when the job says nothing: it holds wherever no other contract on the quantity does.
    pub default: bool,
    /// Its line in the job; nothing for a default.
    pub span: Span,
}

impl Contract {
    /// A contract on the whole part and program; `bound` in mm, s, mm3, mm3/min or as a share, as the quantity has it.
    pub fn whole(kind: ContractKind, bound: f64) -> Self {
        Self { kind, bound: kind.bound(bound), scope: Scope::default(), default: false, span: Span::default() }
    }
}

/// What is knowingly left: taken out of all contracts of its quantity.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Allowed {
    /// What is measured.
    pub kind: ContractKind,
    /// Where; everywhere only where it stands in place of a default contract.
    pub scope: Scope<OperationId>,
    /// Why, in the words of the job.
    pub reason: String,
    /// Its line in the job.
    pub span: Span,
}

/// The dialect that the job asks for.
#[derive(Clone, Debug, PartialEq)]
pub struct PostChoice {
    /// Name in the table of posts.
    pub name: String,
    /// Where the job names it; `None` when the command line does.
    pub span: Option<Span>,
}

impl Program {
    /// Largest distance to the part that contracts ask of shank or holder, mm.
    pub fn clearance_asked(&self, body: Guarded) -> Option<f64> {
        let asks = |kind: ContractKind| matches!(kind, ContractKind::Clearance(b) if b == body || b == Guarded::Body);
        self.contracts.iter().filter(|c| asks(c.kind)).map(|c| c.bound.value()).reduce(f64::max)
    }

    /// What comes highest under any angles of the rotary axes within their travel, `stock`, `table` or `fixture`, and its height in the machine frame,
    /// mm.
    pub fn highest(&self) -> (&'static str, f64) {
        let solids = self.machine.carried.iter().map(|solid| (solid.name, self.machine.highest(&solid.profile)));
        let stock = ("stock", self.machine.highest(&self.stock.profile));
        solids.fold(stock, |most, solid| if solid.1 > most.1 { solid } else { most })
    }

    /// True when an operation finishes an edge of the vanes, which else the lathe does.
    pub fn finishes_edges(&self) -> bool {
        let edge = |s: &SurfaceKind| matches!(s, SurfaceKind::InletEdge(_) | SurfaceKind::OutletEdge(_));
        self.operations
            .iter()
            .any(|(_, o)| matches!(&o.kind, OperationKind::Point { surfaces, .. } if surfaces.iter().any(edge)))
    }

    /// The surface over the vane tips.
    pub fn shroud(&self) -> &Revolution {
        &self.part.shroud
    }
}
