//! What a BladeGen model states of the whole wheel: the sections `Model` and `Meridional`.

use super::curves::{MeridionalCurve, meridional, surface};
use super::named::{ModelSection, not_read, only_one, same};
use crate::Options;
use crate::found::{Found, within};
use crate::frame::{Axis, Frame, Handedness, LengthUnit};
use crate::limits;
use crate::stated::RequiredFacts;
use base::source::Spanned;
use diagnostics::codes::import as codes;
use diagnostics::{Diag, printable};

/// Keys of `Model` that do not change the blade: how BladeGen writes and shows it, and who made it.
const WITHOUT_EFFECT: [&str; 13] = [
    "OutputBladePoints",
    "BladeOutputPointClustering",
    "NumBladePoints",
    "NumLeadingEdgePoints",
    "NumTrailingEdgePoints",
    "CurveDisplayMaximumError",
    "Component",
    "Designer",
    "Company",
    "Comment",
    "DeviceType",
    "ConfigurationType",
    "RotationType",
];

/// Facts of `Model`.
#[derive(Clone, Copy, Debug)]
pub(super) struct WheelModel {
    pub(super) count: u32,
    pub(super) frame: Frame,
    /// Whether beta is stated as the angle to the meridian.
    pub(super) beta_from_meridian: bool,
}

/// Meridional curves and layers.
#[derive(Debug)]
pub(super) struct Meridional {
    pub(super) hub: MeridionalCurve,
    pub(super) shroud: MeridionalCurve,
    /// Leading and trailing edge.
    pub(super) edges: [MeridionalCurve; 2],
    /// Names of the layers with their shares of the span.
    layers: Vec<(String, f64)>,
}

impl WheelModel {
    pub(super) fn of(block: &ModelSection<'_>, options: &Options, found: &mut Found) -> Result<Self, Diag> {
        let read = [
            "NumMainBlades",
            "Mode",
            "LeftHandedCoordSystem",
            "RightHandedCoordSystem",
            "DataFromLeToTe",
            "BetaAxialDef",
            "ThicknessIsDimension",
            "MeridionalSpanCurveRuledShape",
            "GeometryUnits",
        ];
        block.must_be("Mode", "Angle/Thickness")?;
        block.only(&[&read[..], &WITHOUT_EFFECT].concat(), &[])?;
        block.must_have("DataFromLeToTe")?;
        block.must_have("ThicknessIsDimension")?;
        if block.value("MeridionalSpanCurveRuledShape")?.is_some() {
            block.must_be("MeridionalSpanCurveRuledShape", "RuledElementOnly")?;
        }
        let count = match block.value("NumMainBlades")? {
            Some(value) => {
                let count = value.line.count(value.text, "blades", limits::COUNT as usize)?;
                Some(Spanned::new(u32::try_from(count).unwrap_or(0), value.line.span))
            }
            None => None,
        };
        let unit = match block.value("GeometryUnits")? {
            Some(value) => Some(Spanned::new(
                LengthUnit::named(value.text)
                    .ok_or_else(|| value.line.fault("there is no such unit", "MM, CM, M, IN or FT is expected"))?,
                value.line.span,
            )),
            None => None,
        };
        let handedness = match (block.flag("LeftHandedCoordSystem")?, block.flag("RightHandedCoordSystem")?) {
            (Some(left), Some(_)) => {
                return Err(Diag::error(codes::CONTRADICTS, "the frame is left and right handed")
                    .label(left.span, "one of both flags is expected")
                    .help("keep the flag that BladeGen shows for this model"));
            }
            (Some(line), None) => Some(Spanned::new(Handedness::Left, line.span)),
            (None, right) => right.map(|line| Spanned::new(Handedness::Right, line.span)),
        };
        let mut required = RequiredFacts::of(options, found, block.line.span);
        let unit = required.unit(unit)?;
        let axis = required.axis(Some(Spanned::new(Axis::Z, block.line.span)))?;
        let handedness = required.handedness(handedness)?;
        let count = required.blades(count)?;
        required.end()?;
        let beta_from_meridian = block.flag("BetaAxialDef")?.is_some();
        Ok(Self { count, frame: Frame { mm: unit.mm(), axis, handedness }, beta_from_meridian })
    }

    /// The sign of angles about +Z of the part: a left-handed frame is mirrored.
    pub(super) fn sign(&self) -> f64 {
        if self.frame.handedness == Handedness::Left { -1.0 } else { 1.0 }
    }
}

impl Meridional {
    pub(super) fn of(block: &ModelSection<'_>, frame: &Frame, found: &mut Found) -> Result<Self, Diag> {
        let curves = [
            "HubCurve",
            "ShroudCurve",
            "InletCurve",
            "ExhaustCurve",
            "LeadingEdgeCurve",
            "TrailingEdgeCurve",
            "SpanLayer",
        ];
        block.only(&["MeridionalControlCurveMode", "SpanByGeom"], &curves)?;
        if block.value("MeridionalControlCurveMode")?.is_some() {
            block.must_be("MeridionalControlCurveMode", "Normal")?;
        }
        block.must_have("SpanByGeom")?;
        let hub = surface("hub", block.required("HubCurve")?, frame, found)?;
        let shroud = surface("shroud", block.required("ShroudCurve")?, frame, found)?;
        for name in ["InletCurve", "ExhaustCurve"] {
            if let Some(curve) = block.block(name)? {
                found.note(curve.line.span, format!("`{name}` is not used: hub and shroud end where their curves end"));
            }
        }
        let edge = |name: &str| meridional(block.required(name)?, frame)?.smooth();
        let edges = [edge("LeadingEdgeCurve")?, edge("TrailingEdgeCurve")?];
        for (k, (name, curve)) in [("hub", &hub), ("shroud", &shroud)].into_iter().enumerate() {
            let ends = edges.each_ref().map(|edge: &MeridionalCurve| {
                let end = if k == 0 { edge.points.first() } else { edge.points.last() };
                end.map_or(0.0, |end| curve.line.nearest(*end).0)
            });
            curve.holds_blade(name, ends, found)?;
        }
        let mut layers: Vec<(String, f64)> = Vec::new();
        for layer in block.all("SpanLayer") {
            layer.only(&["Name", "OutputLayer", "SpanFraction"], &[])?;
            let name = layer.value("Name")?.ok_or_else(|| layer.missing("Name=Layer1"))?;
            let (share, line) = layer.number("SpanFraction")?.ok_or_else(|| layer.missing("SpanFraction=0"))?;
            if !(0.0..=1.0).contains(&share) {
                return Err(line.fault("a layer lies beyond hub and shroud", "a share from 0 to 1 is expected"));
            }
            if layers.iter().any(|(known, _)| known == name.text) {
                return Err(name.line.fault("this layer is given again", "another name is expected"));
            }
            layers.push((name.text.to_owned(), share));
            within(layers.len(), limits::SECTIONS, "layers", layer.line.span)?;
        }
        Ok(Self { hub, shroud, edges, layers })
    }

    /// Share of the span of the layer that a curve names.
    pub(super) fn layer(&self, curve: &ModelSection<'_>) -> Result<f64, Diag> {
        let name = curve.value("Layer")?.ok_or_else(|| curve.missing("Layer=\"Layer1\""))?;
        let known = self.layers.iter().find(|(layer, _)| same(layer, name.text));
        known
            .map(|(_, share)| *share)
            .ok_or_else(|| name.line.fault("there is no such layer", "the name of a section `SpanLayer` is expected"))
    }
}

/// Refuses sections of the file that are not known, and formulas.
pub(super) fn only_known(blocks: &[ModelSection<'_>]) -> Result<(), Diag> {
    let known = ["Defaults", "Equations", "Model", "Meridional", "Blade", "PlusData"];
    if let Some(block) = blocks.iter().find(|block| !known.iter().any(|name| same(block.name, name))) {
        let name = printable(block.name);
        return Err(not_read(format!("the section `{name}` is not known"), block.line, "it may change the blade"));
    }
    for name in ["Defaults", "Equations"] {
        only_one(blocks, name)?.map_or(Ok(()), ModelSection::must_be_empty)?;
    }
    Ok(())
}
