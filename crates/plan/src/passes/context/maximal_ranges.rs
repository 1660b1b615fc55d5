//! Maximal ranges of indices with a property.

use std::ops::Range;

/// Ranges below `count` in which every index has a property, each as long as possible, in order.
pub(crate) fn maximal_ranges(count: usize, has: impl Fn(usize) -> bool) -> Vec<Range<usize>> {
    let mut ranges: Vec<Range<usize>> = Vec::new();
    for i in (0..count).filter(|i| has(*i)) {
        match ranges.last_mut() {
            Some(last) if last.end == i => last.end = i + 1,
            _ => ranges.push(i..i + 1),
        }
    }
    ranges
}

#[cfg(test)]
mod tests {
    use super::maximal_ranges;

    #[test]
    fn each_range_is_as_long_as_possible() {
        let marked = [true, true, false, true, false, false, true];
        assert_eq!(maximal_ranges(7, |i| marked[i]), [0..2, 3..4, 6..7]);
        assert!(maximal_ranges(7, |_| false).is_empty() && maximal_ranges(0, |_| true).is_empty());
    }
}
