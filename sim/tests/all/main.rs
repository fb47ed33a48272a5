//! All integration tests of the simulator in one binary, which compiles and links once.
//! `cargo test -p splatline-sim --test all hostile` runs one module of them.

mod command_line;
mod commands;
mod documents;
mod fast;
mod golden;
mod hostile;
mod machine_commands;
mod outputs;
mod photos;
mod refusals;
mod shell;
mod stability;
mod texture;
mod vectors;
mod vectors_bench;
