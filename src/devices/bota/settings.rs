//! Settings of a sensor in a rig file, checked before anything is opened.

use serde::{Deserialize, Serialize};

use super::{codec, gen_a, gen0};
use crate::DeviceError;

/// Generation of the sensor and type of its connection.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Transport {
    /// First generation on a serial line: force and torque only.
    #[serde(rename = "gen0")]
    Gen0,
    /// Second generation (A) on a serial line, or as a serial device on USB.
    GenA,
    /// Second generation (A) in a network: commands over TCP, readings over UDP.
    Socket,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BotaSettings {
    /// `"gen0"`, `"gen-a"` (serial) or `"socket"`.
    pub transport: Transport,
    /// Device file of the line (`/dev/ttyUSB0`, `COM3`); for a socket the sensor's address, with `:port` if that is not
    /// 23.
    pub port: String,
    /// Speed of a serial line, bit/s.
    #[serde(default = "baud")]
    pub baud: u32,
    /// First generation: number of samples averaged into a reading, 64 to 2047. The rate is 51200 Hz / sinc; a larger
    /// number gives a lower rate and less noise.
    #[serde(default = "sinc")]
    pub sinc: u16,
    /// Second generation: frame format; 0 and 1 force and torque, 2 and 3 with the inertial unit.
    #[serde(default = "mode")]
    pub mode: u8,
    /// Second generation: rate, Hz, as supported by the sensor (10 20 25 50 100 200 250 270 400 500 800 1000 1600 2133
    /// 3200 3840).
    #[serde(default = "rate")]
    pub rate_hz: u32,
    /// Required serial number (`853` and `SN000853` are equal); any number if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub serial_number: Option<String>,
}

const fn baud() -> u32 {
    460_800
}

const fn sinc() -> u16 {
    64
}

const fn mode() -> u8 {
    gen_a::MODE_INERTIAL
}

const fn rate() -> u32 {
    500
}

/// Bits on the line per byte: start, eight data bits, stop.
const BITS_PER_BYTE: f64 = 10.0;

impl BotaSettings {
    /// Creates default settings except for these two.
    pub fn new(transport: Transport, port: impl Into<String>) -> Self {
        let port = port.into();
        Self { transport, port, baud: baud(), sinc: sinc(), mode: mode(), rate_hz: rate(), serial_number: None }
    }

    /// Returns the expected rate of the readings with these settings, Hz.
    pub fn expected_hz(&self) -> f64 {
        match self.transport {
            Transport::Gen0 => gen0::rate_hz(self.sinc),
            Transport::GenA | Transport::Socket => f64::from(self.rate_hz),
        }
    }

    pub const fn is_inertial(&self) -> bool {
        !matches!(self.transport, Transport::Gen0) && self.mode >= gen_a::MODE_INERTIAL
    }

    /// Returns the submode for the configured rate.
    pub(super) fn submode(&self) -> Option<u32> {
        gen_a::RATES_HZ.iter().position(|rate_hz| *rate_hz == self.rate_hz).map(|place| place as u32)
    }

    /// Refuses settings that no sensor supports.
    ///
    /// # Errors
    /// [`DeviceError::Setting`] for the first invalid setting.
    pub fn check(&self) -> Result<(), DeviceError> {
        let refuse = |key: &str, value: String, allowed: &str| {
            Err(DeviceError::Setting { key: key.to_owned(), value, allowed: allowed.to_owned() })
        };
        if self.port.trim().is_empty() {
            return refuse("port", "\"\"".to_owned(), "the sensor's device file or address");
        }
        if self.transport == Transport::Gen0 {
            if !gen0::SINC.contains(&self.sinc) {
                return refuse("sinc", self.sinc.to_string(), "64 to 2047");
            }
            if !gen0::BAUDS.contains(&self.baud) {
                return refuse("baud", self.baud.to_string(), "9600, 57600, 115200, 230400, 460800 or 921600");
            }
        } else if self.mode > gen_a::MODE_MAX {
            return refuse("mode", self.mode.to_string(), "0 to 3");
        } else if self.submode().is_none() {
            return refuse("rate_hz", self.rate_hz.to_string(), &format!("one of {:?}", gen_a::RATES_HZ));
        }
        let fits_hz = self.line_hz();
        if self.expected_hz() > fits_hz {
            let (key, value) = match self.transport {
                Transport::Gen0 => ("sinc", self.sinc.to_string()),
                Transport::GenA | Transport::Socket => ("rate_hz", self.rate_hz.to_string()),
            };
            return refuse(key, value, &format!("{} baud can carry {fits_hz:.0} readings per second", self.baud));
        }
        Ok(())
    }

    /// Returns whether the sensor is a serial device on USB, which has no line speed.
    pub fn is_usb(&self) -> bool {
        self.transport == Transport::GenA && self.port.contains("ttyACM")
    }

    /// Returns the highest rate that the line speed allows, Hz; infinite for network and USB, which have no line speed.
    fn line_hz(&self) -> f64 {
        if self.is_usb() || self.transport == Transport::Socket {
            return f64::INFINITY;
        }
        let bytes = if self.is_inertial() { codec::INERTIAL_BYTES } else { codec::WRENCH_BYTES };
        f64::from(self.baud) / (BITS_PER_BYTE * bytes as f64)
    }

    /// Returns whether this is the required serial number, or none is required.
    pub(super) fn accepts_serial(&self, serial: &str) -> bool {
        self.serial_number.as_ref().is_none_or(|expected| digits_of(expected) == digits_of(serial))
    }
}

/// Returns the serial number without the prefix that some programs add.
fn digits_of(serial: &str) -> &str {
    let bare = serial.trim();
    bare.strip_prefix("SN").unwrap_or(bare).trim_start_matches('0')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rig_file_is_read_and_strange_keys_are_refused() {
        let text = "transport = \"gen-a\"\nport = \"/dev/ttyACM0\"\nrate_hz = 1000\nserial_number = \"SN000853\"\n";
        let settings: BotaSettings = toml::from_str(text).unwrap();
        let expected = BotaSettings {
            rate_hz: 1000,
            serial_number: Some("SN000853".to_owned()),
            ..BotaSettings::new(Transport::GenA, "/dev/ttyACM0")
        };
        assert_eq!(settings, expected);
        assert!(settings.accepts_serial("853") && !settings.accepts_serial("854") && !settings.accepts_serial(""));
        assert!(toml::from_str::<BotaSettings>(&format!("{text}colour = 1\n")).is_err());
        let written = toml::to_string(&settings).unwrap();
        assert_eq!(toml::from_str::<BotaSettings>(&written).unwrap(), settings);
        for (transport, name) in [(Transport::Gen0, "gen0"), (Transport::GenA, "gen-a"), (Transport::Socket, "socket")]
        {
            assert_eq!(serde_json::to_string(&transport).unwrap(), format!("\"{name}\""));
        }
    }

    #[test]
    fn impossible_settings_are_told_by_their_key() {
        let gen0 = BotaSettings::new(Transport::Gen0, "/dev/ttyUSB0");
        let gen_a = BotaSettings::new(Transport::GenA, "/dev/ttyUSB0");
        let usb = BotaSettings::new(Transport::GenA, "/dev/ttyACM0");
        let socket = BotaSettings::new(Transport::Socket, "192.168.0.100");
        for good in [&gen0, &gen_a, &usb, &socket, &BotaSettings { rate_hz: 3840, ..usb.clone() }] {
            assert_eq!(good.check(), Ok(()));
        }
        let bad = [
            ("port", BotaSettings { port: " ".to_owned(), ..gen0.clone() }),
            ("sinc", BotaSettings { sinc: 63, ..gen0.clone() }),
            ("sinc", BotaSettings { sinc: 2048, ..gen0.clone() }),
            ("sinc", BotaSettings { baud: 115_200, ..gen0.clone() }),
            ("baud", BotaSettings { baud: 1_000_000, ..gen0 }),
            ("mode", BotaSettings { mode: 4, ..gen_a.clone() }),
            ("rate_hz", BotaSettings { rate_hz: 300, ..socket }),
            ("rate_hz", BotaSettings { rate_hz: 800, ..gen_a }),
        ];
        for (key, settings) in bad {
            match settings.check() {
                Err(DeviceError::Setting { key: report, .. }) => assert_eq!(report, key, "{settings:?}"),
                other => panic!("{settings:?}: {other:?}"),
            }
        }
    }
}
