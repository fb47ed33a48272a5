//! Versions of the library and texts of its codes.

use crate::status::*;
use core::ffi::{CStr, c_char};

/// Version of this interface; it changes when a struct or a function changes in a way that needs recompilation.
pub const SPLATLINE_ABI_VERSION: u32 = 2;

const VERSION: &CStr =
    match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
        Ok(text) => text,
        Err(_) => c"",
    };

/// Version of the interface of the library that is linked: compare it with SPLATLINE_ABI_VERSION of the header.
#[unsafe(no_mangle)]
pub extern "C" fn splatline_abi_version() -> u32 {
    SPLATLINE_ABI_VERSION
}

/// Version of the footprint packet's layout.
#[unsafe(no_mangle)]
pub extern "C" fn splatline_packet_version() -> u32 {
    splatline::footprint::packet::VERSION
}

/// Version of the library, "major.minor.patch". Static.
#[unsafe(no_mangle)]
pub extern "C" fn splatline_version() -> *const c_char {
    VERSION.as_ptr()
}

/// What a code below 0 means, in English; "no error" for others. Static.
#[unsafe(no_mangle)]
pub extern "C" fn splatline_error_text(code: i32) -> *const c_char {
    let text = match code {
        SPLATLINE_ERROR_NULL => c"a pointer is null",
        SPLATLINE_ERROR_ALIGNMENT => c"a pointer or stride is not aligned to its type",
        SPLATLINE_ERROR_SIZE => c"a buffer has not the size that is needed",
        SPLATLINE_ERROR_STRIDE => c"a stride is smaller than one element or one row of the window",
        SPLATLINE_ERROR_WIDTHS => c"a width of the design is outside its range",
        SPLATLINE_ERROR_VALUE => {
            c"a choice has no such value or a number is outside its documented range"
        }
        SPLATLINE_ERROR_PACKET_VERSION => c"the packet has another version",
        SPLATLINE_ERROR_STATE => c"the rows were not prepared by splatline_spans_begin",
        code if code < 0 => c"unknown error",
        _ => c"no error",
    };
    text.as_ptr()
}
