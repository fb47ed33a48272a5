//! Any bytes as a height field, .csv: a grid or an error, never a panic.
#![no_main]

mod loader;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| loader::load_height_field(bytes));
