//! Loads and calls the manufacturer's library. The only unsafe code of this driver.
//!
//! All calls go through one table of functions ([`SdkFunctions`]). It is filled from a library loaded at run time or,
//! for emulated handles, with functions of the same signature that are linked into the program ([`Sdk::linked`]). A
//! loaded library is never unloaded, because its threads may still be running. Every call passes the device's number;
//! the library's "default device" is not used. The library keeps its last error per thread, so a call and the query for
//! its error are made on the same thread.
#![expect(unsafe_code, reason = "a C library that is loaded while running")]

mod functions;
mod shutdown;

use std::{
    borrow::Cow,
    ffi::{CStr, CString, c_char, c_int, c_uchar},
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
};

pub use functions::{EmulateHandle, SdkFunctions};
pub(super) use functions::{STAND_IN_SYMBOL, is_stand_in};
use libloading::Library;
use nima_files::quoted;
pub(super) use shutdown::is_ending;

use super::status::{ENTRIES, ForceDimensionStatus, SdkError, Success};
use crate::DeviceError;

/// Name in messages.
pub(super) const NAME: &str = "Force Dimension SDK (libdrd or libdhd, 3.16 or newer)";
/// The oldest version whose status array has the entries that are decoded here.
const VERSION_MIN: (c_int, c_int) = (3, 16);

/// The SDK: a loaded library, or functions linked into the program.
#[derive(Debug)]
pub struct Sdk {
    path: Cow<'static, str>,
    functions: SdkFunctions,
    /// Serialises opening, which uses lists that the library shares between devices.
    opening: Mutex<()>,
}

/// Loaded libraries by path.
static LOADED: Mutex<Vec<(PathBuf, &'static Sdk)>> = Mutex::new(Vec::new());

pub(super) type SdkPose = ([f64; 3], [f64; 9]);

/// Opens a library; the error is the system's text.
pub(super) fn unusable(path: &str, reason: String) -> DeviceError {
    DeviceError::SdkUnusable { name: NAME.to_owned(), path: path.to_owned(), reason }
}

/// Loads a library; the error is the system's text.
pub(super) fn open_library(path: &Path) -> Result<Library, String> {
    // SAFETY: loading runs the library's initialisation. It is the manufacturer's library, named by the user of the rig
    // or found where it is installed.
    unsafe { Library::new(path) }.map_err(|error| {
        let mut words = error.to_string();
        if let Some(source) = std::error::Error::source(&error) {
            words = source.to_string();
        }
        words
    })
}

/// Checks a library and keeps it until the program ends.
pub(super) fn keep(path: &Path, library: Library) -> Result<&'static Sdk, DeviceError> {
    let mut loaded = LOADED.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, sdk)) = loaded.iter().find(|(known, _)| known == path) {
        return Ok(sdk);
    }
    let place = path.display().to_string();
    let functions = SdkFunctions::of(&library);
    let functions = functions.map_err(|symbol| unusable(&place, format!("it has no symbol {symbol}")))?;
    let sdk = Sdk { path: place.clone().into(), functions, opening: Mutex::new(()) };
    // Forgotten, so that it is never unloaded. A library that was refused above is unloaded, because none of its code
    // runs.
    std::mem::forget(library);
    let [major, minor, release, revision] = sdk.version();
    if (major, minor) < VERSION_MIN {
        return Err(unusable(&place, format!("its version {major}.{minor}.{release}.{revision} is older than 3.16")));
    }
    let sdk: &'static Sdk = Box::leak(Box::new(sdk));
    loaded.push((path.to_owned(), sdk));
    Ok(sdk)
}

impl Sdk {
    /// Creates an SDK from functions linked into this program; `name` replaces the library's file in messages.
    pub const fn linked(name: &'static str, functions: SdkFunctions) -> Self {
        Self { path: Cow::Borrowed(name), functions, opening: Mutex::new(()) }
    }

    pub(super) fn path(&self) -> &str {
        &self.path
    }

    /// Returns whether the library emulates devices and is not the manufacturer's.
    pub(super) const fn is_stand_in(&self) -> bool {
        self.functions.emulate_handle.is_some()
    }

    fn last_error(&self) -> SdkError {
        // SAFETY: no arguments; the library is never unloaded.
        SdkError(unsafe { (self.functions.last_error)() })
    }

    fn checked(&self, code: c_int) -> Result<Success, SdkError> {
        Success::of(code).ok_or_else(|| self.last_error())
    }

    pub(super) fn version(&self) -> [c_int; 4] {
        let mut numbers = [0; 4];
        let [major, minor, release, revision] = &mut numbers;
        // SAFETY: four ints that outlive the call.
        unsafe { (self.functions.sdk_version)(major, minor, release, revision) };
        numbers
    }

    /// Adds an emulated handle (replacement library only).
    pub(super) fn emulate(&self, address: &str) -> Result<(), DeviceError> {
        let refuse = |reason: &str| unusable(&self.path, reason.to_owned());
        let function = self
            .functions
            .emulate_handle
            .ok_or_else(|| refuse("it is not the replacement library that an emulated handle needs"))?;
        let text = CString::new(address).map_err(|_| refuse("the emulated handle's address contains a zero byte"))?;
        // SAFETY: a C string that outlives the call.
        if unsafe { function(text.as_ptr()) } == 0 {
            Ok(())
        } else {
            Err(refuse("it cannot parse the emulated handle's address"))
        }
    }

    pub(super) fn device_count(&self) -> i32 {
        // SAFETY: no arguments.
        unsafe { (self.functions.device_count)() }
    }

    /// Opens a device by serial number, or any free one.
    pub(super) fn open(&'static self, serial: Option<u16>) -> Result<OpenDevice, SdkError> {
        shutdown::call_before_exit();
        let _one_at_a_time = self.opening.lock().unwrap_or_else(PoisonError::into_inner);
        // SAFETY: the call takes no pointers.
        let id = unsafe {
            match serial {
                Some(serial) => (self.functions.open_serial)(c_int::from(serial)),
                None => (self.functions.open_any)(),
            }
        };
        // A device number must fit C's `char`, signed or not.
        match i8::try_from(id).ok().filter(|id| *id >= 0).and_then(|id| c_char::try_from(id).ok()) {
            Some(id) => {
                shutdown::opened();
                Ok(OpenDevice { sdk: self, id })
            }
            None => Err(self.last_error()),
        }
    }
}

/// An open device. Dropping it, also during a panic, engages the brakes and closes it.
pub(super) struct OpenDevice {
    sdk: &'static Sdk,
    id: c_char,
}

impl Drop for OpenDevice {
    fn drop(&mut self) {
        self.stop().ok();
        // SAFETY: the call takes no pointers; the device id is not used afterwards.
        unsafe { (self.sdk.functions.close)(self.id) };
        shutdown::closed();
    }
}

impl OpenDevice {
    fn checked(&self, code: c_int) -> Result<Success, SdkError> {
        self.sdk.checked(code)
    }

    pub(super) fn serial(&self) -> Result<u16, SdkError> {
        let mut serial = 0;
        // SAFETY: one unsigned short that outlives the call.
        self.checked(unsafe { (self.sdk.functions.serial)(&raw mut serial, self.id) })?;
        Ok(serial)
    }

    /// Returns the number of the device type (`DHD_DEVICE_*`).
    pub(super) fn kind(&self) -> Result<i32, SdkError> {
        // SAFETY: the call takes no pointers.
        let kind = unsafe { (self.sdk.functions.kind)(self.id) };
        if kind < 0 { Err(self.sdk.last_error()) } else { Ok(kind) }
    }

    pub(super) fn name(&self) -> Option<String> {
        // SAFETY: no pointer arguments.
        let name = unsafe { (self.sdk.functions.name)(self.id) };
        // SAFETY: not null: the library's own C string, which it does not change; copied at once.
        (!name.is_null()).then(|| quoted(&unsafe { CStr::from_ptr(name) }.to_string_lossy()))
    }

    pub(super) fn firmware(&self) -> Result<f64, SdkError> {
        let mut version = 0.0;
        // SAFETY: one double that outlives the call.
        self.checked(unsafe { (self.sdk.functions.firmware)(&raw mut version, self.id) })?;
        Ok(version)
    }

    pub(super) fn status(&self) -> Result<ForceDimensionStatus, SdkError> {
        // Longer than the array of any version of the SDK.
        let mut entries = [0; 4 * ENTRIES];
        // SAFETY: an array of ints, longer than what the library writes, that outlives the call.
        self.checked(unsafe { (self.sdk.functions.status)(entries.as_mut_ptr(), self.id) })?;
        Ok(entries.first_chunk().map(ForceDimensionStatus::decode).unwrap_or_default())
    }

    pub(super) fn enable_force(&self, on: bool) -> Result<Success, SdkError> {
        // SAFETY: the call takes no pointers.
        self.checked(unsafe { (self.sdk.functions.enable_force)(c_uchar::from(on), self.id) })
    }

    /// Switches force off and brakes on.
    pub(super) fn stop(&self) -> Result<Success, SdkError> {
        // SAFETY: the call takes no pointers.
        self.checked(unsafe { (self.sdk.functions.stop)(self.id) })
    }

    /// Switches the brakes on, or off: no current in the motors.
    pub(super) fn set_brakes(&self, on: bool) -> Result<Success, SdkError> {
        // SAFETY: the call takes no pointers.
        self.checked(unsafe { (self.sdk.functions.brakes)(c_int::from(on), self.id) })
    }

    /// Switches gravity compensation on or off.
    pub(super) fn set_gravity_compensation(&self, on: bool) -> Result<Success, SdkError> {
        // SAFETY: the call takes no pointers.
        self.checked(unsafe { (self.sdk.functions.gravity)(c_int::from(on), self.id) })
    }

    /// Sets the time without a force command after which the device switches its force off, in steps of 125 us.
    pub(super) fn set_watchdog(&self, steps: u8) -> Result<Success, SdkError> {
        // SAFETY: the call takes no pointers.
        self.checked(unsafe { (self.sdk.functions.watchdog)(steps, self.id) })
    }

    /// Sets the maximum force that the library passes on, N.
    pub(super) fn set_force_max(&self, force_n: f64) -> Result<Success, SdkError> {
        // SAFETY: the call takes no pointers.
        self.checked(unsafe { (self.sdk.functions.force_max)(force_n, self.id) })
    }

    /// Returns the velocity threshold, in the device's own unit.
    pub(super) fn velocity_threshold(&self) -> Result<u32, SdkError> {
        let mut threshold = 0;
        // SAFETY: one unsigned int that outlives the call.
        self.checked(unsafe { (self.sdk.functions.velocity_threshold)(&raw mut threshold, self.id) })?;
        Ok(threshold)
    }

    /// Returns position and orientation; one exchange with the device.
    pub(super) fn pose(&self) -> Result<(SdkPose, Success), SdkError> {
        let [mut x, mut y, mut z] = [0.0; 3];
        let mut frame = [0.0; 9];
        let places = (&raw mut x, &raw mut y, &raw mut z, frame.as_mut_ptr());
        // SAFETY: three doubles and an array of three by three that outlive the call.
        let code = unsafe { (self.sdk.functions.pose)(places.0, places.1, places.2, places.3, self.id) };
        self.checked(code).map(|success| (([x, y, z], frame), success))
    }

    pub(super) fn gripper_rad(&self) -> Result<f64, SdkError> {
        let mut angle = 0.0;
        // SAFETY: one double that outlives the call.
        self.checked(unsafe { (self.sdk.functions.gripper)(&raw mut angle, self.id) })?;
        Ok(angle)
    }

    /// Returns the velocity, m/s; an error until two positions were read within its averaging window.
    pub(super) fn velocity_m_s(&self) -> Result<[f64; 3], SdkError> {
        let [mut x, mut y, mut z] = [0.0; 3];
        // SAFETY: three doubles that outlive the call.
        let code = unsafe { (self.sdk.functions.velocity)(&raw mut x, &raw mut y, &raw mut z, self.id) };
        self.checked(code)?;
        Ok([x, y, z])
    }

    /// Returns the pressed buttons, one per bit, the first button in the lowest bit.
    pub(super) fn buttons(&self) -> u32 {
        // SAFETY: the call takes no pointers.
        unsafe { (self.sdk.functions.buttons)(self.id) }
    }

    /// Sets whether the closed gripper counts as a button.
    pub(super) fn emulate_button(&self, on: bool) -> Result<Success, SdkError> {
        // SAFETY: the call takes no pointers.
        self.checked(unsafe { (self.sdk.functions.emulate_button)(c_uchar::from(on), self.id) })
    }

    /// Sets force and gripper force, N; no torque, because the wrist is passive.
    pub(super) fn set_force(&self, force_n: [f64; 3], gripper_n: f64) -> Result<Success, SdkError> {
        let [x, y, z] = force_n;
        // SAFETY: the call takes no pointers.
        self.checked(unsafe { (self.sdk.functions.force)(x, y, z, 0.0, 0.0, 0.0, gripper_n, self.id) })
    }
}

/// Above the priority of the loop (80), so that the loop cannot delay a device.
#[cfg(target_os = "linux")]
const PRIORITY: c_int = 82;

/// Requests real-time scheduling for the calling thread; if refused, the thread continues with normal scheduling.
pub fn prepare_thread() {
    #[cfg(target_os = "linux")]
    // SAFETY: plain system calls on the calling thread with valid, initialised arguments.
    unsafe {
        libc::prctl(libc::PR_SET_TIMERSLACK, 1_usize);
        // Field by field, because some C libraries have additional fields.
        let mut parameter: libc::sched_param = std::mem::zeroed();
        parameter.sched_priority = PRIORITY;
        libc::pthread_setschedparam(libc::pthread_self(), libc::SCHED_FIFO, &raw const parameter);
    }
}
