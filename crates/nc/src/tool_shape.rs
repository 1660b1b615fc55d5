//! What a text says of the shape of a tool, and whether the tool of the job has it.

use ir::Tool;

/// Largest difference of a length from that of the tool, mm: the digits of words, and their effect on the profile.
const SHAPE_ROUNDING_MM: f64 = 2e-4;

/// Places of the profile that are compared.
const PROFILE_SAMPLES: u32 = 64;

/// What a text says of the tool of a section besides its number or name.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NcToolShape {
    /// Length from the tip to the gauge line, mm.
    pub length: Option<f64>,
    /// Cutter.
    pub cutter: Option<NcCutter>,
}

/// A cutter by the seven parameters of APT: a lower line from the end of the axis outwards, a corner arc, and an upper
/// line. Lengths in mm, angles in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NcCutter {
    /// Twice the distance from the axis to the point where both lines meet.
    pub diameter: f64,
    /// Radius of the corner arc.
    pub corner: f64,
    /// Distance of the centre of the arc from the axis.
    pub across: f64,
    /// Height of the centre of the arc over the end.
    pub up: f64,
    /// Angle of the lower line over the plane across the axis.
    pub lower: f64,
    /// Angle between the upper line and the axis; positive when the cutter widens upward.
    pub upper: f64,
    /// Height of the cutter, where the text states it.
    pub height: Option<f64>,
}

impl NcCutter {
    /// A cylinder with a corner radius, as two parameters give it.
    pub fn cylinder(diameter: f64, corner: f64) -> Self {
        Self { diameter, corner, across: diameter / 2.0 - corner, up: corner, lower: 0.0, upper: 0.0, height: None }
    }

    /// Distance from the axis at a height over the end. Of a flat end (`lower` is 0) only.
    fn radius_at(&self, s: f64) -> f64 {
        let (sine, cosine) = (libm::sin(self.upper), libm::cos(self.upper));
        let over = s - self.up;
        if over < -self.corner * sine {
            return self.across + (self.corner * self.corner - over * over).max(0.0).sqrt();
        }
        (self.across * cosine + self.corner + over * sine) / cosine
    }

    /// Whether arc and lines meet without a step.
    fn closes(&self) -> bool {
        let ends = (self.up - self.corner).abs().max((2.0 * self.radius_on_line(0.0) - self.diameter).abs());
        self.lower == 0.0 && self.across > -SHAPE_ROUNDING_MM && ends < 4.0 * SHAPE_ROUNDING_MM
    }

    /// Distance of the upper line from the axis at a height.
    fn radius_on_line(&self, s: f64) -> f64 {
        let (sine, cosine) = (libm::sin(self.upper), libm::cos(self.upper));
        (self.across * cosine + self.corner + (s - self.up) * sine) / cosine
    }
}

/// In what the tool of a text is not that of the job.
pub(super) fn difference(shape: &NcToolShape, tool: &Tool) -> Option<String> {
    if let Some(length) = shape.length.filter(|l| (l - tool.length()).abs() > SHAPE_ROUNDING_MM) {
        return Some(format!("the length {length} mm; the tool {} of the job has {:.4} mm", tool.name, tool.length()));
    }
    let cutter = shape.cutter?;
    let flute = tool.solid.flute_length;
    let off = (1..=PROFILE_SAMPLES)
        .map(|k| flute * f64::from(k) / f64::from(PROFILE_SAMPLES))
        .map(|s| (cutter.radius_at(s) - tool.solid.cutter.radius_at(s)).abs())
        .fold(0.0, f64::max);
    if !cutter.closes() || off > SHAPE_ROUNDING_MM {
        let what = tool.solid.cutter.keyword();
        return Some(format!("a cutter that is not the {what} {} of the job", tool.name));
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_4;

    #[test]
    fn seven_parameters_give_the_known_profiles() {
        let ball = NcCutter::cylinder(6.0, 3.0);
        assert!(ball.closes() && (ball.radius_at(1.5) - 6.75f64.sqrt()).abs() < 1e-12);
        assert_eq!([ball.radius_at(3.0), ball.radius_at(20.0)], [3.0, 3.0]);
        let flat = NcCutter::cylinder(8.0, 0.0);
        assert!(flat.closes() && flat.radius_at(0.0) == 4.0);
        // A ball of 2 mm with sides tilted by 45 deg: they touch it at the height 2 - sqrt 2.
        let diameter = 4.0 * (std::f64::consts::PI / 8.0).tan();
        let taper =
            NcCutter { diameter, corner: 2.0, across: 0.0, up: 2.0, lower: 0.0, upper: FRAC_PI_4, height: None };
        let at = 2.0 - 2f64.sqrt();
        assert!(taper.closes() && (taper.radius_at(at) - 2f64.sqrt()).abs() < 1e-12);
        assert!((taper.radius_at(at + 5.0) - 2f64.sqrt() - 5.0).abs() < 1e-12);
        assert!(!NcCutter { diameter: 4.0, ..taper }.closes());
    }
}
