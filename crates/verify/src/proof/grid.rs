//! A surface in one sector, the points of a patch of it, and the cells between them.

use super::hull::Hull;
use nalgebra::{Point3, Rotation3};
use nurbs::range::CellThickness;
use std::sync::OnceLock;
use wheel::part::{
    SurfaceId,
    chart::{Patch, Shape},
};

/// Cells along the side of a block, whose corners share their candidates.
const CELLS_PER_BLOCK_SIDE: usize = 2;

/// A surface of one sector.
#[derive(Clone, Copy)]
pub(crate) struct PlacedSurface<'a> {
    /// Its shape in sector 0.
    pub(crate) shape: &'a dyn Shape,
    /// Rotation into the sector.
    pub(crate) turn: Rotation3<f64>,
    /// Identifier of the surface.
    pub(crate) id: SurfaceId,
}

impl PlacedSurface<'_> {
    /// The point at a place of the chart.
    pub(crate) fn point(&self, [x, y]: [f64; 2]) -> Point3<f64> {
        self.turn * self.shape.place(x, y).position
    }

    /// True when the place `xy` of the chart, which lies at `p`, belongs to the part.
    pub(crate) fn holds(&self, xy: [f64; 2], p: &Point3<f64>) -> bool {
        self.shape.is_milled(xy, &(self.turn.inverse() * p))
    }

    /// How a cell with this hull lies to the part, by its corners and its middle.
    pub(crate) fn lies(&self, cell: &Cell, hull: &Hull) -> Lies {
        let places = Cell::CORNERS.iter().chain([&[0.0; 2]]).map(|[i, j]| cell.at(*i, *j));
        let points = hull.corners.iter().chain([&hull.centre]);
        Lies::by(places.zip(points).filter(|(xy, p)| self.holds(*xy, p)).count())
    }
}

/// Points of a patch in sector 0: corners, middles of sides and middles of all cells, x by x.
pub(crate) struct Grid {
    /// The patch.
    pub(crate) patch: Patch,
    points: Vec<Point3<f64>>,
    /// Thickness of the whole patch about the biquadratic through nine of its points.
    whole: CellThickness,
    /// Of its parts: most patches lie far from all roughing, and nobody asks.
    parts: OnceLock<PartThickness>,
}

/// Thickness of parts of a patch, each about the biquadratic through nine of its points.
struct PartThickness {
    /// Of its blocks, x by x.
    blocks: Vec<CellThickness>,
    /// Of its cells, x by x.
    cells: Vec<CellThickness>,
}

/// Thickness of a shape over a block of cells of a patch.
fn over(shape: &dyn Shape, patch: &Patch, block: &CellBlock) -> CellThickness {
    let along = |range, [from, to]: [usize; 2], n| [mix(range, from, n), mix(range, to, n)];
    shape.thickness([along(patch.x, block.x, patch.columns), along(patch.y, block.y, patch.rows)])
}

impl PartThickness {
    fn new(shape: &dyn Shape, patch: &Patch, whole: CellThickness) -> Self {
        let mut cells = vec![whole; patch.columns * patch.rows];
        let mut blocks = Vec::new();
        for x in CellBlock::runs([0, patch.columns]) {
            for y in CellBlock::runs([0, patch.rows]) {
                let block = CellBlock { x, y };
                let thickness = over(shape, patch, &block);
                let halved = thickness.halved().filter(|_| x[1] - x[0] == 2 && y[1] - y[0] == 2);
                for cell in block.cells() {
                    cells[cell.x[0] * patch.rows + cell.y[0]] = halved.unwrap_or_else(|| over(shape, patch, &cell));
                }
                blocks.push(thickness);
            }
        }
        Self { blocks, cells }
    }
}

impl Grid {
    /// The grid of a patch.
    pub(crate) fn new(shape: &dyn Shape, patch: Patch) -> Self {
        let (nx, ny) = (2 * patch.columns, 2 * patch.rows);
        let points: Vec<Point3<f64>> = (0..=nx)
            .flat_map(|i| (0..=ny).map(move |j| (i, j)))
            .map(|(i, j)| shape.place(mix(patch.x, i, nx), mix(patch.y, j, ny)).position)
            .collect();
        let whole = over(shape, &patch, &CellBlock { x: [0, patch.columns], y: [0, patch.rows] });
        Self { patch, points, whole, parts: OnceLock::new() }
    }

    /// Place in the chart of point i along x and j along y.
    pub(crate) fn xy(&self, i: usize, j: usize) -> [f64; 2] {
        let Patch { x, y, columns, rows } = self.patch;
        [mix(x, i, 2 * columns), mix(y, j, 2 * rows)]
    }

    /// Point i along x and j along y; neighbouring corners are two points apart.
    pub(crate) fn point(&self, i: usize, j: usize) -> Point3<f64> {
        self.points[i * (2 * self.patch.rows + 1) + j]
    }

    /// How far a cell, a block of [`CellBlock::runs`] or the whole patch lies from the biquadratic through its nine points.
    fn thickness(&self, shape: &dyn Shape, block: &CellBlock) -> CellThickness {
        let patch = &self.patch;
        let parts = || self.parts.get_or_init(|| PartThickness::new(shape, patch, self.whole));
        match block.longest() {
            1 => parts().cells[block.x[0] * patch.rows + block.y[0]],
            longest if longest <= CELLS_PER_BLOCK_SIDE => {
                parts().blocks[block.x[0] / CELLS_PER_BLOCK_SIDE * patch.rows.div_ceil(CELLS_PER_BLOCK_SIDE)
                    + block.y[0] / CELLS_PER_BLOCK_SIDE]
            }
            _ => self.whole,
        }
    }

    /// The hull of a block of cells of a surface.
    pub(crate) fn hull(&self, block: &CellBlock, surface: &PlacedSurface<'_>) -> Hull {
        let along = |[from, to]: [usize; 2]| [2 * from, from + to, 2 * to];
        let (x, y) = (along(block.x), along(block.y));
        let at = |k: usize| surface.turn * self.point(x[k / 3], y[k % 3]);
        Hull::new(&std::array::from_fn(at), self.thickness(surface.shape, block).most)
    }

    /// The first cell of a block.
    pub(crate) fn cell(&self, block: &CellBlock, shape: &dyn Shape) -> Cell {
        let patch = &self.patch;
        let half = [
            0.5 * (patch.x[1] - patch.x[0]) / patch.columns as f64,
            0.5 * (patch.y[1] - patch.y[0]) / patch.rows as f64,
        ];
        let middle =
            [patch.x[0] + half[0] * (2 * block.x[0] + 1) as f64, patch.y[0] + half[1] * (2 * block.y[0] + 1) as f64];
        Cell { middle, half, depth: 0, thickness: self.thickness(shape, block) }
    }
}

/// The i-th of n + 1 equally spaced places over a range.
pub(crate) fn mix(range: [f64; 2], i: usize, n: usize) -> f64 {
    range[0] + (range[1] - range[0]) * i as f64 / n as f64
}

/// A block of cells of a patch: columns and rows from..to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CellBlock {
    /// Columns from..to.
    pub(crate) x: [usize; 2],
    /// Rows from..to.
    pub(crate) y: [usize; 2],
}

impl CellBlock {
    pub(crate) fn longest(&self) -> usize {
        (self.x[1] - self.x[0]).max(self.y[1] - self.y[0])
    }

    /// Its cells.
    pub(crate) fn cells(&self) -> impl Iterator<Item = Self> {
        let [from, to] = self.y;
        (self.x[0]..self.x[1]).flat_map(move |i| (from..to).map(move |j| Self { x: [i, i + 1], y: [j, j + 1] }))
    }

    /// Divides a range into runs of [`CELLS_PER_BLOCK_SIDE`] cells.
    pub(crate) fn runs([from, to]: [usize; 2]) -> Vec<[usize; 2]> {
        (from..to).step_by(CELLS_PER_BLOCK_SIDE).map(|k| [k, (k + CELLS_PER_BLOCK_SIDE).min(to)]).collect()
    }
}

/// A cell of the chart: middle and half sides.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cell {
    /// Middle.
    pub(crate) middle: [f64; 2],
    /// Half sides.
    pub(crate) half: [f64; 2],
    /// Number of times that the cell was halved.
    pub(crate) depth: i32,
    /// How far the surface lies from the biquadratic through nine points of the cell.
    pub(crate) thickness: CellThickness,
}

impl Cell {
    /// Its corners in half sides from the middle, in the order of the corners of a hull.
    const CORNERS: [[f64; 2]; 4] = [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]];

    /// Its quarters, on a surface.
    pub(crate) fn quarters(self, shape: &dyn Shape) -> [Self; 4] {
        let half = self.half.map(|h| 0.5 * h);
        Self::CORNERS.map(|[i, j]| {
            let middle = [self.middle[0] + i * half[0], self.middle[1] + j * half[1]];
            let range = |k: usize| [middle[k] - half[k], middle[k] + half[k]];
            let thickness = self.thickness.halved().unwrap_or_else(|| shape.thickness([range(0), range(1)]));
            Self { middle, half, depth: self.depth + 1, thickness }
        })
    }

    pub(crate) fn at(&self, i: f64, j: f64) -> [f64; 2] {
        [self.middle[0] + i * self.half[0], self.middle[1] + j * self.half[1]]
    }
}

/// Position of a cell relative to the part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Lies {
    Inside,
    Across,
    Outside,
}

impl Lies {
    /// From the number of corners and middle (five points) on the part.
    pub(crate) fn by(on: usize) -> Self {
        match on {
            0 => Self::Outside,
            5 => Self::Inside,
            _ => Self::Across,
        }
    }
}
