//! The motion at one end of the link: derivatives, increments over the window, and a bridge over missing samples.

use super::{
    features::{ImpedanceFeatures, Scales, features},
    messages::Posture,
    motion_clock::MotionClock,
    recipe::IncrementReading,
    regressors::{MotionState, position_bank, shortest_fraction},
    settings::ImpedanceSettings,
};
use crate::signal::{DelayLine, Differentiator, Lanes, LowPassBank, Motion, settled};

/// Maximum time (s) for which a missing position is extrapolated at the last speed; after that, the position is held.
/// Design choice.
/// At 0.2 m/s, the position of a hand that stops at once is then 2 mm off.
const BRIDGE_S: f64 = 0.01;

/// Samples that refill a differentiator after a gap, per sample of the bridge: its window is 20 ms or five samples.
const REFILL: usize = 3;

/// A step of more than this many times the largest recent one may be a glitch: the position is used only once the next
/// one confirms it. Design choice; a hand that starts within one sample loses only that sample.
const DOUBTED: f64 = 20.0;
/// Number of known steps before one is doubted.
const KNOWN_STEPS: u32 = 50;
/// Memory of the largest step (s).
const STEP_S: f64 = 20.0;

/// A position or a force of more than this many scales is implausible (1 km, 40 kN with the default scales) and is not
/// raised to powers.
/// The fifth power of such a position, squared in the sums, is 1e40: far from an overflow.
const ABSURD: f64 = 1e4;

/// Computes [`Motion`] from positions and stores it over one window.
#[derive(Clone, Debug)]
pub(super) struct MotionTrack {
    differentiator: Differentiator,
    bank: LowPassBank,
    speed_m: Lanes,
    clock: MotionClock,
    speed_fraction: f64,
    scales: Scales,
    reading: IncrementReading,
    degree: usize,
    posture: Posture,
    history: DelayLine<Motion>,
    last: Motion,
    period_s: f64,
    bridge_ticks: usize,
    missing: usize,
    /// `None` in the replay of a session that was recorded without it.
    glitches: Option<GlitchFilter>,
}

/// Rejects a position that is far from the last one, until the next one confirms it.
#[derive(Clone, Debug)]
struct GlitchFilter {
    fade: f64,
    last_m: Option<Lanes>,
    doubted_m: Option<Lanes>,
    largest_m: f64,
    steps: u32,
}

impl GlitchFilter {
    fn new(rate_hz: f64) -> Self {
        Self { fade: 1.0 - (STEP_S * rate_hz).recip(), last_m: None, doubted_m: None, largest_m: 0.0, steps: 0 }
    }

    /// Returns the position if it can be used. `ticks`: since the last used one.
    fn step(&mut self, position_m: Lanes, ticks: usize) -> Option<Lanes> {
        let step_m = self.last_m.map_or(0.0, |last_m| (position_m - last_m).norm()) / ticks as f64;
        self.steps = self.steps.saturating_add(1);
        let usual = self.steps <= KNOWN_STEPS || step_m <= DOUBTED * self.largest_m || self.largest_m <= 0.0;
        let doubted_m = self.doubted_m.take();
        let seen_m = match doubted_m {
            _ if usual => step_m,
            // The second sample shows how fast this motion is, and confirms the first one.
            Some(doubted_m) => (position_m - doubted_m).norm(),
            None => {
                self.doubted_m = Some(position_m);
                return None;
            }
        };
        self.largest_m = settled(self.largest_m * self.fade).max(seen_m);
        self.last_m = Some(position_m);
        Some(position_m)
    }

    fn reset(&mut self) {
        *self = Self { last_m: None, doubted_m: None, largest_m: 0.0, steps: 0, ..*self };
    }
}

impl MotionTrack {
    pub(super) fn new(settings: &ImpedanceSettings) -> Self {
        Self {
            differentiator: Differentiator::new(settings.differentiator, settings.rate_hz),
            bank: position_bank(settings),
            speed_m: Lanes::ZERO,
            clock: MotionClock::new(settings.rate_hz),
            speed_fraction: shortest_fraction(settings),
            scales: settings.scales,
            reading: settings.literal.reading,
            degree: settings.max_degree,
            posture: Posture::BLANK,
            // A window is two blocks long; the increments reach back over all of it.
            history: DelayLine::new(2 * settings.block(), Motion::default()),
            last: Motion::default(),
            period_s: settings.rate_hz.recip(),
            // Rounded up: a gap of exactly this length is still bridged.
            bridge_ticks: (BRIDGE_S * settings.rate_hz).ceil() as usize,
            missing: 0,
            glitches: (!settings.earlier_forces).then(|| GlitchFilter::new(settings.rate_hz)),
        }
    }

    /// Adds this tick's position. If it is missing (`None`) or may be a glitch, the last position continues at its speed for
    /// at most 10 ms and is held after that. Before the first good position the motion is zero.
    pub(super) fn step(&mut self, position: Option<Lanes>) -> Posture {
        let since = self.missing + 1;
        let believed = match &mut self.glitches {
            Some(glitches) => position.and_then(|position| glitches.step(position, since)),
            None => position,
        };
        let position = if let Some(position) = believed {
            if self.missing > self.bridge_ticks && self.glitches.is_some() {
                self.glide(position);
            }
            self.missing = 0;
            position
        } else if self.history.is_empty() {
            // Nothing is known yet, and zero motion gives no force.
            return self.posture;
        } else {
            self.missing += 1;
            // A short gap is bridged with the speed, because a stop would look like an impact to the second derivative.
            let moving = self.missing <= self.bridge_ticks;
            if moving { self.last.x + self.last.v * self.period_s } else { self.last.x }
        };
        self.last = self.differentiator.step(position);
        self.history.push(self.last);
        let u = self.bank.step(position);
        // The low-pass of the first difference; its difference in turn is the acceleration.
        self.speed_m = (self.speed_m + (u[0] - self.speed_m) * self.speed_fraction).settled();
        self.clock.step(u[1]);
        self.posture = Posture {
            features: self.scales.features(&self.last, self.degree),
            stance: MotionState {
                x: position,
                u,
                surge: u[0] - self.speed_m,
                knee: self.clock.knee_m(),
                pace: self.clock.pace(),
            },
        };
        self.posture
    }

    /// Returns whether the position of this tick was not used.
    pub(super) const fn is_bridged(&self) -> bool {
        self.missing > 0
    }

    /// Ends a long gap as if the position had moved evenly to the new one: a jump would look like an impact.
    fn glide(&mut self, position: Lanes) {
        let held_ticks = self.missing - self.bridge_ticks;
        let change = position - self.last.x;
        self.bank.glide(change, held_ticks);
        let slope = change * (held_ticks as f64 + 1.0).recip();
        self.differentiator.reset();
        for k in (1..REFILL * self.bridge_ticks.max(2)).rev() {
            self.last = self.differentiator.step(position - slope * k as f64);
        }
    }

    /// Returns the paper's features `X` (SI units) of `u`: the changes of position, velocity and acceleration over the
    /// window (over the time since the first sample, while that is shorter), or their values.
    pub(super) fn paper_x(&self) -> ImpedanceFeatures {
        if self.reading == IncrementReading::Displacement {
            return features(&self.last, self.degree);
        }
        let window = self.history.max_delay();
        // Until the window is full, since the first sample: the increments then start at zero.
        let then = self.history.get_or_oldest(window).copied().unwrap_or_default();
        let u = Motion { x: self.last.x - then.x, v: self.last.v - then.v, a: self.last.a - then.a };
        features(&u, self.degree)
    }

    /// Returns whether the derivatives come from a full filter.
    pub(super) fn settled(&self) -> bool {
        self.differentiator.settled()
    }

    pub(super) fn reset(&mut self) {
        self.differentiator.reset();
        self.bank.reset();
        self.speed_m = Lanes::ZERO;
        self.clock.reset();
        self.posture = Posture::BLANK;
        self.history.clear();
        self.last = Motion::default();
        self.missing = 0;
        self.glitches.iter_mut().for_each(GlitchFilter::reset);
    }
}

/// Returns the position if it is usable: finite and not absurd.
pub(super) fn usable_position(position: Lanes, scales: &Scales) -> Option<Lanes> {
    let limit = ABSURD * scales.position_m;
    // NaN fails this comparison, too, so it needs no separate test.
    position.0.iter().all(|x| x.abs() <= limit).then_some(position)
}

/// Returns the force if it is usable: finite and not absurd.
pub(super) fn usable_force(force: Lanes, scales: &Scales) -> Option<Lanes> {
    let limit = ABSURD * scales.force_n;
    force.0.iter().all(|f| f.abs() <= limit).then_some(force)
}
