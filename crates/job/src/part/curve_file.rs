//! Points of curves from a file of comma separated values: `curve,number,x,y,z`; `#` begins a comment. In closed sections of a blade
//! a point of an edge may have `leading-edge` or `trailing-edge` as a sixth value; without them the edges are found.

use crate::block::eval::unknown;
use base::source::{SourceId, SourceMap, Span};
use blade::{LOOP_EDGES, LoopEdges};
use blade_files::limits;
use diagnostics::codes::job as codes;
use diagnostics::{Diag, Sink};
use std::collections::BTreeSet;
use syntax::ast::{Name, Text};

/// Most points of a curve. Splines of measured blades have hundreds.
pub(super) const MAX_POINTS: usize = limits::POINTS_OF_JOB_CURVE;

/// Most sections of a blade that are closed loops. Designers give some 5 to 30, measuring machines up to 100.
pub(super) const MAX_LOOPS: usize = limits::SECTIONS_OF_JOB;

/// A curve of a file.
pub(super) struct FileCurve {
    /// Its name.
    pub(super) name: String,
    /// Its points, without unit.
    pub(super) points: Vec<[f64; 3]>,
    /// Places of their lines.
    pub(super) spans: Vec<Span>,
    /// Which edge each point belongs to: 0 the leading, 1 the trailing one.
    on_edge: Vec<Option<usize>>,
}

impl FileCurve {
    /// The edges of a closed curve, where its points state them; the sink holds the fault of edges that are no edges.
    pub(super) fn edges(&self, file: &Text, sink: &mut Sink) -> Option<Option<LoopEdges>> {
        if self.on_edge.iter().all(Option::is_none) {
            return Some(None);
        }
        let count = self.on_edge.len();
        let ends = |edge: usize| {
            let on = |k: usize| self.on_edge[k % count] == Some(edge);
            let firsts: Vec<usize> = (0..count).filter(|k| on(*k) && !on(k + count - 1)).collect();
            let [first] = firsts[..] else { return Err(firsts.get(1).copied().unwrap_or(0)) };
            let points = (first..first + count).take_while(|k| on(*k)).count();
            if points < 2 { Err(first) } else { Ok([first, (first + points - 1) % count]) }
        };
        match [ends(0), ends(1)] {
            [Ok(leading), Ok(trailing)] => Some(Some([leading, trailing])),
            [leading, trailing] => {
                let (edge, at) = leading.map_or_else(|at| (0, at), |_| (1, trailing.err().unwrap_or(0)));
                let what = format!("`{}` of {} is not one row of two points or more", LOOP_EDGES[edge], self.name);
                sink.push(
                    fault(self.spans[at], file, what)
                        .help("state both edges of a section, each for the points from face to face, or neither"),
                );
                None
            }
        }
    }
}

/// A curve of a file; the numbers of its points count from 1 without a gap.
pub(super) fn read(
    source: SourceId,
    sources: &SourceMap,
    file: &Text,
    curve: &Name,
    sink: &mut Sink,
) -> Option<FileCurve> {
    let mut names: BTreeSet<String> = BTreeSet::new();
    let wanted = |name: &str| {
        if !names.contains(name) {
            names.insert(name.to_owned());
        }
        name == curve.text
    };
    let found = curves(source, sources, file, wanted, sink)?.pop();
    let marked =
        found.as_ref().and_then(|curve| curve.on_edge.iter().position(Option::is_some).map(|k| curve.spans[k]));
    if let Some(span) = marked {
        sink.push(fault(span, file, "only closed sections of a blade have points of edges".to_owned()));
        return None;
    }
    if found.is_none() {
        sink.push(unknown(&curve.text, curve.span, "curve", names.iter().map(String::as_str)));
    }
    found
}

/// All curves of a file, in their order.
pub(super) fn read_all(source: SourceId, sources: &SourceMap, file: &Text, sink: &mut Sink) -> Option<Vec<FileCurve>> {
    curves(source, sources, file, |_| true, sink)
}

/// The curves of a file whose names are wanted, in their order. A curve with too many points ends the search: the caller
/// refuses it.
fn curves(
    source: SourceId,
    sources: &SourceMap,
    file: &Text,
    mut wanted: impl FnMut(&str) -> bool,
    sink: &mut Sink,
) -> Option<Vec<FileCurve>> {
    let text = &sources.get(source)?.text;
    // Spreadsheets mark their texts.
    let mark = text.len() - text.trim_start_matches('\u{feff}').len();
    let text = &text[mark..];
    if let Some(fault) = no_table(text) {
        sink.push_first(
            Diag::error(codes::CURVE_FILE, format!("the curve file `{}` is not a table of points", file.text))
                .label(file.span, "read here")
                .note(fault)
                .help("write each line as `curve,number,x,y,z`; a comment begins with #"),
        );
        return None;
    }
    let mut found: Vec<FileCurve> = Vec::new();
    let mut good = true;
    let mut start = mark;
    for raw in text.split_inclusive('\n') {
        let range = start..start + raw.trim_end().len();
        start += raw.len();
        let line = raw.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let span = Span::new(source, range);
        let fields: Vec<&str> = line.split(',').map(str::trim).collect();
        let name = fields.first().copied().unwrap_or_default();
        let edge = match edge_of(&fields) {
            Ok(edge) => edge,
            Err(what) => {
                sink.push_first(fault(span, file, what));
                return None;
            }
        };
        if !wanted(name) {
            continue;
        }
        // Points of a curve mostly follow each other.
        let at = found.iter().rposition(|curve| curve.name == name).unwrap_or_else(|| {
            found.push(FileCurve { name: name.to_owned(), points: Vec::new(), spans: Vec::new(), on_edge: Vec::new() });
            found.len() - 1
        });
        let curve = &mut found[at];
        if let Some(what) = wrong_number(fields.get(1).and_then(|f| f.parse().ok()), curve) {
            // One row that is missing shifts the numbers of all behind it.
            sink.push_first(fault(span, file, what));
            good = false;
        }
        let [x, y, z] = match coordinates(&fields) {
            Ok(point) => point,
            Err(what) => {
                sink.push_first(fault(span, file, what));
                return None;
            }
        };
        curve.points.push([x, y, z]);
        curve.spans.push(span);
        curve.on_edge.push(edge);
        if curve.points.len() > MAX_POINTS || found.len() > MAX_LOOPS {
            break;
        }
    }
    good.then_some(found)
}

/// What is wrong with the number of the next point of a curve.
fn wrong_number(given: Option<usize>, curve: &FileCurve) -> Option<String> {
    let (name, due) = (&curve.name, curve.points.len() + 1);
    match given {
        Some(given) if given == due => None,
        Some(given) if given < due => {
            Some(format!("point {given} of {name} is given twice; number {due} is expected here"))
        }
        _ => Some(format!("number {due} of {name} is expected here: a line may be missing, or have another name")),
    }
}

/// The coordinates of a line; or what is wrong with the first that is no number.
fn coordinates(fields: &[&str]) -> Result<[f64; 3], String> {
    let mut point = [0.0; 3];
    for (k, name) in ["x", "y", "z"].into_iter().enumerate() {
        let field = fields.get(k + 2).copied().unwrap_or_default();
        let first = field.split_whitespace().next().unwrap_or_default();
        point[k] = match field.parse::<f64>() {
            Ok(value) if value.is_finite() => value,
            _ if field.contains(['\u{2212}', '\u{2013}']) => {
                return Err("another sign stands for minus: write `-`".to_owned());
            }
            _ if field.is_empty() => return Err(format!("{name} is missing")),
            _ if first != field && first.parse::<f64>().is_ok() => {
                return Err(format!(
                    "{name} has a unit: the unit of all points stands in the job, behind the name of the curve"
                ));
            }
            _ => return Err(format!("{name} is no finite number")),
        };
    }
    Ok(point)
}

/// The edge that the sixth field of a line names, if any; what is wrong with fields of another number or form.
fn edge_of(fields: &[&str]) -> Result<Option<usize>, String> {
    let numbers = |fields: &[&str]| fields.iter().all(|f| f.parse::<f64>().is_ok());
    match fields {
        [_, _, _, _, _] => Ok(None),
        [_, _, _, _, _, word] if !numbers(&fields[1..]) => match LOOP_EDGES.iter().position(|edge| edge == word) {
            Some(edge) => Ok(Some(edge)),
            None => Err(format!("the sixth value is `{}` or `{}`", LOOP_EDGES[0], LOOP_EDGES[1])),
        },
        [_, _, _, _, _, _, ..] => {
            Err(format!("the line has {} fields, not 5: the decimal sign is a point", fields.len()))
        }
        [line] if line.contains(';') => Err("`;` separates the fields; here commas do".to_owned()),
        [line] if line.contains('\t') => Err("tabs separate the fields; here commas do".to_owned()),
        _ => Err(format!("the line has {} fields, not 5", fields.len())),
    }
}

/// Whether a line has the required form: a plain name, a whole number, three coordinates.
fn is_point(line: &str) -> bool {
    let fields: Vec<&str> = line.split(',').map(str::trim).collect();
    let fields = if fields.len() == 6 { &fields[..5] } else { &fields[..] };
    let [name, number, coordinates @ ..] = fields else { return false };
    let plain = |c: char| c.is_alphanumeric() || matches!(c, '_' | '-' | '.' | ' ');
    !name.is_empty()
        && name.chars().all(plain)
        && number.parse::<usize>().is_ok()
        && coordinates.len() == 3
        && coordinates.iter().all(|c| c.parse::<f64>().is_ok())
}

/// Why a text is not a table of points. The reason quotes nothing of the text, since the file may be private. A table
/// may have some faulty lines, which are shown, but most of its lines must have the required form.
fn no_table(text: &str) -> Option<String> {
    if let Some(at) = text.lines().position(|line| line.chars().any(|c| c.is_control() && c != '\t')) {
        return Some(format!("line {} has a control character", at + 1));
    }
    let lines = text.lines().zip(1..).map(|(line, number)| (line.trim(), number));
    let (mut good, mut bad, mut first) = (0_usize, 0_usize, 0);
    for (line, number) in lines.filter(|(line, _)| !(line.is_empty() || line.starts_with('#'))) {
        if is_point(line) {
            good += 1;
        } else {
            bad += 1;
            first = if first == 0 { number } else { first };
        }
    }
    let separated = text.lines().filter(|line| line.matches(';').count() >= 4).count();
    let few = text.lines().filter(|line| !line.starts_with('#') && line.matches(',').count() == 3).count();
    let cause = if separated > good {
        ": columns are separated by `;`; here commas separate them, and the decimal sign is a point"
    } else if few > good {
        ": they have 4 values, so that the curve or the number of the point in it is missing"
    } else {
        ""
    };
    (bad > good)
        .then(|| format!("{bad} of its {} lines have another form, the first of them line {first}{cause}", good + bad))
}

fn fault(span: Span, file: &Text, what: String) -> Diag {
    Diag::error(codes::CURVE_FILE, format!("the curve file `{}` has a fault", file.text))
        .label(span, what)
        .label(file.span, "read here")
        .help("write each line as `curve,number,x,y,z`; a comment begins with #")
}
