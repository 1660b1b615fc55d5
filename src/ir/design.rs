//! Samples of everything that the finished part is bounded by, with what each surface asks of the tool.
//!
//! | surface | extent |
//! |---|---|
//! | face | from the fillet (or the hub) to the shroud, along the ruling |
//! | hub | between the fillets (or the vanes) of neighbouring vanes |
//! | fillet | envelope of the rolling ball between its contacts with face and hub |
//! | tip, edge | turned surfaces of the vanes: obstacles, not milled |

use crate::collide::CloudPoint;
use crate::geom::Revolution;
use crate::geom::proximity::Patch;
use crate::ir::part::{Part, Side};
use nalgebra::{Point3, Vector2, Vector3};

/// What a design surface is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SurfaceKind {
    /// A vane face.
    Face(Side),
    /// The fillet between a face and the hub.
    Fillet(Side),
    /// The hub in a channel.
    Hub,
    /// The turned tip of a vane.
    Tip,
    /// The turned inlet edge of a vane.
    InletEdge,
    /// The turned outlet edge of a vane.
    OutletEdge,
    /// Between the fillets of a vane below its inlet edge, down to the hub.
    InletRoot,
    /// The same at the outlet.
    OutletRoot,
    /// Outside of the hub disc below the outlet.
    Rim,
    /// Back face of the hub disc.
    Back,
    /// Bore.
    Bore,
    /// Front face between the bore and the inlet of the hub.
    Nose,
}

/// A surface of the part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct SurfaceId {
    /// What it is.
    pub kind: SurfaceKind,
    /// Sector, from 0.
    pub sector: u32,
}

impl SurfaceId {
    /// True for the surfaces that milling makes.
    pub fn milled(self) -> bool {
        matches!(self.kind, SurfaceKind::Face(_) | SurfaceKind::Fillet(_) | SurfaceKind::Hub)
    }

    /// A number for [`CloudPoint::tag`].
    pub fn tag(self) -> u32 {
        let kind = match self.kind {
            SurfaceKind::Face(Side::Pressure) => 0,
            SurfaceKind::Face(Side::Suction) => 1,
            SurfaceKind::Fillet(Side::Pressure) => 2,
            SurfaceKind::Fillet(Side::Suction) => 3,
            SurfaceKind::Hub => 4,
            SurfaceKind::Tip => 5,
            SurfaceKind::InletEdge => 6,
            SurfaceKind::OutletEdge => 7,
            SurfaceKind::InletRoot => 8,
            SurfaceKind::OutletRoot => 9,
            SurfaceKind::Rim => 10,
            SurfaceKind::Back => 11,
            SurfaceKind::Bore => 12,
            SurfaceKind::Nose => 13,
        };
        self.sector * 16 + kind
    }
}

impl std::fmt::Display for SurfaceId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.kind.in_sectors(&[self.sector]))
    }
}

impl SurfaceKind {
    /// Name of these surfaces in some sectors, from 0 and ascending: `vanes 1-3, 5 pressure face`.
    pub fn in_sectors(self, sectors: &[u32]) -> String {
        let runs: Vec<String> = sectors
            .chunk_by(|a, b| a + 1 == *b)
            .filter_map(|run| Some((run.first()? + 1, run.last()? + 1)))
            .map(|(first, last)| if first == last { first.to_string() } else { format!("{first}-{last}") })
            .collect();
        let (which, many) = (runs.join(", "), if sectors.len() > 1 { "s" } else { "" });
        match self {
            Self::Face(side) => format!("vane{many} {which} {} face", side.name()),
            Self::Fillet(side) => format!("vane{many} {which} {} fillet", side.name()),
            Self::Hub => format!("hub of channel{many} {which}"),
            Self::Tip => format!("vane{many} {which} tip"),
            Self::InletEdge => format!("vane{many} {which} inlet edge"),
            Self::OutletEdge => format!("vane{many} {which} outlet edge"),
            Self::InletRoot => format!("vane{many} {which} root at the inlet"),
            Self::OutletRoot => format!("vane{many} {which} root at the outlet"),
            // Turned all around: no sector has its own.
            Self::Rim => "rim".to_owned(),
            Self::Back => "back face".to_owned(),
            Self::Bore => "bore".to_owned(),
            Self::Nose => "nose".to_owned(),
        }
    }
}

/// A sample of a design surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Surface.
    pub surface: SurfaceId,
    /// Position, part frame.
    pub position: Point3<f64>,
    /// Unit normal out of the material.
    pub normal: Vector3<f64>,
    /// Parameters: (u, v) of a face, (u, share of the arc) of a fillet, (u, share across) of the hub.
    pub parameters: [f64; 2],
    /// Area that it stands for, mm2.
    pub area: f64,
}

impl Sample {
    /// For the distance engine.
    pub fn cloud_point(&self) -> CloudPoint {
        CloudPoint { position: self.position, normal: self.normal, tag: self.surface.tag() }
    }
}

impl Part {
    /// v at which a ball of a radius, touching the face at (u, v) from outside, touches the hub too: the upper edge of
    /// the fillet. `None` when there is no such place on the ruling. Sector 0.
    pub fn fillet_tangent(&self, side: Side, u: f64, radius: f64) -> Option<f64> {
        let face = self.face(side);
        let gap = |v: f64| {
            let centre = face.surface.point(u, v) + face.normal(u, v) * radius;
            self.hub.distance(&centre) - radius
        };
        // The ball sinks into the hub at the root and is clear of it at some height; a face that leans over the hub
        // may need a start below the root.
        let ends = [-0.5, 1.0].map(|v| (v, gap(v)));
        (ends[0].1 <= 0.0 && ends[1].1 >= 0.0).then(|| halved(gap, ends))
    }

    /// v at which the ruling of a face meets a surface of revolution, near `guess`. Sector 0.
    pub fn ruling_meets(&self, side: Side, u: f64, surface: &Revolution, guess: f64) -> f64 {
        let face = self.face(side);
        let gap = |v: f64| surface.distance(&face.surface.point(u, v));
        // Secant steps: the distance along a ruling is nearly linear.
        let (mut a, mut b) = (guess, guess + 1e-3);
        let (mut fa, mut fb) = (gap(a), gap(b));
        for _ in 0..12 {
            if (fb - fa).abs() < 1e-15 || fb.abs() < 1e-12 {
                break;
            }
            // A ruling that never meets the surface must not run away.
            let next = (b - fb * (b - a) / (fb - fa)).clamp(guess - 0.5, guess + 0.5);
            (a, fa) = (b, fb);
            (b, fb) = (next, gap(next));
        }
        b
    }
}

/// Where a function leaves what is below zero, between two places with the values there: by 50 halvings, which end below
/// rounding for a ruling of some 100 mm. Most of them are decided by a bracket.
fn halved(f: impl Fn(f64) -> f64, ends: [(f64, f64); 2]) -> f64 {
    let [(mut low, _), (mut high, _)] = ends;
    let (below, above) = bracket(&f, ends);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if middle <= below || (middle < above && f(middle) < 0.0) { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Two places close to each other between which a function leaves what is below zero, from such a pair with the values
/// there: by secants, of which the weight of an end that stays is halved (Illinois).
fn bracket(f: impl Fn(f64) -> f64, [(mut low, mut f_low), (mut high, mut f_high)]: [(f64, f64); 2]) -> (f64, f64) {
    /// Steps at most: on rulings some six are enough.
    const STEPS: usize = 20;
    /// Width to end with: some steps over rounding.
    const CLOSE: f64 = 2e-14;
    let mut stays = None;
    let mut last = f64::NAN;
    for _ in 0..STEPS {
        let next = high - f_high * (high - low) / (f_high - f_low);
        if !(next > low && next < high) {
            break;
        }
        // The last step was so short that the place lies as near to this one.
        let ends = if (next - last).abs() < CLOSE { [next - CLOSE, next + CLOSE] } else { [next; 2] };
        last = next;
        for v in ends {
            if v <= low || v >= high {
                continue;
            }
            let value = f(v);
            if value < 0.0 {
                (low, f_low) = (v, value);
                f_high *= if stays == Some(true) { 0.5 } else { 1.0 };
                stays = Some(true);
            } else {
                (high, f_high) = (v, value);
                f_low *= if stays == Some(false) { 0.5 } else { 1.0 };
                stays = Some(false);
            }
        }
        if high - low <= 2.0 * CLOSE {
            break;
        }
    }
    (low, high)
}

/// The point of a face or of the hub that is closest to a point near it, with its normal; other surfaces give `None`.
pub fn project(part: &Part, surface: SurfaceId, near: &Point3<f64>) -> Option<(Point3<f64>, Vector3<f64>)> {
    match surface.kind {
        SurfaceKind::Hub => {
            let r = libm::hypot(near.x, near.y);
            let (u, _) = part.hub.closest(Vector2::new(r, near.z));
            let azimuth = libm::atan2(near.y, near.x);
            let u = u.clamp(0.0, 1.0);
            Some((part.hub.point(u, azimuth), part.hub.normal(u, azimuth)))
        }
        SurfaceKind::Face(side) => {
            let turn = part.sector_rotation(surface.sector);
            let face = part.face(side);
            let foot = face.surface.closest(&(turn.inverse() * near), Patch { u: [0.0, 1.0], v: [-0.1, 1.1] });
            Some((turn * face.surface.point(foot.u, foot.v), turn * face.normal(foot.u, foot.v)))
        }
        _ => None,
    }
}

/// Most samples that are made of a part: a few gigabytes with all that is built on them.
pub const MOST_SAMPLES: f64 = 1.5e7;

/// Rough number of samples of a part at a spacing.
pub fn estimate(part: &Part, spacing: f64) -> f64 {
    let outlet = part.hub.meridian(1.0).point.x.max(part.hub.meridian(0.0).point.x);
    let length = guide_length(part, Side::Pressure).max(guide_length(part, Side::Suction));
    let height =
        [0.0, 0.5, 1.0].map(|u| part.vane.pressure.surface.tangents(u, 0.0).2.norm()).into_iter().fold(0.0, f64::max);
    let area = std::f64::consts::TAU * outlet * length + f64::from(part.vane_count) * 2.0 * length * height;
    area * UNEVEN / (spacing * spacing)
}

/// Samples all design surfaces of all sectors so that neighbours lie at most `spacing` apart, in a fixed order.
///
/// What lies outside of the turned blank is not there: fillets end at the inlet cone and the outlet cylinder.
pub fn sample(part: &Part, spacing: f64) -> Vec<Sample> {
    let mut sector0 = Vec::new();
    for side in [Side::Pressure, Side::Suction] {
        sample_face(part, side, spacing, &mut sector0);
        if let Some(radius) = part.fillet {
            sample_fillet(part, side, radius.get(), spacing, &mut sector0);
        }
    }
    sample_hub(part, spacing, &mut sector0);
    sample_turned(part, spacing, &mut sector0);
    let mut all = Vec::with_capacity(sector0.len() * part.vane_count as usize);
    for sector in 0..part.vane_count {
        let turn = part.sector_rotation(sector);
        all.extend(sector0.iter().map(|s| Sample {
            surface: SurfaceId { sector, ..s.surface },
            position: turn * s.position,
            normal: turn * s.normal,
            ..*s
        }));
    }
    all
}

/// Number of steps that keep a length below the spacing.
fn steps(length: f64, spacing: f64) -> usize {
    (length / spacing).ceil().max(1.0) as usize
}

/// Longest of both guides of a face.
fn guide_length(part: &Part, side: Side) -> f64 {
    let surface = &part.face(side).surface;
    [0.0, 1.0]
        .map(|v| {
            (0..200)
                .map(|i| (surface.point(f64::from(i + 1) / 200.0, v) - surface.point(f64::from(i) / 200.0, v)).norm())
                .sum::<f64>()
        })
        .into_iter()
        .fold(0.0, f64::max)
}

/// Longest step of a guide at equal steps of u: parameters by chord length keep it near the mean, but not at it.
const UNEVEN: f64 = 1.25;

fn sample_face(part: &Part, side: Side, spacing: f64, out: &mut Vec<Sample>) {
    let face = part.face(side);
    let nu = steps(guide_length(part, side) * UNEVEN, spacing);
    for i in 0..=nu {
        let u = i as f64 / nu as f64;
        let low = match part.fillet {
            Some(radius) => part.fillet_tangent(side, u, radius.get()),
            None => Some(part.ruling_meets(side, u, &part.hub, 0.0)),
        };
        let Some(low) = low else { continue };
        let high = part.ruling_meets(side, u, &part.shroud, 1.0);
        let (_, _, ruling) = face.surface.tangents(u, 0.0);
        let nv = steps(ruling.norm() * (high - low), spacing);
        for j in 0..=nv {
            let v = low + (high - low) * j as f64 / nv as f64;
            let (position, su, sv) = face.surface.tangents(u, v);
            let weight = end_weight(i, nu) * end_weight(j, nv) / nu as f64 * (high - low) / nv as f64;
            out.push(Sample {
                surface: SurfaceId { kind: SurfaceKind::Face(side), sector: 0 },
                position,
                normal: face.normal(u, v),
                parameters: [u, v],
                area: su.cross(&sv).norm() * weight,
            });
        }
    }
}

/// Trapezoidal weight of the first and last sample of a row.
fn end_weight(i: usize, n: usize) -> f64 {
    if i == 0 || i == n { 0.5 } else { 1.0 }
}

impl Part {
    /// Change of u that moves along the root of a face by a length at u = 0 or u = 1.
    pub fn root_step(&self, side: Side, u: f64, length: f64) -> f64 {
        length / self.face(side).surface.root.derivatives_extended(u).first.norm()
    }

    /// Where the ball of a fillet is on the part: u of its first and of its last place. The ball touches the hub before or
    /// behind the ruling whose face it touches, the farther the more the face leans, so that it runs on beyond both ends of the
    /// face until it touches the hub outside of the part.
    pub fn fillet_ends(&self, side: Side, radius: f64) -> [f64; 2] {
        /// Ball radii beyond an end at most.
        const MOST: u32 = 4;
        let room = self.room();
        let face = self.face(side);
        let on_part = |u: f64| {
            self.fillet_tangent(side, u, radius).is_some_and(|v| {
                let centre = face.surface.point(u, v) + face.normal(u, v) * radius;
                room.holds(&(centre - hub_normal(self, &centre) * radius))
            })
        };
        [(0.0, -1.0), (1.0, 1.0)].map(|(end, outward)| {
            let step = outward * self.root_step(side, end, radius);
            let beyond = (1..MOST).find(|n| !on_part(end + step * f64::from(*n))).unwrap_or(MOST);
            end + step * f64::from(beyond)
        })
    }

    /// The room between inlet cone and outlet cylinder, where milled surfaces are.
    pub fn room(&self) -> Room {
        let (hub, shroud) = (self.hub.meridian(0.0).point, self.shroud.meridian(0.0).point);
        let outlet = self.hub.meridian(1.0).point;
        let mut room = Room { inlet: hub, across: shroud - hub, outlet: f64::INFINITY };
        // Side of the inlet line on which the channel lies.
        if room.side(outlet.x, outlet.y) < 0.0 {
            room.across = -room.across;
        }
        room.outlet = outlet.x.max(self.shroud.meridian(1.0).point.x);
        room
    }
}

/// The room between inlet cone and outlet cylinder.
#[derive(Clone, Copy, Debug)]
pub struct Room {
    /// Point of the inlet line, (r, z).
    inlet: Vector2<f64>,
    /// Along the inlet line, the room on its left.
    across: Vector2<f64>,
    /// Radius of the outlet.
    outlet: f64,
}

impl Room {
    fn side(&self, r: f64, z: f64) -> f64 {
        self.across.x * (z - self.inlet.y) - self.across.y * (r - self.inlet.x)
    }

    /// How far a point lies beyond the inlet cone (`u` 0) or the outlet cylinder (1), by a measure that is zero on it and
    /// linear in r and z.
    pub fn beyond(&self, u: f64, p: &Point3<f64>) -> f64 {
        let r = libm::hypot(p.x, p.y);
        if u > 0.5 { r - self.outlet } else { -self.side(r, p.z) / self.across.norm() }
    }

    /// True for a point in it.
    pub fn holds(&self, p: &Point3<f64>) -> bool {
        let r = (p.x * p.x + p.y * p.y).sqrt();
        self.side(r, p.z) >= 0.0 && r <= self.outlet
    }
}

fn sample_fillet(part: &Part, side: Side, radius: f64, spacing: f64, out: &mut Vec<Sample>) {
    let face = part.face(side);
    let nu = steps(guide_length(part, side) * UNEVEN, spacing);
    let room = part.room();
    let [first, last] = part.fillet_ends(side, radius).map(|u| u * nu as f64);
    for i in first.floor() as i64..=last.ceil() as i64 {
        let u = i as f64 / nu as f64;
        let Some(v) = part.fillet_tangent(side, u, radius) else { continue };
        let to_face = -face.normal(u, v);
        let centre = face.surface.point(u, v) - to_face * radius;
        let to_hub = -hub_normal(part, &centre);
        let angle = libm::acos(to_face.dot(&to_hub).clamp(-1.0, 1.0));
        let n = steps(angle * radius, spacing);
        let width = guide_length_at(part, side, nu);
        for j in 0..=n {
            let share = j as f64 / n as f64;
            // Great arc from the face contact to the hub contact.
            let direction = if angle > 1e-9 {
                (to_face * libm::sin((1.0 - share) * angle) + to_hub * libm::sin(share * angle)) / libm::sin(angle)
            } else {
                to_face
            };
            let position = centre + direction * radius;
            if room.holds(&position) {
                out.push(Sample {
                    surface: SurfaceId { kind: SurfaceKind::Fillet(side), sector: 0 },
                    position,
                    normal: -direction,
                    parameters: [u, share],
                    area: width * angle * radius / n as f64 * end_weight(j, n),
                });
            }
        }
    }
}

/// Mean distance of fillet rows.
fn guide_length_at(part: &Part, side: Side, nu: usize) -> f64 {
    let surface = &part.face(side).surface;
    let length: f64 = (0..100)
        .map(|i| (surface.point(f64::from(i + 1) / 100.0, 0.0) - surface.point(f64::from(i) / 100.0, 0.0)).norm())
        .sum();
    length / nu as f64
}

/// Normal of the hub at the foot of a point.
pub fn hub_normal(part: &Part, at: &Point3<f64>) -> Vector3<f64> {
    let r = libm::hypot(at.x, at.y);
    let (u, _) = part.hub.closest(Vector2::new(r, at.z));
    let n = part.hub.meridian_normal(u);
    Vector3::new(n.x * at.x / r, n.x * at.y / r, n.y)
}

/// Azimuths of the edge of a fillet (or of the root) along the hub: (u of the hub, azimuth), ascending.
pub(super) fn hub_border(part: &Part, side: Side) -> Vec<[f64; 2]> {
    const ROWS: usize = 400;
    let face = part.face(side);
    let mut border: Vec<[f64; 2]> = Vec::with_capacity(ROWS + 1);
    let [from, to] = part.fillet.map_or([0.0, 1.0], |radius| part.fillet_ends(side, radius.get()));
    for i in 0..=ROWS {
        let u = from + (to - from) * i as f64 / ROWS as f64;
        let at = match part.fillet {
            Some(radius) => match part.fillet_tangent(side, u, radius.get()) {
                Some(v) => face.surface.point(u, v) + face.normal(u, v) * radius.get(),
                None => continue,
            },
            None => face.surface.point(u, part.ruling_meets(side, u, &part.hub, 0.0)),
        };
        let (hub_u, _) = part.hub.closest(Vector2::new(libm::hypot(at.x, at.y), at.z));
        let mut azimuth = libm::atan2(at.y, at.x);
        if let Some(last) = border.last() {
            azimuth -= std::f64::consts::TAU * ((azimuth - last[1]) / std::f64::consts::TAU).round();
        }
        border.push([hub_u, azimuth]);
    }
    border
}

/// Azimuth of a border at a hub parameter, its ends continued level.
pub(super) fn border_azimuth(border: &[[f64; 2]], u: f64) -> Option<f64> {
    let i = border.partition_point(|p| p[0] <= u);
    let (first, last) = (border.first()?, border.last()?);
    if i == 0 {
        return Some(first[1]);
    }
    let Some(q) = border.get(i) else { return Some(last[1]) };
    let p = border[i - 1];
    Some(p[1] + (q[1] - p[1]) * (u - p[0]) / (q[0] - p[0]).max(f64::MIN_POSITIVE))
}

fn sample_hub(part: &Part, spacing: f64, out: &mut Vec<Sample>) {
    let second = if part.first_wall == Side::Pressure { Side::Suction } else { Side::Pressure };
    let (a, b) = (hub_border(part, part.first_wall), hub_border(part, second));
    let length: f64 = (0..200)
        .map(|i| {
            (part.hub.meridian(f64::from(i + 1) / 200.0).point - part.hub.meridian(f64::from(i) / 200.0).point).norm()
        })
        .sum();
    let nu = steps(length * UNEVEN, spacing);
    for i in 0..=nu {
        let u = i as f64 / nu as f64;
        let (Some(from), Some(to)) = (border_azimuth(&a, u), border_azimuth(&b, u)) else { continue };
        let ahead = to - from;
        let angle = ahead - std::f64::consts::TAU * (ahead / std::f64::consts::TAU).round() + part.pitch();
        if angle <= 0.0 {
            continue;
        }
        let m = part.hub.meridian(u);
        let n = steps(angle * m.point.x, spacing);
        for j in 0..=n {
            let share = j as f64 / n as f64;
            let azimuth = from + angle * share;
            let weight = end_weight(i, nu) * end_weight(j, n);
            out.push(Sample {
                surface: SurfaceId { kind: SurfaceKind::Hub, sector: 0 },
                position: part.hub.point(u, azimuth),
                normal: part.hub.normal(u, azimuth),
                parameters: [u, share],
                area: m.first.norm() / nu as f64 * angle * m.point.x / n as f64 * weight,
            });
        }
    }
}

/// The point a share of the way from one point to another about Z, as a lathe leaves them.
pub(super) fn arc_between(from: &Point3<f64>, to: &Point3<f64>, share: f64) -> Point3<f64> {
    let [p, q] = [from, to].map(|p| [libm::hypot(p.x, p.y), p.z, libm::atan2(p.y, p.x)]);
    let ahead = q[2] - p[2];
    let ahead = ahead - std::f64::consts::TAU * (ahead / std::f64::consts::TAU).round();
    let ([r, z], angle) = ([0, 1].map(|k| p[k] + (q[k] - p[k]) * share), p[2] + ahead * share);
    Point3::new(r * libm::cos(angle), r * libm::sin(angle), z)
}

/// Turned surfaces of the vane of sector 0: tip, inlet edge, outlet edge, spanned between its two faces.
fn sample_turned(part: &Part, spacing: f64, out: &mut Vec<Sample>) {
    let (p, s) = (&part.vane.pressure, &part.vane.suction);
    let mut span =
        |kind: SurfaceKind, a: Point3<f64>, b: Point3<f64>, normal: Vector3<f64>, parameter: f64, step: f64| {
            let n = steps((b - a).norm(), spacing);
            for j in 0..=n {
                let share = j as f64 / n as f64;
                out.push(Sample {
                    surface: SurfaceId { kind, sector: 0 },
                    position: arc_between(&a, &b, share),
                    normal,
                    parameters: [parameter, share],
                    area: step * (b - a).norm() / n as f64,
                });
            }
        };
    let length = guide_length(part, Side::Pressure);
    let nu = steps(length * UNEVEN, spacing);
    for i in 0..=nu {
        let u = i as f64 / nu as f64;
        let (a, b) = (p.surface.point(u, 1.0), s.surface.point(u, 1.0));
        span(SurfaceKind::Tip, a, b, p.surface.ruling(u), u, length / nu as f64);
    }
    for (kind, u) in [(SurfaceKind::InletEdge, 0.0), (SurfaceKind::OutletEdge, 1.0)] {
        let (_, su, ruling) = p.surface.tangents(u, 0.5);
        let outward = su.normalize() * if u > 0.5 { 1.0 } else { -1.0 };
        let nv = steps(ruling.norm(), spacing);
        for i in 0..=nv {
            let v = i as f64 / nv as f64;
            span(kind, p.surface.point(u, v), s.surface.point(u, v), outward, v, ruling.norm() / nv as f64);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    /// The same bits as by halvings that all ask the function, with a third of the questions.
    #[test]
    fn halvings_by_a_bracket() {
        let plain = |f: &dyn Fn(f64) -> f64| {
            let (mut low, mut high) = (-0.5, 1.0);
            for _ in 0..50 {
                let middle = 0.5 * (low + high);
                if f(middle) < 0.0 { low = middle } else { high = middle }
            }
            0.5 * (low + high)
        };
        let mut asked = 0;
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
                asked += questions.get();
                count += 1;
            }
        }
        assert!(asked <= 17 * count, "{} questions", f64::from(asked) / f64::from(count));
    }

    /// A zero in the end of the bracket, and a function that jumps.
    #[test]
    fn halvings_at_the_ends() {
        let at = |f: &dyn Fn(f64) -> f64| halved(f, [-0.5, 1.0].map(|v| (v, f(v))));
        assert!((at(&|v| v - 1.0) - 1.0).abs() < 1e-14);
        assert!((at(&|v| v + 0.5) + 0.5).abs() < 1e-14);
        assert!((at(&|v| if v < 0.25 { -1.0 } else { 2.0 }) - 0.25).abs() < 1e-14);
    }
}
