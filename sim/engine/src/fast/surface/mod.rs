//! Painting tiles of surfaces on vectors, along spans, in the scene's order.
//!
//! Rows and opacities are those of volume splats on words (`fast/words`). What a surface's pixel adds is its sums
//! ([`SumTile`]), or whatever the caller's pixels do with samples, layers for one. Rows that vectors cannot do are the
//! kernel's; their samples take the same way.

mod tile;

use super::lanes::words::ShareShift;
use super::lanes::{Lanes, VectorLevel, VectorTask, dispatch_pixels, prefetch};
use super::painter::{CHECK_INTERVAL, TableMemory};
use super::row_group::RowGroup;
use super::rows::{Pixels, RowBatch};
use super::setup::SurfaceOutcome;
use super::words::numbers::{EVEN, PathNumbers};
use super::words::path::{PixelPath, SplatWords, WordPixels};
use splatline::blend::surface::{Cell, Sample, WeightedSum, sum_fraction};
use splatline::draw::Coverage;
use splatline::footprint::surface::{
    Attributes, DEPTH_FRACTION, SurfaceFootprint, attribute_fraction, depth_in_pixel,
};
use splatline::format::Rounding;
use splatline::raster::Window;
use tile::{AttributeWords, SampleWords};
pub use tile::{SumCell, SumTile};

/// How many footprints ahead memory is asked for: lists name them in an order that no cache foresees.
const AHEAD: usize = 4;

/// Footprints between two looks at what a tile's blocks hide: four times as many looks hid one footprint in a thousand
/// more and cost more than that saved.
const LOOK_INTERVAL: usize = 256;

/// Everything about gathering that is constant for a picture, as numbers: one compiled copy draws all designs.
#[derive(Clone, Debug)]
pub struct GatherNumbers {
    path: PathNumbers,
    /// Left shift, half of a unit and right shift from an opacity to a weight.
    weight: [i64; 3],
    share: ShareShift,
    threshold: u32,
}

impl GatherNumbers {
    /// For widths and a table that words can do, in lanes of so many bits; the threshold is that of [`WeightedSum`].
    pub fn new(table: &TableMemory, threshold: u32, lane_bits: u32) -> Option<Self> {
        let widths = &table.widths;
        let half = |by: u32| match widths.rounding {
            Rounding::Nearest | Rounding::NearestEven => (1u64 << by) >> 1,
            Rounding::Truncate => 0,
        };
        let drop = i32::from(widths.alpha) - i32::from(sum_fraction(widths));
        let down = drop.max(0) as u32;
        let share = u32::from(attribute_fraction(widths));
        Some(GatherNumbers {
            path: PathNumbers::new(table, lane_bits)?,
            weight: [(-drop).max(0).into(), half(down) as i64, down.into()],
            share: ShareShift {
                by: share,
                half: half(share),
            },
            threshold,
        })
    }

    /// The attributes in the order of the sums; `None` if one exceeds its format.
    #[inline(always)]
    fn attributes(&self, attributes: &Attributes) -> Option<[i32; 8]> {
        let one = 1u32 << self.share.by;
        let ([r, g, b], [x, y, z]) = (attributes.colour, attributes.normal);
        let all = [r, g, b, attributes.opacity];
        let fits = all.iter().all(|value| *value <= one)
            && attributes.normal.iter().all(|n| n.unsigned_abs() <= one);
        let [r, g, b, opacity] = all.map(|value| value as i32);
        fits.then_some([r, g, b, opacity, x, y, z, one as i32])
    }
}

/// Do depths at all of the footprint's pixels stay where no sum of them saturates or wraps?
#[inline(always)]
fn is_near(footprint: &SurfaceFootprint) -> bool {
    let plane = &footprint.plane;
    let small = |value: i64, bits: u32| value.unsigned_abs() < 1 << bits;
    small(plane.origin, 52) && small(plane.step[0], 36) && small(plane.step[1], 36)
}

/// What one footprint leaves in one pixel, as the kernel's painter finds it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Recorded {
    weight: u32,
    depth: u32,
}

impl Cell for Recorded {
    const EMPTY: Self = Recorded {
        weight: 0,
        depth: 0,
    };

    fn add(&mut self, _: &WeightedSum, sample: &Sample) {
        (self.weight, self.depth) = (sample.weight, sample.depth);
    }

    fn fragments(&self) -> &[splatline::blend::surface::Fragment] {
        &[]
    }
}

/// Takes the samples of adjacent pixels from a column and row of the screen on: weights, 0 where there is none, and
/// depths.
pub type TakeSamples<'a> = dyn FnMut(&Attributes, [u16; 2], &[i64], &[i64]) + 'a;

/// Where samples go.
pub enum Gather<'a> {
    /// Into sums of one surface.
    Sums(&'a mut SumTile),
    /// To the caller.
    Samples(&'a mut TakeSamples<'a>),
}

/// Draws a footprint by the kernel into the cells of its box's part in the window.
pub type Record<'a> = dyn Fn(&SurfaceFootprint, Window, &mut [Recorded]) -> Coverage + 'a;

/// A tile to be painted.
#[derive(Clone, Copy)]
pub struct SurfaceTile<'a> {
    /// Its pixels on the screen.
    pub window: Window,
    /// What setup made of every splat, in the scene's order.
    pub footprints: &'a [SurfaceOutcome],
    /// Those that are drawn, in this order.
    pub list: &'a [u32],
}

/// Painting a tile on vectors.
pub struct GatherTask<'a, 'g> {
    /// Constants of the picture.
    pub numbers: &'a GatherNumbers,
    /// The tile.
    pub tile: SurfaceTile<'a>,
    /// Draws what vectors cannot.
    pub record: &'a Record<'a>,
    /// Takes what they can.
    pub gather: Gather<'g>,
    /// Are pixels counted? If not, footprints that nobody sees may be left out, and the counts are anything.
    pub counts: bool,
}

impl GatherTask<'_, '_> {
    /// Paints on such vectors; `None`, and anything in the tile, where there are none or an attribute exceeds its
    /// format.
    pub fn paint(self, choice: VectorLevel) -> Option<Coverage> {
        dispatch_pixels(choice, self).ok().flatten()
    }

    /// One footprint by the kernel: its samples, each at its column and row of the screen.
    #[cold]
    #[inline(never)]
    fn recorded(&self, footprint: &SurfaceFootprint) -> (Coverage, Vec<([u16; 2], Recorded)>) {
        let window = Window::of(&footprint.footprint).intersect(&self.tile.window);
        let mut cells = vec![Recorded::EMPTY; window.pixels()];
        let coverage = (self.record)(footprint, window, &mut cells);
        let columns = usize::from(window.columns()).max(1);
        let placed = cells.into_iter().enumerate().map(|(place, cell)| {
            let (x, y) = ((place % columns) as u16, (place / columns) as u16);
            ([window.first[0] + x, window.first[1] + y], cell)
        });
        let samples = placed.filter(|(_, cell)| cell.weight > 0).collect();
        (coverage, samples)
    }
}

/// A footprint on vectors.
struct Painted<'a, L: Lanes> {
    footprint: &'a SurfaceFootprint,
    splat: SplatWords<L>,
    words: AttributeWords<L>,
}

impl VectorTask for GatherTask<'_, '_> {
    type Output = Option<Coverage>;

    #[inline(always)]
    fn run<L: Lanes>(mut self, lanes: L) -> Option<Coverage> {
        let numbers = self.numbers;
        let path = WordPixels::<L, EVEN>::new(lanes, &numbers.path);
        let words = DepthWords::new(lanes, numbers);
        let (mut group, mut batch) = (RowGroup::default(), RowBatch::new());
        let mut coverage = Coverage::default();
        let (window, left) = (self.tile.window, self.tile.window.first[0]);
        let (footprints, list) = (self.tile.footprints, self.tile.list);
        let mut ahead = list.iter().skip(AHEAD);
        for (number, part) in list.chunks(CHECK_INTERVAL).enumerate() {
            if let Gather::Sums(tile) = &mut self.gather
                && (number * CHECK_INTERVAL).is_multiple_of(LOOK_INTERVAL)
                && !self.counts
            {
                tile.look();
            }
            let mut seen = [None; CHECK_INTERVAL];
            let mut count = 0;
            for index in part {
                if let Some(next) = ahead.next() {
                    prefetch(&footprints[*next as usize]);
                }
                if let Ok(footprint) = &footprints[*index as usize]
                    && !self.is_hidden(footprint)
                {
                    seen[count] = Some(footprint);
                    count += 1;
                }
            }
            for seen in seen[..count].chunks(L::WIDE) {
                for (k, footprint) in seen.iter().flatten().enumerate() {
                    group.read(k, &footprint.footprint, &window);
                }
                let together = group.compute(lanes, &numbers.path.rows.widths(), left);
                for (k, footprint) in seen.iter().flatten().copied().enumerate() {
                    let values = numbers.attributes(&footprint.attributes)?;
                    let material = footprint.attributes.material;
                    let attributes = words.splat(lanes, &values, numbers, material);
                    let of_group = (&together, &group, k);
                    let shape = &footprint.footprint;
                    if is_near(footprint)
                        && let Some(splat) = numbers.path.splat(shape)
                        && let Some((first, second)) =
                            batch.fill(&numbers.path.rows, of_group, shape, (&window, left))
                    {
                        let painted = Painted {
                            footprint,
                            splat: path.splat(&splat, second),
                            words: attributes,
                        };
                        coverage += self.paint_rows(&path, &words, &painted, (&batch, first));
                    } else {
                        coverage += self.paint_alone(lanes, footprint, &attributes);
                    }
                }
            }
        }
        Some(coverage)
    }
}

impl GatherTask<'_, '_> {
    /// One footprint by the kernel.
    #[inline(always)]
    fn paint_alone<L: Lanes>(
        &mut self,
        lanes: L,
        footprint: &SurfaceFootprint,
        attributes: &AttributeWords<L>,
    ) -> Coverage {
        let (coverage, samples) = self.recorded(footprint);
        for (place, Recorded { weight, depth }) in samples {
            let mut alone = [0; 8];
            alone[0] = weight.into();
            let depths = lanes.splat(depth.into());
            let seen = self.seen(lanes, place, depths, attributes, lanes.first(1));
            let samples = SampleWords {
                weights: lanes.keep(lanes.load(&alone), seen),
                depths,
            };
            self.take(lanes, footprint, place, &samples, attributes);
        }
        coverage
    }

    /// The runs of a footprint whose rows begin with the one of this number.
    #[inline(always)]
    fn paint_rows<L: Lanes>(
        &mut self,
        path: &WordPixels<L, EVEN>,
        words: &DepthWords<L>,
        painted: &Painted<L>,
        (batch, first): (&RowBatch, u16),
    ) -> Coverage {
        let mut coverage = Coverage::default();
        for row in 0..batch.rows() {
            for block in batch.touched() {
                if let Some(run) = batch.block(block).run(row, self.tile.window.first[0]) {
                    let y = first + row as u16;
                    coverage.visited += run.length as u64;
                    coverage.covered += self.run_of(path, words, painted, y, &run);
                }
            }
        }
        coverage
    }

    /// One run; the number of pixels inside.
    #[inline(always)]
    fn run_of<L: Lanes>(
        &mut self,
        path: &WordPixels<L, EVEN>,
        words: &DepthWords<L>,
        painted: &Painted<L>,
        y: u16,
        pixels: &Pixels,
    ) -> u64 {
        let (lanes, splat) = (path.lanes(), &painted.splat);
        let x = self.tile.window.first[0] + pixels.x as u16;
        let step = painted.footprint.plane.step[0];
        let depth = painted.footprint.depth_at(x, y);
        let mut depth = lanes.add(
            lanes.splat(depth + words.half),
            lanes.multiples(lanes.splat(step)),
        );
        let mut radial = path.start(splat, pixels);
        let mut covered = 0;
        for from in (0..pixels.length).step_by(L::WIDE) {
            let inside = path.inside(splat, radial[0], pixels.length - from);
            covered += u64::from(lanes.flags(inside).count_ones());
            let depths = words.in_pixel(lanes, depth);
            let place = [x + from as u16, y];
            let seen = self.seen(lanes, place, depths, &painted.words, inside);
            // Half of a closed surface's samples are hidden: they need no opacity.
            if lanes.flags(seen) != 0 {
                let samples = SampleWords {
                    weights: words.weight(lanes, path.alpha(splat, radial[0], seen)),
                    depths,
                };
                self.take(lanes, painted.footprint, place, &samples, &painted.words);
            }
            radial = path.step(splat, radial);
            depth = lanes.add(depth, lanes.splat(step.wrapping_mul(L::WIDE as i64)));
        }
        covered
    }

    /// Is the footprint known to lie behind all of its pixels, whatever its shape?
    #[inline(always)]
    fn is_hidden(&self, footprint: &SurfaceFootprint) -> bool {
        let Gather::Sums(tile) = &self.gather else {
            return false;
        };
        if self.counts || !is_near(footprint) {
            return false;
        }
        let pixels = Window::of(&footprint.footprint).intersect(&self.tile.window);
        if pixels.is_empty() {
            return false;
        }
        let [x, y] = pixels.first;
        let [across, down] = [pixels.columns(), pixels.rows()].map(|count| i64::from(count) - 1);
        let [step_x, step_y] = footprint.plane.step;
        let least = footprint.depth_at(x, y) + (across * step_x).min(0) + (down * step_y).min(0);
        tile.hides(&pixels, depth_in_pixel(least), self.numbers.threshold)
    }

    /// Which of the samples may change a pixel?
    #[inline(always)]
    fn seen<L: Lanes>(
        &self,
        lanes: L,
        place: [u16; 2],
        depths: L::Word,
        words: &AttributeWords<L>,
        samples: L::Truth,
    ) -> L::Truth {
        match &self.gather {
            Gather::Sums(tile) => tile.seen(lanes, self.in_tile(place), depths, words, samples),
            Gather::Samples(_) => samples,
        }
    }

    /// Column of the tile, row of the screen.
    #[inline(always)]
    fn in_tile(&self, [x, y]: [u16; 2]) -> [usize; 2] {
        [usize::from(x - self.tile.window.first[0]), y.into()]
    }

    /// Hands samples on.
    #[inline(always)]
    fn take<L: Lanes>(
        &mut self,
        lanes: L,
        footprint: &SurfaceFootprint,
        place: [u16; 2],
        samples: &SampleWords<L>,
        words: &AttributeWords<L>,
    ) {
        let in_tile = self.in_tile(place);
        match &mut self.gather {
            Gather::Sums(tile) => tile.add(lanes, in_tile, samples, words),
            Gather::Samples(take) => {
                let weights = lanes.list(samples.weights);
                let depths = lanes.list(samples.depths);
                let attributes = &footprint.attributes;
                take(attributes, place, &weights[..L::WIDE], &depths[..L::WIDE]);
            }
        }
    }
}

/// What brings opacities to weights and the depth lane to a pixel's depth.
struct DepthWords<L: Lanes> {
    /// Left shift, half of a unit and right shift of an opacity.
    weight: [L::Word; 3],
    half: i64,
    drop: L::Word,
    last: L::Word,
    threshold: L::Word,
}

impl<L: Lanes> DepthWords<L> {
    #[inline(always)]
    fn new(lanes: L, numbers: &GatherNumbers) -> Self {
        let drop = i64::from(DEPTH_FRACTION) - 23;
        let [up, half, down] = numbers.weight;
        let splat = |word| lanes.splat(word);
        DepthWords {
            weight: [splat(up), splat(half), splat(down)],
            half: 1 << (drop - 1),
            drop: splat(drop),
            last: splat(u32::MAX.into()),
            threshold: splat(numbers.threshold.into()),
        }
    }

    /// [`WeightedSum::weight`].
    #[inline(always)]
    fn weight(&self, lanes: L, alpha: L::Word) -> L::Word {
        let [up, half, down] = self.weight;
        lanes.shr(lanes.add(lanes.shl(alpha, up), half), down)
    }

    /// `depth_in_pixel` of depths to which half of a unit has been added.
    #[inline(always)]
    fn in_pixel(&self, lanes: L, depth: L::Word) -> L::Word {
        let depth = lanes.clear(depth, lanes.marked(depth));
        let depth = lanes.shr(depth, self.drop);
        lanes.select(depth, self.last, lanes.greater(depth, self.last))
    }

    #[inline(always)]
    fn splat(
        &self,
        lanes: L,
        values: &[i32; 8],
        numbers: &GatherNumbers,
        material: u8,
    ) -> AttributeWords<L> {
        AttributeWords {
            attributes: lanes.attributes(values, numbers.share),
            material: lanes.splat(material.into()),
            threshold: self.threshold,
        }
    }
}

#[cfg(test)]
mod tests;
