//! A turned surface as a plane, in which lines and four-sided patches between given borders are found.

use super::patch::PointRows;
use crate::geom::Revolution;
use crate::geom::angle::nearest_turn;
use nalgebra::{Point3, Vector2};

/// Parameters of the meridian that differ by less from one of its ends are that end: rounding.
const END: f64 = 1e-9;

/// A turned surface as a plane: the parameter of its meridian, and the azimuth less that of a guide line, over the width of a strip
/// about this line. Where the strip runs like a channel, straight lines between blades cross none.
pub(super) struct Unrolled<'a> {
    surface: &'a Revolution,
    /// Parameter, azimuth and width in radians of four places of the strip, with cubics through them.
    strip: [[f64; 3]; 4],
}

/// Least width of a strip, radians.
const NARROWEST: f64 = 0.05;

impl<'a> Unrolled<'a> {
    /// The plane with a strip through four places: parameter of the meridian, azimuth, width in radians.
    pub(super) fn along(surface: &'a Revolution, strip: [[f64; 3]; 4]) -> Self {
        Self { surface, strip }
    }

    /// The plane with a meridian as its guide.
    pub(super) fn straight(surface: &'a Revolution) -> Self {
        Self { surface, strip: [0.0, 1.0, 2.0, 3.0].map(|k| [k / 3.0, 0.0, 1.0]) }
    }

    /// Azimuth of the guide, and width of the strip (Lagrange).
    fn at(&self, u: f64) -> [f64; 2] {
        let weight = |k: usize| -> f64 {
            let others = (0..4).filter(|j| *j != k);
            others.map(|j| (u - self.strip[j][0]) / (self.strip[k][0] - self.strip[j][0])).product()
        };
        let [azimuth, width] = [1, 2].map(|d| (0..4).map(|k| weight(k) * self.strip[k][d]).sum::<f64>());
        [azimuth, width.max(NARROWEST)]
    }

    /// Place of a point in the plane: parameter of the meridian, and widths of the strip from the guide, the one within half a turn of
    /// `about`.
    pub(super) fn place(&self, p: &Point3<f64>, about: f64) -> [f64; 2] {
        let u = self.surface.closest(Vector2::new(libm::hypot(p.x, p.y), p.z)).0;
        let u = [0.0, 1.0].into_iter().find(|end| (u - end).abs() < END).unwrap_or(u);
        let [azimuth, width] = self.at(u);
        [u, nearest_turn(libm::atan2(p.y, p.x) - azimuth, about * width) / width]
    }

    /// Width of the strip at a parameter of the meridian, radians.
    pub(super) fn width(&self, u: f64) -> f64 {
        self.at(u)[1]
    }

    /// The point of a place.
    pub(super) fn point(&self, [u, widths]: [f64; 2]) -> Point3<f64> {
        let [azimuth, width] = self.at(u);
        self.surface.point(u, azimuth + widths * width)
    }

    /// Equal steps of the straight line between two points, both included; it spans about as many widths as stated.
    pub(super) fn line(&self, from: &Point3<f64>, to: &Point3<f64>, about: f64, steps: usize) -> Vec<Point3<f64>> {
        let a = self.place(from, 0.0);
        let b = self.place(to, a[1] + about);
        let at = |k: usize| match k {
            0 => *from,
            k if k == steps => *to,
            k => self.point([0, 1].map(|d| a[d] + (b[d] - a[d]) * k as f64 / steps as f64)),
        };
        (0..=steps).map(at).collect()
    }

    /// Steps of the parabola from a point to a place, with the place that its tangents at both ends meet; both ends included.
    pub(super) fn parabola(&self, from: &Point3<f64>, [middle, to]: [[f64; 2]; 2], steps: usize) -> Vec<Point3<f64>> {
        let start = self.place(from, middle[1]);
        let at = |k: usize| {
            let t = k as f64 / steps as f64;
            let mix = |d: usize| start[d] * (1.0 - t) * (1.0 - t) + 2.0 * middle[d] * t * (1.0 - t) + to[d] * t * t;
            if k == 0 { *from } else { self.point([0, 1].map(mix)) }
        };
        (0..=steps).map(at).collect()
    }

    /// Points between four borders (Coons): the first and the last row, the first and the last column. The borders stay as they
    /// are. `None` where lines between borders cross each other.
    pub(super) fn filled(&self, [first, last]: [&[Point3<f64>]; 2], sides: [&[Point3<f64>]; 2]) -> Option<PointRows> {
        let places = |line: &[Point3<f64>], about: f64| {
            let mut about = about;
            let place = |p: &Point3<f64>| {
                let at = self.place(p, about);
                about = at[1];
                at
            };
            line.iter().map(place).collect::<Vec<_>>()
        };
        let low = places(first, self.place(&first[0], 0.0)[1]);
        let columns = low.len() - 1;
        let left = places(sides[0], low[0][1]);
        let right = places(sides[1], low[columns][1]);
        let rows = left.len() - 1;
        let high = places(last, left[rows][1]);
        let at = |i: usize, j: usize| {
            let (x, y) = (i as f64 / columns as f64, j as f64 / rows as f64);
            [0, 1].map(|d| {
                let between = low[i][d] * (1.0 - y) + high[i][d] * y + left[j][d] * (1.0 - x) + right[j][d] * x;
                let lowest = low[0][d] * (1.0 - x) + low[columns][d] * x;
                let highest = high[0][d] * (1.0 - x) + high[columns][d] * x;
                between - lowest * (1.0 - y) - highest * y
            })
        };
        let flat: Vec<Vec<[f64; 2]>> = (0..=rows).map(|j| (0..=columns).map(|i| at(i, j)).collect()).collect();
        let point = |(i, j): (usize, usize)| match (i, j) {
            (i, 0) => first[i],
            (i, j) if j == rows => last[i],
            (0, j) => sides[0][j],
            (i, j) if i == columns => sides[1][j],
            (i, j) => self.point(flat[j][i]),
        };
        (!folded(&flat)).then(|| (0..=rows).map(|j| (0..=columns).map(|i| point((i, j))).collect()).collect())
    }
}

/// True when cells of a grid run in different senses.
fn folded(rows: &[Vec<[f64; 2]>]) -> bool {
    let cells = rows.windows(2).flat_map(|pair| pair[0].windows(2).zip(pair[1].windows(2)));
    let sense = |(low, high): (&[[f64; 2]], &[[f64; 2]])| {
        // Twice the area, by the diagonals.
        let [p, q] = [[low[0], high[1]], [low[1], high[0]]].map(|[a, b]| [b[0] - a[0], b[1] - a[1]]);
        p[0] * q[1] - p[1] * q[0]
    };
    let (least, most) = cells.map(sense).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), s| (a.min(s), b.max(s)));
    least * most <= 0.0
}
