use std::net::{IpAddr, SocketAddr};

use nima_core::kinematics::{ArmModel, JointLimits};
use serde::{Deserialize, Serialize};

use crate::DeviceError;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExternalKind {
    Handle,
    Arm,
    Sensor,
}

impl ExternalKind {
    pub const ALL: [Self; 3] = [Self::Handle, Self::Arm, Self::Sensor];

    pub(super) const fn code(self) -> u8 {
        match self {
            Self::Handle => 1,
            Self::Arm => 2,
            Self::Sensor => 3,
        }
    }

    /// Returns the name in messages, with its article.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Handle => "a handle",
            Self::Arm => "an arm",
            Self::Sensor => "a force sensor",
        }
    }

    /// Returns whether the device moves or exerts force, and therefore needs its own watchdog.
    pub(super) const fn is_driven(self) -> bool {
        matches!(self, Self::Handle | Self::Arm)
    }
}

/// Settings of an external device. Settings that its kind does not have must be omitted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, tag = "make", rename = "external")]
pub struct ExternalSettings {
    /// Local address and port for the device: a different one for each part.
    pub listen: SocketAddr,
    /// Address of the computer that runs the device's program; required if it is not this computer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<IpAddr>,
    /// Required serial number; any number if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub serial_number: Option<String>,
    /// Expected rate of the readings, Hz: 20 to 10000.
    #[serde(default = "ExternalSettings::usual_rate_hz")]
    pub rate_hz: f64,
    /// Time without a fresh reading after which the device is lost, ms: 2 to 20.
    #[serde(default = "ExternalSettings::usual_time_ms")]
    pub silence_ms: f64,
    /// Maximum age of a reading, given by the age of the newest command that its sender had received, ms: 2 to 20.
    #[serde(default = "ExternalSettings::usual_time_ms")]
    pub age_max_ms: f64,
    /// Handle and arm: maximum watchdog time of the device itself, ms: 2 to 100.
    #[serde(default = "ExternalSettings::usual_watchdog_ms")]
    pub watchdog_ms: f64,
    /// Handle: maximum force, N, above 0 to 40; 4 if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force_max_n: Option<f64>,
    /// Handle: maximum force of the gripper, N, 0 to 10; none if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gripper_max_n: Option<f64>,
    /// Arm: fraction of the arm's joint speeds that commands may use, above 0 to 1; 0.3 if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub speed_fraction: Option<f64>,
    /// Arm: maximum lead of a commanded angle over the measured one, rad, above 0 to 0.2; 0.05 if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lead_rad: Option<f64>,
    /// Sensor: whether it has an accelerometer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inertial: Option<bool>,
}

impl ExternalSettings {
    const fn usual_rate_hz() -> f64 {
        1000.0
    }

    const fn usual_time_ms() -> f64 {
        10.0
    }

    const fn usual_watchdog_ms() -> f64 {
        20.0
    }

    pub const fn at(listen: SocketAddr) -> Self {
        Self {
            listen,
            from: None,
            serial_number: None,
            rate_hz: Self::usual_rate_hz(),
            silence_ms: Self::usual_time_ms(),
            age_max_ms: Self::usual_time_ms(),
            watchdog_ms: Self::usual_watchdog_ms(),
            force_max_n: None,
            gripper_max_n: None,
            speed_fraction: None,
            lead_rad: None,
            inertial: None,
        }
    }

    /// Returns the maximum force on the hand and on the gripper, N.
    pub fn forces_max_n(&self) -> (f64, f64) {
        (self.force_max_n.unwrap_or(4.0), self.gripper_max_n.unwrap_or(0.0))
    }

    /// Returns the limits of an arm's joints: the planner keeps to them, the driver checks them.
    pub fn joint_limits(&self, model: &ArmModel) -> JointLimits {
        JointLimits::of_arm(model, self.speed_fraction.unwrap_or(0.3), self.lead_rad.unwrap_or(0.05))
    }

    pub fn is_inertial(&self) -> bool {
        self.inertial.unwrap_or(false)
    }

    pub fn place(&self) -> String {
        format!("UDP {}", self.listen)
    }

    /// Returns the only address from which datagrams are accepted.
    pub(super) fn peer(&self) -> IpAddr {
        self.from.unwrap_or_else(|| self.listen.ip())
    }

    /// Checks every value for a device of this kind.
    ///
    /// # Errors
    /// [`DeviceError::Setting`] for the first impossible value.
    pub fn check(&self, kind: ExternalKind) -> Result<(), DeviceError> {
        let refuse = |key: &str, value: String, allowed: &str| {
            Err(DeviceError::Setting { key: key.to_owned(), value, allowed: allowed.to_owned() })
        };
        let ip = self.listen.ip();
        let port = self.listen.port();
        if port == 0 || ip.is_unspecified() || ip.is_multicast() {
            let allowed = "one address of this computer and a port, such as 127.0.0.1:47200";
            return refuse("listen", self.listen.to_string(), allowed);
        }
        if !ip.is_loopback() && self.from.is_none_or(|from| from.is_unspecified() || from.is_multicast()) {
            let value = self.from.map_or_else(|| "not given".to_owned(), |from| from.to_string());
            return refuse("from", value, "the address of the computer on which the device's program runs");
        }
        if self.peer().is_ipv4() != ip.is_ipv4() || self.peer().is_loopback() != ip.is_loopback() {
            return refuse("from", self.peer().to_string(), "an address that can reach `listen`");
        }
        let of = |own: ExternalKind, value: Option<f64>| if kind == own { Ok(value) } else { Err(value.is_some()) };
        let ranges = [
            ("rate_hz", Ok(Some(self.rate_hz)), 20.0, 10_000.0, "20 to 10000 Hz"),
            ("silence_ms", Ok(Some(self.silence_ms)), 2.0, 20.0, "2 to 20 ms"),
            ("age_max_ms", Ok(Some(self.age_max_ms)), 2.0, 20.0, "2 to 20 ms"),
            ("watchdog_ms", Ok(Some(self.watchdog_ms)), 2.0, 100.0, "2 to 100 ms"),
            ("force_max_n", of(ExternalKind::Handle, self.force_max_n), f64::MIN_POSITIVE, 40.0, "above 0 to 40 N"),
            ("gripper_max_n", of(ExternalKind::Handle, self.gripper_max_n), 0.0, 10.0, "0 to 10 N"),
            ("speed_fraction", of(ExternalKind::Arm, self.speed_fraction), f64::MIN_POSITIVE, 1.0, "above 0 to 1"),
            ("lead_rad", of(ExternalKind::Arm, self.lead_rad), f64::MIN_POSITIVE, 0.2, "above 0 to 0.2 rad"),
        ];
        for (key, value, low, high, allowed) in ranges {
            match value {
                Ok(Some(value)) if !(low..=high).contains(&value) => return refuse(key, value.to_string(), allowed),
                Err(true) => return refuse(key, "given".to_owned(), &format!("omit it: {} has none", kind.word())),
                _ => {}
            }
        }
        if self.inertial.is_some() && kind != ExternalKind::Sensor {
            return refuse("inertial", "given".to_owned(), &format!("omit it: {} has none", kind.word()));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn here() -> ExternalSettings {
        ExternalSettings::at(([127, 0, 0, 1], 47_200).into())
    }

    #[test]
    fn a_rig_file_is_read_and_written_and_strange_keys_are_refused() {
        let read: ExternalSettings = toml::from_str("listen = \"127.0.0.1:47200\"\nforce_max_n = 3.0\n").unwrap();
        assert_eq!(read, ExternalSettings { force_max_n: Some(3.0), ..here() });
        let written = toml::to_string(&read).unwrap();
        assert!(written.contains("make = \"external\""), "{written}");
        assert!(toml::from_str::<ExternalSettings>("listen = \"127.0.0.1:47200\"\nforce = 3.0\n").is_err());
        assert!(toml::from_str::<ExternalSettings>("listen = \"localhost\"\n").is_err());
    }

    #[test]
    fn what_is_impossible_is_told_by_its_key() {
        let address = |text: &str| text.parse::<SocketAddr>().unwrap();
        let elsewhere =
            ExternalSettings { listen: address("192.168.1.2:47200"), from: Some([192, 168, 1, 3].into()), ..here() };
        for kind in ExternalKind::ALL {
            assert_eq!(here().check(kind), Ok(()));
            assert_eq!(elsewhere.check(kind), Ok(()));
        }
        let handle = ExternalKind::Handle;
        let bad = [
            ("listen", handle, ExternalSettings { listen: address("127.0.0.1:0"), ..here() }),
            ("listen", handle, ExternalSettings { listen: address("0.0.0.0:47200"), ..here() }),
            ("from", handle, ExternalSettings { from: None, ..elsewhere.clone() }),
            ("from", handle, ExternalSettings { from: Some([127, 0, 0, 1].into()), ..elsewhere.clone() }),
            ("from", handle, ExternalSettings { from: Some([192, 168, 1, 3].into()), ..here() }),
            ("rate_hz", handle, ExternalSettings { rate_hz: f64::NAN, ..here() }),
            ("silence_ms", handle, ExternalSettings { silence_ms: 50.0, ..here() }),
            ("age_max_ms", handle, ExternalSettings { age_max_ms: 0.0, ..here() }),
            ("watchdog_ms", handle, ExternalSettings { watchdog_ms: 500.0, ..here() }),
            ("force_max_n", handle, ExternalSettings { force_max_n: Some(0.0), ..here() }),
            ("force_max_n", ExternalKind::Arm, ExternalSettings { force_max_n: Some(1.0), ..here() }),
            ("gripper_max_n", handle, ExternalSettings { gripper_max_n: Some(-1.0), ..here() }),
            ("speed_fraction", ExternalKind::Arm, ExternalSettings { speed_fraction: Some(1.5), ..here() }),
            ("lead_rad", ExternalKind::Sensor, ExternalSettings { lead_rad: Some(0.05), ..here() }),
            ("inertial", handle, ExternalSettings { inertial: Some(true), ..here() }),
        ];
        for (key, kind, settings) in bad {
            match settings.check(kind) {
                Err(DeviceError::Setting { key: report, .. }) => assert_eq!(report, key, "{settings:?}"),
                other => panic!("{key}: {other:?}"),
            }
        }
    }
}
