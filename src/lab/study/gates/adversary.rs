//! An endless, reproducible sequence of requests that no real mode would make.

use fastrand::Rng;
use nalgebra::SVector;
use nima_core::safety::{ChainSettings, EnergyMode, ForceRequest};

/// Course of the requested force for a while.
#[derive(Clone, Copy, Debug)]
enum Pattern {
    NotANumber,
    Infinite,
    Huge,
    AtTheLimit,
    Missing,
    Alternating,
    Creep,
    Noise,
    Tiny,
    Honest,
}

const PATTERNS: [Pattern; 10] = [
    Pattern::NotANumber,
    Pattern::Infinite,
    Pattern::Huge,
    Pattern::AtTheLimit,
    Pattern::Missing,
    Pattern::Alternating,
    Pattern::Creep,
    Pattern::Noise,
    Pattern::Tiny,
    Pattern::Honest,
];

/// A change to a chain by an operator or a faulty screen.
#[derive(Clone, Copy, Debug)]
pub(super) enum ChainChange {
    Nothing,
    OrdinaryGain(f64),
    GainAboveOne(f64),
    DeadBand(f64),
    StaticHold(bool),
    Reset,
}

#[derive(Debug)]
pub(super) struct Adversary<'a, const D: usize> {
    rng: &'a mut Rng,
    t_s: f64,
    pattern: Pattern,
    left: u32,
    force_n: SVector<f64, D>,
    hand_m: SVector<f64, D>,
    running: bool,
    permitted: bool,
}

/// Returns random settings, most of them valid, some invalid.
pub(super) fn settings(rng: &mut Rng) -> ChainSettings {
    let fade_after_s = 0.02 * rng.f64();
    ChainSettings {
        gain: odd(rng, 3.0),
        gain_rate_per_s: 10.0 * rng.f64(),
        ceiling_n: [0.0, 0.5, 4.0, 12.0, odd(rng, 12.0)][rng.usize(..5)],
        device_limit_n: [0.4, 8.0, 12.0, odd(rng, 12.0)][rng.usize(..4)],
        slew_n_per_s: [1.0, 50.0, 500.0, 1e4][rng.usize(..4)],
        fade_after_s,
        zero_after_s: fade_after_s + 0.05 * rng.f64(),
        dead_band_m_s: [0.0, 1e-3, odd(rng, 0.1)][rng.usize(..3)],
        static_hold: rng.bool(),
        handle_kg: [0.0, 0.25, 0.25, odd(rng, 1.0)][rng.usize(..4)],
        handle_n_s_m: odd(rng, 5.0),
        handle_step_m: odd(rng, 2e-5),
        brake_n_s_m: odd(rng, 60.0),
        energy: EnergyMode::ALL[rng.usize(..EnergyMode::ALL.len())],
    }
}

/// Usually returns a number from 0 to `max`; sometimes one outside that range, or NaN.
fn odd(rng: &mut Rng, max: f64) -> f64 {
    match rng.u32(..16) {
        0 => f64::NAN,
        1 => f64::INFINITY,
        2 => -max,
        3 => 1e18,
        _ => max * rng.f64(),
    }
}

impl<'a, const D: usize> Adversary<'a, D> {
    pub(super) fn new(rng: &'a mut Rng) -> Self {
        let zeros = SVector::zeros();
        Self {
            rng,
            t_s: 0.0,
            pattern: Pattern::Honest,
            left: 0,
            force_n: zeros,
            hand_m: zeros,
            running: false,
            permitted: true,
        }
    }

    fn vector(&mut self, size: f64) -> SVector<f64, D> {
        SVector::from_fn(|_, _| size * (2.0 * self.rng.f64() - 1.0))
    }

    /// Returns a vector with this value on at least one axis.
    fn poisoned(&mut self, value: f64) -> SVector<f64, D> {
        let mut vector = self.vector(4.0);
        vector[self.rng.usize(..D)] = if self.rng.bool() { value } else { -value };
        vector
    }

    fn force(&mut self) -> Option<SVector<f64, D>> {
        if self.left == 0 {
            self.pattern = PATTERNS[self.rng.usize(..PATTERNS.len())];
            self.left = self.rng.u32(1..60);
            self.force_n = self.vector(8.0);
            self.running = self.rng.u32(..4) == 0;
        }
        self.left -= 1;
        Some(match self.pattern {
            Pattern::NotANumber => self.poisoned(f64::NAN),
            Pattern::Infinite => self.poisoned(f64::INFINITY),
            Pattern::Huge => self.poisoned(1e18),
            Pattern::AtTheLimit => self.poisoned(1e3),
            Pattern::Missing => return None,
            Pattern::Alternating => {
                self.force_n = -self.force_n;
                self.force_n
            }
            Pattern::Creep => {
                let creep_n = self.vector(0.1).map(f64::abs);
                self.force_n += creep_n;
                self.force_n
            }
            Pattern::Noise => self.vector(20.0),
            Pattern::Tiny => self.poisoned(f64::MIN_POSITIVE),
            Pattern::Honest => self.force_n,
        })
    }

    fn hand(&mut self) -> Option<SVector<f64, D>> {
        // A hand that moves with the force takes energy from the device all the time.
        let along = if self.running { self.force_n / self.force_n.norm().max(1e-9) } else { SVector::zeros() };
        let travel_m = self.vector(1e-4) + along * 2e-4;
        self.hand_m += travel_m;
        match self.rng.u32(..64) {
            0 => None,
            1 => Some(self.poisoned(f64::NAN)),
            2 => Some(self.poisoned(f64::MAX)),
            3 => Some(self.vector(1.0)),
            _ => Some(self.hand_m),
        }
    }

    pub(super) fn request(&mut self) -> ForceRequest<D> {
        if self.rng.u32(..if self.permitted { 200 } else { 20 }) == 0 {
            self.permitted = !self.permitted;
        }
        // Late, early, repeated and backward times; a clock that jumps far.
        self.t_s += match self.rng.u32(..32) {
            0 => odd(self.rng, 0.05),
            1 => -self.rng.f64() * 1e-3,
            2 => 0.0,
            3..12 => self.rng.f64() * 5e-3,
            _ => 1e-3,
        };
        if !self.t_s.is_finite() {
            self.t_s = 0.0;
        }
        ForceRequest {
            t_s: self.t_s,
            force_n: self.force(),
            age_s: if self.rng.u32(..4) == 0 { odd(self.rng, 0.05) } else { 0.0 },
            speed_m_s: odd(self.rng, 0.01),
            hand_m: self.hand(),
            hand_age_s: if self.rng.u32(..8) == 0 { odd(self.rng, 0.01) } else { 0.0 },
            permitted: self.permitted,
        }
    }

    /// Returns a change to the chain before the next request.
    pub(super) fn meddling(&mut self) -> ChainChange {
        match self.rng.u32(..100) {
            0 => ChainChange::OrdinaryGain(odd(self.rng, 3.0)),
            1 => ChainChange::GainAboveOne(odd(self.rng, 3.0)),
            2 => ChainChange::DeadBand(odd(self.rng, 0.1)),
            3 => ChainChange::StaticHold(self.rng.bool()),
            4 => ChainChange::Reset,
            _ => ChainChange::Nothing,
        }
    }
}
