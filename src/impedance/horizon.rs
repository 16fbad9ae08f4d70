//! The judge of anchored rendering: every candidate's error at the true delay.

use super::{
    features::{Features, MOTION_COLUMNS},
    messages::clip,
    settings::MAX_DELAY_S,
    solution::{Increments, Solution},
};
use crate::signal::{DelayLine, Lanes};

/// Time constant of the running errors (s).
const MEMORY_S: f64 = 0.5;
/// A correction may be this many times the change of force recently seen over the delay.
const BOUND: f64 = 1.5;
/// A candidate must do better than this share of the plain reflection's error.
const MARGIN: f64 = 0.98;

/// Keeps what every candidate (motion columns 0 to 15; 0 is no correction) would have rendered, and compares it with the
/// force that then arrived.
///
/// The prediction for time `s` uses the solution, the force and the features of `s - D` and the features of `s`, exactly
/// what the leader has at `s`; its running error decides what the parcel of time `s` carries. So the choice is causal and
/// the leader only renders.
#[derive(Clone, Debug)]
pub(super) struct Horizon {
    past: DelayLine<Past>,
    candidates: usize,
    delay_ticks: usize,
    forget: f64,
    errors_n: [f64; MOTION_COLUMNS + 1],
    largest_change_n: f64,
}

#[derive(Clone, Copy, Debug)]
struct Past {
    increments: Increments,
    features: Features,
    force_n: Lanes,
    bound_n: f64,
}

impl Horizon {
    pub(super) fn new(rate_hz: f64, max_degree: usize, delay_ticks: usize) -> Self {
        let blank = Past {
            increments: [Lanes::ZERO; 136],
            features: [Lanes::ZERO; MOTION_COLUMNS],
            force_n: Lanes::ZERO,
            bound_n: 0.0,
        };
        let max_delay = (MAX_DELAY_S * rate_hz).ceil() as usize;
        Self {
            past: DelayLine::new(max_delay, blank),
            candidates: 3 * max_degree,
            delay_ticks,
            forget: 1.0 - (-1.0 / (MEMORY_S * rate_hz)).exp(),
            errors_n: [0.0; MOTION_COLUMNS + 1],
            largest_change_n: 0.0,
        }
    }

    /// Judges all candidates on the newest sample (`good`: the force is a measurement); gives the columns of the best one.
    pub(super) fn step(&mut self, solution: &Solution, features: &Features, force_n: Lanes, good: bool) -> usize {
        if let Some(then) = self.past.get(self.delay_ticks.wrapping_sub(1)).filter(|_| good && self.delay_ticks > 0) {
            let change = force_n - then.force_n;
            let decayed = self.largest_change_n * (1.0 - self.forget);
            self.largest_change_n = decayed.max(change.norm());
            let mut correction = Lanes::ZERO;
            for columns in 0..=self.candidates {
                if columns > 0 {
                    let start = columns * (columns + 1) / 2 + 1;
                    let part = &then.increments[start..start + columns];
                    for ((m, now), then) in part.iter().zip(features).zip(&then.features) {
                        correction += *m * (*now - *then);
                    }
                }
                let error = (change - clip(correction, then.bound_n)).norm();
                self.errors_n[columns] += self.forget * (error - self.errors_n[columns]);
            }
        }
        let bound_n = BOUND * self.largest_change_n;
        let slot = self.past.push_slot();
        slot.increments = *solution.increments();
        slot.features = *features;
        slot.force_n = force_n;
        slot.bound_n = bound_n;
        self.choice()
    }

    /// The candidate with the least running error; 0 unless one is clearly better than no correction.
    fn choice(&self) -> usize {
        let mut best = (0, MARGIN * self.errors_n[0]);
        for columns in 1..=self.candidates {
            if self.errors_n[columns] < best.1 {
                best = (columns, self.errors_n[columns]);
            }
        }
        best.0
    }

    /// Judges at another delay from now on; what was learnt at the old one is forgotten.
    pub(super) fn set_delay(&mut self, delay_ticks: usize) {
        if delay_ticks != self.delay_ticks {
            self.delay_ticks = delay_ticks;
            self.errors_n = [0.0; MOTION_COLUMNS + 1];
            self.largest_change_n = 0.0;
        }
    }

    pub(super) fn reset(&mut self) {
        self.past.clear();
        self.errors_n = [0.0; MOTION_COLUMNS + 1];
        self.largest_change_n = 0.0;
    }
}
