//! Smoothness of a movement: log dimensionless jerk and spectral arc length.

use crate::signal::{RATE_HZ, STEP_S, magnitude_spectrum, peak};

/// The spectrum is used up to this frequency, Hz; within it, up to the last frequency with this fraction of the maximum
/// magnitude. The signal is padded to 2^4 times its length. All three: Balasubramanian et al. 2015.
const CUTOFF_HZ: f64 = 10.0;
const THRESHOLD: f64 = 0.05;
const PADDING: usize = 16;

/// If a hand was never faster than this, m/s, there is no movement to evaluate: its spectrum would be that of noise.
const MOVED_M_PER_S: f64 = 0.005;
/// Minimum number of points of an evaluated segment: 0.2 s.
const MIN_POINTS: usize = 21;

/// Returns whether there is a movement to evaluate.
fn judged(speed: &[f64]) -> bool {
    speed.len() >= MIN_POINTS && peak(std::iter::once(speed)).is_some_and(|peak| peak >= MOVED_M_PER_S)
}

/// `-ln(T^3 / v_peak^2 * integral of |jerk|^2)`: Hogan and Sternad 2009; Balasubramanian et al. 2015.
pub(crate) fn log_dimensionless_jerk(speed: &[f64], jerk: &[f64]) -> Option<f64> {
    if !judged(speed) {
        return None;
    }
    let peak = peak(std::iter::once(speed))?;
    let square: f64 = jerk.windows(2).map(|two| f64::midpoint(two[0] * two[0], two[1] * two[1]) * STEP_S).sum();
    let duration_s = (jerk.len().checked_sub(1)?) as f64 * STEP_S;
    let dimensionless = duration_s * duration_s * duration_s / (peak * peak) * square;
    (dimensionless > 0.0).then(|| -libm::log(dimensionless))
}

/// Returns the length of the normalised spectrum of the speed, negative: smoother is nearer to zero.
pub(crate) fn spectral_arc_length(speed: &[f64]) -> Option<f64> {
    if !judged(speed) {
        return None;
    }
    let length = speed.len().next_power_of_two() * PADDING;
    let bin_hz = RATE_HZ / length as f64;
    let bins = (CUTOFF_HZ / bin_hz) as usize + 1;
    let mut spectrum = magnitude_spectrum(speed, length, bins);
    // A speed is never negative, so no magnitude exceeds the one at frequency zero.
    let largest = spectrum.first().copied().filter(|largest| *largest > 0.0)?;
    for magnitude in &mut spectrum {
        *magnitude /= largest;
    }
    let last = spectrum.iter().rposition(|magnitude| *magnitude >= THRESHOLD)?;
    let step = (last > 0).then(|| 1.0 / last as f64)?;
    let piece = |two: &[f64]| (step * step + (two[1] - two[0]) * (two[1] - two[0])).sqrt();
    Some(-spectrum[..=last].windows(2).map(piece).sum::<f64>())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Results of the authors' Python (github.com/siva82kb/SPARC, `scripts/smoothness.py`), run with `NumPy`.
    #[test]
    fn the_spectral_arc_length_is_that_of_the_authors() {
        let gauss = |k: i32| (-5.0 * (f64::from(k - 100) / 100.0).powi(2)).exp();
        let reach = |k: i32, n: i32| {
            let s = f64::from(k) / f64::from(n);
            30.0 * s * s * (1.0 - s) * (1.0 - s)
        };
        let second = |n: i32| (0..=n).map(move |k| reach(k, n));
        let wobble = |k: i32| {
            let t = f64::from(k) / 100.0;
            let turn = 2.0 * std::f64::consts::PI;
            1.0 - (turn * t / 3.0).cos() + 0.2 * (turn * 4.0 * t).sin().powi(2)
        };
        let two = second(100).chain(std::iter::repeat_n(0.0, 50)).chain(second(100));
        let cases: [(Vec<f64>, f64); 6] = [
            ((0..200).map(gauss).collect(), -1.414_031_261_710),
            (second(50).collect(), -1.405_829_970_229),
            (second(100).collect(), -1.405_829_324_421),
            (second(400).collect(), -1.405_829_281_641),
            (two.collect(), -3.094_880_980_034),
            ((0..=300).map(wobble).collect(), -1.406_889_368_004),
        ];
        for (speed, theirs) in cases {
            let ours = spectral_arc_length(&speed).unwrap();
            assert!((ours - theirs).abs() < 1e-9, "{ours} {theirs}");
        }
    }

    #[test]
    fn a_hand_at_rest_is_neither_smooth_nor_jerky() {
        assert_eq!(spectral_arc_length(&[0.0; 500]), None);
        assert_eq!(spectral_arc_length(&[1.0; 5]), None, "too short");
        assert_eq!(log_dimensionless_jerk(&[0.0; 500], &[0.0; 500]), None);
    }
}
