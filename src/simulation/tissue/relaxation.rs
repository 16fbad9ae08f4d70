//! Tissue whose force fades under constant depth.

use crate::scene::Relaxation;

/// Steps that differ by less than this count as equally long, s.
const ROUNDING_S: f64 = 1e-9;

/// The state of tissue that relaxes: quasi-linear viscoelasticity (Fung, Biomechanics, 1993, section 7.6) with one exponential, which is the
/// standard linear solid where the elastic force is linear in the depth.
#[derive(Clone, Copy, Debug)]
pub(super) struct RelaxationState {
    config: Relaxation,
    /// Length of a step, s.
    step_s: f64,
    /// Fraction of the distance to the elastic force that remains after a step.
    decay: f64,
    /// Weight of the elastic force over a step, which depends on its course within the step.
    ramp: f64,
    elastic_n: f64,
    relaxed_n: f64,
}

impl RelaxationState {
    /// Creates the state at rest, for steps of this length.
    pub(super) fn new(config: Relaxation, step_s: f64) -> Self {
        let mut relaxing = Self { config, step_s: 0.0, decay: 1.0, ramp: 0.0, elastic_n: 0.0, relaxed_n: 0.0 };
        relaxing.set_step(step_s);
        relaxing
    }

    /// Sets the length of the following steps; a difference within rounding is ignored.
    pub(super) fn set_step(&mut self, step_s: f64) {
        if (step_s - self.step_s).abs() <= ROUNDING_S {
            return;
        }
        let over = step_s / self.config.time_s;
        self.step_s = step_s;
        self.decay = (-over).exp();
        // Exact if the elastic force changes linearly during the step.
        self.ramp = 1.0 - (1.0 - self.decay) / over;
    }

    /// Returns the force (N) after a step at whose end the elastic force has this value.
    pub(super) fn step(&mut self, elastic_n: f64) -> f64 {
        let before_n = std::mem::replace(&mut self.elastic_n, elastic_n);
        self.relaxed_n = before_n + (self.relaxed_n - before_n) * self.decay + (elastic_n - before_n) * self.ramp;
        // Tissue does not pull at a tip that leaves it.
        (elastic_n - self.config.fraction * self.relaxed_n).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CONFIG: Relaxation = Relaxation { fraction: 0.4, time_s: 0.8 };
    const STEP_S: f64 = 1e-3;

    #[test]
    fn a_force_that_is_held_fades_to_its_share_with_its_time() {
        let mut tissue = RelaxationState::new(CONFIG, STEP_S);
        // The depth jumps within one millisecond.
        let first_n = tissue.step(2.0);
        assert!((first_n - 2.0).abs() < 1e-3, "{first_n}");
        for i in 1..=6000 {
            let force_n = tissue.step(2.0);
            // The ramp of the first millisecond acts like a jump in the middle of it.
            let t_s = (f64::from(i) + 0.5) * STEP_S;
            let exact_n = 2.0 * (1.0 - 0.4 * (1.0 - (-t_s / 0.8).exp()));
            assert!((force_n - exact_n).abs() < 1e-6, "{force_n} N instead of {exact_n} N at {t_s} s");
        }
    }

    #[test]
    fn a_steady_ramp_is_followed_exactly_at_every_step_length() {
        for step_s in [1e-4, 1e-3, 1e-2, 0.1] {
            let mut tissue = RelaxationState::new(CONFIG, step_s);
            let mut t_s = 0.0;
            while t_s < 1.0 {
                t_s += step_s;
                let force_n = tissue.step(3.0 * t_s);
                let relaxed_n = 3.0 * (t_s - 0.8 * (1.0 - (-t_s / 0.8).exp()));
                assert!((force_n - (3.0 * t_s - 0.4 * relaxed_n)).abs() < 1e-9, "{step_s} s");
            }
        }
    }

    #[test]
    fn steps_of_unequal_length_relax_as_equal_ones() {
        let mut even = RelaxationState::new(CONFIG, STEP_S);
        let mut uneven = RelaxationState::new(CONFIG, STEP_S);
        let mut t_s = 0.0;
        let mut forces_n = [0.0; 2];
        for i in 0..1000_u32 {
            // Every tenth step is 4 ms late, and the next one comes 0.5 ms after it.
            for step_s in if i % 10 == 0 { [5e-3, 0.5e-3] } else { [STEP_S; 2] } {
                uneven.set_step(step_s);
                t_s += step_s;
                forces_n[0] = uneven.step(3.0 * t_s);
            }
        }
        for i in 1..=(t_s / STEP_S).round() as u32 {
            forces_n[1] = even.step(3.0 * STEP_S * f64::from(i));
        }
        assert!((forces_n[0] / forces_n[1] - 1.0).abs() < 1e-3, "{forces_n:?}");
    }

    #[test]
    fn it_takes_energy_in_every_cycle_and_never_pulls() {
        let mut tissue = RelaxationState::new(CONFIG, STEP_S);
        let mut work_j = 0.0;
        let mut before_m = 0.0;
        for i in 0..20_000 {
            let depth_m = 0.005 * (1.0 - (f64::from(i) * 0.004).cos());
            let force_n = tissue.step(500.0 * depth_m);
            assert!(force_n >= 0.0);
            work_j += force_n * (depth_m - before_m);
            before_m = depth_m;
        }
        assert!(work_j > 0.0, "{work_j} J");
    }
}
