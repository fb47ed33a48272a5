//! All integration tests of the simulator in one binary, which compiles and links once. `cargo test -p splatline-sim --test all hostile`
//! runs one module of them.

mod allocations;
mod command_line;
mod documents;
mod fast;
mod harmonics;
mod hostile;
mod kernels;
mod machine_commands;
mod rounded_camera;
mod stability;
mod surface;
mod texture;
mod vectors;
mod vectors_bench;
mod warp;
