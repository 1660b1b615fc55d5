//! Readers of blade files, one file a format: text to hub, shroud and sections of blades.
//!
//! All readers make one value, [`Imported`]: lengths in mm, the frame right handed, Z the axis of rotation. A fact that a
//! file may leave out, such as its unit, is taken from [`Options`]; where neither states it, an error names the option.
//! What a reader finds or takes for granted is a [`Note`] with its line.
//!
//! The readers touch no disk: [`read`] gets files by a function of the caller, and refuses more than [`limits`] allow.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking"))]

mod angle_part;
pub mod angles;
mod bladegen;
mod check;
mod closed_faces;
pub mod edge_tags;
mod face_choice;
pub mod faced_part;
mod found;
mod frame;
mod geomturbo;
pub mod header_unit;
mod ibl;
pub mod job_frame;
mod left_out;
pub mod limits;
mod lines;
mod loader;
mod loops;
mod meridian;
mod nested;
pub mod outlines;
pub mod part_source;
pub mod part_text;
mod repeated;
mod rtzt;
mod short_ends;
mod stated;
mod step;
mod table;
mod tip_meridian;
mod turbogrid;
mod wheel_ends;

pub use check::LEAST_SIZE;
pub use face_choice::{BladeFace, FaceChoice, FaceRole};
pub use frame::{Axis, Handedness, LengthUnit};
pub use loader::{Fetch, NoFile};

use base::source::{SourceId, SourceMap, Span};
use blade::outline::Side;
use blade::{EdgeForm, Section, ThicknessDirection};
use diagnostics::codes::import as codes;
use diagnostics::{Diag, printable};
use found::Found;
use loader::Loader;

/// What a blade file holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Imported {
    /// Name of the format.
    pub format: &'static str,
    /// Points (r, z) of the hub from inlet to outlet, mm; `None` where the files have no hub.
    pub hub: Option<Vec<[f64; 2]>>,
    /// Points (r, z) of the shroud from inlet to outlet, mm; `None` where the files have no shroud.
    pub shroud: Option<Vec<[f64; 2]>>,
    /// Rows of blades in the order of the file.
    pub rows: Vec<ImportedRow>,
    /// What the reader found or took for granted.
    pub notes: Vec<Note>,
    /// What the file holds, line by line, where it does not say which blades there are.
    pub listing: Vec<String>,
    /// What surfaces the part has through the sections.
    pub surfaces: BladeSurfaces,
    /// Largest distance between the files and what was read, mm, where the reader does not keep their points.
    pub moved: f64,
}

/// Surfaces of a part through the sections of its blades.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum BladeSurfaces {
    /// Those that the forms of the sections demand: faces and edges of closed loops, or ruled faces from the first to the last.
    #[default]
    BySections,
    /// Ruled faces from the first to the last section, with edges that the lathe makes. Hub and shroud end with the blades.
    Ruled {
        /// Largest distance from the ends of the faces to hub and shroud, mm.
        extend: f64,
    },
    /// Lofted faces through all sections, otherwise as ruled ones.
    Lofted {
        /// Largest distance from the ends of the faces to hub and shroud, mm.
        extend: f64,
    },
    /// Faces and edges of closed loops, between hub and shroud as they are given.
    Loops {
        /// Largest distance from the ends of the faces to hub and shroud, mm.
        extend: f64,
        /// Largest distance of points from the curve of their section, mm.
        fit: f64,
    },
}

/// A row of blades.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportedRow {
    /// Name in the file; empty where it has none.
    pub name: String,
    /// Number of main blades round the axis, which is that of each splitter too.
    pub count: u32,
    /// The main blade, then the splitters.
    pub blades: Vec<ImportedBlade>,
}

/// A blade of a row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImportedBlade {
    /// Name in the file, or `main` and `splitter`.
    pub name: String,
    /// Sections from hub to shroud.
    pub sections: Vec<Section>,
    /// Place of each section in the files.
    pub places: Vec<Span>,
    /// Forms of the leading and of the trailing edge, where the file states them.
    pub edges: [Option<EdgeForm>; 2],
    /// Points that the file tells to be of an edge.
    pub tags: Vec<edge_tags::EdgeTag>,
    /// Side of the pressure face, where the file states it and the forms of the sections do not.
    pub pressure: Option<Side>,
    /// Radius of the fillet at the hub, mm, where the file states it.
    pub fillet: Option<f64>,
    /// Gap at the tip at the leading and at the trailing edge, mm, where the file states it.
    pub tip_gap: Option<[f64; 2]>,
    /// Angle from the main blade to this blade as a share of the pitch, where the file states it and the sections do not
    /// hold it.
    pub pitch_share: Option<f64>,
    /// Angles and thicknesses, where the file states the blade by them. The sections are made of them.
    pub angles: Option<angles::StatedAngles>,
}

/// What a reader found or took for granted.
#[derive(Clone, Debug, PartialEq)]
pub struct Note {
    /// One sentence.
    pub text: String,
    /// Its place; `None` for an option of the caller.
    pub span: Option<Span>,
}

/// End of the blade at which the points of a loop begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// At the leading edge.
    LeadingEdge,
    /// At the trailing edge.
    TrailingEdge,
}

/// What the caller states of the files.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// Name of the format, for a file whose ending does not tell it.
    pub format: Option<String>,
    /// Unit of length.
    pub unit: Option<LengthUnit>,
    /// Axis of rotation.
    pub axis: Option<Axis>,
    /// Handedness of the frame of the file.
    pub handedness: Option<Handedness>,
    /// Number of main blades.
    pub blades: Option<u32>,
    /// Meaning of the columns of a table, from left to right.
    pub columns: Option<Vec<String>>,
    /// Direction in which thicknesses are measured.
    pub thickness: Option<ThicknessDirection>,
    /// Edge at which loops begin, where there is no hub. Of the faces of a STEP file, the edge at the lower end of the blade along the
    /// axis of rotation.
    pub start: Option<Start>,
    /// Side of the pressure face; without it that of a blade that takes up work, see [`blade::outline`].
    pub side: Option<Side>,
    /// Faces of a STEP file by their roles.
    pub faces: Vec<FaceChoice>,
    /// Radius of the fillets at the feet of the blades, mm, which files of sections do not state.
    pub fillet: Option<f64>,
}

/// A reader of a format.
struct Reader {
    /// Name of the format.
    name: &'static str,
    /// Endings of the names of its files, in lower case.
    endings: &'static [&'static str],
    /// Whether several files are read together. Otherwise one is given, and it names the others.
    several: bool,
    /// Most text of all files together, bytes.
    bytes: usize,
    read: fn(&[SourceId], &mut Loader<'_>, &Options, &mut Found) -> Result<Imported, Diag>,
}

/// Word of the option that states the side of the pressure face.
pub const SIDE_OPTION: &str = "pressure";

/// All formats.
const READERS: &[Reader] = &[
    Reader { name: "turbogrid", endings: &["inf"], several: false, bytes: limits::BYTES, read: turbogrid::read },
    Reader { name: "geomturbo", endings: &["geomturbo"], several: false, bytes: limits::BYTES, read: geomturbo::read },
    Reader { name: "ibl", endings: &["ibl"], several: false, bytes: limits::BYTES, read: ibl::read },
    Reader { name: "rtzt", endings: &["rtzt"], several: false, bytes: limits::BYTES, read: rtzt::read },
    Reader { name: "bgi", endings: &["bgi"], several: false, bytes: limits::BYTES, read: bladegen::read },
    Reader {
        name: "step",
        endings: &["step", "stp", "p21"],
        several: false,
        bytes: limits::STEP_BYTES,
        read: step::read,
    },
    Reader { name: "table", endings: &["csv", "txt", "dat"], several: true, bytes: limits::BYTES, read: table::read },
];

/// Endings of files that are not read, and what to give in their place.
const OTHER_ENDINGS: &[(&[&str], &str)] = &[
    (
        &["curve", "crv"],
        "give the `.inf` file of the set alone: it names the files of hub, shroud and profile; a profile of points in columns is read \
         with `--format table`",
    ),
    (
        &["igs", "iges", "x_t", "x_b", "sat", "sldprt", "prt", "catpart", "ipt", "3dm", "f3d", "par"],
        "export the part from your CAD system as a STEP file, and give this",
    ),
    (
        &["stl", "3mf", "obj", "ply"],
        "triangles have no faces of a blade: export the part from your CAD system as a STEP file, or its sections as points",
    ),
    (&["xls", "xlsx", "ods"], "save the sheet as CSV, and give this"),
    (
        &["cfdb", "cft-batch", "cft", "bgd"],
        "export the blades from the program, such as `.inf` with its curve files, `.bgi` or `.geomTurbo`",
    ),
];

/// Names of the formats with the endings of their files.
pub fn formats() -> impl Iterator<Item = (&'static str, &'static [&'static str])> {
    READERS.iter().map(|reader| (reader.name, reader.endings))
}

/// Reads blade files. `names` are given to `fetch`, which answers for the files that these name as well. The texts go to
/// `sources`.
///
/// # Errors
/// A file that cannot be read, is not of its format, is cut off or too large; a fact that neither the files nor the options
/// state, or that both state and not alike.
pub fn read(
    names: &[String],
    fetch: &mut Fetch<'_>,
    options: &Options,
    sources: &mut SourceMap,
) -> Result<Imported, Vec<Diag>> {
    let reader = reader(names, options).map_err(|diag| vec![diag])?;
    let mut loader = Loader::new(fetch, reader.bytes, sources);
    let mut found = Found::default();
    let loaded: Result<Vec<SourceId>, Diag> = names.iter().map(|name| loader.load(name, None)).collect();
    let made = loaded.and_then(|ids| {
        let mut imported = (reader.read)(&ids, &mut loader, options, &mut found)?;
        let at = ids.first().map_or(Span::default(), |id| loader.text(*id).end());
        check::size(&imported, options, at)?;
        check::order(&imported, at)?;
        repeated::leave_out(&mut imported, &mut found);
        Ok(imported)
    });
    match made {
        Ok(imported) => Ok(Imported { format: reader.name, moved: found.moved, notes: found.notes, ..imported }),
        Err(first) => Err(std::iter::once(first).chain(found.faults).collect()),
    }
}

/// Ending of a name in lower case.
fn ending(name: &str) -> String {
    let file = name.rsplit(['/', '\\']).next().unwrap_or(name);
    file.rsplit_once('.').map(|(_, ending)| ending.to_ascii_lowercase()).unwrap_or_default()
}

/// The reader of the option, or that of the endings of the names.
fn reader(names: &[String], options: &Options) -> Result<&'static Reader, Diag> {
    let known = || READERS.iter().map(|r| r.name).collect::<Vec<_>>().join(", ");
    let endings = || READERS.iter().flat_map(|r| r.endings).map(|e| format!(".{e}")).collect::<Vec<_>>().join(", ");
    let found = match &options.format {
        Some(name) => READERS.iter().find(|r| r.name == name).ok_or_else(|| {
            Diag::error(codes::UNKNOWN_FORMAT, format!("there is no format `{}`", printable(name)))
                .help(format!("give `--format` one of {}", known()))
        })?,
        None => {
            let mut readers = names.iter().map(|name| {
                READERS.iter().find(|r| r.endings.contains(&ending(name).as_str())).ok_or_else(|| {
                    Diag::error(codes::UNKNOWN_FORMAT, format!("the ending of `{}` tells no format", printable(name)))
                        .help(match OTHER_ENDINGS.iter().find(|(others, _)| others.contains(&ending(name).as_str())) {
                            Some((_, help)) => (*help).to_owned(),
                            None => format!("the endings are {}; or state `--format` ({})", endings(), known()),
                        })
                })
            });
            let first = readers.next().unwrap_or_else(|| {
                Err(Diag::error(codes::UNKNOWN_FORMAT, "no blade file is given").help("name at least one file"))
            })?;
            for other in readers {
                if other?.name != first.name {
                    return Err(Diag::error(codes::UNKNOWN_FORMAT, "the files are of different formats")
                        .help("give files of one format; a file that names others is given alone"));
                }
            }
            first
        }
    };
    if names.len() > 1 && !found.several {
        return Err(Diag::error(codes::UNKNOWN_FORMAT, format!("{} files of the format {}", names.len(), found.name))
            .help("give the one file that holds the blade, or that names the other files"));
    }
    Ok(found)
}
