//! What the loop asks of hardware, real or simulated.
//!
//! Positions in m, forces in N, both in the workspace frame (z up). A rig that cannot deliver a sample says so with
//! `None`; it never repeats an old one as new.
//!
//! Drivers of real devices live in a folder each: a codec without input and output, a driver over a [`transport`], an emulator.

pub mod bota;
pub mod discovery;
pub mod dynamixel;
pub mod emulation;
pub mod force_dimension;
mod health;
pub mod hid;
pub mod kinova;
pub mod ndi;
#[cfg(unix)]
mod os;
mod prompt;
mod reading;
pub mod rig;
mod side;
mod slot;
pub mod transport;
mod trouble;

use nalgebra::Vector3;

pub use health::{Health, Identity, Loss, Standing};
pub use prompt::Prompt;
pub use reading::{
    ARM_JOINTS, ArmReading, CapReading, ForceReading, ForceStatus, HandleReading, PedalReading, SERVOS, ServoReading,
    Stamped, TRACKED_TOOLS, Tracked, TrackerReading,
};
pub use side::{SIDES, Side};
pub use slot::{Slot, SlotReport, SlotView};
pub use trouble::Trouble;

use crate::frames::WristSample;

/// Where the force on the instrument is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "made and used within one tick, where a box would be an allocation")]
pub enum Sensed {
    /// At the tip: the force of the tissue on it, N.
    AtTip(Vector3<f64>),
    /// At the wrist: with weight, friction and bias in it, which calibrations take out.
    AtWrist(WristSample),
}

/// One exchange's worth of measurements of an arm pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inputs {
    /// Position of the leader's handle, mapped into the workspace, m.
    pub leader_m: Vector3<f64>,
    /// Position of the instrument's tip, m.
    pub tip_m: Vector3<f64>,
    /// What the force sensor says.
    pub sensed: Sensed,
}

impl Inputs {
    /// Every number in it is finite.
    pub fn is_finite(&self) -> bool {
        let sensed = match &self.sensed {
            Sensed::AtTip(force_n) => force_n.iter().all(|x| x.is_finite()),
            Sensed::AtWrist(sample) => sample.is_finite(),
        };
        sensed && self.leader_m.iter().chain(self.tip_m.iter()).all(|x| x.is_finite())
    }
}

/// What the loop commands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outputs {
    /// Where the tip shall go, m; `None` holds the follower where it is.
    pub tip_command_m: Option<Vector3<f64>>,
    /// Force on the hand, N. Has passed every gate.
    pub hand_force_n: Vector3<f64>,
    /// What the screen asks of the person at the arm.
    pub prompt: Prompt,
    /// Where the person at the screen leads the handle with mouse or keyboard, m; `None`: nobody does.
    pub guide_m: Option<Vector3<f64>>,
}

impl Outputs {
    /// The safe outputs: no force, a resting follower.
    pub const SAFE: Self =
        Self { tip_command_m: None, hand_force_n: Vector3::new(0.0, 0.0, 0.0), prompt: Prompt::Rest, guide_m: None };
}

/// A device that is open and delivers.
///
/// The real-time thread owns it: [`poll`](Self::poll) must neither wait nor allocate.
pub trait Device: Send {
    /// What it reads.
    type Reading: Copy + Send;

    /// Takes in all that has arrived until `now_s` (loop time) and gives the newest reading since the last call, if any. What is
    /// lost, damaged or refused is counted in [`Device::health`]; a device that is lost stays so until it is opened again.
    fn poll(&mut self, now_s: f64) -> Option<Stamped<Self::Reading>>;

    /// How it is.
    fn health(&self) -> &Health;

    /// Who it is.
    fn identity(&self) -> &Identity;
}

/// A leader, a follower and a force sensor that belong together. Owned by the real-time thread.
pub trait Rig: Send {
    /// Applies `outputs` and gives the newest measurements at loop time `now_s`; `None` when there are none.
    ///
    /// Must not block and must not allocate.
    fn exchange(&mut self, now_s: f64, outputs: &Outputs) -> Option<Inputs>;

    /// A device that came or went since the last call; call until `None`. Rigs without devices have none.
    fn event(&mut self) -> Option<DeviceEvent> {
        None
    }

    /// How the devices are, in the order of the rig's [`Roster`].
    fn health(&self) -> Healths {
        Healths::default()
    }
}

/// Most devices of a rig.
pub const DEVICES_MAX: usize = 16;

/// How every device of a rig is.
#[derive(Clone, Copy, Debug, Default)]
pub struct Healths {
    /// In the order of the roster; those beyond its end are closed.
    pub devices: [Health; DEVICES_MAX],
}

/// A device came or went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeviceEvent {
    /// When it was noticed, s on the loop's clock.
    pub t_s: f64,
    /// Its place in the roster.
    pub device: u8,
    /// Where it is now.
    pub standing: Standing,
}

/// One device of a rig, as everybody but the real-time thread sees it.
#[derive(Clone, Debug)]
pub struct RosterEntry {
    /// Its name in the rig: `left wrist sensor`.
    pub name: String,
    /// What drives it: `Bota socket 192.168.1.1`.
    pub driver: String,
    /// Connects, disconnects, tells troubles.
    pub view: SlotView,
}

/// The devices of a rig.
pub type Roster = Vec<RosterEntry>;
