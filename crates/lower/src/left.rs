//! Whether what is left of the blank can be: inside of the turned blank, and enough for the part.

use base::units::length;
use diagnostics::codes::geometry as codes;
use diagnostics::{Diag, Sink};
use job::model::StockFile;
use wheel::part::{Part, Stock, solid};

/// Largest distance by which the file may stand out of the turned blank, mm. What stands out is cut off. A mesh of
/// `--stock` fills inner edges of the blank; a right angle by 0.36 cells, which have 1 mm on parts up to 200 mm.
const MAX_OUT: f64 = 0.5;

/// Least volume of what is left, as a share of that of the part: a mesh of 1 mm cells rounds thin edges, an inch file has a
/// share of 1 / 16 387.
const LEAST_SHARE: f64 = 0.9;

/// Reports what does not fit.
pub(super) fn check(file: &StockFile, part: &Part, stock: &Stock, sink: &mut Sink) {
    if let Some((at, out)) = stock.farthest_out(MAX_OUT) {
        sink.push(
            Diag::error(
                codes::LEFT_OUTSIDE,
                format!("the solid of `{}` stands {} out of the turned blank", file.file, length(out)),
            )
            .label(file.span, format!("at most {} are allowed", length(MAX_OUT)))
            .place("there", at)
            .help("declare the blank that was turned: a larger `over shroud`, a smaller `bore`, a lower `back`; or give the file in mm and in the frame of the part"),
        );
        return;
    }
    let left = file.mesh.volume();
    if let Some(due) = solid::volume(part, stock, 1e-3).map(|v| v.value).filter(|due| left < LEAST_SHARE * due) {
        sink.push(
            Diag::error(
                codes::STOCK,
                format!("the solid of `{}` has {left:.0} mm3, the finished part {due:.0} mm3", file.file),
            )
            .label(file.span, "too little is left")
            .help("give the file in mm and in the frame of the part, and the stock after the last operation that was done"),
        );
    }
}
