//! All scenes that are hard: those of the kinds that people have, and one of all the hard shapes of splats at once.

pub use super::kinds::{Class, Size};
use super::{kinds, splats};

/// Every class; another `seed` makes other scenes of the same kinds.
pub fn all(size: Size, seed: u64) -> Vec<Class> {
    let mut classes = kinds::scenes(size, seed);
    classes.push(splats::mixed(size, seed));
    classes
}
