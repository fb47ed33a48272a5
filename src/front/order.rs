//! Depth order of a display list.
//!
//! Numbers or keys are moved, not footprints: a footprint has a hundred bytes. Heap sort, because it needs no memory,
//! never more than 2 n log2 n comparisons, and on a Cortex-M0 590 bytes of code. The standard library's unstable sort
//! is faster on long lists, but takes 13,562 bytes there and a panic path, for orders that contradict themselves.

use core::cell::Cell;

/// Sorts `items` by ascending key, in place, without allocation or panic. Not stable: keys that must keep an order have
/// to differ.
///
/// At most `2 n log2(n) + 2 n` comparisons, whatever the keys; a key that contradicts itself gives some order.
pub fn sort_by_key<T: Copy, K: Ord>(items: &mut [T], key: impl Fn(T) -> K) {
    let numbers = Cell::from_mut(items).as_slice_of_cells();
    for root in (0..numbers.len() / 2).rev() {
        sift_down(numbers, root, &key);
    }
    for end in (1..numbers.len()).rev() {
        let (Some(first), Some(last)) = (numbers.first(), numbers.get(end)) else {
            return;
        };
        exchange(first, last);
        sift_down(numbers.get(..end).unwrap_or_default(), 0, &key);
    }
}

/// Not `Cell::swap`, which asks whether the two overlap and panics if they do.
fn exchange<T: Copy>(a: &Cell<T>, b: &Cell<T>) {
    let kept = a.replace(b.get());
    b.set(kept);
}

/// Moves the item at `root` down until none of its two children has a larger key.
fn sift_down<T: Copy, K: Ord>(heap: &[Cell<T>], root: usize, key: &impl Fn(T) -> K) {
    let Some(mut parent) = heap.get(root) else {
        return;
    };
    let moved = key(parent.get());
    let mut place = root;
    // The place at least doubles, so that the loop ends.
    while let Some(left) = heap.get(2 * place + 1) {
        let (mut child, mut larger) = (left, key(left.get()));
        place = 2 * place + 1;
        if let Some(right) = heap.get(place + 1) {
            let other = key(right.get());
            if other > larger {
                (child, larger) = (right, other);
                place += 1;
            }
        }
        if larger <= moved {
            return;
        }
        exchange(parent, child);
        parent = child;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    extern crate std;
    use std::vec::Vec;

    proptest! {
        /// The oracle is the standard library's stable sort.
        #[test]
        fn order_is_the_stable_one(depths in prop::collection::vec(0u64..20, 0..100)) {
            let mut got: Vec<u32> = (0..depths.len() as u32).collect();
            let mut expected = got.clone();
            expected.sort_by_key(|number| depths[*number as usize]);
            sort_by_key(&mut got, |number| (depths[number as usize], number));
            prop_assert_eq!(got, expected);
        }
    }

    #[test]
    fn comparisons_are_bounded() {
        for n in [0usize, 1, 2, 3, if cfg!(miri) { 40 } else { 1000 }] {
            for shape in 0..3 {
                let calls = Cell::new(0usize);
                let mut numbers: Vec<u32> = (0..n as u32).collect();
                sort_by_key(&mut numbers, |number| {
                    calls.set(calls.get() + 1);
                    [number, u32::MAX - number, 7][shape]
                });
                let log = usize::BITS - n.leading_zeros();
                assert!(
                    calls.get() <= 3 * n * log as usize + 3 * n,
                    "{n}: {}",
                    calls.get()
                );
            }
        }
    }
}
