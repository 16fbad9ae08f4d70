//! The rig whose devices fail: the simulated one, or an arm pair whose readings are processed like those of a rig with
//! devices.
//!
//! A fault alters readings in the device's own frame; the loop's inputs are computed from them afterwards. For the
//! simulated rig, which has no jointed arm, inputs and readings are the same.

use nalgebra::Vector3;
use nima_core::{
    frames::WristSample,
    kinematics::{Inverse, Joints},
    safety::{RawReading, RawReadings},
};
use nima_devices::TimedReading;
use nima_emulation::emulated::{ArmReadings, ClockedSide, HandFrame};
use nima_machine::{
    config::RigConfig,
    rig::{
        DeliveringDevices, Inputs, Outputs, PlannedTip, Rig as _, SIDES, SensedForce, SensorPlace, Side, SideReadings,
    },
};
use nima_simulation::{Worlds, scene::Scene};

use super::{FaultKind, FaultsError, SensorAt, inject::FAULTY};
use crate::validation::ValidationError;

/// The drivers refuse numbers beyond this, N.
const POSSIBLE_N: f64 = 1e4;
/// Jump of a joint, and drift of a joint, rad and rad/s.
const JOINT_JUMP_RAD: f64 = 0.2;
const JOINT_DRIFT_RAD_S: f64 = 0.02;
const PERIOD_S: f64 = 1e-3;

/// The devices of an arm pair, the measurements computed from their readings, and the measurements without the fault.
#[derive(Clone, Debug)]
pub(super) struct ArmRig {
    devices: ClockedSide,
    given: SideReadings,
    truth: SideReadings,
    newest: ArmReadings,
    /// The last readings, kept for ticks without new ones.
    known: ArmReadings,
    joints_first: Option<[f64; 7]>,
    block: Vec<[f64; 7]>,
    /// The plan of the rig, which knows nothing of a fault of the arm.
    plan: Option<Inverse>,
}

/// A simulated rig or an arm pair.
#[derive(Clone, Debug)]
pub(super) enum FaultSubject {
    Simulated(Box<Worlds>),
    Arm(Box<ArmRig>),
}

impl FaultSubject {
    pub(super) fn new(sensor: SensorAt, config: &RigConfig, scene: &Scene) -> Result<Self, FaultsError> {
        let Some(wiring) = sensor.wiring() else {
            return Ok(Self::Simulated(Box::new(Worlds::new(scene, config.rate_hz))));
        };
        let wrong = |reason: String| FaultsError::Calibration(ValidationError::Calibration(reason));
        let none = || wrong("the emulated rig has no right arm".to_owned());
        let mut devices = RigConfig::load("emulated")?.devices.ok_or_else(none)?;
        let set = devices.right.as_mut().ok_or_else(none)?;
        set.sensor_at = if sensor.is_at_wrist() { SensorPlace::Wrist } else { SensorPlace::Tip };
        let measured = SideReadings::new(Side::Right, set, PERIOD_S, sensor.is_at_wrist());
        let measured = measured.map_err(|error| wrong(error.to_string()))?;
        let hand = HandFrame::of(&config.teleoperation.mapping());
        let clocked = ClockedSide::new(Side::Right, &devices, scene, hand, wiring);
        Ok(Self::Arm(Box::new(ArmRig {
            devices: clocked.map_err(|error| wrong(error.to_string()))?,
            given: measured.clone(),
            truth: measured,
            newest: ArmReadings::default(),
            known: ArmReadings::default(),
            joints_first: None,
            block: Vec::new(),
            plan: None,
        })))
    }

    /// Returns whether the readings are altered before the inputs are computed from them.
    pub(super) const fn is_arm(&self) -> bool {
        matches!(self, Self::Arm(_))
    }

    /// Removes an earlier fault.
    pub(super) fn begin(&mut self) {
        if let Self::Arm(arm) = self {
            arm.joints_first = None;
            arm.block.clear();
        }
    }

    /// Passes outputs to the rig and reads it: returns the true inputs, and those of the failing side for alteration.
    /// `wanted`: outputs of the loop for the failing side; the rig plans the motion of its joints by them.
    pub(super) fn read(
        &mut self,
        now_s: f64,
        outputs: &[Outputs; SIDES],
        wanted: &Outputs,
    ) -> ([Option<Inputs>; SIDES], Option<Inputs>) {
        match self {
            Self::Simulated(worlds) => {
                worlds.write(now_s, outputs);
                let truth = worlds.read(now_s);
                (truth, truth[FAULTY])
            }
            Self::Arm(arm) => {
                arm.plan(wanted);
                let seen = arm.read(now_s, &outputs[FAULTY]);
                let mut truth = [None; SIDES];
                truth[FAULTY] = arm.truth.inputs(now_s, DELIVERING);
                (truth, seen)
            }
        }
    }

    /// Returns the loop's inputs for these altered readings; `None` if the sensor returns nothing.
    pub(super) fn give(
        &mut self,
        now_s: f64,
        altered: Option<&Inputs>,
        fault: Option<FaultKind>,
        age: u32,
    ) -> Option<Inputs> {
        match self {
            Self::Simulated(_) => altered.map(|inputs| Inputs { raw: raw_of(inputs), ..*inputs }),
            Self::Arm(arm) => arm.give(now_s, altered, fault, age),
        }
    }
}

const DELIVERING: DeliveringDevices = DeliveringDevices { handle: Some(true), follower: Some(true) };

/// Returns the readings of a simulated rig that correspond to these inputs, at the times of the true ones.
fn raw_of(inputs: &Inputs) -> RawReadings {
    let RawReadings { handle, sensor, .. } = inputs.raw;
    let parts = match &inputs.sensed {
        SensedForce::AtTip(force_n) => [Some((*force_n).into()), None, None],
        SensedForce::AtWrist(sample) => {
            let acceleration = sample.acceleration_m_s2.map(Into::into);
            [Some(sample.raw.force_n.into()), Some(sample.raw.torque_nm.into()), acceleration]
        }
        SensedForce::FarEnd(_) => [None; 3],
    };
    RawReadings {
        handle: handle.map(|raw| RawReading { channels: inputs.hand.position_m.into(), ..raw }),
        arm: None,
        sensor: sensor.map(|raw| RawReading::of_sensor(parts, raw.device_s, raw.arrival_s)),
    }
}

impl ArmRig {
    fn plan(&mut self, wanted: &Outputs) {
        let joints = self.given.joints_rad().map(Joints::from);
        let Some((joints, target_m)) = joints.zip(wanted.tip_command_m.filter(|_| wanted.drives)) else {
            self.plan = None;
            return;
        };
        if self.plan.is_none() {
            self.plan = self.given.begin(&joints).ok();
        }
        if let Some(plan) = &mut self.plan {
            plan.observe(&joints);
            plan.step(&target_m);
        }
    }

    /// Reads the devices; returns force and handle as inputs, in the frames of their devices.
    fn read(&mut self, now_s: f64, outputs: &Outputs) -> Option<Inputs> {
        self.devices.write(outputs, &self.given);
        self.newest = self.devices.read(now_s);
        let ArmReadings { handle, arm, sensor } = self.newest;
        let known = &mut self.known;
        known.handle = handle.or(known.handle);
        known.arm = arm.or(known.arm);
        known.sensor = sensor.or(known.sensor);
        take(&mut self.truth, &self.newest, outputs.drives);
        let handle = self.known.handle?;
        let force = self.known.sensor?;
        let sample =
            WristSample { acceleration_m_s2: force.value.acceleration_m_s2, ..WristSample::of(force.value.wrench) };
        Some(Inputs {
            hand: nima_core::kinematics::HandPose::at(handle.value.position_m),
            sensed: SensedForce::AtWrist(sample),
            ..Inputs::NOTHING
        })
    }

    fn give(&mut self, now_s: f64, altered: Option<&Inputs>, fault: Option<FaultKind>, age: u32) -> Option<Inputs> {
        let mut report = self.newest;
        report.sensor = report.sensor.zip(altered).and_then(|(sensor, altered)| {
            let SensedForce::AtWrist(sample) = &altered.sensed else { return None };
            let mut value = sensor.value;
            value.wrench = sample.raw;
            value.acceleration_m_s2 = sample.acceleration_m_s2;
            is_possible(&sample.raw.force_n).then_some(TimedReading { value, ..sensor })
        });
        if let (Some(handle), Some(altered)) = (&mut report.handle, altered) {
            handle.value.position_m = altered.hand.position_m;
        }
        report.handle = report.handle.filter(|handle| is_possible(&handle.value.position_m));
        if let Some(arm) = &mut report.arm {
            let joint_rad = arm.value.joint_rad;
            arm.value.joint_rad = self.joints(fault, age, joint_rad);
        }
        report.arm = report.arm.filter(|_| fault != Some(FaultKind::TipNan));
        take(&mut self.given, &report, self.truth.force_is_on);
        let planned = PlannedTip::of(self.plan.as_ref());
        self.given.inputs(now_s, DELIVERING).map(|inputs| Inputs { planned, ..inputs })
    }

    fn joints(&mut self, fault: Option<FaultKind>, age: u32, mut joint_rad: [f64; 7]) -> [f64; 7] {
        let first = *self.joints_first.get_or_insert(joint_rad);
        match fault {
            Some(FaultKind::TipFrozen) => joint_rad = first,
            Some(FaultKind::TipJump) => joint_rad[3] += JOINT_JUMP_RAD,
            Some(FaultKind::TipDrift) => joint_rad[3] += JOINT_DRIFT_RAD_S * f64::from(age) * PERIOD_S,
            Some(FaultKind::TipBlock) => {
                let place = age.saturating_sub(1) as usize;
                if place < FaultKind::BLOCK {
                    self.block.push(joint_rad);
                } else {
                    joint_rad = self.block[place % FaultKind::BLOCK];
                }
            }
            _ => {}
        }
        joint_rad
    }
}

fn take(measured: &mut SideReadings, readings: &ArmReadings, drives: bool) {
    readings.handle.into_iter().for_each(|reading| measured.take_handle(reading));
    readings.arm.into_iter().for_each(|reading| measured.take_arm(reading));
    readings.sensor.into_iter().for_each(|reading| measured.take_force(reading));
    measured.force_is_on = drives;
}

fn is_possible(numbers: &Vector3<f64>) -> bool {
    numbers.iter().all(|number| number.abs() <= POSSIBLE_N)
}
