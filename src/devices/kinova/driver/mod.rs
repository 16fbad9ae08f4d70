//! The running arm: one cyclic exchange per tick, calls without waiting, and joint commands checked by the guard.
//!
//! The arm counts as lost after 18 ms without a good reading, 10 damaged or 5 impossible frames in a row, half a second
//! without an answer to a call, the first fault, or a broken connection. Times are measured from the request on, so a
//! late tick causes no loss.

use nalgebra::{UnitQuaternion, Vector3};
use nima_core::kinematics::ArmModel;

use super::{
    cycle::Cycle,
    feedback::KinovaFeedback,
    limits::{Guard, unwrapped, wire_degrees},
    messages::{
        ActuatorCommand, KinovaCommand, KinovaNumber, KinovaTwist, Rpc, SERVO_ENABLE, ServoingMode, TwistCommand,
    },
    session::KinovaLines,
    settings::KinovaSettings,
};
use crate::{
    ARM_JOINTS, ArmReading, ConnectionState, Device, DeviceIdentity, Health, Loss, TimedReading,
    transport::{ByteStream as _, TransportDatagrams as _},
};

mod commands;
mod receive;
mod shutdown;

pub use commands::{KinovaRefusal, ToolTwist, TwistFrame};
pub(super) use shutdown::close_sessions;

/// Maximum wait for a cyclic answer, s: 2 ms remain of the 20 ms after which the loop takes a force away, so that the
/// arm is named as the cause.
const SILENT_S: f64 = 0.018;
/// Maximum wait for the answer to a call, s.
const CALL_SILENT_S: f64 = 0.5;
/// Interval of keep-alive messages on each connection, s (as in the manufacturer's client).
const KEEP_ALIVE_S: f64 = 0.150;
/// Maximum wait for a change of mode, s.
const MODE_S: f64 = 1.0;
/// Minimum time between two requests, s: half a period at 1 kHz, so that two ticks in quick succession do not make two
/// requests in one cycle of the arm.
const SPACING_S: f64 = 0.5e-3;

/// Servoing mode of the arm, including transitions.
#[derive(Clone, Copy, Debug, PartialEq)]
enum KinovaMode {
    Single,
    /// Low-level servoing was requested.
    Entering {
        number: u16,
        since_s: f64,
    },
    Low,
    /// Braking before low-level servoing is left.
    Braking,
    /// Single-level servoing was requested; the position is held until it is granted.
    Leaving {
        number: u16,
        since_s: f64,
    },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CallAnswer {
    pub rpc: Rpc,
    pub error: u8,
    /// Sub error code; see [`words`](super::messages::sub::words).
    pub sub_error: u16,
}

/// State of the tool according to the arm's own model, in its base frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolReading {
    pub position_m: Vector3<f64>,
    /// Orientation, with the angle convention of [`theta_rad`](super::kinematics::theta_rad).
    pub orientation: UnitQuaternion<f64>,
    pub velocity_m_s: Vector3<f64>,
    pub angular_rad_s: Vector3<f64>,
    /// Force on the tool as estimated by the arm, N.
    pub force_n: Vector3<f64>,
    pub torque_nm: Vector3<f64>,
}

#[derive(Debug)]
pub struct KinovaDriver {
    settings: KinovaSettings,
    lines: KinovaLines,
    health: Health,
    identity: DeviceIdentity,
    guard: Guard,
    mode: KinovaMode,
    cycle: Cycle,
    feedback: KinovaFeedback,
    joint_rad: [f64; ARM_JOINTS],
    command: KinovaCommand,
    frame_id: u16,
    now_s: f64,
    sent_s: Option<f64>,
    unanswered_s: Option<f64>,
    call_unanswered_s: Option<f64>,
    alive_s: Option<f64>,
    damaged_in_row: u32,
    impossible_in_row: u32,
    seen: (u64, u64),
    twist: commands::Jog,
    answer: Option<CallAnswer>,
    ousted: u32,
}

impl KinovaDriver {
    /// Creates the driver on open sessions; `feedback` is the first feedback.
    pub(super) fn new(
        settings: &KinovaSettings,
        model: &ArmModel,
        lines: KinovaLines,
        identity: DeviceIdentity,
        feedback: &KinovaFeedback,
    ) -> Self {
        let seen = (lines.packets.skipped, lines.packets.damaged);
        Self {
            settings: settings.clone(),
            lines,
            health: Health::opening(),
            identity,
            guard: Guard::new(settings.joint_limits(model)),
            mode: KinovaMode::Single,
            cycle: Cycle::default(),
            feedback: *feedback,
            joint_rad: feedback.actuators.map(|a| unwrapped(a.position_deg, 0.0)),
            command: KinovaCommand { frame_id: 0, actuators: vec![ActuatorCommand::default(); feedback.count] },
            frame_id: 0,
            now_s: 0.0,
            sent_s: None,
            unanswered_s: None,
            call_unanswered_s: None,
            alive_s: None,
            damaged_in_row: 0,
            impossible_in_row: 0,
            seen,
            twist: commands::Jog::default(),
            answer: None,
            ousted: 0,
        }
    }

    const fn is_lost(&self) -> bool {
        matches!(self.health.standing, ConnectionState::Lost(_))
    }

    /// Sends a call without waiting; returns its number.
    fn call(&mut self, rpc: Rpc, question: &impl prost::Message) -> u16 {
        let (number, bytes) = self.lines.calls.request(rpc, question);
        if let Err(loss) = self.lines.tcp.send(bytes) {
            self.health.lose(loss);
        }
        self.call_unanswered_s.get_or_insert(self.now_s);
        number
    }

    fn ask_single_level(&mut self, now_s: f64) {
        let number = self.call(Rpc::SET_SERVOING_MODE, &KinovaNumber { value: ServoingMode::Single as u32 });
        self.mode = KinovaMode::Leaving { number, since_s: now_s };
    }

    fn watch(&mut self, now_s: f64) {
        let over = |since_s: Option<f64>, limit_s: f64| since_s.is_some_and(|since_s| now_s - since_s > limit_s);
        if over(self.unanswered_s, SILENT_S) || over(self.call_unanswered_s, CALL_SILENT_S) {
            self.health.lose(Loss::Silent);
        }
        match self.mode {
            KinovaMode::Entering { since_s, .. } | KinovaMode::Leaving { since_s, .. } if now_s - since_s > MODE_S => {
                self.ask_single_level(now_s);
            }
            KinovaMode::Braking if self.guard.is_still() => self.ask_single_level(now_s),
            _ => {}
        }
    }

    fn keep_alive(&mut self, now_s: f64) {
        if self.alive_s.is_some_and(|alive_s| now_s - alive_s < KEEP_ALIVE_S) {
            return;
        }
        self.alive_s = Some(now_s);
        self.call(Rpc::KEEP_ALIVE, &());
        let (_, bytes) = self.lines.cyclic.request(Rpc::KEEP_ALIVE, &());
        if let Err(loss) = self.lines.udp.send(bytes) {
            self.health.lose(loss);
        }
    }

    /// Sends a cyclic request: with joint positions in low-level servoing, without in single-level.
    fn send_cycle(&mut self, now_s: f64) {
        let elapsed_s = self.sent_s.map_or(SPACING_S, |sent_s| now_s - sent_s);
        if elapsed_s < SPACING_S {
            return;
        }
        self.sent_s = Some(now_s);
        let (number, bytes) = if matches!(self.mode, KinovaMode::Single | KinovaMode::Entering { .. }) {
            self.lines.cyclic.request(Rpc::REFRESH_FEEDBACK, &())
        } else {
            self.fill_command(elapsed_s);
            self.lines.cyclic.request(Rpc::REFRESH, &self.command)
        };
        if let Err(loss) = self.lines.udp.send(bytes) {
            self.health.lose(loss);
        }
        self.cycle.asked(number, &mut self.health);
        self.unanswered_s.get_or_insert(now_s);
    }

    /// Sets the next joint positions. The command of every actuator must carry the number of the frame; otherwise the
    /// arm discards it as outdated.
    fn fill_command(&mut self, elapsed_s: f64) {
        self.frame_id = self.frame_id.wrapping_add(1);
        self.command.frame_id = u32::from(self.frame_id);
        let positions = self.guard.step(elapsed_s);
        for (command, position_rad) in self.command.actuators.iter_mut().zip(positions) {
            command.command_id = u32::from(self.frame_id);
            command.flags = SERVO_ENABLE;
            command.position_deg = wire_degrees(*position_rad);
        }
    }
}

impl Device for KinovaDriver {
    type Reading = ArmReading;

    fn poll(&mut self, now_s: f64) -> Option<TimedReading<ArmReading>> {
        if self.is_lost() || !now_s.is_finite() {
            return None;
        }
        self.now_s = now_s;
        let reading = self.take_cycle(now_s);
        self.take_answers(now_s);
        self.watch(now_s);
        if !self.is_lost() {
            self.keep_alive(now_s);
            self.send_twist(now_s);
            self.send_cycle(now_s);
        }
        if self.is_lost() {
            if self.mode != KinovaMode::Single {
                // Requested without waiting; closing the driver waits for it.
                self.ask_single_level(now_s);
            }
            return None;
        }
        reading
    }

    fn about(&self) -> (&Health, &DeviceIdentity) {
        (&self.health, &self.identity)
    }
}

impl Drop for KinovaDriver {
    fn drop(&mut self) {
        self.leave();
    }
}

/// Converts three numbers of the protocol to a vector of [`ToolReading`], multiplied by `scale`.
fn vector(numbers: &[f32], scale: f64) -> Vector3<f64> {
    Vector3::new(f64::from(numbers[0]), f64::from(numbers[1]), f64::from(numbers[2])) * scale
}

fn twist_message(twist: &ToolTwist) -> TwistCommand {
    let [linear_x, linear_y, linear_z] = twist.linear_m_s.cast::<f32>().into();
    let [angular_x, angular_y, angular_z] = twist.angular_rad_s.map(|rate| rate.to_degrees() as f32).into();
    let twist_deg = KinovaTwist { linear_x, linear_y, linear_z, angular_x, angular_y, angular_z };
    TwistCommand { reference_frame: twist.frame as u32, twist: Some(twist_deg), duration: 0 }
}
