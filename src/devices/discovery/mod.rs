//! Finds out which devices are plugged in, and why a configured device does not work: each cause with its remedy.
//!
//! [`PluggedDevices::list`] opens no device. [`diagnose`] tests devices in parallel, each on its own thread, within
//! [`TIMEOUT`]. The real-time thread is not involved; a device in use by a running console gives [`DeviceError::Busy`]. A
//! new driver needs one line in [`KINDS`]: its open function in a [`DeviceProbe`].

mod bus;
mod device_probe;
mod kinds;
mod network;
mod plugged;
pub mod probes;
pub mod rules;
mod serial;

use std::{
    sync::mpsc,
    thread::Builder,
    time::{Duration, Instant},
};

use serde::Serialize;

use super::{ConnectionState, DeviceError, DeviceIdentity, dynamixel::IDS, same_serial};

pub use device_probe::{DataTiming, DeviceProbe};
pub use kinds::{KINDS, ProbeKind, probe_named};
pub use network::TcpProbe;
pub use plugged::{HidNode, PluggedDevices, SerialPort, UsbDevice, UsbIds};
pub use serial::{SerialProbe, frames};

/// Time limit of a diagnosis; all devices are tested at once.
pub const TIMEOUT: Duration = Duration::from_millis(900);

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FoundDevice {
    pub identity: DeviceIdentity,
    /// Connected, or lost again while listening.
    pub standing: ConnectionState,
    pub readings: u64,
    /// Rate of the readings, Hz; `None` for a device that sends only changes or answers.
    pub rate_hz: Option<f64>,
    /// Number of readings that never arrived, according to the device's numbering.
    pub lost: u64,
    /// Number of frames refused because of checksum, structure or content.
    pub damaged: u64,
    /// Response time, s: from opening to the first reading, or the round trip of a connection.
    pub latency_s: Option<f64>,
    /// Reason why a device that works sends no readings.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub note: Option<&'static str>,
}

pub trait Probe: Send {
    /// Returns the name of the test, for the first column of a table.
    fn name(&self) -> &str;
    /// Returns the time needed in addition to the usual limit.
    fn extra(&self) -> Duration {
        Duration::ZERO
    }
    /// Runs the test, within `timeout` as far as possible.
    ///
    /// # Errors
    /// [`DeviceError`] if the device does not work.
    fn probe(&mut self, timeout: Duration) -> Result<FoundDevice, DeviceError>;
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "state")]
pub enum TestOutcome {
    Connected(FoundDevice),
    Trouble {
        #[serde(flatten)]
        trouble: DeviceError,
        cause: String,
        cure: String,
    },
}

impl From<Result<FoundDevice, DeviceError>> for TestOutcome {
    fn from(result: Result<FoundDevice, DeviceError>) -> Self {
        match result {
            Ok(found) => Self::Connected(found),
            Err(trouble) => Self::Trouble { cause: trouble.to_string(), cure: trouble.cure(), trouble },
        }
    }
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DiscoveryDiagnosis {
    pub name: String,
    pub took_s: f64,
    #[serde(flatten)]
    pub outcome: TestOutcome,
}

/// Runs all tests, each on its own thread; returns the results in the given order. A test that does not finish within
/// `timeout` plus its additional time is reported as such, and its thread is left running.
pub fn diagnose(probes: Vec<Box<dyn Probe>>, timeout: Duration) -> Vec<DiscoveryDiagnosis> {
    let begin = Instant::now();
    let started = |probe: Box<dyn Probe>| {
        let timeout = timeout + probe.extra();
        (start(probe, timeout), timeout)
    };
    let running: Vec<_> = probes.into_iter().map(started).collect();
    let mut diagnoses: Vec<_> = running
        .into_iter()
        .map(|((name, answer), timeout)| {
            let answer = answer.recv_timeout((begin + timeout).saturating_duration_since(Instant::now()));
            let (result, took) = answer.unwrap_or_else(|error| {
                let reason = match error {
                    mpsc::RecvTimeoutError::Timeout => format!("no answer within {:.1} s", timeout.as_secs_f64()),
                    mpsc::RecvTimeoutError::Disconnected => "the test failed".to_owned(),
                };
                (Err(DeviceError::Other { place: name.clone(), reason }), begin.elapsed())
            });
            DiscoveryDiagnosis { name, took_s: took.as_secs_f64(), outcome: result.into() }
        })
        .collect();
    refuse_doubles(&mut diagnoses);
    diagnoses
}

/// Refuses two devices that report one serial number: two addresses lead to one device, and each would be mistaken for
/// the other.
fn refuse_doubles(diagnoses: &mut [DiscoveryDiagnosis]) {
    let is_one = |one: &DiscoveryDiagnosis, other: &DiscoveryDiagnosis| match (&one.outcome, &other.outcome) {
        // Servos identify themselves only by their ids, which may be the same on two lines.
        (TestOutcome::Connected(one), TestOutcome::Connected(other)) => {
            one.identity.product == other.identity.product
                && !one.identity.serial.starts_with(IDS)
                && same_serial(&one.identity.serial, &other.identity.serial)
        }
        _ => false,
    };
    let twin = |one: usize| {
        let found = diagnoses.iter().enumerate().find(|(k, other)| *k != one && is_one(&diagnoses[one], other))?;
        Some(found.1.name.clone())
    };
    let twins: Vec<_> = (0..diagnoses.len()).map(twin).collect();
    for (diagnosis, twin) in diagnoses.iter_mut().zip(twins) {
        if let (Some(other), TestOutcome::Connected(found)) = (twin, &diagnosis.outcome) {
            let serial = found.identity.serial.clone();
            diagnosis.outcome = Err(DeviceError::OneDevice { place: diagnosis.name.clone(), other, serial }).into();
        }
    }
}

type DiscoveryAnswer = (Result<FoundDevice, DeviceError>, Duration);

fn start(mut probe: Box<dyn Probe>, timeout: Duration) -> (String, mpsc::Receiver<DiscoveryAnswer>) {
    /// Subtracted from the time of each test, so that a test that uses up its time can still report its result.
    const RESERVE: Duration = Duration::from_millis(100);
    let name = probe.name().to_owned();
    let (give, answer) = mpsc::sync_channel(1);
    let work = move || {
        let begin = Instant::now();
        let result = probe.probe(timeout.saturating_sub(RESERVE));
        // Close the device before reporting, so that it is free when the result is read.
        drop(probe);
        give.send((result, begin.elapsed())).ok();
    };
    // If no thread can be created, `give` is dropped, and the receiver reports that.
    Builder::new().name(format!("probe {name}")).spawn(work).ok();
    (name, answer)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(name: &str, product: &str, serial: &str) -> DiscoveryDiagnosis {
        let identity =
            DeviceIdentity { product: product.to_owned(), serial: serial.to_owned(), firmware: String::new() };
        let found = FoundDevice { identity, standing: ConnectionState::Connected, ..FoundDevice::default() };
        DiscoveryDiagnosis { name: name.to_owned(), took_s: 0.0, outcome: TestOutcome::Connected(found) }
    }

    #[test]
    fn one_device_at_two_addresses_is_no_two_devices() {
        let mut tested = [
            found("right arm", "Gen3", "PJ1"),
            found("left arm", "Gen3", "PJ1"),
            found("right sensor", "SensONE", "PJ1"),
            found("right servos", "XM430", "ids 1 2 3 4"),
            found("left servos", "XM430", "ids 1 2 3 4"),
            found("right handle", "omega.7", ""),
            found("left handle", "omega.7", ""),
        ];
        refuse_doubles(&mut tested);
        let troubles: Vec<_> = tested
            .iter()
            .filter_map(|tested| match &tested.outcome {
                TestOutcome::Trouble { cause, .. } => Some(cause.as_str()),
                TestOutcome::Connected(_) => None,
            })
            .collect();
        let expected = [
            "right arm and left arm are one device: both report the serial number PJ1",
            "left arm and right arm are one device: both report the serial number PJ1",
        ];
        assert_eq!(troubles, expected);
    }
}
