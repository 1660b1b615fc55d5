//! Cutters of tests: those with a name, and shapes that no kind has.

use super::meridian::{Arc, Meridian};
use super::{Cutter, ToolSolid};
use std::f64::consts::FRAC_PI_4;

/// A flat end with a chamfer of 45 deg, and a tapered bull nose with a flank of large radius below a cylinder.
pub(crate) fn turned() -> [Cutter; 2] {
    let chamfered = [Arc::new([3.0, 0.0], 0.0, FRAC_PI_4), Arc::new([4.0, 1.0], 0.0, 0.0)];
    // Each centre lies on the normal of the line that both arcs touch, after 2 mm of this line.
    let (from, to) = ((1.5, 0.8), 30.0);
    let (sin, cos) = libm::sincos(0.2);
    let inward = to - from.1;
    let flank = [from.0 - inward * cos + 2.0 * sin, from.1 + inward * sin + 2.0 * cos];
    let bulged = [Arc::new([from.0, from.1], from.1, 0.2), Arc::new(flank, to, 0.0)];
    [&chamfered, &bulged].map(|arcs| Cutter::turned(Meridian::new(arcs).unwrap()))
}

/// Tools with all these cutters, without shank and holder.
pub(crate) fn solids() -> Vec<ToolSolid> {
    let solid = |cutter, flute_length| ToolSolid { cutter, flute_length, shank: Vec::new(), holder: Vec::new() };
    let lollipop = Cutter::lollipop(3.0);
    let mut solids = vec![
        solid(Cutter::flat(4.0), 12.0),
        solid(Cutter::ball(3.0), 12.0),
        solid(Cutter::bull(4.0, 1.0), 12.0),
        solid(Cutter::tapered_ball(1.5, 0.1), 12.0),
        solid(Cutter::barrel(5.0, 40.0, 1.0), 14.0),
        solid(lollipop, lollipop.neck_height(2.0).unwrap()),
    ];
    solids.extend(turned().map(|cutter| solid(cutter, 12.0)));
    solids
}
