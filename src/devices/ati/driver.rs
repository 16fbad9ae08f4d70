//! The running sensor: requests records, checks them, and reports why readings are missing.

use std::time::{Duration, Instant};

use nalgebra::Vector3;
use nima_core::frames::Wrench;

use super::{
    AtiConfiguration, AtiSettings,
    codec::{RECORD_BYTES, RdtCommand, RdtRecord},
};
use crate::{
    ConnectionState, Device, DeviceError, DeviceIdentity, ForceReading, ForceStatus, Health, Loss, TimedReading,
    same_serial,
    transport::{TransportDatagrams, Udp},
};

/// The sensor is lost if nothing usable has arrived for this time, s, or for five periods: the limits of the other
/// sensors.
const SILENCE_S: f64 = 0.018;
const SILENCE_READINGS: f64 = 5.0;
/// Maximum number of datagrams read in one poll: 30 ms of the fastest sensor.
const DATAGRAMS_MAX: usize = 256;
/// Maximum force, N, and torque, Nm; a larger number is not a measurement.
const FORCE_MAX_N: f64 = 1e5;
const TORQUE_MAX_NM: f64 = 1e4;
/// Time for the first record, and interval at which it is requested again: a datagram may be lost.
const FIRST: Duration = Duration::from_secs(1);
const AGAIN: Duration = Duration::from_millis(200);
const NAP: Duration = Duration::from_millis(1);

/// An open, measuring sensor. Dropping it stops the transfer.
pub struct AtiDriver {
    line: Box<dyn TransportDatagrams>,
    identity: DeviceIdentity,
    health: Health,
    counts: [f64; 2],
    rate_hz: f64,
    silence_s: f64,
    /// Number of the newest record, and records since the first one: the sensor's clock.
    newest: Option<u32>,
    since_first: u64,
    usable_s: Option<f64>,
    /// The cause to report if no usable record arrives any more.
    suspect: Loss,
}

impl std::fmt::Debug for AtiDriver {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("AtiDriver").field("health", &self.health).finish_non_exhaustive()
    }
}

impl AtiDriver {
    /// Reads the sensor's configuration, starts the transfer and waits for the first record; may take some seconds.
    ///
    /// # Errors
    /// [`DeviceError`] if a setting is invalid, the sensor cannot be reached or used, or it sends no records.
    pub fn open(settings: &AtiSettings) -> Result<Self, DeviceError> {
        settings.check()?;
        let place = settings.place();
        let configuration = match settings.counts() {
            Some(counts) => {
                let identity = DeviceIdentity { product: "Net F/T".to_owned(), ..DeviceIdentity::default() };
                AtiConfiguration { identity, counts, rate_hz: None }
            }
            None => AtiConfiguration::fetch(settings)?,
        };
        let found = &configuration.identity.serial;
        if let Some(expected) = settings.serial_number.as_ref().filter(|expected| !same_serial(expected, found)) {
            return Err(DeviceError::OtherSerial { place, expected: expected.clone(), found: found.clone() });
        }
        let unknown = |error| DeviceError::of_address(&place, &error);
        let address = std::net::ToSocketAddrs::to_socket_addrs(&place).map_err(unknown)?.next();
        let address = address.ok_or_else(|| DeviceError::Unreachable { place: place.clone() })?;
        let mut line = Udp::connect(address)?;
        wait_for_record(&mut line, &place)?;
        Ok(Self::over(Box::new(line), settings, configuration))
    }

    /// Uses an open line to a sensor that is sending.
    pub(super) fn over(
        line: Box<dyn TransportDatagrams>,
        settings: &AtiSettings,
        configuration: AtiConfiguration,
    ) -> Self {
        let AtiConfiguration { identity, counts, rate_hz } = configuration;
        let rate_hz = rate_hz.unwrap_or(settings.rate_hz);
        Self {
            line,
            identity,
            health: Health::opening(),
            counts,
            rate_hz,
            silence_s: SILENCE_S.max(SILENCE_READINGS / rate_hz),
            newest: None,
            since_first: 0,
            usable_s: None,
            suspect: Loss::Silent,
        }
    }

    fn take_in(&mut self, now_s: f64) -> Result<Option<TimedReading<ForceReading>>, Loss> {
        let mut newest = None;
        // One byte more than a record, so that a datagram that is too long is recognised.
        let mut buffer = [0; RECORD_BYTES + 1];
        for _ in 0..DATAGRAMS_MAX {
            let Some(count) = self.line.receive(&mut buffer)? else { break };
            if let Some(record) = RdtRecord::decode(&buffer[..count.min(buffer.len())]) {
                newest = self.take(&record, now_s).or(newest);
            } else {
                self.health.damaged += 1;
                self.suspect = Loss::Corrupt;
            }
        }
        Ok(newest)
    }

    fn take(&mut self, record: &RdtRecord, now_s: f64) -> Option<TimedReading<ForceReading>> {
        // The signed difference, because the number wraps around.
        let ahead = self.newest.map_or(1, |newest| record.number.wrapping_sub(newest).cast_signed());
        if ahead <= 0 {
            self.health.out_of_order += 1;
            self.suspect = Loss::Implausible;
            return None;
        }
        let ahead = u64::from(ahead.unsigned_abs());
        self.health.lost += ahead - 1;
        self.since_first += if self.newest.is_some() { ahead } else { 0 };
        self.newest = Some(record.number);
        if record.status != 0 {
            return self.refuse(Loss::Device { code: record.status });
        }
        let axis = |place: usize, counts: f64| f64::from(record.counts[place]) / counts;
        let [per_n, per_nm] = self.counts;
        let force_n = Vector3::new(axis(0, per_n), axis(1, per_n), axis(2, per_n));
        let torque_nm = Vector3::new(axis(3, per_nm), axis(4, per_nm), axis(5, per_nm));
        if force_n.amax() > FORCE_MAX_N || torque_nm.amax() > TORQUE_MAX_NM {
            return self.refuse(Loss::Implausible);
        }
        self.health.accept(now_s);
        self.usable_s = Some(now_s);
        self.suspect = Loss::Silent;
        let value = ForceReading {
            wrench: Wrench { force_n, torque_nm },
            acceleration_m_s2: None,
            angular_velocity_rad_s: None,
            temperature_c: f64::NAN,
            status: ForceStatus::default(),
        };
        let device_s = Some(self.since_first as f64 / self.rate_hz);
        Some(TimedReading { device_s, arrival_s: now_s, value })
    }

    const fn refuse(&mut self, loss: Loss) -> Option<TimedReading<ForceReading>> {
        self.health.refused += 1;
        self.suspect = loss;
        None
    }
}

/// Requests records until one arrives.
fn wait_for_record(line: &mut impl TransportDatagrams, place: &str) -> Result<(), DeviceError> {
    let gone = |_| DeviceError::NobodyListens { place: place.to_owned() };
    let begin = Instant::now();
    let mut asked: Option<Instant> = None;
    let mut buffer = [0; RECORD_BYTES + 1];
    while begin.elapsed() < FIRST {
        if asked.is_none_or(|asked| asked.elapsed() > AGAIN) {
            line.send(&RdtCommand::StartRealTime.encode()).map_err(gone)?;
            asked = Some(Instant::now());
        }
        match line.receive(&mut buffer).map_err(gone)? {
            Some(count) if RdtRecord::decode(&buffer[..count.min(buffer.len())]).is_some() => return Ok(()),
            Some(_) => {}
            None => std::thread::sleep(NAP),
        }
    }
    Err(DeviceError::Silent { place: place.to_owned() })
}

impl Device for AtiDriver {
    type Reading = ForceReading;

    fn poll(&mut self, now_s: f64) -> Option<TimedReading<ForceReading>> {
        if matches!(self.health.standing, ConnectionState::Lost(_)) {
            return None;
        }
        let usable_s = *self.usable_s.get_or_insert(now_s);
        match self.take_in(now_s) {
            Err(loss) => {
                self.health.lose(loss);
                None
            }
            Ok(None) if now_s - usable_s > self.silence_s => {
                self.health.lose(self.suspect);
                None
            }
            Ok(newest) => newest,
        }
    }

    fn about(&self) -> (&Health, &DeviceIdentity) {
        (&self.health, &self.identity)
    }
}

impl Drop for AtiDriver {
    fn drop(&mut self) {
        // Otherwise the sensor would send until it is switched off.
        self.line.send(&RdtCommand::Stop.encode()).ok();
    }
}
