//! The moving part: the simulated world's arm, or a simple substitute.

use nalgebra::{Vector3, Vector6};
use nima_devices::{
    ARM_JOINTS,
    kinova::{
        TwistFrame,
        kinematics::{joint_speeds, tool},
        limits::GEN3,
    },
};

/// Current command of the emulated base to the body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum BodyCommand {
    /// None: brakes on, or a holding base.
    #[default]
    Rest,
    /// Joint angles, rad, each in the turn nearest to the last one.
    Joints([f64; ARM_JOINTS]),
    /// Velocity of the tool.
    Twist {
        /// Frame of the velocity.
        frame: TwistFrame,
        linear_m_s: Vector3<f64>,
        angular_rad_s: Vector3<f64>,
    },
}

/// State of the body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BodyState {
    pub joint_rad: [f64; ARM_JOINTS],
    pub joint_rad_s: [f64; ARM_JOINTS],
    /// Joint torques with the sign of commands, Nm.
    pub joint_nm: [f64; ARM_JOINTS],
    /// Force on the tool in the base frame, N.
    pub tool_force_n: Vector3<f64>,
    /// Torque on the tool, Nm.
    pub tool_torque_nm: Vector3<f64>,
}

/// A body of an emulated arm: a closure that takes the time since the last call (s) and the command.
pub trait KinovaBody: Send {
    /// Advances by `elapsed_s`.
    fn step(&mut self, elapsed_s: f64, asked: &BodyCommand) -> BodyState;
}

impl<F: FnMut(f64, &BodyCommand) -> BodyState + Send> KinovaBody for F {
    fn step(&mut self, elapsed_s: f64, asked: &BodyCommand) -> BodyState {
        self(elapsed_s, asked)
    }
}

/// An arm without a world: its joints follow with a lag and within the arm's speeds. Until the first command it may
/// sway slowly, so that a client receives changing numbers.
#[derive(Clone, Debug)]
pub struct StandIn {
    state: BodyState,
    sways: bool,
    time_s: f64,
}

/// Time constant with which a joint follows, s.
const LAG_S: f64 = 0.004;
/// Sway of the last joint, rad, and its angular frequency, rad/s.
const SWAY: (f64, f64) = (0.1, 0.6);
/// Torque per remaining angle, Nm/rad, so that the torque shows a push.
const STIFFNESS: f64 = 40.0;

impl StandIn {
    pub fn at(joint_rad: [f64; ARM_JOINTS]) -> Self {
        Self { state: BodyState { joint_rad, ..BodyState::default() }, sways: false, time_s: 0.0 }
    }

    /// Creates an arm at the manufacturer's home pose, which sways until it is commanded.
    pub fn swaying() -> Self {
        let home_deg: [f64; ARM_JOINTS] = [0.0, 15.0, 180.0, -130.0, 0.0, 55.0, 90.0];
        Self { sways: true, ..Self::at(home_deg.map(f64::to_radians)) }
    }

    fn speeds(&mut self, elapsed_s: f64, asked: &BodyCommand) -> [f64; ARM_JOINTS] {
        let mut speeds = [0.0; ARM_JOINTS];
        match asked {
            BodyCommand::Rest if self.sways => {
                self.time_s += elapsed_s;
                speeds[ARM_JOINTS - 1] = SWAY.0 * SWAY.1 * (SWAY.1 * self.time_s).cos();
            }
            BodyCommand::Rest => {}
            BodyCommand::Joints(angles) => {
                let fraction = -(-elapsed_s / LAG_S).exp_m1();
                speeds = std::array::from_fn(|j| (angles[j] - self.state.joint_rad[j]) * fraction / elapsed_s);
            }
            BodyCommand::Twist { frame, linear_m_s, angular_rad_s } => {
                let rotation = tool(&self.state.joint_rad).rotation;
                let turned = |own: bool, vector: &Vector3<f64>| if own { rotation * vector } else { *vector };
                let linear = turned(*frame == TwistFrame::Tool, linear_m_s);
                let angular = turned(*frame != TwistFrame::Base, angular_rad_s);
                let twist = Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z);
                speeds = joint_speeds(&self.state.joint_rad, &twist);
            }
        }
        self.sways &= *asked == BodyCommand::Rest;
        speeds
    }
}

impl KinovaBody for StandIn {
    fn step(&mut self, elapsed_s: f64, asked: &BodyCommand) -> BodyState {
        if elapsed_s <= 0.0 {
            return self.state;
        }
        let speeds = self.speeds(elapsed_s, asked);
        for j in 0..ARM_JOINTS {
            let speed = speeds[j].clamp(-GEN3[j].speed_rad_s, GEN3[j].speed_rad_s);
            self.state.joint_rad_s[j] = speed;
            self.state.joint_rad[j] += speed * elapsed_s;
            self.state.joint_nm[j] = match asked {
                BodyCommand::Joints(angles) => STIFFNESS * (angles[j] - self.state.joint_rad[j]),
                _ => 0.0,
            };
        }
        self.state
    }
}
