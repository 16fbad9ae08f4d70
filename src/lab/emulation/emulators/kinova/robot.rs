//! The base and its actuators: servoing modes, cyclic commands, faults that remain until they are cleared.

use nalgebra::Vector3;
use nima_devices::{
    ARM_JOINTS,
    kinova::{
        TwistFrame,
        faults::{
            COMMUNICATION_TICK_LOST, EMERGENCY_STOP, FOLLOWING_ERROR, JOINT_FAULT, JOINT_LIMIT_HIGH, JOINT_LIMIT_LOW,
            MAXIMUM_TORQUE,
        },
        kinematics::{jacobian, theta_rad, tool},
        limits::{GEN3, unwrapped, wire_degrees},
        messages::{ArmState, ERROR_DEVICE, KinovaCommand, ServoingMode, TwistCommand, sub},
    },
};

use super::{
    BodyCommand, BodyState, EmulatedKinova, KinovaBody,
    feedback_message::{ActuatorFeedback, BaseFeedback, FeedbackMessage},
    interface::{InterfaceError, LARGE_SPEED, MANUAL_STOP, MOVEMENT_IN_PROGRESS},
    joint_motion::{KinovaJoints, KinovaMotion, Leg},
};
use crate::emulators::EmulatedFault;

/// The hardware range exceeds the command range by this much, rad.
const HARDWARE_MARGIN_RAD: f64 = 0.1;
/// Maximum step of the body, s.
const STEP_S: f64 = 1e-3;
/// Maximum number of steps in one call; a longer pause of this process is skipped.
const STEPS: usize = 100;
/// Status bits of a working actuator: indexed, servoing.
const STATUS_SERVOING: u32 = 0x20 | 0x800;
/// The same, with a fault.
const STATUS_FAULT: u32 = 0x20 | 0x400 | 0x1000;

pub(super) struct Robot {
    arm: EmulatedKinova,
    body: Box<dyn KinovaBody>,
    state: BodyState,
    asked: BodyCommand,
    motion: Option<KinovaMotion>,
    /// Result of the last path, until it is read: at its end, or stopped with this sub error.
    ended: Option<ObeyResult>,
    mode: ServoingMode,
    base_fault: u32,
    actuator_faults: [u32; ARM_JOINTS],
    emulated_fault: bool,
    command_ids: [u32; ARM_JOINTS],
    frame_id: u32,
    stepped_s: f64,
    commanded_s: Option<f64>,
    random: fastrand::Rng,
}

/// A refusal has the sub error of `ERROR_DEVICE`.
pub(super) type ObeyResult = Result<(), u16>;

impl Robot {
    pub(super) fn new(arm: EmulatedKinova, mut body: Box<dyn KinovaBody>) -> Self {
        let state = body.step(0.0, &BodyCommand::Rest);
        Self {
            arm,
            body,
            state,
            asked: BodyCommand::Rest,
            motion: None,
            ended: None,
            mode: ServoingMode::Single,
            base_fault: 0,
            actuator_faults: [0; ARM_JOINTS],
            emulated_fault: false,
            command_ids: [0; ARM_JOINTS],
            frame_id: 0,
            stepped_s: 0.0,
            commanded_s: None,
            random: fastrand::Rng::with_seed(3),
        }
    }

    /// Advances the time to `now_s`.
    pub(super) fn advance(&mut self, now_s: f64, fault: EmulatedFault) {
        let is_silent = self.commanded_s.is_some_and(|received_s| now_s - received_s > self.arm.watchdog_ms * 1e-3);
        if self.mode == ServoingMode::Low && is_silent && !self.is_faulty() {
            self.trip([COMMUNICATION_TICK_LOST; ARM_JOINTS]);
        }
        self.emulated_fault = fault == EmulatedFault::DeviceFault;
        if self.emulated_fault {
            self.rest(sub::IN_FAULT);
        }
        for _ in 0..STEPS {
            let elapsed_s = (now_s - self.stepped_s).min(STEP_S);
            if elapsed_s <= 0.0 {
                break;
            }
            self.go_on(elapsed_s);
            self.state = self.body.step(elapsed_s, &self.asked);
            self.stepped_s += elapsed_s;
        }
        self.stepped_s = now_s;
    }

    fn go_on(&mut self, elapsed_s: f64) {
        let Some(motion) = &mut self.motion else { return };
        if let Some(asked) = motion.step(elapsed_s) {
            self.asked = asked;
        } else {
            self.motion = None;
            self.asked = BodyCommand::Rest;
            self.ended = Some(Ok(()));
        }
    }

    /// Ends every motion with this sub error.
    fn rest(&mut self, why: u16) {
        self.asked = BodyCommand::Rest;
        if self.motion.take().is_some_and(|motion| motion.is_path()) {
            self.ended = Some(Err(why));
        }
    }

    /// Returns once how the last path ended.
    pub(super) const fn take_end(&mut self) -> Option<ObeyResult> {
        self.ended.take()
    }

    const fn is_faulty(&self) -> bool {
        self.base_fault != 0 || self.emulated_fault
    }

    /// Returns bank A of the base and of a joint; the emulated fault is a torque fault of joint 3 while it is active.
    const fn banks(&self, j: usize) -> (u32, u32) {
        let base = self.base_fault;
        let joint = self.actuator_faults[j];
        match (self.emulated_fault, j) {
            (true, 2) => (base | JOINT_FAULT, joint | MAXIMUM_TORQUE),
            (true, _) => (base | JOINT_FAULT, joint),
            (false, _) => (base, joint),
        }
    }

    fn trip(&mut self, actuators: [u32; ARM_JOINTS]) {
        self.base_fault |= JOINT_FAULT;
        for (bank, bits) in self.actuator_faults.iter_mut().zip(actuators) {
            *bank |= bits;
        }
        self.rest(sub::IN_FAULT);
    }

    /// Returns the state in `GetArmState`.
    pub(super) fn state(&self) -> u32 {
        if self.is_faulty() {
            ArmState::IN_FAULT.0
        } else if self.mode == ServoingMode::Low {
            ArmState::SERVOING_LOW_LEVEL.0
        } else {
            self.arm.idle_state
        }
    }

    pub(super) const fn mode(&self) -> ServoingMode {
        self.mode
    }

    pub(super) fn set_mode(&mut self, mode: u32) -> ObeyResult {
        match mode {
            2 => self.mode = ServoingMode::Single,
            3 if self.is_faulty() => return Err(sub::IN_FAULT),
            3 => self.mode = ServoingMode::Low,
            _ => return Err(3),
        }
        self.rest(sub::WRONG_SERVOING_MODE);
        self.commanded_s = None;
        Ok(())
    }

    /// Clears the faults whose cause is gone.
    pub(super) const fn clear_faults(&mut self) {
        self.base_fault = 0;
        self.actuator_faults = [0; ARM_JOINTS];
        self.commanded_s = None;
    }

    pub(super) fn clear_actuator(&mut self, j: usize) {
        self.actuator_faults[j] = 0;
        if self.base_fault == JOINT_FAULT && self.actuator_faults == [0; ARM_JOINTS] {
            self.clear_faults();
        }
    }

    /// Stops every high-level motion.
    pub(super) fn stop(&mut self) {
        self.rest(MANUAL_STOP);
    }

    /// Stops the arm until faults are cleared.
    pub(super) fn emergency_stop(&mut self) {
        self.base_fault |= EMERGENCY_STOP;
        self.rest(sub::EMERGENCY_STOP);
    }

    /// Checks whether the base may begin a motion.
    fn ready(&self) -> ObeyResult {
        match &self.motion {
            _ if self.mode == ServoingMode::Low => Err(sub::WRONG_SERVOING_MODE),
            _ if self.is_faulty() => Err(sub::IN_FAULT),
            Some(motion) if motion.is_path() => Err(MOVEMENT_IN_PROGRESS),
            _ => Ok(()),
        }
    }

    /// Begins a path from the current pose.
    pub(super) fn follow(&mut self, legs: Vec<Leg>) -> Result<(), InterfaceError> {
        self.ready().map_err(|code| (ERROR_DEVICE, code))?;
        self.motion = Some(KinovaMotion::path(self.state.joint_rad, legs));
        Ok(())
    }

    /// Moves the joints at these speeds, rad/s, until the next command.
    pub(super) fn move_joints(&mut self, rad_s: KinovaJoints) -> Result<(), InterfaceError> {
        self.ready().map_err(|code| (ERROR_DEVICE, code))?;
        // A speed at a joint's limit is accepted, despite rounding in the wire's degrees.
        if !rad_s.iter().zip(&GEN3).all(|(speed, joint)| speed.abs() <= joint.speed_rad_s * 1.001) {
            return Err(LARGE_SPEED);
        }
        if rad_s.iter().all(|speed| *speed == 0.0) {
            self.rest(MANUAL_STOP);
        } else {
            self.motion = Some(KinovaMotion::speeds(self.state.joint_rad, rad_s));
        }
        Ok(())
    }

    /// Returns the active `ControlMode`.
    pub(super) const fn control_mode(&self) -> u32 {
        match (&self.motion, &self.asked) {
            (Some(KinovaMotion::Path { .. }), _) => 4,
            (Some(KinovaMotion::Speeds { .. }), _) => 1,
            (None, BodyCommand::Twist { .. }) => 2,
            (None, _) => 13,
        }
    }

    pub(super) fn twist(&mut self, command: &TwistCommand) -> ObeyResult {
        self.ready()?;
        let frame = match command.reference_frame {
            1 => TwistFrame::Mixed,
            2 => TwistFrame::Tool,
            3 => TwistFrame::Base,
            _ => return Err(3),
        };
        let twist = command.twist.unwrap_or_default();
        let linear_m_s = Vector3::new(twist.linear_x, twist.linear_y, twist.linear_z).cast::<f64>();
        let angular_deg_s = Vector3::new(twist.angular_x, twist.angular_y, twist.angular_z).cast::<f64>();
        let angular_rad_s = angular_deg_s.map(f64::to_radians);
        if !linear_m_s.iter().chain(&angular_rad_s).all(|x| x.is_finite()) {
            return Err(3);
        }
        self.motion = None;
        let still = linear_m_s == Vector3::zeros() && angular_rad_s == Vector3::zeros();
        self.asked = if still { BodyCommand::Rest } else { BodyCommand::Twist { frame, linear_m_s, angular_rad_s } };
        Ok(())
    }

    /// Executes a cyclic command. Refused outside low-level servoing; without effect in a fault.
    pub(super) fn command(&mut self, now_s: f64, command: &KinovaCommand) -> ObeyResult {
        if self.mode != ServoingMode::Low {
            return Err(sub::WRONG_SERVOING_MODE);
        }
        self.frame_id = command.frame_id;
        self.commanded_s = Some(now_s);
        if self.is_faulty() {
            return Ok(());
        }
        let mut wanted = if let BodyCommand::Joints(angles) = self.asked { angles } else { self.state.joint_rad };
        let mut faults = [0; ARM_JOINTS];
        for (j, actuator) in command.actuators.iter().take(ARM_JOINTS).enumerate() {
            // Commands with a wrong frame id are dropped.
            if actuator.command_id != command.frame_id || actuator.flags & 0x40 != 0 {
                continue;
            }
            self.command_ids[j] = actuator.command_id;
            let angle = unwrapped(actuator.position_deg, self.state.joint_rad[j]);
            faults[j] = self.faults_of(j, angle);
            wanted[j] = angle;
        }
        if faults == [0; ARM_JOINTS] {
            self.asked = BodyCommand::Joints(wanted);
        } else {
            self.trip(faults);
        }
        Ok(())
    }

    fn faults_of(&self, j: usize, angle: f64) -> u32 {
        let far = (angle - self.state.joint_rad[j]).abs() > self.arm.following_error_deg.to_radians();
        let limit = &GEN3[j];
        let mut faults = if far || !angle.is_finite() { FOLLOWING_ERROR } else { 0 };
        if angle > limit.high_rad + HARDWARE_MARGIN_RAD {
            faults |= JOINT_LIMIT_HIGH;
        }
        if angle < limit.low_rad - HARDWARE_MARGIN_RAD {
            faults |= JOINT_LIMIT_LOW;
        }
        faults
    }

    pub(super) const fn body(&self) -> &BodyState {
        &self.state
    }

    /// Returns the answer to a refresh.
    pub(super) fn report(&mut self, fault: EmulatedFault) -> FeedbackMessage {
        let mut actuators: Vec<_> = (0..ARM_JOINTS.min(self.arm.joints as usize)).map(|j| self.actuator(j)).collect();
        if fault == EmulatedFault::NotANumber {
            for actuator in &mut actuators {
                actuator.position_deg = f32::NAN;
            }
        }
        FeedbackMessage { frame_id: self.frame_id, base: Some(self.base()), actuators }
    }

    fn noise(&mut self, size: f32) -> f32 {
        (self.random.f32() - 0.5) * size
    }

    fn actuator(&mut self, j: usize) -> ActuatorFeedback {
        let (_, fault_a) = self.banks(j);
        ActuatorFeedback {
            command_id: self.command_ids[j],
            status_flags: if fault_a == 0 { STATUS_SERVOING } else { STATUS_FAULT },
            jitter_us: self.random.u32(..80),
            position_deg: wire_degrees(self.state.joint_rad[j]),
            velocity_deg_s: self.state.joint_rad_s[j].to_degrees() as f32 + self.noise(0.01),
            torque_nm: -self.state.joint_nm[j] as f32 + self.noise(0.02),
            current_a: self.noise(0.02),
            voltage: 24.0 + self.noise(0.1),
            temperature_motor: 35.0,
            temperature_core: 40.0,
            fault_a,
            ..ActuatorFeedback::default()
        }
    }

    fn base(&self) -> BaseFeedback {
        let pose = tool(&self.state.joint_rad);
        let place = pose.translation.vector.cast::<f32>();
        let theta = theta_rad(&pose.rotation).map(|angle| angle.to_degrees() as f32);
        let twist = jacobian(&self.state.joint_rad) * nalgebra::SVector::from(self.state.joint_rad_s);
        let linear = twist.fixed_rows::<3>(0).map(|x| x as f32);
        let angular = twist.fixed_rows::<3>(3).map(|x| x.to_degrees() as f32);
        let force = self.state.tool_force_n.cast::<f32>();
        let torque = self.state.tool_torque_nm.cast::<f32>();
        BaseFeedback {
            state: self.state(),
            arm_voltage: 24.0,
            arm_current: 1.2,
            temperature_cpu: 55.0,
            temperature_ambient: 35.0,
            imu_acceleration_z: 9.81,
            pose_x: place.x,
            pose_y: place.y,
            pose_z: place.z,
            theta_x: theta[0],
            theta_y: theta[1],
            theta_z: theta[2],
            linear_x: linear.x,
            linear_y: linear.y,
            linear_z: linear.z,
            angular_x: angular.x,
            angular_y: angular.y,
            angular_z: angular.z,
            force_x: force.x,
            force_y: force.y,
            force_z: force.z,
            torque_x: torque.x,
            torque_y: torque.y,
            torque_z: torque.z,
            fault_a: self.banks(0).0,
            ..BaseFeedback::default()
        }
    }
}
