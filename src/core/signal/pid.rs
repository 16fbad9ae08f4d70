//! A PID controller with a limited integral. The derivative acts on the measurement, so that a step of the set point
//! causes no spike.

use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PidGains {
    /// Output per unit of error.
    pub proportional: f64,
    /// Output per unit of error and second.
    pub integral_per_s: f64,
    /// Output per rate of change of the measurement.
    pub derivative_s: f64,
    /// Maximum contribution of the integral to the output, in both directions.
    pub integral_max: f64,
}

/// A PID controller.
///
/// ```
/// use nima_core::signal::{Pid, PidGains};
///
/// let gains = PidGains { proportional: 2.0, integral_per_s: 0.0, derivative_s: 0.0, integral_max: 0.0 };
/// let mut pid = Pid::new(gains);
/// assert!((pid.step(1.0, 0.4, 1e-3) - 1.2).abs() < 1e-12);
/// assert!(pid.step(f64::NAN, 0.4, 1e-3).abs() < 1e-12, "NaN gives no output");
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Pid {
    gains: PidGains,
    integral: f64,
    last: Option<f64>,
}

impl Pid {
    pub const fn new(gains: PidGains) -> Self {
        Self { gains, integral: 0.0, last: None }
    }

    pub const fn reset(&mut self) {
        self.integral = 0.0;
        self.last = None;
    }

    /// Returns the output for this set point and measurement, `dt_s` after the last step. A non-finite input gives zero
    /// and leaves the state unchanged.
    pub fn step(&mut self, goal: f64, measured: f64, dt_s: f64) -> f64 {
        // A time that does not advance has no derivative.
        if !(goal.is_finite() && measured.is_finite() && dt_s > 0.0) {
            return 0.0;
        }
        let PidGains { proportional, integral_per_s, derivative_s, integral_max } = self.gains;
        let error = goal - measured;
        // The sign of a limit says nothing, so a negative one cannot disable the clamp.
        let max = integral_max.abs();
        // Clamped in every step (anti-windup): an actuator at its stop would otherwise need as long to come back.
        self.integral = (self.integral + integral_per_s * error * dt_s).clamp(-max, max);
        // On the measurement instead of the error, so that a step of the set point causes no kick.
        let change = self.last.map_or(0.0, |last| (measured - last) / dt_s);
        self.last = Some(measured);
        proportional * error + self.integral - derivative_s * change
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GAINS: PidGains = PidGains { proportional: 0.2, integral_per_s: 8.0, derivative_s: 0.002, integral_max: 0.2 };

    #[test]
    fn a_constant_load_leaves_no_error_at_last() {
        // A servo with a steady error of 0.05 rad that follows its set point within 10 ms.
        let mut pid = Pid::new(GAINS);
        let mut angle = 0.0;
        let goal = 0.4;
        for _ in 0..2000 {
            let commanded = goal + pid.step(goal, angle, 1e-3);
            angle += (commanded - 0.05 - angle) * 0.1;
        }
        assert!((angle - goal).abs() < 1e-4, "{angle}");
    }

    #[test]
    fn the_integral_is_bounded_and_nonsense_is_ignored() {
        let mut pid = Pid::new(GAINS);
        for _ in 0..100_000 {
            pid.step(10.0, 0.0, 1e-3);
        }
        assert!((pid.step(0.0, 0.0, 1e-3) - 0.2).abs() < 1e-9);
        assert!(pid.step(f64::NAN, 0.0, 1e-3).abs() < 1e-12 && pid.step(1.0, 0.0, 0.0).abs() < 1e-12);
        pid.reset();
        assert!(pid.step(0.0, 0.0, 1e-3).abs() < 1e-12);
    }
}
