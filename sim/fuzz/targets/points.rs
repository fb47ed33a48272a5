//! Any bytes as a point cloud, .ply and .xyz: a cloud or an error, never a panic.
#![no_main]

mod loader;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    loader::load_points(bytes, "ply");
    loader::load_points(bytes, "xyz");
});
