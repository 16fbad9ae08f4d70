//! Force-torque sensors of Bota Systems: first generation on a serial line, second generation (A) on a serial line or
//! in a network.
//!
//! Forces in N, torques in Nm, accelerations in m/s^2, angular velocities in rad/s, all in the sensor's own frame and
//! unmodified (no offset or filter is added here). [`BotaDriver::open`] blocks and reports every failure as a
//! [`DeviceError`](super::DeviceError). [`BotaDriver`] then neither waits nor allocates, and returns only usable readings.
//! Configuration: [`BotaSettings`]. The emulator (`nima_simulation::emulators::bota`) uses the same protocols.
//!
//! Sources: `bota.md` of the reference, and observation of the manufacturer's client. Not verified with a real sensor.

mod clock;
pub mod codec;
mod driver;
pub mod gen0;
pub mod gen_a;
mod link;
mod opening;
mod session;
mod settings;

pub use clock::{BotaClock, BotaClockStep};
pub use driver::{BotaDriver, reading_of, status_of};
pub use opening::TCP_PORT;
pub use session::BotaTimeouts;
pub use settings::{BotaSettings, Transport};
