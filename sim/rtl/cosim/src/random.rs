//! Random numbers of the benches and their loads.

pub use splatline_sim::scene::synthetic::Random;

/// A word of nothing.
pub fn noise(random: &mut Random) -> [u32; 4] {
    [(); 4].map(|()| random.next() as u32)
}
