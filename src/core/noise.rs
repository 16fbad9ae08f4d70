//! Seeded random numbers.

/// A seeded source of standard normal numbers.
///
/// ```
/// use nima_core::noise::Noise;
///
/// let (mut one, mut same) = (Noise::new(7), Noise::new(7));
/// let mean = (0..10_000).map(|_| one.gaussian()).sum::<f64>() / 1e4;
/// assert!(mean.abs() < 0.05, "{mean}");
/// assert_eq!((0..10_000).map(|_| same.gaussian()).sum::<f64>() / 1e4, mean, "one seed, one sequence");
/// ```
#[derive(Clone, Debug)]
pub struct Noise {
    rng: fastrand::Rng,
    spare: Option<f64>,
}

impl Noise {
    pub fn new(seed: u64) -> Self {
        Self { rng: fastrand::Rng::with_seed(seed), spare: None }
    }

    /// Returns a number that is uniform in 0..1.
    pub fn uniform(&mut self) -> f64 {
        self.rng.f64()
    }

    /// Returns a standard normal random number (Box-Muller, using both values).
    pub fn gaussian(&mut self) -> f64 {
        // Box-Muller yields two numbers; the second one is kept for the next call.
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        // `1 - u` is in (0, 1], so the logarithm is finite.
        let radius = (-2.0 * libm::log(1.0 - self.rng.f64())).sqrt();
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * self.rng.f64());
        self.spare = Some(radius * sin);
        radius * cos
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_and_deviation_are_those_of_the_standard_normal() {
        let mut noise = Noise::new(1);
        let values: Vec<f64> = (0..100_000).map(|_| noise.gaussian()).collect();
        let mean = values.iter().sum::<f64>() / 1e5;
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 1e5;
        assert!(mean.abs() < 0.02 && (variance - 1.0).abs() < 0.02, "{mean} {variance}");
    }
}
