//! What a link measures about itself.

use crate::{
    clock::Estimate,
    playout::{Counts, Delays},
};

/// What keeps the number of copies below the one that is wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Limit {
    /// Nothing.
    #[default]
    None,
    /// The longest datagram.
    Datagram,
    /// The limit of the rate.
    Rate,
}

/// How often each payload is sent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Copies {
    /// Needed at the measured loss.
    pub wanted: usize,
    /// In the last datagram.
    pub used: usize,
    /// Why they are fewer.
    pub limit: Limit,
}

/// Counts datagrams and their bytes, and measures the rate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Meter {
    /// Datagrams.
    pub datagrams: u64,
    /// Bytes, with the headers of IPv4 and UDP.
    pub bytes: u64,
    /// Rate over the last full second, bit/s.
    pub rate_bit_s: f64,
    begin_s: f64,
    begin_bytes: u64,
}

impl Meter {
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
        Self { least_s: self.least_s + by_s, mean_s: self.mean_s + by_s, p999_s: self.p999_s + by_s }
    }
}

/// What one session has measured.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Figures {
    /// Their clock, with its bound and the least round trip.
    pub clock: Option<Estimate>,
    /// Steps of a clock that were found.
    pub steps: u32,
    /// One-way delay of payloads to us in the last 5 s, wrong by the clock's bound at most.
    pub one_way: Option<Delays>,
    /// Play-out delay in force, s.
    pub playout_s: Option<f64>,
    /// Play-out delay that is wanted, s; what is above the one in force is reached by 1 ms/s.
    pub playout_wanted_s: Option<f64>,
    /// Share of datagrams lost on the way to us, lately.
    pub loss: f64,
    /// The same on the way to them, as they tell.
    pub loss_there: f64,
    /// Datagrams that should have come, and those that did not.
    pub datagrams_expected: u64,
    /// See above.
    pub datagrams_lost: u64,
    /// How often each payload is sent.
    pub copies: Copies,
    /// What became of the payloads to us.
    pub counts: Counts,
    /// Payloads that had to wait for the next datagram because of the rate's limit.
    pub held: u64,
    /// Sent.
    pub sent: Meter,
    /// Received and accepted.
    pub received: Meter,
}

impl Figures {
    /// 99.9th percentile minus the least of the one-way delays, s.
    pub fn jitter_s(&self) -> Option<f64> {
        self.one_way.map(|delays| delays.p999_s - delays.least_s)
    }
}

/// Datagrams that were dropped, by cause.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dropped {
    /// Not encrypted with the session's keys.
    pub forged: u64,
    /// Came before.
    pub replayed: u64,
    /// Older than the window of 2048 datagrams.
    pub old: u64,
    /// Of another version of the protocol.
    pub foreign_version: u64,
    /// Cut, too long, or none of this protocol.
    pub malformed: u64,
    /// Of a session that is not, or no longer, open here.
    pub unknown_session: u64,
    /// Parts of handshakes beyond the limits.
    pub flooded: u64,
    /// Handshakes that were refused: a wrong cookie, a key that is not known.
    pub refused: u64,
    /// Datagrams of ours that the system did not take.
    pub unsent: u64,
}

impl Dropped {
    /// All of them.
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
