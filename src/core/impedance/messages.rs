//! Input, link data and report of the identification.

use nalgebra::Vector3;

use super::{
    MAX_DEGREE, Mode, Models, SLOTS,
    features::{ImpedanceFeatures, MOTION_COLUMNS, Scales},
    regressors::MotionState,
    settings::ModeSet,
};
use crate::signal::{LANES, Lanes, Motion};

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Time (s); must increase from sample to sample. The samples are assumed to be evenly spaced at the rate of the
    /// settings.
    pub t_s: f64,
    /// Tip position in the workspace frame (m); axes not in use are ignored.
    pub position_m: Vector3<f64>,
    /// Tip force in the same frame (N).
    pub force_n: Vector3<f64>,
}

/// One end's motion at one tick, as the models see it.
#[derive(Clone, Copy, Debug)]
pub struct Posture {
    pub(super) features: ImpedanceFeatures,
    pub(super) stance: MotionState,
}

impl Posture {
    pub(super) const BLANK: Self = Self { features: [Lanes::ZERO; MOTION_COLUMNS], stance: MotionState::BLANK };

    /// Returns the position (m), velocity (m/s) and acceleration (m/s^2).
    pub fn motion(&self, scales: &Scales) -> Motion {
        Motion {
            x: self.stance.x,
            v: self.features[1] * scales.velocity_m_s,
            a: self.features[2] * scales.acceleration_m_s2,
        }
    }
}

/// Returns the force shortened to `bound_n`; zero if it is not finite.
#[inline]
pub(super) fn clip(force: Lanes, bound_n: f64) -> Lanes {
    let norm = force.norm();
    // Also the usual case, so it is first.
    if norm <= bound_n {
        force
    // A direction is kept; limiting each axis would turn it.
    } else if norm.is_finite() {
        force * (bound_n / norm)
    } else {
        Lanes::ZERO
    }
}

/// Data that the follower sends over the link each tick: fixed size, plain numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkPacket {
    pub t_s: f64,
    /// Tip force at that time (N); the last good one if the sample was rejected.
    pub force_n: Vector3<f64>,
    /// Whether the sample was good.
    pub fresh: bool,
    /// Whether the identification rested because there was no contact.
    pub resting: bool,
    /// The computed modes; no force is rendered in the others.
    pub modes: ModeSet,
    /// Parameters of each of these renderings.
    pub models: Models,
}

impl LinkPacket {
    pub const BLANK: Self = Self {
        // Older than every real packet, so the first one is always newer.
        t_s: f64::NEG_INFINITY,
        force_n: Vector3::new(0.0, 0.0, 0.0),
        fresh: false,
        modes: ModeSet::only(Mode::Dfr),
        models: Models::NONE,
        resting: false,
    };
}

/// Forces rendered at the leader, before the gates of `safety`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RenderedForces {
    /// Force of every mode (N), by [`Mode::index`](super::Mode::index); zero if not valid.
    pub force_n: [Vector3<f64>; SLOTS],
    /// Whether the mode had a finite force to render.
    pub valid: [bool; SLOTS],
}

impl RenderedForces {
    /// Returns the force of `mode` (N); `None` if it has no valid force.
    pub fn force(&self, mode: Mode) -> Option<Vector3<f64>> {
        self.valid[mode.index()].then(|| self.force_n[mode.index()])
    }

    pub(super) fn new(forces: &[Option<Lanes>; SLOTS]) -> Self {
        Self { force_n: forces.map(|force| force.unwrap_or_default().vector()), valid: forces.map(|f| f.is_some()) }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ImpedanceExcitation {
    pub position_m: Vector3<f64>,
    pub velocity_m_s: Vector3<f64>,
    pub acceleration_m_s2: Vector3<f64>,
}

/// Data of one tick for the screen and the trace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IdentificationReport {
    pub t_s: f64,
    pub modes: ModeSet,
    /// Whether the identification rests, because there is no contact and nothing to learn.
    pub resting: bool,
    pub learnt: u64,
    /// Force of each mode (N) for this time, computed from data up to `t - D` and the follower's motion at `t`.
    pub prediction_n: [Vector3<f64>; SLOTS],
    /// Whether the prediction exists and is finite; otherwise it is zero.
    pub prediction_valid: [bool; SLOTS],
    /// Force minus `M X` (N) at the newest sample, for each literal degree fitted on the window that ends with it.
    pub reconstruction_n: [Vector3<f64>; MAX_DEGREE],
    pub degrees: IdentifiedDegrees,
    /// Motion columns of the nested window solution that predicts the force best at the prediction horizon, 0 (none) to
    /// 15: three per degree (x, v, a). Like condition, rank and excitation it is computed only where anchored and
    /// literal are compared.
    pub columns: u8,
    /// Fraction of a full correction that anchored rendering makes, 0 (plain reflection) to 1.
    pub gain: f64,
    /// Condition number (scaled columns) of those columns, on the worst axis; of the constant and `x` if no columns are
    /// chosen.
    pub condition: f64,
    /// Motion columns with more information than the ridge, on the axis with the fewest.
    pub rank: u8,
    /// Variation of the motion in the window.
    pub excitation: ImpedanceExcitation,
    pub failures: IdentificationFailures,
    /// Running mean (about 0.5 s) of each mode's 3-D error at the prediction horizon (N).
    pub horizon_error_n: [f64; SLOTS],
}

/// The degree N that each way to identify uses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct IdentifiedDegrees {
    /// The paper's choice of the degree, by the recipe; 0 while the window is not full or no degree can be solved.
    pub paper: u8,
    /// Highest power of the position in the model of anchored rendering with the largest weight, 1 or 3; 0 without a
    /// correction.
    pub anchored: u8,
    /// Degree of the matched model with the largest weight; 0 before anything is known.
    pub matched: u8,
    /// Degree of matched rendering in the paper's columns.
    pub nima: u8,
}

/// What went wrong since the start; each count only grows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct IdentificationFailures {
    /// Rejected samples: not finite, absurd, or time not advancing.
    pub samples: u64,
    /// Times that anchored rendering had to restart learning because a number was not finite.
    pub restarts: u64,
    /// Failed literal solves, one per tick, axis and degree.
    pub literal_solves: u64,
}

impl IdentificationReport {
    /// Returns the force that `mode` would render now (N) from data up to `t - D`; `None` if it has no valid force.
    pub fn prediction(&self, mode: Mode) -> Option<Vector3<f64>> {
        self.prediction_valid[mode.index()].then(|| self.prediction_n[mode.index()])
    }

    /// Returns the degree that `mode` uses; 0: none.
    pub fn degree_of(&self, mode: Mode) -> u8 {
        mode.entry().map_or(0, |entry| (entry.degree)(self))
    }

    /// Copies the identification's results from a packet, for a leader without the follower's report.
    pub fn note(&mut self, parcel: &LinkPacket) {
        self.t_s = parcel.t_s;
        self.modes = parcel.modes;
        self.resting = parcel.resting;
        for mode in Mode::ALL {
            if let Some(entry) = mode.entry() {
                (entry.note)(&parcel.models, self);
            }
        }
    }

    pub const BLANK: Self = Self {
        t_s: f64::NEG_INFINITY,
        modes: ModeSet::only(Mode::Dfr),
        resting: false,
        learnt: 0,
        prediction_n: [Vector3::new(0.0, 0.0, 0.0); SLOTS],
        prediction_valid: [false; SLOTS],
        reconstruction_n: [Vector3::new(0.0, 0.0, 0.0); MAX_DEGREE],
        degrees: IdentifiedDegrees { paper: 0, anchored: 0, matched: 0, nima: 0 },
        columns: 0,
        gain: 0.0,
        // The condition number of no column at all.
        condition: 1.0,
        rank: 0,
        excitation: ImpedanceExcitation {
            position_m: Vector3::new(0.0, 0.0, 0.0),
            velocity_m_s: Vector3::new(0.0, 0.0, 0.0),
            acceleration_m_s2: Vector3::new(0.0, 0.0, 0.0),
        },
        failures: IdentificationFailures { samples: 0, restarts: 0, literal_solves: 0 },
        horizon_error_n: [0.0; SLOTS],
    };
}

/// Sets the lanes of unused axes to zero.
pub(super) fn active(vector: &Vector3<f64>, axes: usize) -> Lanes {
    let mut lanes = Lanes::from(*vector);
    for lane in axes..LANES {
        lanes[lane] = 0.0;
    }
    lanes
}
