//! A rigid wall.

use nalgebra::Vector3;

use crate::scene::Wall;

impl Wall {
    /// Returns the force on a tip at this position (m) and velocity (m/s), N: a spring and a damper that never pull
    /// (the virtual wall of Colgate and Brown, IEEE ICRA 1994).
    pub(crate) fn contact_n(&self, tip_m: &Vector3<f64>, velocity_m_s: &Vector3<f64>) -> Vector3<f64> {
        let normal = Vector3::from(self.normal).normalize();
        let depth_m = normal.dot(&(Vector3::from(self.position_m) - tip_m));
        if depth_m <= 0.0 {
            return Vector3::zeros();
        }
        normal * (self.stiffness_n_m * depth_m - self.damping_n_s_m * normal.dot(velocity_m_s)).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_pushes_along_its_normal_and_never_pulls() {
        let wall =
            Wall { position_m: [0.03, 0.0, 0.0], normal: [-2.0, 0.0, 0.0], stiffness_n_m: 4000.0, damping_n_s_m: 20.0 };
        let at = |x_m: f64, vx: f64| wall.contact_n(&Vector3::new(x_m, 0.01, 0.0), &Vector3::new(vx, 0.0, 0.0));
        assert_eq!(at(0.029, 0.1), Vector3::zeros());
        assert!((at(0.0305, 0.0) - Vector3::new(-2.0, 0.0, 0.0)).norm() < 1e-9);
        assert!((at(0.0305, 0.05) - Vector3::new(-3.0, 0.0, 0.0)).norm() < 1e-9);
        assert_eq!(at(0.0305, -1.0), Vector3::zeros());
    }
}
