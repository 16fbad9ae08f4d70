//! Third gate: the paper's rule that no force is rendered below 1 mm/s, with a smooth edge and hysteresis to prevent
//! chatter.

// Larger values keep the force longer after a stop; smaller ones let tremor, which stands still twice a period,
// switch it.
/// Time constant with which the effective speed falls, s. Design choice.
const FALL_S: f64 = 0.040;
/// Upper limit of the effective speed, in thresholds: even a fast hand that stops closes the gate within 0.1 s.
const FAST: f64 = 8.0;

/// Speed gate: 0 below the threshold, 1 above twice the threshold, smooth in between.
///
/// The hysteresis works like the play of a loose gear: a rising speed counts unchanged; a falling speed counts as up to
/// half a threshold higher, and falls slowly. The gate therefore begins to open at the threshold and closes again only
/// below half of it.
#[derive(Clone, Copy, Debug)]
pub struct DeadBand {
    /// Speed at which the gate begins to open, m/s (the paper's 1 mm/s). At zero the gate is always open.
    pub threshold_m_s: f64,
    /// Recent speed, m/s, which rises at once and falls slowly, so that a trembling hand does not switch its force
    /// twenty times a second.
    lately_m_s: f64,
    counted_m_s: f64,
}

impl DeadBand {
    /// Creates a closed gate with this threshold (m/s).
    pub const fn new(threshold_m_s: f64) -> Self {
        Self { threshold_m_s, lately_m_s: 0.0, counted_m_s: 0.0 }
    }

    /// Returns the fraction of the force that passes at this speed (m/s), `dt_s` (s) after the last call, 0 to 1. A NaN
    /// speed closes the gate.
    pub fn step(&mut self, speed_m_s: f64, dt_s: f64) -> f64 {
        // Not a division by the threshold: the operator may set it to zero.
        if self.threshold_m_s <= 0.0 {
            return 1.0;
        }
        if !speed_m_s.is_finite() {
            // The memory is cleared too; otherwise NaN would stay in the average for ever.
            self.lately_m_s = 0.0;
            self.counted_m_s = 0.0;
            return 0.0;
        }
        // First-order low-pass in the form that stays stable for any `dt_s`.
        let fallen_m_s = self.lately_m_s + (speed_m_s - self.lately_m_s) * (dt_s / (FALL_S + dt_s));
        self.lately_m_s = fallen_m_s.max(speed_m_s).clamp(0.0, FAST * self.threshold_m_s);
        let play_m_s = 0.5 * self.threshold_m_s;
        // `counted` may be up to half a threshold above the recent speed: this range is the play.
        self.counted_m_s = self.counted_m_s.clamp(self.lately_m_s, self.lately_m_s + play_m_s);
        let s = (self.counted_m_s / self.threshold_m_s - 1.0).clamp(0.0, 1.0);
        // A smooth step, so that the force has no kink at either end.
        s * s * (3.0 - 2.0 * s)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Returns the fraction that passes once a hand has moved at this speed for half a second.
    fn settled(gate: &mut DeadBand, speed_m_s: f64) -> f64 {
        (0..500).map(|_| gate.step(speed_m_s, 1e-3)).last().unwrap()
    }

    proptest! {
        #[test]
        fn shut_below_half_open_above_double_whatever_came_before(
            before in prop::collection::vec(prop::num::f64::ANY, 0..50), slow in 0.0..0.49e-3f64, fast in 2e-3..10.0f64,
        ) {
            let mut gate = DeadBand::new(1e-3);
            for speed_m_s in before {
                let fraction = gate.step(speed_m_s, 1e-3);
                prop_assert!((0.0..=1.0).contains(&fraction) && (speed_m_s.is_finite() || fraction == 0.0));
            }
            prop_assert!(settled(&mut gate, slow) == 0.0);
            prop_assert!(gate.step(fast, 1e-3) >= 1.0, "it opens at once");
        }
    }

    #[test]
    fn passes_nothing_below_and_everything_well_above_the_threshold() {
        let mut gate = DeadBand::new(1e-3);
        assert!(settled(&mut gate, 0.9e-3).abs() < f64::EPSILON);
        assert!((gate.step(2e-3, 1e-3) - 1.0).abs() < f64::EPSILON);
        assert!(settled(&mut gate, 0.7e-3) > 0.0, "hysteresis keeps it open down to half the threshold");
        assert!(settled(&mut gate, 0.4e-3).abs() < f64::EPSILON);
        assert!(settled(&mut gate, 0.7e-3).abs() < f64::EPSILON, "and closed until the threshold is reached again");
    }

    #[test]
    fn a_hand_that_turns_round_keeps_its_force_and_one_that_stops_loses_it() {
        let mut gate = DeadBand::new(1e-3);
        gate.step(5e-3, 1e-3);
        assert!((0..25).all(|_| gate.step(0.0, 1e-3) > 0.9));
        gate.step(1.0, 1e-3);
        let ticks = (0..1000).position(|_| gate.step(0.0, 1e-3) <= 0.0).unwrap();
        assert!(ticks < 130, "{ticks} ms");
    }

    #[test]
    fn it_never_jumps() {
        let mut gate = DeadBand::new(1e-3);
        let mut last = 0.0;
        for i in 0..20_000 {
            // Moves up and down through both edges, in steps of at most 0.3 um/s.
            let fraction = gate.step(1.5e-3 * (1.0 - (f64::from(i) * 2e-4).cos()), 1e-3);
            assert!((fraction - last).abs() < 1e-3, "from {last} to {fraction}");
            last = fraction;
        }
    }

    #[test]
    fn a_speed_that_is_no_number_closes_it() {
        let mut gate = DeadBand::new(1e-3);
        gate.step(1.0, 1e-3);
        assert!(gate.step(f64::NAN, 1e-3).abs() < f64::EPSILON);
    }
}
