//! The typed job: units as types, resolved names, explicit defaults.

pub(crate) mod blades;
pub(crate) mod tool;

use crate::property::quantity::Quantity;
use base::source::{Span, Spanned};
use base::units::{Mm, MmPerMin, Rad, Rpm};
use blade::{EdgeForm, LoopEdges};
pub use blades::{
    AnglesAtSpan, AnglesSpec, CamberSpec, CurveSpec, DistributionSpec, EdgePlace, Facing, MeridianPlace, SpanSpec,
};
use five_axis::control::{LengthTo, ModuloWay, Planning};
use std::collections::BTreeMap;
use std::sync::Arc;
pub use tool::{CutterKind, LoadLimits, ToolSpec};
use tool_stock::stock::Mesh;
pub use wheel::contract::ContractKind;
use wheel::contract::{Bound, Guarded, OfOperations, Region, Scope};
use wheel::material::Material;
pub use wheel::operation::OperationKind;
use wheel::part::imported::ImportedFrom;
use wheel::part::{FaceId, Fillet, RulingEnd};
use wheel::post_file::PostFile;

/// The whole job.
#[derive(Clone, Debug)]
pub struct Job {
    /// Machine.
    pub machine: MachineSpec,
    /// Names of the tool libraries.
    pub libraries: Vec<String>,
    /// Part.
    pub part: PartSpec,
    /// Blank.
    pub stock: StockSpec,
    /// Tools in the order of the job; operations index them.
    pub tools: Vec<ToolSpec>,
    /// Operations in machining order.
    pub operations: Vec<OperationSpec>,
    /// Contracts.
    pub contracts: Vec<ContractSpec>,
    /// Items that `allow` takes out of the contracts.
    pub allowed: Vec<AllowedSpec>,
    /// Chord tolerance in finishing.
    pub chord: Mm,
    /// Chord tolerance in roughing.
    pub chord_rough: Mm,
    /// Distance of shank and holder to the part that planning keeps: the largest bound of a `require clearance` for
    /// them, or 0.5 mm.
    pub clearance: Mm,
    /// Dialect, number formats and frames.
    pub post: PostFile,
}

/// The readable content of a text, with or without faults: an editor answers from it while a job is being written.
#[derive(Clone, Debug)]
pub struct PartialJob {
    /// Values of `let`, where they are readable.
    pub values: BTreeMap<String, Quantity>,
    /// Machine, where it is readable.
    pub machine: Option<MachineSpec>,
    /// Names of the tool libraries.
    pub libraries: Vec<String>,
    /// Part, where it is readable.
    pub part: Option<PartSpec>,
    /// Blank, where it is readable.
    pub stock: Option<StockSpec>,
    /// All tools of the text in their order, which operations index; `None` where a tool is not understood.
    pub tools: Vec<Option<ToolSpec>>,
    /// The readable operations.
    pub operations: Vec<OperationSpec>,
    /// The readable contracts.
    pub contracts: Vec<ContractSpec>,
    /// Items that `allow` takes out of the contracts.
    pub allowed: Vec<AllowedSpec>,
    /// Chord tolerance in finishing.
    pub chord: Mm,
    /// Chord tolerance in roughing.
    pub chord_rough: Mm,
    /// Dialect, number formats and frames, where they are readable.
    pub post: Option<PostFile>,
    /// True when the text has no fault: only then indices of one list into another are valid.
    pub whole: bool,
}

impl PartialJob {
    /// The job, where the text has no fault.
    pub fn job(self) -> Option<Job> {
        let Self {
            machine,
            libraries,
            part,
            stock,
            tools,
            operations,
            contracts,
            allowed,
            chord,
            chord_rough,
            post,
            whole,
            ..
        } = self;
        if !whole {
            return None;
        }
        // Planning keeps the largest required distance of shank or holder everywhere, and the default where that is
        // allowed.
        let body = ContractKind::Clearance(Guarded::Body);
        let bounds = contracts.iter().filter(|c| c.kind == body || body.covers(c.kind)).map(|c| c.bound.value());
        let usual = body.default_bound().map_or(0.0, |b| b.value());
        let clearance = Mm(bounds.reduce(f64::max).unwrap_or(usual));
        Some(Job {
            machine: machine?,
            libraries,
            part: part?,
            stock: stock?,
            tools: tools.into_iter().collect::<Option<Vec<ToolSpec>>>()?,
            operations,
            contracts,
            allowed,
            chord,
            chord_rough,
            clearance,
            post: post?,
        })
    }
}

base::named! {
    /// Which rotary axes of a machine carry the tool, and which the part.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum MachineKind {
        /// Both carry the part.
        TableTable = "table-table",
        /// One carries the tool, one the part.
        HeadTable = "head-table",
        /// Both carry the tool.
        HeadHead = "head-head",
    }
}

/// A machine file.
#[derive(Clone, Debug, PartialEq)]
pub struct MachineSpec {
    /// Name in the library.
    pub name: String,
    /// X, Y, Z.
    pub linear: [LinearSpec; 3],
    /// Kind, and its place in the file.
    pub kind: Spanned<MachineKind>,
    /// The rotary axes in the sense of the machine's own words: first the axis next to the tool, then the axis next to
    /// the part.
    pub rotary: [RotarySpec; 2],
    /// Origin of the part in the machine frame, with the rotary axes at zero, and its place in the file.
    pub part_origin: Spanned<[Mm; 3]>,
    /// Directions of X and Z of the part in the machine frame, with the rotary axes at zero: of length 1, at right angles.
    /// `None` where the file states neither: they are those of the machine.
    pub part_axes: Option<[[f64; 3]; 2]>,
    /// Whether the file states the direction of Z of the part.
    pub part_direction: bool,
    /// Height of the gauge line at which tools are changed and all axes but Z may move.
    pub retract: Mm,
    /// Positions at which X, Y and Z park at the end of a program.
    pub home: [Option<Mm>; 3],
    /// Point that the lengths in the tool table of the control refer to.
    pub length_to: LengthTo,
    /// Spindle range.
    pub spindle: [Rpm; 2],
    /// Power of the spindle at the cutter, kW; `None` where the file does not state it.
    pub power: Option<f64>,
    /// Speed of rapid moves.
    pub rapid: MmPerMin,
    /// Time between two positions that the control gives to its drives, s.
    pub cycle: f64,
    /// How the control plans speeds.
    pub planning: Planning,
    /// Table; its top is given in the machine frame, with the rotary axes at zero, along the axis of the part.
    pub table: Option<CarriedSpec>,
    /// Fixture; its top is given in the part frame.
    pub fixture: Option<CarriedSpec>,
    /// M words of the machine builder that change nothing that is checked.
    pub own_words: Vec<String>,
    /// Entries that the file marks as assumed.
    pub assumed: Vec<String>,
}

/// A solid of revolution about the axis of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct CarriedSpec {
    /// Height of its top.
    pub top: Mm,
    /// Sections from the top downward: length, upper and lower diameter.
    pub sections: Vec<[Mm; 3]>,
}

/// A linear axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearSpec {
    /// Travel.
    pub travel: [Mm; 2],
    /// Largest speed.
    pub speed: MmPerMin,
    /// Largest acceleration, mm/s2.
    pub acceleration: f64,
    /// Largest jerk, mm/s3; infinite where the control has no limit.
    pub jerk: f64,
}

/// A rotary axis in the sense of its word.
#[derive(Clone, Debug, PartialEq)]
pub struct RotarySpec {
    /// Letter.
    pub name: String,
    /// Direction in the machine frame, of length 1.
    pub direction: [f64; 3],
    /// Travel; infinite for an axis modulo 360 deg.
    pub travel: [Rad; 2],
    /// Way of the control to an angle of an axis modulo 360 deg.
    pub modulo: Option<ModuloWay>,
    /// Words that clamp and unclamp it.
    pub clamp: Option<[String; 2]>,
    /// Largest speed, rad/s.
    pub speed: f64,
    /// Largest acceleration, rad/s2.
    pub acceleration: f64,
    /// Largest jerk, rad/s3; infinite where the control has no limit.
    pub jerk: f64,
    /// True when a positive word turns in the ISO sense.
    pub iso: bool,
    /// A point of the axis in the machine frame.
    pub point: [Mm; 3],
}

/// The part.
#[derive(Clone, Debug)]
pub struct PartSpec {
    /// Name.
    pub name: String,
    /// Number of vanes, with its place.
    pub vanes: Spanned<u32>,
    /// The main blade, then the splitters.
    pub blades: Vec<BladeSpec>,
    /// Largest distance by which faces are extended to hub and shroud.
    pub extend: Mm,
    /// Files that the part was imported from.
    pub imported: Option<ImportedFrom>,
    /// Curve that generates the hub.
    pub hub: RevolvedSpec,
    /// Curve that generates the shroud.
    pub shroud: RevolvedSpec,
    /// Whole item.
    pub span: Span,
}

impl PartSpec {
    /// The main blade.
    pub fn main(&self) -> &BladeSpec {
        &self.blades[0]
    }
}

/// A blade: the main one, or a splitter.
#[derive(Clone, Debug)]
pub struct BladeSpec {
    /// Name.
    pub name: String,
    /// What gives its faces.
    pub form: BladeForm,
    /// Fillet; `None` is a sharp root.
    pub fillet: Option<Fillet>,
    /// Turn about Z from its curves to its position.
    pub angle: Rad,
    /// Place of its name in the text.
    pub span: Span,
}

impl BladeSpec {
    /// Its two faces, the pressure face first, where the job gives them one by one.
    pub fn faces(&self) -> Option<&[FaceSpec; 2]> {
        match &self.form {
            BladeForm::Faces(faces) => Some(faces),
            BladeForm::Sections(_) | BladeForm::Angles(_) => None,
        }
    }
}

/// What gives the faces of a blade.
#[derive(Clone, Debug)]
pub enum BladeForm {
    /// Curves of each face, the pressure face first.
    Faces(Box<[FaceSpec; 2]>),
    /// Closed curves round the blade.
    Sections(SectionsSpec),
    /// Angles and thicknesses.
    Angles(AnglesSpec),
}

/// Closed curves round a blade, from hub to shroud.
#[derive(Clone, Debug)]
pub struct SectionsSpec {
    /// At least two.
    pub loops: Vec<LoopSpec>,
    /// The file of all of them as the job names it, where they are from one.
    pub file: Option<String>,
    /// Largest distance of a point to the fitted curve of its section.
    pub fit: Mm,
    /// Forms of the leading and of the trailing edge, where the job states them.
    pub edges: [Option<EdgeForm>; 2],
    /// Sense about Z, seen from +Z, in which the pressure face looks, where the job states it.
    pub pressure: Option<Facing>,
    /// Place in the text.
    pub span: Span,
}

/// A closed curve round a blade; its first point is not repeated.
#[derive(Clone, Debug)]
pub struct LoopSpec {
    /// Name in messages.
    pub name: String,
    /// Points, mm.
    pub points: Vec<[f64; 3]>,
    /// Place of each point.
    pub spans: Vec<Span>,
    /// The points of its edges, where they are stated.
    pub edges: Option<LoopEdges>,
    /// Whole curve.
    pub span: Span,
}

/// A curve that is turned about Z.
#[derive(Clone, Debug)]
pub enum RevolvedSpec {
    /// A curve of the main blade.
    OfBlade(CurveRef),
    /// A curve of its own, from inlet to outlet. Its azimuth does not matter.
    Own(CurveSpec),
}

impl RevolvedSpec {
    /// Place in the text.
    pub fn span(&self) -> Span {
        match self {
            Self::OfBlade(curve) => curve.span,
            Self::Own(curve) => curve.span,
        }
    }
}

base::named! {
    /// How the curves of a face make its surface.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum FaceForm {
        /// Straight lines from root to tip.
        Ruled = "ruled",
        /// A spline through root, sections and tip.
        Lofted = "lofted",
    }
}

/// A face.
#[derive(Clone, Debug)]
pub struct FaceSpec {
    /// Form of its surface.
    pub form: FaceForm,
    /// Curve at the shroud.
    pub tip: CurveSpec,
    /// Curve at the hub.
    pub root: CurveSpec,
    /// Curves between them, from the root to the tip; none in a ruled face.
    pub sections: Vec<CurveSpec>,
}

/// A curve of the main blade, at one end of the rulings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CurveRef {
    /// Face.
    pub face: FaceId,
    /// End of the rulings.
    pub end: RulingEnd,
    /// Place of the reference.
    pub span: Span,
}

/// The blank, a solid of revolution, and what is left of it.
#[derive(Clone, Debug)]
pub struct StockSpec {
    /// Material over the vane tips.
    pub over_shroud: Mm,
    /// Diameter of the bore; zero is none.
    pub bore: Mm,
    /// Height of the back face.
    pub back: Mm,
    /// Clamping.
    pub clamping: ClampingSpec,
    /// What is left of the blank before the first operation; `None` is all of it.
    pub left: Option<StockFile>,
    /// Material; `None` where the job does not state it.
    pub material: Option<Material>,
    /// Whole item.
    pub span: Span,
}

/// A solid from a file.
#[derive(Clone, Debug)]
pub struct StockFile {
    /// Path as the job gives it.
    pub file: String,
    /// Its closed surface, part frame.
    pub mesh: Arc<Mesh>,
    /// Place of the path.
    pub span: Span,
}

/// Space of chuck and table, which no tool may enter.
#[derive(Clone, Copy, Debug)]
pub struct ClampingSpec {
    /// Upper limit of the space; the back face where the job gives none.
    pub below: Mm,
    /// Diameter about Z; `None` means everything below.
    pub diameter: Option<Mm>,
    /// Place in the job; `None` where the job gives none.
    pub span: Option<Span>,
}

/// An operation.
#[derive(Clone, Debug)]
pub struct OperationSpec {
    /// Unique name.
    pub name: String,
    /// Kind, with its own properties.
    pub kind: OperationKind,
    /// Index of its tool.
    pub tool: usize,
    /// Spindle speed.
    pub speed: Rpm,
    /// Feed.
    pub feed: MmPerMin,
    /// Feed of links.
    pub link_feed: MmPerMin,
    /// Length of the lead before the first contact.
    pub lead_in: Mm,
    /// Length of the lead after the last contact.
    pub lead_out: Mm,
    /// Rest machining: the operation cuts where the stock is thicker than this; `None` is off.
    pub rest: Option<Mm>,
    /// Sectors from 0.
    pub sectors: Vec<u32>,
    /// Its item.
    pub span: Span,
}

/// A contract.
#[derive(Clone, Debug, PartialEq)]
pub struct ContractSpec {
    /// Quantity.
    pub kind: ContractKind,
    /// Bound.
    pub bound: Bound,
    /// Where it holds; operations by their index.
    pub scope: Scope<usize>,
    /// True when the job does not state it: it then holds wherever no other contract on the quantity does.
    pub default: bool,
    /// Its item; empty for a default.
    pub span: Span,
}

impl ContractSpec {
    /// Surfaces and operations that it covers, of `count` operations. A quantity that is judged after operations covers
    /// all of them: the named operations only say when it is judged.
    pub fn region(&self, count: usize) -> Region {
        match self.kind.of_operations() {
            OfOperations::Done => Region::of(&self.scope, count),
            OfOperations::After => {
                Region::of(&Scope { operations: Vec::new(), surfaces: self.scope.surfaces.clone() }, count)
            }
        }
    }
}

/// Surfaces and operations that the job takes out of the contracts of a quantity.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AllowedSpec {
    /// Quantity.
    pub kind: ContractKind,
    /// Where; everywhere only in place of a default contract.
    pub scope: Scope<usize>,
    /// Why, in the words of the job.
    pub reason: String,
    /// Its item.
    pub span: Span,
}
