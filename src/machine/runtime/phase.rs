//! Prevents the loop from waking just when a sensor sends.
//!
//! A sensor sends on its own clock. If it sends at the moment at which the loop reads, some readings arrive an instant
//! too late, and the forces computed from them a whole period later. The loop then shifts by a quarter of a period,
//! until no device sends at that moment. It shifts by making periods a thousandth longer, which the filters do not
//! notice.

/// Extension of a period while the loop shifts, as one part in this many. A shift then takes a quarter of a second at 1
/// kHz; a jump by a quarter of a period would be a fault of the clock (`teleop::timing`).
const STRETCH: u64 = 1000;
/// Size of a shift: a quarter of a period. Four shifts try every phase.
const MOVES: u32 = 4;
/// Number of ticks over which late ones are counted: one second.
const MEMORY: f64 = 1000.0;
/// Number of late ticks among these that causes a shift: one in a hundred.
const LATE_MAX: f64 = 10.0;
/// Number of ticks at one phase, without too many late ones, until the phase counts as good: 10 s.
const GOOD: u64 = 10_000;
/// A device that sends less often than the loop reads is late at every phase; the search is then repeated after a
/// minute.
const REST: u64 = 60_000;

/// Phase of the loop's wake-ups within the period.
#[derive(Debug)]
pub(super) struct LoopPhase {
    period_ns: u64,
    /// Recent ticks in which a device had no new reading.
    late: f64,
    /// Remainder of the current shift.
    ahead_ns: u64,
    /// Shifts since the last good phase.
    moves: u32,
    /// Ticks since the last shift.
    stood: u64,
}

impl LoopPhase {
    pub(super) const fn new(period_ns: u64) -> Self {
        Self { period_ns, late: 0.0, ahead_ns: 0, moves: 0, stood: 0 }
    }

    /// Returns the extension of the next period, ns. `is_late`: a device had no new reading in this tick.
    pub(super) fn step(&mut self, is_late: bool) -> u64 {
        let stretch_ns = self.ahead_ns.min(self.period_ns / STRETCH);
        if stretch_ns > 0 {
            self.ahead_ns -= stretch_ns;
            return stretch_ns;
        }
        self.stood += 1;
        // A leaky count instead of a window: it needs no history.
        self.late += f64::from(u8::from(is_late)) - self.late / MEMORY;
        if self.stood > GOOD && self.late < LATE_MAX {
            self.moves = 0;
        }
        if self.late > LATE_MAX && (self.moves < MOVES || self.stood > REST) {
            self.late = 0.0;
            self.stood = 0;
            self.moves += 1;
            self.ahead_ns = self.period_ns / u64::from(MOVES);
        }
        0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD_NS: u64 = 1_000_000;

    /// Simulates sensors that send once per `every_ns`, each from its own start, with up to 0.1 ms of delay, and a loop
    /// that adjusts its phase. Returns the ticks in which a sensor had no new reading, and the total shift of the loop,
    /// ns.
    fn late(begins_ns: &[u64], every_ns: u64, ticks: u64) -> (Vec<bool>, u64) {
        let mut random = fastrand::Rng::with_seed(1);
        let mut phase = LoopPhase::new(PERIOD_NS);
        let mut now_ns = 0;
        let mut moved_ns = 0;
        let mut next_ns: Vec<u64> = begins_ns.to_vec();
        let mut tick = || {
            now_ns += PERIOD_NS;
            let mut is_late = false;
            for next_ns in &mut next_ns {
                let mut came = 0;
                while *next_ns + random.u64(0..100_000) <= now_ns {
                    *next_ns += every_ns;
                    came += 1;
                }
                is_late |= came == 0;
            }
            let stretch_ns = phase.step(is_late);
            assert!(stretch_ns <= PERIOD_NS / 1000);
            now_ns += stretch_ns;
            moved_ns += stretch_ns;
            is_late
        };
        ((0..ticks).map(|_| tick()).collect(), moved_ns)
    }

    #[test]
    fn wherever_two_sensors_send_none_of_their_readings_is_late_after_some_seconds() {
        for first in 0..10 {
            for second in 0..10 {
                let (late, moved_ns) = late(&[100_000 * first, 100_000 * second], PERIOD_NS, 20_000);
                let fraction = late[10_000..].iter().filter(|late| **late).count() as f64 / 10_000.0;
                assert!(fraction < 0.01 && moved_ns < PERIOD_NS, "{first}, {second}: {fraction}, {moved_ns}");
            }
        }
    }

    #[test]
    fn without_a_place_that_is_better_the_loop_moves_once_a_minute_at_most() {
        let (_, moved_ns) = late(&[0], 2 * PERIOD_NS, 300_000);
        assert!((PERIOD_NS..3 * PERIOD_NS).contains(&moved_ns), "{moved_ns}");
    }
}
