//! An external arm.

use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};

use nima_core::kinematics::ArmModel;

use super::{
    codec::{Datagram, status},
    line::ExternalLine,
    opening,
    settings::{ExternalKind, ExternalSettings},
};
use crate::{
    ARM_JOINTS, ArmReading, Device, DeviceError, DeviceIdentity, Follower, Health, Lever, TimedReading,
    kinova::limits::Guard,
};

/// Numbers of an arm beyond these limits are impossible: rad, rad/s, Nm.
const ANGLE_MAX_RAD: f64 = 100.0;
// Far above any arm; such a number can only be a wrong unit or a damaged datagram.
const SPEED_MAX_RAD_S: f64 = 50.0;
// Far above any arm, as for the speed.
const TORQUE_MAX_NM: f64 = 1e4;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ArmMode {
    Resting,
    /// Servoing was requested; the arm has not reported it yet.
    Asked,
    Servoing,
    /// The arm slows down before it is switched off.
    Braking,
}

pub struct ExternalArm {
    line: ExternalLine,
    guard: Guard,
    joints: usize,
    mode: ArmMode,
    joint_rad: Option<[f64; ARM_JOINTS]>,
    last_s: Option<f64>,
    pulled: Arc<AtomicBool>,
}

impl ExternalArm {
    /// Waits for the device's program, up to half a second.
    ///
    /// # Errors
    /// [`DeviceError`] if a setting is invalid, the port is in use, or no program of an arm sends and receives.
    pub fn open(settings: &ExternalSettings, model: &ArmModel) -> Result<Self, DeviceError> {
        Ok(Self::on(opening::open(ExternalKind::Arm, settings, Some(model.joints()))?, settings, model))
    }

    /// Opens an arm with any number of joints, to read it only: its limits are not known.
    ///
    /// # Errors
    /// The errors of [`ExternalArm::open`], except for the number of joints.
    pub fn open_to_read(settings: &ExternalSettings) -> Result<impl Device<Reading = ArmReading> + use<>, DeviceError> {
        Ok(Self::to_read(opening::open(ExternalKind::Arm, settings, None)?, settings))
    }

    fn to_read(line: ExternalLine, settings: &ExternalSettings) -> Self {
        let joints = line.joints();
        let mut arm = Self::on(line, settings, &ArmModel::GEN3);
        arm.joints = joints;
        arm
    }

    /// Opens the arm over an existing connection, with time stamps from 0 on.
    #[cfg(test)]
    pub(super) fn over(
        datagrams: Box<dyn crate::transport::TransportDatagrams>,
        settings: &ExternalSettings,
        model: &ArmModel,
    ) -> Result<Self, DeviceError> {
        settings.check(ExternalKind::Arm)?;
        Ok(Self::on(opening::meet(datagrams, ExternalKind::Arm, settings, Some(model.joints()), 0)?, settings, model))
    }

    fn on(line: ExternalLine, settings: &ExternalSettings, model: &ArmModel) -> Self {
        let guard = Guard::new(settings.joint_limits(model));
        let joints = model.joints();
        Self { line, guard, joints, mode: ArmMode::Resting, joint_rad: None, last_s: None, pulled: Arc::default() }
    }

    /// Handles the arm's own report: an arm that has stopped following does not resume by itself.
    fn follow(&mut self, on: bool) {
        self.mode = match (self.mode, on) {
            (ArmMode::Asked, true) => ArmMode::Servoing,
            (ArmMode::Servoing | ArmMode::Braking, false) => ArmMode::Resting,
            (mode, _) => mode,
        };
    }

    fn advance(&mut self, elapsed_s: f64) {
        if self.mode != ArmMode::Resting {
            self.guard.step(elapsed_s);
        }
        if self.mode == ArmMode::Braking && self.guard.is_still() {
            self.mode = ArmMode::Resting;
        }
    }
}

/// Returns the reading in a datagram if its numbers are possible; the driver fills in whether the arm is servoing.
fn reading(datagram: &Datagram, joints: usize) -> Option<ArmReading> {
    let of = |group: usize| -> [f64; ARM_JOINTS] {
        let numbers = &datagram.numbers[group * joints..][..joints];
        std::array::from_fn(|joint| numbers.get(joint).copied().unwrap_or(0.0))
    };
    let value =
        ArmReading { joint_rad: of(0), joint_rad_s: of(1), joint_nm: of(2), servoing: datagram.has(status::ON) };
    let within = |values: &[f64; ARM_JOINTS], limit: f64| values.iter().all(|value| value.abs() <= limit);
    let possible = within(&value.joint_rad, ANGLE_MAX_RAD)
        && within(&value.joint_rad_s, SPEED_MAX_RAD_S)
        && within(&value.joint_nm, TORQUE_MAX_NM);
    (possible && datagram.joints == joints).then_some(value)
}

impl Device for ExternalArm {
    type Reading = ArmReading;

    fn poll(&mut self, now_s: f64) -> Option<TimedReading<ArmReading>> {
        if self.pulled.swap(false, Ordering::AcqRel) {
            self.leave_servoing();
        }
        let joints = self.joints;
        let newest = self.line.receive(now_s, |datagram| reading(datagram, joints));
        if let Some((stamped, _)) = &newest {
            self.joint_rad = Some(stamped.value.joint_rad);
            self.follow(stamped.value.servoing);
        }
        if now_s.is_finite() {
            let elapsed_s = self.last_s.replace(now_s).map_or(0.0, |last_s| now_s - last_s);
            self.advance(elapsed_s);
        }
        let on = self.mode != ArmMode::Resting;
        let held_rad = self.joint_rad.unwrap_or_default();
        let command_rad = if on { *self.guard.command_rad() } else { held_rad };
        self.line.report(on, &command_rad[..self.joints]);
        let (mut stamped, _) = newest?;
        stamped.value.servoing = self.mode == ArmMode::Servoing;
        Some(stamped)
    }

    fn about(&self) -> (&Health, &DeviceIdentity) {
        self.line.about()
    }
}

impl Follower for ExternalArm {
    fn enter_servoing(&mut self) {
        // An arm that has not reported its position cannot be held there.
        if let (ArmMode::Resting, Some(joint_rad)) = (self.mode, &self.joint_rad) {
            self.guard.seed(joint_rad);
            self.mode = ArmMode::Asked;
        }
    }

    fn leave_servoing(&mut self) {
        match self.mode {
            ArmMode::Asked => self.mode = ArmMode::Resting,
            ArmMode::Servoing => {
                self.guard.brake();
                self.mode = ArmMode::Braking;
            }
            ArmMode::Resting | ArmMode::Braking => {}
        }
    }

    fn command_rad(&self) -> [f64; ARM_JOINTS] {
        *self.guard.command_rad()
    }

    fn aim(&mut self, target_rad: &[f64; ARM_JOINTS]) -> bool {
        let Some(measured_rad) = self.joint_rad.filter(|_| self.mode == ArmMode::Servoing) else { return false };
        if !target_rad.iter().all(|rad| rad.is_finite()) {
            return false;
        }
        let taken = self.guard.aim(target_rad, &measured_rad).is_ok();
        if !taken {
            self.line.refuse_command();
            self.leave_servoing();
        }
        taken
    }

    fn attach(&self, lever: &Lever) {
        // Only a flag for a loop that resumes, as for a handle: while the loop hangs, the arm's own watchdog acts.
        let pulled = Arc::clone(&self.pulled);
        lever.attach(move || pulled.store(true, Ordering::Release));
    }
}

impl Drop for ExternalArm {
    fn drop(&mut self) {
        self.line.leave();
    }
}
