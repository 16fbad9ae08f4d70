//! Force-torque sensors of Bota Systems: first generation on a serial line, second generation (A) on a serial line or in the network.
//!
//! Forces in N, torques in Nm, accelerations in m/s^2, angular velocities in rad/s, all in the sensor's own frame and as the sensor
//! gives them (no offset, no filter of ours). [`Driver::open`] blocks and tells every failure as a [`Trouble`](super::Trouble);
//! [`Driver`] then neither waits nor allocates, and hands out nothing that must not be used. What it must be told is in
//! [`Settings`]. The emulator (`nima_world::emulators::bota`) speaks the same protocols.
//!
//! Facts: `bota.md` of the reference; found by running the manufacturer's client, not proven on real sensors.

mod clock;
pub mod codec;
mod driver;
pub mod gen0;
pub mod gen_a;
mod link;
mod opening;
mod session;
mod settings;

pub use clock::{Clock, Step};
pub use driver::{Driver, reading_of, status_of};
pub use opening::TCP_PORT;
pub use session::Timeouts;
pub use settings::{Settings, Transport};
