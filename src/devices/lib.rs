//! Transports, drivers, slots and discovery: bytes to readings.
//!
//! A driver lives in a folder of its own: a codec without input and output, and a driver over a [`transport`] that neither waits nor
//! allocates. Readings are in SI units in the device's own frame, with the time of their arrival. No crate knows here which rig a device
//! belongs to.
#![warn(missing_docs)]

#[expect(missing_docs, reason = "the names are the manufacturer's")]
pub mod bota;
pub mod discovery;
#[expect(missing_docs, reason = "the names are the manufacturer's")]
pub mod dynamixel;
#[expect(missing_docs, reason = "the names are the manufacturer's")]
pub mod force_dimension;
mod health;
#[expect(missing_docs, reason = "the names are the manufacturer's")]
pub mod hid;
#[expect(missing_docs, reason = "the names are the manufacturer's")]
pub mod kinova;
mod lever;
#[expect(missing_docs, reason = "the names are the manufacturer's")]
pub mod ndi;
#[cfg(unix)]
pub mod os;
pub mod own_folder;
mod parts;
mod reading;
pub mod simulated_arm;
mod slot;
pub mod transport;
mod trouble;

pub use health::{Health, Identity, Loss, Standing};
pub use lever::Lever;
pub use parts::{Follower, ForceSensor, Leader, Switch, Tracker};
pub use reading::{
    ARM_JOINTS, ArmReading, CapReading, ForceReading, ForceStatus, HandleReading, PedalReading, SERVOS, ServoReading,
    Stamped, TRACKED_TOOLS, Tracked, TrackerReading,
};
pub use slot::{Slot, SlotReport, SlotView};
pub use trouble::Trouble;

/// A device that is open and delivers.
///
/// The real-time thread owns it: [`poll`](Self::poll) must neither wait nor allocate.
pub trait Device: Send {
    /// What it reads.
    type Reading: Copy + Send;

    /// Takes in all that has arrived until `now_s` (loop time) and gives the newest reading since the last call, if any. What is
    /// lost, damaged or refused is counted in [`Device::health`]; a device that is lost stays so until it is opened again.
    fn poll(&mut self, now_s: f64) -> Option<Stamped<Self::Reading>>;

    /// How it is, and who it is.
    fn about(&self) -> (&Health, &Identity);

    /// How it is.
    fn health(&self) -> &Health {
        self.about().0
    }

    /// Who it is.
    fn identity(&self) -> &Identity {
        self.about().1
    }
}

/// A person's command to a device in fault.
#[derive(Clone)]
pub struct ClearFaults(std::sync::Arc<dyn Fn() + Send + Sync>);

impl ClearFaults {
    /// By this means.
    pub fn by(command: impl Fn() + Send + Sync + 'static) -> Self {
        Self(std::sync::Arc::new(command))
    }

    /// Gives the command.
    pub fn command(&self) {
        (self.0)();
    }
}

impl std::fmt::Debug for ClearFaults {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("ClearFaults")
    }
}
