//! Friction and support where the instrument passes the body wall.

use nalgebra::Vector3;

use crate::scene::TrocarModel as TrocarConfig;

/// Seal of the trocar. Its state is its elastic deformation along and across the shaft.
#[derive(Clone, Debug)]
pub struct Trocar {
    config: TrocarConfig,
    position_m: Vector3<f64>,
    /// Direction of the shaft and depth of the tip, one step ago.
    last: Option<(Vector3<f64>, f64)>,
    stretch_along_m: f64,
    stretch_across_m: Vector3<f64>,
    force_n: Vector3<f64>,
}

/// Elastic stiffness against rotation of the shaft in the seal, N per m of displacement at the wall.
const ACROSS_STIFFNESS_N_M: f64 = 400.0;

impl Trocar {
    /// Creates an undeformed seal at this position, m (`world`).
    pub fn new(config: TrocarConfig, position_m: Vector3<f64>) -> Self {
        Self {
            config,
            position_m,
            last: None,
            stretch_along_m: 0.0,
            stretch_across_m: Vector3::zeros(),
            force_n: Vector3::zeros(),
        }
    }

    /// Removes all deformation: the instrument was taken out.
    pub(super) const fn relax(&mut self) {
        self.last = None;
        self.stretch_along_m = 0.0;
        self.stretch_across_m = Vector3::new(0.0, 0.0, 0.0);
        self.force_n = Vector3::new(0.0, 0.0, 0.0);
    }

    /// Returns the direction of the shaft (towards the tip) and the depth of the tip beyond the wall, m.
    pub fn shaft(&self, tip_m: &Vector3<f64>) -> (Vector3<f64>, f64) {
        shaft(&self.position_m, tip_m)
    }

    /// Returns the force of the wall on the instrument after the last step, N (`world`); it acts at the wall.
    pub const fn force_n(&self) -> Vector3<f64> {
        self.force_n
    }

    /// Moves the tip of the instrument to `tip_m` within `dt_s`.
    pub fn advance(&mut self, tip_m: &Vector3<f64>, dt_s: f64) {
        let (direction, depth_m) = self.shaft(tip_m);
        let (last_direction, last_depth_m) = self.last.unwrap_or((direction, depth_m));
        self.last = Some((direction, depth_m));
        let wall_n = self.across_n(&direction, &(direction - last_direction), depth_m);
        self.force_n = wall_n - direction * self.along_n(depth_m - last_depth_m, wall_n.norm(), dt_s);
    }

    /// Returns the friction along the shaft (N, against inward motion): the `LuGre` model, integrated semi-implicitly
    /// so that it is stable for any step.
    fn along_n(&mut self, travel_m: f64, load_n: f64, dt_s: f64) -> f64 {
        let TrocarConfig { coulomb_n, static_n, stribeck_m_s, viscous_n_s_m, presliding_m, friction_per_load, .. } =
            self.config;
        if coulomb_n <= 0.0 {
            return viscous_n_s_m * travel_m / dt_s;
        }
        let speed_m_s = travel_m / dt_s;
        let sliding_n = coulomb_n + friction_per_load * load_n;
        let breakaway = static_n / coulomb_n.max(1e-9);
        let slow = (-(speed_m_s / stribeck_m_s).powi(2)).exp();
        let stretch_max_m = presliding_m * (1.0 + (breakaway - 1.0) * slow);
        self.stretch_along_m = (self.stretch_along_m + travel_m) / (1.0 + travel_m.abs() / stretch_max_m);
        sliding_n / presliding_m * self.stretch_along_m + viscous_n_s_m * speed_m_s
    }

    /// Returns the force across the shaft, N: the wall straightens a tilted shaft, and friction opposes its rotation.
    fn across_n(&mut self, direction: &Vector3<f64>, turn: &Vector3<f64>, depth_m: f64) -> Vector3<f64> {
        let down = -Vector3::z();
        let tilt = direction - down * direction.dot(&down);
        let straighten_n = -(tilt - direction * tilt.dot(direction)) * self.config.wall_n;
        // Friction is computed at the wall, from the displacement of the tip.
        let limit_m = self.config.across_n / ACROSS_STIFFNESS_N_M;
        let stretched = self.stretch_across_m + turn * depth_m;
        let across = stretched - direction * stretched.dot(direction);
        let length_m = across.norm();
        self.stretch_across_m = if length_m > limit_m { across * (limit_m / length_m) } else { across };
        straighten_n - self.stretch_across_m * ACROSS_STIFFNESS_N_M
    }
}

/// Returns the direction from the wall to the tip, and its distance, m. Straight down if the tip is in the wall itself.
pub(super) fn shaft(wall_m: &Vector3<f64>, tip_m: &Vector3<f64>) -> (Vector3<f64>, f64) {
    let travel_m = tip_m - wall_m;
    let depth_m = travel_m.norm();
    if depth_m < 1e-6 { (-Vector3::z(), depth_m) } else { (travel_m / depth_m, depth_m) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    fn trocar() -> (Trocar, TrocarConfig) {
        let config = Scene::load("isolation").unwrap().trocar.unwrap();
        (Trocar::new(config, Vector3::new(0.0, 0.0, 0.14)), config)
    }

    /// Moves the tip straight down at this speed; returns the force along z in each step.
    fn plunge(trocar: &mut Trocar, from_z_m: f64, speed_m_s: f64, steps: u32) -> Vec<f64> {
        (1..=steps)
            .map(|i| {
                trocar.advance(&Vector3::new(0.0, 0.0, from_z_m - speed_m_s * f64::from(i) * 1e-3), 1e-3);
                trocar.force_n().z
            })
            .collect()
    }

    #[test]
    fn it_sticks_breaks_away_and_slides_against_the_motion() {
        let (mut trocar, config) = trocar();
        trocar.advance(&Vector3::new(0.0, 0.0, 0.02), 1e-3);
        let slow = plunge(&mut trocar, 0.02, 0.001, 3000);
        let peak = slow.iter().copied().fold(0.0, f64::max);
        assert!((0.8..=1.0).contains(&(peak / config.static_n)), "breaks away at {peak} N");
        let fast = plunge(&mut trocar, 0.017, 0.03, 300);
        let sliding = config.coulomb_n + config.viscous_n_s_m * 0.03;
        assert!((fast[299] - sliding).abs() < 0.02, "slides at {} N", fast[299]);
        let back = plunge(&mut trocar, 0.008, -0.03, 300);
        assert!((back[299] + sliding).abs() < 0.02, "turns round with the motion: {} N", back[299]);
    }

    #[test]
    fn at_rest_it_keeps_its_stretch() {
        let (mut trocar, _) = trocar();
        trocar.advance(&Vector3::new(0.0, 0.0, 0.02), 1e-3);
        plunge(&mut trocar, 0.02, 0.02, 200);
        let resting = plunge(&mut trocar, 0.016, 0.0, 1000);
        assert!(resting[0] > 0.4 && (resting[999] - resting[1]).abs() < 1e-9, "a stuck seal still pulls");
    }

    #[test]
    fn a_tilted_shaft_is_pushed_straight() {
        let (mut trocar, config) = trocar();
        let tip = Vector3::new(0.05, 0.0, 0.02);
        trocar.advance(&tip, 1e-3);
        let (direction, _) = trocar.shaft(&tip);
        let force = trocar.force_n();
        assert!(force.x < -0.2, "{force}");
        assert!(force.dot(&direction).abs() < 1e-9, "nothing along the shaft without motion");
        assert!(force.norm() <= config.wall_n);
    }
}
