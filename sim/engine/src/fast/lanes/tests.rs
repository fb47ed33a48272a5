//! Every operation of every implementation against the portable arrays, word for word.

use super::words::Falls;
use super::*;
use proptest::prelude::*;

/// Results of all operations on pixels' words, in a fixed order.
struct PixelOperations {
    a: [u64; 16],
    b: [i64; 8],
    at: usize,
    count: usize,
    falls: Falls,
}

impl VectorTask for &PixelOperations {
    type Output = Vec<[u64; 4]>;

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> Self::Output {
        let (a, b) = (lanes.read(&self.a, self.at), lanes.load(&self.b));
        let low = lanes.splat(u32::MAX.into());
        let truth = lanes.greater(a, b);
        let first = lanes.first(self.count);
        let words = [
            a,
            lanes.keep(a, lanes.marked(b)),
            lanes.clear(a, lanes.marked(b)),
            lanes.keep(a, first),
            lanes.keep(a, lanes.both(truth, first)),
            lanes.keep(a, lanes.except(truth, first)),
            lanes.min_short(lanes.and(a, low), lanes.and(b, low)),
            lanes.multiples(lanes.splat(self.b[0])),
            lanes.intervals(&self.falls, b),
        ];
        let mut results = Vec::new();
        for word in words {
            let mut stored = self.a;
            lanes.write(&mut stored, self.at, word);
            let start = self.at.min(stored.len() - 4);
            results.push(std::array::from_fn(|k| stored[start + k]));
        }
        results
    }
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
    fn run<L: Lanes>(self, lanes: L) -> [[i64; 4]; 18] {
        let (a, b) = (lanes.load(&self.a), lanes.load(&self.b));
        let [x, y, z, w] = lanes.columns(|k| self.rows[k]);
        let [low, high] = lanes.gather(&self.table, a);
        let [inside, next] = lanes.gather(&self.table, lanes.and(b, lanes.splat(63)));
        let mut rows = [[0; 4]; 8];
        lanes.rows(&mut rows, [a, b, low, x]);
        let turned = lanes.columns(|k| rows[k]);
        let words = [
            turned[0],
            turned[1],
            turned[2],
            turned[3],
            lanes.mul_whole(a, b),
            lanes.mul(a, b),
            lanes.mul_unsigned(a, b),
            lanes.sar_by(a, self.by),
            lanes.select(a, b, lanes.greater(a, b)),
            lanes.select(a, b, lanes.double_greater(a, b)),
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
            let stored = lanes.list(word);
            std::array::from_fn(|k| stored[k])
        })
    }
}

proptest! {
    #[test]
    fn operations_are_the_portable_ones(
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
    fn operations_on_pixels_are_the_portable_ones(
        a: [u64; 16], b: [i64; 8], alike: bool, at in 0usize..9, count in 0usize..9, falls in prop::collection::vec(0u32..1000, 1..40),
    ) {
        let mut entries = falls;
        entries.sort_unstable_by(|a, b| b.cmp(a));
        let falls = Falls::new(&entries).expect("they fall");
        let b = if alike { std::array::from_fn(|k| a[at + k] as i64) } else { b };
        let operations = PixelOperations { a, b, at, count, falls };
        let expected = (&operations).run(Portable);
        for choice in [VectorLevel::Avx2, VectorLevel::Best] {
            let found = dispatch_vectors(choice, &operations);
            prop_assert_eq!(found.as_ref().unwrap_or(&expected), &expected, "{:?}", choice);
        }
    }
}
