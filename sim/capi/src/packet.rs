//! The footprint packet: its layout, and footprints to packets and back.

use crate::memory::{read, slice, slice_mut, write};
use crate::status::{Error, SPLATLINE_OK, code};
use crate::types::{SplatlineFootprint, SplatlineWidths};
use core::ffi::c_char;
use splatline::footprint::Footprint;
use splatline::footprint::packet::{FIELDS, Layout, WORDS};

/// Words of the longest packet of any design.
pub const SPLATLINE_LONGEST_PACKET: usize = 18;
/// Fields of a packet, those of width 0 included.
pub const SPLATLINE_PACKET_FIELDS: usize = 25;
/// Bytes of a field's name, with the final zero.
pub const SPLATLINE_FIELD_NAME: usize = 24;

const _: () = assert!(SPLATLINE_LONGEST_PACKET == WORDS && SPLATLINE_PACKET_FIELDS == FIELDS);

/// Where a field lies in the packet.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SplatlineField {
    /// Name, ends with a zero.
    pub name: [c_char; SPLATLINE_FIELD_NAME],
    /// First bit, counted from bit 0 of word 0.
    pub offset: u16,
    /// Bits; 0 in a packet that does without the field.
    pub width: u8,
    /// 1: two's complement.
    pub is_signed: u8,
    /// Fraction bits.
    pub fraction: u8,
}

/// Writes the number of 32-bit words of a design's packet, which has what `traversal` (SPLATLINE_TRAVERSAL_...) reads:
/// no depth, which whoever sorts has already, and the coefficients of that traversal alone.
///
/// # Safety
/// Pointers are null or lead to what their types say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn splatline_packet_words(
    widths: *const SplatlineWidths,
    traversal: u32,
    words: *mut usize,
) -> i32 {
    // SAFETY: the function's own contract.
    code(|| unsafe { write(words, layout(widths, traversal)?.words()) })
}

/// Describes field `index` (below SPLATLINE_PACKET_FIELDS) of a design's packet.
///
/// # Safety
/// Pointers are null or lead to what their types say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn splatline_packet_field(
    widths: *const SplatlineWidths,
    traversal: u32,
    index: usize,
    field: *mut SplatlineField,
) -> i32 {
    // SAFETY: the function's own contract.
    code(|| unsafe {
        let layout = layout(widths, traversal)?;
        let found = layout.fields().get(index).ok_or(Error::Size)?;
        let mut name = [0; SPLATLINE_FIELD_NAME];
        let places = name.iter_mut().take(SPLATLINE_FIELD_NAME - 1);
        for (to, from) in places.zip(found.name.bytes()) {
            *to = from as c_char;
        }
        let described = SplatlineField {
            name,
            offset: found.offset,
            width: found.width,
            is_signed: found.signed.into(),
            fraction: found.fraction,
        };
        write(field, described)
    })
}

/// Serialises a footprint into exactly `count` words (see splatline_packet_words). Values too wide for their field are
/// cut.
///
/// # Safety
/// Pointers are null or lead to what their types say; `words` to `count` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn splatline_packet_encode(
    widths: *const SplatlineWidths,
    traversal: u32,
    footprint: *const SplatlineFootprint,
    words: *mut u32,
    count: usize,
) -> i32 {
    // SAFETY: the function's own contract.
    code(|| unsafe {
        let layout = layout(widths, traversal)?;
        let footprint: Footprint = read(footprint)?.into();
        let words = slice_mut(words, exactly(&layout, count)?)?;
        for (to, from) in words.iter_mut().zip(layout.encode(&footprint)) {
            *to = from;
        }
        Ok(SPLATLINE_OK)
    })
}

/// Reads a packet of exactly `count` words; what it does not have is 0.
///
/// # Safety
/// Pointers are null or lead to what their types say; `words` to `count` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn splatline_packet_decode(
    widths: *const SplatlineWidths,
    traversal: u32,
    words: *const u32,
    count: usize,
    footprint: *mut SplatlineFootprint,
) -> i32 {
    // SAFETY: the function's own contract.
    code(|| unsafe {
        let layout = layout(widths, traversal)?;
        let words = slice(words, exactly(&layout, count)?)?;
        let mut packet = [0; WORDS];
        for (to, from) in packet.iter_mut().zip(words) {
            *to = *from;
        }
        let found = layout.decode(&packet).map_err(|_| Error::PacketVersion)?;
        write(footprint, (&found).into())
    })
}

/// # Safety
/// `widths` is null or leads to widths.
unsafe fn layout(widths: *const SplatlineWidths, traversal: u32) -> Result<Layout, Error> {
    // SAFETY: the function's own contract.
    let widths = unsafe { read(widths) }?.widths()?;
    Ok(Layout::new(&widths, crate::types::traversal(traversal)?))
}

fn exactly(layout: &Layout, count: usize) -> Result<usize, Error> {
    if count == layout.words() {
        Ok(count)
    } else {
        Err(Error::Size)
    }
}
