//! An external force-torque sensor.

use nima_core::frames::Wrench;

use super::{
    codec::{Datagram, status},
    line::ExternalLine,
    opening,
    settings::{ExternalKind, ExternalSettings},
};
use crate::{Device, DeviceError, DeviceIdentity, ForceReading, ForceStatus, Health, TimedReading};

/// Numbers of a sensor beyond this limit are impossible: N, Nm, m/s^2, rad/s, degrees Celsius.
const NUMBER_MAX: f64 = 1e4;

pub struct ExternalSensor {
    line: ExternalLine,
}

impl ExternalSensor {
    /// Waits for the device's program, up to half a second.
    ///
    /// # Errors
    /// [`DeviceError`] if a setting is invalid, the port is in use, or no program of a sensor sends and receives.
    pub fn open(settings: &ExternalSettings) -> Result<Self, DeviceError> {
        Ok(Self { line: opening::open(ExternalKind::Sensor, settings, None)? })
    }

    /// Opens the sensor over an existing connection, with time stamps from 0 on.
    #[cfg(test)]
    pub(super) fn over(
        datagrams: Box<dyn crate::transport::TransportDatagrams>,
        settings: &ExternalSettings,
    ) -> Result<Self, DeviceError> {
        settings.check(ExternalKind::Sensor)?;
        Ok(Self { line: opening::meet(datagrams, ExternalKind::Sensor, settings, None, 0)? })
    }
}

/// Returns the reading in a datagram, if its numbers are possible.
fn reading(datagram: &Datagram) -> Option<ForceReading> {
    let numbers = &datagram.numbers[..13];
    let possible = numbers.iter().all(|number| number.abs() <= NUMBER_MAX);
    possible.then(|| ForceReading {
        wrench: Wrench { force_n: datagram.three(0).into(), torque_nm: datagram.three(3).into() },
        acceleration_m_s2: datagram.has(status::HAS_ACCELERATION).then(|| datagram.three(6).into()),
        angular_velocity_rad_s: datagram.has(status::HAS_ANGULAR_VELOCITY).then(|| datagram.three(9).into()),
        temperature_c: numbers[12],
        status: ForceStatus {
            throttled: datagram.has(status::THROTTLED),
            overrange: datagram.has(status::OVERRANGE),
            invalid: datagram.has(status::INVALID),
            raw: datagram.has(status::RAW),
        },
    })
}

impl Device for ExternalSensor {
    type Reading = ForceReading;

    fn poll(&mut self, now_s: f64) -> Option<TimedReading<ForceReading>> {
        let newest = self.line.receive(now_s, reading);
        self.line.report(true, &[]);
        newest.map(|(stamped, _)| stamped)
    }

    fn about(&self) -> (&Health, &DeviceIdentity) {
        self.line.about()
    }
}
