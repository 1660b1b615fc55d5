//! Syntax tree: the written text with places, without meaning.

use base::source::Span;

/// A word of the job with its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Name {
    /// The word.
    pub text: String,
    /// Its place.
    pub span: Span,
}

/// A quoted text with its place; the place includes the quotes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Text {
    /// The text between the quotes.
    pub text: String,
    /// Its place.
    pub span: Span,
}

/// A job file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct File {
    /// Items in the order of the text.
    pub items: Vec<Item>,
    /// Comments in the order of the text, from `//` to the end of the line, without trailing blanks.
    pub comments: Vec<Span>,
    /// True when an item could not be read; a missing item may then be this one.
    pub damaged: bool,
    /// True when the text has any fault: then no job is made of it, though all items may be there.
    pub faulty: bool,
}

/// One item with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// What it is.
    pub kind: ItemKind,
    /// Whole item.
    pub span: Span,
}

/// Items of the language.
#[derive(Clone, Debug, PartialEq)]
pub enum ItemKind {
    /// `edition 2026`
    Edition(Name),
    /// `use machine "5mc850-c"`
    Use {
        /// `machine` or `tools`.
        kind: Name,
        /// Name in the library.
        what: Text,
    },
    /// `let blade = 3 mm`
    Let {
        /// New name.
        name: Name,
        /// Its value.
        value: Expr,
    },
    /// `part NAME { }`
    Part {
        /// Name of the part.
        name: Name,
        /// Its entries.
        body: Block,
    },
    /// `stock turned { }`
    Stock {
        /// Kind of the blank.
        kind: Name,
        /// Its entries.
        body: Block,
    },
    /// `tool t1 = ball { }` or `tool t1 = "ball-6"`
    Tool {
        /// New name.
        name: Name,
        /// Source of its shape.
        source: ToolSource,
    },
    /// `operation groove NAME { }`
    Operation {
        /// Kind.
        kind: Name,
        /// Its own name, where given.
        name: Option<Name>,
        /// Its entries.
        body: Block,
    },
    /// `operations auto`: the compiler chooses what is missing.
    Operations(Name),
    /// `tolerance chord 1 um, rough 10 um`
    Tolerance(Vec<Value>),
    /// `require gouge <= 7 um`
    Require {
        /// Quantity.
        what: Name,
        /// Part of the tool, after `clearance`.
        body: Option<Name>,
        /// `<=` or `>=`, as written.
        relation: Name,
        /// Bound.
        bound: Expr,
        /// Cuts to which it does not apply: the word after `outside of`.
        outside: Option<Name>,
        /// Where it holds; empty means everywhere.
        scope: Vec<ScopeTarget>,
    },
    /// `allow excess on fillet "ground by hand"`
    Allow {
        /// Quantity.
        what: Name,
        /// Part of the tool, after `clearance`.
        body: Option<Name>,
        /// Where.
        scope: Vec<ScopeTarget>,
        /// Why.
        reason: Text,
    },
    /// `post siemens-840d`
    Post {
        /// Dialect.
        name: Name,
        /// Options, where given.
        body: Option<Block>,
    },
}

/// The word of a value that the compiler chooses.
pub const AUTO: &str = "auto";

/// Properties of an operation whose value may be [`AUTO`].
pub const OPEN_PROPERTIES: [&str; 12] = [
    "tool",
    "tools",
    "speed",
    "feed",
    "link-feed",
    "depth",
    "stepover",
    "allowance",
    "scallop",
    "method",
    "lead-in",
    "lead-out",
];

impl File {
    /// True for a job that leaves something for the compiler to choose.
    pub fn is_open(&self) -> bool {
        self.items.iter().any(Item::is_open)
    }
}

impl Item {
    /// True for an item that leaves something for the compiler to choose.
    pub fn is_open(&self) -> bool {
        match &self.kind {
            ItemKind::Operations(_) => true,
            ItemKind::Operation { body, .. } => body.entries.iter().any(Entry::is_open),
            _ => false,
        }
    }
}

impl Entry {
    /// True where the compiler chooses the value.
    pub fn is_open(&self) -> bool {
        OPEN_PROPERTIES.contains(&self.name.text.as_str())
            && matches!(&self.values[..], [Value::Expr(Expr { kind: ExprKind::Path(path), .. })] if path.text() == AUTO)
    }
}

/// A word after `on`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ScopeTarget {
    /// True when `operation` stands before the name.
    pub operation: bool,
    /// Surface or operation.
    pub name: Name,
}

/// Source of the shape of a tool.
#[derive(Clone, Debug, PartialEq)]
pub enum ToolSource {
    /// A tool of the library.
    Library(Text),
    /// Kind and properties.
    Shape(Name, Block),
}

/// Entries between braces.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Entries in order.
    pub entries: Vec<Entry>,
    /// Braces included.
    pub span: Span,
    /// True when an entry could not be read.
    pub damaged: bool,
}

/// `name value, value` or `name word { }`.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// First word.
    pub name: Name,
    /// Values after the name; never empty.
    pub values: Vec<Value>,
    /// Whole entry.
    pub span: Span,
}

/// A value of an entry.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Number, name or arithmetic.
    Expr(Expr),
    /// `vane 0.2 mm`
    Labelled(Name, Expr),
    /// `vane 0.2 mm .. 0.4 mm`
    Range(Name, [Expr; 2]),
    /// `"er16-mini"`
    Text(Text),
    /// `main { }`
    Block(Option<Name>, Block),
    /// `0 % { }`
    Placed(Expr, Block),
    /// `[(0 %, 35 deg) (100 %, 30 deg)]`
    List(Vec<Point>, Span),
    /// `spline [(x, y, z) ...] mm`
    Spline(Spline),
    /// `loop [(x, y, z) ...] mm`
    Loop(Spline),
    /// `loops from "blade.csv" mm`
    Loops {
        /// Path beside the job.
        file: Text,
        /// Unit of all coordinates, where given.
        unit: Option<Name>,
        /// Whole value.
        span: Span,
    },
    /// `revolve main.pressure.root` or `revolve spline [(x, y, z) ...] mm`
    Revolve(Revolved, Span),
}

/// A curve that is turned about Z.
#[derive(Clone, Debug, PartialEq)]
pub enum Revolved {
    /// A curve of the main blade.
    OfBlade(Path),
    /// A curve of its own.
    Own(Spline),
}

impl Value {
    /// Place of the value.
    pub fn span(&self) -> Span {
        match self {
            Self::Expr(e) => e.span,
            Self::Labelled(name, e) | Self::Range(name, [_, e]) => Span { end: e.span.end, ..name.span },
            Self::Text(t) => t.span,
            Self::Block(name, block) => name.as_ref().map_or(block.span, |n| Span { end: block.span.end, ..n.span }),
            Self::Placed(e, block) => Span { end: block.span.end, ..e.span },
            Self::Spline(s) | Self::Loop(s) => s.span,
            Self::Loops { span, .. } | Self::Revolve(_, span) | Self::List(_, span) => *span,
        }
    }
}

/// A curve through points.
#[derive(Clone, Debug, PartialEq)]
pub struct Spline {
    /// Its points.
    pub points: SplinePoints,
    /// Unit of all coordinates, where given.
    pub unit: Option<Name>,
    /// Whole value.
    pub span: Span,
}

/// Place of the points of a curve.
#[derive(Clone, Debug, PartialEq)]
pub enum SplinePoints {
    /// In the job.
    Inline(Vec<Point>),
    /// In a file of comma separated values.
    File {
        /// Path beside the job.
        file: Text,
        /// Curve in the file.
        curve: Name,
    },
}

/// A tuple of coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Coordinates as written; three are correct.
    pub coordinates: Vec<Expr>,
    /// Parentheses included.
    pub span: Span,
}

/// Names joined by dots.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Path {
    /// At least one.
    pub names: Vec<Name>,
    /// Whole path.
    pub span: Span,
}

impl Path {
    /// The path as written.
    pub fn text(&self) -> String {
        self.names.iter().map(|n| n.text.as_str()).collect::<Vec<_>>().join(".")
    }
}

/// Arithmetic with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Expr {
    /// What it is.
    pub kind: ExprKind,
    /// Its place.
    pub span: Span,
}

/// Forms of an expression. Chains are flat, so that a long sum is not a deep tree.
#[derive(Clone, Debug, PartialEq)]
pub enum ExprKind {
    /// A number with the unit written after it.
    Number(f64, Option<Name>),
    /// A name.
    Path(Path),
    /// The negative.
    Negative(Box<Expr>),
    /// Sum and difference, or product and quotient, from left to right.
    Chain(Box<Expr>, Vec<(Operator, Expr)>),
}

/// Operators of a chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operator {
    /// `+`
    Add,
    /// `-`
    Subtract,
    /// `*`
    Multiply,
    /// `/`
    Divide,
}
