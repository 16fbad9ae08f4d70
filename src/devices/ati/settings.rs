use serde::{Deserialize, Serialize};

use super::codec::PORT;
use crate::DeviceError;

/// Settings of a sensor in a rig file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, tag = "make", rename = "ati")]
pub struct AtiSettings {
    /// Network address or host name.
    pub host: String,
    /// UDP port of the records.
    #[serde(default = "AtiSettings::usual_rdt_port")]
    pub rdt_port: u16,
    /// TCP port of its web pages.
    #[serde(default = "AtiSettings::usual_http_port")]
    pub http_port: u16,
    /// Expected rate of the records, Hz: 20 to 8000; the sensor's own setting is used if it can be read.
    #[serde(default = "AtiSettings::usual_rate_hz")]
    pub rate_hz: f64,
    /// Counts per newton. With `counts_per_nm` the sensor's web pages are not read; it is then unknown which sensor it
    /// is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub counts_per_n: Option<f64>,
    /// Counts per newton metre.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub counts_per_nm: Option<f64>,
    /// Required serial number; any number if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub serial_number: Option<String>,
}

impl AtiSettings {
    const fn usual_rdt_port() -> u16 {
        PORT
    }

    const fn usual_http_port() -> u16 {
        80
    }

    const fn usual_rate_hz() -> f64 {
        1000.0
    }

    /// Creates settings for an endpoint `HOST rdt=PORT http=PORT`, the format in which an emulator prints it.
    pub fn at(endpoint: &str) -> Option<Self> {
        let mut words = endpoint.split_whitespace();
        let mut settings = Self {
            host: words.next()?.to_owned(),
            rdt_port: Self::usual_rdt_port(),
            http_port: Self::usual_http_port(),
            rate_hz: Self::usual_rate_hz(),
            counts_per_n: None,
            counts_per_nm: None,
            serial_number: None,
        };
        for word in words {
            match word.split_once('=')? {
                ("rdt", port) => settings.rdt_port = port.parse().ok()?,
                ("http", port) => settings.http_port = port.parse().ok()?,
                _ => return None,
            }
        }
        Some(settings)
    }

    /// Returns the address of the records, for messages.
    pub fn place(&self) -> String {
        format!("{}:{}", self.host, self.rdt_port)
    }

    /// Returns counts per newton and per newton metre, if the rig file gives both.
    pub(super) fn counts(&self) -> Option<[f64; 2]> {
        Some([self.counts_per_n?, self.counts_per_nm?])
    }

    /// Checks every value.
    ///
    /// # Errors
    /// [`DeviceError::Setting`] for the first invalid value.
    pub fn check(&self) -> Result<(), DeviceError> {
        let refuse = |key: &str, value: String, allowed: &str| {
            Err(DeviceError::Setting { key: key.to_owned(), value, allowed: allowed.to_owned() })
        };
        if self.host.trim().is_empty() {
            let allowed = "the sensor's address or host name; it leaves the factory with 192.168.1.1";
            return refuse("host", "\"\"".to_owned(), allowed);
        }
        if !(20.0..=8000.0).contains(&self.rate_hz) {
            return refuse("rate_hz", self.rate_hz.to_string(), "20 to 8000 Hz");
        }
        for (key, counts) in [("counts_per_n", self.counts_per_n), ("counts_per_nm", self.counts_per_nm)] {
            if let Some(counts) = counts.filter(|counts| !(1.0..=1e9).contains(counts)) {
                return refuse(key, counts.to_string(), "1 to 1e9, as on the sensor's page of configurations");
            }
        }
        if self.counts_per_n.is_some() != self.counts_per_nm.is_some() {
            let allowed = "both counts_per_n and counts_per_nm, or neither";
            return refuse("counts_per_nm", "given alone".to_owned(), allowed);
        }
        if self.counts_per_n.is_some() && self.serial_number.is_some() {
            let allowed = "omitted with counts_per_n: the serial number is on the web pages, which are then not read";
            return refuse("serial_number", self.serial_number.clone().unwrap_or_default(), allowed);
        }
        Ok(())
    }
}
