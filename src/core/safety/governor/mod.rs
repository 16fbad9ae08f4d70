//! Last gate: brakes a released handle instead of pushing it.
//!
//! Input: the time of the tick (s), the handle's reading (m) with its time (s), and the force that all other gates pass
//! (`F_d`, N). Output: the force for the hand (N), the withheld fraction and the reason. The handle is the only model:
//! [`FreeHandle`].
//!
//! The force of the hand on the handle follows from the readings and the applied force at true times ([`observer`], [`fit`]).
//! [`evidence`] compares this force with the limits of a hand. There are four states:
//!
//! - *held*: `F = F_d`. A withheld fraction returns within [`RETURN_S`].
//! - *doubtful*: the motion is rare for a hand. The force fades, `F = (1 - A) F_d`, no faster than the slew limit. If the handle then
//!   coasts, it was released; if its motion requires a hand, it is held.
//! - *let go*: a hand cannot move like this. The force falls to zero at once; then `F = -b v`, at most `|F_d|`, built up within the slew limit.
//! - *gone*: the handle has rested for [`GONE_AFTER_S`] after one of the two. No force until a reset.
//!
//! Guaranteed for every request and every evidence: `|F| <= |F_d|`; while a hand is present, `F` has the direction of `F_d`
//! and changes no faster than the slew limit; after a release, `F . v <= 0` with the estimated `v`. The energy gate before this one
//! observes the applied force, so its bound holds too.
//!
//! A device that reads on its own clock delivers readings that are up to one period older than their times. This error is measured while
//! the handle moves and widens the bound on the hand's force; where the bound becomes too wide, a longer window decides.
//!
//! Measured, not guaranteed: the travel of a released handle, and the rate of false alarms (`docs/results/release.md`,
//! `docs/results/hands.md`). Below about 1.5 N, a slowly opening hand and a fast voluntary motion look the same; there the handle
//! travels farther, because a present hand must never be braked.

mod evidence;
mod fit;
mod observer;

use nalgebra::SVector;

pub use observer::FreeHandle;

use self::{
    evidence::{COULOMB_N, Evidence, EvidenceAnswer, MASS_OFF, OUT_M_S},
    fit::Parabola,
    observer::{Observer, ObserverHistory},
};
use super::{PLAUSIBLE_N, Reason};

// With one tick of delay a sampled damper overshoots from a quarter of `m / T` on (`z^2 - z + b T / m`); 0.15 leaves
// room for the delay of the estimated velocity.
/// A brake sampled with at most this fraction of `m / T` does not make the handle vibrate.
const BRAKE_OF_MASS: f64 = 0.15;
/// Below this speed nothing is braked, m/s. The estimated velocity of a handle at rest has noise of this size, and a
/// brake on noise is felt as vibration.
const STILL_M_S: f64 = 2e-3;
/// Windows for judging the hand's force while no force is applied, s. The long one serves scattered readings, once enough time has passed.
/// Design choice: shorter windows have larger errors, longer ones find a coasting handle later.
const JUDGED_S: f64 = 0.009;
const JUDGED_LONG_S: f64 = 0.028;
/// Time after which a soft grip (400 N/m, 8 N s/m) pulls a handle by more than friction when the force has vanished, s.
const ANSWER_S: f64 = 0.020;
/// Minimum duration of a finding, s: longer than the effect of one wrong reading.
const COASTS_S: f64 = 0.0025;
const PULLS_S: f64 = 0.005;
/// Time after which the brake has stopped a handle, s: seven times `m / b`. Until then, an opening hand still touches
/// it.
const STOPPED_S: f64 = 0.060;
/// If the force before the fade was below this, coasting cannot be distinguished from a slow motion, N.
const COASTING_N: f64 = 0.8;
/// If a handle at rest moves by this distance, a hand moves it, m: tremor has 50 um at 9 Hz.
const STIR_M: f64 = 60e-6;
// Equal to the time that a grip takes to respond (`ANSWER_S`).
const RESTED_S: f64 = 0.020;
/// Rest without any sign of a hand after which the hand counts as gone, s: longer than a period of tremor.
const GONE_AFTER_S: f64 = 0.150;
/// Time in which the whole force returns, s: a tenth of a hand's slowest reaction.
const RETURN_S: f64 = 0.040;
/// A reading farther away is none, m. It is a computing error or a wrong unit, and its square would spoil every fit
/// that contains it.
const FAR_M: f64 = 1e3;

/// Reading of the handle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GovernorReading<const D: usize> {
    /// Time of the reading, s, on the clock of the ticks.
    pub t_s: f64,
    /// Position, m.
    pub position_m: SVector<f64, D>,
}

/// Output of the governor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GovernorOutput<const D: usize> {
    /// Force for the hand, N.
    pub force_n: SVector<f64, D>,
    /// Fraction of the requested force that was withheld, 0 to 1.
    pub withheld: f64,
    /// Why.
    pub reason: Reason,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum GripState<const D: usize> {
    Held,
    Doubtful {
        since: Since,
        /// Applied force when the doubt arose, N.
        force_n: SVector<f64, D>,
        /// Time after the fade from which a pull or none counts, s.
        ripe_s: f64,
    },
    LetGo(Since),
    Gone,
}

/// Observations since a grip became doubtful or was lost; durations in s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[expect(clippy::struct_field_names, reason = "the unit")]
struct Since {
    lasted_s: f64,
    /// Time without any force.
    faded_s: f64,
    pulls_s: f64,
    coasts_s: f64,
    rests_s: f64,
}

/// The governor: gate and memory.
///
/// ```
/// use nalgebra::Vector1;
/// use nima_core::safety::{Governor, FreeHandle, GovernorReading, Reason};
///
/// let handle = FreeHandle { mass_kg: 0.25, damping_n_s_m: 0.5, brake_n_s_m: 30.0, step_m: 1e-5 };
/// let mut governor = Governor::<1>::new(handle, 500.0, 1e-3);
/// let asked_n = Vector1::new(3.0);
/// let (mut position_m, mut speed_m_s, mut held_n) = (0.0, 0.0, 0.0);
/// for tick in 0..300 {
///     let t_s = f64::from(tick) * 1e-3;
///     // A hand of 900 N/m carries the force; after 200 ms it lets go.
///     let hand_n = if tick < 200 { -3.0 - 900.0 * position_m - 20.0 * speed_m_s } else { 0.0 };
///     speed_m_s += (held_n + hand_n - 0.5 * speed_m_s) / 0.25 * 1e-3;
///     position_m += speed_m_s * 1e-3;
///     let reading = GovernorReading { t_s, position_m: Vector1::new(position_m) };
///     let governed = governor.step(t_s, Some(reading), asked_n);
///     held_n = governed.force_n.x;
///     assert!(tick >= 200 || governed.reason == Reason::Open, "a hand that carries it gets all of it");
/// }
/// assert!(held_n.abs() < 0.1 && position_m < 2e-3, "the handle was caught after {position_m} m");
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Governor<const D: usize> {
    handle: FreeHandle,
    brake_n_s_m: f64,
    slew_n_per_s: f64,
    period_s: f64,
    watching: bool,
    last_s: Option<f64>,
    observer: Observer<D>,
    evidence: Evidence<D>,
    grip: GripState<D>,
    rest_m: SVector<f64, D>,
    withheld: f64,
    applied_n: SVector<f64, D>,
}

impl<const D: usize> Governor<D> {
    /// Creates a governor for this handle (with unknown mass, every force passes), a force that changes by at most
    /// `slew_n_per_s` (N/s), and a loop with this nominal period (s).
    pub fn new(handle: FreeHandle, slew_n_per_s: f64, period_s: f64) -> Self {
        Self {
            handle,
            // The smaller of the limits of the device and of the sampling; a stiffer brake would excite the handle
            // instead of stopping it.
            // Without a mass nothing can be computed from a motion, so the governor has no say.
            brake_n_s_m: handle.brake_n_s_m.min(BRAKE_OF_MASS * handle.mass_kg / period_s),
            slew_n_per_s,
            period_s,
            watching: handle.mass_kg > 0.0,
            last_s: None,
            observer: Observer::new(handle),
            evidence: Evidence::default(),
            grip: GripState::Held,
            rest_m: SVector::zeros(),
            withheld: 0.0,
            applied_n: SVector::zeros(),
        }
    }

    /// Returns the handle that it watches.
    pub const fn handle(&self) -> &FreeHandle {
        &self.handle
    }

    /// Watches the handle, or passes every force. A withheld force returns gradually.
    pub fn watch(&mut self, on: bool) {
        self.watching = on && self.handle.mass_kg > 0.0;
        self.grip = GripState::Held;
    }

    /// Starts again without force: the hand is taken to be there.
    pub fn reset(&mut self) {
        self.observer.forget();
        self.evidence = Evidence::default();
        self.grip = GripState::Held;
        self.last_s = None;
        self.withheld = 0.0;
        self.applied_n = SVector::zeros();
    }

    /// Returns the force for the hand at the tick's time `t_s` (s). `reading`: the newest one; with `None` the grip does not change.
    /// `asked_n`: the force that all earlier gates passed (N). Values that are not finite result in zero force.
    pub fn step(
        &mut self,
        t_s: f64,
        reading: Option<GovernorReading<D>>,
        asked_n: SVector<f64, D>,
    ) -> GovernorOutput<D> {
        // The first tick, and a tick after the clock was set back, count as zero elapsed time.
        // An invalid time does not become the last one: the next valid tick then counts its full duration.
        let before_s = if t_s.is_finite() { self.last_s.replace(t_s) } else { self.last_s };
        let dt_s = before_s.map_or(0.0, |before_s| (t_s - before_s).max(0.0));
        // Negated `<=`, so that NaN counts as far.
        let far = |vector: &SVector<f64, D>, limit: f64| !vector.iter().all(|x| x.abs() <= limit);
        let reading_is_far = reading.is_some_and(|reading| far(&reading.position_m, FAR_M) || !reading.t_s.is_finite());
        if far(&asked_n, PLAUSIBLE_N) || reading_is_far || !t_s.is_finite() {
            self.observer.forget();
            // The force then returns gradually.
            self.applied_n = SVector::zeros();
            self.withheld = 1.0;
            return GovernorOutput { force_n: SVector::zeros(), withheld: 1.0, reason: Reason::NotFinite };
        }
        let brake_n = if self.watching { self.judge(dt_s, reading) } else { SVector::zeros() };
        // At most one period: after a late tick the step would otherwise be larger, and the hand would feel it at once.
        let step_n = self.slew_n_per_s * dt_s.min(self.period_s);
        self.applied_n = self.force(asked_n, brake_n, step_n, dt_s);
        GovernorOutput { force_n: self.applied_n, withheld: self.withheld, reason: self.reason() }
    }

    const fn reason(&self) -> Reason {
        match self.grip {
            GripState::Gone => Reason::HandGone,
            GripState::LetGo(_) => Reason::LetGo,
            GripState::Doubtful { .. } => Reason::RunsAway,
            GripState::Held if self.withheld > 0.0 => Reason::RunsAway,
            GripState::Held => Reason::Open,
        }
    }

    /// Decides on the grip; returns the brake's force, N.
    /// Before the reading, because the force was applied until the reading was taken.
    fn judge(&mut self, dt_s: f64, reading: Option<GovernorReading<D>>) -> SVector<f64, D> {
        self.observer.held(&self.applied_n, dt_s);
        let Some(reading) = reading else { return SVector::zeros() };
        self.observer.read(reading.t_s, reading.position_m);
        // A force below the friction cannot move a released handle, so there is nothing to find, and the cost is saved.
        if self.grip == GripState::Gone || (self.grip == GripState::Held && self.applied_n.norm() < COULOMB_N) {
            self.evidence = Evidence::default();
            return SVector::zeros();
        }
        let past = self.observer.past();
        let alone = self.evidence.look(&past);
        self.grip = match (self.grip, alone) {
            (GripState::Held | GripState::Doubtful { .. }, EvidenceAnswer::Certain) => {
                // A certain release also ends a doubt: both states withhold the force, only this one brakes.
                GripState::LetGo(Since::default())
            }
            (GripState::Held, EvidenceAnswer::Pushed | EvidenceAnswer::Dropped) => GripState::Doubtful {
                since: Since::default(),
                force_n: self.applied_n,
                // After a push the hand needs its answer time; a dropped force can be judged as soon as the window is
                // filled.
                ripe_s: if alone == EvidenceAnswer::Pushed { ANSWER_S } else { JUDGED_S },
            },
            (grip, _) => grip,
        };
        // Too few samples since the last gap: keep the state, without a brake.
        let Some(now) = past.parabola(JUDGED_S) else { return SVector::zeros() };
        match self.grip {
            GripState::Held | GripState::Gone => SVector::zeros(),
            // No brake while in doubt: a hand that is present must never be braked.
            GripState::Doubtful { mut since, force_n, ripe_s } => {
                let ripe = since.faded_s > ripe_s;
                // The handle moves along the former force, which was strong enough to distinguish this from a slow
                // motion of the hand.
                let coasting = now.velocity_m_s.dot(&force_n) > OUT_M_S * force_n.norm() && force_n.norm() > COASTING_N;
                self.notice(&mut since, &past, &now, dt_s, ripe);
                // Only a motion along the former force counts; a handle at rest does not indicate a release.
                since.coasts_s = if coasting { since.coasts_s } else { 0.0 };
                self.grip = since.verdict().unwrap_or(GripState::Doubtful { since, force_n, ripe_s });
                SVector::zeros()
            }
            GripState::LetGo(mut since) => {
                let ripe = since.lasted_s > STOPPED_S;
                self.notice(&mut since, &past, &now, dt_s, ripe);
                self.grip = since.verdict().unwrap_or(GripState::LetGo(since));
                self.brake(&now)
            }
        }
    }

    /// Observes the handle without force; a pull counts only once it can be distinguished (`ripe`).
    fn notice(&mut self, since: &mut Since, past: &ObserverHistory<D>, now: &Parabola<D>, dt_s: f64, ripe: bool) {
        // A long tick counts as one observation, not as many.
        // A late tick has one reading, so it is one observation.
        let looked_s = dt_s.min(self.period_s);
        let speed_m_s = now.velocity_m_s.norm();
        let friction_n = COULOMB_N + self.handle.damping_n_s_m * speed_m_s;
        let by_hand = |seen: &Parabola<D>| {
            let applied_n = past.range(seen.span_s, &SVector::zeros()).max_n;
            // The mass error scales the applied force, so it widens the limit by that part.
            seen.hand_n.norm() > friction_n + MASS_OFF * applied_n + seen.error_n
        };
        let longer = if since.faded_s > JUDGED_LONG_S { past.parabola(JUDGED_LONG_S) } else { None };
        let pulls = by_hand(now) || longer.is_some_and(|longer| by_hand(&longer));
        since.lasted_s += dt_s;
        since.faded_s = if self.withheld >= 1.0 { since.faded_s + dt_s } else { 0.0 };
        // Decays twice as fast as it grows, so that noise around the threshold never adds up to a pull.
        since.pulls_s =
            if pulls && ripe { since.pulls_s + looked_s } else { (since.pulls_s - 2.0 * looked_s).max(0.0) };
        since.coasts_s = if !pulls && ripe { since.coasts_s + looked_s } else { 0.0 };
        // A force below a third of the friction does not move a free handle, so a handle at rest says nothing about a
        // hand.
        let quiet = self.withheld >= 1.0 && self.applied_n.norm() < 0.3 * COULOMB_N;
        let moved_m = (past.position_m - self.rest_m).norm();
        if !quiet || moved_m > STIR_M + 2.0 * self.handle.step_m {
            if quiet && since.rests_s > RESTED_S {
                // A handle at rest without force that moves again is moved by a hand, so no further evidence is needed.
                since.pulls_s = PULLS_S;
            }
            self.rest_m = past.position_m;
            since.rests_s = 0.0;
        } else if moved_m > 1.5 * self.handle.step_m {
            // A motion of one to two steps is neither rest nor a hand, so the time at rest does not increase.
            since.rests_s = since.rests_s.min(RESTED_S + looked_s);
        } else {
            since.rests_s += looked_s;
        }
    }

    fn brake(&self, now: &Parabola<D>) -> SVector<f64, D> {
        let speed_m_s = now.velocity_m_s.norm();
        // Offset by the still speed, so that the brake starts from zero and not with a step.
        let brake_n = self.brake_n_s_m * (speed_m_s - STILL_M_S).max(0.0);
        now.velocity_m_s * (-brake_n / speed_m_s.max(STILL_M_S))
    }

    fn force(&mut self, asked_n: SVector<f64, D>, brake_n: SVector<f64, D>, step_n: f64, dt_s: f64) -> SVector<f64, D> {
        match self.grip {
            GripState::Gone => {
                self.withheld = 1.0;
                SVector::zeros()
            }
            GripState::LetGo(since) => {
                self.withheld = 1.0;
                // The first tick removes the force; later ticks apply the brake alone.
                if since.lasted_s <= dt_s {
                    return SVector::zeros();
                }
                // A decrease of the request uses up part of the slew limit; the brake gets the rest.
                let max_n = asked_n.norm();
                // If the request shrinks, the brake must not exceed it: it is never stronger than the force the
                // operator expects.
                let kept_n = within(self.applied_n, max_n);
                let room_n = (step_n - (kept_n - self.applied_n).norm()).max(0.0);
                kept_n + within(within(brake_n, max_n) - kept_n, room_n)
            }
            GripState::Doubtful { .. } | GripState::Held => {
                // A change of the request uses up part of the slew limit; fading gets the rest.
                let kept_n = asked_n * (1.0 - self.withheld);
                let room_n = (step_n - (kept_n - self.applied_n).norm()).max(0.0);
                // The small number only prevents a division by zero: without a request there is nothing to fade.
                let change = (room_n / asked_n.norm().max(1e-9)).min(1.0);
                // In doubt the whole slew limit is used to fade; the return takes `RETURN_S`.
                let fades = self.grip != GripState::Held;
                let back = change.min(dt_s / RETURN_S);
                self.withheld = if fades { (self.withheld + change).min(1.0) } else { (self.withheld - back).max(0.0) };
                asked_n * (1.0 - self.withheld)
            }
        }
    }
}

impl Since {
    /// Returns the grip that this shows, if any.
    fn verdict<const D: usize>(&self) -> Option<GripState<D>> {
        // A pull is examined first: if the findings contradict each other, a hand is assumed.
        if self.pulls_s >= PULLS_S {
            Some(GripState::Held)
        } else if self.rests_s > GONE_AFTER_S {
            Some(GripState::Gone)
        } else if self.coasts_s > COASTS_S {
            Some(GripState::LetGo(*self))
        } else {
            None
        }
    }
}

/// Returns the vector, shortened to this length.
fn within<const D: usize>(vector: SVector<f64, D>, max: f64) -> SVector<f64, D> {
    let norm = vector.norm();
    if norm > max { vector * (max / norm) } else { vector }
}

#[cfg(test)]
mod tests;
