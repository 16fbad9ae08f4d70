//! World of one side, with a jointed arm in it: the data source of every emulator of the side.
//!
//! Times are on the common clock (s). Whenever an emulator reads the world, the world advances to that time in fixed
//! steps of 1 ms. Positions in m, forces in N, in `world` unless the name says otherwise. The joints follow the arm's
//! commands like the simulated follower or, while its drives are off, the hands of the technician.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use nima_core::{
    frames::{GRAVITY_M_S2, Wrench, from_roll_pitch_yaw_deg},
    kinematics::{Arm, Joints, view_from_omega},
};
use nima_devices::{ARM_JOINTS, ForceReading, ForceStatus, TrackedTool};
use nima_machine::rig::{ArmSet, EndoscopeSettings, Flaws, Outputs, Prompt, RemoteIdentification, SensedForce};

use nima_simulation::{HandForces, World, scene::Scene, screen::PersonTask};

use super::{HandFrame, noise_model::FlawedSide, technician::SideTechnician, tracker_view::CameraMount};
use crate::emulators::{
    force_dimension::{HandState, MotorOutput},
    kinova::{BodyCommand, BodyState, KinovaBody as _, StandIn},
};

/// One step of the world, s.
const STEP_S: f64 = 1e-3;
/// Maximum number of steps executed after a pause of the whole process; earlier time is skipped. Without a limit a
/// pause of the process would be made up for longer than it lasted.
const CATCH_UP_STEPS: u64 = 100;
/// Natural rotation of the handle, rad, and its speed, rad/s: no hand is perfectly still.
const HANDLE_WAVE: (f64, f64) = (0.05, 0.9);
/// Opening of the gripper, rad.
const GRIPPER_RAD: f64 = 0.2;
/// Housing temperature of a sensor that has been on for a while, degrees Celsius.
const SENSOR_C: f64 = 31.0;

/// The true state of a side, known only in a simulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truth {
    /// Position of the tip, m.
    pub tip_m: Vector3<f64>,
    /// Force of the tissue on the tip, N.
    pub tip_n: Vector3<f64>,
    /// Position of the hand, m.
    pub hand_m: Vector3<f64>,
    pub joint_rad: [f64; ARM_JOINTS],
    /// Orientation of the wrist sensor.
    pub world_from_s1: UnitQuaternion<f64>,
    /// Commands of the handle's motors.
    pub applied: MotorOutput,
    /// Whether the arm follows commands; otherwise it holds.
    pub servoing: bool,
    /// Pose of the marker in the wrist sensor's frame.
    pub s1_from_m: Isometry3<f64>,
    /// Pose of the tracker's camera in the workspace.
    pub world_from_c: Isometry3<f64>,
}

/// Returns the orientation of the endoscope image.
fn world_from_view(hand: &HandFrame) -> UnitQuaternion<f64> {
    (view_from_omega() * hand.leader_from_world).inverse()
}

#[derive(Clone, Debug)]
pub(super) struct SideWorld {
    world: World,
    arm: Arm,
    /// Natural angular frequency of the joints; `None` if they are always at their commanded angles.
    omega: Option<f64>,
    body: BodyState,
    asked: BodyCommand,
    applied: MotorOutput,
    hand: HandFrame,
    start_m: Vector3<f64>,
    imu_from_s1: UnitQuaternion<f64>,
    technician: Box<SideTechnician>,
    camera: CameraMount,
    flawed: FlawedSide,
    world_from_s1: UnitQuaternion<f64>,
    turn_rad_s: Vector3<f64>,
    tip_m: Vector3<f64>,
    /// Position of the hand, as measured by its handle.
    hand_m: Vector3<f64>,
    sensed: SensedForce,
    /// Number of due steps, by the common clock, that were executed or skipped.
    reached: u64,
    /// Number of executed steps.
    made: u64,
}

impl SideWorld {
    /// Creates the world of a scene adapted to this side, with the arm at these angles.
    pub(super) fn new(
        scene: &Scene,
        set: &ArmSet,
        arm: &Arm,
        start_rad: &Joints,
        hand: HandFrame,
        flaws: Flaws,
    ) -> Self {
        let pose = arm.pose(start_rad);
        let imu_deg = scene.wrist.as_ref().and_then(|wrist| wrist.imu).map(|imu| imu.s1_from_imu_deg);
        // Each side has its own arm and its own person who guides it, so remove those of the scene.
        let world = World::new(&Scene { follower: None, person: None, ..scene.clone() }, STEP_S.recip());
        let start_m = world.hand().position_m();
        let mut side = Self {
            world,
            arm: *arm,
            omega: scene.follower.map(|follower| std::f64::consts::TAU * follower.bandwidth_hz),
            body: BodyState { joint_rad: (*start_rad).into(), ..BodyState::default() },
            asked: BodyCommand::Rest,
            applied: MotorOutput::default(),
            hand,
            start_m,
            imu_from_s1: imu_deg.map_or_else(UnitQuaternion::identity, |deg| from_roll_pitch_yaw_deg(&deg).inverse()),
            technician: Box::new(SideTechnician::new(arm, *start_rad, scene, world_from_view(&hand))),
            camera: CameraMount::new(scene, set),
            flawed: FlawedSide::new(flaws, (*start_rad).into()),
            world_from_s1: pose.orientation(),
            turn_rad_s: Vector3::zeros(),
            tip_m: pose.tip_m,
            hand_m: start_m,
            sensed: SensedForce::AtTip(Vector3::zeros()),
            reached: 0,
            made: 0,
        };
        side.step();
        side
    }

    /// Advances to `now_s` of the common clock.
    pub(super) fn advance(&mut self, now_s: f64) {
        let due = (now_s / STEP_S) as u64;
        self.reached = self.reached.max(due.saturating_sub(CATCH_UP_STEPS));
        while self.reached < due {
            self.reached += 1;
            self.step();
        }
    }

    /// Sets the command of the arm's base from now on; returns the state of the arm.
    pub(super) fn ask(&mut self, now_s: f64, asked: &BodyCommand) -> BodyState {
        self.advance(now_s);
        self.asked = *asked;
        BodyState { joint_rad: self.flawed.encoders(&self.body.joint_rad), ..self.body }
    }

    /// Sets the output of the handle's motors from now on; returns the pose of the handle in its own frame.
    pub(super) fn hold(&mut self, now_s: f64, applied: &MotorOutput) -> HandState {
        self.advance(now_s);
        self.applied = *applied;
        let HandFrame { leader_from_world, scale } = self.hand;
        let (max_rad, rad_s) = HANDLE_WAVE;
        let phase = rad_s * now_s;
        HandState {
            position_m: leader_from_world * (self.hand_m - self.start_m) / scale,
            orientation: UnitQuaternion::from_euler_angles(
                max_rad * phase.sin(),
                0.7 * max_rad * (1.3 * phase).cos(),
                0.5 * max_rad * (0.6 * phase).sin(),
            ),
            gripper_rad: GRIPPER_RAD,
            ..HandState::default()
        }
    }

    /// Returns the reading of the sensor between arm and instrument, in its own frame.
    pub(super) fn feel(&mut self, now_s: f64) -> ForceReading {
        self.advance(now_s);
        let s1_from_world = self.world_from_s1.inverse();
        let support = self.imu_from_s1 * (s1_from_world * Vector3::new(0.0, 0.0, GRAVITY_M_S2));
        let (wrench, measured) = match &self.sensed {
            SensedForce::AtWrist(sample) => (sample.raw, sample.acceleration_m_s2),
            SensedForce::AtTip(tip_n) | SensedForce::FarEnd(RemoteIdentification { force_n: tip_n, .. }) => {
                (Wrench { force_n: s1_from_world * tip_n, torque_nm: Vector3::zeros() }, None)
            }
        };
        let more = self.flawed.wrench(now_s, self.body.joint_rad[self.arm.model().joints() - 1]);
        ForceReading {
            wrench: Wrench { force_n: wrench.force_n + more.force_n, torque_nm: wrench.torque_nm + more.torque_nm },
            acceleration_m_s2: Some(self.flawed.askew() * measured.unwrap_or(support)),
            angular_velocity_rad_s: Some(self.imu_from_s1 * self.turn_rad_s),
            temperature_c: SENSOR_C,
            status: ForceStatus::default(),
        }
    }

    /// Returns this side's contribution to the reading of the sensor under the tissue, N.
    pub(super) fn press(&mut self, now_s: f64) -> Vector3<f64> {
        self.advance(now_s);
        self.sensed.wrist().and_then(|sample| sample.tissue_n).unwrap_or_else(|| self.world.true_tip_n())
    }

    /// Returns the tracker's reading of the marker on the instrument.
    pub(super) fn marker(&mut self, now_s: f64) -> TrackedTool {
        self.advance(now_s);
        let noisy = self.sensed.wrist().and_then(|sample| sample.m_from_c).map(|m_from_c| m_from_c.inverse());
        let sensor_m = self.tip_m - self.world_from_s1 * Vector3::new(0.0, 0.0, self.arm.shaft_m());
        let marker = self.camera.marker(&self.world_from_s1, &sensor_m, noisy);
        self.flawed.tracked(now_s, marker)
    }

    /// Returns the tracker's reading of the endoscope's marker, which does not move unless the endoscope was pushed. An
    /// Omega is aligned with the endoscope image, and the hand moves in the image's directions.
    pub(super) fn endoscope(&mut self, endoscope: &EndoscopeSettings, is_moved: bool) -> TrackedTool {
        self.camera.endoscope(&world_from_view(&self.hand), endoscope, is_moved)
    }

    /// Returns the true state.
    pub(super) fn truth(&mut self, now_s: f64) -> Truth {
        self.advance(now_s);
        let [s1_from_m, world_from_c] = self.camera.truth();
        Truth {
            tip_m: self.tip_m,
            tip_n: self.world.true_tip_n(),
            hand_m: self.world.hand().position_m(),
            joint_rad: self.body.joint_rad,
            world_from_s1: self.world_from_s1,
            applied: self.applied,
            servoing: self.asked != BodyCommand::Rest,
            s1_from_m,
            world_from_c,
        }
    }

    /// Passes the content of the screen to the technician.
    pub(super) fn reads(&mut self, now_s: f64, task: PersonTask, prompt: Prompt) {
        self.advance(now_s);
        self.technician.reads(task, prompt);
    }

    fn step(&mut self) {
        let asked = self.asked;
        self.move_joints(&asked);
        let pose = self.arm.pose(&self.body.joint_rad.into());
        let orientation = pose.orientation();
        self.turn_rad_s = (self.world_from_s1.inverse() * orientation).scaled_axis() / STEP_S;
        let bent_m = self.flawed.bent_m(&self.world.true_tip_n(), &pose.direction);
        self.world_from_s1 = orientation;
        self.tip_m = pose.tip_m + bent_m;
        self.world.carry(orientation);
        // The technician lets go of an arm whose drives are on.
        let hands_on = asked == BodyCommand::Rest && !self.technician.is_away();
        let touch = self.technician.touch();
        let aside = self.technician.sets_aside();
        let (touch, aside) = if hands_on { (touch, aside) } else { (HandForces::default(), false) };
        self.world.touched(&touch, aside);
        if hands_on {
            self.world.wait_at(self.start_m + self.technician.handle_m());
        } else {
            // The hand does not start its task before the arm follows it.
            self.world.wait(!matches!(asked, BodyCommand::Joints(_)));
        }
        let force_n = self.hand.leader_from_world.inverse() * self.applied.force_n;
        let outputs = Outputs { tip_command_m: Some(self.tip_m), hand_force_n: force_n, ..Outputs::SAFE };
        self.made += 1;
        let inputs = self.world.advance_to(self.made as f64 * STEP_S, &outputs);
        self.hand_m = inputs.hand.position_m;
        self.sensed = inputs.sensed;
        self.load_joints(&pose.chain.jacobian(&pose.tip_m));
    }

    fn move_joints(&mut self, asked: &BodyCommand) {
        match asked {
            BodyCommand::Rest if self.technician.is_away() => self.body.joint_rad_s = [0.0; ARM_JOINTS],
            BodyCommand::Rest => {
                let before = Joints::from(self.body.joint_rad);
                let guided = self.technician.advance(&before, STEP_S);
                self.body.joint_rad = guided.into();
                self.body.joint_rad_s = ((guided - before) / STEP_S).into();
            }
            BodyCommand::Joints(goal_rad) => {
                for (joint, goal_rad) in goal_rad.iter().enumerate() {
                    self.follow(joint, *goal_rad);
                }
            }
            BodyCommand::Twist { .. } => {
                let moved = StandIn::at(self.body.joint_rad).step(STEP_S, asked);
                self.body.joint_rad = moved.joint_rad;
                self.body.joint_rad_s = moved.joint_rad_s;
            }
        }
    }

    /// Critically damped second order, exact over the step for a constant goal: like the simulated follower, joint by
    /// joint.
    fn follow(&mut self, joint: usize, goal_rad: f64) {
        let angle_rad = &mut self.body.joint_rad[joint];
        let speed_rad_s = &mut self.body.joint_rad_s[joint];
        let Some(omega) = self.omega else {
            *speed_rad_s = (goal_rad - *angle_rad) / STEP_S;
            *angle_rad = goal_rad;
            return;
        };
        let offset_rad = *angle_rad - goal_rad;
        let decay = (-omega * STEP_S).exp();
        let slope = *speed_rad_s + offset_rad * omega;
        *angle_rad = goal_rad + (offset_rad + slope * STEP_S) * decay;
        *speed_rad_s = (*speed_rad_s - slope * (omega * STEP_S)) * decay;
    }

    /// Applies the joint torques of the tissue's force (`J^T f`), and the same force as reported by the arm's base.
    fn load_joints(&mut self, jacobian: &nalgebra::SMatrix<f64, 6, ARM_JOINTS>) {
        let tip_n = self.world.true_tip_n();
        let held_nm = jacobian.fixed_rows::<3>(0).transpose() * tip_n;
        // The motors push against it.
        self.body.joint_nm = (-held_nm).into();
        self.body.tool_force_n = self.arm.world_from_base().rotation.inverse() * tip_n;
    }
}
