//! Drivers of the devices: from the bytes on the connection to readings in SI units.
//!
//! Each driver has its own folder, with a codec without input and output, and a driver over a [`transport`] that
//! neither waits nor allocates. Readings are in SI units in the device's own frame, with their time of arrival. This
//! crate does not depend on the rig to which a device belongs.

pub mod ati;
pub mod bota;
pub mod discovery;
pub mod dynamixel;
mod error;
pub mod external;
pub mod force_dimension;
pub mod haply;
mod health;
pub mod hid;
pub mod kinova;
mod lever;
pub mod ndi;
#[cfg(unix)]
pub mod os;
pub mod own_folder;
mod parts;
mod reading;
pub mod simulated_arm;
mod slot;
mod stream_buffer;
pub mod transport;

pub use error::DeviceError;
pub use health::{ConnectionState, DeviceIdentity, Health, Loss, same_serial};
pub use lever::Lever;
pub use parts::{Follower, ForceSensor, Leader, Switch, Tracker};
pub use reading::{
    ARM_JOINTS, ArmReading, CapReading, ForceReading, ForceStatus, HandleReading, PedalReading, SERVOS, ServoReading,
    TRACKED_TOOLS, TimedReading, TrackedTool, TrackerReading,
};
pub use slot::{DeviceSlot, SlotReport, SlotView};

/// An open device.
///
/// The real-time thread owns it: [`poll`](Self::poll) must neither wait nor allocate.
pub trait Device: Send {
    type Reading: Copy + Send;

    /// Handles all data that have arrived until `now_s` (loop time) and returns the newest reading since the last call,
    /// if any. Lost, damaged and refused data are counted in [`Device::health`]; a lost device stays lost until it is
    /// reopened.
    fn poll(&mut self, now_s: f64) -> Option<TimedReading<Self::Reading>>;

    fn about(&self) -> (&Health, &DeviceIdentity);

    fn health(&self) -> &Health {
        self.about().0
    }

    /// Returns the identity that the device reported.
    fn identity(&self) -> &DeviceIdentity {
        self.about().1
    }
}

/// A person's request that a device in fault clears its faults.
#[derive(Clone)]
pub struct ClearFaults(std::sync::Arc<dyn Fn() + Send + Sync>);

impl ClearFaults {
    pub fn by(command: impl Fn() + Send + Sync + 'static) -> Self {
        Self(std::sync::Arc::new(command))
    }

    pub fn command(&self) {
        (self.0)();
    }
}

impl std::fmt::Debug for ClearFaults {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("ClearFaults")
    }
}
