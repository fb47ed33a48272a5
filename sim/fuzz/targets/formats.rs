//! Any bytes as each of the formats that other tools write, features included: a scene, a cloud or an error, never a
//! panic.
#![no_main]

mod loader;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    for extension in ["nii", "mha", "vti", "sog", "ksplat", "glb"] {
        loader::load(bytes, extension);
    }
    for extension in ["obj", "las"] {
        loader::load_points(bytes, extension);
    }
});
