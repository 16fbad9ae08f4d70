//! Checks every output of a chain and counts violations. It uses only the limits, not the implementation of the gates.

use nalgebra::SVector;
use nima_core::{
    limits::{GAIN, GAIN_ABOVE_ONE},
    safety::{ChainSettings, Gate, GateReport, MAX_J, Reason},
};
use serde::Serialize;

/// Relative rounding allowed in a limit.
const ROUNDING: f64 = 1e-9;

/// Number of violations of each limit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Breaches {
    /// A force that is not finite.
    pub not_finite: u64,
    /// A force above the force limit, or above the device's maximum.
    pub ceiling: u64,
    /// A change between consecutive forces above the slew limit, except a fall to zero where a gate withdraws the force
    /// at once.
    pub slew: u64,
    /// Gain changes faster than the permitted rate.
    pub gain_rate: u64,
    /// A gain outside 0 to 3, or one above 1 without the second confirmation.
    pub gain_range: u64,
    /// A force without permission, without a hand, or from an invalid request.
    pub uncalled: u64,
    /// Stored energies above the limit.
    pub energy: u64,
}

impl Breaches {
    pub const fn total(&self) -> u64 {
        let Self { not_finite, ceiling, slew, gain_rate, gain_range, uncalled, energy } = *self;
        not_finite + ceiling + slew + gain_rate + gain_range + uncalled + energy
    }
}

/// The limits of one chain, and its last output.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GateWatch<const D: usize> {
    pub(super) max_n: f64,
    pub(super) slew_n_per_s: f64,
    pub(super) gain_per_s: f64,
    pub(super) period_s: f64,
    pub(super) last_s: Option<f64>,
    pub(super) last_n: SVector<f64, D>,
    pub(super) gain: f64,
    /// Whether the governor had already detected a release before the last force.
    pub(super) let_go: bool,
    /// Whether a gain above 1 has been confirmed and not withdrawn.
    pub(super) above_one: bool,
}

impl<const D: usize> GateWatch<D> {
    /// Creates the limits of a chain with these settings and this period (s), before its first force.
    pub(crate) fn of(settings: &ChainSettings, period_s: f64) -> Self {
        Self {
            max_n: settings.ceiling_n.min(settings.device_limit_n),
            slew_n_per_s: settings.slew_n_per_s,
            gain_per_s: settings.gain_rate_per_s,
            period_s,
            last_s: None,
            last_n: SVector::zeros(),
            gain: settings.gain,
            let_go: false,
            above_one: false,
        }
    }

    /// Checks the force (N) at a time (s) and its report; `chosen` is the gain that was set.
    pub(crate) fn look(
        &mut self,
        t_s: f64,
        now_n: &SVector<f64, D>,
        report: &GateReport,
        chosen: f64,
        breaches: &mut Breaches,
    ) {
        let dt_s = self.last_s.replace(t_s).map_or(self.period_s, |last_s| (t_s - last_s).max(0.0));
        let within = |value: f64, limit: f64| value <= limit * (1.0 + ROUNDING) + f64::MIN_POSITIVE;
        let finite = now_n.iter().all(|f| f.is_finite()) && report.gain.is_finite();
        let let_go = [Gate::Permission, Gate::Validity].iter().any(|gate| report.acted(*gate))
            || [Reason::HandGone, Reason::NotFinite].contains(&report.reason(Gate::Governor));
        // Only on a released handle may the force or the brake fall faster, and then to zero.
        let lets_go = report.reason(Gate::Governor) == Reason::LetGo;
        let falls = (let_go || lets_go || self.let_go) && now_n.norm() == 0.0;
        let step_n = self.slew_n_per_s * dt_s.min(self.period_s);
        let change_n = (now_n - self.last_n).norm();
        // The rounding of a gain near 3 is larger than the relative rounding of a slow ramp.
        let gain_change = (report.gain - self.gain).abs() - 4.0 * f64::EPSILON;
        let chosen_well = (if self.above_one { GAIN_ABOVE_ONE } else { GAIN }).contains(chosen);
        breaches.not_finite += u64::from(!finite);
        breaches.ceiling += u64::from(!within(now_n.norm(), self.max_n));
        // The tolerance is the rounding of the two forces, which is larger than that of their small difference.
        breaches.slew += u64::from(!falls && !within(change_n - 1e-14 * self.max_n, step_n));
        breaches.gain_rate += u64::from(!within(gain_change, self.gain_per_s * dt_s));
        breaches.gain_range += u64::from(!chosen_well || !GAIN_ABOVE_ONE.contains(report.gain));
        breaches.uncalled += u64::from(let_go && now_n.norm() != 0.0);
        breaches.energy += u64::from(!within(report.stored_j.abs(), MAX_J));
        self.last_n = *now_n;
        self.gain = report.gain;
        self.let_go = lets_go;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    fn seen(now_n: Vector3<f64>, report: GateReport, chosen: f64) -> Breaches {
        let mut watch = GateWatch {
            max_n: 4.0,
            slew_n_per_s: 500.0,
            gain_per_s: 2.0,
            period_s: 1e-3,
            last_s: None,
            last_n: Vector3::new(3.8, 0.0, 0.0),
            gain: 1.0,
            let_go: false,
            above_one: false,
        };
        let mut breaches = Breaches::default();
        watch.look(0.0, &now_n, &report, chosen, &mut breaches);
        breaches
    }

    #[test]
    fn every_kind_of_breach_is_seen_and_nothing_else() {
        let good = GateReport { gain: 1.0, ..GateReport::default() };
        let near = Vector3::new(3.9, 0.1, 0.0);
        assert_eq!(seen(near, good, 1.0), Breaches::default());
        assert_eq!(seen(Vector3::new(4.1, 0.0, 0.0), good, 1.0), Breaches { ceiling: 1, ..Breaches::default() });
        assert_eq!(seen(Vector3::new(3.2, 0.0, 0.0), good, 1.0), Breaches { slew: 1, ..Breaches::default() });
        assert!(seen(Vector3::new(f64::NAN, 0.0, 0.0), good, 1.0).not_finite == 1);
        let fast = GateReport { gain: 0.99, ..good };
        assert_eq!(seen(near, fast, 0.5), Breaches { gain_rate: 1, ..Breaches::default() });
        assert_eq!(seen(near, good, 1.5), Breaches { gain_range: 1, ..Breaches::default() });
        let forbidden = good.with(Gate::Permission, Reason::NotPermitted);
        assert_eq!(seen(near, forbidden, 1.0), Breaches { uncalled: 1, ..Breaches::default() });
        assert_eq!(
            seen(Vector3::zeros(), forbidden, 1.0),
            Breaches::default(),
            "a release does not violate the slew limit"
        );
        let pump = GateReport { stored_j: 2.0 * MAX_J, ..good };
        assert_eq!(seen(near, pump, 1.0), Breaches { energy: 1, ..Breaches::default() });
    }
}
