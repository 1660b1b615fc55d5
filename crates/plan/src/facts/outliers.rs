//! Data points that break the pattern of the others.
//!
//! The two sides of a vane are compared row by row in cylinder coordinates: the differences in angle, radius and height
//! from pressure to suction side are smooth from inlet to outlet on any vane. A row is likely a misprint when its
//! distance from the line through its neighbours is several times that of the other rows.

use diagnostics::codes::geometry as codes;
use diagnostics::{Diag, Sink};
use ir::DataCurve;
use nalgebra::Point3;
use wheel::part::{BladeId, FaceId, RulingEnd};

/// A point that breaks the pattern.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outlier {
    /// Face.
    pub side: FaceId,
    /// End of the rulings.
    pub end: RulingEnd,
    /// Index of the point, from 0.
    pub row: usize,
    /// Coordinate that breaks the pattern.
    pub pattern: Pattern,
    /// Difference from pressure to suction side at this row: radians or mm.
    pub value: f64,
    /// Difference that the other rows give there.
    pub expected: f64,
    /// The point that would fit the pattern.
    pub suggestion: Point3<f64>,
}

/// Coordinate in which the sides are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pattern {
    /// Angle about Z.
    Angle,
    /// Distance from Z.
    Radius,
    /// Z.
    Height,
}

/// Fewest rows that show a pattern.
const MIN_ROWS: usize = 5;

/// Least distance of an outlier, in multiples of the roughness of the other rows. Gaussian noise reaches 5 sigma once
/// in two million rows.
const BREAK: f64 = 5.0;

/// Least distance that is reported, mm: tables are printed to a tenth of a micrometre, parts are milled to a few
/// micrometres.
const MIN_REPORTED_MM: f64 = 0.02;

/// Points that break the pattern, at most one for each row of a table.
pub fn find(data: &[DataCurve]) -> Vec<Outlier> {
    let mut found: Vec<Outlier> = Vec::new();
    for end in [RulingEnd::Tip, RulingEnd::Root] {
        let curve = |side| data.iter().find(|c| c.side == side && c.end == end).map(|c| &c.points);
        let [Some(p), Some(s)] = BladeId::MAIN.faces().map(curve) else { continue };
        if p.len() != s.len() || p.len() < MIN_ROWS {
            continue;
        }
        let tables = [p, s].map(|t| t.iter().map(|d| d.point).collect::<Vec<_>>());
        for pattern in [Pattern::Angle, Pattern::Radius, Pattern::Height] {
            for outlier in breaks(&tables, end, pattern) {
                if !found.iter().any(|o| o.end == end && o.row == outlier.row) {
                    found.push(outlier);
                }
            }
        }
    }
    found
}

/// Angles without jumps of a full turn, or radii, or heights.
fn values(points: &[Point3<f64>], pattern: Pattern) -> Vec<f64> {
    let mut values = Vec::with_capacity(points.len());
    let mut before = 0.0;
    for p in points {
        before = match pattern {
            Pattern::Angle => before + super::channel::turn_between(before, libm::atan2(p.y, p.x)),
            Pattern::Radius => libm::hypot(p.x, p.y),
            Pattern::Height => p.z,
        };
        values.push(before);
    }
    values
}

/// Value at row k by linear interpolation between the nearest of `rows` on both sides; at an end, by extrapolation from
/// the two nearest rows.
fn expectation(values: &[f64], rows: &[usize], k: usize) -> Option<f64> {
    let below: Vec<usize> = rows.iter().copied().filter(|r| *r < k).collect();
    let above: Vec<usize> = rows.iter().copied().filter(|r| *r > k).collect();
    let (a, b) = match (&below[..], &above[..]) {
        ([.., a], [b, ..]) => (*a, *b),
        ([], [a, b, ..]) | ([.., a, b], []) => (*a, *b),
        _ => return None,
    };
    let t = (k as f64 - a as f64) / (b as f64 - a as f64);
    Some(values[a] * (1.0 - t) + values[b] * t)
}

/// Root mean square distance of the inner rows from the line through their neighbours.
fn roughness(values: &[f64], rows: &[usize]) -> f64 {
    let inner = rows.get(1..rows.len().saturating_sub(1)).unwrap_or_default();
    let squares: Vec<f64> =
        inner.iter().filter_map(|k| expectation(values, rows, *k).map(|e| (values[*k] - e).powi(2))).collect();
    (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
}

fn breaks(tables: &[Vec<Point3<f64>>; 2], end: RulingEnd, pattern: Pattern) -> Vec<Outlier> {
    let own = [0, 1].map(|i| values(&tables[i], pattern));
    let between: Vec<f64> = match pattern {
        Pattern::Angle => own[0].iter().zip(&own[1]).map(|(p, s)| super::channel::turn_between(*p, *s)).collect(),
        _ => own[0].iter().zip(&own[1]).map(|(p, s)| s - p).collect(),
    };
    let mut rows: Vec<usize> = (0..between.len()).collect();
    let mut found = Vec::new();
    while rows.len() >= MIN_ROWS {
        // The row without which the others are smoothest; only rows that break the pattern of the others count.
        let candidate = rows.iter().filter_map(|k| {
            let others: Vec<usize> = rows.iter().copied().filter(|r| r != k).collect();
            let expected = expectation(&between, &others, *k)?;
            let gap = (between[*k] - expected).abs();
            let scale = if pattern == Pattern::Angle { libm::hypot(tables[0][*k].x, tables[0][*k].y) } else { 1.0 };
            let rough = roughness(&between, &others);
            (gap > BREAK * rough && gap * scale > MIN_REPORTED_MM).then_some((*k, expected, rough))
        });
        let Some((row, expected, _)) = candidate.min_by(|a, b| a.2.total_cmp(&b.2)) else { break };
        rows.retain(|r| *r != row);
        // The fault is on the side that deviates further from its own curve.
        let fault = [0, 1].map(|i| own_break(&own[i], &rows, row));
        let side = usize::from(fault[1] > fault[0]);
        let sign = if side == 0 { 1.0 } else { -1.0 };
        let change = sign * (between[row] - expected);
        found.push(Outlier {
            side: BladeId::MAIN.faces()[side],
            end,
            row,
            pattern,
            value: between[row],
            expected,
            suggestion: moved(&tables[side][row], pattern, change),
        });
    }
    found
}

/// Distance of a row from the cubic through the four nearest of the other rows of its own curve. A cubic is needed
/// because a curve itself has more curvature than the difference between two curves.
fn own_break(values: &[f64], others: &[usize], row: usize) -> f64 {
    let mut nearest = others.to_vec();
    nearest.sort_by_key(|k| k.abs_diff(row));
    nearest.truncate(4);
    let expected: f64 = nearest
        .iter()
        .map(|k| {
            let weight: f64 = nearest
                .iter()
                .filter(|j| *j != k)
                .map(|j| (row as f64 - *j as f64) / (*k as f64 - *j as f64))
                .product();
            values[*k] * weight
        })
        .sum();
    (values[row] - expected).abs()
}

fn moved(p: &Point3<f64>, pattern: Pattern, change: f64) -> Point3<f64> {
    let (radius, angle) = (libm::hypot(p.x, p.y), libm::atan2(p.y, p.x));
    match pattern {
        Pattern::Angle => Point3::new(radius * libm::cos(angle + change), radius * libm::sin(angle + change), p.z),
        Pattern::Radius => Point3::new((radius + change) * libm::cos(angle), (radius + change) * libm::sin(angle), p.z),
        Pattern::Height => Point3::new(p.x, p.y, p.z + change),
    }
}

impl Outlier {
    /// Warns at the text of the point, where it is known.
    pub fn report(&self, data: &[DataCurve], sink: &mut Sink) {
        let (what, value, expected) = match self.pattern {
            Pattern::Angle => {
                let deg = |x: f64| format!("{:.2} deg", x.to_degrees().abs());
                ("the angle", deg(self.value), deg(self.expected))
            }
            Pattern::Radius => ("the difference in radius", mm(self.value), mm(self.expected)),
            Pattern::Height => ("the difference in height", mm(self.value), mm(self.expected)),
        };
        let name = format!("point {} of the {} {}", self.row + 1, self.side.name(), self.end.name());
        let s = self.suggestion;
        let mut diag = Diag::warning(codes::OUTLIER, format!("{name} does not fit the other points"))
            .note(format!("{what} between the faces is {value} there; by the other points {expected} is expected"))
            .help(format!(
                "compare the point with the drawing; ({:.4}, {:.4}, {:.4}) fits the other points. The point is used as given",
                s.x, s.y, s.z
            ));
        let curve = data.iter().find(|c| c.side == self.side && c.end == self.end);
        if let Some(point) = curve.and_then(|c| c.points.get(self.row)) {
            diag = diag.place(name, point.point);
            if let Some(span) = point.span {
                diag = diag.label(span, "this point");
            }
        }
        sink.push(diag);
    }
}

fn mm(x: f64) -> String {
    format!("{x:.4} mm")
}
