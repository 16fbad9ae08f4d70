//! Writing results to a caller's pointers.

use std::ffi::c_int;

use crate::errors::NULL_ARGUMENT;

/// Writes one value; an error for a null pointer.
///
/// # Safety
/// `place` is null or valid for a write.
pub(crate) unsafe fn put<T>(place: *mut T, value: T) -> Result<(), c_int> {
    if place.is_null() {
        return Err(NULL_ARGUMENT);
    }
    // SAFETY: guaranteed by the caller.
    unsafe { place.write(value) };
    Ok(())
}

/// Writes several consecutive values.
///
/// # Safety
/// `place` is null or valid for writes of this many values.
pub(crate) unsafe fn put_all<T: Copy>(place: *mut T, values: &[T]) -> Result<(), c_int> {
    if place.is_null() {
        return Err(NULL_ARGUMENT);
    }
    // SAFETY: the caller guarantees that the pointer is valid; the ranges do not overlap, because one is ours.
    unsafe { place.copy_from_nonoverlapping(values.as_ptr(), values.len()) };
    Ok(())
}

/// Writes three values to three pointers.
///
/// # Safety
/// As [`put`].
pub(crate) unsafe fn put_three(places: [*mut f64; 3], values: [f64; 3]) -> Result<(), c_int> {
    for (place, value) in places.into_iter().zip(values) {
        // SAFETY: guaranteed by the caller.
        unsafe { put(place, value)? };
    }
    Ok(())
}
