//! What is plugged in, and why what is configured does not work: each cause with its cure.
//!
//! [`Plugged::list`] looks without opening anything. [`diagnose`] tries devices, each on a thread of its own and all at once, within
//! [`TIMEOUT`]; the real-time thread has no part in it, and a device that a running console holds is [`Trouble::Busy`]. A driver takes part by
//! one line in [`KINDS`]: an open function in a [`DeviceProbe`].

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

use super::{Identity, Standing, Trouble};

pub use device_probe::{DeviceProbe, Speaks};
pub use kinds::{KINDS, ProbeKind, probe_named};
pub use network::TcpProbe;
pub use plugged::{HidNode, Plugged, SerialPort, UsbDevice, UsbIds};
pub use serial::{SerialProbe, frames};

/// Time for one device, and so for all.
pub const TIMEOUT: Duration = Duration::from_millis(900);

/// A device that answered.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Found {
    /// Who it says it is.
    pub identity: Identity,
    /// Connected, or lost again while it was listened to.
    pub standing: Standing,
    /// Readings while it was listened to.
    pub readings: u64,
    /// Their rate, Hz; `None` of what speaks only when something changes or when asked.
    pub rate_hz: Option<f64>,
    /// Readings that the device numbered and that never arrived.
    pub lost: u64,
    /// Frames refused by checksum, shape or content.
    pub damaged: u64,
    /// Time it takes to answer, s: from opening to the first reading, or a connection's way there and back.
    pub latency_s: Option<f64>,
}

/// Something that can be tried.
pub trait Probe: Send {
    /// What it tries, for the first column of a table.
    fn name(&self) -> &str;
    /// Time that it needs beyond the usual one.
    fn extra(&self) -> Duration {
        Duration::ZERO
    }
    /// Tries it, within `timeout` as well as it can.
    fn probe(&mut self, timeout: Duration) -> Result<Found, Trouble>;
}

/// What came of a try.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "state")]
#[expect(missing_docs, reason = "the names say it")]
pub enum Outcome {
    /// It answers.
    Connected(Found),
    /// It does not.
    Trouble {
        #[serde(flatten)]
        trouble: Trouble,
        cause: String,
        cure: String,
    },
}

impl From<Result<Found, Trouble>> for Outcome {
    fn from(result: Result<Found, Trouble>) -> Self {
        match result {
            Ok(found) => Self::Connected(found),
            Err(trouble) => Self::Trouble { cause: trouble.to_string(), cure: trouble.cure(), trouble },
        }
    }
}

/// One device that was tried.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the names say it")]
pub struct Diagnosis {
    pub name: String,
    /// How long it took, s.
    pub took_s: f64,
    #[serde(flatten)]
    pub outcome: Outcome,
}

/// Tries all, each on a thread of its own; gives them in the order asked. One that does not come back within `timeout`, and what it
/// needs beyond it, is told so and left to itself.
pub fn diagnose(probes: Vec<Box<dyn Probe>>, timeout: Duration) -> Vec<Diagnosis> {
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
                    mpsc::RecvTimeoutError::Disconnected => "trying it failed".to_owned(),
                };
                (Err(Trouble::Other { place: name.clone(), reason }), begin.elapsed())
            });
            Diagnosis { name, took_s: took.as_secs_f64(), outcome: result.into() }
        })
        .collect()
}

type Answer = (Result<Found, Trouble>, Duration);

fn start(mut probe: Box<dyn Probe>, timeout: Duration) -> (String, mpsc::Receiver<Answer>) {
    /// Kept back, so that what uses up its time still tells what it knows.
    const RESERVE: Duration = Duration::from_millis(100);
    let name = probe.name().to_owned();
    let (give, answer) = mpsc::sync_channel(1);
    let work = move || {
        let begin = Instant::now();
        let result = probe.probe(timeout.saturating_sub(RESERVE));
        // Put away first, so that who reads the answer finds the device free.
        drop(probe);
        give.send((result, begin.elapsed())).ok();
    };
    // Where no thread can be made, `give` is dropped, and the receiver tells.
    Builder::new().name(format!("probe {name}")).spawn(work).ok();
    (name, answer)
}
