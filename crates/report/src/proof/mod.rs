//! The figures of a proof as people read them. Each subject is one table, from which every text takes its columns.

pub(crate) mod alike;
pub mod contracts;
pub mod details;
pub mod head;
pub(crate) mod machine;
pub(crate) mod operations;
pub(crate) mod stock;
pub mod summary;
pub mod surfaces;

use crate::table::Figure;
use base::units::Mm;
use verify::clearance::Clearance;
use verify::surface::FAR;

/// A text that shows the tables.
#[derive(Clone, Copy)]
pub(crate) enum Text<'a> {
    /// What a run prints.
    Summary,
    /// What it prints with `--details`.
    Details,
    /// The page of the report: where a click on a figure of a row leads, by the numbers of both.
    Page(&'a dyn Fn(usize, usize) -> Option<usize>),
    /// The setup sheet.
    Sheet,
}

impl Text<'_> {
    /// Place on the page of a figure of a row.
    fn place(self, row: usize, figure: usize) -> Option<usize> {
        match self {
            Self::Page(places) => places(row, figure),
            _ => None,
        }
    }
}

/// Text in place of a figure where no cutter comes near.
pub(crate) const NOT_REACHED: &str = "not reached";

/// A distance from a surface to the cutters.
pub(crate) fn reached(Mm(mm): Mm) -> Figure {
    if mm >= FAR { Figure::Words(NOT_REACHED.to_owned()) } else { Figure::Number(mm) }
}

/// A clearance; `far` where nothing is within the search.
fn clearance(found: Option<&Clearance>, far: &str) -> Figure {
    Figure::or(found.map(|c| c.distance), far)
}

/// Coordinates, mm.
fn coordinates([x, y, z]: [f64; 3]) -> String {
    format!("({x:.3}, {y:.3}, {z:.3})")
}
