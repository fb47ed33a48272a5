//! Pointers from C, turned into references after checking what can be checked. (The state of `rows`, memory of our own
//! type that C only carries about, is cast there.)
//!
//! Null and misaligned pointers are errors. That a pointer leads to as much memory as the caller says, and that nobody
//! else writes it meanwhile, cannot be checked: it is the contract of every function of this library.

use crate::status::{Error, SPLATLINE_OK};

/// Is the pointer neither null nor misaligned?
pub(crate) fn check<T>(pointer: *const T) -> Result<(), Error> {
    if pointer.is_null() {
        Err(Error::Null)
    } else if !pointer.is_aligned() {
        Err(Error::Alignment)
    } else {
        Ok(())
    }
}

/// # Safety
/// `pointer` is null, misaligned, or leads to a `T` that lives and stays unchanged during the call.
pub(crate) unsafe fn read<'a, T>(pointer: *const T) -> Result<&'a T, Error> {
    check(pointer)?;
    // SAFETY: not null, aligned; the rest is the caller's contract.
    Ok(unsafe { &*pointer })
}

/// Writes without reading what was there: the memory may be uninitialised. Gives the code of success.
///
/// # Safety
/// `pointer` is null, misaligned, or leads to memory for a `T` that nobody else uses during the call.
pub(crate) unsafe fn write<T>(pointer: *mut T, value: T) -> Result<i32, Error> {
    check(pointer)?;
    // SAFETY: not null, aligned; the rest is the caller's contract.
    unsafe { pointer.write(value) };
    Ok(SPLATLINE_OK)
}

/// # Safety
/// `pointer` is null, misaligned, or leads to a `T` that nobody else uses during the call.
pub(crate) unsafe fn modify<'a, T>(pointer: *mut T) -> Result<&'a mut T, Error> {
    check(pointer)?;
    // SAFETY: not null, aligned; the rest is the caller's contract.
    Ok(unsafe { &mut *pointer })
}

/// An empty slice may have any pointer.
///
/// # Safety
/// `pointer` is null, misaligned, or leads to `count` times `T` that live and stay unchanged during the call.
pub(crate) unsafe fn slice<'a, T>(pointer: *const T, count: usize) -> Result<&'a [T], Error> {
    if count == 0 {
        return Ok(&[]);
    }
    check(pointer)?;
    fits::<T>(count)?;
    // SAFETY: not null, aligned, not longer than the address space; the rest is the caller's contract.
    Ok(unsafe { core::slice::from_raw_parts(pointer, count) })
}

/// An empty slice may have any pointer.
///
/// # Safety
/// `pointer` is null, misaligned, or leads to `count` times `T` that nobody else uses during the call.
pub(crate) unsafe fn slice_mut<'a, T>(pointer: *mut T, count: usize) -> Result<&'a mut [T], Error> {
    if count == 0 {
        return Ok(&mut []);
    }
    check(pointer)?;
    fits::<T>(count)?;
    // SAFETY: not null, aligned, not longer than the address space; the rest is the caller's contract.
    Ok(unsafe { core::slice::from_raw_parts_mut(pointer, count) })
}

/// Rust's slices span at most half of the address space.
fn fits<T>(count: usize) -> Result<(), Error> {
    match count.checked_mul(size_of::<T>()) {
        Some(bytes) if bytes <= isize::MAX as usize => Ok(()),
        _ => Err(Error::Size),
    }
}

/// Address of element `index` of an array with `stride` bytes from one element to the next.
pub(crate) fn element<T>(first: *const T, index: usize, stride: usize) -> *const T {
    first.wrapping_byte_add(index.wrapping_mul(stride))
}

/// Is `stride` (bytes) possible for elements of type `T`?
pub(crate) fn check_stride<T>(stride: usize) -> Result<(), Error> {
    if stride < size_of::<T>() {
        Err(Error::Stride)
    } else if !stride.is_multiple_of(align_of::<T>()) {
        Err(Error::Alignment)
    } else {
        Ok(())
    }
}
