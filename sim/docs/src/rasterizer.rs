//! The single-precision rasterizer that the kernel's speed is held against: the best that open CPU rasterizers do.
//!
//! Setup by the usual formulas (\[EWA\] 6.2, 7.1), the box of the cut-off, 16 x 16 tiles, splats binned by counting and
//! sorted by integer keys tile by tile, a row's constant terms computed once, pixels eight at a time in loops that the
//! compiler turns into vectors of the level asked for, an exponential no more accurate than eight bits of colour need,
//! and tiles left when they have finished. It draws front to back by the kernel's [`Rules`]. What makes the kernel's
//! engine fast is not in it: spans, large tiles, rows in vectors.

use rayon::prelude::*;
use splatline::raster::Window;
use splatline_sim::camera::Camera;
use splatline_sim::fast::lanes::{Lanes, VectorLevel, VectorTask, dispatch_vectors, prefetch};
use splatline_sim::fast::order::{Grid, Key, part_length, tile_lists};
use splatline_sim::fixed::Times;
use splatline_sim::picture::Picture;
use splatline_sim::rules::Rules;
use splatline_sim::scene::Scene;
use std::array::from_fn;
use std::time::Instant;

/// Columns and rows of a tile.
const TILE: usize = 16;

/// Pixels of a vector.
const WIDTH: usize = 8;

/// Splats painted between two checks whether the tile has finished.
const CHECK_INTERVAL: usize = 32;

/// How many splats ahead memory is asked for.
const AHEAD: usize = 4;

/// A splat as a rasterizer loads it.
#[derive(Clone, Copy, Debug)]
struct FloatSplat {
    centre: [f32; 3],
    /// xx, xy, xz, yy, yz, zz.
    covariance: [f32; 6],
    weight: f32,
    colour: [f32; 3],
}

/// A splat on the screen.
#[derive(Clone, Copy, Debug)]
struct FloatFootprint {
    depth: f32,
    /// Pixels.
    centre: [f32; 2],
    /// r = a dx^2 + 2 b dx dy + c dy^2.
    conic: [f32; 3],
    /// The footprint is r < cutoff.
    cutoff: f32,
    /// Opacity at r = 0.
    peak: f32,
    colour: [f32; 3],
    /// Pixels of the cut-off's box; not empty.
    bounds: Window,
}

/// Splats, camera and rules in single precision. Covariances and colours are made when the scene is loaded; what
/// depends on the camera's place otherwise is computed for every frame.
#[derive(Clone, Debug)]
pub struct FloatScene {
    splats: Vec<FloatSplat>,
    rules: Rules,
    rotation: [[f32; 3]; 3],
    translation: [f32; 3],
    focal: [f32; 2],
    principal: [f32; 2],
    depths: [f32; 2],
    /// Smallest and largest x/z and y/z that the Jacobian takes.
    slopes: [[f32; 2]; 2],
    viewport: [u16; 2],
}

/// A frame and what it took.
#[derive(Clone, Debug)]
pub struct FloatDrawing {
    /// Premultiplied red, green, blue and transmittance, row-major.
    pub frame: Vec<[f32; 4]>,
    pub times: Times,
}

impl FloatScene {
    /// What `rules` and `camera` make of the scene.
    pub fn new(scene: &Scene, camera: &Camera, rules: &Rules) -> Self {
        let (colours, weights) = (scene.colours(camera), scene.weights_for(rules));
        let splats = scene.splats.iter().zip(colours.iter().zip(&weights));
        let slope = |size: usize, focal: f64, principal: f64| {
            let size = size as f64;
            let margin = 0.15 * size / focal;
            let ends = [
                -principal / focal - margin,
                (size - principal) / focal + margin,
            ];
            if rules.clamp_jacobian {
                ends.map(|end| end as f32)
            } else {
                [f32::NEG_INFINITY, f32::INFINITY]
            }
        };
        let entry = |axes: &[[f64; 3]; 3], (i, j): (usize, usize)| {
            axes.iter().map(|a| a[i] * a[j]).sum::<f64>()
        };
        FloatScene {
            splats: splats
                .map(|(splat, (colour, weight))| FloatSplat {
                    centre: splat.centre.map(|c| c as f32),
                    covariance: [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)]
                        .map(|place| entry(&splat.axes, place) as f32),
                    weight: *weight as f32,
                    colour: colour.map(|c| c as f32),
                })
                .collect(),
            rules: *rules,
            rotation: camera.rotation.map(|row| row.map(|w| w as f32)),
            translation: camera.translation.map(|d| d as f32),
            focal: [camera.fx as f32, camera.fy as f32],
            principal: [camera.cx as f32, camera.cy as f32],
            depths: [camera.near as f32, camera.far as f32],
            slopes: [
                slope(camera.width, camera.fx, camera.cx),
                slope(camera.height, camera.fy, camera.cy),
            ],
            viewport: [camera.width as u16, camera.height as u16],
        }
    }

    /// Draws a frame; the caller's rayon pool decides the number of threads.
    pub fn draw(&self, level: VectorLevel) -> FloatDrawing {
        let started = Instant::now();
        let footprints: Vec<_> = self
            .splats
            .par_iter()
            .map(|splat| self.footprint(splat))
            .collect();
        let set_up = started.elapsed().as_secs_f64();
        let grid = Grid::new(self.viewport, [TILE as u16; 2]);
        let part = part_length(footprints.len());
        let parts = footprints.par_chunks(part).enumerate();
        let keys = parts
            .map(|(number, footprints)| keys(footprints, number * part))
            .collect();
        let lists = tile_lists(&grid, keys);
        let sorted = started.elapsed().as_secs_f64();
        let mut frame = vec![[0.0, 0.0, 0.0, 1.0]; self.viewport.map(usize::from).iter().product()];
        let tiles = grid
            .split(&mut frame)
            .into_par_iter()
            .zip(&lists)
            .enumerate();
        tiles.for_each(|(number, (rows, list))| {
            let painting = TilePainting {
                rules: &self.rules,
                window: grid.window(number),
                rows,
                footprints: &footprints,
                list,
            };
            if let Err(painting) = dispatch_vectors(level, painting) {
                painting.paint::<false>();
            }
        });
        FloatDrawing {
            frame,
            times: Times {
                setup: set_up,
                sort: sorted - set_up,
                raster: started.elapsed().as_secs_f64() - sorted,
            },
        }
    }

    /// A frame in double precision.
    pub fn picture(&self, drawing: &FloatDrawing) -> Picture {
        let [width, height] = self.viewport.map(usize::from);
        let mut picture = Picture::new(width, height);
        for (out, [r, g, b, t]) in picture.pixels.iter_mut().zip(&drawing.frame) {
            *out = [r, g, b, &(1.0 - t)].map(|value| f64::from(*value));
        }
        picture
    }

    /// Projects one splat; `None` if nothing of it is seen.
    fn footprint(&self, splat: &FloatSplat) -> Option<FloatFootprint> {
        let [x, y, z] =
            [0, 1, 2].map(|row| dot(self.rotation[row], splat.centre) + self.translation[row]);
        if z <= self.depths[0] || z >= self.depths[1] {
            return None;
        }
        let slope = [x / z, y / z];
        let gain = self.focal.map(|focal| focal / z);
        let clamped = [0, 1].map(|axis| {
            slope[axis]
                .max(self.slopes[axis][0])
                .min(self.slopes[axis][1])
        });
        // Rows of J W; the third column of J is -gain * slope.
        let rows = [0, 1].map(|axis| {
            [0, 1, 2].map(|k| {
                gain[axis] * (self.rotation[axis][k] - clamped[axis] * self.rotation[2][k])
            })
        });
        let [across, down] = rows.map(|row| apply(&splat.covariance, row));
        let low_pass = self.rules.low_pass as f32;
        let [xx, xy, yy] = [
            dot(rows[0], across) + low_pass,
            dot(rows[0], down),
            dot(rows[1], down) + low_pass,
        ];
        let determinant = xx * yy - xy * xy;
        if determinant <= 0.0 {
            return None;
        }
        let mut peak = splat.weight;
        if self.rules.normalised {
            let slant = (1.0 + clamped[0] * clamped[0] + clamped[1] * clamped[1]).sqrt();
            peak *= gain[0] * gain[1] * slant / (std::f32::consts::TAU * determinant.sqrt());
        }
        let mut cutoff = self.rules.cutoff as f32;
        if self.rules.alpha_min > 0.0 {
            cutoff = cutoff.min(2.0 * (peak / self.rules.alpha_min as f32).ln());
        }
        // Also false for a peak of 0, whose logarithm is -infinity, and for NaN.
        if !(cutoff > 0.0 && peak > 0.0) {
            return None;
        }
        let centre = [0, 1].map(|axis| self.focal[axis] * slope[axis] + self.principal[axis]);
        Some(FloatFootprint {
            depth: z,
            centre,
            conic: [yy / determinant, -xy / determinant, xx / determinant],
            cutoff,
            peak,
            colour: splat.colour,
            bounds: self.bounds(centre, [(cutoff * xx).sqrt(), (cutoff * yy).sqrt()])?,
        })
    }

    /// Pixels whose samples lie within the extents around the centre.
    fn bounds(&self, centre: [f32; 2], extent: [f32; 2]) -> Option<Window> {
        let limit = self.viewport.map(f32::from);
        let low = [0, 1].map(|k| (centre[k] - extent[k] - 0.5).ceil().max(0.0));
        let high = [0, 1].map(|k| ((centre[k] + extent[k] - 0.5).floor() + 1.0).min(limit[k]));
        let is_seen = low[0] < high[0] && low[1] < high[1];
        is_seen.then(|| Window {
            first: low.map(|low| low as u16),
            end: high.map(|high| high as u16),
        })
    }
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// A symmetric matrix times a vector.
fn apply([xx, xy, xz, yy, yz, zz]: &[f32; 6], v: [f32; 3]) -> [f32; 3] {
    [
        dot([*xx, *xy, *xz], v),
        dot([*xy, *yy, *yz], v),
        dot([*xz, *yz, *zz], v),
    ]
}

/// What orders the splats that are seen, numbered from `start`. The bits of positive numbers are ordered as the numbers
/// are.
fn keys(footprints: &[Option<FloatFootprint>], start: usize) -> Vec<Key> {
    let numbered = footprints.iter().zip(start as u32..);
    let seen = numbered.filter_map(|(footprint, index)| Some((footprint.as_ref()?, index)));
    seen.map(|(footprint, index)| Key {
        depth: footprint.depth.to_bits().into(),
        index,
        bounds: footprint.bounds,
    })
    .collect()
}

/// A row of a tile: transmittance, negative where the pixel has finished; red, green, blue.
type TileRow = [[f32; TILE]; 4];

/// A tile to be painted, compiled for whatever vectors.
struct TilePainting<'a, 'f> {
    rules: &'a Rules,
    window: Window,
    rows: Vec<&'f mut [[f32; 4]]>,
    footprints: &'a [Option<FloatFootprint>],
    list: &'a [u32],
}

impl VectorTask for TilePainting<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) {
        self.paint::<true>();
    }
}

impl TilePainting<'_, '_> {
    #[inline(always)]
    fn paint<const FUSED: bool>(mut self) {
        let columns = usize::from(self.window.end[0] - self.window.first[0]);
        // What lies beyond the screen has finished.
        let clear = from_fn(|x| if x < columns { 1.0 } else { -1.0 });
        let mut tile = [[clear, [0.0; TILE], [0.0; TILE], [0.0; TILE]]; TILE];
        let used = self.rows.len();
        for part in self.list.chunks(CHECK_INTERVAL) {
            for (number, index) in part.iter().enumerate() {
                if let Some(next) = part.get(number + AHEAD) {
                    prefetch(&self.footprints[*next as usize]);
                }
                if let Some(footprint) = &self.footprints[*index as usize] {
                    draw::<FUSED>(self.rules, footprint, &self.window, &mut tile);
                }
            }
            if tile[..used]
                .iter()
                .all(|row| row[0].iter().all(|t| t.is_sign_negative()))
            {
                break;
            }
        }
        for (row, [transmittance, red, green, blue]) in self.rows.iter_mut().zip(&tile) {
            for (x, pixel) in row.iter_mut().enumerate() {
                *pixel = [red[x], green[x], blue[x], transmittance[x].abs()];
            }
        }
    }
}

/// All rows of a footprint's box within the tile.
#[inline(always)]
fn draw<const FUSED: bool>(
    rules: &Rules,
    footprint: &FloatFootprint,
    window: &Window,
    tile: &mut [TileRow; TILE],
) {
    let part = footprint.bounds.intersect(window);
    let [a, b, c] = footprint.conic;
    let [first, last] = [part.first[0], part.end[0]].map(|x| usize::from(x - window.first[0]));
    // One vector where one is enough, else both.
    let start = if last - first <= WIDTH {
        first.min(TILE - WIDTH)
    } else {
        0
    };
    let left = f32::from(window.first[0]) + 0.5 - footprint.centre[0];
    let (alpha_max, stop) = (rules.alpha_max as f32, rules.minimum_transmittance as f32);
    for y in part.first[1]..part.end[1] {
        let dy = f32::from(y) + 0.5 - footprint.centre[1];
        let (along, vertical) = (2.0 * b * dy, c * dy * dy);
        let row = &mut tile[usize::from(y - window.first[1]) % TILE];
        for x in (start..last).step_by(WIDTH) {
            // Never changes x; tells the compiler that a vector fits.
            let x = x.min(TILE - WIDTH);
            let radial = from_fn(|k| {
                let dx = left + (x as i32 + k as i32) as f32;
                sum::<FUSED>(sum::<FUSED>(a, dx, along), dx, vertical)
            });
            blend::<FUSED>(
                footprint,
                radial,
                [alpha_max, stop],
                rules.omit_finishing,
                x,
                row,
            );
        }
    }
}

#[inline(always)]
fn blend<const FUSED: bool>(
    splat: &FloatFootprint,
    radial: [f32; WIDTH],
    [alpha_max, stop]: [f32; 2],
    omit_finishing: bool,
    x: usize,
    row: &mut TileRow,
) {
    let before: [f32; WIDTH] = from_fn(|k| row[0][x + k]);
    // A word of ones where the pixel is inside and has not finished: words, not truth values, are what the compiler
    // turns into vectors.
    let live: [u32; WIDTH] = from_fn(|k| {
        if (radial[k] < splat.cutoff) & (before[k] > 0.0) {
            u32::MAX
        } else {
            0
        }
    });
    if live.iter().fold(0, |any, word| any | word) == 0 {
        return;
    }
    let share: [f32; WIDTH] = from_fn(|k| {
        let alpha = splat.peak * exponential::<FUSED>(radial[k]);
        let alpha = if alpha < alpha_max { alpha } else { alpha_max };
        f32::from_bits((before[k] * alpha).to_bits() & live[k])
    });
    let rest: [f32; WIDTH] = from_fn(|k| before[k] - share[k]);
    let finishes: [u32; WIDTH] = from_fn(|k| if rest[k] <= stop { u32::MAX } else { 0 });
    let last = if omit_finishing { before } else { rest };
    let omitted = if omit_finishing { finishes } else { [0; WIDTH] };
    let share: [f32; WIDTH] = from_fn(|k| f32::from_bits(share[k].to_bits() & !omitted[k]));
    let after: [f32; WIDTH] = from_fn(|k| {
        let marked = last[k].to_bits() | SIGN;
        f32::from_bits(marked & finishes[k] | rest[k].to_bits() & !finishes[k])
    });
    row[0][x..x + WIDTH].copy_from_slice(&after);
    for (plane, colour) in row[1..].iter_mut().zip(splat.colour) {
        let sums: [f32; WIDTH] = from_fn(|k| sum::<FUSED>(share[k], colour, plane[x + k]));
        plane[x..x + WIDTH].copy_from_slice(&sums);
    }
}

/// a b + c, rounded once where the processor has an instruction for it.
#[inline(always)]
fn sum<const FUSED: bool>(a: f32, b: f32, c: f32) -> f32 {
    if FUSED { a.mul_add(b, c) } else { a * b + c }
}

/// Set in the transmittance of a pixel that has finished.
const SIGN: u32 = 1 << 31;

/// exp(-r/2) to three hundredths: the exponent's integer part becomes a number's exponent, and its fraction the
/// mantissa as it is. The sum with `MAGIC` leaves the exponent in steps of 2^-15 in the low bits of a number.
#[inline(always)]
fn exponential<const FUSED: bool>(radial: f32) -> f32 {
    const STEPS: f32 = (1u32 << 15) as f32;
    const MAGIC: f32 = (3u32 << 22) as f32;
    const RATE: f32 = -0.5 * std::f32::consts::LOG2_E * STEPS;
    // The exponent of 1, less what makes the largest relative error of both signs alike.
    const BIAS: f32 = 127.0 - 0.0437;
    let steps = sum::<FUSED>(radial, RATE, BIAS * STEPS + MAGIC);
    f32::from_bits((steps.to_bits() << 8).wrapping_sub(MAGIC.to_bits() << 8))
}
