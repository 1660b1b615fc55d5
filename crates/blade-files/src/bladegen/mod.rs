//! BladeGen `.bgi`: a model by angles and thicknesses on layers between hub and shroud.
//!
//! Points are (z, r), the axis of rotation is Z. All that the file has is understood, or known to be without effect on the
//! blade, or refused: a key that is not known may change the blade. BladeGen has a default for each key, but it is not known
//! which, so a key that matters must be stated.

mod blade;
mod curves;
mod model;
mod named;
mod splitter;

use super::angles::StatedAngles;
use super::found::{Found, within};
use super::lines::{Text, ends};
use super::loader::Loader;
use super::{Imported, ImportedBlade, ImportedRow, Options, limits};
use ::blade::EdgeForm;
use ::blade::angles::{CamberSurface, EdgeShape, Thickness};
use base::source::{SourceId, Span};
use blade::{main_blade, no_section};
use diagnostics::Diag;
use diagnostics::codes::import as codes;
use model::{Meridional, WheelModel, only_known};
use named::{ModelSection, blocks, only_one, same};
use splitter::splitter;

/// What is taken for granted of every model.
const GRANTED: [&str; 4] = [
    "between the points of a curve a cubic spline is taken; that of BladeGen may differ",
    "layers are taken to divide the straight lines between equal shares of hub and shroud; curved edges bend them",
    "thicknesses are taken across the camber line on the surface of revolution of the layer, half to each side",
    "an edge that is cut off is taken to end on its meridional curve",
];

pub(super) fn read(
    ids: &[SourceId],
    loader: &mut Loader<'_>,
    options: &Options,
    found: &mut Found,
) -> Result<Imported, Diag> {
    let Some(id) = ids.first().copied() else { return Ok(Imported::default()) };
    let text = loader.text(id);
    let blocks = blocks(text, found)?;
    only_known(&blocks)?;
    let section = |name: &str| only_one(&blocks, name)?.ok_or_else(|| ends(text, &format!("the section `{name}`")));
    let model = WheelModel::of(section("Model")?, options, found)?;
    let meridional = Meridional::of(section("Meridional")?, &model.frame, found)?;
    let given: Vec<&ModelSection<'_>> = blocks.iter().filter(|block| same(block.name, "Blade")).collect();
    let Some((first, others)) = given.split_first() else { return Err(ends(text, "the first section `Blade`")) };
    within(given.len(), limits::BLADES, "blades of a row", text.end())?;
    complete(&blocks, text)?;

    let main = main_blade(first, &model, &meridional, found)?;
    let pitch = std::f64::consts::TAU / f64::from(model.count);
    let made = |name: String, stated: &StatedAngles, camber: &CamberSurface, thickness: &Thickness, at: Span| {
        let spans = spans(&main.stated);
        let turn = stated.turn * pitch;
        let sections = stated.sections(camber, thickness.clone(), &spans, turn);
        let sections = sections.map_err(|fault| no_section(&fault, at))?;
        let place = |span: &f64| {
            let row = main.stated.camber.iter().position(|row| row.at == *span);
            row.filter(|_| at == main.at).and_then(|k| main.places.get(k)).copied().unwrap_or(at)
        };
        let places = spans.iter().map(place).collect();
        let edges = stated
            .shapes
            .map(|shape| Some(if shape == EdgeShape::CutOff { EdgeForm::CutOff } else { EdgeForm::Round }));
        Ok(ImportedBlade { name, sections, places, edges, angles: Some(stated.clone()), ..ImportedBlade::default() })
    };
    let mut blades = vec![made("main".to_owned(), &main.stated, &main.camber, &main.thickness, main.at)?];
    for (k, block) in others.iter().enumerate() {
        let part = splitter(block, &model, &meridional, &main, found)?;
        blades.push(made(format!("splitter_{}", k + 1), &part.stated, &part.camber, &part.thickness, block.line.span)?);
    }
    GRANTED.into_iter().for_each(|granted| found.note(None, granted));
    let row = ImportedRow { name: String::new(), count: model.count, blades };
    Ok(Imported {
        hub: Some(meridional.hub.points),
        shroud: Some(meridional.shroud.points),
        rows: vec![row],
        ..Imported::default()
    })
}

/// Refuses a file without its last section: it may have been cut off between two blades.
fn complete(blocks: &[ModelSection<'_>], text: Text<'_>) -> Result<(), Diag> {
    if blocks.last().is_some_and(|block| same(block.name, "PlusData")) {
        return Ok(());
    }
    Err(Diag::error(
        codes::ENDS_EARLY,
        "the file ends without the section `PlusData`, the last one that BladeGen writes",
    )
    .label(text.end(), "the last line")
    .help("copy the file again; where it is complete, add the lines `Begin PlusData` and `End PlusData` at its end"))
}

/// Shares of the span at which sections are made: those of the stated layers, and quarters.
fn spans(main: &StatedAngles) -> Vec<f64> {
    let stated = main.camber.iter().map(|row| row.at).chain(main.thickness.iter().map(|row| row.at));
    let mut spans: Vec<f64> = stated.chain([0.0, 0.25, 0.5, 0.75, 1.0]).collect();
    spans.sort_by(f64::total_cmp);
    spans.dedup_by(|a, b| (*a - *b).abs() < 1e-6);
    spans
}
