//! Ridges between lines, measured with the cutter itself.

use super::SurfaceLine;
use ir::CcPoint;
use nalgebra::{Point3, Vector3};
use nurbs::bracket::around_minimum;
use rayon::prelude::*;
use tool_stock::collide::Cutter;
use tool_stock::collide::tool::tool_coordinates;

/// Columns over a surface in which ridges are measured.
const COLUMNS: usize = 40;

/// Samples between two lines.
const RIDGES: usize = 8;

/// Range of x about a place that contains the nearest positions of the cutter.
const WINDOW: f64 = 0.06;

/// A contact with its x on the surface, and the tool there.
pub(crate) struct CutterPose {
    x: f64,
    contact: Point3<f64>,
    tip: Point3<f64>,
    axis: Vector3<f64>,
}

impl CutterPose {
    /// The cutter with an axis on a contact at x. `None` for a flat end.
    pub(crate) fn at(cutter: &Cutter, x: f64, p: &CcPoint, axis: Vector3<f64>) -> Option<Self> {
        let tip = cutter.tip_at(&p.position, &p.normal, &axis)?;
        Some(Self { x, contact: p.position, tip, axis })
    }
}

/// The highest ridge that lines leave, mm: in columns of x the greatest height between both walls. `poses` gives the tool
/// along a line, `walls` y of the first wall and the difference to the second one, `place` the point of the surface at (x, y).
pub(crate) fn highest_ridge(
    cutter: &Cutter,
    lines: &[SurfaceLine],
    poses: impl Fn(&SurfaceLine) -> Vec<CutterPose> + Sync,
    walls: impl Fn(f64) -> (f64, f64) + Sync,
    place: impl Fn(f64, f64) -> Point3<f64> + Sync,
) -> Option<f64> {
    let poses: Vec<Vec<CutterPose>> = lines.par_iter().map(&poses).collect();
    let rows = RIDGES * lines.len().max(2);
    let columns: Vec<f64> = (0..=COLUMNS).map(|i| i as f64 / COLUMNS as f64).collect();
    let highest = |x: &f64| {
        let (low, height) = walls(*x);
        // Neighbours of a row: the lines around it, and the next lines where lines begin.
        let near: Vec<NearLine<'_>> = poses.iter().filter_map(|line| around(line, *x)).map(NearLine::new).collect();
        let left = |row: f64| left_at(cutter, &near, &place(*x, low + height * row / rows as f64));
        let values: Vec<f64> = (0..=rows).map(|j| left(j as f64)).collect();
        // A ridge is a local maximum between two rows.
        let tops = values.windows(3).enumerate().filter(|(_, v)| v[1] > v[0] && v[1] >= v[2]);
        tops.map(|(j, _)| top(&left, j as f64, j as f64 + 2.0)).fold(0.0, f64::max)
    };
    columns.par_iter().map(highest).collect::<Vec<f64>>().into_iter().reduce(f64::max)
}

/// Greatest value of a function that has one maximum between two places.
fn top(f: &dyn Fn(f64) -> f64, low: f64, high: f64) -> f64 {
    /// Number of times that a third of the interval is removed: a thousandth remains.
    const THIRDS: usize = 16;
    let mut best = 0.0_f64;
    around_minimum([low, high], THIRDS, |x| {
        let value = f(x);
        best = best.max(value);
        -value
    });
    best
}

/// Poses of a line near a place.
fn around(line: &[CutterPose], x: f64) -> Option<&[CutterPose]> {
    let from = line.partition_point(|p| p.x < x - WINDOW);
    let to = line.partition_point(|p| p.x <= x + WINDOW);
    (from < to).then(|| &line[from..to])
}

/// Contacts that share a box.
const CONTACTS_PER_BOX: usize = 12;

/// Rounding of distances, as a share.
const DISTANCE_ROUNDING: f64 = 1e-12;

/// A box about contacts: its least and its greatest corner.
struct ContactBox([Point3<f64>; 2]);

impl ContactBox {
    fn about(poses: &[CutterPose]) -> Self {
        let [low, high] = [f64::INFINITY, f64::NEG_INFINITY].map(|x| Point3::new(x, x, x));
        Self(poses.iter().fold([low, high], |[low, high], pose| [low.inf(&pose.contact), high.sup(&pose.contact)]))
    }

    /// Square of a distance that is not greater than that from a point to a contact in the box, mm2.
    fn distance(&self, p: &Point3<f64>) -> f64 {
        let [low, high] = &self.0;
        let gap = (low - p).sup(&(p - high)).sup(&Vector3::zeros());
        gap.norm_squared() * (1.0 - DISTANCE_ROUNDING)
    }
}

/// The poses of a line about a place, with boxes about their contacts.
struct NearLine<'a> {
    poses: &'a [CutterPose],
    whole: ContactBox,
    /// One for each [`CONTACTS_PER_BOX`] contacts.
    pieces: Vec<ContactBox>,
}

impl<'a> NearLine<'a> {
    fn new(poses: &'a [CutterPose]) -> Self {
        let pieces = poses.chunks(CONTACTS_PER_BOX).map(ContactBox::about).collect();
        Self { poses, whole: ContactBox::about(poses), pieces }
    }

    /// The contact that is nearest to a point, where its distance is not greater than a limit: square of the distance, and pose.
    fn nearest(&self, p: &Point3<f64>, limit: f64) -> Option<(f64, usize)> {
        let mut best: Option<(f64, usize)> = None;
        for (piece, (around, poses)) in self.pieces.iter().zip(self.poses.chunks(CONTACTS_PER_BOX)).enumerate() {
            if around.distance(p) > best.map_or(limit, |(far, _)| far) {
                continue;
            }
            for (k, pose) in poses.iter().enumerate() {
                let far = (pose.contact - p).norm_squared();
                if far <= limit && best.is_none_or(|(least, _)| far < least) {
                    best = Some((far, piece * CONTACTS_PER_BOX + k));
                }
            }
        }
        best
    }
}

/// The contact of a line that is nearest to a point: its square distance, mm2, and the indices of line and pose.
#[derive(Clone, Copy, Debug, PartialEq)]
struct NearContact {
    square: f64,
    line: usize,
    pose: usize,
}

/// The three nearest contacts to a point, each of another line, the nearest first.
fn nearest_contacts(lines: &[NearLine<'_>], p: &Point3<f64>) -> Vec<NearContact> {
    let boxes: Vec<f64> = lines.iter().map(|line| line.whole.distance(p)).collect();
    let nearest_three = |far: &[f64; 3], new: f64| {
        let mut three = *far;
        if new < three[2] {
            three[2] = new;
            three.sort_by(f64::total_cmp);
        }
        three
    };
    // No line whose box is farther than the third nearest contact of three lines is one of the three.
    let nearest_boxes = boxes.iter().fold([f64::INFINITY; 3], |three, far| nearest_three(&three, *far));
    let mut three = [f64::INFINITY; 3];
    let mut found: Vec<NearContact> = Vec::with_capacity(8);
    let mut add = |line: usize| {
        if let Some((square, pose)) = lines[line].nearest(p, three[2]) {
            three = nearest_three(&three, square);
            found.push(NearContact { square, line, pose });
        }
        three[2]
    };
    let mut limit = f64::INFINITY;
    for (i, _) in boxes.iter().enumerate().filter(|(_, far)| **far <= nearest_boxes[2]) {
        limit = add(i);
    }
    for (i, far) in boxes.iter().enumerate().filter(|(_, far)| **far > nearest_boxes[2]) {
        if *far <= limit {
            limit = add(i);
        }
    }
    found.sort_by(|a, b| a.square.total_cmp(&b.square).then(a.line.cmp(&b.line)));
    found.truncate(3);
    found
}

/// Height that poses leave at a point: the least distance of each line, with a parabola between its poses.
fn left_at(cutter: &Cutter, lines: &[NearLine<'_>], p: &Point3<f64>) -> f64 {
    // For a ball only the sphere: the distance of its side depends on the axis that is chosen later.
    let ball = cutter.ends_in_ball().then(|| cutter.tip_radius());
    let gap = |pose: &CutterPose| match ball {
        Some(radius) => (p - (pose.tip + pose.axis * radius)).norm() - radius,
        None => {
            let (rho, s) = tool_coordinates(p, &pose.tip, &pose.axis);
            cutter.distance(rho, s)
        }
    };
    // The nearest contacts leave least, apart from effects of the cutter's shape: use the three nearest lines.
    let mut least = f64::INFINITY;
    for NearContact { line, pose, .. } in nearest_contacts(lines, p) {
        let line = lines[line].poses;
        // Descend from the nearest contact.
        let (mut k, mut value) = (pose, gap(&line[pose]));
        loop {
            let next = [k.checked_sub(1), Some(k + 1).filter(|n| *n < line.len())]
                .into_iter()
                .flatten()
                .map(|n| (n, gap(&line[n])))
                .min_by(|a, b| a.1.total_cmp(&b.1));
            match next {
                Some((n, g)) if g < value => (k, value) = (n, g),
                _ => break,
            }
        }
        if k > 0 && k + 1 < line.len() {
            let (before, after) = (gap(&line[k - 1]) - value, gap(&line[k + 1]) - value);
            let arc_radius = before + after;
            if arc_radius > 0.0 {
                value -= (after - before).powi(2) / (8.0 * arc_radius);
            }
        }
        least = least.min(value);
    }
    least
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same lines and poses as by a look at every pose.
    #[test]
    fn nearest_contacts_are_those_of_a_full_search() {
        let line = |j: usize| -> Vec<CutterPose> {
            let count = 3 + (j * 7) % 90;
            let at = |k: usize| {
                let x = k as f64 / count as f64;
                let contact =
                    Point3::new(20.0 * x, 0.4 * j as f64 + libm::sin(9.0 * x), libm::cos(3.0 * x + 0.1 * j as f64));
                CutterPose { x, contact, tip: contact, axis: Vector3::z() }
            };
            (0..count).map(at).collect()
        };
        let poses: Vec<Vec<CutterPose>> = (0..60).map(line).collect();
        let lines: Vec<NearLine<'_>> = poses.iter().map(|line| NearLine::new(line)).collect();
        for n in 0..2000 {
            let p = Point3::new((n % 50) as f64 * 0.41, (n / 50) as f64 * 0.61, libm::sin(n as f64));
            let mut all: Vec<NearContact> = poses
                .iter()
                .enumerate()
                .map(|(i, line)| {
                    let far = |k: usize| (line[k].contact - p).norm_squared();
                    let k = (0..line.len()).min_by(|a, b| far(*a).total_cmp(&far(*b))).unwrap();
                    NearContact { square: far(k), line: i, pose: k }
                })
                .collect();
            all.sort_by(|a, b| a.square.total_cmp(&b.square));
            assert_eq!(nearest_contacts(&lines, &p), all[..3]);
        }
    }
}
