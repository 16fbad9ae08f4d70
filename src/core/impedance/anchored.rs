//! Anchored rendering, the follower's part: learns how force changes over the delay, and judges itself at that horizon.
//!
//! The force at the hand is the last one measured plus a correction, `f^(t) = f(t-D) + c`. The correction is a mixture of
//! experts: the window's impedance `M (phi(t) - phi(t-D))`, and six regressions of the change of force over D itself on the
//! change of motion over D and on what the follower knew D ago. What the follower alone knows is folded into a constant
//! before it is sent; the leader puts in its own motion. Every expert's prediction, made with what was known D ago, is
//! compared with the force that came; no correction (delayed reflection) is always among the experts, as the part of the
//! weights that is missing to one, and a guard falls back to it altogether.

use super::{
    envelope::Envelope,
    features::Features,
    messages::{AnchoredModel, Impedance, clip},
    regression::{Parameters, Regression, SOLUTIONS, length, predict},
    regressors::{Background, REGRESSORS, Regressors, Stance, Surroundings, at},
    settings::{MAX_DELAY_S, Settings},
    stack::Stack,
};
use crate::signal::{DelayLine, Lanes, settled};

/// A correction may be this many times the change of force recently seen over the delay.
const BOUND: f64 = 1.5;
/// Solves per second of every model (at most one a tick).
const SOLVE_HZ: f64 = 200.0;
/// Added to the guard's ratio while the judgement is made with newer parameters than those that would have been sent (which
/// is optimistic), and in the first moments, when nothing is known but free motion: a first contact was rendered up to 4 %
/// worse than reflected.
const EARLY_PENALTY: f64 = 0.4;
const FIRST_PENALTY: f64 = 0.8;
const FIRST_S: f64 = 0.3;

/// The window's impedance and the regressions.
const EXPERTS: usize = 1 + SOLUTIONS;

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
    decisions: DelayLine<Decision>,
    stack: Stack<EXPERTS>,
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
    features: Features,
    impedance: Impedance,
}

/// What was decided at one tick.
#[derive(Clone, Copy, Debug, Default)]
struct Decision {
    weights: [f64; EXPERTS],
    bound_n: f64,
    envelope_n: [Lanes; 2],
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
            decisions: DelayLine::new(max_delay, Decision::default()),
            stack: Stack::new(rate_hz),
            largest_change_n: 0.0,
            envelope: Envelope::new(rate_hz),
            restarts: 0,
        }
    }

    /// Takes the follower's newest motion and force and the window's impedance; `good`: the sample was measured, not bridged;
    /// `learn`: there is something to learn from.
    pub(super) fn step(
        &mut self,
        stance: &Stance,
        features: &Features,
        force_n: Lanes,
        impedance: &Impedance,
        good: bool,
        learn: bool,
    ) -> AnchoredModel {
        let d = self.delay_ticks;
        let usual = (self.tick > 2 * d).then(|| self.regression.mean_squares());
        let background = self.surroundings.step(stance, force_n, usual);
        if learn {
            self.envelope.see(force_n, 1.0);
        }
        self.moments.push(Moment { good, stance: *stance, background, features: *features, impedance: *impedance });
        if let Some(then) = self.moments.get(d).filter(|then| d > 0 && learn && good && then.good).copied() {
            let q = then.background.regressors(stance, &then.stance);
            let change = force_n - then.background.force_n;
            let forget = (-1.0 / ((2.0 * d as f64).max(0.5 * self.rate_hz))).exp();
            self.largest_change_n = settled(self.largest_change_n * forget).max(change.norm());
            self.stack.see_change(change.norm());
            if self.tick > d {
                self.judge(&q, &then, features, change);
            }
            let newest = self.snapshots.get(0).unwrap_or(&self.parameters);
            self.regression.learn(&q, change, newest);
        }
        self.solve(learn);
        let model = self.model(stance, &background, impedance);
        let decision = Decision {
            weights: *self.stack.weights(),
            bound_n: model.bound_n,
            envelope_n: [model.low_n, model.high_n],
        };
        self.decisions.push(decision);
        self.tick += 1;
        model
    }

    /// Judged with newer parameters than those that would have been sent, so that rendering starts one delay earlier.
    fn early(&self) -> bool {
        self.tick < 3 * self.delay_ticks
    }

    fn judge(&mut self, q: &Regressors, then: &Moment, features: &Features, change: Lanes) {
        let (tick, d) = (self.tick, self.delay_ticks);
        let newest_block = (tick - 1) / self.every;
        let age = if self.early() { 0 } else { newest_block - (tick - d) / self.every };
        let Some(parameters) = self.snapshots.get(age) else { return };
        let mut said = [then.impedance.change(features, &then.features); EXPERTS];
        for (solution, said) in said[1..].iter_mut().enumerate() {
            *said = predict(&parameters[solution], q, length(solution));
        }
        let Some(newest) = self.decisions.get(0) else { return };
        let decision = if self.early() {
            Decision { weights: *self.stack.weights(), bound_n: BOUND * self.largest_change_n, ..*newest }
        } else {
            *self.decisions.get(d - 1).unwrap_or(newest)
        };
        let mixed = said.iter().zip(decision.weights).fold(Lanes::ZERO, |sum, (said, weight)| sum + *said * weight);
        let [low, high] = decision.envelope_n;
        let force_n = then.background.force_n;
        let mixed = within(force_n + clip(mixed, decision.bound_n), low, high) - force_n;
        self.stack.judge(said, mixed, change, self.largest_change_n);
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

    /// Experts, weights and gate folded into what the leader needs.
    fn model(&self, stance: &Stance, background: &Background, impedance: &Impedance) -> AnchoredModel {
        let first = (self.tick as f64) < FIRST_S * self.rate_hz;
        let penalty = if first { FIRST_PENALTY } else { EARLY_PENALTY };
        let gate = self.stack.gate(if self.early() { penalty } else { 0.0 });
        let weights = self.stack.weights().map(|weight| gate * weight);
        let mut p = [Lanes::ZERO; REGRESSORS];
        if let Some(parameters) = self.snapshots.get(0) {
            for (solution, (parameters, weight)) in parameters.iter().zip(&weights[1..]).enumerate() {
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
            impedance: impedance.weighted(weights[0]),
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
            gain: weights.iter().sum(),
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
        self.decisions.clear();
        self.stack.reset();
        self.largest_change_n = 0.0;
        self.envelope.reset();
    }
}

/// Each lane kept between two bounds.
#[inline]
pub(super) fn within(value: Lanes, low: Lanes, high: Lanes) -> Lanes {
    value.zip(low, f64::max).zip(high, f64::min)
}
