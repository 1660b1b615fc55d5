//! STEP files (ISO 10303-21 of AP203, AP214, AP242): their unit, the list of their faces, and the wheel of the faces that are
//! picked.

mod assembly;
mod blade;
mod copies;
mod curve;
mod edge;
mod ends;
mod face;
mod fillet;
mod fitted;
mod inlet;
mod lexer;
mod looped;
mod meridian;
mod neighbours;
mod nose;
mod picks;
mod placement;
mod read_geometry;
mod revolved;
mod sheet;
mod spline;
mod surface;
mod table;
mod turned_faces;
mod turned_surface;
mod units;
mod wheel;

use super::Imported;
use super::Options;
use super::found::Found;
use super::loader::Loader;
use base::source::SourceId;
use base::units::trim;
use diagnostics::codes::import as codes;
use diagnostics::{Diag, printable};
use nalgebra::IsometryMatrix3;
use placement::StepGeometry;
use table::EntityTable;
use wheel::StepWheel;

/// Reads the wheel of the faces that the caller picks, or that have the names of our own export. Without any it lists the faces.
pub(super) fn read(
    ids: &[SourceId],
    loader: &mut Loader<'_>,
    options: &Options,
    found: &mut Found,
) -> Result<Imported, Diag> {
    let text = loader.text(ids.first().copied().unwrap_or_default());
    let end = text.end();
    let (source, whole) = text.whole();
    let table = EntityTable::read(source, whole)?;
    let mm = units::length(&table, options, end, found)?;
    let mut faces = picks::listed(&table)?;
    if faces.is_empty() {
        return Err(Diag::error(codes::NOT_READ, "the file has no faces")
            .label(end, "no ADVANCED_FACE stands before its end")
            .help("export the wheel as a solid or as surfaces with their edges"));
    }
    let picked = picks::picked(&faces, &options.faces, end)?;
    if !picked.is_empty() {
        let radians = units::angle(&table)?;
        let geometry = StepGeometry { table: &table, mm, radians, frame: IsometryMatrix3::identity() };
        assembly::place(&geometry, &mut faces, &|k| picked.has(k))?;
        return StepWheel { geometry, faces: &faces, picked: &picked, options, end }.read(found);
    }
    let mut listing = vec![format!("unit of length: {} mm", trim(mm, 9)), "  number  surface  name".to_owned()];
    let line = |face: &picks::ListedFace<'_>| {
        format!("  #{}  {}  {}", face.entity.number, face.surface, printable(&face.name))
    };
    listing.extend(faces.iter().map(line));
    found.note(end, format!("{} faces are listed; `--face` picks those of the wheel", faces.len()));
    Ok(Imported { listing, ..Imported::default() })
}

#[cfg(test)]
mod tests {
    use crate::{Imported, LengthUnit, Options, read};
    use base::source::{SourceFile, SourceMap};

    const INCH: &str = "#1=(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.));
#2=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#1);
#3=DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);
#4=(CONVERSION_BASED_UNIT('INCH',#2) LENGTH_UNIT() NAMED_UNIT(#3));
#5=(NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.));
#6=(GEOMETRIC_REPRESENTATION_CONTEXT(3) GLOBAL_UNIT_ASSIGNED_CONTEXT((#4,#5)) REPRESENTATION_CONTEXT('',''));
";

    fn of(data: &str, unit: Option<LengthUnit>) -> Result<Imported, (&'static str, usize)> {
        let face = "#20=PLANE('',#21);\n#22=ADVANCED_FACE('it''s',(),#20,.T.);\n";
        let text = format!("ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n{data}{face}ENDSEC;\nEND-ISO-10303-21;\n");
        let mut sources = SourceMap::default();
        let options = Options { unit, ..Options::default() };
        let mut fetch = |name: &str, _: usize| Ok(SourceFile::text(name, text.as_str()));
        let read = read(&["a.stp".to_owned()], &mut fetch, &options, &mut sources);
        read.map_err(|diags| (diags[0].code.id(), sources.line_column(diags[0].labels[0].span).0))
    }

    #[test]
    fn units_and_faces_are_found() {
        let made = of(INCH, None).expect("a file");
        assert_eq!(made.listing, ["unit of length: 25.4 mm", "  number  surface  name", "  #22  PLANE  it's"]);
        let micrometre = INCH.replace(".MILLI.", ".MICRO.").replace("((#4,", "((#1,");
        assert_eq!(of(&micrometre, None).expect("a file").listing[0], "unit of length: 0.001 mm");
        let metre = INCH.replace(".MILLI.", "$").replace("((#4,", "((#1,");
        assert_eq!(of(&metre, Some(LengthUnit::Metre)).expect("a file").listing[0], "unit of length: 1000 mm");
    }

    #[test]
    fn units_are_never_guessed() {
        // Line 5 is the first one of the data.
        assert_eq!(of("", None), Err(("IMP1004", 8)));
        assert!(of("", Some(LengthUnit::Inch)).is_ok_and(|made| made.listing[0] == "unit of length: 25.4 mm"));
        assert_eq!(of(INCH, Some(LengthUnit::Millimetre)), Err(("IMP1005", 10)));
        let two = format!("{INCH}#7=(GLOBAL_UNIT_ASSIGNED_CONTEXT((#1)) REPRESENTATION_CONTEXT('',''));\n");
        assert_eq!(of(&two, None), Err(("IMP1005", 11)));
        let circle = INCH.replace("LENGTH_MEASURE(25.4),#1", "LENGTH_MEASURE(25.4),#4");
        assert_eq!(of(&circle, None), Err(("IMP1002", 8)));
        assert_eq!(of(&INCH.replace("25.4", "0."), None), Err(("IMP1002", 6)));
        assert_eq!(of(&INCH.replace("#4,#5", "#99,#5"), None), Err(("IMP1002", 10)));
    }
}
