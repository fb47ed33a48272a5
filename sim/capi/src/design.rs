//! Named designs and rules, and the kernel tables that belong to them.

use crate::memory::{read, slice, slice_mut, write};
use crate::status::{Error, SPLATLINE_OK, code};
use crate::types::{SplatlineBlendConstants, SplatlineRules, SplatlineWidths};
use splatline::blend::Blend;
use splatline::format::{Classic8, Deep32, Lean18, Micro16, Standard24, Widths};
use splatline::kernel::{FootprintTable, entries, fill_gaussian};
use splatline::rules::Rules;

/// 8-bit opacity, box traversal, truncation.
pub const SPLATLINE_CLASSIC8: u32 = 0;
/// 18-bit multipliers.
pub const SPLATLINE_LEAN18: u32 = 1;
/// 28-bit mantissas, 32-bit lanes.
pub const SPLATLINE_STANDARD24: u32 = 2;
/// 31-bit magnitudes.
pub const SPLATLINE_DEEP32: u32 = 3;
/// 32-bit words throughout, for microcontrollers.
pub const SPLATLINE_MICRO16: u32 = 4;

/// EWA volume splatting.
pub const SPLATLINE_RULES_EWA: u32 = 0;
/// 3D Gaussian splatting.
pub const SPLATLINE_RULES_3DGS: u32 = 1;

/// Writes the widths of a named design (SPLATLINE_CLASSIC8 ...).
///
/// # Safety
/// Pointers are null or lead to what their types say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn splatline_design(name: u32, widths: *mut SplatlineWidths) -> i32 {
    let named = match name {
        SPLATLINE_CLASSIC8 => &Classic8::WIDTHS,
        SPLATLINE_LEAN18 => &Lean18::WIDTHS,
        SPLATLINE_STANDARD24 => &Standard24::WIDTHS,
        SPLATLINE_DEEP32 => &Deep32::WIDTHS,
        SPLATLINE_MICRO16 => &Micro16::WIDTHS,
        _ => return Error::Value as i32,
    };
    // SAFETY: the function's own contract.
    code(|| unsafe { write(widths, named.into()) })
}

/// Are all widths within their ranges? SPLATLINE_OK, SPLATLINE_ERROR_WIDTHS, or SPLATLINE_ERROR_VALUE of a rounding
/// that there is not.
///
/// # Safety
/// Pointers are null or lead to what their types say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn splatline_design_check(widths: *const SplatlineWidths) -> i32 {
    // SAFETY: the function's own contract.
    code(|| unsafe { read(widths) }?.widths().map(|_| SPLATLINE_OK))
}

/// Writes named rules (SPLATLINE_RULES_EWA or SPLATLINE_RULES_3DGS).
///
/// # Safety
/// Pointers are null or lead to what their types say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn splatline_rules(name: u32, rules: *mut SplatlineRules) -> i32 {
    let named = match name {
        SPLATLINE_RULES_EWA => &Rules::EWA,
        SPLATLINE_RULES_3DGS => &Rules::GAUSSIAN_3D,
        _ => return Error::Value as i32,
    };
    // SAFETY: the function's own contract.
    code(|| unsafe { write(rules, named.into()) })
}

/// Writes the constants of front-to-back compositing: what a circuit of the design compares with under these rules.
///
/// # Safety
/// Pointers are null or lead to what their types say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn splatline_blend_constants(
    widths: *const SplatlineWidths,
    rules: *const SplatlineRules,
    constants: *mut SplatlineBlendConstants,
) -> i32 {
    // SAFETY: the function's own contract.
    code(|| unsafe {
        let (widths, rules) = (read(widths)?, read(rules)?.rules()?);
        let blend = Blend::new(&widths.widths()?, &rules);
        write(constants, blend.constants().into())
    })
}

/// Writes the number of entries of a design's footprint table.
///
/// # Safety
/// Pointers are null or lead to what their types say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn splatline_table_entries(
    widths: *const SplatlineWidths,
    count: *mut usize,
) -> i32 {
    // SAFETY: the function's own contract.
    code(|| unsafe { write(count, entries(&read(widths)?.widths()?)) })
}

/// Fills a footprint table with the Gaussian exp(-r/2), entries in UQ1.weight, for `table_range` of the rules (0 to 4,
/// at most the design's `table`). `count` must be what splatline_table_entries says.
///
/// # Safety
/// Pointers are null or lead to what their types say; `table` to `count` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn splatline_table_gaussian(
    widths: *const SplatlineWidths,
    table_range: u32,
    table: *mut u32,
    count: usize,
) -> i32 {
    // SAFETY: the function's own contract.
    code(|| unsafe {
        let widths = read(widths)?.widths()?;
        let range = checked_range(&widths, table_range)?;
        let memory = slice_mut(table, count)?;
        FootprintTable::new(memory, &widths, range).map_err(|_| Error::Size)?;
        fill_gaussian(memory, &widths, range);
        Ok(SPLATLINE_OK)
    })
}

/// Looks the kernel up at `radial` (UQ4.radial) and writes it in UQ1.weight.
///
/// # Safety
/// Pointers are null or lead to what their types say; `table` to `count` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn splatline_table_weight(
    widths: *const SplatlineWidths,
    table_range: u32,
    table: *const u32,
    count: usize,
    radial: u64,
    weight: *mut u32,
) -> i32 {
    // SAFETY: the function's own contract.
    code(|| unsafe {
        let table = footprint_table(&read(widths)?.widths()?, table_range, table, count)?;
        write(weight, table.weight(radial))
    })
}

/// # Safety
/// `table` is null or leads to `count` numbers.
pub(crate) unsafe fn footprint_table<'a>(
    widths: &Widths,
    range: u32,
    table: *const u32,
    count: usize,
) -> Result<FootprintTable<'a>, Error> {
    let range = checked_range(widths, range)?;
    // SAFETY: the function's own contract.
    let memory = unsafe { slice(table, count) }?;
    FootprintTable::new(memory, widths, range).map_err(|_| Error::Size)
}

/// A table needs at least one interval per unit of its range.
fn checked_range(widths: &Widths, range: u32) -> Result<u8, Error> {
    if range > 4 || range > u32::from(widths.table) {
        return Err(Error::Value);
    }
    Ok(range as u8)
}
