//! The rig as the loop sees it, and the devices that make one.
//!
//! Positions in m, forces in N, both in the workspace frame (z up). A rig that cannot deliver a sample says so with
//! `None`; it never repeats an old one as new.

mod arm_pair;
mod devices;
mod jaws;
#[cfg(test)]
mod joint_limits_tests;
mod makes;
mod probes;
mod prompt;
mod settings;
mod side;
mod watch;

use nalgebra::{UnitQuaternion, Vector3};
use nima_core::{frames::WristSample, kinematics::Hand};
use nima_devices::{ClearFaults, Health, Lever, SlotView, Standing};

pub use arm_pair::{ArmPair, Obstacle};
pub use devices::{DeviceRig, RigError};
pub use jaws::JawsSettings;
pub use makes::{FollowerSettings, LeaderSettings, SensorSettings};
pub(crate) use makes::{Misread, take_out_makes};
pub use probes::rig_probes;
pub use prompt::Prompt;
pub use settings::{ArmSet, DeskSettings, EndoscopeSettings, SensorPlace, Settings};
pub use side::{SIDES, Side};
pub use watch::Watch;

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
    /// `world_from_view` as a tracker sees it.
    Seen(UnitQuaternion<f64>),
}

/// The measurements of an arm pair at one time.
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
    pub world_from_jaws: Option<UnitQuaternion<f64>>,
    /// What the force sensor says.
    pub sensed: Sensed,
    /// How the endoscope looks.
    pub view: View,
    /// Clutch and presence.
    pub switches: Switches,
    /// The drives obey: the arm follows commands, the handle's motors are on.
    pub powered: bool,
    /// Why the arm cannot be engaged from where it is.
    pub obstacle: Option<Obstacle>,
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
            && self.world_from_jaws.is_none_or(|q| q.coords.iter().all(|x| x.is_finite()))
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
    pub world_from_jaws: Option<UnitQuaternion<f64>>,
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
        world_from_jaws: None,
        hand_force_n: Vector3::new(0.0, 0.0, 0.0),
        gripper_n: 0.0,
        prompt: Prompt::Rest,
        guide_m: None,
    };
}

/// Leaders, followers and force sensors that belong together, a pair for each side. Owned by the real-time thread.
pub trait Rig: Send {
    /// Gives the newest measurements at loop time `now_s`; `None` when there are none.
    ///
    /// Must not block and must not allocate.
    fn read(&mut self, now_s: f64) -> [Option<Inputs>; SIDES];

    /// Sends what the loop made of the measurements of the same tick at once: a force does not wait for the next period. In a simulated
    /// world it holds until the next [`Rig::read`]. Before the first call [`Outputs::SAFE`] holds.
    ///
    /// Must not block and must not allocate.
    fn write(&mut self, now_s: f64, outputs: &[Outputs; SIDES]);

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
    pub obstacles: [Option<Obstacle>; SIDES],
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
    /// It is the force sensor on the arm of this side: calibrations belong to it.
    pub force_sensor_of: Option<Side>,
    /// Clears the device's own faults, where that is a person's command; it happens while it is opened the next time.
    pub clear_faults: Option<ClearFaults>,
}

impl RosterEntry {
    /// A device that belongs to no arm's force path and has no faults that a person clears.
    pub fn new(name: impl Into<String>, driver: impl Into<String>, view: SlotView) -> Self {
        Self { name: name.into(), driver: driver.into(), view, force_sensor_of: None, clear_faults: None }
    }
}

/// The devices of a rig.
pub type Roster = Vec<RosterEntry>;
