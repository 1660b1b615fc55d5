//! Pieces of an operation that are the same motion, turned about the axis of the part by whole pitches.
//!
//! They are found from the poses of the tool alone, and so from the joints: no assumption on how the motion was planned. Two
//! pieces are *partners* where the tips at both ends and the axes at every quarter, turned, are the same to a
//! [`PartnerRounding`]. Between the quarters a bound of the fifth derivative of the axis holds them together, so that the distance
//! of partners at any time is known: by how much they really differ, not by how much they may.

use super::piece::Piece;
use ir::MoveKind;
use nalgebra::{Point3, Rotation3, Vector3};
use rayon::prelude::*;
use tool_stock::stock::{Step, StepKind};
use wheel::control::{Control, Orientation};

/// Largest distance between motions that count as the same, turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartnerRounding {
    /// Of the tips, mm.
    tip: f64,
    /// Of the unit axes.
    axis: f64,
}

impl PartnerRounding {
    /// Of a plan, whose sectors are the same up to the arithmetic.
    pub const ARITHMETIC: Self = Self { tip: 1e-7, axis: 1e-9 };

    /// Of a text, which rounds the words of each sector by themselves: three lengths of the tip and two angles or three
    /// components of the axis, each by half a step in both partners. Angles that follow from components, as in rapids, can be
    /// off by more.
    pub fn of_words(control: &Control) -> Self {
        let decimals = &control.decimals;
        let step = |decimals: usize| libm::pow(10.0, -(decimals as f64));
        let angle = std::f64::consts::SQRT_2 * step(decimals.angle).to_radians();
        let component = 3.0_f64.sqrt() * step(decimals.vector);
        let axis = if control.orientation == Orientation::Vectors { angle.max(component) } else { angle };
        Self { tip: 3.0_f64.sqrt() * step(decimals.length), axis: 2.0 * axis }
    }
}

impl Default for PartnerRounding {
    fn default() -> Self {
        Self::ARITHMETIC
    }
}

/// Largest value between five even places of the polynomial of degree four whose values there are at most one: the largest sum of
/// the absolute Lagrange polynomials.
const INTERPOLATED: f64 = 2.21;

/// Number of classes with about the same key that a piece is compared with. A piece of one class more counts as one without
/// partners.
const MAX_COMPARED: usize = 64;

/// A motion of the tool that may be another one, turned.
pub(crate) trait Turnable: Sync {
    /// Kinds of partners are equal.
    type Kind: PartialEq;

    fn kind(&self) -> Self::Kind;

    /// Tip at both ends.
    fn tips(&self) -> &[Point3<f64>; 2];

    /// Axis at a share of the motion.
    fn axis(&self, share: f64) -> Vector3<f64>;

    /// Upper bound of how far the axis leaves, between its quarters, the polynomial of degree four through its axes there.
    fn between_quarters(&self) -> f64;
}

/// The fifth derivative, which is at most the fifth power of both turns together, times the largest |t (t - 1/4) (t - 1/2)
/// (t - 3/4) (t - 1)| / 5!, bounds how far an axis leaves the polynomial.
impl Turnable for Piece<'_> {
    type Kind = MoveKind;

    fn kind(&self) -> MoveKind {
        self.kind
    }

    fn tips(&self) -> &[Point3<f64>; 2] {
        &self.tips
    }

    fn axis(&self, share: f64) -> Vector3<f64> {
        self.pose(share).axis
    }

    fn between_quarters(&self) -> f64 {
        let turn: f64 = self.rotary_turns().iter().sum();
        2.96e-5 * turn * turn * turn * turn * turn
    }
}

/// The axis of a step is a parabola.
impl Turnable for Step {
    type Kind = StepKind;

    fn kind(&self) -> StepKind {
        self.kind
    }

    fn tips(&self) -> &[Point3<f64>; 2] {
        &self.tips
    }

    fn axis(&self, share: f64) -> Vector3<f64> {
        let [a, m, b] = &self.axes;
        a + ((m * 4.0 - a * 3.0 - b) + ((a + b) * 2.0 - m * 4.0) * share) * share
    }

    fn between_quarters(&self) -> f64 {
        0.0
    }
}

/// Class of a piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Member {
    class: u32,
    /// Pitches from the sector of the class to that of the piece.
    pitches: u32,
    /// Index of the piece in the order of time.
    order: u32,
}

/// The pieces of an operation in classes of partners.
#[derive(Clone, Debug, Default)]
pub(crate) struct TurnClasses {
    /// The pieces in the order of time.
    members: Vec<Member>,
    /// The same by class, then by pitches.
    by_class: Vec<Member>,
    /// The first piece of each class in time.
    first_in_time: Vec<u32>,
    /// Pieces, in the order of time, of classes that have not one in every sector.
    partial: Vec<u32>,
    /// Number of sectors.
    vanes: u32,
    /// Largest distances between partners: of the tips, mm, and of the unit axes.
    off: [f64; 2],
    /// How far an axis leaves, between the places where axes are compared, the polynomial through these, at most.
    between: f64,
}

/// Where a piece, turned, is beside another one: both ends of the tip, mm, and the axis at each quarter.
#[derive(Clone, Copy, Debug, Default)]
struct Beside {
    tips: [Vector3<f64>; 2],
    axes: [Vector3<f64>; 5],
}

/// The smallest box about the pieces of a class, in the frame of its first piece: no two of them are farther apart than its
/// diagonals.
#[derive(Clone, Copy, Debug, Default)]
struct Around {
    least: Beside,
    most: Beside,
}

impl Around {
    fn take(&mut self, beside: &Beside) {
        let Self { least, most } = self;
        let tips = least.tips.iter_mut().zip(&mut most.tips).zip(&beside.tips);
        let axes = least.axes.iter_mut().zip(&mut most.axes).zip(&beside.axes);
        for ((least, most), at) in tips.chain(axes) {
            (*least, *most) = (least.inf(at), most.sup(at));
        }
    }

    /// Diagonals for the tips and for the axes.
    fn diagonals(&self) -> [f64; 2] {
        let longest = |least: &[Vector3<f64>], most: &[Vector3<f64>]| {
            least.iter().zip(most).map(|(least, most)| (most - least).norm()).fold(0.0, f64::max)
        };
        [longest(&self.least.tips, &self.most.tips), longest(&self.least.axes, &self.most.axes)]
    }
}

/// The first piece of a class.
struct First {
    key: f64,
    order: usize,
    class: u32,
    around: Around,
}

impl TurnClasses {
    /// The classes of pieces in the order of time, for a part that `turns` turn into itself: by 0, 1, 2 ... pitches.
    pub(crate) fn of(pieces: &[impl Turnable], turns: &[Rotation3<f64>], rounding: PartnerRounding) -> Self {
        let vanes = turns.len();
        let count = u32::try_from(pieces.len()).unwrap_or(u32::MAX);
        let keyed = |order: u32| (key(&pieces[order as usize], vanes), order);
        let mut keys: Vec<(f64, u32)> = (0..count).into_par_iter().map(keyed).collect();
        keys.par_sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        // The powers in a key enlarge a difference by at most the number of sectors.
        let window = rounding.tip * (2.0 + 2.0 * vanes as f64);
        let (mut firsts, mut oldest): (Vec<First>, usize) = (Vec::new(), 0);
        let mut members = vec![Member { class: 0, pitches: 0, order: 0 }; pieces.len()];
        let mut found = Self { vanes: u32::try_from(vanes).unwrap_or(u32::MAX), ..Self::default() };
        for (key, order) in keys {
            while firsts.get(oldest).is_some_and(|first| first.key < key - window) {
                oldest += 1;
            }
            let piece = &pieces[order as usize];
            let partner = firsts[oldest..].iter_mut().rev().take(MAX_COMPARED).find_map(|first| {
                let (pitches, beside) = turned(&pieces[first.order], piece, turns, rounding)?;
                first.around.take(&beside);
                Some((first.class, first.order, pitches))
            });
            let (class, pitches) = match partner {
                Some((class, first, pitches)) => {
                    found.between = found.between.max(piece.between_quarters()).max(pieces[first].between_quarters());
                    (class, pitches)
                }
                None => {
                    let class = u32::try_from(firsts.len()).unwrap_or(u32::MAX);
                    firsts.push(First { key, order: order as usize, class, around: Around::default() });
                    (class, 0)
                }
            };
            members[order as usize] = Member { class, pitches, order };
        }
        for [tip, axis] in firsts.iter().map(|first| first.around.diagonals()) {
            found.off = [found.off[0].max(tip), found.off[1].max(axis)];
        }
        found.by_class.clone_from(&members);
        found.by_class.par_sort_unstable();
        found.first_in_time = vec![u32::MAX; firsts.len()];
        for member in &members {
            let first = &mut found.first_in_time[member.class as usize];
            *first = member.order.min(*first);
        }
        found.members = members;
        found.partial = found.partial();
        found
    }

    fn partial(&self) -> Vec<u32> {
        let in_sectors = |class: &[Member]| class.chunk_by(|a, b| a.pitches == b.pitches).count();
        let classes = self.by_class.chunk_by(|a, b| a.class == b.class);
        let partial = classes.filter(|class| in_sectors(class) < self.vanes as usize);
        let mut orders: Vec<u32> = partial.flatten().map(|member| member.order).collect();
        orders.sort_unstable();
        orders
    }

    /// Number of sectors.
    pub(crate) fn vanes(&self) -> u32 {
        self.vanes
    }

    /// The pieces without a partner turned by a number of pitches, in the order of time.
    pub(crate) fn without_partner(&self, by: u32) -> impl Iterator<Item = u32> + '_ {
        self.partial.iter().copied().filter(move |order| self.partner(*order, by).is_none())
    }

    /// The partner of a piece that is turned by a number of pitches, by their order in time.
    pub(crate) fn partner(&self, order: u32, by: u32) -> Option<u32> {
        let own = self.members.get(order as usize)?;
        let wanted = (own.class, (own.pitches + by) % self.vanes.max(1));
        let at = self.by_class.partition_point(|m| (m.class, m.pitches) < wanted);
        self.by_class.get(at).filter(|m| (m.class, m.pitches) == wanted).map(|m| m.order)
    }

    /// Whether a piece is the first of its class in time.
    pub(crate) fn is_first(&self, order: u32) -> bool {
        self.first_of(order).0 == order
    }

    /// The first piece in time of the class of a piece, and the pitches from that one to the piece.
    pub(crate) fn first_of(&self, order: u32) -> (u32, u32) {
        let Some(own) = self.members.get(order as usize) else { return (order, 0) };
        let first = self.first_in_time[own.class as usize];
        let before = self.members[first as usize].pitches;
        (first, (own.pitches + self.vanes - before) % self.vanes.max(1))
    }

    /// Upper bound of the distance between points of the tool in partners at any time, mm, for points within an arm of its tip.
    /// Between the quarters both axes leave their polynomials.
    pub(crate) fn error(&self, arm: f64) -> f64 {
        let [tip, axis] = self.off;
        tip + (INTERPOLATED * axis + 2.0 * self.between) * arm
    }
}

/// A value that is about the same for partners and differs for most other pieces. The power of the horizontal place turns with
/// the number of sectors, so that a turn by a pitch leaves it as it is.
fn key(piece: &impl Turnable, vanes: usize) -> f64 {
    const WEIGHTS: [f64; 4] = [1.0, 0.754_877_666_2, 0.569_840_290_9, 0.381_966_011_3];
    let [from, to] = piece.tips();
    let radius = from.coords.xy().norm();
    let [x, y] = if radius > 0.0 { power([from.x / radius, from.y / radius], vanes) } else { [0.0; 2] };
    let values = [from.z, radius * x, radius * y, to.z];
    values.iter().zip(WEIGHTS).map(|(value, weight)| value * weight).sum()
}

/// The power of a complex number.
fn power([mut x, mut y]: [f64; 2], mut exponent: usize) -> [f64; 2] {
    let mut result = [1.0, 0.0];
    while exponent > 0 {
        if exponent % 2 == 1 {
            result = [result[0] * x - result[1] * y, result[0] * y + result[1] * x];
        }
        [x, y] = [x * x - y * y, 2.0 * x * y];
        exponent /= 2;
    }
    result
}

/// The number of pitches by which a piece is another one turned, and where it is beside that one; `None` where it is not.
fn turned<P: Turnable>(from: &P, to: &P, turns: &[Rotation3<f64>], rounding: PartnerRounding) -> Option<(u32, Beside)> {
    if from.kind() != to.kind() {
        return None;
    }
    // The angle between the horizontal directions that are farthest from the axis of the part.
    let directions = |piece: &P| [piece.tips()[0].coords, piece.tips()[1].coords, piece.axis(0.5)];
    let [a, b] = [directions(from), directions(to)];
    let (a, b) = a.iter().zip(&b).max_by(|x, y| x.0.xy().norm().total_cmp(&y.0.xy().norm()))?;
    let angle = libm::atan2(a.x * b.y - a.y * b.x, a.x * b.x + a.y * b.y);
    let count = turns.len() as f64;
    let pitches = (angle / std::f64::consts::TAU * count).round().rem_euclid(count) as usize % turns.len();
    let back = turns[pitches].inverse();
    let ends = [0, 1].map(|k| back * to.tips()[k] - from.tips()[k]);
    if ends.iter().any(|off| off.norm() > rounding.tip) {
        return None;
    }
    let axes = [0.0, 0.25, 0.5, 0.75, 1.0].map(|share| back * to.axis(share) - from.axis(share));
    let alike = axes.iter().all(|off| off.norm() <= rounding.axis);
    alike.then(|| (u32::try_from(pitches).unwrap_or(u32::MAX), Beside { tips: ends, axes }))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

    use super::*;
    use crate::proof::piece::{At, divide};
    use five_axis::{Chain, RotaryPose};
    use std::f64::consts::{PI, TAU};

    const VANES: usize = 7;

    fn turns() -> Vec<Rotation3<f64>> {
        (0..VANES).map(|k| Rotation3::from_axis_angle(&Vector3::z_axis(), TAU * k as f64 / VANES as f64)).collect()
    }

    /// The path of sector 0, turned: in every other sector with the other pose of the rotary axes.
    fn path(sector: usize) -> Vec<RotaryPose> {
        let turn = turns()[sector];
        // The part turns against its table.
        let pitch = Chain::tilting_table();
        let unit = |c: f64| pitch.tool_axis([0.5, c]);
        let sign = if (turn * unit(0.0) - unit(TAU * sector as f64 / VANES as f64)).norm() < 1e-9 { 1.0 } else { -1.0 };
        (0..40)
            .map(|k| {
                let t = 0.1 * f64::from(k);
                let tip = turn * Point3::new(20.0 + t, 3.0 * t.sin(), -t);
                let rotary = [0.4 + 0.1 * t, 0.3 * t + sign * TAU * sector as f64 / VANES as f64];
                let other = [-rotary[0], rotary[1] + PI];
                RotaryPose { tip, rotary: if sector.is_multiple_of(2) { rotary } else { other } }
            })
            .collect()
    }

    fn pieces<'a>(chain: &'a Chain, paths: &[Vec<RotaryPose>]) -> Vec<Piece<'a>> {
        let mut pieces = Vec::new();
        for (at, pair) in (0..).zip(paths.iter().flat_map(|path| path.windows(2))) {
            divide(chain, At { operation: 0, index: at }, MoveKind::Cut, [pair[0], pair[1]], &mut pieces);
        }
        pieces
    }

    #[test]
    fn sectors_are_partners_in_both_branches() {
        let chain = Chain::tilting_table();
        let sectors: Vec<Vec<RotaryPose>> = (0..VANES).map(path).collect();
        let pieces = pieces(&chain, &sectors);
        let classes = TurnClasses::of(&pieces, &turns(), PartnerRounding::ARITHMETIC);
        let in_sector = u32::try_from(pieces.len() / VANES).unwrap();
        for order in 0..in_sector * 7 {
            let (sector, own) = (order / in_sector, order % in_sector);
            assert_eq!(classes.is_first(order), sector == 0);
            for by in 0..7 {
                assert_eq!(classes.partner(order, by), Some((sector + by) % 7 * in_sector + own));
            }
        }
        assert!(classes.error(100.0) < 1e-8);
    }

    /// A point that is moved by a micrometre or an axis turned by 0.01 deg in one sector has no partner; no other piece loses its own.
    #[test]
    fn a_change_in_one_sector_is_seen() {
        let chain = Chain::tilting_table();
        for change in [[1e-3, 0.0], [0.0, 1.7e-4], [2e-7, 0.0]] {
            let mut sectors: Vec<Vec<RotaryPose>> = (0..VANES).map(path).collect();
            sectors[4][20].tip.z += change[0];
            sectors[4][20].rotary[0] += change[1];
            let pieces = pieces(&chain, &sectors);
            let classes = TurnClasses::of(&pieces, &turns(), PartnerRounding::ARITHMETIC);
            let changed: Vec<&Piece<'_>> =
                pieces.iter().zip(0..).filter(|(_, k)| classes.partner(*k, 3).is_none()).map(|(p, _)| p).collect();
            // Both moves at the changed point, and their partners three sectors before.
            let moves: Vec<u32> = changed.iter().map(|p| p.at.index).collect();
            let moves: std::collections::BTreeSet<u32> = moves.into_iter().collect();
            assert_eq!(moves, [39 + 19, 39 + 20, 4 * 39 + 19, 4 * 39 + 20].into(), "{change:?}");
        }
    }

    /// Nothing is a partner where the sectors are no pitch apart, and a part of one sector has no partners but copies.
    #[test]
    fn other_turns_are_no_partners() {
        let chain = Chain::tilting_table();
        let pieces = pieces(&chain, &(0..VANES).map(path).collect::<Vec<_>>());
        let eight: Vec<Rotation3<f64>> =
            (0..8).map(|k| Rotation3::from_axis_angle(&Vector3::z_axis(), TAU * f64::from(k) / 8.0)).collect();
        let classes = TurnClasses::of(&pieces, &eight, PartnerRounding::ARITHMETIC);
        assert!((0..u32::try_from(pieces.len()).unwrap()).all(|k| (1..8).all(|by| classes.partner(k, by).is_none())));
        let classes = TurnClasses::of(&pieces, &eight[..1], PartnerRounding::ARITHMETIC);
        assert!((0..u32::try_from(pieces.len()).unwrap()).all(|k| classes.partner(k, 0) == Some(k)));
    }
}
