//! Force Dimension omega.7: haptic handle with a passive wrist and an active gripper, through the manufacturer's library.
//!
//! - In: position (m), orientation, opening of the gripper (rad), velocity (m/s), in the device's own frame; 1 kHz.
//! - Out: force (N, at most 12) and gripper force (N, at most 8), each valid for 10 ms. Not finite: zero. Force is on only while it is
//!   enabled by command; brakes are on before, after, and on every way out. The velocity threshold of the device is never touched, its
//!   watchdog always set.
//! - The library (`libdrd`, which holds all of `libdhd`) is loaded while running; the program builds and runs without it and says where
//!   it looked ([`crate::device::Trouble::SdkMissing`]).
//! - Lost: without a reading for 20 ms, with ten impossible readings in a row, when the SDK names a lasting error, or when the
//!   status array tells of a fault ([`status::fault_words`] reads the code). That the device took force away (button, speed,
//!   watchdog) is no loss but a [`HandleEvent`]: it goes on reading.
//! - A still handle reads the same numbers again and again; standing still is no fault. Only when the library itself says that
//!   there is nothing newer (`DHD_TIMEGUARD`) for 20 ms it counts as silent.
//!
//! `emulators/omega` stands in for the library; [`Emulator`] is the device behind it.

mod driver;
mod emulator;
mod firmware;
mod library;
mod opening;
mod sdk;
pub mod status;
#[cfg(test)]
#[expect(clippy::float_cmp, reason = "forces and positions arrive as they were sent, to the last bit")]
mod tests;
pub mod wire;
mod worker;

pub use driver::{
    Counters, Driver, FORCE_MAX_N, ForceAnswer, GRIPPER_MAX_N, HandleEvent, IdleMode, SILENCE_S, Settings, open,
};
pub use emulator::{Body, Emulator, HandState, Held, stand_in};
pub use firmware::{Applied, Mode};
pub use library::installed_library;
pub use status::{ForceOffCause, Kind, SdkError, Status};
