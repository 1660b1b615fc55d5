//! A main blade of BladeGen: angles and thicknesses on layers, forms of its edges.

use super::curves::values;
use super::model::{Meridional, WheelModel};
use super::named::{ModelSection, not_read, same};
use crate::angles::{CamberFault, StatedAngle, StatedAngles, StatedAtSpan};
use crate::found::{Found, within};
use crate::lines::malformed;
use base::source::{Span, Spanned};
use base::units::trim;
use blade::angles::limits::{MAX_SPANS, OFF_ENDS, RATIOS, THICKNESSES};
use blade::angles::{CamberSurface, EdgeShape, FaultKind, MeridionalPatch, SectionFault, Thickness};
use diagnostics::Diag;
use diagnostics::codes::import as codes;

/// Keys of a blade for its edges.
pub(super) const EDGE_KEYS: [&str; 7] = [
    "LeadingEdgeEndType",
    "TrailingEdgeEndType",
    "HubLE_EllipseRatio",
    "ShrLE_EllipseRatio",
    "HubTE_EllipseRatio",
    "ShrTE_EllipseRatio",
    "EllipseAtMean",
];

/// The main blade with what a splitter takes from it.
#[derive(Debug)]
pub(super) struct MainBlade {
    pub(super) stated: StatedAngles,
    pub(super) camber: CamberSurface,
    pub(super) thickness: Thickness,
    /// Lines of the camber lines, and of the blade.
    pub(super) places: Vec<Span>,
    pub(super) at: Span,
}

/// Forms of both edges.
pub(super) fn shapes(block: &ModelSection<'_>) -> Result<[EdgeShape; 2], Diag> {
    Ok([shape(block, "LeadingEdgeEndType", "LE")?, shape(block, "TrailingEdgeEndType", "TE")?])
}

fn shape(block: &ModelSection<'_>, key: &str, edge: &str) -> Result<EdgeShape, Diag> {
    let kind = block.value(key)?.ok_or_else(|| block.missing(&format!("{key}=Ellipse")))?;
    if same(kind.text, "CutOff") {
        return Ok(EdgeShape::CutOff);
    }
    if !same(kind.text, "Ellipse") {
        return Err(not_read("this form of an edge is not read", kind.line, "Ellipse and CutOff are read"));
    }
    block.must_have("EllipseAtMean")?;
    let ratio = |key: String| {
        let (ratio, line) = block.number(&key)?.ok_or_else(|| block.missing(&format!("{key}=2")))?;
        if (RATIOS[0]..=RATIOS[1]).contains(&ratio) {
            return Ok((ratio, line));
        }
        let due = format!("a ratio from {} to {} is expected", RATIOS[0], RATIOS[1]);
        Err(not_read("this edge is too blunt or too slender", line, &due))
    };
    let (hub, _) = ratio(format!("Hub{edge}_EllipseRatio"))?;
    let (shroud, line) = ratio(format!("Shr{edge}_EllipseRatio"))?;
    if hub != shroud {
        return Err(not_read("the form of an edge changes over the span", line, "the ratio of the hub is expected"));
    }
    Ok(EdgeShape::Elliptic(hub))
}

/// Rows in the order of the span, without two on a layer.
fn in_order<T>(mut rows: Vec<Spanned<StatedAtSpan<T>>>) -> Result<Vec<Spanned<StatedAtSpan<T>>>, Diag> {
    rows.sort_by(|a, b| a.value.at.total_cmp(&b.value.at));
    match rows.windows(2).find(|pair| pair[1].value.at - pair[0].value.at < 1e-4) {
        Some(pair) => Err(malformed("two curves lie on one layer", pair[1].span, "this curve")),
        None => Ok(rows),
    }
}

/// Whether rows go from hub to shroud.
fn whole_span<T>(rows: &[Spanned<StatedAtSpan<T>>]) -> bool {
    rows.len() > 1 && rows.first().is_some_and(|r| r.value.at == 0.0) && rows.last().is_some_and(|r| r.value.at == 1.0)
}

/// Reads the curves of a blade.
struct CurveReader<'a> {
    model: &'a WheelModel,
    meridional: &'a Meridional,
    patch: &'a MeridionalPatch,
    /// Largest distance of the ends of a curve from 0 % and 100 %.
    off_ends: f64,
}

impl CurveReader<'_> {
    /// Values by the share of the way on a layer. BladeGen counts lengths of the layer, the language those of hub and shroud.
    fn on_layer(&mut self, curve: &ModelSection<'_>, span: f64) -> Result<Vec<[f64; 2]>, Diag> {
        let given = values(curve, &mut self.off_ends)?;
        if span == 0.0 || span == 1.0 {
            return Ok(given);
        }
        let shares: Vec<f64> = given.iter().map(|[share, _]| *share).collect();
        let places = self.patch.at_lengths(span, &shares);
        Ok(places.into_iter().zip(given).map(|(x, [_, value])| [x, value]).collect())
    }

    fn angles(&mut self, block: &ModelSection<'_>) -> Result<Vec<Spanned<StatedAtSpan<StatedAngle>>>, Diag> {
        block.only(&["AngleLocation", "SpanwiseDistribution"], &["AngleCurve"])?;
        block.must_be("AngleLocation", "MeanLine")?;
        block.must_be("SpanwiseDistribution", "General")?;
        let mut rows = Vec::new();
        for curve in block.all("AngleCurve") {
            within(rows.len() + 1, MAX_SPANS, "layers of a blade", curve.line.span)?;
            let at = self.meridional.layer(curve)?;
            rows.push(Spanned::new(StatedAtSpan { at, says: self.angle(curve, at)? }, curve.line.span));
        }
        let rows = in_order(rows)?;
        if whole_span(&rows) {
            return Ok(rows);
        }
        let message = "the angles do not go from hub to shroud";
        Err(not_read(message, block.line, "curves on a layer at 0 and on one at 1 are expected"))
    }

    fn angle(&mut self, curve: &ModelSection<'_>, span: f64) -> Result<StatedAngle, Diag> {
        let keys = ["Layer", "DefinitionType", "HorizDim", "VertDim"];
        let kind = curve.value("DefinitionType")?.ok_or_else(|| curve.missing("DefinitionType=ThetaCurve"))?;
        curve.must_be("VertDim", "Degree")?;
        let radians = |mut values: Vec<[f64; 2]>| {
            values.iter_mut().for_each(|[_, angle]| *angle = self.model.sign() * angle.to_radians());
            values
        };
        if same(kind.text, "ThetaCurve") {
            curve.only(&keys, &["Segment"])?;
            return Ok(StatedAngle::Theta(radians(self.on_layer(curve, span)?)));
        }
        if !same(kind.text, "BetaCurve") {
            return Err(not_read("this kind of angles is not read", kind.line, "ThetaCurve and BetaCurve are read"));
        }
        curve.only(&[&keys[..], &["LE_Theta"]].concat(), &["Segment"])?;
        if !self.model.beta_from_meridian {
            return Err(not_read(
                "it is not known from where beta is measured",
                kind.line,
                "`BetaAxialDef` is expected in `Model`",
            ));
        }
        let (start, _) = curve.number("LE_Theta")?.ok_or_else(|| curve.missing("LE_Theta=0"))?;
        let beta = radians(self.on_layer(curve, span)?);
        Ok(StatedAngle::Beta(beta, self.model.sign() * start.to_radians()))
    }

    fn thicknesses(
        &mut self,
        block: &ModelSection<'_>,
        found: &mut Found,
    ) -> Result<Vec<StatedAtSpan<Vec<[f64; 2]>>>, Diag> {
        block.only(&["ThicknessType", "SpanwiseDistribution"], &["ThicknessCurve"])?;
        block.must_be("ThicknessType", "Normal To Camber Line")?;
        block.must_be("SpanwiseDistribution", "General")?;
        let mut rows = Vec::new();
        for curve in block.all("ThicknessCurve") {
            within(rows.len() + 1, MAX_SPANS, "layers of a blade", curve.line.span)?;
            curve.only(&["Layer", "HorizDim"], &["Segment"])?;
            let at = self.meridional.layer(curve)?;
            let mut says = self.on_layer(curve, at)?;
            says.iter_mut().for_each(|[_, thickness]| *thickness = self.model.frame.length(*thickness));
            if says.iter().any(|[_, t]| !(THICKNESSES[0]..=THICKNESSES[1]).contains(t)) {
                let due = format!("from {} to {} mm are expected", THICKNESSES[0], THICKNESSES[1]);
                return Err(malformed("a blade cannot have this thickness", curve.line.span, &due));
            }
            rows.push(Spanned::new(StatedAtSpan { at, says }, curve.line.span));
        }
        let rows = in_order(rows)?;
        if let [only] = rows.as_slice() {
            found.note(only.span, "the thicknesses of this layer hold for all layers");
        } else if !whole_span(&rows) {
            let message = "the thicknesses do not go from hub to shroud";
            return Err(not_read(
                message,
                block.line,
                "one layer, or curves on a layer at 0 and on one at 1 are expected",
            ));
        }
        Ok(rows.into_iter().map(|row| row.value).collect())
    }
}

/// Reads the main blade.
pub(super) fn main_blade(
    block: &ModelSection<'_>,
    model: &WheelModel,
    meridional: &Meridional,
    found: &mut Found,
) -> Result<MainBlade, Diag> {
    block.only(&[&EDGE_KEYS[..], &["PitchFraction"]].concat(), &["AngleDefinition", "ThicknessDefinition"])?;
    if let Some((turn, line)) = block.number("PitchFraction")?
        && turn != 0.0
    {
        return Err(not_read("the main blade is turned", line, "0 is expected for the first blade"));
    }
    let edges = meridional.edges.each_ref().map(|edge| edge.points.clone());
    let shapes = shapes(block)?;
    let mut stated = StatedAngles { camber: Vec::new(), thickness: Vec::new(), edges, shapes, turn: 0.0 };
    let ends = [&meridional.hub.line, &meridional.shroud.line];
    let (patch, off) =
        stated.patch(ends).ok_or_else(|| malformed("an edge is no curve", block.line.span, "of this blade"))?;
    for (edge, off) in meridional.edges.iter().zip(off) {
        edge_ends(off, edge.at)?;
    }
    let mut reader = CurveReader { model, meridional, patch: &patch, off_ends: 0.0 };
    let angles = reader.angles(block.required("AngleDefinition")?)?;
    stated.thickness = reader.thicknesses(block.required("ThicknessDefinition")?, found)?;
    if reader.off_ends > 0.0 {
        let percent = trim(reader.off_ends * 100.0, 7);
        found.note(
            None,
            format!("curves begin and end up to {percent} % beside 0 % and 100 %, which are taken instead"),
        );
    }
    let (camber, places): (Vec<_>, Vec<_>) = angles.into_iter().map(|row| (row.value, row.span)).unzip();
    stated.camber = camber;
    let surface = stated.camber(patch).map_err(|fault| no_camber(fault, &places, block.line.span))?;
    let thickness = stated.thicknesses();
    let thickness =
        thickness.ok_or_else(|| malformed("the thicknesses give no curve", block.line.span, "of this blade"))?;
    Ok(MainBlade { stated, camber: surface, thickness, places, at: block.line.span })
}

/// Refuses an edge that does not go from hub to shroud.
pub(super) fn edge_ends(off: [f64; 2], at: Span) -> Result<(), Diag> {
    let Some((surface, off)) = ["hub", "shroud"].into_iter().zip(off).find(|(_, off)| *off > OFF_ENDS) else {
        return Ok(());
    };
    Err(Diag::error(codes::CONTRADICTS, format!("an edge of the blade ends {off:.3} mm beside the {surface}"))
        .label(at, "this curve goes from hub to shroud")
        .help(format!("let the ends of the curve lie on hub and shroud, within {OFF_ENDS} mm")))
}

/// The fault of angles that give no camber surface.
pub(super) fn no_camber(fault: CamberFault, places: &[Span], blade: Span) -> Diag {
    match fault {
        CamberFault::NoCurve => malformed("the angles give no curve", blade, "of this blade"),
        CamberFault::Steep(row, beta) => {
            let at = places.get(row).copied().unwrap_or(blade);
            Diag::error(codes::SECTION, "the camber line runs round the axis")
                .label(at, format!("it reaches {:.2} deg to the meridian", beta.to_degrees()))
                .help("look at the angles of this layer; theta of less slope, or beta of less than 89 deg is expected")
        }
    }
}

/// The fault of a section that cannot be made.
pub(super) fn no_section(fault: &SectionFault, at: Span) -> Diag {
    let why = match fault.kind {
        FaultKind::Steep(beta) => format!("the camber line has {:.2} deg to the meridian", beta.to_degrees()),
        FaultKind::Thin(thickness) => format!("the spline of the thickness falls to {thickness:.4} mm"),
        FaultKind::Fold(thickness) => format!("a face folds: the camber line bends too much for {thickness:.3} mm"),
        FaultKind::EdgesMeet([edges, line]) => format!("edges of {edges:.3} mm are too long for {line:.3} mm"),
        FaultKind::NotCut(0) => "a face does not reach the leading edge".to_owned(),
        FaultKind::NotCut(_) => "a face does not reach the trailing edge".to_owned(),
    };
    let place = format!("{} % of the way, {} % of the span", trim(fault.way * 100.0, 2), trim(fault.span * 100.0, 2));
    Diag::error(codes::SECTION, "a section of the blade cannot be made")
        .label(at, format!("{why}, at {place}"))
        .help("look at the angles and thicknesses there in BladeGen")
}
