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
mod lever;
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

use nalgebra::{UnitQuaternion, Vector3};

pub use health::{Health, Identity, Loss, Standing};
pub use lever::Lever;
pub use prompt::Prompt;
pub use reading::{
    ARM_JOINTS, ArmReading, CapReading, ForceReading, ForceStatus, HandleReading, PedalReading, SERVOS, ServoReading,
    Stamped, TRACKED_TOOLS, Tracked, TrackerReading,
};
pub use side::{SIDES, Side};
pub use slot::{Slot, SlotReport, SlotView};
pub use trouble::Trouble;

use crate::{frames::WristSample, kinematics::Hand};

/// Where the force on the instrument is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "made and used within one tick, where a box would be an allocation")]
pub enum Sensed {
    /// At the tip: the force of the tissue on it, N.
    AtTip(Vector3<f64>),
    /// At the wrist: with weight, friction and bias in it, which calibrations take out.
    AtWrist(WristSample),
}

/// What switches and grips say about the operator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Switches {
    /// The clutch is pressed: the hand moves freely.
    pub clutch: bool,
    /// Somebody holds the handle; `None` where nothing tells.
    pub presence: Option<bool>,
}

/// How the endoscope looks, by which the hand's motion becomes the tip's.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum View {
    /// As the rig file has it.
    #[default]
    Fixed,
    /// A tracker should see it and does not: hand and tip cannot be joined.
    Unseen,
    /// `kbf_from_view` as a tracker sees it.
    Seen(UnitQuaternion<f64>),
}

/// One exchange's worth of measurements of an arm pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inputs {
    /// The hand, as its device sees it.
    pub hand: Hand,
    /// Opening of the gripper, rad, where there is one.
    pub gripper_rad: Option<f64>,
    /// Force that opens the jaws, N at the finger, where it is known.
    pub grip_n: Option<f64>,
    /// Position of the instrument's tip, m.
    pub tip_m: Vector3<f64>,
    /// Orientation of the instrument's jaws, where it is known.
    pub kbf_from_jaws: Option<UnitQuaternion<f64>>,
    /// What the force sensor says.
    pub sensed: Sensed,
    /// How the endoscope looks.
    pub view: View,
    /// Clutch and presence.
    pub switches: Switches,
    /// The drives obey: the arm follows commands, the handle's motors are on.
    pub powered: bool,
    /// Age of the oldest part, s: devices tick by their own clocks. Zero in a simulation.
    pub age_s: f64,
}

impl Inputs {
    /// Every number in it is finite.
    pub fn is_finite(&self) -> bool {
        let sensed = match &self.sensed {
            Sensed::AtTip(force_n) => force_n.iter().all(|x| x.is_finite()),
            Sensed::AtWrist(sample) => sample.is_finite(),
        };
        sensed
            && self.hand.is_finite()
            && self.tip_m.iter().all(|x| x.is_finite())
            && self.kbf_from_jaws.is_none_or(|q| q.coords.iter().all(|x| x.is_finite()))
            && self.gripper_rad.is_none_or(f64::is_finite)
            && self.grip_n.is_none_or(f64::is_finite)
            && !matches!(self.view, View::Seen(q) if !q.coords.iter().all(|x| x.is_finite()))
            && self.age_s.is_finite()
    }
}

/// Farthest from the middle of the workspace that a handle may be led ([`Outputs::guide_m`]), on each axis, m.
pub const GUIDE_MAX_M: f64 = 0.1;

/// What the loop commands to an arm pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outputs {
    /// Drives and motors may be on: without it the arm rests by itself and the handle has no force.
    pub drives: bool,
    /// Where the tip shall go, m; `None` holds the follower where it is.
    pub tip_command_m: Option<Vector3<f64>>,
    /// How the jaws shall stand; `None` holds them.
    pub kbf_from_jaws: Option<UnitQuaternion<f64>>,
    /// Force on the hand, N, in the frame of its device. Has passed every gate.
    pub hand_force_n: Vector3<f64>,
    /// Force on the gripper, N. Has passed its gates.
    pub gripper_n: f64,
    /// What the screen asks of the person at the arm.
    pub prompt: Prompt,
    /// Where the person at the screen leads the handle with mouse or keyboard, m; `None`: nobody does.
    pub guide_m: Option<Vector3<f64>>,
}

impl Outputs {
    /// The safe outputs: no force, a resting follower, drives off.
    pub const SAFE: Self = Self {
        drives: false,
        tip_command_m: None,
        kbf_from_jaws: None,
        hand_force_n: Vector3::new(0.0, 0.0, 0.0),
        gripper_n: 0.0,
        prompt: Prompt::Rest,
        guide_m: None,
    };
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

/// Leaders, followers and force sensors that belong together, a pair for each side. Owned by the real-time thread.
pub trait Rig: Send {
    /// Gives the newest measurements at loop time `now_s`; `None` when there are none. Applies `outputs`, unless
    /// [`Rig::apply`] already did.
    ///
    /// Must not block and must not allocate.
    fn exchange(&mut self, now_s: f64, outputs: &[Outputs; SIDES]) -> [Option<Inputs>; SIDES];

    /// Sends what the loop has just made on its way, so that a force does not wait for the next period. A simulated world
    /// takes it with the next exchange, as if it had held since this tick.
    ///
    /// Must not block and must not allocate.
    fn apply(&mut self, now_s: f64, outputs: &[Outputs; SIDES]) {
        let _ = (now_s, outputs);
    }

    /// A device that came or went since the last call; call until `None`. Rigs without devices have none.
    fn event(&mut self) -> Option<DeviceEvent> {
        None
    }

    /// What another thread may pull when the loop no longer runs; asked for once, before the loop begins.
    fn levers(&self) -> Vec<Lever> {
        Vec::new()
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
    /// Why an arm that delivers cannot be engaged from where it is.
    pub obstacles: [Option<rig::Obstacle>; SIDES],
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
    /// The arm pairs whose force path it is part of.
    pub of_side: [bool; SIDES],
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
    /// Clears the device's own faults, where that is a person's command; it happens while it is opened the next time.
    pub clear_faults: Option<ClearFaults>,
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

/// The devices of a rig.
pub type Roster = Vec<RosterEntry>;
