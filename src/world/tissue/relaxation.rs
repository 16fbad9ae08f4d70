//! Tissue whose force fades while it is held.

use crate::scene::Relaxation;

/// The state of tissue that relaxes: quasi-linear viscoelasticity (Fung, Biomechanics, 1993, section 7.6) with one exponential, which is the
/// standard linear solid where the elastic force is linear in the depth.
#[derive(Clone, Copy, Debug)]
pub(super) struct Relaxing {
    share: f64,
    /// Share of the distance to the elastic force that is left after a step.
    decay: f64,
    /// Mean of the elastic force over a step that counts, by its shape inside the step.
    ramp: f64,
    elastic_n: f64,
    relaxed_n: f64,
}

impl Relaxing {
    /// At rest, for steps of this length.
    pub(super) fn new(config: Relaxation, step_s: f64) -> Self {
        let Relaxation { share, time_s } = config;
        let decay = (-step_s / time_s).exp();
        // For an elastic force that changes linearly during the step the solution is exact.
        let ramp = 1.0 - (1.0 - decay) * time_s / step_s;
        Self { share, decay, ramp, elastic_n: 0.0, relaxed_n: 0.0 }
    }

    /// The force (N) after a step at whose end the force of the elastic tissue is this.
    pub(super) fn step(&mut self, elastic_n: f64) -> f64 {
        let before_n = std::mem::replace(&mut self.elastic_n, elastic_n);
        self.relaxed_n = before_n + (self.relaxed_n - before_n) * self.decay + (elastic_n - before_n) * self.ramp;
        (elastic_n - self.share * self.relaxed_n).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CONFIG: Relaxation = Relaxation { share: 0.4, time_s: 0.8 };
    const STEP_S: f64 = 1e-3;

    #[test]
    fn a_force_that_is_held_fades_to_its_share_with_its_time() {
        let mut tissue = Relaxing::new(CONFIG, STEP_S);
        // A step within one millisecond.
        let first_n = tissue.step(2.0);
        assert!((first_n - 2.0).abs() < 1e-3, "{first_n}");
        for i in 1..=6000 {
            let force_n = tissue.step(2.0);
            // The ramp of the first millisecond counts as a step in its middle.
            let t_s = (f64::from(i) + 0.5) * STEP_S;
            let exact_n = 2.0 * (1.0 - 0.4 * (1.0 - (-t_s / 0.8).exp()));
            assert!((force_n - exact_n).abs() < 1e-6, "{force_n} N instead of {exact_n} N at {t_s} s");
        }
    }

    #[test]
    fn a_steady_ramp_is_followed_exactly_at_every_step_length() {
        for step_s in [1e-4, 1e-3, 1e-2, 0.1] {
            let mut tissue = Relaxing::new(CONFIG, step_s);
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
    fn it_takes_energy_in_every_cycle_and_never_pulls() {
        let mut tissue = Relaxing::new(CONFIG, STEP_S);
        let (mut work_j, mut before_m) = (0.0, 0.0);
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
