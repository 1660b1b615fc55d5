//! The floor of a passage: the hub between the two lines where a ball leaves the walls.

use super::finished::{Finished, edges};
use crate::passes::context::STATIONS;
use crate::passes::lines::{DriveSurface, METRIC_STATIONS, scallop};
use ir::CcPoint;
use nalgebra::Vector2;
use nurbs::BandMetric;
use nurbs::angle::nearest_turn;
use rayon::prelude::*;
use wheel::part::{BladeId, FaceId, FloorBorder, Part, Passage, Rolling, Surface};

/// Contacts with the hub of a ball that rolls along a wall: (u of the hub, azimuth), ascending in u.
pub(super) type Contact = Vec<[f64; 2]>;

/// The machined surface: the hub of a passage of sector 0 between two contact lines.
pub(super) struct ChannelFloor<'a> {
    pub(super) part: &'a Part,
    pub(super) passage: Passage,
    /// Radius of the tool.
    pub(super) radius: f64,
    pub(super) walls: [Contact; 2],
    /// What larger balls have finished.
    pub(super) finished: Vec<Finished>,
}

impl ChannelFloor<'_> {
    /// Azimuth of the first wall, and the angle from it to the second, radians.
    pub(super) fn walls(&self, u: f64) -> (f64, f64) {
        let a = azimuth(&self.walls[0], u);
        let ahead = azimuth(&self.walls[1], u) - a;
        (a, nearest_turn(ahead, 0.0) + self.part.turn(&self.passage))
    }

    pub(super) fn point(&self, u: f64, w: f64, azimuth: f64) -> CcPoint {
        let hub = &self.part.hub;
        CcPoint { u, v: 0.0, w, position: hub.point(u, azimuth), normal: hub.normal(u, azimuth) }
    }

    /// Steps of a ball along and across the meridian that leave ridges of a given height.
    pub(super) fn steps(&self, u: f64, height: f64) -> [f64; 2] {
        let hub = &self.part.hub;
        [hub.meridian_curvature(u), hub.ring_curvature(u)].map(|k| scallop::curved_step(self.radius, height, k))
    }

    /// The larger one of both steps of a ball.
    pub(super) fn largest_step(&self, u: f64, height: f64) -> f64 {
        let [along, across] = self.steps(u, height);
        along.max(across)
    }

    /// Lower bound of the length of lines over an interval of u, beside what is finished, for the largest step at each u.
    pub(super) fn least_length_over(
        &self,
        [from, to]: [f64; 2],
        finished: &[Finished],
        largest_step: impl Fn(f64) -> f64,
    ) -> f64 {
        (0..STATIONS)
            .map(|i| {
                let u = from + (to - from) * (i as f64 + 0.5) / STATIONS as f64;
                let m = self.part.hub.meridian(u);
                let (first, angle) = self.walls(u);
                let done = edges(finished, u, first)
                    .map_or(0.0, |[low, high]| (high.min(first + angle) - low.max(first)).max(0.0));
                m.first.norm() * m.point.x * (angle - done) / largest_step(u) * (to - from) / STATIONS as f64
            })
            .sum()
    }
}

impl DriveSurface for ChannelFloor<'_> {
    fn name(&self) -> String {
        "channel".to_owned()
    }

    fn walls(&self, x: f64) -> (f64, f64) {
        self.walls(x)
    }

    fn contact(&self, x: f64, y: f64, share: f64) -> CcPoint {
        self.point(x, share, y)
    }

    fn finished(&self, x: f64) -> Option<[f64; 2]> {
        edges(&self.finished, x, self.walls(x).0)
    }

    fn speed(&self, x: f64, _y: f64, slope: f64) -> f64 {
        let m = self.part.hub.meridian(x);
        libm::hypot(m.first.norm(), m.point.x * slope)
    }

    /// Along and across the meridian, which are the principal directions, the metric has the exact step.
    fn metric(&self, height: f64) -> BandMetric {
        let hub = &self.part.hub;
        // Until the ball has passed the edges, but well before the axis.
        let beyond = [0.0, 1.0].map(|u| {
            let m = hub.meridian(u);
            self.radius.min(0.5 * m.point.x) / m.first.norm()
        });
        // Lines follow the corners of their walls before an edge.
        let count =
            ((hub_length(self.part) / METRIC_SPACING_MM).ceil() as usize).clamp(METRIC_STATIONS, MAX_METRIC_STATIONS);
        BandMetric::new(-beyond[0], 1.0 + beyond[1], count + 1, |u| {
            let m = hub.meridian(u);
            let [along, across] = self.steps(u, height);
            [m.first.norm() / along, m.point.x / across]
        })
    }

    fn least_length(&self, height: f64) -> f64 {
        self.least_length_over([0.0, 1.0], &self.finished, |u| self.largest_step(u, height))
    }
}

/// Contact lines of both walls of a passage with the hub. Where a blade begins or ends inside of the passage, they run round
/// its edges, and go on before and behind them; there they turn off with a radius of at most `turn_off`, mm.
pub(super) fn contacts(part: &Part, passage: &Passage, along: FloorBorder, turn_off: f64) -> Option<[Contact; 2]> {
    let ends_inside =
        |side: &FaceId| side.blade != BladeId::MAIN || [0, 1].iter().any(|end| part.edge(side.blade, *end).is_some());
    if !passage.walls.iter().any(ends_inside) {
        let [first, second] = passage.walls.map(|side| contact(part, side, along));
        return Some([first?, second?]);
    }
    let count = ((hub_length(part) / BORDER_SPACING_MM).ceil() as usize).clamp(MIN_PLACES, MAX_PLACES);
    let places: Vec<f64> = (0..=count).map(|i| i as f64 / count as f64).collect();
    let borders = part.floor_borders(passage, along, &places)?;
    let lengths = places.iter().scan((0.0, None), |(sum, last), u| {
        let at = part.hub.meridian(*u).point;
        *sum += last.map_or(0.0, |last: Vector2<f64>| (at - last).norm());
        *last = Some(at);
        Some([*sum, at.x])
    });
    let lengths: Vec<[f64; 2]> = lengths.collect();
    let line = |side: usize| -> Contact {
        let outward = if side == 0 { 1.0 } else { -1.0 };
        let border: Vec<f64> = borders[side].iter().map(|azimuth| outward * azimuth).collect();
        let smooth = rounded(
            &lengths,
            &border,
            turn_off.min(CORNER_RADIUS_SHARE * least_wall(part, passage.walls[side], along)),
        );
        places.iter().zip(smooth).map(|(u, azimuth)| [*u, outward * azimuth]).collect()
    };
    Some([line(0), line(1)])
}

/// Length of the meridian of the hub, mm.
fn hub_length(part: &Part) -> f64 {
    (0..STATIONS).map(|i| part.hub.meridian(i as f64 / STATIONS as f64).first.norm()).sum::<f64>() / STATIONS as f64
}

/// Least distance from a wall of the centres of balls beside it, mm.
fn least_wall(part: &Part, wall: FaceId, along: FloorBorder) -> f64 {
    match (along, part.fillet(wall)) {
        (FloorBorder::Fillets(_), Some(fillet)) => fillet.least().get(),
        _ => along.ball(part, wall, 0.0).map_or(0.0, |ball| ball.wall),
    }
}

/// Distance of the places along the hub at which borders round an edge are known, mm. A disc that rolls on them sinks between two by
/// about a tenth of a micrometre.
const BORDER_SPACING_MM: f64 = 0.02;

/// Largest distance of the stations of the metric along the hub, mm, and the most of them.
const METRIC_SPACING_MM: f64 = 0.15;
const MAX_METRIC_STATIONS: usize = 4000;

/// Fewest and most of these places, minus one.
const MIN_PLACES: usize = 4000;
const MAX_PLACES: usize = 40_000;

/// Largest radius with which a line turns off before an edge, as a share of the distance from the wall.
const CORNER_RADIUS_SHARE: f64 = 0.4;

/// The same radius as a share of the step between lines. Before the edge the lines of both passages leave a place between them
/// and the last line of the fillet. A point there is at most a quarter of the radius away from each of the three, which is
/// less than half a step.
pub(super) const TURN_OFF_STEPS: f64 = 1.5;

/// The least line above a border, as azimuths, on which a disc of a radius rolls: without the corners that the disc does not
/// reach from above. `along` has the length of the meridian and the radius about Z at each place, mm.
fn rounded(along: &[[f64; 2]], border: &[f64], radius: f64) -> Vec<f64> {
    // Half of the height of the disc at a distance from its centre, as an angle.
    let over = |i: usize, j: usize| {
        let d = along[j][0] - along[i][0];
        (radius * radius - d * d).max(0.0).sqrt() / along[i][1]
    };
    let near = |i: usize| {
        let from = along.partition_point(|p| p[0] < along[i][0] - radius);
        from..along.partition_point(|p| p[0] <= along[i][0] + radius)
    };
    let centre = |i: usize| near(i).map(|j| border[j] + over(i, j)).fold(f64::NEG_INFINITY, f64::max);
    let centres: Vec<f64> = (0..border.len()).into_par_iter().map(centre).collect();
    let below = |i: usize| near(i).map(|j| centres[j] - over(i, j)).fold(f64::INFINITY, f64::min);
    (0..border.len()).into_par_iter().map(below).collect()
}

/// Contact line with the hub of a ball whose centre keeps distances from a face of sector 0 and from the hub, while its
/// place beside the face is at most `top` high. `None` when a ruling has no such place.
fn contact(part: &Part, side: FaceId, along: FloorBorder) -> Option<Contact> {
    let face = part.face(side);
    let mut line: Contact = Vec::with_capacity(STATIONS + 1);
    // The ball touches the hub before or behind the ruling whose face it touches: run on beyond both ends.
    let beyond = |end: f64| Some(part.root_step(side, end, along.ball(part, side, end)?.wall));
    let (from, to) = (-beyond(0.0)?, 1.0 + beyond(1.0)?);
    for i in 0..=STATIONS {
        let u = from + (to - from) * i as f64 / STATIONS as f64;
        let Rolling { wall, floor, top } = along.ball(part, side, u)?;
        let v = part.v_of_centre(side, u, [wall, floor], top)?;
        let centre = face.surface.point(u, v) + face.normal(u, v) * wall;
        let (hub_u, _) = part.hub.closest(Vector2::new(libm::hypot(centre.x, centre.y), centre.z));
        let mut azimuth = libm::atan2(centre.y, centre.x);
        if let Some(last) = line.last() {
            azimuth = nearest_turn(azimuth, last[1]);
        }
        line.push([hub_u, azimuth]);
    }
    Some(line)
}

/// Azimuth of a contact line at a hub parameter; linear beyond both ends. Four point interpolation: over 0.15 mm its
/// error is far below a nanometre for a smooth line.
pub(super) fn azimuth(line: &Contact, u: f64) -> f64 {
    let n = line.len();
    let i = line.partition_point(|p| p[0] <= u).clamp(2, n - 2);
    let at = &line[i - 2..i + 2];
    if u < line[0][0] {
        return line[0][1] + (line[1][1] - line[0][1]) / (line[1][0] - line[0][0]) * (u - line[0][0]);
    }
    if u > line[n - 1][0] {
        let (p, q) = (line[n - 2], line[n - 1]);
        return q[1] + (q[1] - p[1]) / (q[0] - p[0]) * (u - q[0]);
    }
    (0..4)
        .map(|j| (0..4).filter(|k| *k != j).map(|k| (u - at[k][0]) / (at[j][0] - at[k][0])).product::<f64>() * at[j][1])
        .sum()
}
