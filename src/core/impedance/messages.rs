//! What goes in, what goes over the link, and what is shown.

use nalgebra::Vector3;

use super::{
    MAX_DEGREE, Mode, SLOTS,
    anchored::within,
    baselines::BaselineModel,
    features::{Features, MOTION_COLUMNS},
    matched::{MatchedModel, Slip},
    regressors::{Stance, motion_changes},
    settings::ModeSet,
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
    /// Constant force (N); zero unless the recipe has one.
    pub constant_n: Lanes,
    /// `M`: the first `3 N` are in use, N per SI unit of the feature.
    pub coefficients: [Lanes; MOTION_COLUMNS],
}

impl LiteralModel {
    /// No model.
    pub const NONE: Self = Self { degree: 0, constant_n: Lanes::ZERO, coefficients: [Lanes::ZERO; MOTION_COLUMNS] };

    /// `M X` (N), `X` in SI units as the recipe reads it.
    #[inline]
    pub(super) fn product(&self, x: &Features) -> Lanes {
        let terms = self.coefficients.iter().zip(x).take(3 * usize::from(self.degree));
        terms.fold(self.constant_n, |sum, (m, x)| sum + *m * *x)
    }

    /// The same; `None` without a model or where the product is not finite.
    pub(super) fn force(&self, x: &Features) -> Option<Lanes> {
        let force = self.product(x);
        (self.degree > 0 && force.is_finite()).then_some(force)
    }
}

/// Parameters of anchored rendering: `f^(t) = f(t - D) + clip(...)`, all experts folded into one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnchoredModel {
    /// N per change of position (m), of its differences from four low-passes (m), of friction
    /// (1), of square, cube and product of the position about the centre (m², m³, m²).
    pub motion: [Lanes; 9],
    /// What the follower alone knows: the change expected without any motion (N).
    pub constant_n: Lanes,
    /// Slow mean of the follower's position (m).
    pub centre_m: Lanes,
    /// Where friction saturates (m).
    pub knee: Lanes,
    /// Least force rendered (N): forces beyond those seen are not invented.
    pub low_n: Lanes,
    /// Greatest force rendered (N).
    pub high_n: Lanes,
    /// Largest correction (N, norm over the axes).
    pub bound_n: f64,
    /// Highest power of the position in the model that most of the weight is on, 1 or 3; 0 without a correction.
    pub degree: u8,
    /// How much of a full correction this is, 0 (plain reflection) to 1, on the axis that is corrected most.
    pub gain: f64,
}

impl AnchoredModel {
    /// No correction.
    pub const NONE: Self = Self {
        motion: [Lanes::ZERO; 9],
        constant_n: Lanes::ZERO,
        centre_m: Lanes::ZERO,
        knee: Lanes::ZERO,
        low_n: Lanes::ZERO,
        high_n: Lanes::ZERO,
        bound_n: 0.0,
        degree: 0,
        gain: 0.0,
    };

    /// The force (N) for the motion now, from the force and the motion at the anchor. The force as it came where nothing is
    /// corrected or the correction is not finite.
    pub(super) fn force(&self, measured: Lanes, now: &Posture, then: &Posture) -> Lanes {
        if self.gain <= 0.0 {
            return measured;
        }
        let changes = motion_changes(&now.stance, &then.stance, self.centre_m, self.knee);
        let correction = self.motion.iter().zip(changes).fold(self.constant_n, |sum, (k, change)| sum + *k * change);
        if correction.is_finite() {
            within(measured + clip(correction, self.bound_n), self.low_n, self.high_n)
        } else {
            measured
        }
    }
}

/// One end's motion at one tick, as the models see it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Posture {
    pub(super) features: Features,
    pub(super) stance: Stance,
}

impl Posture {
    pub(super) const BLANK: Self = Self { features: [Lanes::ZERO; MOTION_COLUMNS], stance: Stance::BLANK };
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
    /// The paper's choice.
    pub literal: LiteralModel,
    /// The paper's linear model.
    pub linear: LiteralModel,
    /// Anchored rendering's choice.
    pub anchored: AnchoredModel,
    /// Matched rendering's parameters.
    pub matched: MatchedModel,
    /// The same in the paper's columns.
    pub nima: MatchedModel,
    /// What the baseline needs, where one is computed.
    pub baseline: BaselineModel,
}

impl Parcel {
    /// Nothing measured yet.
    pub const BLANK: Self = Self {
        t_s: f64::NEG_INFINITY,
        force_n: Vector3::new(0.0, 0.0, 0.0),
        fresh: false,
        modes: ModeSet::only(Mode::Dfr),
        literal: LiteralModel::NONE,
        linear: LiteralModel::NONE,
        anchored: AnchoredModel::NONE,
        matched: MatchedModel::NONE,
        nima: MatchedModel::NONE,
        resting: false,
        baseline: BaselineModel::Nothing,
    };

    /// The force of every mode for the motion now, by [`Mode::index`](super::Mode::index): `anchored` from the motion now and at
    /// the time of the parcel, `literal` from `x`, the paper's `X` now, `matched` with this end's `slip`. `anchored_weight`: that of
    /// anchored rendering in the best of both, 0 to 1. `baseline`: that mode's force, which has a state of its own
    /// at the leader. Nothing is made of a force that is not finite: limits would turn it into one of their edges.
    pub(super) fn render(
        &self,
        now: &Posture,
        then: &Posture,
        x: &Features,
        slip: &mut Slip,
        anchored_weight: Lanes,
        baseline: impl FnOnce(&BaselineModel, Lanes) -> Option<Lanes>,
    ) -> [Option<Lanes>; SLOTS] {
        let measured = Lanes::from(self.force_n);
        if !measured.is_finite() {
            return [None; SLOTS];
        }
        let anchored = self.anchored.force(measured, now, then);
        let matched = self.matched.force(now, slip);
        let best = matched.map_or(anchored, |matched| matched + (anchored - matched) * anchored_weight);
        let mut forces = [
            self.literal.force(x),
            self.linear.force(x),
            Some(measured),
            Some(anchored),
            matched,
            self.nima.force(now, &mut Slip::default()),
            Some(best),
            self.modes.baseline().and_then(|_| baseline(&self.baseline, measured)),
        ];
        for mode in Mode::ALL.into_iter().filter(|mode| !self.modes.contains(*mode)) {
            forces[mode.index()] = None;
        }
        forces
    }
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
        match mode {
            Mode::Literal => self.paper_degree,
            Mode::Linear => u8::from(self.paper_degree > 0),
            Mode::Dfr | Mode::Baseline(_) => 0,
            Mode::Anchored => self.degree,
            Mode::Matched | Mode::Best => self.matched_degree,
            Mode::Nima => self.nima_degree,
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
