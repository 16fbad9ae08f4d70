//! The paper's rule that nothing is rendered below 1 mm/s, with a smooth edge and hysteresis so that it does not chatter.

/// Speed gate: 0 below the threshold, 1 above twice the threshold, smooth between.
///
/// Opening needs the threshold; once open it stays until the speed falls below half of it.
#[derive(Clone, Copy, Debug)]
pub struct DeadBand {
    /// Speed at which the gate begins to open, m/s (the paper's 1 mm/s). Zero means always open.
    pub threshold_m_s: f64,
    open: bool,
}

impl DeadBand {
    /// A closed gate with this threshold (m/s).
    pub const fn new(threshold_m_s: f64) -> Self {
        Self { threshold_m_s, open: false }
    }

    /// Share of the force that passes at this speed (m/s), 0 to 1. A speed that is not a number closes the gate.
    pub fn step(&mut self, speed_m_s: f64) -> f64 {
        if self.threshold_m_s <= 0.0 {
            return 1.0;
        }
        if !speed_m_s.is_finite() {
            self.open = false;
            return 0.0;
        }
        let closing_below = if self.open { 0.5 } else { 1.0 } * self.threshold_m_s;
        self.open = speed_m_s >= closing_below;
        if !self.open {
            return 0.0;
        }
        // Smoothstep from the closing edge to twice the threshold: no step in force at either end.
        let s = ((speed_m_s - 0.5 * self.threshold_m_s) / (1.5 * self.threshold_m_s)).clamp(0.0, 1.0);
        s * s * (3.0 - 2.0 * s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_nothing_below_and_everything_well_above_the_threshold() {
        let mut gate = DeadBand::new(1e-3);
        assert!(gate.step(0.9e-3).abs() < f64::EPSILON);
        assert!((gate.step(2e-3) - 1.0).abs() < f64::EPSILON);
        assert!(gate.step(0.7e-3) > 0.0, "hysteresis keeps it open down to half the threshold");
        assert!(gate.step(0.4e-3).abs() < f64::EPSILON);
        assert!(gate.step(0.7e-3).abs() < f64::EPSILON, "and closed until the threshold is reached again");
    }

    #[test]
    fn a_speed_that_is_no_number_closes_it() {
        let mut gate = DeadBand::new(1e-3);
        gate.step(1.0);
        assert!(gate.step(f64::NAN).abs() < f64::EPSILON);
    }
}
