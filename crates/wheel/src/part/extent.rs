//! Extent of the milled surfaces of a blade: between its inlet cone and its outlet cylinder.

use super::{BladeId, Part, Surface};
use nalgebra::{Point3, Vector2};

/// The space between the ends of a blade, which contains its milled surfaces: between inlet cone and outlet cylinder, or
/// outlet cone for a blade whose outlet is rather axial.
#[derive(Clone, Copy, Debug)]
pub struct Extent {
    inlet: EndLine,
    outlet: Outlet,
}

/// A straight line of the meridian plane, (r, z), with the space on its left.
#[derive(Clone, Copy, Debug)]
struct EndLine {
    from: Vector2<f64>,
    across: Vector2<f64>,
}

#[derive(Clone, Copy, Debug)]
enum Outlet {
    /// Its radius.
    Cylinder(f64),
    Cone(EndLine),
}

impl EndLine {
    /// The line through two points, with a point `inside` on its left.
    fn through([from, to]: [Vector2<f64>; 2], inside: Vector2<f64>) -> Self {
        let line = Self { from, across: to - from };
        if line.side(inside.x, inside.y) < 0.0 { Self { across: -line.across, ..line } } else { line }
    }

    fn side(&self, r: f64, z: f64) -> f64 {
        self.across.x * (z - self.from.y) - self.across.y * (r - self.from.x)
    }
}

impl Extent {
    /// Distance of a point beyond the inlet (`u` 0) or the outlet (1), by a measure that is zero there and linear in r and
    /// z.
    pub fn beyond(&self, u: f64, p: &Point3<f64>) -> f64 {
        let r = libm::hypot(p.x, p.y);
        let over = |line: &EndLine| -line.side(r, p.z) / line.across.norm();
        match &self.outlet {
            _ if u <= 0.5 => over(&self.inlet),
            Outlet::Cylinder(radius) => r - radius,
            Outlet::Cone(line) => over(line),
        }
    }

    /// True for a point in the space.
    pub fn holds(&self, p: &Point3<f64>) -> bool {
        let r = (p.x * p.x + p.y * p.y).sqrt();
        let before = match &self.outlet {
            Outlet::Cylinder(radius) => r <= *radius,
            Outlet::Cone(line) => line.side(r, p.z) >= 0.0,
        };
        before && self.inlet.side(r, p.z) >= 0.0
    }
}

impl Part {
    /// Ends at hub and shroud of the straight line in the meridian plane, (r, z), to which a blade is turned at its
    /// inlet (`end` 0) or outlet (1). The main blade extends over the whole hub and shroud, a splitter as far as its
    /// faces. A blade whose edge is a surface of its own ends inside of the part.
    pub fn end_line(&self, blade: BladeId, end: f64) -> [Vector2<f64>; 2] {
        if blade == BladeId::MAIN || self.blade(blade).edges[usize::from(end > 0.5)].is_some() {
            return [&self.hub, &self.shroud].map(|surface| surface.meridian(end).point);
        }
        let surface = &self.blade(blade).faces[0].surface;
        [0.0, 1.0].map(|v| {
            let p = surface.point(end, v);
            Vector2::new(libm::hypot(p.x, p.y), p.z)
        })
    }

    /// True where a blade ends inside of the part at its inlet (`end` 0) or outlet (1): at an edge that is a surface of its
    /// own, or at the edge of a splitter that is shorter than the main blades.
    pub fn ends_inside(&self, blade: BladeId, end: usize) -> bool {
        /// Distance of the ends that is rounding of the curves, mm.
        const SAME_END_MM: f64 = 0.05;
        let [u, v] = [end as f64, 0.5];
        let inside =
            || self.extent(BladeId::MAIN).beyond(u, &self.blade(blade).faces[0].surface.point(u, v)) < -SAME_END_MM;
        self.edge(blade, end).is_some() || (blade != BladeId::MAIN && inside())
    }

    /// True when the outlet lies rather in the direction of the axis: blisks of axial machines.
    pub fn axial_outlet(&self) -> bool {
        let [hub, shroud] = self.end_line(BladeId::MAIN, 1.0);
        (shroud.x - hub.x).abs() > (shroud.y - hub.y).abs()
    }

    /// The extent of a blade.
    pub fn extent(&self, blade: BladeId) -> Extent {
        let [inlet, outlet] = [0.0, 1.0].map(|end| self.end_line(blade, end));
        let outlet_surface = if self.axial_outlet() {
            Outlet::Cone(EndLine::through(outlet, inlet[0]))
        } else {
            Outlet::Cylinder(outlet[0].x.max(outlet[1].x))
        };
        Extent { inlet: EndLine::through(inlet, outlet[0]), outlet: outlet_surface }
    }
}
