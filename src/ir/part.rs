//! The design part: vanes, hub, shroud, fillets.

use crate::geom::{NurbsCurve, Revolution, RuledSurface};
use crate::units::Mm;
use nalgebra::{Point3, Rotation3, Vector2, Vector3};

/// Side of a vane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Side {
    /// Pressure side.
    Pressure,
    /// Suction side.
    Suction,
}

impl Side {
    /// Name in the job language.
    pub fn name(self) -> &'static str {
        match self {
            Self::Pressure => "pressure",
            Self::Suction => "suction",
        }
    }

    /// The other one.
    pub fn other(self) -> Self {
        match self {
            Self::Pressure => Self::Suction,
            Self::Suction => Self::Pressure,
        }
    }
}

/// One face of a vane: a ruled surface, u from inlet (0) to outlet (1), v from root (0, at the hub) to tip (1, at the
/// shroud). Its material lies on the side opposite to the outward normal.
#[derive(Clone, Debug)]
pub struct Face {
    /// The surface of sector 0, root and tip curves on equal parameters (Wei 17).
    pub surface: RuledSurface,
    /// +1 when S_u x S_v points out of the material, else -1.
    pub orientation: f64,
}

impl Face {
    /// Unit normal out of the material, sector 0.
    pub fn normal(&self, u: f64, v: f64) -> Vector3<f64> {
        self.surface.normal(u, v) * self.orientation
    }
}

/// The two faces of the vane of sector 0.
#[derive(Clone, Debug)]
pub struct Vane {
    /// Pressure face.
    pub pressure: Face,
    /// Suction face.
    pub suction: Face,
}

/// The design part. Sector k is sector 0 turned about Z by k pitches (Wei 18).
#[derive(Clone, Debug)]
pub struct Part {
    /// Number of vanes.
    pub vane_count: u32,
    /// Vane of sector 0.
    pub vane: Vane,
    /// Hub: outward normal points into the channel.
    pub hub: Revolution,
    /// Surface of the vane tips.
    pub shroud: Revolution,
    /// Fillet radius between vane and hub; `None` for a sharp root.
    pub fillet: Option<Mm>,
    /// Face on the clockwise wall of channel 0 (it belongs to vane 0); the other wall is the other side of vane 1.
    pub first_wall: Side,
}

/// Root and tip curve of a face.
#[derive(Clone, Debug)]
pub struct Guides {
    /// Curve at the hub.
    pub root: NurbsCurve,
    /// Curve at the shroud.
    pub tip: NurbsCurve,
}

impl Part {
    /// The part of a vane's guide curves, with hub and shroud turned from curves of the vane. Orientation of the faces
    /// and the order of the walls are found from the geometry.
    pub fn new(
        vane_count: u32,
        pressure: Guides,
        suction: Guides,
        hub: NurbsCurve,
        shroud: NurbsCurve,
        fillet: Option<Mm>,
    ) -> Self {
        let pressure = RuledSurface { root: pressure.root, tip: pressure.tip };
        let suction = RuledSurface { root: suction.root, tip: suction.tip };
        // A face points away from the other face of its vane.
        let across = pressure.point(0.5, 0.5) - suction.point(0.5, 0.5);
        let sign = |x: f64| if x < 0.0 { -1.0 } else { 1.0 };
        let orientation = [sign(pressure.normal(0.5, 0.5).dot(&across)), sign(-suction.normal(0.5, 0.5).dot(&across))];
        let middle = |s: &RuledSurface| s.point(0.5, 0.5);
        let (p, s) = (middle(&pressure), middle(&suction));
        // The suction face is ahead (counter-clockwise) when the turn from pressure to suction is positive.
        let first_wall = if p.x * s.y - p.y * s.x > 0.0 { Side::Suction } else { Side::Pressure };
        let meridian = |q: nalgebra::Point3<f64>| Vector2::new(libm::hypot(q.x, q.y), q.z);
        let outside = meridian(pressure.point(0.5, 1.0));
        // Beyond the tips by the height of the vane.
        let beyond = meridian(pressure.point(0.5, 2.0));
        Self {
            vane_count,
            hub: Revolution::new(hub, outside),
            shroud: Revolution::new(shroud, beyond),
            vane: Vane {
                pressure: Face { surface: pressure, orientation: orientation[0] },
                suction: Face { surface: suction, orientation: orientation[1] },
            },
            fillet,
            first_wall,
        }
    }

    /// Angle between neighbouring vanes.
    pub fn pitch(&self) -> f64 {
        std::f64::consts::TAU / f64::from(self.vane_count)
    }

    /// Turn that carries sector 0 to a sector.
    pub fn sector_rotation(&self, sector: u32) -> Rotation3<f64> {
        Rotation3::from_axis_angle(&Vector3::z_axis(), self.pitch() * f64::from(sector))
    }

    /// Face of the vane of sector 0.
    pub fn face(&self, side: Side) -> &Face {
        match side {
            Side::Pressure => &self.vane.pressure,
            Side::Suction => &self.vane.suction,
        }
    }

    /// Point of a face of a sector.
    pub fn face_point(&self, side: Side, sector: u32, u: f64, v: f64) -> Point3<f64> {
        self.sector_rotation(sector) * self.face(side).surface.point(u, v)
    }
}
