//! Extrapolation by an autoregressive model of the force: `f(t) = c + sum_j a_j f(t - D - j s)`, by recursive least
//! squares.
//!
//! The model is fitted directly at the prediction horizon (the direct form of a multi-step forecast), so that it need
//! not be iterated over hundreds of samples. Its columns are the newest force and the differences between the taps,
//! which are equivalent to the taps and well conditioned; before any learning it is `f(t) = f(t - D)`, reflection.

use nima_core::{
    impedance::{Baseline, BaselineModel, Envelope, MAX_DELAY_S},
    signal::{DelayLine, Lanes, Motion},
};

use crate::{
    BaselineSender,
    rls::{Rls, dot},
};

/// Number of taps, and number of their spacings in a delay (chosen on recordings, see docs/modes.md).
const TAPS: usize = 6;
const SPACINGS: usize = 10;
/// Memory (s) and ridge (s) of the regression.
const MEMORY_S: f64 = 3.0;
const RIDGE_S: f64 = 0.03;
/// Number of solutions per second (at most one per tick), because the parameters hardly change within 5 ms.
const SOLVE_HZ: f64 = 200.0;

/// A constant, the newest force, and the differences of the taps.
const COLUMNS: usize = 1 + TAPS;

#[derive(Clone, Debug)]
pub(crate) struct Autoregressive {
    delay_ticks: usize,
    spacing: usize,
    every: usize,
    tick: usize,
    past: DelayLine<Lanes>,
    rls: Rls<COLUMNS>,
    envelope: Envelope,
    coefficients: [Lanes; COLUMNS],
}

impl Autoregressive {
    /// Returns the columns as they were `ago` ticks ago.
    fn columns(&self, ago: usize) -> Option<[Lanes; COLUMNS]> {
        let mut columns = [Lanes([1.0, 1.0, 1.0, 0.0]); COLUMNS];
        let mut later = *self.past.get(ago)?;
        columns[1] = later;
        for (tap, column) in columns.iter_mut().enumerate().skip(2) {
            let earlier = *self.past.get(ago + (tap - 1) * self.spacing)?;
            *column = later - earlier;
            later = earlier;
        }
        Some(columns)
    }
}

impl BaselineSender for Autoregressive {
    const BASELINE: Baseline = Baseline::Autoregressive;

    fn new(rate_hz: f64, delay_ticks: usize) -> Self {
        let max = (MAX_DELAY_S * rate_hz).ceil() as usize;
        let mut autoregressive = Self {
            delay_ticks,
            spacing: 1,
            every: ((rate_hz / SOLVE_HZ).round() as usize).max(1),
            tick: 0,
            past: DelayLine::new(max + TAPS * spacing(max), Lanes::ZERO),
            rls: Rls::new(MEMORY_S, RIDGE_S, rate_hz),
            envelope: Envelope::new(rate_hz),
            coefficients: reflection(),
        };
        autoregressive.set_delay(delay_ticks);
        autoregressive
    }

    /// Predicts over another delay from now on, and discards the model of the old delay.
    fn set_delay(&mut self, delay_ticks: usize) {
        self.delay_ticks = delay_ticks;
        self.spacing = spacing(delay_ticks);
        self.rls.reset();
        self.coefficients = reflection();
    }

    fn step(&mut self, _motion: &Motion, force_n: Option<Lanes>) -> BaselineModel {
        let Some(newest) = force_n.or_else(|| self.past.get(0).copied()) else { return BaselineModel::Nothing };
        self.past.push(newest);
        self.envelope.see(newest, 1.0);
        if let (Some(force_n), Some(then)) = (force_n, self.columns(self.delay_ticks)) {
            self.rls.learn(&then, force_n);
        }
        if self.tick.is_multiple_of(self.every) {
            let found = self.rls.solve(&reflection());
            if found.iter().all(|coefficient| coefficient.is_finite()) {
                self.coefficients = found;
            }
        }
        self.tick = self.tick.wrapping_add(1);
        // Until there are as many forces as taps, the prediction is the newest force.
        let foretold = self.columns(0).map_or(newest, |now| dot(&self.coefficients, &now));
        let [low, high] = self.envelope.bounds_n();
        BaselineModel::Forecast { force_n: foretold.within(low, high) }
    }

    fn reset(&mut self) {
        self.tick = 0;
        self.past.clear();
        self.rls.reset();
        self.envelope.reset();
        self.coefficients = reflection();
    }
}

/// Returns the number of ticks between two taps for a delay.
const fn spacing(delay_ticks: usize) -> usize {
    let spacing = delay_ticks / SPACINGS;
    if spacing == 0 { 1 } else { spacing }
}

const fn reflection() -> [Lanes; COLUMNS] {
    let mut coefficients = [Lanes::ZERO; COLUMNS];
    coefficients[1] = Lanes::splat(1.0);
    coefficients
}
