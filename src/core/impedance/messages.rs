//! What goes in, what goes over the link, and what is shown.

use nalgebra::Vector3;

use super::{
    MAX_DEGREE, Mode, Models, SLOTS,
    features::{Features, MOTION_COLUMNS, Scales},
    regressors::Stance,
    settings::ModeSet,
};
use crate::signal::{LANES, Lanes, Motion};

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

/// One end's motion at one tick, as the models see it.
#[derive(Clone, Copy, Debug)]
pub struct Posture {
    pub(super) features: Features,
    pub(super) stance: Stance,
}

impl Posture {
    pub(super) const BLANK: Self = Self { features: [Lanes::ZERO; MOTION_COLUMNS], stance: Stance::BLANK };

    /// Position (m), velocity (m/s) and acceleration (m/s^2).
    pub fn motion(&self, scales: &Scales) -> Motion {
        Motion {
            x: self.stance.x,
            v: self.features[1] * scales.velocity_m_s,
            a: self.features[2] * scales.acceleration_m_s2,
        }
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
    /// Whether the identification rested: there was no contact.
    pub resting: bool,
    /// The modes that were computed; nothing is rendered in the others.
    pub modes: ModeSet,
    /// The parameters of each of them.
    pub models: Models,
}

impl Parcel {
    /// Nothing measured yet.
    pub const BLANK: Self = Self {
        t_s: f64::NEG_INFINITY,
        force_n: Vector3::new(0.0, 0.0, 0.0),
        fresh: false,
        modes: ModeSet::only(Mode::Dfr),
        models: Models::NONE,
        resting: false,
    };
}

/// Forces rendered at the leader, unclamped (the gates of `safety` come after).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rendered {
    /// Force of every mode (N), by [`Mode::index`](super::Mode::index); zero where not valid.
    pub force_n: [Vector3<f64>; SLOTS],
    /// Whether that mode had something to render, and it was finite.
    pub valid: [bool; SLOTS],
}

impl Rendered {
    /// Force of `mode` (N); `None` where it has nothing valid.
    pub fn force(&self, mode: Mode) -> Option<Vector3<f64>> {
        self.valid[mode.index()].then(|| self.force_n[mode.index()])
    }

    pub(super) fn new(forces: &[Option<Lanes>; SLOTS]) -> Self {
        Self { force_n: forces.map(|force| force.unwrap_or_default().vector()), valid: forces.map(|f| f.is_some()) }
    }
}

/// Standard deviation of the motion inside the window, per axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Excitation {
    pub position_m: Vector3<f64>,
    pub velocity_m_s: Vector3<f64>,
    pub acceleration_m_s2: Vector3<f64>,
}

/// Everything the screen and the trace show of one tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// Time of the newest sample (s).
    pub t_s: f64,
    /// The modes that are computed.
    pub modes: ModeSet,
    /// Whether the identification rests: there is no contact, and nothing to learn.
    pub resting: bool,
    /// Samples that were learnt from so far.
    pub learnt: u64,
    /// For each mode the force (N) for this time made from data up to `t - D` and the follower's motion at `t`.
    pub prediction_n: [Vector3<f64>; SLOTS],
    /// Whether that prediction exists and is finite; it is zero otherwise.
    pub prediction_valid: [bool; SLOTS],
    /// Force minus `M X` (N) at the newest sample, for each literal degree fitted on the window that ends with it.
    pub reconstruction_n: [Vector3<f64>; MAX_DEGREE],
    /// The paper's choice of the degree, as the recipe makes it; 0 while the window is not full or nothing can be solved.
    pub paper_degree: u8,
    /// Degree of anchored rendering: the highest power of the position in the model that most of the weight is on, 1 or 3; 0: no
    /// correction.
    pub degree: u8,
    /// Degree of the matched model with the largest weight; 0 while nothing is known.
    pub matched_degree: u8,
    /// The same in the paper's columns.
    pub nima_degree: u8,
    /// Motion columns of the nested solution on the window which predicts force best at the horizon, 0 (none) to 15: three per
    /// degree (x, v, a). This, condition, rank and excitation are made only where anchored and literal are compared.
    pub columns: u8,
    /// How much of a full correction anchored rendering makes, 0 (plain reflection) to 1.
    pub gain: f64,
    /// Condition (scaled columns) of those columns, the worst of the axes; of the constant and `x` if nothing is chosen.
    pub condition: f64,
    /// Motion columns that carry more information than the ridge, the fewest of the axes.
    pub rank: u8,
    /// How much the motion in the window varies.
    pub excitation: Excitation,
    /// Samples rejected so far (not finite, absurd, or time not advancing).
    pub rejected: u64,
    /// How often anchored rendering had to begin learning anew because a number was not finite.
    pub restarts: u64,
    /// Literal solves (one per tick, axis and degree) that failed so far.
    pub literal_failures: u64,
    /// Running mean (about 0.5 s) of each mode's 3-D error at the horizon (N).
    pub horizon_error_n: [f64; SLOTS],
}

impl Report {
    /// What `mode` would render now (N) from data up to `t - D`; `None` where it has nothing valid.
    pub fn prediction(&self, mode: Mode) -> Option<Vector3<f64>> {
        self.prediction_valid[mode.index()].then(|| self.prediction_n[mode.index()])
    }

    /// The degree that `mode` uses; 0: none.
    pub fn degree_of(&self, mode: Mode) -> u8 {
        mode.entry().map_or(0, |entry| (entry.degree)(self))
    }

    /// Takes over what a parcel tells of the identification, where the parcel is all that there is of it.
    pub fn note(&mut self, parcel: &Parcel) {
        self.t_s = parcel.t_s;
        self.modes = parcel.modes;
        self.resting = parcel.resting;
        for mode in Mode::ALL {
            if let Some(entry) = mode.entry() {
                (entry.note)(&parcel.models, self);
            }
        }
    }

    /// Nothing measured yet.
    pub const BLANK: Self = Self {
        t_s: f64::NEG_INFINITY,
        modes: ModeSet::only(Mode::Dfr),
        resting: false,
        learnt: 0,
        prediction_n: [Vector3::new(0.0, 0.0, 0.0); SLOTS],
        prediction_valid: [false; SLOTS],
        reconstruction_n: [Vector3::new(0.0, 0.0, 0.0); MAX_DEGREE],
        paper_degree: 0,
        degree: 0,
        matched_degree: 0,
        nima_degree: 0,
        columns: 0,
        gain: 0.0,
        condition: 1.0,
        rank: 0,
        excitation: Excitation {
            position_m: Vector3::new(0.0, 0.0, 0.0),
            velocity_m_s: Vector3::new(0.0, 0.0, 0.0),
            acceleration_m_s2: Vector3::new(0.0, 0.0, 0.0),
        },
        rejected: 0,
        restarts: 0,
        literal_failures: 0,
        horizon_error_n: [0.0; SLOTS],
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
