//! Force Dimension omega.7: haptic handle with a passive wrist and an active gripper, used through the manufacturer's
//! library.
//!
//! - Input: position (m), orientation, opening of the gripper (rad), velocity (m/s), in the device's own frame; 1 kHz.
//! - Output: force (N, at most 12) and gripper force (N, at most 8), each valid for 10 ms; a value that is not finite
//!   gives zero. Force is on only while it is enabled by command; otherwise, and regardless of how the program ends,
//!   the brakes are on. The device's velocity threshold is never changed, its watchdog is always set.
//! - The library (`libdrd`, which includes all of `libdhd`) is loaded at run time. The program builds and runs without
//!   it and reports where it searched ([`crate::DeviceError::SdkMissing`]). An emulated handle is reached through a
//!   replacement library in the program.
//! - The device is lost after 20 ms without a reading, after ten impossible readings in a row, on a permanent error of
//!   the SDK, or on a fault in the status array ([`status::fault_text`] explains the code). If the device switches its
//!   force off (button, speed, watchdog), this is a [`HandleEvent`], not a loss; reading continues.
//! - A handle that is not moved repeats the same numbers, which is not a fault. It counts as silent only if the library
//!   reports for 20 ms that there are no newer data (`DHD_TIMEGUARD`).
//!
//! The replacement library is in `src/lab/stand_in`; the emulated device behind it is
//! `nima_simulation::emulators::force_dimension`.

mod driver;
mod leader;
mod library;
mod opening;
mod sdk;
mod settings;
pub mod status;
mod worker;

pub use driver::{Counters, ForceAnswer, ForceDimensionDriver, HandleEvent, SILENCE_S, open};
pub use library::{installed_library, provide_stand_in};
pub use opening::attached;
pub use sdk::{EmulateHandle, Sdk, SdkFunctions, prepare_thread};
pub use settings::{FORCE_MAX_N, ForceDimensionSettings, GRIPPER_MAX_N, IdleMode};
pub use status::{ForceDimensionKind, ForceDimensionStatus, ForceOffCause, SdkError};
