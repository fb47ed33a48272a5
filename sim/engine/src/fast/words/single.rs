//! The pixel path in single precision, front to back, for designs whose every product is one fused multiply-add
//! ([`Blend::is_single`]).
//!
//! A pixel is four numbers: its transmittance T, an integer, negative once it has finished; and its sums, each 2^23
//! more than the integer C. With M = 2^23, L = max(T, 0), P' = P 2^-(p+w) and O = M 2^-a a vector of pixels is
//!
//! ```text
//! W' = M + ((word - slope (f + 1)) >> k)         the packed table, in integers, of which the last makes a number
//! A' = min(fma(W', P', O - M P'), O + A'max)     O more than the opacity; from O to twice that the unit is 2^-a
//! G' = fma(L, A', M - L O)                       M more than the contribution
//! T' = T - (G' - M),  finished if G' > L + M - stop
//! C' = fma(G' - M, K 2^-(t+c-s), C)
//! ```
//!
//! which is the kernel's arithmetic ([`splatline::blend`]) bit for bit: what is added to every fused multiply-add is
//! exact, so that each has the one rounding of its product. Subtractions do not stand between the steps, since each
//! step waits for the one before. An opacity of 0 leaves a pixel as it is, so that pixels outside and finished ones
//! need no selection: the first have opacity 0, the others no transmittance.
//!
//! The product of slope and position is one of 16 bits by 16, the quickest that there is: of the position and the
//! interval's number above it, which the packed table counts on, it sees 16 bits as a signed number, and what it does
//! not see is taken off the interval's word.

use super::numbers::{OMIT_FINISHING, SplatNumbers};
use super::path::{PixelPath, TwoRuns};
use super::tile::Row;
use crate::fast::lanes::packed::{PackedOn, PackedWords};
use crate::fast::lanes::singles::{HAS_FUSED_ADD, SINGLES, Singles};
use crate::fast::rows::Pixels;
use crate::fast::tile::TILE;
use splatline::blend::Blend;
use splatline::draw::Coverage;
use splatline::format::Widths;
use splatline::kernel::{PackedTable, pack_into};
use splatline::rules::Rules;

/// 2^23: numbers from here to twice that are integers.
pub const WHOLE: f32 = 8_388_608.0;

/// 2^-bits.
fn unit(bits: i32) -> f32 {
    (-f64::from(bits)).exp2() as f32
}

/// What is constant for a picture.
#[derive(Clone, Debug)]
pub struct SingleNumbers {
    table: PackedWords,
    /// Bits of the radial index below an interval's number.
    below: i32,
    /// Of these, bits that the interpolation does not see.
    unseen: i32,
    slope: i32,
    interpolation: i32,
    /// See [`PackedTable::lead`].
    lead: i32,
    /// Integers are these times their units.
    peak: f32,
    colour: f32,
    /// O, O + A'max, and the least transmittance that does not finish a pixel less M.
    opacity: f32,
    alpha_max: f32,
    stop: f32,
    /// Colours end here, UQ.colour.
    end_of_colour: u32,
}

impl SingleNumbers {
    /// For widths, rules, the entries of a table and lanes of so many bits that allow it.
    pub fn new(widths: &Widths, rules: &Rules, entries: &[u32], lane_bits: u32) -> Option<Self> {
        let blend = Blend::new(widths, rules);
        // W lies in M's last bits, O - M P' in 24, and where 16 bits of a position change their sign an interval
        // begins.
        let fits = widths.weight <= 22
            && widths.peak + widths.weight <= widths.alpha + 24
            && (1..=15).contains(&widths.interpolation);
        if !HAS_FUSED_ADD
            || !blend.is_single()
            || !blend.draws_all_visible()
            || !fits
            || lane_bits > 32
        {
            return None;
        }
        let constants = blend.constants();
        // With the last interval: footprints of [`Rules::EWA`] end where their table does.
        let mut words = vec![0; entries.len() + 1];
        pack_into(&mut words, entries, widths, rules.table_range).ok()?;
        for (number, word) in words.iter_mut().enumerate() {
            let begin = (number as u32) << widths.interpolation;
            let unseen = begin.wrapping_sub(begin as i16 as u32);
            let slope = PackedTable::slope(*word, widths.interpolation);
            *word = word.wrapping_sub(slope.wrapping_mul(unseen));
        }
        let below = i32::from(widths.radial + rules.table_range) - i32::from(widths.table);
        let interpolation = i32::from(widths.interpolation);
        let [alpha, fraction] = [widths.alpha, widths.peak + widths.weight].map(i32::from);
        Some(SingleNumbers {
            table: PackedWords::new(words),
            below,
            unseen: below - interpolation,
            slope: (1 << (interpolation - 1)) - 1,
            interpolation,
            lead: PackedTable::lead(widths, rules.table_range) as i32,
            peak: unit(fraction),
            colour: unit(constants.colour_shift),
            opacity: WHOLE * unit(alpha),
            alpha_max: (WHOLE + constants.alpha_max as f32) * unit(alpha),
            stop: constants.minimum_transmittance as f32 + 1.0 - WHOLE,
            end_of_colour: 1 << (widths.colour + widths.colour_range()),
        })
    }
}

/// The same on vectors; what a splat would finish is left out if `OPERATOR` says so.
#[derive(Clone, Copy)]
pub struct SinglePixels<'a, L: Singles, const OPERATOR: u8> {
    lanes: L,
    numbers: &'a SingleNumbers,
    table: PackedOn<'a, L>,
    lead: L::Whole,
    slope: L::Whole,
    below: L::Whole,
    unseen: L::Whole,
    interpolation: L::Whole,
    zero: L::Whole,
    whole: L::Single,
    opacity_negated: L::Single,
    alpha_max: L::Single,
    stop: L::Single,
}

/// What is constant for a footprint.
#[derive(Clone, Copy)]
pub struct SingleSplat<L: Singles> {
    /// One past the largest radial index inside.
    end: L::Whole,
    peak: L::Single,
    /// O - M P'.
    opacity: L::Single,
    colour: [L::Single; 3],
    /// k (k - 1) / 2 s and w (w - 1) / 2 s + w k s for pixel k of a vector of w.
    ahead: [L::Whole; 2],
    /// w^2 s.
    second: L::Whole,
    /// k (k - 1) / 2 s for pixel k of both halves of a vector.
    two: L::Whole,
}

/// 0, 1, 2 and so on, and k (k - 1) / 2.
const PLACES: [i32; SINGLES] = [0, 1, 2, 3, 4, 5, 6, 7];
const PAIRS: [i32; SINGLES] = [0, 0, 1, 3, 6, 10, 15, 21];

/// The same of two rows, and a bit for each pixel of a row.
const PLACES_OF_TWO: [i32; SINGLES] = [0, 1, 2, 3, 0, 1, 2, 3];
const PAIRS_OF_TWO: [i32; SINGLES] = [0, 0, 1, 3, 0, 0, 1, 3];
const BITS_OF_TWO: [i32; SINGLES] = [1, 2, 4, 8, 1, 2, 4, 8];

impl<'a, L: Singles, const OPERATOR: u8> SinglePixels<'a, L, OPERATOR> {
    /// On these vectors.
    #[inline(always)]
    pub fn new(lanes: L, numbers: &'a SingleNumbers) -> Self {
        SinglePixels {
            lanes,
            numbers,
            table: numbers.table.on(lanes),
            lead: lanes.whole(numbers.lead),
            slope: lanes.whole(numbers.slope),
            // Known to be below 32, so that no selection stands behind a shift.
            below: lanes.whole(numbers.below & 31),
            unseen: lanes.whole(numbers.unseen & 31),
            interpolation: lanes.whole(numbers.interpolation & 31),
            zero: lanes.whole(0),
            whole: lanes.single(WHOLE),
            opacity_negated: lanes.single(-numbers.opacity),
            alpha_max: lanes.single(numbers.alpha_max),
            stop: lanes.single(numbers.stop),
        }
    }

    /// Radial indices of the first vector of some pixels, and their differences to the next one's.
    #[inline(always)]
    fn start(&self, splat: &SingleSplat<L>, pixels: &Pixels) -> [L::Whole; 2] {
        let lanes = self.lanes;
        let first = lanes.whole(pixels.first as i32);
        let start = lanes.whole_add(lanes.whole(pixels.radial as i32), splat.ahead[0]);
        let along = lanes.whole_mul(lanes.whole_load(&PLACES), first);
        let width = lanes.whole_mul(first, lanes.whole(SINGLES as i32));
        [
            lanes.whole_add(start, along),
            lanes.whole_add(width, splat.ahead[1]),
        ]
    }

    /// The kernel at radial indices inside the footprint, M more than an integer; M elsewhere.
    #[inline(always)]
    fn weight(&self, radial: L::Whole, inside: L::Choice) -> L::Single {
        let lanes = self.lanes;
        let ahead = lanes.whole_add(lanes.whole_max(radial, self.zero), self.lead);
        let interval = lanes.whole_shr(ahead, self.below);
        let word = lanes.packed(&self.table, interval, inside);
        let slope = lanes.whole_and(word, self.slope);
        let fall = lanes.short_mul(slope, lanes.whole_shr(ahead, self.unseen));
        let weight = lanes.whole_shr(lanes.whole_sub(word, fall), self.interpolation);
        lanes.single_of(weight, self.whole)
    }

    /// One vector of pixels. Whether all of them have finished is not asked: it costs every vector more than it saves
    /// on the one in twenty that has.
    #[inline(always)]
    fn blend<const COUNTS: bool>(
        &self,
        splat: &SingleSplat<L>,
        radial: L::Whole,
        inside: L::Choice,
        x: usize,
        row: &mut Row<f32>,
        counts: &mut Coverage,
    ) {
        let lanes = self.lanes;
        let [plane_of_light, colours @ ..] = row;
        let light = lanes.single_read(plane_of_light, x);
        if COUNTS {
            let covered = lanes.chosen(inside);
            counts.covered += u64::from(covered.count_ones());
            counts.finished += u64::from((covered & lanes.signs(light)).count_ones());
        }
        let (rest, share) = self.lighten(splat, radial, inside, light);
        lanes.single_write(plane_of_light, x, rest);
        for (plane, colour) in colours.iter_mut().zip(splat.colour) {
            let sum = lanes.fused_add(share, colour, lanes.single_read(plane, x));
            lanes.single_write(plane, x, sum);
        }
    }

    /// What is left of a vector's transmittances, and M times the contribution.
    #[inline(always)]
    fn lighten(
        &self,
        splat: &SingleSplat<L>,
        radial: L::Whole,
        inside: L::Choice,
        light: L::Single,
    ) -> (L::Single, L::Single) {
        let lanes = self.lanes;
        let left = lanes.at_least_zero(light);
        let base = lanes.fused_add(left, self.opacity_negated, self.whole);
        let least = lanes.single_sub(left, self.stop);
        let alpha = lanes.fused_add(self.weight(radial, inside), splat.peak, splat.opacity);
        let alpha = lanes.single_min(alpha, self.alpha_max);
        let share = lanes.fused_add(left, alpha, base);
        let stop = lanes.single_less(least, share);
        let share = lanes.single_sub(share, self.whole);
        let share = if OPERATOR == OMIT_FINISHING {
            lanes.single_clear(share, stop)
        } else {
            share
        };
        let rest = lanes.single_sub(light, share);
        (lanes.single_mark(rest, stop), share)
    }
}

impl<L: Singles, const OPERATOR: u8> PixelPath for SinglePixels<'_, L, OPERATOR> {
    type Word = f32;
    type Splat = SingleSplat<L>;

    /// Are colours within their format?
    #[inline(always)]
    fn fits(&self, splat: &SplatNumbers) -> bool {
        let [red, green, blue] = splat.colour;
        red.max(green).max(blue) <= self.numbers.end_of_colour
    }

    #[inline(always)]
    fn splat(&self, splat: &SplatNumbers, second: i64) -> SingleSplat<L> {
        let (lanes, numbers) = (self.lanes, self.numbers);
        let width = SINGLES as i32;
        let second = second as i32;
        let along = lanes.whole(second.wrapping_mul(width));
        let whole = lanes.whole(second.wrapping_mul(width * (width - 1) / 2));
        SingleSplat {
            // At a cut-off of 0 nothing is inside, not even the rounding noise below 0.
            end: lanes.whole(match (splat.end >> 32) as i32 {
                0 => i32::MIN,
                end => end,
            }),
            peak: lanes.single(splat.peak as f32 * numbers.peak),
            opacity: lanes.single(numbers.opacity - WHOLE * (splat.peak as f32 * numbers.peak)),
            colour: [
                lanes.single(splat.colour[0] as f32 * numbers.colour),
                lanes.single(splat.colour[1] as f32 * numbers.colour),
                lanes.single(splat.colour[2] as f32 * numbers.colour),
            ],
            ahead: [
                lanes.whole_mul(lanes.whole_load(&PAIRS), lanes.whole(second)),
                lanes.whole_add(whole, lanes.whole_mul(lanes.whole_load(&PLACES), along)),
            ],
            second: lanes.whole(second.wrapping_mul(width * width)),
            two: lanes.whole_mul(lanes.whole_load(&PAIRS_OF_TWO), lanes.whole(second)),
        }
    }

    #[inline(always)]
    fn paint<const COUNTS: bool>(
        &self,
        splat: &SingleSplat<L>,
        pixels: &Pixels,
        row: &mut Row<f32>,
        counts: &mut Coverage,
    ) {
        let lanes = self.lanes;
        let [mut radial, mut difference] = self.start(splat, pixels);
        let end = (pixels.x + pixels.length).min(TILE[0].into());
        // Never changes x; tells the compiler that a vector fits.
        let mut x = pixels.x % usize::from(TILE[0]);
        let mut next = x + SINGLES;
        while next < end {
            let inside = lanes.whole_greater(splat.end, radial);
            self.blend::<COUNTS>(splat, radial, inside, x, row, counts);
            radial = lanes.whole_add(radial, difference);
            difference = lanes.whole_add(difference, splat.second);
            (x, next) = (next, next + SINGLES);
        }
        let inside = lanes.whole_greater(splat.end, radial);
        let inside = lanes.choose_both(inside, lanes.choose_first(end - x));
        self.blend::<COUNTS>(splat, radial, inside, x, row, counts);
    }

    const TAKES_TWO: bool = true;

    #[inline(always)]
    fn paint_two(&self, splat: &SingleSplat<L>, runs: &TwoRuns, rows: &mut [Row<f32>; 2]) {
        let lanes = self.lanes;
        let places = lanes.whole_load(&PLACES_OF_TWO);
        let along = lanes.whole_mul(places, lanes.whole_two(runs.first));
        let start = lanes.whole_add(lanes.whole_two(runs.radial), splat.two);
        let radial = lanes.whole_add(start, along);
        let bits = lanes.whole_and(lanes.whole_two(runs.pixels), lanes.whole_load(&BITS_OF_TWO));
        let inside = lanes.whole_greater(splat.end, radial);
        let inside = lanes.choose_both(inside, lanes.whole_greater(bits, self.zero));
        // Never changes x; tells the compiler that a vector fits.
        let [left, right] = *runs.x;
        let x = [
            left as usize % usize::from(TILE[0]),
            right as usize % usize::from(TILE[0]),
        ];
        let [above, below] = rows;
        let [light_above, colours_above @ ..] = above;
        let [light_below, colours_below @ ..] = below;
        let light = lanes.two_read([light_above, light_below], x);
        let (light, share) = self.lighten(splat, radial, inside, light);
        lanes.two_write([light_above, light_below], x, light);
        let planes = colours_above.iter_mut().zip(colours_below);
        for ((above, below), colour) in planes.zip(splat.colour) {
            let sum = lanes.fused_add(share, colour, lanes.two_read([above, below], x));
            lanes.two_write([above, below], x, sum);
        }
    }

    #[inline(always)]
    fn finished(&self, row: &Row<f32>) -> u64 {
        let columns = (0..usize::from(TILE[0])).step_by(SINGLES);
        columns.fold(0, |all, x| {
            let signs = self.lanes.signs(self.lanes.single_read(&row[0], x));
            all | u64::from(signs) << x
        })
    }
}

#[cfg(test)]
mod tests {
    //! Arbitrary pixels, splats and runs against the kernel's own words.

    use super::super::path::SHORT;
    use super::*;
    use crate::fast::lanes::{Lanes, Portable, VectorLevel, VectorTask, dispatch_vectors};
    use crate::fast::tile::TILE;
    use crate::fast::words::tile::WordTile;
    use splatline::blend::{FINISHED, Pixel};
    use splatline::draw::cutoff_in_lane;
    use splatline::format::Lean18;
    use splatline::kernel::{FootprintTable, gaussian};
    use splatline::raster::Window;

    const WIDTHS: Widths = Lean18::WIDTHS;
    const COLUMNS: usize = TILE[0] as usize;

    /// Draws so many times two runs of up to 64 pixels into rows of arbitrary pixels, one by one or, if they are short,
    /// together; the number of pixels inside a footprint.
    struct ArbitraryRuns {
        runs: u64,
        random: u64,
        rules: Rules,
    }

    impl ArbitraryRuns {
        fn bits(&mut self, bits: u32) -> u32 {
            self.random = self
                .random
                .wrapping_mul(0x5851_f42d_4c95_7f2d)
                .wrapping_add(1);
            ((self.random >> 32) as u32) >> (32 - bits)
        }

        /// Numbers of all magnitudes up to `end`, itself included.
        fn up_to(&mut self, end: u32) -> u32 {
            let spare = self.bits(5);
            match spare {
                31 => end,
                30 => end.saturating_sub(1),
                _ => ((u64::from(self.bits(32)) * u64::from(end)) >> 32) as u32 >> (spare % 20),
            }
        }

        /// A pixel as front-to-back compositing leaves it.
        fn pixel(&mut self, minimum: u32) -> Pixel {
            let one = 1 << WIDTHS.transmittance;
            let light = one - self.up_to(one);
            let colours = 1 << (WIDTHS.accumulator + WIDTHS.colour_range() - WIDTHS.transmittance);
            let sums = (one - light) * colours;
            let mark = if light <= minimum || self.bits(3) == 0 {
                FINISHED
            } else {
                0
            };
            Pixel {
                colour: [(); 3].map(|()| self.up_to(sums)),
                transmittance: light | mark,
            }
        }

        /// A run of so many pixels at most.
        fn arbitrary_run(&mut self, end: u64, longest: usize) -> Pixels {
            let x = self.bits(6) as usize;
            Pixels {
                x,
                length: 1 + self.bits(6) as usize % longest.min(COLUMNS - x),
                radial: i64::from(self.up_to(end as u32) as i32) - i64::from(self.bits(8)),
                first: i64::from(self.bits(32) as i32 >> self.bits(4).max(6)),
            }
        }

        fn check<L: Lanes, const OPERATOR: u8>(mut self, lanes: L) -> u64 {
            let entries = gaussian::<{ splatline::kernel::entries(&WIDTHS) }>(
                &WIDTHS,
                self.rules.table_range,
            );
            let table = FootprintTable::new(&entries, &WIDTHS, self.rules.table_range).unwrap();
            let numbers = SingleNumbers::new(&WIDTHS, &self.rules, &entries, 32).unwrap();
            let path = SinglePixels::<_, OPERATOR>::new(lanes.singles(), &numbers);
            let blend = Blend::new(&WIDTHS, &self.rules);
            let minimum = blend.constants().minimum_transmittance;
            let window = Window {
                first: [0; 2],
                end: [TILE[0], 2],
            };
            let mut tile = WordTile::<f32>::default();
            tile.open(window, Pixel::clear(&WIDTHS));
            let (mut counts, mut covered, mut of_two) = (Coverage::default(), 0, 0);
            let mut pixels = [Pixel::default(); 2 * COLUMNS];
            for _ in 0..self.runs {
                pixels = pixels.map(|_| self.pixel(minimum));
                tile.set_pixels(&pixels);
                let last = u32::MAX >> (4 - self.rules.table_range);
                let end = cutoff_in_lane(self.up_to(last), WIDTHS.radial);
                let splat = SplatNumbers {
                    end: (end as i64) << 32,
                    peak: self.up_to((1 << (4 + WIDTHS.peak)) - 1),
                    colour: [(); 3]
                        .map(|()| self.up_to(1 << (WIDTHS.colour + WIDTHS.colour_range()))),
                };
                let second = i64::from(self.up_to(1 << 24));
                let words = path.splat(&splat, second);
                let longest = if self.bits(1) == 0 { COLUMNS } else { SHORT };
                let runs = [(); 2].map(|()| self.arbitrary_run(end, longest));
                if longest == SHORT {
                    let pair = TwoRuns {
                        x: &runs.map(|run| run.x as i64),
                        pixels: &runs.map(|run| (1 << run.length) - 1),
                        radial: &runs.map(|run| run.radial),
                        first: &runs.map(|run| run.first),
                    };
                    path.paint_two(&words, &pair, tile.rows().first_chunk_mut().unwrap());
                } else {
                    for (run, row) in runs.iter().zip(tile.rows()) {
                        path.paint::<true>(&words, run, row, &mut counts);
                    }
                }
                let mut inside = 0;
                for (run, row) in runs.iter().zip(pixels.chunks_mut(COLUMNS)) {
                    let (mut radial, mut first) = (run.radial as i32, run.first as i32);
                    for pixel in &mut row[run.x..run.x + run.length] {
                        let index = radial.max(0) as u64;
                        radial = radial.wrapping_add(first);
                        first = first.wrapping_add(second as i32);
                        if index >= end {
                            continue;
                        }
                        inside += 1;
                        let alpha = blend.opacity(splat.peak, table.weight(index));
                        if alpha > 0 && !pixel.is_finished() {
                            blend.front_to_back(pixel, alpha, &splat.colour);
                        }
                    }
                }
                *if longest == SHORT {
                    &mut of_two
                } else {
                    &mut covered
                } += inside;
                assert_eq!(tile.to_pixels(), pixels, "{splat:?} {runs:?} {second}");
            }
            assert_eq!(counts.covered, covered);
            covered + of_two
        }
    }

    impl VectorTask for ArbitraryRuns {
        type Output = u64;

        #[inline(always)]
        fn run<L: Lanes>(self, lanes: L) -> u64 {
            if self.rules.omit_finishing {
                self.check::<L, OMIT_FINISHING>(lanes)
            } else {
                self.check::<L, { super::super::numbers::DRAW_FINISHING }>(lanes)
            }
        }
    }

    /// On all vectors, under both rules.
    fn all(runs: u64) -> u64 {
        let mut covered = 0;
        for rules in [Rules::EWA, Rules::GAUSSIAN_3D] {
            for (random, choice) in [VectorLevel::Avx2, VectorLevel::Best]
                .into_iter()
                .enumerate()
            {
                let random = random as u64 + 1;
                let task = ArbitraryRuns {
                    runs,
                    random,
                    rules,
                };
                covered += dispatch_vectors(choice, task).unwrap_or_default();
            }
            covered += ArbitraryRuns {
                runs: runs / 100,
                random: 3,
                rules,
            }
            .run(Portable);
        }
        covered
    }

    #[test]
    fn arbitrary_pixels_are_the_kernels() {
        assert!(all(20_000) > 100_000);
    }

    #[test]
    #[ignore = "takes minutes; prints how many pixels were compared"]
    fn a_billion_arbitrary_pixels_are_the_kernels() {
        let covered = all(36_500_000);
        println!("{covered} covered pixels, word for word the kernel's");
        assert!(covered >= 1_000_000_000);
    }
}
