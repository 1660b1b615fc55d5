//! Options of `impellerc import`, and of blade files wherever they are read.

use super::ErrorFormat;
use super::quantities::{fillet, within};
use clap::{Args, ValueEnum};
use impellerc::blade::ThicknessDirection;
use impellerc::blade::outline::Side;
use impellerc::blade_files::{self, Axis, FaceChoice, FaceRole, Handedness, LengthUnit, Start, job_frame::Zero};
use impellerc::driver::Import;
use std::path::PathBuf;

/// What the import takes.
#[derive(Args)]
pub(super) struct ImportArguments {
    /// Blade files, or a folder with them: .inf with its curve files, .geomTurbo, .ibl, .rtzt, .bgi, .step, tables of points
    #[arg(required = true)]
    files: Vec<PathBuf>,

    /// Write the part to this file, and tables of its points beside it
    #[arg(short, long, value_name = "FILE.imp")]
    output: Option<PathBuf>,

    /// Replace files that exist
    #[arg(long)]
    force: bool,

    #[command(flatten)]
    of_files: BladeFileArguments,

    /// Format of errors, warnings and remarks
    #[arg(long, value_enum, default_value = "human", value_name = "FORMAT")]
    pub(super) error_format: ErrorFormat,
}

impl ImportArguments {
    /// The options in the form of the driver.
    pub(super) fn options(self) -> Import {
        Import { output: self.output, force: self.force, ..self.of_files.import(self.files) }
    }
}

/// What is stated of blade files.
#[derive(Args)]
pub(super) struct BladeFileArguments {
    /// Format of the files, where their endings do not tell it: turbogrid, geomturbo, ibl, rtzt, bgi, step, table
    #[arg(long, value_name = "NAME")]
    format: Option<String>,

    /// Unit of length of the files: mm, cm, m, in, ft
    #[arg(long, value_name = "UNIT", value_parser = unit)]
    unit: Option<LengthUnit>,

    /// Axis of rotation in the files: x, y, z
    #[arg(long, value_name = "AXIS", value_parser = axis)]
    axis: Option<Axis>,

    /// Handedness of the frame of the files: right, left
    #[arg(long, value_name = "HAND", value_parser = handedness)]
    handedness: Option<Handedness>,

    /// Number of main blades of the whole row
    #[arg(long, value_name = "NUMBER")]
    blades: Option<u32>,

    /// Columns of a table, such as x,rtheta,r
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    columns: Option<Vec<String>>,

    /// Direction in which thicknesses are measured
    #[arg(long, value_enum, value_name = "DIRECTION")]
    thickness: Option<ThicknessArgument>,

    /// Edge at which the points of sections begin, where there is no hub; of a STEP file, the edge at the lower end along the axis
    #[arg(long, value_enum, value_name = "EDGE")]
    start: Option<StartArgument>,

    /// Side of the pressure face by the angle about the axis
    #[arg(long = blade_files::SIDE_OPTION, value_enum, value_name = "SIDE")]
    side: Option<SideArgument>,

    /// Face of a STEP file by its role: hub, shroud, pressure, suction, inlet, outlet, fillet, splitter1-pressure and so on.
    /// ROLE=#NUMBER or ROLE=NAME; several times
    #[arg(long = "face", value_name = "ROLE=FACE", value_parser = face)]
    faces: Vec<FaceChoice>,

    /// Radius of the fillets at the feet of the blades, which files of sections do not state, from 0.05mm to 50mm
    #[arg(long, value_name = "LENGTH", value_parser = fillet)]
    fillet: Option<f64>,

    /// Place on the axis of rotation that becomes zero of the part
    #[arg(long, value_enum, default_value = "file", value_name = "PLACE")]
    zero: ZeroArgument,

    /// Write faces ruled from the first to the last section, however far sections, edges, hub and shroud of the file lie beside
    #[arg(long)]
    ruled: bool,

    /// Largest distance between points of the files and the part
    #[arg(long, default_value = "20um", value_name = "LENGTH", value_parser = within)]
    within: f64,

    /// Row of blades, where the files have several
    #[arg(long, value_name = "NAME")]
    row: Option<String>,
}

impl BladeFileArguments {
    /// True where anything is stated.
    pub(super) fn is_stated(&self) -> bool {
        let Self {
            format,
            unit,
            axis,
            handedness,
            blades,
            columns,
            thickness,
            start,
            side,
            faces,
            fillet,
            zero,
            ruled,
            within: _,
            row,
        } = self;
        [format.is_some(), unit.is_some(), axis.is_some(), handedness.is_some(), blades.is_some(), columns.is_some()]
            .into_iter()
            .chain([
                thickness.is_some(),
                start.is_some(),
                side.is_some(),
                !faces.is_empty(),
                row.is_some(),
                *ruled,
                fillet.is_some(),
            ])
            .any(|stated| stated)
            || matches!(zero, ZeroArgument::Top)
    }

    /// The import of some files, in the form of the driver.
    pub(super) fn import(self, files: Vec<PathBuf>) -> Import {
        let options = blade_files::Options {
            format: self.format,
            unit: self.unit,
            axis: self.axis,
            handedness: self.handedness,
            blades: self.blades,
            columns: self.columns,
            thickness: self.thickness.map(|t| match t {
                ThicknessArgument::Normal => ThicknessDirection::Normal,
                ThicknessArgument::Tangential => ThicknessDirection::Tangential,
            }),
            start: self.start.map(|s| match s {
                StartArgument::Leading => Start::LeadingEdge,
                StartArgument::Trailing => Start::TrailingEdge,
            }),
            side: self.side.map(|s| match s {
                SideArgument::Greater => Side::Greater,
                SideArgument::Smaller => Side::Smaller,
            }),
            faces: self.faces,
            fillet: self.fillet,
        };
        let zero = match self.zero {
            ZeroArgument::File => Zero::File,
            ZeroArgument::Top => Zero::Top,
        };
        Import {
            files,
            output: None,
            row: self.row,
            force: false,
            ruled: self.ruled,
            within: Some(self.within),
            zero,
            options,
        }
    }
}

#[derive(Clone, Copy, ValueEnum)]
enum ZeroArgument {
    /// The origin of the files
    File,
    /// The height of the highest point of blades, hub and shroud
    Top,
}

#[derive(Clone, Copy, ValueEnum)]
enum ThicknessArgument {
    /// Across the mean line
    Normal,
    /// Round the axis
    Tangential,
}

#[derive(Clone, Copy, ValueEnum)]
enum StartArgument {
    /// At the leading edge
    Leading,
    /// At the trailing edge
    Trailing,
}

#[derive(Clone, Copy, ValueEnum)]
enum SideArgument {
    /// At the greater angle
    Greater,
    /// At the smaller angle
    Smaller,
}

/// The face that the command line picks.
fn face(text: &str) -> Result<FaceChoice, String> {
    FaceChoice::parsed(text)
        .ok_or_else(|| format!("write ROLE=#NUMBER or ROLE=NAME; the roles are {}", FaceRole::FORMS))
}

/// The unit of a word of the command line.
fn unit(word: &str) -> Result<LengthUnit, String> {
    LengthUnit::named(word).ok_or_else(|| "the units are mm, cm, m, in and ft".to_owned())
}

/// The axis of a word of the command line.
fn axis(word: &str) -> Result<Axis, String> {
    Axis::named(word).ok_or_else(|| "the axes are x, y and z".to_owned())
}

/// The handedness of a word of the command line.
fn handedness(word: &str) -> Result<Handedness, String> {
    Handedness::named(word).ok_or_else(|| "a frame is right or left".to_owned())
}
