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
    /// Largest norm.
    pub max: f64,
}

/// In-window reconstruction error of one degree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Reconstruction {
    /// Mean norm.
    pub mae: f64,
    /// Standard deviation about the mean.
    pub sd: f64,
}

/// In-window errors of the paper's method: the parameters fitted to a window, tested on the newest sample of that same
/// window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Reconstructions {
    /// N = 1.
    pub degree_1: Reconstruction,
    /// N = 2.
    pub degree_2: Reconstruction,
    /// N = 3.
    pub degree_3: Reconstruction,
    /// N = 4.
    pub degree_4: Reconstruction,
    /// N = 5.
    pub degree_5: Reconstruction,
    /// The degree chosen in each window.
    pub selected: Reconstruction,
}

/// Median, 95th percentile and maximum.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Spread {
    pub p50: f64,
    pub p95: f64,
    pub max: f64,
}

/// Time of one tick of identification, us.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct TickTime {
    pub p50: f64,
    pub p99: f64,
    pub max: f64,
}

/// All results of a replay; the JSON of `nima identify`.
#[derive(Clone, Debug, Serialize)]
pub struct Figures {
    /// Samples in the recording.
    pub samples: usize,
    pub rate_hz: f64,
    /// Axes, by name.
    pub axes: Vec<&'static str>,
    pub mode: Mode,
    /// The motion of which the force is made: the follower's, or the handle's where the recording has it.
    pub own_motion: OwnMotion,
    /// Window used, ms.
    pub window_ms: f64,
    /// Delay used, ms: the requested one rounded to whole samples.
    pub delay_ms: f64,
    /// Number of samples compared: all from the first one with a delayed force.
    pub compared: usize,
    /// Rendered force against measured force.
    pub error: ErrorFigures,
    /// Delayed force against measured force: delayed DFR.
    pub hold: ErrorFigures,
    /// In-window errors of the paper's method.
    pub reconstruction: Reconstructions,
    /// Share of compared samples with degree 1 to 5; the remaining ones were rendered without a correction.
    pub degree_share: [f64; MAX_DEGREE],
    /// Share of compared samples with a degree above 1.
    pub nonlinear_share: f64,
    /// Condition number of the scaled regression; 0 while there is no regression.
    pub condition: Spread,
    /// Compared samples for which the mode had no valid force and rendered zero.
    pub rejected: u64,
    /// Holes in the recording; after each, window and delay begin anew.
    pub holes: u64,
    /// The longest of them, s.
    pub longest_hole_s: f64,
    /// Computing time of one tick of identification.
    pub tick_us: TickTime,
}
