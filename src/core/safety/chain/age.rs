//! Second gate: fades the force with the age of its data, so that a silent source loses its force.

use super::Reason;

/// Fades a force between two ages of its data, beyond the link's own delay.
#[derive(Clone, Copy, Debug)]
pub struct AgeGate {
    fade_after_s: f64,
    zero_after_s: f64,
}

impl AgeGate {
    /// Creates a gate that passes the full force until `fade_after_s` and none from `zero_after_s` on (s, the second
    /// above the first).
    pub const fn new(fade_after_s: f64, zero_after_s: f64) -> Self {
        Self { fade_after_s, zero_after_s }
    }

    /// Returns the fraction of the force that passes at this age (s), 0 to 1, and the reason for a reduction. At a
    /// non-finite age, no force passes.
    pub fn fraction(&self, age_s: f64) -> (f64, Reason) {
        // NaN would fail both comparisons below and give a NaN force, so it is tested here.
        if !age_s.is_finite() || age_s >= self.zero_after_s {
            return (0.0, Reason::TooOld);
        }
        if age_s <= self.fade_after_s {
            return (1.0, Reason::Open);
        }
        // Linear from 1 to 0: no step at either end, which the hand would feel as a knock.
        ((self.zero_after_s - age_s) / (self.zero_after_s - self.fade_after_s), Reason::Ageing)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn older_never_passes_more(age_s in prop::num::f64::ANY, more_s in 0.0..1.0f64) {
            let age = AgeGate::new(0.005, 0.020);
            let (fraction, reason) = age.fraction(age_s);
            let (later, _) = age.fraction(age_s + more_s);
            prop_assert!((0.0..=1.0).contains(&fraction) && later <= fraction);
            prop_assert_eq!(reason == Reason::Open, fraction >= 1.0);
            prop_assert!(age_s < 0.020 || fraction == 0.0);
        }
    }

    #[test]
    fn an_age_that_is_no_number_passes_nothing() {
        for age_s in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(AgeGate::new(0.005, 0.020).fraction(age_s), (0.0, Reason::TooOld));
        }
    }
}
