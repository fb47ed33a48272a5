//! Stepping: the runs of a footprint, the pixels of a run, and one pixel's opacity and compositing.
//!
//! What an RTL bench compares step by step. Lane words come as 64-bit integers; a design with 32-bit lanes holds their
//! low 32 bits.

use crate::draw::SplatlinePainter;
use crate::memory::{modify, read, write};
use crate::status::{Error, SPLATLINE_OK, code};
use crate::types::*;
use core::mem::MaybeUninit;
use splatline::blend::Pixel;
use splatline::format::{RuntimeWidths, Traversal};
use splatline::math::shift_signed;
use splatline::raster::{BoxSpans, EllipseSpans, Span, Spans};
use splatline::rules::Compositing;

/// Words of the state in SplatlineSpans.
pub const SPLATLINE_ROWS_STATE: usize = 32;

/// Tells prepared rows from memory that never was.
const PREPARED: u32 = 0x5350_4c31;

/// The rows of one footprint being stepped through. Prepared by splatline_spans_begin; the content is private and may
/// be copied.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct SplatlineSpans {
    prepared: u32,
    traversal: u32,
    state: [MaybeUninit<u64>; SPLATLINE_ROWS_STATE],
}

/// Adjacent pixels of one row. The radial index at the first is `radial`; splatline_span_step moves on to the next.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SplatlineSpan {
    /// Radial index at the first pixel, `fraction` fraction bits.
    pub radial: i64,
    /// Difference to the next pixel.
    pub first: i64,
    /// Difference of differences.
    pub second: i64,
    /// Fraction bits of the three numbers.
    pub fraction: u32,
    /// Row.
    pub y: u16,
    /// First column.
    pub x: u16,
    /// Pixels left.
    pub length: u16,
}

type SpanEllipse = EllipseSpans<RuntimeWidths>;

/// Both states consist of integers alone and fit the memory, so that any content of it is a valid state.
const _: () = assert!(
    size_of::<SpanEllipse>() <= 8 * SPLATLINE_ROWS_STATE
        && size_of::<BoxSpans>() <= 8 * SPLATLINE_ROWS_STATE
        && align_of::<SpanEllipse>() <= align_of::<u64>()
        && align_of::<BoxSpans>() <= align_of::<u64>()
);

/// Prepares `rows` (uninitialised memory) for the part of a footprint that lies in `window`.
///
/// # Safety
/// Pointers are null or lead to what their types say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn splatline_spans_begin(
    widths: *const SplatlineWidths,
    footprint: *const SplatlineFootprint,
    traversal: u32,
    window: *const SplatlineWindow,
    rows: *mut SplatlineSpans,
) -> i32 {
    code(|| {
        // SAFETY: the function's own contract.
        let (widths, footprint, window) =
            unsafe { (read(widths)?, read(footprint)?, read(window)?) };
        let (design, footprint, window) = (widths.design()?, footprint.into(), window.into());
        let mut prepared = SplatlineSpans {
            prepared: PREPARED,
            traversal,
            state: [MaybeUninit::uninit(); SPLATLINE_ROWS_STATE],
        };
        let state = prepared.state.as_mut_ptr();
        match crate::types::traversal(traversal)? {
            // SAFETY: the state has the size and alignment of either kind of rows (asserted above).
            Traversal::Spans => unsafe {
                state
                    .cast::<SpanEllipse>()
                    .write(EllipseSpans::new(design, &footprint, &window));
            },
            // SAFETY: as above.
            Traversal::Box => unsafe {
                state
                    .cast::<BoxSpans>()
                    .write(BoxSpans::new(design, &footprint, &window));
            },
        }
        // SAFETY: the function's own contract.
        unsafe { write(rows, prepared) }
    })
}

/// Writes the next run and returns 1, or returns SPLATLINE_OK when there is none.
///
/// # Safety
/// Pointers are null or lead to what their types say; `rows` was prepared by splatline_spans_begin.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn splatline_spans_next(
    rows: *mut SplatlineSpans,
    run: *mut SplatlineSpan,
) -> i32 {
    code(|| {
        // SAFETY: the function's own contract.
        let rows = unsafe { modify(rows) }?;
        if rows.prepared != PREPARED {
            return Err(Error::State);
        }
        let state = rows.state.as_mut_ptr();
        // SAFETY: written by splatline_spans_begin for the same traversal.
        let found = match traversal(rows.traversal)? {
            Traversal::Spans => next_of(unsafe { &mut *state.cast::<SpanEllipse>() }),
            Traversal::Box => next_of(unsafe { &mut *state.cast::<BoxSpans>() }),
        };
        match found {
            // SAFETY: the function's own contract.
            Some(found) => unsafe { write(run, found) }.map(|_| 1),
            None => Ok(SPLATLINE_OK),
        }
    })
}

fn next_of<R: Spans<Lane = i64>>(rows: &mut R) -> Option<SplatlineSpan> {
    let fraction = rows.fraction();
    let Span {
        y,
        x,
        length,
        radial,
        first,
        second,
    } = rows.next_span()?;
    Some(SplatlineSpan {
        radial,
        first,
        second,
        fraction,
        y,
        x,
        length,
    })
}

/// Moves a run on by one pixel: two additions. Returns 1 if the run still has a pixel, SPLATLINE_OK if it is at its
/// end.
///
/// # Safety
/// Pointers are null or lead to what their types say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn splatline_span_step(run: *mut SplatlineSpan) -> i32 {
    code(|| {
        // SAFETY: the function's own contract.
        let run = unsafe { modify(run) }?;
        run.radial = run.radial.wrapping_add(run.first);
        run.first = run.first.wrapping_add(run.second);
        run.x = run.x.saturating_add(1);
        run.length = run.length.saturating_sub(1);
        Ok(i32::from(run.length > 0))
    })
}

/// The opacity of a footprint at a run's present pixel, UQ1.alpha: 0 outside the footprint and where the rules skip it.
/// Writes the opacity and returns 1 inside the footprint, SPLATLINE_OK outside.
///
/// # Safety
/// Pointers are null or lead to what their types say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn splatline_pixel_opacity(
    painter: *const SplatlinePainter,
    footprint: *const SplatlineFootprint,
    run: *const SplatlineSpan,
    opacity: *mut u32,
) -> i32 {
    // SAFETY: the function's own contract; the painter's table is as long as it says.
    code(|| unsafe {
        let (painter, footprint, run) = (read(painter)?, read(footprint)?, read(run)?);
        let (widths, table, blend) = painter.parts()?;
        let drop = i64::from(run.fraction) - i64::from(widths.radial);
        let drop = i32::try_from(drop).map_err(|_| Error::Value)?;
        let radial = shift_signed(run.radial, drop).max(0) as u64;
        let inside = radial < splatline::draw::cutoff_in_lane(footprint.cutoff, widths.radial);
        let alpha = if inside {
            blend.opacity(footprint.opacity, table.weight(radial))
        } else {
            0
        };
        write(opacity, alpha).map(|_| i32::from(inside))
    })
}

/// Composites a splat of an opacity (UQ1.alpha, at most 1) and colour (UQ4.colour, three numbers) into a pixel by the
/// painter's operator. Opacity 0 and, front to back, a finished pixel leave the pixel as it is.
///
/// # Safety
/// Pointers are null or lead to what their types say; `colour` to three numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn splatline_pixel_composite(
    painter: *const SplatlinePainter,
    opacity: u32,
    colour: *const u32,
    pixel: *mut SplatlinePixel,
) -> i32 {
    // SAFETY: the function's own contract; the painter's table is as long as it says.
    code(|| unsafe {
        let (painter, colour) = (read(painter)?, read(colour.cast::<[u32; 3]>())?);
        let pixel = modify(pixel.cast::<Pixel>())?;
        let (widths, _, blend) = painter.parts()?;
        if opacity > 1 << widths.alpha {
            return Err(Error::Value);
        }
        let order = compositing(painter.compositing)?;
        if opacity > 0 && !pixel.is_finished() {
            match order {
                Compositing::FrontToBack => blend.front_to_back(pixel, opacity, colour),
                Compositing::BackToFront => blend.back_to_front(pixel, opacity, colour),
                Compositing::XRay => blend.x_ray(pixel, opacity, colour),
            }
        }
        Ok(SPLATLINE_OK)
    })
}
