//! The results of a replay.

use nima_core::impedance::{MAX_DEGREE, Mode, OwnMotion};
use serde::Serialize;

/// Mean, standard deviation, percentile and maximum of an error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ErrorFigures {
    /// Mean norm of the error.
    pub mae: f64,
    /// Standard deviation of the error about its mean (all axes together).
    pub sd: f64,
    /// 95th percentile of the norm.
    pub p95: f64,
    pub max: f64,
}

/// In-window reconstruction error of one degree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Reconstruction {
    pub mae: f64,
    pub sd: f64,
}

/// In-window errors of the paper's method: the parameters fitted to a window, tested on the newest sample of that same
/// window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Reconstructions {
    pub degree_1: Reconstruction,
    pub degree_2: Reconstruction,
    pub degree_3: Reconstruction,
    pub degree_4: Reconstruction,
    pub degree_5: Reconstruction,
    /// The degree chosen in each window.
    pub selected: Reconstruction,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct FigureSpread {
    pub p50: f64,
    pub p95: f64,
    pub max: f64,
}

/// Time of one tick of identification, us.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct IdentificationTime {
    pub p50: f64,
    pub p99: f64,
    pub max: f64,
}

/// All results of a replay; the JSON of `nima identify`.
#[derive(Clone, Debug, Serialize)]
pub struct ReplayFigures {
    pub samples: usize,
    pub rate_hz: f64,
    pub axes: Vec<&'static str>,
    pub mode: Mode,
    /// The motion from which the force is computed: the follower's, or the handle's if the recording has it.
    pub own_motion: OwnMotion,
    pub window_ms: f64,
    /// Delay used, ms: the requested one rounded to whole samples.
    pub delay_ms: f64,
    /// Number of samples compared: all from the first one with a delayed force.
    pub compared: usize,
    /// Rendered force compared with measured force.
    pub error: ErrorFigures,
    /// Delayed force (delayed DFR) compared with measured force.
    pub hold: ErrorFigures,
    /// In-window errors of the paper's method.
    pub reconstruction: Reconstructions,
    /// Fraction of compared samples with degree 1 to 5; the remaining ones were rendered without a correction.
    #[serde(rename = "degree_share")]
    pub degree_fraction: [f64; MAX_DEGREE],
    /// Fraction of compared samples with a degree above 1.
    #[serde(rename = "nonlinear_share")]
    pub nonlinear_fraction: f64,
    /// Condition number of the scaled regression; 0 if there is no regression.
    pub condition: FigureSpread,
    /// Compared samples for which the mode had no valid force and rendered zero.
    pub rejected: u64,
    /// Number of gaps in the recording. They are bridged; after a gap of more than 10 s, the identification starts again.
    pub holes: u64,
    /// The longest gap, s.
    pub longest_hole_s: f64,
    /// Number of new force values per second, if the sensor renews the force much more slowly than the recording's rate.
    pub force_renewal_hz: Option<f64>,
    /// Factor by which the positions were multiplied, 1 if they could be metres or radians.
    pub position_scale: f64,
    /// Computing time of one tick of identification.
    pub tick_us: IdentificationTime,
}
