//! What a part is written from.

use super::job_frame::Zero;
use super::left_out::{self, LeftOut};
use super::repeated::ONE_POINT;
use super::tip_meridian::TipMeridian;
use super::wheel_ends::{self, CutMeridian};
use super::{BladeSurfaces, Imported, ImportedRow};
use base::units::{length, trim};
use blade::outline::DividedSection;
use diagnostics::{Diag, codes::import as codes};

/// Most files that are named one by one.
const MAX_NAMED_FILES: usize = 4;

/// Largest distance of a part from its files where none is stated, mm: that of a tolerance of form, and less than any allowance
/// of finishing.
pub const WITHIN: f64 = 0.02;

/// What is written.
#[derive(Clone, Debug)]
pub struct PartSource<'a> {
    /// All that was read.
    pub(super) imported: &'a Imported,
    /// The row whose blades are written.
    pub(super) row: &'a ImportedRow,
    /// Sections of each blade of the row, divided.
    pub(super) divided: &'a [Vec<DividedSection>],
    /// Names of the files that were read.
    read: &'a [String],
    /// Name of the part and of its files, without an ending.
    pub(super) name: &'a str,
    /// Zero of the part.
    pub(super) zero: Zero,
    /// Hub and shroud of the wheel, where all blades have closed sections.
    pub(super) ends: Option<[CutMeridian; 2]>,
    /// A meridian through the tips, for a shroud that is the casing; `None` where the part is not written by its sections.
    pub(super) tips: Option<TipMeridian>,
    /// What faces leave out that are ruled from the first to the last section.
    pub(super) left: Vec<LeftOut>,
}

impl<'a> PartSource<'a> {
    /// What is written of a row with its divided sections. `read` has the names of the files, `name` is that of the part.
    pub fn new(
        imported: &'a Imported,
        row: &'a ImportedRow,
        divided: &'a [Vec<DividedSection>],
        read: &'a [String],
        name: &'a str,
        zero: Zero,
    ) -> Self {
        let ends = wheel_ends::wheel(imported, row, divided);
        let by_sections = matches!(imported.surfaces, BladeSurfaces::BySections);
        let by_points = by_sections && row.blades.iter().all(|blade| blade.angles.is_none());
        let shroud = ends.as_ref().filter(|_| by_points).map(|[_, shroud]| shroud.points.as_slice());
        let tips = shroud.and_then(|shroud| TipMeridian::of(shroud, divided));
        let ruled = ends.is_none() && by_sections;
        let left = if ruled { left_out::all(imported, divided) } else { Vec::new() };
        Self { imported, row, divided, read, name, zero, ends, tips, left }
    }

    /// Refuses a part that lies too far from its files, whatever the reason.
    ///
    /// # Errors
    /// A point of the files lies farther from the part than `limit`, mm.
    pub fn lies_within(&self, limit: f64) -> Result<(), Diag> {
        left_out::check(&self.left, self.row, limit)?;
        let within = self.within();
        if within <= limit {
            return Ok(());
        }
        let text = format!("points of the files would lie up to {} beside the part", length(within));
        // Two digits, rounded up: what is stated must be enough.
        let enough = (within * 1e2).ceil() / 1e2;
        Err(Diag::error(codes::LEFT_OUT, text).note(format!("the limit is {}", length(limit))).help(format!(
            "export the file with a finer tolerance, or state `--within {}mm` where this is near enough: part and certificate then \
             state the distance",
            trim(enough, 2)
        )))
    }

    /// Names of the files.
    pub(super) fn files(&self) -> String {
        match self.read {
            [first, .., last] if self.read.len() > MAX_NAMED_FILES => {
                format!("{} files, {first} to {last}", self.read.len())
            }
            read => read.join(", "),
        }
    }

    /// Largest distance between points of the files and what is written, mm. Points nearer to each other than one point are one, and
    /// coordinates have so many digits that they move less.
    fn within(&self) -> f64 {
        let left = self.left.iter().map(|left| left.distance);
        let cut = self.ends.iter().flatten().map(|end| end.moved);
        left.chain(cut).chain([self.imported.moved]).fold(ONE_POINT, f64::max)
    }

    /// The line of the part that names its files and the largest distance from them, rounded up.
    pub(super) fn imported_from(&self) -> String {
        /// Digits of a length in mm, and of one in um.
        const LENGTH_DIGITS: [(f64, i32, &str); 2] = [(1.0, 3, "mm"), (1e3, 2, "um")];
        let within = self.within();
        let (scale, digits, unit) = LENGTH_DIGITS[usize::from(within < 1.0)];
        let steps = 10.0_f64.powi(digits);
        // A hundredth of a step is what numbers round.
        let up = (within * scale * steps - 0.01).ceil() / steps;
        let digits = usize::try_from(digits).unwrap_or_default();
        // A text of the language holds no quotation mark.
        format!("  imported \"{}\", within {} {unit}\n", self.files().replace('"', "'"), trim(up, digits))
    }
}

/// Name of a blade in the job.
pub(super) fn blade_name(k: usize) -> String {
    if k == 0 { "main".to_owned() } else { format!("splitter_{k}") }
}
