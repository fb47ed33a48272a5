//! A splat's colour in the design's width.
//!
//! The one place where halves go to the even neighbour. Files have colours of few bits: a quarter of all
//! single-precision numbers below 1/2 lies in the middle between two numbers of 24 fraction bits, and upwards all
//! pictures would be too bright by `2^-28`.

use crate::format::{Rounding, Widths};
use fixed::types::U4F28;

/// Red, green, blue in UQ(range).colour, with the design's [range](Widths::colour_range): rounded to nearest, halves to
/// even, saturated below the format's end, or truncated as the design's pixel path is.
#[inline]
pub fn colour(widths: &Widths, colour: [U4F28; 3]) -> [u32; 3] {
    let drop = 28u32.saturating_sub(widths.colour.into());
    let last = (1u64 << (widths.colour + widths.colour_range())) - 1;
    // What carries from halves on, of odd numbers, and above halves, of even ones.
    let (below_half, odd) = if drop == 0 || widths.rounding == Rounding::Truncate {
        (0, 0)
    } else {
        ((1 << (drop - 1)) - 1, 1)
    };
    colour.map(|channel| {
        let value = u64::from(channel.to_bits());
        let rounded = (value + below_half + (value >> drop & odd)) >> drop;
        rounded.min(last) as u32
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::{Classic8, Deep32, Lean18, Standard24};

    #[test]
    fn halves_go_to_even() {
        let of = |bits: u32, widths: &Widths| colour(widths, [U4F28::from_bits(bits); 3])[0];
        for (bits, expected) in [
            (7, 0),
            (8, 0),
            (9, 1),
            (24, 2),
            (40, 2),
            (41, 3),
            (u32::MAX, (1 << 28) - 1),
        ] {
            assert_eq!(of(bits, &Standard24::WIDTHS), expected, "{bits}");
        }
        assert_eq!(of((1 << 20) - 1, &Classic8::WIDTHS), 0);
        assert_eq!(of((7 << 28) + (5 << 12), &Lean18::WIDTHS), (7 << 15) + 2);
        assert_eq!(of(u32::MAX, &Lean18::WIDTHS), (8 << 15) - 1);
        assert_eq!(
            of(
                8,
                &Widths {
                    colour: 28,
                    ..Deep32::WIDTHS
                }
            ),
            8
        );
    }
}
