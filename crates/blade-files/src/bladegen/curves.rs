//! Curves of BladeGen: segments with lists of points, of which meridians and values along a blade are made.

use super::named::{ListedPoint, ModelSection, not_read, not_read_at, same};
use crate::angles::meridian as by_length;
use crate::found::{Found, within};
use crate::frame::Frame;
use crate::limits;
use crate::lines::{Line, malformed};
use crate::meridian;
use base::source::Span;
use blade::angles::MeridianByLength;
use blade::angles::limits::{LEAST_LENGTH, MIN_SHARE_STEP, VALUES};
use diagnostics::Diag;
use diagnostics::codes::import as codes;
use nalgebra::Point3;
use nurbs::{NurbsCurve, interpolate};

/// Pieces of a meridian between the points that are written of it: those of splines, which have few, come between their own.
const MERIDIAN_PIECES: f64 = 200.0;

/// Largest gap between two segments of a curve, mm. Files have seven digits or more.
const JOINED: f64 = 1e-3;

/// Largest turn of a meridian from one segment to the next, rad: 5 deg. One curve goes through all of them.
const MAX_MERIDIAN_TURN: f64 = 5.0 * std::f64::consts::PI / 180.0;

/// Largest distance of the first and last value of a curve from 0 % and 100 % of the way. BladeGen writes 99.9992 for 100.
const OFF_ENDS: f64 = 1e-4;

/// A meridional curve.
#[derive(Clone, Debug)]
pub(super) struct MeridionalCurve {
    /// Points (r, z), mm.
    pub(super) points: Vec<[f64; 2]>,
    /// The curve through them.
    pub(super) line: MeridianByLength,
    pub(super) at: Span,
    /// Turns between segments of more than [`MAX_MERIDIAN_TURN`], rad, with the places (r, z) and lines.
    corners: Vec<(f64, [f64; 2], Span)>,
}

impl MeridionalCurve {
    /// Refuses a blade that ends before it begins, by its lengths along the curve, mm, and corners near to it; others are noted.
    pub(super) fn holds_blade(&self, name: &str, [from, to]: [f64; 2], found: &mut Found) -> Result<(), Diag> {
        /// Share of the length of the blade beyond its ends that belongs to the wheel, with a margin.
        const WHEEL_SHARE: f64 = 0.15;
        if to - from < LEAST_LENGTH {
            let label = format!("the blade goes from {from:.3} to {to:.3} mm along this curve");
            return Err(Diag::error(codes::CONTRADICTS, format!("on the {name} the blade ends before it begins"))
                .label(self.at, label)
                .help("let hub and shroud run from inlet to outlet; check that both edges are not exchanged"));
        }
        let beyond = WHEEL_SHARE * (to - from);
        for (turn, place, at) in &self.corners {
            let (length, _) = self.line.nearest(*place);
            let turn = turn.to_degrees();
            if length > from - beyond && length < to + beyond {
                return Err(corner(turn, *at));
            }
            found.note(
                *at,
                format!("the {name} has a corner of {turn:.1} deg here, away from the blades, which is rounded"),
            );
        }
        Ok(())
    }

    /// Refuses corners.
    pub(super) fn smooth(self) -> Result<Self, Diag> {
        self.corners.first().map_or(Ok(()), |(turn, _, at)| Err(corner(turn.to_degrees(), *at)))?;
        Ok(self)
    }
}

/// The fault of a corner, deg.
fn corner(turn: f64, at: Span) -> Diag {
    let message = format!("a meridional curve has a corner of {turn:.1} deg");
    not_read_at(message, at, "this segment leaves the direction of the one before")
}

/// The points of a segment.
fn segment<'b, 't>(block: &'b ModelSection<'t>) -> Result<&'b [ListedPoint<'t>], Diag> {
    block.only(&["CurveType", "UpstreamControl", "DownstreamControl"], &["Data"])?;
    let kind = block.value("CurveType")?.ok_or_else(|| block.missing("CurveType=Spline"))?;
    let data = block.required("Data")?;
    data.only(&[], &[])?;
    if !same(kind.text, "Spline") && !same(kind.text, "Linear") {
        return Err(not_read("this type of a curve is not read", kind.line, "Spline and Linear are read"));
    }
    if same(kind.text, "Linear") && data.points.len() > 2 {
        return Err(not_read("a curve with corners is not read", kind.line, "Linear is read with two points"));
    }
    for control in ["UpstreamControl", "DownstreamControl"] {
        if block.value(control)?.is_some() {
            block.must_be(control, "Free")?;
        }
    }
    if data.points.len() < 2 {
        return Err(malformed("a curve has fewer than two points", data.line.span, "this list"));
    }
    Ok(&data.points)
}

/// The curve of a segment, from (z, r).
fn spline(points: &[ListedPoint<'_>], frame: &Frame) -> Result<NurbsCurve, Diag> {
    let mut placed: Vec<Point3<f64>> = Vec::with_capacity(points.len());
    for ListedPoint { at: [z, r], line } in points {
        let [r, z] = frame.meridian(*r, *z, line.span)?;
        let p = Point3::new(r, 0.0, z);
        if placed.last() == Some(&p) {
            return Err(line.fault("a point is at the place of the one before", "another point is expected"));
        }
        placed.push(p);
    }
    let degree = placed.len().saturating_sub(1).clamp(1, 3);
    interpolate(&placed, degree).map_err(|_| malformed("the points give no curve", first_line(points), "this list"))
}

fn first_line(points: &[ListedPoint<'_>]) -> Span {
    points.first().map_or(Span::default(), |p| p.line.span)
}

/// A meridional curve: hub, shroud, or an edge.
pub(super) fn meridional(block: &ModelSection<'_>, frame: &Frame) -> Result<MeridionalCurve, Diag> {
    block.only(&[], &["Segment"])?;
    let mut splines: Vec<(NurbsCurve, usize, Line<'_>)> = Vec::new();
    let mut corners = Vec::new();
    let mut count = 0;
    for part in block.all("Segment") {
        let points = segment(part)?;
        count += points.len();
        within(count, limits::POINTS_OF_JOB_CURVE / 2, "points of a meridional curve", part.line.span)?;
        let curve = spline(points, frame)?;
        if let Some((before, _, _)) = splines.last() {
            let turn = joined(before, &curve, part.line)?;
            let p = curve.point(0.0);
            corners.extend((turn > MAX_MERIDIAN_TURN).then_some((turn, [p.x, p.z], part.line.span)));
        }
        splines.push((curve, points.len(), part.line));
    }
    if splines.is_empty() {
        return Err(malformed("a curve has no segment", block.line.span, "this curve"));
    }
    let lengths: Vec<f64> = splines.iter().map(|(curve, ..)| curve.length(0.0, 1.0)).collect();
    let whole: f64 = lengths.iter().sum();
    let mut points = Vec::new();
    for ((curve, given, _), length) in splines.iter().zip(&lengths) {
        // A straight line needs no points between its ends, but the curves beside it do.
        let pieces = if splines.len() == 1 && *given == 2 { 1.0 } else { (MERIDIAN_PIECES * length / whole).ceil() };
        let pieces = if pieces.is_finite() { pieces.clamp(1.0, MERIDIAN_PIECES) } else { 1.0 };
        let pieces = (pieces as usize).max(given - 1);
        let from = usize::from(!points.is_empty());
        points.extend((from..=pieces).map(|k| curve.point(k as f64 / pieces as f64)).map(|p| [p.x, p.z]));
    }
    let line =
        by_length(&points).ok_or_else(|| malformed("the points give no curve", block.line.span, "this curve"))?;
    Ok(MeridionalCurve { points, line, at: block.line.span, corners })
}

/// The turn from a segment to the next, rad. Refuses segments that do not follow each other.
fn joined(before: &NurbsCurve, next: &NurbsCurve, line: Line<'_>) -> Result<f64, Diag> {
    let [end, begin] = [before.derivatives(1.0), next.derivatives(0.0)];
    let gap = nalgebra::distance(&end.point, &begin.point);
    if gap > JOINED {
        return Err(Diag::error(codes::CONTRADICTS, format!("two segments of a curve are {gap:.4} mm apart"))
            .label(line.span, "this one begins elsewhere")
            .help("let each segment begin where the one before ends"));
    }
    Ok(end.first.angle(&begin.first))
}

/// Hub or shroud.
pub(super) fn surface(
    name: &str,
    block: &ModelSection<'_>,
    frame: &Frame,
    found: &mut Found,
) -> Result<MeridionalCurve, Diag> {
    let curve = meridional(block, frame)?;
    let points = meridian::checked(name, curve.points, block.line.span, found)?;
    Ok(MeridionalCurve { points, ..curve })
}

/// Values along a blade with their lines: the share of the way, and the value as the file has it.
pub(super) fn values(block: &ModelSection<'_>, off_ends: &mut f64) -> Result<Vec<[f64; 2]>, Diag> {
    block.must_be("HorizDim", "PercentMeridional")?;
    let part = block.required("Segment")?;
    let points = segment(part)?;
    within(points.len(), VALUES, "values of a curve", part.line.span)?;
    let last = points.len() - 1;
    let mut values: Vec<[f64; 2]> = Vec::with_capacity(points.len());
    for (k, ListedPoint { at: [percent, value], line }) in points.iter().enumerate() {
        let share = percent / 100.0;
        let end = if k == last { 1.0 } else { 0.0 };
        let share = if k == 0 || k == last {
            if (share - end).abs() > OFF_ENDS {
                let due = format!("{} % is expected", end * 100.0);
                return Err(not_read("a curve does not go from edge to edge", *line, &due));
            }
            *off_ends = off_ends.max((share - end).abs());
            end
        } else {
            share
        };
        if values.last().is_some_and(|[before, _]| share - before < MIN_SHARE_STEP) {
            return Err(line.fault("values do not follow each other", "0.01 % more than before is expected"));
        }
        values.push([share, *value]);
    }
    Ok(values)
}
