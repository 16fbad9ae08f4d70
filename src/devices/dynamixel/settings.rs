//! Settings of the four servos, checked before anything is opened, and the register values that follow from them.

use std::f64::consts::FRAC_PI_2;

use serde::{Deserialize, Serialize};

use super::table::{
    self, ACCELERATION_UNIT_RAD_S2, BAUDS, DynamixelRegister, ServoModel, TICKS_PER_TURN, VELOCITY_UNIT_RAD_S,
    WATCHDOG_UNIT_S, ticks_from_rad,
};
use crate::{DeviceError, SERVOS};

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OperatingMode {
    /// Within one turn; the servo refuses goals beyond its limits.
    #[default]
    Position = 3,
    /// Over several turns.
    ExtendedPosition = 4,
    /// Over several turns, with the current limited to `goal_current_a`.
    CurrentBasedPosition = 5,
}

/// Gains of the servo's built-in controllers, in the units of its registers; the defaults are the factory values of the
/// XM430.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Gains {
    /// Position, proportional (128 is one PWM step per tick).
    pub position_p: u16,
    /// Position, integral.
    pub position_i: u16,
    /// Position, differential.
    pub position_d: u16,
    /// Velocity, proportional.
    pub velocity_p: u16,
    /// Velocity, integral.
    pub velocity_i: u16,
    pub feedforward_1: u16,
    pub feedforward_2: u16,
}

impl Default for Gains {
    fn default() -> Self {
        Self {
            position_p: 800,
            position_i: 0,
            position_d: 0,
            velocity_p: 100,
            velocity_i: 1920,
            feedforward_1: 0,
            feedforward_2: 0,
        }
    }
}

/// One servo. All angles refer to its shaft, zero in the middle of its range (tick 2048), after offset and sign.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ServoSettings {
    /// Id on the bus, 0 to 252.
    pub id: u8,
    /// Name of the model, such as `XM430-W350`; any supported model if omitted.
    #[serde(default)]
    pub model: Option<String>,
    /// Reverses the direction of rotation (drive mode, bit 0; stored in the servo).
    #[serde(default)]
    pub reverse: bool,
    /// Offset added to the angle of the encoder, rad (homing offset; stored in the servo). At most a quarter turn in
    /// position mode.
    #[serde(default)]
    pub homing_offset_rad: f64,
    /// Operating mode (stored in the servo).
    #[serde(default)]
    pub operating_mode: OperatingMode,
    pub position_min_rad: f64,
    pub position_max_rad: f64,
    /// Current limit, A (stored in the servo); omitted for a servo that does not measure its current.
    #[serde(default)]
    pub current_limit_a: f64,
    /// Current for holding the goal in current-based position mode, A; the current limit if omitted.
    #[serde(default)]
    pub goal_current_a: Option<f64>,
    /// Maximum speed of a move, rad/s; 0 sets no limit.
    #[serde(default)]
    pub profile_velocity_rad_s: f64,
    /// Maximum acceleration of a move, rad/s^2; 0 sets no limit.
    #[serde(default)]
    pub profile_acceleration_rad_s2: f64,
    #[serde(default)]
    pub gains: Gains,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DynamixelSettings {
    /// Device file of the adapter, or `COM3`.
    pub port: String,
    /// Line speed, bit/s, as supported by the servos.
    pub baud: u32,
    pub servos: [ServoSettings; SERVOS],
    /// Whether to request one common answer from all servos; if a firmware rejects this, each servo answers separately.
    #[serde(default = "yes")]
    pub fast_sync_read: bool,
    /// Time after which a servo with torque on stops if it receives nothing, s; 0.02 to 2.54.
    #[serde(default = "watchdog_s")]
    pub bus_watchdog_s: f64,
    /// Time without a reading after which the servos count as lost, s; 0.005 to 1.
    #[serde(default = "silence_s")]
    pub silence_s: f64,
}

const fn yes() -> bool {
    true
}

const fn watchdog_s() -> f64 {
    0.1
}

pub(super) const fn silence_s() -> f64 {
    0.018
}

/// Highest id (ROBOTIS e-manual, protocol 2.0).
const ID_MAX: u8 = 252;
/// Highest profile velocity and acceleration, units (ROBOTIS e-manual, X series).
const PROFILE_MAX: f64 = 32_767.0;
// Fourteen bits (ROBOTIS e-manual, X series).
const GAIN_MAX: u16 = 16_383;
/// Maximum turns of an extended position in each direction (ROBOTIS e-manual, X series: -256 to 256 revolutions); one
/// turn is kept, so that the homing offset fits too.
const TURNS_MAX: f64 = 255.0;

pub(super) type RegisterGoal = (DynamixelRegister, u32);

impl DynamixelSettings {
    /// Checks every setting; the error names the key and the allowed values.
    ///
    /// # Errors
    /// [`DeviceError::Setting`] for the first invalid setting.
    pub fn check(&self) -> Result<(), DeviceError> {
        let in_range = |key: &str, value: f64, low: f64, high: f64| {
            let allowed = format!("{low} to {high}");
            if (low..=high).contains(&value) { Ok(()) } else { Err(impossible(key, &value, allowed)) }
        };
        if !BAUDS.contains(&self.baud) {
            return Err(impossible("baud", &self.baud, format!("one of {BAUDS:?}")));
        }
        in_range("bus_watchdog_s", self.bus_watchdog_s, WATCHDOG_UNIT_S, 127.0 * WATCHDOG_UNIT_S)?;
        in_range("silence_s", self.silence_s, 0.005, 1.0)?;
        for (index, servo) in self.servos.iter().enumerate() {
            servo.check(index)?;
            if self.servos[..index].iter().any(|other| other.id == servo.id) {
                return Err(impossible(
                    &format!("servos[{index}].id"),
                    &servo.id,
                    "use a different id for each servo".to_owned(),
                ));
            }
        }
        Ok(())
    }

    /// Returns the ids in the form of the servos' identity: `ids 1 2 3 4`.
    pub fn ids_text(&self) -> String {
        ids_text(self.servos.iter().map(|servo| servo.id))
    }

    /// Checks that the servos of two instruments have different ids, because nothing else reveals a cable at the wrong
    /// adapter.
    ///
    /// # Errors
    /// [`DeviceError::Setting`] for the first common id.
    pub fn check_beside(&self, other: &Self) -> Result<(), DeviceError> {
        let has = |id: u8| other.servos.iter().any(|servo| servo.id == id);
        match self.servos.iter().position(|servo| has(servo.id)) {
            None => Ok(()),
            Some(index) => {
                let allowed = "use different ids for the right and left servos, so that swapped cables are detected";
                Err(impossible(&format!("servos[{index}].id"), &self.servos[index].id, allowed.to_owned()))
            }
        }
    }

    /// Returns the watchdog's time in units of the register.
    pub(super) fn watchdog_units(&self) -> u8 {
        (self.bus_watchdog_s / WATCHDOG_UNIT_S).round().clamp(1.0, 127.0) as u8
    }
}

/// First word of the identity of servos, which have no serial number.
pub(crate) const IDS: &str = "ids";

pub(super) fn ids_text(ids: impl Iterator<Item = u8>) -> String {
    ids.fold(IDS.to_owned(), |words, id| format!("{words} {id}"))
}

fn impossible(key: &str, value: &dyn std::fmt::Display, allowed: String) -> DeviceError {
    DeviceError::Setting { key: key.to_owned(), value: value.to_string(), allowed }
}

impl ServoSettings {
    fn check(&self, index: usize) -> Result<(), DeviceError> {
        let key = |name: &str| format!("servos[{index}].{name}");
        if self.id > ID_MAX {
            return Err(impossible(&key("id"), &self.id, format!("0 to {ID_MAX}")));
        }
        if let Some(name) = &self.model
            && !table::MODELS.iter().any(|model| model.name == name)
        {
            let known: Vec<_> = table::MODELS.iter().map(|model| model.name).collect();
            return Err(impossible(&key("model"), name, format!("known are {}", known.join(", "))));
        }
        let single_turn = self.operating_mode == OperatingMode::Position;
        let turns = std::f64::consts::TAU * TURNS_MAX;
        let (homing, low, high) = if single_turn {
            (FRAC_PI_2, table::rad_from_ticks(0.0), table::rad_from_ticks(TICKS_PER_TURN - 1.0))
        } else {
            (turns, -turns, turns)
        };
        let current_max = 2.69e-3 * 2047.0;
        let ranges = [
            ("homing_offset_rad", self.homing_offset_rad, -homing, homing),
            ("position_min_rad", self.position_min_rad, low - 1e-3, self.position_max_rad),
            ("position_max_rad", self.position_max_rad, self.position_min_rad, high + 1e-3),
            ("current_limit_a", self.current_limit_a, 0.0, current_max),
            ("goal_current_a", self.goal_current_a.unwrap_or(0.0), 0.0, self.current_limit_a),
            ("profile_velocity_rad_s", self.profile_velocity_rad_s, 0.0, PROFILE_MAX * VELOCITY_UNIT_RAD_S),
            (
                "profile_acceleration_rad_s2",
                self.profile_acceleration_rad_s2,
                0.0,
                PROFILE_MAX * ACCELERATION_UNIT_RAD_S2,
            ),
        ];
        for (name, value, low, high) in ranges {
            if !(low..=high).contains(&value) {
                return Err(impossible(&key(name), &value, format!("{low:.4} to {high:.4}")));
            }
        }
        let gains = &self.gains;
        let largest = [gains.position_p, gains.position_i, gains.position_d, gains.velocity_p, gains.velocity_i];
        match largest.into_iter().chain([gains.feedforward_1, gains.feedforward_2]).find(|gain| *gain > GAIN_MAX) {
            Some(gain) => Err(impossible(&key("gains"), &gain, format!("0 to {GAIN_MAX} each"))),
            None => Ok(()),
        }
    }

    pub(super) fn limits_ticks(&self) -> (f64, f64) {
        let low = ticks_from_rad(self.position_min_rad).ceil();
        let high = ticks_from_rad(self.position_max_rad).floor();
        if self.operating_mode == OperatingMode::Position {
            (low.clamp(0.0, TICKS_PER_TURN - 1.0), high.clamp(0.0, TICKS_PER_TURN - 1.0))
        } else {
            (low, high)
        }
    }

    /// Returns the values for the EEPROM, which keeps them without power; `drive_mode` is the current value.
    pub(super) fn eeprom(&self, model: &ServoModel, drive_mode: u8) -> Vec<RegisterGoal> {
        // Profiles are based on velocity, and a goal must not switch the torque on: bits 2 and 3 off.
        let drive_mode = u32::from(drive_mode & !0b1101) | u32::from(self.reverse);
        let homing = (self.homing_offset_rad / std::f64::consts::TAU * TICKS_PER_TURN).round() as i32;
        let mut wanted = vec![
            (table::RETURN_DELAY, 0),
            (table::DRIVE_MODE, drive_mode),
            (table::OPERATING_MODE, self.operating_mode as u32),
            (table::HOMING_OFFSET, homing.cast_unsigned()),
        ];
        if model.measures_current() {
            wanted.push((table::CURRENT_LIMIT, (self.current_limit_a / model.current_unit_a).round() as u32));
        }
        if self.operating_mode == OperatingMode::Position {
            let (low, high) = self.limits_ticks();
            wanted.extend([(table::POSITION_MIN, low as u32), (table::POSITION_MAX, high as u32)]);
        }
        wanted
    }

    /// Returns the values for the RAM, which is lost at every restart.
    pub(super) fn ram(&self, model: &ServoModel) -> Vec<RegisterGoal> {
        let gains = &self.gains;
        // Only 0 means "no limit", so a small value must not be rounded to 0.
        let profile = |value: f64, unit: f64| if value > 0.0 { (value / unit).round().max(1.0) as u32 } else { 0 };
        let goal_a = self.goal_current_a.unwrap_or(self.current_limit_a);
        let goal_current = (table::GOAL_CURRENT, (goal_a / model.current_unit_a).round() as u32);
        let mut wanted = vec![
            (table::VELOCITY_I, gains.velocity_i.into()),
            (table::VELOCITY_P, gains.velocity_p.into()),
            (table::POSITION_D, gains.position_d.into()),
            (table::POSITION_I, gains.position_i.into()),
            (table::POSITION_P, gains.position_p.into()),
            (table::FEEDFORWARD_2, gains.feedforward_2.into()),
            (table::FEEDFORWARD_1, gains.feedforward_1.into()),
            (table::PROFILE_ACCELERATION, profile(self.profile_acceleration_rad_s2, ACCELERATION_UNIT_RAD_S2)),
            (table::PROFILE_VELOCITY, profile(self.profile_velocity_rad_s, VELOCITY_UNIT_RAD_S)),
        ];
        wanted.extend(model.measures_current().then_some(goal_current));
        wanted
    }

    /// Checks that the settings of the current fit the model.
    pub(super) fn check_current(&self, model: &ServoModel) -> Result<(), DeviceError> {
        let max_a = f64::from(model.current_max) * model.current_unit_a;
        if !model.measures_current() {
            let uses = self.current_limit_a > 0.0
                || self.goal_current_a.is_some()
                || self.operating_mode == OperatingMode::CurrentBasedPosition;
            let allowed = format!(
                "a {} does not measure its current: omit current_limit_a and goal_current_a, and use the mode position or extended_position",
                model.name
            );
            return if uses { Err(impossible("current_limit_a", &self.current_limit_a, allowed)) } else { Ok(()) };
        }
        if self.current_limit_a <= 0.0 {
            let allowed = format!("above 0: a {} measures its current and needs a limit", model.name);
            return Err(impossible("current_limit_a", &self.current_limit_a, allowed));
        }
        if self.current_limit_a > max_a {
            let allowed = format!("a {} takes at most {max_a:.3} A", model.name);
            return Err(impossible("current_limit_a", &self.current_limit_a, allowed));
        }
        Ok(())
    }
}
