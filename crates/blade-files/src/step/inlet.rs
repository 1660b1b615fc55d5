//! Which end of the hub is the inlet: by an edge that was picked, by the caller along the axis, otherwise the end of the blade nearer to
//! the axis.

use super::face::{EDGE_GAP_MM, StepFace};
use super::meridian::{StepMeridian, flat};
use crate::found::Found;
use crate::{Axis, Start};
use base::source::Span;
use base::units::trim;
use diagnostics::Diag;
use diagnostics::codes::import as codes;
use nalgebra::Vector2;

/// Radii of both ends of a blade are different where their ratio is below this.
const SMALLER: f64 = 0.95;

/// Of the points of borders, one in so many counts.
const BORDER_STRIDE: usize = 64;

fn points(face: &StepFace) -> Vec<Vector2<f64>> {
    face.borders.iter().flatten().flat_map(|edge| edge.points.iter().step_by(BORDER_STRIDE)).map(flat).collect()
}

/// Mean length along the hub to the points of faces, mm.
fn mean(hub: &StepMeridian, faces: &[StepFace]) -> f64 {
    let points: Vec<Vector2<f64>> = faces.iter().flat_map(points).collect();
    points.iter().map(|p| hub.nearest(p)[0]).sum::<f64>() / points.len().max(1) as f64
}

/// The meridian of the hub from inlet to outlet. `blade` has the pressure and the suction face, `ends` the faces that are picked
/// at inlet and outlet; `start` is which edge the caller says to be first along the axis.
pub(super) fn run_from_inlet(
    hub: StepMeridian,
    blade: &[StepFace],
    ends: [Vec<StepFace>; 2],
    start: Option<Start>,
    axis: Axis,
    found: &mut Found,
) -> Result<StepMeridian, Diag> {
    let middle = mean(&hub, blade);
    let [inlet, outlet] = ends.each_ref().map(|faces| faces.first().map(|face| (mean(&hub, faces), face)));
    let forward = [inlet.map(|(at, face)| (at < middle, face)), outlet.map(|(at, face)| (at > middle, face))];
    let stated = BladeEnds::of(&hub, blade).stated(start, axis)?;
    let forward = match forward {
        [Some((a, inlet)), Some((b, outlet))] if a != b => {
            return Err(Diag::error(codes::CONTRADICTS, "the edges at inlet and outlet are at one end of the blade")
                .label(inlet.span, format!("#{} is the inlet edge", inlet.number))
                .label(outlet.span, format!("#{} is the outlet edge", outlet.number))
                .help("pick other edges with `--face inlet=` and `--face outlet=`"));
        }
        [Some((forward, face)), _] | [None, Some((forward, face))] => {
            if stated.is_some_and(|stated| stated != forward) {
                let message = "the edge that is picked is at the other end of the blade than `--start` says";
                return Err(Diag::error(codes::CONTRADICTS, message)
                    .label(face.span, format!("#{} is picked as edge", face.number))
                    .help("leave out `--start`, or pick the other edge"));
            }
            found.note(face.span, format!("#{} `{}` tells the inlet", face.number, face.name));
            forward
        }
        [None, None] => match stated {
            Some(forward) => {
                found.note(
                    None,
                    format!("the inlet is at the {} end of the blade along {axis}, by `--start`", {
                        if start == Some(Start::LeadingEdge) { "lower" } else { "upper" }
                    }),
                );
                forward
            }
            None => BladeEnds::of(&hub, blade).by_radius(axis, found)?,
        },
    };
    Ok(if forward { hub } else { hub.reversed() })
}

/// Ends of a blade along the hub.
struct BladeEnds {
    /// Radius and height of the blade at the start and at the end of the hub, near the hub, mm.
    at: [Vector2<f64>; 2],
    span: Span,
}

impl BladeEnds {
    fn of(hub: &StepMeridian, blade: &[StepFace]) -> Self {
        /// What is nearer to an end than this share of the length of the blade belongs to it: an edge may stand across the hub.
        const NEAR_END_SHARE: f64 = 0.02;
        let places: Vec<([f64; 2], Vector2<f64>)> =
            blade.iter().flat_map(points).map(|p| (hub.nearest(&p), p)).collect();
        let lengths = || places.iter().map(|([at, _], _)| *at);
        let (first, last) = (lengths().fold(f64::INFINITY, f64::min), lengths().fold(f64::NEG_INFINITY, f64::max));
        let lowest = |end: f64| {
            let near = places.iter().filter(|([at, _], _)| (at - end).abs() <= NEAR_END_SHARE * (last - first));
            near.min_by(|a, b| a.0[1].total_cmp(&b.0[1])).map_or_else(Vector2::zeros, |(_, p)| *p)
        };
        Self { at: [lowest(first), lowest(last)], span: blade.first().map_or(Span::default(), |face| face.span) }
    }

    /// Whether the hub runs from the inlet, by the edge that the caller says to be first along the axis.
    fn stated(&self, start: Option<Start>, axis: Axis) -> Result<Option<bool>, Diag> {
        let Some(start) = start else { return Ok(None) };
        let [first, last] = self.at.map(|p| p.y);
        if (first - last).abs() <= EDGE_GAP_MM {
            let message =
                format!("`--start` does not tell the inlet: both ends of the blade are at one height along {axis}");
            return Err(Diag::error(codes::CONTRADICTS, message)
                .label(self.span, format!("both ends are at {axis} = {} mm", trim(first, 3)))
                .help("leave out `--start`; state `--face inlet=#NUMBER` where the radii do not tell the inlet"));
        }
        Ok(Some((first < last) == (start == Start::LeadingEdge)))
    }

    fn by_radius(&self, axis: Axis, found: &mut Found) -> Result<bool, Diag> {
        let [first, last] = self.at.map(|p| p.x);
        if first.min(last) >= SMALLER * first.max(last) {
            let [a, b] = self.at.map(|p| p.y);
            let [lower, upper] = [a.min(b), a.max(b)].map(|z| trim(z, 3));
            return Err(Diag::error(codes::NOT_STATED, "nothing tells at which end of the blade the inlet is")
                .label(self.span, format!("its ends have the radii {} and {} mm", trim(first, 3), trim(last, 3)))
                .help(format!(
                    "state `--start leading` where the inlet is at {axis} = {lower} mm, `--start trailing` where it is at {axis} = {upper} mm; or `--face inlet=#NUMBER`, a face at the inlet"
                )));
        }
        found.note(
            self.span,
            format!(
                "the end of the blade at the radius {} mm is taken for the inlet, the one at {} mm for the outlet; `--start` or `--face inlet=` says otherwise",
                trim(first.min(last), 3),
                trim(first.max(last), 3)
            ),
        );
        Ok(first < last)
    }
}
