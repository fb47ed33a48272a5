//! A display list of packed footprints: what spans read, bit by bit, in drawing order.
//!
//! A [`Footprint`] has 104 bytes, and a list of them a number each for the order. Here an entry has neither conic nor
//! depth and no bit that follows from others: 36 bytes for [`Micro16`](crate::Micro16). There is no order beside it,
//! because splats are sorted before they are set up: the keys of that sort lie at the end of the same memory, and the
//! footprints take their place as they come.
//!
//! | field | bits |
//! |---|---|
//! | a bound, and [how](side) both follow from it, rows first | 2 x (16 + 2) |
//! | centre, its sign in how bounds follow | 2 x (26 + *subpixel*) |
//! | cut-off | 32 |
//! | A and C: mantissa without its leading bit, power of two of that bit | 2 x (*mantissa* - 1 + 8) |
//! | 1/A: the same mantissa, its exponent by that of A | *mantissa* - 1 + 2 |
//! | S | *mantissa* + 1 + 8 |
//! | peak, colours | 4 + *peak* + 3 x (range + *colour*) |
//!
//! The first two words say which rows an entry has, so that a strip passes over footprints of other strips without
//! unpacking them. Lists by strip would save these for two bytes more per footprint and strip.

use super::list::Footprints;
use crate::footprint::{Conic, Footprint, Ldl};
use crate::format::{Design, Widths};
use crate::math::SoftFloat;
use crate::raster::Window;
use crate::rules::Compositing;

/// Words of the longest entry that the width ranges allow.
const MOST: usize = 14;

/// Words of a key: depth, and the number of a splat.
pub(super) const KEY: usize = 3;

/// Bits of a bound, of how both follow, of twice a centre's magnitude, and of a power of two.
const BOUND: u32 = 16;
const HOW: u32 = 2;
const TWICE: u32 = 27;
const POWER: u32 = 8;

/// Words of an entry, for a design's widths.
pub const fn packed_words(widths: &Widths) -> usize {
    let [mantissa, subpixel, peak, colour] = [
        widths.mantissa as u32,
        widths.subpixel as u32,
        widths.peak as u32,
        (widths.colour_range() + widths.colour) as u32,
    ];
    let place = 2 * (BOUND + HOW + TWICE + subpixel - 1);
    let ldl = 4 * mantissa - 2 + 3 * POWER + 2;
    (place + 32 + ldl + (4 + peak) + 3 * colour).div_ceil(32) as usize
}

const _: () = assert!(
    packed_words(&Widths {
        mantissa: 31,
        subpixel: 24,
        peak: 28,
        colour: 28,
        ..crate::format::Deep32::WIDTHS
    }) <= MOST
);

/// A display list of packed footprints in memory that the caller lends, filled by
/// [`Renderer::set_up_scene`](super::Renderer::set_up_scene). It is drawn by spans, whatever the renderer's traversal.
#[derive(Debug)]
pub struct PackedList<'a, D> {
    design: D,
    pub(super) words: &'a mut [u32],
    used: usize,
    viewport: [u16; 2],
}

impl<'a, D: Design> PackedList<'a, D> {
    /// An empty list with room for one footprint of the design per [`packed_words`] words. What they hold is of no
    /// account.
    pub fn new(design: D, words: &'a mut [u32]) -> Self {
        PackedList {
            design,
            words,
            used: 0,
            viewport: [0; 2],
        }
    }

    /// A list of `used` footprints that [`into_words`](PackedList::into_words) left in these words, of a picture with
    /// this viewport; `None` if they have no room for as many.
    pub fn filled(
        design: D,
        words: &'a mut [u32],
        used: usize,
        viewport: [u16; 2],
    ) -> Option<Self> {
        let list = PackedList {
            design,
            words,
            used,
            viewport,
        };
        (used <= list.capacity()).then_some(list)
    }

    /// The memory, to be [taken up](PackedList::filled) again with [`len`](PackedList::len).
    pub fn into_words(self) -> &'a mut [u32] {
        self.words
    }

    /// Footprints on the list.
    pub fn len(&self) -> usize {
        self.used
    }

    /// Is there none?
    pub fn is_empty(&self) -> bool {
        self.used == 0
    }

    /// Footprints for which there is room.
    pub fn capacity(&self) -> usize {
        self.words
            .len()
            .checked_div(self.entry())
            .unwrap_or_default()
    }

    /// Words of an entry.
    #[inline(always)]
    pub(super) fn entry(&self) -> usize {
        packed_words(&self.design.widths())
    }

    /// Forgets all footprints.
    pub fn clear(&mut self) {
        self.used = 0;
    }

    /// Forgets all footprints; those to come are of a picture with this viewport.
    pub(super) fn begin(&mut self, viewport: [u16; 2]) {
        self.clear();
        self.viewport = viewport;
    }

    /// The footprint at a place in drawing order, without its conic and depth.
    pub fn footprint(&self, place: usize) -> Option<Footprint> {
        (place < self.used).then(|| self.unpack(self.at(place)))
    }

    /// The words at a place; none beyond the list.
    #[inline(always)]
    fn at(&self, place: usize) -> &[u32] {
        let entry = self.entry();
        let start = place.wrapping_mul(entry);
        self.words
            .get(start..start.wrapping_add(entry))
            .unwrap_or_default()
    }

    #[inline(never)]
    fn unpack(&self, words: &[u32]) -> Footprint {
        let mut bits = [0; MOST];
        for (word, packed) in bits.iter_mut().zip(words) {
            *word = *packed;
        }
        // The place is no part of what is copied: a compiler for size would not know it.
        let mut bits = Bits { words: bits, at: 0 };
        let widths = self.design.widths();
        let mut entry = Entry::default();
        entry.fields(&widths, |_, width| bits.take(width));
        entry.footprint(&widths, self.viewport)
    }

    /// Adds a footprint of setup that [fits](fits) behind all others, which must leave the words from `end` on alone.
    /// Where there is no room the list stays as it is.
    #[inline(never)]
    pub(super) fn push(&mut self, footprint: &Footprint, end: usize) -> Option<()> {
        let start = self.used.checked_mul(self.entry())?;
        let stop = start
            .checked_add(self.entry())
            .filter(|stop| *stop <= end)?;
        let place = self.words.get_mut(start..stop)?;
        let mut bits = Bits::default();
        let widths = self.design.widths();
        Entry::new(&widths, footprint).fields(&widths, |value, width| {
            bits.put(value, width);
            value
        });
        for (word, packed) in place.iter_mut().zip(bits.words) {
            *word = packed;
        }
        self.used += 1;
        Some(())
    }
}

impl<D: Design> Footprints for PackedList<'_, D> {
    const CONIC: bool = false;

    #[inline(always)]
    fn visit(&self, window: &Window, compositing: Compositing, mut draw: impl FnMut(&Footprint)) {
        let [from, to] = [window.first[1], window.end[1]].map(u32::from);
        if window.first[1] >= self.viewport[1] {
            return;
        }
        let used = self.used.saturating_mul(self.entry());
        let entries = self.words.get(..used).unwrap_or_default();
        let mut entries = entries.chunks_exact(self.entry().max(1));
        let backwards = compositing == Compositing::BackToFront;
        while let Some(entry) = if backwards {
            entries.next_back()
        } else {
            entries.next()
        } {
            let Some([bounds, place]) = entry.first_chunk::<2>() else {
                return;
            };
            // [`side`] for the rows, without what cuts them to the viewport, which the window has rows in.
            let (bound, how) = (bounds & 0xffff, place & 3);
            let meets = if how > 1 {
                bound > from
            } else {
                let twice = place >> (2 * HOW) & ((1 << TWICE) - 1);
                bound < to && twice.wrapping_sub(bound).wrapping_add(how) > from
            };
            if meets {
                draw(&self.unpack(entry));
            }
        }
    }
}

/// Can an entry hold this footprint of setup? Rules with a low-pass filter make no other, but for a centre that is
/// rounded to 2^26 pixels.
pub(super) fn fits(widths: &Widths, footprint: &Footprint) -> bool {
    let ldl = &footprint.ldl;
    let leading = i32::from(widths.mantissa) - 1;
    [ldl.horizontal, ldl.vertical]
        .iter()
        .all(|number| is_power(number.exponent.saturating_add(leading)))
        && footprint
            .centre
            .iter()
            .all(|centre| *centre < 1 << (TWICE - 1 + u32::from(widths.subpixel)))
}

/// Has a power of two a place in its field?
fn is_power(power: i32) -> bool {
    power >> (POWER - 1) == power >> 31
}

/// First and end of a footprint's box on an axis.
///
/// Sample points from c - 1/2 - e to c - 1/2 + e are the pixels from `first` to `last`, and `first + last` is floor(2
/// c) - 1 or floor(2 c): `how` is 0 or 1, `bound` the first pixel, and the end is cut to the viewport. Where the box
/// begins with pixel 0 `bound` is the end: `how` is 2, or 3 of a negative centre.
#[inline(always)]
fn side(bound: u32, how: u32, twice: u32, limit: u16) -> (u16, u16) {
    if how > 1 {
        return (0, bound as u16);
    }
    let end = twice.wrapping_sub(bound).wrapping_add(how);
    (bound as u16, end.min(limit.into()) as u16)
}

/// The fields of an entry, as they are packed.
#[derive(Default)]
struct Entry {
    /// Of rows, and of columns.
    sides: [Side; 2],
    cutoff: u32,
    /// Of A, C and 1/A.
    mantissa: [u32; 3],
    /// Of A, C and S.
    power: [u32; 3],
    /// Sum of the exponents of A and 1/A, from that of the smallest mantissas on.
    sum: u32,
    shear: u32,
    opacity: u32,
    colour: [u32; 3],
}

/// Centre and box on an axis: see [`side`].
#[derive(Default)]
struct Side {
    bound: u32,
    how: u32,
    /// floor(2 c) without its sign, and the bits of c below.
    twice: u32,
    rest: u32,
}

impl Side {
    #[inline(always)]
    fn new(first: u16, end: u16, centre: i64, below: u32) -> Side {
        let twice = (centre >> below) as u32;
        let (bound, how) = if first == 0 {
            (end, 2 + u32::from(centre < 0))
        } else {
            let shorter = twice.wrapping_sub(first.into());
            (first, u32::from(shorter < u32::from(end)))
        };
        Side {
            bound: bound.into(),
            how,
            twice,
            rest: centre as u32 & ((1 << below) - 1),
        }
    }

    #[inline(always)]
    fn centre(&self, below: u32) -> i64 {
        let twice = (self.twice as i32).wrapping_sub(i32::from(self.how == 3) << TWICE);
        i64::from(twice) << below | i64::from(self.rest)
    }
}

impl Entry {
    #[inline(always)]
    fn new(widths: &Widths, footprint: &Footprint) -> Entry {
        let below = u32::from(widths.subpixel) - 1;
        let leading = i32::from(widths.mantissa) - 1;
        let ldl = &footprint.ldl;
        let mut shear = ldl.shear;
        if !is_power(shear.exponent.saturating_add(leading)) {
            // Too small to move a pixel: above it is kept by the variances.
            (shear.mantissa, shear.exponent) = (0, 0);
        }
        let ([x, y], [first_x, first_y], [end_x, end_y]) =
            (footprint.centre, footprint.first, footprint.end);
        Entry {
            sides: [
                Side::new(first_y, end_y, y, below),
                Side::new(first_x, end_x, x, below),
            ],
            cutoff: footprint.cutoff,
            mantissa: [ldl.horizontal, ldl.vertical, ldl.squared_width].map(|n| n.mantissa as u32),
            power: [ldl.horizontal, ldl.vertical, shear]
                .map(|n| n.exponent.wrapping_add(leading) as u32),
            sum: (ldl.horizontal.exponent)
                .wrapping_add(ldl.squared_width.exponent)
                .wrapping_add(2 * leading + 2) as u32,
            shear: shear.mantissa as u32,
            opacity: footprint.opacity,
            colour: footprint.colour,
        }
    }

    /// Every field in the order of the entry: `field` gets a value and its bits, and returns the value that is kept.
    /// Written once for both directions. What is above a field is not packed.
    #[inline(always)]
    fn fields(&mut self, widths: &Widths, mut field: impl FnMut(u32, u32) -> u32) {
        let mantissa = u32::from(widths.mantissa);
        let below = u32::from(widths.subpixel) - 1;
        let [y, x] = &mut self.sides;
        let mut one = |value: &mut u32, bits| *value = field(*value, bits);
        one(&mut y.bound, BOUND);
        one(&mut x.bound, BOUND);
        one(&mut y.how, HOW);
        one(&mut x.how, HOW);
        one(&mut y.twice, TWICE);
        one(&mut x.twice, TWICE);
        one(&mut y.rest, below);
        one(&mut x.rest, below);
        one(&mut self.cutoff, 32);
        let [horizontal, vertical, squared_width] = &mut self.mantissa;
        one(horizontal, mantissa - 1);
        one(vertical, mantissa - 1);
        one(squared_width, mantissa - 1);
        let [horizontal, vertical, shear] = &mut self.power;
        one(horizontal, POWER);
        one(vertical, POWER);
        one(shear, POWER);
        one(&mut self.sum, 2);
        one(&mut self.shear, mantissa + 1);
        one(&mut self.opacity, 4 + u32::from(widths.peak));
        let colour = u32::from(widths.colour_range() + widths.colour);
        let [red, green, blue] = &mut self.colour;
        one(red, colour);
        one(green, colour);
        one(blue, colour);
    }

    #[inline(always)]
    fn footprint(&self, widths: &Widths, viewport: [u16; 2]) -> Footprint {
        let leading = i32::from(widths.mantissa) - 1;
        let below = u32::from(widths.subpixel) - 1;
        let ([y, x], [columns, rows]) = (&self.sides, viewport);
        let (first_x, end_x) = side(x.bound, x.how, x.twice, columns);
        let (first_y, end_y) = side(y.bound, y.how, y.twice, rows);
        let [horizontal, vertical, squared_width] =
            self.mantissa.map(|low| (low | 1 << leading) as i32);
        let [power, vertical_power, shear_power] =
            self.power.map(|low| extended(low, POWER) - leading);
        let number = |mantissa, exponent| SoftFloat { mantissa, exponent };
        // Not `EMPTY` with other fields, which small processors would copy before.
        Footprint {
            depth: 0,
            centre: [x.centre(below), y.centre(below)],
            first: [first_x, first_y],
            end: [end_x, end_y],
            ldl: Ldl {
                horizontal: number(horizontal, power),
                squared_width: number(squared_width, self.sum as i32 - (2 * leading + 2) - power),
                shear: number(
                    extended(self.shear, u32::from(widths.mantissa) + 1),
                    shear_power,
                ),
                vertical: number(vertical, vertical_power),
            },
            conic: Conic {
                mantissa: [0; 3],
                exponent: 0,
            },
            cutoff: self.cutoff,
            opacity: self.opacity,
            colour: self.colour,
        }
    }
}

/// The low `bits` (1 to 32) of a word as a signed number.
#[inline(always)]
const fn extended(word: u32, bits: u32) -> i32 {
    let spare = 32u32.wrapping_sub(bits);
    (word.wrapping_shl(spare) as i32).wrapping_shr(spare)
}

/// An entry being written or read from its first bit on.
#[derive(Default)]
struct Bits {
    words: [u32; MOST],
    at: u32,
}

impl Bits {
    /// Appends the low `bits` (1 to 32) of a value.
    #[inline(always)]
    fn put(&mut self, value: u32, bits: u32) {
        let value = value & u32::MAX.wrapping_shr(32u32.wrapping_sub(bits));
        let (word, shift) = ((self.at / 32) as usize, self.at % 32);
        if let Some(low) = self.words.get_mut(word) {
            *low |= value << shift;
        }
        if shift + bits > 32
            && let Some(high) = self.words.get_mut(word + 1)
        {
            *high |= value.wrapping_shr(32 - shift);
        }
        self.at += bits;
    }

    /// The next `bits` (1 to 32).
    #[inline(always)]
    fn take(&mut self, bits: u32) -> u32 {
        let (word, shift) = ((self.at / 32) as usize, self.at % 32);
        let mut value = self.words.get(word).copied().unwrap_or_default() >> shift;
        if shift + bits > 32 {
            let high = self.words.get(word + 1).copied().unwrap_or_default();
            value |= high.wrapping_shl(32 - shift);
        }
        self.at += bits;
        value & u32::MAX.wrapping_shr(32u32.wrapping_sub(bits))
    }
}

#[cfg(test)]
mod tests;
