//! Control table of the X series, limited to what driver and emulator use: addresses, units, models, hardware errors
//! (e-manual, X series).

use std::f64::consts::TAU;

use crate::DeviceError;

/// A register: address and length in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DynamixelRegister {
    pub address: u16,
    pub bytes: u16,
}

const fn register(address: u16, bytes: u16) -> DynamixelRegister {
    DynamixelRegister { address, bytes }
}

/// Address of the model number (2 bytes, followed by 4 bytes of model information and the firmware version).
pub const MODEL: DynamixelRegister = register(0, 2);
pub const FIRMWARE: DynamixelRegister = register(6, 1);
pub const ID: DynamixelRegister = register(7, 1);
/// Code of the line speed, see [`BAUDS`].
pub const BAUD: DynamixelRegister = register(8, 1);
/// Delay before an answer, units of 2 us.
pub const RETURN_DELAY: DynamixelRegister = register(9, 1);
/// Bit 0 reverses the direction, bit 2 selects time-based profiles, bit 3 switches the torque on with a goal.
pub const DRIVE_MODE: DynamixelRegister = register(10, 1);
/// 0 current, 1 velocity, 3 position, 4 extended position, 5 current-based position, 16 PWM.
pub const OPERATING_MODE: DynamixelRegister = register(11, 1);
/// Secondary id; the servo executes writes to it without an answer.
pub const SHADOW_ID: DynamixelRegister = register(12, 1);
/// Offset added to the encoder's position, ticks.
pub const HOMING_OFFSET: DynamixelRegister = register(20, 4);
/// Velocity above which the servo counts as moving.
pub const MOVING_THRESHOLD: DynamixelRegister = register(24, 4);
/// Degrees Celsius.
pub const TEMPERATURE_LIMIT: DynamixelRegister = register(31, 1);
/// Maximum supply voltage, units of 0.1 V.
pub const VOLTAGE_MAX: DynamixelRegister = register(32, 2);
/// Minimum supply voltage, units of 0.1 V.
pub const VOLTAGE_MIN: DynamixelRegister = register(34, 2);
/// Maximum PWM; 885 is 100 %.
pub const PWM_LIMIT: DynamixelRegister = register(36, 2);
/// Limit of the current, in the model's unit; see [`ServoModel::current_unit_a`].
pub const CURRENT_LIMIT: DynamixelRegister = register(38, 2);
/// Units of 0.229 rpm.
pub const VELOCITY_LIMIT: DynamixelRegister = register(44, 4);
/// Ticks; in position mode only.
pub const POSITION_MAX: DynamixelRegister = register(48, 4);
/// Ticks; in position mode only.
pub const POSITION_MIN: DynamixelRegister = register(52, 4);
/// Hardware errors that switch the torque off.
pub const SHUTDOWN: DynamixelRegister = register(63, 1);
/// Registers below this address are writable only while the torque is off.
pub const EEPROM_BYTES: u16 = 64;
/// 1: the motor is driven.
pub const TORQUE_ENABLE: DynamixelRegister = register(64, 1);
/// 0: answers pings only; 1: also reads; 2: every instruction.
pub const STATUS_RETURN_LEVEL: DynamixelRegister = register(68, 1);
/// Whether a write waits for the action instruction.
pub const REGISTERED: DynamixelRegister = register(69, 1);
/// Bits: 0 input voltage, 2 overheating, 3 encoder, 4 electrical shock, 5 overload; only a restart clears them.
pub const HARDWARE_ERROR: DynamixelRegister = register(70, 1);
/// Integral gain of the velocity controller.
pub const VELOCITY_I: DynamixelRegister = register(76, 2);
/// Proportional gain of the velocity controller.
pub const VELOCITY_P: DynamixelRegister = register(78, 2);
/// Differential gain of the position controller.
pub const POSITION_D: DynamixelRegister = register(80, 2);
/// Integral gain of the position controller.
pub const POSITION_I: DynamixelRegister = register(82, 2);
/// Proportional gain of the position controller.
pub const POSITION_P: DynamixelRegister = register(84, 2);
/// Acceleration feedforward of the position controller.
pub const FEEDFORWARD_2: DynamixelRegister = register(88, 2);
/// Velocity feedforward of the position controller.
pub const FEEDFORWARD_1: DynamixelRegister = register(90, 2);
/// Units of 20 ms; 0 off, -1 expired.
pub const BUS_WATCHDOG: DynamixelRegister = register(98, 1);
/// Units of 0.113 %; 885 is 100 %.
pub const GOAL_PWM: DynamixelRegister = register(100, 2);
/// Goal in current mode, limit in current-based position mode.
pub const GOAL_CURRENT: DynamixelRegister = register(102, 2);
/// Units of 0.229 rpm.
pub const GOAL_VELOCITY: DynamixelRegister = register(104, 4);
/// Units of 214.577 rev/min^2; 0 sets no limit.
pub const PROFILE_ACCELERATION: DynamixelRegister = register(108, 4);
/// Units of 0.229 rpm; 0 sets no limit.
pub const PROFILE_VELOCITY: DynamixelRegister = register(112, 4);
/// Ticks.
pub const GOAL_POSITION: DynamixelRegister = register(116, 4);
/// Milliseconds, 0 to 32767.
pub const TICK: DynamixelRegister = register(120, 2);
/// 1 while the servo moves faster than [`MOVING_THRESHOLD`].
pub const MOVING: DynamixelRegister = register(122, 1);
/// Bit 0: in position; bit 1: a profile is running; bit 3: following error.
pub const MOVING_STATUS: DynamixelRegister = register(123, 1);
/// Units of 0.113 %; 885 is 100 %.
pub const PRESENT_PWM: DynamixelRegister = register(124, 2);
/// Measured current, in the model's unit.
pub const PRESENT_CURRENT: DynamixelRegister = register(126, 2);
/// Units of 0.229 rpm.
pub const PRESENT_VELOCITY: DynamixelRegister = register(128, 4);
/// Ticks.
pub const PRESENT_POSITION: DynamixelRegister = register(132, 4);
/// Velocity of the profile, units of 0.229 rpm.
pub const VELOCITY_TRAJECTORY: DynamixelRegister = register(136, 4);
/// Position of the profile, ticks.
pub const POSITION_TRAJECTORY: DynamixelRegister = register(140, 4);
/// Supply voltage, units of 0.1 V.
pub const VOLTAGE: DynamixelRegister = register(144, 2);
/// Degrees Celsius.
pub const TEMPERATURE: DynamixelRegister = register(146, 1);

/// Value at which [`TICK`] overflows, ms (ROBOTIS e-manual, X series).
pub const TICK_WRAP: i32 = 32_768;
/// Encoder steps of one turn (ROBOTIS e-manual, X series).
pub const TICKS_PER_TURN: f64 = 4096.0;
/// Ticks at zero radians: the middle of the range.
pub const TICKS_AT_ZERO: f64 = 2048.0;
/// One unit of velocity, 0.229 rpm, in rad/s.
pub const VELOCITY_UNIT_RAD_S: f64 = 0.229 * TAU / 60.0;
/// One unit of acceleration, 214.577 rev/min^2, in rad/s^2.
pub const ACCELERATION_UNIT_RAD_S2: f64 = 214.577 * TAU / 3600.0;
/// One unit of the bus watchdog, s (ROBOTIS e-manual, X series).
pub const WATCHDOG_UNIT_S: f64 = 0.020;
/// Value of the bus watchdog once it has expired: -1 in eight bits (ROBOTIS e-manual, X series).
pub const WATCHDOG_EXPIRED: u8 = 0xFF;

/// Line speeds by their code in [`BAUD`].
pub const BAUDS: [u32; 8] = [9600, 57_600, 115_200, 1_000_000, 2_000_000, 3_000_000, 4_000_000, 4_500_000];

/// Returns the ticks of an angle of the shaft.
pub fn ticks_from_rad(angle_rad: f64) -> f64 {
    angle_rad / TAU * TICKS_PER_TURN + TICKS_AT_ZERO
}

/// Returns the angle of the shaft at `ticks`.
pub fn rad_from_ticks(ticks: f64) -> f64 {
    (ticks - TICKS_AT_ZERO) / TICKS_PER_TURN * TAU
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServoModel {
    /// Model number in the answer to a ping.
    pub number: u16,
    pub name: &'static str,
    /// One unit of current, A; not a number if the model does not measure its current.
    pub current_unit_a: f64,
    /// Highest current limit, units; 0 if the model does not measure its current.
    pub current_max: u16,
}

const fn model(number: u16, name: &'static str, current_unit_a: f64, current_max: u16) -> ServoModel {
    ServoModel { number, name, current_unit_a, current_max }
}

/// A model that reports its load instead of its current, and has no limit of the current.
const fn without_current(number: u16, name: &'static str) -> ServoModel {
    model(number, name, f64::NAN, 0)
}

/// Number, unit of the current and highest current limit of each model (ROBOTIS e-manual).
pub const MODELS: [ServoModel; 13] = [
    model(1000, "XH430-W350", 2.69e-3, 648),
    model(1010, "XH430-W210", 2.69e-3, 648),
    model(1020, "XM430-W350", 2.69e-3, 1193),
    model(1030, "XM430-W210", 2.69e-3, 1193),
    model(1120, "XM540-W270", 2.69e-3, 2047),
    model(1130, "XM540-W150", 2.69e-3, 2047),
    model(1190, "XL330-M077", 1e-3, 1750),
    model(1200, "XL330-M288", 1e-3, 1750),
    without_current(1060, "XL430-W250"),
    without_current(1070, "XC430-W150"),
    without_current(1080, "XC430-W240"),
    without_current(1090, "2XL430-W250"),
    without_current(1160, "2XC430-W250"),
];

impl ServoModel {
    pub fn numbered(number: u16) -> Option<&'static Self> {
        MODELS.iter().find(|model| model.number == number)
    }

    pub const fn measures_current(&self) -> bool {
        self.current_max > 0
    }

    /// Returns whether the model has the factory values of the small series for 5 V.
    pub const fn is_small(&self) -> bool {
        matches!(self.number, 1190 | 1200)
    }
}

/// Returns the error for a servo of another model.
pub fn unsupported(place: String, number: u16) -> DeviceError {
    let known: Vec<_> = MODELS.iter().map(|model| model.name).collect();
    DeviceError::Unsupported {
        place,
        found: format!("servo with model number {number}"),
        cure: format!("Use a servo of these models: {}.", known.join(", ")),
    }
}

/// Hardware error status (register 70), with the state of the bus watchdog in bit 7.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HardwareError(pub u8);

impl HardwareError {
    /// Text for each bit, lowest first.
    pub const WORDS: [(u8, &'static str); 7] = [
        (0x01, "input voltage outside its limits"),
        (0x04, "overheated"),
        (0x08, "motor encoder failed"),
        (0x10, "electrical shock or too little power"),
        (0x20, "overload"),
        (Self::TORQUE_GONE, "the torque went off without a command"),
        (Self::WATCHDOG, "the bus watchdog expired"),
    ];
    /// Not a bit of register 70: the bus watchdog has expired.
    pub const WATCHDOG: u8 = 0x80;
    /// Not a bit of register 70: the torque went off without a command, as after a restart.
    pub const TORQUE_GONE: u8 = 0x40;
    pub const OVERLOAD: u8 = 0x20;

    /// Returns whether an error is reported.
    pub const fn is_any(self) -> bool {
        self.0 != 0
    }
}

impl std::fmt::Display for HardwareError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let known = Self::WORDS.iter().filter(|(bit, _)| self.0 & bit != 0);
        let mut empty = true;
        for (_, words) in known {
            write!(f, "{}{words}", if empty { "" } else { ", " })?;
            empty = false;
        }
        if empty { write!(f, "hardware error {:#04x}", self.0) } else { Ok(()) }
    }
}

/// A servo's fault, encoded in [`Loss::Device`](crate::Loss::Device).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ServoFault {
    pub id: u8,
    pub error: HardwareError,
}

impl ServoFault {
    /// Returns the code: the id above the error bits.
    pub const fn code(self) -> u32 {
        (self.id as u32) << 8 | self.error.0 as u32
    }

    /// Decodes such a code.
    pub const fn of_code(code: u32) -> Self {
        Self { id: (code >> 8) as u8, error: HardwareError(code as u8) }
    }
}

impl std::fmt::Display for ServoFault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "servo {}: {}", self.id, self.error)
    }
}
