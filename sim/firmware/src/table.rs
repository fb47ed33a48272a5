//! The footprint table of the images, made by the compiler: entries in the kernel's own form, and packed for the pixel
//! loops.

use crate::design::Firmware16;
use crate::scene::RULES;
use splatline::kernel::{PackedTable, gaussian, pack};

/// Intervals of the footprint table.
pub const INTERVALS: usize = 1 << Firmware16::WIDTHS.table;

/// The footprint table, made by the compiler.
pub static ENTRIES: [u32; INTERVALS + 1] = gaussian(&Firmware16::WIDTHS, RULES.table_range);

/// The same packed for the pixel loop.
pub static WORDS: [u32; INTERVALS] = {
    match pack(&ENTRIES, &Firmware16::WIDTHS, RULES.table_range) {
        Ok(words) => words,
        Err(_) => panic!("the widths have no packed table"),
    }
};

/// The packed table.
pub const PACKED: PackedTable<'static> = {
    match PackedTable::new(&WORDS, &Firmware16::WIDTHS, RULES.table_range) {
        Ok(table) => table,
        Err(_) => panic!("packed for other widths"),
    }
};
