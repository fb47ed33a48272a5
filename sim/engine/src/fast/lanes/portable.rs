//! Vectors as arrays.

/// Vectors as arrays: the definition of the operations, and what processors without an implementation of their own use.
#[derive(Clone, Copy, Debug)]
pub struct Portable;
