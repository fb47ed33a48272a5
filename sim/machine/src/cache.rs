//! A raster unit's packet cache: four ways, the least recently used packet leaves.
//!
//! A splat over several tiles is fetched once for each of them. Neighbouring tiles share most of their splats, so that
//! a cache in front of the read channel saves the packet, though not the list's entry, if it holds the splats of a tile
//! until the next one comes: how many that is depends on the order of the tiles.

/// Ways of a set.
const WAYS: usize = 4;

/// Which splats' packets are held.
#[derive(Clone, Debug)]
pub(super) struct PacketCache {
    /// The splats of all sets, each set's last used one first.
    splats: Vec<Option<u32>>,
    /// Look-ups that found their packet.
    pub hits: u64,
}

impl PacketCache {
    /// A cache of so many packets, a power of two from 4 on; none holds nothing.
    pub fn new(packets: u32) -> PacketCache {
        PacketCache {
            splats: vec![None; packets as usize],
            hits: 0,
        }
    }

    /// Is the packet there? It is afterwards.
    #[inline(always)]
    pub fn look_up(&mut self, splat: u32) -> bool {
        if self.splats.is_empty() {
            return false;
        }
        let sets = self.splats.len() / WAYS;
        let first = (splat as usize & (sets - 1)) * WAYS;
        let set = &mut self.splats[first..first + WAYS];
        let place = set.iter().position(|held| *held == Some(splat));
        set[..=place.unwrap_or(WAYS - 1)].rotate_right(1);
        set[0] = Some(splat);
        self.hits += u64::from(place.is_some());
        place.is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::HashMap;

    proptest! {
        /// Beside a list of times: a packet is held if fewer than four others of its set came since.
        #[test]
        fn the_least_recently_used_packet_leaves(log2 in 2u32..6, splats in proptest::collection::vec(0u32..80, 1..300)) {
            let packets = 1 << log2;
            let mut cache = PacketCache::new(packets);
            let mut last: HashMap<u32, usize> = HashMap::new();
            for (now, splat) in splats.iter().enumerate() {
                let sets = packets / 4;
                let expected = last.get(splat).is_some_and(|then| {
                    let later = last.iter().filter(|(other, at)| **other % sets == splat % sets && *at > then);
                    later.count() < 4
                });
                prop_assert_eq!(cache.look_up(*splat), expected);
                last.insert(*splat, now);
            }
        }
    }
}
