//! The swept solid of a tool: cutter, shank and holder as bodies of revolution about the tool axis.
//!
//! A point is given by its distance `rho` from the axis and its height `s` over the tip. Distances are signed,
//! negative inside.

use nalgebra::{Point3, Vector3};

/// Cutting part; it goes up to the end of the flutes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cutter {
    /// Flat end mill.
    Flat {
        /// Radius.
        radius: f64,
    },
    /// Ball end mill.
    Ball {
        /// Radius.
        radius: f64,
    },
    /// Bull nose end mill.
    Bull {
        /// Radius.
        radius: f64,
        /// Corner radius, below the radius.
        corner: f64,
    },
    /// Tapered ball end mill.
    TaperedBall {
        /// Radius of the ball.
        ball: f64,
        /// Angle between axis and side, radians, in (0, pi/4).
        half_angle: f64,
    },
}

impl Cutter {
    /// Signed distance to the cutter, its side continued upward without end. Exact inside and outside.
    pub fn distance(&self, rho: f64, s: f64) -> f64 {
        match *self {
            Self::Flat { radius } => rounded_box(rho, s, radius, 0.0),
            Self::Bull { radius, corner } => rounded_box(rho, s, radius, corner),
            Self::Ball { radius } => {
                if s < radius {
                    norm(rho, s - radius) - radius
                } else {
                    rho - radius
                }
            }
            Self::TaperedBall { ball, half_angle } => {
                // Side line through the tangent point of the ball; its region begins at the normal of the ball there.
                let (sin, cos) = half_angle.sin_cos();
                let height = s - ball;
                if height * cos + rho * sin > 0.0 { rho * cos - height * sin - ball } else { norm(rho, height) - ball }
            }
        }
    }

    /// Radius at a height over the tip, zero below it.
    pub fn radius_at(&self, s: f64) -> f64 {
        if s < 0.0 {
            return 0.0;
        }
        match *self {
            Self::Flat { radius } => radius,
            Self::Ball { radius } => cap(radius, s),
            Self::Bull { radius, corner } => radius - corner + cap(corner, s),
            Self::TaperedBall { ball, half_angle } => {
                let tangent = ball * (1.0 - half_angle.sin());
                if s < tangent { cap(ball, s) } else { (ball + (s - ball) * half_angle.sin()) / half_angle.cos() }
            }
        }
    }

    /// Radius of the rounding that meets the floor: the ball radius, or the corner radius; zero for a flat end.
    pub fn tip_radius(&self) -> f64 {
        match *self {
            Self::Flat { .. } => 0.0,
            Self::Ball { radius } => radius,
            Self::Bull { corner, .. } => corner,
            Self::TaperedBall { ball, .. } => ball,
        }
    }

    /// Name in the job language.
    pub fn keyword(&self) -> &'static str {
        match self {
            Self::Flat { .. } => "flat",
            Self::Ball { .. } => "ball",
            Self::Bull { .. } => "bull",
            Self::TaperedBall { .. } => "tapered-ball",
        }
    }
}

/// Length of a vector of moderate size: several times as fast as `hypot`, which guards against overflow.
fn norm(x: f64, y: f64) -> f64 {
    (x * x + y * y).sqrt()
}

/// Radius of a ball of this radius at height s over its lowest point, its own radius above the centre.
fn cap(radius: f64, s: f64) -> f64 {
    if s < radius { (s * (2.0 * radius - s)).max(0.0).sqrt() } else { radius }
}

/// Cylinder over s >= 0, open upward, with a rounded lower corner.
fn rounded_box(rho: f64, s: f64, radius: f64, corner: f64) -> f64 {
    let out = rho - (radius - corner);
    let below = corner - s;
    norm(out.max(0.0), below.max(0.0)) + out.max(below).min(0.0) - corner
}

/// A frustum of the non-cutting part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section {
    /// Lower height over the tip.
    pub from: f64,
    /// Upper height.
    pub to: f64,
    /// Radius at the lower height.
    pub radius_from: f64,
    /// Radius at the upper height.
    pub radius_to: f64,
}

impl Section {
    /// Signed distance to the closed frustum.
    pub fn distance(&self, rho: f64, s: f64) -> f64 {
        let (dr, ds) = (self.radius_to - self.radius_from, self.to - self.from);
        // Distances to the three edges of the half section: bottom, top, side.
        let to_segment = |r0: f64, s0: f64, r1: f64, s1: f64| {
            let (er, es) = (r1 - r0, s1 - s0);
            let length = er * er + es * es;
            let t = if length > 0.0 { (((rho - r0) * er + (s - s0) * es) / length).clamp(0.0, 1.0) } else { 0.0 };
            norm(rho - r0 - t * er, s - s0 - t * es)
        };
        let gap = to_segment(0.0, self.from, self.radius_from, self.from)
            .min(to_segment(0.0, self.to, self.radius_to, self.to))
            .min(to_segment(self.radius_from, self.from, self.radius_to, self.to));
        let inside = s > self.from && s < self.to && (rho - self.radius_from) * ds - (s - self.from) * dr < 0.0;
        if inside { -gap } else { gap }
    }
}

/// Cutter, shank and holder of a tool; height 0 is the tip.
#[derive(Clone, Debug, PartialEq)]
pub struct ToolSolid {
    /// Cutting part.
    pub cutter: Cutter,
    /// End of the flutes.
    pub flute_length: f64,
    /// Shank, from the end of the flutes to the holder.
    pub shank: Vec<Section>,
    /// Holder.
    pub holder: Vec<Section>,
}

impl ToolSolid {
    /// Half of the cutting diameter; for a tapered tool at the end of the flutes.
    pub fn radius(&self) -> f64 {
        self.cutter.radius_at(self.flute_length)
    }

    /// Signed distance to the cutting part; above the end of the flutes it is closed by a plane.
    pub fn cutter_distance(&self, rho: f64, s: f64) -> f64 {
        let side = self.cutter.distance(rho, s);
        if s <= self.flute_length {
            return side;
        }
        // Above the plane: distance to the disc at the end of the flutes.
        norm((rho - self.radius()).max(0.0), s - self.flute_length)
    }

    /// Signed distance to shank and holder.
    pub fn body_distance(&self, rho: f64, s: f64) -> f64 {
        self.shank.iter().chain(&self.holder).map(|x| x.distance(rho, s)).fold(f64::INFINITY, f64::min)
    }

    /// Signed distance to the whole tool.
    pub fn distance(&self, rho: f64, s: f64) -> f64 {
        self.cutter_distance(rho, s).min(self.body_distance(rho, s))
    }

    /// Upper end of the holder.
    pub fn length(&self) -> f64 {
        self.shank.iter().chain(&self.holder).map(|x| x.to).fold(self.flute_length, f64::max)
    }
}

/// Distance from the tool axis and height over the tip of a point, for a tool at a tip and a unit axis.
pub fn tool_coordinates(p: &Point3<f64>, tip: &Point3<f64>, axis: &Vector3<f64>) -> (f64, f64) {
    let d = p - tip;
    let s = d.dot(axis);
    // Cross product instead of the difference of squares: exact near the axis.
    (d.cross(axis).norm(), s)
}
