//! Nodes of patches: the places through whose points the spline surfaces go.
//!
//! A blade bends in its nose and hardly behind it. Equal steps that are short enough for the nose make files of a hundred
//! megabytes. Nodes are therefore far apart at first, and an interval between two nodes is halved where the surface is not near
//! enough.

use super::patch::{PatchDirection, Shares};

/// Places of the finest intervals in an interval between the first nodes: these can be halved ten times.
const FINEST: usize = 1 << 11;

/// Directions in which some patches or lines on the circles run backwards: their nodes are the same from both ends.
const BOTH_WAYS: [PatchDirection; 4] =
    [PatchDirection::Shoulder, PatchDirection::Blade, PatchDirection::Channel, PatchDirection::Before];

/// Of each direction of patches, the places of its nodes, which ascend.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct PatchNodes([Vec<usize>; 7]);

/// Intervals that are to be halved, of each direction by their number.
#[derive(Clone, Debug, Default)]
pub(super) struct Halved([Vec<usize>; 7]);

impl Halved {
    /// Marks an interval of a direction.
    pub(super) fn mark(&mut self, direction: PatchDirection, interval: usize) {
        self.0[direction as usize].push(interval);
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.iter().all(Vec::is_empty)
    }
}

impl PatchNodes {
    /// So many equal intervals in each direction.
    pub(super) fn equal(intervals: [usize; 7]) -> Self {
        Self(intervals.map(|n| (0..=n).map(|k| k * FINEST).collect()))
    }

    /// Parameters of the nodes of a direction: shares of its length.
    pub(super) fn parameters(&self, direction: PatchDirection) -> Vec<f64> {
        shares(&self.0[direction as usize])
    }

    /// The nodes and the middles of their intervals.
    pub(super) fn with_middles(&self) -> Shares {
        let refined = |nodes: &Vec<usize>| {
            let middles = nodes.windows(2).flat_map(|pair| [pair[0], pair[0].midpoint(pair[1])]);
            shares(&middles.chain(nodes.last().copied()).collect::<Vec<_>>())
        };
        Shares(self.0.each_ref().map(refined))
    }

    /// Halves the marked intervals, and those that are then more than twice as long as a neighbour. False where an interval is too
    /// short for that.
    pub(super) fn halve(&mut self, marked: &Halved) -> bool {
        for (d, (nodes, marked)) in self.0.iter_mut().zip(&marked.0).enumerate() {
            let last = nodes[nodes.len() - 1];
            let middle = |nodes: &[usize], k: usize| nodes[k].midpoint(nodes[k + 1]);
            let mut new: Vec<usize> = marked.iter().map(|k| middle(nodes, *k)).collect();
            if BOTH_WAYS.iter().any(|way| *way as usize == d) {
                new.extend(new.clone().into_iter().map(|place| last - place));
            }
            while !new.is_empty() {
                nodes.append(&mut new);
                nodes.sort_unstable();
                nodes.dedup();
                let length = |k: usize| nodes[k + 1] - nodes[k];
                let intervals = nodes.len() - 1;
                let uneven = |k: &usize| {
                    let neighbours = [k.checked_sub(1), Some(k + 1).filter(|k| *k < intervals)];
                    neighbours.into_iter().flatten().any(|other| length(*k) > 2 * length(other))
                };
                new = (0..intervals).filter(uneven).map(|k| middle(nodes, k)).collect();
            }
            if nodes.windows(2).any(|pair| pair[1] - pair[0] < 2) {
                return false;
            }
        }
        true
    }
}

/// Places as shares of the last one.
fn shares(places: &[usize]) -> Vec<f64> {
    let last = places[places.len() - 1] as f64;
    places.iter().map(|k| *k as f64 / last).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn halved(nodes: &mut PatchNodes, direction: PatchDirection, interval: usize) -> bool {
        let mut marked = Halved::default();
        marked.mark(direction, interval);
        nodes.halve(&marked)
    }

    /// Neighbours differ by a factor of two at most, and the ends stay.
    #[test]
    fn intervals_grow_by_steps() {
        let mut nodes = PatchNodes::equal([2, 1, 1, 1, 1, 1, 1]);
        for _ in 0..4 {
            assert!(halved(&mut nodes, PatchDirection::Along, 0));
        }
        let of = |places: &[f64]| places.iter().map(|k| k / 32.0).collect::<Vec<_>>();
        assert_eq!(nodes.parameters(PatchDirection::Along), of(&[0.0, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0]));
        assert!(halved(&mut nodes, PatchDirection::Along, 1));
        let places = of(&[0.0, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0, 32.0]);
        assert_eq!(nodes.parameters(PatchDirection::Along), places);
        let middles = nodes.with_middles();
        let middles = middles.of(PatchDirection::Along);
        assert_eq!(middles[..5], of(&[0.0, 0.5, 1.0, 1.25, 1.5]));
        assert_eq!(middles.len(), 2 * places.len() - 1);
    }

    /// Where some patches run backwards, nodes are the same from both ends; intervals have a least length.
    #[test]
    fn nodes_are_the_same_both_ways() {
        let mut nodes = PatchNodes::equal([2; 7]);
        assert!(halved(&mut nodes, PatchDirection::Channel, 0));
        assert_eq!(nodes.parameters(PatchDirection::Channel), [0.0, 0.25, 0.5, 0.75, 1.0]);
        let rounds = (0..20).take_while(|_| halved(&mut nodes, PatchDirection::Face, 0)).count();
        assert_eq!(rounds, 10);
    }
}
