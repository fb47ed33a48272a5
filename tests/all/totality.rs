//! Totality: the kernel on arbitrary bit patterns of every public input.
//!
//! Built with overflow checks, so that an overflow is a panic and a panic is a failure. Beyond that each property
//! states what must hold of any result: nothing is written outside the window of the lent memory, and the work is
//! bounded by the window's size. The same bodies run under cargo-fuzz (`sim/fuzz`).

use crate::arbitrary::Source;
use proptest::prelude::*;

/// More bytes than any input needs, and shorter strings that end in zeros.
fn bytes() -> impl Strategy<Value = Vec<u8>> {
    proptest::collection::vec(any::<u8>(), 0..1500)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(20_000) })]

    #[test]
    fn arithmetic(bytes in bytes()) {
        crate::checks::arithmetic(&mut Source::new(&bytes));
    }

    #[test]
    fn setup_and_its_units(bytes in bytes()) {
        crate::checks::setup(&mut Source::new(&bytes));
    }

    #[test]
    fn packets(bytes in bytes()) {
        crate::checks::packet(&mut Source::new(&bytes));
    }

    #[test]
    fn tables(bytes in bytes()) {
        crate::checks::table(&mut Source::new(&bytes));
    }

    #[test]
    fn compositing_of_one_pixel(bytes in bytes()) {
        crate::checks::blend(&mut Source::new(&bytes));
    }

    #[test]
    fn drawing(bytes in bytes()) {
        crate::checks::draw(&mut Source::new(&bytes));
    }

    #[test]
    fn splats_to_pixels(bytes in bytes()) {
        crate::checks::splat_to_pixels(&mut Source::new(&bytes));
    }

    #[test]
    fn targets(bytes in bytes()) {
        crate::checks::target(&mut Source::new(&bytes));
    }
}

/// The properties above are worth something only if their inputs get past the culling.
#[test]
fn inputs_reach_the_pixels() {
    let mut state = 1u64;
    let mut drawn = 0;
    for _ in 0..2000 {
        let mut bytes = [0u8; 1500];
        bytes.fill_with(|| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 56) as u8
        });
        drawn += u32::from(crate::checks::splat_to_pixels(&mut Source::new(&bytes)) > 0);
    }
    assert!(drawn >= 200, "only {drawn} of 2000 inputs cover a pixel");
}
