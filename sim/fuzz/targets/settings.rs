//! Any bytes as a camera, transfer function, design, machine, prices or space: an answer and its use, never a panic.
#![no_main]

mod readers;

pub use readers::seeds;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| readers::read(bytes, &["camera", "transfer", "design", "machine", "prices", "space"]));
