//! The last readings of the devices of one side, and their relations: the basis of the loop's measurements.
//!
//! In: readings in the devices' own frames (m, N, Nm, rad). Out: [`Inputs`] in `world`, together with the unmodified
//! readings.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use nima_core::{
    calibration::frames::FrameSample,
    frames::{WristSample, from_roll_pitch_yaw_deg},
    kinematics::{
        Arm, ArmStartError, HandPose, InstrumentPose, Inverse, JointLimits, Joints, Rcm, START_MISS_M,
        world_from_tracked_view,
    },
    safety::{RawReading, RawReadings},
};
use nima_devices::{ARM_JOINTS, ArmReading, ForceReading, HandleReading, ServoReading, TimedReading};

use super::{SharedReadings, rigid};
use crate::rig::{
    ArmSet, Inputs, RigError, SensedForce, Side, ViewOrientation, devices::OLDEST_S, engage_blocker::EngageBlocker,
    engage_blocker::ExpectedMarker, jaws::JawsControl,
};

/// Whether the devices of the force path deliver data now; `None` for those at another machine.
#[derive(Clone, Copy, Debug)]
pub struct DeliveringDevices {
    pub handle: Option<bool>,
    /// Both arm and sensor.
    pub follower: Option<bool>,
}

#[derive(Clone, Debug)]
pub struct SideReadings {
    pub(super) mount: Arm,
    pub(super) rcm: Rcm,
    pub(super) hand_eye: Option<ExpectedMarker>,
    limits: JointLimits,
    period_s: f64,
    s1_from_m: Option<UnitQuaternion<f64>>,
    at_wrist: bool,
    pub(super) hand: Option<TimedReading<HandleReading>>,
    pub(super) joints: Option<TimedReading<ArmReading>>,
    force: Option<TimedReading<ForceReading>>,
    pub(super) turned: Option<TimedReading<ServoReading>>,
    /// Pose of the instrument from the measured joint angles.
    pub(super) pose: Option<InstrumentPose>,
    /// Reason why the arm cannot be engaged from its current position.
    pub obstacle: Option<EngageBlocker>,
    pub force_is_on: bool,
}

impl SideReadings {
    /// Starts without readings; `at_wrist` gives the place of the force sensor, `period_s` is the period of the
    /// commands to the arm.
    ///
    /// # Errors
    /// [`RigError`] if mount or trocar are invalid.
    pub fn new(side: Side, set: &ArmSet, period_s: f64, at_wrist: bool) -> Result<Self, RigError> {
        let word = side.word();
        let mount = set.kinematics().map_err(|source| RigError::Mount { side: word, source })?;
        Ok(Self {
            mount,
            rcm: Rcm::new(&set.rcm).map_err(|source| RigError::Rcm { side: word, source })?,
            hand_eye: set.hand_eye().map(|[s1_from_m, base_from_c]| ExpectedMarker { s1_from_m, base_from_c }),
            limits: set.arm.joint_limits(mount.model()),
            period_s,
            s1_from_m: set.s1_from_m_deg.as_ref().map(from_roll_pitch_yaw_deg),
            at_wrist,
            hand: None,
            joints: None,
            force: None,
            turned: None,
            pose: None,
            obstacle: None,
            force_is_on: false,
        })
    }

    pub const fn take_handle(&mut self, reading: TimedReading<HandleReading>) {
        self.hand = Some(reading);
    }

    pub fn take_arm(&mut self, reading: TimedReading<ArmReading>) {
        self.pose = Some(self.mount.pose(&Joints::from(reading.value.joint_rad)));
        self.joints = Some(reading);
    }

    /// Stores a new reading of the force sensor; an unusable one invalidates the previous reading.
    pub fn take_force(&mut self, reading: TimedReading<ForceReading>) {
        // A reading that its own sensor marks as invalid counts as missing.
        self.force = Some(reading).filter(|reading| reading.value.status.is_usable());
    }

    /// Returns the last reported angles of the arm's joints, rad.
    pub fn joints_rad(&self) -> Option<[f64; ARM_JOINTS]> {
        self.joints.map(|joints| joints.value.joint_rad)
    }

    /// Starts the inverse kinematics at these joint angles (rad).
    ///
    /// # Errors
    /// [`ArmStartError`] if the arm cannot start there.
    pub fn begin(&self, joint_rad: &Joints) -> Result<Inverse, ArmStartError> {
        Inverse::new(self.mount, self.rcm, self.period_s, joint_rad).map(|inverse| inverse.within(self.limits))
    }

    /// Returns the measurements of a side without servos and shared devices; see [`SideReadings::with`].
    pub fn inputs(&self, now_s: f64, delivering: DeliveringDevices) -> Option<Inputs> {
        self.with(now_s, delivering, None, &SharedReadings::default())
    }

    /// Returns the measurements; `None` unless every device of the force path delivers data and no reading is too old.
    /// A part at another machine is at rest in them, and has no force.
    pub(super) fn with(
        &self,
        now_s: f64,
        delivering: DeliveringDevices,
        jaws: Option<(&JawsControl, bool)>,
        shared: &SharedReadings,
    ) -> Option<Inputs> {
        let led = match delivering.handle {
            // A missing handle ends the sample (`?`): hand and tip are only used together.
            Some(is_there) => Some(self.hand.filter(|hand| is_there && now_s - hand.arrival_s <= OLDEST_S)?),
            None => None,
        };
        let inputs = match delivering.follower {
            Some(is_there) => self.follower_inputs(now_s, jaws, shared).filter(|_| is_there)?,
            // Without the follower's half, there are no drives here that could be off.
            None => Inputs { powered: true, ..Inputs::NOTHING },
        };
        let Some(hand) = led else { return Some(inputs) };
        let HandleReading { position_m, orientation, gripper_rad, .. } = hand.value;
        let turn = orientation.unwrap_or_else(UnitQuaternion::identity);
        let leader_from_handle = Some(Isometry3::from_parts(position_m.into(), turn));
        Some(Inputs {
            hand: HandPose { position_m, orientation },
            gripper_rad,
            frames: FrameSample { leader_from_handle, ..inputs.frames },
            powered: inputs.powered && self.force_is_on,
            // The older of the two ages: a force is as old as its oldest input.
            age_s: inputs.age_s.max(now_s - hand.arrival_s),
            raw: RawReadings { handle: Some(raw(&hand, position_m.into())), ..inputs.raw },
            ..inputs
        })
    }

    fn follower_inputs(
        &self,
        now_s: f64,
        jaws: Option<(&JawsControl, bool)>,
        shared: &SharedReadings,
    ) -> Option<Inputs> {
        let joints = self.joints?;
        let force = self.force?;
        let pose = self.pose.as_ref()?;
        let age_s = [joints.arrival_s, force.arrival_s].map(|at_s| now_s - at_s).into_iter().fold(0.0, f64::max);
        // The joints and the force must be from the same moment, so the older one decides.
        if age_s > OLDEST_S {
            return None;
        }
        let world_from_s1 = pose.orientation();
        let turned = jaws.zip(self.turned);
        let measured = turned.filter(|((_, is_there), _)| *is_there);
        let measured = measured.map(|((control, _), turned)| control.measured(&turned.value));
        Some(Inputs {
            grip_n: turned.and_then(|((control, _), turned)| control.grip_n(&turned.value)),
            tip_m: pose.tip_m,
            world_from_jaws: measured.map(|jaws| world_from_s1 * jaws.s1_from_jaws()),
            sensed: self.sensed(&force.value, pose, &world_from_s1, shared),
            view: self.view(&world_from_s1, shared),
            frames: self.frames(pose, &force.value, shared),
            powered: joints.value.servoing && self.obstacle.is_none(),
            obstacle: self.obstacle,
            age_s,
            raw: RawReadings {
                handle: None,
                arm: Some(raw(&joints, joints.value.joint_rad)),
                sensor: Some(raw_force(&force)),
            },
            ..Inputs::NOTHING
        })
    }

    fn view(&self, world_from_s1: &UnitQuaternion<f64>, shared: &SharedReadings) -> ViewOrientation {
        let ViewOrientation::Seen(c_from_view) = shared.c_from_view else { return shared.c_from_view };
        // Without the marker on the instrument the camera's orientation is unknown.
        let Some((s1_from_m, m_from_c)) = self.s1_from_m.zip(shared.m_from_c()) else { return ViewOrientation::Unseen };
        let world_from_view = world_from_tracked_view(&(world_from_s1 * s1_from_m), &m_from_c, &c_from_view);
        match self.world_from_c().zip(shared.c_from_n) {
            Some((world_from_c, c_from_n)) => {
                ViewOrientation::SeenAt { world_from_view, world_from_n: world_from_c * c_from_n }
            }
            None => ViewOrientation::Seen(world_from_view),
        }
    }

    /// Returns the tracker's pose found by the hand-eye calibration. It is steadier than a pose computed through the
    /// instrument's marker, whose noise would be amplified by a lever of several decimetres.
    fn world_from_c(&self) -> Option<Isometry3<f64>> {
        self.hand_eye.map(|hand_eye| rigid(self.mount.world_from_base()) * hand_eye.base_from_c)
    }

    /// Returns the input of the frame calibrations; the rig adds the other side's poses.
    fn frames(&self, pose: &InstrumentPose, force: &ForceReading, shared: &SharedReadings) -> FrameSample {
        let base_from_flange = self.mount.world_from_base().inverse() * pose.chain.world_from_flange;
        FrameSample {
            base_from_flange: Some(rigid(&base_from_flange)),
            c_from_m: shared.c_from_m,
            wrench: Some(force.wrench),
            ..FrameSample::default()
        }
    }

    fn sensed(
        &self,
        force: &ForceReading,
        pose: &InstrumentPose,
        world_from_s1: &UnitQuaternion<f64>,
        shared: &SharedReadings,
    ) -> SensedForce {
        if !self.at_wrist {
            return SensedForce::AtTip(world_from_s1 * force.wrench.force_n);
        }
        let trocar_m = &self.rcm.settings().trocar_m;
        let in_trocar = pose.axis_miss_m(trocar_m).norm() <= START_MISS_M;
        SensedForce::AtWrist(WristSample {
            raw: force.wrench,
            acceleration_m_s2: force.acceleration_m_s2,
            world_from_s1: Some(*world_from_s1),
            world_from_m: self.s1_from_m.map(|s1_from_m| world_from_s1 * s1_from_m),
            m_from_c: shared.m_from_c(),
            // A tool outside the trocar has no depth.
            insertion_m: Some(pose.insertion_m(trocar_m)).filter(|_| in_trocar),
            tissue_n: shared.tissue_n,
        })
    }
}

const fn raw<T, const N: usize>(reading: &TimedReading<T>, channels: [f64; N]) -> RawReading<N> {
    RawReading { channels, device_s: reading.device_s, arrival_s: reading.arrival_s }
}

fn raw_force(reading: &TimedReading<ForceReading>) -> RawReading<{ nima_core::safety::CHANNELS }> {
    let ForceReading { wrench, acceleration_m_s2, .. } = reading.value;
    let array = |vector: Vector3<f64>| <[f64; 3]>::from(vector);
    let parts = [Some(array(wrench.force_n)), Some(array(wrench.torque_nm)), acceleration_m_s2.map(array)];
    RawReading::of_sensor(parts, reading.device_s, reading.arrival_s)
}
