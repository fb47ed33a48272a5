//! Setup: splats to footprints.

use crate::memory::{check, check_stride, element, read, slice_mut, write};
use crate::status::{Error, SPLATLINE_OK, code};
use crate::types::{
    SplatlineFootprint, SplatlineRules, SplatlineSplat, SplatlineView, SplatlineWidths,
};
use splatline::setup::{Cull, setup};

/// No footprint: z <= near.
pub const SPLATLINE_CULLED_NEAR: i32 = 1;
/// No footprint: z >= far.
pub const SPLATLINE_CULLED_FAR: i32 = 2;
/// No footprint: it lies or reaches too many pixels away.
pub const SPLATLINE_CULLED_RANGE: i32 = 3;
/// No footprint: it has no area.
pub const SPLATLINE_CULLED_DEGENERATE: i32 = 4;
/// No footprint: its opacity is below what the rules draw.
pub const SPLATLINE_CULLED_TRANSPARENT: i32 = 5;
/// No footprint: its bounding box does not touch the viewport.
pub const SPLATLINE_CULLED_OUTSIDE: i32 = 6;

/// One splat's footprint. SPLATLINE_OK, or why it has none (SPLATLINE_CULLED_...); then nothing is written.
///
/// # Safety
/// Pointers are null or lead to what their types say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn splatline_setup(
    widths: *const SplatlineWidths,
    view: *const SplatlineView,
    rules: *const SplatlineRules,
    splat: *const SplatlineSplat,
    footprint: *mut SplatlineFootprint,
) -> i32 {
    let mut reason = SPLATLINE_OK;
    // SAFETY: the function's own contract; one element has any stride.
    let status = unsafe {
        splatline_setup_many(
            widths,
            view,
            rules,
            splat,
            size_of::<SplatlineSplat>(),
            footprint,
            size_of::<SplatlineFootprint>(),
            &mut reason,
            1,
        )
    };
    if status < 0 { status } else { reason }
}

/// The footprints of `count` splats. `splat_stride` and `footprint_stride` are the bytes from one element to the next.
/// `reasons[i]` is SPLATLINE_OK or why splat i has no footprint; its place in `footprints` is then left as it was.
/// Returns the number of footprints written (at most INT32_MAX splats), or an error, in which case nothing has been
/// written.
///
/// # Safety
/// Pointers are null or lead to what their types, strides and `count` say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn splatline_setup_many(
    widths: *const SplatlineWidths,
    view: *const SplatlineView,
    rules: *const SplatlineRules,
    splats: *const SplatlineSplat,
    splat_stride: usize,
    footprints: *mut SplatlineFootprint,
    footprint_stride: usize,
    reasons: *mut i32,
    count: usize,
) -> i32 {
    code(|| {
        check_stride::<SplatlineSplat>(splat_stride)?;
        check_stride::<SplatlineFootprint>(footprint_stride)?;
        let bytes = count.checked_mul(splat_stride.max(footprint_stride));
        let fits = bytes.is_some_and(|bytes| bytes <= isize::MAX as usize);
        if i32::try_from(count).is_err() || !fits {
            return Err(Error::Size);
        }
        if count > 0 {
            // SAFETY: the function's own contract. Read here, before anything is written, to report null and
            // misalignment.
            unsafe { read(splats) }?;
            check(footprints)?;
        }
        // SAFETY: the function's own contract.
        let (widths, view, rules) = unsafe { (read(widths)?, read(view)?, read(rules)?) };
        // SAFETY: the function's own contract.
        let reasons = unsafe { slice_mut(reasons, count) }?;
        let (design, view, rules) = (widths.design()?, view.view()?, rules.rules()?);
        let mut written = 0;
        for (index, reason) in reasons.iter_mut().enumerate() {
            let splat = element(splats, index, splat_stride);
            let footprint = element(footprints, index, footprint_stride).cast_mut();
            // SAFETY: the function's own contract; strides keep the alignment.
            *reason = match setup(design, &view, &rules, &unsafe { read(splat) }?.into()) {
                // SAFETY: as above.
                Ok(found) => unsafe { write(footprint, (&found).into()) }?,
                Err(reason) => culled(reason),
            };
            written += i32::from(*reason == SPLATLINE_OK);
        }
        Ok(written)
    })
}

fn culled(reason: Cull) -> i32 {
    match reason {
        Cull::Near => SPLATLINE_CULLED_NEAR,
        Cull::Far => SPLATLINE_CULLED_FAR,
        Cull::Range => SPLATLINE_CULLED_RANGE,
        Cull::Degenerate => SPLATLINE_CULLED_DEGENERATE,
        Cull::Transparent => SPLATLINE_CULLED_TRANSPARENT,
        Cull::Outside => SPLATLINE_CULLED_OUTSIDE,
    }
}
