//! Pixels as a display takes them: RGB8 or RGB565, over a background.
//!
//! A channel with L levels above 0 is `round(L (C + T b))`, halves up, at most L: C the accumulated colour, T the
//! transmittance and b the background (\[EWA\] eq. 5 with the background as the last layer). The background is given in
//! the same levels, B = L b, so that the value is
//!
//! ```text
//! floor((L C 2^(f - accumulator) + T B 2^(f - transmittance)) / 2^f + 1/2),   f = the larger of both widths
//! ```
//!
//! an exact sum rounded once. No gamma is applied: a display gets the linear values, as PNG files of the host do.

use crate::blend::Pixel;
use crate::draw::Coverage;
use crate::format::Widths;
use crate::raster::Window;

/// Brings pixels of a design to the levels of a display. One per design.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelReader {
    accumulator: u8,
    transmittance: u8,
    /// Does no channel of the frame's pixels exceed 1 - T by half a level, and has T at most 25 bits?
    bounded: bool,
}

impl PixelReader {
    /// A reader for pixels of these widths.
    pub const fn new(widths: &Widths) -> Self {
        PixelReader {
            accumulator: widths.accumulator,
            transmittance: widths.transmittance,
            bounded: false,
        }
    }

    /// The same for pixels no channel of which exceeds 1 - T by half a level, if that is so, and T of at most 25 bits.
    pub(super) const fn where_bounded(self, bounded: bool) -> Self {
        PixelReader { bounded, ..self }
    }

    /// One channel in levels of `1 / top`: colour UQ4.accumulator, transmittance UQ1.transmittance, background in the
    /// same levels. Saturates.
    #[inline]
    pub const fn level(&self, colour: u32, transmittance: u32, background: u8, top: u8) -> u8 {
        let (a, t) = (self.accumulator as u32, self.transmittance as u32);
        let fraction = if a > t { a } else { t };
        if fraction + u8::BITS - top.leading_zeros() <= 32 {
            return narrow_level([colour, transmittance], [a, t], fraction, background, top);
        }
        // From 1 on the result saturates, so that two terms below 2^39 remain.
        let light = (at_most_one(colour, a) * top as u64).wrapping_shl(fraction - a);
        let behind = (at_most_one(transmittance, t) * background as u64).wrapping_shl(fraction - t);
        let half = 1u64.wrapping_shl(fraction) >> 1;
        let level = (light + behind + half).wrapping_shr(fraction);
        if level > top as u64 { top } else { level as u8 }
    }

    /// Red, green, blue in 255ths; the background in 255ths.
    #[inline]
    pub fn rgb8(&self, pixel: &Pixel, background: [u8; 3]) -> [u8; 3] {
        let [red, green, blue] = pixel.colour;
        let [behind_red, behind_green, behind_blue] = background;
        let transmittance = pixel.transmittance();
        [
            self.level(red, transmittance, behind_red, 255),
            self.level(green, transmittance, behind_green, 255),
            self.level(blue, transmittance, behind_blue, 255),
        ]
    }

    /// Red, green, blue in 5, 6 and 5 bits, red highest; the background in the same format. [`Frame::write_rgb565`] is
    /// quicker.
    pub fn rgb565(&self, pixel: &Pixel, background: u16) -> u16 {
        let [red, green, blue] = pixel.colour;
        let transmittance = pixel.transmittance();
        let level = |colour, shift: u32, top: u8| {
            let behind = (background >> shift) as u8 & top;
            u16::from(self.level(colour, transmittance, behind, top)) << shift
        };
        level(red, 11, 31) | level(green, 5, 63) | level(blue, 0, 31)
    }

    /// The same of [bounded](PixelReader::where_bounded) pixels, in a function of its own: a pixel then costs
    /// Cortex-M0+ 30 instructions less. Widths of at most 26 bits, to which light and background are scaled: six bits
    /// of levels fit the word above them.
    #[inline(never)]
    fn write_bounded_565(&self, pixels: &[Pixel], background: u16, sent: &mut [u16]) {
        const HALF: u32 = 1 << 25;
        let scaled = |level: u32, bits: u8| level.wrapping_shl(26 - u32::from(bits));
        let top = [31, 63, 31].map(|level| scaled(level, self.accumulator));
        let behind = [background >> 11, background >> 5 & 63, background & 31];
        let behind = behind.map(|level| scaled(level.into(), self.transmittance));
        for (sent, pixel) in sent.iter_mut().zip(pixels) {
            // T has fewer than 26 bits, so that it is scaled by an even number, and its flag leaves the word.
            let transmittance = pixel.transmittance;
            let level = |channel: usize| {
                let light = pixel.colour[channel].wrapping_mul(top[channel]);
                let hidden = transmittance.wrapping_mul(behind[channel]);
                hidden.wrapping_add(HALF).wrapping_add(light) >> 26
            };
            *sent = ((level(0) << 6 | level(1)) << 5 | level(2)) as u16;
        }
    }
}

/// [`PixelReader::level`] in words of 32 bits, for levels and fraction bits that fit one together: each term is at most
/// 1, and a sum that leaves the word is above 1, too.
#[inline(always)]
const fn narrow_level(
    [colour, transmittance]: [u32; 2],
    [a, t]: [u32; 2],
    fraction: u32,
    background: u8,
    top: u8,
) -> u8 {
    let light = (at_most_one(colour, a) as u32).wrapping_mul(top as u32);
    let behind = (at_most_one(transmittance, t) as u32).wrapping_mul(background as u32);
    let light = light.wrapping_shl(fraction - a);
    let sum = light.wrapping_add(behind.wrapping_shl(fraction - t));
    let half = 1u32.wrapping_shl(fraction) >> 1;
    let rounded = sum.wrapping_add(half);
    let level = rounded.wrapping_shr(fraction);
    if sum < light || rounded < half || level > top as u32 {
        top
    } else {
        level as u8
    }
}

/// A number with `fraction` fraction bits, at most 1.
const fn at_most_one(value: u32, fraction: u32) -> u64 {
    let one = 1u32.wrapping_shl(fraction);
    if value > one {
        one as u64
    } else {
        value as u64
    }
}

/// A drawn window: its pixels row by row, and what drawing them visited.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'p> {
    /// The window's pixels, row by row without gaps.
    pub pixels: &'p [Pixel],
    /// Which part of the screen they are.
    pub window: Window,
    /// Pixels visited and covered by footprints; `None` where the loop of 32-bit words drew them, which has no
    /// counters.
    pub coverage: Option<Coverage>,
    /// How to read the pixels.
    pub reader: PixelReader,
}

impl<'p> Frame<'p> {
    /// The pixels as red, green, blue in 255ths, row by row, over a background in 255ths.
    pub fn rgb8(&self, background: [u8; 3]) -> impl Iterator<Item = [u8; 3]> + use<'p> {
        let reader = self.reader;
        let pixels = self.pixels.iter();
        pixels.map(move |pixel| reader.rgb8(pixel, background))
    }

    /// The pixels in 16 bits (red 5, green 6, blue 5), row by row, over a background in the same format: what a display
    /// on a serial bus takes.
    pub fn rgb565(&self, background: u16) -> impl Iterator<Item = u16> + use<'p> {
        let reader = self.reader;
        let pixels = self.pixels.iter();
        pixels.map(move |pixel| reader.rgb565(pixel, background))
    }

    /// The same into memory, as many as there is room for: what a DMA channel sends. Faster where the loop of 32-bit
    /// words drew colours of at most 1; of footprints that no setup made, levels may then wrap where
    /// [`rgb565`](Frame::rgb565) saturates.
    pub fn write_rgb565(&self, background: u16, sent: &mut [u16]) {
        let Frame { pixels, reader, .. } = self;
        if reader.bounded && reader.accumulator <= 26 {
            return reader.write_bounded_565(pixels, background, sent);
        }
        for (sent, bits) in sent.iter_mut().zip(self.rgb565(background)) {
            *sent = bits;
        }
    }

    /// The pixel at column `x` and row `y` of the screen, if it lies in the window.
    pub fn pixel(&self, x: u16, y: u16) -> Option<&'p Pixel> {
        let Window { first, end } = self.window;
        if x < first[0] || x >= end[0] || y < first[1] || y >= end[1] {
            return None;
        }
        let columns = usize::from(end[0] - first[0]);
        let place = usize::from(y - first[1]) * columns + usize::from(x - first[0]);
        self.pixels.get(place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::blend::FINISHED;
    use crate::format::{Classic8, Deep32, Micro16, Standard24};
    use proptest::prelude::*;

    proptest! {
        /// The oracle computes the header's formula in 128 bits.
        #[test]
        fn levels_are_the_formula(
            choice in 0usize..6, colour: u32, transmittance in 0u32..=1 << 30, background in 0u8..=255, top in prop_oneof![Just(31u8), Just(63), Just(255)],
        ) {
            let mut widths = [Classic8::WIDTHS, Standard24::WIDTHS, Deep32::WIDTHS, Standard24::WIDTHS, Standard24::WIDTHS, Micro16::WIDTHS][choice];
            if choice == 3 || choice == 4 {
                (widths.accumulator, widths.transmittance) = [(4, 30), (27, 4)][choice - 3];
            }
            let background = background.min(top);
            let transmittance = transmittance >> (30 - widths.transmittance);
            for colour in [colour, colour >> (31 - widths.accumulator)] {
                let (a, t) = (u32::from(widths.accumulator), u32::from(widths.transmittance));
                let light = (u128::from(colour) * u128::from(top)) << t;
                let exact = light + ((u128::from(transmittance) * u128::from(background)) << a);
                let rounded = ((exact << 1) + (1 << (a + t))) >> (a + t + 1);
                let expected = rounded.min(top.into()) as u8;
                prop_assert_eq!(PixelReader::new(&widths).level(colour, transmittance, background, top), expected);
            }
        }

        #[test]
        fn every_bit_pattern_is_defined(colour: [u32; 3], transmittance: u32, background: [u8; 3], behind: u16) {
            for widths in [Classic8::WIDTHS, Standard24::WIDTHS, Deep32::WIDTHS] {
                let reader = PixelReader::new(&widths);
                let pixel = Pixel { colour, transmittance };
                let _ = (reader.rgb8(&pixel, background), reader.rgb565(&pixel, behind));
            }
        }
    }

    #[test]
    fn ends_of_the_formats() {
        let reader = PixelReader::new(&Standard24::WIDTHS);
        let clear = Pixel::clear(&Standard24::WIDTHS);
        assert_eq!(reader.rgb8(&clear, [1, 128, 255]), [1, 128, 255]);
        assert_eq!(reader.rgb565(&clear, 0xabcd), 0xabcd);
        for widths in [Classic8::WIDTHS, Micro16::WIDTHS, Standard24::WIDTHS] {
            assert_eq!(
                PixelReader::new(&widths).rgb8(&Pixel::EMPTY, [7; 3]),
                [0; 3]
            );
        }
        let white = Pixel {
            colour: [1 << 26; 3],
            transmittance: FINISHED,
        };
        assert_eq!(reader.rgb8(&white, [9; 3]), [255; 3]);
        assert_eq!(reader.rgb565(&white, 0x1234), 0xffff);
        assert_eq!(
            reader.rgb565(
                &Pixel {
                    colour: [1 << 26, 0, 0],
                    transmittance: 0
                },
                0xffff
            ),
            0xf800
        );
    }

    /// A window whose columns and rows begin at different numbers: every pixel of the screen is the window's own or
    /// none.
    #[test]
    fn pixels_are_found_by_their_place_on_the_screen() {
        let pixels: [Pixel; 16] = core::array::from_fn(|index| Pixel {
            colour: [0; 3],
            transmittance: index as u32,
        });
        let frame = Frame {
            pixels: &pixels,
            window: Window {
                first: [3, 5],
                end: [7, 8],
            },
            coverage: None,
            reader: PixelReader::new(&Standard24::WIDTHS),
        };
        for (x, y) in (0..12).flat_map(|x| (0..12).map(move |y| (x, y))) {
            let inside = (3..7).contains(&x) && (5..8).contains(&y);
            let expected = inside.then(|| u32::from((y - 5) * 4 + x - 3));
            let found = frame.pixel(x, y).map(|pixel| pixel.transmittance);
            assert_eq!(found, expected, "{x} {y}");
        }
    }
    /// Longer words than the quick way has room for, and channels above 1 of pixels that nobody called bounded, are
    /// read one by one.
    #[test]
    fn words_are_written_quickly_where_they_have_room() {
        let written = |widths: &Widths, bounded: bool, colour: u32| {
            let reader = PixelReader::new(widths);
            let pixels = [Pixel {
                colour: [colour, colour / 2, 0],
                transmittance: 1 << (widths.transmittance - 2),
            }];
            let frame = Frame {
                pixels: &pixels,
                window: Window {
                    first: [0; 2],
                    end: [1; 2],
                },
                coverage: None,
                reader: if bounded {
                    reader.where_bounded(true)
                } else {
                    reader
                },
            };
            let mut sent = [0];
            frame.write_rgb565(0x8410, &mut sent);
            (sent[0], frame.rgb565(0x8410).next().unwrap())
        };
        let long = Widths {
            accumulator: 27,
            ..Micro16::WIDTHS
        };
        for (widths, bounded, colour) in [
            (&long, true, 3 << 25),
            (&Micro16::WIDTHS, true, 3 << 24),
            (&Micro16::WIDTHS, false, 3 << 26),
            (&Classic8::WIDTHS, false, 3 << 8),
        ] {
            let (found, expected) = written(widths, bounded, colour);
            assert_eq!(found, expected, "{widths:?} {bounded}");
        }
    }
}
