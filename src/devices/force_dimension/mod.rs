//! Force Dimension omega.7: haptic handle with a passive wrist and an active gripper, through the manufacturer's library.
//!
//! - In: position (m), orientation, opening of the gripper (rad), velocity (m/s), in the device's own frame; 1 kHz.
//! - Out: force (N, at most 12) and gripper force (N, at most 8), each valid for 10 ms. Not finite: zero. Force is on only while it is
//!   enabled by command; brakes are on before, after, and on every way out. The velocity threshold of the device is never touched, its
//!   watchdog always set.
//! - The library (`libdrd`, which holds all of `libdhd`) is loaded while running; the program builds and runs without it and says where
//!   it looked ([`crate::Trouble::SdkMissing`]). An emulated handle is reached by a stand-in that the program provides.
//! - Lost: without a reading for 20 ms, with ten impossible readings in a row, when the SDK names a lasting error, or when the
//!   status array tells of a fault ([`status::fault_words`] reads the code). That the device took force away (button, speed,
//!   watchdog) is no loss but a [`HandleEvent`]: it goes on reading.
//! - A still handle reads the same numbers again and again; standing still is no fault. Only when the library itself says that
//!   there is nothing newer (`DHD_TIMEGUARD`) for 20 ms it counts as silent.
//!
//! `src/stand_in` stands in for the library; the emulated device behind it is `nima_world::emulators::force_dimension`.

mod driver;
mod leader;
mod library;
mod opening;
mod sdk;
pub mod status;
mod worker;

pub use driver::{
    Counters, Driver, FORCE_MAX_N, ForceAnswer, GRIPPER_MAX_N, HandleEvent, IdleMode, SILENCE_S, Settings, open,
};
pub use library::{installed_library, provide_stand_in};
pub use sdk::{EmulateHandle, Sdk, SdkFunctions, prepare_thread};
pub use status::{ForceOffCause, Kind, SdkError, Status};
