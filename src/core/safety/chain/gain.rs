//! Fourth gate: the operator's gain, ramped; a gain above 1 needs a second, deliberate action.

use super::Reason;
use crate::limits::{GAIN, GAIN_ABOVE_ONE};

#[derive(Clone, Copy, Debug)]
pub struct Gain {
    chosen: f64,
    /// Whether the operator took the second action; cleared by any gain of 1 or less.
    above_one: bool,
    now: f64,
    rate_per_s: f64,
}

impl Gain {
    /// Starts at this gain (at most 1, because a higher gain needs a second action); the gain changes by at most
    /// `rate_per_s` (1/s).
    pub const fn new(gain: f64, rate_per_s: f64) -> Self {
        // NaN starts without force: of all gains only zero is safe for every force.
        let chosen = if gain.is_nan() { 0.0 } else { gain.clamp(GAIN.min, GAIN.max) };
        Self { chosen, above_one: false, now: chosen, rate_per_s }
    }

    /// Sets a gain of 0 to 1. A larger gain is clamped to 1, unless the second action has already permitted
    /// more than 1. NaN is ignored. A gain of 1 or less withdraws that permission.
    pub const fn choose(&mut self, gain: f64) {
        if gain.is_nan() {
            return;
        }
        // Returning above 1 then needs the second action again.
        self.above_one = self.above_one && gain > 1.0;
        self.chosen = gain.clamp(GAIN.min, if self.above_one { GAIN_ABOVE_ONE.max } else { GAIN.max });
    }

    /// Sets a gain within [`GAIN_ABOVE_ONE`]: the second, deliberate action. NaN is ignored.
    pub const fn choose_above_one(&mut self, gain: f64) {
        if !gain.is_nan() {
            self.above_one = gain > 1.0;
            self.chosen = gain.clamp(GAIN_ABOVE_ONE.min, GAIN_ABOVE_ONE.max);
        }
    }

    /// Returns the gain that was set; [`Gain::step`] ramps towards it.
    pub const fn chosen(&self) -> f64 {
        self.chosen
    }

    /// Returns the active gain `dt_s` (s) after the last call, and the reason if it differs from the set gain or no
    /// force passes.
    pub fn step(&mut self, dt_s: f64) -> (f64, Reason) {
        // Ramped also downwards, because a sudden loss of force lets a pressing hand jump forward.
        let step = self.rate_per_s * dt_s;
        self.now += (self.chosen - self.now).clamp(-step, step);
        let reason = if self.now <= 0.0 {
            Reason::GainZero
        // Not `!=`: the last step of the ramp may end one rounding error away.
        } else if (self.now - self.chosen).abs() > 1e-12 {
            Reason::GainRamping
        } else {
            Reason::Open
        };
        (self.now, reason)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn it_never_leaves_its_range_its_rate_or_its_permission(
            choices in prop::collection::vec((prop::num::f64::ANY, any::<bool>()), 1..200),
        ) {
            let mut gain = Gain::new(1.0, 2.0);
            let mut last = 1.0;
            let mut allowed = false;
            for (choice, deliberate) in choices {
                if deliberate {
                    gain.choose_above_one(choice);
                    allowed = if choice.is_nan() { allowed } else { choice > 1.0 };
                } else {
                    gain.choose(choice);
                    allowed = if choice.is_nan() { allowed } else { allowed && choice > 1.0 };
                }
                let (now, _) = gain.step(1e-3);
                prop_assert!(GAIN_ABOVE_ONE.contains(now) && (now - last).abs() <= 2e-3 + 1e-12);
                prop_assert!(allowed || gain.chosen() <= 1.0);
                last = now;
            }
        }
    }

    #[test]
    fn more_than_one_takes_the_second_action_and_is_withdrawn_by_going_back() {
        let mut gain = Gain::new(3.0, 1e6);
        let at = |gain: &mut Gain| gain.step(1e-3).0;
        assert!((at(&mut gain) - 1.0).abs() < 1e-12, "no file starts above 1");
        gain.choose(2.0);
        assert!((at(&mut gain) - 1.0).abs() < 1e-12);
        gain.choose_above_one(2.0);
        assert!((at(&mut gain) - 2.0).abs() < 1e-12);
        gain.choose(1.5);
        assert!((at(&mut gain) - 1.5).abs() < 1e-12, "allowed while above 1");
        gain.choose(1.0);
        gain.choose(2.0);
        assert!((at(&mut gain) - 1.0).abs() < 1e-12, "going back to 1 withdrew it");
        gain.choose(0.0);
        assert_eq!(gain.step(1e-3), (0.0, Reason::GainZero));
    }
}
