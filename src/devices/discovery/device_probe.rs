//! Tests any driver: opens it like the console, listens, closes.

use std::time::{Duration, Instant};

use super::{FoundDevice, Probe};
use crate::{ConnectionState, Device, DeviceError, Health, Loss};

/// Conditions under which a device sends data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DataTiming {
    /// Sends continuously, at its own rate, so silence is a fault.
    Always,
    /// Only changes: silence is normal.
    OnChange,
    /// Answers always, but measures only with a tool.
    WithTool,
}

pub struct DeviceProbe<F> {
    name: String,
    place: String,
    speaks: DataTiming,
    extra: Duration,
    open: F,
}

/// Listening time, unless the timeout is shorter.
const LISTEN: Duration = Duration::from_millis(400);
// Half a period of a 1 kHz device, so that no reading waits for another.
const NAP: Duration = Duration::from_micros(500);

impl<F> DeviceProbe<F> {
    /// Creates a probe of the device that `open` opens at `place`.
    pub fn new(name: impl Into<String>, place: impl Into<String>, speaks: DataTiming, open: F) -> Self {
        Self { name: name.into(), place: place.into(), speaks, extra: Duration::ZERO, open }
    }

    /// Adds this much time to the usual limit, for example because the device restarts when it is opened.
    #[must_use]
    pub fn with_extra(self, extra: Duration) -> Self {
        Self { extra, ..self }
    }

    fn verdict(&self, health: &Health) -> Result<(), DeviceError> {
        let place = self.place.clone();
        let other = |reason: &str| Err(DeviceError::Other { place: self.place.clone(), reason: reason.to_owned() });
        match health.standing {
            ConnectionState::Lost(Loss::Disconnected) => Err(DeviceError::Absent { place }),
            // Readings count until the first of them is too old, which takes about as long as the loss of a device.
            ConnectionState::Lost(Loss::Silent) if 2 * health.out_of_order > health.readings => {
                Err(DeviceError::Late { place })
            }
            ConnectionState::Lost(Loss::Silent) => Err(DeviceError::Silent { place }),
            ConnectionState::Lost(loss @ (Loss::Corrupt | Loss::Implausible)) => other(loss.cause()),
            ConnectionState::Lost(Loss::Device { code }) => Err(DeviceError::DeviceFault {
                place,
                words: format!("code {code:#x}"),
                cure: "Look up the code in the device's manual, remove the cause, then switch the device off and on."
                    .to_owned(),
            }),
            // A driver reports a tracker that does not answer as lost.
            _ if self.speaks != DataTiming::Always || health.readings > 0 => Ok(()),
            _ if health.damaged > 0 => other(Loss::Corrupt.cause()),
            _ if health.refused > 0 => other(Loss::Implausible.cause()),
            _ => Err(DeviceError::Silent { place }),
        }
    }
}

impl<F, D> Probe for DeviceProbe<F>
where
    F: FnMut() -> Result<D, DeviceError> + Send,
    D: Device,
{
    fn name(&self) -> &str {
        &self.name
    }

    fn extra(&self) -> Duration {
        self.extra
    }

    fn probe(&mut self, timeout: Duration) -> Result<FoundDevice, DeviceError> {
        let begin = Instant::now();
        let mut device = (self.open)()?;
        let end = Instant::now() + LISTEN.min(timeout.saturating_sub(begin.elapsed()));
        let mut first = None;
        let mut last = None;
        while Instant::now() < end && !matches!(device.health().standing, ConnectionState::Lost(_)) {
            if device.poll(begin.elapsed().as_secs_f64()).is_some() {
                last = Some(Instant::now());
                first = first.or(last);
            }
            std::thread::sleep(NAP);
        }
        let health = *device.health();
        self.verdict(&health)?;
        let span_s = first.zip(last).map(|(first, last)| (last - first).as_secs_f64()).filter(|span_s| *span_s > 0.0);
        let rate = |span_s: f64| (health.readings.saturating_sub(1)) as f64 / span_s;
        Ok(FoundDevice {
            identity: device.identity().clone(),
            standing: health.standing,
            readings: health.readings,
            rate_hz: span_s.map(rate).filter(|_| self.speaks != DataTiming::OnChange),
            lost: health.lost,
            damaged: health.damaged + health.refused,
            latency_s: first.map(|first| (first - begin).as_secs_f64()),
            note: (self.speaks == DataTiming::WithTool && health.readings == 0).then_some("no tool is loaded"),
        })
    }
}
