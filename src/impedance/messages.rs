//! What goes in, what goes over the link, and what is shown.

use nalgebra::Vector3;

use super::{
    MAX_DEGREE,
    anchored::{Correction, Seen},
    features::{Features, MOTION_COLUMNS},
    literal,
};
use crate::signal::{LANES, Lanes};

/// One tick at the follower.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Time (s); must advance from sample to sample. The samples are taken to be evenly spaced at the settings' rate.
    pub t_s: f64,
    /// Tip position in the workspace frame (m); axes not in use are ignored.
    pub position_m: Vector3<f64>,
    /// Tip force in the same frame (N).
    pub force_n: Vector3<f64>,
}

/// Parameters of the paper's model `f = M X`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LiteralModel {
    /// Degree `N`; 0: none could be solved.
    pub degree: u8,
    /// `M`: the first `3 N` are in use, N per SI unit of the feature.
    pub coefficients: [Lanes; MOTION_COLUMNS],
}

impl LiteralModel {
    /// No model.
    pub const NONE: Self = Self { degree: 0, coefficients: [Lanes::ZERO; MOTION_COLUMNS] };

    /// `M X` (N), `X` the features of the increments over the window, in SI units; `None` without a model or where the
    /// product is not finite.
    pub(super) fn force(&self, increments: &Features) -> Option<Lanes> {
        let force = literal::product(&self.coefficients, increments, 3 * usize::from(self.degree));
        (self.degree > 0 && force.is_finite()).then_some(force)
    }
}

/// Shortens a force to `bound_n`; zero where it is not finite.
#[inline]
pub(super) fn clip(force: Lanes, bound_n: f64) -> Lanes {
    let norm = force.norm();
    if norm <= bound_n {
        force
    } else if norm.is_finite() {
        force * (bound_n / norm)
    } else {
        Lanes::ZERO
    }
}

/// What the follower sends over the link each tick: fixed size, plain numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parcel {
    /// Time of the sample it was made from (s).
    pub t_s: f64,
    /// Tip force at that time (N); the last good one if that sample was rejected.
    pub force_n: Vector3<f64>,
    /// Whether that sample was good.
    pub fresh: bool,
    /// The paper's choice.
    pub literal: LiteralModel,
    /// The paper's linear model.
    pub linear: LiteralModel,
    /// Anchored rendering's correction.
    pub anchored: Correction,
}

impl Parcel {
    /// Nothing measured yet.
    pub const BLANK: Self = Self {
        t_s: f64::NEG_INFINITY,
        force_n: Vector3::new(0.0, 0.0, 0.0),
        fresh: false,
        literal: LiteralModel::NONE,
        linear: LiteralModel::NONE,
        anchored: Correction::NONE,
    };

    /// The force of every mode for the motion now, by [`Mode::index`](super::Mode::index): for `anchored` the motion now and
    /// at the time of the parcel, for `literal` the increments now.
    pub(super) fn render(&self, now: &Seen, then: &Seen, increments: &Features) -> [Option<Lanes>; 4] {
        let measured = Lanes::from(self.force_n);
        [
            self.literal.force(increments),
            self.linear.force(increments),
            Some(measured),
            Some(self.anchored.apply(measured, now, then)),
        ]
    }
}

/// Forces rendered at the leader, unclamped (the gates of `safety` come after).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rendered {
    /// Force of every mode (N), by [`Mode::index`](super::Mode::index); zero where not valid.
    pub force_n: [Vector3<f64>; 4],
    /// Whether that mode had something to render, and it was finite.
    pub valid: [bool; 4],
}

impl Rendered {
    pub(super) fn new(forces: [Option<Lanes>; 4]) -> Self {
        Self { force_n: forces.map(|force| force.unwrap_or_default().vector()), valid: forces.map(|f| f.is_some()) }
    }
}

/// Standard deviation of the motion inside the window, per axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Excitation {
    /// Of the position (m).
    pub position_m: Vector3<f64>,
    /// Of the velocity (m/s).
    pub velocity_m_s: Vector3<f64>,
    /// Of the acceleration (m/s²).
    pub acceleration_m_s2: Vector3<f64>,
}

/// Everything the screen and the trace show of one tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// Time of the newest sample (s).
    pub t_s: f64,
    /// For each mode the force (N) for this time made from data up to `t - D` and the follower's motion at `t`.
    pub prediction_n: [Vector3<f64>; 4],
    /// Whether that prediction exists and is finite; it is zero otherwise.
    pub prediction_valid: [bool; 4],
    /// Force minus `M X` (N) at the newest sample, for each literal degree fitted on the window that ends with it.
    pub reconstruction_n: [Vector3<f64>; MAX_DEGREE],
    /// The paper's in-window choice of the degree; 0 while the window is not full or nothing can be solved.
    pub paper_degree: u8,
    /// Anchored rendering's choice of the degree; 0 is no correction.
    pub degree: u8,
    /// Motion columns of that choice, 0 to 15: three per degree (x, v, a); the last degree may hold x or x, v only.
    pub columns: u8,
    /// Condition (scaled columns) of that choice, the worst of the axes; of the constant and `x` if nothing is chosen.
    pub condition: f64,
    /// Motion columns that carry more information than the ridge, the fewest of the axes.
    pub rank: u8,
    /// How much the motion in the window varies.
    pub excitation: Excitation,
    /// Samples rejected so far (not finite, absurd, or time not advancing).
    pub rejected: u64,
    /// Literal solves (one per tick, axis and degree) that failed so far.
    pub literal_failures: u64,
    /// Running mean (about 0.5 s) of each mode's 3-D error at the horizon (N).
    pub horizon_error_n: [f64; 4],
}

impl Report {
    /// Nothing measured yet.
    pub const BLANK: Self = Self {
        t_s: f64::NEG_INFINITY,
        prediction_n: [Vector3::new(0.0, 0.0, 0.0); 4],
        prediction_valid: [false; 4],
        reconstruction_n: [Vector3::new(0.0, 0.0, 0.0); MAX_DEGREE],
        paper_degree: 0,
        degree: 0,
        columns: 0,
        condition: 1.0,
        rank: 0,
        excitation: Excitation {
            position_m: Vector3::new(0.0, 0.0, 0.0),
            velocity_m_s: Vector3::new(0.0, 0.0, 0.0),
            acceleration_m_s2: Vector3::new(0.0, 0.0, 0.0),
        },
        rejected: 0,
        literal_failures: 0,
        horizon_error_n: [0.0; 4],
    };
}

/// Zeroes the lanes of axes not in use.
pub(super) fn active(vector: &Vector3<f64>, axes: usize) -> Lanes {
    let mut lanes = Lanes::from(*vector);
    for lane in axes..LANES {
        lanes[lane] = 0.0;
    }
    lanes
}
