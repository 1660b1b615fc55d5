//! The swept solid of a tool: cutter, shank and holder as bodies of revolution about the tool axis.
//!
//! A point is given by its distance `rho` from the axis and its height `s` over the tip. Distances are signed,
//! negative inside.

use super::cutter::Cutter;
use super::meridian::{Slope, norm};
use nalgebra::{Point3, Vector3};

/// Share by which squares of distances are off by rounding, at most.
const SQUARE_ROUNDING: f64 = 1e-9;

/// A frustum of the non-cutting part.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(try_from = "StoredSection"))]
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
    /// Least of the signed distances to closed frustums; infinite without any.
    #[inline]
    pub fn least_distance<'a>(sections: impl IntoIterator<Item = &'a Self>, rho: f64, s: f64) -> f64 {
        let (mut outside, mut inside) = (f64::INFINITY, None::<f64>);
        // One root for all: planner and verifier call this function most often.
        for section in sections {
            let beyond = (section.from - s).max(s - section.to);
            // A frustum that ends farther above or below is no nearer.
            if beyond > 0.0 && beyond * beyond * (1.0 - SQUARE_ROUNDING) > outside {
                continue;
            }
            let [bottom, top, side] = section.offsets(rho, s).map(|(r, h)| r * r + h * h);
            let square = bottom.min(top).min(side);
            if section.holds(rho, s) {
                inside = Some(inside.map_or(square, |most| most.max(square)));
            } else {
                outside = outside.min(square);
            }
        }
        inside.map_or_else(|| outside.sqrt(), |most| -most.sqrt())
    }

    /// Signed distance to the closed frustum.
    #[inline]
    pub fn distance(&self, rho: f64, s: f64) -> f64 {
        Self::least_distance([self], rho, s)
    }

    /// [`Self::distance`] with its gradient; at a kink the gradient of one side.
    #[inline]
    pub fn slope(&self, rho: f64, s: f64) -> Slope {
        let mut nearest = Slope { value: f64::INFINITY, rho: 1.0, s: 0.0 };
        for (r, h) in self.offsets(rho, s) {
            let gap = norm(r, h);
            if gap < nearest.value {
                // On the outline itself any direction is valid.
                let (r, h) = if gap > 0.0 { (r / gap, h / gap) } else { (1.0, 0.0) };
                nearest = Slope { value: gap, rho: r, s: h };
            }
        }
        let sign = if self.holds(rho, s) { -1.0 } else { 1.0 };
        Slope { value: sign * nearest.value, rho: sign * nearest.rho, s: sign * nearest.s }
    }

    /// Vectors to a point from the three edges of the half section: bottom, top, side.
    #[inline]
    fn offsets(&self, rho: f64, s: f64) -> [(f64, f64); 3] {
        let (dr, ds) = (self.radius_to - self.radius_from, self.to - self.from);
        let (out, up) = (rho - self.radius_from, s - self.from);
        let length = dr * dr + ds * ds;
        let t = if length > 0.0 { ((out * dr + up * ds) / length).clamp(0.0, 1.0) } else { 0.0 };
        [(out.max(0.0), up), ((rho - self.radius_to).max(0.0), s - self.to), (out - t * dr, up - t * ds)]
    }

    /// True inside of the frustum.
    #[inline]
    fn holds(&self, rho: f64, s: f64) -> bool {
        let (dr, ds) = (self.radius_to - self.radius_from, self.to - self.from);
        let (out, up) = (rho - self.radius_from, s - self.from);
        up > 0.0 && s < self.to && out * ds - up * dr < 0.0
    }
}

/// Cutter, shank and holder of a tool; height 0 is the tip.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(try_from = "StoredTool"))]
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
    #[inline]
    pub fn radius(&self) -> f64 {
        self.cutter.radius_at(self.flute_length)
    }

    /// Signed distance to the cutting part, closed by a plane at the end of the flutes. Exact inside and outside,
    /// therefore convex, and changing no faster than the point moves.
    #[inline]
    pub fn cutter_distance(&self, rho: f64, s: f64) -> f64 {
        // Far below the end of the flutes only the side matters; this is nearly always the case.
        let side = self.cutter.distance(rho, s);
        if s + side.abs() < self.flute_length { side } else { self.capped(self.cutter.slope(rho, s), rho, s).value }
    }

    /// [`Self::cutter_distance`] with its gradient.
    #[inline]
    pub fn cutter_slope(&self, rho: f64, s: f64) -> Slope {
        let side = self.cutter.slope(rho, s);
        if s + side.value.abs() < self.flute_length { side } else { self.capped(side, rho, s) }
    }

    #[inline]
    fn capped(&self, side: Slope, rho: f64, s: f64) -> Slope {
        let over = s - self.flute_length;
        let foot = s - side.value * side.s;
        if foot <= self.flute_length && side.value >= over {
            return side;
        }
        let out = rho - self.radius();
        if out <= 0.0 || (over <= 0.0 && side.value <= 0.0) {
            return Slope { value: over, rho: 0.0, s: 1.0 };
        }
        let value = norm(out, over);
        Slope { value, rho: out / value, s: over / value }
    }

    /// Signed distance to shank and holder.
    #[inline]
    pub fn body_distance(&self, rho: f64, s: f64) -> f64 {
        Section::least_distance(self.shank.iter().chain(&self.holder), rho, s)
    }

    /// Signed distance to the whole tool.
    #[inline]
    pub fn distance(&self, rho: f64, s: f64) -> f64 {
        self.cutter_distance(rho, s).min(self.body_distance(rho, s))
    }

    /// The cutter without shank and holder, enlarged by a distance on all sides; heights count from its new tip.
    #[must_use]
    #[inline]
    pub fn cutter_alone(&self, by: f64) -> Self {
        Self {
            cutter: self.cutter.enlarged(by),
            flute_length: self.flute_length + 2.0 * by,
            shank: Vec::new(),
            holder: Vec::new(),
        }
    }

    /// A tool that holds all places of this one while it leaves along its axis by up to a distance, mm: its flutes are
    /// longer by this distance, and no section of shank and holder is thinner than one below it.
    #[must_use]
    #[inline]
    pub fn swept_along_axis(&self, distance: f64) -> Self {
        let mut widest = 0.0_f64;
        let mut swept = |x: &Section| {
            let radius_from = x.radius_from.max(widest);
            widest = widest.max(x.radius_from).max(x.radius_to);
            Section { radius_from, radius_to: widest, ..*x }
        };
        let [shank, holder] = [&self.shank, &self.holder].map(|sections| sections.iter().map(&mut swept).collect());
        let mut tool = Self { cutter: self.cutter, flute_length: self.flute_length + distance, shank, holder };
        if let Some(last) = tool.holder.last_mut().or(tool.shank.last_mut()) {
            last.to += distance;
        }
        tool
    }

    /// Upper bound of the distance of any point of the tool from its tip, mm.
    pub fn arm(&self) -> f64 {
        let sections = self.shank.iter().chain(&self.holder);
        self.length() + sections.map(|s| s.radius_from.max(s.radius_to)).fold(self.radius(), f64::max)
    }

    /// Upper end of the holder.
    #[inline]
    pub fn length(&self) -> f64 {
        self.shank.iter().chain(&self.holder).map(|x| x.to).fold(self.flute_length, f64::max)
    }
}

/// Distance from the tool axis and height over the tip of a point, for a tool with a given tip and unit axis.
#[inline]
pub fn tool_coordinates(p: &Point3<f64>, tip: &Point3<f64>, axis: &Vector3<f64>) -> (f64, f64) {
    let d = p - tip;
    let s = d.dot(axis);
    // The cross product instead of a difference of squares: exact near the axis.
    (d.cross(axis).norm(), s)
}

/// A frustum.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredSection {
    from: f64,
    to: f64,
    radius_from: f64,
    radius_to: f64,
}

#[cfg(feature = "serde")]
impl TryFrom<StoredSection> for Section {
    type Error = &'static str;

    fn try_from(StoredSection { from, to, radius_from, radius_to }: StoredSection) -> Result<Self, Self::Error> {
        let sizes = [from, to, radius_from, radius_to];
        if sizes.iter().all(|x| x.is_finite() && *x >= 0.0) && from <= to {
            Ok(Self { from, to, radius_from, radius_to })
        } else {
            Err("a section of the tool has no height or a negative size")
        }
    }
}

/// Cutter, shank and holder.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredTool {
    cutter: Cutter,
    flute_length: f64,
    shank: Vec<Section>,
    holder: Vec<Section>,
}

#[cfg(feature = "serde")]
impl TryFrom<StoredTool> for ToolSolid {
    type Error = &'static str;

    fn try_from(StoredTool { cutter, flute_length, shank, holder }: StoredTool) -> Result<Self, Self::Error> {
        if flute_length.is_finite() && flute_length > 0.0 {
            Ok(Self { cutter, flute_length, shank, holder })
        } else {
            Err("the flutes of a tool have no length")
        }
    }
}
