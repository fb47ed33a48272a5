//! Any bits into `checks::packet`, the body of the property test of the same name.
#![no_main]

#[path = "../../../tests/arbitrary/mod.rs"]
mod arbitrary;
#[path = "../../../tests/checks/mod.rs"]
mod checks;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| checks::packet(&mut arbitrary::Source::new(bytes)));
