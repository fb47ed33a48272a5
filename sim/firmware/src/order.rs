//! Depth order of a display list: numbers of splats by ascending depth, those of equal depth as they came.
//!
//! Numbers are moved, not footprints, and a list of some dozens needs no better sort than insertion.

use crate::scene::SPLATS;

/// A number has a byte.
const _: () = assert!(SPLATS <= 256);

/// Depths and numbers of the splats inserted so far.
#[derive(Clone, Copy, Debug)]
pub struct Order<K> {
    entries: [(K, u8); SPLATS],
    used: usize,
}

impl<K: Copy + PartialOrd> Order<K> {
    /// An empty list; `depth` may be any.
    pub const fn new(depth: K) -> Self {
        Order {
            entries: [(depth, 0); SPLATS],
            used: 0,
        }
    }

    /// Forgets all splats.
    pub fn clear(&mut self) {
        self.used = 0;
    }

    /// Inserts a splat's number after all that are not farther. A full list takes no more.
    pub fn insert(&mut self, number: usize, depth: K) {
        let mut carried = (depth, number as u8);
        let mut shifting = false;
        for entry in self.entries.iter_mut().take(self.used) {
            shifting = shifting || entry.0 > depth;
            if shifting {
                core::mem::swap(entry, &mut carried);
            }
        }
        if let Some(entry) = self.entries.get_mut(self.used) {
            *entry = carried;
            self.used += 1;
        }
    }

    /// The numbers, nearest first.
    pub fn iter(&self) -> impl Iterator<Item = usize> {
        let used = self.entries.iter().take(self.used);
        used.map(|(_, number)| usize::from(*number))
    }
}
