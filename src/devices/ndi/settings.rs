//! What the rig file says of the tracker.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::{TRACKED_TOOLS, Trouble};

/// TCP port of the units with a network (reference 1.1).
pub const PORT: u16 = 8765;
/// Line speeds that carry a tracking reply of four tools within a frame's time or little more, bit/s.
const SPEEDS: [u32; 6] = [38_400, 57_600, 115_200, 230_400, 921_600, 1_228_739];

/// Which form of tracking replies to ask for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Replies {
    /// As the firmware can.
    #[default]
    Auto,
    /// `TX`.
    Text,
    /// `BX`.
    Binary,
}

/// Settings of the tracker in the rig file. Either `address` or `port` is given.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Settings {
    /// Host, or `host:port`, of a unit with a network; the port is 8765 where none is given.
    pub address: Option<String>,
    /// Serial port of another: its device file, or `COM3`.
    pub port: Option<String>,
    /// Speed of the serial line while tracking, bit/s; the line begins at 9600 whatever stands here.
    pub baud: u32,
    /// Tool definitions (`.rom` files) of the wireless tools, in the order in which they are reported.
    pub tools: Vec<PathBuf>,
    /// Also take tools that are plugged in, after the wireless ones.
    pub wired: bool,
    /// Form of the tracking replies.
    pub replies: Replies,
    /// Frames per second of the unit's frame counter, Hz, from which its time is told. 60 for Polaris, 40 for Aurora.
    pub frame_hz: f64,
}

impl Default for Settings {
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

fn refuse(key: &str, value: impl Into<String>, allowed: &str) -> Trouble {
    Trouble::Setting { key: key.to_owned(), value: value.into(), allowed: allowed.to_owned() }
}

impl Settings {
    /// Tells the first setting that is not possible.
    pub fn check(&self) -> Result<(), Trouble> {
        if self.address.is_some() == self.port.is_some() {
            let value = self.address.as_deref().unwrap_or("nothing");
            return Err(refuse("address", value, "either address (network) or port (serial line) is given"));
        }
        if !SPEEDS.contains(&self.baud) {
            return Err(refuse("baud", self.baud.to_string(), "38400, 57600, 115200, 230400, 921600 or 1228739"));
        }
        if self.tools.len() > TRACKED_TOOLS {
            return Err(refuse("tools", format!("{} tools", self.tools.len()), "there are at most four"));
        }
        if self.tools.is_empty() && !self.wired {
            return Err(refuse("tools", "[]", "at least one definition, or wired = true"));
        }
        if !(1.0..=2000.0).contains(&self.frame_hz) {
            return Err(refuse("frame_hz", self.frame_hz.to_string(), "1 to 2000 Hz"));
        }
        Ok(())
    }

    /// Where the unit is, with the port number where it has a network.
    pub fn place(&self) -> String {
        match (&self.address, &self.port) {
            (Some(address), _) if address.contains(':') => address.clone(),
            (Some(address), _) => format!("{address}:{PORT}"),
            (None, port) => port.clone().unwrap_or_default(),
        }
    }
}
