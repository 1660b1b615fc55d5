//! Sectors in which the passes of an operation meet the same stock as in another sector, turned.
//!
//! The blank is a body of revolution and the part is the same in each sector. An operation goes from sector to sector. What a
//! sector finds is therefore what another one finds, turned, where the sectors beside both were machined alike: the sector
//! before by this operation, the others by the same earlier operations. So the second sector stands for those behind it. The
//! last one of a whole wheel finds no more than that, since the sector behind it is cut already.
//!
//! The cells of the simulated stock lie differently in each sector. Passes and links allow for the error between its rays,
//! wherever the rays lie.

use ir::{ClPass, Program};
use nalgebra::Rotation3;

/// Fewest sectors of a part of which one has two different neighbours.
const MIN_SECTORS: u32 = 3;

/// Largest distance between a place of a pass and the place of another one, turned, mm, and of their unit axes, where both
/// passes are one.
const SAME_PLACE_MM: f64 = 1e-7;
const SAME_AXIS: f64 = 1e-9;

/// Sectors of the operations of a plan up to one of them.
pub(super) struct LikeSectors<'a> {
    pub(super) program: &'a Program,
    machined: &'a [&'a [u32]],
}

impl<'a> LikeSectors<'a> {
    /// For the last one of the operations that machine these sectors, in their order.
    pub(super) fn new(program: &'a Program, machined: &'a [&'a [u32]]) -> Self {
        Self { program, machined }
    }

    /// Whether the sector before has been machined by the operation.
    pub(super) fn follows(&self, sector: u32) -> bool {
        let own = self.machined.last().copied().unwrap_or_default();
        sector.checked_sub(1).is_some_and(|before| own.contains(&before))
    }

    /// The turn from one sector to another where the passes of the other one meet the same stock.
    pub(super) fn turn(&self, from: u32, to: u32) -> Option<Rotation3<f64>> {
        let part = &self.program.part;
        let vanes = part.vane_count;
        let alike = |list: &&[u32]| {
            [vanes - 1, 0, 1].iter().all(|beside| {
                let [a, b] = [from, to].map(|sector| list.contains(&((sector + beside) % vanes)));
                a == b
            })
        };
        let is_like = vanes >= MIN_SECTORS
            && self.program.stock.left.is_none()
            && self.follows(from)
            && self.follows(to)
            && self.machined.iter().all(alike);
        is_like.then(|| part.sector_rotation(to) * part.sector_rotation(from).inverse())
    }
}

/// A pass of one sector in another one.
pub(super) fn turned(pass: &ClPass, sector: u32, turn: &Rotation3<f64>) -> ClPass {
    let name = pass.label.strip_prefix(&format!("sector {} ", pass.sector + 1)).unwrap_or(&pass.label);
    let points = |points: &[ir::ClPoint]| points.iter().map(|p| p.turned(turn)).collect();
    ClPass {
        label: format!("sector {} {name}", sector + 1),
        sector,
        points: points(&pass.points),
        air: pass.air.clone(),
        link: pass.link.as_deref().map(points),
    }
}

/// Whether passes are others, turned.
pub(super) fn are_turned(from: &[ClPass], to: &[ClPass], turn: &Rotation3<f64>) -> bool {
    let same = |(a, b): (&ClPass, &ClPass)| {
        a.points.len() == b.points.len()
            && a.points.iter().zip(&b.points).all(|(p, q)| {
                (turn * p.tip - q.tip).norm() <= SAME_PLACE_MM && (turn * p.axis - q.axis).norm() <= SAME_AXIS
            })
    };
    from.len() == to.len() && from.iter().zip(to).all(same)
}
