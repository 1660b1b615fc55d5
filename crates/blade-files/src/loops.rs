//! Loops round a blade, closed by the file or not.

use super::found::Found;
use base::source::Span;
use blade::{Section, SectionForm};
use diagnostics::Diag;
use diagnostics::codes::import as codes;
use nalgebra::Point3;

/// Fewest points of a loop: two for each face and each edge.
const MIN_LOOP_POINTS: usize = 8;

/// The first and last point of a closed loop coincide within this share of its length. Files have six digits or more.
const SAME_END_SHARE: f64 = 1e-6;

/// The gap of an open loop is at most this multiple of its longest step. A cut file has a longer one.
const MAX_GAP_STEPS: f64 = 2.0;

/// A loop as the file has it.
#[derive(Debug)]
pub(super) struct ReadLoop {
    pub(super) points: Vec<Point3<f64>>,
    pub(super) span_fraction: Option<f64>,
    /// Where it begins, and its last line.
    pub(super) begins: Span,
    pub(super) ends: Span,
}

/// Sections with the places at which they begin.
pub(super) struct PlacedSections {
    pub(super) sections: Vec<Section>,
    pub(super) places: Vec<Span>,
}

/// Closes the loops of a file, which are all closed or all open in it, and notes which.
pub(super) fn close(loops: Vec<ReadLoop>, found: &mut Found) -> Result<PlacedSections, Diag> {
    let mut sections = Vec::with_capacity(loops.len());
    let places = loops.iter().map(|l| l.begins).collect();
    let mut first: Option<(bool, Span)> = None;
    let mut counts: Option<[usize; 2]> = None;
    for ReadLoop { mut points, span_fraction, begins, ends } in loops {
        let given = points.len();
        if given < MIN_LOOP_POINTS {
            return Err(Diag::error(
                codes::ENDS_EARLY,
                format!("a section has {given} points, fewer than {MIN_LOOP_POINTS}"),
            )
            .label(ends, "its last line")
            .label(begins, "it begins here")
            .help("a section is a loop of points round the blade; export the file again"));
        }
        let steps = || points.windows(2).map(|w| nalgebra::distance(&w[0], &w[1]));
        let (length, longest): (f64, f64) = (steps().sum(), steps().fold(0.0, f64::max));
        let gap = points.first().zip(points.last()).map_or(0.0, |(a, b)| nalgebra::distance(a, b));
        if length <= 0.0 || gap > MAX_GAP_STEPS * longest {
            return Err(Diag::error(codes::ENDS_EARLY, "a section does not come back to its first point")
                .label(ends, format!("{gap:.3} mm from its first point; its longest step has {longest:.3} mm"))
                .label(begins, "it begins here")
                .help("a section is a loop of points round the blade; the file may be cut off"));
        }
        let closed = gap <= SAME_END_SHARE * length;
        if closed {
            points.pop();
        }
        match first {
            Some((before, at)) if before != closed => {
                let [here, there] = [closed, before].map(|c| if c { "repeats" } else { "does not repeat" });
                return Err(Diag::error(codes::ENDS_EARLY, "one section is closed and another one is open")
                    .label(ends, format!("this section {here} its first point at its end"))
                    .label(at, format!("this one {there} it"))
                    .help("the file may be cut off, or a line was lost: export it again"));
            }
            Some(_) => {}
            None => {
                let what = if closed { "repeat" } else { "do not repeat" };
                found.note(begins, format!("the sections {what} their first point at their end"));
                first = Some((closed, ends));
            }
        }
        let [least, most] = counts.unwrap_or([points.len(); 2]);
        counts = Some([least.min(points.len()), most.max(points.len())]);
        sections.push(Section { span: span_fraction, form: SectionForm::Loop(points) });
    }
    if let (Some([least, most]), Some((_, at))) = (counts, first) {
        let points = if least == most { format!("{least}") } else { format!("{least} to {most}") };
        found.note(at, format!("{} sections with {points} points each", sections.len()));
    }
    Ok(PlacedSections { sections, places })
}

/// Refuses a blade with fewer sections than a surface needs.
pub(super) fn enough(count: usize, name: &str, at: Span) -> Result<(), Diag> {
    if count >= 2 {
        return Ok(());
    }
    Err(Diag::error(codes::ENDS_EARLY, format!("the blade `{name}` has {count} sections: at least 2 are needed"))
        .label(at, "the file ends here")
        .help("export a section at the hub and one at the shroud at least"))
}
