//! The last readings of the devices of one side, and their relations: the basis of the loop's measurements.
//!
//! In: readings in the devices' own frames (m, N, Nm, rad). Out: [`Inputs`] in `world`, together with the unmodified
//! readings.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use nima_core::{
    calibration::frames::FrameSample,
    frames::{WristSample, from_roll_pitch_yaw_deg},
    kinematics::{
        Arm, Hand, Inverse, JointLimits, Joints, Pose, Rcm, START_MISS_M, StartError, world_from_tracked_view,
    },
    safety::{Raw, RawReadings},
};
use nima_devices::{ARM_JOINTS, ArmReading, ForceReading, HandleReading, ServoReading, Stamped};

use super::{Shared, rigid};
use crate::rig::{
    ArmSet, Inputs, RigError, Sensed, Side, View, devices::OLDEST_S, jaws::JawsControl, obstacle::HandEye,
    obstacle::Obstacle,
};

/// Whether the devices of the force path deliver data now; `None` for those at another machine.
#[derive(Clone, Copy, Debug)]
pub struct Delivering {
    pub handle: Option<bool>,
    /// Both arm and sensor.
    pub follower: Option<bool>,
}

#[derive(Clone, Debug)]
pub struct Measured {
    pub(super) mount: Arm,
    pub(super) rcm: Rcm,
    pub(super) hand_eye: Option<HandEye>,
    limits: JointLimits,
    period_s: f64,
    s1_from_m: Option<UnitQuaternion<f64>>,
    at_wrist: bool,
    pub(super) hand: Option<Stamped<HandleReading>>,
    pub(super) joints: Option<Stamped<ArmReading>>,
    force: Option<Stamped<ForceReading>>,
    pub(super) turned: Option<Stamped<ServoReading>>,
    /// Pose of the instrument from the measured joint angles.
    pub(super) pose: Option<Pose>,
    /// Reason why the arm cannot be engaged from its current position.
    pub obstacle: Option<Obstacle>,
    pub force_is_on: bool,
}

impl Measured {
    /// Starts without readings; `at_wrist` gives the place of the force sensor, `period_s` is the period of the
    /// commands to the arm.
    ///
    /// # Errors
    /// [`RigError`] if mount or trocar are invalid.
    pub fn new(side: Side, set: &ArmSet, period_s: f64, at_wrist: bool) -> Result<Self, RigError> {
        let word = side.word();
        Ok(Self {
            mount: Arm::new(&set.mount).map_err(|source| RigError::Mount { side: word, source })?,
            rcm: Rcm::new(&set.rcm).map_err(|source| RigError::Rcm { side: word, source })?,
            hand_eye: set.hand_eye().map(|[s1_from_m, base_from_c]| HandEye { s1_from_m, base_from_c }),
            limits: set.arm.joint_limits(),
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

    pub const fn take_handle(&mut self, reading: Stamped<HandleReading>) {
        self.hand = Some(reading);
    }

    pub fn take_arm(&mut self, reading: Stamped<ArmReading>) {
        self.pose = Some(self.mount.pose(&Joints::from(reading.value.joint_rad)));
        self.joints = Some(reading);
    }

    /// Stores a new reading of the force sensor; an unusable one invalidates the previous reading.
    pub fn take_force(&mut self, reading: Stamped<ForceReading>) {
        self.force = Some(reading).filter(|reading| reading.value.status.is_usable());
    }

    /// Returns the last reported angles of the arm's joints, rad.
    pub fn joints_rad(&self) -> Option<[f64; ARM_JOINTS]> {
        self.joints.map(|joints| joints.value.joint_rad)
    }

    /// Starts the inverse kinematics at these joint angles (rad).
    ///
    /// # Errors
    /// [`StartError`] if the arm cannot start there.
    pub fn begin(&self, joint_rad: &Joints) -> Result<Inverse, StartError> {
        Inverse::new(self.mount, self.rcm, self.period_s, joint_rad).map(|inverse| inverse.within(self.limits))
    }

    /// Returns the measurements of a side without servos and shared devices; see [`Measured::with`].
    pub fn inputs(&self, now_s: f64, delivering: Delivering) -> Option<Inputs> {
        self.with(now_s, delivering, None, &Shared::default())
    }

    /// Returns the measurements; `None` unless every device of the force path delivers data and no reading is too old.
    /// A part at another machine is at rest in them, and has no force.
    pub(super) fn with(
        &self,
        now_s: f64,
        delivering: Delivering,
        jaws: Option<(&JawsControl, bool)>,
        shared: &Shared,
    ) -> Option<Inputs> {
        let led = match delivering.handle {
            Some(is_there) => Some(self.hand.filter(|hand| is_there && now_s - hand.arrival_s <= OLDEST_S)?),
            None => None,
        };
        let inputs = match delivering.follower {
            Some(is_there) => self.follower_inputs(now_s, jaws, shared).filter(|_| is_there)?,
            None => Inputs { powered: true, ..Inputs::NOTHING },
        };
        let Some(hand) = led else { return Some(inputs) };
        let HandleReading { position_m, orientation, gripper_rad, .. } = hand.value;
        let turn = orientation.unwrap_or_else(UnitQuaternion::identity);
        let leader_from_handle = Some(Isometry3::from_parts(position_m.into(), turn));
        Some(Inputs {
            hand: Hand { position_m, orientation },
            gripper_rad,
            frames: FrameSample { leader_from_handle, ..inputs.frames },
            powered: inputs.powered && self.force_is_on,
            age_s: inputs.age_s.max(now_s - hand.arrival_s),
            raw: RawReadings { handle: Some(raw(&hand, position_m.into())), ..inputs.raw },
            ..inputs
        })
    }

    fn follower_inputs(&self, now_s: f64, jaws: Option<(&JawsControl, bool)>, shared: &Shared) -> Option<Inputs> {
        let joints = self.joints?;
        let force = self.force?;
        let pose = self.pose.as_ref()?;
        let age_s = [joints.arrival_s, force.arrival_s].map(|at_s| now_s - at_s).into_iter().fold(0.0, f64::max);
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

    fn view(&self, world_from_s1: &UnitQuaternion<f64>, shared: &Shared) -> View {
        let View::Seen(c_from_view) = shared.c_from_view else { return shared.c_from_view };
        let Some((s1_from_m, m_from_c)) = self.s1_from_m.zip(shared.m_from_c()) else { return View::Unseen };
        let world_from_view = world_from_tracked_view(&(world_from_s1 * s1_from_m), &m_from_c, &c_from_view);
        match self.world_from_c().zip(shared.c_from_n) {
            Some((world_from_c, c_from_n)) => View::SeenAt { world_from_view, world_from_n: world_from_c * c_from_n },
            None => View::Seen(world_from_view),
        }
    }

    /// Returns the tracker's pose found by the hand-eye calibration. It is steadier than a pose computed through the
    /// instrument's marker, whose noise would be amplified by a lever of several decimetres.
    fn world_from_c(&self) -> Option<Isometry3<f64>> {
        self.hand_eye.map(|hand_eye| rigid(self.mount.world_from_base()) * hand_eye.base_from_c)
    }

    /// Returns the input of the frame calibrations; the rig adds the other side's poses.
    fn frames(&self, pose: &Pose, force: &ForceReading, shared: &Shared) -> FrameSample {
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
        pose: &Pose,
        world_from_s1: &UnitQuaternion<f64>,
        shared: &Shared,
    ) -> Sensed {
        if !self.at_wrist {
            return Sensed::AtTip(world_from_s1 * force.wrench.force_n);
        }
        let trocar_m = &self.rcm.settings().trocar_m;
        let in_trocar = pose.axis_miss_m(trocar_m).norm() <= START_MISS_M;
        Sensed::AtWrist(WristSample {
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

const fn raw<T, const N: usize>(reading: &Stamped<T>, channels: [f64; N]) -> Raw<N> {
    Raw { channels, device_s: reading.device_s, arrival_s: reading.arrival_s }
}

fn raw_force(reading: &Stamped<ForceReading>) -> Raw<{ nima_core::safety::CHANNELS }> {
    let ForceReading { wrench, acceleration_m_s2, .. } = reading.value;
    let array = |vector: Vector3<f64>| <[f64; 3]>::from(vector);
    let parts = [Some(array(wrench.force_n)), Some(array(wrench.torque_nm)), acceleration_m_s2.map(array)];
    Raw::of_sensor(parts, reading.device_s, reading.arrival_s)
}
