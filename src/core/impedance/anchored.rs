//! Anchored rendering, the follower's part: learns how force changes over the delay, and judges itself at that horizon.
//!
//! The force at the hand is the last one measured plus a correction, `f^(t) = f(t-D) + c`. The correction is a mixture of
//! experts: regressions of the change of force over D itself on the change of motion over D and on what the follower knew D
//! ago. What the follower alone knows is folded into a constant before it is sent; the leader puts in its own motion. Every
//! expert's prediction, made with what was known D ago, is compared with the force that came; no correction (delayed
//! reflection) is always among the experts, as the part of the weights that is missing to one.

use super::{
    envelope::Envelope,
    messages::{AnchoredModel, clip},
    mixture::Mixture,
    regression::{Parameters, Regression, SOLUTIONS, length, predict},
    regressors::{Background, REGRESSORS, Regressors, Stance, Surroundings, at},
    settings::{MAX_DELAY_S, Settings},
};
use crate::signal::{DelayLine, Lanes, settled};

/// A correction may be this many times the change of force recently seen over the delay.
const BOUND: f64 = 1.5;
/// What an expert said is judged within this many times that change.
const EXPERT_BOUND: f64 = 2.0;
/// Solves per second of every model (at most one a tick).
const SOLVE_HZ: f64 = 200.0;
/// The error of reflection is taken for this share of what it is while the judgement is made with newer parameters than those
/// that would have been sent (which is optimistic), and in the first moments, when nothing is known but free motion: a first
/// contact was rendered up to 4 % worse than reflected.
const EARLY_CAUTION: f64 = 0.6;
const FIRST_CAUTION: f64 = 0.2;
const FIRST_S: f64 = 0.3;

#[derive(Clone, Debug)]
pub(super) struct Anchored {
    rate_hz: f64,
    delay_ticks: usize,
    every: usize,
    tick: usize,
    surroundings: Surroundings,
    regression: Regression,
    parameters: Parameters,
    snapshots: DelayLine<Parameters>,
    moments: DelayLine<Moment>,
    mixture: Mixture<SOLUTIONS>,
    largest_change_n: f64,
    envelope: Envelope,
    restarts: u64,
}

/// What the follower was like at one tick.
#[derive(Clone, Copy, Debug, Default)]
struct Moment {
    good: bool,
    stance: Stance,
    background: Background,
}

impl Anchored {
    pub(super) fn new(settings: &Settings, delay_ticks: usize) -> Self {
        let rate_hz = settings.rate_hz;
        let every = ((rate_hz / SOLVE_HZ).round() as usize).max(1);
        let max_delay = (MAX_DELAY_S * rate_hz).ceil() as usize;
        let blank = [[Lanes::ZERO; REGRESSORS]; SOLUTIONS];
        Self {
            rate_hz,
            delay_ticks,
            every,
            tick: 0,
            surroundings: Surroundings::new(settings),
            regression: Regression::new(rate_hz),
            parameters: blank,
            snapshots: DelayLine::new(max_delay / every + 1, blank),
            moments: DelayLine::new(max_delay, Moment::default()),
            mixture: Mixture::new(rate_hz),
            largest_change_n: 0.0,
            envelope: Envelope::new(rate_hz),
            restarts: 0,
        }
    }

    /// Takes the follower's newest motion and force; `good`: the sample was measured, not bridged; `learn`: there is something to
    /// learn from.
    pub(super) fn step(&mut self, stance: &Stance, force_n: Lanes, good: bool, learn: bool) -> AnchoredModel {
        let d = self.delay_ticks;
        let usual = (self.tick > 2 * d).then(|| self.regression.mean_squares());
        let background = self.surroundings.step(stance, force_n, usual);
        if learn {
            self.envelope.see(force_n, 1.0);
        }
        self.moments.push(Moment { good, stance: *stance, background });
        if let Some(then) = self.moments.get(d).filter(|then| d > 0 && learn && good && then.good).copied() {
            let q = then.background.regressors(stance, &then.stance);
            let change = force_n - then.background.force_n;
            let forget = (-1.0 / ((2.0 * d as f64).max(0.5 * self.rate_hz))).exp();
            self.largest_change_n = settled(self.largest_change_n * forget).max(change.norm());
            if self.tick > d {
                self.judge(&q, change);
            }
            let newest = self.snapshots.get(0).unwrap_or(&self.parameters);
            self.regression.learn(&q, change, newest);
        }
        self.solve(learn);
        let model = self.model(stance, &background);
        self.tick += 1;
        model
    }

    /// Judged with newer parameters than those that would have been sent, so that rendering starts one delay earlier.
    fn early(&self) -> bool {
        self.tick < 3 * self.delay_ticks
    }

    /// The share of reflection's error that counts against a correction.
    fn caution(&self) -> f64 {
        match self.early() {
            true if (self.tick as f64) < FIRST_S * self.rate_hz => FIRST_CAUTION,
            true => EARLY_CAUTION,
            false => 1.0,
        }
    }

    fn judge(&mut self, q: &Regressors, change: Lanes) {
        let (tick, d) = (self.tick, self.delay_ticks);
        let newest_block = (tick - 1) / self.every;
        let age = if self.early() { 0 } else { newest_block - (tick - d) / self.every };
        let Some(parameters) = self.snapshots.get(age) else { return };
        let mut said = [Lanes::ZERO; SOLUTIONS];
        for (solution, said) in said.iter_mut().enumerate() {
            *said = clip(predict(&parameters[solution], q, length(solution)), EXPERT_BOUND * self.largest_change_n);
        }
        self.mixture.judge(&said, change, self.caution());
    }

    /// One solve per ridge, spread over a block of ticks; a block's work becomes the next block's snapshot.
    fn solve(&mut self, learn: bool) {
        let phase = self.tick % self.every;
        for ridge in 0..SOLUTIONS / 2 {
            if learn && ridge * self.every / (SOLUTIONS / 2) == phase {
                self.regression.solve(ridge, &mut self.parameters);
            }
        }
        if phase == 0 {
            // A last resort: whatever a sum has caught, it is not kept and not sent.
            if !self.parameters.iter().flatten().all(|p| p.is_finite()) {
                self.regression.reset();
                self.parameters = [[Lanes::ZERO; REGRESSORS]; SOLUTIONS];
                self.restarts += 1;
            }
            self.snapshots.push(self.parameters);
        }
    }

    /// Experts and weights folded into what the leader needs.
    fn model(&self, stance: &Stance, background: &Background) -> AnchoredModel {
        let weights = self.mixture.weights();
        let mut p = [Lanes::ZERO; REGRESSORS];
        if let Some(parameters) = self.snapshots.get(0) {
            for (solution, (parameters, weight)) in parameters.iter().zip(weights).enumerate() {
                for (p, parameter) in p.iter_mut().zip(parameters).take(length(solution)) {
                    *p += *parameter * *weight;
                }
            }
        }
        // With no motion since the anchor only what the follower alone knows is left.
        let constant = predict(&p, &background.regressors(stance, stance), REGRESSORS);
        let [low, high] = self.envelope.bounds_n();
        let (force, m, c) = (background.force_n, at::MOTION, at::CURVATURE);
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

    /// The highest power of the position in the model that most of the weight is on; 0 without a correction.
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

    /// How often the regressions had to begin anew because a number was not finite.
    pub(super) fn restarts(&self) -> u64 {
        self.restarts
    }

    /// Learns and judges at another delay from now on; what was learnt at the old one is forgotten.
    pub(super) fn set_delay(&mut self, delay_ticks: usize) {
        if delay_ticks != self.delay_ticks {
            self.delay_ticks = delay_ticks;
            self.forget();
        }
    }

    pub(super) fn reset(&mut self) {
        self.surroundings.reset();
        self.restarts = 0;
        self.forget();
    }

    fn forget(&mut self) {
        self.tick = 0;
        self.regression.reset();
        self.parameters = [[Lanes::ZERO; REGRESSORS]; SOLUTIONS];
        self.snapshots.clear();
        self.moments.clear();
        self.mixture.reset();
        self.largest_change_n = 0.0;
        self.envelope.reset();
    }
}

/// Each lane kept between two bounds.
#[inline]
pub(super) fn within(value: Lanes, low: Lanes, high: Lanes) -> Lanes {
    value.zip(low, f64::max).zip(high, f64::min)
}
