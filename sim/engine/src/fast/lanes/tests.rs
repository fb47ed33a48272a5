//! Operations of every implementation against the portable arrays, word for word.

use super::words::Entries;
use super::*;
use proptest::prelude::*;

/// Operands of the operations on words.
struct Operations {
    a: [i64; 16],
    b: [i64; 8],
    at: usize,
    count: usize,
    by: u32,
    rows: [[i32; 4]; 8],
    table: Vec<u32>,
}

impl VectorTask for &Operations {
    /// The first four words of all results, in a fixed order, written among pixels and listed.
    type Output = Vec<[i64; 4]>;

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> Self::Output {
        let (a, b) = (lanes.read(&self.a, self.at), lanes.load(&self.b));
        let low = lanes.splat(u32::MAX.into());
        let truth = lanes.greater(a, b);
        let first = lanes.first(self.count);
        let [x, y, z, w] = lanes.columns(|k| self.rows[k]);
        let [entry, next] = lanes.gather(&self.table, a);
        let [inside, beside] = lanes.gather(&self.table, lanes.masked(b, 63));
        let rows = lanes.rows([a, b, entry, x]);
        let turned = lanes.columns(|k| rows[k]);
        let words = [
            a,
            lanes.keep(a, lanes.marked(b)),
            lanes.clear(a, lanes.marked(b)),
            lanes.keep(a, first),
            lanes.keep(a, lanes.both(truth, first)),
            lanes.keep(a, lanes.except(truth, first)),
            lanes.min_short(lanes.and(a, low), lanes.and(b, low)),
            lanes.multiples(lanes.splat(self.b[0])),
            lanes.pairs(Entries::new(&self.table), b),
            lanes.halves(a, b),
            lanes.add_halves(a, b),
            lanes.unmarked(a),
            lanes.raised(a),
            turned[0],
            turned[1],
            turned[2],
            turned[3],
            lanes.mul_whole(a, b),
            lanes.mul(a, b),
            lanes.mul_unsigned(a, b),
            lanes.sar_by(a, self.by),
            lanes.select(a, b, truth),
            lanes.select(a, b, lanes.double_greater(a, b)),
            x,
            y,
            z,
            w,
            entry,
            next,
            inside,
            beside,
        ];
        let mut results = Vec::new();
        for word in words {
            let mut stored = self.a;
            lanes.write(&mut stored, self.at, word);
            let start = self.at.min(stored.len() - 4);
            results.push(std::array::from_fn(|k| stored[start + k]));
            let list = lanes.list(word);
            results.push(std::array::from_fn(|k| list[k]));
        }
        results
    }
}

proptest! {
    #[test]
    fn operations_are_the_portable_ones(
        a: [i64; 16], b: [i64; 8], alike: bool, at in 0usize..9, count in 0usize..9, by in 0u32..64, rows: [[i32; 4]; 8],
        table in prop::collection::vec(any::<u32>(), 0..60),
    ) {
        let b = if alike { std::array::from_fn(|k| a[at + k]) } else { b };
        let operations = Operations { a, b, at, count, by, rows, table };
        let expected = (&operations).run(Portable);
        for choice in [VectorLevel::Avx2, VectorLevel::Best] {
            let found = dispatch_vectors(choice, &operations);
            prop_assert_eq!(found.as_ref().unwrap_or(&expected), &expected, "{:?}", choice);
        }
    }
}
