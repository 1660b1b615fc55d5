//! A face with four sides as the image of the unit square: s runs along it, t from its root to its tip.
//!
//! The parameters of the sides are blended (a Coons patch in the parameters of the surface), so that each place lies on the
//! surface, and the sides are those of the face also where it is trimmed.

use super::face::{EDGE_GAP_MM, StepChain, StepFace, four_sides};
use super::surface::{StepSurface, SurfaceJet};
use diagnostics::Diag;
use diagnostics::codes::import as codes;
use nalgebra::{Point3, Vector2};
use nurbs::chords;

/// A side: parameters of the surface, by the share of its length.
#[derive(Clone, Debug)]
struct SheetSide {
    /// Numbers of its edges.
    edges: Vec<u64>,
    shares: Vec<f64>,
    places: Vec<Vector2<f64>>,
}

impl SheetSide {
    fn at(&self, share: f64) -> Vector2<f64> {
        let k = self.shares.partition_point(|s| *s < share).clamp(1, self.shares.len() - 1);
        let width = self.shares[k] - self.shares[k - 1];
        let part = if width > 0.0 { (share - self.shares[k - 1]) / width } else { 0.0 };
        self.places[k - 1] + (self.places[k] - self.places[k - 1]) * part
    }

    fn reversed(mut self) -> Self {
        self.shares = self.shares.iter().rev().map(|s| 1.0 - s).collect();
        self.places.reverse();
        self
    }
}

/// A face with four sides.
#[derive(Clone, Debug)]
pub(super) struct StepSheet {
    surface: StepSurface,
    /// Root and tip along s, first and last side along t.
    sides: [SheetSide; 4],
    /// Largest distance of the edges from the surface, mm.
    pub(super) gap: f64,
}

impl StepSheet {
    /// The sheet of a face. `from_root` measures how far a point is from the root; `from_start` how far it is from the start
    /// of s.
    pub(super) fn new(
        face: &StepFace,
        from_root: impl Fn(&Point3<f64>) -> f64,
        from_start: impl Fn(&Point3<f64>) -> f64,
    ) -> Result<Self, Diag> {
        let fault = |message: String| {
            Diag::error(codes::NOT_READ, message)
                .label(face.span, format!("#{} `{}`", face.number, face.name))
                .help("pick a face with four sides: root, tip and both ends; join its pieces before the export")
        };
        let sides = face.borders.first().filter(|_| face.borders.len() == 1).and_then(four_sides);
        let Some(sides) = sides else {
            return Err(fault(format!("the face #{} has no border with four corners", face.number)));
        };
        // The root is the side whose farthest point is nearest to the hub.
        let farthest = |side: &StepChain| side.points.iter().map(&from_root).fold(0.0, f64::max);
        let root = (0..4).min_by(|a, b| farthest(&sides[*a]).total_cmp(&farthest(&sides[*b]))).unwrap_or(0);
        let (mut gap, mut near) = (0.0_f64, None);
        let mut placed = Vec::with_capacity(4);
        for side in &sides {
            let mut places = Vec::with_capacity(side.points.len());
            for p in &side.points {
                let mut foot = face.surface.nearest(p, near);
                // From a place at which a parameter has no speed no search comes away. Round a closed surface it may jump.
                let closed = (0..2).any(|k| face.surface.period(k).is_some());
                if foot.far > EDGE_GAP_MM && near.is_some() && !closed {
                    foot = face.surface.nearest(p, None);
                }
                near = Some(foot.place);
                gap = gap.max(foot.far);
                places.push(Vector2::from(foot.place));
            }
            let lengths = chords::lengths(&side.points);
            let whole = lengths[lengths.len() - 1].max(f64::MIN_POSITIVE);
            let shares = lengths.into_iter().map(|l| l / whole).collect();
            placed.push(SheetSide { edges: side.edges.clone(), shares, places });
        }
        if gap.is_nan() || gap > EDGE_GAP_MM {
            return Err(fault(format!("the border of the face #{} is {gap:.3} mm away from its surface", face.number)));
        }
        let ends = |side: &SheetSide| [side.places[0], side.places[side.places.len() - 1]];
        let joined = |a: Vector2<f64>, b: Vector2<f64>| {
            let [a, b] = [a, b].map(|place| face.surface.at(place.into()).point);
            nalgebra::distance(&a, &b)
        };
        // Round a closed surface the parameters of the border may not come back.
        let (first, last) = (ends(&placed[0])[0], ends(&placed[3])[1]);
        if joined(first, last) > EDGE_GAP_MM || (first - last).norm() > 1.0 + 1e-3 * first.norm() {
            return Err(fault(format!("the border of the face #{} goes round its surface", face.number)));
        }
        placed.rotate_left(root);
        let along_root = &sides[root].points;
        let starts = along_root.first().zip(along_root.last()).is_some_and(|(a, b)| from_start(a) < from_start(b));
        let [root, second, tip, fourth] = <[SheetSide; 4]>::try_from(placed).map_err(|_| fault(String::new()))?;
        let sides = if starts {
            [root, tip.reversed(), fourth.reversed(), second]
        } else {
            [root.reversed(), tip, second, fourth.reversed()]
        };
        Ok(Self { surface: face.surface.clone(), sides, gap })
    }

    /// Point and derivatives of the surface at a place of the unit square.
    pub(super) fn jet(&self, s: f64, t: f64) -> SurfaceJet {
        let [root, tip, first, last] = &self.sides;
        let corner = |t: f64, s: f64| if t < 0.5 { root.at(s) } else { tip.at(s) };
        let along = root.at(s) * (1.0 - t) + tip.at(s) * t;
        let across = first.at(t) * (1.0 - s) + last.at(t) * s;
        let corners = (corner(0.0, 0.0) * (1.0 - s) + corner(0.0, 1.0) * s) * (1.0 - t)
            + (corner(1.0, 0.0) * (1.0 - s) + corner(1.0, 1.0) * s) * t;
        self.surface.at((along + across - corners).into())
    }

    /// Numbers of the edges of the first (0) or last (1) side along t.
    pub(super) fn edges(&self, end: usize) -> &[u64] {
        &self.sides[2 + end].edges
    }

    /// Numbers of the edges of the root.
    pub(super) fn root_edges(&self) -> &[u64] {
        &self.sides[0].edges
    }

    /// Points of a row, at equal shares between shares of s.
    pub(super) fn row(&self, t: f64, steps: usize) -> Vec<Point3<f64>> {
        (0..=steps).map(|k| self.jet(k as f64 / steps as f64, t).point).collect()
    }

    /// Length of a row, mm.
    pub(super) fn length(&self, t: f64) -> f64 {
        const SHEET_STEPS: usize = 64;
        self.row(t, SHEET_STEPS).windows(2).map(|w| nalgebra::distance(&w[0], &w[1])).sum()
    }

    /// Points of the first (0) or last (1) side along t.
    pub(super) fn end(&self, end: f64, steps: usize) -> Vec<Point3<f64>> {
        (0..=steps).map(|k| self.jet(end, k as f64 / steps as f64).point).collect()
    }
}
