//! Walls of channels as sheets: from the contact with the hub along the rolling ball, then up the face to the shroud.

use super::chart::{Chart, Shape};
use super::{FaceId, FaceSurface, Part, Surface, SurfaceKind};
use nalgebra::{Point3, Vector2};
use nurbs::bracket::Bracket;
use nurbs::proximity::Patch;
use rayon::prelude::*;

/// A wall of a channel with its fillet, sector 0.
pub(super) struct Sheet<'a> {
    part: &'a Part,
    id: FaceId,
    fillet: Option<&'a Chart<'a>>,
    /// Range of u in which the wall is defined.
    range: [f64; 2],
}

impl<'a> Sheet<'a> {
    pub(super) fn new(part: &'a Part, charts: &'a [Chart<'a>], id: FaceId) -> Option<Self> {
        let fillet = charts.iter().find(|c| c.kind == SurfaceKind::Fillet(id));
        if part.fillet(id).is_some() && fillet.is_none() {
            return None;
        }
        let range = match fillet {
            Some(chart) => [chart.place(0.0, 0.0).parameters[0], chart.place(1.0, 0.0).parameters[0]],
            // The guides continue along their tangents.
            None => [-0.2, 1.2],
        };
        Some(Self { part, id, fillet, range })
    }

    /// Point at u; `w` from 0 to 1 goes along the fillet, from 1 to 2 up the ruling.
    pub(super) fn point(&self, u: f64, w: f64) -> Point3<f64> {
        let surface = &self.part.face(self.id).surface;
        let low = match self.fillet {
            Some(chart) => {
                let x = (u - self.range[0]) / (self.range[1] - self.range[0]);
                if w < 1.0 {
                    return chart.place(x, 1.0 - w).position;
                }
                let contact = chart.place(x, 0.0).position;
                match surface {
                    FaceSurface::Ruled(ruled) => {
                        let (root, _, ruling) = ruled.tangents(u, 0.0);
                        (contact - root).dot(&ruling) / ruling.norm_squared()
                    }
                    // The same place from the ball itself takes a tenth of the time of a search for the closest point.
                    FaceSurface::Lofted(lofted) => {
                        let ball = self.part.fillet_top(self.id, u);
                        ball.unwrap_or_else(|| lofted.closest(&contact, Patch { u: [u, u], v: [-0.5, 1.5] }).v)
                    }
                }
            }
            None => self.part.ruling_meets(self.id, u, &self.part.hub, 0.0),
        };
        let high = self.part.ruling_meets(self.id, u, &self.part.shroud, 1.0);
        surface.point(u, low + (high - low) * (w - 1.0))
    }

    /// True when the face has a fillet.
    pub(super) fn has_fillet(&self) -> bool {
        self.fillet.is_some()
    }

    /// Rows from hub to shroud, at shares of the way up the fillet and up the face, each with places at the given shares from the inlet
    /// line to the outlet line. Without a fillet the first row is the root of the face.
    pub(super) fn grid(&self, along: &[f64], [fillet, face]: [&[f64]; 2]) -> Option<Vec<Vec<Point3<f64>>>> {
        let below = if self.has_fillet() { &fillet[..fillet.len() - 1] } else { &[] };
        let heights: Vec<f64> = below.iter().copied().chain(face.iter().map(|share| 1.0 + share)).collect();
        heights.into_par_iter().map(|w| self.row(along, w)).collect()
    }

    fn row(&self, along: &[f64], w: f64) -> Option<Vec<Point3<f64>>> {
        let ends = [self.meets(0.0, w)?, self.meets(1.0, w)?];
        let at = |share: &f64| self.point(ends[0] + (ends[1] - ends[0]) * share, w);
        Some(along.iter().map(at).collect())
    }

    /// u at which a row meets the line in the meridian plane between the ends of hub and shroud at u = 0 or 1.
    pub(super) fn meets(&self, end: f64, w: f64) -> Option<f64> {
        // An edge that is a surface of its own begins at the end of the face, and ends at the faces itself.
        if self.id.edge_end().is_some() || self.part.edge(self.id.blade, usize::from(end > 0.5)).is_some() {
            let reached = (self.range[0]..=self.range[1]).contains(&end);
            return reached.then_some(end);
        }
        let [hub, shroud] = self.part.end_line(self.id.blade, end);
        let normal = Vector2::new(hub.y - shroud.y, shroud.x - hub.x).normalize();
        let gap = |u: f64| {
            let p = self.point(u, w);
            (Vector2::new(libm::hypot(p.x, p.y), p.z) - hub).dot(&normal)
        };
        let ends = Bracket { holds: 0.5, fails: self.range[end as usize] };
        let sign = gap(ends.holds).signum();
        if gap(ends.fails) * sign > 0.0 {
            return None;
        }
        // Bisection of a wall of some 100 mm down to rounding.
        Some(ends.halved(48, |u| gap(u) * sign > 0.0).middle())
    }
}
