//! The sections of the part as files, and how near a part that is read from them comes to the part.

use ::report::turbogrid::{TurboGridFiles, TurboGridNames};
use base::source::{SourceFile, SourceMap};
use blade::Outline;
use blade::loft::{LoftedBlade, loft};
use blade_files::{Imported, Options as ImportOptions};
use diagnostics::Diag;
use nurbs::proximity::Patch;
use std::path::{Path, PathBuf};
use wheel::part::Part;
use wheel::part::blade_loops::{BladeLoops, blade_loops};

/// Largest distance of a point to the curve of its section, mm, with which the sections are read back.
const FIT_MM: f64 = 1e-3;

/// Of so many points of a loop one is compared.
const COMPARED_EVERY: usize = 5;

/// Paths of the four files beside the `.inf` file, and the names by which it calls them.
pub(super) fn places(index: &Path) -> ([PathBuf; 3], TurboGridNames) {
    let paths = ["hub.curve", "shroud.curve", "profile.curve"].map(|extension| index.with_extension(extension));
    let [hub, shroud, profile] =
        paths.each_ref().map(|path| path.file_name().map_or_else(String::new, |name| name.display().to_string()));
    (paths, TurboGridNames { hub, shroud, profile })
}

/// What the import makes of the files.
///
/// # Errors
/// What the import says of them.
pub(super) fn read_back(files: &TurboGridFiles, names: &TurboGridNames) -> Result<Imported, Diag> {
    let texts = [
        ("sections.inf", &files.index),
        (&names.hub, &files.hub),
        (&names.shroud, &files.shroud),
        (&names.profile, &files.profile),
    ];
    let mut fetch = |name: &str, _: usize| {
        let found = texts.iter().find(|(own, _)| *own == name);
        found
            .map(|(_, text)| SourceFile::text(name, text.as_str()))
            .ok_or_else(|| "there is no such file".to_owned().into())
    };
    let read = blade_files::read(
        &["sections.inf".to_owned()],
        &mut fetch,
        &ImportOptions::default(),
        &mut SourceMap::default(),
    );
    read.map_err(|mut faults| faults.swap_remove(0))
}

/// Largest distance of points between the sections to surfaces through the sections as they were read, mm.
///
/// `None` where the sections do not divide into faces and edges, or have no surfaces.
pub(super) fn distance_between(part: &Part, written: &[BladeLoops], read: &Imported) -> Option<f64> {
    let row = read.rows.first()?;
    let divided = blade_files::outlines::outlines(row, read.hub.as_deref(), &ImportOptions::default()).ok()?;
    let count = written.first()?.loops.len();
    let finer = blade_loops(part, 2 * count - 1).ok()?;
    let mut worst = 0.0_f64;
    for (blade, sections) in finer.iter().zip(divided) {
        let outlines: Vec<Outline> = sections.into_iter().map(|section| section.outline).collect();
        let LoftedBlade { faces, edges, .. } = loft(&outlines, FIT_MM).ok()?;
        let surfaces: Vec<_> = faces.iter().chain(edges.iter().flatten()).collect();
        let whole = Patch { u: [0.0, 1.0], v: [0.0, 1.0] };
        for points in blade.loops.iter().skip(1).step_by(2) {
            for p in points.iter().step_by(COMPARED_EVERY) {
                let off = surfaces.iter().map(|surface| surface.closest(p, whole).distance);
                worst = worst.max(off.fold(f64::INFINITY, f64::min));
            }
        }
    }
    Some(worst)
}
