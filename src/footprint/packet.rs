//! The packet's serial form: every field that a traversal reads at a fixed bit position, for a design's widths.
//!
//! | field | who reads it |
//! |---|---|
//! | version | whoever takes a packet |
//! | depth | nobody: what sorts has the key beside the packet. [`Layout::with_depth`] keeps it where sheets or depth planes are drawn from packets |
//! | centre, first, end | either traversal |
//! | horizontal, squared_width, shear, vertical | the traversal `spans` |
//! | conic | the traversal `box` |
//! | cutoff, peak, red, green, blue | the pixels |
//!
//! Fields that a traversal does not read have width 0 and come back as 0 (mantissas, exponents and the key). The others
//! follow each other without padding, least significant bit first, in 32-bit words, in the order of [`Layout::fields`];
//! unused bits of the last word are 0. Mantissas of variances are unsigned, of the shear and the mixed conic
//! coefficient signed; exponents are signed 10-bit; centres are signed. `docs/results/packet.md` is this table,
//! printed.
//!
//! The format is versioned by [`VERSION`], which is the packet's first field.

use super::depth::KEY_BITS;
use super::{Conic, Footprint, Ldl};
use crate::format::{Traversal, Widths};
use crate::math::SoftFloat;

/// Version of the layout.
///
/// 1 had depths in UQ9.23, 2 as sort keys with an exponent; 3 has only the fields that a traversal reads.
pub const VERSION: u32 = 3;

/// Number of fields, those of width 0 included.
pub const FIELDS: usize = 25;

/// Words of the longest packet that the width ranges allow.
pub const WORDS: usize = 18;

/// Places of the depth, of the coefficients of `spans` and of those of `box` among the fields.
const DEPTH: usize = 1;
const OF_SPANS: core::ops::Range<usize> = 8..16;
const OF_BOX: core::ops::Range<usize> = 16..20;

/// One field of the packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    /// Name, as in [`Footprint`].
    pub name: &'static str,
    /// First bit, counted from bit 0 of word 0.
    pub offset: u16,
    /// Bits; 0 in a packet that does without the field.
    pub width: u8,
    /// Two's complement?
    pub signed: bool,
    /// Fraction bits; mantissas and exponents are integers.
    pub fraction: u8,
}

/// Where every field lies, for one design.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    fields: [Field; FIELDS],
}

/// A serialised footprint; `Layout::words` of it are used.
pub type Packet = [u32; WORDS];

/// A packet of another version.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VersionError {
    /// The version found.
    pub found: u32,
}

impl Layout {
    /// The layout for a design's widths and its traversal.
    pub const fn new(widths: &Widths, traversal: Traversal) -> Layout {
        Layout::of(widths, traversal, false)
    }

    /// The same with the depth, for techniques that compare depths of footprints that they get as packets.
    pub const fn with_depth(widths: &Widths, traversal: Traversal) -> Layout {
        Layout::of(widths, traversal, true)
    }

    const fn of(widths: &Widths, traversal: Traversal, depth: bool) -> Layout {
        let mantissa = widths.mantissa;
        let (subpixel, peak, colour) = (widths.subpixel, widths.peak, widths.colour);
        let range = widths.colour_range();
        let mut fields = [
            unsigned("version", 4, 0),
            unsigned("depth", KEY_BITS as u8, 0),
            signed("centre_u", 28 + subpixel, subpixel),
            signed("centre_v", 28 + subpixel, subpixel),
            unsigned("first_column", 16, 0),
            unsigned("first_row", 16, 0),
            unsigned("end_column", 16, 0),
            unsigned("end_row", 16, 0),
            unsigned("horizontal_mantissa", mantissa, 0),
            signed("horizontal_exponent", 10, 0),
            unsigned("squared_width_mantissa", mantissa, 0),
            signed("squared_width_exponent", 10, 0),
            signed("shear_mantissa", mantissa + 1, 0),
            signed("shear_exponent", 10, 0),
            unsigned("vertical_mantissa", mantissa, 0),
            signed("vertical_exponent", 10, 0),
            unsigned("conic_a", mantissa, 0),
            signed("conic_b", mantissa + 1, 0),
            unsigned("conic_c", mantissa, 0),
            signed("conic_exponent", 10, 0),
            unsigned("cutoff", 32, 28),
            unsigned("peak", 4 + peak, peak),
            unsigned("red", range + colour, colour),
            unsigned("green", range + colour, colour),
            unsigned("blue", range + colour, colour),
        ];
        let absent = match traversal {
            Traversal::Spans => OF_BOX,
            Traversal::Box => OF_SPANS,
        };
        let mut offset = 0;
        let mut i = 0;
        while i < FIELDS {
            if i >= absent.start && i < absent.end || i == DEPTH && !depth {
                fields[i].width = 0;
            }
            fields[i].offset = offset;
            offset += fields[i].width as u16;
            i += 1;
        }
        Layout { fields }
    }

    /// All fields in order; those of width 0 are not in the packet.
    pub const fn fields(&self) -> &[Field; FIELDS] {
        &self.fields
    }

    /// Bits of a packet.
    pub const fn bits(&self) -> usize {
        let last = self.fields[FIELDS - 1];
        last.offset as usize + last.width as usize
    }

    /// 32-bit words of a packet.
    pub const fn words(&self) -> usize {
        self.bits().div_ceil(32)
    }

    /// Serialises what the packet has of a footprint. A value too wide for its field is cut to its low bits; setup
    /// produces none.
    pub fn encode(&self, footprint: &Footprint) -> Packet {
        let mut packet = [0; WORDS];
        for (field, value) in self.fields.iter().zip(values(footprint)) {
            put(&mut packet, field, value);
        }
        packet
    }

    /// Reads a footprint back, 0 where the packet has no field; defined for every bit pattern of the packet's version.
    pub fn decode(&self, packet: &Packet) -> Result<Footprint, VersionError> {
        let mut read = self.fields.iter().map(|field| get(packet, field));
        let mut next = || read.next().unwrap_or_default();
        let found = next() as u32;
        if found != VERSION {
            return Err(VersionError { found });
        }
        let depth = next() as u64;
        let centre = [next(), next()];
        let first = [next() as u16, next() as u16];
        let last = [next() as u16, next() as u16];
        let mut number = || SoftFloat {
            mantissa: next() as i32,
            exponent: next() as i32,
        };
        let scan = Ldl {
            horizontal: number(),
            squared_width: number(),
            shear: number(),
            vertical: number(),
        };
        let mantissa = [next() as i32, next() as i32, next() as i32];
        let conic = Conic {
            mantissa,
            exponent: next() as i32,
        };
        let cutoff = next() as u32;
        let peak = next() as u32;
        let colour = [next() as u32, next() as u32, next() as u32];
        Ok(Footprint {
            depth,
            centre,
            first,
            end: last,
            ldl: scan,
            conic,
            cutoff,
            opacity: peak,
            colour,
        })
    }
}

/// A footprint's values in the order of the fields.
fn values(footprint: &Footprint) -> [i64; FIELDS] {
    let Footprint {
        centre,
        first,
        end: last,
        ldl: scan,
        conic,
        colour,
        ..
    } = footprint;
    let [mantissa_a, mantissa_b, mantissa_c] = conic.mantissa.map(i64::from);
    [
        VERSION.into(),
        footprint.depth as i64,
        centre[0],
        centre[1],
        first[0].into(),
        first[1].into(),
        last[0].into(),
        last[1].into(),
        scan.horizontal.mantissa.into(),
        scan.horizontal.exponent.into(),
        scan.squared_width.mantissa.into(),
        scan.squared_width.exponent.into(),
        scan.shear.mantissa.into(),
        scan.shear.exponent.into(),
        scan.vertical.mantissa.into(),
        scan.vertical.exponent.into(),
        mantissa_a,
        mantissa_b,
        mantissa_c,
        conic.exponent.into(),
        footprint.cutoff.into(),
        footprint.opacity.into(),
        colour[0].into(),
        colour[1].into(),
        colour[2].into(),
    ]
}

/// A field touches at most three words: at most 52 bits from any offset.
fn put(packet: &mut Packet, field: &Field, value: i64) {
    let bits = (value as u64 & mask(field.width)) as u128;
    let placed = bits << (field.offset % 32);
    for (word, part) in packet
        .iter_mut()
        .skip(usize::from(field.offset / 32))
        .zip([0, 32, 64])
    {
        *word |= (placed >> part) as u32;
    }
}

fn get(packet: &Packet, field: &Field) -> i64 {
    let mut placed = 0u128;
    for (word, part) in packet
        .iter()
        .skip(usize::from(field.offset / 32))
        .zip([0, 32, 64])
    {
        placed |= u128::from(*word) << part;
    }
    let bits = (placed >> (field.offset % 32)) as u64 & mask(field.width);
    if field.signed {
        let spare = 64 - u32::from(field.width);
        ((bits.wrapping_shl(spare)) as i64).wrapping_shr(spare)
    } else {
        bits as i64
    }
}

const fn mask(width: u8) -> u64 {
    (1 << width) - 1
}

const fn unsigned(name: &'static str, width: u8, fraction: u8) -> Field {
    Field {
        name,
        offset: 0,
        width,
        signed: false,
        fraction,
    }
}

const fn signed(name: &'static str, width: u8, fraction: u8) -> Field {
    Field {
        name,
        offset: 0,
        width,
        signed: true,
        fraction,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::Micro16;

    #[test]
    fn layouts_count_their_words() {
        for layout in [
            Layout::new(&Micro16::WIDTHS, Traversal::Spans),
            Layout::with_depth(&Micro16::WIDTHS, Traversal::Box),
        ] {
            let bits: usize = layout
                .fields()
                .iter()
                .map(|field| usize::from(field.width))
                .sum();
            assert_eq!((layout.bits(), layout.words()), (bits, bits.div_ceil(32)));
            let depth = layout.fields()[DEPTH];
            assert_eq!((depth.name, depth.fraction), ("depth", 0));
        }
    }
}
