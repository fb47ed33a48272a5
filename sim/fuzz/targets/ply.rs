//! Any bytes as a .ply file: a scene or an error, never a panic.
#![no_main]

mod loader;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| loader::load(bytes, "ply"));
