//! Attached devices, open devices, and their status.

use std::{
    ffi::{CStr, c_char, c_int, c_uchar, c_ushort},
    sync::OnceLock,
    time::{Duration, Instant},
};

use crate::{
    errors::{INVALID_PARAMETER, NULL_ARGUMENT, OUTSIDE_RANGE, noted},
    handle::{StandInHandle, attached, choose, chosen, close, is_taken, open, report, with},
    outputs::{put, put_all},
};

const RIGHT: u32 = 35;
const LEFT: u32 = 37;

pub(crate) fn is_left(handle: &StandInHandle) -> bool {
    handle.reply.kind == LEFT
}

/// Not part of the SDK: adds an emulated handle at `address` ("127.0.0.1:PORT"). Returns 0, or -1 if that is not an
/// address.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nimaEmulateHandle(address: *const c_char) -> c_int {
    if address.is_null() {
        return noted(Err(NULL_ARGUMENT));
    }
    // SAFETY: not null; the caller guarantees a C string.
    let address = unsafe { CStr::from_ptr(address) }.to_str().unwrap_or_default();
    noted(if report(address) { Ok(0) } else { Err(INVALID_PARAMETER) })
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdEnableSimulator(_on: c_uchar) {}

/// 3.17.5.0, or the value of `NIMA_EMULATED_SDK_VERSION` ("3.10.0.0").
fn version() -> [c_int; 4] {
    let mut version = [3, 17, 5, 0];
    let report = std::env::var("NIMA_EMULATED_SDK_VERSION").unwrap_or_default();
    for (number, report) in version.iter_mut().zip(report.split('.')) {
        *number = report.parse().unwrap_or(*number);
    }
    version
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn dhdGetSDKVersion(
    major: *mut c_int,
    minor: *mut c_int,
    release: *mut c_int,
    revision: *mut c_int,
) {
    for (place, number) in [major, minor, release, revision].into_iter().zip(version()) {
        // SAFETY: each pointer is null or valid for an int (SDK).
        unsafe { put(place, number) }.ok();
    }
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdGetSDKVersionStr() -> *const c_char {
    c"3.17.5.0 (emulated by nima)".as_ptr()
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdGetDeviceCount() -> c_int {
    noted(c_int::try_from(attached().len()).map_err(|_| OUTSIDE_RANGE))
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdGetAvailableCount() -> c_int {
    let free = attached().iter().filter(|(_, reply)| !is_taken(reply)).count();
    noted(c_int::try_from(free).map_err(|_| OUTSIDE_RANGE))
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdOpen() -> c_int {
    noted(open(|_, reply| !is_taken(reply)))
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdOpenID(number: c_char) -> c_int {
    let wanted = usize::try_from(number).ok();
    noted(open(|number, _| wanted == Some(number)))
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdOpenSerial(serial: c_int) -> c_int {
    noted(open(|_, reply| i64::from(serial) == i64::from(reply.serial)))
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdOpenType(kind: c_int) -> c_int {
    noted(open(|_, reply| i64::from(kind) == i64::from(reply.kind)))
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdClose(id: c_char) -> c_int {
    noted(close(id))
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdSetDevice(id: c_char) -> c_int {
    noted(choose(id))
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdGetDeviceID() -> c_int {
    noted(chosen())
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn dhdGetSerialNumber(serial: *mut c_ushort, id: c_char) -> c_int {
    noted(with(id, |handle| {
        let number = c_ushort::try_from(handle.reply.serial).map_err(|_| OUTSIDE_RANGE)?;
        // SAFETY: the pointer is null or valid for one value (SDK).
        unsafe { put(serial, number) }.map(|()| 0)
    }))
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdGetSystemType(id: c_char) -> c_int {
    noted(with(id, |handle| Ok(handle.reply.kind.cast_signed())))
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdGetSystemName(id: c_char) -> *const c_char {
    match with(id, |_| Ok(())) {
        Ok(()) => c"omega.7".as_ptr(),
        Err(error) => {
            noted(Err(error));
            std::ptr::null()
        }
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn dhdGetVersion(firmware: *mut f64, id: c_char) -> c_int {
    // SAFETY: the pointer is null or valid for one value (SDK).
    noted(with(id, |handle| unsafe { put(firmware, handle.reply.firmware) }.map(|()| 0)))
}

macro_rules! properties {
    ($($name:ident: $value:expr;)*) => {$(
        #[unsafe(no_mangle)]
        pub extern "C" fn $name(id: c_char) -> bool {
            let value: fn(&StandInHandle) -> bool = $value;
            noted(with(id, |handle| Ok(c_int::from(value(handle))))) == 1
        }
    )*};
}

properties! {
    dhdIsLeftHanded: is_left;
    dhdHasBase: |_| true;
    dhdHasWrist: |_| true;
    dhdHasActiveWrist: |_| false;
    dhdHasGripper: |_| true;
    dhdHasActiveGripper: |handle| matches!(handle.reply.kind, RIGHT | LEFT);
}

/// Gravity and time guard are the host's own entries.
const GRAVITY: usize = 10;
const TIME_GUARD: usize = 11;

#[unsafe(no_mangle)]
pub unsafe extern "C" fn dhdGetStatus(status: *mut c_int, id: c_char) -> c_int {
    noted(with(id, |handle| {
        let code = handle.refresh()?;
        let mut entries = handle.reply.status.map(u32::cast_signed);
        entries[GRAVITY] = c_int::from(handle.gravity);
        entries[TIME_GUARD] = c_int::from(!handle.time_guard.is_zero());
        // SAFETY: the pointer is null or valid for 17 values (SDK).
        unsafe { put_all(status, &entries) }.map(|()| code.min(0))
    }))
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdGetComMode(id: c_char) -> c_int {
    // The communication mode is asynchronous, the default.
    noted(with(id, |_| Ok(1)))
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdGetComFreq(id: c_char) -> f64 {
    with(id, |handle| Ok(handle.com_khz())).unwrap_or_else(|error| f64::from(noted(Err(error))))
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdGetTime() -> f64 {
    static BEGIN: OnceLock<Instant> = OnceLock::new();
    BEGIN.get_or_init(Instant::now).elapsed().as_secs_f64()
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdSleep(length_s: f64) {
    if let Ok(length) = Duration::try_from_secs_f64(length_s) {
        std::thread::sleep(length);
    }
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdKbHit() -> bool {
    false
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdKbGet() -> c_char {
    0
}
