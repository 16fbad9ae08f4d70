//! Does the handle run away along the push while nobody carries the force?
//!
//! *Fast*: a force that a hand carried a moment ago is carried no more, and the handle moves along it. Told within 4 to 6 ms. *Slow*:
//! the handle's kinetic energy has grown by what the force has given it, and by nothing else. Told after 15 ms, whatever came before.

use nalgebra::SVector;

use super::{Push, observer::Observer};

/// Weakest force that is judged, N.
pub(super) const WEAK_N: f64 = 0.3;
/// Slowest motion along the push that is a flight, m/s.
const FLIGHT_M_S: f64 = 0.030;
/// Slowest motion that counts as along the push, m/s.
pub(super) const ALONG_M_S: f64 = 0.002;
/// Shares of the push, carried by the hand, between which the fade goes from whole to none.
const FADE: [f64; 2] = [0.35, 0.6];
/// A share above the first is a force that is carried, one below the second is one that is not.
const CARRIED: f64 = 0.7;
pub(super) const FREE: f64 = 0.3;
/// For how long after it was carried a push can turn into a flight, s.
const CARRIED_WITHIN_S: f64 = 0.008;
/// The same for one that is beyond doubt, s, and the least force of such a one, N.
const SURELY_WITHIN_S: f64 = 0.009;
const SURE_N: f64 = 1.0;
/// Time in which a force counts as steady, s, and the share of it that must.
const STEADY_S: f64 = 0.008;
const STEADY: f64 = 0.75;
/// For the slow look: most of the push that is carried as a share and beyond it (N), for how long more does not count (s: steps of a
/// coarse reading look like it), least time (s) and least work (J).
const UNCARRIED: f64 = 0.4;
const UNCARRIED_N: f64 = 0.1;
const BREAK_S: f64 = 0.002;
const LONG_S: f64 = 0.015;
const WORK_J: f64 = 0.25e-3;
/// What the kinetic energy has grown by, as a share of the work: a handle's mass that is wrong by a quarter, and its Coulomb friction (N).
const ENERGIES: [f64; 2] = [0.77, 1.45];
const COULOMB_N: f64 = 0.16;

/// What one look tells.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Flown {
    /// Share of the force that is to be withheld at least.
    pub(super) share: f64,
    /// The hand has let go beyond doubt, just now.
    pub(super) surely: bool,
}

/// The push's past.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flight<const D: usize> {
    period_s: f64,
    /// What of the push has been there for a while, N.
    steady_n: SVector<f64, D>,
    /// Since when the hand does not carry it, s.
    uncarried_s: f64,
    /// Share that it carried at the last look.
    share_before: f64,
    run: Option<Run>,
    /// For how long it has not looked like one, s.
    broken_s: f64,
}

/// A motion along a push that nobody carries.
#[derive(Clone, Copy, Debug)]
struct Run {
    lasted_s: f64,
    work_j: f64,
    kinetic_at_start_j: f64,
    rubbed_j: f64,
}

impl<const D: usize> Flight<D> {
    pub(super) fn new(period_s: f64) -> Self {
        Self {
            period_s,
            steady_n: SVector::zeros(),
            uncarried_s: f64::INFINITY,
            share_before: 0.0,
            run: None,
            broken_s: 0.0,
        }
    }

    /// Looks at a push while this share of it is withheld, `held_n` (N) being the force that was applied since the last look.
    pub(super) fn look(
        &mut self,
        push: &Push<D>,
        held_n: &SVector<f64, D>,
        withheld: f64,
        observer: &Observer<D>,
    ) -> Flown {
        let is_steady = self.steadies(push) > STEADY * push.size_n;
        let carries = -push.hand_n.dot(&push.along) >= CARRIED * push.size_n && held_n.norm() > WEAK_N;
        self.uncarried_s = if carries && withheld < 0.5 { 0.0 } else { self.uncarried_s + self.period_s };
        let strong = push.size_n > WEAK_N && push.out_m_s > FLIGHT_M_S;
        let recent = self.uncarried_s < CARRIED_WITHIN_S || withheld > 0.5;
        let fast = strong && is_steady && recent;
        let slow = self.runs(push, held_n, observer) && strong;
        let fade = ((FADE[1] - push.carried) / (FADE[1] - FADE[0])).clamp(0.0, 1.0);
        let falls = push.carried < FREE && self.share_before >= FREE;
        self.share_before = push.carried;
        Flown {
            share: if slow {
                1.0
            } else if fast {
                fade
            } else {
                0.0
            },
            surely: falls && fast && self.uncarried_s <= SURELY_WITHIN_S && push.size_n >= SURE_N,
        }
    }

    /// How much of the push is steady, N: all that has been there for [`STEADY_S`].
    fn steadies(&mut self, push: &Push<D>) -> f64 {
        let kept_n = self.steady_n.dot(&push.along);
        let now_n = if kept_n < 0.0 || push.size_n <= 0.0 {
            0.0
        } else {
            (kept_n + push.size_n * self.period_s / STEADY_S).min(push.size_n)
        };
        self.steady_n = push.along * now_n;
        now_n
    }

    /// All that the handle's kinetic energy has grown by is the force's work, but for what friction takes.
    fn runs(&mut self, push: &Push<D>, held_n: &SVector<f64, D>, observer: &Observer<D>) -> bool {
        let goes = push.out_m_s > ALONG_M_S && push.size_n > 0.5 * WEAK_N;
        let uncarried = push.hand_n.norm() < UNCARRIED * push.size_n + UNCARRIED_N;
        self.broken_s = if goes && uncarried { 0.0 } else { self.broken_s + self.period_s };
        if !goes || self.broken_s > BREAK_S {
            self.run = None;
            return false;
        }
        let kinetic_j = observer.kinetic_j(&push.velocity_m_s);
        let run =
            self.run.get_or_insert(Run { lasted_s: 0.0, work_j: 0.0, rubbed_j: 0.0, kinetic_at_start_j: kinetic_j });
        run.lasted_s += self.period_s;
        run.work_j += held_n.dot(&push.velocity_m_s) * self.period_s;
        run.rubbed_j += COULOMB_N * push.velocity_m_s.norm() * self.period_s;
        let grown_j = kinetic_j - run.kinetic_at_start_j;
        let explained = ENERGIES[0] * (run.work_j - run.rubbed_j)..ENERGIES[1] * run.work_j;
        run.lasted_s > LONG_S && run.work_j > WORK_J && explained.contains(&grown_j)
    }
}
