//! Hybrid points: gathering within a depth range, then compositing (\[HYBRID\] 2 and 4).
//!
//! Samples closer together than pixels become points. Every pixel gathers the points that its circular filter reaches;
//! the filter is the same for all points and pixels, so a gather is a footprint of constant shape and runs through the
//! same traversals (`spans`, or `stamp`) as splats do. Points within one depth range are *summed*, not composited: they
//! are parts of the same piece of matter, and their order within the range does not matter. The sum is composited as
//! one layer when the next fragment lies beyond the range, or belongs to a splat, or the picture ends:
//!
//! ```text
//! a = sum a_i,  A = sum a_i c_i        while depth - first depth <= range
//! C' = C + T min(1, 1/a) A,  T' = T (1 - min(1, a))
//! ```
//!
//! Pixels that have finished gather nothing.

use super::{Blend, Pixel};
use crate::math::{SoftFloat, reciprocal, shift_unsigned};
use crate::raster::Window;

/// What a pixel has gathered and not yet composited.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Slab {
    /// Sum of opacity times colour, UQ4.accumulator, saturating.
    pub colour: [u32; 3],
    /// Sum of opacities, UQ4.alpha, saturating; 0 is an empty slab.
    pub opacity: u32,
    /// Depth of the first point, UQ9.23.
    pub first: u32,
}

/// One slab per pixel of a target, in memory that the caller lends.
#[derive(Debug)]
pub struct Slabs<'a> {
    memory: &'a mut [Slab],
    window: Window,
    stride: usize,
}

impl<'a> Slabs<'a> {
    /// Empty slabs for the pixels of `window`; `None` if `memory` is smaller than the window.
    pub fn new(memory: &'a mut [Slab], window: Window) -> Option<Self> {
        let columns = usize::from(window.end[0].saturating_sub(window.first[0]));
        let rows = usize::from(window.end[1].saturating_sub(window.first[1]));
        if memory.len() < columns * rows {
            return None;
        }
        memory.fill(Slab::default());
        Some(Slabs {
            memory,
            window,
            stride: columns,
        })
    }

    /// The slab of column `x` and row `y`, if it lies in the window.
    #[inline(always)]
    pub fn at(&mut self, [x, y]: [u16; 2]) -> Option<&mut Slab> {
        let Window { first, end: last } = self.window;
        if x < first[0] || x >= last[0] || y < first[1] || y >= last[1] {
            return None;
        }
        let index = usize::from(y - first[1]) * self.stride + usize::from(x - first[0]);
        self.memory.get_mut(index)
    }
}

impl Blend {
    /// Gathers a point of opacity `alpha` (UQ1.alpha) at `depth` (UQ9.23, not before the slab's) into the pixel's slab.
    ///
    /// `range` is the slab's thickness in the depth's format.
    #[inline(always)]
    pub fn gather(
        &self,
        pixel: &mut Pixel,
        slab: &mut Slab,
        alpha: u32,
        colour: &[u32; 3],
        depth: u32,
        range: u32,
    ) {
        if slab.opacity != 0 && depth.saturating_sub(slab.first) > range {
            self.close(pixel, slab);
            if pixel.is_finished() {
                return;
            }
        }
        if slab.opacity == 0 {
            slab.first = depth;
        }
        slab.opacity = slab.opacity.saturating_add(alpha);
        for (sum, c) in slab.colour.iter_mut().zip(colour) {
            let part = self.shift(u64::from(alpha) * u64::from(*c), self.layer_shift);
            *sum = sum.saturating_add(part as u32);
        }
    }

    /// Composites what the slab holds, front to back, and empties it. An empty slab changes nothing.
    #[inline]
    pub fn close(&self, pixel: &mut Pixel, slab: &mut Slab) {
        let Slab {
            colour, opacity, ..
        } = core::mem::take(slab);
        if opacity == 0 || pixel.is_finished() {
            return;
        }
        let one = 1u32 << self.contribution.by();
        let colour = if opacity > one {
            self.scaled_back(colour, opacity)
        } else {
            colour
        };
        let transmittance = u64::from(pixel.transmittance);
        let Some((_, after)) = self.contribution(pixel, opacity.min(one), u32::saturating_sub)
        else {
            return;
        };
        // UQ1.transmittance times UQ4.accumulator.
        for (sum, c) in pixel.colour.iter_mut().zip(colour) {
            let part = self.shift(transmittance * u64::from(c), self.transmittance_bits());
            *sum = sum.saturating_add(part as u32);
        }
        pixel.transmittance = after;
    }

    /// colour / opacity for a slab whose opacities sum to more than 1: rare, so the reciprocal unit serves.
    #[cold]
    fn scaled_back(&self, colour: [u32; 3], opacity: u32) -> [u32; 3] {
        let sum = SoftFloat::from_wide(opacity.into(), -self.contribution.by(), 31);
        let inverse = reciprocal(sum, 31).unwrap_or(SoftFloat::ZERO);
        // Below 1, hence at most 31 fraction bits.
        let factor = inverse.to_fixed(31).clamp(0, 1 << 31) as u64;
        colour.map(|c| {
            shift_unsigned(u64::from(c) * factor, 31, crate::format::Rounding::Nearest) as u32
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::{Standard24, Widths};
    use crate::rules::Rules;

    fn unit(value: f64, bits: u8) -> u32 {
        (value * f64::from(bits).exp2()) as u32
    }

    /// Memory larger than the window holds slabs that belong to no pixel: they are never handed out.
    #[test]
    fn slabs_end_with_their_window() {
        let window = Window {
            first: [3, 5],
            end: [7, 8],
        };
        let mut memory = [Slab::default(); 40];
        assert!(Slabs::new(&mut memory[..11], window).is_none());
        // Twelve are enough.
        for lent in [12, 40] {
            let mut slabs = Slabs::new(&mut memory[..lent], window).unwrap();
            let mut inside = 0;
            for (x, y) in (0..12).flat_map(|x| (0..12).map(move |y| (x, y))) {
                let expected = (3..7).contains(&x) && (5..8).contains(&y);
                let slab = slabs.at([x, y]);
                assert_eq!(slab.is_some(), expected, "{x} {y}");
                if let Some(slab) = slab {
                    assert_eq!(slab.opacity, 0, "{x} {y}: handed out twice");
                    slab.opacity = 1;
                    inside += 1;
                }
            }
            assert_eq!(inside, 12);
        }
    }

    /// Points in one range are summed, points of two ranges composited; also where opacities sum to more than 1.
    #[test]
    fn sums_within_and_composites_between_ranges() {
        let odd = Widths {
            transmittance: 23,
            ..Standard24::WIDTHS
        };
        let opacities = [[0.2, 0.3, 0.4], [0.7, 0.6, 0.9]];
        for (widths, opacities) in [Standard24::WIDTHS, odd]
            .into_iter()
            .flat_map(|w| opacities.map(|o| (w, o)))
        {
            let blend = Blend::new(&widths, &Rules::EWA);
            let colour = [1.0, 0.5, 0.25].map(|c| unit(c, widths.colour));
            let mut pixel = Pixel::clear(&widths);
            let mut slab = Slab::default();
            for (alpha, depth) in opacities.iter().zip([100, 150, 300]) {
                blend.gather(
                    &mut pixel,
                    &mut slab,
                    unit(*alpha, widths.alpha),
                    &colour,
                    depth,
                    50,
                );
            }
            blend.close(&mut pixel, &mut slab);
            let [a, b, c] = opacities;
            let first = f64::min(a + b, 1.0);
            let expected = first + (1.0 - first) * c;
            let got = f64::from(pixel.colour[0]) / f64::from(widths.accumulator).exp2();
            assert!((got - expected).abs() < 1e-6, "{got} {expected}");
            assert_eq!(slab, Slab::default());
            assert_eq!(pixel.is_finished(), first == 1.0);
        }
    }

    /// The faintest point begins a slab of its own, and takes of the light; a finished pixel is left as it is.
    #[test]
    fn faint_points_and_finished_pixels() {
        let widths = Standard24::WIDTHS;
        let blend = Blend::new(&widths, &Rules::EWA);
        let (mut pixel, mut slab) = (Pixel::clear(&widths), Slab::default());
        for depth in [100, 300] {
            blend.gather(&mut pixel, &mut slab, 1, &[0; 3], depth, 50);
        }
        assert_eq!((slab.first, slab.opacity), (300, 1));
        blend.close(&mut pixel, &mut slab);
        let taken = 2 << (widths.transmittance - widths.alpha);
        assert_eq!(pixel.transmittance, (1 << widths.transmittance) - taken);
        let finished = Pixel {
            transmittance: super::super::FINISHED | 1 << 20,
            ..pixel
        };
        let mut after = finished;
        blend.close(
            &mut after,
            &mut Slab {
                opacity: 1 << 20,
                colour: [9; 3],
                first: 5,
            },
        );
        assert_eq!(after, finished);
    }

    #[test]
    fn order_within_a_range_does_not_matter() {
        let widths = Standard24::WIDTHS;
        let blend = Blend::new(&widths, &Rules::EWA);
        let points = [
            (0.1, [1u32 << 18, 0, 0]),
            (0.37, [0, 1 << 18, 0]),
            (0.22, [0, 0, 1 << 17]),
        ];
        let draw = |order: [usize; 3]| {
            let mut pixel = Pixel::clear(&widths);
            let mut slab = Slab::default();
            for index in order {
                let (alpha, colour) = points[index];
                blend.gather(
                    &mut pixel,
                    &mut slab,
                    unit(alpha, widths.alpha),
                    &colour,
                    7,
                    50,
                );
            }
            blend.close(&mut pixel, &mut slab);
            pixel
        };
        assert_eq!(draw([0, 1, 2]), draw([2, 0, 1]));
    }

    #[test]
    fn sums_above_one_are_scaled_back_to_these() {
        let mut next = crate::random();
        let blend = Blend::new(&Standard24::WIDTHS, &Rules::EWA);
        let words = (0..2000).flat_map(|_| {
            let colour = [next() as u32, next() as u32, next() as u32];
            let opacity = (next() as u32 | 1 << 31) >> (next() % 4);
            blend.scaled_back(colour, opacity).map(u64::from)
        });
        assert_eq!(crate::digest(words), 579_421_008_155_018_587);
    }
}
