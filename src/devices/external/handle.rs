//! An external haptic handle.

use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::{
    codec::{Datagram, status},
    line::ExternalLine,
    opening,
    settings::{ExternalKind, ExternalSettings},
};
use crate::{Device, DeviceError, DeviceIdentity, HandleReading, Health, Leader, Lever, TimedReading};

/// Numbers of a handle beyond these limits are impossible: m, m/s, rad.
const POSITION_MAX_M: f64 = 2.0;
// Far above a hand (3 m/s); such a number can only be a wrong unit.
const SPEED_MAX_M_S: f64 = 20.0;
// Just above half a turn.
const GRIPPER_MAX_RAD: f64 = 3.2;
/// Maximum deviation of a quaternion's length from 1: rounding, even to 32 bits, gives 1e-7, so that a larger deviation
/// is a mistake in the user's program.
const UNIT_WITHIN: f64 = 0.01;

pub struct ExternalHandle {
    line: ExternalLine,
    /// Whether force is requested; the emergency release clears it from another thread, for a loop that resumes.
    wanted: Arc<AtomicBool>,
    /// Force state that the device has reported and the loop has not read yet.
    reported: Option<bool>,
    forces_max_n: (f64, f64),
    /// Whether a command was sent since the last poll.
    report: bool,
}

impl ExternalHandle {
    /// Waits for the device's program, up to half a second.
    ///
    /// # Errors
    /// [`DeviceError`] if a setting is invalid, the port is in use, or no program of a handle sends and receives.
    pub fn open(settings: &ExternalSettings) -> Result<Self, DeviceError> {
        Ok(Self::on(opening::open(ExternalKind::Handle, settings, None)?, settings))
    }

    /// Opens the handle over an existing connection, with time stamps from 0 on.
    #[cfg(test)]
    pub(super) fn over(
        datagrams: Box<dyn crate::transport::TransportDatagrams>,
        settings: &ExternalSettings,
    ) -> Result<Self, DeviceError> {
        settings.check(ExternalKind::Handle)?;
        Ok(Self::on(opening::meet(datagrams, ExternalKind::Handle, settings, None, 0)?, settings))
    }

    fn on(line: ExternalLine, settings: &ExternalSettings) -> Self {
        let forces_max_n = settings.forces_max_n();
        Self { line, wanted: Arc::default(), reported: None, forces_max_n, report: false }
    }

    fn is_wanted(&self) -> bool {
        self.wanted.load(Ordering::Acquire)
    }
}

fn within(values: &[f64], limit: f64) -> bool {
    values.iter().all(|value| value.abs() <= limit)
}

/// Returns the reading in a datagram, if its numbers are possible.
fn reading(datagram: &Datagram) -> Option<HandleReading> {
    let position_m = datagram.three(0);
    let velocity_m_s = datagram.three(7);
    let [w, i, j, k] = std::array::from_fn(|at| datagram.numbers[3 + at]);
    let gripper_rad = datagram.numbers[10];
    let orientation = if datagram.has(status::HAS_ORIENTATION) {
        let turn = Quaternion::new(w, i, j, k);
        let is_unit = (turn.norm() - 1.0).abs() <= UNIT_WITHIN;
        Some(is_unit.then(|| UnitQuaternion::from_quaternion(turn))?)
    } else {
        None
    };
    let has_velocity = datagram.has(status::HAS_VELOCITY);
    let has_gripper = datagram.has(status::HAS_GRIPPER);
    let possible = within(&position_m, POSITION_MAX_M)
        && (!has_velocity || within(&velocity_m_s, SPEED_MAX_M_S))
        && (!has_gripper || within(&[gripper_rad], GRIPPER_MAX_RAD));
    possible.then(|| HandleReading {
        position_m: position_m.into(),
        orientation,
        gripper_rad: has_gripper.then_some(gripper_rad),
        velocity_m_s: has_velocity.then(|| velocity_m_s.into()),
        buttons: datagram.buttons,
    })
}

impl Device for ExternalHandle {
    type Reading = HandleReading;

    fn poll(&mut self, now_s: f64) -> Option<TimedReading<HandleReading>> {
        let newest = self.line.receive(now_s, reading);
        // If the loop sets no force, the program still gets a response, with zero force.
        if !std::mem::take(&mut self.report) {
            self.line.report(self.is_wanted(), &[]);
        }
        let (stamped, status) = newest?;
        self.reported = Some(status & status::ON != 0);
        Some(stamped)
    }

    fn about(&self) -> (&Health, &DeviceIdentity) {
        self.line.about()
    }
}

impl Leader for ExternalHandle {
    fn switch_force(&mut self, on: bool) {
        self.wanted.store(on, Ordering::Release);
    }

    fn set_force(&mut self, force_n: Vector3<f64>, gripper_n: f64) {
        let (force_max_n, gripper_max_n) = self.forces_max_n;
        let is_finite = force_n.iter().chain([&gripper_n]).all(|x| x.is_finite());
        let on = self.is_wanted();
        let (force_n, gripper_n) = if is_finite && on {
            // Clamp each axis first, so that the squares of large numbers stay finite.
            let cut_n = force_n.map(|axis| axis.clamp(-force_max_n, force_max_n));
            (cut_n.cap_magnitude(force_max_n), gripper_n.clamp(-gripper_max_n, gripper_max_n))
        } else {
            (Vector3::zeros(), 0.0)
        };
        self.line.report(on, &[force_n.x, force_n.y, force_n.z, gripper_n]);
        self.report = true;
    }

    fn force_change(&mut self) -> Option<bool> {
        self.reported.take()
    }

    fn attach(&self, lever: &Lever) {
        // Only a flag for a loop that resumes. While the loop hangs, a command sent from here would be refused, because
        // the reading that it acknowledges is old: the device's own watchdog ends the force.
        let wanted = Arc::clone(&self.wanted);
        lever.attach(move || wanted.store(false, Ordering::Release));
    }
}

impl Drop for ExternalHandle {
    fn drop(&mut self) {
        self.line.leave();
    }
}
