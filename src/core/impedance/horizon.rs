//! Which of the nested window solutions foretells the change of force best at the true delay.

use super::{
    cross_talk::CrossTalk,
    factor::column_start,
    features::{Features, MOTION_COLUMNS},
    messages::{Impedance, clip},
    settings::{MAX_DELAY_S, Settings},
    solution::{Increments, PRODUCTS, Solution},
};
use crate::signal::{DelayLine, Lanes, settled};

/// Time constant of the running errors (s).
const MEMORY_S: f64 = 0.5;
/// A correction may be this many times the change of force recently seen over the delay.
const BOUND: f64 = 1.5;
/// A candidate must do better than this share of the plain reflection's error.
const MARGIN: f64 = 0.98;
/// How often the solutions are renewed (Hz, at most once a tick): they are large, and hardly change in 5 ms.
const RENEW_HZ: f64 = 200.0;

/// Keeps what every candidate (motion columns 0 to 15; 0 is no correction) would have foretold, and compares it with the
/// change of force that then came.
///
/// The prediction for time `s` uses the solution, the force and the features of `s - D` and the features of `s`, exactly
/// what the leader has at `s`; its running error decides what the parcel of time `s` carries. So the choice is causal and
/// the leader only renders.
#[derive(Clone, Debug)]
pub(super) struct Horizon {
    solutions: DelayLine<Increments>,
    past: DelayLine<Past>,
    candidates: usize,
    delay_ticks: usize,
    every: usize,
    tick: usize,
    forget: f64,
    errors_n: [f64; MOTION_COLUMNS + 1],
    largest_change_n: f64,
    newest: Impedance,
    cross: Option<CrossTalk>,
}

#[derive(Clone, Copy, Debug)]
struct Past {
    features: Features,
    force_n: Lanes,
    bound_n: f64,
}

impl Horizon {
    pub(super) fn new(settings: &Settings, ridge: f64, delay_ticks: usize) -> Self {
        let Settings { rate_hz, max_degree, .. } = *settings;
        let blank = Past { features: [Lanes::ZERO; MOTION_COLUMNS], force_n: Lanes::ZERO, bound_n: 0.0 };
        let max_delay = (MAX_DELAY_S * rate_hz).ceil() as usize;
        let every = ((rate_hz / RENEW_HZ).round() as usize).max(1);
        let forget = 1.0 - (-1.0 / (MEMORY_S * rate_hz)).exp();
        let renewals = max_delay / every + 1;
        let cross = (settings.cross_talk && settings.axes > 1)
            .then(|| CrossTalk::new(settings.block(), max_degree, ridge, renewals, forget));
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
            newest: Impedance::NONE,
            cross,
        }
    }

    /// Goes on without judging: only what a later judgement needs is kept.
    pub(super) fn rest(&mut self, features: &Features, force_n: Lanes) -> Impedance {
        self.keep(features, force_n);
        if self.tick.is_multiple_of(self.every)
            && let Some(solution) = self.solutions.get(0).copied()
        {
            self.solutions.push(solution);
            self.cross.iter_mut().for_each(CrossTalk::rest);
        }
        self.tick += 1;
        self.newest
    }

    fn keep(&mut self, features: &Features, force_n: Lanes) {
        self.past.push(Past { features: *features, force_n, bound_n: BOUND * self.largest_change_n });
    }

    /// Judges all candidates on the newest sample and returns the one to send. `good`: the force is a measurement; `usable`:
    /// the features are those of a full filter, too.
    pub(super) fn step(
        &mut self,
        solution: &Solution,
        features: &Features,
        force_n: Lanes,
        good: bool,
        usable: bool,
    ) -> Impedance {
        if good && self.delay_ticks > 0 {
            self.judge(features, force_n);
        }
        self.keep(features, force_n);
        let renew = self.tick.is_multiple_of(self.every);
        if renew {
            self.solutions.push(*solution.increments());
        }
        if let Some(cross) = &mut self.cross {
            cross.step(usable.then_some((features, force_n)), renew);
        }
        let (choice, coupled) = self.choice();
        if renew || (choice, coupled) != (usize::from(self.newest.columns), self.newest.coupled) {
            self.newest = match &self.cross {
                Some(cross) if coupled => cross.impedance(choice / 3),
                _ => self.impedance(choice),
            };
        }
        self.tick += 1;
        self.newest
    }

    fn judge(&mut self, features: &Features, force_n: Lanes) {
        // Before this tick is stored: the newest is one tick old.
        let Some(then) = self.past.get(self.delay_ticks - 1) else { return };
        let age = (self.tick - 1) / self.every - (self.tick - self.delay_ticks) / self.every;
        let Some(solution) = self.solutions.get(age) else { return };
        let change = force_n - then.force_n;
        let decayed = settled(self.largest_change_n * (1.0 - self.forget));
        self.largest_change_n = decayed.max(change.norm());
        let mut moved = *features;
        for (now, then) in moved.iter_mut().zip(&then.features) {
            *now -= *then;
        }
        let mut foretold = Lanes::ZERO;
        for (columns, mean) in self.errors_n.iter_mut().enumerate().take(self.candidates + 1) {
            foretold +=
                part(solution, columns).iter().zip(&moved).fold(Lanes::ZERO, |sum, (m, moved)| sum + *m * *moved);
            let error_n = (change - clip(foretold, then.bound_n)).norm();
            *mean = settled(*mean + self.forget * (error_n - *mean));
        }
        if let Some(cross) = &mut self.cross {
            cross.judge(age, &moved, change, then.bound_n);
        }
    }

    /// The newest solution with this many motion columns.
    fn impedance(&self, columns: usize) -> Impedance {
        let mut impedance = Impedance { columns: columns as u8, ..Impedance::NONE };
        if let Some(solution) = self.solutions.get(0) {
            for column in 1..=columns {
                for (sum, part) in impedance.coefficients.iter_mut().zip(part(solution, column)) {
                    *sum += *part;
                }
            }
        }
        impedance
    }

    /// The candidate with the least running error (motion columns; whether coupled); 0 unless one is clearly better than no
    /// correction, coupled only if that is clearly better still.
    fn choice(&self) -> (usize, bool) {
        let (columns, error_n) = self.best();
        match &self.cross {
            Some(cross) if cross.best().1 < MARGIN * error_n => (3 * cross.best().0, true),
            _ => (columns, false),
        }
    }

    fn best(&self) -> (usize, f64) {
        let mut best = (0, MARGIN * self.errors_n[0]);
        for columns in 1..=self.candidates {
            if self.errors_n[columns] < best.1 {
                best = (columns, self.errors_n[columns]);
            }
        }
        best
    }

    /// Error of the best candidate with cross-talk relative to the best without; 1 where there is none.
    pub(super) fn cross_talk_ratio(&self) -> f64 {
        let error_n = self.best().1;
        self.cross.as_ref().filter(|_| error_n > 0.0).map_or(1.0, |cross| cross.best().1 / error_n)
    }

    /// Judges at another delay from now on; what was learnt at the old one is forgotten.
    pub(super) fn set_delay(&mut self, delay_ticks: usize) {
        if delay_ticks != self.delay_ticks {
            self.delay_ticks = delay_ticks;
            self.errors_n = [0.0; MOTION_COLUMNS + 1];
            self.largest_change_n = 0.0;
            if let Some(cross) = &mut self.cross {
                cross.forget_errors();
            }
        }
    }

    pub(super) fn reset(&mut self) {
        self.solutions.clear();
        self.past.clear();
        self.tick = 0;
        self.errors_n = [0.0; MOTION_COLUMNS + 1];
        self.largest_change_n = 0.0;
        self.newest = Impedance::NONE;
        if let Some(cross) = &mut self.cross {
            cross.reset();
        }
    }
}

/// What motion column `column` (1 to 15) adds to the coefficients of the motion columns up to itself; nothing for column 0.
#[inline]
fn part(increments: &Increments, column: usize) -> &[Lanes] {
    &increments[column_start(column) + 1..=column_start(column) + column]
}
