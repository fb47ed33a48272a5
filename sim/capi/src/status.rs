//! Integer status codes: negative errors, 0, positive answers.

/// Success; for `splatline_spans_next`: no more runs.
pub const SPLATLINE_OK: i32 = 0;
/// A pointer is null that must not be.
pub const SPLATLINE_ERROR_NULL: i32 = -1;
/// A pointer or a stride is not a multiple of the type's alignment.
pub const SPLATLINE_ERROR_ALIGNMENT: i32 = -2;
/// A buffer has not the size that is asked for.
pub const SPLATLINE_ERROR_SIZE: i32 = -3;
/// A stride is smaller than what lies between two strides.
pub const SPLATLINE_ERROR_STRIDE: i32 = -4;
/// A width is outside its range.
pub const SPLATLINE_ERROR_WIDTHS: i32 = -5;
/// A choice (design, rules, traversal, compositing, projection) has no such value, or a number is outside its
/// documented range.
pub const SPLATLINE_ERROR_VALUE: i32 = -6;
/// The packet has another version.
pub const SPLATLINE_ERROR_PACKET_VERSION: i32 = -7;
/// `SplatlineSpans` was not prepared by `splatline_spans_begin`.
pub const SPLATLINE_ERROR_STATE: i32 = -8;

/// An error on its way to its code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub(crate) enum Error {
    Null = SPLATLINE_ERROR_NULL,
    Alignment = SPLATLINE_ERROR_ALIGNMENT,
    Size = SPLATLINE_ERROR_SIZE,
    Stride = SPLATLINE_ERROR_STRIDE,
    Widths = SPLATLINE_ERROR_WIDTHS,
    Value = SPLATLINE_ERROR_VALUE,
    PacketVersion = SPLATLINE_ERROR_PACKET_VERSION,
    State = SPLATLINE_ERROR_STATE,
}

/// The code of what a function does.
pub(crate) fn code(work: impl FnOnce() -> Result<i32, Error>) -> i32 {
    match work() {
        Ok(answer) => answer,
        Err(error) => error as i32,
    }
}
