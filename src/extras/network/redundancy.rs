//! Every datagram carries the last n payloads, so that a lost one arrives with the next.
//!
//! The receiver measures how many datagrams are lost and how often two in a row, and tells the sender. The sender takes the least n at which
//! a payload is lost with all its copies less often than [`LEFT_OVER`], as far as the datagram and the limit of the rate have room.

use crate::wire::{AGE_MAX_S, COPIES_MAX, Record};

/// Share of payloads that may be lost with all their copies.
pub const LEFT_OVER: f64 = 1e-4;
/// A datagram counts as lost when this many later ones have come.
const PATIENCE: u64 = 64;
/// A run of this many lost ones is an outage, which no copies cure: it does not count for their number.
const OUTAGE: u32 = 64;
/// Numbers that are remembered.
const ROOM: u64 = 1024;
/// Length of one part of the statistics, s, and their number.
const PART_S: f64 = 0.5;
const PARTS: usize = 10;
/// The last parts that alone can raise the loss: a link that becomes bad is answered within a second.
const RECENT: usize = 2;

/// Copies needed at this loss: `loss` is the share of datagrams lost, `again` that of those after a lost one. What comes after a later one
/// counts like what is lost: its payload may be due before.
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

/// What a sender may need again.
#[derive(Clone, Debug)]
pub struct History {
    /// Content, length and time of sending of each payload.
    bytes: Vec<u8>,
    sent: [(usize, f64); COPIES_MAX],
    payload_max: usize,
    /// Number of payloads so far.
    count: u64,
}

impl History {
    /// Empty, for payloads of this length (bytes). All memory is allocated here.
    pub fn new(payload_max: usize) -> Self {
        Self { bytes: vec![0; payload_max * COPIES_MAX], sent: [(0, 0.0); COPIES_MAX], payload_max, count: 0 }
    }

    /// Number of payloads so far.
    pub const fn count(&self) -> u64 {
        self.count
    }

    /// Adds a payload; `false` if it is too long.
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

    /// Length of the longest payload of late, bytes.
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

    /// Writes the last payloads, newest first, at most this many and as far as there is room. The first `fresh` of them have not been sent
    /// yet; the others are copies, which take the first `for_copies` bytes at most. Where not all copies fit, those much longer than
    /// the mean are left out, so that one of them does not cost many short ones their copy.
    pub fn write(&self, copies: usize, fresh: usize, now_s: f64, room: &mut [u8], for_copies: usize) -> Written {
        let mut written = Written::default();
        let count = (copies.min(COPIES_MAX) as u64).min(self.count);
        let total: usize = (0..count).map(|back| self.len(back)).sum();
        let all: usize = (0..count).map(|back| Record::length(self.len(back), now_s - self.sent_s(back))).sum();
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
            let record = Record { age_s, bytes: is_carried.then(|| &self.bytes[at..at + len]) };
            let end = if is_fresh { room.len() } else { for_copies.min(room.len()) };
            let Some(bytes) = room.get_mut(written.bytes..end).and_then(|room| record.write(room)) else { break };
            written.bytes += bytes;
            written.records += 1;
            written.carried += usize::from(is_carried);
        }
        written
    }
}

/// What was written into a datagram.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Written {
    /// Length.
    pub bytes: usize,
    /// Payloads that stand in it, those that are left out included.
    pub records: usize,
    /// Payloads that it carries.
    pub carried: usize,
}

#[derive(Clone, Copy, Debug, Default)]
struct Part {
    all: u32,
    lost: u32,
    /// Lost ones after a lost one.
    again: u32,
    /// Those that came after a later one.
    overtaken: u32,
}

/// Measures which datagrams are lost.
#[derive(Clone, Debug)]
pub struct Losses {
    /// Bit of each number: it came.
    came: [u64; (ROOM / 64) as usize],
    /// One more than the highest number that came.
    end: u64,
    /// Numbers below are judged.
    judged: u64,
    /// Length of the run of lost ones that ends with the last judged one.
    run: u32,
    /// How many of them the statistics contain.
    added: u32,
    parts: [Part; PARTS],
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
            parts: [Part::default(); PARTS],
            part: 0,
            part_begin_s: 0.0,
            all: 0,
            lost: 0,
        }
    }
}

impl Losses {
    /// The datagram with this number came.
    pub fn add(&mut self, number: u64, now_s: f64) {
        if now_s - self.part_begin_s >= PART_S {
            self.part = (self.part + 1) % PARTS;
            self.parts[self.part] = Part::default();
            self.part_begin_s = now_s;
        }
        self.parts[self.part].overtaken += u32::from(number + 1 < self.end);
        if number < self.judged {
            return;
        }
        if number >= self.end {
            // An outage: what lies far behind is lost without a look at each.
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

    /// All numbers below this one count as lost or were judged before.
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
            // What the run has added is taken away, once; a run over two parts leaves some.
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

    /// Share of datagrams that were lost lately: of the last 5 s or the last second, whichever is worse. And of those after a lost
    /// one, the share that was lost too.
    pub fn shares(&self) -> (f64, f64) {
        let share = |parts| {
            let (all, lost, _) = self.sum(parts);
            // Too few to tell a share from.
            if all < 100.0 { 0.0 } else { lost / all }
        };
        let loss = f64::max(share(PARTS), share(RECENT));
        let (_, lost, again) = self.sum(PARTS);
        // As if two had been lost alone at this share: one chance run is no burst.
        let again = if lost == 0.0 { loss } else { (again + 10.0 * loss) / (lost + 10.0) };
        (loss, again.max(loss).min(1.0))
    }

    /// Share of datagrams of the last 5 s that came after a later one.
    pub fn overtaken(&self) -> f64 {
        let (all, ..) = self.sum(PARTS);
        let overtaken: u32 = self.parts.iter().map(|part| part.overtaken).sum();
        if all < 100.0 { 0.0 } else { (f64::from(overtaken) / all).min(1.0) }
    }

    /// All datagrams that should have come, and those that did not.
    pub const fn totals(&self) -> (u64, u64) {
        (self.all, self.lost)
    }
}

#[cfg(test)]
#[path = "redundancy_tests.rs"]
mod tests;
