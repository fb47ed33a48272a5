//! Every operation of every implementation against the portable arrays, word for word.

use super::factors::Factors;
use super::fused::{Fused, FusedLanes, FusedTask, Pairs};
use super::*;
use proptest::prelude::*;
use splatline::format::Deep32;

/// Results of all operations on one set of operands, in a fixed order.
struct All {
    a: [u32; 16],
    b: [u32; 16],
    shift: u32,
    half: u64,
    count: usize,
    table: Vec<u32>,
}

impl VectorTask for &All {
    type Output = Vec<Vec<u32>>;

    /// Sixteen words in steps of the vector's width.
    #[inline(always)]
    fn run<L: Floats>(self, lanes: L) -> Self::Output {
        let mut results = vec![Vec::new(); 28];
        for start in (0..16).step_by(L::WIDTH) {
            let (a, b) = (lanes.load(&self.a[start..]), lanes.load(&self.b[start..]));
            let mask = lanes.greater(a, b);
            let first = lanes.first(self.count.saturating_sub(start));
            let by = self.shift % 32;
            let drop = |narrow| ProductShift {
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
                lanes.product_from(
                    lanes.shr(a, 1),
                    lanes.shr(b, 1),
                    drop(false),
                    u64::from(self.a[0] >> 1) * u64::from(self.b[0] >> 1),
                ),
                lanes.product_from(
                    lanes.shr(a, 17),
                    lanes.shr(b, 17),
                    drop(true),
                    u64::from(self.a[0] >> 17) * u64::from(self.b[0] >> 17),
                ),
                lanes.signed_product(
                    a,
                    b,
                    ProductShift {
                        shift: by + 1,
                        ..drop(false)
                    },
                ),
                lanes.signed_product(lanes.sar(a, 17), lanes.sar(b, 17), drop(true)),
                lanes.gather(&self.table, lanes.shr(a, by), mask),
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
            results[26].push(lanes.total(count) as u32);
            results[27].push(lanes.is_none(mask).into());
        }
        let total = results[26].iter().sum();
        let none = results[27].iter().product();
        results[26] = vec![total];
        results[27] = vec![none];
        results
    }
}

/// Entries of a table where an index is greater than another word.
struct Gathered {
    index: [u32; 16],
    other: [u32; 16],
    table: Vec<u32>,
}

impl VectorTask for &Gathered {
    type Output = Vec<u32>;

    #[inline(always)]
    fn run<L: Floats>(self, lanes: L) -> Vec<u32> {
        let mut gathered = vec![0; 16];
        for start in (0..16).step_by(L::WIDTH) {
            let index = lanes.load(&self.index[start..]);
            let mask = lanes.greater(index, lanes.load(&self.other[start..]));
            let entries = lanes.gather(&self.table, index, mask);
            lanes.store(&mut gathered[start..], entries);
        }
        gathered
    }
}

/// Results of all operations on 64-bit words and fused products, in a fixed order.
struct AllFused {
    a: [u64; 8],
    b: [u64; 8],
    c: [u64; 8],
    bits: u8,
    pairs: Pairs,
    factors: Factors,
    table: Vec<u32>,
}

impl FusedTask for &AllFused {
    type Output = Vec<[u64; 8]>;

    #[inline(always)]
    fn run<L: Fused>(self, lanes: L) -> Self::Output {
        let [a, b, c] = [&self.a, &self.b, &self.c].map(|words| lanes.read(words));
        let truth = lanes.truth(self.bits);
        let by = lanes.wide_and(c, lanes.wide_splat(63));
        let [low, high] = lanes.wide_gather(&self.table, lanes.wide_and(a, lanes.wide_splat(63)));
        let words = [
            lanes.wide_iota(),
            lanes.wide_splat(self.a[0] as i64),
            lanes.wide_add(a, b),
            lanes.wide_sub(a, b),
            lanes.wide_and(a, b),
            lanes.wide_mul(a, b),
            lanes.wide_mul_unsigned(a, b),
            lanes.wide_shl(a, c),
            lanes.wide_shr(a, c),
            lanes.wide_sar(a, c),
            lanes.wide_shl(a, by),
            lanes.wide_shr(a, by),
            lanes.wide_sar(a, by),
            lanes.wide_leading_zeros(lanes.wide_shr(a, lanes.wide_splat(1))),
            low,
            high,
            lanes.wide_select(a, b, lanes.wide_greater(a, b)),
            lanes.wide_select(a, b, lanes.wide_equal(a, b)),
            lanes.wide_select(a, b, truth),
            lanes.fused(a, b, c),
            lanes.wide_mul_whole(a, b),
            lanes.half_from_zero(a),
            lanes.max_whole(a, b),
            lanes.min_whole(a, b),
            lanes.turn(a, by),
            lanes.merge(a, b, c),
            lanes.all_three(a, b, c),
            lanes.without(a, b, c),
            lanes.blend(a, b, c),
            lanes.spread(a),
            lanes.spread(lanes.marks(self.a[0])),
            lanes.gather_pairs(&self.pairs, b),
            lanes.factored(&self.factors, b)[0],
            lanes.factored(&self.factors, b)[1],
        ];
        let mut packed = [0; 8];
        lanes.pack(&mut packed, a, truth);
        packed[self.bits.count_ones() as usize..].fill(0);
        let bits = [lanes.bits(truth), lanes.marked(a)].map(u64::from);
        let mut results = vec![packed, [bits[0], bits[1], lanes.sum(a), 0, 0, 0, 0, 0]];
        for word in words {
            let mut stored = [0; 8];
            lanes.write(&mut stored, word);
            results.push(stored);
        }
        results
    }
}

/// The factors of the largest table.
fn gaussian() -> Factors {
    let mut entries = vec![0; splatline::kernel::entries(&Deep32::WIDTHS)];
    splatline::kernel::fill_gaussian(&mut entries, &Deep32::WIDTHS, 4);
    Factors::gaussian(&entries, &Deep32::WIDTHS, 4).expect("its products are exact")
}

/// Whole products of 64-bit words.
struct WholeProducts {
    a: [i64; 8],
    b: [i64; 8],
}

impl VectorTask for &WholeProducts {
    type Output = [i64; 4];

    #[inline(always)]
    fn run<L: Floats>(self, lanes: L) -> [i64; 4] {
        let product = lanes.wide_mul_whole(lanes.wide_load(&self.a), lanes.wide_load(&self.b));
        let mut stored = [0; 8];
        lanes.wide_store(&mut stored, product);
        std::array::from_fn(|k| stored[k])
    }
}

proptest! {
    #[test]
    fn whole_products_are_the_portable_ones(a: [i64; 8], b: [i64; 8]) {
        let products = WholeProducts { a, b };
        let expected = dispatch(VectorLevel::Portable, &products);
        prop_assert_eq!(dispatch(VectorLevel::Avx2, &products), expected);
        prop_assert_eq!(dispatch(VectorLevel::Best, &products), expected);
    }

    #[test]
    #[cfg_attr(
        not(has_avx512),
        ignore = "this processor has no AVX-512: the portable model would be compared with itself"
    )]
    fn every_fused_operation_is_the_portable_one(
        a: [u64; 8], b: [u64; 8], c: [u64; 8], bits: u8, less in 0u32..64, alike: bool, pairs in prop::collection::vec(any::<u64>(), 0..40),
        table in prop::collection::vec(any::<u32>(), 0..60),
    ) {
        let small = |words: [u64; 8]| words.map(|word| word >> less);
        let b = if alike { a } else { small(b) };
        let all = AllFused { a, b, c: small(c), bits, pairs: Pairs::new(pairs), factors: gaussian(), table };
        let expected = FusedLanes::Portable.run(&all);
        for lanes in FusedLanes::all() {
            prop_assert_eq!(&lanes.run(&all), &expected, "{:?}", lanes);
        }
    }

    /// Within the table, beyond it, in an empty one and where the mask does not hold, against the contract itself.
    #[test]
    fn gathers_keep_their_contract(index: [u32; 16], shift in 0u32..32, other: [u32; 16], table in prop::collection::vec(any::<u32>(), 0..40)) {
        let index = index.map(|index| index >> shift);
        let expected: Vec<u32> = (0..16)
            .map(|k| match (table.last(), (index[k] as i32) > other[k] as i32) {
                (Some(last), true) => *table.get(index[k] as usize).unwrap_or(last),
                _ => 0,
            })
            .collect();
        let gathered = Gathered { index, other, table: table.clone() };
        for choice in [VectorLevel::Portable, VectorLevel::Avx2, VectorLevel::Best] {
            prop_assert_eq!(dispatch(choice, &gathered), &expected[..]);
        }
    }

    #[test]
    fn every_operation_is_the_portable_one(
        a: [u32; 16], b: [u32; 16], equal: bool, shift in 1u32..64, half: u64, count in 0usize..20, table in prop::collection::vec(any::<u32>(), 0..40),
    ) {
        let b = if equal { a } else { b };
        let all = All { a, b, shift, half: half >> 2, count, table };
        let expected = dispatch(VectorLevel::Portable, &all);
        prop_assert_eq!(&dispatch(VectorLevel::Avx2, &all), &expected);
        prop_assert_eq!(&dispatch(VectorLevel::Best, &all), &expected);
    }
}
