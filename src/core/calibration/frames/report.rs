//! Result of a frame calibration, and the parts that all frame calibrations have in common.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::{
    CalibrationSource, Carrier, FrameCause, FrameCoverage, FrameError, FrameRecord, FrameSample, Mistake, Serials,
    examine::{ExaminedModel, RowMiss},
    record::CalibrationResult,
    sample::check,
};
use crate::calibration::{RecordHead, Verdict};

/// A size in position and in angle; `None` for a size that the calibration does not have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sizes {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub place_m: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub angle_deg: Option<f64>,
}

impl Sizes {
    pub const fn place(place_m: f64) -> Self {
        Self { place_m: Some(place_m), angle_deg: None }
    }

    pub const fn angle(angle_deg: f64) -> Self {
        Self { place_m: None, angle_deg: Some(angle_deg) }
    }

    /// Creates a size with length and angle, m and degrees.
    pub const fn both(place_m: f64, angle_deg: f64) -> Self {
        Self { place_m: Some(place_m), angle_deg: Some(angle_deg) }
    }

    /// Returns the root mean square and the maximum of these errors, in the quantities that all of them have.
    pub(super) fn of(misses: &[RowMiss]) -> [Self; 2] {
        let sizes = |of: fn(f64, f64) -> f64, finish: &dyn Fn(f64) -> f64| {
            let fold = |part: fn(&RowMiss) -> Option<f64>| {
                let values: Option<Vec<f64>> = misses.iter().map(part).collect();
                let values = values.filter(|values| !values.is_empty())?;
                Some(finish(values.into_iter().fold(0.0, of)))
            };
            let angle_deg = fold(|miss| miss.angle_rad).map(f64::to_degrees);
            Self { place_m: fold(|miss| miss.place_m), angle_deg }
        };
        let count = misses.len().max(1) as f64;
        [sizes(|sum, x| sum + x * x, &|sum| (sum / count).sqrt()), sizes(f64::max, &|max| max)]
    }
}

/// Limits for a verdict; `None` for a size that the calibration does not have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameLimits {
    pub min: usize,
    pub held_out: Sizes,
    /// Maximum half length of the 95 % interval.
    pub uncertainty: Sizes,
    pub outliers: f64,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FrameReport<F> {
    pub verdict: Verdict,
    pub cause: FrameCause,
    pub poses: usize,
    /// Indices of poses that contradict the others, from 0; not used.
    pub outliers: Vec<usize>,
    /// Root mean square error of the poses in the fit.
    pub fitted: Sizes,
    /// Root mean square error on held-out poses. Each pose (beyond 20: each tenth of them) is compared with a fit to the
    /// others; outliers are not counted.
    pub held_out: Sizes,
    pub held_out_max: Sizes,
    /// Half the length of the 95 % interval: of the position, along the longest axis of its ellipsoid; of the angle,
    /// about any axis.
    pub uncertainty: Sizes,
    /// The result; `None` if the data do not determine it. Use it only with [`Verdict::Accepted`].
    pub found: Option<F>,
}

impl<F> FrameReport<F> {
    pub fn nothing(poses: usize, cause: FrameCause) -> Self {
        let none = Sizes::default();
        Self {
            verdict: cause.verdict(),
            cause,
            poses,
            outliers: Vec::new(),
            fitted: none,
            held_out: none,
            held_out_max: none,
            uncertainty: none,
            found: None,
        }
    }

    /// Creates a report with a result but no verdict yet.
    pub(super) fn of<M>(poses: usize, examined: ExaminedModel<M>, uncertainty: Sizes, found: F) -> Self {
        let [fitted, _] = Sizes::of(&examined.fitted);
        let [held_out, held_out_max] = Sizes::of(&examined.held_out);
        let outliers = examined.outliers;
        let cause = FrameCause::Proven;
        Self {
            verdict: cause.verdict(),
            cause,
            poses,
            outliers,
            fitted,
            held_out,
            held_out_max,
            uncertainty,
            found: Some(found),
        }
    }

    /// Changes the cause and the verdict that follows from it.
    pub(super) const fn because(mut self, cause: FrameCause) -> Self {
        self.verdict = cause.verdict();
        self.cause = cause;
        self
    }

    /// Sets the cause that follows from errors and uncertainty.
    pub(super) fn judged(self, limits: &FrameLimits) -> Self {
        let cause = self.cause_within(limits);
        self.because(cause)
    }

    fn cause_within(&self, limits: &FrameLimits) -> FrameCause {
        // The checks are ordered from the most basic cause to the weakest.
        let kept = self.poses - self.outliers.len();
        if kept < limits.min {
            return FrameCause::TooFew { have: kept, min: limits.min };
        }
        let fraction = self.outliers.len() as f64 / self.poses.max(1) as f64;
        if fraction > limits.outliers {
            return FrameCause::Outliers { fraction, max: limits.outliers };
        }
        let error = &self.held_out;
        let max = &limits.held_out;
        if let Some((by_m, max_m)) = above(error.place_m, max.place_m) {
            return FrameCause::PoorPlace { by_m, max_m };
        }
        if let Some((by_deg, max_deg)) = above(error.angle_deg, max.angle_deg) {
            return FrameCause::PoorAngle { by_deg, max_deg };
        }
        let doubt = &self.uncertainty;
        let max = &limits.uncertainty;
        if let Some((by_m, max_m)) = above(doubt.place_m, max.place_m) {
            return FrameCause::UncertainPlace { by_m, max_m };
        }
        if let Some((by_deg, max_deg)) = above(doubt.angle_deg, max.angle_deg) {
            return FrameCause::UncertainAngle { by_deg, max_deg };
        }
        FrameCause::Proven
    }
}

impl<F: CalibrationResult> FrameReport<F> {
    /// Returns the record of the result; `None` without a result. `reason` is the sentence for [`Self::cause`].
    pub fn record(&self, head: RecordHead, serials: Serials, reason: &str) -> Option<FrameRecord<F>> {
        FrameRecord::of(self, head, serials, reason)
    }
}

/// Returns value and limit if the value exceeds the limit, is NaN or could not be determined.
fn above(value: Option<f64>, max: Option<f64>) -> Option<(f64, f64)> {
    max.map(|max| (value.unwrap_or(f64::INFINITY), max)).filter(|(value, max)| value.is_nan() || value > max)
}

/// A frame calibration: its settings, and the fit. [`FrameSession`](super::FrameSession) records its data.
pub trait Calibration {
    type Solution: CalibrationResult;

    fn needs(&self) -> Vec<CalibrationSource>;

    /// Returns the carrier that moves while the calibration is recorded.
    fn carrier(&self) -> Carrier;

    /// Returns the time for which a pose is held, s; 0 takes single samples in motion.
    fn hold_s(&self) -> f64 {
        0.5
    }

    /// Returns whether a pose differs enough from those already taken.
    fn differs(&self, sample: &FrameSample, taken: &[FrameSample]) -> bool;

    /// Returns the completed fraction of the motion and the missing part.
    fn coverage(&self, taken: &[FrameSample]) -> FrameCoverage;

    /// Fits the data as given; the samples have been checked.
    fn attempt(&self, samples: &[FrameSample]) -> FrameReport<Self::Solution>;

    /// Returns the mistakes to check, likeliest first, and the carrier whose poses they affect.
    fn mistakes(&self) -> Vec<(Mistake, Carrier)>;

    fn fault(&self) -> Option<&'static str> {
        None
    }

    /// Fits and evaluates. `Err` is returned for invalid samples and settings only; data that do not determine a
    /// result, or fit badly, give a report with that verdict. A mistake is reported if correcting it, and only it,
    /// gives data that are accepted.
    ///
    /// # Errors
    /// [`FrameError`] for a sample that lacks a source, has a non-finite number or is beyond 10 m, and for non-finite
    /// settings.
    fn fit(&self, samples: &[FrameSample]) -> Result<FrameReport<Self::Solution>, FrameError> {
        if let Some(setting) = self.fault() {
            return Err(FrameError::Setting { setting });
        }
        check(samples, &self.needs())?;
        let given = self.attempt(samples);
        // If the data fit only an impossible geometry, the first attempt has already found the mistake.
        let fits = given.found.is_some() && matches!(given.cause, FrameCause::Mistake { .. });
        if given.verdict == Verdict::Accepted || fits {
            return Ok(given);
        }
        let mut best: Option<(f64, Mistake)> = None;
        for (mistake, carrier) in self.mistakes() {
            let undone: Option<Vec<_>> = samples.iter().map(|sample| mistake.undone(sample, carrier)).collect();
            let Some(report) = undone.map(|samples| self.attempt(&samples)) else { continue };
            let size = report.held_out.place_m.or(report.held_out.angle_deg).unwrap_or(f64::INFINITY);
            // Likelier mistakes come first in the list, so a later one has to be clearly better.
            let better = best.is_none_or(|(min, _)| size < CLEARLY * min);
            if report.verdict == Verdict::Accepted && better {
                best = Some((size, mistake));
            }
        }
        Ok(match best {
            Some((_, mistake)) => given.because(FrameCause::Mistake { mistake }),
            None => given,
        })
    }
}

/// A less likely mistake is reported only if its error is below this fraction of the error of a likelier one.
const CLEARLY: f64 = 0.7;

pub(super) fn finite(vector: &Vector3<f64>) -> bool {
    vector.iter().all(|x| x.is_finite())
}
