//! Every operation of every implementation against the portable arrays, word for word.

use super::*;
use proptest::prelude::*;

/// Results of all operations on one set of operands, in a fixed order.
struct All {
    a: [u32; 16],
    b: [u32; 16],
    shift: u32,
    half: u64,
    count: usize,
    table: Vec<u32>,
}

impl Job for &All {
    type Output = Vec<Vec<u32>>;

    /// Sixteen words in steps of the vector's width.
    #[inline(always)]
    fn run<L: Floats>(self, lanes: L) -> Self::Output {
        let mut results = vec![Vec::new(); 26];
        for start in (0..16).step_by(L::WIDTH) {
            let (a, b) = (lanes.load(&self.a[start..]), lanes.load(&self.b[start..]));
            let mask = lanes.greater(a, b);
            let first = lanes.first(self.count.saturating_sub(start));
            let by = self.shift % 32;
            let drop = |narrow| Drop {
                shift: if narrow { by } else { self.shift },
                half: if narrow {
                    self.half & 0xffff
                } else {
                    self.half
                },
                narrow,
            };
            let truth = |mask| lanes.clear(lanes.splat(1), mask);
            let words = [
                lanes.splat(self.a[3]),
                lanes.add(lanes.iota(), lanes.splat(start as u32)),
                lanes.add(a, b),
                lanes.sub(a, b),
                lanes.mul(a, b),
                lanes.shl(a, by),
                lanes.shr(a, by),
                lanes.sar(a, by),
                lanes.and(a, b),
                lanes.or(a, b),
                lanes.max_signed(a, b),
                lanes.min_unsigned(a, b),
                lanes.product(a, b, drop(false)),
                lanes.product(lanes.shr(a, 17), lanes.shr(b, 17), drop(true)),
                lanes.signed_product(
                    a,
                    b,
                    Drop {
                        shift: by + 1,
                        ..drop(false)
                    },
                ),
                lanes.signed_product(lanes.sar(a, 17), lanes.sar(b, 17), drop(true)),
                lanes.gather(&self.table, lanes.shr(a, 28), mask),
                truth(mask),
                truth(first),
                truth(lanes.both(mask, first)),
                truth(lanes.except(mask, first)),
                truth(lanes.negative(a)),
                lanes.clear(a, mask),
                lanes.select(a, b, mask),
            ];
            for (result, value) in results.iter_mut().zip(words) {
                let mut stored = vec![0; L::WIDTH];
                lanes.store(&mut stored, value);
                result.extend(stored);
            }
            let count = lanes.count(lanes.count(lanes.no_count(), mask), first);
            results[24].push(lanes.total(count) as u32);
            results[25].push(lanes.is_none(mask).into());
        }
        let total = results[24].iter().sum();
        let none = results[25].iter().product();
        results[24] = vec![total];
        results[25] = vec![none];
        results
    }
}

proptest! {
    #[test]
    fn every_operation_is_the_portable_one(
        a: [u32; 16], b: [u32; 16], equal: bool, shift in 1u32..64, half: u64, count in 0usize..20, table in prop::collection::vec(any::<u32>(), 16..40),
    ) {
        let b = if equal { a } else { b };
        let all = All { a, b, shift, half: half >> 2, count, table };
        let expected = dispatch(Choice::Portable, &all);
        prop_assert_eq!(&dispatch(Choice::Eight, &all), &expected);
        prop_assert_eq!(&dispatch(Choice::Best, &all), &expected);
    }
}
