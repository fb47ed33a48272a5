//! The same drawing in `f32`, for comparison: soft float on these targets.
//!
//! Drawn twice: `draw_box` as splatting is usually written (bounding box, conic evaluated at every pixel, `expf`), and
//! `draw_spans` by the kernel's own algorithm (spans, forward differencing, table), so that what the algorithm and what
//! the arithmetic gains are told apart. Accumulators are f32; pixels finish as in the kernel.

use crate::order::{Full, Order};
use crate::phase::{phase_draw, phase_draw_again, phase_rest, phase_setup};
use crate::scene::{COLUMNS, ROWS, SCENE, SPLATS, STRIP, STRIP_PIXELS, bits_of};
use crate::table::{ENTRIES, INTERVALS};
use libm::{ceilf, expf, floorf, logf, sqrtf};

const FOCAL: f32 = 60.0;
const LOW_PASS: f32 = 0.3;
const RATIO_LIMIT: f32 = 0.8;
const ALPHA_MIN: f32 = 1.0 / 255.0;
const ALPHA_MAX: f32 = 0.999;
const STOP: f32 = 1e-4;

/// A pixel: premultiplied colour and transmittance; negative when finished.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FloatPixel {
    colour: [f32; 3],
    transmittance: f32,
}

/// A splat on the screen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FloatFootprint {
    depth: f32,
    centre: [f32; 2],
    conic: [f32; 3],
    slope: f32,
    stretch: f32,
    cutoff: f32,
    peak: f32,
    colour: [f32; 3],
    first: [u16; 2],
    last: [u16; 2],
}

/// A splat of the scene in floating point.
#[derive(Clone, Copy, Debug, Default)]
pub struct FloatSplat {
    centre: [f32; 3],
    axes: [[f32; 3]; 3],
    opacity: f32,
    colour: [f32; 3],
}

/// Memory of a picture. One splat at a time is converted, so that the scene needs none.
#[derive(Debug)]
pub struct FloatMemory {
    footprints: [Option<FloatFootprint>; SPLATS],
    order: Order<f32>,
    strip: Strip,
}

impl FloatMemory {
    /// Empty memory.
    pub const EMPTY: FloatMemory = FloatMemory {
        footprints: [None; SPLATS],
        order: Order::EMPTY,
        strip: [FloatPixel {
            colour: [0.0; 3],
            transmittance: 0.0,
        }; STRIP_PIXELS],
    };
}

/// What came out: covered pixels and the sum of all colours, of either way.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FloatOutcome {
    /// Splats with a footprint.
    pub visible: u32,
    /// Covered pixels, by box and by spans.
    pub covered: [u32; 2],
    /// Sum of red, green and blue over the picture, times 256, by box and by spans.
    pub sum: [u32; 2],
}

/// Draws the scene both ways. A splat without a place in the depth order is an error, and nothing is drawn.
pub fn draw(memory: &mut FloatMemory) -> Result<FloatOutcome, Full> {
    let mut outcome = FloatOutcome::default();
    set_up(memory)?;
    outcome.visible = memory.order.iter().count() as u32;
    let mut first_row = 0;
    while first_row < ROWS {
        phase_draw();
        outcome.covered[0] += draw_strip(memory, first_row, draw_box);
        phase_rest();
        outcome.sum[0] += sum(&memory.strip);
        phase_draw_again();
        outcome.covered[1] += draw_strip(memory, first_row, draw_spans);
        phase_rest();
        outcome.sum[1] += sum(&memory.strip);
        first_row += STRIP;
    }
    Ok(outcome)
}

fn sum(strip: &[FloatPixel]) -> u32 {
    let sum: f32 = strip.iter().flat_map(|p| p.colour).sum();
    (sum * 256.0) as u32
}

/// The scene's integers as floats.
fn converted(index: usize) -> FloatSplat {
    let Some(splat) = SCENE.get(index) else {
        return FloatSplat::default();
    };
    // Axes have exponents -32 to -34 and weights -30: within the range of f32's exponent bits.
    let power = |exponent: i32| f32::from_bits(((127 + exponent) as u32) << 23);
    FloatSplat {
        centre: splat.centre.map(|c| bits_of(c) as f32 * power(-24)),
        axes: (splat.axes).map(|a| a.mantissa.map(|m| m as f32 * power(a.exponent))),
        opacity: splat.weight.mantissa as f32 * power(splat.weight.exponent),
        colour: splat.colour.map(|c| c.to_bits() as f32 * power(-28)),
    }
}

fn set_up(memory: &mut FloatMemory) -> Result<(), Full> {
    memory.order.clear();
    for (index, place) in memory.footprints.iter_mut().enumerate() {
        let splat = converted(index);
        phase_setup();
        *place = project(&splat);
        if let Some(found) = place {
            memory.order.insert(index, found.depth)?;
        }
        phase_rest();
    }
    Ok(())
}

/// EWA in the usual formulas. The camera is not turned, so W is the identity.
#[inline(never)]
fn project(splat: &FloatSplat) -> Option<FloatFootprint> {
    let [x, y, z] = splat.centre;
    let z = z + 4.0;
    if z <= 0.015_625 || splat.opacity <= ALPHA_MIN {
        return None;
    }
    let inverse = 1.0 / z;
    let (on_x, on_y) = (x * inverse, y * inverse);
    let centre = [
        FOCAL * on_x + f32::from(COLUMNS / 2),
        FOCAL * on_y + f32::from(ROWS / 2),
    ];
    let ratio = [on_x, on_y].map(|r| r.clamp(-RATIO_LIMIT, RATIO_LIMIT));
    let gain = FOCAL * inverse;
    let (mut xx, mut xy, mut yy) = (LOW_PASS, 0.0, LOW_PASS);
    for axis in &splat.axes {
        let across = (axis[0] - ratio[0] * axis[2]) * gain;
        let down = (axis[1] - ratio[1] * axis[2]) * gain;
        xx += across * across;
        xy += across * down;
        yy += down * down;
    }
    let determinant = xx * yy - xy * xy;
    let scale = 1.0 / determinant;
    let cutoff = 2.0 * logf(splat.opacity * 255.0);
    let (first_x, last_x) = bounds(centre[0], sqrtf(cutoff * xx), COLUMNS)?;
    let (first_y, last_y) = bounds(centre[1], sqrtf(cutoff * yy), ROWS)?;
    let stretch = 1.0 / yy;
    Some(FloatFootprint {
        depth: z,
        centre,
        conic: [yy * scale, -xy * scale, xx * scale],
        slope: xy * stretch,
        stretch,
        cutoff,
        peak: splat.opacity,
        colour: splat.colour,
        first: [first_x, first_y],
        last: [last_x, last_y],
    })
}

fn bounds(centre: f32, extent: f32, limit: u16) -> Option<(u16, u16)> {
    let first = ceilf(centre - extent - 0.5).max(0.0);
    let last = (floorf(centre + extent - 0.5) + 1.0).min(limit.into());
    (first < last).then_some((first as u16, last as u16))
}

type Strip = [FloatPixel; STRIP_PIXELS];
type Drawer = fn(&FloatFootprint, u16, &mut Strip) -> u32;

#[inline(never)]
fn draw_strip(memory: &mut FloatMemory, first_row: u16, drawer: Drawer) -> u32 {
    memory.strip.fill(FloatPixel {
        colour: [0.0; 3],
        transmittance: 1.0,
    });
    let mut covered = 0;
    for number in memory.order.iter() {
        let Some(Some(footprint)) = memory.footprints.get(number) else {
            continue;
        };
        covered += drawer(footprint, first_row, &mut memory.strip);
    }
    covered
}

/// Pixels `first .. last` of row `y` of the strip.
fn row(strip: &mut Strip, y: u16, first: u16, last: u16) -> &mut [FloatPixel] {
    let start = usize::from(y) * usize::from(COLUMNS);
    let pixels = start + usize::from(first)..start + usize::from(last);
    strip.get_mut(pixels).unwrap_or_default()
}

/// Every pixel of the box: conic, exponential, over.
fn draw_box(footprint: &FloatFootprint, first_row: u16, strip: &mut Strip) -> u32 {
    let [a, b, c] = footprint.conic;
    let mut covered = 0;
    let last = footprint.last[1].min(first_row + STRIP);
    for y in footprint.first[1].max(first_row)..last {
        let dy = f32::from(y) + 0.5 - footprint.centre[1];
        let pixels = row(strip, y - first_row, footprint.first[0], footprint.last[0]);
        for (pixel, x) in pixels.iter_mut().zip(footprint.first[0]..) {
            let dx = f32::from(x) + 0.5 - footprint.centre[0];
            let radial = a * dx * dx + 2.0 * b * dx * dy + c * dy * dy;
            if radial < footprint.cutoff {
                covered += 1;
                over(pixel, footprint, expf(-0.5 * radial));
            }
        }
    }
    covered
}

/// Spans by LDL, radial index by two additions, kernel from the table.
fn draw_spans(footprint: &FloatFootprint, first_row: u16, strip: &mut Strip) -> u32 {
    let curvature = footprint.conic[0];
    let spread = 1.0 / curvature;
    let mut covered = 0;
    let last = footprint.last[1].min(first_row + STRIP);
    for y in footprint.first[1].max(first_row)..last {
        let dy = f32::from(y) + 0.5 - footprint.centre[1];
        let vertical = footprint.stretch * dy * dy;
        let rest = footprint.cutoff - vertical;
        if rest <= 0.0 {
            continue;
        }
        let middle = footprint.centre[0] + footprint.slope * dy;
        let Some((first, last)) = bounds(middle, sqrtf(rest * spread), COLUMNS) else {
            continue;
        };
        let dx = f32::from(first) + 0.5 - middle;
        let mut radial = curvature * dx * dx + vertical;
        let mut step = curvature * (2.0 * dx + 1.0);
        for pixel in row(strip, y - first_row, first, last) {
            covered += 1;
            over(pixel, footprint, looked_up(radial));
            radial += step;
            step += 2.0 * curvature;
        }
    }
    covered
}

/// The kernel's table (UQ1.14, up to r = 16), without interpolation.
fn looked_up(radial: f32) -> f32 {
    let index = (radial * (INTERVALS as f32 / 16.0)) as usize;
    let entry = ENTRIES.get(index);
    entry.map_or(0.0, |w| *w as f32 * (1.0 / 16384.0))
}

#[inline(always)]
fn over(pixel: &mut FloatPixel, footprint: &FloatFootprint, weight: f32) {
    if pixel.transmittance < 0.0 {
        return;
    }
    let alpha = (footprint.peak * weight).min(ALPHA_MAX);
    if alpha < ALPHA_MIN {
        return;
    }
    let share = pixel.transmittance * alpha;
    let rest = pixel.transmittance - share;
    if rest <= STOP {
        pixel.transmittance = -pixel.transmittance;
        return;
    }
    for (sum, c) in pixel.colour.iter_mut().zip(footprint.colour) {
        *sum += share * c;
    }
    pixel.transmittance = rest;
}
