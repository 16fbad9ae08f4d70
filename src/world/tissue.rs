//! Contact of a tip with soft tissue.

use nalgebra::Vector3;

use crate::scene::Tissue as TissueConfig;

/// Soft tissue. Its only state is how far the tip has dragged its surface sideways.
#[derive(Clone, Debug)]
pub struct Tissue {
    config: TissueConfig,
    /// Rest position of the surface point under the tip, m (horizontal).
    anchor_m: Option<Vector3<f64>>,
}

impl Tissue {
    /// Untouched tissue.
    pub const fn new(config: TissueConfig) -> Self {
        Self { config, anchor_m: None }
    }

    /// Force on the tip (N) at this position (m) and velocity (m/s); call once per step.
    ///
    /// Normal force after Hunt and Crossley, `k d^n (1 + c d')`, never negative. Tangential force elastic up to the
    /// Coulomb limit, then sliding (Dahl's model without the hysteresis exponent).
    ///
    /// ```
    /// use nalgebra::Vector3;
    /// use nima_world::{Tissue, scene::Scene};
    ///
    /// let config = Scene::load("peg_transfer")?.tissue.expect("this scene has tissue");
    /// let mut tissue = Tissue::new(config);
    /// let at_rest = Vector3::zeros();
    /// let above_m = Vector3::new(0.0, 0.0, config.surface_z_m + 0.001);
    /// assert_eq!(tissue.contact_n(&above_m, &at_rest), Vector3::zeros());
    /// let inside_m = Vector3::new(0.0, 0.0, config.surface_z_m - 0.005);
    /// assert!(tissue.contact_n(&inside_m, &at_rest).z > 0.0, "the tissue pushes the tip upwards");
    /// # Ok::<(), nima_machine::config::ConfigError>(())
    /// ```
    pub fn contact_n(&mut self, tip_m: &Vector3<f64>, velocity_m_s: &Vector3<f64>) -> Vector3<f64> {
        let TissueConfig { surface_z_m, size_m, stiffness, exponent, damping_s_m, friction, shear_stiffness_n_m } =
            self.config;
        let depth_m = surface_z_m - tip_m.z;
        let beside = tip_m.x.abs() > 0.5 * size_m[0] || tip_m.y.abs() > 0.5 * size_m[1];
        if depth_m <= 0.0 || beside {
            self.anchor_m = None;
            return Vector3::zeros();
        }
        let normal_n = (stiffness * depth_m.powf(exponent) * (1.0 - damping_s_m * velocity_m_s.z)).max(0.0);
        let here = Vector3::new(tip_m.x, tip_m.y, 0.0);
        let stretch_m = here - self.anchor_m.unwrap_or(here);
        let slip_m = if shear_stiffness_n_m > 0.0 { friction * normal_n / shear_stiffness_n_m } else { 0.0 };
        let length_m = stretch_m.norm();
        let held_m = if length_m > slip_m { stretch_m * (slip_m / length_m) } else { stretch_m };
        self.anchor_m = Some(here - held_m);
        Vector3::new(0.0, 0.0, normal_n) - held_m * shear_stiffness_n_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tissue() -> Tissue {
        Tissue::new(TissueConfig {
            surface_z_m: 0.0,
            size_m: [0.1, 0.1],
            stiffness: 1000.0,
            exponent: 1.5,
            damping_s_m: 1.0,
            friction: 0.3,
            shear_stiffness_n_m: 200.0,
        })
    }

    #[test]
    fn static_force_is_the_power_law() {
        let force = tissue().contact_n(&Vector3::new(0.0, 0.0, -0.01), &Vector3::zeros());
        assert!((force - Vector3::new(0.0, 0.0, 1.0)).norm() < 1e-12, "{force}");
    }

    #[test]
    fn nothing_above_or_beside_and_no_pull_on_leaving() {
        let mut tissue = tissue();
        assert_eq!(tissue.contact_n(&Vector3::new(0.0, 0.0, 0.001), &Vector3::zeros()), Vector3::zeros());
        assert_eq!(tissue.contact_n(&Vector3::new(0.06, 0.0, -0.01), &Vector3::zeros()), Vector3::zeros());
        assert!(tissue.contact_n(&Vector3::new(0.0, 0.0, -0.01), &Vector3::new(0.0, 0.0, 5.0)).z >= 0.0);
    }

    #[test]
    fn it_sticks_like_a_spring_and_slips_at_the_coulomb_limit() {
        let mut tissue = tissue();
        tissue.contact_n(&Vector3::new(0.0, 0.0, -0.01), &Vector3::zeros());
        let stuck = tissue.contact_n(&Vector3::new(0.001, 0.0, -0.01), &Vector3::zeros());
        assert!((stuck.x + 0.2).abs() < 1e-12, "{stuck}");
        let slipping = tissue.contact_n(&Vector3::new(0.005, 0.0, -0.01), &Vector3::zeros());
        assert!((slipping.x + 0.3).abs() < 1e-12, "{slipping}");
        let back = tissue.contact_n(&Vector3::new(0.0042, 0.0, -0.01), &Vector3::zeros());
        assert!((back.x + 0.14).abs() < 1e-12, "friction turns round elastically: {back}");
    }
}
