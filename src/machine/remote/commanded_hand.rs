//! The hand at the other end, as used by the loop here.

use nalgebra::Vector3;

/// After a gap, the tip catches up at this speed at most, m/s, or at the hand's own speed if that is faster, so that a
/// tip never moves faster than a hand.
/// Above the fastest hand that a rig file permits (`desk.speed_m_s`, 0.15 m/s), so that every gap is caught up.
const CATCH_UP_M_S: f64 = 0.18;

/// Moves by the commanded displacements, and only while they are to be followed, so that a restart is not a jump.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CommandedHand {
    position_m: Vector3<f64>,
    /// Commanded displacement that has not been executed yet, m.
    behind_m: Vector3<f64>,
    speed_m_s: f64,
}

impl CommandedHand {
    pub(super) const fn position_m(&self) -> Vector3<f64> {
        self.position_m
    }

    /// Adds a displacement (m) that took this time (s).
    pub(super) fn report(&mut self, moved_m: &Vector3<f64>, over_s: f64) {
        self.behind_m += moved_m;
        self.speed_m_s = if over_s > 0.0 { moved_m.norm() / over_s } else { 0.0 };
    }

    pub(super) fn rest(&mut self) {
        self.behind_m = Vector3::zeros();
    }

    /// Advances by one period of the loop.
    pub(super) fn advance(&mut self, period_s: f64) {
        // Slightly more than the hand's speed, because the time stamps of messages are rounded.
        let max_m = CATCH_UP_M_S.max(1.001 * self.speed_m_s) * period_s;
        let behind_m = self.behind_m.norm();
        let fraction = if behind_m > max_m { max_m / behind_m } else { 1.0 };
        let step_m = self.behind_m * fraction;
        self.position_m += step_m;
        self.behind_m -= step_m;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD_S: f64 = 1e-3;

    #[test]
    fn a_hand_that_is_told_of_in_every_tick_is_where_it_is_told_to_be() {
        let mut hand = CommandedHand::default();
        for tick in 1..500 {
            hand.report(&Vector3::new(0.8e-3, 0.0, 0.0), PERIOD_S);
            hand.advance(PERIOD_S);
            assert!((hand.position_m().x - 0.8e-3 * f64::from(tick)).abs() < 1e-12, "0.8 m/s is not a gap");
        }
    }

    #[test]
    fn what_was_missed_in_a_gap_is_made_up_for_without_a_step() {
        let mut hand = CommandedHand::default();
        let mut reported_m = 0.0;
        let mut before_m = 0.0;
        for tick in 0..400 {
            // Moves at 120 mm/s, with 50 ms of silence.
            if !(100..150).contains(&tick) {
                let ticks = if tick == 150 { 51.0 } else { 1.0 };
                hand.report(&Vector3::new(0.12e-3 * ticks, 0.0, 0.0), ticks * PERIOD_S);
                reported_m += 0.12e-3 * ticks;
            }
            hand.advance(PERIOD_S);
            let position_m = hand.position_m().x;
            assert!((0.0..0.19e-3).contains(&(position_m - before_m)), "{tick}: {}", position_m - before_m);
            before_m = position_m;
            assert!(tick < 260 || (position_m - reported_m).abs() < 1e-9, "{tick}: {position_m} of {reported_m}");
        }
    }

    #[test]
    fn what_is_not_followed_any_more_is_forgotten() {
        let mut hand = CommandedHand::default();
        hand.report(&Vector3::new(0.01, 0.0, 0.0), 0.05);
        hand.advance(PERIOD_S);
        let position_m = hand.position_m();
        hand.rest();
        hand.advance(PERIOD_S);
        assert_eq!(hand.position_m(), position_m);
    }
}
