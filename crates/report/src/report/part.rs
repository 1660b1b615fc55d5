//! The finished part for the page: the samples of sector 0 in rows, and their deviations in all sectors.

use super::pack::{self, Bytes, Frame};
use serde::Serialize;
use verify::surface::FAR;
use wheel::part::{Part, Sample, SurfaceKind};

/// Most vertices of all sectors; with more samples, neighbouring samples share a vertex.
const MAX_PART_VERTICES: usize = 1_200_000;

/// A row of evenly spaced samples of a surface: their number, and the parameters of the first and the last.
#[derive(Clone, Copy, Debug, Serialize)]
struct MeshRow(usize, f64, f64);

/// One surface of sector 0.
#[derive(Clone, Debug, Serialize)]
struct SurfaceMesh {
    /// Name without its sector, as `pressure face`.
    name: String,
    /// Whether the surface is milled.
    milled: bool,
    /// Rows in order.
    rows: Vec<MeshRow>,
}

/// The part in the form of the page.
#[derive(Serialize)]
pub(super) struct PartData {
    sectors: u32,
    pub(super) frame: Frame,
    surfaces: Vec<SurfaceMesh>,
    /// Triangles with a longer edge are gaps, mm.
    gap: f64,
    /// Number of samples, along and across a row, of which a vertex shows the worst.
    pub(super) stride: usize,
    /// Knee and steps of the deviation codes.
    law: [f64; 2],
    /// Turned outside that is not milled: lines of (r, z) from the end of the shroud over the back to the inlet, mm.
    turned: Vec<Vec<[f64; 2]>>,
    #[serde(skip)]
    pub(super) positions: Bytes,
    #[serde(skip)]
    pub(super) normals: Bytes,
    #[serde(skip)]
    pub(super) deviations: Bytes,
}

/// Name of a surface without its sector.
fn name(kind: SurfaceKind) -> String {
    match kind {
        SurfaceKind::Face(side) => format!("{} face", side.name()),
        SurfaceKind::Fillet(side) => format!("{} fillet", side.name()),
        SurfaceKind::Hub(_) => "hub".to_owned(),
        SurfaceKind::Tip(_) => "tip".to_owned(),
        SurfaceKind::InletEdge(_) => "inlet edge".to_owned(),
        SurfaceKind::OutletEdge(_) => "outlet edge".to_owned(),
        SurfaceKind::InletRoot(_) => "root at the inlet".to_owned(),
        SurfaceKind::OutletRoot(_) => "root at the outlet".to_owned(),
        SurfaceKind::Rim | SurfaceKind::Back | SurfaceKind::Bore | SurfaceKind::Nose => kind.in_sectors(&[0]),
    }
}

/// Rows of samples of one surface: ranges of the samples of sector 0.
struct MeshRows {
    kind: SurfaceKind,
    milled: bool,
    rows: Vec<std::ops::Range<usize>>,
}

/// Cuts the samples of sector 0 where the surface or its first parameter changes.
fn rows(sector0: &[Sample]) -> Vec<MeshRows> {
    let mut found: Vec<MeshRows> = Vec::new();
    let mut start = 0;
    for (i, s) in sector0.iter().enumerate() {
        let last = sector0.get(i + 1).is_none_or(|next| {
            next.surface != s.surface || (next.parameters[0] - s.parameters[0]).abs() > f64::EPSILON
        });
        if !last {
            continue;
        }
        match found.last_mut() {
            Some(rows) if rows.kind == s.surface.kind => rows.rows.push(start..i + 1),
            _ => {
                let rows = std::iter::once(start..i + 1).collect();
                found.push(MeshRows { kind: s.surface.kind, milled: s.surface.milled(), rows });
            }
        }
        start = i + 1;
    }
    found
}

/// Every `stride`-th index of a range, and always the last, so that both ends of a surface are kept.
fn thinned(range: &std::ops::Range<usize>, stride: usize) -> Vec<usize> {
    let mut kept: Vec<usize> = range.clone().step_by(stride).collect();
    if let (Some(last), Some(kept_last)) = (range.clone().last(), kept.last().copied())
        && last != kept_last
    {
        kept.push(last);
    }
    kept
}

/// Deviation in relation to the bounds of gouge and excess (`bounds`, mm): a vertex for several samples shows the
/// worst.
fn badness(g: f64, bounds: [f64; 2]) -> f64 {
    if g < 0.0 { -g / bounds[0] } else { g / bounds[1] }
}

/// The part from the points of sector 0 in rows and their deviations in all sectors, mm, NaN where there is none.
/// `bounds` are those of gouge and excess, mm; `spacing` is the spacing of the samples.
pub(super) fn part(
    part: &Part,
    samples: &[Sample],
    deviations: &[f64],
    bounds: [f64; 2],
    spacing: f64,
    turned: Vec<Vec<[f64; 2]>>,
) -> PartData {
    let (sector0, count) = (samples, samples.len());
    let stride = ((deviations.len() as f64 / MAX_PART_VERTICES as f64).sqrt().ceil() as usize).max(1);
    let frame = Frame::around(sector0.iter().map(|s| [s.position.x, s.position.y, s.position.z]));
    let mut data = PartData {
        sectors: part.vane_count,
        frame,
        surfaces: Vec::new(),
        gap: 4.0 * spacing * stride as f64,
        stride,
        law: pack::deviation_law(),
        turned,
        positions: Bytes::default(),
        normals: Bytes::default(),
        deviations: Bytes::default(),
    };
    // Index of the vertex that shows each sample of sector 0.
    let mut shown = vec![0_usize; count];
    let mut vertices = 0;
    for surface in rows(sector0) {
        let all = surface.rows.len();
        let kept_rows = thinned(&(0..all), stride);
        let mut starts = Vec::with_capacity(kept_rows.len());
        let mut listed = Vec::with_capacity(kept_rows.len());
        for row in &kept_rows {
            let kept = thinned(&surface.rows[*row], stride);
            starts.push((vertices, kept.len()));
            vertices += kept.len();
            let parameter = |i: Option<&usize>| i.map_or(0.0, |i| rounded(sector0[*i].parameters[1]));
            listed.push(MeshRow(kept.len(), parameter(kept.first()), parameter(kept.last())));
            for i in kept {
                let s = &sector0[i];
                frame.place([s.position.x, s.position.y, s.position.z]).into_iter().for_each(|v| data.positions.u16(v));
                pack::direction(&s.normal).into_iter().for_each(|v| data.normals.i16(v));
            }
        }
        for (r, row) in surface.rows.iter().enumerate() {
            let nearest = |i: usize, n: usize| ((i + stride / 2) / stride).min(n.saturating_sub(1));
            let (first, n) = starts[nearest(r, starts.len())];
            let length = row.len().max(1);
            for (i, sample) in row.clone().enumerate() {
                // Rows differ in length: the vertex in the kept row follows from the share of the length.
                let share = i as f64 / (length - 1).max(1) as f64;
                shown[sample] = first + (share * (n.saturating_sub(1)) as f64).round() as usize;
            }
        }
        data.surfaces.push(SurfaceMesh { name: name(surface.kind), milled: surface.milled, rows: listed });
    }
    for sector in 0..part.vane_count as usize {
        let mut worst = vec![f64::NAN; vertices];
        for (i, vertex) in shown.iter().enumerate() {
            let g = deviations.get(sector * count + i).copied().unwrap_or(f64::NAN);
            let before = worst[*vertex];
            if before.is_nan() || badness(g, bounds) > badness(before, bounds) {
                worst[*vertex] = g;
            }
        }
        for g in worst {
            data.deviations.i16(if g.is_nan() {
                pack::NOT_MILLED
            } else if g >= FAR {
                pack::NOT_REACHED
            } else {
                pack::deviation(g)
            });
        }
    }
    data
}

/// Parameters need no more digits.
fn rounded(x: f64) -> f64 {
    (x * 1e6).round() / 1e6
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_the_ends() {
        assert_eq!(thinned(&(3..4), 2), [3]);
        assert_eq!(thinned(&(0..6), 2), [0, 2, 4, 5]);
        assert_eq!(thinned(&(0..7), 3), [0, 3, 6]);
        assert_eq!(thinned(&(2..5), 1), [2, 3, 4]);
    }
}
