//! The rig as an interface for the loop, and its implementation with devices.
//!
//! Positions in m, forces in N, both in the workspace frame (z up). A rig that cannot deliver a sample returns `None`;
//! it never repeats an old sample as a new one.

mod arm_model;
mod arm_pair;
pub mod checkup;
#[cfg(test)]
mod checkup_tests;
mod device_identity;
mod device_search;
mod devices;
mod doubles;
mod engage_blocker;
mod flaws;
mod gauge;
mod identified;
mod jaws;
#[cfg(test)]
mod joint_limits_tests;
mod lengths;
mod makes;
mod nominal;
mod part;
mod places;
mod probes;
mod prompt;
mod settings;
mod starting;
mod task_actions;
mod watch;

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
pub use nima_core::{SIDES, Side};
use nima_core::{
    calibration::frames::FrameSample,
    frames::WristSample,
    kinematics::{HandPose, Inverse},
    safety::RawReadings,
};
use nima_devices::{ClearFaults, ConnectionState, Health, Lever, SlotView};

use crate::messages::{Command, PeerStatus};

pub use arm_model::ArmModelSettings;
pub use arm_pair::{ArmPair, DeliveringDevices, SideReadings};
pub use device_identity::CheckedDevices;
pub use device_search::{DeviceOffer, SearchResult, seek};
pub use devices::{DeviceRig, RigError};
pub use engage_blocker::{AwaitedDevice, EngageBlocker, SideSwap};
pub use flaws::Flaws;
pub use gauge::{AGES, CHANNELS, Gauge, GaugeSpread, Gauges};
pub use identified::RemoteIdentification;
pub use jaws::JawsSettings;
pub use makes::{FollowerSettings, LeaderSettings, SensorSettings};
pub(crate) use makes::{Misread, take_out_makes};
pub use nominal::Nominal;
pub use part::{DeviceName, DeviceRole, PartKind, RigPart};
pub use probes::rig_probes;
pub use prompt::Prompt;
pub use settings::{ArmSet, DeskSettings, EndoscopeSettings, RigEnds, RigSettings, SensorPlace};
pub use task_actions::{Acts, TaskAction};
pub use watch::DeviceWatch;

/// The force measurement, by the location of the sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "made and used within one tick, where a box would be an allocation")]
pub enum SensedForce {
    /// At the tip: force of the tissue on the tip, N.
    AtTip(Vector3<f64>),
    /// At the wrist: includes weight, trocar friction and bias, which the calibrations remove.
    AtWrist(WristSample),
    /// Measured by another machine at the other end of a network, which also identifies the force.
    FarEnd(RemoteIdentification),
}

impl SensedForce {
    /// Returns the sample of a sensor at the wrist.
    pub const fn wrist(&self) -> Option<&WristSample> {
        match self {
            Self::AtWrist(sample) => Some(sample),
            Self::AtTip(_) | Self::FarEnd(_) => None,
        }
    }
}

/// State of the pedals and of the handle's presence detection.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Switches {
    /// The clutch is pressed: the hand moves without moving the tip.
    pub clutch: bool,
    /// Whether a hand holds the handle; `None` if the rig cannot detect it.
    pub presence: Option<bool>,
}

/// Orientation of the endoscope; the hand's motion is mapped to the tip's motion in the frame of its image.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ViewOrientation {
    /// Fixed, as given in the rig file.
    #[default]
    Fixed,
    /// The rig's tracker does not detect the endoscope: the mapping is unknown.
    Unseen,
    /// `world_from_view`, measured by a tracker.
    Seen(UnitQuaternion<f64>),
    /// Like `Seen`, with the position of the marker, because hand-eye calibrations give the tracker's pose.
    SeenAt {
        /// Orientation of the image.
        world_from_view: UnitQuaternion<f64>,
        world_from_n: Isometry3<f64>,
    },
}

impl ViewOrientation {
    /// Returns the orientation of the image, if a tracker measures it.
    pub const fn world_from_view(&self) -> Option<&UnitQuaternion<f64>> {
        match self {
            Self::Seen(world_from_view) | Self::SeenAt { world_from_view, .. } => Some(world_from_view),
            Self::Fixed | Self::Unseen => None,
        }
    }

    /// Returns the pose of the endoscope's marker, if it is known.
    pub const fn world_from_n(&self) -> Option<&Isometry3<f64>> {
        match self {
            Self::SeenAt { world_from_n, .. } => Some(world_from_n),
            Self::Fixed | Self::Unseen | Self::Seen(_) => None,
        }
    }

    fn is_finite(&self) -> bool {
        self.world_from_view().is_none_or(|q| q.coords.iter().all(|x| x.is_finite()))
            && self.world_from_n().is_none_or(|pose| pose.to_homogeneous().iter().all(|x| x.is_finite()))
    }
}

/// Tip position commanded to the arm, m, within the limits of joints and trocar, so it may lag behind the hand's
/// command. `None` if the arm has no joints here or is at rest, and if the plan waits for a blocked arm: then the
/// hand's command is what the arm should follow.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlannedTip(pub Option<Vector3<f64>>);

impl PlannedTip {
    pub fn of(plan: Option<&Inverse>) -> Self {
        Self(plan.filter(|plan| !plan.is_blocked()).map(|plan| plan.pose().tip_m))
    }
}

/// The measurements of an arm pair at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inputs {
    pub hand: HandPose,
    /// Opening of the gripper, rad, if the handle has one.
    pub gripper_rad: Option<f64>,
    /// Force that opens the jaws, N at the finger, if known.
    pub grip_n: Option<f64>,
    pub tip_m: Vector3<f64>,
    /// Tip position commanded to the arm one tick ago.
    pub planned: PlannedTip,
    /// Orientation of the instrument's jaws, if known.
    pub world_from_jaws: Option<UnitQuaternion<f64>>,
    pub sensed: SensedForce,
    pub view: ViewOrientation,
    /// Input of the frame calibrations. Not checked by [`Inputs::is_finite`], because no force depends on it.
    pub frames: FrameSample,
    /// Clutch and presence.
    pub switches: Switches,
    /// The drives are on: the arm follows commands and the handle's motors are powered.
    pub powered: bool,
    /// Reason why the arm cannot be engaged from its current position.
    pub obstacle: Option<EngageBlocker>,
    /// Age of the oldest part, s, because the devices sample on their own clocks. Zero in a simulation.
    pub age_s: f64,
    /// Time since the last message over the network that joins the two halves of the rig, s; zero for a rig in one
    /// place.
    pub silent_s: f64,
    /// The devices' readings from which all other fields were computed.
    pub raw: RawReadings,
}

impl Inputs {
    /// No measurement: everything is at rest at the origin, without a force, and switched off.
    pub const NOTHING: Self = Self {
        hand: HandPose::at(Vector3::new(0.0, 0.0, 0.0)),
        gripper_rad: None,
        grip_n: None,
        tip_m: Vector3::new(0.0, 0.0, 0.0),
        planned: PlannedTip(None),
        world_from_jaws: None,
        sensed: SensedForce::AtTip(Vector3::new(0.0, 0.0, 0.0)),
        view: ViewOrientation::Fixed,
        frames: FrameSample {
            base_from_flange: None,
            other_base_from_flange: None,
            c_from_m: None,
            c_from_other_m: None,
            leader_from_handle: None,
            wrench: None,
        },
        switches: Switches { clutch: false, presence: None },
        powered: false,
        obstacle: None,
        age_s: 0.0,
        silent_s: 0.0,
        raw: RawReadings::NONE,
    };

    /// Returns the time of the handle's reading, s; `now_s` is the time of the tick (s).
    pub fn hand_s(&self, now_s: f64) -> f64 {
        self.raw.handle.map_or(now_s - self.age_s, |reading| reading.arrival_s)
    }

    pub fn is_finite(&self) -> bool {
        let sensed = match &self.sensed {
            SensedForce::AtTip(force_n) => force_n.iter().all(|x| x.is_finite()),
            SensedForce::AtWrist(sample) => sample.is_finite(),
            SensedForce::FarEnd(identified) => identified.is_finite(),
        };
        sensed
            && self.hand.is_finite()
            && self.tip_m.iter().all(|x| x.is_finite())
            && self.planned.0.is_none_or(|tip_m| tip_m.iter().all(|x| x.is_finite()))
            && self.world_from_jaws.is_none_or(|q| q.coords.iter().all(|x| x.is_finite()))
            && self.gripper_rad.is_none_or(f64::is_finite)
            && self.grip_n.is_none_or(f64::is_finite)
            && self.view.is_finite()
            && self.age_s.is_finite()
            && self.silent_s.is_finite()
            && self.raw.is_finite()
    }
}

/// Maximum distance from the centre of the workspace to which the screen may guide a handle ([`Outputs::guide_m`]), on
/// each axis, m.
pub const GUIDE_MAX_M: f64 = 0.1;
/// Maximum opening at which the screen may hold a gripper ([`Outputs::grip_rad`]), rad.
pub const GRIP_MAX_RAD: f64 = 1.2;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outputs {
    /// Drives and motors may be on. If false, the arm brakes to rest and the handle has no force.
    pub drives: bool,
    /// Commanded tip position, m; `None` holds the follower at its position.
    pub tip_command_m: Option<Vector3<f64>>,
    /// Commanded orientation of the jaws; `None` holds the orientation.
    pub world_from_jaws: Option<UnitQuaternion<f64>>,
    /// Force on the hand, N, in the frame of its device, after all gates.
    pub hand_force_n: Vector3<f64>,
    /// Force on the gripper, N, after its gates.
    pub gripper_n: f64,
    /// Instruction of the screen to the person at the arm.
    pub prompt: Prompt,
    /// Position to which the operator guides the handle with mouse or keyboard, m; `None` without guidance.
    pub guide_m: Option<Vector3<f64>>,
    /// Opening at which the operator holds the gripper from the screen, rad; `None` without.
    pub grip_rad: Option<f64>,
    /// Acts of the operator in a training task.
    pub acts: Acts,
    /// The simulated hand has released the handle.
    pub lets_go: bool,
}

impl Outputs {
    /// Safe outputs: no force, follower at rest, drives off.
    pub const SAFE: Self = Self {
        drives: false,
        tip_command_m: None,
        world_from_jaws: None,
        hand_force_n: Vector3::new(0.0, 0.0, 0.0),
        gripper_n: 0.0,
        prompt: Prompt::Rest,
        guide_m: None,
        grip_rad: None,
        acts: Acts::NONE,
        lets_go: false,
    };
}

/// The hardware, or its simulation, of both sides. Owned by the real-time thread.
pub trait Rig: Send {
    /// Returns the newest measurements at loop time `now_s`; `None` for a side without measurements.
    ///
    /// Must not block and must not allocate.
    fn read(&mut self, now_s: f64) -> [Option<Inputs>; SIDES];

    /// Sends the outputs of this tick, computed from the measurements of the same tick, so that a force does not wait
    /// for the next period. A simulated world holds them until the next [`Rig::read`]. Until the first call,
    /// [`Outputs::SAFE`] applies.
    ///
    /// Must not block and must not allocate.
    fn write(&mut self, now_s: f64, outputs: &[Outputs; SIDES]);

    /// Receives the state of the pairs for the machine at the other end of a network, once per tick, after
    /// [`Rig::write`]. A rig in one place ignores it.
    ///
    /// Must not block and must not allocate.
    fn receive_status(&mut self, _now_s: f64, _bulletins: &[Option<PeerStatus<'_>>; SIDES]) {}

    /// Returns the next command of the operator at the other end of a network; call until it returns `None`.
    fn command(&mut self) -> Option<Command> {
        None
    }

    /// Returns the next device that connected or was lost; call until it returns `None`. Rigs without devices have no
    /// events.
    fn event(&mut self) -> Option<DeviceEvent> {
        None
    }

    /// Returns the levers that the supervisor may call when the loop no longer runs. Called once, before the loop
    /// starts.
    fn levers(&self) -> Vec<Lever> {
        Vec::new()
    }

    /// Returns the health of the devices, in the order of the rig's [`Roster`].
    fn health(&self) -> Healths {
        Healths::default()
    }

    /// Returns the deliveries of the devices since the last call; `None` for a rig without devices.
    ///
    /// Must not block and must not allocate.
    fn gauges(&mut self, _now_s: f64) -> Option<Gauges> {
        None
    }
}

/// The device methods of [`Rig`], forwarded by a rig to the inner rig that has the devices:
/// `devices_of!(self, self.local)`.
macro_rules! devices_of {
    ($self:ident, $rig:expr) => {
        fn event(&mut $self) -> Option<$crate::rig::DeviceEvent> {
            ($rig).event()
        }

        fn levers(&$self) -> Vec<nima_devices::Lever> {
            ($rig).levers()
        }

        fn health(&$self) -> $crate::rig::Healths {
            ($rig).health()
        }

        fn gauges(&mut $self, now_s: f64) -> Option<$crate::rig::Gauges> {
            ($rig).gauges(now_s)
        }
    };
}
pub(crate) use devices_of;

impl<R: Rig + ?Sized> Rig for Box<R> {
    fn read(&mut self, now_s: f64) -> [Option<Inputs>; SIDES] {
        (**self).read(now_s)
    }

    fn write(&mut self, now_s: f64, outputs: &[Outputs; SIDES]) {
        (**self).write(now_s, outputs);
    }

    fn receive_status(&mut self, now_s: f64, bulletins: &[Option<PeerStatus<'_>>; SIDES]) {
        (**self).receive_status(now_s, bulletins);
    }

    fn command(&mut self) -> Option<Command> {
        (**self).command()
    }

    devices_of!(self, **self);
}

pub const DEVICES_MAX: usize = 16;

#[derive(Clone, Copy, Debug, Default)]
pub struct Healths {
    /// Health of each device, in the order of the roster; entries beyond its end are `closed`.
    pub devices: [Health; DEVICES_MAX],
    /// Reason why an arm that delivers data cannot be engaged from its current position.
    pub obstacles: [Option<EngageBlocker>; SIDES],
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeviceEvent {
    /// Time of detection, s on the loop's clock.
    pub t_s: f64,
    /// Index into the roster.
    pub device: u8,
    pub standing: ConnectionState,
    /// Sides whose force path requires the device.
    pub of_side: [bool; SIDES],
}

/// One device of a rig, for threads other than the real-time thread.
#[derive(Clone, Debug)]
pub struct RosterEntry {
    pub role: DeviceRole,
    /// Name of its driver and address: `Bota socket 192.168.1.1`.
    pub driver: String,
    /// Connects and disconnects the device, and reports why it is not connected.
    pub view: SlotView,
    /// Part for which the device is used; `None` for a device that controls a simulated rig.
    pub part: Option<RigPart>,
    /// Clears the faults of the device itself, if it has such a command; carried out when the device is next opened.
    pub clear_faults: Option<ClearFaults>,
}

impl RosterEntry {
    /// Creates an entry for a device that is not a part of the rig and has no faults to clear.
    pub fn new(role: DeviceRole, driver: impl Into<String>, view: SlotView) -> Self {
        Self { role, driver: driver.into(), view, part: None, clear_faults: None }
    }

    /// Creates an entry for a part of the rig.
    pub fn of(part: RigPart, driver: impl Into<String>, view: SlotView) -> Self {
        Self { part: Some(part), ..Self::new(DeviceRole::Part(part), driver, view) }
    }

    /// Returns the name in files and in English text.
    pub const fn name(&self) -> &'static str {
        self.role.name()
    }

    /// Returns the side of the arm that carries the device, if it is a force sensor at an arm: calibrations are bound
    /// to it.
    pub const fn force_sensor_of(&self) -> Option<Side> {
        match self.part {
            Some(RigPart::Sensor(side)) => Some(side),
            _ => None,
        }
    }
}

pub type Roster = Vec<RosterEntry>;
