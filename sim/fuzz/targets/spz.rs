//! Any bytes as a .spz file, as they are and as the content of a sound gzip stream: a scene or an error, never a panic.
#![no_main]

mod loader;

use std::io::Write;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    loader::load(bytes, "spz");
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packed.write_all(bytes).expect("memory does not fail");
    loader::load(&packed.finish().expect("memory does not fail"), "spz");
});
