//! Depth order of a display list: numbers of splats by ascending depth, those of equal depth as they came.
//!
//! Numbers are moved, not footprints, and a list of some dozens needs no better sort than insertion.

use crate::scene::SPLATS;
use heapless::Vec;

/// Depths and numbers of the splats inserted so far. A number of full width costs no byte more than a short one: depths
/// are aligned.
#[derive(Clone, Debug)]
pub struct Order<K> {
    entries: Vec<(K, usize), SPLATS>,
}

/// As many splats as the list has room for are in it already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Full;

impl<K: Copy + PartialOrd> Order<K> {
    /// An empty list.
    pub const EMPTY: Self = Order {
        entries: Vec::new(),
    };

    /// Forgets all splats.
    pub fn clear(&mut self) {
        self.entries.clear();
    }

    /// Inserts a splat's number after all that are not farther. A full list has lost its farthest one then, and is of
    /// no use.
    pub fn insert(&mut self, number: usize, depth: K) -> Result<(), Full> {
        let mut carried = (depth, number);
        let mut shifting = false;
        for entry in &mut self.entries {
            shifting = shifting || entry.0 > depth;
            if shifting {
                core::mem::swap(entry, &mut carried);
            }
        }
        self.entries.push(carried).map_err(|_| Full)
    }

    /// The numbers, nearest first.
    pub fn iter(&self) -> impl Iterator<Item = usize> {
        self.entries.iter().map(|(_, number)| *number)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_first_and_equal_ones_as_they_came() {
        let mut order = Order::EMPTY;
        for (number, depth) in [3, 1, 3, 2, 1].into_iter().enumerate() {
            assert_eq!(order.insert(number, depth), Ok(()));
        }
        assert!(order.iter().eq([1, 4, 3, 0, 2]));
    }

    #[test]
    fn what_has_no_place_is_an_error() {
        let mut order = Order::EMPTY;
        for number in 0..SPLATS {
            assert_eq!(order.insert(1000 + number, 0), Ok(()));
        }
        assert!(order.iter().eq(1000..1000 + SPLATS));
        assert_eq!(order.insert(0, 0), Err(Full));
    }
}
