//! Estimates the stiffness of the current contact from the ticks: the slope of force over displacement along the force, by
//! least squares over the last half second of contact.
//!
//! Displacement in m, force in N (workspace frame), stiffness in N/m. Only moments are stored, so a tick costs a few
//! multiplications. Non-finite values are ignored; between contacts the last stiffness is kept.

use nalgebra::{Matrix3, Vector3};

/// A smaller force is not considered a contact, N.
pub const CONTACT_N: f64 = 0.3;
/// Averaging time, s.
const MEMORY_S: f64 = 0.5;
/// After a pause of this length a contact counts as new, s.
const PAUSE_S: f64 = 0.2;
/// Contact time, s, and variation of the displacement, m, needed for an estimate.
const MIN_S: f64 = 0.15;
const MIN_TRAVEL_M: f64 = 2e-4;

/// Exponentially weighted moments of displacement and force.
#[derive(Clone, Copy, Debug, Default)]
pub struct ContactStiffness {
    weight_s: f64,
    travel_m: Vector3<f64>,
    force_n: Vector3<f64>,
    way_way: Matrix3<f64>,
    force_way: Matrix3<f64>,
    last_s: Option<f64>,
    n_m: Option<f64>,
}

impl ContactStiffness {
    /// Adds tip position and force at a time (s).
    pub fn push(&mut self, t_s: f64, tip_m: &Vector3<f64>, force_n: &Vector3<f64>) {
        let finite = t_s.is_finite() && tip_m.iter().chain(force_n).all(|x| x.is_finite());
        if !finite || force_n.norm() < CONTACT_N {
            return;
        }
        let dt_s = self.last_s.map_or(f64::INFINITY, |last_s| t_s - last_s);
        if !(0.0..PAUSE_S).contains(&dt_s) {
            // The last stiffness stays on the screen until the new contact has one.
            *self = Self { n_m: self.n_m, last_s: Some(t_s), ..Self::default() };
            return;
        }
        self.last_s = Some(t_s);
        self.weight_s = self.weight_s * (-dt_s / MEMORY_S).exp() + dt_s;
        if self.weight_s <= 0.0 {
            return;
        }
        let fraction = dt_s / self.weight_s;
        let way = tip_m - self.travel_m;
        let force = force_n - self.force_n;
        self.travel_m += fraction * way;
        self.force_n += fraction * force;
        let keep = 1.0 - fraction;
        self.way_way = keep * (self.way_way + fraction * way * way.transpose());
        self.force_way = keep * (self.force_way + fraction * force * way.transpose());
        self.notify();
    }

    fn notify(&mut self) {
        let Some(along) = self.force_n.try_normalize(1e-9) else { return };
        let travel_m2 = (along.transpose() * self.way_way * along)[0];
        if self.weight_s < MIN_S || travel_m2 < MIN_TRAVEL_M * MIN_TRAVEL_M {
            return;
        }
        // Negative, because the force of the tissue opposes the displacement.
        let n_m = -(along.transpose() * self.force_way * along)[0] / travel_m2;
        // Values outside are noise, not a contact.
        if (1.0..1e6).contains(&n_m) {
            self.n_m = Some(n_m);
        }
    }

    /// Returns the stiffness of the current or last contact, N/m; `None` before the first.
    pub const fn n_m(&self) -> Option<f64> {
        self.n_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Presses and releases along a direction, with noise of 0.02 N.
    fn pressed(stiffness_n_m: f64, along: Vector3<f64>) -> ContactStiffness {
        let along = along.normalize();
        let mut found = ContactStiffness::default();
        let mut seed = 1_u32;
        for i in 0..2000 {
            let t_s = f64::from(i) * 1e-3;
            let deep_m = 1.2 / stiffness_n_m * (1.0 + 0.6 * (9.0 * t_s).sin()).max(0.0);
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let noise_n = 0.04 * (f64::from(seed >> 8) / f64::from(1 << 24) - 0.5);
            found.push(t_s, &(-along * deep_m), &(along * (stiffness_n_m * deep_m + noise_n)));
        }
        found
    }

    #[test]
    fn a_spring_is_found_whatever_its_stiffness_and_direction() {
        for n_m in [50.0, 240.0, 1200.0] {
            for along in [Vector3::z(), Vector3::new(1.0, -2.0, 0.5)] {
                let found = pressed(n_m, along).n_m().unwrap();
                assert!((found / n_m - 1.0).abs() < 0.05, "{found} for {n_m}");
            }
        }
    }

    #[test]
    fn without_contact_or_without_motion_nothing_is_told_and_a_known_stiffness_stays() {
        let mut found = ContactStiffness::default();
        for i in 0..1000 {
            let t_s = f64::from(i) * 1e-3;
            found.push(t_s, &Vector3::new(0.0, 0.0, t_s), &(0.1 * Vector3::z()));
            found.push(t_s, &Vector3::zeros(), &Vector3::z());
            found.push(f64::NAN, &Vector3::z(), &Vector3::z());
            found.push(t_s, &Vector3::repeat(f64::NAN), &Vector3::z());
        }
        assert_eq!(found.n_m(), None);
        let mut known = pressed(240.0, Vector3::z());
        let before = known.n_m();
        for i in 0..1000 {
            known.push(3.0 + f64::from(i) * 1e-3, &Vector3::zeros(), &Vector3::zeros());
        }
        assert_eq!(known.n_m(), before);
    }
}
