//! One number of a device: whether it has stopped changing, or is cut off at the end of its range.
//!
//! A number can be missed only if it is known to change. It is judged after it has changed for [`LIVELY_S`] without a rest; then a rest that is
//! [`LONGER`] times the longest one until then is a fault. A number with noise never rests by itself. One without noise (an ideal
//! sensor, or a filter that leaves none) may rest with the arm, or at zero where nothing is touched: it is frozen only if it stops from
//! speed while the arm goes on. What a number was like is learnt a second late, so that a fault does not become what is usual.

/// So long a number must have changed before its rest is a fault, s.
const LIVELY_S: f64 = 3.0;
/// A number that rests for longer is not one that changes all the time, s: data of 40 Hz, repeated at the rate of the line.
const RESTLESS_S: f64 = 0.025;
/// Shortest rest that is a fault, s, and fewest repetitions in it: 10 at 1 kHz, which leaves half of 20 ms to the rest of the path.
pub(super) const FROZEN_S: f64 = 0.010;
const REPEATED: u32 = 3;
/// How much longer than the longest rest so far. If each of n readings repeats the one before with probability p, the longest rest r that is
/// seen has n p^r of about 1, so that one of 2.5 r has a chance of n^-2.5 a reading: 2e-9 after 3 s at 1 kHz.
const LONGER: f64 = 2.5;
/// The longest rest is forgotten with this time constant, s.
const FORGOTTEN_S: f64 = 60.0;
/// A number turns so often a second if it has noise: tremor of 12 Hz turns 24 times, and a product of two such forces 48 times. White noise
/// turns at two of three readings.
const NOISY_TURNS: f64 = 60.0;
/// Or at this share of the readings of a slow device.
const NOISY_SHARE: f64 = 0.35;
/// Longest rest of a number without noise that is fine enough to be judged, s.
const FINE_S: f64 = 0.003;
/// It stopped from speed if its last step was so many times its smallest one: what comes to rest by itself passes through small steps.
const FROM_SPEED: f64 = 20.0;
/// The arm goes on if its tip went so far meanwhile, m: an arm that comes to rest goes less.
const STIRRED_M: f64 = 1e-6;
/// A force changes over this way, m: at the tip by 0.1 N on the softest tissue (100 N/m), at a wrist with the direction of the weight.
const FAR_M: f64 = 1e-3;
/// What is learnt is taken over by periods of this length, s, the last but one at the end of each.
const LEARNT_S: f64 = 1.0;
/// The end of the range: so many hits of the same extreme number, never with more than [`APART`] others between two of them. Noise of s counts
/// hits its extreme again with a chance of about 1/s: eight times 1e-7 for the worst, s = 10, which is mostly found to be [`COARSE`] first.
const HITS: u32 = 8;
const APART: u32 = 20;
/// So many hits happen to a number with few values; it is not judged for [`LIVELY_S`].
const COARSE: u32 = 3;

/// What surrounds a number.
#[derive(Clone, Copy, Debug)]
pub(super) struct Around {
    /// Way of the tip so far, m.
    pub(super) way_m: f64,
    /// The number is a force or a torque: then it changes with the way of the tip, though it has no noise.
    pub(super) is_load: bool,
    /// Shortest rest that is a fault, s.
    pub(super) shortest_s: f64,
}

/// What is wrong with a number or a reading; the first cause comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Wrong {
    Frozen,
    Repeats,
    Saturated,
}

/// An extreme value of the last readings.
#[derive(Clone, Copy, Debug)]
struct Extreme {
    at: f64,
    hits: u32,
    ago: u32,
}

impl Extreme {
    const NONE: Self = Self { at: f64::NAN, hits: 0, ago: 0 };

    const fn is_at(&self, value: f64) -> bool {
        value.to_bits() == self.at.to_bits()
    }

    /// Takes the next value, for the lower extreme its negative; whether an extreme ended that was hit too often for a number with noise.
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

/// The memory of one number.
#[derive(Clone, Copy, Debug)]
pub(super) struct Channel {
    last: f64,
    last_step: f64,
    /// The smallest step since it has been lively.
    least_step: f64,
    /// Since when it has this value: time and way of the tip.
    since_s: f64,
    since_m: f64,
    repeats: u32,
    /// Since when it has not rested for longer than [`RESTLESS_S`].
    lively_since_s: f64,
    longest_s: f64,
    /// What was seen in this period and in the one before: the longest rest, and whether an extreme was hit too often for noise.
    seen: [(f64, bool); 2],
    learns_s: f64,
    /// Turns and changes of about the last second.
    turns: f64,
    changes: f64,
    extremes: [Extreme; 2],
    coarse_s: f64,
    t_s: f64,
}

impl Channel {
    pub(super) const NONE: Self = Self {
        last: f64::NAN,
        last_step: 0.0,
        least_step: f64::INFINITY,
        since_s: 0.0,
        since_m: 0.0,
        repeats: 0,
        lively_since_s: 0.0,
        longest_s: 0.0,
        seen: [(0.0, false); 2],
        learns_s: 0.0,
        turns: 0.0,
        changes: 0.0,
        extremes: [Extreme::NONE; 2],
        coarse_s: 0.0,
        t_s: 0.0,
    };

    /// Takes the number of a new reading at `t_s`; NaN is no number.
    pub(super) fn look(&mut self, now: f64, t_s: f64, around: &Around) -> Option<Wrong> {
        if now.is_nan() || self.last.is_nan() {
            let since_s = t_s;
            let since_m = around.way_m;
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
            self.repeats += 1;
            self.rest(t_s, around)
        } else {
            self.change(now, t_s, around);
            false
        };
        self.t_s = t_s;
        let is_saturated = self.is_saturated(now, t_s);
        if is_frozen { Some(Wrong::Frozen) } else { is_saturated.then_some(Wrong::Saturated) }
    }

    fn learn(&mut self, t_s: f64) {
        if t_s - self.learns_s < LEARNT_S {
            return;
        }
        let [newest, (rested_s, is_coarse)] = self.seen;
        let kept = (1.0 - LEARNT_S / FORGOTTEN_S).max(0.0);
        self.longest_s = rested_s.max(self.longest_s * kept);
        self.coarse_s = if is_coarse { t_s } else { self.coarse_s };
        self.seen = [(0.0, false), newest];
        self.learns_s = t_s;
    }

    /// It has rested: from now on it must be lively for a while again.
    fn begin(&mut self, t_s: f64) {
        self.lively_since_s = t_s;
        self.longest_s = 0.0;
        self.least_step = f64::INFINITY;
        self.seen = [(0.0, false); 2];
    }

    fn is_lively(&self) -> bool {
        self.since_s - self.lively_since_s >= LIVELY_S
    }

    fn is_noisy(&self) -> bool {
        self.turns >= NOISY_TURNS.min(NOISY_SHARE * self.changes)
    }

    /// Whether the rest that goes on is a fault.
    fn rest(&mut self, t_s: f64, around: &Around) -> bool {
        let stood_s = t_s - self.since_s;
        if !self.is_lively() {
            if stood_s > RESTLESS_S && self.repeats > 1 {
                self.begin(t_s);
            }
            return false;
        }
        // Sums of intervals are exact to some 1e-12 s.
        let is_long = stood_s >= around.shortest_s.max(LONGER * self.longest_s) - 1e-9 && self.repeats >= REPEATED;
        is_long && (self.is_noisy() || self.stopped_from_speed(around))
    }

    fn stopped_from_speed(&self, around: &Around) -> bool {
        let way_m = around.way_m - self.since_m;
        let is_judged = around.is_load && self.last != 0.0 && self.longest_s <= FINE_S && way_m > STIRRED_M;
        is_judged && (self.last_step.abs() >= FROM_SPEED * self.least_step || way_m > FAR_M)
    }

    fn change(&mut self, now: f64, t_s: f64, around: &Around) {
        let rested_s = self.t_s - self.since_s;
        let dt_s = t_s - self.since_s;
        if rested_s > RESTLESS_S && self.repeats > 1 {
            self.begin(t_s);
        } else {
            self.seen[0].0 = self.seen[0].0.max(rested_s);
        }
        let step = now - self.last;
        let kept = (1.0 - dt_s).max(0.0);
        self.turns = self.turns * kept + f64::from(u8::from(step * self.last_step < 0.0));
        self.changes = self.changes * kept + 1.0;
        self.least_step = self.least_step.min(step.abs());
        self.last = now;
        self.last_step = step;
        self.since_s = t_s;
        self.since_m = around.way_m;
        self.repeats = 0;
    }

    fn is_saturated(&mut self, now: f64, t_s: f64) -> bool {
        let [high, low] = &mut self.extremes;
        self.seen[0].1 |= high.look(now) | low.look(-now);
        // A number that rests is judged by its rest.
        let often = HITS.max(self.repeats + 2);
        let hit = (high.is_at(now) && high.hits >= often) || (low.is_at(-now) && low.hits >= often);
        hit && t_s - self.coarse_s >= LIVELY_S && self.is_lively() && self.is_noisy()
    }
}
