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

use super::{ConnectionState, DeviceError, DeviceIdentity};

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
    running
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
        .collect()
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
