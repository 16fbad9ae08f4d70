//! Contact of a tip with soft tissue, and the additional effects of a scene.

mod layers;
mod lumps;
mod membrane;
mod relaxation;
mod wall;

use nalgebra::Vector3;

use self::{membrane::TissueMembrane, relaxation::RelaxationState};
use crate::scene::{GroundLayer, Lumps, Scene, TissueModel as TissueConfig};

/// Soft tissue. Without effects its only state is the lateral displacement of its surface by the tip.
#[derive(Clone, Debug)]
pub struct Tissue {
    config: TissueConfig,
    /// Rest position of the surface point under the tip, m (horizontal).
    anchor_m: Option<Vector3<f64>>,
    /// Effects of the scene; each costs time only where it is listed.
    layers: Vec<GroundLayer>,
    lumps: Option<Lumps>,
    relaxing: Option<RelaxationState>,
    membrane: Option<TissueMembrane>,
}

impl Tissue {
    pub const fn new(config: TissueConfig) -> Self {
        Self { config, anchor_m: None, layers: Vec::new(), lumps: None, relaxing: None, membrane: None }
    }

    /// Returns the untouched tissue of this scene with all its effects, for steps of this length (s); `None` without
    /// tissue.
    pub fn of(scene: &Scene, step_s: f64) -> Option<Self> {
        let Scene { layers, lumps, relaxation, membrane, .. } = scene;
        let config = scene.tissue?;
        // The tissue itself is the lowest layer.
        let own = GroundLayer { stiffness: config.stiffness, exponent: config.exponent };
        let layers = if layers.is_empty() { Vec::new() } else { layers.iter().copied().chain([own]).collect() };
        Some(Self {
            config,
            anchor_m: None,
            layers,
            lumps: lumps.as_ref().map(|lumps| lumps.placed(scene.seed, config.size_m)),
            relaxing: relaxation.map(|relaxation| RelaxationState::new(relaxation, step_s)),
            membrane: membrane.map(TissueMembrane::new),
        })
    }

    /// Sets the time between calls of [`contact_n`](Self::contact_n) from the next call on, s. A time of 0 changes
    /// nothing.
    pub(crate) fn set_step(&mut self, step_s: f64) {
        if let Some(relaxing) = self.relaxing.as_mut().filter(|_| step_s > 0.0) {
            relaxing.set_step(step_s);
        }
    }

    /// Returns the number of tears in the membrane.
    pub fn tears(&self) -> usize {
        self.membrane.as_ref().map_or(0, TissueMembrane::tears)
    }

    /// Returns the force on the tip (N) at this position (m) and velocity (m/s); call it once per step.
    ///
    /// Normal force after Hunt and Crossley, `k d^n (1 + c d')`, never negative; where the scene has layers, lumps or
    /// relaxation, they replace `k d^n`. Tangential force elastic up to the Coulomb limit, then sliding (Dahl's model
    /// without the hysteresis exponent).
    ///
    /// ```
    /// use nalgebra::Vector3;
    /// use nima_simulation::{Tissue, scene::Scene};
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
        let TissueConfig { surface_z_m, size_m, damping_s_m, friction, shear_stiffness_n_m, .. } = self.config;
        let depth_m = surface_z_m - tip_m.z;
        let beside = tip_m.x.abs() > 0.5 * size_m[0] || tip_m.y.abs() > 0.5 * size_m[1];
        let membrane_n = match &mut self.membrane {
            Some(membrane) if !beside => Vector3::new(0.0, 0.0, membrane.force_n(tip_m)),
            _ => Vector3::zeros(),
        };
        if depth_m <= 0.0 || beside {
            self.anchor_m = None;
            // Tissue that is not touched recovers.
            if let Some(relaxing) = &mut self.relaxing {
                relaxing.step(0.0);
            }
            return membrane_n;
        }
        let elastic_n = self.elastic_n(depth_m, tip_m);
        let held_n = self.relaxing.as_mut().map_or(elastic_n, |relaxing| relaxing.step(elastic_n));
        // Upward is positive, so the force grows while the tip moves in.
        let normal_n = (held_n * (1.0 - damping_s_m * velocity_m_s.z)).max(0.0);
        let here = Vector3::new(tip_m.x, tip_m.y, 0.0);
        let stretch_m = here - self.anchor_m.unwrap_or(here);
        let slip_m = if shear_stiffness_n_m > 0.0 { friction * normal_n / shear_stiffness_n_m } else { 0.0 };
        let length_m = stretch_m.norm();
        let held_m = if length_m > slip_m { stretch_m * (slip_m / length_m) } else { stretch_m };
        // Beyond the Coulomb limit the surface point follows the tip.
        self.anchor_m = Some(here - held_m);
        Vector3::new(0.0, 0.0, normal_n) - held_m * shear_stiffness_n_m + membrane_n
    }

    /// Returns the force of the tissue that is compressed by this depth, before relaxation, N.
    fn elastic_n(&self, depth_m: f64, tip_m: &Vector3<f64>) -> f64 {
        let TissueConfig { stiffness, exponent, .. } = self.config;
        let even_n = match self.layers.as_slice() {
            [] => stiffness * depth_m.powf(exponent),
            layers => layers::force_n(layers, depth_m),
        };
        self.lumps.as_ref().map_or(even_n, |lumps| even_n * lumps::factor(lumps, tip_m))
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

    #[test]
    fn over_a_hidden_lump_the_force_is_that_of_the_law_and_fades_while_it_is_held() {
        let scene = Scene::load("lumps").unwrap();
        let config = scene.tissue.unwrap();
        let lumps = scene.lumps.clone().unwrap();
        let relaxation = scene.relaxation.unwrap();
        for lump in &lumps.list {
            let mut tissue = Tissue::of(&scene, 1e-3).unwrap();
            let [x_m, y_m] = lump.position_m;
            let at = |depth_m: f64| Vector3::new(x_m, y_m, config.surface_z_m - depth_m);
            let soft_n = config.stiffness * 0.008_f64.powf(config.exponent);
            let left_m = lumps.thickness_m - 2.0 * lump.radius_m * (1.0 - 1.0 / lump.times_stiffer);
            let law_n = soft_n * lumps.thickness_m / left_m;
            let first_n = tissue.contact_n(&at(0.008), &Vector3::zeros()).z;
            assert!((first_n / law_n - 1.0).abs() < 0.02, "{first_n} N, law {law_n} N");
            let held: Vec<f64> = (0..8000).map(|_| tissue.contact_n(&at(0.008), &Vector3::zeros()).z).collect();
            assert!((held[7999] / (law_n * (1.0 - relaxation.fraction)) - 1.0).abs() < 1e-3, "{} N", held[7999]);
        }
    }

    #[test]
    fn what_a_scene_does_not_list_changes_nothing() {
        let scene = Scene::load("peg_transfer").unwrap();
        let mut plain = Tissue::new(scene.tissue.unwrap());
        let mut of_scene = Tissue::of(&scene, 1e-3).unwrap();
        for i in 0..2000 {
            let t_s = f64::from(i) * 1e-3;
            let tip_m = Vector3::new(0.01 * t_s, 0.0, 0.005 * (5.0 * t_s).cos());
            let velocity_m_s = Vector3::new(0.01, 0.0, -0.025 * (5.0 * t_s).sin());
            assert_eq!(plain.contact_n(&tip_m, &velocity_m_s), of_scene.contact_n(&tip_m, &velocity_m_s));
        }
        assert_eq!(of_scene.tears(), 0);
    }
}
