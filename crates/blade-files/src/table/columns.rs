//! Columns of a table of points and what they mean.

use super::super::found::Found;
use super::super::frame::{Axis, Frame};
use super::super::header_unit;
use super::super::lines::Line;
use super::super::stated::not_stated;
use base::source::Span;
use diagnostics::codes::import as codes;
use diagnostics::{Diag, printable};
use nalgebra::Point3;

/// Meaning of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Column {
    X,
    Y,
    Z,
    /// Distance from the axis.
    R,
    /// Distance from the axis times angle about the axis in radians.
    Arc,
    Degrees,
    Radians,
    Thickness,
    Blade,
    Section,
    /// Share of the height from hub (0) to shroud (1).
    Span,
    Face,
    /// `hub` or `shroud`.
    Curve,
    Skipped,
}

/// Words for columns. Of other signs than letters and digits only the star and the dash of the words count, see [`plain`].
const WORDS: &[(&str, Column)] = &[
    ("x", Column::X),
    ("y", Column::Y),
    ("z", Column::Z),
    ("r", Column::R),
    ("rtheta", Column::Arc),
    ("rth", Column::Arc),
    ("thetadeg", Column::Degrees),
    ("thetarad", Column::Radians),
    ("thickness", Column::Thickness),
    ("blade", Column::Blade),
    ("section", Column::Section),
    ("span", Column::Span),
    ("face", Column::Face),
    ("side", Column::Face),
    ("curve", Column::Curve),
    ("number", Column::Skipped),
    ("skip", Column::Skipped),
];

/// What the option takes.
const VALUES: &str =
    "a list of x, y, z, r, rtheta, theta-deg, theta-rad, thickness, blade, section, span, face, curve and skip";

/// A word for a column in lower case, without signs: `R*THETA` is `rtheta`.
fn plain(word: &str) -> String {
    word.chars().filter(char::is_ascii_alphanumeric).map(|c| c.to_ascii_lowercase()).collect()
}

/// Where the coordinates of a point stand.
#[derive(Clone, Copy, Debug)]
pub(super) enum Coordinates {
    /// Columns of x, y and z.
    Cartesian([usize; 3]),
    /// Columns along the axis, of the radius, of the angle, and the kind of the latter.
    Cylindrical([usize; 3], Column),
    /// Columns along the axis and of the radius.
    Meridian([usize; 2]),
}

/// The columns of a file.
#[derive(Clone, Debug)]
pub(super) struct Columns {
    all: Vec<Column>,
    pub(super) coordinates: Coordinates,
    /// Axis of rotation that the columns name: the coordinate that is neither radius nor angle.
    pub(super) axis: Option<Axis>,
    at: Span,
}

/// Whether a line has words where a table has numbers.
pub(super) fn is_header(line: Line<'_>) -> bool {
    line.fields().iter().all(|field| line.number(field).is_err() && !field.is_empty())
}

impl Columns {
    /// Columns of the header of a file.
    pub(super) fn of_header(line: Line<'_>, found: &mut Found) -> Result<Self, Diag> {
        let column = |word: &str, found: &mut Found| {
            // `x [m]` is the column `x`: the unit is that of the file.
            let (word, _) = header_unit::column(word);
            let known = WORDS.iter().find(|(w, _)| *w == plain(word)).map(|(_, column)| *column);
            match known {
                None if plain(word) == "theta" => Err(not_stated("unit of the angle", "--columns", VALUES, line.span)),
                None => {
                    found.note(line.span, format!("the column `{}` is not used", printable(word)));
                    Ok(Column::Skipped)
                }
                Some(column) => Ok(column),
            }
        };
        let all: Result<Vec<Column>, Diag> = line.fields().into_iter().map(|word| column(word, found)).collect();
        let columns = Self::new(all?, line.span)?;
        found.note(line.span, format!("the columns are {}", line.fields().join(", ")));
        Ok(columns)
    }

    /// Columns that the caller states.
    pub(super) fn of_words(words: &[String], at: Span) -> Result<Self, Diag> {
        let column = |word: &String| {
            WORDS.iter().find(|(w, _)| *w == plain(word)).map(|(_, column)| *column).ok_or_else(|| {
                Diag::error(codes::NOT_STATED, format!("there is no column `{}`", printable(word)))
                    .label(at, "in this file")
                    .help(format!("state `--columns`: {VALUES}"))
            })
        };
        Self::new(words.iter().map(column).collect::<Result<_, _>>()?, at)
    }

    /// The fault of a file without a header, for which the caller states no columns either.
    pub(super) fn missing(at: Span) -> Diag {
        not_stated("meaning of its columns", "--columns", VALUES, at)
    }

    fn new(all: Vec<Column>, at: Span) -> Result<Self, Diag> {
        let place = |column: Column| all.iter().position(|c| *c == column);
        for (k, column) in all.iter().enumerate() {
            if *column != Column::Skipped && place(*column) != Some(k) {
                return Err(Diag::error(codes::CONTRADICTS, "two columns have the same meaning")
                    .label(at, "in this line or file")
                    .help("give each column its own word; `skip` leaves one out"));
            }
        }
        let angles = [Column::Arc, Column::Degrees, Column::Radians];
        let angle = angles.into_iter().find_map(|kind| Some((place(kind)?, kind)));
        let cartesian = [Column::X, Column::Y, Column::Z].map(place);
        let along: Vec<(usize, Axis)> = cartesian
            .into_iter()
            .zip([Axis::X, Axis::Y, Axis::Z])
            .filter_map(|(place, axis)| Some((place?, axis)))
            .collect();
        let (coordinates, axis) = match (cartesian, place(Column::R), angle, along.as_slice()) {
            ([Some(x), Some(y), Some(z)], None, None, _) => (Coordinates::Cartesian([x, y, z]), None),
            (_, Some(r), Some((angle, kind)), [(z, axis)]) => {
                (Coordinates::Cylindrical([*z, r, angle], kind), Some(*axis))
            }
            (_, Some(r), None, [(z, axis)]) => (Coordinates::Meridian([*z, r]), Some(*axis)),
            _ => {
                return Err(Diag::error(codes::NOT_STATED, "the columns do not give points")
                    .label(at, "in this line or file")
                    .note("points are x, y, z; or one of them along the axis, r, and rtheta, theta-deg or theta-rad")
                    .note("points of hub and shroud are one of x, y, z along the axis, and r")
                    .help(format!("state `--columns`: {VALUES}")));
            }
        };
        Ok(Self { all, coordinates, axis, at })
    }

    /// Number of columns.
    pub(super) fn count(&self) -> usize {
        self.all.len()
    }

    /// Whether the columns mean the same.
    pub(super) fn means_the_same(&self, other: &Self) -> bool {
        self.all == other.all
    }

    /// Line of the header.
    pub(super) fn at(&self) -> Span {
        self.at
    }

    /// The word of a column in a line.
    pub(super) fn word<'t>(&self, column: Column, fields: &[&'t str]) -> Option<&'t str> {
        fields.get(self.all.iter().position(|c| *c == column)?).copied()
    }

    /// The number of a column in a line; `None` without such a column.
    pub(super) fn number(&self, column: Column, line: Line<'_>, fields: &[&str]) -> Result<Option<f64>, Diag> {
        self.word(column, fields).map(|word| line.number(word)).transpose()
    }

    /// The point of a line, in the part frame. That of a meridian lies at angle zero.
    pub(super) fn point(&self, line: Line<'_>, fields: &[&str], frame: &Frame) -> Result<Point3<f64>, Diag> {
        let number = |at: usize| line.number(fields.get(at).copied().unwrap_or_default());
        match self.coordinates {
            Coordinates::Cartesian([x, y, z]) => frame.point([number(x)?, number(y)?, number(z)?], line.span),
            Coordinates::Meridian([z, r]) => frame.cylindrical(number(r)?, 0.0, number(z)?, line.span),
            Coordinates::Cylindrical([z, r, angle], kind) => {
                let (r, angle) = (number(r)?, number(angle)?);
                let theta = match kind {
                    Column::Degrees => angle.to_radians(),
                    Column::Arc if r == 0.0 => {
                        return Err(line.fault("the radius is zero", "R*THETA gives no angle there"));
                    }
                    Column::Arc => angle / r,
                    _ => angle,
                };
                frame.cylindrical(r, theta, number(z)?, line.span)
            }
        }
    }
}
