//! Any bits into `checks::setup`, the body of the property test of the same name.
#![no_main]

#[path = "../../../tests/all/arbitrary/mod.rs"]
mod arbitrary;
#[path = "../../../tests/all/checks/mod.rs"]
mod checks;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| checks::setup(&mut arbitrary::Source::new(bytes)));
