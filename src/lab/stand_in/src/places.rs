//! Writing results to where a caller wants them.

use std::ffi::c_int;

use crate::errors::NULL_ARGUMENT;

/// Writes one value; an error where there is no place for it.
///
/// # Safety
/// `place` is null or points to a value that may be written.
pub(crate) unsafe fn put<T>(place: *mut T, value: T) -> Result<(), c_int> {
    if place.is_null() {
        return Err(NULL_ARGUMENT);
    }
    // SAFETY: as the caller promises.
    unsafe { place.write(value) };
    Ok(())
}

/// Writes several values, one behind the other.
///
/// # Safety
/// `place` is null or points to at least as many values.
pub(crate) unsafe fn put_all<T: Copy>(place: *mut T, values: &[T]) -> Result<(), c_int> {
    if place.is_null() {
        return Err(NULL_ARGUMENT);
    }
    // SAFETY: as the caller promises; the two do not overlap, one is ours.
    unsafe { place.copy_from_nonoverlapping(values.as_ptr(), values.len()) };
    Ok(())
}

/// Writes three values to three places.
///
/// # Safety
/// As [`put`].
pub(crate) unsafe fn put_three(places: [*mut f64; 3], values: [f64; 3]) -> Result<(), c_int> {
    for (place, value) in places.into_iter().zip(values) {
        // SAFETY: as the caller promises.
        unsafe { put(place, value)? };
    }
    Ok(())
}
