//! Meaning of the SDK's numbers: errors, types of devices, the status array, causes of a switched-off force. No calls,
//! no clock.
//!
//! Source: headers of SDK 3.17.5 (`DHD_STATUS_*`, `DHD_ERROR_*`, `DHD_DEVICE_*`).

use serde::Serialize;

use crate::Loss;

/// An error of the SDK, by its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SdkError(pub i32);

impl SdkError {
    /// Error in the communication over USB.
    pub const COMMUNICATION: Self = Self(2);
    /// The operating system has no driver for the device.
    pub const NO_DRIVER: Self = Self(4);
    /// The device does not exist (any more).
    pub const NO_DEVICE: Self = Self(5);
    pub const TIMED_OUT: Self = Self(7);
    pub const REDUNDANT_ENCODER: Self = Self(18);
    pub const IN_USE: Self = Self(20);

    /// Returns the text of the SDK.
    pub const fn words(self) -> &'static str {
        match self.0 {
            0 => "no error",
            1 => "undocumented error",
            2 => "communication error",
            3 => "device controller busy",
            4 => "no driver found",
            5 => "no device found",
            6 => "operation not available",
            7 => "operation timed out",
            8 => "geometric error",
            9 => "expert mode disabled",
            10 => "feature not implemented",
            11 => "out of memory",
            12 => "device not ready",
            13 => "file not found",
            14 => "device configuration failed",
            15 => "index outside valid range",
            16 => "feature or device no longer supported",
            17 => "argument is null or invalid",
            18 => "redundant encoder integrity test failed",
            19 => "feature is not enabled",
            20 => "device is in use",
            21 => "invalid parameter",
            22 => "robotic regulation is not running",
            _ => "invalid error code",
        }
    }

    /// Returns whether the device only lacks this feature, which is not a fault.
    pub const fn is_missing_feature(self) -> bool {
        matches!(self.0, 6 | 10 | 16 | 19)
    }

    /// Returns the cause of the loss if calls continue to fail with this error.
    pub const fn loss(self) -> Loss {
        match self {
            Self::NO_DEVICE | Self::NO_DRIVER => Loss::Disconnected,
            Self::COMMUNICATION => Loss::Corrupt,
            Self::TIMED_OUT => Loss::Silent,
            Self(code) => Loss::Device { code: code.cast_unsigned() },
        }
    }

    /// Returns whether the error is permanent, so that the device is lost at once.
    pub const fn is_final(self) -> bool {
        matches!(self, Self::NO_DEVICE | Self::REDUNDANT_ENCODER)
    }
}

/// Additional information of a successful call (`DHD_TIMEGUARD`, `DHD_MOTOR_SATURATED`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Success {
    Plain,
    /// No newer data were available: the last data are repeated.
    TimeGuard,
    /// The force was reduced to the capability of the motors.
    Saturated,
}

impl Success {
    /// Decodes the return value of a call; `None` if it failed.
    pub const fn of(code: i32) -> Option<Self> {
        match code {
            0 | 3.. => Some(Self::Plain),
            1 => Some(Self::TimeGuard),
            2 => Some(Self::Saturated),
            _ => None,
        }
    }
}

/// A type of device (`DHD_DEVICE_*`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ForceDimensionKind {
    /// omega.7 for the right or the left hand.
    Omega7 { left_handed: bool },
    /// Any other device, which this driver does not support.
    Other(i32),
}

impl ForceDimensionKind {
    pub const fn of(number: i32) -> Self {
        match number {
            35 => Self::Omega7 { left_handed: false },
            37 => Self::Omega7 { left_handed: true },
            other => Self::Other(other),
        }
    }

    pub const fn number(self) -> i32 {
        match self {
            Self::Omega7 { left_handed: false } => 35,
            Self::Omega7 { left_handed: true } => 37,
            Self::Other(number) => number,
        }
    }

    pub fn name(self) -> String {
        match self {
            Self::Omega7 { left_handed } => format!("omega.7 ({} hand)", if left_handed { "left" } else { "right" }),
            Self::Other(33) => "omega.3".to_owned(),
            Self::Other(34 | 36) => "omega.6".to_owned(),
            Self::Other(60) => "Falcon".to_owned(),
            Self::Other(81 | 82) => "controller".to_owned(),
            Self::Other(104 | 105) => "sigma.7".to_owned(),
            Self::Other(108 | 109) => "lambda.7".to_owned(),
            Self::Other(number) => format!("device of type {number}"),
        }
    }
}

/// Reason why the device switched its force off by itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ForceOffCause {
    #[default]
    None,
    Button,
    Velocity,
    /// No force command arrived within the watchdog's time.
    Watchdog,
    /// Requested by a program.
    Software,
    /// Error on USB.
    Usb,
    DeadMan,
    /// A number that this program does not support.
    Unknown,
}

impl ForceOffCause {
    const fn of(number: i32) -> Self {
        match number {
            0 => Self::None,
            1 => Self::Button,
            2 => Self::Velocity,
            3 => Self::Watchdog,
            4 => Self::Software,
            5 => Self::Usb,
            6 => Self::DeadMan,
            _ => Self::Unknown,
        }
    }

    /// Returns whether the device switched the force off by itself, for a known cause.
    const fn is_by_the_device(self) -> bool {
        !matches!(self, Self::None | Self::Software | Self::Unknown)
    }

    /// Returns cause and remedy, for a screen.
    pub const fn words(self) -> &'static str {
        match self {
            Self::None => "the device reports no cause",
            Self::Button => "the force button on its base was pressed; press it again",
            Self::Velocity => "the hand was too fast; hold the handle and enable force again",
            Self::Watchdog => "no force command arrived in time; enable force again",
            Self::Software => "another program switched it off",
            Self::Usb => "its USB connection was disturbed; check the cable",
            Self::DeadMan => "the handle is not held; grip it",
            Self::Unknown => "for an unknown cause",
        }
    }
}

/// Length of the status array.
pub const ENTRIES: usize = 17;

/// [`Loss::Device`] codes from this number on are this number plus an index of the status array; lower ones are error
/// numbers of the SDK.
pub const STATUS_CODE: u32 = 100;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[expect(clippy::struct_excessive_bools, reason = "each is an entry of the device's own status")]
pub struct ForceDimensionStatus {
    pub power: bool,
    pub connected: bool,
    pub started: bool,
    /// The device must be calibrated: put the handle into its rest position.
    pub reset: bool,
    /// No current in the motors.
    pub idle: bool,
    pub force: bool,
    /// The brakes are on: the motors damp every motion.
    pub brake: bool,
    pub torque: bool,
    pub wrist: bool,
    pub error: bool,
    pub gravity: bool,
    pub time_guard: bool,
    pub wrist_ready: bool,
    /// Redundant encoders are monitored and agree.
    pub redundancy: bool,
    /// Cause of a switched-off force.
    pub force_off: ForceOffCause,
    /// The locks are closed (the value -1, unknown, counts as false).
    pub locks: bool,
    /// Whether the axes have been checked.
    pub axis_checked: bool,
}

impl ForceDimensionStatus {
    /// Decodes the array filled by `dhdGetStatus`.
    pub const fn decode(of: &[i32; ENTRIES]) -> Self {
        Self {
            power: of[0] != 0,
            connected: of[1] != 0,
            started: of[2] != 0,
            reset: of[3] != 0,
            idle: of[4] != 0,
            force: of[5] != 0,
            brake: of[6] != 0,
            torque: of[7] != 0,
            wrist: of[8] != 0,
            error: of[9] != 0,
            gravity: of[10] != 0,
            time_guard: of[11] != 0,
            wrist_ready: of[12] != 0,
            redundancy: of[13] != 0,
            force_off: ForceOffCause::of(of[14]),
            locks: of[15] == 1,
            axis_checked: of[16] != 0,
        }
    }

    /// Returns the cause of a loss according to the status. An error indicator while the device has switched its own
    /// force off refers to that event; the device still delivers data. (The cause keeps its last value when force is on
    /// again.)
    pub const fn loss(&self) -> Option<Loss> {
        if !self.connected {
            return Some(Loss::Disconnected);
        }
        let entry = match self {
            Self { power: false, .. } => 0,
            Self { reset: true, .. } => 3,
            Self { error: true, force, force_off, .. } if *force || !force_off.is_by_the_device() => 9,
            _ => return None,
        };
        Some(Loss::Device { code: STATUS_CODE + entry })
    }
}

/// Returns the meaning of a [`Loss::Device`] code of this driver.
pub fn fault_text(code: u32) -> &'static str {
    match code {
        STATUS_CODE => "the device has no power",
        103 => "the device waits for its calibration: put the handle into its rest position",
        109 => "its error indicator is on",
        _ => SdkError(code.cast_signed()).words(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_entry_of_the_status_array_is_decoded_at_its_place() {
        let at = |index: usize| {
            let mut entries = [0; ENTRIES];
            entries[index] = 1;
            ForceDimensionStatus::decode(&entries)
        };
        let flags: [fn(&ForceDimensionStatus) -> bool; ENTRIES] = [
            |s| s.power,
            |s| s.connected,
            |s| s.started,
            |s| s.reset,
            |s| s.idle,
            |s| s.force,
            |s| s.brake,
            |s| s.torque,
            |s| s.wrist,
            |s| s.error,
            |s| s.gravity,
            |s| s.time_guard,
            |s| s.wrist_ready,
            |s| s.redundancy,
            |s| s.force_off == ForceOffCause::Button,
            |s| s.locks,
            |s| s.axis_checked,
        ];
        for set in 0..ENTRIES {
            for (flag, read) in flags.iter().enumerate() {
                assert_eq!(read(&at(set)), flag == set, "entry {set}, flag {flag}");
            }
        }
    }

    #[test]
    fn causes_losses_and_codes_are_those_of_the_sdk() {
        use ForceOffCause as C;
        let causes = [C::None, C::Button, C::Velocity, C::Watchdog, C::Software, C::Usb, C::DeadMan, C::Unknown];
        for (number, cause) in (0..).zip(causes) {
            assert_eq!(ForceOffCause::of(number), cause);
        }
        assert_eq!(ForceOffCause::of(-1), C::Unknown);
        let good =
            ForceDimensionStatus { power: true, connected: true, started: true, ..ForceDimensionStatus::default() };
        assert_eq!(good.loss(), None);
        assert_eq!(ForceDimensionStatus { error: true, ..good }.loss(), Some(Loss::Device { code: 109 }));
        assert_eq!(ForceDimensionStatus { error: true, force_off: C::Velocity, ..good }.loss(), None);
        let on = ForceDimensionStatus { error: true, force: true, force_off: C::Velocity, ..good };
        assert_eq!(on.loss(), Some(Loss::Device { code: 109 }));
        assert_eq!(ForceDimensionStatus { reset: true, ..good }.loss(), Some(Loss::Device { code: 103 }));
        assert_eq!(ForceDimensionStatus { connected: false, ..good }.loss(), Some(Loss::Disconnected));
        assert_eq!(ForceDimensionStatus { power: false, ..good }.loss(), Some(Loss::Device { code: 100 }));
        assert_eq!(Success::of(-1), None);
        assert_eq!(
            [0, 1, 2].map(Success::of),
            [Some(Success::Plain), Some(Success::TimeGuard), Some(Success::Saturated)]
        );
        for number in -5..200 {
            assert_eq!(ForceDimensionKind::of(number).number(), number);
        }
        assert_eq!(SdkError(23).words(), "invalid error code");
        assert_eq!(fault_text(18), "redundant encoder integrity test failed");
    }
}
