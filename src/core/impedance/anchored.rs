//! Anchored rendering at the follower: learns how the force changes over the delay, and evaluates itself at that
//! prediction horizon.
//!
//! The force at the hand is the last measured force plus a correction, `f^(t) = f(t-D) + c`. The correction is a
//! mixture of experts: regressions of the change of force over D on the change of motion over D and on quantities that
//! the follower measured D ago. Quantities that only the follower has are combined into one constant before it is sent;
//! the leader inserts its own motion. Every expert's prediction, computed from the data of D ago, is compared with the
//! force measured now. No correction (delayed reflection) is always one of the experts: its weight is the difference
//! between one and the sum of the weights.

use super::{
    Mode, Models,
    envelope::Envelope,
    messages::{IdentificationReport, LinkPacket, Posture, clip},
    method::{FollowerEnd, LeaderEnd, LeaderInput, MethodInput, Place, RenderingMethod},
    mixture::Mixture,
    packed::{PackedNumbers, PackedReader, PackedWriter},
    regression::{ImpedanceRegression, LENGTHS, NESTED, RIDGES, Solutions, predict},
    regressors::{Background, BackgroundBuilder, MotionState, REGRESSORS, Regressors, at, motion_changes},
    settings::{ImpedanceSettings, MAX_DELAY_S, ModeSet},
};
use crate::signal::{DelayLine, Lanes, settled};

/// A correction may be at most this many times the recent change of force over the delay. This constant and the others
/// were chosen by hand on the recordings of both rigs, and on simulated palpation, reaching, sudden contact and loss of
/// contact.
const BOUND: f64 = 1.5;
/// Each expert's prediction is limited to this many times that change before it is evaluated. Chosen like [`BOUND`].
const EXPERT_BOUND: f64 = 2.0;
/// Solves per second of every ridge (at most one per tick). The ridges are solved in turn, and each solution is used at
/// once. Half this number reduces the accuracy by 1 % at 10 ms; a higher number has no benefit.
const SOLVE_HZ: f64 = 150.0;
// Every ridge has a linear and a full model.
const EXPERTS: usize = RIDGES * NESTED;
// Zero parameters predict no change, which is plain reflection.
const UNKNOWN: Solutions = [[Lanes::ZERO; REGRESSORS]; NESTED];
/// Fraction of the reflection's error that counts while the evaluation uses newer parameters than those that would have
/// been sent (which is optimistic), and in the first moments, when only free motion has been seen: a first contact was
/// otherwise rendered up to 4 % worse than reflected.
const EARLY_CAUTION: f64 = 0.6;
const FIRST_CAUTION: f64 = 0.2;
const FIRST_S: f64 = 0.3;

/// Anchored rendering.
#[derive(Clone, Debug)]
pub(super) struct AnchoredMethod;

impl RenderingMethod for AnchoredMethod {
    const NAME: &'static str = "anchored";
    const ABOUT: &'static str = "our rendering: delayed force plus its learned change";
    const PARAMETERS: Option<Place> = Some(|models| &mut models.anchored);

    fn follower(settings: &ImpedanceSettings, delay_ticks: usize) -> Option<Box<dyn FollowerEnd>> {
        Some(Box::new(Learner::new(settings, delay_ticks)))
    }

    fn leader(_settings: &ImpedanceSettings) -> Box<dyn LeaderEnd> {
        Box::new(Self)
    }

    fn degree(report: &IdentificationReport) -> u8 {
        report.degrees.anchored
    }

    fn note(models: &Models, report: &mut IdentificationReport) {
        report.degrees.anchored = models.anchored.degree;
        report.gain = models.anchored.gain;
    }
}

impl LeaderEnd for AnchoredMethod {
    fn render(&mut self, moment: &LeaderInput<'_>) -> Option<Lanes> {
        Some(moment.parcel.models.anchored.force(moment.measured_n, moment.now, moment.then))
    }
}

/// Parameters of anchored rendering: `f^(t) = f(t - D) + clip(...)`, all experts folded into one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnchoredModel {
    /// Force (N) per change of position (m), of its differences from four low-passes (m), of friction (1), of square,
    /// cube and product of the position about the centre (m², m³, m²).
    pub motion: [Lanes; 9],
    /// Change expected without any motion (N), which only the follower can compute.
    pub constant_n: Lanes,
    /// Slow mean of the follower's position (m).
    pub centre_m: Lanes,
    /// Motion at which friction saturates (m).
    pub knee: Lanes,
    /// Minimum rendered force (N): the mode does not render forces outside the observed range.
    pub low_n: Lanes,
    /// Maximum rendered force (N).
    pub high_n: Lanes,
    /// Largest correction (N, norm over the axes).
    pub bound_n: f64,
    /// Highest power of the position in the model with most of the weight, 1 or 3; 0 without a correction.
    pub degree: u8,
    /// Degree of correction, from 0 (plain reflection) to 1, on the axis with the largest correction.
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

    /// Returns the force (N) for the motion now, from the force and the motion at the anchor. Without a correction, or
    /// if the correction is not finite, returns the received force.
    pub(super) fn force(&self, measured: Lanes, now: &Posture, then: &Posture) -> Lanes {
        if self.gain <= 0.0 {
            return measured;
        }
        let changes = motion_changes(&now.stance, &then.stance, self.centre_m, self.knee);
        let correction = self.motion.iter().zip(changes).fold(self.constant_n, |sum, (k, change)| sum + *k * change);
        if correction.is_finite() {
            (measured + clip(correction, self.bound_n)).within(self.low_n, self.high_n)
        } else {
            measured
        }
    }
}

impl PackedNumbers for AnchoredModel {
    const NONE: Self = Self::NONE;

    fn write(&self, row: &mut PackedWriter<'_>) {
        row.put(f64::from(self.degree));
        row.put(self.gain);
        row.put(self.bound_n);
        for lanes in [self.constant_n, self.centre_m, self.knee, self.low_n, self.high_n] {
            row.lanes(lanes);
        }
        row.row(&self.motion);
    }

    fn read(row: &mut PackedReader<'_>) -> Option<Self> {
        let degree = row.count(3)? as u8;
        let gain = row.take()?;
        let bound_n = row.take()?;
        let constant_n = row.lanes()?;
        let centre_m = row.lanes()?;
        let knee = row.lanes()?;
        let low_n = row.lanes()?;
        let high_n = row.lanes()?;
        Some(Self { motion: row.row()?, constant_n, centre_m, knee, low_n, high_n, bound_n, degree, gain })
    }
}

/// The follower's part.
#[derive(Clone, Debug)]
struct Learner {
    rate_hz: f64,
    delay_ticks: usize,
    every: usize,
    tick: usize,
    surroundings: BackgroundBuilder,
    regression: ImpedanceRegression,
    /// Solutions of each ridge.
    found: [DelayLine<Solutions>; RIDGES],
    moments: DelayLine<Instant>,
    mixture: Mixture<EXPERTS>,
    largest_change_n: f64,
    envelope: Envelope,
    /// Number of times that the regressions had to restart because a number was not finite.
    restarts: u64,
}

#[derive(Clone, Copy, Debug, Default)]
struct Instant {
    good: bool,
    stance: MotionState,
    background: Background,
}

impl Learner {
    fn new(settings: &ImpedanceSettings, delay_ticks: usize) -> Self {
        let rate_hz = settings.rate_hz;
        let every = ((rate_hz / SOLVE_HZ).round() as usize).max(1);
        let max_delay = (MAX_DELAY_S * rate_hz).ceil() as usize;
        Self {
            rate_hz,
            delay_ticks,
            every,
            tick: 0,
            surroundings: BackgroundBuilder::new(settings),
            regression: ImpedanceRegression::new(rate_hz),
            found: std::array::from_fn(|_| DelayLine::new(max_delay / every + 1, UNKNOWN)),
            moments: DelayLine::new(max_delay, Instant::default()),
            mixture: Mixture::new(rate_hz),
            largest_change_n: 0.0,
            envelope: Envelope::new(rate_hz),
            restarts: 0,
        }
    }

    /// Adds the follower's newest motion and force; `good`: the sample was measured, not bridged; `learn`: the sample
    /// is informative.
    fn step(&mut self, stance: &MotionState, force_n: Lanes, good: bool, learn: bool) -> AnchoredModel {
        let d = self.delay_ticks;
        let usual = (self.tick > 2 * d).then(|| self.regression.mean_squares());
        let background = self.surroundings.step(stance, force_n, usual);
        if learn {
            self.envelope.see(force_n, 1.0);
        }
        self.moments.push(Instant { good, stance: *stance, background });
        if let Some(then) = self.moments.get(d).filter(|then| d > 0 && learn && good && then.good).copied() {
            let q = then.background.regressors(stance, &then.stance);
            let change = force_n - then.background.force_n;
            let forget = libm::exp(-1.0 / (2.0 * d as f64).max(0.5 * self.rate_hz));
            self.largest_change_n = settled(self.largest_change_n * forget).max(change.norm());
            if self.tick > d {
                self.judge(&q, change);
            }
            let [_, newest] = self.found[0].get(0).unwrap_or(&UNKNOWN);
            self.regression.learn(&q, change, newest);
        }
        self.solve(learn);
        let model = self.model(stance, &background);
        self.tick += 1;
        model
    }

    /// Returns whether predictions are evaluated with newer parameters than those that would have been sent; rendering
    /// then starts one delay earlier.
    fn early(&self) -> bool {
        self.tick < 3 * self.delay_ticks
    }

    /// Returns the factor for the reflection's error: below 1 it favours the reflection over a correction.
    fn caution(&self) -> f64 {
        match self.early() {
            true if (self.tick as f64) < FIRST_S * self.rate_hz => FIRST_CAUTION,
            true => EARLY_CAUTION,
            false => 1.0,
        }
    }

    fn judge(&mut self, q: &Regressors, change: Lanes) {
        let bound_n = EXPERT_BOUND * self.largest_change_n;
        let mut said = [Lanes::ZERO; EXPERTS];
        for (ridge, said) in said.chunks_exact_mut(NESTED).enumerate() {
            let age = if self.early() { 0 } else { self.renewals(ridge, self.delay_ticks) };
            let Some(found) = self.found[ridge].get(age) else { continue };
            for ((said, parameters), length) in said.iter_mut().zip(found).zip(LENGTHS) {
                *said = clip(predict(parameters, q, length), bound_n);
            }
        }
        self.mixture.judge(&said, change, self.caution());
    }

    /// Returns the tick between two renewals in which a ridge is solved.
    const fn phase(&self, ridge: usize) -> usize {
        ridge * self.every / RIDGES
    }

    /// Returns how often a ridge was solved in the last `ticks` ticks, not counting this tick.
    const fn renewals(&self, ridge: usize, ticks: usize) -> usize {
        let ahead = self.every - self.phase(ridge) - 1;
        (self.tick + ahead) / self.every - (self.tick + 1 - ticks + ahead) / self.every
    }

    fn solve(&mut self, learn: bool) {
        let phase = self.tick % self.every;
        for ridge in 0..RIDGES {
            if phase != self.phase(ridge) {
                continue;
            }
            let mut found = *self.found[ridge].get(0).unwrap_or(&UNKNOWN);
            if learn {
                found = self.regression.solve(ridge);
            }
            // Last resort: a result that is not finite is neither kept nor sent.
            if !found.iter().flatten().all(|p| p.is_finite()) {
                self.regression.reset();
                found = UNKNOWN;
                self.restarts += 1;
            }
            self.found[ridge].push(found);
        }
    }

    /// Combines experts and weights into the model that the leader needs.
    fn model(&self, stance: &MotionState, background: &Background) -> AnchoredModel {
        let weights = self.mixture.weights();
        let mut p = [Lanes::ZERO; REGRESSORS];
        for (found, weights) in self.found.iter().zip(weights.chunks_exact(NESTED)) {
            let found = found.get(0).unwrap_or(&UNKNOWN);
            for ((parameters, weight), length) in found.iter().zip(weights).zip(LENGTHS) {
                for (p, parameter) in p.iter_mut().zip(parameters).take(length) {
                    *p += *parameter * *weight;
                }
            }
        }
        // With no motion since the anchor, only the follower's own quantities remain.
        let constant = predict(&p, &background.regressors(stance, stance), REGRESSORS);
        let [low, high] = self.envelope.bounds_n();
        let force = background.force_n;
        let m = at::MOTION;
        let c = at::CURVATURE;
        AnchoredModel {
            motion: [
                p[m] + force * p[at::LOADED_POSITION],
                p[m + 1],
                p[m + 2] + force * p[at::LOADED_SPEED],
                p[m + 3],
                p[m + 4],
                p[at::FRICTION],
                p[c],
                p[c + 1],
                p[c + 2],
            ],
            constant_n: constant,
            centre_m: background.centre,
            knee: background.knee,
            low_n: low,
            high_n: high,
            bound_n: BOUND * self.largest_change_n,
            degree: self.degree(),
            gain: weights.iter().fold(Lanes::ZERO, |sum, weight| sum + *weight).0.into_iter().fold(0.0, f64::max),
        }
    }

    /// Returns the highest power of the position in the model with the largest weight; 0 without a correction.
    fn degree(&self) -> u8 {
        let sum = |[x, y, z, _]: [f64; 4]| x + y + z;
        let [linear, full] =
            [0, 1].map(|nested| self.mixture.weights().iter().skip(nested).step_by(2).map(|w| sum(w.0)).sum::<f64>());
        match linear + full > 0.0 {
            true if full > linear => 3,
            true => 1,
            false => 0,
        }
    }

    fn forget(&mut self) {
        self.tick = 0;
        self.regression.reset();
        self.found.iter_mut().for_each(DelayLine::clear);
        self.moments.clear();
        self.mixture.reset();
        self.largest_change_n = 0.0;
        self.envelope.reset();
    }
}

impl FollowerEnd for Learner {
    fn serves(&self, modes: ModeSet) -> bool {
        modes.contains(Mode::Anchored)
    }

    fn take(&mut self, seen: &MethodInput<'_>, parcel: &mut LinkPacket, report: &mut IdentificationReport) {
        parcel.models.anchored = self.step(&seen.posture.stance, seen.force_n, seen.good, seen.learn);
        if seen.learn {
            report.degrees.anchored = parcel.models.anchored.degree;
            report.gain = parcel.models.anchored.gain;
            report.failures.restarts = self.restarts;
        }
    }

    /// Changes the delay; everything learned at the old delay is discarded.
    fn set_delay(&mut self, delay_ticks: usize) {
        if delay_ticks != self.delay_ticks {
            self.delay_ticks = delay_ticks;
            self.forget();
        }
    }

    fn reset(&mut self) {
        self.surroundings.reset();
        self.restarts = 0;
        self.forget();
    }
}
