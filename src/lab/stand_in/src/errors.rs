//! The last error of each thread, and the errors' texts.

use std::{
    cell::Cell,
    ffi::{c_char, c_int},
};

thread_local! {
    static LAST: Cell<c_int> = const { Cell::new(0) };
}

pub(crate) const COMMUNICATION: c_int = 2;
pub(crate) const NO_DEVICE: c_int = 5;
pub(crate) const TIMED_OUT: c_int = 7;
pub(crate) const EXPERT_MODE_DISABLED: c_int = 9;
pub(crate) const NOT_IMPLEMENTED: c_int = 10;
pub(crate) const OUTSIDE_RANGE: c_int = 15;
pub(crate) const NULL_ARGUMENT: c_int = 17;
pub(crate) const IN_USE: c_int = 20;
pub(crate) const INVALID_PARAMETER: c_int = 21;

/// Stores the error of a call and returns its return value.
pub(crate) fn noted(outcome: Result<c_int, c_int>) -> c_int {
    LAST.set(outcome.err().unwrap_or(0));
    outcome.unwrap_or(-1)
}

const TEXTS: [&std::ffi::CStr; 23] = [
    c"no error",
    c"undocumented error",
    c"communication error",
    c"device controller busy",
    c"no driver found",
    c"no device found",
    c"operation not available",
    c"operation timed out",
    c"geometric error",
    c"expert mode disabled",
    c"feature not implemented",
    c"out of memory",
    c"device not ready",
    c"file not found",
    c"device configuration failed",
    c"index outside valid range",
    c"feature or device no longer supported",
    c"argument is null or invalid",
    c"redundant encoder integrity test failed",
    c"feature is not enabled",
    c"device is in use",
    c"invalid parameter",
    c"robotic regulation is not running",
];

#[unsafe(no_mangle)]
pub extern "C" fn dhdErrorGetLast() -> c_int {
    LAST.get()
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdErrorGetLastStr() -> *const c_char {
    dhdErrorGetStr(LAST.get())
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdErrorGetStr(error: c_int) -> *const c_char {
    usize::try_from(error).ok().and_then(|error| TEXTS.get(error)).unwrap_or(&c"invalid error code").as_ptr()
}
