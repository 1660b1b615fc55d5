//! Hub and shroud of the wheel: where its blades end on them, which ends the lathe makes, and the points of both meridians.

use super::blade::{ENDS, StepBlade};
use super::face::StepFace;
use super::meridian::{StepMeridian, flat};
use super::revolved;
use super::turned_faces::{self, TurnedMeridian};
use crate::found::Found;
use base::source::Span;
use base::units::trim;
use blade::EdgeForm;
use diagnostics::Diag;
use diagnostics::codes::import as codes;
use nalgebra::{Point3, Vector2};
use nurbs::interpolate;

/// Largest distance of an end of a blade from the straight line between the ends of hub and shroud in the meridian plane, mm: the
/// lathe makes such an edge.
const MAX_BOW_MM: f64 = 0.02;

/// Points of a side of a face.
const SIDE_STEPS: usize = 512;

/// Hub and shroud of a wheel.
#[derive(Clone, Debug)]
pub(super) struct WheelEnds {
    /// Meridians from inlet to outlet.
    lines: [StepMeridian; 2],
    /// Lengths on both between which the main blade lies, with its edges.
    ranges: [[f64; 2]; 2],
    /// Largest distance of the faces from hub and shroud, mm.
    pub(super) extend: f64,
    /// Which ends of the main blade the lathe makes.
    turned: [bool; 2],
}

impl WheelEnds {
    /// Hub and shroud of these blades, of which the first is the main blade. Without faces the shroud goes through its tips.
    pub(super) fn new(
        hub: StepMeridian,
        blades: &[StepBlade],
        shroud_faces: &[StepFace],
        found: &mut Found,
    ) -> Result<Self, Diag> {
        let (main, place) = main(blades)?;
        let shroud = shroud(main, shroud_faces, place, found)?;
        let lines = [hub, shroud];
        let mut gaps = [0.0_f64; 2];
        let mut ranges = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for (k, line) in lines.iter().enumerate() {
            for blade in blades {
                let far = border(blade, k).iter().map(|p| line.nearest(p)[1]).fold(0.0, f64::max);
                gaps[k] = gaps[k].max(far);
            }
            for at in border(main, k).iter().map(|p| line.nearest(p)[0]) {
                ranges[k] = [ranges[k][0].min(at), ranges[k][1].max(at)];
            }
        }
        let [root, tip] = gaps.map(|gap| trim(1e3 * gap, 2));
        if shroud_faces.is_empty() {
            found.moved(gaps[1]);
        }
        found.note(place, format!("the faces end within {root} um of the hub and within {tip} um of the shroud"));
        let mut ends = Self { lines, ranges, extend: gaps[0].max(gaps[1]), turned: [false; 2] };
        ends.turned = ends.turned_of(main);
        for (k, blade) in blades.iter().enumerate() {
            ends.tell(k, blade, found)?;
        }
        Ok(ends)
    }

    /// Largest distance of an end of a blade from the line on which that of the main blade lies if the lathe makes it, mm.
    fn off_line(&self, blade: &StepBlade, end: usize) -> f64 {
        let line = [0, 1].map(|k| self.lines[k].at(self.ranges[k][end]));
        blade.edges[end].off_line(&blade.sheets, end, line)
    }

    /// Whether the lathe makes an end of a blade. No lathe makes a nose.
    fn is_turned(&self, blade: &StepBlade, end: usize) -> bool {
        !blade.edges[end].is_nose() && self.off_line(blade, end) <= MAX_BOW_MM
    }

    /// Says what the ends of a blade are. Refuses an end that is not turned and has no faces.
    fn tell(&self, k: usize, blade: &StepBlade, found: &mut Found) -> Result<(), Diag> {
        let of = if k == 0 { String::new() } else { format!(" of splitter {k}") };
        let role = if k == 0 { String::new() } else { format!("splitter{k}-") };
        let place = blade.faces[0].span;
        for (end, name) in ENDS.into_iter().enumerate() {
            let (off, edge) = (self.off_line(blade, end), &blade.edges[end]);
            let count = edge.sheets.len();
            let note = match edge.form {
                None => format!(
                    "both faces meet at the {name}{of} without a face between them: the curvature of closed sections tells the edge"
                ),
                _ if off <= MAX_BOW_MM => {
                    // The lathe makes this straight line.
                    found.moved(off);
                    format!(
                        "the {name} edge{of} is turned: it keeps to a straight line in the meridian plane within {} um",
                        trim(1e3 * off, 2)
                    )
                }
                _ if count == 0 => {
                    return Err(Diag::error(
                        codes::NOT_STATED,
                        format!("nothing tells which faces are the {name} edge{of}"),
                    )
                    .label(
                        place,
                        format!("this blade ends {} mm beside the straight line between hub and shroud", trim(off, 3)),
                    )
                    .note("no faces that share their edges lead from the pressure to the suction face at this end")
                    .help(format!(
                        "state `--face {role}{name}=#NUMBER` for each face of the edge; or export sections of the blade as points"
                    )));
                }
                Some(EdgeForm::Round) => format!("the {name} edge{of} is round: {count} faces lead round it"),
                _ => format!("the {name} edge{of} is cut off inside of the wheel, between two corners"),
            };
            found.note(place, note);
        }
        Ok(())
    }

    /// Which ends of a blade the lathe makes.
    pub(super) fn turned_of(&self, blade: &StepBlade) -> [bool; 2] {
        [0, 1].map(|end| self.is_turned(blade, end))
    }

    /// Whether the lathe makes all ends of all blades.
    pub(super) fn all_turned(&self, blades: &[StepBlade]) -> bool {
        blades.iter().all(|blade| self.turned_of(blade) == [true; 2])
    }

    /// Points (r, z) of hub and shroud from inlet to outlet, mm. They end with turned ends of the main blade. At another end the hub
    /// goes on as far as its faces do, and so does a shroud through the tips: straight, by the same length.
    pub(super) fn points(&self, shroud_is_picked: bool, found: &mut Found) -> Option<[Vec<[f64; 2]>; 2]> {
        let [hub, shroud] = &self.lines;
        let beyond = |k: usize| {
            let [first, last] = self.ranges[k];
            [first, self.lines[k].length() - last]
        };
        let missing = [0, 1].map(|end| match self.turned[end] || shroud_is_picked {
            true => 0.0,
            false => (beyond(0)[end] - beyond(1)[end]).max(0.0),
        });
        let shroud = shroud.lengthened(missing)?;
        for (name, by) in ENDS.iter().zip(missing).filter(|(_, by)| *by > 0.0) {
            found.note(
                None,
                format!(
                    "the shroud goes on straight by {} mm beyond the tips at the {name}, as far as the hub",
                    trim(by, 3)
                ),
            );
        }
        let of = |line: &StepMeridian, [first, last]: [f64; 2], before: f64| {
            let from = if self.turned[0] { first + before } else { 0.0 };
            let to = if self.turned[1] { last + before } else { line.length() };
            Some(spline_points(&line.part([from, to])?))
        };
        let [(hub, root), (shroud, tip)] = [of(hub, self.ranges[0], 0.0)?, of(&shroud, self.ranges[1], missing[0])?];
        found.moved(root.max(tip));
        Some([hub, shroud])
    }
}

/// Points of the root (0) or tip (1) of a blade with its edges.
fn border(blade: &StepBlade, end: usize) -> Vec<Vector2<f64>> {
    let edges = blade.edges.iter().flat_map(|edge| edge.across(end as f64));
    let faces = blade.sheets.iter().flat_map(|sheet| sheet.row(end as f64, SIDE_STEPS));
    faces.chain(edges).map(|p| flat(&p)).collect()
}

fn main(blades: &[StepBlade]) -> Result<(&StepBlade, Span), Diag> {
    let main = blades.first().ok_or_else(|| Diag::error(codes::NOT_READ, "the wheel has no blade"))?;
    Ok((main, main.faces[0].span))
}

/// The meridian of the shroud from inlet to outlet.
fn shroud(main: &StepBlade, faces: &[StepFace], place: Span, found: &mut Found) -> Result<StepMeridian, Diag> {
    if faces.is_empty() {
        found.note(place, "the shroud goes through the tips of the main blade: no face is picked as shroud");
        return main.tip(SIDE_STEPS).ok_or_else(|| {
            Diag::error(codes::NOT_READ, "the tip of the pressure face has no length")
                .label(place, "this face")
                .help("pick another face")
        });
    }
    let TurnedMeridian { line: shroud, spread } = turned_faces::meridian(faces)?;
    revolved::check(faces, spread, "shroud", place, found)?;
    found.moved(turned_faces::distance(&shroud, faces));
    let [first, last] = [0.0, 1.0].map(|s| shroud.nearest(&flat(&main.sheets[0].jet(s, 1.0).point))[0]);
    Ok(if first < last { shroud } else { shroud.reversed() })
}

/// Points of a meridian, as many as its spline needs, and the largest distance of this spline from it, mm.
fn spline_points(line: &StepMeridian) -> (Vec<[f64; 2]>, f64) {
    /// Distance of the spline from the meridian that is good enough, mm.
    const GOOD_FIT_MM: f64 = 1e-5;
    const FIT_STEPS: [usize; 5] = [12, 24, 48, 96, 192];
    let (mut points, mut off) = (Vec::new(), f64::INFINITY);
    for steps in FIT_STEPS {
        points = line.between([0.0, line.length()], steps);
        let space: Vec<Point3<f64>> = points.iter().map(|[r, z]| Point3::new(*r, 0.0, *z)).collect();
        let Ok(curve) = interpolate(&space, 3) else { continue };
        let places = (0..4 * steps).map(|k| curve.point((k as f64 + 0.5) / (4 * steps) as f64));
        off = places.map(|p| line.nearest(&Vector2::new(p.x, p.z))[1]).fold(0.0, f64::max);
        if off < GOOD_FIT_MM {
            break;
        }
    }
    (points, off)
}
