//! All integration tests of the engine in one binary. `cargo test -p splatline-engine --test all surface` runs one
//! module of them.

mod allocations;
mod harmonics;
mod kernels;
mod rounded_camera;
mod sheets;
mod surface;
mod warp;
