//! Files of sections as TurboGrid and BladeGen read them: an index, hub, shroud, and the profiles of the blades.
//!
//! `import` reads the same form. Lengths are in mm, rounded to 1e-9 mm; the axis of rotation is Z.

use nalgebra::Point3;
use nurbs::Revolution;
use std::fmt::Write;
use wheel::part::Part;
use wheel::part::blade_loops::BladeLoops;

/// Steps along hub and shroud.
const MERIDIAN_STEPS: usize = 200;

/// Names of the files of hub, shroud and profiles.
pub struct TurboGridNames {
    /// File of the hub.
    pub hub: String,
    /// File of the shroud.
    pub shroud: String,
    /// File of the profiles.
    pub profile: String,
}

/// Texts of the four files.
pub struct TurboGridFiles {
    /// The `.inf` file.
    pub index: String,
    /// Points of the hub from inlet to outlet, in the plane of X and Z.
    pub hub: String,
    /// The same of the shroud.
    pub shroud: String,
    /// Sections of all blades of a sector.
    pub profile: String,
}

/// The files of a part with loops round its blades; `title` is a comment of a line.
pub fn turbogrid(part: &Part, blades: &[BladeLoops], names: &TurboGridNames, title: &str) -> TurboGridFiles {
    let mut index = format!(
        "! {title}\nAxis of Rotation: Z\nNumber of Blade Sets: {}\nNumber of Blades Per Set: {}\nGeometry Units: MM\n\
         Coordinate System Orientation: Righthanded\nBlade Loft Direction: Spanwise\n",
        part.vane_count,
        blades.len()
    );
    let mut profile = String::new();
    for (k, blade) in blades.iter().enumerate() {
        for (end, rounded) in ["LE", "TE"].iter().zip(blade.rounded) {
            let form = if rounded { "EllipseEnd" } else { "CutOffEnd" };
            let _ = writeln!(index, "Blade {k} {end}: {form}");
        }
        let _ = writeln!(profile, "## {}", part.blade(blade.blade).name);
        let last = blade.loops.len().max(2) - 1;
        for (j, points) in blade.loops.iter().enumerate() {
            let _ = writeln!(profile, "# Profile {} at {:.6}%", j + 1, 100.0 * j as f64 / last as f64);
            profile.push_str(&lines(points));
        }
    }
    let TurboGridNames { hub, shroud, profile: profiles } = names;
    let _ = write!(index, "Hub Data File: {hub}\nShroud Data File: {shroud}\nProfile Data File: {profiles}\n");
    let meridian = |surface: &Revolution| {
        let points: Vec<Point3<f64>> =
            (0..=MERIDIAN_STEPS).map(|i| surface.point(i as f64 / MERIDIAN_STEPS as f64, 0.0)).collect();
        lines(&points)
    };
    TurboGridFiles { index, hub: meridian(&part.hub), shroud: meridian(&part.shroud), profile }
}

fn lines(points: &[Point3<f64>]) -> String {
    points.iter().map(|p| format!("{:.9} {:.9} {:.9}\n", p.x, p.y, p.z)).collect()
}
