//! Recursive least squares of the increments over the delay, with the trend of the force: `f(t) = f(t - D) + K dx + B dv +
//! M da + sum_j c_j (f(t - D) - f(t - D - s_j))`, where `dx`, `dv` and `da` are the changes of the motion since `t - D`.
//!
//! Increments remove the unknown rest position of a spring and the offset of a sensor. The follower sends the parameters
//! with the sum over the trend, which it alone knows, and the leader adds its own motion.

use nima_core::{
    impedance::{Baseline, BaselineModel, Envelope, ForceIncrements, MAX_DELAY_S},
    signal::{DelayLine, Lanes, Motion},
};

use crate::{
    BaselineSender,
    rls::{Rls, dot},
};

/// Times over which the trend of the force is taken (s), memory (s) and ridge (s) of the regression (chosen on recordings,
/// see docs/modes.md).
const TRENDS_S: [f64; 4] = [0.002, 0.005, 0.02, 0.08];
const MEMORY_S: f64 = 3.0;
const RIDGE_S: f64 = 0.03;
/// Number of solutions per second (at most one per tick), because the parameters hardly change within 5 ms.
const SOLVE_HZ: f64 = 200.0;

/// Stiffness, damping and mass, then one column for each trend.
const MOTIONS: usize = 3;
const COLUMNS: usize = MOTIONS + TRENDS_S.len();

/// Returns the force (N) at the leader, from the measured force in the packet and the leader's motion then and now.
pub(crate) fn force(increments: &ForceIncrements, measured_n: Lanes, then: &Motion, now: &Motion) -> Lanes {
    let force_n = measured_n + increments.trend_n + dot(&increments.parameters, &changes(then, now));
    let [low, high] = increments.bounds_n;
    // Clamping would turn NaN into one of the limits.
    if force_n.is_finite() { force_n.within(low, high) } else { force_n }
}

fn changes(then: &Motion, now: &Motion) -> [Lanes; MOTIONS] {
    [now.x - then.x, now.v - then.v, now.a - then.a]
}

#[derive(Clone, Debug)]
pub(crate) struct Increments {
    delay_ticks: usize,
    lags: [usize; TRENDS_S.len()],
    every: usize,
    tick: usize,
    past: DelayLine<(Motion, Lanes)>,
    rls: Rls<COLUMNS>,
    envelope: Envelope,
    parameters: [Lanes; COLUMNS],
}

impl Increments {
    /// Returns the trends of the force as they were `ago` ticks ago.
    fn trends(&self, ago: usize) -> Option<[Lanes; TRENDS_S.len()]> {
        let (_, force_n) = *self.past.get(ago)?;
        let mut trends = [Lanes::ZERO; TRENDS_S.len()];
        for (trend, lag) in trends.iter_mut().zip(self.lags) {
            let (_, earlier_n) = *self.past.get(ago + lag)?;
            *trend = force_n - earlier_n;
        }
        Some(trends)
    }

    fn learn(&mut self, motion: &Motion, force_n: Lanes) {
        let Some((then, then_n)) = self.past.get(self.delay_ticks) else { return };
        let Some(trends) = self.trends(self.delay_ticks) else { return };
        let mut columns = [Lanes::ZERO; COLUMNS];
        columns[..MOTIONS].copy_from_slice(&changes(then, motion));
        columns[MOTIONS..].copy_from_slice(&trends);
        self.rls.learn(&columns, force_n - *then_n);
    }
}

impl BaselineSender for Increments {
    const BASELINE: Baseline = Baseline::Increments;

    fn new(rate_hz: f64, delay_ticks: usize) -> Self {
        let lags = TRENDS_S.map(|trend_s| ((trend_s * rate_hz).round() as usize).max(1));
        let max = (MAX_DELAY_S * rate_hz).ceil() as usize + lags.into_iter().max().unwrap_or(1);
        let still = Motion { x: Lanes::ZERO, v: Lanes::ZERO, a: Lanes::ZERO };
        Self {
            delay_ticks,
            lags,
            every: ((rate_hz / SOLVE_HZ).round() as usize).max(1),
            tick: 0,
            past: DelayLine::new(max, (still, Lanes::ZERO)),
            rls: Rls::new(MEMORY_S, RIDGE_S, rate_hz),
            envelope: Envelope::new(rate_hz),
            parameters: [Lanes::ZERO; COLUMNS],
        }
    }

    /// Predicts over another delay from now on, and discards the model of the old delay.
    fn set_delay(&mut self, delay_ticks: usize) {
        self.delay_ticks = delay_ticks;
        self.rls.reset();
        self.parameters = [Lanes::ZERO; COLUMNS];
    }

    fn step(&mut self, motion: &Motion, force_n: Option<Lanes>) -> BaselineModel {
        let newest = force_n.or_else(|| self.past.get(0).map(|(_, force_n)| *force_n));
        let Some(newest) = newest else { return BaselineModel::Nothing };
        self.past.push((*motion, newest));
        self.envelope.see(newest, 1.0);
        if let Some(force_n) = force_n {
            self.learn(motion, force_n);
        }
        if self.tick.is_multiple_of(self.every) {
            // Without knowledge there is no correction: the delayed force.
            let found = self.rls.solve(&[Lanes::ZERO; COLUMNS]);
            if found.iter().all(|parameter| parameter.is_finite()) {
                self.parameters = found;
            }
        }
        self.tick = self.tick.wrapping_add(1);
        let [stiffness, damping, mass, of_trends @ ..] = self.parameters;
        BaselineModel::Increments(ForceIncrements {
            parameters: [stiffness, damping, mass],
            trend_n: self.trends(0).map_or(Lanes::ZERO, |trends| dot(&of_trends, &trends)),
            bounds_n: self.envelope.bounds_n(),
        })
    }

    fn reset(&mut self) {
        self.tick = 0;
        self.past.clear();
        self.rls.reset();
        self.envelope.reset();
        self.parameters = [Lanes::ZERO; COLUMNS];
    }
}
