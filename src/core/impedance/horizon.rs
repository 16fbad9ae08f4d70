//! Selects the nested window solution that predicts the change of force best at the true delay.

use super::{
    factor::column_start,
    features::{ImpedanceFeatures, MOTION_COLUMNS},
    messages::clip,
    settings::{ImpedanceSettings, MAX_DELAY_S},
    solution::{ImpedanceSolution, Increments, PRODUCTS},
};
use crate::signal::{DelayLine, Lanes, settled};

/// Time constant of the running errors (s). Chosen as in `anchored.rs`.
/// Shorter memories switch the degree within a contact, longer ones keep a degree of the previous contact.
const MEMORY_S: f64 = 0.5;
/// A correction may be at most this many times the recent change of force over the delay. Chosen as in `anchored.rs`.
/// Without a bound, an extrapolation that is wrong once would be felt as a blow.
const BOUND: f64 = 1.5;
/// A candidate must achieve less than this fraction of the plain reflection's error. A tie is decided for the plain
/// reflection, because a correction that does not help can only do harm.
const MARGIN: f64 = 0.98;
/// Renewals of the solutions per second (at most one per tick): they are large, and hardly change in 5 ms.
const RENEW_HZ: f64 = 200.0;

/// Stores the predictions of every candidate (motion columns 0 to 15; 0 means no correction), and compares them with the
/// change of force that followed. The prediction for time `s` uses the solution, the force and the features of `s - D`
/// and the features of `s`, which are available to a leader at `s`.
#[derive(Clone, Debug)]
pub(super) struct Horizon {
    solutions: DelayLine<Increments>,
    past: DelayLine<HorizonHistory>,
    candidates: usize,
    delay_ticks: usize,
    every: usize,
    tick: usize,
    forget: f64,
    errors_n: [f64; MOTION_COLUMNS + 1],
    largest_change_n: f64,
}

#[derive(Clone, Copy, Debug)]
struct HorizonHistory {
    features: ImpedanceFeatures,
    force_n: Lanes,
    bound_n: f64,
}

impl Horizon {
    pub(super) fn new(settings: &ImpedanceSettings, delay_ticks: usize) -> Self {
        let ImpedanceSettings { rate_hz, max_degree, .. } = *settings;
        let blank = HorizonHistory { features: [Lanes::ZERO; MOTION_COLUMNS], force_n: Lanes::ZERO, bound_n: 0.0 };
        // For the longest delay that the link accepts, because nothing may be allocated when the delay changes later.
        let max_delay = (MAX_DELAY_S * rate_hz).ceil() as usize;
        let every = ((rate_hz / RENEW_HZ).round() as usize).max(1);
        let forget = 1.0 - libm::exp(-1.0 / (MEMORY_S * rate_hz));
        let renewals = max_delay / every + 1;
        Self {
            solutions: DelayLine::new(renewals, [Lanes::ZERO; PRODUCTS]),
            past: DelayLine::new(max_delay, blank),
            candidates: 3 * max_degree,
            delay_ticks,
            every,
            tick: 0,
            forget,
            errors_n: [0.0; MOTION_COLUMNS + 1],
            largest_change_n: 0.0,
        }
    }

    /// Advances without evaluating: only the data for later evaluations are stored.
    pub(super) fn rest(&mut self, features: &ImpedanceFeatures, force_n: Lanes) {
        self.keep(features, force_n);
        // The solution is stored again although nothing was learnt: one entry for each period keeps the index a
        // function of the tick.
        if self.tick.is_multiple_of(self.every)
            && let Some(solution) = self.solutions.get(0).copied()
        {
            self.solutions.push(solution);
        }
        self.tick += 1;
    }

    fn keep(&mut self, features: &ImpedanceFeatures, force_n: Lanes) {
        // Store the bound at the time of the prediction: the leader could not know a later one.
        self.past.push(HorizonHistory { features: *features, force_n, bound_n: BOUND * self.largest_change_n });
    }

    /// Evaluates all candidates on the newest sample and returns the columns of the best. `good`: the force is a
    /// measurement.
    pub(super) fn step(
        &mut self,
        solution: &ImpedanceSolution,
        features: &ImpedanceFeatures,
        force_n: Lanes,
        good: bool,
    ) -> usize {
        // Without a delay the reflected force is exact, and there is nothing to choose.
        if good && self.delay_ticks > 0 {
            self.judge(features, force_n);
        }
        self.keep(features, force_n);
        if self.tick.is_multiple_of(self.every) {
            // Pushed before the tick advances, so that `age` in `judge` counts whole periods.
            self.solutions.push(*solution.increments());
        }
        self.tick += 1;
        self.choice()
    }

    fn judge(&mut self, features: &ImpedanceFeatures, force_n: Lanes) {
        // This runs before the tick is stored, so the newest entry is one tick old.
        let Some(then) = self.past.get(self.delay_ticks - 1) else { return };
        // Number of renewals between the prediction and now.
        let age = (self.tick - 1) / self.every - (self.tick - self.delay_ticks) / self.every;
        let Some(solution) = self.solutions.get(age) else { return };
        let change = force_n - then.force_n;
        // See `BOUND`: it limits how far a prediction may go.
        // The bound rises at once and falls slowly, so that the first contact after a pause is not clipped by the calm
        // before it.
        let decayed = settled(self.largest_change_n * (1.0 - self.forget));
        self.largest_change_n = decayed.max(change.norm());
        // Predictions use changes of features since the anchor; the force at the anchor is measured.
        let mut moved = *features;
        for (now, then) in moved.iter_mut().zip(&then.features) {
            *now -= *then;
        }
        let mut foretold = Lanes::ZERO;
        for (columns, mean) in self.errors_n.iter_mut().enumerate().take(self.candidates + 1) {
            // The candidates are nested: each adds one column to the prediction of the previous one, so all of them
            // cost as much as the largest.
            foretold +=
                part(solution, columns).iter().zip(&moved).fold(Lanes::ZERO, |sum, (m, moved)| sum + *m * *moved);
            let error_n = (change - clip(foretold, then.bound_n)).norm();
            *mean = settled(*mean + self.forget * (error_n - *mean));
        }
    }

    /// Returns the motion columns of the candidate with the smallest running error; 0 unless one is clearly better than
    /// no correction.
    fn choice(&self) -> usize {
        let mut best = (0, MARGIN * self.errors_n[0]);
        for columns in 1..=self.candidates {
            if self.errors_n[columns] < best.1 {
                best = (columns, self.errors_n[columns]);
            }
        }
        best.0
    }

    /// Evaluates at another delay from now on and discards the errors of the old one.
    pub(super) fn set_delay(&mut self, delay_ticks: usize) {
        if delay_ticks != self.delay_ticks {
            self.delay_ticks = delay_ticks;
            self.errors_n = [0.0; MOTION_COLUMNS + 1];
            // A bound learnt with another delay does not apply to this one.
            self.largest_change_n = 0.0;
        }
    }

    pub(super) fn reset(&mut self) {
        self.solutions.clear();
        self.past.clear();
        self.tick = 0;
        self.errors_n = [0.0; MOTION_COLUMNS + 1];
        self.largest_change_n = 0.0;
    }
}

/// Returns the contribution of motion column `column` (1 to 15) to the coefficients of the motion columns up to itself;
/// nothing for column 0.
#[inline]
fn part(increments: &Increments, column: usize) -> &[Lanes] {
    &increments[column_start(column) + 1..=column_start(column) + column]
}
