//! Settings of an omega.7.

use std::{net::SocketAddr, path::PathBuf};

use nima_core::{Side, limits};
use serde::{Deserialize, Serialize};

use crate::DeviceError;

/// Maximum force of an omega.7, N.
pub const FORCE_MAX_N: f64 = limits::OMEGA7_FORCE_N;
/// Maximum force of its gripper, N.
pub const GRIPPER_MAX_N: f64 = limits::OMEGA7_GRIPPER_N;

/// Behaviour of the handle while no force is wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum IdleMode {
    /// The motors brake, so the handle stays in place.
    #[default]
    Brake,
    /// Without current: the handle moves freely and sinks under its weight.
    Free,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ForceDimensionSettings {
    /// File of the library. If omitted, the manufacturer's library is searched in the places where the SDK installs it;
    /// an emulated handle uses the replacement library within this program.
    pub library: Option<PathBuf>,
    /// Serial number of the device; any free device if omitted. Required if there are two devices.
    pub serial: Option<u16>,
    /// Hand for which the device must be built, as reported by the device. If omitted: the hand of its side on a rig
    /// with two handles, any hand on a rig with one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hand: Option<Side>,
    /// Rate of the readings, Hz: 100 to 2000.
    pub rate_hz: f64,
    /// Time without a force command after which the device switches its force off by itself, ms: 1 to 31.
    pub watchdog_ms: f64,
    /// Maximum force, N: up to 12.
    pub force_max_n: f64,
    /// Maximum force of the gripper, N: up to 8.
    pub gripper_max_n: f64,
    /// Whether the library compensates the handle's weight while force is on.
    pub gravity_compensation: bool,
    /// Whether the closed gripper counts as button 0.
    pub gripper_is_a_button: bool,
    pub idle: IdleMode,
    /// Address of an emulated handle; a real one has none.
    pub emulator: Option<SocketAddr>,
}

impl Default for ForceDimensionSettings {
    fn default() -> Self {
        Self {
            library: None,
            serial: None,
            hand: None,
            rate_hz: 1000.0,
            watchdog_ms: 20.0,
            force_max_n: FORCE_MAX_N,
            gripper_max_n: GRIPPER_MAX_N,
            gravity_compensation: true,
            gripper_is_a_button: true,
            idle: IdleMode::Brake,
            emulator: None,
        }
    }
}

impl ForceDimensionSettings {
    /// Checks every setting.
    ///
    /// # Errors
    /// [`DeviceError::Setting`] for the first value outside its range.
    pub fn check(&self) -> Result<(), DeviceError> {
        let ranges = [
            ("rate_hz", self.rate_hz, 100.0, 2000.0),
            ("watchdog_ms", self.watchdog_ms, 1.0, 31.0),
            ("force_max_n", self.force_max_n, 0.0, FORCE_MAX_N),
            ("gripper_max_n", self.gripper_max_n, 0.0, GRIPPER_MAX_N),
        ];
        match ranges.into_iter().find(|(_, value, min, max)| !(*min..=*max).contains(value)) {
            None => Ok(()),
            Some((key, value, min, max)) => Err(DeviceError::Setting {
                key: key.to_owned(),
                value: value.to_string(),
                allowed: format!("{min} to {max}"),
            }),
        }
    }

    /// Returns the watchdog's time in steps of 125 us.
    pub fn watchdog_steps(&self) -> u8 {
        (self.watchdog_ms / 0.125).round().clamp(1.0, 255.0) as u8
    }
}
