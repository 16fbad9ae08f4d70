//! One number of a device: has it stopped changing, or is it cut off at the end of its range?
//!
//! A missing change can be detected only in a number that is known to change. A number is judged after it has changed
//! for [`LIVELY_S`] without a rest; a rest that is then [`LONGER`] times the longest previous rest is a fault. A number
//! with noise never rests by itself. A number without noise (from an ideal sensor, or behind a filter that removes all
//! noise) may rest with the arm, or at zero without contact: it counts as frozen only if it stops from speed while the
//! arm keeps moving. The properties of a number are updated with a delay of one second, so that a fault does not become
//! normal behaviour.

/// Time for which a number must have changed before its rest is a fault, s. Design choice, with no false alarm in 136
/// healthy minutes (`docs/results/faults.md`).
const LIVELY_S: f64 = 3.0;
/// A number that rests for longer does not change continuously, s: data of 40 Hz, repeated at the rate of the
/// connection.
const RESTLESS_S: f64 = 0.025;
/// Shortest rest that is a fault, s, and the minimum number of repetitions in it: 10 at 1 kHz, which leaves half of the
/// 20 ms for the rest of the path.
pub(super) const FROZEN_S: f64 = 0.010;
const REPEATED: u32 = 3;
/// Factor by which a faulty rest exceeds the longest rest so far. If each of n readings repeats the one before with
/// probability p, the longest observed rest r satisfies n p^r = 1 approximately, so that a rest of 2.5 r has a
/// probability of n^-2.5 per reading: 2e-9 after 3 s at 1 kHz.
const LONGER: f64 = 2.5;
/// Time constant with which the longest rest is forgotten, s, so that one long rest does not hide faults for the rest
/// of the day. Design choice.
const FORGOTTEN_S: f64 = 60.0;
/// A number counts as noisy if it changes direction this often per second: tremor of 12 Hz does so 24 times, and a
/// product of two such forces 48 times. White noise does so in two of three readings.
const NOISY_TURNS: f64 = 60.0;
/// A number of a slow device counts as noisy if it changes direction in this fraction of the readings. White noise does
/// so in two of three. Design choice, with no false alarm in 136 healthy minutes (`docs/results/faults.md`).
const NOISY_FRACTION: f64 = 0.35;
/// Longest rest of a noise-free number whose resolution is fine enough for a judgement, s. A coarser one cannot be
/// distinguished from a frozen one within the 20 ms. Design choice.
const FINE_S: f64 = 0.003;
/// A number has stopped from speed if its last step was this many times its smallest step: a number that comes to rest
/// on its own passes through small steps.
const FROM_SPEED: f64 = 20.0;
/// The arm keeps moving if its tip has travelled this far in the meantime, m: an arm that comes to rest travels less.
const STIRRED_M: f64 = 1e-6;
/// A force changes over this much travel, m: at the tip by 0.1 N on the softest tissue (100 N/m), at a wrist with the
/// direction of the weight.
const FAR_M: f64 = 1e-3;
/// Learned properties are updated in periods of this length, s: at the end of each, from the last period but one.
const LEARNT_S: f64 = 1.0;
/// The end of the range is detected by this many hits of the same extreme number, with at most [`APART`] other readings
/// between two of them. Noise of s counts hits its extreme again with a probability of about 1/s: eight hits have 1e-7
/// in the worst case, s = 10, which is usually classified as [`COARSE`] first.
const HITS: u32 = 8;
const APART: u32 = 20;
/// A number with few distinct values reaches this many hits; it is not judged for [`LIVELY_S`].
const COARSE: u32 = 3;

#[derive(Clone, Copy, Debug)]
pub(super) struct Around {
    /// Travel of the tip so far, m.
    pub(super) travel_m: f64,
    /// Whether the number is a force or a torque: these change with the travel of the tip even without noise.
    pub(super) is_load: bool,
    /// Shortest rest that is a fault, s.
    pub(super) shortest_s: f64,
}

/// Fault of a number or a reading; the order gives the priority of the causes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum ReadingFault {
    Frozen,
    Repeats,
    Saturated,
}

#[derive(Clone, Copy, Debug)]
struct ChannelExtreme {
    at: f64,
    hits: u32,
    ago: u32,
}

impl ChannelExtreme {
    const NONE: Self = Self { at: f64::NAN, hits: 0, ago: 0 };

    const fn is_at(&self, value: f64) -> bool {
        // Bits instead of `==`: -0.0 and 0.0 are different readings, and NaN is equal to itself.
        value.to_bits() == self.at.to_bits()
    }

    /// Adds the next value (for the lower extreme, its negative). Returns whether an extreme has ended that was hit too
    /// often for a noisy number.
    fn look(&mut self, value: f64) -> bool {
        if self.is_at(value) {
            self.hits += 1;
            self.ago = 0;
            return false;
        }
        self.ago += 1;
        if value > self.at || self.at.is_nan() || self.ago > APART {
            let coarse = self.hits >= COARSE;
            *self = Self { at: value, hits: 1, ago: 0 };
            return coarse;
        }
        false
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) struct PlausibilityChannel {
    last: f64,
    last_step: f64,
    min_step: f64,
    /// Time, and travel of the tip, when the number took its current value.
    since_s: f64,
    since_m: f64,
    repeats: u32,
    /// Time since which the number has not rested for longer than [`RESTLESS_S`].
    lively_since_s: f64,
    longest_s: f64,
    /// Observations of this period and the previous one: the longest rest, and whether an extreme was hit too often for
    /// noise.
    seen: [(f64, bool); 2],
    learns_s: f64,
    /// Turns and changes within about the last second.
    turns: f64,
    changes: f64,
    extremes: [ChannelExtreme; 2],
    coarse_s: f64,
    t_s: f64,
}

impl PlausibilityChannel {
    pub(super) const NONE: Self = Self {
        last: f64::NAN,
        last_step: 0.0,
        min_step: f64::INFINITY,
        since_s: 0.0,
        since_m: 0.0,
        repeats: 0,
        lively_since_s: 0.0,
        longest_s: 0.0,
        seen: [(0.0, false); 2],
        learns_s: 0.0,
        turns: 0.0,
        changes: 0.0,
        extremes: [ChannelExtreme::NONE; 2],
        coarse_s: 0.0,
        t_s: 0.0,
    };

    /// Adds the number of a new reading at `t_s`; NaN represents a missing number.
    pub(super) fn look(&mut self, now: f64, t_s: f64, around: &Around) -> Option<ReadingFault> {
        // A missing number starts the memory again, because the number that returns may behave differently.
        if now.is_nan() || self.last.is_nan() {
            let since_s = t_s;
            let since_m = around.travel_m;
            *self = Self {
                last: now,
                since_s,
                since_m,
                lively_since_s: t_s,
                coarse_s: t_s,
                learns_s: t_s,
                t_s,
                ..Self::NONE
            };
            return None;
        }
        self.learn(t_s);
        let is_frozen = if now.to_bits() == self.last.to_bits() {
            // See `REPEATED`: a rest is judged by its time and by the number of equal readings.
            self.repeats += 1;
            self.rest(t_s, around)
        } else {
            self.change(now, t_s, around);
            false
        };
        self.t_s = t_s;
        let is_saturated = self.is_saturated(now, t_s);
        if is_frozen { Some(ReadingFault::Frozen) } else { is_saturated.then_some(ReadingFault::Saturated) }
    }

    fn learn(&mut self, t_s: f64) {
        if t_s - self.learns_s < LEARNT_S {
            return;
        }
        let [newest, (rested_s, is_coarse)] = self.seen;
        // Fraction that remains after one period of learning.
        let kept = (1.0 - LEARNT_S / FORGOTTEN_S).max(0.0);
        self.longest_s = rested_s.max(self.longest_s * kept);
        self.coarse_s = if is_coarse { t_s } else { self.coarse_s };
        self.seen = [(0.0, false), newest];
        self.learns_s = t_s;
    }

    /// Restarts after a rest: the number must be lively for a while again.
    fn begin(&mut self, t_s: f64) {
        self.lively_since_s = t_s;
        self.longest_s = 0.0;
        self.min_step = f64::INFINITY;
        self.seen = [(0.0, false); 2];
    }

    fn is_lively(&self) -> bool {
        self.since_s - self.lively_since_s >= LIVELY_S
    }

    fn is_noisy(&self) -> bool {
        self.turns >= NOISY_TURNS.min(NOISY_FRACTION * self.changes)
    }

    fn rest(&mut self, t_s: f64, around: &Around) -> bool {
        let stood_s = t_s - self.since_s;
        // A long rest before the number became lively shows a slow source (40 Hz data), so the clock starts again.
        if !self.is_lively() {
            if stood_s > RESTLESS_S && self.repeats > 1 {
                self.begin(t_s);
            }
            return false;
        }
        // Sums of intervals are exact to about 1e-12 s.
        let is_long = stood_s >= around.shortest_s.max(LONGER * self.longest_s) - 1e-9 && self.repeats >= REPEATED;
        is_long && (self.is_noisy() || self.stopped_from_speed(around))
    }

    fn stopped_from_speed(&self, around: &Around) -> bool {
        let travel_m = around.travel_m - self.since_m;
        let is_judged = around.is_load && self.last != 0.0 && self.longest_s <= FINE_S && travel_m > STIRRED_M;
        is_judged && (self.last_step.abs() >= FROM_SPEED * self.min_step || travel_m > FAR_M)
    }

    fn change(&mut self, now: f64, t_s: f64, around: &Around) {
        let rested_s = self.t_s - self.since_s;
        // `dt_s` ends now; `rested_s` ends at the last reading before the change.
        let dt_s = t_s - self.since_s;
        if rested_s > RESTLESS_S && self.repeats > 1 {
            self.begin(t_s);
        } else {
            self.seen[0].0 = self.seen[0].0.max(rested_s);
        }
        let step = now - self.last;
        // A window of about one second: the factor loses everything older than that.
        let kept = (1.0 - dt_s).max(0.0);
        self.turns = self.turns * kept + f64::from(u8::from(step * self.last_step < 0.0));
        // Decayed with the same factor as the turns, so their ratio stays a fraction.
        self.changes = self.changes * kept + 1.0;
        self.min_step = self.min_step.min(step.abs());
        self.last = now;
        self.last_step = step;
        self.since_s = t_s;
        self.since_m = around.travel_m;
        self.repeats = 0;
    }

    fn is_saturated(&mut self, now: f64, t_s: f64) -> bool {
        let [high, low] = &mut self.extremes;
        self.seen[0].1 |= high.look(now) | low.look(-now);
        // More hits than repeats are required: a value that stays at an extreme is judged by `rest`.
        let often = HITS.max(self.repeats + 2);
        let hit = (high.is_at(now) && high.hits >= often) || (low.is_at(-now) && low.hits >= often);
        hit && t_s - self.coarse_s >= LIVELY_S && self.is_lively() && self.is_noisy()
    }
}
