//! What the hand does to the handle, told from the handle's reading and the force that was applied.
//!
//! A Luenberger observer of place, velocity and the hand's force (taken as constant), all three poles at 500 rad/s: a change of the
//! force shows after 4 to 6 ms, an encoder step of 10 um as 0.15 N. Model: `m a = F + f_h - c v`.

use nalgebra::SVector;

/// The observer's pole, rad/s. At 700 the fade comes 2 ms sooner and three times as often to a hand that is there.
const POLE_RAD_S: f64 = 500.0;
/// Least mass that is believed, kg: a lighter handle moves farther in a tick than can be told.
const LEAST_KG: f64 = 0.01;

/// A handle alone, without a hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Handle {
    /// Apparent mass at the grip, kg; 0: not known.
    pub mass_kg: f64,
    /// What its bearings and cables brake, N s/m.
    pub damping_n_s_m: f64,
    /// Most viscous damping that the device can make without shaking, N s/m.
    pub brake_n_s_m: f64,
}

/// What was found at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Observed<const D: usize> {
    /// Reading of the handle, m.
    pub(super) at_m: SVector<f64, D>,
    /// Velocity, m/s.
    pub(super) velocity_m_s: SVector<f64, D>,
    /// Force of the hand on the handle, N.
    pub(super) hand_n: SVector<f64, D>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Observer<const D: usize> {
    mass_kg: f64,
    damping_n_s_m: f64,
    period_s: f64,
    /// What of the reading's surprise goes into place (1), velocity (1/s) and force (N/m).
    gains: [f64; 3],
    last: Option<Observed<D>>,
}

impl<const D: usize> Observer<D> {
    /// Of this handle, in a loop of this period (s).
    pub(super) fn new(handle: Handle, period_s: f64) -> Self {
        let mass_kg = handle.mass_kg.max(LEAST_KG);
        let pole = libm::exp(-POLE_RAD_S * period_s);
        let rest = 1.0 - pole;
        Self {
            mass_kg,
            // A step of Euler's method stays stable.
            damping_n_s_m: handle.damping_n_s_m.clamp(0.0, 0.5 * mass_kg / period_s),
            period_s,
            gains: [
                1.0 - pole * pole * pole,
                1.5 * rest * rest * (1.0 + pole) / period_s,
                mass_kg * (rest * rest * rest) / (period_s * period_s),
            ],
            last: None,
        }
    }

    /// Kinetic energy at this velocity (m/s), J.
    pub(super) fn kinetic_j(&self, velocity_m_s: &SVector<f64, D>) -> f64 {
        0.5 * self.mass_kg * velocity_m_s.norm_squared()
    }

    /// The handle is here now (m), and this force (N) was held since the last call. The first look takes the handle to be at rest, in
    /// balance with the force that is asked for (N).
    pub(super) fn step(
        &mut self,
        at_m: SVector<f64, D>,
        held_n: &SVector<f64, D>,
        asked_n: &SVector<f64, D>,
    ) -> Observed<D> {
        let first = Observed { at_m, velocity_m_s: SVector::zeros(), hand_n: -asked_n };
        let Observed { at_m: last_m, velocity_m_s, hand_n } = self.last.map_or(first, |last| Observed { ..last });
        let dt_s = self.period_s;
        let held_n = if self.last.is_some() { *held_n } else { *asked_n };
        let acceleration_m_s2 = (held_n + hand_n - velocity_m_s * self.damping_n_s_m) / self.mass_kg;
        let expected_m = last_m + velocity_m_s * dt_s + acceleration_m_s2 * (0.5 * dt_s * dt_s);
        let surprise_m = at_m - expected_m;
        let [place, velocity, force] = self.gains;
        let estimate = Observed {
            at_m: expected_m + surprise_m * place,
            velocity_m_s: velocity_m_s + acceleration_m_s2 * dt_s + surprise_m * velocity,
            hand_n: hand_n + surprise_m * force,
        };
        self.last = Some(estimate);
        Observed { at_m, ..estimate }
    }

    /// Knows nothing any more.
    pub(super) const fn forget(&mut self) {
        self.last = None;
    }
}
