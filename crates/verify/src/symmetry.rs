//! Sectors of the wheel in which the program is the same motion, turned.
//!
//! The part is the same in each sector. Let the moves of the program be a set M, and let those of them that have no partner
//! ([`super::proof::turns`]) in the next sector be the set E, and those without a partner in the sector before be E'. Turned by a
//! pitch, M without E is M without E'. Where no move of E comes near a surface of a sector, and no move of E' near the same surface
//! of the next one, nearer than what is proved of the first, that is proved of the second too; and the same the other way round.
//! So a proof goes on from sector to sector, until it meets a place where the motion is another one. What it does not reach is
//! proved by itself, and goes on from there.
//!
//! All partners of a piece lie within one small box ([`super::proof::turns`]), so that a proof that went through many sectors is off
//! by no more than one that went through one.
//!
//! Nothing is taken from the planner: a block that was changed in one sector has no partner there, or it differs by less than the
//! rounding of a text; the bounds of what follows contain by how much.

use super::proof::cells::PatchTask;
use super::proof::grid::{Grid, PlacedSurface};
use super::proof::piece::At;
use super::proof::sweep::Sweep;
use nalgebra::Point3;
use rayon::prelude::*;
use std::collections::BTreeMap;
use wheel::part::{Part, Surface, SurfaceId, SurfaceKind};

/// Share of all pieces that may lack a partner in the next sector. Where more do, each sector is proved by itself without a trial.
const MAX_UNSHARED: f64 = 1.0 / 3.0;

/// Share of the pieces of the sector with most of them that the first proved sector has at least.
const MIN_OF_BUSIEST: f64 = 0.9;

/// By how many pieces, as a share of those of the sector with most, sectors may differ that serve equally well.
const EQUALLY_WELL: f64 = 0.02;

/// What each sector has in common with the next one.
pub(super) struct Symmetry<'a> {
    sweeps: &'a [Sweep<'a>],
    /// Number of the sectors.
    pub(super) vanes: u32,
    /// The sector that is proved first.
    pub(super) first: u32,
    /// The pieces without a partner in the next sector, and those without one in the sector before; `None` where there are too many.
    unshared: Option<[Vec<Sweep<'a>>; 2]>,
}

impl<'a> Symmetry<'a> {
    /// The partners in the sweeps of a program for a part.
    pub(super) fn of(sweeps: &'a [Sweep<'a>], part: &Part) -> Self {
        let vanes = part.vane_count;
        let most = MAX_UNSHARED * sweeps.iter().map(Sweep::len).sum::<usize>() as f64;
        // Partners in sweeps of another part say nothing of this one.
        let known = vanes > 1 && sweeps.iter().all(|sweep| sweep.sectors() == Some(vanes));
        let without = |pitches: u32| -> Option<Vec<Sweep<'a>>> {
            let pieces: Vec<_> = sweeps.iter().map(|sweep| sweep.without_partner(pitches)).collect::<Option<_>>()?;
            let few = pieces.iter().map(Vec::len).sum::<usize>() as f64 <= most;
            few.then(|| sweeps.iter().zip(pieces).filter_map(|(sweep, pieces)| sweep.of_pieces(pieces)).collect())
        };
        let both = || rayon::join(|| without(1), || without(vanes - 1));
        let unshared = known.then(both).and_then(|(ahead, behind)| Some([ahead?, behind?]));
        let first = like_most_others(sweeps, unshared.iter().flatten().flatten(), part);
        Self { sweeps, vanes, first, unshared }
    }

    /// Whether any sector may follow from another one.
    pub(super) fn is_any(&self) -> bool {
        self.unshared.is_some()
    }

    /// Upper bound of the distance between what is proved of one sector and what holds in those that follow from it, mm.
    pub(super) fn error(&self) -> f64 {
        Sweep::largest_partner_error(self.sweeps)
    }

    /// Pieces that a sector and the one beside it do not share: of the first one and of the other.
    fn unshared_between(&self, [own, other]: [u32; 2]) -> Option<[&[Sweep<'a>]; 2]> {
        let [ahead, behind] = self.unshared.as_ref()?.each_ref().map(Vec::as_slice);
        Some(if (own + 1) % self.vanes == other { [ahead, behind] } else { [behind, ahead] })
    }

    /// Whether in `grids` of two surfaces, the same one in a sector and in the one beside it, no unshared move comes within a
    /// distance.
    pub(super) fn follows(&self, [own, other]: [&PlacedSurface<'_>; 2], grids: &[&Grid], distance: f64) -> bool {
        let Some([ahead, behind]) = self.unshared_between([own.id.sector, other.id.sector]) else { return false };
        let reach = distance + self.error();
        let is_clear = |surface, sweeps: &[Sweep<'_>]| {
            sweeps.is_empty() || grids.iter().all(|grid| PatchTask { surface, grid, sweeps }.keeps_clear(reach))
        };
        is_clear(own, ahead) && is_clear(other, behind)
    }

    /// Pieces of the operation of a sweep that a sector and the next one do not share.
    pub(super) fn unshared_in(&self, sweep: &Sweep<'_>) -> Option<[Option<&Sweep<'a>>; 2]> {
        let of_operation = |sweeps: &'_ Vec<Sweep<'a>>| sweeps.iter().position(|s| s.operation() == sweep.operation());
        let unshared = self.unshared.as_ref()?;
        Some(unshared.each_ref().map(|sweeps| of_operation(sweeps).and_then(|k| sweeps.get(k))))
    }

    /// The move in a sector that is the partner of a move in another one.
    pub(super) fn partner(&self, at: At, [own, other]: [u32; 2]) -> Option<At> {
        let sweep = self.sweeps.iter().find(|sweep| sweep.operation() == Some(at.operation))?;
        sweep.partner_at(at, (other + self.vanes - own) % self.vanes)
    }

    /// What is proved of each surface, in their order. `prove` proves surfaces, by their indices, each by itself. `follow` takes what
    /// was proved of one to a second, if it holds there, from a third that it was taken to before and that lies beside the second.
    /// Results are missing only of a run that was cancelled.
    pub(super) fn prove<R: Clone + Send + Sync>(
        &self,
        surfaces: &[SurfaceId],
        prove: impl Fn(&[usize]) -> Vec<R>,
        follow: impl Fn(Step, &R) -> Option<R> + Sync,
    ) -> Vec<Option<R>> {
        let mut rings: BTreeMap<SurfaceKind, Vec<Option<usize>>> = BTreeMap::new();
        for (index, id) in surfaces.iter().enumerate() {
            rings.entry(id.kind).or_insert_with(|| vec![None; self.vanes as usize])[id.sector as usize] = Some(index);
        }
        let mut found: Vec<Option<R>> = vec![None; surfaces.len()];
        loop {
            let starts: Vec<(&[Option<usize>], usize)> = rings
                .values()
                .flat_map(|ring| {
                    let is_open = |sector: usize| ring[sector].is_some_and(|surface| found[surface].is_none());
                    starts(ring.len(), self.first as usize, is_open).into_iter().map(|sector| (ring.as_slice(), sector))
                })
                .collect();
            let these: Vec<usize> = starts.iter().filter_map(|(ring, sector)| ring[*sector]).collect();
            let proved = prove(&these);
            if these.is_empty() || proved.len() < these.len() {
                return found;
            }
            these.iter().zip(proved).for_each(|(surface, proved)| found[*surface] = Some(proved));
            let walks: Vec<Vec<(usize, R)>> =
                starts.par_iter().map(|(ring, at)| walk(ring, *at, &found, &follow)).collect();
            walks.into_iter().flatten().for_each(|(surface, result)| found[surface] = Some(result));
        }
    }
}

/// A proof is taken to a surface: indices of the one that was proved, of the one beside that it was taken to before, and of the one
/// that it is taken to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    pub(super) proved: usize,
    pub(super) beside: usize,
    pub(super) to: usize,
}

/// The sectors of a ring that are proved next: one in the middle of each run of open sectors; the first one if all are open.
fn starts(count: usize, first: usize, is_open: impl Fn(usize) -> bool) -> Vec<usize> {
    let Some(closed) = (0..count).find(|sector| !is_open(*sector)) else { return vec![first] };
    let ring: Vec<usize> = (1..=count).map(|k| (closed + k) % count).collect();
    let runs = ring.chunk_by(|a, b| is_open(*a) == is_open(*b)).filter(|run| is_open(run[0]));
    runs.map(|run| run[run.len() / 2]).collect()
}

/// Takes what was proved in a sector of a ring from sector to sector, ahead and then back, as far as it holds.
fn walk<R: Clone>(
    ring: &[Option<usize>],
    from: usize,
    found: &[Option<R>],
    follow: &impl Fn(Step, &R) -> Option<R>,
) -> Vec<(usize, R)> {
    let mut reached: Vec<(usize, R)> = Vec::new();
    let Some((proved, result)) = ring[from].and_then(|surface| Some((surface, found[surface].as_ref()?))) else {
        return reached;
    };
    for by in [1, ring.len() - 1] {
        let (mut sector, mut beside) = (from, proved);
        loop {
            sector = (sector + by) % ring.len();
            let open =
                ring[sector].filter(|to| found[*to].is_none() && reached.iter().all(|(surface, _)| surface != to));
            let Some(taken) = open.and_then(|to| Some((to, follow(Step { proved, beside, to }, result)?))) else {
                break;
            };
            beside = taken.0;
            reached.push(taken);
        }
    }
    reached
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

#[cfg(test)]
mod tests {
    use super::*;

    /// What is proved in each sector, and the sectors that were proved by themselves in each round. `wall` is a step between sectors,
    /// from a sector to the next one, that nothing follows over.
    fn proved(vanes: u32, first: u32, walls: &[u32]) -> (Vec<u32>, Vec<Vec<u32>>) {
        let symmetry = Symmetry { sweeps: &[], vanes, first, unshared: None };
        let surfaces: Vec<SurfaceId> = (0..vanes).map(|sector| SurfaceId { kind: SurfaceKind::Rim, sector }).collect();
        let rounds = std::cell::RefCell::new(Vec::new());
        let prove = |these: &[usize]| {
            let these: Vec<u32> = these.iter().map(|k| surfaces[*k].sector).collect();
            rounds.borrow_mut().extend((!these.is_empty()).then(|| these.clone()));
            these
        };
        let follow = |step: Step, result: &u32| {
            let [from, to] = [step.beside, step.to].map(|k| surfaces[k].sector);
            let ahead = (from + 1) % vanes == to;
            assert!(ahead || (to + 1) % vanes == from, "{step:?}");
            assert_eq!(surfaces[step.proved].sector, *result);
            let wall = if ahead { from } else { to };
            (!walls.contains(&wall)).then_some(*result)
        };
        let found = symmetry.prove(&surfaces, prove, follow);
        (found.into_iter().map(|result| result.unwrap_or(u32::MAX)).collect(), rounds.into_inner())
    }

    #[test]
    fn a_proof_goes_around_the_wheel() {
        assert_eq!(proved(8, 3, &[]), (vec![3; 8], vec![vec![3]]));
        assert_eq!(proved(8, 3, &[3]), (vec![3; 8], vec![vec![3]]));
        assert_eq!(proved(1, 0, &[]), (vec![0], vec![vec![0]]));
    }

    /// Sector 5 of 8 is another one; then all are.
    #[test]
    fn a_proof_ends_where_the_motion_is_another_one() {
        assert_eq!(proved(8, 1, &[4, 5]), (vec![1, 1, 1, 1, 1, 5, 1, 1], vec![vec![1], vec![5]]));
        let (found, rounds) = proved(8, 1, &[0, 1, 2, 3, 4, 5, 6, 7]);
        assert_eq!(found, (0..8).collect::<Vec<_>>());
        assert_eq!(rounds, [vec![1], vec![5], vec![3, 7], vec![2, 4, 6, 0]]);
    }
}
