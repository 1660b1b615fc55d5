//! The way from the points that were imported to the frame of the job.
//!
//! The language has the axis of rotation in Z with the inlet above the outlet. A blade whose flow goes towards +Z is turned
//! over: about X by half a turn, which mirrors nothing. Then the wheel moves along Z, where the caller wants its zero elsewhere.

use super::Imported;
use base::units::trim;
use blade::outline::DividedSection;
use nalgebra::Point3;

/// Place on the axis of rotation that becomes zero of the part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Zero {
    /// The origin of the files.
    #[default]
    File,
    /// The height of the highest point of blades, hub and shroud.
    Top,
}

/// The frame of the job, against that of the points that were imported.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct JobFrame {
    /// True where the wheel is turned over.
    pub(super) over: bool,
    /// Way along Z after that, mm.
    shift: f64,
}

impl JobFrame {
    /// The frame for a wheel with these sections of its blades, and curves (r, z) of hub and shroud.
    pub(super) fn of(
        zero: Zero,
        imported: &Imported,
        divided: &[Vec<DividedSection>],
        ends: Option<[&[[f64; 2]]; 2]>,
    ) -> Self {
        let unmoved = Self { over: upward(imported, divided), shift: 0.0 };
        let outlines = divided.iter().flatten().map(|d| &d.outline);
        let blades = outlines.flat_map(|o| o.faces.iter().chain(&o.edges).flatten()).map(|p| p.z);
        let curves = ends.into_iter().flatten().flatten().map(|[_, z]| *z);
        let highest = blades.chain(curves).map(|z| unmoved.height(z)).fold(f64::NEG_INFINITY, f64::max);
        match zero {
            Zero::Top if highest.is_finite() => Self { shift: -highest, ..unmoved },
            _ => unmoved,
        }
    }

    /// A point in the frame of the job.
    pub(super) fn point(&self, p: &Point3<f64>) -> Point3<f64> {
        Point3::new(p.x, if self.over { -p.y } else { p.y }, self.height(p.z))
    }

    /// A height in the frame of the job.
    pub(super) fn height(&self, z: f64) -> f64 {
        (if self.over { -z } else { z }) + self.shift
    }

    /// What was done to the points, in sentences.
    pub(super) fn sentences(&self) -> Vec<String> {
        let mut lines = Vec::new();
        if self.over {
            lines.push(
                "Turned over about X, so that the inlet is up: y and z have the other sign than in the file."
                    .to_owned(),
            );
        }
        if self.shift != 0.0 {
            lines.push(format!("Moved by {} mm along Z, so that the highest point is at zero.", trim(self.shift, 7)));
        }
        lines
    }
}

/// Whether the flow goes towards +Z: by hub and shroud, otherwise by the edges of the main blade.
fn upward(imported: &Imported, divided: &[Vec<DividedSection>]) -> bool {
    let ends = |line: &Vec<[f64; 2]>| Some(line.last()?[1] - line.first()?[1]);
    let of_blade = || {
        let outline = &divided.first()?.first()?.outline;
        Some(outline.faces[0].last()?.z - outline.faces[0].first()?.z)
    };
    let of_line = imported.hub.as_ref().or(imported.shroud.as_ref()).and_then(ends);
    of_line.or_else(of_blade).is_some_and(|dz| dz > 0.0)
}
