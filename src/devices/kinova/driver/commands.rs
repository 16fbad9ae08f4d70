//! Commands to a running arm. Nothing here waits or allocates.

use nalgebra::{UnitQuaternion, Vector3};

use super::{CallAnswer, KinovaDriver, KinovaMode, ToolReading, twist_message, vector};
use crate::{
    ARM_JOINTS,
    kinova::{
        faults::KinovaFaults,
        feedback::KinovaFeedback,
        limits::ExceededLimit,
        messages::{KinovaNumber, Rpc, ServoingMode},
    },
    transport::ByteStream as _,
};

#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum KinovaRefusal {
    #[error("the connection to the arm is lost: reconnect it")]
    Lost,
    #[error("the arm does not accept joint targets now: enter low-level servoing first")]
    NotServoing,
    #[error("the arm does not accept a twist in low-level servoing: leave low-level servoing first")]
    NotSingleLevel,
    #[error("a twist is moving the arm: stop it first")]
    Moving,
    #[error("the command contains a non-finite number: send finite numbers")]
    NotFinite,
    #[error("the command for joint {joint} is {beyond}: the arm brakes and leaves low-level servoing")]
    Beyond {
        /// The joint, counted from 1.
        joint: usize,
        beyond: ExceededLimit,
    },
}

/// Frame in which a twist is given (`CartesianReferenceFrame`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u32)]
pub enum TwistFrame {
    /// Translation in the base frame, rotation in the tool's.
    Mixed = 1,
    Tool = 2,
    #[default]
    Base = 3,
}

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
        // Clamped before its length is computed, because the square of a huge number is infinite and would make the
        // result NaN.
        let cut = |vector: &Vector3<f64>, max: f64| vector.map(|x| x.clamp(-1e3, 1e3)).cap_magnitude(max);
        Self {
            frame: self.frame,
            linear_m_s: cut(&self.linear_m_s, linear_m_s),
            angular_rad_s: cut(&self.angular_rad_s, angular_rad_s),
        }
    }
}

/// The active twist. The arm itself limits its duration only by the 2 s of the session, so the driver requires renewal.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Jog {
    twist: ToolTwist,
    pub(super) active: bool,
    renewed_s: f64,
    sent_s: Option<f64>,
}

/// A twist that is not renewed ends after this time, s. The arm's own limit of 2 s (`connection_inactivity_timeout`) is
/// too long for a moving tool.
const TWIST_DEAD_MAN_S: f64 = 0.1;
/// Interval between two twists, s: the base accepts about 40 per second.
const TWIST_PERIOD_S: f64 = 0.025;

impl KinovaDriver {
    /// Requests low-level servoing, starting at rest at the current position. It is active when
    /// [`ArmReading::servoing`](crate::ArmReading::servoing) becomes true, after some ticks; a refusal of the arm is in
    /// [`KinovaDriver::answer`].
    ///
    /// # Errors
    /// [`KinovaRefusal`] while a twist moves the arm.
    pub fn enter_low_level(&mut self) -> Result<(), KinovaRefusal> {
        self.still_there()?;
        if self.twist.active {
            return Err(KinovaRefusal::Moving);
        }
        if self.mode == KinovaMode::Single {
            self.answer = None;
            let number = self.call(Rpc::SET_SERVOING_MODE, &KinovaNumber { value: ServoingMode::Low as u32 });
            self.mode = KinovaMode::Entering { number, since_s: self.now_s };
        }
        Ok(())
    }

    pub fn leave_low_level(&mut self) {
        match self.mode {
            KinovaMode::Single | KinovaMode::Braking | KinovaMode::Leaving { .. } => {}
            KinovaMode::Entering { .. } => self.ask_single_level(self.now_s),
            KinovaMode::Low => {
                // First brake, then leave: the base must not take over a moving arm.
                self.guard.brake();
                self.mode = KinovaMode::Braking;
            }
        }
    }

    /// Commands joint angles, rad, in the turns of the readings: the next point of a path within the
    /// [limits](crate::kinova::KinovaSettings::joint_limits), starting at [`KinovaDriver::command_rad`]. A command
    /// beyond the limits is refused and counted, and ends servoing, because its plan is wrong.
    ///
    /// # Errors
    /// [`KinovaRefusal`] if the arm is not servoing, a number is not finite, or a limit is exceeded.
    pub fn aim(&mut self, target_rad: &[f64; ARM_JOINTS]) -> Result<(), KinovaRefusal> {
        self.still_there()?;
        if !target_rad.iter().all(|angle| angle.is_finite()) {
            return Err(KinovaRefusal::NotFinite);
        }
        if self.mode != KinovaMode::Low {
            return Err(KinovaRefusal::NotServoing);
        }
        self.guard.aim(target_rad, &self.joint_rad).map_err(|(joint, beyond)| {
            // Counted in addition to the error, because a program may ignore the error but not the state of the device.
            self.health.refused += 1;
            self.leave_low_level();
            KinovaRefusal::Beyond { joint, beyond }
        })
    }

    /// Ends every motion: in low-level servoing brakes and holds; in single-level sends a zero twist and `Stop`.
    pub fn stop(&mut self) {
        self.guard.brake();
        if !self.is_lost() && !matches!(self.mode, KinovaMode::Low | KinovaMode::Braking | KinovaMode::Leaving { .. }) {
            self.release_twist();
        }
    }

    /// Moves the tool in single-level servoing, limited to the speeds of the settings. The twist ends unless it is
    /// renewed within 0.1 s; a zero twist ends it at once.
    ///
    /// # Errors
    /// [`KinovaRefusal`] in low-level servoing, or if a number is not finite.
    pub fn twist(&mut self, twist: &ToolTwist) -> Result<(), KinovaRefusal> {
        self.still_there()?;
        if !twist.is_finite() {
            return Err(KinovaRefusal::NotFinite);
        }
        if self.mode != KinovaMode::Single {
            return Err(KinovaRefusal::NotSingleLevel);
        }
        // Not sent as a twist, because it would have to be renewed for ever.
        if twist.is_zero() {
            if self.twist.active {
                self.release_twist();
            }
            return Ok(());
        }
        self.twist.twist = twist.limited(self.settings.twist_m_s, self.settings.twist_rad_s);
        self.twist.active = true;
        self.twist.renewed_s = self.now_s;
        Ok(())
    }

    /// For emergencies: returns a function that another thread can call to end low-level servoing; the arm then holds
    /// its position.
    ///
    /// # Errors
    /// If the operating system cannot duplicate the connection.
    pub fn lever(&self) -> std::io::Result<impl FnMut() + Send + 'static> {
        let single = KinovaNumber { value: ServoingMode::Single as u32 };
        // Encoded now, so that the emergency path neither allocates nor waits for a lock.
        let (mut tcp, words) = self.lines.last_text(Rpc::SET_SERVOING_MODE, &single)?;
        // If the connection is broken, the arm's own watchdog has already acted.
        Ok(move || {
            tcp.send(&words).ok();
        })
    }

    /// Clears the warnings of a connected arm. An arm in fault is not connected; its faults are cleared while it is
    /// opened ([`FaultClearing`](crate::kinova::FaultClearing)).
    ///
    /// # Errors
    /// [`KinovaRefusal`] if the arm cannot accept the call now.
    pub fn clear_faults(&mut self) -> Result<(), KinovaRefusal> {
        self.still_there()?;
        self.call(Rpc::CLEAR_FAULTS, &());
        Ok(())
    }

    pub fn faults(&self) -> KinovaFaults {
        KinovaFaults::of(&self.feedback)
    }

    /// Returns the latest valid answer, in the units of the protocol.
    pub const fn feedback(&self) -> &KinovaFeedback {
        &self.feedback
    }

    /// Returns the last call that was refused since low-level servoing was entered.
    pub const fn answer(&self) -> Option<CallAnswer> {
        self.answer
    }

    /// Returns how often another client ended low-level servoing.
    pub const fn ousted(&self) -> u32 {
        self.ousted
    }

    /// Returns the commanded joint positions, rad; valid while servoing.
    pub const fn command_rad(&self) -> &[f64; ARM_JOINTS] {
        self.guard.command_rad()
    }

    /// Returns the state of the tool according to the arm.
    pub fn tool(&self) -> ToolReading {
        let KinovaFeedback { tool_pose, tool_twist, tool_wrench, .. } = &self.feedback;
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

    const fn still_there(&self) -> Result<(), KinovaRefusal> {
        if self.is_lost() { Err(KinovaRefusal::Lost) } else { Ok(()) }
    }

    /// Resends the active twist when it is due; ends a twist that was not renewed.
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

    /// Sends an explicit zero twist, and `Stop`.
    pub(super) fn release_twist(&mut self) {
        let zero = ToolTwist { frame: self.twist.twist.frame, ..ToolTwist::default() };
        self.twist = Jog { twist: zero, ..Jog::default() };
        self.call(Rpc::SEND_TWIST, &twist_message(&zero));
        // Both, because `Stop` also ends a motion that is not a twist.
        self.call(Rpc::STOP, &());
    }
}
