use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::{DeviceError, TRACKED_TOOLS};

/// TCP port of units with a network connection (reference 1.1).
pub const PORT: u16 = 8765;
/// Line speeds at which a tracking reply with four tools takes about the time of a frame or less, bit/s.
const SPEEDS: [u32; 6] = [38_400, 57_600, 115_200, 230_400, 921_600, 1_228_739];

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Replies {
    #[default]
    Auto,
    Text,
    Binary,
}

/// Settings of the tracker in a rig file. Exactly one of `address` and `port` must be given.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct NdiSettings {
    /// Network address: host, or `host:port`; the default port is 8765.
    pub address: Option<String>,
    /// Serial port: device file, or `COM3`.
    pub port: Option<String>,
    /// Line speed while tracking, bit/s; the session always starts at 9600.
    pub baud: u32,
    /// Tool definitions (`.rom` files) of the wireless tools, in the order in which they are reported.
    pub tools: Vec<PathBuf>,
    /// Whether to use plugged-in tools as well, listed after the wireless ones.
    pub wired: bool,
    pub replies: Replies,
    /// Rate of the unit's frame counter, Hz, which determines its time. 60 for Polaris, 40 for Aurora.
    pub frame_hz: f64,
}

impl Default for NdiSettings {
    fn default() -> Self {
        Self {
            address: None,
            port: None,
            baud: 115_200,
            tools: Vec::new(),
            wired: false,
            replies: Replies::Auto,
            frame_hz: 60.0,
        }
    }
}

fn refuse(key: &str, value: impl Into<String>, allowed: &str) -> DeviceError {
    DeviceError::Setting { key: key.to_owned(), value: value.into(), allowed: allowed.to_owned() }
}

impl NdiSettings {
    /// Checks every setting.
    ///
    /// # Errors
    /// [`DeviceError::Setting`] for the first invalid setting.
    pub fn check(&self) -> Result<(), DeviceError> {
        if self.address.is_some() == self.port.is_some() {
            let value = self.address.as_deref().unwrap_or("nothing");
            return Err(refuse("address", value, "either address (network) or port (serial line)"));
        }
        if !SPEEDS.contains(&self.baud) {
            return Err(refuse("baud", self.baud.to_string(), "38400, 57600, 115200, 230400, 921600 or 1228739"));
        }
        if self.tools.len() > TRACKED_TOOLS {
            return Err(refuse("tools", format!("{} tools", self.tools.len()), "at most four"));
        }
        let double = |k: &usize| self.tools[..*k].contains(&self.tools[*k]);
        if let Some(k) = (1..self.tools.len()).find(double) {
            let allowed =
                "a different definition for each tool: the unit cannot distinguish two tools with one definition";
            return Err(refuse(&format!("tools[{k}]"), self.tools[k].display().to_string(), allowed));
        }
        if self.tools.is_empty() && !self.wired {
            return Err(refuse("tools", "[]", "at least one definition, or wired = true"));
        }
        if !(1.0..=2000.0).contains(&self.frame_hz) {
            return Err(refuse("frame_hz", self.frame_hz.to_string(), "1 to 2000 Hz"));
        }
        Ok(())
    }

    /// Returns the address, with the port number for a network connection, or the serial port.
    pub fn place(&self) -> String {
        match (&self.address, &self.port) {
            (Some(address), _) if address.contains(':') => address.clone(),
            (Some(address), _) => format!("{address}:{PORT}"),
            (None, port) => port.clone().unwrap_or_default(),
        }
    }
}
