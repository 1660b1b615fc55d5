//! Samples of all surfaces of the finished part.
//!
//! | surface | extent |
//! |---|---|
//! | face | from the fillet (or the hub) to the shroud, along the ruling |
//! | hub | between the fillets (or the vanes) of neighbouring vanes |
//! | fillet | envelope of the rolling ball between its contacts with face and hub |
//! | tip, edge | turned surfaces of the vanes: obstacles, not milled |

use super::borders::{Opening, arc_between};
use super::charting::turned;
use super::rolling_ball::FilletArc;
use super::{BladeId, FaceId, Part, Passage, Surface, SurfaceId, SurfaceKind};
use nalgebra::{Point3, Vector3};
use nurbs::bracket::Bracket;
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;
use tool_stock::collide::CloudPoint;

/// A sample of a design surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Surface.
    pub surface: SurfaceId,
    /// Position, part frame.
    pub position: Point3<f64>,
    /// Unit normal out of the material.
    pub normal: Vector3<f64>,
    /// Parameters: (u, v) of a face, (u, share of the arc) of a fillet, (u, share across) of the hub.
    pub parameters: [f64; 2],
    /// Area that the sample represents, mm2; none for points on the border of a fillet.
    pub area: f64,
}

/// Samples for distance queries. The tag of a point is the index of its surface among the sorted surfaces of the
/// samples.
pub fn cloud_points<'a>(samples: impl IntoIterator<Item = &'a Sample>) -> Vec<CloudPoint> {
    let samples: Vec<&Sample> = samples.into_iter().collect();
    let surfaces: BTreeSet<SurfaceId> = samples.iter().map(|s| s.surface).collect();
    let tags: BTreeMap<SurfaceId, u32> = surfaces.into_iter().zip(0..).collect();
    samples.iter().map(|s| CloudPoint { position: s.position, normal: s.normal, tag: tags[&s.surface] }).collect()
}

/// Most samples of a part: a few gigabytes together with all structures built on them.
pub const MAX_SAMPLES: f64 = 1.5e7;

/// Approximate number of samples of a part at a spacing.
pub fn estimate(part: &Part, spacing: f64) -> f64 {
    let outlet = part.hub.meridian(1.0).point.x.max(part.hub.meridian(0.0).point.x);
    let longest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
    let length = longest(&mut part.faces().map(|face| guide_length(part, face)));
    let main = &part.main().faces[0].surface;
    let height = longest(&mut [0.0, 0.5, 1.0].into_iter().map(|u| main.height(u)));
    let blades = f64::from(part.vane_count) * part.blades.len() as f64;
    let area = TAU * outlet * length + blades * 2.0 * length * height;
    area * UNEVEN / (spacing * spacing)
}

/// Samples all design surfaces of all sectors so that neighbours lie at most `spacing` apart, in a fixed order.
///
/// Surfaces outside of the turned blank are left out: fillets end at the inlet cone and the outlet cylinder.
pub fn sample(part: &Part, spacing: f64) -> Vec<Sample> {
    let mut sector0 = Vec::new();
    for id in part.blade_ids().flat_map(|blade| part.sides(blade)) {
        sample_face(part, id, spacing, &mut sector0);
        if part.fillet(id).is_some() {
            sample_fillet(part, id, spacing, &mut sector0);
        }
    }
    for passage in part.passages() {
        sample_hub(part, &passage, spacing, &mut sector0);
    }
    for blade in part.blade_ids() {
        sample_turned(part, blade, spacing, &mut sector0);
    }
    let mut all = Vec::with_capacity(sector0.len() * part.vane_count as usize);
    for sector in 0..part.vane_count {
        let turn = part.sector_rotation(sector);
        all.extend(sector0.iter().map(|s| Sample {
            surface: SurfaceId { sector, ..s.surface },
            position: turn * s.position,
            normal: turn * s.normal,
            ..*s
        }));
    }
    all
}

/// Number of steps that keep a length below the spacing.
fn steps(length: f64, spacing: f64) -> usize {
    (length / spacing).ceil().max(1.0) as usize
}

/// Length of the longer guide of a face.
fn guide_length(part: &Part, id: FaceId) -> f64 {
    let surface = &part.face(id).surface;
    [0.0, 1.0]
        .map(|v| {
            (0..200)
                .map(|i| (surface.point(f64::from(i + 1) / 200.0, v) - surface.point(f64::from(i) / 200.0, v)).norm())
                .sum::<f64>()
        })
        .into_iter()
        .fold(0.0, f64::max)
}

/// Ratio of the longest step of a guide at equal steps of u to the mean: parameters by chord length keep steps near the
/// mean.
const UNEVEN: f64 = 1.25;

fn sample_face(part: &Part, id: FaceId, spacing: f64, out: &mut Vec<Sample>) {
    let face = part.face(id);
    let nu = steps(guide_length(part, id) * UNEVEN, spacing);
    let kind = match id.edge_end() {
        None => SurfaceKind::Face(id),
        Some(0) => SurfaceKind::InletEdge(id.blade),
        Some(_) => SurfaceKind::OutletEdge(id.blade),
    };
    for i in 0..=nu {
        let u = i as f64 / nu as f64;
        let low = match part.fillet(id) {
            Some(_) => part.fillet_top(id, u),
            None => Some(part.ruling_meets(id, u, &part.hub, 0.0)),
        };
        let Some(low) = low else { continue };
        let high = part.ruling_meets(id, u, &part.shroud, 1.0);
        let nv = steps(face.surface.height(u) * (high - low), spacing);
        for j in 0..=nv {
            let v = low + (high - low) * j as f64 / nv as f64;
            let (position, su, sv) = face.surface.tangents(u, v);
            let weight = end_weight(i, nu) * end_weight(j, nv) / nu as f64 * (high - low) / nv as f64;
            out.push(Sample {
                surface: SurfaceId { kind, sector: 0 },
                position,
                normal: face.normal(u, v),
                parameters: [u, v],
                area: su.cross(&sv).norm() * weight,
            });
        }
    }
}

/// Trapezoidal weight of the first and last sample of a row.
fn end_weight(i: usize, n: usize) -> f64 {
    if i == 0 || i == n { 0.5 } else { 1.0 }
}

/// Samples of the fillet of a face: rows of points on the arcs of the rolling ball. A row at an oblique end of the blade is
/// in the part with some of its points alone; where the fillet leaves the part between two rows it has a point on the
/// border, as every other surface has. Beside a border without points the distance to the surface would be wrong to the
/// first order in the spacing.
fn sample_fillet(part: &Part, id: FaceId, spacing: f64, out: &mut Vec<Sample>) {
    /// Distance of a point on the border to the border, in rows.
    const BORDER_ROWS: f64 = 1e-4;
    let ends = part.fillet_ends(id, |u| part.fillet_radius(id, u).unwrap_or(0.0));
    let rows = |nu: usize| -> Vec<(f64, Option<FilletArc>)> {
        let [first, last] = ends.map(|u| u * nu as f64);
        let row = |row: i64| (row as f64, part.fillet_arc(id, row as f64 / nu as f64));
        (first.floor() as i64..=last.ceil() as i64).map(row).collect()
    };
    let mut nu = steps(guide_length(part, id) * UNEVEN, spacing);
    let mut arcs = rows(nu);
    let widest = widest_step(&arcs);
    if widest > spacing {
        // Round an edge the contacts with the hub lie on a wider arc than those with the edge.
        nu = (nu as f64 * widest / spacing).ceil() as usize;
        arcs = rows(nu);
    }
    let extent = part.extent(id.blade);
    let width = guide_length_at(part, id, nu);
    let at = |row: f64| part.fillet_arc(id, row / nu as f64);
    let within = |arc: &FilletArc, share: f64| extent.holds(&arc.point(share));
    let sample = |row: f64, arc: &FilletArc, share: f64, area: f64| Sample {
        surface: SurfaceId { kind: SurfaceKind::Fillet(id), sector: 0 },
        position: arc.point(share),
        normal: -arc.direction(share),
        parameters: [row / nu as f64, share],
        area,
    };
    for (i, (row, arc)) in arcs.iter().enumerate() {
        let Some(arc) = arc else { continue };
        // From the face contact to the hub contact.
        let length = arc.angle() * arc.radius;
        let n = steps(length, spacing);
        for j in 0..=n {
            let share = j as f64 / n as f64;
            if !within(arc, share) {
                continue;
            }
            out.push(sample(*row, arc, share, width * length / n as f64 * end_weight(j, n)));
            for (beyond, next) in [i.checked_sub(1), Some(i + 1)].into_iter().flatten().filter_map(|k| arcs.get(k)) {
                if next.as_ref().is_none_or(|next| within(next, share)) {
                    continue;
                }
                let border = Bracket { holds: *row, fails: *beyond }
                    .narrowed(BORDER_ROWS, |row| at(row).is_some_and(|arc| within(&arc, share)));
                out.extend(at(border.holds).map(|arc| sample(border.holds, &arc, share, 0.0)));
            }
        }
    }
}

/// Largest distance between places of neighbouring rows of a fillet at the same share of their arcs, mm.
fn widest_step(rows: &[(f64, Option<FilletArc>)]) -> f64 {
    let step = |pair: &[(f64, Option<FilletArc>)]| {
        let (Some(a), Some(b)) = (&pair[0].1, &pair[1].1) else { return 0.0 };
        [0.0, 0.5, 1.0].map(|share| (a.point(share) - b.point(share)).norm()).into_iter().fold(0.0, f64::max)
    };
    rows.windows(2).map(step).fold(0.0, f64::max)
}

/// Mean distance of the rows of a fillet.
fn guide_length_at(part: &Part, id: FaceId, nu: usize) -> f64 {
    let surface = &part.face(id).surface;
    let length: f64 = (0..100)
        .map(|i| (surface.point(f64::from(i + 1) / 100.0, 0.0) - surface.point(f64::from(i) / 100.0, 0.0)).norm())
        .sum();
    length / nu as f64
}

fn sample_hub(part: &Part, passage: &Passage, spacing: f64, out: &mut Vec<Sample>) {
    let opening = Opening::of(part, passage);
    let length: f64 = (0..200)
        .map(|i| {
            (part.hub.meridian(f64::from(i + 1) / 200.0).point - part.hub.meridian(f64::from(i) / 200.0).point).norm()
        })
        .sum();
    let nu = steps(length * UNEVEN, spacing);
    for i in 0..=nu {
        let u = i as f64 / nu as f64;
        let Some([from, angle]) = opening.at(u) else { continue };
        if angle <= 0.0 {
            continue;
        }
        let m = part.hub.meridian(u);
        let n = steps(angle * m.point.x, spacing);
        for j in 0..=n {
            let share = j as f64 / n as f64;
            let azimuth = from + angle * share;
            let weight = end_weight(i, nu) * end_weight(j, n);
            out.push(Sample {
                surface: SurfaceId { kind: SurfaceKind::Hub(passage.id), sector: 0 },
                position: part.hub.point(u, azimuth),
                normal: part.hub.normal(u, azimuth),
                parameters: [u, share],
                area: m.first.norm() / nu as f64 * angle * m.point.x / n as f64 * weight,
            });
        }
    }
}

/// Turned surfaces of a blade of sector 0 between its two faces: tip, inlet edge, outlet edge.
fn sample_turned(part: &Part, blade: BladeId, spacing: f64, out: &mut Vec<Sample>) {
    let p = &part.blade(blade).faces[0];
    let mut span =
        |kind: SurfaceKind, a: Point3<f64>, b: Point3<f64>, normal: Vector3<f64>, parameter: f64, step: f64| {
            let n = steps((b - a).norm(), spacing);
            for j in 0..=n {
                let share = j as f64 / n as f64;
                out.push(Sample {
                    surface: SurfaceId { kind, sector: 0 },
                    position: arc_between(&a, &b, share),
                    normal,
                    parameters: [parameter, share],
                    area: step * (b - a).norm() / n as f64,
                });
            }
        };
    let length = guide_length(part, blade.faces()[0]);
    let nu = steps(length * UNEVEN, spacing);
    for i in 0..=nu {
        let u = i as f64 / nu as f64;
        let [a, b] = blade.faces().map(|face| {
            let (id, u) = part.outline_place(face, u);
            part.face(id).surface.point(u, part.ruling_meets(id, u, &part.shroud, 1.0))
        });
        span(SurfaceKind::Tip(blade), a, b, p.surface.ruling(u), u, length / nu as f64);
    }
    for (kind, u) in [(SurfaceKind::InletEdge(blade), 0.0), (SurfaceKind::OutletEdge(blade), 1.0)] {
        if part.edge(blade, usize::from(u > 0.5)).is_some() {
            continue;
        }
        let (_, su, _) = p.surface.tangents(u, 0.5);
        let height = p.surface.height(u);
        let outward = su.normalize() * if u > 0.5 { 1.0 } else { -1.0 };
        let nv = steps(height, spacing);
        // A face ends at its data, a little before the rim or behind it, and a lofted one also beyond hub and shroud or before them.
        let extent = part.extent(blade);
        let ends = blade.faces().map(|id| {
            let [low, high] = [(&part.hub, 0.0), (&part.shroud, 1.0)];
            [low, high].map(|(surface, guess)| part.ruling_meets(id, u, surface, guess))
        });
        for i in 0..=nv {
            let share = i as f64 / nv as f64;
            let [a, b] = blade.faces().map(|id| {
                let [low, high] = ends[id.index()];
                turned(part, &extent, id, u, low + (high - low) * share)
            });
            span(kind, a, b, outward, share, height / nv as f64);
        }
    }
}
