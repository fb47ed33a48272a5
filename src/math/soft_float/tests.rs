use super::*;
use proptest::prelude::*;

fn value(number: SoftFloat) -> f64 {
    number.mantissa as f64 * (number.exponent as f64).exp2()
}

proptest! {
    #[test]
    fn normalising_rounds_to_the_mantissa(wide: i64, exponent in -100i32..100, bits in 8u32..=31) {
        let number = SoftFloat::from_wide(wide, exponent, bits);
        let exact = wide as f64 * (exponent as f64).exp2();
        prop_assert!((value(number) - exact).abs() <= exact.abs() * (-(bits as f64)).exp2() * 1.0001);
        if wide != 0 {
            let length = 32 - number.mantissa.unsigned_abs().leading_zeros();
            prop_assert_eq!(length, bits);
        }
    }

    #[test]
    fn sums_are_rounded_once(parts: [(i32, i32, i8); 4], bits in 8u32..=31) {
        let terms = parts.map(|(a, b, e)| {
            let [a, b] = [a, b].map(|mantissa| SoftFloat { mantissa: mantissa >> 1, exponent: e as i32 / 16 });
            a.times(b)
        });
        let number = |t: &Product| t.value as f64 * (t.exponent as f64).exp2();
        let exact: f64 = terms.iter().map(number).sum();
        let largest = terms.iter().map(number).fold(0.0, |most: f64, term| most.max(term.abs()));
        let error = (value(sum_of_products(terms, bits)) - exact).abs();
        // Of four terms each loses less than a unit, and the largest has its leading bit at the window's first or
        // second bit.
        let cuts = 4.0 * 4.0 * largest * (-f64::from(bits + GUARD)).exp2();
        prop_assert!(error <= (exact.abs() + cuts) * (-f64::from(bits)).exp2() * 1.0001 + cuts, "{error} {exact}");
    }

    #[test]
    fn normalising_by_words_is_normalising(wide: i64, drop in 0u32..64, tail in 0u32..4, bits in 1u32..=31) {
        // Half of the values are short, some end in a half or next to it.
        let wide = wide >> drop;
        let wide = [wide, wide & -1 << 32, (wide & -1 << 33) | 1 << 32, (wide & -1 << 33) | 1][tail as usize];
        prop_assert_eq!(SoftFloat::from_wide(wide, 3, bits), normalised(wide, bits));
        if let Ok(word) = i32::try_from(wide) {
            prop_assert_eq!(SoftFloat::from_word(word, 3, bits), normalised(wide, bits));
        }
    }

    #[test]
    fn fixed_point_by_words_is_a_shift(mantissa: i32, exponent in -100i32..80, fraction in 0u32..64) {
        let expected = shift_signed(mantissa.into(), -exponent - fraction as i32);
        prop_assert_eq!(SoftFloat { mantissa, exponent }.to_fixed(fraction), expected);
    }

    /// The oracle cuts and adds in 128 bits.
    #[test]
    fn terms_are_cut_to_the_window(parts: [(i64, i8, u8); 4], last in prop_oneof![Just(0), Just(i32::MAX - 200)], bits in 8u32..=31) {
        let terms = parts.map(|(value, e, drop)| Product::new(value >> (2 + drop % 62), last + e as i32));
        let top = |t: &Product| t.exponent.saturating_add(t.length as i32);
        let Some(top) = terms.iter().filter(|t| t.value != 0).map(top).max() else { return Ok(()) };
        let unit = top.saturating_sub(bits as i32 + GUARD as i32);
        let aligned = terms.iter().map(|t| match unit.saturating_sub(t.exponent) {
            shift @ ..0 => i128::from(t.value) << shift.unsigned_abs().min(63),
            shift => i128::from(t.value) >> shift.min(127),
        });
        let sum: i128 = aligned.sum();
        prop_assert_eq!(sum_of_products(terms, bits), SoftFloat::from_wide(sum as i64, unit, bits));
        prop_assert_eq!(sum_below(terms, top, bits), SoftFloat::from_wide(sum as i64, unit, bits));
    }

    /// What they give has no meaning, but a panic would be one in a build with overflow checks.
    #[test]
    fn widths_that_are_none_do_not_panic(wide: i64, exponent: i32, mantissa: i32, length: u32, top: i32,
        bits in prop_oneof![any::<u32>(), 0u32..64, u32::MAX - 20..=u32::MAX, (1u32 << 31) - 20..(1 << 31) + 20]) {
        let (number, term) = (SoftFloat { mantissa, exponent }, Product { value: wide, exponent: top, length });
        let _ = (number.multiply_within(number, bits), number.multiply(number, bits), term.normalise(bits));
        let _ = (sum_of_products([term], bits), sum_of_products([term, number.times(number)], bits));
        let _ = (sum_of_products([term; 3], bits), sum_below([term; 2], top, bits));
        let _ = (crate::math::square_root(number, bits), crate::math::reciprocal(number, bits));
    }

    #[test]
    fn every_bit_pattern_is_defined(mantissa: i32, exponent: i32, wide: i64, fraction in 0u32..64, bits in 1u32..=31) {
        let number = SoftFloat { mantissa, exponent };
        let _ = (number.to_fixed(fraction), number.leading(), number.multiply(number, bits));
        let _ = SoftFloat::from_wide(wide, exponent, bits);
        let product = Product { value: wide, exponent, length: fraction };
        let _ = (product.to_fixed(fraction), sum_of_products([product; 4], bits), sum_below([product; 4], mantissa, bits));
    }
}

/// Times 8, rounded in 128 bits.
fn normalised(wide: i64, bits: u32) -> SoftFloat {
    if wide == 0 {
        return SoftFloat::ZERO;
    }
    let shift = 64 - wide.unsigned_abs().leading_zeros() as i32 - bits as i32;
    let rounded = if shift > 0 {
        (i128::from(wide) + (1 << (shift - 1))) >> shift
    } else {
        i128::from(wide) << -shift
    };
    let carried = rounded.unsigned_abs() >> bits != 0;
    let mantissa = if carried { rounded / 2 } else { rounded };
    SoftFloat {
        mantissa: mantissa as i32,
        exponent: 3 + shift + i32::from(carried),
    }
}

/// Numbers of ones alone carry through all of them.
#[test]
fn ones_become_the_next_power_of_two() {
    for (bits, length) in (1..=31).flat_map(|bits| (1..=63).map(move |length| (bits, length))) {
        let ones = i64::MAX >> (63 - length);
        for value in [ones, -ones, ones - 1, -ones - 1] {
            let found = SoftFloat::from_wide(value, 3, bits);
            assert_eq!(found, normalised(value, bits), "{value} {bits}");
            if let Ok(word) = i32::try_from(value) {
                assert_eq!(SoftFloat::from_word(word, 3, bits), found, "{word} {bits}");
            }
        }
    }
}

#[test]
fn short_numbers_by_words_are_rounded_alike() {
    for bits in [1, 4, 8, 12, 16] {
        for value in -40_000..40_000 {
            let wide = SoftFloat::from_wide(value.into(), 3, bits);
            assert_eq!(SoftFloat::from_word(value, 3, bits), wide, "{value} {bits}");
        }
    }
}

/// Terms of 0 say nothing of the window, wherever they are; small ones do. The oracle is the sum in two words.
#[test]
fn terms_of_zero_have_no_say() {
    let places = [0, 3, 40].into_iter().flat_map(|exponent| {
        [0, 1, 2, -1, 1 << 29].map(|value| Product {
            value,
            exponent,
            length: 30,
        })
    });
    for a in places.clone() {
        for b in places.clone() {
            let wide = [a, b].map(|term| term.cut(15 + GUARD));
            assert_eq!(sum_of_products([a, b], 15), sum(&wide, 15), "{a:?} {b:?}");
        }
    }
    assert_eq!(
        Product::new(3 << 30, 0).normalise(2),
        SoftFloat {
            mantissa: 3,
            exponent: 30
        }
    );
}

/// Four of the largest terms, alone and with mantissas of half a word.
#[test]
fn the_largest_sums_fit() {
    for bits in 8..=31 {
        let most = SoftFloat {
            mantissa: i32::MAX >> (31 - bits),
            exponent: 0,
        };
        let term = most.times_within(most, 2 * bits);
        assert_eq!(
            term.value,
            i64::from(most.mantissa) * i64::from(most.mantissa)
        );
        let drop = (2 * bits).saturating_sub(bits + GUARD);
        let sum = 4 * (term.value >> drop);
        let unit = 2 * bits as i32 - (bits + GUARD) as i32;
        let sum = if unit < 0 { sum << -unit } else { sum };
        assert_eq!(
            sum_of_products([term; 4], bits),
            SoftFloat::from_wide(sum, unit, bits),
            "{bits}"
        );
    }
    for bits in 8..=31 {
        // A single bit at the window's end.
        let least = Product {
            value: 1,
            exponent: 0,
            length: bits + GUARD,
        };
        assert_eq!(
            sum_of_products([least], bits),
            SoftFloat::from_wide(1, 0, bits)
        );
    }
    let far = Product {
        value: 1 << 62,
        exponent: 0,
        length: 63,
    };
    assert_eq!(sum_below([far], 200, 8), SoftFloat::ZERO);
}

#[test]
fn fixed_point_saturates() {
    let number = SoftFloat {
        mantissa: 3,
        exponent: 80,
    };
    assert_eq!(number.to_fixed(16), i64::MAX);
    assert_eq!(
        SoftFloat {
            mantissa: -3,
            exponent: 80
        }
        .to_fixed(16),
        i64::MIN
    );
    assert_eq!(
        SoftFloat {
            mantissa: 3,
            exponent: -1
        }
        .to_fixed(0),
        2
    );
    assert_eq!(SoftFloat::ZERO.to_fixed(40), 0);
}
