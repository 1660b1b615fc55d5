//! The ball that rolls along a face and the hub: it defines the fillet and the lower end of faces.

use super::{FaceId, Part, Surface};
use nalgebra::{Point3, Vector2, Vector3};
use nurbs::Revolution;
use nurbs::angle::great_arc;
use nurbs::bracket::{Bracket, SecantBracket, SecantEnd, secant};

/// Step of differences along u: their directions are exact to 1e-6, also where the curvature jumps.
const DIFFERENCE_STEP: f64 = 1e-6;

/// End of secants along a ruling, mm.
const RULING: SecantEnd = SecantEnd { steps: 12, exact: 1e-12, level: 1e-15 };

/// The arc in which a ball touches the fillet: a circle about the way of its centre. It is a great circle of the ball where the radius
/// does not change; else it is moved along the way, to the side at which the ball is smaller.
#[derive(Clone, Copy)]
pub(super) struct FilletArc {
    /// Centre of the ball.
    pub(super) centre: Point3<f64>,
    /// Radius of the ball, mm.
    pub(super) radius: f64,
    /// From the centre of the ball to that of the circle, in radii of the ball.
    pub(super) tilt: Vector3<f64>,
    /// Radius of the circle, in radii of the ball.
    pub(super) level: f64,
    /// Unit directions from the centre of the circle to the contacts with face and hub.
    pub(super) ends: [Vector3<f64>; 2],
}

impl FilletArc {
    /// Unit direction from the centre of the ball to the place at a share of the arc, from the face to the hub.
    pub(super) fn direction(&self, share: f64) -> Vector3<f64> {
        let [from, to] = &self.ends;
        self.tilt + great_arc(from, to, share) * self.level
    }

    /// Place of the fillet at a share of the arc.
    pub(super) fn point(&self, share: f64) -> Point3<f64> {
        self.centre + self.direction(share) * self.radius
    }

    /// Angle of the arc, rad.
    pub(super) fn angle(&self) -> f64 {
        let [from, to] = &self.ends;
        libm::acos(from.dot(to).clamp(-1.0, 1.0))
    }
}

impl Part {
    /// v at which a ball of a given radius that touches the face at (u, v) from outside also touches the hub: the upper
    /// edge of the fillet. `None` when the ruling has no such place. Sector 0.
    pub fn fillet_tangent(&self, id: FaceId, u: f64, radius: f64) -> Option<f64> {
        self.v_of_centre(id, u, [radius; 2], 1.0)
    }

    /// v at which the fillet of a face begins, on the ruling at u. `None` for a sharp root, and when the ruling has no such place.
    pub fn fillet_top(&self, id: FaceId, u: f64) -> Option<f64> {
        self.fillet_tangent(id, u, self.fillet_radius(id, u)?)
    }

    /// The arc of the fillet of a face at u. `None` where the ball touches no face and hub together. Sector 0.
    pub(super) fn fillet_arc(&self, id: FaceId, u: f64) -> Option<FilletArc> {
        let face = self.face(id);
        let ball = |u: f64| {
            let radius = self.fillet_radius(id, u)?;
            let v = self.fillet_tangent(id, u, radius)?;
            let (point, normal) = face.point_and_normal(u, v);
            let to_face = -normal;
            Some((point - to_face * radius, radius, to_face))
        };
        let (centre, radius, to_face) = ball(u)?;
        let ends = [to_face, -hub_normal(self, &centre)];
        if self.fillet(id)?.constant().is_some() || id.edge_end().is_some() {
            return Some(FilletArc { centre, radius, tilt: Vector3::zeros(), level: 1.0, ends });
        }
        let [(before, less, _), (after, more, _)] = [ball(u - DIFFERENCE_STEP)?, ball(u + DIFFERENCE_STEP)?];
        let way = after - before;
        // On the arc the ball neither sinks into the surface nor leaves it while it moves on and grows.
        let sine = -(more - less) / way.norm();
        let tilt = way.normalize() * sine;
        let ends = ends.map(|to| (to - way * (to.dot(&way) / way.norm_squared())).normalize());
        Some(FilletArc { centre, radius, tilt, level: (1.0 - sine * sine).sqrt(), ends })
    }

    /// True where [`Self::fillet_arc`] finds an arc, in a fraction of its time.
    pub(super) fn has_fillet_arc(&self, id: FaceId, u: f64) -> bool {
        let ball = |u: f64| {
            self.fillet_radius(id, u).is_some_and(|radius| self.ends_about_centre(id, u, [radius; 2], 1.0).is_some())
        };
        let changes = self.fillet(id).is_some_and(|fillet| fillet.constant().is_none()) && id.edge_end().is_none();
        ball(u) && (!changes || (ball(u - DIFFERENCE_STEP) && ball(u + DIFFERENCE_STEP)))
    }

    /// v at which the point that lies `wall` off the face at (u, v) lies `floor` off the hub, the two distances, at most `top`. `None`
    /// when the ruling has no such place. Sector 0.
    pub fn v_of_centre(&self, id: FaceId, u: f64, distances: [f64; 2], top: f64) -> Option<f64> {
        let gap = self.gap_of_centre(id, u, distances);
        self.ends_about_centre(id, u, distances, top).map(|ends| halved(gap, ends))
    }

    /// How far over `floor` the point that lies `wall` off the face at (u, v) is off the hub, by v.
    fn gap_of_centre(&self, id: FaceId, u: f64, [wall, floor]: [f64; 2]) -> impl Fn(f64) -> f64 + '_ {
        let face = self.face(id);
        move |v: f64| {
            let (point, normal) = face.point_and_normal(u, v);
            self.hub.distance(&(point + normal * wall)) - floor
        }
    }

    /// Two places on a ruling with the gaps there, between which the place of [`Self::v_of_centre`] lies.
    fn ends_about_centre(&self, id: FaceId, u: f64, distances: [f64; 2], top: f64) -> Option<[(f64, f64); 2]> {
        let gap = self.gap_of_centre(id, u, distances);
        // The ball sinks into the hub at the root and is clear of the hub at some height. For a face inclined over the
        // hub the start may have to lie below the root.
        let ends = [-0.5, top].map(|v| (v, gap(v)));
        (ends[0].1 <= 0.0 && ends[1].1 >= 0.0).then_some(ends)
    }

    /// v at which the ruling of a face meets a surface of revolution, near `guess`. Sector 0.
    pub fn ruling_meets(&self, id: FaceId, u: f64, surface: &Revolution, guess: f64) -> f64 {
        let face = self.face(id);
        let gap = |v: f64| surface.distance(&face.surface.point(u, v));
        // The distance along a ruling is nearly linear.
        secant([guess, guess + 1e-3], 0.5, RULING, gap)
    }
}

/// The place between two places with known values where a function becomes positive, by 50 bisection steps, which end
/// below rounding for a ruling of some 100 mm. A bracket decides most steps without an evaluation.
fn halved(f: impl Fn(f64) -> f64, ends: [(f64, f64); 2]) -> f64 {
    let [below, above] = bracket(&f, ends);
    let whole = Bracket { holds: ends[0].0, fails: ends[1].0 };
    whole.halved(50, |v| v <= below || (v < above && f(v) < 0.0)).middle()
}

/// A narrow bracket of the place where a function becomes positive, from a wide bracket with known values, by secants.
fn bracket(f: impl Fn(f64) -> f64, ends: [(f64, f64); 2]) -> [f64; 2] {
    /// Largest number of steps: for rulings about six are enough.
    const MAX_STEPS: usize = 20;
    /// Final width: some units of rounding.
    const CLOSE_ON_RULING: f64 = 2e-14;
    let mut found = SecantBracket::new(ends.map(|end| end.0), ends.map(|end| end.1));
    let mut last = f64::NAN;
    let inside = |v: f64, [low, high]: [f64; 2]| v > low && v < high;
    for _ in 0..MAX_STEPS {
        let next = found.next();
        if !inside(next, found.ends) {
            break;
        }
        // After a very short step the root lies close to this place.
        let close = (next - last).abs() < CLOSE_ON_RULING;
        last = next;
        for v in if close { [next - CLOSE_ON_RULING, next + CLOSE_ON_RULING] } else { [next; 2] } {
            if inside(v, found.ends) {
                found.take(v, f(v));
            }
        }
        if found.width() <= 2.0 * CLOSE_ON_RULING {
            break;
        }
    }
    found.ends
}

impl Part {
    /// Change of u that moves along the root of a face by a given length at u = 0 or u = 1.
    pub fn root_step(&self, id: FaceId, u: f64, length: f64) -> f64 {
        length / self.face(id).surface.root().derivatives_extended(u).first.norm()
    }

    /// The u of the first and of the last place where the ball of a fillet is on the part. The ball touches the hub
    /// before or behind the ruling whose face it touches; the offset grows with the inclination of the face. The ball
    /// therefore runs on beyond both ends of the face until it touches the hub outside of the part.
    pub fn fillet_ends(&self, id: FaceId, radius: impl Fn(f64) -> f64) -> [f64; 2] {
        /// Largest extension beyond an end, in ball radii.
        const MAX_EXTENSION: u32 = 4;
        let extent = self.extent(id.blade);
        let face = self.face(id);
        let on_part = |u: f64| {
            let radius = radius(u);
            self.fillet_tangent(id, u, radius).is_some_and(|v| {
                let (point, normal) = face.point_and_normal(u, v);
                let centre = point + normal * radius;
                extent.holds(&(centre - hub_normal(self, &centre) * radius))
            })
        };
        [(0.0, -1.0), (1.0, 1.0)].map(|(end, outward)| {
            // Beside an edge that is a surface of its own the ball rolls on along the edge.
            if id.edge_end().is_some() || self.edge(id.blade, usize::from(end > 0.5)).is_some() {
                return end;
            }
            let step = outward * self.root_step(id, end, radius(end));
            let beyond = (1..MAX_EXTENSION).find(|n| !on_part(end + step * f64::from(*n))).unwrap_or(MAX_EXTENSION);
            end + step * f64::from(beyond)
        })
    }
}

/// Normal of the hub at the foot of a point.
pub fn hub_normal(part: &Part, at: &Point3<f64>) -> Vector3<f64> {
    let r = libm::hypot(at.x, at.y);
    let (u, _) = part.hub.closest(Vector2::new(r, at.z));
    let n = part.hub.meridian_normal(u);
    Vector3::new(n.x * at.x / r, n.x * at.y / r, n.y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    /// The same bits as bisection that always evaluates the function, with a third of the evaluations.
    #[test]
    fn halvings_by_a_bracket() {
        let plain = |f: &dyn Fn(f64) -> f64| Bracket { holds: -0.5, fails: 1.0 }.halved(50, |v| f(v) < 0.0).middle();
        let mut evaluations = 0;
        let mut count = 0;
        for k in 0..200 {
            let root = -0.49 + 1.48 * f64::from(k) / 199.0;
            let functions: [&dyn Fn(f64) -> f64; 5] = [
                &|v| 20.0 * (v - root),
                &|v| (v - root) * (3.0 + v * v),
                &|v| (v.exp() - root.exp()) * 7.0,
                &|v| (4.0 * (v - root)).atan(),
                &|v| (v * v + 40.0 * (v + 1.0)).sqrt() - (root * root + 40.0 * (root + 1.0)).sqrt(),
            ];
            for f in functions {
                let questions = Cell::new(0);
                let g = |v: f64| {
                    questions.set(questions.get() + 1);
                    f(v)
                };
                let found = halved(g, [-0.5, 1.0].map(|v| (v, f(v))));
                assert_eq!(found.to_bits(), plain(f).to_bits(), "root {root}");
                assert!((found - root).abs() < 1e-12);
                evaluations += questions.get();
                count += 1;
            }
        }
        assert!(evaluations <= 17 * count, "{} questions", f64::from(evaluations) / f64::from(count));
    }

    /// A zero at an end of the bracket, and a function with a jump.
    #[test]
    fn halvings_at_the_ends() {
        let at = |f: &dyn Fn(f64) -> f64| halved(f, [-0.5, 1.0].map(|v| (v, f(v))));
        assert!((at(&|v| v - 1.0) - 1.0).abs() < 1e-14);
        assert!((at(&|v| v + 0.5) + 0.5).abs() < 1e-14);
        assert!((at(&|v| if v < 0.25 { -1.0 } else { 2.0 }) - 0.25).abs() < 1e-14);
    }
}
