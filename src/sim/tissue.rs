//! Contact force of a tip in soft tissue.

use nalgebra::Vector3;

use crate::config::Tissue;

/// Sliding speed at which friction reaches tanh(1) of its full value, m/s: keeps the force continuous through a stop.
const FRICTION_SPEED_M_S: f64 = 0.003;

/// Force of the tissue on the tip, N: Hunt-Crossley along the surface normal, regularised Coulomb friction across it.
///
/// Never pulls: the normal force is at least zero however fast the tip leaves.
pub fn contact_force_n(tissue: &Tissue, tip_m: &Vector3<f64>, velocity_m_s: &Vector3<f64>) -> Vector3<f64> {
    let depth_m = tissue.surface_z_m - tip_m.z;
    let beside = tip_m.x.abs() > 0.5 * tissue.size_m[0] || tip_m.y.abs() > 0.5 * tissue.size_m[1];
    if depth_m <= 0.0 || beside {
        return Vector3::zeros();
    }
    let normal_n =
        (tissue.stiffness * depth_m.powf(tissue.exponent) * (1.0 - tissue.damping_s_m * velocity_m_s.z)).max(0.0);
    let sliding = Vector3::new(velocity_m_s.x, velocity_m_s.y, 0.0);
    let speed_m_s = sliding.norm();
    if tissue.friction == 0.0 || speed_m_s < 1e-9 {
        return Vector3::new(0.0, 0.0, normal_n);
    }
    let friction_n = tissue.friction * normal_n * (speed_m_s / FRICTION_SPEED_M_S).tanh();
    Vector3::new(0.0, 0.0, normal_n) - sliding * (friction_n / speed_m_s)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TISSUE: Tissue = Tissue {
        surface_z_m: 0.0,
        size_m: [0.1, 0.1],
        stiffness: 1000.0,
        exponent: 1.5,
        damping_s_m: 1.0,
        friction: 0.3,
    };

    #[test]
    fn static_force_is_the_power_law() {
        let force = contact_force_n(&TISSUE, &Vector3::new(0.0, 0.0, -0.01), &Vector3::zeros());
        assert!((force - Vector3::new(0.0, 0.0, 1.0)).norm() < 1e-12, "{force}");
    }

    #[test]
    fn nothing_above_or_beside_and_no_pull_on_leaving() {
        assert_eq!(contact_force_n(&TISSUE, &Vector3::new(0.0, 0.0, 0.001), &Vector3::zeros()), Vector3::zeros());
        assert_eq!(contact_force_n(&TISSUE, &Vector3::new(0.06, 0.0, -0.01), &Vector3::zeros()), Vector3::zeros());
        assert!(contact_force_n(&TISSUE, &Vector3::new(0.0, 0.0, -0.01), &Vector3::new(0.0, 0.0, 5.0)).z >= 0.0);
    }

    #[test]
    fn friction_opposes_sliding_and_is_bounded() {
        let force = contact_force_n(&TISSUE, &Vector3::new(0.0, 0.0, -0.01), &Vector3::new(0.1, 0.0, 0.0));
        assert!(force.x < 0.0 && force.x.abs() <= 0.3 * force.z + 1e-12 && force.y.abs() < 1e-15);
    }
}
