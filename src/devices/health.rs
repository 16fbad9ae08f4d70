//! State and counters that every driver keeps in the same way, without allocation.

use serde::Serialize;

/// Why readings of a running device can no longer be trusted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case", tag = "loss")]
pub enum Loss {
    Disconnected,
    Silent,
    Corrupt,
    Implausible,
    Device {
        /// The manufacturer's code.
        code: u32,
    },
}

impl Loss {
    /// Returns the cause, for a screen.
    pub const fn cause(self) -> &'static str {
        match self {
            Self::Disconnected => "the connection was interrupted",
            Self::Silent => "it sends no data",
            Self::Corrupt => "its data are damaged",
            Self::Implausible => "it sends impossible values",
            Self::Device { .. } => "it reports a fault",
        }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ConnectionState {
    #[default]
    Closed,
    /// Being opened and configured, on another thread.
    Opening,
    /// Delivers readings. Connected does not mean engaged.
    Connected,
    /// The device has delivered readings but does not any more.
    Lost(Loss),
}

/// State and counters of a device since it was opened. A reading is a complete, checked frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Health {
    pub standing: ConnectionState,
    pub readings: u64,
    /// Number of readings that never arrived, according to the device's counter or clock.
    pub lost: u64,
    /// Number of frames refused because of their checksum or structure.
    pub damaged: u64,
    /// Number of bytes skipped to find the beginning of a frame again.
    pub skipped_bytes: u64,
    /// Number of readings that arrived too late, twice, or in the wrong order.
    pub out_of_order: u64,
    /// Number of readings refused because of their status bits or numbers.
    pub refused: u64,
    /// Arrival of the newest reading, s on the loop's clock.
    pub newest_s: Option<f64>,
    /// Rate over the last half second, Hz.
    pub rate_hz: f64,
    /// Number of outages since the loop began; reopening does not reset it.
    pub outages: u64,
    /// Duration of the longest outage, s: from the last reading before it to the first one after it, or until now.
    pub longest_outage_s: f64,
    #[serde(skip)]
    window_s: Option<f64>,
    #[serde(skip)]
    in_window: u32,
}

/// Averaging time of the rate, s: short enough to follow a change on the screen, long enough for 30 frames of a tracker
/// at 60 Hz, so that the rate does not flicker.
const RATE_WINDOW_S: f64 = 0.5;

impl Health {
    /// Returns the health of a device that is being opened.
    pub fn opening() -> Self {
        Self { standing: ConnectionState::Opening, ..Self::default() }
    }

    pub fn accept(&mut self, now_s: f64) {
        let begin_s = *self.window_s.get_or_insert(now_s);
        if now_s - begin_s >= RATE_WINDOW_S {
            self.rate_hz = f64::from(self.in_window) / (now_s - begin_s);
            self.window_s = Some(now_s);
            self.in_window = 0;
        }
        self.in_window += 1;
        self.newest_s = Some(now_s);
        self.readings += 1;
        self.standing = ConnectionState::Connected;
    }

    /// Marks the device as lost; the first cause is kept. Returns true if it was not lost before.
    pub const fn lose(&mut self, loss: Loss) -> bool {
        let newly = !matches!(self.standing, ConnectionState::Lost(_));
        if newly {
            self.standing = ConnectionState::Lost(loss);
        }
        newly
    }

    /// Returns the seconds since the newest reading; infinite before the first.
    pub fn age_s(&self, now_s: f64) -> f64 {
        self.newest_s.map_or(f64::INFINITY, |newest_s| now_s - newest_s)
    }
}

/// Outages of a slot; they are kept when the device is reopened.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Outages {
    count: u64,
    longest_s: f64,
    since_s: Option<f64>,
}

impl Outages {
    /// Updates the outages from the current state of the device, and copies them into `health`.
    pub(super) fn follow(&mut self, health: &mut Health, now_s: f64) {
        if matches!(health.standing, ConnectionState::Lost(_)) && self.since_s.is_none() {
            self.count += 1;
            self.since_s = Some(health.newest_s.unwrap_or(now_s));
        }
        if let Some(since_s) = self.since_s {
            self.longest_s = self.longest_s.max(now_s - since_s);
        }
        // A device that a person disconnects does not count as an outage.
        if matches!(health.standing, ConnectionState::Connected | ConnectionState::Closed) {
            self.since_s = None;
        }
        health.outages = self.count;
        health.longest_outage_s = self.longest_s;
    }
}

#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct DeviceIdentity {
    pub product: String,
    pub serial: String,
    pub firmware: String,
}

/// Returns whether two serial numbers are equal: `853`, `SN853` and `SN000853` are. An empty number equals no other.
pub fn same_serial(one: &str, other: &str) -> bool {
    let number = |serial: &str| {
        let serial = serial.trim().to_uppercase();
        serial.trim_start_matches("SN").trim_start_matches('0').to_owned()
    };
    let [one, other] = [one, other].map(number);
    !one.is_empty() && one == other
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_serial_number_is_the_same_in_every_spelling() {
        assert!(same_serial("853", "SN000853") && same_serial(" sn853", "853") && same_serial("049d", "049D"));
        assert!(!same_serial("853", "8530") && !same_serial("", "") && !same_serial("SN0", "0"));
    }

    #[test]
    fn the_rate_is_found_one_by_one_and_in_batches() {
        for batch in [1, 4] {
            let mut health = Health::default();
            for k in 0..8000_u32 {
                health.accept(f64::from(k / batch * batch) * 1e-3);
            }
            assert!((health.rate_hz - 1000.0).abs() < 50.0, "batches of {batch}: {} Hz", health.rate_hz);
        }
    }

    #[test]
    fn the_first_cause_of_a_loss_stays_until_it_delivers_again() {
        let mut health = Health::default();
        assert!(health.age_s(3.0).is_infinite());
        health.accept(1.0);
        assert!(health.lose(Loss::Silent) && !health.lose(Loss::Disconnected));
        assert_eq!(health.standing, ConnectionState::Lost(Loss::Silent));
        health.accept(2.0);
        assert_eq!(health.standing, ConnectionState::Connected);
    }
}
