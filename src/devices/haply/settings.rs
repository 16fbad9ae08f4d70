use serde::{Deserialize, Serialize};

use crate::DeviceError;

/// Maximum force that may be commanded to an Inverse3, N.
pub const FORCE_LIMIT_N: f64 = 10.0;
/// Centre of the workspace of an Inverse3 on its base, m from its origin (the manufacturer's example of position
/// control).
pub const CENTRE_M: [f64; 3] = [0.0186, -0.153, 0.151];
/// Maximum distance of the centre from the origin, m.
const CENTRE_MAX_M: f64 = 0.5;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, tag = "make", rename = "haply")]
pub struct HaplySettings {
    /// Device file.
    pub port: String,
    /// Required device id, four hexadecimal digits as printed by `nima devices`; any device if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub serial_number: Option<String>,
    /// Maximum force, N, above 0 to 10.
    #[serde(default = "HaplySettings::usual_force_max_n")]
    pub force_max_n: f64,
    /// Origin of the positions, m in the device's axes.
    #[serde(default = "HaplySettings::usual_centre_m")]
    pub centre_m: [f64; 3],
}

impl HaplySettings {
    const fn usual_force_max_n() -> f64 {
        4.0
    }

    const fn usual_centre_m() -> [f64; 3] {
        CENTRE_M
    }

    /// Returns the default settings at this port.
    pub fn at(port: impl Into<String>) -> Self {
        Self {
            port: port.into(),
            serial_number: None,
            force_max_n: Self::usual_force_max_n(),
            centre_m: Self::usual_centre_m(),
        }
    }

    /// Checks every value.
    ///
    /// # Errors
    /// [`DeviceError::Setting`] for the first value outside its range.
    pub fn check(&self) -> Result<(), DeviceError> {
        let refuse = |key: &str, value: String, allowed: &str| {
            Err(DeviceError::Setting { key: key.to_owned(), value, allowed: allowed.to_owned() })
        };
        if self.port.trim().is_empty() {
            return refuse("port", "\"\"".to_owned(), "the handle's device file");
        }
        if !(self.force_max_n > 0.0 && self.force_max_n <= FORCE_LIMIT_N) {
            return refuse("force_max_n", self.force_max_n.to_string(), "above 0 to 10 N");
        }
        if !self.centre_m.iter().all(|axis| axis.abs() <= CENTRE_MAX_M) {
            return refuse("centre_m", format!("{:?}", self.centre_m), "three lengths up to 0.5 m");
        }
        Ok(())
    }
}
