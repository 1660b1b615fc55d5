//! What is left of the blank, from an STL file: `from "left.stl"` of the stock.

use super::curves::not_read;
use crate::block::context::Context;
use crate::block::properties::Properties;
use crate::model::StockFile;
use diagnostics::Diag;
use diagnostics::codes::job as codes;
use nalgebra::Point3;
use std::sync::Arc;
use syntax::ast::{Text, Value};
use tool_stock::stock::stl::{self, MAX_TRIANGLES, StlFault};

/// Path of the file. Outer `None`: faulty; inner `None`: the stock is the whole blank.
pub(crate) fn path<'a>(p: &mut Properties<'a, '_>) -> Option<Option<&'a Text>> {
    let Some((word, values)) = p.take("from") else { return Some(None) };
    match values.as_slice() {
        [Value::Text(file)] => Some(Some(file)),
        _ => {
            let span = values.first().map_or(word.span, |v| v.span());
            p.wrong_form(span, "from", "a quoted path", "from \"left.stl\"");
            None
        }
    }
}

/// The solid of the file. Faults go to the sink.
pub(crate) fn read(file: &Text, cx: &mut Context<'_>) -> Option<StockFile> {
    let found = match cx.files.mesh(&file.text) {
        Ok(found) => found,
        Err(missing) => {
            cx.sink.push(not_read("mesh", file, missing));
            return None;
        }
    };
    let source = cx.sources.add_file(found);
    match stl::read(cx.sources.get(source).map_or(&[], |f| f.bytes())) {
        Ok(mesh) => Some(StockFile { file: file.text.clone(), mesh: Arc::new(mesh), span: file.span }),
        Err(fault) => {
            cx.sink.push(diag(file, &fault));
            None
        }
    }
}

/// What to do about a surface that bounds no solid.
const MEND: &str = "mend the mesh in the program that wrote it; the meshes of `--stock FOLDER` are closed";

/// What to give where there is no STL.
const GIVE: &str = "give a binary or text STL file of a closed solid, in mm, such as `--stock FOLDER` writes";

fn diag(file: &Text, fault: &StlFault) -> Diag {
    let (what, help, at) = words(fault);
    let diag = Diag::error(codes::STOCK_FILE, format!("the stock cannot start from `{}`: {what}", file.text))
        .label(file.span, "read here")
        .help(help);
    match at {
        Some(at) => diag.place("the first of these edges", at),
        None => diag,
    }
}

/// Reason and way out, and a place in the part frame.
fn words(fault: &StlFault) -> (String, &'static str, Option<Point3<f64>>) {
    let (what, help) = match fault {
        StlFault::Empty => ("it is empty".to_owned(), GIVE),
        StlFault::NotStl => {
            let what = "it is no STL file: it neither begins with `solid`, nor is it as long as its number of triangles, \
                        bytes 81 to 84, requires";
            (what.to_owned(), GIVE)
        }
        StlFault::Truncated { announced, found } => (
            format!("it ends after {found} of {announced} triangles"),
            "write or copy the file again; its end is missing",
        ),
        StlFault::Line { line, due } => {
            (format!("line {line} is not {due}"), "write or copy the file again, as binary STL if possible")
        }
        StlFault::End { due } => (format!("it ends before {due}"), "write or copy the file again; its end is missing"),
        StlFault::NoTriangles => ("it has no triangle with an area".to_owned(), GIVE),
        StlFault::TooMany { triangles } => (
            format!("it has {triangles} triangles or more; {MAX_TRIANGLES} are possible"),
            "write a coarser mesh, such as `--stock FOLDER` with a larger `--stock-cell`",
        ),
        StlFault::Coordinate { triangle } => (
            format!("a corner of triangle {triangle} is not three numbers within 10 m"),
            "write the file again, in mm and in the frame of the part",
        ),
        StlFault::Needles => (
            "its triangles are long needles in such numbers that they cannot be cut into rays".to_owned(),
            "mesh the solid again with an upper bound of the length of edges",
        ),
        StlFault::Open { edges, .. } => {
            (format!("its surface is not closed: an odd number of triangles meets at {edges} edges"), MEND)
        }
        StlFault::Turned { edges, .. } => {
            (format!("neighbouring triangles have their outside on different sides, at {edges} edges"), MEND)
        }
        StlFault::InsideOut => (
            "it is inside out: its triangles are clockwise, seen from outside".to_owned(),
            "turn all triangles; corners of STL run counter-clockwise, seen from outside",
        ),
        StlFault::NoVolume => ("its surface encloses nothing".to_owned(), MEND),
    };
    let at = match fault {
        StlFault::Open { at, .. } | StlFault::Turned { at, .. } => Some(*at),
        _ => None,
    };
    (what, help, at)
}
