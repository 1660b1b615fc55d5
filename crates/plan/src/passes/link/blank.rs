//! Distances of a tool from the turned blank and its clamping.

use ir::ClPoint;
use nalgebra::{Point3, Vector3};
use tool_stock::collide::ToolSolid;
use wheel::part::{Clamping, Stock, TurnedProfile};

/// Steps along the tool at which its distance to the blank is determined, mm.
const HEIGHT_STEP_MM: f64 = 1.0;

/// The turned blank, its clamping, and a tool.
pub(crate) struct Blank<'a> {
    /// Meridian as (r, z), closed from its last point to its first.
    profile: &'a TurnedProfile,
    clamping: &'a Clamping,
    /// Balls that hold the tool: heights of their centres over the tip, and radii, mm.
    balls: Vec<(f64, f64)>,
    /// [`Stock::sphere`].
    sphere: [f64; 2],
}

/// Lower bounds of the distances of a tool, mm; negative inside.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Distances {
    pub(crate) blank: f64,
    pub(crate) clamping: f64,
}

impl Distances {
    pub(crate) fn least(self) -> f64 {
        self.blank.min(self.clamping)
    }
}

impl<'a> Blank<'a> {
    pub(crate) fn new(stock: &'a Stock, tool: &ToolSolid) -> Self {
        let balls = balls_along(tool);
        Self { profile: &stock.profile, clamping: &stock.clamping, balls, sphere: stock.sphere() }
    }

    /// True when all of the tool is outside of the blank and farther from it than a distance, mm.
    pub(crate) fn clear(&self, at: &ClPoint, distance: f64) -> bool {
        self.highest_near(at, distance).is_none()
    }

    /// Height over the tip above which no point of the tool is in the blank, mm.
    pub(crate) fn height_within(&self, at: &ClPoint) -> f64 {
        self.highest_near(at, 0.0).unwrap_or(0.0)
    }

    /// Distances of the whole tool to blank and clamping.
    pub(crate) fn distance(&self, tip: &Point3<f64>, axis: &Vector3<f64>) -> Distances {
        let [centre, radius] = self.sphere;
        let mut found = Distances { blank: f64::INFINITY, clamping: f64::INFINITY };
        for &(s, around) in &self.balls {
            let p = tip + axis * s;
            let r = libm::hypot(p.x, p.y);
            let over = p.z - self.clamping.below.get();
            let clamping = self.clamping.radius.map_or(over, |radius| {
                let outside = r - radius.get();
                if over < 0.0 && outside < 0.0 {
                    over.max(outside)
                } else {
                    libm::hypot(over.max(0.0), outside.max(0.0))
                }
            });
            found.clamping = found.clamping.min(clamping - around);
            // The sphere decides for most of a long tool.
            if libm::hypot(r, p.z - centre) - radius - around < found.blank {
                found.blank = found.blank.min(self.profile.distance([r, p.z]) - around);
            }
        }
        found
    }

    /// Greatest height over the tip at which the tool is in the blank or nearer to it than a distance, mm.
    fn highest_near(&self, at: &ClPoint, distance: f64) -> Option<f64> {
        let near = |&&(s, around): &&(f64, f64)| {
            let p = at.tip + at.axis * s;
            self.profile.distance([libm::hypot(p.x, p.y), p.z]) <= around + distance
        };
        self.balls.iter().rev().find(near).map(|ball| ball.0)
    }
}

/// Balls that hold a tool, each from its height over the tip to the next height: heights and radii, mm.
fn balls_along(tool: &ToolSolid) -> Vec<(f64, f64)> {
    let count = (tool.length() / HEIGHT_STEP_MM).ceil() as usize;
    let ball = |k: usize| {
        let s = k as f64 * HEIGHT_STEP_MM;
        let sections = tool.shank.iter().chain(&tool.holder);
        let body = sections.filter(|x| x.from <= s + HEIGHT_STEP_MM && s <= x.to + HEIGHT_STEP_MM);
        let widest = body.map(|x| x.radius_from.max(x.radius_to)).fold(tool.radius(), f64::max);
        (s, widest + HEIGHT_STEP_MM)
    };
    (0..=count).map(ball).collect()
}
