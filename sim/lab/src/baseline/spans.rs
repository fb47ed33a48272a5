//! Baseline (b): the kernel's spans, tiles, order and vectors, with single-precision pixels.
//!
//! What is left between this and the fast engine is the arithmetic: here the radial index is computed at every pixel (a subtraction, a
//! product, a fused product), `exp` is a polynomial of degree 5 on the fraction of the exponent, and colours are fused products.

use super::BaselineDrawing;
use super::binned::draw_binned;
use super::scene::{BaselineFootprint, BoxExtent, FloatScene};
use rayon::prelude::*;
use splatline::blend::{FINISHED, Pixel};
use splatline_sim::fast::lanes::{Floats, VectorLevel, VectorTask, dispatch};
use splatline_sim::fast::order::Grid;
use splatline_sim::fast::tile::{PlaneTile, TILE, TileRow};

/// Footprints painted between two checks whether the tile has finished, as in the fast engine.
const CHECK_INTERVAL: usize = 64;

/// Draws the scene; the caller's rayon pool decides the number of threads.
pub fn draw(scene: &FloatScene, choice: VectorLevel) -> BaselineDrawing {
    draw_binned(scene, BoxExtent::Cutoff, TILE, |grid, footprints, lists| {
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
    let clear = Pixel {
        colour: [0; 3],
        transmittance: 1f32.to_bits(),
    };
    grid.split(&mut frame)
        .into_par_iter()
        .zip(lists)
        .enumerate()
        .for_each_init(PlaneTile::new, |tile, (number, (mut rows, list))| {
            tile.open(grid.window(number), clear);
            let painting = SpanPainting {
                scene,
                tile,
                footprints,
                list,
            };
            dispatch(choice, painting);
            for (y, row) in rows.iter_mut().enumerate() {
                let [transmittance, red, green, blue] = tile.planes(y);
                for (x, pixel) in row.iter_mut().enumerate() {
                    let words = [red[x], green[x], blue[x], transmittance[x] & !FINISHED];
                    *pixel = words.map(f32::from_bits);
                }
            }
        });
    frame
}

/// A tile to be painted, by whatever vectors.
struct SpanPainting<'a> {
    scene: &'a FloatScene,
    tile: &'a mut PlaneTile,
    footprints: &'a [Option<BaselineFootprint>],
    list: &'a [u32],
}

impl VectorTask for SpanPainting<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Floats>(self, lanes: L) {
        let SpanPainting {
            scene,
            tile,
            footprints,
            list,
        } = self;
        let path = SpanPixels::new(lanes, scene);
        for part in list.chunks(CHECK_INTERVAL) {
            for index in part {
                let Some(footprint) = &footprints[*index as usize] else {
                    continue;
                };
                if scene.omit_finishing {
                    path.draw::<true>(footprint, tile);
                } else {
                    path.draw::<false>(footprint, tile);
                }
            }
            if tile.is_finished() {
                break;
            }
        }
    }
}

/// What is constant for a picture, on vectors.
struct SpanPixels<L: Floats> {
    lanes: L,
    iota: L::Words,
    alpha_max: L::Words,
    alpha_min: L::Words,
    stop: L::Words,
    finished: L::Words,
}

/// What is constant for a footprint.
struct SpanConstants<L: Floats> {
    curvature: L::Words,
    cutoff: L::Words,
    peak: L::Words,
    colour: [L::Words; 3],
}

impl<L: Floats> SpanPixels<L> {
    #[inline(always)]
    fn new(lanes: L, scene: &FloatScene) -> Self {
        SpanPixels {
            lanes,
            iota: lanes.to_float(lanes.iota()),
            alpha_max: lanes.splat(scene.alpha_max.to_bits()),
            alpha_min: lanes.splat(scene.alpha_min.to_bits()),
            // The next number: "at most stop" becomes "less".
            stop: lanes.splat(scene.stop.to_bits() + 1),
            finished: lanes.splat(FINISHED),
        }
    }

    /// All rows of one footprint within the tile.
    #[inline(always)]
    fn draw<const STOP_BEFORE: bool>(&self, footprint: &BaselineFootprint, tile: &mut PlaneTile) {
        let lanes = self.lanes;
        let window = tile.window();
        let part = footprint.bounds.intersect(&window);
        let [xx, xy, yy] = footprint.variance;
        let [curvature, ..] = footprint.conic;
        let (slope, stretch) = (xy / yy, 1.0 / yy);
        let spread = (xx * yy - xy * xy) * stretch;
        let [r, g, b] = footprint.colour;
        let splat = SpanConstants {
            curvature: lanes.splat(curvature.to_bits()),
            cutoff: lanes.splat(footprint.cutoff.to_bits()),
            peak: lanes.splat(footprint.peak.to_bits()),
            colour: [
                lanes.splat(r.to_bits()),
                lanes.splat(g.to_bits()),
                lanes.splat(b.to_bits()),
            ],
        };
        let (left, right) = (f32::from(part.first[0]), f32::from(part.end[0]));
        for y in part.first[1]..part.end[1] {
            let dy = f32::from(y) + 0.5 - footprint.centre[1];
            let vertical = stretch * dy * dy;
            let rest = footprint.cutoff - vertical;
            if rest <= 0.0 {
                continue;
            }
            let half = (rest * spread).sqrt();
            let centre = footprint.centre[0] + slope * dy - 0.5;
            let low = (centre - half).ceil().max(left);
            let high = ((centre + half).floor() + 1.0).min(right);
            if low < high {
                let x = low as u16 - window.first[0];
                let length = (high - low) as u16;
                let run = (low - centre, vertical);
                self.paint::<STOP_BEFORE>(&splat, run, x, length, tile.row(y));
            }
        }
    }

    /// One run: `dx` at its first pixel and the vertical part of the radial index.
    #[inline(always)]
    fn paint<const STOP_BEFORE: bool>(
        &self,
        splat: &SpanConstants<L>,
        (dx, vertical): (f32, f32),
        x: u16,
        length: u16,
        row: &mut TileRow,
    ) {
        let lanes = self.lanes;
        let step = lanes.splat((L::WIDTH as f32).to_bits());
        let vertical = lanes.splat(vertical.to_bits());
        let mut dx = lanes.float_add(lanes.splat(dx.to_bits()), self.iota);
        let (mut x, mut rest) = (usize::from(x), usize::from(length));
        loop {
            let along = lanes.float_mul(dx, splat.curvature);
            let radial = lanes.float_mul_add(along, dx, vertical);
            let mut inside = lanes.float_greater(splat.cutoff, radial);
            if rest < L::WIDTH {
                inside = lanes.both(inside, lanes.first(rest));
            }
            self.blend::<STOP_BEFORE>(splat, radial, inside, x, row);
            if rest <= L::WIDTH {
                return;
            }
            dx = lanes.float_add(dx, step);
            x += L::WIDTH;
            rest -= L::WIDTH;
        }
    }

    #[inline(always)]
    fn blend<const STOP_BEFORE: bool>(
        &self,
        splat: &SpanConstants<L>,
        radial: L::Words,
        inside: L::Mask,
        x: usize,
        row: &mut TileRow,
    ) {
        let lanes = self.lanes;
        // Never changes x; tells the compiler that a vector fits.
        let x = x % usize::from(TILE[0]);
        let transmittance = lanes.load(&row[0][x..]);
        let live = lanes.except(inside, lanes.negative(transmittance));
        if lanes.is_none(live) {
            return;
        }
        let alpha = lanes.float_mul(splat.peak, self.exp(radial));
        let alpha = lanes.float_min(alpha, self.alpha_max);
        let alpha = lanes.clear(alpha, lanes.float_greater(self.alpha_min, alpha));
        let alpha = lanes.select(lanes.splat(0), alpha, live);
        let share = lanes.float_mul(transmittance, alpha);
        let rest = lanes.float_sub(transmittance, share);
        let stop = lanes.float_greater(self.stop, rest);
        let (share, marked) = if STOP_BEFORE {
            (
                lanes.clear(share, stop),
                lanes.or(transmittance, self.finished),
            )
        } else {
            (share, lanes.or(rest, self.finished))
        };
        lanes.store(&mut row[0][x..], lanes.select(rest, marked, stop));
        for (plane, colour) in row[1..].iter_mut().zip(splat.colour) {
            let sum = lanes.float_mul_add(share, colour, lanes.load(&plane[x..]));
            lanes.store(&mut plane[x..], sum);
        }
    }

    /// exp(-r/2), relative error below 3e-7 for r in 0..16: 2^n 2^f with the Taylor series of 2^f on -1/2..1/2.
    #[inline(always)]
    fn exp(&self, radial: L::Words) -> L::Words {
        const SERIES: [f32; 6] = [
            1.339_887_4e-3,
            9.618_437e-3,
            5.550_336e-2,
            0.240_226_5,
            std::f32::consts::LN_2,
            1.0,
        ];
        let lanes = self.lanes;
        let rate = lanes.splat((-0.5 * std::f32::consts::LOG2_E).to_bits());
        let exponent = lanes.float_mul(radial, rate);
        let whole = lanes.to_integer(exponent);
        let fraction = lanes.float_sub(exponent, lanes.to_float(whole));
        let mut power = lanes.splat(SERIES[0].to_bits());
        for coefficient in &SERIES[1..] {
            power = lanes.float_mul_add(power, fraction, lanes.splat(coefficient.to_bits()));
        }
        lanes.add(power, lanes.shl(whole, 23))
    }
}
