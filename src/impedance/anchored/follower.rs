//! One tick of anchored rendering at the follower: remember, judge, learn, mix.

use super::{
    super::{features::Features, messages::clip, settings::MAX_DELAY_S},
    bands::{BandMotion, Bands},
    correction::{Correction, Seen, within},
    cross_talk::CrossTalk,
    keep,
    learner::{self, Learner},
    mixture::{EXPERTS, Mixture},
    regressors::{FOLLOWER_ONLY, REGRESSORS, State, VARIANTS, VARIED, regressors},
};
use crate::signal::{DelayLine, Lanes};

/// Memory of the means that motion and force are counted from, s.
const SLOW_S: f64 = 2.0;
/// The correction may be this many times the largest change of force recently seen over the delay.
const BOUND: f64 = 1.5;
/// Memory of the forces' envelope, s, and how far beyond it may be rendered, as a share of its width.
const ENVELOPE_S: f64 = 5.0;
const ENVELOPE_MARGIN: f64 = 0.1;
/// What only the follower knows is bounded by this many times its typical size: a jump never seen before is not extrapolated.
const SURPRISE: f64 = 6.0;

/// Coefficients of the regression axis by axis.
type Coefficients = learner::Coefficients<REGRESSORS, VARIANTS>;
const NOTHING: Coefficients = learner::nothing();

/// Everything about one tick that is needed when its consequences arrive a delay later.
#[derive(Clone, Copy, Debug, Default)]
struct Past {
    good: bool,
    seen: Seen,
    state: State,
    weights: [f64; EXPERTS],
    bound_n: f64,
    envelope: [Lanes; 2],
}

/// Learns the change of force over the delay from the follower's samples.
#[derive(Clone, Debug)]
pub(in super::super) struct Follower {
    rate_hz: f64,
    delay_ticks: usize,
    /// Ticks since the delay was set.
    tick: usize,
    motion_bands: Bands,
    force_bands: Bands,
    slow_share: f64,
    started: bool,
    centre: Lanes,
    mean_force: Lanes,
    friction_scale: Lanes,
    seen: [Lanes; 2],
    past: DelayLine<Past>,
    snapshots: DelayLine<Coefficients>,
    learner: Learner<REGRESSORS, VARIANTS>,
    cross_talk: Option<CrossTalk>,
    mixture: Mixture,
    judged: f64,
    largest_change_n: f64,
    mean_change_n: f64,
}

impl Follower {
    /// Allocates everything, for delays up to [`MAX_DELAY_S`].
    pub(in super::super) fn new(rate_hz: f64, delay_ticks: usize, cross_talk: bool) -> Self {
        let most = (MAX_DELAY_S * rate_hz).ceil() as usize;
        let learner = Learner::new(rate_hz, VARIED);
        Self {
            rate_hz,
            delay_ticks,
            tick: 0,
            motion_bands: Bands::new(rate_hz),
            force_bands: Bands::new(rate_hz),
            slow_share: 1.0 - keep(SLOW_S, rate_hz),
            started: false,
            centre: Lanes::ZERO,
            mean_force: Lanes::ZERO,
            friction_scale: Lanes::ZERO,
            seen: [Lanes::ZERO; 2],
            past: DelayLine::new(most, Past::default()),
            snapshots: DelayLine::new(most / learner.ticks_per_solve() + 1, NOTHING),
            learner,
            cross_talk: cross_talk.then(|| CrossTalk::new(rate_hz, most)),
            mixture: Mixture::new(rate_hz),
            judged: 0.0,
            largest_change_n: 0.0,
            mean_change_n: 0.0,
        }
    }

    /// Takes this tick's position (m), its features (scaled) and force (N); `good`: they were measured. Gives the correction
    /// to send.
    pub(in super::super) fn step(
        &mut self,
        position: Lanes,
        features: &Features,
        force: Lanes,
        good: bool,
    ) -> Correction {
        let seen = Seen { bands: self.motion_bands.motion(position), features: *features };
        let state = self.observe(&seen.bands, force, good);
        if self.tick.is_multiple_of(self.learner.ticks_per_solve()) {
            *self.snapshots.push_slot() = *self.learner.solutions();
            if let Some(cross_talk) = &mut self.cross_talk {
                cross_talk.begin_round();
            }
        }
        if let Some(then) = self.past.get(self.delay_ticks.wrapping_sub(1)).filter(|_| self.delay_ticks > 0).copied()
            && good
            && then.good
        {
            self.take_in(&seen, force, &then);
        }
        let early = self.tick < 3 * self.delay_ticks;
        let gate = if self.delay_ticks > 0 { self.mixture.gate(early) } else { 0.0 };
        let bound_n = BOUND * self.largest_change_n;
        let envelope = self.envelope();
        let weights = *self.mixture.weights();
        self.past.push(Past { good, seen, state, weights, bound_n, envelope });
        self.tick += 1;
        self.mixed(&seen.bands, &state, gate, bound_n, envelope)
    }

    /// Updates the slow means and the envelope; gives the state of this tick.
    fn observe(&mut self, motion: &BandMotion, force: Lanes, good: bool) -> State {
        if !self.started && good {
            self.started = true;
            self.centre = motion.x;
            self.mean_force = force;
            self.seen = [force; 2];
        }
        self.centre += (motion.x - self.centre) * self.slow_share;
        self.mean_force += (force - self.mean_force) * self.slow_share;
        self.friction_scale += (motion.u[1].map(f64::abs) - self.friction_scale) * self.slow_share;
        let [lowest, highest] = &mut self.seen;
        let leak = (*highest - *lowest) * (0.5 / (ENVELOPE_S * self.rate_hz));
        *lowest = (*lowest + leak).zip(force, f64::min);
        *highest = (*highest - leak).zip(force, f64::max);
        let force_bands = self.force_bands.high_passes(force);
        let settled = self.tick > 2 * self.delay_ticks;
        let bounded = |value: Lanes, column: usize| {
            if !settled {
                return value;
            }
            let most = self.learner.typical(column) * SURPRISE;
            value.zip(most, |value, most| value.clamp(-most, most))
        };
        State {
            force,
            force_bands: std::array::from_fn(|j| bounded(force_bands[j], 5 + j)),
            centre: self.centre,
            friction_scale: self.friction_scale,
            position_level: bounded(motion.x - self.centre, 15),
            force_level: bounded(force - self.mean_force, 16),
            band_levels: std::array::from_fn(|j| bounded(motion.u[j], 18 + j)),
        }
    }

    /// What the sample of one delay ago has led to: judge the variants by it, then learn from it.
    fn take_in(&mut self, now: &Seen, force: Lanes, then: &Past) {
        let change = force - then.state.force;
        let change_n = change.norm();
        let columns = regressors(&now.bands, &then.seen.bands, &then.state);
        self.judged += 1.0;
        self.learner.measure(&columns);
        let fade = keep((2.0 * self.delay_ticks as f64 / self.rate_hz).max(0.5), self.rate_hz);
        self.largest_change_n = (self.largest_change_n * fade).max(change_n);
        self.mean_change_n += (change_n - self.mean_change_n) / self.judged.min(2.0 * self.rate_hz);
        let newest = *self.snapshots.get(0).unwrap_or(&NOTHING);
        if self.tick > self.delay_ticks {
            self.judge(&columns, now, change, then, &newest);
        }
        self.learner.learn(&columns, change, &newest);
        self.learner.solve_due(self.tick);
        if let Some(cross_talk) = &mut self.cross_talk {
            cross_talk.learn(&now.features, &then.seen.features, change, self.tick);
        }
    }

    fn judge(&mut self, columns: &[Lanes; REGRESSORS], now: &Seen, change: Lanes, then: &Past, newest: &Coefficients) {
        // Early on the newest parameters stand in for those of a delay ago, so that rendering begins a delay sooner.
        let early = self.tick < 3 * self.delay_ticks;
        let latest = self.past.get(0).unwrap_or(then);
        let (weights, bound_n, envelope) = if early {
            (*self.mixture.weights(), BOUND * self.largest_change_n, latest.envelope)
        } else {
            (then.weights, then.bound_n, then.envelope)
        };
        // Snapshots are one a round; the one in force at the tick of `then`.
        let round = self.learner.ticks_per_solve();
        let rounds_ago = if early { 0 } else { self.tick / round - (self.tick - self.delay_ticks) / round };
        let coefficients = self.snapshots.get(rounds_ago).unwrap_or(newest);
        let mut expected = [Lanes::ZERO; EXPERTS];
        expected[..VARIANTS].copy_from_slice(&self.learner.expectations(coefficients, columns));
        if let Some(cross_talk) = &self.cross_talk {
            expected[VARIANTS] = cross_talk.expectation(rounds_ago, &now.features, &then.seen.features);
        }
        let mut mix = Lanes::ZERO;
        for (expected, weight) in expected.iter().zip(weights) {
            mix += *expected * weight;
        }
        let rendered = within(then.state.force + clip(mix, bound_n), &envelope);
        let error_n = (then.state.force + change - rendered).norm();
        for expected in &mut expected {
            *expected = clip(*expected, 2.0 * self.largest_change_n);
        }
        self.mixture.judge(&expected, change, error_n, self.mean_change_n);
    }

    fn envelope(&self) -> [Lanes; 2] {
        let [lowest, highest] = self.seen;
        let margin = (highest - lowest) * ENVELOPE_MARGIN;
        [lowest - margin, highest + margin]
    }

    /// All variants by their weights, with what only the follower knows folded into one constant.
    fn mixed(&self, motion: &BandMotion, state: &State, gate: f64, bound_n: f64, envelope: [Lanes; 2]) -> Correction {
        let share: f64 = gate * self.mixture.weights().iter().sum::<f64>();
        if share <= 0.0 {
            return Correction::NONE;
        }
        let mut sum = [Lanes::ZERO; REGRESSORS];
        let newest = self.snapshots.get(0).unwrap_or(&NOTHING);
        for (variant, weight) in newest.iter().zip(self.mixture.weights()) {
            for (sum, coefficient) in sum.iter_mut().zip(variant) {
                *sum += *coefficient * (gate * weight);
            }
        }
        let columns = regressors(motion, motion, state);
        let constant = FOLLOWER_ONLY.iter().fold(Lanes::ZERO, |constant, &j| constant + sum[j] * columns[j]);
        Correction {
            share,
            bound_n,
            envelope,
            centre: state.centre,
            friction_scale: state.friction_scale,
            constant,
            stiffness: sum[0] + state.force * sum[9],
            bands: [sum[1], sum[2] + state.force * sum[10], sum[3], sum[4]],
            friction: sum[11],
            powers: [sum[12], sum[13], sum[14]],
            cross_talk: self
                .cross_talk
                .as_ref()
                .map(|learner| learner.newest().map(|m| m * (gate * self.mixture.weights()[VARIANTS]))),
        }
    }

    /// The newest motion.
    pub(in super::super) fn seen(&self) -> Seen {
        self.past.get(0).map(|past| past.seen).unwrap_or_default()
    }

    /// Learns at another delay from now on; what was learnt at the old one is forgotten, the past itself is not.
    pub(in super::super) fn set_delay(&mut self, delay_ticks: usize) {
        if delay_ticks != self.delay_ticks {
            self.delay_ticks = delay_ticks;
            self.forget();
        }
    }

    fn forget(&mut self) {
        self.tick = 0;
        self.learner.reset();
        if let Some(cross_talk) = &mut self.cross_talk {
            cross_talk.reset();
        }
        self.mixture.reset();
        self.snapshots.clear();
        self.judged = 0.0;
        self.largest_change_n = 0.0;
        self.mean_change_n = 0.0;
    }

    pub(in super::super) fn reset(&mut self) {
        self.forget();
        self.motion_bands.reset();
        self.force_bands.reset();
        self.past.clear();
        self.started = false;
        (self.centre, self.mean_force, self.friction_scale) = (Lanes::ZERO, Lanes::ZERO, Lanes::ZERO);
        self.seen = [Lanes::ZERO; 2];
    }
}
