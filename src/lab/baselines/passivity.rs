//! Time-domain passivity over a delayed link, return channel (Hannaford and Ryu, "Time-domain passivity control of
//! haptic interfaces", IEEE Trans. Robotics and Automation 18, 2002; Ryu, Artigas and Preusche, "A passive bilateral
//! control scheme for a teleoperator with time-varying communication delay", Mechatronics 20, 2010).
//!
//! The energy at each port is split by its direction. The follower accumulates the energy that the tissue gives to the
//! link, `E_in`, which never decreases, and sends it with the force. The leader accumulates the energy that the link
//! gives to the hand, `E_out`, and must not give more than was put in: observer
//! `W(k) = E_in(k - D) - E_out(k) + E_pc(k - 1)`; where `W` is negative, the controller adds the damping
//! `alpha = -W / (v^2 T)`, which dissipates `E_pc += alpha v^2 T`. The deficit of a tick is at most the energy given in
//! that tick, so the damping never reverses the force.
//!
//! The observer and controller at the follower are omitted, because the motion reaches the follower without delay in
//! this loop.

use nima_core::{
    impedance::{Baseline, BaselineModel},
    signal::{Lanes, Motion},
};

use crate::BaselineSender;

/// The follower's part: energy that the tissue returns.
#[derive(Clone, Debug)]
pub(crate) struct ReturnedEnergy {
    period_s: f64,
    energy_j: Lanes,
}

impl BaselineSender for ReturnedEnergy {
    const BASELINE: Baseline = Baseline::Passivity;

    fn new(rate_hz: f64, _delay_ticks: usize) -> Self {
        Self { period_s: rate_hz.recip(), energy_j: Lanes::ZERO }
    }

    fn step(&mut self, motion: &Motion, force_n: Option<Lanes>) -> BaselineModel {
        if let Some(force_n) = force_n {
            self.energy_j += given(force_n, motion, self.period_s);
        }
        BaselineModel::Returned { energy_j: self.energy_j }
    }

    fn reset(&mut self) {
        self.energy_j = Lanes::ZERO;
    }
}

/// The leader's part: observer and controller.
#[derive(Clone, Debug)]
pub(crate) struct PassivityController {
    period_s: f64,
    came_j: Lanes,
    /// `E_in - E_out + E_pc`.
    store_j: Lanes,
}

impl PassivityController {
    pub(crate) fn new(rate_hz: f64) -> Self {
        Self { period_s: rate_hz.recip(), came_j: Lanes::ZERO, store_j: Lanes::ZERO }
    }

    /// Returns the force (N) for the hand: the received force and the controller's addition.
    pub(crate) fn step(&mut self, force_n: Lanes, came_j: Lanes, own: &Motion) -> Lanes {
        if !came_j.is_finite() {
            return force_n;
        }
        // Energy that is reported twice (after a longer delay or a restart of the follower) is not counted again.
        self.store_j += (came_j - self.came_j).map(|more_j| more_j.max(0.0));
        self.came_j = came_j;
        self.store_j -= given(force_n, own, self.period_s);
        // `-alpha v = W / (v T)`, against the motion; after it no deficit remains.
        let damping_n = self.store_j.map(|store_j| store_j.min(0.0)) * (own.v * self.period_s).recip_or_zero();
        self.store_j = self.store_j.map(|store_j| store_j.max(0.0));
        force_n + damping_n
    }

    pub(crate) fn reset(&mut self) {
        self.came_j = Lanes::ZERO;
        self.store_j = Lanes::ZERO;
    }
}

/// Returns the energy (J) that a force gives along the motion in one period; 0 if it absorbs energy.
fn given(force_n: Lanes, motion: &Motion, period_s: f64) -> Lanes {
    (force_n * motion.v * period_s).map(|energy_j| energy_j.max(0.0))
}
