//! The learning curve of a sequence of trials.

use serde::Serialize;

/// Minimum number of trials with a time for a curve. A curve has four parameters including its scatter, and `AICc`
/// divides by the trials minus five.
pub const MIN_TRIALS: usize = 6;

/// Maximum time, s, and maximum number of trials that are accepted.
const LONGEST_S: f64 = 1e6;
const MAX_TRIALS: usize = 10_000;
/// The plateau is reached within this fraction of it: 10 %, as in Feldman et al. 2009 (Surgery 146:381-386).
const WITHIN: f64 = 0.10;
/// A plateau that would be reached later does not count, trials.
const FARTHEST: f64 = 1000.0;
/// Number of rates tested before the best one is refined.
const GRID: u32 = 120;

/// Form of a learning curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum CurveShape {
    /// `asymptote + gain * exp(-(n - 1) / rate)`: Heathcote, Brown and Mewhort 2000 (Psychon. Bull. Rev. 7:185-207).
    Exponential,
    /// `asymptote + gain * n^(-rate)`: Newell and Rosenbloom 1981 (Cognitive Skills and Their Acquisition, 1-55).
    Power,
    /// No learning: the same time in every trial.
    Flat,
}

/// The curve that fits a sequence of completion times best, by the minimum `AICc` (Hurvich and Tsai 1989, Biometrika
/// 76:297-307).
///
/// ```
/// use nima_score::{LearningCurve, CurveShape};
///
/// let times_s: Vec<f64> = (0..20).map(|n| 50.0 + 120.0 * (-f64::from(n) / 4.0).exp()).collect();
/// let curve = LearningCurve::fit(&times_s).ok_or("too few trials")?;
/// assert_eq!(curve.shape, CurveShape::Exponential);
/// assert!((curve.asymptote_s - 50.0).abs() < 0.01 && (curve.rate - 4.0).abs() < 0.01);
/// assert_eq!(curve.trials_to_plateau, Some(14), "the time is then below 55 s");
/// # Ok::<(), &str>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LearningCurve {
    pub shape: CurveShape,
    /// The asymptotic time, s: the plateau.
    pub asymptote_s: f64,
    /// Additional time of the first trial, s.
    pub gain_s: f64,
    /// Exponential: trials in which the remainder falls to 1/e. Power: the exponent. Flat: 0.
    pub rate: f64,
    /// Root mean square of the residuals, s.
    pub rms_s: f64,
    /// Akaike's criterion with the correction for few trials.
    pub aicc: f64,
    /// Number of fitted trials.
    pub fitted: usize,
    /// The first trial (from 1) in which the curve is within 10 % of the plateau; `None` if that is beyond 1000 trials.
    pub trials_to_plateau: Option<u32>,
    /// Whether that trial was actually made; otherwise the plateau is extrapolated.
    pub plateau_seen: bool,
}

/// Trial numbers and times.
type Points = [(f64, f64)];

impl LearningCurve {
    /// Fits the completion times of all trials in order, s. NaN represents a trial without a time: it counts in the
    /// numbering and is not fitted. `None` for fewer than [`MIN_TRIALS`] times.
    pub fn fit(times_s: &[f64]) -> Option<Self> {
        let usable = |time_s: f64| (0.0..=LONGEST_S).contains(&time_s);
        let numbered = times_s.iter().take(MAX_TRIALS).enumerate().map(|(k, time_s)| (k as f64 + 1.0, *time_s));
        let points: Vec<(f64, f64)> = numbered.filter(|(_, time_s)| usable(*time_s)).collect();
        if points.len() < MIN_TRIALS {
            return None;
        }
        let last = points.last().map_or(0.0, |(n, _)| *n);
        let exponential = best(CurveShape::Exponential, &points, [0.3, 3.0 * last]);
        let power = best(CurveShape::Power, &points, [0.05, 5.0]);
        let flat = LearningLinear::fit(&points, &|_| 0.0).curve(CurveShape::Flat, 0.0, &points);
        [flat, exponential, power].into_iter().reduce(|a, b| if b.aicc < a.aicc { b } else { a })
    }

    /// Returns the curve's time in a trial (from 1), s.
    pub fn time_s(&self, trial: u32) -> f64 {
        self.asymptote_s + self.gain_s * decay(self.shape, self.rate, f64::from(trial.max(1)))
    }
}

/// Returns the remaining fraction of the gain in trial `n`.
fn decay(shape: CurveShape, rate: f64, n: f64) -> f64 {
    match shape {
        CurveShape::Exponential => libm::exp(-(n - 1.0) / rate),
        CurveShape::Power => libm::pow(n, -rate),
        CurveShape::Flat => 0.0,
    }
}

/// For a given rate the curve is linear in the other two; the rate is searched in steps of equal ratio and then by
/// golden section.
fn best(shape: CurveShape, points: &Points, [min, max]: [f64; 2]) -> LearningCurve {
    let ratio = libm::log(max / min) / f64::from(GRID);
    let rate = |step: f64| min * libm::exp(ratio * step.clamp(0.0, f64::from(GRID)));
    let linear = |step: f64| LearningLinear::fit(points, &|n| decay(shape, rate(step), n));
    let steps = (0..=GRID).map(f64::from);
    let start = steps.reduce(|a, b| if linear(b).square < linear(a).square { b } else { a }).unwrap_or(0.0);
    let mut low = start - 1.0;
    let mut high = start + 1.0;
    // Sixty steps narrow the interval by 1e12.
    for _ in 0..60 {
        let inner = 0.618_033_988_749_895 * (high - low);
        if linear(high - inner).square <= linear(low + inner).square {
            high = low + inner;
        } else {
            low = high - inner;
        }
    }
    let step = f64::midpoint(low, high);
    linear(step).curve(shape, rate(step), points)
}

/// Least squares for the asymptote and the gain, neither below zero: performance is assumed not to get worse, and no
/// time is negative.
#[derive(Clone, Copy)]
struct LearningLinear {
    asymptote: f64,
    gain: f64,
    /// Sum of the squares of the residuals.
    square: f64,
}

impl LearningLinear {
    fn fit(points: &Points, left: &dyn Fn(f64) -> f64) -> Self {
        let count = points.len() as f64;
        let rows: Vec<(f64, f64)> = points.iter().map(|(n, time)| (left(*n), *time)).collect();
        let mean = |of: &dyn Fn(&(f64, f64)) -> f64| rows.iter().map(of).sum::<f64>() / count;
        let mean_x = mean(&|row| row.0);
        let mean_y = mean(&|row| row.1);
        let (square_x, product) =
            (mean(&|row| (row.0 - mean_x) * (row.0 - mean_x)), mean(&|row| (row.0 - mean_x) * row.1));
        let gain = if square_x > 1e-18 { (product / square_x).max(0.0) } else { 0.0 };
        let (asymptote, gain) = if mean_y - gain * mean_x >= 0.0 {
            (mean_y - gain * mean_x, gain)
        } else {
            (0.0, mean(&|row| row.0 * row.1) / mean(&|row| row.0 * row.0))
        };
        let square = rows.iter().map(|(x, y)| y - asymptote - gain * x).map(|residual| residual * residual).sum();
        Self { asymptote, gain, square }
    }

    fn curve(self, shape: CurveShape, rate: f64, points: &Points) -> LearningCurve {
        let count = points.len() as f64;
        // The scatter counts as a parameter (Burnham and Anderson 2002).
        let parameters = if shape == CurveShape::Flat { 2.0 } else { 4.0 };
        // A perfect fit would have a logarithm of minus infinity; a microsecond is negligible scatter.
        let variance = (self.square / count).max(1e-12);
        let correction = 2.0 * parameters * (parameters + 1.0) / (count - parameters - 1.0);
        let trials_to_plateau = to_plateau(shape, rate, self.asymptote, self.gain);
        let last = points.last().map_or(0.0, |(n, _)| *n);
        LearningCurve {
            shape,
            asymptote_s: self.asymptote,
            gain_s: self.gain,
            rate,
            rms_s: (self.square / count).sqrt(),
            aicc: count * libm::log(variance) + 2.0 * parameters + correction,
            fitted: points.len(),
            trials_to_plateau,
            plateau_seen: trials_to_plateau.is_some_and(|trial| f64::from(trial) <= last),
        }
    }
}

fn to_plateau(shape: CurveShape, rate: f64, asymptote: f64, gain: f64) -> Option<u32> {
    let excess = gain / (WITHIN * asymptote);
    let trial = match shape {
        _ if excess <= 1.0 => 1.0,
        CurveShape::Exponential => 1.0 + rate * libm::log(excess),
        CurveShape::Power => libm::pow(excess, 1.0 / rate),
        CurveShape::Flat => 1.0,
    };
    (trial <= FARTHEST).then(|| trial.ceil() as u32)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn times(count: u32, of: impl Fn(f64) -> f64) -> Vec<f64> {
        (1..=count).map(|n| of(f64::from(n))).collect()
    }

    #[test]
    fn a_known_exponential_and_a_known_power_law_are_recovered() {
        for rate in [1.0, 3.0, 10.0] {
            let curve = LearningCurve::fit(&times(30, |n| 45.0 + 150.0 * (-(n - 1.0) / rate).exp())).unwrap();
            assert_eq!(curve.shape, CurveShape::Exponential);
            assert!((curve.asymptote_s - 45.0).abs() < 1e-3 && (curve.gain_s - 150.0).abs() < 1e-3, "{curve:?}");
            assert!((curve.rate / rate - 1.0).abs() < 1e-4, "{curve:?}");
        }
        for exponent in [0.4, 1.0, 2.0] {
            let curve = LearningCurve::fit(&times(30, |n| 45.0 + 150.0 * n.powf(-exponent))).unwrap();
            assert_eq!(curve.shape, CurveShape::Power);
            assert!((curve.asymptote_s - 45.0).abs() < 0.01 && (curve.rate / exponent - 1.0).abs() < 1e-3, "{curve:?}");
            assert!((curve.time_s(5) - 45.0 - 150.0 * 5_f64.powf(-exponent)).abs() < 1e-3);
        }
    }

    #[test]
    fn the_plateau_is_the_first_trial_within_a_tenth_of_it() {
        // 50 + 100 exp(-(n - 1) / 5) <= 55 from n = 1 + 5 ln 20 = 15.98 on.
        let curve = LearningCurve::fit(&times(20, |n| 50.0 + 100.0 * (-(n - 1.0) / 5.0).exp())).unwrap();
        assert_eq!((curve.trials_to_plateau, curve.plateau_seen), (Some(16), true));
        let curve = LearningCurve::fit(&times(10, |n| 50.0 + 100.0 * (-(n - 1.0) / 5.0).exp())).unwrap();
        assert_eq!((curve.trials_to_plateau, curve.plateau_seen), (Some(16), false), "only extrapolated");
    }

    #[test]
    fn times_without_a_trend_are_flat() {
        let scatter = [60.0, 64.0, 58.0, 61.0, 66.0, 59.0, 62.0, 60.0, 65.0, 61.0];
        let curve = LearningCurve::fit(&scatter).unwrap();
        assert_eq!((curve.shape, curve.trials_to_plateau), (CurveShape::Flat, Some(1)));
        assert!((curve.asymptote_s - 61.6).abs() < 1e-9);
        let slower = LearningCurve::fit(&times(10, |n| 60.0 + 5.0 * n)).unwrap();
        assert_eq!(slower.shape, CurveShape::Flat, "nobody unlearns");
    }

    #[test]
    fn few_trials_have_no_curve_and_trials_without_a_time_keep_their_number() {
        assert_eq!(LearningCurve::fit(&[]), None);
        assert_eq!(LearningCurve::fit(&times(5, |n| 100.0 / n)), None);
        let mut with_gaps = times(20, |n| 50.0 + 100.0 * (-(n - 1.0) / 4.0).exp());
        for missing in [2, 3, 11] {
            with_gaps[missing] = f64::NAN;
        }
        let curve = LearningCurve::fit(&with_gaps).unwrap();
        assert_eq!(curve.fitted, 17);
        assert!((curve.rate - 4.0).abs() < 1e-3, "{curve:?}");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn any_times_give_finite_curves(times_s in proptest::collection::vec(
            prop_oneof![4 => 0.0..400.0, 1 => any::<f64>(), 1 => Just(0.0), 1 => Just(1e6)], 0..40)) {
            if let Some(curve) = LearningCurve::fit(&times_s) {
                let values = [curve.asymptote_s, curve.gain_s, curve.rate, curve.rms_s, curve.aicc, curve.time_s(1)];
                prop_assert!(values.iter().all(|value| value.is_finite()), "{curve:?}");
                prop_assert!(curve.asymptote_s >= 0.0 && curve.gain_s >= 0.0);
            }
        }
    }
}
