//! Kinova Gen3 with 6 or 7 joints over the Kortex API 2.x: TCP for calls, UDP for the cycle of 1 kHz.
//!
//! - [`KinovaDriver`] reads [`ArmReading`](crate::ArmReading)s: angles in rad, unwrapped; joint torques in Nm with the sign
//!   of commands. The tool's pose and twist are in [`ToolReading`].
//! - After opening, the arm is connected and in single-level servoing. It follows [`KinovaDriver::aim`] only after
//!   [`KinovaDriver::enter_low_level`]; every command is checked by [`limits::Guard`], because the arm checks no limits in
//!   that mode.
//! - Faults are reported as text ([`faults::KinovaFaults`]) and cleared only by command: [`FaultClearing`].
//! - Dropping the driver brakes, leaves low-level servoing, stops a twist and closes the sessions.
//! - The emulated arm, which follows commands, is `nima_simulation::emulators::kinova`.
//!
//! Modules without input and output: [`wire`] (decodes protobuf in place), [`frame`], [`messages`], [`feedback`],
//! [`faults`], [`limits`], [`kinematics`]. The protocol uses degrees, everything else rad. The protocol has no checksum
//! and no time stamp: structure, versions and lengths are checked, and answers are matched by the number of their
//! request.

mod cycle;
mod driver;
pub mod faults;
pub mod feedback;
mod follower;
pub mod frame;
pub mod kinematics;
pub mod limits;
pub mod messages;
mod opening;
pub mod session;
mod settings;
pub mod wire;

#[cfg(test)]
mod golden_tests;

pub use driver::{CallAnswer, KinovaDriver, KinovaRefusal, ToolReading, ToolTwist, TwistFrame};
pub use opening::{FaultClearing, open, open_clearing, open_to_read};
pub use settings::KinovaSettings;
