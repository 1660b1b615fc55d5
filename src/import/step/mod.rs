//! STEP files (ISO 10303-21 of AP203, AP214, AP242): their unit and their faces, with number, name and kind of surface.

mod lexer;
mod table;
mod units;

use super::Imported;
use super::Options;
use super::found::Found;
use super::loader::Loader;
use crate::diag::codes::import as codes;
use crate::diag::{Diag, printable};
use crate::source::SourceId;
use crate::units::trim;
use table::EntityTable;

/// Most faces that are listed. A wheel of 40 blades with fillets has some 500.
const MOST_FACES: usize = 20_000;

/// Lists the faces of a file.
pub(super) fn read(
    ids: &[SourceId],
    loader: &mut Loader<'_>,
    options: &Options,
    found: &mut Found,
) -> Result<Imported, Diag> {
    let text = loader.text(ids.first().copied().unwrap_or_default());
    let (source, whole) = text.whole();
    let table = EntityTable::read(source, whole)?;
    let mm = units::length(&table, options, text.end(), found)?;
    let mut listing = vec![format!("unit of length: {} mm", trim(mm, 9)), "  number  surface  name".to_owned()];
    for face in table.of_kinds(&["ADVANCED_FACE", "FACE_SURFACE"]) {
        let face = face?;
        if listing.len() > MOST_FACES {
            return Err(Diag::error(codes::TOO_MUCH, format!("more than {MOST_FACES} faces, the limit"))
                .label(face.span, "this one exceeds it")
                .help("export one sector of the wheel alone"));
        }
        let arguments = face.arguments("FACE_SURFACE")?;
        let surface = table.entity(arguments.reference(2)?, face.span)?;
        listing.push(format!("  #{}  {}  {}", face.number, surface.name(), printable(&arguments.text(0))));
    }
    let faces = listing.len() - 2;
    if faces == 0 {
        return Err(Diag::error(codes::NOT_READ, "the file has no faces")
            .label(text.end(), "no ADVANCED_FACE stands before its end")
            .help("export the wheel as a solid or as surfaces with their edges"));
    }
    found.note(text.end(), format!("{faces} faces are listed; blades are not made from them"));
    Ok(Imported { listing, ..Imported::default() })
}

#[cfg(test)]
mod tests {
    use crate::import::{Imported, LengthUnit, Options, read};
    use crate::source::{SourceFile, SourceMap};

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
        let mut fetch = |name: &str| Ok(SourceFile::text(name, text.as_str()));
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
