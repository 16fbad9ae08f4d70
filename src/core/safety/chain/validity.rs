//! First gate: a force must exist, be finite and be plausible. An invalid force is refused completely, never clipped.

use nalgebra::SVector;

use super::Reason;

/// A request beyond this value on any axis is a computing error, not a contact, N (Nm for a torque): it is rejected,
/// not clipped.
pub const PLAUSIBLE_N: f64 = 1e3;

/// Returns the requested force (N) unchanged.
///
/// # Errors
/// The reason for the refusal: absent, not finite, or larger than [`PLAUSIBLE_N`].
///
/// ```
/// use nalgebra::Vector3;
/// use nima_core::safety::{PLAUSIBLE_N, admitted};
///
/// let force_n = Vector3::new(1.0, 2.0, 3.0);
/// assert_eq!(admitted(Some(force_n)), Ok(force_n));
/// assert!(admitted(Some(Vector3::new(0.0, f64::NAN, 0.0))).is_err());
/// assert!(admitted(Some(Vector3::x() * (2.0 * PLAUSIBLE_N))).is_err());
/// assert!(admitted::<3>(None).is_err());
/// ```
pub fn admitted<const D: usize>(force_n: Option<SVector<f64, D>>) -> Result<SVector<f64, D>, Reason> {
    let force_n = force_n.ok_or(Reason::NothingAsked)?;
    if !force_n.iter().all(|f| f.is_finite()) {
        return Err(Reason::NotFinite);
    }
    // Per axis, because a norm could overflow to infinity for a finite force.
    if force_n.amax() > PLAUSIBLE_N { Err(Reason::Implausible) } else { Ok(force_n) }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn what_passes_is_what_was_asked_and_bounded(force in prop::array::uniform3(prop::num::f64::ANY)) {
            let force = Vector3::from(force);
            let good = force.iter().all(|f| f.abs() <= PLAUSIBLE_N);
            match admitted(Some(force)) {
                Ok(passed) => prop_assert!(good && passed == force),
                Err(reason) => {
                    prop_assert!(!good);
                    let finite = force.iter().all(|f| f.is_finite());
                    prop_assert_eq!(reason == Reason::Implausible, finite);
                }
            }
        }
    }

    #[test]
    fn nothing_asked_is_not_zero_asked() {
        assert_eq!(admitted::<3>(None), Err(Reason::NothingAsked));
        assert_eq!(admitted(Some(Vector3::zeros())), Ok(Vector3::zeros()));
    }
}
