//! No code: one set of features for the tests of all members.
//!
//! Cargo compiles a library once for each set of features that it is asked for, and everything above it with it. What
//! `cargo test -p` of a member asks for comes from that member alone: the circuits' bench has no proptest, so that
//! `getrandom` got fewer features there, and the kernel, the reference, the engine and the simulator were compiled a
//! second time for it, and a third time for the documentation's program. Both and the simulator (for its tests only)
//! depend on this crate, which asks for all of these features.
