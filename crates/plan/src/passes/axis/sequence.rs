//! Sequences of clear tool axes along a pass of the floor: `method corridor` by the shortest path in the axes of the
//! machine, `method xu` by the greedy choice of Xu 2013.

use super::clear_axes::{ClearAxes, StandingBall, is_steep};
use super::run::{interval_at, lengths, rotary};
use axes::orient::inscribe::Proof;
use axes::orient::{AxisCandidate, Costs, Energy, greedy};
use base::progress::Work;
use five_axis::{Angles, Chain, Machine, between};
use ir::{CcPass, ClPass, ClPoint};
use nalgebra::{Point3, Vector3};
use nurbs::Triangulation;
use nurbs::angle::nearest_turn;
use nurbs::moving_least_squares::{Patch, curvature};
use rayon::prelude::*;

/// Distance at which two places of the chart count as one, mm.
const SAME_PLACE_MM: f64 = 1e-6;

/// Distance of the stations of the shortest path, mm, for usual tools.
pub(super) const STATION_SPACING_MM: f64 = 4.0;

/// Most candidates of a station, the nearest to the direction of the channel first. The search compares pairs of pairs.
const MAX_CANDIDATES: usize = 40;

/// Distance that candidates add to the required distance, mm: free space for the corridor about them.
pub(super) const CANDIDATE_MARGIN_MM: f64 = 0.1;

/// Weight of second differences in formula (4), 1/s.
const SMOOTHNESS: f64 = 40.0;

/// Largest turn between stations, radians.
pub(super) const MAX_STATION_TURN: f64 = 0.6;

/// Cost of a radian away from the direction of the channel, s: of equal sequences the one in the middle wins.
const AWAY_COST: f64 = 0.02;

/// Cost of the square of the angle, in radians, to the axis at the nearest place of earlier lines, s. It is far above
/// the gain of one line from a jump, and small for a drift from line to line.
const NEIGHBOUR_COST: f64 = 2.0;

/// Stations on both sides of a gap between the axes of two stations which get axes that lead over it.
const BRIDGE: usize = 12;

/// Times that a pass is bridged.
const BRIDGES: usize = 8;

/// Rings about the axes of the station before, for the axes that lead over a gap: 20 deg.
const BRIDGE_RINGS: usize = 6;

/// Most axes that lead over a gap at a station, and number of them about which axes of the next station are tried.
const LEADING: [usize; 2] = [10, 2];

/// Distance of the contacts of the greedy choice, mm.
const CONTACTS: f64 = 2.0;

/// Weights of membrane and thin plate (22) of the greedy choice.
const ENERGY: Energy = Energy { membrane: 0.5, thin_plate: 0.5 };

/// A place at which a sequence of clear axes ends.
pub(crate) struct Blocked {
    pub(crate) at: Point3<f64>,
    /// The direction about which axes were tried.
    pub(crate) about: Vector3<f64>,
    pub(crate) why: Gap,
}

/// Why a sequence of clear axes ends.
pub(crate) enum Gap {
    /// No axis is clear.
    NoAxis,
    /// The clear axes are so near to the pole that rotary axis 2 would turn through.
    NearPole,
    /// The clear axes are too far from those of the station before.
    TooFar,
}

/// The ball at the stations of a pass, the length of its path to each, and the lengths at which axes are chosen.
struct PassPath {
    balls: Vec<StandingBall>,
    table: Vec<f64>,
    stops: Vec<f64>,
}

impl PassPath {
    fn new(pass: &ClPass, radius: f64, step: f64) -> Self {
        let balls: Vec<StandingBall> = pass.points.iter().map(|p| StandingBall::at(p, radius)).collect();
        let table = lengths(&balls.iter().map(|ball| ball.centre).collect::<Vec<_>>());
        let whole = table.last().copied().unwrap_or(0.0);
        let count = (whole / step).ceil().max(2.0) as usize;
        let stops = (0..=count).map(|k| whole * k as f64 / count as f64).collect();
        Self { balls, table, stops }
    }

    fn centre(&self, length: f64) -> Point3<f64> {
        self.ball(length).centre
    }

    fn ball(&self, length: f64) -> StandingBall {
        let (i, t) = interval_at(&self.table, length);
        self.balls[i].towards(&self.balls[i + 1], t)
    }

    /// True when this pass starts nearer to the end of the other pass than to its start.
    fn starts_at_the_end_of(&self, other: &Self) -> bool {
        let far = |end: Option<&Point3<f64>>| {
            self.balls.first().zip(end).map_or(f64::INFINITY, |(p, q)| (p.centre - q).norm_squared())
        };
        far(other.balls.last().map(|ball| &ball.centre)) < far(other.balls.first().map(|ball| &ball.centre))
    }

    /// All stations of the pass; between two stops the rotary axes are linear.
    fn between(&self, chain: &Chain, pass: &ClPass, angles: &[Angles], radius: f64) -> Vec<ClPoint> {
        let at = |length: f64| {
            let (i, t) = interval_at(&self.stops, length);
            chain.tool_axis(between(angles[i], angles[i + 1], t))
        };
        let stations = pass.points.iter().zip(&self.balls).zip(&self.table);
        stations
            .map(|((point, ball), length)| {
                let axis = at(*length);
                ClPoint { tip: ball.centre - axis * radius, axis, contact: point.contact }
            })
            .collect()
    }
}

/// Stations of a pass with their candidates.
struct PathStations {
    path: PassPath,
    /// Clear axes of each station; empty where no axis is clear.
    candidates: Vec<Vec<AxisCandidate>>,
    /// The direction of the channel at each station.
    middles: Vec<Vector3<f64>>,
}

/// The poses of an axis on both branches, with the cost of its angle to the direction of the channel.
fn candidates_of<'a>(
    machine: &'a Machine,
    centre: &'a Point3<f64>,
    middle: &'a Vector3<f64>,
    axis: &'a Vector3<f64>,
    radius: f64,
) -> impl Iterator<Item = AxisCandidate> + 'a {
    let penalty = AWAY_COST * axis.angle(middle);
    machine.chain.nearest(axis, 0.0).into_iter().map(move |rotary| {
        let joints = machine.joints(&(centre - axis * radius), rotary).all();
        AxisCandidate { joints, penalty }
    })
}

/// The tool axis of a pose.
fn axis_of(chain: &Chain, candidate: &AxisCandidate) -> Vector3<f64> {
    chain.tool_axis([candidate.joints[3], candidate.joints[4]])
}

impl PathStations {
    /// Finds clear axes about the axes of a pass, which give the direction of the channel.
    fn new(clear: &ClearAxes<'_>, machine: &Machine, pass: &ClPass) -> Self {
        let radius = clear.radius();
        let path = PassPath::new(pass, radius, clear.scaled(STATION_SPACING_MM));
        let middles: Vec<Vector3<f64>> =
            path.stops.iter().map(|length| pass.points[interval_at(&path.table, *length).0].axis).collect();
        let stops = path.stops.iter().zip(&middles);
        let candidates = stops
            .map(|(length, middle)| {
                let ball = path.ball(*length);
                let mut axes = clear.candidates(&ball, middle, clear.scaled(CANDIDATE_MARGIN_MM));
                if axes.is_empty() {
                    axes = clear.candidates(&ball, middle, 0.0);
                }
                axes.iter()
                    .filter(|axis| is_steep(axis))
                    .take(MAX_CANDIDATES)
                    .flat_map(|axis| candidates_of(machine, &ball.centre, middle, axis, radius))
                    .collect()
            })
            .collect();
        Self { path, candidates, middles }
    }

    /// Adds to all candidates the cost of the angle to the axis chosen at the nearest place of earlier lines. Lines of
    /// the floor may take the clear axes about that axis as well.
    fn tilt_towards(
        &mut self,
        clear: &ClearAxes<'_>,
        machine: &Machine,
        chosen: &[(Point3<f64>, Vector3<f64>)],
        on_floor: bool,
    ) {
        let chain = &machine.chain;
        for ((length, candidates), middle) in self.path.stops.iter().zip(&mut self.candidates).zip(&self.middles) {
            let ball = self.path.ball(*length);
            let here = ball.centre;
            let far = |x: &(Point3<f64>, Vector3<f64>)| (x.0 - here).norm_squared();
            let Some((_, neighbour)) = chosen.iter().min_by(|p, q| far(p).total_cmp(&far(q))) else { continue };
            if on_floor {
                let axes = clear.near(&ball, neighbour, 1, clear.scaled(CANDIDATE_MARGIN_MM));
                candidates.truncate(2 * (MAX_CANDIDATES - axes.len()));
                let poses = |axis| candidates_of(machine, &here, middle, axis, clear.radius());
                candidates.extend(axes.iter().filter(|axis| is_steep(axis)).flat_map(poses));
            }
            for candidate in candidates {
                let axis = axis_of(chain, candidate);
                candidate.penalty += NEIGHBOUR_COST * axis.angle(neighbour).powi(2);
            }
        }
    }

    /// Adds axes that lead from those of station `k` to those before it, and from those before it on: where one wall turns away and
    /// the other comes near, neighbouring stations have their axes on different sides. False where no axis was added.
    fn bridge(&mut self, clear: &ClearAxes<'_>, machine: &Machine, k: usize) -> bool {
        let last = self.candidates.len();
        let back: Vec<usize> = (k.saturating_sub(BRIDGE)..k).rev().collect();
        let on: Vec<usize> = (k..last.min(k + BRIDGE)).collect();
        let mut added = false;
        for (from, stations) in [(k, back), (k - 1, on)] {
            let nearest = self.candidates[from].iter().take(LEADING[1]);
            let mut axes: Vec<Vector3<f64>> = nearest.map(|c| axis_of(&machine.chain, c)).collect();
            for j in stations {
                let (ball, middle) = (self.path.ball(self.path.stops[j]), self.middles[j]);
                let about = axes.iter().flat_map(|to| clear.near(&ball, to, BRIDGE_RINGS, 0.0));
                let mut leading: Vec<Vector3<f64>> = about.filter(is_steep).collect();
                leading.sort_by(|a, b| a.angle(&middle).total_cmp(&b.angle(&middle)));
                leading.truncate(LEADING[0]);
                if leading.is_empty() {
                    break;
                }
                added = true;
                let poses = |axis| candidates_of(machine, &ball.centre, &middle, axis, clear.radius());
                self.candidates[j].extend(leading.iter().flat_map(poses));
                axes = leading.into_iter().take(LEADING[1]).collect();
            }
        }
        added
    }

    /// The cheapest sequence, with axes that lead over gaps where it needs them.
    ///
    /// # Errors
    /// The first station without a clear axis, or out of reach from the one before.
    fn cheapest(&mut self, clear: &ClearAxes<'_>, machine: &Machine, costs: &Costs) -> Result<Vec<usize>, usize> {
        let mut choice = costs.shortest(&self.candidates);
        for _ in 0..BRIDGES {
            match choice {
                Err(k) if k > 0 && !self.candidates[k].is_empty() && self.bridge(clear, machine, k) => {
                    choice = costs.shortest(&self.candidates);
                }
                _ => break,
            }
        }
        choice
    }

    /// The axes of the cheapest sequence at the stops of the pass.
    ///
    /// # Errors
    /// The place at which all sequences end.
    fn axes(
        mut self,
        clear: &ClearAxes<'_>,
        machine: &Machine,
        costs: &Costs,
    ) -> Result<(PassPath, Vec<Vector3<f64>>), Blocked> {
        match self.cheapest(clear, machine, costs) {
            // The other branch gives the same motion of the tool: `link-moves` chooses the branch.
            Ok(choice) => {
                let picked = choice.iter().zip(&self.candidates).map(|(k, station)| &station[*k]);
                let axes = picked.map(|c| axis_of(&machine.chain, c)).collect();
                Ok((self.path, axes))
            }
            Err(k) => {
                let (about, length) = (self.middles[k], self.path.stops[k]);
                let why = if !self.candidates[k].is_empty() {
                    Gap::TooFar
                } else if clear.candidates(&self.path.ball(length), &about, 0.0).is_empty() {
                    Gap::NoAxis
                } else {
                    Gap::NearPole
                };
                Err(Blocked { at: self.path.centre(length), about, why })
            }
        }
    }
}

/// True where there is a clear axis at each station of the shortest path along a pass, without which there is no path.
pub(super) fn has_candidates(clear: &ClearAxes<'_>, pass: &ClPass) -> bool {
    if pass.points.len() < 2 {
        return true;
    }
    let path = PassPath::new(pass, clear.radius(), clear.scaled(STATION_SPACING_MM));
    path.stops.iter().all(|length| {
        let about = pass.points[interval_at(&path.table, *length).0].axis;
        clear.has_candidates(&path.ball(*length), &about)
    })
}

/// The cheapest sequences of clear axes; the axes of the passes give the direction of the channel. Each line stays
/// close to earlier lines, so that the tool hardly turns between neighbours, on the part and in links.
///
/// # Errors
/// For each pass without a sequence: its number and the first place without a clear axis far from the pole, or with axes
/// too far from those before.
pub(crate) fn shortest(
    clear: &ClearAxes<'_>,
    machine: &Machine,
    passes: &[ClPass],
    on_floor: bool,
    work: &Work,
) -> Result<Vec<Vec<ClPoint>>, Vec<(usize, Blocked)>> {
    let stations_of_passes: Vec<Option<PathStations>> = passes
        .par_iter()
        .map(|pass| work.do_step(|| (pass.points.len() > 1).then(|| PathStations::new(clear, machine, pass))).flatten())
        .collect();
    let costs = Costs {
        speed: machine.speeds(),
        acceleration: machine.accelerations(),
        smoothness: SMOOTHNESS,
        most_turn: MAX_STATION_TURN,
    };
    let (mut found, mut faults) = (Vec::with_capacity(passes.len()), Vec::new());
    let mut chosen: Vec<(Point3<f64>, Vector3<f64>)> = Vec::new();
    for (i, (pass, stations)) in passes.iter().zip(stations_of_passes).enumerate() {
        if work.is_cancelled() {
            return Err(Vec::new());
        }
        let Some(stations) = stations else {
            found.push(pass.points.clone());
            continue;
        };
        let along = |clear: &ClearAxes<'_>, mut stations: PathStations| {
            stations.tilt_towards(clear, machine, &chosen, on_floor);
            stations.axes(clear, machine, &costs)
        };
        let with_less_distance = || {
            let tried = clear.with_less_side_distance();
            tried.iter().find_map(|clear| along(clear, PathStations::new(clear, machine, pass)).ok())
        };
        match along(clear, stations).or_else(|blocked| with_less_distance().ok_or(blocked)) {
            Ok((path, axes)) => {
                chosen.extend(path.stops.iter().map(|s| path.centre(*s)).zip(axes.iter().copied()));
                let angles = rotary(&machine.chain, axes.into_iter());
                found.push(path.between(&machine.chain, pass, &angles, clear.radius()));
            }
            Err(blocked) => faults.push((i, blocked)),
        }
    }
    if faults.is_empty() { Ok(found) } else { Err(faults) }
}

/// The greedy choice of Xu 2013 over the passes of a sector, line by line. Normals and curvatures at the contacts come
/// from their triangulation. Each contact gets a cone of clear axes, and the axis in it that adds least energy.
///
/// # Errors
/// Places without a clear axis, with the pass.
pub(crate) fn greedy_axes(
    clear: &ClearAxes<'_>,
    chain: &Chain,
    planned: &[CcPass],
    passes: &[ClPass],
) -> Result<Vec<Vec<ClPoint>>, Vec<(usize, Blocked)>> {
    let radius = clear.radius();
    let paths: Vec<PassPath> = passes.iter().map(|pass| PassPath::new(pass, radius, CONTACTS)).collect();
    let (curvatures_of_stops, mean) = curvatures(planned, &paths);
    let contacts: Vec<Result<Vec<greedy::Contact>, Blocked>> = paths
        .par_iter()
        .zip(passes.par_iter().zip(planned))
        .zip(&curvatures_of_stops)
        .map(|((path, (pass, cc)), curvatures_of_stops)| {
            let stops = path.stops.iter().zip(curvatures_of_stops);
            stops
                .map(|(length, curvature)| {
                    let ball = path.ball(*length);
                    let station = interval_at(&path.table, *length).0;
                    let normal = cc.points.get(station).map_or_else(Vector3::z, |p| p.normal);
                    let about = pass.points[station].axis;
                    // About the clear axis nearest to the normal. In a deep channel there is none near the normal, or
                    // only axes near the pole: then about the direction of the channel.
                    let cone_about = |to: &Vector3<f64>, proof: Proof| clear.cone(&ball, to, proof, 0.0);
                    let cone = cone_about(&normal, Proof::Covered)
                        .filter(|cone| is_steep(&cone.axis()))
                        .or_else(|| cone_about(&about, Proof::Covered))
                        .or_else(|| cone_about(&about, Proof::Rays));
                    let weight = curvature.map_or(0.0, |k| greedy::weight(k, mean));
                    cone.map(|cone| greedy::Contact { normal, cone, weight }).ok_or(Blocked {
                        at: ball.centre,
                        about,
                        why: Gap::NoAxis,
                    })
                })
                .collect()
        })
        .collect();
    let mut rows: Vec<Vec<Vector3<f64>>> = Vec::new();
    let mut faults = Vec::new();
    for (i, row) in contacts.into_iter().enumerate() {
        match row {
            Ok(row) => {
                let mut before = rows.last().cloned().filter(|b: &Vec<Vector3<f64>>| b.len() == row.len());
                if let Some(before) = before.as_mut().filter(|_| i > 0 && paths[i].starts_at_the_end_of(&paths[i - 1]))
                {
                    before.reverse();
                }
                let chosen = greedy::choose(&row, before.as_deref(), &ENERGY, CONTACTS);
                rows.push(chosen);
            }
            Err(blocked) => {
                faults.push((i, blocked));
                rows.push(Vec::new());
            }
        }
    }
    if !faults.is_empty() {
        return Err(faults);
    }
    let points = |((path, pass), row): ((&PassPath, &ClPass), &Vec<Vector3<f64>>)| {
        path.between(chain, pass, &rotary(chain, row.iter().copied()), radius)
    };
    Ok(paths.iter().zip(passes).zip(&rows).map(points).collect())
}

/// Mean curvature at every stop of every pass, and the mean of the absolute values.
fn curvatures(planned: &[CcPass], paths: &[PassPath]) -> (Vec<Vec<Option<f64>>>, f64) {
    let (mut points, mut chart, mut owner) = (Vec::new(), Vec::new(), Vec::new());
    // Azimuths count from the first contact: a channel spans less than half a turn.
    let first = planned.first().and_then(|p| p.points.first()).map_or(0.0, |p| libm::atan2(p.position.y, p.position.x));
    for (i, (cc, path)) in planned.iter().zip(paths).enumerate() {
        for (k, length) in path.stops.iter().enumerate() {
            let Some(p) = cc.points.get(interval_at(&path.table, *length).0) else { continue };
            let (r, azimuth) = (libm::hypot(p.position.x, p.position.y), libm::atan2(p.position.y, p.position.x));
            let place = [*length, r * nearest_turn(azimuth - first, 0.0)];
            if chart.iter().all(|c: &[f64; 2]| libm::hypot(c[0] - place[0], c[1] - place[1]) > SAME_PLACE_MM) {
                points.push(p.position);
                chart.push(place);
                owner.push((i, k));
            }
        }
    }
    let mut curvatures_of_stops: Vec<Vec<Option<f64>>> = paths.iter().map(|w| vec![None; w.stops.len()]).collect();
    let Ok(mesh) = Triangulation::delaunay(points, &chart, 4.0 * CONTACTS) else { return (curvatures_of_stops, 0.0) };
    let normals = mesh.normals();
    let (mut sum, mut count) = (0.0, 0.0_f64);
    for (index, (i, k)) in owner.into_iter().enumerate() {
        if let Some(found) = curvature(&mesh, &normals, index, Patch::Cubic) {
            curvatures_of_stops[i][k] = Some(found.mean);
            sum += found.mean.abs();
            count += 1.0;
        }
    }
    (curvatures_of_stops, sum / count.max(1.0))
}
