//! The table of the SDK's functions, with the types of its C header, and how it is filled from a loaded library.
//!
//! Source: `dhdc.h` and `drdc.h` of SDK 3.17.5.

use std::ffi::{c_char, c_int, c_uchar, c_uint, c_ushort};

use libloading::Library;

macro_rules! library {
    ($($field:ident = $symbol:literal: fn($($argument:ty),*) $(-> $result:ty)?;)*) => {
        /// The SDK's functions that are used here, with the types of its C header.
        #[derive(Clone, Copy, Debug)]
        pub struct SdkFunctions {
            $(
                #[doc = concat!("`", $symbol, "`")]
                pub $field: unsafe extern "C" fn($($argument),*) $(-> $result)?,
            )*
            /// Adds an emulated handle by its address; only replacement libraries have this function.
            pub emulate_handle: Option<EmulateHandle>,
        }

        impl SdkFunctions {
            /// Looks up all functions in a library; the error is the name of the missing one.
            pub(super) fn of(library: &Library) -> Result<Self, &'static str> {
                Ok(Self {
                    $(
                        // SAFETY: the type matches the symbol's declaration in the SDK's header; the library is never
                        // unloaded, so the pointer stays valid.
                        $field: unsafe { *library.get($symbol).map_err(|_| $symbol)? },
                    )*
                    emulate_handle: emulate_handle_of(library),
                })
            }
        }
    };
}

library! {
    sdk_version = "dhdGetSDKVersion": fn(*mut c_int, *mut c_int, *mut c_int, *mut c_int);
    last_error = "dhdErrorGetLast": fn() -> c_int;
    device_count = "dhdGetDeviceCount": fn() -> c_int;
    open_any = "dhdOpen": fn() -> c_int;
    open_serial = "dhdOpenSerial": fn(c_int) -> c_int;
    close = "dhdClose": fn(c_char) -> c_int;
    stop = "dhdStop": fn(c_char) -> c_int;
    serial = "dhdGetSerialNumber": fn(*mut c_ushort, c_char) -> c_int;
    kind = "dhdGetSystemType": fn(c_char) -> c_int;
    name = "dhdGetSystemName": fn(c_char) -> *const c_char;
    firmware = "dhdGetVersion": fn(*mut f64, c_char) -> c_int;
    status = "dhdGetStatus": fn(*mut c_int, c_char) -> c_int;
    enable_force = "dhdEnableForce": fn(c_uchar, c_char) -> c_int;
    brakes = "dhdSetBrakes": fn(c_int, c_char) -> c_int;
    gravity = "dhdSetGravityCompensation": fn(c_int, c_char) -> c_int;
    watchdog = "dhdSetWatchdog": fn(c_uchar, c_char) -> c_int;
    force_max = "dhdSetMaxForce": fn(f64, c_char) -> c_int;
    velocity_threshold = "dhdGetVelocityThreshold": fn(*mut c_uint, c_char) -> c_int;
    pose = "dhdGetPositionAndOrientationFrame": fn(*mut f64, *mut f64, *mut f64, *mut f64, c_char) -> c_int;
    gripper = "dhdGetGripperAngleRad": fn(*mut f64, c_char) -> c_int;
    velocity = "dhdGetLinearVelocity": fn(*mut f64, *mut f64, *mut f64, c_char) -> c_int;
    buttons = "dhdGetButtonMask": fn(c_char) -> c_uint;
    emulate_button = "dhdEmulateButton": fn(c_uchar, c_char) -> c_int;
    force = "dhdSetForceAndTorqueAndGripperForce": fn(f64, f64, f64, f64, f64, f64, f64, c_char) -> c_int;
}

/// Symbol that only a replacement library exports.
pub(in crate::force_dimension) const STAND_IN_SYMBOL: &str = "nimaEmulateHandle";

/// `nimaEmulateHandle`: takes an address ("127.0.0.1:PORT"); returns 0, or -1 if it is not an address.
pub type EmulateHandle = unsafe extern "C" fn(*const c_char) -> c_int;

fn emulate_handle_of(library: &Library) -> Option<EmulateHandle> {
    // SAFETY: the type matches the replacement library's own symbol; a library whose symbol is stored is never
    // unloaded.
    unsafe { library.get::<EmulateHandle>(STAND_IN_SYMBOL).ok().map(|symbol| *symbol) }
}

/// Returns whether this library emulates devices and is not the manufacturer's.
pub(in crate::force_dimension) fn is_stand_in(library: &Library) -> bool {
    emulate_handle_of(library).is_some()
}
