//! The active configuration of a sensor, from its page `netftapi2.xml`: counts, units, rate, identity.

use std::{
    io::{Read as _, Write as _},
    net::{TcpStream, ToSocketAddrs as _},
    time::{Duration, Instant},
};

use super::AtiSettings;
use crate::{DeviceError, DeviceIdentity, transport::check_no_example};

// For the connection, and for the whole page.
const TIMEOUT: Duration = Duration::from_secs(2);
/// Maximum length of the page, bytes; real ones have about 10 kB.
const PAGE_MAX: u64 = 256 << 10;
const PAGE: &str = "netftapi2.xml";
/// Units of force that a sensor can be set to, with the number of newtons.
const FORCES: [(&str, f64); 7] = [
    ("N", 1.0),
    ("kN", 1000.0),
    ("lbf", 4.448_221_6),
    ("klbf", 4_448.221_6),
    ("kgf", 9.806_65),
    ("kg", 9.806_65),
    ("gf", 9.806_65e-3),
];
/// Units of torque, with the number of newton metres.
const TORQUES: [(&str, f64); 9] = [
    ("N-m", 1.0),
    ("Nm", 1.0),
    ("N-mm", 1e-3),
    ("kN-m", 1000.0),
    ("lbf-in", 0.112_984_83),
    ("in-lbf", 0.112_984_83),
    ("lbf-ft", 1.355_817_9),
    ("ft-lbf", 1.355_817_9),
    ("kgf-cm", 0.098_066_5),
];

#[derive(Clone, Debug, PartialEq)]
pub struct AtiConfiguration {
    pub identity: DeviceIdentity,
    /// Counts per newton, and per newton metre.
    pub counts: [f64; 2],
    /// Rate of the records, Hz; `None` if the page does not contain it.
    pub rate_hz: Option<f64>,
}

impl AtiConfiguration {
    /// Reads the page; may take some seconds.
    ///
    /// # Errors
    /// [`DeviceError`] if the page cannot be read, or the sensor's configuration cannot be used.
    pub fn fetch(settings: &AtiSettings) -> Result<Self, DeviceError> {
        let place = format!("{}:{}", settings.host, settings.http_port);
        let page = page(&place)?;
        Self::of_page(&place, &page)
    }

    /// Parses the page.
    ///
    /// # Errors
    /// [`DeviceError`] if it is not such a page, or names a unit that is not known.
    pub fn of_page(place: &str, page: &str) -> Result<Self, DeviceError> {
        let number = |name: &str| value(page, name)?.parse::<f64>().ok().filter(|number| number.is_finite());
        let count = |name: &str| number(name).filter(|counts| *counts > 0.0);
        let (Some(per_force), Some(per_torque)) = (count("cfgcpf"), count("cfgcpt")) else {
            return Err(DeviceError::WrongProduct {
                place: place.to_owned(),
                expected: "Net F/T sensor".to_owned(),
                found: format!("device without counts per force in {PAGE}"),
            });
        };
        if value(page, "comrdte").is_some_and(|enabled| !enabled.eq_ignore_ascii_case("enabled")) {
            return Err(DeviceError::NotReady {
                place: place.to_owned(),
                mode: "a mode without raw data transfer (RDT)".to_owned(),
                cure: "Enable the RDT interface on the sensor's communications page.".to_owned(),
            });
        }
        let newtons = factor(place, page, "scfgfu", &FORCES)?;
        let newton_metres = factor(place, page, "scfgtu", &TORQUES)?;
        let text = |name: &str| value(page, name).unwrap_or_default().to_owned();
        Ok(Self {
            identity: DeviceIdentity {
                product: text("prodname"),
                serial: text("setserial"),
                firmware: text("setfwver"),
            },
            counts: [per_force / newtons, per_torque / newton_metres],
            rate_hz: number("comrdtrate").filter(|rate_hz| *rate_hz > 0.0),
        })
    }
}

/// Returns how many newtons (newton metres) the sensor's unit has; N and Nm if the page names none.
fn factor(place: &str, page: &str, name: &str, known: &[(&str, f64)]) -> Result<f64, DeviceError> {
    let Some(unit) = value(page, name) else { return Ok(1.0) };
    let found = known.iter().find(|(known, _)| known.eq_ignore_ascii_case(unit));
    found.map(|(_, factor)| *factor).ok_or_else(|| DeviceError::NotReady {
        place: place.to_owned(),
        mode: format!("a mode with the unknown unit \"{}\"", nima_files::quoted(unit)),
        cure: "Set the units to N and N-m on the sensor's page of configurations.".to_owned(),
    })
}

/// Returns the text of the first element with this name.
fn value<'a>(page: &'a str, name: &str) -> Option<&'a str> {
    let (_, rest) = page.split_once(&format!("<{name}>"))?;
    rest.split_once(&format!("</{name}>")).map(|(value, _)| value.trim())
}

fn page(place: &str) -> Result<String, DeviceError> {
    check_no_example(place)?;
    let trouble = |error: std::io::Error| DeviceError::of_address(place, &error);
    let address = place.to_socket_addrs().map_err(trouble)?.next();
    let address = address.ok_or_else(|| DeviceError::Unreachable { place: place.to_owned() })?;
    let mut stream = TcpStream::connect_timeout(&address, TIMEOUT).map_err(trouble)?;
    // A pause of this length ends a page whose connection stays open.
    stream.set_read_timeout(Some(TIMEOUT / 4)).map_err(trouble)?;
    stream.set_write_timeout(Some(TIMEOUT)).map_err(trouble)?;
    stream.write_all(format!("GET /{PAGE} HTTP/1.0\r\nHost: {place}\r\n\r\n").as_bytes()).map_err(trouble)?;
    let begin = Instant::now();
    let mut received = Vec::new();
    let mut chunk = [0; 4096];
    // A sensor may keep the connection open, so the last element ends the page as well.
    while begin.elapsed() < TIMEOUT && received.len() as u64 <= PAGE_MAX {
        match stream.read(&mut chunk) {
            Ok(0) => break,
            Ok(count) => received.extend_from_slice(&chunk[..count]),
            Err(error) if matches!(error.kind(), std::io::ErrorKind::WouldBlock | std::io::ErrorKind::TimedOut) => {
                break;
            }
            Err(error) => return Err(trouble(error)),
        }
    }
    if received.is_empty() {
        return Err(DeviceError::Silent { place: place.to_owned() });
    }
    let text = String::from_utf8_lossy(&received);
    let status = text.split_whitespace().nth(1).unwrap_or_default();
    if status != "200" {
        return Err(DeviceError::WrongProduct {
            place: place.to_owned(),
            expected: "Net F/T sensor".to_owned(),
            found: format!("device without the page {PAGE}"),
        });
    }
    Ok(text.into_owned())
}
