//! Which end of the hub is the inlet: by an edge that was picked, otherwise the end of the blade nearer to the axis.

use super::face::StepFace;
use super::meridian::{StepMeridian, flat};
use crate::diag::Diag;
use crate::diag::codes::import as codes;
use crate::import::found::Found;
use crate::units::trim;
use nalgebra::Vector2;

/// Radii of both ends of a blade are different where their ratio is below this.
const SMALLER: f64 = 0.95;

/// Of the points of borders, one in so many counts.
const COUNTED: usize = 64;

fn points(face: &StepFace) -> Vec<Vector2<f64>> {
    face.borders.iter().flatten().flat_map(|edge| edge.points.iter().step_by(COUNTED)).map(flat).collect()
}

/// Mean length along the hub to the points of faces, mm.
fn mean(hub: &StepMeridian, faces: &[StepFace]) -> f64 {
    let points: Vec<Vector2<f64>> = faces.iter().flat_map(points).collect();
    points.iter().map(|p| hub.nearest(p)[0]).sum::<f64>() / points.len().max(1) as f64
}

/// The meridian of the hub from inlet to outlet. `blade` has the pressure and the suction face, `ends` the faces that are picked
/// at inlet and outlet.
pub(super) fn run_from_inlet(
    hub: StepMeridian,
    blade: &[StepFace],
    ends: [Vec<StepFace>; 2],
    found: &mut Found,
) -> Result<StepMeridian, Diag> {
    let middle = mean(&hub, blade);
    let [inlet, outlet] = ends.each_ref().map(|faces| faces.first().map(|face| (mean(&hub, faces), face)));
    let forward = [inlet.map(|(at, face)| (at < middle, face)), outlet.map(|(at, face)| (at > middle, face))];
    match forward {
        [Some((a, inlet)), Some((b, outlet))] if a != b => {
            Err(Diag::error(codes::CONTRADICTS, "the edges at inlet and outlet are at one end of the blade")
                .label(inlet.span, format!("#{} is the inlet edge", inlet.number))
                .label(outlet.span, format!("#{} is the outlet edge", outlet.number))
                .help("pick other edges with `--face inlet=` and `--face outlet=`"))
        }
        [Some((forward, face)), _] | [None, Some((forward, face))] => {
            found.note(face.span, format!("#{} `{}` tells the inlet", face.number, face.name));
            Ok(if forward { hub } else { hub.reversed() })
        }
        [None, None] => by_radius(hub, blade, found),
    }
}

fn by_radius(hub: StepMeridian, blade: &[StepFace], found: &mut Found) -> Result<StepMeridian, Diag> {
    let places: Vec<[f64; 2]> = blade.iter().flat_map(points).map(|p| [hub.nearest(&p)[0], p.x]).collect();
    let by = |a: &&[f64; 2], b: &&[f64; 2]| a[0].total_cmp(&b[0]);
    let ends = places.iter().min_by(by).zip(places.iter().max_by(by));
    let [first, last] = ends.map_or([0.0; 2], |(a, b)| [a[1], b[1]]);
    let span = blade.first().map(|face| face.span);
    if first.min(last) >= SMALLER * first.max(last) {
        return Err(Diag::error(codes::NOT_STATED, "nothing tells at which end of the blade the inlet is")
            .label(
                span.unwrap_or_default(),
                format!("its ends have the radii {} and {} mm", trim(first, 3), trim(last, 3)),
            )
            .help("state `--face inlet=#NUMBER`: a face at the inlet, such as the edge of the blade"));
    }
    found.note(
        span,
        format!(
            "the end of the blade at the radius {} mm is taken for the inlet, the one at {} mm for the outlet; `--face inlet=` says otherwise",
            trim(first.min(last), 3),
            trim(first.max(last), 3)
        ),
    );
    Ok(if first < last { hub } else { hub.reversed() })
}
