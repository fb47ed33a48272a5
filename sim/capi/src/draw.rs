//! Whole footprints into a window of pixels that the caller lends.

use crate::design::footprint_table;
use crate::memory::{read, slice_mut, write};
use crate::status::{Error, SPLATLINE_OK, code};
use crate::types::*;
use splatline::blend::{Blend, Pixel};
use splatline::draw::{Coverage, Painter};
use splatline::format::Widths;
use splatline::kernel::FootprintTable;
use splatline::raster::Window;
use splatline::target::Target;

/// Everything that is constant for a picture. The table stays the caller's and must outlive every use of the painter.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct SplatlinePainter {
    /// The design.
    pub widths: SplatlineWidths,
    /// The rules of blending.
    pub rules: SplatlineRules,
    /// SPLATLINE_FRONT_TO_BACK, SPLATLINE_BACK_TO_FRONT or SPLATLINE_XRAY.
    pub compositing: u32,
    /// SPLATLINE_TRAVERSAL_BOX or SPLATLINE_TRAVERSAL_SPANS.
    pub traversal: u32,
    /// Footprint table of the design and the rules.
    pub table: *const u32,
    /// Its entries; must be what splatline_table_entries says.
    pub table_count: usize,
}

/// Pixels that a drawing touched.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SplatlineCoverage {
    /// Pixels at which a radial index was computed.
    pub visited: u64,
    /// Of these, pixels inside a footprint.
    pub covered: u64,
    /// Of the covered ones, pixels that had already finished.
    pub finished: u64,
}

const _: () = assert!(
    size_of::<SplatlinePixel>() == size_of::<Pixel>()
        && align_of::<SplatlinePixel>() == align_of::<Pixel>()
);

impl SplatlinePainter {
    /// # Safety
    /// `table` is null or leads to `table_count` numbers.
    pub(crate) unsafe fn parts(&self) -> Result<(Widths, FootprintTable<'_>, Blend), Error> {
        let widths = self.widths.widths()?;
        let rules = self.rules.rules()?;
        let range = self.rules.table_range;
        // SAFETY: the function's own contract.
        let table = unsafe { footprint_table(&widths, range, self.table, self.table_count) }?;
        Ok((widths, table, Blend::new(&widths, &rules)))
    }
}

/// Makes `count` pixels transparent black.
///
/// # Safety
/// Pointers are null or lead to what their types say; `pixels` to `count` pixels.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn splatline_clear(
    widths: *const SplatlineWidths,
    pixels: *mut SplatlinePixel,
    count: usize,
) -> i32 {
    // SAFETY: the function's own contract.
    code(|| unsafe {
        let clear = Pixel::clear(&read(widths)?.widths()?);
        slice_mut(pixels.cast::<Pixel>(), count)?.fill(clear);
        Ok(SPLATLINE_OK)
    })
}

/// Draws one footprint into `window`. Row y of the window begins at pixel `(y - window.first[1]) * stride`; `stride`
/// counts pixels and is at least the window's width; `count` pixels are lent. Footprints must come in the compositing's
/// order. `coverage` may be null; otherwise it is written.
///
/// # Safety
/// Pointers are null or lead to what their types say; `pixels` to `count` pixels.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn splatline_draw(
    painter: *const SplatlinePainter,
    footprint: *const SplatlineFootprint,
    window: *const SplatlineWindow,
    pixels: *mut SplatlinePixel,
    count: usize,
    stride: usize,
    coverage: *mut SplatlineCoverage,
) -> i32 {
    // SAFETY: the function's own contract.
    code(|| unsafe {
        let (painter, footprint, window) = (read(painter)?, read(footprint)?, read(window)?);
        let pixels = slice_mut(pixels.cast::<Pixel>(), count)?;
        let drawn = draw_into(painter, footprint, &window.into(), pixels, stride)?;
        if coverage.is_null() {
            return Ok(SPLATLINE_OK);
        }
        let counted = SplatlineCoverage {
            visited: drawn.visited,
            covered: drawn.covered,
            finished: drawn.finished,
        };
        write(coverage, counted)
    })
}

/// # Safety
/// The painter's table is as long as it says.
unsafe fn draw_into(
    painter: &SplatlinePainter,
    footprint: &SplatlineFootprint,
    window: &Window,
    pixels: &mut [Pixel],
    stride: usize,
) -> Result<Coverage, Error> {
    // SAFETY: the function's own contract.
    let (_, table, _) = unsafe { painter.parts() }?;
    if window.end[0].saturating_sub(window.first[0]) as usize > stride {
        return Err(Error::Stride);
    }
    let mut target = Target::new(pixels, *window, stride).map_err(|_| Error::Size)?;
    let (design, rules) = (painter.widths.design()?, painter.rules.rules()?);
    let (order, traversal) = (
        compositing(painter.compositing)?,
        traversal(painter.traversal)?,
    );
    let kernel_painter = Painter::new(design, &rules, table, order, traversal);
    Ok(kernel_painter.draw(&footprint.into(), &mut target))
}
