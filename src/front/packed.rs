//! A display list of packed footprints: what spans read, bit by bit, in drawing order.
//!
//! A [`Footprint`] has 104 bytes, and a list of them a number each for the order. Here an entry has neither conic nor depth and no bit more
//! than the design's widths: 44 bytes for [`Micro16`](crate::Micro16). There is no order beside it, because splats are sorted before they are
//! set up: the keys of that sort lie at the end of the same memory, and the footprints take their place as they come.
//!
//! The first word of an entry is its rows, so that a strip passes over a footprint of other strips with one load and two comparisons. Lists by
//! strip would save these for two bytes more per footprint and strip.

use super::list::Footprints;
use crate::footprint::Footprint;
use crate::format::{Design, Widths};
use crate::raster::Window;
use crate::rules::Compositing;

/// Words of the longest entry that the width ranges allow.
const MOST: usize = 16;

/// Words of a key: depth, and the number of a splat.
pub(super) const KEY: usize = 3;

/// Words of an entry, for a design's widths.
pub const fn packed_words(widths: &Widths) -> usize {
    let [mantissa, subpixel, peak, colour] = [
        widths.mantissa as usize,
        widths.subpixel as usize,
        widths.peak as usize,
        widths.colour as usize,
    ];
    let bounds = 4 * 16 + 32;
    let ldl = 4 * (mantissa + 10) + 1;
    (bounds + ldl + 2 * (28 + subpixel) + (4 + peak) + 3 * (4 + colour)).div_ceil(32)
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
}

impl<'a, D: Design> PackedList<'a, D> {
    /// An empty list with room for one footprint of the design per [`packed_words`] words. What they hold is of no account.
    pub fn new(design: D, words: &'a mut [u32]) -> Self {
        PackedList {
            design,
            words,
            used: 0,
        }
    }

    /// A list of `used` footprints that [`into_words`](PackedList::into_words) left in these words; `None` if they have no room for as many.
    pub fn filled(design: D, words: &'a mut [u32], used: usize) -> Option<Self> {
        let list = PackedList {
            design,
            words,
            used,
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

    /// The footprint at a place in drawing order, without its conic and depth.
    pub fn footprint(&self, place: usize) -> Option<Footprint> {
        (place < self.used).then(|| self.decode(self.at(place)))
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
    fn decode(&self, entry: &[u32]) -> Footprint {
        let mut bits = Bits::default();
        for (word, packed) in bits.words.iter_mut().zip(entry) {
            *word = *packed;
        }
        let mut footprint = Footprint::EMPTY;
        fields(&mut footprint, &self.design.widths(), |_, width| {
            bits.take(width)
        });
        footprint
    }

    /// Adds a footprint behind all others, which must leave the words from `end` on alone. Where there is no room the list stays as it is.
    #[inline(never)]
    pub(super) fn push(&mut self, footprint: &Footprint, end: usize) -> Option<()> {
        let start = self.used.checked_mul(self.entry())?;
        let stop = start
            .checked_add(self.entry())
            .filter(|stop| *stop <= end)?;
        let place = self.words.get_mut(start..stop)?;
        let mut bits = Bits::default();
        let mut copy = *footprint;
        fields(&mut copy, &self.design.widths(), |value, width| {
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
        let used = self.used.saturating_mul(self.entry());
        let entries = self.words.get(..used).unwrap_or_default();
        let mut entries = entries.chunks_exact(self.entry().max(1));
        let backwards = compositing == Compositing::BackToFront;
        while let Some(entry) = if backwards {
            entries.next_back()
        } else {
            entries.next()
        } {
            let rows = entry.first().copied().unwrap_or_default();
            let (first, end) = (rows as u16, (rows >> 16) as u16);
            if first < window.end[1] && end > window.first[1] {
                draw(&self.decode(entry));
            }
        }
    }
}

/// Low bits of a centre, which are a field of their own: of 28 + subpixel bits up to 52.
const CENTRE_LOW: u32 = 20;

/// Every field that spans read, in the order of the entry: `field` gets a value and its bits, and returns the value that the footprint keeps.
/// Written once for both directions. A value too wide for its field is cut to its low bits; setup makes none.
#[inline(always)]
fn fields(footprint: &mut Footprint, widths: &Widths, mut field: impl FnMut(u32, u32) -> u32) {
    let mantissa = u32::from(widths.mantissa);
    for axis in [1, 0] {
        let (Some(first), Some(end)) = (footprint.first.get_mut(axis), footprint.end.get_mut(axis))
        else {
            continue;
        };
        *first = field((*first).into(), 16) as u16;
        *end = field((*end).into(), 16) as u16;
    }
    footprint.cutoff = field(footprint.cutoff, 32);
    let ldl = &mut footprint.ldl;
    for (number, bits) in [
        (&mut ldl.horizontal, mantissa),
        (&mut ldl.squared_width, mantissa),
        (&mut ldl.vertical, mantissa),
        (&mut ldl.shear, mantissa + 1),
    ] {
        number.mantissa = field(number.mantissa as u32, bits) as i32;
        number.exponent = extended(field(number.exponent as u32, 10), 10);
    }
    // The others have no sign.
    ldl.shear.mantissa = extended(ldl.shear.mantissa as u32, mantissa + 1);
    let high = 28 + u32::from(widths.subpixel) - CENTRE_LOW;
    for centre in &mut footprint.centre {
        let low = field(*centre as u32 & ((1 << CENTRE_LOW) - 1), CENTRE_LOW);
        let rest = field((*centre >> CENTRE_LOW) as u32, high);
        *centre = i64::from(extended(rest, high)) << CENTRE_LOW | i64::from(low);
    }
    footprint.opacity = field(footprint.opacity, 4 + u32::from(widths.peak));
    for channel in &mut footprint.colour {
        *channel = field(*channel, 4 + u32::from(widths.colour));
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
mod tests {
    use super::*;
    use crate::format::{Classic8, Deep32, Lean18, Micro16, RuntimeWidths, Standard24};
    extern crate std;
    use std::vec;
    use std::vec::Vec;

    /// Fields of all bits, and of none.
    fn extreme(widths: &Widths, ones: bool) -> Footprint {
        let mut footprint = Footprint::EMPTY;
        fields(&mut footprint, widths, |_, bits| {
            if ones { u32::MAX >> (32 - bits) } else { 0 }
        });
        footprint
    }

    #[test]
    fn entries_have_room_for_their_fields_and_no_more() {
        let named = [
            Classic8::WIDTHS,
            Micro16::WIDTHS,
            Lean18::WIDTHS,
            Standard24::WIDTHS,
            Deep32::WIDTHS,
        ];
        let shapes = (8..=31u8).flat_map(|mantissa| (4..=28u8).map(move |bits| (mantissa, bits)));
        let drawn = shapes.map(|(mantissa, bits)| Widths {
            mantissa,
            peak: bits,
            colour: 28 - bits + 4,
            subpixel: 2 + (bits * 7 + mantissa) % 23,
            ..Standard24::WIDTHS
        });
        for widths in named.into_iter().chain(drawn) {
            let (mut sum, mut footprint) = (0, Footprint::EMPTY);
            fields(&mut footprint, &widths, |value, bits| {
                sum += bits as usize;
                value
            });
            assert_eq!(packed_words(&widths), sum.div_ceil(32), "{widths:?}");
        }
    }

    #[test]
    fn every_bit_of_a_field_is_kept() {
        for widths in [Micro16::WIDTHS, Standard24::WIDTHS, Deep32::WIDTHS] {
            let design = RuntimeWidths::<i64>::for_lanes(widths).unwrap();
            let mut words = vec![u32::MAX; 3 * packed_words(&widths)];
            let mut list = PackedList::new(design, &mut words);
            assert!(list.is_empty() && list.footprint(0).is_none());
            let mut entries = [
                extreme(&widths, true),
                extreme(&widths, false),
                extreme(&widths, true),
            ];
            entries[1].ldl.horizontal.exponent = 300;
            entries[1].ldl.shear.exponent = -300;
            for (place, entry) in entries.iter().enumerate() {
                assert_eq!(list.push(entry, 3 * packed_words(&widths)), Some(()));
                assert_eq!(list.footprint(place + 1), None);
            }
            assert!(list.push(&entries[0], usize::MAX).is_none());
            for (place, entry) in entries.iter().enumerate() {
                assert_eq!(list.footprint(place), Some(*entry), "{place}");
            }
            let used = list.len();
            let words = list.into_words();
            assert_eq!(
                PackedList::filled(design, words, used)
                    .unwrap()
                    .footprint(2),
                Some(entries[2])
            );
            assert!(PackedList::filled(design, words, used + 1).is_none());
        }
    }

    /// Every list shows a strip exactly those footprints that have rows in it.
    #[test]
    fn strips_visit_their_own_footprints() {
        let with_rows = |[first, end]: [u16; 2]| Footprint {
            first: [0, first],
            end: [1, end],
            ..Footprint::EMPTY
        };
        let rows = [[0, 3], [2, 5], [4, 5], [3, 40_000], [5, 8]];
        let mut words = vec![0; rows.len() * packed_words(&Micro16::WIDTHS)];
        let mut packed = PackedList::new(Micro16, &mut words);
        let mut list = crate::BoundedList::<5>::new();
        for rows in rows {
            packed.push(&with_rows(rows), usize::MAX).unwrap();
            crate::front::DisplayList::push(&mut list, &with_rows(rows)).unwrap();
        }
        let small = (0..9).flat_map(|first| (first + 1..10).map(move |end| (first, end)));
        for (first, end) in small.chain([(39_999, 40_000), (40_000, 40_001)]) {
            let window = Window {
                first: [0, first],
                end: [1, end],
            };
            let meets = |rows: &&[u16; 2]| (rows[0]..rows[1]).any(|y| (first..end).contains(&y));
            let expected: Vec<[u16; 2]> = rows.iter().filter(meets).copied().collect();
            let mut seen = [Vec::new(), Vec::new()];
            let [a, b] = &mut seen;
            let order = Compositing::FrontToBack;
            packed.visit(&window, order, |footprint| {
                a.push([footprint.first[1], footprint.end[1]])
            });
            list.visit(&window, order, |footprint| {
                b.push([footprint.first[1], footprint.end[1]])
            });
            assert_eq!(seen, [expected.clone(), expected], "{first} {end}");
        }
    }
}
