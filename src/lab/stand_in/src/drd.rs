//! The implemented `drd` symbols. Regulation is not emulated: nothing here moves the handle on its own.

use std::ffi::{c_char, c_int};

use crate::{devices as dhd, stubs::refused};

#[unsafe(no_mangle)]
pub extern "C" fn drdOpen() -> c_int {
    dhd::dhdOpen()
}

#[unsafe(no_mangle)]
pub extern "C" fn drdOpenID(number: c_char) -> c_int {
    dhd::dhdOpenID(number)
}

#[unsafe(no_mangle)]
pub extern "C" fn drdClose(id: c_char) -> c_int {
    dhd::dhdClose(id)
}

#[unsafe(no_mangle)]
pub extern "C" fn drdSetDevice(id: c_char) -> c_int {
    dhd::dhdSetDevice(id)
}

#[unsafe(no_mangle)]
pub extern "C" fn drdGetDeviceID() -> c_int {
    dhd::dhdGetDeviceID()
}

/// Returns success: an omega.7 is initialised as soon as it is on.
#[unsafe(no_mangle)]
pub extern "C" fn drdIsInitialized(id: c_char) -> bool {
    dhd::dhdHasBase(id)
}

/// Fails with error 22, "regulation is not running", because it never runs here.
#[unsafe(no_mangle)]
pub extern "C" fn drdWaitForTick(_id: c_char) {
    refused();
}
