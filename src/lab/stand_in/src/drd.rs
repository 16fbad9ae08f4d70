//! The `drd` symbols that are implemented. Regulation is not emulated: nothing here ever moves the handle by itself.

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

/// An omega.7 is initialised as soon as it is on.
#[unsafe(no_mangle)]
pub extern "C" fn drdIsInitialized(id: c_char) -> bool {
    dhd::dhdHasBase(id)
}

/// Error 22 would be "regulation is not running", which it never is here.
#[unsafe(no_mangle)]
pub extern "C" fn drdWaitForTick(_id: c_char) {
    refused();
}
