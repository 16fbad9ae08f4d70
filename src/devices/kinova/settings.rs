use nima_core::kinematics::{ArmModel, JointLimits};
use serde::{Deserialize, Serialize};

use super::limits::TWIST_MAX;
use crate::DeviceError;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct KinovaSettings {
    /// Network address or host name.
    pub host: String,
    /// TCP port for calls.
    pub tcp_port: u16,
    /// UDP port for the cycle.
    pub udp_port: u16,
    /// Required serial number; any number if omitted. With it, swapped cables of two arms are detected.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub serial_number: Option<String>,
    pub user: String,
    pub password: String,
    /// Fraction of the arm's joint speeds that commands may use, above 0 to 1.
    pub speed_fraction: f64,
    /// Maximum lead of a commanded angle over the measured one, rad, above 0 to 0.2.
    pub lead_rad: f64,
    /// Maximum linear twist, m/s, up to 0.5.
    pub twist_m_s: f64,
    /// Maximum angular twist, rad/s, up to 1.74.
    pub twist_rad_s: f64,
    /// Time limit for an answer while opening, s, 0.05 to 30.
    pub timeout_s: f64,
}

impl Default for KinovaSettings {
    fn default() -> Self {
        Self {
            // Without the factory's address: a rig or a test must not reach an arm that is not in its settings.
            host: String::new(),
            tcp_port: 10_000,
            udp_port: 10_001,
            serial_number: None,
            user: "admin".to_owned(),
            password: "admin".to_owned(),
            speed_fraction: 0.5,
            lead_rad: 0.05,
            twist_m_s: 0.1,
            twist_rad_s: 0.5,
            timeout_s: 2.0,
        }
    }
}

impl KinovaSettings {
    /// Creates settings for an endpoint `HOST tcp=PORT udp=PORT`, the format in which an emulator prints it.
    ///
    /// ```
    /// use nima_devices::kinova::KinovaSettings;
    ///
    /// let settings = KinovaSettings::at("127.0.0.1 tcp=10000 udp=10001").expect("a complete endpoint");
    /// assert_eq!((settings.host.as_str(), settings.tcp_port, settings.udp_port), ("127.0.0.1", 10_000, 10_001));
    /// assert!(settings.check().is_ok());
    /// assert!(KinovaSettings::at("127.0.0.1 tcp=many").is_none(), "not a port");
    /// ```
    pub fn at(endpoint: &str) -> Option<Self> {
        let mut words = endpoint.split_whitespace();
        let host = words.next()?.to_owned();
        let mut settings = Self { host, ..Self::default() };
        for word in words {
            match word.split_once('=')? {
                ("tcp", port) => settings.tcp_port = port.parse().ok()?,
                ("udp", port) => settings.udp_port = port.parse().ok()?,
                _ => return None,
            }
        }
        Some(settings)
    }

    /// Returns the limits of position, speed and acceleration: the planner keeps to them, the driver checks them.
    pub fn joint_limits(&self, model: &ArmModel) -> JointLimits {
        JointLimits::of_arm(model, self.speed_fraction, self.lead_rad)
    }

    /// Checks every value.
    ///
    /// # Errors
    /// [`DeviceError::Setting`] for the first value outside its range.
    pub fn check(&self) -> Result<(), DeviceError> {
        let within = |key: &str, value: f64, low: f64, high: f64| {
            if value > low && value <= high {
                return Ok(());
            }
            let allowed = format!("above {low} and at most {high}");
            Err(DeviceError::Setting { key: key.to_owned(), value: value.to_string(), allowed })
        };
        if self.host.trim().is_empty() {
            let allowed = "the arm's address or host name; a Gen3 leaves the factory with 192.168.1.10";
            return Err(DeviceError::Setting {
                key: "host".to_owned(),
                value: "\"\"".to_owned(),
                allowed: allowed.to_owned(),
            });
        }
        within("speed_fraction", self.speed_fraction, 0.0, 1.0)?;
        within("lead_rad", self.lead_rad, 0.0, 0.2)?;
        within("twist_m_s", self.twist_m_s, 0.0, TWIST_MAX.0)?;
        within("twist_rad_s", self.twist_rad_s, 0.0, TWIST_MAX.1)?;
        within("timeout_s", self.timeout_s, 0.05, 30.0)
    }
}
