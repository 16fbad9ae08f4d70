//! Seventh gate: the maximum force at the hand, never above the device's own limit.

use nalgebra::SVector;

use super::Reason;

/// Limits a force to the ceiling and to the device's own limit.
///
/// ```
/// use nalgebra::Vector3;
/// use nima_core::safety::{Ceiling, Reason};
///
/// let (force_n, reason) = Ceiling::new(4.0, 12.0).under(Vector3::new(0.0, 6.0, 8.0));
/// assert!((force_n - Vector3::new(0.0, 2.4, 3.2)).norm() < 1e-12, "shortened to 4 N, same direction");
/// assert_eq!(reason, Reason::AboveCeiling);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Ceiling {
    ceiling_n: f64,
    device_limit_n: f64,
}

impl Ceiling {
    /// Uses the lower of the two limits (N, norm of the vector).
    pub const fn new(ceiling_n: f64, device_limit_n: f64) -> Self {
        Self { ceiling_n, device_limit_n }
    }

    pub const fn max_n(&self) -> f64 {
        self.ceiling_n.min(self.device_limit_n)
    }

    /// Returns `force_n` (N), shortened to the limit along its own direction, and the reason.
    pub fn under<const D: usize>(&self, force_n: SVector<f64, D>) -> (SVector<f64, D>, Reason) {
        let norm = force_n.norm();
        let max_n = self.max_n();
        // Also true for a norm of zero, so the division below never sees it.
        if norm <= max_n {
            return (force_n, Reason::Open);
        }
        // On equal limits the ceiling is named, because it is the one that the operator can change.
        let reason = if self.device_limit_n < self.ceiling_n { Reason::AboveDeviceLimit } else { Reason::AboveCeiling };
        // Shortened as a vector: limiting each axis would turn the force towards another direction.
        (force_n * (max_n / norm), reason)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn nothing_larger_passes_and_no_direction_is_bent(
            force in prop::array::uniform3(-1e3..1e3f64), ceiling_n in 0.0..20.0f64, device_n in 0.0..20.0f64,
        ) {
            let force = Vector3::from(force);
            let ceiling = Ceiling::new(ceiling_n, device_n);
            let (passed, reason) = ceiling.under(force);
            prop_assert!(passed.norm() <= ceiling_n.min(device_n) * (1.0 + 1e-12));
            prop_assert!(passed.cross(&force).norm() <= 1e-9 * force.norm() * (1.0 + passed.norm()));
            prop_assert!(passed.dot(&force) >= 0.0);
            prop_assert_eq!(reason == Reason::Open, passed == force);
        }
    }
}
