//! An arm with a typical instrument, and a trocar next to its base.

use nalgebra::Vector3;

use super::{Arm, ArmSettings, JOINTS, Rcm, RcmSettings};

pub(super) const TROCAR_M: Vector3<f64> = Vector3::new(0.4, 0.0, -0.1);
/// A starting pose, stored because the search is slow.
pub(super) const READY_RAD: [f64; JOINTS] = [2.38, -1.34, -1.37, 1.91, -1.28, 1.68, 0.92];

pub(super) fn arm_settings() -> ArmSettings {
    ArmSettings {
        base_m: Vector3::zeros(),
        base_deg: Vector3::zeros(),
        sensor_m: Vector3::new(0.0, 0.0, 0.06),
        sensor_deg: Vector3::zeros(),
        shaft_m: 0.42,
    }
}

pub(super) fn arm() -> Arm {
    Arm::new(&arm_settings()).unwrap()
}

pub(super) fn rcm(cone_deg: f64) -> Rcm {
    let settings = RcmSettings {
        trocar_m: TROCAR_M,
        inward: -Vector3::z(),
        cone_deg,
        insertion_min_m: 0.03,
        insertion_max_m: 0.25,
    };
    Rcm::new(&settings).unwrap()
}

pub(super) fn middle_m() -> Vector3<f64> {
    TROCAR_M - Vector3::z() * 0.12
}
