//! Redundancy: every datagram contains the last n payloads, so that a lost payload arrives with the next datagram.
//!
//! The receiver measures the loss of datagrams, and how often two in a row are lost, and reports it to the sender. The
//! sender uses the smallest n at which a payload is lost with all its copies less often than [`LEFT_OVER`], as far as
//! the datagram size and the rate limit permit.

use crate::wire::{AGE_MAX_S, COPIES_MAX, PayloadRecord};

/// Allowed fraction of payloads that are lost with all their copies.
pub const LEFT_OVER: f64 = 1e-4;
/// A datagram counts as lost when this many later ones have arrived.
const PATIENCE: u64 = 64;
/// A run of this many lost datagrams is an outage, which copies cannot remedy, so it does not affect their number.
const OUTAGE: u32 = 64;
/// Number of datagram numbers stored.
const ROOM: u64 = 1024;
/// Length of one part of the statistics, s, and number of parts.
const PART_S: f64 = 0.5;
const PARTS: usize = 10;
/// Number of recent parts that can raise the loss on their own, so that a deteriorating link gets a response within a
/// second.
const RECENT: usize = 2;

/// Returns the required number of copies: `loss` is the fraction of datagrams lost, `again` the fraction lost after a
/// lost one. A reordered datagram counts as lost, because its payload may be due before it arrives.
///
/// ```
/// use nima_network::redundancy::copies_for;
///
/// assert_eq!(copies_for(0.0, 0.0), 1, "each payload once");
/// assert_eq!(copies_for(0.001, 0.001), 2);
/// assert_eq!(copies_for(0.3, 0.3), 8, "0.3^8 = 7e-5");
/// assert!(copies_for(0.05, 0.9) > 32, "bursts of ten");
/// ```
pub fn copies_for(loss: f64, again: f64) -> usize {
    let again = again.clamp(0.0, 0.99);
    let mut left = loss.clamp(0.0, 1.0);
    let mut copies = 1;
    while left > LEFT_OVER && copies < 4 * COPIES_MAX {
        left *= again;
        copies += 1;
    }
    copies
}

/// Payloads that a sender may need again.
#[derive(Clone, Debug)]
pub struct RedundancyHistory {
    /// Content, length and time of sending of each payload.
    bytes: Vec<u8>,
    sent: [(usize, f64); COPIES_MAX],
    payload_max: usize,
    count: u64,
}

impl RedundancyHistory {
    /// Creates an empty history for payloads of this length (bytes). All memory is allocated here.
    pub fn new(payload_max: usize) -> Self {
        Self { bytes: vec![0; payload_max * COPIES_MAX], sent: [(0, 0.0); COPIES_MAX], payload_max, count: 0 }
    }

    pub const fn count(&self) -> u64 {
        self.count
    }

    /// Adds a payload; returns `false` if it is too long.
    pub fn add(&mut self, bytes: &[u8], now_s: f64) -> bool {
        if bytes.len() > self.payload_max {
            return false;
        }
        let index = (self.count % COPIES_MAX as u64) as usize;
        let at = index * self.payload_max;
        self.bytes[at..at + bytes.len()].copy_from_slice(bytes);
        self.sent[index] = (bytes.len(), now_s);
        self.count += 1;
        true
    }

    /// Returns the length of the longest recent payload, bytes.
    pub fn longest(&self) -> usize {
        let known = (self.count as usize).min(COPIES_MAX);
        self.sent.iter().take(known).map(|(len, _)| *len).max().unwrap_or(0)
    }

    const fn index(&self, back: u64) -> usize {
        ((self.count - 1 - back) % COPIES_MAX as u64) as usize
    }

    fn len(&self, back: u64) -> usize {
        self.sent[self.index(back)].0
    }

    fn sent_s(&self, back: u64) -> f64 {
        self.sent[self.index(back)].1
    }

    /// Writes the last payloads, newest first, at most this many and as far as there is room. The first `fresh` of them
    /// have not been sent yet; the others are copies, which use at most the first `for_copies` bytes. If not all copies
    /// fit, those much longer than the mean are left out, so that one of them does not displace many short ones.
    pub fn write(
        &self,
        copies: usize,
        fresh: usize,
        now_s: f64,
        room: &mut [u8],
        for_copies: usize,
    ) -> DatagramContent {
        let mut written = DatagramContent::default();
        let count = (copies.min(COPIES_MAX) as u64).min(self.count);
        let total: usize = (0..count).map(|back| self.len(back)).sum();
        let all: usize = (0..count).map(|back| PayloadRecord::length(self.len(back), now_s - self.sent_s(back))).sum();
        let all_fit = all <= for_copies;
        for back in 0..count {
            let index = self.index(back);
            let (len, sent_s) = self.sent[index];
            let is_fresh = back < fresh as u64;
            let age_s = now_s - sent_s;
            if age_s > AGE_MAX_S {
                break;
            }
            let is_long = 2 * len * count as usize > 3 * total;
            let is_carried = is_fresh || all_fit || !is_long;
            let at = index * self.payload_max;
            let record = PayloadRecord { age_s, bytes: is_carried.then(|| &self.bytes[at..at + len]) };
            let end = if is_fresh { room.len() } else { for_copies.min(room.len()) };
            let Some(bytes) = room.get_mut(written.bytes..end).and_then(|room| record.write(room)) else { break };
            written.bytes += bytes;
            written.records += 1;
            written.carried += usize::from(is_carried);
        }
        written
    }
}

/// The payloads written into a datagram.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DatagramContent {
    /// Length, bytes.
    pub bytes: usize,
    /// Number of payloads in the datagram, including those left out.
    pub records: usize,
    /// Number of payloads that the datagram contains.
    pub carried: usize,
}

#[derive(Clone, Copy, Debug, Default)]
struct RedundancyPart {
    all: u32,
    lost: u32,
    /// Lost after a lost one.
    again: u32,
    /// Arrived after a later one.
    overtaken: u32,
}

/// Measures the loss of datagrams.
#[derive(Clone, Debug)]
pub struct Losses {
    /// One bit per number: whether the datagram arrived.
    came: [u64; (ROOM / 64) as usize],
    /// One more than the highest number received.
    end: u64,
    /// Lower numbers have been evaluated.
    judged: u64,
    /// Length of the run of lost datagrams that ends with the last judged one.
    run: u32,
    /// Number of datagrams of this run that the statistics contain.
    added: u32,
    parts: [RedundancyPart; PARTS],
    part: usize,
    part_begin_s: f64,
    all: u64,
    lost: u64,
}

impl Default for Losses {
    fn default() -> Self {
        Self {
            came: [0; (ROOM / 64) as usize],
            end: 0,
            judged: 0,
            run: 0,
            added: 0,
            parts: [RedundancyPart::default(); PARTS],
            part: 0,
            part_begin_s: 0.0,
            all: 0,
            lost: 0,
        }
    }
}

impl Losses {
    /// Called when the datagram with this number arrived.
    pub fn add(&mut self, number: u64, now_s: f64) {
        if now_s - self.part_begin_s >= PART_S {
            self.part = (self.part + 1) % PARTS;
            self.parts[self.part] = RedundancyPart::default();
            self.part_begin_s = now_s;
        }
        self.parts[self.part].overtaken += u32::from(number + 1 < self.end);
        if number < self.judged {
            return;
        }
        if number >= self.end {
            // After an outage, numbers far behind count as lost without checking each.
            if number - self.end > ROOM - PATIENCE {
                self.skip_to(number);
            }
            self.end = number + 1;
            while self.judged + PATIENCE < self.end {
                self.judge();
            }
        }
        self.came[(number / 64 % (ROOM / 64)) as usize] |= 1 << (number % 64);
    }

    /// Skips all numbers below this one, which count as lost or were judged before.
    fn skip_to(&mut self, number: u64) {
        while self.judged < self.end {
            self.judge();
        }
        let lost = number - self.judged;
        self.all += lost;
        self.lost += lost;
        self.run = OUTAGE;
        self.judged = number;
        self.came = [0; (ROOM / 64) as usize];
    }

    fn judge(&mut self) {
        let word = (self.judged / 64 % (ROOM / 64)) as usize;
        let bit = 1 << (self.judged % 64);
        let is_lost = self.came[word] & bit == 0;
        self.came[word] &= !bit;
        self.all += 1;
        self.lost += u64::from(is_lost);
        self.run = if is_lost { self.run.saturating_add(1).min(OUTAGE) } else { 0 };
        let part = &mut self.parts[self.part];
        let run = self.run;
        if run < OUTAGE {
            part.all = part.all.saturating_add(1);
            part.lost = part.lost.saturating_add(u32::from(is_lost));
            part.again = part.again.saturating_add(u32::from(run > 1));
        } else {
            // An outage is not a loss that copies could repair, so remove what this run has added so far. Only this part is corrected: a run that began in the previous one leaves a remainder there.
            let added = std::mem::take(&mut self.added);
            part.lost = part.lost.saturating_sub(added);
            part.again = part.again.saturating_sub(added.saturating_sub(1));
        }
        self.added = if is_lost && run < OUTAGE { run } else { 0 };
        self.judged += 1;
    }

    fn sum(&self, parts: usize) -> (f64, f64, f64) {
        let last = (0..parts).map(|back| self.parts[(self.part + PARTS - back) % PARTS]);
        last.fold((0.0, 0.0, 0.0), |(all, lost, again), part| {
            (all + f64::from(part.all), lost + f64::from(part.lost), again + f64::from(part.again))
        })
    }

    /// Returns the recent fraction of datagrams lost, over the last 5 s or the last second, whichever is worse; and the
    /// fraction lost after a lost one.
    pub fn fractions(&self) -> (f64, f64) {
        let fraction = |parts| {
            let (all, lost, _) = self.sum(parts);
            // Too few datagrams for a meaningful fraction.
            if all < 100.0 { 0.0 } else { lost / all }
        };
        let loss = f64::max(fraction(PARTS), fraction(RECENT));
        let (_, lost, again) = self.sum(PARTS);
        // Weighs in ten losses at the average rate, so that a single chance run does not count as a burst.
        let again = if lost == 0.0 { loss } else { (again + 10.0 * loss) / (lost + 10.0) };
        (loss, again.max(loss).min(1.0))
    }

    /// Returns the fraction of datagrams of the last 5 s that arrived after a later one.
    pub fn overtaken(&self) -> f64 {
        let (all, ..) = self.sum(PARTS);
        let overtaken: u32 = self.parts.iter().map(|part| part.overtaken).sum();
        if all < 100.0 { 0.0 } else { (f64::from(overtaken) / all).min(1.0) }
    }

    /// Returns the numbers of datagrams that should have arrived and of those that did not.
    pub const fn totals(&self) -> (u64, u64) {
        (self.all, self.lost)
    }
}

#[cfg(test)]
#[path = "redundancy_tests.rs"]
mod tests;
