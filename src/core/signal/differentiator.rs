use serde::{Deserialize, Serialize};

use super::{Lanes, Motion, foaw::Foaw, kalman::SignalKalman, savitzky_golay::SavitzkyGolay};

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DifferentiatorKind {
    /// Parabola through the last 20 ms (at least 5 samples): no lag at constant acceleration, fixed cost.
    #[default]
    SavitzkyGolay,
    /// Steady-state Kalman filter with a constant-jerk model, 25 Hz.
    Kalman,
    /// First-order adaptive windows up to 20 ms: little noise at rest, little lag in motion.
    Foaw,
}

impl DifferentiatorKind {
    pub const ALL: [Self; 3] = [Self::SavitzkyGolay, Self::Kalman, Self::Foaw];

    /// Returns the name used in files and on the screen.
    pub const fn name(self) -> &'static str {
        match self {
            Self::SavitzkyGolay => "savitzky-golay",
            Self::Kalman => "kalman",
            Self::Foaw => "foaw",
        }
    }
}

/// Length of the finite windows (s). Longer windows delay the speed, and shorter ones amplify the noise of the encoder,
/// because both scale with the window.
const SPAN_S: f64 = 0.02;
/// Minimum number of samples in a finite window, used at low rates. A parabola through fewer samples has no residual,
/// so noise would pass unfiltered.
const MIN_SAMPLES: usize = 5;
/// Longest adaptive window, in samples: its cost increases with the square of its length.
const MAX_FOAW_SAMPLES: usize = 32;
/// Bandwidth of the Kalman filter (Hz). At 15 Hz its acceleration lags by 5.2 instead of 1.3 ms (table in `mod.rs`).
const KALMAN_BANDWIDTH_HZ: f64 = 25.0;
/// Half width of the position noise for adaptive windows (m): one count of a 0.01 mm encoder. Below 1 kHz the windows
/// contain few samples and the band has little effect.
const FOAW_BAND_M: f64 = 1e-5;

/// Turns positions at a fixed rate into [`Motion`]; nothing is allocated after construction.
///
/// ```
/// use nima_core::signal::{Differentiator, DifferentiatorKind, Lanes};
///
/// for kind in DifferentiatorKind::ALL {
///     let mut differentiator = Differentiator::new(kind, 1000.0);
///     let mut motion = Default::default();
///     for tick in 0..1000 {
///         motion = differentiator.step(Lanes::splat(0.2 * f64::from(tick) * 1e-3));
///     }
///     assert!(differentiator.settled());
///     assert!((motion.v[0] - 0.2).abs() < 1e-3, "{}: {} m/s", kind.name(), motion.v[0]);
/// }
/// ```
#[derive(Clone, Debug)]
pub struct Differentiator(DifferentiatorInner);

#[derive(Clone, Debug)]
enum DifferentiatorInner {
    SavitzkyGolay(SavitzkyGolay),
    Kalman(SignalKalman),
    Foaw(Foaw),
}

impl Differentiator {
    pub fn new(kind: DifferentiatorKind, rate_hz: f64) -> Self {
        // At least five also where 20 ms have fewer samples: see `MIN_SAMPLES`.
        let samples = ((SPAN_S * rate_hz).round() as usize).max(MIN_SAMPLES);
        Self(match kind {
            DifferentiatorKind::SavitzkyGolay => {
                DifferentiatorInner::SavitzkyGolay(SavitzkyGolay::new(samples, rate_hz))
            }
            DifferentiatorKind::Kalman => DifferentiatorInner::Kalman(SignalKalman::new(KALMAN_BANDWIDTH_HZ, rate_hz)),
            DifferentiatorKind::Foaw => {
                // Only this filter searches for a window, so only its length is limited.
                DifferentiatorInner::Foaw(Foaw::new(samples.min(MAX_FOAW_SAMPLES), rate_hz, FOAW_BAND_M))
            }
        })
    }

    /// Adds the position of this tick (m, finite) and returns the motion of this tick.
    pub fn step(&mut self, position: Lanes) -> Motion {
        match &mut self.0 {
            DifferentiatorInner::SavitzkyGolay(filter) => filter.step(position),
            DifferentiatorInner::Kalman(filter) => filter.step(position),
            DifferentiatorInner::Foaw(filter) => filter.step(position),
        }
    }

    /// Returns whether enough samples have been added for valid derivatives.
    pub fn settled(&self) -> bool {
        match &self.0 {
            DifferentiatorInner::SavitzkyGolay(filter) => filter.settled(),
            DifferentiatorInner::Kalman(filter) => filter.settled(),
            DifferentiatorInner::Foaw(filter) => filter.settled(),
        }
    }

    pub fn reset(&mut self) {
        match &mut self.0 {
            DifferentiatorInner::SavitzkyGolay(filter) => filter.reset(),
            DifferentiatorInner::Kalman(filter) => filter.reset(),
            DifferentiatorInner::Foaw(filter) => filter.reset(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Applies a differentiator to `motion(t)` and returns the largest errors of (v, a) after settling.
    fn worst_errors(kind: DifferentiatorKind, rate_hz: f64, motion: impl Fn(f64) -> [f64; 3]) -> (f64, f64) {
        let mut differentiator = Differentiator::new(kind, rate_hz);
        let mut dv = 0.0_f64;
        let mut da = 0.0_f64;
        for k in 0..(5.0 * rate_hz) as usize {
            let [x, v, a] = motion(k as f64 / rate_hz);
            let found = differentiator.step(Lanes([x, 0.5 * x, 0.0, 0.0]));
            assert!(found.x.is_finite() && found.v.is_finite() && found.a.is_finite());
            assert!(
                (found.v[1] - 0.5 * found.v[0]).abs() <= 1e-6 + 1e-6 * found.v[0].abs()
                    || kind == DifferentiatorKind::Foaw
            );
            if k as f64 > 4.5 * rate_hz {
                dv = dv.max((found.v[0] - v).abs());
                da = da.max((found.a[0] - a).abs());
            }
        }
        (dv, da)
    }

    #[test]
    fn constant_speed_is_exact_for_all() {
        for kind in DifferentiatorKind::ALL {
            for rate_hz in [20.0, 66.0, 1000.0, 10_000.0] {
                let (dv, da) = worst_errors(kind, rate_hz, |t| [0.3 + 0.1 * t, 0.1, 0.0]);
                assert!(dv < 1e-6, "{kind:?} at {rate_hz} Hz: velocity off by {dv}");
                assert!(da < 1e-3, "{kind:?} at {rate_hz} Hz: acceleration off by {da}");
            }
        }
    }

    #[test]
    fn constant_acceleration_is_exact_for_polynomial_models() {
        for kind in [DifferentiatorKind::SavitzkyGolay, DifferentiatorKind::Kalman] {
            for rate_hz in [66.0, 1000.0] {
                let (dv, da) = worst_errors(kind, rate_hz, |t| [0.2 * t * t, 0.4 * t, 0.4]);
                assert!(dv < 1e-6, "{kind:?} at {rate_hz} Hz: velocity off by {dv}");
                assert!(da < 1e-4, "{kind:?} at {rate_hz} Hz: acceleration off by {da}");
            }
        }
    }

    #[test]
    fn reset_forgets() {
        for kind in DifferentiatorKind::ALL {
            let mut used = Differentiator::new(kind, 1000.0);
            let mut fresh = used.clone();
            for k in 0..500 {
                used.step(Lanes::splat((f64::from(k) * 0.1).sin()));
            }
            used.reset();
            for k in 0..500 {
                let position = Lanes::splat((f64::from(k) * 0.01).cos());
                assert_eq!(used.step(position), fresh.step(position), "{kind:?} at {k}");
            }
        }
    }
}
