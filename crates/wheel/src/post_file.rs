//! Content of a post file: the dialect of a control, its number formats, and the frames of a program as templates.
//!
//! A *frame* holds the lines of a program that are no moves: head, start and end of an operation, end of the program. A shop
//! edits frames in a file of its own; the reader of the dialect judges what they make, like any other text.

use crate::control::Control;
use base::source::Span;
use serde::{Deserialize, Serialize};

/// What a post file says, with the properties of the `post` item of a job over it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PostFile {
    /// Name of the file, without its folder and ending.
    pub name: String,
    /// Where the job names it; `None` when the command line names it.
    #[serde(deserialize_with = "Deserialize::deserialize")]
    pub span: Option<Span>,
    /// Name of the dialect.
    pub dialect: String,
    /// Its place in the post file.
    pub dialect_span: Span,
    /// Ends of lines.
    pub line_end: LineEnd,
    /// Step of the block numbers; 0 for blocks without numbers.
    pub block_numbers: u32,
    /// Number of the program, for controls that call programs by number.
    pub program_number: u32,
    /// What the control takes.
    pub control: Control,
    /// The work offset that holds the part origin, as the control names it, with its place; `None` for the usual one of the
    /// dialect.
    #[serde(deserialize_with = "Deserialize::deserialize")]
    pub offset: Option<(String, Span)>,
    /// Where the file names the spline blocks of the control.
    #[serde(deserialize_with = "Deserialize::deserialize")]
    pub splines_span: Option<Span>,
    /// Words that smooth within a tolerance in finishing and in roughing, and words that end smoothing.
    pub smoothing: [Template; 3],
    /// Words that switch tool centre point control on, for rotary words and for vectors.
    pub transformation: [Template; 2],
    /// The frames, in the order of [`Frame::ALL`].
    pub frames: [Vec<Template>; 5],
    /// Place of the frame `end` in the file, for what is missing in it.
    pub end_span: Span,
}

base::named! {
    /// Ends of lines in NC text.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum LineEnd {
        /// Line feed.
        Lf = "lf",
        /// Carriage return and line feed.
        CrLf = "crlf",
    }
}

impl LineEnd {
    /// The characters.
    pub fn text(self) -> &'static str {
        match self {
            Self::Lf => "\n",
            Self::CrLf => "\r\n",
        }
    }
}

impl PostFile {
    /// Name of the work offset that holds the part origin, where file or job state it.
    pub fn work_offset(&self) -> Option<&str> {
        self.offset.as_ref().map(|(name, _)| name.as_str())
    }
}

base::named! {
    /// A part of the program that templates make.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Frame {
        /// Before the comments of the head.
        Start = "start",
        /// Behind these comments.
        Head = "head",
        /// Before the moves of an operation: retract, tool, spindle, positions of the axes, transformation.
        OperationStart = "operation-start",
        /// Behind the moves of an operation.
        OperationEnd = "operation-end",
        /// End of the program.
        End = "end",
    }
}

impl Frame {
    /// The fields that a template of this frame may name.
    pub fn fields(self) -> impl Iterator<Item = Field> {
        Field::ALL.into_iter().filter(move |field| field.scope().contains(&self))
    }
}

/// One line of a frame.
#[derive(Clone, Debug, PartialEq, Default, Serialize, Deserialize)]
#[serde(try_from = "StoredTemplate", into = "StoredTemplate")]
pub struct Template {
    /// Texts and fields.
    pub pieces: Vec<Piece>,
    /// The line in the post file.
    pub span: Span,
}

/// A template as the post file has it.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredTemplate {
    text: String,
    span: Span,
}

impl From<Template> for StoredTemplate {
    fn from(template: Template) -> Self {
        Self { text: template.text(), span: template.span }
    }
}

impl TryFrom<StoredTemplate> for Template {
    type Error = String;

    fn try_from(StoredTemplate { text, span }: StoredTemplate) -> Result<Self, String> {
        Self::new(&text, span).map_err(|fault| match fault {
            TemplateFault::Open => format!("a bracket of the template `{text}` is not closed"),
            TemplateFault::Unknown(name) => format!("a template has no field `{name}`"),
            TemplateFault::Character(c) => format!("NC text cannot carry the character {c:?} of a template"),
        })
    }
}

/// A piece of a template.
#[derive(Clone, Debug, PartialEq)]
pub enum Piece {
    /// Text as it stands.
    Text(String),
    /// A value that the program fills in.
    Field(Field),
}

/// Why a text is no template.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TemplateFault {
    /// A bracket that is not closed.
    Open,
    /// A field with this name does not exist.
    Unknown(String),
    /// A character that NC text cannot carry.
    Character(char),
}

impl Template {
    /// A template from its text, with fields in curly brackets, such as `S{spindle} M3`.
    ///
    /// # Errors
    /// The first fault.
    pub fn new(text: &str, span: Span) -> Result<Self, TemplateFault> {
        if let Some(c) = text.chars().find(|c| !c.is_ascii() || c.is_ascii_control()) {
            return Err(TemplateFault::Character(c));
        }
        let mut pieces = Vec::new();
        let mut rest = text;
        while let Some(open) = rest.find('{') {
            let (before, inside) = rest.split_at(open);
            let (name, behind) = inside[1..].split_once('}').ok_or(TemplateFault::Open)?;
            let field = Field::ALL.into_iter().find(|f| f.name() == name);
            if !before.is_empty() {
                pieces.push(Piece::Text(before.to_owned()));
            }
            pieces.push(Piece::Field(field.ok_or_else(|| TemplateFault::Unknown(name.to_owned()))?));
            rest = behind;
        }
        if !rest.is_empty() {
            pieces.push(Piece::Text(rest.to_owned()));
        }
        Ok(Self { pieces, span })
    }

    /// The fields in their order.
    pub fn fields(&self) -> impl Iterator<Item = Field> {
        self.pieces.iter().filter_map(|piece| if let Piece::Field(field) = piece { Some(*field) } else { None })
    }

    /// The text with every field replaced.
    pub fn filled(&self, mut value: impl FnMut(Field) -> String) -> String {
        self.pieces
            .iter()
            .map(|piece| match piece {
                Piece::Text(text) => text.clone(),
                Piece::Field(field) => value(*field),
            })
            .collect()
    }

    /// The text as the post file has it.
    pub fn text(&self) -> String {
        self.filled(|field| format!("{{{}}}", field.name()))
    }
}

base::named! {
    /// A value that a template can name.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Field {
        /// Name of the part.
        ProgramName = "program.name",
        /// The same in capitals, with `_` in the place of `-`: a file name of the control.
        ProgramFile = "program.file",
        /// Number of the program, four digits.
        ProgramNumber = "program.number",
        /// The work offset of the part.
        WorkOffset = "work-offset",
        /// Its number in G10 L2 of LinuxCNC.
        WorkOffsetNumber = "work-offset.number",
        /// Machine Z of the gauge line at the retract height.
        Retract = "retract",
        /// Words that end smoothing.
        SmoothingOff = "smoothing-off",
        /// Name of the operation.
        OperationName = "operation.name",
        /// Name of the tool.
        ToolName = "tool.name",
        /// Number of the tool.
        ToolNumber = "tool.number",
        /// Length of the tool from the tip to the gauge line.
        ToolLength = "tool.length",
        /// Spindle speed, rpm.
        Spindle = "spindle",
        /// Words that smooth within the tolerances of the operation.
        Smoothing = "smoothing",
        /// Path tolerance of the operation.
        Tolerance = "tolerance",
        /// Path tolerance in finishing, the finest of all operations.
        FinishTolerance = "finish-tolerance",
        /// Orientation tolerance of the operation, degrees.
        OrientationTolerance = "orientation-tolerance",
        /// Words of both rotary axes where tool centre point control is switched on: at the first target, or on controls that
        /// fix the work frame to the table there, with the tables at zero.
        Rotary = "rotary",
        /// Words of both rotary axes at zero.
        RotaryZero = "rotary-zero",
        /// Machine X over the first target.
        X = "x",
        /// Machine Y over the first target.
        Y = "y",
        /// Machine Z of the gauge line after the operation.
        Z = "z",
        /// Words that switch tool centre point control on.
        Transformation = "transformation",
        /// Tip of the tool at the first station, part frame: three numbers with commas.
        StartTip = "start-tip",
        /// Vector from the tip to the holder there.
        StartAxis = "start-axis",
        /// Tip of the tool at the last station.
        EndTip = "end-tip",
        /// Vector from the tip to the holder there.
        EndAxis = "end-axis",
        /// The APT statement of the cutter; no text for a cutter that its seven numbers cannot describe.
        Cutter = "cutter",
        /// Word that unclamps rotary axis 1; no text for an axis without a clamp.
        Unclamp1 = "unclamp.1",
        /// The same for rotary axis 2.
        Unclamp2 = "unclamp.2",
        /// Word that clamps rotary axis 1.
        Clamp1 = "clamp.1",
        /// The same for rotary axis 2.
        Clamp2 = "clamp.2",
        /// Machine X where the machine parks; a line is left out where the machine file does not say it.
        HomeX = "home.x",
        /// Machine Y where the machine parks.
        HomeY = "home.y",
        /// Machine Z of the gauge line where the machine parks: the retract height where the machine file does not say it.
        HomeZ = "home.z",
    }
}

impl Field {
    /// The frames in which the value exists.
    fn scope(self) -> &'static [Frame] {
        use Frame::{End, Head, OperationEnd, OperationStart, Start};
        match self {
            Self::ProgramName
            | Self::ProgramFile
            | Self::ProgramNumber
            | Self::WorkOffset
            | Self::WorkOffsetNumber
            | Self::Retract
            | Self::RotaryZero
            | Self::Unclamp1
            | Self::Unclamp2
            | Self::Clamp1
            | Self::Clamp2
            | Self::SmoothingOff => &[Start, Head, OperationStart, OperationEnd, End],
            // In a head: the finest of all operations.
            Self::Smoothing => &[Head, OperationStart],
            Self::OperationName | Self::ToolName | Self::ToolNumber | Self::ToolLength => {
                &[OperationStart, OperationEnd]
            }
            Self::FinishTolerance => &[Head, OperationStart],
            Self::Spindle | Self::Tolerance | Self::OrientationTolerance => &[OperationStart],
            Self::Rotary
            | Self::X
            | Self::Y
            | Self::Transformation
            | Self::StartTip
            | Self::StartAxis
            | Self::Cutter => &[OperationStart],
            Self::Z | Self::EndTip | Self::EndAxis => &[OperationEnd],
            Self::HomeX | Self::HomeY | Self::HomeZ => &[End],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_template_keeps_its_text() {
        let text = "T=\"{tool.name}\" M6 ; {operation.name}";
        let template = Template::new(text, Span::default()).unwrap();
        assert_eq!(template.text(), text);
        assert_eq!(template.fields().collect::<Vec<_>>(), [Field::ToolName, Field::OperationName]);
        assert_eq!(template.filled(|f| f.name().len().to_string()), "T=\"9\" M6 ; 14");
        assert_eq!(Template::new("{tool.nme}", Span::default()), Err(TemplateFault::Unknown("tool.nme".to_owned())));
        assert_eq!(Template::new("S{spindle", Span::default()), Err(TemplateFault::Open));
        assert_eq!(Template::new("M8 \u{e4}", Span::default()), Err(TemplateFault::Character('\u{e4}')));
    }

    #[test]
    fn every_field_has_a_name_of_its_own_and_a_place() {
        for (i, field) in Field::ALL.into_iter().enumerate() {
            assert_eq!(Field::ALL.iter().position(|f| f.name() == field.name()), Some(i));
            assert!(Frame::ALL.iter().any(|frame| frame.fields().any(|f| f == field)));
        }
    }
}
