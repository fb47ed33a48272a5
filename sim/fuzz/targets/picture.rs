//! Any bytes as a scene, point cloud or height field, the whole way: loaded, framed and drawn at 16 x 16 by both
//! engines.
#![no_main]

mod readers;

pub use readers::seeds;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| readers::read(
    bytes,
    &[
        ".ply", ".splat", ".spz", ".nrrd", ".nhdr", ".nii", ".mha", ".vti", ".sog", ".ksplat",
        ".glb", ".xyz", ".obj", ".las", ".laz", "grid"
    ]
));
