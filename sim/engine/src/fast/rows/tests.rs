//! Rows in double precision against rows in words, run for run.

use super::*;
use crate::fast::lanes::{Portable, VectorLevel, VectorTask, dispatch_vectors};
use crate::fast::tests::{ordinary, usual_widths};
use proptest::prelude::*;
use splatline::rules::Rules;

/// The runs of a footprint's rows in a tile, by both ways; `None` where one does not take them.
struct BothWays<'a>(&'a RowConstants<i64>);

type AllRuns = Option<Vec<Option<[i64; 4]>>>;

impl VectorTask for &BothWays<'_> {
    type Output = [AllRuns; 2];

    #[inline(always)]
    fn run<L: Doubles>(self, lanes: L) -> [AllRuns; 2] {
        let (constants, math) = (self.0, Arithmetic { lanes });
        let mut batch = RowBatch::new();
        batch.touched = (0, BLOCKS);
        let runs = |batch: &RowBatch, filled: bool| {
            let places = (0..batch.rows()).flat_map(|row| (0..BLOCKS).map(move |x| (row, x)));
            let run = |(row, block)| {
                let run: RunWords = batch.run(row, block)?;
                Some([run.x, run.end, run.radial, run.first])
            };
            filled.then(|| places.map(run).collect())
        };
        let filled = is_tame(constants) && batch.fill_in_reals(math, constants, 0);
        let reals = runs(&batch, filled);
        let filled = is_tame(constants) && batch.fill_in_words(math, constants, 0);
        [reals, runs(&batch, filled)]
    }
}

proptest! {
    #[test]
    fn rows_in_reals_are_those_in_words(
        widths in usual_widths(), seed: u64, multiplier in prop::sample::select(vec![0.3, 1.0, 4.0, 20.0]),
    ) {
        let rows = RuntimeRows::new(&widths, i64::BITS).expect("a design");
        let window = Window { first: [0; 2], end: TILE };
        let (mut taken, mut all) = (0, 0);
        for footprint in ordinary(widths, &Rules::GAUSSIAN_3D, seed, multiplier).iter().flatten() {
            if Window::of(footprint).intersect(&window).is_empty() {
                continue;
            }
            let constants = rows.constants(footprint, &window);
            let both = BothWays(&constants);
            let portable = Ok((&both).run(Portable));
            let others = [VectorLevel::Avx2, VectorLevel::Best];
            for found in others.map(|level| dispatch_vectors(level, &both)).into_iter().chain([portable]) {
                let Ok([reals, words]) = found else { continue };
                all += 1;
                taken += i32::from(reals.is_some());
                if reals.is_some() && words.is_some() {
                    prop_assert_eq!(reals, words);
                }
            }
        }
        prop_assert!(4 * taken >= 3 * all, "{} of {}", taken, all);
    }

    #[test]
    fn half_widths_lie_within_the_error(
        mantissa in 1u64..1 << 31, odd in 0u32..2, power in -40i32..=30, rest: u32, less in 0u32..32,
    ) {
        let rest = rest >> less;
        let constants = RowConstants {
            squared_width: (mantissa, odd, power),
            vertical_fraction: REST,
            ..RowConstants::default()
        };
        let math = Arithmetic { lanes: Portable };
        let table = SquaredWidth::new(math, &constants).half_of(math, [rest.into(); 8])[0];
        let [table, product] = [table as f64, (mantissa << odd) as f64 * f64::from(rest)];
        let root = product.sqrt() * f64::from(power).exp2();
        let [relative, absolute] = crate::fast::row_reals::ERROR;
        let most = root * relative + absolute * 2f64.powi(32);
        prop_assert!((table - root).abs() < most, "{table} and {root}");
    }
}
