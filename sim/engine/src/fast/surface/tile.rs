//! A tile of the accumulation buffer: each pixel's eight sums as a vector, and depth and material as one word to be
//! compared.
//!
//! What [`Accumulation`](splatline::blend::surface::Accumulation) does with a sample, for several pixels at once:
//! nearer than the pixel's depth by more than the threshold it replaces the sums, farther by more it is dropped, else
//! it is added. Depth and material lie in one word, `depth 2^8 + material`, because the nearest sample's material is
//! kept, the smaller of two that are equally near. An empty pixel is farther than any depth: its first sample replaces
//! nothing. The greatest depth, which layers need, is not kept.

use crate::fast::lanes::Lanes;
use crate::fast::lanes::words::Sums;
use crate::fast::tile::{ROWS, TILE};
use splatline::blend::surface::{Cell, Fragment, Sample, WeightedSum};
use splatline::raster::Window;

/// Columns that a vector may reach beyond the tile's last pixel.
const SPARE: usize = 8;

/// Pixels from one row to the next.
const STRIDE: usize = TILE[0] as usize + SPARE;

/// Columns and rows of a block, whose farthest pixel is known.
const BLOCK: usize = 4;

/// Blocks of a tile: columns and rows.
const BLOCKS: [usize; 2] = [TILE[0] as usize / BLOCK, ROWS / BLOCK];

/// Bits of a key below its depth.
const MATERIAL: i64 = 8;

/// Key of an empty pixel.
const EMPTY: i64 = i64::MAX;

/// A row's keys and sums.
#[derive(Clone, Debug)]
struct SumRow {
    keys: [i64; STRIDE],
    sums: [Sums; STRIDE],
}

/// The pixels of one tile, kept from tile to tile by a thread.
#[derive(Clone, Debug)]
pub struct SumTile {
    rows: Box<[SumRow]>,
    /// What no pixel of a block was farther than when it was [looked at](SumTile::look).
    farthest: [[i64; BLOCKS[0]]; BLOCKS[1]],
    window: Window,
}

impl Default for SumTile {
    fn default() -> Self {
        let row = SumRow {
            keys: [EMPTY; STRIDE],
            sums: [[0; 8]; STRIDE],
        };
        SumTile {
            rows: vec![row; ROWS].into(),
            farthest: [[i64::MAX; BLOCKS[0]]; BLOCKS[1]],
            window: Window {
                first: [0; 2],
                end: [0; 2],
            },
        }
    }
}

/// Several samples of one splat in adjacent pixels, one per word.
#[derive(Clone, Copy)]
pub struct SampleWords<L: Lanes> {
    /// UQ1.f; 0 where there is none.
    pub weights: L::Word,
    /// UQ9.23.
    pub depths: L::Word,
}

/// A splat's attributes as samples add them, and what decides whether they do.
#[derive(Clone, Copy)]
pub struct AttributeWords<L: Lanes> {
    pub attributes: L::Attributes,
    pub material: L::Word,
    pub threshold: L::Word,
}

impl SumTile {
    /// Makes it the empty pixels of `window`, which is at most a [`TILE`].
    pub fn open(&mut self, window: Window) {
        self.window = window;
        self.farthest = [[i64::MAX; BLOCKS[0]]; BLOCKS[1]];
        for row in self.rows.iter_mut().take(window.rows().into()) {
            row.keys.fill(EMPTY);
            row.sums.fill([0; 8]);
        }
    }

    /// Notes each block's farthest pixel. Pixels come only nearer, so that what is hidden from a block's farthest depth
    /// now is hidden later.
    #[inline(always)]
    pub fn look(&mut self) {
        let columns = usize::from(self.window.columns()).min(TILE[0].into());
        let rows = self.rows.iter().take(self.window.rows().into());
        self.farthest = [[0; BLOCKS[0]]; BLOCKS[1]];
        for (y, row) in rows.enumerate() {
            let blocks = row.keys[..columns].chunks(BLOCK);
            for (farthest, keys) in self.farthest[y / BLOCK % BLOCKS[1]].iter_mut().zip(blocks) {
                let near = keys.iter().fold(0, |far, key| far.max(*key));
                *farthest = near.max(*farthest);
            }
        }
        let blocks = self.farthest.iter_mut().flatten();
        blocks.for_each(|farthest| *farthest >>= MATERIAL);
    }

    /// Would every sample in these pixels of the tile, none of them nearer than `depth`, be dropped for being farther
    /// than its pixel?
    #[inline(always)]
    pub fn hides(&self, pixels: &Window, depth: u32, threshold: u32) -> bool {
        let blocks = |axis: usize| {
            let place = |pixel: u16| usize::from(pixel - self.window.first[axis]) / BLOCK;
            place(pixels.first[axis])..=place(pixels.end[axis] - 1).min(BLOCKS[axis] - 1)
        };
        // Most footprints are seen in the first block.
        let nearest = i64::from(depth) - i64::from(threshold);
        for row in &self.farthest[blocks(1)] {
            for farthest in &row[blocks(0)] {
                if nearest <= *farthest {
                    return false;
                }
            }
        }
        true
    }

    /// Which of the samples in the pixels from column `x` of the tile on, in row `y` of the screen, are not dropped for
    /// being farther than their pixel?
    #[inline(always)]
    pub fn seen<L: Lanes>(
        &self,
        lanes: L,
        place: [usize; 2],
        depths: L::Word,
        splat: &AttributeWords<L>,
        samples: L::Truth,
    ) -> L::Truth {
        let (x, row) = self.place(place);
        let near = lanes.shr(lanes.read(&self.rows[row].keys, x), lanes.splat(MATERIAL));
        let behind = lanes.greater(depths, lanes.add(near, splat.threshold));
        lanes.except(samples, behind)
    }

    /// Column and row of the tile. Never changes them; tells the compiler that a vector fits.
    #[inline(always)]
    fn place(&self, [x, y]: [usize; 2]) -> (usize, usize) {
        let row = (y - usize::from(self.window.first[1])) % ROWS;
        (x % usize::from(TILE[0]), row)
    }

    /// Adds samples that are [seen](SumTile::seen) to the pixels from column `x` of the tile on, in row `y` of the
    /// screen.
    #[inline(always)]
    pub fn add<L: Lanes>(
        &mut self,
        lanes: L,
        place: [usize; 2],
        samples: &SampleWords<L>,
        splat: &AttributeWords<L>,
    ) {
        let (x, row) = self.place(place);
        let Some(SumRow { keys, sums }) = self.rows.get_mut(row) else {
            return;
        };
        let [none, material] = [0, MATERIAL].map(|word| lanes.splat(word));
        let old = lanes.read(keys, x);
        let near = lanes.shr(old, material);
        let SampleWords { weights, depths } = *samples;
        let drawn = lanes.greater(weights, none);
        if lanes.flags(drawn) == 0 {
            return;
        }
        let before = lanes.greater(near, lanes.add(depths, splat.threshold));
        let replaced = lanes.flags(lanes.both(before, drawn));
        if replaced != 0 {
            for (k, sums) in sums[x..].iter_mut().take(L::WIDE).enumerate() {
                if replaced >> k & 1 != 0 {
                    *sums = [0; 8];
                }
            }
        }
        let key = lanes.or(lanes.shl(depths, material), splat.material);
        let empty = lanes.splat(EMPTY);
        let compared = lanes.select(old, empty, before);
        let nearest = lanes.select(compared, key, lanes.greater(compared, key));
        lanes.write(keys, x, lanes.select(old, nearest, drawn));
        for (k, weight) in lanes.list(weights).iter().enumerate().take(L::WIDE) {
            if !lanes.add_shares(&mut sums[x + k], weight, &splat.attributes) {
                // A full pixel stays as it is.
                keys[x + k] = lanes.list(old)[k];
            }
        }
    }

    /// The pixels row by row.
    pub fn cells(&self) -> impl Iterator<Item = SumCell> {
        let columns = usize::from(self.window.columns());
        let rows = self.rows.iter().take(self.window.rows().into());
        rows.flat_map(move |row| {
            let pixels = row.sums.iter().zip(&row.keys).take(columns);
            pixels.map(|(sums, key)| SumCell::new(sums, *key))
        })
    }
}

/// A pixel as the kernel resolves it.
#[derive(Clone, Debug)]
pub struct SumCell([Fragment; 1]);

impl SumCell {
    fn new([red, green, blue, opacity, x, y, z, weight]: &Sums, key: i64) -> Self {
        let near = (key >> MATERIAL) as u32;
        SumCell([Fragment {
            weight: *weight,
            colour: [*red, *green, *blue],
            opacity: *opacity,
            normal: [*x, *y, *z].map(|n| n as i32),
            near,
            far: near,
            material: key as u8,
        }])
    }
}

impl Cell for SumCell {
    const EMPTY: Self = SumCell([Fragment::EMPTY]);

    /// Samples of one surface; those of others are told apart by [`SumTile::add`].
    fn add(&mut self, gather: &WeightedSum, sample: &Sample) {
        gather.accumulate(&mut self.0[0], sample);
    }

    fn fragments(&self) -> &[Fragment] {
        match self.0 {
            [Fragment { weight: 0, .. }] => &[],
            _ => &self.0,
        }
    }
}
