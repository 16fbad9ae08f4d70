//! Last gate: a handle that runs away under its force while nobody carries it is braked instead of pushed.
//!
//! In: the handle's reading (m), the force that all other gates let pass (`F_d`, N) and what the mode would like to give (N), once a
//! period. Out: the force for the hand (N), the share withheld and why. It needs to know the handle alone: [`Handle`].
//!
//! An [`observer`] tells what the hand does to the handle; [`flight`] tells a handle that flies; then with the share `A` withheld
//!
//! ```text
//! F = (1 - A) F_d - A min(b |v|, |F_d|) v / |v|        (below 1 mm/s no brake)
//! ```
//! so what pushed may also brake, and no more. That happens long before anybody knows whether the hand is gone: [`evidence`] of a
//! hand gives the force back smoothly, and only a handle that rests for 150 ms after a letting go beyond doubt is declared to have no
//! hand, until a reset.
//!
//! What is certain, whatever is asked and whatever the observer believes:
//! - `|F| <= |F_d|`: `F` lies between `F_d` and a vector no longer than it. Ceiling and device limit hold behind this gate.
//! - `F . v <= (1 - A) max(F_d . v, 0)`, `v` as observed: the brake only takes energy. The energy gate before this one observes the
//!   force that was really applied, so its bound holds with it: after a hand has let go at most what is stored
//!   ([`MOST_J`](super::MOST_J)) and [`ALLOWANCE_J`](super::ALLOWANCE_J)/[`LEAK_S`](super::LEAK_S), whatever is asked.
//!
//! What is only measured: an honest mode's push gives a handle 1.4 mJ at most before it is told (`docs/release.md`); one who sees the
//! handle and pushes in bursts too short to judge gets as much through as the energy gate lets.

mod evidence;
mod flight;
mod observer;

use nalgebra::SVector;

pub use observer::Handle;

use self::{
    evidence::{Evidence, Says},
    flight::{Flight, WEAK_N},
    observer::Observer,
};
use super::{PLAUSIBLE_N, Reason};

/// A brake sampled with this share of `m / T` or less does not shake the handle.
const BRAKE_OF_MASS: f64 = 0.15;
/// Slower than this nothing is braked, m/s.
const STILL_M_S: f64 = 1e-3;
/// Smoothing of the velocity, s, and the smoothed speed up to which it rather than the newest one is braked, m/s.
const SLOW_S: f64 = 0.010;
const COUNTS_M_S: f64 = 3e-3;
/// Time in which the force fades, s.
const FADE_S: f64 = 0.001;
/// Times in which it comes back (exponentially) to a hand that carries it, and (linearly) to what may be a hand, s.
const BACK_S: f64 = 0.020;
const PERHAPS_BACK_S: f64 = 0.150;
/// Times in which it is withheld altogether from a handle that flies on, and from one that nothing is known of, s.
const FREE_S: f64 = 0.005;
const NOTHING_S: f64 = 0.050;
/// Shares withheld: below the first the fade was a false alarm, above the second nothing is left.
const HARDLY: f64 = 0.1;
const NEARLY_ALL: f64 = 0.9;
/// Without any sign of a hand for so long it is gone, s.
const GONE_AFTER_S: f64 = 0.150;
/// A reading farther away is none, m.
const FAR_M: f64 = 1e3;

/// Force and handle as the looks need them.
#[derive(Clone, Copy, Debug)]
struct Push<const D: usize> {
    /// Direction of the force asked for; of the last one worth the name where there is none.
    along: SVector<f64, D>,
    /// Size of the force asked for, N.
    size_n: f64,
    at_m: SVector<f64, D>,
    velocity_m_s: SVector<f64, D>,
    hand_n: SVector<f64, D>,
    /// Speed along the push, m/s.
    out_m_s: f64,
    /// Size of the hand's force over that of the push.
    carried: f64,
}

/// What left the governor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Governed<const D: usize> {
    /// Force for the hand, N.
    pub force_n: SVector<f64, D>,
    /// Share of the asked force that was withheld, 0 to 1.
    pub withheld: f64,
    /// Why.
    pub reason: Reason,
}

/// The gate and its memory.
///
/// ```
/// use nalgebra::Vector1;
/// use nima_core::safety::{Governor, Handle, Reason};
///
/// let handle = Handle { mass_kg: 0.25, damping_n_s_m: 0.5, brake_n_s_m: 30.0 };
/// let mut governor = Governor::<1>::new(handle, 1e-3);
/// let asked_n = Vector1::new(3.0);
/// let (mut at_m, mut speed_m_s, mut held_n) = (0.0, 0.0, 3.0);
/// for tick in 0..200 {
///     // A hand of 900 N/m carries the force; after 100 ms it lets go.
///     let hand_n = if tick < 100 { -3.0 - 900.0 * at_m - 20.0 * speed_m_s } else { 0.0 };
///     speed_m_s += (held_n + hand_n - 0.5 * speed_m_s) / 0.25 * 1e-3;
///     at_m += speed_m_s * 1e-3;
///     let governed = governor.step(Some(Vector1::new(at_m)), asked_n, 3.0);
///     held_n = governed.force_n.x;
///     assert!(tick >= 100 || governed.reason == Reason::Open, "a hand that carries it gets all of it");
/// }
/// assert!(held_n.abs() < 0.1 && at_m < 2e-3, "the handle was caught after {at_m} m");
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Governor<const D: usize> {
    handle: Handle,
    period_s: f64,
    brake_n_s_m: f64,
    observer: Observer<D>,
    flight: Flight<D>,
    evidence: Evidence<D>,
    along: SVector<f64, D>,
    /// Velocity, smoothed, m/s: steps of the reading at rest are no motion to brake.
    slow_m_s: SVector<f64, D>,
    applied_n: SVector<f64, D>,
    withheld: f64,
    /// The hand let go beyond doubt, and nothing has spoken for one since.
    let_go: bool,
    gone: bool,
}

impl<const D: usize> Governor<D> {
    /// For this handle (of unknown mass: everything passes) and a loop of this period (s).
    pub fn new(handle: Handle, period_s: f64) -> Self {
        let brake_n_s_m = handle.brake_n_s_m.min(BRAKE_OF_MASS * handle.mass_kg / period_s);
        let stopping_s = handle.mass_kg / (brake_n_s_m + handle.damping_n_s_m).max(1e-9);
        Self {
            handle,
            period_s,
            brake_n_s_m,
            observer: Observer::new(handle, period_s),
            flight: Flight::new(period_s),
            evidence: Evidence::new(stopping_s, period_s),
            along: SVector::zeros(),
            slow_m_s: SVector::zeros(),
            applied_n: SVector::zeros(),
            withheld: 0.0,
            let_go: false,
            gone: false,
        }
    }

    /// Starts anew: the hand is taken to be there.
    pub fn reset(&mut self) {
        *self = Self::new(self.handle, self.period_s);
    }

    /// The handle is here now (m; `None`: not known, then what is withheld stays so), all gates before let `asked_n` (N) pass, and the
    /// mode would like to give this much (N): a force that other gates hold back for a moment is still a threat.
    ///
    /// Anything that is not finite gives no force.
    pub fn step(&mut self, hand_m: Option<SVector<f64, D>>, asked_n: SVector<f64, D>, threat_n: f64) -> Governed<D> {
        let governed = self.governed(hand_m, asked_n, threat_n);
        self.applied_n = governed.force_n;
        governed
    }

    fn governed(&mut self, hand_m: Option<SVector<f64, D>>, asked_n: SVector<f64, D>, threat_n: f64) -> Governed<D> {
        let far = |vector: &SVector<f64, D>, most: f64| !vector.iter().all(|x| x.abs() <= most);
        let none = |reason| Governed { force_n: SVector::zeros(), withheld: 1.0, reason };
        if far(&asked_n, PLAUSIBLE_N) || hand_m.is_some_and(|at_m| far(&at_m, FAR_M)) || threat_n.is_nan() {
            self.observer.forget();
            return none(Reason::NotFinite);
        }
        if self.handle.mass_kg <= 0.0 {
            return Governed { force_n: asked_n, withheld: 0.0, reason: Reason::Open };
        }
        let brake_n = if let Some(at_m) = hand_m {
            let push = self.push(at_m, asked_n);
            self.judge(&push, threat_n);
            self.brake(&push)
        } else {
            self.observer.forget();
            SVector::zeros()
        };
        if self.gone {
            return none(Reason::HandGone);
        }
        let withheld = self.withheld;
        let reason = if withheld > 0.0 { Reason::RunsAway } else { Reason::Open };
        Governed { force_n: asked_n * (1.0 - withheld) - brake_n * withheld, withheld, reason }
    }

    fn push(&mut self, at_m: SVector<f64, D>, asked_n: SVector<f64, D>) -> Push<D> {
        let size_n = asked_n.norm();
        if size_n > 0.3 * WEAK_N {
            self.along = asked_n / size_n;
        }
        let seen = self.observer.step(at_m, &self.applied_n, &asked_n);
        self.slow_m_s += (seen.velocity_m_s - self.slow_m_s) * decay(self.period_s, SLOW_S);
        Push {
            along: self.along,
            size_n,
            at_m,
            velocity_m_s: seen.velocity_m_s,
            hand_n: seen.hand_n,
            out_m_s: seen.velocity_m_s.dot(&self.along),
            carried: seen.hand_n.norm() / size_n.max(1e-9),
        }
    }

    /// Decides on the share that is withheld.
    fn judge(&mut self, push: &Push<D>, threat_n: f64) {
        let before = self.withheld;
        let flown = self.flight.look(push, &self.applied_n, before, &self.observer);
        if flown.share > before {
            self.withheld += (flown.share - before) * decay(self.period_s, FADE_S);
        }
        self.let_go |= flown.surely;
        if self.withheld > 0.5 && before <= 0.5 {
            self.evidence.begin();
        }
        let (says, seen) = self.evidence.look(push, &self.applied_n, self.withheld);
        self.let_go &= !seen;
        if self.withheld > 0.0 && flown.share <= self.withheld && !self.gone {
            let weak = push.size_n.max(threat_n) < 0.3 * WEAK_N;
            let says = if weak || before <= HARDLY { Says::Hand } else { says };
            self.withheld = self.moved(says);
        }
        self.let_go &= self.withheld > 0.0;
        self.gone |= self.let_go && self.withheld > NEARLY_ALL && self.evidence.quiet_s() > GONE_AFTER_S;
    }

    fn moved(&self, says: Says) -> f64 {
        let (withheld, dt_s) = (self.withheld, self.period_s);
        let moved = match says {
            Says::Hand => withheld * (1.0 - decay(dt_s, BACK_S)),
            Says::Perhaps => withheld - dt_s / PERHAPS_BACK_S,
            Says::Free => withheld + dt_s / FREE_S,
            Says::Nothing => withheld + dt_s / NOTHING_S,
        };
        if moved < 1e-3 { 0.0 } else { moved.min(1.0) }
    }

    fn brake(&self, push: &Push<D>) -> SVector<f64, D> {
        let speed_m_s = push.velocity_m_s.norm();
        let slow_m_s = self.slow_m_s.norm();
        let sure_m_s = speed_m_s.min(slow_m_s * (slow_m_s / COUNTS_M_S).max(1.0));
        let brake_n = self.brake_n_s_m * (sure_m_s - STILL_M_S).max(0.0);
        push.velocity_m_s * (brake_n.min(push.size_n) / speed_m_s.max(STILL_M_S))
    }
}

/// Share of the way that a low-pass of this time constant goes in a period.
fn decay(period_s: f64, time_s: f64) -> f64 {
    (period_s / time_s).min(1.0)
}

#[cfg(test)]
mod tests;
