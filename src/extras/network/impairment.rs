//! A reproducibly impaired line: delay, jitter, loss, reordering, duplicates, a limited rate, outages.
//!
//! [`Impairment`] computes when each datagram arrives, on any clock; [`ImpairedLine`] also holds the datagrams. A study uses
//! virtual time, a [`crate::relay`] real time. Each direction of a link has its own line, so that they can differ.

use std::{cmp::Reverse, collections::BinaryHeap};

use nima_core::noise::Noise;
use serde::{Deserialize, Serialize};

/// Additional delay of a datagram.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ImpairmentJitter {
    /// None.
    #[default]
    None,
    /// Absolute value of a normal random number with this standard deviation.
    Normal { deviation_s: f64 },
    /// A Pareto (Lomax) number: rarely very large.
    Pareto {
        mean_s: f64,
        /// Shape, above 1: the smaller, the longer the tail. 3 is usual.
        shape: f64,
    },
}

/// The datagrams that are lost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum LossModel {
    /// None.
    #[default]
    None,
    /// Each with this probability, independent of the others.
    Independent {
        /// Fraction lost.
        #[serde(rename = "share")]
        fraction: f64,
    },
    /// In bursts: while the link is bad, all datagrams are lost, while it is good, none (E. N. Gilbert, 1960; E. O.
    /// Elliott, 1963).
    Bursts {
        /// Fraction lost in the long run.
        #[serde(rename = "share")]
        fraction: f64,
        /// Mean length of a burst, s.
        burst_s: f64,
    },
}

/// Periodic interruptions of the line.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Flap {
    /// Duration of an interruption, s.
    pub down_s: f64,
    /// Period, s; the interruption is at the end of each.
    pub every_s: f64,
}

/// The published profile of outages: 3.2 s on, 0.8 s off.
pub const OUTAGES: Flap = Flap { down_s: 0.8, every_s: 4.0 };

/// Impairments of one direction of a line. The default is a perfect line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ImpairmentSettings {
    /// Minimum delay, s.
    pub delay_s: f64,
    /// Additional delay.
    pub jitter: ImpairmentJitter,
    /// Whether jitter lets datagrams overtake each other; otherwise a late datagram delays those behind it, as in a
    /// queue.
    pub overtakes: bool,
    /// Lost datagrams.
    pub loss: LossModel,
    /// This fraction is delayed by a further `reorder_s`, and is overtaken in the meantime.
    pub reorder: f64,
    /// See `reorder`, s.
    pub reorder_s: f64,
    /// This fraction arrives twice.
    pub duplicate: f64,
    /// Maximum rate, bit/s; a datagram that would wait longer than `queue_s` is lost. 0 for no limit.
    pub rate_bit_s: f64,
    /// See `rate_bit_s`, s.
    pub queue_s: f64,
    /// Times without a connection.
    pub flap: Option<Flap>,
}

impl ImpairmentSettings {
    /// Checks the settings.
    ///
    /// # Errors
    /// A sentence with key, value and the allowed range.
    pub fn check(&self) -> Result<(), String> {
        let fraction = |name: &str, value: f64| {
            if (0.0..=1.0).contains(&value) {
                Ok(())
            } else {
                Err(format!("{name} = {value}: it must be between 0 and 1"))
            }
        };
        let time = |name: &str, value: f64| {
            let allowed = (0.0..=60.0).contains(&value);
            if allowed { Ok(()) } else { Err(format!("{name} = {value}: it must be between 0 and 60 s")) }
        };
        time("delay_s", self.delay_s)?;
        time("reorder_s", self.reorder_s)?;
        time("queue_s", self.queue_s)?;
        fraction("reorder", self.reorder)?;
        fraction("duplicate", self.duplicate)?;
        match self.jitter {
            ImpairmentJitter::None => {}
            ImpairmentJitter::Normal { deviation_s } => time("deviation_s", deviation_s)?,
            ImpairmentJitter::Pareto { mean_s, shape } => {
                time("mean_s", mean_s)?;
                if !(shape > 1.0 && shape <= 100.0) {
                    return Err(format!("shape = {shape}: it must be above 1 and at most 100"));
                }
            }
        }
        match self.loss {
            LossModel::None => {}
            LossModel::Independent { fraction: lost } => fraction("share", lost)?,
            LossModel::Bursts { fraction: lost, burst_s } => {
                fraction("share", lost)?;
                time("burst_s", burst_s)?;
            }
        }
        if let Some(Flap { down_s, every_s }) = self.flap {
            time("down_s", down_s)?;
            time("every_s", every_s)?;
            if down_s >= every_s {
                return Err(format!("down_s = {down_s}: it must be shorter than every_s = {every_s}"));
            }
        }
        if !(self.rate_bit_s >= 0.0 && self.rate_bit_s.is_finite()) {
            return Err(format!("rate_bit_s = {}: it must be 0 (no limit) or above", self.rate_bit_s));
        }
        Ok(())
    }
}

/// Arrival times of a datagram, s: none, one, or two.
pub type DeliveryTimes = [Option<f64>; 2];

/// Computes the arrival times of datagrams.
#[derive(Clone, Debug)]
pub struct Impairment {
    settings: ImpairmentSettings,
    noise: Noise,
    /// Whether the line is bad, and the end of that state, s.
    is_bad: bool,
    until_s: f64,
    /// Arrival of the last datagram in the queue, s.
    last_s: f64,
    /// Until when the rate limit is busy, s.
    busy_s: f64,
}

impl Impairment {
    /// Creates an impairment; the same seed gives the same arrivals.
    pub fn new(settings: ImpairmentSettings, seed: u64) -> Self {
        let noise = Noise::new(seed);
        Self {
            settings,
            noise,
            is_bad: false,
            until_s: f64::NEG_INFINITY,
            last_s: f64::NEG_INFINITY,
            busy_s: f64::NEG_INFINITY,
        }
    }

    /// Returns the arrivals of a datagram of this length (bytes, with all headers) that is sent at `now_s`; times must
    /// not go back.
    pub fn pass(&mut self, now_s: f64, len: usize) -> DeliveryTimes {
        let ImpairmentSettings { flap, duplicate, reorder, reorder_s, delay_s, overtakes, .. } = self.settings;
        // Draw the same number of random values for every datagram, whatever its outcome, so that runs stay comparable.
        let lost = self.noise.uniform();
        let twice = self.noise.uniform();
        let held = self.noise.uniform();
        let jitter_s = self.jitter_s();
        let is_down = flap.is_some_and(|flap| now_s.rem_euclid(flap.every_s) >= flap.every_s - flap.down_s);
        if self.is_lost(now_s, lost) || is_down {
            return [None, None];
        }
        let Some(sent_s) = self.through_limit(now_s, len) else { return [None, None] };
        let mut due_s = sent_s + delay_s + jitter_s;
        if held < reorder {
            due_s += reorder_s;
        } else if !overtakes {
            due_s = due_s.max(self.last_s);
            self.last_s = due_s;
        }
        [Some(due_s), (twice < duplicate).then_some(due_s)]
    }

    fn jitter_s(&mut self) -> f64 {
        match self.settings.jitter {
            ImpairmentJitter::None => 0.0,
            ImpairmentJitter::Normal { deviation_s } => self.noise.gaussian().abs() * deviation_s,
            ImpairmentJitter::Pareto { mean_s, shape } => {
                let tail = libm::pow(1.0 - self.noise.uniform(), -1.0 / shape) - 1.0;
                tail * mean_s * (shape - 1.0)
            }
        }
    }

    fn is_lost(&mut self, now_s: f64, chance: f64) -> bool {
        match self.settings.loss {
            LossModel::None => false,
            LossModel::Independent { fraction } => chance < fraction,
            LossModel::Bursts { fraction, burst_s } => {
                if fraction <= 0.0 || burst_s <= 0.0 {
                    return false;
                }
                if self.until_s == f64::NEG_INFINITY {
                    self.is_bad = chance < fraction;
                    self.until_s = now_s;
                } else if self.until_s > now_s {
                    return self.is_bad;
                } else {
                    self.is_bad = !self.is_bad;
                }
                let good_s = burst_s * (1.0 / fraction - 1.0);
                // Skip the states that ended before now. The limit only prevents an endless loop: on average each state lasts as long as the mean of its kind.
                for _ in 0..1000 {
                    let mean_s = if self.is_bad { burst_s } else { good_s };
                    self.until_s += -mean_s * libm::log(1.0 - self.noise.uniform());
                    if self.until_s > now_s {
                        return self.is_bad;
                    }
                    self.is_bad = !self.is_bad;
                }
                self.until_s = now_s;
                self.is_bad
            }
        }
    }

    /// Returns the time at which it has passed the rate limit; `None` if it would wait too long.
    fn through_limit(&mut self, now_s: f64, len: usize) -> Option<f64> {
        if self.settings.rate_bit_s <= 0.0 {
            return Some(now_s);
        }
        let begin_s = self.busy_s.max(now_s);
        if begin_s - now_s > self.settings.queue_s {
            return None;
        }
        self.busy_s = begin_s + len as f64 * 8.0 / self.settings.rate_bit_s;
        Some(self.busy_s)
    }
}

/// A datagram in transit.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
struct DatagramInFlight {
    /// Time in ns, so that it can be ordered.
    due_ns: i64,
    /// Order of sending, for datagrams that are due at the same time.
    number: u64,
    bytes: Vec<u8>,
}

/// One direction of an impaired line, with the datagrams in transit.
#[derive(Debug)]
pub struct ImpairedLine {
    impairment: Impairment,
    under_way: BinaryHeap<Reverse<DatagramInFlight>>,
    number: u64,
    /// Datagrams sent, and datagrams lost.
    sent: u64,
    lost: u64,
    /// Added to the length of each datagram for the rate limit, bytes.
    headers: usize,
}

/// Maximum number of datagrams in transit; further ones are lost.
const UNDER_WAY_MAX: usize = 1 << 17;

impl ImpairedLine {
    /// Creates a line; the same seed gives the same behaviour.
    pub fn new(settings: ImpairmentSettings, seed: u64) -> Self {
        let impairment = Impairment::new(settings, seed);
        Self { impairment, under_way: BinaryHeap::new(), number: 0, sent: 0, lost: 0, headers: crate::wire::UDP_LEN }
    }

    pub fn send(&mut self, now_s: f64, bytes: &[u8]) {
        let fate = self.impairment.pass(now_s, bytes.len() + self.headers);
        self.sent += 1;
        let has_room = self.under_way.len() < UNDER_WAY_MAX;
        self.lost += u64::from(fate == [None, None] || !has_room);
        for due_s in fate.into_iter().flatten().filter(|_| has_room) {
            self.number += 1;
            let due_ns = (due_s * 1e9).round() as i64;
            self.under_way.push(Reverse(DatagramInFlight { due_ns, number: self.number, bytes: bytes.into() }));
        }
    }

    /// Returns the next datagram that has arrived by `now_s`, and its arrival time, s.
    pub fn receive(&mut self, now_s: f64) -> Option<(f64, Vec<u8>)> {
        let due_s = self.due_s()?;
        if due_s > now_s {
            return None;
        }
        self.under_way.pop().map(|Reverse(datagram)| (due_s, datagram.bytes))
    }

    /// Returns the arrival of the next datagram, s.
    pub fn due_s(&self) -> Option<f64> {
        self.under_way.peek().map(|Reverse(next)| next.due_ns as f64 * 1e-9)
    }

    /// Returns the numbers of datagrams sent and lost.
    pub const fn totals(&self) -> (u64, u64) {
        (self.sent, self.lost)
    }
}

#[cfg(test)]
#[path = "impairment_tests.rs"]
mod tests;
