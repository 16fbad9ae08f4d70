//! A little damping, so that a force computed from the handle's own motion does not drive the hand.

use super::{motion_clock::fraction, regressors::MotionState};
use crate::signal::{Lanes, settled};

/// Damping force at the usual motion, as a fraction of the usual force. With 0.02 the mean power into the hand was
/// still 0.5 mW in one of 60 cases (four tasks, tissue 0.4 to 2.5 times as stiff, 0 to 300 ms), with 0.03 in none;
/// without damping it was up to 2.2 mW (`nima study passivity`).
const FRACTION: f64 = 0.03;
/// Memory of the usual motion and force (s by the clock).
/// Covers several contacts and pauses, so that the damping does not change within one of them.
const USUAL_S: f64 = 20.0;

/// Viscous damping in proportion to the usual force over the usual motion, which makes it independent of units.
///
/// The force of a spring is held for a tick while the hand keeps moving, and its parameters change while it is pressed.
/// Both give energy to the hand, and more for a stiffer spring. To be passive, a sampled spring needs damping in
/// proportion to its stiffness (Colgate and Schenkel 1994: more than half of stiffness times period).
#[derive(Clone, Debug)]
pub(super) struct Damper {
    rate_hz: f64,
    passed: f64,
    motion2: f64,
    force2: f64,
}

impl Damper {
    pub(super) const fn new(rate_hz: f64) -> Self {
        Self { rate_hz, passed: 0.0, motion2: 0.0, force2: 0.0 }
    }

    /// Takes this tick's motion and the force computed from it (N); returns the damped force (N).
    pub(super) fn step(&mut self, now: &MotionState, force_n: Lanes) -> Lanes {
        // Nearly proportional to the velocity, and hardly disturbed by encoder steps.
        let above_low_pass_m = now.u[1];
        self.passed += now.pace;
        let fraction = fraction(now.pace, self.passed, USUAL_S * self.rate_hz);
        let follow = |mean: &mut f64, size: f64| *mean = settled(*mean + (size * size - *mean) * fraction);
        follow(&mut self.motion2, above_low_pass_m.norm());
        follow(&mut self.force2, force_n.norm());
        if self.motion2 > 0.0 {
            force_n - above_low_pass_m * (FRACTION * (self.force2 / self.motion2).sqrt())
        } else {
            force_n
        }
    }

    pub(super) const fn reset(&mut self) {
        *self = Self::new(self.rate_hz);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn usual_motion_is_damped_by_the_share_of_the_usual_force_whatever_the_units() {
        for (per_m, per_n) in [(1.0, 1.0), (1e3, 1.0), (1.0, 1e3)] {
            let mut damper = Damper::new(1000.0);
            let motion = Lanes([0.002 * per_m, 0.0, 0.0, 0.0]);
            let now = MotionState { u: [motion; 4], pace: 1.0, ..MotionState::BLANK };
            let force_n = Lanes([0.0, 0.0, 4.0 * per_n, 0.0]);
            let damped = (0..100).map(|_| damper.step(&now, force_n)).last().unwrap();
            assert!(
                (damped - force_n + Lanes([FRACTION * 4.0 * per_n, 0.0, 0.0, 0.0])).norm() < 1e-12 * per_n,
                "{damped:?}"
            );
        }
    }

    #[test]
    fn before_any_motion_the_force_is_as_it_was() {
        let force_n = Lanes([1.0, 2.0, 3.0, 0.0]);
        assert_eq!(Damper::new(1000.0).step(&MotionState::BLANK, force_n), force_n);
    }
}
