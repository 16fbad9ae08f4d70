//! One summary of several recordings.

use serde::Serialize;

use super::ReplayFigures;

/// Distribution over the recordings of the ratio of the two errors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct RatioFigures {
    #[serde(rename = "least")]
    pub min: f64,
    pub median: f64,
    pub greatest: f64,
}

/// Several recordings replayed with the same options.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReplaySummary {
    pub recordings: usize,
    /// Number of samples in all recordings, and of compared samples.
    pub samples: usize,
    /// See `samples`.
    pub compared: usize,
    /// Mean norm of the rendered force's error over all compared samples, and its maximum.
    pub error_mae: f64,
    /// See `error_mae`.
    pub error_max: f64,
    /// Mean norm of the held force's error over the same samples.
    pub hold_mae: f64,
    /// Ratio of these two; `None` if the held force is exact.
    pub ratio: Option<f64>,
    /// The same for each recording; `None` if the held force is exact in every one.
    pub ratios: Option<RatioFigures>,
    /// Name of the recording with the largest ratio.
    pub worst: Option<String>,
    /// Compared samples for which the mode had no valid force.
    pub rejected: u64,
    /// Gaps in the recordings.
    pub holes: u64,
}

impl ReplaySummary {
    /// Summarises recordings with these names.
    ///
    /// ```
    /// use nima_study::replay::ReplaySummary;
    ///
    /// let none = ReplaySummary::of(&[]);
    /// assert_eq!((none.recordings, none.ratio), (0, None));
    /// ```
    pub fn of(all: &[(String, ReplayFigures)]) -> Self {
        let sum = |of: fn(&ReplayFigures) -> f64| all.iter().map(|(_, figures)| of(figures)).sum::<f64>();
        let count = |of: fn(&ReplayFigures) -> usize| all.iter().map(|(_, figures)| of(figures)).sum::<usize>();
        let compared = count(|figures| figures.compared);
        let weight = compared.max(1) as f64;
        let error_mae = sum(|figures| figures.error.mae * figures.compared as f64) / weight;
        let hold_mae = sum(|figures| figures.hold.mae * figures.compared as f64) / weight;
        let mut ratios: Vec<(f64, &String)> = all
            .iter()
            .filter_map(|(name, figures)| Some((ratio(figures.error.mae, figures.hold.mae)?, name)))
            .collect();
        ratios.sort_by(|a, b| a.0.total_cmp(&b.0));
        let spread = ratios.first().zip(ratios.last()).map(|(min, greatest)| RatioFigures {
            min: min.0,
            median: ratios[(ratios.len() - 1) / 2].0,
            greatest: greatest.0,
        });
        Self {
            recordings: all.len(),
            samples: count(|figures| figures.samples),
            compared,
            error_mae,
            error_max: all.iter().map(|(_, figures)| figures.error.max).fold(0.0, f64::max),
            hold_mae,
            ratio: ratio(error_mae, hold_mae),
            ratios: spread,
            worst: ratios.last().map(|(_, name)| (*name).clone()),
            rejected: all.iter().map(|(_, figures)| figures.rejected).sum(),
            holes: all.iter().map(|(_, figures)| figures.holes).sum(),
        }
    }
}

/// Returns the rendered force's error as a multiple of the held force's.
fn ratio(error: f64, hold: f64) -> Option<f64> {
    (hold > 0.0).then(|| error / hold)
}
