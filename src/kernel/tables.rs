//! The footprint tables of the named designs, made by the compiler: a table belongs to its design.
//!
//! A static takes room in an image only if something refers to it, so that a renderer under one set of rules costs one
//! table.

use super::{FootprintTable, PackedTable, entries, gaussian, pack};
use crate::format::{Classic8, Deep32, Design, Lean18, Micro16, Standard24, Widths};

/// A design whose widths are constants and whose tables of the Gaussian exp(-r/2) therefore are, too.
///
/// A design of one's own states its widths and two statics; a length that is not [`entries`] of the widths does not
/// compile where a [`Renderer`](crate::Renderer) is made of it:
///
/// ```
/// use splatline::format::{Design, Standard24, Widths};
/// use splatline::kernel::{Tabled, entries, gaussian};
///
/// #[derive(Clone, Copy)]
/// struct Mine;
/// impl Mine {
///     const WIDTHS: Widths = Widths { table: 8, subpixel: 12, ..Standard24::WIDTHS };
/// }
/// static TABLE_4: [u32; entries(&Mine::WIDTHS)] = gaussian(&Mine::WIDTHS, 2);
/// static TABLE_16: [u32; entries(&Mine::WIDTHS)] = gaussian(&Mine::WIDTHS, 4);
/// impl Design for Mine {
///     type Lane = i32;
///     const FIXED: Option<Widths> = Some(Mine::WIDTHS);
/// }
/// impl Tabled for Mine {
///     const WIDTHS: Widths = Mine::WIDTHS;
///     const GAUSSIAN_4: &'static [u32] = &TABLE_4;
///     const GAUSSIAN_16: &'static [u32] = &TABLE_16;
/// }
/// let renderer = splatline::Renderer::new(Mine);
/// ```
pub trait Tabled: Design {
    /// What [`Design::widths`] answers.
    const WIDTHS: Widths;
    /// The Gaussian on radial indices 0 to 4, UQ1.weight: `table_range` 2, for cut-offs up to 4
    /// ([`Rules::EWA`](crate::rules::Rules::EWA), [`Rules::SURFACE`](crate::rules::Rules::SURFACE)).
    const GAUSSIAN_4: &'static [u32];
    /// The Gaussian on radial indices 0 to 16, UQ1.weight: `table_range` 4, for all other cut-offs
    /// ([`Rules::GAUSSIAN_3D`](crate::rules::Rules::GAUSSIAN_3D)).
    const GAUSSIAN_16: &'static [u32];
    /// The same packed for the loop of 32-bit words ([`Painter32`](crate::draw::Painter32)); `None` where the design's
    /// products or its table have no room there.
    const PACKED_16: Option<PackedTable<'static>> = None;
}

/// A design's table for `table_range` 2.
#[inline(always)]
pub const fn table_4<D: Tabled>() -> FootprintTable<'static> {
    const { checked::<D>(D::GAUSSIAN_4, 2) }
}

/// A design's table for `table_range` 4.
#[inline(always)]
pub const fn table_16<D: Tabled>() -> FootprintTable<'static> {
    const { checked::<D>(D::GAUSSIAN_16, 4) }
}

/// A table of another length does not compile, nor one for other widths than the design's.
const fn checked<D: Tabled>(entries: &'static [u32], range: u8) -> FootprintTable<'static> {
    if let Some(own) = D::FIXED {
        let widths = &D::WIDTHS;
        assert!(
            own.radial == widths.radial
                && own.table == widths.table
                && own.interpolation == widths.interpolation
                && own.weight == widths.weight,
            "Tabled::WIDTHS must be the design's"
        );
    }
    match FootprintTable::new(entries, &D::WIDTHS, range) {
        Ok(table) => table,
        Err(_) => panic!("a design's table must have kernel::entries(&WIDTHS) entries"),
    }
}

/// Widths without a packed table do not compile.
const fn words<const N: usize>(entries: &[u32], widths: &Widths) -> [u32; N] {
    match pack(entries, widths, 4) {
        Ok(words) => words,
        Err(_) => panic!("the design has no packed table"),
    }
}

const fn packed(words: &'static [u32], widths: &Widths) -> Option<PackedTable<'static>> {
    match PackedTable::new(words, widths, 4) {
        Ok(table) => Some(table),
        Err(_) => None,
    }
}

static CLASSIC8_4: [u32; entries(&Classic8::WIDTHS)] = gaussian(&Classic8::WIDTHS, 2);
static CLASSIC8_16: [u32; entries(&Classic8::WIDTHS)] = gaussian(&Classic8::WIDTHS, 4);
static CLASSIC8_PACKED: [u32; 1 << Classic8::WIDTHS.table] = words(&CLASSIC8_16, &Classic8::WIDTHS);
static MICRO16_4: [u32; entries(&Micro16::WIDTHS)] = gaussian(&Micro16::WIDTHS, 2);
static MICRO16_16: [u32; entries(&Micro16::WIDTHS)] = gaussian(&Micro16::WIDTHS, 4);
static MICRO16_PACKED: [u32; 1 << Micro16::WIDTHS.table] = words(&MICRO16_16, &Micro16::WIDTHS);
static LEAN18_4: [u32; entries(&Lean18::WIDTHS)] = gaussian(&Lean18::WIDTHS, 2);
static LEAN18_16: [u32; entries(&Lean18::WIDTHS)] = gaussian(&Lean18::WIDTHS, 4);
static LEAN18_PACKED: [u32; 1 << Lean18::WIDTHS.table] = words(&LEAN18_16, &Lean18::WIDTHS);
static STANDARD24_4: [u32; entries(&Standard24::WIDTHS)] = gaussian(&Standard24::WIDTHS, 2);
static STANDARD24_16: [u32; entries(&Standard24::WIDTHS)] = gaussian(&Standard24::WIDTHS, 4);
static DEEP32_4: [u32; entries(&Deep32::WIDTHS)] = gaussian(&Deep32::WIDTHS, 2);
static DEEP32_16: [u32; entries(&Deep32::WIDTHS)] = gaussian(&Deep32::WIDTHS, 4);

impl Tabled for Classic8 {
    const WIDTHS: Widths = Classic8::WIDTHS;
    const GAUSSIAN_4: &'static [u32] = &CLASSIC8_4;
    const GAUSSIAN_16: &'static [u32] = &CLASSIC8_16;
    const PACKED_16: Option<PackedTable<'static>> = packed(&CLASSIC8_PACKED, &Classic8::WIDTHS);
}

impl Tabled for Micro16 {
    const WIDTHS: Widths = Micro16::WIDTHS;
    const GAUSSIAN_4: &'static [u32] = &MICRO16_4;
    const GAUSSIAN_16: &'static [u32] = &MICRO16_16;
    const PACKED_16: Option<PackedTable<'static>> = packed(&MICRO16_PACKED, &Micro16::WIDTHS);
}

impl Tabled for Lean18 {
    const WIDTHS: Widths = Lean18::WIDTHS;
    const GAUSSIAN_4: &'static [u32] = &LEAN18_4;
    const GAUSSIAN_16: &'static [u32] = &LEAN18_16;
    const PACKED_16: Option<PackedTable<'static>> = packed(&LEAN18_PACKED, &Lean18::WIDTHS);
}

impl Tabled for Standard24 {
    const WIDTHS: Widths = Standard24::WIDTHS;
    const GAUSSIAN_4: &'static [u32] = &STANDARD24_4;
    const GAUSSIAN_16: &'static [u32] = &STANDARD24_16;
}

impl Tabled for Deep32 {
    const WIDTHS: Widths = Deep32::WIDTHS;
    const GAUSSIAN_4: &'static [u32] = &DEEP32_4;
    const GAUSSIAN_16: &'static [u32] = &DEEP32_16;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packed_tables_at_run_time_are_the_compilers() {
        assert_eq!(words(&MICRO16_16, &Micro16::WIDTHS), MICRO16_PACKED);
        let table = packed(&MICRO16_PACKED, &Micro16::WIDTHS).unwrap();
        assert!(table.is_for(&Micro16::WIDTHS, 4));
    }
}
