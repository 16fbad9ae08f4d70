//! ROBOTIS DYNAMIXEL servos of the X series, Protocol 2.0: the four that move an instrument, on one half-duplex bus.
//!
//! Angles in rad, zero in the middle of the servo's range; speeds in rad/s; currents in A. [`open`] finds and
//! configures the servos (return delay 0, operating mode, homing offset, sign, limits, gains, profiles) with the torque
//! off. [`DynamixelDriver::poll`](crate::Device::poll) never waits. Each call advances the one exchange under way, so the rate
//! is limited by the caller or by the bus, and is measured in [`Health`](crate::Health). Only [`DynamixelDriver::set_torque`]
//! switches the torque on, at the current angles; while it is on, each servo's bus watchdog stops the servo when the
//! bus becomes quiet. Dropping the driver switches it off. A servo that has shut itself down ([`ServoFault`] gives the
//! reason) starts again only through [`Reboots`].
//!
//! The emulated bus with its servos is `nima_simulation::emulators::dynamixel`.
//!
//! Sources: the ROBOTIS e-manual (Protocol 2.0, X series) and the manufacturer's SDK (`dynamixel-sdk` 4.1.0), which
//! `tests/peers` runs against the emulator.

mod clock;
pub mod codec;
mod driver;
pub mod message;
mod opening;
mod protocol_1;
mod reboots;
mod settings;
pub mod table;
#[cfg(test)]
mod tests;

pub use driver::{DynamixelDriver, GoalResult, ServoCondition, open, open_with};
pub use driver::{open_over, who_is_there};
pub use opening::WaitClock;
pub use reboots::Reboots;
pub(crate) use settings::IDS;
pub use settings::{DynamixelSettings, Gains, OperatingMode, ServoSettings};
pub use table::{HardwareError, ServoFault};
