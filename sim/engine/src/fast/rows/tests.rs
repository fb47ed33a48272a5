//! Rows in double precision against rows in words, run for run.

use super::*;
use crate::fast::lanes::{Portable, VectorLevel, VectorTask, dispatch_vectors};
use crate::fast::row_words::SquaredWidth;
use crate::fast::tests::{ordinary, usual_widths};
use proptest::prelude::*;
use splatline::format::{Lean18, Standard24};
use splatline::rules::Rules;

/// The runs of a footprint's rows in a tile, by both ways; `None` where one does not take them.
struct BothWays<'a> {
    constants: &'a RowConstants<i64>,
    widths: &'a Widths,
    footprint: &'a Footprint,
    window: &'a Window,
}

type AllRuns = Option<Vec<Option<[i64; 4]>>>;

impl VectorTask for &BothWays<'_> {
    type Output = [AllRuns; 2];

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> [AllRuns; 2] {
        let constants = self.constants;
        let mut batch = RowBatch::new();
        let runs = |batch: &RowBatch, filled: bool| {
            let places = (0..batch.rows()).flat_map(|row| batch.touched().map(move |x| (row, x)));
            let run = |(row, block)| {
                let run: Pixels = batch.block(block).run(row, 0)?;
                let [x, end] = [run.x, run.x + run.length].map(|x| x as i64);
                Some([x, end, run.radial, run.first])
            };
            filled.then(|| places.map(run).collect())
        };
        let filled = batch.fill_in_words(lanes, constants, 0);
        let words = runs(&batch, filled);
        let (mut group, k) = (RowGroup::default(), L::WIDE - 1);
        group.read(k, self.footprint, self.window);
        let together = group.compute(lanes, self.widths, 0);
        let mut batch = RowBatch::new(); // Which holds nothing of the other way.
        let filled = batch.fill_in_reals(&together, &group, k, 0);
        if filled {
            let (rows, visible) = (group.member(k).rows, group.member(k).visible);
            assert_eq!((rows, visible), (constants.rows, constants.visible));
            assert_eq!(group.second(k), constants.second);
        }
        [runs(&batch, filled), words]
    }
}

proptest! {
    #[test]
    fn rows_in_reals_are_those_in_words(
        widths in prop_oneof![2 => usual_widths(), 1 => Just(Lean18::WIDTHS), 1 => Just(Standard24::WIDTHS)],
        seed: u64, multiplier in prop::sample::select(vec![0.3, 1.0, 4.0, 20.0]),
        corner in prop_oneof![Just([0; 2]), [0u16..64, 0u16..64]], down in prop_oneof![3 => Just(0u16), 1 => 1u16..32],
    ) {
        let rows = RuntimeRows::new(&widths, i64::BITS).expect("a design");
        // All moved down: beside a tile of the screen, rows lie in three blocks.
        let window = Window { first: [corner[0], corner[1] + down], end: [TILE[0], TILE[1] + down] };
        let (mut taken, mut all) = (0, 0);
        for mut footprint in ordinary(widths, &Rules::GAUSSIAN_3D, seed, multiplier).into_iter().flatten() {
            footprint.centre[1] += i64::from(down) << widths.subpixel;
            footprint.first[1] += down;
            footprint.end[1] += down;
            let footprint = &footprint;
            if Window::of(footprint).intersect(&window).is_empty() {
                continue;
            }
            let constants = rows.constants(footprint, &window);
            let ways = BothWays { constants: &constants, widths: &widths, footprint, window: &window };
            let portable = Ok((&ways).run(Portable));
            let others = [VectorLevel::Avx2, VectorLevel::Best];
            for found in others.map(|level| dispatch_vectors(level, &ways)).into_iter().chain([portable]) {
                let Ok([reals, words]) = found else { continue };
                all += 1;
                taken += i32::from(reals.is_some());
                if reals.is_some() && words.is_some() {
                    prop_assert_eq!(reals, words);
                }
            }
        }
        let is_named = [Lean18::WIDTHS, Standard24::WIDTHS].contains(&widths);
        prop_assert!(4 * taken >= 3 * all || !is_named || down > 0, "{} of {}", taken, all);
    }

    #[test]
    fn half_widths_lie_within_the_error(
        mantissa in 1u64..1 << 31, odd in 0u32..2, power in -40i32..=30, rest: u32, less in 0u32..32,
    ) {
        let rest = rest >> less;
        let lanes = Portable;
        let constants = RowConstants {
            squared_width: (mantissa, odd, power),
            ..RowConstants::<i64>::default()
        };
        let table = SquaredWidth::new(lanes, &constants).half_of(lanes, [rest.into(); 8])[0];
        let [table, product] = [table as f64, (mantissa << odd) as f64 * f64::from(rest)];
        let root = product.sqrt() * f64::from(power).exp2();
        let [relative, absolute] = crate::fast::row_reals::ERROR;
        let most = root * relative + absolute * 2f64.powi(32);
        prop_assert!((table - root).abs() < most, "{table} and {root}");
    }
}
