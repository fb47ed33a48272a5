//! Any bytes as a table of footprints, a sweep (identity and table) or a manifest of vectors: an answer, never a panic.
#![no_main]

mod readers;

pub use readers::seeds;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| readers::read(
    bytes,
    &["footprints", "sweep", "manifest"]
));
