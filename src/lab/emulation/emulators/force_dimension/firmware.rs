//! The emulated device's own rules: modes, watchdog, velocity threshold, saturation. Without I/O; time is passed in as
//! an argument.
//!
//! According to the SDK: force on selects FORCE; stop, excessive speed and an expired watchdog select BRAKE with a
//! cause; brakes off selects IDLE. A force is applied only in the state FORCE.

use drd::wire::ClientOrder;
use nalgebra::Vector3;
use nima_devices::force_dimension::status::{ENTRIES, ForceOffCause};

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FirmwareMode {
    /// No current.
    Idle,
    /// Force is applied.
    Force,
    /// Braking.
    #[default]
    Brake,
}

/// Output of the motors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotorOutput {
    pub mode: FirmwareMode,
    /// Force on the hand, N; zero outside [`FirmwareMode::Force`].
    pub force_n: Vector3<f64>,
    /// Force of the gripper, N.
    pub gripper_n: f64,
    /// Why the force was last switched off.
    pub cause: ForceOffCause,
}

/// A device that has just been switched on: velocity threshold 2 m/s, no watchdog.
#[derive(Clone, Debug)]
pub(super) struct Firmware {
    applied: MotorOutput,
    commanded_s: f64,
    motor_limit_n: f64,
    pub(super) watchdog_steps: u32,
    pub(super) threshold_mm_s: u32,
    past: Option<(f64, Vector3<f64>)>,
    pub(super) gripper_button: bool,
}

/// Velocity threshold after power-up, mm/s.
const THRESHOLD_MM_S: u32 = 2000;
/// Time between two positions from which the hand's speed is computed, s.
const SPEED_OVER_S: f64 = 0.004;
/// A speed above this results from a jump of the position, m/s, because the world was restarted.
const JUMP_M_S: f64 = 50.0;
/// Unit of the watchdog's duration, s: 125 us (`dhdSetWatchdog` in the manual of the SDK).
const STEP_S: f64 = 125e-6;

impl Firmware {
    /// Creates the firmware with this limit of the motors, N.
    pub(super) fn new(motor_limit_n: f64) -> Self {
        Self {
            applied: MotorOutput::default(),
            commanded_s: 0.0,
            motor_limit_n,
            watchdog_steps: 0,
            threshold_mm_s: THRESHOLD_MM_S,
            past: None,
            gripper_button: false,
        }
    }

    /// Returns the output of the motors.
    pub(super) const fn applied(&self) -> &MotorOutput {
        &self.applied
    }

    /// Switches the force off.
    pub(super) const fn cut(&mut self, cause: ForceOffCause) {
        self.applied =
            MotorOutput { mode: FirmwareMode::Brake, force_n: Vector3::new(0.0, 0.0, 0.0), gripper_n: 0.0, cause };
    }

    /// Advances the time with the hand at `position_m`.
    pub(super) fn pass(&mut self, now_s: f64, position_m: &Vector3<f64>) {
        let silent_s = now_s - self.commanded_s;
        if self.applied.mode == FirmwareMode::Force
            && self.watchdog_steps > 0
            && silent_s > f64::from(self.watchdog_steps) * STEP_S
        {
            self.cut(ForceOffCause::Watchdog);
        }
        let (past_s, past_m) = *self.past.get_or_insert((now_s, *position_m));
        if now_s - past_s < SPEED_OVER_S {
            return;
        }
        self.past = Some((now_s, *position_m));
        let speed_m_s = (position_m - past_m).norm() / (now_s - past_s);
        let too_fast = speed_m_s * 1e3 > f64::from(self.threshold_mm_s) && speed_m_s < JUMP_M_S;
        if self.applied.mode == FirmwareMode::Force && self.threshold_mm_s > 0 && too_fast {
            self.cut(ForceOffCause::Velocity);
        }
    }

    /// Executes an order; returns whether the motors were saturated.
    pub(super) fn obey(&mut self, now_s: f64, order: ClientOrder, argument: u32, values: [f64; 4]) -> bool {
        match order {
            ClientOrder::Force => return self.force(now_s, values),
            ClientOrder::EnableForce if argument == 0 => {
                self.cut(ForceOffCause::Software);
                self.applied.mode = FirmwareMode::Idle;
            }
            ClientOrder::EnableForce => {
                // The last cause of switching off remains readable.
                self.applied =
                    MotorOutput { mode: FirmwareMode::Force, cause: self.applied.cause, ..MotorOutput::default() };
                self.commanded_s = now_s;
            }
            ClientOrder::Brakes => {
                self.cut(ForceOffCause::Software);
                self.applied.mode = if argument == 0 { FirmwareMode::Idle } else { FirmwareMode::Brake };
            }
            ClientOrder::Watchdog => (self.watchdog_steps, self.commanded_s) = (argument, now_s),
            ClientOrder::VelocityThreshold => self.threshold_mm_s = argument,
            ClientOrder::Button => self.gripper_button = argument != 0,
            ClientOrder::Close => self.cut(ForceOffCause::Software),
            ClientOrder::Hello | ClientOrder::Open | ClientOrder::Read => {}
        }
        false
    }

    fn force(&mut self, now_s: f64, [x, y, z, gripper_n]: [f64; 4]) -> bool {
        let asked_n = Vector3::new(x, y, z);
        if self.applied.mode != FirmwareMode::Force
            || !asked_n.iter().chain([&gripper_n]).all(|value| value.is_finite())
        {
            return false;
        }
        self.commanded_s = now_s;
        let saturated = asked_n.norm() > self.motor_limit_n;
        self.applied.force_n = if saturated { asked_n * (self.motor_limit_n / asked_n.norm()) } else { asked_n };
        self.applied.gripper_n = gripper_n;
        saturated
    }

    pub(super) fn status(&self, fault: bool, reset: bool) -> [u32; ENTRIES] {
        let mode = self.applied.mode;
        let off = self.applied.cause as u32;
        let on = u32::from;
        let modes = [on(mode == FirmwareMode::Idle), on(mode == FirmwareMode::Force), on(mode == FirmwareMode::Brake)];
        let [idle, force, brake] = modes;
        [1, 1, 1, on(reset), idle, force, brake, 0, 1, on(fault), 0, 0, 1, 0, off, 0, 1]
    }
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "a force is passed on unchanged, and no force is exactly zero")]
mod tests {
    use super::*;

    fn on_with_watchdog(steps: u32) -> Firmware {
        let mut firmware = Firmware::new(12.0);
        firmware.obey(0.0, ClientOrder::Watchdog, steps, [0.0; 4]);
        firmware.obey(0.0, ClientOrder::EnableForce, 1, [0.0; 4]);
        firmware.obey(0.0, ClientOrder::Force, 0, [3.0, 0.0, 0.0, 1.0]);
        firmware
    }

    #[test]
    fn the_watchdog_cuts_force_after_its_time_and_not_before() {
        let mut firmware = on_with_watchdog(160);
        firmware.pass(0.0199, &Vector3::zeros());
        assert_eq!(firmware.applied().force_n.x, 3.0);
        firmware.pass(0.0201, &Vector3::zeros());
        assert_eq!(
            firmware.applied(),
            &MotorOutput { cause: ForceOffCause::Watchdog, ..MotorOutput::default() },
            "brakes, no force"
        );
        firmware.obey(0.03, ClientOrder::Force, 0, [3.0, 0.0, 0.0, 0.0]);
        assert_eq!(firmware.applied().force_n.norm(), 0.0, "a force command alone does not bring it back");
    }

    #[test]
    fn a_hand_that_is_too_fast_loses_force() {
        let mut firmware = on_with_watchdog(0);
        let at = |speed_m_s: f64, k: u32| Vector3::new(speed_m_s * f64::from(k) * 1e-3, 0.0, 0.0);
        for k in 0..100 {
            firmware.pass(f64::from(k) * 1e-3, &at(1.9, k));
        }
        assert_eq!(firmware.applied().mode, FirmwareMode::Force);
        for k in 100..120 {
            firmware.pass(f64::from(k) * 1e-3, &at(2.1, k));
        }
        assert_eq!((firmware.applied().mode, firmware.applied().cause), (FirmwareMode::Brake, ForceOffCause::Velocity));
    }

    #[test]
    fn motors_saturate_and_refuse_what_is_no_number() {
        let mut firmware = on_with_watchdog(0);
        assert!(firmware.obey(0.0, ClientOrder::Force, 0, [0.0, 30.0, 40.0, 0.0]));
        assert!((firmware.applied().force_n - Vector3::new(0.0, 7.2, 9.6)).norm() < 1e-12);
        firmware.obey(0.0, ClientOrder::Force, 0, [f64::NAN, 0.0, 0.0, 0.0]);
        assert!((firmware.applied().force_n.norm() - 12.0).abs() < 1e-12);
    }
}
