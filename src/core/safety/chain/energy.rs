//! Sixth gate: the hand cannot receive more energy than it has put in, apart from a small allowance.
//!
//! Time-domain passivity (Hannaford and Ryu, "Time-domain passivity control of haptic interfaces", 2002) at the hand's
//! port, with all axes together. *Observer*: the force held over the last period times the hand's travel in that period
//! is exactly the energy that crossed the port (the device holds a force for a period). *Controller*: while force and
//! motion have the same direction, the device gives energy; as the store runs low, the controller smoothly removes the
//! force along the motion, completely when the store is empty. Unlike theirs, this controller never reverses a force,
//! because a gate only removes force; the error of a predicted motion stays in the store as a debt.
//!
//! Two deliberate leaks, both towards the allowance: energy put in long ago cannot return as a kick, and a sensor's
//! noise cannot close the gate for ever. The hand therefore gets at most [`MAX_J`] at once, and
//! [`ALLOWANCE_J`]/[`LEAK_S`] (W) continuously. The travel must be the handle's own, unscaled, without the clutch's
//! jumps; a travel faster than any hand counts as zero.

use nalgebra::SVector;

use super::{EnergyMode, Reason};

/// Energy that the hand may receive without having put it in, J. It limits the energy of a free handle to 30 mJ and,
/// with [`LEAK_S`], 15 mW: in 100 million adversarial requests the most in 2 s was 58 mJ, without gates 43 J
/// (`docs/results/release.md`).
pub const ALLOWANCE_J: f64 = 0.030;
/// Maximum energy stored for the hand to get back, J.
/// Limits what a long compression of tissue may return: 200 mJ are 5 N over 40 mm.
pub const MAX_J: f64 = 0.200;
/// Time constant with which a surplus or a debt returns to the allowance, s. Without it, integration errors would
/// accumulate over a session.
pub const LEAK_S: f64 = 2.0;
/// Below this level of the store the controller begins to remove force, J. A third of the allowance: below it the force
/// fades over some millimetres instead of ending at once.
const SOFT_J: f64 = 0.010;
/// Smoothing of the direction of motion, s: a single encoder step is not a motion.
const SMOOTHING_S: f64 = 0.004;
/// A reading that moves faster than this, m/s, has jumped, because no hand is that fast.
const JUMP_M_S: f64 = 5.0;

/// The energy store and the state required to update it.
#[derive(Clone, Copy, Debug)]
pub struct Energy<const D: usize> {
    mode: EnergyMode,
    stored_j: f64,
    hand_m: Option<SVector<f64, D>>,
    hand_m_s: SVector<f64, D>,
}

impl<const D: usize> Energy<D> {
    pub fn new(mode: EnergyMode) -> Self {
        Self { mode, stored_j: ALLOWANCE_J, hand_m: None, hand_m_s: SVector::zeros() }
    }

    /// Accounts for the last `dt_s` (s): the hand is now at `hand_m` (m), and `held_n` (N) was held since the last
    /// call.
    pub fn observe(&mut self, hand_m: Option<SVector<f64, D>>, held_n: &SVector<f64, D>, dt_s: f64) {
        let hand_m = hand_m.filter(|position_m| position_m.iter().all(|x| x.is_finite()));
        let travel_m = match (hand_m, self.hand_m) {
            (Some(now_m), Some(then_m)) => now_m - then_m,
            _ => SVector::zeros(),
        };
        // Also when it is unknown, so that the travel of a gap does not count as the travel of one period.
        self.hand_m = hand_m;
        // The comparison is also false for the infinite difference of two finite positions.
        let travel_m = if travel_m.norm() <= JUMP_M_S * dt_s { travel_m } else { SVector::zeros() };
        // Low-pass of travel over time, arranged so that it never divides by zero time.
        self.hand_m_s += (travel_m - self.hand_m_s * dt_s) / (SMOOTHING_S + dt_s);
        // At most the whole difference, also after a long gap.
        let leak = (dt_s / LEAK_S).min(1.0);
        self.stored_j += (ALLOWANCE_J - self.stored_j) * leak - held_n.dot(&travel_m);
        // A debt is limited like a credit: otherwise a long error could close the gate for the rest of a session.
        self.stored_j = self.stored_j.clamp(-MAX_J, MAX_J);
    }

    /// Returns the part of `force_n` (N) that may pass now, and the reason for a reduction.
    pub fn controlled(&self, force_n: SVector<f64, D>) -> (SVector<f64, D>, Reason) {
        let fraction = (self.stored_j / SOFT_J).clamp(0.0, 1.0);
        let speed_m_s = self.hand_m_s.norm();
        let giving_w = force_n.dot(&self.hand_m_s);
        // A force that takes energy out of the hand is never removed: it only slows the hand.
        if self.mode != EnergyMode::Control || fraction >= 1.0 || giving_w <= 0.0 || speed_m_s < 1e-6 {
            return (force_n, Reason::Open);
        }
        // (f . v) v / |v|^2, arranged so that it never divides by the square of a tiny number.
        let direction = self.hand_m_s / speed_m_s;
        (force_n - direction * ((1.0 - fraction) * force_n.dot(&direction)), Reason::EnergySpent)
    }

    /// Returns the energy that the hand may still receive, J; negative if it received too much. 0 while the gate is
    /// off.
    pub fn stored_j(&self) -> f64 {
        // The screen shows the store; a gate that is off has none.
        if self.mode == EnergyMode::Off { 0.0 } else { self.stored_j }
    }

    /// Restarts from rest. The remaining store is discarded, but a debt is kept: otherwise toggling the permission
    /// could pump energy into the hand.
    pub fn reset(&mut self) {
        // The position is forgotten: the hand may move freely while nothing is permitted.
        self.stored_j = self.stored_j.min(ALLOWANCE_J);
        self.hand_m = None;
        self.hand_m_s = SVector::zeros();
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;
    use proptest::prelude::*;

    use super::*;

    /// Pushes a handle of 0.25 kg by `force(t, x, v)` (N) through the gate for `seconds`. Returns the energy that the
    /// hand received, J, and the largest fraction of force removed while the hand itself pushed.
    fn pushed(mode: EnergyMode, seconds: f64, force: impl Fn(f64, f64, f64) -> f64) -> f64 {
        let mut gate = Energy::<1>::new(mode);
        let mut x = 0.0;
        let mut v = 0.0;
        let mut got_j = 0.0;
        let mut held_n = 0.0;
        for i in 0..(seconds * 1e3) as u32 {
            gate.observe(Some([x].into()), &[held_n].into(), 1e-3);
            held_n = gate.controlled([force(f64::from(i) * 1e-3, x, v)].into()).0.x;
            v += held_n / 0.25 * 1e-3;
            x += v * 1e-3;
            got_j += held_n * v * 1e-3;
        }
        got_j
    }

    #[test]
    fn a_push_that_the_hand_did_not_pay_for_ends_with_the_allowance() {
        let (free_j, held_j) =
            (pushed(EnergyMode::Observe, 0.3, |_, _, _| 4.0), pushed(EnergyMode::Control, 0.3, |_, _, _| 4.0));
        assert!(free_j > 2.0, "{free_j} J");
        // The margin covers the leak during the push and the lag of the prediction.
        assert!(held_j < 1.3 * ALLOWANCE_J, "{held_j} J");
    }

    #[test]
    fn a_spring_that_gives_back_what_it_took_is_never_touched() {
        let mut gate = Energy::<1>::new(EnergyMode::Control);
        let mut held_n = 0.0;
        for i in 0..5000 {
            // 500 N/m pressed 8 mm deep once per second, without loss of energy.
            let depth_m = 0.004 * (1.0 - (f64::from(i) * 1e-3 * std::f64::consts::TAU).cos());
            gate.observe(Some([-depth_m].into()), &[held_n].into(), 1e-3);
            let (force_n, reason) = gate.controlled([500.0 * depth_m].into());
            assert_eq!(reason, Reason::Open, "after {i} ms: {} J", gate.stored_j());
            held_n = force_n.x;
        }
    }

    #[test]
    fn resetting_again_and_again_gives_no_energy() {
        let mut gate = Energy::<1>::new(EnergyMode::Control);
        for i in 0..400 {
            gate.observe(Some([f64::from(i) * 1e-4].into()), &[1.0].into(), 1e-3);
        }
        let owed_j = gate.stored_j();
        gate.reset();
        assert!(owed_j < 0.0 && gate.stored_j() <= owed_j);
    }

    proptest! {
        #[test]
        fn it_only_ever_takes_and_its_store_is_bounded(
            ticks in prop::collection::vec(
                (prop::array::uniform3(-20.0..20.0f64), prop::array::uniform3(prop_oneof![9 => -2e-3..2e-3f64, 1 => prop::num::f64::ANY]), prop_oneof![3 => Just(0.0), 1 => -1e-3..20e-3f64]),
                1..300,
            ),
        ) {
            let mut gate = Energy::<3>::new(EnergyMode::Control);
            let mut position_m = Vector3::zeros();
            let mut held_n = Vector3::zeros();
            for (force, way, late_s) in ticks {
                let force = Vector3::from(force);
                let now_m = position_m + Vector3::from(way);
                gate.observe(Some(now_m), &held_n, 1e-3 + late_s);
                position_m = if now_m.iter().all(|x| x.abs() < 1.0) { now_m } else { Vector3::zeros() };
                let (passed, reason) = gate.controlled(force);
                prop_assert!(passed.iter().all(|f| f.is_finite()) && passed.norm() <= force.norm() * (1.0 + 1e-12));
                prop_assert!(passed.dot(&force) >= -1e-9);
                prop_assert!(gate.stored_j().abs() <= MAX_J);
                prop_assert_eq!(reason == Reason::Open, passed == force);
                held_n = passed;
            }
        }
    }
}
