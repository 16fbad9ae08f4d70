//! Stacked layers of tissue as springs in series.

use crate::scene::GroundLayer;

/// Maximum number of halvings and Newton steps: 52 bits.
const STEPS_MAX: u32 = 60;

/// Returns the force (N) on a tip that has compressed all layers together by `depth_m`: each yields by `(f / k)^(1/n)`
/// under the same force `f`, and together they yield by `depth_m` (springs in series; Johnson, Contact Mechanics, 1985,
/// section 4.3, for an elastic foundation).
///
/// Newton's method, kept inside the interval of the solution: the sum rises with the force.
pub(super) fn force_n(layers: &[GroundLayer], depth_m: f64) -> f64 {
    // Each layer alone is stiffer than all of them in series, so the softest layer bounds the force.
    let alone_n = |layer: &GroundLayer| layer.stiffness * depth_m.powf(layer.exponent);
    let mut low_n = 0.0;
    let mut high_n = layers.iter().map(alone_n).fold(f64::INFINITY, f64::min);
    if !(high_n > 0.0 && high_n.is_finite()) {
        return 0.0;
    }
    // Exact for equal linear layers.
    let mut force_n = high_n / layers.len() as f64;
    for _ in 0..STEPS_MAX {
        let mut given_m = 0.0;
        let mut slope_m_n = 0.0;
        for layer in layers {
            let by_m = (force_n / layer.stiffness).powf(1.0 / layer.exponent);
            given_m += by_m;
            slope_m_n += by_m / (layer.exponent * force_n);
        }
        if given_m > depth_m {
            high_n = force_n;
        } else {
            low_n = force_n;
        }
        let step_n = (depth_m - given_m) / slope_m_n;
        // Well above the rounding of a double (2e-16), so that the loop ends.
        if step_n.abs() <= 1e-12 * force_n {
            break;
        }
        let newton_n = force_n + step_n;
        force_n = if newton_n > low_n && newton_n < high_n { newton_n } else { 0.5 * (low_n + high_n) };
    }
    force_n
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn layer(stiffness: f64, exponent: f64) -> GroundLayer {
        GroundLayer { stiffness, exponent }
    }

    #[test]
    fn linear_layers_are_springs_in_series() {
        let layers = [layer(300.0, 1.0), layer(700.0, 1.0), layer(2000.0, 1.0)];
        let together = 1.0 / (1.0 / 300.0 + 1.0 / 700.0 + 1.0 / 2000.0);
        for depth_m in [1e-6, 0.003, 0.02] {
            assert!((force_n(&layers, depth_m) / (together * depth_m) - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn equal_layers_share_the_depth_and_one_layer_is_its_own_law() {
        for exponent in [1.0, 1.3, 1.5, 2.0, 3.0] {
            let one = layer(1300.0, exponent);
            let alone = |depth_m: f64| 1300.0 * depth_m.powf(exponent);
            for depth_m in [1e-5, 0.004, 0.02] {
                assert!((force_n(&[one], depth_m) / alone(depth_m) - 1.0).abs() < 1e-9);
                assert!((force_n(&[one; 4], depth_m) / alone(depth_m / 4.0) - 1.0).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn a_soft_cover_on_a_hard_ground_gives_the_depth_back() {
        let layers = [layer(800.0, 1.4), layer(60_000.0, 1.1)];
        for depth_m in [1e-9, 0.001, 0.015, 0.5] {
            let force_n = force_n(&layers, depth_m);
            let given_m: f64 = layers.iter().map(|layer| (force_n / layer.stiffness).powf(1.0 / layer.exponent)).sum();
            assert!((given_m / depth_m - 1.0).abs() < 1e-9, "{given_m} m of {depth_m} m");
        }
        assert!(force_n(&layers, 0.0).abs() < 1e-15);
    }
}
