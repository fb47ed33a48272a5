//! Baseline (a): the best that open CPU rasterizers do.
//!
//! Bounding boxes of three sigmas and 16 x 16 tiles as in [`textbook`](super::textbook), and everything that makes the fastest of them fast: splats are
//! binned by counting and sorted by integer keys tile by tile, a row's pixels are vectors chosen at run time, everything that is constant
//! along a row is computed once, pixels beyond the cut-off never enter the exponential, which is an integer trick with a parabola and no
//! more accurate than eight bits of colour need, and a tile is left when its pixels have finished.
//!
//! What makes the kernel's engine fast is not in it: spans instead of boxes, large tiles, rows in vectors.

use super::BaselineDrawing;
use super::binned::draw_binned;
use super::scene::{BaselineFootprint, BoxExtent, FloatScene};
use rayon::prelude::*;
use splatline::blend::FINISHED;
use splatline::raster::Window;
use splatline_sim::fast::lanes::{Floats, VectorLevel, VectorTask, dispatch, prefetch};
use splatline_sim::fast::order::Grid;

const TILE: u16 = 16;

/// Columns of a tile: a vector of sixteen words, or two of eight.
const COLUMNS: usize = TILE as usize;

/// Splats painted between two checks whether the tile has finished.
const CHECK_INTERVAL: usize = 32;

/// How many splats ahead memory is asked for.
const AHEAD: usize = 4;

/// One row of a tile: transmittance, red, green, blue.
type BoxRow = [[u32; COLUMNS]; 4];

/// Draws the scene; the caller's rayon pool decides the number of threads.
pub fn draw(scene: &FloatScene, extent: BoxExtent, choice: VectorLevel) -> BaselineDrawing {
    draw_binned(scene, extent, [TILE; 2], |grid, footprints, lists| {
        raster(scene, grid, footprints, lists, choice)
    })
}

/// Every tile on some core. Not inlined, so that a profiler can tell it from the rest.
#[inline(never)]
fn raster(
    scene: &FloatScene,
    grid: &Grid,
    footprints: &[Option<BaselineFootprint>],
    lists: &[Vec<u32>],
    choice: VectorLevel,
) -> Vec<[f32; 4]> {
    let [width, height] = scene.viewport.map(usize::from);
    let mut frame = vec![[0.0, 0.0, 0.0, 1.0]; width * height];
    grid.split(&mut frame)
        .into_par_iter()
        .zip(lists)
        .enumerate()
        .for_each(|(number, (mut rows, list))| {
            let mut tile = opened(rows.len(), rows.first().map_or(0, |row| row.len()));
            let painting = BoxPainting {
                scene,
                window: grid.window(number),
                tile: &mut tile,
                footprints,
                list,
            };
            dispatch(choice, painting);
            for (row, planes) in rows.iter_mut().zip(&tile) {
                let [transmittance, red, green, blue] = planes;
                for (x, pixel) in row.iter_mut().enumerate() {
                    let words = [red[x], green[x], blue[x], transmittance[x] & !FINISHED];
                    *pixel = words.map(f32::from_bits);
                }
            }
        });
    frame
}

/// A tile's transparent pixels; what lies beyond the screen has finished.
fn opened(rows: usize, columns: usize) -> [BoxRow; TILE as usize] {
    let clear = |x: usize, y: usize| x < columns && y < rows;
    std::array::from_fn(|y| {
        let transmittance = |x| 1f32.to_bits() | if clear(x, y) { 0 } else { FINISHED };
        let nothing = [0f32.to_bits(); COLUMNS];
        [
            std::array::from_fn(transmittance),
            nothing,
            nothing,
            nothing,
        ]
    })
}

fn is_finished(tile: &[BoxRow]) -> bool {
    let all = |row: &BoxRow| row[0].iter().fold(FINISHED, |all, word| all & word);
    tile.iter().fold(FINISHED, |both, row| both & all(row)) != 0
}

/// A tile to be painted, by whatever vectors.
struct BoxPainting<'a> {
    scene: &'a FloatScene,
    window: Window,
    tile: &'a mut [BoxRow; TILE as usize],
    footprints: &'a [Option<BaselineFootprint>],
    list: &'a [u32],
}

impl VectorTask for BoxPainting<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Floats>(self, lanes: L) {
        let BoxPainting {
            scene,
            window,
            tile,
            footprints,
            list,
        } = self;
        let path = BoxPixels::new(lanes, scene);
        for part in list.chunks(CHECK_INTERVAL) {
            for (number, index) in part.iter().enumerate() {
                if let Some(next) = part.get(number + AHEAD) {
                    prefetch(&footprints[*next as usize]);
                }
                if let Some(footprint) = &footprints[*index as usize] {
                    path.draw(footprint, &window, tile);
                }
            }
            if is_finished(tile) {
                break;
            }
        }
    }
}

/// What is constant for a picture, on vectors.
struct BoxPixels<L: Floats> {
    lanes: L,
    iota: L::Words,
    alpha_max: L::Words,
    stop: L::Words,
    finished: L::Words,
    omit_finishing: bool,
}

/// What is constant for a footprint.
struct BoxConstants<L: Floats> {
    curvature: L::Words,
    cutoff: L::Words,
    peak: L::Words,
    colour: [L::Words; 3],
}

impl<L: Floats> BoxPixels<L> {
    #[inline(always)]
    fn new(lanes: L, scene: &FloatScene) -> Self {
        BoxPixels {
            lanes,
            iota: lanes.to_float(lanes.iota()),
            alpha_max: lanes.splat(scene.alpha_max.to_bits()),
            // The next number: "at most stop" becomes "less".
            stop: lanes.splat(scene.stop.to_bits() + 1),
            finished: lanes.splat(FINISHED),
            omit_finishing: scene.omit_finishing,
        }
    }

    #[inline(always)]
    fn number(&self, value: f32) -> L::Words {
        self.lanes.splat(value.to_bits())
    }

    /// All rows of a footprint's box within the tile.
    #[inline(always)]
    fn draw(
        &self,
        footprint: &BaselineFootprint,
        window: &Window,
        tile: &mut [BoxRow; TILE as usize],
    ) {
        let lanes = self.lanes;
        let part = footprint.bounds.intersect(window);
        let [a, b, c] = footprint.conic;
        let constants = BoxConstants {
            curvature: self.number(a),
            cutoff: self.number(footprint.cutoff),
            peak: self.number(footprint.peak),
            colour: footprint.colour.map(|colour| self.number(colour)),
        };
        let [first, last] = [part.first[0], part.end[0]].map(|x| usize::from(x - window.first[0]));
        // One vector where one is enough, else those that lie in the box.
        let start = if last - first <= L::WIDTH {
            first.min(COLUMNS - L::WIDTH)
        } else {
            0
        };
        let left = f32::from(window.first[0]) + 0.5 - footprint.centre[0];
        for y in part.first[1]..part.end[1] {
            let dy = f32::from(y) + 0.5 - footprint.centre[1];
            let (along, vertical) = (self.number(2.0 * b * dy), self.number(c * dy * dy));
            let row = &mut tile[usize::from(y - window.first[1]) % COLUMNS];
            for x in (start..last).step_by(L::WIDTH) {
                let dx = lanes.float_add(self.iota, self.number(left + x as f32));
                let slope = lanes.float_mul_add(constants.curvature, dx, along);
                let radial = lanes.float_mul_add(slope, dx, vertical);
                self.blend(&constants, radial, x, row);
            }
        }
    }

    #[inline(always)]
    fn blend(&self, splat: &BoxConstants<L>, radial: L::Words, x: usize, row: &mut BoxRow) {
        let lanes = self.lanes;
        // Never changes x; tells the compiler that a vector fits.
        let x = x.min(COLUMNS - L::WIDTH);
        let transmittance = lanes.load(&row[0][x..]);
        let inside = lanes.float_greater(splat.cutoff, radial);
        let live = lanes.except(inside, lanes.negative(transmittance));
        if lanes.is_none(live) {
            return;
        }
        let alpha = lanes.float_mul(splat.peak, self.exp(radial));
        let alpha = lanes.float_min(alpha, self.alpha_max);
        let alpha = lanes.select(lanes.splat(0), alpha, live);
        let share = lanes.float_mul(transmittance, alpha);
        let rest = lanes.float_sub(transmittance, share);
        let stop = lanes.float_greater(self.stop, rest);
        let (share, marked) = if self.omit_finishing {
            let marked = lanes.or(transmittance, self.finished);
            (lanes.clear(share, stop), marked)
        } else {
            (share, lanes.or(rest, self.finished))
        };
        lanes.store(&mut row[0][x..], lanes.select(rest, marked, stop));
        for (plane, colour) in row[1..].iter_mut().zip(splat.colour) {
            let sum = lanes.float_mul_add(share, colour, lanes.load(&plane[x..]));
            lanes.store(&mut plane[x..], sum);
        }
    }

    /// exp(-r/2) to three hundredths: the exponent's integer part becomes a number's exponent, and its fraction the mantissa as it is.
    #[inline(always)]
    fn exp(&self, radial: L::Words) -> L::Words {
        const ONE: f32 = (1u32 << 23) as f32;
        const RATE: f32 = -0.5 * std::f32::consts::LOG2_E * ONE;
        let lanes = self.lanes;
        let bits = lanes.float_mul_add(radial, self.number(RATE), self.number(BIAS * ONE));
        lanes.to_integer(bits)
    }
}

/// The exponent of 1, less what makes the largest relative error of both signs alike.
const BIAS: f32 = 127.0 - 0.0437;
