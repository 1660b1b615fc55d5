//! `fit-curves`: dual NURBS of the finishing passes (algorithms reference, 3).
//!
//! Before: dense stations. After: the same, and beside them two cubic curves on common knots and parameter, one of the
//! tip and one of the axis at the end of the flutes, which no station leaves by more than the chord tolerance. A pass
//! that was found as such curves keeps them. A pass that no such curves follow stays without.

use super::pipeline::PassContext;
use crate::geom::DualCurve;
use crate::ir::{ClPass, ClPlan};
use nalgebra::Point3;
use rayon::prelude::*;

/// Control points to begin with, and at most.
const CONTROL: [usize; 2] = [16, 512];

/// Fits the curves.
pub(super) fn run(cx: &PassContext<'_>, cl: &mut ClPlan) {
    let tolerance = cx.program.tolerances.chord.get();
    for planned in &mut cl.operations {
        let operation = &cx.program.operations[planned.operation];
        if !operation.kind.finishes() {
            continue;
        }
        let reach = cx.program.tools[operation.tool].solid.flute_length;
        let work = cx.progress.begin(format!("{}, curves", operation.name), planned.passes.len());
        planned.passes.par_iter_mut().for_each(|pass| {
            if pass.path.is_none() {
                pass.path = fit(pass, reach, tolerance);
            }
            work.step(());
        });
    }
}

/// Curves with the fewest control points of 16, 32, 64, ... that keep the tolerance.
fn fit(pass: &ClPass, reach: f64, tolerance: f64) -> Option<DualCurve> {
    let pairs: Vec<[Point3<f64>; 2]> = pass.points.iter().map(|p| [p.tip, p.tip + p.axis * reach]).collect();
    let mut way = vec![0.0];
    for w in pairs.windows(2) {
        let step = (w[1][0] - w[0][0]).norm_squared().max((w[1][1] - w[0][1]).norm_squared());
        way.push(way.last()? + step.sqrt());
    }
    let whole = way.last().copied().filter(|w| *w > 0.0)?;
    let parameters: Vec<f64> = way.iter().map(|w| w / whole).collect();
    let mut control = CONTROL[0];
    while control <= CONTROL[1].min(pairs.len()) {
        let curve = DualCurve::fitted(&parameters, &pairs, control)?;
        let far = |(t, pair): (&f64, &[Point3<f64>; 2])| {
            let at = curve.at(*t);
            let upper = at.lower + at.axis * at.length;
            (at.lower - pair[0]).norm_squared().max((upper - pair[1]).norm_squared())
        };
        let worst = parameters.iter().zip(&pairs).map(far).fold(0.0, f64::max);
        if worst <= tolerance * tolerance {
            return Some(curve);
        }
        control *= 2;
    }
    None
}
