//! Every operation of every implementation against the portable arrays, word for word.

use super::factors::Factors;
use super::fused::{Fused, Pairs};
use super::*;
use proptest::prelude::*;
use splatline::format::Deep32;

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
            lanes.wide_splat(self.a[0] as i64),
            lanes.wide_add(a, b),
            lanes.wide_sub(a, b),
            lanes.wide_and(a, b),
            lanes.wide_or(a, b),
            lanes.wide_xor(a, b),
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
            lanes.wide_sar_by(a, 63),
            lanes.wide_sar_by(lanes.marks(self.a[0]), 63),
            lanes.gather_pairs(&self.pairs, b),
            lanes.factored(&self.factors, b)[0],
            lanes.factored(&self.factors, b)[1],
        ];
        let mut packed = [0; 8];
        lanes.pack(&mut packed, a, truth);
        packed[self.bits.count_ones() as usize..].fill(0);
        let bits = [lanes.wide_flags(truth), lanes.marked(a).into()].map(u64::from);
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

/// Operations on 64-bit words that AVX2 is missing in part.
struct WideOperations {
    a: [i64; 8],
    b: [i64; 8],
    by: u32,
    rows: [[i32; 4]; 8],
    table: Vec<u32>,
}

impl VectorTask for &WideOperations {
    type Output = [[i64; 4]; 18];

    #[inline(always)]
    fn run<L: Doubles>(self, lanes: L) -> [[i64; 4]; 18] {
        let (a, b) = (lanes.wide_load(&self.a), lanes.wide_load(&self.b));
        let [x, y, z, w] = lanes.wide_columns(|k| self.rows[k]);
        let [low, high] = lanes.wide_gather(&self.table, a);
        let [inside, next] =
            lanes.wide_gather(&self.table, lanes.wide_and(b, lanes.wide_splat(63)));
        let mut rows = [[0; 4]; 8];
        lanes.wide_rows(&mut rows, [a, b, low, x]);
        let turned = lanes.wide_columns(|k| rows[k]);
        let words = [
            turned[0],
            turned[1],
            turned[2],
            turned[3],
            lanes.wide_mul_whole(a, b),
            lanes.wide_mul(a, b),
            lanes.wide_mul_unsigned(a, b),
            lanes.wide_sar_by(a, self.by),
            lanes.wide_select(a, b, lanes.wide_greater(a, b)),
            lanes.wide_select(a, b, lanes.double_greater(a, b)),
            x,
            y,
            z,
            w,
            low,
            high,
            inside,
            next,
        ];
        words.map(|word| {
            let mut stored = [0; 8];
            lanes.wide_store(&mut stored, word);
            std::array::from_fn(|k| stored[k])
        })
    }
}

proptest! {
    #[test]
    fn wide_operations_are_the_portable_ones(
        a: [i64; 8], b: [i64; 8], by in 0u32..64, rows: [[i32; 4]; 8], table in prop::collection::vec(any::<u32>(), 0..60),
    ) {
        let operations = WideOperations { a, b, by, rows, table };
        let expected = operations.run(Portable);
        for choice in [VectorLevel::Avx2, VectorLevel::Best] {
            let found = dispatch_vectors(choice, &operations).unwrap_or(expected);
            prop_assert_eq!(found, expected);
        }
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
}
