//! Playout: delivers each payload at a fixed delay after it was sent. Nearly every payload arrives within this delay,
//! which never changes in steps.
//!
//! The target delay is the 99.9th percentile of the one-way delays of the last 5 s, plus a margin. The current delay
//! follows it by at most 1 ms/s. Payloads are delivered in order, each once. One that arrives after its time is
//! delivered at once if it is newer than all earlier ones, and counted as late; otherwise it is counted as stale. One
//! that never arrives is counted as lost when a newer one is delivered.
//!
//! All of this compares payloads with each other, so no estimate of the clocks' offset is needed: delays are apparent
//! ones, which contain the offset.

use serde::{Deserialize, Serialize};

/// Length of one part of the statistics, s, and number of parts: 5 s together.
const PART_S: f64 = 0.5;
const PARTS: usize = 10;
/// Number of the largest delays stored for each part: enough for the percentile of 16 000 payloads.
const TOP: usize = 16;
/// Fraction of payloads that may arrive later than the target delay.
const LATE_FRACTION: f64 = 1e-3;
/// Measuring time before the first payload is delivered, s and payloads.
const FIRST_S: f64 = 0.1;
const FIRST_COUNT: u32 = 20;
/// Number of payloads needed after a clock step before the delay moves again.
const AGAIN_COUNT: u32 = 500;

/// Settings of the delivery.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PlayoutSettings {
    /// Whether payloads wait for the playout delay; otherwise each is delivered on arrival, unless a newer one was
    /// delivered.
    pub waits: bool,
    /// Added to the percentile, s.
    pub margin_s: f64,
    /// Maximum rate of change of the delay, s per s.
    pub rate: f64,
    /// Maximum number of waiting payloads; with the rate of the stream this limits the delay.
    pub room: usize,
}

impl Default for PlayoutSettings {
    fn default() -> Self {
        Self { waits: true, margin_s: 0.5e-3, rate: 1e-3, room: 2048 }
    }
}

/// A payload that is delivered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DuePayload<'a> {
    /// Number of the payload, from 0.
    pub number: u64,
    /// Time of sending, by their clock, s.
    pub sent_s: f64,
    /// Time since sending, s; the bound of the clock's estimate limits its error.
    pub age_s: f64,
    /// Whether the payload arrived too late.
    pub is_late: bool,
    pub bytes: &'a [u8],
}

/// Counts of payloads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PlayoutCounts {
    /// Delivered.
    pub delivered: u64,
    /// Delivered after their time.
    pub late: u64,
    /// Not received before a newer one was delivered.
    pub lost: u64,
    /// Number of payloads received after a newer one had been delivered; they also count as lost.
    pub stale: u64,
    /// Received in a later datagram than their own.
    pub recovered: u64,
}

/// Largest delays of one part of the statistics.
#[derive(Clone, Copy, Debug)]
struct PlayoutPart {
    /// Descending.
    top_s: [f64; TOP],
    min_s: f64,
    sum_s: f64,
    count: u32,
}

const EMPTY: PlayoutPart = PlayoutPart { top_s: [f64::NEG_INFINITY; TOP], min_s: f64::INFINITY, sum_s: 0.0, count: 0 };

impl PlayoutPart {
    fn add(&mut self, delay_s: f64) {
        self.count += 1;
        self.sum_s += delay_s;
        self.min_s = self.min_s.min(delay_s);
        let place = self.top_s.iter().position(|&top_s| delay_s > top_s);
        if let Some(place) = place {
            self.top_s.copy_within(place..TOP - 1, place + 1);
            self.top_s[place] = delay_s;
        }
    }
}

/// One-way delays of the last seconds; apparent, i.e. including the clocks' offset, s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Delays {
    /// Minimum.
    pub min_s: f64,
    pub mean_s: f64,
    /// 99.9th percentile.
    pub p999_s: f64,
}

#[derive(Clone, Copy, Debug)]
struct PlayoutSlot {
    /// Number of the payload, plus one; 0 if there is none.
    mark: u64,
    sent_s: f64,
    arrived_s: f64,
    len: usize,
}

/// Holds payloads until they are due.
#[derive(Clone, Debug)]
pub struct Playout {
    settings: PlayoutSettings,
    slots: Vec<PlayoutSlot>,
    bytes: Vec<u8>,
    payload_max: usize,
    /// Number of the next payload to deliver, and one more than the highest received.
    next: u64,
    end: u64,
    parts: [PlayoutPart; PARTS],
    part: usize,
    part_begin_s: Option<f64>,
    first_s: Option<f64>,
    /// Current apparent delay, s; `None` before the first delivery.
    delay_s: Option<f64>,
    wanted_s: Option<f64>,
    moved_s: f64,
    /// Payloads needed before the delay moves.
    awaited: u32,
    counts: PlayoutCounts,
}

impl Playout {
    /// Creates an empty buffer with room for payloads of this length (bytes). All memory is allocated here.
    pub fn new(settings: PlayoutSettings, payload_max: usize) -> Self {
        let room = settings.room.clamp(16, 1 << 16);
        Self {
            settings,
            slots: vec![PlayoutSlot { mark: 0, sent_s: 0.0, arrived_s: 0.0, len: 0 }; room],
            bytes: vec![0; room * payload_max],
            payload_max,
            next: 0,
            end: 0,
            parts: [EMPTY; PARTS],
            part: 0,
            part_begin_s: None,
            first_s: None,
            delay_s: None,
            wanted_s: None,
            moved_s: 0.0,
            awaited: 0,
            counts: PlayoutCounts::default(),
        }
    }

    /// Counts of payloads.
    pub const fn counts(&self) -> PlayoutCounts {
        self.counts
    }

    /// Returns the current apparent delay, s; `None` before the first delivery, and if payloads do not wait.
    pub fn delay_s(&self) -> Option<f64> {
        self.delay_s.filter(|_| self.settings.waits)
    }

    /// Returns the target apparent delay, s.
    pub const fn wanted_s(&self) -> Option<f64> {
        self.wanted_s
    }

    /// Returns the number of the last payload in order, plus one.
    pub const fn end(&self) -> u64 {
        self.end
    }

    /// Returns the one-way delays of the last 5 s.
    pub fn delays(&self) -> Option<Delays> {
        let count: u32 = self.parts.iter().map(|part| part.count).sum();
        let sum_s: f64 = self.parts.iter().map(|part| part.sum_s).sum();
        let min_s = self.parts.iter().map(|part| part.min_s).fold(f64::INFINITY, f64::min);
        let p999_s = self.percentile_s(count)?;
        Some(Delays { min_s, mean_s: sum_s / f64::from(count), p999_s })
    }

    /// Called when their clock minus ours has changed by this, s: delays are apparent, so earlier measurements are no
    /// longer valid.
    pub fn clock_stepped(&mut self, by_s: f64) {
        self.delay_s = self.delay_s.map(|delay_s| delay_s - by_s);
        self.wanted_s = self.delay_s;
        self.parts = [EMPTY; PARTS];
        self.awaited = AGAIN_COUNT;
        let room = self.slots.len() as u64;
        for number in self.next..self.end {
            let slot = &mut self.slots[(number % room) as usize];
            slot.sent_s += by_s;
        }
    }

    /// Restarts with the next payload; earlier ones are not delivered.
    pub fn begin(&mut self) {
        self.next = self.end;
        self.parts = [EMPTY; PARTS];
        self.part_begin_s = None;
        self.first_s = None;
        self.delay_s = None;
        self.wanted_s = None;
    }

    /// Adds a received payload: its number, time of sending (s, their clock), time of arrival (s, ours), and whether it
    /// is the newest of its datagram. Duplicates are ignored.
    pub fn insert(&mut self, number: u64, sent_s: f64, arrived_s: f64, is_newest: bool, bytes: &[u8]) {
        let room = self.slots.len() as u64;
        if bytes.len() > self.payload_max || !(sent_s + arrived_s).is_finite() {
            return;
        }
        let index = (number % room) as usize;
        if self.slots[index].mark == number + 1 {
            return;
        }
        if number < self.next {
            // While its slot is remembered, it is certain that the payload had not arrived before.
            self.counts.stale += u64::from(self.next - number <= room && self.slots[index].mark < number + 1);
            self.slots[index].mark = self.slots[index].mark.max(number + 1);
            return;
        }
        if number >= self.next.saturating_add(room) {
            let next = number + 1 - room;
            self.counts.lost += next - self.next;
            self.next = next;
        }
        self.slots[index] = PlayoutSlot { mark: number + 1, sent_s, arrived_s, len: bytes.len() };
        let at = index * self.payload_max;
        self.bytes[at..at + bytes.len()].copy_from_slice(bytes);
        self.end = self.end.max(number + 1);
        self.counts.recovered += u64::from(!is_newest);
        self.note(arrived_s - sent_s, arrived_s);
    }

    fn note(&mut self, delay_s: f64, arrived_s: f64) {
        let begin_s = *self.part_begin_s.get_or_insert(arrived_s);
        self.first_s.get_or_insert(arrived_s);
        if arrived_s - begin_s >= PART_S {
            self.part = (self.part + 1) % PARTS;
            self.parts[self.part] = EMPTY;
            self.part_begin_s = Some(arrived_s);
        }
        self.parts[self.part].add(delay_s);
    }

    /// Returns the percentile of this many payloads, s: the largest delays of all parts, merged.
    fn percentile_s(&self, count: u32) -> Option<f64> {
        let rank = (f64::from(count) * LATE_FRACTION).floor() as usize;
        let mut taken = [0_usize; PARTS];
        let mut percentile_s = None;
        for _ in 0..=rank.min(PARTS * TOP - 1) {
            let heads = self.parts.iter().zip(&taken).enumerate();
            let heads = heads.filter_map(|(i, (part, &taken))| Some((i, *part.top_s.get(taken)?)));
            let (part, delay_s) = heads.max_by(|(_, a), (_, b)| a.total_cmp(b))?;
            taken[part] += 1;
            percentile_s = Some(delay_s);
        }
        percentile_s.filter(|_| count > 0)
    }

    /// Moves the delay towards its target. Call it once per tick, before payloads are taken.
    pub fn advance(&mut self, now_s: f64) {
        let passed_s = (now_s - self.moved_s).clamp(0.0, 0.1);
        self.moved_s = now_s;
        let count: u32 = self.parts.iter().map(|part| part.count).sum();
        if count < self.awaited.max(FIRST_COUNT) {
            return;
        }
        self.awaited = 0;
        let Some(percentile_s) = self.percentile_s(count) else { return };
        let wanted_s = percentile_s + self.settings.margin_s;
        self.wanted_s = Some(wanted_s);
        if let Some(delay_s) = self.delay_s {
            let max_s = self.settings.rate * passed_s;
            self.delay_s = Some(delay_s + (wanted_s - delay_s).clamp(-max_s, max_s));
        } else if self.first_s.is_some_and(|first_s| now_s - first_s >= FIRST_S) {
            self.delay_s = Some(wanted_s);
            self.leave_out(now_s - wanted_s);
        }
    }

    /// Before the first delivery: excludes payloads sent before this time (s, their clock), which served only for
    /// measurement.
    fn leave_out(&mut self, before_s: f64) {
        let room = self.slots.len() as u64;
        let is_wanted = |number: &u64| {
            let slot = &self.slots[(number % room) as usize];
            slot.mark == number + 1 && slot.sent_s >= before_s
        };
        self.next = (self.next..self.end).find(is_wanted).unwrap_or(self.end);
    }

    /// Returns the next payload that is due; `offset_s` is their clock minus ours.
    pub fn take(&mut self, now_s: f64, offset_s: f64) -> Option<DuePayload<'_>> {
        let delay_s = if self.settings.waits { self.delay_s? } else { f64::NEG_INFINITY };
        let room = self.slots.len() as u64;
        // This scans all slots at most, and only after that many payloads were lost.
        let number = (self.next..self.end).find(|number| self.slots[(number % room) as usize].mark == number + 1)?;
        let index = (number % room) as usize;
        let slot = self.slots[index];
        let due_s = slot.sent_s + delay_s;
        if due_s > now_s {
            return None;
        }
        let is_late = self.settings.waits && slot.arrived_s > due_s;
        self.counts.lost += number - self.next;
        self.counts.delivered += 1;
        self.counts.late += u64::from(is_late);
        self.next = number + 1;
        let at = index * self.payload_max;
        let age_s = now_s - (slot.sent_s - offset_s);
        Some(DuePayload { number, sent_s: slot.sent_s, age_s, is_late, bytes: &self.bytes[at..at + slot.len] })
    }
}

#[cfg(test)]
#[path = "playout_tests.rs"]
mod tests;
