//! Stiff lumps in soft tissue.

use nalgebra::Vector3;
use nima_core::noise::Noise;

use crate::scene::{Lump, Lumps, RandomLumps};

/// Number of attempts to place one lump before giving up for lack of room.
const DRAWS_MAX: u32 = 2000;
/// Makes the positions of lumps independent of the random sequences of tremor and noise.
const LOT: u64 = 0x1_0b05;

impl Lumps {
    /// Returns the lumps with a position for each random one; fewer if there is no room for all.
    #[must_use]
    pub(crate) fn placed(&self, seed: u64, size_m: [f64; 2]) -> Self {
        let mut placed = Self { drawn: None, ..self.clone() };
        let Some(RandomLumps { count, radius_m: [min_m, max_m], times_stiffer, apart_m, margin_m }) = self.drawn else {
            return placed;
        };
        let mut lot = Noise::new(seed ^ LOT);
        let half_m = size_m.map(|size_m| (0.5 * size_m - margin_m).max(0.0));
        for _ in 0..count {
            let radius_m = min_m + (max_m - min_m) * lot.uniform();
            let place = (0..DRAWS_MAX).find_map(|_| {
                let position_m = half_m.map(|half_m| half_m * (2.0 * lot.uniform() - 1.0));
                let clear = |lump: &Lump| {
                    (lump.position_m[0] - position_m[0]).hypot(lump.position_m[1] - position_m[1]) >= apart_m
                };
                placed.list.iter().all(clear).then_some(position_m)
            });
            let Some(position_m) = place else { break };
            placed.list.push(Lump { position_m, radius_m, times_stiffer });
        }
        placed
    }
}

/// Returns the stiffness of the tissue under a tip at this position, as a multiple of the stiffness without lumps.
///
/// The tissue is an elastic foundation (Johnson, Contact Mechanics, 1985, section 4.3): independent columns of height `h`, whose stiffness is
/// `E / h`. A lump of `r` times their modulus fills the chord `t` of its sphere above the place; the column is then as one of the
/// height `h - t (1 - 1/r)`.
pub(super) fn factor(lumps: &Lumps, tip_m: &Vector3<f64>) -> f64 {
    let filled_m: f64 = lumps.list.iter().map(|lump| lump.times_softer(tip_m)).sum();
    // However much lumps overlap, at least a twentieth of the column remains soft.
    lumps.thickness_m / (lumps.thickness_m - filled_m).max(0.05 * lumps.thickness_m)
}

impl Lump {
    /// Returns the height by which the lump shortens the column at this position, m.
    fn times_softer(&self, tip_m: &Vector3<f64>) -> f64 {
        let [x_m, y_m] = self.position_m;
        let aside = (tip_m.x - x_m).hypot(tip_m.y - y_m);
        let chord_m = 2.0 * (self.radius_m * self.radius_m - aside * aside).max(0.0).sqrt();
        chord_m * (1.0 - 1.0 / self.times_stiffer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lumps() -> Lumps {
        let lump = Lump { position_m: [0.01, -0.02], radius_m: 0.006, times_stiffer: 10.0 };
        Lumps { thickness_m: 0.03, list: vec![lump], drawn: None }
    }

    fn drawn() -> Lumps {
        let drawn =
            RandomLumps { count: 5, radius_m: [0.004, 0.006], times_stiffer: 10.0, apart_m: 0.018, margin_m: 0.012 };
        Lumps { list: Vec::new(), drawn: Some(drawn), ..lumps() }
    }

    #[test]
    fn drawn_lumps_lie_apart_inside_the_margin_and_elsewhere_with_every_seed() {
        let mut seen = Vec::new();
        for seed in 0..200 {
            let placed = drawn().placed(seed, [0.12, 0.09]);
            assert_eq!(placed, drawn().placed(seed, [0.12, 0.09]), "one seed, one place");
            assert_eq!((placed.list.len(), placed.drawn), (5, None));
            for (i, lump) in placed.list.iter().enumerate() {
                let [x_m, y_m] = lump.position_m;
                assert!(x_m.abs() <= 0.048 && y_m.abs() <= 0.033 && (0.004..=0.006).contains(&lump.radius_m));
                let apart = |other: &Lump| (other.position_m[0] - x_m).hypot(other.position_m[1] - y_m) >= 0.018;
                assert!(placed.list[..i].iter().all(apart), "seed {seed}");
            }
            seen.push(placed.list[0].position_m);
        }
        // Random positions cover every corner of the tissue.
        for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
            let near = seen.iter().filter(|[x_m, y_m]| x * x_m > 0.0 && y * y_m > 0.0).count();
            assert!(near > 25, "{near} of 200 in this corner");
        }
    }

    #[test]
    fn what_has_no_room_is_left_out() {
        let mut lumps = drawn();
        lumps.drawn.iter_mut().for_each(|drawn| (drawn.count, drawn.apart_m) = (30, 0.05));
        assert!((1..30).contains(&lumps.placed(1, [0.12, 0.09]).list.len()));
    }

    #[test]
    fn over_the_middle_the_column_is_shorter_by_the_lump() {
        let factor = factor(&lumps(), &Vector3::new(0.01, -0.02, 0.0));
        // A 30 mm column, 12 mm of it ten times as stiff.
        assert!((factor - 30.0 / (18.0 + 1.2)).abs() < 1e-12, "{factor}");
    }

    #[test]
    fn beside_it_there_is_nothing_and_in_between_it_rises_without_a_step() {
        let at = |x_m: f64| factor(&lumps(), &Vector3::new(0.01 + x_m, -0.02, 0.0));
        assert_eq!((at(0.006), at(-0.02)), (1.0, 1.0));
        let mut before = at(0.0);
        for i in 1..=600 {
            let here = at(f64::from(i) * 1e-5);
            assert!(here <= before && before - here < 0.05, "{i}");
            before = here;
        }
    }
}
