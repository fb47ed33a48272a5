//! Tile lists that keep the order of the picture before, along a camera path.
//!
//! From one picture of a path to the next most splats stay in their tiles, and in nearly the same order. A machine may
//! keep the lists: entries whose splat has left a tile are dropped, those that came are sorted by themselves and merged
//! in, each before the first one that is farther than it is. What stays is not compared with what stays, so that the
//! order grows old until the next full sort. Here are both sides of it: the picture that such lists give, and how many
//! entries come and go.

use super::{Bins, Workload};
use rayon::prelude::*;
use std::collections::HashSet;

/// Entries of all lists that changed from the picture before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct OrderChanges {
    /// Entries that the list of the picture before has not.
    pub came: u64,
    /// Entries of the list before that are gone.
    pub left: u64,
    /// Pairs of entries of a tile of which the farther one is drawn first.
    pub inversions: u64,
    /// All pairs of entries of a tile.
    pub pairs: u64,
}

/// The lists of the picture before.
#[derive(Clone, Copy)]
pub(super) struct Before<'a> {
    pub workload: &'a Workload,
    /// Do lists hold only what the traversal visits?
    pub exact: bool,
}

impl Before<'_> {
    /// Splats in a tile's list, in its order.
    fn list(&self, tile: usize) -> Vec<u32> {
        let pairs = self.workload.pairs_of(tile).iter();
        let listed = pairs.filter(|pair| pair.visits || !self.exact);
        listed.map(|pair| pair.splat).collect()
    }

    /// Puts lists, which are in the order of `rank`, into the order in which such a machine would have them.
    pub fn keep_order(&self, bins: &mut Bins, rank: &[u32]) {
        let lists = bins.lists.par_iter_mut().enumerate();
        lists.for_each(|(tile, list)| *list = merged(&self.list(tile), list, rank));
    }

    /// What changed, of a picture in the order of its lists.
    pub fn changes(&self, now: &Workload, rank: &[u32]) -> OrderChanges {
        let new = Before {
            workload: now,
            exact: self.exact,
        };
        let one = |tile: usize| {
            let [old, list] = [self.list(tile), new.list(tile)];
            let [was, is] = [&old[..], &list].map(set);
            let length = list.len() as u64;
            OrderChanges {
                came: is.difference(&was).count() as u64,
                left: was.difference(&is).count() as u64,
                inversions: inversions(list.iter().map(|splat| rank[*splat as usize]).collect()),
                pairs: length * length.saturating_sub(1) / 2,
            }
        };
        let all = (0..now.tiles.len()).into_par_iter().map(one);
        all.reduce(OrderChanges::default, |a, b| OrderChanges {
            came: a.came + b.came,
            left: a.left + b.left,
            inversions: a.inversions + b.inversions,
            pairs: a.pairs + b.pairs,
        })
    }
}

fn set(list: &[u32]) -> HashSet<u32> {
    list.iter().copied().collect()
}

/// What stayed in the order of `before`, and among it what came; `now` is in the order of `rank`.
fn merged(before: &[u32], now: &[u32], rank: &[u32]) -> Vec<u32> {
    let [here, known] = [now, before].map(set);
    let came = now.iter().copied().filter(|splat| !known.contains(splat));
    let mut came = came.peekable();
    let mut list = Vec::with_capacity(now.len());
    for splat in before.iter().copied().filter(|splat| here.contains(splat)) {
        let nearer = |other: &u32| rank[*other as usize] < rank[splat as usize];
        while let Some(new) = came.next_if(nearer) {
            list.push(new);
        }
        list.push(splat);
    }
    list.extend(came);
    list
}

/// Pairs of values of which the larger comes first, counted by merging.
fn inversions(mut values: Vec<u32>) -> u64 {
    let mut spare = values.clone();
    let (mut count, mut width) = (0, 1);
    while width < values.len() {
        for start in (0..values.len()).step_by(2 * width) {
            let middle = (start + width).min(values.len());
            let end = (start + 2 * width).min(values.len());
            let [mut left, mut right] = [start, middle];
            for place in &mut spare[start..end] {
                let takes_right = right < end && (left >= middle || values[right] < values[left]);
                if takes_right {
                    // It passes all that is left of the left half.
                    count += (middle - left) as u64;
                    *place = values[right];
                    right += 1;
                } else {
                    *place = values[left];
                    left += 1;
                }
            }
        }
        std::mem::swap(&mut values, &mut spare);
        width *= 2;
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn inversions_are_those_of_all_pairs(values in proptest::collection::vec(0u32..40, 0..60)) {
            let mut naive = 0;
            for (place, first) in values.iter().enumerate() {
                naive += values[place..].iter().filter(|other| *other < first).count() as u64;
            }
            prop_assert_eq!(inversions(values), naive);
        }

        /// Everything that is there once; what stayed in its old order; what came before the first of the old ones that
        /// is farther.
        #[test]
        fn a_kept_list_is_the_old_order_with_what_came(
            before in Just((0u32..30).collect::<Vec<_>>()).prop_shuffle(),
            rank in Just((0u32..30).collect::<Vec<_>>()).prop_shuffle(),
            old in 0usize..30,
            here in proptest::collection::vec(any::<bool>(), 30),
        ) {
            let before = &before[..old];
            let mut now: Vec<u32> = (0..30).filter(|splat| here[*splat as usize]).collect();
            now.sort_by_key(|splat| rank[*splat as usize]);
            let list = merged(before, &now, &rank);
            let mut sorted = list.clone();
            sorted.sort_by_key(|splat| rank[*splat as usize]);
            prop_assert_eq!(&sorted, &now);
            let stayed: Vec<u32> = list.iter().copied().filter(|splat| before.contains(splat)).collect();
            let expected: Vec<u32> = before.iter().copied().filter(|splat| here[*splat as usize]).collect();
            prop_assert_eq!(&stayed, &expected);
            for (place, splat) in list.iter().enumerate().filter(|(_, splat)| !before.contains(splat)) {
                let farther = |other: &&u32| before.contains(other) && rank[**other as usize] > rank[*splat as usize];
                let first_farther = list.iter().position(|other| farther(&other));
                prop_assert!(first_farther.is_none_or(|first| place < first));
                let nearer_old = list[place..].iter().take_while(|other| !farther(other)).any(|other| before.contains(other));
                prop_assert!(!nearer_old, "it stands behind all that is nearer up to there");
            }
        }
    }
}
