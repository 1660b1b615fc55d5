//! Does roughing leave its allowance on the vanes, at every height?
//!
//! The allowance is stock of this thickness, measured along the normal of a face or a fillet. Its outside is therefore
//! the surface of the part, moved along the normal by the allowance at the height of each point. No cutter may go into
//! the moved surface deeper than `tolerance rough`. The proof is that of kept surfaces (`kept.rs`).
//!
//! The planner keeps a distance from samples of the part and knows nothing of moved surfaces.

use super::kept::{Cover, Covered, deepest};
use super::place::describe;
use super::proof::grid::{Grid, PlacedSurface};
use super::proof::sweep::Sweep;
use super::surface::{self, Worst};
use super::{SPACING, proof::cells::Extreme};
use base::progress::Progress;
use base::units::{Mm, length};
use diagnostics::{Diag, Sink, codes::verification};
use ir::{Motion, Program};
use nalgebra::Point3;
use nurbs::range::{CellThickness, Interval};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use wheel::operation::VaneAllowance;
use wheel::part::chart::{Along, Chart, Place, Shape, charts};
use wheel::part::{Part, SurfaceId, SurfaceKind};

/// What an operation leaves on the vanes, against its allowance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct VaneReport {
    /// Index of the operation in the motion.
    pub operation: u32,
    /// Name of the operation.
    pub name: String,
    /// Allowance at the tip and at the root, mm; both are the same unless it grows.
    pub allowance: [Mm; 2],
    /// The place where most is missing; `None` where no cutter reaches into the allowance.
    pub worst: Option<MissingAllowance>,
    /// Proved bound of what is missing anywhere, mm.
    pub bound: Mm,
}

/// A place where a cutter goes into the allowance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MissingAllowance {
    /// Surface of the part.
    pub surface: String,
    /// Place on the outside of the allowance. Its value is negative: what is missing.
    pub place: Worst,
}

/// Face or fillet, moved along its normal by the allowance at the height of each point.
pub struct Moved<'a> {
    /// Face or fillet.
    pub chart: Chart<'a>,
    /// Part.
    pub part: &'a Part,
    /// Allowance.
    pub vane: VaneAllowance,
}

impl Shape for Moved<'_> {
    fn place(&self, x: f64, y: f64) -> Place {
        let place = self.chart.place(x, y);
        let allowance = self.at(&place.position);
        Place { position: place.position + place.normal * allowance, ..place }
    }

    /// That of the surface at the allowance of the middle, and that of the rest of a growing allowance along the normal.
    fn thickness(&self, rectangle: [[f64; 2]; 2]) -> CellThickness {
        let [x, y] = rectangle.map(|[from, to]| 0.5 * (from + to));
        let middle = self.chart.place(x, y).position;
        let even = self.chart.moved_thickness(rectangle, self.at(&middle));
        if self.vane.growth() == 0.0 { even } else { even.plus(self.growth_thickness(rectangle, &middle)) }
    }

    /// What counts is the surface of the part: where its normal leans over an end of the part, the moved surface reaches
    /// over the end, or ends before it.
    fn is_milled(&self, xy: [f64; 2], _: &Point3<f64>) -> bool {
        let on_surface = || self.chart.place(xy[0], xy[1]).position;
        matches!(self.chart.kind, SurfaceKind::Face(_)) || self.chart.is_milled(xy, &on_surface())
    }
}

impl Moved<'_> {
    /// The allowance at a place of the surface.
    fn at(&self, position: &Point3<f64>) -> f64 {
        // An even allowance needs no height.
        let height = if self.vane.growth() == 0.0 { 0.0 } else { self.part.height(position) };
        self.vane.at(height)
    }

    /// The share of the height changes by at most one over the sum of both distances in it per mm of way.
    fn growth_thickness(&self, rectangle: [[f64; 2]; 2], middle: &Point3<f64>) -> CellThickness {
        let half = rectangle.map(|[from, to]| 0.5 * (to - from));
        let most = |derivative: [Interval; 3]| derivative.map(|d| d.most() * d.most()).iter().sum::<f64>().sqrt();
        // Lengths of the derivatives of the surface and of its normal, along x and along y.
        let [(along, turn_along), (across, turn_across)] = [Along::X, Along::Y].map(|along| {
            let [own, moved] = [0.0, 1.0].map(|distance| self.chart.jets(along, rectangle, distance));
            let first = own.map(|jet| jet.orders[1]);
            (most(first), most(std::array::from_fn(|k| moved[k].orders[1] - first[k])))
        });
        let radius = along * half[0] + across * half[1];
        let [over_hub, under_shroud] = [self.part.hub.distance(middle), -self.part.shroud.distance(middle)];
        let height = over_hub.max(0.0) + under_shroud.max(0.0) - 2.0 * radius;
        let slope = if height > 0.0 { self.vane.growth() / height } else { f64::INFINITY };
        let rest = slope * radius;
        CellThickness::of_surface([
            CellThickness::of_rate(slope * along + rest * turn_along, half[0]),
            CellThickness::of_rate(slope * across + rest * turn_across, half[1]),
        ])
    }
}

/// Measures each roughing operation with an allowance on the vanes.
pub(super) fn check(
    program: &Program,
    motion: &Motion,
    roughing: &[Sweep<'_>],
    progress: &Progress,
) -> Vec<VaneReport> {
    let with_allowance = |sweep| {
        let sweep: &Sweep<'_> = sweep;
        let o = sweep.operation()?;
        let declared = &program.operations[motion.operations.get(o as usize)?.operation];
        let vane = declared.kind.roughing().map(|kept| kept.vane).filter(|vane| vane.root().get() > 0.0)?;
        Some((o, declared.name.clone(), vane, sweep))
    };
    let operations: Vec<_> = roughing.iter().filter_map(with_allowance).collect();
    // Operations with one allowance share the surfaces.
    let mut allowances: Vec<VaneAllowance> = Vec::new();
    for (_, _, vane, _) in &operations {
        if !allowances.contains(vane) {
            allowances.push(*vane);
        }
    }
    let shapes: Vec<Vec<Moved<'_>>> = allowances.iter().map(|vane| moved(&program.part, *vane)).collect();
    let covers: Vec<Cover<'_>> = shapes.iter().map(|shapes| cover(&program.part, shapes)).collect();
    let reports = operations.into_iter().filter_map(|(operation, name, vane, sweep)| {
        let cover = &covers[allowances.iter().position(|known| *known == vane)?];
        let (bound, worst) = missing(program, &name, cover, std::slice::from_ref(sweep), progress);
        let allowance = [vane.tip(), vane.root()].map(|value| Mm(value.get()));
        Some(VaneReport { operation, name, allowance, worst, bound: Mm(bound) })
    });
    reports.collect()
}

/// Faces and fillets with an allowance.
fn moved(part: &Part, vane: VaneAllowance) -> Vec<Moved<'_>> {
    let of_vane = |chart: &Chart<'_>| matches!(chart.kind, SurfaceKind::Face(_) | SurfaceKind::Fillet(_));
    charts(part).into_iter().filter(of_vane).map(|chart| Moved { chart, part, vane }).collect()
}

/// Moved surfaces in all sectors, with all of their patches.
fn cover<'a>(part: &'a Part, shapes: &'a [Moved<'_>]) -> Cover<'a> {
    let (mut grids, mut surfaces) = (Vec::new(), Vec::new());
    for shape in shapes {
        let first = grids.len();
        grids.extend(shape.patches(SPACING).into_par_iter().map(|p| Grid::new(shape, p)).collect::<Vec<_>>());
        surfaces.extend((0..part.vane_count).map(|sector| {
            let (turn, id) = (part.sector_rotation(sector), SurfaceId { kind: shape.chart.kind, sector });
            Covered { surface: PlacedSurface { shape, turn, id }, grids: (first..grids.len()).collect() }
        }));
    }
    Cover { part, surfaces, grids }
}

/// Proved bound of what is missing of an allowance, mm, and the worst place.
fn missing(
    program: &Program,
    name: &str,
    cover: &Cover<'_>,
    sweeps: &[Sweep<'_>],
    progress: &Progress,
) -> (f64, Option<MissingAllowance>) {
    let tolerance = program.tolerances.chord_rough.get();
    let stage = format!("{name}, allowance on vanes");
    let all = deepest(cover, sweeps, 0.0, tolerance, progress, stage);
    let bound = all.iter().map(|d| -d.low).fold(0.0, f64::max);
    let least = |found: Extreme| found.map_or(0.0, |f| f.0);
    let worst = cover.surfaces.iter().zip(&all).filter(|(_, d)| least(d.found) < 0.0);
    let worst = worst.min_by(|a, b| least(a.1.found).total_cmp(&least(b.1.found))).map(|(c, d)| MissingAllowance {
        surface: c.surface.id.to_string(),
        place: surface::extreme(&c.surface, d.found, -1.0, sweeps),
    });
    // The search for the worst place may leave the strip at the border of a surface that the proof leaves out.
    (worst.as_ref().map_or(bound, |w: &MissingAllowance| bound.max(-w.place.value.get())), worst)
}

impl VaneReport {
    /// The allowance in words: one value, or the values at the tip and at the root.
    pub fn leaves(&self) -> String {
        let [tip, root] = self.allowance.map(|mm| length(mm.get()));
        if self.allowance[0] == self.allowance[1] { tip } else { format!("{tip} .. {root}") }
    }
}

/// Reports operations that leave less than their allowance as errors.
pub(super) fn report(program: &Program, motion: &Motion, found: &[VaneReport], sink: &mut Sink) {
    let tolerance = program.tolerances.chord_rough.get();
    for r in found.iter().filter(|r| r.bound > Mm(tolerance)) {
        let Some(operation) = motion.operations.get(r.operation as usize) else { continue };
        let (name, allowed) = (&r.name, length(tolerance));
        let worst = r.worst.as_ref().filter(|w| -w.place.value.get() > tolerance);
        let text = match worst {
            Some(w) => {
                let (missing, surface) = (length(-w.place.value.get()), &w.surface);
                format!(
                    "`{name}` leaves {missing} less than its allowance on the {surface}; at most {allowed} may be missing"
                )
            }
            None => {
                let bound = length(r.bound.get());
                format!(
                    "`{name}` is proved to leave its allowance only to within {bound}; at most {allowed} may be missing"
                )
            }
        };
        let mut diag = Diag::error(verification::VANE_ALLOWANCE, text)
            .label(program.operations[operation.operation].span, "in this operation");
        if let Some(w) = worst {
            diag = diag.place(describe(program, motion, w.place.at), w.place.point.into());
            if let Some(at) = w.place.at {
                diag = diag.block(at.operation, at.index);
            }
        }
        sink.push(
            diag.note(format!("its allowance on the vanes is {}; it may lack `tolerance rough`", r.leaves()))
                .help(format!(
                    "state `tolerance rough {}`, which is twice as much, or a smaller allowance on the vanes; a program of \
                     another job has to be compiled again",
                    length(2.0 * tolerance)
                )),
        );
    }
}
