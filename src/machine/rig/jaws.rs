//! Converts the orientation of the instrument's jaws to servo angles and back, with a PID controller around each servo.

use std::ops::RangeInclusive;

use nalgebra::UnitQuaternion;
use nima_core::{
    kinematics::WristJaws,
    signal::{Pid, PidGains},
};
use nima_devices::{DeviceError, SERVOS, ServoReading, dynamixel::DynamixelSettings};
use serde::{Deserialize, Serialize};

/// Transmission from the servos to the instrument's wrist. Order: roll, pitch, yaw, grip.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct JawsSettings {
    /// Servo angle per joint angle of the wrist.
    pub ratio: [f64; SERVOS],
    /// Opening of the jaws per opening of the gripper.
    pub grip_per_gripper: f64,
    /// Force at the finger per current of the closing servo, N/A; zero without force feedback on the gripper.
    pub grip_n_per_a: f64,
    /// PID around each servo's built-in control, to remove the steady error due to load and backlash.
    pub pid: PidGains,
}

impl Default for JawsSettings {
    fn default() -> Self {
        let pid = PidGains { proportional: 0.15, integral_per_s: 4.0, derivative_s: 0.002, integral_max: 0.15 };
        Self { ratio: [1.0; SERVOS], grip_per_gripper: 1.0, grip_n_per_a: 0.0, pid }
    }
}

/// Far outside the gears of any wrist: only a wrong unit or a slip of the pen lies beyond.
const RATIO: RangeInclusive<f64> = 0.01..=100.0;
const FACTOR: RangeInclusive<f64> = 0.0..=100.0;

impl JawsSettings {
    /// Refuses values without physical sense, and grip force from a servo that does not measure its current.
    pub(super) fn check(&self, servos: Option<&DynamixelSettings>) -> Result<(), DeviceError> {
        let refused = |key: &str, value: String, allowed: &str| {
            Err(DeviceError::Setting { key: key.to_owned(), value, allowed: allowed.to_owned() })
        };
        let Self { ratio, grip_per_gripper, grip_n_per_a, pid } = self;
        if !ratio.iter().all(|one| RATIO.contains(&one.abs())) {
            return refused("ratio", format!("{ratio:?}"), "a number from 0.01 to 100, or the same below zero");
        }
        if !FACTOR.contains(grip_per_gripper) {
            return refused("grip_per_gripper", grip_per_gripper.to_string(), "0 to 100");
        }
        if !FACTOR.contains(grip_n_per_a) {
            return refused("grip_n_per_a", grip_n_per_a.to_string(), "0 to 100 N/A");
        }
        let PidGains { proportional, integral_per_s, derivative_s, integral_max } = *pid;
        for (key, gain) in [
            ("pid.proportional", proportional),
            ("pid.integral_per_s", integral_per_s),
            ("pid.derivative_s", derivative_s),
            ("pid.integral_max", integral_max),
        ] {
            if !FACTOR.contains(&gain) {
                return refused(key, gain.to_string(), "0 to 100");
            }
        }
        let Some(closing) = servos.map(|servos| &servos.servos[SERVOS - 1]) else { return Ok(()) };
        if *grip_n_per_a > 0.0 && closing.current_limit_a <= 0.0 {
            let allowed = "0 for a closing servo that does not measure its current (without current_limit_a)";
            return refused("grip_n_per_a", grip_n_per_a.to_string(), allowed);
        }
        Ok(())
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) struct JawsControl {
    settings: JawsSettings,
    pids: [Pid; SERVOS],
    /// Last commanded orientation, as angles; counts full turns.
    asked: Option<WristJaws>,
    period_s: f64,
    /// Time of the last set points, s.
    last_s: Option<f64>,
}

impl JawsControl {
    pub(super) const fn new(settings: JawsSettings, period_s: f64) -> Self {
        Self { settings, pids: [Pid::new(settings.pid); SERVOS], asked: None, period_s, last_s: None }
    }

    /// Returns the orientation of the jaws from the measured servo angles.
    pub(super) fn measured(&self, reading: &ServoReading) -> WristJaws {
        let [roll_rad, pitch_rad, yaw_rad, _] = self.angles(reading);
        WristJaws { roll_rad, pitch_rad, yaw_rad }
    }

    /// Returns the force that opens the jaws, N at the finger: the load on the closing servo; `None` if it is not
    /// measured.
    pub(super) fn grip_n(&self, reading: &ServoReading) -> Option<f64> {
        let Self { settings: JawsSettings { grip_n_per_a, ratio, .. }, .. } = self;
        let closing_a = -reading.current_a[SERVOS - 1] * ratio[SERVOS - 1].signum();
        (*grip_n_per_a > 0.0 && closing_a.is_finite()).then(|| (closing_a * grip_n_per_a).max(0.0))
    }

    fn angles(&self, reading: &ServoReading) -> [f64; SERVOS] {
        std::array::from_fn(|i| reading.position_rad[i] / self.settings.ratio[i])
    }

    /// Returns the set points of the servos at this time (s), rad, for this orientation and this opening of the gripper
    /// (rad).
    pub(super) fn goals(
        &mut self,
        now_s: f64,
        s1_from_jaws: &UnitQuaternion<f64>,
        gripper_rad: Option<f64>,
        reading: &ServoReading,
    ) -> [f64; SERVOS] {
        // Right after a late tick, one step of the reading would otherwise look like a high speed.
        let at_least_s = 0.5 * self.period_s;
        let dt_s = self.last_s.replace(now_s).map_or(self.period_s, |last_s| (now_s - last_s).max(at_least_s));
        let near = self.asked.unwrap_or_else(|| self.measured(reading));
        let jaws = WristJaws::of(s1_from_jaws, &near);
        self.asked = Some(jaws);
        let measured = self.angles(reading);
        let grip_rad = gripper_rad.map_or(measured[SERVOS - 1], |rad| rad * self.settings.grip_per_gripper);
        let wanted = [jaws.roll_rad, jaws.pitch_rad, jaws.yaw_rad, grip_rad];
        std::array::from_fn(|i| {
            let trim = self.pids[i].step(wanted[i], measured[i], dt_s);
            (wanted[i] + trim) * self.settings.ratio[i]
        })
    }

    pub(super) fn reset(&mut self) {
        self.asked = None;
        self.last_s = None;
        self.pids.iter_mut().for_each(Pid::reset);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::RigConfig;

    #[test]
    fn a_servo_without_current_gives_no_grip_force_instead_of_zero() {
        let control = JawsControl::new(JawsSettings { grip_n_per_a: 10.0, ..JawsSettings::default() }, 1e-3);
        let reading =
            |closing_a: f64| ServoReading { current_a: [0.0, 0.0, 0.0, -closing_a], ..ServoReading::default() };
        assert_eq!(control.grip_n(&reading(0.5)), Some(5.0));
        assert_eq!(control.grip_n(&reading(f64::NAN)), None);
        let mut rig = RigConfig::load("paper").unwrap();
        let right = rig.devices.as_mut().unwrap().right.as_mut().unwrap();
        right.jaws.grip_n_per_a = 10.0;
        for servo in &mut right.servos.as_mut().unwrap().servos {
            servo.current_limit_a = 0.0;
        }
        let refused = rig.validate().expect_err("no current").to_string();
        let source = std::error::Error::source(&rig.validate().unwrap_err()).map(ToString::to_string);
        let words = format!("{refused} {}", source.unwrap_or_default());
        assert!(words.contains("devices.right.jaws.grip_n_per_a"), "{words}");
    }

    #[test]
    fn values_without_physical_sense_are_refused() {
        let usual = JawsSettings::default();
        assert!(usual.check(None).is_ok());
        let negative = JawsSettings { ratio: [-2.0, 1.0, 1.0, 1.0], ..usual };
        assert!(negative.check(None).is_ok(), "a ratio may turn the other way");
        let pid = PidGains { integral_per_s: -1.0, ..usual.pid };
        for (settings, key) in [
            (JawsSettings { ratio: [1.0, 0.0, 1.0, 1.0], ..usual }, "ratio"),
            (JawsSettings { ratio: [f64::NAN, 1.0, 1.0, 1.0], ..usual }, "ratio"),
            (JawsSettings { grip_per_gripper: -1.0, ..usual }, "grip_per_gripper"),
            (JawsSettings { grip_n_per_a: 1e4, ..usual }, "grip_n_per_a"),
            (JawsSettings { pid, ..usual }, "pid.integral_per_s"),
        ] {
            let words = settings.check(None).unwrap_err().to_string();
            assert!(words.starts_with(key), "{words}");
        }
    }
}
