//! Random numbers of the benches and their loads.

use splatline_sim::scene::synthetic::Random;

/// SplitMix64.
pub fn split_mix(state: &mut u64) -> u64 {
    let mut random = Random(*state);
    let bits = random.next();
    *state = random.0;
    bits
}

/// A word of nothing.
pub fn noise(state: &mut u64) -> [u32; 4] {
    [(); 4].map(|()| split_mix(state) as u32)
}
