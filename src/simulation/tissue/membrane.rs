//! A membrane over the tissue that tears.

use nalgebra::Vector3;

use crate::scene::GroundMembrane as Config;

/// Number of holes that are stored; the oldest closes when there are more.
const HOLES: usize = 32;

/// A membrane with the law `a d + b d^2` until it tears at a force (the capsule of an organ before a needle breaks
/// through: Okamura, Simone and O'Leary, IEEE Trans. Biomed. Eng. 51(10), 2004). A hole stays.
#[derive(Clone, Copy, Debug)]
pub(super) struct TissueMembrane {
    config: Config,
    holes_m: [Option<[f64; 2]>; HOLES],
    torn: usize,
}

impl TissueMembrane {
    pub(super) const fn new(config: Config) -> Self {
        Self { config, holes_m: [None; HOLES], torn: 0 }
    }

    /// Returns the force along z on a tip at this position, N; call it once per step.
    pub(super) fn force_n(&mut self, tip_m: &Vector3<f64>) -> f64 {
        let Config { height_m, stiffness_n_m, stiffening_n_m2, tears_at_n, hole_radius_m } = self.config;
        let depth_m = height_m - tip_m.z;
        let is_in = |hole_m: &[f64; 2]| (tip_m.x - hole_m[0]).hypot(tip_m.y - hole_m[1]) <= hole_radius_m;
        if depth_m <= 0.0 || self.holes_m.iter().flatten().any(is_in) {
            return 0.0;
        }
        let force_n = (stiffness_n_m + stiffening_n_m2 * depth_m) * depth_m;
        if force_n < tears_at_n {
            return force_n;
        }
        // The force ends in one step, as at the moment when a needle breaks through.
        self.holes_m[self.torn % HOLES] = Some([tip_m.x, tip_m.y]);
        self.torn += 1;
        0.0
    }

    /// Returns the number of tears.
    pub(super) const fn tears(&self) -> usize {
        self.torn
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn membrane() -> TissueMembrane {
        TissueMembrane::new(Config {
            height_m: 0.004,
            stiffness_n_m: 100.0,
            stiffening_n_m2: 20_000.0,
            tears_at_n: 1.5,
            hole_radius_m: 0.003,
        })
    }

    #[test]
    fn it_gives_way_by_its_law_until_it_tears_and_the_hole_stays() {
        let mut membrane = membrane();
        let mut max_n: f64 = 0.0;
        for i in 0..200 {
            let depth_m = f64::from(i) * 5e-5;
            let force_n = membrane.force_n(&Vector3::new(0.0, 0.0, 0.004 - depth_m));
            if membrane.tears() == 0 {
                assert!((force_n - (100.0 * depth_m + 20_000.0 * depth_m * depth_m)).abs() < 1e-12);
                max_n = max_n.max(force_n);
            } else {
                assert!(force_n.abs() < 1e-15);
            }
        }
        assert!((1.48..1.5).contains(&max_n) && membrane.tears() == 1, "{max_n} N");
        assert!(membrane.force_n(&Vector3::new(0.002, 0.0, 0.0)).abs() < 1e-15, "in the hole");
        let beside_n = membrane.force_n(&Vector3::new(0.004, 0.0, 0.0));
        assert!(beside_n > 0.5, "next to the hole: {beside_n} N");
    }
}
