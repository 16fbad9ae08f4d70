//! The remote centre of motion (RCM): converts between the tip position and the shaft's direction and insertion.
//!
//! Positions in m, angles in rad, in `world`. The permitted space is a cone about a direction into the body, between a
//! smallest and a largest insertion. [`Rcm::resolve`] refuses a tip outside it; [`Rcm::confine`] returns the nearest
//! permitted shaft instead and reports what it changed, for the loop, which always needs a result.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::units;

/// Settings of the trocar and of the permitted space beyond it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RcmSettings {
    /// Trocar point, fixed in space, m (`world`).
    pub trocar_m: Vector3<f64>,
    /// Axis of the cone, pointing into the body (`world`); any length except zero.
    pub inward: Vector3<f64>,
    /// Half opening angle of the cone, degrees, above 0 and at most 80.
    pub cone_deg: f64,
    /// Smallest insertion of the tip beyond the trocar, m, at least 0.005: closer to the trocar, small motions of the
    /// hand would need unbounded rotations of the shaft.
    pub insertion_min_m: f64,
    pub insertion_max_m: f64,
}

/// Reason why a position or the settings are refused.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum RcmError {
    #[error("{what} is not a finite number: enter it in metres in the frame of the arm's base")]
    NotFinite { what: &'static str },
    #[error("the trocar's {setting} is {value_m} m: {}", units::length_remedy(*.value_m, *.max_m))]
    TooFar { setting: &'static str, value_m: f64, max_m: f64 },
    #[error("the trocar's {setting} is {value}: {wanted}")]
    Setting { setting: &'static str, value: f64, wanted: &'static str },
    #[error("the tip is {insertion_m:.4} m beyond the trocar (minimum {min_m} m): push the instrument in")]
    TooNear { insertion_m: f64, min_m: f64 },
    #[error("the tip is {insertion_m:.4} m beyond the trocar (limit {max_m} m): pull the instrument back")]
    TooDeep { insertion_m: f64, max_m: f64 },
    #[error("the shaft is tilted by {tilt_deg:.1} degrees (limit {cone_deg} degrees): straighten it or widen the cone")]
    OutsideCone {
        /// Angle from the axis of the cone, degrees.
        tilt_deg: f64,
        /// Half opening angle of the cone, degrees.
        cone_deg: f64,
    },
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RcmShaft {
    /// Direction from the trocar to the tip, unit length.
    pub direction: Vector3<f64>,
    /// Distance of the tip beyond the trocar, m.
    pub insertion_m: f64,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RcmCorrection {
    pub too_near: bool,
    pub too_deep: bool,
    pub outside_cone: bool,
}

impl RcmCorrection {
    pub const fn is_untouched(self) -> bool {
        !self.too_near && !self.too_deep && !self.outside_cone
    }
}

/// A trocar with checked settings.
///
/// ```
/// use nalgebra::Vector3;
/// use nima_core::kinematics::{Rcm, RcmError, RcmSettings};
///
/// let rcm = Rcm::new(&RcmSettings {
///     trocar_m: Vector3::new(0.0, 0.0, 0.1),
///     inward: Vector3::new(0.0, 0.0, -1.0),
///     cone_deg: 30.0,
///     insertion_min_m: 0.01,
///     insertion_max_m: 0.2,
/// })?;
/// let inside_m = Vector3::new(0.0, 0.0, 0.05);
/// assert!((rcm.tip_m(&rcm.resolve(&inside_m)?) - inside_m).norm() < 1e-12);
///
/// let beside_m = Vector3::new(0.5, 0.0, 0.05);
/// assert!(matches!(rcm.resolve(&beside_m), Err(RcmError::TooDeep { .. })));
/// let (shaft, confined) = rcm.confine(&beside_m);
/// assert!(confined.outside_cone && shaft.insertion_m <= 0.2);
/// # Ok::<(), RcmError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Rcm {
    settings: RcmSettings,
    inward: Vector3<f64>,
    cone_rad: f64,
}

/// A position closer to the trocar than this defines no direction, m. Below it only rounding would decide the
/// direction.
/// A nanometre: far below what any encoder resolves.
const POINT_M: f64 = 1e-9;

/// Maximum distance of a trocar from the origin of the workspace, m.
const TROCAR_MAX_M: f64 = 10.0;
/// Maximum insertion beyond the trocar, m: the longest shaft.
const INSERTION_MAX_M: f64 = 1.0;

impl Rcm {
    /// Creates a trocar from checked settings.
    ///
    /// # Errors
    /// [`RcmError`] if a number is not finite or no space is left.
    pub fn new(settings: &RcmSettings) -> Result<Self, RcmError> {
        let RcmSettings { trocar_m, inward, cone_deg, insertion_min_m, insertion_max_m } = *settings;
        for (what, vector) in [("the trocar's position", trocar_m), ("the direction into the body", inward)] {
            if !vector.iter().all(|x| x.is_finite()) {
                return Err(RcmError::NotFinite { what });
            }
        }
        let lengths = [
            ("trocar_m", trocar_m.norm(), TROCAR_MAX_M),
            ("insertion_min_m", insertion_min_m, INSERTION_MAX_M),
            ("insertion_max_m", insertion_max_m, INSERTION_MAX_M),
        ];
        if let Some((setting, value_m, max_m)) = lengths.into_iter().find(|(_, value_m, max_m)| value_m > max_m) {
            return Err(RcmError::TooFar { setting, value_m, max_m });
        }
        let refuse = |setting, value, wanted| Err(RcmError::Setting { setting, value, wanted });
        if inward.norm() < POINT_M {
            return refuse("inward", inward.norm(), "its length must not be zero");
        }
        // Written so that NaN is rejected too.
        if !(cone_deg > 0.0 && cone_deg <= 80.0) {
            return refuse("cone_deg", cone_deg, "it must be above 0 and at most 80 degrees");
        }
        if !(insertion_min_m >= 0.005 && insertion_min_m.is_finite()) {
            return refuse("insertion_min_m", insertion_min_m, "it must be at least 0.005 m");
        }
        if !(insertion_max_m > insertion_min_m && insertion_max_m.is_finite()) {
            return refuse("insertion_max_m", insertion_max_m, "it must be above insertion_min_m");
        }
        Ok(Self { settings: *settings, inward: inward.normalize(), cone_rad: cone_deg.to_radians() })
    }

    pub const fn settings(&self) -> &RcmSettings {
        &self.settings
    }

    /// Returns the axis of the cone, unit length.
    pub const fn inward(&self) -> &Vector3<f64> {
        &self.inward
    }

    /// Returns the position of the tip of a shaft, m.
    pub fn tip_m(&self, shaft: &RcmShaft) -> Vector3<f64> {
        self.settings.trocar_m + shaft.direction * shaft.insertion_m
    }

    /// Returns the shaft that passes through the trocar to this tip (m).
    ///
    /// # Errors
    /// [`RcmError`] if the tip is not finite, too close, too deep, or outside the cone.
    pub fn resolve(&self, tip_m: &Vector3<f64>) -> Result<RcmShaft, RcmError> {
        if !tip_m.iter().all(|x| x.is_finite()) {
            return Err(RcmError::NotFinite { what: "the tip's position" });
        }
        let RcmSettings { trocar_m, cone_deg, insertion_min_m, insertion_max_m, .. } = self.settings;
        let travel_m = tip_m - trocar_m;
        let insertion_m = travel_m.norm();
        if insertion_m < insertion_min_m {
            return Err(RcmError::TooNear { insertion_m, min_m: insertion_min_m });
        }
        if insertion_m > insertion_max_m {
            return Err(RcmError::TooDeep { insertion_m, max_m: insertion_max_m });
        }
        let tilt_rad = angle_rad(&self.inward, &travel_m);
        if tilt_rad > self.cone_rad {
            return Err(RcmError::OutsideCone { tilt_deg: tilt_rad.to_degrees(), cone_deg });
        }
        Ok(RcmShaft { direction: travel_m / insertion_m, insertion_m })
    }

    /// Returns the permitted shaft nearest to this tip (m, finite), and the required change.
    pub fn confine(&self, tip_m: &Vector3<f64>) -> (RcmShaft, RcmCorrection) {
        let RcmSettings { trocar_m, insertion_min_m, insertion_max_m, .. } = self.settings;
        let travel_m = tip_m - trocar_m;
        let tilt_rad = angle_rad(&self.inward, &travel_m);
        let length_m = travel_m.norm();
        let mut confined = RcmCorrection::default();
        let (direction, wanted_m) = if length_m < POINT_M {
            (self.inward, 0.0)
        } else if tilt_rad > self.cone_rad {
            confined.outside_cone = true;
            // Project onto the cone, so that the tip slides along it; behind the apex, project to the apex.
            let excess_rad = tilt_rad - self.cone_rad;
            (self.on_the_cone(&travel_m), length_m * libm::cos(excess_rad).max(0.0))
        } else {
            (travel_m / length_m, length_m)
        };
        confined.too_near = wanted_m < insertion_min_m;
        confined.too_deep = wanted_m > insertion_max_m;
        (RcmShaft { direction, insertion_m: wanted_m.clamp(insertion_min_m, insertion_max_m) }, confined)
    }

    /// Returns the direction on the cone's surface on the same side as `travel_m`, unit length.
    fn on_the_cone(&self, travel_m: &Vector3<f64>) -> Vector3<f64> {
        let sideways = travel_m - self.inward * travel_m.dot(&self.inward);
        let side = if sideways.norm() > POINT_M {
            sideways.normalize()
        } else {
            // If it points exactly opposite to the cone, any side is equally close.
            let other = if self.inward.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
            self.inward.cross(&other).normalize()
        };
        let (sin, cos) = libm::sincos(self.cone_rad);
        self.inward * cos + side * sin
    }
}

/// Returns the angle between two directions of any length, rad; accurate for small angles.
pub(super) fn angle_rad(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    libm::atan2(a.cross(b).norm(), a.dot(b))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn settings() -> RcmSettings {
        RcmSettings {
            trocar_m: Vector3::new(0.4, -0.06, 0.14),
            inward: Vector3::new(0.2, 0.0, -2.0),
            cone_deg: 40.0,
            insertion_min_m: 0.02,
            insertion_max_m: 0.25,
        }
    }

    #[test]
    fn each_refusal_says_why() {
        let rcm = Rcm::new(&settings()).unwrap();
        let at = |along_m: f64, across_m: f64| {
            rcm.resolve(&(settings().trocar_m + rcm.inward * along_m + Vector3::y() * across_m))
        };
        assert!(at(0.1, 0.02).is_ok());
        assert!(matches!(at(0.01, 0.0), Err(RcmError::TooNear { .. })));
        assert!(matches!(at(0.3, 0.0), Err(RcmError::TooDeep { .. })));
        assert!(matches!(at(0.1, 0.1), Err(RcmError::OutsideCone { .. })));
        assert!(matches!(at(-0.1, 0.0), Err(RcmError::OutsideCone { .. })), "outside of the body");
        assert!(matches!(at(f64::NAN, 0.0), Err(RcmError::NotFinite { .. })));
    }

    #[test]
    fn settings_without_space_are_refused() {
        let good = settings();
        for broken in [
            RcmSettings { inward: Vector3::zeros(), ..good },
            RcmSettings { cone_deg: 95.0, ..good },
            RcmSettings { cone_deg: f64::NAN, ..good },
            RcmSettings { insertion_min_m: 0.0, ..good },
            RcmSettings { insertion_max_m: 0.02, ..good },
        ] {
            assert!(matches!(Rcm::new(&broken), Err(RcmError::Setting { .. })), "{broken:?}");
        }
        let lost = RcmSettings { trocar_m: Vector3::repeat(f64::INFINITY), ..good };
        assert!(matches!(Rcm::new(&lost), Err(RcmError::NotFinite { .. })));
    }

    proptest! {
        #[test]
        fn there_and_back_is_the_same_tip(tilt in 0.0..0.69_f64, round in -3.1..3.1_f64, insertion_m in 0.021..0.249_f64) {
            let rcm = Rcm::new(&settings()).unwrap();
            let side = rcm.inward.cross(&Vector3::y()).normalize();
            let across = side * round.cos() + rcm.inward.cross(&side) * round.sin();
            let shaft = RcmShaft { direction: rcm.inward * tilt.cos() + across * tilt.sin(), insertion_m };
            let tip_m = rcm.tip_m(&shaft);
            let back = rcm.resolve(&tip_m).unwrap();
            prop_assert!((back.direction - shaft.direction).norm() < 1e-12);
            prop_assert!((back.insertion_m - insertion_m).abs() < 1e-13);
            let (same, confined) = rcm.confine(&tip_m);
            prop_assert!(confined.is_untouched() && (rcm.tip_m(&same) - tip_m).norm() < 1e-15);
        }

        #[test]
        fn a_confined_tip_is_permitted_and_as_near_as_can_be(x in -0.5..0.5_f64, y in -0.5..0.5_f64, z in -0.5..0.5_f64) {
            let rcm = Rcm::new(&settings()).unwrap();
            let tip_m = settings().trocar_m + Vector3::new(x, y, z);
            let (shaft, confined) = rcm.confine(&tip_m);
            prop_assert_eq!(confined.is_untouched(), rcm.resolve(&tip_m).is_ok());
            prop_assert!((shaft.direction.norm() - 1.0).abs() < 1e-12);
            prop_assert!(angle_rad(&rcm.inward, &shaft.direction) <= rcm.cone_rad + 1e-12);
            prop_assert!((0.02..=0.25).contains(&shaft.insertion_m));
            // No other permitted position is closer, unless the smallest insertion is the active limit.
            if !confined.too_near {
                let miss_m = (rcm.tip_m(&shaft) - tip_m).norm();
                let mut random = fastrand::Rng::with_seed(x.to_bits() ^ z.to_bits());
                for _ in 0..50 {
                    let other_m = tip_m + Vector3::from_fn(|_, _| random.f64() - 0.5) * miss_m * 1.1;
                    if rcm.resolve(&other_m).is_ok() {
                        prop_assert!((other_m - tip_m).norm() >= miss_m - 1e-12);
                    }
                }
            }
        }
    }
}
