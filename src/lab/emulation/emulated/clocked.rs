//! The world of an emulated arm pair on the virtual clock: the readings of its devices as returned by their drivers,
//! without connections and threads.
//!
//! Takes the loop's outputs; returns readings in the devices' own frames and units, each at its own rate and on its own
//! clock. The caller converts them to measurements as a rig with devices does ([`SideReadings`]).

use nima_core::kinematics::{Inverse, Joints};
use nima_devices::{ARM_JOINTS, ArmReading, ForceReading, HandleReading, TimedReading};
use nima_machine::rig::{Flaws, Outputs, RigSettings, Side, SideReadings};
use nima_simulation::scene::Scene;

use super::{EmulatedRigError, HandFrame, SideWorld, of_side};
use crate::emulators::{force_dimension::MotorOutput, kinova::BodyCommand};

/// Kind of devices, which determines the form of their readings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wiring {
    /// An Omega and a Gen3, which send no time stamps, and a Bota sensor, which sends a time stamp and `f32`.
    Emulated,
    /// Devices of a lab's own design: they send time stamps and `f64`, and the sensor measures 500 times per second.
    External,
}

/// Clock of an external device when the world begins, s. Far from zero, so that a driver that confuses the two clocks
/// is noticed at once.
const BEGAN_S: f64 = 1234.5;
/// Period of an external sensor, s, and its offset relative to the loop. Half the rate of the loop, so that every
/// second tick has no new reading.
const SENSOR_S: f64 = 2e-3;
const SENSOR_FROM_S: f64 = 0.3e-3;

/// New readings in a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ArmReadings {
    pub handle: Option<TimedReading<HandleReading>>,
    pub arm: Option<TimedReading<ArmReading>>,
    pub sensor: Option<TimedReading<ForceReading>>,
}

/// The devices of one side around their world.
#[derive(Clone, Debug)]
pub struct ClockedSide {
    world: SideWorld,
    wiring: Wiring,
    applied: MotorOutput,
    asked: BodyCommand,
    inverse: Option<Inverse>,
    servoing: bool,
    sensor_s: f64,
}

impl ClockedSide {
    /// Creates the devices of this side of the rig, in this scene.
    ///
    /// # Errors
    /// [`EmulatedRigError`] if the rig has no such arm, or arm, trocar and scene do not fit together.
    pub fn new(
        side: Side,
        devices: &RigSettings,
        scene: &Scene,
        hand: HandFrame,
        wiring: Wiring,
    ) -> Result<Self, EmulatedRigError> {
        let set = devices.arm(side).ok_or(EmulatedRigError::NoArm)?;
        Ok(Self {
            world: of_side(side, set, scene, hand, Flaws::default())?,
            wiring,
            applied: MotorOutput::default(),
            asked: BodyCommand::Rest,
            inverse: None,
            servoing: false,
            sensor_s: SENSOR_FROM_S,
        })
    }

    /// Returns the devices' readings at loop time `now_s`.
    pub fn read(&mut self, now_s: f64) -> ArmReadings {
        let device_s = (self.wiring == Wiring::External).then_some(BEGAN_S + now_s);
        let held = self.world.hold(now_s, &self.applied);
        let body = self.world.ask(now_s, &self.asked);
        let handle = HandleReading {
            position_m: held.position_m,
            orientation: Some(held.orientation),
            gripper_rad: Some(held.gripper_rad),
            velocity_m_s: None,
            buttons: held.buttons,
        };
        let arm = ArmReading {
            joint_rad: self.report(&body.joint_rad),
            joint_rad_s: body.joint_rad_s,
            joint_nm: body.joint_nm,
            servoing: self.servoing,
        };
        ArmReadings {
            handle: Some(TimedReading { device_s, arrival_s: now_s, value: handle }),
            arm: Some(TimedReading { device_s, arrival_s: now_s, value: arm }),
            sensor: self.sense(now_s),
        }
    }

    fn sense(&mut self, now_s: f64) -> Option<TimedReading<ForceReading>> {
        let mut felt = self.world.feel(now_s);
        if self.wiring == Wiring::Emulated {
            let wire = |number: f64| f64::from(number as f32);
            (felt.wrench.force_n, felt.wrench.torque_nm) =
                (felt.wrench.force_n.map(wire), felt.wrench.torque_nm.map(wire));
            felt.acceleration_m_s2 = felt.acceleration_m_s2.map(|acceleration| acceleration.map(wire));
            return Some(TimedReading { device_s: Some(now_s), arrival_s: now_s, value: felt });
        }
        let is_due = now_s >= self.sensor_s;
        let measured_s = self.sensor_s;
        self.sensor_s += if is_due { SENSOR_S } else { 0.0 };
        is_due.then_some(TimedReading { device_s: Some(BEGAN_S + measured_s), arrival_s: now_s, value: felt })
    }

    /// Returns the angles in the resolution of the wire, rad.
    fn report(&self, joint_rad: &[f64; ARM_JOINTS]) -> [f64; ARM_JOINTS] {
        match self.wiring {
            Wiring::Emulated => joint_rad.map(|rad| f64::from(rad.to_degrees() as f32).to_radians()),
            Wiring::External => *joint_rad,
        }
    }

    /// Passes the loop's outputs to the devices; `measured` is the rig's view of them.
    pub fn write(&mut self, outputs: &Outputs, measured: &SideReadings) {
        self.servoing = outputs.drives;
        self.applied.force_n = if outputs.drives { outputs.hand_force_n } else { nalgebra::Vector3::zeros() };
        let Some(joints) = measured.joints_rad().map(Joints::from).filter(|_| outputs.drives) else {
            self.inverse = None;
            self.asked = BodyCommand::Rest;
            return;
        };
        let Some(target_m) = outputs.tip_command_m else {
            self.inverse = None;
            return;
        };
        if self.inverse.is_none() {
            self.inverse = measured.begin(&joints).ok();
        }
        if let Some(inverse) = &mut self.inverse {
            inverse.observe(&joints);
            self.asked = BodyCommand::Joints(inverse.step(&target_m).joint_rad.into());
        }
    }
}
