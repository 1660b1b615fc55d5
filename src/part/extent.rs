//! Extent of the milled surfaces of a blade: between its inlet cone and its outlet cylinder.

use super::{BladeId, Part, Surface};
use nalgebra::{Point3, Vector2};

/// The space between inlet cone and outlet cylinder of a blade, which contains its milled surfaces.
#[derive(Clone, Copy, Debug)]
pub struct Extent {
    /// Point of the inlet line, (r, z).
    inlet: Vector2<f64>,
    /// Direction of the inlet line; the space lies on its left.
    across: Vector2<f64>,
    /// Radius of the outlet.
    outlet: f64,
}

impl Extent {
    fn side(&self, r: f64, z: f64) -> f64 {
        self.across.x * (z - self.inlet.y) - self.across.y * (r - self.inlet.x)
    }

    /// Distance of a point beyond the inlet cone (`u` 0) or the outlet cylinder (1), by a measure that is zero there
    /// and linear in r and z.
    pub fn beyond(&self, u: f64, p: &Point3<f64>) -> f64 {
        let r = libm::hypot(p.x, p.y);
        if u > 0.5 { r - self.outlet } else { -self.side(r, p.z) / self.across.norm() }
    }

    /// True for a point in the space.
    pub fn holds(&self, p: &Point3<f64>) -> bool {
        let r = (p.x * p.x + p.y * p.y).sqrt();
        self.side(r, p.z) >= 0.0 && r <= self.outlet
    }
}

impl Part {
    /// Ends at hub and shroud of the straight line in the meridian plane, (r, z), to which a blade is turned at its
    /// inlet (`end` 0) or outlet (1). The main blade extends over the whole hub and shroud, a splitter as far as its
    /// faces.
    pub fn end_line(&self, blade: BladeId, end: f64) -> [Vector2<f64>; 2] {
        if blade == BladeId::MAIN {
            return [&self.hub, &self.shroud].map(|surface| surface.meridian(end).point);
        }
        let surface = &self.blade(blade).faces[0].surface;
        [0.0, 1.0].map(|v| {
            let p = surface.point(end, v);
            Vector2::new(libm::hypot(p.x, p.y), p.z)
        })
    }

    /// The extent of a blade.
    pub fn extent(&self, blade: BladeId) -> Extent {
        let [[hub, shroud], [outlet, over]] = [0.0, 1.0].map(|end| self.end_line(blade, end));
        let mut extent = Extent { inlet: hub, across: shroud - hub, outlet: f64::INFINITY };
        // The inlet line has the passage on its left.
        if extent.side(outlet.x, outlet.y) < 0.0 {
            extent.across = -extent.across;
        }
        extent.outlet = outlet.x.max(over.x);
        extent
    }
}
