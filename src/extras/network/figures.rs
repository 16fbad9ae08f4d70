//! Measurements of a link.

use crate::{
    clock::ClockEstimate,
    playout::{Delays, PlayoutCounts},
};

/// Reason why there are fewer redundant copies than requested.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Limit {
    /// They are not limited.
    #[default]
    None,
    /// The maximum size of a datagram.
    Datagram,
    /// The rate limit.
    Rate,
}

/// Number of times that each payload is sent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Copies {
    /// Required for the measured loss.
    pub wanted: usize,
    /// Number of copies in the last datagram.
    pub used: usize,
    /// Reason why there are fewer than requested.
    pub limit: Limit,
}

/// Counts datagrams and their bytes, and measures the rate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FigureMeter {
    pub datagrams: u64,
    /// Includes the headers of IPv4 and UDP.
    pub bytes: u64,
    /// Rate over the last full second, bit/s.
    pub rate_bit_s: f64,
    begin_s: f64,
    begin_bytes: u64,
}

impl FigureMeter {
    pub(crate) fn add(&mut self, bytes: usize, now_s: f64) {
        self.datagrams += 1;
        self.bytes += bytes as u64;
        let passed_s = now_s - self.begin_s;
        if passed_s >= 1.0 {
            self.rate_bit_s = (self.bytes - self.begin_bytes) as f64 * 8.0 / passed_s;
            self.begin_s = now_s;
            self.begin_bytes = self.bytes;
        }
    }
}

impl Delays {
    pub(crate) fn shifted(self, by_s: f64) -> Self {
        Self { min_s: self.min_s + by_s, mean_s: self.mean_s + by_s, p999_s: self.p999_s + by_s }
    }
}

/// Measurements of one session.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SessionMeasurements {
    /// Estimate of the other side's clock, with its bound and the minimum round trip.
    pub clock: Option<ClockEstimate>,
    /// Number of detected clock steps.
    pub steps: u32,
    /// One-way delay of payloads to us in the last 5 s; the clock's bound limits its error.
    pub one_way: Option<Delays>,
    /// Current playout delay, s.
    pub playout_s: Option<f64>,
    /// Target playout delay, s; the current one approaches it at 1 ms/s.
    pub playout_wanted_s: Option<f64>,
    /// Recent fraction of datagrams lost on the way to us.
    pub loss: f64,
    /// The same in the other direction, as reported by the other side.
    pub loss_there: f64,
    /// Datagrams that should have arrived.
    pub datagrams_expected: u64,
    /// Datagrams that did not arrive.
    pub datagrams_lost: u64,
    /// Number of times that each payload is sent.
    pub copies: Copies,
    /// Counts of the payloads to us.
    pub counts: PlayoutCounts,
    /// Payloads that had to wait for the next datagram because of the rate limit.
    pub held: u64,
    pub sent: FigureMeter,
    /// Received and accepted.
    pub received: FigureMeter,
}

impl SessionMeasurements {
    /// Returns the difference between the 99.9th percentile and the minimum of the one-way delays, s.
    pub fn jitter_s(&self) -> Option<f64> {
        self.one_way.map(|delays| delays.p999_s - delays.min_s)
    }
}

/// Dropped datagrams, by cause.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DroppedCounts {
    /// Not encrypted with the session's keys.
    pub forged: u64,
    /// Duplicates.
    pub replayed: u64,
    /// Older than the window of 2048 datagrams.
    pub old: u64,
    /// Of another version of the protocol.
    pub foreign_version: u64,
    /// Truncated, too long, or not of this protocol.
    pub malformed: u64,
    /// Datagrams of a session that is not open here.
    pub unknown_session: u64,
    /// Parts of handshakes beyond the limits.
    pub flooded: u64,
    /// Refused handshakes: a wrong cookie, or an unknown key.
    pub refused: u64,
    /// Our datagrams that the system did not accept.
    pub unsent: u64,
}

impl DroppedCounts {
    /// Returns the sum of all causes.
    pub const fn total(&self) -> u64 {
        self.forged
            + self.replayed
            + self.old
            + self.foreign_version
            + self.malformed
            + self.unknown_session
            + self.flooded
            + self.refused
            + self.unsent
    }
}
