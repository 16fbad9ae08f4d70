//! What may be asked of a running arm. Nothing here waits or allocates.

use nalgebra::{UnitQuaternion, Vector3};

use super::{Answer, Driver, Mode, ToolReading, twist_message, vector};
use crate::{
    ARM_JOINTS,
    kinova::{
        faults::Faults,
        feedback::Feedback,
        limits::Beyond,
        messages::{Number, Rpc, ServoingMode},
    },
    transport::Bytes as _,
};

/// Why a command was not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Refusal {
    #[error("the arm is lost: connect it again")]
    Lost,
    /// Joint targets need low-level servoing.
    #[error("the arm does not take joint targets now: enter low-level servoing first")]
    NotServoing,
    /// A twist needs single-level servoing.
    #[error("the arm takes no twist in low-level servoing: leave it first")]
    NotSingleLevel,
    /// A twist still moves the arm.
    #[error("the arm moves with a twist: stop it first")]
    Moving,
    /// A number is not finite.
    #[error("the command has a number that is not finite")]
    NotFinite,
    /// A limit of a joint.
    #[error("joint {joint} was commanded {beyond}: the arm brakes and leaves low-level servoing")]
    Beyond {
        /// Counted from 1.
        joint: usize,
        beyond: Beyond,
    },
}

/// In which frame a twist is given (`CartesianReferenceFrame`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u32)]
pub enum TwistFrame {
    /// Translation in the base frame, rotation in the tool's.
    Mixed = 1,
    Tool = 2,
    #[default]
    Base = 3,
}

/// A velocity of the tool.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToolTwist {
    pub frame: TwistFrame,
    pub linear_m_s: Vector3<f64>,
    pub angular_rad_s: Vector3<f64>,
}

impl ToolTwist {
    fn is_finite(&self) -> bool {
        self.linear_m_s.iter().chain(&self.angular_rad_s).all(|x| x.is_finite())
    }

    fn is_zero(&self) -> bool {
        self.linear_m_s == Vector3::zeros() && self.angular_rad_s == Vector3::zeros()
    }

    fn limited(&self, linear_m_s: f64, angular_rad_s: f64) -> Self {
        let cut = |vector: &Vector3<f64>, most: f64| vector.map(|x| x.clamp(-1e3, 1e3)).cap_magnitude(most);
        Self {
            frame: self.frame,
            linear_m_s: cut(&self.linear_m_s, linear_m_s),
            angular_rad_s: cut(&self.angular_rad_s, angular_rad_s),
        }
    }
}

/// The twist in force. The arm has no time limit of its own for it but the session's 2 s, so it must be renewed.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Jog {
    twist: ToolTwist,
    pub(super) active: bool,
    renewed_s: f64,
    sent_s: Option<f64>,
}

/// A twist that is not renewed ends after this time, s.
const TWIST_DEAD_MAN_S: f64 = 0.1;
/// Between two twists, s: the base takes about 40 a second.
const TWIST_PERIOD_S: f64 = 0.025;

impl Driver {
    /// Asks for low-level servoing, beginning at rest where the arm is. It has come when
    /// [`ArmReading::servoing`](crate::ArmReading::servoing) turns true, after some ticks; a refusal is in [`Driver::answer`].
    pub fn enter_low_level(&mut self) -> Result<(), Refusal> {
        self.still_there()?;
        if self.twist.active {
            return Err(Refusal::Moving);
        }
        if self.mode == Mode::Single {
            self.answer = None;
            let number = self.call(Rpc::SET_SERVOING_MODE, &Number { value: ServoingMode::Low as u32 });
            self.mode = Mode::Entering { number, since_s: self.now_s };
        }
        Ok(())
    }

    /// Brakes, then goes back to single-level servoing.
    pub fn leave_low_level(&mut self) {
        match self.mode {
            Mode::Single | Mode::Braking | Mode::Leaving { .. } => {}
            Mode::Entering { .. } => self.ask_single_level(self.now_s),
            Mode::Low => {
                self.guard.brake();
                self.mode = Mode::Braking;
            }
        }
    }

    /// Where the joints shall be now, rad, in the turns of the readings: one step of a path that keeps to the
    /// [limits](crate::kinova::Settings::joint_limits), from [`Driver::command_rad`] on. What is beyond them is refused and counted, and
    /// ends the servoing: it comes from a plan that nobody may trust any more.
    pub fn aim(&mut self, target_rad: &[f64; ARM_JOINTS]) -> Result<(), Refusal> {
        self.still_there()?;
        if !target_rad.iter().all(|angle| angle.is_finite()) {
            return Err(Refusal::NotFinite);
        }
        if self.mode != Mode::Low {
            return Err(Refusal::NotServoing);
        }
        self.guard.aim(target_rad, &self.joint_rad).map_err(|(joint, beyond)| {
            self.health.refused += 1;
            self.leave_low_level();
            Refusal::Beyond { joint, beyond }
        })
    }

    /// Ends every motion: brakes and holds in low level; in single level a zero twist and `Stop`.
    pub fn stop(&mut self) {
        self.guard.brake();
        if !self.is_lost() && !matches!(self.mode, Mode::Low | Mode::Braking | Mode::Leaving { .. }) {
            self.release_twist();
        }
    }

    /// Moves the tool in single level, cut to the speeds of the settings. Renew it within 0.1 s, or it ends; a zero twist ends
    /// it at once.
    pub fn twist(&mut self, twist: &ToolTwist) -> Result<(), Refusal> {
        self.still_there()?;
        if !twist.is_finite() {
            return Err(Refusal::NotFinite);
        }
        if self.mode != Mode::Single {
            return Err(Refusal::NotSingleLevel);
        }
        if twist.is_zero() {
            if self.twist.active {
                self.release_twist();
            }
            return Ok(());
        }
        self.twist.twist = twist.limited(self.settings.twist_m_s, self.settings.twist_rad_s);
        (self.twist.active, self.twist.renewed_s) = (true, self.now_s);
        Ok(())
    }

    /// What another thread may do in an emergency: take the arm out of low-level servoing, whereupon it holds where it is.
    ///
    /// # Errors
    /// When the operating system gives no second end of the connection.
    pub fn lever(&self) -> std::io::Result<impl FnMut() + Send + 'static> {
        let single = Number { value: ServoingMode::Single as u32 };
        let (mut tcp, words) = self.lines.last_words(Rpc::SET_SERVOING_MODE, &single)?;
        // With a broken connection the arm's own watchdog has acted.
        Ok(move || {
            tcp.send(&words).ok();
        })
    }

    /// Clears warnings of a connected arm. An arm in fault is lost; its faults are cleared while opening it
    /// ([`FaultClearing`](crate::kinova::FaultClearing)).
    pub fn clear_faults(&mut self) -> Result<(), Refusal> {
        self.still_there()?;
        self.call(Rpc::CLEAR_FAULTS, &());
        Ok(())
    }

    /// The faults of the newest answer.
    pub fn faults(&self) -> Faults {
        Faults::of(&self.feedback)
    }

    /// All that the newest good answer told, in the units of the wire.
    pub const fn feedback(&self) -> &Feedback {
        &self.feedback
    }

    /// The last call that was refused, since low level was entered.
    pub const fn answer(&self) -> Option<Answer> {
        self.answer
    }

    /// How often somebody else took the arm out of low-level servoing.
    pub const fn ousted(&self) -> u32 {
        self.ousted
    }

    /// The positions that are commanded now, rad; meaningful while servoing.
    pub const fn command_rad(&self) -> &[f64; ARM_JOINTS] {
        self.guard.command_rad()
    }

    /// Where the arm sees its tool.
    pub fn tool(&self) -> ToolReading {
        let Feedback { tool_pose, tool_twist, tool_wrench, .. } = &self.feedback;
        let theta_rad = vector(&tool_pose[3..], 1_f64.to_radians());
        ToolReading {
            position_m: vector(&tool_pose[..3], 1.0),
            orientation: UnitQuaternion::from_euler_angles(theta_rad.x, theta_rad.y, theta_rad.z),
            velocity_m_s: vector(&tool_twist[..3], 1.0),
            angular_rad_s: vector(&tool_twist[3..], 1_f64.to_radians()),
            force_n: vector(&tool_wrench[..3], 1.0),
            torque_nm: vector(&tool_wrench[3..], 1.0),
        }
    }

    const fn still_there(&self) -> Result<(), Refusal> {
        if self.is_lost() { Err(Refusal::Lost) } else { Ok(()) }
    }

    /// Sends the twist in force again when it is due; ends one that nobody renews.
    pub(super) fn send_twist(&mut self, now_s: f64) {
        if !self.twist.active {
            return;
        }
        if now_s - self.twist.renewed_s > TWIST_DEAD_MAN_S {
            self.release_twist();
        } else if self.twist.sent_s.is_none_or(|sent_s| now_s - sent_s >= TWIST_PERIOD_S) {
            self.twist.sent_s = Some(now_s);
            self.call(Rpc::SEND_TWIST, &twist_message(&self.twist.twist));
        }
    }

    /// A zero twist, said explicitly, and `Stop`.
    pub(super) fn release_twist(&mut self) {
        let zero = ToolTwist { frame: self.twist.twist.frame, ..ToolTwist::default() };
        self.twist = Jog { twist: zero, ..Jog::default() };
        self.call(Rpc::SEND_TWIST, &twist_message(&zero));
        self.call(Rpc::STOP, &());
    }
}
