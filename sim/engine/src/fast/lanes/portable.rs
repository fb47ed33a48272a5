//! Vectors as arrays.

/// Vectors as arrays: the definition of the operations, and what processors without an implementation of their own use.
/// Tests need not have its operations inlined, which took half of the time in which they compile and saved 2 of 16
/// seconds in which they run.
#[derive(Clone, Copy, Debug)]
pub struct Portable;
