//! The virtual clock: the times at which the loop wakes, as on a real computer.
//!
//! A [`ClockProfile`] defines how late wake-ups are; [`TickTimes`] draws them from a seed and turns them into ticks by
//! the rules of the real clock: whole periods that have passed are counted and skipped, and a tick has the time of its
//! wake-up.

use std::{fmt, str::FromStr};

use nima_core::noise::Noise;
use serde::Serialize;

use super::jitter;
use crate::teleop::Timing;

/// Lateness of a tick of [`ClockProfile::Late`], us: uniform in this range.
const LATE_US: [f64; 2] = [500.0, 4000.0];
/// Time from one pause of [`ClockProfile::Stall`] to the next, s; uniformly distributed in this range.
const STALL_EVERY_S: [f64; 2] = [0.5, 1.5];
/// Maximum fraction of late ticks, %, and maximum pause, ms, of a profile.
const LATE_MAX_PERCENT: f64 = 50.0;
const STALL_MAX_MS: u16 = 1000;

/// Lateness of the virtual clock's wake-ups.
///
/// ```
/// use nima_machine::runtime::ClockProfile;
///
/// let profile: ClockProfile = "late-0.1".parse()?;
/// assert_eq!(profile, ClockProfile::Late { percent: 0.1 });
/// assert!(ClockProfile::ALL.iter().all(|profile| profile.to_string().parse() == Ok(*profile)));
/// # Ok::<(), nima_machine::runtime::ParseClockProfileError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ClockProfile {
    #[default]
    Perfect,
    /// As recorded on an otherwise idle computer.
    Quiet,
    /// As recorded on a computer whose processors are busy with other work.
    Busy,
    /// This percentage of ticks is 0.5 to 4 ms late, independently of each other; all others wake at their deadline.
    Late { percent: f64 },
    /// About once per second, the loop pauses for this time, ms; all other ticks wake at their deadline.
    Stall { ms: u16 },
}

impl ClockProfile {
    /// The profiles of the studies, in display order.
    pub const ALL: [Self; 9] = [
        Self::Perfect,
        Self::Quiet,
        Self::Busy,
        Self::Late { percent: 0.1 },
        Self::Late { percent: 1.0 },
        Self::Late { percent: 5.0 },
        Self::Stall { ms: 5 },
        Self::Stall { ms: 20 },
        Self::Stall { ms: 100 },
    ];
}

impl fmt::Display for ClockProfile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Perfect => f.pad("perfect"),
            Self::Quiet => f.pad("quiet"),
            Self::Busy => f.pad("busy"),
            Self::Late { percent } => f.pad(&format!("late-{percent}")),
            Self::Stall { ms } => f.pad(&format!("stall-{ms}")),
        }
    }
}

impl Serialize for ClockProfile {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// A text that is not the name of a clock profile.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "unknown clock profile \"{0}\": use perfect, quiet, busy, late-PERCENT (up to {LATE_MAX_PERCENT}), \
     or stall-MS (1 to {STALL_MAX_MS})"
)]
pub struct ParseClockProfileError(String);

impl FromStr for ClockProfile {
    type Err = ParseClockProfileError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let of_number = || {
            if let Some(percent) = text.strip_prefix("late-") {
                let percent = percent.parse().ok().filter(|percent| *percent > 0.0 && *percent <= LATE_MAX_PERCENT);
                return percent.map(|percent| Self::Late { percent });
            }
            let ms = text.strip_prefix("stall-")?.parse().ok();
            ms.filter(|ms| (1..=STALL_MAX_MS).contains(ms)).map(|ms| Self::Stall { ms })
        };
        match text {
            "perfect" => Ok(Self::Perfect),
            "quiet" => Ok(Self::Quiet),
            "busy" => Ok(Self::Busy),
            _ => of_number().ok_or_else(|| ParseClockProfileError(text.to_owned())),
        }
    }
}

/// A virtual clock: a profile and the seed of its random numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct VirtualClock {
    pub profile: ClockProfile,
    pub seed: u64,
}

impl VirtualClock {
    pub const PERFECT: Self = Self { profile: ClockProfile::Perfect, seed: 0 };

    /// Returns the times of the ticks of a loop with this rate, from the first one on.
    pub fn tick_times(self, rate_hz: f64) -> TickTimes {
        TickTimes::new(self.profile, self.seed, rate_hz)
    }
}

/// Time of one tick on the loop's clock.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TickTime {
    /// Loop time at which the tick woke, s.
    pub now_s: f64,
    /// Delay of the wake-up after its deadline, s, including whole periods.
    pub wake_s: f64,
    /// Number of whole periods that passed just before this tick and were skipped.
    pub missed: u64,
}

impl TickTime {
    /// Writes this time into the timing of a tick.
    pub(super) const fn enter(self, timing: &mut Timing) {
        timing.now_s = self.now_s;
        timing.wake_s = self.wake_s;
        timing.missed_now = self.missed;
    }
}

/// A tick at its deadline, at this loop time, s.
impl From<f64> for TickTime {
    fn from(now_s: f64) -> Self {
        Self { now_s, ..Self::default() }
    }
}

impl From<TickTime> for Timing {
    fn from(time: TickTime) -> Self {
        let mut timing = Self::default();
        time.enter(&mut timing);
        timing
    }
}

/// Returns the whole periods that passed before a wake-up with this lateness, and the remainder, ns. Both clocks skip
/// these periods: executing them late would cause a burst of ticks.
pub(super) const fn skip(late_ns: u64, period_ns: u64) -> (u64, u64) {
    (late_ns / period_ns, late_ns % period_ns)
}

/// The times of a loop's ticks on a virtual clock. Nothing is allocated after construction.
///
/// ```
/// use nima_machine::runtime::{ClockProfile, TickTimes};
///
/// let mut times = TickTimes::new(ClockProfile::Stall { ms: 20 }, 1, 1000.0);
/// let missed: u64 = (0..10_000).map(|_| times.advance().missed).sum();
/// assert!(missed > 100, "some pauses of 19 or 20 periods: {missed}");
/// ```
#[derive(Clone, Debug)]
pub struct TickTimes {
    profile: ClockProfile,
    random: Noise,
    /// State of a recorded distribution.
    state: usize,
    /// Time of the next pause, s.
    stall_s: f64,
    period_s: f64,
    period_ns: u64,
    /// Deadline of the next tick, in periods since the clock began.
    deadline: u64,
}

impl TickTimes {
    /// Creates the times of a loop with this rate, from time 0 on.
    pub fn new(profile: ClockProfile, seed: u64, rate_hz: f64) -> Self {
        let mut random = Noise::new(seed ^ 0x71_c4);
        let stall_s = within(STALL_EVERY_S, random.uniform());
        let period_ns = (1e9 / rate_hz).round() as u64;
        Self { profile, random, state: 0, stall_s, period_s: 1.0 / rate_hz, period_ns, deadline: 0 }
    }

    pub fn advance(&mut self) -> TickTime {
        let late_ns = self.late_ns();
        let (missed, rest_ns) = skip(late_ns, self.period_ns);
        self.deadline += missed;
        let now_s = self.deadline as f64 * self.period_s + rest_ns as f64 * 1e-9;
        self.deadline += 1;
        TickTime { now_s, wake_s: late_ns as f64 * 1e-9, missed }
    }

    /// Returns the periods since the clock began: executed ticks and skipped ones.
    pub const fn periods(&self) -> u64 {
        self.deadline
    }

    fn late_ns(&mut self) -> u64 {
        let Self { random, state, .. } = self;
        match self.profile {
            ClockProfile::Perfect => 0,
            ClockProfile::Quiet => jitter::QUIET.late_ns(state, random),
            ClockProfile::Busy => jitter::BUSY.late_ns(state, random),
            ClockProfile::Late { percent } => {
                let is_late = random.uniform() < 1e-2 * percent;
                let late_us = within(LATE_US, random.uniform());
                if is_late { (1e3 * late_us).round() as u64 } else { 0 }
            }
            ClockProfile::Stall { ms } => self.stalled_ns(ms),
        }
    }

    /// Returns the position of a pause, which starts anywhere in the period before the deadline at which it is
    /// detected.
    fn stalled_ns(&mut self, ms: u16) -> u64 {
        let deadline_s = self.deadline as f64 * self.period_s;
        if deadline_s < self.stall_s {
            return 0;
        }
        let pause_s = 1e-3 * f64::from(ms);
        self.stall_s = deadline_s + pause_s + within(STALL_EVERY_S, self.random.uniform());
        (1e9 * (pause_s - self.period_s * self.random.uniform()).max(0.0)).round() as u64
    }
}

/// Returns the value at this fraction of a range.
fn within([low, high]: [f64; 2], part: f64) -> f64 {
    low + (high - low) * part
}

#[cfg(test)]
mod tests;
