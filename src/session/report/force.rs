//! Measures of a force over time.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};
use serde::Serialize;

/// Statistics of one force while the arm is engaged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ForceFigures {
    /// Number of samples.
    pub samples: u64,
    /// Maximum length, N.
    pub peak_n: f64,
    /// Time of the maximum, s since the start of the session.
    pub peak_at_s: f64,
    pub mean_n: f64,
    /// Integral of the length over time, N s.
    pub integral_n_s: f64,
    /// Standard deviations along the force's principal axes, the largest first, N.
    pub principal_sd_n: [f64; 3],
    /// Volume of the ellipsoid with these half axes, N^3.
    pub volume_n3: f64,
    /// Root mean square of the force's rate of change, N/s.
    pub rate_rms_n_s: f64,
    /// Maximum rate of change, N/s.
    pub rate_peak_n_s: f64,
}

/// Collects the samples of one force.
#[derive(Clone, Debug, Default)]
pub(super) struct ForceStatistics {
    figures: ForceFigures,
    sum_length_n: f64,
    mean_n: Vector3<f64>,
    /// Sum of the products of the deviations from the mean, N^2 (Welford).
    products_n2: Matrix3<f64>,
    rates: u64,
    rate_squares: f64,
    before: Option<Vector3<f64>>,
}

impl ForceStatistics {
    /// Adds a sample that holds for `dt_s`; it follows the previous one unless `begins`. A sample that is not finite is
    /// left out.
    pub(super) fn add(&mut self, t_s: f64, dt_s: f64, force_n: Vector3<f64>, begins: bool) {
        if !force_n.iter().all(|part| part.is_finite()) {
            self.before = None;
            return;
        }
        let figures = &mut self.figures;
        let length_n = force_n.norm();
        if length_n > figures.peak_n {
            figures.peak_n = length_n;
            figures.peak_at_s = t_s;
        }
        figures.samples += 1;
        figures.integral_n_s += length_n * dt_s;
        self.sum_length_n += length_n;
        let from_old = force_n - self.mean_n;
        self.mean_n += from_old / figures.samples as f64;
        self.products_n2 += from_old * (force_n - self.mean_n).transpose();
        if let Some(before) = self.before.filter(|_| !begins && dt_s > 0.0) {
            let rate_n_s = (force_n - before).norm() / dt_s;
            self.rates += 1;
            self.rate_squares += rate_n_s * rate_n_s;
            figures.rate_peak_n_s = figures.rate_peak_n_s.max(rate_n_s);
        }
        self.before = Some(force_n);
    }

    /// Returns the statistics; `None` without a sample.
    pub(super) fn figures(&self) -> Option<ForceFigures> {
        let mut figures = self.figures;
        if figures.samples == 0 {
            return None;
        }
        let count = figures.samples as f64;
        figures.mean_n = self.sum_length_n / count;
        let covariance_n2 = self.products_n2 / count;
        // Rounding breaks the symmetry; restore it.
        let covariance_n2 = (covariance_n2 + covariance_n2.transpose()) * 0.5;
        let mut sd_n: [f64; 3] =
            SymmetricEigen::new(covariance_n2).eigenvalues.map(|value| value.max(0.0).sqrt()).into();
        sd_n.sort_by(|a, b| b.total_cmp(a));
        figures.principal_sd_n = sd_n;
        figures.volume_n3 = 4.0 / 3.0 * std::f64::consts::PI * sd_n.iter().product::<f64>();
        figures.rate_rms_n_s = (self.rate_squares / self.rates.max(1) as f64).sqrt();
        Some(figures)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use super::*;

    fn near(value: f64, expected: f64, within: f64) {
        assert!((value - expected).abs() <= within, "{value} instead of {expected}");
    }

    #[test]
    fn a_sine_along_each_axis_has_the_figures_of_the_books() {
        // Whole periods of 1, 2 and 3 Hz with 2, 1 and 0.5 N: the standard deviations are the amplitudes over the
        // square root of two.
        let mut measured = ForceStatistics::default();
        let mut lengths_n = 0.0;
        let mut peak_n = 0.0_f64;
        for i in 0..4000 {
            let t_s = f64::from(i) * 1e-3;
            let force_n =
                Vector3::new(5.0 + 2.0 * (TAU * t_s).sin(), (2.0 * TAU * t_s).sin(), 0.5 * (3.0 * TAU * t_s).sin());
            lengths_n += force_n.norm();
            peak_n = peak_n.max(force_n.norm());
            measured.add(t_s, 1e-3, force_n, i == 0);
        }
        let figures = measured.figures().unwrap();
        near(figures.peak_n, peak_n, 1e-12);
        near(figures.mean_n, lengths_n / 4000.0, 1e-9);
        near(figures.integral_n_s, lengths_n * 1e-3, 1e-9);
        for (sd_n, amplitude_n) in figures.principal_sd_n.into_iter().zip([2.0, 1.0, 0.5]) {
            near(sd_n, amplitude_n / 2.0_f64.sqrt(), 1e-3);
        }
        near(figures.volume_n3, 4.0 / 3.0 * PI * 1.0 / 8.0_f64.sqrt(), 1e-3);
        // The mean square of each rate is half the square of amplitude times angular frequency.
        let squares = [2.0 * TAU, 2.0 * TAU, 1.5 * TAU].map(|rate| 0.5 * rate * rate);
        near(figures.rate_rms_n_s, squares.iter().sum::<f64>().sqrt(), 2e-3);
        near(figures.rate_peak_n_s, (8.0 + 2.25_f64).sqrt() * TAU, 2e-2);
    }

    #[test]
    fn what_is_turned_has_the_same_volume_and_a_line_has_none() {
        let turn = nalgebra::Rotation3::from_euler_angles(0.4, -0.9, 1.3);
        let [mut straight, mut turned, mut line] = [0; 3].map(|_| ForceStatistics::default());
        for i in 0..1000 {
            let angle = f64::from(i) * TAU * 1e-3;
            let force_n = Vector3::new(3.0 * angle.sin(), angle.cos(), (2.0 * angle).sin());
            straight.add(0.0, 1e-3, force_n, i == 0);
            turned.add(0.0, 1e-3, turn * force_n, i == 0);
            line.add(0.0, 1e-3, turn * Vector3::x() * angle.sin(), i == 0);
        }
        let volume_n3 = |of: &ForceStatistics| of.figures().unwrap().volume_n3;
        near(volume_n3(&straight), volume_n3(&turned), 1e-9);
        assert!(volume_n3(&straight) > 1.0 && volume_n3(&line) < 1e-6);
    }

    #[test]
    fn holes_and_odd_numbers_make_no_rate() {
        let mut measured = ForceStatistics::default();
        measured.add(0.0, 1e-3, Vector3::zeros(), true);
        measured.add(5.0, 1e-3, Vector3::x() * 7.0, true);
        measured.add(5.001, 1e-3, Vector3::x() * f64::NAN, false);
        measured.add(5.002, 1e-3, Vector3::zeros(), false);
        let figures = measured.figures().unwrap();
        assert_eq!((figures.samples, figures.peak_n, figures.peak_at_s, figures.rate_peak_n_s), (3, 7.0, 5.0, 0.0));
        assert_eq!(ForceStatistics::default().figures(), None);
    }
}
