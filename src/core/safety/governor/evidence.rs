//! Decides whether a hand holds the handle, from the limits of hands and the signs of a released handle.
//!
//! *Push*: the handle accelerates along the force faster than a hand moves. *Step*: the force that the hand carried vanishes
//! faster than a hand changes its own. Both are certain beyond what a voluntary motion reaches, and likely beyond a
//! fraction of it. *Travel*: the force alone explains the motion over a longer path than any hand shows.

use nalgebra::SVector;

use super::{
    fit::Parabola,
    observer::{ForceRange, ObserverHistory},
};

/// Largest acceleration of a hand, m/s^2: a minimum-jerk motion of 35 mm in 0.2 s has 5.05 (5.77 d / T^2, Flash and Hogan 1985),
/// and a soft grip overshoots by a fifth.
const HAND_M_S2: f64 = 6.0;
/// Largest jerk of a hand, m/s^3: the same motion has 262 (60 d / T^3).
const HAND_M_S3: f64 = 300.0;
/// Fractions of these limits that are rare, chosen for less than one false alarm per hour with the hands of `nima study
/// hands`.
const RARE_M_S2: f64 = 4.2;
const RARE_STEP: f64 = 0.35;
/// Weakest force that is evaluated, N: twice the friction.
const WEAK_N: f64 = 0.3;
/// Coulomb friction of a cable-driven handle, N (omega.7).
pub(super) const COULOMB_N: f64 = 0.15;
/// Error of the handle's mass, as a fraction.
pub(super) const MASS_OFF: f64 = 0.25;
/// A motion along the force is faster than this, m/s: it crosses an encoder step of 10 um in one tick.
pub(super) const OUT_M_S: f64 = 0.008;
/// Time that a grip of 400 N/m with 0.25 kg takes to respond to a change of the force, s.
const ANSWER_S: f64 = 0.020;
/// Fraction of the speed that the force gives a lone handle after a step.
/// Half: a handle with twice the assumed mass still passes.
const DRIVEN: f64 = 0.5;
/// A hand that carries less than this fraction of a force has lost it.
/// Above the error of the mass (`MASS_OFF`), so that a handle without a hand always counts as lost.
const LOST: f64 = 0.4;
/// Fraction of the force that a hand carried before a step counts as one.
const CARRIED: f64 = 0.5;
/// Windows of the parabola, s, and of the two halves of the kink, s: short ones for strong forces, long ones for weak ones.
const PUSHES_S: [f64; 5] = [0.004, 0.006, 0.009, LONG_S, 2.0 * LONG_S];
const STEPS_S: [[f64; 2]; 4] = [[0.008, 0.005], [0.008, 0.008], [0.010, 0.011], [0.016, 0.014]];
const LONG_S: f64 = 0.014;
/// Windows for judging the travel, s; the shortest usable one decides.
const TRAVELS_S: [f64; 3] = [LONG_S, 2.0 * LONG_S, 4.0 * LONG_S];
/// Largest scatter of a usable fit, as a fraction of the applied force. With 0.4, hands that held a device with its own
/// clock were mistaken for released handles (`nima study hands`).
const SCATTER: f64 = 0.3;
/// Travel caused by the force alone, m: the first value is suspicious if the acceleration is rare, the second is
/// evidence at any acceleration. In the study, no hand moved more than 13 mm in this way.
const PUSHED_M: f64 = 1e-3;
const TRAVEL_M: f64 = 0.025;
const TRAVEL_N: f64 = 0.4;
/// The same for a handle that started at rest, m, for a force of this size, N, and its initial speed, m/s.
const FROM_REST_M: f64 = 2e-3;
const FROM_REST_N: f64 = 1.2;
const REST_M_S: f64 = 0.02;

/// Answer to the question.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum EvidenceAnswer {
    /// A hand explains the motion.
    #[default]
    No,
    /// The force alone explains the motion; a hand hardly moves like that.
    Pushed,
    /// The held force vanished faster than a hand normally releases it.
    Dropped,
    /// No hand moves so.
    Certain,
}

/// Memory of the travel.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Evidence<const D: usize> {
    run: Option<ForceRun<D>>,
}

/// A motion explained by the force alone.
#[derive(Clone, Copy, Debug)]
struct ForceRun<const D: usize> {
    /// Start of the motion, m.
    from_m: SVector<f64, D>,
    /// Whether it started from rest: the motion of a hand never starts like this without a force from the hand.
    from_rest: bool,
}

/// Components along and across the applied force.
#[expect(clippy::struct_field_names, reason = "the unit")]
struct MotionParts {
    /// Size of the applied force, N.
    size_n: f64,
    /// Part of the force that the hand carries, N.
    carried_n: f64,
    /// Force of the hand across that direction, N.
    aside_n: f64,
}

impl MotionParts {
    fn of<const D: usize>(hand_n: &SVector<f64, D>, applied_n: &SVector<f64, D>) -> Self {
        // The caller has checked that the force is above `WEAK_N`, so this never divides by zero.
        let size_n = applied_n.norm();
        let along = applied_n / size_n;
        // A hand that carries a force pushes against it, hence the sign.
        let carried_n = -hand_n.dot(&along);
        Self { size_n, carried_n, aside_n: (hand_n + along * carried_n).norm() }
    }

    /// Returns a lower bound of mass times acceleration along the force, N.
    fn pushed_n(&self, error_n: f64) -> f64 {
        self.size_n - self.carried_n - error_n
    }

    /// Returns whether a handle without a hand could show this hand force: from an error of its mass, friction, and the
    /// error of the fit.
    fn is_free(&self, error_n: f64) -> bool {
        let mass_n = MASS_OFF * self.size_n + error_n;
        self.carried_n < mass_n + COULOMB_N && self.carried_n > -mass_n && self.aside_n < mass_n + COULOMB_N
    }
}

impl<const D: usize> Evidence<D> {
    pub(super) fn look(&mut self, past: &ObserverHistory<D>) -> EvidenceAnswer {
        let pushed = self.pushes(past);
        // A certain answer needs no second sign, and the search for a step is the more expensive one.
        if pushed == EvidenceAnswer::Certain { pushed } else { pushed.max(steps(past)) }
    }

    fn pushes(&mut self, past: &ObserverHistory<D>) -> EvidenceAnswer {
        // Short windows first: a strong force is recognised within 4 ms. `map_while` ends when the history is too
        // short.
        for now in PUSHES_S.iter().map_while(|span_s| past.parabola(*span_s)) {
            let size_n = now.applied_n.norm();
            if !moves_along(&now) || now.scatter_n > SCATTER * size_n {
                continue;
            }
            let range = past.range(now.span_s + ANSWER_S, &(now.applied_n / size_n));
            let parts = MotionParts::of(&now.hand_n, &now.applied_n);
            let lost = parts.carried_n < LOST * size_n + now.error_n
                && parts.aside_n < MASS_OFF * size_n + COULOMB_N + now.error_n;
            // A hand needs [`ANSWER_S`] to respond: a change of the force within that time accelerates a held handle
            // too.
            let pushed_n = parts.pushed_n(now.error_n) - range.change_n();
            if lost && range.min_along_n > 0.0 && pushed_n > past.handle.mass_kg * HAND_M_S2 {
                return EvidenceAnswer::Certain;
            }
        }
        self.travels(past)
    }

    fn travels(&mut self, past: &ObserverHistory<D>) -> EvidenceAnswer {
        // The same scatter limit as for the push, so that both judge only fits of the same quality.
        let known = |now: &Parabola<D>| now.scatter_n <= SCATTER * now.applied_n.norm();
        let fit = TRAVELS_S.iter().map_while(|span_s| past.parabola(*span_s)).find(known);
        if let Some(now) = fit.filter(moves_along) {
            let size_n = now.applied_n.norm();
            let parts = MotionParts::of(&now.hand_n, &now.applied_n);
            let steady_n = past.range(now.span_s, &(now.applied_n / size_n)).min_along_n;
            if parts.is_free(now.error_n) && steady_n > 0.5 * size_n {
                let rare = parts.pushed_n(now.error_n) > past.handle.mass_kg * RARE_M_S2;
                return self.travel(past, size_n, now.velocity_m_s.norm(), rare);
            }
        }
        // One sample that a hand explains ends the run: travel counts only without interruption.
        self.run = None;
        EvidenceAnswer::No
    }

    fn travel(&mut self, past: &ObserverHistory<D>, size_n: f64, speed_m_s: f64, rare: bool) -> EvidenceAnswer {
        // Kept from the first sample of the run, not moved along with it.
        let begins = ForceRun { from_m: past.position_m, from_rest: speed_m_s < REST_M_S };
        let run = self.run.get_or_insert(begins);
        let travel_m = (past.position_m - run.from_m).norm();
        let driven = run.from_rest && travel_m > FROM_REST_M && size_n > FROM_REST_N;
        let far = travel_m > TRAVEL_M && size_n > TRAVEL_N;
        if far {
            EvidenceAnswer::Certain
        } else if driven || (rare && travel_m > PUSHED_M) {
            EvidenceAnswer::Pushed
        } else {
            EvidenceAnswer::No
        }
    }
}

/// Returns whether the handle moves along a force that is strong enough to be evaluated.
fn moves_along<const D: usize>(now: &Parabola<D>) -> bool {
    let size_n = now.applied_n.norm();
    size_n >= WEAK_N && now.velocity_m_s.dot(&now.applied_n) >= OUT_M_S * size_n
}

/// Returns whether the hand's force has vanished in a step.
fn steps<const D: usize>(past: &ObserverHistory<D>) -> EvidenceAnswer {
    let mut alone = EvidenceAnswer::No;
    for [before_s, after_s] in STEPS_S {
        // The splits become longer, so the first one that the history cannot fill ends the search.
        let Some(kink) = past.kink(before_s, after_s) else { break };
        let size_n = kink.applied_after_n.norm();
        // The applied force soon accelerates a released handle from rest; a handle that swings in a grip does not move
        // like that.
        let driven_m_s = DRIVEN * size_n / past.handle.mass_kg * kink.after_s;
        if size_n < WEAK_N || kink.velocity_m_s.dot(&kink.applied_after_n) < driven_m_s.max(OUT_M_S) * size_n {
            continue;
        }
        let along = kink.applied_after_n / size_n;
        let range: ForceRange = past.range(kink.span_s, &along);
        let parts = MotionParts::of(&kink.after_n, &kink.applied_after_n);
        let was_carried = -kink.before_n.dot(&along) > CARRIED * kink.applied_before_n.dot(&along);
        let known = kink.scatter_n <= SCATTER * size_n;
        if !known || range.min_along_n < 0.5 * size_n || !parts.is_free(kink.after_error_n) || !was_carried {
            continue;
        }
        // If the assumed mass is wrong, a step of the applied force looks like a step of the hand's force.
        let step_n = (kink.after_n - kink.before_n).dot(&along) - kink.step_error_n - MASS_OFF * range.change_n();
        // Largest change of a hand's force during the kink: mass times jerk times half its length.
        let ramp_n = past.handle.mass_kg * HAND_M_S3 * 0.5 * kink.span_s;
        if step_n > ramp_n {
            return EvidenceAnswer::Certain;
        }
        if step_n > RARE_STEP * ramp_n {
            // A longer split may still give certainty, so the search continues.
            alone = EvidenceAnswer::Dropped;
        }
    }
    alone
}
