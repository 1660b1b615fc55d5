//! A splitter of BladeGen: the main blade, cut by a meridional curve and turned by a share of the pitch.
//!
//! The language has splitters that begin at shares of the way of the main blade. A cut is any curve. So the splitter gets angles
//! and thicknesses of its own, which are those of the main blade at the same meridional places.

use super::blade::{EDGE_KEYS, MainBlade, edge_ends, no_camber, shapes};
use super::curves::meridional as curve;
use super::model::{Meridional, WheelModel};
use super::named::{ModelSection, not_read};
use crate::angles::{StatedAngle, StatedAngles, StatedAtSpan};
use crate::found::Found;
use crate::lines::malformed;
use blade::angles::{CamberSurface, MeridionalPatch, Thickness};
use diagnostics::Diag;
use diagnostics::codes::import as codes;

/// Spans of the splitter, and places along it, at which angles and thicknesses are taken from the main blade.
const SPLITTER_SPANS: usize = 9;
const SAMPLED_PLACES: usize = 48;

/// Largest distance from the main blade, mm, half way between these places.
const OFF_MAIN: f64 = 0.01;

/// A splitter, with its camber surface.
#[derive(Debug)]
pub(super) struct Splitter {
    pub(super) stated: StatedAngles,
    pub(super) camber: CamberSurface,
    pub(super) thickness: Thickness,
}

/// The main blade, seen from the meridional surface of the splitter.
struct OnMain<'a> {
    main: &'a MainBlade,
    patch: &'a MeridionalPatch,
}

impl OnMain<'_> {
    /// Theta and thickness of the main blade at a place of the splitter, with the radius there.
    fn at(&self, way: f64, span: f64, near: &mut [f64; 2]) -> Option<[f64; 3]> {
        let point = self.patch.at(way, span).0;
        *near = self.main.camber.patch().place_of(point, *near)?;
        let [x, s] = near.map(|share| share.clamp(0.0, 1.0));
        Some([self.main.camber.theta(x, s), self.main.thickness.at(x, s), point[0]])
    }
}

/// Reads a splitter.
pub(super) fn splitter(
    block: &ModelSection<'_>,
    model: &WheelModel,
    meridional: &Meridional,
    main: &MainBlade,
    found: &mut Found,
) -> Result<Splitter, Diag> {
    let at = block.line.span;
    for own in ["AngleDefinition", "ThicknessDefinition"] {
        if let Some(own) = block.block(own)? {
            return Err(not_read(
                "a splitter with angles of its own is not read",
                own.line,
                "a part of the main blade is read",
            ));
        }
    }
    block.only(&[&EDGE_KEYS[..], &["PitchFraction"]].concat(), &["LeadingEdgeCut"])?;
    let (share, line) = block.number("PitchFraction")?.ok_or_else(|| block.missing("PitchFraction=0.5"))?;
    if !(share > 0.0 && share < 1.0) {
        return Err(
            line.fault("a splitter stands in a blade or beyond the next", "a share between 0 and 1 is expected")
        );
    }
    let turn = if model.sign() < 0.0 { 1.0 - share } else { share };
    let cut = curve(block.required("LeadingEdgeCut")?, &model.frame)?.smooth()?;
    let edges = [cut.points, meridional.edges[1].points.clone()];
    let mut stated = StatedAngles { camber: Vec::new(), thickness: Vec::new(), edges, shapes: shapes(block)?, turn };
    let ends = [&meridional.hub.line, &meridional.shroud.line];
    let (patch, off) = stated.patch(ends).ok_or_else(|| malformed("the cut is no curve", cut.at, "this curve"))?;
    edge_ends(off[0], cut.at)?;
    let on_main = OnMain { main, patch: &patch };
    let outside = || {
        Diag::error(codes::CONTRADICTS, "the splitter does not lie within the main blade")
            .label(cut.at, "this cut")
            .help("let the cut lie between the leading and the trailing edge of the main blade")
    };
    for k in 0..SPLITTER_SPANS {
        let span = k as f64 / (SPLITTER_SPANS - 1) as f64;
        let (mut theta, mut thickness) = (Vec::new(), Vec::new());
        let mut near = [0.5, span];
        for j in 0..=SAMPLED_PLACES {
            let way = j as f64 / SAMPLED_PLACES as f64;
            let [angle, thick, _] = on_main.at(way, span, &mut near).ok_or_else(outside)?;
            if !(-1e-3..=1.001).contains(&near[0]) {
                return Err(outside());
            }
            theta.push([way, angle]);
            thickness.push([way, thick]);
        }
        stated.camber.push(StatedAtSpan { at: span, says: StatedAngle::Theta(theta) });
        stated.thickness.push(StatedAtSpan { at: span, says: thickness });
    }
    let camber = stated.camber(patch.clone()).map_err(|fault| no_camber(fault, &[], at))?;
    let thickness = stated.thicknesses().ok_or_else(outside)?;
    let off = off_main(&on_main, &camber, &thickness).ok_or_else(outside)?;
    if off > OFF_MAIN {
        let message = format!("the splitter would lie {off:.3} mm off the main blade of which it is a part");
        return Err(not_read(message, block.line, &format!("{OFF_MAIN} mm are allowed")));
    }
    found.moved(off);
    found.note(
        None,
        format!(
            "a splitter is the main blade, cut and turned by {share} of the pitch; it lies within {:.2} um of it",
            off * 1000.0
        ),
    );
    Ok(Splitter { stated, camber, thickness })
}

/// Largest distance of the splitter from the main blade half way between the places that were taken from it, mm: of camber
/// lines round the axis, and of half the thicknesses.
fn off_main(on_main: &OnMain<'_>, camber: &CamberSurface, thickness: &Thickness) -> Option<f64> {
    let mut worst = 0.0_f64;
    for k in 0..SPLITTER_SPANS - 1 {
        let span = (k as f64 + 0.5) / (SPLITTER_SPANS - 1) as f64;
        let mut near = [0.5, span];
        for j in 0..SAMPLED_PLACES {
            let way = (j as f64 + 0.5) / SAMPLED_PLACES as f64;
            let [theta, thick, r] = on_main.at(way, span, &mut near)?;
            worst = worst.max((camber.theta(way, span) - theta).abs() * r);
            worst = worst.max(0.5 * (thickness.at(way, span) - thick).abs());
        }
    }
    Some(worst)
}
