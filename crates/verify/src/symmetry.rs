//! Sectors of the wheel in which the program is the same motion, turned.
//!
//! The part is the same in each sector. Let the moves of the program be a set M, and let those of them that have no partner
//! ([`super::proof::turns`]) from one sector to another be the set E, and those without a partner from the other back be E'.
//! Turned by the pitches between both, M without E is M without E'. Where no move of E comes near a surface of the first
//! sector, and no move of E' near the same surface of the second, nearer than what is proved of the first, that is proved of the
//! second too. Surfaces for which this does not hold are proved by themselves.
//!
//! Nothing is taken from the planner: a block that was changed in one sector has no partner there, or it differs by less than the
//! rounding of a text; the bounds of what follows contain by how much.

use super::proof::cells::PatchTask;
use super::proof::grid::{Grid, PlacedSurface};
use super::proof::piece::At;
use super::proof::sweep::Sweep;
use nalgebra::Point3;
use rayon::prelude::*;
use wheel::part::{Part, Surface};

/// Share of all pieces that may lack a partner between two sectors. Where more do, each sector is proved by itself without a
/// trial.
const MAX_UNSHARED: f64 = 1.0 / 3.0;

/// Share of the pieces of the sector with most of them that the first proved sector has at least.
const MIN_OF_BUSIEST: f64 = 0.9;

/// By how many pieces, as a share of those of the sector with most, sectors may differ that serve equally well.
const EQUALLY_WELL: f64 = 0.02;

/// What the sectors have in common with the first proved one.
pub(super) struct Symmetry<'a> {
    sweeps: &'a [Sweep<'a>],
    vanes: u32,
    /// The sector that is proved first.
    pub(super) first: u32,
    /// For each number of pitches the pieces without a partner turned by it; `None` where there are too many.
    unshared: Vec<Option<Vec<Sweep<'a>>>>,
}

impl<'a> Symmetry<'a> {
    /// The partners in the sweeps of a program for a part.
    pub(super) fn of(sweeps: &'a [Sweep<'a>], part: &Part) -> Self {
        let vanes = part.vane_count;
        let most = MAX_UNSHARED * sweeps.iter().map(Sweep::len).sum::<usize>() as f64;
        // Partners in sweeps of another part say nothing of this one.
        let known = sweeps.iter().all(|sweep| sweep.sectors() == Some(vanes));
        let without = |pitches: u32| {
            if !known {
                return None;
            }
            let pieces: Vec<_> = sweeps.iter().map(|sweep| sweep.without_partner(pitches)).collect::<Option<_>>()?;
            let few = pieces.iter().map(Vec::len).sum::<usize>() as f64 <= most;
            few.then(|| sweeps.iter().zip(pieces).filter_map(|(sweep, pieces)| sweep.of_pieces(pieces)).collect())
        };
        let unshared: Vec<Option<Vec<Sweep<'a>>>> = (0..vanes).into_par_iter().map(without).collect();
        let first = like_most_others(sweeps, unshared.iter().flatten().flatten(), part);
        Self { sweeps, vanes, first, unshared }
    }

    /// Whether any sector may follow from the first one.
    pub(super) fn is_any(&self) -> bool {
        self.unshared.iter().skip(1).any(Option::is_some)
    }

    /// Upper bound of the distance between what is proved of one sector and what holds in another, mm.
    pub(super) fn error(&self) -> f64 {
        Sweep::largest_partner_error(self.sweeps)
    }

    /// Pitches from the first sector to another.
    fn pitches(&self, sector: u32) -> u32 {
        (sector + self.vanes - self.first) % self.vanes
    }

    /// Pieces that the first sector and another one do not share: of the first one and of the other. `None` where there are too
    /// many.
    fn unshared_with(&self, sector: u32) -> Option<[&[Sweep<'a>]; 2]> {
        let pitches = self.pitches(sector);
        let unshared = |pitches: u32| self.unshared.get(pitches as usize)?.as_deref();
        Some([unshared(pitches)?, unshared((self.vanes - pitches) % self.vanes)?])
    }

    /// Whether in `grids` of two surfaces, the same one in the first sector and in another, no unshared move comes within a
    /// distance.
    pub(super) fn follows(&self, [first, other]: [&PlacedSurface<'_>; 2], grids: &[&Grid], distance: f64) -> bool {
        let Some([ahead, behind]) = self.unshared_with(other.id.sector) else { return false };
        let reach = distance + self.error();
        let is_clear = |surface, sweeps: &[Sweep<'_>]| {
            sweeps.is_empty() || grids.iter().all(|grid| PatchTask { surface, grid, sweeps }.keeps_clear(reach))
        };
        is_clear(first, ahead) && is_clear(other, behind)
    }

    /// [`Self::unshared_with`] of the operation of a sweep.
    pub(super) fn unshared_in(&self, sweep: &Sweep<'_>, sector: u32) -> Option<[Option<&Sweep<'a>>; 2]> {
        Some(self.unshared_with(sector)?.map(|sweeps| sweeps.iter().find(|s| s.operation() == sweep.operation())))
    }

    /// The move in a sector that is the partner of a move of the first sector.
    pub(super) fn partner(&self, at: At, sector: u32) -> Option<At> {
        let sweep = self.sweeps.iter().find(|sweep| sweep.operation() == Some(at.operation))?;
        sweep.partner_at(at, self.pitches(sector))
    }
}

/// Of the sectors that have about as many pieces as any, the first with about the fewest pieces that another sector lacks, in it
/// and beside it: from it most others follow. Often it is the second, since the first one is cut with both neighbours still full.
fn like_most_others<'a, 's>(sweeps: &[Sweep<'_>], unshared: impl Iterator<Item = &'s Sweep<'a>>, part: &Part) -> u32
where
    'a: 's,
{
    let pieces = in_sectors(sweeps.iter(), part);
    let own = in_sectors(unshared, part);
    let beside = |sector: usize| [sector + own.len() - 1, sector, sector + 1].map(|s| own[s % own.len()]);
    let alone: Vec<usize> = (0..own.len()).map(|sector| beside(sector).iter().sum()).collect();
    let most = pieces.iter().copied().max().unwrap_or(0) as f64;
    let busy = || (0..pieces.len()).filter(|sector| pieces[*sector] as f64 >= MIN_OF_BUSIEST * most);
    let fewest = busy().map(|sector| alone[sector] as f64).fold(f64::INFINITY, f64::min);
    let first = busy().find(|sector| alone[*sector] as f64 <= fewest + EQUALLY_WELL * most);
    first.and_then(|sector| u32::try_from(sector).ok()).unwrap_or(0)
}

/// Number of the pieces about the main blade of each sector.
fn in_sectors<'a, 's>(sweeps: impl Iterator<Item = &'s Sweep<'a>>, part: &Part) -> Vec<usize>
where
    'a: 's,
{
    let blade = part.faces().next().map_or(Point3::origin(), |face| part.face(face).surface.point(0.5, 0.5));
    let azimuth = |p: &Point3<f64>| libm::atan2(p.y, p.x);
    let count = f64::from(part.vane_count);
    let mut counts = vec![0_usize; part.vane_count as usize];
    for piece in sweeps.flat_map(Sweep::in_time) {
        let pitches = (azimuth(&piece.middle().tip) - azimuth(&blade)) / std::f64::consts::TAU * count;
        let sector = (pitches + 0.5).floor().rem_euclid(count) as usize;
        counts[sector.min(part.vane_count as usize - 1)] += 1;
    }
    counts
}
