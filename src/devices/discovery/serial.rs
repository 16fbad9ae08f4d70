//! Tests a serial port without knowing its device: permissions, use by other programs, silence, line speed.

use std::{
    path::Path,
    str::FromStr,
    time::{Duration, Instant},
};

use super::{FoundDevice, Probe, plugged::UsbIds, rules};
use crate::{
    ConnectionState, DeviceError, DeviceIdentity,
    transport::{ByteStream as _, Serial, SerialSettings},
};

/// A probe of a port. Its text form is `PORT@BAUD[,HEADER][,quiet]`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SerialProbe {
    settings: SerialSettings,
    /// First bytes of every frame; empty if unknown. Without them a wrong line speed can be detected only by the port's
    /// count of framing errors, which pseudo-terminals and native USB ports do not have.
    header: Vec<u8>,
    /// Whether the device sends only answers, so that silence is normal.
    quiet: bool,
}

/// Listening time, unless the timeout is shorter.
const LISTEN: Duration = Duration::from_millis(400);
// A probe listens for a fraction of a second, so 2 ms do not delay it.
const NAP: Duration = Duration::from_millis(2);
/// Longest frame length for which headers are searched: more than eight times the longest frame of the devices here (61
/// bytes), because unknown devices are examined, too.
const PERIOD_MAX: usize = 512;
/// Number of headers at a constant distance that cannot be a coincidence: even a header of one byte repeats five times
/// by chance only once in 2^40.
const REPEATS: usize = 6;
/// Number of bytes after which a missing header means a wrong line speed: longer than the longest frame of the devices
/// here (61 bytes), so that a correct line has shown a header.
const ENOUGH: usize = 64;

impl FromStr for SerialProbe {
    type Err = DeviceError;

    fn from_str(text: &str) -> Result<Self, DeviceError> {
        let wrong = || DeviceError::Setting {
            key: "serial".to_owned(),
            value: text.to_owned(),
            allowed: "PORT@BAUD[,HEADER as hexadecimal digits][,quiet]".to_owned(),
        };
        let mut parts = text.split(',');
        let (port, baud) = parts.next().and_then(|line| line.rsplit_once('@')).ok_or_else(wrong)?;
        let baud = baud.parse().ok().filter(|baud| *baud > 0).ok_or_else(wrong)?;
        let settings = SerialSettings { port: port.to_owned(), baud };
        let mut probe = Self { settings, header: Vec::new(), quiet: false };
        for part in parts {
            match part {
                "quiet" => probe.quiet = true,
                digits => probe.header = bytes_of(digits).ok_or_else(wrong)?,
            }
        }
        Ok(probe)
    }
}

fn bytes_of(digits: &str) -> Option<Vec<u8>> {
    if digits.is_empty() || !digits.len().is_multiple_of(2) || !digits.is_ascii() {
        return None;
    }
    (0..digits.len()).step_by(2).map(|i| u8::from_str_radix(&digits[i..i + 2], 16).ok()).collect()
}

/// Returns the number of frames that begin with `header` at a constant distance; `None` if there are too few to be
/// certain.
pub fn frames(bytes: &[u8], header: &[u8]) -> Option<usize> {
    let first = bytes.windows(header.len()).take(PERIOD_MAX).position(|window| window == header)?;
    // The first match may be a coincidence inside a frame; then the next one is tried.
    let starts = (first..bytes.len().min(first + PERIOD_MAX)).filter(|&start| bytes[start..].starts_with(header));
    let regular = |start: usize, period: usize| {
        let mut count = (start..bytes.len().saturating_sub(header.len() - 1)).step_by(period);
        let total = count.len();
        (total >= REPEATS && count.all(|at| bytes[at..].starts_with(header))).then_some(total)
    };
    starts.take(8).find_map(|start| (header.len() + 1..=PERIOD_MAX).find_map(|period| regular(start, period)))
}

impl Probe for SerialProbe {
    fn name(&self) -> &str {
        &self.settings.port
    }

    fn probe(&mut self, timeout: Duration) -> Result<FoundDevice, DeviceError> {
        let SerialSettings { port, baud } = &self.settings;
        let ids = UsbIds::of_port(Path::new("/sys"), Path::new(port));
        let begin = Instant::now();
        let mut line = Serial::open(&self.settings).map_err(|trouble| exact(trouble, ids.as_ref()))?;
        let errors_before = line.line_errors();
        let end = Instant::now() + LISTEN.min(timeout.saturating_sub(begin.elapsed()));
        let mut received = Vec::new();
        let mut first_s = None;
        let mut buffer = [0; 4096];
        while Instant::now() < end {
            match line.receive(&mut buffer) {
                Ok(0) => std::thread::sleep(NAP),
                Ok(count) => {
                    first_s.get_or_insert(begin.elapsed().as_secs_f64());
                    received.extend_from_slice(&buffer[..count]);
                }
                Err(_) => return Err(DeviceError::Absent { place: port.clone() }),
            }
        }
        let place = port.clone();
        let wrong_baud = Err(DeviceError::WrongBaud { place: place.clone(), baud: *baud });
        // A break, or starting in the middle of a byte, causes one or two errors; a wrong baud rate causes errors
        // continuously.
        let errors = line.line_errors().zip(errors_before).map_or(0, |(now, before)| now.wrapping_sub(before));
        if errors as usize > 2 + received.len() / 50 {
            return wrong_baud;
        }
        if received.is_empty() && !self.quiet {
            return Err(DeviceError::Silent { place });
        }
        let framed = if self.header.is_empty() { None } else { frames(&received, &self.header) };
        if !self.header.is_empty() && framed.is_none() && received.len() >= ENOUGH {
            return wrong_baud;
        }
        let listened_s = begin.elapsed().as_secs_f64() - first_s.unwrap_or(0.0);
        let product = ids.map_or_else(|| "serial port".to_owned(), |ids| ids.words());
        Ok(FoundDevice {
            identity: DeviceIdentity { product, ..DeviceIdentity::default() },
            standing: ConnectionState::Connected,
            readings: framed.unwrap_or(0) as u64,
            rate_hz: framed.map(|count| count as f64 / listened_s),
            damaged: u64::from(errors),
            latency_s: first_s,
            ..FoundDevice::default()
        })
    }
}

/// Adds the udev rule for exactly this device, if its USB ids are known.
fn exact(trouble: DeviceError, ids: Option<&UsbIds>) -> DeviceError {
    match trouble {
        DeviceError::Permission { place, .. } => DeviceError::Permission { place, udev: rules::of_serial(ids) },
        other => other,
    }
}
