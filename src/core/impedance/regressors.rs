//! The quantities that explain a change of force over the delay.

use super::settings::ImpedanceSettings;
use crate::signal::{BANK, LANES, Lanes, LowPassBank};

/// Shortest and longest time constants of the filter bank (s). Chosen as in `anchored.rs`.
/// The four time constants are a factor of 4 apart: 5, 20, 80 and 320 ms.
const BANK_S: [f64; 2] = [0.005, 0.32];
/// Memory of the slow means: the motion's centre, the force's level, the size of the speed (s). Longer than
/// the longest delay (1 s), so that the level at the anchor still describes the contact when the packet is rendered.
const SLOW_S: f64 = 2.0;
/// Quantities that only the follower has are limited to this many times their running RMS, so that an unprecedented
/// jump is not extrapolated.
const USUAL: f64 = 6.0;

pub(super) const REGRESSORS: usize = 22;
/// Length of the shorter model: the first regressors, linear in the motion.
pub(super) const LINEAR_REGRESSORS: usize = 12;

/// Index of the first regressor of each group.
pub(super) mod at {
    /// Change of position, followed by the changes of its four differences from the low-passes.
    pub(in super::super) const MOTION: usize = 0;
    /// Force minus its low-passes at the anchor.
    pub(in super::super) const FORCE_TREND: usize = 5;
    /// Change of position times the force at the anchor: stiffness that grows with load (zero in free motion).
    pub(in super::super) const LOADED_POSITION: usize = 9;
    /// Change of the second difference times the force at the anchor.
    pub(in super::super) const LOADED_SPEED: usize = 10;
    /// Change of the saturated second difference: dry friction.
    pub(in super::super) const FRICTION: usize = 11;
    /// Change of square, cube, and product with the second difference, of the position about its centre.
    pub(in super::super) const CURVATURE: usize = 12;
    /// Position minus its centre at the anchor.
    pub(in super::super) const POSITION_LEVEL: usize = 15;
    /// Force minus its level at the anchor, followed by a steady drift.
    pub(in super::super) const FORCE_LEVEL: usize = 16;
    /// The motion's differences from the low-passes at the anchor.
    pub(in super::super) const MOTION_TREND: usize = 18;
}

pub(super) type Regressors = [Lanes; REGRESSORS];

/// Position and its differences from the low-pass bank; the follower uses its tip, the leader its own motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct MotionState {
    pub(super) x: Lanes,
    pub(super) u: [Lanes; BANK],
    /// Difference of the first difference from its own low-pass: acceleration.
    pub(super) surge: Lanes,
    /// Motion at which dry friction saturates, and the pace of time, by this end's [`MotionClock`](super::motion_clock::MotionClock).
    pub(super) knee: Lanes,
    pub(super) pace: f64,
}

impl MotionState {
    pub(super) const BLANK: Self =
        Self { x: Lanes::ZERO, u: [Lanes::ZERO; BANK], surge: Lanes::ZERO, knee: Lanes::ZERO, pace: 0.0 };
}

/// The follower's data at the anchor, apart from the motion.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Background {
    pub(super) force_n: Lanes,
    force_trend: [Lanes; BANK],
    pub(super) centre: Lanes,
    /// Half of the mean size of the second difference: where friction saturates.
    pub(super) knee: Lanes,
    position_level: Lanes,
    force_level: Lanes,
    motion_trend: [Lanes; BANK],
}

/// Creates the filter bank for positions, identical at both ends of the link.
pub(super) fn position_bank(settings: &ImpedanceSettings) -> LowPassBank {
    LowPassBank::new(BANK_S[0], BANK_S[1], settings.rate_hz)
}

/// Returns the fraction of a change that the low-pass with the bank's shortest time constant follows in one sample.
pub(super) fn shortest_fraction(settings: &ImpedanceSettings) -> f64 {
    // `expm1`, because `1 - exp(x)` loses digits for the small `x` of a high rate.
    // A loop slower than the time constant follows at most 63 %.
    -libm::expm1(-1.0 / (BANK_S[0] * settings.rate_hz).max(1.0))
}

/// Returns `u / (|u| + knee)`: the sign of the motion, smoothed.
#[inline]
pub(super) fn saturated(u: Lanes, knee: Lanes) -> Lanes {
    // Smooth instead of a sign function, because the noise of a hand at rest would switch a sign in every sample.
    let size = u.map(f64::abs) + knee;
    // Where neither moves nor has moved, 0 / 0 becomes 0.
    u * size.recip_or_zero()
}

/// Returns the changes from `then` to `now` that depend only on the motion, in the order
/// [position, four differences, friction, square, cube, product].
#[inline]
pub(super) fn motion_changes(now: &MotionState, then: &MotionState, centre: Lanes, knee: Lanes) -> [Lanes; 9] {
    // About the slow centre: powers of a position far from zero would hide its changes in rounding.
    let a = now.x - centre;
    let b = then.x - centre;
    let [u0, u1, u2, u3] = std::array::from_fn(|j| now.u[j] - then.u[j]);
    [
        now.x - then.x,
        u0,
        u1,
        u2,
        u3,
        saturated(now.u[1], knee) - saturated(then.u[1], knee),
        a * a - b * b,
        a * a * a - b * b * b,
        a * now.u[1] - b * then.u[1],
    ]
}

impl Background {
    /// Returns the regressors for the motion `now`, anchored at `then` with this background.
    pub(super) fn regressors(&self, now: &MotionState, then: &MotionState) -> Regressors {
        let [dx, u0, u1, u2, u3, friction, square, cube, product] = motion_changes(now, then, self.centre, self.knee);
        let [g0, g1, g2, g3] = self.force_trend;
        let [m0, m1, m2, m3] = self.motion_trend;
        let position = self.position_level;
        let force = self.force_level;
        // The fourth lane is padding and must stay zero, because sums over all lanes enter the errors.
        let drift = Lanes([1.0, 1.0, 1.0, 0.0]);
        let stiffening = self.force_n * dx;
        let damping = self.force_n * u1;
        [
            dx, u0, u1, u2, u3, g0, g1, g2, g3, stiffening, damping, friction, square, cube, product, position, force,
            drift, m0, m1, m2, m3,
        ]
    }
}

/// Computes [`Background`]s from the follower's motion and force.
#[derive(Clone, Debug)]
pub(super) struct BackgroundBuilder {
    force_bank: LowPassBank,
    fraction: f64,
    centre: Lanes,
    force_level: Lanes,
    speed: Lanes,
    started: bool,
}

impl BackgroundBuilder {
    pub(super) fn new(settings: &ImpedanceSettings) -> Self {
        Self {
            // The same bank as for the motion, so that both trends have the same lags.
            force_bank: LowPassBank::new(BANK_S[0], BANK_S[1], settings.rate_hz),
            fraction: -libm::expm1(-1.0 / (SLOW_S * settings.rate_hz)),
            centre: Lanes::ZERO,
            force_level: Lanes::ZERO,
            speed: Lanes::ZERO,
            started: false,
        }
    }

    /// Returns the background of this tick. `usual`: mean squares of the regressors so far, `None` while there are too
    /// few samples.
    pub(super) fn step(&mut self, stance: &MotionState, force_n: Lanes, usual: Option<&Regressors>) -> Background {
        // Starting the means at zero would look like a large force and motion for the first seconds.
        if !self.started {
            self.centre = stance.x;
            self.force_level = force_n;
            self.speed = Lanes::ZERO;
            self.started = true;
        }
        let follow = |mean: Lanes, value: Lanes| (mean + (value - mean) * self.fraction).settled();
        self.centre = follow(self.centre, stance.x);
        self.force_level = follow(self.force_level, force_n);
        self.speed = follow(self.speed, stance.u[1].map(f64::abs));
        let bounded = |value: Lanes, index: usize| {
            usual.map_or(value, |squares| {
                let limit = squares[index].sqrt() * USUAL;
                value.zip(limit, |value, limit| value.min(limit).max(-limit))
            })
        };
        let force_trend = self.force_bank.step(force_n);
        Background {
            force_n,
            force_trend: std::array::from_fn(|j| bounded(force_trend[j], at::FORCE_TREND + j)),
            centre: self.centre,
            // Half the mean size, like `MotionClock::knee_m`.
            knee: self.speed * 0.5,
            position_level: bounded(stance.x - self.centre, at::POSITION_LEVEL),
            force_level: bounded(force_n - self.force_level, at::FORCE_LEVEL),
            motion_trend: std::array::from_fn(|j| bounded(stance.u[j], at::MOTION_TREND + j)),
        }
    }

    pub(super) fn reset(&mut self) {
        self.force_bank.reset();
        self.started = false;
    }
}

const _: () = assert!(at::MOTION_TREND + BANK == REGRESSORS && LANES == 4);
