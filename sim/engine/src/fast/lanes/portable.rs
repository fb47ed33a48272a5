//! Vectors as arrays.

/// Vectors as arrays: the definition of the operations, and what processors without an implementation of their own use.
/// In tests its operations are calls: inlined, they took half of the time in which the tests compile, and saved 2 of 16
/// seconds in which they run.
#[derive(Clone, Copy, Debug)]
pub struct Portable;
