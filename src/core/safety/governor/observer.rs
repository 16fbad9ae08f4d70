//! The handle's last readings with the force that was applied between them, at true times.
//!
//! A late tick changes only the spacing of the samples. By the model `m x'' + c x' = F + f_hand`, the second derivative
//! of `y = m x + c ∫x - ∬F` is the hand's force, whatever `F` did in between. An [`ObserverHistory`] is this `y`, and
//! [`fit`](super::fit) takes the derivative.

use nalgebra::SVector;

/// A haptic handle without a hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeHandle {
    /// Apparent mass at the grip, kg; 0: unknown.
    pub mass_kg: f64,
    /// Viscous friction of bearings and cables, N s/m.
    pub damping_n_s_m: f64,
    /// Largest viscous damping that the device renders without vibration, N s/m.
    pub brake_n_s_m: f64,
    /// Step of the position reading, m.
    pub step_m: f64,
}

/// Samples kept: the longest fit spans 30 ms, and a rate above 2.5 kHz is thinned out to [`SPACING_S`].
pub(super) const ROOM: usize = 96;
/// A reading closer to the last sample than this is discarded, s.
const SPACING_S: f64 = 0.4e-3;
/// After a longer gap, the force during it is unknown, s, because a device switches its force off if no command
/// arrives.
const GAP_S: f64 = 0.010;
/// A handle that moved by this many reading steps moves on by at least one, so a reading that repeats the previous one
/// is old.
const MOVES_STEPS: f64 = 3.0;
/// Shortest time between two readings in which such a motion must show, s, and longest time for which old readings are ignored.
const SHOWS_S: f64 = 0.7e-3;
const OLD_S: f64 = 5e-3;
/// The times of readings are evaluated while the handle moves faster than this, m/s, and for spacings up to this, s.
const MOVES_M_S: f64 = 0.01;
const CLOSE_S: f64 = 6e-3;
/// Largest acceleration of a hand, m/s^2, which bends the path between readings (see `HAND_M_S2`).
const BENDS_M_S2: f64 = 6.0;
/// Time constant for forgetting the largest error, s. Clocks of 1 kHz that differ by 100 ppm need 10 s to drift apart by one period.
const REMEMBERED_S: f64 = 60.0;
/// Smallest plausible mass, kg: a lighter handle moves farther in one tick than can be evaluated.
const MIN_KG: f64 = 0.01;

#[derive(Clone, Copy, Debug)]
struct ObserverSample<const D: usize> {
    t_s: f64,
    position_m: SVector<f64, D>,
    /// Mean force applied from this sample to the next one, N.
    applied_n: SVector<f64, D>,
}

/// Ring of samples.
#[derive(Clone, Copy, Debug)]
pub(super) struct Observer<const D: usize> {
    handle: FreeHandle,
    ring: [ObserverSample<D>; ROOM],
    newest: usize,
    count: usize,
    /// Impulse of the force since the newest sample, N s, and its duration, s.
    impulse_n_s: SVector<f64, D>,
    over_s: f64,
    /// Distance of the newest sample from the previous one, m.
    moved_m: f64,
    /// Largest error of the times of readings, s, fading.
    inexact_s: f64,
}

impl<const D: usize> Observer<D> {
    pub(super) fn new(handle: FreeHandle) -> Self {
        let blank = ObserverSample { t_s: 0.0, position_m: SVector::zeros(), applied_n: SVector::zeros() };
        // A mass of zero would divide by zero; the governor does not watch such a handle anyway.
        let handle = FreeHandle { mass_kg: handle.mass_kg.max(MIN_KG), ..handle };
        Self {
            handle,
            ring: [blank; ROOM],
            newest: 0,
            count: 0,
            impulse_n_s: SVector::zeros(),
            over_s: 0.0,
            moved_m: 0.0,
            inexact_s: 0.0,
        }
    }

    /// Forgets all samples.
    pub(super) fn forget(&mut self) {
        self.count = 0;
        self.moved_m = 0.0;
        self.impulse_n_s = SVector::zeros();
        self.over_s = 0.0;
    }

    /// Adds `dt_s` (s) during which `applied_n` (N) was applied.
    pub(super) fn held(&mut self, applied_n: &SVector<f64, D>, dt_s: f64) {
        self.impulse_n_s += applied_n * dt_s;
        self.over_s += dt_s;
    }

    /// Adds a reading (m) taken at `t_s` (s). One that is not newer than the last sample is ignored.
    pub(super) fn read(&mut self, t_s: f64, position_m: SVector<f64, D>) {
        if self.count > 0 {
            let since_s = t_s - self.ring[self.newest].t_s;
            // A clock that was set back by more than a gap would otherwise block every later reading as old.
            if !(-GAP_S..=GAP_S).contains(&since_s) {
                self.forget();
            } else if since_s < SPACING_S || self.is_old(since_s, &position_m) {
                return;
            } else if self.over_s > 0.0 {
                self.ring[self.newest].applied_n = self.impulse_n_s / self.over_s;
            }
            self.moved_m = (position_m - self.ring[self.newest].position_m).norm();
            // First order suffices: a step is far below `REMEMBERED_S`, and a gap was handled above.
            self.inexact_s *= 1.0 - since_s.max(0.0) / REMEMBERED_S;
        }
        self.newest = (self.newest + 1) % ROOM;
        self.ring[self.newest] = ObserverSample { t_s, position_m, applied_n: SVector::zeros() };
        self.count = (self.count + 1).min(ROOM);
        self.impulse_n_s = SVector::zeros();
        self.over_s = 0.0;
        // After the sample is stored, because the judgement compares the last three.
        self.judge_times();
    }

    /// Returns whether the reading is old: the handle moves, but the reading repeats the previous one.
    fn is_old(&self, since_s: f64, position_m: &SVector<f64, D>) -> bool {
        let must_move = self.moved_m >= MOVES_STEPS * self.handle.step_m && (SHOWS_S..OLD_S).contains(&since_s);
        must_move && *position_m == self.ring[self.newest].position_m
    }

    /// Evaluates how far the last three readings are from a common path at their times.
    fn judge_times(&mut self) {
        if self.count < 3 {
            return;
        }
        let at = |back: usize| &self.ring[(self.newest + ROOM - back) % ROOM];
        let [new, mid, old] = [at(0), at(1), at(2)];
        // Unequal intervals are common (USB), so the path between the outer readings is weighted by time.
        let [after_s, before_s] = [new.t_s - mid.t_s, mid.t_s - old.t_s];
        let speed_m_s = (new.position_m - old.position_m).norm() / (after_s + before_s);
        if after_s > CLOSE_S || before_s > CLOSE_S || speed_m_s < MOVES_M_S {
            return;
        }
        let between_m = (new.position_m * before_s + old.position_m * after_s) / (after_s + before_s);
        let bend_m = 0.5 * BENDS_M_S2 * after_s * before_s + self.handle.step_m;
        // A hand's largest acceleration and one reading step explain this much without an error of the time.
        let off_m = ((mid.position_m - between_m).norm() - bend_m).max(0.0);
        // Twice: the middle reading shows only half of a shift that affects one of the outer ones.
        self.inexact_s = self.inexact_s.max(2.0 * off_m / speed_m_s);
    }

    /// Returns the samples relative to the newest one.
    pub(super) fn past(&self) -> ObserverHistory<D> {
        let mut past = ObserverHistory::blank(self.handle, self.count, self.inexact_s);
        let now = self.ring[self.newest];
        let mut impulse_n_s = SVector::<f64, D>::zeros();
        let mut twice_n_s2 = SVector::<f64, D>::zeros();
        let mut travel_m_s = SVector::<f64, D>::zeros();
        past.position_m = now.position_m;
        for back in 1..self.count {
            let sample = self.ring[(self.newest + ROOM - back) % ROOM];
            let next = self.ring[(self.newest + ROOM - back + 1) % ROOM];
            let dt_s = next.t_s - sample.t_s;
            // Exact for a force that is constant between two samples.
            twice_n_s2 += impulse_n_s * dt_s + sample.applied_n * (0.5 * dt_s * dt_s);
            impulse_n_s += sample.applied_n * dt_s;
            travel_m_s += (sample.position_m + next.position_m - now.position_m * 2.0) * (0.5 * dt_s);
            let from_now_m = sample.position_m - now.position_m;
            past.t_s[back] = sample.t_s - now.t_s;
            past.from_now_m[back] = from_now_m;
            past.impulse_n_s[back] = impulse_n_s;
            past.applied_n[back] = sample.applied_n;
            past.y[back] = from_now_m * self.handle.mass_kg - travel_m_s * self.handle.damping_n_s_m - twice_n_s2;
        }
        past
    }
}

/// Samples relative to the newest one, which has index 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct ObserverHistory<const D: usize> {
    pub(super) handle: FreeHandle,
    pub(super) count: usize,
    /// Error of the times, s.
    pub(super) inexact_s: f64,
    /// The newest reading, m.
    pub(super) position_m: SVector<f64, D>,
    /// Time after the newest sample, s: none is above 0.
    pub(super) t_s: [f64; ROOM],
    /// Position from the newest one, m.
    pub(super) from_now_m: [SVector<f64, D>; ROOM],
    /// Impulse of the applied force from this sample until now, N s.
    pub(super) impulse_n_s: [SVector<f64, D>; ROOM],
    /// Force applied from this sample to the next one, N.
    pub(super) applied_n: [SVector<f64, D>; ROOM],
    /// `m x + c ∫x - ∬F`, kg m.
    pub(super) y: [SVector<f64, D>; ROOM],
}

impl<const D: usize> ObserverHistory<D> {
    fn blank(handle: FreeHandle, count: usize, inexact_s: f64) -> Self {
        let zeros = [SVector::zeros(); ROOM];
        Self {
            handle,
            count,
            inexact_s,
            position_m: SVector::zeros(),
            t_s: [0.0; ROOM],
            from_now_m: zeros,
            impulse_n_s: zeros,
            applied_n: zeros,
            y: zeros,
        }
    }

    /// Returns the largest force applied in the last `span_s` (s), N, and its smallest component along a unit vector,
    /// N.
    pub(super) fn range(&self, span_s: f64, along: &SVector<f64, D>) -> ForceRange {
        let mut range = ForceRange { max_n: 0.0, min_along_n: f64::INFINITY };
        for k in 1..self.count {
            if self.t_s[k - 1] < -span_s {
                break;
            }
            range.max_n = range.max_n.max(self.applied_n[k].norm());
            range.min_along_n = range.min_along_n.min(self.applied_n[k].dot(along));
        }
        range
    }
}

/// Extremes of the applied force, N.
#[derive(Clone, Copy, Debug)]
pub(super) struct ForceRange {
    pub(super) max_n: f64,
    pub(super) min_along_n: f64,
}

impl ForceRange {
    /// Returns the change of the force, N.
    pub(super) fn change_n(&self) -> f64 {
        (self.max_n - self.min_along_n).max(0.0)
    }
}
