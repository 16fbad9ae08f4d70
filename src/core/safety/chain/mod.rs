//! The gates in their fixed order: permission, validity, age, dead band, gain, slew, energy, ceiling, governor.
//!
//! The same gates, with the required number of axes, serve a force in space, a torque and a gripper force: one chain
//! each.

mod age;
mod ceiling;
mod dead_band;
mod energy;
mod gain;
mod slew;
#[cfg(test)]
mod tests;
mod validity;

use nalgebra::SVector;

pub use age::AgeGate;
pub use ceiling::Ceiling;
pub use dead_band::DeadBand;
pub use energy::{ALLOWANCE_J, Energy, LEAK_S, MAX_J};
pub use gain::Gain;
pub use slew::Slew;
pub use validity::{PLAUSIBLE_N, admitted};

use super::{ChainSettings, EnergyMode, Gate, GateCounts, GateReport, Governor, GovernorReading, Reason};
use crate::limits::DEAD_BAND_M_S;

/// A force that is to reach the hand. [`ForceRequest::default`] is not permitted.
#[derive(Clone, Copy, Debug)]
pub struct ForceRequest<const D: usize = 3> {
    pub t_s: f64,
    /// The force that a mode requests, N; `None` if the mode has no valid force.
    pub force_n: Option<SVector<f64, D>>,
    /// Age of the newest data beyond the link's own delay, s.
    pub age_s: f64,
    pub speed_m_s: f64,
    /// Position of the handle, m, on the axes of the force, as the device reports it (not scaled); `None` if unknown:
    /// the energy gate then assumes no motion. A position instead of a velocity, because force times travel is exactly
    /// the energy.
    pub hand_m: Option<SVector<f64, D>>,
    /// Age of the handle's reading at `t_s`, s.
    pub hand_age_s: f64,
    /// Whether the state machine permits force at all.
    pub permitted: bool,
}

impl<const D: usize> Default for ForceRequest<D> {
    fn default() -> Self {
        Self {
            t_s: 0.0,
            // Unknown counts as too old; the other defaults also give no force.
            force_n: None,
            age_s: f64::INFINITY,
            speed_m_s: 0.0,
            hand_m: None,
            hand_age_s: 0.0,
            permitted: false,
        }
    }
}

/// The chain and its state (gain ramp, last force, dead band, energy, counters).
#[derive(Clone, Debug)]
pub struct SafetyChain<const D: usize = 3> {
    settings: ChainSettings,
    period_s: f64,
    age: AgeGate,
    dead_band: DeadBand,
    gain: Gain,
    slew: Slew<D>,
    energy: Energy<D>,
    ceiling: Ceiling,
    governor: Governor<D>,
    last_s: Option<f64>,
    /// The last force that reached the hand, N. The slew limit stores its own last force, before the governor.
    applied_n: SVector<f64, D>,
    counts: GateCounts,
}

pub type GripperChain = SafetyChain<1>;
pub type TorqueChain = SafetyChain<3>;

impl<const D: usize> SafetyChain<D> {
    /// Creates a chain for a loop of this nominal period (s). Settings outside their ranges are clamped, the gain to at
    /// most 1.
    pub fn new(settings: ChainSettings, period_s: f64) -> Self {
        let mut settings = settings.pulled_in();
        let gain = Gain::new(settings.gain, settings.gain_rate_per_s);
        // The clamped value, so that the report never shows a gain that is not applied.
        settings.gain = gain.chosen();
        Self {
            settings,
            period_s,
            age: AgeGate::new(settings.fade_after_s, settings.zero_after_s),
            dead_band: DeadBand::new(settings.dead_band_m_s),
            gain,
            slew: Slew::new(settings.slew_n_per_s, period_s),
            energy: Energy::new(settings.energy),
            ceiling: Ceiling::new(settings.ceiling_n, settings.device_limit_n),
            // With the same slew limit as the gate before it, because it changes the force after that gate.
            governor: Governor::new(settings.handle(), settings.slew_n_per_s, period_s),
            last_s: None,
            applied_n: SVector::zeros(),
            counts: GateCounts::default(),
        }
    }

    pub const fn settings(&self) -> &ChainSettings {
        &self.settings
    }

    pub const fn counts(&self) -> &GateCounts {
        &self.counts
    }

    /// Returns the maximum force that the chain can pass, N.
    pub const fn max_n(&self) -> f64 {
        self.ceiling.max_n()
    }

    /// Sets the gain to ramp to, 0 to 1. A larger gain is clamped to 1, unless [`SafetyChain::set_gain_above_one`] was called
    /// since the last gain of 1 or less. NaN is ignored.
    pub const fn set_ordinary_gain(&mut self, gain: f64) {
        self.gain.choose(gain);
        self.settings.gain = self.gain.chosen();
    }

    /// Sets a gain within [`GAIN_ABOVE_ONE`](crate::limits::GAIN_ABOVE_ONE): the operator's second, deliberate action.
    /// NaN is ignored.
    pub const fn set_gain_above_one(&mut self, gain: f64) {
        self.gain.choose_above_one(gain);
        self.settings.gain = self.gain.chosen();
    }

    /// Sets the dead band, m/s, clamped to 0 to 0.1; NaN is ignored.
    pub fn set_dead_band(&mut self, threshold_m_s: f64) {
        // Keep the current value: a default instead of NaN would be a surprise while engaged.
        if !threshold_m_s.is_nan() {
            self.settings.dead_band_m_s = threshold_m_s.clamp(DEAD_BAND_M_S.min, DEAD_BAND_M_S.max);
            self.dead_band.threshold_m_s = self.settings.dead_band_m_s;
        }
    }

    /// Keeps the force at standstill (true) or fades it in the dead band (false).
    pub const fn set_static_hold(&mut self, hold: bool) {
        self.settings.static_hold = hold;
    }

    /// Switches the governor off or on. Off is for simulated handles only.
    pub fn set_governor(&mut self, on: bool) {
        self.settings.handle_kg = if on { self.governor.handle().mass_kg } else { 0.0 };
        self.governor.watch(on);
    }

    /// Resets the last force, so that the next force starts from zero, and the hand's motion; a hand is assumed to hold
    /// the handle.
    pub fn reset(&mut self) {
        self.slew.left(SVector::zeros());
        self.energy.reset();
        self.governor.reset();
        self.applied_n = SVector::zeros();
    }

    /// Sends one request through all gates; returns the force for the hand (N) and the action of each gate. Call once
    /// per tick.
    ///
    /// ```
    /// use nalgebra::Vector3;
    /// use nima_core::safety::{SafetyChain, ChainSettings, Gate, Reason, ForceRequest};
    ///
    /// let settings = ChainSettings { ceiling_n: 2.0, ..ChainSettings::default() };
    /// let mut chain = SafetyChain::new(settings, 1e-3);
    /// let mut request = ForceRequest {
    ///     t_s: 0.0,
    ///     force_n: Some(Vector3::new(0.0, 0.0, 50.0)),
    ///     age_s: 0.0,
    ///     speed_m_s: 0.1,
    ///     permitted: true,
    ///     ..ForceRequest::default()
    /// };
    /// for _ in 0..1000 {
    ///     request.t_s += 1e-3;
    ///     let (force_n, _) = chain.step(&request);
    ///     assert!(force_n.norm() <= 2.0 + 1e-9, "the ceiling holds");
    /// }
    ///
    /// // NaN closes the chain and names the gate.
    /// request.force_n = Some(Vector3::new(f64::NAN, 0.0, 0.0));
    /// let (_, report) = chain.step(&request);
    /// assert_eq!(report.first().map(|(gate, _)| gate), Some(Gate::Validity));
    /// assert_eq!(chain.step(&request).0, Vector3::zeros());
    /// ```
    pub fn step(&mut self, request: &ForceRequest<D>) -> (SVector<f64, D>, GateReport) {
        let mut report = GateReport { settings: self.settings, ..GateReport::default() };
        // Taken before anything else, so that a refused request also advances the clock.
        let dt_s = self.since_last_s(request.t_s);
        if self.settings.energy != EnergyMode::Off {
            // The force that was really held, after the governor: the energy of a requested force never reached the
            // hand.
            self.energy.observe(request.hand_m, &self.applied_n, dt_s);
        }
        self.applied_n = self.through(request, dt_s, &mut report);
        report.stored_j = self.energy.stored_j();
        self.counts.add(&report.reasons);
        report.counts = self.counts;
        (self.applied_n, report)
    }

    /// Returns the time since the last request, s: one period for the first request, zero if the clock did not advance.
    fn since_last_s(&mut self, t_s: f64) -> f64 {
        if !t_s.is_finite() {
            return 0.0;
        }
        // A clock that was set back gives zero: the slew limit then holds the last force for one tick.
        self.last_s.replace(t_s).map_or(self.period_s, |last_s| (t_s - last_s).max(0.0))
    }

    fn through(&mut self, request: &ForceRequest<D>, dt_s: f64, report: &mut GateReport) -> SVector<f64, D> {
        let admitted = admitted(request.force_n);
        let (fresh, age) = self.age.fraction(request.age_s);
        // The ramps of gain and dead band advance even while no force is permitted, so that they have settled before
        // the next engagement.
        let (gain, ramp) = self.gain.step(dt_s);
        report.gain = gain;
        report.note(Gate::Validity, admitted.err().unwrap_or_default());
        report.note(Gate::Age, age);
        report.note(Gate::Gain, ramp);
        let aged_n = admitted.unwrap_or_else(|_| SVector::zeros()) * fresh;
        let moving_n = self.past_dead_band(aged_n, request.speed_m_s, dt_s, report);
        // After the other gates: the report then also names what else would have held the force back.
        if !request.permitted {
            report.note(Gate::Permission, Reason::NotPermitted);
            // The next permitted force starts from zero, not from the force before the pause.
            self.reset();
            return SVector::zeros();
        }
        let limited_n = if report.acted(Gate::Validity) {
            // A stop takes effect at once: the slew limit does not apply to a release.
            SVector::zeros()
        } else {
            // Gain before slew and ceiling, so that neither limit can be raised by the gain.
            self.limited(moving_n * gain, dt_s, report)
        };
        // The force before the governor: a brake must not become the start of the next request.
        self.slew.left(limited_n);
        let reading =
            request.hand_m.map(|position_m| GovernorReading { t_s: request.t_s - request.hand_age_s, position_m });
        // Last, because the governor may only see forces that are really applied.
        let governed = self.governor.step(request.t_s, reading, limited_n);
        report.note(Gate::Governor, governed.reason);
        report.governed = governed.withheld;
        governed.force_n
    }

    /// Applies slew limit, energy gate and ceiling.
    fn limited(&self, force_n: SVector<f64, D>, dt_s: f64, report: &mut GateReport) -> SVector<f64, D> {
        let (slewed_n, slew) = self.slew.limited(force_n, dt_s);
        report.note(Gate::Slew, slew);
        let (paid_n, energy) = self.energy.controlled(slewed_n);
        report.note(Gate::Energy, energy);
        // The force removed by the energy gate decreases as fast as the slew limit allows, no faster. The ceiling
        // scales towards a ball that contains the last force, which never moves two forces further apart, so the slew
        // limit still holds afterwards.
        let (force_n, ceiling) = self.ceiling.under(self.slew.limited(paid_n, dt_s).0);
        report.note(Gate::Ceiling, ceiling);
        force_n
    }

    fn past_dead_band(
        &mut self,
        force_n: SVector<f64, D>,
        speed_m_s: f64,
        dt_s: f64,
        report: &mut GateReport,
    ) -> SVector<f64, D> {
        let fraction = self.dead_band.step(speed_m_s, dt_s);
        // A held force skips the band, but its state was advanced above, so switching the hold off causes no jump.
        if self.settings.static_hold || fraction >= 1.0 {
            return force_n;
        }
        report.note(Gate::DeadBand, if speed_m_s.is_finite() { Reason::HandSlow } else { Reason::SpeedUnknown });
        // For the screen: how much force the band removed, not how much is left.
        report.withheld_n = force_n.norm() * (1.0 - fraction);
        force_n * fraction
    }
}
